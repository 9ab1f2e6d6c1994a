//! Every piece of scene language in the manual is accepted.
//!
//! A fence says what stands in it: ```` ```kajo ```` a scene or its top-level blocks, ```` ```kajo,group ````,
//! `kajo,materials`, `kajo,lights` or `kajo,settings` what stands inside that block.

mod common;

use std::fs;
use std::path::{Path, PathBuf};

use kajo::{EncodeOptions, Format, Image, MemoryAssets, encode};
use kajo::{LoadOptions, load_from};

const CAMERA: &str = "PerspectiveCamera { center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30 }\n";

struct Snippet {
    file: PathBuf,
    line: usize,
    kind: String,
    text: String,
}

fn pages(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            pages(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "md") {
            found.push(path);
        }
    }
}

fn snippets(file: &Path) -> Vec<Snippet> {
    let mut found = Vec::new();
    let mut open: Option<Snippet> = None;
    for (i, line) in fs::read_to_string(file).unwrap().lines().enumerate() {
        match (&mut open, line.trim_start().strip_prefix("```")) {
            (None, Some(kind)) if kind == "kajo" || kind.starts_with("kajo,") => {
                let kind = kind.strip_prefix("kajo,").unwrap_or("").to_owned();
                open = Some(Snippet { file: file.into(), line: i + 1, kind, text: String::new() });
            }
            (None, _) => {}
            (Some(_), Some(_)) => found.extend(open.take()),
            (Some(snippet), None) => {
                snippet.text.push_str(line);
                snippet.text.push('\n');
            }
        }
    }
    found
}

/// A scene around the snippet, with all materials that it names.
fn scene(Snippet { kind, text, .. }: &Snippet) -> String {
    let words: Vec<&str> = text.split(|c: char| c.is_whitespace() || c == '{' || c == '}').collect();
    let names_one = |word: &str| word.eq_ignore_ascii_case("MaterialIndex") || word == "material";
    let used = words.windows(2).filter(|pair| names_one(pair[0])).map(|pair| pair[1]);
    let mut named: Vec<&str> = used.filter(|name| name.starts_with(char::is_alphabetic)).collect();
    named.sort_unstable();
    named.dedup();
    // What the snippet makes itself is not made twice.
    named.retain(|name| {
        !words.windows(2).any(|pair| {
            pair[0].starts_with(char::is_uppercase) && !pair[0].ends_with("ndex") && pair[1] == *name
        })
    });
    let named: String = named.iter().map(|name| format!("Material {name} {{}} ")).collect();
    let some = format!("{} {named}", "Material {} ".repeat(8));
    let camera = if words.iter().any(|word| word.ends_with("Camera")) { "" } else { CAMERA };
    match kind.as_str() {
        "group" => format!("{camera} Materials {{ {some} }} Group {{ MaterialIndex 0\n{text} }}"),
        "materials" => format!("{camera} Materials {{ {some}\n{text} }}"),
        "lights" => format!("{camera} Lights {{\n{text} }}"),
        "settings" => format!("{camera} Settings {{\n{text} }}"),
        _ if words.contains(&"Materials") => format!("{camera} {text}"),
        _ => format!("{camera} Materials {{ {some} }}\n{text}"),
    }
}

/// The files that snippets name, each with the least that can be in it.
fn assets(scene: &str) -> MemoryAssets {
    let sky =
        encode(&Image::filled(2, 2, &[0.5; 3]).unwrap(), Format::Png, &EncodeOptions::default()).unwrap();
    let mut assets = MemoryAssets::new().with("scene.txt", scene);
    for word in scene.split(|c: char| c.is_whitespace() || "{}\"".contains(c)) {
        if word.ends_with(".obj") {
            assets = assets.with(word, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
        } else if word.ends_with(".ply") {
            let header = "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
                element face 1\nproperty list uchar int vertex_indices\n";
            let values = "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
            assets = assets.with(word, format!("ply\nformat ascii 1.0\n{header}end_header\n{values}"));
        } else if word.ends_with(".png") || word.ends_with(".hdr") {
            // Pictures are known by their first bytes, not by their names.
            assets = assets.with(word, &sky);
        } else if word.ends_with(".glb") {
            let bytes = (0..9u8).flat_map(|i| f32::from(i * i).to_le_bytes()).collect::<Vec<_>>();
            let json = r#"{"asset":{"version":"2.0"},"buffers":[{"uri":"buffer.bin","byteLength":36}],
                "bufferViews":[{"buffer":0,"byteLength":36}],
                "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],
                "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"nodes":[{"mesh":0}]}"#;
            let folder = word.rsplit_once('/').map_or("", |(folder, _)| folder);
            assets = assets.with(word, json).with(format!("{folder}/buffer.bin"), bytes);
        } else if word.ends_with(".ies") {
            assets = assets.with(word, "TILT=NONE\n1 -1 1  2 1 1 2  0 0 0\n1 1 60\n0 90\n0\n800 0\n");
        } else if word.ends_with(".ttf") {
            assets = assets.with(word, include_bytes!("../../../scenes/gallery/fonts/kajo.ttf"));
        } else if word.ends_with(".vdb") {
            assets = assets.with(word, include_bytes!("../../../fuzz/corpus/vdb/plain.vdb"));
        } else if word.ends_with("knot.raw") {
            assets = assets.with(word, include_bytes!("../../../scenes/gallery/grids/knot.raw"));
        } else if word.ends_with(".txt") {
            assets = assets.with(word, "");
        }
    }
    let folders =
        scene.split_whitespace().zip(scene.split_whitespace().skip(1)).filter(|(key, _)| *key == "cubeMap");
    for (_, folder) in folders {
        for face in ["left", "right", "up", "down", "front", "back"] {
            assets = assets.with(format!("{}/{face}.png", folder.trim_matches('"')), &sky);
        }
    }
    assets
}

#[test]
fn the_manual_tells_the_truth() {
    let mut files = vec![common::workspace().join("README.md")];
    pages(&common::workspace().join("docs/src"), &mut files);
    files.sort();
    let all: Vec<Snippet> = files.iter().flat_map(|file| snippets(file)).collect();
    assert!(all.len() >= 20, "only {} snippets were found", all.len());
    let mut wrong = Vec::new();
    for snippet in &all {
        let text = scene(snippet);
        let loaded = load_from("scene.txt", &assets(&text), &LoadOptions::default());
        if !loaded.diagnostics.is_empty() {
            wrong.push(format!("{}:{}\n{}", snippet.file.display(), snippet.line, loaded.report(false)));
        }
    }
    assert!(wrong.is_empty(), "{} of {} snippets are wrong:\n{}", wrong.len(), all.len(), wrong.join("\n"));
}
