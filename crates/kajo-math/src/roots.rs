//! Real roots of polynomials, in double precision.

/// Real roots of `a t^2 + 2 h t + c`, smaller first.
///
/// `None` when there are none, or when `a` and `h` are both zero. A vanishing `a` gives the
/// single root of the linear equation twice. The larger root in magnitude is formed without
/// cancellation, the other from their product [Haines et al. 2019, eq. 5].
#[inline]
pub fn quadratic(a: f64, h: f64, c: f64) -> Option<(f64, f64)> {
    if a == 0.0 {
        let t = -c / (2.0 * h);
        return (h != 0.0).then_some((t, t));
    }
    let discriminant = h * h - a * c;
    if discriminant < 0.0 || discriminant.is_nan() {
        return None;
    }
    let q = -(h + discriminant.sqrt().copysign(h));
    let (t0, t1) = if q == 0.0 { (0.0, 0.0) } else { (q / a, c / q) };
    Some(if t0 <= t1 { (t0, t1) } else { (t1, t0) })
}

/// The Bernstein coefficients on [0, 1] of `a[0] + a[1] t + a[2] t^2 + ...`.
///
/// `b_i = sum_{k <= i} C(i, k) / C(n, k) a_k` [Farouki 2012, eq. 27].
pub fn bernstein_of<const N: usize>(a: &[f64; N]) -> [f64; N] {
    let degree = (N - 1) as f64;
    let mut scaled = *a;
    let mut binomial = 1.0;
    for (k, coefficient) in scaled.iter_mut().enumerate() {
        *coefficient /= binomial;
        binomial *= (degree - k as f64) / (k + 1) as f64;
    }
    // What Pascal's triangle makes of them, in place: a row of sums for each degree.
    for row in 1..N {
        for i in (row..N).rev() {
            scaled[i] += scaled[i - 1];
        }
    }
    scaled
}

/// Visits the places in [0, 1] where a polynomial changes its sign, in ascending order.
///
/// Zero counts as positive everywhere, so that the number of places visited is even exactly if the first and the last
/// coefficient have the same sign: two roots nearer to each other than their rounding are both found or both passed over.
///
/// Intervals are halved until the coefficients of one change their sign at most once: then there is one root or none, by
/// Descartes' rule [Collins and Akritas 1976].
///
/// * `b`: Bernstein coefficients on [0, 1]; for those that are not finite nothing is visited
pub fn sign_changes<const N: usize>(b: &[f64; N], mut visit: impl FnMut(f64)) {
    sign_changes_until(b, |t| {
        visit(t);
        false
    });
}

/// [`sign_changes`] until `visit` says that it is enough; whether it did.
#[inline]
pub fn sign_changes_until<const N: usize>(b: &[f64; N], mut visit: impl FnMut(f64) -> bool) -> bool {
    may_change_sign(b) && isolate(b, 0.0, 1.0, &mut visit)
}

/// Whether there is any place for [`sign_changes`] to visit, which is found without working it out.
#[inline]
pub fn changes_sign<const N: usize>(b: &[f64; N]) -> bool {
    may_change_sign(b) && has_change(b, 1.0)
}

/// Whether coefficients are finite and have not all the same sign.
#[inline]
fn may_change_sign<const N: usize>(b: &[f64; N]) -> bool {
    b.iter().any(|&x| (x < 0.0) != (b[0] < 0.0)) && b.iter().all(|x| x.is_finite())
}

/// Below this width all that is left of a polynomial is rounding.
const NARROWEST: f64 = 1.0 / (1u64 << 50) as f64;

/// How often the coefficients change their sign.
#[inline]
fn count_changes<const N: usize>(b: &[f64; N]) -> usize {
    b.windows(2).filter(|pair| (pair[0] < 0.0) != (pair[1] < 0.0)).count()
}

/// Whether there is a sign change on an interval of a width, whose coefficients are `b`.
fn has_change<const N: usize>(b: &[f64; N], width: f64) -> bool {
    if (b[0] < 0.0) != (b[N - 1] < 0.0) {
        return true;
    }
    if count_changes(b) == 0 || width <= NARROWEST {
        return false;
    }
    let (left, right) = halves(b);
    has_change(&left, 0.5 * width) || has_change(&right, 0.5 * width)
}

/// Visits the sign changes on the interval from `lo` of a width, whose coefficients are `b`, until it is enough.
fn isolate<const N: usize>(b: &[f64; N], lo: f64, width: f64, visit: &mut dyn FnMut(f64) -> bool) -> bool {
    let changes = count_changes(b);
    if changes == 0 {
        return false;
    }
    if changes == 1 {
        return visit(lo + width * single_root(b));
    }
    if width <= NARROWEST {
        return (b[0] < 0.0) != (b[N - 1] < 0.0) && visit(lo + 0.5 * width);
    }
    let (left, right) = halves(b);
    isolate(&left, lo, 0.5 * width, visit) || isolate(&right, lo + 0.5 * width, 0.5 * width, visit)
}

/// The coefficients of both halves of the interval, by de Casteljau's algorithm. They share the value in the middle.
fn halves<const N: usize>(b: &[f64; N]) -> ([f64; N], [f64; N]) {
    let (mut left, mut right) = (*b, *b);
    for (level, last) in left.iter_mut().enumerate().skip(1) {
        for i in 0..N - level {
            right[i] = 0.5 * (right[i] + right[i + 1]);
        }
        *last = right[0];
    }
    (left, right)
}

/// The only root of a polynomial whose ends differ in sign.
fn single_root<const N: usize>(b: &[f64; N]) -> f64 {
    // An end that is all but zero may be beside another root, beyond it, at which Newton's method would stay.
    const BESIDE: f64 = 1e-9;
    let chord = b[0] / (b[0] - b[N - 1]);
    let start = if (BESIDE..=1.0 - BESIDE).contains(&chord) { chord } else { 0.5 };
    bracketed([0.0, 1.0], start, b[0] < 0.0, f64::EPSILON, |t| value_and_slope(b, t))
}

/// A place where a function changes its sign, of which it has different ones at the ends of a bracket: Newton's method,
/// kept within the bracket by bisection.
///
/// * `start`: a place in the bracket to begin with
/// * `rises`: whether it is negative at the lower end
/// * `tolerance`: when a step is shorter than this part of the place it is the last one
/// * `f`: value and derivative
pub fn bracketed(
    [mut lo, mut hi]: [f64; 2],
    start: f64,
    rises: bool,
    tolerance: f64,
    f: impl Fn(f64) -> (f64, f64),
) -> f64 {
    const MOST_STEPS: u32 = 64;
    let mut t = start;
    for _ in 0..MOST_STEPS {
        let (value, slope) = f(t);
        if (value < 0.0) == rises {
            lo = t;
        } else {
            hi = t;
        }
        let newton = t - value / slope;
        if (newton - t).abs() <= tolerance * t.abs() {
            return t;
        }
        t = if newton > lo && newton < hi { newton } else { 0.5 * (lo + hi) };
    }
    t
}

/// Value and derivative at `t`, by de Casteljau's algorithm.
#[inline]
fn value_and_slope<const N: usize>(b: &[f64; N], t: f64) -> (f64, f64) {
    let (mut row, s) = (*b, 1.0 - t);
    for level in 1..N - 1 {
        for i in 0..N - level {
            row[i] = s * row[i] + t * row[i + 1];
        }
    }
    (s * row[0] + t * row[1], (N - 1) as f64 * (row[1] - row[0]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roots_survive_cancellation() {
        // (t - 1e-8)(t - 1e8)
        let (lo, hi) = quadratic(1.0, -0.5 * (1e8 + 1e-8), 1.0).unwrap();
        assert!((lo / 1e-8 - 1.0).abs() < 1e-14 && (hi / 1e8 - 1.0).abs() < 1e-14);
        assert_eq!(quadratic(1.0, 0.0, 1.0), None);
        assert_eq!(quadratic(0.0, 1.0, -4.0), Some((2.0, 2.0)));
        assert_eq!(quadratic(0.0, 0.0, 1.0), None);
        assert_eq!(quadratic(1.0, 0.0, 0.0), Some((0.0, 0.0)));
    }

    fn roots_of<const N: usize>(power: [f64; N]) -> Vec<f64> {
        let mut found = Vec::new();
        sign_changes(&bernstein_of(&power), |t| found.push(t));
        found
    }

    /// The coefficients of the product of `t - r`.
    fn product<const N: usize>(roots: &[f64]) -> [f64; N] {
        let mut a = [0.0; N];
        a[0] = 1.0;
        for (degree, root) in roots.iter().enumerate() {
            for i in (0..=degree + 1).rev() {
                a[i] = if i > 0 { a[i - 1] } else { 0.0 } - root * a[i];
            }
        }
        a
    }

    #[test]
    fn all_roots_in_the_interval_are_found_in_order() {
        let roots = [0.125, 0.25, 0.375, 0.875];
        let found = roots_of(product::<5>(&roots));
        assert!(found.len() == 4 && found.iter().zip(roots).all(|(a, b)| (a - b).abs() < 1e-14), "{found:?}");
        assert_eq!(roots_of(product::<5>(&[-0.5, 0.5, 1.5, 2.0])).len(), 1);
        assert_eq!(roots_of(product::<5>(&[-0.5, -0.25, 1.5, 2.0])).len(), 0);
    }

    /// Roots of Chebyshev's polynomial of degree 8, moved to [0, 1]: `(1 + cos((2 k + 1) pi / 16)) / 2`.
    #[test]
    fn roots_of_a_chebyshev_polynomial() {
        let t8 = [1.0, -128.0, 2688.0, -21504.0, 84480.0, -180224.0, 212992.0, -131072.0, 32768.0];
        let found = roots_of::<9>(t8);
        assert_eq!(found.len(), 8);
        for (k, root) in found.iter().enumerate() {
            let angle = f64::from(15 - 2 * k as u32) * std::f64::consts::PI / 16.0;
            assert!((root - 0.5 * (1.0 + angle.cos())).abs() < 1e-12, "{root}");
        }
    }

    /// Two roots that draw nearer until they are one and none: two or none are found.
    #[test]
    fn roots_that_touch_come_in_pairs() {
        for exponent in 1..60 {
            let gap = 0.3 * f64::powi(0.5, exponent);
            for middle in [0.5, 0.37, 0.7112] {
                let found = roots_of(product::<5>(&[middle - gap, middle + gap, 2.0, 3.0]));
                assert!(found.is_empty() || found.len() == 2, "{gap}: {found:?}");
                let separate =
                    gap < 1e-7 || (found.len() == 2 && (found[1] - found[0] - 2.0 * gap).abs() < 1e-8);
                assert!(separate, "{gap}: {found:?}");
            }
        }
        assert_eq!(roots_of([0.25, -1.0, 1.0]).len(), 0);
        assert_eq!(roots_of([-0.25, 1.0, -1.0]).len() % 2, 0);
    }

    /// A root inside, and another at an end or just beyond: the first is where the sign changes.
    #[test]
    fn roots_at_ends_do_not_hide_those_inside() {
        for beyond in [0.0, 1e-18, 1e-16, 1e-12, 1e-6] {
            let found = roots_of(product::<4>(&[0.75, 1.0 + beyond, 3.0]));
            assert!(found.len() == 1 && (found[0] - 0.75).abs() < 1e-14, "{beyond}: {found:?}");
            // An end of zero counts as positive, so the sign changes there as well.
            let found = roots_of(product::<4>(&[-beyond, 0.25, 3.0]).map(|a| -a));
            let at_end = usize::from(beyond == 0.0);
            assert!(found.len() == 1 + at_end && (found[at_end] - 0.25).abs() < 1e-14, "{beyond}: {found:?}");
        }
    }

    /// Whether there is a change is what visiting them says.
    #[test]
    fn changes_are_there_where_they_are_visited() {
        for i in 0..20_000 {
            let s = crate::rng::Stream::new(101, [i, 0], 0);
            let b: [f64; 5] = std::array::from_fn(|k| {
                let x = 2.0 * f64::from(s.uniform(k as u32)) - 0.8;
                if i % 3 == 0 { x * x } else { x }
            });
            // Two roots that are nearly one, too.
            let b = if i % 5 == 0 { bernstein_of(&[0.25 * b[0] * b[0], -b[0], 1.0, 0.0, 0.0]) } else { b };
            let mut count = 0;
            sign_changes(&b, |_| count += 1);
            assert_eq!(changes_sign(&b), count > 0, "{b:?}");
        }
        assert!(!changes_sign(&[f64::NAN, 1.0, -2.0]) && !changes_sign(&[-1.0, f64::INFINITY, 0.0]));
    }

    #[test]
    fn numbers_that_are_none_have_no_roots() {
        assert!(roots_of([f64::NAN, 1.0, -2.0]).is_empty() && roots_of([0.0; 4]).is_empty());
        assert!(roots_of([-1.0, f64::INFINITY, 0.0]).is_empty());
    }
}
