//! Parallel rays.
//!
//! Origins cover `center + (size/2) (x aspect right + y up)`. Rays start infinitely far back:
//! what is behind the camera is seen too.
//!
//! Scene: `OrthographicCamera { center 0 0 10  direction 0 0 -1  up 0 1 0  size 5 }`

use kajo_math::{Ray, Vec2};

use super::Frame;

/// An orthographic camera.
#[derive(Clone, Copy, Debug)]
pub struct OrthographicCamera {
    /// Position and axes.
    pub frame: Frame,
    /// Height of the picture in world units.
    pub size: f64,
}

impl OrthographicCamera {
    /// The ray through a place of the picture; see [`super::Camera::ray`].
    pub fn ray(&self, at: Vec2, aspect: f32) -> Ray {
        let Frame { center, right, up, forward } = self.frame;
        let (x, y) = (f64::from(at.x) * f64::from(aspect), f64::from(at.y));
        let o = center + 0.5 * self.size * (x * right + y * up);
        Ray::new(o.as_vec3(), forward.as_vec3()).over(f32::NEG_INFINITY, f32::INFINITY)
    }
}
