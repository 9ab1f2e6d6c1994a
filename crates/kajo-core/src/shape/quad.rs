//! Parallelograms.
//!
//! Points are `corner + u edge1 + v edge2` with `u` and `v` in [0, 1]. With the reciprocal
//! vectors `e1* = (e2 x n)/(e1 . (e2 x n))` and likewise `e2*`, the coordinates of a point `p` of the
//! plane are dot products.
//!
//! Scene: `Quad { corner -1 0 -1  edge1 2 0 0  edge2 0 0 2 }`

use kajo_math::{Aabb, DVec3, Ray, Vec2, Vec3};

use super::{Patch, Ray64, Surface, in_range, stored};
use crate::interaction::{Hit, SurfacePoint, Tangents};

/// A two-sided parallelogram; its normal is `edge1 x edge2`.
#[derive(Clone, Copy, Debug)]
pub struct Quad {
    corner: DVec3,
    edges: [DVec3; 2],
    normal: DVec3,
    /// Reciprocal vectors of the edges within the plane.
    dual: [DVec3; 2],
}

impl Quad {
    /// The parallelogram at `corner` between two edges; `None` when it has no area.
    pub fn new(corner: Vec3, edge1: Vec3, edge2: Vec3) -> Option<Quad> {
        let (e1, e2) = (edge1.as_dvec3(), edge2.as_dvec3());
        let area = e1.cross(e2);
        let normal = area.try_normalize()?;
        let dual = [e2.cross(area), area.cross(e1)].map(|v| v / area.length_squared());
        Some(Quad { corner: corner.as_dvec3(), edges: [e1, e2], normal, dual })
    }
}

impl Surface for Quad {
    fn bounds(&self) -> Aabb {
        let [e1, e2] = self.edges;
        let corners = [self.corner, self.corner + e1, self.corner + e2, self.corner + e1 + e2];
        Aabb::around(corners.map(|c| c.as_vec3())).padded(1e-6)
    }

    fn is_finite(&self) -> bool {
        self.corner.is_finite() && self.edges.iter().chain(&self.dual).all(|v| v.is_finite())
    }

    #[inline]
    fn hit(&self, ray: &Ray) -> Option<Hit> {
        let r = Ray64::new(ray);
        let t = self.normal.dot(self.corner - r.o) / self.normal.dot(r.d);
        let stored = in_range(ray, t)?;
        let w = r.at(t) - self.corner;
        let [u, v] = self.dual.map(|e| e.dot(w));
        let inside = (0.0..=1.0).contains(&u) && (0.0..=1.0).contains(&v);
        inside.then_some(Hit { t: stored, u: u as f32, v: v as f32, part: 0 })
    }

    fn crossings<F: FnMut(Hit)>(&self, ray: &Ray, visit: F) {
        self.hit(ray).into_iter().for_each(visit);
    }

    fn surface_at(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        let p = Ray64::new(ray).at(hit.t.into());
        let (p, p_error) =
            stored(p - self.normal.dot(p - self.corner) * self.normal, self.corner.abs().max_element());
        SurfacePoint::flat(p, p_error, self.normal.as_vec3())
    }

    fn hit_at(&self, part: u32, p: Vec3) -> Hit {
        let w = p.as_dvec3() - self.corner;
        let [u, v] = self.dual.map(|e| e.dot(w) as f32);
        Hit { t: 0.0, u, v, part }
    }

    fn uv_at(&self, hit: &Hit, _p: Vec3) -> Vec2 {
        Vec2::new(hit.u, hit.v)
    }

    /// The edges.
    fn tangents_at(&self, _hit: &Hit, _p: Vec3) -> Tangents {
        let [dpdu, dpdv] = self.edges.map(|e| e.as_vec3());
        Tangents { dpdu, dpdv }
    }

    fn patches<F: FnMut(u32, Patch)>(&self, mut visit: F) {
        visit(0, Patch::parallelogram(self.corner, self.edges));
    }

    fn is_closed(&self) -> bool {
        false
    }

    fn is_curved(&self) -> bool {
        false
    }
}
