//! The two eyes of stereo pictures.

use std::f64::consts::PI;

use kajo_math::{DVec3, fmath};

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
