//! Elementary functions with the same bits on every machine.
//!
//! The system's maths library picks its code by processor and by version, and so may
//! round differently from one machine to the next. These are plain Rust.

/// Sine of an angle in radians.
#[inline]
pub fn sin(x: f32) -> f32 {
    libm::sinf(x)
}

/// Cosine of an angle in radians.
#[inline]
pub fn cos(x: f32) -> f32 {
    libm::cosf(x)
}

/// `1 - cos x` of an angle in radians, with the digits that the cosine of a small angle has lost: `2 sin²(x/2)`.
#[inline]
pub fn one_minus_cos(x: f32) -> f32 {
    let sin = sin(0.5 * x);
    2.0 * sin * sin
}

/// Sine and cosine of an angle in radians.
#[inline]
pub fn sin_cos(x: f32) -> (f32, f32) {
    libm::sincosf(x)
}

/// Tangent of an angle in radians.
#[inline]
pub fn tan(x: f32) -> f32 {
    libm::tanf(x)
}

/// Angle of the point `(x, y)` in (-pi, pi].
#[inline]
pub fn atan2(y: f32, x: f32) -> f32 {
    libm::atan2f(y, x)
}

/// Arc sine in [-pi/2, pi/2].
#[inline]
pub fn asin(x: f32) -> f32 {
    libm::asinf(x)
}

/// Arc cosine in [0, pi].
#[inline]
pub fn acos(x: f32) -> f32 {
    libm::acosf(x)
}

/// `e` to the power `x`.
#[inline]
pub fn exp(x: f32) -> f32 {
    libm::expf(x)
}

/// Natural logarithm.
#[inline]
pub fn ln(x: f32) -> f32 {
    libm::logf(x)
}

/// `x` to the power `y`; `0^0` is 1.
///
/// Whole exponents up to 1024, which is what shininess usually is, go by squaring.
#[inline]
pub fn pow(x: f32, y: f32) -> f32 {
    if x == 0.0 && y > 0.0 {
        return 0.0;
    }
    if (0.0..=1024.0).contains(&y) && y == (y as u32) as f32 {
        return powi(x, y as u32);
    }
    libm::powf(x, y)
}

/// `x` to a whole power, by repeated squaring in double precision.
#[inline]
pub fn powi(x: f32, mut n: u32) -> f32 {
    let (mut square, mut product) = (f64::from(x), 1.0f64);
    while n > 0 {
        if n & 1 == 1 {
            product *= square;
        }
        square *= square;
        n >>= 1;
    }
    product as f32
}

/// The error function, `2/sqrt(pi)` times the integral of `exp(-t^2)` from 0 to `x`.
#[inline]
pub fn erf(x: f32) -> f32 {
    libm::erff(x)
}

/// The error function in double precision.
#[inline]
pub fn erf64(x: f64) -> f64 {
    libm::erf(x)
}

/// Sine in double precision.
#[inline]
pub fn sin64(x: f64) -> f64 {
    libm::sin(x)
}

/// Cosine in double precision.
#[inline]
pub fn cos64(x: f64) -> f64 {
    libm::cos(x)
}

/// Sine and cosine in double precision.
#[inline]
pub fn sincos64(x: f64) -> (f64, f64) {
    libm::sincos(x)
}

/// Tangent in double precision.
#[inline]
pub fn tan64(x: f64) -> f64 {
    libm::tan(x)
}

/// Arc sine in double precision.
#[inline]
pub fn asin64(x: f64) -> f64 {
    libm::asin(x)
}

/// Arc tangent in double precision.
#[inline]
pub fn atan64(x: f64) -> f64 {
    libm::atan(x)
}

/// Angle of the vector (x, y) to the x axis, in (-pi, pi].
#[inline]
pub fn atan2_64(y: f64, x: f64) -> f64 {
    libm::atan2(y, x)
}

/// `e` to the power `x` in double precision.
#[inline]
pub fn exp64(x: f64) -> f64 {
    libm::exp(x)
}

/// `e^x - 1` in double precision, accurate near zero.
#[inline]
pub fn exp_m1_64(x: f64) -> f64 {
    libm::expm1(x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_powers_agree_with_the_general_one() {
        for x in [0.0f32, 0.1, 0.5, 0.93, 1.0, 1.7] {
            for n in [0u32, 1, 2, 3, 16, 100, 1000] {
                let (a, b) = (powi(x, n), libm::powf(x, n as f32));
                assert!((a - b).abs() <= 1e-5 * b.abs() || a == b, "{x}^{n}: {a} {b}");
            }
        }
        assert_eq!(pow(0.0, 0.0), 1.0);
    }
}
