//! One pass over a picture: its plan, and the threads that carry it out.

use std::{
    ops::Range,
    panic::{AssertUnwindSafe, catch_unwind},
    sync::{
        Mutex, PoisonError,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
    thread,
};

use super::{
    FailedUnit, LARGEST_TILE, Progress, RenderSettings, RenderStats, STACK, TILE, UNITS_PER_THREAD, Unit,
    render_unit,
};
use crate::{
    Film, FilmPart, PixelIntegrator, RayCounters, SampleContext,
    context::{Interrupt, Scratch},
    order,
    rect::{Grid, Rect},
    setup::panic_message,
};

/// The units of a pass, numbered.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Plan {
    pub grid: Grid,
    pub samples: Range<u32>,
    /// Pixels that samples are taken of.
    pub sampled: Rect,
    /// Parts that the samples are split into.
    pub ranges: u32,
    /// [`Unit::limits`] of each tile, row by row; empty where there are none.
    limits: Vec<[u32; 2]>,
}

impl Plan {
    /// All tiles of a film with a range of samples.
    ///
    /// * `limits`: of each block of the film; empty where there are none
    pub fn new(film: &Film, settings: &RenderSettings, samples: Range<u32>, limits: &[[u32; 2]]) -> Plan {
        Plan::over(film, settings, film.spec().sampled(&settings.sampler), samples, limits)
    }

    /// As [`Plan::new`] of some of the pixels that samples are taken of.
    pub fn over(
        film: &Film,
        settings: &RenderSettings,
        sampled: Rect,
        samples: Range<u32>,
        limits: &[[u32; 2]],
    ) -> Plan {
        let spec = film.spec();
        let tile = if settings.tile == 0 { TILE } else { settings.tile.min(LARGEST_TILE) };
        let grid = if limits.is_empty() { film.grid().with_side(tile) } else { film.grid() };
        let tiles = grid.cells_over(&sampled).area().max(1);
        let wanted = (UNITS_PER_THREAD * settings.thread_count() as u64).div_ceil(tiles);
        let most = u64::from(samples.end - samples.start);
        let ranges = if spec.keeps_sums() { wanted.min(most).max(1) as u32 } else { 1 };
        Plan { grid, samples, sampled, ranges, limits: limits.to_vec() }
    }

    /// The same pass in tiles of this side, if it has no limits, and with its samples split into this many ranges.
    pub fn cut(mut self, tile: u32, ranges: u32) -> Plan {
        if self.limits.is_empty() {
            self.grid = self.grid.with_side(tile.min(LARGEST_TILE));
        }
        self.ranges = ranges.clamp(1, (self.samples.end - self.samples.start).max(1));
        self
    }

    /// Units; none when there are no samples.
    pub fn len(&self) -> u64 {
        if self.samples.is_empty() { 0 } else { self.grid.len() * u64::from(self.ranges) }
    }

    /// Samples of all units together.
    pub fn samples(&self) -> u64 {
        let of_tile = |index| {
            let unit = self.tile_unit(index, self.samples.clone());
            unit.tile.area() * u64::from(unit.count())
        };
        (0..self.grid.len()).map(of_tile).sum()
    }

    /// Unit `index`: all tiles with the first range of samples, then all with the second, and so on.
    pub fn unit(&self, index: u64) -> Option<Unit> {
        if index >= self.len() {
            return None;
        }
        let range = index / self.grid.len();
        let count = u64::from(self.samples.end - self.samples.start);
        let start = |r: u64| self.samples.start + (count * r / u64::from(self.ranges)) as u32;
        Some(self.tile_unit(index % self.grid.len(), start(range)..start(range + 1)))
    }

    fn tile_unit(&self, index: u64, samples: Range<u32>) -> Unit {
        let (column, row) = order::cell(index, self.grid.columns(), self.grid.rows());
        let place = row as usize * self.grid.columns() as usize + column as usize;
        let limits = self.limits.get(place).copied().unwrap_or(Unit::UNLIMITED);
        Unit { tile: self.grid.cell(column, row).intersection(&self.sampled), samples, limits }
    }
}

/// What part a pass is of the whole, for observers.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PassShare {
    /// Samples taken before.
    pub samples: u64,
    /// Rays cast before.
    pub rays: u64,
    /// Samples in all, as far as they are known.
    pub samples_in_all: u64,
    /// Throw away what an interrupted unit has so far, so that the film holds whole units only.
    pub whole_units: bool,
}

/// A pass as its threads share it.
pub(super) struct Pass<'a, I: ?Sized> {
    integrator: &'a I,
    film: &'a Film,
    settings: &'a RenderSettings,
    progress: &'a dyn Progress,
    plan: &'a Plan,
    share: PassShare,
    next: AtomicU64,
    /// A bit for each unit that is in the film.
    finished: Vec<AtomicU64>,
    stop: AtomicBool,
    samples: AtomicU64,
    rays: AtomicU64,
    outcome: Mutex<Outcome>,
}

/// What the threads of a pass leave behind.
#[derive(Default)]
struct Outcome {
    rays: RayCounters,
    failed: Vec<FailedUnit>,
    threads: usize,
}

impl<'a, I: PixelIntegrator + ?Sized> Pass<'a, I> {
    pub fn new(
        integrator: &'a I,
        film: &'a Film,
        settings: &'a RenderSettings,
        progress: &'a dyn Progress,
        plan: &'a Plan,
        share: PassShare,
    ) -> Pass<'a, I> {
        let words = plan.len().div_ceil(64) as usize;
        Pass {
            integrator,
            film,
            settings,
            progress,
            plan,
            share,
            next: AtomicU64::new(0),
            finished: (0..words).map(|_| AtomicU64::new(0)).collect(),
            stop: AtomicBool::new(false),
            samples: AtomicU64::new(0),
            rays: AtomicU64::new(0),
            outcome: Mutex::default(),
        }
    }

    /// Goes on where an interrupted pass of the same plan was left.
    ///
    /// * `finished`: a bit for each unit
    pub fn after(mut self, finished: &[u64]) -> Pass<'a, I> {
        for (word, &bits) in self.finished.iter_mut().zip(finished) {
            *word.get_mut() = bits;
        }
        self
    }

    /// Renders all units that are not finished, on all threads.
    pub fn run(&self) {
        let wanted = (self.settings.thread_count() as u64).min(self.plan.len()).max(1);
        let threads = thread::scope(|scope| {
            let spawn = |i: &u64| {
                let builder = thread::Builder::new().name(format!("render-{i}")).stack_size(STACK);
                builder.spawn_scoped(scope, || self.work()).is_ok()
            };
            (0..wanted).take_while(spawn).count()
        });
        if threads == 0 {
            // The system gives no threads. Fewer than asked for make the same picture.
            self.work();
        }
        self.outcome.lock().unwrap_or_else(PoisonError::into_inner).threads = threads.max(1);
    }

    /// Renders units until none is left.
    fn work(&self) {
        let mut part = FilmPart::new(self.film.spec(), &self.settings.sampler);
        let stopped = || self.stopped();
        let interrupt = Interrupt::new(&stopped);
        let mut ctx =
            SampleContext::new(&self.settings.sampler, self.settings.seed).interruptible(&interrupt);
        let mut failed = Vec::new();
        while !self.stopped() {
            let index = self.next.fetch_add(1, Ordering::Relaxed);
            let Some(unit) = self.plan.unit(index) else { break };
            if self.is_finished(index) {
                continue;
            }
            let attempt = catch_unwind(AssertUnwindSafe(|| self.render(index, &unit, &mut part, &mut ctx)));
            if let Err(panic) = attempt {
                ctx.scratch = Scratch::default();
                failed.push(FailedUnit { unit, message: panic_message(&*panic) });
            }
        }
        let mut outcome = self.outcome.lock().unwrap_or_else(PoisonError::into_inner);
        outcome.rays += ctx.rays;
        outcome.failed.append(&mut failed);
    }

    /// Renders a unit and adds it to the film, finished or not.
    fn render(&self, index: u64, unit: &Unit, part: &mut FilmPart, ctx: &mut SampleContext<'_>) {
        let mut told = ctx.rays.total();
        let is_empty = unit.count() == 0 || unit.tile.area() == 0;
        let finished = is_empty
            || render_unit(self.integrator, ctx, unit, part, |samples, counters| {
                let rays = counters.total() - told;
                told += rays;
                self.report(samples, rays);
                !self.stopped()
            });
        if !is_empty && (finished || !self.share.whole_units) {
            self.film.add(part);
        }
        if finished {
            self.finished[(index / 64) as usize].fetch_or(1 << (index % 64), Ordering::Relaxed);
        }
    }

    fn report(&self, samples: u64, rays: u64) {
        let samples = self.samples.fetch_add(samples, Ordering::Relaxed) + samples;
        let rays = self.rays.fetch_add(rays, Ordering::Relaxed) + rays;
        let pixels = self.plan.sampled.area();
        let part = (self.share.samples + samples) as f64 / self.share.samples_in_all.max(1) as f64;
        let done = (part * pixels as f64) as u64;
        self.progress.done(done.min(pixels), pixels, self.share.rays + rays);
    }

    fn stopped(&self) -> bool {
        let stop = self.stop.load(Ordering::Relaxed) || self.progress.cancelled();
        if stop {
            self.stop.store(true, Ordering::Relaxed);
        }
        stop
    }

    fn is_finished(&self, index: u64) -> bool {
        self.finished[(index / 64) as usize].load(Ordering::Relaxed) >> (index % 64) & 1 == 1
    }

    /// Whether the film has every unit.
    pub fn is_complete(&self) -> bool {
        (0..self.plan.len()).all(|index| self.is_finished(index))
    }

    /// A bit for each unit that the film has.
    pub fn finished(&self) -> Vec<u64> {
        self.finished.iter().map(|word| word.load(Ordering::Relaxed)).collect()
    }

    /// What the pass took, and the units that panicked, sorted by position.
    pub fn finish(self) -> (RenderStats, Vec<FailedUnit>) {
        let outcome = self.outcome.into_inner().unwrap_or_else(PoisonError::into_inner);
        let Outcome { rays, mut failed, threads } = outcome;
        failed.sort_by_key(|f| (f.unit.tile.y0, f.unit.tile.x0, f.unit.samples.start));
        let samples = self.samples.into_inner();
        let stats = RenderStats { rays, samples, non_finite: self.film.non_finite(), seconds: 0.0, threads };
        (stats, failed)
    }
}

/// What came of a pass.
pub(super) struct Done {
    /// Whether the film has every unit.
    pub is_complete: bool,
    /// A bit for each unit that the film has.
    pub finished: Vec<u64>,
    /// What it took.
    pub stats: RenderStats,
    /// The units that panicked, sorted by position.
    pub failed: Vec<FailedUnit>,
}

/// Carries out a pass.
///
/// * `finished`: a bit for each unit that the film has already; empty for none
pub(super) fn carry_out<I: PixelIntegrator + ?Sized>(
    integrator: &I,
    film: &Film,
    progress: &dyn Progress,
    settings: &RenderSettings,
    plan: &Plan,
    share: PassShare,
    finished: &[u64],
) -> Done {
    let pass = Pass::new(integrator, film, settings, progress, plan, share).after(finished);
    pass.run();
    let (is_complete, finished) = (pass.is_complete(), pass.finished());
    let (stats, failed) = pass.finish();
    Done { is_complete, finished, stats, failed }
}
