//! Scattering by the droplets of fog and clouds: a fit to Mie's solution for water, averaged over some sizes of droplets
//! and over wavelengths, by their mean diameter `d` in micrometres [Jendersie and d'Eon 2023, eqs. 4 to 7]:
//!
//! ```text
//! p(cos) = (1 - w) HG(cos; g_HG) + w Draine(cos; g_D, alpha)
//!
//! g_HG  = exp(-0.0990567 / (d - 1.67154))
//! g_D   = exp(-2.20679 / (d + 3.91029) - 0.428934)
//! alpha = exp(3.62489 - 8.29288 / (d + 5.52825))
//! w     = exp(-0.599085 / (d - 0.641583) - 0.665888)
//! ```
//!
//! The narrow lobe is light that goes on nearly straight, the wide one with its part backwards is what makes edges of clouds bright.

use std::ops::RangeInclusive;

use kajo_math::fmath;

use super::{Draine, HenyeyGreenstein};

/// Scattering by droplets of water.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MiePhase {
    narrow: HenyeyGreenstein,
    wide: Draine,
    /// The share of the wide one.
    share: f32,
}

impl MiePhase {
    /// Diameters that the fit holds for, in micrometres.
    pub const DIAMETERS: RangeInclusive<f32> = 5.0..=50.0;

    /// * `diameter`: mean diameter of the droplets in micrometres
    ///
    /// `None` for one outside of [`MiePhase::DIAMETERS`].
    pub fn new(diameter: f32) -> Option<MiePhase> {
        if !MiePhase::DIAMETERS.contains(&diameter) {
            return None;
        }
        let d = diameter;
        let g_narrow = fmath::exp(-0.0990567 / (d - 1.67154));
        let g_wide = fmath::exp(-2.20679 / (d + 3.91029) - 0.428934);
        let alpha = fmath::exp(3.62489 - 8.29288 / (d + 5.52825));
        let share = fmath::exp(-0.599085 / (d - 0.641583) - 0.665888);
        Some(MiePhase { narrow: HenyeyGreenstein::new(g_narrow)?, wide: Draine::new(g_wide, alpha)?, share })
    }

    /// The mean cosine.
    pub fn mean_cosine(&self) -> f32 {
        (1.0 - self.share) * self.narrow.g() + self.share * self.wide.mean_cosine()
    }

    /// The value for the cosine of the angle by which light is turned.
    #[inline]
    pub fn at(&self, cos: f32) -> f32 {
        (1.0 - self.share) * self.narrow.at(cos) + self.share * self.wide.at(cos)
    }

    /// A cosine for `u` in [0, 1): one of the two lobes is chosen by its share, and drawn by what is left of `u`.
    pub fn sample(&self, u: f32) -> f32 {
        let below_one = |u: f32| u.min(1.0 - f32::EPSILON);
        match u < self.share {
            true => self.wide.sample(below_one(u / self.share)),
            false => self.narrow.sample(below_one((u - self.share) / (1.0 - self.share))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Diameter, cosine, value.
    const TABLE: [(f32, f32, f64); 15] = [
        (5.0, -1.0, 0.014781631),
        (5.0, -0.5, 0.0066660671),
        (5.0, 0.0, 0.0028821438),
        (5.0, 0.7, 0.069265234),
        (5.0, 0.98, 0.67694103),
        (20.0, -1.0, 0.010913952),
        (20.0, -0.5, 0.0045630133),
        (20.0, 0.0, 0.0011471754),
        (20.0, 0.7, 0.060291295),
        (20.0, 0.98, 0.56968779),
        (50.0, -1.0, 0.0094830693),
        (50.0, -0.5, 0.0038978623),
        (50.0, 0.0, 0.00080011425),
        (50.0, 0.7, 0.055773639),
        (50.0, 0.98, 0.59977964),
    ];

    /// Values of the fit worked out in double precision.
    #[test]
    fn droplets_scatter_as_the_paper_says() {
        for (diameter, cos, value) in TABLE {
            let phase = MiePhase::new(diameter).unwrap();
            let found = f64::from(phase.at(cos));
            assert!((found / value - 1.0).abs() < 2e-4, "{diameter} {cos}: {found} {value}");
        }
    }

    #[test]
    fn diameters_that_the_fit_does_not_know_are_none() {
        for diameter in [4.99, 50.01, 0.0, -5.0, f32::NAN, f32::INFINITY] {
            assert_eq!(MiePhase::new(diameter), None, "{diameter}");
        }
        assert!(MiePhase::new(5.0).is_some() && MiePhase::new(50.0).is_some());
    }
}
