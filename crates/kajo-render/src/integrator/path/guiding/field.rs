//! Where light comes from, by place: a tree over the box of the scene for each side that a surface may face, whose leaves are cells
//! with a [tree of directions](super::quadtree).

use kajo_math::{Aabb, Vec3};

use super::quadtree::Node;

/// Sides that a surface may face: both ends of three axes.
pub const SIDES: usize = 6;

/// Marks links to cells among those to branches.
const CELL: u32 = 1 << 31;

/// How often a box is halved at most.
pub const MOST_HALVINGS: u32 = 36;

/// What is known of the light that comes to a place.
#[derive(Clone, Copy, Debug)]
pub struct Cell {
    /// Its density of directions; none as long as nothing has been learned.
    pub guide: Option<u32>,
    /// The share of directions that are drawn by scattering.
    pub share: f32,
    /// Mean radiance that surfaces there send back of light that was scattered before, as the sum of its lanes.
    pub light: f32,
    /// The same of light that no surface has scattered before.
    pub direct: f32,
    /// What the guide was made of.
    pub known: Known,
}

/// Sums over records, those of earlier passes with a smaller weight.
#[derive(Clone, Copy, Debug, Default)]
pub struct Known {
    /// How many there are.
    pub records: f64,
    /// Of the light that the places were connected with.
    pub direct: f64,
    /// Of the light that was scattered before.
    pub x: f64,
    /// Of its square.
    pub squares: f64,
    /// Of the light that came from directions of the tree.
    pub energy: f64,
    /// Number of photons recorded there.
    pub photons: f32,
}

impl Known {
    /// How many records of equal light would be as good [Kish 1965].
    pub fn effective(&self) -> f32 {
        if self.squares > 0.0 { (self.x * self.x / self.squares) as f32 } else { 0.0 }
    }

    /// What half of the records have.
    fn half(self) -> Known {
        Known {
            records: 0.5 * self.records,
            direct: 0.5 * self.direct,
            x: 0.5 * self.x,
            squares: 0.5 * self.squares,
            energy: 0.5 * self.energy,
            photons: 0.5 * self.photons,
        }
    }
}

/// A box in two halves.
#[derive(Clone, Copy, Debug)]
struct Branch {
    axis: u8,
    /// Where it is divided.
    at: f32,
    below: u32,
    above: u32,
}

/// Cells, to be found by place and normal.
#[derive(Clone, Debug)]
pub struct Field {
    bounds: Aabb,
    roots: [u32; SIDES],
    branches: Vec<Branch>,
    pub cells: Vec<Cell>,
    /// The trees of directions that are drawn by.
    pub nodes: Vec<Node>,
    /// The same trees with the shares of what paths have found, and nothing else.
    pub found: Vec<Node>,
}

impl Field {
    /// One cell for each side, of which nothing is known.
    pub fn new(bounds: Aabb) -> Field {
        let cell = Cell { guide: None, share: 1.0, light: 0.0, direct: 0.0, known: Known::default() };
        Field {
            bounds,
            roots: [0, 1, 2, 3, 4, 5].map(|i| CELL | i),
            branches: Vec::new(),
            cells: vec![cell; SIDES],
            nodes: Vec::new(),
            found: Vec::new(),
        }
    }

    /// The cell of a place. What lies outside of the box belongs to the cells at its border.
    ///
    /// * `n`: unit normal
    #[inline]
    pub fn cell(&self, p: Vec3, n: Vec3) -> u32 {
        let mut at = self.roots[side(n)];
        while at & CELL == 0 {
            let branch = &self.branches[at as usize];
            at = if p[usize::from(branch.axis)] < branch.at { branch.below } else { branch.above };
        }
        at & !CELL
    }

    /// Halves cells until each has few enough records of light, one after the other in the order of the tree.
    ///
    /// * `counts`: what each cell has had
    /// * `most`: how much a cell may have; halves are taken to have half of it
    /// * `split`: called with the new cell that gets a half of an old one; `false` when there is no room for it
    pub fn divide(&mut self, counts: &[f32], most: f32, mut split: impl FnMut(u32) -> bool) {
        for root in 0..SIDES {
            // What remains to be looked at: which link leads there, its box, the records in it.
            let mut rest = vec![(Where::Root(root), self.bounds, None, 0)];
            while let Some((from, bounds, count, halvings)) = rest.pop() {
                let link = self.link(from);
                let axis = longest_axis(&bounds);
                let at = bounds.center()[axis];
                let (mut below, mut above) = (bounds, bounds);
                (below.max[axis], above.min[axis]) = (at, at);
                let halvings = halvings + 1;
                let count = if link & CELL == 0 {
                    None
                } else {
                    let cell = link & !CELL;
                    let count = count.unwrap_or_else(|| counts[cell as usize]);
                    let is_divisible = bounds.min[axis] < at && at < bounds.max[axis];
                    if count <= most || halvings > MOST_HALVINGS || !is_divisible || !split(cell) {
                        continue;
                    }
                    let other = self.cells.len() as u32;
                    let half =
                        Cell { known: self.cells[cell as usize].known.half(), ..self.cells[cell as usize] };
                    self.cells[cell as usize] = half;
                    self.cells.push(half);
                    let branch = Branch { axis: axis as u8, at, below: link, above: CELL | other };
                    self.branches.push(branch);
                    self.relink(from, self.branches.len() as u32 - 1);
                    Some(0.5 * count)
                };
                let branch = self.link(from);
                rest.push((Where::Above(branch), above, count, halvings));
                rest.push((Where::Below(branch), below, count, halvings));
            }
        }
    }

    /// The side of each cell.
    pub fn sides(&self) -> Vec<usize> {
        let mut sides = vec![0; self.cells.len()];
        for (side, &root) in self.roots.iter().enumerate() {
            let mut rest = vec![root];
            while let Some(link) = rest.pop() {
                if link & CELL == 0 {
                    let branch = &self.branches[link as usize];
                    rest.extend([branch.below, branch.above]);
                } else {
                    sides[(link & !CELL) as usize] = side;
                }
            }
        }
        sides
    }

    fn link(&self, from: Where) -> u32 {
        match from {
            Where::Root(i) => self.roots[i],
            Where::Below(i) => self.branches[i as usize].below,
            Where::Above(i) => self.branches[i as usize].above,
        }
    }

    fn relink(&mut self, from: Where, to: u32) {
        match from {
            Where::Root(i) => self.roots[i] = to,
            Where::Below(i) => self.branches[i as usize].below = to,
            Where::Above(i) => self.branches[i as usize].above = to,
        }
    }
}

/// Where a link is kept.
#[derive(Clone, Copy)]
enum Where {
    Root(usize),
    Below(u32),
    Above(u32),
}

/// The direction that a side faces.
pub fn axis_of(side: usize) -> Vec3 {
    let mut axis = Vec3::ZERO;
    axis[side / 2] = if side.is_multiple_of(2) { 1.0 } else { -1.0 };
    axis
}

/// The side that a surface faces: the axis that its normal is closest to, and the end of it.
#[inline]
fn side(n: Vec3) -> usize {
    let a = n.abs();
    let axis = if a.x >= a.y && a.x >= a.z {
        0
    } else if a.y >= a.z {
        1
    } else {
        2
    };
    2 * axis + usize::from(n[axis] < 0.0)
}

fn longest_axis(bounds: &Aabb) -> usize {
    let extent = bounds.extent();
    if extent.x >= extent.y && extent.x >= extent.z {
        0
    } else if extent.y >= extent.z {
        1
    } else {
        2
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn field() -> Field {
        Field::new(Aabb { min: Vec3::ZERO, max: Vec3::new(4.0, 2.0, 1.0) })
    }

    #[test]
    fn sides_are_told_by_the_longest_axis_of_the_normal() {
        let normals = [Vec3::X, -Vec3::X, Vec3::Y, -Vec3::Y, Vec3::Z, -Vec3::Z];
        for (i, n) in normals.into_iter().enumerate() {
            assert_eq!(side(n), i);
            assert_eq!(side((n + 0.3 * Vec3::ONE).normalize()), i);
            assert_eq!(field().cell(Vec3::ONE, n), i as u32);
        }
    }

    #[test]
    fn cells_are_halved_until_they_have_few_records() {
        let mut field = field();
        let mut told = Vec::new();
        field.divide(&[100.0, 10.0, 0.0, 0.0, 0.0, 0.0], 30.0, |cell| {
            told.push(cell);
            true
        });
        // 100 records are four cells of 25, along the longest axis each time.
        assert_eq!((field.cells.len(), told.len()), (9, 3));
        let cells: Vec<u32> =
            [0.5, 1.5, 2.5, 3.5].map(|x| field.cell(Vec3::new(x, 1.9, 0.1), Vec3::X)).to_vec();
        let mut different = cells.clone();
        different.sort_unstable();
        different.dedup();
        assert_eq!(different.len(), 4, "{cells:?}");
        assert_eq!(field.cell(Vec3::new(0.5, 0.1, 0.9), Vec3::X), cells[0]);
        assert_eq!(field.cell(Vec3::new(-7.0, 0.0, 0.0), Vec3::X), cells[0], "outside is at the border");
        assert_eq!(field.cell(Vec3::splat(f32::INFINITY), Vec3::X), cells[3]);
        assert_eq!(field.cell(Vec3::ONE, -Vec3::X), 1);
        // Where there is no room nothing changes, and where all is in one point it ends.
        field.divide(&[1000.0; 9], 1.0, |_| false);
        assert_eq!(field.cells.len(), 9);
        let mut point = Field::new(Aabb { min: Vec3::ONE, max: Vec3::ONE });
        point.divide(&[1000.0; SIDES], 1.0, |_| true);
        assert_eq!(point.cells.len(), SIDES);
    }

    #[test]
    fn counts_belong_to_the_cells_of_the_tree_that_was() {
        let mut field = field();
        field.divide(&[100.0, 0.0, 0.0, 0.0, 0.0, 0.0], 60.0, |_| true);
        assert_eq!(field.cells.len(), 7);
        // The new half alone is divided.
        field.divide(&[10.0, 0.0, 0.0, 0.0, 0.0, 0.0, 90.0], 60.0, |_| true);
        assert_eq!(field.cells.len(), 8);
        let at = |x: f32| field.cell(Vec3::new(x, 0.5, 0.5), Vec3::X);
        assert_eq!((at(0.5), at(1.5)), (0, 0));
        assert_ne!(at(2.5), at(3.5));
    }
}
