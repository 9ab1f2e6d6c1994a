//! Integrators: from a camera ray to the light that arrives along it.
//!
//! One is a file with a type that takes samples, its settings, and an [`IntegratorSpec`] for each name by which the language
//! knows it. Two lines here, one for the settings and one for the name, make it known to scenes, the command line, the
//! studio and the manual.

pub mod ambient_occlusion;
pub mod bidir;
mod camera_view;
mod choice;
pub mod classic;
mod hidden_light;
pub mod irradiance;
pub mod metropolis;
pub mod path;
pub mod photon;
mod photon_map;
mod scatterings;
mod shadow;
mod small_picture;
mod spec;
mod transport;
pub mod vcm;

pub use ambient_occlusion::{AmbientOcclusion, AmbientOcclusionSettings};
pub use bidir::{Bidirectional, BidirectionalSettings};
pub use choice::{AUTO, CHOICES, Choice, choose};
pub use classic::{Classic, ClassicSettings};
pub use irradiance::{IrradianceCaching, IrradianceSettings};
pub(crate) use transport::PathState;

pub use metropolis::{Metropolis, MetropolisSettings, MutatedSamples};
pub use path::{Path, PathSettings};
pub use photon::{PhotonMapping, PhotonSettings};
pub(crate) use scatterings::cut_off;
pub use spec::{Defaults, IntegratorSpec, Prepare, Quantity, SettingsContext};
pub(crate) use spec::{bounces_from_both_ends, bounces_of_paths, without_curves, without_media};
pub use vcm::{VertexMerging, VertexMergingSettings};

use kajo_core::camera::Camera;
use kajo_core::scene::Scene;
use kajo_core::settings::Settings;
use kajo_math::Vec2;

use crate::trail::{Counting, PathObserver};
use crate::{KeptState, LayerSet, PixelIntegrator, PixelSample, SampleContext, SamplesPerState};
use crate::{Setup, SetupError, Trail, WithState};

/// Writes the enum of all settings, with a `match` for each method of [`Prepare`].
macro_rules! settings {
    ($($(#[$doc:meta])* $Variant:ident($Settings:ty),)+) => {
        /// The settings of an integrator: those that take samples, each with its own fields.
        #[derive(Clone, Copy, Debug)]
        pub enum IntegratorSettings {
            $($(#[$doc])* $Variant($Settings),)+
        }

        impl Prepare for IntegratorSettings {
            fn prepare<'a>(
                self,
                scene: &'a Scene,
                camera: &'a Camera,
                size: [u32; 2],
                layers: LayerSet,
            ) -> Box<dyn PixelIntegrator + 'a> {
                match self {
                    $(IntegratorSettings::$Variant(settings) => settings.prepare(scene, camera, size, layers),)+
                }
            }

            fn values(&self) -> Settings {
                match self {
                    $(IntegratorSettings::$Variant(settings) => settings.values(),)+
                }
            }

            fn left_out(&self, scene: &Scene, size: [u32; 2]) -> Vec<&'static str> {
                let mut left_out = match self {
                    $(IntegratorSettings::$Variant(settings) => settings.left_out(scene, size),)+
                };
                left_out.extend(spec::without_frames(scene).filter(|_| !self.follows_frames()));
                left_out.extend(spec::without_learning(&self.values()).filter(|_| !self.learns_lights(scene)));
                left_out
            }

            fn learns_lights(&self, scene: &Scene) -> bool {
                match self {
                    $(IntegratorSettings::$Variant(settings) => settings.learns_lights(scene),)+
                }
            }

            fn follows_frames(&self) -> bool {
                match self {
                    $(IntegratorSettings::$Variant(settings) => settings.follows_frames(),)+
                }
            }
        }
    };
}

settings! {
    /// How open the surroundings of a surface are.
    AmbientOcclusion(AmbientOcclusionSettings),
    /// Light from both ends, or from lights alone.
    Bidirectional(BidirectionalSettings),
    /// Recursive ray tracing as in the course.
    Classic(ClassicSettings),
    /// Irradiance caching.
    Irradiance(IrradianceSettings),
    /// Metropolis light transport.
    Metropolis(MetropolisSettings),
    /// Path tracing, distribution ray tracing and direct light.
    Path(PathSettings),
    /// Photon mapping, of one map or of many.
    Photon(PhotonSettings),
    /// Vertex connection and merging.
    VertexMerging(VertexMergingSettings),
}

/// All integrators, by their names.
pub const INTEGRATORS: [&IntegratorSpec; 13] = [
    &bidir::BIDIRECTIONAL,
    &classic::CLASSIC,
    &path::DIRECT,
    &path::DISTRIBUTION,
    &irradiance::IRRADIANCE,
    &bidir::LIGHT,
    &metropolis::METROPOLIS,
    &metropolis::MULTIPLEXED,
    &ambient_occlusion::OCCLUSION,
    &path::PATH,
    &photon::PHOTON,
    &photon::SPPM,
    &vcm::VCM,
];

/// The names of all integrators, in the same order.
pub const NAMES: [&str; INTEGRATORS.len()] = {
    let mut names = [""; INTEGRATORS.len()];
    let mut i = 0;
    while i < names.len() {
        names[i] = INTEGRATORS[i].name.0;
        i += 1;
    }
    names
};

/// The integrator of scenes that ask for none.
pub const DEFAULT: &IntegratorSpec = &classic::CLASSIC;

/// What all integrators of this family do: take a sample and tell of it. A member is a file with a type that does this.
pub(crate) trait Integrator: Sync {
    /// Casts one camera ray and follows it; `observer` is called for every ray and all light that is found.
    ///
    /// * the rest: as for [`PixelIntegrator::sample`]
    fn observe<O: PathObserver>(
        &self,
        ctx: &mut SampleContext<'_>,
        pixel: [u32; 2],
        raster: Vec2,
        observer: &mut O,
    ) -> PixelSample;

    /// As [`PixelIntegrator::trails_need_state`].
    fn trails_need_state(&self) -> bool {
        Integrator::samples_per_state(self).is_some()
    }

    /// As [`PixelIntegrator::samples_per_state`].
    fn samples_per_state(&self) -> Option<SamplesPerState> {
        None
    }

    /// As [`PixelIntegrator::noise_is_known`].
    fn noise_is_known(&self) -> bool {
        matches!(Integrator::samples_per_state(self), None | Some(SamplesPerState::ONE))
    }

    /// As [`PixelIntegrator::keep_state`].
    fn keep_state(&mut self, _kept: &KeptState) -> bool {
        false
    }

    /// As [`PixelIntegrator::with_state`], for those that have some.
    fn with_state<'a>(&'a self, _k: u32, _setup: &Setup<'_>) -> Result<WithState<'a>, SetupError> {
        Err(SetupError::Refused("this integrator has no state".to_owned()))
    }
}

/// One code for renders, where rays are counted, and for debug rays, where all is kept.
impl<I: Integrator> PixelIntegrator for I {
    fn sample(&self, ctx: &mut SampleContext<'_>, pixel: [u32; 2], raster: Vec2) -> PixelSample {
        let mut counting = Counting::new(ctx);
        let sample = self.observe(ctx, pixel, raster, &mut counting);
        (ctx.rays, ctx.aux.seen) = (counting.rays, counting.seen);
        sample
    }

    fn trail(&self, ctx: &mut SampleContext<'_>, pixel: [u32; 2], raster: Vec2) -> (PixelSample, Trail) {
        let mut trail = Trail::default();
        (self.observe(ctx, pixel, raster, &mut trail), trail)
    }

    fn trails_need_state(&self) -> bool {
        Integrator::trails_need_state(self)
    }

    fn samples_per_state(&self) -> Option<SamplesPerState> {
        Integrator::samples_per_state(self)
    }

    fn noise_is_known(&self) -> bool {
        Integrator::noise_is_known(self)
    }

    fn keep_state(&mut self, kept: &KeptState) -> bool {
        Integrator::keep_state(self, kept)
    }

    fn with_state<'a>(&'a self, k: u32, setup: &Setup<'_>) -> Result<WithState<'a>, SetupError> {
        Integrator::with_state(self, k, setup)
    }
}

#[cfg(test)]
mod choice_tests;
#[cfg(test)]
mod clamp_tests;
#[cfg(test)]
mod flat_tests;
#[cfg(test)]
mod footprint_tests;
#[cfg(test)]
mod given_tests;
#[cfg(test)]
mod immersion_tests;
#[cfg(test)]
mod limit_tests;
#[cfg(test)]
mod motion_tests;
#[cfg(test)]
mod relief_tests;
#[cfg(test)]
mod same_picture;
#[cfg(test)]
mod solid_tests;
#[cfg(test)]
mod spec_tests;
#[cfg(test)]
mod tests;
