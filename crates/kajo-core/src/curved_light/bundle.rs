//! Rays infinitely near to one that is followed: how its neighbours part from it.
//!
//! With the state `y` of a ray, the states of neighbouring rays differ from it by `δ`, which follows the linear equation
//!
//! ```text
//! dδ/ds = (∂f/∂y) δ,      f(y) = dy/ds
//! ```
//!
//! the geodesic deviation of relativity, and the paraxial rays of optics. It is integrated beside the ray itself by the classic method of
//! Runge and Kutta over several steps of the ray at a time, as these are shorter than it asks for, with the cubic of
//! Hermite for the ray between, and `(∂f/∂y) δ` is a difference of slopes. Two such rays, those of the neighbouring
//! pixels, bound a bundle of light, whose cross section is what a pixel covers of the sky or of a surface.
//!
//! [Born and Wolf 1999, 3.2], [Misner et al. 1973, 22.5], and for pictures [James et al. 2015, A.2]

use kajo_math::DVec3;
use kajo_math::ode::Step;

use super::{RayEquation, RayState};
use crate::differential::RayDifferential;

/// Length of the difference that a derivative is taken over, in units of the state.
const DIFFERENCE: f64 = 1e-6;

/// The part of the body's extent after which a bundle catches up with its ray.
const LONGEST: f64 = 1.0 / 32.0;

/// The most steps of the ray that it goes over at once.
const STEPS: u32 = 8;

/// Differences of two neighbouring rays from the one that is followed, in the units in which that is.
#[derive(Clone, Copy, Debug)]
pub(super) struct RayBundle {
    delta: [RayState; 2],
    /// The ray where they differ so, and its slope there.
    y: RayState,
    slope: RayState,
    /// How far the ray has gone since then, and by how many steps.
    ahead: f64,
    steps: u32,
}

/// A bundle at the end of the way, in world space, where it has gone as far as the ray itself by its parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BundleEnd {
    /// Differences of the points of two neighbouring rays.
    pub dp: [DVec3; 2],
    /// Differences of their unit directions.
    pub dd: [DVec3; 2],
    /// Derivative of the point along the curve.
    pub velocity: DVec3,
    /// Derivative of the unit direction along the curve.
    pub turn: DVec3,
}

impl BundleEnd {
    /// Differences where the neighbours come to the plane through the end of the ray, as [`RayDifferential::transferred`].
    ///
    /// * `ng`: unit normal of the plane, on either side, in the coordinates that points have
    pub fn on_plane(&self, ng: DVec3) -> RayDifferential {
        let [dp, dd] = [0, 1].map(|i| {
            let ds = -self.dp[i].dot(ng) / self.velocity.dot(ng);
            [self.dp[i] + ds * self.velocity, self.dd[i] + ds * self.turn]
        });
        let [[dp0, dd0], [dp1, dd1]] = [dp, dd].map(|pair| pair.map(DVec3::as_vec3));
        RayDifferential { dp: [dp0, dp1], dd: [dd0, dd1] }.usable()
    }

    /// Differences where the neighbours have gone as far as the ray.
    pub fn here(&self) -> RayDifferential {
        RayDifferential { dp: self.dp.map(DVec3::as_vec3), dd: self.dd.map(DVec3::as_vec3) }.usable()
    }
}

/// The derivative of `f` at `y` along `by`; zero where that is.
fn derivative<const N: usize>(
    y: &RayState,
    by: &RayState,
    mut f: impl FnMut(&RayState) -> Option<[f64; N]>,
) -> Option<[f64; N]> {
    let size = by.iter().fold(0.0, |size: f64, v| size.max(v.abs()));
    if size == 0.0 {
        return Some([0.0; N]);
    }
    let e = DIFFERENCE / size;
    let there = f(&moved(y, by, e))?;
    let back = f(&moved(y, by, -e))?;
    Some(std::array::from_fn(|i| (there[i] - back[i]) / (2.0 * e)))
}

/// `y + t by`
fn moved(y: &RayState, by: &RayState, t: f64) -> RayState {
    std::array::from_fn(|i| y[i] + t * by[i])
}

impl RayBundle {
    /// The bundle at the start of a ray; `None` where there is no light beside it.
    ///
    /// * `start`: the state at a point and a direction of any length, in the units of the bundle
    /// * `scale`: how much longer the unit of points is than that of `around`
    pub fn start(
        (p, d): (DVec3, DVec3),
        around: &RayDifferential,
        scale: f64,
        start: impl Fn(DVec3, DVec3) -> Option<RayState>,
        slope: impl Fn(&RayState) -> RayState,
    ) -> Option<RayBundle> {
        let beside = |i: usize| {
            let (dp, dd) = (around.dp[i].as_dvec3(), around.dd[i].as_dvec3());
            let size = (dp.length() / scale).max(dd.length());
            if size == 0.0 {
                return Some([0.0; 8]);
            }
            let e = DIFFERENCE / size;
            let at = |e: f64| start(p + e * dp, (d + e * dd).normalize());
            let (there, back) = (at(e)?, at(-e)?);
            Some(std::array::from_fn(|k| (there[k] - back[k]) / (2.0 * e)))
        };
        let y = start(p, d)?;
        let delta = [beside(0)?, beside(1)?];
        Some(RayBundle { delta, y, slope: slope(&y), ahead: 0.0, steps: 0 })
    }

    /// Goes along with a step of the ray.
    ///
    /// * `theta`: up to which part of the step
    pub fn advance(&mut self, step: &Step<8>, theta: f64, slope: impl Fn(&RayState) -> RayState) {
        (self.ahead, self.steps) = (self.ahead + theta * step.h(), self.steps + 1);
        if self.steps == STEPS || self.ahead > LONGEST {
            self.catch_up(&step.at(theta), slope);
        }
    }

    /// Goes to where the ray is.
    ///
    /// * `y`: the ray there
    pub fn catch_up(&mut self, y: &RayState, slope: impl Fn(&RayState) -> RayState) {
        let h = std::mem::take(&mut self.ahead);
        self.steps = 0;
        if h == 0.0 {
            return;
        }
        let end = slope(y);
        let middle: RayState =
            std::array::from_fn(|i| 0.5 * (self.y[i] + y[i]) + 0.125 * h * (self.slope[i] - end[i]));
        let within = slope(&middle);
        // The ray itself is what its neighbours are compared with.
        let change = |(y, own): (&RayState, &RayState), by: &RayState| -> RayState {
            let size = by.iter().fold(f64::MIN_POSITIVE, |size: f64, v| size.max(v.abs()));
            let e = DIFFERENCE / size;
            let there = slope(&moved(y, by, e));
            std::array::from_fn(|i| (there[i] - own[i]) / e)
        };
        for delta in &mut self.delta {
            let k1 = change((&self.y, &self.slope), delta);
            let k2 = change((&middle, &within), &moved(delta, &k1, 0.5 * h));
            let k3 = change((&middle, &within), &moved(delta, &k2, 0.5 * h));
            let k4 = change((y, &end), &moved(delta, &k3, h));
            *delta = std::array::from_fn(|i| delta[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]));
        }
        (self.y, self.slope) = (*y, end);
    }

    /// Goes through a gate, to which the neighbours come a little earlier or later; `None` where they do not.
    ///
    /// * `y`: the ray before the gate
    /// * `before`: [`RayEquation::before_gate`]
    /// * `through`: [`RayEquation::through_gate`]
    /// * `slope`: of the ray
    pub fn through_gate(
        mut self,
        y: &RayState,
        before: impl Fn(&RayState) -> f64,
        through: impl Fn(&RayState) -> Option<RayState>,
        slope: impl Fn(&RayState) -> RayState,
    ) -> Option<RayBundle> {
        self.catch_up(y, &slope);
        let [approach] = derivative(y, &self.slope, |y| Some([before(y)]))?;
        let beyond = |delta: &RayState| {
            let [ahead] = derivative(y, delta, |y| Some([before(y)]))?;
            derivative(y, &moved(delta, &self.slope, -ahead / approach), &through)
        };
        let [first, second] = &self.delta;
        let (delta, y) = ([beyond(first)?, beyond(second)?], through(y)?);
        Some(RayBundle { delta, y, slope: slope(&y), ahead: 0.0, steps: 0 })
    }

    /// The bundle at the end of the way.
    ///
    /// * `y`: the end of the ray
    /// * `slope`: of the ray
    /// * `in_world`: from the units of the bundle
    /// * `scale`: how much longer the unit of points is than that of the world
    pub fn end(
        mut self,
        equation: &impl RayEquation,
        y: &RayState,
        slope: impl Fn(&RayState) -> RayState,
        in_world: impl Fn(&RayState) -> RayState,
        scale: f64,
    ) -> BundleEnd {
        self.catch_up(y, &slope);
        let turned = |by: &RayState| {
            let direction = |y: &RayState| Some(equation.direction(&in_world(y)).to_array());
            derivative(y, by, direction).map_or(DVec3::ZERO, DVec3::from)
        };
        let [first, second] = &self.delta;
        let along = slope(y);
        BundleEnd {
            dp: [first, second].map(|delta| scale * super::position(delta)),
            dd: [first, second].map(turned),
            velocity: super::position(&along),
            turn: turned(&along) / scale,
        }
    }
}
