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

/// `docs/src/program/checkpoints.md`, "More samples".
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
