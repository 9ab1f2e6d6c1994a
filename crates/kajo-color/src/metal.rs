//! Metals by their index of refraction and extinction.
//!
//! At normal incidence a metal reflects
//!
//! ```text
//! F₀ = ((n − 1)² + k²) / ((n + 1)² + k²)
//! ```
//!
//! In RGB mode `n` is read at the dominant wavelengths of the primaries and `k` solved from the colour that
//! the spectrum of `F₀` has under D65, so that a metal seen head on has the same colour in both modes:
//!
//! ```text
//! k² = (F₀ (n + 1)² − (n − 1)²) / (1 − F₀)
//! ```
//!
//! [Born and Wolf 1999, 14.2], [Gulbrandsen 2014, eq. 5]

use crate::matrix::apply;
use crate::reflectance::non_negative;
use crate::tabulated::Tabulated;
use crate::{Spectrum, Wavelengths, illuminant, observer, sensor};

/// Dominant wavelengths of the primaries of sRGB in nm.
const DOMINANT_NM: [f32; 3] = [611.4, 549.1, 464.2];

/// The index of refraction and the extinction of a conductor, relative to vacuum.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredMetal {
    eta: Tabulated,
    k: Tabulated,
    eta_rgb: [f32; 3],
    k_rgb: [f32; 3],
}

impl MeasuredMetal {
    /// A metal by its two tables; negative values become zero.
    pub fn new(eta: &Tabulated, k: &Tabulated) -> MeasuredMetal {
        let (eta, k) = (eta.map(non_negative), k.map(non_negative));
        let reflected = |nm: f32| f64::from(head_on(eta.at(nm), k.at(nm))) * f64::from(illuminant::d65(nm));
        let xyz = observer::xyz(&[eta.nm(), k.nm()].concat(), reflected);
        let colour = apply(&sensor::RGB_FROM_XYZ, xyz);
        let eta_rgb = DOMINANT_NM.map(|nm| eta.at(nm));
        let k_rgb = [0, 1, 2].map(|i| extinction(eta_rgb[i], colour[i] as f32));
        MeasuredMetal { eta, k, eta_rgb, k_rgb }
    }

    /// The index and the extinction in the lanes of a path.
    pub fn at(&self, lambda: &Wavelengths) -> (Spectrum, Spectrum) {
        match lambda.nm() {
            Some(nm) => (nm.map(|nm| self.eta.at(nm)).into(), nm.map(|nm| self.k.at(nm)).into()),
            None => {
                let rgb = |[r, g, b]: [f32; 3]| Spectrum::rgb(r, g, b);
                (rgb(self.eta_rgb), rgb(self.k_rgb))
            }
        }
    }

    /// Linear sRGB of white light reflected at normal incidence.
    pub fn rgb(&self) -> [f32; 3] {
        [0, 1, 2].map(|i| head_on(self.eta_rgb[i], self.k_rgb[i]))
    }
}

/// Reflectance at normal incidence.
fn head_on(eta: f32, k: f32) -> f32 {
    let (down, up) = (eta - 1.0, eta + 1.0);
    (down * down + k * k) / (up * up + k * k)
}

/// The extinction with which a metal of index `eta` reflects `f0` at normal incidence. What reflects more than
/// 0.999, as the red of gold does outside sRGB, is held there.
fn extinction(eta: f32, f0: f32) -> f32 {
    let f0 = non_negative(f0).min(0.999);
    let (down, up) = (eta - 1.0, eta + 1.0);
    non_negative((f0 * up * up - down * down) / (1.0 - f0)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::named::metal;

    #[test]
    fn metals_have_their_known_colours() {
        // Linear sRGB at normal incidence under D65, computed from the same tables by another program
        // [colour-science 0.4.7]. The red of gold, 1.0376, lies outside.
        let published = [
            ("aluminium", [0.9073, 0.9159, 0.9222]),
            ("chromium", [0.5496, 0.5561, 0.5541]),
            ("copper", [0.9317, 0.6227, 0.5222]),
            ("gold", [0.999, 0.7284, 0.3646]),
            ("iron", [0.5297, 0.5133, 0.4942]),
            ("silver", [0.9894, 0.9840, 0.9777]),
            ("titanium", [0.6186, 0.5794, 0.5425]),
        ];
        for (name, expected) in published {
            let found = metal(name).unwrap().rgb();
            assert!((0..3).all(|i| (found[i] - expected[i]).abs() < 5e-4), "{name}: {found:?}");
        }
    }

    #[test]
    fn lanes_are_read_from_the_tables() {
        let gold = metal("gold").unwrap();
        let lambda = Wavelengths::sample(0.5);
        let (eta, k) = gold.at(&lambda);
        for (i, nm) in lambda.nm().unwrap().into_iter().enumerate() {
            assert_eq!((eta[i], k[i]), (gold.eta.at(nm), gold.k.at(nm)));
        }
        let (eta, k) = gold.at(&Wavelengths::RGB);
        assert_eq!((eta[3], k[3]), (0.0, 0.0));
        assert!(eta[0] < 0.3 && k[0] > 3.0, "{eta:?} {k:?}");
    }

    #[test]
    fn both_modes_agree_head_on() {
        let copper = metal("copper").unwrap();
        let mut sum = [0.0; 3];
        for i in 0..4000 {
            let lambda = Wavelengths::sample((i as f32 + 0.5) / 4000.0);
            let (eta, k) = copper.at(&lambda);
            let white = crate::Emission::from_rgb([1.0; 3]).at(&lambda);
            let lanes = [0, 1, 2, 3].map(|i| head_on(eta[i], k[i]) * white[i]);
            for (sum, x) in sum.iter_mut().zip(sensor::to_rgb(lanes.into(), &lambda)) {
                *sum += x / 4000.0;
            }
        }
        let rgb = copper.rgb();
        assert!((0..3).all(|i| (sum[i] - rgb[i]).abs() < 1e-3), "{sum:?} {rgb:?}");
    }
}
