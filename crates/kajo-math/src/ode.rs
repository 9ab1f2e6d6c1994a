//! Initial value problems of ordinary differential equations, in double precision.
//!
//! The state is an array of `N` numbers that follows `dy/dt = f(t, y)`. [`Solver`] takes steps of the embedded pair of
//! orders 5 and 4 of Dormand and Prince, whose difference estimates the error of a step and so decides the length of the next.
//! A [`Step`] has the solution anywhere within it: an interpolant of order 4 made of the slopes that the step worked out
//! anyway, which is where events are to be found. [`rk4_step`] and [`euler_step`] are the classic methods of fixed steps.
//!
//! Steps may go backwards. Nothing is allocated. A right-hand side that is not finite makes a step shorter, so where there is
//! no solution any more the steps shrink until [`StepError`] ends them.
//!
//! [Dormand and Prince 1980, table 2], [Hairer et al. 1993, sections II.4 to II.6]

use crate::fmath::pow64;

/// How exact a step is: an error of `absolute + relative * |y|` in each component.
#[derive(Clone, Copy, Debug)]
pub struct Tolerance {
    /// In the units of the state.
    pub absolute: f64,
    /// As a part of the state.
    pub relative: f64,
}

/// Steps have become too short to move on, which happens where the solution ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepError {
    /// Where the last step that succeeded has ended.
    pub t: f64,
}

/// One step of the solution, and all that lies within.
///
/// Places in it are told by `theta`, the part of the step that has passed, from 0 to 1.
#[derive(Clone, Copy, Debug)]
pub struct Step<const N: usize> {
    t: f64,
    h: f64,
    start: [f64; N],
    end: [f64; N],
    end_slope: [f64; N],
    /// Coefficients of the interpolant [Hairer et al. 1993, eq. II.6.12, as their program `contd5` orders them].
    dense: [[f64; N]; 4],
}

impl<const N: usize> Step<N> {
    /// Where the step begins.
    #[inline]
    pub fn t(&self) -> f64 {
        self.t
    }

    /// How far it goes; negative for a step backwards.
    #[inline]
    pub fn h(&self) -> f64 {
        self.h
    }

    /// The state at the beginning.
    #[inline]
    pub fn start(&self) -> &[f64; N] {
        &self.start
    }

    /// The state at the end, of order 5.
    #[inline]
    pub fn end(&self) -> &[f64; N] {
        &self.end
    }

    /// `f` at the end.
    #[inline]
    pub fn end_slope(&self) -> &[f64; N] {
        &self.end_slope
    }

    /// The state at `theta`, of order 4. It is the start at 0 and the end at 1, up to rounding.
    #[inline]
    pub fn at(&self, theta: f64) -> [f64; N] {
        let rest = 1.0 - theta;
        let [a, b, c, d] = &self.dense;
        std::array::from_fn(|i| self.start[i] + theta * (a[i] + rest * (b[i] + theta * (c[i] + rest * d[i]))))
    }

    /// The derivative of [`at`](Step::at) with respect to `t`, of order 3.
    #[inline]
    pub fn slope_at(&self, theta: f64) -> [f64; N] {
        let rest = 1.0 - theta;
        let [a, b, c, d] = &self.dense;
        std::array::from_fn(|i| {
            let (inner, d_inner) = (c[i] + rest * d[i], -d[i]);
            let (middle, d_middle) = (b[i] + theta * inner, inner + theta * d_inner);
            let (outer, d_outer) = (a[i] + rest * middle, rest * d_middle - middle);
            (outer + theta * d_outer) / self.h
        })
    }

    /// A place in a bracket at which `g` of the state changes its sign: where an event happens.
    ///
    /// `None` if the signs at the ends of the bracket are equal. Zero counts as positive. The place is exact to about `1e-15` of
    /// the step, on the side of the sign at the end.
    ///
    /// * `bracket`: two values of `theta`, ascending
    /// * `g`: a continuous function of the state
    pub fn event(&self, bracket: [f64; 2], mut g: impl FnMut(&[f64; N]) -> f64) -> Option<f64> {
        let [mut lo, mut hi] = bracket;
        let (mut g_lo, mut g_hi) = (g(&self.at(lo)), g(&self.at(hi)));
        if (g_lo < 0.0) == (g_hi < 0.0) {
            return None;
        }
        // Regula falsi, where a bound that stays twice is given less weight (the Illinois method); bisection every third time
        // makes sure of its end.
        let mut kept = 0i8;
        for round in 0..200 {
            let width = hi - lo;
            if width <= 4.0 * f64::EPSILON * hi.abs().max(0.25) {
                break;
            }
            let chord = lo + width * (g_lo / (g_lo - g_hi));
            let bisect = round % 3 == 2 || !chord.is_finite() || chord <= lo || chord >= hi;
            let theta = if bisect { lo + 0.5 * width } else { chord };
            let value = g(&self.at(theta));
            if (value < 0.0) == (g_hi < 0.0) {
                (hi, g_hi) = (theta, value);
                g_lo *= if kept == 1 { 0.5 } else { 1.0 };
                kept = 1;
            } else {
                (lo, g_lo) = (theta, value);
                g_hi *= if kept == -1 { 0.5 } else { 1.0 };
                kept = -1;
            }
        }
        Some(hi)
    }
}

/// One step of the pair of Dormand and Prince, and the estimate of its error in each component.
///
/// * `slope`: `f(t, y)`, which is the [`end_slope`](Step::end_slope) of the step before
/// * `h`: how far to go, of either sign
pub fn dormand_prince_step<const N: usize>(
    f: &mut impl FnMut(f64, &[f64; N]) -> [f64; N],
    t: f64,
    y: &[f64; N],
    slope: &[f64; N],
    h: f64,
) -> (Step<N>, [f64; N]) {
    let k1 = slope;
    let sum = |terms: &[(f64, &[f64; N])]| -> [f64; N] {
        std::array::from_fn(|i| h * terms.iter().fold(0.0, |sum, (weight, k)| sum + weight * k[i]))
    };
    let moved = |by: [f64; N]| -> [f64; N] { std::array::from_fn(|i| y[i] + by[i]) };
    let k2 = f(t + h / 5.0, &moved(sum(&[(1.0 / 5.0, k1)])));
    let k3 = f(t + h * 0.3, &moved(sum(&[(3.0 / 40.0, k1), (9.0 / 40.0, &k2)])));
    let k4 = f(t + h * 0.8, &moved(sum(&[(44.0 / 45.0, k1), (-56.0 / 15.0, &k2), (32.0 / 9.0, &k3)])));
    let fifth =
        [(19372.0 / 6561.0, k1), (-25360.0 / 2187.0, &k2), (64448.0 / 6561.0, &k3), (-212.0 / 729.0, &k4)];
    let k5 = f(t + h * (8.0 / 9.0), &moved(sum(&fifth)));
    let sixth = [
        (9017.0 / 3168.0, k1),
        (-355.0 / 33.0, &k2),
        (46732.0 / 5247.0, &k3),
        (49.0 / 176.0, &k4),
        (-5103.0 / 18656.0, &k5),
    ];
    let k6 = f(t + h, &moved(sum(&sixth)));
    let seventh = [
        (35.0 / 384.0, k1),
        (500.0 / 1113.0, &k3),
        (125.0 / 192.0, &k4),
        (-2187.0 / 6784.0, &k5),
        (11.0 / 84.0, &k6),
    ];
    let end = moved(sum(&seventh));
    let k7 = f(t + h, &end);
    let error = sum(&[
        (71.0 / 57600.0, k1),
        (-71.0 / 16695.0, &k3),
        (71.0 / 1920.0, &k4),
        (-17253.0 / 339_200.0, &k5),
        (22.0 / 525.0, &k6),
        (-1.0 / 40.0, &k7),
    ]);
    let quartic = sum(&[
        (-12_715_105_075.0 / 11_282_082_432.0, k1),
        (87_487_479_700.0 / 32_700_410_799.0, &k3),
        (-10_690_763_975.0 / 1_880_347_072.0, &k4),
        (701_980_252_875.0 / 199_316_789_632.0, &k5),
        (-1_453_857_185.0 / 822_651_844.0, &k6),
        (69_997_945.0 / 29_380_423.0, &k7),
    ]);
    let dense = dense_output([y, &end], [k1, &k7], h, quartic);
    (Step { t, h, start: *y, end, end_slope: k7, dense }, error)
}

/// The coefficients of the interpolant between the ends of a step, of which `quartic` is the last.
#[inline]
fn dense_output<const N: usize>(
    [start, end]: [&[f64; N]; 2],
    slopes: [&[f64; N]; 2],
    h: f64,
    quartic: [f64; N],
) -> [[f64; N]; 4] {
    let chord: [f64; N] = std::array::from_fn(|i| end[i] - start[i]);
    let bend: [f64; N] = std::array::from_fn(|i| h * slopes[0][i] - chord[i]);
    let cubic = std::array::from_fn(|i| chord[i] - h * slopes[1][i] - bend[i]);
    [chord, bend, cubic, quartic]
}

/// Follows a solution by steps whose lengths are such that their errors stay within a tolerance.
#[derive(Clone, Copy, Debug)]
pub struct Solver<const N: usize> {
    t: f64,
    y: [f64; N],
    slope: [f64; N],
    /// Length of the next step, positive.
    h: f64,
    tolerance: Tolerance,
    /// Error of the last step in units of the tolerance.
    last_error: f64,
}

impl<const N: usize> Solver<N> {
    /// A solution that is `y` at `t`.
    ///
    /// The length of its first step is that for which a step of Euler's method, and the change of slope in it, are small against
    /// the tolerance [Hairer et al. 1993, section II.4].
    pub fn new(
        f: &mut impl FnMut(f64, &[f64; N]) -> [f64; N],
        t: f64,
        y: [f64; N],
        tolerance: Tolerance,
    ) -> Solver<N> {
        let slope = f(t, &y);
        let d0 = scaled_norm(&y, &y, &y, tolerance);
        let d1 = scaled_norm(&slope, &y, &y, tolerance);
        let h0 = if d0 > 1e-5 && d1 > 1e-5 { 0.01 * d0 / d1 } else { 1e-6 };
        let tried: [f64; N] = std::array::from_fn(|i| y[i] + h0 * slope[i]);
        let slope_there = f(t + h0, &tried);
        let change = std::array::from_fn(|i| slope_there[i] - slope[i]);
        let d2 = scaled_norm(&change, &y, &y, tolerance) / h0;
        let larger = d1.max(d2);
        let h1 = if larger > 1e-15 { pow64(0.01 / larger, 0.2) } else { h0.max(1e-3) };
        let h = if h1.is_finite() { h1.min(100.0 * h0) } else { h0 };
        Solver { t, y, slope, h, tolerance, last_error: 1e-4 }
    }

    /// Where the solution has come to.
    #[inline]
    pub fn t(&self) -> f64 {
        self.t
    }

    /// The state there.
    #[inline]
    pub fn y(&self) -> &[f64; N] {
        &self.y
    }

    /// `f` there.
    #[inline]
    pub fn slope(&self) -> &[f64; N] {
        &self.slope
    }

    /// Makes the next step no longer than `h`, which is positive.
    #[inline]
    pub fn limit_step(&mut self, h: f64) {
        self.h = self.h.min(h);
    }

    /// Goes on from a state that was corrected, for instance by what is known to be conserved.
    #[inline]
    pub fn correct(&mut self, f: &mut impl FnMut(f64, &[f64; N]) -> [f64; N], y: [f64; N]) {
        self.y = y;
        self.slope = f(self.t, &y);
    }

    /// Takes a step towards `end`, and never beyond; `end` is not where the solution is already.
    ///
    /// # Errors
    ///
    /// If steps have become too short to tell their ends apart.
    pub fn step(
        &mut self,
        f: &mut impl FnMut(f64, &[f64; N]) -> [f64; N],
        end: f64,
    ) -> Result<Step<N>, StepError> {
        let ahead = end - self.t;
        let mut rejected = false;
        loop {
            // A step that all but reaches the end goes there, so that no tiny one is left.
            let is_last = self.h * 1.01 >= ahead.abs();
            let h = if is_last { ahead } else { self.h.copysign(ahead) };
            if self.t + 0.1 * h == self.t || h.is_nan() {
                return Err(StepError { t: self.t });
            }
            let (step, error) = dormand_prince_step(f, self.t, &self.y, &self.slope, h);
            let error = scaled_norm(&error, &self.y, &step.end, self.tolerance);
            let is_finite = error.is_finite() && step.end_slope.iter().all(|k| k.is_finite());
            if !is_finite {
                self.h = 0.2 * h.abs();
                rejected = true;
                continue;
            }
            // Control by the last two errors [Hairer and Wanner 1996, section IV.2, beta = 0.04].
            const BETA: f64 = 0.04;
            let growth = 0.9 * pow64(error.max(1e-10), -(0.2 - 0.75 * BETA));
            if error > 1.0 {
                self.h = h.abs() * growth.clamp(0.2, 0.9);
                rejected = true;
                continue;
            }
            let growth = growth * pow64(self.last_error, BETA);
            let growth = growth.clamp(0.2, if rejected { 1.0 } else { 10.0 });
            // A step cut short by its end says little about how long the next may be.
            let next = h.abs() * growth;
            self.h = if is_last && !rejected { next.max(self.h) } else { next };
            self.last_error = error.max(1e-4);
            self.t = if is_last { end } else { self.t + h };
            self.y = step.end;
            self.slope = step.end_slope;
            return Ok(step);
        }
    }
}

/// The largest component of `v` in units of the tolerance for states between two.
fn scaled_norm<const N: usize>(v: &[f64; N], from: &[f64; N], to: &[f64; N], tolerance: Tolerance) -> f64 {
    let mut largest = 0.0f64;
    for i in 0..N {
        let unit = tolerance.absolute + tolerance.relative * from[i].abs().max(to[i].abs());
        let part = v[i].abs() / unit;
        // Not `max`, which passes over what is no number.
        if part > largest || part.is_nan() {
            largest = part;
        }
    }
    largest
}

/// The state after a step of the classic method of order 4 [Kutta 1901].
pub fn rk4_step<const N: usize>(
    f: &mut impl FnMut(f64, &[f64; N]) -> [f64; N],
    t: f64,
    y: &[f64; N],
    h: f64,
) -> [f64; N] {
    let moved = |k: &[f64; N], by: f64| -> [f64; N] { std::array::from_fn(|i| y[i] + by * k[i]) };
    let k1 = f(t, y);
    let k2 = f(t + 0.5 * h, &moved(&k1, 0.5 * h));
    let k3 = f(t + 0.5 * h, &moved(&k2, 0.5 * h));
    let k4 = f(t + h, &moved(&k3, h));
    std::array::from_fn(|i| y[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]))
}

/// The state after a step of Euler's method, of order 1.
pub fn euler_step<const N: usize>(
    f: &mut impl FnMut(f64, &[f64; N]) -> [f64; N],
    t: f64,
    y: &[f64; N],
    h: f64,
) -> [f64; N] {
    let k = f(t, y);
    std::array::from_fn(|i| y[i] + h * k[i])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fmath::{cos64, exp64, ln64, sin64};
    use std::f64::consts::{FRAC_PI_2, TAU};

    const TIGHT: Tolerance = Tolerance { absolute: 1e-12, relative: 1e-12 };

    fn oscillator(_: f64, y: &[f64; 2]) -> [f64; 2] {
        [y[1], -y[0]]
    }

    /// A problem without symmetry: `y' = y cos t`, `y = exp(sin t)`.
    fn swelling(t: f64, y: &[f64; 1]) -> [f64; 1] {
        [y[0] * cos64(t)]
    }

    /// The order that errors at `n` and `2 n` steps say a method has.
    fn order(errors: [f64; 2]) -> f64 {
        ln64(errors[0] / errors[1]) / ln64(2.0)
    }

    fn error_of_fixed_steps(n: u32, mut step: impl FnMut(f64, &[f64; 1], f64) -> [f64; 1]) -> f64 {
        let h = 2.0 / f64::from(n);
        let mut y = [1.0];
        for i in 0..n {
            y = step(f64::from(i) * h, &y, h);
        }
        (y[0] - exp64(sin64(2.0))).abs()
    }

    #[test]
    fn methods_have_their_orders() {
        let dp = |n| {
            error_of_fixed_steps(n, |t, y, h| {
                *dormand_prince_step(&mut swelling, t, y, &swelling(t, y), h).0.end()
            })
        };
        let rk4 = |n| error_of_fixed_steps(n, |t, y, h| rk4_step(&mut swelling, t, y, h));
        let euler = |n| error_of_fixed_steps(n, |t, y, h| euler_step(&mut swelling, t, y, h));
        for (name, expected, found) in [
            ("Dormand-Prince", 5.0, order([dp(32), dp(64)])),
            ("Runge-Kutta 4", 4.0, order([rk4(64), rk4(128)])),
            ("Euler", 1.0, order([euler(512), euler(1024)])),
        ] {
            assert!((found - expected).abs() < 0.15, "{name}: order {found}");
        }
    }

    /// Within a step the error is of one power of its length more than the order of the interpolant.
    #[test]
    fn dense_output_is_of_order_4_and_its_slope_of_order_3() {
        let errors = |h: f64| {
            let (step, _) = dormand_prince_step(
                &mut swelling,
                0.3,
                &[exp64(sin64(0.3))],
                &[exp64(sin64(0.3)) * cos64(0.3)],
                h,
            );
            let (mut value, mut slope) = (0.0f64, 0.0f64);
            for i in 1..20 {
                let theta = f64::from(i) / 20.0;
                let t = 0.3 + theta * h;
                let exact = exp64(sin64(t));
                value = value.max((step.at(theta)[0] - exact).abs());
                slope = slope.max((step.slope_at(theta)[0] - exact * cos64(t)).abs());
            }
            (value, slope)
        };
        let (coarse, fine) = (errors(0.1), errors(0.05));
        let (value, slope) = (order([coarse.0, fine.0]), order([coarse.1, fine.1]));
        assert!((value - 5.0).abs() < 0.2, "value: h^{value}");
        assert!((slope - 4.0).abs() < 0.2, "slope: h^{slope}");
    }

    #[test]
    fn interpolant_joins_the_ends_and_their_slopes() {
        let y = [0.4, -1.2];
        let (step, _) = dormand_prince_step(&mut oscillator, 0.0, &y, &oscillator(0.0, &y), 0.3);
        for i in 0..2 {
            assert!((step.at(0.0)[i] - y[i]).abs() < 1e-15);
            assert!((step.at(1.0)[i] - step.end()[i]).abs() < 1e-15);
            assert!((step.slope_at(0.0)[i] - oscillator(0.0, &y)[i]).abs() < 1e-14);
            assert!((step.slope_at(1.0)[i] - step.end_slope()[i]).abs() < 1e-14);
        }
    }

    fn follow<const N: usize>(
        f: &mut impl FnMut(f64, &[f64; N]) -> [f64; N],
        t: f64,
        y: [f64; N],
        end: f64,
        tolerance: Tolerance,
    ) -> ([f64; N], u32) {
        let mut solver = Solver::new(f, t, y, tolerance);
        let mut n = 0;
        while solver.t() != end {
            solver.step(f, end).expect("a smooth problem");
            n += 1;
            assert!(n < 100_000);
        }
        (*solver.y(), n)
    }

    #[test]
    fn oscillator_comes_back_after_ten_periods() {
        let (y, n) = follow(&mut oscillator, 0.0, [1.0, 0.0], 10.0 * TAU, TIGHT);
        assert!((y[0] - 1.0).abs() < 1e-9 && y[1].abs() < 1e-9, "{y:?}");
        // Tolerance to the power 1/5, so a hundred times as exact takes 2.5 times the steps.
        let (_, fewer) = follow(
            &mut oscillator,
            0.0,
            [1.0, 0.0],
            10.0 * TAU,
            Tolerance { absolute: 1e-10, relative: 1e-10 },
        );
        let ratio = f64::from(n) / f64::from(fewer);
        assert!((2.2..2.9).contains(&ratio), "{n} / {fewer}");
    }

    #[test]
    fn integrating_back_returns_to_the_start() {
        let start = [0.3, 0.9];
        let (there, _) = follow(&mut oscillator, 1.0, start, 8.0, TIGHT);
        let (back, _) = follow(&mut oscillator, 8.0, there, 1.0, TIGHT);
        assert!((back[0] - start[0]).abs() < 1e-10 && (back[1] - start[1]).abs() < 1e-10);
    }

    /// The error of the whole follows the tolerance, also where scales differ along the way: an orbit of eccentricity 0.9.
    #[test]
    fn steps_follow_what_the_problem_asks_for() {
        let mut kepler = |_: f64, y: &[f64; 4]| {
            let r = (y[0] * y[0] + y[1] * y[1]).sqrt();
            [y[2], y[3], -y[0] / (r * r * r), -y[1] / (r * r * r)]
        };
        let e: f64 = 0.9;
        let start = [1.0 - e, 0.0, 0.0, ((1.0 + e) / (1.0 - e)).sqrt()];
        let (y, n) = follow(&mut kepler, 0.0, start, TAU, TIGHT);
        for i in 0..4 {
            assert!((y[i] - start[i]).abs() < 1e-7, "{y:?}");
        }
        assert!(n < 1500, "{n} steps");
    }

    #[test]
    fn events_are_found_where_they_happen() {
        let mut solver = Solver::new(&mut oscillator, 0.0, [1.0, 0.0], TIGHT);
        let found = loop {
            let step = solver.step(&mut oscillator, 10.0).expect("smooth");
            if let Some(theta) = step.event([0.0, 1.0], |y| y[0]) {
                break step.t() + theta * step.h();
            }
        };
        assert!((found - FRAC_PI_2).abs() < 1e-10, "{found}");
        let (step, _) = dormand_prince_step(&mut oscillator, 0.0, &[1.0, 0.0], &[0.0, -1.0], 0.1);
        assert_eq!(step.event([0.0, 1.0], |y| y[0]), None);
        // The place returned is beyond the change of sign, or on it.
        let theta = step.event([0.0, 1.0], |y| y[0] - 0.999).expect("cos falls to 0.995");
        assert!(step.at(theta)[0] - 0.999 < 0.0);
    }

    #[test]
    fn solutions_that_end_are_an_error_and_no_endless_loop() {
        // 1 / (1 - t) has a pole at 1; (1 - 3/4 t)^(2/3) reaches zero at 4/3, beyond which its root is no number.
        let mut pole = |_: f64, y: &[f64; 1]| [y[0] * y[0]];
        let mut root = |_: f64, y: &[f64; 1]| [-1.0 / (2.0 * y[0].sqrt())];
        for (f, start) in
            [(&mut pole as &mut dyn FnMut(f64, &[f64; 1]) -> [f64; 1], [1.0]), (&mut root, [1.0])]
        {
            let mut f = |t: f64, y: &[f64; 1]| f(t, y);
            let mut solver = Solver::new(&mut f, 0.0, start, TIGHT);
            let mut n = 0;
            let end = loop {
                match solver.step(&mut f, 3.0) {
                    Ok(_) => n += 1,
                    Err(end) => break end.t,
                }
                assert!(n < 10_000);
            };
            assert!(end > 0.999 && end < 4.0 / 3.0 + 1e-6, "{end}");
        }
        let mut nothing = |_: f64, _: &[f64; 1]| [f64::NAN];
        let mut solver = Solver::new(&mut nothing, 0.0, [1.0], TIGHT);
        assert_eq!(solver.step(&mut nothing, 1.0).err(), Some(StepError { t: 0.0 }));
    }

    #[test]
    fn a_corrected_state_goes_on_with_its_own_slope() {
        let mut solver = Solver::new(&mut oscillator, 0.0, [1.0, 0.0], TIGHT);
        solver.limit_step(0.01);
        solver.step(&mut oscillator, 10.0).expect("smooth");
        assert!(solver.t() <= 0.01);
        solver.correct(&mut oscillator, [2.0, 0.5]);
        assert_eq!((*solver.y(), *solver.slope()), ([2.0, 0.5], [0.5, -2.0]));
    }
}
