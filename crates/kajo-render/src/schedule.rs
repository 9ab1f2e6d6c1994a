//! Rendering a picture by tiles on all cores.
//!
//! A unit of work is a tile and a range of samples; what comes of it is a [`FilmPart`], and parts add
//! up exactly. Each random number depends on (seed, pixel, sample, dimension) only. So neither the
//! number of threads, nor the size of tiles, nor the order of the work can change a bit of the
//! picture.
//!
//! Threads take the next unit from a counter until none is left, which keeps all of them busy to the
//! end; tiles are numbered along a Hilbert curve (see [`order`](crate::order)). When a picture has few
//! tiles for the threads at hand, its samples are split as well.
//!
//! What samples of an integrator share is made before them (see [`state`](crate::state)); passes end where that changes.
//!
//! [`render`] takes all samples in one pass over the picture. [`render_passes`] takes them in several, with the whole
//! picture to be seen after each; the bits at the end are the same.

pub mod adaptive;
mod pass;
mod passes;
mod stages;

use std::{ops::Range, thread, time::Instant};

use kajo_core::sampler::{Sampler, SamplerKind};
use kajo_math::Vec2;
use kajo_math::rng::{Key, mix};
use thiserror::Error;

use crate::{
    Auxiliary, Film, FilmPart, PixelIntegrator, Progress, RayCounters, Rect, SampleContext, Setup,
    SetupError, context::RAYS_PER_CHECK, state::States,
};
use pass::{PassShare, Plan, carry_out};
pub use passes::{Goal, Position, render_passes};
pub use stages::render_work_unit;

/// Side of a tile in pixels unless the settings say otherwise.
const TILE: u32 = 32;

/// Largest side of a tile, since each thread holds the sums of one.
pub const LARGEST_TILE: u32 = 512;

/// Most threads that are started, whatever is asked for.
pub const MOST_THREADS: usize = 1024;

/// Units for each thread below which samples are split too.
const UNITS_PER_THREAD: u64 = 8;

/// Stack of a thread in bytes. No path takes more of it for being long or for having forked.
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
    /// Bytes that the state of an integrator may take.
    pub memory: u64,
}

impl RenderSettings {
    /// These samples with seed 0, on all cores, with default tiles and memory without bound.
    pub fn new(sampler: Sampler) -> RenderSettings {
        RenderSettings { sampler, seed: 0, threads: 0, tile: 0, memory: u64::MAX }
    }

    /// Threads to start, the default filled in.
    fn thread_count(&self) -> usize {
        match self.threads {
            0 => thread::available_parallelism().map_or(1, |n| n.get()),
            n => n.min(MOST_THREADS),
        }
    }

    /// What an integrator may use to make its state.
    pub fn setup<'a>(&self, progress: &'a dyn Progress) -> Setup<'a> {
        Setup { seed: self.seed, threads: self.thread_count(), memory: self.memory, progress }
    }
}

/// A tile and a range of its samples.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unit {
    /// Pixels.
    pub tile: Rect,
    /// Positions of samples of each of them in the order in which the sampler's are taken.
    pub samples: Range<u32>,
    /// How many samples of even and of odd index the pixels get in all; what the range has beyond is left out.
    pub limits: [u32; 2],
}

impl Unit {
    /// Samples of even and odd index without a limit.
    pub const UNLIMITED: [u32; 2] = [u32::MAX; 2];

    /// The samples of each pixel.
    fn indices(&self, sampler: &Sampler) -> impl Iterator<Item = u32> + Clone + use<> {
        let limits = self.limits;
        let within = move |k: &u32| k / 2 < limits[*k as usize % 2];
        Sequence::new(sampler).indices(self.samples.clone()).filter(within)
    }

    /// How many these are, of a sampler whose samples come in order.
    fn count(&self) -> u32 {
        let [even, odd] = self.limits.map(|limit| limit.saturating_mul(2));
        let below = |k: u32| k.min(even).div_ceil(2) + k.min(odd) / 2;
        below(self.samples.end) - below(self.samples.start)
    }
}

/// The order in which samples are taken. Any beginning of it should be spread over the pixel.
#[derive(Clone, Copy, Debug)]
struct Sequence {
    /// From one index to the next.
    stride: u64,
    /// The index is taken modulo this.
    modulus: u64,
}

impl Sequence {
    fn new(sampler: &Sampler) -> Sequence {
        match sampler.kind() {
            // Sub-pixels row by row: jump by the golden section of their number.
            SamplerKind::Regular | SamplerKind::Jittered => {
                let n = u64::from(sampler.samples().max(1));
                let golden = (n as f64 * 0.618_034) as u64;
                let stride = (golden.max(1)..).find(|&stride| inverse(stride, n).is_some()).unwrap_or(1);
                Sequence { stride, modulus: n }
            }
            _ => Sequence { stride: 1, modulus: u64::MAX },
        }
    }

    /// The indices of samples at some positions of the sequence.
    fn indices(self, positions: Range<u32>) -> impl Iterator<Item = u32> + Clone {
        let Sequence { stride, modulus } = self;
        let first = u64::from(positions.start) * stride % modulus;
        positions.scan(first, move |next, _| {
            let index = *next as u32;
            *next += stride;
            if *next >= modulus {
                *next -= modulus;
            }
            Some(index)
        })
    }

    /// The position at which [`Sequence::indices`] has an index; `None` where the sequence does not have it.
    fn position(self, index: u32) -> Option<u32> {
        let Sequence { stride, modulus } = self;
        let index = u64::from(index);
        // Of fewer than 2^32 samples, so that the product has room.
        let position = if stride == 1 { index } else { index * inverse(stride, modulus)? % modulus };
        (index < modulus).then_some(position as u32)
    }
}

/// The position in the order in which a render takes the samples of a pixel at which it takes that of an index, which is what decides on the
/// [state](crate::state) that it is taken with. Indices beyond all samples are their own positions.
pub fn position_of(sampler: &Sampler, index: u32) -> u32 {
    Sequence::new(sampler).position(index).unwrap_or(index)
}

/// The number whose product with `a` is 1 modulo `n`, below `n`, by Euclid's algorithm; `None` where both have a common divisor.
///
/// * `a`, `n`: at most 2^32, `n` not zero
fn inverse(a: u64, n: u64) -> Option<u64> {
    // Each remainder is `a` times its factor, modulo n.
    let (mut remainders, mut factors) = ([n as i64, a as i64], [0, 1]);
    while remainders[1] != 0 {
        let quotient = remainders[0] / remainders[1];
        remainders = [remainders[1], remainders[0] - quotient * remainders[1]];
        factors = [factors[1], factors[0] - quotient * factors[1]];
    }
    (remainders[0] == 1).then(|| factors[0].rem_euclid(n as i64) as u64)
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
        /// At least one unit, sorted by position.
        failed: Vec<FailedUnit>,
        /// What the render took.
        stats: RenderStats,
    },
    /// What the integrator's samples share could not be made.
    #[error("{message}")]
    Unprepared {
        /// Why, a sentence for the user.
        message: String,
        /// What the render took.
        stats: RenderStats,
    },
}

impl RenderError {
    /// What a failed preparation means to a render that took so much.
    fn of_setup(error: SetupError, stats: RenderStats) -> RenderError {
        match error {
            SetupError::Cancelled => RenderError::Cancelled(stats),
            error => RenderError::Unprepared { message: error.to_string(), stats },
        }
    }
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
    let all = settings.sampler.samples();
    let in_all = Plan::new(film, settings, 0..all, &[]).samples();
    let mut states = States::new(integrator);
    let (mut stats, mut begin) = (RenderStats::default(), 0);
    loop {
        let end = states.end_of_part(begin).min(all);
        let setup = settings.setup(progress);
        let with_state = states.at(begin, &setup, &mut stats.rays);
        let with_state = with_state.map_err(|error| RenderError::of_setup(error, stats))?;
        let plan = Plan::new(film, settings, begin..end, &[]);
        let share = PassShare {
            samples: stats.samples,
            rays: stats.rays.total(),
            samples_in_all: in_all,
            ..PassShare::default()
        };
        let done = match with_state {
            Some(with_state) => carry_out(with_state, film, progress, settings, &plan, share, &[]),
            None => carry_out(integrator, film, progress, settings, &plan, share, &[]),
        };
        stats = stats.and(done.stats, start.elapsed().as_secs_f64());
        match (done.failed.is_empty(), done.is_complete) {
            (false, _) => return Err(RenderError::Panicked { failed: done.failed, stats }),
            (true, false) => return Err(RenderError::Cancelled(stats)),
            (true, true) if end == all => return Ok(stats),
            (true, true) => begin = end,
        }
    }
}

/// Renders one unit into a part, which is emptied first.
///
/// * `ctx`: the rays cast are added to its counters
/// * `go_on`: called every 256 camera rays, more often where they branch, and at the end, with how many were cast since the
///   last call, and the counters; returns whether to go on
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
    ctx.chains.clear();
    let finished = take_samples(integrator, ctx, unit, part, &mut go_on);
    part.take_splats(&mut ctx.splats);
    part.take_chains(&mut ctx.chains);
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
    // The halves of a film are two renders with seeds of their own.
    let halves = part.spec().halves.then(|| [ctx.seed(), mix(ctx.seed())].map(Key::new));
    let indices = unit.indices(ctx.sampler);
    let (mut untold, mut rays_told) = (0, ctx.rays.total());
    for y in tile.y0..tile.y1 {
        for x in tile.x0..tile.x1 {
            let corner = Vec2::new(x as f32, y as f32);
            for k in indices.clone() {
                let offset = match halves {
                    Some(seeds) => ctx.begin_with(seeds[k as usize % 2], [x, y], k / 2),
                    None => ctx.begin([x, y], k),
                };
                if wants_auxiliary {
                    ctx.aux = Auxiliary::default();
                }
                let lost_before = ctx.rays.lost;
                let sample = integrator.sample(ctx, [x, y], corner + offset);
                if ctx.is_interrupted() {
                    go_on(untold, &ctx.rays);
                    return false;
                }
                if wants_auxiliary {
                    ctx.aux.lost = (ctx.rays.lost - lost_before) as f32;
                }
                part.add(x, y, k, offset, &sample, &ctx.aux);
                untold += 1;
                if untold == SAMPLES_PER_CHECK || ctx.rays.total() - rays_told >= RAYS_PER_CHECK {
                    if !go_on(untold, &ctx.rays) {
                        return false;
                    }
                    (untold, rays_told) = (0, ctx.rays.total());
                }
            }
        }
    }
    go_on(untold, &ctx.rays);
    true
}

#[cfg(test)]
mod tests;
