//! Arc sine, arc cosine and arc tangent.
//!
//! ```text
//! asin x = x + x³ P(x²)                           |x| <= 1/2
//! asin x = pi/2 - 2 asin sqrt((1 - x)/2)          beyond
//! atan t = t + t³ Q(t²)                           |t| <= 1/2
//! atan t = pi/4 + atan((t - 1)/(t + 1))           up to 1
//! ```

use std::f32::consts::{FRAC_PI_2, FRAC_PI_4};

use super::{select, upper};

/// What `pi/2` is more than its nearest number.
const HALF_PI_REST: f32 = -4.371_139e-8;

/// Arc sine in [-pi/2, pi/2], within 1 ulp; not a number beyond [-1, 1].
#[inline]
pub fn asin(x: f32) -> f32 {
    let Arc { is_far, s, more } = arc(x);
    // A multiple of 2^-12, so that the first difference is exact.
    let coarse = (s + 3072.0) - 3072.0;
    let far = (FRAC_PI_2 - 2.0 * coarse) - (2.0 * ((s - coarse) + more) - HALF_PI_REST);
    select(is_far, far, s + more).copysign(x)
}

/// Arc cosine in [0, pi], within 1 ulp; not a number beyond [-1, 1].
#[inline]
pub fn acos(x: f32) -> f32 {
    let Arc { is_far, s, more } = arc(x);
    let sign = 1f32.copysign(x);
    let near = FRAC_PI_2 - (sign * s - (HALF_PI_REST - sign * more));
    let right = 2.0 * (s + more);
    let left = 2.0 * (FRAC_PI_2 - (s - (HALF_PI_REST - more)));
    select(is_far, select(x < 0.0, left, right), near)
}

/// An arc sine as a sum of two.
struct Arc {
    /// Whether it is that of `sqrt((1 - |x|)/2)`, and not of `|x|`.
    is_far: bool,
    s: f32,
    more: f32,
}

#[inline]
fn arc(x: f32) -> Arc {
    let size = x.abs();
    let is_far = size > 0.5;
    let z = select(is_far, 0.5 * (1.0 - size), size * size);
    let s = select(is_far, z.sqrt(), size);
    // What the root has lost to rounding; 0 where the root is.
    let coarse = upper(s);
    let lost = (z - coarse * coarse) / (s + coarse) - (s - coarse);
    let lost = select(is_far && s > 0.0, lost, 0.0);
    let p = 0.166_667_54 + z * (0.074_952_49 + z * (0.045_476_66 + z * (0.024_148_127 + z * 0.042_219_803)));
    Arc { is_far, s, more: s * z * p + lost }
}

/// Angle of the point `(x, y)` in [-pi, pi], within 1 ulp; that of `(0, 0)` is 0 or pi by the sign of `x`.
#[inline]
pub fn atan2(y: f32, x: f32) -> f32 {
    let (a, b) = (x.abs(), y.abs());
    let is_steep = b > a;
    let (large, small) = (select(is_steep, b, a), select(is_steep, a, b));
    let (large, small) = if !(1e-18..=1e30).contains(&large) { scaled(large, small) } else { (large, small) };
    let is_far = small > 0.5 * large;
    // Exact for the numerator, as the two are close.
    let over = small - select(is_far, large, 0.0);
    let added = select(is_far, small, 0.0);
    let under = large + added;
    let under_rest = added - (under - large);
    let t = over / under;
    let (t_high, under_high) = (upper(t), upper(under));
    let left = ((over - t_high * under_high) - t_high * (under - under_high)) - (t - t_high) * under;
    // So small a quotient is the angle itself, and the products above have lost their last digits.
    let lost = select(small > 1e-30, (left - t * under_rest) / under, 0.0);
    let z = t * t;
    let q =
        -0.333_332_36 + z * (0.199_942_89 + z * (-0.141_757_35 + z * (0.101_633_79 + z * -0.051_379_986)));
    let more = t * z * q + lost;
    // The angle to the nearer axis, or to the diagonal, and from there to the positive x axis.
    let is_left = x.is_sign_negative();
    let eighths = select(is_far, 1.0, 0.0);
    let eighths = select(is_steep, 2.0 - eighths, eighths);
    let eighths = select(is_left, 4.0 - eighths, eighths);
    let sign = select(is_steep != is_left, -1.0, 1.0);
    let base = eighths * FRAC_PI_4;
    (base + (sign * t + (eighths * (0.5 * HALF_PI_REST) + sign * more))).copysign(y)
}

/// Two numbers with the same quotient and sizes farther from the ends of the range; infinities count as equal.
#[cold]
fn scaled(large: f32, small: f32) -> (f32, f32) {
    if large == 0.0 || small.is_nan() {
        return (1.0, small);
    }
    if large == f32::INFINITY {
        return (1.0, if small == f32::INFINITY { 1.0 } else { 0.0 });
    }
    // 2^98 either way.
    let factor = if large > 1.0 { 3.155_443_6e-30 } else { 3.169_126_5e29 };
    (large * factor, small * factor)
}
