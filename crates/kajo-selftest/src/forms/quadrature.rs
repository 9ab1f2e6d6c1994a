//! Integrals in one dimension, for formulas that end in one.

use std::f64::consts::PI;

/// The integral of `f` from `a` to `b` by Simpson's rule on `2 n` intervals.
pub fn simpson(a: f64, b: f64, n: u32, f: impl Fn(f64) -> f64) -> f64 {
    let h = (b - a) / f64::from(2 * n);
    let inner: f64 = (1..2 * n).map(|i| f(a + f64::from(i) * h) * if i % 2 == 1 { 4.0 } else { 2.0 }).sum();
    (f(a) + inner + f(b)) * h / 3.0
}

/// The places in `[-1, 1]` and the weights of Gauss's rule with `n` points: the zeros of Legendre's polynomial, by Newton's method.
pub fn gauss_legendre(n: u32) -> Vec<[f64; 2]> {
    let point = |k: u32| {
        let mut x = (PI * (f64::from(k) + 0.75) / (f64::from(n) + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..100 {
            let (mut before, mut value) = (1.0, x);
            for i in 1..n {
                let i = f64::from(i);
                (before, value) = (value, ((2.0 * i + 1.0) * x * value - i * before) / (i + 1.0));
            }
            slope = f64::from(n) * (x * value - before) / (x * x - 1.0);
            x -= value / slope;
        }
        [x, 2.0 / ((1.0 - x * x) * slope * slope)]
    };
    (0..n).map(point).collect()
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
    fn polynomials_are_exact_and_zeros_are_found() {
        assert!((simpson(0.0, 2.0, 1, |x| x * x * x) - 4.0).abs() < 1e-14);
        let sixth = |points: Vec<[f64; 2]>| points.iter().map(|[x, weight]| weight * x.powi(6)).sum::<f64>();
        assert!((sixth(gauss_legendre(4)) - 2.0 / 7.0).abs() < 1e-14);
        assert!((zero(0.0, 2.0, |x| x * x - 2.0) - 2f64.sqrt()).abs() < 1e-15);
        assert!((zero(0.0, 2.0, |x| 2.0 - x * x) - 2f64.sqrt()).abs() < 1e-15);
    }
}
