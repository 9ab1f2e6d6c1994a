//! Ctrl-C, and the other ways of being told to stop.
//!
//! While a picture is rendered the first signal stops it in an orderly way; while a file is written it waits
//! for the end of the file, so that nothing half written stays. At any other time, and the second time
//! always, the program ends at once. So it does when a render has not come to its end two seconds after the
//! signal: a single camera ray can branch without end.
//!
//! Signals that were ignored when the program began stay so: `nohup` and shells that start a program in the
//! background ask for that.

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

/// The signal of Ctrl-C, the only one where there are no others.
const CTRL_C: u8 = 2;

/// Knows whether the program was told to stop.
#[derive(Clone, Debug, Default)]
pub struct Interrupt {
    state: Arc<AtomicU8>,
    /// Number of the last signal.
    signal: Arc<AtomicU8>,
}

impl Interrupt {
    /// Listens to the system's signals from now on.
    pub fn listen() -> Interrupt {
        let interrupt = Interrupt::default();
        let heard = interrupt.clone();
        on_signal(move |signal| heard.hear(signal));
        ignore_file_size_signal();
        interrupt
    }

    /// What a signal leads to.
    fn hear(&self, signal: u8) {
        self.signal.store(signal, Ordering::SeqCst);
        match self.stop() {
            None => self.end(),
            Some(Work::Write) => {}
            Some(Work::Render) => {
                let heard = self.clone();
                thread::spawn(move || {
                    thread::sleep(PATIENCE);
                    if heard.state.load(Ordering::SeqCst) == STOPPING + Work::Render as u8 {
                        heard.end();
                    }
                });
            }
        }
    }

    /// Does some work. Returns what came of it, and whether the signal came meanwhile.
    pub fn during<T>(&self, kind: Work, work: impl FnOnce() -> T) -> (T, bool) {
        self.state.store(kind as u8, Ordering::SeqCst);
        let result = work();
        (result, self.state.swap(FREE, Ordering::SeqCst) >= STOPPING)
    }

    /// Writes something in the course of a render; it is not broken off, even when the render is to stop.
    pub fn undisturbed<T>(&self, write: impl FnOnce() -> T) -> T {
        self.turn(Work::Render, Work::Write);
        let result = write();
        self.turn(Work::Write, Work::Render);
        result
    }

    /// Makes one kind of work another, told to stop or not.
    fn turn(&self, from: Work, to: Work) {
        let turned = |state: u8| (state & !STOPPING == from as u8).then_some(state & STOPPING | to as u8);
        // Nothing is to be turned where there is no work.
        let _ = self.state.fetch_update(Ordering::SeqCst, Ordering::SeqCst, turned);
    }

    /// Whether the work in progress should come to an end.
    pub fn is_stopping(&self) -> bool {
        self.state.load(Ordering::Relaxed) >= STOPPING
    }

    /// How a program ends that was told to stop: with the signal's own exit code.
    pub fn failure(&self) -> Failure {
        Failure::Interrupted { signal: self.signal.load(Ordering::SeqCst) }
    }

    /// Asks the work in progress to end and returns its kind; `None` when there is none, or it was asked before.
    fn stop(&self) -> Option<Work> {
        [Work::Render, Work::Write].into_iter().find(|&kind| {
            let (working, stopping) = (kind as u8, STOPPING + kind as u8);
            self.state.compare_exchange(working, stopping, Ordering::SeqCst, Ordering::SeqCst).is_ok()
        })
    }

    fn end(&self) -> ! {
        process::exit(self.failure().code().into())
    }
}

/// Calls `act` with the number of each signal that asks the program to end. Where signals cannot be had the system's
/// own way of ending a program is left.
#[cfg(unix)]
fn on_signal(act: impl Fn(u8) + Send + 'static) {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    let ignored = ignored_signals();
    let heard = [SIGHUP, SIGINT, SIGTERM].into_iter().filter(|signal| ignored >> (signal - 1) & 1 == 0);
    let Ok(mut signals) = signal_hook::iterator::Signals::new(heard) else { return };
    thread::spawn(move || {
        for signal in signals.forever() {
            act(u8::try_from(signal).unwrap_or(CTRL_C));
        }
    });
}

/// The signals that are ignored, signal 1 in the lowest bit, as far as the system tells: Linux does.
#[cfg(unix)]
fn ignored_signals() -> u64 {
    ignored_in(&std::fs::read_to_string("/proc/self/status").unwrap_or_default()).unwrap_or(0)
}

#[cfg(unix)]
fn ignored_in(status: &str) -> Option<u64> {
    let digits = status.lines().find_map(|line| line.strip_prefix("SigIgn:"))?;
    u64::from_str_radix(digits.trim(), 16).ok()
}

#[cfg(not(unix))]
fn on_signal(act: impl Fn(u8) + Send + 'static) {
    let _ = ctrlc::set_handler(move || act(CTRL_C));
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

    #[test]
    fn a_file_written_in_a_render_is_not_broken_off() {
        let interrupt = Interrupt::default();
        let ((), stopped) = interrupt.during(Work::Render, || {
            interrupt.undisturbed(|| assert_eq!(interrupt.stop(), Some(Work::Write)));
            assert!(interrupt.is_stopping(), "the render hears of it afterwards");
            interrupt.undisturbed(|| {
                let writing = STOPPING + Work::Write as u8;
                assert_eq!(
                    interrupt.state.load(Ordering::SeqCst),
                    writing,
                    "the render's patience does not end it"
                );
            });
        });
        assert!(stopped);
        interrupt.undisturbed(|| ());
        assert_eq!(interrupt.stop(), None, "there is no work to turn into another");
    }

    #[cfg(unix)]
    #[test]
    fn ignored_signals_are_bits() {
        assert_eq!(ignored_in("Name:\tkajo\nSigIgn:\t0000000000001001\n"), Some(1 << 12 | 1));
        assert_eq!(ignored_in("Name:\tkajo\n"), None);
        assert_eq!(ignored_in("SigIgn:\tmany\n"), None);
    }

    #[test]
    fn the_exit_code_tells_the_signal() {
        let interrupt = Interrupt::default();
        let codes = [1, 2, 15].map(|signal| {
            interrupt.during(Work::Write, || interrupt.hear(signal));
            interrupt.failure().code()
        });
        assert_eq!(codes, [129, 130, 143]);
    }
}
