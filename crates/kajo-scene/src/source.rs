//! The files a scene was read from, and places in them.

use std::sync::{Arc, OnceLock};

/// Which file of a [`Sources`] a [`Span`] points into, and in which turn of repeated blocks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct SourceId(pub(crate) u32);

/// A half-open range of bytes of one source.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Span {
    /// The file.
    pub source: SourceId,
    /// First byte.
    pub start: u32,
    /// One past the last byte.
    pub end: u32,
}

impl Span {
    /// The range as indices into the text of its source.
    pub fn range(self) -> std::ops::Range<usize> {
        self.start as usize..self.end as usize
    }

    /// The smallest span holding both; `other` must lie in the same source.
    pub fn to(self, other: Span) -> Span {
        debug_assert_eq!(self.source, other.source);
        Span { source: self.source, start: self.start.min(other.start), end: self.end.max(other.end) }
    }
}

/// A place as people count it, both from 1; columns count characters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Position {
    /// Line, where `\n`, `\r\n` and a lone `\r` each end one.
    pub line: usize,
    /// Character within the line.
    pub column: usize,
}

/// One text, with its name.
#[derive(Clone, Debug)]
pub struct Source {
    path: String,
    /// Shared, so that the parser can read it while it adds further sources.
    text: Arc<String>,
    first_line: usize,
    /// Byte offset at which each line starts, made when first asked for.
    line_starts: OnceLock<Vec<u32>>,
}

impl Source {
    /// The name shown in messages, which is also the file's identity.
    pub fn path(&self) -> &str {
        &self.path
    }

    /// The whole text, byte for byte as it was read.
    pub fn text(&self) -> &str {
        &self.text
    }

    pub(crate) fn shared_text(&self) -> Arc<String> {
        Arc::clone(&self.text)
    }

    /// Line and column of a byte offset; offsets past the end mean the end.
    pub fn position(&self, offset: u32) -> Position {
        let index = self.line_index(offset);
        let start = self.line_starts()[index] as usize;
        let end = floor_char_boundary(&self.text, offset as usize);
        let bom = if start == 0 && self.text.starts_with('\u{feff}') { '\u{feff}'.len_utf8() } else { 0 };
        let column = self.text[(start + bom).min(end)..end].chars().count() + 1;
        Position { line: index + self.first_line, column }
    }

    /// The bytes of the line that holds `offset`, without its line end.
    pub(crate) fn line_range(&self, offset: u32) -> std::ops::Range<usize> {
        let index = self.line_index(offset);
        let starts = self.line_starts();
        let start = starts[index] as usize;
        let next = starts.get(index + 1).map_or(self.text.len(), |&s| s as usize);
        let line = self.text[start..next].trim_end_matches(['\r', '\n']);
        start..start + line.len()
    }

    fn line_index(&self, offset: u32) -> usize {
        self.line_starts().partition_point(|&start| start <= offset) - 1
    }

    fn line_starts(&self) -> &[u32] {
        self.line_starts.get_or_init(|| line_starts(self.text.as_bytes()))
    }
}

fn line_starts(bytes: &[u8]) -> Vec<u32> {
    std::iter::once(0).chain(line_ends(bytes)).collect()
}

/// One past each line end.
fn line_ends(bytes: &[u8]) -> impl Iterator<Item = u32> {
    let ends_line = |i: usize, byte: u8| byte == b'\n' || (byte == b'\r' && bytes.get(i + 1) != Some(&b'\n'));
    bytes.iter().enumerate().filter(move |&(i, &byte)| ends_line(i, byte)).map(|(i, _)| i as u32 + 1)
}

/// How many line ends there are.
pub(crate) fn count_line_ends(bytes: &[u8]) -> usize {
    line_ends(bytes).count()
}

/// The last character boundary at or before `offset`.
pub(crate) fn floor_char_boundary(text: &str, offset: usize) -> usize {
    let mut offset = offset.min(text.len());
    while !text.is_char_boundary(offset) {
        offset -= 1;
    }
    offset
}

/// Every text that places may point into.
///
/// A text of which a part is repeated has an id for each turn besides its own, so that a place in it says which turn is
/// meant.
#[derive(Clone, Debug, Default)]
pub struct Sources {
    list: Vec<Source>,
    turns: Vec<Turn>,
    /// Names of the variables of repeated blocks.
    variables: Vec<String>,
}

/// A text in a turn of a repeated block.
#[derive(Clone, Copy, Debug)]
struct Turn {
    /// The text itself.
    text: u32,
    /// The turn of the block around, if that is repeated too.
    outer: Option<SourceId>,
    variable: u32,
    value: f64,
}

/// Ids from here on are turns.
const TURNS: u32 = 1 << 31;

impl Sources {
    /// Adds a text. Texts longer than `u32::MAX` bytes are cut; readers refuse them earlier.
    pub fn add(&mut self, path: impl Into<String>, text: impl Into<String>) -> SourceId {
        self.add_excerpt(path, text, 1)
    }

    /// Adds a piece of a file that starts at line `first_line` (from 1), so that
    /// a message can show a line of a file that was never kept whole.
    pub fn add_excerpt(
        &mut self,
        path: impl Into<String>,
        text: impl Into<String>,
        first_line: usize,
    ) -> SourceId {
        let mut text = text.into();
        text.truncate(floor_char_boundary(&text, u32::MAX as usize));
        self.list.push(Source {
            path: path.into(),
            text: Arc::new(text),
            first_line,
            line_starts: OnceLock::new(),
        });
        SourceId(self.list.len() as u32 - 1)
    }

    /// The source an id stands for.
    ///
    /// # Panics
    /// When `id` came from another `Sources`.
    pub fn get(&self, id: SourceId) -> &Source {
        &self.list[self.original(id).0 as usize]
    }

    /// The text that an id stands for, in whatever turn of a repeated block.
    pub fn original(&self, id: SourceId) -> SourceId {
        self.turn(id).map_or(id, |turn| SourceId(turn.text))
    }

    /// The variables of the repeated blocks that a place is in, outermost first, and their values.
    pub fn repetition(&self, id: SourceId) -> Vec<(&str, f64)> {
        let mut variables = Vec::new();
        let mut next = self.turn(id);
        while let Some(turn) = next {
            variables.push((&*self.variables[turn.variable as usize], turn.value));
            next = turn.outer.and_then(|outer| self.turn(outer));
        }
        variables.reverse();
        variables
    }

    fn turn(&self, id: SourceId) -> Option<&Turn> {
        self.turns.get(id.0.checked_sub(TURNS)? as usize)
    }

    /// Names the variable of a repeated block, for [`Sources::add_turn`].
    pub(crate) fn add_variable(&mut self, name: &str) -> u32 {
        self.variables.push(name.to_owned());
        self.variables.len() as u32 - 1
    }

    /// An id for a turn of a repeated block in `outer`.
    pub(crate) fn add_turn(&mut self, outer: SourceId, variable: u32, value: f64) -> SourceId {
        let text = self.original(outer).0;
        self.turns.push(Turn { text, outer: Some(outer), variable, value });
        SourceId(TURNS + self.turns.len() as u32 - 1)
    }

    /// An id for a file that is included in `turn`.
    pub(crate) fn within(&mut self, file: SourceId, turn: SourceId) -> SourceId {
        let Some(&around) = self.turn(turn) else { return file };
        self.turns.push(Turn { text: file.0, ..around });
        SourceId(TURNS + self.turns.len() as u32 - 1)
    }

    /// All sources in the order they were read.
    pub fn iter(&self) -> impl Iterator<Item = (SourceId, &Source)> {
        self.list.iter().enumerate().map(|(i, source)| (SourceId(i as u32), source))
    }

    /// The text of a span.
    pub fn text(&self, span: Span) -> &str {
        &self.get(span.source).text[span.range()]
    }

    /// Where a span starts.
    pub fn position(&self, span: Span) -> Position {
        self.get(span.source).position(span.start)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn position(text: &str, offset: u32) -> (usize, usize) {
        let mut sources = Sources::default();
        let id = sources.add("t", text);
        let Position { line, column } = sources.get(id).position(offset);
        (line, column)
    }

    #[test]
    fn lines_end_in_any_of_the_three_ways() {
        for end in ["\n", "\r\n", "\r"] {
            let text = format!("ab{end}cd{end}{end}ef");
            let at = |needle: &str| position(&text, text.find(needle).unwrap() as u32);
            assert_eq!((at("b"), at("d"), at("f")), ((1, 2), (2, 2), (4, 2)), "{end:?}");
        }
    }

    #[test]
    fn columns_count_characters_and_skip_the_byte_order_mark() {
        assert_eq!(position("é€x", 5), (1, 3));
        assert_eq!(position("\u{feff}x", 3), (1, 1));
        assert_eq!(position("é", 1), (1, 1), "inside a character");
        assert_eq!(position("ab", 99), (1, 3), "past the end");
        assert_eq!(position("", 0), (1, 1));
    }

    #[test]
    fn an_excerpt_keeps_the_line_numbers_of_its_file() {
        let mut sources = Sources::default();
        let id = sources.add_excerpt("m.obj", "f 1 2 9", 4711);
        assert_eq!(sources.get(id).position(6), Position { line: 4711, column: 7 });
    }

    #[test]
    fn line_range_leaves_out_the_line_end() {
        let mut sources = Sources::default();
        let id = sources.add("t", "ab\r\ncd\r\n");
        assert_eq!(sources.get(id).line_range(1), 0..2);
        assert_eq!(sources.get(id).line_range(5), 4..6);
        assert_eq!(sources.get(id).line_range(8), 8..8);
    }
}
