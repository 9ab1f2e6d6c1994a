//! Words that no file of ours may hold: unfinished work, and paths of one person's machine.

use std::path::{Path, PathBuf};
use std::process::Command;

/// Places that exist on one machine only, and marks of work left undone.
const BANNED: [&str; 8] = ["/home/", "/root/", "/Users/", "/work/", "TODO", "FIXME", "XXX", "HACK"];

/// Files that list the banned words themselves, or that other people wrote.
const EXCEPT: [&str; 2] = ["xtask/src/words.rs", "Cargo.lock"];

/// Searches every text file that git would track.
///
/// # Errors
/// The places found, one a line.
pub fn check(root: &Path) -> Result<(), Vec<String>> {
    let mut problems = Vec::new();
    for path in tracked(root).map_err(|problem| vec![problem])? {
        let name = path.to_string_lossy();
        let text = std::fs::read_to_string(root.join(&path));
        // What is no UTF-8 is a picture or the like; what is gone was deleted but not yet committed.
        let Ok(text) = text else { continue };
        if !EXCEPT.contains(&&*name) {
            problems.extend(banned_lines(&text).map(|(line, word)| format!("{name}:{line}: `{word}`")));
        }
    }
    if problems.is_empty() { Ok(()) } else { Err(problems) }
}

fn banned_lines(text: &str) -> impl Iterator<Item = (usize, &'static str)> {
    text.lines().enumerate().flat_map(|(i, line)| {
        let found = BANNED.iter().filter(move |word| line.contains(**word));
        found.map(move |word| (i + 1, *word))
    })
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
    fn no_file_holds_one() {
        assert_eq!(check(&crate::workspace_root()), Ok(()));
    }
}
