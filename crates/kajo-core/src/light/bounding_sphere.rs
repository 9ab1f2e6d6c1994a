//! The sphere around a scene, which light from infinitely far away is aimed at.

use std::f32::consts::PI;

use kajo_math::{Aabb, Frame, Vec2, Vec3, warp};

/// A sphere around everything that has bounds.
#[derive(Clone, Copy, Debug)]
pub struct BoundingSphere {
    /// Its center.
    pub center: Vec3,
    /// Its radius.
    pub radius: f32,
}

impl BoundingSphere {
    /// A little more room than the box needs, so that rounding puts nothing outside.
    const MARGIN: f32 = 1.001;

    /// The sphere around a box; around the origin when that is empty.
    pub fn around(bounds: &Aabb) -> BoundingSphere {
        if bounds.is_empty() {
            return BoundingSphere { center: Vec3::ZERO, radius: 1.0 };
        }
        let radius = BoundingSphere::MARGIN * 0.5 * bounds.extent().length();
        BoundingSphere { center: bounds.center(), radius: radius.max(f32::MIN_POSITIVE) }
    }

    /// Area of the disk that it is seen as from far away.
    pub fn cross_section(&self) -> f32 {
        PI * self.radius * self.radius
    }

    /// A point of the disk before the sphere, from which light travels along the unit vector `d`.
    pub(super) fn sample_disk(&self, u: Vec2, d: Vec3) -> Vec3 {
        let across = self.radius * warp::concentric_disk(u).extend(0.0);
        self.center - self.radius * d + Frame::from_normal(d).to_world(across)
    }

    /// Density per area of the point of the disk from which light along `d` comes to `p`; 0 where it does not.
    pub(super) fn pdf_disk(&self, p: Vec3, d: Vec3) -> f32 {
        let offset = p - self.center;
        let along = offset.dot(d);
        let aside = offset - along * d;
        let lit = along >= -self.radius && aside.length_squared() <= self.radius * self.radius;
        if lit { 1.0 / self.cross_section() } else { 0.0 }
    }
}
