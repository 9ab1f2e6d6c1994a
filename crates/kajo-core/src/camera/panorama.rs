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

use kajo_math::{DVec3, Ray, Vec2, fmath};

use super::CameraFrame;

/// Two eyes around a centre.
#[derive(Clone, Copy, Debug)]
pub struct EyePair {
    /// Distance between the eyes in world units.
    pub separation: f64,
}

impl EyePair {
    /// Where an eye is when the head turns to look along the unit vector `w`.
    ///
    /// * `side`: -1 for the left eye, 1 for the right
    pub fn turned(&self, frame: &CameraFrame, w: DVec3, side: f64) -> DVec3 {
        let level = w - w.dot(frame.up) * frame.up;
        let right = level.cross(frame.up).normalize_or_zero();
        frame.center + 0.5 * self.separation * side * pole_fade(w.dot(frame.up)) * right
    }

    /// Where an eye is when the head looks forward.
    pub fn ahead(&self, frame: &CameraFrame, side: f64) -> DVec3 {
        frame.center + 0.5 * self.separation * side * frame.right
    }
}

/// 1 up to 60 degrees of latitude, 0 from 75 degrees, a cosine between.
fn pole_fade(sin_latitude: f64) -> f64 {
    let latitude = fmath::asin64(sin_latitude.abs().min(1.0)).to_degrees();
    let x = ((latitude - 60.0) / 15.0).clamp(0.0, 1.0);
    fmath::cos64(0.5 * PI * x)
}

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

    /// The ray through a position of the picture; see [`super::Camera::ray`].
    pub fn ray(&self, at: Vec2) -> Ray {
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
        Ray::new(o.as_vec3(), w.as_vec3())
    }
}
