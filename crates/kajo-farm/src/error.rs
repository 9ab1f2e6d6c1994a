//! What can go wrong, by what is to be done about it.

use std::io;
use std::path::{Path, PathBuf};

use kajo::RenderError;

/// Why a job does not go on.
#[derive(Debug, thiserror::Error)]
pub enum FarmError {
    /// The plan, the scene or a request is wrong, and stays so.
    #[error("{0}")]
    Input(String),
    /// Work is missing that may come yet.
    #[error("{0}")]
    NotYet(String),
    /// A file or a folder cannot be read or written.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// One unit gave two results.
    #[error(
        "unit {unit} of stage {stage} gave two results, on {first} and on {second}: bad memory, or programs that \
         round otherwise; the second is kept in `{}`", kept.display()
    )]
    TwoResults {
        /// The stage.
        stage: u32,
        /// The unit.
        unit: u64,
        /// Who brought the first.
        first: String,
        /// Who brought the second.
        second: String,
        /// Where the second is.
        kept: PathBuf,
    },
    /// Units failed again and again.
    #[error("{}", in_words(units))]
    Failed {
        /// Which, and how.
        units: Vec<FailedUnit>,
    },
    /// It was told to stop.
    #[error("interrupted")]
    Cancelled,
    /// A render failed.
    #[error(transparent)]
    Render(#[from] RenderError),
}

/// A unit that failed in all its tries.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FailedUnit {
    /// The stage.
    pub stage: u32,
    /// The unit.
    pub unit: u64,
    /// What the last try said.
    pub message: String,
}

impl FarmError {
    /// For `map_err` on what is done with a file.
    pub(crate) fn io(path: &Path) -> impl Fn(io::Error) -> FarmError + Copy + '_ {
        move |source| FarmError::Io { path: path.to_path_buf(), source }
    }
}

fn in_words(units: &[FailedUnit]) -> String {
    let some: Vec<String> =
        units.iter().take(20).map(|unit| format!("\n  unit {}: {}", unit.unit, unit.message)).collect();
    let more = if units.len() > 20 { format!("\n  and {} more", units.len() - 20) } else { String::new() };
    format!(
        "{} of the picture's units failed three times each, and all others are finished:{}{more}",
        units.len(),
        some.concat()
    )
}
