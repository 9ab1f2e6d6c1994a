//! A better binary tree by moving subtrees to where they cost less.
//!
//! The cost of a tree is the sum of its nodes' surfaces. A subtree that is taken out lets
//! its ancestors shrink, and put beside another node makes that node's ancestors grow; the
//! best new place is found by branch and bound, walking up from the old one
//! [Bittner, Hapala and Havran 2013], [Meister and Bittner 2018, alg. 2].

use super::binary::{Grove, MAX_LEVELS, Next, TASK, TOP_LEVELS, Twig};
use super::prim::Box4;

/// Times that subtrees are tried.
const PASSES: usize = 2;
/// One in so many subtrees of a whole tree is tried, the largest first, but at least [`FEW`].
const SHARE: usize = 4;
const FEW: usize = 1 << 16;
/// About how many subtrees of the top of a tree are moved around.
const TOP: usize = 1 << 10;

/// Where nodes stand in the tree; leaves have no children.
struct Links {
    bounds: Vec<Box4>,
    parents: Vec<u32>,
    children: Vec<Option<[u32; 2]>>,
    /// The twigs they were made from.
    twigs: Vec<(usize, usize)>,
}

/// The root's number.
const ROOT: u32 = 0;

/// Moves the largest subtrees of the whole tree, down to its leaves. Returns the new tree, or
/// the old one where that would be too deep.
pub(super) fn improve(groves: Vec<Grove>) -> Vec<Grove> {
    let mut links = Links::new(&groves, 0);
    for _ in 0..PASSES {
        let largest = links.largest();
        links.improve(&largest[..(largest.len() / SHARE).max(FEW).min(largest.len())]);
    }
    if links.depth() > MAX_LEVELS {
        return groves;
    }
    let leaf = |node: u32| leaf(&groves, links.twigs[node as usize]);
    let sizes = links.sizes(|node| leaf(node).len());
    let mut out = vec![Grove::default()];
    links.emit(ROOT, 0, &sizes, &mut out, &leaf);
    out
}

/// Moves the subtrees at the top of the tree: what is below them stays as it is.
///
/// * `n`: primitives in the tree
/// * `least`: subtrees of so many are not taken apart
pub(super) fn improve_top(groves: &mut [Grove], n: usize, least: usize) {
    let mut links = Links::new(groves, (n / TOP).clamp(least, TASK));
    for _ in 0..PASSES {
        links.improve(&links.largest());
    }
    if links.depth() <= TOP_LEVELS {
        groves[0].twigs.clear();
        links.emit_top(ROOT, &mut groves[0]);
    }
}

/// The primitives of a leaf.
fn leaf(groves: &[Grove], (grove, place): (usize, usize)) -> &[u32] {
    let twig = &groves[grove].twigs[place];
    &groves[grove].ids[twig.first as usize..(twig.first + twig.len) as usize]
}

impl Links {
    /// Takes twigs with up to `whole` primitives for leaves.
    fn new(groves: &[Grove], whole: usize) -> Links {
        let mut links =
            Links { bounds: Vec::new(), parents: Vec::new(), children: Vec::new(), twigs: Vec::new() };
        links.add(groves, (0, 0), ROOT, whole);
        links
    }

    /// Adds the subtree at a twig, parents first.
    fn add(&mut self, groves: &[Grove], at: (usize, usize), parent: u32, whole: usize) -> u32 {
        let (grove, place) = at;
        let twig = &groves[grove].twigs[place];
        if let Next::Elsewhere(grove, place) = twig.next {
            return self.add(groves, (grove as usize, place as usize), parent, whole);
        }
        let node = self.bounds.len();
        self.bounds.push(twig.bounds);
        self.parents.push(parent);
        self.children.push(None);
        self.twigs.push(at);
        if let Next::Right(right) = twig.next
            && twig.len as usize > whole
        {
            let left = self.add(groves, (grove, place + 1), node as u32, whole);
            let right = self.add(groves, (grove, right as usize), node as u32, whole);
            self.children[node] = Some([left, right]);
        }
        node as u32
    }

    /// All nodes but the root, by falling surface.
    fn largest(&self) -> Vec<u32> {
        let mut nodes: Vec<u32> = (1..self.bounds.len() as u32).collect();
        nodes.sort_by(|&a, &b| self.area(b).total_cmp(&self.area(a)).then(a.cmp(&b)));
        nodes
    }

    /// Moves each of `nodes` to a better place if there is one.
    fn improve(&mut self, nodes: &[u32]) {
        let mut waiting = Vec::new();
        for &node in nodes {
            if let Some(place) = self.better_place(node, &mut waiting) {
                self.reinsert(node, place);
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
    fn better_place(&self, node: u32, waiting: &mut Vec<(f32, u32)>) -> Option<u32> {
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
            while let Some((won, place)) = waiting.pop() {
                if won - area <= most {
                    continue;
                }
                let left = won - self.bounds[place as usize].union(bounds).half_area();
                if left > most {
                    (best, most) = (Some(place), left);
                }
                if let Some([a, b]) = self.children[place as usize] {
                    let won = left + self.area(place);
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
        best.filter(|&place| place != old_sibling)
    }

    /// Takes `node` out and puts it beside `place`, which is neither its parent nor below it.
    fn reinsert(&mut self, node: u32, place: u32) {
        let parent = self.parent(node);
        let Some(sibling) = self.sibling(node) else { return };
        let grandparent = self.parent(parent);
        self.replace(grandparent, parent, sibling);
        self.refit(grandparent);
        let above = self.parent(place);
        self.replace(above, place, parent);
        self.children[parent as usize] = Some([place, node]);
        self.parents[place as usize] = parent;
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

    /// Adds the subtree at `node` to a grove; what is small enough gets one of its own.
    fn emit<'a>(
        &self,
        node: u32,
        grove: usize,
        sizes: &[usize],
        out: &mut Vec<Grove>,
        leaf: &impl Fn(u32) -> &'a [u32],
    ) {
        let (bounds, size) = (self.bounds[node as usize], sizes[node as usize]);
        if grove == 0 && size <= TASK {
            let own = out.len();
            out.push(Grove::default());
            self.emit(node, own, sizes, out, leaf);
            let twig = Twig { next: Next::Elsewhere(own as u32, 0), ..out[own].twigs[0] };
            out[0].twigs.push(twig);
            return;
        }
        let (place, first) = (out[grove].twigs.len(), out[grove].ids.len() as u32);
        let len = if grove == 0 { u32::MAX } else { size as u32 };
        out[grove].twigs.push(Twig { bounds, first, len, next: Next::Nothing });
        match self.children[node as usize] {
            None => out[grove].ids.extend(leaf(node)),
            Some([a, b]) => {
                self.emit(a, grove, sizes, out, leaf);
                out[grove].twigs[place].next = Next::Right(out[grove].twigs.len() as u32);
                self.emit(b, grove, sizes, out, leaf);
            }
        }
    }

    /// Adds the subtree at `node` to the first grove; its leaves stay elsewhere.
    fn emit_top(&self, node: u32, out: &mut Grove) {
        let place = out.twigs.len();
        let (grove, twig) = self.twigs[node as usize];
        let next = Next::Elsewhere(grove as u32, twig as u32);
        out.twigs.push(Twig { bounds: self.bounds[node as usize], first: 0, len: u32::MAX, next });
        if let Some([a, b]) = self.children[node as usize] {
            self.emit_top(a, out);
            out.twigs[place].next = Next::Right(out.twigs.len() as u32);
            self.emit_top(b, out);
        }
    }
}

#[cfg(test)]
mod tests {
    use kajo_math::{Aabb, Vec3};

    use super::*;
    use crate::build::binary::{Set, build};
    use crate::build::prim::Prim;
    use crate::build::split;

    /// Slabs of all lengths that overlap, hard to split well.
    fn groves(n: u32) -> Vec<Grove> {
        let at = |i: u32, k: u32| (i.wrapping_mul(2_654_435_761).wrapping_add(k * 40_503) % 1009) as f32;
        let slab = |i: u32| {
            let p = Vec3::new(at(i, 1), at(i, 2), at(i, 3));
            let mut extent = Vec3::ONE;
            extent[i as usize % 3] = at(i, 4);
            Aabb::around([p, p + extent])
        };
        let mut prims: Vec<Prim> = (0..n).map(|i| Prim::new(slab(i), i)).collect();
        let bounds = split::bounds(&prims);
        build(Set { prims: &mut prims, spare: &mut [], bounds }, 4)
    }

    fn cost(groves: &[Grove]) -> f32 {
        let links = Links::new(groves, 0);
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

    #[test]
    fn moving_subtrees_lowers_the_cost_and_keeps_every_primitive() {
        let groves = groves(20_000);
        let before = cost(&groves);
        let mut links = Links::new(&groves, 0);
        links.improve(&links.largest());
        check(&links);
        let after = improve(groves);
        assert!(cost(&after) < 0.95 * before, "{} after {before}", cost(&after));
        let mut ids: Vec<u32> = after.iter().flat_map(|grove| grove.ids.iter().copied()).collect();
        ids.sort_unstable();
        assert!(ids.into_iter().eq(0..20_000));
    }

    #[test]
    fn the_top_alone_gains_too() {
        let mut groves = groves(20_000);
        let before = cost(&groves);
        improve_top(&mut groves, 20_000, 32);
        assert!(cost(&groves) < 0.99 * before, "{} after {before}", cost(&groves));
        check(&Links::new(&groves, 0));
    }
}
