//! Sine, cosine and tangent.
//!
//! With `q` the whole number nearest to `2x/pi`, the rest `r = x - q pi/2` lies in [-pi/4, pi/4], where two short polynomials
//! give sine and cosine; the last two bits of `q` say which of them is wanted and with which sign. `pi/2` is
//! subtracted in three parts, the first two short enough for their products with `q` to be exact [Cody and Waite 1980].
//! From 200 on whole numbers replace them: the product of the 24 digits of `x` with those digits of `2/pi` that
//! matter [Payne and Hanek 1983].

use std::f32::consts::FRAC_2_PI;

use super::{select, upper, whole};

/// `pi/2` in 17 bits, 17 more and the rest.
const HALF_PI: [f32; 3] = [1.570_785_5, 1.080_427_3e-5, 6.077_100_6e-11];

/// Below this the product of `q` with 17 bits is exact.
const NEAR: f32 = 199.0;

/// Sine of an angle in radians, within 1 ulp; not a number for infinite angles.
#[inline]
pub fn sin(x: f32) -> f32 {
    let Rest { quarters, r, low } = rest(x);
    with_sign(x, one_in_quarter(quarters, r, low))
}

/// Cosine of an angle in radians, within 1 ulp; not a number for infinite angles.
#[inline]
pub fn cos(x: f32) -> f32 {
    let Rest { quarters, r, low } = rest(x);
    one_in_quarter(quarters.wrapping_add(1), r, low)
}

/// Sine and cosine of an angle in radians: the bits of [`sin`] and [`cos`].
#[inline]
pub fn sin_cos(x: f32) -> (f32, f32) {
    let Rest { quarters, r, low } = rest(x);
    let (sin, cos) = in_quarter(quarters, sin_near(r, low), cos_near(r, low));
    (with_sign(x, sin), cos)
}

/// Tangent of an angle in radians, within 1.25 ulp; not a number for infinite angles.
#[inline]
pub fn tan(x: f32) -> f32 {
    let Rest { quarters, r, low } = rest(x);
    let z = r * r;
    let z2 = z * z;
    let even = 0.133_325_83 + z2 * (0.021_238_612 + z2 * -4.615_765_6e-5);
    let odd = 0.054_068_65 + z2 * (0.010_945_531 + z2 * 0.004_441_808);
    let beyond = r * z * (0.333_333_52 + z * (even + z * odd));
    let tan = r + beyond;
    let beyond = beyond + low * (1.0 + tan * tan);
    let tan = r + beyond;
    if quarters & 1 == 0 {
        return with_sign(x, tan);
    }
    // -1/(r + beyond): the quotient, and what is left of 1 divided once more.
    let high = upper(tan);
    let rest_of_tan = (r - high) + beyond;
    let quotient = -1.0 / tan;
    let coarse = upper(quotient);
    with_sign(x, coarse + quotient * ((1.0 + coarse * high) + coarse * rest_of_tan))
}

/// `1 - cos x` of an angle in radians, with the digits that the cosine of a small angle has lost, within 2 ulp.
#[inline]
pub fn one_minus_cos(x: f32) -> f32 {
    let Rest { quarters, r, low } = rest(x);
    let (half, beyond) = cos_parts(r, low);
    let (_, cos) = in_quarter(quarters, sin_near(r, low), cos_near(r, low));
    // Next to whole turns `low` is no small part of `r`, and its square counts.
    if quarters & 3 == 0 { half - (beyond - 0.5 * low * low) } else { 1.0 - cos }
}

/// The size of an angle less a whole number of quarter turns.
struct Rest {
    /// The number of quarter turns, of which the last two bits are right.
    quarters: u32,
    /// In [-pi/4, pi/4] but for rounding.
    r: f32,
    /// What is left of the rest after rounding.
    low: f32,
}

/// `value`, or minus it where `x` is negative.
#[inline]
fn with_sign(x: f32, value: f32) -> f32 {
    f32::from_bits(value.to_bits() ^ x.to_bits() & 0x8000_0000)
}

#[inline]
fn rest(x: f32) -> Rest {
    let x = x.abs();
    if x > NEAR {
        return rest_of_large(x);
    }
    let (q, quarters) = whole(x * FRAC_2_PI);
    let high = x - q * HALF_PI[0];
    let r = high - q * HALF_PI[1];
    let low = ((high - r) - q * HALF_PI[1]) - q * HALF_PI[2];
    Rest { quarters, r, low }
}

/// The first digits of `2/pi` to base 256, after four zeros.
const DIGITS: [u8; 30] = [
    0x00, 0x00, 0x00, 0x00, 0xA2, 0xF9, 0x83, 0x6E, 0x4E, 0x44, 0x15, 0x29, 0xFC, 0x27, 0x57, 0xD1, 0xF5,
    0x34, 0xDD, 0xC0, 0xDB, 0x62, 0x95, 0x99, 0x3C, 0x43, 0x90, 0x41, 0xFE, 0x51,
];

/// The same of positive angles of 128 and more.
#[cold]
fn rest_of_large(x: f32) -> Rest {
    if !x.is_finite() {
        return Rest { quarters: 0, r: f32::NAN, low: 0.0 };
    }
    let bits = x.to_bits();
    let mantissa = bits & 0x007F_FFFF | 0x0080_0000;
    // In units of its last digit x is the mantissa times 2^(exponent - 150). Digits of 2/pi whose products are whole
    // numbers of full turns are left out; those after the first thirteen do not matter.
    let skipped = (bits >> 23) - 120;
    let (first, shift) = ((skipped / 8) as usize, skipped % 8);
    let mut product = [0; 13];
    let mut carry = 0;
    for i in (0..13).rev() {
        let sum = mantissa * u32::from(DIGITS[first + i]) + carry;
        product[i] = sum & 0xFF;
        carry = sum >> 8;
    }
    let word = |i: usize| {
        let [a, b, c, d, e] = [0, 1, 2, 3, 4].map(|k| product[i + k]);
        (a << 24 | b << 16 | c << 8 | d) << shift | e >> (8 - shift)
    };
    // Of the 64 bits the first two count quarter turns, and the others are a fraction of one, from -1/2 to 1/2 after rounding.
    let (high, low) = (word(0), word(4));
    let quarters = high.wrapping_add(1 << 29) >> 30;
    let high = high.wrapping_sub(quarters << 30);
    let is_below = high >> 31 == 1;
    let (high, low) = if is_below { (!high, !low) } else { (high, low) };
    let (leading, next, below) = if high == 0 { (low, 0, 32) } else { (high, low, 0) };
    let zeros = leading.leading_zeros().min(31);
    let digits = leading << zeros | (next >> 1) >> (31 - zeros);
    let scale = f32::from_bits((127 - 30 - zeros - below) << 23);
    let (coarse, fine) = ((digits & 0xFFF0_0000) as f32 * scale, (digits & 0x000F_FFFF) as f32 * scale);
    let half_pi = [1.570_800_8, -4.454_455e-6];
    let (exact, more) = (coarse * half_pi[0], coarse * half_pi[1] + fine * (half_pi[0] + half_pi[1]));
    let r = exact + more;
    let low = (exact - r) + more;
    let sign = |x: f32| if is_below { -x } else { x };
    Rest { quarters, r: sign(r), low: sign(low) }
}

/// Coefficients of `(sin r - r)/r³` and of `(cos r - 1 + r²/2)/r⁴` as polynomials of `r²`.
const SIN: [f32; 3] = [-0.166_666_55, 0.008_332_191, -1.951_86e-4];
const COS: [f32; 3] = [0.041_666_646, -0.001_388_730_1, 2.443_066_8e-5];

#[inline]
fn polynomial(z: f32, [a, b, c]: [f32; 3]) -> f32 {
    a + z * (b + z * c)
}

/// Sine of `r + low` in [-pi/4, pi/4].
#[inline]
fn sin_near(r: f32, low: f32) -> f32 {
    let z = r * r;
    r + (r * z * polynomial(z, SIN) + low)
}

/// Cosine of `r + low` in [-pi/4, pi/4].
#[inline]
fn cos_near(r: f32, low: f32) -> f32 {
    let (half, beyond) = cos_parts(r, low);
    let near = 1.0 - half;
    near + (((1.0 - near) - half) + beyond)
}

/// The cosine of `r + low` as `1 - half + beyond`.
#[inline]
fn cos_parts(r: f32, low: f32) -> (f32, f32) {
    let z = r * r;
    (0.5 * z, z * z * polynomial(z, COS) - r * low)
}

/// Sine and cosine that many quarter turns on.
#[inline]
fn in_quarter(quarters: u32, sin: f32, cos: f32) -> (f32, f32) {
    let is_odd = quarters & 1 == 1;
    let (a, b) = (select(is_odd, cos, sin), select(is_odd, sin, cos));
    (turned(a, quarters), turned(b, quarters.wrapping_add(1)))
}

/// Minus `x` in the third and fourth quarter.
#[inline]
fn turned(x: f32, quarters: u32) -> f32 {
    f32::from_bits(x.to_bits() ^ (quarters & 2) << 30)
}

/// The sine alone: one polynomial, whose coefficients are those of [`sin_near`] or of [`cos_near`]. The same bits.
#[inline]
fn one_in_quarter(quarters: u32, r: f32, low: f32) -> f32 {
    let is_odd = quarters & 1 == 1;
    let z = r * r;
    let p = polynomial(z, [SIN, COS][(quarters & 1) as usize]);
    let (first, half) = (select(is_odd, 1.0, r), select(is_odd, 0.5 * z, 0.0));
    let near = first - half;
    let beyond = select(is_odd, z, r) * z * p + select(is_odd, -r, 1.0) * low;
    turned(near + (((first - near) - half) + beyond), quarters)
}
