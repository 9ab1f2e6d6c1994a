//! Scattering by particles much smaller than the wavelength, as by those of air, for light that is not polarised:
//!
//! ```text
//! p(cos) = 3 (1 + cos²) / 16π
//! ```
//!
//! [Chandrasekhar 1950]. The share of directions below a cosine is `u = (cos³ + 3 cos + 4) / 8`, a cubic that Cardano's
//! formula inverts [Frisvad 2011]:
//!
//! ```text
//! cos = a - 1/a,    a³ = q + sqrt(q² + 1),    q = 4u - 2
//! ```

use std::f32::consts::FRAC_1_PI;

use kajo_math::fmath;

/// The value for the cosine of the angle by which light is turned.
#[inline]
pub fn at(cos: f32) -> f32 {
    3.0 / 16.0 * FRAC_1_PI * (1.0 + cos * cos)
}

/// A cosine for `u` in [0, 1).
#[inline]
pub fn sample(u: f32) -> f32 {
    let q = 4.0 * u - 2.0;
    // The curve is odd in q; with a positive one nothing cancels below the root.
    let size = q.abs();
    let a = fmath::pow(size + (size * size + 1.0).sqrt(), 1.0 / 3.0);
    (a - 1.0 / a).copysign(q)
}
