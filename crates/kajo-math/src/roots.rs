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
}
