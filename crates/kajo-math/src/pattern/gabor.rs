//! Gabor noise: kernels of one frequency strewn over space [Lagae et al. 2009].
//!
//! ```text
//! n(q) = sum w_i g(q - q_i),        g(d) = exp(-pi a^2 |d|^2) cos(2 pi F (omega . d) + phi_i)
//! ```
//!
//! The places `q_i` are a Poisson process, the weights are uniform in [-1, 1], and the direction `omega` is one for all, or drawn for each
//! kernel, where the noise is the same in all directions. Its power is around the frequency `F`, over a band of width `a`. It is
//! scaled by its variance
//!
//! ```text
//! lambda / 3 (1 / 2) (1 / (sqrt 2 a))^3
//! ```
//!
//! (random phases leave half of the Gaussian's square), so that four standard deviations reach 0 and 1. Kernels end where they
//! have fallen to 1/100.

use super::worley::count;
use super::{Pattern, fract, hash};
use crate::{Vec3, fmath};

/// Gabor noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gabor {
    /// Periods per unit.
    pub frequency: f32,
    /// Width of the band around it, above 0.
    pub bandwidth: f32,
    /// Unit vector across the waves; zero where each kernel has its own.
    pub direction: Vec3,
    /// Chooses the kernels.
    pub seed: u32,
}

impl Default for Gabor {
    fn default() -> Gabor {
        Gabor { frequency: 2.0, bandwidth: 0.75, direction: Vec3::ZERO, seed: 0 }
    }
}

/// The width `a` of a kernel that has fallen to 1/100 at the distance 1.
const REACH: f32 = 1.210_731_7;

/// `4 / 6 (1 / (sqrt 2 REACH))^3`: the variance with four kernels per cell, whose edge is the reach of one.
const VARIANCE: f32 = 0.132_807;

impl Pattern for Gabor {
    fn is_finite(&self) -> bool {
        self.frequency.is_finite() && self.bandwidth.is_finite() && self.direction.is_finite()
    }

    fn at(&self, q: Vec3, _width: f32) -> f32 {
        // In units of the reach.
        let scale = self.bandwidth / REACH;
        let (q, frequency) = (q * scale, self.frequency / scale);
        let floor = q.floor();
        let (f, home) = (q - floor, floor.to_array().map(|v| v as i32));
        let mut sum = 0.0;
        for x in -1..=1 {
            for y in -1..=1 {
                for z in -1..=1 {
                    let corner = Vec3::new(x as f32, y as f32, z as f32);
                    let outside = (corner - f).max(f - corner - 1.0).max(Vec3::ZERO);
                    if outside.length_squared() < 1.0 {
                        let cell =
                            [home[0].wrapping_add(x), home[1].wrapping_add(y), home[2].wrapping_add(z)];
                        sum += self.of_cell(hash::cell(cell, self.seed), f - corner, frequency);
                    }
                }
            }
        }
        0.5 + sum / (8.0 * VARIANCE.sqrt())
    }

    fn frequency(&self, _q: Vec3) -> f32 {
        self.frequency.abs().max(self.bandwidth)
    }
}

impl Gabor {
    /// What the kernels of a cell add at a place within or beside it.
    fn of_cell(&self, cell: u32, place: Vec3, frequency: f32) -> f32 {
        let mut sum = 0.0;
        for i in 0..count(cell) {
            let h = hash::with(cell, i as i32);
            let d = place - Vec3::new(hash::uniform(h, 0), hash::uniform(h, 1), hash::uniform(h, 2));
            let square = d.length_squared();
            if square >= 1.0 {
                continue;
            }
            let weight = 2.0 * hash::uniform(h, 3) - 1.0;
            let along =
                if self.direction == Vec3::ZERO { direction(h).dot(d) } else { self.direction.dot(d) };
            let wave = fmath::cos(std::f32::consts::TAU * fract(frequency * along + hash::uniform(h, 4)));
            sum += weight * fmath::exp(-std::f32::consts::PI * REACH * REACH * square) * wave;
        }
        sum
    }
}

/// A direction, uniform over the sphere.
fn direction(h: u32) -> Vec3 {
    let z = 2.0 * hash::uniform(h, 5) - 1.0;
    let (sin, cos) = fmath::sin_cos(std::f32::consts::TAU * hash::uniform(h, 6));
    let r = (1.0 - z * z).max(0.0).sqrt();
    Vec3::new(r * cos, z, r * sin)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pattern::spread;

    #[test]
    fn the_variance_is_the_formula_s() {
        let by_formula = 4.0 / 6.0 * (1.0 / (2.0f32.sqrt() * REACH)).powi(3);
        assert!((VARIANCE - by_formula).abs() < 1e-4, "{by_formula}");
        for direction in [Vec3::ZERO, Vec3::X] {
            let gabor = Gabor { direction, ..Gabor::default() };
            let n = 40_000u32;
            let values = (0..n).map(|i| f64::from(gabor.at(400.0 * spread(i), 0.0)));
            let (sum, squares) = values.fold((0.0, 0.0), |(s, q), v| (s + v, q + v * v));
            let mean = sum / f64::from(n);
            let sigma = (squares / f64::from(n) - mean * mean).sqrt();
            assert!((mean - 0.5).abs() < 0.004 && (sigma - 0.125).abs() < 0.004, "{mean} {sigma}");
        }
    }

    #[test]
    fn its_power_is_around_its_frequency() {
        // Along the direction half a period apart the noise is opposite, a whole one apart it is alike.
        let gabor = Gabor { direction: Vec3::X, ..Gabor::default() };
        let correlation = |step: f32| {
            let n = 20_000u32;
            let product = |i: u32| {
                let q = 300.0 * spread(i);
                (gabor.at(q, 0.0) - 0.5) * (gabor.at(q + step * Vec3::X, 0.0) - 0.5)
            };
            64.0 * (0..n).map(product).sum::<f32>() / n as f32
        };
        // exp(-pi a^2 d^2 / 2) cos(2 pi F d)
        for step in [0.125f32, 0.25, 0.5] {
            let a = 0.75f32;
            let expected = fmath::exp(-std::f32::consts::FRAC_PI_2 * (a * step).powi(2))
                * fmath::cos(std::f32::consts::TAU * 2.0 * step);
            assert!((correlation(step) - expected).abs() < 0.03, "{step}: {} {expected}", correlation(step));
        }
    }
}
