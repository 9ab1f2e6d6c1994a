//! The error function.

use super::exp;

/// The error function, `2/sqrt(pi)` times the integral of `exp(-t^2)` from 0 to `x`, within 1.44 ulp.
///
/// `x + x P(x²)` up to 0.92, and `1 - exp(-Q(x))` beyond; from 3.92 on it is 1.
#[inline]
pub fn erf(x: f32) -> f32 {
    let size = x.abs();
    let z = x * x;
    if size < 0.92 {
        let p = -0.026_855_73 + z * (0.005_192_392 + z * (-8.049_495e-4 + z * 7.994_859e-5));
        return x + x * (0.128_379_17 + z * (-0.376_126_3 + z * (0.112_836_26 + z * p)));
    }
    let size = size.clamp(0.92, 4.0);
    let z = size * size;
    let even = -1.758_733_7e-4 + z * (0.633_334_9 + z * (-0.025_128_21 + z * -4.351_579_7e-4));
    let odd = 1.129_520_8 + z * (0.108_293_526 + z * (0.004_174_421 + z * 2.115_522e-5));
    (1.0 - exp(-(even + size * odd))).copysign(x)
}
