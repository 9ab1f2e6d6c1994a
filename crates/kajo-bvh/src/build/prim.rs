//! What the builder moves around: boxes with the numbers of their primitives.

use bytemuck::{Pod, Zeroable};
use kajo_math::{Aabb, Vec3, Vec4};
use rayon::prelude::*;

use crate::array::Array;

/// A box, four floats a corner so that one instruction handles it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Box4 {
    pub(crate) lo: Vec4,
    pub(crate) hi: Vec4,
}

impl Box4 {
    pub(crate) const EMPTY: Box4 = Box4 { lo: Vec4::INFINITY, hi: Vec4::NEG_INFINITY };

    #[inline(always)]
    pub(crate) fn union(self, other: Box4) -> Box4 {
        Box4 { lo: self.lo.min(other.lo), hi: self.hi.max(other.hi) }
    }

    #[inline(always)]
    pub(crate) fn grown(self, p: Vec4) -> Box4 {
        Box4 { lo: self.lo.min(p), hi: self.hi.max(p) }
    }

    /// Half the surface area; not a number when empty.
    #[inline(always)]
    pub(crate) fn half_area(self) -> f32 {
        let e = self.hi - self.lo;
        e.x * (e.y + e.z) + e.y * e.z
    }

    pub(crate) fn aabb(self) -> Aabb {
        Aabb { min: self.lo.truncate(), max: self.hi.truncate() }
    }
}

/// A primitive's box, its number in the low bits of the fourth floats.
///
/// Those floats lie between 1 and 2: a number's bits alone would be a denormal float, which
/// many processors handle slowly, and the fourth lane takes part in all arithmetic.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Prim {
    lo: Vec4,
    hi: Vec4,
}

/// Primitives that a thread takes at a time where all threads work on a large set.
pub(super) const PIECE: usize = 1 << 15;

/// Bits of the number in each of the two floats.
const ID_BITS: u32 = 23;
const ID_MASK: u32 = (1 << ID_BITS) - 1;

impl Prim {
    /// No primitive, with a number that none has.
    const NONE: Prim = Prim::with(Vec3::ZERO, Vec3::ZERO, u32::MAX);

    #[inline(always)]
    const fn new(bounds: Aabb, id: u32) -> Prim {
        Prim::with(bounds.min, bounds.max, id)
    }

    const fn with(lo: Vec3, hi: Vec3, id: u32) -> Prim {
        let low = f32::from_bits(1f32.to_bits() | id & ID_MASK);
        let high = f32::from_bits(1f32.to_bits() | id >> ID_BITS);
        Prim { lo: Vec4::new(lo.x, lo.y, lo.z, low), hi: Vec4::new(hi.x, hi.y, hi.z, high) }
    }

    #[inline(always)]
    pub(crate) fn id(&self) -> u32 {
        self.lo.w.to_bits() & ID_MASK | (self.hi.w.to_bits() & ID_MASK) << ID_BITS
    }

    fn is_none(&self) -> bool {
        self.id() == u32::MAX
    }

    /// The box; its fourth lane means nothing.
    #[inline(always)]
    pub(crate) fn bounds(&self) -> Box4 {
        Box4 { lo: self.lo, hi: self.hi }
    }

    /// Twice the centre; its fourth lane means nothing.
    #[inline(always)]
    pub(crate) fn center2(&self) -> Vec4 {
        self.lo + self.hi
    }
}

/// The primitives that a tree is built over.
pub(crate) struct Prims {
    /// Those that have a box come first.
    all: Array<Prim>,
    len: usize,
}

impl Prims {
    /// Those of the numbers from 0 to `count - 1` that have a box.
    pub(crate) fn new(count: usize, bounds: impl Fn(u32) -> Option<Aabb> + Sync) -> Prims {
        let mut all = Array::<Prim>::zeroed(count);
        let prim = |id: u32| bounds(id).map_or(Prim::NONE, |bounds| Prim::new(bounds, id));
        let fill = |(i, prims): (usize, &mut [Prim])| {
            let mut kept = true;
            for (id, place) in (i * PIECE..).zip(prims) {
                *place = prim(id as u32);
                kept &= !place.is_none();
            }
            kept
        };
        let pieces = all.par_chunks_mut(PIECE).enumerate().map(fill);
        let len = if pieces.reduce(|| true, |a, b| a & b) { count } else { squeeze(&mut all) };
        Prims { all, len }
    }

    pub(crate) fn len(&self) -> usize {
        self.len
    }

    pub(crate) fn as_mut_slice(&mut self) -> &mut [Prim] {
        &mut self.all[..self.len]
    }
}

/// Moves primitives that are some to the front, in their order, and counts them.
fn squeeze(prims: &mut [Prim]) -> usize {
    let mut len = 0;
    for i in 0..prims.len() {
        prims[len] = prims[i];
        len += usize::from(!prims[i].is_none());
    }
    len
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_and_boxes_come_back() {
        let bounds = Aabb { min: Vec3::new(1.0, 2.0, 3.0), max: Vec3::new(4.0, 6.0, 8.0) };
        for id in [0, 1, 0x7f_ffff, 0x80_0000, 0x1234_5678, i32::MAX as u32] {
            let prim = Prim::new(bounds, id);
            assert!(prim.id() == id && !prim.is_none());
            assert_eq!((prim.bounds().aabb(), prim.bounds().half_area()), (bounds, 12.0 + 20.0 + 15.0));
        }
        assert!(Prim::NONE.is_none());
    }

    #[test]
    fn what_has_no_box_is_left_out_and_the_rest_keeps_its_order() {
        let point = |id: u32| Aabb::around([Vec3::splat(id as f32)]);
        for count in [0, 1, 5, PIECE + 7] {
            let ids = |prims: &mut Prims| prims.as_mut_slice().iter().map(Prim::id).collect::<Vec<_>>();
            let mut whole = Prims::new(count, |id| Some(point(id)));
            assert!(ids(&mut whole).into_iter().eq(0..count as u32));
            let mut odd = Prims::new(count, |id| (id % 2 == 1).then(|| point(id)));
            assert_eq!(odd.len(), count / 2);
            assert!(ids(&mut odd).into_iter().eq((1..count as u32).step_by(2)));
            assert!(odd.as_mut_slice().iter().all(|prim| prim.bounds().aabb() == point(prim.id())));
        }
    }
}
