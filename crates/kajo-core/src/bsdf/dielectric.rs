//! Glass, water and other clear media, smooth or rough: light is reflected or refracted at facets.
//!
//! With `η` the index beyond the surface over the index on the side of `wo`:
//!
//! ```text
//! reflected    f = F D(m) G2 / (4 |cos θo| |cos θi|)                                        m along wo + wi
//!
//!              (1 - F) D(m) G2   |wi·m| |wo·m|
//! refracted    ——————————————— · ————————————————————                                       m along wo + η wi
//!              |cos θo| |cos θi| (wi·m + wo·m/η)² η²
//! ```
//!
//! [Walter et al. 2007, eq. 20 and 21]. The factor `1/η²` stands for radiance, which is squeezed into a narrower cone in
//! a denser medium; paths from the lights, which carry power, go without it [Veach 1997, sec. 5.2]. Refracted, `G2`
//! is the lesser of both `G1`. What is hidden all the same comes out in all directions, see `energy.rs`.
//!
//! A facet is drawn from those that `wo` sees, then reflection with probability F. Light that meets more than
//! one facet has its own part of the samples, as many as its share.

use kajo_color::Spectrum;
use kajo_math::{Vec2, Vec3};

use super::energy::Loss;
use super::microfacet::half_vector;
use super::{BsdfSample, Microfacets, ScatterKind, Transport, fresnel, same_side};

/// Indices nearer to each other than this part without bending light that single precision could tell.
const MATCHED: f32 = 1e-3;

/// A boundary between two clear media.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dielectric {
    /// Index of refraction on the side of negative z over that on the side of positive z.
    pub eta: f32,
    /// The facets of the boundary.
    pub microfacets: Microfacets,
    /// Factor of reflected light; white for real glass.
    pub reflection_tint: Spectrum,
    /// Factor of transmitted light; white for real glass.
    pub transmission_tint: Spectrum,
}

/// The boundary as it is met from the side of `wo`, which is turned to be above.
struct IncidentSide {
    eta: f32,
    wo: Vec3,
}

impl Dielectric {
    /// Untinted glass.
    pub fn new(eta: f32, microfacets: Microfacets) -> Dielectric {
        let white = Spectrum::WHITE;
        Dielectric { eta, microfacets, reflection_tint: white, transmission_tint: white }
    }

    /// Whether light is reflected and refracted in single directions only.
    pub(super) fn is_smooth(&self) -> bool {
        self.microfacets.is_smooth() || (self.eta - 1.0).abs() < MATCHED
    }

    #[inline]
    fn incident_side(&self, wo: Vec3) -> IncidentSide {
        let eta = if wo.z > 0.0 { self.eta } else { 1.0 / self.eta };
        IncidentSide { eta, wo: Vec3::new(wo.x, wo.y, wo.z.abs()) }
    }

    pub(super) fn eval(&self, wo: Vec3, wi: Vec3, mode: Transport) -> Spectrum {
        self.scatter(wo, wi, mode).0
    }

    pub(super) fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        self.scatter(wo, wi, Transport::Radiance).1
    }

    /// Value, with the cosine, and density.
    fn scatter(&self, wo: Vec3, wi: Vec3, mode: Transport) -> (Spectrum, f32) {
        if self.is_smooth() || wo.z == 0.0 || wi.z == 0.0 {
            return (Spectrum::BLACK, 0.0);
        }
        let facets = self.microfacets.held();
        let reflects = same_side(wo, wi);
        let (once, once_pdf) = self.once(&facets, wo, wi, mode);
        let loss = self.loss();
        let lost = loss.lost(self.is_dense(wo), wo);
        let again_pdf = loss.pdf(self.is_dense(wi), wi);
        let scale = if reflects { 1.0 } else { mode.scale(self.incident_side(wo).eta) };
        let again = lost * loss.returned(self.is_dense(wi), wi) * scale;
        let tint = if reflects { self.reflection_tint } else { self.transmission_tint };
        (tint * (once + again), (1.0 - lost) * once_pdf + lost * again_pdf)
    }

    /// Light that meets one facet: value and density. The facet is the same, to the last bit, for both ways.
    fn once(&self, facets: &Microfacets, wo: Vec3, wi: Vec3, mode: Transport) -> (f32, f32) {
        let side = wo.z.signum();
        let seen = |m: Vec3| facets.visible_over_cos(side * wo, m);
        if same_side(wo, wi) {
            let (m, cos) = half_vector(wo, wi);
            let m = side * m;
            let f = fresnel::dielectric(cos, self.incident_side(wo).eta);
            let value = 0.25 * f * facets.d(m) * facets.g2(wo, wi) / wo.z.abs();
            return (value, 0.25 * f * seen(m));
        }
        let (up, down) = if side > 0.0 { (wo, wi) } else { (wi, wo) };
        let m = (up + self.eta * down).normalize_or_zero();
        let m = if m.z < 0.0 { -m } else { m };
        let (cos_up, cos_down) = (up.dot(m), down.dot(m));
        if cos_up <= 0.0 || cos_down >= 0.0 {
            return (0.0, 0.0);
        }
        let spread = cos_up + self.eta * cos_down;
        let bent = (1.0 - fresnel::dielectric(cos_up, self.eta)) * -cos_up * cos_down / (spread * spread);
        let eta2 = self.eta * self.eta;
        // Radiance that comes up is divided by eta², and what goes down would be multiplied by it.
        let scale = if (mode == Transport::Radiance) == (wo.z > 0.0) { 1.0 } else { eta2 };
        let value = bent * scale * facets.d(m) * facets.through(wo, wi) / wo.z.abs();
        (value, bent * seen(m) * if wo.z > 0.0 { eta2 } else { 1.0 })
    }

    /// Whether `w` is on the side of the higher index.
    fn is_dense(&self, w: Vec3) -> bool {
        (self.eta > 1.0) != (w.z > 0.0)
    }

    fn loss(&self) -> Loss {
        Loss::new(&self.microfacets.held(), self.eta.max(1.0 / self.eta))
    }

    pub(super) fn sample(&self, wo: Vec3, u: Vec2, uc: f32, mode: Transport) -> Option<BsdfSample> {
        if self.is_smooth() {
            return self.sample_smooth(wo, uc, mode);
        }
        let loss = self.loss();
        let lost = loss.lost(self.is_dense(wo), wo);
        let wi = if uc < lost {
            loss.sample(self.eta < 1.0, u, uc / lost)
        } else {
            self.sample_facet(wo, u, (uc - lost) / (1.0 - lost))?
        };
        let (value, pdf) = self.scatter(wo, wi, mode);
        self.sampled(wo, wi, value * (1.0 / pdf), pdf, false)
    }

    fn sample_smooth(&self, wo: Vec3, uc: f32, mode: Transport) -> Option<BsdfSample> {
        let IncidentSide { eta, wo: above } = self.incident_side(wo);
        let side = wo.z.signum();
        let f = fresnel::dielectric(above.z, eta);
        if uc < f {
            let wi = Vec3::new(-wo.x, -wo.y, wo.z);
            return self.sampled(wo, wi, self.reflection_tint, f, true);
        }
        let wi = fresnel::refract(-wo, side * Vec3::Z, eta)?;
        self.sampled(wo, wi, self.transmission_tint * mode.scale(eta), 1.0 - f, true)
    }

    /// A direction by way of one facet.
    fn sample_facet(&self, wo: Vec3, u: Vec2, uc: f32) -> Option<Vec3> {
        let IncidentSide { eta, wo: above } = self.incident_side(wo);
        let m = self.microfacets.held().sample(above, u);
        let cos = above.dot(m);
        let reflects = uc < fresnel::dielectric(cos, eta);
        let wi = if reflects { fresnel::reflect(-above, m) } else { fresnel::refract(-above, m, eta)? };
        let wi = Vec3::new(wi.x, wi.y, wo.z.signum() * wi.z);
        (cos > 0.0 && wi.z != 0.0 && same_side(wo, wi) == reflects).then_some(wi)
    }

    fn sampled(&self, wo: Vec3, wi: Vec3, weight: Spectrum, pdf: f32, delta: bool) -> Option<BsdfSample> {
        let transmission = !same_side(wo, wi);
        let kind = ScatterKind { transmission, delta, straight: false };
        let sample = BsdfSample::new(wi, weight, pdf, kind)?;
        Some(BsdfSample { eta: if transmission { self.incident_side(wo).eta } else { 1.0 }, ..sample })
    }

    pub(super) fn albedo(&self, wo: Vec3) -> Spectrum {
        let IncidentSide { eta, wo } = self.incident_side(wo);
        let f = fresnel::dielectric(wo.z, eta);
        self.reflection_tint * f + self.transmission_tint * (1.0 - f)
    }
}
