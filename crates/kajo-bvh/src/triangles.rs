//! A tree over triangles.

use kajo_math::{Aabb, Ray, Vec3};

use crate::{BuildError, BuildSettings, Bvh, Stats};

/// Where a ray meets a triangle `a b c`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TriangleHit {
    /// Ray parameter.
    pub t: f32,
    /// Weight of `b`: the point is `(1 - u - v) a + u b + v c`.
    pub u: f32,
    /// Weight of `c`.
    pub v: f32,
    /// The triangle's place in the list the tree was built from.
    pub triangle: u32,
}

/// A tree over triangles, and the triangles.
#[derive(Clone, Debug, Default)]
pub struct TriangleBvh {
    tree: Bvh,
    triangles: Vec<[Vec3; 3]>,
}

impl TriangleBvh {
    /// Builds a tree over `triangles`, three indices into `positions` each. What it needs of
    /// them is copied.
    pub fn build(
        positions: &[Vec3],
        triangles: &[[u32; 3]],
        settings: &BuildSettings,
    ) -> Result<TriangleBvh, BuildError> {
        let corners = |(triangle, t): (usize, &[u32; 3])| {
            let corner = |index: u32| {
                let vertices = positions.len();
                let missing = BuildError::IndexOutOfRange { triangle, index, vertices };
                positions.get(index as usize).copied().ok_or(missing)
            };
            Ok([corner(t[0])?, corner(t[1])?, corner(t[2])?])
        };
        let triangles: Vec<_> = triangles.iter().enumerate().map(corners).collect::<Result<_, _>>()?;
        let boxes: Vec<_> = triangles.iter().map(|t| Aabb::around(*t)).collect();
        Ok(TriangleBvh { tree: Bvh::build(&boxes, settings), triangles })
    }

    /// The nearest hit in the ray's range; of equally near ones that of the lowest number.
    pub fn closest(&self, ray: &Ray) -> Option<TriangleHit> {
        let mut best: Option<TriangleHit> = None;
        self.tree.closest(ray, |triangle, t_max| {
            let hit = self.meet(ray, triangle).filter(|h| h.t < best.map_or(ray.t_max, |b| b.t));
            best = hit.or(best);
            hit.map_or(t_max, |h| h.t)
        });
        best
    }

    /// Whether anything is hit in the ray's range.
    pub fn any(&self, ray: &Ray) -> bool {
        self.tree.any(ray, |triangle| self.meet(ray, triangle).is_some())
    }

    /// Calls `visit` once for every crossing in the ray's range, in no set order.
    pub fn all(&self, ray: &Ray, mut visit: impl FnMut(TriangleHit)) {
        self.tree.each(ray, |triangle| {
            if let Some(hit) = self.meet(ray, triangle) {
                visit(hit);
            }
        });
    }

    /// The box around everything; empty when there is nothing.
    pub fn bounds(&self) -> Aabb {
        self.tree.bounds()
    }

    /// Size, depth and memory of the tree.
    pub fn stats(&self) -> Stats {
        self.tree.stats()
    }

    fn meet(&self, ray: &Ray, triangle: u32) -> Option<TriangleHit> {
        let [a, b, c] = self.triangles[triangle as usize];
        let (e1, e2) = (b - a, c - a);
        let p = ray.d.cross(e2);
        let inv = e1.dot(p).recip();
        let s = ray.o - a;
        let q = s.cross(e1);
        let (u, v, t) = (s.dot(p) * inv, ray.d.dot(q) * inv, e2.dot(q) * inv);
        let inside = u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > ray.t_min && t < ray.t_max;
        inside.then_some(TriangleHit { t, u, v, triangle })
    }
}
