//! Ideal diffusion: radiance leaves evenly, whatever direction light came from.
//!
//! ```text
//! f(wo, wi) = R/π  on the side of wo,   T/π  on the other
//! ```
//!
//! [Lambert 1760]. `T` makes leaves, paper and light shades; reflection and transmission take their share of the
//! samples in proportion to their largest lanes.

use std::f32::consts::FRAC_1_PI;

use kajo_color::Spectrum;
use kajo_math::{Vec2, Vec3, warp};

use super::{BsdfSample, ScatterKind, same_side};

/// Diffuse reflection and transmission.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lambert {
    /// Share of light reflected, in [0, 1].
    pub reflectance: Spectrum,
    /// Share of light let through, in [0, 1]; with the reflectance at most 1.
    pub transmittance: Spectrum,
}

impl Lambert {
    /// An opaque surface.
    pub fn new(reflectance: Spectrum) -> Lambert {
        Lambert { reflectance, transmittance: Spectrum::BLACK }
    }

    /// What it reflects.
    pub(super) fn without_transmission(&self) -> Lambert {
        Lambert::new(self.reflectance)
    }

    /// Probability of reflection.
    #[inline]
    fn reflects(&self) -> f32 {
        let t = self.transmittance.max_lane();
        if t > 0.0 {
            let r = self.reflectance.max_lane();
            return r / (r + t);
        }
        1.0
    }

    #[inline]
    pub(super) fn eval(&self, wo: Vec3, wi: Vec3) -> Spectrum {
        let share = if same_side(wo, wi) { self.reflectance } else { self.transmittance };
        share * (wi.z.abs() * FRAC_1_PI)
    }

    #[inline]
    pub(super) fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        let p = self.reflects();
        wi.z.abs() * FRAC_1_PI * if same_side(wo, wi) { p } else { 1.0 - p }
    }

    pub(super) fn sample(&self, wo: Vec3, u: Vec2, uc: f32) -> Option<BsdfSample> {
        let p = self.reflects();
        let reflects = uc < p;
        let mut wi = warp::cosine_hemisphere(u);
        let cos = wi.z;
        if reflects != (wo.z > 0.0) {
            wi.z = -wi.z;
        }
        let (share, p) = if reflects { (self.reflectance, p) } else { (self.transmittance, 1.0 - p) };
        let kind = if reflects { ScatterKind::REFLECTION } else { ScatterKind::TRANSMISSION };
        BsdfSample::new(wi, share * (1.0 / p), p * cos * FRAC_1_PI, kind)
    }

    pub(super) fn albedo(&self) -> Spectrum {
        self.reflectance + self.transmittance
    }
}
