//! Ctrl-C, and the other ways of being told to stop.
//!
//! While a picture is rendered the first signal stops it in an orderly way; while a file is written it waits
//! for the end of the file, so that nothing half written stays. At any other time, and the second time
//! always, the program ends at once. So it does when a render has not come to its end two seconds after the
//! signal: a single camera ray can branch without end.

use std::process;
use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};
use std::thread;
use std::time::Duration;

use crate::failure::Failure;

/// What must not simply be broken off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Work {
    /// Asks [`Interrupt::is_stopping`] now and then.
    Render = 1,
    /// Is over soon.
    Write = 2,
}

/// No work is in progress. Otherwise the state is the [`Work`], and [`STOPPING`] more once the signal came.
const FREE: u8 = 0;
const STOPPING: u8 = 4;

/// How long a render may take to stop.
const PATIENCE: Duration = Duration::from_secs(2);

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
        let _ = ctrlc::set_handler(move || match heard.stop() {
            None => end(),
            Some(Work::Write) => {}
            Some(Work::Render) => {
                let heard = heard.clone();
                thread::spawn(move || {
                    thread::sleep(PATIENCE);
                    if heard.state.load(Ordering::SeqCst) == STOPPING + Work::Render as u8 {
                        end();
                    }
                });
            }
        });
        ignore_file_size_signal();
        interrupt
    }

    /// Does some work. Returns what came of it, and whether the signal came meanwhile.
    pub fn during<T>(&self, kind: Work, work: impl FnOnce() -> T) -> (T, bool) {
        self.state.store(kind as u8, Ordering::SeqCst);
        let result = work();
        (result, self.state.swap(FREE, Ordering::SeqCst) >= STOPPING)
    }

    /// Whether the work in progress should come to an end.
    pub fn is_stopping(&self) -> bool {
        self.state.load(Ordering::Relaxed) >= STOPPING
    }

    /// Asks the work in progress to end and returns its kind; `None` when there is none, or it was asked before.
    fn stop(&self) -> Option<Work> {
        [Work::Render, Work::Write].into_iter().find(|&kind| {
            let (working, stopping) = (kind as u8, STOPPING + kind as u8);
            self.state.compare_exchange(working, stopping, Ordering::SeqCst, Ordering::SeqCst).is_ok()
        })
    }
}

fn end() -> ! {
    process::exit(Failure::Interrupted.code().into())
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
        for kind in [Work::Render, Work::Write] {
            assert_eq!(interrupt.stop(), None, "nothing to stop");
            assert_eq!(interrupt.during(kind, || 7), (7, false));
            let ((), stopped) = interrupt.during(kind, || {
                assert!(!interrupt.is_stopping());
                assert_eq!(interrupt.stop(), Some(kind));
                assert!(interrupt.is_stopping());
                assert_eq!(interrupt.stop(), None, "the second one ends the program");
            });
            assert!(stopped && !interrupt.is_stopping());
        }
    }
}
