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

/// The value for the cosine of the angle by which light is turned; off by at most 3e-7 of itself.
#[inline]
pub fn at(cos: f32) -> f32 {
    3.0 / 16.0 * FRAC_1_PI * (1.0 + cos * cos)
}

/// A cosine for `u` in [0, 1), off by at most 8e-7.
#[inline]
pub fn sample(u: f32) -> f32 {
    let q = 4.0 * u - 2.0;
    // The curve is odd in q; with a positive one nothing cancels below the root.
    let size = q.abs();
    let a = fmath::pow(size + (size * size + 1.0).sqrt(), 1.0 / 3.0);
    (a - 1.0 / a).copysign(q)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_and_cosines_are_as_exact_as_they_say() {
        for i in 0..100_000u32 {
            let u = i as f32 / 100_000.0;
            let cos = 2.0 * f64::from(u) - 1.0;
            let exact = 3.0 / (16.0 * std::f64::consts::PI) * (1.0 + cos * cos);
            assert!((f64::from(at(2.0 * u - 1.0)) / exact - 1.0).abs() < 3e-7, "{cos}");
            let q = 4.0 * f64::from(u) - 2.0;
            let a = (q.abs() + (q * q + 1.0).sqrt()).cbrt();
            let exact = (a - 1.0 / a).copysign(q);
            assert!((f64::from(sample(u)) - exact).abs() < 8e-7, "{u}: {exact}");
        }
    }
}
