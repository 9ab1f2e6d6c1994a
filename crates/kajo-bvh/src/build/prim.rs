//! What the builder moves around: boxes with the numbers of their primitives.

use bytemuck::{Pod, Zeroable};
use kajo_math::{Aabb, Vec3A, Vec4};
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

    /// The smallest box around `points`.
    #[inline(always)]
    pub(crate) fn around<const N: usize>(points: [Vec3A; N]) -> Box4 {
        points.into_iter().fold(Box4::EMPTY, |bounds, p| bounds.grown(p.extend(0.0)))
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

impl From<Aabb> for Box4 {
    #[inline(always)]
    fn from(bounds: Aabb) -> Box4 {
        Box4 { lo: bounds.min.extend(0.0), hi: bounds.max.extend(0.0) }
    }
}

/// A box as eight floats: its smaller corner, and its larger corner negated, so that the smaller
/// of each float of two boxes are the box around both. Fourth floats mean nothing.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C, align(32))]
pub(super) struct Row(pub(super) [f32; 8]);

impl Row {
    #[inline(always)]
    fn halves(&self) -> [Vec4; 2] {
        [Vec4::from_slice(&self.0[..4]), Vec4::from_slice(&self.0[4..])]
    }

    #[inline(always)]
    pub(super) fn bounds(&self) -> Box4 {
        let [lo, back] = self.halves();
        Box4 { lo, hi: -back }
    }
}

/// A primitive's box, its number in the low bits of the fourth floats.
///
/// Those floats lie between 1 and 2: a number's bits alone would be a denormal float, which
/// many processors handle slowly, and the fourth lane takes part in all arithmetic.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(transparent)]
pub(crate) struct Prim(Row);

/// Primitives that a thread takes at a time where all threads work on a large set.
pub(super) const BLOCK: usize = 1 << 13;

/// Bits of the number in each of the two floats.
const ID_BITS: u32 = 23;
const ID_MASK: u32 = (1 << ID_BITS) - 1;

impl Prim {
    #[inline(always)]
    fn new(bounds: Box4, id: u32) -> Prim {
        let tag = |id: u32| f32::from_bits(1f32.to_bits() | id & ID_MASK);
        let ([lx, ly, lz, _], [hx, hy, hz, _]) = (bounds.lo.to_array(), (-bounds.hi).to_array());
        Prim(Row([lx, ly, lz, tag(id), hx, hy, hz, tag(id >> ID_BITS)]))
    }

    /// No primitive, with a number that none has.
    fn none() -> Prim {
        Prim::new(Box4 { lo: Vec4::ZERO, hi: Vec4::ZERO }, u32::MAX)
    }

    #[inline(always)]
    pub(crate) fn id(&self) -> u32 {
        let bits = |float: usize| self.0.0[float].to_bits() & ID_MASK;
        bits(3) | bits(7) << ID_BITS
    }

    /// The same primitive with another box.
    pub(super) fn with_bounds(&self, bounds: Box4) -> Prim {
        Prim::new(bounds, self.id())
    }

    fn is_none(&self) -> bool {
        self.id() == u32::MAX
    }

    #[inline(always)]
    pub(super) fn row(&self) -> &Row {
        &self.0
    }

    /// The box; its fourth lane means nothing.
    #[inline(always)]
    pub(crate) fn bounds(&self) -> Box4 {
        self.0.bounds()
    }

    /// Twice the centre; its fourth lane means nothing.
    #[inline(always)]
    pub(crate) fn center2(&self) -> Vec4 {
        let [lo, back] = self.0.halves();
        lo - back
    }

    /// Twice the centre on one axis.
    #[inline(always)]
    pub(super) fn center2_on(&self, axis: usize) -> f32 {
        self.0.0[axis & 3] - self.0.0[4 + (axis & 3)]
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
    pub(crate) fn new(count: usize, bounds: impl Fn(u32) -> Option<Box4> + Sync) -> Prims {
        let mut all = Array::<Prim>::zeroed(count);
        let prim = |id: u32| bounds(id).map_or_else(Prim::none, |bounds| Prim::new(bounds, id));
        let fill = |(i, prims): (usize, &mut [Prim])| {
            let mut kept = true;
            for (id, place) in (i * BLOCK..).zip(prims) {
                *place = prim(id as u32);
                kept &= !place.is_none();
            }
            kept
        };
        let blocks = all.par_chunks_mut(BLOCK).enumerate().map(fill);
        let len = if blocks.reduce(|| true, |a, b| a & b) { count } else { compact(&mut all) };
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
fn compact(prims: &mut [Prim]) -> usize {
    let mut len = 0;
    for i in 0..prims.len() {
        prims[len] = prims[i];
        len += usize::from(!prims[i].is_none());
    }
    len
}

#[cfg(test)]
mod tests {
    use kajo_math::Vec3;

    use super::*;

    #[test]
    fn numbers_and_boxes_come_back() {
        let bounds = Aabb { min: Vec3::new(1.0, 2.0, 3.0), max: Vec3::new(4.0, 6.0, 8.0) };
        for id in [0, 1, 0x7f_ffff, 0x80_0000, 0x1234_5678, i32::MAX as u32] {
            let prim = Prim::new(bounds.into(), id);
            assert!(prim.id() == id && !prim.is_none());
            assert_eq!((prim.bounds().aabb(), prim.bounds().half_area()), (bounds, 12.0 + 20.0 + 15.0));
        }
        assert!(Prim::none().is_none());
    }

    #[test]
    fn what_has_no_box_is_left_out_and_the_rest_keeps_its_order() {
        let point = |id: u32| Aabb::around([Vec3::splat(id as f32)]);
        for count in [0, 1, 5, BLOCK + 7] {
            let ids = |prims: &mut Prims| prims.as_mut_slice().iter().map(Prim::id).collect::<Vec<_>>();
            let mut whole = Prims::new(count, |id| Some(point(id).into()));
            assert!(ids(&mut whole).into_iter().eq(0..count as u32));
            let mut odd = Prims::new(count, |id| (id % 2 == 1).then(|| point(id).into()));
            assert_eq!(odd.len(), count / 2);
            assert!(ids(&mut odd).into_iter().eq((1..count as u32).step_by(2)));
            assert!(odd.as_mut_slice().iter().all(|prim| prim.bounds().aabb() == point(prim.id())));
        }
    }
}
