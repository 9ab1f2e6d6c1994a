//! Which medium a body is filled with that is to have a given colour.
//!
//! A half space of albedo `alpha` that light enters and leaves without reflection gives back the share `A` of what comes from all
//! around. For isotropic scattering that is, by the similarity parameter `s = sqrt(1 - alpha)`, about
//!
//! ```text
//! A = (1 - s) (1 - 0.139 s) / (1 + 1.17 s)                                          [van de Hulst 1980]
//! ```
//!
//! and solved for `s`
//!
//! ```text
//! s = 4.09712 + 4.20863 A - sqrt(9.59217 + 41.6808 A + 17.7126 A^2)                 [Kulla and Conty 2017]
//! ```
//!
//! Half spaces of the albedos that this gives to dark colours reflect too much, 3 % for black. Against Chandrasekhar's H function that is taken away
//! to 0.02 % by asking for
//!
//! ```text
//! A' = A / (1 + 0.0312 (1 - A) exp(-4.45 A))
//! ```
//!
//! With the mean cosine `g` of scattering, half spaces of the same `s^2 = (1 - alpha) / (1 - g alpha)` look about alike, so that
//! `alpha = (1 - s^2) / (1 - g s^2)`.

use kajo_math::fmath;

/// The share of light that a collision scatters, of a medium whose half space has the reflectance `color` in even light.
///
/// * `color`: in [0, 1], met to 0.02 %
/// * `g`: mean cosine of scattering, in (-1, 1); for other than 0 the reflectance is about right
///
/// In [0, 1]; 1 for the colour 1.
pub fn albedo_of(color: f32, g: f32) -> f32 {
    let (color, g) = (f64::from(color).clamp(0.0, 1.0), f64::from(g));
    let a = color / (1.0 + 0.0312 * (1.0 - color) * fmath::exp64(-4.45 * color));
    let s = 4.09712 + 4.20863 * a - (9.59217 + 41.6808 * a + 17.7126 * a * a).sqrt();
    // What rounding leaves of both ends.
    let s2 = if color == 1.0 {
        0.0
    } else if color == 0.0 {
        1.0
    } else {
        s.clamp(0.0, 1.0).powi(2)
    };
    ((1.0 - s2) / (1.0 - g * s2)) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bond albedos of half spaces by Chandrasekhar's H function.
    #[test]
    fn half_spaces_have_the_albedo_that_was_asked_for() {
        for (alpha, bond) in [(0.5, 0.146_544), (0.8, 0.341_867), (0.9, 0.478_024), (0.99, 0.794_564)] {
            let found = albedo_of(bond, 0.0);
            assert!((found - alpha).abs() < 1e-3, "{bond}: {found} {alpha}");
        }
        assert_eq!([albedo_of(0.0, 0.0), albedo_of(1.0, 0.0), albedo_of(1.0, 0.7)], [0.0, 1.0, 1.0]);
    }

    #[test]
    fn it_grows_with_the_colour_and_stays_within_bounds() {
        for g in [-0.9, 0.0, 0.5, 0.95] {
            let all: Vec<f32> = (0..=1000).map(|i| albedo_of(i as f32 / 1000.0, g)).collect();
            assert!(all.iter().all(|alpha| (0.0..=1.0).contains(alpha)), "{g}");
            assert!(all.windows(2).all(|pair| pair[0] <= pair[1]), "{g}");
        }
    }

    #[test]
    fn the_similarity_parameter_is_kept() {
        for color in [0.1, 0.5, 0.9] {
            let isotropic = albedo_of(color, 0.0);
            for g in [-0.5, 0.3, 0.9] {
                let alpha = albedo_of(color, g);
                let reduced = (1.0 - g) * alpha / (1.0 - g * alpha);
                assert!((reduced - isotropic).abs() < 1e-5, "{color} {g}: {reduced} {isotropic}");
            }
        }
    }
}
