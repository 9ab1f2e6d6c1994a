//! Cylinders, cones and truncated cones.
//!
//! Along the unit axis `a` from the base `b` the radius is `r(s) = r0 + k s`. With
//! `w = o - b`, `s = w.a + t d.a`, a point of the side satisfies
//!
//! ```text
//! |w + t d|^2 - s^2 = r(s)^2,
//! ```
//!
//! a quadratic in `t`. The origin is first moved along the ray to the point nearest the base,
//! so that far-away rays lose no digits.
//!
//! Scene: `Cylinder { base 0 0 0  top 0 2 0  radius 1 }`
//! Scene: `Cone { base 0 0 0  top 0 2 0  radius 1  topRadius 0  capped on }`

use kajo_math::solid_angle::basis64;
use kajo_math::{Aabb, DAffine3, DMat3, DVec3, Ray, Vec2, Vec3, fmath, roots, warp};

use super::{Canonical, DiskPatch, Patch, Ray64, Surface, in_range, nearest_crossing, stored};
use crate::interaction::{Hit, SurfacePoint, Tangents};

const SIDE: u32 = 0;
const BASE: u32 = 1;
const TOP: u32 = 2;

/// A cone cut off by two planes across its axis; a cylinder when both radii agree.
///
/// A hit's part is 0 for the side, 1 for the base and 2 for the top.
#[derive(Clone, Copy, Debug)]
pub struct Cone {
    base: DVec3,
    axis: DVec3,
    height: f64,
    base_radius: f64,
    top_radius: f64,
    capped: bool,
}

impl Cone {
    /// A cone from `base` to `top`; the radii are taken as absolute values.
    ///
    /// `None` when base and top coincide.
    pub fn new(base: Vec3, top: Vec3, base_radius: f32, top_radius: f32, capped: bool) -> Option<Cone> {
        let along = top.as_dvec3() - base.as_dvec3();
        let (axis, height) = (along.try_normalize()?, along.length());
        let (base_radius, top_radius) = (f64::from(base_radius.abs()), f64::from(top_radius.abs()));
        Some(Cone { base: base.as_dvec3(), axis, height, base_radius, top_radius, capped })
    }

    fn slope(&self) -> f64 {
        (self.top_radius - self.base_radius) / self.height
    }
}

impl Surface for Cone {
    fn bounds(&self) -> Aabb {
        // A disk of radius r across the unit axis a reaches r sqrt(1 - a_i^2) along axis i.
        let reach = (DVec3::ONE - self.axis * self.axis).max(DVec3::ZERO).map(f64::sqrt);
        let disk = |c: DVec3, r: f64| Aabb { min: (c - r * reach).as_vec3(), max: (c + r * reach).as_vec3() };
        let top = self.base + self.height * self.axis;
        disk(self.base, self.base_radius).union(disk(top, self.top_radius)).padded(1e-6)
    }

    fn is_finite(&self) -> bool {
        let numbers = [self.height, self.base_radius, self.top_radius];
        self.base.is_finite() && self.axis.is_finite() && numbers.iter().all(|v| v.is_finite())
    }

    #[inline]
    fn hit(&self, ray: &Ray) -> Option<Hit> {
        nearest_crossing(self, ray)
    }

    fn crossings<F: FnMut(Hit)>(&self, ray: &Ray, mut visit: F) {
        let Ray64 { o, d } = Ray64::new(ray);
        let shift = -(o - self.base).dot(d) / d.dot(d);
        let w = o + shift * d - self.base;
        let (k, s0, da) = (self.slope(), w.dot(self.axis), d.dot(self.axis));
        let r0 = self.base_radius + k * s0;
        let mut emit = |t: f64, part: u32| {
            if let Some(t) = in_range(ray, t + shift) {
                visit(Hit { t, part, ..Hit::default() });
            }
        };

        let a = d.dot(d) - da * da * (1.0 + k * k);
        let h = w.dot(d) - s0 * da - r0 * k * da;
        let c = w.dot(w) - s0 * s0 - r0 * r0;
        if let Some((t0, t1)) = roots::quadratic(a, h, c) {
            let on_side = |t: f64| (0.0..=self.height).contains(&(s0 + t * da));
            if on_side(t0) {
                emit(t0, SIDE);
            }
            if t1 != t0 && on_side(t1) {
                emit(t1, SIDE);
            }
        }
        if self.capped && da != 0.0 {
            for (s, radius, part) in [(0.0, self.base_radius, BASE), (self.height, self.top_radius, TOP)] {
                let t = (s - s0) / da;
                let across = w + t * d - s * self.axis;
                // Strict: the rim belongs to the side, so that a crossing there counts once.
                if across.length_squared() < radius * radius {
                    emit(t, part);
                }
            }
        }
    }

    fn surface_at(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        let w = Ray64::new(ray).at(hit.t.into()) - self.base;
        let s = w.dot(self.axis);
        let across = w - s * self.axis;
        let (onto, n) = match hit.part {
            BASE => (across, -self.axis),
            TOP => (across + self.height * self.axis, self.axis),
            _ => {
                let radial = across.normalize_or(self.axis);
                let radius = (self.base_radius + self.slope() * s).max(0.0);
                (radius * radial + s * self.axis, (radial - self.slope() * self.axis).normalize())
            }
        };
        let (p, p_error) = stored(self.base + onto, self.base.abs().max_element());
        SurfacePoint::flat(p, p_error, n.as_vec3())
    }

    /// `u` runs once around the axis; `v` from base to top, or outward on a cap.
    fn uv_at(&self, hit: &Hit, p: Vec3) -> Vec2 {
        let w = (p.as_dvec3() - self.base).as_vec3();
        let axis = self.axis.as_vec3();
        let (x, y) = warp::basis(axis);
        let turn = fmath::atan2(w.dot(y), w.dot(x)) / std::f32::consts::TAU;
        let u = if turn < 0.0 { turn + 1.0 } else { turn };
        let s = w.dot(axis);
        let v = match hit.part {
            BASE => (w - s * axis).length() / self.base_radius as f32,
            TOP => (w - s * axis).length() / self.top_radius as f32,
            _ => s / self.height as f32,
        };
        Vec2::new(u, v)
    }

    /// Around the axis; along the side, or outward on a cap.
    fn tangents_at(&self, hit: &Hit, p: Vec3) -> Tangents {
        let w = p.as_dvec3() - self.base;
        let across = w - w.dot(self.axis) * self.axis;
        let radial = across.normalize_or_zero();
        let outward = match hit.part {
            BASE => self.base_radius * radial,
            TOP => self.top_radius * radial,
            _ => self.height * (self.axis + self.slope() * radial),
        };
        let around = std::f64::consts::TAU * self.axis.cross(across);
        Tangents { dpdu: around.as_vec3(), dpdv: outward.as_vec3() }
    }

    fn patches<F: FnMut(u32, Patch)>(&self, mut visit: F) {
        let (x, y) = basis64(self.axis);
        let columns = DMat3::from_cols(x, y, self.height * self.axis);
        let map = DAffine3 { matrix3: columns, translation: self.base };
        let side = Patch::curved(Canonical::Frustum([self.base_radius, self.top_radius]), map);
        side.into_iter().for_each(|side| visit(SIDE, side));
        if self.capped {
            let cap = |center: DVec3, x: DVec3, y: DVec3| DiskPatch { center, axes: [x, y], inner: 0.0 };
            let (r, s) = (self.base_radius, self.top_radius);
            if r > 0.0 {
                visit(BASE, Patch::Disk(cap(self.base, r * y, r * x)));
            }
            if s > 0.0 {
                visit(TOP, Patch::Disk(cap(self.base + self.height * self.axis, s * x, s * y)));
            }
        }
    }

    fn is_closed(&self) -> bool {
        self.capped
    }

    fn part_count(&self) -> u32 {
        TOP + 1
    }
}
