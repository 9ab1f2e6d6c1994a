//! Surfaces that give light: every place of a piece sends the same radiance into all directions of its side.
//!
//! Such a light exists for each piece of every object whose material has an `emission`; it is not written on its
//! own. The power of one side is `pi A L`.

use std::f32::consts::PI;

use kajo_color::{Emission, Spectrum, Wavelengths};
use kajo_math::{Vec2, Vec3};

use super::{Emitter, Illumination, LightBounds, LightSample, Target};
use crate::shape::Patch;

/// Which sides of a surface give light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sides {
    /// Both.
    #[default]
    Both,
    /// The outer one, where normals point.
    Front,
    /// The inner one.
    Back,
}

impl Sides {
    /// Whether light leaves the surface into a direction whose cosine with the outward normal is `cos`.
    #[inline]
    pub fn emit(self, cos: f32) -> bool {
        match self {
            Sides::Both => cos != 0.0,
            Sides::Front => cos > 0.0,
            Sides::Back => cos < 0.0,
        }
    }
}

/// A piece of surface that gives light.
#[derive(Clone, Debug)]
pub struct AreaLight {
    /// Its geometry in world space.
    pub patch: Patch,
    /// Radiance.
    pub emission: Emission,
    /// Which sides give light.
    pub sides: Sides,
    /// The object it belongs to, an index into [`crate::Scene::primitives`].
    pub primitive: u32,
    /// The part of that object.
    pub part: u32,
}

impl AreaLight {
    /// Density per solid angle with which [`Emitter::sample`] draws the place `p` for the receiver `from`.
    ///
    /// * `n`: unit geometric normal at `p`
    #[inline]
    pub fn pdf(&self, from: Vec3, p: Vec3, n: Vec3) -> f32 {
        self.patch.pdf(from, p, n)
    }
}

impl Emitter for AreaLight {
    /// As if all light came from the middle of the piece.
    fn illuminate(&self, p: Vec3) -> Illumination {
        let bounds = self.patch.bounds();
        let to_light = bounds.center() - p;
        let distance = to_light.length();
        let wi = to_light / distance;
        let (area, cos) = match self.patch.normal() {
            Some(n) => {
                let cos = -wi.dot(n.as_vec3());
                (self.patch.area() as f32, if self.sides.emit(cos) { cos.abs() } else { 0.0 })
            }
            // A convex body shows a quarter of its surface on average.
            None => (0.25 * self.patch.area() as f32, if self.sides == Sides::Back { 0.0 } else { 1.0 }),
        };
        let irradiance =
            Spectrum::from(Vec3::from(self.emission.rgb())) * (area * cos / (distance * distance));
        // Not quite as far as the surface, which would hide itself.
        let reach = 1.0 - 0.5 * bounds.extent().max_element() / distance.max(f32::MIN_POSITIVE);
        Illumination { wi, distance: distance * reach.clamp(0.0, 0.999), intensity: irradiance * (1.0 / PI) }
    }

    #[inline]
    fn sample(&self, p: Vec3, u: Vec2, wavelengths: &Wavelengths) -> Option<LightSample> {
        let drawn = self.patch.sample(p, u)?;
        let wi = (drawn.p - p).normalize_or_zero();
        if !self.sides.emit(-wi.dot(drawn.n)) {
            return None;
        }
        let target = Target::Surface { p: drawn.p, p_error: drawn.p_error, n: drawn.n };
        let radiance = self.emission.at(wavelengths);
        Some(LightSample { wi, radiance, pdf: drawn.pdf, is_delta: false, target })
    }

    fn bounds(&self) -> Option<LightBounds> {
        let sides = if self.sides == Sides::Both { 2.0 } else { 1.0 };
        let power = sides * PI * self.patch.area() as f32 * self.emission.luminance();
        let (axis, cos_spread) = match self.patch.normal() {
            Some(n) => (if self.sides == Sides::Back { -n.as_vec3() } else { n.as_vec3() }, 1.0),
            None => (Vec3::Z, -1.0),
        };
        let two_sided = self.sides == Sides::Both;
        Some(LightBounds { bounds: self.patch.bounds(), axis, cos_spread, cos_reach: 0.0, two_sided, power })
    }
}
