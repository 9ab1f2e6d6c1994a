//! The integrators that follow light from both ends, or from lights alone.

use kajo_core::camera::Camera;
use kajo_core::light::LightChoice;
use kajo_core::scene::Scene;
use kajo_core::settings::{IntegratorName, Settings, SettingsKey};

use crate::integrator::{
    IntegratorSettings, IntegratorSpec, Prepare, Quantity, SettingsContext, bounces_from_both_ends, cut_off,
};
use crate::{LayerSet, PixelIntegrator};

/// Options of [`super::Bidirectional`].
#[derive(Clone, Copy, Debug)]
pub struct BidirectionalSettings {
    /// Maximum number of scattering events of a path; 0 is direct illumination only.
    pub bounces: u32,
    /// Whether light is followed from lights only.
    pub only_from_lights: bool,
    /// How lights are chosen for a point.
    pub light_choice: LightChoice,
    /// Whether paths of little weight end at random.
    pub roulette: bool,
    /// Whether light is followed by wavelength.
    pub spectral: bool,
}

impl Default for BidirectionalSettings {
    fn default() -> BidirectionalSettings {
        BidirectionalSettings {
            bounces: 16,
            only_from_lights: false,
            light_choice: LightChoice::Tree,
            roulette: true,
            spectral: false,
        }
    }
}

/// Bidirectional path tracing.
pub const BIDIRECTIONAL: IntegratorSpec = IntegratorSpec {
    name: IntegratorName("bidirectional"),
    about: "paths from the camera and from lights, joined",
    quantity: Quantity::Radiance,
    splats: true,
    samples: 64,
    keys: &[
        SettingsKey::Bounces,
        SettingsKey::LightChoice,
        SettingsKey::Roulette,
        SettingsKey::Clamp,
        SettingsKey::Spectral,
    ],
    settings: |context| {
        let default = BidirectionalSettings::default();
        let light_choice = context.said.light_choice.unwrap_or(default.light_choice);
        IntegratorSettings::Bidirectional(BidirectionalSettings { light_choice, ..said(context, default) })
    },
};

/// Light tracing.
pub const LIGHT: IntegratorSpec = IntegratorSpec {
    name: IntegratorName("light"),
    about: "paths from lights alone",
    // No light is ever chosen for a point.
    keys: &[SettingsKey::Bounces, SettingsKey::Roulette, SettingsKey::Clamp, SettingsKey::Spectral],
    settings: |context| {
        let default = BidirectionalSettings { only_from_lights: true, ..BidirectionalSettings::default() };
        IntegratorSettings::Bidirectional(said(context, default))
    },
    ..BIDIRECTIONAL
};

/// What is said for the keys that both of them listen to, and `default` where nothing is.
fn said(context: &SettingsContext<'_>, default: BidirectionalSettings) -> BidirectionalSettings {
    let said = context.said;
    let bounces = bounces_from_both_ends(context.scene, default.bounces);
    BidirectionalSettings {
        bounces: said.bounces.unwrap_or(bounces),
        roulette: said.roulette.unwrap_or(default.roulette),
        spectral: said.spectral.unwrap_or(default.spectral),
        ..default
    }
}

impl Prepare for BidirectionalSettings {
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
            light_choice: Some(self.light_choice),
            roulette: Some(self.roulette),
            spectral: Some(self.spectral),
            ..Settings::default()
        }
    }

    fn left_out(&self, scene: &Scene, size: [u32; 2]) -> Vec<&'static str> {
        let cut_off = cut_off(scene, self.bounces);
        if !self.only_from_lights {
            return cut_off.into_iter().collect();
        }
        let notes = [
            (scene.lighting.groups.len() > 1, "light tracing does not tell groups of lights apart"),
            (
                !connects(scene, size),
                "light from emitters does not find this camera, only perspective and orthographic ones",
            ),
            (
                scene.moves() && scene.output.readout > 0.0,
                "light from emitters does not find a camera whose rows open one after the other while things move",
            ),
        ];
        let notes = notes.into_iter().filter_map(|(applies, note)| applies.then_some(note));
        notes.chain(cut_off).collect()
    }
}

/// Whether points can be joined with the camera.
fn connects(scene: &Scene, [width, height]: [u32; 2]) -> bool {
    scene.output.camera.is_connectable()
        && !scene.output.rules.corner_samples
        && !(scene.output.rules.spans_width && width != height)
}
