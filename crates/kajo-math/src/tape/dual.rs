//! Values with derivatives.

use super::{Binary, Scalar, Unary};

/// A value, and how it changes with `N` things.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<S, const N: usize> {
    /// The value.
    pub value: S,
    /// Its derivatives.
    pub slopes: [S; N],
}

fn times<S: Scalar>(a: S, b: S) -> S {
    a.binary(Binary::Mul, b)
}

fn over<S: Scalar>(a: S, b: S) -> S {
    a.binary(Binary::Div, b)
}

fn plus<S: Scalar>(a: S, b: S) -> S {
    a.binary(Binary::Add, b)
}

fn minus<S: Scalar>(a: S, b: S) -> S {
    a.binary(Binary::Sub, b)
}

impl<S: Scalar, const N: usize> Dual<S, N> {
    /// The slopes times a factor: the chain rule.
    fn scaled(self, factor: S) -> [S; N] {
        self.slopes.map(|slope| times(factor, slope))
    }
}

impl<S: Scalar, const N: usize> Scalar for Dual<S, N> {
    fn constant(x: f64) -> Dual<S, N> {
        Dual { value: S::constant(x), slopes: [S::constant(0.0); N] }
    }

    fn unary(self, function: Unary) -> Dual<S, N> {
        match function {
            Unary::Sin => return self.sin_cos().0,
            Unary::Cos => return self.sin_cos().1,
            _ => {}
        }
        let (x, one) = (self.value, S::constant(1.0));
        let value = x.unary(function);
        let root_of_rest = || minus(one, x.unary(Unary::Powi(2))).unary(Unary::Sqrt);
        let slopes = match function {
            Unary::Neg => self.slopes.map(|slope| slope.unary(Unary::Neg)),
            Unary::Abs => self.scaled(x.unary(Unary::Sign)),
            Unary::Sign | Unary::Floor | Unary::Ceil | Unary::Round => [value.step_slope(x); N],
            Unary::Sqrt => self.slopes.map(|slope| over(slope, plus(value, value))),
            Unary::Exp => self.scaled(value),
            Unary::Ln => self.slopes.map(|slope| over(slope, x)),
            Unary::Sin | Unary::Cos => self.slopes, // See above.
            Unary::Tan => self.scaled(plus(one, value.unary(Unary::Powi(2)))),
            Unary::Asin => self.slopes.map(|slope| over(slope, root_of_rest())),
            Unary::Acos => self.slopes.map(|slope| over(slope, root_of_rest()).unary(Unary::Neg)),
            Unary::Atan => self.slopes.map(|slope| over(slope, plus(one, x.unary(Unary::Powi(2))))),
            Unary::Powi(0) => [S::constant(0.0); N],
            Unary::Powi(n) => self.scaled(times(S::constant(n.into()), x.unary(Unary::Powi(n - 1)))),
        };
        Dual { value, slopes }
    }

    #[inline]
    fn sin_cos(self) -> (Dual<S, N>, Dual<S, N>) {
        let (sin, cos) = self.value.sin_cos();
        let falls = sin.unary(Unary::Neg);
        (Dual { value: sin, slopes: self.scaled(cos) }, Dual { value: cos, slopes: self.scaled(falls) })
    }

    fn binary(self, function: Binary, other: Dual<S, N>) -> Dual<S, N> {
        let (x, y) = (self.value, other.value);
        let value = x.binary(function, y);
        let slope = |i: usize| {
            let (dx, dy) = (self.slopes[i], other.slopes[i]);
            match function {
                Binary::Add => plus(dx, dy),
                Binary::Sub => minus(dx, dy),
                Binary::Mul => plus(times(dx, y), times(x, dy)),
                Binary::Div => over(minus(dx, times(value, dy)), y),
                Binary::Modulo => {
                    let floor = over(x, y).unary(Unary::Floor);
                    let steps = floor.step_slope(over(x, y));
                    minus(dx, plus(times(floor, dy), times(y, steps)))
                }
                // x^y (y' ln x + y x' / x), where `ln x` counts only if the exponent changes.
                Binary::Pow => {
                    let base = times(times(y, x.binary(Binary::Pow, minus(y, S::constant(1.0)))), dx);
                    plus(base, times(times(value, x.unary(Unary::Ln)), dy))
                }
                Binary::Min => S::choose(x, y, dx, dy),
                Binary::Max => S::choose(x, y, dy, dx),
                // The angle of (y, x): x is the height here.
                Binary::Atan2 => {
                    let square = plus(x.unary(Unary::Powi(2)), y.unary(Unary::Powi(2)));
                    over(minus(times(dx, y), times(x, dy)), square)
                }
            }
        };
        Dual { value, slopes: std::array::from_fn(slope) }
    }

    fn step_slope(self, x: Dual<S, N>) -> Dual<S, N> {
        Dual { value: self.value.step_slope(x.value), slopes: [S::constant(0.0); N] }
    }

    fn choose(x: Dual<S, N>, y: Dual<S, N>, a: Dual<S, N>, b: Dual<S, N>) -> Dual<S, N> {
        let pick = |a: S, b: S| S::choose(x.value, y.value, a, b);
        Dual {
            value: pick(a.value, b.value),
            slopes: std::array::from_fn(|i| pick(a.slopes[i], b.slopes[i])),
        }
    }
}
