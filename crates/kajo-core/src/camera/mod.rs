//! Cameras: from a position in the picture to a ray.
//!
//! A picture's own coordinates run from (-1, -1) at the lower left to (1, 1) at the upper right.
//!
//! Rays are worked out in double precision and then rounded, as the reference program of the classic scenes does: a ray decides by
//! its last bit which of two things a pixel at their edge shows.

mod aperture;
mod fisheye;
pub mod fit;
mod frame;
mod importance;
mod lens;
mod moving;
mod origins;
mod orthographic;
mod panorama;
mod perspective;
mod project;
mod raster;
mod stereo_cubemap;

pub use aperture::Aperture;
pub use fisheye::{FisheyeCamera, FisheyeProjection};
pub use frame::CameraFrame;
pub use importance::{Connection, Importance};
pub use lens::ThinLens;
pub use moving::MovingCamera;
pub use orthographic::OrthographicCamera;
pub use panorama::{EyePair, PanoramaCamera};
pub use perspective::PerspectiveCamera;
pub use raster::Raster;
pub use stereo_cubemap::{Stereo, StereoCubemapCamera};

use kajo_math::{DVec3, Ray, Vec2, Vec3};

/// A camera of a scene, and the name that it is chosen by.
#[derive(Clone, Debug)]
pub struct NamedCamera {
    /// Its name, if it has one.
    pub name: Option<String>,
    /// Where it stands, and what it sees.
    pub camera: Camera,
}

/// Any camera.
#[derive(Clone, Debug)]
pub enum Camera {
    /// Parallel rays.
    Orthographic(OrthographicCamera),
    /// Rays through a point or a lens.
    Perspective(PerspectiveCamera),
    /// All directions, as a rectangle of longitude and latitude.
    Panorama(PanoramaCamera),
    /// Half of all directions or more, in a disk.
    Fisheye(FisheyeCamera),
    /// Twelve faces of two cubes in a row.
    StereoCubemap(StereoCubemapCamera),
    /// One of the others that moves while the shutter is open.
    Moving(Box<MovingCamera>),
}

/// Makes any camera of one.
macro_rules! into_camera {
    ($($Variant:ident($Own:ty)),+) => {
        $(
            impl From<$Own> for Camera {
                fn from(camera: $Own) -> Camera {
                    Camera::$Variant(camera)
                }
            }
        )+
    };
}

into_camera! {
    Orthographic(OrthographicCamera),
    Perspective(PerspectiveCamera),
    Panorama(PanoramaCamera),
    Fisheye(FisheyeCamera),
    StereoCubemap(StereoCubemapCamera)
}

impl Camera {
    /// Whether all its numbers are finite.
    pub fn is_finite(&self) -> bool {
        let own = match self {
            Camera::Orthographic(camera) => camera.size.is_finite(),
            Camera::Perspective(camera) => camera.is_finite(),
            Camera::Panorama(camera) => camera.eyes.is_none_or(|eyes| eyes.separation.is_finite()),
            Camera::Fisheye(camera) => camera.angle.is_finite(),
            Camera::StereoCubemap(camera) => camera.eyes.separation.is_finite(),
            Camera::Moving(moving) => return moving.camera.is_finite(),
        };
        let lens = match self {
            Camera::Orthographic(camera) => camera.lens.as_ref(),
            Camera::Perspective(camera) => camera.lens(),
            _ => None,
        };
        own && self.frame().is_finite() && lens.is_none_or(ThinLens::is_finite)
    }

    /// The ray through a position of the picture, with a unit direction; `None` where no light gets.
    ///
    /// * `at`: picture coordinates; samples may lie somewhat outside [-1, 1]
    /// * `aspect`: width of the picture over its height
    /// * `lens`: uniform in [0, 1)²; of no effect unless [`Camera::has_lens`]
    /// * `time`: moment within the shutter interval, which becomes that of the ray
    #[inline]
    pub fn ray(&self, at: Vec2, aspect: f32, lens: Vec2, time: f32) -> Option<Ray> {
        let ray = match self {
            Camera::Orthographic(camera) => camera.ray(at, aspect, lens),
            Camera::Perspective(camera) => camera.ray(at, aspect, lens),
            Camera::Panorama(camera) => camera.ray(at),
            Camera::Fisheye(camera) => camera.ray(at, aspect)?,
            Camera::StereoCubemap(camera) => camera.ray(at),
            Camera::Moving(moving) => moving.ray(at, aspect, lens, time)?,
        };
        Some(Ray { time, ..ray })
    }

    /// Whether rays depend on the time.
    pub fn moves(&self) -> bool {
        matches!(self, Camera::Moving(moving) if moving.map.moves())
    }

    /// The camera without its motion.
    pub fn at_rest(&self) -> &Camera {
        match self {
            Camera::Moving(moving) => &moving.camera,
            other => other,
        }
    }

    /// The same camera with a lens in place of the pinhole; those that see all around have none.
    pub fn with_lens(self, lens: Option<ThinLens>) -> Camera {
        match self {
            Camera::Orthographic(camera) => Camera::Orthographic(OrthographicCamera { lens, ..camera }),
            Camera::Perspective(camera) => Camera::Perspective(camera.with_lens(lens)),
            other => other,
        }
    }

    /// The same camera with its lens, if it has one, focused on a world-space point; `None` where that is not before it.
    pub fn focused_on(self, p: DVec3) -> Option<Camera> {
        let CameraFrame { center, forward, .. } = *self.frame();
        let focus = (p - center).dot(forward);
        let lens = match &self {
            Camera::Perspective(camera) => camera.lens().cloned(),
            Camera::Orthographic(camera) => camera.lens.clone(),
            _ => None,
        };
        (focus > 0.0).then(|| self.with_lens(lens.map(|lens| ThinLens { focus, ..lens })))
    }

    /// Whether the position on the lens matters, or there is a pinhole.
    pub fn has_lens(&self) -> bool {
        match self.at_rest() {
            Camera::Orthographic(camera) => camera.lens.is_some(),
            Camera::Perspective(camera) => camera.lens().is_some(),
            _ => false,
        }
    }

    /// The world-space point where all rays start, if there is one.
    pub fn apex(&self) -> Option<Vec3> {
        match self {
            Camera::Perspective(camera) if camera.lens().is_none() => Some(camera.frame().center.as_vec3()),
            _ => None,
        }
    }

    /// Columns and rows of independent pictures that the whole picture consists of.
    ///
    /// Reconstruction filters do not reach across their borders.
    pub fn cells(&self) -> [u32; 2] {
        match self.at_rest() {
            Camera::StereoCubemap(_) => [12, 1],
            Camera::Panorama(camera) if camera.is_stereo() => [1, 2],
            _ => [1, 1],
        }
    }

    /// Whether the camera has an angle or a size that is that of the picture's height, or in one dialect its width.
    pub fn has_extent(&self) -> bool {
        matches!(self.at_rest(), Camera::Orthographic(_) | Camera::Perspective(_))
    }

    /// Width over height that the picture should have, where the camera demands one.
    pub fn natural_aspect(&self) -> Option<f32> {
        match self.at_rest() {
            Camera::StereoCubemap(_) => Some(12.0),
            Camera::Panorama(camera) => Some(if camera.is_stereo() { 1.0 } else { 2.0 }),
            Camera::Fisheye(camera) if !camera.to_corners => Some(1.0),
            _ => None,
        }
    }
}

#[cfg(test)]
pub(crate) mod tests;
