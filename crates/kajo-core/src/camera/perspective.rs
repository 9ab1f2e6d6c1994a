//! Rays through a point, or through a lens: direction `x aspect right + y up + forward / tan(angle/2)`, normalised.
//!
//! Scene: `PerspectiveCamera { center 0 0 10  direction 0 0 -1  up 0 1 0  angle 30 }`

use kajo_math::{DVec2, Ray, Vec2, fmath};

use super::{CameraFrame, ThinLens};

/// A pinhole camera, or one with a lens.
#[derive(Clone, Debug)]
pub struct PerspectiveCamera {
    frame: CameraFrame,
    /// Distance of the picture plane at which the picture is two units high.
    distance: f64,
    lens: Option<ThinLens>,
}

impl PerspectiveCamera {
    pub(super) fn is_finite(&self) -> bool {
        self.distance.is_finite()
    }

    /// A pinhole camera with the full vertical field of view `angle`, in radians.
    pub fn new(frame: CameraFrame, angle: f64) -> PerspectiveCamera {
        PerspectiveCamera { frame, distance: 1.0 / fmath::tan64(0.5 * angle), lens: None }
    }

    /// The same camera with a lens in place of the pinhole.
    pub fn with_lens(self, lens: Option<ThinLens>) -> PerspectiveCamera {
        PerspectiveCamera { lens, ..self }
    }

    /// Position and axes.
    pub fn frame(&self) -> &CameraFrame {
        &self.frame
    }

    /// The same camera with another position and other axes.
    pub fn with_frame(self, frame: CameraFrame) -> PerspectiveCamera {
        PerspectiveCamera { frame, ..self }
    }

    /// Distance of the picture plane at which the picture is two units high: `1 / tan(angle / 2)`.
    pub fn distance(&self) -> f64 {
        self.distance
    }

    /// The lens, if there is one.
    pub fn lens(&self) -> Option<&ThinLens> {
        self.lens.as_ref()
    }

    /// Half the picture's width and height at unit distance.
    pub(super) fn half_size(&self, aspect: f32) -> DVec2 {
        DVec2::new(f64::from(aspect), 1.0) / self.distance
    }

    /// The ray through a position of the picture; see [`super::Camera::ray`].
    pub fn ray(&self, at: Vec2, aspect: f32, lens: Vec2) -> Ray {
        let CameraFrame { center, right, up, forward } = self.frame;
        let (x, y) = (f64::from(at.x) * f64::from(aspect), f64::from(at.y));
        let d = x * right + y * up + self.distance * forward;
        let (o, d) = match &self.lens {
            None => (center, d),
            Some(thin) => thin.refract(&self.frame, center, d * (thin.focus / self.distance), lens),
        };
        Ray::new(o.as_vec3(), d.normalize_or_zero().as_vec3())
    }
}
