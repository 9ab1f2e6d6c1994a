//! Elementary functions with the same bits on every machine.
//!
//! The system's maths library picks its code by processor and by version, and so may round differently from one
//! machine to the next. These are plain Rust.
//!
//! Those of single precision are made of `+ - * /` and square root in single precision and of operations on the bits of 32-bit
//! numbers, nothing else: vector lanes and graphics cards can compute the same. Tables are a few numbers, and choices are
//! `select`, but for arguments that are rare. Each states its largest error in units in the last place (ulp), from which the tests
//! let none depart. Those of double precision, whose names end in `64`, are the functions of the crate `libm`.
//!
//! Where rounding would cost too much, a number is cut in two of at most 12 bits each, whose products are exact, since the
//! fused multiply-add that would do the same is not to be had everywhere.

mod angles;
mod arcs;
mod double;
mod error_function;
mod exponentials;
#[cfg(test)]
mod tests;

pub use angles::{cos, one_minus_cos, sin, sin_cos, tan};
pub use arcs::{acos, asin, atan2};
pub use double::{
    acos64, asin64, atan2_64, atan64, cos64, erf64, exp_m1_64, exp64, ln64, pow64, sin64, sincos64, tan64,
    tanh64,
};
pub use error_function::erf;
pub use exponentials::{exp, exp_m1, ln, pow, powi};

/// The first 12 of the 24 binary digits of `x`. The product of two such numbers is exact.
#[inline]
fn upper(x: f32) -> f32 {
    f32::from_bits(x.to_bits() & 0xFFFF_F000)
}

/// The whole number nearest to `x`, as a number and modulo 2^32.
///
/// * `x`: up to 2^22 in size
#[inline]
fn whole(x: f32) -> (f32, u32) {
    // From 2^23 to 2^24 numbers are whole, and their bits count up with them.
    const MIDDLE: f32 = 12_582_912.0;
    let sum = x + MIDDLE;
    (sum - MIDDLE, sum.to_bits().wrapping_sub(MIDDLE.to_bits()))
}

/// One of two numbers, without a branch.
#[inline]
fn select(condition: bool, yes: f32, no: f32) -> f32 {
    let mask = u32::from(condition).wrapping_neg();
    f32::from_bits(yes.to_bits() & mask | no.to_bits() & !mask)
}
