//! Exponential, logarithm and powers.
//!
//! `exp x` is `2^k exp r` with `r = x - k ln 2` in [-0.35, 0.35]. A logarithm is that of the mantissa `m`, taken between `sqrt ½` and
//! `sqrt 2`, with `s = (m - 1)/(m + 1)`:
//!
//! ```text
//! ln m = 2 atanh s = 2 (s + s³/3 + s⁵/5 + ...)
//! ```
//!
//! Powers are `2^(y log2 x)`. There the logarithm needs seven binary digits more than the result has, for its
//! product with `y` may be as large as 128: it is a sum of two numbers, the first of 12 digits, so
//! that its products are exact [Dekker 1971].

use std::f32::consts::{LN_2, LOG2_E};

use super::{upper, whole};

/// `ln 2` in 16 bits, and the rest.
const LN_2_PARTS: [f32; 2] = [0.693_145_75, 1.428_606_8e-6];

/// `e` to the power `x`, within 1 ulp, also where the result is subnormal.
#[inline]
pub fn exp(x: f32) -> f32 {
    let Reduced { r, rest, k } = Reduced::new(x.clamp(-110.0, 90.0));
    times_two_to(1.0 + (r + rest), k)
}

/// `e^x - 1` within 1.23 ulp, also next to 0.
#[inline]
pub fn exp_m1(x: f32) -> f32 {
    // Below it is -1.
    let Reduced { r, rest, k } = Reduced::new(x.clamp(-20.0, 90.0));
    let power = times_two_to(1.0, k);
    // The sum of `2^k - 1` and `2^k r`, and what rounding takes from it, which follows from the larger of them.
    let (one, other) = (power - 1.0, times_two_to(r, k));
    let sum = one + other;
    let lost = if one.abs() >= other.abs() { (one - sum) + other } else { (other - sum) + one };
    if k == 0 {
        r + rest
    } else if power < f32::INFINITY {
        sum + (lost + times_two_to(rest, k))
    } else {
        times_two_to(1.0 + (r + rest), k)
    }
}

/// `e^x = 2^k (1 + r + rest)`.
struct Reduced {
    r: f32,
    rest: f32,
    k: u32,
}

impl Reduced {
    /// * `x`: from -110 to 90
    #[inline]
    fn new(x: f32) -> Reduced {
        let (whole, k) = whole(x * LOG2_E);
        let (high, low) = (x - whole * LN_2_PARTS[0], whole * LN_2_PARTS[1]);
        let r = high - low;
        let lost = (high - r) - low;
        let p = 0.5 + r * (0.166_665_2 + r * (0.041_666_403 + r * (0.008_368_828 + r * 0.001_394_061_6)));
        Reduced { r, rest: r * r * p + lost, k }
    }
}

/// `x 2^k`, rounded once.
///
/// * `k`: from -250 to 250
#[inline]
fn times_two_to(x: f32, k: u32) -> f32 {
    let half = (k as i32 >> 1) as u32;
    let power = |k: u32| f32::from_bits(k.wrapping_add(127) << 23);
    x * power(half) * power(k.wrapping_sub(half))
}

/// `x = m 2^k` with `m` from `sqrt ½` to `sqrt 2`.
///
/// * `x`: positive and finite
#[inline]
fn mantissa_and_exponent(x: f32) -> (f32, f32) {
    let is_subnormal = x < f32::MIN_POSITIVE;
    let bits = if is_subnormal { x * 16_777_216.0 } else { x }.to_bits();
    // The bits of sqrt ½ become an exponent of 127 and a mantissa of zero.
    let moved = bits.wrapping_add(0x3F80_0000 - 0x3F35_04F3);
    let k = (moved >> 23) as i32 - if is_subnormal { 151 } else { 127 };
    (f32::from_bits((moved & 0x007F_FFFF) + 0x3F35_04F3), k as f32)
}

/// Natural logarithm, within 1 ulp; minus infinity at 0 and not a number below.
#[inline]
pub fn ln(x: f32) -> f32 {
    if !(x > 0.0 && x < f32::INFINITY) {
        return if x == 0.0 {
            f32::NEG_INFINITY
        } else if x > 0.0 {
            x
        } else {
            f32::NAN
        };
    }
    let (m, k) = mantissa_and_exponent(x);
    let f = m - 1.0;
    let s = f / (2.0 + f);
    let z = s * s;
    let r = z * (0.666_667_76 + z * (0.399_775_77 + z * 0.298_710_53));
    let half = 0.5 * f * f;
    k * LN_2_PARTS[0] - ((half - (s * (half + r) + k * LN_2_PARTS[1])) - f)
}

/// `x` to the power `y`, within 1 ulp but for high whole powers; `0^0` is 1. Of negative `x` only whole powers are numbers.
///
/// Whole powers from 0 to 1024, which is what shininess usually is, go by [`powi`].
#[inline]
pub fn pow(x: f32, y: f32) -> f32 {
    if x == 0.0 && y > 0.0 {
        return 0.0;
    }
    if (0.0..=1024.0).contains(&y) && y == (y as u32) as f32 {
        return powi(x, y as u32);
    }
    any_pow(x, y)
}

/// `x` to a whole power up to 1024. Where the result is at least 1e-30 in size it is within 0.55 ulp for powers up to the 64th,
/// and within 1.25 ulp for higher ones; below it is right to 1e-34.
///
/// By repeated squaring of a number and of what rounding has taken from it.
#[inline]
pub fn powi(x: f32, n: u32) -> f32 {
    let Some(top) = n.checked_ilog2() else { return 1.0 };
    let (mut power, mut lost) = (x, 0.0);
    for bit in (0..top).rev() {
        (power, lost) = (power * power, (power + power) * lost + lost_by_product(power, power));
        if n >> bit & 1 == 1 {
            (power, lost) = (power * x, x * lost + lost_by_product(power, x));
        }
    }
    let sum = power + lost;
    if sum.is_finite() { sum } else { any_pow(x, n as f32) }
}

/// What rounding takes from the product of two numbers: `a b` less the nearest number.
#[inline]
fn lost_by_product(a: f32, b: f32) -> f32 {
    let (a_high, b_high) = (upper(a), upper(b));
    (a_high * b_high - a * b) + (a_high * (b - b_high) + (a - a_high) * b)
}

/// [`pow`] by logarithms.
#[inline]
fn any_pow(x: f32, y: f32) -> f32 {
    if x > 0.0 && x < f32::INFINITY && y.abs() < f32::INFINITY {
        positive_pow(x, y)
    } else {
        special_pow(x, y)
    }
}

/// `x` to the power `y` for positive finite `x` and finite `y`.
#[inline]
fn positive_pow(x: f32, y: f32) -> f32 {
    let (log_high, log_low) = log2(x);
    let y_high = upper(y);
    let high = y_high * log_high;
    // Smaller than 1 unless the result is out of range in any case.
    let low = ((y - y_high) * log_high + y * log_low).clamp(-1.0, 1.0);
    let sum = (high + low).clamp(-160.0, 160.0);
    let (n, exponent) = whole(sum);
    let high = high.clamp(-160.0, 160.0) - n;
    // 2^(a + b) = 1 + a ln 2 + ..., the product again in parts.
    let r = high + low;
    let a = upper(r);
    let b = low - (a - high);
    let p = 0.240_226_5 + r * (0.055_503_618 + r * (0.009_618_063 + r * (0.001_339_043 + r * 1.546_29e-4)));
    let exact = a * 0.693_115_23;
    let beyond = a * 3.194_618_3e-5 + (b * LN_2 + r * r * p);
    let near = 1.0 + exact;
    times_two_to(near + ((exact - (near - 1.0)) + beyond), exponent)
}

/// The logarithm to base 2 as a sum of two numbers, the first of 12 bits: of its relative error
/// 33 bits are right.
#[inline]
fn log2(x: f32) -> (f32, f32) {
    let (m, k) = mantissa_and_exponent(x);
    let f = m - 1.0;
    let g = m + 1.0;
    let g_high = upper(g);
    let g_low = m - (g_high - 1.0);
    let inverse = 1.0 / g;
    let s = f * inverse;
    let s_high = upper(s);
    let s_low = ((f - s_high * g_high) - s_high * g_low) * inverse;
    // 3 atanh s = s (3 + s² + s⁴ R).
    let z = s * s;
    let z_high = s_high * s_high;
    let beyond = z * z * (0.600_002_3 + z * (0.428_206_26 + z * 0.351_298_45)) + s_low * (s + s_high);
    let t_high = upper(3.0 + z_high + beyond);
    let t_low = beyond - ((t_high - 3.0) - z_high);
    let u = s_high * t_high;
    let v = s_low * t_high + t_low * s;
    let p_high = upper(u + v);
    let p_low = v - (p_high - u);
    // Times 2/(3 ln 2), and the exponent.
    let w = 0.961_914_06 * p_high;
    let w_low = p_high * -1.173_685_7e-4 + p_low * 0.961_796_7;
    let high = upper((w + w_low) + k);
    (high, w_low - ((high - k) - w))
}

/// Powers that are not of a positive number, or not finite.
#[cold]
fn special_pow(x: f32, y: f32) -> f32 {
    if y == 0.0 || x == 1.0 {
        return 1.0;
    }
    if x.is_nan() || y.is_nan() {
        return f32::NAN;
    }
    let size = x.abs();
    if y.is_infinite() {
        return if size == 1.0 {
            1.0
        } else if (size > 1.0) == (y > 0.0) {
            f32::INFINITY
        } else {
            0.0
        };
    }
    let is_whole = y == y.trunc();
    let is_odd = is_whole && y.abs() < 16_777_216.0 && y as i32 & 1 == 1;
    let power = match (size == 0.0 || size.is_infinite(), y > 0.0) {
        (true, true) => size,
        (true, false) => 1.0 / size,
        (false, _) if !is_whole => f32::NAN,
        (false, _) => positive_pow(size, y),
    };
    if is_odd && x.is_sign_negative() { -power } else { power }
}
