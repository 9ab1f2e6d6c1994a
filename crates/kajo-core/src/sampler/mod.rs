//! Where the samples of a pixel lie, in the pixel and in every further dimension of a path.
//!
//! A sample of a pixel is a point in a cube of many dimensions: a place in the pixel, a place on the lens, a time, a
//! wavelength, and then whatever its path needs. [`SampleStream`] hands the coordinates out one after the other. Each
//! is uniform in [0, 1) and a function of (seed, pixel, sample, dimension), and what the kinds of samplers
//! differ in is how the samples of a pixel, or of neighbouring pixels, lie to each other:
//!
//! | kind | two coordinates at a time | good for |
//! |---|---|---|
//! | uniform | independent | comparison |
//! | regular | the middles of a grid in the pixel, else as jittered | the classic program's pictures |
//! | jittered | one in each cell of a grid; multi-jitter [Chiu et al. 1994] behind the film | any number |
//! | cmj | correlated multi-jitter [Kensler 2013] | smooth light, any number |
//! | pmj | progressive multi-jittered (0, 2) points [Christensen et al. 2018] | |
//! | poisson | maximal Poisson-disk sets [Ebeida et al. 2012] | looking at edges |
//! | sobol | Owen-scrambled (0, 2)-sequence, shuffled for each pair [Burley 2020] | powers of two |
//! | zsobol | the same along a shuffled Z-curve through the picture [Ahmed and Wonka 2020] | few samples |
//!
//! Numbers can also be given: methods that change a path a little, as Metropolis light transport does, see it as a point in
//! the cube of its numbers [Kelemen et al. 2002], and move that point. [`Sampler::given`] hands the coordinates of one out,
//! and independent ones behind its end.
//!
//! Scene: `Settings { samples sobol 64 }`

mod sample_stream;
mod zorder;

use std::sync::Arc;

use kajo_math::{Vec2, pmj, poisson};

pub use sample_stream::SampleStream;

/// The rule by which samples are spread.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SamplerKind {
    /// Independent uniform numbers.
    Uniform,
    /// The middles of sub-pixels, without randomness; stratified in the dimensions behind the film.
    Regular,
    /// One uniform position in each sub-pixel; stratified in the dimensions behind the film.
    Jittered,
    /// Owen-scrambled Sobol points.
    Sobol,
    /// Owen-scrambled Sobol points that make the error of neighbouring pixels differ: blue noise on the screen.
    ZSobol,
    /// Progressive multi-jittered (0, 2) points.
    Pmj,
    /// Maximal Poisson-disk sets.
    Poisson,
    /// Correlated multi-jittered samples.
    Cmj,
}

impl SamplerKind {
    /// Names on the command line and in `Settings`, in alphabetical order. One kind has two.
    pub const NAMES: [(&'static str, SamplerKind); 9] = [
        ("bluenoise", SamplerKind::ZSobol),
        ("cmj", SamplerKind::Cmj),
        ("jittered", SamplerKind::Jittered),
        ("pmj", SamplerKind::Pmj),
        ("poisson", SamplerKind::Poisson),
        ("regular", SamplerKind::Regular),
        ("sobol", SamplerKind::Sobol),
        ("uniform", SamplerKind::Uniform),
        ("zsobol", SamplerKind::ZSobol),
    ];

    /// The kind of that name.
    pub fn from_name(name: &str) -> Option<SamplerKind> {
        SamplerKind::NAMES.iter().find(|(known, _)| *known == name).map(|&(_, kind)| kind)
    }

    /// The first of its names.
    pub fn name(self) -> &'static str {
        SamplerKind::NAMES.iter().find(|(_, kind)| *kind == self).map_or("", |(name, _)| name)
    }

    /// Whether sample `k` of a pixel is the same one whatever the number of samples, so that more of them can be
    /// added to those that were taken. Otherwise the number says how the pixel, or the picture, is divided.
    pub fn is_open_ended(self) -> bool {
        matches!(self, SamplerKind::Uniform | SamplerKind::Sobol)
    }

    /// Whether positions in the pixel are those of the classic program.
    fn is_classic(self) -> bool {
        matches!(self, SamplerKind::Uniform | SamplerKind::Regular | SamplerKind::Jittered)
    }
}

/// The most progressive multi-jittered points that are laid out; more samples go through them again.
const PMJ_POINTS: u32 = 4096;

/// The most points of one Poisson-disk set; more samples are spread over several.
const POISSON_POINTS: u32 = 1024;

/// Seed of the point sets that all pixels share.
const SET_SEED: u64 = 0x6B61_6A6F;

/// A rule and a number of samples.
#[derive(Clone, Debug)]
pub struct Sampler {
    kind: SamplerKind,
    samples: u32,
    /// Sub-pixels on a side, at least 1.
    side: u32,
    /// The point set of the kinds that have one, as fractions of 2^32.
    points: Arc<[[u32; 2]]>,
    /// The first numbers of each sample, where they are given.
    given: Vec<f32>,
    /// Where numbers are given, what those of a path beside are.
    beside: Option<Box<Sampler>>,
}

impl PartialEq for Sampler {
    fn eq(&self, other: &Sampler) -> bool {
        // The point set follows from the first two.
        let parts = |sampler: &Sampler| (sampler.kind, sampler.samples);
        parts(self) == parts(other) && self.given == other.given && self.beside == other.beside
    }
}

/// Given numbers are in [0, 1).
impl Eq for Sampler {}

impl Sampler {
    /// `samples` may be 0: a picture without samples is black.
    ///
    /// Some kinds lay out their point set here, which takes up to a quarter of a second.
    pub fn new(kind: SamplerKind, samples: u32) -> Sampler {
        let points = match kind {
            SamplerKind::Pmj => pmj::sequence(samples.clamp(1, PMJ_POINTS) as usize, SET_SEED),
            SamplerKind::Poisson => poisson_points(samples),
            _ => Vec::new(),
        };
        let side = samples.isqrt().max(1);
        Sampler { kind, samples, side, points: points.into(), given: Vec::new(), beside: None }
    }

    /// Numbers that are known: those of a sample are `path` in the order of its dimensions, and those of the path that
    /// splits off to be followed beside it are `beside`. Whatever is asked for behind the end of either is independent and
    /// uniform, a hash of seed, pixel, sample and dimension as ever; so is all that a path needs which splits in several.
    ///
    /// * `path`, `beside`: in [0, 1)
    pub fn given(path: Vec<f32>, beside: Vec<f32>) -> Sampler {
        debug_assert!(path.iter().chain(&beside).all(|u| (0.0..1.0).contains(u)), "{path:?} {beside:?}");
        let unknown = Sampler::new(SamplerKind::Uniform, 1);
        let beside = Sampler { given: beside, beside: Some(Box::new(unknown.clone())), ..unknown.clone() };
        Sampler { given: path, beside: Some(Box::new(beside)), ..unknown }
    }

    /// Gives other numbers, in the memory of those of [`Sampler::given`].
    ///
    /// * `path`, `beside`: in [0, 1)
    pub fn give(&mut self, path: &[f32], beside: &[f32]) {
        let replace = |given: &mut Vec<f32>, numbers: &[f32]| {
            given.clear();
            given.extend_from_slice(numbers);
        };
        replace(&mut self.given, path);
        match &mut self.beside {
            Some(sampler) => replace(&mut sampler.given, beside),
            None => *self = Sampler::given(path.to_vec(), beside.to_vec()),
        }
    }

    /// Where the numbers of a path come from that splits off as one of `n`.
    fn of_split(&self, n: u32) -> &Sampler {
        let beside = self.beside.as_deref().unwrap_or(self);
        // The numbers that are given are for one path.
        if n == 1 { beside } else { beside.beside.as_deref().unwrap_or(beside) }
    }

    /// The rule.
    pub fn kind(&self) -> SamplerKind {
        self.kind
    }

    /// Samples per pixel.
    pub fn samples(&self) -> u32 {
        self.samples
    }

    /// Whether some samples lie below the pixel they count for, because their number is no square.
    pub fn overhangs(&self) -> bool {
        let in_rows = matches!(self.kind, SamplerKind::Regular | SamplerKind::Jittered);
        in_rows && self.samples > self.side * self.side
    }

    /// Height of the region the samples are spread over, in pixels: 1, or more when they overhang.
    pub fn height(&self) -> f32 {
        if self.overhangs() { self.samples.div_ceil(self.side) as f32 / self.side as f32 } else { 1.0 }
    }

    /// The point `u` of [0, 1)² carried into the sub-pixel of sample `k`.
    #[inline]
    fn in_sub_pixel(&self, k: u32, u: Vec2) -> Vec2 {
        if k == 0 && self.side == 1 {
            return u; // The whole pixel.
        }
        let place = |cell: u32, u: f32| {
            let p = (cell as f32 + u) / self.side as f32;
            let end = (cell + 1) as f32 / self.side as f32;
            // The sum may round up to the next sub-pixel, which does not belong to this one.
            if p < end { p } else { end.next_down() }
        };
        Vec2::new(place(k % self.side, u.x), place(k / self.side, u.y))
    }
}

/// A Poisson-disk set for `samples` samples, or for an equal share of them.
fn poisson_points(samples: u32) -> Vec<[u32; 2]> {
    let samples = samples.max(1);
    let sets = samples.div_ceil(POISSON_POINTS);
    let set = poisson::exactly(samples.div_ceil(sets) as usize, SET_SEED);
    set.iter().map(|p| (*p * 4_294_967_296.0).to_array().map(|c| c as u32)).collect()
}

#[cfg(test)]
mod tests;
