//! What a line has inside of the balls along a curve.
//!
//! With `c(s)` and `r(s)` polynomials of degree `n`, a line `o + t d` of unit speed is within the ball at `s` between
//!
//! ```text
//! t = B(s) ± sqrt(D(s)),    B = (c - o) . d,    D = r² - |c - o - B d|².
//! ```
//!
//! Over a stretch of `s` on which `D` is not negative both ends change steadily, so the union of these pieces is one piece, from the
//! least `t` to the largest. The stretches end at roots of `D`, of degree `2 n`; the least and the largest `t` are at ends of the stretch or
//! where a derivative vanishes,
//!
//! ```text
//! 4 B'² D - D'² = 0,
//! ```
//!
//! of degree `4 n - 2`, 10 for cubics. That is the envelope without solving for it: a root that is not found because two fall together
//! is no extremum, and costs nothing.

use kajo_math::{DVec3, DVec4, roots};

use super::Bezier;

/// A piece of a line, with the places on the curve of the balls at its ends.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chord {
    pub t: [f64; 2],
    pub s: [f64; 2],
}

/// Visits the pieces of a line within the balls along a curve, of which there are at most as many as its degree and one.
///
/// * `o`, `d`: the line; `o` near the curve, `d` of unit length
pub(super) fn chords(curve: &Bezier<DVec4>, o: DVec3, d: DVec3, visit: impl FnMut(Chord)) {
    match *curve.points() {
        [a, b] => Pencil::<2, 3, 1>::new([a, b], o, d).chords::<1, 3>(visit),
        [a, b, c] => Pencil::<3, 5, 2>::new([a, b, c], o, d).chords::<3, 7>(visit),
        [a, b, c, e] => Pencil::<4, 7, 3>::new([a, b, c, e], o, d).chords::<5, 11>(visit),
        _ => {}
    }
}

/// A line and the balls along a curve: Bernstein coefficients of `B`, `D` and `B'`.
struct Pencil<const N: usize, const M: usize, const L: usize> {
    middle: [f64; N],
    inside: [f64; M],
    drift: [f64; L],
}

impl<const N: usize, const M: usize, const L: usize> Pencil<N, M, L> {
    fn new(points: [DVec4; N], o: DVec3, d: DVec3) -> Self {
        let from_o = points.map(|p| p.truncate() - o);
        let middle = from_o.map(|w| w.dot(d));
        let off: [DVec3; N] = std::array::from_fn(|i| from_o[i] - middle[i] * d);
        let mut inside = [0.0; M];
        for i in 0..N {
            for j in 0..N {
                let share = binomial(N - 1, i) * binomial(N - 1, j) / binomial(M - 1, i + j);
                inside[i + j] += share * (points[i].w * points[j].w - off[i].dot(off[j]));
            }
        }
        Pencil { middle, inside, drift: derivative(&middle) }
    }

    /// * `K`: coefficients of `B'²`; `P`: of the polynomial of the extrema
    fn chords<const K: usize, const P: usize>(&self, mut visit: impl FnMut(Chord)) {
        if self.inside.iter().all(|d| *d < 0.0) || !self.inside.iter().all(|d| d.is_finite()) {
            return;
        }
        let extrema = self.extrema::<K, P>();
        let mut from = (self.inside[0] >= 0.0).then_some(0.0);
        let mut stretch = |from: f64, to: f64| {
            let mut chord = Chord { t: [f64::INFINITY, f64::NEG_INFINITY], s: [from, to] };
            let mut add = |s: f64| {
                let (middle, half) = (value(&self.middle, s), value(&self.inside, s).max(0.0).sqrt());
                if middle - half < chord.t[0] {
                    (chord.t[0], chord.s[0]) = (middle - half, s);
                }
                if middle + half > chord.t[1] {
                    (chord.t[1], chord.s[1]) = (middle + half, s);
                }
            };
            add(from);
            roots::sign_changes(&extrema, |s| {
                if s > from && s < to {
                    add(s);
                }
            });
            add(to);
            visit(chord);
        };
        roots::sign_changes(&self.inside, |s| {
            from = match from {
                Some(from) => {
                    stretch(from, s);
                    None
                }
                None => Some(s),
            };
        });
        if let Some(from) = from {
            stretch(from, 1.0);
        }
    }

    /// The coefficients of `4 B'² D - D'²`.
    fn extrema<const K: usize, const P: usize>(&self) -> [f64; P] {
        let squared: [f64; K] = product(&self.drift, &self.drift);
        let mut extrema: [f64; P] = product(&squared, &self.inside);
        // D' has one coefficient less than D.
        let slope = derivative_of(&self.inside);
        let slope = &slope[..M - 1];
        for (i, a) in slope.iter().enumerate() {
            for (j, b) in slope.iter().enumerate() {
                let share = binomial(M - 2, i) * binomial(M - 2, j) / binomial(P - 1, i + j);
                extrema[i + j] -= 0.25 * share * a * b;
            }
        }
        extrema
    }
}

/// The coefficients of the derivative: one less.
fn derivative<const N: usize, const L: usize>(b: &[f64; N]) -> [f64; L] {
    std::array::from_fn(|i| (N - 1) as f64 * (b[i + 1] - b[i]))
}

/// The same with a zero behind them.
fn derivative_of<const M: usize>(b: &[f64; M]) -> [f64; M] {
    std::array::from_fn(|i| if i + 1 < M { (M - 1) as f64 * (b[i + 1] - b[i]) } else { 0.0 })
}

/// The coefficients of a product of two polynomials [Farouki 2012, eq. 44].
fn product<const A: usize, const B: usize, const C: usize>(a: &[f64; A], b: &[f64; B]) -> [f64; C] {
    let mut out = [0.0; C];
    for i in 0..A {
        for j in 0..B {
            out[i + j] += binomial(A - 1, i) * binomial(B - 1, j) / binomial(C - 1, i + j) * a[i] * b[j];
        }
    }
    out
}

/// How many ways there are to choose `k` of up to ten things.
const fn binomial(n: usize, k: usize) -> f64 {
    const PASCAL: [[f64; 11]; 11] = {
        let mut rows = [[0.0; 11]; 11];
        let mut n = 0;
        while n < 11 {
            rows[n][0] = 1.0;
            let mut k = 1;
            while k <= n {
                rows[n][k] = rows[n - 1][k - 1] + rows[n - 1][k];
                k += 1;
            }
            n += 1;
        }
        rows
    };
    PASCAL[n][k]
}

/// The value of a polynomial, by de Casteljau's algorithm.
fn value<const N: usize>(b: &[f64; N], s: f64) -> f64 {
    let mut row = *b;
    for level in 1..N {
        for i in 0..N - level {
            row[i] = (1.0 - s) * row[i] + s * row[i + 1];
        }
    }
    row[0]
}
