//! Integrals of smooth functions.

/// The integral of `f` from `a` to `b` by Gauss-Legendre quadrature with five points: exact for polynomials of the ninth degree.
pub fn gauss5(a: f64, b: f64, f: impl Fn(f64) -> f64) -> f64 {
    const POINTS: [(f64, f64); 5] = [
        (0.0, 0.568_888_888_888_888_9),
        (-0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
        (0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
        (-0.906_179_845_938_664, 0.236_926_885_056_189_08),
        (0.906_179_845_938_664, 0.236_926_885_056_189_08),
    ];
    let half = 0.5 * (b - a);
    half * POINTS.into_iter().map(|(x, weight)| weight * f(a + half * (1.0 + x))).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_are_exact() {
        for degree in 0..=9 {
            let exact = (3f64.powi(degree + 1) - (-1f64).powi(degree + 1)) / f64::from(degree + 1);
            let found = gauss5(-1.0, 3.0, |x| x.powi(degree));
            assert!((found - exact).abs() < 1e-12 * exact.abs().max(1.0), "{degree}: {found} for {exact}");
        }
        assert!((gauss5(-1.0, 3.0, |x| x.powi(10)) - (3f64.powi(11) + 1.0) / 11.0).abs() > 1e-3);
    }
}
