//! Reads the few lines of a `Cargo.toml` that the floors and the fuzzer look at.
//!
//! Not a TOML reader: sections in brackets and `key = value` lines are all that our manifests use.

use std::path::Path;

/// A `key` before `=` or `.`, with the name of its section and the rest of its line.
struct Entry<'a> {
    section: &'a str,
    key: &'a str,
    value: &'a str,
}

/// The crates a manifest asks for.
pub struct Dependencies {
    /// For the library itself, on whichever platform.
    pub normal: Vec<String>,
    /// For its tests, benches and build script.
    pub development: Vec<String>,
}

/// Reads the dependencies out of the text of a manifest.
pub fn dependencies(text: &str) -> Dependencies {
    let mut all = Dependencies { normal: Vec::new(), development: Vec::new() };
    for Entry { section, key, .. } in entries(text) {
        let (table, inline) = section.split_once("dependencies").unwrap_or(("none", ""));
        // `[dependencies.NAME]` is as good as a line `NAME = { ... }`.
        let name = inline.strip_prefix('.').unwrap_or(key).to_owned();
        let list = match table {
            "none" | "workspace." => continue,
            "dev-" | "build-" => &mut all.development,
            _ => &mut all.normal,
        };
        if !list.contains(&name) {
            list.push(name);
        }
    }
    all
}

/// Whether the crate is checked by the lints of the workspace.
pub fn takes_workspace_lints(text: &str) -> bool {
    entries(text).any(|entry| entry.section == "lints" && entry.key == "workspace" && entry.value == "true")
}

/// Names of the `[[bin]]` sections of the manifest at `path`.
pub fn binaries(path: &Path) -> Result<Vec<String>, String> {
    let text = std::fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))?;
    let names = entries(&text).filter(|entry| entry.section == "[bin]" && entry.key == "name");
    Ok(names.map(|entry| entry.value.trim_matches('"').to_owned()).collect())
}

fn entries(text: &str) -> impl Iterator<Item = Entry<'_>> {
    let mut section = "";
    text.lines().filter_map(move |line| {
        let line = line.split('#').next().unwrap_or(line).trim();
        if let Some(name) = line.strip_prefix('[').and_then(|rest| rest.strip_suffix(']')) {
            section = name;
            return None;
        }
        let (key, value) = line.split_once('=')?;
        let key = key.split('.').next().unwrap_or(key).trim();
        Some(Entry { section, key, value: value.trim() })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dependencies_are_found_in_every_spelling() {
        let text = "[package]\nname = \"x\" # a comment\n\n[dependencies]\na.workspace = true\nb = { path = \"b\" }\n\
                    [target.'cfg(unix)'.dependencies]\nc = \"1\"\n[dependencies.d]\nversion = \"1\"\n\
                    [dev-dependencies]\ne = \"1\"\n[build-dependencies]\nf = \"1\"\n[lints]\nworkspace = true\n";
        let Dependencies { normal, development } = dependencies(text);
        assert_eq!(normal, ["a", "b", "c", "d"]);
        assert_eq!(development, ["e", "f"]);
        assert!(takes_workspace_lints(text) && !takes_workspace_lints("[lints.rust]\nworkspace = true\n"));
        assert!(dependencies("[workspace.dependencies]\na = \"1\"\n").normal.is_empty());
    }
}
