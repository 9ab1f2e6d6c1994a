//! Fisheye pictures: half of all directions, or more, in a disk.
//!
//! A position at distance `r` from the middle of the picture, where 1 is the edge of the disk, sees at the
//! angle `theta` from forward. With `T` half the field of view
//!
//! ```text
//! equidistant      r = theta / T                      angles are lengths
//! equisolid        r = sin(theta/2) / sin(T/2)        solid angles are areas
//! stereographic    r = tan(theta/2) / tan(T/2)        small circles stay circles
//! orthographic     r = sin(theta) / sin(T)            areas are irradiances; T up to 90 degrees
//! ```
//!
//! [Kannala and Brandt 2006]. Outside of the disk the picture is black.
//!
//! Scene: `FisheyeCamera { center 0 1 0  direction 0 0 -1  up 0 1 0  angle 180  projection equisolid }`

use kajo_math::{DVec2, DVec3, Ray, Vec2, fmath};

use super::fit::{Fit, FitError, FitSpace, Freedom};
use super::model::CameraModel;
use super::{Camera, CameraFrame};

/// How angles become distances from the middle of the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FisheyeProjection {
    /// In proportion.
    Equidistant,
    /// Such that areas are solid angles.
    Equisolid,
    /// Such that small shapes keep their shape.
    Stereographic,
    /// As a hemisphere seen from far away.
    Orthographic,
}

impl FisheyeProjection {
    /// The largest field of view in radians. The stereographic projection of everything has no end; 350 degrees
    /// are most of it.
    pub fn widest_angle(self) -> f64 {
        use std::f64::consts::{PI, TAU};
        match self {
            FisheyeProjection::Orthographic => PI,
            FisheyeProjection::Stereographic => 350.0 / 180.0 * PI,
            FisheyeProjection::Equidistant | FisheyeProjection::Equisolid => TAU,
        }
    }

    /// The distance from the middle at which the angle `theta` from forward appears, for half a field of view `half`.
    fn radius(self, theta: f64, half: f64) -> f64 {
        match self {
            FisheyeProjection::Equidistant => theta / half,
            FisheyeProjection::Equisolid => fmath::sin64(0.5 * theta) / fmath::sin64(0.5 * half),
            FisheyeProjection::Stereographic => fmath::tan64(0.5 * theta) / fmath::tan64(0.5 * half),
            FisheyeProjection::Orthographic => fmath::sin64(theta) / fmath::sin64(half),
        }
    }

    /// The angle from forward at a distance `r` in [0, 1] from the middle, for half a field of view `half`.
    fn theta(self, r: f64, half: f64) -> f64 {
        match self {
            FisheyeProjection::Equidistant => r * half,
            FisheyeProjection::Equisolid => 2.0 * fmath::asin64(r * fmath::sin64(0.5 * half)),
            FisheyeProjection::Stereographic => 2.0 * fmath::atan64(r * fmath::tan64(0.5 * half)),
            FisheyeProjection::Orthographic => fmath::asin64((r * fmath::sin64(half)).min(1.0)),
        }
    }
}

/// A fisheye camera.
#[derive(Clone, Copy, Debug)]
pub struct FisheyeCamera {
    /// Position and axes.
    pub frame: CameraFrame,
    /// Field of view across the disk in radians, up to [`FisheyeProjection::widest_angle`].
    pub angle: f64,
    /// The projection.
    pub projection: FisheyeProjection,
    /// Whether the disk reaches the corners of the picture, and not only its upper and lower edge.
    pub to_corners: bool,
}

impl FisheyeCamera {
    /// The radius of the disk, where half the height of the picture is 1.
    fn radius(&self, aspect: f64) -> f64 {
        if self.to_corners { (aspect * aspect + 1.0).sqrt() } else { 1.0 }
    }
}

impl CameraModel for FisheyeCamera {
    fn keyword(&self) -> &'static str {
        "FisheyeCamera"
    }

    fn is_finite(&self) -> bool {
        self.angle.is_finite()
    }

    fn frame(&self) -> &CameraFrame {
        &self.frame
    }

    fn set_frame(&mut self, frame: CameraFrame) {
        self.frame = frame;
    }

    /// `None` outside of the disk.
    fn ray(&self, at: Vec2, aspect: f32, _lens: Vec2) -> Option<Ray> {
        let aspect = f64::from(aspect);
        let radius = self.radius(aspect);
        let (x, y) = (f64::from(at.x) * aspect / radius, f64::from(at.y) / radius);
        let r = (x * x + y * y).sqrt();
        if r > 1.0 {
            return None;
        }
        let CameraFrame { center, right, up, forward } = self.frame;
        let theta = self.projection.theta(r, 0.5 * self.angle);
        let outward = if r > 0.0 { (x * right + y * up) / r } else { right };
        let w = fmath::sin64(theta) * outward + fmath::cos64(theta) * forward;
        Some(Ray::new(center.as_vec3(), w.as_vec3()))
    }

    fn natural_aspect(&self) -> Option<f32> {
        (!self.to_corners).then_some(1.0)
    }

    fn project(&self, local: DVec3, aspect: f64) -> Option<DVec2> {
        let across = local.truncate();
        let outward = across.length();
        let theta = fmath::atan2_64(outward, local.z);
        let half = 0.5 * self.angle;
        if theta > half {
            return None;
        }
        let r = self.projection.radius(theta, half);
        let scale = self.radius(aspect);
        let direction = if outward > 0.0 { across / outward } else { DVec2::ZERO };
        Some(direction * r * scale / DVec2::new(aspect, 1.0))
    }

    fn fitted(&self, fit: &Fit, space: &FitSpace<'_>, inside: f64) -> Result<Camera, FitError> {
        let middle = space.middle();
        let half = 0.5 * self.angle;
        let edge = inside * fit.aspect.min(1.0) / self.radius(fit.aspect);
        let theta = self.projection.theta(edge.min(1.0), half);
        let CameraFrame { center, forward, .. } = self.frame;
        if fit.freedom == Freedom::Opening {
            return Err(FitError::NoAngle);
        }
        let sin = if theta < 0.5 * std::f64::consts::PI { fmath::sin64(theta) } else { 1.0 };
        let distance = space.radius() / sin.max(1e-6);
        let middle = match fit.freedom {
            Freedom::Distance => center + (middle - center).dot(forward) * forward,
            _ => middle,
        };
        let frame = CameraFrame { center: middle - distance * forward, ..self.frame };
        Ok(FisheyeCamera { frame, ..*self }.into())
    }
}
