//! Neither the number of threads nor the size of tiles changes a byte of any file.

mod common;

use common::Folder;

#[test]
fn threads_and_tiles_change_nothing() {
    let folder = Folder::new();
    folder.write("scene.txt", format!("{} Settings {{ bounces 3 }}", common::BALL));
    for (samples, filter) in
        [("jittered 5", "none"), ("uniform 4", "gaussian 0.7"), ("regular 4", "lanczos 3")]
    {
        let mut first = None;
        for (threads, tile) in [(1, 0), (2, 0), (7, 0), (2, 8), (3, 64), (1, 512)] {
            let size = "--size 150 90";
            folder.succeed(&format!(
                "scene.txt -o a.png --aov normals=n.png {size} --samples {samples} --filter {filter} --threads {threads} --tile {tile}"
            ));
            folder.succeed(&format!(
                "scene.txt -o a.exr --layers all {size} --samples {samples} --filter {filter} --threads {threads} --tile {tile}"
            ));
            let files = ["a.png", "n.png", "a.exr"].map(|name| folder.read(name));
            let first = first.get_or_insert_with(|| files.clone());
            assert!(
                *first == files,
                "{samples}, {filter}: {threads} threads and tile {tile} differ from 1 and 0"
            );
        }
    }
}

/// Light from emitters falls on any pixel, whoever follows it.
#[test]
fn threads_and_tiles_change_nothing_of_light_from_lights() {
    let folder = Folder::new();
    folder.write("scene.txt", common::BALL);
    for more in [
        "--integrator bidirectional --samples jittered 4",
        "--integrator light --samples sobol 8 --filter mitchell 2",
        "--integrator bidirectional --samples sobol 32 --adaptive --noise 0.03 --filter gaussian 0.6",
    ] {
        let mut first = None;
        for (threads, tile) in [(1, 0), (4, 0), (2, 8), (3, 512)] {
            folder.succeed(&format!(
                "scene.txt -o a.exr --size 90 60 {more} --threads {threads} --tile {tile}"
            ));
            let picture = folder.read("a.exr");
            let first = first.get_or_insert_with(|| picture.clone());
            assert!(*first == picture, "{more}: {threads} threads and tile {tile} differ from 1 and 0");
        }
    }
}

#[test]
fn another_seed_is_another_picture() {
    let folder = Folder::new();
    let line = "-input ball.txt -output a.png -jittered_samples 4";
    let with_seed = |seed: &str| {
        folder.succeed(&format!("{line} {seed}"));
        folder.read("a.png")
    };
    let zero = with_seed("");
    assert!(with_seed("--seed 0") == zero);
    assert!(with_seed("--seed 1") != zero);
}
