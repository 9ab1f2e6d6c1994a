//! The descriptions of blocks against the compiler.

use std::collections::BTreeSet;
use std::path::Path;

use kajo_core::settings::Dialect;

use kajo::language::{blocks, kind_of};

use super::*;
use crate::Document;
use kajo::{LoadOptions, MemoryAssets, load_from};

/// A scene with `text` as the block that has `keyword`, and the kind of place where such a block stands.
fn scene_with(block: &Block, text: &str) -> String {
    let camera = "PerspectiveCamera { center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30 }";
    let materials = "Materials { Matte { } Matte { } }";
    match block.kind {
        Kind::Camera | Kind::Settings | Kind::Animation | Kind::Background | Kind::Fog => {
            format!("{camera} {text}")
        }
        Kind::Part if block.keyword == "key" => {
            let moving = format!("Motion {{ {text} key 1 {{ Translate 1 0 0 }} }}");
            let ball = "Sphere { center 0 0 0  radius 1 }";
            format!("{camera} {materials} Group {{ MaterialIndex 0 Transform {{ {moving} {ball} }} }}")
        }
        Kind::Part if ["sphere", "cylinder", "plane"].contains(&block.keyword) => {
            let materials = "Materials { Matte { } Matte { } Matte { } }";
            let other = "sphere { center 9 9 9  radius 1  material 1 }";
            format!("{camera} {materials} Group {{ MaterialIndex 2 Blob {{ {other} {text} }} }}")
        }
        Kind::Part if block.keyword == "profile" => {
            format!("{camera} {materials} Group {{ MaterialIndex 0 Lathe {{ {text} }} }}")
        }
        Kind::Part if block.keyword == "FollowPath" => {
            format!(
                "{camera} {materials} Group {{ MaterialIndex 0 Transform {{ {text} Sphere {{ center 0 0 0  radius 1 }} }} }}"
            )
        }
        Kind::Part if block.keyword == "WorldLine" => {
            format!(
                "PerspectiveCamera {{ center 0 1 0  direction 3 -2 4  up 0 1 0  angle 30 {text} }} {materials}"
            )
        }
        Kind::Part if block.keyword == "path" => {
            format!("{camera} {materials} Group {{ MaterialIndex 0 SphereSweep {{ {text} }} }}")
        }
        Kind::Part if block.keyword == "outline" => {
            format!("{camera} {materials} Group {{ MaterialIndex 0 Prism {{ depth 1  {text} }} }}")
        }
        Kind::Part if block.keyword == "strand" => {
            format!("{camera} {materials} Group {{ MaterialIndex 0 Curves {{ {text} }} }}")
        }
        Kind::Part => format!("{camera} Background {{ {text} }}"),
        Kind::Picture => unreachable!("has no word of its own"),
        Kind::Light => format!("{camera} Lights {{ {text} }}"),
        Kind::Medium => format!("{camera} Textures {{ Cells known {{ }} }} Media {{ {text} }}"),
        Kind::Texture => format!("{camera} Textures {{ Cells known {{ }} {text} }}"),
        Kind::Material if block.keyword == "AccretionDisk" => {
            format!("{camera} Media {{ BlackHole some {{ }} }} Materials {{ Matte {{ }} {text} }}")
        }
        Kind::Material => format!("{camera} Materials {{ Matte {{ }} {text} }}"),
        Kind::Shape | Kind::Instance | Kind::Transform => {
            format!("{camera} {materials} Group {{ MaterialIndex 0 Define thing {{ }} {text} }}")
        }
        Kind::Group if block.fields().next().is_some() => {
            let materials = "Materials { Matte { } Matte { } Matte { } }";
            format!("{camera} {materials} Group {{ MaterialIndex 2 {text} }}")
        }
        Kind::Group | Kind::Define | Kind::Lights | Kind::Materials | Kind::Textures | Kind::Media => {
            format!("{camera} {text}")
        }
    }
}

fn messages(text: &str) -> Vec<String> {
    let loaded = load_from("s.txt", &MemoryAssets::new().with("s.txt", text), &LoadOptions::default());
    let lines =
        loaded.diagnostics.iter().map(|d| format!("{} / {}", d.message, d.help.as_deref().unwrap_or("")));
    lines.collect()
}

fn head(block: &Block) -> String {
    match block.keyword {
        "Instance" => "Instance thing".to_owned(),
        "key" => "key 0".to_owned(),
        keyword if [Kind::Medium, Kind::Texture].contains(&block.kind) => format!("{keyword} some"),
        keyword => keyword.to_owned(),
    }
}

/// Values for what must be there.
fn needed(block: &Block) -> String {
    let given = |field: &FieldSpec| {
        let value = match field.kind {
            FieldKind::Point | FieldKind::Vector if ["top", "direction", "max"].contains(&field.key) => {
                "3 -2 4"
            }
            FieldKind::Point | FieldKind::Vector if ["edge1", "vertex1"].contains(&field.key) => "1 0 0",
            FieldKind::Point | FieldKind::Vector => "0 1 0",
            FieldKind::Color(_) | FieldKind::Emission => "0.5 0.25 0.125",
            FieldKind::Material => "0",
            FieldKind::Numbers(_) if field.key == "row0" => "0 0 0  1 0 0  2 0 0  3 0 1",
            FieldKind::Numbers(ranges) if ranges.len() == 12 => "0 1 0  1 1 1  2 1 0  3 1 0",
            FieldKind::Numbers(ranges) => return format!("{} {}", field.key, "1 ".repeat(ranges.len())),
            FieldKind::ColorStop => "0 1 0.5 0.25",
            FieldKind::Groups([_, _, _]) => "0 0 0  1 0 0  1 1 0",
            FieldKind::File => "heights.pfm",
            _ => "30",
        };
        let value = match field.key {
            "vertex2" => "0 0 3",
            "texture" => "known",
            "hole" => "some",
            "terms" => "1 2 0 0  1 0 2 0  -0.5 0 0 0",
            "other" => "99 0 0",
            "throat" => "1",
            _ => value,
        };
        format!("{} {value} ", field.key)
    };
    let needed: String =
        block.fields().filter(|field| matches!(field.absent, Absent::Required)).map(given).collect();
    match block.kind {
        Kind::Light => needed + "color 1 1 1 ",
        Kind::Camera => {
            let aim = "center 0 1 0 direction 3 -2 4 up 0 1 0 ";
            let opening = match block.keyword {
                "PerspectiveCamera" => "angle 30 ",
                "OrthographicCamera" => "size 30 ",
                _ => "",
            };
            needed + aim + opening
        }
        Kind::Group => needed + "Sphere { center 0 0 0  radius 1 } ",
        _ if block.keyword == "Lathe" => needed + "profile { line 0 0  1 0  0 1 } ",
        _ if block.keyword == "SphereSweep" => needed + "path { line 0 0 0 1  1 0 0 1 } ",
        Kind::Medium if block.keyword == "GridMedium" => needed + "size 2 1 1  values 0 1  density 1 ",
        Kind::Medium if block.keyword == "IndexGrid" => needed + "size 2 1 1  values 1 1.5 ",
        Kind::Medium if block.fields().any(|field| field.key == "density") => needed + "density 1 ",
        _ if block.keyword == "HeightField" => needed + "file heights.pfm ",
        _ if block.keyword == "DistanceGrid" => needed + "size 2 2 2  values -1 1 1 1 1 1 1 1 ",
        _ if block.keyword == "Prism" => needed + "outline { line 0 0  1 0  0 1 } ",
        _ if block.keyword == "Curves" => needed + "strand { points 0 0 0  1 0 0  1 1 0 } ",
        _ if ["outline", "profile"].contains(&block.keyword) => needed + "line 0 0  1 0  0 1 ",
        _ if block.keyword == "FollowPath" => needed + "line 0 0 0  1 0 0  progress 0.7 ",
        _ if block.keyword == "WorldLine" => needed + "acceleration 0 0 -0.1 ",
        _ if block.keyword == "path" => needed + "line 0 0 0 1  1 0 0 1 ",
        _ => needed,
    }
}

/// The keys that the compiler asks for in a block, by what it says when none of them is meant.
fn known_to_compiler(block: &Block) -> BTreeSet<String> {
    let text = format!("{} {{ {} zzzzzzzzqqqqqqqq 1 }}", head(block), needed(block));
    let said = messages(&scene_with(block, &text)).into_iter().find(|m| m.contains("unknown word `zzzzzzzz"));
    let said = said.unwrap_or_else(|| panic!("{}: no such message", block.keyword));
    said.split('/').next_back().unwrap().split('`').skip(1).step_by(2).map(str::to_owned).collect()
}

#[test]
fn every_key_that_the_compiler_knows_is_in_the_tables_and_no_other() {
    // Operations may be many, and what is said behind a picture is known by key.
    let is_order = |block: &Block| block.kind == Kind::Transform || block.keyword == "key";
    for block in blocks().filter(|b| b.fields().next().is_some() && !is_order(b) && b.kind != Kind::Picture) {
        let mut here: BTreeSet<String> = block.fields().map(|field| field.key.to_owned()).collect();
        here.extend(block.parts.iter().map(|part| part.keyword.to_owned()));
        let mut there = known_to_compiler(block);
        // Members of its family, and objects.
        there.retain(|word| !blocks().any(|other| other.keyword == word && block.lists(other)));
        if block.kind == Kind::Group {
            there.remove("MaterialIndex");
        }
        // Both names of a mesh's file are asked for only when they are there.
        if block.keyword == "TriangleMesh" {
            there.insert("obj_file".to_owned());
        }
        // Asked for only when there is a picture.
        if block.keyword == "Background" {
            there.extend(["environment", "rotate", "scale"].map(str::to_owned));
        }
        if ["PerspectiveCamera", "OrthographicCamera"].contains(&block.keyword) {
            there.extend(["fNumber", "focalLength"].map(str::to_owned));
        }
        assert_eq!(here, there, "{}", block.keyword);
    }
}

/// What may be said behind each kind of picture, by the key that it is for.
fn picture_blocks() -> impl Iterator<Item = (&'static str, &'static Block)> {
    let matte = blocks().find(|block| block.keyword == "Matte").unwrap();
    matte.fields().filter_map(|field| Some((field.key, field.texture?)))
}

#[test]
fn every_key_behind_a_picture_is_in_the_tables_and_no_other() {
    let all: BTreeSet<&str> =
        blocks().find(|b| b.kind == Kind::Picture).unwrap().fields().map(|field| field.key).collect();
    let mut met = BTreeSet::new();
    for (key, block) in picture_blocks() {
        let matte = blocks().find(|block| block.keyword == "Matte").unwrap();
        let text = format!("Matte {{ {key} heights.pfm {{ zzzzzzzzqqqqqqqq 1 }} }}");
        let said = messages(&scene_with(matte, &text));
        let said = said.into_iter().find(|m| m.contains("unknown word `zzzzzzzz")).expect(key);
        let there: BTreeSet<&str> =
            said.split('/').next_back().unwrap().split('`').skip(1).step_by(2).collect();
        let here: BTreeSet<&str> = block.fields().map(|field| field.key).collect();
        assert_eq!(here, there, "{key}");
        met.extend(here);
    }
    assert_eq!(met, all, "the table of all pictures");
}

/// The keys behind a picture are absent, one after the other, or have the value that is said to hold then.
#[test]
fn defaults_behind_a_picture_are_what_the_compiler_takes() {
    let folder = folder();
    let matte = blocks().find(|block| block.keyword == "Matte").unwrap();
    let mut same = 0;
    for (key, block) in picture_blocks() {
        let with = |more: &str| {
            let material = format!("Matte {{ {key} heights.pfm {{ {more} }} }}");
            document(folder.path(), &scene_with(matte, &material))
        };
        let absent = made(&with("")).unwrap_or_else(|| panic!("{}", with("").report(false)));
        for field in block.fields().filter(|field| field.needs.is_none() && field.key != "range") {
            let Absent::Value(constant) = field.absent else { continue };
            let written = with(&format!("{} {}", field.key, FieldValue::from(constant).text()));
            let made = made(&written).unwrap_or_else(|| panic!("{}", written.report(false)));
            assert!(made == absent, "{key}: {}", field.key);
            same += 1;
        }
    }
    assert!(same > 30, "{same}");
}

#[test]
fn every_word_that_begins_a_block_is_in_the_tables() {
    let words = |text: &str| -> Vec<String> {
        let said = messages(text).into_iter().find(|m| m.contains("unknown word `zzzzzzzz"));
        let said = said.unwrap_or_else(|| panic!("{text}"));
        said.split('/').next_back().unwrap().split('`').skip(1).step_by(2).map(str::to_owned).collect()
    };
    let unknown = "zzzzzzzzqqqqqqqq { }";
    let places = [
        (unknown.to_owned(), None),
        (format!("Lights {{ {unknown} }}"), Some(Kind::Lights)),
        (format!("Materials {{ {unknown} }}"), Some(Kind::Materials)),
        (format!("Textures {{ {unknown} }}"), Some(Kind::Textures)),
        (format!("Media {{ {unknown} }}"), Some(Kind::Media)),
        (format!("Group {{ {unknown} }}"), Some(Kind::Group)),
    ];
    for (text, parent) in places {
        for word in words(&text) {
            let is_value =
                ["numLights", "numMaterials", "numObjects", "MaterialIndex", "exterior"].contains(&&*word);
            let known = blocks().any(|block| block.keyword == word);
            assert!(is_value || known, "`{word}` in {parent:?}");
            assert!(is_value || kind_of(&word, parent) != Kind::Part, "`{word}` in {parent:?}");
        }
    }
}

/// A folder with a luminaire and a mesh.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let light = "TILT=NONE\n1 -1 1  2 3 1 2  0 0 0\n1 1 60\n0 180\n0 90 180\n100 100\n200 200\n300 300\n";
    let normals = "vn 1 0 0\nvn 0 1 0\nvn 0 0.6 0.8\n";
    let mesh = format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n{normals}f 1//1 2//2 3//3\nf 1//2 3//3 4//1\n");
    std::fs::write(folder.path().join("luminaire.ies"), light).unwrap();
    std::fs::write(folder.path().join("two.obj"), mesh).unwrap();
    let heights = [0.0f32, 0.5, 0.25, 1.0].map(f32::to_le_bytes);
    let heights = [b"Pf\n2 2\n-1\n".as_slice(), heights.as_flattened()].concat();
    std::fs::write(folder.path().join("heights.pfm"), heights).unwrap();
    folder
}

fn document(folder: &Path, text: &str) -> Document {
    let mut document = Document::untitled(folder, text, LoadOptions::default()).unwrap();
    document.compile();
    document
}

/// What the compiler makes of a text, and a render of that; `None` with mistakes in it.
fn made(document: &Document) -> Option<String> {
    let scene = document.scene()?;
    let render = RenderSettings::resolve(scene, &Settings::default(), Defaults::Modern, false).unwrap();
    let materials: Vec<_> = scene.geometry.primitives.iter().map(|object| object.material).collect();
    let world = format!(
        "{materials:?} {:?} {:?} {:?} {:?} {:?} {:?} {:?} {:?} {:?} {:?} {:?} {:?} {render:?}",
        scene.geometry.shapes,
        scene.appearance.materials,
        scene.appearance.textures,
        scene.geometry.transforms,
        scene.geometry.motions,
        scene.lighting.lights,
        scene.lighting.groups,
        scene.output.camera,
        (scene.output.readout, scene.output.animation),
        scene.lighting.background,
        scene.lighting.ambient,
        (scene.lighting.fog, scene.lighting.air, &scene.appearance.media),
    );
    Some(without_spare_lanes(&world))
}

/// Whether the scene says something to its integrator that this has no use for.
fn has_idle_keys(document: &Document) -> bool {
    let Some(scene) = document.scene() else { return false };
    let render = RenderSettings::resolve(scene, &Settings::default(), Defaults::Modern, false).unwrap();
    !render.without_effect(&Settings::default(), &scene.output.settings).is_empty()
}

/// What is printed, without the fourth lane of spectra, which has no meaning in linear RGB: white that nobody wrote fills
/// it, and a colour does not.
fn without_spare_lanes(world: &str) -> String {
    let mut parts = world.split("Spectrum(Vec4(");
    let mut text = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (lanes, rest) = part.split_once(')').unwrap();
        text.extend(lanes.split(", ").take(3).chain([rest]));
    }
    text
}

/// The matt colour of the last material.
fn diffuse(document: &Document) -> Option<[f32; 3]> {
    let scene = document.scene()?;
    let (material, _) = scene.appearance.list.last()?;
    scene.appearance.materials.constant(*material).map(|phong| phong.diffuse.to_rgb())
}

/// What else may stand in a block and changes what holds for the fields that are absent.
fn variants(block: &Block) -> Vec<String> {
    let more: &[&str] = match (block.kind, block.keyword) {
        (_, "PhongMaterial" | "Material") => &[
            "transparentColor 0.5 0.6 0.7",
            "transparentColor 0.5 0 0.7",
            "shininess 7",
            "diffuseColor 0.3 0.2 0.1  specularColor 0.1 0.2 0.3",
            "emission 1 2 3",
        ],
        (_, "Glass") => &["thickness 0.1", "glass N-BK7"],
        (Kind::Material, _) if block.fields().any(|field| field.key == "emission") => &["emission 1 2 3"],
        (_, "PerspectiveCamera") => {
            &["focus 4", "aperture 0.2  focus 4", "fNumber 2  focalLength 0.05  focus 4"]
        }
        (_, "PointLight") => &["falloff 2", "attenuation 1 2 3"],
        (_, "TriangleMesh") => &["file two.obj"],
        (_, "Settings") => &[
            "integrator path",
            "integrator distribution",
            "integrator direct",
            "integrator occlusion",
            "integrator bidirectional",
            "integrator light",
        ],
        _ => &[],
    };
    let mut bodies: Vec<String> = more.iter().map(|more| format!("{} {more}", needed(block))).collect();
    match block.keyword {
        "PointLight" => bodies.push("position 0 1 0  ies luminaire.ies".to_owned()),
        "TriangleMesh" => return bodies,
        _ => {}
    }
    bodies.push(needed(block));
    bodies
}

/// The fields of a block are absent, one after the other, or have the value that is said to hold then.
#[test]
fn defaults_are_what_the_compiler_takes() {
    let folder = folder();
    let (mut same, mut other, mut wrong) = (0, 0, Vec::new());
    let all = blocks().filter(|block| {
        let is_order = matches!(block.kind, Kind::Transform | Kind::Instance);
        // These would need whole files of other formats.
        let needs_file = ["BTF", "Measured", "Model", "Text"].contains(&block.keyword);
        block.fields().next().is_some() && !is_order && !needs_file && block.kind != Kind::Picture
    });
    for (block, dialect) in all.flat_map(|block| Dialect::NAMES.map(|dialect| (block, dialect))) {
        for body in variants(block) {
            let text = |more: &str| {
                let text = scene_with(block, &format!("{} {{ {body} {more} }}", head(block)));
                match block.kind {
                    Kind::Settings => text,
                    _ => format!("{text} Settings {{ dialect {dialect} }}"),
                }
            };
            let plain = document(folder.path(), &text(""));
            let absent = made(&plain).unwrap_or_else(|| panic!("{}", plain.report(false)));
            let mut nodes = plain.outline().nodes().iter().filter(|node| &*node.keyword == block.keyword);
            let node = if block.keyword == "key" { nodes.next() } else { nodes.next_back() }.unwrap().id;
            for field in plain.fields(node).into_iter().filter(|field| field.span.is_none()) {
                assert!(field.kind != FieldKind::Count, "lists count by themselves");
                let with = |value: &str| document(folder.path(), &text(&format!("{} {value}", field.key)));
                let place = || format!("{} {{ {body} }}: {}", block.keyword, field.key);
                let Some(value) = &field.value else {
                    // What no value says must be no value of the usual ones. Those without effect say so.
                    for value in ["0", "1", "0.5", "0 0", "0 0 0", "1 1 1", "on", "off"] {
                        let document = with(value);
                        let is_heard = document.lines().next().is_none() && !has_idle_keys(&document);
                        if is_heard && field.idle.is_none() && made(&document).as_ref() == Some(&absent) {
                            wrong.push(format!("{}: {value} is the default", place()));
                        }
                    }
                    other += 1;
                    continue;
                };
                let document = with(&value.text());
                if field.key == "diffuseColor" {
                    // Here the spare lane is in what lobes are drawn by, too.
                    let [a, b] = [&plain, &document].map(diffuse);
                    if a.is_none() || a != b {
                        wrong.push(format!("{}: {a:?} {b:?}", place()));
                    }
                    continue;
                }
                let written = made(&document).unwrap_or_else(|| panic!("{}", document.report(false)));
                if written != absent {
                    wrong.push(format!("{}: {} is not what holds", place(), value.text()));
                }
                same += 1;
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
    assert!(same > 500 && other > 100, "{same} {other}");
}

/// A field that cannot be set as the block is now would be an error, or say nothing.
#[test]
fn what_is_idle_is_refused_or_said_to_have_no_effect() {
    let folder = folder();
    for (block, keys, idle, value) in [
        ("PointLight", "position 0 1 0  color 1 1 1", "intensity", "1 1 1"),
        ("PointLight", "position 0 1 0  color 1 1 1", "rotate", "20"),
        ("PointLight", "position 0 1 0  power 1 1 1", "falloff", "1"),
        ("Matte", "", "emits", "front"),
    ] {
        let block = blocks().find(|other| other.keyword == block).unwrap();
        let text = |more: &str| scene_with(block, &format!("{} {{ {keys} {more} }}", block.keyword));
        let plain = document(folder.path(), &text(""));
        let node = plain.outline().nodes().iter().rfind(|node| &*node.keyword == block.keyword).unwrap().id;
        let field = plain.fields(node).into_iter().find(|field| field.key == idle).unwrap();
        assert!(field.idle.is_some() && field.value.is_none(), "{idle}: {field:?}");
        assert!(
            document(folder.path(), &text(&format!("{idle} {value}"))).lines().next().is_some(),
            "{idle}"
        );
    }
}
