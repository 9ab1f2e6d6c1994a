//! Why a mesh or material file could not be used.

use crate::assets::AssetError;
use crate::diagnostic::Diagnostic;
use crate::memory_budget::OverBudget;
use crate::source::{Sources, Span};

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
    /// What it describes needs more memory than is left.
    #[error("cannot read `{path}`: {source}")]
    Memory {
        /// The file.
        path: String,
        /// How much is asked for, and how much is left.
        source: OverBudget,
    },
    /// The file could be read but holds a mistake.
    #[error(transparent)]
    Mistake(Box<FileMistake>),
    /// The same, where there are no lines.
    #[error("{path}: byte {byte}: {message}")]
    Bytes {
        /// The file.
        path: String,
        /// Bytes before the mistake.
        byte: u64,
        /// What was found and what was expected.
        message: String,
    },
    /// The same, where the message says the place in the file's own terms.
    #[error("{path}: {message}")]
    Content {
        /// The file.
        path: String,
        /// What was found and what was expected.
        message: String,
    },
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
    pub(crate) text: String,
    /// The place, in bytes of `text`.
    pub(crate) place: (u32, u32),
}

impl MeshFileError {
    /// The error as a message with the line it is about, which is added to
    /// `sources`; `named_at` is where the scene names the file.
    pub fn to_diagnostic(&self, sources: &mut Sources, named_at: Option<Span>) -> Diagnostic {
        let diagnostic = match self {
            MeshFileError::Read { .. }
            | MeshFileError::Memory { .. }
            | MeshFileError::Bytes { .. }
            | MeshFileError::Content { .. } => Diagnostic::error(self.to_string()),
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
