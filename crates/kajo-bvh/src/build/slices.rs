//! What lies between planes across an axis, and where cutting a set costs least.
//!
//! Planes divide the box of a set into slices of the same width. The box of a slice is that around
//! the parts of triangles in it. A triangle stands before a plane if its first slice does, and behind
//! a plane if its last slice does [Stich, Friedrich and Dietrich 2009, sec. 4.2].

use kajo_math::Vec3;
use rayon::prelude::*;

use super::cut::cut;
use super::prim::{BLOCK, Box4, Prim};

/// Most slices on an axis.
const MOST: usize = 32;

/// A plane at which to cut a set.
#[derive(Debug)]
pub(super) struct Cutting {
    pub(super) axis: usize,
    pub(super) plane: f32,
    /// The sum of surface times primitives on both sides.
    pub(super) cost: f32,
    /// The boxes around what lies before and behind the plane, by slices.
    pub(super) sides: [Box4; 2],
    /// Primitives on either side.
    pub(super) counts: [usize; 2],
}

/// Where the slices are.
struct Planes {
    count: usize,
    lo: [f32; 3],
    hi: [f32; 3],
    scale: [f32; 3],
}

/// The slices of one axis.
#[derive(Clone, Copy)]
struct Slices {
    boxes: [Box4; MOST],
    /// Primitives whose first and whose last slice it is.
    firsts: [u32; MOST],
    lasts: [u32; MOST],
}

impl Planes {
    /// Fewer slices for small sets, whose primitives would reach into many.
    fn new(bounds: Box4, len: usize) -> Planes {
        let count = match len {
            0..512 => 8,
            512..4096 => 16,
            _ => MOST,
        };
        let (lo, hi) = (bounds.lo.truncate().to_array(), bounds.hi.truncate().to_array());
        let scale = [0, 1, 2].map(|axis| count as f32 / (hi[axis] - lo[axis]));
        // An axis without extent has no slices; nor has one that is too long for numbers.
        let scale = scale.map(|scale| if scale.is_finite() { scale } else { 0.0 });
        Planes { count, lo, hi, scale }
    }

    /// The slice of a coordinate. Where rounding takes the one beside, boxes are a little wrong,
    /// and so is an estimate.
    fn slice(&self, axis: usize, x: f32) -> usize {
        (((x - self.lo[axis]) * self.scale[axis]) as usize).min(self.count - 1)
    }

    /// The plane before a slice, if it lies within the box.
    fn plane(&self, axis: usize, slice: usize) -> Option<f32> {
        let (lo, hi) = (self.lo[axis], self.hi[axis]);
        let share = slice as f64 / self.count as f64;
        let plane = (f64::from(lo) + (f64::from(hi) - f64::from(lo)) * share) as f32;
        Some(plane).filter(|&plane| lo < plane && plane < hi)
    }
}

impl Slices {
    const EMPTY: Slices = Slices { boxes: [Box4::EMPTY; MOST], firsts: [0; MOST], lasts: [0; MOST] };

    /// The slices of all axes.
    fn of(prims: &[Prim], planes: &Planes, corners: &impl Fn(u32) -> [Vec3; 3]) -> [Slices; 3] {
        let mut all = [Slices::EMPTY; 3];
        for prim in prims {
            let bounds = prim.bounds();
            for (axis, slices) in all.iter_mut().enumerate() {
                let slice = |x: f32| planes.slice(axis, x);
                let (first, last) = (slice(bounds.lo[axis]), slice(bounds.hi[axis]));
                slices.firsts[first] += 1;
                slices.lasts[last] += 1;
                let mut rest = Some(bounds);
                for i in first..last {
                    let (Some(part), Some(plane)) = (rest, planes.plane(axis, i + 1)) else { break };
                    let [before, behind] = cut(corners(prim.id()), part, axis, plane);
                    slices.boxes[i] = before.map_or(slices.boxes[i], |before| slices.boxes[i].union(before));
                    rest = behind;
                }
                slices.boxes[last] = rest.map_or(slices.boxes[last], |rest| slices.boxes[last].union(rest));
            }
        }
        all
    }

    fn and(mut self, other: &Slices) -> Slices {
        for i in 0..MOST {
            self.boxes[i] = self.boxes[i].union(other.boxes[i]);
            self.firsts[i] += other.firsts[i];
            self.lasts[i] += other.lasts[i];
        }
        self
    }
}

impl Cutting {
    /// The cheapest plane that cuts at most `spare` of `prims` and leaves fewer of them on
    /// either side.
    pub(super) fn best(
        prims: &[Prim],
        bounds: Box4,
        spare: usize,
        corners: &(impl Fn(u32) -> [Vec3; 3] + Sync),
    ) -> Option<Cutting> {
        let planes = Planes::new(bounds, prims.len());
        let of = |prims: &[Prim]| Slices::of(prims, &planes, corners);
        let all = if prims.len() < 2 * BLOCK {
            of(prims)
        } else {
            let and = |a: [Slices; 3], b: [Slices; 3]| [0, 1, 2].map(|axis| a[axis].and(&b[axis]));
            prims.par_chunks(BLOCK).map(of).reduce(|| [Slices::EMPTY; 3], and)
        };
        let mut best: Option<Cutting> = None;
        for (axis, slices) in all.iter().enumerate() {
            let mut behind = [(Box4::EMPTY, 0); MOST];
            let mut sum = (Box4::EMPTY, 0);
            for i in (1..planes.count).rev() {
                sum = (sum.0.union(slices.boxes[i]), sum.1 + slices.lasts[i] as usize);
                behind[i] = sum;
            }
            let mut sum = (Box4::EMPTY, 0);
            for (i, &(box_behind, n_behind)) in behind.iter().enumerate().take(planes.count).skip(1) {
                sum = (sum.0.union(slices.boxes[i - 1]), sum.1 + slices.firsts[i - 1] as usize);
                let (sides, counts) = ([sum.0, box_behind], [sum.1, n_behind]);
                let Some(plane) = planes.plane(axis, i) else { continue };
                let is_allowed = counts.iter().all(|&n| n > 0 && n < prims.len())
                    && counts[0] + counts[1] - prims.len() <= spare;
                let cost = cost(sides, counts);
                if is_allowed && best.as_ref().is_none_or(|best| cost < best.cost) {
                    best = Some(Cutting { axis, plane, cost, sides, counts });
                }
            }
        }
        best
    }
}

/// The sum of surface times primitives on both sides.
pub(super) fn cost(sides: [Box4; 2], counts: [usize; 2]) -> f32 {
    sides[0].half_area() * counts[0] as f32 + sides[1].half_area() * counts[1] as f32
}
