//! Light from a point, with falloff `1 / (c0 + c1 d + c2 d^2)` at distance `d`.
//!
//! A classic light is given by its `color`, the factor of the shading formula where the falloff is one. Its
//! physical meaning is the irradiance `pi color falloff`, which makes a white Lambertian surface as bright as
//! the formula does. A light given by its `intensity` in W/sr has the irradiance `intensity / d^2`.
//!
//! Scene: `PointLight { position 0 5 0  color 1 1 1  attenuation 0 0 1 }`
//! Scene: `PointLight { position 0 5 0  intensity 40 40 40 }`

use std::f32::consts::FRAC_1_PI;

use kajo_color::{Emission, Spectrum, Wavelengths};
use kajo_math::{Aabb, Vec2, Vec3, warp};

use super::sample::INVERSE_SQUARE;
use super::{
    BoundingSphere, EmissionPdf, EmissiveSurfaces, Emitter, Illumination, LeNumbers, LightBounds,
    LightLeSample, LightLiSample, LightPoint, Receiver, classic_factor,
};

/// A point light.
#[derive(Clone, Debug)]
pub struct PointLight {
    /// World-space position.
    pub position: Vec3,
    /// Factor of the classic shading formula where the falloff is one.
    pub intensity: Spectrum,
    /// Irradiance where the falloff is one.
    pub emission: Emission,
    /// Coefficients `[c0, c1, c2]` of the falloff.
    pub attenuation: [f32; 3],
}

impl PointLight {
    /// A light that falls off with the square of the distance.
    ///
    /// * `intensity`: in W/sr
    pub fn new(position: Vec3, intensity: Emission) -> PointLight {
        let factor = classic_factor(&intensity);
        PointLight { position, intensity: factor, emission: intensity, attenuation: INVERSE_SQUARE }
    }

    /// Unit direction to the light, its distance, and the falloff there.
    #[inline]
    pub(super) fn seen_from(&self, p: Vec3) -> (Vec3, f32, f32) {
        let to_light = self.position - p;
        let d = to_light.length();
        let [c0, c1, c2] = self.attenuation;
        (to_light / d, d, 1.0 / (c0 + d * (c1 + d * c2)))
    }

    /// Whether a point that light comes from is the light's.
    pub(super) fn is_at(&self, at: &LightPoint) -> bool {
        matches!(at, LightPoint::Position(p) if *p == self.position)
    }

    /// Light that leaves into a direction, drawn with this density per solid angle.
    pub(super) fn leaving(&self, d: Vec3, pdf: f32, wavelengths: &Wavelengths) -> LightLeSample {
        LightLeSample {
            at: LightPoint::Position(self.position),
            d,
            radiance: self.emission.at(wavelengths),
            attenuation: self.attenuation,
            pdf: EmissionPdf { position: 1.0, direction: pdf },
            is_delta: true,
        }
    }

    /// Extent and power, for light into all directions.
    pub(super) fn point_bounds(&self) -> LightBounds {
        let power = 4.0 * std::f32::consts::PI * self.emission.luminance();
        LightBounds {
            bounds: Aabb { min: self.position, max: self.position },
            axis: Vec3::Z,
            cos_spread: -1.0,
            cos_reach: 0.0,
            two_sided: false,
            power,
            is_inverse_square: self.attenuation == INVERSE_SQUARE,
        }
    }
}

impl Emitter for PointLight {
    #[inline]
    fn illuminate(&self, p: Vec3, _time: f32) -> Illumination {
        let (wi, distance, falloff) = self.seen_from(p);
        Illumination { wi, distance, intensity: self.intensity * falloff }
    }

    fn is_finite(&self) -> bool {
        let has_numbers = self.position.is_finite() && self.attenuation.iter().all(|v| v.is_finite());
        has_numbers && self.intensity.is_finite() && self.emission.is_finite()
    }

    #[inline]
    fn sample_li<S: EmissiveSurfaces>(
        &self,
        to: &Receiver,
        _u: Vec2,
        wavelengths: &Wavelengths,
        _surfaces: &S,
    ) -> Option<LightLiSample> {
        let (wi, _, falloff) = self.seen_from(to.p);
        let radiance = self.emission.at(wavelengths) * falloff;
        let at = LightPoint::Position(self.position);
        Some(LightLiSample { wi, radiance, pdf: 1.0, is_delta: true, at })
    }

    fn pdf_li(&self, _to: &Receiver, at: &LightPoint, _wi: Vec3) -> f32 {
        f32::from(u8::from(self.is_at(at)))
    }

    fn is_pointlike(&self) -> bool {
        true
    }

    fn is_unfading(&self) -> bool {
        self.attenuation[2] == 0.0
    }

    /// Falloffs other than the inverse square are weighed as if they were that.
    fn bounds(&self) -> Option<LightBounds> {
        Some(self.point_bounds())
    }

    fn apex(&self) -> Option<Vec3> {
        Some(self.position)
    }

    fn sample_le<S: EmissiveSurfaces>(
        &self,
        _time: f32,
        u: LeNumbers,
        wavelengths: &Wavelengths,
        _world: &BoundingSphere,
        _surfaces: &S,
    ) -> Option<LightLeSample> {
        Some(self.leaving(warp::uniform_sphere(u.direction), 0.25 * FRAC_1_PI, wavelengths))
    }

    fn pdf_le(&self, _time: f32, at: &LightPoint, _d: Vec3, _world: &BoundingSphere) -> EmissionPdf {
        EmissionPdf::at_point(self.is_at(at), 0.25 * FRAC_1_PI)
    }

    fn power(&self, _world: &BoundingSphere) -> f32 {
        self.point_bounds().power
    }

    fn emission(&self) -> Option<&Emission> {
        Some(&self.emission)
    }
}
