//! Settings of Metropolis light transport.

use kajo_core::camera::Camera;
use kajo_core::light::LightChoice;
use kajo_core::scene::Scene;
use kajo_core::settings::{IntegratorName, Settings, SettingsKey};

use super::Metropolis;
use crate::integrator::{IntegratorSettings, IntegratorSpec, Prepare, Quantity, bounces_from_both_ends};
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
    /// Whether samples of path tracing are moved, and not those of light from both ends.
    pub by_paths: bool,
}

impl Default for MetropolisSettings {
    fn default() -> MetropolisSettings {
        MetropolisSettings {
            bounces: 16,
            light_choice: LightChoice::Tree,
            roulette: true,
            spectral: false,
            by_paths: false,
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
    keys: &[SettingsKey::Bounces, SettingsKey::LightChoice, SettingsKey::Roulette, SettingsKey::Spectral],
    settings: |context| {
        let (said, default) = (context.said, MetropolisSettings::default());
        let bounces = bounces_from_both_ends(context.scene, default.bounces);
        IntegratorSettings::Metropolis(MetropolisSettings {
            bounces: said.bounces.unwrap_or(bounces),
            light_choice: said.light_choice.unwrap_or(default.light_choice),
            roulette: said.roulette.unwrap_or(default.roulette),
            spectral: said.spectral.unwrap_or(default.spectral),
            by_paths: default.by_paths,
        })
    },
};

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
            ..Settings::default()
        }
    }

    fn left_out(&self, scene: &Scene, _size: [u32; 2]) -> Vec<&'static str> {
        let groups = scene.lighting.groups.len() > 1;
        let groups = groups.then_some("Markov chains do not tell groups of lights apart");
        groups.into_iter().collect()
    }
}
