//! A tree over boxes that move while the shutter is open.

use kajo_math::{Aabb, Ray, Vec3};

use crate::boxes::SHAPE;
use crate::build::{self, Prims};
use crate::node::{Child, MovingNode};
use crate::simd::dispatch;
use crate::walk::Tree;
use crate::{BuildSettings, Stats};

/// A tree over boxes that move steadily: at the time `s` of a ray, from 0 at the opening of the
/// shutter to 1 at its closing, a box has the corners
///
/// ```text
/// p(s) = (1 - s) p_open + s p_close
/// ```
///
/// and a primitive must lie within its box at that time. What moves along a curve, such as
/// something that turns, takes boxes that hold the curve. Times outside 0 to 1 count as the
/// nearer end, and what is not a number as 0.
///
/// Queries are those of [`Bvh`](crate::Bvh), with the same promises. A box around a set of
/// boxes that move steadily, made at both ends, holds them at all times in between, so the
/// nodes of the tree move the same way.
#[derive(Clone, Debug)]
pub struct MovingBvh {
    tree: Tree<MovingNode>,
    leaves: usize,
    dropped: usize,
}

impl Default for MovingBvh {
    fn default() -> MovingBvh {
        MovingBvh { tree: Tree::EMPTY, leaves: 0, dropped: 0 }
    }
}

impl MovingBvh {
    /// Builds a tree over boxes at the opening and the closing of the shutter.
    ///
    /// Boxes that are empty, or whose places or motion are not finite, are left out and
    /// counted; so is what comes after the first 2^31 boxes. The number of threads of the
    /// current rayon pool does not change the tree.
    pub fn build(boxes: &[[Aabb; 2]], settings: &BuildSettings) -> MovingBvh {
        let prims =
            Prims::new(boxes.len().min(Child::LIMIT), |id| middle(boxes[id as usize]).map(Into::into));
        let leaf = |ids: &[u32], _: &mut [()], _: usize| ids[0];
        let Some(built) = build::build(prims, SHAPE, settings.quality, build::NO_CORNERS, leaf) else {
            return MovingBvh::default();
        };
        let tree = built.tree.moving(|id| boxes[id as usize]);
        MovingBvh { tree, leaves: built.leaves, dropped: boxes.len() - built.leaves }
    }

    /// As [`Bvh::closest`](crate::Bvh::closest), among boxes as they are at the ray's time.
    #[inline]
    pub fn closest(&self, ray: &Ray, hit: impl FnMut(u32, f32) -> f32) {
        dispatch!(simd => self.tree.nearest(simd, ray, Vec3::ZERO, hit))
    }

    /// As [`Bvh::any`](crate::Bvh::any), among boxes as they are at the ray's time.
    #[inline]
    pub fn any(&self, ray: &Ray, hit: impl FnMut(u32) -> bool) -> bool {
        dispatch!(simd => self.tree.any(simd, ray, Vec3::ZERO, hit))
    }

    /// As [`Bvh::each`](crate::Bvh::each), among boxes as they are at the ray's time.
    #[inline]
    pub fn each(&self, ray: &Ray, mut visit: impl FnMut(u32)) {
        self.any(ray, |primitive| {
            visit(primitive);
            false
        });
    }

    /// The box around everything at any time; empty when there is nothing.
    pub fn bounds(&self) -> Aabb {
        self.tree.bounds
    }

    /// Size, depth and memory of the tree.
    pub fn stats(&self) -> Stats {
        self.tree.stats(self.leaves, self.dropped)
    }
}

/// The box halfway, which decides the shape of the tree; `None` for one that cannot be used.
fn middle([open, close]: [Aabb; 2]) -> Option<Aabb> {
    let motion_is_finite = (close.min - open.min).is_finite() && (close.max - open.max).is_finite();
    let usable = [open, close].iter().all(|b| b.is_finite() && !b.is_empty()) && motion_is_finite;
    let half = |a, b| 0.5 * a + 0.5 * b;
    usable.then(|| Aabb { min: half(open.min, close.min), max: half(open.max, close.max) })
}
