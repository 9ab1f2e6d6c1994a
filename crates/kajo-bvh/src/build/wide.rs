//! Wide nodes and leaves, as the binary tree's [`Plan`](super::plan::Plan)s say.
//!
//! Subtrees below the stems are measured first, so that each thread writes its nodes and leaf
//! blocks where they are to stay.

use bytemuck::Pod;
use rayon::prelude::*;

use super::binary::{At, Binary, Forest, Grove, Spot};
use super::{Built, LeafShape};
use crate::array::Array;
use crate::node::{Child, Node, WIDTH};
use crate::walk::Tree;

/// Subtrees that a thread takes at a time.
const ROOTS: usize = 16;
/// Most primitives in a leaf.
pub(super) const MOST: usize = 32;

/// The binary nodes that fill the slots of a wide one.
struct Slots<A> {
    at: [A; WIDTH],
    len: usize,
}

impl<A: Copy> Slots<A> {
    /// Those of the wide node that replaces a binary one; `None` if it is to be a leaf.
    #[inline]
    fn new<T: Binary<At = A>>(tree: &T, at: A) -> Option<Slots<A>> {
        let plan = tree.plan(at);
        let [left, right] = tree.children(at).filter(|_| !plan.is_leaf())?;
        let mut slots = Slots { at: [at; WIDTH], len: 0 };
        slots.gather(tree, left, plan.left(WIDTH));
        slots.gather(tree, right, WIDTH - plan.left(WIDTH));
        Some(slots)
    }

    /// Adds up to `n` slots that cover the subtree at the least cost.
    fn gather<T: Binary<At = A>>(&mut self, tree: &T, at: A, mut n: usize) {
        let plan = tree.plan(at);
        while n > 1 && plan.left(n) == 0 {
            n -= 1;
        }
        match tree.children(at).filter(|_| n > 1) {
            Some([left, right]) => {
                self.gather(tree, left, plan.left(n));
                self.gather(tree, right, n - plan.left(n));
            }
            None => {
                self.at[self.len] = at;
                self.len += 1;
            }
        }
    }

    fn all(&self) -> &[A] {
        &self.at[..self.len]
    }
}

/// What a subtree takes.
#[derive(Clone, Copy, Default)]
struct Size {
    nodes: usize,
    leaves: usize,
    blocks: usize,
    /// Nodes from the root of the tree to the deepest leaf.
    depth: usize,
}

impl Size {
    fn and(self, other: Size) -> Size {
        Size {
            nodes: self.nodes + other.nodes,
            leaves: self.leaves + other.leaves,
            blocks: self.blocks + other.blocks,
            depth: self.depth.max(other.depth),
        }
    }
}

/// Where a thread writes, and which numbers its first node and block have.
struct Room<'a, B> {
    nodes: &'a mut [Node],
    first_node: usize,
    blocks: &'a mut [B],
    first_block: usize,
}

impl<'a, B> Room<'a, B> {
    /// Takes off the room for a subtree.
    fn take(&mut self, size: Size) -> Room<'a, B> {
        let (nodes, more_nodes) = std::mem::take(&mut self.nodes).split_at_mut(size.nodes);
        let (blocks, more_blocks) = std::mem::take(&mut self.blocks).split_at_mut(size.blocks);
        let (first_node, first_block) = (self.first_node, self.first_block);
        *self = Room {
            nodes: more_nodes,
            first_node: first_node + size.nodes,
            blocks: more_blocks,
            first_block: first_block + size.blocks,
        };
        Room { nodes, first_node, blocks, first_block }
    }
}

impl Forest {
    /// The wide tree. `leaf` gets the primitives of a leaf in ascending order, the blocks to
    /// fill with them and the number of the first, and answers what the leaf is to hold.
    ///
    /// Returns `None` if there would be more than `shape.limit` blocks.
    pub(super) fn wide<B: Pod + Send>(
        &self,
        shape: LeafShape,
        leaf: impl Fn(&[u32], &mut [B], usize) -> u32 + Sync,
    ) -> Option<Built<B>> {
        let (mut top, mut roots) = (Vec::new(), Vec::new());
        let root = self.top(self.root(), 0, &mut top, &mut roots);
        let measure = |roots: &[(Spot, usize)]| {
            roots.iter().fold(Size::default(), |sum, &(spot, depth)| {
                sum.and(self.grove(spot).measure(spot, depth, shape))
            })
        };
        let sizes: Vec<Size> = roots.par_chunks(ROOTS).map(measure).collect();
        let size =
            sizes.iter().fold(Size { nodes: top.len(), ..Size::default() }, |sum, &size| sum.and(size));
        if size.blocks > shape.limit || size.nodes > Child::LIMIT {
            return None;
        }
        let (mut nodes, mut blocks) = (Array::<Node>::zeroed(size.nodes), Array::<B>::zeroed(size.blocks));
        let (above, below) = nodes.split_at_mut(top.len());
        let mut room = Room { nodes: below, first_node: top.len(), blocks: &mut blocks, first_block: 0 };
        let rooms: Vec<_> = sizes.iter().map(|&size| room.take(size)).collect();
        let fill = |(roots, mut room): (&[(Spot, usize)], Room<'_, B>)| {
            roots
                .iter()
                .map(|&(spot, _)| self.grove(spot).fill(spot, &mut room, shape, &leaf))
                .collect::<Vec<_>>()
        };
        let children: Vec<_> = roots.par_chunks(ROOTS).zip(rooms).flat_map_iter(fill).collect();
        let place = |child: Child| if child.is_leaf() { children[child.index() as usize] } else { child };
        above.copy_from_slice(&top);
        above.iter_mut().flat_map(Node::children_mut).for_each(|child| *child = place(*child));
        let bounds = self.bounds(self.root()).aabb();
        let tree = Tree { nodes, root: Some(place(root)), bounds, depth: size.depth };
        Some(Built { tree, blocks, leaves: size.leaves, cut: self.is_cut() })
    }

    /// Adds nodes for all stems that become nodes. What lies below is added to `roots` with
    /// its depth, and stands in `top` as a leaf of that number.
    fn top(&self, at: At, depth: usize, top: &mut Vec<Node>, roots: &mut Vec<(Spot, usize)>) -> Child {
        if let At::Twig(spot) = at {
            roots.push((spot, depth));
            return Child::leaf(roots.len() as u32 - 1);
        }
        let node = top.len();
        top.push(Node::EMPTY);
        for at in Slots::new(self, at).iter().flat_map(Slots::all) {
            let child = self.top(*at, depth + 1, top, roots);
            top[node].push(&self.bounds(*at).aabb(), child);
        }
        Child::node(node)
    }
}

impl Grove {
    /// The primitives of a leaf, each once, in ascending order.
    fn sorted<'a>(&self, spot: Spot, sorted: &'a mut [u32; MOST]) -> &'a [u32] {
        let ids = self.ids(spot);
        let sorted = &mut sorted[..ids.len()];
        sorted.copy_from_slice(ids);
        sorted.sort_unstable();
        if !self.cut {
            return sorted;
        }
        let mut len = 0;
        for i in 0..sorted.len() {
            if i == 0 || sorted[i] != sorted[len - 1] {
                sorted[len] = sorted[i];
                len += 1;
            }
        }
        &sorted[..len]
    }

    /// How many primitives a leaf holds.
    fn leaf_len(&self, spot: Spot) -> usize {
        if self.cut { self.sorted(spot, &mut [0; MOST]).len() } else { self.twig(spot).len() }
    }

    /// What a subtree takes whose root lies below `depth` nodes.
    fn measure(&self, spot: Spot, depth: usize, shape: LeafShape) -> Size {
        let Some(slots) = Slots::new(self, spot) else {
            return Size { nodes: 0, leaves: 1, blocks: shape.blocks(self.leaf_len(spot)), depth };
        };
        let below = slots.all().iter().map(|&spot| self.measure(spot, depth + 1, shape));
        below.fold(Size { nodes: 1, ..Size::default() }, Size::and)
    }

    /// Writes a subtree to the front of `room`.
    fn fill<B>(
        &self,
        spot: Spot,
        room: &mut Room<'_, B>,
        shape: LeafShape,
        leaf: &impl Fn(&[u32], &mut [B], usize) -> u32,
    ) -> Child {
        let Some(slots) = Slots::new(self, spot) else {
            let mut sorted = [0; MOST];
            let sorted = self.sorted(spot, &mut sorted);
            let own = room.take(Size { blocks: shape.blocks(sorted.len()), ..Size::default() });
            return Child::leaf(leaf(sorted, own.blocks, own.first_block));
        };
        let own = room.take(Size { nodes: 1, ..Size::default() });
        let node = &mut own.nodes[0];
        *node = Node::EMPTY;
        for &spot in slots.all() {
            let child = self.fill(spot, room, shape, leaf);
            node.push(&self.twig(spot).bounds().aabb(), child);
        }
        Child::node(own.first_node)
    }
}
