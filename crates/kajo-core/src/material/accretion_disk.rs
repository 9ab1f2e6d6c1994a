//! The gas that a black hole swallows: it goes around, emits, and lets nothing pass.
//!
//! The surface is flat in the equatorial plane, or near it. It scatters nothing; its light is that of [`OrbitingGas`], through a pattern.
//!
//! Scene: `AccretionDisk gas { hole gargantua  temperature 5000 }`

use kajo_color::Spectrum;

use super::{Appearance, Material, MaterialId, ShadingPoint};
use crate::bsdf::{Bsdf, Lambert, Phong};
use crate::emission::{OrbitingGas, SurfaceEmission};
use crate::texture::{AnyTexture, FloatTexture, TextureContext, Textures};

/// Hot gas around a black hole.
#[derive(Clone, Debug)]
pub struct AccretionDisk {
    /// What emits.
    pub gas: OrbitingGas,
    /// What its light is multiplied by.
    pub pattern: FloatTexture,
}

impl Material for AccretionDisk {
    fn is_finite(&self) -> bool {
        self.gas.is_finite()
    }

    fn textures(&self) -> Vec<AnyTexture<'_>> {
        vec![self.pattern.into()]
    }

    fn emission(
        &self,
        _of_part: &dyn Fn(MaterialId) -> SurfaceEmission,
        _textures: &mut Textures,
    ) -> Option<SurfaceEmission> {
        Some(SurfaceEmission::from(self.gas.clone()).times(self.pattern))
    }

    fn phong(&self, _appearance: &Appearance, _at: &TextureContext) -> Phong {
        Phong::BLACK
    }

    fn needs_uv(&self, _appearance: &Appearance) -> bool {
        false
    }

    fn bsdf<'a>(&'a self, _appearance: &'a Appearance, _at: &ShadingPoint<'_>) -> Bsdf<'a> {
        Bsdf::Lambert(Lambert::new(Spectrum::BLACK))
    }
}
