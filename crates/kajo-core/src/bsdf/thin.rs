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
//! What goes straight on reaches a light behind the pane as if there were a hole with the share `T`, so that paths treat it as
//! one: at each pane they decide whether they pass, [`ThinDielectric::cross`], and shadow rays are weakened by `T`.
//!
//! A rough pane is made of such panes as facets. One with the normal `m` sends the share `R` to the mirror direction, and
//! `T` to that direction's image beyond the surface:
//!
//! ```text
//! f(wo, wi) = (R or T)(wo·m) D(m) G2 / (4 |cos θo| |cos θi|),   m the half vector of wo and wi, which is mirrored if beyond
//! ```
//!
//! [Khronos glTF, KHR_materials_transmission], times the factor for light that meets more than one facet, see `energy.rs`:
//! where the pane absorbs nothing all light leaves it.

use kajo_color::Spectrum;
use kajo_math::{Vec2, Vec3};

use super::microfacet::{NormalDistribution, half_vector};
use super::{BsdfSample, Conductor, MetalFresnel, Microfacets, ScatterKind, energy, fresnel, same_side};

/// Up to this `α`, which is a roughness of 0.1, a pane is taken as polished. It would scatter light by about a degree, and
/// shadow rays that pass are worth more than that.
pub(crate) const POLISHED: f32 = 0.1 * 0.1;

/// A pane, polished or frosted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThinDielectric {
    /// Index of refraction of the pane over that of the medium around it.
    pub eta: f32,
    /// Absorption times thickness: straight across, light is attenuated by `exp(-optical_depth)`.
    pub optical_depth: Spectrum,
    /// Its facets.
    pub microfacets: Microfacets,
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
        let p = mirror_probability(r, t);
        if u >= p {
            return Ok(t * (1.0 / (1.0 - p)));
        }
        let fresnel = MetalFresnel::Constant(r * (1.0 / p));
        Err(Conductor { fresnel, microfacets: Microfacets::new(NormalDistribution::Ggx, 0.0) })
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

    /// Whether light goes on straight or is mirrored, in single directions only.
    #[inline]
    pub fn is_polished(&self) -> bool {
        self.microfacets.alpha_x.max(self.microfacets.alpha_y) <= POLISHED
    }

    /// Share of light at the cosine `cos` outside that goes straight on.
    #[inline]
    pub fn passage(&self, cos: f32) -> Spectrum {
        if self.is_polished() { self.shares(cos).1 } else { Spectrum::BLACK }
    }

    pub(super) fn eval(&self, wo: Vec3, wi: Vec3) -> Spectrum {
        if self.is_polished() || wo.z == 0.0 || wi.z == 0.0 {
            return Spectrum::BLACK;
        }
        let facets = self.microfacets.held();
        let (o, i) = (above(wo), above(wi));
        let (m, cos) = half_vector(o, i);
        self.scattered(&facets, [o, i], cos)[usize::from(!same_side(wo, wi))] * facets.mirror_lobe(o, i, m)
    }

    /// What a facet reflects and lets through, times the factor for further bounces; all directions above.
    ///
    /// * `cos`: cosine of both directions with its normal
    fn scattered(&self, facets: &Microfacets, [o, i]: [Vec3; 2], cos: f32) -> [Spectrum; 2] {
        let (r, t) = self.shares(cos.min(1.0));
        let x = energy::metal(facets, o) * energy::metal(facets, i);
        let again = (r + t).map(|f| energy::saturate(f, x));
        [r * again, t * again]
    }

    pub(super) fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        if self.is_polished() || wo.z == 0.0 || wi.z == 0.0 {
            return 0.0;
        }
        let (o, i) = (above(wo), above(wi));
        let (m, cos) = half_vector(o, i);
        let (r, t) = self.shares(cos.min(1.0));
        let mirrored = mirror_probability(r, t);
        let share = if same_side(wo, wi) { mirrored } else { 1.0 - mirrored };
        0.25 * share * self.microfacets.held().visible_over_cos(o, m)
    }

    pub(super) fn sample(&self, wo: Vec3, u: Vec2, uc: f32) -> Option<BsdfSample> {
        if !self.is_polished() {
            return self.sample_facet(wo, u, uc);
        }
        let (r, t) = self.shares(wo.z.abs());
        let p = mirror_probability(r, t);
        if uc < p {
            let wi = Vec3::new(-wo.x, -wo.y, wo.z);
            return BsdfSample::new(wi, r * (1.0 / p), p, ScatterKind::MIRROR);
        }
        BsdfSample::new(-wo, t * (1.0 / (1.0 - p)), 1.0 - p, ScatterKind::STRAIGHT)
    }

    /// A direction by way of one facet.
    fn sample_facet(&self, wo: Vec3, u: Vec2, uc: f32) -> Option<BsdfSample> {
        let facets = self.microfacets.held();
        let o = above(wo);
        let m = facets.sample(o, u);
        let i = fresnel::reflect(-o, m);
        if i.z <= 0.0 {
            return None;
        }
        let cos = o.dot(m);
        let (r, t) = self.shares(cos.min(1.0));
        let mirrored = mirror_probability(r, t);
        let passes = uc >= mirrored;
        let share = if passes { 1.0 - mirrored } else { mirrored };
        let weight =
            self.scattered(&facets, [o, i], cos)[usize::from(passes)] * (facets.g2_over_g1(o, i) / share);
        let pdf = 0.25 * share * facets.visible_over_cos(o, m);
        let is_above = (wo.z > 0.0) != passes;
        let wi = if is_above { i } else { Vec3::new(i.x, i.y, -i.z) };
        let kind = if passes { ScatterKind::TRANSMISSION } else { ScatterKind::REFLECTION };
        BsdfSample::new(wi, weight, pdf, kind)
    }

    pub(super) fn albedo(&self, wo: Vec3) -> Spectrum {
        let (r, t) = self.shares(wo.z.abs());
        r + t
    }
}

/// The direction, or its image on the side of positive z.
#[inline]
fn above(w: Vec3) -> Vec3 {
    Vec3::new(w.x, w.y, w.z.abs())
}

/// The probability of the mirror where one of the two is followed.
#[inline]
fn mirror_probability(r: Spectrum, t: Spectrum) -> f32 {
    r.max_lane() / (r.max_lane() + t.max_lane())
}
