//! How far a picture still is from its limit, by the spread of its samples.
//!
//! The picture is cut into blocks of 32 × 32 pixels. With `V` the mean over the pixels of a block, and over
//! red, green and blue, of the estimated variance of the pixel's value, and `M` the mean of the values, the
//! noise of the block and of the picture are
//!
//! ```text
//! e_b² = V / (M² + ε²)        e = sqrt(mean of e_b² over blocks, weighted by pixels)
//! ```
//!
//! where `ε` is a tenth of the mean of the picture, so that dark blocks need not be better than one can
//! see. It is a relative error, free of the picture's scale. The variance of independent samples is assumed;
//! stratified ones do better than it says. Where light comes by splats, `V` is the sum of the variances of both.

use super::{
    Camera, Film, Layer,
    splats::{Areas, SplatSpread},
    sums::Spread,
};

/// Share of the picture's mean that is added to the mean of a block.
const EPSILON: f64 = 0.1;

impl Film {
    /// The estimated relative error of the colours; see [`noise`](self).
    ///
    /// `None` when the film does not keep [`Layer::Variance`], or no pixel has two samples yet.
    pub fn noise(&self) -> Option<f64> {
        if !self.spec.layers.has(Layer::Variance) || !self.spec.keeps_sums() {
            return None;
        }
        let halves = self.spec.parts().halves;
        let splats = self.splat_spreads();
        // Light that came by splats is part of what the error is relative to.
        let with_splats = |half: usize| -> Vec<Spread> {
            let add =
                |(block, splats): (Spread, &SplatSpread)| Spread { mean: block.mean + splats.mean, ..block };
            self.spreads(half).into_iter().zip(&splats).map(add).collect()
        };
        let each: Vec<Vec<Spread>> = (0..halves).map(with_splats).collect();
        let errors = each.iter().map(|blocks| relative_error(blocks, |_, block| block.variance_of_mean));
        let of_splats = relative_error(&each[0], |i, _| splats[i].variance)?;
        // The mean of two halves has a quarter of the sum of their variances. Splats belong to both.
        let sum: f64 = errors.map(|error| error.map(|e| e * e)).sum::<Option<f64>>()?;
        Some((sum / (halves * halves) as f64 + of_splats * of_splats).sqrt())
    }

    /// How splats spread in each block, row by row.
    fn splat_spreads(&self) -> Vec<SplatSpread> {
        let samples_per_pixel = self.samples_per_pixel();
        let (mut areas, mut spreads) = (None, Vec::new());
        self.for_each_block(|_, block| {
            spreads.push(block.splats.as_ref().map_or_else(SplatSpread::default, |splats| {
                splats.spread(areas.get_or_insert_with(|| Areas::new(&self.spec)), samples_per_pixel)
            }));
        });
        spreads
    }

    /// The spread of the camera's samples of one half, or of all, in each block, row by row.
    pub(crate) fn spreads(&self, half: usize) -> Vec<Spread> {
        let mut spreads = Vec::new();
        self.for_each_block(|_, block| {
            spreads.push(match &block.camera {
                Camera::Open(sums) => sums.spread(half),
                Camera::Empty | Camera::Finished(_) => Spread::default(),
            });
        });
        spreads
    }
}

/// The noise of a picture of blocks; `None` where nothing is known of it.
///
/// * `variance_of_mean`: of the pixels of a block
pub(crate) fn relative_error(
    blocks: &[Spread],
    variance_of_mean: impl Fn(usize, &Spread) -> f64,
) -> Option<f64> {
    let epsilon = epsilon(blocks)?;
    let pixels: f64 = blocks.iter().map(|block| block.pixels).sum();
    let error = |(i, block): (usize, &Spread)| {
        let error = variance_of_mean(i, block) / scale_squared(block, epsilon);
        if error.is_finite() { error * block.pixels } else { 0.0 }
    };
    Some((blocks.iter().enumerate().map(error).sum::<f64>() / pixels).sqrt())
}

/// What the variance of a block is compared with.
pub(crate) fn scale_squared(block: &Spread, epsilon: f64) -> f64 {
    block.mean * block.mean + epsilon * epsilon
}

/// A tenth of the mean of a picture; `None` where nothing is known of it.
pub(crate) fn epsilon(blocks: &[Spread]) -> Option<f64> {
    let pixels: f64 = blocks.iter().map(|block| block.pixels).sum();
    let mean = blocks.iter().map(|block| block.mean * block.pixels).sum::<f64>() / pixels;
    (pixels > 0.0).then_some(EPSILON * mean)
}
