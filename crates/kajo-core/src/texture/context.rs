//! Where textures are evaluated.

use kajo_color::{Spectrum, Wavelengths};
use kajo_math::{Affine3, Vec3, Vec4};

use super::rgb::rgb_reflectance;
use super::{SurfaceUv, TextureFootprint};

/// A point of a surface, as far as textures depend on it.
#[derive(Clone, Copy, Debug, Default)]
pub struct TextureContext {
    /// World-space point, where patterns are evaluated; of a thing that moves where it was at time 0.
    pub p: Vec3,
    /// Surface coordinates, where pictures are looked up; of effect where [`crate::material::Material::needs_uv`].
    pub uv: SurfaceUv,
    /// Linear RGB in [0, 1] that the base colour of the material is multiplied by, and a factor of the opacity of
    /// [`crate::material::Perforated`]: the colours at the corners of a mesh.
    pub tint: Option<Vec4>,
    /// Unit shading normal in world space, without any relief; zero where a texture is asked without a surface.
    pub n: Vec3,
    /// Moment within the shutter interval.
    pub time: f32,
    /// From the space of `p` to that in which the fields of the shape are written; of effect where
    /// [`super::Textures::wants_object_space`].
    pub object_from_world: Affine3,
    /// What a sample covers; that of a point unless [`crate::material::Appearance::has_filters`].
    pub footprint: TextureFootprint,
}

impl TextureContext {
    /// A base colour as it is here.
    #[inline]
    pub(crate) fn tinted(&self, color: Spectrum, wavelengths: &Wavelengths) -> Spectrum {
        self.tint.map_or(color, |tint| color * rgb_reflectance(tint.truncate().to_array(), wavelengths))
    }

    /// The factor of the opacity here.
    #[inline]
    pub(crate) fn cover(&self) -> f32 {
        self.tint.map_or(1.0, |tint| tint.w)
    }
}
