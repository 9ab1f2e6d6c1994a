//! Phong's model with its lobes normalised, so that no light is made.
//!
//! ```text
//! f(wo, wi) = kd/π + ks (q + 2)/(2π) max(0, r·wi)^q  +  kr in the mirror direction  +  kt refracted
//! ```
//!
//! with `r` the mirror direction of `wo` [Lafortune and Willems 1994]: the factor is the one with which a lobe seen
//! straight on reflects `ks` of the light. Where the four colours add up to more than one they are scaled down together.
//! Light that is refracted where it cannot pass is reflected instead. The classic `PhongMaterial` comes to physical
//! integrators in this form.

use std::f32::consts::{FRAC_1_PI, TAU};

use kajo_color::Spectrum;
use kajo_math::{Frame, Vec2, Vec3, fmath, warp};

use super::broad::LARGEST_BROAD_EXPONENT;
use super::diffuse_normal::DiffuseNormal;
use super::{BsdfSample, Phong, ScatterKind, Transport, fresnel, same_side, upright};

/// Diffuse and glossy reflection, a mirror, and clear transmission.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhongLobes {
    diffuse: Spectrum,
    specular: Spectrum,
    reflective: Spectrum,
    transparent: Spectrum,
    exponent: f32,
    eta: f32,
    /// Probabilities of diffuse and specular lobe and the mirror; the rest is transmission.
    share: [f32; 3],
    diffuse_normal: DiffuseNormal,
}

impl From<&Phong> for PhongLobes {
    fn from(phong: &Phong) -> PhongLobes {
        let bounded = |s: Spectrum| s.map(|v| if v.is_finite() { v.max(0.0) } else { 0.0 });
        let colors = [phong.diffuse, phong.specular, phong.reflective, phong.transparent].map(bounded);
        let total = colors.into_iter().fold(Spectrum::BLACK, |sum, color| sum + color).max_lane();
        let scale = if total > 1.0 { 1.0 / total } else { 1.0 };
        let [diffuse, specular, reflective, transparent] = colors.map(|color| color * scale);
        let weights = [diffuse, specular, reflective, transparent].map(Spectrum::max_lane);
        let sum: f32 = weights.iter().sum();
        let share = [0, 1, 2].map(|i| if sum > 0.0 { weights[i] / sum } else { 0.0 });
        let exponent = phong.exponent.clamp(0.0, 1e6);
        let diffuse_normal = DiffuseNormal::SAME;
        PhongLobes {
            diffuse,
            specular,
            reflective,
            transparent,
            exponent,
            eta: phong.eta,
            share,
            diffuse_normal,
        }
    }
}

impl PhongLobes {
    /// The same surface with `eta_outside` instead of a vacuum on the side of its normal.
    #[inline]
    pub fn within(mut self, eta_outside: f32) -> PhongLobes {
        self.eta /= eta_outside;
        self
    }

    pub(super) fn has_diffuse(&self) -> bool {
        !self.diffuse.is_black()
    }

    /// The same with diffuse reflection about another normal.
    pub(super) fn bumped(self, diffuse_normal: DiffuseNormal) -> PhongLobes {
        PhongLobes { diffuse_normal, ..self }
    }

    /// The same with another exponent.
    pub(super) fn widened(self, exponent: impl FnOnce(f32) -> f32) -> PhongLobes {
        PhongLobes { exponent: exponent(self.exponent), ..self }
    }

    pub(super) fn is_delta(&self) -> bool {
        self.diffuse.is_black() && self.specular.is_black()
    }

    /// The share of light that is reflected evenly.
    pub(super) fn diffuse(&self) -> Spectrum {
        self.diffuse
    }

    /// Whether all light is reflected evenly.
    pub(super) fn is_even(&self) -> bool {
        [self.specular, self.reflective, self.transparent].iter().all(|color| color.is_black())
    }

    /// The diffuse lobe alone, for its value.
    pub(super) fn without_gloss(&self) -> PhongLobes {
        PhongLobes { specular: Spectrum::BLACK, ..*self }
    }

    /// Whether the glossy lobe is narrow.
    pub(super) fn is_narrow(&self) -> bool {
        !self.specular.is_black() && self.exponent > LARGEST_BROAD_EXPONENT
    }

    /// `max(0, r·wi)^q`, zero behind the mirror direction for `q = 0` too.
    fn lobe(&self, wo: Vec3, wi: Vec3) -> f32 {
        let mirror = Vec3::new(-wo.x, -wo.y, wo.z);
        let cos = mirror.dot(wi).min(1.0);
        if cos > 0.0 { fmath::pow(cos, self.exponent) } else { 0.0 }
    }

    pub(super) fn eval(&self, wo: Vec3, wi: Vec3, mode: Transport) -> Spectrum {
        if !same_side(wo, wi) {
            return Spectrum::BLACK;
        }
        let (wo, wi) = upright(wo, wi);
        let glossy = (self.exponent + 2.0) / TAU * self.lobe(wo, wi);
        if self.diffuse_normal == DiffuseNormal::SAME {
            return (self.diffuse * FRAC_1_PI + self.specular * glossy) * wi.z;
        }
        let diffuse = self.diffuse_normal.eval(wo, wi, mode, |_, wi| self.diffuse * (FRAC_1_PI * wi.z));
        diffuse + self.specular * (glossy * wi.z)
    }

    pub(super) fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        if !same_side(wo, wi) {
            return 0.0;
        }
        let (wo, wi) = upright(wo, wi);
        let glossy = (self.exponent + 1.0) / TAU * self.lobe(wo, wi);
        let diffuse_cosine = self.diffuse_normal.directions(wo, wi).map_or(0.0, |(_, wi)| wi.z);
        self.share[0] * diffuse_cosine * FRAC_1_PI + self.share[1] * glossy
    }

    pub(super) fn sample(&self, wo: Vec3, u: Vec2, uc: f32, mode: Transport) -> Option<BsdfSample> {
        let [diffuse, specular, reflective] = self.share;
        let mirror = Vec3::new(-wo.x, -wo.y, wo.z);
        let wi = if uc < diffuse {
            self.diffuse_direction(wo, u)?
        } else if uc < diffuse + specular {
            let cos = fmath::pow(1.0 - u.x, 1.0 / (self.exponent + 1.0));
            let sin = (1.0 - cos * cos).max(0.0).sqrt();
            let (s, c) = fmath::sin_cos(TAU * u.y);
            Frame::from_normal(mirror).to_world(Vec3::new(sin * c, sin * s, cos))
        } else if uc < diffuse + specular + reflective {
            return BsdfSample::new(
                mirror,
                self.reflective * (1.0 / reflective),
                reflective,
                ScatterKind::MIRROR,
            );
        } else {
            return self.refract(wo, 1.0 - (diffuse + specular + reflective), mode);
        };
        let pdf = self.pdf(wo, wi);
        BsdfSample::new(wi, self.eval(wo, wi, mode) * (1.0 / pdf), pdf, ScatterKind::REFLECTION)
    }

    fn diffuse_direction(&self, wo: Vec3, u: Vec2) -> Option<Vec3> {
        if self.diffuse_normal == DiffuseNormal::SAME {
            return Some(wo.z.signum() * warp::cosine_hemisphere(u));
        }
        let drawn =
            |_| BsdfSample::new(warp::cosine_hemisphere(u), Spectrum::WHITE, 1.0, ScatterKind::REFLECTION);
        let BsdfSample { wi, .. } = self.diffuse_normal.sample(Vec3::new(wo.x, wo.y, wo.z.abs()), drawn)?;
        Some(Vec3::new(wi.x, wi.y, wo.z.signum() * wi.z))
    }

    /// The refracted direction, chosen with probability `p`.
    fn refract(&self, wo: Vec3, p: f32, mode: Transport) -> Option<BsdfSample> {
        if self.transparent.is_black() {
            return None;
        }
        let eta = if wo.z > 0.0 { self.eta } else { 1.0 / self.eta };
        let normal = Vec3::new(0.0, 0.0, wo.z.signum());
        let color = self.transparent * (1.0 / p);
        let Some(wi) = fresnel::refract(-wo, normal, eta) else {
            return BsdfSample::new(Vec3::new(-wo.x, -wo.y, wo.z), color, p, ScatterKind::MIRROR);
        };
        let kind = ScatterKind { transmission: true, delta: true, straight: eta == 1.0 };
        BsdfSample::new(wi, color * mode.scale(eta), p, kind).map(|sample| BsdfSample { eta, ..sample })
    }

    pub(super) fn albedo(&self) -> Spectrum {
        self.diffuse + self.specular + self.reflective + self.transparent
    }
}
