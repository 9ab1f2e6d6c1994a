//! Runs the program and turns however it ends into an exit code.

use std::panic::{self, AssertUnwindSafe};
use std::process;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::failure::Failure;
use crate::{console, shortage};

/// Runs `program`, shows how it ended if it failed, and returns the exit code.
///
/// A panic is a bug of ours; it is shown as such and ends with code 4. But for those of decoders on the files of others,
/// which become errors, and those for want of memory.
pub fn guarded(program: impl FnOnce() -> Result<(), Failure>) -> u8 {
    let panicked = Arc::new(AtomicBool::new(false));
    shortage::exit_when_aborted(&panicked);
    panic::set_hook(Box::new(move |info| {
        if kajo::is_contained() {
            return;
        }
        if shortage::is_meant_by(info.payload_as_str().unwrap_or_default()) {
            console::error("there is not enough memory to start a thread");
            process::exit(Failure::Memory(String::new()).code().into());
        }
        panicked.store(true, Ordering::SeqCst);
        console::error(&format!("this is a bug in kajo, not in your scene: {info}"));
    }));
    match panic::catch_unwind(AssertUnwindSafe(program)) {
        Ok(Ok(())) => 0,
        Ok(Err(failure)) => {
            if !failure.message().is_empty() {
                console::error(failure.message());
            }
            failure.code()
        }
        Err(_) => {
            console::line("Please report it, with the scene and the command line if you can.");
            Failure::Bug(String::new()).code()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_end_has_its_code() {
        assert_eq!(guarded(|| Ok(())), 0);
        assert_eq!(guarded(|| Err(Failure::Different(String::new()))), 1);
        assert_eq!(guarded(|| Err(Failure::Input("x".into()))), 2);
        assert_eq!(guarded(|| panic!("on purpose")), 4);
        assert_eq!(guarded(|| Err(Failure::Output("x".into()))), 5);
        assert_eq!(guarded(|| Err(Failure::Memory("x".into()))), 6);
        assert_eq!(guarded(|| Err(Failure::Interrupted { signal: 2 })), 130);
    }
}
