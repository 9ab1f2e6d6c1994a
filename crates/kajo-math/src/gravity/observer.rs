//! Frames of observers: who sees light from which direction and of which frequency.
//!
//! The vector normal to the slices of constant time of the Kerr-Schild coordinates is a 4-velocity everywhere, inside of the horizon too:
//!
//! ```text
//! n^m = (1, -f k/(1 + f)) / α,    α = 1/sqrt(1 + f)
//! ```
//!
//! With the symmetric root of the metric of the slice, `e_i = δ_i + (1/sqrt(1 + f) - 1) k_i k`, it is an orthonormal frame whose
//! axes are those of the coordinates, as nearly as may be. Everybody else moves in it with a velocity, and has the axes that a Lorentz
//! boost without rotation makes of them. Who rests in the coordinates moves outwards along `k` with velocity `f`, so that no observer
//! rests where `f >= 1`.

use crate::DVec3;
use crate::gravity::{Kerr, KerrMetric};

/// An orthonormal frame at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observer {
    metric: KerrMetric,
    /// Velocity in the frame normal to the slice, shorter than 1.
    velocity: DVec3,
    gamma: f64,
}

/// `v` with its part along the unit vector `k` multiplied by `factor`.
#[inline]
fn stretched(v: DVec3, k: DVec3, factor: f64) -> DVec3 {
    v + (factor - 1.0) * k.dot(v) * k
}

/// A photon of frequency and momentum in one frame, as one sees it in which that frame moves with a velocity.
#[inline]
fn boosted((frequency, momentum): (f64, DVec3), velocity: DVec3, gamma: f64) -> (f64, DVec3) {
    let along = velocity.dot(momentum);
    let pushed = gamma * frequency + gamma * gamma / (gamma + 1.0) * along;
    (gamma * (frequency + along), momentum + pushed * velocity)
}

/// Light that a moving camera looks along, as an observer at rest beside it sees it: the unit direction to look along there, and the frequency
/// that the camera sees over that which an observer at rest does.
///
/// * `direction`: unit vector that the camera looks along, in its own frame
/// * `velocity`: of the camera in the frame of the observer at rest, shorter than 1
pub fn seen_from_rest(direction: DVec3, velocity: DVec3) -> (DVec3, f64) {
    let gamma = 1.0 / (1.0 - velocity.length_squared()).sqrt();
    // Light arrives against the direction that is looked along.
    let (frequency, momentum) = boosted((1.0, -direction), velocity, gamma);
    (-momentum / frequency, 1.0 / frequency)
}

impl Observer {
    /// An observer who moves with a velocity in the frame normal to the slice of constant time.
    ///
    /// `None` unless the velocity is shorter than 1.
    pub fn moving(kerr: &Kerr, x: DVec3, velocity: DVec3) -> Option<Observer> {
        let v2 = velocity.length_squared();
        (v2 < 1.0).then(|| Observer { metric: kerr.metric(x), velocity, gamma: 1.0 / (1.0 - v2).sqrt() })
    }

    /// An observer with this 4-velocity, but for its length; `None` where that is not towards the future and slower than light.
    ///
    /// * `u`: its part in time and those in space
    pub fn of_velocity(kerr: &Kerr, x: DVec3, (time, space): (f64, DVec3)) -> Option<Observer> {
        let metric = kerr.metric(x);
        let KerrMetric { f, k, .. } = metric;
        let shift = f / (1.0 + f) * k;
        let lapse = 1.0 / (1.0 + f).sqrt();
        let along = stretched(space + time * shift, k, (1.0 + f).sqrt());
        let velocity = along / (lapse * time);
        let v2 = velocity.length_squared();
        (time > 0.0 && v2 < 1.0).then(|| Observer { metric, velocity, gamma: 1.0 / (1.0 - v2).sqrt() })
    }

    /// An observer at rest in the coordinates; `None` inside of the ergosphere, where none can be.
    pub fn at_rest(kerr: &Kerr, x: DVec3) -> Option<Observer> {
        Observer::rotating(kerr, x, 0.0)
    }

    /// An observer who goes around the axis on a circle.
    ///
    /// * `omega`: angular velocity as seen from far away, right-handed about z
    ///
    /// `None` where that would be faster than light.
    pub fn rotating(kerr: &Kerr, x: DVec3, omega: f64) -> Option<Observer> {
        let space = omega * DVec3::new(-x.y, x.x, 0.0);
        Observer::of_velocity(kerr, x, (1.0, space))
    }

    /// An observer without angular momentum who stays at a radius, and is dragged around the axis [Bardeen et al. 1972, eq. 2.5]; `None`
    /// inside of the horizon.
    pub fn dragged(kerr: &Kerr, x: DVec3) -> Option<Observer> {
        let (r, a, m) = (kerr.radius(x), kerr.spin(), kerr.mass());
        if r <= kerr.horizon() {
            return None;
        }
        let q = r * r + a * a;
        let sin2 = (x.x * x.x + x.y * x.y) / q;
        let delta = q - 2.0 * m * r;
        Observer::rotating(kerr, x, 2.0 * m * a * r / (q * q - a * a * delta * sin2))
    }

    /// An observer who has fallen freely from rest at infinity, without angular momentum; at home inside of the horizon too.
    ///
    /// The covector of the velocity is `-dt + u_r dr` with `u_r = -sqrt(2 M r) / (sqrt(r² + a²) + sqrt(2 M r))`
    /// [Doran 2000, in these coordinates].
    pub fn falling(kerr: &Kerr, x: DVec3) -> Option<Observer> {
        Observer::radial(kerr, x, |fall, space| -fall / (space + fall))
    }

    /// The same run backwards in time: an observer who leaves the hole and comes to rest at infinity. `None` inside of the horizon.
    pub fn escaping(kerr: &Kerr, x: DVec3) -> Option<Observer> {
        let outside = kerr.radius(x) > kerr.horizon();
        outside.then(|| Observer::radial(kerr, x, |fall, space| fall / (space - fall)))?
    }

    /// An observer with the covector `-dt + u_r dr`.
    fn radial(kerr: &Kerr, x: DVec3, u_r: impl Fn(f64, f64) -> f64) -> Option<Observer> {
        let metric = kerr.metric(x);
        let (r, a) = (metric.r, kerr.spin());
        let u_r = u_r((2.0 * kerr.mass() * r).sqrt(), (r * r + a * a).sqrt());
        let q = r * r + a * a;
        let d = r.powi(4) + a * a * x.z * x.z;
        let dr = DVec3::new(x.x * r * r, x.y * r * r, x.z * q) * (r / d);
        Observer::of_velocity(kerr, x, metric.raised((-1.0, u_r * dr)))
    }

    /// The 4-velocity, its part in time and those in space.
    pub fn velocity(&self) -> (f64, DVec3) {
        let KerrMetric { f, k, .. } = self.metric;
        let time = self.gamma * (1.0 + f).sqrt();
        let along = stretched(self.gamma * self.velocity, k, 1.0 / (1.0 + f).sqrt());
        (time, along - time * f / (1.0 + f) * k)
    }

    /// The velocity of another observer at this place, in this frame.
    pub fn velocity_of(&self, other: &Observer) -> DVec3 {
        // Something that rests with the other, as a vector of energy and momentum that is not light but is boosted alike.
        let (energy, momentum) = (other.gamma, other.gamma * other.velocity);
        let (energy, momentum) = boosted((energy, momentum), -self.velocity, self.gamma);
        momentum / energy
    }

    /// Light of frequency 1 in this frame that travels along a unit vector: its energy at infinity and the covector of its momentum.
    #[inline]
    pub fn emitted(&self, direction: DVec3) -> (f64, DVec3) {
        let KerrMetric { f, k, .. } = self.metric;
        let (frequency, momentum) = boosted((1.0, direction), self.velocity, self.gamma);
        let p = stretched(momentum, k, (1.0 + f).sqrt());
        let lapse = 1.0 / (1.0 + f).sqrt();
        (lapse * frequency - f / (1.0 + f) * k.dot(p), p)
    }

    /// The frequency of light in this frame and the unit vector that it travels along.
    ///
    /// * `energy`: `-p_t`
    /// * `p`: the covector of its momentum
    #[inline]
    pub fn received(&self, energy: f64, p: DVec3) -> (f64, DVec3) {
        let KerrMetric { f, k, .. } = self.metric;
        let root = (1.0 + f).sqrt();
        let frequency = root * (energy + f / (1.0 + f) * k.dot(p));
        let momentum = stretched(p, k, 1.0 / root);
        let (frequency, momentum) = boosted((frequency, momentum), -self.velocity, self.gamma);
        (frequency, momentum / frequency.abs())
    }

    /// A covector of space in this frame, such as the normal of a surface at rest, of which the components in the coordinates are these.
    ///
    /// For an observer at rest in the coordinates; the metric of space there is `δ + f/(1 - f) k k`.
    pub fn covector(&self, n: DVec3) -> DVec3 {
        let KerrMetric { f, k, .. } = self.metric;
        stretched(n, k, (1.0 - f).max(0.0).sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Stream;

    fn check(found: f64, expected: f64, tolerance: f64) {
        assert!((found - expected).abs() < tolerance, "{found} instead of {expected}");
    }

    /// Unit vectors and places outside of the ergosphere, drawn from a seed.
    fn draws(count: u32) -> impl Iterator<Item = (DVec3, DVec3)> {
        (0..count).map(|i| {
            let stream = Stream::new(7, [i, 0], 0);
            let number = |k| 2.0 * f64::from(stream.uniform(k)) - 1.0;
            let vector = |k| DVec3::new(number(k), number(k + 1), number(k + 2));
            (6.0 * vector(0).normalize() * (1.0 + number(6).abs()), vector(3).normalize())
        })
    }

    #[test]
    fn frames_are_orthonormal_and_invert() {
        let kerr = Kerr::new(1.0, 0.9);
        for (x, direction) in draws(100) {
            let observers = [
                Observer::at_rest(&kerr, x),
                Observer::falling(&kerr, x),
                Observer::escaping(&kerr, x),
                Observer::rotating(&kerr, x, 0.05),
            ];
            for observer in observers.into_iter().flatten() {
                let u = observer.velocity();
                check(kerr.metric(x).product(u, u), -1.0, 1e-12);
                let (energy, p) = observer.emitted(direction);
                check(kerr.norm(x, p, energy), 0.0, 1e-12);
                // The frequency is -p·u, by definition.
                check(energy * u.0 - p.dot(u.1), 1.0, 1e-12);
                let (frequency, back) = observer.received(energy, p);
                check(frequency, 1.0, 1e-12);
                check(back.distance(direction), 0.0, 1e-12);
                // Two directions of light make the angle that their momenta say: 1 - cos = -p·q.
                let (energy2, p2) = observer.emitted(DVec3::X);
                let metric = kerr.metric(x);
                let product = metric.product(metric.raised((-energy, p)), metric.raised((-energy2, p2)));
                check(-product, 1.0 - direction.x, 1e-12);
            }
        }
    }

    #[test]
    fn frequencies_without_spin() {
        let kerr = Kerr::new(1.0, 0.0);
        for (x, direction) in draws(20) {
            let r = x.length();
            let rest = Observer::at_rest(&kerr, x).unwrap();
            check(rest.emitted(direction).0, (1.0 - 2.0 / r).sqrt(), 1e-12);
            // The direction to the centre stays what it is, and the speed of the fall is sqrt(2/r).
            let fall = Observer::falling(&kerr, x).unwrap();
            let inwards = -x / r;
            let (frequency, seen) = fall.received(1.0, rest.emitted(inwards).1 / rest.emitted(inwards).0);
            check(seen.distance(inwards), 0.0, 1e-12);
            check(rest.velocity_of(&fall).distance(inwards * (2.0 / r).sqrt()), 0.0, 1e-12);
            // Light from behind is shifted by the energy that was gained in the fall and the speed: 1/(1 + sqrt(2/r)).
            check(frequency, 1.0 / (1.0 + (2.0 / r).sqrt()), 1e-12);
        }
    }

    #[test]
    fn cameras_that_move_look_ahead() {
        // Aberration: cos = (cos' - v)/(1 - v cos') looked along, and light from ahead is shifted to higher frequencies.
        let v = 0.5;
        let (ahead, ratio) = seen_from_rest(DVec3::X, v * DVec3::X);
        check(ahead.distance(DVec3::X), 0.0, 1e-15);
        check(ratio, 3f64.sqrt(), 1e-12);
        let (side, ratio) = seen_from_rest(DVec3::Y, v * DVec3::X);
        check(side.x, -v, 1e-12);
        check(ratio, (1.0 - v * v).sqrt().recip() * (1.0 + v * side.x), 1e-12);
    }

    #[test]
    fn space_is_dragged_along() {
        let kerr = Kerr::new(1.0, 0.9);
        for (x, _) in draws(20) {
            let x = 0.3 * x;
            let Some(observer) = Observer::dragged(&kerr, x) else { continue };
            let (t, v) = kerr.metric(x).lowered(observer.velocity());
            check(x.x * v.y - x.y * v.x, 0.0, 1e-9 * t.abs());
        }
        assert!(Observer::dragged(&kerr, DVec3::new(1.8, 0.0, 0.0)).is_some(), "in the ergosphere");
        assert!(Observer::dragged(&kerr, DVec3::new(1.5, 0.0, 0.0)).is_none(), "inside of the horizon");
    }

    #[test]
    fn nobody_rests_in_the_ergosphere_or_outruns_light() {
        let kerr = Kerr::new(1.0, 0.9);
        assert!(Observer::at_rest(&kerr, DVec3::new(1.9, 0.0, 0.0)).is_none());
        assert!(Observer::at_rest(&kerr, DVec3::new(0.0, 0.0, 1.9)).is_some());
        assert!(Observer::rotating(&kerr, DVec3::new(10.0, 0.0, 0.0), 0.11).is_none());
        assert!(Observer::moving(&kerr, DVec3::X * 5.0, DVec3::Z).is_none());
        assert!(Observer::falling(&kerr, DVec3::new(0.9, 0.3, 0.2)).is_some(), "inside of the horizon");
        assert!(Observer::escaping(&kerr, DVec3::new(0.9, 0.3, 0.2)).is_none());
    }

    #[test]
    fn normals_stand_on_their_surfaces() {
        // Light that grazes a surface in the coordinates grazes it in the frame at rest.
        let kerr = Kerr::new(1.0, 0.7);
        for (x, n) in draws(50) {
            let rest = Observer::at_rest(&kerr, x).unwrap();
            let (energy, p) = rest.emitted(rest.covector(n).normalize().any_orthonormal_vector());
            let (velocity, _) = kerr.flow(x, p, energy);
            check(velocity.normalize().dot(n), 0.0, 1e-12);
        }
    }
}
