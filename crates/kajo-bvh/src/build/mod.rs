//! From boxes to wide nodes: a binary tree by the surface area heuristic ([`binary`],
//! [`split`]), with triangles cut at planes ([`spatial`]) or along a curve ([`linear`]), improved
//! by moving subtrees ([`reinsert`]), then the best wide tree within it ([`plan`], [`wide`]).

mod binary;
mod bins;
mod cut;
mod linear;
mod plan;
mod planning;
mod prim;
mod reinsert;
mod slices;
mod spatial;
mod split;
mod wide;

use bytemuck::Pod;
use kajo_math::Vec3;

pub(crate) use self::binary::MAX_LEVELS;
use self::binary::Set;
pub(crate) use self::prim::{Box4, Prims};
use crate::Quality;
use crate::array::Array;
use crate::walk::Tree;

/// How primitives go into leaves.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LeafShape {
    /// Primitives that are tested together at the price of one, as a power of two.
    pub(crate) block_bits: u32,
    /// Most primitives in a leaf, at most 32.
    pub(crate) most: usize,
    /// Blocks that leaves can tell apart.
    pub(crate) limit: usize,
}

impl LeafShape {
    /// Primitives in a block.
    pub(crate) fn block(self) -> usize {
        1 << self.block_bits
    }

    /// Blocks that so many primitives fill.
    #[inline(always)]
    pub(crate) fn blocks(self, len: usize) -> usize {
        (len + self.block() - 1) >> self.block_bits
    }
}

/// A finished tree and the blocks of its leaves.
pub(crate) struct Built<B> {
    pub(crate) tree: Tree,
    pub(crate) blocks: Array<B>,
    pub(crate) leaves: usize,
    /// Whether a primitive may stand in several leaves.
    pub(crate) cut: bool,
}

/// The corners of primitives that are no triangles.
pub(crate) const NO_CORNERS: Option<fn(u32) -> [Vec3; 3]> = None;

/// Builds a tree over `prims`, each with a finite box.
///
/// With the `corners` of triangles, [`Quality::High`] may put one into several leaves.
///
/// `leaf` gets the primitives of a leaf in ascending order, the blocks to fill with them and
/// the number of the first, and answers what the leaf is to hold. Returns `None` if there
/// would be more than `shape.limit` blocks.
pub(crate) fn build<B: Pod + Send>(
    mut prims: Prims,
    shape: LeafShape,
    quality: Quality,
    corners: Option<impl Fn(u32) -> [Vec3; 3] + Sync>,
    leaf: impl Fn(&[u32], &mut [B], usize) -> u32 + Sync,
) -> Option<Built<B>> {
    debug_assert!(shape.most <= wide::MOST);
    if prims.len() == 0 {
        return Some(Built { tree: Tree::EMPTY, blocks: Array::EMPTY, leaves: 0, cut: false });
    }
    let set = Set::around(prims.as_mut_slice());
    let mut forest = match quality {
        Quality::Linear => linear::build(set.prims, shape),
        Quality::Fast => binary::build(set, shape),
        Quality::High => match corners {
            Some(corners) => spatial::build(set, shape, corners),
            None => binary::build(set, shape),
        },
    };
    // Giving back large memory takes as long as a tenth of the rest.
    rayon::join(
        || match quality {
            Quality::Linear | Quality::Fast => reinsert::improve_top(&mut forest),
            Quality::High => reinsert::improve(&mut forest),
        },
        || drop(prims),
    );
    forest.plan(shape);
    forest.wide(shape, leaf)
}
