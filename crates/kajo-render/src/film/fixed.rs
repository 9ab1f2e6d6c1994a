//! Sums that do not depend on their order.
//!
//! A sum of floats depends on the order of its terms; a sum of integers does not. So each product of
//! a filter weight `w` and a sample value `v` is turned into a 128-bit integer:
//!
//! * `w`, of magnitude at most 1, is cut to a multiple of 2^-30 and so is an integer `q`
//! * `v` is an `f32` and so is an integer `m` of 24 bits times a power of two
//! * `q m` is exact in 54 bits, and is rounded once, to a multiple of 2^-56
//!
//! Values are clamped to ±2^40, which leaves room for 2^30 terms. With weight 1 every `f32` of magnitude
//! from 2^-33 to 2^40 is summed without any rounding. The average of a constant is therefore that
//! constant, whatever the filter.

/// Bits after the point in a sum.
const SUM_BITS: i32 = 56;

/// Bits after the point in a weight.
const WEIGHT_BITS: i32 = 30;

/// Largest square, 2^40, in units of a sum; 2^30 of them fit.
const LARGEST_SQUARE: i128 = 1 << (40 + SUM_BITS);

/// Shifts beyond this give more than [`LARGEST_SQUARE`], since mantissas have 24 bits.
const LARGEST_SQUARE_SHIFT: i32 = 40 + SUM_BITS - 46;

/// Largest magnitude of a value; what is beyond counts as this.
pub const LARGEST: f32 = (1u64 << 40) as f32;

/// The weight of a filter at one pixel: a multiple of 2^-30.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Weight(i64);

impl Weight {
    /// The weight 1.
    pub const ONE: Weight = Weight(1 << WEIGHT_BITS);

    /// `w`, which lies in [-1, 1], cut to a multiple of 2^-30.
    #[inline]
    pub fn new(w: f32) -> Weight {
        debug_assert!(w.abs() <= 1.0, "filter weight {w}");
        Weight((w * (1i64 << WEIGHT_BITS) as f32) as i64)
    }

    /// The integer whose multiples of 2^-30 weights are.
    #[inline]
    pub fn bits(self) -> i64 {
        self.0
    }
}

/// A sample value, ready to be multiplied by weights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Term {
    /// The value is `mantissa` times a power of two.
    mantissa: i64,
    /// Positions by which `mantissa` times a weight's bits is shifted left to become a sum's bits.
    shift: i32,
}

impl Term {
    /// Nothing.
    pub const ZERO: Term = Term { mantissa: 0, shift: 0 };

    /// The value `v`, or `None` when it is not a finite number.
    #[inline]
    pub fn new(v: f32) -> Option<Term> {
        if !v.is_finite() {
            return None;
        }
        let bits = v.clamp(-LARGEST, LARGEST).to_bits();
        let exponent = (bits >> 23 & 0xFF) as i32;
        // Numbers below the normal ones are far below the resolution, so their missing leading bit is
        // of no account.
        let magnitude = i64::from(bits & 0x7F_FFFF | 0x80_0000);
        let mantissa = if bits >> 31 == 1 { -magnitude } else { magnitude };
        let shift = exponent - 150 - WEIGHT_BITS + SUM_BITS;
        Some(Term { mantissa, shift })
    }

    /// The square of the value in units of 2^-56, rounded to the nearest; values beyond ±2^20 count as these.
    #[inline]
    pub fn squared(self) -> i128 {
        // The value is m 2^(shift + 30 - 56), so its square in units of 2^-56 is m² 2^(2 shift + 4).
        let square = i128::from(self.mantissa) * i128::from(self.mantissa);
        match 2 * self.shift + 2 * WEIGHT_BITS - SUM_BITS {
            shift if shift > LARGEST_SQUARE_SHIFT => LARGEST_SQUARE,
            shift @ 0.. => (square << shift).min(LARGEST_SQUARE),
            shift => ((square >> (-shift - 1).min(126)) + 1) >> 1,
        }
    }

    /// The product with a weight, in units of 2^-56, rounded to the nearest.
    #[inline]
    pub fn times(self, weight: Weight) -> i128 {
        let product = self.mantissa * weight.0;
        match self.shift {
            // The common case, values below 128: the result fits in 63 bits.
            shift @ 0..=8 => i128::from(product << shift),
            shift @ 9.. => i128::from(product) << shift,
            shift => i128::from(((product >> (-shift - 1).min(62)) + 1) >> 1),
        }
    }
}

/// What a single value of weight 1 is after it went through a sum: itself, unless it lies beyond the range or the
/// resolution. `None` when it is not a finite number.
#[inline]
pub fn alone(v: f32) -> Option<f32> {
    /// From here up to [`LARGEST`] every value is a multiple of 2^-56.
    const EXACT: f32 = 1.0 / (1u64 << 33) as f32;
    if (EXACT..=LARGEST).contains(&v.abs()) {
        return Some(v);
    }
    Term::new(v).map(|term| average(term.times(Weight::ONE), 1.0))
}

/// The average that a sum and the sum of its weights stand for; 0 where the weights cancel.
///
/// * `sum`: of [`Term::times`]
/// * `weight`: of [`Weight::bits`] through [`weight_sum`], or a count of samples of weight 1
#[inline]
pub fn average(sum: i128, weight: f64) -> f32 {
    if weight == 0.0 { 0.0 } else { mean(sum, weight) as f32 }
}

/// As [`average`] with all digits; `weight` is not 0.
#[inline]
pub fn mean(sum: i128, weight: f64) -> f64 {
    const UNIT: f64 = 1.0 / (1u64 << SUM_BITS) as f64;
    // Both conversions round to the nearest; the first one is an instruction, the second a function.
    let sum = i64::try_from(sum).map_or_else(|_| sum as f64, |small| small as f64);
    sum * UNIT / weight
}

/// The sum of weights that an integer stands for.
#[inline]
pub fn weight_sum(bits: i64) -> f64 {
    bits as f64 * (1.0 / f64::from(1 << WEIGHT_BITS))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn value(bits: i128) -> f64 {
        bits as f64 / 2f64.powi(SUM_BITS)
    }

    #[test]
    fn known_values() {
        let one = |v: f32| value(Term::new(v).expect("finite").times(Weight::ONE));
        for v in [
            0.0, 1.0, -1.0, 0.1, -0.3, 1e-9, 63.9, 64.1, -127.9, 128.1, -256.0, 123_456.79, LARGEST, -LARGEST,
        ] {
            assert_eq!(one(v), f64::from(v));
        }
        assert_eq!(one(1e30), f64::from(LARGEST));
        assert_eq!(one(f32::MIN), -f64::from(LARGEST));
        for tiny in [1e-30, -1e-30, f32::from_bits(1), f32::MIN_POSITIVE] {
            assert_eq!(one(tiny), 0.0);
        }
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            assert!(Term::new(bad).is_none());
        }
        assert_eq!(Term::ZERO.times(Weight::ONE), 0);
        assert_eq!(Weight::new(1.0), Weight::ONE);
        assert_eq!(average(5, 0.0), 0.0);
    }

    #[test]
    fn squares_by_hand() {
        let square = |v: f32| value(Term::new(v).expect("finite").squared());
        for v in [0.0, 1.0, -1.5, 0.1, 0.04, 127.9, 128.1, 1234.567, 1_048_576.0, -1_048_575.9] {
            assert_eq!(square(v), f64::from(v) * f64::from(v), "{v}");
        }
        for v in [1e7, -3e12, f32::MAX] {
            assert_eq!(square(v), f64::from(1 << 20).powi(2), "{v}");
        }
        for v in [1e-3, 3e-5, 1e-6, 1e-8, -1e-9, 1e-30, f32::MIN_POSITIVE] {
            assert!((square(v) - f64::from(v) * f64::from(v)).abs() <= 2f64.powi(-57), "{v}");
        }
        assert_eq!(Term::ZERO.squared(), 0);
    }

    #[test]
    fn the_largest_sum_fits() {
        let largest = Term::new(f32::MAX).expect("finite").times(Weight::ONE);
        assert!(largest.checked_mul(1 << 30).is_some());
    }

    proptest! {
        #[test]
        fn a_value_alone_is_what_its_sum_gives(bits in any::<u32>()) {
            let v = f32::from_bits(bits);
            let sum = Term::new(v).map(|term| average(term.times(Weight::ONE), 1.0).to_bits());
            prop_assert_eq!(alone(v).map(f32::to_bits), sum);
        }

        #[test]
        fn products_are_right_to_half_a_unit(v in -1e6f32..1e6, w in -1f32..=1.0) {
            let found = value(Term::new(v).expect("finite").times(Weight::new(w)));
            // The weight is off by 2^-30, the product by 2^-57.
            let tolerance = f64::from(v.abs()) * 2f64.powi(-30) + 2f64.powi(-57);
            prop_assert!((found - f64::from(v) * f64::from(w)).abs() <= tolerance * 1.000001);
        }

        #[test]
        fn small_products_are_rounded_to_the_nearest(v in -1e-12f32..1e-12) {
            let found = value(Term::new(v).expect("finite").times(Weight::ONE));
            prop_assert!((found - f64::from(v)).abs() <= 2f64.powi(-57));
        }

        #[test]
        fn a_constant_is_its_own_average(v in 1e-9f32..1e9, weights in proptest::collection::vec(0.01f32..1.0, 1..50)) {
            let term = Term::new(v).expect("finite");
            let weights: Vec<Weight> = weights.into_iter().map(Weight::new).collect();
            let sum: i128 = weights.iter().map(|&w| term.times(w)).sum();
            let weight: i64 = weights.iter().map(|w| w.bits()).sum();
            let relative = (average(sum, weight_sum(weight)) - v).abs() / v;
            prop_assert!(relative <= 6e-8, "{relative}");
        }
    }
}
