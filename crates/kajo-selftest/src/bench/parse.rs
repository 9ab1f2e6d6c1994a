//! How fast scene text is read: parsing alone, and parsing with compiling.

use std::fmt::Write;

use kajo_core::compile::{CompileOptions, compile};
use kajo_scene::{Limits, MemoryAssets, SceneDesc};

use super::pcg::uniform;
use super::time::{Seconds, Times, timed};

/// One material to so many lines of objects.
const OBJECTS_PER_MATERIAL: usize = 99;

/// What a run showed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Report {
    /// Lines of text.
    pub lines: usize,
    /// Bytes of text.
    pub bytes: usize,
    /// Objects in the scene that came of it.
    pub objects: usize,
    /// From text to its tree.
    pub parse: Times,
    /// From text to a scene that can be rendered.
    pub load: Times,
}

/// The text did not become the scene it describes.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the scene of {expected} objects was read as one of {found}:\n{report}")]
pub struct ParseError {
    expected: usize,
    found: usize,
    report: String,
}

/// Reads a scene of about `lines` lines `passes` times.
///
/// # Errors
/// [`ParseError`] when the scene read is not the one written.
pub fn run(lines: usize, passes: usize) -> Result<Report, ParseError> {
    let (text, expected) = scene(lines);
    let limits = Limits { items: usize::MAX, ..Limits::default() };
    let assets = MemoryAssets::new();
    let options = CompileOptions::default();
    let (mut parses, mut loads) = (Vec::new(), Vec::new());
    for _ in 0..passes.max(1) {
        let (mut parsed, parse) = timed(|| SceneDesc::parse("bench.txt", text.as_str(), &assets, &limits));
        let (scene, compiled) =
            timed(|| compile(&mut parsed.desc, &assets, &options, &mut parsed.diagnostics));
        let found = scene.map_or(0, |scene| scene.geometry.primitives.len());
        if found != expected {
            let report = kajo_scene::render(&parsed.diagnostics, parsed.desc.sources(), false);
            return Err(ParseError { expected, found, report });
        }
        loads.push(Seconds { wall: parse.wall + compiled.wall, cpu: parse.cpu + compiled.cpu });
        parses.push(parse);
    }
    Ok(Report {
        lines: text.lines().count(),
        bytes: text.len(),
        objects: expected,
        parse: Times::of(&parses),
        load: Times::of(&loads),
    })
}

/// Text of spheres and triangles in many materials, and the number of its objects.
fn scene(lines: usize) -> (String, usize) {
    let materials = (lines / (OBJECTS_PER_MATERIAL + 1)).max(1);
    let objects = lines.saturating_sub(materials);
    let mut text = String::from(
        "PerspectiveCamera { center 0 0 50  direction 0 0 -1  up 0 1 0  angle 30 }\n\
         Lights { DirectionalLight { direction -1 -1 -1  color 1 1 1 } }\nMaterials {\n",
    );
    // Writing to a string cannot fail.
    for i in 0..materials {
        let _ = writeln!(text, "  PhongMaterial {{ diffuseColor {} }}", numbers(i, [0, 1, 2], 1.0));
    }
    text.push_str("}\nGroup {\n");
    for i in 0..objects {
        let select = match i % OBJECTS_PER_MATERIAL {
            0 => format!("MaterialIndex {}  ", (i / OBJECTS_PER_MATERIAL).min(materials - 1)),
            _ => String::new(),
        };
        let first = numbers(i, [3, 4, 5], 20.0);
        let _ = match i % 2 {
            0 => writeln!(text, "  {select}Sphere {{ center {first} radius 0.25 }}"),
            _ => {
                let (second, third) = (numbers(i, [6, 7, 8], 20.0), numbers(i, [9, 10, 11], 20.0));
                writeln!(text, "  {select}Triangle {{ vertex0 {first} vertex1 {second} vertex2 {third} }}")
            }
        };
    }
    text.push_str("}\n");
    (text, objects)
}

/// Three numbers of item `i` in [0, `scale`), with six digits behind the point.
fn numbers(i: usize, dimensions: [u32; 3], scale: f64) -> String {
    let [x, y, z] = dimensions.map(|k| uniform(i as u32, k) * scale);
    format!("{x:.6} {y:.6} {z:.6}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_text_is_the_scene_it_says() {
        let report = run(1000, 1).unwrap();
        assert_eq!(report.objects, 990);
        assert!((1000..=1010).contains(&report.lines), "{}", report.lines);
        assert!(report.load.wall.median >= report.parse.wall.median);
        assert_eq!(scene(500).0, scene(500).0);
    }

    #[test]
    fn tiny_scenes_work_too() {
        assert_eq!(run(0, 0).unwrap().objects, 0);
        assert_eq!(run(3, 1).unwrap().objects, 2);
    }
}
