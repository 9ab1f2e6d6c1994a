//! Ctrl-C, and the other ways of being told to stop.
//!
//! While a picture is rendered the first signal stops it in an orderly way; while a file is written it waits
//! for the end of the file, so that nothing half written stays. At any other time, and the second time
//! always, the program ends at once.

use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};

use crate::failure::Failure;

const FREE: u8 = 0;
const BUSY: u8 = 1;
const STOPPING: u8 = 2;

/// Knows whether the program was told to stop.
#[derive(Clone, Debug, Default)]
pub struct Interrupt {
    state: Arc<AtomicU8>,
}

impl Interrupt {
    /// Listens to the system's signals from now on.
    pub fn listen() -> Interrupt {
        let interrupt = Interrupt::default();
        let heard = interrupt.clone();
        // Where signals cannot be had the system's own way of ending a program is left.
        let _ = ctrlc::set_handler(move || {
            if !heard.stop() {
                std::process::exit(Failure::Interrupted.code().into());
            }
        });
        ignore_file_size_signal();
        interrupt
    }

    /// Runs `work`, which asks [`Interrupt::is_stopping`] now and then or is short.
    ///
    /// Returns what came of it, and whether the signal came meanwhile.
    pub fn during<T>(&self, work: impl FnOnce() -> T) -> (T, bool) {
        self.state.store(BUSY, Ordering::SeqCst);
        let result = work();
        (result, self.state.swap(FREE, Ordering::SeqCst) == STOPPING)
    }

    /// Whether the work in progress should come to an end.
    pub fn is_stopping(&self) -> bool {
        self.state.load(Ordering::Relaxed) == STOPPING
    }

    /// Asks the work in progress to end; `false` when there is none, or it was asked before.
    fn stop(&self) -> bool {
        self.state.compare_exchange(BUSY, STOPPING, Ordering::SeqCst, Ordering::SeqCst).is_ok()
    }
}

/// Makes writing beyond the limit on file sizes an error of the write, instead of the end of the program.
#[cfg(unix)]
fn ignore_file_size_signal() {
    let _ = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, Arc::default());
}

#[cfg(not(unix))]
fn ignore_file_size_signal() {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_first_signal_during_work_is_orderly() {
        let interrupt = Interrupt::default();
        assert!(!interrupt.stop(), "nothing to stop");
        assert_eq!(interrupt.during(|| 7), (7, false));
        let ((), stopped) = interrupt.during(|| {
            assert!(!interrupt.is_stopping());
            assert!(interrupt.stop());
            assert!(interrupt.is_stopping());
            assert!(!interrupt.stop(), "the second one ends the program");
        });
        assert!(stopped);
        assert!(!interrupt.is_stopping());
    }
}
