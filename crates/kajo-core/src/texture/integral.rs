//! Integrals of functions of one number that are cubics between given places, and the same before and after all of them.
//!
//! What is linear, smooth or a step between places is such a cubic, and so is linear light of what is linear in Oklab: it is the
//! sum of third powers there. Squares of these are of the sixth degree. Gauss-Legendre quadrature with four points, exact up to
//! the seventh, integrates each piece, and sums over whole pieces are tabulated.

/// The integral of `N` functions, which are handed in again wherever it is asked.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Integral<const N: usize> {
    /// Where pieces meet, none less than the one before; at least one.
    places: Vec<f32>,
    /// The integrals from the first place to each.
    sums: Vec<[f64; N]>,
}

/// Places in [-1, 1] and weights.
const POINTS: [(f64, f64); 4] = [
    (-0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
    (-0.339_981_043_584_856_26, 0.652_145_154_862_546_1),
    (0.339_981_043_584_856_26, 0.652_145_154_862_546_1),
    (0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
];

fn plus<const N: usize>(a: [f64; N], b: [f64; N]) -> [f64; N] {
    std::array::from_fn(|i| a[i] + b[i])
}

/// Over a piece.
fn gauss<const N: usize>(lo: f64, hi: f64, f: impl Fn(f32) -> [f32; N]) -> [f64; N] {
    let (middle, half) = (0.5 * (lo + hi), 0.5 * (hi - lo));
    POINTS.into_iter().fold([0.0; N], |sum, (x, weight)| {
        let values = f((middle + half * x) as f32);
        std::array::from_fn(|i| sum[i] + half * weight * f64::from(values[i]))
    })
}

impl<const N: usize> Integral<N> {
    /// The integral of `f`.
    ///
    /// * `places`: where its pieces meet, none less than the one before; at least one
    pub fn new(places: Vec<f32>, f: impl Fn(f32) -> [f32; N]) -> Integral<N> {
        let mut sum = [0.0; N];
        let mut sums = vec![sum];
        for pair in places.windows(2) {
            sum = plus(sum, gauss(pair[0].into(), pair[1].into(), &f));
            sums.push(sum);
        }
        Integral { places, sums }
    }

    /// Over an interval, `lo` no more than `hi`.
    pub fn over(&self, lo: f64, hi: f64, f: impl Fn(f32) -> [f32; N]) -> [f64; N] {
        let after = |t: f64| self.places.partition_point(|&place| f64::from(place) <= t);
        let (first, end) = (after(lo), after(hi));
        if first == end {
            return gauss(lo, hi, f);
        }
        // The places from `first` to `last` are within.
        let last = end - 1;
        let (from, to) = (f64::from(self.places[first]), f64::from(self.places[last]));
        let whole: [f64; N] = std::array::from_fn(|i| self.sums[last][i] - self.sums[first][i]);
        plus(plus(gauss(lo, from, &f), whole), gauss(to, hi, &f))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pieces of the sixth degree, with a jump.
    fn of(t: f32) -> [f32; 2] {
        match t {
            t if t < 0.25 => [1.0, -2.0],
            t if t < 0.5 => [t.powi(6), t],
            t if t < 1.0 => [3.0 - t * t, 0.5],
            _ => [2.0, 0.5],
        }
    }

    #[test]
    fn pieces_are_integrated_exactly() {
        let integral = Integral::new(vec![0.25, 0.5, 0.5, 1.0], of);
        // Antiderivatives that are 0 at 0.
        let exact = |t: f64| {
            let pieces = [t.min(0.25), t.clamp(0.25, 0.5), t.clamp(0.5, 1.0), t.max(1.0)];
            let [a, b, c, d] = pieces;
            let first = a + (b.powi(7) - 0.25f64.powi(7)) / 7.0;
            let first = first + 3.0 * (c - 0.5) - (c.powi(3) - 0.125) / 3.0 + 2.0 * (d - 1.0);
            [first, -2.0 * a + 0.5 * (b * b - 0.0625) + 0.5 * (c - 0.5) + 0.5 * (d - 1.0)]
        };
        let ends = [-3.0, 0.0, 0.1, 0.25, 0.3, 0.31, 0.5, 0.75, 1.0, 1.5, 2.0];
        for (lo, hi) in ends.into_iter().flat_map(|lo| ends.map(|hi| (lo, hi))).filter(|(lo, hi)| lo <= hi) {
            let (found, [a, b]) = (integral.over(lo, hi, of), [exact(lo), exact(hi)]);
            for i in 0..2 {
                assert!((found[i] - (b[i] - a[i])).abs() < 1e-6, "{lo} {hi}: {found:?} {a:?} {b:?}");
            }
        }
    }
}
