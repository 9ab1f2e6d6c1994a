//! Wrong input of every kind ends with code 2, a message that helps, and no file.

mod common;

use common::{BALL, Folder};

/// Renders `text` as a scene and makes sure that it is refused.
fn refused(text: impl AsRef<[u8]>, said: &[&str]) {
    let folder = Folder::new();
    folder.write("scene.txt", text);
    folder.fail("-input scene.txt -output out.png", 2, said);
    folder.fail("scene.txt", 2, said);
    folder.fail("check scene.txt", 2, said);
    assert_eq!(folder.names(), ["ball.txt", "scene.txt"]);
}

#[test]
fn unknown_words_name_their_place_and_their_neighbour() {
    refused(
        BALL.replace("Sphere ball", "Sphre ball"),
        &["unknown word `Sphre`", "scene.txt:9:", "did you mean `Sphere`"],
    );
    refused(BALL.replace("radius", "raduis"), &["raduis", "did you mean `radius`"]);
    refused("Grup {}", &["scene.txt:1:1", "did you mean `Group`"]);
}

#[test]
fn all_mistakes_are_shown_at_once() {
    refused(
        BALL.replace("Sphere ball", "Sphre ball").replace("exponent 20", "exponent many"),
        &["Sphre", "exponent", "`scene.txt` has 2 errors"],
    );
}

#[test]
fn truncated_scenes_are_refused() {
    for end in [BALL.len() - 3, BALL.len() / 2, 30] {
        refused(&BALL[..end], &["error"]);
    }
}

#[test]
fn wrong_numbers_are_refused() {
    refused(BALL.replace("radius 1", "radius one"), &["radius"]);
    refused(BALL.replace("center 0 0 0", "center 0 0"), &["center"]);
    refused(BALL.replace("radius 1", "radius nan"), &["radius", "nan"]);
    refused(BALL.replace("radius 1", "radius 1e99"), &["radius"]);
    refused(BALL.replace("Materials {", "Materials { numMaterials 3"), &["numMaterials", "3"]);
    refused(BALL.replace("Group {", "Group { numObjects 1"), &["numObjects"]);
    refused(BALL.replace("MaterialIndex gold", "MaterialIndex 7"), &["7"]);
    refused(BALL.replace("MaterialIndex gold", "MaterialIndex godl"), &["godl", "gold"]);
}

#[test]
fn bytes_that_are_no_text_are_refused() {
    refused([0xff, 0xfe, b'G', 0], &["UTF-16"]);
    refused(b"Group \xc3\x28 {}", &["UTF-8"]);
    refused([0u8; 100], &["error"]);
    let noise: Vec<u8> = (0u32..4000).map(|i| (i.wrapping_mul(2_654_435_761) >> 13) as u8).collect();
    refused(noise, &["error"]);
}

#[test]
fn deep_nesting_is_refused() {
    refused("Group {".repeat(100_000), &["nest"]);
    refused(
        format!("{BALL} Group {{ {} {} }}", "Transform {".repeat(100_000), "}".repeat(100_000)),
        &["nest"],
    );
}

#[test]
fn features_to_come_are_named() {
    refused(
        BALL.replace("Sphere ball { center 0 0 0  radius 1 }", "RevSurface { }"),
        &["`RevSurface` is not supported yet"],
    );
}

#[test]
fn includes_that_include_themselves_are_refused() {
    let folder = Folder::new();
    folder.write("a.txt", "include \"b.txt\"");
    folder.write("b.txt", "include \"a.txt\"");
    folder.fail("check a.txt", 2, &["a.txt", "b.txt", "->"]);
    folder.write("me.txt", "include me.txt");
    folder.fail("check me.txt", 2, &["me.txt -> me.txt"]);
}

#[test]
fn doubling_includes_are_refused() {
    let folder = Folder::new();
    for level in 0..30 {
        let next = level + 1;
        folder.write(&format!("{level}.txt"), format!("include \"{next}.txt\" include \"{next}.txt\""));
    }
    folder.write("30.txt", "Group {}");
    folder.fail("check 0.txt", 2, &["include"]);
}

fn mesh_scene(name: &str) -> String {
    BALL.replace("Sphere ball { center 0 0 0  radius 1 }", &format!("TriangleMesh {{ obj_file {name} }}"))
}

#[test]
fn hostile_meshes_are_refused() {
    for (content, said) in [
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 99999999\n", "99999999"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n", "0"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf -4 -2 -1\n", "-4"),
        ("v 0 0\n", "mesh.obj:1"),
        ("v a b c\n", "mesh.obj:1"),
        ("v 0 0 0\nv 1 0 0\nf 1 x\n", "mesh.obj:3"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1//9 2//9 3//9\n", "9"),
    ] {
        let folder = Folder::new();
        folder.write("scene.txt", mesh_scene("mesh.obj"));
        folder.write("mesh.obj", content);
        folder.fail("scene.txt", 2, &[said, "mesh.obj"]);
        assert_eq!(folder.names(), ["ball.txt", "mesh.obj", "scene.txt"], "{content:?}");
    }
}

#[test]
fn missing_files_name_their_neighbour() {
    let folder = Folder::new();
    folder.write("scene.txt", mesh_scene("bunny_20.obj"));
    folder.write("bunny_200.obj", "");
    folder.fail("scene.txt", 2, &["no such file", "did you mean `bunny_200.obj`", "scene.txt:9:"]);
    folder.fail("scen.txt", 2, &["did you mean `scene.txt`"]);
    folder.fail("nowhere/scene.txt", 2, &["nowhere"]);
}

#[test]
fn names_that_climb_out_are_refused_unless_allowed() {
    let folder = Folder::new();
    folder.write("mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    folder.write("inside/x/y", "");
    let absolute = folder.path("mesh.obj").to_string_lossy().into_owned();
    for name in ["../mesh.obj", "x/../../mesh.obj", &absolute] {
        folder.write("inside/scene.txt", mesh_scene(&format!("\"{name}\"")));
        folder.fail("inside/scene.txt", 2, &["outside the scene's folder"]);
        folder.succeed("inside/scene.txt --allow-outside --size 4 4 -o out.png");
    }
    folder.write("inside/scene.txt", mesh_scene("../mesh.obj"));
    folder.succeed("inside/scene.txt --assets . --size 4 4 -o out.png");
    folder.write("inside/scene.txt", "include \"../ball.txt\"");
    folder.fail("check inside/scene.txt", 2, &["outside the scene's folder"]);
}

#[cfg(unix)]
#[test]
fn links_devices_and_pipes_are_refused() {
    let folder = Folder::new();
    folder.write("secret.obj", "v 0 0 0\n");
    folder.write("inside/scene.txt", mesh_scene("link.obj"));
    std::os::unix::fs::symlink("../secret.obj", folder.path("inside/link.obj")).unwrap();
    folder.fail("check inside/scene.txt", 2, &["outside the scene's folder"]);

    let pipe = folder.path("inside/pipe.obj");
    let made = std::process::Command::new("mkfifo").arg(&pipe).status().unwrap();
    assert!(made.success());
    folder.write("inside/scene.txt", mesh_scene("pipe.obj"));
    folder.fail("check inside/scene.txt", 2, &["not a regular file"]);
    folder.fail("check inside/pipe.obj", 2, &["not a regular file"]);
    folder.fail("check /dev/zero", 2, &["not a regular file"]);
    folder.fail("check inside", 2, &["not a regular file"]);
}

#[test]
fn absurd_sizes_are_refused_with_the_memory_they_need() {
    let folder = Folder::new();
    folder.fail("-input ball.txt -output a.png -size 1000000000 1000000000", 6, &["needs", "EB"]);
    folder.fail("ball.txt --size 4294967295 4294967295", 6, &["needs"]);
    folder.fail("ball.txt --size 1000 1000 --memory 1", 6, &["needs 40.0 MB", "kB can be had"]);
    folder.fail("ball.txt --size 0 10", 2, &["width and height"]);
    folder.fail("-input ball.txt -size -5 10", 2, &["width and height"]);
    folder.fail("-input ball.txt -size 99999999999 10", 2, &["width and height"]);
    folder.write("scene.txt", format!("{BALL} Settings {{ size 0 10 }}"));
    folder.fail("scene.txt", 2, &["size"]);
    assert_eq!(folder.names(), ["ball.txt", "scene.txt"]);
}

#[test]
fn wrong_command_lines_are_explained() {
    let folder = Folder::new();
    folder.fail("-input ball.txt -shadow", 2, &["no option `-shadow`", "`-shadows`"]);
    folder.fail("ball.txt --bounce 3", 2, &["no option `--bounce`", "`--bounces`"]);
    folder.fail("-input ball.txt -bounces 1001", 2, &["1001"]);
    folder.fail("-input ball.txt -weight -1", 2, &["weight"]);
    folder.fail("-input ball.txt -depth 0 near d.png", 2, &["-depth", "near"]);
    folder.fail("-input ball.txt -depth 0 1", 2, &["depth"]);
    folder.fail("-input ball.txt -tent_filter 0", 2, &["tent_filter"]);
    folder.fail("-input ball.txt -output a.jpg", 2, &["a.jpg", ".png"]);
    folder.fail("ball.txt -o picture", 2, &["picture", ".png"]);
    folder.fail("ball.txt --aov death=d.png", 2, &["depth"]);
    folder.fail("ball.txt --aov depth", 2, &["OpenEXR"]);
    folder.fail("ball.txt --samples random 4", 2, &["samples"]);
    folder.fail("ball.txt --dialect mit", 2, &["mit-2004"]);
    folder.fail("", 2, &["Usage"]);
    assert_eq!(folder.names(), ["ball.txt"]);
}
