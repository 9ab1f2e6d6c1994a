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

/// A square of glTF whose picture is within: its JSON and its buffer.
///
/// * `image`, `buffer`: what is said of the picture and of the buffer
fn painted_square(picture: &[u8], image: &str, buffer: &str) -> (String, Vec<u8>) {
    let corners = [[-1.0f32, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let positions = corners.iter().flat_map(|&[x, y]| [x, y, 0.0]);
    let uvs = corners.iter().flat_map(|&[x, y]| [0.5 + 0.5 * x, 0.5 - 0.5 * y]);
    let mut bytes: Vec<u8> = positions.chain(uvs).flat_map(f32::to_le_bytes).collect();
    bytes.extend([0u16, 1, 2, 0, 2, 3].iter().flat_map(|i| i.to_le_bytes()));
    bytes.extend(picture);
    bytes.resize(bytes.len().next_multiple_of(4), 0);
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"TEXCOORD_0":1}},"indices":2,"material":0}}]}}],
        "materials":[{{"pbrMetallicRoughness":{{"baseColorTexture":{{"index":0}},"roughnessFactor":1,"metallicFactor":0}}}}],
        "textures":[{{"source":1}}],"images":[{{"uri":"unused.png"}},{{{image}}}],
        "accessors":[
            {{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[-1,-1,0],"max":[1,1,0]}},
            {{"bufferView":1,"componentType":5126,"count":4,"type":"VEC2"}},
            {{"bufferView":2,"componentType":5123,"count":6,"type":"SCALAR"}}],
        "bufferViews":[
            {{"buffer":0,"byteOffset":0,"byteLength":48}},{{"buffer":0,"byteOffset":48,"byteLength":32}},
            {{"buffer":0,"byteOffset":80,"byteLength":12}},
            {{"buffer":0,"byteOffset":92,"byteLength":{}}}],
        "buffers":[{{{buffer}"byteLength":{}}}]}}"#,
        picture.len(),
        bytes.len()
    );
    (json, bytes)
}

fn glb(json: &str, buffer: &[u8]) -> Vec<u8> {
    let mut json = json.as_bytes().to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut bytes = b"glTF\x02\0\0\0".to_vec();
    bytes.extend((28 + json.len() as u32 + buffer.len() as u32).to_le_bytes());
    for (kind, chunk) in [(b"JSON", &json[..]), (b"BIN\0", buffer)] {
        bytes.extend((chunk.len() as u32).to_le_bytes());
        bytes.extend(kind);
        bytes.extend(chunk);
    }
    bytes
}

fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let four = |three: &[u8]| {
        let bits =
            three.iter().fold(0u32, |bits, &byte| bits << 8 | u32::from(byte)) << (8 * (3 - three.len()));
        (0..=three.len())
            .map(move |i| DIGITS[(bits >> (18 - 6 * i) & 63) as usize] as char)
            .collect::<String>()
    };
    bytes.chunks(3).map(four).collect()
}

/// The models in their three forms, with this picture.
fn write_models(folder: &Folder, picture: &[u8]) {
    let (json, buffer) = painted_square(picture, r#""bufferView":3"#, "");
    folder.write("square.glb", glb(&json, &buffer));
    let (json, buffer) = painted_square(picture, r#""bufferView":3"#, r#""uri":"my%20square.bin","#);
    folder.write("beside.gltf", json);
    folder.write("my square.bin", buffer);
    let image = format!(r#""uri":"data:image/png;base64,{}""#, base64(picture));
    let (json, buffer) = painted_square(picture, &image, "");
    folder.write("data.glb", glb(&json, &buffer));
}

#[test]
fn pictures_within_models_have_copies() {
    let folder = wall();
    write_models(&folder, &folder.read("large.png"));
    let other = |x: u32, y: u32| [(x * 7 % 31) as f32 / 30.0, (y % 5) as f32 / 4.0, 0.3];
    let other = Image::from_fn(600, 400, other).unwrap();
    let other = encode(&other, Format::Png, &EncodeOptions::default()).unwrap();
    for model in ["square.glb", "beside.gltf", "data.glb"] {
        write_models(&folder, &folder.read("large.png"));
        let text = format!(
            "PerspectiveCamera {{ center 0 0 4  direction 0 0 -1  up 0 1 0  angle 40 }}
             Lights {{ PointLight {{ position 0 1 4  color 1 1 1 }} }}
             Group {{ Model {{ file {model} }} }}"
        );
        folder.write("wall.txt", text);
        let tiles = format!("tiles-{model}");
        let line = format!("render wall.txt --size 60 40 --samples 4 --texture-folder {tiles}");
        let render = |name: &str, memory: &str| {
            folder.succeed(&format!("{line} -o {name} {memory}"));
            folder.read(name)
        };
        let copy = || {
            let files = std::fs::read_dir(folder.path(&tiles)).unwrap().map(|file| file.unwrap().path());
            let mut files = files.filter(|path| path.extension().is_some_and(|ending| ending == "ktile"));
            let (copy, none) = (files.next(), files.next());
            assert!(none.is_none(), "{none:?}");
            copy.unwrap()
        };
        let whole = render("whole.png", "");
        assert!(!folder.path(&tiles).exists(), "all fits");
        assert!(render("a.png", "--texture-memory 1") == whole, "{model}");
        let changed = || std::fs::metadata(copy()).unwrap().modified().unwrap();
        let before = changed();
        assert!(
            render("b.png", "--texture-memory 1") == whole && changed() == before,
            "{model} is read again"
        );
        // Damaged in its tiles, cut off, and of a model that has changed.
        let good = std::fs::read(copy()).unwrap();
        let mut bytes = good.clone();
        bytes[40..4000].fill(0x55);
        std::fs::write(copy(), bytes).unwrap();
        assert!(render("c.png", "--texture-memory 1") == whole, "{model} with a damaged tile");
        assert!(std::fs::read(copy()).unwrap() == good);
        std::fs::write(copy(), &good[..good.len() / 2]).unwrap();
        assert!(render("d.png", "--texture-memory 1") == whole, "{model} with half a copy");
        write_models(&folder, &other);
        let new = render("e.png", "--texture-memory 1");
        assert!(new != whole && new == render("f.png", ""), "{model} with another picture");
        copy();
    }
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
