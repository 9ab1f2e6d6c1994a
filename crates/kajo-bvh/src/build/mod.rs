//! From boxes to wide nodes.
//!
//! A node starts as one set of boxes. Its largest set is split, by the surface area
//! heuristic, until there are eight or none is worth splitting; then each becomes a child.
//! Large sets are split by all threads together, sets below [`TASK`] each by one thread.
//! Every decision depends on sizes and boxes alone, so the tree does not depend on the
//! number of threads.

mod prim;
mod split;

use kajo_math::Aabb;
use rayon::prelude::*;

use self::prim::Box4;
pub(crate) use self::prim::Prim;
use self::split::{PARALLEL, Split};
use crate::node::{Child, MAX_DEPTH, Node, WIDTH};
use crate::walk::Tree;

/// Sets up to this size are built by one thread.
const TASK: usize = 1 << 13;

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
    /// the root of a part.
    top: Vec<Node>,
    pub(crate) parts: Vec<Part>,
    bounds: Aabb,
    depth: usize,
}

/// A piece of the tree that one thread built. Its nodes and leaves are numbered within it.
#[derive(Default)]
pub(crate) struct Part {
    nodes: Vec<Node>,
    root: Option<Child>,
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

    fn grow(&mut self, mut set: Set<'_>, depth: usize, shape: LeafShape) -> Child {
        let Some(children) = set.divide(depth, shape) else {
            self.depth = self.depth.max(depth);
            self.ids.extend(set.prims.iter().map(Prim::id));
            self.ends.push(self.ids.len() as u32);
            return Child::leaf(self.ends.len() as u32 - 1);
        };
        let place = self.nodes.len();
        self.nodes.push(Node::EMPTY);
        for (slot, child) in children.into_iter().enumerate() {
            let bounds = child.bounds.aabb();
            let child = self.grow(child, depth + 1, shape);
            self.nodes[place].set(slot, &bounds, child);
        }
        Child::node(place)
    }
}

/// The upper part of the tree while it is built.
enum Piece {
    Part(Part),
    Node(Vec<(Aabb, Piece)>),
}

impl Piece {
    fn build(mut set: Set<'_>, depth: usize, shape: LeafShape) -> Piece {
        let children = if set.prims.len() > TASK { set.divide(depth, shape) } else { None };
        match children {
            Some(children) => {
                let child = |set: Set<'_>| (set.bounds.aabb(), Piece::build(set, depth + 1, shape));
                Piece::Node(children.into_par_iter().map(child).collect())
            }
            None => {
                let mut part = Part::default();
                part.root = Some(part.grow(set, depth, shape));
                Piece::Part(part)
            }
        }
    }
}

/// Builds a tree over `prims`, each with a box that is not empty and finite.
pub(crate) fn build(mut prims: Vec<Prim>, shape: LeafShape) -> Built {
    let bounds = split::bounds(&prims);
    let mut built = Built { top: Vec::new(), parts: Vec::new(), bounds: bounds.aabb(), depth: 0 };
    if prims.is_empty() {
        built.bounds = Aabb::EMPTY;
        return built;
    }
    let mut spare = if prims.len() >= 2 * PARALLEL { prims.clone() } else { Vec::new() };
    let piece = Piece::build(Set { prims: &mut prims, spare: &mut spare, bounds }, 0, shape);
    built.add(piece);
    built
}

impl Built {
    fn add(&mut self, piece: Piece) -> Child {
        match piece {
            Piece::Part(part) => {
                self.depth = self.depth.max(part.depth);
                self.parts.push(part);
                Child::leaf(self.parts.len() as u32 - 1)
            }
            Piece::Node(children) => {
                let place = self.top.len();
                self.top.push(Node::EMPTY);
                for (slot, (bounds, piece)) in children.into_iter().enumerate() {
                    let child = self.add(piece);
                    self.top[place].set(slot, &bounds, child);
                }
                Child::node(place)
            }
        }
    }

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
        let root_of = |p: usize| self.parts[p].root.map(|root| in_part(p, root));
        let node = |i: usize| {
            let (mut node, home) = match i.checked_sub(self.top.len()) {
                None => (self.top[i], None),
                Some(_) => {
                    let p = bases.partition_point(|&base| base <= i) - 1;
                    (self.parts[p].nodes[i - bases[p]], Some(p))
                }
            };
            for slot in 0..WIDTH {
                let child = node.children[slot];
                if node.is_used(slot) {
                    node.children[slot] = match home {
                        Some(p) => in_part(p, child),
                        None if child.is_leaf() => root_of(child.index() as usize).unwrap_or(child),
                        None => child,
                    };
                }
            }
            node
        };
        let nodes: Vec<Node> = (0..total).into_par_iter().map(node).collect();
        let root = if self.top.is_empty() {
            (!self.parts.is_empty()).then(|| root_of(0)).flatten()
        } else {
            Some(Child::node(0))
        };
        Tree { nodes, root, bounds: self.bounds, depth: self.depth }
    }
}

/// A set of primitives on its way into the tree.
struct Set<'a> {
    prims: &'a mut [Prim],
    /// As long as `prims`, for parting large sets; else empty.
    spare: &'a mut [Prim],
    bounds: Box4,
}

impl<'a> Set<'a> {
    /// The children of a node over this set, or `None` if it should be a leaf.
    ///
    /// * `depth`: nodes above; never more than [`MAX_DEPTH`]
    fn divide(&mut self, depth: usize, shape: LeafShape) -> Option<Vec<Set<'a>>> {
        let n = self.prims.len();
        if n <= shape.block as usize {
            return None;
        }
        // More than a tree of the levels below each child can hold, unless shared out evenly.
        let crowded = n > capacity(depth + 1, shape);
        let split = Split::best(self.prims, shape.block).filter(|_| !crowded);
        if n <= shape.most {
            let area = self.bounds.half_area();
            let as_leaf = area * (n as u32).div_ceil(shape.block) as f32;
            if split.is_none_or(|s| as_leaf <= area + s.cost) {
                return None;
            }
        }
        let mut children = Vec::with_capacity(WIDTH);
        let (left, right) = self.take().split(split);
        children.extend([left, right]);
        while children.len() < WIDTH {
            let large = |c: &Set<'_>| c.prims.len() > shape.block as usize;
            let size = |c: &Set<'_>| if crowded { c.prims.len() as f32 } else { c.bounds.half_area() };
            let candidates = children.iter().enumerate().filter(|(_, c)| large(c));
            let Some((next, _)) = candidates.max_by(|a, b| size(a.1).total_cmp(&size(b.1))) else { break };
            let set = children.swap_remove(next);
            let split = Split::best(set.prims, shape.block).filter(|_| !crowded);
            let (left, right) = set.split(split);
            children.extend([left, right]);
        }
        Some(children)
    }

    fn take(&mut self) -> Set<'a> {
        let (prims, spare) = (std::mem::take(&mut self.prims), std::mem::take(&mut self.spare));
        Set { prims, spare, bounds: self.bounds }
    }

    /// Both sides of `split`; without one, two halves.
    fn split(self, split: Option<Split>) -> (Set<'a>, Set<'a>) {
        let (mut prims, mut spare) = (self.prims, self.spare);
        let Some(split) = split else {
            let (left, right) = prims.split_at_mut(prims.len() / 2);
            let whole = |prims: &'a mut [Prim]| Set { bounds: split::bounds(prims), prims, spare: &mut [] };
            return (whole(left), whole(right));
        };
        if spare.len() == prims.len() && prims.len() >= 2 * PARALLEL {
            split.part_into(prims, spare);
            std::mem::swap(&mut prims, &mut spare);
        } else {
            split.part(prims);
        }
        let (left, right) = prims.split_at_mut(split.left);
        let (spare_left, spare_right) = spare.split_at_mut(split.left.min(spare.len()));
        let [bounds_left, bounds_right] = split.sides;
        (
            Set { prims: left, spare: spare_left, bounds: bounds_left },
            Set { prims: right, spare: spare_right, bounds: bounds_right },
        )
    }
}

/// Primitives that surely fit below `depth` nodes.
fn capacity(depth: usize, shape: LeafShape) -> usize {
    let levels = (MAX_DEPTH - depth.min(MAX_DEPTH)) as u32;
    WIDTH.checked_pow(levels).map_or(usize::MAX, |n| n.saturating_mul(shape.block as usize))
}
