//! Integrals in one dimension, for formulas that end in one.

/// The integral of `f` from `a` to `b` by Simpson's rule on `2 n` intervals.
pub fn simpson(a: f64, b: f64, n: u32, f: impl Fn(f64) -> f64) -> f64 {
    let h = (b - a) / f64::from(2 * n);
    let inner: f64 = (1..2 * n).map(|i| f(a + f64::from(i) * h) * if i % 2 == 1 { 4.0 } else { 2.0 }).sum();
    (f(a) + inner + f(b)) * h / 3.0
}

/// The place between `a` and `b` where `f`, which changes its sign between them, is zero.
pub fn zero(mut a: f64, mut b: f64, f: impl Fn(f64) -> f64) -> f64 {
    let rises = f(a) < 0.0;
    for _ in 0..200 {
        let middle = 0.5 * (a + b);
        if (f(middle) < 0.0) == rises { a = middle } else { b = middle }
    }
    0.5 * (a + b)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cubics_are_exact_and_zeros_are_found() {
        assert!((simpson(0.0, 2.0, 1, |x| x * x * x) - 4.0).abs() < 1e-14);
        assert!((zero(0.0, 2.0, |x| x * x - 2.0) - 2f64.sqrt()).abs() < 1e-15);
        assert!((zero(0.0, 2.0, |x| 2.0 - x * x) - 2f64.sqrt()).abs() < 1e-15);
    }
}
