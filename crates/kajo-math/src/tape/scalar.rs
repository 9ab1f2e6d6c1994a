//! What a tape can be evaluated over.

use super::{Binary, Unary};
use crate::fmath;
use crate::interval::{Domain, Interval};

/// Numbers, or what stands for them.
pub trait Scalar: Copy {
    /// The same as a number.
    fn constant(x: f64) -> Self;

    /// A function of one of them.
    fn unary(self, function: Unary) -> Self;

    /// Its sine and its cosine, as [`Scalar::unary`] has them.
    #[inline]
    fn sin_cos(self) -> (Self, Self) {
        (self.unary(Unary::Sin), self.unary(Unary::Cos))
    }

    /// A function of two of them.
    fn binary(self, function: Binary, other: Self) -> Self;

    /// The slope of a step function whose value here is `self` and whose argument is `x`: zero where there is no step.
    fn step_slope(self, x: Self) -> Self;

    /// `a` where `x < y`, `b` where not; something that stands for both where it is not known.
    fn choose(x: Self, y: Self, a: Self, b: Self) -> Self;
}

impl Scalar for f64 {
    #[inline]
    fn constant(x: f64) -> f64 {
        x
    }

    #[inline]
    fn unary(self, function: Unary) -> f64 {
        match function {
            Unary::Neg => -self,
            Unary::Abs => self.abs(),
            Unary::Sign => {
                if self == 0.0 {
                    0.0
                } else {
                    self.signum()
                }
            }
            Unary::Floor => self.floor(),
            Unary::Ceil => self.ceil(),
            Unary::Round => self.round(),
            Unary::Sqrt => self.sqrt(),
            Unary::Exp => fmath::exp64(self),
            Unary::Ln => fmath::ln64(self),
            Unary::Sin => fmath::sin64(self),
            Unary::Cos => fmath::cos64(self),
            Unary::Tan => fmath::tan64(self),
            Unary::Asin => fmath::asin64(self),
            Unary::Acos => fmath::acos64(self),
            Unary::Atan => fmath::atan64(self),
            Unary::Powi(n) => whole_power(self, n),
        }
    }

    #[inline]
    fn sin_cos(self) -> (f64, f64) {
        fmath::sincos64(self)
    }

    #[inline]
    fn binary(self, function: Binary, other: f64) -> f64 {
        match function {
            Binary::Add => self + other,
            Binary::Sub => self - other,
            Binary::Mul => self * other,
            Binary::Div => self / other,
            Binary::Modulo => self - other * (self / other).floor(),
            // What is not a number stays so, in all of these.
            Binary::Pow if self.is_nan() || other.is_nan() => f64::NAN,
            Binary::Pow => fmath::pow64(self, other),
            Binary::Min => {
                if self.is_nan() || self < other {
                    self
                } else {
                    other
                }
            }
            Binary::Max => {
                if self.is_nan() || self > other {
                    self
                } else {
                    other
                }
            }
            Binary::Atan2 => fmath::atan2_64(self, other),
        }
    }

    fn step_slope(self, _: f64) -> f64 {
        0.0
    }

    #[inline]
    fn choose(x: f64, y: f64, a: f64, b: f64) -> f64 {
        if x < y { a } else { b }
    }
}

/// By squaring: the same multiplications on every machine.
#[inline]
fn whole_power(x: f64, n: i32) -> f64 {
    let (mut square, mut left, mut power) = (x, n.unsigned_abs(), 1.0);
    while left > 0 {
        if left % 2 == 1 {
            power *= square;
        }
        square *= square;
        left /= 2;
    }
    match n {
        0 if x.is_nan() => x,
        ..0 => 1.0 / power,
        _ => power,
    }
}

impl Scalar for Interval {
    fn constant(x: f64) -> Interval {
        match x {
            _ if x.is_finite() => Interval::point(x),
            _ if x.is_nan() => Interval { domain: Domain::Nowhere, ..Interval::EVERYTHING },
            _ => Interval { domain: Domain::Somewhere, ..Interval::EVERYTHING },
        }
    }

    fn unary(self, function: Unary) -> Interval {
        match function {
            Unary::Neg => -self,
            Unary::Abs => self.abs(),
            Unary::Sign => self.sign(),
            Unary::Floor => self.stepped(f64::floor),
            Unary::Ceil => self.stepped(f64::ceil),
            Unary::Round => self.stepped(f64::round),
            Unary::Sqrt => self.sqrt(),
            Unary::Exp => self.exp(),
            Unary::Ln => self.ln(),
            Unary::Sin => self.sin(),
            Unary::Cos => self.cos(),
            Unary::Tan => self.tan(),
            Unary::Asin => self.asin(),
            Unary::Acos => self.acos(),
            Unary::Atan => self.atan(),
            Unary::Powi(n) => self.powi(n),
        }
    }

    fn binary(self, function: Binary, other: Interval) -> Interval {
        match function {
            Binary::Add => self + other,
            Binary::Sub => self - other,
            Binary::Mul => self * other,
            Binary::Div => self / other,
            Binary::Modulo => self.modulo(other),
            Binary::Pow => self.pow(other),
            Binary::Min => self.min(other),
            Binary::Max => self.max(other),
            Binary::Atan2 => self.atan2(other),
        }
    }

    fn step_slope(self, x: Interval) -> Interval {
        if self.lo == self.hi && x.domain == Domain::Everywhere {
            Interval::point(0.0)
        } else {
            Interval::EVERYTHING
        }
    }

    fn choose(x: Interval, y: Interval, a: Interval, b: Interval) -> Interval {
        if x.hi < y.lo {
            a
        } else if x.lo >= y.hi {
            b
        } else {
            a.hull(b)
        }
    }
}
