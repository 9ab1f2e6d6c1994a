//! What an integrator may use to make what its samples share.

use std::any::Any;
use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
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
    /// As [`Setup::tasks`], with results that are put together while others are made, so that all of them never exist twice.
    ///
    /// * `work`: what task `i` is
    /// * `add`: puts a result to those of the tasks before it; never called by two threads at once
    ///
    /// # Errors
    /// As there, and those of `add`.
    pub fn fold_tasks<T: Send, A: Default + Send>(
        &self,
        n: u32,
        work: impl Fn(u32) -> T + Sync,
        add: impl Fn(&mut A, T) -> Result<(), SetupError> + Sync,
    ) -> Result<A, SetupError> {
        /// What is put together, the next task's number, and results of tasks after it.
        struct Folded<T, A>(A, u32, BTreeMap<u32, T>);
        let folded = Mutex::new(Folded(A::default(), 0, BTreeMap::new()));
        self.tasks(n, |i| {
            let result = work(i);
            let mut folded = folded.lock().unwrap_or_else(PoisonError::into_inner);
            let Folded(all, next, waiting) = &mut *folded;
            waiting.insert(i, result);
            while let Some(result) = waiting.remove(next) {
                add(all, result)?;
                *next += 1;
            }
            Ok(())
        })?;
        Ok(folded.into_inner().unwrap_or_else(PoisonError::into_inner).0)
    }
}

/// Appends, with room for an eighth more than is there at most.
///
/// Where memory is handed out by pages, as for all that is large, neither old nor new elements are copied in between.
pub fn append_tightly<T>(all: &mut Vec<T>, more: Vec<T>) {
    if all.capacity() - all.len() < more.len() {
        all.reserve_exact(more.len().max(all.len() / 8));
    }
    all.extend(more);
}

/// The text of a panic that was caught.
pub fn panic_message(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().copied();
    let text = text.or_else(|| panic.downcast_ref::<String>().map(String::as_str));
    text.unwrap_or("a panic without a message").to_string()
}
