//! A texel of a bidirectional texture function: see [`crate::measured::btf`].
//!
//! The back of a surface scatters as its front, mirrored at the surface. Directions follow the mean of all texels for the views around
//! `wo`; on paths from the lights too, whose value is that of both directions exchanged.

use kajo_color::{RgbBasis, Spectrum};
use kajo_math::{Vec2, Vec3};

use super::{BsdfSample, ScatterKind, Transport, same_side, upright};
use crate::measured::btf::{Btf, Texel};

/// What a texel scatters.
#[derive(Clone, Copy, Debug)]
pub struct BtfLobe<'s> {
    /// The tables.
    pub btf: &'s Btf,
    /// The texel.
    pub texel: Texel,
    /// A factor of all values, at least 0.
    pub scale: f32,
    /// What red, green and blue are in the lanes of the path.
    pub basis: RgbBasis,
}

impl BtfLobe<'_> {
    pub(super) fn eval(&self, wo: Vec3, wi: Vec3, mode: Transport) -> Spectrum {
        if !same_side(wo, wi) {
            return Spectrum::BLACK;
        }
        let (wo, wi) = upright(wo, wi);
        // Measured values may not be symmetric; those of the viewer's direction are meant.
        let [r, g, b] = match mode {
            Transport::Radiance => self.btf.value(self.texel, wo, wi),
            Transport::Importance => self.btf.value(self.texel, wi, wo),
        };
        self.basis.reflectance([r, g, b]) * (self.scale * wi.z)
    }

    pub(super) fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        if !same_side(wo, wi) {
            return 0.0;
        }
        let (wo, wi) = upright(wo, wi);
        self.btf.pdf(wo, wi)
    }

    pub(super) fn sample(&self, wo: Vec3, u: Vec2, uc: f32, mode: Transport) -> Option<BsdfSample> {
        let side = wo.z.signum();
        let wi = self.btf.sample(Vec3::new(wo.x, wo.y, wo.z.abs()), u, uc);
        let wi = Vec3::new(wi.x, wi.y, side * wi.z);
        let pdf = self.pdf(wo, wi);
        BsdfSample::new(wi, self.eval(wo, wi, mode) * (1.0 / pdf), pdf, ScatterKind::REFLECTION)
    }

    pub(super) fn albedo(&self, wo: Vec3) -> Spectrum {
        let above = Vec3::new(wo.x, wo.y, wo.z.abs());
        self.basis.reflectance(self.btf.albedo(self.texel, above)) * self.scale
    }
}
