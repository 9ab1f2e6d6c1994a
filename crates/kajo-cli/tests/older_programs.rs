//! Options of older programs: what they asked for is there, or the run fails.

mod common;

use common::Folder;
use kajo::Image;

const SCENE: &str = "OrthographicCamera { center 0 0 5  direction 0 0 -1  up 0 1 0  size 4 }
    Background { color 0 0 0 }
    Materials { Material { diffuseColor 1 0.5 0.25 } }
    Group { MaterialIndex 0  Triangle { vertex0 -1.7 -1.3 0  vertex1 1.9 -0.4 0  vertex2 0.2 1.8 0 } }";

fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("s.txt", SCENE);
    folder
}

fn image(folder: &Folder, name: &str) -> Image {
    common::picture(&folder.path(name))
}

#[test]
fn a_filtered_picture_is_one_of_three_times_its_size_weighed_by_1_2_1() {
    let folder = folder();
    for dialect in ["handout", "mit-a2"] {
        let run = |options: &str| {
            folder.succeed(&format!("-input s.txt -quiet -dialect {dialect} {options}"));
        };
        run("-output large.pfm -size 30 24");
        run("-output small.pfm -size 10 8 -filter");
        let (large, small) = (image(&folder, "large.pfm"), image(&folder, "small.pfm"));
        assert_eq!((small.width(), small.height()), (10, 8));
        let weight = |d: u32| [1.0, 2.0, 1.0][d as usize];
        let mut between = 0;
        for (y, x) in (0..8).flat_map(|y| (0..10).map(move |x| (y, x))) {
            let mut sum = [0.0f32; 3];
            for (dy, dx) in (0..3).flat_map(|dy| (0..3).map(move |dx| (dy, dx))) {
                let from = large.rgb(3 * x + dx, 3 * y + dy);
                sum.iter_mut().zip(from).for_each(|(sum, v)| *sum += weight(dx) * weight(dy) / 16.0 * v);
            }
            let found = small.rgb(x, y);
            assert!(found.iter().zip(sum).all(|(a, b)| (a - b).abs() < 1e-6), "{x} {y}: {found:?} {sum:?}");
            between += usize::from(sum[0] > 0.0 && sum[0] < 1.0);
        }
        assert!(between > 5, "the triangle has edges");
    }
    // With `-jitter` rays lie anywhere; what is inside stays what it is.
    folder.succeed("-input s.txt -quiet -output jitter.pfm -size 10 8 -jitter -filter");
    assert_eq!(image(&folder, "jitter.pfm").rgb(5, 4), [1.0, 0.5, 0.25]);
    folder.succeed("-input s.txt -quiet -output mean.bmp -size 10 8 -jitter");
    let mean = image(&folder, "mean.bmp");
    assert_eq!((mean.width(), mean.height()), (10, 8));
    let ninths = |v: f32| (9.0 * v - (9.0 * v).round()).abs() < 9.0 / 255.0;
    assert!(mean.rgb_pixels().all(|[r, ..]| ninths(r)));
    folder.fail("-input s.txt -output a.exr -filter", 2, &["no OpenEXR files"]);
}

#[test]
fn samples_and_filters_are_drawn() {
    let folder = folder();
    folder.succeed("-input s.txt -quiet -size 3 2 -regular_samples 4 -render_samples samples.png 8 -box_filter 0.5 -render_filter filter.bmp 4");
    let samples = image(&folder, "samples.png");
    assert_eq!((samples.width(), samples.height()), (24, 16));
    assert_eq!(samples.rgb_pixels().filter(|rgb| *rgb == [1.0; 3]).count(), 3 * 2 * 4);
    let filter = image(&folder, "filter.bmp");
    assert_eq!((filter.width(), filter.height()), (12, 8));
    assert_eq!(filter.rgb_pixels().filter(|rgb| *rgb == [1.0; 3]).count(), 4 * 4);
    assert_eq!([filter.rgb(4, 4), filter.rgb(3, 4)], [[1.0; 3], [0.0; 3]]);
    for (options, code, said) in [
        ("-render_samples a.png 0", 2, "expected a whole number from 1 to 1000, found `0`"),
        ("-render_samples a.png x", 2, "found `x`"),
        ("-render_filter a.what 3", 2, "its ending says no format"),
        ("-size 4000 4000 -render_filter a.png 100", 2, "or more than"),
        ("-output a.png -render_filter a.png 3", 5, "twice in one run"),
    ] {
        folder.fail(&format!("-input s.txt {options}"), code, &[said]);
    }
}

#[test]
fn what_there_is_not_is_refused() {
    let folder = folder();
    for option in ["-visualize_grid", "-output_bezier a.txt", "-output_bspline a.txt"] {
        folder.fail(&format!("-input s.txt -output a.png {option}"), 2, &["cannot be done"]);
        assert!(!folder.path("a.png").exists());
    }
}
