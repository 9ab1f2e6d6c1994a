//! Exact sums over a rectangle of pixels.
//!
//! Every number here is an integer and every rule of combination (adding, taking the smaller index) is
//! commutative and associative, so it does not matter in which order samples and rectangles come
//! together.

use super::{
    fixed::{self, Term, Weight},
    layer::Layer,
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
    fn variance_of_mean(&self, c: usize, n: u32) -> f32 {
        if n < 2 {
            return 0.0;
        }
        let n = f64::from(n);
        let (mean, mean_square) = (fixed::mean(self.values[c], n), fixed::mean(self.squares[c], n));
        // Rounding can make a difference of equals negative.
        ((mean_square - mean * mean) / (n - 1.0)).max(0.0) as f32
    }
}

/// The sums of a rectangle of pixels; arrays that the film does not need are empty.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Sums {
    pub rect: Rect,
    parts: Parts,
    /// Weighted values, `parts.channels` for each pixel.
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
        let pixels = rect.area() as usize;
        let len = |wanted: bool| if wanted { pixels } else { 0 };
        self.rect = rect;
        refill(&mut self.values, pixels * parts.channels, 0);
        refill(&mut self.weights, len(parts.weights), 0);
        refill(&mut self.counts, len(parts.counts), 0);
        refill(&mut self.distances, len(parts.distances), 0);
        refill(&mut self.hits, len(parts.distances), 0);
        refill(&mut self.firsts, len(parts.firsts), First::NONE);
        refill(&mut self.moments, len(parts.moments), Moments::default());
    }

    /// Adds the filtered channels of a sample to a pixel.
    #[inline]
    pub fn add_filtered(&mut self, pixel: usize, weight: Weight, terms: &[Term]) {
        let start = pixel * self.parts.channels;
        for (sum, term) in self.values[start..start + terms.len()].iter_mut().zip(terms) {
            *sum += term.times(weight);
        }
        self.weights[pixel] += weight.bits();
    }

    /// Adds the filtered channels of a sample with weight 1, which the count stands for, to a pixel.
    ///
    /// Returns whether all of them were finite.
    #[inline]
    pub fn add_plain(&mut self, pixel: usize, values: &[f32]) -> bool {
        let start = pixel * self.parts.channels;
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
    pub fn add_own(&mut self, pixel: usize, k: u32, sample: &PixelSample) -> bool {
        let hit = sample.first.as_ref();
        if self.parts.counts {
            self.counts[pixel] += 1;
        }
        if self.parts.moments {
            self.moments[pixel].add(sample.radiance);
        }
        if self.parts.firsts {
            let (object, material) = hit.map_or((0, 0), |hit| (hit.object, hit.material));
            self.firsts[pixel].keep_earlier(First { sample: k, object, material });
        }
        let Some(hit) = hit.filter(|_| self.parts.distances) else { return true };
        let Some(distance) = Term::new(hit.t) else { return false };
        self.distances[pixel] += distance.times(Weight::ONE);
        self.hits[pixel] += 1;
        true
    }

    /// Adds the sums of the pixels that both rectangles have.
    pub fn absorb(&mut self, other: &Sums) {
        let common = self.rect.intersection(&other.rect);
        let (channels, width) = (self.parts.channels, common.width() as usize);
        if width == 0 {
            return;
        }
        for y in common.y0..common.y1 {
            let (to, from) = (self.rect.index(common.x0, y), other.rect.index(common.x0, y));
            combine(
                &mut self.values,
                to * channels,
                &other.values,
                from * channels,
                width * channels,
                |a, b| *a += b,
            );
            combine(&mut self.weights, to, &other.weights, from, width, |a, b| *a += b);
            combine(&mut self.counts, to, &other.counts, from, width, |a, b| *a += b);
            combine(&mut self.distances, to, &other.distances, from, width, |a, b| *a += b);
            combine(&mut self.hits, to, &other.hits, from, width, |a, b| *a += b);
            combine(&mut self.firsts, to, &other.firsts, from, width, First::keep_earlier);
            combine(&mut self.moments, to, &other.moments, from, width, Moments::absorb);
        }
    }

    /// Develops a row of a layer: the values of pixels from index `first` on, as many as `out` has room for.
    pub fn row(&self, spec: &FilmSpec, layer: Layer, first: usize, out: &mut [f32]) {
        let n = layer.channels();
        let offset: usize = spec.layers.filtered().take_while(|&l| l != layer).map(Layer::channels).sum();
        for (pixel, out) in (first..).zip(out.chunks_exact_mut(n)) {
            match layer {
                Layer::Depth if self.hits[pixel] == 0 => out[0] = f32::INFINITY,
                Layer::Depth => out[0] = fixed::average(self.distances[pixel], f64::from(self.hits[pixel])),
                Layer::ObjectId | Layer::MaterialId => out[0] = self.id(layer, pixel) as f32,
                Layer::SampleCount => out[0] = self.counts[pixel] as f32,
                Layer::Variance => {
                    for (c, out) in out.iter_mut().enumerate() {
                        *out = self.moments[pixel].variance_of_mean(c, self.counts[pixel]);
                    }
                }
                _ => {
                    let weight = self.weight(pixel);
                    let sums = &self.values[pixel * self.parts.channels + offset..][..n];
                    for (out, &sum) in out.iter_mut().zip(sums) {
                        *out = fixed::average(sum, weight);
                    }
                }
            }
        }
    }

    /// Number of the object or material of a pixel's first sample; 0 without samples.
    pub fn id(&self, layer: Layer, pixel: usize) -> u32 {
        let first = self.firsts[pixel];
        if layer == Layer::ObjectId { first.object } else { first.material }
    }

    /// Sum of the weights of the samples that reached a pixel.
    fn weight(&self, pixel: usize) -> f64 {
        if self.parts.weights {
            fixed::weight_sum(self.weights[pixel])
        } else {
            f64::from(self.counts[pixel])
        }
    }
}

/// Combines a run of one array into another of the same kind; empty arrays are left alone.
fn combine<T: Copy>(to: &mut [T], at: usize, from: &[T], start: usize, len: usize, rule: impl Fn(&mut T, T)) {
    if !from.is_empty() {
        for (a, &b) in to[at..at + len].iter_mut().zip(&from[start..start + len]) {
            rule(a, b);
        }
    }
}
