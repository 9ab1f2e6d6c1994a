//! A density that is bilinear between the nodes of a grid, such as the brightness of a picture, and drawing from it.
//!
//! Over a cell with the values `a b` above and `c d` below the density at the share `(s, t)` of it is in proportion to
//!
//! ```text
//! f(s, t) = (1 - t) ((1 - s) a + s b) + t ((1 - s) c + s d)
//! ```
//!
//! A point is drawn by a hierarchical warp of the unit square [McCool and Harwood 1997; Clarberg et al. 2005]: `y` says by the sums
//! of both halves whether the point is above or below, `x` then whether it is left or right, both are stretched to [0, 1) again,
//! and so on with the quarter down to a cell. In the cell `t` has a linear density and `s` for that `t` too, both inverted in
//! closed form [Pharr et al. 2023, 2.4.2]. All splits are along the axes, so that stratified numbers stay stratified: to draw a row
//! of the whole grid first and a cell of it then is one step, but it slides each row of cells along the next, and what was a
//! square of numbers becomes a long oblique strip wherever the densities of neighbouring rows differ.

use crate::Vec2;

/// A density over [0, 1)².
#[derive(Clone, Debug, PartialEq)]
pub struct Bilinear2D {
    /// Of cells.
    columns: usize,
    rows: usize,
    /// The density at the nodes, row by row.
    nodes: Vec<f32>,
    /// How blocks of cells are split, the coarsest first.
    levels: Vec<Level>,
    /// Height of the first and of the last row of cells, in that of the others.
    ends: f32,
}

/// Blocks of two times two smaller blocks, the smallest of which are cells.
#[derive(Clone, Debug, PartialEq)]
struct Level {
    /// Blocks in a row.
    across: usize,
    splits: Vec<Split>,
}

/// Probabilities of parts of a block. What lies beyond the border of the grid has none.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Split {
    above: f32,
    /// Of what is above.
    left_above: f32,
    /// Of what is below.
    left_below: f32,
}

impl Bilinear2D {
    /// The density in proportion to the values of nodes; `None` when they are not all finite and at least zero, or all zero.
    ///
    /// * `cells`: columns and rows of cells, at least one of each; of nodes there is one more of both, on the borders too
    /// * `ends`: height of the first and the last row of cells in that of the others; 1 where there is one row
    /// * `value`: by column and row, the first at x = 0 and y = 0
    pub fn new(cells: [usize; 2], ends: f32, value: impl Fn(usize, usize) -> f32) -> Option<Bilinear2D> {
        let [columns, rows] = cells;
        if columns == 0 || rows == 0 || (rows == 1 && ends != 1.0) {
            return None;
        }
        let mut nodes: Vec<f32> =
            (0..=rows).flat_map(|j| (0..=columns).map(move |i| (i, j))).map(|(i, j)| value(i, j)).collect();
        if nodes.iter().any(|v| !(v.is_finite() && *v >= 0.0)) {
            return None;
        }
        let height = |j: usize| if j == 0 || j + 1 == rows { f64::from(ends) } else { 1.0 };
        let mut sums = Sums { columns, rows, of: Vec::with_capacity(columns * rows) };
        for (j, row) in nodes.chunks(columns + 1).zip(nodes[columns + 1..].chunks(columns + 1)).enumerate() {
            let cell = |(above, below): (&[f32], &[f32])| -> f64 {
                above.iter().chain(below).map(|&v| f64::from(v)).sum()
            };
            sums.of.extend(row.0.windows(2).zip(row.1.windows(2)).map(|pair| 0.25 * height(j) * cell(pair)));
        }
        let mut levels = Vec::new();
        while sums.of.len() > 1 {
            let (level, coarser) = sums.halved();
            levels.push(level);
            sums = coarser;
        }
        levels.reverse();
        let (total, area) = (sums.of[0], columns as f64 * (0..rows).map(height).sum::<f64>());
        if total <= 0.0 {
            return None;
        }
        nodes.iter_mut().for_each(|v| *v = (f64::from(*v) * (area / total)) as f32);
        Some(Bilinear2D { columns, rows, nodes, levels, ends })
    }

    /// Bytes on the heap.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.nodes) + self.levels.iter().map(|level| size_of_val(&*level.splits)).sum::<usize>()
    }

    /// A point drawn with this density and the density there, per area of the unit square; 0 where a number at the end of its range
    /// is mapped to where the density begins.
    ///
    /// * `u`: uniform in [0, 1)²
    #[inline]
    pub fn sample(&self, mut u: Vec2) -> (Vec2, f32) {
        let (mut i, mut j) = (0, 0);
        for level in &self.levels {
            let split = level.splits[j * level.across + i];
            let (is_below, y) = halved(u.y, split.above);
            let (is_right, x) = halved(u.x, if is_below { split.left_below } else { split.left_above });
            (i, j, u) = (2 * i + usize::from(is_right), 2 * j + usize::from(is_below), Vec2::new(x, y));
        }
        let [a, b, c, d] = self.corners(i, j);
        let t = linear(u.y, a + b, c + d);
        let (left, right) = (lerp(a, c, t), lerp(b, d, t));
        let s = linear(u.x, left, right);
        let p = Vec2::new((i as f32 + s) / self.columns as f32, self.y_of(j, t));
        (p.min(Vec2::splat(BELOW_ONE)), lerp(left, right, s))
    }

    /// The density at `p`, and 0 outside of the unit square.
    #[inline]
    pub fn pdf(&self, p: Vec2) -> f32 {
        if !(p.cmpge(Vec2::ZERO).all() && p.cmplt(Vec2::ONE).all()) {
            return 0.0;
        }
        let (j, t) = self.row_at(p.y);
        let x = p.x * self.columns as f32;
        let i = (x as usize).min(self.columns - 1);
        let [a, b, c, d] = self.corners(i, j);
        lerp(lerp(a, c, t), lerp(b, d, t), x - i as f32)
    }

    /// The density at the corners of a cell: both above, then both below.
    #[inline]
    fn corners(&self, i: usize, j: usize) -> [f32; 4] {
        let above = j * (self.columns + 1) + i;
        let below = above + self.columns + 1;
        [self.nodes[above], self.nodes[above + 1], self.nodes[below], self.nodes[below + 1]]
    }

    /// The row of cells at `y`, and the share of it.
    #[inline]
    fn row_at(&self, y: f32) -> (usize, f32) {
        let last = self.rows - 1;
        let y = y * self.height() - self.ends;
        if y < 0.0 {
            return (0, 1.0 + y / self.ends);
        }
        let j = 1 + y as usize;
        if j < last { (j, y.fract()) } else { (last, ((y - (last as f32 - 1.0)) / self.ends).min(1.0)) }
    }

    /// The other way round.
    #[inline]
    fn y_of(&self, j: usize, t: f32) -> f32 {
        let t = if j == 0 || j + 1 == self.rows { self.ends * t } else { t };
        let before = if j == 0 { 0.0 } else { self.ends + (j as f32 - 1.0) };
        (before + t) / self.height()
    }

    /// Of all rows of cells together.
    #[inline]
    fn height(&self) -> f32 {
        self.rows as f32 - 2.0 + 2.0 * self.ends
    }
}

/// Integrals over blocks of a grid, row by row.
struct Sums {
    columns: usize,
    rows: usize,
    of: Vec<f64>,
}

impl Sums {
    /// How blocks of two times two of these are split, and their sums.
    fn halved(&self) -> (Level, Sums) {
        let [across, down] = [self.columns, self.rows].map(|n| n.div_ceil(2));
        let of = |i: usize, j: usize| {
            if i < self.columns && j < self.rows { self.of[j * self.columns + i] } else { 0.0 }
        };
        let blocks = || {
            (0..down).flat_map(|j| {
                (0..across).map(move |i| [0, 1].map(|y| [0, 1].map(|x| of(2 * i + x, 2 * j + y))))
            })
        };
        let split = |[[a, b], [c, d]]: [[f64; 2]; 2]| Split {
            above: share(a + b, c + d),
            left_above: share(a, b),
            left_below: share(c, d),
        };
        let sums = blocks().map(|[[a, b], [c, d]]| (a + b) + (c + d)).collect();
        (
            Level { across, splits: blocks().map(split).collect() },
            Sums { columns: across, rows: down, of: sums },
        )
    }
}

/// The part that `a` is of both, at least zero; all where there is nothing.
fn share(a: f64, b: f64) -> f32 {
    if a + b > 0.0 { (a / (a + b)) as f32 } else { 1.0 }
}

/// The largest number of [0, 1).
const BELOW_ONE: f32 = 1.0f32.next_down();

/// Whether `u` in [0, 1) is beyond the first part of it, and where it is in its part, in [0, 1).
#[inline]
fn halved(u: f32, first: f32) -> (bool, f32) {
    let is_beyond = u >= first;
    let (passed, length) = if is_beyond { (first, 1.0 - first) } else { (0.0, first) };
    (is_beyond, ((u - passed) / length).min(BELOW_ONE))
}

/// A number of [0, 1] whose density goes linearly from `a` to `b`.
#[inline]
fn linear(u: f32, a: f32, b: f32) -> f32 {
    let root = lerp(a * a, b * b, u).max(0.0).sqrt();
    let x = u * (a + b) / (a + root);
    if x.is_finite() { x.clamp(0.0, 1.0) } else { u.clamp(0.0, 1.0) }
}

#[inline]
fn lerp(a: f32, b: f32, t: f32) -> f32 {
    (1.0 - t) * a + t * b
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Stream;

    /// Grids of many shapes, with rows and columns of zeros and values far apart.
    fn grids() -> Vec<([usize; 2], f32, Vec<f32>)> {
        let mut grids = Vec::new();
        for (k, cells, ends) in
            [(0, [4, 3], 1.0), (1, [1, 1], 1.0), (2, [37, 23], 0.5), (3, [64, 2], 0.25), (4, [2, 40], 1.0)]
        {
            let s = Stream::new(17, [k, 0], 0);
            let [columns, rows] = cells;
            let value = |i: u32| {
                let (column, row) = (i as usize % (columns + 1), i as usize / (columns + 1));
                let is_dark = row == 2 || column == 5 || (column > 20 && row > 3) || s.uniform(3 * i) < 0.3;
                let v = if s.uniform(3 * i + 1) < 0.02 { 1e4 } else { 0.1 } * s.uniform(3 * i + 2);
                if is_dark && (columns > 1 || row > 0) { 0.0 } else { v }
            };
            grids.push((cells, ends, (0..((columns + 1) * (rows + 1)) as u32).map(value).collect()));
        }
        grids
    }

    fn density(([columns, rows], ends, values): &([usize; 2], f32, Vec<f32>)) -> Bilinear2D {
        Bilinear2D::new([*columns, *rows], *ends, |i, j| values[j * (columns + 1) + i]).unwrap()
    }

    /// The least and the greatest `y` of a row of cells.
    fn rows_of(density: &Bilinear2D, j: usize) -> [f32; 2] {
        [density.y_of(j, 0.0), density.y_of(j, 1.0)]
    }

    #[test]
    fn the_density_is_that_of_the_nodes_and_linear_between_them() {
        for grid in grids() {
            let ([columns, rows], _, values) = &grid;
            let density = density(&grid);
            let (mut integral, mut per_value) = (0.0, f64::NAN);
            for (j, i) in (0..*rows).flat_map(|j| (0..*columns).map(move |i| (j, i))) {
                let [top, bottom] = rows_of(&density, j);
                let at =
                    |s: f32, t: f32| Vec2::new((i as f32 + s) / *columns as f32, top + t * (bottom - top));
                let corner = |s: usize, t: usize| f64::from(values[(j + t) * (columns + 1) + i + s]);
                let mean = 0.25 * (corner(0, 0) + corner(1, 0) + corner(0, 1) + corner(1, 1));
                let middle = f64::from(density.pdf(at(0.5, 0.5)));
                integral += middle * f64::from(bottom - top) / *columns as f64;
                if per_value.is_nan() && mean > 0.0 {
                    per_value = middle / mean;
                }
                for (s, t) in [(0.5, 0.5), (0.125, 0.75), (0.9, 0.05)] {
                    let expected = (1.0 - t) * ((1.0 - s) * corner(0, 0) + s * corner(1, 0))
                        + t * ((1.0 - s) * corner(0, 1) + s * corner(1, 1));
                    let found = f64::from(density.pdf(at(s as f32, t as f32)));
                    // Shares of a row are kept in single precision.
                    let bright = values.iter().fold(0.0f32, |a, &b| a.max(b));
                    let allowed = 1e-3 * expected * per_value + 1e-5 * f64::from(bright) * per_value;
                    assert!(
                        mean == 0.0 || (found - expected * per_value).abs() <= allowed,
                        "{i} {j} {s} {t}"
                    );
                }
            }
            assert!((integral - 1.0).abs() < 1e-3, "{integral}");
            assert_eq!(density.pdf(Vec2::new(1.0, 0.5)), 0.0);
            assert_eq!(density.pdf(Vec2::new(0.5, -0.1)), 0.0);
        }
    }

    /// The cell of a point, and where it is in it.
    fn cell_of(density: &Bilinear2D, p: Vec2) -> ([usize; 2], Vec2) {
        let (j, t) = density.row_at(p.y);
        let x = p.x * density.columns as f32;
        ([x as usize, j], Vec2::new(x.fract(), t))
    }

    /// The numbers that lead to a cell are a rectangle, and its area is the probability of the cell.
    #[test]
    fn cells_are_drawn_by_their_probability() {
        let n = 1024;
        for grid in grids() {
            let ([columns, rows], ends, values) = &grid;
            let density = density(&grid);
            let mut found = vec![0.0; columns * rows];
            for k in 0..n * n {
                let u = Vec2::new((k % n) as f32 + 0.5, (k / n) as f32 + 0.5) / n as f32;
                let ([i, j], _) = cell_of(&density, density.sample(u).0);
                found[j * columns + i] += 1.0 / (n * n) as f64;
            }
            let expected = |i: usize, j: usize| {
                let corner = |s: usize, t: usize| f64::from(values[(j + t) * (columns + 1) + i + s]);
                let height = if j == 0 || j + 1 == *rows { f64::from(*ends) } else { 1.0 };
                height * (corner(0, 0) + corner(1, 0) + corner(0, 1) + corner(1, 1))
            };
            let all: f64 = (0..*rows)
                .flat_map(|j| (0..*columns).map(move |i| (i, j)))
                .map(|(i, j)| expected(i, j))
                .sum();
            for (k, found) in found.iter().enumerate() {
                let expected = expected(k % columns, k / columns) / all;
                // A rectangle holds its area's numbers but for those along two of its sides.
                assert!(
                    (found - expected).abs() < 2.0 / n as f64,
                    "cell {k} of {columns} x {rows}: {found} {expected}"
                );
            }
        }
    }

    #[test]
    fn drawn_densities_are_those_asked_for() {
        for grid in grids() {
            let density = density(&grid);
            let mut edges = 0;
            for k in 0..40_000 {
                let s = Stream::new(19, [k, 0], 0);
                let u = Vec2::new(s.uniform(0), s.uniform(1));
                let (p, pdf) = density.sample(u);
                if pdf == 0.0 {
                    edges += 1;
                    continue;
                }
                assert!((density.pdf(p) / pdf - 1.0).abs() < 0.02, "{u}: {p} {} {pdf}", density.pdf(p));
            }
            assert!(edges < 4, "{edges}");
        }
    }

    /// What the mapping stretches areas by is the inverse of the density.
    #[test]
    fn numbers_are_spread_by_the_inverse_of_the_density() {
        let smooth = ([8, 6], 0.5, (0..63).map(|i| 1.0 + (i * 37 % 11) as f32).collect());
        for grid in [vec![smooth], grids()].concat() {
            let density = density(&grid);
            let (mut tried, mut beyond) = (0, 0);
            for k in 0..4000 {
                let s = Stream::new(18, [k, 0], 0);
                let (u, h) = (Vec2::new(s.uniform(0), s.uniform(1)) * 0.99 + 0.005, 5e-4);
                let at = |dx: f32, dy: f32| density.sample(u + Vec2::new(dx, dy)).0;
                let around = |h: f32| [[h, 0.0], [-h, 0.0], [0.0, h], [0.0, -h]].map(|[dx, dy]| at(dx, dy));
                let (cell, at) = cell_of(&density, at(0.0, 0.0));
                let is_inside = at.min_element() > 0.1 && at.max_element() < 0.9;
                if !is_inside || around(8.0 * h).iter().any(|&p| cell_of(&density, p).0 != cell) {
                    continue;
                }
                let [right, left, below, above] = around(h);
                let stretch = ((right - left) / (2.0 * h)).perp_dot((below - above) / (2.0 * h));
                let product = stretch * density.sample(u).1;
                // Differences see the bend of the mapping where the density in a cell is nearly 0 at a corner.
                assert!((product - 1.0).abs() < 0.1, "{:?} {u}: {product}", grid.0);
                (tried, beyond) = (tried + 1, beyond + usize::from((product - 1.0).abs() > 0.01));
            }
            assert!(tried > 100 && 20 * beyond < tried, "{:?}: {tried} {beyond}", grid.0);
        }
    }

    #[test]
    fn an_even_density_leaves_numbers_where_they_are() {
        for cells in [[1, 1], [3, 2], [8, 8], [37, 23]] {
            let density = Bilinear2D::new(cells, 1.0, |_, _| 0.7).unwrap();
            for k in 0..1000 {
                let s = Stream::new(20, [k, 0], 0);
                let u = Vec2::new(s.uniform(0), s.uniform(1));
                let (p, pdf) = density.sample(u);
                assert!(p.abs_diff_eq(u, 1e-5) && (pdf - 1.0).abs() < 1e-5, "{cells:?} {u}: {p} {pdf}");
            }
        }
    }

    /// Stratified numbers stay so: a square of numbers is no long strip afterwards, though the densities of neighbouring rows
    /// differ.
    #[test]
    fn squares_of_numbers_stay_together() {
        let density =
            Bilinear2D::new([64, 64], 1.0, |i, j| if (i / 8 + j / 8) % 2 == 0 { 3.0 } else { 1.0 }).unwrap();
        let (parts, n) = (8, 16);
        let mut extents = 0.0;
        for part in 0..parts * parts {
            let corner = Vec2::new((part % parts) as f32, (part / parts) as f32);
            let points = (0..n * n).map(|k| {
                let inside = Vec2::new((k % n) as f32 + 0.5, (k / n) as f32 + 0.5) / n as f32;
                density.sample((corner + inside) / parts as f32).0
            });
            let (least, most) = points.fold((Vec2::ONE, Vec2::ZERO), |(a, b), p| (a.min(p), b.max(p)));
            extents += (most - least).max_element() / (parts * parts) as f32;
        }
        assert!(extents < 0.2, "{extents}");
    }

    #[test]
    fn the_ends_of_the_intervals_are_in_cells_that_count() {
        let values = [0.0, 0.0, 0.0, 0.0, 0.0, 2.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        let density = Bilinear2D::new([3, 2], 1.0, |i, j| values[4 * j + i]).unwrap();
        for u in [Vec2::ZERO, Vec2::ONE.map(f32::next_down), Vec2::new(0.0, 0.5), Vec2::new(0.5, 0.0)] {
            let (p, pdf) = density.sample(u);
            assert!(
                p.min_element() >= 0.0 && p.max_element() < 1.0 && pdf >= 0.0 && pdf.is_finite(),
                "{u}: {p} {pdf}"
            );
        }
    }

    #[test]
    fn what_is_no_density_is_refused() {
        assert!(Bilinear2D::new([2, 2], 1.0, |_, _| 0.0).is_none());
        assert!(Bilinear2D::new([2, 2], 1.0, |i, _| i as f32 - 1.0).is_none());
        assert!(Bilinear2D::new([2, 2], 1.0, |i, _| if i == 0 { f32::NAN } else { 1.0 }).is_none());
        assert!(Bilinear2D::new([2, 2], 1.0, |_, _| f32::INFINITY).is_none());
        assert!(Bilinear2D::new([0, 2], 1.0, |_, _| 1.0).is_none());
        assert!(Bilinear2D::new([2, 1], 0.5, |_, _| 1.0).is_none());
    }
}
