//! A binary tree in the order of a space-filling curve: fast to build, slower to trace.
//!
//! The bits of a centre's three coordinates, interleaved from the highest down, are its place
//! on a curve that fills the box around all centres [Morton 1966]. Primitives are sorted by
//! that place, and a set splits where the highest bit changes that is not the same for all of
//! it [Lauterbach et al. 2009].

use rayon::prelude::*;

use super::LeafShape;
use super::binary::{Forest, Grove, Next, Stem, TASK, TASK_LEVELS, TOP_LEVELS, Twig};
use super::prim::{Box4, Prim};
use super::split;

/// Bits of each coordinate.
const BITS: u32 = 21;

/// A primitive's place on the curve, and its place in the list.
type Key = (u64, u32);

/// Leaves two zeros between the lowest [`BITS`] bits.
fn spread(x: u32) -> u64 {
    let x = u64::from(x) & 0x1f_ffff;
    let x = (x | x << 32) & 0x001f_0000_0000_ffff;
    let x = (x | x << 16) & 0x001f_0000_ff00_00ff;
    let x = (x | x << 8) & 0x100f_00f0_0f00_f00f;
    let x = (x | x << 4) & 0x10c3_0c30_c30c_30c3;
    (x | x << 2) & 0x1249_2492_4924_9249
}

/// The binary tree over a list of primitives that is not empty.
pub(super) fn build(prims: &[Prim], shape: LeafShape) -> Forest {
    let centers = split::centers(prims);
    let extent = centers.hi - centers.lo;
    // The same scale on all axes keeps the cells cubes.
    let scale = ((1u32 << BITS) - 1) as f32 / extent.truncate().max_element();
    let scale = if scale.is_finite() { scale } else { 0.0 };
    let key = |(i, prim): (usize, &Prim)| {
        let [x, y, z, _] = ((prim.center2() - centers.lo) * scale).to_array().map(|x| spread(x as u32));
        (x << 2 | y << 1 | z, i as u32)
    };
    let mut keys: Vec<Key> = prims.par_iter().enumerate().with_min_len(1 << 12).map(key).collect();
    keys.par_sort_unstable();
    let mut forest = Forest::default();
    let curve = Curve { prims, block: shape.block() };
    curve.flatten(curve.upper(&keys, 0), &mut forest);
    forest
}

/// What to split, and when to stop.
#[derive(Clone, Copy)]
struct Curve<'a> {
    prims: &'a [Prim],
    block: usize,
}

/// The upper part of the tree while it is built.
enum Upper {
    Grove(Grove),
    Node(Box<[Upper; 2]>),
}

/// Two parts of a stretch of the curve, not empty; two halves where all places are the same or
/// a part could hold more than `most`, the primitives that fit below.
fn split(keys: &[Key], most: usize) -> (&[Key], &[Key]) {
    let differ = keys[0].0 ^ keys[keys.len() - 1].0;
    if differ == 0 || keys.len() > most {
        return keys.split_at(keys.len() / 2);
    }
    let bit = 1 << (63 - differ.leading_zeros());
    keys.split_at(keys.partition_point(|key| key.0 & bit == 0))
}

impl Curve<'_> {
    fn upper(self, keys: &[Key], depth: usize) -> Upper {
        if keys.len() <= TASK {
            let mut grove = Grove::default();
            grove.ids.reserve(keys.len());
            self.grow(keys, &mut grove, 0);
            return Upper::Grove(grove);
        }
        let (left, right) = split(keys, TASK << (TOP_LEVELS - depth - 1).min(32));
        let (left, right) = rayon::join(|| self.upper(left, depth + 1), || self.upper(right, depth + 1));
        Upper::Node(Box::new([left, right]))
    }

    fn flatten(self, upper: Upper, forest: &mut Forest) -> Box4 {
        let index = forest.stems.len();
        match upper {
            Upper::Grove(grove) => forest.push(grove),
            Upper::Node(children) => {
                forest.stems.push(Stem::new(Box4::EMPTY, Next::Right(0)));
                let [left, right] = *children;
                let left = self.flatten(left, forest);
                forest.stems[index].next = Next::Right(forest.stems.len() as u32);
                forest.stems[index].bounds = left.union(self.flatten(right, forest));
            }
        }
        forest.stems[index].bounds
    }

    fn grow(self, keys: &[Key], grove: &mut Grove, depth: usize) -> Box4 {
        let index = grove.twigs.len();
        grove.twigs.push(Twig::new(Box4::EMPTY, keys.len()));
        let bounds = if keys.len() <= self.block {
            let prims = keys.iter().map(|key| &self.prims[key.1 as usize]);
            grove.ids.extend(prims.clone().map(Prim::id));
            prims.fold(Box4::EMPTY, |bounds, prim| bounds.union(prim.bounds()))
        } else {
            let (left, right) = split(keys, self.block << (TASK_LEVELS - depth - 1));
            let left = self.grow(left, grove, depth + 1);
            grove.twigs[index].right = grove.twigs.len() as u16;
            left.union(self.grow(right, grove, depth + 1))
        };
        grove.twigs[index].set_bounds(bounds);
        bounds
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_are_spread_and_stay_in_order() {
        for bit in 0..BITS {
            assert_eq!(spread(1 << bit), 1 << (3 * bit));
        }
        assert_eq!(spread(u32::MAX), 0x1249_2492_4924_9249);
    }

    #[test]
    fn a_stretch_splits_where_its_highest_bit_changes() {
        let keys = [1, 1, 3, 4, 5, 5].map(|code| (code, 0));
        let lengths = |keys: &[Key], most| {
            let (left, right) = split(keys, most);
            (left.len(), right.len())
        };
        assert_eq!(lengths(&keys, 6), (3, 3));
        assert_eq!(lengths(&keys[1..], 6), (2, 3));
        assert_eq!(lengths(&keys[..3], 6), (2, 1));
        assert_eq!(lengths(&keys[..2], 6), (1, 1), "the same place");
        assert_eq!(lengths(&keys[..3], 2), (1, 2), "too deep");
    }
}
