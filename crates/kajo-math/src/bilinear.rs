//! A density that is bilinear between the nodes of a grid, such as the brightness of a picture, and drawing from it.
//!
//! Over a cell with the values `a b` above and `c d` below the density at the share `(s, t)` of it is in proportion to
//!
//! ```text
//! f(s, t) = (1 - t) ((1 - s) a + s b) + t ((1 - s) c + s d)
//! ```
//!
//! Over a whole row of cells its integral is linear in `t`. So `y` is drawn first, by the sums of rows and the inverse of a linear
//! density's integral; at that `y` the density along `x` is the mix of those of the two rows of nodes, and so is its integral,
//! which is searched for the cell and inverted in it [Pharr et al. 2023, 2.3.2]. Neighbouring numbers go to neighbouring places, so
//! that stratified numbers stay stratified. A guide table says between which cells to search.

use crate::Vec2;

/// A density over [0, 1)².
#[derive(Clone, Debug, PartialEq)]
pub struct Bilinear2D {
    /// Cells in a row.
    columns: usize,
    /// For each row of nodes the share of its sum that lies before each node, and 1 at the end.
    before: Vec<f32>,
    /// For each row of nodes the density at a node over the node's share of the sum.
    scales: Vec<f32>,
    /// For each row of nodes the integral of the density along it.
    integrals: Vec<f32>,
    /// Probability of what lies above each row of nodes, from 0 to 1.
    above: Vec<f64>,
    /// Height of the first and of the last row of cells, in that of the others.
    ends: f32,
    guide_to_rows: Guide,
    guide_to_cells: Guide,
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
        let mut before = Vec::with_capacity((columns + 2) * (rows + 1));
        let (mut sums, mut guide_to_cells) = (Vec::with_capacity(rows + 1), Guide::new(columns));
        for j in 0..=rows {
            sums.push(add_row(&mut before, (0..=columns).map(|i| value(i, j)))?);
            let row = Row::new(&before, columns, j);
            let over = 1.0 / row.integral(columns).max(f32::MIN_POSITIVE);
            guide_to_cells.add(columns, |i| f64::from(row.integral(i) * over));
        }
        let integral = |j: usize| sums[j] * f64::from(Row::new(&before, columns, j).integral(columns));
        let height = |j: usize| if j == 0 || j + 1 == rows { f64::from(ends) } else { 1.0 };
        let (mut above, mut total) = (vec![0.0], 0.0);
        for j in 0..rows {
            total += 0.5 * height(j) * (integral(j) + integral(j + 1));
            above.push(total);
        }
        if total <= 0.0 {
            return None;
        }
        above.iter_mut().for_each(|above| *above /= total);
        let mut guide_to_rows = Guide::new(rows);
        guide_to_rows.add(rows, |j| above[j]);
        let all: f64 = (0..rows).map(height).sum();
        let integrals = (0..=rows).map(|j| (integral(j) * all / total) as f32).collect();
        let scales = sums.iter().map(|sum| (sum * all / total * columns as f64) as f32).collect();
        Some(Bilinear2D { columns, before, scales, integrals, above, ends, guide_to_rows, guide_to_cells })
    }

    /// Bytes on the heap.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.before) + size_of_val(&*self.guide_to_cells.starts)
    }

    /// A point drawn with this density and the density there, per area of the unit square; 0 where rounding carries
    /// it beside what counts, as it may one number of a million.
    ///
    /// * `u`: uniform in [0, 1)²
    #[inline]
    pub fn sample(&self, u: Vec2) -> (Vec2, f32) {
        let (first, last) = self.guide_to_rows.between(0, u.y);
        let uy = f64::from(u.y);
        let j = last_at_most(first, last, |j| self.above[j] <= uy);
        let rest = (uy - self.above[j]) / (self.above[j + 1] - self.above[j]);
        let t = linear(rest as f32, self.integrals[j], self.integrals[j + 1]);
        let (i, s, pdf) = self.sample_row(u.x, j, t);
        let x = (i as f32 + s) / self.columns as f32;
        (Vec2::new(x, self.y_of(j, t)).min(Vec2::splat(1.0f32.next_down())), pdf)
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
        let row = self.between(j, t);
        lerp(row.node(i), row.node(i + 1), x - i as f32)
    }

    /// The cell and the place in it of `u` in [0, 1), and the density there, at the share `t` of a row of cells.
    #[inline]
    fn sample_row(&self, u: f32, j: usize, t: f32) -> (usize, f32, f32) {
        let row = self.between(j, t);
        let sought = u * row.integral(self.columns);
        // The integral of a mix is at each cell between those of its parts.
        let [upper, lower] = [j, j + 1].map(|j| self.guide_to_cells.between(j, u));
        let (first, last) = (upper.0.min(lower.0), upper.1.max(lower.1));
        let i = last_at_most(first, last, |i| row.integral(i) <= sought);
        let (a, b) = (row.node(i), row.node(i + 1));
        let mean = 0.5 * (a + b);
        let s = if mean > 0.0 { linear((sought - row.integral(i)) / mean, a, b) } else { 0.5 };
        (i, s, lerp(a, b, s))
    }

    /// The density along x at the share `t` of a row of cells.
    #[inline]
    fn between(&self, j: usize, t: f32) -> Mix<'_> {
        let weights = [(1.0 - t) * self.scales[j], t * self.scales[j + 1]];
        Mix { rows: [j, j + 1].map(|j| Row::new(&self.before, self.columns, j)), weights }
    }

    /// The row of cells at `y`, and the share of it.
    #[inline]
    fn row_at(&self, y: f32) -> (usize, f32) {
        let last = self.above.len() - 2;
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
        let t = if j == 0 || j + 2 == self.above.len() { self.ends * t } else { t };
        let before = if j == 0 { 0.0 } else { self.ends + (j as f32 - 1.0) };
        (before + t) / self.height()
    }

    /// Of all rows of cells together.
    #[inline]
    fn height(&self) -> f32 {
        self.above.len() as f32 - 3.0 + 2.0 * self.ends
    }
}

/// Appends the shares of a row to those of others; returns their sum.
fn add_row(before: &mut Vec<f32>, values: impl Iterator<Item = f32> + Clone) -> Option<f64> {
    let sum: f64 = values.clone().map(f64::from).sum();
    if !sum.is_finite() || values.clone().any(|v| v < 0.0) {
        return None;
    }
    let (over, mut passed) = (1.0 / sum.max(f64::MIN_POSITIVE), 0.0);
    before.push(0.0);
    for value in values {
        passed += f64::from(value);
        before.push((passed * over) as f32);
    }
    Some(sum)
}

/// The shares of one row of nodes.
#[derive(Clone, Copy)]
struct Row<'a>(&'a [f32]);

impl Row<'_> {
    #[inline]
    fn new(before: &[f32], columns: usize, j: usize) -> Row<'_> {
        Row(&before[j * (columns + 2)..][..columns + 2])
    }

    /// The sum over cells before the node `i` of the means of their two nodes.
    #[inline]
    fn integral(&self, i: usize) -> f32 {
        0.5 * (self.0[i] + self.0[i + 1] - self.0[1])
    }

    #[inline]
    fn node(&self, i: usize) -> f32 {
        self.0[i + 1] - self.0[i]
    }
}

/// The sum of two rows times weights.
struct Mix<'a> {
    rows: [Row<'a>; 2],
    weights: [f32; 2],
}

impl Mix<'_> {
    #[inline]
    fn integral(&self, i: usize) -> f32 {
        self.weights[0] * self.rows[0].integral(i) + self.weights[1] * self.rows[1].integral(i)
    }

    #[inline]
    fn node(&self, i: usize) -> f32 {
        self.weights[0] * self.rows[0].node(i) + self.weights[1] * self.rows[1].node(i)
    }
}

/// Between which cells to search, for rising sequences of shares from 0 to 1.
#[derive(Clone, Debug, PartialEq)]
struct Guide {
    /// Equal parts of [0, 1) that each sequence has an entry for.
    parts: usize,
    /// For each sequence the last cell that begins at most at the start of each part, and at 1.
    starts: Vec<u32>,
}

impl Guide {
    /// Cells for each part.
    const CELLS: usize = 4;

    fn new(cells: usize) -> Guide {
        Guide { parts: cells.div_ceil(Guide::CELLS), starts: Vec::new() }
    }

    /// Appends a sequence of so many cells, by the share at which each begins.
    fn add(&mut self, cells: usize, begin: impl Fn(usize) -> f64) {
        let mut at = 0;
        for part in 0..=self.parts {
            let share = part as f64 / self.parts as f64;
            while at + 1 < cells && begin(at + 1) <= share {
                at += 1;
            }
            self.starts.push(at as u32);
        }
    }

    /// The first and the last cell of a sequence that may hold `u` in [0, 1).
    #[inline]
    fn between(&self, sequence: usize, u: f32) -> (usize, usize) {
        let part = ((u * self.parts as f32) as usize).min(self.parts - 1);
        let starts = &self.starts[sequence * (self.parts + 1) + part..][..2];
        (starts[0] as usize, starts[1] as usize)
    }
}

/// The last of `first..=last` for which `holds`, which it does up to there; `first` if for none.
#[inline]
fn last_at_most(mut first: usize, mut last: usize, holds: impl Fn(usize) -> bool) -> usize {
    while first < last {
        let middle = (first + last).div_ceil(2);
        if holds(middle) { first = middle } else { last = middle - 1 }
    }
    first
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

    /// Of the integral over [0, x) the part that lies in each cell, of a function linear between the values of nodes.
    fn integral(nodes: &[f64], x: f64) -> f64 {
        nodes
            .windows(2)
            .enumerate()
            .map(|(i, ends)| {
                let s = (x - i as f64).clamp(0.0, 1.0);
                s * (ends[0] + 0.5 * s * (ends[1] - ends[0]))
            })
            .sum()
    }

    /// A point is where the integral of the density down to its row, and along that to its column, is what it was drawn by.
    #[test]
    fn points_follow_the_density() {
        for grid in grids() {
            let ([columns, rows], ends, values) = &grid;
            let density = density(&grid);
            let row = |j: usize| values[j * (columns + 1)..][..columns + 1].iter().map(|&v| f64::from(v));
            let sums: Vec<f64> =
                (0..=*rows).map(|j| integral(&row(j).collect::<Vec<_>>(), *columns as f64)).collect();
            let height = |j: usize| if j == 0 || j + 1 == *rows { f64::from(*ends) } else { 1.0 };
            let upto = |j: usize, t: f64| {
                let before = |k: usize| height(k) * 0.5 * (sums[k] + sums[k + 1]);
                (0..j).map(before).sum::<f64>() + height(j) * integral(&sums[j..j + 2], t)
            };
            let (all, mut beside) = (upto(*rows - 1, 1.0), 0);
            for k in 0..40_000 {
                let s = Stream::new(19, [k, 0], 0);
                let u = Vec2::new(s.uniform(0), s.uniform(1));
                let (p, pdf) = density.sample(u);
                let again = density.pdf(p);
                if pdf == 0.0 {
                    beside += 1;
                    continue;
                }
                assert!((again / pdf - 1.0).abs() < 0.02, "{u}: {p} {again} {pdf}");
                let (j, t) = density.row_at(p.y);
                let t = f64::from(t);
                let at_y: Vec<f64> = row(j).zip(row(j + 1)).map(|(a, b)| (1.0 - t) * a + t * b).collect();
                let in_row = integral(&at_y, *columns as f64);
                let x = integral(&at_y, f64::from(p.x) * *columns as f64) / in_row;
                let y = upto(j, t) / all;
                // Places are rounded, which counts as much as the density there.
                let allowed = 1e-5 + 2e-7 * f64::from(pdf);
                assert!((y - f64::from(u.y)).abs() < allowed, "{u}: {p} {y}");
                assert!((x - f64::from(u.x)).abs() < allowed, "{u}: {p} {x}");
            }
            assert!(beside < 4, "{beside}");
        }
    }

    /// What the mapping stretches areas by is the inverse of the density.
    #[test]
    fn numbers_are_spread_by_the_inverse_of_the_density() {
        let grid = ([8, 6], 0.5, (0..63).map(|i| 1.0 + (i * 37 % 11) as f32).collect());
        let density = density(&grid);
        for k in 0..500 {
            let s = Stream::new(18, [k, 0], 0);
            let (u, h) = (Vec2::new(s.uniform(0), s.uniform(1)) * 0.99 + 0.005, 1e-3);
            let at = |dx: f32, dy: f32| density.sample(u + Vec2::new(dx, dy)).0;
            let (across, down) =
                ((at(h, 0.0) - at(-h, 0.0)) / (2.0 * h), (at(0.0, h) - at(0.0, -h)) / (2.0 * h));
            let stretch = across.perp_dot(down) * density.sample(u).1;
            // Where the difference is taken across the border of a cell the density has a crease.
            assert!((stretch - 1.0).abs() < 0.03, "{u}: {stretch}");
        }
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
