//! Models without a scene, cameras by name, parts of pictures, and files of other programs.

mod common;

use common::Folder;
use kajo::Image;

const TETRAHEDRON: &str = "v 0 0 0\nv 0.01 0 0\nv 0 0.01 0\nv 0 0 0.01\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

fn picture(folder: &Folder, name: &str) -> Image {
    kajo::compare::read_picture(&folder.path(name)).unwrap().image
}

#[test]
fn a_model_is_shown_without_a_scene() {
    let folder = Folder::new();
    folder.write("thing.obj", TETRAHEDRON);
    folder.succeed("thing.obj --size 40 30 --samples 4");
    let image = picture(&folder, "thing.png");
    let corner = image.pixel(0, 0).to_vec();
    let differs = |x: u32, y: u32| image.pixel(x, y).iter().zip(&corner).any(|(a, b)| (a - b).abs() > 0.05);
    assert!((10..30).any(|x| differs(x, 15)), "something is in the middle");
    let edges = (0..40).flat_map(|x| [(x, 0), (x, 29)]).chain((0..30).flat_map(|y| [(0, y), (39, y)]));
    assert!(edges.into_iter().all(|(x, y)| !differs(x, y)), "and nothing at the edges");
    // What kajo wrote it writes again, and nothing else.
    folder.succeed("render thing.obj --size 8 6 --samples 1 --up -z --ground");
    folder.write("thing.png", "a texture");
    folder.fail("thing.obj --size 8 6", 2, &["`thing.png` is there already", "-o FILE"]);
    folder.succeed("info thing.obj");
}

#[test]
fn a_model_becomes_a_scene_to_go_on_with() {
    let folder = Folder::new();
    folder.write("parts/thing.obj", TETRAHEDRON);
    folder.succeed("convert parts/thing.obj scene.txt --ground");
    let text = String::from_utf8(folder.read("scene.txt")).unwrap();
    for word in ["file \"parts/thing.obj\"", "fit       scene", "Plane ground", "# "] {
        assert!(text.contains(word), "{word}: {text}");
    }
    folder.succeed("scene.txt --size 8 6 --samples 1 -o a.png");
    folder.succeed("parts/thing.obj --ground --size 8 6 --samples 1 -o b.png");
    assert_eq!(folder.read("a.png"), folder.read("b.png"));
    folder.fail("convert parts/thing.obj scene.txt", 2, &["`scene.txt` is there already", "--force"]);
    folder.succeed("convert parts/thing.obj scene.txt --force");
    folder.fail("convert ball.txt other.txt", 2, &["`ball.txt` is a scene already"]);
    folder.fail("convert none.glb", 2, &["none.glb"]);
    assert!(folder.succeed("convert parts/thing.obj -").stdout.contains("PerspectiveCamera view"));
}

#[test]
fn a_part_of_a_picture_is_that_of_the_whole() {
    let folder = Folder::new();
    for more in ["", " --filter mitchell", " --integrator path --samples sobol 4"] {
        folder.succeed(&format!("ball.txt --size 40 30 -o all.exr{more}"));
        folder.succeed(&format!("ball.txt --size 40 30 --crop 7 5 20 11 -o part.exr{more}"));
        let (all, part) = (picture(&folder, "all.exr"), picture(&folder, "part.exr"));
        assert_eq!([part.width(), part.height()], [20, 11]);
        for (x, y) in (0..11).flat_map(|y| (0..20).map(move |x| (x, y))) {
            assert_eq!(part.pixel(x, y), all.pixel(x + 7, y + 5), "{more}: {x} {y}");
        }
    }
    folder.fail("ball.txt --size 40 30 --crop 30 0 11 5", 2, &["reaches beyond the picture of 40 x 30"]);
    folder.fail("ball.txt --size 40 30 --crop 3 0 0 5", 2, &["reaches beyond"]);
}

#[test]
fn cameras_are_chosen_by_name() {
    let folder = Folder::new();
    let scene = common::BALL.replacen("PerspectiveCamera", "PerspectiveCamera near", 1);
    folder.write("two.txt", scene + "PerspectiveCamera far { fit ball 0.4 }");
    folder.succeed("two.txt --size 8 6 --samples 1 -o last.png");
    folder.succeed("two.txt --size 8 6 --samples 1 -o far.png --camera far");
    folder.succeed("two.txt --size 8 6 --samples 1 -o near.png --camera near");
    assert_eq!(folder.read("last.png"), folder.read("far.png"));
    assert_ne!(folder.read("last.png"), folder.read("near.png"));
    folder.fail("two.txt --camera nera", 2, &["no camera named `nera`", "`near`, `far`"]);
}

#[test]
fn files_of_other_programs_are_told_from_scenes() {
    let folder = Folder::new();
    let read = ["scene text", "glTF 2.0", "OBJ", "PLY", "STL"];
    for (name, content, what) in [
        ("a.pbrt", "LookAt 0 0 5 0 0 0 0 1 0\nCamera \"perspective\"\nWorldBegin\n", "a scene of pbrt"),
        ("a.xml", "<?xml version=\"1.0\"?>\n<scene version=\"3.0.0\">", "a scene of Mitsuba"),
        ("a.blend", "BLENDER-v402", "a Blender file"),
        ("scene.txt", "#usda 1.0\n", "a USD stage"),
        ("a.fbx", "Kaydara FBX Binary  \0", "an FBX file"),
        ("a.glb", "glTF\u{1}\0\0\0", "a glTF 1.0 file"),
    ] {
        folder.write(name, content);
        let said: Vec<&str> = [what].into_iter().chain(read).collect();
        folder.fail(name, 2, &said);
    }
    folder.write(
        "mesh.txt",
        common::BALL.replace("Sphere ball {", "TriangleMesh { file a.fbx } Sphere ball {"),
    );
    folder.fail("mesh.txt", 2, &["this is an FBX file"]);
    folder.write("empty.txt", "");
    folder.fail("empty.txt", 2, &["`empty.txt` is empty"]);
    folder.fail("-input empty.txt -output a.png", 2, &["`empty.txt` is empty"]);
    folder.write("comments.txt", "# nothing\n// at all\n");
    folder.fail("comments.txt", 2, &["`comments.txt` is empty"]);
    folder.write("hex.txt", common::BALL.replace("diffuseColor 0.5 0.5 0.5", "diffuseColor #ff0000"));
    folder.fail("hex.txt", 2, &["`#ff0000` is a comment", "`diffuseColor 1 0 0`"]);
}
