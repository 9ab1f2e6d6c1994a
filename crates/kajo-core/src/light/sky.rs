//! The background as a light.
//!
//! Directions are drawn in proportion to a picture's brightness, and uniformly where the background is one colour.
//! With a share `s` they are drawn uniformly over the sun's disc, if there is one; the density is that of the mixture,
//!
//! ```text
//! p = s p_sun + (1 - s) p_sky
//! ```

use std::f32::consts::PI;
use std::sync::{Arc, OnceLock};

use kajo_color::{Emission, Wavelengths};
use kajo_math::{Vec2, Vec3, warp};

use super::emit::{INVERSE_SQUARE, power_by_samples};
use super::{Ball, EmissionPdf, Emitted, Emitter, Illumination, LightBounds, LightSample, Target};
use crate::background::Background;
use crate::daylight::Sun;
use crate::environment::SphereDensity;

/// Light from everywhere around the scene.
#[derive(Clone, Debug)]
pub struct SkyLight {
    background: Arc<Background>,
    /// Made when it is first asked for; `None` for the uniform density.
    density: OnceLock<Option<SphereDensity>>,
    /// The share of directions that go to the sun.
    sun_share: f32,
}

impl SkyLight {
    /// The light of a background.
    pub fn new(background: Arc<Background>) -> SkyLight {
        let sun_share = background.sun().map_or(0.0, |(_, share)| share);
        SkyLight { density: OnceLock::new(), sun_share, background }
    }

    #[inline]
    fn density(&self) -> Option<&SphereDensity> {
        self.density.get_or_init(|| self.background.density()).as_ref()
    }

    /// Density per solid angle with which [`Emitter::sample`] draws the unit direction `wi`.
    #[inline]
    pub fn pdf(&self, wi: Vec3) -> f32 {
        let sky = self.density().map_or(1.0 / (4.0 * PI), |density| density.pdf(wi));
        match self.background.sun() {
            Some((sun, _)) if sun.disc().covers(wi) => {
                (1.0 - self.sun_share) * sky + self.sun_share / Sun::SOLID_ANGLE
            }
            _ => (1.0 - self.sun_share) * sky,
        }
    }

    /// A unit direction and its density per solid angle.
    #[inline]
    fn draw(&self, u: Vec2) -> Option<(Vec3, f32)> {
        if let Some((sun, share)) = self.background.sun()
            && u.x < share
        {
            let wi = sun.disc().draw(Vec2::new(u.x / share, u.y));
            return Some((wi, self.pdf(wi)));
        }
        let u = Vec2::new((u.x - self.sun_share) / (1.0 - self.sun_share), u.y);
        let (wi, pdf) = match self.density() {
            Some(density) => density.sample(u)?,
            None => (warp::uniform_sphere(u), 1.0 / (4.0 * PI)),
        };
        Some((wi, if self.sun_share > 0.0 { self.pdf(wi) } else { pdf }))
    }
}

impl Emitter for SkyLight {
    /// Nothing: the classic integrator has ambient light for this.
    fn illuminate(&self, _p: Vec3, _time: f32) -> Illumination {
        Illumination { wi: Vec3::Y, distance: f32::INFINITY, intensity: kajo_color::Spectrum::BLACK }
    }

    #[inline]
    fn sample(&self, _p: Vec3, _time: f32, u: Vec2, wavelengths: &Wavelengths) -> Option<LightSample> {
        let (wi, pdf) = self.draw(u)?;
        let radiance = self.background.radiance(wi, wavelengths);
        Some(LightSample { wi, radiance, pdf, is_delta: false, target: Target::Infinity, light: 0 })
    }

    fn bounds(&self) -> Option<LightBounds> {
        None
    }

    fn emit(&self, _time: f32, u: [Vec2; 2], wavelengths: &Wavelengths, world: &Ball) -> Option<Emitted> {
        let LightSample { wi, radiance, pdf, .. } = self.sample(world.center, 0.0, u[1], wavelengths)?;
        Some(Emitted {
            p: world.disk(u[0], -wi),
            origin: Target::Infinity,
            d: -wi,
            radiance,
            attenuation: INVERSE_SQUARE,
            pdf: EmissionPdf { place: 1.0 / world.cross_section(), direction: pdf },
            is_delta: false,
        })
    }

    fn emission_pdf(&self, _time: f32, [p, _]: [Vec3; 2], d: Vec3, world: &Ball) -> EmissionPdf {
        EmissionPdf { place: world.pdf(p, d), direction: self.pdf(-d) }
    }

    fn power(&self, world: &Ball) -> f32 {
        power_by_samples(self, world)
    }

    fn emission(&self) -> Option<&Emission> {
        match &*self.background {
            Background::Constant { emission, .. } => Some(emission),
            Background::CubeMap(_) | Background::Environment(_) | Background::Sky(_) => None,
        }
    }
}
