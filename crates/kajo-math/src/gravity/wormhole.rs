//! Wormholes: a throat that joins two places, each around a mouth.
//!
//! The spacetime is still and its clocks agree everywhere [Morris and Thorne 1988], [James et al. 2015b, eq. 1]:
//!
//! ```text
//! ds² = -dt² + dl² + r(l)² (dθ² + sin² θ dφ²)
//! r² = ρ² + l²                                                                 [Ellis 1973]
//! r = ρ + w (x atan x - ln(1 + x²)/2),   x = 2 l/(π w)                         [James et al. 2015b, eq. 5]
//! ```
//!
//! `l` is the distance from the throat, of radius `ρ`; between the two halves there may be a piece of cylinder. Each half is drawn as
//! a shell around its mouth, by isotropic coordinates: a radius `s` with `d ln s = dl/r`, scaled so that `s = r` at the edge, where it
//! meets flat space. Then
//!
//! ```text
//! ds² = -dt² + n² (dx² + dy² + dz²),    n = r/s
//! ```
//!
//! and light goes as in glass of index `n`: `dx/dλ = p`, `dp/dλ = ∇n²/2`, `|p| = n`. Angles in the coordinates are angles.
//! Where the index of a half is wanted beyond the throat, which steps of a solver may do, it is that of the other half.

use crate::fmath::{atan64, ln64};
use crate::ode::{Solver, Tolerance};
use crate::{DQuat, DVec3};

/// How the radius grows with the distance from the throat.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Profile {
    /// `r² = ρ² + l²`.
    Ellis,
    /// That of the film Interstellar, with the parameter `w`: the larger, the wider the region in which light is bent much.
    Gradual(f64),
}

/// One mouth of a wormhole, around the origin.
#[derive(Clone, Debug)]
pub struct Wormhole {
    throat: f64,
    length: f64,
    profile: Profile,
    edge: f64,
    /// Logarithm of the isotropic radius of the throat, and the distance of knots in it.
    start: f64,
    spacing: f64,
    /// The distance `l` at each knot.
    distances: Vec<f64>,
}

/// Light that leaves the throat on the other side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThroatPassage {
    /// Place on the throat of the other mouth, as if it stood where this one stands.
    pub x: DVec3,
    /// Momentum there, outwards.
    pub p: DVec3,
    /// The length of the way along the cylinder.
    pub length: f64,
}

/// Pieces that the logarithm of the radius is cut into.
const PIECES: usize = 256;

/// Light that goes along the throat by less than this, of 1, does not get through: it winds around forever.
const LEAST_PROGRESS: f64 = 1e-7;

impl Wormhole {
    /// * `throat`: radius of the throat, positive
    /// * `length`: of the cylinder between the halves, not negative
    /// * `edge`: radius of the sphere beyond which space is flat, more than that of the throat
    pub fn new(throat: f64, length: f64, profile: Profile, edge: f64) -> Wormhole {
        debug_assert!(throat > 0.0 && length >= 0.0 && edge > throat);
        let mut wormhole =
            Wormhole { throat, length, profile, edge, start: 0.0, spacing: 0.0, distances: Vec::new() };
        let far = wormhole.distance_of(edge);
        let fine = Tolerance { absolute: 1e-13 * throat, relative: 1e-13 };
        // From the edge to the throat, ln s as a function of l; then l as one of ln s.
        let mut inwards = |l: f64, _: &[f64; 1]| [1.0 / wormhole.radius_at(l).0];
        let span = solved(&mut inwards, 0.0, far, 0.0, Tolerance { absolute: 1e-13, relative: 1e-13 });
        wormhole.start = ln64(edge) - span;
        wormhole.spacing = span / PIECES as f64;
        let mut outwards = |_: f64, l: &[f64; 1]| [wormhole.radius_at(l[0]).0];
        let mut distances = vec![0.0];
        for i in 0..PIECES {
            let [from, to] = [i, i + 1].map(|i| i as f64 * wormhole.spacing);
            distances.push(solved(&mut outwards, from, to, distances[i], fine));
        }
        wormhole.distances = distances;
        wormhole
    }

    /// Radius of the throat in the coordinates of a mouth, somewhat smaller than its own.
    pub fn throat_in_chart(&self) -> f64 {
        crate::fmath::exp64(self.start)
    }

    /// Radius of the sphere that the mouth fills.
    pub fn edge(&self) -> f64 {
        self.edge
    }

    /// `r` and `dr/dl` at a distance from the throat.
    #[inline]
    fn radius_at(&self, l: f64) -> (f64, f64) {
        use std::f64::consts::{FRAC_2_PI, FRAC_PI_2};
        match self.profile {
            Profile::Ellis => {
                let r = (self.throat * self.throat + l * l).sqrt();
                (r, l / r)
            }
            Profile::Gradual(width) => {
                let x = l / (FRAC_PI_2 * width);
                let angle = atan64(x);
                (self.throat + width * (x * angle - 0.5 * ln64(1.0 + x * x)), FRAC_2_PI * angle)
            }
        }
    }

    /// The distance at which the radius is `r`, by bisection.
    fn distance_of(&self, r: f64) -> f64 {
        let (mut lo, mut hi) = (0.0, r);
        while self.radius_at(hi).0 < r {
            hi *= 2.0;
        }
        for _ in 0..200 {
            let middle = 0.5 * (lo + hi);
            if self.radius_at(middle).0 < r { lo = middle } else { hi = middle }
        }
        0.5 * (lo + hi)
    }

    /// The distance `l` at a logarithm of the isotropic radius, from the table by Hermite's interpolation of fifth degree: its derivatives
    /// `dl/dq = r` and `r r'` are known at the knots.
    fn distance(&self, q: f64) -> f64 {
        let place = ((q - self.start) / self.spacing).clamp(0.0, PIECES as f64);
        let piece = (place as usize).min(PIECES - 1);
        let (t, h) = (place - piece as f64, self.spacing);
        let [a, b] = [piece, piece + 1].map(|i| {
            let l = self.distances[i];
            let (r, slope) = self.radius_at(l);
            [l, h * r, h * h * r * slope]
        });
        let (t2, u) = (t * t, 1.0 - t);
        let (t3, u3) = (t2 * t, u * u * u);
        u3 * (1.0 + 3.0 * t + 6.0 * t2) * a[0]
            + u3 * t * (1.0 + 3.0 * t) * a[1]
            + 0.5 * u3 * t2 * a[2]
            + t3 * (1.0 + 3.0 * u + 6.0 * u * u) * b[0]
            - t3 * u * (1.0 + 3.0 * u) * b[1]
            + 0.5 * t3 * u * u * b[2]
    }

    /// The square of the index, and half of its gradient over the place: `∇n²/2 = gradient x`.
    ///
    /// * `s2`: square of the distance from the centre of the mouth, positive
    pub fn index_squared(&self, s2: f64) -> (f64, f64) {
        let q = 0.5 * ln64(s2.max(f64::MIN_POSITIVE));
        let (beyond, q) = if q < self.start { (-1.0, 2.0 * self.start - q) } else { (1.0, q) };
        let (r, slope) = self.radius_at(self.distance(q));
        let n2 = r * r / s2;
        (n2, n2 * (beyond * slope - 1.0) / s2)
    }

    /// How place and momentum of light change; see the module.
    pub fn flow(&self, x: DVec3, p: DVec3) -> (DVec3, DVec3) {
        let (_, gradient) = self.index_squared(x.length_squared());
        (p, gradient * x)
    }

    /// Light that has come to the throat, on the other side; `None` where it never gets there.
    ///
    /// In a throat of radius `ρ` and length `ℓ` it winds by the angle `ℓ b / (ρ sqrt(ρ² - b²))`, `b` its impact parameter.
    ///
    /// * `x`, `p`: on the throat of this mouth, inwards
    /// * `forwards`: the unit vector along which light goes on as it came
    /// * `turn`: what turns the world of this mouth to that of the other
    pub fn passed(&self, x: DVec3, p: DVec3, forwards: DVec3, turn: DQuat) -> Option<ThroatPassage> {
        let s = x.length();
        let (n, outward) = (p.length(), x / s);
        let radial = outward.dot(p) / n;
        let across = p / n - radial * outward;
        let sine = across.length();
        let progress = (1.0 - sine * sine).max(0.0).sqrt();
        if progress.is_nan() || progress < LEAST_PROGRESS {
            return None;
        }
        let tangent = if sine > 0.0 { across / sine } else { DVec3::ZERO };
        let angle = self.length * sine / (self.throat * progress);
        let (sin, cos) = crate::fmath::sincos64(angle);
        let [place, along] = [cos * outward + sin * tangent, cos * tangent - sin * outward];
        // Inwards becomes outwards. Were it not for the reflection, the other side would be seen in a mirror.
        let there = |v: DVec3| turn * (v - 2.0 * v.dot(forwards) * forwards);
        let [place, along] = [place, along].map(there);
        Some(ThroatPassage {
            x: s * place,
            p: n * (progress * place + sine * along),
            length: self.length / progress,
        })
    }
}

/// `y(to)` for `y' = f(t, y)`, `y(from)` given.
fn solved(
    f: &mut impl FnMut(f64, &[f64; 1]) -> [f64; 1],
    from: f64,
    to: f64,
    y: f64,
    tolerance: Tolerance,
) -> f64 {
    let mut solver = Solver::new(f, from, [y], tolerance);
    while solver.t() < to && solver.step(f, to).is_ok() {}
    solver.y()[0]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gravity::schwarzschild::elliptic_rf;
    use std::f64::consts::PI;

    fn check(found: f64, expected: f64, tolerance: f64) {
        assert!((found - expected).abs() < tolerance, "{found} instead of {expected}");
    }

    /// Light from the edge with an impact parameter: whether it has got through, and the angle between the ways in and out.
    fn deflection(wormhole: &Wormhole, b: f64) -> (bool, f64) {
        let edge = wormhole.edge();
        let x = DVec3::new(-(edge * edge - b * b).sqrt(), b, 0.0);
        let fine = Tolerance { absolute: 1e-12, relative: 1e-12 };
        let mut f = |_: f64, y: &[f64; 6]| {
            let (x, p) = wormhole.flow(DVec3::new(y[0], y[1], y[2]), DVec3::new(y[3], y[4], y[5]));
            [x.x, x.y, x.z, p.x, p.y, p.z]
        };
        let mut solver = Solver::new(&mut f, 0.0, [x.x, x.y, x.z, 1.0, 0.0, 0.0], fine);
        let mut through = false;
        loop {
            let step = solver.step(&mut f, f64::INFINITY).unwrap();
            let s2 = |y: &[f64; 6]| y[0] * y[0] + y[1] * y[1] + y[2] * y[2];
            if let Some(theta) = step.event([0.0, 1.0], |y| edge * edge - s2(y))
                && s2(step.start()) < edge * edge * (1.0 - 1e-9)
            {
                let y = step.at(theta);
                return (through, y[4].atan2(y[3]).rem_euclid(2.0 * PI));
            }
            let throat = wormhole.throat_in_chart();
            if let Some(theta) = step.event([0.0, 1.0], |y| s2(y) - throat * throat)
                && !through
            {
                let y = step.at(theta);
                let (x, p) = (DVec3::new(y[0], y[1], y[2]), DVec3::new(y[3], y[4], y[5]));
                let passage = wormhole.passed(x, p, DVec3::X, DQuat::IDENTITY).unwrap();
                let (x, p) = (passage.x * (1.0 + 1e-14), passage.p);
                solver = Solver::new(&mut f, 0.0, [x.x, x.y, x.z, p.x, p.y, p.z], fine);
                through = true;
            }
        }
    }

    fn complete(m: f64) -> f64 {
        elliptic_rf(0.0, 1.0 - m, 1.0)
    }

    #[test]
    fn the_index_of_ellis_is_a_closed_form() {
        // s = (l + r)/2 up to a factor, so n = c (1 + (s₀/s)²).
        let (throat, edge) = (1.0, 5.0);
        let wormhole = Wormhole::new(throat, 0.0, Profile::Ellis, edge);
        let l = (edge * edge - throat * throat).sqrt();
        let scale = 2.0 * edge / (l + edge);
        let s0 = 0.5 * throat * scale;
        check(wormhole.throat_in_chart(), s0, 1e-12);
        for i in 1..200 {
            let s = s0 * (0.5 + 0.02 * f64::from(i));
            let n = (1.0 + (s0 / s) * (s0 / s)) / scale;
            let (n2, gradient) = wormhole.index_squared(s * s);
            check(n2, n * n, 1e-10);
            check(gradient * s, -2.0 * n * s0 * s0 / (s * s * s) / scale, 1e-9);
        }
    }

    #[test]
    fn ellis_deflects_as_elliptic_integrals() {
        let wormhole = Wormhole::new(1.0, 0.0, Profile::Ellis, 3000.0);
        for b in [1.1, 1.5, 2.0, 5.0] {
            // Past it: 2 K(1/b) - π [Chetouani and Clément 1984].
            let (through, angle) = deflection(&wormhole, b);
            assert!(!through);
            check((2.0 * PI - angle) % (2.0 * PI), 2.0 * complete(1.0 / (b * b)) - PI, 1e-6);
        }
        for b in [0.0, 0.3, 0.7, 0.95] {
            // Through it the place turns by 2 b K(b); the way out is mirrored, and outwards.
            let (through, angle) = deflection(&wormhole, b);
            assert!(through);
            let turned = 2.0 * b * complete(b * b);
            check(angle.sin(), turned.sin(), 1e-6);
            check(angle.cos(), turned.cos(), 1e-6);
        }
    }

    #[test]
    fn a_long_throat_winds_light_around() {
        let [short, long] = [0.0, 2.0].map(|length| Wormhole::new(1.0, length, Profile::Gradual(0.3), 500.0));
        let b = 0.6;
        let [short, long] = [short, long].map(|wormhole| deflection(&wormhole, b).1);
        check(
            (long - short).rem_euclid(2.0 * PI),
            (2.0 * b / (1.0 - b * b).sqrt()).rem_euclid(2.0 * PI),
            1e-8,
        );
    }

    #[test]
    fn what_winds_around_forever_is_lost() {
        let wormhole = Wormhole::new(1.0, 1.0, Profile::Ellis, 4.0);
        let s = wormhole.throat_in_chart();
        let n = wormhole.index_squared(s * s).0.sqrt();
        assert!(wormhole.passed(s * DVec3::X, n * DVec3::Y, DVec3::X, DQuat::IDENTITY).is_none());
        let head_on = wormhole.passed(s * DVec3::X, -n * DVec3::X, DVec3::X, DQuat::IDENTITY).unwrap();
        check(head_on.x.distance(-s * DVec3::X), 0.0, 1e-12);
        check(head_on.p.distance(-n * DVec3::X), 0.0, 1e-12);
        check(head_on.length, 1.0, 1e-12);
    }

    #[test]
    fn the_far_side_is_no_mirror_image() {
        // Up stays up, and left stays left, for whoever looks along `forwards`.
        let wormhole = Wormhole::new(1.0, 0.0, Profile::Ellis, 4.0);
        let s = wormhole.throat_in_chart();
        for side in [DVec3::Y, DVec3::Z] {
            let passage = wormhole.passed(
                s * (DVec3::X + 0.1 * side).normalize(),
                -DVec3::X,
                DVec3::X,
                DQuat::IDENTITY,
            );
            assert!(passage.unwrap().p.dot(side) > 0.0);
        }
    }
}
