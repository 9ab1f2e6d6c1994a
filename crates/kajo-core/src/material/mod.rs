//! Materials: which reflection model a surface has at each of its points.

mod blend;

pub use blend::Blend;

use kajo_math::Vec3;

use crate::bsdf::Phong;
use crate::family::family;
use crate::texture::Textures;

/// What every material can do.
pub trait Appearance {
    /// The reflection model at the world-space point `p`.
    fn phong(&self, materials: &Materials, textures: &Textures, p: Vec3) -> Phong;

    /// The reflection model, where it is the same at every point.
    fn constant(&self) -> Option<&Phong> {
        None
    }

    /// Whether light can pass through anywhere.
    fn may_transmit(&self, materials: &Materials) -> bool;
}

family! {
    /// Names a material in [`Materials`].
    handle MaterialId;
    /// All materials of a scene.
    pools Materials;
    contract Appearance;
    members {
        blends: Blend,
        phongs: Phong,
    }
    methods {
        /// See [`Appearance::phong`].
        fn phong(materials: &Materials, textures: &Textures, p: Vec3) -> Phong;
        /// See [`Appearance::constant`].
        fn constant() -> Option<&Phong>;
        /// See [`Appearance::may_transmit`].
        fn may_transmit(materials: &Materials) -> bool;
    }
}

/// The same everywhere.
impl Appearance for Phong {
    #[inline]
    fn phong(&self, _materials: &Materials, _textures: &Textures, _p: Vec3) -> Phong {
        *self
    }

    #[inline]
    fn constant(&self) -> Option<&Phong> {
        Some(self)
    }

    fn may_transmit(&self, _materials: &Materials) -> bool {
        !self.transparent.is_black()
    }
}
