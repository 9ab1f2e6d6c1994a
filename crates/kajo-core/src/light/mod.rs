//! Lights: what illuminates surfaces.
//!
//! Three questions are asked of a light. The classic integrator asks how much light arrives at a point
//! ([`Emitter::illuminate`]). Integrators that estimate integrals sample a direction towards the light with a
//! known density ([`Emitter::sample_li`], [`Emitter::pdf_li`]); which light they ask is chosen by [`LightSampler`]. Those that
//! follow light from its source sample a ray that leaves it ([`Emitter::sample_le`], [`Emitter::pdf_le`]); where they begin is
//! chosen by [`PowerLightSampler`].
//!
//! Each sample has its density beside it, answered by the same member for the same receiver, and `laws/lights.rs` holds every
//! member to that.

mod area;
mod bounding_sphere;
mod bounds;
mod choice;
mod cluster;
mod directional;
mod emission_density;
mod groups;
mod infinite;
mod outline;
mod photometric;
mod point;
mod power_sampler;
mod sample;
mod sampler;
mod segment;
mod sky;
mod spot;
mod tree;
mod visibility;

pub use crate::ids::MAX_LIGHT_GROUPS;
pub use area::{AreaLight, PatchExtent, Sides};
pub use bounding_sphere::BoundingSphere;
pub use bounds::LightBounds;
pub use choice::{LightChoice, LightSelection};
pub use directional::DirectionalLight;
pub use emission_density::{EmissionDensity, TableDetail};
pub(crate) use groups::OTHER;
pub use groups::{LightGroupError, LightGroups};
pub use outline::LightOutline;
pub use photometric::{PhotometricLight, Photometry};
pub use point::PointLight;
pub use power_sampler::PowerLightSampler;
pub use sample::{
    EmissionPdf, LeNumbers, LightHit, LightLeSample, LightLiSample, LightPoint, Receiver, SampledLight,
};
pub use sampler::LightSampler;
pub use segment::{AngularSpan, RaySegment};
pub use sky::SkyLight;
pub use spot::{SpotCone, SpotLight};
pub use tree::LightTree;
pub use visibility::{LightDraw, LightVisibility};

use kajo_color::{Emission, Spectrum, Wavelengths};
use kajo_math::{Vec2, Vec3};

use crate::differential::SkyFootprint;
use crate::family::family;
use crate::ids::{ObjectId, VariedEmissionId};

/// Light that arrives at a point when nothing is in the way.
#[derive(Clone, Copy, Debug)]
pub struct Illumination {
    /// Unit direction towards the light.
    pub wi: Vec3,
    /// Distance to the light along `wi`; infinite for directional lights.
    pub distance: f32,
    /// Arriving light, distance included, without the receiver's cosine.
    pub intensity: Spectrum,
}

/// Light that leaves a surface.
#[derive(Clone, Copy, Debug)]
pub struct LeavingLight {
    /// The point that it leaves, in world space.
    pub p: Vec3,
    /// Unit direction in which it goes.
    pub d: Vec3,
}

/// What lights ask about the surfaces that they are.
///
/// A light has its geometry; the textures of a surface's emission are the scene's, which evaluates them here.
pub trait EmissiveSurfaces {
    /// The radiance of a point whose surface does not emit the same everywhere.
    ///
    /// * `light`: the patch that the point lies on
    /// * `emission`: its [`AreaLight::varied`]
    /// * `leaving`: the point and where its light goes
    /// * `time`: moment within the shutter interval
    fn radiance(
        &self,
        light: &AreaLight,
        emission: VariedEmissionId,
        leaving: LeavingLight,
        time: f32,
        wavelengths: &Wavelengths,
    ) -> Spectrum;

    /// Whether the world-space point `p` of a light's patch is one of the surface, where there may be less of that.
    fn shows(&self, light: &AreaLight, p: Vec3, time: f32) -> bool;
}

/// What makes a white surface under a light that it faces just as bright in the classic formula: the irradiance over π.
pub(crate) fn classic_factor(quantity: &Emission) -> Spectrum {
    Spectrum::from(Vec3::from(quantity.rgb()) / std::f32::consts::PI)
}

/// What every light can do.
pub trait Emitter {
    /// Whether all its numbers are finite.
    fn is_finite(&self) -> bool;

    /// The light that arrives at the world-space point `p`, in the classic integrator's units.
    ///
    /// * `time`: moment within the shutter interval
    fn illuminate(&self, p: Vec3, time: f32) -> Illumination;

    /// Light that arrives at a receiver from a direction drawn with `u` in [0, 1)^2; `None` when none does.
    fn sample_li<S: EmissiveSurfaces>(
        &self,
        to: &Receiver,
        u: Vec2,
        wavelengths: &Wavelengths,
        surfaces: &S,
    ) -> Option<LightLiSample>;

    /// Density with which [`Emitter::sample_li`] draws the unit direction `wi` for a receiver: the `pdf` of that sample, 0
    /// where there is none.
    ///
    /// Per solid angle. A delta light is drawn by its single direction, with the probability 1 where it shines; no ray
    /// finds that direction, so only light that was drawn from the light itself is asked for.
    ///
    /// * `at`: the point of the light in that direction
    fn pdf_li(&self, to: &Receiver, at: &LightPoint, wi: Vec3) -> f32;

    /// As [`Emitter::sample_li`] for paths that find the light by scattering as well: where that does well enough, other directions are drawn
    /// more often, which is MIS compensation [Karlík et al. 2019].
    fn sample_li_beside_scattering<S: EmissiveSurfaces>(
        &self,
        to: &Receiver,
        u: Vec2,
        wavelengths: &Wavelengths,
        surfaces: &S,
    ) -> Option<LightLiSample> {
        self.sample_li(to, u, wavelengths, surfaces)
    }

    /// Density with which [`Emitter::sample_li_beside_scattering`] draws a direction; as [`Emitter::pdf_li`].
    fn pdf_li_beside_scattering(&self, to: &Receiver, at: &LightPoint, wi: Vec3) -> f32 {
        self.pdf_li(to, at, wi)
    }

    /// A ray of light that leaves; `None` when there is none.
    ///
    /// * `time`: moment within the shutter interval
    /// * `world`: what lights infinitely far away are aimed at
    fn sample_le<S: EmissiveSurfaces>(
        &self,
        time: f32,
        u: LeNumbers,
        wavelengths: &Wavelengths,
        world: &BoundingSphere,
        surfaces: &S,
    ) -> Option<LightLeSample>;

    /// Densities with which [`Emitter::sample_le`] draws light that leaves the point `at` along the unit vector `d`.
    fn pdf_le(&self, time: f32, at: &LightPoint, d: Vec3, world: &BoundingSphere) -> EmissionPdf;

    /// Where the light is and how strong, for the choice among many; `None` when it is infinitely far.
    fn bounds(&self) -> Option<LightBounds>;

    /// The irradiance that light from infinitely far away makes on a surface, the mean over all that its normal may be, as a luminance:
    /// a quarter of the integral of its radiance over all directions. 0 for a light that has a position.
    fn irradiance(&self) -> f32 {
        0.0
    }

    /// For light from everywhere around the scene the share of it that is above its mean over all directions: 0 where it is the same from all. 1 for
    /// other lights.
    fn unevenness(&self) -> f32 {
        1.0
    }

    /// The world-space point where all its light comes from, if there is one.
    fn apex(&self) -> Option<Vec3> {
        None
    }

    /// Whether it is a surface.
    fn is_surface(&self) -> bool {
        false
    }

    /// A point of its surface, drawn by area or emission and independently of any receiver, and its density per area. `None` for lights
    /// without a surface, and for surfaces without a closed form, see [`Patch::Traced`](crate::shape::Patch::Traced).
    ///
    /// Where what a receiver sees of the light is not what shines at it, as through glass, all of the light has to be drawn.
    ///
    /// * `u`: uniform in [0, 1)²
    /// * `time`: moment within the shutter interval
    fn sample_area(&self, _u: Vec2, _time: f32) -> Option<(LightPoint, f32)> {
        None
    }

    /// Density per area with which [`Emitter::sample_area`] draws the point `p`; 0 where it draws none.
    fn pdf_area(&self, _p: Vec3, _time: f32) -> f32 {
        0.0
    }

    /// What is drawn of it where its light is not.
    fn outline(&self) -> LightOutline {
        self.apex().map_or(LightOutline::None, LightOutline::Star)
    }

    /// Whether rays do not hit it, or hardly ever: a point, a direction, or a disc in the sky as small as the sun.
    fn is_pointlike(&self) -> bool;

    /// Whether it has a position and yet does not fall off with the square of the distance, as lights of the classic formula may.
    fn is_unfading(&self) -> bool {
        false
    }

    /// The object whose surface it is a patch of.
    fn object(&self) -> Option<ObjectId> {
        None
    }

    /// Whether it is what rays see that leave the scene into any direction.
    fn is_background(&self) -> bool {
        false
    }

    /// Whether rays that leave the scene can hit it: see [`Emitter::radiance_at_infinity`].
    fn is_seen_at_infinity(&self) -> bool {
        false
    }

    /// The radiance that a ray along the unit vector `d` finds when it leaves the scene; `None` where it misses the light.
    ///
    /// * `footprint`: of the pixel, where what is smaller is to be seen as large as that
    fn radiance_at_infinity(
        &self,
        _d: Vec3,
        _footprint: &SkyFootprint,
        _wavelengths: &Wavelengths,
    ) -> Option<Spectrum> {
        None
    }

    /// Luminous power, of light from infinitely far what reaches the `world`.
    fn power(&self, world: &BoundingSphere) -> f32;

    /// The spectrum of all its light but for a factor, or of its mean; `None` where it is that of pictures.
    fn emission(&self) -> Option<&Emission>;

    /// What it emits where, if that is not the same everywhere on its surface.
    fn varied_emission(&self) -> Option<VariedEmissionId> {
        None
    }
}

family! {
    /// Names a light in [`Lights`].
    handle LightId;
    /// All lights of a scene.
    pools Lights;
    /// Any light.
    any AnyLight;
    contract Emitter;
    members {
        areas: AreaLight,
        directional: DirectionalLight,
        photometric: PhotometricLight,
        point: PointLight,
        skies: SkyLight,
        spots: SpotLight,
    }
    any methods {
        /// See [`Emitter::is_finite`].
        fn is_finite() -> bool;
    }
    methods {
        /// See [`Emitter::illuminate`].
        fn illuminate(p: Vec3, time: f32) -> Illumination;
        /// See [`Emitter::sample_li`].
        fn sample_li<S: EmissiveSurfaces>(to: &Receiver, u: Vec2, wavelengths: &Wavelengths, surfaces: &S) -> Option<LightLiSample>;
        /// See [`Emitter::pdf_li`].
        fn pdf_li(to: &Receiver, at: &LightPoint, wi: Vec3) -> f32;
        /// See [`Emitter::sample_li_beside_scattering`].
        fn sample_li_beside_scattering<S: EmissiveSurfaces>(to: &Receiver, u: Vec2, wavelengths: &Wavelengths, surfaces: &S) -> Option<LightLiSample>;
        /// See [`Emitter::pdf_li_beside_scattering`].
        fn pdf_li_beside_scattering(to: &Receiver, at: &LightPoint, wi: Vec3) -> f32;
        /// See [`Emitter::sample_le`].
        fn sample_le<S: EmissiveSurfaces>(time: f32, u: LeNumbers, wavelengths: &Wavelengths, world: &BoundingSphere, surfaces: &S) -> Option<LightLeSample>;
        /// See [`Emitter::pdf_le`].
        fn pdf_le(time: f32, at: &LightPoint, d: Vec3, world: &BoundingSphere) -> EmissionPdf;
        /// See [`Emitter::bounds`].
        fn bounds() -> Option<LightBounds>;
        /// See [`Emitter::irradiance`].
        fn irradiance() -> f32;
        /// See [`Emitter::unevenness`].
        fn unevenness() -> f32;
        /// See [`Emitter::apex`].
        fn apex() -> Option<Vec3>;
        /// See [`Emitter::is_surface`].
        fn is_surface() -> bool;
        /// See [`Emitter::sample_area`].
        fn sample_area(u: Vec2, time: f32) -> Option<(LightPoint, f32)>;
        /// See [`Emitter::pdf_area`].
        fn pdf_area(p: Vec3, time: f32) -> f32;
        /// See [`Emitter::outline`].
        fn outline() -> LightOutline;
        /// See [`Emitter::is_pointlike`].
        fn is_pointlike() -> bool;
        /// See [`Emitter::is_unfading`].
        fn is_unfading() -> bool;
        /// See [`Emitter::object`].
        fn object() -> Option<ObjectId>;
        /// See [`Emitter::is_background`].
        fn is_background() -> bool;
        /// See [`Emitter::is_seen_at_infinity`].
        fn is_seen_at_infinity() -> bool;
        /// See [`Emitter::radiance_at_infinity`].
        fn radiance_at_infinity(d: Vec3, footprint: &SkyFootprint, wavelengths: &Wavelengths) -> Option<Spectrum>;
        /// See [`Emitter::power`].
        fn power(world: &BoundingSphere) -> f32;
        /// See [`Emitter::emission`].
        fn emission() -> Option<&Emission>;
        /// See [`Emitter::varied_emission`].
        fn varied_emission() -> Option<VariedEmissionId>;
    }
}

#[cfg(test)]
pub(crate) mod tests;
