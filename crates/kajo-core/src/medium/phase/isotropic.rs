//! Scattering to all sides alike: `p = 1 / 4π`.

use std::f32::consts::FRAC_1_PI;

/// `1 / 4π`.
pub const VALUE: f32 = 0.25 * FRAC_1_PI;

/// A cosine for `u` in [0, 1).
#[inline]
pub fn sample(u: f32) -> f32 {
    2.0 * u - 1.0
}
