//! A surface made of tiny mirrors: how their normals are distributed, and which of them are seen.
//!
//! With `m` a facet normal in local coordinates and `t² = (mx/αx)² + (my/αy)²`:
//!
//! ```text
//! GGX        D(m) = 1 / (π αx αy (t² + mz²)²)                 Λ(w) = (√(1 + a²) - 1) / 2
//! Beckmann   D(m) = exp(-t²/mz²) / (π αx αy mz⁴)              Λ(w) = (erf(1/a) - 1) / 2 + a exp(-1/a²) / (2√π)
//!
//!            a² = ((αx wx)² + (αy wy)²) / wz²
//! ```
//!
//! The facets that `w` sees have the density `D_w(m) = G1(w) max(0, w·m) D(m) / |wz|` with
//! `G1 = 1/(1 + Λ(w))`; seen from both `wo` and `wi` is the share `G2 = 1/(1 + Λ(wo) + Λ(wi))`.
//! [Walter et al. 2007], [Heitz 2014]; anisotropy by stretching.
//!
//! Facets are drawn from `D_w`: for GGX through the spherical cap that a hemisphere of mirrors reflects into
//! [Dupuy and Benyoub 2023], for Beckmann by inverting the distribution of slopes.

use std::f32::consts::PI;

use kajo_math::{Vec2, Vec3, fmath};

/// Below this roughness a surface is a mirror: single precision cannot hold the lobe.
pub const SMOOTH: f32 = 1e-3;

/// A distribution of facet normals, of any width.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum NormalDistribution {
    /// Long tails; also known as Trowbridge-Reitz.
    #[default]
    Ggx,
    /// Gaussian slopes.
    Beckmann,
}

/// Distribution of facet normals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Microfacets {
    /// Shape of the distribution.
    pub shape: NormalDistribution,
    /// Roughness along the local x axis.
    pub alpha_x: f32,
    /// Roughness along the local y axis.
    pub alpha_y: f32,
}

/// The half vector of two unit directions on the same side, zero where they are opposite, and the cosine of both with it.
///
/// The cosine is half the length of their sum. Where they are nearly opposite, rounded unit vectors have two different dot products with
/// the half vector, and Fresnel's term by one of them would not be the same both ways.
#[inline]
pub(super) fn half_vector(wo: Vec3, wi: Vec3) -> (Vec3, f32) {
    let sum = wo + wi;
    (sum.normalize_or_zero(), 0.5 * sum.length())
}

impl Microfacets {
    /// The same roughness in every direction, in [0, 1].
    pub fn new(shape: NormalDistribution, alpha: f32) -> Microfacets {
        Microfacets { shape, alpha_x: alpha, alpha_y: alpha }
    }

    /// Facets that are rougher along x than along y.
    ///
    /// * `alpha`: the root of the mean square of both roughnesses
    /// * `anisotropy`: in [0, 1], one minus the lesser roughness over the greater [OpenPBR 1.1, sec. 3.4.1]
    pub fn brushed(shape: NormalDistribution, alpha: f32, anisotropy: f32) -> Microfacets {
        let aspect = 1.0 - anisotropy;
        let alpha_x = alpha * (2.0 / (1.0 + aspect * aspect)).sqrt();
        Microfacets { shape, alpha_x, alpha_y: aspect * alpha_x }
    }

    /// The exponent of the Phong highlight that is about as wide.
    pub fn exponent(&self) -> f32 {
        (2.0 / (self.alpha_x * self.alpha_y).max(1e-4) - 2.0).max(1.0)
    }

    /// Whether the surface is to be treated as a perfect mirror.
    #[inline]
    pub fn is_smooth(&self) -> bool {
        self.alpha_x.max(self.alpha_y) < SMOOTH
    }

    /// The distribution with neither roughness so small that single precision cannot hold the lobe.
    #[inline]
    pub(super) fn held(&self) -> Microfacets {
        let hold = |alpha: f32| alpha.clamp(SMOOTH, 1.0);
        Microfacets { shape: self.shape, alpha_x: hold(self.alpha_x), alpha_y: hold(self.alpha_y) }
    }

    /// Density `D(m)` of facets with unit normal `m`: projected on the surface they cover it once, `∫ D(m) mz dm = 1`.
    ///
    /// Of GGX off by at most 1e-6 of itself.
    #[inline]
    pub fn d(&self, m: Vec3) -> f32 {
        // Nearer to the surface nothing is left of a lobe but trouble with small numbers.
        if m.z < 1e-8 {
            return 0.0;
        }
        let t2 = sqr(m.x / self.alpha_x) + sqr(m.y / self.alpha_y);
        let area = PI * self.alpha_x * self.alpha_y;
        let z2 = m.z * m.z;
        match self.shape {
            NormalDistribution::Ggx => 1.0 / (area * sqr(t2 + z2)),
            NormalDistribution::Beckmann => fmath::exp(-t2 / z2) / (area * z2 * z2),
        }
    }

    /// The lobe of facets that are perfect mirrors, with the cosine of `wi`: `D(m) G2 / (4 cos θo)`.
    ///
    /// * `wo`, `wi`: unit directions above the surface
    /// * `m`: their half vector
    #[inline]
    pub(super) fn mirror_lobe(&self, wo: Vec3, wi: Vec3, m: Vec3) -> f32 {
        self.d(m) * self.g2(wo, wi) / (4.0 * wo.z)
    }

    /// Smith's `Λ(w)`: how much more area is hidden from the unit direction `w` than it sees.
    #[inline]
    pub fn lambda(&self, w: Vec3) -> f32 {
        let a2 = (sqr(self.alpha_x * w.x) + sqr(self.alpha_y * w.y)) / (w.z * w.z);
        // Along the surface as good as infinite, but a number.
        let a2 = a2.min(1e30);
        match self.shape {
            // The same as (√(1 + a²) - 1)/2 and exact for small a.
            NormalDistribution::Ggx => 0.5 * a2 / (1.0 + (1.0 + a2).sqrt()),
            NormalDistribution::Beckmann => {
                let a = a2.sqrt();
                if a < 0.2 {
                    // Less than 1e-12.
                    return 0.0;
                }
                let gauss = fmath::exp(-1.0 / a2) * a * (0.5 / PI.sqrt());
                (0.5 * (fmath::erf(1.0 / a) - 1.0) + gauss).max(0.0)
            }
        }
    }

    /// Share of the facets turned to `w` that `w` sees; of GGX off by at most 4e-7 of itself.
    #[inline]
    pub fn g1(&self, w: Vec3) -> f32 {
        1.0 / (1.0 + self.lambda(w))
    }

    /// Share of facets that both directions see; heights of the surface are correlated [Heitz 2014, eq. 99].
    #[inline]
    pub fn g2(&self, wo: Vec3, wi: Vec3) -> f32 {
        1.0 / (1.0 + self.lambda(wo) + self.lambda(wi))
    }

    /// `G2/G1(wo)`: the share of the facets seen from `wo` that `wi` sees too.
    #[inline]
    pub fn g2_over_g1(&self, wo: Vec3, wi: Vec3) -> f32 {
        let seen = 1.0 + self.lambda(wo);
        seen / (seen + self.lambda(wi))
    }

    /// Share of facets seen from one side of a clear boundary through which light reaches `wi` on the other. What hides
    /// one direction hides the other, so that an index next to 1 lets everything pass.
    #[inline]
    pub(super) fn through(&self, wo: Vec3, wi: Vec3) -> f32 {
        1.0 / (1.0 + self.lambda(wo).max(self.lambda(wi)))
    }

    /// Density, per solid angle, of the normals seen from `w`, `w.z > 0`.
    #[inline]
    pub fn visible(&self, w: Vec3, m: Vec3) -> f32 {
        self.visible_over_cos(w, m) * w.dot(m).max(0.0)
    }

    /// The density of visible normals without its factor `w·m`: four times the pdf of mirror directions.
    #[inline]
    pub(super) fn visible_over_cos(&self, w: Vec3, m: Vec3) -> f32 {
        self.d(m) / (w.z * (1.0 + self.lambda(w)))
    }

    /// A normal as seen from `w`, `w.z > 0`, for `u` uniform in [0, 1)²; its density is [`visible`](Self::visible).
    ///
    /// Of GGX off by at most 1e-3: at the pole of a hemisphere, where heights that single precision tells apart are so far from each
    /// other; elsewhere by some 1e-7.
    #[inline]
    pub fn sample(&self, w: Vec3, u: Vec2) -> Vec3 {
        let stretched = Vec3::new(self.alpha_x * w.x, self.alpha_y * w.y, w.z).normalize();
        let m = match self.shape {
            NormalDistribution::Ggx => sample_ggx(stretched, u),
            NormalDistribution::Beckmann => sample_beckmann(stretched, u),
        };
        Vec3::new(self.alpha_x * m.x, self.alpha_y * m.y, m.z.max(0.0)).normalize_or(Vec3::Z)
    }
}

/// A visible normal of GGX with `α = 1`, not normalised: the facets are a hemisphere, whose mirror images of `w`
/// are uniform over the cap `z > -wz` [Dupuy and Benyoub 2023, listing 3].
#[inline]
fn sample_ggx(w: Vec3, u: Vec2) -> Vec3 {
    let z = (1.0 - u.y) * (1.0 + w.z) - w.z;
    let r = (1.0 - z * z).clamp(0.0, 1.0).sqrt();
    let (s, c) = fmath::sin_cos(2.0 * PI * u.x);
    Vec3::new(r * c, r * s, z) + w
}

/// A visible normal of Beckmann's distribution with `α = 1`, not normalised.
///
/// Across the plane of `w` slopes are Gaussian. Along it a slope `s` is seen in proportion to
/// `(cos + s sin)⁺ exp(-s²)`.
fn sample_beckmann(w: Vec3, u: Vec2) -> Vec3 {
    let sin = w.truncate().length();
    let along = slope(sin, w.z, u.x);
    let across = slope(0.0, 1.0, u.y);
    let (c, s) = if sin > 0.0 { (w.x / sin, w.y / sin) } else { (1.0, 0.0) };
    Vec3::new(c * along - s * across, s * along + c * across, 1.0)
}

/// The slope below which lies the share `u` of what a direction with this sine and cosine sees:
///
/// ```text
/// ∫ (cos + t sin) exp(-t²)/√π dt = cos (erf s + erf b)/2 + sin (exp(-b²) - exp(-s²)) / (2√π),  t from -b to s
/// ```
///
/// with `b = cos/sin`, where facets turn away. Newton's method, kept within its bracket by bisection.
///
/// The share below the result is off by at most 1.1e-6, and by 7e-8 on average; `u` is a multiple of 6e-8.
fn slope(sin: f32, cos: f32, u: f32) -> f32 {
    /// Beyond this slope there is an eighth of 2^-24 of a Gaussian.
    const FAR: f32 = 4.0;
    const ROOT_PI: f32 = 1.772_453_9;
    let b = if cos < FAR * sin { cos / sin } else { FAR };
    let gauss = |s: f32| fmath::exp(-s * s);
    let primitive = |s: f32| 0.5 * (cos * fmath::erf(s) - sin * gauss(s) / ROOT_PI);
    let (bottom, top) = (primitive(-b), primitive(FAR));
    let target = bottom + u * (top - bottom);
    let (mut low, mut high) = (-b, FAR);
    let mut s = (2.0 * u - 1.0).clamp(low, high);
    for _ in 0..32 {
        let error = primitive(s) - target;
        if error > 0.0 {
            high = s
        } else {
            low = s
        }
        let seen = cos + s * sin;
        let step = error * ROOT_PI / (seen * gauss(s));
        // Of so small a step the square is left, which is rounding.
        if step.abs() <= 1e-3 * seen {
            return (s - step).clamp(-b, FAR);
        }
        let next = s - step;
        s = if next > low && next < high { next } else { 0.5 * (low + high) };
    }
    s
}

#[inline]
fn sqr(x: f32) -> f32 {
    x * x
}
