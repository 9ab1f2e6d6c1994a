//! The integrator that connects and merges.

use kajo_core::camera::Camera;
use kajo_core::light::LightChoice;
use kajo_core::scene::Scene;
use kajo_core::settings::{IntegratorName, Settings, SettingsKey};

use crate::integrator::{
    IntegratorSettings, IntegratorSpec, Prepare, Quantity, SettingsContext, bounces_from_both_ends, cut_off,
};
use crate::{LayerSet, PixelIntegrator};

/// Options of [`super::VertexMerging`].
#[derive(Clone, Copy, Debug)]
pub struct VertexMergingSettings {
    /// Maximum number of scattering events of a path; 0 is direct illumination only.
    pub bounces: u32,
    /// Paths from lights whose vertices are kept for a sample of all pixels, at least 1; a scene's settings ask for as many as there are pixels.
    pub photons: u32,
    /// Whether vertices are merged; without that it is the bidirectional integrator.
    pub merging: bool,
    /// Radius of the first disks in world units; 0 for one that suits the picture.
    pub radius: f32,
    /// How disks shrink from pass to pass, from 0 to 1: their area goes as `i^(alpha - 1)`.
    pub alpha: f32,
    /// How lights are chosen for a point.
    pub light_choice: LightChoice,
    /// Whether paths of little weight end at random.
    pub roulette: bool,
    /// Whether light is followed by wavelength.
    pub spectral: bool,
}

impl Default for VertexMergingSettings {
    fn default() -> VertexMergingSettings {
        VertexMergingSettings {
            bounces: 16,
            photons: 100_000,
            merging: true,
            radius: 0.0,
            alpha: 0.75,
            light_choice: LightChoice::Tree,
            roulette: true,
            spectral: false,
        }
    }
}

/// Vertex connection and merging.
pub const VCM: IntegratorSpec = IntegratorSpec {
    name: IntegratorName("vcm"),
    about: "paths from the camera and from lights, joined and merged",
    quantity: Quantity::Radiance,
    splats: true,
    samples: 64,
    keys: &[
        SettingsKey::Bounces,
        SettingsKey::Photons,
        SettingsKey::Merging,
        SettingsKey::MergeRadius,
        SettingsKey::MergeAlpha,
        SettingsKey::LightChoice,
        SettingsKey::Roulette,
        SettingsKey::Clamp,
        SettingsKey::Spectral,
    ],
    settings,
};

fn settings(context: &SettingsContext<'_>) -> IntegratorSettings {
    let (said, default) = (context.said, VertexMergingSettings::default());
    let bounces = bounces_from_both_ends(context.scene, default.bounces);
    IntegratorSettings::VertexMerging(VertexMergingSettings {
        bounces: said.bounces.unwrap_or(bounces),
        photons: said.photons.unwrap_or_else(|| context.paths_for_pixels(1)),
        merging: said.merging.unwrap_or(default.merging),
        radius: said.merge_radius.unwrap_or(default.radius),
        alpha: said.merge_alpha.unwrap_or(default.alpha),
        light_choice: said.light_choice.unwrap_or(default.light_choice),
        roulette: said.roulette.unwrap_or(default.roulette),
        spectral: said.spectral.unwrap_or(default.spectral),
    })
}

impl Prepare for VertexMergingSettings {
    fn prepare<'a>(
        self,
        scene: &'a Scene,
        camera: &'a Camera,
        size: [u32; 2],
        layers: LayerSet,
    ) -> Box<dyn PixelIntegrator + 'a> {
        super::integrator_of(camera, scene, self, size, layers)
    }

    fn values(&self) -> Settings {
        Settings {
            bounces: Some(self.bounces),
            photons: Some(self.photons),
            merging: Some(self.merging),
            merge_radius: Some(self.radius),
            merge_alpha: Some(self.alpha),
            light_choice: Some(self.light_choice),
            roulette: Some(self.roulette),
            spectral: Some(self.spectral),
            ..Settings::default()
        }
    }

    fn left_out(&self, scene: &Scene, _size: [u32; 2]) -> Vec<&'static str> {
        cut_off(scene, self.bounces).into_iter().collect()
    }
}
