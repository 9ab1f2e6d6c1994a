//! Where to split a set of boxes: the binned surface area heuristic.
//!
//! A node costs the rays that meet it; the chance of that is proportional to its surface.
//! Splitting a set into `L` and `R` costs
//!
//! ```text
//! C = A(L) n(L) + A(R) n(R)
//! ```
//!
//! where `n` counts leaf blocks rather than primitives. Centres are sorted into bins on each
//! axis and the borders between bins are tried [Wald 2007].

use kajo_math::Vec4;
use rayon::prelude::*;

use super::prim::{Box4, PIECE, Prim};
use crate::simd::dispatch;

/// Bins on an axis for large, for small and for tiny sets.
const MANY: usize = 16;
const FEW: usize = 8;
const LEAST: usize = 4;
/// A float whose neighbours are one apart: adding it rounds to an integer in the low bits.
const ROUND: f32 = 8_388_608.0;

/// The bin of a centre on each axis.
#[derive(Clone, Copy, Debug)]
struct Bins {
    base: Vec4,
    scale: Vec4,
    last: f32,
}

impl Bins {
    /// `count` bins over twice the centres.
    fn new(centers: Box4, count: usize) -> Bins {
        let extent = centers.hi - centers.lo;
        let scale = Vec4::splat(count as f32 * 0.9999) / extent;
        // An axis without extent has no border worth trying: everything lands in bin 0.
        let scale = Vec4::select(scale.cmplt(Vec4::INFINITY), scale, Vec4::ZERO);
        Bins { base: centers.lo, scale, last: ROUND + (count - 1) as f32 }
    }

    /// Bin numbers on three axes, as what is added to [`ROUND`].
    #[inline(always)]
    fn place(&self, center2: Vec4) -> Vec4 {
        let place = (center2 - self.base) * self.scale - Vec4::splat(0.5) + Vec4::splat(ROUND);
        place.max(Vec4::splat(ROUND)).min(Vec4::splat(self.last))
    }
}

/// How many primitives each of `N` bins holds, and the box around them.
struct Histogram<const N: usize> {
    boxes: [[Box4; 3]; N],
    counts: [[u32; 3]; N],
}

impl<const N: usize> Histogram<N> {
    const EMPTY: Self = Histogram { boxes: [[Box4::EMPTY; 3]; N], counts: [[0; 3]; N] };

    #[inline(always)]
    fn add(&mut self, prims: &[Prim], bins: &Bins) {
        for prim in prims {
            let bounds = prim.bounds();
            let place = bins.place(prim.center2()).to_array();
            for (axis, place) in place.into_iter().take(3).enumerate() {
                let bin = place.to_bits() as usize % N;
                self.boxes[bin][axis] = self.boxes[bin][axis].union(bounds);
                self.counts[bin][axis] += 1;
            }
        }
    }

    fn merge(&mut self, other: &Histogram<N>) {
        for bin in 0..N {
            for axis in 0..3 {
                self.boxes[bin][axis] = self.boxes[bin][axis].union(other.boxes[bin][axis]);
                self.counts[bin][axis] += other.counts[bin][axis];
            }
        }
    }

    /// The cheapest border: its axis, the first bin after it, both sides, and what the left
    /// side holds. `None` when all centres share their bins.
    #[inline(always)]
    fn best(&self, block: u32) -> Option<(usize, usize, [Box4; 2], usize)> {
        let mut best = None;
        let mut least = f32::INFINITY;
        for axis in 0..3 {
            // From the right: what is at or past each bin.
            let mut right = [(Box4::EMPTY, 0); N];
            let mut sum = (Box4::EMPTY, 0);
            for bin in (1..N).rev() {
                sum = (sum.0.union(self.boxes[bin][axis]), sum.1 + self.counts[bin][axis]);
                right[bin] = sum;
            }
            let mut left = (Box4::EMPTY, 0);
            for border in 1..N {
                left = (left.0.union(self.boxes[border - 1][axis]), left.1 + self.counts[border - 1][axis]);
                let right = right[border];
                let cost = left.0.half_area() * left.1.div_ceil(block) as f32
                    + right.0.half_area() * right.1.div_ceil(block) as f32;
                // With an empty side the cost is infinity times zero, which is not less.
                if cost < least {
                    least = cost;
                    best = Some((axis, border, [left.0, right.0], left.1 as usize));
                }
            }
        }
        best
    }
}

/// A border between two bins.
#[derive(Clone, Debug)]
pub(super) struct Split {
    bins: Bins,
    axis: usize,
    /// Places below this one are left.
    border: f32,
    pub(super) sides: [Box4; 2],
    /// Primitives on the left.
    pub(super) left: usize,
    /// The same for each piece of a large set.
    lefts: Vec<usize>,
}

impl Split {
    /// The cheapest split of `prims` with `block` primitives to a leaf block; `None` when
    /// all centres share their bins.
    pub(super) fn best(prims: &[Prim], block: u32) -> Option<Split> {
        if prims.len() < 3 * LEAST {
            dispatch!(_simd => Split::small::<LEAST>(prims, block))
        } else if prims.len() < 10 * FEW {
            dispatch!(_simd => Split::small::<FEW>(prims, block))
        } else if prims.len() < 2 * PIECE {
            dispatch!(_simd => Split::small::<MANY>(prims, block))
        } else {
            Split::large(prims, block)
        }
    }

    #[inline(always)]
    fn small<const N: usize>(prims: &[Prim], block: u32) -> Option<Split> {
        let mut centers = Box4::EMPTY;
        for prim in prims {
            centers = centers.grown(prim.center2());
        }
        let (bins, mut histogram) = (Bins::new(centers, N), Histogram::<N>::EMPTY);
        histogram.add(prims, &bins);
        histogram.best(block).map(|best| Split::new(bins, best, Vec::new()))
    }

    fn new(bins: Bins, best: (usize, usize, [Box4; 2], usize), lefts: Vec<usize>) -> Split {
        let (axis, border, sides, left) = best;
        Split { bins, axis, border: ROUND + border as f32, sides, left, lefts }
    }

    /// By all threads.
    fn large(prims: &[Prim], block: u32) -> Option<Split> {
        let bins = Bins::new(centers(prims), MANY);
        let of = |prims: &[Prim]| {
            let mut histogram = Histogram::<MANY>::EMPTY;
            histogram.add(prims, &bins);
            histogram
        };
        let histograms: Vec<_> = prims.par_chunks(PIECE).map(of).collect();
        let mut sum = Histogram::<MANY>::EMPTY;
        histograms.iter().for_each(|histogram| sum.merge(histogram));
        let best = sum.best(block)?;
        let left = |h: &Histogram<MANY>| h.counts[..best.1].iter().map(|n| n[best.0] as usize).sum();
        let lefts = histograms.iter().map(left).collect();
        Some(Split::new(bins, best, lefts))
    }

    #[inline(always)]
    fn is_left(&self, prim: &Prim) -> bool {
        self.bins.place(prim.center2()).to_array()[self.axis] < self.border
    }

    /// Moves the left side of `prims` to the front.
    pub(super) fn part(&self, prims: &mut [Prim]) {
        if self.lefts.is_empty() {
            return self.part_piece(prims);
        }
        prims.par_chunks_mut(PIECE).for_each(|piece| self.part_piece(piece));
        // What is right but stands before the border changes places with what is left behind it.
        let (mut front, mut back) = prims.split_at_mut(self.left);
        let (mut rights, mut lefts) = (Vec::new(), Vec::new());
        for &n_left in &self.lefts {
            let piece = PIECE.min(front.len() + back.len());
            let n_front = piece.min(front.len());
            let (here, rest) = front.split_at_mut(n_front);
            front = rest;
            rights.push(here.split_at_mut(n_left.min(n_front)).1);
            let (here, rest) = back.split_at_mut(piece - n_front);
            back = rest;
            lefts.push(here.split_at_mut(n_left.saturating_sub(n_front)).0);
        }
        pairs(rights, lefts).into_par_iter().for_each(|(right, left)| right.swap_with_slice(left));
    }

    fn part_piece(&self, prims: &mut [Prim]) {
        dispatch!(_simd => self.part_piece_on(prims))
    }

    #[inline(always)]
    fn part_piece_on(&self, prims: &mut [Prim]) {
        let mut left = 0;
        for i in 0..prims.len() {
            // Without a branch: which side comes next cannot be predicted.
            let is_left = self.is_left(&prims[i]);
            prims.swap(i, left);
            left += usize::from(is_left);
        }
    }
}

/// Two lists of slices with the same number of items in all, cut into pairs of the same length.
fn pairs<'a, T>(a: Vec<&'a mut [T]>, b: Vec<&'a mut [T]>) -> Vec<(&'a mut [T], &'a mut [T])> {
    let mut pairs = Vec::with_capacity(a.len() + b.len());
    let mut others = b.into_iter();
    let mut other: &mut [T] = &mut [];
    for mut one in a {
        while !one.is_empty() {
            if other.is_empty() {
                let Some(next) = others.next() else { return pairs };
                other = next;
                continue;
            }
            let n = one.len().min(other.len());
            let (x, y) = (one.split_at_mut(n), other.split_at_mut(n));
            pairs.push((x.0, y.0));
            (one, other) = (x.1, y.1);
        }
    }
    pairs
}

/// The box around twice the centres.
pub(super) fn centers(prims: &[Prim]) -> Box4 {
    around(prims, |b, p| b.grown(p.center2()))
}

/// The box around everything in `prims`.
pub(super) fn bounds(prims: &[Prim]) -> Box4 {
    around(prims, |b, p| b.union(p.bounds()))
}

fn around(prims: &[Prim], grow: impl Fn(Box4, &Prim) -> Box4 + Sync) -> Box4 {
    if prims.len() < 2 * PIECE {
        return prims.iter().fold(Box4::EMPTY, grow);
    }
    let piece = |prims: &[Prim]| prims.iter().fold(Box4::EMPTY, &grow);
    prims.par_chunks(PIECE).map(piece).reduce(|| Box4::EMPTY, Box4::union)
}

#[cfg(test)]
mod tests {
    use kajo_math::rng::mix;
    use kajo_math::{Aabb, Vec3};

    use super::*;
    use crate::build::prim::Prims;

    /// Boxes of all sizes here and there.
    fn prims(n: usize) -> Prims {
        let at = |i: u32, k: u64| (mix(u64::from(i) << 8 | k) >> 40) as f32;
        Prims::new(n, |i| {
            let p = Vec3::new(at(i, 0), at(i, 1), at(i, 2));
            Some(Aabb::around([p, p + at(i, 3) * at(i, 4) * 1e-9]))
        })
    }

    #[test]
    fn parting_keeps_everything_and_agrees_with_the_border() {
        for n in [2, 3, 9, 100, 1000, 2 * PIECE, 2 * PIECE + 1, 5 * PIECE - 3] {
            let mut prims = prims(n);
            let prims = prims.as_mut_slice();
            let split = Split::best(prims, 4).unwrap();
            assert!(split.left > 0 && split.left < n);
            split.part(prims);
            let (left, right) = prims.split_at(split.left);
            assert!(left.iter().all(|prim| split.is_left(prim)), "{n}");
            assert!(!right.iter().any(|prim| split.is_left(prim)), "{n}");
            assert_eq!([bounds(left), bounds(right)].map(Box4::aabb), split.sides.map(Box4::aabb));
            let mut ids: Vec<u32> = prims.iter().map(Prim::id).collect();
            ids.sort_unstable();
            assert!(ids.into_iter().eq(0..n as u32), "{n}");
        }
    }
}
