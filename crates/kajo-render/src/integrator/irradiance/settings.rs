//! The integrator that keeps irradiance.

use kajo_core::camera::Camera;
use kajo_core::light::LightChoice;
use kajo_core::scene::Scene;
use kajo_core::settings::{Gradients, IntegratorName, Settings, SettingsKey};

use super::IrradianceCaching;
use crate::integrator::path::PathSettings;
use crate::integrator::{IntegratorSettings, IntegratorSpec, Prepare, Quantity, bounces_of_paths};
use crate::{LayerSet, PixelIntegrator};

/// Options of [`IrradianceCaching`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IrradianceSettings {
    /// Maximum number of scattering events of a path before the surface that the cache lights.
    pub bounces: u32,
    /// The error that a record may make by being taken for its surroundings, as a share of its irradiance; positive.
    pub accuracy: f32,
    /// Rays that a record is made by at most, at least 16.
    pub rays: u32,
    /// What is known of how irradiance changes around a record.
    pub gradients: Gradients,
    /// Whether the irradiance and its records are shown in place of the picture.
    pub shows_records: bool,
    /// How lights are chosen for a point.
    pub light_choice: LightChoice,
    /// Whether paths of little weight end at random.
    pub roulette: bool,
}

impl Default for IrradianceSettings {
    fn default() -> IrradianceSettings {
        IrradianceSettings {
            bounces: 16,
            accuracy: 0.1,
            rays: 2048,
            gradients: Gradients::Occlusion,
            shows_records: false,
            light_choice: LightChoice::Tree,
            roulette: true,
        }
    }
}

impl IrradianceSettings {
    /// How paths are followed from the camera.
    pub(super) fn paths(&self) -> PathSettings {
        let IrradianceSettings { bounces, light_choice, roulette, .. } = *self;
        // What is behind glass and in mirrors is lit by the cache too.
        PathSettings { bounces, free_mirrors: bounces, light_choice, roulette, ..PathSettings::default() }
    }
}

/// Irradiance caching.
pub const IRRADIANCE: IntegratorSpec = IntegratorSpec {
    name: IntegratorName("irradiance"),
    about: "indirect light of matt surfaces interpolated between few points",
    quantity: Quantity::Radiance,
    splats: false,
    samples: 64,
    keys: &[
        SettingsKey::Bounces,
        SettingsKey::Accuracy,
        SettingsKey::Rays,
        SettingsKey::Gradients,
        SettingsKey::ShowRecords,
        SettingsKey::LightChoice,
        SettingsKey::Roulette,
        SettingsKey::Clamp,
    ],
    settings: |context| {
        let (said, default) = (context.said, IrradianceSettings::default());
        IntegratorSettings::Irradiance(IrradianceSettings {
            bounces: said.bounces.unwrap_or(bounces_of_paths(context.scene, default.bounces)),
            accuracy: said.accuracy.unwrap_or(default.accuracy),
            rays: said.rays.unwrap_or(default.rays),
            gradients: said.gradients.unwrap_or(default.gradients),
            shows_records: said.show_records.unwrap_or(default.shows_records),
            light_choice: said.light_choice.unwrap_or(default.light_choice),
            roulette: said.roulette.unwrap_or(default.roulette),
        })
    },
};

impl Prepare for IrradianceSettings {
    fn prepare<'a>(
        self,
        scene: &'a Scene,
        camera: &'a Camera,
        size: [u32; 2],
        layers: LayerSet,
    ) -> Box<dyn PixelIntegrator + 'a> {
        Box::new(IrradianceCaching::through(camera, scene, self, size, layers))
    }

    fn values(&self) -> Settings {
        Settings {
            bounces: Some(self.bounces),
            accuracy: Some(self.accuracy),
            rays: Some(self.rays),
            gradients: Some(self.gradients),
            show_records: Some(self.shows_records),
            light_choice: Some(self.light_choice),
            roulette: Some(self.roulette),
            ..Settings::default()
        }
    }

    fn left_out(&self, scene: &Scene, _size: [u32; 2]) -> Vec<&'static str> {
        let notes = [
            (
                scene.has_moving_things(),
                "records belong to one moment each, so indirect light of what moves is blurred",
            ),
            (
                scene.lighting.groups.len() > 1,
                "indirect light of matt surfaces is in no layer of a group of lights",
            ),
        ];
        notes.into_iter().filter_map(|(applies, note)| applies.then_some(note)).collect()
    }
}
