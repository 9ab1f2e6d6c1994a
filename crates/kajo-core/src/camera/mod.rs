//! Cameras: from a position in the picture to a ray.
//!
//! A picture's own coordinates run from (-1, -1) at the lower left to (1, 1) at the upper right.
//!
//! Rays are worked out in double precision and then rounded, as the reference program of the classic scenes does: a ray decides by
//! its last bit which of two things a pixel at their edge shows.

mod aperture;
mod eyes;
mod fisheye;
pub mod fit;
mod frame;
mod importance;
mod lens;
mod model;
mod moving;
mod origins;
mod orthographic;
mod panorama;
mod perspective;
mod project;
mod raster;
mod stereo_cubemap;

pub use aperture::Aperture;
pub use eyes::EyePair;
pub use fisheye::{FisheyeCamera, FisheyeProjection};
pub use frame::CameraFrame;
pub use importance::{Connection, Importance};
pub use lens::ThinLens;
pub use moving::MovingCamera;
pub use orthographic::OrthographicCamera;
pub use panorama::PanoramaCamera;
pub use perspective::PerspectiveCamera;
pub use raster::Raster;
pub use stereo_cubemap::{Stereo, StereoCubemapCamera};

use kajo_math::{DVec3, Ray, Vec2, Vec3};

use self::model::CameraModel;

/// A camera of a scene, and the name that it is chosen by.
#[derive(Clone, Debug)]
pub struct NamedCamera {
    /// Its name, if it has one.
    pub name: Option<String>,
    /// Where it stands, and what it sees.
    pub camera: Camera,
}

/// Writes the enum of all cameras, and what has to be known of each by its type.
macro_rules! cameras {
    ($($(#[$doc:meta])* $Variant:ident($Model:ty),)+) => {
        /// Any camera.
        #[derive(Clone, Debug)]
        pub enum Camera {
            $($(#[$doc])* $Variant($Model),)+
            /// One of the others that moves while the shutter is open.
            Moving(Box<MovingCamera>),
        }

        $(
            impl From<$Model> for Camera {
                fn from(camera: $Model) -> Camera {
                    Camera::$Variant(camera)
                }
            }
        )+

        impl Camera {
            /// What this kind of camera can do; of one that moves, what it can at rest.
            fn model(&self) -> &dyn CameraModel {
                match self {
                    $(Camera::$Variant(camera) => camera,)+
                    Camera::Moving(moving) => moving.camera.model(),
                }
            }

            fn model_mut(&mut self) -> &mut dyn CameraModel {
                match self {
                    $(Camera::$Variant(camera) => camera,)+
                    Camera::Moving(moving) => moving.camera.model_mut(),
                }
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
                    $(Camera::$Variant(camera) => camera.ray(at, aspect, lens)?,)+
                    Camera::Moving(moving) => moving.ray(at, aspect, lens, time)?,
                };
                Some(Ray { time, ..ray })
            }
        }
    };
}

// A new camera is a file with a type that is a `CameraModel`, and a line here.
cameras! {
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
}

impl Camera {
    /// The word that makes this kind of camera in a scene.
    pub fn keyword(&self) -> &'static str {
        self.model().keyword()
    }

    /// Whether all its numbers are finite.
    pub fn is_finite(&self) -> bool {
        let model = self.model();
        model.is_finite() && model.frame().is_finite() && model.lens().is_none_or(ThinLens::is_finite)
    }

    /// Whether light can be connected with its picture: [`Camera::connect`] and [`Camera::importance`] have answers.
    pub fn is_connectable(&self) -> bool {
        self.model().is_connectable()
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

    /// The same camera with a lens in place of the pinhole; those that see all around have none, and one that moves keeps its own.
    #[must_use]
    pub fn with_lens(mut self, lens: Option<ThinLens>) -> Camera {
        if !matches!(self, Camera::Moving(_)) {
            self.model_mut().set_lens(lens);
        }
        self
    }

    /// The same camera with its lens, if it has one, focused on a world-space point; `None` where that is not before it.
    pub fn focused_on(self, p: DVec3) -> Option<Camera> {
        let CameraFrame { center, forward, .. } = *self.frame();
        let focus = (p - center).dot(forward);
        let lens = self.lens().cloned();
        (focus > 0.0).then(|| self.with_lens(lens.map(|lens| ThinLens { focus, ..lens })))
    }

    /// The lens, if there is one.
    pub fn lens(&self) -> Option<&ThinLens> {
        self.model().lens()
    }

    /// Whether the position on the lens matters, or there is a pinhole.
    pub fn has_lens(&self) -> bool {
        self.lens().is_some()
    }

    /// The world-space point where all rays start, if there is one.
    pub fn apex(&self) -> Option<Vec3> {
        match self {
            Camera::Moving(_) => None,
            still => still.model().apex(),
        }
    }

    /// Columns and rows of independent pictures that the whole picture consists of.
    ///
    /// Reconstruction filters do not reach across their borders.
    pub fn cells(&self) -> [u32; 2] {
        self.model().cells()
    }

    /// Whether the camera has an angle or a size that is that of the picture's height, or in one dialect its width.
    pub fn has_extent(&self) -> bool {
        self.model().has_extent()
    }

    /// Width over height that the picture should have, where the camera demands one.
    pub fn natural_aspect(&self) -> Option<f32> {
        self.model().natural_aspect()
    }
}

#[cfg(test)]
pub(crate) mod tests;
