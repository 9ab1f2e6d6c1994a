//! The background as a light.
//!
//! Directions are drawn in proportion to a picture's brightness, and uniformly where the background is one colour.
//! With a share `s` they are drawn uniformly over the sun's disc, if there is one; the density is that of the mixture,
//!
//! ```text
//! p = s p_sun + (1 - s) p_sky
//! ```
//!
//! Where scattering finds the light too, directions are drawn in proportion to what is above the mean of all directions only [Karlík et al. 2019]: the
//! rest is found well by scattering. So of one colour none are drawn.
//!
//! Stars have a density of their own, which is mixed with that of what is behind them in proportion to the power of both.

use std::f32::consts::PI;
use std::sync::{Arc, OnceLock};

use kajo_color::{Emission, Spectrum, Wavelengths};
use kajo_math::{Vec2, Vec3, warp};

use super::sample::INVERSE_SQUARE;
use super::{
    BoundingSphere, EmissionPdf, EmissiveSurfaces, Emitter, Illumination, LeNumbers, LightBounds,
    LightLeSample, LightLiSample, LightPoint, Receiver,
};
use crate::background::Background;
use crate::daylight::Sun;
use crate::differential::SkyFootprint;
use crate::environment::{DensityWeight, SphereDensity};
use crate::star_field::StarField;

/// Light from everywhere around the scene.
#[derive(Clone, Debug)]
pub struct SkyLight {
    background: Arc<Background>,
    /// By all light; made when it is first asked for.
    density: OnceLock<SkyDensity>,
    /// By what is above the mean; made when it is first asked for.
    above_mean: OnceLock<SkyDensity>,
    /// The share of directions that go to the sun.
    sun_share: f32,
}

/// How directions are drawn, the sun's disc left out.
#[derive(Clone, Debug)]
enum SkyDensity {
    Uniform,
    Picture(SphereDensity),
    /// Stars with a share of the directions, and what is behind them with the rest.
    Starry {
        share: f32,
        stars: Arc<StarField>,
        behind: Box<SkyDensity>,
    },
}

impl SkyDensity {
    fn of(background: &Background, weight: DensityWeight) -> SkyDensity {
        /// Neither stars nor what is behind them may be forgotten.
        const LEAST: f32 = 0.02;
        match background {
            Background::Starry { behind, stars } if !stars.is_black() => {
                let [own, other] = [stars.mean_luminance(), behind.mean_luminance()];
                let share =
                    if behind.is_black() { 1.0 } else { (own / (own + other)).clamp(LEAST, 1.0 - LEAST) };
                let behind = Box::new(SkyDensity::of(behind, weight));
                SkyDensity::Starry { share, stars: Arc::clone(stars), behind }
            }
            _ => background.density(weight).map_or(SkyDensity::Uniform, SkyDensity::Picture),
        }
    }

    /// Per solid angle.
    #[inline]
    fn pdf(&self, wi: Vec3) -> f32 {
        match self {
            SkyDensity::Uniform => 1.0 / (4.0 * PI),
            SkyDensity::Picture(density) => density.pdf(wi),
            SkyDensity::Starry { share, stars, behind } => {
                share * stars.pdf(wi) + (1.0 - share) * behind.pdf(wi)
            }
        }
    }

    /// A unit direction and its density.
    #[inline]
    fn sample(&self, u: Vec2) -> Option<(Vec3, f32)> {
        match self {
            SkyDensity::Uniform => Some((warp::uniform_sphere(u), 1.0 / (4.0 * PI))),
            SkyDensity::Picture(density) => density.sample(u),
            SkyDensity::Starry { share, stars, behind } => {
                let wi = match u.x < *share {
                    true => stars.sample(Vec2::new(u.x / share, u.y))?,
                    false => behind.sample(Vec2::new((u.x - share) / (1.0 - share), u.y))?.0,
                };
                Some((wi, self.pdf(wi))).filter(|&(_, pdf)| pdf > 0.0)
            }
        }
    }
}

impl SkyLight {
    /// The light of a background.
    pub fn new(background: Arc<Background>) -> SkyLight {
        let sun_share = background.sun().map_or(0.0, |(_, share)| share);
        SkyLight { density: OnceLock::new(), above_mean: OnceLock::new(), sun_share, background }
    }

    /// Whether its light is the same from everywhere.
    #[inline]
    fn is_even(&self) -> bool {
        matches!(*self.background, Background::Constant { .. })
    }

    #[inline]
    fn density(&self) -> &SkyDensity {
        self.density.get_or_init(|| SkyDensity::of(&self.background, DensityWeight::All))
    }

    #[inline]
    fn above_mean(&self) -> &SkyDensity {
        self.above_mean.get_or_init(|| SkyDensity::of(&self.background, DensityWeight::AboveMean))
    }

    /// Density per solid angle with which the unit direction `wi` is drawn.
    ///
    /// * `density`: of the directions that do not go to the sun
    #[inline]
    fn pdf(&self, density: &SkyDensity, wi: Vec3) -> f32 {
        let sky = density.pdf(wi);
        match self.background.sun() {
            Some((sun, _)) if sun.disc().covers(wi) => {
                (1.0 - self.sun_share) * sky + self.sun_share / Sun::SOLID_ANGLE
            }
            _ => (1.0 - self.sun_share) * sky,
        }
    }

    /// A unit direction and its density per solid angle.
    #[inline]
    fn draw(&self, density: &SkyDensity, u: Vec2) -> Option<(Vec3, f32)> {
        if let Some((sun, share)) = self.background.sun()
            && u.x < share
        {
            let wi = sun.disc().draw(Vec2::new(u.x / share, u.y));
            return Some((wi, self.pdf(density, wi)));
        }
        let u = Vec2::new((u.x - self.sun_share) / (1.0 - self.sun_share), u.y);
        let (wi, pdf) = density.sample(u)?;
        Some((wi, if self.sun_share > 0.0 { self.pdf(density, wi) } else { pdf }))
    }

    /// Light for a receiver from a direction drawn by one of the two densities.
    #[inline]
    fn li_by(
        &self,
        density: &SkyDensity,
        to: &Receiver,
        u: Vec2,
        wavelengths: &Wavelengths,
    ) -> Option<LightLiSample> {
        let (wi, pdf) = self.draw(density, u)?;
        let radiance = self.background.radiance(wi, wavelengths);
        let at = LightPoint::Infinite { through: to.p };
        Some(LightLiSample { wi, radiance, pdf, is_delta: false, at })
    }
}

impl Emitter for SkyLight {
    /// Nothing: the classic integrator has ambient light for this.
    fn illuminate(&self, _p: Vec3, _time: f32) -> Illumination {
        Illumination { wi: Vec3::Y, distance: f32::INFINITY, intensity: Spectrum::BLACK }
    }

    fn is_finite(&self) -> bool {
        self.background.is_finite()
    }

    #[inline]
    fn sample_li<S: EmissiveSurfaces>(
        &self,
        to: &Receiver,
        u: Vec2,
        wavelengths: &Wavelengths,
        _surfaces: &S,
    ) -> Option<LightLiSample> {
        self.li_by(self.density(), to, u, wavelengths)
    }

    #[inline]
    fn pdf_li(&self, _to: &Receiver, at: &LightPoint, wi: Vec3) -> f32 {
        if at.is_infinite() { self.pdf(self.density(), wi) } else { 0.0 }
    }

    #[inline]
    fn sample_li_beside_scattering<S: EmissiveSurfaces>(
        &self,
        to: &Receiver,
        u: Vec2,
        wavelengths: &Wavelengths,
        _surfaces: &S,
    ) -> Option<LightLiSample> {
        (!self.is_even()).then(|| self.li_by(self.above_mean(), to, u, wavelengths)).flatten()
    }

    #[inline]
    fn pdf_li_beside_scattering(&self, _to: &Receiver, at: &LightPoint, wi: Vec3) -> f32 {
        if at.is_infinite() && !self.is_even() { self.pdf(self.above_mean(), wi) } else { 0.0 }
    }

    fn is_pointlike(&self) -> bool {
        false
    }

    fn is_background(&self) -> bool {
        true
    }

    fn bounds(&self) -> Option<LightBounds> {
        None
    }

    fn irradiance(&self) -> f32 {
        PI * self.background.mean_luminance()
    }

    fn unevenness(&self) -> f32 {
        let mean = self.background.mean_luminance();
        if mean > 0.0 { (self.background.luminance_above_mean() / mean).clamp(0.0, 1.0) } else { 0.0 }
    }

    fn sample_le<S: EmissiveSurfaces>(
        &self,
        _time: f32,
        u: LeNumbers,
        wavelengths: &Wavelengths,
        world: &BoundingSphere,
        _surfaces: &S,
    ) -> Option<LightLeSample> {
        let (wi, pdf) = self.draw(self.density(), u.direction)?;
        Some(LightLeSample {
            at: LightPoint::Infinite { through: world.sample_disk(u.position, -wi) },
            d: -wi,
            radiance: self.background.radiance(wi, wavelengths),
            attenuation: INVERSE_SQUARE,
            pdf: EmissionPdf { position: 1.0 / world.cross_section(), direction: pdf },
            is_delta: false,
        })
    }

    fn pdf_le(&self, _time: f32, at: &LightPoint, d: Vec3, world: &BoundingSphere) -> EmissionPdf {
        let direction = if at.is_infinite() { self.pdf(self.density(), -d) } else { 0.0 };
        EmissionPdf { position: world.pdf_disk(at.p(), d), direction }
    }

    fn is_seen_at_infinity(&self) -> bool {
        true
    }

    #[inline]
    fn radiance_at_infinity(
        &self,
        d: Vec3,
        footprint: &SkyFootprint,
        wavelengths: &Wavelengths,
    ) -> Option<Spectrum> {
        Some(self.background.radiance_within(d, footprint, wavelengths))
            .filter(|radiance| !radiance.is_black())
    }

    /// Estimated by an even grid of its own samples; of stars, which these may miss, it is known.
    fn power(&self, world: &BoundingSphere) -> f32 {
        const SIDE: u32 = 24;
        if let Background::Starry { .. } = *self.background {
            return world.cross_section() * 4.0 * PI * self.background.mean_luminance();
        }
        let sample = |i: u32| {
            let u = Vec2::new((i % SIDE) as f32 + 0.5, (i / SIDE) as f32 + 0.5) / SIDE as f32;
            let sample = self.draw(self.density(), u);
            sample.map_or(0.0, |(wi, pdf)| self.background.radiance(wi, &Wavelengths::RGB).luminance() / pdf)
        };
        world.cross_section() * (0..SIDE * SIDE).map(sample).sum::<f32>() / (SIDE * SIDE) as f32
    }

    fn emission(&self) -> Option<&Emission> {
        match &*self.background {
            Background::Constant { emission, .. } => Some(emission),
            Background::CubeMap(_)
            | Background::Environment(_)
            | Background::Sky(_)
            | Background::Starry { .. } => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::star_field::Star;

    /// Drawn directions find all light of stars and of what is behind them, and their density is one everywhere.
    #[test]
    fn stars_and_what_is_behind_them_are_drawn_by_their_power() {
        let star = |direction: Vec3, magnitude: f32| Star { direction, magnitude, temperature: 6500.0 };
        let stars = || {
            let all = [star(Vec3::X, -1.0), star(Vec3::new(0.0, 0.6, -0.8), 0.0), star(Vec3::NEG_Y, 1.0)];
            Arc::new(StarField::new(&all, 0.02, 1e5))
        };
        let of_stars = 2.54e-1 * (10f64.powf(0.4) + 1.0 + 10f64.powf(-0.4));
        for grey in [0.0, 0.02, 1.0] {
            let behind = Box::new(Background::constant([grey; 3]));
            let sky = SkyLight::new(Arc::new(Background::Starry { behind, stars: stars() }));
            let expected = of_stars + 4.0 * f64::from(PI) * f64::from(grey);
            const SIDE: u32 = 512;
            let (mut sum, mut densities) = (0.0, 0.0);
            for i in 0..SIDE * SIDE {
                let u = Vec2::new((i % SIDE) as f32 + 0.5, (i / SIDE) as f32 + 0.5) / SIDE as f32;
                let Some((wi, pdf)) = sky.draw(sky.density(), u) else { continue };
                assert_eq!(sky.pdf(sky.density(), wi), pdf, "{wi}");
                let luminance = sky.background.radiance(wi, &Wavelengths::RGB).luminance();
                sum += f64::from(luminance / pdf);
                densities += f64::from(4.0 * PI * sky.pdf(sky.density(), warp::uniform_sphere(u)));
            }
            let n = f64::from(SIDE * SIDE);
            assert!((sum / n / expected - 1.0).abs() < 0.02, "{grey}: {} for {expected}", sum / n);
            assert!((densities / n - 1.0).abs() < 0.05, "{grey}: {}", densities / n);
        }
    }
}
