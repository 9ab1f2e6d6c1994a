//! Parallel rays, or with a lens those of a telecentric camera.
//!
//! Origins cover `center + (size/2) (x aspect right + y up)`. Rays start infinitely far back:
//! what is behind the camera is seen too. With a lens each position of the picture has an opening of its own
//! around its origin, and rays start there.
//!
//! Scene: `OrthographicCamera { center 0 0 10  direction 0 0 -1  up 0 1 0  size 5 }`

use kajo_math::{DVec2, Ray, Vec2};

use super::{CameraFrame, ThinLens};

/// An orthographic camera.
#[derive(Clone, Debug)]
pub struct OrthographicCamera {
    /// Position and axes.
    pub frame: CameraFrame,
    /// Height of the picture in world units.
    pub size: f64,
    /// The lens, if there is one.
    pub lens: Option<ThinLens>,
}

impl OrthographicCamera {
    /// Half the picture's width and height in world units.
    pub(super) fn half_size(&self, aspect: f32) -> DVec2 {
        0.5 * self.size * DVec2::new(f64::from(aspect), 1.0)
    }

    /// The ray through a position of the picture; see [`super::Camera::ray`].
    pub fn ray(&self, at: Vec2, aspect: f32, lens: Vec2) -> Ray {
        let CameraFrame { center, right, up, forward } = self.frame;
        let (x, y) = (f64::from(at.x) * f64::from(aspect), f64::from(at.y));
        let o = center + 0.5 * self.size * (x * right + y * up);
        match &self.lens {
            None => Ray::new(o.as_vec3(), forward.as_vec3()).over(f32::NEG_INFINITY, f32::INFINITY),
            Some(thin) => {
                let (o, d) = thin.refract(&self.frame, o, thin.focus * forward, lens);
                Ray::new(o.as_vec3(), d.normalize_or_zero().as_vec3())
            }
        }
    }
}
