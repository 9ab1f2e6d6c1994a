//! What the builder moves around: boxes with the numbers of their primitives.

use kajo_math::{Aabb, Vec4};

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

/// A primitive's box. The fourth float of `lo` holds the bits of its number.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Prim {
    lo: Vec4,
    hi: Vec4,
}

impl Prim {
    #[inline(always)]
    pub(crate) fn new(bounds: Aabb, id: u32) -> Prim {
        Prim { lo: bounds.min.extend(f32::from_bits(id)), hi: bounds.max.extend(0.0) }
    }

    #[inline(always)]
    pub(crate) fn id(&self) -> u32 {
        self.lo.w.to_bits()
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
