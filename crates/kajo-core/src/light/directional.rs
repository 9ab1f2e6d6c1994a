//! Light from infinitely far away: parallel and without falloff.
//!
//! Given by its classic `color`, the factor of the shading formula, it has the irradiance `pi color` across its
//! direction; given by its `irradiance`, just that.
//!
//! With an `angle` it is a disc of this diameter in the sky, as the sun is of 0.53 degrees: shadows have soft
//! edges. Rays that meet the disc see it with the radiance `E / (pi sin^2 r)` of its irradiance `E`.
//!
//! Scene: `DirectionalLight { direction -1 -1 -1  color 0.9 0.9 0.9 }`; the light travels along `direction`.

use kajo_color::{Emission, Spectrum, Wavelengths};
use kajo_math::{Vec2, Vec3};

use super::sample::INVERSE_SQUARE;
use super::{
    BoundingSphere, EmissionPdf, EmissiveSurfaces, Emitter, Illumination, LeNumbers, LightBounds,
    LightLeSample, LightLiSample, LightOutline, LightPoint, Receiver, classic_factor,
};
use crate::differential::SkyFootprint;
use crate::sky_disc::SkyDisc;

/// Discs less high are taken for points: directions in single precision do not tell their parts apart.
const LOWEST: f32 = 1e-12;

/// A directional light.
#[derive(Clone, Debug)]
pub struct DirectionalLight {
    /// Unit direction from the scene towards the light.
    pub to_light: Vec3,
    /// `1 - cos r` of the angle `r` from the middle of the light's disc to its edge: 0 for a light without extent.
    pub height: f32,
    /// Factor of the classic shading formula.
    pub intensity: Spectrum,
    /// Irradiance on a surface across the direction.
    pub emission: Emission,
}

impl DirectionalLight {
    /// Light from a point of the sky.
    ///
    /// * `direction`: in which the light goes, of any length
    /// * `irradiance`: of a surface that faces it, in W/m²
    pub fn new(direction: Vec3, irradiance: Emission) -> DirectionalLight {
        let to_light = -direction.normalize_or_zero();
        DirectionalLight {
            to_light,
            height: 0.0,
            intensity: classic_factor(&irradiance),
            emission: irradiance,
        }
    }

    /// What rays may hit of it.
    #[inline]
    pub fn disc(&self) -> Option<SkyDisc> {
        (self.height > LOWEST).then_some(SkyDisc { middle: self.to_light, height: self.height })
    }

    /// Radiance of its disc.
    fn radiance(&self, disc: &SkyDisc, wavelengths: &Wavelengths) -> Spectrum {
        self.emission.at(wavelengths) * disc.projected_solid_angle().recip()
    }
}

impl Emitter for DirectionalLight {
    #[inline]
    fn illuminate(&self, _p: Vec3, _time: f32) -> Illumination {
        Illumination { wi: self.to_light, distance: f32::INFINITY, intensity: self.intensity }
    }

    fn is_finite(&self) -> bool {
        let has_numbers = self.to_light.is_finite() && self.height.is_finite();
        has_numbers && self.intensity.is_finite() && self.emission.is_finite()
    }

    #[inline]
    fn sample_li<S: EmissiveSurfaces>(
        &self,
        to: &Receiver,
        u: Vec2,
        wavelengths: &Wavelengths,
        _surfaces: &S,
    ) -> Option<LightLiSample> {
        let (wi, radiance, pdf) = match self.disc() {
            Some(disc) => (disc.draw(u), self.radiance(&disc, wavelengths), disc.solid_angle().recip()),
            None => (self.to_light, self.emission.at(wavelengths), 1.0),
        };
        let is_delta = self.disc().is_none();
        Some(LightLiSample { wi, radiance, pdf, is_delta, at: LightPoint::Infinite { through: to.p } })
    }

    fn pdf_li(&self, _to: &Receiver, at: &LightPoint, wi: Vec3) -> f32 {
        match self.disc() {
            _ if !at.is_infinite() => 0.0,
            Some(disc) => disc.pdf(wi),
            None => f32::from(u8::from(wi == self.to_light)),
        }
    }

    fn outline(&self) -> LightOutline {
        LightOutline::Direction(self.to_light)
    }

    fn is_pointlike(&self) -> bool {
        true
    }

    fn bounds(&self) -> Option<LightBounds> {
        None
    }

    fn irradiance(&self) -> f32 {
        0.25 * self.emission.luminance()
    }

    fn sample_le<S: EmissiveSurfaces>(
        &self,
        _time: f32,
        u: LeNumbers,
        wavelengths: &Wavelengths,
        world: &BoundingSphere,
        surfaces: &S,
    ) -> Option<LightLeSample> {
        let to = Receiver { p: world.center, ..Receiver::default() };
        let LightLiSample { wi, radiance, pdf, is_delta, .. } =
            self.sample_li(&to, u.direction, wavelengths, surfaces)?;
        Some(LightLeSample {
            at: LightPoint::Infinite { through: world.sample_disk(u.position, -wi) },
            d: -wi,
            radiance,
            attenuation: INVERSE_SQUARE,
            pdf: EmissionPdf { position: 1.0 / world.cross_section(), direction: pdf },
            is_delta,
        })
    }

    fn pdf_le(&self, _time: f32, at: &LightPoint, d: Vec3, world: &BoundingSphere) -> EmissionPdf {
        let position = world.pdf_disk(at.p(), d);
        EmissionPdf { position, direction: self.pdf_li(&Receiver::default(), at, -d) }
    }

    fn is_seen_at_infinity(&self) -> bool {
        self.disc().is_some()
    }

    #[inline]
    fn radiance_at_infinity(
        &self,
        d: Vec3,
        _footprint: &SkyFootprint,
        wavelengths: &Wavelengths,
    ) -> Option<Spectrum> {
        let disc = self.disc().filter(|disc| disc.covers(d))?;
        Some(self.radiance(&disc, wavelengths))
    }

    fn power(&self, world: &BoundingSphere) -> f32 {
        // Of a wide disc the irradiance across other directions is larger.
        let widened = 2.0 / (2.0 - self.height);
        widened * self.emission.luminance() * world.cross_section()
    }

    fn emission(&self) -> Option<&Emission> {
        Some(&self.emission)
    }
}
