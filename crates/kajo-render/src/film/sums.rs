//! Exact sums over a rectangle of pixels.
//!
//! Every number here is an integer and every rule of combination (adding, taking the smaller index) is
//! commutative and associative, so it does not matter in which order samples and rectangles come
//! together.

use std::{
    io::{self, Read},
    ops::Range,
};

use super::{
    fixed::{self, Term, Weight},
    layer::Layer,
    numbers::{restore_array, restore_numbers, save_numbers},
    spec::{FilmSpec, Parts},
};
use crate::{PixelSample, rect::Rect};

/// Object and material seen by the sample of smallest index.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct First {
    sample: u32,
    object: u32,
    material: u32,
}

impl First {
    /// No sample yet. No sample has this index, since their number is a `u32`.
    const NONE: First = First { sample: u32::MAX, object: 0, material: 0 };

    #[inline]
    fn keep_earlier(&mut self, other: First) {
        if other.sample < self.sample {
            *self = other;
        }
    }
}

/// Sums of the colours of a pixel's own samples and of their squares.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Moments {
    values: [i128; 3],
    squares: [i128; 3],
}

impl Moments {
    #[inline]
    fn add(&mut self, radiance: [f32; 3]) {
        for (c, value) in radiance.into_iter().enumerate() {
            let term = Term::new(value).unwrap_or(Term::ZERO);
            self.values[c] += term.times(Weight::ONE);
            self.squares[c] += term.squared();
        }
    }

    fn absorb(&mut self, other: Moments) {
        for c in 0..3 {
            self.values[c] += other.values[c];
            self.squares[c] += other.squares[c];
        }
    }

    /// Estimated variance of the mean of `n` samples in channel `c`; 0 when `n` is less than 2.
    fn variance_of_mean(&self, c: usize, n: u32) -> f64 {
        if n < 2 {
            return 0.0;
        }
        let n = f64::from(n);
        let (mean, mean_square) = (fixed::mean(self.values[c], n), fixed::mean(self.squares[c], n));
        // Rounding can make a difference of equals negative.
        ((mean_square - mean * mean) / (n - 1.0)).max(0.0)
    }
}

/// The sums of a rectangle of pixels; arrays that the film does not need are empty.
///
/// A pixel has one slot in each array, or two where halves are kept apart: see [`Sums::slot`].
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Sums {
    pub rect: Rect,
    parts: Parts,
    /// Weighted values, `parts.channels` for each slot.
    values: Vec<i128>,
    /// Bits of [`Weight`]s.
    weights: Vec<i64>,
    counts: Vec<u32>,
    distances: Vec<i128>,
    hits: Vec<u32>,
    firsts: Vec<First>,
    moments: Vec<Moments>,
}

impl Sums {
    /// Nothing, over no pixels.
    pub fn empty(spec: &FilmSpec) -> Sums {
        Sums {
            rect: Rect::of_size(0, 0),
            parts: spec.parts(),
            values: Vec::new(),
            weights: Vec::new(),
            counts: Vec::new(),
            distances: Vec::new(),
            hits: Vec::new(),
            firsts: Vec::new(),
            moments: Vec::new(),
        }
    }

    /// Starts afresh with the pixels of `rect`, keeping the memory.
    pub fn reset(&mut self, rect: Rect) {
        fn refill<T: Clone>(array: &mut Vec<T>, len: usize, value: T) {
            array.clear();
            array.resize(len, value);
        }
        let parts = self.parts;
        let slots = rect.area() as usize * parts.halves;
        let len = |wanted: bool| if wanted { slots } else { 0 };
        self.rect = rect;
        refill(&mut self.values, slots * parts.channels, 0);
        refill(&mut self.weights, len(parts.weights), 0);
        refill(&mut self.counts, len(parts.counts), 0);
        refill(&mut self.distances, len(parts.distances), 0);
        refill(&mut self.hits, len(parts.distances), 0);
        refill(&mut self.firsts, len(parts.firsts), First::NONE);
        refill(&mut self.moments, len(parts.moments), Moments::default());
    }

    /// Where sample `k` finds a pixel's sums.
    #[inline]
    pub fn slot(&self, x: u32, y: u32, k: u32) -> usize {
        self.rect.index(x, y) * self.parts.halves + k as usize % self.parts.halves
    }

    /// From a pixel's slot to the next pixel's.
    #[inline]
    pub fn stride(&self) -> usize {
        self.parts.halves
    }

    /// Adds the filtered channels of a sample to a pixel's slot.
    #[inline]
    pub fn add_filtered(&mut self, slot: usize, weight: Weight, terms: &[Term]) {
        let start = slot * self.parts.channels;
        for (sum, term) in self.values[start..start + terms.len()].iter_mut().zip(terms) {
            *sum += term.times(weight);
        }
        self.weights[slot] += weight.bits();
    }

    /// Adds the filtered channels of a sample with weight 1, which the count stands for, to a pixel's slot.
    ///
    /// Returns whether all of them were finite.
    #[inline]
    pub fn add_plain(&mut self, slot: usize, values: &[f32]) -> bool {
        let start = slot * self.parts.channels;
        let mut finite = true;
        for (sum, &value) in self.values[start..start + values.len()].iter_mut().zip(values) {
            match Term::new(value) {
                Some(term) => *sum += term.times(Weight::ONE),
                None => finite = false,
            }
        }
        finite
    }

    /// Records what concerns only the pixel that sample `k` was taken for.
    ///
    /// Returns whether all of it was finite.
    #[inline]
    pub fn add_own(&mut self, slot: usize, k: u32, sample: &PixelSample) -> bool {
        let hit = sample.first.as_ref();
        if self.parts.counts {
            self.counts[slot] += 1;
        }
        if self.parts.moments {
            self.moments[slot].add(sample.radiance);
        }
        if self.parts.firsts {
            let (object, material) = hit.map_or((0, 0), |hit| (hit.object, hit.material));
            self.firsts[slot].keep_earlier(First { sample: k, object, material });
        }
        let Some(hit) = hit.filter(|_| self.parts.distances) else { return true };
        let Some(distance) = Term::new(hit.t) else { return false };
        self.distances[slot] += distance.times(Weight::ONE);
        self.hits[slot] += 1;
        true
    }

    /// Adds the sums of the pixels that both rectangles have.
    pub fn absorb(&mut self, other: &Sums) {
        let common = self.rect.intersection(&other.rect);
        if common.area() == 0 {
            return;
        }
        let channels = self.parts.channels;
        let len = common.width() as usize * self.parts.halves;
        for y in common.y0..common.y1 {
            let (to, from) = (self.slot(common.x0, y, 0), other.slot(common.x0, y, 0));
            let (to_values, from_values) = (to * channels, from * channels);
            combine(&mut self.values, to_values, &other.values, from_values, len * channels, |a, b| *a += b);
            combine(&mut self.weights, to, &other.weights, from, len, |a, b| *a += b);
            combine(&mut self.counts, to, &other.counts, from, len, |a, b| *a += b);
            combine(&mut self.distances, to, &other.distances, from, len, |a, b| *a += b);
            combine(&mut self.hits, to, &other.hits, from, len, |a, b| *a += b);
            combine(&mut self.firsts, to, &other.firsts, from, len, First::keep_earlier);
            combine(&mut self.moments, to, &other.moments, from, len, Moments::absorb);
        }
    }

    /// Develops a row of a layer: the values of pixels from index `first` on, as many as `out` has room for.
    pub fn row(&self, spec: &FilmSpec, layer: Layer, first: usize, out: &mut [f32]) {
        let n = layer.channels();
        let offset: usize = spec.layers.filtered().take_while(|&l| l != layer).map(Layer::channels).sum();
        for (pixel, out) in (first..).zip(out.chunks_exact_mut(n)) {
            match layer {
                Layer::Depth => out[0] = self.depth(pixel),
                Layer::ObjectId | Layer::MaterialId => out[0] = self.id(layer, pixel) as f32,
                Layer::SampleCount => {
                    out[0] = self.slots(pixel).map(|slot| self.counts[slot]).sum::<u32>() as f32
                }
                Layer::Variance => self.variance(pixel, out),
                _ => self.mean(pixel, offset, out),
            }
        }
    }

    /// Number of the object or material of a pixel's first sample; 0 without samples.
    pub fn id(&self, layer: Layer, pixel: usize) -> u32 {
        let mut first = First::NONE;
        self.slots(pixel).for_each(|slot| first.keep_earlier(self.firsts[slot]));
        if layer == Layer::ObjectId { first.object } else { first.material }
    }

    fn slots(&self, pixel: usize) -> Range<usize> {
        pixel * self.parts.halves..(pixel + 1) * self.parts.halves
    }

    /// Averages of a filtered layer whose channels start at `offset`: of two halves the mean of both, or of the
    /// only one that samples reached.
    fn mean(&self, pixel: usize, offset: usize, out: &mut [f32]) {
        let n = out.len();
        let channels = |slot: usize| &self.values[slot * self.parts.channels + offset..][..n];
        let Range { start: even, end } = self.slots(pixel);
        let (odd, weight) = (end - 1, self.weight(even));
        let odd_weight = if odd == even { 0.0 } else { self.weight(odd) };
        if odd_weight == 0.0 {
            for (out, &sum) in out.iter_mut().zip(channels(even)) {
                *out = fixed::average(sum, weight);
            }
        } else if weight == 0.0 {
            for (out, &sum) in out.iter_mut().zip(channels(odd)) {
                *out = fixed::average(sum, odd_weight);
            }
        } else {
            for ((out, &a), &b) in out.iter_mut().zip(channels(even)).zip(channels(odd)) {
                *out = (0.5 * (fixed::mean(a, weight) + fixed::mean(b, odd_weight))) as f32;
            }
        }
    }

    fn depth(&self, pixel: usize) -> f32 {
        let hits: u32 = self.slots(pixel).map(|slot| self.hits[slot]).sum();
        let distance = self.slots(pixel).map(|slot| self.distances[slot]).sum();
        if hits == 0 { f32::INFINITY } else { fixed::average(distance, f64::from(hits)) }
    }

    /// The variance of the mean is that of one half, or a quarter of the sum of both.
    fn variance(&self, pixel: usize, out: &mut [f32]) {
        let halves = self.parts.halves as f64;
        for (c, out) in out.iter_mut().enumerate() {
            let of_slot = |slot: usize| self.moments[slot].variance_of_mean(c, self.counts[slot]);
            *out = (self.slots(pixel).map(of_slot).sum::<f64>() / (halves * halves)) as f32;
        }
    }

    /// Sum of the weights of the samples that reached a slot.
    fn weight(&self, slot: usize) -> f64 {
        if self.parts.weights { fixed::weight_sum(self.weights[slot]) } else { f64::from(self.counts[slot]) }
    }

    /// Writes all arrays.
    pub fn save(&self, out: &mut Vec<u8>) {
        save_numbers(self.values.iter().copied(), out);
        save_numbers(self.weights.iter().map(|&n| n.into()), out);
        save_numbers(self.counts.iter().map(|&n| n.into()), out);
        save_numbers(self.distances.iter().copied(), out);
        save_numbers(self.hits.iter().map(|&n| n.into()), out);
        let firsts = self.firsts.iter().flat_map(|first| [first.sample, first.object, first.material]);
        save_numbers(firsts.map(i128::from), out);
        save_numbers(self.moments.iter().flat_map(|moments| moments.values), out);
        save_numbers(self.moments.iter().flat_map(|moments| moments.squares), out);
    }

    /// Reads what [`Sums::save`] wrote into arrays of the same lengths.
    pub fn restore(&mut self, input: &mut dyn Read) -> io::Result<()> {
        restore_array(&mut self.values, input)?;
        restore_array(&mut self.weights, input)?;
        restore_array(&mut self.counts, input)?;
        restore_array(&mut self.distances, input)?;
        restore_array(&mut self.hits, input)?;
        let mut firsts = vec![0; 3 * self.firsts.len()];
        restore_array(&mut firsts, input)?;
        for (first, numbers) in self.firsts.iter_mut().zip(firsts.chunks_exact(3)) {
            *first = First { sample: numbers[0], object: numbers[1], material: numbers[2] };
        }
        let count = 3 * self.moments.len();
        restore_numbers(count, input, |i, number| {
            self.moments[i / 3].values[i % 3] = number;
            Ok(())
        })?;
        restore_numbers(count, input, |i, number| {
            self.moments[i / 3].squares[i % 3] = number;
            Ok(())
        })
    }

    /// Mean and variance over the pixels of one half; see [`Spread`].
    pub fn spread(&self, half: usize) -> Spread {
        let mut spread = Spread::default();
        let slots = (half..self.counts.len()).step_by(self.parts.halves);
        for slot in slots.filter(|&slot| self.counts[slot] >= 2) {
            let n = self.counts[slot];
            for c in 0..3 {
                spread.mean += fixed::mean(self.moments[slot].values[c], f64::from(n)) / 3.0;
                spread.variance += self.moments[slot].variance_of_mean(c, n) * f64::from(n) / 3.0;
                spread.variance_of_mean += self.moments[slot].variance_of_mean(c, n) / 3.0;
            }
            spread.pixels += 1.0;
        }
        let pixels = spread.pixels.max(1.0);
        spread.mean /= pixels;
        spread.variance /= pixels;
        spread.variance_of_mean /= pixels;
        spread
    }
}

/// How samples are spread in a region: averages over its pixels and the three channels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Spread {
    /// Pixels with at least two samples; the others have no estimate of variance.
    pub pixels: f64,
    /// Mean of the samples.
    pub mean: f64,
    /// Variance of a single sample.
    pub variance: f64,
    /// Variance of a pixel's mean.
    pub variance_of_mean: f64,
}

/// Combines a run of one array into another of the same kind; empty arrays are left alone.
fn combine<T: Copy>(to: &mut [T], at: usize, from: &[T], start: usize, len: usize, rule: impl Fn(&mut T, T)) {
    if !from.is_empty() {
        for (a, &b) in to[at..at + len].iter_mut().zip(&from[start..start + len]) {
            rule(a, b);
        }
    }
}
