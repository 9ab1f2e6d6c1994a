//! Coordinates of the points of a patch, in the unit square.
//!
//! Equal areas of the square are equal areas of the patch, but for stretched spheres and cones, where they are equal areas before the
//! stretch. They are the numbers by which [`Patch::sample_area`] draws, but for triangles, whose coordinates are linear on
//! both sides of a diagonal [Heitz 2019]:
//!
//! ```text
//! b0 = x/2, b1 = y - x/2   where x < y         b1 = y/2, b0 = x - y/2   elsewhere
//! ```
//!
//! with the barycentric coordinates `b0` and `b1` of the first two corners.

use std::f64::consts::TAU;

use kajo_math::{DAffine3, DVec3, Vec2, Vec3, fmath};

use super::{Canonical, CurvedPatch, Patch, PatchSample, on_unit_sphere, tube_area};

impl Patch {
    /// The position at coordinates in [0, 1)², its density per area that of evenly drawn coordinates; `None` for traced surfaces,
    /// which have none.
    pub fn point_at(&self, at: Vec2) -> Option<PatchSample> {
        let p = self.point(f64::from(at.x), f64::from(at.y))?;
        Some(PatchSample { at: self.placed_point(p), pdf_area: self.pdf_area(p.as_vec3()) })
    }

    /// [`Patch::point_at`] of the image of this patch under `m`.
    pub fn point_at_moved(&self, m: &DAffine3, at: Vec2) -> Option<PatchSample> {
        let p = m.transform_point3(self.point(f64::from(at.x), f64::from(at.y))?);
        let at = match self {
            Patch::Curved(curved) => curved.moved(m).placed_point(p),
            other => other.moved(m)?.placed_point(p),
        };
        Some(PatchSample { at, pdf_area: self.pdf_area_moved(m, p.as_vec3()) })
    }

    /// The coordinates of a position on the patch, in [0, 1)²; zero for traced surfaces.
    pub fn coordinates(&self, p: Vec3) -> Vec2 {
        let p = p.as_dvec3();
        let [x, y] = match self {
            Patch::Triangle([a, b, c]) => {
                let [b1, b2] = affine(p - a, [b - a, c - a]);
                let b0 = 1.0 - b1 - b2;
                if b0 < b1 { [2.0 * b0, b0 + b1] } else { [b0 + b1, 2.0 * b1] }
            }
            Patch::Rectangle(rectangle) => affine(p - rectangle.corner(), rectangle.edges()),
            Patch::Quad(quad) => affine(p - quad.corner, quad.edges),
            Patch::Disk(disk) => {
                let [x, y] = affine(p - disk.center, disk.axes);
                let inner2 = disk.inner * disk.inner;
                [(x * x + y * y - inner2) / (1.0 - inner2), turn(x, y)]
            }
            Patch::Sphere { center, .. } => on_sphere(p - center),
            Patch::Curved(curved) => curved.coordinates(curved.inverse.transform_point3(p)),
            Patch::Traced(_) => [0.0; 2],
        };
        Vec2::new(x as f32, y as f32).clamp(Vec2::ZERO, Vec2::splat(1.0f32.next_down()))
    }

    /// [`Patch::coordinates`] of a position on the image of this patch under `m`.
    pub fn coordinates_moved(&self, m: &DAffine3, p: Vec3) -> Vec2 {
        self.coordinates(m.inverse().transform_point3(p.as_dvec3()).as_vec3())
    }

    /// The position at coordinates.
    pub(super) fn point(&self, x: f64, y: f64) -> Option<DVec3> {
        Some(match self {
            Patch::Triangle([a, b, c]) => {
                let [b0, b1] = if x < y { [0.5 * x, y - 0.5 * x] } else { [x - 0.5 * y, 0.5 * y] };
                c + b0 * (a - c) + b1 * (b - c)
            }
            Patch::Rectangle(rectangle) => {
                let [a, b] = rectangle.edges();
                rectangle.corner() + x * a + y * b
            }
            Patch::Quad(quad) => quad.corner + x * quad.edges[0] + y * quad.edges[1],
            Patch::Disk(disk) => disk.point(x, y),
            Patch::Sphere { center, radius } => center + *radius * on_unit_sphere(x, y),
            Patch::Curved(curved) => curved.map.transform_point3(curved.canonical(x, y)),
            Patch::Traced(_) => return None,
        })
    }
}

impl CurvedPatch {
    /// Those of a position of the canonical surface.
    fn coordinates(&self, q: DVec3) -> [f64; 2] {
        match self.surface {
            Canonical::Sphere => on_sphere(q),
            Canonical::Frustum([r0, r1]) => {
                let r = r0 + q.z * (r1 - r0);
                [q.z * (r0 + r) / (r0 + r1), turn(q.x, q.y)]
            }
            Canonical::Torus { minor, widest } => {
                let angle =
                    f64::from(fmath::atan2(q.z as f32, ((q.x * q.x + q.y * q.y).sqrt() - 1.0) as f32));
                let share = tube_area(minor, angle) / tube_area(minor, widest);
                [0.5 + 0.5 * share, turn(q.x, q.y)]
            }
        }
    }
}

/// The factors of two edges that make up `v`, which lies in their plane.
fn affine(v: DVec3, [a, b]: [DVec3; 2]) -> [f64; 2] {
    let n = a.cross(b);
    [v.cross(b).dot(n), a.cross(v).dot(n)].map(|part| part / n.length_squared())
}

/// Of a direction from the middle of a sphere.
fn on_sphere(d: DVec3) -> [f64; 2] {
    [0.5 - 0.5 * d.normalize_or(DVec3::Z).z, turn(d.x, d.y)]
}

/// The angle from the x axis, as a share of the circle.
fn turn(x: f64, y: f64) -> f64 {
    let turn = f64::from(fmath::atan2(y as f32, x as f32)) / TAU;
    if turn < 0.0 { turn + 1.0 } else { turn }
}
