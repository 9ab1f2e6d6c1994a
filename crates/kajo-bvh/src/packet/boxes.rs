//! The packet's side of box tests: the beam around the rays, and each ray.

use kajo_math::Vec3;

use super::{ALL, Rays, abs, largest, smallest};
use crate::node::{Node, Wide};
use crate::simd::PacketSimd;
use crate::slabs::{LARGEST_ERROR, LEAST_SLOPE, OWN_ERROR, U};

/// The beam around the rays, all of which run into the same octant from `t_min >= 0` on.
///
/// With `s` the sign of the direction on an axis and `a = s (x - o)` the way to a plane `x`, a ray
/// reaches the plane at `a |1/d|`. With `m` and `M` the bounds of `|1/d|`, and `a` taken from the
/// origin nearest to or farthest from the plane, all rays reach it at `a m` or later and at `a M`
/// or sooner, as long as `a` is not negative. Where it is, so are the ray's and the beam's
/// parameters, and which negative number they are does not matter: no ray begins before zero.
/// As a product with the plane plus a constant, each bound costs one instruction.
pub(super) struct Beam<S: PacketSimd> {
    axes: [BeamAxis<S>; 3],
    t_min: S::F32x8,
}

/// The beam on one axis.
struct BeamAxis<S: PacketSimd> {
    /// Which of a box's planes is met first: 0 the smaller, 1 the larger.
    first: usize,
    /// `s m` and the constant for entering.
    enter: [S::F32x8; 2],
    /// `s M` and the constant for leaving.
    leave: [S::F32x8; 2],
}

impl<S: PacketSimd> BeamAxis<S> {
    /// `None` where that cannot be done in finite numbers.
    ///
    /// * `sign`: 1 or -1
    /// * `size`: `|1/d|`
    /// * `error`: by how much boxes are widened
    #[inline(always)]
    fn new(simd: S, sign: f32, o: S::F32x8, size: S::F32x8, error: S::F32x8) -> Option<BeamAxis<S>> {
        let (lo, hi) = (smallest(simd, o), largest(simd, o));
        let (nearest, farthest) = if sign > 0.0 { (hi, lo) } else { (lo, hi) };
        // Twice the error of one ray makes up for the rounding of these constants.
        let error = 2.0 * largest(simd, error);
        let [m, big] = [smallest(simd, size), largest(simd, size)];
        let (enter, leave) = ((-sign * nearest - error) * m, (error - sign * farthest) * big);
        (enter + leave).is_finite().then_some(BeamAxis {
            first: usize::from(sign < 0.0),
            enter: [simd.splat(sign * m), simd.splat(enter)],
            leave: [simd.splat(sign * big), simd.splat(leave)],
        })
    }

    #[inline(always)]
    fn enter(&self, simd: S, node: &Node, axis: usize, time: S::F32x8) -> S::F32x8 {
        let plane = node.planes(simd, 2 * axis + (self.first & 1), time);
        simd.mul_add(plane, self.enter[0], self.enter[1])
    }

    #[inline(always)]
    fn leave(&self, simd: S, node: &Node, axis: usize, time: S::F32x8) -> S::F32x8 {
        let plane = node.planes(simd, 2 * axis + (self.first & 1 ^ 1), time);
        simd.mul_add(plane, self.leave[0], self.leave[1])
    }
}

impl<S: PacketSimd> Beam<S> {
    /// The children whose boxes some ray may meet before `t_max`, and where the first enters each.
    #[inline(always)]
    pub(super) fn intersect(&self, simd: S, node: &Node, t_max: f32) -> (u32, S::F32x8) {
        // These nodes do not move: the time does not matter.
        let ([x, y, z], time) = (&self.axes, self.t_min);
        let near = simd.max(
            simd.max(x.enter(simd, node, 0, time), y.enter(simd, node, 1, time)),
            simd.max(z.enter(simd, node, 2, time), self.t_min),
        );
        let far = simd.min(
            simd.min(x.leave(simd, node, 0, time), y.leave(simd, node, 1, time)),
            simd.min(z.leave(simd, node, 2, time), simd.splat(t_max)),
        );
        (simd.le(near, far), near)
    }
}

/// The rays' side of box tests.
pub(super) struct Slabs<S: PacketSimd> {
    pub(super) beam: Beam<S>,
    axes: [Axis<S>; 3],
    t_min: S::F32x8,
}

/// The rays on one axis, as in [`crate::slabs`].
struct Axis<S: PacketSimd> {
    rd: S::F32x8,
    near: S::F32x8,
    far: S::F32x8,
}

impl<S: PacketSimd> Slabs<S> {
    /// `None` where the rays do not run into the same octant, or one begins before zero or can hit
    /// nothing.
    #[inline(always)]
    pub(super) fn new(simd: S, rays: &Rays<S>, reach: Vec3) -> Option<Slabs<S>> {
        let [dx, dy, dz] = [abs(simd, rays.d[0]), abs(simd, rays.d[1]), abs(simd, rays.d[2])];
        let least = simd.mul(simd.max(simd.max(dx, dy), dz), simd.splat(LEAST_SLOPE));
        let sizes = [
            simd.add(abs(simd, rays.o[0]), simd.splat(reach.x)),
            simd.add(abs(simd, rays.o[1]), simd.splat(reach.y)),
            simd.add(abs(simd, rays.o[2]), simd.splat(reach.z)),
        ];
        let largest =
            simd.mul(simd.max(simd.max(sizes[0], sizes[1]), sizes[2]), simd.splat(LARGEST_ERROR * U));
        let ([x, y, z], own) = (sizes, simd.splat(OWN_ERROR * U));
        let (x, beam_x) = Axis::new(simd, rays.o[0], rays.d[0], least, simd.mul_add(x, own, largest))?;
        let (y, beam_y) = Axis::new(simd, rays.o[1], rays.d[1], least, simd.mul_add(y, own, largest))?;
        let (z, beam_z) = Axis::new(simd, rays.o[2], rays.d[2], least, simd.mul_add(z, own, largest))?;
        let usable = simd.lt(rays.t_min, rays.t_max) & simd.le(simd.splat(0.0), rays.t_min);
        if usable != ALL {
            return None;
        }
        let beam = Beam { axes: [beam_x, beam_y, beam_z], t_min: simd.splat(smallest(simd, rays.t_min)) };
        Some(Slabs { beam, axes: [x, y, z], t_min: rays.t_min })
    }

    /// Which rays meet a child's box before their `t_max`.
    #[inline(always)]
    pub(super) fn intersect(&self, simd: S, node: &Node, slot: usize, t_max: S::F32x8) -> u32 {
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
        let Axis { rd, near, .. } = self.axes[axis];
        let plane = simd.splat(node.plane(2 * axis + (self.beam.axes[axis].first & 1), slot));
        simd.mul_add(plane, rd, near)
    }

    #[inline(always)]
    fn leave(&self, simd: S, node: &Node, slot: usize, axis: usize) -> S::F32x8 {
        let Axis { rd, far, .. } = self.axes[axis];
        let plane = simd.splat(node.plane(2 * axis + (self.beam.axes[axis].first & 1 ^ 1), slot));
        simd.mul_add(plane, rd, far)
    }
}

impl<S: PacketSimd> Axis<S> {
    /// `None` where the rays run both ways, or a number is not finite.
    #[inline(always)]
    fn new(
        simd: S,
        o: S::F32x8,
        d: S::F32x8,
        least: S::F32x8,
        error: S::F32x8,
    ) -> Option<(Axis<S>, BeamAxis<S>)> {
        let sign = match simd.signs(d) {
            0 => 1.0,
            ALL => -1.0,
            _ => return None,
        };
        let zero = simd.splat(0.0);
        let slope = simd.div(simd.splat(1.0), simd.max(abs(simd, d), least));
        let rd = simd.mul(slope, simd.splat(sign));
        let (base, slack) = (simd.mul(simd.sub(zero, o), rd), simd.mul(error, slope));
        let (near, far) = (simd.sub(base, slack), simd.add(base, slack));
        // Whatever was not finite has spread to here, and differs from itself.
        let sum = simd.sub(simd.sub(far, near), d);
        if simd.le(simd.sub(sum, sum), zero) != ALL {
            return None;
        }
        Some((Axis { rd, near, far }, BeamAxis::new(simd, sign, o, slope, error)?))
    }
}
