//! How far a blob reaches: a box and a ball around all points where the field may come up to the threshold.
//!
//! A box is halved again and again. What its components can say at most in a half, by the least and the largest distance from
//! their cores, decides whether it may hold a point of the blob; a half that would not add to what is found already is left.

use kajo_math::{Aabb, DVec3};

use super::cell::Cell;
use super::field::{BlobKernel, Term};

/// Boxes are halved this often: into 64 along each axis.
const HALVINGS: u32 = 18;

/// The components of a field and its threshold.
pub(super) struct Extent<'a> {
    pub kernel: BlobKernel,
    pub threshold: f64,
    pub terms: &'a [Term],
}

impl Extent<'_> {
    /// A box around the blob, which lies in the box `within`; empty where there is none.
    pub fn bounds(&self, within: Aabb) -> Aabb {
        let (mut min, mut max) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let middle = within.center().as_dvec3();
        self.visit(within, middle, &mut |cell, is_last| {
            let known = min.cmple(cell.min).all() && max.cmpge(cell.max).all();
            if is_last && !known {
                (min, max) = (min.min(cell.min), max.max(cell.max));
            }
            !known
        });
        if min.x > max.x {
            return Aabb::EMPTY;
        }
        Aabb { min: min.as_vec3(), max: max.as_vec3() }.padded(1e-6)
    }

    /// Radius of a ball around `center` that holds the blob, which lies in the box `within`.
    pub fn radius(&self, within: Aabb, center: DVec3) -> f64 {
        let mut most = 0.0;
        self.visit(within, center, &mut |cell, is_last| {
            let [_, far] = cell.distances2(center);
            let known = far <= most;
            if is_last && !known {
                most = far;
            }
            !known
        });
        most.sqrt() * (1.0 + 1e-6)
    }

    /// Visits the parts of a box that may hold a point of the blob, farther ones from `middle` first, with whether they are among the
    /// smallest; `visit` says whether to look into them.
    fn visit(&self, within: Aabb, middle: DVec3, visit: &mut dyn FnMut(&Cell, bool) -> bool) {
        if within.is_empty() || !within.is_finite() {
            return;
        }
        let all: Vec<u32> = (0..self.terms.len() as u32).collect();
        let cell = Cell { min: within.min.as_dvec3(), max: within.max.as_dvec3() };
        self.visit_cell(&cell, &all, HALVINGS, middle, visit);
    }

    fn visit_cell(
        &self,
        cell: &Cell,
        terms: &[u32],
        halvings: u32,
        middle: DVec3,
        visit: &mut dyn FnMut(&Cell, bool) -> bool,
    ) {
        let mut most = 0.0;
        let mut near = Vec::with_capacity(terms.len());
        for &i in terms {
            if let Some(range) = self.terms[i as usize].range_in(self.kernel, cell) {
                most += range.hi;
                near.push(i);
            }
        }
        // Rounding of the sum is far below this.
        if most < self.threshold * (1.0 - 1e-9) || !visit(cell, halvings == 0) || halvings == 0 {
            return;
        }
        let mut halves = cell.halves();
        let far = halves.map(|half| half.distances2(middle)[1]);
        if far[0] < far[1] {
            halves.swap(0, 1);
        }
        halves.iter().for_each(|half| self.visit_cell(half, &near, halvings - 1, middle, visit));
    }
}
