//! Lines of mesh and material files.
//!
//! A line ends in `\n`, `\r\n` or `\r`; one that ends in `\` goes on in the
//! next. Lines are borrowed from the read buffer, which grows to the longest
//! line seen and never beyond [`Limits::line_bytes`].

use crate::byte_reader::ByteReader;
use crate::diagnostic::quoted;
use crate::limits::Limits;
use crate::mesh_file_error::{FileMistake, MeshFileError};
use crate::source::floor_char_boundary;
use crate::text_encoding::{UTF_16, is_utf16};
use std::io::Read;

/// One line, its continuations included.
#[derive(Clone, Copy)]
pub(crate) struct Line<'b> {
    /// The bytes without the line end; inner line ends of continuations are kept as blanks.
    pub bytes: &'b [u8],
    /// Number of the first line, from 1.
    pub number: usize,
}

/// A word of a [`Line`] and where it starts there.
#[derive(Clone, Copy)]
pub(crate) struct Field<'b> {
    pub bytes: &'b [u8],
    pub start: usize,
}

impl<'b> Line<'b> {
    /// The words of the line, up to a `#`.
    pub fn fields(self) -> Fields<'b> {
        Fields { bytes: self.bytes, at: 0 }
    }

    /// A mistake at `field`.
    pub fn mistake(self, path: &str, field: Field<'_>, message: impl Into<String>) -> MeshFileError {
        const SHOWN: usize = 400;
        // Continuations are lines of their own to the reader of the message.
        let before = &self.bytes[..field.start];
        let first = before.iter().rposition(|&b| b == b'\n' || b == b'\r').map_or(0, |at| at + 1);
        let skipped = crate::source::count_line_ends(&self.bytes[..first]);
        let physical = &self.bytes[first..];
        let len = physical.iter().position(|&b| b == b'\n' || b == b'\r').unwrap_or(physical.len());
        let head = String::from_utf8_lossy(&physical[..field.start - first]).into_owned();
        let word = String::from_utf8_lossy(field.bytes);
        let tail =
            String::from_utf8_lossy(&physical[(field.start - first + field.bytes.len()).min(len)..len]);
        let column = head.chars().count() + 1;
        let mut text = head + &word + &tail;
        let start = text.len() - tail.len() - word.len();
        let end = text.len() - tail.len();
        text.truncate(floor_char_boundary(&text, start + SHOWN));
        let place = (start as u32, end.min(text.len()) as u32);
        let (path, message) = (path.to_owned(), message.into());
        MeshFileError::Mistake(Box::new(FileMistake {
            path,
            line: self.number + skipped,
            column,
            message,
            text,
            place,
        }))
    }
}

/// The iterator of [`Line::fields`].
#[derive(Clone)]
pub(crate) struct Fields<'b> {
    bytes: &'b [u8],
    at: usize,
}

impl<'b> Fields<'b> {
    /// Everything that is left, without blanks around it: a name that may hold blanks.
    pub fn rest(&self) -> Field<'b> {
        let rest = &self.bytes[self.at..];
        let blank = rest.len() - rest.trim_ascii_start().len();
        Field { bytes: rest.trim_ascii(), start: self.at + blank }
    }

    /// An empty field behind the last one.
    pub fn end(&self) -> Field<'b> {
        Field { bytes: &[], start: self.bytes.trim_ascii_end().len() }
    }
}

impl<'b> Iterator for Fields<'b> {
    type Item = Field<'b>;

    #[inline]
    fn next(&mut self) -> Option<Field<'b>> {
        let bytes = self.bytes;
        let mut start = self.at;
        while *bytes.get(start)? <= b' ' {
            start += 1;
        }
        if bytes[start] == b'#' {
            self.at = bytes.len();
            return None;
        }
        let mut end = start + 1;
        while bytes.get(end).is_some_and(|&b| b > b' ') {
            end += 1;
        }
        self.at = end;
        Some(Field { bytes: &bytes[start..end], start })
    }
}

impl Field<'_> {
    /// The word for a message.
    pub fn quoted(self) -> String {
        quoted(&String::from_utf8_lossy(self.bytes))
    }

    /// A number as `scanf` reads it, `nan` and `inf` included; too large ones are infinite.
    #[inline]
    pub fn float(self) -> Option<f32> {
        std::str::from_utf8(self.bytes).ok()?.parse().ok()
    }
}

/// Reads lines from a stream of bytes.
pub(crate) struct LineReader<'l, R> {
    bytes: ByteReader<'l, R>,
    /// Whether a line that ends in `\\` goes on in the next.
    continues: bool,
    /// Whether lines end in `\r` alone, so that a `\n` after one belongs to what comes next.
    ends_in_cr: bool,
    /// Line ends passed so far.
    lines: usize,
    /// The number of the last line, its bytes, and how many of the file it took.
    last: (usize, usize, usize),
}

impl<'l, R: Read> LineReader<'l, R> {
    pub fn new(reader: R, path: &'l str, limits: &'l Limits) -> Self {
        Self {
            bytes: ByteReader::new(reader, path, limits),
            continues: true,
            ends_in_cr: false,
            lines: 0,
            last: (0, 0, 0),
        }
    }

    /// The same for formats in which `\\` means nothing.
    pub fn without_continuations(self) -> Self {
        Self { continues: false, ..self }
    }

    /// What comes after the lines read so far.
    pub fn into_bytes(self) -> ByteReader<'l, R> {
        self.bytes
    }

    /// The bytes that come next, without stepping over them: `n` of them, or all there are.
    pub fn at_least(&mut self, n: usize) -> Result<&[u8], MeshFileError> {
        self.bytes.at_least(n)
    }

    /// A mistake that is about no line in particular, such as the end of the file.
    pub fn mistake(&self, message: impl Into<String>) -> MeshFileError {
        self.bytes.mistake(message)
    }

    /// A mistake somewhere in the line that [`LineReader::next_line`] gave last.
    pub fn mistake_in_last(&self, message: impl Into<String>) -> MeshFileError {
        let (number, len, consumed) = self.last;
        let line = Line { bytes: &self.bytes.before(consumed)[..len], number };
        let whole = line.bytes.trim_ascii();
        let start = line.bytes.len() - line.bytes.trim_ascii_start().len();
        line.mistake(self.bytes.path, Field { bytes: whole, start }, message)
    }

    /// The next line, or `None` at the end of the file.
    pub fn next_line(&mut self) -> Result<Option<Line<'_>>, MeshFileError> {
        let number = self.lines + 1;
        if number == 1 && is_utf16(self.bytes.at_least(8)?) {
            return Err(MeshFileError::Content {
                path: self.bytes.path.to_owned(),
                message: UTF_16.to_owned(),
            });
        }
        // Bytes of the line known to hold no end of it.
        let mut seen = 0;
        loop {
            let unread = self.bytes.unread();
            let Some(len) = unread[seen..].iter().position(|&b| b == b'\n' || b == b'\r').map(|at| at + seen)
            else {
                seen = unread.len();
                if self.bytes.at_end() {
                    self.last = (number, seen, seen);
                    let unread = self.bytes.take(seen, seen);
                    return Ok(
                        (!unread.is_empty()).then(|| Line { bytes: without_bom(unread, number), number })
                    );
                }
                self.fill()?;
                continue;
            };
            // Whether `\n` follows a `\r` must be known to step over both.
            if unread[len] == b'\r' && len + 1 == unread.len() && !self.bytes.at_end() {
                seen = len;
                self.fill()?;
                continue;
            }
            let is_pair = unread[len..].starts_with(b"\r\n") && !self.ends_in_cr;
            let end_len = if is_pair { 2 } else { 1 };
            if number == 1 && !self.continues {
                self.ends_in_cr = unread[len] == b'\r' && !is_pair;
            }
            self.lines += 1;
            if self.continues && len > 0 && unread[len - 1] == b'\\' {
                self.bytes.unread_mut()[len - 1] = b' ';
                seen = len + end_len;
                continue;
            }
            self.last = (number, len, len + end_len);
            let line = self.bytes.take(len, len + end_len);
            return Ok(Some(Line { bytes: without_bom(line, number), number }));
        }
    }

    /// Reads more of a line that is not too long already.
    fn fill(&mut self) -> Result<(), MeshFileError> {
        let (unread, limits) = (self.bytes.unread(), self.bytes.limits);
        if unread.len() > limits.line_bytes {
            let line = Line { bytes: unread, number: self.lines + 1 };
            let message = format!("the line has more than {} bytes", limits.line_bytes);
            return Err(line.mistake(self.bytes.path, Field { bytes: &[], start: 0 }, message));
        }
        self.bytes.fill()
    }
}

/// A byte order mark in front of the first line means nothing.
fn without_bom(bytes: &[u8], number: usize) -> &[u8] {
    let bom = if number == 1 { "\u{feff}".as_bytes() } else { b"" };
    bytes.strip_prefix(bom).unwrap_or(bytes)
}
