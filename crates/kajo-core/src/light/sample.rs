//! What integrators and lights exchange: receivers, samples of lights, and their densities.
//!
//! Light that arrives at a receiver is drawn by [`Emitter::sample_li`](super::Emitter::sample_li), light that leaves a light by
//! [`Emitter::sample_le`](super::Emitter::sample_le). A light is chosen first, with the probability `c`, then a position on it
//! and a direction. A ray that leaves carries its power over the density of all that,
//!
//! ```text
//! W = L cos / (c p_position p_direction)
//!
//! surface             position by area                     direction by the cosine
//! point, spot         one position, of density 1           uniform over the directions of its light
//! infinitely far      a disk across the direction, as      direction as drawn for a receiver; 1 for a delta light
//!                     wide as the scene
//! ```
//!
//! [Veach 1997, 8.2], [Pharr, Jakob and Humphreys 2023, 12]. For a point light the radiance is its intensity and there is
//! no cosine; for lights infinitely far away the cosine with the disk is 1.

use kajo_color::Spectrum;
use kajo_math::{Ray, Vec2, Vec3, robust::offset_origin};

use crate::ids::{LightGroup, LightIndex};
use crate::interaction::SurfacePoint;

/// The point that light is sampled for.
#[derive(Clone, Copy, Debug, Default)]
pub struct Receiver {
    /// The point.
    pub p: Vec3,
    /// Its unit normal, or zero where there is none.
    pub n: Vec3,
    /// Moment within the shutter interval, 0 to 1.
    pub time: f32,
}

/// The far end of a connection: the point that light comes from.
#[derive(Clone, Copy, Debug)]
pub enum LightPoint {
    /// A point of a surface.
    Surface {
        /// The point.
        p: Vec3,
        /// Bound on the error of its coordinates.
        p_error: Vec3,
        /// Unit geometric normal.
        n: Vec3,
    },
    /// A point in space.
    Position(Vec3),
    /// Infinitely far away: only the direction belongs to the light.
    Infinite {
        /// Any point that the light passes.
        through: Vec3,
    },
}

impl LightPoint {
    /// The point of a surface.
    #[inline]
    pub fn on(surface: &SurfacePoint) -> LightPoint {
        LightPoint::Surface { p: surface.p, p_error: surface.p_error, n: surface.ng }
    }

    /// The point; of light from infinitely far away one that it passes.
    #[inline]
    pub fn p(&self) -> Vec3 {
        match *self {
            LightPoint::Surface { p, .. } | LightPoint::Position(p) | LightPoint::Infinite { through: p } => {
                p
            }
        }
    }

    /// The unit geometric normal, zero where there is no surface.
    #[inline]
    pub fn n(&self) -> Vec3 {
        match *self {
            LightPoint::Surface { n, .. } => n,
            LightPoint::Position(_) | LightPoint::Infinite { .. } => Vec3::ZERO,
        }
    }

    /// Whether it is infinitely far away.
    #[inline]
    pub fn is_infinite(&self) -> bool {
        matches!(self, LightPoint::Infinite { .. })
    }

    /// Absolute cosine between its surface and a unit direction; 1 where there is no surface, since power of a point or of parallel light is
    /// counted without one.
    #[inline]
    pub fn cosine(&self, w: Vec3) -> f32 {
        match self {
            LightPoint::Surface { n, .. } => n.dot(w).abs(),
            LightPoint::Position(_) | LightPoint::Infinite { .. } => 1.0,
        }
    }

    /// What a density per solid angle of a viewer is multiplied by to be in the measure in which the light's end of a path is counted: per area
    /// on a surface, `|cos| / distance^2`. The end infinitely far away is a direction, and stays per solid angle; a position is
    /// one point, whose probability stays what it is.
    ///
    /// * `w`: unit direction of sight
    /// * `distance2`: squared distance of the viewer
    #[inline]
    pub fn jacobian_to_end_measure(&self, w: Vec3, distance2: f32) -> f32 {
        match self {
            LightPoint::Surface { n, .. } => n.dot(w).abs() / distance2,
            LightPoint::Position(_) | LightPoint::Infinite { .. } => 1.0,
        }
    }
}

/// Light that arrives at a receiver from a direction drawn at random.
#[derive(Clone, Copy, Debug)]
pub struct LightLiSample {
    /// Unit direction towards the light.
    pub wi: Vec3,
    /// Radiance from there; of a delta light its irradiance across `wi`.
    pub radiance: Spectrum,
    /// Density of the direction per solid angle; the probability 1 for the single direction of a delta light.
    pub pdf: f32,
    /// Whether the light is a single point or direction (a delta distribution), which no ray finds.
    pub is_delta: bool,
    /// Where the light comes from, which is how far the way must be clear.
    pub at: LightPoint,
}

/// Uniform numbers in [0, 1)² for a ray that leaves a light.
#[derive(Clone, Copy, Debug)]
pub struct LeNumbers {
    /// For the position on the light.
    pub position: Vec2,
    /// For the direction.
    pub direction: Vec2,
}

/// A ray of light that leaves a light, drawn at random.
#[derive(Clone, Copy, Debug)]
pub struct LightLeSample {
    /// Where it starts: on the light, or before the scene.
    pub at: LightPoint,
    /// Unit direction in which the light travels.
    pub d: Vec3,
    /// Radiance; the intensity of a point, the irradiance of a delta light infinitely far away.
    pub radiance: Spectrum,
    /// Coefficients `[c0, c1, c2]` of a falloff with distance `1 / (c0 + c1 d + c2 d^2)`.
    pub attenuation: [f32; 3],
    /// Densities of position and direction.
    pub pdf: EmissionPdf,
    /// Whether the light is a single point or direction, which no ray finds.
    pub is_delta: bool,
}

/// Densities of light that leaves a light.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EmissionPdf {
    /// Of the position, per area; 1 for a point.
    pub position: f32,
    /// Of the direction, per solid angle; 1 for a delta light infinitely far away.
    pub direction: f32,
}

impl EmissionPdf {
    /// Of a light that is a point.
    ///
    /// * `is_at`: whether the point that light leaves is the light's; else there is none
    /// * `direction`: density per solid angle
    pub(super) fn at_point(is_at: bool, direction: f32) -> EmissionPdf {
        if is_at { EmissionPdf { position: 1.0, direction } } else { EmissionPdf::default() }
    }
}

/// The falloff of radiant power that spreads in space.
pub(super) const INVERSE_SQUARE: [f32; 3] = [0.0, 0.0, 1.0];

impl LightLeSample {
    /// Cosine at the light, where it has a surface.
    pub fn cosine(&self) -> f32 {
        self.at.cosine(self.d)
    }

    /// What the ray carries.
    pub fn power(&self) -> Spectrum {
        self.radiance * (self.cosine() / (self.pdf.position * self.pdf.direction))
    }

    /// Power at a distance over power at the start, for lights whose falloff is not the inverse square. Radiance is multiplied by this
    /// at the first vertex.
    pub fn share_at(&self, distance: f32) -> f32 {
        if self.attenuation == INVERSE_SQUARE {
            return 1.0;
        }
        let [c0, c1, c2] = self.attenuation;
        distance * distance / (c0 + distance * (c1 + distance * c2))
    }

    /// The ray, clear of the light's own surface.
    pub fn ray(&self, time: f32) -> Ray {
        let o = match self.at {
            LightPoint::Surface { p, p_error, n } => offset_origin(p, p_error, n, self.d),
            LightPoint::Position(p) | LightPoint::Infinite { through: p } => p,
        };
        Ray { o, t_min: 0.0, d: self.d, t_max: f32::INFINITY, time }
    }
}

/// A light that was chosen at random.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampledLight {
    /// The light.
    pub light: LightIndex,
    /// Probability of the choice.
    pub probability: f32,
    /// What the choice left of its number: how far into the part of [0, 1) that chooses this light it was, in [0, 1).
    pub rest: f32,
}

impl SampledLight {
    /// * `rest`: may be out of range by rounding
    #[inline]
    pub(super) fn new(light: LightIndex, probability: f32, rest: f32) -> SampledLight {
        SampledLight { light, probability, rest: rest.clamp(0.0, 1.0f32.next_down()) }
    }

    /// A pair of uniform numbers for the light, of the pair `u` whose `x` chose it.
    ///
    /// The pairs of all samples that choose this light are then as evenly spread as all pairs are: a part of a stratified
    /// square is stratified too. Of what few numbers choose few digits are left; more are taken from the last ones of `y`.
    #[inline]
    pub fn pair(&self, u: Vec2) -> Vec2 {
        /// Digits of a uniform number, and those that are left to do without others.
        const STEP: f32 = 1.0 / (1 << 24) as f32;
        const ENOUGH: f32 = 1.0 / (1 << 12) as f32;
        if self.probability >= ENOUGH {
            return Vec2::new(self.rest, u.y);
        }
        let last = (u.y * (1 << 12) as f32).fract();
        Vec2::new((self.rest + last * STEP / self.probability).min(1.0f32.next_down()), u.y)
    }
}

/// Emission that a ray hits.
#[derive(Clone, Copy, Debug)]
pub struct LightHit {
    /// The light that it belongs to.
    pub light: LightIndex,
    /// The light's group.
    pub group: LightGroup,
    /// Radiance against the ray.
    pub radiance: Spectrum,
}
