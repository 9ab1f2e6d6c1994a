//! Sums of splats: light that comes to a pixel from samples of any other.
//!
//! ```text
//! I_j = P/S Σ w(splat - centre of j) value / ∫ w
//! ```
//!
//! with `S` samples in all and `P` pixels; the integral runs over the part of the filter's support around pixel
//! `j` that lies in the pixel's cell. It is the product of two integrals along the axes. Where samples count for
//! their own pixel only, the filter is the pixel itself and the integral 1.
//!
//! Where the variance is wanted the squares `s²` of the splats that fall into a pixel are summed as well. Without a filter
//! the pixel is the sum of `S` independent draws, most of them zero, so that its variance is
//!
//! ```text
//! V_j = (P/S)² (Σ s² - (Σ s)²/S),
//! ```
//!
//! of which the second term is smaller than the first by the number of pixels and is left out. Splats of one
//! sample that fall into the same pixel are taken for independent, too. As for camera rays, filters are left aside.

use std::io::{self, Read};

use super::{
    filter::Filter,
    fixed::{self, Term, Weight},
    numbers::{restore_array, save_numbers},
    spec::FilmSpec,
};
use crate::rect::Rect;

/// How splats spread in a region.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct SplatSpread {
    /// Mean of what they bring.
    pub mean: f64,
    /// Mean over the pixels of its variance.
    pub variance: f64,
}

/// Panels of the midpoint rule for one integral of a filter.
const PANELS: u32 = 4096;

/// Exact sums of the splats of a rectangle of pixels.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SplatSums {
    pub rect: Rect,
    values: Vec<[i128; 3]>,
    /// Sums of the squares of those that fell into the pixel; empty where the variance is not asked for.
    squares: Vec<[i128; 3]>,
}

impl SplatSums {
    /// Nothing, over the pixels of `rect`.
    ///
    /// * `spreads`: whether the variance is wanted
    pub fn new(rect: Rect, spreads: bool) -> SplatSums {
        let none = || vec![[0; 3]; rect.area() as usize];
        SplatSums { rect, values: none(), squares: if spreads { none() } else { Vec::new() } }
    }

    /// Records how far a value, which fell into this pixel of the rectangle, makes the pixel spread.
    pub fn add_square(&mut self, x: u32, y: u32, value: &[Term; 3]) {
        let index = self.rect.index(x, y);
        let Some(sums) = self.squares.get_mut(index) else { return };
        for (sum, term) in sums.iter_mut().zip(value) {
            *sum += term.squared();
        }
    }

    /// Adds the variance of what the splats bring to a row of pixels; see [`SplatSums::add_to_row`].
    pub fn add_variance_to_row(&self, samples_per_pixel: f64, y: u32, out: &mut [f32]) {
        let row = self.rect.index(self.rect.x0, y);
        for (sums, out) in self.squares.iter().skip(row).zip(out.chunks_exact_mut(3)) {
            for (out, &sum) in out.iter_mut().zip(sums) {
                *out += fixed::average(sum, samples_per_pixel * samples_per_pixel);
            }
        }
    }

    /// Means over the pixels and the three channels of what the splats bring and of its variance.
    pub fn spread(&self, areas: &Areas, samples_per_pixel: f64) -> SplatSpread {
        let mut spread = SplatSpread::default();
        for y in self.rect.y0..self.rect.y1 {
            let row = |values: &[[i128; 3]], sum: &mut f64, divisor: &dyn Fn(u32) -> f64| {
                for (x, sums) in (self.rect.x0..self.rect.x1).zip(&values[self.rect.index(self.rect.x0, y)..])
                {
                    *sum += sums.iter().map(|&sum| f64::from(fixed::average(sum, divisor(x)))).sum::<f64>();
                }
            };
            row(&self.values, &mut spread.mean, &|x| samples_per_pixel * areas.of(x, y));
            if !self.squares.is_empty() {
                row(&self.squares, &mut spread.variance, &|_| samples_per_pixel * samples_per_pixel);
            }
        }
        let n = 3.0 * self.rect.area() as f64;
        SplatSpread { mean: spread.mean / n, variance: spread.variance / n }
    }

    /// Adds a value to a pixel of the rectangle.
    pub fn add(&mut self, x: u32, y: u32, weight: Weight, value: &[Term; 3]) {
        let sums = &mut self.values[self.rect.index(x, y)];
        for (sum, term) in sums.iter_mut().zip(value) {
            *sum += term.times(weight);
        }
    }

    /// Adds what the splats bring to a row of colours: of pixels from `first` on, as many as `out` has room for.
    ///
    /// * `samples_per_pixel`: `S/P`
    pub fn add_to_row(&self, areas: &Areas, samples_per_pixel: f64, y: u32, out: &mut [f32]) {
        let row = self.rect.index(self.rect.x0, y);
        for ((x, sums), out) in (self.rect.x0..).zip(&self.values[row..]).zip(out.chunks_exact_mut(3)) {
            let divisor = samples_per_pixel * areas.of(x, y);
            for (out, &sum) in out.iter_mut().zip(sums) {
                *out += fixed::average(sum, divisor);
            }
        }
    }
}

impl SplatSums {
    /// Adds the sums of the same rectangle of another film of this kind.
    pub fn absorb(&mut self, other: &SplatSums) {
        let sums = self.values.iter_mut().chain(&mut self.squares);
        for (sum, other) in sums.zip(other.values.iter().chain(&other.squares)) {
            (0..3).for_each(|c| sum[c] += other[c]);
        }
    }

    /// Writes the sums.
    pub fn save(&self, out: &mut Vec<u8>) {
        save_numbers(self.values.as_flattened().iter().copied(), out);
        save_numbers(self.squares.as_flattened().iter().copied(), out);
    }

    /// Reads what [`SplatSums::save`] wrote of a rectangle of this size.
    pub fn restore(&mut self, input: &mut dyn Read) -> io::Result<()> {
        restore_array(self.values.as_flattened_mut(), input)?;
        restore_array(self.squares.as_flattened_mut(), input)
    }
}

/// Integrals of the filter around every column and row.
#[derive(Clone, Debug)]
pub(crate) struct Areas {
    columns: Vec<f64>,
    rows: Vec<f64>,
}

impl Areas {
    /// The integrals of a film's filter.
    pub fn new(spec: &FilmSpec) -> Areas {
        let [width, height] = spec.cell.unwrap_or([spec.width, spec.height]);
        Areas {
            columns: integrals(&spec.filter, spec.width, width),
            rows: integrals(&spec.filter, spec.height, height),
        }
    }

    /// The integral around a pixel, in pixels; 0 where lobes cancel.
    fn of(&self, x: u32, y: u32) -> f64 {
        self.columns[x as usize] * self.rows[y as usize]
    }
}

/// The integral of a filter's profile around each of `n` pixels, within cells of `cell` pixels.
fn integrals(filter: &Filter, n: u32, cell: u32) -> Vec<f64> {
    let Some(r) = filter.radius() else { return vec![1.0; n as usize] };
    let r = f64::from(r);
    let mut last = ((0.0, 0.0), 0.0);
    let mut integral_around = |i: u32| {
        let start = i - i % cell;
        let end = start.saturating_add(cell).min(n);
        let centre = f64::from(i) + 0.5;
        let limits = ((f64::from(start) - centre).max(-r), (f64::from(end) - centre).min(r));
        // Far from borders one integral is as good as the next.
        if limits != last.0 {
            last = (limits, integral(filter, limits.0, limits.1));
        }
        last.1
    };
    (0..n).map(&mut integral_around).collect()
}

fn integral(filter: &Filter, from: f64, to: f64) -> f64 {
    let step = (to - from) / f64::from(PANELS);
    let value = |i: u32| f64::from(filter.profile((from + (f64::from(i) + 0.5) * step) as f32));
    (0..PANELS).map(value).sum::<f64>() * step
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integrals_by_hand() {
        // A box of one pixel to each side, and a tent: all of it inside, three quarters and ⅞ at the border.
        let close = |found: &[f64], expected: &[f64]| {
            assert_eq!(found.len(), expected.len());
            for (a, b) in found.iter().zip(expected) {
                assert!((a - b).abs() < 1e-6, "{found:?} is not {expected:?}");
            }
        };
        close(&integrals(&Filter::None, 3, 3), &[1.0; 3]);
        close(&integrals(&Filter::BOX, 2, 2), &[1.0; 2]);
        close(&integrals(&Filter::Box { radius: 1.0 }, 4, 4), &[1.5, 2.0, 2.0, 1.5]);
        close(&integrals(&Filter::Tent { radius: 1.0 }, 3, 3), &[0.875, 1.0, 0.875]);
        close(&integrals(&Filter::Tent { radius: 1.0 }, 4, 2), &[0.875; 4]);
        // The cubic integrates to 1 at its natural scale.
        close(&integrals(&Filter::MITCHELL, 7, 7)[3..4], &[1.0]);
    }
}
