//! Colours of pictures as spectra: three fixed reflectances, mixed.
//!
//! ```text
//! f(λ) = r ρ_r(λ) + g ρ_g(λ) + b ρ_b(λ),      ρ_r + ρ_g + ρ_b = 1,      0 ≤ ρ
//! ```
//!
//! The sum is linear in the colour. So what filters, scales or adds colours, as textures and environment
//! maps do, may do so before or after; white is flat, and colours within sRGB reflect no more than they receive.
//! A path finds the three in its lanes once and then mixes them for a few multiplications, where a
//! [`Reflectance`](crate::Reflectance) has to be fitted first. The price is a spectrum less smooth: two plateaus
//! and a slope between them.
//! [Mallett and Yuksel 2019]

use crate::data::primaries::{BLUE, RED};
use crate::observer::{FIRST_NM, LAST_NM, locate};
use crate::{Spectrum, Wavelengths};

/// Distance of the nodes in nm.
const STEP_NM: f64 = 5.0;
const NODES: usize = RED.len();

/// `ρ_r, ρ_g, ρ_b`, node by node.
static PRIMARIES: [[f32; 3]; NODES] = {
    let (mut table, mut i) = ([[0.0; 3]; NODES], 0);
    while i < NODES {
        table[i] = [RED[i] as f32, (1.0 - RED[i] - BLUE[i]) as f32, BLUE[i] as f32];
        i += 1;
    }
    table
};

/// The spectra of the primaries in the lanes of one path; in RGB mode, the primaries themselves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RgbBasis {
    primaries: [Spectrum; 3],
    white: Spectrum,
}

impl RgbBasis {
    /// The basis for the wavelengths of a path.
    pub fn new(lambda: &Wavelengths) -> RgbBasis {
        let Some(nm) = lambda.nm() else {
            let primaries =
                [Spectrum::rgb(1.0, 0.0, 0.0), Spectrum::rgb(0.0, 1.0, 0.0), Spectrum::rgb(0.0, 0.0, 1.0)];
            return RgbBasis { primaries, white: Spectrum::WHITE };
        };
        let lanes = nm.map(primaries_at);
        let primary = |c: usize| Spectrum::from([lanes[0][c], lanes[1][c], lanes[2][c], lanes[3][c]]);
        RgbBasis { primaries: [primary(0), primary(1), primary(2)], white: lambda.daylight() }
    }

    /// The reflectance, or another factor, of linear sRGB; in [0, 1] where the colour is.
    #[inline]
    pub fn reflectance(&self, [r, g, b]: [f32; 3]) -> Spectrum {
        self.primaries[0] * r + self.primaries[1] * g + self.primaries[2] * b
    }

    /// The shares that red, green and blue have of a wavelength in nm: positive or zero, and 1 together.
    /// Beyond the visible range they are as at its ends.
    pub fn shares_at(nm: f32) -> [f32; 3] {
        primaries_at(nm.clamp(FIRST_NM as f32, LAST_NM as f32))
    }

    /// The radiance of linear sRGB: D65 through a filter of that colour.
    #[inline]
    pub fn emission(&self, rgb: [f32; 3]) -> Spectrum {
        self.reflectance(rgb) * self.white
    }
}

/// `ρ_r, ρ_g, ρ_b` at a wavelength in nm; zero outside the visible range.
fn primaries_at(nm: f32) -> [f32; 3] {
    let Some((node, t)) = locate(nm, STEP_NM, NODES) else { return [0.0; 3] };
    let (a, b) = (PRIMARIES[node], PRIMARIES[node + 1]);
    [0, 1, 2].map(|i| a[i] + t * (b[i] - a[i]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::matrix::apply;
    use crate::{illuminant, observer, sensor};

    #[test]
    fn each_primary_looks_like_itself_under_d65() {
        for c in 0..3 {
            let light = |nm: f32| f64::from(primaries_at(nm)[c]) * f64::from(illuminant::d65(nm));
            let found = apply(&sensor::RGB_FROM_XYZ, observer::xyz(&[], light));
            for (i, x) in found.into_iter().enumerate() {
                assert!((x - f64::from(u8::from(i == c))).abs() < 1e-5, "{c}: {found:?}");
            }
        }
    }

    #[test]
    fn primaries_are_reflectances_that_add_up_to_one() {
        for i in 0..=4700 {
            let primaries = primaries_at(360.0 + 0.1 * i as f32);
            assert!(primaries.iter().all(|v| (0.0..=1.0).contains(v)), "{i}: {primaries:?}");
            assert!((primaries.iter().sum::<f32>() - 1.0).abs() < 1e-6, "{i}: {primaries:?}");
        }
        assert_eq!(primaries_at(359.0), [0.0; 3]);
        assert_eq!(RgbBasis::shares_at(200.0), primaries_at(360.0));
        assert_eq!(RgbBasis::shares_at(1e5), primaries_at(830.0));
    }

    #[test]
    fn rgb_mode_leaves_colours_alone() {
        let basis = RgbBasis::new(&Wavelengths::RGB);
        assert_eq!(basis.reflectance([0.1, 0.2, 0.3]), Spectrum::rgb(0.1, 0.2, 0.3));
        assert_eq!(basis.emission([4.0, 0.2, 0.0]), Spectrum::rgb(4.0, 0.2, 0.0));
    }

    #[test]
    fn white_is_flat_and_shines_as_d65() {
        let lambda = Wavelengths::sample(0.6);
        let basis = RgbBasis::new(&lambda);
        for i in 0..4 {
            assert!((basis.reflectance([0.7; 3])[i] - 0.7).abs() < 1e-6);
            assert!(
                (basis.emission([2.0; 3])[i] / illuminant::d65(lambda.nm().unwrap()[i]) - 2.0).abs() < 1e-5
            );
        }
    }
}
