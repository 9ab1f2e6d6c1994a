//! Light that does not go straight: what bends it, and how it is followed.
//!
//! Light bends inside of closed bodies only: the body's medium has a [`RayEquation`], and outside of it rays are straight. A ray
//! that is inside is followed by [`follow`], in double precision:
//!
//! ```text
//! dy/ds = slope(y),      y = (position, momentum, length, time)
//! ```
//!
//! by steps of Dormand and Prince's pair with error control ([`kajo_math::ode`]). Each step is cut into chords that keep within
//! [`SAG`] of the curve, and the caller tests these against the scene's trees, as rays that end ([`Chords`]). Where a chord meets
//! something the step is halved until chord and curve agree to single precision, so that the point that is met lies on the curve
//! and on the surface; the direction of arrival is the tangent there, never the chord. The surface of the body is met like any
//! other.
//!
//! Nothing else is needed for another kind of space: a medium whose [`RayEquation`] is that of geodesics bends light by gravity, its
//! frequency is shifted by [`RayEquation::frequency_ratio`], and what crosses a horizon has ended ([`RayEquation::ends`]).
//!
//! Where the footprint of a pixel is needed, two rays infinitely near go along ([`BundleEnd`]).

#[cfg(test)]
pub(crate) mod ball;
mod bundle;
mod follow;

use kajo_math::{Aabb, DMat3, DVec3, Ray};

pub use bundle::BundleEnd;
#[cfg(test)]
pub(crate) use follow::TOLERANCE;
pub use follow::follow;

/// Position (3), momentum (3), length of the way, and time that light takes (for an index of refraction the optical length).
///
/// All in world space and in the scene's unit of length.
pub type RayState = [f64; 8];

/// The largest distance of a chord from its curve, in parts of the extent of the body.
pub const SAG: f64 = 1e-5;

/// The position of a state.
#[inline]
pub fn position(y: &RayState) -> DVec3 {
    DVec3::new(y[0], y[1], y[2])
}

/// The momentum of a state.
#[inline]
pub fn momentum(y: &RayState) -> DVec3 {
    DVec3::new(y[3], y[4], y[5])
}

/// The law that light follows inside of a body, at one wavelength.
///
/// Rays are followed from the point that sees to what it sees, or from a light on: the law has to be the same both ways.
pub trait RayEquation {
    /// The state of a ray at a point; `None` where no light can be.
    ///
    /// * `p`: world space
    /// * `d`: unit direction in which it is followed
    fn start(&self, p: DVec3, d: DVec3) -> Option<RayState>;

    /// The derivative of the state by the parameter of the curve; not a number where no light can be.
    ///
    /// The parameter has the dimension of a length, and the derivative of the position is about as long as 1.
    fn slope(&self, y: &RayState) -> RayState;

    /// The state brought back to what is conserved, after a step.
    fn corrected(&self, y: &RayState) -> RayState {
        *y
    }

    /// Unit direction of the curve in world space.
    fn direction(&self, y: &RayState) -> DVec3 {
        momentum(y).normalize_or_zero()
    }

    /// Whether nothing of the light gets any further, as behind a horizon.
    fn ends(&self, _y: &RayState) -> bool {
        false
    }

    /// Index of refraction at a state, as surfaces there have to know it.
    fn index(&self, _y: &RayState) -> f64 {
        1.0
    }

    /// Frequency of light where the curve begins over that where it ends, both in the rest frames at its ends.
    ///
    /// Radiance over the third power of the frequency is what stays the same.
    fn frequency_ratio(&self, _from: &RayState, _to: &RayState) -> f64 {
        1.0
    }

    /// What takes unit normals of surfaces at a state to those in the frame in which directions are measured there; `None` where nothing
    /// differs.
    fn normals(&self, _y: &RayState) -> Option<DMat3> {
        None
    }

    /// The largest distance of a chord from its curve near a state, where that is to be smaller than [`SAG`] of the body.
    fn largest_sag(&self, _y: &RayState) -> f64 {
        f64::INFINITY
    }

    /// The longest that a step may be from a state, where that is to be shorter than a part of the body: no step is to go over what light
    /// ends in.
    fn longest_step(&self, _y: &RayState) -> f64 {
        f64::INFINITY
    }

    /// Whether there is a gate: a surface at which light leaves one place of the body and goes on from another.
    fn has_gate(&self) -> bool {
        false
    }

    /// Positive before the gate, negative behind it.
    fn before_gate(&self, _y: &RayState) -> f64 {
        1.0
    }

    /// Light that has come to the gate, where it goes on; `None` where it does not.
    fn through_gate(&self, _y: &RayState) -> Option<RayState> {
        None
    }

    /// What of a state stays the same along a curve, by name; nothing where no such quantity is known.
    fn conserved(&self, _y: &RayState) -> [Option<(&'static str, f64)>; 3] {
        [None; 3]
    }

    /// How steps are taken.
    fn stepping(&self) -> Stepping {
        Stepping::default()
    }
}

/// A quantity that stays the same along a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConservedQuantity {
    /// What it is.
    pub name: &'static str,
    /// Where the way begins.
    pub start: f64,
    /// Where it ends: the same but for the errors of all steps.
    pub end: f64,
}

impl ConservedQuantity {
    /// Those of an equation at both ends of a way.
    pub fn of(equation: &impl RayEquation, [start, end]: &[RayState; 2]) -> [Option<ConservedQuantity>; 3] {
        let [before, after] = [start, end].map(|y| equation.conserved(y));
        std::array::from_fn(|i| {
            let ((name, start), (_, end)) = (before[i]?, after[i]?);
            Some(ConservedQuantity { name, start, end })
        })
    }
}

/// How steps along a curve are taken.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Stepping {
    /// As long as their errors allow.
    #[default]
    Adaptive,
    /// Euler's method, of first order, by this many steps for the extent of the body: the plain formula that is found first, to
    /// see how wrong it is.
    Euler(u32),
    /// The classic method of Runge and Kutta, of fourth order, by this many steps for the extent of the body.
    RungeKutta(u32),
}

/// The body that light is inside of.
#[derive(Clone, Copy, Debug)]
pub struct Region {
    /// World-space box around it.
    pub bounds: Aabb,
}

impl Region {
    fn center(&self) -> DVec3 {
        self.bounds.center().as_dvec3()
    }

    /// The length that errors are measured by, its diagonal.
    fn extent(&self) -> f64 {
        f64::from(self.bounds.extent().length())
    }
}

/// What stands in the way of chords.
pub trait Chords {
    /// Where a chord meets the nearest surface, as the ray's parameter; what it is has to be kept until the next question.
    fn hit(&mut self, chord: &Ray) -> Option<f32>;

    /// Light has gone along this whole chord.
    fn passed(&mut self, _chord: &Ray) {}
}

/// What became of light that was followed through a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// It hits the surface that [`Chords::hit`] was asked for last.
    Meets,
    /// It is outside of the body without having met its surface, by rounding at an edge or since the body is not closed.
    Leaves,
    /// [`RayEquation::ends`].
    Absorbed,
    /// It took more steps than there are, or there is no light where it came to.
    Lost,
}

/// A way through a body.
#[derive(Clone, Copy, Debug)]
pub struct Followed {
    /// What became of the light.
    pub outcome: Outcome,
    /// The last chord, which ends at its `t_max`.
    pub chord: Ray,
    /// Unit direction of light where it arrives: the tangent of the curve.
    pub d: DVec3,
    /// Length of the way.
    pub length: f64,
    /// Time that light takes for it; for an index of refraction the optical length.
    pub time: f64,
    /// Index of refraction at the end.
    pub index: f64,
    /// Radiance where the way begins over that where it ends, but for the shift of frequency: `(n / n')^2`.
    pub eta_scale: f64,
    /// Frequency where the way begins over that where it ends.
    pub g: f64,
    /// [`RayEquation::normals`] at the end.
    pub normals: Option<DMat3>,
    /// The states at both ends; nothing where light was lost.
    pub ends: [RayState; 2],
    /// What has become of the rays beside it; `None` unless that was asked for, and where it is not known.
    pub bundle: Option<BundleEnd>,
}
