//! Single triangles.
//!
//! The ray is made the z axis by a shear, and the three edge functions of the projected
//! triangle decide. Two triangles that share an edge compute the same number for it up to sign,
//! so no ray passes between them [Woop, Benthin and Wald 2013]; here in double precision.
//!
//! Scene: `Triangle { vertex0 0 0 0  vertex1 1 0 0  vertex2 0 1 0 }`

use kajo_math::{Aabb, DVec3, Ray, Vec2, Vec3};

use super::{Patch, Ray64, Surface, hit_of_triangle, in_range, stored};
use crate::interaction::{Hit, SurfacePoint, Tangents};

/// A two-sided triangle; counter-clockwise vertices face outward.
#[derive(Clone, Copy, Debug)]
pub struct Triangle {
    /// Corners.
    pub vertices: [Vec3; 3],
    /// Surface coordinates of the corners.
    pub uvs: [Vec2; 3],
}

impl Triangle {
    /// Whether the triangle has no area, and so no normal.
    pub fn is_degenerate(&self) -> bool {
        self.normal().is_none()
    }

    fn normal(&self) -> Option<DVec3> {
        let [a, b, c] = self.vertices.map(|v| v.as_dvec3());
        (b - a).cross(c - a).try_normalize()
    }
}

impl Surface for Triangle {
    fn bounds(&self) -> Aabb {
        Aabb::around(self.vertices)
    }

    fn is_finite(&self) -> bool {
        self.vertices.iter().all(|v| v.is_finite()) && self.uvs.iter().all(|uv| uv.is_finite())
    }

    #[inline]
    fn hit(&self, ray: &Ray) -> Option<Hit> {
        let Ray64 { o, d } = Ray64::new(ray);
        // Permute so that the direction's largest coordinate is z, keeping the winding.
        let z = largest_axis(d);
        let (mut x, mut y) = ((z + 1) % 3, (z + 2) % 3);
        if d[z] < 0.0 {
            std::mem::swap(&mut x, &mut y);
        }
        let (sx, sy, sz) = (d[x] / d[z], d[y] / d[z], 1.0 / d[z]);
        let [a, b, c] = self.vertices.map(|v| {
            let r = v.as_dvec3() - o;
            DVec3::new(r[x] - sx * r[z], r[y] - sy * r[z], sz * r[z])
        });
        let (u, v, w) = (c.x * b.y - c.y * b.x, a.x * c.y - a.y * c.x, b.x * a.y - b.y * a.x);
        if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
            return None;
        }
        let sum = u + v + w;
        if sum == 0.0 {
            return None;
        }
        let t = in_range(ray, (u * a.z + v * b.z + w * c.z) / sum)?;
        Some(Hit { t, u: (v / sum) as f32, v: (w / sum) as f32, part: 0 })
    }

    fn crossings<F: FnMut(Hit)>(&self, ray: &Ray, visit: F) {
        self.hit(ray).into_iter().for_each(visit);
    }

    #[inline]
    fn surface_at(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        let n = self.normal().unwrap_or(DVec3::Z);
        let (onto, first) = (Ray64::new(ray).at(hit.t.into()), self.vertices[0].as_dvec3());
        let (p, p_error) = stored(onto - (onto - first).dot(n) * n, first.abs().max_element());
        SurfacePoint::flat(p, p_error, n.as_vec3())
    }

    fn hit_at(&self, part: u32, p: Vec3) -> Hit {
        hit_of_triangle(self.vertices.map(|v| v.as_dvec3()), part, p)
    }

    /// The corners' coordinates, interpolated.
    fn uv_at(&self, hit: &Hit, _p: Vec3) -> Vec2 {
        let [a, b, c] = self.uvs;
        (1.0 - hit.u - hit.v) * a + hit.u * b + hit.v * c
    }

    fn tangents_at(&self, _hit: &Hit, _p: Vec3) -> Tangents {
        Tangents::of_triangle(self.vertices.map(|v| v.as_dvec3()), self.uvs)
    }

    fn patches<F: FnMut(u32, Patch)>(&self, mut visit: F) {
        visit(0, Patch::Triangle(self.vertices.map(|v| v.as_dvec3())));
    }

    fn is_closed(&self) -> bool {
        false
    }

    fn is_curved(&self) -> bool {
        false
    }
}

#[inline]
fn largest_axis(d: DVec3) -> usize {
    let a = d.abs();
    if a.x > a.y && a.x > a.z {
        0
    } else if a.y > a.z {
        1
    } else {
        2
    }
}
