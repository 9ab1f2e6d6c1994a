//! Lights: what illuminates surfaces.
//!
//! Three questions are asked of a light. The classic integrator asks how much light arrives at a point
//! ([`Emitter::illuminate`]). Integrators that estimate integrals draw a direction towards the light with a
//! known density ([`Emitter::sample`]); which light they ask is for [`LightTree`] to say. Those that follow light from
//! its source draw a ray that leaves it ([`Emitter::emit`]); where they begin is for [`Departures`] to say.

mod area;
mod directional;
mod emit;
mod emitters;
mod photometric;
mod point;
mod sky;
mod spot;
mod tree;

pub use area::{AreaLight, Sides};
pub use directional::DirectionalLight;
pub use emit::{Ball, Departures, EmissionPdf, Emitted};
pub use emitters::Emitters;
pub use photometric::{PhotometricLight, Photometry};
pub use point::PointLight;
pub use sky::SkyLight;
pub use spot::{Cone, SpotLight};
pub use tree::{LightBounds, LightChoice, LightTree};

use kajo_color::{Emission, Spectrum, Wavelengths};
use kajo_math::{Vec2, Vec3};

use crate::family::family;

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

/// Most groups of lights that a scene can have, those without a group counted as one.
pub const MAX_LIGHT_GROUPS: usize = 8;

/// Light that arrives at a point from a direction drawn at random.
#[derive(Clone, Copy, Debug)]
pub struct LightSample {
    /// Unit direction towards the light.
    pub wi: Vec3,
    /// Radiance from there; for a light without extent its irradiance across `wi`.
    pub radiance: Spectrum,
    /// Density of the direction per solid angle; 1 for a light without extent.
    pub pdf: f32,
    /// Whether the light has no extent, so that no ray finds it by chance.
    pub is_delta: bool,
    /// How far the way must be clear.
    pub target: Target,
    /// The number of the light; [`Emitters::sample`] fills it in.
    pub light: u32,
}

/// The far end of the way to a light.
#[derive(Clone, Copy, Debug)]
pub enum Target {
    /// A place on a surface, which is not to hide itself.
    Surface {
        /// The place.
        p: Vec3,
        /// Bound on the error of its coordinates.
        p_error: Vec3,
        /// Unit geometric normal.
        n: Vec3,
    },
    /// A point in space.
    Point(Vec3),
    /// Beyond everything, along the sample's `wi`.
    Infinity,
}

/// What every light can do.
pub trait Emitter {
    /// The light that arrives at the world-space point `p`, in the classic integrator's units.
    ///
    /// * `time`: moment within the shutter interval
    fn illuminate(&self, p: Vec3, time: f32) -> Illumination;

    /// Light that arrives at the world-space point `p` from a direction drawn with `u` in [0, 1)^2; `None` when
    /// none does.
    ///
    /// * `time`: moment within the shutter interval
    fn sample(&self, p: Vec3, time: f32, u: Vec2, wavelengths: &Wavelengths) -> Option<LightSample>;

    /// Where the light is and how strong, for the choice among many; `None` when it is infinitely far.
    fn bounds(&self) -> Option<LightBounds>;

    /// The world-space point where all its light comes from, if there is one.
    fn apex(&self) -> Option<Vec3> {
        None
    }

    /// A ray of light that leaves, drawn with `u` in [0, 1)^2 for its place and for its direction; `None` when there
    /// is none.
    fn emit(&self, time: f32, u: [Vec2; 2], wavelengths: &Wavelengths, world: &Ball) -> Option<Emitted>;

    /// Densities with which [`Emitter::emit`] draws light that leaves along the unit vector `d`.
    ///
    /// * `time`: moment within the shutter interval
    /// * `at`: where it leaves, or any point on the way of light from infinitely far; and the unit normal there, of
    ///   effect where the light has a surface
    fn emission_pdf(&self, time: f32, at: [Vec3; 2], d: Vec3, world: &Ball) -> EmissionPdf;

    /// Luminous power, of light from infinitely far what reaches the `world`.
    fn power(&self, world: &Ball) -> f32;

    /// The spectrum of all its light but for a factor, or of its mean; `None` where it is that of pictures.
    fn emission(&self) -> Option<&Emission>;
}

family! {
    /// Names a light in [`Lights`].
    handle LightId;
    /// All lights of a scene.
    pools Lights;
    contract Emitter;
    members {
        areas: AreaLight,
        directional: DirectionalLight,
        photometric: PhotometricLight,
        point: PointLight,
        skies: SkyLight,
        spots: SpotLight,
    }
    methods {
        /// See [`Emitter::illuminate`].
        fn illuminate(p: Vec3, time: f32) -> Illumination;
        /// See [`Emitter::sample`].
        fn sample(p: Vec3, time: f32, u: Vec2, wavelengths: &Wavelengths) -> Option<LightSample>;
        /// See [`Emitter::bounds`].
        fn bounds() -> Option<LightBounds>;
        /// See [`Emitter::apex`].
        fn apex() -> Option<Vec3>;
        /// See [`Emitter::emit`].
        fn emit(time: f32, u: [Vec2; 2], wavelengths: &Wavelengths, world: &Ball) -> Option<Emitted>;
        /// See [`Emitter::emission_pdf`].
        fn emission_pdf(time: f32, at: [Vec3; 2], d: Vec3, world: &Ball) -> EmissionPdf;
        /// See [`Emitter::power`].
        fn power(world: &Ball) -> f32;
        /// See [`Emitter::emission`].
        fn emission() -> Option<&Emission>;
    }
}

#[cfg(test)]
pub(crate) mod tests;
