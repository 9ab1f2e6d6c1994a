//! Functions of double precision, by the crate `libm`; sine and cosine have its bits.

/// The error function in double precision.
#[inline]
pub fn erf64(x: f64) -> f64 {
    libm::erf(x)
}

/// Sine in double precision.
#[inline]
pub fn sin64(x: f64) -> f64 {
    sincos64(x).0
}

/// Cosine in double precision.
#[inline]
pub fn cos64(x: f64) -> f64 {
    sincos64(x).1
}

/// Sine and cosine in double precision: the bits of `libm::sincos`, which has a branch for each quarter.
///
/// With `q` the whole number nearest to `2x/pi` the rest `r = x - q pi/2` is the sum `high + low`, by two parts of `pi/2`
/// [Cody and Waite 1980], and the polynomials of the library give sine and cosine. Where it does otherwise it does it itself:
/// next to the ends of quarters, where `r` has lost many digits, and far from zero.
#[inline]
pub fn sincos64(x: f64) -> (f64, f64) {
    /// From 1.5 2^52 on numbers are whole, and their bits count up with them.
    const MIDDLE: f64 = 6_755_399_441_055_744.0;
    /// `pi/2` in 33 bits, and the rest.
    const HALF_PI: [f64; 2] = [f64::from_bits(0x3FF9_21FB_5440_0000), f64::from_bits(0x3DD0_B461_1A62_6331)];
    const FAR: f64 = 1e6;
    const END_OF_QUARTER: f64 = 0.785;
    let sum = x * std::f64::consts::FRAC_2_PI + MIDDLE;
    let q = sum - MIDDLE;
    let (before, rest) = (x - q * HALF_PI[0], q * HALF_PI[1]);
    let high = before - rest;
    let low = (before - high) - rest;
    let size = high.abs();
    let is_plain = x.abs() < FAR && size < END_OF_QUARTER && size * 32_768.0 > x.abs();
    if !is_plain {
        return libm::sincos(x);
    }
    let (sin, cos) = (sin_near(high, low, q == 0.0), cos_near(high, low));
    let quarters = sum.to_bits();
    let mask = (quarters & 1).wrapping_neg();
    let (sin, cos) = (sin.to_bits(), cos.to_bits());
    let (a, b) = (cos & mask | sin & !mask, sin & mask | cos & !mask);
    let turned = |bits: u64, quarters: u64| f64::from_bits(bits ^ (quarters & 2) << 62);
    (turned(a, quarters), turned(b, quarters.wrapping_add(1)))
}

/// Sine of `x + y` in [-pi/4, pi/4], as the library has it.
///
/// * `alone`: whether `y` is zero, which changes the order of the sum
#[inline]
fn sin_near(x: f64, y: f64, alone: bool) -> f64 {
    const S: [f64; 6] = [
        -1.666_666_666_666_663_2e-1,
        8.333_333_333_322_49e-3,
        -1.984_126_982_985_795e-4,
        2.755_731_370_707_006_8e-6,
        -2.505_076_025_340_686_3e-8,
        1.589_690_995_211_55e-10,
    ];
    let z = x * x;
    let r = S[1] + z * (S[2] + z * S[3]) + z * (z * z) * (S[4] + z * S[5]);
    let v = z * x;
    let [near, both] = [x + v * (S[0] + z * r), x - ((z * (0.5 * y - v * r) - y) - v * S[0])];
    if alone { near } else { both }
}

/// Cosine of `x + y` in [-pi/4, pi/4], as the library has it.
#[inline]
fn cos_near(x: f64, y: f64) -> f64 {
    const C: [f64; 6] = [
        4.166_666_666_666_66e-2,
        -1.388_888_888_887_411e-3,
        2.480_158_728_947_673e-5,
        -2.755_731_435_139_066_3e-7,
        2.087_572_321_298_175e-9,
        -1.135_964_755_778_819_5e-11,
    ];
    let z = x * x;
    let w = z * z;
    let r = z * (C[0] + z * (C[1] + z * C[2])) + w * w * (C[3] + z * (C[4] + z * C[5]));
    let half = 0.5 * z;
    let near = 1.0 - half;
    near + (((1.0 - near) - half) + (z * r - x * y))
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
