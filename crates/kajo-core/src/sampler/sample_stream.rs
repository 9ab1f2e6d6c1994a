//! The numbers of one sample of one pixel, one dimension after the other.
//!
//! Positions in the pixel of the classic kinds: with `n` samples and `d = floor(sqrt n)` the pixel is cut into
//! `d x d` sub-pixels, row by row from the top; sample `k` belongs to sub-pixel `(k mod d, k / d)`.
//!
//! * uniform: anywhere in the pixel, whatever `k` is
//! * regular: in the middle of its sub-pixel, `((k mod d + ½)/d, (k / d + ½)/d)`
//! * jittered: anywhere in its sub-pixel
//!
//! When `n` is not a square all `n` samples are taken nevertheless, as the classic program does: the
//! rows from `d` on lie below the pixel. [`Sampler::overhangs`] says so.
//!
//! Behind the film the samples of a pixel are stratified in each dimension, or in each pair of them, by a random
//! permutation of their own: which place of one pair goes with which place of another is left to chance
//! [Cook, Porter and Carpenter 1984].

use kajo_math::permute::permute;
use kajo_math::rng::{Key, Stream, unit};
use kajo_math::{Vec2, sobol};

use super::{Sampler, SamplerKind, zorder};

/// Sets the random numbers of a pixel apart from those of its samples.
const PATTERN_SALT: u32 = 0xA076_1D64;

/// Sets the seeds of splits apart from pixels.
const SPLIT_SALT: u32 = 0x78BD_642F;

/// Sets the seeds of [`SampleStream::substream`] apart from those of splits.
const SUBSTREAM_SALT: u32 = 0x2545_F491;

/// Dimensions of a part of a path, see [`SampleStream::begin_part`].
const DIMENSIONS_OF_PART: u32 = 1024;

/// The largest number below 1.
const BELOW_ONE: f32 = 1.0 - f32::EPSILON / 2.0;

/// The numbers of one sample of one pixel. Copies hand out the same numbers again.
#[derive(Clone, Copy, Debug)]
pub struct SampleStream<'a> {
    sampler: &'a Sampler,
    seed: Key,
    pixel: [u32; 2],
    /// What the random numbers of the pixel are named by.
    key: Key,
    sample: u32,
    /// The number of the sample, its bits in reverse order.
    reversed: u32,
    /// Samples that share the pixel, at least 1.
    count: u32,
    dimension: u32,
    stream: Stream,
}

impl<'a> SampleStream<'a> {
    /// The numbers of sample `sample` of `pixel`, from the first dimension on.
    ///
    /// Samples beyond the number of the sampler are good ones too: another pattern begins.
    #[inline]
    pub fn new(sampler: &'a Sampler, seed: u64, pixel: [u32; 2], sample: u32) -> SampleStream<'a> {
        SampleStream::with_key(sampler, Key::new(seed), pixel, sample)
    }

    /// The same from the key of a seed, which all samples under it share.
    #[inline]
    pub fn with_key(sampler: &'a Sampler, seed: Key, pixel: [u32; 2], sample: u32) -> SampleStream<'a> {
        SampleStream::with_count(sampler, seed, pixel, sample, sampler.samples)
    }

    /// How many samples each pixel is given.
    #[inline]
    pub fn samples_of_pixel(&self) -> u32 {
        self.sampler.samples
    }

    #[inline]
    fn with_count(
        sampler: &'a Sampler,
        seed: Key,
        pixel: [u32; 2],
        sample: u32,
        count: u32,
    ) -> SampleStream<'a> {
        let key = seed.part(pixel);
        let stream = Stream::of_pixel(key, sample);
        let reversed = sample.reverse_bits();
        SampleStream {
            sampler,
            seed,
            pixel,
            key,
            sample,
            reversed,
            count: count.max(1),
            dimension: 0,
            stream,
        }
    }

    /// The place of the sample relative to the top left corner of its pixel, in pixels; to be asked for first.
    ///
    /// In [0, 1)², but for samples that overhang, whose `y` is below [`Sampler::height`].
    #[inline]
    pub fn film_position(&mut self) -> Vec2 {
        debug_assert_eq!(self.dimension, 0, "the first two dimensions are the film's");
        if !self.sampler.kind.is_classic() {
            return self.next_2d();
        }
        let d = self.take(2);
        let uniform = || Vec2::new(self.independent(d), self.independent(d + 1));
        match self.sampler.kind {
            SamplerKind::Regular => self.sampler.in_sub_pixel(self.sample, Vec2::splat(0.5)),
            SamplerKind::Jittered => self.sampler.in_sub_pixel(self.sample, uniform()),
            _ => uniform(),
        }
    }

    /// The next number, in [0, 1).
    #[inline]
    pub fn next_1d(&mut self) -> f32 {
        let d = self.take(1);
        match self.sampler.kind {
            SamplerKind::Uniform => self.independent(d),
            SamplerKind::Sobol | SamplerKind::ZSobol => {
                let (index, [seed, _]) = self.index_in_sequence(d);
                unit(sobol::scrambled_number(index, seed))
            }
            _ => self.stratum(d),
        }
    }

    /// The next two numbers, in [0, 1)².
    #[inline]
    pub fn next_2d(&mut self) -> Vec2 {
        let d = self.take(2);
        match self.sampler.kind {
            SamplerKind::Uniform => Vec2::new(self.independent(d), self.independent(d + 1)),
            SamplerKind::Regular | SamplerKind::Jittered => self.multi_jittered(d),
            SamplerKind::Sobol | SamplerKind::ZSobol => point(self.sobol(d)),
            // The sets are laid out for the samples of the pixel, not for what these split into.
            SamplerKind::Pmj | SamplerKind::Poisson if self.count > self.sampler.samples.max(1) => {
                point(self.sobol(d))
            }
            SamplerKind::Pmj => point(self.progressive(d)),
            SamplerKind::Poisson => point(self.disk(d)),
            SamplerKind::Cmj => self.correlated_multi_jittered(d),
        }
    }

    /// Skips dimensions that are not needed here; those after them stay what they are.
    #[inline]
    pub fn skip(&mut self, n: u32) {
        self.take(n);
    }

    /// The next number where it is needed, else 0; the dimension is taken either way.
    #[inline]
    pub fn number_if(&mut self, needed: bool) -> f32 {
        if needed {
            return self.next_1d();
        }
        self.skip(1);
        0.0
    }

    /// The next two numbers where they are needed, else zeros; the dimensions are taken either way.
    #[inline]
    pub fn pair_if(&mut self, needed: bool) -> Vec2 {
        if needed {
            return self.next_2d();
        }
        self.skip(2);
        Vec2::ZERO
    }

    /// The numbers of ray `i` of `n` into which a path splits, from a first dimension of their own on.
    ///
    /// The rays of all samples of the pixel are spread together. With `n` 1 the path goes on, and another is followed
    /// beside it.
    ///
    /// * `branch`: tells splits at the same dimension apart
    pub fn split(&self, branch: u32, i: u32, n: u32) -> SampleStream<'a> {
        let seed = self.seed.part([self.dimension, SPLIT_SALT]).part([branch, 0]);
        let sample = self.sample.wrapping_mul(n).wrapping_add(i);
        let count = self.count.saturating_mul(n);
        SampleStream::with_count(self.sampler.of_split(n), seed, self.pixel, sample, count)
    }

    /// Numbers of their own for what takes an unknown count of them, so that those that follow keep their dimensions; `None` where numbers
    /// are given, of which only the order is known.
    #[inline]
    pub fn substream(&self) -> Option<SampleStream<'a>> {
        self.sampler.beside.is_none().then(|| {
            let seed = self.seed.part([self.dimension, SUBSTREAM_SALT]);
            SampleStream::with_count(self.sampler, seed, self.pixel, self.sample, self.count)
        })
    }

    /// Goes on at the dimensions of part `part` of a path, so that it has the same in all samples of a pixel, whatever each took before.
    /// Dimensions that were taken are not taken again; where numbers are given, they stay in their order.
    #[inline]
    pub fn begin_part(&mut self, part: u32) {
        if self.sampler.beside.is_none() {
            self.dimension = self.dimension.max(part.saturating_mul(DIMENSIONS_OF_PART));
        }
    }

    /// Independent numbers by dimension, for callers that name their dimensions.
    pub fn stream(&self) -> &Stream {
        &self.stream
    }

    /// The number of a dimension that is given, or one independent of all others, for callers that name their dimensions.
    #[inline]
    pub fn independent(&self, d: u32) -> f32 {
        self.sampler.given.get(d as usize).copied().unwrap_or_else(|| self.stream.uniform(d))
    }

    #[inline]
    fn take(&mut self, n: u32) -> u32 {
        let first = self.dimension;
        self.dimension = first.wrapping_add(n);
        first
    }

    /// 96 random bits of a dimension that all samples of a pattern have in common.
    #[inline]
    fn pattern(&self, dimension: u32, pattern: u32) -> [u32; 3] {
        self.key.words([dimension, pattern ^ PATTERN_SALT])
    }

    /// One number in each of `n` strata, in random order.
    #[inline]
    fn stratum(&self, d: u32) -> f32 {
        let n = self.count;
        let [order, ..] = self.pattern(d, self.sample / n);
        let stratum = permute(self.sample % n, n, order);
        ((stratum as f32 + self.stream.uniform(d)) / n as f32).min(BELOW_ONE)
    }

    /// Multi-jitter of any number of samples [Chiu, Shirley and Wang 1994], [Kensler 2013].
    ///
    /// The square is a grid with one sample in each cell; besides, the samples lie in different columns of a
    /// finer grid, and in different rows. When the grid's last row is not full, chance says in which columns.
    #[inline]
    fn multi_jittered(&self, d: u32) -> Vec2 {
        let n = self.count;
        let columns = ((n as f32).sqrt() + 0.5) as u32;
        let rows = n.div_ceil(columns);
        let pattern = self.key.part([d, (self.sample / n) ^ PATTERN_SALT]);
        let [order, of_columns, _] = pattern.words([0, 0]);
        let order_in = |which: [u32; 2]| pattern.words(which)[0];
        let s = permute(self.sample % n, n, order);
        let (row, stratum) = (s / columns, s % columns);
        let column = permute(stratum, columns, of_columns);
        let in_column = permute(row, rows, order_in([column, 1]));
        let in_row = permute(stratum, columns.min(n - row * columns), order_in([row, 2]));
        let x = (in_column as f32 + self.stream.uniform(d)) / rows as f32;
        let y = ((row * columns + in_row) as f32 + self.stream.uniform(d + 1)) / n as f32;
        Vec2::new((column as f32 + x) / columns as f32, y).min(Vec2::splat(BELOW_ONE))
    }

    /// Correlated multi-jitter of any number of samples [Kensler 2013].
    ///
    /// As [`SampleStream::multi_jittered`], but all columns of the grid use one order of the rows, and all rows one order of the
    /// columns. So the points keep away from each other as those of a lattice do, which is worth most for smooth functions.
    #[inline]
    fn correlated_multi_jittered(&self, d: u32) -> Vec2 {
        let n = self.count;
        let columns = ((n as f32).sqrt() + 0.5) as u32;
        let rows = n.div_ceil(columns);
        let [order, of_columns, of_rows] = self.pattern(d, self.sample / n);
        let s = permute(self.sample % n, n, order);
        let (row, stratum) = (s / columns, s % columns);
        let column = permute(stratum, columns, of_columns);
        let in_column = permute(row, rows, of_rows);
        let x = (in_column as f32 + self.stream.uniform(d)) / rows as f32;
        let y = (s as f32 + self.stream.uniform(d + 1)) / n as f32;
        Vec2::new((column as f32 + x) / columns as f32, y).min(Vec2::splat(BELOW_ONE))
    }

    /// A scrambled point of the (0, 2)-sequence.
    #[inline]
    fn sobol(&self, d: u32) -> [u32; 2] {
        let (index, seeds) = self.index_in_sequence(d);
        sobol::scrambled_point(index, seeds)
    }

    /// Which point of the (0, 2)-sequence is this sample's, and random bits for scrambling it.
    #[inline]
    fn index_in_sequence(&self, d: u32) -> (u32, [u32; 2]) {
        if self.sampler.kind == SamplerKind::ZSobol {
            return zorder::index(self.seed, self.pixel, self.sample, self.count, d);
        }
        let [x, y, order] = self.pattern(d, 0);
        (sobol::shuffle_reversed(self.reversed, order), [x, y])
    }

    /// A point of the progressive set, with random digits flipped, which leaves each stratum its one point.
    ///
    /// In the pixel the points come in their own order, so that the first few samples are well spread already.
    #[inline]
    fn progressive(&self, d: u32) -> [u32; 2] {
        let (index, by) = self.index_in_set(d);
        let [x, y] = self.sampler.points[index];
        [x ^ by[0], y ^ by[1]]
    }

    /// A point of the Poisson-disk set, moved around the torus.
    #[inline]
    fn disk(&self, d: u32) -> [u32; 2] {
        let (index, by) = self.index_in_set(d);
        let [x, y] = self.sampler.points[index];
        [x.wrapping_add(by[0]), y.wrapping_add(by[1])]
    }

    /// Which point of the shared set is this sample's, and random bits for moving the set.
    #[inline]
    fn index_in_set(&self, d: u32) -> (usize, [u32; 2]) {
        let n = self.sampler.points.len().max(1) as u32;
        let [x, y, order] = self.pattern(d, self.sample / n);
        let own = self.sample % n;
        let index = if d == 0 { own } else { permute(own, n, order) };
        (index as usize, [x, y])
    }
}

#[inline]
fn point(bits: [u32; 2]) -> Vec2 {
    Vec2::from_array(bits.map(unit))
}
