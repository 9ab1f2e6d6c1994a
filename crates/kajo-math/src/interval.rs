//! Interval arithmetic: bounds on the values of a function over a range of its arguments.
//!
//! Every operation rounds outwards by at least the error of the operation on numbers, so that the value for any arguments
//! in the intervals, computed in double precision or exactly, is in the result [Moore, Kearfott and Cloud 2009, chapter 2].
//! An interval also holds whether the function has a value everywhere in its range: `sqrt` has none below zero.

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::ops::{Add, Div, Mul, Neg, Sub};

use crate::fmath;

/// Where in the range of its arguments a function has a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Domain {
    /// At no place.
    Nowhere,
    /// It is not known to have one everywhere.
    Somewhere,
    /// At every place.
    Everywhere,
}

/// All numbers from `lo` to `hi`, and where they were computed from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// The least; may be minus infinity.
    pub lo: f64,
    /// The greatest; may be infinity.
    pub hi: f64,
    /// Where there is a value. [`Domain::Nowhere`] makes the bounds meaningless.
    pub domain: Domain,
}

impl Interval {
    /// All numbers.
    pub const EVERYTHING: Interval = Interval::new(f64::NEG_INFINITY, f64::INFINITY);

    /// The numbers from `lo` to `hi`, which is not less.
    pub const fn new(lo: f64, hi: f64) -> Interval {
        Interval { lo, hi, domain: Domain::Everywhere }
    }

    /// One number.
    pub const fn point(x: f64) -> Interval {
        Interval::new(x, x)
    }

    /// Whether `x` is one of the numbers.
    #[inline]
    pub fn contains(self, x: f64) -> bool {
        self.lo <= x && x <= self.hi
    }

    /// The smallest interval with all numbers of both.
    #[inline]
    pub fn hull(self, other: Interval) -> Interval {
        let domain = self.domain.min(other.domain);
        Interval { lo: self.lo.min(other.lo), hi: self.hi.max(other.hi), domain }
    }

    /// The numbers in both, which both are bounds of one thing.
    #[inline]
    pub fn intersection(self, other: Interval) -> Interval {
        Interval { lo: self.lo.max(other.lo), hi: self.hi.min(other.hi), ..self }
    }

    /// Half of the sum of the ends.
    #[inline]
    pub fn middle(self) -> f64 {
        0.5 * self.lo + 0.5 * self.hi
    }

    #[inline]
    fn is_zero(self) -> bool {
        self.lo == 0.0 && self.hi == 0.0
    }

    /// The same numbers, with a value at most where `domain` says.
    fn within(self, domain: Domain) -> Interval {
        Interval { domain: self.domain.min(domain), ..self }
    }

    /// Bounds that were rounded once to the nearest number each.
    #[inline]
    fn rounded(self, lo: f64, hi: f64) -> Interval {
        Interval { lo: below(lo), hi: above(hi), ..self }.or_too_large()
    }

    /// Bounds that are off by less than two places.
    fn loose(self, lo: f64, hi: f64) -> Interval {
        Interval { lo: below(below(lo)), hi: above(above(hi)), ..self }.or_too_large()
    }

    /// Numbers that may be infinite may have no difference, product or sine.
    #[inline]
    fn or_too_large(self) -> Interval {
        if self.lo.is_finite() && self.hi.is_finite() { self } else { self.within(Domain::Somewhere) }
    }

    /// The values of a function that rises everywhere.
    fn rising(self, f: impl Fn(f64) -> f64) -> Interval {
        self.loose(f(self.lo), f(self.hi))
    }

    /// The distance from zero.
    pub fn abs(self) -> Interval {
        if self.lo >= 0.0 {
            self
        } else if self.hi <= 0.0 {
            -self
        } else {
            Interval { lo: 0.0, hi: self.hi.max(-self.lo), ..self }
        }
    }

    /// -1, 0 or 1.
    pub fn sign(self) -> Interval {
        let of = |x: f64| f64::from(i8::from(x > 0.0) - i8::from(x < 0.0));
        Interval { lo: of(self.lo), hi: of(self.hi), ..self }
    }

    /// The values of a function that rises in steps of whole numbers, such as `floor`.
    pub fn stepped(self, f: impl Fn(f64) -> f64) -> Interval {
        Interval { lo: f(self.lo), hi: f(self.hi), ..self }
    }

    /// The smaller of two.
    pub fn min(self, other: Interval) -> Interval {
        let domain = self.domain.min(other.domain);
        Interval { lo: self.lo.min(other.lo), hi: self.hi.min(other.hi), domain }
    }

    /// The larger of two.
    pub fn max(self, other: Interval) -> Interval {
        let domain = self.domain.min(other.domain);
        Interval { lo: self.lo.max(other.lo), hi: self.hi.max(other.hi), domain }
    }

    /// The square root, which negative numbers have not.
    pub fn sqrt(self) -> Interval {
        let Interval { lo, hi, .. } = self.not_negative();
        let roots = self.within(domain_at_least(self, 0.0)).rounded(lo.sqrt(), hi.sqrt());
        Interval { lo: roots.lo.max(0.0), ..roots }
    }

    /// The exponential function.
    pub fn exp(self) -> Interval {
        let values = self.rising(fmath::exp64);
        Interval { lo: values.lo.max(0.0), ..values }
    }

    /// The natural logarithm, which negative numbers have not; that of zero is minus infinity.
    pub fn ln(self) -> Interval {
        let cut = self.not_negative();
        cut.within(domain_at_least(self, 0.0))
            .rising(|x| if x > 0.0 { fmath::ln64(x) } else { f64::NEG_INFINITY })
    }

    /// The sine.
    pub fn sin(self) -> Interval {
        self.wave(fmath::sin64, FRAC_PI_2)
    }

    /// The cosine.
    pub fn cos(self) -> Interval {
        self.wave(fmath::cos64, 0.0)
    }

    /// A function of period 2 pi whose greatest value, 1, is at `crest`, and whose least, -1, half a period from there.
    fn wave(self, f: impl Fn(f64) -> f64, crest: f64) -> Interval {
        /// Beyond, the places of crests are not known to a good part of a period.
        const FAR: f64 = 1e9;
        let whole = Interval { lo: -1.0, hi: 1.0, ..self };
        let far = self.lo.abs().max(self.hi.abs());
        if far.is_nan() || far >= FAR || self.hi - self.lo >= TAU {
            return whole;
        }
        let margin = 1e-15 * (1.0 + far);
        let has = |extreme: f64| {
            // As `floor`, which is slow on machines of old.
            let periods = |x: f64| {
                let whole = ((x - extreme) / TAU) as i64;
                whole - i64::from((x - extreme) / TAU < whole as f64)
            };
            periods(self.hi + margin) > periods(self.lo - margin)
        };
        let (a, b) = (f(self.lo), f(self.hi));
        let values = self.loose(a.min(b), a.max(b));
        let lo = if has(crest + PI) { -1.0 } else { values.lo.max(-1.0) };
        let hi = if has(crest) { 1.0 } else { values.hi.min(1.0) };
        Interval { lo, hi, ..self }
    }

    /// The tangent.
    pub fn tan(self) -> Interval {
        let (sin, cos) = (self.sin(), self.cos());
        let quotient = sin / cos;
        // On a branch without a pole the function rises.
        if cos.contains(0.0) { quotient } else { quotient.intersection(self.rising(fmath::tan64)) }
    }

    /// The arc sine, which numbers from -1 to 1 have.
    pub fn asin(self) -> Interval {
        let domain = domain_at_least(self, -1.0).min(domain_at_least(-self, -1.0));
        self.within(domain).rising(|x| fmath::asin64(x.clamp(-1.0, 1.0)))
    }

    /// The arc cosine, which numbers from -1 to 1 have.
    pub fn acos(self) -> Interval {
        Interval::new(FRAC_PI_2.next_down(), FRAC_PI_2.next_up()) - self.asin()
    }

    /// The arc tangent.
    pub fn atan(self) -> Interval {
        self.rising(fmath::atan64)
    }

    /// The angle of the point `(x, self)` from the x axis, from -pi to pi.
    pub fn atan2(self, x: Interval) -> Interval {
        let domain = self.domain.min(x.domain);
        let crosses_cut = x.lo <= 0.0 && self.contains(0.0);
        let corners = [(self.lo, x.lo), (self.lo, x.hi), (self.hi, x.lo), (self.hi, x.hi)];
        let angles = corners.map(|(y, x)| fmath::atan2_64(y, x));
        let bounds = Interval { domain, ..self };
        if crosses_cut || angles.iter().any(|angle| angle.is_nan()) {
            return Interval { domain, ..Interval::new(-PI, PI) };
        }
        bounds.loose(angles.into_iter().fold(PI, f64::min), angles.into_iter().fold(-PI, f64::max))
    }

    /// A whole power.
    pub fn powi(self, n: i32) -> Interval {
        if n < 0 {
            return Interval::point(1.0) / self.powi(-n);
        }
        let even = n % 2 == 0;
        let base = if even { self.abs() } else { self };
        let (mut lo, mut hi) = (1.0_f64, 1.0_f64);
        // One rounding for each factor, the way numbers are multiplied.
        for _ in 0..n {
            lo = if base.lo >= 0.0 {
                (lo * base.lo).next_down().max(0.0)
            } else {
                (lo.abs() * -base.lo).next_up()
            };
            hi = if base.hi >= 0.0 {
                (hi * base.hi).next_up()
            } else {
                (hi.abs() * -base.hi).next_down().max(0.0)
            };
        }
        // Only odd powers have negative bases left.
        let lo = if base.lo < 0.0 && n > 0 { -lo } else { lo };
        let hi = if base.hi < 0.0 && n > 0 { -hi } else { hi };
        Interval { lo, hi, ..self }.or_too_large()
    }

    /// Any power. Negative numbers have whole powers only.
    pub fn pow(self, exponent: Interval) -> Interval {
        let domain = self.domain.min(exponent.domain);
        if self.lo < 0.0 {
            let has_whole = exponent.hi.floor() >= exponent.lo;
            let sizes = self.abs().pow(exponent);
            let domain =
                domain.min(if self.hi < 0.0 && !has_whole { Domain::Nowhere } else { Domain::Somewhere });
            return Interval { domain, ..if has_whole { sizes.hull(-sizes) } else { sizes } };
        }
        let power = (exponent * Interval { domain: Domain::Everywhere, ..self.ln() }).exp();
        let widest = 8.0 * f64::EPSILON * (1.0 + exponent.lo.abs().max(exponent.hi.abs()));
        // The logarithm of zero is infinite, and zero times that is not known.
        let hi = if self.lo == 0.0 && exponent.contains(0.0) { power.hi.max(1.0) } else { power.hi };
        let (lo, hi) = ((power.lo * (1.0 - widest)).max(0.0), hi * (1.0 + widest));
        let whole = Interval { lo, hi, domain }.or_too_large();
        if exponent.lo < 0.0 && self.lo == 0.0 { whole.within(Domain::Somewhere) } else { whole }
    }

    /// What is left of `self` divided by `divisor`, with the sign of the divisor.
    pub fn modulo(self, divisor: Interval) -> Interval {
        let quotient = self / divisor;
        let floors = quotient.stepped(f64::floor);
        let rest = self - divisor * floors;
        // It lies between zero and the divisor, but for rounding.
        let reach = 4.0 * f64::EPSILON * self.abs().hi;
        let bound = Interval::new(divisor.lo.min(0.0) - reach, divisor.hi.max(0.0) + reach);
        if rest.lo.is_nan() || rest.hi.is_nan() {
            return Interval { domain: rest.domain, ..bound };
        }
        rest.intersection(bound)
    }

    /// The part of the numbers that is not negative; zero where there is none.
    fn not_negative(self) -> Interval {
        Interval { lo: self.lo.max(0.0), hi: self.hi.max(0.0), ..self }
    }
}

/// Where a function has a value that numbers from `least` on have one of.
fn domain_at_least(x: Interval, least: f64) -> Domain {
    let domain = match (x.lo >= least, x.hi >= least) {
        (true, true) => Domain::Everywhere,
        (false, false) => Domain::Nowhere,
        _ => Domain::Somewhere,
    };
    domain.min(x.domain)
}

/// A number that is less by at least the distance to the next one, and not much more than twice that.
#[inline]
fn below(x: f64) -> f64 {
    // What is not a number stays so.
    let x = if x > f64::MAX { f64::MAX } else { x };
    x - (f64::EPSILON * x.abs() + f64::MIN_POSITIVE)
}

/// A number that is greater, as [`below`].
#[inline]
fn above(x: f64) -> f64 {
    -below(-x)
}

/// Zero for a product that has no value: of zero and infinity, which stands for large numbers.
#[inline]
fn product(a: f64, b: f64) -> f64 {
    if a == 0.0 || b == 0.0 { 0.0 } else { a * b }
}

impl Add for Interval {
    type Output = Interval;

    #[inline]
    fn add(self, other: Interval) -> Interval {
        // Exact, as many slopes are.
        if other.is_zero() {
            return self.within(other.domain);
        }
        if self.is_zero() {
            return other.within(self.domain);
        }
        self.within(other.domain).rounded(self.lo + other.lo, self.hi + other.hi)
    }
}

impl Sub for Interval {
    type Output = Interval;

    #[inline]
    fn sub(self, other: Interval) -> Interval {
        self + -other
    }
}

impl Neg for Interval {
    type Output = Interval;

    #[inline]
    fn neg(self) -> Interval {
        Interval { lo: -self.hi, hi: -self.lo, ..self }
    }
}

impl Mul for Interval {
    type Output = Interval;

    #[inline]
    fn mul(self, other: Interval) -> Interval {
        if self.is_zero() || other.is_zero() {
            return Interval::point(0.0).within(self.domain.min(other.domain));
        }
        let [a, b] = [product(self.lo, other.lo), product(self.lo, other.hi)];
        let [c, d] = [product(self.hi, other.lo), product(self.hi, other.hi)];
        self.within(other.domain).rounded(a.min(b).min(c.min(d)), a.max(b).max(c.max(d)))
    }
}

impl Div for Interval {
    type Output = Interval;

    #[inline]
    fn div(self, other: Interval) -> Interval {
        if other.contains(0.0) {
            return Interval::EVERYTHING.within(Domain::Somewhere.min(self.domain).min(other.domain));
        }
        let quotients =
            [self.lo / other.lo, self.lo / other.hi, self.hi / other.lo, self.hi / other.hi].map(|x| {
                // Infinity over infinity.
                if x.is_nan() { 0.0 } else { x }
            });
        let [a, b, c, d] = quotients;
        self.within(other.domain).rounded(a.min(b).min(c.min(d)), a.max(b).max(c.max(d)))
    }
}
