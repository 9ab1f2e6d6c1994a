//! Where to split a set of boxes: the binned surface area heuristic.
//!
//! A node costs the rays that meet it; the chance of that is proportional to its surface.
//! Splitting a set into `L` and `R` costs
//!
//! ```text
//! C = 1 + (A(L) n(L) + A(R) n(R)) / A
//! ```
//!
//! where `n` counts leaf blocks rather than primitives. Centres are sorted into bins on each
//! axis and the borders between bins are tried [Wald 2007].

use kajo_math::Vec4;
use rayon::prelude::*;

use super::prim::{Box4, Prim};

/// Most bins on an axis.
const BINS: usize = 32;
/// Sets larger than this are binned and parted by several threads, in pieces of this size.
pub(super) const PARALLEL: usize = 1 << 15;
/// A float whose neighbours are one apart: adding it rounds to an integer in the low bits.
const ROUND: f32 = 8_388_608.0;

/// The bin of a centre on each axis.
#[derive(Clone, Copy, Debug)]
struct Bins {
    base: Vec4,
    scale: Vec4,
    last: Vec4,
    count: usize,
}

impl Bins {
    fn new(centers: Box4, n: usize) -> Bins {
        let count = BINS.min(4 + n / 20);
        let extent = centers.hi - centers.lo;
        // An axis without extent has no border worth trying: everything lands in bin 0.
        let scale =
            Vec4::select(extent.cmpgt(Vec4::ZERO), Vec4::splat(count as f32 * 0.9999) / extent, Vec4::ZERO);
        let finite = Vec4::select(scale.cmplt(Vec4::INFINITY), scale, Vec4::ZERO);
        Bins { base: centers.lo, scale: finite, last: Vec4::splat(ROUND + (count - 1) as f32), count }
    }

    /// Bin numbers on three axes, each below [`BINS`].
    #[inline(always)]
    fn of(&self, prim: &Prim) -> [usize; 3] {
        let place = (prim.center2() - self.base) * self.scale - Vec4::splat(0.5);
        let bits = (place + Vec4::splat(ROUND)).max(Vec4::splat(ROUND)).min(self.last).to_array();
        [0, 1, 2].map(|axis| bits[axis].to_bits() as usize & (BINS - 1))
    }
}

/// How many primitives each bin holds, and the box around them.
struct Histogram {
    boxes: [[Box4; 3]; BINS],
    counts: [[u32; 3]; BINS],
}

impl Histogram {
    fn of(prims: &[Prim], bins: &Bins) -> Histogram {
        let mut h = Histogram { boxes: [[Box4::EMPTY; 3]; BINS], counts: [[0; 3]; BINS] };
        for prim in prims {
            let bounds = prim.bounds();
            for (axis, bin) in bins.of(prim).into_iter().enumerate() {
                h.boxes[bin][axis] = h.boxes[bin][axis].union(bounds);
                h.counts[bin][axis] += 1;
            }
        }
        h
    }

    fn merged(mut self, other: &Histogram) -> Histogram {
        for bin in 0..BINS {
            for axis in 0..3 {
                self.boxes[bin][axis] = self.boxes[bin][axis].union(other.boxes[bin][axis]);
                self.counts[bin][axis] += other.counts[bin][axis];
            }
        }
        self
    }
}

/// A border between two bins.
#[derive(Clone, Copy, Debug)]
pub(super) struct Split {
    bins: Bins,
    axis: usize,
    /// The first bin on the right.
    border: usize,
    /// `A(L) n(L) + A(R) n(R)`.
    pub(super) cost: f32,
    pub(super) sides: [Box4; 2],
    pub(super) left: usize,
}

impl Split {
    /// The cheapest split of `prims` with `block` primitives to a leaf block; `None` when
    /// all centres share their bins.
    pub(super) fn best(prims: &[Prim], block: u32) -> Option<Split> {
        let bins = Bins::new(centers(prims), prims.len());
        let histogram = if prims.len() >= 2 * PARALLEL {
            prims
                .par_chunks(PARALLEL)
                .map(|piece| Histogram::of(piece, &bins))
                .reduce_with(|a, b| a.merged(&b))
                .unwrap_or_else(|| Histogram::of(&[], &bins))
        } else {
            Histogram::of(prims, &bins)
        };
        (0..3)
            .filter_map(|axis| Split::on_axis(&histogram, &bins, axis, block))
            .min_by(|a, b| a.cost.total_cmp(&b.cost))
    }

    fn on_axis(h: &Histogram, bins: &Bins, axis: usize, block: u32) -> Option<Split> {
        let blocks = |n: u32| n.div_ceil(block) as f32;
        // From the right: boxes and counts of everything at or past each bin.
        let mut right = [(Box4::EMPTY, 0u32); BINS];
        let mut sum = (Box4::EMPTY, 0);
        for bin in (1..bins.count).rev() {
            sum = (sum.0.union(h.boxes[bin][axis]), sum.1 + h.counts[bin][axis]);
            right[bin] = sum;
        }
        let mut best: Option<Split> = None;
        let mut left = (Box4::EMPTY, 0);
        for border in 1..bins.count {
            left = (left.0.union(h.boxes[border - 1][axis]), left.1 + h.counts[border - 1][axis]);
            let (right, n_right) = right[border];
            if left.1 == 0 || n_right == 0 {
                continue;
            }
            let cost = left.0.half_area() * blocks(left.1) + right.half_area() * blocks(n_right);
            if best.is_none_or(|b| cost < b.cost) {
                let sides = [left.0, right];
                best = Some(Split { bins: *bins, axis, border, cost, sides, left: left.1 as usize });
            }
        }
        best
    }

    #[inline(always)]
    fn is_left(&self, prim: &Prim) -> bool {
        self.bins.of(prim)[self.axis] < self.border
    }

    /// Moves the left side of `prims` to the front.
    pub(super) fn part(&self, prims: &mut [Prim]) {
        let mut left = 0;
        for i in 0..prims.len() {
            // Without a branch: which side comes next cannot be predicted.
            let is_left = self.is_left(&prims[i]);
            prims.swap(i, left);
            left += usize::from(is_left);
        }
    }

    /// Like [`Split::part`], but from `prims` into `out` and by several threads.
    pub(super) fn part_into(&self, prims: &[Prim], out: &mut [Prim]) {
        let pieces: Vec<_> =
            prims.par_chunks(PARALLEL).map(|p| (p, p.iter().filter(|p| self.is_left(p)).count())).collect();
        let (mut lefts, mut rights) = out.split_at_mut(self.left);
        let mut work = Vec::with_capacity(pieces.len());
        for (piece, n_left) in pieces {
            let (left, more_left) = lefts.split_at_mut(n_left);
            let (right, more_right) = rights.split_at_mut(piece.len() - n_left);
            (lefts, rights) = (more_left, more_right);
            work.push((piece, left, right));
        }
        work.into_par_iter().for_each(|(piece, left, right)| {
            let (mut left, mut right) = (left.iter_mut(), right.iter_mut());
            for prim in piece {
                let place = if self.is_left(prim) { left.next() } else { right.next() };
                if let Some(place) = place {
                    *place = *prim;
                }
            }
        });
    }
}

/// The box around twice the centres.
fn centers(prims: &[Prim]) -> Box4 {
    let around = |prims: &[Prim]| prims.iter().fold(Box4::EMPTY, |b, p| b.grown(p.center2()));
    if prims.len() < 2 * PARALLEL {
        return around(prims);
    }
    prims.par_chunks(PARALLEL).map(around).reduce(|| Box4::EMPTY, Box4::union)
}

/// The box around everything in `prims`.
pub(super) fn bounds(prims: &[Prim]) -> Box4 {
    let around = |prims: &[Prim]| prims.iter().fold(Box4::EMPTY, |b, p| b.union(p.bounds()));
    if prims.len() < 2 * PARALLEL {
        return around(prims);
    }
    prims.par_chunks(PARALLEL).map(around).reduce(|| Box4::EMPTY, Box4::union)
}
