//! The incomplete gamma function, for tests only: it uses the system's maths library.

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
}
