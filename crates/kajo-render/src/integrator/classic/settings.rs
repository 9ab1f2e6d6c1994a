//! The classic integrator by its name.

use kajo_core::RayOffset;
use kajo_core::bsdf::Highlight;
use kajo_core::camera::Camera;
use kajo_core::scene::Scene;
use kajo_core::settings::{IntegratorName, Settings, SettingsKey, ShadowAttenuation, Shadows};

use super::Classic;
use crate::integrator::{
    Defaults, IntegratorSettings, IntegratorSpec, Prepare, Quantity, SettingsContext, without_curves,
    without_media,
};
use crate::{Layer, LayerSet, PixelIntegrator};

/// The most mirror and refracted rays in a row that may be asked for.
pub const MAX_BOUNCES: u32 = 1000;

/// Options of [`Classic`].
#[derive(Clone, Copy, Debug)]
pub struct ClassicSettings {
    /// Mirror and refracted rays in a row, at most [`MAX_BOUNCES`].
    pub bounces: u32,
    /// A branch ends where the product of the magnitudes of its colours falls below this.
    pub weight: f32,
    /// Whether and how lights are hidden.
    pub shadows: Shadows,
    /// How transparent shadows weaken light.
    pub shadow_attenuation: ShadowAttenuation,
    /// Whether surfaces are lit on their back sides too.
    pub shade_back: bool,
    /// Show the uv test picture instead of the scene.
    pub uv: bool,
    /// Divide light at transparent surfaces by Fresnel's equations.
    pub fresnel: bool,
    /// Mirror what cannot leave a transparent body.
    pub total_reflection: bool,
    /// How rays keep clear of the surface they leave.
    pub ray_offset: RayOffset,
    /// The vector of the highlight.
    pub highlight: Highlight,
}

/// Recursive ray tracing with the classic shading formula.
pub const CLASSIC: IntegratorSpec = IntegratorSpec {
    name: IntegratorName("classic"),
    about: "recursive ray tracing with the classic shading formula",
    quantity: Quantity::Shading,
    splats: false,
    samples: 16,
    keys: &[
        SettingsKey::Bounces,
        SettingsKey::Weight,
        SettingsKey::Fresnel,
        SettingsKey::TotalReflection,
        SettingsKey::RayOffset,
        SettingsKey::Shadows,
        SettingsKey::ShadowAttenuation,
        SettingsKey::ShadeBack,
    ],
    settings: |context| IntegratorSettings::Classic(said(context)),
};

/// What is said, and the defaults of the course or the usual ones where nothing is.
fn said(context: &SettingsContext<'_>) -> ClassicSettings {
    let &SettingsContext { said, scene, defaults, uv, .. } = context;
    let is_course = defaults == Defaults::Classic;
    let (bounces, shadows, ray_offset) = match defaults {
        Defaults::Classic => (0, Shadows::Off, RayOffset::Reference),
        Defaults::Modern => (4, Shadows::Opaque, RayOffset::Auto),
    };
    ClassicSettings {
        bounces: said.bounces.unwrap_or(bounces),
        weight: said.weight.unwrap_or(0.0),
        shadows: said.shadows.unwrap_or(shadows),
        shadow_attenuation: said.shadow_attenuation.unwrap_or(scene.output.rules.shadow_attenuation),
        shade_back: said.shade_back.unwrap_or(false),
        uv: uv || (is_course && !scene.output.has_group),
        fresnel: said.fresnel.unwrap_or(false),
        total_reflection: said.total_reflection.unwrap_or(false),
        ray_offset: said.ray_offset.unwrap_or(ray_offset),
        highlight: scene.output.rules.highlight,
    }
}

impl Prepare for ClassicSettings {
    /// Depth and normals are those of the first surface, so that without colour nothing further is followed.
    fn prepare<'a>(
        self,
        scene: &'a Scene,
        camera: &'a Camera,
        size: [u32; 2],
        layers: LayerSet,
    ) -> Box<dyn PixelIntegrator + 'a> {
        let settings = match layers.has(Layer::Color) {
            true => self,
            false => ClassicSettings { bounces: 0, shadows: Shadows::Off, ..self },
        };
        Box::new(Classic::through(camera, scene, settings, size, layers))
    }

    fn values(&self) -> Settings {
        Settings {
            bounces: Some(self.bounces),
            weight: Some(self.weight),
            shadows: Some(self.shadows),
            shadow_attenuation: Some(self.shadow_attenuation),
            shade_back: Some(self.shade_back),
            fresnel: Some(self.fresnel),
            total_reflection: Some(self.total_reflection),
            ray_offset: Some(self.ray_offset),
            ..Settings::default()
        }
    }

    fn left_out(&self, scene: &Scene, _size: [u32; 2]) -> Vec<&'static str> {
        without_media(scene).into_iter().chain(without_curves(scene)).collect()
    }
}
