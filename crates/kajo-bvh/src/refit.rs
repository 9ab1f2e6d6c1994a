//! New boxes for a tree that keeps its shape: for things that move a little.
//!
//! Nodes come after their parents, so one pass from the last node to the first sees children
//! before parents.

use kajo_math::Aabb;

use crate::array::Array;
use crate::node::{Child, MovingNode};
use crate::walk::Tree;

impl Tree {
    /// Fits all boxes around leaves that have changed; `leaf` answers the box of what a leaf
    /// holds.
    pub(crate) fn refit(&mut self, leaf: impl Fn(u32) -> Aabb) {
        let mut bounds = vec![Aabb::EMPTY; self.nodes.len()];
        let of = |child: Child, bounds: &[Aabb]| match child.is_leaf() {
            true => leaf(child.index()),
            false => bounds[child.index() as usize],
        };
        for (i, node) in self.nodes.iter_mut().enumerate().rev() {
            for slot in 0..node.children().len() {
                let child = of(node.children()[slot], &bounds);
                node.set_bounds(slot, &child);
                bounds[i] = bounds[i].union(child);
            }
        }
        self.bounds = self.root.map_or(Aabb::EMPTY, |root| of(root, &bounds));
    }

    /// The same tree with boxes that move; `leaf` answers where that of a leaf begins and ends.
    pub(crate) fn moving(&self, leaf: impl Fn(u32) -> [Aabb; 2]) -> Tree<MovingNode> {
        let mut bounds = vec![[Aabb::EMPTY; 2]; self.nodes.len()];
        let mut nodes = Array::zeroed(self.nodes.len());
        let of = |child: Child, bounds: &[[Aabb; 2]]| match child.is_leaf() {
            true => leaf(child.index()),
            false => bounds[child.index() as usize],
        };
        for (i, node) in self.nodes.iter().enumerate().rev() {
            nodes[i] = MovingNode::new(node, |child| of(child, &bounds));
            bounds[i] = node.children().iter().fold([Aabb::EMPTY; 2], |[open, close], &child| {
                let [a, b] = of(child, &bounds);
                [open.union(a), close.union(b)]
            });
        }
        let [open, close] = self.root.map_or([Aabb::EMPTY; 2], |root| of(root, &bounds));
        Tree { nodes, root: self.root, bounds: open.union(close), depth: self.depth }
    }
}
