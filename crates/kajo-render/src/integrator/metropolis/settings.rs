//! Settings of Metropolis light transport.

use kajo_core::camera::Camera;
use kajo_core::light::LightChoice;
use kajo_core::scene::Scene;
use kajo_core::settings::{Caustics, IntegratorName, Settings, SettingsKey};

use super::Metropolis;
use crate::integrator::path::{PathSettings, WITHOUT_WALKS};
use crate::integrator::{
    IntegratorSettings, IntegratorSpec, Prepare, Quantity, SettingsContext, bounces_from_both_ends, cut_off,
};
use crate::{LayerSet, PixelIntegrator};

/// Options of [`Metropolis`].
#[derive(Clone, Copy, Debug)]
pub struct MetropolisSettings {
    /// Maximum number of scattering events of a path; 0 is direct illumination only.
    pub bounces: u32,
    /// How lights are chosen for a point.
    pub light_choice: LightChoice,
    /// Whether paths of little weight end at random.
    pub roulette: bool,
    /// Whether light is followed by wavelength.
    pub spectral: bool,
    /// What is mutated.
    pub samples: MutatedSamples,
    /// How lights behind glass are found; heeded where the samples are [`MutatedSamples::OfPaths`].
    pub caustics: Caustics,
}

/// The samples that Markov chains mutate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MutatedSamples {
    /// Those of path tracing.
    OfPaths,
    /// Those of bidirectional path tracing.
    OfBothEnds,
    /// The same by one technique each, with chains for each number of vertices.
    ByTechnique,
}

/// The most bounces where each has chains of its own.
const MOST_BOUNCES: u32 = 200;

impl MetropolisSettings {
    /// Scattering events of the longest paths.
    pub(super) fn bounces_followed(&self) -> u32 {
        match self.samples {
            MutatedSamples::ByTechnique => self.bounces.min(MOST_BOUNCES),
            MutatedSamples::OfPaths | MutatedSamples::OfBothEnds => self.bounces,
        }
    }

    /// Those of the paths whose samples are mutated.
    pub(super) fn of_paths(&self) -> PathSettings {
        let MetropolisSettings { light_choice, roulette, spectral, caustics, .. } = *self;
        let bounces = self.bounces_followed();
        PathSettings { bounces, light_choice, roulette, spectral, caustics, ..PathSettings::DEFAULT }
    }
}

impl Default for MetropolisSettings {
    fn default() -> MetropolisSettings {
        MetropolisSettings {
            bounces: 16,
            light_choice: LightChoice::Tree,
            roulette: true,
            spectral: false,
            samples: MutatedSamples::OfBothEnds,
            caustics: Caustics::Scattering,
        }
    }
}

/// Metropolis light transport.
pub const METROPOLIS: IntegratorSpec = IntegratorSpec {
    name: IntegratorName("mlt"),
    about: "paths from both ends, moved to where much light is",
    quantity: Quantity::Radiance,
    splats: true,
    samples: 64,
    keys: &[
        SettingsKey::Bounces,
        SettingsKey::LightChoice,
        SettingsKey::Caustics,
        SettingsKey::Roulette,
        SettingsKey::Spectral,
    ],
    settings: |context| {
        let caustics = context.said.caustics.unwrap_or_default();
        let walking = MetropolisSettings { caustics, ..MetropolisSettings::default() };
        // Paths from the camera alone draw lights through glass.
        let walks = walking.of_paths().walks_in(context.scene);
        let samples = if walks { MutatedSamples::OfPaths } else { walking.samples };
        said(context, MetropolisSettings { samples, ..walking })
    },
};

/// Multiplexed Metropolis light transport.
pub const MULTIPLEXED: IntegratorSpec = IntegratorSpec {
    name: IntegratorName("mmlt"),
    about: "the same with chains for each number of bounces, that choose how paths are joined",
    keys: &[SettingsKey::Bounces, SettingsKey::LightChoice, SettingsKey::Roulette, SettingsKey::Spectral],
    settings: |context| {
        let samples = MutatedSamples::ByTechnique;
        said(context, MetropolisSettings { samples, ..MetropolisSettings::default() })
    },
    ..METROPOLIS
};

/// What is said, and `default` where nothing is.
fn said(context: &SettingsContext<'_>, default: MetropolisSettings) -> IntegratorSettings {
    let said = context.said;
    let settings =
        MetropolisSettings { bounces: bounces_from_both_ends(context.scene, default.bounces), ..default };
    IntegratorSettings::Metropolis(MetropolisSettings {
        bounces: said.bounces.unwrap_or(settings.bounces_followed()),
        light_choice: said.light_choice.unwrap_or(default.light_choice),
        roulette: said.roulette.unwrap_or(default.roulette),
        spectral: said.spectral.unwrap_or(default.spectral),
        ..default
    })
}

impl Prepare for MetropolisSettings {
    fn prepare<'a>(
        self,
        scene: &'a Scene,
        camera: &'a Camera,
        size: [u32; 2],
        layers: LayerSet,
    ) -> Box<dyn PixelIntegrator + 'a> {
        Box::new(Metropolis::through(camera, scene, self, size, layers))
    }

    fn values(&self) -> Settings {
        Settings {
            bounces: Some(self.bounces),
            light_choice: Some(self.light_choice),
            roulette: Some(self.roulette),
            spectral: Some(self.spectral),
            caustics: Some(self.caustics),
            ..Settings::default()
        }
    }

    fn left_out(&self, scene: &Scene, _size: [u32; 2]) -> Vec<&'static str> {
        let groups = scene.lighting.groups.len() > 1;
        let groups = groups.then_some("Markov chains do not tell groups of lights apart");
        let bounces = (self.bounces_followed() < self.bounces)
            .then_some("multiplexed Markov chains follow 200 bounces; `mlt` follows more");
        let walks = self.caustics == Caustics::Manifold && !self.of_paths().walks_in(scene);
        let walks = walks.then_some(WITHOUT_WALKS);
        groups
            .into_iter()
            .chain(bounces)
            .chain(walks)
            .chain(cut_off(scene, self.bounces_followed()))
            .collect()
    }
}
