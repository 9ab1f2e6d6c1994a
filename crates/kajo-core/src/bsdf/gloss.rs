//! The reflecting half of a rough dielectric boundary met from above: a coat, whatever lies below it.
//!
//! ```text
//! f(wo, wi) = F D(m) G2 / (4 cos θo cos θi)  +  l(o) l(i) / (π (L₁ + n² L₂))
//! ```
//!
//! as in [`Dielectric`](super::Dielectric), whose transmission is left to the layers below: they get the share that
//! [`Gloss::albedo`] does not reflect.
//!
//! Where another reflectance at normal incidence, `f0`, takes the place of `F0`, that of the index, Fresnel's term keeps its
//! shape and goes from `f0` to 1:
//!
//! ```text
//! f0 + (1 - f0) (F - F0)/(1 - F0)  =  a F + b        a = (1 - f0)/(1 - F0),   b = (f0 - F0)/(1 - F0)
//! ```
//!
//! The lobe is `a` times the one above and `b` times that of perfect mirrors: where `b` is positive with the light that
//! meets more than one facet, so that its albedo is 1, and where it is negative without that light, so that no facet reflects less than
//! nothing.

use kajo_math::{Vec2, Vec3};

use super::energy::{self, Loss};
use super::microfacet::half_vector;
use super::{Microfacets, fresnel};

/// Indices nearer to 1 than this do not reflect.
const MATCHED: f32 = 1e-3;

/// A glossy layer above others.
#[derive(Clone, Copy)]
pub(super) struct Gloss {
    n: f32,
    facets: Microfacets,
    loss: Loss,
}

impl Gloss {
    /// * `n`: index of the layer over that of the medium above, at least 1
    pub fn new(n: f32, facets: Microfacets) -> Gloss {
        let facets = facets.held();
        Gloss { n, facets, loss: Loss::new(&facets, n) }
    }

    /// Share of light reflected to `wo`.
    pub fn albedo(&self, wo: Vec3) -> f32 {
        if self.n < 1.0 + MATCHED { 0.0 } else { self.loss.reflected(wo) }
    }

    /// The lobe of perfect mirrors in place of the facets, without and with light that meets more than one of them; both
    /// directions above. Zero where the layer does not reflect.
    pub fn mirror_values(&self, wo: Vec3, wi: Vec3) -> [f32; 2] {
        if self.n < 1.0 + MATCHED {
            return [0.0; 2];
        }
        let once = self.facets.mirror_lobe(wo, wi, half_vector(wo, wi).0);
        [once, once * energy::metal(&self.facets, wo) * energy::metal(&self.facets, wi)]
    }

    /// The albedos of [`mirror_values`](Self::mirror_values).
    pub fn mirror_albedos(&self, wo: Vec3) -> [f32; 2] {
        if self.n < 1.0 + MATCHED { [0.0; 2] } else { [energy::mirrored_once(&self.facets, wo.z), 1.0] }
    }

    /// A value or an albedo of facets that reflect `factor` times as much at normal incidence, held to 1 there; see the top
    /// of this file.
    ///
    /// * `own`: the value or albedo without the factor
    /// * `mirrors`: those of perfect mirrors
    pub fn with_f0(&self, factor: f32, own: f32, mirrors: [f32; 2]) -> f32 {
        let root = (self.n - 1.0) / (self.n + 1.0);
        let of_index = root * root;
        let f0 = (of_index * factor).clamp(0.0, 1.0);
        let [a, b] = [1.0 - f0, f0 - of_index].map(|x| x / (1.0 - of_index));
        (a * own + b * mirrors[usize::from(b > 0.0)]).max(0.0)
    }

    /// Share of what is reflected to `wo` that meets more than one facet.
    fn again(&self, wo: Vec3) -> f32 {
        let again = self.loss.thin_share() * self.loss.lost(false, wo);
        (again / self.albedo(wo).max(again).max(f32::MIN_POSITIVE)).min(1.0)
    }

    /// Value, with the cosine of `wi`, and density of [`sample`](Self::sample); both directions above.
    pub fn eval(&self, wo: Vec3, wi: Vec3) -> (f32, f32) {
        if self.n < 1.0 + MATCHED {
            return (0.0, 0.0);
        }
        let (m, cos) = half_vector(wo, wi);
        let once = self.facets.mirror_lobe(wo, wi, m) * fresnel::dielectric(cos, self.n);
        let again = self.loss.returned(false, wi);
        let share = self.again(wo);
        let again_pdf = if share > 0.0 { self.loss.thin_pdf(wi) } else { 0.0 };
        let pdf = (1.0 - share) * 0.25 * self.facets.visible_over_cos(wo, m) + share * again_pdf;
        (once + self.loss.lost(false, wo) * again, pdf)
    }

    /// A direction, `None` when it is below the surface.
    pub fn sample(&self, wo: Vec3, u: Vec2, uc: f32) -> Option<Vec3> {
        let wi = if uc < self.again(wo) {
            self.loss.sample_side(false, u)
        } else {
            let m = self.facets.sample(wo, u);
            fresnel::reflect(-wo, m)
        };
        (wi.z > 0.0).then_some(wi)
    }
}
