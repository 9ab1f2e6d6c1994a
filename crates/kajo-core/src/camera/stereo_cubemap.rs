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

use kajo_math::{Aabb, DVec2, DVec3, Ray, Vec2};

use super::model::CameraModel;
use super::origins::around_eyes;
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

impl CameraModel for StereoCubemapCamera {
    fn keyword(&self) -> &'static str {
        "StereoCubemapCamera"
    }

    fn is_finite(&self) -> bool {
        self.eyes.separation.is_finite()
    }

    fn frame(&self) -> &CameraFrame {
        &self.frame
    }

    fn set_frame(&mut self, frame: CameraFrame) {
        self.frame = frame;
    }

    fn ray(&self, at: Vec2, _aspect: f32, _lens: Vec2) -> Option<Ray> {
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
        Some(Ray::new(o.as_vec3(), w.as_vec3()))
    }

    fn cells(&self) -> [u32; 2] {
        [12, 1]
    }

    fn natural_aspect(&self) -> Option<f32> {
        Some(12.0)
    }

    fn origins(&self, _positions: [Vec2; 2], _aspect: f32) -> Option<Aabb> {
        Some(around_eyes(&self.frame, Some(self.eyes)))
    }

    fn has_two_eyes(&self) -> bool {
        true
    }

    fn project_eye(&self, p: DVec3, side: f64) -> Option<DVec2> {
        let w = match self.stereo {
            Stereo::Twin => p - self.eyes.ahead(&self.frame, side),
            Stereo::Omnidirectional => self.eyes.gaze(&self.frame, p, side)?,
        };
        let DVec3 { x: a, y: b, z: s } = self.frame.local(self.frame.center + w)?;
        let size = DVec3::new(a, b, s).abs();
        // The faces as in `StereoCubemapCamera::direction`: which one, and right and up on it.
        let (face, out, x, y) = if size.x >= size.y && size.x >= size.z {
            (f64::from(a < 0.0), size.x, if a < 0.0 { s } else { -s }, b)
        } else if size.y >= size.z {
            (if b < 0.0 { 3.0 } else { 2.0 }, size.y, a, if b < 0.0 { s } else { -s })
        } else {
            (if s < 0.0 { 5.0 } else { 4.0 }, size.z, if s < 0.0 { -a } else { a }, b)
        };
        let of_eye = if side < 0.0 { 0.0 } else { 6.0 };
        let at = DVec2::new((of_eye + face + 0.5 * (x / out + 1.0)) / 6.0 - 1.0, y / out);
        at.is_finite().then_some(at)
    }
}
