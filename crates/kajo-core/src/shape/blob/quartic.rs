//! Blobs of balls with POV-Ray's kernel: the parts of space that the surface may pass, and the quartic of a ray in each.
//!
//! The box of a blob is halved again and again. Bounds on what its balls say in a part tell where the field is below the threshold,
//! or above it, everywhere; the other parts stay, each with the balls that say anything there. A ray asks those that it passes. In one of
//! them `1 - u` of a ball is a quadratic along the ray, whose Bernstein coefficients are products of the places of both
//! ends, and its square a quartic; so is the sum, but where the border of a ball is passed, at which the piece is cut.
//!
//! What the field is at a place depends on nothing else, to the bit: balls that say nothing there add zero, and the others are added
//! in one order in all parts. So neighbours agree on the value between them.

use kajo_bvh::{BuildSettings, Bvh};
use kajo_math::roots::{quadratic, sign_changes_until};
use kajo_math::{Aabb, DVec3, Ray};

use super::cell::Cell;
use super::field::{BlobCore, Term};
use crate::shape::{Ray64, in_range};

/// Parts are halved until there are as many, and so many more for each ball.
const FEWEST_CELLS: usize = 64;
const CELLS_OF_A_BALL: usize = 8;

/// Balls that the lists of all parts name, for each ball, beyond which nothing is halved: where all reach into all parts, lists get long.
const MENTIONS_OF_A_BALL: usize = 512;

/// Parts are halved at most this often: of a surface that is hardly there they do not become many.
const MOST_HALVINGS: u32 = 27;

/// How far around its cell a list of balls holds, in parts of the largest coordinate: hits are rounded to single precision.
const MARGIN: f64 = 1e-5;

/// The parts of a blob's box that its surface may pass.
#[derive(Debug)]
pub(super) struct QuarticCells {
    threshold: f64,
    balls: Vec<QuarticComponent>,
    parts: Parts,
    tree: Bvh,
    /// How far around its cell a list of balls holds.
    margin: f64,
}

#[derive(Clone, Copy, Debug)]
struct QuarticComponent {
    center: DVec3,
    /// One over the squared radius.
    inverse2: f64,
    strength: f64,
}

#[derive(Debug)]
struct QuarticCell {
    cell: Cell,
    /// The range of its balls in the list.
    members: [u32; 2],
}

/// A ball's `1 - u` on a piece of a ray, by Bernstein coefficients.
type Quadratic = [f64; 3];

impl QuarticComponent {
    /// On the piece between two places.
    #[inline(always)]
    fn quadratic(&self, a: DVec3, b: DVec3) -> Quadratic {
        let (a, b) = (a - self.center, b - self.center);
        [a.dot(a), a.dot(b), b.dot(b)].map(|product| 1.0 - product * self.inverse2)
    }

    /// What it says at a place, and the gradient of that.
    #[inline]
    fn at(&self, p: DVec3) -> (f64, DVec3) {
        let w = p - self.center;
        let v = 1.0 - w.length_squared() * self.inverse2;
        if v <= 0.0 {
            return (0.0, DVec3::ZERO);
        }
        (self.strength * (v * v), 2.0 * self.strength * self.inverse2 * (-2.0 * v) * w)
    }

    /// Adds the square of a quadratic, times the strength.
    #[inline(always)]
    fn add_square(&self, [v0, v1, v2]: Quadratic, sum: &mut [f64; 5]) {
        let square = [v0 * v0, v0 * v1, (v0 * v2 + 2.0 * v1 * v1) / 3.0, v1 * v2, v2 * v2];
        sum.iter_mut().zip(square).for_each(|(sum, v)| *sum += self.strength * v);
    }

    /// The least and the most that it may say in a cell; `None` where that is nothing.
    fn range_in(&self, cell: &Cell) -> Option<[f64; 2]> {
        let [most, least] = cell.distances2(self.center).map(|d2| (1.0 - d2 * self.inverse2).max(0.0));
        let [a, b] = [least, most].map(|v| self.strength * v * v);
        (most > 0.0).then_some([a.min(b), a.max(b)])
    }
}

/// Memory for what is found in a cell.
#[derive(Default)]
pub(super) struct QuarticScratch {
    borders: Vec<f64>,
    /// Pieces of a ray in cells.
    pieces: Vec<([f64; 2], u32)>,
}

/// A ray, and one over its direction.
struct Line {
    ray: Ray64,
    inverse: DVec3,
}

impl Line {
    fn new(ray: &Ray) -> Line {
        let ray = Ray64::new(ray);
        Line { ray, inverse: ray.d.recip() }
    }
}

/// Parts of the box, and the balls of each in one list.
#[derive(Debug, Default)]
struct Parts {
    cells: Vec<QuarticCell>,
    members: Vec<u32>,
}

impl Parts {
    /// The balls of a cell, in ascending order.
    #[inline]
    fn members(&self, cell: &QuarticCell) -> &[u32] {
        let [first, last] = cell.members.map(|i| i as usize);
        &self.members[first..last]
    }
}

/// What parts of a box are looked for.
struct Search<'a> {
    balls: &'a [QuarticComponent],
    /// Below the first no place is of the surface, nor above the second.
    thresholds: [f64; 2],
    margin: f64,
}

impl Search<'_> {
    /// Adds a cell to those found, if the surface may pass it.
    fn keep(&self, cell: Cell, members: &[u32], found: &mut Parts) {
        let wider = cell.padded(self.margin);
        let (mut least, mut most) = (0.0, 0.0);
        let from = found.members.len();
        for &i in members {
            if let Some(range) = self.balls[i as usize].range_in(&wider) {
                (least, most) = (least + range[0], most + range[1]);
                found.members.push(i);
            }
        }
        if most < self.thresholds[0] || least > self.thresholds[1] {
            return found.members.truncate(from);
        }
        let members = [from, found.members.len()].map(|i| i as u32);
        found.cells.push(QuarticCell { cell, members });
    }
}

impl QuarticCells {
    /// `None` for terms that are not all balls, and where the box is not finite.
    ///
    /// * `within`: a box that holds the surface
    /// * `rounding`: more than that of sums of all terms
    pub fn new(terms: &[Term], threshold: f64, within: Aabb, rounding: f64) -> Option<QuarticCells> {
        let balls: Vec<QuarticComponent> = terms
            .iter()
            .filter_map(|term| match term.core() {
                BlobCore::Ball(center) => {
                    Some(QuarticComponent { center, inverse2: term.inverse2(), strength: term.strength() })
                }
                _ => None,
            })
            .collect();
        if balls.len() < terms.len() || !within.is_finite() {
            return None;
        }
        let (min, max) = (within.min.as_dvec3(), within.max.as_dvec3());
        let margin = MARGIN * min.abs().max(max.abs()).max_element();
        let search =
            Search { balls: &balls, thresholds: [threshold - rounding, threshold + rounding], margin };
        let all: Vec<u32> = (0..balls.len() as u32).collect();
        let mut parts = Parts::default();
        search.keep(Cell { min, max }, &all, &mut parts);
        let enough = FEWEST_CELLS + CELLS_OF_A_BALL * balls.len();
        for _ in 0..MOST_HALVINGS {
            if parts.cells.is_empty() || parts.cells.len() >= enough {
                break;
            }
            let mut halved = Parts::default();
            for cell in &parts.cells {
                let halves = cell.cell.joined_halves();
                halves.iter().for_each(|half| search.keep(*half, parts.members(cell), &mut halved));
            }
            if halved.members.len() > MENTIONS_OF_A_BALL * balls.len() {
                break;
            }
            parts = halved;
        }
        let boxes: Vec<Aabb> = parts.cells.iter().map(|cell| cell.cell.bounds()).collect();
        let tree = Bvh::build(&boxes, &BuildSettings::default());
        Some(QuarticCells { threshold, balls, parts, tree, margin })
    }

    /// The field less the threshold, and its gradient, at a place near a cell: by the cell's balls.
    ///
    /// `None` where others may say anything too, and for a number that is no cell's.
    #[inline]
    pub fn field_near(&self, cell: u32, p: DVec3) -> Option<(f64, DVec3)> {
        let cell = self.parts.cells.get(cell as usize)?;
        if !cell.cell.padded(self.margin).contains(p) {
            return None;
        }
        let (mut value, mut gradient) = (-self.threshold, DVec3::ZERO);
        for &i in self.parts.members(cell) {
            let (v, g) = self.balls[i as usize].at(p);
            value += v;
            gradient += g;
        }
        Some((value, gradient))
    }

    /// The nearest crossing within a ray's range, and the number of its cell.
    pub fn nearest(&self, ray: &Ray, scratch: &mut QuarticScratch) -> Option<(f32, u32)> {
        let line = Line::new(ray);
        let mut nearest = None;
        self.tree.closest(ray, |index, far| {
            let found = self.first_in(index, ray, &line, far, scratch);
            let Some(t) = found.filter(|t| *t < far) else { return far };
            nearest = Some((t, index));
            t
        });
        nearest
    }

    /// Whether there is a crossing within a ray's range.
    pub fn any(&self, ray: &Ray, scratch: &mut QuarticScratch) -> bool {
        let line = Line::new(ray);
        self.tree.any(ray, |index| self.first_in(index, ray, &line, ray.t_max, scratch).is_some())
    }

    /// The first crossing in a cell within a ray's range and up to `far`.
    #[inline(always)]
    fn first_in(
        &self,
        index: u32,
        ray: &Ray,
        line: &Line,
        far: f32,
        scratch: &mut QuarticScratch,
    ) -> Option<f32> {
        let cell = &self.parts.cells[index as usize];
        let piece = cell.cell.clip(&line.ray, line.inverse, [ray.t_min.into(), far.into()])?;
        let mut first = None;
        self.cross(cell, &line.ray, piece, scratch, &mut |t| {
            first = in_range(ray, t);
            first.is_some()
        });
        first
    }

    /// Visits all crossings within a ray's range, in ascending order, until `visit` says that it is enough.
    pub fn all(&self, ray: &Ray, scratch: &mut QuarticScratch, mut visit: impl FnMut(f64) -> bool) {
        let line = Line::new(ray);
        let mut pieces = std::mem::take(&mut scratch.pieces);
        pieces.clear();
        let range = [f64::from(ray.t_min), f64::from(ray.t_max)];
        self.tree.each(ray, |index| {
            let piece = self.parts.cells[index as usize].cell.clip(&line.ray, line.inverse, range);
            pieces.extend(piece.map(|piece| (piece, index)));
        });
        pieces.sort_unstable_by(|(a, _), (b, _)| a[0].total_cmp(&b[0]));
        for (piece, index) in &pieces {
            if self.cross(&self.parts.cells[*index as usize], &line.ray, *piece, scratch, &mut visit) {
                break;
            }
        }
        scratch.pieces = pieces;
    }

    /// Visits the crossings on a piece of a line in a cell, in ascending order, until `visit` says that it is enough;
    /// whether it did.
    #[inline(always)]
    fn cross(
        &self,
        cell: &QuarticCell,
        line: &Ray64,
        [from, to]: [f64; 2],
        scratch: &mut QuarticScratch,
        visit: &mut impl FnMut(f64) -> bool,
    ) -> bool {
        let members = self.parts.members(cell);
        let ends = [from, to].map(|t| line.at(t));
        // Where borders of balls are passed this is more than the field.
        let mut most = [-self.threshold; 5];
        let mut is_cut = false;
        for &i in members {
            let ball = &self.balls[i as usize];
            let v = ball.quadratic(ends[0], ends[1]);
            if v[0].max(v[1]).max(v[2]) <= 0.0 {
                continue;
            }
            let passes_border = v[0] < 0.0 || v[2] < 0.0;
            is_cut |= passes_border;
            if !passes_border || ball.strength > 0.0 {
                ball.add_square(v.map(|v| v.max(0.0)), &mut most);
            }
        }
        if most.iter().all(|&v| v < 0.0) {
            return false;
        }
        if !is_cut {
            return sign_changes_until(&most, |s| visit(from + s * (to - from)));
        }
        self.cross_cut(members, line, [from, to], scratch, visit)
    }

    /// The same where the borders of balls are passed.
    #[inline(never)]
    fn cross_cut(
        &self,
        members: &[u32],
        line: &Ray64,
        [from, to]: [f64; 2],
        scratch: &mut QuarticScratch,
        visit: &mut dyn FnMut(f64) -> bool,
    ) -> bool {
        let borders = &mut scratch.borders;
        borders.clear();
        let ends = [from, to].map(|t| line.at(t));
        for &i in members {
            let v = self.balls[i as usize].quadratic(ends[0], ends[1]);
            if v[0] >= 0.0 && v[2] >= 0.0 || v[0].max(v[1]).max(v[2]) <= 0.0 {
                continue;
            }
            let roots = quadratic(v[0] - 2.0 * v[1] + v[2], v[1] - v[0], v[0]);
            let roots = roots.into_iter().flat_map(|(a, b)| [a, b]).filter(|s| *s > 0.0 && *s < 1.0);
            borders.extend(roots.map(|s| from + s * (to - from)));
        }
        borders.push(to);
        borders.sort_unstable_by(f64::total_cmp);
        let (mut from, mut start) = (from, ends[0]);
        for &border in &*borders {
            let border = border.min(to);
            if border <= from {
                continue;
            }
            let end = line.at(border);
            let mut sum = [-self.threshold; 5];
            for &i in members {
                let ball = &self.balls[i as usize];
                let v = ball.quadratic(start, end);
                // What it says between borders it says in their middle.
                if v[0] + 2.0 * v[1] + v[2] > 0.0 {
                    ball.add_square(v.map(|v| v.max(0.0)), &mut sum);
                }
            }
            if sign_changes_until(&sum, |s| visit(from + s * (border - from))) {
                return true;
            }
            (from, start) = (border, end);
        }
        false
    }

    pub fn heap_bytes(&self) -> usize {
        size_of_val(&*self.balls)
            + size_of_val(&*self.parts.cells)
            + size_of_val(&*self.parts.members)
            + self.tree.stats().bytes
    }
}
