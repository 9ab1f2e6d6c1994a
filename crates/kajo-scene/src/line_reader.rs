//! Lines of OBJ and MTL files, and mistakes in them.
//!
//! A line ends in `\n`, `\r\n` or `\r`; one that ends in `\` goes on in the
//! next. Lines are borrowed from the read buffer, which grows to the longest
//! line seen and never beyond [`Limits::line_bytes`].

use crate::assets::AssetError;
use crate::diagnostic::{Diagnostic, quoted};
use crate::limits::Limits;
use crate::source::{Sources, Span, floor_char_boundary};
use std::io::Read;

/// A mesh or material file that could not be used.
#[derive(Debug, thiserror::Error)]
pub enum MeshFileError {
    /// The file could not be read.
    #[error("cannot read `{path}`: {source}")]
    Read {
        /// The file.
        path: String,
        /// Why not.
        source: AssetError,
    },
    /// The file could be read but holds a mistake.
    #[error(transparent)]
    Mistake(Box<FileMistake>),
}

/// A mistake at a place of a file that is not kept in memory.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{path}:{line}:{column}: {message}")]
pub struct FileMistake {
    /// The file.
    pub path: String,
    /// Line, from 1.
    pub line: usize,
    /// Character in the line, from 1.
    pub column: usize,
    /// What was found and what was expected.
    pub message: String,
    /// The line, cut if long.
    text: String,
    /// The place, in bytes of `text`.
    place: (u32, u32),
}

impl MeshFileError {
    /// The error as a message with the line it is about, which is added to
    /// `sources`; `named_at` is where the scene names the file.
    pub fn to_diagnostic(&self, sources: &mut Sources, named_at: Option<Span>) -> Diagnostic {
        let diagnostic = match self {
            MeshFileError::Read { .. } => Diagnostic::error(self.to_string()),
            MeshFileError::Mistake(mistake) => {
                let source = sources.add_excerpt(&mistake.path, &mistake.text, mistake.line);
                let (start, end) = mistake.place;
                Diagnostic::error(&mistake.message).label(Span { source, start, end }, "")
            }
        };
        match named_at {
            Some(span) => diagnostic.label(span, "the file is named here"),
            None => diagnostic,
        }
    }
}

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
    reader: R,
    path: &'l str,
    limits: &'l Limits,
    buffer: Vec<u8>,
    /// The unread part of the buffer.
    start: usize,
    end: usize,
    at_end: bool,
    bytes_read: u64,
    /// Line ends passed so far.
    lines: usize,
}

impl<'l, R: Read> LineReader<'l, R> {
    const CHUNK: usize = 256 << 10;

    pub fn new(reader: R, path: &'l str, limits: &'l Limits) -> Self {
        Self {
            reader,
            path,
            limits,
            buffer: Vec::new(),
            start: 0,
            end: 0,
            at_end: false,
            bytes_read: 0,
            lines: 0,
        }
    }

    /// The next line, or `None` at the end of the file.
    pub fn next_line(&mut self) -> Result<Option<Line<'_>>, MeshFileError> {
        let number = self.lines + 1;
        // Bytes of the line known to hold no end of it.
        let mut seen = 0;
        loop {
            let unread = &self.buffer[self.start..self.end];
            let Some(len) = unread[seen..].iter().position(|&b| b == b'\n' || b == b'\r').map(|at| at + seen)
            else {
                seen = unread.len();
                if self.at_end {
                    return Ok(self.last_line(number));
                }
                self.fill()?;
                continue;
            };
            // Whether `\n` follows a `\r` must be known to step over both.
            if unread[len] == b'\r' && len + 1 == unread.len() && !self.at_end {
                seen = len;
                self.fill()?;
                continue;
            }
            let end_len = if unread[len..].starts_with(b"\r\n") { 2 } else { 1 };
            self.lines += 1;
            if len > 0 && unread[len - 1] == b'\\' {
                self.buffer[self.start + len - 1] = b' ';
                seen = len + end_len;
                continue;
            }
            let start = self.start;
            self.start += len + end_len;
            return Ok(Some(Line { bytes: without_bom(&self.buffer[start..start + len], number), number }));
        }
    }

    fn last_line(&mut self, number: usize) -> Option<Line<'_>> {
        let bytes = &self.buffer[self.start..self.end];
        self.start = self.end;
        (!bytes.is_empty()).then(|| Line { bytes: without_bom(bytes, number), number })
    }

    /// Reads more bytes behind the unread ones.
    fn fill(&mut self) -> Result<(), MeshFileError> {
        self.buffer.copy_within(self.start..self.end, 0);
        self.end -= self.start;
        self.start = 0;
        if self.end > self.limits.line_bytes {
            let line = Line { bytes: &self.buffer[..self.end], number: self.lines + 1 };
            let message = format!("the line has more than {} bytes", self.limits.line_bytes);
            return Err(line.mistake(self.path, Field { bytes: &[], start: 0 }, message));
        }
        if self.buffer.len() < self.end + Self::CHUNK {
            self.buffer.resize(self.end + Self::CHUNK, 0);
        }
        let read = loop {
            match self.reader.read(&mut self.buffer[self.end..]) {
                Err(error) if error.kind() == std::io::ErrorKind::Interrupted => {}
                result => break result.map_err(|error| self.unreadable(error.into()))?,
            }
        };
        self.at_end = read == 0;
        self.end += read;
        self.bytes_read += read as u64;
        if self.bytes_read > self.limits.mesh_bytes {
            return Err(self.unreadable(AssetError::TooLarge { limit: self.limits.mesh_bytes }));
        }
        Ok(())
    }

    fn unreadable(&self, source: AssetError) -> MeshFileError {
        MeshFileError::Read { path: self.path.to_owned(), source }
    }
}

/// A byte order mark in front of the first line means nothing.
fn without_bom(bytes: &[u8], number: usize) -> &[u8] {
    let bom = if number == 1 { "\u{feff}".as_bytes() } else { b"" };
    bytes.strip_prefix(bom).unwrap_or(bytes)
}
