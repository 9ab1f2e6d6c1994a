//! Infinite planes `n.p = offset`.
//!
//! Scene: `Plane { normal 0 1 0  offset -1 }`; the normal is normalised, the offset is not rescaled.

use kajo_math::{Aabb, DVec3, Ray, Vec2, Vec3, warp};

use super::{Ray64, Surface, in_range, stored};
use crate::interaction::{Hit, SurfacePoint, Tangents};

/// An infinite, two-sided plane.
#[derive(Clone, Copy, Debug)]
pub struct Plane {
    normal: DVec3,
    offset: f64,
}

impl Plane {
    /// The plane through all `p` with `p . n = offset`, where `n` is `normal` brought to unit length.
    ///
    /// A zero normal gives a plane that no ray hits.
    pub fn new(normal: DVec3, offset: f64) -> Plane {
        Plane { normal: normal.normalize_or_zero(), offset }
    }

    /// The unit normal.
    pub fn normal(&self) -> Vec3 {
        self.normal.as_vec3()
    }

    /// Distance from the origin along the normal.
    pub fn offset(&self) -> f64 {
        self.offset
    }
}

impl Surface for Plane {
    fn bounds(&self) -> Aabb {
        Aabb::EVERYWHERE
    }

    fn is_finite(&self) -> bool {
        self.normal.is_finite() && self.offset.is_finite()
    }

    #[inline(always)]
    fn hit(&self, ray: &Ray) -> Option<Hit> {
        let Ray64 { o, d } = Ray64::new(ray);
        let (height, speed) = (self.offset - self.normal.dot(o), self.normal.dot(d));
        if height * speed < 0.0 && ray.t_min >= 0.0 {
            return None; // Going away.
        }
        // Parallel rays divide by zero and fall out of the range as infinite or NaN.
        let t = height / speed;
        let t = in_range(ray, t).filter(|t| t.is_finite())?;
        Some(Hit { t, ..Hit::default() })
    }

    fn crossings<F: FnMut(Hit)>(&self, ray: &Ray, visit: F) {
        self.hit(ray).into_iter().for_each(visit);
    }

    #[inline]
    fn surface_at(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        let p = Ray64::new(ray).at(hit.t.into());
        let onto = p - (self.normal.dot(p) - self.offset) * self.normal;
        let (p, p_error) = stored(onto, self.offset.abs());
        SurfacePoint::flat(p, p_error, self.normal.as_vec3())
    }

    /// Lengths along two perpendicular directions in the plane; not confined to [0, 1].
    fn uv_at(&self, _hit: &Hit, p: Vec3) -> Vec2 {
        let (s, t) = warp::basis(self.normal());
        Vec2::new(p.dot(s), p.dot(t))
    }

    fn tangents_at(&self, _hit: &Hit, _p: Vec3) -> Tangents {
        let (dpdu, dpdv) = warp::basis(self.normal());
        Tangents { dpdu, dpdv }
    }

    fn is_closed(&self) -> bool {
        false
    }

    fn is_curved(&self) -> bool {
        false
    }

    /// It bounds the half of space that its normal points away from.
    fn is_solid(&self) -> bool {
        true
    }

    fn starts_inside(&self, ray: &Ray) -> bool {
        let speed = self.normal.dot(ray.d.as_dvec3());
        speed > 0.0 || (speed == 0.0 && self.normal.dot(ray.o.as_dvec3()) < self.offset)
    }
}
