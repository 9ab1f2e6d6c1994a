//! Wide nodes: the boxes of up to eight children, laid out for one vector instruction each.

use bytemuck::{Pod, Zeroable};
use kajo_math::Aabb;

use crate::simd::Simd;

/// Children of a node.
pub(crate) const WIDTH: usize = 8;

/// What a slot of a node leads to: the number of a node, or a leaf.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(transparent)]
pub(crate) struct Child(pub(crate) u32);

impl Child {
    const LEAF: u32 = 1 << 31;
    /// Numbers that a child can hold.
    pub(crate) const LIMIT: usize = Child::LEAF as usize;

    pub(crate) fn node(index: usize) -> Child {
        debug_assert!(index < Child::LIMIT);
        Child(index as u32)
    }

    /// A leaf, told apart by 31 bits of the caller's choice.
    pub(crate) fn leaf(payload: u32) -> Child {
        debug_assert!(payload < Child::LEAF);
        Child(payload | Child::LEAF)
    }

    #[inline(always)]
    pub(crate) fn is_leaf(self) -> bool {
        self.0 & Child::LEAF != 0
    }

    /// The number of the node, or the payload of the leaf.
    #[inline(always)]
    pub(crate) fn index(self) -> u32 {
        self.0 & !Child::LEAF
    }
}

/// What a ray needs of a node.
pub(crate) trait Wide: Pod + Send + Sync {
    /// By how much a plane may be off, in units of `2^-24` times the largest coordinate.
    const ERROR: f32;

    /// Planes of all children at a moment: twice the axis, plus one for the larger side.
    fn planes<S: Simd>(&self, simd: S, row: usize, time: S::F32x8) -> S::F32x8;

    /// Where a slot leads.
    fn child(&self, slot: usize) -> Child;
}

/// Smallest and largest x, y and z of the children's boxes.
type Planes = [[f32; WIDTH]; 6];

const NO_PLANES: Planes = {
    let (none, all) = ([f32::INFINITY; WIDTH], [f32::NEG_INFINITY; WIDTH]);
    [none, all, none, all, none, all]
};

/// Up to eight children. Empty slots have boxes that no ray meets.
///
/// 256 bytes, so that a node is found by a shift, and both planes of an axis share a cache
/// line.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C, align(64))]
pub(crate) struct Node {
    planes: Planes,
    children: [Child; WIDTH],
    /// Slots in use, the first ones.
    used: u32,
    /// Fills up the cache line.
    spare: [u32; WIDTH - 1],
}

impl Node {
    pub(crate) const EMPTY: Node =
        Node { planes: NO_PLANES, children: [Child(0); WIDTH], used: 0, spare: [0; WIDTH - 1] };

    /// Fills the next slot.
    pub(crate) fn push(&mut self, bounds: &Aabb, child: Child) {
        self.children[self.used as usize] = child;
        self.used += 1;
        self.set_bounds(self.used as usize - 1, bounds);
    }

    /// Changes the box of a slot.
    pub(crate) fn set_bounds(&mut self, slot: usize, bounds: &Aabb) {
        for axis in 0..3 {
            self.planes[2 * axis][slot] = bounds.min[axis];
            self.planes[2 * axis + 1][slot] = bounds.max[axis];
        }
    }

    /// A plane of one child: twice the axis, plus one for the larger side.
    #[cfg(any(test, feature = "bench"))]
    #[inline(always)]
    pub(crate) fn plane(&self, row: usize, slot: usize) -> f32 {
        self.planes[row][slot % WIDTH]
    }

    /// Where the used slots lead.
    #[inline(always)]
    pub(crate) fn children(&self) -> &[Child] {
        &self.children[..(self.used as usize).min(WIDTH)]
    }

    pub(crate) fn children_mut(&mut self) -> &mut [Child] {
        &mut self.children[..self.used as usize]
    }
}

impl Wide for Node {
    const ERROR: f32 = 0.0;

    #[inline(always)]
    fn planes<S: Simd>(&self, simd: S, row: usize, _time: S::F32x8) -> S::F32x8 {
        simd.load(&self.planes[row])
    }

    #[inline(always)]
    fn child(&self, slot: usize) -> Child {
        self.children[slot % WIDTH]
    }
}

/// Up to eight children whose boxes move steadily while the shutter is open.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C, align(64))]
pub(crate) struct MovingNode {
    /// When the shutter opens.
    planes: Planes,
    /// How far they go until it closes.
    motion: Planes,
    children: [Child; WIDTH],
    /// Fills up the cache line.
    spare: [u32; WIDTH],
}

impl MovingNode {
    /// The children of `node`, with boxes of their own.
    pub(crate) fn new(node: &Node, bounds: impl Fn(Child) -> [Aabb; 2]) -> MovingNode {
        let motion = [[0.0; WIDTH]; 6];
        let mut moving = MovingNode { planes: NO_PLANES, motion, children: node.children, spare: [0; WIDTH] };
        for (slot, child) in node.children().iter().enumerate() {
            let [open, close] = bounds(*child);
            for axis in 0..3 {
                moving.planes[2 * axis][slot] = open.min[axis];
                moving.planes[2 * axis + 1][slot] = open.max[axis];
                moving.motion[2 * axis][slot] = close.min[axis] - open.min[axis];
                moving.motion[2 * axis + 1][slot] = close.max[axis] - open.max[axis];
            }
        }
        moving
    }
}

impl Wide for MovingNode {
    // With `R` the largest coordinate: 2 R for the rounded motion, 2 R for its product with
    // the time, R for the sum.
    const ERROR: f32 = 5.0;

    #[inline(always)]
    fn planes<S: Simd>(&self, simd: S, row: usize, time: S::F32x8) -> S::F32x8 {
        simd.mul_add(simd.load(&self.motion[row]), time, simd.load(&self.planes[row]))
    }

    #[inline(always)]
    fn child(&self, slot: usize) -> Child {
        self.children[slot % WIDTH]
    }
}
