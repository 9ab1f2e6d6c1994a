//! A ray made ready for box tests that never miss.
//!
//! The ray enters a slab `lo <= x <= hi` at `t = (lo - o) / d`, here evaluated as
//! `lo * rd + c` with `rd = 1 / d` and `c = -o * rd`, near and far planes chosen by the
//! sign of `d`. A hit that a primitive's own test accepts lies within its box but for
//! rounding, so the slabs are widened until rounding cannot matter
//! [Woop, Benthin and Wald 2013, sec. 3.2-3.3].
//!
//! With `u = 2^-24`, `k` an axis, `z` the axis along which the ray runs fastest and `S` the
//! largest `|v - o|` of any vertex on each axis, bounded by `|o| + reach`:
//!
//! - a sheared vertex of the triangle test is off by at most `2u S_k + 5u S_z`,
//! - its parameter `t` by `3u S_z / |d_z|`, which moves the point by `3u S_z`,
//! - the slab's own products and sums by `5u S_k`,
//! - replacing a tiny `d_k` by `2^-30 d_z` by `2^-30 S_z`.
//!
//! In all less than `7u S_k + 9u S_z`; the largest `S` stands for `S_z` below. Planes that
//! move add [`Wide::ERROR`].

use kajo_math::{Ray, Vec3, Vec3A};

use crate::node::Wide;
use crate::simd::Simd;

/// `2^-24`, half the distance from 1 to the next larger number.
pub(crate) const U: f32 = 0.5 * f32::EPSILON;
/// By how many `u S_k` and `u S` boxes are widened.
pub(crate) const OWN_ERROR: f32 = 7.0;
pub(crate) const LARGEST_ERROR: f32 = 9.0;
/// A direction on an axis counts as at least so much of the largest one.
pub(crate) const LEAST_SLOPE: f32 = 1.0 / (1u32 << 30) as f32;

/// The ray's side of eight slab tests at a time.
pub(crate) struct Slabs<S: Simd> {
    simd: S,
    /// Which of a node's planes is met first on each axis: 0 the smaller, 1 the larger.
    first: [usize; 3],
    rd: [S::F32x8; 3],
    near: [S::F32x8; 3],
    far: [S::F32x8; 3],
    t_min: S::F32x8,
    /// Moment within the shutter interval.
    time: S::F32x8,
}

impl<S: Simd> Slabs<S> {
    /// Prepares `ray` for boxes whose coordinates are at most `reach` in size.
    ///
    /// Returns `None` for rays that hit nothing: an empty range, no direction, or a number in
    /// origin or direction that is not finite or out of all proportion.
    #[inline(always)]
    pub(crate) fn new<N: Wide>(simd: S, ray: &Ray, reach: Vec3) -> Option<Slabs<S>> {
        let (o, d) = (Vec3A::from(ray.o), Vec3A::from(ray.d));
        // A direction along a slab would divide by zero; the tilt is within the error bound.
        let least = Vec3A::splat(d.abs().max_element() * LEAST_SLOPE);
        let rd = d.abs().max(least).copysign(d).recip();
        let s = o.abs() + Vec3A::from(reach);
        let error = ((OWN_ERROR + N::ERROR) * U) * s + Vec3A::splat((LARGEST_ERROR * U) * s.max_element());
        let (base, slack) = (-o * rd, error * rd.abs());
        let (near, far) = (base - slack, base + slack);
        // Whatever was not finite has spread to here.
        if !((far - near + d).is_finite() && ray.t_min < ray.t_max) {
            return None;
        }
        let time = if ray.time > 0.0 { ray.time.min(1.0) } else { 0.0 };
        let splat = |v: Vec3A| v.to_array().map(|x| simd.splat(x));
        let backward = rd.cmplt(Vec3A::ZERO).bitmask() as usize;
        Some(Slabs {
            simd,
            first: [backward & 1, backward >> 1 & 1, backward >> 2 & 1],
            rd: splat(rd),
            near: splat(near),
            far: splat(far),
            t_min: simd.splat(ray.t_min),
            time: simd.splat(time),
        })
    }

    /// Which children's boxes the ray meets before `t_max`, and where it enters each.
    #[inline(always)]
    pub(crate) fn intersect(&self, node: &impl Wide, t_max: f32) -> (u32, S::F32x8) {
        let simd = self.simd;
        let at = |axis: usize, side: usize, c: &[S::F32x8; 3]| {
            simd.mul_add(node.planes(simd, 2 * axis + (side & 1), self.time), self.rd[axis], c[axis])
        };
        let enter = |axis: usize| at(axis, self.first[axis], &self.near);
        let leave = |axis: usize| at(axis, self.first[axis] ^ 1, &self.far);
        let near = simd.max(simd.max(enter(0), enter(1)), simd.max(enter(2), self.t_min));
        let far = simd.min(simd.min(leave(0), leave(1)), simd.min(leave(2), simd.splat(t_max)));
        (simd.le(near, far), near)
    }
}
