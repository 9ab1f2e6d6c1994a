//! A body of the curved space around a black hole.
//!
//! Inside of the body light follows the geodesics of a hole of mass `M` and spin `a` about an axis, in Kerr-Schild coordinates that
//! are those of the scene ([`kajo_math::gravity::Kerr`]). Outside it goes straight: the body ought to be a ball, and what its
//! surface cuts off is a deflection of the order of `M b / R²` for light of impact parameter `b`, `R` the radius of the ball.
//!
//! Everything in the body rests in the coordinates but for the gas of disks. Directions of light are those in the rest frame
//! ([`kajo_math::gravity::Observer`]), and so are frequencies; on the surface of the body frequencies are those far away.
//! Where nothing can rest, in the ergosphere, the frame is that of an observer who is dragged around.
//!
//! Light is followed backwards, from the eye. So it is sent into the future around the hole that spins the other way; see
//! [`Kerr`]. Only for an eye that falls in, which may be inside of the horizon, light is followed into its past: [`Sense::Past`].
//! Around a spinning hole things then stand in other coordinates, turned about the axis.
//!
//! Scene: `Media { BlackHole hole { mass 1  spin 0.9  axis 0 1 0 } }`

mod geodesics;
#[cfg(test)]
mod tests;

use kajo_math::gravity::{Kerr, Observer, seen_from_rest, thin_disk};
use kajo_math::{DMat3, DVec3, Ray, Vec3};

use super::bending::only_bends_light;
use super::{Coefficients, Medium};

pub use geodesics::Geodesics;

/// How light is followed from the eye.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Sense {
    /// Into the future, with everything that moves going backwards: for eyes outside of the horizon.
    #[default]
    Reversed,
    /// Into the past. Light that would have to come out of the horizon piles up there and is dark.
    Past,
}

/// How cameras move that are in the space around a black hole.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BlackHoleObserver {
    /// Not at all.
    #[default]
    Rests,
    /// Around the axis, with the angular velocity of circular orbits.
    Orbits {
        /// Whether in the right-handed sense.
        with_axis: bool,
    },
    /// Freely from rest far away, also through the horizon.
    Falls,
}

/// The space around a black hole.
#[derive(Clone, Debug)]
pub struct BlackHole {
    /// The hole as it is.
    hole: Kerr,
    /// The hole that light is followed around.
    chart: Kerr,
    center: DVec3,
    /// From the axes of the world to those of the hole, whose z axis it spins about.
    hole_from_world: DMat3,
    sense: Sense,
    observer: BlackHoleObserver,
    coefficients: Coefficients,
}

/// A mistake in a black hole.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BlackHoleError {
    /// The mass is not positive.
    Mass,
    /// The spin is not in [-1, 1].
    Spin,
    /// The axis has no direction.
    Axis,
}

impl std::fmt::Display for BlackHoleError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            BlackHoleError::Mass => "the mass of a black hole is more than 0",
            BlackHoleError::Spin => "the spin of a black hole is from -1 to 1",
            BlackHoleError::Axis => "the axis of a black hole is not zero",
        })
    }
}

impl std::error::Error for BlackHoleError {}

impl BlackHole {
    /// * `center`: world space
    /// * `mass`: a length, positive
    /// * `spin`: angular momentum over the square of the mass, in [-1, 1]
    /// * `axis`: what it spins about, in the right-handed sense; of any length but zero
    ///
    /// # Errors
    ///
    /// [`BlackHoleError`].
    pub fn new(center: Vec3, mass: f32, spin: f32, axis: Vec3) -> Result<BlackHole, BlackHoleError> {
        if !(mass > 0.0 && mass.is_finite()) {
            return Err(BlackHoleError::Mass);
        }
        if !(-1.0..=1.0).contains(&spin) {
            return Err(BlackHoleError::Spin);
        }
        let axis = axis.as_dvec3().try_normalize().ok_or(BlackHoleError::Axis)?;
        let (x, y) = axis.any_orthonormal_pair();
        let hole = Kerr::new(mass.into(), spin.into());
        Ok(BlackHole {
            hole,
            chart: Kerr::new(mass.into(), -f64::from(spin)),
            center: center.as_dvec3(),
            hole_from_world: DMat3::from_cols(x, y, axis).transpose(),
            sense: Sense::Reversed,
            observer: BlackHoleObserver::Rests,
            coefficients: Coefficients::clear(),
        })
    }

    /// The same for cameras that move in a way.
    pub fn observed_by(self, observer: BlackHoleObserver) -> BlackHole {
        let sense = if observer == BlackHoleObserver::Falls { Sense::Past } else { Sense::Reversed };
        let spin = self.hole.spin() / self.hole.mass();
        let chart = match sense {
            Sense::Reversed => Kerr::new(self.hole.mass(), -spin),
            Sense::Past => self.hole,
        };
        BlackHole { sense, chart, observer, ..self }
    }

    /// How cameras move that are in its space.
    pub fn observer(&self) -> BlackHoleObserver {
        self.observer
    }

    /// Whether a camera can be at a world-space point and move as is said.
    pub fn may_see_from(&self, p: Vec3) -> bool {
        let is_within = self.radius(p) <= self.hole.horizon();
        match self.observer {
            BlackHoleObserver::Rests => {
                !is_within && Observer::at_rest(&self.chart, self.point_in_hole(p.as_dvec3())).is_some()
            }
            BlackHoleObserver::Orbits { with_axis } => self.orbital_velocity(p, with_axis).is_some(),
            BlackHoleObserver::Falls => self.radius(p) > self.inner_end(),
        }
    }

    /// The radial coordinate at which light has ended that is followed.
    fn inner_end(&self) -> f64 {
        match self.sense {
            Sense::Reversed => self.chart.horizon(),
            // The inner horizon; without spin not quite the singularity.
            Sense::Past => (2.0 * self.hole.mass() - self.hole.horizon()).max(1e-3 * self.hole.mass()),
        }
    }

    /// The hole.
    pub fn hole(&self) -> &Kerr {
        &self.hole
    }

    /// A world-space point in the coordinates of the hole.
    #[inline]
    pub fn point_in_hole(&self, p: DVec3) -> DVec3 {
        self.hole_from_world * (p - self.center)
    }

    /// A world-space vector in the axes of the hole.
    #[inline]
    pub fn vector_in_hole(&self, v: DVec3) -> DVec3 {
        self.hole_from_world * v
    }

    /// A vector in the axes of the hole in world space.
    #[inline]
    pub fn vector_in_world(&self, v: DVec3) -> DVec3 {
        self.hole_from_world.transpose() * v
    }

    /// The radial coordinate of a world-space point, of Boyer and Lindquist.
    pub fn radius(&self, p: Vec3) -> f64 {
        self.hole.radius(self.point_in_hole(p.as_dvec3()))
    }

    /// The spin over the mass as seen by gas that goes around in the right-handed sense about the axis, or against it.
    pub fn spin_along(&self, with_axis: bool) -> f64 {
        let spin = self.hole.spin() / self.hole.mass();
        if with_axis { spin } else { -spin }
    }

    /// The radial coordinate of the innermost stable circular orbit.
    ///
    /// * `with_axis`: of gas that goes around in the right-handed sense about the axis, or against it
    pub fn innermost_orbit(&self, with_axis: bool) -> f64 {
        self.hole.mass() * thin_disk::innermost_orbit(self.spin_along(with_axis))
    }

    /// How the frequency of light from gas on a circular orbit is shifted: in the rest frame at the position over that of the gas,
    /// and far away over that in the rest frame. `None` where no gas can go around.
    ///
    /// * `p`: world space
    /// * `d`: unit direction in which the light goes, in the rest frame
    pub fn shift_of_orbit(&self, p: Vec3, d: Vec3, with_axis: bool) -> Option<(f64, f64)> {
        let x = self.point_in_hole(p.as_dvec3());
        let along = self.vector_in_hole(d.as_dvec3()).normalize();
        let rest = resting(&self.chart, x)?;
        let gas = Observer::rotating(&self.chart, x, self.angular_velocity(x, with_axis))?;
        // In time that is turned around light goes to the gas, from where it went.
        let (energy, momentum) = rest.emitted(match self.sense {
            Sense::Reversed => -along,
            Sense::Past => along,
        });
        Some((1.0 / gas.received(energy, momentum).0, energy))
    }

    /// The angular velocity of circular orbits, in the coordinates that light is followed in.
    fn angular_velocity(&self, x: DVec3, with_axis: bool) -> f64 {
        let omega = self.hole.angular_velocity(self.hole.radius(x), with_axis);
        match self.sense {
            Sense::Reversed => -omega,
            Sense::Past => omega,
        }
    }

    /// The velocity of what goes around at the angular velocity of circular orbits, in the rest frame at a world-space
    /// point; in world space and in units of the speed of light. `None` where nothing can rest, or nothing is as fast.
    pub fn orbital_velocity(&self, p: Vec3, with_axis: bool) -> Option<Vec3> {
        let x = self.point_in_hole(p.as_dvec3());
        self.measured(x, |chart| Observer::rotating(chart, x, self.angular_velocity(x, with_axis)))
    }

    /// The same for what has fallen freely from rest far away.
    pub fn falling_velocity(&self, p: Vec3) -> Option<Vec3> {
        let x = self.point_in_hole(p.as_dvec3());
        self.measured(x, |chart| match self.sense {
            Sense::Reversed => Observer::escaping(chart, x),
            Sense::Past => Observer::falling(chart, x),
        })
    }

    /// The velocity of an observer in the rest frame.
    fn measured(&self, x: DVec3, observer: impl Fn(&Kerr) -> Option<Observer>) -> Option<Vec3> {
        if self.hole.radius(x) <= self.hole.horizon() {
            return None;
        }
        let rest = Observer::at_rest(&self.chart, x)?;
        let velocity = rest.velocity_of(&observer(&self.chart)?);
        let velocity = if self.sense == Sense::Reversed { -velocity } else { velocity };
        Some(self.vector_in_world(velocity).as_vec3())
    }
}

/// An observer at rest; dragged around where nothing can rest; falling where nothing can stay.
fn resting(chart: &Kerr, x: DVec3) -> Option<Observer> {
    let outside = Observer::at_rest(chart, x).or_else(|| Observer::dragged(chart, x));
    outside.or_else(|| Observer::falling(chart, x))
}

impl Medium for BlackHole {
    fn is_finite(&self) -> bool {
        self.center.is_finite()
    }

    only_bends_light!(|medium, region, _wavelengths| Geodesics::new(medium, region));

    fn observed(&self, ray: &Ray) -> Option<(Vec3, f32)> {
        let velocity = match self.observer {
            BlackHoleObserver::Rests => None,
            BlackHoleObserver::Orbits { with_axis } => self.orbital_velocity(ray.o, with_axis),
            BlackHoleObserver::Falls => self.falling_velocity(ray.o),
        };
        let (d, ratio) = seen_from_rest(ray.d.as_dvec3().normalize(), velocity?.as_dvec3());
        Some((d.as_vec3(), ratio as f32))
    }
}
