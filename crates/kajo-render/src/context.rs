//! What an integrator works with while it takes a sample: one [`SampleContext`] for each thread.
//!
//! The context hands in the random numbers of the sample and takes what is more than the sample's own
//! value: the count of rays, values of rare layers, and splats. A *splat* is light for any position of the
//! picture, as light tracing and bidirectional methods find it. With `S` samples in all over a picture of
//! `P` pixels, the splats add to pixel `j`
//!
//! ```text
//! I_j = P/S Σ w(splat - centre of j) value / ∫ w
//! ```
//!
//! They are divided by the number of samples and not by the weights that happened to fall near, which would
//! be biased [Pharr, Jakob and Humphreys 2023, 5.4.2]; the integral of the filter `w` runs over the part of its
//! support that lies in the picture. So the mean of the picture is the mean over all samples of the sum of their
//! splats.

use std::any::Any;
use std::cell::Cell;
use std::fmt;

use kajo_core::light::MAX_LIGHT_GROUPS;
use kajo_core::sampler::{SampleStream, Sampler};
use kajo_math::Vec2;
use kajo_math::rng::Key;

use crate::{ChainCounts, RayCounters};

/// The surroundings of a sample.
#[derive(Debug)]
pub struct SampleContext<'a> {
    /// The rule by which samples are spread.
    pub sampler: &'a Sampler,
    /// Seed of every random number.
    seed: u64,
    /// Its key, which every sample asks for.
    key: Key,
    /// Index of the sample within its pixel.
    pub index: u32,
    /// The random numbers of the sample behind its place in the pixel.
    pub draws: SampleStream<'a>,
    /// Rays cast by the thread so far.
    pub rays: RayCounters,
    /// Values of rare layers; zero before each sample.
    pub aux: Auxiliary,
    /// Light for anywhere in the picture.
    pub splats: Splats,
    /// Where Markov chains were.
    pub chains: ChainCounts,
    /// Memory of the integrator's own, kept from sample to sample.
    pub scratch: Scratch,
    /// Asked within samples that take long.
    pub(crate) interrupt: Option<&'a Interrupt<'a>>,
}

impl<'a> SampleContext<'a> {
    /// The context of a thread, made ready for sample 0 of pixel (0, 0).
    pub fn new(sampler: &'a Sampler, seed: u64) -> SampleContext<'a> {
        SampleContext {
            sampler,
            seed,
            key: Key::new(seed),
            index: 0,
            draws: SampleStream::new(sampler, seed, [0, 0], 0),
            rays: RayCounters::default(),
            aux: Auxiliary::default(),
            splats: Splats::default(),
            chains: ChainCounts::default(),
            scratch: Scratch::default(),
            interrupt: None,
        }
    }

    /// The same, with samples that may be given up.
    pub(crate) fn interruptible(self, interrupt: &'a Interrupt<'a>) -> SampleContext<'a> {
        SampleContext { interrupt: Some(interrupt), ..self }
    }

    /// Whether the last sample was given up, so that it is to be thrown away.
    pub(crate) fn is_interrupted(&self) -> bool {
        self.interrupt.is_some_and(Interrupt::is_raised)
    }

    /// Seed of every random number.
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// Makes ready for sample `index` of `pixel`, and says where it lies relative to the pixel's top left corner.
    #[inline]
    pub fn begin(&mut self, pixel: [u32; 2], index: u32) -> Vec2 {
        self.begin_with(self.key, pixel, index)
    }

    /// As [`SampleContext::begin`] with the key of another seed.
    #[inline]
    pub(crate) fn begin_with(&mut self, seed: Key, pixel: [u32; 2], index: u32) -> Vec2 {
        self.index = index;
        self.draws = SampleStream::with_key(self.sampler, seed, pixel, index);
        self.draws.film_position()
    }
}

/// Rays of any kind between two questions whether to go on, if they are cast before other reasons to ask: a few
/// hundredths of a second.
pub(crate) const RAYS_PER_CHECK: u64 = 8192;

/// Lets a sample that takes long be given up.
pub(crate) struct Interrupt<'a> {
    wanted: &'a dyn Fn() -> bool,
    raised: Cell<bool>,
}

impl<'a> Interrupt<'a> {
    /// * `wanted`: whether to stop; asked now and then
    pub fn new(wanted: &'a dyn Fn() -> bool) -> Interrupt<'a> {
        Interrupt { wanted, raised: Cell::new(false) }
    }

    /// Asks whether to stop, and keeps the answer if it is yes.
    pub fn ask(&self) {
        if (self.wanted)() {
            self.raised.set(true);
        }
    }

    /// Whether an answer was yes.
    #[inline]
    pub fn is_raised(&self) -> bool {
        self.raised.get()
    }
}

impl fmt::Debug for Interrupt<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Interrupt").field("raised", &self.raised).finish_non_exhaustive()
    }
}

/// Values of a sample for layers that few films keep. An integrator fills in those that are asked for.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Auxiliary {
    /// Share of white light that the surface throws back, linear RGB; of the first surface, or of the first
    /// one that is no mirror.
    pub albedo: [f32; 3],
    /// Motion of the surface in the picture while the shutter is open, in pixels to the right and downwards.
    pub motion: [f32; 2],
    /// The share of each group of lights in the sample's radiance, linear RGB.
    pub lights: [[f32; 3]; MAX_LIGHT_GROUPS],
    /// The share of the sample's radiance that emitters send to the camera straight, or by way of smooth mirrors and glass alone, linear
    /// RGB. Noted for every integrator that follows paths, and kept in no layer.
    pub seen: [f32; 3],
    /// Rays of the sample that were given up in bodies that bend light: a whole number, those of paths from lights included. Counted where
    /// samples are taken, for every integrator.
    pub lost: f32,
    /// 1 where the sample looks at the dot that stands for a record of an irradiance cache, straight or by way of smooth mirrors and
    /// glass, and 0 elsewhere.
    pub record: f32,
}

/// Light for one position of the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Splat {
    /// Position in pixels from the picture's top left corner.
    pub raster: Vec2,
    /// Linear RGB.
    pub value: [f32; 3],
}

/// Light for any positions of the picture, collected until a unit of work is done.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Splats(Vec<Splat>);

impl Splats {
    /// Adds light at a position of the film; outside of the picture it is lost.
    ///
    /// * `raster`: in pixels from the top left corner
    /// * `value`: linear RGB, such that the mean over all samples of the sum of their splats is the mean
    ///   of the picture
    #[inline]
    pub fn add(&mut self, raster: Vec2, value: [f32; 3]) {
        self.0.push(Splat { raster, value });
    }

    /// What was added.
    pub fn as_slice(&self) -> &[Splat] {
        &self.0
    }

    /// Drops all but the first `n`.
    pub fn truncate(&mut self, n: usize) {
        self.0.truncate(n);
    }

    /// Drops everything, keeping the memory.
    pub fn clear(&mut self) {
        self.0.clear();
    }
}

/// Room for one value of any type, which an integrator keeps from sample to sample: arrays of vertices, caches.
///
/// Nothing in it may change the result of a sample, since which samples share a thread is left to chance.
#[derive(Debug, Default)]
pub struct Scratch(Option<Box<dyn Any>>);

impl Scratch {
    /// The value, made by `Default` when it is asked for the first time, or after one of another type.
    #[inline]
    pub fn get<T: Default + 'static>(&mut self) -> &mut T {
        if !self.0.as_ref().is_some_and(|value| value.is::<T>()) {
            self.0 = Some(Box::<T>::default());
        }
        match self.0.as_mut().and_then(|value| value.downcast_mut()) {
            Some(value) => value,
            None => unreachable!("a value of this type was put there just now"),
        }
    }
}

/// An empty list with the memory of another one, if their values have the same size: what borrows from a scene, or does not, may keep it so.
pub(crate) fn emptied<A, B>(mut list: Vec<A>) -> Vec<B> {
    list.clear();
    // Collecting in place reuses the memory.
    list.into_iter().map_while(|_| None).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo_core::sampler::SamplerKind;

    #[test]
    fn scratch_keeps_one_value() {
        let mut scratch = Scratch::default();
        scratch.get::<Vec<u32>>().push(7);
        assert_eq!(scratch.get::<Vec<u32>>(), &[7]);
        assert_eq!(*scratch.get::<u8>(), 0);
        assert!(scratch.get::<Vec<u32>>().is_empty(), "another type took the place");
    }

    #[test]
    fn an_emptied_list_has_the_memory_of_the_other() {
        let list: Vec<[u32; 2]> = Vec::with_capacity(40);
        let memory = list.as_ptr() as usize;
        let other: Vec<u64> = emptied(list);
        assert!(other.is_empty() && (other.capacity() == 0 || other.as_ptr() as usize == memory));
        let again: Vec<[i32; 2]> = emptied(vec![[1u32, 2], [3, 4]]);
        assert!(again.is_empty() && again.capacity() == 2);
    }

    #[test]
    fn a_context_moves_from_sample_to_sample() {
        let sampler = Sampler::new(SamplerKind::Uniform, 4);
        let mut ctx = SampleContext::new(&sampler, 3);
        let position = ctx.begin([5, 6], 2);
        let mut expected = SampleStream::new(&sampler, 3, [5, 6], 2);
        assert_eq!((ctx.index, position), (2, expected.film_position()));
        assert_eq!(ctx.draws.next_2d(), expected.next_2d());
    }
}
