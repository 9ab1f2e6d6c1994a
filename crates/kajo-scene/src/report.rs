//! Diagnostics as text for people, drawn by `annotate-snippets`.
//!
//! Each label shows the first line of its span. Long lines are cut around the
//! place before they are drawn, so a scene of one 10 MB line costs no more
//! than any other; control characters are shown as symbols.

use crate::diagnostic::{Diagnostic, Diagnostics, Label, Severity};
use crate::source::{Position, SourceId, Sources, floor_char_boundary};
use annotate_snippets::renderer::DecorStyle;
use annotate_snippets::{
    AnnotationKind, Group, Level, Origin, Padding, Renderer, Snippet, normalize_untrusted_str,
};
use std::borrow::Cow;
use std::fmt::Write as _;
use std::ops::Range;

/// Messages of each severity that [`render`] shows.
pub const SHOWN: usize = 20;

/// A long line is shown from this many bytes before the place to twice as many after.
const LINE_WINDOW: usize = 80;

/// All messages, each with its source lines, carets and advice; with terminal colours if `color`.
///
/// Of each severity the first [`SHOWN`] appear, then "... and 7 more errors".
pub fn render(diagnostics: &Diagnostics, sources: &Sources, color: bool) -> String {
    let mut out = String::new();
    let mut shown = [0; 3];
    for diagnostic in diagnostics.iter() {
        let shown = &mut shown[diagnostic.severity as usize];
        *shown += 1;
        if *shown <= SHOWN {
            out.push_str(&render_one(diagnostic, sources, color));
            out.push_str("\n\n");
        }
    }
    for severity in [Severity::Error, Severity::Warning, Severity::Note] {
        let more = diagnostics.count(severity).saturating_sub(SHOWN);
        if more > 0 {
            let plural = if more == 1 { "" } else { "s" };
            let _ = writeln!(out, "... and {more} more {}{plural}", severity.name());
        }
    }
    out
}

/// One message with its source lines; no line end at the end.
pub fn render_one(diagnostic: &Diagnostic, sources: &Sources, color: bool) -> String {
    let renderer = if color { Renderer::styled() } else { Renderer::plain() };
    let level = match diagnostic.severity {
        Severity::Error => Level::ERROR,
        Severity::Warning => Level::WARNING,
        Severity::Note => Level::NOTE,
    };
    let mut group = Group::with_title(level.primary_title(printable(&diagnostic.message)));
    for excerpt in excerpts(&diagnostic.labels, sources) {
        group = excerpt.draw(group, sources);
    }
    if let Some(turn) = turn_of(diagnostic, sources) {
        group = group.element(Padding).element(Level::NOTE.message(turn));
    }
    if let Some(help) = &diagnostic.help {
        if !diagnostic.labels.is_empty() {
            group = group.element(Padding);
        }
        group = group.element(Level::HELP.message(printable(help)));
    }
    renderer.decor_style(DecorStyle::Ascii).render(&[group])
}

/// `file:line:col: error: message`, or `error: message` for a message without a place.
pub fn one_line(diagnostic: &Diagnostic, sources: &Sources) -> String {
    let text = format!("{}: {}", diagnostic.severity.name(), diagnostic.message);
    let place = diagnostic.span().map(|span| {
        let Position { line, column } = sources.position(span);
        format!("{}:{line}:{column}: ", sources.get(span.source).path())
    });
    let turn = turn_of(diagnostic, sources).map(|turn| format!(" ({turn})")).unwrap_or_default();
    printable(&(place.unwrap_or_default() + &text + &turn))
}

/// The turn of the repeated blocks in which a mistake was found: "in `repeat`: i = 3, j = 0".
fn turn_of(diagnostic: &Diagnostic, sources: &Sources) -> Option<String> {
    let variables = sources.repetition(diagnostic.span()?.source);
    let shown: Vec<String> = variables.iter().map(|(name, value)| format!("{name} = {value}")).collect();
    (!shown.is_empty()).then(|| format!("in `repeat`: {}", shown.join(", ")))
}

/// A piece of one line, and the labels on it.
struct Excerpt<'a> {
    source: SourceId,
    /// The line's range in the source.
    line: Range<usize>,
    /// The part of the line that is shown.
    window: Range<usize>,
    /// First the one the excerpt was made for; `true` for the message's primary label.
    labels: Vec<(&'a Label, bool)>,
}

/// One excerpt for each line that labels point into, the primary label's first.
fn excerpts<'a>(labels: &'a [Label], sources: &Sources) -> Vec<Excerpt<'a>> {
    let mut list: Vec<Excerpt<'a>> = Vec::new();
    for (i, label) in labels.iter().enumerate() {
        let source = sources.get(label.span.source);
        let line = source.line_range(label.span.start);
        let start = label.span.start as usize;
        let on_it = |e: &&mut Excerpt<'a>| {
            sources.original(e.source) == sources.original(label.span.source)
                && e.line == line
                && e.window.contains(&start)
        };
        match list.iter_mut().find(on_it) {
            Some(excerpt) => excerpt.labels.push((label, i == 0)),
            None => list.push(Excerpt {
                source: label.span.source,
                window: window(source.text(), &line, start),
                line,
                labels: vec![(label, i == 0)],
            }),
        }
    }
    list
}

/// The part of `line` to show around byte `at`.
fn window(text: &str, line: &Range<usize>, at: usize) -> Range<usize> {
    if line.len() <= 3 * LINE_WINDOW {
        return line.clone();
    }
    let at = at.min(line.end);
    let start = floor_char_boundary(text, at.saturating_sub(LINE_WINDOW).max(line.start));
    let end = floor_char_boundary(text, (at + 2 * LINE_WINDOW).min(line.end));
    start..end
}

impl<'a> Excerpt<'a> {
    fn draw<'g>(&self, group: Group<'g>, sources: &'g Sources) -> Group<'g>
    where
        'a: 'g,
    {
        let source = sources.get(self.source);
        let Position { line, column } = source.position(self.labels[0].0.span.start);
        let cut_before = if self.window.start > self.line.start { "..." } else { "" };
        let cut_after = if self.window.end < self.line.end { "..." } else { "" };
        let bom = if self.window.start == 0 && source.text().starts_with('\u{feff}') { 3 } else { 0 };
        let (start, end) = (self.window.start + bom, self.window.end);
        let text = format!("{cut_before}{}{cut_after}", mask_c1(&source.text()[start..end]));
        let annotations = self.labels.iter().map(|&(label, primary)| {
            let kind = if primary { AnnotationKind::Primary } else { AnnotationKind::Context };
            let place = |at: u32| (at as usize).clamp(start, end) - start + cut_before.len();
            let text = (!label.text.is_empty()).then(|| printable(&label.text));
            kind.span(place(label.span.start)..place(label.span.end)).label(text)
        });
        let snippet = Snippet::source(text).line_start(line).fold(false).annotations(annotations);
        let path = printable(source.path());
        if cut_before.is_empty() {
            return group.element(snippet.path(path));
        }
        // The snippet would count columns from the cut, so the place is given apart.
        let origin = Origin::path(path).line(line).char_column(column);
        group.element(origin).element(snippet)
    }
}

/// Text with the control characters U+0080 to U+009F, some of which terminals obey,
/// replaced by dots of the same length in bytes; the drawing crate sees to the others.
fn mask_c1(text: &str) -> Cow<'_, str> {
    let is_c1 = |c: char| ('\u{80}'..='\u{9f}').contains(&c);
    if text.contains(is_c1) { Cow::Owned(text.replace(is_c1, "\u{b7}")) } else { Cow::Borrowed(text) }
}

/// A line of text that is safe to send to a terminal: control characters and what turns the direction of writing are
/// shown as symbols, tabs as blanks.
///
/// ```
/// assert_eq!(kajo_scene::printable("a\u{1b}[2Jb"), "a␛[2Jb");
/// ```
pub fn printable(line: &str) -> String {
    normalize_untrusted_str(&mask_c1(line))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tree::SceneDesc;

    fn report(text: &str) -> String {
        let parsed =
            SceneDesc::parse("dir/scene.txt", text, &crate::MemoryAssets::new(), &crate::Limits::default());
        render(&parsed.diagnostics, parsed.desc.sources(), false)
    }

    #[test]
    fn a_message_shows_place_line_caret_and_advice() {
        let expected = "\
error: `1.2//x` is not a number
 --> dir/scene.txt:3:7
  |
3 |   c 1 1.2//x 4
  |       ^^^^^^ expected a number such as 1, -0.5 or 2e3, or a keyword
  |
  = help: write a blank before the comment's `//`

";
        assert_eq!(report("# é\nSphere {\n  c 1 1.2//x 4\n}"), expected);
    }

    #[test]
    fn both_places_of_an_open_block_are_shown() {
        let text = report("\n  Group {\n  a 1\n");
        assert!(text.contains("--> dir/scene.txt:2:3"), "{text}");
        assert!(text.contains("::: dir/scene.txt:4:1"), "{text}");
        assert!(text.contains("^^^^^ its `{` has no `}`"), "{text}");
    }

    #[test]
    fn one_line_form_counts_characters_of_the_place() {
        let parsed = SceneDesc::parse_str("\u{feff}a 1\r\nb 2 é 3 \"x\"");
        let lines: Vec<String> =
            parsed.diagnostics.iter().map(|d| one_line(d, parsed.desc.sources())).collect();
        assert_eq!(lines, ["scene:2:9: error: the string `\"x\"` belongs to no keyword"]);
        let parsed = SceneDesc::parse_str("\u{feff}{");
        assert!(
            one_line(parsed.diagnostics.iter().next().unwrap(), parsed.desc.sources())
                .starts_with("scene:1:1: ")
        );
        assert_eq!(one_line(&Diagnostic::warning("w"), parsed.desc.sources()), "warning: w");
    }

    #[test]
    fn only_the_first_twenty_of_each_severity_are_shown() {
        let text = report(&"} ".repeat(27));
        assert_eq!(text.matches("error: ").count(), SHOWN);
        assert!(text.ends_with("... and 7 more errors\n"), "{text}");
        assert!(report(&"} ".repeat(21)).ends_with("... and 1 more error\n"));
        assert!(!report(&"} ".repeat(20)).contains("more"));
    }

    #[test]
    fn a_very_long_line_is_cut_around_the_place() {
        let pad = "é 1 ".repeat(250_000);
        let text = report(&format!("{pad} }} {pad}"));
        assert!(text.len() < 2000, "{} bytes", text.len());
        assert!(text.contains("--> dir/scene.txt:1:1000002\n"), "{text}");
        let caret = text.lines().find(|line| line.contains('^')).unwrap();
        let source = text.lines().find(|line| line.contains("1 | ...")).unwrap();
        let column = caret.chars().position(|c| c == '^').unwrap();
        assert_eq!(source.chars().nth(column), Some('}'), "{text}");
    }

    #[test]
    fn control_characters_are_never_emitted() {
        let text = report("a\u{1b}[2J\u{7}\u{202e} } \u{1b}]0;x\u{7}\u{9b}31m");
        assert!(text.chars().all(|c| c == '\n' || !c.is_control()), "{text:?}");
        assert!(!text.contains('\u{202e}'), "bidirectional override");
    }

    #[test]
    fn colour_adds_only_escapes() {
        let parsed = SceneDesc::parse_str("}");
        let colored = render(&parsed.diagnostics, parsed.desc.sources(), true);
        assert!(colored.contains("\u{1b}["));
        assert!(!render(&parsed.diagnostics, parsed.desc.sources(), false).contains('\u{1b}'));
    }
}
