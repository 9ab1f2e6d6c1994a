//! Where in a pixel its samples lie.
//!
//! With `n` samples and `d = floor(sqrt n)` the pixel is cut into `d × d` sub-pixels, row by row from
//! the top; sample `k` belongs to sub-pixel `(k mod d, k / d)`.
//!
//! * uniform: anywhere in the pixel, whatever `k` is
//! * regular: in the middle of its sub-pixel, `((k mod d + ½)/d, (k / d + ½)/d)`
//! * jittered: anywhere in its sub-pixel
//!
//! When `n` is not a square all `n` samples are taken nevertheless, as the classic program does: the
//! rows from `d` on lie below the pixel. [`Sampler::overhangs`] says so.
//!
//! Dimensions 0 and 1 of a sample's [`Stream`] are the sampler's, used or not; everything else draws
//! from [`FIRST_FREE_DIMENSION`] on.
//!
//! Scene: `Settings { samples jittered 16 }`

use kajo_math::{Vec2, rng::Stream};

/// The first dimension of a sample's stream that the sampler leaves to others.
pub const FIRST_FREE_DIMENSION: u32 = 2;

/// The rule by which samples are spread over a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SamplerKind {
    /// Independent uniform positions.
    Uniform,
    /// The middles of sub-pixels; no randomness.
    Regular,
    /// One uniform position in each sub-pixel.
    Jittered,
}

/// A rule and a number of samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sampler {
    kind: SamplerKind,
    samples: u32,
    /// Sub-pixels on a side, at least 1.
    side: u32,
}

impl Sampler {
    /// `samples` may be 0: a picture without samples is black.
    pub fn new(kind: SamplerKind, samples: u32) -> Sampler {
        Sampler { kind, samples, side: samples.isqrt().max(1) }
    }

    /// The rule.
    pub fn kind(&self) -> SamplerKind {
        self.kind
    }

    /// Samples per pixel.
    pub fn samples(&self) -> u32 {
        self.samples
    }

    /// Position of sample `k` relative to the top left corner of its pixel, in pixels.
    ///
    /// In [0, 1)², but for samples that overhang, whose `y` is below [`Sampler::height`].
    #[inline]
    pub fn position(&self, k: u32, stream: &Stream) -> Vec2 {
        match self.kind {
            SamplerKind::Uniform => Vec2::new(stream.uniform(0), stream.uniform(1)),
            SamplerKind::Regular => self.in_sub_pixel(k, Vec2::splat(0.5)),
            SamplerKind::Jittered => self.in_sub_pixel(k, Vec2::new(stream.uniform(0), stream.uniform(1))),
        }
    }

    /// Whether some samples lie below the pixel they count for, because their number is no square.
    pub fn overhangs(&self) -> bool {
        self.kind != SamplerKind::Uniform && self.samples > self.side * self.side
    }

    /// Height of the region the samples are spread over, in pixels: 1, or more when they overhang.
    pub fn height(&self) -> f32 {
        if self.overhangs() { self.samples.div_ceil(self.side) as f32 / self.side as f32 } else { 1.0 }
    }

    /// The point `u` of [0, 1)² carried into the sub-pixel of sample `k`.
    #[inline]
    fn in_sub_pixel(&self, k: u32, u: Vec2) -> Vec2 {
        let place = |cell: u32, u: f32| {
            let p = (cell as f32 + u) / self.side as f32;
            let end = (cell + 1) as f32 / self.side as f32;
            // The sum may round up to the next sub-pixel, which does not belong to this one.
            if p < end { p } else { end.next_down() }
        };
        Vec2::new(place(k % self.side, u.x), place(k / self.side, u.y))
    }
}

#[cfg(test)]
mod tests;
