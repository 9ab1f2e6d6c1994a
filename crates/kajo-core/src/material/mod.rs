//! Materials: which reflection model a surface has at each of its points.

mod blend;
mod glass;
mod matte;
mod metal;
mod perforated;
mod phong;
mod principled;

pub use blend::Blend;
pub use glass::{Glass, GlassSettings};
pub use matte::Matte;
pub use metal::{Metal, Substance};
pub use perforated::Perforated;
pub use phong::PhongMaterial;
pub use principled::{LayeredMaterial, Layers};

use kajo_color::{Spectrum, Wavelengths};
use kajo_math::Vec3;

use crate::bsdf::{Bsdf, Phong};
use crate::family::family;
use crate::texture::Textures;

/// Where a material is asked how it scatters.
#[derive(Clone, Copy, Debug)]
pub struct ShadingPoint<'a> {
    /// World-space point.
    pub p: Vec3,
    /// What the lanes of the answer stand for.
    pub wavelengths: &'a Wavelengths,
    /// Index of refraction outside, on the side of the normal, at the first wavelength.
    pub eta_outside: f32,
    /// Uniform in [0, 1): chooses among the parts of a mixture.
    pub u: f32,
}

/// What fills a body whose surface lets light through.
#[derive(Clone, Copy, Debug)]
pub struct Interior {
    /// Index of refraction at the first wavelength.
    pub eta: f32,
    /// Whether the index depends on the wavelength.
    pub is_dispersive: bool,
    /// Absorption per unit length: light is weakened by `exp(-absorption d)`.
    pub absorption: Spectrum,
    /// Where bodies overlap the one of the highest priority is there [Schmidt and Budge 2002].
    pub priority: i32,
}

/// What every material can do.
pub trait Appearance {
    /// The classic reflection model at the world-space point `p`.
    fn phong(&self, materials: &Materials, textures: &Textures, p: Vec3) -> Phong;

    /// The classic reflection model, where it is the same at every point.
    fn constant(&self) -> Option<&Phong> {
        None
    }

    /// Whether light can pass through anywhere.
    fn may_transmit(&self, materials: &Materials) -> bool;

    /// How light is scattered at a point, for integrators that estimate integrals.
    ///
    /// A mixture answers with one of its parts, drawn with its share; the mean of the answers is the mixture.
    fn bsdf(&self, materials: &Materials, textures: &Textures, at: &ShadingPoint<'_>) -> Bsdf;

    /// Whether [`Appearance::bsdf`] chooses among parts.
    fn is_mixture(&self) -> bool {
        false
    }

    /// The share of the surface that is there at the world-space point `p`; the rest is holes, where
    /// [`Appearance::bsdf`] answers with [`Bsdf::Null`].
    fn opacity(&self, _materials: &Materials, _textures: &Textures, _p: Vec3) -> f32 {
        1.0
    }

    /// What is behind the surface, for materials that refract.
    fn interior(
        &self,
        _materials: &Materials,
        _textures: &Textures,
        _at: &ShadingPoint<'_>,
    ) -> Option<Interior> {
        None
    }
}

family! {
    /// Names a material in [`Materials`].
    handle MaterialId;
    /// All materials of a scene.
    pools Materials;
    contract Appearance;
    members {
        blends: Blend,
        glasses: Glass,
        layered: LayeredMaterial,
        mattes: Matte,
        metals: Metal,
        perforated: Perforated,
        phongs: PhongMaterial,
    }
    methods {
        /// See [`Appearance::phong`].
        fn phong(materials: &Materials, textures: &Textures, p: Vec3) -> Phong;
        /// See [`Appearance::constant`].
        fn constant() -> Option<&Phong>;
        /// See [`Appearance::may_transmit`].
        fn may_transmit(materials: &Materials) -> bool;
        /// See [`Appearance::bsdf`].
        fn bsdf(materials: &Materials, textures: &Textures, at: &ShadingPoint<'_>) -> Bsdf;
        /// See [`Appearance::is_mixture`].
        fn is_mixture() -> bool;
        /// See [`Appearance::opacity`].
        fn opacity(materials: &Materials, textures: &Textures, p: Vec3) -> f32;
        /// See [`Appearance::interior`].
        fn interior(materials: &Materials, textures: &Textures, at: &ShadingPoint<'_>) -> Option<Interior>;
    }
}
