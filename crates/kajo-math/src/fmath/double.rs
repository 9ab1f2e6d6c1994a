//! Functions of double precision, by the crate `libm`.

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

/// Arc cosine in double precision.
#[inline]
pub fn acos64(x: f64) -> f64 {
    libm::acos(x)
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

/// Natural logarithm in double precision.
#[inline]
pub fn ln64(x: f64) -> f64 {
    libm::log(x)
}

/// `x` to the power `y` in double precision.
#[inline]
pub fn pow64(x: f64, y: f64) -> f64 {
    libm::pow(x, y)
}

/// Hyperbolic tangent in double precision.
#[inline]
pub fn tanh64(x: f64) -> f64 {
    libm::tanh(x)
}

/// `e^x - 1` in double precision, accurate near zero.
#[inline]
pub fn exp_m1_64(x: f64) -> f64 {
    libm::expm1(x)
}
