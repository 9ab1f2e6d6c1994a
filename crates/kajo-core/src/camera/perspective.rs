//! Rays through a point: direction `x aspect right + y up + forward / tan(angle/2)`, normalised.
//!
//! Scene: `PerspectiveCamera { center 0 0 10  direction 0 0 -1  up 0 1 0  angle 30 }`

use kajo_math::{Ray, Vec2, fmath};

use super::Frame;

/// A pinhole camera.
#[derive(Clone, Copy, Debug)]
pub struct PerspectiveCamera {
    frame: Frame,
    /// Distance of the picture plane at which the picture is two units high.
    distance: f64,
}

impl PerspectiveCamera {
    /// A camera with the full vertical field of view `angle`, in radians.
    pub fn new(frame: Frame, angle: f64) -> PerspectiveCamera {
        PerspectiveCamera { frame, distance: 1.0 / fmath::tan64(0.5 * angle) }
    }

    /// Position and axes.
    pub fn frame(&self) -> &Frame {
        &self.frame
    }

    /// The ray through a place of the picture; see [`super::Camera::ray`].
    pub fn ray(&self, at: Vec2, aspect: f32) -> Ray {
        let Frame { center, right, up, forward } = self.frame;
        let (x, y) = (f64::from(at.x) * f64::from(aspect), f64::from(at.y));
        let d = x * right + y * up + self.distance * forward;
        Ray::new(center.as_vec3(), d.normalize_or_zero().as_vec3())
    }
}
