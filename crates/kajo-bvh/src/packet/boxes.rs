//! The packet's side of box tests: the beam around the rays, and each ray.

use kajo_math::Vec3;

use super::{ALL, Rays, abs, largest, smallest};
use crate::node::{Node, Wide};
use crate::simd::Simd;
use crate::slabs::{LARGEST_ERROR, LEAST_SLOPE, OWN_ERROR, U};

/// The beam around the rays, all of which run into the same octant.
///
/// With `s` the sign of the direction on an axis and `a = s (x - o)` the way to a plane `x`, the
/// rays reach the plane at `a |1/d|`. Over all origins and directions that is at least the
/// smaller and at most the larger of `a m` and `a M`, where `m` and `M` bound `|1/d|` and `a` is
/// taken from the origin nearest to or farthest from the plane. As products with the plane plus
/// constants they cost one instruction each.
pub(super) struct Beam<S: Simd> {
    first: [usize; 3],
    /// `s m` and `s M`.
    scale: [[S::F32x8; 2]; 3],
    enter: [[S::F32x8; 2]; 3],
    leave: [[S::F32x8; 2]; 3],
    t_min: S::F32x8,
}

impl<S: Simd> Beam<S> {
    /// Sets up an axis, and tells whether that could be done in finite numbers.
    ///
    /// * `sign`: 1 or -1
    /// * `size`: `|1/d|`
    /// * `error`: by how much boxes are widened
    #[inline(always)]
    fn set(&mut self, simd: S, axis: usize, sign: f32, o: S::F32x8, size: S::F32x8, error: S::F32x8) -> bool {
        let (lo, hi) = (smallest(simd, o), largest(simd, o));
        let (nearest, farthest) = if sign > 0.0 { (hi, lo) } else { (lo, hi) };
        // Twice the error of one ray makes up for the rounding of these constants.
        let error = 2.0 * largest(simd, error);
        let (nearest, farthest) = (-sign * nearest - error, -sign * farthest + error);
        let mut sum = 0.0;
        for (i, m) in [smallest(simd, size), largest(simd, size)].into_iter().enumerate() {
            self.scale[axis][i] = simd.splat(sign * m);
            self.enter[axis][i] = simd.splat(nearest * m);
            self.leave[axis][i] = simd.splat(farthest * m);
            sum += nearest * m + farthest * m;
        }
        sum.is_finite()
    }

    /// The children whose boxes some ray may meet before `t_max`, and where the first enters each.
    #[inline(always)]
    pub(super) fn meet(&self, simd: S, node: &Node, t_max: f32) -> (u32, S::F32x8) {
        let near = simd.max(
            simd.max(self.enter(simd, node, 0), self.enter(simd, node, 1)),
            simd.max(self.enter(simd, node, 2), self.t_min),
        );
        let far = simd.min(
            simd.min(self.leave(simd, node, 0), self.leave(simd, node, 1)),
            simd.min(self.leave(simd, node, 2), simd.splat(t_max)),
        );
        (simd.le(near, far), near)
    }

    #[inline(always)]
    fn enter(&self, simd: S, node: &Node, axis: usize) -> S::F32x8 {
        let plane = node.planes(simd, 2 * axis + (self.first[axis] & 1), self.t_min);
        let ([m, big], [c, d]) = (self.scale[axis], self.enter[axis]);
        simd.min(simd.mul_add(plane, m, c), simd.mul_add(plane, big, d))
    }

    #[inline(always)]
    fn leave(&self, simd: S, node: &Node, axis: usize) -> S::F32x8 {
        let plane = node.planes(simd, 2 * axis + (self.first[axis] & 1 ^ 1), self.t_min);
        let ([m, big], [c, d]) = (self.scale[axis], self.leave[axis]);
        simd.max(simd.mul_add(plane, m, c), simd.mul_add(plane, big, d))
    }
}

/// The rays' side of box tests.
pub(super) struct Slabs<S: Simd> {
    pub(super) beam: Beam<S>,
    /// Which of a box's planes is met first on each axis: 0 the smaller, 1 the larger.
    first: [usize; 3],
    rd: [S::F32x8; 3],
    near: [S::F32x8; 3],
    far: [S::F32x8; 3],
    t_min: S::F32x8,
}

impl<S: Simd> Slabs<S> {
    /// `None` where the rays do not run into the same octant, or one can hit nothing.
    #[inline(always)]
    pub(super) fn new(simd: S, rays: &Rays<S>, reach: Vec3) -> Option<Slabs<S>> {
        let zero = simd.splat(0.0);
        let none = [zero; 3];
        let t_min = simd.splat(smallest(simd, rays.t_min));
        let pairs = [[zero; 2]; 3];
        let beam = Beam { first: [0; 3], scale: pairs, enter: pairs, leave: pairs, t_min };
        let mut slabs = Slabs { beam, first: [0; 3], rd: none, near: none, far: none, t_min: rays.t_min };
        let [dx, dy, dz] = [abs(simd, rays.d[0]), abs(simd, rays.d[1]), abs(simd, rays.d[2])];
        let least = simd.mul(simd.max(simd.max(dx, dy), dz), simd.splat(LEAST_SLOPE));
        let sizes = [
            simd.add(abs(simd, rays.o[0]), simd.splat(reach.x)),
            simd.add(abs(simd, rays.o[1]), simd.splat(reach.y)),
            simd.add(abs(simd, rays.o[2]), simd.splat(reach.z)),
        ];
        let largest =
            simd.mul(simd.max(simd.max(sizes[0], sizes[1]), sizes[2]), simd.splat(LARGEST_ERROR * U));
        let mut usable = simd.lt(rays.t_min, rays.t_max);
        for (axis, size) in sizes.into_iter().enumerate() {
            let (o, d) = (rays.o[axis], rays.d[axis]);
            let sign = match simd.signs(d) {
                0 => 1.0,
                ALL => -1.0,
                _ => return None,
            };
            let slope = simd.div(simd.splat(1.0), simd.max(abs(simd, d), least));
            let error = simd.mul_add(size, simd.splat(OWN_ERROR * U), largest);
            let rd = simd.mul(slope, simd.splat(sign));
            let (base, slack) = (simd.mul(simd.sub(zero, o), rd), simd.mul(error, slope));
            let (near, far) = (simd.sub(base, slack), simd.add(base, slack));
            // Whatever was not finite has spread to here, and differs from itself.
            let sum = simd.sub(simd.sub(far, near), d);
            usable &= simd.le(simd.sub(sum, sum), zero);
            slabs.first[axis] = usize::from(sign < 0.0);
            (slabs.rd[axis], slabs.near[axis], slabs.far[axis]) = (rd, near, far);
            if !slabs.beam.set(simd, axis, sign, o, slope, error) {
                return None;
            }
        }
        slabs.beam.first = slabs.first;
        (usable == ALL).then_some(slabs)
    }

    /// Which rays meet a child's box before their `t_max`.
    #[inline(always)]
    pub(super) fn meet(&self, simd: S, node: &Node, slot: usize, t_max: S::F32x8) -> u32 {
        let near = simd.max(
            simd.max(self.enter(simd, node, slot, 0), self.enter(simd, node, slot, 1)),
            simd.max(self.enter(simd, node, slot, 2), self.t_min),
        );
        let far = simd.min(
            simd.min(self.leave(simd, node, slot, 0), self.leave(simd, node, slot, 1)),
            simd.min(self.leave(simd, node, slot, 2), t_max),
        );
        simd.le(near, far)
    }

    #[inline(always)]
    fn enter(&self, simd: S, node: &Node, slot: usize, axis: usize) -> S::F32x8 {
        let plane = simd.splat(node.plane(2 * axis + (self.first[axis] & 1), slot));
        simd.mul_add(plane, self.rd[axis], self.near[axis])
    }

    #[inline(always)]
    fn leave(&self, simd: S, node: &Node, slot: usize, axis: usize) -> S::F32x8 {
        let plane = simd.splat(node.plane(2 * axis + (self.first[axis] & 1 ^ 1), slot));
        simd.mul_add(plane, self.rd[axis], self.far[axis])
    }
}
