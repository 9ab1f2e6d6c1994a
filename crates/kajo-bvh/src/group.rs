//! Four triangles at a time against one ray, watertight.
//!
//! The ray is sheared onto the axis along which it runs fastest and the triangle is tested
//! against the origin of the remaining plane by three edge functions
//! [Woop, Benthin and Wald 2013]. They are products of two numbers of 24 bits, so in f64
//! their signs are exact, and the two triangles at an edge see it with opposite signs:
//! no ray passes between them. In f32 a difference of rounded products has the right sign or
//! is zero, which is enough to reject; what is left is decided in f64, where also `t` and
//! the barycentric weights are good for slivers.
//!
//! Nothing here is fused or reordered: all machines find the same bits.

use kajo_math::{Ray, Vec3, Vec4};

use crate::slabs::main_axis;

/// Triangles in a group.
pub(crate) const LANES: usize = 4;

/// Up to four triangles in ascending order of their numbers, the last one repeated to fill up.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(crate) struct Group {
    /// By axis and corner.
    corners: [[Vec4; 3]; 3],
    triangles: [u32; LANES],
}

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

/// A ray made ready for triangle tests: axes renamed so that it runs fastest along the third.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shear {
    axes: [usize; 3],
    o: [f32; 3],
    /// `d_x / d_z`, `d_y / d_z`.
    slope: [f32; 2],
    inv_dz: f32,
    t_min: f32,
}

impl Shear {
    #[inline(always)]
    pub(crate) fn new(ray: &Ray) -> Shear {
        let z = main_axis(ray.d);
        let axes = [[1, 2, 0], [2, 0, 1], [0, 1, 2]][z];
        let inv_dz = ray.d[z].recip();
        Shear {
            axes,
            o: axes.map(|axis| ray.o[axis]),
            slope: [ray.d[axes[0]] * inv_dz, ray.d[axes[1]] * inv_dz],
            inv_dz,
            t_min: ray.t_min,
        }
    }
}

/// Corners of four triangles in the plane across the ray, and how far along it they are.
struct Sheared {
    x: [Vec4; 3],
    y: [Vec4; 3],
    z: [Vec4; 3],
}

/// An edge through the ray, as seen from the ray.
#[derive(Clone, Copy)]
enum Border {
    /// The edge belongs to the triangle: for queries where a hole is worse than a double.
    Inside,
    /// The edge belongs to one of the two triangles that meet in it: for counting.
    Shared,
}

impl Group {
    pub(crate) const EMPTY: Group = Group { corners: [[Vec4::ZERO; 3]; 3], triangles: [0; LANES] };

    /// A group of one to four triangles with ascending numbers; the rest of `triangles` is
    /// left out.
    pub(crate) fn new(triangles: &[u32], corners: impl Fn(u32) -> [Vec3; 3]) -> Group {
        let mut group = Group::EMPTY;
        for lane in 0..LANES {
            let triangle = triangles[lane.min(triangles.len() - 1)];
            group.triangles[lane] = triangle;
            for (corner, p) in corners(triangle).into_iter().enumerate() {
                for axis in 0..3 {
                    group.corners[axis][corner][lane] = p[axis];
                }
            }
        }
        group
    }

    #[inline(always)]
    fn sheared(&self, ray: &Shear) -> Sheared {
        let [x, y, z] = ray.axes.map(|axis| &self.corners[axis]);
        let along = z.map(|z| z - Vec4::splat(ray.o[2]));
        let across = |v: &[Vec4; 3], o: f32, slope: f32| {
            let (o, slope) = (Vec4::splat(o), Vec4::splat(slope));
            [0, 1, 2].map(|i| (v[i] - o) - slope * along[i])
        };
        Sheared { x: across(x, ray.o[0], ray.slope[0]), y: across(y, ray.o[1], ray.slope[1]), z: along }
    }

    /// The nearest hit with `t_min < t < t_max`, of equally near ones the lowest number. A
    /// hit at exactly `t_max` counts if its triangle's number is below `tie`.
    #[inline(always)]
    pub(crate) fn closest(&self, ray: &Shear, t_max: f32, tie: u32) -> Option<TriangleHit> {
        let sheared = self.sheared(ray);
        let mut candidates = sheared.candidates();
        let mut best: Option<TriangleHit> = None;
        while candidates != 0 {
            let lane = take_lowest(&mut candidates);
            let Some((t, u, v)) = sheared.hit(lane, ray, Border::Inside) else { continue };
            let triangle = self.triangles[lane];
            let (limit, tie) = best.map_or((t_max, tie), |b| (b.t, b.triangle));
            if t < limit || (t == limit && triangle < tie) {
                best = Some(TriangleHit { t, u, v, triangle });
            }
        }
        best
    }

    #[cfg(test)]
    pub(crate) fn candidate_count(&self, ray: &Shear) -> u32 {
        self.sheared(ray).candidates().count_ones()
    }

    /// Whether there is a hit with `t_min < t < t_max`.
    #[inline(always)]
    pub(crate) fn any(&self, ray: &Shear, t_max: f32) -> bool {
        let sheared = self.sheared(ray);
        let mut candidates = sheared.candidates();
        while candidates != 0 {
            let lane = take_lowest(&mut candidates);
            if sheared.hit(lane, ray, Border::Inside).is_some_and(|(t, ..)| t < t_max) {
                return true;
            }
        }
        false
    }

    /// Every crossing with `t_min < t < t_max`.
    #[inline(always)]
    pub(crate) fn all(&self, ray: &Shear, t_max: f32, mut visit: impl FnMut(TriangleHit)) {
        let sheared = self.sheared(ray);
        let mut candidates = sheared.candidates();
        while candidates != 0 {
            let lane = take_lowest(&mut candidates);
            let triangle = self.triangles[lane];
            let filler = lane > 0 && self.triangles[lane - 1] == triangle;
            let hit = sheared.hit(lane, ray, Border::Shared).filter(|(t, ..)| *t < t_max);
            if let (Some((t, u, v)), false) = (hit, filler) {
                visit(TriangleHit { t, u, v, triangle });
            }
        }
    }
}

/// Clears the lowest of the set bits and answers its number.
#[inline(always)]
fn take_lowest(bits: &mut u32) -> usize {
    let lowest = bits.trailing_zeros() as usize % LANES;
    *bits &= *bits - 1;
    lowest
}

impl Sheared {
    /// The lanes whose triangles cannot be ruled out in f32.
    #[inline(always)]
    fn candidates(&self) -> u32 {
        let edge = |p: usize, q: usize| self.x[p] * self.y[q] - self.y[p] * self.x[q];
        let (u, v, w) = (edge(2, 1), edge(0, 2), edge(1, 0));
        let negative = u.cmplt(Vec4::ZERO) | v.cmplt(Vec4::ZERO) | w.cmplt(Vec4::ZERO);
        let positive = u.cmpgt(Vec4::ZERO) | v.cmpgt(Vec4::ZERO) | w.cmpgt(Vec4::ZERO);
        !(negative & positive).bitmask() & 0xf
    }

    /// `t`, `u` and `v` of the triangle in a lane if the ray meets it after `t_min`.
    #[inline(always)]
    fn hit(&self, lane: usize, ray: &Shear, border: Border) -> Option<(f32, f32, f32)> {
        let at = |v: &[Vec4; 3], corner: usize| f64::from(v[corner].to_array()[lane]);
        let edge = |p: usize, q: usize| at(&self.x, p) * at(&self.y, q) - at(&self.y, p) * at(&self.x, q);
        let weights = [edge(2, 1), edge(0, 2), edge(1, 0)];
        let inside = match border {
            Border::Inside => weights.iter().all(|w| *w >= 0.0) || weights.iter().all(|w| *w <= 0.0),
            Border::Shared => {
                let sides = [
                    self.side(weights[0], lane, 2, 1),
                    self.side(weights[1], lane, 0, 2),
                    self.side(weights[2], lane, 1, 0),
                ];
                sides == [true; 3] || sides == [false; 3]
            }
        };
        let [a, b, c] = weights;
        let det = a + b + c;
        let inv = 1.0 / det;
        let z = a * at(&self.z, 0) + b * at(&self.z, 1) + c * at(&self.z, 2);
        let t = (z * inv * f64::from(ray.inv_dz)) as f32;
        (inside && det != 0.0 && t > ray.t_min).then(|| (t, (b * inv) as f32, (c * inv) as f32))
    }

    /// Whether the ray passes left of the directed edge from corner `p` to corner `q`, whose
    /// edge function is `value`. A ray through the edge is moved by `(e, e^2)` for an
    /// infinitesimal `e`, so that it passes both triangles at the edge on opposite sides.
    #[inline(always)]
    fn side(&self, value: f64, lane: usize, p: usize, q: usize) -> bool {
        if value != 0.0 {
            return value > 0.0;
        }
        let at = |v: &[Vec4; 3], corner: usize| v[corner].to_array()[lane];
        let (py, qy) = (at(&self.y, p), at(&self.y, q));
        if py != qy { py > qy } else { at(&self.x, p) < at(&self.x, q) }
    }
}
