//! Flat disks and rings.
//!
//! Scene: `Disk { center 0 0 0  normal 0 1 0  radius 1  innerRadius 0.5 }`

use kajo_math::solid_angle::basis64;
use kajo_math::{Aabb, DVec3, Ray, Vec2, Vec3, fmath, warp};

use super::{DiskPatch, Patch, Ray64, Surface, in_range, stored};
use crate::interaction::{Hit, SurfacePoint, Tangents};

/// A two-sided disk, or a ring when the inner radius is not zero.
#[derive(Clone, Copy, Debug)]
pub struct Disk {
    center: DVec3,
    normal: DVec3,
    radius: f64,
    inner_radius: f64,
}

impl Disk {
    /// A disk across `normal`; `None` when the normal is zero.
    pub fn new(center: Vec3, normal: Vec3, radius: f32, inner_radius: f32) -> Option<Disk> {
        Some(Disk {
            center: center.as_dvec3(),
            normal: normal.as_dvec3().try_normalize()?,
            radius: f64::from(radius.abs()),
            inner_radius: f64::from(inner_radius.abs()),
        })
    }
}

impl Surface for Disk {
    fn bounds(&self) -> Aabb {
        let reach = self.radius * (DVec3::ONE - self.normal * self.normal).max(DVec3::ZERO).map(f64::sqrt);
        Aabb { min: (self.center - reach).as_vec3(), max: (self.center + reach).as_vec3() }.padded(1e-6)
    }

    fn is_finite(&self) -> bool {
        let radii = [self.radius, self.inner_radius];
        self.center.is_finite() && self.normal.is_finite() && radii.iter().all(|v| v.is_finite())
    }

    #[inline]
    fn hit(&self, ray: &Ray) -> Option<Hit> {
        let r = Ray64::new(ray);
        let t = self.normal.dot(self.center - r.o) / self.normal.dot(r.d);
        let out = (r.at(t) - self.center).length_squared();
        // False for a NaN too, which a ray in the disk's own plane gives.
        let inside = out <= self.radius * self.radius && out >= self.inner_radius * self.inner_radius;
        let t = in_range(ray, t).filter(|_| inside)?;
        Some(Hit { t, ..Hit::default() })
    }

    fn crossings<F: FnMut(Hit)>(&self, ray: &Ray, visit: F) {
        self.hit(ray).into_iter().for_each(visit);
    }

    fn surface_at(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        let p = Ray64::new(ray).at(hit.t.into());
        let (p, p_error) =
            stored(p - self.normal.dot(p - self.center) * self.normal, self.center.abs().max_element());
        SurfacePoint::flat(p, p_error, self.normal.as_vec3())
    }

    /// `u` runs once around the centre; `v` is 0 at the centre and 1 at the rim.
    fn uv_at(&self, _hit: &Hit, p: Vec3) -> Vec2 {
        let w = (p.as_dvec3() - self.center).as_vec3();
        let (x, y) = warp::basis(self.normal.as_vec3());
        let turn = fmath::atan2(w.dot(y), w.dot(x)) / std::f32::consts::TAU;
        Vec2::new(if turn < 0.0 { turn + 1.0 } else { turn }, w.length() / self.radius as f32)
    }

    /// Around the centre, and outward.
    fn tangents_at(&self, _hit: &Hit, p: Vec3) -> Tangents {
        let w = p.as_dvec3() - self.center;
        let around = std::f64::consts::TAU * self.normal.cross(w);
        let outward = self.radius * w.normalize_or_zero();
        Tangents { dpdu: around.as_vec3(), dpdv: outward.as_vec3() }
    }

    fn patches<F: FnMut(u32, Patch)>(&self, mut visit: F) {
        let (x, y) = basis64(self.normal);
        let inner = self.inner_radius / self.radius;
        visit(
            0,
            Patch::Disk(DiskPatch { center: self.center, axes: [self.radius * x, self.radius * y], inner }),
        );
    }

    fn is_closed(&self) -> bool {
        false
    }

    fn is_curved(&self) -> bool {
        false
    }
}
