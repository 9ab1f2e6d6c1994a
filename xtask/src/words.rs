//! Words that no file of ours may hold: unfinished work, paths of one person's machine, and names for which the field has
//! a standard term.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::names;

/// Places that exist on one machine only, and marks of work left undone.
const BANNED: [&str; 8] = ["/home/", "/root/", "/Users/", "/work/", "TODO", "FIXME", "XXX", "HACK"];

/// Files that list the banned words themselves, or that other people wrote.
const EXCEPT: [&str; 2] = ["xtask/src/words.rs", "Cargo.lock"];

/// Words that were given up, with the standard terms of the field that stand in their place; `docs/src/glossary.md` says what
/// they mean. Each is looked for as a word of prose and as a part of a name, in any case, in the singular and the plural.
const RETIRED: [(&str, &str); 6] = [
    ("chore", "task"),
    ("fibre", "fuzz (the layer), fiber (one of its hairs)"),
    ("glow", "emission, emissive, to emit"),
    ("lamp", "light, or emitter where `light` would be misread"),
    ("pigment", "diffuse base"),
    ("varnish", "coat"),
];

/// Files that need a retired word, and why; what ends with a slash is a folder.
const STILL_NEEDED: [(&str, &str); 13] = [
    // The word of the standard IES LM-63 for what gives light in a luminaire.
    ("crates/kajo-scene/src/ies.rs", "lamp"),
    ("crates/kajo-core/src/light/photometric.rs", "lamp"),
    ("crates/kajo-core/src/light/tests/emission.rs", "lamp"),
    // A keyword of scenes that exist.
    ("crates/kajo-core/src/settings.rs", "lamp"),
    ("docs/src/language/settings.md", "lamp"),
    // The term of the Academy's reference rendering for one of its steps.
    ("crates/kajo-color/src/aces.rs", "glow"),
    ("docs/src/maths/tone.md", "glow"),
    // Names of files and materials that exist.
    ("scenes/", "glow"),
    ("docs/src/language/pictures.md", "glow"),
    // It tells of the change.
    ("CHANGELOG.md", "lamp"),
    // A keyword of POV-Ray.
    ("crates/kajo-selftest/src/bench/whitted/peers.rs", "pigment"),
    ("scenes/bench/solids.py", "pigment"),
    ("scenes/bench/povray.py", "pigment"),
];

/// Searches every text file that git would track.
///
/// # Errors
/// The places found, one a line.
pub fn check(root: &Path) -> Result<(), Vec<String>> {
    let read = |path: PathBuf| {
        // What is no UTF-8 is a picture or the like; what is gone was deleted but not yet committed.
        let text = std::fs::read_to_string(root.join(&path)).ok()?;
        Some((path.to_string_lossy().into_owned(), text))
    };
    let files: Vec<(String, String)> =
        tracked(root).map_err(|problem| vec![problem])?.into_iter().filter_map(read).collect();
    let mut problems = names::problems(files.iter().map(|(name, text)| (&**name, &**text)));
    for (name, text) in &files {
        if !EXCEPT.contains(&&**name) {
            problems.extend(banned_lines(text).map(|(line, word)| format!("{name}:{line}: `{word}`")));
            let retired = retired_lines(text).filter(|(_, (word, _))| !is_needed(name, word));
            let told =
                |(line, (word, instead))| format!("{name}:{line}: `{word}` is retired, write {instead}");
            problems.extend(retired.map(told));
        }
    }
    if problems.is_empty() { Ok(()) } else { Err(problems) }
}

/// Whether a file is one of those that need this word.
fn is_needed(file: &str, word: &str) -> bool {
    let here = |place: &str| if place.ends_with('/') { file.starts_with(place) } else { file == place };
    STILL_NEEDED.iter().any(|&(place, needed)| needed == word && here(place))
}

fn banned_lines(text: &str) -> impl Iterator<Item = (usize, &'static str)> {
    text.lines().enumerate().flat_map(|(i, line)| {
        let found = BANNED.iter().filter(move |word| line.contains(**word));
        found.map(move |word| (i + 1, *word))
    })
}

/// The lines with retired words, each with the word and what to write instead.
fn retired_lines(text: &str) -> impl Iterator<Item = (usize, (&'static str, &'static str))> {
    text.lines().enumerate().flat_map(|(i, line)| {
        let found = RETIRED.iter().filter(move |(word, _)| words_of(line).any(|name| is_form_of(name, word)));
        found.map(move |&retired| (i + 1, retired))
    })
}

/// The words of a line, those of `snake_case` and `CamelCase` names one by one.
fn words_of(line: &str) -> impl Iterator<Item = &str> {
    line.split(|c: char| !c.is_alphabetic()).flat_map(|name| {
        let humps = name
            .char_indices()
            .filter(move |&(i, c)| i > 0 && c.is_uppercase() && !name[..i].ends_with(char::is_uppercase));
        let ends = humps.map(|(i, _)| i).chain([name.len()]);
        ends.scan(0, move |start, end| Some(&name[std::mem::replace(start, end)..end]))
    })
}

/// Whether a name is this word, in any case, in the singular or the plural, or a participle of it.
fn is_form_of(name: &str, word: &str) -> bool {
    let name = name.to_lowercase();
    name.strip_prefix(word).is_some_and(|rest| matches!(rest, "" | "s" | "es" | "ed" | "ing"))
}

fn tracked(root: &Path) -> Result<Vec<PathBuf>, String> {
    let git = ["ls-files", "-z", "--cached", "--others", "--exclude-standard"];
    let output = Command::new("git").args(git).current_dir(root).output();
    let output = output.map_err(|error| format!("git did not start: {error}"))?;
    if !output.status.success() {
        return Err(format!("git ls-files: {}", String::from_utf8_lossy(&output.stderr).trim()));
    }
    let names = output.stdout.split(|&byte| byte == 0).filter(|name| !name.is_empty());
    Ok(names.map(|name| PathBuf::from(String::from_utf8_lossy(name).into_owned())).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn banned_words_are_found_with_their_lines() {
        let found: Vec<_> = banned_lines("fine\n// TODO: later\nsee /home/me/x\n").collect();
        assert_eq!(found, [(2, "TODO"), (3, "/home/")]);
        assert_eq!(banned_lines("a todo list at home/\n").count(), 0);
    }

    #[test]
    fn retired_words_are_found_in_prose_and_in_names() {
        let found = |text: &'static str| {
            retired_lines(text).map(|(line, (word, _))| (line, word)).collect::<Vec<_>>()
        };
        assert_eq!(found("light\nThe lamp's light\n"), [(2, "lamp")]);
        for text in ["LAMPS", "lamp_pdf", "PATH_LAMPS", "LampPath", "toLamps", "two lamps.", "Lamps"] {
            assert_eq!(found(text), [(1, "lamp")], "{text}");
        }
        assert_eq!(found("a varnished top"), [(1, "varnish")]);
        assert_eq!(found("glowing gas"), [(1, "glow")]);
        for text in ["clamp", "Clamped", "clamps", "lampoon", "CLAMP", "SliderClamping"] {
            assert_eq!(found(text), [], "{text}");
        }
    }

    #[test]
    fn no_file_holds_one() {
        assert_eq!(check(&crate::workspace_root()), Ok(()));
    }
}
