//! Pearson's chi-square test: do counts follow their expected values?
//!
//! ```text
//! χ² = Σ (observed - expected)² / expected
//! ```
//!
//! The p-value is the chance of a χ² at least as large when they do: `Q(ν/2, χ²/2)` with ν degrees of
//! freedom, one less than there are cells. Cells that expect fewer than five are pooled, since the law
//! holds for large counts only.

use crate::special::upper_gamma;

/// Least number expected in a cell that is not pooled with others.
const SMALLEST_CELL: f64 = 5.0;

/// Outcome of a test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChiSquare {
    /// The sum.
    pub statistic: f64,
    /// Degrees of freedom.
    pub degrees: u32,
    /// Chance of a sum at least as large.
    pub p: f64,
}

impl ChiSquare {
    /// Compares counts with what is expected of each cell, in the same order and of the same total.
    ///
    /// Counts where none can be (expected zero or less) give `p = 0`, and so does a shape that leaves fewer
    /// than two cells.
    pub fn test(observed: &[f64], expected: &[f64]) -> ChiSquare {
        assert_eq!(observed.len(), expected.len(), "as many counts as expectations");
        let mut cells = Vec::new();
        let mut pool = (0.0, 0.0);
        let mut impossible = false;
        for (&found, &wanted) in observed.iter().zip(expected) {
            impossible |= wanted <= 0.0 && found > 0.0;
            if wanted >= SMALLEST_CELL {
                cells.push((found, wanted));
            } else {
                pool = (pool.0 + found, pool.1 + wanted);
            }
        }
        // A pool too small for a cell of its own joins the last one.
        if pool.1 >= SMALLEST_CELL {
            cells.push(pool);
        } else if let Some(last) = cells.last_mut() {
            *last = (last.0 + pool.0, last.1 + pool.1);
        }
        let statistic = cells.iter().map(|(found, wanted)| (found - wanted).powi(2) / wanted).sum();
        let degrees = cells.len().saturating_sub(1) as u32;
        let p = if impossible || degrees == 0 {
            0.0
        } else {
            upper_gamma(f64::from(degrees) / 2.0, statistic / 2.0)
        };
        ChiSquare { statistic, degrees, p }
    }

    /// Whether the test passes at the level `alpha` shared by `tests` tests of a list.
    ///
    /// The level of each is Šidák's, `1 - (1 - alpha)^(1/tests)`. [Šidák 1967]
    pub fn passes(&self, alpha: f64, tests: u32) -> bool {
        self.p >= 1.0 - (1.0 - alpha).powf(1.0 / f64::from(tests))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo_math::rng::Stream;

    #[test]
    fn p_values_of_the_tables() {
        // Critical values of the usual tables: ν, χ² at 5 % and at 1 %.
        for (degrees, five, one) in
            [(1, 3.841, 6.635), (2, 5.991, 9.210), (10, 18.307, 23.209), (100, 124.342, 135.807)]
        {
            let p = |x: f64| upper_gamma(f64::from(degrees) / 2.0, x / 2.0);
            assert!((p(five) - 0.05).abs() < 1e-4, "{degrees}");
            assert!((p(one) - 0.01).abs() < 1e-4, "{degrees}");
        }
    }

    #[test]
    fn by_hand() {
        let test = ChiSquare::test(&[44.0, 56.0], &[50.0, 50.0]);
        assert!((test.statistic - 1.44).abs() < 1e-12 && test.degrees == 1);
        assert!((test.p - 0.230_139).abs() < 1e-5, "{}", test.p);
    }

    #[test]
    fn small_cells_are_pooled() {
        let test = ChiSquare::test(&[50.0, 3.0, 4.0, 43.0], &[50.0, 4.0, 3.0, 43.0]);
        assert_eq!((test.statistic, test.degrees), (0.0, 2));
        let test = ChiSquare::test(&[50.0, 2.0, 48.0], &[50.0, 1.0, 49.0]);
        assert_eq!((test.statistic, test.degrees), (0.0, 1));
        assert_eq!(ChiSquare::test(&[1.0], &[1.0]).p, 0.0);
        assert_eq!(ChiSquare::test(&[50.0, 1.0, 49.0], &[50.0, 0.0, 50.0]).p, 0.0);
    }

    #[test]
    fn uniform_numbers_pass_and_bent_ones_fail() {
        let counts = |bend: f32| {
            let mut counts = [0.0; 50];
            for i in 0..100_000 {
                let u = Stream::new(4, [i, 0], 0).uniform(0);
                counts[((u + bend * u * (1.0 - u)) * 50.0) as usize] += 1.0;
            }
            counts
        };
        assert!(ChiSquare::test(&counts(0.0), &[2000.0; 50]).passes(0.01, 10));
        assert!(!ChiSquare::test(&counts(0.05), &[2000.0; 50]).passes(0.01, 10));
    }
}
