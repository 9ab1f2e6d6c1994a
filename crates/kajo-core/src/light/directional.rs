//! Light from infinitely far away: parallel and without falloff.
//!
//! Scene: `DirectionalLight { direction -1 -1 -1  color 0.9 0.9 0.9 }`; the light travels along `direction`.

use kajo_color::Spectrum;
use kajo_math::Vec3;

use super::{Emitter, Illumination};

/// A directional light.
#[derive(Clone, Copy, Debug)]
pub struct DirectionalLight {
    /// Unit direction from the scene towards the light.
    pub to_light: Vec3,
    /// Intensity everywhere.
    pub intensity: Spectrum,
}

impl Emitter for DirectionalLight {
    #[inline]
    fn illuminate(&self, _p: Vec3) -> Illumination {
        Illumination { wi: self.to_light, distance: f32::INFINITY, intensity: self.intensity }
    }
}
