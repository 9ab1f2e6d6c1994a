//! Where new text goes in a text written by hand, so that it looks as if it had been written there.

use std::ops::Range;

use kajo_scene::{TokenKind, tokens};

/// The line ends of a text: those of its first line.
pub(super) fn newline(text: &str) -> &'static str {
    match text.find(['\n', '\r']) {
        Some(at) if text[at..].starts_with("\r\n") => "\r\n",
        Some(at) if text[at..].starts_with('\r') => "\r",
        _ => "\n",
    }
}

/// What a block is indented by, against what it stands in.
fn indent_unit(text: &str) -> &'static str {
    let tabs = text.split(['\n', '\r']).any(|line| line.starts_with('\t'));
    if tabs { "\t" } else { "  " }
}

fn line_start(text: &str, at: usize) -> usize {
    text[..at].rfind(['\n', '\r']).map_or(0, |end| end + 1)
}

/// The blanks that the line of byte `at` begins with.
fn indent(text: &str, at: usize) -> &str {
    let line = text[line_start(text, at)..at].trim_start_matches('\u{feff}');
    let end = line.find(|c| c != ' ' && c != '\t').unwrap_or(line.len());
    &line[..end]
}

/// Whether only blanks stand before byte `at` in its line.
fn begins_line(text: &str, at: usize) -> bool {
    text[line_start(text, at)..at].chars().all(|c| matches!(c, ' ' | '\t' | '\u{feff}'))
}

/// The end of the line of byte `at`, where a token ends, if nothing but blanks and comments comes before it.
fn free_to_line_end(text: &str, at: usize) -> Option<usize> {
    for token in tokens(&text[at..]) {
        let piece = &text[at..][token.range()];
        let line_end = piece.find(['\n', '\r']);
        match (token.kind, line_end) {
            (TokenKind::Whitespace, Some(end)) => return Some(at + token.start as usize + end),
            (TokenKind::Whitespace | TokenKind::Comment, None) => {}
            _ => return None,
        }
    }
    Some(text.len())
}

/// Where to put `piece` after the item at `item`, and with what around it.
pub(super) fn after(text: &str, item: &Range<usize>, piece: &str) -> (usize, String) {
    match free_to_line_end(text, item.end) {
        Some(end) if begins_line(text, item.start) => {
            (end, format!("{}{}{piece}", newline(text), indent(text, item.start)))
        }
        _ => (item.end, format!("  {piece}")),
    }
}

/// Where to put `piece` before what begins at byte `at`, and with what around it.
pub(super) fn before(text: &str, at: usize, piece: &str) -> (usize, String) {
    if begins_line(text, at) {
        return (at, format!("{piece}{}{}", newline(text), indent(text, at)));
    }
    (at, format!("{piece}  "))
}

/// Where to put `piece` first in the block of the item at `item`, and with what around it; `None` without a block.
pub(super) fn first_in(text: &str, item: &Range<usize>, piece: &str) -> Option<(usize, String)> {
    let open = item.start + open_brace(&text[item.clone()])? + 1;
    let inside = &text[open..item.end.saturating_sub(1).max(open)];
    if let Some(end) = free_to_line_end(text, open).filter(|_| inside.contains(['\n', '\r'])) {
        let deeper = format!("{}{}", indent(text, item.start), indent_unit(text));
        return Some((end, format!("{}{deeper}{piece}", newline(text))));
    }
    let gap = if inside.starts_with([' ', '\t']) { "" } else { " " };
    Some((open, format!(" {piece}{gap}")))
}

/// The offset of the brace that opens an item's block.
pub(super) fn open_brace(item: &str) -> Option<usize> {
    tokens(item).find(|token| token.kind == TokenKind::OpenBrace).map(|token| token.start as usize)
}

/// The bytes to take out so that the item at `item` leaves no gap: its lines, where it has them for itself.
pub(super) fn removal(text: &str, item: &Range<usize>) -> Range<usize> {
    let rest = &text[item.end..];
    let to_line_end = rest.len() - rest.trim_start_matches([' ', '\t']).len();
    let next = rest[to_line_end..].chars().next();
    let ends_line = matches!(next, None | Some('\n' | '\r'));
    if begins_line(text, item.start) && ends_line {
        let bom = if text.starts_with('\u{feff}') { '\u{feff}'.len_utf8() } else { 0 };
        let start = line_start(text, item.start).max(bom.min(item.start));
        let line_end = item.end + to_line_end;
        let end = match &text[line_end..] {
            rest if rest.starts_with("\r\n") => line_end + 2,
            "" => line_end,
            _ => line_end + 1,
        };
        return start..end;
    }
    let separated = rest.chars().next().is_none_or(|c| c.is_whitespace() || c == '}');
    let before = text[..item.start].trim_end_matches([' ', '\t']).len();
    // A line's indentation stays, and so does the only blank between two words.
    let start = if separated && !begins_line(text, item.start) { before } else { item.start };
    start..item.end
}

/// Where to put `piece` at the end of a file, and with what around it.
pub(super) fn at_end(text: &str, piece: &str) -> (usize, String) {
    let newline = newline(text);
    let bare = text.trim_start_matches('\u{feff}');
    let gap = if bare.is_empty() || bare.ends_with(['\n', '\r']) { "" } else { newline };
    (text.len(), format!("{gap}{piece}{newline}"))
}

/// A block at the top of a file that holds one piece.
pub(super) fn block(text: &str, keyword: &str, piece: &str) -> String {
    let (newline, unit) = (newline(text), indent_unit(text));
    format!("{keyword} {{{newline}{unit}{piece}{newline}}}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn range(text: &str, piece: &str) -> Range<usize> {
        let at = text.find(piece).unwrap();
        at..at + piece.len()
    }

    fn put((at, piece): (usize, String), text: &str) -> String {
        format!("{}{piece}{}", &text[..at], &text[at..])
    }

    #[test]
    fn what_comes_after_looks_like_what_is_there() {
        let check = |text: &str, item: &str, expected: &str| {
            assert_eq!(put(after(text, &range(text, item), "b 2"), text), expected);
        };
        check("S { a 1 }", "a 1", "S { a 1  b 2 }");
        check("S { a 1}", "a 1", "S { a 1  b 2}");
        check("S {\n  a 1 # one\n}", "a 1", "S {\n  a 1 # one\n  b 2\n}");
        check("S {\r\n\ta 1\r\n}", "a 1", "S {\r\n\ta 1\r\n\tb 2\r\n}");
        check("S {\n  z 0  a 1 # one\n}", "a 1", "S {\n  z 0  a 1  b 2 # one\n}");
        check("a 1 /* two\n lines */", "a 1", "a 1  b 2 /* two\n lines */");
        check("\u{feff}a 1", "a 1", "\u{feff}a 1\nb 2");
    }

    #[test]
    fn what_comes_first_opens_the_block() {
        let check = |text: &str, expected: &str| {
            assert_eq!(put(first_in(text, &range(text, text.trim()), "b 2").unwrap(), text), expected);
        };
        check("S {}", "S { b 2 }");
        check("S { }", "S { b 2 }");
        check("S { a 1 }", "S { b 2 a 1 }");
        check("S { # note\n}", "S { # note\n  b 2\n}");
        check("\tS \"{\" {\n\t}", "\tS \"{\" {\n\t\tb 2\n\t}");
        check("S {a 1\n}", "S { b 2 a 1\n}");
        assert_eq!(first_in("S 1", &(0..3), "b"), None);
    }

    #[test]
    fn what_comes_before_keeps_the_indentation() {
        let text = "G {\n  a 1\n}";
        assert_eq!(put(before(text, 6, "b 2"), text), "G {\n  b 2\n  a 1\n}");
        assert_eq!(put(before("G { a 1 }", 4, "b 2"), "G { a 1 }"), "G { b 2  a 1 }");
    }

    #[test]
    fn nothing_else_goes_with_what_is_removed() {
        let check = |text: &str, item: &str, expected: &str| {
            let gone = removal(text, &range(text, item));
            assert_eq!(format!("{}{}", &text[..gone.start], &text[gone.end..]), expected);
        };
        check("a {}\n  b {} \n  c {}\n", "b {}", "a {}\n  c {}\n");
        check("a {}\r\n  b {}\r\n", "b {}", "a {}\r\n");
        check("a {}\n  b {} # why\n", "b {}", "a {}\n   # why\n");
        check("{ a {}  b {} }", "b {}", "{ a {} }");
        check("{ a {}  b {} }", "a {}", "{  b {} }");
        check("x 1 b {}y 2", "b {}", "x 1 y 2");
        check("\u{feff}b {}\nc", "b {}", "\u{feff}c");
        check("b {}", "b {}", "");
    }
}
