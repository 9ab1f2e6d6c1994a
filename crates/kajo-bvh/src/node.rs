//! Wide nodes: the boxes of up to eight children, laid out for one vector instruction each.

use kajo_math::{Aabb, Vec3};

/// Children of a node.
pub(crate) const WIDTH: usize = 8;

/// Wide nodes on the longest way from the root to a leaf, the root counted: the builder
/// keeps to it, traversal relies on it.
pub(crate) const MAX_DEPTH: usize = 32;

/// What a slot of a node leads to: the number of a node, or a leaf.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(crate) struct Node {
    /// By axis, smallest or largest, child.
    pub(crate) planes: [[[f32; WIDTH]; 2]; 3],
    pub(crate) children: [Child; WIDTH],
}

impl Node {
    pub(crate) const EMPTY: Node = Node {
        planes: [[[f32::INFINITY; WIDTH], [f32::NEG_INFINITY; WIDTH]]; 3],
        children: [Child(0); WIDTH],
    };

    /// Fills a slot.
    pub(crate) fn set(&mut self, slot: usize, bounds: &Aabb, child: Child) {
        for (axis, planes) in self.planes.iter_mut().enumerate() {
            planes[0][slot] = bounds.min[axis];
            planes[1][slot] = bounds.max[axis];
        }
        self.children[slot] = child;
    }


    /// Whether a slot leads anywhere.
    #[inline]
    pub(crate) fn is_used(&self, slot: usize) -> bool {
        self.planes[0][0][slot] <= self.planes[0][1][slot]
    }
}
