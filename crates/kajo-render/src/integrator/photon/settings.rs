//! The integrators that keep photons.

use kajo_core::camera::Camera;
use kajo_core::light::LightChoice;
use kajo_core::scene::Scene;
use kajo_core::settings::{IntegratorName, PhotonMapUse, Settings, SettingsKey};

use super::PhotonMapping;
use crate::integrator::{
    IntegratorSettings, IntegratorSpec, Prepare, Quantity, SettingsContext, bounces_from_both_ends, cut_off,
};
use crate::{LayerSet, PixelIntegrator};

/// Options of [`PhotonMapping`].
#[derive(Clone, Copy, Debug)]
pub struct PhotonSettings {
    /// Maximum number of scattering events of a path; 0 is direct illumination only.
    pub bounces: u32,
    /// Paths from lights that the photons of one map are left by, at least 1.
    pub photons: u32,
    /// What the map is used for; `None` for a new one for each sample of a pixel, in ever smaller disks.
    pub usage: Option<PhotonMapUse>,
    /// How lights are chosen for a point.
    pub light_choice: LightChoice,
    /// Whether paths of little weight end at random.
    pub roulette: bool,
    /// Whether light is followed by wavelength. One map for all samples knows none.
    pub spectral: bool,
}

impl Default for PhotonSettings {
    fn default() -> PhotonSettings {
        PhotonSettings {
            bounces: 16,
            photons: 500_000,
            usage: Some(PhotonMapUse::Gather),
            light_choice: LightChoice::Tree,
            roulette: true,
            spectral: false,
        }
    }
}

/// Paths from lights for each pixel that a pass of progressive photon mapping follows, unless something else is said.
///
/// With fewer the first disks are wider than pixels need, and the time goes into paths from the camera; with more there are few passes.
const PHOTONS_PER_PIXEL: u32 = 2;

/// Photon mapping.
pub const PHOTON: IntegratorSpec = IntegratorSpec {
    name: IntegratorName("photon"),
    about: "photons from lights, kept in a map that all samples share",
    quantity: Quantity::Radiance,
    splats: false,
    samples: 64,
    keys: &[
        SettingsKey::Bounces,
        SettingsKey::Photons,
        SettingsKey::PhotonMap,
        SettingsKey::LightChoice,
        SettingsKey::Roulette,
        SettingsKey::Clamp,
    ],
    settings: |context| {
        let default = default_in(context);
        let usage = context.said.photon_map.unwrap_or_default();
        IntegratorSettings::Photon(PhotonSettings {
            usage: Some(usage),
            spectral: false,
            ..said(context, default)
        })
    },
};

/// Progressive photon mapping.
pub const SPPM: IntegratorSpec = IntegratorSpec {
    name: IntegratorName("sppm"),
    about: "photons anew for each sample, in ever smaller disks",
    keys: &[
        SettingsKey::Bounces,
        SettingsKey::Photons,
        SettingsKey::LightChoice,
        SettingsKey::Roulette,
        SettingsKey::Clamp,
        SettingsKey::Spectral,
    ],
    settings: |context| {
        let photons = context.paths_for_pixels(PHOTONS_PER_PIXEL);
        let default = PhotonSettings { photons, usage: None, ..default_in(context) };
        IntegratorSettings::Photon(said(context, default))
    },
    ..PHOTON
};

/// What holds in a scene where nothing is said.
fn default_in(context: &SettingsContext<'_>) -> PhotonSettings {
    let default = PhotonSettings::default();
    PhotonSettings { bounces: bounces_from_both_ends(context.scene, default.bounces), ..default }
}

/// What is said for the keys that both of them listen to, and `default` where nothing is.
fn said(context: &SettingsContext<'_>, default: PhotonSettings) -> PhotonSettings {
    let said = context.said;
    PhotonSettings {
        bounces: said.bounces.unwrap_or(default.bounces),
        photons: said.photons.unwrap_or(default.photons),
        light_choice: said.light_choice.unwrap_or(default.light_choice),
        roulette: said.roulette.unwrap_or(default.roulette),
        spectral: said.spectral.unwrap_or(default.spectral),
        ..default
    }
}

impl Prepare for PhotonSettings {
    fn prepare<'a>(
        self,
        scene: &'a Scene,
        camera: &'a Camera,
        size: [u32; 2],
        layers: LayerSet,
    ) -> Box<dyn PixelIntegrator + 'a> {
        Box::new(PhotonMapping::through(camera, scene, self, size, layers))
    }

    fn values(&self) -> Settings {
        Settings {
            bounces: Some(self.bounces),
            photons: Some(self.photons),
            photon_map: self.usage,
            light_choice: Some(self.light_choice),
            roulette: Some(self.roulette),
            spectral: Some(self.spectral),
            ..Settings::default()
        }
    }

    fn left_out(&self, scene: &Scene, _size: [u32; 2]) -> Vec<&'static str> {
        let notes = [
            (
                scene.has_moving_things() && self.usage.is_some(),
                "things are lit by the photons of an eighth of the time that the shutter is open, since they move; \
                 `integrator sppm` has all photons for each moment",
            ),
            (scene.lighting.groups.len() > 1, "photon maps do not tell groups of lights apart"),
            (
                scene.lights_endless_surfaces(),
                "photons from infinitely far away come to planes without end only around the other things: what a plane reflects beyond is left out",
            ),
        ];
        let notes = notes.into_iter().filter_map(|(applies, note)| applies.then_some(note));
        notes.chain(cut_off(scene, self.bounces)).collect()
    }
}
