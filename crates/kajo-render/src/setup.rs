//! What an integrator may use to make what its samples share.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicU32, AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};
use std::thread;

use thiserror::Error;

use crate::progress::Progress;

/// Stack of a thread in bytes, as for those that take samples.
const STACK: usize = 8 << 20;

/// What an integrator may use to make its state.
#[derive(Clone, Copy)]
pub struct Setup<'a> {
    /// Seed of every random number of the render.
    pub seed: u64,
    /// Threads to work on, at least 1.
    pub threads: usize,
    /// Bytes that the state may take.
    pub memory: u64,
    /// What may stop it.
    pub progress: &'a dyn Progress,
}

/// Why there is no state.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum SetupError {
    /// [`Progress::cancelled`] said so.
    #[error("the render was cancelled")]
    Cancelled,
    /// It is more than there is room for, or nothing can be made of this scene; a sentence for the user.
    #[error("{0}")]
    Refused(String),
    /// A bug.
    #[error("the preparation of the integrator failed: {0}")]
    Panicked(String),
}

impl Setup<'_> {
    /// Does `n` tasks on all threads, and returns what came of them in their order.
    ///
    /// * `work`: what task `i` is; it may depend on nothing but `i`
    ///
    /// # Errors
    /// Those of `work`; [`SetupError::Cancelled`]; [`SetupError::Panicked`] when `work` panics.
    pub fn tasks<T: Send>(
        &self,
        n: u32,
        work: impl Fn(u32) -> Result<T, SetupError> + Sync,
    ) -> Result<Vec<T>, SetupError> {
        let next = AtomicU32::new(0);
        let stop = AtomicBool::new(false);
        let found = Mutex::new((Vec::new(), None));
        let run = || {
            while !stop.load(Ordering::Relaxed) {
                let i = next.fetch_add(1, Ordering::Relaxed);
                if i >= n {
                    break;
                }
                let result = match self.progress.cancelled() {
                    true => Err(SetupError::Cancelled),
                    false => catch_unwind(AssertUnwindSafe(|| work(i)))
                        .unwrap_or_else(|panic| Err(SetupError::Panicked(panic_message(&*panic)))),
                };
                let mut found = found.lock().unwrap_or_else(PoisonError::into_inner);
                match result {
                    Ok(task) => {
                        found.0.push((i, task));
                        // Under the lock, so that numbers are reported in order.
                        self.progress.prepared(found.0.len() as u32, n);
                    }
                    Err(error) => {
                        stop.store(true, Ordering::Relaxed);
                        found.1.get_or_insert(error);
                    }
                }
            }
        };
        thread::scope(|scope| {
            // This thread works too. Fewer than asked for do the same work.
            for i in 1..self.threads.min(n as usize) {
                let builder = thread::Builder::new().name(format!("setup-{i}")).stack_size(STACK);
                if builder.spawn_scoped(scope, run).is_err() {
                    break;
                }
            }
            run();
        });
        let (mut tasks, error) = found.into_inner().unwrap_or_else(PoisonError::into_inner);
        match error {
            Some(error) => Err(error),
            None => {
                tasks.sort_unstable_by_key(|&(i, _)| i);
                Ok(tasks.into_iter().map(|(_, task)| task).collect())
            }
        }
    }
}

impl Setup<'_> {
    /// As [`Setup::tasks`], with results that are kept together and may not take more bytes than [`Setup::memory`].
    ///
    /// * `work`: what task `i` is, and how many bytes its result takes
    /// * `too_many`: what is said where there is no room for them
    ///
    /// # Errors
    /// As there, and `too_many`.
    pub fn tasks_in_memory<T: Send>(
        &self,
        n: u32,
        work: impl Fn(u32) -> (T, u64) + Sync,
        too_many: impl Fn() -> SetupError + Sync,
    ) -> Result<Vec<T>, SetupError> {
        let kept = AtomicU64::new(0);
        self.tasks(n, |i| {
            let (result, bytes) = work(i);
            let kept = kept.fetch_add(bytes, Ordering::Relaxed) + bytes;
            if kept > self.memory { Err(too_many()) } else { Ok(result) }
        })
    }
}

/// The text of a panic that was caught.
pub fn panic_message(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().copied();
    let text = text.or_else(|| panic.downcast_ref::<String>().map(String::as_str));
    text.unwrap_or("a panic without a message").to_string()
}
