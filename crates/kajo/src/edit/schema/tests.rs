//! The tables against the compiler.

use std::collections::BTreeSet;

use super::*;
use crate::{LoadOptions, MemoryAssets, load_from};

/// A scene with `text` as the block that has `keyword`, and the kind of place where such a block stands.
fn scene_with(block: &Block, text: &str) -> String {
    let camera = "PerspectiveCamera { center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30 }";
    let materials = "Materials { Matte { } Matte { } }";
    match block.kind {
        Kind::Camera | Kind::Settings | Kind::Background | Kind::Fog => format!("{camera} {text}"),
        Kind::Part => format!("{camera} Background {{ {text} }}"),
        Kind::Light => format!("{camera} Lights {{ {text} }}"),
        Kind::Material => format!("{camera} Materials {{ Matte {{ }} {text} }}"),
        Kind::Shape | Kind::Instance | Kind::Transform => {
            format!("{camera} {materials} Group {{ MaterialIndex 0 Define thing {{ }} {text} }}")
        }
        Kind::Group | Kind::Define | Kind::Lights | Kind::Materials => format!("{camera} {text}"),
    }
}

fn messages(text: &str) -> Vec<String> {
    let loaded = load_from("s.txt", &MemoryAssets::new().with("s.txt", text), &LoadOptions::default());
    let lines =
        loaded.diagnostics.iter().map(|d| format!("{} / {}", d.message, d.help.as_deref().unwrap_or("")));
    lines.collect()
}

fn head(block: &Block) -> String {
    if block.kind == Kind::Instance { format!("{} thing", block.keyword) } else { block.keyword.to_owned() }
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
            FieldKind::Color | FieldKind::Emission => "0.5 0.25 0.125",
            FieldKind::Material => "0",
            _ => "30",
        };
        let value = if field.key == "vertex2" { "0 0 3" } else { value };
        format!("{} {value} ", field.key)
    };
    let needed: String = block.fields.iter().filter(|field| field.required).map(given).collect();
    if block.kind == Kind::Light { needed + "color 1 1 1 " } else { needed }
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
    for block in blocks().filter(|b| !b.fields.is_empty() && b.kind != Kind::Transform && b.keyword != "key")
    {
        let here: BTreeSet<String> = block.fields.iter().map(|field| field.key.to_owned()).collect();
        // Blocks within are nodes of their own.
        let mut there = known_to_compiler(block);
        there.retain(|key| !["sky", "Transform", "Motion"].contains(&&**key));
        // Both names of a mesh's file are asked for only when they are there.
        if block.keyword == "TriangleMesh" {
            there.insert("obj_file".to_owned());
        }
        // Asked for only when there is a picture.
        if block.keyword == "Background" {
            there.extend(["environment", "rotate", "scale"].map(str::to_owned));
        }
        // Asked for only when there is a measured luminaire.
        if block.keyword == "PointLight" {
            there.extend(["ies", "direction", "rotate", "scale"].map(str::to_owned));
        }
        if ["PerspectiveCamera", "OrthographicCamera"].contains(&block.keyword) {
            there.extend(["fNumber", "focalLength"].map(str::to_owned));
        }
        assert_eq!(here, there, "{}", block.keyword);
    }
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
        (format!("Group {{ {unknown} }}"), Some(Kind::Group)),
    ];
    for (text, parent) in places {
        for word in words(&text) {
            let is_value = ["numLights", "numMaterials", "numObjects", "MaterialIndex"].contains(&&*word);
            let known = blocks().any(|block| block.keyword == word);
            assert!(is_value || known, "`{word}` in {parent:?}");
            assert!(is_value || kind_of(&word, parent) != Kind::Part, "`{word}` in {parent:?}");
        }
    }
}

#[test]
fn defaults_are_what_the_compiler_takes() {
    for block in blocks().filter(|b| {
        !matches!(b.kind, Kind::Settings | Kind::Transform | Kind::Instance) && b.keyword != "key"
    }) {
        if ["Model", "TriangleMesh"].contains(&block.keyword) {
            continue;
        }
        let needed = needed(block);
        let compiled = |more: &str| {
            let text = scene_with(block, &format!("{} {{ {needed} {more} }}", head(block)));
            let loaded =
                load_from("s.txt", &MemoryAssets::new().with("s.txt", text), &LoadOptions::default());
            let scene = loaded.scene.as_ref().unwrap_or_else(|| panic!("{}", loaded.report(false)));
            format!(
                "{:?} {:?} {:?} {:?} {:?} {:?} {:?}",
                scene.shapes,
                scene.materials,
                scene.lights,
                scene.camera,
                scene.background,
                scene.fog,
                scene.textures
            )
        };
        for field in block.fields {
            let Some(default) = field.default else { continue };
            // White that nobody wrote is a pure factor: it fills the spare lane too, which a colour leaves zero.
            if field.key == "diffuseColor" {
                continue;
            }
            let explicit = compiled(&format!("{} {default}", field.key));
            assert!(explicit == compiled(""), "{} {}", block.keyword, field.key);
        }
    }
}
