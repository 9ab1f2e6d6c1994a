//! Both command lines, from arguments to pixels.

mod common;

use common::{BALL, Folder, picture};

fn pixel(folder: &Folder, name: &str, x: u32, y: u32) -> Vec<u8> {
    picture(&folder.path(name)).pixel(x, y).iter().map(|v| (v * 255.0 + 0.5) as u8).collect()
}

#[test]
fn the_classic_line_writes_what_it_is_asked_for_and_nothing_else() {
    let folder = Folder::new();
    folder.succeed("-input ball.txt -size 20 10 -output c.png -depth 7 10 d.png -normals n.png");
    for name in ["c.png", "d.png", "n.png"] {
        let image = picture(&folder.path(name));
        assert_eq!((image.width(), image.height(), image.channels()), (20, 10, 4), "{name} is RGBA");
    }
    assert_eq!(folder.names(), ["ball.txt", "c.png", "d.png", "n.png"]);
    folder.succeed("-input ball.txt -normals m.png -size 20 10");
    assert_eq!(folder.read("m.png"), folder.read("n.png"), "normals do not depend on the rest");
    assert_eq!(folder.names().len(), 5);
    folder.succeed("-input ball.txt");
    assert_eq!(folder.names().len(), 5);
}

#[test]
fn classic_defaults_are_those_of_the_course() {
    let folder = Folder::new();
    folder.succeed("-input ball.txt -output a.png");
    folder.succeed("-input ball.txt -output b.png -size 100 100 -regular_samples 1 -bounces 0 -weight 0");
    assert!(folder.read("a.png") == folder.read("b.png"));
    for more in ["-shadows", "-bounces 1", "-regular_samples 4", "-uv", "-tent_filter 2"] {
        folder.succeed(&format!("-input ball.txt -output c.png {more}"));
        assert!(folder.read("a.png") != folder.read("c.png"), "{more} changes the picture");
    }
}

#[test]
fn a_scene_may_choose_its_integrator() {
    let folder = Folder::new();
    let line = "render ball.txt --size 20 15 --integrator";
    let told = folder.succeed(&format!("{line} auto -o a.png")).stderr;
    assert!(told.contains("note: integrator auto takes `classic`: its lights, ambient"), "{told}");
    folder.succeed(&format!("{line} classic -o b.png"));
    assert!(folder.read("a.png") == folder.read("b.png"));
    assert!(!folder.succeed(&format!("{line} auto -o a.png --quiet")).stderr.contains("auto"));
}

#[test]
fn later_options_win() {
    let folder = Folder::new();
    folder
        .succeed("-input ball.txt -output a.png -size 9 9 -size 10 8 -jittered_samples 9 -regular_samples 4");
    folder.succeed("-input ball.txt -output b.png -size 10 8 -regular_samples 4");
    assert!(folder.read("a.png") == folder.read("b.png"));
    folder.succeed("-input ball.txt -output a.png -tent_filter 2 -box_filter 0.5");
    folder.succeed("-input ball.txt -output b.png -box_filter 0.5");
    assert!(folder.read("a.png") == folder.read("b.png"));
}

#[test]
fn the_uv_picture_shows_pixel_centres() {
    let folder = Folder::new();
    folder.write("empty.txt", "Background { color 0 0 0 }");
    for line in ["-input ball.txt -uv", "-input empty.txt"] {
        folder.succeed(&format!("{line} -size 8 4 -output uv.png"));
        // ((i + 1/2)/8, (j + 1/2)/4, 1), rounded.
        assert_eq!(pixel(&folder, "uv.png", 0, 0), [16, 32, 255, 255], "{line}");
        assert_eq!(pixel(&folder, "uv.png", 7, 3), [239, 223, 255, 255], "{line}");
    }
}

#[test]
fn depth_runs_from_white_to_black_and_takes_negative_ranges() {
    let folder = Folder::new();
    folder.write(
        "wall.txt",
        "OrthographicCamera { center 0 0 5  direction 0 0 -1  up 0 1 0  size 2 }\n\
         Materials { Material {} } Group { MaterialIndex 0  Plane { normal 0 0 1  offset 0 } }",
    );
    for (range, expected) in
        [("0 10", 128), ("5 10", 255), ("0 5", 0), ("-5 15", 128), ("-.5 10.5", 128), ("10 0", 128)]
    {
        folder.succeed(&format!("-input wall.txt -size 2 2 -depth {range} d.png"));
        assert_eq!(pixel(&folder, "d.png", 0, 0)[0], expected, "{range}");
    }
}

#[test]
fn no_samples_are_a_black_picture() {
    let folder = Folder::new();
    folder.succeed("-input ball.txt -output a.png -size 5 5 -regular_samples 0");
    assert_eq!(pixel(&folder, "a.png", 2, 2), [0, 0, 0, 255]);
}

#[test]
fn options_of_older_programs_are_accepted_with_a_warning() {
    let folder = Folder::new();
    let old = "-gui -tessellation 10 5 -gouraud -grid 20 20 20";
    let ran = folder.succeed(&format!("-input ball.txt {old} -output a.png -specular_fix"));
    for name in ["-gui", "-tessellation", "-gouraud", "-grid"] {
        assert!(
            ran.stderr.contains(&format!("`{name}` belongs to an older program")),
            "{name}: {}",
            ran.stderr
        );
    }
    assert!(ran.stderr.contains("`-specular_fix` works in dialect mit-2004 only"), "{}", ran.stderr);
}

#[test]
fn words_mean_what_they_mean_in_their_dialect() {
    let folder = Folder::new();
    let render = |options: &str| {
        folder.succeed(&format!("-input ball.txt -output a.png -size 30 30 {options}"));
        folder.read("a.png")
    };
    let grid = render("-regular_samples 4 --dialect mit-2004");
    assert!(render("-uniform_samples 4 --dialect mit-2004") == grid);
    assert!(render("-random_samples 4 --dialect mit-2004") != grid);
    assert!(render("-uniform_samples 4") != render("-regular_samples 4"));
    assert!(render("-uniform_samples 4") == render("-random_samples 4"));
    assert!(render("--dialect mit-2004") != render("--dialect mit-2004 -specular_fix"));
    assert!(render("--dialect mit-2004") != render(""));
}

#[test]
fn a_bare_scene_is_rendered_beside_itself() {
    let folder = Folder::new();
    folder.write("sub/scene.txt", format!("{BALL} Settings {{ size 12 8 }}"));
    let ran = folder.succeed("sub/scene.txt");
    assert!(ran.stderr.contains("12 x 8, 16 samples a pixel") && ran.stdout.is_empty(), "{}", ran.stderr);
    let image = picture(&folder.path("sub/scene.png"));
    assert_eq!((image.width(), image.height(), image.channels()), (12, 8, 3));
    let ran = folder.succeed("sub/scene.txt --size 6 4 --quiet");
    assert!(ran.stderr.is_empty());
    assert_eq!(picture(&folder.path("sub/scene.png")).width(), 6, "the command line wins over the scene");
}

#[test]
fn one_run_writes_many_pictures() {
    let folder = Folder::new();
    let aov = "--aov depth=d.pfm --aov normals=n.png --aov uv=uv.tga --aov object=o.png --aov material=m.ppm --aov samples=s.hdr";
    folder.succeed(&format!("ball.txt --size 16 12 -o c.png {aov}"));
    for name in ["c.png", "d.pfm", "n.png", "uv.tga", "o.png", "m.ppm", "s.hdr"] {
        assert_eq!(picture(&folder.path(name)).width(), 16, "{name}");
    }
    let depth = picture(&folder.path("d.pfm")).pixel(8, 6)[0];
    assert!((7.0..10.0).contains(&depth), "the distance itself: {depth}");
}

#[test]
fn an_exr_file_holds_every_layer() {
    let folder = Folder::new();
    folder.succeed("ball.txt --size 16 12 -o all.exr --layers all");
    folder.succeed("ball.txt --size 16 12 -o some.exr --aov depth --aov object");
    folder.succeed("ball.txt --size 16 12 -o same.exr --layers color,depth,object");
    assert!(folder.read("some.exr") == folder.read("same.exr"));
    let all = folder.read("all.exr");
    for channel in
        ["B", "G", "N.X", "N.Y", "N.Z", "R", "Z", "material.id", "object.id", "samples.count", "uv.U", "uv.V"]
    {
        let name = [channel.as_bytes(), b"\0"].concat();
        assert!(all.windows(name.len()).any(|window| window == name), "{channel}");
    }
}

#[test]
fn sixteen_bits_are_finer_than_eight() {
    let folder = Folder::new();
    let line = "ball.txt --size 16 12 --samples 4";
    folder.succeed(&format!("{line} -o a.png"));
    folder.succeed(&format!("{line} -o b.png --bits 16"));
    let (eight, sixteen) = (picture(&folder.path("a.png")), picture(&folder.path("b.png")));
    let farthest = eight.data().iter().zip(sixteen.data()).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    assert!(farthest > 0.0 && farthest <= 0.5 / 255.0 + 1e-5, "{farthest}");
}

#[test]
fn a_picture_can_go_to_standard_output() {
    let folder = Folder::new();
    folder.succeed("ball.txt --size 16 12 -o a.png");
    let output = folder.command().args("ball.txt --size 16 12 -o - --quiet".split(' ')).output().unwrap();
    assert!(output.stdout == folder.read("a.png"));
}

#[test]
fn the_deepest_mirrors_do_not_exhaust_the_stack() {
    let folder = Folder::new();
    folder.write(
        "mirrors.txt",
        "PerspectiveCamera { center 0 0 0  direction 0.01 0 -1  up 0 1 0  angle 60 }\n\
         Background { ambientLight 1 1 1 }\n\
         Materials { Material { diffuseColor 0.0005 0.0005 0.0005  reflectiveColor 1 1 1 } }\n\
         Group { MaterialIndex 0  Plane { normal 0 0 1  offset -1 }  Plane { normal 0 0 1  offset 1 } }",
    );
    let ran = folder.succeed("-input mirrors.txt -size 9 9 -bounces 1000 -output a.png -stats");
    assert!(ran.stderr.contains("mirror rays"), "{}", ran.stderr);
    // 1001 surfaces in a row, each with a light of 0.0005.
    assert_eq!(pixel(&folder, "a.png", 4, 4), [128, 128, 128, 255]);
    folder.fail("-input mirrors.txt -bounces 1001", 2, &["1001"]);
}

#[test]
fn stereo_cameras_have_sizes_of_their_own() {
    let folder = Folder::new();
    let scene = BALL.replace("PerspectiveCamera", "StereoCubemapCamera").replace("angle 30", "");
    folder.write("cubes.txt", scene);
    folder.fail("cubes.txt --size 100 100", 2, &["12 times as wide as high", "1200 x 100"]);
    folder.succeed("cubes.txt --size 120 10 --samples 1");
    let ran = folder.succeed("cubes.txt --samples 1");
    assert!(ran.stderr.contains("3072 x 256"), "{}", ran.stderr);
}

#[test]
fn statistics_and_progress_are_printed_on_request() {
    let folder = Folder::new();
    let ran = folder.succeed("-input ball.txt -output a.png -shadows -bounces 1 -stats -show_progress");
    for word in ["camera rays", "10000", "shadow rays", "mirror rays", "100 %"] {
        assert!(ran.stderr.contains(word), "{word}: {}", ran.stderr);
    }
    assert!(!folder.succeed("-input ball.txt -output a.png").stderr.contains("camera rays"));
}

#[cfg(target_os = "linux")]
#[test]
fn names_need_not_be_text() {
    use std::ffi::OsString;
    use std::os::unix::ffi::OsStringExt;
    let folder = Folder::new();
    let name = |bytes: &[u8]| OsString::from_vec(bytes.to_vec());
    std::fs::rename(folder.path("ball.txt"), folder.path("").join(name(b"b\xffll.txt"))).unwrap();
    let mut command = folder.command();
    command.arg(name(b"b\xffll.txt")).args(["--size", "4", "4", "--aov"]).arg(name(b"depth=d\xfe.png"));
    let ran = common::Ran::from(command.output().unwrap());
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    assert!(folder.path("").join(name(b"b\xffll.png")).is_file());
    assert!(folder.path("").join(name(b"d\xfe.png")).is_file());
}
