//! Debug rays by a thread of their own, for a window that may not wait while an integrator prepares.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};

use kajo_core::scene::Scene;
use kajo_math::DVec2;
use kajo_render::{Progress, SetupError, panic_message};

use super::{DebugRay, DebugRays};
use crate::{CameraPose, RenderSettings, Resources};

/// What debug rays are shot through. Those of one subject share what the integrator has prepared.
#[derive(Clone, Debug)]
pub struct ProbeSubject {
    /// The scene.
    pub scene: Arc<Scene>,
    /// Size, samples and integrator.
    pub settings: RenderSettings,
    /// From where.
    pub camera: CameraPose,
}

/// One ray to be shot.
#[derive(Clone, Debug)]
struct Order {
    number: u64,
    /// Compared by its address.
    subject: Arc<ProbeSubject>,
    position: DVec2,
    index: u32,
}

/// A thread that shoots the debug ray that was asked for last.
///
/// What the integrator has prepared is kept as long as rays of the same subject are asked for. A ray of another subject ends a preparation
/// that is under way, and so does [`Prober::forget`].
pub struct Prober {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

struct Shared {
    state: Mutex<State>,
    /// Told of every new order.
    changed: Condvar,
    /// Whether what is being prepared is no longer needed.
    is_unwanted: AtomicBool,
    /// Tasks of the preparation that are done, and how many there are.
    prepared: [AtomicU32; 2],
    threads: usize,
    wake: Box<dyn Fn() + Send + Sync>,
}

#[derive(Default)]
struct State {
    last: u64,
    next: Option<Order>,
    /// The subject that the thread works for.
    current: Option<Arc<ProbeSubject>>,
    /// Whether the last order was not carried out yet.
    is_awaited: bool,
    result: Option<Result<DebugRay, SetupError>>,
    /// Whether `current` is to be let go of.
    is_forgotten: bool,
    is_over: bool,
}

impl Prober {
    /// Nothing is asked for yet.
    ///
    /// * `threads`: that prepare; 0 for one on each core
    /// * `wake`: called from other threads when there is a result, and while it is prepared
    /// * `begin`: called once from the thread, as to lower its priority
    pub fn new(
        threads: usize,
        wake: impl Fn() + Send + Sync + 'static,
        begin: impl FnOnce() + Send + 'static,
    ) -> Prober {
        let shared = Arc::new(Shared {
            state: Mutex::default(),
            changed: Condvar::new(),
            is_unwanted: AtomicBool::new(false),
            prepared: Default::default(),
            threads,
            wake: Box::new(wake),
        });
        let worker = Arc::clone(&shared);
        let work = move || {
            begin();
            worker.work();
        };
        let thread = thread::Builder::new().name("prober".to_owned()).spawn(work).ok();
        Prober { shared, thread }
    }

    /// Asks for a ray in place of any that was asked for before.
    ///
    /// * `position`, `index`: as for [`DebugShooter::shoot`](super::DebugShooter::shoot)
    pub fn shoot(&self, subject: &Arc<ProbeSubject>, position: DVec2, index: u32) {
        let mut state = self.shared.lock();
        state.last += 1;
        state.result = None;
        let is_same = state.current.as_ref().is_some_and(|current| Arc::ptr_eq(current, subject));
        if !is_same || state.is_forgotten {
            self.shared.is_unwanted.store(true, Ordering::Relaxed);
            self.shared.set_prepared([0, 0]);
        }
        state.next = Some(Order { number: state.last, subject: Arc::clone(subject), position, index });
        state.is_awaited = self.thread.is_some();
        if self.thread.is_none() {
            state.next = None;
            state.result = Some(Err(SetupError::Refused("the system gives no thread to work on".to_owned())));
        }
        self.shared.changed.notify_all();
    }

    /// The ray that was asked for last, once it is there; or why there is none.
    pub fn take(&self) -> Option<Result<DebugRay, SetupError>> {
        self.shared.lock().result.take()
    }

    /// How many tasks are done of how many that prepare the ray that is awaited, `[0, 0]` before that is known; `None` when none is awaited.
    pub fn progress(&self) -> Option<[u32; 2]> {
        let is_awaited = self.shared.lock().is_awaited;
        is_awaited.then(|| self.shared.prepared.each_ref().map(|n| n.load(Ordering::Relaxed)))
    }

    /// Ends what is under way, and lets go of what was prepared.
    pub fn forget(&self) {
        let mut state = self.shared.lock();
        state.last += 1;
        (state.next, state.result, state.is_awaited) = (None, None, false);
        if state.current.is_some() {
            state.is_forgotten = true;
            self.shared.is_unwanted.store(true, Ordering::Relaxed);
        }
        self.shared.changed.notify_all();
    }
}

impl Drop for Prober {
    fn drop(&mut self) {
        self.shared.lock().is_over = true;
        self.shared.is_unwanted.store(true, Ordering::Relaxed);
        self.shared.changed.notify_all();
        if let Some(thread) = self.thread.take() {
            // What it works on is caught, so it has no way to panic.
            let _ = thread.join();
        }
    }
}

impl std::fmt::Debug for Prober {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Prober").field("progress", &self.progress()).finish_non_exhaustive()
    }
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn set_prepared(&self, [done, tasks]: [u32; 2]) {
        self.prepared[0].store(done, Ordering::Relaxed);
        self.prepared[1].store(tasks, Ordering::Relaxed);
    }

    /// Serves one subject after the other.
    fn work(&self) {
        while let Some(first) = self.begin_subject() {
            let subject = Arc::clone(&first.subject);
            let served = catch_unwind(AssertUnwindSafe(|| self.serve(&subject, first)));
            if let Err(panic) = served {
                self.give_up(SetupError::Panicked(panic_message(&*panic)));
            }
        }
    }

    /// Waits for an order, and makes its subject the current one; `None` at the end.
    fn begin_subject(&self) -> Option<Order> {
        let mut state = self.lock();
        (state.current, state.is_forgotten) = (None, false);
        loop {
            if state.is_over {
                return None;
            }
            if let Some(order) = state.next.take() {
                state.current = Some(Arc::clone(&order.subject));
                self.is_unwanted.store(false, Ordering::Relaxed);
                return Some(order);
            }
            state = self.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Waits for another order of the current subject; `None` when something else is wanted.
    fn next_of_subject(&self) -> Option<Order> {
        let mut state = self.lock();
        loop {
            if state.is_over || state.is_forgotten {
                return None;
            }
            if let Some(order) = &state.next {
                let is_same = state.current.as_ref().is_some_and(|of| Arc::ptr_eq(of, &order.subject));
                if !is_same {
                    return None;
                }
                // Another subject may have been asked for between.
                self.is_unwanted.store(false, Ordering::Relaxed);
                return state.next.take();
            }
            state = self.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }

    fn serve(&self, subject: &ProbeSubject, first: Order) {
        let ProbeSubject { scene, settings, camera } = subject;
        let rays = DebugRays::new(scene, settings, camera);
        let mut shooter = rays.shooter();
        let resources = Resources { threads: self.threads, ..Resources::default() };
        let mut order = Some(first);
        while let Some(Order { number, position, index, .. }) = order {
            let result = shooter.shoot(position, index, &resources, self);
            self.publish(number, result);
            order = self.next_of_subject();
        }
    }

    /// Says why there is no ray of the order that was worked on, if no other one was made since.
    fn give_up(&self, error: SetupError) {
        let last = {
            let state = self.lock();
            (state.next.is_none() && state.is_awaited).then_some(state.last)
        };
        if let Some(last) = last {
            self.publish(last, Err(error));
        }
    }

    /// Hands out a result, if it is that of the last order.
    fn publish(&self, number: u64, result: Result<DebugRay, SetupError>) {
        {
            let mut state = self.lock();
            if state.last != number {
                return;
            }
            (state.result, state.is_awaited) = (Some(result), false);
        }
        (self.wake)();
    }
}

/// Of what an integrator prepares.
impl Progress for Shared {
    fn done(&self, _pixels_done: u64, _pixels_total: u64, _rays: u64) {}

    fn cancelled(&self) -> bool {
        self.is_unwanted.load(Ordering::Relaxed)
    }

    fn prepared(&self, done: u32, tasks: u32) {
        self.set_prepared([done, tasks]);
        (self.wake)();
    }
}
