//! A pane of glass so thin that where light leaves is where it enters.
//!
//! Light that bounces to and fro inside adds up without interference. With `r` the reflectance of one face and
//! `a` what one crossing lets through:
//!
//! ```text
//! R = r + (1 - r)² r a² / (1 - r² a²)        T = (1 - r)² a / (1 - r² a²)
//! ```
//!
//! which without absorption are `2r/(1 + r)` and `(1 - r)/(1 + r)` [Stokes 1862]. The direction does not change: light
//! goes straight on, or to the mirror direction.
//!
//! What goes straight on reaches a lamp behind the pane as if there were a hole with the share `T`, so that paths treat it as
//! one: at each pane they decide whether they pass, [`ThinDielectric::cross`], and shadow rays are weakened by `T`.

use kajo_color::Spectrum;
use kajo_math::Vec3;

use super::microfacet::Shape;
use super::{BsdfSample, Conductor, MetalFresnel, Microfacets, ScatterKind, fresnel};

/// A clear pane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThinDielectric {
    /// Index of refraction of the pane over that of the medium around it.
    pub eta: f32,
    /// Absorption times thickness: straight across, light is attenuated by `exp(-optical_depth)`.
    pub optical_depth: Spectrum,
}

impl ThinDielectric {
    /// Decides at random whether a path passes: what it is multiplied by if it does, or else the mirror that it meets. The
    /// mean over `u` is the pane.
    ///
    /// * `cos`: of the angle with the normal
    /// * `u`: uniform in [0, 1)
    #[inline]
    pub fn cross(&self, cos: f32, u: f32) -> Result<Spectrum, Conductor> {
        let (r, t) = self.shares(cos);
        let p = chance_of_mirror(r, t);
        if u >= p {
            return Ok(t * (1.0 / (1.0 - p)));
        }
        let fresnel = MetalFresnel::Constant(r * (1.0 / p));
        Err(Conductor { fresnel, microfacets: Microfacets::new(Shape::Ggx, 0.0) })
    }

    /// Reflected and transmitted share at the cosine `cos` outside.
    pub fn shares(&self, cos: f32) -> (Spectrum, Spectrum) {
        let r = fresnel::dielectric(cos, self.eta);
        // Snell's law: the path inside is longer by 1/cos of the refracted ray.
        let sin2_t = (1.0 - cos * cos).max(0.0) / (self.eta * self.eta);
        let cos_t = (1.0 - sin2_t).max(0.0).sqrt();
        let a = self
            .optical_depth
            .map(|depth| if depth > 0.0 { kajo_math::fmath::exp(-depth / cos_t) } else { 1.0 });
        if r >= 1.0 {
            return (Spectrum::WHITE, Spectrum::BLACK);
        }
        let entering = (1.0 - r) * (1.0 - r);
        let transmitted = a.map(|a| entering * a / (1.0 - r * r * a * a));
        let reflected = a.map(|a| r + entering * r * a * a / (1.0 - r * r * a * a));
        (reflected, transmitted)
    }

    pub(super) fn sample(&self, wo: Vec3, uc: f32) -> Option<BsdfSample> {
        let (r, t) = self.shares(wo.z.abs());
        let p = chance_of_mirror(r, t);
        if uc < p {
            let wi = Vec3::new(-wo.x, -wo.y, wo.z);
            return BsdfSample::new(wi, r * (1.0 / p), p, ScatterKind::MIRROR);
        }
        BsdfSample::new(-wo, t * (1.0 / (1.0 - p)), 1.0 - p, ScatterKind::STRAIGHT)
    }

    pub(super) fn albedo(&self, wo: Vec3) -> Spectrum {
        let (r, t) = self.shares(wo.z.abs());
        r + t
    }
}

/// The probability of the mirror where one of the two is followed.
#[inline]
fn chance_of_mirror(r: Spectrum, t: Spectrum) -> f32 {
    r.max_lane() / (r.max_lane() + t.max_lane())
}
