//! Films: several frames of a scene, their names, and a video of them.

mod common;

use std::os::unix::fs::PermissionsExt;
use std::process::Command;

use common::{Folder, picture};

/// A ball that goes round in eight frames, with a light and a camera of their own.
const ORBIT: &str = "\
Animation { fps 8  frames 1 8 }
PerspectiveCamera { center keys loop cubic { 0: 0 1 9  0.5: 0.5 1 9  1: 0 1 9 }  target 0 0 0  up 0 1 0  angle 40 }
Background { color 0.2 0.3 0.5  ambientLight 0.2 0.2 0.2 }
Lights { PointLight { position 3 4 5  color keys loop { 0: 1 0.6 0.6  0.5: 0.6 1 1  1: 1 0.6 0.6 } } }
Materials { PhongMaterial { diffuseColor keys loop { 0: 0.8 0.6 0.2  0.5: 0.2 0.6 0.8  1: 0.8 0.6 0.2 } } }
Group {
  MaterialIndex 0
  Transform {
    YRotate keys loop { 0: 0  1: 360 }
    Sphere { center 2 0 0  radius keys loop pingpong { 0: 0.5  0.5: 1 } }
  }
}
";

const HOW: &str = "--size 48 36 --samples jittered 4 --quiet";

fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("orbit.txt", ORBIT);
    folder
}

#[test]
fn a_frame_alone_is_that_of_a_run_and_an_orbit_closes() {
    let folder = folder();
    folder.succeed(&format!("render orbit.txt --frames all -o run.####.png {HOW}"));
    folder.succeed(&format!("render orbit.txt --frames 8,2..6:2 -o some.##.png {HOW}"));
    let frame = |k: u32| folder.read(&format!("run.{k:04}.png"));
    for k in [2, 4, 6, 8] {
        assert_eq!(folder.read(&format!("some.{k:02}.png")), frame(k), "frame {k}");
    }
    assert!(!folder.names().contains(&"some.03.png".to_owned()));
    // One frame needs no place for a number; without any it is the first.
    folder.succeed(&format!("render orbit.txt --frames 5 -o five.png --threads 1 {HOW}"));
    folder.succeed(&format!("orbit.txt -o first.png {HOW}"));
    assert_eq!((folder.read("five.png"), folder.read("first.png")), (frame(5), frame(1)));
    folder.succeed(&format!("render orbit.txt --frames 9..10 -o next.#.png {HOW}"));
    assert_eq!((folder.read("next.9.png"), folder.read("next.10.png")), (frame(1), frame(2)));
    assert!(frame(1) != frame(2) && frame(1) != frame(5));
    // Twice as many frames of a second: every second one is the same but for the blur.
    folder.succeed(&format!("render orbit.txt --frames 1 --fps 16 -o fast.png {HOW}"));
    assert!(folder.read("fast.png") != frame(1));
}

#[test]
fn all_files_of_a_frame_have_its_number() {
    let folder = folder();
    folder.succeed(&format!(
        "render orbit.txt --frames 1..2 -o a.###.exr --layers color,depth,motion --aov normals=n#.png {HOW}"
    ));
    let made = folder.names();
    for name in ["a.001.exr", "a.002.exr", "n1.png", "n2.png"] {
        assert!(made.contains(&name.to_owned()), "{name} of {made:?}");
    }
    // Without a name they stand beside the scene.
    folder.succeed(&format!("render orbit.txt --frames 1..2 {HOW}"));
    assert!(folder.names().contains(&"orbit.0002.png".to_owned()));
}

#[test]
fn frames_that_are_there_are_kept_when_asked() {
    let folder = folder();
    let line = format!("render orbit.txt --frames 1..3 -o f.#.png {HOW}");
    folder.succeed(&line);
    let third = folder.read("f.3.png");
    folder.write("f.2.png", "kept");
    std::fs::remove_file(folder.path("f.3.png")).unwrap();
    folder.succeed(&format!("{line} --keep-frames"));
    assert_eq!((folder.read("f.2.png"), folder.read("f.3.png")), (b"kept".to_vec(), third));
    folder.succeed(&line);
    assert!(folder.read("f.2.png") != b"kept");
}

#[test]
fn the_farm_makes_the_same_frames() {
    let folder = folder();
    folder.succeed(&format!("render orbit.txt --frames 3..4 -o own.#.png {HOW}"));
    folder.succeed(&format!("render orbit.txt --frames 3..4 -o farm.#.png --farm local:2 {HOW}"));
    for k in [3, 4] {
        assert_eq!(folder.read(&format!("farm.{k}.png")), folder.read(&format!("own.{k}.png")));
    }
    folder.fail(&format!("plan orbit.txt --frames 3..4 -o farm.#.png {HOW}"), 2, &["one frame at a time"]);
}

#[test]
fn names_that_would_be_written_over_are_refused() {
    let folder = folder();
    let fails = |line: &str, said: &[&str]| {
        folder.fail(&format!("render orbit.txt {line} {HOW}"), 2, said);
    };
    fails("--frames 1..3 -o out.png", &["each of 3 frames would write over `out.png`", "out.####.png"]);
    fails("--frames 1..3 -o out.#.png --aov depth=d.png", &["would write over `d.png`"]);
    fails("--frames 1..3 -o out.#.png --checkpoint state", &["would write over `state`"]);
    fails("--frames 1..3 -o -", &["standard output"]);
    fails("--frames 1..12 -o f#2.png --aov depth=f1#.png", &["which is a picture of frame"]);
    fails("--frames 1..3 -o #.#.png", &["two places for the number"]);
    fails(
        "--frames 1..3 -o out.#.png --resume state",
        &["`--resume` goes on with the render of one picture"],
    );
    fails("--frames 1..3 -o out.#.png --farm tls://head:8786", &["a cluster renders one frame a command"]);
    fails("--frames 9..3 -o out.#.png", &["comes before the first one"]);
    fails("--frames 1..3 -o out.#.png --fps -24", &["--fps"]);
    fails("--frames 1..3 -o out.#.png --fps 0", &["--fps"]);
    fails("-o out.png --keep-frames", &["--frames"]);
    folder.fail("render ball.txt --frames all -o out.#.png", 2, &["does not say which frames it has"]);
    assert!(folder.names().iter().all(|name| !name.starts_with("out")), "{:?}", folder.names());
}

#[test]
fn mistakes_name_their_frame() {
    let folder = folder();
    folder.write(
        "bad.txt",
        ORBIT.replace("radius keys loop pingpong { 0: 0.5  0.5: 1 }", "radius 0.1 / (0.25 - time)"),
    );
    let ran = folder.fail(&format!("render bad.txt --frames 1..4 -o b.#.png {HOW}"), 2, &["frame 3"]);
    assert!(ran.stderr.contains("division by zero"), "{}", ran.stderr);
    let made = folder.names();
    assert!(made.contains(&"b.2.png".to_owned()) && !made.contains(&"b.3.png".to_owned()), "{made:?}");
}

/// A program in the place of ffmpeg, which joins the names of the pictures.
const JOINER: &str = "#!/bin/sh
[ \"$1\" = -version ] && exit 0
while [ $# -gt 1 ]; do [ \"$1\" = -i ] && list=$2; shift; done
grep -c ^file \"$list\" > \"$1\"
grep ^duration \"$list\" | sort -u >> \"$1\"
";

#[test]
fn a_video_is_made_where_ffmpeg_is() {
    let folder = folder();
    folder.write("bin/ffmpeg", JOINER);
    std::fs::set_permissions(folder.path("bin/ffmpeg"), std::fs::Permissions::from_mode(0o755)).unwrap();
    let line = format!("render orbit.txt --frames 1..3 -o film.mp4 {HOW}");
    let path = format!("PATH={}:$PATH", folder.path("bin").display());
    let ran = folder.run_in_shell(&path, &line);
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    assert_eq!(folder.read("film.mp4"), b"3\nduration 0.125000000\n");
    assert!(!folder.path("film.mp4.frames").exists());
    // One that fails leaves the pictures, and one that is not there is said to be missing.
    folder.write("bin/ffmpeg", "#!/bin/sh\n[ \"$1\" = -version ] && exit 0\necho no codec >&2\nexit 1\n");
    let ran = folder.run_in_shell(&path, &line.replace("film.mp4", "other.webm"));
    assert_eq!(ran.code, Some(5), "{}", ran.stderr);
    assert!(ran.stderr.contains("no codec") && folder.path("other.webm.frames/000003.png").exists());
    let ran = folder.run_in_shell("PATH=/nowhere", &line);
    assert_eq!(ran.code, Some(2));
    assert!(
        ran.stderr.contains("apt install ffmpeg") && ran.stderr.contains("film.####.png"),
        "{}",
        ran.stderr
    );
}

/// A field of one colour, joined and taken apart again by the ffmpeg of this machine.
#[test]
fn a_video_has_the_colours_of_its_frames() {
    let is_there = Command::new("ffmpeg").arg("-version").output().is_ok_and(|ran| ran.status.success());
    if !is_there {
        eprintln!("skipped: ffmpeg is not installed");
        return;
    }
    let folder = folder();
    folder.write(
        "flat.txt",
        "PerspectiveCamera { center 0 0 5 direction 0 0 -1 up 0 1 0 angle 30 }
        Background { color 0.6 0.05 0.3 }
        Materials { Matte { color 1 1 1 } }
        Group { MaterialIndex 0 Sphere { center 0 100 0 radius 0.1 } }",
    );
    let how = "--integrator path --samples 1 --size 1280 721 --frames 1..3";
    for name in ["film.mp4", "film.webm"] {
        folder.succeed(&format!("render flat.txt {how} -o {name}"));
        folder.succeed(&format!("render flat.txt {how} -o still.#.png"));
        // As a player does that goes by the words of the file.
        let taken = Command::new("ffmpeg")
            .args(["-loglevel", "error", "-i", name, "-vf", "scale=in_color_matrix=auto", "taken.%d.png"])
            .current_dir(folder.path("."))
            .status();
        assert!(taken.is_ok_and(|status| status.success()), "{name}");
        assert!(folder.path("taken.3.png").exists() && !folder.path("taken.4.png").exists(), "{name}");
        let [still, taken] = ["still.2.png", "taken.2.png"].map(|png| picture(&folder.path(png)).rgb(9, 9));
        for (a, b) in still.into_iter().zip(taken) {
            assert!((a - b).abs() <= 4.0 / 255.0, "{name}: {still:?} {taken:?}");
        }
    }
}
