//! The diagnostics of the scene, ready to be shown beside the text.

use kajo::{Diagnostics, Severity, Sources};

/// A message about the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Problem {
    /// How bad it is.
    pub severity: Severity,
    /// What is wrong, in a line.
    pub message: String,
    /// What to do about it.
    pub help: Option<String>,
    /// Where it is, if anywhere.
    pub place: Option<SourcePosition>,
}

/// A piece of a line.
#[derive(Clone, Debug, PartialEq)]
pub struct SourcePosition {
    /// The file, as the scene names it.
    pub file: String,
    /// The line, from 1.
    pub line: usize,
    /// The column of its first character, from 1.
    pub column: usize,
    /// Number of characters on that line, at least 1.
    pub width: usize,
    /// The whole line.
    pub text: String,
    /// A few words about the place; may be empty.
    pub label: String,
}

/// Every message with its place, the worst first.
pub fn problems(diagnostics: &Diagnostics, sources: &Sources) -> Vec<Problem> {
    let mut problems: Vec<Problem> = diagnostics
        .iter()
        .map(|diagnostic| Problem {
            severity: diagnostic.severity,
            message: diagnostic.message.clone(),
            help: diagnostic.help.clone(),
            place: diagnostic.labels.first().map(|label| {
                let position = sources.position(label.span);
                let text = line_of(sources.get(label.span.source).text(), label.span.range().start);
                let rest = text.chars().count().saturating_sub(position.column - 1);
                let width = sources.text(label.span).lines().next().map_or(1, |line| line.chars().count());
                SourcePosition {
                    file: sources.get(label.span.source).path().to_owned(),
                    line: position.line,
                    column: position.column,
                    width: width.clamp(1, rest.max(1)),
                    text: text.to_owned(),
                    label: label.text.clone(),
                }
            }),
        })
        .collect();
    problems.sort_by_key(|problem| std::cmp::Reverse(problem.severity));
    problems
}

/// The line around a place in a text, without its end.
fn line_of(text: &str, at: usize) -> &str {
    let before = text.get(..at).unwrap_or(text);
    let begin = before.rfind(['\n', '\r']).map_or(0, |end| end + 1);
    text[begin..].split(['\n', '\r']).next().unwrap_or("")
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo::{LoadOptions, MemoryAssets};

    fn of(text: &str) -> Vec<Problem> {
        let assets = MemoryAssets::new().with("scene.txt", text);
        let loaded = kajo::load_from("scene.txt", &assets, &LoadOptions::default());
        problems(&loaded.diagnostics, loaded.sources())
    }

    #[test]
    fn a_mistake_is_shown_with_its_line() {
        let found = of("// a comment\r\nGroup {\n  Sphre { radius 1 }\n}\n");
        let problem = found.iter().find(|problem| problem.message.contains("Sphre")).expect("a message");
        assert_eq!(problem.severity, Severity::Error);
        let place = problem.place.as_ref().expect("a place");
        assert_eq!((place.file.as_str(), place.line, place.column, place.width), ("scene.txt", 3, 3, 5));
        assert_eq!(place.text, "  Sphre { radius 1 }");
    }

    #[test]
    fn errors_come_first() {
        let found = of("Nonsense {}\nGroup { Sphere { center 0 0 0 radius 1 colour 3 } }");
        assert!(!found.is_empty());
        assert!(found.windows(2).all(|pair| pair[0].severity >= pair[1].severity), "{found:?}");
    }

    #[test]
    fn places_in_odd_texts_are_places_too() {
        for text in ["Sphre", "\u{e4}\u{1f600} {", "Group {\n\n", ""] {
            for place in of(text).iter().filter_map(|problem| problem.place.as_ref()) {
                assert!(place.width >= 1 && place.line >= 1 && place.column >= 1, "{text:?}: {place:?}");
            }
        }
    }
}
