//! Numbers by a number: curves and thresholds.
//!
//! Where a number varies within a [footprint](super::FilteredNumber), a curve answers with its mean over these numbers,
//! and says by its mean square how much it varies itself.

use std::sync::Arc;

use super::filtered::{HeldBox, NARROW};
use super::integral::Integral;
use super::{
    FilteredNumber, FloatNode, FloatTexture, Knots, TextureContext, TextureDetail, TextureSlope, Textures,
};

/// A curve with its integrals.
#[derive(Clone, Debug)]
pub struct CurveNumbers {
    knots: Knots<1>,
    /// Of the number and of its square.
    moments: Integral<2>,
}

impl CurveNumbers {
    /// The numbers of a curve.
    pub fn new(knots: Knots<1>) -> CurveNumbers {
        let moments = Integral::new(knots.breakpoints(1), |t| with_square(knots.at(t)));
        CurveNumbers { knots, moments }
    }

    /// What it makes of the numbers of a footprint: their mean and variance.
    fn moments(&self, numbers: &HeldBox) -> [f32; 2] {
        let f = |t| with_square(self.knots.at(t));
        let [mean, square] =
            numbers.mean_of(f, |lo, hi| self.moments.over(lo, hi, f).map(|sum| sum / (hi - lo)));
        [mean, (square - mean * mean).max(0.0)]
    }

    /// How its mean over the numbers of a footprint changes with them.
    fn mean_slope(&self, numbers: &HeldBox) -> f32 {
        let [lo, hi] = numbers.bounds;
        let inside = 1.0 - numbers.ends[0] - numbers.ends[1];
        if hi - lo < NARROW {
            return self.knots.slope((0.5 * (lo + hi)) as f32)[0];
        }
        let rise = self.knots.at(hi as f32)[0] - self.knots.at(lo as f32)[0];
        rise * (inside / (hi - lo)) as f32
    }
}

fn with_square([v]: [f32; 1]) -> [f32; 2] {
    [v, v * v]
}

/// Numbers by a number.
#[derive(Clone, Debug)]
pub struct Curve {
    /// The number.
    pub texture: FloatTexture,
    /// The curve, with numbers in [0, 1].
    pub curve: Arc<CurveNumbers>,
}

impl FloatNode for Curve {
    fn is_finite(&self) -> bool {
        true
    }

    fn part(&self) -> Option<FloatTexture> {
        Some(self.texture)
    }

    fn value(&self, textures: &Textures, at: &TextureContext) -> f32 {
        self.filtered(textures, at).mean
    }

    fn filtered(&self, textures: &Textures, at: &TextureContext) -> FilteredNumber {
        let number = self.texture.filtered(textures.evaluator(at));
        if !number.varies() {
            return FilteredNumber::point(self.curve.knots.at(number.mean)[0]);
        }
        let numbers = number.numbers();
        let [mean, variance] = self.curve.moments(&numbers);
        let even = FilteredNumber { lost: 0.0, ..number.mapped(mean, self.curve.mean_slope(&numbers)) };
        FilteredNumber { lost: (variance - even.variance()).max(0.0), ..even }
    }

    fn slope(&self, textures: &Textures, at: &TextureContext, factor: f32) -> TextureSlope {
        let evaluator = textures.evaluator(at);
        let number = self.texture.filtered(evaluator);
        let slope = match number.varies() {
            true => self.curve.mean_slope(&number.numbers()),
            false => self.curve.knots.slope(number.mean)[0],
        };
        self.texture.slope(evaluator, factor * slope)
    }

    fn detail(&self, textures: &Textures, found: &mut TextureDetail) {
        self.texture.detail(textures, found);
        found.jumps = true;
    }

    fn mean(&self, _textures: &Textures) -> f32 {
        self.curve.knots.mean()[0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::texture::Interpolation;

    fn curve(interpolation: Interpolation) -> CurveNumbers {
        let knots = vec![(0.2, [0.1]), (0.5, [1.0]), (0.5, [0.0]), (0.8, [0.6])];
        CurveNumbers::new(Knots::new(knots, interpolation).unwrap())
    }

    #[test]
    fn curves_have_the_moments_of_many_points() {
        for interpolation in [Interpolation::Linear, Interpolation::Smooth, Interpolation::Step] {
            let curve = curve(interpolation);
            for (mean, variance) in [(0.5, 1.0 / 12.0), (0.5, 1e-3), (0.3, 1e-3), (0.7, 0.004), (0.2, 0.1)] {
                const PLACES: u32 = 100_000;
                let numbers = HeldBox::new(mean, variance);
                let ([zero, one], [lo, hi]) = (numbers.ends, numbers.bounds);
                let at = |t: f64| f64::from(curve.knots.at(t as f32)[0]);
                let moment = |power: i32| {
                    let between = |i: u32| at(lo + (hi - lo) * (f64::from(i) + 0.5) / f64::from(PLACES));
                    let sum: f64 = (0..PLACES).map(|i| between(i).powi(power)).sum();
                    let inside = (1.0 - zero - one) / f64::from(PLACES);
                    zero * at(0.0).powi(power) + one * at(1.0).powi(power) + inside * sum
                };
                let [found, spread] = curve.moments(&numbers).map(f64::from);
                assert!((found - moment(1)).abs() < 1e-4, "{interpolation:?} {mean} {variance}: {found}");
                let expected = moment(2) - moment(1) * moment(1);
                assert!((spread - expected).abs() < 1e-4, "{interpolation:?} {mean} {variance}: {spread}");
            }
        }
    }

    #[test]
    fn slopes_are_those_of_the_mean() {
        let curve = curve(Interpolation::Linear);
        let mean = |m: f32| curve.moments(&HeldBox::new(m, 1e-3))[0];
        for m in [0.3, 0.45, 0.5, 0.56, 0.7] {
            let difference = (mean(m + 1e-3) - mean(m - 1e-3)) / 2e-3;
            let slope = curve.mean_slope(&HeldBox::new(m, 1e-3));
            assert!((difference - slope).abs() < 0.05 * slope.abs().max(1.0), "{m}: {slope} {difference}");
        }
    }
}
