//! Densities that are constant over the cells of a grid, such as the brightness of a picture, and drawing from them.
//!
//! With cells `v_0 .. v_(n-1)` over [0, 1) the density is `n v_i / sum v`. A uniform number is carried through
//! the inverse of its integral; in two dimensions first to a row, by the sums of rows, then to a place in the row
//! [Pharr, Jakob and Humphreys 2023, appendix A.4 and A.5]. Neighbouring numbers go to neighbouring places, so that
//! stratified numbers stay stratified.

use crate::Vec2;

/// A density over [0, 1).
#[derive(Clone, Debug, PartialEq)]
pub struct Piecewise1D {
    /// Probability of what lies before each cell, and 1 at the end; one number more than there are cells.
    before: Vec<f32>,
}

impl Piecewise1D {
    /// The density in proportion to `values`; `None` when they are not all finite and at least zero, or all zero.
    pub fn new(values: &[f32]) -> Option<Piecewise1D> {
        let valid = values.iter().all(|v| v.is_finite() && *v >= 0.0);
        let total: f64 = values.iter().map(|&v| f64::from(v)).sum();
        if !valid || total <= 0.0 {
            return None;
        }
        let mut sum = 0.0;
        let mut before: Vec<f32> = Vec::with_capacity(values.len() + 1);
        for &value in values {
            before.push((sum / total) as f32);
            sum += f64::from(value);
        }
        before.push(1.0);
        Some(Piecewise1D { before })
    }

    /// A number drawn with this density and the density there.
    ///
    /// * `u`: uniform in [0, 1)
    #[inline]
    pub fn sample(&self, u: f32) -> (f32, f32) {
        let (cell, rest) = self.cell_of(u);
        let n = (self.before.len() - 1) as f32;
        (((cell as f32 + rest) / n).min(1.0f32.next_down()), self.probability(cell) * n)
    }

    /// The density at `x`, and 0 outside of [0, 1).
    #[inline]
    pub fn pdf(&self, x: f32) -> f32 {
        let n = (self.before.len() - 1) as f32;
        if (0.0..1.0).contains(&x) {
            self.probability(((x * n) as usize).min(self.before.len() - 2)) * n
        } else {
            0.0
        }
    }

    /// The probability of a cell, which [`Piecewise1D::cell_of`] answers or is less than the number of cells.
    #[inline]
    pub fn probability(&self, cell: usize) -> f32 {
        self.before[cell + 1] - self.before[cell]
    }

    /// The cell that `u` in [0, 1) falls into, none of probability zero, and where in it.
    #[inline]
    pub fn cell_of(&self, u: f32) -> (usize, f32) {
        let cell = self.before.partition_point(|&b| b <= u) - 1;
        let cell = cell.min(self.before.len() - 2);
        (cell, (u - self.before[cell]) / self.probability(cell))
    }
}

/// A density over [0, 1)².
#[derive(Clone, Debug, PartialEq)]
pub struct Piecewise2D {
    /// The density of each row along x; that of an empty row is never asked for.
    rows: Vec<Option<Piecewise1D>>,
    column: Piecewise1D,
}

impl Piecewise2D {
    /// The density in proportion to the rows of `width` values each, the first at y = 0; `None` as in
    /// [`Piecewise1D::new`], or when there is no whole number of rows.
    pub fn new(values: &[f32], width: usize) -> Option<Piecewise2D> {
        if width == 0 || !values.len().is_multiple_of(width) {
            return None;
        }
        let sum = |row: &[f32]| row.iter().map(|&v| f64::from(v)).sum::<f64>() as f32;
        let column = Piecewise1D::new(&values.chunks(width).map(sum).collect::<Vec<_>>())?;
        Some(Piecewise2D { rows: values.chunks(width).map(Piecewise1D::new).collect(), column })
    }

    /// A point drawn with this density and the density there, per area of the unit square.
    ///
    /// * `u`: uniform in [0, 1)²
    #[inline]
    pub fn sample(&self, u: Vec2) -> (Vec2, f32) {
        let (y, pdf_y) = self.column.sample(u.y);
        let (x, pdf_x) = self.row(y).map_or((u.x, 0.0), |row| row.sample(u.x));
        (Vec2::new(x, y), pdf_x * pdf_y)
    }

    /// The density at `p`, and 0 outside of the unit square.
    #[inline]
    pub fn pdf(&self, p: Vec2) -> f32 {
        self.column.pdf(p.y) * self.row(p.y).map_or(0.0, |row| row.pdf(p.x))
    }

    #[inline]
    fn row(&self, y: f32) -> Option<&Piecewise1D> {
        let row = ((y * self.rows.len() as f32) as usize).min(self.rows.len() - 1);
        self.rows[row].as_ref()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PICTURE: [f32; 12] = [0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 3.0, 2.0, 0.5, 0.5, 0.0, 1.0];

    #[test]
    fn points_fall_into_cells_in_proportion_to_their_values() {
        let density = Piecewise2D::new(&PICTURE, 4).unwrap();
        let (n, mut counts) = (400, [0.0; 12]);
        for i in 0..n * n {
            let u = Vec2::new((i % n) as f32 + 0.5, (i / n) as f32 + 0.5) / n as f32;
            let (p, pdf) = density.sample(u);
            assert!((density.pdf(p) / pdf - 1.0).abs() < 1e-5, "{p}");
            counts[(p.x * 4.0) as usize + 4 * (p.y * 3.0) as usize] += 1.0;
        }
        for (count, value) in counts.iter().zip(PICTURE) {
            let share = count / (n * n) as f32;
            assert!((share - value / 8.0).abs() < 2e-3, "{value}: {share}");
        }
    }

    #[test]
    fn the_density_integrates_to_one() {
        let density = Piecewise2D::new(&PICTURE, 4).unwrap();
        let middles =
            (0..12).map(|i| Vec2::new((i % 4) as f32 + 0.5, (i / 4) as f32 + 0.5) / Vec2::new(4.0, 3.0));
        let integral: f32 = middles.map(|p| density.pdf(p) / 12.0).sum();
        assert!((integral - 1.0).abs() < 1e-6);
        assert_eq!(density.pdf(Vec2::new(1.0, 0.5)), 0.0);
    }

    #[test]
    fn the_ends_of_the_interval_are_in_cells_that_count() {
        let density = Piecewise1D::new(&[0.0, 2.0, 0.0, 1.0, 0.0]).unwrap();
        for (u, low, high) in [(0.0, 0.2, 0.21), (1.0f32.next_down(), 0.79, 0.8)] {
            let (x, pdf) = density.sample(u);
            assert!((low..=high).contains(&x) && pdf > 0.0, "{u}: {x} {pdf}");
        }
    }

    #[test]
    fn what_is_no_density_is_refused() {
        assert!(Piecewise1D::new(&[]).is_none());
        assert!(Piecewise1D::new(&[0.0, 0.0]).is_none());
        assert!(Piecewise1D::new(&[1.0, -1.0]).is_none());
        assert!(Piecewise1D::new(&[1.0, f32::NAN]).is_none());
        assert!(Piecewise2D::new(&[1.0, 2.0, 3.0], 2).is_none());
        assert!(Piecewise2D::new(&[], 0).is_none());
    }
}
