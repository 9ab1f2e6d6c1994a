//! The background as a light.
//!
//! Directions are drawn uniformly over the sphere.

use std::f32::consts::PI;
use std::sync::Arc;

use kajo_color::Wavelengths;
use kajo_math::{Vec2, Vec3, warp};

use super::{Emitter, Illumination, LightBounds, LightSample, Target};
use crate::background::Background;

/// Light from everywhere around the scene.
#[derive(Clone, Debug)]
pub struct SkyLight {
    /// What it looks like.
    pub background: Arc<Background>,
}

impl SkyLight {
    /// Density per solid angle with which [`Emitter::sample`] draws a direction.
    #[inline]
    pub fn pdf(&self, _wi: Vec3) -> f32 {
        1.0 / (4.0 * PI)
    }
}

impl Emitter for SkyLight {
    /// Nothing: the classic integrator has ambient light for this.
    fn illuminate(&self, _p: Vec3) -> Illumination {
        Illumination { wi: Vec3::Y, distance: f32::INFINITY, intensity: kajo_color::Spectrum::BLACK }
    }

    #[inline]
    fn sample(&self, _p: Vec3, u: Vec2, wavelengths: &Wavelengths) -> Option<LightSample> {
        let wi = warp::uniform_sphere(u);
        let radiance = self.background.radiance(wi, wavelengths);
        Some(LightSample { wi, radiance, pdf: self.pdf(wi), is_delta: false, target: Target::Infinity })
    }

    fn bounds(&self) -> Option<LightBounds> {
        None
    }
}
