//! Bounds on how fast a function changes, and how fast that changes.

use super::{Binary, Scalar, Unary};
use crate::interval::{Domain, Interval};

/// Bounds over a region: of the value, of the length of the gradient, and of the norm of the matrix of second derivatives.
///
/// The norms of sums and products follow from those of their parts: for a product `u v` the second one is at most
/// `|u| h_v + 2 g_u g_v + |v| h_u`, for a function `k(u)` at most `|k'| h_u + |k''| g_u^2`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Curvature {
    /// The values.
    pub value: Interval,
    /// Largest length of the gradient.
    pub slope: f64,
    /// Largest norm of the second derivatives; infinite where there are edges or jumps.
    pub curvature: f64,
}

impl Curvature {
    /// A variable with a range.
    pub fn variable(range: Interval) -> Curvature {
        Curvature { value: range, slope: 1.0, curvature: 0.0 }
    }

    /// A value of which nothing else is known.
    fn rough(value: Interval) -> Curvature {
        Curvature { value, slope: f64::INFINITY, curvature: f64::INFINITY }
    }

    /// A function with this value and these largest first and second derivatives.
    fn of(self, value: Interval, first: f64, second: f64) -> Curvature {
        let curvature = first * self.curvature + second * self.slope * self.slope;
        Curvature { value, slope: first * self.slope, curvature }.known()
    }

    /// The same for a function that is constant wherever it does not jump.
    fn stepped(self, value: Interval) -> Curvature {
        let constant = value.lo == value.hi && value.domain == Domain::Everywhere;
        if constant { Curvature { value, slope: 0.0, curvature: 0.0 } } else { Curvature::rough(value) }
    }

    /// Zero times infinity, say, is not known.
    fn known(self) -> Curvature {
        let or_infinite = |x: f64| if x.is_nan() { f64::INFINITY } else { x };
        Curvature { slope: or_infinite(self.slope), curvature: or_infinite(self.curvature), ..self }
    }

    fn times(self, other: Curvature) -> Curvature {
        let [a, b] = [self, other].map(|x| x.value.abs().hi);
        let curvature = a * other.curvature + 2.0 * self.slope * other.slope + b * self.curvature;
        let value = self.value * other.value;
        Curvature { value, slope: a * other.slope + b * self.slope, curvature }.known()
    }

    fn reciprocal(self) -> Curvature {
        let least = nearest_to_zero(self.value);
        self.of(Interval::point(1.0) / self.value, least.powi(-2), 2.0 * least.powi(-3))
    }
}

/// The least distance from zero.
fn nearest_to_zero(x: Interval) -> f64 {
    if x.contains(0.0) { 0.0 } else { x.lo.abs().min(x.hi.abs()) }
}

impl Scalar for Curvature {
    fn constant(x: f64) -> Curvature {
        Curvature { value: Interval::constant(x), slope: 0.0, curvature: 0.0 }
    }

    fn unary(self, function: Unary) -> Curvature {
        let x = self.value;
        let value = x.unary(function);
        let (most, least) = (value.abs().hi, nearest_to_zero(x));
        match function {
            Unary::Neg => Curvature { value, ..self },
            Unary::Abs if x.lo >= 0.0 || x.hi <= 0.0 => Curvature { value, ..self },
            Unary::Abs => Curvature { value, curvature: f64::INFINITY, ..self },
            Unary::Sign | Unary::Floor | Unary::Ceil | Unary::Round => self.stepped(value),
            Unary::Sqrt => self.of(value, 0.5 / least.sqrt(), 0.25 / (least * least.sqrt())),
            Unary::Exp => self.of(value, most, most),
            Unary::Ln => self.of(value, 1.0 / least, 1.0 / (least * least)),
            Unary::Sin => self.of(value, x.cos().abs().hi, most),
            Unary::Cos => self.of(value, x.sin().abs().hi, most),
            Unary::Tan => self.of(value, 1.0 + most * most, 2.0 * most * (1.0 + most * most)),
            Unary::Asin | Unary::Acos => {
                let far = x.abs().hi;
                let rest = 1.0 - far * far;
                self.of(value, 1.0 / rest.sqrt(), far / (rest * rest.sqrt()))
            }
            // The second derivative is largest at sqrt(1/3), 9 / (8 sqrt(3)).
            Unary::Atan => self.of(value, 1.0 / (1.0 + least * least), 0.65),
            Unary::Powi(n) if n < 0 => self.unary(Unary::Powi(-n)).reciprocal(),
            Unary::Powi(n) => {
                let (degree, far) = (f64::from(n), x.abs().hi);
                let power = |n: i32| if n < 0 { 0.0 } else { far.unary(Unary::Powi(n)) };
                self.of(value, degree * power(n - 1), degree * (degree - 1.0) * power(n - 2))
            }
        }
    }

    fn binary(self, function: Binary, other: Curvature) -> Curvature {
        let value = self.value.binary(function, other.value);
        match function {
            Binary::Add | Binary::Sub => {
                let (slope, curvature) = (self.slope + other.slope, self.curvature + other.curvature);
                Curvature { value, slope, curvature }
            }
            Binary::Mul => self.times(other),
            Binary::Div => Curvature { value, ..self.times(other.reciprocal()) },
            Binary::Modulo => {
                let floor = self.times(other.reciprocal()).unary(Unary::Floor);
                Curvature { value, ..self.binary(Binary::Sub, other.times(floor)) }
            }
            Binary::Pow => Curvature { value, ..other.times(self.unary(Unary::Ln)).unary(Unary::Exp) },
            Binary::Min | Binary::Max => {
                let first = (self.value.hi < other.value.lo) == (function == Binary::Min);
                let decided = self.value.hi < other.value.lo || other.value.hi < self.value.lo;
                let kept = if first { self } else { other };
                let edge = Curvature { value, slope: self.slope.max(other.slope), curvature: f64::INFINITY };
                if decided { Curvature { value, ..kept } } else { edge }
            }
            Binary::Atan2 => Curvature::rough(value),
        }
    }

    fn step_slope(self, x: Curvature) -> Curvature {
        Curvature::constant(0.0).stepped(self.value.step_slope(x.value))
    }

    fn choose(x: Curvature, y: Curvature, a: Curvature, b: Curvature) -> Curvature {
        Curvature::rough(Interval::choose(x.value, y.value, a.value, b.value))
    }
}
