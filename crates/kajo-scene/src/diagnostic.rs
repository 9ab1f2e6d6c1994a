//! Messages about input, as values: what was found, what was expected, what to do.

use crate::nearest::nearest;
use crate::source::{Sources, Span};
use std::collections::HashSet;

/// How bad it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// Worth knowing.
    Note,
    /// Probably a mistake; the scene still means something.
    Warning,
    /// The scene cannot be used.
    Error,
}

impl Severity {
    /// The word messages start with.
    pub fn name(self) -> &'static str {
        match self {
            Severity::Note => "note",
            Severity::Warning => "warning",
            Severity::Error => "error",
        }
    }
}

/// A place and the annotation shown there.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Label {
    /// The place.
    pub span: Span,
    /// A few words shown at the place; may be empty.
    pub text: String,
}

/// One message. Building blocks chain:
///
/// ```
/// # use kajo_scene::{Diagnostic, SceneDesc};
/// let parsed = SceneDesc::parse_str("Sphere { radius -1 }");
/// let item = parsed.desc.roots().next().unwrap();
/// let message = Diagnostic::error("the radius is negative")
///     .label(item.span(), "in this sphere")
///     .help("write a positive number");
/// assert_eq!(message.labels.len(), 1);
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    /// How bad it is.
    pub severity: Severity,
    /// What is wrong, in one line that can stand alone.
    pub message: String,
    /// Places; the first is where the message belongs.
    pub labels: Vec<Label>,
    /// What to do.
    pub help: Option<String>,
}

impl Diagnostic {
    /// An error without a place yet.
    pub fn error(message: impl Into<String>) -> Self {
        Self::new(Severity::Error, message)
    }

    /// A warning without a place yet.
    pub fn warning(message: impl Into<String>) -> Self {
        Self::new(Severity::Warning, message)
    }

    /// A note without a place yet.
    pub fn note(message: impl Into<String>) -> Self {
        Self::new(Severity::Note, message)
    }

    /// A message without a place yet.
    pub fn new(severity: Severity, message: impl Into<String>) -> Self {
        Self { severity, message: message.into(), labels: Vec::new(), help: None }
    }

    /// Adds a place; the first added is the primary one.
    pub fn label(mut self, span: Span, text: impl Into<String>) -> Self {
        self.labels.push(Label { span, text: text.into() });
        self
    }

    /// Says what to do.
    pub fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }

    /// As [`Diagnostic::help`], where there is a help text.
    pub fn maybe_help(mut self, help: Option<impl Into<String>>) -> Self {
        self.help = help.map(Into::into).or(self.help);
        self
    }

    /// Where the message belongs, if it has a place.
    pub fn span(&self) -> Option<Span> {
        self.labels.first().map(|label| label.span)
    }
}

/// Messages in the order they came up.
///
/// At most [`Diagnostics::KEPT`] of each severity are kept; the rest are counted.
#[derive(Clone, Debug, Default)]
pub struct Diagnostics {
    list: Vec<Diagnostic>,
    /// Messages ever pushed, by [`Severity`].
    counts: [usize; 3],
}

impl Diagnostics {
    /// Messages kept of each severity.
    pub const KEPT: usize = 1000;

    /// Errors that get a suggestion, which takes a look at every name there is.
    const SUGGESTED: usize = 20;

    /// No messages yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a message.
    pub fn push(&mut self, diagnostic: Diagnostic) {
        let count = &mut self.counts[diagnostic.severity as usize];
        *count += 1;
        if *count <= Self::KEPT {
            self.list.push(diagnostic);
        }
    }

    /// Keeps one of the messages that say the same about one place in several turns of a repeated block: the first.
    pub fn merge_turns(&mut self, sources: &Sources) {
        let mut seen = HashSet::new();
        let counts = &mut self.counts;
        self.list.retain(|diagnostic| {
            let Some(span) = diagnostic.span().filter(|span| !sources.repetition(span.source).is_empty())
            else {
                return true;
            };
            let place = (sources.original(span.source), span.start, span.end);
            let is_new = seen.insert((diagnostic.severity as usize, diagnostic.message.clone(), place));
            counts[diagnostic.severity as usize] -= usize::from(!is_new);
            is_new
        });
    }

    /// Adds all messages of `other` after these.
    pub fn append(&mut self, other: Diagnostics) {
        let Diagnostics { list, counts } = other;
        let mut dropped = counts;
        for diagnostic in list {
            dropped[diagnostic.severity as usize] -= 1;
            self.push(diagnostic);
        }
        for (count, dropped) in self.counts.iter_mut().zip(dropped) {
            *count += dropped;
        }
    }

    /// As [`nearest`], for the suggestion of the next error. After twenty errors there are none, so that many wrong
    /// names among many right ones do not take the product of both.
    pub fn nearest<'a>(&self, word: &str, candidates: impl Iterator<Item = &'a str>) -> Option<&'a str> {
        if self.count(Severity::Error) < Self::SUGGESTED { nearest(word, candidates) } else { None }
    }

    /// All messages kept.
    pub fn iter(&self) -> impl Iterator<Item = &Diagnostic> {
        self.list.iter()
    }

    /// The errors kept.
    pub fn errors(&self) -> impl Iterator<Item = &Diagnostic> {
        self.of(Severity::Error)
    }

    /// The messages kept of one severity.
    pub fn of(&self, severity: Severity) -> impl Iterator<Item = &Diagnostic> {
        self.list.iter().filter(move |d| d.severity == severity)
    }

    /// How many messages of a severity came up, those not kept included.
    pub fn count(&self, severity: Severity) -> usize {
        self.counts[severity as usize]
    }

    /// Whether any error came up.
    pub fn has_errors(&self) -> bool {
        self.count(Severity::Error) > 0
    }

    /// Whether nothing came up at all.
    pub fn is_empty(&self) -> bool {
        self.counts == [0; 3]
    }
}

/// `word` in back quotes, for a message: cut after 40 characters.
pub(crate) fn quoted(word: &str) -> String {
    const SHOWN: usize = 40;
    match word.char_indices().nth(SHOWN) {
        Some((cut, _)) => format!("`{}...`", &word[..cut]),
        None => format!("`{word}`"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_beyond_the_bound_are_counted_not_kept() {
        let mut all = Diagnostics::new();
        for i in 0..1500 {
            all.push(Diagnostic::error(format!("{i}")));
        }
        all.push(Diagnostic::warning("w"));
        assert_eq!((all.errors().count(), all.count(Severity::Error)), (Diagnostics::KEPT, 1500));
        assert_eq!(all.of(Severity::Warning).count(), 1);

        let mut more = Diagnostics::new();
        more.push(Diagnostic::error("first"));
        more.append(all);
        assert_eq!(more.count(Severity::Error), 1501);
        assert_eq!(more.errors().nth(1).map(|d| d.message.as_str()), Some("0"));
        assert!(more.has_errors() && !more.is_empty());
    }

    #[test]
    fn long_words_are_cut_between_characters() {
        assert_eq!(quoted("ab"), "`ab`");
        assert_eq!(quoted(&"é".repeat(100)), format!("`{}...`", "é".repeat(40)));
    }
}
