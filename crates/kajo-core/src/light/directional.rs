//! Light from infinitely far away: parallel and without falloff.
//!
//! Given by its classic `color`, the factor of the shading formula, it has the irradiance `pi color` across its
//! direction; given by its `irradiance`, just that.
//!
//! Scene: `DirectionalLight { direction -1 -1 -1  color 0.9 0.9 0.9 }`; the light travels along `direction`.

use kajo_color::{Emission, Spectrum, Wavelengths};
use kajo_math::{Vec2, Vec3};

use super::{Emitter, Illumination, LightBounds, LightSample, Target};

/// A directional light.
#[derive(Clone, Debug)]
pub struct DirectionalLight {
    /// Unit direction from the scene towards the light.
    pub to_light: Vec3,
    /// Factor of the classic shading formula.
    pub intensity: Spectrum,
    /// Irradiance on a surface across the direction.
    pub emission: Emission,
}

impl Emitter for DirectionalLight {
    #[inline]
    fn illuminate(&self, _p: Vec3) -> Illumination {
        Illumination { wi: self.to_light, distance: f32::INFINITY, intensity: self.intensity }
    }

    #[inline]
    fn sample(&self, _p: Vec3, _u: Vec2, wavelengths: &Wavelengths) -> Option<LightSample> {
        let radiance = self.emission.at(wavelengths);
        Some(LightSample { wi: self.to_light, radiance, pdf: 1.0, is_delta: true, target: Target::Infinity })
    }

    fn bounds(&self) -> Option<LightBounds> {
        None
    }
}
