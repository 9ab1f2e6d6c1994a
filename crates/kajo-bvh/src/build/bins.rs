//! Primitives by bins of their centres, and what borders between bins cost.
//!
//! Most of a build's time goes into adding primitives to bins. A box is one register there, and
//! one minimum adds it to another; costs are weighed for three axes at a time, without a branch.

use kajo_math::{Mat4, Vec4};

use super::LeafShape;
use super::prim::{Box4, Prim, Row};
use crate::simd::{Simd, dispatch};

/// From so many bins on, primitives are added in turn to two histograms.
const IN_TURN: usize = 16;
/// A float whose neighbours are one apart: adding it rounds to an integer in the low bits.
const ROUND: f32 = 8_388_608.0;

/// The bin of a centre on each axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bins {
    base: Vec4,
    scale: Vec4,
    last: f32,
}

impl Bins {
    /// `count` bins over twice the centres.
    pub(super) fn new(centers: Box4, count: usize) -> Bins {
        let extent = centers.hi - centers.lo;
        let scale = Vec4::splat(count as f32 * 0.9999) / extent;
        // An axis without extent has no border worth trying: everything lands in bin 0.
        let scale = Vec4::select(scale.cmplt(Vec4::INFINITY), scale, Vec4::ZERO);
        Bins { base: centers.lo, scale, last: ROUND + (count - 1) as f32 }
    }

    /// Bin numbers on three axes, as what is added to [`ROUND`].
    #[inline(always)]
    fn bin_position(&self, center2: Vec4) -> Vec4 {
        let place = (center2 - self.base) * self.scale - Vec4::splat(0.5) + Vec4::splat(ROUND);
        place.max(Vec4::splat(ROUND)).min(Vec4::splat(self.last))
    }

    /// Tells which primitives stand before a border.
    #[inline(always)]
    pub(super) fn is_left(&self, border: &Border) -> impl Fn(&Prim) -> bool {
        let (base, scale) = (self.base[border.axis], self.scale[border.axis]);
        let (axis, border) = (border.axis, ROUND + border.bin as i32 as f32);
        // As `place` on this axis; also what is not a number is in the first bin.
        move |prim| {
            let is_right = (prim.center2_on(axis) - base) * scale - 0.5 + ROUND >= border;
            !is_right
        }
    }
}

/// How many primitives each of `N` bins holds, and the box around them.
pub(super) struct Histogram<const N: usize> {
    boxes: [[Row; 3]; N],
    /// The fourth is always zero.
    pub(super) counts: [[u32; 4]; N],
}

/// The cheapest border between bins.
pub(super) struct Border {
    pub(super) axis: usize,
    /// The first bin after it.
    pub(super) bin: usize,
    /// The boxes around the left and the right.
    pub(super) sides: [Box4; 2],
    /// Primitives on the left.
    pub(super) left: usize,
}

impl<const N: usize> Histogram<N> {
    #[inline(always)]
    pub(super) fn empty(simd: impl Simd) -> Self {
        let row = Row(simd.store(simd.splat(f32::INFINITY)));
        Histogram { boxes: [[row; 3]; N], counts: [[0; 4]; N] }
    }

    /// That of `prims`.
    pub(super) fn of(prims: &[Prim], bins: &Bins) -> Self {
        dispatch!(simd => Self::of_on(simd, prims, bins))
    }

    #[inline(always)]
    pub(super) fn of_on(simd: impl Simd, prims: &[Prim], bins: &Bins) -> Self {
        let mut histogram = Self::empty(simd);
        if N < IN_TURN {
            for prim in prims {
                histogram.add(simd, prim, bins);
            }
            return histogram;
        }
        // Neighbours in the list mostly share their bins. In two histograms in turn, none waits
        // for the one before it.
        let mut other = Self::empty(simd);
        let (pairs, rest) = prims.as_chunks::<2>();
        for [a, b] in pairs {
            histogram.add(simd, a, bins);
            other.add(simd, b, bins);
        }
        for prim in rest {
            histogram.add(simd, prim, bins);
        }
        histogram.merge(simd, &other);
        histogram
    }

    #[inline(always)]
    fn add(&mut self, simd: impl Simd, prim: &Prim, bins: &Bins) {
        let row = simd.load(&prim.row().0);
        let place = bins.bin_position(prim.center2()).to_array();
        for (axis, place) in place.into_iter().take(3).enumerate() {
            let bin = place.to_bits() as usize % N;
            let sum = &mut self.boxes[bin][axis].0;
            *sum = simd.store(simd.min(simd.load(sum), row));
            self.counts[bin][axis] += 1;
        }
    }

    /// Adds another.
    #[inline(always)]
    pub(super) fn merge(&mut self, simd: impl Simd, other: &Histogram<N>) {
        for bin in 0..N {
            for axis in 0..3 {
                let sum = &mut self.boxes[bin][axis].0;
                *sum = simd.store(simd.min(simd.load(sum), simd.load(&other.boxes[bin][axis].0)));
                self.counts[bin][axis] += other.counts[bin][axis];
            }
        }
    }

    /// The cheapest border; `None` when all centres share their bins.
    #[inline(always)]
    pub(super) fn best<S: Simd>(&self, simd: S, shape: LeafShape) -> Option<Border> {
        // What lies right of each border costs, on each axis.
        let mut rights = [Vec4::ZERO; N];
        let mut sum = Sum::new(simd);
        for bin in (1..N).rev() {
            sum.add(simd, &self.boxes[bin], self.counts[bin]);
            rights[bin] = sum.cost(simd, shape);
        }
        let (mut least, mut borders) = (Vec4::INFINITY, Vec4::ZERO);
        let mut sum = Sum::new(simd);
        for (bin, right) in rights.into_iter().enumerate().skip(1) {
            sum.add(simd, &self.boxes[bin - 1], self.counts[bin - 1]);
            // With an empty side the cost is infinity times zero, which is not less.
            let cost = sum.cost(simd, shape) + right;
            let is_less = cost.cmplt(least);
            least = Vec4::select(is_less, cost, least);
            borders = Vec4::select(is_less, Vec4::splat(bin as f32), borders);
        }
        let (least, borders) = (least.to_array(), borders.to_array());
        let axis = (1..3).fold(0, |best, axis| if least[axis] < least[best] { axis } else { best });
        (least[axis] < f32::INFINITY).then(|| self.border(simd, axis, borders[axis] as usize))
    }

    #[inline(always)]
    fn border(&self, simd: impl Simd, axis: usize, bin: usize) -> Border {
        let around = |bins: &[[Row; 3]]| {
            let sum = bins
                .iter()
                .fold(simd.splat(f32::INFINITY), |sum, bin| simd.min(sum, simd.load(&bin[axis].0)));
            Row(simd.store(sum)).bounds()
        };
        let left = self.counts[..bin].iter().map(|counts| counts[axis] as usize).sum();
        Border { axis, bin, sides: [around(&self.boxes[..bin]), around(&self.boxes[bin..])], left }
    }
}

/// What some bins hold, for each axis.
struct Sum<S: Simd> {
    boxes: [S::F32x8; 3],
    counts: [u32; 4],
}

impl<S: Simd> Sum<S> {
    #[inline(always)]
    fn new(simd: S) -> Sum<S> {
        Sum { boxes: [simd.splat(f32::INFINITY); 3], counts: [0; 4] }
    }

    #[inline(always)]
    fn add(&mut self, simd: S, boxes: &[Row; 3], counts: [u32; 4]) {
        for (sum, row) in self.boxes.iter_mut().zip(boxes) {
            *sum = simd.min(*sum, simd.load(&row.0));
        }
        for (sum, count) in self.counts.iter_mut().zip(counts) {
            *sum += count;
        }
    }

    /// `A n`, or infinity times zero.
    #[inline(always)]
    fn cost(&self, simd: S, shape: LeafShape) -> Vec4 {
        // The smaller corner minus the larger; signs cancel in the products below.
        let size = |axis: usize| {
            let [lo, back] = simd.halves(self.boxes[axis]);
            lo + back
        };
        let size = Mat4::from_cols(size(0), size(1), size(2), size(2)).transpose();
        let half_areas = size.x_axis * (size.y_axis + size.z_axis) + size.y_axis * size.z_axis;
        half_areas * Vec4::from_array(self.counts.map(|n| shape.blocks(n as usize) as i32 as f32))
    }
}
