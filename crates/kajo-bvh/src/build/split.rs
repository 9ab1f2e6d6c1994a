//! Where to split a set of boxes: the binned surface area heuristic.
//!
//! A node costs the rays that meet it; the chance of that is proportional to its surface.
//! Splitting a set into `L` and `R` costs
//!
//! ```text
//! C = A(L) n(L) + A(R) n(R)
//! ```
//!
//! where `n` counts leaf blocks rather than primitives. Centres are sorted into [`bins`](super::bins)
//! on each axis and the borders between bins are tried [Wald 2007].

use rayon::prelude::*;

use super::LeafShape;
use super::bins::{Bins, Border, Histogram};
use super::prim::{BLOCK, Box4, Prim};
use crate::simd::{Portable, Simd, dispatch};

/// Bins on an axis for large, for small and for tiny sets.
const MANY: usize = 16;
const FEW: usize = 8;
const LEAST: usize = 4;
/// A border between two bins.
pub(super) struct Split {
    bins: Bins,
    best: Border,
    /// Primitives on the left of each block of a large set.
    lefts: Vec<usize>,
}

impl Split {
    /// The cheapest split of `prims`; `None` when all centres share their bins.
    pub(super) fn best(prims: &[Prim], shape: LeafShape) -> Option<Split> {
        if prims.len() < 3 * LEAST {
            dispatch!(simd => Split::small::<LEAST>(simd, prims, shape))
        } else if prims.len() < 10 * FEW {
            dispatch!(simd => Split::small::<FEW>(simd, prims, shape))
        } else if prims.len() < 2 * BLOCK {
            dispatch!(simd => Split::small::<MANY>(simd, prims, shape))
        } else {
            Split::large(prims, shape)
        }
    }

    #[inline(always)]
    fn small<const N: usize>(simd: impl Simd, prims: &[Prim], shape: LeafShape) -> Option<Split> {
        let mut centers = Box4::EMPTY;
        for prim in prims {
            centers = centers.grown(prim.center2());
        }
        let bins = Bins::new(centers, N);
        let histogram = Histogram::<N>::of_on(simd, prims, &bins);
        histogram.best(simd, shape).map(|best| Split { bins, best, lefts: Vec::new() })
    }

    /// By all threads.
    fn large(prims: &[Prim], shape: LeafShape) -> Option<Split> {
        let bins = Bins::new(centers(prims), MANY);
        let of = |prims: &[Prim]| Histogram::<MANY>::of(prims, &bins);
        let histograms: Vec<_> = prims.par_chunks(BLOCK).map(of).collect();
        let mut sum = Histogram::<MANY>::empty(Portable);
        histograms.iter().for_each(|histogram| sum.merge(Portable, histogram));
        let best = sum.best(Portable, shape)?;
        let left = |h: &Histogram<MANY>| h.counts[..best.bin].iter().map(|n| n[best.axis] as usize).sum();
        let lefts = histograms.iter().map(left).collect();
        Some(Split { bins, best, lefts })
    }

    /// Primitives on the left.
    pub(super) fn left(&self) -> usize {
        self.best.left
    }

    /// The boxes around the left and the right.
    pub(super) fn sides(&self) -> [Box4; 2] {
        self.best.sides
    }

    /// Moves the left side of `prims` to the front.
    pub(super) fn part(&self, prims: &mut [Prim]) {
        if self.lefts.is_empty() {
            return self.part_block(prims);
        }
        prims.par_chunks_mut(BLOCK).for_each(|block| self.part_block(block));
        // What is right but stands before the border changes places with what is left behind it.
        let (mut front, mut back) = prims.split_at_mut(self.best.left);
        let (mut rights, mut lefts) = (Vec::new(), Vec::new());
        for &n_left in &self.lefts {
            let block = BLOCK.min(front.len() + back.len());
            let n_front = block.min(front.len());
            let (here, rest) = front.split_at_mut(n_front);
            front = rest;
            rights.push(here.split_at_mut(n_left.min(n_front)).1);
            let (here, rest) = back.split_at_mut(block - n_front);
            back = rest;
            lefts.push(here.split_at_mut(n_left.saturating_sub(n_front)).0);
        }
        pairs(rights, lefts).into_par_iter().for_each(|(right, left)| right.swap_with_slice(left));
    }

    fn part_block(&self, prims: &mut [Prim]) {
        dispatch!(_simd => self.part_block_on(prims))
    }

    #[inline(always)]
    fn part_block_on(&self, prims: &mut [Prim]) {
        let is_left = self.bins.is_left(&self.best);
        let mut left = 0;
        for i in 0..prims.len() {
            // Without a branch: which side comes next cannot be predicted.
            let prim = &prims[i];
            let (step, prim) = (usize::from(is_left(prim)), *prim);
            prims[i] = prims[left];
            prims[left] = prim;
            left += step;
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
    if prims.len() < 2 * BLOCK {
        return prims.iter().fold(Box4::EMPTY, grow);
    }
    let block = |prims: &[Prim]| prims.iter().fold(Box4::EMPTY, &grow);
    prims.par_chunks(BLOCK).map(block).reduce(|| Box4::EMPTY, Box4::union)
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
            Some(Aabb::around([p, p + at(i, 3) * at(i, 4) * 1e-9]).into())
        })
    }

    #[test]
    fn parting_keeps_everything_and_agrees_with_the_border() {
        for n in [2, 3, 9, 100, 1000, 2 * BLOCK, 2 * BLOCK + 1, 5 * BLOCK - 3] {
            let mut prims = prims(n);
            let prims = prims.as_mut_slice();
            let split = Split::best(prims, LeafShape { block_bits: 2, most: 8, limit: n }).unwrap();
            assert!(split.left() > 0 && split.left() < n);
            split.part(prims);
            let ((left, right), is_left) = (prims.split_at(split.left()), split.bins.is_left(&split.best));
            assert!(left.iter().all(&is_left), "{n}");
            assert!(!right.iter().any(is_left), "{n}");
            assert_eq!([bounds(left), bounds(right)].map(Box4::aabb), split.sides().map(Box4::aabb));
            let mut ids: Vec<u32> = prims.iter().map(Prim::id).collect();
            ids.sort_unstable();
            assert!(ids.into_iter().eq(0..n as u32), "{n}");
        }
    }
}
