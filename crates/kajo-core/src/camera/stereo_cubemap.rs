//! Two cube maps in one row of twelve square faces, for headsets.
//!
//! Six faces for the left eye, then six for the right, each time in the order right, left, up, down, front,
//! back (+x, -x, +y, -y, +z, -z of a frame whose z looks forward). Faces show what a viewer
//! inside sees, unmirrored; the upper edge of `front` meets the lower edge of `up`, the lower edge of
//! `front` the upper edge of `down`.
//!
//! Twin cubes take both eyes where they are when the head looks forward. Omnidirectional
//! cubes turn the eyes with the direction of each ray; see [`super::PanoramaCamera`].
//!
//! Scene: `StereoCubemapCamera { center 0 1 0  direction 0 0 -1  up 0 1 0  eyeSeparation 0.065 }`

use kajo_math::{DVec3, Ray, Vec2};

use super::{CameraFrame, EyePair};

/// How the eyes stand while the gaze goes round.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stereo {
    /// Both eyes stay where they are.
    Twin,
    /// The eyes turn with the gaze.
    Omnidirectional,
}

/// A camera for a strip of twelve cube faces.
#[derive(Clone, Copy, Debug)]
pub struct StereoCubemapCamera {
    /// Position and axes.
    pub frame: CameraFrame,
    /// The two eyes.
    pub eyes: EyePair,
    /// How the eyes move.
    pub stereo: Stereo,
}

impl StereoCubemapCamera {
    /// The ray through a position of the whole strip; see [`super::Camera::ray`].
    pub fn ray(&self, at: Vec2) -> Ray {
        // Position in units of faces; a sample beyond the strip's ends continues its last face.
        let along = 6.0 * (f64::from(at.x) + 1.0);
        let face = along.floor().clamp(0.0, 11.0);
        let (x, y) = (2.0 * (along - face) - 1.0, f64::from(at.y));
        let w = self.direction(face as usize % 6, x, y);
        let side = if face < 6.0 { -1.0 } else { 1.0 };
        let o = match self.stereo {
            Stereo::Twin => self.eyes.ahead(&self.frame, side),
            Stereo::Omnidirectional => self.eyes.turned(&self.frame, w, side),
        };
        Ray::new(o.as_vec3(), w.as_vec3())
    }

    /// Unit direction through a position of one face, with x and y in [-1, 1].
    pub(super) fn direction(&self, face: usize, x: f64, y: f64) -> DVec3 {
        let CameraFrame { right, up, forward, .. } = self.frame;
        // Each face's own right, up and outward axes.
        let (r, u, out) = match face {
            0 => (-forward, up, right),
            1 => (forward, up, -right),
            2 => (right, -forward, up),
            3 => (right, forward, -up),
            4 => (right, up, forward),
            _ => (-right, up, -forward),
        };
        (out + x * r + y * u).normalize_or_zero()
    }
}
