//! The parts of a box in which a function may be zero.

use std::ops::Index;

use kajo_math::interval::{Domain, Interval};
use kajo_math::tape::{Curvature, Dual, Tape};
use kajo_math::{Aabb, DVec3};

use super::{Ray64, box_faces};
use crate::shape::box_faces::down;

/// The box is halved along each axis at most this often.
const MOST_LEVELS: u32 = 9;

/// And at least this often where there may be a surface, so that rays that miss it meet few cells.
const FEWEST_LEVELS: u32 = 4;

/// No more halving once there are as many cells.
const ENOUGH_CELLS: usize = 12_000;

/// Cells that no other touches but at its faces.
#[derive(Debug)]
pub(super) struct Cells {
    /// Along each axis, the planes between the smallest cells there could be.
    planes: [Vec<f64>; 3],
    cells: Vec<Cell>,
    fills_faces: bool,
}

/// A cell, and bounds on the gradient of the function in it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cell {
    /// The planes at its lower corner, and how many farther those at the upper one are.
    low: [u16; 3],
    size: u16,
    slopes: [[f32; 2]; 3],
    /// Bound on the norm of the second derivatives.
    curvature: f32,
}

impl Cell {
    /// Bounds on the change of the function along a direction.
    #[inline]
    pub fn slope_along(&self, d: DVec3) -> [f64; 2] {
        /// More than the roundings of three products and their sum.
        const ROUNDING: f64 = 8.0 * f64::EPSILON;
        let (mut lo, mut hi, mut size) = (0.0, 0.0, 0.0);
        for axis in 0..3 {
            let d = d[axis];
            // Bounds may be infinite.
            if d != 0.0 {
                let [a, b] = self.slopes[axis].map(|slope| f64::from(slope) * d);
                lo += a.min(b);
                hi += a.max(b);
                size += a.abs().max(b.abs());
            }
        }
        [lo - ROUNDING * size, hi + ROUNDING * size]
    }

    /// Bound on the second derivative along a direction; infinite where nothing is known.
    pub fn curvature_along(&self, d: DVec3) -> f64 {
        f64::from(self.curvature) * d.length_squared()
    }
}

/// What is known of a function in a part of the box.
enum Known {
    Outside,
    Inside,
    /// It may be zero; with bounds on its gradient.
    Mixed([Interval; 3]),
}

impl Cells {
    /// The cells of a box in which a function may be zero.
    pub fn of(function: &Tape, [low, high]: [DVec3; 2]) -> Cells {
        let n = 1_u16 << MOST_LEVELS;
        let planes = [0, 1, 2].map(|axis| {
            let plane = |k: u16| {
                let t = f64::from(k) / f64::from(n);
                if k == n { high[axis] } else { low[axis] + t * (high[axis] - low[axis]) }
            };
            (0..=n).map(plane).collect::<Vec<f64>>()
        });
        let mut found = Cells { planes, cells: Vec::new(), fills_faces: false };
        let mut search = Search { function, values: Vec::new(), slopes: Vec::new(), curvatures: Vec::new() };
        let mut level = vec![Cell { low: [0; 3], size: n, slopes: [[0.0; 2]; 3], curvature: 0.0 }];
        while !level.is_empty() {
            let mut kept = Vec::new();
            for cell in level {
                let touches = cell.low.iter().any(|&k| k == 0 || k + cell.size == n);
                match search.known(found.ranges(&cell)) {
                    Known::Outside => {}
                    Known::Inside => found.fills_faces |= touches,
                    Known::Mixed(slopes) => {
                        found.fills_faces |= touches;
                        let is_done = cell.size <= n >> FEWEST_LEVELS && is_almost_flat(&slopes);
                        let slopes = slopes.map(|slope| [down(slope.lo), -down(-slope.hi)]);
                        let cell = Cell { slopes, ..cell };
                        if is_done { found.cells.push(cell) } else { kept.push(cell) }
                    }
                }
            }
            let size = kept.first().map_or(1, |cell| cell.size);
            if size == 1 || found.cells.len() + kept.len() >= ENOUGH_CELLS {
                found.cells.append(&mut kept);
            }
            level = kept.iter().flat_map(|cell| (0..8_u16).map(|i| cell.octant(i, size / 2))).collect();
        }
        let ranges: Vec<[Interval; 3]> = found.cells.iter().map(|cell| found.ranges(cell)).collect();
        for (cell, ranges) in found.cells.iter_mut().zip(ranges) {
            cell.curvature = search.curvature(ranges);
        }
        found
    }

    /// The corners of the box.
    pub fn corners(&self) -> [DVec3; 2] {
        let end = |plane: fn(&[f64]) -> Option<&f64>| {
            DVec3::from_array([0, 1, 2].map(|axis| plane(&self.planes[axis]).copied().unwrap_or(0.0)))
        };
        [end(<[f64]>::first), end(<[f64]>::last)]
    }

    /// Whether some of the inside may be at a face of the box.
    pub fn fills_faces(&self) -> bool {
        self.fills_faces
    }

    pub fn iter(&self) -> impl Iterator<Item = &Cell> {
        self.cells.iter()
    }

    fn ends(&self, cell: &Cell, axis: usize) -> [f64; 2] {
        let low = cell.low[axis];
        [low, low + cell.size].map(|k| self.planes[axis][usize::from(k)])
    }

    /// What coordinates a point of a cell may have, with the rounding of points that are worked out along rays from far away.
    fn ranges(&self, cell: &Cell) -> [Interval; 3] {
        const ROUNDING: f64 = 1e-10;
        let [low, high] = self.corners();
        let margin = ROUNDING * low.abs().max(high.abs()).max_element();
        [0, 1, 2].map(|axis| {
            let [lo, hi] = self.ends(cell, axis);
            Interval::new(lo - margin, hi + margin)
        })
    }

    /// A box of single precision around a cell.
    pub fn bounds(&self, cell: &Cell) -> Aabb {
        let ends = [0, 1, 2].map(|axis| self.ends(cell, axis));
        box_faces::around([0, 1].map(|i| DVec3::from_array(ends.map(|ends| ends[i]))))
    }

    /// The piece of a line in a cell and in a range of parameters; none where it has no length.
    ///
    /// Planes that cells share give both the same parameter.
    #[inline]
    pub fn clip(&self, cell: &Cell, line: &Ray64, range: [f64; 2]) -> Option<[f64; 2]> {
        box_faces::clip(|axis| self.ends(cell, axis), line, range)
    }

    pub fn heap_bytes(&self) -> usize {
        size_of_val(&*self.cells) + self.planes.iter().map(|planes| size_of_val(&**planes)).sum::<usize>()
    }
}

impl Index<u32> for Cells {
    type Output = Cell;

    #[inline]
    fn index(&self, index: u32) -> &Cell {
        &self.cells[index as usize]
    }
}

impl Cell {
    /// The part of a cell in one of its corners, which is half as large.
    fn octant(&self, i: u16, half: u16) -> Cell {
        let low = [0, 1, 2].map(|axis| self.low[axis] + (i >> axis & 1) * half);
        Cell { low, size: half, ..*self }
    }
}

/// Evaluates a function over boxes.
struct Search<'a> {
    function: &'a Tape,
    values: Vec<Interval>,
    slopes: Vec<Dual<Interval, 3>>,
    curvatures: Vec<Curvature>,
}

impl Search<'_> {
    /// Bound on the norm of the second derivatives; infinite where the function has no value somewhere.
    fn curvature(&mut self, ranges: [Interval; 3]) -> f32 {
        let found = self.function.at(&ranges.map(Curvature::variable), &mut self.curvatures);
        let known = found.value.domain == Domain::Everywhere;
        if known { -down(-found.curvature) } else { f32::INFINITY }
    }

    fn known(&mut self, ranges: [Interval; 3]) -> Known {
        let value = self.function.at(&ranges, &mut self.values);
        if let Some(known) = one_sign(value) {
            return known;
        }
        let one = |axis: usize, k: usize| Interval::point(f64::from(u8::from(axis == k)));
        let duals =
            [0, 1, 2].map(|axis| Dual { value: ranges[axis], slopes: std::array::from_fn(|k| one(axis, k)) });
        let found = self.function.at(&duals, &mut self.slopes);
        // The mean value theorem, around the middle.
        let middle = ranges.map(|range| Interval::point(range.middle()));
        let at_middle = self.function.at(&middle, &mut self.values);
        let mean =
            (0..3).fold(at_middle, |sum, axis| sum + found.slopes[axis] * (ranges[axis] - middle[axis]));
        if value.domain != Domain::Everywhere {
            // At the border of where it has values it jumps.
            return Known::Mixed([Interval::EVERYTHING; 3]);
        }
        one_sign(value.intersection(mean)).unwrap_or(Known::Mixed(found.slopes))
    }
}

/// Whether the surface bends so little in a cell that the sign of the slope is known for most rays.
fn is_almost_flat(slopes: &[Interval; 3]) -> bool {
    let middle = slopes.iter().map(|slope| slope.middle().powi(2)).sum::<f64>();
    let spread = slopes.iter().map(|slope| (0.5 * (slope.hi - slope.lo)).powi(2)).sum::<f64>();
    4.0 * spread <= middle
}

/// On which side of the surface all places are with these values.
fn one_sign(value: Interval) -> Option<Known> {
    if value.domain == Domain::Nowhere || value.lo >= 0.0 {
        return Some(Known::Outside);
    }
    (value.hi < 0.0 && value.domain == Domain::Everywhere).then_some(Known::Inside)
}
