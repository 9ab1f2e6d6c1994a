//! Rendering a picture by tiles on all cores.
//!
//! A unit of work is a tile and a range of samples; what comes of it is a [`FilmPart`], and parts add
//! up exactly. Each random number depends on (seed, pixel, sample, dimension) only. So neither the
//! number of threads, nor the size of tiles, nor who renders what and when can change a bit of the
//! picture.
//!
//! Threads take the next unit from a counter until none is left, which keeps all of them busy to the
//! end; tiles are numbered along a Hilbert curve (see [`mod@order`]). When a picture has few
//! tiles for the threads at hand, its samples are split as well.

use std::{
    any::Any,
    ops::Range,
    panic::{AssertUnwindSafe, catch_unwind},
    sync::{
        Mutex, PoisonError,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
    thread,
    time::Instant,
};

use kajo_core::sampler::Sampler;
use kajo_math::Vec2;
use thiserror::Error;

use crate::{
    Auxiliary, Film, FilmPart, PixelIntegrator, RayCounters, SampleContext,
    context::Scratch,
    order,
    rect::{Grid, Rect},
};

/// Side of a tile in pixels unless the settings say otherwise.
const TILE: u32 = 32;

/// Largest side of a tile, since each thread holds the sums of one.
const LARGEST_TILE: u32 = 512;

/// Most threads that are started, whatever is asked for.
const MOST_THREADS: usize = 1024;

/// Units for each thread below which samples are split too.
const UNITS_PER_THREAD: u64 = 8;

/// Stack of a thread in bytes: room for a thousand mirrors in a row.
const STACK: usize = 8 << 20;

/// Camera rays between two questions whether to go on.
const SAMPLES_PER_CHECK: u64 = 256;

/// How to render; nothing here but the sampler and the seed can change the picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RenderSettings {
    /// Samples of each pixel.
    pub sampler: Sampler,
    /// Seed of every random number.
    pub seed: u64,
    /// Threads; 0 for one on each core, and no more than 1024.
    pub threads: usize,
    /// Side of a tile in pixels; 0 for the default of 32, and no more than 512.
    pub tile: u32,
}

impl RenderSettings {
    /// These samples with seed 0, on all cores, with default tiles.
    pub fn new(sampler: Sampler) -> RenderSettings {
        RenderSettings { sampler, seed: 0, threads: 0, tile: 0 }
    }

    /// Threads to start, the default filled in.
    fn thread_count(&self) -> usize {
        match self.threads {
            0 => thread::available_parallelism().map_or(1, |n| n.get()),
            n => n.min(MOST_THREADS),
        }
    }
}

/// Who is told how far a render is, and may stop it. Called from every thread.
pub trait Progress: Sync {
    /// `pixels_done` of `pixels_total` are finished, by the share of samples taken, and `rays` have been
    /// cast so far. Reports of different threads may arrive out of order.
    fn done(&self, pixels_done: u64, pixels_total: u64, rays: u64);

    /// Whether to stop. Asked every 256 camera rays of a thread, and before each unit.
    fn cancelled(&self) -> bool;
}

/// Progress that nobody looks at.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Progress for Silent {
    fn done(&self, _: u64, _: u64, _: u64) {}

    fn cancelled(&self) -> bool {
        false
    }
}

/// A tile and a range of its samples.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unit {
    /// Pixels.
    pub tile: Rect,
    /// Indices of samples of each of them.
    pub samples: Range<u32>,
}

/// What a render took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RenderStats {
    /// Rays by kind.
    pub rays: RayCounters,
    /// Samples taken.
    pub samples: u64,
    /// Samples with a value that was no finite number, which counted as zero.
    pub non_finite: u64,
    /// Seconds by the clock.
    pub seconds: f64,
    /// Threads that worked.
    pub threads: usize,
}

/// A unit that could not be rendered because of a bug.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FailedUnit {
    /// What was to be rendered.
    pub unit: Unit,
    /// What the panic said.
    pub message: String,
}

/// Why a picture is not complete. The film holds what was rendered.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum RenderError {
    /// [`Progress::cancelled`] said so.
    #[error("the render was cancelled")]
    Cancelled(RenderStats),
    /// Some units panicked, which is a bug; the others are finished.
    #[error(
        "{} of the picture's tiles failed; the first is the one at ({}, {}): {}",
        .failed.len(), .failed[0].unit.tile.x0, .failed[0].unit.tile.y0, .failed[0].message
    )]
    Panicked {
        /// At least one unit, sorted by place.
        failed: Vec<FailedUnit>,
        /// What the render took.
        stats: RenderStats,
    },
}

/// Renders all pixels of a film.
///
/// # Errors
/// [`RenderError`] when the render was cancelled or a unit panicked; the film then holds the rest.
pub fn render<I: PixelIntegrator + ?Sized>(
    integrator: &I,
    film: &Film,
    settings: &RenderSettings,
    progress: &dyn Progress,
) -> Result<RenderStats, RenderError> {
    let start = Instant::now();
    let plan = Plan::new(film, settings);
    let pass = Pass {
        integrator,
        film,
        settings,
        progress,
        plan,
        next: AtomicU64::new(0),
        stop: AtomicBool::new(false),
        samples: AtomicU64::new(0),
        rays: AtomicU64::new(0),
        outcome: Mutex::default(),
    };
    let wanted = (settings.thread_count() as u64).min(plan.len()).max(1);
    let threads = thread::scope(|scope| {
        let spawn = |i: &u64| {
            let builder = thread::Builder::new().name(format!("render-{i}")).stack_size(STACK);
            builder.spawn_scoped(scope, || pass.work()).is_ok()
        };
        (0..wanted).take_while(spawn).count()
    });
    if threads == 0 {
        // The system gives no threads. Fewer than asked for make the same picture.
        pass.work();
    }
    pass.finish(start.elapsed().as_secs_f64(), threads.max(1))
}

/// Renders one unit into a part, which is emptied first.
///
/// * `ctx`: the rays cast are added to its counters
/// * `go_on`: told every 256 camera rays, and at the end, how many were cast since it was last told, and
///   the counters; says whether to go on
///
/// Returns whether the unit was finished. If not, the part holds the samples taken so far.
pub fn render_unit<I: PixelIntegrator + ?Sized>(
    integrator: &I,
    ctx: &mut SampleContext<'_>,
    unit: &Unit,
    part: &mut FilmPart,
    mut go_on: impl FnMut(u64, &RayCounters) -> bool,
) -> bool {
    ctx.splats.clear();
    let finished = take_samples(integrator, ctx, unit, part, &mut go_on);
    part.take_splats(&mut ctx.splats);
    finished
}

fn take_samples<I: PixelIntegrator + ?Sized>(
    integrator: &I,
    ctx: &mut SampleContext<'_>,
    unit: &Unit,
    part: &mut FilmPart,
    go_on: &mut impl FnMut(u64, &RayCounters) -> bool,
) -> bool {
    let tile = unit.tile;
    part.reset(&tile);
    let wants_auxiliary = part.spec().layers.wants_auxiliary();
    let mut untold = 0;
    for y in tile.y0..tile.y1 {
        for x in tile.x0..tile.x1 {
            let corner = Vec2::new(x as f32, y as f32);
            for k in unit.samples.clone() {
                let offset = ctx.begin([x, y], k);
                if wants_auxiliary {
                    ctx.aux = Auxiliary::default();
                }
                let sample = integrator.sample(ctx, [x, y], corner + offset);
                part.add(x, y, k, offset, &sample, &ctx.aux);
                untold += 1;
                if untold == SAMPLES_PER_CHECK {
                    if !go_on(untold, &ctx.rays) {
                        return false;
                    }
                    untold = 0;
                }
            }
        }
    }
    go_on(untold, &ctx.rays);
    true
}

/// One call of [`render`], as its threads share it.
struct Pass<'a, I: ?Sized> {
    integrator: &'a I,
    film: &'a Film,
    settings: &'a RenderSettings,
    progress: &'a dyn Progress,
    plan: Plan,
    next: AtomicU64,
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
}

impl<I: PixelIntegrator + ?Sized> Pass<'_, I> {
    /// Renders units until none is left.
    fn work(&self) {
        let mut part = FilmPart::new(self.film.spec(), &self.settings.sampler);
        let mut ctx = SampleContext::new(&self.settings.sampler, self.settings.seed);
        let mut failed = Vec::new();
        while !self.stopped()
            && let Some(unit) = self.plan.unit(self.next.fetch_add(1, Ordering::Relaxed))
        {
            let attempt = catch_unwind(AssertUnwindSafe(|| self.render(&unit, &mut part, &mut ctx)));
            if let Err(panic) = attempt {
                ctx.scratch = Scratch::default();
                failed.push(FailedUnit { unit, message: message_of(&*panic) });
            }
        }
        let mut outcome = self.outcome.lock().unwrap_or_else(PoisonError::into_inner);
        outcome.rays += ctx.rays;
        outcome.failed.append(&mut failed);
    }

    /// Renders a unit and adds it to the film, finished or not.
    fn render(&self, unit: &Unit, part: &mut FilmPart, ctx: &mut SampleContext<'_>) {
        let mut told = ctx.rays.total();
        render_unit(self.integrator, ctx, unit, part, |samples, counters| {
            let rays = counters.total() - told;
            told += rays;
            self.report(samples, rays);
            !self.stopped()
        });
        self.film.add(part);
    }

    fn report(&self, samples: u64, rays: u64) {
        let samples = self.samples.fetch_add(samples, Ordering::Relaxed) + samples;
        let rays = self.rays.fetch_add(rays, Ordering::Relaxed) + rays;
        let per_pixel = u64::from(self.settings.sampler.samples());
        self.progress.done(samples / per_pixel, self.film.spec().rect().area(), rays);
    }

    fn stopped(&self) -> bool {
        let stop = self.stop.load(Ordering::Relaxed) || self.progress.cancelled();
        if stop {
            self.stop.store(true, Ordering::Relaxed);
        }
        stop
    }

    fn finish(self, seconds: f64, threads: usize) -> Result<RenderStats, RenderError> {
        let samples = self.samples.into_inner();
        let Outcome { rays, mut failed } = self.outcome.into_inner().unwrap_or_else(PoisonError::into_inner);
        let stats = RenderStats { rays, samples, non_finite: self.film.non_finite(), seconds, threads };
        if !failed.is_empty() {
            failed.sort_by_key(|f| (f.unit.tile.y0, f.unit.tile.x0, f.unit.samples.start));
            return Err(RenderError::Panicked { failed, stats });
        }
        if self.stop.into_inner() && samples < self.plan.samples_in_all() {
            return Err(RenderError::Cancelled(stats));
        }
        Ok(stats)
    }
}

/// The units of a picture, numbered.
#[derive(Clone, Copy, Debug)]
struct Plan {
    grid: Grid,
    pixels: u64,
    samples: u32,
    /// Parts that the samples are split into.
    ranges: u32,
}

impl Plan {
    fn new(film: &Film, settings: &RenderSettings) -> Plan {
        let spec = film.spec();
        let samples = settings.sampler.samples();
        let tile = if settings.tile == 0 { TILE } else { settings.tile.min(LARGEST_TILE) };
        let grid = Grid::new(spec.width, spec.height, tile);
        let wanted = (UNITS_PER_THREAD * settings.thread_count() as u64).div_ceil(grid.len());
        let ranges = if spec.keeps_sums() { wanted.min(u64::from(samples)).max(1) as u32 } else { 1 };
        Plan { grid, pixels: spec.rect().area(), samples, ranges }
    }

    /// Units; none when there are no samples.
    fn len(&self) -> u64 {
        if self.samples == 0 { 0 } else { self.grid.len() * u64::from(self.ranges) }
    }

    fn samples_in_all(&self) -> u64 {
        self.pixels * u64::from(self.samples)
    }

    /// Unit `index`: all tiles with the first range of samples, then all with the second, and so on.
    fn unit(&self, index: u64) -> Option<Unit> {
        if index >= self.len() {
            return None;
        }
        let (column, row) = order::place(index % self.grid.len(), self.grid.columns(), self.grid.rows());
        let range = index / self.grid.len();
        let start = |r: u64| (u64::from(self.samples) * r / u64::from(self.ranges)) as u32;
        Some(Unit { tile: self.grid.cell(column, row), samples: start(range)..start(range + 1) })
    }
}

/// The text of a panic.
fn message_of(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().copied();
    let text = text.or_else(|| panic.downcast_ref::<String>().map(String::as_str));
    text.unwrap_or("a panic without a message").to_string()
}

#[cfg(test)]
mod tests;
