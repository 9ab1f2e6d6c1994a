//! The best wide tree within a binary one.
//!
//! A binary subtree can become a leaf, a wide node, or be shared out over some slots of the
//! wide node above it. With `A` the surface, `P` the blocks of a leaf, the cheapest ways are
//! [Ylitie, Karras and Laine 2017, eq. 3-6]
//!
//! ```text
//! C(n, 1) = min(A P c_block, A c_node + D(n, 8))
//! C(n, i) = min(D(n, i), C(n, i - 1))
//! D(n, i) = min over 0 < k < i of C(left, k) + C(right, i - k)
//! ```
//!
//! found from the leaves up, one table of `C` a node.

use kajo_math::Aabb;
use rayon::prelude::*;

use super::LeafShape;
use super::Part;
use super::binary::{Grove, Next};
use crate::node::{Child, Node, WIDTH};

/// Costs relative to a visit of a wide node.
const BLOCK_COST: f32 = 0.9;

/// Subtrees that one thread turns into a part.
pub(super) const ROOTS: usize = 16;

/// `C(n, 1)` to `C(n, 7)`.
type Costs = [f32; WIDTH - 1];

/// A node of the binary tree: grove, and number within it.
type Place = (usize, usize);

/// The binary tree with the costs of its nodes.
pub(super) struct Collapse<'a> {
    groves: &'a [Grove],
    costs: Vec<Vec<Costs>>,
    shape: LeafShape,
}

/// The cheapest `C(left, k) + C(right, slots - k)` and its `k`.
fn share(left: &Costs, right: &Costs, slots: usize) -> (f32, usize) {
    let mut best = (f32::INFINITY, 1);
    for k in 1..slots {
        let cost = left[k - 1] + right[slots - k - 1];
        if cost < best.0 {
            best = (cost, k);
        }
    }
    best
}

/// Costs of all nodes of a grove; `others` are those of the groves it leads to.
fn costs(grove: &Grove, shape: LeafShape, others: &[Vec<Costs>]) -> Vec<Costs> {
    let mut costs = vec![[0.0; WIDTH - 1]; grove.twigs.len()];
    for (place, twig) in grove.twigs.iter().enumerate().rev() {
        let area = twig.bounds.half_area();
        let as_leaf = if twig.len as usize <= shape.most {
            area * BLOCK_COST * twig.len.div_ceil(shape.block) as f32
        } else {
            f32::INFINITY
        };
        costs[place] = match twig.next {
            Next::Nothing => [as_leaf; WIDTH - 1],
            Next::Elsewhere(grove, place) => others[grove as usize][place as usize],
            Next::Right(right) => {
                let (left, right) = (&costs[place + 1], &costs[right as usize]);
                let mut c = [as_leaf.min(area + share(left, right, WIDTH).0); WIDTH - 1];
                for slots in 2..WIDTH {
                    c[slots - 1] = c[slots - 2].min(share(left, right, slots).0);
                }
                c
            }
        };
    }
    costs
}

impl<'a> Collapse<'a> {
    pub(super) fn new(groves: &'a [Grove], shape: LeafShape) -> Collapse<'a> {
        let mut all = vec![Vec::new()];
        all.par_extend(groves[1..].par_iter().map(|grove| costs(grove, shape, &[])));
        all[0] = costs(&groves[0], shape, &all);
        Collapse { groves, costs: all, shape }
    }

    fn follow(&self, place: Place) -> Place {
        match self.groves[place.0].twigs[place.1].next {
            Next::Elsewhere(grove, place) => (grove as usize, place as usize),
            _ => place,
        }
    }

    fn bounds(&self, (grove, twig): Place) -> Aabb {
        self.groves[grove].twigs[twig].bounds.aabb()
    }

    fn costs(&self, (grove, twig): Place) -> &Costs {
        &self.costs[grove][twig]
    }

    fn children(&self, (grove, twig): Place) -> Option<(Place, Place)> {
        match self.groves[grove].twigs[twig].next {
            Next::Right(right) => {
                Some((self.follow((grove, twig + 1)), self.follow((grove, right as usize))))
            }
            _ => None,
        }
    }

    /// The slots of the wide node that replaces `place`; none if it is to be a leaf.
    fn slots(&self, place: Place) -> Vec<Place> {
        let mut slots = Vec::new();
        let Some((left, right)) = self.children(place) else { return slots };
        let twig = &self.groves[place.0].twigs[place.1];
        let (cost, k) = share(self.costs(left), self.costs(right), WIDTH);
        let as_leaf = BLOCK_COST * twig.len.div_ceil(self.shape.block) as f32;
        let area = twig.bounds.half_area();
        if twig.len as usize <= self.shape.most && area * as_leaf <= area + cost {
            return slots;
        }
        slots.reserve(WIDTH);
        self.gather(left, k, &mut slots);
        self.gather(right, WIDTH - k, &mut slots);
        slots
    }

    /// Adds up to `n` slots that cover the subtree at `place` at the least cost.
    fn gather(&self, place: Place, n: usize, slots: &mut Vec<Place>) {
        let c = self.costs(place);
        let n = (1..n).find(|&fewer| c[fewer - 1] <= c[n - 1]).unwrap_or(n);
        match self.children(place).filter(|_| n > 1) {
            Some((left, right)) => {
                let (_, k) = share(self.costs(left), self.costs(right), n);
                self.gather(left, k, slots);
                self.gather(right, n - k, slots);
            }
            None => slots.push(place),
        }
    }

    /// The wide tree: its top nodes and, in the order of their leaves, the parts below.
    pub(super) fn wide(&self) -> (Vec<Node>, Vec<Part>) {
        let (mut top, mut roots) = (Vec::new(), Vec::new());
        self.top(self.follow((0, 0)), 0, &mut top, &mut roots);
        let part = |roots: &[(Place, usize)]| {
            let mut part = Part::default();
            for &(place, depth) in roots {
                let root = self.part(place, depth, &mut part);
                part.roots.push(root);
            }
            part
        };
        (top, roots.par_chunks(ROOTS).map(part).collect())
    }

    /// Adds nodes for all of the first grove that becomes nodes. What lies in other groves
    /// is added to `roots` with its depth, and stands in `top` as a leaf of that number; each
    /// [`ROOTS`] of them make a part.
    fn top(&self, place: Place, depth: usize, top: &mut Vec<Node>, roots: &mut Vec<(Place, usize)>) -> Child {
        if place.0 > 0 {
            roots.push((place, depth));
            return Child::leaf(roots.len() as u32 - 1);
        }
        let node = top.len();
        top.push(Node::EMPTY);
        for (slot, place) in self.slots(place).into_iter().enumerate() {
            let child = self.top(place, depth + 1, top, roots);
            top[node].set(slot, &self.bounds(place), child);
        }
        Child::node(node)
    }

    fn part(&self, place: Place, depth: usize, part: &mut Part) -> Child {
        let slots = self.slots(place);
        if slots.is_empty() {
            let grove = &self.groves[place.0];
            let twig = &grove.twigs[place.1];
            part.depth = part.depth.max(depth);
            part.ids.extend(&grove.ids[twig.first as usize..(twig.first + twig.len) as usize]);
            part.ends.push(part.ids.len() as u32);
            return Child::leaf(part.ends.len() as u32 - 1);
        }
        let node = part.nodes.len();
        part.nodes.push(Node::EMPTY);
        for (slot, place) in slots.into_iter().enumerate() {
            let child = self.part(place, depth + 1, part);
            part.nodes[node].set(slot, &self.bounds(place), child);
        }
        Child::node(node)
    }
}
