//! A tree over boxes of arbitrary primitives.

use kajo_math::{Aabb, Ray, Vec3};

use crate::build::{self, LeafShape, Prims};
use crate::node::Child;
use crate::simd::dispatch;
use crate::walk::Tree;
use crate::{BuildSettings, Stats};

/// One primitive to a leaf: testing a primitive is expensive.
pub(crate) const SHAPE: LeafShape = LeafShape { block_bits: 0, most: 1, limit: Child::LIMIT };

/// A tree over the boxes of primitives that the caller intersects.
///
/// A query visits every primitive that has a hit within its box, and few others: boxes are
/// widened by the rounding of the ray's arithmetic, so a hit that rounding has moved just
/// out of its box is not lost.
#[derive(Clone, Debug)]
pub struct Bvh {
    pub(crate) tree: Tree,
    leaves: usize,
    dropped: usize,
}

impl Default for Bvh {
    fn default() -> Bvh {
        Bvh { tree: Tree::EMPTY, leaves: 0, dropped: 0 }
    }
}

impl Bvh {
    /// Builds a tree over `boxes`. Boxes that are empty or not finite are left out and
    /// counted; so is what comes after the first 2^31 boxes.
    ///
    /// Threads of the current rayon pool share the work; their number does not change the
    /// tree.
    pub fn build(boxes: &[Aabb], settings: &BuildSettings) -> Bvh {
        let prims = Prims::new(boxes.len().min(Child::LIMIT), |id| usable(boxes, id).map(Into::into));
        let leaf = |ids: &[u32], _: &mut [()], _: usize| ids[0];
        let Some(built) = build::build(prims, SHAPE, settings.quality, build::NO_CORNERS, leaf) else {
            return Bvh::default();
        };
        Bvh { tree: built.tree, leaves: built.leaves, dropped: boxes.len() - built.leaves }
    }

    /// Takes new boxes for the same primitives and keeps the shape of the tree: fast, and fine
    /// for small changes; after large ones a new tree is faster to trace.
    ///
    /// A primitive whose box is missing, empty or not finite is not visited until it gets
    /// another. What was left out by [`Bvh::build`] stays out.
    pub fn refit(&mut self, boxes: &[Aabb]) {
        self.tree.refit(|id| usable(boxes, id).unwrap_or(Aabb::EMPTY));
    }

    /// Calls `hit(primitive, t_max)` for primitives whose boxes the ray meets up to `t_max`,
    /// nearest box first. `hit` answers the new `t_max`: the parameter of the hit if it
    /// accepts one, else the `t_max` it was given.
    ///
    /// A box entered exactly at `t_max` is still visited, so of equally near hits the caller
    /// can choose one by its own rule, such as the lowest number.
    #[inline]
    pub fn closest(&self, ray: &Ray, hit: impl FnMut(u32, f32) -> f32) {
        dispatch!(simd => self.tree.nearest(simd, ray, Vec3::ZERO, hit))
    }

    /// Whether `hit` is true of any primitive whose box the ray meets.
    #[inline]
    pub fn any(&self, ray: &Ray, hit: impl FnMut(u32) -> bool) -> bool {
        dispatch!(simd => self.tree.any(simd, ray, Vec3::ZERO, hit))
    }

    /// [`Bvh::closest`] for a ray that was worked out from larger numbers than its own, such as one
    /// in the space of an object that stands far from where its origin was given.
    ///
    /// * `size`: of those numbers on each axis; boxes are widened by some of their rounding errors, 7
    ///   times `2^-24 size`, and 9 times that of the largest of them
    #[inline]
    pub fn closest_of_derived(&self, ray: &Ray, size: Vec3, hit: impl FnMut(u32, f32) -> f32) {
        dispatch!(simd => self.tree.nearest(simd, ray, size, hit))
    }

    /// [`Bvh::any`] for a ray that was worked out from larger numbers than its own.
    ///
    /// * `size`: as for [`Bvh::closest_of_derived`]
    #[inline]
    pub fn any_of_derived(&self, ray: &Ray, size: Vec3, hit: impl FnMut(u32) -> bool) -> bool {
        dispatch!(simd => self.tree.any(simd, ray, size, hit))
    }

    /// Calls `visit` once for every primitive whose box the ray meets, in no set order.
    #[inline]
    pub fn each(&self, ray: &Ray, mut visit: impl FnMut(u32)) {
        self.any(ray, |primitive| {
            visit(primitive);
            false
        });
    }

    /// The box around everything; empty when there is nothing.
    pub fn bounds(&self) -> Aabb {
        self.tree.bounds
    }

    /// Size, depth and memory of the tree.
    pub fn stats(&self) -> Stats {
        self.tree.stats(self.leaves, self.dropped)
    }
}

/// The box of a primitive if a tree can hold it.
fn usable(boxes: &[Aabb], id: u32) -> Option<Aabb> {
    boxes.get(id as usize).copied().filter(|b| b.is_finite() && !b.is_empty())
}
