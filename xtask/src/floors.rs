//! Who may import whom.
//!
//! A crate imports crates of lower floors only, as `ARCHITECTURE.md` lists them; some third-party crates
//! are kept to one crate of ours. Inside `kajo-core` the modules are ordered in the same way, in no crate do files need
//! each other in a circle, and no function is long.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::manifest::{self, Dependencies};
use crate::{cycles, lengths};

/// Each crate of the workspace, lowest floor first, and the crates it may import.
const CRATES: [(&str, &[&str]); 16] = [
    ("kajo-math", &[]),
    ("kajo-color", &["kajo-math"]),
    ("kajo-bvh", &["kajo-math"]),
    ("kajo-scene", &["kajo-math"]),
    ("kajo-image", &["kajo-color", "kajo-math"]),
    ("kajo-core", &["kajo-scene", "kajo-image", "kajo-bvh", "kajo-color", "kajo-math"]),
    ("kajo-render", &["kajo-core", "kajo-scene", "kajo-image", "kajo-bvh", "kajo-color", "kajo-math"]),
    (
        "kajo",
        &["kajo-render", "kajo-core", "kajo-scene", "kajo-image", "kajo-bvh", "kajo-color", "kajo-math"],
    ),
    (
        "kajo-edit",
        &[
            "kajo",
            "kajo-render",
            "kajo-core",
            "kajo-scene",
            "kajo-image",
            "kajo-bvh",
            "kajo-color",
            "kajo-math",
        ],
    ),
    (
        "kajo-selftest",
        &[
            "kajo",
            "kajo-render",
            "kajo-core",
            "kajo-scene",
            "kajo-image",
            "kajo-bvh",
            "kajo-color",
            "kajo-math",
        ],
    ),
    ("kajo-farm", &["kajo"]),
    ("kajo-cli", &["kajo", "kajo-farm", "kajo-selftest"]),
    ("kajo-py", &["kajo", "kajo-edit", "kajo-farm", "kajo-selftest"]),
    ("kajo-studio", &["kajo", "kajo-edit", "kajo-math"]),
    ("kajo-testkit", &["kajo-math", "kajo-color", "kajo-image"]),
    ("xtask", &[]),
];

/// Helpers that any crate may use in its tests.
const TESTKIT: &str = "kajo-testkit";

/// Third-party crates that one crate of ours hides from the others.
const KEPT: [(&str, &str); 11] = [
    ("annotate-snippets", "kajo-scene"),
    ("clap", "kajo-cli"),
    ("eframe", "kajo-studio"),
    ("egui", "kajo-studio"),
    ("egui-wgpu", "kajo-studio"),
    ("exr", "kajo-image"),
    ("glam", "kajo-math"),
    ("image", "kajo-image"),
    ("png", "kajo-image"),
    ("pyo3", "kajo-py"),
    ("wgpu", "kajo-studio"),
];

/// The modules of `kajo-core` and those that each may name. `scene` is above all families, so that no
/// family can see it; `compile` is above `scene`.
const CORE_MODULES: [(&str, &[&str]); 36] = [
    ("ids", &[]),
    ("family", &[]),
    ("differential", &[]),
    ("interaction", &[]),
    ("motion", &[]),
    ("animation", &[]),
    ("moving_tree", &["motion"]),
    ("measured", &[]),
    ("bsdf", &["interaction", "measured"]),
    ("texture", &["family", "interaction"]),
    ("material", &["family", "interaction", "texture", "emission", "bsdf", "measured", "medium"]),
    ("emission", &["ids", "family", "texture", "light", "medium"]),
    ("shape", &["ids", "family", "interaction", "motion"]),
    (
        "light",
        &[
            "ids",
            "differential",
            "family",
            "interaction",
            "background",
            "environment",
            "daylight",
            "motion",
            "shape",
            "sky_disc",
            "star_field",
        ],
    ),
    ("item_buffer", &["ids", "shape"]),
    ("curved_light", &["differential"]),
    ("medium", &["curved_light", "differential", "family", "interaction", "motion", "texture"]),
    ("objects", &[]),
    ("nested", &["ids", "interaction", "material", "objects", "shape"]),
    ("camera", &["interaction", "motion"]),
    ("sampler", &["interaction"]),
    ("settings", &["bsdf", "interaction", "light", "sampler", "texture"]),
    ("environment", &[]),
    ("sky_disc", &[]),
    ("daylight", &["environment", "sky_disc"]),
    ("star_field", &["differential"]),
    ("background", &["differential", "interaction", "environment", "daylight", "star_field"]),
    (
        "scene",
        &[
            "ids",
            "differential",
            "family",
            "interaction",
            "bsdf",
            "settings",
            "texture",
            "material",
            "emission",
            "shape",
            "light",
            "item_buffer",
            "medium",
            "animation",
            "motion",
            "moving_tree",
            "nested",
            "objects",
            "camera",
            "sampler",
            "background",
        ],
    ),
    ("schema", &["scene", "settings"]),
    (
        "lighting",
        &[
            "ids",
            "differential",
            "interaction",
            "bsdf",
            "texture",
            "emission",
            "light",
            "material",
            "sampler",
            "scene",
        ],
    ),
    ("emissive_media", &["ids", "medium", "scene", "space"]),
    ("shading", &["interaction", "material", "scene"]),
    ("space", &["ids", "curved_light", "differential", "medium", "scene"]),
    (
        "builder",
        &[
            "ids",
            "family",
            "settings",
            "texture",
            "material",
            "emission",
            "shape",
            "light",
            "medium",
            "motion",
            "nested",
            "objects",
            "camera",
            "background",
            "scene",
        ],
    ),
    // Tests only: what holds for all families.
    (
        "laws",
        &[
            "family",
            "motion",
            "bsdf",
            "texture",
            "material",
            "emission",
            "shape",
            "light",
            "measured",
            "medium",
            "daylight",
            "background",
            "camera",
        ],
    ),
    (
        "compile",
        &[
            "ids",
            "family",
            "interaction",
            "bsdf",
            "settings",
            "texture",
            "material",
            "emission",
            "shape",
            "light",
            "measured",
            "curved_light",
            "differential",
            "medium",
            "animation",
            "motion",
            "moving_tree",
            "nested",
            "objects",
            "camera",
            "sampler",
            "background",
            "environment",
            "daylight",
            "star_field",
            "scene",
            "schema",
            "builder",
            "emissive_media",
            "lighting",
            "shading",
        ],
    ),
];

/// The one crate whose kernels may be `unsafe`.
const MAY_BE_UNSAFE: &str = "crates/kajo-bvh";

/// The one file elsewhere that may: it calls a C library.
const MAY_CALL_C: &str = "crates/kajo-image/src/denoise/oidn.rs";

/// Reads every manifest and every source.
///
/// # Errors
/// The imports that go upwards and the places that let unsafe code in, one a line.
pub fn check(root: &Path) -> Result<(), Vec<String>> {
    let mut problems = Vec::new();
    let result = check_crates(root, &mut problems)
        .and_then(|()| check_modules(root, &mut problems))
        .and_then(|()| check_cycles(root, &mut problems))
        .and_then(|()| check_lengths(root, &mut problems))
        .and_then(|()| check_unsafe(root, &mut problems));
    problems.extend(result.err());
    if problems.is_empty() { Ok(()) } else { Err(problems) }
}

fn check_crates(root: &Path, problems: &mut Vec<String>) -> Result<(), String> {
    for folder in folders(&root.join("crates"))?.into_iter().chain([root.join("xtask")]) {
        let name = file_name(&folder);
        let text = read(&folder.join("Cargo.toml"))?;
        problems.extend(crate_problems(&name, &manifest::dependencies(&text)));
    }
    Ok(())
}

fn crate_problems(name: &str, dependencies: &Dependencies) -> Vec<String> {
    let Some((_, allowed)) = CRATES.iter().find(|(known, _)| *known == name) else {
        return vec![format!("{name}: this crate has no floor yet; give it one in xtask/src/floors.rs")];
    };
    let is_ours = |import: &&String| CRATES.iter().any(|(known, _)| known == import);
    let ours = dependencies.normal.iter().filter(is_ours);
    let upward = ours.filter(|import| !allowed.contains(&import.as_str()));
    let tests = dependencies.development.iter().filter(is_ours);
    let upward_tests = tests.filter(|import| !allowed.contains(&import.as_str()) && *import != TESTKIT);
    let kept = KEPT.iter().filter(|(import, owner)| {
        *owner != name && dependencies.normal.iter().any(|dependency| dependency == import)
    });
    upward
        .map(|import| format!("{name} imports {import}, which is not on a floor below it"))
        .chain(upward_tests.map(|import| format!("the tests of {name} import {import}")))
        .chain(kept.map(|(import, owner)| format!("{name} imports {import}, which is kept to {owner}")))
        .collect()
}

fn check_modules(root: &Path, problems: &mut Vec<String>) -> Result<(), String> {
    let allowed = BTreeMap::from(CORE_MODULES);
    let sources = root.join("crates/kajo-core/src");
    for path in rust_files(&sources)? {
        let inside = path.strip_prefix(&sources).unwrap_or(&path);
        let module = inside.iter().next().map(|part| part.to_string_lossy().into_owned()).unwrap_or_default();
        let module = module.trim_end_matches(".rs");
        if module == "lib" {
            continue;
        }
        let Some(allowed) = allowed.get(module) else {
            problems.push(format!("kajo-core/{module}: this module has no floor yet"));
            continue;
        };
        let text = read(&path)?;
        for (line, import) in crate_imports(&text) {
            let known = CORE_MODULES.iter().any(|(name, _)| *name == import);
            if known && import != module && !allowed.contains(&import) {
                problems.push(format!("{}:{line}: {module} must not see {import}", relative(root, &path)));
            }
        }
    }
    Ok(())
}

fn check_cycles(root: &Path, problems: &mut Vec<String>) -> Result<(), String> {
    for folder in folders(&root.join("crates"))?.into_iter().chain([root.join("xtask")]) {
        let sources = folder.join("src");
        let read = |path: PathBuf| Ok((relative(&sources, &path), read(&path)?));
        let sources = rust_files(&sources)?.into_iter().map(read).collect::<Result<Vec<_>, String>>()?;
        for cycle in cycles::find(&sources) {
            let files = cycle.files.join(", ");
            problems.push(format!("{}: these files need each other: {files}", file_name(&folder)));
            problems.extend(cycle.ties.iter().map(|tie| format!("  {tie}")));
        }
    }
    Ok(())
}

/// Every function can be held in one's head, but for those of tests.
fn check_lengths(root: &Path, problems: &mut Vec<String>) -> Result<(), String> {
    for folder in folders(&root.join("crates"))?.into_iter().chain([root.join("xtask")]) {
        if file_name(&folder) == TESTKIT {
            continue;
        }
        for path in rust_files(&folder.join("src"))? {
            let name = relative(root, &path);
            if name.contains("/tests/") || name.contains("/laws/") || name.ends_with("tests.rs") {
                continue;
            }
            let text = read(&path)?;
            let long = lengths::find(&text).into_iter();
            problems.extend(
                long.map(|(line, function, length)| {
                    format!("{name}:{line}: `{function}` has {length} lines")
                }),
            );
        }
    }
    Ok(())
}

/// Modules named after `crate::`, with their lines; comments, where pages link to each other, are left out.
fn crate_imports(text: &str) -> Vec<(usize, &str)> {
    let mut imports = Vec::new();
    for (i, line) in text.lines().enumerate() {
        for rest in code_of(line).split("crate::").skip(1) {
            // `use crate::{a, b::C}` names several.
            let group = rest.strip_prefix('{').and_then(|list| list.split('}').next());
            let names = group.map_or_else(|| vec![rest], |list| list.split(',').map(str::trim).collect());
            imports.extend(names.into_iter().map(|name| (i + 1, first_word(name))));
        }
    }
    imports
}

/// The compiler denies `unsafe_code` wherever a manifest takes the workspace's lints and no attribute
/// lifts them; both are looked for here. Tests may: one that counts allocations cannot do without.
fn check_unsafe(root: &Path, problems: &mut Vec<String>) -> Result<(), String> {
    let safe = |folder: &PathBuf| relative(root, folder) != MAY_BE_UNSAFE;
    for folder in folders(&root.join("crates"))?.into_iter().chain([root.join("xtask")]).filter(safe) {
        if !manifest::takes_workspace_lints(&read(&folder.join("Cargo.toml"))?) {
            problems
                .push(format!("{}: the lints of the workspace are not taken over", relative(root, &folder)));
        }
        for path in rust_files(&folder.join("src"))? {
            let text = read(&path)?;
            let place = relative(root, &path);
            if place == MAY_CALL_C {
                continue;
            }
            problems.extend(lifted_lints(&text).map(|line| format!("{place}:{line}: unsafe code is let in")));
        }
    }
    Ok(())
}

/// Lines with an attribute that lets unsafe code in.
fn lifted_lints(text: &str) -> impl Iterator<Item = usize> {
    let lifts =
        |line: &str| ["allow(unsafe_code", "expect(unsafe_code"].iter().any(|word| line.contains(word));
    let attributes =
        text.lines().enumerate().filter(move |(_, line)| line.trim_start().starts_with('#') && lifts(line));
    attributes.map(|(i, _)| i + 1)
}

fn code_of(line: &str) -> &str {
    line.split("//").next().unwrap_or(line)
}

fn first_word(text: &str) -> &str {
    let end = text.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(text.len());
    &text[..end]
}

fn rust_files(folder: &Path) -> Result<Vec<PathBuf>, String> {
    let mut files = Vec::new();
    for path in entries(folder)? {
        if path.is_dir() && file_name(&path) != "target" {
            files.extend(rust_files(&path)?);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
    Ok(files)
}

fn folders(folder: &Path) -> Result<Vec<PathBuf>, String> {
    Ok(entries(folder)?.into_iter().filter(|path| path.join("Cargo.toml").is_file()).collect())
}

fn entries(folder: &Path) -> Result<Vec<PathBuf>, String> {
    let problem = |error| format!("{}: {error}", folder.display());
    let list: Result<Vec<PathBuf>, _> =
        std::fs::read_dir(folder).map_err(problem)?.map(|entry| entry.map(|entry| entry.path())).collect();
    let mut list = list.map_err(problem)?;
    list.sort();
    Ok(list)
}

fn read(path: &Path) -> Result<String, String> {
    std::fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))
}

fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

fn relative(root: &Path, path: &Path) -> String {
    path.strip_prefix(root).unwrap_or(path).to_string_lossy().replace('\\', "/")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn importing(normal: &[&str], development: &[&str]) -> Dependencies {
        let owned = |names: &[&str]| names.iter().map(|&name| name.to_owned()).collect();
        Dependencies { normal: owned(normal), development: owned(development) }
    }

    #[test]
    fn the_workspace_keeps_its_floors() {
        assert_eq!(check(&crate::workspace_root()), Ok(()));
    }

    #[test]
    fn crates_import_downwards_only() {
        let problems =
            |name, normal: &[&str], tests: &[&str]| crate_problems(name, &importing(normal, tests)).len();
        assert_eq!(
            problems("kajo-core", &["kajo-math", "kajo-bvh", "thiserror"], &["kajo-testkit", "proptest"]),
            0
        );
        assert_eq!(problems("kajo-math", &["kajo-color"], &[]), 1);
        assert_eq!(problems("kajo-core", &["kajo-testkit"], &[]), 1);
        assert_eq!(problems("kajo-bvh", &[], &["kajo-core"]), 1);
        assert_eq!(problems("kajo-cli", &["kajo", "kajo-render", "png"], &[]), 2);
        assert_eq!(problems("kajo-new", &[], &[]), 1);
    }

    #[test]
    fn the_table_itself_goes_downwards() {
        let floor = |name: &str| CRATES.iter().position(|(known, _)| *known == name);
        for (name, allowed) in CRATES {
            assert!(allowed.iter().all(|import| floor(import) < floor(name)), "{name}");
        }
        let floor = |name: &str| CORE_MODULES.iter().position(|(known, _)| *known == name);
        for (name, allowed) in CORE_MODULES {
            assert!(allowed.iter().all(|import| floor(import).is_some() && *import != name), "{name}");
        }
    }

    #[test]
    fn imports_are_found_in_code_and_not_in_comments() {
        let text = "use crate::shape::Sphere;\n/// See [`crate::scene`].\nlet x = crate::light::f();\n\
                    use crate::{bsdf::Phong, texture};\n";
        assert_eq!(crate_imports(text), [(1, "shape"), (3, "light"), (4, "bsdf"), (4, "texture")]);
    }

    #[test]
    fn attributes_that_let_unsafe_code_in_are_found() {
        let text = "#![forbid(unsafe_code)]\n// allow(unsafe_code)\n#[allow(unsafe_code)]\nfn f() {}\n    #![expect(unsafe_code)]\n";
        assert_eq!(lifted_lints(text).collect::<Vec<_>>(), [3, 5]);
    }
}
