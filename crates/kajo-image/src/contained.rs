//! Panics of other people's decoders, which become errors of the file.
//!
//! The decoders are written in safe Rust and mean to return errors, but bytes of unknown origin still make one or the
//! other panic. That is no bug to be reported to the user, so code that shows panics asks [`is_contained`] first.

use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind};

use crate::{Format, ImageError};

thread_local! {
    static CONTAINED: Cell<bool> = const { Cell::new(false) };
}

/// Whether a panic of this thread, now, becomes an error of the picture that is read. For panic hooks.
pub fn is_contained() -> bool {
    CONTAINED.get()
}

/// Runs a decoder on bytes of unknown origin. Nothing it touched is used after a panic.
pub(crate) fn contained<T>(
    format: Format,
    decoder: impl FnOnce() -> Result<T, ImageError>,
) -> Result<T, ImageError> {
    let outer = CONTAINED.replace(true);
    let result = catch_unwind(AssertUnwindSafe(decoder));
    CONTAINED.set(outer);
    result.unwrap_or_else(|_| {
        Err(ImageError::malformed(format, "sizes or offsets in the file contradict each other"))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_is_an_error_and_is_known_as_contained() {
        assert!(!is_contained());
        let result = contained(Format::Png, || contained(Format::Exr, || Ok(is_contained())));
        assert_eq!(result, Ok(true));
        let result: Result<(), _> = contained(Format::Exr, || panic!("on purpose"));
        assert!(matches!(result, Err(ImageError::Malformed { format: Format::Exr, .. })), "{result:?}");
        assert!(!is_contained());
    }
}
