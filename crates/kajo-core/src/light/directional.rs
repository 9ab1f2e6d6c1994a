//! Light from infinitely far away: parallel and without falloff.
//!
//! Given by its classic `color`, the factor of the shading formula, it has the irradiance `pi color` across its
//! direction; given by its `irradiance`, just that.
//!
//! With an `angle` it is a disc of this diameter in the sky, as the sun is of 0.53 degrees: shadows have soft
//! edges. Only drawn directions find it, so that it is not seen itself, in mirrors neither.
//!
//! Scene: `DirectionalLight { direction -1 -1 -1  color 0.9 0.9 0.9 }`; the light travels along `direction`.

use kajo_color::{Emission, Spectrum, Wavelengths};
use kajo_math::{Frame, Vec2, Vec3, warp};

use super::emit::INVERSE_SQUARE;
use super::{Ball, EmissionPdf, Emitted, Emitter, Illumination, LightBounds, LightSample, Target};

/// A directional light.
#[derive(Clone, Debug)]
pub struct DirectionalLight {
    /// Unit direction from the scene towards the light.
    pub to_light: Vec3,
    /// `1 - cos r` of the angle `r` from the middle of the light's disc to its edge: 0 for a light without extent.
    pub disc: f32,
    /// Factor of the classic shading formula.
    pub intensity: Spectrum,
    /// Irradiance on a surface across the direction.
    pub emission: Emission,
}

impl Emitter for DirectionalLight {
    #[inline]
    fn illuminate(&self, _p: Vec3, _time: f32) -> Illumination {
        Illumination { wi: self.to_light, distance: f32::INFINITY, intensity: self.intensity }
    }

    #[inline]
    fn sample(&self, _p: Vec3, _time: f32, u: Vec2, wavelengths: &Wavelengths) -> Option<LightSample> {
        let mut radiance = self.emission.at(wavelengths);
        let mut wi = self.to_light;
        if self.disc > 0.0 {
            wi = Frame::from_normal(wi).to_world(warp::uniform_cone(u, self.disc)).normalize();
            // The disc's radiance E / (pi sin^2 r) times its solid angle 2 pi (1 - cos r).
            radiance *= 2.0 / (2.0 - self.disc);
        }
        Some(LightSample { wi, radiance, pdf: 1.0, is_delta: true, target: Target::Infinity, lamp: 0 })
    }

    fn bounds(&self) -> Option<LightBounds> {
        None
    }

    fn emit(&self, _time: f32, u: [Vec2; 2], wavelengths: &Wavelengths, world: &Ball) -> Option<Emitted> {
        let LightSample { wi, radiance, .. } = self.sample(world.center, 0.0, u[1], wavelengths)?;
        Some(Emitted {
            p: world.disk(u[0], -wi),
            origin: Target::Infinity,
            d: -wi,
            radiance,
            attenuation: INVERSE_SQUARE,
            pdf: EmissionPdf { place: 1.0 / world.cross_section(), direction: 1.0 },
            is_delta: true,
        })
    }

    fn emission_pdf(&self, _time: f32, [p, _]: [Vec3; 2], d: Vec3, world: &Ball) -> EmissionPdf {
        EmissionPdf { place: world.pdf(p, d), direction: 1.0 }
    }

    fn power(&self, world: &Ball) -> f32 {
        self.emission.luminance() * world.cross_section()
    }
}
