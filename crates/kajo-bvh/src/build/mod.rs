//! From boxes to wide nodes: a binary tree by the surface area heuristic ([`binary`],
//! [`split`]), for the best quality improved by moving subtrees ([`reinsert`]), then the best
//! wide tree within it ([`collapse`]).

mod binary;
mod collapse;
mod prim;
mod reinsert;
mod split;

use kajo_math::Aabb;
use rayon::prelude::*;

pub(crate) use self::binary::MAX_LEVELS;
use self::binary::Set;
use self::collapse::{Collapse, ROOTS};
pub(crate) use self::prim::Prim;
use self::split::PIECE;
use crate::Quality;
use crate::node::{Child, Node, WIDTH};
use crate::walk::Tree;

/// How primitives go into leaves.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LeafShape {
    /// Primitives that are tested together at the price of one.
    pub(crate) block: u32,
    /// Most primitives in a leaf.
    pub(crate) most: usize,
}

/// A tree whose leaves are still sets of primitives.
pub(crate) struct Built {
    /// Nodes above the parts, root first. A child leads to a node of these or, as a leaf, to
    /// a subtree of a part.
    top: Vec<Node>,
    pub(crate) parts: Vec<Part>,
    bounds: Aabb,
    depth: usize,
}

/// A piece of the tree that one thread built. Its nodes and leaves are numbered within it.
#[derive(Default)]
pub(crate) struct Part {
    nodes: Vec<Node>,
    /// Its subtrees, none below another.
    roots: Vec<Child>,
    /// Primitives of all leaves, leaf after leaf.
    ids: Vec<u32>,
    /// Where each leaf ends in `ids`.
    ends: Vec<u32>,
    /// Nodes from the root of the tree to the deepest leaf.
    depth: usize,
}

impl Part {
    /// The primitives of each leaf, in the order of their numbers.
    pub(crate) fn leaves(&self) -> impl Iterator<Item = &[u32]> {
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        starts.zip(&self.ends).map(|(start, &end)| &self.ids[start as usize..end as usize])
    }
}

/// Builds a tree over `prims`, each with a box that is not empty and finite.
pub(crate) fn build(mut prims: Vec<Prim>, shape: LeafShape, quality: Quality) -> Built {
    let bounds = split::bounds(&prims);
    let mut built = Built { top: Vec::new(), parts: Vec::new(), bounds: bounds.aabb(), depth: 0 };
    if prims.is_empty() {
        built.bounds = Aabb::EMPTY;
        return built;
    }
    let spare = if prims.len() >= 2 * PIECE { prims.len() } else { 0 };
    let mut spare: Vec<Prim> = (0..spare).into_par_iter().map(|_| Prim::NONE).collect();
    let n = prims.len();
    let mut groves = binary::build(Set { prims: &mut prims, spare: &mut spare, bounds }, shape.block);
    drop((prims, spare));
    match quality {
        Quality::Fast => reinsert::improve_top(&mut groves, n, shape.most),
        Quality::High => groves = reinsert::improve(groves),
    }
    (built.top, built.parts) = Collapse::new(&groves, shape).wide();
    built.depth = built.parts.iter().map(|part| part.depth).max().unwrap_or_default();
    built
}

impl Built {
    /// The finished tree, with `payloads[p][l]` for leaf `l` of part `p`.
    pub(crate) fn finish(&self, payloads: &[Vec<u32>]) -> Tree {
        let mut bases = Vec::with_capacity(self.parts.len());
        let mut total = self.top.len();
        for part in &self.parts {
            bases.push(total);
            total += part.nodes.len();
        }
        let in_part = |p: usize, child: Child| {
            let index = child.index() as usize;
            if child.is_leaf() { Child::leaf(payloads[p][index]) } else { Child::node(bases[p] + index) }
        };
        let root_of = |number: usize| {
            let p = number / ROOTS;
            in_part(p, self.parts[p].roots[number % ROOTS])
        };
        let node = |i: usize| {
            let (mut node, home) = match i.checked_sub(self.top.len()) {
                None => (self.top[i], None),
                Some(_) => {
                    let p = bases.partition_point(|&base| base <= i) - 1;
                    (self.parts[p].nodes[i - bases[p]], Some(p))
                }
            };
            for slot in 0..WIDTH {
                let child = node.child(slot);
                if node.is_used(slot) {
                    *node.child_mut(slot) = match home {
                        Some(p) => in_part(p, child),
                        None if child.is_leaf() => root_of(child.index() as usize),
                        None => child,
                    };
                }
            }
            node
        };
        let nodes: Vec<Node> = (0..total).into_par_iter().map(node).collect();
        let root = if self.top.is_empty() {
            (!self.parts.is_empty()).then(|| root_of(0))
        } else {
            Some(Child::node(0))
        };
        Tree { nodes, root, bounds: self.bounds, depth: self.depth }
    }
}
