//! The list of scenes of a gallery.
//!
//! One line a picture: its name, the scene file, arguments of the classic command line, or `render` and arguments of that
//! command. Words are separated by blanks; a word with blanks stands in double quotes. `#` at the start of a word begins a
//! comment.

use std::ffi::OsString;
use std::path::Path;

/// One line of the list.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Entry {
    /// Name of the picture, fit for a file's name on any system.
    pub name: String,
    /// The scene file, as written.
    pub scene: String,
    /// Whether the arguments are those of `kajo render`, not of the classic command line.
    pub is_modern: bool,
    /// Arguments, as written.
    pub arguments: Vec<String>,
}

impl Entry {
    /// The arguments with `@` at their start, or at that of a value `NAME=@...`, replaced by the place of the pictures.
    pub fn arguments_in(&self, out: &Path) -> Vec<OsString> {
        let file = |rest: &str| out.join(format!("{}{rest}", self.name)).into_os_string();
        let place = |argument: &String| match argument.split_once('@') {
            Some(("", rest)) => file(rest),
            Some((name, rest)) if name.ends_with('=') => {
                let mut value = OsString::from(name);
                value.push(file(rest));
                value
            }
            _ => OsString::from(argument),
        };
        self.arguments.iter().map(place).collect()
    }

    /// Whether the line itself says where the picture goes.
    pub fn names_output(&self) -> bool {
        self.arguments.iter().any(|argument| {
            let name = argument.split('=').next().unwrap_or(argument);
            matches!(name, "-output" | "--output" | "-o")
        })
    }
}

/// Reads the list.
///
/// # Errors
/// What is wrong with which line.
pub fn parse(text: &str) -> Result<Vec<Entry>, String> {
    let mut entries: Vec<Entry> = Vec::new();
    for (i, line) in text.trim_start_matches('\u{feff}').lines().enumerate() {
        let entry = parse_line(line).map_err(|problem| format!("line {}: {problem}", i + 1))?;
        let Some(entry) = entry else { continue };
        // Some file systems do not tell upper from lower case.
        let same = |other: &Entry| other.name.eq_ignore_ascii_case(&entry.name);
        if entries.iter().any(same) {
            return Err(format!("line {}: there is a picture `{}` already", i + 1, entry.name));
        }
        entries.push(entry);
    }
    if entries.is_empty() {
        return Err("there is no picture in it".to_owned());
    }
    Ok(entries)
}

fn parse_line(line: &str) -> Result<Option<Entry>, String> {
    let mut words = words(line)?.into_iter();
    let Some(name) = words.next() else { return Ok(None) };
    check_name(&name)?;
    let scene = words.next().ok_or_else(|| format!("`{name}` needs a scene file after it"))?;
    let mut arguments: Vec<String> = words.collect();
    let is_modern = arguments.first().is_some_and(|word| word == "render");
    if is_modern {
        arguments.remove(0);
    }
    Ok(Some(Entry { name, scene, is_modern, arguments }))
}

fn words(line: &str) -> Result<Vec<String>, String> {
    let mut words = Vec::new();
    let mut rest = line.trim_start();
    while !rest.is_empty() && !rest.starts_with('#') {
        let (word, after) = match rest.strip_prefix('"') {
            Some(quoted) => quoted.split_once('"').ok_or("a double quote is never closed")?,
            None => rest.split_at(rest.find(char::is_whitespace).unwrap_or(rest.len())),
        };
        words.push(word.to_owned());
        rest = after.trim_start();
    }
    Ok(words)
}

/// Names become names of files, which on some system or other may not hold these.
fn check_name(name: &str) -> Result<(), String> {
    let is_bad = |c: char| c.is_control() || r#"/\:*?"<>|@"#.contains(c);
    if name.is_empty() || name.starts_with(['.', '-']) || name.ends_with(['.', ' ']) || name.contains(is_bad)
    {
        return Err(format!("`{name}` cannot be the name of a file"));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_names_scenes_and_arguments() {
        let text = "\u{feff}# a list\r\n\nball r1+r2.txt -size 20 20 -depth 9 10 @.depth.png # why\r\nbox \"my box.txt\"\n";
        let entries = parse(text).unwrap();
        assert_eq!(entries.len(), 2);
        assert_eq!((entries[0].name.as_str(), entries[0].scene.as_str()), ("ball", "r1+r2.txt"));
        assert_eq!(entries[0].arguments.join(" "), "-size 20 20 -depth 9 10 @.depth.png");
        assert_eq!((entries[1].scene.as_str(), entries[1].arguments.len()), ("my box.txt", 0));
        assert_eq!(
            entries[0].arguments_in(Path::new("out")).last(),
            Some(&Path::new("out").join("ball.depth.png").into_os_string())
        );
        assert!(!entries[0].names_output());
        assert!(parse("a b -output x.png").unwrap()[0].names_output());
        let modern = &parse("a b render --tone aces --aov lights=@.groups.png").unwrap()[0];
        assert!(modern.is_modern && !entries[0].is_modern);
        let groups = format!("lights={}", Path::new("out").join("a.groups.png").display());
        assert_eq!(*modern.arguments_in(Path::new("out")).last().unwrap(), *groups);
    }

    #[test]
    fn mistakes_name_their_line() {
        for (text, part) in [
            ("a b\na c", "line 2: there is a picture `a` already"),
            ("a b\nA c", "line 2: "),
            ("\nball", "line 2: `ball` needs a scene file"),
            ("../x a.txt", "line 1: `../x` cannot be the name"),
            ("a \"b", "line 1: a double quote is never closed"),
            ("# nothing", "no picture"),
        ] {
            let problem = parse(text).unwrap_err();
            assert!(problem.contains(part), "{text:?} gave {problem}");
        }
    }
}
