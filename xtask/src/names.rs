//! Names of types, functions and files: which have a standard term in their place, and that one name is one type.

use std::collections::BTreeMap;
use std::path::Path;

/// Names of types, of functions and of files without their ending, with what to write instead. As words of prose and as variables they are
/// plain English.
const RETIRED: [(&[&str], &str); 4] = [
    (&["Place", "Places"], "Position, Point, Transform, or what is there"),
    (&["Piece", "Pieces"], "Patch, Segment, Span, WorkUnit, or what it is a part of"),
    (&["Meet", "Meets", "Met"], "hit, intersect, overlaps"),
    (&["Seen", "Walk", "Way"], "what is seen, or followed: a name for one thing"),
];

/// Those of them that no part of the name of a type may be.
const NOUNS: [&str; 5] = ["Place", "Places", "Piece", "Pieces", "Way"];

/// Names of types alone, with what to write instead; as a part of a longer name, or as a function, they are plain English.
const RETIRED_TYPES: [(&str, &str); 10] = [
    ("Ball", "BoundingSphere, or which sphere it is"),
    ("Bodies", "MediumStack"),
    ("Boundary", "Interface"),
    ("Departures", "PowerLightSampler"),
    ("Draws", "SampleStream"),
    ("Emitters", "LightSampler"),
    ("Paint", "ColorTexture"),
    ("Rivals", "PartialMis"),
    ("Share", "FloatTexture, or the share of what it is"),
    ("Witness", "PathObserver"),
];

/// The same of functions.
const RETIRED_FUNCTIONS: [(&str, &str); 4] = [
    ("squeeze", "eta_scale, or compact for an array"),
    ("throughput", "beta"),
    ("way_pdf", "pdf_li"),
    ("weight_of_chance", "mis_weight"),
];

/// What is wrong with the names in the files of a workspace.
///
/// * `files`: path from the root, and text
pub fn problems<'a>(files: impl Iterator<Item = (&'a str, &'a str)>) -> Vec<String> {
    let mut problems = Vec::new();
    let mut types: BTreeMap<(&str, &str), Vec<String>> = BTreeMap::new();
    for (path, text) in files.filter(|(path, _)| path.starts_with("crates/") && path.ends_with(".rs")) {
        let stem = Path::new(path).file_stem().and_then(|stem| stem.to_str()).unwrap_or_default();
        problems.extend(instead_of(stem, true).map(|instead| format!("{path}: call the file {instead}")));
        for (i, line) in text.lines().enumerate() {
            let Some((kind, name)) = definition(line) else { continue };
            let is_function = kind == "fn";
            let whole: &[_] = if is_function { &RETIRED_FUNCTIONS } else { &RETIRED_TYPES };
            let whole = whole.iter().find(|(retired, _)| *retired == name).map(|(_, instead)| *instead);
            problems.extend(
                instead_of(name, is_function)
                    .or(whole)
                    .map(|instead| format!("{path}:{}: `{kind} {name}` is retired, write {instead}", i + 1)),
            );
            // Benchmarks are modules of one kind, each with its settings and its report.
            let is_public = !is_function && line.starts_with("pub ") && !path.contains("/bench/");
            if let Some(name_of_crate) = path.split('/').nth(1).filter(|_| is_public) {
                types.entry((name_of_crate, name)).or_default().push(format!("{path}:{}", i + 1));
            }
        }
    }
    let twice = types.iter().filter(|(_, found)| found.len() > 1);
    problems.extend(
        twice.map(|((of, name), found)| {
            format!("{of}: `{name}` is {} types: {}", found.len(), found.join(", "))
        }),
    );
    problems
}

/// What to write in place of a retired name; functions and files are those of one word, which are verbs unless they are plural.
fn instead_of(name: &str, is_lower: bool) -> Option<&'static str> {
    // To place something is plain English.
    if is_lower && ["place", "seen", "walk", "met"].contains(&name) {
        return None;
    }
    let words = words_of(name);
    let is = |retired: &&str| match is_lower {
        true => retired.to_lowercase() == name,
        // A longer name of a type may end in a participle, as in what was seen, but not in one of these nouns.
        false => *retired == name || NOUNS.contains(retired) && words.contains(retired),
    };
    RETIRED.iter().find(|(retired, _)| retired.iter().any(is)).map(|(_, instead)| *instead)
}

/// The parts of the name of a type, each from one capital letter to the next.
fn words_of(name: &str) -> Vec<&str> {
    let starts: Vec<usize> = name.match_indices(char::is_uppercase).map(|(i, _)| i).collect();
    let ends = starts.iter().skip(1).copied().chain([name.len()]);
    starts.iter().zip(ends).map(|(&start, end)| &name[start..end]).collect()
}

/// The kind and the name of what a line begins to define, if it does.
fn definition(line: &str) -> Option<(&'static str, &str)> {
    let code = line.trim_start();
    let code = code.strip_prefix("pub").map_or(code, |rest| match rest.strip_prefix('(') {
        Some(scope) => scope.split_once(')').map_or(rest, |(_, rest)| rest),
        None => rest,
    });
    let code = code.trim_start();
    let code = code.strip_prefix("const fn").map_or(code, |_| &code["const ".len()..]);
    ["struct", "enum", "trait", "type", "union", "fn"].into_iter().find_map(|kind| {
        let rest = code.strip_prefix(kind)?.strip_prefix(' ')?;
        let end = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
        (end > 0).then_some((kind, &rest[..end]))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn definitions_are_found() {
        assert_eq!(definition("pub struct Place {"), Some(("struct", "Place")));
        assert_eq!(definition("    pub(in crate::x) const fn pieces(&self)"), Some(("fn", "pieces")));
        assert_eq!(definition("enum Way {"), Some(("enum", "Way")));
        for line in ["let place = 1;", "// struct Place", "const PLACE: u32 = 1;", "use x::Place;"] {
            assert_eq!(definition(line), None, "{line}");
        }
    }

    #[test]
    fn retired_names_are_refused_and_verbs_are_not() {
        let found = |path, text| problems([(path, text)].into_iter()).len();
        for text in ["struct Place;", "pub enum Piece {}", "fn pieces() {}", "fn meets() {}", "struct Walk;"]
        {
            assert_eq!(found("crates/a/src/b.rs", text), 1, "{text}");
        }
        for text in ["struct PatchWay;", "enum LeafPlace {}", "struct PieceOfCake;", "pub struct Rivals {}"] {
            assert_eq!(found("crates/x/src/a.rs", text), 1, "{text}");
        }
        for text in [
            "fn place() {}",
            "struct Placement;",
            "fn walk() {}",
            "struct PathSegment;",
            "struct Piecewise1D;",
            "struct HostShare;",
            "fn share() {}",
            "fn squeezed() {}",
        ] {
            assert_eq!(found("crates/a/src/b.rs", text), 0, "{text}");
        }
        for text in ["fn way_pdf() {}", "pub fn throughput(&self)", "trait Witness {}", "enum Paint {}"] {
            assert_eq!(found("crates/a/src/b.rs", text), 1, "{text}");
        }
        assert_eq!(found("crates/a/src/pieces.rs", ""), 1);
        assert_eq!(found("docs/pieces.md", "struct Place;"), 0);
    }

    #[test]
    fn one_public_name_is_one_type_of_a_crate() {
        let two = |a, b| problems([(a, "pub struct Grid;"), (b, "pub enum Grid {}")].into_iter());
        assert_eq!(two("crates/a/src/b.rs", "crates/a/src/c.rs").len(), 1);
        assert!(two("crates/a/src/b.rs", "crates/d/src/c.rs").is_empty());
        let private = [("crates/a/src/b.rs", "struct Parts;"), ("crates/a/src/c.rs", "struct Parts;")];
        assert!(problems(private.into_iter()).is_empty());
    }
}
