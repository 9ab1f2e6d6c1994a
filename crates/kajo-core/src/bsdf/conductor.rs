//! Reflection from a metal, smooth or rough.
//!
//! ```text
//! f(wo, wi) = F(wi·m) D(m) G2(wo, wi) / (4 |cos θo| |cos θi|),   m the half vector
//! ```
//!
//! [Cook and Torrance 1982], [Walter et al. 2007, eq. 20], times a factor for light that facets reflect more than once,
//! see `energy.rs`. Facets are drawn from those that `wo` sees, so the weight of a sample is that factor times `F G2/G1`
//! [Heitz 2018].
//!
//! Fresnel's equations with the complex index `eta + i k`, relative to the medium outside, for
//! unpolarised light [Born and Wolf 1999, sec. 14.2]:
//!
//! ```text
//! a² - b² = t = eta² - k² - sin²      a² + b² = √(t² + 4 eta² k²)      a b = eta k
//!
//!      (a - cos)² + b²               (a cos - sin²)² + (b cos)²
//! Rs = ———————————————       Rp = Rs ——————————————————————————      F = (Rs + Rp) / 2
//!      (a + cos)² + b²               (a cos + sin²)² + (b cos)²
//! ```

use kajo_color::Spectrum;
use kajo_math::{Vec2, Vec3};

use super::microfacet::half_vector;
use super::{BsdfSample, Microfacets, ScatterKind, energy, same_side, upright};

/// How much the facets of a metal reflect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MetalFresnel {
    /// By the complex index of refraction relative to the medium outside.
    Complex {
        /// Real part.
        eta: Spectrum,
        /// Extinction, the imaginary part.
        k: Spectrum,
    },
    /// By two colours: straight on, and what is left of Schlick's reflectance at 82 degrees
    /// [Kutz, Hašan and Edmondson 2021].
    Tinted {
        /// Reflectance straight on.
        f0: Spectrum,
        /// Factor at 82 degrees; white is [Schlick 1994].
        f82: Spectrum,
    },
    /// The same at every angle.
    Constant(Spectrum),
}

impl MetalFresnel {
    /// Reflectance at the cosine `cos` in [0, 1].
    #[inline]
    pub fn at(&self, cos: f32) -> Spectrum {
        match *self {
            MetalFresnel::Complex { eta, k } => complex(cos, eta, k),
            MetalFresnel::Tinted { f0, f82 } => tinted(cos, f0, f82),
            MetalFresnel::Constant(f) => f,
        }
    }
}

/// Schlick's reflectance less a term that is largest where the cosine is 1/7 and scales it there by `f82`.
#[inline]
fn tinted(cos: f32, f0: Spectrum, f82: Spectrum) -> Spectrum {
    const COS_82: f32 = 1.0 / 7.0;
    let fifth_power = |x: f32| {
        let x2 = x * x;
        x2 * x2 * x
    };
    let schlick = |cos: f32| {
        let t = fifth_power(1.0 - cos);
        f0 * (1.0 - t) + Spectrum::grey(t)
    };
    let cos = cos.clamp(0.0, 1.0);
    let dip = |cos: f32| cos * (1.0 - cos) * fifth_power(1.0 - cos);
    let dip = schlick(COS_82) * (Spectrum::WHITE - f82) * (dip(cos) / dip(COS_82));
    (schlick(cos) - dip).clamp(0.0, 1.0)
}

/// Fresnel reflectance of a conductor for unpolarised light, lane by lane.
#[inline]
pub fn complex(cos: f32, eta: Spectrum, k: Spectrum) -> Spectrum {
    let (rs, rp) = complex_polarised(cos, eta, k);
    (rs + rp) * 0.5
}

/// Reflectances of a conductor for light polarised across and along the plane of incidence.
///
/// Of `a` and `b` the larger is a root and the smaller `eta k` over it, and squares are added, so that nothing cancels: their mean
/// is off by at most 5e-7 where `k >= 0.5`.
#[inline]
pub fn complex_polarised(cos: f32, eta: Spectrum, k: Spectrum) -> (Spectrum, Spectrum) {
    let cos = cos.clamp(0.0, 1.0);
    let sin2 = (1.0 - cos) * (1.0 + cos);
    let ratio = |a: Spectrum, b: Spectrum| a * b.map(|b| 1.0 / b.max(f32::MIN_POSITIVE));
    let square = |v: Spectrum| v * v;
    let grey = Spectrum::grey;
    let product = eta * k;
    let t = (eta - k) * (eta + k) - grey(sin2);
    let sum = (square(t) + square(product) * 4.0).sqrt();
    let larger = ((sum + t.map(f32::abs)) * 0.5).sqrt();
    let smaller = product.safe_div(larger);
    let choose = |first: Spectrum, other: Spectrum| {
        Spectrum::from([0, 1, 2, 3].map(|lane| if t[lane] > 0.0 { first[lane] } else { other[lane] }))
    };
    let (a, b) = (choose(larger, smaller), choose(smaller, larger));
    let rs = ratio(square(a - grey(cos)) + square(b), square(a + grey(cos)) + square(b));
    let (along, b2) = (a * cos, square(b * cos));
    let rp = ratio(square(along - grey(sin2)) + b2, square(along + grey(sin2)) + b2);
    (rs, rs * rp)
}

/// A metal surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conductor {
    /// Reflectance of its facets.
    pub fresnel: MetalFresnel,
    /// Its facets.
    pub microfacets: Microfacets,
}

impl Conductor {
    pub(super) fn is_smooth(&self) -> bool {
        self.microfacets.is_smooth()
    }

    pub(super) fn eval(&self, wo: Vec3, wi: Vec3) -> Spectrum {
        if self.is_smooth() || !same_side(wo, wi) {
            return Spectrum::BLACK;
        }
        let (wo, wi) = upright(wo, wi);
        let facets = self.microfacets.held();
        let (m, cos) = half_vector(wo, wi);
        self.reflected(&facets, [wo, wi], cos) * facets.mirror_lobe(wo, wi, m)
    }

    /// What a facet reflects, times the factor for further bounces.
    ///
    /// * `cos`: cosine of both directions with its normal
    #[inline]
    fn reflected(&self, facets: &Microfacets, [wo, wi]: [Vec3; 2], cos: f32) -> Spectrum {
        let x = energy::metal(facets, wo) * energy::metal(facets, wi);
        self.fresnel.at(cos).map(|f| f * energy::saturate(f, x))
    }

    pub(super) fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        if self.is_smooth() || !same_side(wo, wi) {
            return 0.0;
        }
        let (wo, wi) = upright(wo, wi);
        let (m, _) = half_vector(wo, wi);
        0.25 * self.microfacets.held().visible_over_cos(wo, m)
    }

    pub(super) fn sample(&self, wo: Vec3, u: Vec2) -> Option<BsdfSample> {
        if self.is_smooth() {
            let wi = Vec3::new(-wo.x, -wo.y, wo.z);
            return BsdfSample::new(wi, self.fresnel.at(wo.z.abs()), 1.0, ScatterKind::MIRROR);
        }
        let side = wo.z.signum();
        let wo = Vec3::new(wo.x, wo.y, wo.z.abs());
        let facets = self.microfacets.held();
        let m = facets.sample(wo, u);
        let cos = wo.dot(m);
        let wi = 2.0 * cos * m - wo;
        if wi.z <= 0.0 {
            return None;
        }
        let weight = self.reflected(&facets, [wo, wi], cos) * facets.g2_over_g1(wo, wi);
        let pdf = 0.25 * facets.visible_over_cos(wo, m);
        BsdfSample::new(Vec3::new(wi.x, wi.y, side * wi.z), weight, pdf, ScatterKind::REFLECTION)
    }

    pub(super) fn albedo(&self, wo: Vec3) -> Spectrum {
        self.fresnel.at(wo.z.abs())
    }
}
