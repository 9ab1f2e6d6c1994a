//! The order in which tiles are rendered: a Hilbert curve over any rectangle.
//!
//! Neighbours on the curve are neighbours in the picture, so what a thread needs next is mostly what
//! it, or another thread, had in the cache a moment ago. The curve splits the rectangle as Hilbert's
//! does a square: into two halves along its long side when it is long, otherwise into a quarter, a
//! half and a quarter. [Červený 2018, "Generalized Hilbert space-filling curve for rectangular domains"]

use std::ops::{Add, Neg, Sub};

/// A step in columns and rows.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Step(i64, i64);

impl Step {
    /// Length of a step along an axis.
    fn len(self) -> i64 {
        (self.0 + self.1).abs()
    }

    /// The step of length 1 in the same direction.
    fn unit(self) -> Step {
        Step(self.0.signum(), self.1.signum())
    }

    /// Half of it, rounded so that a length over 2 becomes even.
    fn even_half(self) -> Step {
        let half = self.half();
        if half.len() % 2 == 1 && self.len() > 2 { half + self.unit() } else { half }
    }

    fn half(self) -> Step {
        Step(self.0 >> 1, self.1 >> 1)
    }

    fn times(self, n: i64) -> Step {
        Step(self.0 * n, self.1 * n)
    }
}

impl Add for Step {
    type Output = Step;
    fn add(self, other: Step) -> Step {
        Step(self.0 + other.0, self.1 + other.1)
    }
}

impl Sub for Step {
    type Output = Step;
    fn sub(self, other: Step) -> Step {
        Step(self.0 - other.0, self.1 - other.1)
    }
}

impl Neg for Step {
    type Output = Step;
    fn neg(self) -> Step {
        Step(-self.0, -self.1)
    }
}

/// Column and row of position `index` on the curve through `columns × rows` cells.
///
/// `index` is less than their number, which is at most 2^62; the work is proportional to the logarithm of that.
pub fn cell(index: u64, columns: u32, rows: u32) -> (u32, u32) {
    debug_assert!(index < u64::from(columns) * u64::from(rows));
    let (right, down) = (Step(i64::from(columns), 0), Step(0, i64::from(rows)));
    // The part of the curve at hand starts at `at`, goes along `a` and is as wide as `b`.
    let (mut at, mut a, mut b) =
        if columns >= rows { (Step(0, 0), right, down) } else { (Step(0, 0), down, right) };
    let mut left = index as i64;
    loop {
        if b.len() == 1 {
            at = at + a.unit().times(left);
        } else if a.len() == 1 {
            at = at + b.unit().times(left);
        }
        if a.len() == 1 || b.len() == 1 {
            return (at.0 as u32, at.1 as u32);
        }
        if 2 * a.len() > 3 * b.len() {
            let half = a.even_half();
            let first = half.len() * b.len();
            if left < first {
                a = half;
            } else {
                (left, at, a) = (left - first, at + half, a - half);
            }
            continue;
        }
        let (half_a, half_b) = (a.half(), b.even_half());
        let first = half_b.len() * half_a.len();
        let second = first + a.len() * (b - half_b).len();
        if left < first {
            (a, b) = (half_b, half_a);
        } else if left < second {
            (left, at, b) = (left - first, at + half_b, b - half_b);
        } else {
            left -= second;
            at = at + (a - a.unit()) + (half_b - b.unit());
            (a, b) = (-half_b, -(a - half_a));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_cell_is_visited_once_and_next_to_the_last() {
        for (columns, rows) in
            [(1, 1), (1, 9), (9, 1), (2, 2), (8, 8), (7, 5), (5, 7), (12, 1), (48, 4), (31, 33), (3, 64)]
        {
            let mut seen = vec![false; (columns * rows) as usize];
            let mut last = None;
            for index in 0..u64::from(columns * rows) {
                let (x, y) = cell(index, columns, rows);
                assert!(
                    x < columns && y < rows && !seen[(y * columns + x) as usize],
                    "{columns} x {rows}: {index}"
                );
                seen[(y * columns + x) as usize] = true;
                // Odd sizes need a diagonal step now and then.
                if let Some((a, b)) = last.replace((x, y)) {
                    assert!(x.abs_diff(a) <= 1 && y.abs_diff(b) <= 1, "{columns} x {rows}: jump at {index}");
                }
            }
        }
    }

    #[test]
    fn a_stretch_of_the_curve_is_compact() {
        // 256 cells in a row of tiles would span 64 × 4; on the curve they fill 16 × 16.
        let places: Vec<_> = (0..256).map(|i| cell(i, 64, 64)).collect();
        assert!(places.iter().all(|&(x, y)| x < 16 && y < 16));
    }

    #[test]
    fn the_largest_picture_in_tiles_of_one_pixel_has_a_last_place() {
        let (x, y) = cell((1 << 31) - 1, 1 << 16, 1 << 15);
        assert_eq!((x, y), ((1 << 16) - 1, 0));
    }
}
