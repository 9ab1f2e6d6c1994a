//! `kajo info`: what is in a scene.

use std::fmt::Write;

use kajo::{SceneInfo, TreeNode, load};

use crate::args::InfoArgs;
use crate::failure::Failure;
use crate::job::has_errors;
use crate::{console, json};

/// Lines of objects and of the tree that are shown to people; machines get all.
const SHOWN: usize = 100;

pub fn info(args: &InfoArgs) -> Result<(), Failure> {
    let loaded = load(&args.scene, &args.scene_args.options());
    if !loaded.diagnostics.is_empty() {
        console::report(&loaded.report(console::in_color()));
    }
    let info = SceneInfo::of(&loaded).ok_or_else(|| has_errors(&args.scene, &loaded))?;
    if args.json { console::data(&(as_json(&info) + "\n")) } else { console::answer(&as_text(&info)) }
}

fn as_text(info: &SceneInfo) -> String {
    let mut lines = Lines::default();
    lines.field("camera", info.camera);
    lines.field("dialect", info.dialect.name());
    lines.field("lights", info.lights);
    lines.field("materials", info.materials.len());
    lines.field("objects", info.objects.len());
    if info.nested_objects > 0 {
        lines.field("nested objects", info.nested_objects);
    }
    for (kind, count) in &info.shapes {
        lines.field(&format!("  {kind}"), count);
    }
    lines.field("mesh triangles", info.mesh_triangles);
    lines.field("geometry", format!("{:.1} MB", info.bytes as f64 / 1e6));
    match info.bounds {
        Some([low, high]) => lines.field("bounds", format!("{} to {}", point(low), point(high))),
        None => lines.field("bounds", "none"),
    }
    for file in &info.files {
        lines.field("file", file.display());
    }
    let named = |name: &Option<String>| name.as_ref().map(|name| format!(" {name}")).unwrap_or_default();
    lines.heading("materials, by their number in the id layer");
    lines.some(info.materials.iter().enumerate().map(|(i, name)| format!("{:>6}{}", i + 1, named(name))));
    lines.heading("objects, by their number in the id layer");
    let objects = info.objects.iter().enumerate();
    lines.some(objects.map(|(i, object)| format!("{:>6} {}{}", i + 1, object.keyword, named(&object.name))));
    lines.heading("blocks");
    lines.some(outline(&info.tree).into_iter());
    lines.text
}

#[derive(Default)]
struct Lines {
    text: String,
}

impl Lines {
    fn field(&mut self, name: &str, value: impl std::fmt::Display) {
        let _ = writeln!(self.text, "{name:<16}{}", kajo::printable(&value.to_string()));
    }

    fn heading(&mut self, text: &str) {
        let _ = writeln!(self.text, "\n{text}");
    }

    /// The first [`SHOWN`] lines, and how many more there are.
    fn some(&mut self, mut lines: impl Iterator<Item = String>) {
        for line in lines.by_ref().take(SHOWN) {
            let _ = writeln!(self.text, "{}", kajo::printable(&line));
        }
        let more = lines.count();
        if more > 0 {
            let _ = writeln!(self.text, "   ... and {more} more");
        }
    }
}

fn point([x, y, z]: [f32; 3]) -> String {
    format!("({x}, {y}, {z})")
}

/// One line a block, indented by its depth.
fn outline(tree: &[TreeNode]) -> Vec<String> {
    fn add(nodes: &[TreeNode], depth: usize, lines: &mut Vec<String>) {
        for node in nodes {
            let name = node.name.as_deref().map(|name| format!(" {name}")).unwrap_or_default();
            lines.push(format!("{:indent$}{}{name}", "", node.keyword, indent = 2 + 2 * depth));
            add(&node.children, depth + 1, lines);
        }
    }
    let mut lines = Vec::new();
    add(tree, 0, &mut lines);
    lines
}

fn as_json(info: &SceneInfo) -> String {
    let text = |name: &Option<String>| name.as_deref().map_or("null".to_owned(), json::string);
    let count = |n: usize| n.to_string();
    let numbers = |point: [f32; 3]| json::list(point.map(|v| json::number(v.into())));
    json::object([
        ("files", json::list(info.files.iter().map(|file| json::string(&file.to_string_lossy())))),
        ("dialect", json::string(info.dialect.name())),
        ("camera", json::string(info.camera)),
        ("lights", count(info.lights)),
        ("materials", json::list(info.materials.iter().map(text))),
        (
            "objects",
            json::list(info.objects.iter().map(|object| {
                json::object([("keyword", json::string(&object.keyword)), ("name", text(&object.name))])
            })),
        ),
        ("nested_objects", info.nested_objects.to_string()),
        ("shapes", json::object(info.shapes.iter().map(|&(kind, n)| (kind, count(n))))),
        ("mesh_triangles", info.mesh_triangles.to_string()),
        ("bounds", info.bounds.map_or("null".to_owned(), |bounds| json::list(bounds.map(numbers)))),
        ("bytes", count(info.bytes)),
        ("tree", json_tree(&info.tree)),
    ])
}

fn json_tree(nodes: &[TreeNode]) -> String {
    json::list(nodes.iter().map(|node| {
        let name = node.name.as_deref().map_or("null".to_owned(), json::string);
        let children = json_tree(&node.children);
        json::object([("keyword", json::string(&node.keyword)), ("name", name), ("children", children)])
    }))
}
