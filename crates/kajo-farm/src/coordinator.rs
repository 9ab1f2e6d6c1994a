//! Hands units to workers until all are finished, whatever becomes of the workers.
//!
//! A worker that is lost costs its unit one more attempt somewhere else, as often as it takes. A unit that fails is tried
//! three times and then left out, and the others go on. A unit that takes ten times as long as others, and ten
//! minutes, is taken from its worker. All that is finished is in the folder of the [`Job`], so a coordinator may be
//! killed at any moment; the next one renders what is missing.

use std::collections::{BTreeMap, VecDeque};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use kajo::SplitRender;

use crate::hosts::HostShare;
use crate::{FailedUnit, FarmError, Job, Layout, Part};

/// Tries of a unit that fails.
pub(crate) const TRIES: usize = 3;

/// Workers that may be killed from outside while they render one unit: more is no accident.
pub(crate) const MOST_LOSSES: u32 = 50;

/// A unit may take this long, whatever others took.
pub(crate) const LEAST_LEASE: Duration = Duration::from_secs(600);

/// And this many times as long as the median of others.
pub(crate) const LEASE: u32 = 10;

/// A unit to be rendered.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Task {
    /// The stage.
    pub stage: u32,
    /// The unit.
    pub unit: u64,
    /// Where the stage begins, for [`protocol`](crate::protocol); empty for the first.
    pub position: Arc<[u8]>,
}

/// What a worker brought.
#[derive(Clone, Debug, Default)]
pub struct Reply {
    /// The bytes of a [`Part`].
    pub bytes: Vec<u8>,
    /// Samples that were taken.
    pub samples: u64,
    /// Rays that were cast.
    pub rays: u64,
}

/// Why a worker brought nothing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Loss {
    /// The worker was lost for a reason that has nothing to do with the unit.
    Worker(String),
    /// The unit failed, and perhaps the worker with it.
    Unit(String),
    /// No worker would do better.
    Input(String),
}

/// Renders one unit after the other.
pub trait Worker: Send {
    /// Renders a unit.
    ///
    /// # Errors
    /// [`Loss`]; the worker is then given up, and another one is started.
    fn render(&mut self, task: &Task) -> Result<Reply, Loss>;

    /// What ends the worker from another thread, so that `render` returns.
    fn end(&self) -> Box<dyn Fn() + Send + Sync>;
}

/// Starts workers.
pub trait Start: Sync {
    /// A worker for this place.
    ///
    /// # Errors
    /// [`Loss`]
    fn start(&self, slot: usize) -> Result<Box<dyn Worker + '_>, Loss>;
}

/// Progress callback of a stage. Called from several threads.
pub trait Watch: Sync {
    /// So many of its units are finished, and so many samples and rays were taken for them in this run.
    fn done(&self, units: u64, of: u64, samples: u64, rays: u64);

    /// Something worth a line.
    fn note(&self, text: &str);

    /// What each host of an engine has brought so far.
    fn hosts(&self, _hosts: &BTreeMap<String, HostShare>) {}

    /// Whether to stop.
    fn cancelled(&self) -> bool;
}

/// Renders what is missing of a stage.
///
/// * `workers`: how many at once, at least one
///
/// # Errors
/// [`FarmError::Failed`] when some units failed, and all others are finished; [`FarmError::Cancelled`]; and all that
/// [`Job::publish`] says.
pub fn coordinate(
    job: &Job,
    split: &SplitRender<'_>,
    workers: usize,
    start: &dyn Start,
    watch: &dyn Watch,
) -> Result<(), FarmError> {
    let (stage, position) = job.stage(split)?;
    let bytes: Arc<[u8]> = job.stage_bytes()?.map(|(_, bytes)| bytes).unwrap_or_default().into();
    let layout = job.layout(split, &position)?;
    let finished = job.finished(&layout)?;
    let waiting: VecDeque<u64> =
        (0..layout.units()).filter(|&unit| !finished.contains(&(stage, unit))).collect();
    let total = layout.units();
    let queue = Queue {
        state: Mutex::new(State { done: total - waiting.len() as u64, waiting, ..State::default() }),
        changed: Condvar::new(),
    };
    let shared = Shared { job, split, layout, stage, position: bytes, start, watch, queue, total };
    watch.done(shared.queue.lock().done, total, 0, 0);
    thread::scope(|scope| {
        let shared = &shared;
        let slots = workers.max(1).min(shared.queue.lock().waiting.len());
        let started = (0..slots).filter(|&slot| {
            let work = move || shared.work(slot);
            let builder = thread::Builder::new().name(format!("worker-{slot}"));
            builder.spawn_scoped(scope, work).is_ok()
        });
        if started.count() == 0 && slots > 0 {
            shared.stop(FarmError::Input("the system gives no threads to talk to workers".to_owned()));
        }
        shared.oversee();
    });
    let state = shared.queue.state.into_inner().unwrap_or_else(PoisonError::into_inner);
    match (state.stopped, state.failed) {
        (Some(error), _) => Err(error),
        (None, units) if !units.is_empty() => Err(FarmError::Failed { units }),
        (None, _) => Ok(()),
    }
}

struct Shared<'a> {
    job: &'a Job,
    split: &'a SplitRender<'a>,
    layout: Layout,
    stage: u32,
    position: Arc<[u8]>,
    start: &'a dyn Start,
    watch: &'a dyn Watch,
    queue: Queue,
    total: u64,
}

struct Queue {
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Default)]
struct State {
    waiting: VecDeque<u64>,
    /// Since when a place renders a unit, and what ends its worker.
    running: BTreeMap<usize, Running>,
    tries: BTreeMap<u64, usize>,
    losses: BTreeMap<u64, u32>,
    failed: Vec<FailedUnit>,
    /// How long units took.
    took: Vec<Duration>,
    done: u64,
    samples: u64,
    rays: u64,
    /// Workers that could not be started in a row.
    refused: usize,
    stopped: Option<FarmError>,
}

struct Running {
    since: Instant,
    end: Box<dyn Fn() + Send + Sync>,
    overdue: bool,
}

impl Queue {
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The next unit for a place; waits while others may still give theirs back. `None` when there is nothing to do.
    fn next(&self) -> Option<u64> {
        let mut state = self.lock();
        loop {
            if state.stopped.is_some() {
                return None;
            }
            if let Some(unit) = state.waiting.pop_front() {
                return Some(unit);
            }
            if state.is_over() {
                return None;
            }
            state = self.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }
}

impl State {
    fn is_over(&self) -> bool {
        self.stopped.is_some() || (self.waiting.is_empty() && self.running.is_empty())
    }

    /// How long a unit may take.
    fn lease(&self) -> Duration {
        let mut took = self.took.clone();
        took.sort_unstable();
        let median = took.get(took.len() / 2).copied().unwrap_or_default();
        median.saturating_mul(LEASE).max(LEAST_LEASE)
    }
}

impl Shared<'_> {
    /// What one place does.
    fn work(&self, slot: usize) {
        let mut worker: Option<Box<dyn Worker + '_>> = None;
        while let Some(unit) = self.queue.next() {
            self.hold(slot, Box::new(|| ()));
            let mut ready = match worker.take() {
                Some(ready) => ready,
                None => match self.start.start(slot) {
                    Ok(started) => started,
                    Err(loss) => {
                        self.not_started(slot, unit, loss);
                        continue;
                    }
                },
            };
            self.hold(slot, ready.end());
            let since = Instant::now();
            let task = Task { stage: self.stage, unit, position: Arc::clone(&self.position) };
            match ready.render(&task).and_then(|reply| self.received(unit, reply)) {
                Ok(reply) => {
                    worker = Some(ready);
                    self.finished(slot, &reply, since.elapsed());
                }
                Err(loss) => self.lost(slot, unit, loss),
            }
        }
    }

    fn hold(&self, slot: usize, end: Box<dyn Fn() + Send + Sync>) {
        let mut state = self.queue.lock();
        if state.stopped.is_some() {
            end();
        }
        state.running.insert(slot, Running { since: Instant::now(), end, overdue: false });
    }

    /// Publishes what a worker brought.
    fn received(&self, unit: u64, reply: Reply) -> Result<Reply, Loss> {
        let part = Part::read(reply.bytes, self.job.hash())
            .map_err(|error| Loss::Worker(format!("what the worker sent is no part of this job: {error}")))?;
        if (part.stage, part.unit) != (self.stage, unit) {
            return Err(Loss::Worker("the worker sent another unit than it was asked for".to_owned()));
        }
        if let Err(error) = self.job.publish(&part, &self.layout, self.split) {
            self.stop(error);
        }
        Ok(Reply { bytes: Vec::new(), ..reply })
    }

    fn finished(&self, slot: usize, reply: &Reply, took: Duration) {
        let mut state = self.queue.lock();
        state.running.remove(&slot);
        state.took.push(took);
        (state.done, state.refused) = (state.done + 1, 0);
        state.samples += reply.samples;
        state.rays += reply.rays;
        self.watch.done(state.done, self.total, state.samples, state.rays);
        self.queue.changed.notify_all();
    }

    /// A unit comes back without a result.
    fn lost(&self, slot: usize, unit: u64, loss: Loss) {
        let mut state = self.queue.lock();
        let overdue = state.running.remove(&slot).is_some_and(|running| running.overdue);
        let loss = match loss {
            Loss::Worker(text) if overdue => Loss::Unit(format!("it took too long: {text}")),
            loss => loss,
        };
        if state.stopped.is_none() {
            match loss {
                Loss::Input(text) => state.stopped = Some(FarmError::Input(text)),
                Loss::Worker(text) => {
                    let losses = state.losses.entry(unit).or_insert(0);
                    *losses += 1;
                    if *losses > MOST_LOSSES {
                        let message = format!("{MOST_LOSSES} workers were lost with it; the last: {text}");
                        state.failed.push(FailedUnit { stage: self.stage, unit, message });
                    } else {
                        state.waiting.push_front(unit);
                    }
                    self.watch.note(&format!("unit {unit} is rendered again: {text}"));
                }
                Loss::Unit(text) => {
                    let tries = state.tries.entry(unit).or_insert(0);
                    *tries += 1;
                    let tries = *tries;
                    self.job.log(self.stage, unit, tries, &text);
                    self.watch.note(&format!("unit {unit} failed, try {tries} of {TRIES}: {text}"));
                    if tries < TRIES {
                        // Behind all others, so that another place takes it.
                        state.waiting.push_back(unit);
                    } else {
                        let message = text.lines().next().unwrap_or_default().to_owned();
                        state.failed.push(FailedUnit { stage: self.stage, unit, message });
                    }
                }
            }
        }
        self.queue.changed.notify_all();
    }

    /// A worker could not even be started.
    fn not_started(&self, slot: usize, unit: u64, loss: Loss) {
        /// In a row, before it is no accident.
        const MOST: usize = 5;
        let mut state = self.queue.lock();
        state.running.remove(&slot);
        state.waiting.push_front(unit);
        state.refused += 1;
        if state.stopped.is_none() {
            match loss {
                Loss::Input(text) => state.stopped = Some(FarmError::Input(text)),
                Loss::Worker(text) | Loss::Unit(text) if state.refused >= MOST => {
                    state.stopped = Some(FarmError::NotYet(format!("no worker can be started: {text}")));
                }
                Loss::Worker(_) | Loss::Unit(_) => {}
            }
        }
        self.queue.changed.notify_all();
    }

    fn stop(&self, error: FarmError) {
        let mut state = self.queue.lock();
        state.stopped.get_or_insert(error);
        state.running.values().for_each(|running| (running.end)());
        self.queue.changed.notify_all();
    }

    /// Looks after time and signals until all is over.
    fn oversee(&self) {
        const STEP: Duration = Duration::from_millis(50);
        loop {
            let mut state = self.queue.lock();
            if state.is_over() {
                state.running.values().for_each(|running| (running.end)());
                break self.queue.changed.notify_all();
            }
            let lease = state.lease();
            for running in state.running.values_mut() {
                if running.since.elapsed() > lease && !running.overdue {
                    running.overdue = true;
                    (running.end)();
                }
            }
            let (state, _) =
                self.queue.changed.wait_timeout(state, STEP).unwrap_or_else(PoisonError::into_inner);
            drop(state);
            if self.watch.cancelled() {
                self.stop(FarmError::Cancelled);
            }
        }
    }
}
