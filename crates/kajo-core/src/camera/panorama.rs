//! All directions around a point, and for two eyes at once.
//!
//! The picture's x runs over the longitude from -180 to 180 degrees, its y over the latitude from
//! -90 to 90, the middle looking forward. For omnidirectional stereo every direction
//! gets the eyes that a head turned that way would have: rays are tangent to a circle
//! whose diameter is the distance of the eyes [Ishiguro et al. 1992], [Peleg et al. 2001].
//! The left eye's picture lies above the right eye's. Towards the poles, where a turned
//! head makes no sense, the eyes draw together: fully apart up to 60 degrees of latitude,
//! one from 75 on.
//!
//! Scene: `PanoramaCamera { center 0 1 0  direction 0 0 -1  up 0 1 0  stereo omnidirectional }`

use std::f64::consts::PI;

use kajo_math::{Aabb, DVec2, DVec3, Ray, Vec2, fmath};

use super::model::CameraModel;
use super::origins::around_eyes;
use super::project::longitude_latitude;
use super::{CameraFrame, EyePair};

/// An equirectangular camera for one eye or two.
#[derive(Clone, Copy, Debug)]
pub struct PanoramaCamera {
    /// Position and axes.
    pub frame: CameraFrame,
    /// The eyes of a stereo picture; `None` for a plain one.
    pub eyes: Option<EyePair>,
}

impl PanoramaCamera {
    /// Whether the picture holds two panoramas, one above the other.
    pub fn is_stereo(&self) -> bool {
        self.eyes.is_some()
    }
}

impl CameraModel for PanoramaCamera {
    fn keyword(&self) -> &'static str {
        "PanoramaCamera"
    }

    fn is_finite(&self) -> bool {
        self.eyes.is_none_or(|eyes| eyes.separation.is_finite())
    }

    fn frame(&self) -> &CameraFrame {
        &self.frame
    }

    fn set_frame(&mut self, frame: CameraFrame) {
        self.frame = frame;
    }

    fn ray(&self, at: Vec2, _aspect: f32, _lens: Vec2) -> Option<Ray> {
        let (x, mut y) = (f64::from(at.x), f64::from(at.y));
        let side = if y > 0.0 { -1.0 } else { 1.0 };
        if self.is_stereo() {
            y = 2.0 * y + side;
        }
        let (longitude, latitude) = (PI * x, 0.5 * PI * y);
        let CameraFrame { right, up, forward, .. } = self.frame;
        let level = fmath::sin64(longitude) * right + fmath::cos64(longitude) * forward;
        let w = fmath::cos64(latitude) * level + fmath::sin64(latitude) * up;
        let o = self.eyes.map_or(self.frame.center, |eyes| eyes.turned(&self.frame, w, side));
        Some(Ray::new(o.as_vec3(), w.as_vec3()))
    }

    fn cells(&self) -> [u32; 2] {
        if self.is_stereo() { [1, 2] } else { [1, 1] }
    }

    fn natural_aspect(&self) -> Option<f32> {
        Some(if self.is_stereo() { 1.0 } else { 2.0 })
    }

    fn origins(&self, _positions: [Vec2; 2], _aspect: f32) -> Option<Aabb> {
        Some(around_eyes(&self.frame, self.eyes))
    }

    fn project(&self, local: DVec3, _aspect: f64) -> Option<DVec2> {
        (!self.is_stereo()).then(|| longitude_latitude(local))
    }

    fn has_two_eyes(&self) -> bool {
        self.is_stereo()
    }

    fn project_eye(&self, p: DVec3, side: f64) -> Option<DVec2> {
        let w = self.eyes?.gaze(&self.frame, p, side)?;
        let at = longitude_latitude(self.frame.local(self.frame.center + w)?);
        Some(DVec2::new(at.x, 0.5 * (at.y - side)))
    }
}
