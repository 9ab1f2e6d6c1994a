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

use bytemuck::{Pod, Zeroable};
use kajo_math::{Aabb, Ray, Vec3, Vec4};

use crate::simd::Simd;

/// Triangles in a group.
pub(crate) const LANES: usize = 4;

/// Up to four triangles in ascending order of their numbers, the last one repeated to fill up.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Group {
    /// By axis and corner.
    pub(crate) corners: [[Vec4; 3]; 3],
    pub(crate) triangles: [u32; LANES],
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

/// The axis along which `d` is longest.
#[inline(always)]
fn main_axis(d: Vec3) -> usize {
    // No branches: for scattered rays they would be mispredicted.
    let a = d.abs();
    let (xy, longer) = (usize::from(a.y > a.x), a.x.max(a.y));
    if a.z >= longer { 2 } else { xy }
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
    /// What the axes are called when a ray runs fastest along each.
    pub(crate) const AXES: [[usize; 3]; 3] = [[1, 2, 0], [2, 0, 1], [0, 1, 2]];

    #[inline(always)]
    pub(crate) fn new(ray: &Ray) -> Shear {
        let z = main_axis(ray.d);
        let axes = Shear::AXES[z];
        let (o, d) = (ray.o.to_array(), ray.d.to_array());
        let inv_dz = d[z].recip();
        Shear {
            axes,
            o: axes.map(|axis| o[axis]),
            slope: [d[axes[0]] * inv_dz, d[axes[1]] * inv_dz],
            inv_dz,
            t_min: ray.t_min,
        }
    }

    #[inline(always)]
    fn inv_dz<S: Simd>(&self, simd: S) -> S::F64x4 {
        simd.splat_f64(f64::from(self.inv_dz))
    }

    /// The lanes whose parameters lie after the ray's start.
    #[inline(always)]
    fn after_start(&self, t: Vec4) -> u32 {
        t.cmpgt(Vec4::splat(self.t_min)).bitmask()
    }
}

/// Corners of four triangles in the plane across the ray, and how far along it they are.
pub(crate) struct Sheared {
    pub(crate) x: [Vec4; 3],
    pub(crate) y: [Vec4; 3],
    pub(crate) z: [Vec4; 3],
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

    /// Takes new corners for the same triangles, `None` for one that cannot be hit, and
    /// answers the box around them.
    pub(crate) fn refit(&mut self, corners: impl Fn(u32) -> Option<[Vec3; 3]>) -> Aabb {
        let mut bounds = Aabb::EMPTY;
        let place = |triangle: u32| corners(triangle).unwrap_or([Vec3::NAN; 3]);
        for corners in self.triangles.iter().filter_map(|&triangle| corners(triangle)) {
            bounds = corners.into_iter().fold(bounds, Aabb::grown);
        }
        *self = Group::new(&self.triangles, place);
        bounds
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
    pub(crate) fn closest<S: Simd>(&self, simd: S, ray: &Shear, t_max: f32, tie: u32) -> Option<TriangleHit> {
        let sheared = self.sheared(ray);
        let candidates = sheared.candidates();
        if candidates == 0 {
            return None;
        }
        let edges = sheared.edges(simd);
        let (t, scale) = edges.distances(simd, &sheared, ray.inv_dz(simd));
        let mut hits =
            candidates & edges.inside(simd) & ray.after_start(t) & t.cmple(Vec4::splat(t_max)).bitmask();
        if hits == 0 {
            return None;
        }
        let [u, v] = edges.weights(simd, scale).map(|weight| weight.to_array());
        let t = t.to_array();
        let mut best = TriangleHit { t: t_max, u: 0.0, v: 0.0, triangle: tie };
        while hits != 0 {
            let lane = take_lowest(&mut hits);
            let triangle = self.triangles[lane];
            if t[lane] < best.t || (t[lane] == best.t && triangle < best.triangle) {
                best = TriangleHit { t: t[lane], u: u[lane], v: v[lane], triangle };
            }
        }
        (best.t < t_max || best.triangle < tie).then_some(best)
    }

    /// Whether there is a hit with `t_min < t < t_max`.
    #[inline(always)]
    pub(crate) fn any<S: Simd>(&self, simd: S, ray: &Shear, t_max: f32) -> bool {
        let sheared = self.sheared(ray);
        let candidates = sheared.candidates();
        if candidates == 0 {
            return false;
        }
        let edges = sheared.edges(simd);
        let (t, _) = edges.distances(simd, &sheared, ray.inv_dz(simd));
        candidates & edges.inside(simd) & ray.after_start(t) & t.cmplt(Vec4::splat(t_max)).bitmask() != 0
    }

    /// Every crossing with `t_min < t < t_max`.
    #[inline(always)]
    pub(crate) fn all<S: Simd>(&self, simd: S, ray: &Shear, t_max: f32, mut visit: impl FnMut(TriangleHit)) {
        let sheared = self.sheared(ray);
        let candidates = sheared.candidates();
        if candidates == 0 {
            return;
        }
        let edges = sheared.edges(simd);
        let (t, scale) = edges.distances(simd, &sheared, ray.inv_dz(simd));
        let mut hits = candidates & ray.after_start(t) & t.cmplt(Vec4::splat(t_max)).bitmask();
        let [u, v] = edges.weights(simd, scale).map(|weight| weight.to_array());
        while hits != 0 {
            let lane = take_lowest(&mut hits);
            let triangle = self.triangles[lane];
            let filler = lane > 0 && self.triangles[lane - 1] == triangle;
            if !filler && sheared.is_crossed(lane) {
                visit(TriangleHit { t: t.to_array()[lane], u: u[lane], v: v[lane], triangle });
            }
        }
    }
}

/// Clears the lowest of the set bits and answers its number.
#[inline(always)]
pub(crate) fn take_lowest(bits: &mut u32) -> usize {
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

    /// The edge functions, their signs exact.
    #[inline(always)]
    pub(crate) fn edges<S: Simd>(&self, simd: S) -> Edges<S> {
        let (x, y) = (self.x.map(|x| simd.widen(x)), self.y.map(|y| simd.widen(y)));
        let edge = |p: usize, q: usize| simd.sub_f64(simd.mul_f64(x[p], y[q]), simd.mul_f64(y[p], x[q]));
        Edges { u: edge(2, 1), v: edge(0, 2), w: edge(1, 0) }
    }

    /// Whether the ray crosses the triangle in a lane, where each edge belongs to only one of
    /// the two triangles that meet in it.
    #[inline(always)]
    fn is_crossed(&self, lane: usize) -> bool {
        let corner = |i: usize| (self.x[i].to_array()[lane], self.y[i].to_array()[lane]);
        let (a, b, c) = (corner(0), corner(1), corner(2));
        let sides = [is_left(c, b), is_left(a, c), is_left(b, a)];
        sides == [true; 3] || sides == [false; 3]
    }
}

/// Whether the origin is left of the directed edge from `p` to `q`.
///
/// An origin on the edge counts as moved by `(e, e^2)` for an infinitesimal `e`: the two
/// triangles at the edge, which see it in opposite directions, get opposite answers.
#[inline(always)]
fn is_left((px, py): (f32, f32), (qx, qy): (f32, f32)) -> bool {
    let edge = f64::from(px) * f64::from(qy) - f64::from(py) * f64::from(qx);
    if edge != 0.0 {
        edge > 0.0
    } else if py != qy {
        py > qy
    } else {
        px < qx
    }
}

/// Edge functions of four triangles: the unscaled weights of their corners.
pub(crate) struct Edges<S: Simd> {
    u: S::F64x4,
    v: S::F64x4,
    w: S::F64x4,
}

impl<S: Simd> Edges<S> {
    /// The lanes whose triangles the ray meets, edges included.
    #[inline(always)]
    pub(crate) fn inside(&self, simd: S) -> u32 {
        let zero = simd.splat_f64(0.0);
        let [u, v, w] = [self.u, self.v, self.w];
        let positive = simd.le_f64(zero, u) & simd.le_f64(zero, v) & simd.le_f64(zero, w);
        let negative = simd.le_f64(u, zero) & simd.le_f64(v, zero) & simd.le_f64(w, zero);
        positive | negative
    }

    /// The ray parameters, given the inverse of the direction along the main axis, and the
    /// scale that turns edge functions into weights; not numbers where the ray lies in the
    /// triangle's plane.
    #[inline(always)]
    pub(crate) fn distances(&self, simd: S, sheared: &Sheared, inv_dz: S::F64x4) -> (Vec4, S::F64x4) {
        let [a, b, c] = sheared.z.map(|z| simd.widen(z));
        let det = simd.add_f64(simd.add_f64(self.u, self.v), self.w);
        let scale = simd.div_f64(simd.splat_f64(1.0), det);
        let sum = simd.add_f64(simd.mul_f64(self.u, a), simd.mul_f64(self.v, b));
        let sum = simd.add_f64(sum, simd.mul_f64(self.w, c));
        (simd.narrow(simd.mul_f64(simd.mul_f64(sum, scale), inv_dz)), scale)
    }

    /// The weights of the second and the third corner.
    #[inline(always)]
    pub(crate) fn weights(&self, simd: S, scale: S::F64x4) -> [Vec4; 2] {
        [simd.narrow(simd.mul_f64(self.v, scale)), simd.narrow(simd.mul_f64(self.w, scale))]
    }
}
