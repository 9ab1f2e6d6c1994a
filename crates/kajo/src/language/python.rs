//! The classes of the Python package, one for each block, written from the descriptions of blocks.
//!
//! `cargo xtask tables` writes them into the folder `kajo/blocks` of the package, a file for each family; a test compares these. A
//! class has a keyword argument for each field, with a type by the field's kind and a line of documentation by its
//! description. Operations of transforms, whose order counts, are classes of their own.

use std::fmt::Write;
use std::fs;
use std::path::PathBuf;

use super::{Absent, Block, FieldKind, FieldSpec, FieldValue, Kind, blocks};

/// Columns of a line of documentation.
const WIDTH: usize = 100;

/// What every file imports that is there when it runs.
const CLASSES: [&str; 12] = [
    "Block",
    "CameraBlock",
    "Function",
    "Item",
    "LightBlock",
    "MaterialBlock",
    "MediumBlock",
    "ObjectBlock",
    "Operation",
    "PartBlock",
    "PictureValue",
    "TextureBlock",
];

/// Types that are there for checkers alone.
const TYPES: [&str; 9] = [
    "Emission",
    "File",
    "MaterialName",
    "MediumName",
    "Number",
    "PictureFile",
    "Reflectance",
    "Texture",
    "Vector",
];

/// Whether a block is for a file.
type Belongs = fn(&Block) -> bool;

/// Files of the package, what is in each, and blocks of which kinds. Shapes come in two: those told by a few numbers, and all others.
const FILES: [(&str, &str, Belongs); 11] = [
    ("cameras", "Cameras", |block| block.kind == Kind::Camera),
    ("lights", "Lights", |block| block.kind == Kind::Light),
    ("materials", "Materials", |block| block.kind == Kind::Material),
    ("media", "Media", |block| block.kind == Kind::Medium),
    ("objects", "Other shapes, groups and operations of transforms", |block| {
        base_of(block.kind) == "ObjectBlock" && !is_primitive(block)
    }),
    ("others", "Settings, surroundings, lists and parts of blocks", |block| {
        ["Block", "PartBlock"].contains(&base_of(block.kind))
    }),
    ("patterns_a", "Patterns, A to M", |block| is_pattern(block) && block.keyword < "N"),
    ("patterns_n", "Patterns, N to Z", |block| is_pattern(block) && block.keyword >= "N"),
    ("picture", "Pictures on surfaces", |block| block.kind == Kind::Picture),
    ("primitives", "Shapes that a few numbers tell", is_primitive),
    ("textures", "Textures that are made of others", |block| {
        block.kind == Kind::Texture && !is_pattern(block)
    }),
];

/// Whether a block is a texture that is made of no other.
fn is_pattern(block: &Block) -> bool {
    const OPERATIONS: [&str; 8] =
        ["Add", "Blend", "Curve", "Formula", "Multiply", "Placed", "Ramp", "Threshold"];
    block.kind == Kind::Texture && !OPERATIONS.contains(&block.keyword)
}

/// Whether a block is a shape without a file, a function or a path.
fn is_primitive(block: &Block) -> bool {
    const OTHERS: [&str; 9] = [
        "Curves",
        "Difference",
        "Intersection",
        "Lathe",
        "Lorentz",
        "Merge",
        "Prism",
        "SphereSweep",
        "Union",
    ];
    let is_text = |field: &FieldSpec| matches!(field.kind, FieldKind::File | FieldKind::Function);
    block.kind == Kind::Shape && !block.fields().any(is_text) && !OTHERS.contains(&block.keyword)
}

/// Words that no argument of Python can be called.
const KEYWORDS: [&str; 12] =
    ["and", "as", "class", "def", "for", "from", "global", "in", "is", "lambda", "not", "or"];

/// What the constructors of all blocks take.
const TAKEN: [&str; 5] = ["children", "keyword", "material", "name", "parts"];

/// `shadeBack` as `shade_back`.
fn snake(key: &str) -> String {
    let mut name = String::new();
    for c in key.chars() {
        if c.is_uppercase() && !name.is_empty() {
            name.push('_');
        }
        name.extend(c.to_lowercase());
    }
    if KEYWORDS.contains(&&*name) { name + "_" } else { name }
}

/// `shade_back` as `shadeBack`, as the package does.
fn camel(name: &str) -> String {
    let mut words = name.trim_end_matches('_').split('_');
    let first = words.next().unwrap_or_default().to_owned();
    words.fold(first, |key, word| key + &word[..1].to_uppercase() + &word[1..])
}

/// The class of a block. Parts whose word is that of another block, as the balls of a `Blob`, say so.
fn class_of(block: &Block) -> String {
    let (first, rest) = block.keyword.split_at(1);
    let name = first.to_uppercase() + rest;
    let is_taken = name != block.keyword && blocks().any(|other| other.keyword == name);
    if is_taken { name + "Part" } else { name }
}

fn base_of(kind: Kind) -> &'static str {
    match kind {
        Kind::Camera => "CameraBlock",
        Kind::Light => "LightBlock",
        Kind::Medium => "MediumBlock",
        Kind::Material => "MaterialBlock",
        Kind::Group | Kind::Define | Kind::Transform | Kind::Instance | Kind::Shape => "ObjectBlock",
        Kind::Texture => "TextureBlock",
        Kind::Part => "PartBlock",
        Kind::Picture => "PictureValue",
        Kind::Settings
        | Kind::Animation
        | Kind::Background
        | Kind::Fog
        | Kind::Lights
        | Kind::Media
        | Kind::Materials
        | Kind::Textures => "Block",
    }
}

fn literal(words: &[&str]) -> String {
    let words: Vec<String> = words.iter().map(|word| format!("\"{word}\"")).collect();
    format!("Literal[{}]", words.join(", "))
}

/// The type of a field's value.
fn type_of(field: &FieldSpec) -> String {
    let plain = match field.kind {
        FieldKind::Number { .. } | FieldKind::Angle { .. } => "Number".to_owned(),
        FieldKind::Whole { .. } | FieldKind::Count => "int".to_owned(),
        // A camera may look at an object, by its name.
        FieldKind::Point if field.key == "target" => "Vector | str".to_owned(),
        FieldKind::Point | FieldKind::Vector | FieldKind::Color(_) => "Vector".to_owned(),
        FieldKind::Reflectance => "Reflectance".to_owned(),
        FieldKind::Emission => "Emission".to_owned(),
        FieldKind::Flag => "bool".to_owned(),
        FieldKind::Choice(words) => literal(words),
        FieldKind::ChoiceAndNumber(words, _) => {
            format!("{0} | tuple[{0}, Number]", literal(words))
        }
        FieldKind::ChoiceAndWhole(words, _) => format!("{0} | tuple[{0}, int]", literal(words)),
        FieldKind::Numbers(_) | FieldKind::Groups(_) | FieldKind::ColorStop => "Number | Vector".to_owned(),
        FieldKind::Wholes(_) => "int | Sequence[int]".to_owned(),
        FieldKind::File => "File".to_owned(),
        // What a texture is made of.
        FieldKind::Text if field.texture.is_some() => "Number | Vector".to_owned(),
        FieldKind::Text if ["medium", "exterior"].contains(&field.key) => "MediumName".to_owned(),
        FieldKind::Text | FieldKind::Integrator => "str".to_owned(),
        FieldKind::Function => "Function | str | Number".to_owned(),
        FieldKind::Material => "MaterialName".to_owned(),
        FieldKind::Picture => return "Texture".to_owned(),
    };
    if field.texture.is_some() { plain + " | Texture" } else { plain }
}

/// A field, and whether it stands there several times, as the two materials of a `Mix` do.
///
/// The segments of a path are none: their order counts, which arguments do not have, so that they are items.
fn fields_of(block: &Block) -> Vec<(&'static FieldSpec, bool)> {
    let mut fields: Vec<(&FieldSpec, bool)> = Vec::new();
    if block.fields().all(|field| field.repeats) {
        return fields;
    }
    for field in block.fields().filter(|field| field.same_as.is_none() && !is_operation(field)) {
        match fields.last_mut().filter(|(last, _)| last.key == field.key) {
            Some((_, several)) => *several = true,
            None => fields.push((field, field.repeats)),
        }
    }
    fields
}

fn is_operation(field: &FieldSpec) -> bool {
    field.key.starts_with(char::is_uppercase)
}

/// Text in lines of at most so many columns, each but the first indented.
fn wrapped(text: &str, indent: &str) -> String {
    let (mut out, mut column) = (String::new(), indent.len());
    for word in text.split_whitespace() {
        if column + 1 + word.chars().count() > WIDTH && !out.is_empty() {
            out.push('\n');
            out.push_str(indent);
            column = indent.len();
        } else if !out.is_empty() {
            out.push(' ');
            column += 1;
        }
        out.push_str(word);
        column += word.chars().count();
    }
    out.replace('\\', "\\\\")
}

fn sentence(text: &str) -> String {
    let (first, rest) = text.split_at(text.chars().next().map_or(0, char::len_utf8));
    let text = first.to_uppercase() + rest;
    if text.ends_with('.') { text } else { text + "." }
}

/// The argument of a field: its key, unless all blocks of its kind have an argument of that name.
fn argument(base: &str, field: &FieldSpec) -> String {
    let is_taken = field.key == "material" && base == "ObjectBlock";
    if is_taken { format!("own_{}", snake(field.key)) } else { snake(field.key) }
}

fn document(base: &str, field: &FieldSpec) -> String {
    let default = match field.absent {
        Absent::Required => String::new(),
        Absent::Value(constant) => format!(" Default: {}.", FieldValue::from(constant).text()),
        _ => format!(" Default: {}.", field.absence()),
    };
    let text = format!("{}: {} ({}).{default}", argument(base, field), field.about, field.values());
    wrapped(&text, "            ")
}

fn class(block: &Block) -> String {
    let fields = fields_of(block);
    let base = base_of(block.kind);
    let mut out = format!("\n\nclass {}({base}):\n", class_of(block));
    let about = wrapped(&sentence(block.about), "    ");
    match fields.is_empty() {
        true => _ = writeln!(out, "    \"\"\"{about}\"\"\"\n"),
        false => {
            _ = writeln!(out, "    \"\"\"{about}\n\n    Args:");
            fields.iter().for_each(|(field, _)| _ = writeln!(out, "        {}", document(base, field)));
            out.push_str("    \"\"\"\n\n");
        }
    }
    _ = writeln!(out, "    keyword = \"{}\"", block.keyword);
    if fields.is_empty() {
        return out;
    }
    let named = |wanted: fn(&FieldSpec, bool) -> bool| -> String {
        let names = fields.iter().filter(|(field, several)| wanted(field, *several));
        names.map(|(field, _)| format!("\"{}\",", argument(base, field))).collect()
    };
    for (what, names) in [
        ("several", named(|_, several| several)),
        ("functions", named(|field, _| field.kind == FieldKind::Function)),
    ] {
        if !names.is_empty() {
            _ = writeln!(out, "    {what}: ClassVar[tuple[str, ...]] = ({names})");
        }
    }
    let other = fields.iter().map(|(field, _)| (argument(base, field), field.key));
    let other: Vec<String> = other
        .filter(|(name, key)| camel(name) != *key)
        .map(|(name, key)| format!("\"{name}\": \"{key}\""))
        .collect();
    if !other.is_empty() {
        _ = writeln!(out, "    spelled: ClassVar[dict[str, str]] = {{{}}}", other.join(", "));
    }
    let has_material = base == "ObjectBlock";
    let taken = if has_material { ", material: MaterialName | None = None" } else { "" };
    _ = writeln!(out, "\n    def __init__(\n        self, *children: Item, name: str | None = None{taken},");
    for (field, several) in &fields {
        let kind = type_of(field);
        let kind = if *several { format!("Sequence[{kind}]") } else { kind };
        let default = if matches!(field.absent, Absent::Required) { "" } else { " | None = None" };
        _ = writeln!(out, "        {}: {kind}{default},", argument(base, field));
    }
    let material = if has_material { ", material=material" } else { "" };
    _ = writeln!(out, "    ) -> None:\n        super().__init__(*children, name=name{material})");
    for (field, _) in &fields {
        _ = writeln!(out, "        self.{0} = {0}", argument(base, field));
    }
    out
}

/// The class of what is said behind the name of a picture, which is the value of a key.
fn picture(block: &Block) -> String {
    let fields = fields_of(block);
    let mut out = format!("\n\nclass {}(PictureValue):\n", class_of(block));
    out.push_str("    \"\"\"A picture on a surface.\n\n    Args:\n");
    out.push_str("        source: the name of its file, or an array of height x width x channels, see `kajo.picture_file`.\n");
    fields.iter().for_each(|(field, _)| _ = writeln!(out, "        {}", document("PictureValue", field)));
    out.push_str(
        "        factor: Of `emission`: a factor.\n    \"\"\"\n\n    keys: ClassVar[dict[str, str]] = {\n",
    );
    for (field, _) in &fields {
        _ = writeln!(out, "        \"{}\": \"{}\",", snake(field.key), field.key);
    }
    out.push_str("    }\n\n    def __init__(\n        self,\n        source: PictureFile,\n        *,\n");
    for (field, _) in &fields {
        _ = writeln!(out, "        {}: {} | None = None,", snake(field.key), type_of(field));
    }
    out.push_str(
        "        factor: Number | None = None,\n    ) -> None:\n        super().__init__(source, factor)\n",
    );
    fields.iter().for_each(|(field, _)| _ = writeln!(out, "        self.{0} = {0}", snake(field.key)));
    out
}

/// The class of an operation of transforms.
fn operation(field: &FieldSpec) -> String {
    let about = wrapped(
        &sentence(&format!("{}: {}", sentence(field.about).trim_end_matches('.'), field.values())),
        "    ",
    );
    let arguments = match field.kind {
        FieldKind::Point | FieldKind::Vector => "x: Number, y: Number, z: Number",
        FieldKind::Angle { .. } => "degrees: Number",
        FieldKind::Numbers(_) => "*numbers: Number",
        _ => "factor: Number",
    };
    let values: Vec<&str> = arguments.split(", ").filter_map(|argument| argument.split(':').next()).collect();
    format!(
        "\n\nclass {0}(Operation):\n    \"\"\"{about}\"\"\"\n\n    keyword = \"{0}\"\n\n    def __init__(self, \
         {arguments}) -> None:\n        super().__init__({1})\n",
        field.key,
        values.join(", ")
    )
}

/// The beginning of a file with these classes, which imports what they use.
fn head(what: &str, classes: &str) -> String {
    let uses = |name: &&str| {
        let is_word = |c: char| c.is_alphanumeric() || c == '_';
        classes.match_indices(*name).any(|(at, _)| {
            let (before, after) = (&classes[..at], &classes[at + name.len()..]);
            !before.ends_with(is_word) && !after.starts_with(is_word)
        })
    };
    let list = |indent: &str, names: &[&str]| -> String {
        let names = names.iter().copied().filter(|name| uses(name));
        names.map(|name| format!("{indent}    {name},\n")).collect()
    };
    let typing: Vec<&str> = ["ClassVar", "Literal"].into_iter().filter(|name| uses(name)).collect();
    let mut text = format!(
        "\"\"\"{what}: written by `cargo xtask tables`, not by hand.\"\"\"\n\nfrom __future__ import annotations\n\n"
    );
    if uses(&"Sequence") {
        text.push_str("from collections.abc import Sequence\n");
    }
    _ = writeln!(text, "from typing import {}", [&["TYPE_CHECKING"], &typing[..]].concat().join(", "));
    _ = writeln!(text, "\nfrom .._items import (\n{})\n", list("", &CLASSES));
    _ = writeln!(text, "if TYPE_CHECKING:\n    from .._items import (\n{}    )", list("    ", &TYPES));
    text
}

/// The operations of transforms.
fn operations() -> Vec<&'static FieldSpec> {
    let transform = blocks().find(|block| block.keyword == "Transform");
    transform.map_or_else(Vec::new, |block| block.fields().filter(|field| is_operation(field)).collect())
}

/// The files of the package with their texts.
fn files() -> Vec<(String, String)> {
    let mut files = Vec::new();
    let (mut imports, mut all) = (String::new(), Vec::new());
    for (file, what, belongs) in FILES {
        let of_file: Vec<&Block> = blocks().filter(|block| belongs(block)).collect();
        let mut text = String::new();
        let mut names: Vec<String> = of_file.iter().map(|block| class_of(block)).collect();
        let write = |block: &Block| if block.kind == Kind::Picture { picture(block) } else { class(block) };
        of_file.iter().for_each(|block| text.push_str(&write(block)));
        if file == "objects" {
            names.extend(operations().iter().map(|field| field.key.to_owned()));
            operations().iter().for_each(|field| text.push_str(&operation(field)));
        }
        names.sort_unstable();
        text.insert_str(0, &head(what, &text));
        _ = writeln!(imports, "from ._{file} import {}", names.join(", "));
        all.extend(names);
        files.push((format!("_{file}.py"), text));
    }
    all.sort_unstable();
    let list: String = all.iter().map(|name| format!("    \"{name}\",\n")).collect();
    let about = "\"\"\"The blocks of the scene language as classes: written by `cargo xtask tables`, not by hand.\n\n\
                 Each class has a keyword argument for each field of its block; `None` leaves a field out, so that its default holds.\n\
                 \"\"\"";
    files.push(("__init__.py".to_owned(), format!("{about}\n\n{imports}\n__all__ = [\n{list}]\n")));
    files
}

#[test]
fn the_python_package_has_a_class_for_each_block() {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../kajo-py/python/kajo/blocks");
    let mut classes = 0;
    for (name, text) in files() {
        let path = folder.join(name);
        if std::env::var_os(super::tests::WRITE).is_some() {
            fs::create_dir_all(&folder).unwrap();
            fs::write(&path, &text).unwrap();
        }
        let old = fs::read_to_string(&path).unwrap_or_default();
        let different = old.lines().zip(text.lines()).find(|(old, new)| old != new);
        assert!(old == text, "{} differs: `cargo xtask tables` writes it\n{different:#?}", path.display());
        assert!(text.lines().count() <= 900, "{} is long", path.display());
        classes += text.matches("\nclass ").count();
    }
    assert_eq!(classes, blocks().count() + operations().len());
}

#[test]
fn names_of_python_are_distinct_and_free() {
    let mut classes: Vec<String> = blocks().map(class_of).collect();
    let count = classes.len();
    classes.sort_unstable();
    classes.dedup();
    assert_eq!(classes.len(), count, "two blocks have one class");
    for block in blocks() {
        for (field, _) in fields_of(block) {
            let name = argument(base_of(block.kind), field);
            // Parts of blocks have no material unless it is a field of theirs.
            let is_free = base_of(block.kind) == "PartBlock" && name == "material";
            assert!(
                is_free || !TAKEN.contains(&&*name),
                "{}: `{name}` is an argument of all blocks",
                block.keyword
            );
            assert!(snake(field.key).chars().all(|c| c.is_ascii_alphanumeric() || c == '_'), "{}", field.key);
        }
    }
    assert_eq!(
        (snake("shadeBack"), snake("obj_file"), snake("in")),
        ("shade_back".into(), "obj_file".into(), "in_".into())
    );
}
