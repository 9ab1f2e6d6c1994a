//! Light from a point, with falloff `1 / (c0 + c1 d + c2 d^2)` at distance `d`.
//!
//! Scene: `PointLight { position 0 5 0  color 1 1 1  attenuation 0 0 1 }`

use kajo_color::Spectrum;
use kajo_math::Vec3;

use super::{Emitter, Illumination};

/// A point light.
#[derive(Clone, Copy, Debug)]
pub struct PointLight {
    /// World-space position.
    pub position: Vec3,
    /// Intensity where the falloff is one.
    pub intensity: Spectrum,
    /// Coefficients `[c0, c1, c2]` of the falloff.
    pub attenuation: [f32; 3],
}

impl Emitter for PointLight {
    #[inline]
    fn illuminate(&self, p: Vec3) -> Illumination {
        let to_light = self.position - p;
        let d = to_light.length();
        let [c0, c1, c2] = self.attenuation;
        let falloff = 1.0 / (c0 + d * (c1 + d * c2));
        Illumination { wi: to_light / d, distance: d, intensity: self.intensity * falloff }
    }
}
