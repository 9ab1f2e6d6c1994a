//! A better binary tree by moving subtrees to where they cost less.
//!
//! The cost of a tree is the sum of its nodes' surfaces. A subtree that is taken out lets
//! its ancestors shrink, and put beside another node makes that node's ancestors grow; the
//! best new place is found by branch and bound, walking up from the old one
//! [Bittner, Hapala and Havran 2013], [Meister and Bittner 2018, alg. 2].
//!
//! Places for many subtrees of a whole tree are looked for side by side, in the tree as it is;
//! then one after the other is moved if its place is still better than where it is. So the tree
//! does not depend on the number of threads.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use rayon::prelude::*;

use super::binary::{At, Binary, Forest, Grove, MAX_LEVELS, Next, Spot, Stem, TASK, TOP_LEVELS, Twig};
use super::prim::Box4;

/// Times that subtrees are tried.
const PASSES: usize = 2;
/// One in so many subtrees of a whole tree is tried, the largest first, but at least [`FEW`].
const SHARE: usize = 4;
const FEW: usize = 1 << 16;
/// Subtrees of a whole tree whose places are looked for side by side: at first, and at most.
const TOGETHER: (usize, usize) = (16, 1024);
/// How many subtrees of the top of a tree are moved around, if there are no more stems.
const TOP: usize = 1 << 9;

/// Where nodes stand in the tree; leaves have no children.
struct Links {
    bounds: Vec<Box4>,
    parents: Vec<u32>,
    children: Vec<Option<[u32; 2]>>,
    /// The twigs they were made from; of no meaning for nodes above the groves.
    spots: Vec<Spot>,
}

/// A node whose children have not been looked at.
struct Waiting {
    /// Before all that are not.
    first: bool,
    area: f32,
    node: u32,
    at: At,
}

impl Ord for Waiting {
    fn cmp(&self, other: &Waiting) -> Ordering {
        let by_area = self.area.total_cmp(&other.area);
        self.first.cmp(&other.first).then(by_area).then(other.node.cmp(&self.node))
    }
}

impl PartialOrd for Waiting {
    fn partial_cmp(&self, other: &Waiting) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Waiting {
    fn eq(&self, other: &Waiting) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Waiting {}

/// The root's number.
const ROOT: u32 = 0;

/// Moves the largest subtrees of the whole tree, down to its leaves, unless that would make it
/// too deep.
pub(super) fn improve(forest: &mut Forest) {
    let mut links = Links::new(forest, usize::MAX);
    for _ in 0..PASSES {
        let largest = links.largest();
        links.improve_together(&largest[..(largest.len() / SHARE).max(FEW).min(largest.len())]);
    }
    if links.depth() > MAX_LEVELS {
        return;
    }
    let leaf = |node: u32| {
        let spot = links.spots[node as usize];
        forest.grove(spot).ids(spot)
    };
    let sizes = links.sizes(|node| leaf(node).len());
    let mut out = Forest::default();
    let is_cut = forest.is_cut();
    links.emit_stem(ROOT, &sizes, &mut out, &leaf);
    out.groves.iter_mut().for_each(|grove| grove.cut = is_cut);
    *forest = out;
}

/// Moves the largest subtrees at the top of the tree: what is below them stays as it is.
pub(super) fn improve_top(forest: &mut Forest) {
    let mut links = Links::new(forest, TOP);
    for _ in 0..PASSES {
        links.improve(&links.largest());
    }
    if links.depth() <= TOP_LEVELS {
        forest.stems.clear();
        links.emit_top(ROOT, &mut forest.stems);
    }
}

impl Links {
    /// The top of a tree with about `leaves` leaves: all stems, and below them what has the
    /// largest surfaces.
    fn new(forest: &Forest, leaves: usize) -> Links {
        let mut links =
            Links { bounds: Vec::new(), parents: Vec::new(), children: Vec::new(), spots: Vec::new() };
        let mut waiting = BinaryHeap::new();
        links.push(forest, forest.root(), ROOT, &mut waiting);
        let mut n = 1;
        while let Some(Waiting { node, at, .. }) = waiting.pop() {
            if n >= leaves && matches!(at, At::Twig(_)) {
                break;
            }
            if let Some(children) = forest.children(at) {
                links.children[node as usize] =
                    Some(children.map(|child| links.push(forest, child, node, &mut waiting)));
                n += 1;
            }
        }
        links
    }

    fn push(&mut self, forest: &Forest, at: At, parent: u32, waiting: &mut BinaryHeap<Waiting>) -> u32 {
        let (node, bounds) = (self.bounds.len() as u32, forest.bounds(at));
        let (spot, first) = match at {
            At::Stem(_) => (Spot { grove: 0, twig: 0, first: 0 }, true),
            At::Twig(spot) => (spot, false),
        };
        self.bounds.push(bounds);
        self.parents.push(parent);
        self.children.push(None);
        self.spots.push(spot);
        waiting.push(Waiting { first, area: bounds.half_area(), node, at });
        node
    }

    /// All nodes but the root, by falling surface.
    fn largest(&self) -> Vec<u32> {
        let mut nodes: Vec<u32> = (1..self.bounds.len() as u32).collect();
        nodes.sort_by(|&a, &b| self.area(b).total_cmp(&self.area(a)).then(a.cmp(&b)));
        nodes
    }

    /// Moves `nodes` to better places, found by all threads.
    fn improve_together(&mut self, mut nodes: &[u32]) {
        let (mut count, most) = TOGETHER;
        while !nodes.is_empty() {
            let (now, later) = nodes.split_at(count.min(nodes.len()));
            let target_of = |waiting: &mut Vec<_>, &node: &u32| self.better_position(node, waiting);
            let targets: Vec<_> = now.par_iter().with_min_len(16).map_init(Vec::new, target_of).collect();
            for (&node, target) in now.iter().zip(targets) {
                if let Some(target) = target.filter(|&target| self.gain(node, target) > 0.0) {
                    self.reinsert(node, target);
                }
            }
            (nodes, count) = (later, most.min(2 * count));
        }
    }

    /// How much less the tree costs with `node` beside `target`; nothing where it cannot go there.
    fn gain(&self, node: u32, target: u32) -> f32 {
        let (parent, bounds) = (self.parent(node), self.bounds[node as usize]);
        let Some(sibling) = self.sibling(node).filter(|_| parent != ROOT) else { return 0.0 };
        if [node, parent, sibling].contains(&target) {
            return 0.0;
        }
        // Up to the lowest node that is above both, boxes shrink on one side and grow on the other.
        let (mut from, mut to) = (parent, target);
        let (mut depth_from, mut depth_to) = (self.depth_of(parent), self.depth_of(target));
        let mut rest = self.bounds[sibling as usize];
        let mut gain = self.area(parent) - self.bounds[target as usize].union(bounds).half_area();
        while from != to {
            if depth_to >= depth_from {
                if to == node {
                    return 0.0;
                }
                if to != target {
                    let grown = self.bounds[to as usize].union(bounds);
                    gain -= grown.half_area() - self.area(to);
                }
                (to, depth_to) = (self.parent(to), depth_to - 1);
            } else {
                if from != parent {
                    gain += self.area(from) - rest.half_area();
                }
                let above = self.parent(from);
                let other = self.sibling(from).unwrap_or(from);
                rest = rest.union(self.bounds[other as usize]);
                (from, depth_from) = (above, depth_from - 1);
            }
        }
        gain
    }

    fn depth_of(&self, mut node: u32) -> usize {
        let mut depth = 0;
        while node != ROOT {
            (node, depth) = (self.parent(node), depth + 1);
        }
        depth
    }

    /// Moves each of `nodes` to a better place if there is one.
    fn improve(&mut self, nodes: &[u32]) {
        let mut waiting = Vec::new();
        for &node in nodes {
            if let Some(target) = self.better_position(node, &mut waiting) {
                self.reinsert(node, target);
            }
        }
    }

    fn area(&self, node: u32) -> f32 {
        self.bounds[node as usize].half_area()
    }

    fn parent(&self, node: u32) -> u32 {
        self.parents[node as usize]
    }

    fn sibling(&self, node: u32) -> Option<u32> {
        let [left, right] = self.children[self.parent(node) as usize]?;
        Some(if left == node { right } else { left })
    }

    /// The node beside which `node` would make the tree cheapest, if that is not where it is.
    /// `waiting` is empty before and after.
    fn better_position(&self, node: u32, waiting: &mut Vec<(f32, u32)>) -> Option<u32> {
        let (bounds, area) = (self.bounds[node as usize], self.area(node));
        let parent = self.parent(node);
        let old_sibling = self.sibling(node).filter(|_| parent != ROOT)?;
        // What is won so far by the removal: the parent, then what ancestors shrink.
        let mut won = self.area(parent);
        let (mut best, mut most) = (None, 0.0);
        let (mut sibling, mut pivot) = (old_sibling, parent);
        let mut rest = self.bounds[old_sibling as usize];
        loop {
            waiting.push((won, sibling));
            while let Some((won, target)) = waiting.pop() {
                if won - area <= most {
                    continue;
                }
                let left = won - self.bounds[target as usize].union(bounds).half_area();
                if left > most {
                    (best, most) = (Some(target), left);
                }
                let won = left + self.area(target);
                // What could not be taken now will not be later.
                if won - area > most
                    && let Some([a, b]) = self.children[target as usize]
                {
                    waiting.extend([(won, a), (won, b)]);
                }
            }
            if pivot != parent {
                rest = rest.union(self.bounds[sibling as usize]);
                won += self.area(pivot) - rest.half_area();
            }
            if pivot == ROOT {
                break;
            }
            sibling = self.sibling(pivot)?;
            pivot = self.parent(pivot);
        }
        best.filter(|&target| target != old_sibling)
    }

    /// Takes `node` out and puts it beside `target`, which is neither its parent nor below it.
    fn reinsert(&mut self, node: u32, target: u32) {
        let parent = self.parent(node);
        let Some(sibling) = self.sibling(node) else { return };
        let grandparent = self.parent(parent);
        self.replace(grandparent, parent, sibling);
        self.refit(grandparent);
        let above = self.parent(target);
        self.replace(above, target, parent);
        self.children[parent as usize] = Some([target, node]);
        self.parents[target as usize] = parent;
        self.refit(parent);
    }

    /// Makes `new` the child of `parent` that `old` was.
    fn replace(&mut self, parent: u32, old: u32, new: u32) {
        if let Some(children) = &mut self.children[parent as usize] {
            children.iter_mut().filter(|child| **child == old).for_each(|child| *child = new);
        }
        self.parents[new as usize] = parent;
    }

    /// Fits boxes from `node` up to the root.
    fn refit(&mut self, mut node: u32) {
        loop {
            if let Some([a, b]) = self.children[node as usize] {
                self.bounds[node as usize] = self.bounds[a as usize].union(self.bounds[b as usize]);
            }
            if node == ROOT {
                return;
            }
            node = self.parent(node);
        }
    }

    fn depth(&self) -> usize {
        let mut deepest = 0;
        let mut waiting = vec![(ROOT, 0)];
        while let Some((node, depth)) = waiting.pop() {
            deepest = deepest.max(depth);
            waiting.extend(self.children[node as usize].iter().flatten().map(|&child| (child, depth + 1)));
        }
        deepest
    }

    /// Primitives below each node, given those of leaves.
    fn sizes(&self, leaf: impl Fn(u32) -> usize) -> Vec<usize> {
        let mut order = vec![ROOT];
        let mut next = 0;
        while let Some(&node) = order.get(next) {
            order.extend(self.children[node as usize].iter().flatten());
            next += 1;
        }
        let mut sizes = vec![0; order.len()];
        for node in order.into_iter().rev() {
            sizes[node as usize] = match self.children[node as usize] {
                Some([a, b]) => sizes[a as usize] + sizes[b as usize],
                None => leaf(node),
            };
        }
        sizes
    }

    /// Adds the subtree at `node` to the stems; what is small enough gets a grove of its own.
    fn emit_stem<'a>(&self, node: u32, sizes: &[usize], out: &mut Forest, leaf: &impl Fn(u32) -> &'a [u32]) {
        let (index, children) = (out.stems.len(), self.children[node as usize]);
        match children.filter(|_| sizes[node as usize] > TASK) {
            None => {
                let mut grove = Grove::default();
                self.emit(node, sizes, &mut grove, leaf);
                out.push(grove);
            }
            Some([a, b]) => {
                out.stems.push(Stem::new(self.bounds[node as usize], Next::Right(0)));
                self.emit_stem(a, sizes, out, leaf);
                out.stems[index].next = Next::Right(out.stems.len() as u32);
                self.emit_stem(b, sizes, out, leaf);
            }
        }
    }

    /// Adds the subtree at `node` to a grove.
    fn emit<'a>(&self, node: u32, sizes: &[usize], out: &mut Grove, leaf: &impl Fn(u32) -> &'a [u32]) {
        let index = out.twigs.len();
        out.twigs.push(Twig::new(self.bounds[node as usize], sizes[node as usize]));
        match self.children[node as usize] {
            None => out.ids.extend(leaf(node)),
            Some([a, b]) => {
                self.emit(a, sizes, out, leaf);
                out.twigs[index].right = out.twigs.len() as u16;
                self.emit(b, sizes, out, leaf);
            }
        }
    }

    /// Adds stems for the subtree at `node`; its leaves stay where they are.
    fn emit_top(&self, node: u32, out: &mut Vec<Stem>) {
        let (index, bounds) = (out.len(), self.bounds[node as usize]);
        out.push(Stem::new(bounds, Next::Twig(self.spots[node as usize])));
        if let Some([a, b]) = self.children[node as usize] {
            self.emit_top(a, out);
            out[index].next = Next::Right(out.len() as u32);
            self.emit_top(b, out);
        }
    }
}

#[cfg(test)]
mod tests {
    use kajo_math::{Aabb, Vec3};

    use super::*;
    use crate::build::LeafShape;
    use crate::build::binary::{Set, build};
    use crate::build::prim::Prims;

    /// Slabs of all lengths that overlap, hard to split well.
    fn forest(n: usize) -> Forest {
        let at = |i: u32, k: u32| (i.wrapping_mul(2_654_435_761).wrapping_add(k * 40_503) % 1009) as f32;
        let slab = |i: u32| {
            let p = Vec3::new(at(i, 1), at(i, 2), at(i, 3));
            let mut extent = Vec3::ONE;
            extent[i as usize % 3] = at(i, 4);
            Some(Aabb::around([p, p + extent]).into())
        };
        build(Set::around(Prims::new(n, slab).as_mut_slice()), LeafShape { block_bits: 2, most: 8, limit: n })
    }

    fn cost(forest: &Forest) -> f32 {
        let links = Links::new(forest, usize::MAX);
        (0..links.bounds.len() as u32).map(|node| links.area(node)).sum()
    }

    fn check(links: &Links) {
        for (node, children) in links.children.iter().enumerate() {
            let Some(children) = children else { continue };
            let [a, b] = children.map(|child| {
                assert_eq!(links.parents[child as usize], node as u32);
                links.bounds[child as usize]
            });
            assert_eq!(links.bounds[node].aabb(), a.union(b).aabb());
        }
    }

    /// All primitives from left to right, by way of the leaves.
    fn ids(forest: &Forest) -> Vec<u32> {
        let links = Links::new(forest, usize::MAX);
        let leaves = (0..links.bounds.len()).filter(|&node| links.children[node].is_none());
        leaves.map(|node| links.spots[node]).flat_map(|spot| forest.grove(spot).ids(spot)).copied().collect()
    }

    #[test]
    fn moving_subtrees_lowers_the_cost_and_keeps_every_primitive() {
        let mut forest = forest(20_000);
        let before = cost(&forest);
        let mut links = Links::new(&forest, usize::MAX);
        links.improve(&links.largest());
        check(&links);
        improve(&mut forest);
        assert!(cost(&forest) < 0.95 * before, "{} after {before}", cost(&forest));
        let mut ids = ids(&forest);
        ids.sort_unstable();
        assert!(ids.into_iter().eq(0..20_000));
    }

    #[test]
    fn gains_are_what_a_move_saves() {
        let sum = |links: &Links| {
            (0..links.bounds.len() as u32).map(|node| f64::from(links.area(node))).sum::<f64>()
        };
        let mut links = Links::new(&forest(600), usize::MAX);
        let (n, mut moved) = (links.bounds.len() as u32, 0);
        for i in 0..20_000u32 {
            let (node, target) = (i.wrapping_mul(2_654_435_761) % n, i.wrapping_mul(40_503) / 7 % n);
            if node == ROOT || target == ROOT {
                continue;
            }
            let gain = links.gain(node, target);
            if gain > 0.0 {
                let before = sum(&links);
                links.reinsert(node, target);
                let saved = before - sum(&links);
                // Beside a node above it, at least so much.
                assert!(saved > 0.999 * f64::from(gain) - 1e-6 * before, "{saved} instead of {gain}");
                moved += 1;
            }
        }
        check(&links);
        assert!(moved > 20, "{moved}");
    }

    #[test]
    fn the_top_alone_gains_too() {
        let mut forest = forest(20_000);
        let before = cost(&forest);
        improve_top(&mut forest);
        assert!(cost(&forest) < 0.99 * before, "{} after {before}", cost(&forest));
        check(&Links::new(&forest, usize::MAX));
        let mut ids = ids(&forest);
        ids.sort_unstable();
        assert!(ids.into_iter().eq(0..20_000));
    }
}
