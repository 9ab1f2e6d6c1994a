//! How a run of the program can end other than well, and the exit code that says so.

use std::io::ErrorKind;

use kajo::compare::CompareError;
use kajo::output::OutputError;
use kajo::{CheckpointError, ImageError, Kept, RenderError, SettingsError};
use kajo_farm::FarmError;

/// Why the program ends early. The text, if any, is still to be shown.
#[derive(Debug, PartialEq)]
pub enum Failure {
    /// A comparison found more difference than allowed.
    Different(String),
    /// A scene, a picture or the command line is wrong.
    Input(String),
    /// Work is missing that may come yet.
    NotYet(String),
    /// The program is wrong.
    Bug(String),
    /// A file could not be written.
    Output(String),
    /// There is not enough memory.
    Memory(String),
    /// The user said stop, and what was finished is kept.
    Unfinished(String),
    /// The user said stop, by a signal of this number.
    Interrupted {
        /// 2 for Ctrl-C.
        signal: u8,
    },
}

impl Failure {
    /// The exit code.
    pub fn code(&self) -> u8 {
        match self {
            Failure::Different(_) => 1,
            Failure::Input(_) => 2,
            Failure::NotYet(_) => 3,
            Failure::Bug(_) => 4,
            Failure::Output(_) => 5,
            Failure::Memory(_) => 6,
            Failure::Unfinished(_) => 75,
            Failure::Interrupted { signal } => 128_u8.saturating_add(*signal),
        }
    }

    /// The same with another text, where there is one.
    pub fn with(self, say: impl FnOnce(&str) -> String) -> Failure {
        match self {
            Failure::Different(text) => Failure::Different(say(&text)),
            Failure::Input(text) => Failure::Input(say(&text)),
            Failure::NotYet(text) => Failure::NotYet(say(&text)),
            Failure::Bug(text) => Failure::Bug(say(&text)),
            Failure::Output(text) => Failure::Output(say(&text)),
            Failure::Memory(text) => Failure::Memory(say(&text)),
            Failure::Unfinished(text) => Failure::Unfinished(say(&text)),
            Failure::Interrupted { signal } => Failure::Interrupted { signal },
        }
    }

    /// All failures as one: the first says the code, and each its text, which become lines. That somebody said stop
    /// comes last.
    ///
    /// # Errors
    /// When there are any.
    pub fn all(results: impl IntoIterator<Item = Result<(), Failure>>) -> Result<(), Failure> {
        let mut failures: Vec<Failure> = results.into_iter().filter_map(Result::err).collect();
        failures.sort_by_key(|failure| matches!(failure, Failure::Interrupted { .. }));
        let mut failures = failures.into_iter();
        let Some(first) = failures.next() else { return Ok(()) };
        let more: String = failures.map(|failure| format!("\nerror: {}", failure.message())).collect();
        Err(first.with(|text| format!("{text}{more}")))
    }

    /// What to tell the user.
    pub fn message(&self) -> &str {
        match self {
            Failure::Different(text)
            | Failure::Input(text)
            | Failure::NotYet(text)
            | Failure::Bug(text)
            | Failure::Output(text)
            | Failure::Unfinished(text)
            | Failure::Memory(text) => text,
            Failure::Interrupted { .. } => "interrupted",
        }
    }
}

impl From<FarmError> for Failure {
    fn from(error: FarmError) -> Failure {
        let text = error.to_string();
        match error {
            FarmError::Input(_) => Failure::Input(text),
            FarmError::NotYet(_) => Failure::NotYet(text),
            FarmError::Io { .. } => Failure::Output(text),
            FarmError::TwoResults { .. } => Failure::Different(text),
            FarmError::Failed { .. } => Failure::Bug(text),
            FarmError::Cancelled => Failure::Interrupted { signal: 2 },
            FarmError::Render(error) => error.into(),
        }
    }
}

impl From<OutputError> for Failure {
    fn from(error: OutputError) -> Failure {
        Failure::Output(error.to_string())
    }
}

impl From<SettingsError> for Failure {
    fn from(error: SettingsError) -> Failure {
        Failure::Input(error.to_string())
    }
}

impl From<CompareError> for Failure {
    fn from(error: CompareError) -> Failure {
        match error {
            CompareError::Image(ImageError::Memory { .. })
            | CompareError::Decode { source: ImageError::Memory { .. }, .. } => {
                Failure::Memory(error.to_string())
            }
            CompareError::Read { ref source, .. } if source.kind() == ErrorKind::OutOfMemory => {
                Failure::Memory(error.to_string())
            }
            _ => Failure::Input(error.to_string()),
        }
    }
}

/// A picture that was rendered but cannot be put into its file.
impl From<ImageError> for Failure {
    fn from(error: ImageError) -> Failure {
        match error {
            ImageError::Memory { .. } => Failure::Memory(error.to_string()),
            _ => Failure::Output(error.to_string()),
        }
    }
}

impl From<RenderError> for Failure {
    fn from(error: RenderError) -> Failure {
        match error {
            RenderError::Film(_) => Failure::Input(error.to_string()),
            RenderError::Memory { .. } => Failure::Memory(error.to_string()),
            RenderError::Cancelled(_) => Failure::Interrupted { signal: 2 },
            RenderError::Checkpoint(CheckpointError::Replaces { kept, .. }) => Failure::Input(match kept {
                Kept::Farther => {
                    format!("{error}, go on from it with --resume, or allow it with --overwrite-checkpoint")
                }
                _ => format!("{error}, or allow it with --overwrite-checkpoint"),
            }),
            RenderError::Checkpoint(_)
            | RenderError::NotAdaptive(_)
            | RenderError::UnknownNoise(_)
            | RenderError::Unprepared(_) => Failure::Input(error.to_string()),
            RenderError::Panicked { .. } => Failure::Bug(error.to_string()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn several_failures_become_one() {
        assert_eq!(Failure::all([Ok(()), Ok(())]), Ok(()));
        let all = Failure::all([Ok(()), Err(Failure::Output("a".into())), Err(Failure::Memory("b".into()))]);
        assert_eq!(all, Err(Failure::Output("a\nerror: b".into())));
        let stopped = || Err(Failure::Interrupted { signal: 2 });
        assert_eq!(Failure::all([stopped(), Err(Failure::Output("a".into()))]).unwrap_err().code(), 5);
        assert_eq!(Failure::all([stopped(), stopped()]), stopped());
    }
}
