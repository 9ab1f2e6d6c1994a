//! Want of memory ends with code 6 and a reason, wherever it comes up.
#![cfg(target_os = "linux")]

mod common;

use std::fmt::Write as _;
use std::process::{Command, Stdio};

use common::{Folder, Ran};

/// A scene with some of everything that takes memory: a picture, a mesh, instances, lights.
const SCENE: &str = "\
PerspectiveCamera { center 0 1 9  direction 0 -0.1 -1  up 0 1 0  angle 30 }
Lights { DirectionalLight { direction -1 -1 -1  color 0.9 0.9 0.9 } }
Materials { Matte skin { color skin.ppm }  Matte grey { color 0.5 0.5 0.5 }  Matte emitter { emission 1 1 1 } }
Group {
  MaterialIndex grey  TriangleMesh { file waves.obj }
  MaterialIndex emitter  Transform { Translate 0 2 0  TriangleMesh { file waves.obj } }
  Define ball { MaterialIndex skin  Sphere { center 0 0 0  radius 0.1 } }
  Instance ball
  Transform { Translate 1 0 0  Instance ball }
}
";

/// With the scene and its files, of some megabytes in memory.
fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("scene.txt", SCENE);
    let mut skin = b"P6\n1000 1000\n255\n".to_vec();
    skin.resize(skin.len() + 3_000_000, 128);
    folder.write("skin.ppm", skin);
    let (side, mut waves) = (60, String::new());
    for i in 0..side * side {
        let (x, y) = (f64::from(i % side) / 30.0 - 1.0, f64::from(i / side) / 30.0 - 1.0);
        writeln!(waves, "v {x} {} {y}", 0.1 * (9.0 * x * y).sin()).unwrap();
    }
    for i in (1..side * (side - 1)).filter(|i| i % side != 0) {
        writeln!(waves, "f {} {} {}\nf {} {} {}", i, i + 1, i + side, i + 1, i + side + 1, i + side).unwrap();
    }
    folder.write("waves.obj", waves);
    folder
}

/// Runs the program with at most so much address space.
fn within(folder: &Folder, megabytes: u32, line: &str) -> Ran {
    let script = format!("ulimit -v {}; exec \"$0\" {line}", megabytes * 1024);
    let mut command = Command::new("sh");
    command.args(["-c", &script, env!("CARGO_BIN_EXE_kajo")]);
    command.current_dir(folder.path("")).stdin(Stdio::null()).env("NO_COLOR", "1");
    Ran::from(command.output().unwrap())
}

/// The least address space, in megabytes, in which the program starts at all: below it the system's loader speaks.
fn least(folder: &Folder) -> u32 {
    let starts = |&megabytes: &u32| within(folder, megabytes, "--version").code == Some(0);
    (16..=512).step_by(8).find(starts).expect("it starts within half a gigabyte")
}

#[test]
fn any_bound_on_the_address_space_ends_in_a_picture_or_in_code_6() {
    let folder = folder();
    let least = least(&folder).max(32);
    let runs = if std::env::var_os("KAJO_DEEP").is_some() { 50 } else { 4 };
    let lines = [
        "render scene.txt -o out.png --quiet --size 300 200 --samples 1",
        "render scene.txt -o out.exr --quiet --size 200 200 --samples 4 --integrator path --denoise --threads 8",
        "check scene.txt",
        "diff skin.ppm skin.ppm",
    ];
    for line in lines {
        for i in 0..runs {
            // Small bounds are the interesting ones.
            let share = f64::from(i) / f64::from(runs);
            let megabytes = least + (f64::from(1024 - least) * share * share) as u32;
            let _ = std::fs::remove_file(folder.path("out.png"));
            let ran = within(&folder, megabytes, line);
            let ends = matches!(ran.code, Some(0 | 2 | 6));
            assert!(ends, "{megabytes} MB: kajo {line}\n{:?}\n{}{}", ran.code, ran.stdout, ran.stderr);
            assert!(
                ran.code == Some(0) || !ran.stderr.is_empty(),
                "{megabytes} MB: kajo {line} says nothing"
            );
            assert!(!ran.stderr.contains("bug in kajo"), "{megabytes} MB: kajo {line}\n{}", ran.stderr);
        }
    }
}

#[test]
fn one_budget_holds_for_the_whole_scene() {
    let folder = folder();
    folder.succeed("render scene.txt -o out.png --quiet --size 30 20 --memory 100");
    // Each fits, and all of them do not.
    let pictures: String = (0..4).map(|i| format!("Matte {{ color skin{i}.ppm }} ")).collect();
    (0..4).for_each(|i| folder.write(&format!("skin{i}.ppm"), folder.read("skin.ppm")));
    let sphere = "MaterialIndex 0 Sphere { center 0 0 0 radius 1 }";
    let camera = SCENE.lines().next().unwrap();
    folder.write("four.txt", format!("{camera}\nMaterials {{\n{pictures}\n}}\nGroup {{ {sphere} }}"));
    folder.succeed("render four.txt -o four.png --quiet --size 30 20 --memory 100");
    let said = &["four.txt:3:", "cannot read `skin", "it needs", "of memory", "not enough memory"];
    folder.fail("render four.txt -o none.png --quiet --size 30 20 --memory 34", 6, said);
    // What the scene takes is not there for the film.
    folder.fail("render scene.txt -o none.png --size 1000 1000 --memory 45", 6, &["1000 x 1000", "needs"]);
    folder.succeed("render ball.txt -o out.png --quiet --size 1000 1000 --samples 1 --memory 45");
    assert!(!folder.names().contains(&"none.png".to_owned()));
}

#[test]
fn instances_are_counted_before_they_are_made() {
    let folder = Folder::new();
    let mut text = common::BALL.split("Group").next().unwrap().to_owned();
    text += "Group { MaterialIndex gold Define d0 { Sphere { center 0 0 0 radius 1 } }\n";
    for i in 1..=22 {
        let before = i - 1;
        let moved = |x: f64| {
            format!(
                "Transform {{ Motion {{ key 0 {{ }} key 1 {{ Translate {x} 0 0 }} }} Instance d{before} }}"
            )
        };
        writeln!(text, "Define d{i} {{ {} {} }}", moved(1.0), moved(2.0)).unwrap();
    }
    folder.write("levels.txt", text + "Instance d22 }");
    let said = &["levels.txt:", "no memory for the objects", "of memory", "not enough memory"];
    folder.fail("render levels.txt -o none.png --memory 200", 6, said);
}

#[test]
fn materials_and_models_are_counted_as_they_are_read() {
    let folder = Folder::new();
    let [camera, _] = common::BALL.split_once("Materials").map(|(camera, rest)| [camera, rest]).unwrap();
    let materials = "Principled { }\n".repeat(60_000);
    let ball = "Group { MaterialIndex 0 Sphere { center 0 0 0 radius 1 } }";
    folder.write("many.txt", format!("{camera} Materials {{\n{materials}}}\n{ball}"));
    let said = &["many.txt:", "no memory for the materials", "not enough memory"];
    folder.fail("render many.txt -o none.png --size 30 20 --samples 1 --memory 50", 6, said);
    let libraries: String = (0..60_000).map(|i| format!("newmtl m{i}\nPr 1\n")).collect();
    let uses: String = (0..60_000).map(|i| format!("usemtl m{i}\nf 1 2 3\n")).collect();
    folder.write("many.mtl", libraries);
    folder.write("many.obj", format!("mtllib many.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n{uses}"));
    folder.fail(
        "render many.obj -o none.png --size 30 20 --samples 1 --memory 30",
        6,
        &["not enough memory"],
    );
    // Three bytes each in the file.
    let nodes = vec!["{}"; 300_000].join(",");
    folder.write("many.gltf", format!(r#"{{"asset":{{"version":"2.0"}},"nodes":[{nodes}]}}"#));
    folder.fail("render many.gltf -o none.png --memory 100", 6, &["many.gltf", "needs", "not enough memory"]);
    let materials = vec!["{}"; 300_000].join(",");
    folder.write("many.gltf", format!(r#"{{"asset":{{"version":"2.0"}},"materials":[{materials}]}}"#));
    folder.fail("render many.gltf -o none.png --memory 100", 6, &["many.gltf", "needs", "not enough memory"]);
}
