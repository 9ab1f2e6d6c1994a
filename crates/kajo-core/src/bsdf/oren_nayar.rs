//! Diffusion by a rough surface, such as clay or the moon: brighter towards the light than Lambert's law has it.
//!
//! The energy-preserving Oren-Nayar model [Portsmouth, Kutz and Hill 2024], with `r` the roughness, `ρ` the albedo of
//! a facet and `s = wi·wo - cos θi cos θo`:
//!
//! ```text
//! f  =  ρ/π A (1 + r s/t)  +  ρms/π (1 - E(θo)) (1 - E(θi)) / (1 - Eavg),    t = max(cos θi, cos θo) if s > 0, else 1
//!
//! A = 1 / (1 + (1/2 - 2/(3π)) r)        Eavg = A (1 + (2/3 - 28/(15π)) r)        ρms = ρ² Eavg / (1 - ρ (1 - Eavg))
//!
//! E(θ) = A + A r/π (sin θ (θ - sin θ cos θ) + 2/3 (sin θ/cos θ (1 - sin³ θ) - sin θ))
//! ```
//!
//! The first term is light scattered once [Fujii 2012], `E` its albedo for `ρ = 1`; the second is light scattered again
//! and again. A white surface reflects everything.
//!
//! Directions come from a linearly transformed cosine clipped to what is above the surface, mixed with a uniform
//! hemisphere; coefficients are those of the paper's listing 2.

use std::f32::consts::{FRAC_1_PI, PI};

use kajo_color::Spectrum;
use kajo_math::{Vec2, Vec3, fmath, warp};

use super::{BsdfSample, ScatterKind, same_side, upright};

/// Rough diffuse reflection.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrenNayar {
    /// Albedo of a facet, in [0, 1].
    pub reflectance: Spectrum,
    /// From 0, Lambert's law, to 1.
    pub roughness: f32,
}

/// Quantities that depend on the roughness alone.
struct Single {
    /// `A`.
    a: f32,
    /// `Eavg`.
    average: f32,
}

impl OrenNayar {
    fn single(&self) -> Single {
        let a = 1.0 / (1.0 + (0.5 - 2.0 / (3.0 * PI)) * self.roughness);
        Single { a, average: a * (1.0 + (2.0 / 3.0 - 28.0 / (15.0 * PI)) * self.roughness) }
    }

    /// `E(θ)`: the albedo of light scattered once, for white facets.
    fn single_albedo(&self, cos: f32, a: f32) -> f32 {
        let sin = (1.0 - cos * cos).max(0.0).sqrt();
        // 1 - sin³ without cancellation, over the cosine.
        let tip = cos * (1.0 + sin + sin * sin) / (1.0 + sin);
        let g = sin * (fmath::acos(cos.min(1.0)) - sin * cos) + 2.0 / 3.0 * (sin * tip - sin);
        a * (1.0 + self.roughness * FRAC_1_PI * g)
    }

    /// `ρms` over `1 - Eavg`; zero for a smooth surface, which scatters only once.
    fn multiple(&self, average: f32) -> Spectrum {
        let lost = 1.0 - average;
        if lost < 1e-6 {
            return Spectrum::BLACK;
        }
        self.reflectance.map(|rho| rho * rho * average / (lost * (1.0 - rho * lost)))
    }

    /// The value and the cosine of `wi`, off by at most 1e-6.
    pub(super) fn eval(&self, wo: Vec3, wi: Vec3) -> Spectrum {
        if !same_side(wo, wi) {
            return Spectrum::BLACK;
        }
        let (wo, wi) = upright(wo, wi);
        let Single { a, average } = self.single();
        let s = wo.x * wi.x + wo.y * wi.y;
        let s_over_t = if s > 0.0 { s / wo.z.max(wi.z) } else { s };
        let once = self.reflectance * (a * (1.0 + self.roughness * s_over_t));
        let lost = |cos| (1.0 - self.single_albedo(cos, a)).max(0.0);
        let again = self.multiple(average) * (lost(wo.z) * lost(wi.z));
        (once + again) * (FRAC_1_PI * wi.z)
    }

    pub(super) fn albedo(&self, wo: Vec3) -> Spectrum {
        let Single { a, average } = self.single();
        let e = self.single_albedo(wo.z.abs(), a);
        self.reflectance * e + self.multiple(average) * ((1.0 - e).max(0.0) * (1.0 - average))
    }

    /// Probability of the uniform hemisphere.
    fn uniform_share(&self, cos: f32) -> f32 {
        let r = fmath::pow(self.roughness, 0.1);
        r * (0.162_925 + cos * (-0.372_058 + (0.538_233 - 0.290_822 * cos) * cos))
    }

    pub(super) fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        if !same_side(wo, wi) {
            return 0.0;
        }
        let (wo, wi) = upright(wo, wi);
        let uniform = self.uniform_share(wo.z);
        let lobe = ClippedCosine::new(wo.z, self.roughness);
        uniform * (0.5 * FRAC_1_PI) + (1.0 - uniform) * lobe.pdf(to_lobe(wo, wi))
    }

    pub(super) fn sample(&self, wo: Vec3, u: Vec2, uc: f32) -> Option<BsdfSample> {
        let side = wo.z.signum();
        let above = Vec3::new(wo.x, wo.y, wo.z.abs());
        let wi = if uc < self.uniform_share(above.z) {
            warp::uniform_hemisphere(u)
        } else {
            from_lobe(above, ClippedCosine::new(above.z, self.roughness).sample(u))
        };
        let wi = Vec3::new(wi.x, wi.y, side * wi.z);
        let pdf = self.pdf(wo, wi);
        BsdfSample::new(wi, self.eval(wo, wi) * (1.0 / pdf), pdf, ScatterKind::REFLECTION)
    }
}

/// `w` in coordinates whose x axis lies below `wo`.
fn to_lobe(wo: Vec3, w: Vec3) -> Vec3 {
    let x = wo.truncate().normalize_or(Vec2::X);
    Vec3::new(x.x * w.x + x.y * w.y, x.x * w.y - x.y * w.x, w.z)
}

/// The inverse of [`to_lobe`].
fn from_lobe(wo: Vec3, w: Vec3) -> Vec3 {
    let x = wo.truncate().normalize_or(Vec2::X);
    Vec3::new(x.x * w.x - x.y * w.y, x.y * w.x + x.x * w.y, w.z)
}

/// A cosine lobe mapped by the matrix `M = (a 0 b; 0 c 0; d 0 1)`, its part below the surface cut off beforehand
/// [Portsmouth, Kutz and Hill 2024, sec. 5].
struct ClippedCosine {
    a: f32,
    b: f32,
    c: f32,
    d: f32,
}

impl ClippedCosine {
    fn new(cos: f32, r: f32) -> ClippedCosine {
        ClippedCosine {
            a: 1.0
                + r * (0.303_392 + (-0.518_982 + 0.111_709 * cos) * cos + (-0.276_266 + 0.335_918 * cos) * r),
            b: r * (-1.164_07 + 1.158_59 * cos + (0.150_815 - 0.150_105 * cos) * r)
                / (cos * cos * cos - 1.435_45),
            c: 1.0 + (0.200_13 + (-0.506_373 + 0.261_777 * cos) * cos) * r,
            d: (0.540_852 + (-1.016_25 + 0.475_392 * cos) * cos) * r / (-1.0743 + cos * (0.072_562_8 + cos)),
        }
    }

    /// Share of the disk that stays after clipping by the plane that `M` maps to the horizon.
    fn kept(&self) -> f32 {
        0.5 * (1.0 + 1.0 / (self.d * self.d + 1.0).sqrt())
    }

    fn determinant(&self) -> f32 {
        self.c * (self.a - self.b * self.d)
    }

    /// A direction above the surface, with x below `wo`.
    fn sample(&self, u: Vec2) -> Vec3 {
        let radius = u.x.sqrt();
        let (sin, cos) = fmath::sin_cos(2.0 * PI * u.y);
        let (x, y) = (radius * cos, radius * sin);
        // The clipped disk is a half disk and a half ellipse: squeeze the disk towards the kept side.
        let s = self.kept();
        let x = -((1.0 - s) * (1.0 - y * y).max(0.0).sqrt() + s * x);
        let h = Vec3::new(x, y, (1.0 - x * x - y * y).max(0.0).sqrt());
        Vec3::new(self.a * h.x + self.b * h.z, self.c * h.y, self.d * h.x + h.z).normalize_or(Vec3::Z)
    }

    fn pdf(&self, w: Vec3) -> f32 {
        let ClippedCosine { a, b, c, d } = *self;
        // The adjugate of M times w: the direction before the map, with a length that is its stretch.
        let h = Vec3::new(c * (w.x - b * w.z), (a - b * d) * w.y, c * (a * w.z - d * w.x));
        let stretch = self.determinant() / h.length_squared();
        stretch * stretch * h.z.max(0.0) * FRAC_1_PI / self.kept()
    }
}
