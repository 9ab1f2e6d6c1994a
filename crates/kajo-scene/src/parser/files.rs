//! The files a scene consists of: opened, bounded, and checked to be text.

use super::{Frame, Parser, Stop};
use crate::assets::{AssetError, read_limited};
use crate::diagnostic::{Diagnostic, quoted};
use crate::foreign::{HEAD_BYTES, foreign_file};
use crate::source::{SourceId, Span};
use crate::text_encoding::{UTF_16, is_utf16};
use crate::tree::Word;
use std::string::FromUtf8Error;

impl Parser<'_> {
    /// Goes on with the file that an include names.
    pub(super) fn include(&mut self, keyword: Span, name: Option<Span>) -> Result<(), Stop> {
        let Some(span) = name else {
            self.damage(
                Diagnostic::error("`include` names no file")
                    .label(keyword, "expected a file name after this, as in `include \"lights.txt\"`"),
            );
            return Ok(());
        };
        let raw = self.desc.sources.text(span);
        let name = Word { raw, span }.text().into_owned();
        self.includes += 1;
        if self.includes > self.limits.includes {
            self.damage(
                Diagnostic::error(format!(
                    "more than {} files are included, repeats counted",
                    self.limits.includes
                ))
                .label(span, "this one is too many"),
            );
            return Err(Stop);
        }
        if self.frames.len() > self.limits.include_depth {
            self.damage(
                Diagnostic::error(format!(
                    "files include each other more than {} deep: {}",
                    self.limits.include_depth,
                    self.chain(0, &name)
                ))
                .label(span, "this one is too deep"),
            );
            return Ok(());
        }
        match self.read_source(&name, Some(span)) {
            Ok(source) => {
                let source = self.desc.sources.within(source, span.source);
                self.frames.push(Frame { source, at: 0, outer_blocks: self.blocks.len() });
                Ok(())
            }
            Err(diagnostic) => {
                self.damage(diagnostic);
                Ok(())
            }
        }
    }

    /// The files being read from the `first` on, and then `last`, as "a -> b -> c".
    fn chain(&self, first: usize, last: &str) -> String {
        let mut chain = String::new();
        for frame in &self.frames[first..] {
            chain.push_str(self.desc.sources.get(frame.source).path());
            chain.push_str(" -> ");
        }
        chain + last
    }

    /// Opens and keeps a file; `span` is its name in an include, `None` for the scene itself.
    pub(super) fn read_source(&mut self, name: &str, span: Option<Span>) -> Result<SourceId, Diagnostic> {
        let from = span.map_or("", |span| self.desc.sources.get(span.source).path());
        let file = self.assets.open(name, from).map_err(|error| unreadable(name, span, &error))?;
        let path = file.path.clone();
        let mut file = file;
        let head = file.head(HEAD_BYTES).map_err(|error| unreadable(name, span, &error))?;
        if let Some(foreign) = foreign_file(&head, &path) {
            return Err(at(span, "included here", foreign.error(name)));
        }
        if let Some(block) = block_of_shapes(&path) {
            let shape = Diagnostic::error(format!("{} holds shapes, not a scene", quoted(name)));
            let help = format!("a scene shows it: `Group {{ {block} {{ file {} }} }}`", file_name(&path));
            return Err(at(span, "included here", shape).help(help));
        }
        if let Some(first) = self.frames.iter().position(|f| self.desc.sources.get(f.source).path() == path) {
            let message = format!("a file includes itself: {}", self.chain(first, &path));
            return Err(at(span, "this include closes the circle", Diagnostic::error(message)));
        }
        if let Some(&id) = self.by_path.get(&path) {
            self.count_text(self.desc.sources.get(id).text().len(), span)?;
            return Ok(id);
        }
        let bytes = read_limited(file, self.max_text() - self.text_bytes).map_err(|error| match error {
            AssetError::TooLarge { .. } => self.too_much_text(span),
            error => unreadable(name, span, &error),
        })?;
        self.add_source(&path, bytes, span)
    }

    /// Keeps the content of a file if it is text.
    pub(super) fn add_source(
        &mut self,
        path: &str,
        bytes: Vec<u8>,
        span: Option<Span>,
    ) -> Result<SourceId, Diagnostic> {
        self.count_text(bytes.len(), span)?;
        self.limits.memory.take(bytes.len() as u64).map_err(|over| {
            at(span, "included here", Diagnostic::error(format!("there is no memory for `{path}`: {over}")))
        })?;
        let text = match String::from_utf8(bytes) {
            Ok(text) => text,
            Err(error) => return Err(self.not_utf8(path, &error)),
        };
        let nul = text.find('\0');
        let source = self.desc.sources.add(path, text);
        if let Some(nul) = nul {
            let span = Span { source, start: nul as u32, end: nul as u32 + 1 };
            let wide = is_utf16(self.desc.sources.get(source).text().as_bytes());
            let message = if wide { UTF_16 } else { "the file is not text: it holds a zero byte" };
            return Err(Diagnostic::error(message).label(span, "here"));
        }
        self.by_path.insert(path.to_owned(), source);
        Ok(source)
    }

    fn count_text(&mut self, len: usize, span: Option<Span>) -> Result<(), Diagnostic> {
        let sum = self.text_bytes.saturating_add(len as u64);
        if sum > self.max_text() {
            return Err(self.too_much_text(span));
        }
        self.text_bytes = sum;
        Ok(())
    }

    /// Bytes of text that may be read; places in it are 32-bit numbers.
    fn max_text(&self) -> u64 {
        self.limits.text_bytes.min(u64::from(u32::MAX))
    }

    fn too_much_text(&self, span: Option<Span>) -> Diagnostic {
        let most = self.max_text();
        let message = format!("more than {most} bytes of scene text, included files counted each time");
        at(span, "this file is too much", Diagnostic::error(message))
            .help("use a mesh file for large geometry, and include files fewer times")
    }

    fn not_utf8(&mut self, path: &str, error: &FromUtf8Error) -> Diagnostic {
        let message = if is_utf16(error.as_bytes()) { UTF_16 } else { "the file is not UTF-8 text" };
        let start = error.utf8_error().valid_up_to();
        // The first bad byte is replaced by one character, at the same place.
        let shown = error.as_bytes().len().min(start + 200);
        let lossy = String::from_utf8_lossy(&error.as_bytes()[..shown]).into_owned();
        let source = self.desc.sources.add(path, lossy);
        let end = start + char::REPLACEMENT_CHARACTER.len_utf8();
        let error = Diagnostic::error(message)
            .label(Span { source, start: start as u32, end: end as u32 }, "the first byte that is no text");
        if message == UTF_16 { error } else { error.help("save the file as UTF-8") }
    }
}

/// The block that shows a file of shapes, by the ending of its name.
fn block_of_shapes(path: &str) -> Option<&'static str> {
    let (_, ending) = path.rsplit_once('.')?;
    match ending.to_ascii_lowercase().as_str() {
        "glb" | "gltf" => Some("Model"),
        "obj" | "ply" | "stl" => Some("TriangleMesh"),
        _ => None,
    }
}

/// A path without its folders.
fn file_name(path: &str) -> &str {
    path.rsplit(['/', '\\']).next().unwrap_or(path)
}

fn unreadable(name: &str, span: Option<Span>, error: &AssetError) -> Diagnostic {
    at(span, "included here", Diagnostic::error(format!("cannot read {}: {error}", quoted(name))))
}

/// The message, placed where the file is included if it is.
fn at(span: Option<Span>, label: &str, diagnostic: Diagnostic) -> Diagnostic {
    match span {
        Some(span) => diagnostic.label(span, label),
        None => diagnostic,
    }
}
