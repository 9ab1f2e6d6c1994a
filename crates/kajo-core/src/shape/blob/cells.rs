//! The parts of space that the surface of a blob may pass, each with the components whose support overlaps it.
//!
//! The box of a blob is halved again and again. Bounds on its components within a part show where the field is below the threshold,
//! or above it, everywhere; the other parts stay. A ray is tested against those that it passes, from the nearest on.
//!
//! The field at a point depends on nothing else, to the bit: components whose support does not hold it add zero, and the others are added
//! in one order in all parts. So neighbors agree on the value between them.

use kajo_bvh::{BuildSettings, Bvh};
use kajo_math::{Aabb, DVec3, Ray};

use super::cell::Cell;
use super::field::{BlobKernel, Term};
use crate::shape::Ray64;

/// Parts are halved until there are as many, and so many more for each component.
const FEWEST_CELLS: usize = 64;
const CELLS_OF_A_TERM: usize = 8;

/// Components that the lists of all parts name, for each component, beyond which nothing is halved: where all reach into all parts,
/// lists get long.
const MENTIONS_OF_A_TERM: usize = 512;

/// Parts are halved at most this often: of a surface that is hardly there they do not become many.
const MOST_HALVINGS: u32 = 27;

/// How far around its cell a list of components holds, in parts of the largest coordinate: hits are rounded to single precision.
const MARGIN: f64 = 1e-5;

/// The parts of a blob's box that its surface may pass.
#[derive(Debug)]
pub(super) struct SurfaceCells {
    lists: CellLists,
    tree: Bvh,
    /// How far around its cell a list of components holds.
    margin: f64,
}

/// Parts of the box, and the components of each in one list.
#[derive(Debug, Default)]
struct CellLists {
    cells: Vec<ListedCell>,
    members: Vec<u32>,
}

#[derive(Debug)]
struct ListedCell {
    cell: Cell,
    /// The range of its components in the list.
    members: [u32; 2],
}

/// A piece of a ray in a cell.
#[derive(Clone, Copy)]
pub(super) struct CellSpan {
    /// From and to: parameters of the ray.
    pub piece: [f64; 2],
    /// The number of the cell.
    pub cell: u32,
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

impl CellLists {
    /// The components of a cell, in ascending order.
    #[inline]
    fn members(&self, cell: &ListedCell) -> &[u32] {
        let [first, last] = cell.members.map(|i| i as usize);
        &self.members[first..last]
    }
}

/// What parts of a box are looked for.
struct Search<'a> {
    kernel: BlobKernel,
    terms: &'a [Term],
    /// Below the first no place is of the surface, nor above the second.
    thresholds: [f64; 2],
    margin: f64,
}

impl Search<'_> {
    /// Adds a cell to those found, if the surface may pass it.
    fn keep(&self, cell: Cell, members: &[u32], found: &mut CellLists) {
        let wider = cell.padded(self.margin);
        let (mut least, mut most) = (0.0, 0.0);
        let from = found.members.len();
        for &i in members {
            if let Some(range) = self.terms[i as usize].range_in(self.kernel, &wider) {
                (least, most) = (least + range.lo, most + range.hi);
                found.members.push(i);
            }
        }
        if most < self.thresholds[0] || least > self.thresholds[1] {
            return found.members.truncate(from);
        }
        let members = [from, found.members.len()].map(|i| i as u32);
        found.cells.push(ListedCell { cell, members });
    }
}

impl SurfaceCells {
    /// `None` where the box is not finite.
    ///
    /// * `thresholds`: the surface is where the field is between these: the threshold, less and more the rounding of sums of all terms
    /// * `within`: a box that holds the surface
    pub fn new(
        kernel: BlobKernel,
        terms: &[Term],
        thresholds: [f64; 2],
        within: Aabb,
    ) -> Option<SurfaceCells> {
        within.is_finite().then_some(())?;
        let (min, max) = (within.min.as_dvec3(), within.max.as_dvec3());
        let margin = MARGIN * min.abs().max(max.abs()).max_element();
        let search = Search { kernel, terms, thresholds, margin };
        let all: Vec<u32> = (0..terms.len() as u32).collect();
        let mut lists = CellLists::default();
        search.keep(Cell { min, max }, &all, &mut lists);
        let enough = FEWEST_CELLS + CELLS_OF_A_TERM * terms.len();
        for _ in 0..MOST_HALVINGS {
            if lists.cells.is_empty() || lists.cells.len() >= enough {
                break;
            }
            let mut halved = CellLists::default();
            for cell in &lists.cells {
                let halves = cell.cell.joined_halves();
                halves.into_iter().for_each(|half| search.keep(half, lists.members(cell), &mut halved));
            }
            if halved.members.len() > MENTIONS_OF_A_TERM * terms.len() {
                break;
            }
            lists = halved;
        }
        let boxes: Vec<Aabb> = lists.cells.iter().map(|cell| cell.cell.bounds()).collect();
        let tree = Bvh::build(&boxes, &BuildSettings::default());
        Some(SurfaceCells { lists, tree, margin })
    }

    /// The components whose support overlaps the surroundings of a cell; `None` where that of others may too, and for a number that is no cell's.
    #[inline]
    pub fn members_near(&self, cell: u32, p: DVec3) -> Option<&[u32]> {
        let cell = self.lists.cells.get(cell as usize)?;
        cell.cell.padded(self.margin).contains(p).then(|| self.lists.members(cell))
    }

    /// The nearest crossing within a ray's range, and the number of its cell.
    ///
    /// * `first_in`: the first crossing on a piece of the ray in a cell with these components
    #[inline(always)]
    pub fn nearest(
        &self,
        ray: &Ray,
        mut first_in: impl FnMut(&[u32], &Ray64, [f64; 2]) -> Option<f32>,
    ) -> Option<(f32, u32)> {
        let line = Line::new(ray);
        let mut nearest = None;
        self.tree.closest(ray, |index, far| {
            let cell = &self.lists.cells[index as usize];
            let piece = cell.cell.clip(&line.ray, line.inverse, [ray.t_min.into(), far.into()]);
            let found = piece.and_then(|piece| first_in(self.lists.members(cell), &line.ray, piece));
            let Some(t) = found.filter(|t| *t < far) else { return far };
            nearest = Some((t, index));
            t
        });
        nearest
    }

    /// Whether there is a crossing within a ray's range.
    ///
    /// * `is_in`: whether there is one on a piece of the ray in a cell with these components
    #[inline(always)]
    pub fn any(&self, ray: &Ray, mut is_in: impl FnMut(&[u32], &Ray64, [f64; 2]) -> bool) -> bool {
        let line = Line::new(ray);
        self.tree.any(ray, |index| {
            let cell = &self.lists.cells[index as usize];
            let piece = cell.cell.clip(&line.ray, line.inverse, [ray.t_min.into(), ray.t_max.into()]);
            piece.is_some_and(|piece| is_in(self.lists.members(cell), &line.ray, piece))
        })
    }

    /// Visits the pieces of a ray in cells in ascending order, until `visit` says that it is enough.
    ///
    /// * `pieces`: memory
    /// * `visit`: gets the components of the cell, the ray and the piece
    pub fn each(
        &self,
        ray: &Ray,
        pieces: &mut Vec<CellSpan>,
        mut visit: impl FnMut(&[u32], &Ray64, [f64; 2]) -> bool,
    ) {
        let line = Line::new(ray);
        pieces.clear();
        let range = [f64::from(ray.t_min), f64::from(ray.t_max)];
        self.tree.each(ray, |cell| {
            let piece = self.lists.cells[cell as usize].cell.clip(&line.ray, line.inverse, range);
            pieces.extend(piece.map(|piece| CellSpan { piece, cell }));
        });
        pieces.sort_unstable_by(|a, b| a.piece[0].total_cmp(&b.piece[0]));
        for &CellSpan { piece, cell } in &*pieces {
            if visit(self.lists.members(&self.lists.cells[cell as usize]), &line.ray, piece) {
                return;
            }
        }
    }

    pub fn heap_bytes(&self) -> usize {
        size_of_val(&*self.lists.cells) + size_of_val(&*self.lists.members) + self.tree.stats().bytes
    }
}
