//! A Markov chain over the numbers of a sample.

use kajo_core::sampler::Sampler;
use kajo_math::rng::{Key, Stream, unit};
use kajo_math::{Vec2, fmath};

use super::mutated::Mutated;
use crate::context::{Scratch, Splat};
use crate::{RayCounters, SampleContext};

/// Numbers of a path that a chain keeps, and of the path beside it.
pub const KEPT: [usize; 2] = [96, 48];

/// Probability of a large step.
pub const LARGE_STEP: f32 = 0.3;

/// The largest small step, and the logarithm of its ratio to the smallest.
const STEP: f32 = 1.0 / 64.0;
const LN_RANGE: f32 = 2.772_588_7;

/// Sets the seeds of mutations apart from those of samples.
const SALT: u64 = 0x6D75_7461_7465;

/// A sample to begin at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Start {
    pub seed: u64,
    pub number: u32,
    /// The class of its paths; see [`Mutated`].
    pub class: u32,
}

/// The mean importance of the samples of a class, and that of all classes.
#[derive(Clone, Copy, Debug)]
pub struct Brightness {
    pub of_class: f64,
    pub of_all: f64,
}

/// The light of a sample.
#[derive(Clone, Debug, Default)]
pub struct Light {
    /// Where it is seen.
    splats: Vec<Splat>,
    /// Where the brightest of it is seen.
    brightest: Vec2,
    /// The mean over the channels of the absolute value of its sum: 0 only where it is black.
    pub importance: f32,
}

/// Numbers of a sample: those that are kept, path by path.
#[derive(Clone, Debug)]
struct Numbers {
    paths: [Vec<f32>; 2],
    /// Chooses the technique, where samples have one alone.
    technique: f32,
}

impl Numbers {
    fn of(start: &Start) -> Numbers {
        let numbers = |path: usize| {
            let stream = Stream::new(start.seed, [start.number, path as u32], 0);
            (0..KEPT[path] as u32).map(|d| stream.uniform(d)).collect()
        };
        let technique = Stream::new(start.seed, [start.number, 2], 0).uniform(0);
        Numbers { paths: [numbers(0), numbers(1)], technique }
    }
}

/// Takes samples by given numbers.
pub struct Evaluation<'a> {
    mutated: Mutated<'a>,
    size: [u32; 2],
    sampler: Sampler,
    scratch: Scratch,
    rays: RayCounters,
    /// Keeps the seeds of hashed numbers apart.
    key: Key,
}

impl<'a> Evaluation<'a> {
    /// For independent samples.
    pub fn alone(mutated: Mutated<'a>, size: [u32; 2]) -> Evaluation<'a> {
        let sampler = Sampler::given(Vec::new(), Vec::new());
        let (scratch, rays) = (Scratch::default(), RayCounters::default());
        Evaluation { mutated, size, sampler, scratch, rays, key: Key::new(SALT) }
    }

    /// For a chain: with the memory and the counters of a sample's surroundings, and random numbers that are its own.
    pub fn of(mutated: Mutated<'a>, size: [u32; 2], ctx: &mut SampleContext<'_>) -> Self {
        let [a, b] = [0, 1].map(|d| ctx.draws.stream().bits(d));
        let scratch = std::mem::take(&mut ctx.scratch);
        let key = Key::new(ctx.seed() ^ SALT).part([a, b]);
        Evaluation { scratch, rays: ctx.rays, key, ..Evaluation::alone(mutated, size) }
    }

    /// Hands memory and counters back.
    pub fn give_back(self, ctx: &mut SampleContext<'_>) {
        ctx.scratch = self.scratch;
        ctx.rays = self.rays;
    }

    /// Whether the render is to stop.
    pub fn is_given_up(&self, ctx: &SampleContext<'_>) -> bool {
        ctx.interrupt.is_some_and(|interrupt| {
            interrupt.ask();
            interrupt.is_raised()
        })
    }

    /// Rays cast so far.
    pub fn rays(&self) -> RayCounters {
        self.rays
    }

    /// The light of a sample to begin at.
    pub fn begin(&mut self, start: &Start) -> Light {
        let mut light = Light::default();
        let seed = start.seed ^ u64::from(start.number) << 20;
        self.light_of(start.class, &Numbers::of(start), seed, &mut light);
        light
    }

    /// * `seed`: of the numbers that are not given
    fn light_of(&mut self, class: u32, numbers: &Numbers, seed: u64, light: &mut Light) {
        let [path, beside] = &numbers.paths;
        self.sampler.give(path, beside);
        let mut ctx = SampleContext::new(&self.sampler, seed);
        ctx.scratch = std::mem::take(&mut self.scratch);
        ctx.rays = self.rays;
        let size = Vec2::from(self.size.map(|n| n as f32));
        let raster = ctx.begin([0, 0], 0) * size;
        let (sample, scale) = self.mutated.sample(&mut ctx, raster, class, numbers.technique);
        light.splats.clear();
        light.splats.push(Splat { raster, value: sample.radiance });
        light.splats.extend_from_slice(ctx.splats.as_slice());
        light.splats.iter_mut().for_each(|splat| splat.value = splat.value.map(|v| v * scale));
        light.splats.retain(|splat| splat.value != [0.0; 3] && is_within(splat.raster, size));
        let sum = light.splats.iter().fold([0.0; 3], |sum, splat| [0, 1, 2].map(|i| sum[i] + splat.value[i]));
        let importance = mean(sum);
        // What is no number is a bug that the film counts, and no place for a chain.
        light.importance = if importance.is_finite() { importance } else { 0.0 };
        let first = Splat { raster, value: [0.0; 3] };
        let brighter = |a: Splat, &b: &Splat| if mean(b.value) > mean(a.value) { b } else { a };
        light.brightest = light.splats.iter().fold(first, brighter).raster;
        (self.scratch, self.rays) = (ctx.scratch, ctx.rays);
    }
}

/// The mean over the channels of absolute values.
fn mean(value: [f32; 3]) -> f32 {
    value.into_iter().map(f32::abs).sum::<f32>() / 3.0
}

/// Whether a position lies in the picture.
fn is_within(raster: Vec2, size: Vec2) -> bool {
    raster.min_element() >= 0.0 && raster.x < size.x && raster.y < size.y
}

/// A chain, and where it is.
pub struct Chain {
    class: u32,
    numbers: Numbers,
    light: Light,
    /// Where it may go.
    proposal: (Numbers, Light),
}

impl Chain {
    /// A chain that begins there.
    pub fn new(start: Start, evaluation: &mut Evaluation<'_>) -> Chain {
        let numbers = Numbers::of(&start);
        let light = evaluation.begin(&start);
        Chain { class: start.class, proposal: (numbers.clone(), Light::default()), numbers, light }
    }

    /// Where the brightest part of its light is seen, in pixels.
    pub fn brightest(&self) -> Vec2 {
        self.light.brightest
    }

    /// Mutation `m`: hands the light of both states to `found`, such that the mean over mutations of the sum of what is found is that of
    /// the picture, and moves or stays.
    ///
    /// * `b`: mean importance of the picture, and of the chain's class
    pub fn mutate(
        &mut self,
        m: u32,
        b: Brightness,
        evaluation: &mut Evaluation<'_>,
        found: &mut dyn FnMut(Vec2, [f32; 3]),
    ) {
        let key = evaluation.key.part([m, 0]);
        let [choice, by_chance, seed] = key.words([0, 0]);
        let is_large = unit(choice) < LARGE_STEP;
        let (numbers, light) = &mut self.proposal;
        for (path, (proposed, current)) in numbers.paths.iter_mut().zip(&self.numbers.paths).enumerate() {
            propose(is_large, key.part([1, path as u32]), current, proposed);
        }
        propose(
            is_large,
            key.part([1, 2]),
            &[self.numbers.technique],
            std::slice::from_mut(&mut numbers.technique),
        );
        evaluation.light_of(self.class, numbers, u64::from(seed) << 32 | u64::from(by_chance), light);
        let a = acceptance(self.light.importance, light.importance);
        // [Kelemen et al. 2002, eq. 13]; a chain of this class is drawn with the probability b_k/b [Hachisuka, Kaplanyan and Dachsbacher 2014].
        let share_of_class = b.of_all / b.of_class;
        let weight = |share: f32, light: &Light| {
            let importance = f64::from(light.importance) / b.of_class;
            (f64::from(share) * share_of_class / (importance + f64::from(LARGE_STEP))) as f32
        };
        let shares = [a + f32::from(u8::from(is_large)), 1.0 - a];
        for (share, light) in shares.into_iter().zip([&*light, &self.light]) {
            if share > 0.0 {
                let weight = weight(share, light);
                light.splats.iter().for_each(|splat| found(splat.raster, splat.value.map(|v| v * weight)));
            }
        }
        if unit(by_chance) < a {
            std::mem::swap(&mut self.numbers, numbers);
            std::mem::swap(&mut self.light, light);
        }
    }
}

/// Probability of going from one importance to another.
pub fn acceptance(from: f32, to: f32) -> f32 {
    if to >= from { 1.0 } else { to / from }
}

/// The numbers of a proposal.
fn propose(is_large: bool, key: Key, current: &[f32], proposed: &mut [f32]) {
    for (d, (proposed, &current)) in proposed.iter_mut().zip(current).enumerate() {
        let [u, sign, _] = key.words([d as u32, 0]);
        *proposed = if is_large { unit(u) } else { moved(current, unit(u), sign & 1 == 1) };
    }
}

/// A number moved by a small step, around the torus.
///
/// * `x`: uniform in [0, 1)
pub fn moved(u: f32, x: f32, is_up: bool) -> f32 {
    let step = STEP * fmath::exp(-LN_RANGE * x);
    let moved = if is_up { u + step } else { u - step };
    let turned = if moved >= 1.0 {
        moved - 1.0
    } else if moved < 0.0 {
        moved + 1.0
    } else {
        moved
    };
    // Rounding may lead up to 1.
    turned.min(1.0 - f32::EPSILON / 2.0)
}
