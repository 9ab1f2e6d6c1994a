//! Integrators: from a camera ray to the light that arrives along it.

pub mod ambient_occlusion;
pub mod bidir;
mod camera_view;
pub mod classic;
pub mod path;
mod shadow;
mod transport;

pub use ambient_occlusion::{AmbientOcclusion, AmbientOcclusionSettings};
pub use bidir::{Bidirectional, BidirectionalSettings};
pub use classic::{Classic, ClassicSettings};
pub use path::{Path, PathSettings};

use kajo_core::camera::Camera;
use kajo_core::scene::Scene;
use kajo_math::Vec2;

use crate::trail::{Counting, PathObserver};
use crate::{LayerSet, PixelIntegrator, PixelSample, SampleContext, Trail};

/// All integrators, each with its settings: the one list of them.
#[derive(Clone, Copy, Debug)]
pub enum IntegratorSettings {
    /// How open the surroundings of a surface are.
    AmbientOcclusion(AmbientOcclusionSettings),
    /// Light from both ends, or from lights alone.
    Bidirectional(BidirectionalSettings),
    /// Recursive ray tracing as in the course.
    Classic(ClassicSettings),
    /// Path tracing, distribution ray tracing and direct light.
    Path(PathSettings),
}

impl IntegratorSettings {
    /// The integrator, ready to take samples of a picture of `size` pixels with these `layers`.
    pub fn prepare<'a>(
        self,
        scene: &'a Scene,
        camera: &'a Camera,
        size: [u32; 2],
        layers: LayerSet,
    ) -> Box<dyn PixelIntegrator + 'a> {
        match self {
            IntegratorSettings::AmbientOcclusion(settings) => {
                Box::new(AmbientOcclusion::through(camera, scene, settings, size, layers))
            }
            IntegratorSettings::Bidirectional(settings) => {
                Box::new(Bidirectional::through(camera, scene, settings, size, layers))
            }
            IntegratorSettings::Classic(settings) => {
                Box::new(Classic::through(camera, scene, settings, size, layers))
            }
            IntegratorSettings::Path(settings) => {
                Box::new(Path::through(camera, scene, settings, size, layers))
            }
        }
    }
}

/// What all integrators of this family do: take a sample and tell of it. A member is a file with a type that does this.
pub(crate) trait Integrator: Sync {
    /// Casts one camera ray, and tells `observer` of every ray and all light that follows from it.
    ///
    /// * the rest: as for [`PixelIntegrator::sample`]
    fn observe<O: PathObserver>(
        &self,
        ctx: &mut SampleContext<'_>,
        pixel: [u32; 2],
        raster: Vec2,
        observer: &mut O,
    ) -> PixelSample;
}

/// One code for renders, where rays are counted, and for debug rays, where all is kept.
impl<I: Integrator> PixelIntegrator for I {
    fn sample(&self, ctx: &mut SampleContext<'_>, pixel: [u32; 2], raster: Vec2) -> PixelSample {
        let mut counting = Counting::new(ctx);
        let sample = self.observe(ctx, pixel, raster, &mut counting);
        ctx.rays = counting.rays;
        sample
    }

    fn trail(&self, ctx: &mut SampleContext<'_>, pixel: [u32; 2], raster: Vec2) -> (PixelSample, Trail) {
        let mut trail = Trail::default();
        (self.observe(ctx, pixel, raster, &mut trail), trail)
    }
}

#[cfg(test)]
mod flat_tests;
#[cfg(test)]
mod immersion_tests;
#[cfg(test)]
mod limit_tests;
#[cfg(test)]
mod motion_tests;
#[cfg(test)]
mod relief_tests;
#[cfg(test)]
mod tests;
