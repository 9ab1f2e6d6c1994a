//! A measured BRDF at one point: see [`crate::measured`].
//!
//! The back of a surface scatters as its front, mirrored at the surface. On paths from the lights the value is that of both directions
//! exchanged, since tables need not be symmetric.

use kajo_color::Spectrum;
use kajo_math::{Vec2, Vec3};

use super::{BsdfSample, ScatterKind, Transport, same_side, upright};
use crate::measured::{MeasuredBrdf, MeasuredLanes};

/// What a measured material scatters.
#[derive(Clone, Copy, Debug)]
pub struct MeasuredLobe<'s> {
    /// The table.
    pub brdf: &'s MeasuredBrdf,
    /// A factor of all values, at least 0.
    pub scale: f32,
    /// What is asked of it.
    pub lanes: MeasuredLanes,
}

impl MeasuredLobe<'_> {
    pub(super) fn eval(&self, wo: Vec3, wi: Vec3, mode: Transport) -> Spectrum {
        if !same_side(wo, wi) {
            return Spectrum::BLACK;
        }
        let (wo, wi) = upright(wo, wi);
        match mode {
            Transport::Radiance => self.brdf.value(wo, wi, &self.lanes) * self.scale,
            // The cosine of the viewer's direction is in the value.
            Transport::Importance => self.brdf.value(wi, wo, &self.lanes) * (self.scale * wi.z / wo.z),
        }
    }

    pub(super) fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        if !same_side(wo, wi) {
            return 0.0;
        }
        let (wo, wi) = upright(wo, wi);
        self.brdf.pdf(wo, wi)
    }

    pub(super) fn sample(&self, wo: Vec3, u: Vec2, uc: f32, mode: Transport) -> Option<BsdfSample> {
        let side = wo.z.signum();
        let wi = self.brdf.sample(Vec3::new(wo.x, wo.y, wo.z.abs()), u, uc);
        if wi.z <= 0.0 {
            return None;
        }
        let wi = Vec3::new(wi.x, wi.y, side * wi.z);
        let pdf = self.pdf(wo, wi);
        BsdfSample::new(wi, self.eval(wo, wi, mode) * (1.0 / pdf), pdf, ScatterKind::REFLECTION)
    }

    pub(super) fn albedo(&self, wo: Vec3) -> Spectrum {
        let [r, g, b] = self.brdf.albedo(wo.z.abs()).map(|v| v * self.scale);
        match &self.lanes {
            MeasuredLanes::Rgb(basis) => basis.reflectance([r, g, b]),
            // A guide for roulette and denoising; which wavelengths there are matters little to it.
            MeasuredLanes::Nm(_) => Spectrum::from([(r + g + b) / 3.0; 4]),
        }
    }
}
