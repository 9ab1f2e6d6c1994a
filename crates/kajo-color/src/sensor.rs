//! From what a path carries to a colour.
//!
//! In spectral mode the four lanes are four estimates of
//!
//! ```text
//! X = ∫ L(λ) x̄(λ) dλ / ∫ ȳ(λ) dλ  ≈  1/4 Σᵢ L(λᵢ) x̄(λᵢ) / p(λᵢ) / ∫ ȳ(λ) dλ
//! ```
//!
//! in RGB mode they are the colour. Linear RGB has the primaries of sRGB, with white where the table of
//! D65 puts it, 3e-5 from the chromaticity in the standard: so a grey surface under a white light is grey in
//! both modes to the last digit.
//! [Pharr, Jakob and Humphreys 2023, 4.6]

use kajo_math::Vec4;

use crate::gamut::{SRGB, xyz_from_primaries};
use crate::illuminant::D65_XYZ;
use crate::matrix::{Matrix3, apply_f32, inverse};
use crate::observer::{LUMINANCE_NM, matching_lanes};
use crate::{Spectrum, Wavelengths};

/// CIE XYZ of linear RGB as the sensor sees it.
pub const XYZ_FROM_RGB: Matrix3 = xyz_from_primaries(&SRGB.primaries, D65_XYZ);

/// Linear RGB of CIE XYZ as the sensor sees it.
pub const RGB_FROM_XYZ: Matrix3 = inverse(&XYZ_FROM_RGB);

/// CIE XYZ of radiance, one sample of it in spectral mode. `Y` is 1 for a white of 1.
pub fn to_xyz(s: Spectrum, lambda: &Wavelengths) -> [f32; 3] {
    if !lambda.is_spectral() {
        return apply_f32(&XYZ_FROM_RGB, s.to_rgb());
    }
    let (nm, pdf, mut sum) = (lambda.seen_nm(), lambda.pdf(), Vec4::ZERO);
    for i in 0..4 {
        if pdf[i] > 0.0 {
            sum += s[i] / pdf[i] * matching_lanes(nm[i]);
        }
    }
    (sum * (0.25 / LUMINANCE_NM) as f32).truncate().to_array()
}

/// Linear RGB of radiance, one sample of it in spectral mode, where single samples may be negative.
#[inline]
pub fn to_rgb(s: Spectrum, lambda: &Wavelengths) -> [f32; 3] {
    if lambda.is_spectral() { apply_f32(&RGB_FROM_XYZ, to_xyz(s, lambda)) } else { s.to_rgb() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observer::xyz;

    /// The mean of `f(λ)` on the sensor over even `u`, four lanes or only the hero.
    fn mean(f: impl Fn(f32) -> f32, terminate: bool) -> [f64; 3] {
        const N: usize = 20_000;
        let mut sum = [0.0; 3];
        for i in 0..N {
            let mut lambda = Wavelengths::sample((i as f32 + 0.5) / N as f32);
            if terminate {
                lambda.terminate_secondary();
            }
            let s = Spectrum::from(lambda.nm().unwrap().map(&f));
            for (sum, x) in sum.iter_mut().zip(to_xyz(s, &lambda)) {
                *sum += f64::from(x) / N as f64;
            }
        }
        sum
    }

    #[test]
    fn lanes_estimate_the_integral_all_four_or_one() {
        let step = |nm: f32| if nm > 550.0 { 2.0 } else { 0.25 };
        let expected = xyz(&[550.0], |nm| f64::from(step(nm)));
        for terminate in [false, true] {
            let found = mean(step, terminate);
            for i in 0..3 {
                assert!((found[i] - expected[i]).abs() < 2e-4 * expected[i], "{found:?} {expected:?}");
            }
        }
    }

    #[test]
    fn rgb_mode_is_the_identity_and_agrees_with_xyz() {
        let s = Spectrum::rgb(0.2, 0.5, 0.9);
        assert_eq!(to_rgb(s, &Wavelengths::RGB), [0.2, 0.5, 0.9]);
        let back = apply_f32(&RGB_FROM_XYZ, to_xyz(s, &Wavelengths::RGB));
        for (found, expected) in back.into_iter().zip([0.2, 0.5, 0.9]) {
            assert!((found - expected).abs() < 1e-6);
        }
    }

    #[test]
    fn the_sensors_primaries_are_those_of_srgb() {
        for (found, expected) in XYZ_FROM_RGB.iter().flatten().zip(SRGB.xyz_from_rgb().iter().flatten()) {
            assert!((found - expected).abs() < 4e-4, "{found} {expected}");
        }
    }
}
