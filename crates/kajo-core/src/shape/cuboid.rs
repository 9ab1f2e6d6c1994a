//! Axis-aligned solid boxes.
//!
//! Three pairs of parallel planes; the ray is inside between the latest entry and the earliest
//! exit [Kay and Kajiya 1986].
//!
//! Scene: `Box { min -1 -1 -1  max 1 1 1 }`

use kajo_math::{Aabb, DVec3, Ray, Vec2, Vec3};

use super::{Patch, Ray64, Surface, in_range, stored};
use crate::interaction::{Hit, SurfacePoint, Tangents};

/// A box with faces parallel to the axes.
///
/// A hit's part is `2 axis` for the face at the smaller coordinate and `2 axis + 1` for the other.
#[derive(Clone, Copy, Debug)]
pub struct Cuboid {
    min: DVec3,
    max: DVec3,
}

impl Cuboid {
    /// The box between two opposite corners, in either order.
    pub fn new(a: Vec3, b: Vec3) -> Cuboid {
        Cuboid { min: a.min(b).as_dvec3(), max: a.max(b).as_dvec3() }
    }

    /// Entry and exit with their faces.
    #[inline]
    fn interval(&self, ray: &Ray) -> Option<[(f64, u32); 2]> {
        let Ray64 { o, d } = Ray64::new(ray);
        let (mut near, mut far) = ((f64::NEG_INFINITY, 0), (f64::INFINITY, 0));
        for axis in 0..3 {
            if d[axis] == 0.0 {
                if o[axis] < self.min[axis] || o[axis] > self.max[axis] {
                    return None;
                }
                continue;
            }
            let low = ((self.min[axis] - o[axis]) / d[axis], 2 * axis as u32);
            let high = ((self.max[axis] - o[axis]) / d[axis], 2 * axis as u32 + 1);
            let (enter, leave) = if d[axis] > 0.0 { (low, high) } else { (high, low) };
            if enter.0 > near.0 {
                near = enter;
            }
            if leave.0 < far.0 {
                far = leave;
            }
        }
        (near.0 <= far.0 && near.0.is_finite() && far.0.is_finite()).then_some([near, far])
    }
}

impl Surface for Cuboid {
    fn bounds(&self) -> Aabb {
        Aabb { min: self.min.as_vec3(), max: self.max.as_vec3() }
    }

    fn is_finite(&self) -> bool {
        self.min.is_finite() && self.max.is_finite()
    }

    #[inline]
    fn hit(&self, ray: &Ray) -> Option<Hit> {
        let crossings = self.interval(ray)?;
        crossings.into_iter().find_map(|(t, part)| Some(Hit { t: in_range(ray, t)?, part, ..Hit::default() }))
    }

    fn crossings<F: FnMut(Hit)>(&self, ray: &Ray, mut visit: F) {
        for (t, part) in self.interval(ray).into_iter().flatten() {
            if let Some(t) = in_range(ray, t) {
                visit(Hit { t, part, ..Hit::default() });
            }
        }
    }

    #[inline]
    fn surface_at(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        let (axis, high) = ((hit.part / 2) as usize, hit.part % 2 == 1);
        let mut p = Ray64::new(ray).at(hit.t.into()).clamp(self.min, self.max);
        p[axis] = if high { self.max[axis] } else { self.min[axis] };
        let mut n = Vec3::ZERO;
        n[axis] = if high { 1.0 } else { -1.0 };
        let (p, p_error) = stored(p, 0.0);
        SurfacePoint::flat(p, p_error, n)
    }

    /// Position within the face, in the order of the two remaining axes.
    fn uv_at(&self, hit: &Hit, p: Vec3) -> Vec2 {
        let axis = (hit.part / 2) as usize;
        let (s, t) = ((axis + 1) % 3, (axis + 2) % 3);
        let part = |k: usize| ((f64::from(p[k]) - self.min[k]) / (self.max[k] - self.min[k])) as f32;
        Vec2::new(part(s), part(t))
    }

    /// The edges of the face.
    fn tangents_at(&self, hit: &Hit, _p: Vec3) -> Tangents {
        let axis = (hit.part / 2) as usize;
        let edge = |k: usize| (DVec3::AXES[k % 3] * (self.max - self.min)).as_vec3();
        Tangents { dpdu: edge(axis + 1), dpdv: edge(axis + 2) }
    }

    fn patches<F: FnMut(u32, Patch)>(&self, mut visit: F) {
        let size = self.max - self.min;
        for part in 0..6 {
            let axis = part as usize / 2;
            let along = |i: usize| DVec3::AXES[i % 3] * size[i % 3];
            // Turned so that the normal points outward.
            let (corner, edges) = match part % 2 {
                0 => (self.min, [along(axis + 2), along(axis + 1)]),
                _ => (self.min + along(axis), [along(axis + 1), along(axis + 2)]),
            };
            visit(part, Patch::parallelogram(corner, edges));
        }
    }

    fn is_closed(&self) -> bool {
        true
    }

    fn is_curved(&self) -> bool {
        false
    }

    fn part_count(&self) -> u32 {
        6
    }
}
