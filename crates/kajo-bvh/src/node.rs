//! Wide nodes: the boxes of up to eight children, laid out for one vector instruction each.

use bytemuck::{Pod, Zeroable};
use kajo_math::Aabb;

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

/// Up to eight children. Empty slots have boxes that no ray meets.
///
/// 256 bytes, so that a node is found by a shift, and both planes of an axis share a cache
/// line.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C, align(64))]
pub(crate) struct Node {
    /// Smallest and largest x, y and z of the children's boxes.
    planes: [[f32; WIDTH]; 6],
    children: [Child; WIDTH],
    /// Fills up the cache line.
    spare: [u32; WIDTH],
}

impl Node {
    pub(crate) const EMPTY: Node = {
        let (none, all) = ([f32::INFINITY; WIDTH], [f32::NEG_INFINITY; WIDTH]);
        Node { planes: [none, all, none, all, none, all], children: [Child(0); WIDTH], spare: [0; WIDTH] }
    };

    /// Fills a slot.
    pub(crate) fn set(&mut self, slot: usize, bounds: &Aabb, child: Child) {
        for axis in 0..3 {
            self.planes[2 * axis][slot] = bounds.min[axis];
            self.planes[2 * axis + 1][slot] = bounds.max[axis];
        }
        self.children[slot] = child;
    }

    /// Whether a slot leads anywhere.
    fn is_used(&self, slot: usize) -> bool {
        self.planes[0][slot] <= self.planes[1][slot]
    }

    /// Planes of all children: twice the axis, plus one for the larger side.
    #[inline(always)]
    pub(crate) fn planes(&self, row: usize) -> &[f32; WIDTH] {
        &self.planes[row]
    }

    /// Where a slot leads.
    #[inline(always)]
    pub(crate) fn child(&self, slot: usize) -> Child {
        self.children[slot % WIDTH]
    }

    /// Changes where used slots lead.
    pub(crate) fn map_children(&mut self, f: impl Fn(Child) -> Child) {
        for slot in 0..WIDTH {
            if self.is_used(slot) {
                self.children[slot] = f(self.children[slot]);
            }
        }
    }
}
