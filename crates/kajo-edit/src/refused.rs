//! Why something cannot be done.

/// Why something cannot be done, for people.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct EditRefused(String);

impl From<kajo_scene::EditError> for EditRefused {
    fn from(error: kajo_scene::EditError) -> EditRefused {
        EditRefused(error.to_string())
    }
}

impl EditRefused {
    pub(super) fn new(reason: impl Into<String>) -> EditRefused {
        EditRefused(reason.into())
    }
}
