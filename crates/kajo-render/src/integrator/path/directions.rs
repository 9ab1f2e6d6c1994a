//! Directions in which a path goes on from a surface: by its scattering, or by a rule independent of it.

use std::f32::consts::FRAC_1_PI;

use kajo_core::bsdf::{Bsdf, BsdfSample, ScatterKind, Transport};
use kajo_core::settings::Directions;
use kajo_math::{Vec2, Vec3, warp};

/// Which of a surface's scattering a path follows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// All of it.
    All,
    /// Without the single directions of mirrors and clear interfaces.
    Diffuse,
    /// Only those.
    Mirror,
}

impl Part {
    /// Whether a sample belongs to it.
    pub fn holds(self, sample: &BsdfSample) -> bool {
        match self {
            Part::All => true,
            Part::Diffuse => !sample.kind.delta,
            Part::Mirror => sample.kind.delta,
        }
    }
}

/// A direction drawn without regard to the surface's scattering, on either side if light passes.
///
/// * `directions`: the rule; any but [`Directions::Uniform`] goes by the cosine
/// * `choice`: uniform in [0, 1), chooses the side
pub fn sample(directions: Directions, bsdf: &Bsdf<'_>, wo: Vec3, u: Vec2, choice: f32) -> Option<BsdfSample> {
    let local = match directions {
        Directions::Uniform => warp::uniform_hemisphere(u),
        _ => warp::cosine_hemisphere(u),
    };
    let other_side = bsdf.transmits() && choice < 0.5;
    let side = if (wo.z > 0.0) == other_side { -1.0 } else { 1.0 };
    let wi = Vec3::new(local.x, local.y, side * local.z);
    let pdf = pdf(directions, bsdf, wo, wi);
    let weight = bsdf.eval(wo, wi, Transport::Radiance) * (1.0 / pdf);
    let kind = ScatterKind { transmission: other_side, delta: false, straight: false };
    (pdf > 0.0 && weight.is_finite()).then_some(BsdfSample { wi, weight, pdf, kind, eta: 1.0 })
}

/// Density per solid angle with which directions are drawn at surfaces that are no mirrors: by scattering itself, or by
/// [`sample`].
pub fn pdf(directions: Directions, bsdf: &Bsdf<'_>, wo: Vec3, wi: Vec3) -> f32 {
    let sides = if bsdf.transmits() { 0.5 } else { 1.0 };
    let reachable = bsdf.transmits() || wo.z * wi.z > 0.0;
    match directions {
        Directions::Scattering => bsdf.pdf(wo, wi),
        _ if !reachable => 0.0,
        Directions::Cosine => sides * wi.z.abs() * FRAC_1_PI,
        Directions::Uniform => sides * 0.5 * FRAC_1_PI,
    }
}
