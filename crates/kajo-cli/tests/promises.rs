//! What the manual promises about refusals and checkpoints and no other test of the program looks at.

mod common;

use common::{BALL, Folder};

/// `docs/src/program/errors.md`, "Things that are refused".
#[test]
fn texts_that_the_manual_calls_wrong_are_refused() {
    let folder = Folder::new();
    let nested =
        |levels: usize| format!("{BALL} Group {{ {}{} }}", "Transform {".repeat(levels), "}".repeat(levels));
    for (text, said) in [
        (format!("{BALL} /* never closed"), "comment"),
        (BALL.replace("Sphere ball", "Sphere \"ball"), "string"),
        (format!("{BALL} }}"), "}"),
        (BALL.trim_end().trim_end_matches('}').to_owned(), "`{` has no `}`"),
        (nested(256), "nest"),
        (BALL.replace("radius 1", "radius inf"), "inf"),
        (BALL.replace("radius 1", "radius 1e39"), "radius"),
        (BALL.replace("center 0 0 0", "center 0 -1e39 0"), "center"),
    ] {
        folder.write("scene.txt", text);
        folder.fail("scene.txt", 2, &["error", said]);
        assert_eq!(folder.names(), ["ball.txt", "scene.txt"], "nothing is written");
    }
    let only_group =
        |levels: usize| format!("Group {{ {}{} }}", "Transform {".repeat(levels), "}".repeat(levels));
    folder.write("scene.txt", BALL.split("Group").next().unwrap().to_owned() + &only_group(250));
    folder.succeed("check scene.txt");
}

#[test]
fn includes_may_be_thirty_two_deep_and_no_deeper() {
    let folder = Folder::new();
    for level in 1..40 {
        folder.write(&format!("{level}.txt"), format!("include \"{}.txt\"", level + 1));
    }
    folder.write("40.txt", BALL);
    folder.fail("check 1.txt", 2, &["include"]);
    folder.fail("check 7.txt", 2, &["include"]);
    folder.succeed("check 9.txt");
}

/// The numbers of `errors.md` and `docs/src/language/instance.md`.
#[test]
fn bounds_are_those_of_the_manual() {
    let limits = kajo::Limits::default();
    assert_eq!((limits.nesting, limits.include_depth), (256, 32));
    assert_eq!((limits.items, limits.objects, limits.objects / 16), (10_000_000, 10_000_000, 625_000));
    let giga = 1 << 30;
    assert_eq!(
        (limits.picture_bytes, limits.model_bytes, limits.mesh_bytes),
        (2 * giga, 8 * giga, 64 * giga)
    );
}

/// `docs/src/language/instance.md`: a tree in two colours is two instances, and each object has its number.
#[test]
fn instances_are_numbered_in_the_order_of_the_file() {
    let folder = Folder::new();
    let group = "Group {
        Define pair { Sphere { center -2 0 0 radius 1 } Sphere { center 2 0 0 radius 1 } }
        MaterialIndex gold   Instance pair { Translate 0 1 0 }
        MaterialIndex floor  Instance pair { Translate 0 -2 0 }
    }";
    folder.write("scene.txt", BALL.split("Group").next().unwrap().to_owned() + group);
    folder.succeed(
        "scene.txt --size 40 40 --samples 1 --layers object,material -o out.exr --aov object=ids.pfm",
    );
    folder.succeed("scene.txt --size 40 40 --samples 1 -o color.png --aov material=materials.pfm");
    let numbers = |name: &str| {
        let mut found: Vec<u32> =
            common::picture(&folder.path(name)).data().iter().map(|&id| id as u32).collect();
        found.sort_unstable();
        found.dedup();
        found
    };
    assert_eq!(numbers("ids.pfm"), [0, 1, 2, 3, 4]);
    assert_eq!(numbers("materials.pfm"), [0, 1, 2]);
}

/// A scene that shows the objects of a group.
fn of_group(group: &str) -> String {
    format!("{} Group {{ {group} }}", BALL.split("Group").next().unwrap())
}

const PEARL: &str = "Sphere { center 0 0 0  radius 0.1 }";

/// `docs/src/language/instance.md`: `numObjects` counts an instance as one object and a definition as none.
#[test]
fn an_instance_counts_as_one_object_and_a_definition_as_none() {
    let folder = Folder::new();
    let pair = |inside: u32, outside: u32| {
        let define = format!("Define pair {{ numObjects {inside} {PEARL} {PEARL} }}");
        of_group(&format!(
            "numObjects {outside} MaterialIndex gold {define} Instance pair Instance pair {PEARL}"
        ))
    };
    folder.write("scene.txt", pair(2, 3));
    folder.succeed("check scene.txt");
    for (inside, outside) in [(2, 5), (2, 4), (1, 3)] {
        folder.write("scene.txt", pair(inside, outside));
        folder.fail("check scene.txt", 2, &["numObjects"]);
    }
}

/// The same page: where the instances of a definition would be more than a sixteenth of all objects that there may be,
/// the definition becomes a tree of its own.
#[test]
fn what_makes_many_objects_is_nested() {
    let nested = |instances: usize| {
        let define = format!("Define bush {{ {} }}", PEARL.repeat(100));
        let text = of_group(&format!("MaterialIndex gold {define} {}", "Instance bush ".repeat(instances)));
        let assets = kajo::MemoryAssets::new().with("scene.txt", text);
        let limits = kajo::Limits { objects: 16 * 1000, ..kajo::Limits::default() };
        let loaded =
            kajo::load_from("scene.txt", &assets, &kajo::LoadOptions { limits, ..Default::default() });
        let info = kajo::SceneInfo::of(&loaded).unwrap();
        (info.objects.len(), info.nested_objects)
    };
    assert_eq!(nested(10), (1000, 0));
    assert_eq!(nested(11), (0, 1100));
}

/// The same page: a thousand groves of a thousand trees of a thousand leaves, and what may not be nested.
#[test]
fn forests_take_little_memory_and_may_neither_shine_nor_move() {
    let folder = Folder::new();
    let row = |word: &str| format!("Instance {word} {{ Translate 1 0 0 }}\n").repeat(1000);
    let tree = format!("Define tree {{ {} }}", PEARL.repeat(1000));
    let grove = format!("Define grove {{ {} }}", row("tree"));
    folder.write("scene.txt", of_group(&format!("{tree} {grove} MaterialIndex gold {}", row("grove"))));
    let said = folder.succeed("info scene.txt").stdout;
    let field = |name: &str| {
        let line = said.lines().find(|line| line.starts_with(name)).unwrap_or_else(|| panic!("{said}"));
        line.split_whitespace().find_map(|word| word.parse::<f64>().ok()).unwrap()
    };
    assert_eq!(field("nested objects"), 1e9);
    assert!(field("geometry") < 2.0, "{said}");
    let light = "Materials { Matte emitter { emission 1 1 1 }";
    let motion = "Motion { key 0 { } key 1 { Translate 1 0 0 } }";
    for (placed, message) in [
        ("MaterialIndex emitter Instance grove", "make lights of 1000000 objects"),
        (&*format!("MaterialIndex gold Instance grove {{ {motion} }}"), "move 1000000 objects"),
    ] {
        let scene = of_group(&format!("{tree} {grove} {placed}"));
        folder.write("scene.txt", scene.replace("Materials {", light));
        folder.fail("check scene.txt", 2, &["error", message]);
    }
    let forests = "Instance forest ".repeat(5);
    let forest = format!("Define forest {{ {} }}", row("grove"));
    folder.write("scene.txt", of_group(&format!("{tree} {grove} {forest} MaterialIndex gold {forests}")));
    folder.fail("check scene.txt", 2, &["more objects than can be numbered, about 4 * 10^9"]);
}

/// Sparse files, which take no room.
#[test]
fn files_that_are_too_long_are_refused_before_they_are_read() {
    let folder = Folder::new();
    let giga = 1_u64 << 30;
    for (name, block, gigabytes) in [
        ("big.png", "MaterialIndex paper Sphere { center 0 0 0 radius 1 }", 2),
        ("big.glb", "Model { file big.glb }", 8),
        ("big.obj", "MaterialIndex gold TriangleMesh { obj_file big.obj }", 64),
        ("big.ply", "MaterialIndex gold TriangleMesh { file big.ply }", 64),
    ] {
        let file = std::fs::File::create(folder.path(name)).unwrap();
        if file.set_len(gigabytes * giga + 1).is_err() {
            println!("skipped: no file of {gigabytes} GiB can be made here");
            continue;
        }
        let materials = match name {
            "big.png" => "Materials { Matte paper { color big.png }",
            _ => "Materials {",
        };
        let group = format!("Group {{ {block}");
        folder.write("scene.txt", BALL.replace("Materials {", materials).replace("Group {", &group));
        let bytes = (gigabytes * giga).to_string();
        folder.fail("scene.txt", 2, &[name, &bytes]);
    }
}

#[test]
fn warnings_do_not_stop_a_render() {
    let folder = Folder::new();
    folder.write(
        "scene.txt",
        BALL.replace(
            "Group {",
            "Group { MaterialIndex gold Triangle { vertex0 0 0 0 vertex1 1 0 0 vertex2 2 0 0 }",
        ),
    );
    let ran = folder.succeed("scene.txt --size 4 4 -o out.png");
    assert!(ran.stderr.contains("warning: "), "{}", ran.stderr);
}

/// `docs/src/program/checkpoints.md`, "Where samples go".
#[test]
fn patterns_of_a_fixed_number_are_not_adaptive() {
    let folder = Folder::new();
    for pattern in ["cmj", "jittered", "regular", "poisson"] {
        let line = format!("ball.txt --size 8 8 --samples {pattern} 16 --adaptive -o a.png");
        folder.fail(&line, 2, &[pattern, "sobol"]);
    }
    for pattern in ["uniform", "sobol", "zsobol", "pmj"] {
        folder.succeed(&format!("ball.txt --size 8 8 --samples {pattern} 16 --adaptive -o a.png"));
    }
}

/// The same page, "Checkpoints": a state that cannot be written where it belongs is put elsewhere, whole.
#[cfg(unix)]
#[test]
fn a_state_whose_folder_is_gone_is_put_elsewhere() {
    use std::io::{BufRead, BufReader, Read};
    let folder = Folder::new();
    std::fs::create_dir(folder.path("states")).unwrap();
    let render = "ball.txt --size 20 20 --samples sobol 1000000 -o a.exr";
    let line = format!("{render} --checkpoint states/a.state --time 1 --show_progress");
    let mut command = folder.command();
    let mut child = command.args(line.split(' ')).stderr(std::process::Stdio::piped()).spawn().unwrap();
    let mut stderr = BufReader::new(child.stderr.take().unwrap());
    let mut said = String::new();
    stderr.read_line(&mut said).unwrap();
    std::fs::remove_dir(folder.path("states")).unwrap();
    stderr.read_to_string(&mut said).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(5), "{said}");
    assert!(folder.path("a.exr").exists(), "the picture is written in any case");
    let (_, after) = said.split_once("; it is in `").unwrap_or_else(|| panic!("{said}"));
    let place = after.split('`').next().unwrap();
    assert!(place.starts_with("a.kajo-") && place.ends_with(".state"), "{said}");
    folder.succeed(&format!("{render} --time 0 --resume {place}"));
}

/// The same page, "More samples".
#[test]
fn what_the_scene_says_about_samples_is_part_of_the_scene() {
    let folder = Folder::new();
    let scene = |samples: &str| folder.write("scene.txt", format!("{BALL} Settings {{ samples {samples} }}"));
    scene("sobol 4");
    folder.succeed("scene.txt --size 20 20 -o a.exr --checkpoint state");
    folder.succeed("scene.txt --size 20 20 -o b.exr --samples sobol 8 --resume state");
    scene("sobol 8");
    folder.fail(
        "scene.txt --size 20 20 -o c.exr --resume state",
        2,
        &["belongs to another render", "`scene "],
    );
    folder.succeed("scene.txt --size 20 20 -o c.exr");
    assert!(folder.read("b.exr") == folder.read("c.exr"));
}

#[test]
fn a_goal_for_noise_needs_what_it_goes_by() {
    let folder = Folder::new();
    let render = "ball.txt --size 20 20 --samples sobol 32 -o a.exr";
    let of_other = ["belongs to another render"];
    folder.succeed(&format!("{render} --checkpoint plain"));
    folder.fail(&format!("{render} --resume plain --noise 0.001"), 2, &of_other);
    folder.succeed(&format!("{render} --noise 0.9 --checkpoint noise"));
    folder.fail(&format!("{render} --resume noise"), 2, &of_other);
    let with_variance = format!("{render} --layers color,variance");
    folder.succeed(&format!("{with_variance} --checkpoint both"));
    folder.succeed(&format!("{with_variance} --resume both --noise 0.001"));
}

#[test]
fn exit_codes_are_those_of_the_manual() {
    let folder = Folder::new();
    folder.succeed("ball.txt --size 8 8 -o a.png");
    folder.succeed("ball.txt --size 8 8 -o b.png --seed 7 --bounces 0");
    folder.fail("diff a.png b.png --max-off 0 --share 0", 1, &[]);
    folder.fail("diff a.png nothing.png", 2, &[]);
    folder.fail("ball.txt --no-such-option", 2, &[]);
    folder.fail("ball.txt -o nowhere/a.png", 5, &[]);
    folder.fail("ball.txt --size 100000 100000 --memory 1", 6, &[]);
}
