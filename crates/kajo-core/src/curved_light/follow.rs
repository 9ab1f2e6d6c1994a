//! Following a ray along its curve until it meets something.

use kajo_math::ode::{Solver, Step, Tolerance, euler_step, rk4_step};
use kajo_math::{DVec3, Ray};

use super::bundle::RayBundle;
use super::{Chords, Followed, Outcome, RayEquation, RayState, Region, SAG, Stepping, position};
use crate::differential::RayDifferential;

/// Errors of a step, in units of the body's extent for positions and of the momentum's own for that.
pub(crate) const TOLERANCE: Tolerance = Tolerance { absolute: 1e-11, relative: 1e-10 };

/// Steps after which light counts as lost: it may go around for ever.
const MOST_STEPS: u32 = 1 << 14;

/// Most chords of one step.
const MOST_CHORDS: f64 = 4096.0;

/// The longest step in parts of the body's extent: no thin layer is stepped over unseen.
const LONGEST_STEP: f64 = 1.0 / 16.0;

/// How far a ray may be outside of the box around the body, in parts of its extent, before it has left.
const BESIDE: f64 = 1e-3;

/// How far two chords overlap, in parts of a chord, so that rounding leaves no gap between them.
const OVERLAP: f32 = 1e-4;

/// Follows a ray through a body until it meets a surface.
///
/// * `ray`: starts inside of the body; its direction has unit length
/// * `around`: how neighbouring rays differ from it, if they are to be followed too; steps of a fixed length leave them behind
pub fn follow(
    equation: &impl RayEquation,
    ray: &Ray,
    around: Option<&RayDifferential>,
    region: &Region,
    chords: &mut impl Chords,
) -> Followed {
    let way =
        RegionUnits { equation, time: ray.time, center: region.center(), extent: region.extent(), region };
    let (p, d) = (ray.o.as_dvec3(), ray.d.as_dvec3());
    let Some(start) = equation.start(p, d).filter(|y| y.iter().all(|v| v.is_finite())) else {
        return way.lost(ray);
    };
    match equation.stepping() {
        Stepping::Adaptive => {
            let bundle = around.and_then(|around| way.bundle(p, d, around));
            way.adaptive(&start, ray, bundle, chords)
        }
        Stepping::Euler(steps) => way.fixed(&start, ray, steps, chords, |y, h| {
            euler_step(&mut |_, y: &RayState| way.slope(y), 0.0, y, h)
        }),
        Stepping::RungeKutta(steps) => way.fixed(&start, ray, steps, chords, |y, h| {
            rk4_step(&mut |_, y: &RayState| way.slope(y), 0.0, y, h)
        }),
    }
}

/// A way through a body in units of the body: positions from its centre, lengths in parts of its extent.
struct RegionUnits<'a, E> {
    equation: &'a E,
    /// Moment within the shutter interval.
    time: f32,
    center: DVec3,
    extent: f64,
    region: &'a Region,
}

impl<E: RayEquation> RegionUnits<'_, E> {
    fn in_units(&self, y: &RayState) -> RayState {
        let p = (position(y) - self.center) / self.extent;
        [p.x, p.y, p.z, y[3], y[4], y[5], y[6] / self.extent, y[7] / self.extent]
    }

    fn in_world(&self, y: &RayState) -> RayState {
        let p = self.center + self.extent * position(y);
        [p.x, p.y, p.z, y[3], y[4], y[5], y[6] * self.extent, y[7] * self.extent]
    }

    fn slope(&self, y: &RayState) -> RayState {
        // By a parameter in units of the extent too, so that only the change of momentum has another size.
        let mut slope = self.equation.slope(&self.in_world(y));
        slope[3..6].iter_mut().for_each(|v| *v *= self.extent);
        slope
    }

    fn chord(&self, from: &RayState, to: &RayState) -> Ray {
        let [a, b] = [from, to].map(|y| (self.center + self.extent * position(y)).as_vec3());
        Ray { o: a, t_min: 0.0, d: b - a, t_max: 1.0 + OVERLAP, time: self.time }
    }

    /// The bundle around a ray at its start.
    #[cold]
    fn bundle(&self, p: DVec3, d: DVec3, around: &RayDifferential) -> Option<RayBundle> {
        let start = |p: DVec3, d: DVec3| self.equation.start(p, d).map(|y| self.in_units(&y));
        RayBundle::start((p, d), around, self.extent, start, |y| self.slope(y))
    }

    /// Takes a bundle along a step, and through the gate at the end of it.
    #[cold]
    fn carry(&self, bundle: &mut Option<RayBundle>, step: &Step<8>, theta: f64, is_gate: bool) {
        let Some(delta) = bundle else { return };
        delta.advance(step, theta, |y| self.slope(y));
        if is_gate {
            let y = step.at(theta);
            let before = |y: &RayState| self.equation.before_gate(&self.in_world(y));
            let through =
                |y: &RayState| self.equation.through_gate(&self.in_world(y)).map(|y| self.in_units(&y));
            *bundle = delta.through_gate(&y, before, through, |y| self.slope(y));
        }
    }

    /// Steps with error control.
    fn adaptive(
        &self,
        start: &RayState,
        ray: &Ray,
        mut bundle: Option<RayBundle>,
        chords: &mut impl Chords,
    ) -> Followed {
        let mut f = |_: f64, y: &RayState| self.slope(y);
        let mut solver = Solver::new(&mut f, 0.0, self.in_units(start), TOLERANCE);
        for _ in 0..MOST_STEPS {
            let longest = self.equation.longest_step(&self.in_world(solver.y())) / self.extent;
            solver.limit_step(LONGEST_STEP.min(longest));
            let Ok(step) = solver.step(&mut f, f64::from(MOST_STEPS)) else { break };
            let gate = if self.equation.has_gate() { self.gate(&step) } else { None };
            let last = gate.unwrap_or(1.0);
            let finest = SAG.min(self.equation.largest_sag(&self.in_world(step.end())) / self.extent);
            let n = (sag(&step, 0.0, last) / finest).sqrt().ceil().clamp(1.0, MOST_CHORDS);
            let mut a = 0.0;
            for i in 1..=n as u32 {
                let b = last * f64::from(i) / n;
                if let Some((theta, chord)) = self.first_meeting(&step, [a, b], chords) {
                    let o = self.chord(&step.at(a), &step.at(b)).o;
                    chords.passed(&Ray { o, d: chord.o - o, t_max: 1.0, ..chord });
                    self.carry(&mut bundle, &step, theta, false);
                    return self.end(Outcome::Meets, start, &step.at(theta), chord, bundle);
                }
                chords.passed(&Ray { t_max: 1.0, ..self.chord(&step.at(a), &step.at(b)) });
                a = b;
            }
            self.carry(&mut bundle, &step, last, gate.is_some());
            if gate.is_some() {
                let there = self.equation.through_gate(&self.in_world(&step.at(last)));
                let Some(y) = there else {
                    let chord = self.chord(step.start(), step.end());
                    return self.end(Outcome::Absorbed, start, &step.at(last), chord, None);
                };
                solver = Solver::new(&mut f, 0.0, self.in_units(&y), TOLERANCE);
                continue;
            }
            let y = self.in_units(&self.equation.corrected(&self.in_world(step.end())));
            if let Some(outcome) = self.outcome(&y) {
                return self.end(outcome, start, &y, self.chord(step.start(), &y), bundle);
            }
            if y != *step.end() {
                solver.correct(&mut f, y);
            }
        }
        self.lost(ray)
    }

    /// Where a step comes to the gate.
    fn gate(&self, step: &Step<8>) -> Option<f64> {
        let before = |y: &RayState| self.equation.before_gate(&self.in_world(y));
        let enters = before(step.start()) >= 0.0 && before(step.end()) < 0.0;
        if enters { step.event([0.0, 1.0], before) } else { None }
    }

    /// Steps of one length, each a straight line.
    fn fixed(
        &self,
        start: &RayState,
        ray: &Ray,
        steps: u32,
        chords: &mut impl Chords,
        step: impl Fn(&RayState, f64) -> RayState,
    ) -> Followed {
        let h = 1.0 / f64::from(steps.max(1));
        let mut y = self.in_units(start);
        // A body is crossed many times at most before light counts as lost.
        for _ in 0..steps.saturating_mul(64).max(MOST_STEPS) {
            let next = step(&y, h);
            if !next.iter().all(|v| v.is_finite()) {
                break;
            }
            let chord = self.chord(&y, &next);
            if let Some(t) = self.meeting(&chord, chords) {
                let t = f64::from(t.min(1.0));
                let met = std::array::from_fn(|i| y[i] + t * (next[i] - y[i]));
                return self.end(Outcome::Meets, start, &met, Ray { t_max: t as f32, ..chord }, None);
            }
            chords.passed(&Ray { t_max: 1.0, ..chord });
            if let Some(outcome) = self.outcome(&next) {
                return self.end(outcome, start, &next, chord, None);
            }
            y = next;
        }
        self.lost(ray)
    }

    /// Whether the way is over at a state, though nothing was met.
    fn outcome(&self, y: &RayState) -> Option<Outcome> {
        if self.equation.ends(&self.in_world(y)) {
            return Some(Outcome::Absorbed);
        }
        let half = 0.5 * self.region.bounds.extent().as_dvec3() / self.extent + DVec3::splat(BESIDE);
        let is_beside = position(y).abs().cmpgt(half).any();
        is_beside.then_some(Outcome::Leaves)
    }

    fn meeting(&self, chord: &Ray, chords: &mut impl Chords) -> Option<f32> {
        // A chord that rounding left nothing of has no direction.
        if chord.d.length_squared() == 0.0 { None } else { chords.hit(chord) }
    }

    /// Where the curve first meets something within a part of a step, and the chord that meets it there.
    ///
    /// Chords that meet something are halved until they are as near to the curve as single precision can tell. A half that
    /// meets nothing is passed, so a surface that only the chord came across is none.
    fn first_meeting(&self, step: &Step<8>, part: [f64; 2], chords: &mut impl Chords) -> Option<(f64, Ray)> {
        /// Below this part of a step there is nothing to be halved.
        const SHORTEST: f64 = 1.0 / (1u64 << 40) as f64;
        let size = self.region.bounds.min.abs().max(self.region.bounds.max.abs()).max_element();
        let finest = 0.25 * f64::from(f32::EPSILON) * (1.0 + f64::from(size) / self.extent);
        // The halves that are still to be looked at, the nearest last: one for each time of halving.
        let mut pending = [[0.0; 2]; 64];
        pending[0] = part;
        let mut len = 1;
        while len > 0 {
            len -= 1;
            let [a, b] = pending[len];
            let chord = self.chord(&step.at(a), &step.at(b));
            let Some(t) = self.meeting(&chord, chords) else { continue };
            if b - a <= SHORTEST || len + 2 > pending.len() || sag(step, a, b) <= finest {
                let theta = a + f64::from(t.min(1.0)) * (b - a);
                return Some((theta, Ray { t_max: t, ..chord }));
            }
            let m = 0.5 * (a + b);
            pending[len] = [m, b];
            pending[len + 1] = [a, m];
            len += 2;
        }
        None
    }

    fn end(
        &self,
        outcome: Outcome,
        start: &RayState,
        y: &RayState,
        chord: Ray,
        bundle: Option<RayBundle>,
    ) -> Followed {
        let end = |bundle: RayBundle| {
            bundle.end(self.equation, y, |y| self.slope(y), |y| self.in_world(y), self.extent)
        };
        let bundle = bundle.map(end);
        let y = self.in_world(y);
        let index = self.equation.index(&y);
        let ratio = self.equation.index(start) / index;
        Followed {
            outcome,
            chord,
            d: self.equation.direction(&y),
            length: y[6] - start[6],
            time: y[7] - start[7],
            index,
            eta_scale: ratio * ratio,
            g: self.equation.frequency_ratio(start, &y),
            normals: self.equation.normals(&y),
            ends: [*start, y],
            bundle,
        }
    }

    fn lost(&self, ray: &Ray) -> Followed {
        Followed {
            outcome: Outcome::Lost,
            chord: *ray,
            d: ray.d.as_dvec3(),
            length: 0.0,
            time: 0.0,
            index: 1.0,
            eta_scale: 1.0,
            g: 1.0,
            normals: None,
            ends: [[0.0; 8]; 2],
            bundle: None,
        }
    }
}

/// How far the middle of a part of a step is from the middle of its chord.
fn sag(step: &Step<8>, a: f64, b: f64) -> f64 {
    let [from, middle, to] = [a, 0.5 * (a + b), b].map(|theta| position(&step.at(theta)));
    middle.distance(0.5 * (from + to))
}
