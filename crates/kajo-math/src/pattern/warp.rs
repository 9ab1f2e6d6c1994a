//! Warping by turbulence: a pattern is looked up where noise has moved the point to.
//!
//! ```text
//! q' = q + a sum omega^i n(lambda^i q)
//! ```
//!
//! with a noise for each coordinate [Perlin 1985]; `lambda` and `omega` as POV-Ray calls them.

use super::gradient_noise::SHIFT;
use super::{noise_vector, passed};
use crate::Vec3;

/// How points are moved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TurbulentWarp {
    /// How far, along each axis.
    pub amount: Vec3,
    /// How many octaves the noise has, at least one.
    pub octaves: u32,
    /// Frequency of an octave by that of the one before.
    pub lambda: f32,
    /// Size of an octave by that of the one before.
    pub omega: f32,
    /// Chooses one of many noises.
    pub seed: u32,
}

impl Default for TurbulentWarp {
    fn default() -> TurbulentWarp {
        TurbulentWarp { amount: Vec3::splat(0.5), octaves: 6, lambda: 2.0, omega: 0.5, seed: 0 }
    }
}

impl TurbulentWarp {
    /// Whether all its numbers are finite.
    pub fn is_finite(&self) -> bool {
        self.amount.is_finite() && self.lambda.is_finite() && self.omega.is_finite()
    }

    /// Where a point is moved to; it stays where single precision has no digits left for the noise.
    ///
    /// * `width`: distance between samples, beyond which octaves are left out
    pub fn moved(&self, q: Vec3, width: f32) -> Vec3 {
        let (mut at, mut frequency, mut size, mut sum) = (q, 1.0f32, 1.0f32, Vec3::ZERO);
        for i in 0..self.octaves.min(16) {
            let share = passed(width, frequency);
            let is_near = at.abs().max_element() < 1_048_576.0;
            if share == 0.0 || !is_near {
                break;
            }
            sum +=
                size * share * noise_vector(at + SHIFT * (3 * i) as f32, self.seed.wrapping_add(101 + 3 * i));
            at *= self.lambda;
            frequency *= self.lambda;
            size *= self.omega;
        }
        q + self.amount * sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pattern::spread;

    #[test]
    fn points_move_as_far_as_they_are_told() {
        let warp = TurbulentWarp { amount: Vec3::new(0.25, 0.0, 1.0), ..TurbulentWarp::default() };
        let n = 20_000u32;
        let sum = (0..n).fold(Vec3::ZERO, |sum, i| {
            let q = 300.0 * spread(i);
            let way = warp.moved(q, 0.0) - q;
            sum + way * way
        });
        // The variance of six octaves of gain 1/2 is 0.27^2 (1 - 4^-6) / (1 - 1/4).
        let expected = 0.27f32.powi(2) * (4.0 / 3.0) * Vec3::new(0.0625, 0.0, 1.0);
        assert!((sum / n as f32 - expected).abs().max_element() < 0.003, "{}", sum / n as f32);
        let far = Vec3::splat(2e6);
        assert_eq!(warp.moved(far, 0.0), far);
        assert_eq!(warp.moved(Vec3::ONE, 0.6), Vec3::ONE, "wider than the widest octave");
    }
}
