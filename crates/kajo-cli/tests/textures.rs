//! Pictures by tiles, and the command that keeps their copies.

mod common;

use common::Folder;
use kajo::{EncodeOptions, Format, Image, encode};

/// A wall with one picture of 600 x 400 texels, and a small one.
fn wall() -> Folder {
    let folder = Folder::new();
    let picture = |n: u32, width, height| {
        let image = Image::from_fn(width, height, |x, y| {
            [(x * n % 17) as f32 / 16.0, (y * n % 13) as f32 / 12.0, (x + y) as f32 / (width + height) as f32]
        });
        encode(&image.unwrap(), Format::Png, &EncodeOptions::default()).unwrap()
    };
    folder.write("large.png", picture(3, 600, 400));
    folder.write("small.png", picture(5, 20, 30));
    folder.write(
        "wall.txt",
        "PerspectiveCamera { center 0 0 4  direction 0 0 -1  up 0 1 0  angle 40 }
         Lights { PointLight { position 0 1 4  color 1 1 1 } }
         Materials { Matte { color large.png { filter ewa  repeat 3 } } Matte { color small.png  roughness large.png { encoding linear } } }
         Group { MaterialIndex 0 Quad { corner -1 -1 0  edge1 1 0 0  edge2 0 2 0 }
                 MaterialIndex 1 Quad { corner 0 -1 0  edge1 1 0 0  edge2 0 2 0 } }",
    );
    folder
}

const RENDER: &str = "render wall.txt --size 60 40 --samples 4 --texture-folder tiles";

#[test]
fn the_same_picture_comes_from_tiles() {
    let folder = wall();
    folder.succeed(&format!("{RENDER} -o whole.png"));
    assert!(!folder.path("tiles").exists(), "all fits");
    folder.succeed(&format!("{RENDER} -o a.png --texture-memory 1"));
    folder.succeed(&format!("{RENDER} -o b.png --texture-memory 1 --threads 3"));
    assert!(
        folder.read("a.png") == folder.read("whole.png") && folder.read("b.png") == folder.read("whole.png")
    );
    // Colours by the file, numbers as amounts: two copies of one picture.
    let copies = || {
        let files = std::fs::read_dir(folder.path("tiles")).unwrap().map(|file| file.unwrap().path());
        files.filter(|path| path.extension().is_some_and(|ending| ending == "ktile")).collect::<Vec<_>>()
    };
    assert_eq!(copies().len(), 2);
    // In the middle of its tiles a copy is damaged: it is made anew.
    for path in copies() {
        let mut bytes = std::fs::read(&path).unwrap();
        bytes[40..80].fill(0x55);
        std::fs::write(&path, bytes).unwrap();
    }
    folder.succeed(&format!("{RENDER} -o c.png --texture-memory 1"));
    assert!(folder.read("c.png") == folder.read("whole.png"));
}

#[test]
fn a_changed_picture_has_another_copy() {
    let folder = wall();
    folder.succeed(&format!("{RENDER} -o a.png --texture-memory 1"));
    let image = Image::filled(600, 400, &[0.5, 0.2, 0.9]).unwrap();
    folder.write("large.png", encode(&image, Format::Png, &EncodeOptions::default()).unwrap());
    folder.succeed(&format!("{RENDER} -o b.png --texture-memory 1"));
    folder.succeed(&format!("{RENDER} -o whole.png"));
    assert!(folder.read("b.png") == folder.read("whole.png") && folder.read("a.png") != folder.read("b.png"));
}

#[test]
fn copies_are_made_listed_and_removed() {
    let folder = wall();
    folder.succeed("texture make large.png --texture-folder tiles");
    folder.succeed("texture make large.png --encoding linear --texture-folder tiles");
    let listed = folder.succeed("texture list --texture-folder tiles").stdout;
    assert_eq!(listed.matches("large.png-").count(), 2, "{listed}");
    folder.write("tiles/notes.txt", "mine");
    folder.succeed("texture clear --texture-folder tiles");
    let listed = folder.succeed("texture list --texture-folder tiles").stdout;
    assert!(!listed.contains("large.png") && folder.path("tiles/notes.txt").exists(), "{listed}");
    folder.fail("texture make small.png --texture-folder tiles", 2, &["small.png", "always in memory"]);
    folder.fail("texture make wall.txt none.png --texture-folder tiles", 2, &["wall.txt", "none.png"]);
    folder.fail(&format!("{RENDER} -o a.png --texture-memory 0"), 2, &["texture-memory"]);
}

#[test]
fn a_folder_that_takes_no_copies_is_an_error() {
    let folder = wall();
    folder.write("file", "no folder");
    let line = "render wall.txt --size 60 40 -o a.png --texture-memory 1 --texture-folder file";
    folder.fail(line, 2, &["large.png", "tiled copy cannot be written"]);
    assert!(!folder.path("a.png").exists());
}
