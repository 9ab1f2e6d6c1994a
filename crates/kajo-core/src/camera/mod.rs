//! Cameras: from a place in the picture to a ray.
//!
//! A picture's own coordinates run from (-1, -1) at the lower left to (1, 1) at the upper right.

mod frame;
mod orthographic;
mod panorama;
mod perspective;
mod stereo_cubemap;

pub use frame::Frame;
pub use orthographic::OrthographicCamera;
pub use panorama::{EyePair, PanoramaCamera};
pub use perspective::PerspectiveCamera;
pub use stereo_cubemap::{Stereo, StereoCubemapCamera};

use kajo_math::{Ray, Vec2};

/// Any camera.
#[derive(Clone, Copy, Debug)]
pub enum Camera {
    /// Parallel rays.
    Orthographic(OrthographicCamera),
    /// Rays through a point.
    Perspective(PerspectiveCamera),
    /// All directions, as a rectangle of longitude and latitude.
    Panorama(PanoramaCamera),
    /// Twelve faces of two cubes in a row.
    StereoCubemap(StereoCubemapCamera),
}

impl Camera {
    /// The ray through a place of the picture.
    ///
    /// * `at`: picture coordinates; samples may lie somewhat outside [-1, 1]
    /// * `aspect`: width of the picture over its height
    #[inline]
    pub fn ray(&self, at: Vec2, aspect: f32) -> Ray {
        match self {
            Camera::Orthographic(camera) => camera.ray(at, aspect),
            Camera::Perspective(camera) => camera.ray(at, aspect),
            Camera::Panorama(camera) => camera.ray(at),
            Camera::StereoCubemap(camera) => camera.ray(at),
        }
    }

    /// Columns and rows of independent pictures that the whole picture consists of.
    ///
    /// Reconstruction filters do not reach across their borders.
    pub fn cells(&self) -> [u32; 2] {
        match self {
            Camera::StereoCubemap(_) => [12, 1],
            Camera::Panorama(camera) if camera.is_stereo() => [1, 2],
            _ => [1, 1],
        }
    }

    /// Width over height that the picture should have, where the camera demands one.
    pub fn natural_aspect(&self) -> Option<f32> {
        match self {
            Camera::StereoCubemap(_) => Some(12.0),
            Camera::Panorama(camera) => Some(if camera.is_stereo() { 1.0 } else { 2.0 }),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests;
