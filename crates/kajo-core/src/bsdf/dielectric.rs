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
//! a denser medium; light that is carried as importance's partner, in paths from the lamps, goes without it
//! [Veach 1997, sec. 5.2].
//!
//! A facet is drawn from those that `wo` sees, then reflection with probability F: the weight of a sample is
//! `G2/G1` (and `1/η²`).

use kajo_color::Spectrum;
use kajo_math::{Vec2, Vec3};

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

/// A facet that joins two directions.
struct Facet {
    facets: Microfacets,
    /// Its normal, upward.
    m: Vec3,
    /// Its reflectance.
    fresnel: f32,
    /// `|up·m| |down·m| / (up·m + η down·m)²` where light is refracted, with η of the boundary as it is defined.
    bend: Option<f32>,
}

/// The boundary as it is met from the side of `wo`, which is turned to be above.
struct Met {
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
    fn met(&self, wo: Vec3) -> Met {
        let eta = if wo.z > 0.0 { self.eta } else { 1.0 / self.eta };
        Met { eta, wo: Vec3::new(wo.x, wo.y, wo.z.abs()) }
    }

    pub(super) fn eval(&self, wo: Vec3, wi: Vec3, mode: Transport) -> Spectrum {
        let Some(facet) = self.facet(wo, wi) else { return Spectrum::BLACK };
        let Facet { facets, m, fresnel, bend } = facet;
        let common = facets.d(m) * facets.g2(wo, wi) / wo.z.abs();
        let Some(bend) = bend else {
            return self.reflection_tint * (0.25 * fresnel * common);
        };
        // Radiance that comes up is divided by eta²; what goes down would be multiplied by it.
        let scale = if (mode == Transport::Radiance) == (wo.z > 0.0) { 1.0 } else { self.eta * self.eta };
        self.transmission_tint * ((1.0 - fresnel) * common * bend * scale)
    }

    pub(super) fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        let Some(facet) = self.facet(wo, wi) else { return 0.0 };
        let Facet { facets, m, fresnel, bend } = facet;
        let side = wo.z.signum();
        let visible = facets.visible_over_cos(side * wo, m);
        match bend {
            None => 0.25 * fresnel * visible,
            Some(bend) => {
                (1.0 - fresnel) * visible * bend * if wo.z > 0.0 { self.eta * self.eta } else { 1.0 }
            }
        }
    }

    /// The facet that joins two directions, if there is one; the same, to the last bit, for both orders.
    #[inline]
    fn facet(&self, wo: Vec3, wi: Vec3) -> Option<Facet> {
        if self.is_smooth() || wo.z == 0.0 || wi.z == 0.0 {
            return None;
        }
        let facets = self.microfacets.held();
        let side = wo.z.signum();
        if same_side(wo, wi) {
            let m = (wo + wi).normalize_or_zero();
            let cos = wo.dot(m);
            let eta = if side > 0.0 { self.eta } else { 1.0 / self.eta };
            let fresnel = fresnel::dielectric(cos, eta);
            return (cos > 0.0).then_some(Facet { facets, m: side * m, fresnel, bend: None });
        }
        let (up, down) = if side > 0.0 { (wo, wi) } else { (wi, wo) };
        let m = (up + self.eta * down).normalize_or_zero();
        let m = if m.z < 0.0 { -m } else { m };
        let (cos_up, cos_down) = (up.dot(m), down.dot(m));
        if cos_up <= 0.0 || cos_down >= 0.0 {
            return None;
        }
        let spread = cos_up + self.eta * cos_down;
        let bend = Some(-cos_up * cos_down / (spread * spread));
        Some(Facet { facets, m, fresnel: fresnel::dielectric(cos_up, self.eta), bend })
    }

    pub(super) fn sample(&self, wo: Vec3, u: Vec2, uc: f32, mode: Transport) -> Option<BsdfSample> {
        let side = wo.z.signum();
        let Met { eta, wo } = self.met(wo);
        let smooth = self.is_smooth();
        let facets = self.microfacets.held();
        let m = if smooth { Vec3::Z } else { facets.sample(wo, u) };
        let cos_o = wo.dot(m);
        if cos_o <= 0.0 {
            return None;
        }
        let f = fresnel::dielectric(cos_o, eta);
        let visible = if smooth { 1.0 } else { facets.visible_over_cos(wo, m) };
        let reflects = uc < f;
        let (wi, weight, pdf) = if reflects {
            let wi = fresnel::reflect(-wo, m);
            (wi, self.reflection_tint, f * if smooth { 1.0 } else { 0.25 * visible })
        } else {
            let wi = fresnel::refract(-wo, m, eta)?;
            let cos_i = wi.dot(m);
            let spread = cos_i + cos_o / eta;
            let stretch = if smooth { 1.0 } else { visible * cos_o * cos_i.abs() / (spread * spread) };
            (wi, self.transmission_tint * mode.scale(eta), (1.0 - f) * stretch)
        };
        if same_side(wo, wi) != reflects || wi.z == 0.0 {
            return None;
        }
        let weight = if smooth { weight } else { weight * facets.g2_over_g1(wo, wi) };
        let kind = ScatterKind { transmission: !reflects, delta: smooth, straight: false };
        let sample = BsdfSample::new(Vec3::new(wi.x, wi.y, side * wi.z), weight, pdf, kind)?;
        Some(BsdfSample { eta: if reflects { 1.0 } else { eta }, ..sample })
    }

    pub(super) fn albedo(&self, wo: Vec3) -> Spectrum {
        let Met { eta, wo } = self.met(wo);
        let f = fresnel::dielectric(wo.z, eta);
        self.reflection_tint * f + self.transmission_tint * (1.0 - f)
    }
}
