//! Scene text cut into tokens that cover every byte exactly once.
//!
//! Whitespace separates tokens and means nothing else. A comment starts only
//! where a token could start, so `../x//y` and `a#b` are words:
//!
//! ```text
//! # to the end of the line      // to the end of the line      /* ... */
//! ```
//!
//! A word is a number exactly when C's `scanf("%f")` would read all of it
//! (hexadecimal floats apart) and it does not overflow: `+0.`, `3.e-1`, `-.0`,
//! and also `nan` and `inf`, which no reader accepts as a value.

use std::iter::FusedIterator;

/// What a token is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TokenKind {
    /// Blanks, line ends and byte order marks.
    Whitespace,
    /// A whole comment, without the line end that closes it.
    Comment,
    /// A bare word.
    Word,
    /// A number and its value, which is not finite for `nan` and `inf`.
    Number(f64),
    /// A string with both its quotes.
    String,
    /// `{`
    OpenBrace,
    /// `}`
    CloseBrace,
    /// Text that is no token.
    Error(LexError),
}

/// Why text is no token.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LexError {
    /// A string without its closing quote on the same line.
    UnterminatedString,
    /// A `/*` without its `*/`.
    UnterminatedComment,
}

impl TokenKind {
    /// Whether the token separates others and means nothing itself.
    pub fn is_trivia(self) -> bool {
        matches!(self, TokenKind::Whitespace | TokenKind::Comment)
    }
}

/// A piece of text and what it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Token {
    /// What it is.
    pub kind: TokenKind,
    /// First byte.
    pub start: u32,
    /// One past the last byte.
    pub end: u32,
}

impl Token {
    /// The range as indices into the text.
    pub fn range(self) -> std::ops::Range<usize> {
        self.start as usize..self.end as usize
    }
}

/// Cuts `text` into tokens; their texts put together are `text` again.
///
/// ```
/// let text = "Sphere{ radius 1 } # a ball";
/// let pieces: Vec<&str> = kajo_scene::tokens(text).map(|t| &text[t.range()]).collect();
/// assert_eq!(pieces, ["Sphere", "{", " ", "radius", " ", "1", " ", "}", " ", "# a ball"]);
/// ```
pub fn tokens(text: &str) -> Tokens<'_> {
    Tokens { text, at: 0 }
}

/// The iterator of [`tokens`].
#[derive(Clone, Debug)]
pub struct Tokens<'a> {
    text: &'a str,
    at: usize,
}

impl Tokens<'_> {
    /// Continues at byte `at` of the text, where a token must start.
    pub(crate) fn resume(text: &str, at: u32) -> Tokens<'_> {
        Tokens { text, at: at as usize }
    }

    /// Where the next token starts.
    pub(crate) fn offset(&self) -> u32 {
        self.at as u32
    }

    /// The next token that is neither blank nor comment.
    pub(crate) fn next_significant(&mut self) -> Option<Token> {
        self.find(|token| !token.kind.is_trivia())
    }
}

impl Iterator for Tokens<'_> {
    type Item = Token;

    fn next(&mut self) -> Option<Token> {
        let start = self.at;
        let rest = &self.text[start..];
        let bytes = rest.as_bytes();
        let (kind, len) = match *bytes.first()? {
            b'{' => (TokenKind::OpenBrace, 1),
            b'}' => (TokenKind::CloseBrace, 1),
            b'"' => string(bytes),
            b'#' => (TokenKind::Comment, line_len(bytes)),
            b'/' if bytes.starts_with(b"//") => (TokenKind::Comment, line_len(bytes)),
            b'/' if bytes.starts_with(b"/*") => block_comment(rest),
            _ => blank_or_word(rest),
        };
        self.at += len;
        Some(Token { kind, start: start as u32, end: self.at as u32 })
    }
}

impl FusedIterator for Tokens<'_> {}

fn line_len(bytes: &[u8]) -> usize {
    bytes.iter().position(|b| matches!(b, b'\n' | b'\r')).unwrap_or(bytes.len())
}

fn block_comment(rest: &str) -> (TokenKind, usize) {
    match rest[2..].find("*/") {
        Some(at) => (TokenKind::Comment, at + 4),
        None => (TokenKind::Error(LexError::UnterminatedComment), rest.len()),
    }
}

fn string(bytes: &[u8]) -> (TokenKind, usize) {
    let mut i = 1;
    while let Some(byte) = bytes.get(i) {
        match byte {
            b'"' => return (TokenKind::String, i + 1),
            b'\\' if matches!(bytes.get(i + 1), Some(b'"' | b'\\')) => i += 2,
            b'\n' | b'\r' => break,
            _ => i += 1,
        }
    }
    (TokenKind::Error(LexError::UnterminatedString), i)
}

fn blank_or_word(rest: &str) -> (TokenKind, usize) {
    let len = blank_len(rest);
    if len > 0 {
        return (TokenKind::Whitespace, len);
    }
    let word = &rest[..word_len(rest)];
    (number(word).map_or(TokenKind::Word, TokenKind::Number), word.len())
}

fn blank_len(rest: &str) -> usize {
    let bytes = rest.as_bytes();
    let mut i = 0;
    while let Some(&byte) = bytes.get(i) {
        match CLASS[byte as usize] {
            Class::Blank => i += 1,
            Class::NotAscii => match wide_blank(&rest[i..]) {
                Some(len) => i += len,
                None => break,
            },
            _ => break,
        }
    }
    i
}

fn word_len(rest: &str) -> usize {
    let bytes = rest.as_bytes();
    let mut i = 0;
    while let Some(&byte) = bytes.get(i) {
        match CLASS[byte as usize] {
            Class::Word => i += 1,
            Class::NotAscii => match rest[i..].chars().next() {
                Some(c) if !is_blank(c) => i += c.len_utf8(),
                _ => break,
            },
            Class::Blank | Class::Special => break,
        }
    }
    i
}

/// The length of a blank beyond ASCII, such as a no-break space, at the start of `rest`.
fn wide_blank(rest: &str) -> Option<usize> {
    rest.chars().next().filter(|&c| is_blank(c)).map(char::len_utf8)
}

/// White space of Unicode, and the byte order mark, which nobody can see either.
fn is_blank(c: char) -> bool {
    c.is_whitespace() || c == '\u{feff}'
}

/// The value of a word that is a number; `None` for other words and for overflow.
pub(crate) fn number(word: &str) -> Option<f64> {
    let first = *word.as_bytes().first()?;
    if !matches!(first, b'0'..=b'9' | b'+' | b'-' | b'.' | b'i' | b'I' | b'n' | b'N') {
        return None;
    }
    let value: f64 = word.parse().ok()?;
    let overflowed = value.is_infinite() && word.contains(|c: char| c.is_ascii_digit());
    (!overflowed).then_some(value)
}

/// Whether a word was meant to be a number: it starts with a digit, after a sign or point if any.
pub(crate) fn looks_like_number(word: &str) -> bool {
    let unsigned = word.strip_prefix(['+', '-']).unwrap_or(word);
    unsigned.strip_prefix('.').unwrap_or(unsigned).starts_with(|c: char| c.is_ascii_digit())
}

#[derive(Clone, Copy)]
enum Class {
    Blank,
    Word,
    /// A brace or a quote: it ends a word.
    Special,
    NotAscii,
}

const CLASS: [Class; 256] = {
    let mut class = [Class::Word; 256];
    let mut i = 0;
    while i < 256 {
        class[i] = match i as u8 {
            b' ' | b'\t' | b'\n' | b'\r' | 0x0b | 0x0c => Class::Blank,
            b'{' | b'}' | b'"' => Class::Special,
            0x80.. => Class::NotAscii,
            _ => Class::Word,
        };
        i += 1;
    }
    class
};

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn kinds(text: &str) -> Vec<(TokenKind, &str)> {
        tokens(text).filter(|t| !t.kind.is_trivia()).map(|t| (t.kind, &text[t.range()])).collect()
    }

    #[test]
    fn numbers_as_scanf_reads_them() {
        for (text, value) in [
            ("+0.", 0.0),
            ("3.e-1", 0.3),
            ("-.0", -0.0),
            ("1e5", 1e5),
            ("-1.5", -1.5),
            (".5", 0.5),
            ("007", 7.0),
            ("1E+2", 100.0),
            ("1e-999", 0.0),
        ] {
            assert_eq!(kinds(text), [(TokenKind::Number(value), text)]);
        }
        for text in ["nan", "-NaN", "inf", "+Infinity", "-INF"] {
            assert!(matches!(kinds(text)[..], [(TokenKind::Number(v), _)] if !v.is_finite()), "{text}");
        }
        for text in
            ["1.2.3", "12abc", "1e", "+", "-", ".", "1e999", "-1e999", "0x10", "name", "index", "1_000"]
        {
            assert_eq!(kinds(text), [(TokenKind::Word, text)]);
        }
    }

    #[test]
    fn comments_start_only_where_a_token_could() {
        assert_eq!(kinds("../x//y a#b a/*b"), ["../x//y", "a#b", "a/*b"].map(|w| (TokenKind::Word, w)));
        assert_eq!(
            kinds("a //b\nc #d\re /* f { */ g /x"),
            ["a", "c", "e", "g", "/x"].map(|w| (TokenKind::Word, w))
        );
        assert_eq!(kinds("/*/ a */ b"), [(TokenKind::Word, "b")]);
        assert_eq!(kinds("/* a"), [(TokenKind::Error(LexError::UnterminatedComment), "/* a")]);
    }

    #[test]
    fn strings_end_on_their_line() {
        assert_eq!(kinds(r#"f"a \" { b\\"g"#)[1], (TokenKind::String, r#""a \" { b\\""#));
        assert_eq!(kinds("\"ab\ncd")[0], (TokenKind::Error(LexError::UnterminatedString), "\"ab"));
        assert_eq!(kinds(r#""C:\dir""#), [(TokenKind::String, r#""C:\dir""#)]);
        assert_eq!(kinds("\"\\")[0], (TokenKind::Error(LexError::UnterminatedString), "\"\\"));
    }

    #[test]
    fn braces_need_no_blanks_and_wide_blanks_separate() {
        let words: Vec<_> = kinds("Group{numObjects\u{a0}1}").into_iter().map(|(_, text)| text).collect();
        assert_eq!(words, ["Group", "{", "numObjects", "1", "}"]);
        assert_eq!(kinds("\u{feff}été\u{feff}"), [(TokenKind::Word, "été")]);
    }

    proptest! {
        #[test]
        fn tokens_cover_the_text_once(text in "([a-z{}\"#/*\\\\0-9. \r\n\t+eé\u{a0}\u{feff}\0]|//|/\\*|\\*/){0,60}") {
            let mut at = 0;
            for token in tokens(&text) {
                prop_assert_eq!(token.start, at);
                prop_assert!(token.end > token.start);
                prop_assert!(text.is_char_boundary(token.end as usize));
                at = token.end;
            }
            prop_assert_eq!(at as usize, text.len());
        }
    }
}
