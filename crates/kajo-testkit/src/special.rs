//! The incomplete gamma and beta functions, for tests only: it uses the system's maths library.

use std::f64::consts::PI;

/// Natural logarithm of Γ(x) for `x > 0`, to 1e-13: Lanczos's series with g = 7 and nine terms. [Lanczos 1964]
pub fn ln_gamma(x: f64) -> f64 {
    const TERMS: [f64; 8] = [
        676.520_368_121_885_1,
        -1_259.139_216_722_402_8,
        771.323_428_777_653_1,
        -176.615_029_162_140_6,
        12.507_343_278_686_905,
        -0.138_571_095_265_720_12,
        9.984_369_578_019_572e-6,
        1.505_632_735_149_311_6e-7,
    ];
    let x = x - 1.0;
    let t = x + 7.5;
    let series: f64 = (1..).zip(TERMS).map(|(i, c)| c / (x + f64::from(i))).sum();
    0.5 * (2.0 * PI).ln() + (x + 0.5) * t.ln() - t + (0.999_999_999_999_809_9 + series).ln()
}

/// The upper incomplete gamma function over the whole, `Q(a, x) = Γ(a, x) / Γ(a)`, for `a > 0`, `x >= 0`.
///
/// Below `a + 1` by the series of `1 - Q`, above by Lentz's continued fraction. [Press et al. 2007, sec. 6.2]
pub fn upper_gamma(a: f64, x: f64) -> f64 {
    if x <= 0.0 {
        return 1.0;
    }
    let scale = (a * x.ln() - x - ln_gamma(a)).exp();
    if x < a + 1.0 {
        let mut term = 1.0 / a;
        let mut sum = term;
        let mut n = a;
        while term > sum * 1e-16 {
            n += 1.0;
            term *= x / n;
            sum += term;
        }
        return 1.0 - scale * sum;
    }
    let mut b = x + 1.0 - a;
    let mut c = 1e300;
    let mut d = 1.0 / b;
    let mut fraction = d;
    for i in 1..10_000 {
        let i = f64::from(i);
        let numerator = -i * (i - a);
        b += 2.0;
        d = 1.0 / (numerator * d + b);
        c = b + numerator / c;
        fraction *= c * d;
        if (c * d - 1.0).abs() < 1e-15 {
            break;
        }
    }
    scale * fraction
}

/// The incomplete beta function over the whole, `I_x(a, b)`, for `0 <= x <= 1` and positive `a` and `b`.
///
/// By Lentz's continued fraction, from the end at which it converges fast. [Press et al. 2007, sec. 6.4]
pub fn beta(x: f64, a: f64, b: f64) -> f64 {
    if x <= 0.0 || x >= 1.0 {
        return x.clamp(0.0, 1.0);
    }
    if x > (a + 1.0) / (a + b + 2.0) {
        return 1.0 - beta(1.0 - x, b, a);
    }
    let scale = (ln_gamma(a + b) - ln_gamma(a) - ln_gamma(b) + a * x.ln() + b * (1.0 - x).ln()).exp() / a;
    let (mut c, mut d) = (1.0, 1.0 / (1.0 - (a + b) * x / (a + 1.0)));
    let mut fraction = d;
    for m in 1..10_000 {
        let m = f64::from(m);
        let even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
        let odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        let mut step = 1.0;
        for numerator in [even, odd] {
            d = 1.0 / (1.0 + numerator * d);
            c = 1.0 + numerator / c;
            step = c * d;
            fraction *= step;
        }
        if (step - 1.0).abs() < 1e-15 {
            break;
        }
    }
    scale * fraction
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gamma_of_integers_and_halves() {
        let mut factorial = 1.0f64;
        for n in 1..30 {
            assert!((ln_gamma(f64::from(n)) - factorial.ln()).abs() < 1e-11, "{n}");
            factorial *= f64::from(n);
        }
        assert!((ln_gamma(0.5) - PI.sqrt().ln()).abs() < 1e-13);
    }

    #[test]
    fn closed_forms_of_the_upper_gamma_function() {
        for i in 0..100 {
            let x = f64::from(i) * 0.25;
            // Q(1, x) = exp(-x) and Q(3, x) = exp(-x) (1 + x + x²/2).
            assert!((upper_gamma(1.0, x) - (-x).exp()).abs() < 1e-13);
            assert!((upper_gamma(3.0, x) - (-x).exp() * (1.0 + x + x * x / 2.0)).abs() < 1e-13, "{x}");
        }
    }

    #[test]
    fn closed_forms_of_the_beta_function() {
        for i in 0..=100 {
            let x = f64::from(i) * 0.01;
            // I_x(1, b) = 1 - (1 - x)^b, I_x(2, 3) = 6 x² - 8 x³ + 3 x⁴, I_x(1/2, 1/2) = 2/π asin √x.
            assert!((beta(x, 1.0, 7.5) - (1.0 - (1.0 - x).powf(7.5))).abs() < 1e-13, "{x}");
            assert!((beta(x, 2.0, 3.0) - x * x * (6.0 - 8.0 * x + 3.0 * x * x)).abs() < 1e-13, "{x}");
            assert!((beta(x, 0.5, 0.5) - 2.0 / PI * x.sqrt().asin()).abs() < 1e-12, "{x}");
        }
    }
}
