//! Smooth functions through numbers on a grid: tensor products of cubic splines, twice differentiable.
//!
//! Along each axis the spline is that with uniform knots in the numbers and no knot in the last but one on either side ("not a knot"), so that
//! cubic polynomials are what they are, up to the ends. With its second differences `d` a spline through `f` has the coefficients
//!
//! ```text
//! c_i = f_i - d_i/6,    d_(i-1) + 4 d_i + d_(i+1) = 6 (f_(i-1) - 2 f_i + f_(i+1)),    d_0 = 2 d_1 - d_2
//! ```
//!
//! of uniform B-splines [de Boor 2001, chapter IV]. Fewer than four numbers along an axis make a parabola, a line or a constant.

use glam::DVec3;

/// A function on a box, three-dimensional.
#[derive(Clone, Debug)]
pub struct SplineGrid {
    /// Numbers along each axis, at least two: a single one stands twice.
    size: [usize; 3],
    /// Coefficients of the B-splines, two more along each axis; x first, then y.
    coefficients: Vec<f64>,
}

impl SplineGrid {
    /// Bytes of the coefficients for so many numbers along each axis; what is too many to count is the largest number.
    pub fn bytes(size: [u32; 3]) -> u64 {
        size.into_iter().fold(8, |bytes, n| bytes.saturating_mul(u64::from(n.max(2)) + 2))
    }

    /// The spline through numbers.
    ///
    /// * `values`: as many as there are points, x first, then y; at least one along each axis
    ///
    /// # Panics
    ///
    /// If there are more or fewer.
    pub fn new(size: [u32; 3], values: &[f32]) -> SplineGrid {
        let size = size.map(|n| n as usize);
        assert_eq!(values.len(), size.iter().product::<usize>());
        let mut coefficients: Vec<f64> = values.iter().map(|&value| f64::from(value)).collect();
        let (mut inner, mut outer) = (1, values.len());
        for n in size {
            outer /= n;
            coefficients = widened(&coefficients, [inner, n, outer]);
            inner *= n.max(2) + 2;
        }
        SplineGrid { size: size.map(|n| n.max(2)), coefficients }
    }

    /// The value and its derivatives at a place that is counted in numbers: whole coordinates from 0 are where those stand.
    /// Beyond the outermost ones it stays what it is there.
    pub fn at(&self, p: DVec3) -> (f64, DVec3) {
        let axes: [Basis; 3] = std::array::from_fn(|axis| Basis::at(p[axis], self.size[axis]));
        let [x, y, z] = &axes;
        let stride = [self.size[0] + 2, self.size[1] + 2];
        let (mut value, mut slope) = (0.0, DVec3::ZERO);
        for k in 0..4 {
            // Sums along x and y for this layer: of the value, and its derivatives by x and y.
            let mut layer = [0.0; 3];
            for j in 0..4 {
                let start = ((z.first + k) * stride[1] + y.first + j) * stride[0] + x.first;
                let row = &self.coefficients[start..start + 4];
                let sum = |weights: &[f64; 4]| {
                    weights[0] * row[0] + weights[1] * row[1] + weights[2] * row[2] + weights[3] * row[3]
                };
                let along = sum(&x.weights);
                layer[0] += y.weights[j] * along;
                layer[1] += y.weights[j] * sum(&x.slopes);
                layer[2] += y.slopes[j] * along;
            }
            value += z.weights[k] * layer[0];
            slope += DVec3::new(z.weights[k] * layer[1], z.weights[k] * layer[2], z.slopes[k] * layer[0]);
        }
        (value, slope)
    }
}

/// The four B-splines of an axis that are not zero at a place.
struct Basis {
    /// Which coefficient the first of them has.
    first: usize,
    weights: [f64; 4],
    slopes: [f64; 4],
}

impl Basis {
    fn at(x: f64, n: usize) -> Basis {
        let last = (n - 1) as f64;
        let inside = x.clamp(0.0, last);
        let cell = inside.floor().min(last - 1.0);
        let t = inside - cell;
        let s = 1.0 - t;
        let weights = [
            s * s * s / 6.0,
            (4.0 - 6.0 * t * t + 3.0 * t * t * t) / 6.0,
            (4.0 - 6.0 * s * s + 3.0 * s * s * s) / 6.0,
            t * t * t / 6.0,
        ];
        let slopes = if inside == x {
            [-0.5 * s * s, t * (1.5 * t - 2.0), s * (2.0 - 1.5 * s), 0.5 * t * t]
        } else {
            [0.0; 4]
        };
        Basis { first: cell as usize, weights, slopes }
    }
}

/// Coefficients along one axis, two more than numbers.
///
/// * `values`: `outer` times `n` rows of `inner` numbers
fn widened(values: &[f64], [inner, n, outer]: [usize; 3]) -> Vec<f64> {
    let stands = n.max(2);
    let mut all = vec![0.0; outer * (stands + 2) * inner];
    let mut line = vec![0.0; stands];
    let mut work = Line::default();
    for o in 0..outer {
        for i in 0..inner {
            for (k, f) in line.iter_mut().enumerate() {
                *f = values[(o * n + k.min(n - 1)) * inner + i];
            }
            let d = work.second_differences(&line);
            let c = |k: usize| line[k] - d[k] / 6.0;
            let mut put = |k: usize, value: f64| all[(o * (stands + 2) + k) * inner + i] = value;
            (0..stands).for_each(|k| put(k + 1, c(k)));
            let last = stands - 1;
            put(0, d[0] + 2.0 * c(0) - c(1));
            put(stands + 1, d[last] + 2.0 * c(last) - c(last - 1));
        }
    }
    all
}

/// Room for the solution of a line.
#[derive(Default)]
struct Line {
    d: Vec<f64>,
    /// What elimination leaves of the entries above the diagonal.
    above: Vec<f64>,
}

impl Line {
    /// Second differences of the coefficients of a spline through numbers.
    fn second_differences(&mut self, f: &[f64]) -> &[f64] {
        let n = f.len();
        let Line { d, above } = self;
        d.clear();
        d.resize(n, 0.0);
        above.clear();
        above.resize(n, 0.0);
        let curvature = |i: usize| f[i - 1] - 2.0 * f[i] + f[i + 1];
        if n < 3 {
            return d;
        }
        (d[1], d[n - 2]) = (curvature(1), curvature(n - 2));
        // Between these the system is tridiagonal [Thomas 1949].
        for i in 2..n.saturating_sub(2) {
            let pivot = 4.0 - above[i - 1];
            above[i] = 1.0 / pivot;
            d[i] = (6.0 * curvature(i) - d[i - 1]) / pivot;
        }
        for i in (2..n.saturating_sub(2)).rev() {
            d[i] -= above[i] * d[i + 1];
        }
        if n == 3 {
            (d[0], d[2]) = (d[1], d[1]);
        } else {
            (d[0], d[n - 1]) = (2.0 * d[1] - d[2], 2.0 * d[n - 2] - d[n - 3]);
        }
        d
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sampled(size: [u32; 3], f: impl Fn(DVec3) -> f64) -> SplineGrid {
        let mut values = Vec::new();
        for z in 0..size[2] {
            for y in 0..size[1] {
                values.extend((0..size[0]).map(|x| f(DVec3::new(x.into(), y.into(), z.into())) as f32));
            }
        }
        SplineGrid::new(size, &values)
    }

    /// Places inside of a grid, its corners among them.
    fn positions(size: [u32; 3]) -> impl Iterator<Item = DVec3> {
        (0..300).map(move |i| {
            let part = |k: u32| match i {
                0 => 0.0,
                1 => 1.0,
                _ => (f64::from(i) * [0.618_034, 0.754_878, 0.569_840][k as usize]).fract(),
            };
            DVec3::from([0, 1, 2].map(|k| part(k) * f64::from(size[k as usize] - 1)))
        })
    }

    /// Cubic polynomials with small whole coefficients are exact in single precision on the grid, and so is the spline everywhere.
    #[test]
    fn cubic_polynomials_are_what_they_are() {
        let one = |x: f64, k: i32| f64::from(k) - 2.0 * x + 0.5 * x * x - 0.25 * x * x * x;
        let slope = |x: f64| -2.0 + x - 0.75 * x * x;
        for size in [[6, 5, 4], [4, 9, 7], [5, 4, 12]] {
            let grid = sampled(size, |p| one(p.x, 1) * one(p.y, 2) * one(p.z, -1));
            for p in positions(size) {
                let [a, b, c] = [one(p.x, 1), one(p.y, 2), one(p.z, -1)];
                let exact = DVec3::new(slope(p.x) * b * c, a * slope(p.y) * c, a * b * slope(p.z));
                let (value, found) = grid.at(p);
                let size = 1.0 + (a * b * c).abs() + exact.length();
                assert!((value - a * b * c).abs() < 1e-6 * size, "{p}: {value} for {}", a * b * c);
                assert!((found - exact).length() < 1e-6 * size, "{p}: {found} for {exact}");
            }
        }
    }

    /// Few numbers along an axis are a constant, a line and a parabola; the numbers themselves are met.
    #[test]
    fn small_grids_are_polynomials() {
        let f = |p: DVec3| 3.0 + p.y + p.z * p.z;
        let size = [1, 2, 3];
        let grid = sampled(size, f);
        for p in positions(size) {
            let (value, slope) = grid.at(p);
            assert!((value - f(p)).abs() < 1e-12, "{p}: {value}");
            assert!((slope - DVec3::new(0.0, 1.0, 2.0 * p.z)).length() < 1e-12, "{p}: {slope}");
        }
        let single = SplineGrid::new([1, 1, 1], &[2.5]);
        let (value, slope) = single.at(DVec3::splat(7.0));
        assert!((value - 2.5).abs() < 1e-14 && slope == DVec3::ZERO, "{value} {slope}");
    }

    #[test]
    fn noise_is_met_and_joins_smoothly() {
        let size = [9, 8, 7];
        let f = |p: DVec3| ((12.9898 * p.x + 78.233 * p.y + 37.719 * p.z).sin() * 43758.5453).fract();
        let grid = sampled(size, f);
        let h = 1e-6;
        for z in 1..6 {
            for y in 1..7 {
                for x in 1..8 {
                    let p = DVec3::new(x.into(), y.into(), z.into());
                    assert!((grid.at(p).0 - f64::from(f(p) as f32)).abs() < 1e-12);
                    for axis in DVec3::AXES {
                        // The second derivative from either side of a knot.
                        let [a, b] =
                            [-1.0, 1.0].map(|s| s * (grid.at(p + s * h * axis).1 - grid.at(p).1) / h);
                        assert!((a - b).length() < 1e-4, "{p}: {a} {b}");
                    }
                }
            }
        }
    }

    /// Derivatives are those of the value.
    #[test]
    fn slopes_are_differences() {
        let size = [7, 6, 5];
        let grid = sampled(size, |p| (0.7 * p.x).sin() + (0.4 * p.y * p.z).cos());
        for p in positions(size).skip(2) {
            let (_, slope) = grid.at(p);
            let h = 1e-5;
            let found = DVec3::AXES.map(|e| (grid.at(p + h * e).0 - grid.at(p - h * e).0) / (2.0 * h));
            assert!((DVec3::from(found) - slope).length() < 1e-8, "{p}: {slope} for {found:?}");
        }
        // Outside it is as it is on the face.
        let (value, slope) = grid.at(DVec3::new(-3.0, 2.5, 1.5));
        assert_eq!((value, slope.x), (grid.at(DVec3::new(0.0, 2.5, 1.5)).0, 0.0));
    }
}
