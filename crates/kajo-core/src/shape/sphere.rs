//! Spheres.
//!
//! With `m = o - c` the ray meets `|p - c| = r` where
//!
//! ```text
//! (d.d) t^2 + 2 (m.d) t + (m.m - r^2) = 0.
//! ```
//!
//! The discriminant is taken as `(d.d) r^2 - |m x d|^2`: up to the factor `d.d` it is the squared radius
//! less the squared distance from the centre to the line, which keeps its digits when the origin
//! is far away [Haines et al. 2019, eq. 8].
//!
//! Scene: `Sphere { center 0 0 0  radius 1 }`

use std::f32::consts::{PI, TAU};

use kajo_math::{Aabb, DVec3, Ray, Vec2, Vec3, fmath};

use super::{Patch, Ray64, Surface, in_range, stored};
use crate::interaction::{Hit, SurfacePoint, Tangents};

/// A sphere; a radius of zero is never hit.
#[derive(Clone, Copy, Debug)]
pub struct Sphere {
    /// Centre.
    pub center: Vec3,
    /// Radius, not negative.
    pub radius: f32,
}

impl Sphere {
    /// A sphere with the absolute value of `radius`, as the classic format has it.
    pub fn new(center: Vec3, radius: f32) -> Sphere {
        Sphere { center, radius: radius.abs() }
    }

    /// Where the line of a ray meets the sphere, if it does.
    #[inline(always)]
    fn chord(&self, ray: &Ray) -> Option<Chord> {
        let Ray64 { o, d } = Ray64::new(ray);
        let (m, r) = (o - self.center.as_dvec3(), f64::from(self.radius));
        let (h, c) = (m.dot(d), m.dot(m) - r * r);
        if h > 0.0 && c > 0.0 && ray.t_min >= 0.0 {
            return None; // Outside and going away, as most rays that have just left this sphere.
        }
        let (a, across) = (d.dot(d), m.cross(d));
        let discriminant = a * (r * r) - across.dot(across);
        if r == 0.0 || discriminant.is_nan() || discriminant < 0.0 {
            return None;
        }
        Some(Chord { a, h, c, root: discriminant.sqrt() })
    }
}

/// A quadratic `a t^2 + 2 h t + c` with the root of its discriminant; both solutions without cancellation.
struct Chord {
    a: f64,
    h: f64,
    c: f64,
    root: f64,
}

impl Chord {
    #[inline]
    fn entry(&self) -> f64 {
        if self.h > 0.0 { -(self.h + self.root) / self.a } else { self.product_over(self.root - self.h) }
    }

    #[inline]
    fn exit(&self) -> f64 {
        if self.h > 0.0 { self.product_over(-(self.h + self.root)) } else { (self.root - self.h) / self.a }
    }

    /// The other solution of `q / a`: their product is `c / a`.
    #[inline]
    fn product_over(&self, q: f64) -> f64 {
        if q == 0.0 { 0.0 } else { self.c / q }
    }
}

impl Surface for Sphere {
    fn bounds(&self) -> Aabb {
        let r = Vec3::splat(self.radius);
        Aabb { min: self.center - r, max: self.center + r }.padded(1e-6)
    }

    fn is_finite(&self) -> bool {
        self.center.is_finite() && self.radius.is_finite()
    }

    #[inline(always)]
    fn hit(&self, ray: &Ray) -> Option<Hit> {
        let chord = self.chord(ray)?;
        let t = in_range(ray, chord.entry()).or_else(|| in_range(ray, chord.exit()))?;
        Some(Hit { t, ..Hit::default() })
    }

    fn crossings<F: FnMut(Hit)>(&self, ray: &Ray, mut visit: F) {
        if let Some(chord) = self.chord(ray) {
            for t in [chord.entry(), chord.exit()].into_iter().filter_map(|t| in_range(ray, t)) {
                visit(Hit { t, ..Hit::default() });
            }
        }
    }

    #[inline(always)]
    fn surface_at(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        let center = self.center.as_dvec3();
        let n = (Ray64::new(ray).at(hit.t.into()) - center).normalize_or(DVec3::Z);
        let (p, p_error) = stored(center + f64::from(self.radius) * n, center.abs().max_element());
        SurfacePoint::flat(p, p_error, n.as_vec3())
    }

    /// `u` runs once around the y axis, starting at +z towards +x; `v` from the south pole to the north.
    fn uv_at(&self, _hit: &Hit, p: Vec3) -> Vec2 {
        let n = ((p - self.center) / self.radius).clamp(Vec3::NEG_ONE, Vec3::ONE);
        let turn = fmath::atan2(n.x, n.z) / TAU;
        let u = if turn < 0.0 { turn + 1.0 } else { turn };
        Vec2::new(u, 0.5 + fmath::asin(n.y) / PI)
    }

    /// Along the circle of latitude and up the meridian, of which the poles have none.
    fn tangents_at(&self, _hit: &Hit, p: Vec3) -> Tangents {
        let w = p - self.center;
        let across = (w.x * w.x + w.z * w.z).sqrt();
        if across == 0.0 {
            return Tangents::default();
        }
        let up = Vec3::new(-w.y * w.x / across, across, -w.y * w.z / across);
        Tangents { dpdu: TAU * Vec3::new(w.z, 0.0, -w.x), dpdv: PI * up }
    }

    fn patches<F: FnMut(u32, Patch)>(&self, mut visit: F) {
        visit(0, Patch::Sphere { center: self.center.as_dvec3(), radius: self.radius.into() });
    }

    fn is_closed(&self) -> bool {
        true
    }
}
