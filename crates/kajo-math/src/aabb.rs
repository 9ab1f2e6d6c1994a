//! Axis-aligned boxes.

use crate::{Affine3A, Ray, Vec3};

/// The set of points between `min` and `max`, both included.
///
/// A box with `min > max` on any axis is empty; [`Aabb::EMPTY`] is the neutral
/// element of [`Aabb::union`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// Smallest corner.
    pub min: Vec3,
    /// Largest corner.
    pub max: Vec3,
}

impl Aabb {
    /// The box that holds nothing.
    pub const EMPTY: Aabb = Aabb { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    /// The box that holds everything: bounds of an infinite plane.
    pub const EVERYWHERE: Aabb = Aabb { min: Vec3::NEG_INFINITY, max: Vec3::INFINITY };

    /// The smallest box around `points`.
    pub fn around(points: impl IntoIterator<Item = Vec3>) -> Aabb {
        points.into_iter().fold(Aabb::EMPTY, Aabb::grown)
    }

    /// The smallest box around this one and the point `p`.
    #[inline]
    pub fn grown(self, p: Vec3) -> Aabb {
        Aabb { min: self.min.min(p), max: self.max.max(p) }
    }

    /// The smallest box around both.
    #[inline]
    pub fn union(self, other: Aabb) -> Aabb {
        Aabb { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// The common part, possibly empty.
    #[inline]
    pub fn intersection(self, other: Aabb) -> Aabb {
        Aabb { min: self.min.max(other.min), max: self.max.min(other.max) }
    }

    /// Whether no point is inside.
    #[inline]
    pub fn is_empty(&self) -> bool {
        !self.min.cmple(self.max).all()
    }

    /// Whether both corners are finite numbers.
    #[inline]
    pub fn is_finite(&self) -> bool {
        self.min.is_finite() && self.max.is_finite()
    }

    /// Whether `p` is inside or on the boundary.
    #[inline]
    pub fn contains(&self, p: Vec3) -> bool {
        self.min.cmple(p).all() && p.cmple(self.max).all()
    }

    /// The middle.
    #[inline]
    pub fn center(&self) -> Vec3 {
        0.5 * self.min + 0.5 * self.max
    }

    /// Edge lengths; negative or NaN for an empty box.
    #[inline]
    pub fn extent(&self) -> Vec3 {
        self.max - self.min
    }

    /// Half the surface area, the measure of the surface area heuristic; 0 when empty.
    #[inline]
    pub fn half_area(&self) -> f32 {
        if self.is_empty() {
            return 0.0;
        }
        let e = self.extent();
        e.x * e.y + e.y * e.z + e.z * e.x
    }

    /// A box that certainly holds the image of this one under `m`, rounding included.
    pub fn transformed(&self, m: &Affine3A) -> Aabb {
        if self.is_empty() {
            return Aabb::EMPTY;
        }
        if !self.is_finite() {
            return Aabb::EVERYWHERE;
        }
        let corners = (0..8).map(|i| {
            let pick = |bit: i32, lo: f32, hi: f32| if i & bit == 0 { lo } else { hi };
            let p = Vec3::new(
                pick(1, self.min.x, self.max.x),
                pick(2, self.min.y, self.max.y),
                pick(4, self.min.z, self.max.z),
            );
            m.transform_point3(p)
        });
        Aabb::around(corners).padded(1e-6)
    }

    /// This box grown on every side by `relative` times its largest coordinate.
    #[inline]
    pub fn padded(&self, relative: f32) -> Aabb {
        let size = self.min.abs().max(self.max.abs()).max_element();
        let pad = Vec3::splat(size * relative);
        Aabb { min: self.min - pad, max: self.max + pad }
    }

    /// The interval of ray parameters inside the box, clipped to the ray's own range.
    ///
    /// Conservative: a ray that touches the box within rounding is reported.
    /// Returns `None` when the ray misses.
    #[inline]
    pub fn clip(&self, ray: &Ray) -> Option<(f32, f32)> {
        let (mut near, mut far) = (ray.t_min, ray.t_max);
        for axis in 0..3 {
            if ray.d[axis] == 0.0 {
                if ray.o[axis] < self.min[axis] || ray.o[axis] > self.max[axis] {
                    return None;
                }
                continue;
            }
            let inv = ray.d[axis].recip();
            let a = (self.min[axis] - ray.o[axis]) * inv;
            let b = (self.max[axis] - ray.o[axis]) * inv;
            // Three roundings on either side; see `robust::gamma`.
            near = near.max(a.min(b));
            let exit = a.max(b);
            far = far.min(exit + exit.abs() * (2.0 * crate::robust::gamma(3)));
        }
        (near <= far).then_some((near, far))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn empty_is_neutral_and_has_no_area() {
        let b = Aabb::around([Vec3::ZERO, Vec3::new(1.0, 2.0, 3.0)]);
        assert_eq!(b.union(Aabb::EMPTY), b);
        assert!(Aabb::EMPTY.is_empty() && Aabb::EMPTY.half_area() == 0.0);
        assert_eq!(b.half_area(), 2.0 + 6.0 + 3.0);
    }

    #[test]
    fn clip_finds_the_slab_and_keeps_rays_in_a_face() {
        let b = Aabb::around([Vec3::splat(-1.0), Vec3::splat(1.0)]);
        let through = Ray::new(Vec3::new(-3.0, 0.0, 0.0), Vec3::X);
        let (near, far) = b.clip(&through).unwrap();
        assert!((near - 2.0).abs() < 1e-5 && (far - 4.0).abs() < 1e-5);
        let in_face = Ray::new(Vec3::new(-3.0, 1.0, 0.0), Vec3::X);
        assert!(b.clip(&in_face).is_some());
        let miss = Ray::new(Vec3::new(-3.0, 1.1, 0.0), Vec3::X);
        assert!(b.clip(&miss).is_none());
    }
}
