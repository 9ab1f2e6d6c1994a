//! The packet's side of triangle tests.

use kajo_math::Vec4;

use super::{Lanes, RAYS, Rays};
use crate::group::{Group, LANES, Shear, Sheared, TriangleHit, take_lowest};
use crate::simd::PacketSimd;

/// The rays' side of triangle tests; all have the same axes.
pub(super) struct Shears<S: PacketSimd> {
    axes: [usize; 3],
    o: [S::F32x8; 3],
    slope: [S::F32x8; 2],
    inv_dz: [Vec4; 2],
    t_min: [Vec4; 2],
}

impl<S: PacketSimd> Shears<S> {
    /// `None` where the rays do not run along the same main axis.
    #[inline(always)]
    pub(super) fn new(simd: S, rays: &Rays<S>) -> Option<Shears<S>> {
        let axes = Shear::AXES[rays.main_axis(simd)?];
        let inv_dz = simd.div(simd.splat(1.0), rays.d[axes[2]]);
        let slope = [simd.mul(rays.d[axes[0]], inv_dz), simd.mul(rays.d[axes[1]], inv_dz)];
        let o = [rays.o[axes[0]], rays.o[axes[1]], rays.o[axes[2]]];
        let (inv_dz, t_min) = (simd.halves(inv_dz), simd.halves(rays.t_min));
        Some(Shears { axes, o, slope, inv_dz, t_min })
    }

    /// Tests the triangles of a group against some of the rays.
    #[inline(always)]
    pub(super) fn closest(&self, simd: S, group: &Group, rays: u32, hits: &mut Hits) {
        let corners: &[[[f32; LANES]; 3]; 3] = bytemuck::cast_ref(&group.corners);
        let zero = simd.splat(0.0);
        for lane in 0..LANES {
            if lane > 0 && group.triangles[lane] == group.triangles[lane - 1] {
                break;
            }
            let along = self.along(simd, &corners[self.axes[2]], lane);
            let x = self.across(simd, 0, &corners[self.axes[0]], lane, along);
            let y = self.across(simd, 1, &corners[self.axes[1]], lane, along);
            let u = edge(simd, x, y, 2, 1);
            let v = edge(simd, x, y, 0, 2);
            let w = edge(simd, x, y, 1, 0);
            let (least, most) = (simd.min(simd.min(u, v), w), simd.max(simd.max(u, v), w));
            // What cannot be ruled out in f32, as one ray's test does; the rest decides.
            let candidates = rays & !(simd.lt(least, zero) & simd.lt(zero, most));
            for half in 0..2 {
                let candidates = candidates >> (4 * half) & 0xf;
                if candidates != 0 {
                    let (x, y, z) =
                        (half_of(simd, x, half), half_of(simd, y, half), half_of(simd, along, half));
                    let sheared = Sheared { x, y, z };
                    self.finish(simd, &sheared, group.triangles[lane], candidates, half, hits);
                }
            }
        }
    }

    /// How far the corners of a triangle lie along the main axis.
    #[inline(always)]
    fn along(&self, simd: S, z: &[[f32; LANES]; 3], lane: usize) -> [S::F32x8; 3] {
        let [a, b, c] = [simd.splat(z[0][lane]), simd.splat(z[1][lane]), simd.splat(z[2][lane])];
        [simd.sub(a, self.o[2]), simd.sub(b, self.o[2]), simd.sub(c, self.o[2])]
    }

    /// Where they lie on another axis in the plane across the ray.
    #[inline(always)]
    fn across(
        &self,
        simd: S,
        axis: usize,
        v: &[[f32; LANES]; 3],
        lane: usize,
        along: [S::F32x8; 3],
    ) -> [S::F32x8; 3] {
        let (o, slope) = (self.o[axis], self.slope[axis]);
        let [a, b, c] = [simd.splat(v[0][lane]), simd.splat(v[1][lane]), simd.splat(v[2][lane])];
        [
            simd.sub(simd.sub(a, o), simd.mul(slope, along[0])),
            simd.sub(simd.sub(b, o), simd.mul(slope, along[1])),
            simd.sub(simd.sub(c, o), simd.mul(slope, along[2])),
        ]
    }

    /// Decides which of four rays meet a triangle, in f64.
    #[inline(always)]
    fn finish(&self, simd: S, sheared: &Sheared, triangle: u32, rays: u32, half: usize, hits: &mut Hits) {
        let edges = sheared.edges(simd);
        let (t, scale) = edges.distances(simd, sheared, simd.widen(self.inv_dz[half]));
        let in_range = t.cmpgt(self.t_min[half]).bitmask() & t.cmple(hits.t(half)).bitmask();
        let found = rays & edges.inside(simd) & in_range;
        if found != 0 {
            let [u, v] = edges.weights(simd, scale);
            hits.offer4(half, found, [t, u, v], triangle);
        }
    }
}

/// An edge function.
#[inline(always)]
fn edge<S: PacketSimd>(simd: S, x: [S::F32x8; 3], y: [S::F32x8; 3], p: usize, q: usize) -> S::F32x8 {
    simd.sub(simd.mul(x[p], y[q]), simd.mul(y[p], x[q]))
}

/// The first or the last four rays' numbers.
#[inline(always)]
fn half_of<S: PacketSimd>(simd: S, v: [S::F32x8; 3], half: usize) -> [Vec4; 3] {
    [simd.halves(v[0])[half], simd.halves(v[1])[half], simd.halves(v[2])[half]]
}

/// For four bits, which lanes they stand for: those that are not zero.
const CHOSEN: [[f32; 4]; 16] = {
    let mut lanes = [[0.0; 4]; 16];
    let mut i = 0;
    while i < 64 {
        let (bits, lane) = (i / 4, i % 4);
        lanes[bits][lane] = ((bits >> lane) & 1) as f32;
        i += 1;
    }
    lanes
};

/// The nearest hits so far.
pub(super) struct Hits {
    /// Their parameters, or where the rays end.
    pub(super) t: Lanes,
    u: Lanes,
    v: Lanes,
    pub(super) triangle: [u32; RAYS],
    /// Which rays hit anything.
    found: u32,
}

impl Hits {
    /// None yet, of rays that end at `t_max`.
    pub(super) fn before(t_max: Lanes) -> Hits {
        Hits { t: t_max, u: [0.0; RAYS], v: [0.0; RAYS], triangle: [0; RAYS], found: 0 }
    }

    #[inline(always)]
    pub(super) fn hit(&self, ray: usize) -> Option<TriangleHit> {
        let Hits { t, u, v, triangle, found } = self;
        let hit = TriangleHit { t: t[ray], u: u[ray], v: v[ray], triangle: triangle[ray] };
        (found >> ray & 1 != 0).then_some(hit)
    }

    /// The parameters of the first or the last four.
    #[inline(always)]
    pub(super) fn t(&self, half: usize) -> Vec4 {
        Vec4::from_slice(&self.t[4 * half..][..4])
    }

    /// Takes a hit at most as far as the one before, of equally near ones the lowest number.
    #[inline(always)]
    pub(super) fn offer(&mut self, ray: usize, hit: TriangleHit) {
        let ray = ray % RAYS;
        if hit.t < self.t[ray] || (hit.t == self.t[ray] && hit.triangle < self.triangle[ray]) {
            (self.t[ray], self.u[ray], self.v[ray]) = (hit.t, hit.u, hit.v);
            self.triangle[ray] = hit.triangle;
            self.found |= 1 << ray;
        }
    }

    /// Offers hits of the first or the last four rays with one triangle, those of the bits in
    /// `found`, each at most as far as the one before.
    ///
    /// * `numbers`: `t`, `u` and `v`
    #[inline(always)]
    fn offer4(&mut self, half: usize, mut found: u32, numbers: [Vec4; 3], triangle: u32) {
        let mut ties = found & numbers[0].cmpeq(self.t(half)).bitmask();
        while ties != 0 {
            let lane = take_lowest(&mut ties);
            found &= !(u32::from(triangle >= self.triangle[4 * half + lane]) << lane);
        }
        let chosen = Vec4::from_array(CHOSEN[found as usize & 15]).cmpgt(Vec4::ZERO);
        for (lanes, new) in [&mut self.t, &mut self.u, &mut self.v].into_iter().zip(numbers) {
            let lanes = &mut lanes[4 * half..][..4];
            Vec4::select(chosen, new, Vec4::from_slice(lanes)).write_to_slice(lanes);
        }
        let triangles: &mut Lanes = bytemuck::cast_mut(&mut self.triangle);
        let lanes = &mut triangles[4 * half..][..4];
        let new = Vec4::splat(f32::from_bits(triangle));
        Vec4::select(chosen, new, Vec4::from_slice(lanes)).write_to_slice(lanes);
        self.found |= found << (4 * half);
    }
}
