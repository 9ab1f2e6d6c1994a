//! A body of clear matter whose index of refraction differs from place to place, so that light bends in it.
//!
//! Rays obey Hamilton's equations with the momentum `p`, `|p| = n`:
//!
//! ```text
//! dx/ds = p,      dp/ds = grad(n^2) / 2,      length: |p|,      optical length: n^2
//! ```
//!
//! [Born and Wolf 1999, section 3.2], by a parameter that makes them free of square roots. Radiance over `n^2` stays the same along
//! a ray: radiance itself is what pictures show, as in glass.
//!
//! The index depends on the wavelength by a factor of `n - 1`, [`Dispersing`]. Where it does, rays of one wavelength are followed.
//!
//! Scene: `Media { GradientIndex ball { index = sqrt(2 - x^2 - y^2 - z^2) } }`

mod dispersing;
mod index_grid;
mod profile;
#[cfg(test)]
mod tests;

use kajo_color::Wavelengths;
use kajo_math::{DVec3, Vec3};

use super::bending::only_bends_light;
use super::{Coefficients, Medium};
use crate::curved_light::{RayEquation, RayState, Stepping, momentum, position};

pub use dispersing::Dispersing;
pub use index_grid::{IndexGrid, IndexGridError};
pub use profile::{AirLayers, IndexTurbulence, Profile};

/// A medium whose index of refraction differs from place to place.
#[derive(Clone, Debug)]
pub struct GradientIndex {
    /// The index by place, at yellow light.
    pub profile: Profile,
    /// What is added to it at random.
    pub turbulence: Option<IndexTurbulence>,
    /// How it depends on the wavelength.
    pub dispersing: Dispersing,
    /// How light is followed.
    pub stepping: Stepping,
    coefficients: Coefficients,
}

impl GradientIndex {
    /// A clear medium of this index.
    pub fn new(profile: Profile) -> GradientIndex {
        GradientIndex {
            profile,
            turbulence: None,
            dispersing: Dispersing::None,
            stepping: Stepping::Adaptive,
            coefficients: Coefficients::clear(),
        }
    }

    /// The law of rays at the first wavelength.
    pub fn at<'a>(&'a self, wavelengths: &Wavelengths) -> IndexField<'a> {
        IndexField { medium: self, factor: self.dispersing.factor(wavelengths) }
    }
}

/// A gradient index at one wavelength.
#[derive(Clone, Copy, Debug)]
pub struct IndexField<'a> {
    medium: &'a GradientIndex,
    /// Of `n - 1`.
    factor: f64,
}

impl IndexField<'_> {
    /// The square of the index at a world-space point, and half its gradient; not a number where there is no index.
    pub fn squared(&self, p: DVec3) -> (f64, DVec3) {
        let (mut square, mut half_slope) = self.medium.profile.squared(p);
        if self.medium.turbulence.is_none() && self.factor == 1.0 {
            return if square > 0.0 { (square, half_slope) } else { (f64::NAN, half_slope) };
        }
        let (mut n, mut slope) = (square.sqrt(), half_slope / square.sqrt());
        if let Some(turbulence) = &self.medium.turbulence {
            let (added, its_slope) = turbulence.at(p);
            (n, slope) = (n + added, slope + its_slope);
        }
        (n, slope) = (1.0 + self.factor * (n - 1.0), self.factor * slope);
        (square, half_slope) = (n * n, n * slope);
        if n > 0.0 { (square, half_slope) } else { (f64::NAN, half_slope) }
    }
}

impl RayEquation for IndexField<'_> {
    fn start(&self, p: DVec3, d: DVec3) -> Option<RayState> {
        let (square, _) = self.squared(p);
        let momentum = square.sqrt() * d.normalize();
        square.is_finite().then_some([p.x, p.y, p.z, momentum.x, momentum.y, momentum.z, 0.0, 0.0])
    }

    #[inline]
    fn slope(&self, y: &RayState) -> RayState {
        let (square, force) = self.squared(position(y));
        let p = momentum(y);
        [p.x, p.y, p.z, force.x, force.y, force.z, p.length(), square]
    }

    fn corrected(&self, y: &RayState) -> RayState {
        let (square, _) = self.squared(position(y));
        let p = momentum(y);
        let ratio = square / p.length_squared();
        // Nothing to mend that rounding would not do again.
        if (ratio - 1.0).abs() < 1e-13 || !ratio.is_finite() {
            return *y;
        }
        let p = ratio.sqrt() * p;
        [y[0], y[1], y[2], p.x, p.y, p.z, y[6], y[7]]
    }

    fn index(&self, y: &RayState) -> f64 {
        self.squared(position(y)).0.sqrt()
    }

    fn conserved(&self, y: &RayState) -> [Option<(&'static str, f64)>; 3] {
        let (p, m) = (position(y), momentum(y));
        let length = Some(("momentum over index", m.length() / self.index(y)));
        // Whatever is added to a profile breaks its symmetry.
        let symmetric = self.medium.turbulence.is_none();
        let own = match &self.medium.profile {
            Profile::Luneburg { center, .. } | Profile::FishEye { center, .. } => {
                Some(("angular momentum", (p - *center).cross(m).length()))
            }
            Profile::Rod { axis, .. } => Some(("momentum along the axis", m.dot(*axis))),
            _ => None,
        };
        [length, own.filter(|_| symmetric), None]
    }

    fn stepping(&self) -> Stepping {
        self.medium.stepping
    }
}

impl Medium for GradientIndex {
    fn is_finite(&self) -> bool {
        self.profile.is_finite() && self.turbulence.as_ref().is_none_or(IndexTurbulence::is_finite)
    }

    only_bends_light!(|medium, _region, wavelengths| medium.at(wavelengths));

    fn is_dispersive(&self) -> bool {
        !matches!(self.dispersing, Dispersing::None)
    }

    fn index(&self, p: Vec3, wavelengths: &Wavelengths) -> Option<f32> {
        let (square, _) = self.at(wavelengths).squared(p.as_dvec3());
        Some(if square.is_finite() { square.sqrt() as f32 } else { 1.0 })
    }
}
