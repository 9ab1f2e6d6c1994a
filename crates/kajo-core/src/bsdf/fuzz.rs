//! Fuzz, microfibers on a surface: the sheen of velvet, dust and peach skin.
//!
//! The volume of microfibers of [Zeltner, Burley and Chiang 2022], as rational fits to its directional albedo `R` and to a
//! cosine lobe mapped by a matrix, whose inverse is `M⁻¹ = (a 0 b; 0 a 0; 0 0 1)` with x in the plane of `v`:
//!
//! ```text
//! f(v, w) = R(v) a² / (π |M⁻¹ w|⁴)
//! ```
//!
//! The horizon maps to itself, so the lobe reflects the share `R` exactly. `v` is the direction to the viewer: the
//! fit is not symmetric.

use std::f32::consts::{FRAC_1_PI, TAU};

use kajo_math::{Vec2, Vec3, fmath, warp};

/// The fuzz as seen from one direction.
#[derive(Clone, Copy)]
pub(super) struct Fuzz {
    /// Share of light that is reflected.
    pub albedo: f32,
    a: f32,
    b: f32,
    /// Unit vector in the surface below the viewer.
    x: Vec2,
}

impl Fuzz {
    /// * `v`: to the viewer, above the surface
    /// * `roughness`: from fibers that lie close, 0, to fibers that stand up, 1
    pub fn new(v: Vec3, roughness: f32) -> Fuzz {
        let (x, y) = (v.z.clamp(0.0, 1.0), roughness.clamp(0.01, 1.0));
        let s = y * (0.020_660_7 + 1.584_91 * y) / (0.037_942_4 + y * (1.322_27 + y));
        let m = y * (-0.193_854 + y * (-1.148_85 + y * (1.7932 - 0.959_43 * y * y))) / (0.046_391 + y);
        let o = y * (0.000_654_023 + (-0.020_781_8 + 0.119_681 * y) * y) / (1.262_64 + y * (-1.920_21 + y));
        let distance = (x - m) / s;
        let albedo = fmath::exp(-0.5 * distance * distance) / (s * TAU.sqrt()) + o;
        let root = (1.0 - x).max(0.0).sqrt();
        Fuzz {
            albedo: albedo.clamp(0.0, 1.0),
            a: (2.581_26 * x + 0.813_703 * y) * y / (1.0 + 0.310_327 * x * x + 2.609_94 * x * y),
            b: root * (y - 1.0) * y * y * y
                / (0.000_025_405_3 + 1.712_28 * x - 1.715_06 * x * y + 1.341_74 * y * y),
            x: v.truncate().normalize_or(Vec2::X),
        }
    }

    /// The lobe without `R`, as a density times the inverse cosine: `pdf = shape · wz`.
    pub fn shape(&self, w: Vec3) -> f32 {
        let along = self.x.x * w.x + self.x.y * w.y;
        let across = self.x.x * w.y - self.x.y * w.x;
        let before = Vec3::new(self.a * along + self.b * w.z, self.a * across, w.z);
        let stretch = self.a / before.length_squared();
        FRAC_1_PI * stretch * stretch
    }

    /// A direction above the surface with the density `shape · wz`.
    pub fn sample(&self, u: Vec2) -> Vec3 {
        let before = warp::cosine_hemisphere(u);
        let along = (before.x - self.b * before.z) / self.a;
        let across = before.y / self.a;
        let w =
            Vec3::new(self.x.x * along - self.x.y * across, self.x.y * along + self.x.x * across, before.z);
        w.normalize_or(Vec3::Z)
    }
}
