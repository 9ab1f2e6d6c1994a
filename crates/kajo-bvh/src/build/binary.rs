//! The binary tree that wide nodes are made of.
//!
//! Sets of primitives are split by the surface area heuristic until they fill a leaf block.
//! Large sets are binned and parted by all threads together and their halves built side by
//! side; a set below [`TASK`] is built by one thread into a [`Grove`] of its own. Every
//! decision depends on sizes and boxes alone, so the tree does not depend on the number of
//! threads.

use super::prim::{Box4, Prim};
use super::split::{self, PIECE, Split};

/// Sets up to this size are built by one thread.
pub(super) const TASK: usize = 1 << 13;
/// Most levels above the sets of one thread.
pub(super) const TOP_LEVELS: usize = 32;
/// Most levels within such a set.
const TASK_LEVELS: usize = 32;
/// Most nodes on the way from the root to a leaf.
pub(crate) const MAX_LEVELS: usize = TOP_LEVELS + TASK_LEVELS;

/// A node of the binary tree. Its left child is the next node.
#[derive(Clone, Copy, Debug)]
pub(super) struct Twig {
    pub(super) bounds: Box4,
    /// Its primitives, as part of the grove's; [`u32::MAX`] of them where they are not all
    /// in the same grove.
    pub(super) first: u32,
    pub(super) len: u32,
    pub(super) next: Next,
}

/// What follows a node of the binary tree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Next {
    /// Nothing: a leaf.
    Nothing,
    /// The next node and this one.
    Right(u32),
    /// A node of another grove, by the numbers of both.
    Elsewhere(u32, u32),
}

/// A part of the binary tree, parents before children.
#[derive(Default)]
pub(super) struct Grove {
    pub(super) twigs: Vec<Twig>,
    /// Primitives from left to right.
    pub(super) ids: Vec<u32>,
}

/// A set of primitives on its way into the tree.
pub(super) struct Set<'a> {
    pub(super) prims: &'a mut [Prim],
    /// As long as `prims`, for parting large sets; else empty.
    pub(super) spare: &'a mut [Prim],
    pub(super) bounds: Box4,
}

/// The upper part of the tree while it is built.
enum Upper {
    Grove(Grove),
    Node(Box4, Box<[Upper; 2]>),
}

/// The binary tree over a set: the first grove is its top and leads to the others.
pub(super) fn build(set: Set<'_>, block: u32) -> Vec<Grove> {
    let mut groves = vec![Grove::default()];
    flatten(upper(set, block, 0), &mut groves);
    groves
}

fn upper(set: Set<'_>, block: u32, depth: usize) -> Upper {
    if set.prims.len() <= TASK {
        let mut grove = Grove::default();
        grove.ids.reserve(set.prims.len());
        grove.grow(set, block, 0);
        return Upper::Grove(grove);
    }
    let bounds = set.bounds;
    let (left, right) = set.split(block, TASK << (TOP_LEVELS - depth - 1).min(32));
    let (left, right) = rayon::join(|| upper(left, block, depth + 1), || upper(right, block, depth + 1));
    Upper::Node(bounds, Box::new([left, right]))
}

fn flatten(upper: Upper, groves: &mut Vec<Grove>) {
    let place = groves[0].twigs.len();
    match upper {
        Upper::Grove(grove) => {
            let twig = Twig { next: Next::Elsewhere(groves.len() as u32, 0), ..grove.twigs[0] };
            groves[0].twigs.push(twig);
            groves.push(grove);
        }
        Upper::Node(bounds, children) => {
            groves[0].twigs.push(Twig { bounds, first: 0, len: u32::MAX, next: Next::Nothing });
            let [left, right] = *children;
            flatten(left, groves);
            groves[0].twigs[place].next = Next::Right(groves[0].twigs.len() as u32);
            flatten(right, groves);
        }
    }
}

impl Grove {
    fn grow(&mut self, set: Set<'_>, block: u32, depth: usize) {
        let (place, first, len) = (self.twigs.len(), self.ids.len() as u32, set.prims.len());
        self.twigs.push(Twig { bounds: set.bounds, first, len: len as u32, next: Next::Nothing });
        if len <= block as usize {
            self.ids.extend(set.prims.iter().map(Prim::id));
            return;
        }
        let (left, right) = set.split(block, (block as usize) << (TASK_LEVELS - depth - 1));
        self.grow(left, block, depth + 1);
        self.twigs[place].next = Next::Right(self.twigs.len() as u32);
        self.grow(right, block, depth + 1);
    }
}

impl<'a> Set<'a> {
    /// Two sets, not empty, by the cheapest split; two halves where there is none, or where a
    /// side could hold more than `most`, the primitives that fit below.
    fn split(self, block: u32, most: usize) -> (Set<'a>, Set<'a>) {
        let (mut prims, mut spare) = (self.prims, self.spare);
        let best = if prims.len() > most { None } else { Split::best(prims, block) };
        let Some(split) = best else {
            let (left, right) = prims.split_at_mut(prims.len() / 2);
            let whole = |prims: &'a mut [Prim]| Set { bounds: split::bounds(prims), prims, spare: &mut [] };
            return (whole(left), whole(right));
        };
        if spare.len() == prims.len() && prims.len() >= 2 * PIECE {
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
