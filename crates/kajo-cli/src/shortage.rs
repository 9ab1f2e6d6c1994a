//! The last resort where memory runs out in a place that can return no error.
//!
//! When an allocation fails, the standard library says so and aborts. That signal ends the program with the exit code
//! for want of memory. A panic that cannot be caught is a bug, and ends by the same signal with the code for that.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use crate::failure::Failure;

/// Gives the ends by `abort` their exit codes.
///
/// * `panicked`: whether there was a panic that was no error of a file
#[cfg(unix)]
pub fn exit_when_aborted(panicked: &Arc<AtomicBool>) {
    use signal_hook::{consts::SIGABRT, flag::register_conditional_shutdown};
    // They are asked in this order. Where the system does not take them, its own way to end is left.
    let ends = [
        (Failure::Bug(String::new()), Arc::clone(panicked)),
        (Failure::Memory(String::new()), Arc::new(AtomicBool::new(true))),
    ];
    for (failure, condition) in ends {
        let _ = register_conditional_shutdown(SIGABRT, failure.code().into(), condition);
    }
}

#[cfg(not(unix))]
pub fn exit_when_aborted(_panicked: &Arc<AtomicBool>) {}

/// Whether a panic with this message means that the system has no memory for a thread.
///
/// The standard library and rayon panic where a thread cannot be started, or has no room for the signals of its own.
pub fn is_meant_by(message: &str) -> bool {
    const SAID: [&str; 3] = [
        "failed to spawn thread",
        "failed to allocate an alternative stack",
        "The global thread pool has not been initialized",
    ];
    SAID.iter().any(|said| message.contains(said))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn threads_that_do_not_start_are_no_bugs() {
        assert!(is_meant_by("failed to spawn thread: Os { code: 11, kind: WouldBlock, message: \"...\" }"));
        assert!(is_meant_by("failed to allocate an alternative stack: Cannot allocate memory (os error 12)"));
        assert!(!is_meant_by("index out of bounds: the len is 3 but the index is 3"));
    }
}
