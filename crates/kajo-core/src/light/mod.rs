//! Lights that are not surfaces.

mod directional;
mod point;

pub use directional::DirectionalLight;
pub use point::PointLight;

use kajo_color::Spectrum;
use kajo_math::Vec3;

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

/// What every light can do.
pub trait Emitter {
    /// The light that arrives at the world-space point `p`.
    fn illuminate(&self, p: Vec3) -> Illumination;
}

family! {
    /// Names a light in [`Lights`].
    handle LightId;
    /// All lights of a scene.
    pools Lights;
    contract Emitter;
    members {
        directional: DirectionalLight,
        point: PointLight,
    }
    methods {
        /// See [`Emitter::illuminate`].
        fn illuminate(p: Vec3) -> Illumination;
    }
}
