//! The thin lens: depth of field.
//!
//! An ideal lens makes all rays through one point of the plane of focus, at distance `s`, meet in one point of
//! the film. So the ray of a film point goes from a random point of the lens to where the ray through the middle
//! of the lens crosses the plane of focus [Potmesil and Chakravarty 1981], [Cook, Porter and Carpenter 1984]. With
//! the diameter `A` of the opening a point at distance `z` is spread over a circle of
//!
//! ```text
//! A |z - s| / s      measured at z           c = A f / (s - f) |z - s| / z      measured on the film
//! ```
//!
//! for a lens of focal length `f`, whose opening is `A = f / N` by its f-number `N`.
//!
//! Scene: `PerspectiveCamera { ..  aperture 0.2  focus 5 }`

use kajo_math::{DVec2, DVec3, Vec2};

use super::{Aperture, CameraFrame};

/// An ideal lens.
#[derive(Clone, Debug)]
pub struct ThinLens {
    /// Shape of the opening.
    pub aperture: Aperture,
    /// Radius of the circle around the opening, in world units, above 0.
    pub radius: f64,
    /// Distance of the plane of focus from the lens along the camera's direction, above 0.
    pub focus: f64,
}

impl ThinLens {
    /// Whether its radius and its focus are finite.
    pub fn is_finite(&self) -> bool {
        self.radius.is_finite() && self.focus.is_finite()
    }

    /// A point of the lens relative to its middle, right and up in world units.
    pub(super) fn sample(&self, u: Vec2) -> DVec2 {
        self.radius * self.aperture.sample(u)
    }

    /// The density of [`ThinLens::sample`], per area.
    pub(super) fn pdf(&self, l: DVec2) -> f64 {
        self.aperture.pdf(l / self.radius) / (self.radius * self.radius)
    }

    /// Origin and direction, not normalised, of the ray through a point of the lens.
    ///
    /// * `middle`: of the lens
    /// * `d`: from there to where the film point is in focus
    pub(super) fn refract(&self, frame: &CameraFrame, middle: DVec3, d: DVec3, u: Vec2) -> (DVec3, DVec3) {
        let l = self.sample(u);
        let offset = l.x * frame.right + l.y * frame.up;
        (middle + offset, d - offset)
    }
}
