//! Summed-area tables [Crow 1984]: means over boxes of any size at the same cost.
//!
//! ```text
//! S(x, y) = sum over i < x, j < y of  T(i, j)
//! sum over [x0, x1) x [y0, y1) = S(x1, y1) - S(x0, y1) - S(x1, y0) + S(x0, y0)
//! ```
//!
//! Sums of the 16-bit numbers of texels are kept in 64 bits, which are exact. Within a texel the sum is bilinear, which is
//! the integral of a picture whose texels are squares. Beyond its edges a coordinate is a combination of some of the picture's own: whole
//! repetitions are counted.

use kajo_math::Vec2;

use super::{Picture, Wrap};

/// A table of sums over all texels above and to the left.
#[derive(Debug)]
pub(super) struct SummedAreaTable {
    width: u32,
    height: u32,
    sums: Vec<[u64; 4]>,
}

/// A coordinate as a combination of coordinates within the picture.
type Combination = [(f64, f64); 3];

impl SummedAreaTable {
    /// Bytes that the table of a picture takes.
    pub fn bytes(width: u32, height: u32) -> u64 {
        (u64::from(width) + 1) * (u64::from(height) + 1) * size_of::<[u64; 4]>() as u64
    }

    pub fn of(picture: &Picture) -> SummedAreaTable {
        let (w, h) = (picture.width as usize, picture.height as usize);
        let stride = w + 1;
        let mut sums = vec![[0u64; 4]; stride * (h + 1)];
        for y in 0..h {
            let mut row = [0u64; 4];
            for x in 0..w {
                let texel = picture.stored(x, y);
                for c in 0..4 {
                    row[c] += u64::from(texel[c]);
                    sums[(y + 1) * stride + x + 1][c] = sums[y * stride + x + 1][c] + row[c];
                }
            }
        }
        SummedAreaTable { width: picture.width, height: picture.height, sums }
    }

    /// The mean over a box, in [0, 1].
    ///
    /// * `low`, `high`: its corners in texels from the upper left
    pub fn mean(&self, low: Vec2, high: Vec2, wrap: [Wrap; 2]) -> [f32; 4] {
        let [x0, x1] = [low.x, high.x].map(|x| combined(x.into(), self.width, wrap[0]));
        let [y0, y1] = [low.y, high.y].map(|y| combined(y.into(), self.height, wrap[1]));
        let area = f64::from(high.x - low.x) * f64::from(high.y - low.y);
        let [a, b, c, d] = [(&x1, &y1), (&x0, &y1), (&x1, &y0), (&x0, &y0)].map(|(x, y)| self.integral(x, y));
        std::array::from_fn(|i| (((a[i] - b[i] - c[i] + d[i]) / (65535.0 * area)).clamp(0.0, 1.0)) as f32)
    }

    fn integral(&self, x: &Combination, y: &Combination) -> [f64; 4] {
        let mut sum = [0.0; 4];
        for &(b, y) in y.iter().filter(|(b, _)| *b != 0.0) {
            for &(a, x) in x.iter().filter(|(a, _)| *a != 0.0) {
                let part = self.within(x, y);
                (0..4).for_each(|c| sum[c] += a * b * part[c]);
            }
        }
        sum
    }

    /// The integral from the upper left corner to a place within the picture.
    fn within(&self, x: f64, y: f64) -> [f64; 4] {
        let (i, j) = ((x as usize).min(self.width as usize - 1), (y as usize).min(self.height as usize - 1));
        let (a, b) = (x - i as f64, y - j as f64);
        let stride = self.width as usize + 1;
        let corner = |i: usize, j: usize| self.sums[j * stride + i];
        let [p, q, r, s] = [corner(i, j), corner(i + 1, j), corner(i, j + 1), corner(i + 1, j + 1)];
        std::array::from_fn(|c| {
            let [p, q, r, s] = [p, q, r, s].map(|sums| sums[c] as f64);
            (1.0 - b) * (p + a * (q - p)) + b * (r + a * (s - r))
        })
    }
}

/// The integral from 0 to `x` over a picture of `n` texels and what is beside it, by integrals from 0 to places within.
fn combined(x: f64, n: u32, wrap: Wrap) -> Combination {
    let n = f64::from(n);
    const NONE: (f64, f64) = (0.0, 0.0);
    match wrap {
        Wrap::Repeat => {
            let periods = (x / n).floor();
            [(periods, n), (1.0, (x - periods * n).clamp(0.0, n)), NONE]
        }
        Wrap::Mirror => {
            let periods = (x / (2.0 * n)).floor();
            let rest = (x - 2.0 * n * periods).clamp(0.0, 2.0 * n);
            if rest <= n {
                [(2.0 * periods, n), (1.0, rest), NONE]
            } else {
                [(2.0 * periods + 2.0, n), (-1.0, 2.0 * n - rest), NONE]
            }
        }
        Wrap::Clamp if x < 0.0 => [(x, 1.0), NONE, NONE],
        Wrap::Clamp if x > n => [(1.0 + (x - n), n), (n - x, n - 1.0), NONE],
        Wrap::Clamp | Wrap::Black | Wrap::Once => [(1.0, x.clamp(0.0, n)), NONE, NONE],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo_math::rng::Stream;

    const SIZE: (u32, u32) = (23, 17);

    fn noise() -> Picture {
        Picture::from_fn(SIZE.0, SIZE.1, |x, y| {
            let s = Stream::new(5, [x, y], 0);
            [s.uniform(0), s.uniform(1), s.uniform(2), s.uniform(3)]
        })
    }

    /// Boxes of whole texels, inside and over all edges, against sums of integers.
    #[test]
    fn sums_of_boxes_are_exact() {
        let picture = noise();
        let table = SummedAreaTable::of(&picture);
        for i in 0..10_000u32 {
            let s = Stream::new(6, [i, 0], 0);
            let wrap = [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp, Wrap::Black, Wrap::Once][(i % 5) as usize];
            let place = |k: u32| (120.0 * s.uniform(k)) as i64 - 60;
            let (x0, y0) = (place(0), place(1));
            let (x1, y1) = (x0 + 1 + (50.0 * s.uniform(2)) as i64, y0 + 1 + (50.0 * s.uniform(3)) as i64);
            let mut sum = [0u64; 4];
            for y in y0..y1 {
                for x in x0..x1 {
                    let (Some(x), Some(y)) = (wrap.index_far(x, SIZE.0), wrap.index_far(y, SIZE.1)) else {
                        continue;
                    };
                    let texel = picture.stored(x, y);
                    (0..4).for_each(|c| sum[c] += u64::from(texel[c]));
                }
            }
            let [x0c, x1c] = [x0, x1].map(|x| combined(x as f64, SIZE.0, wrap));
            let [y0c, y1c] = [y0, y1].map(|y| combined(y as f64, SIZE.1, wrap));
            let [a, b, c, d] =
                [(&x1c, &y1c), (&x0c, &y1c), (&x1c, &y0c), (&x0c, &y0c)].map(|(x, y)| table.integral(x, y));
            let found: [f64; 4] = std::array::from_fn(|i| a[i] - b[i] - c[i] + d[i]);
            assert_eq!(found, sum.map(|sum| sum as f64), "{wrap:?} {x0} {x1} {y0} {y1}");
        }
    }

    /// Parts of texels count by their area.
    #[test]
    fn boxes_of_parts_of_texels_are_integrals() {
        let picture = noise();
        let table = SummedAreaTable::of(&picture);
        let value = |x: i64, y: i64| {
            let (Some(x), Some(y)) = (Wrap::Repeat.index_far(x, SIZE.0), Wrap::Repeat.index_far(y, SIZE.1))
            else {
                return 0.0;
            };
            f64::from(picture.stored(x, y)[0]) / 65535.0
        };
        let (low, high) = (Vec2::new(20.25, -1.5), Vec2::new(24.5, 1.75));
        let part = |i: i64, low: f32, high: f32| ((i + 1) as f32).min(high) - (i as f32).max(low);
        let mut sum = 0.0;
        for (x, y) in (20..25).flat_map(|x| (-2..2).map(move |y| (x, y))) {
            sum += value(x, y) * f64::from(part(x, low.x, high.x) * part(y, low.y, high.y));
        }
        let expected = sum / f64::from((high - low).element_product());
        let found = f64::from(table.mean(low, high, [Wrap::Repeat; 2])[0]);
        assert!((found - expected).abs() < 1e-6, "{found} {expected}");
    }
}
