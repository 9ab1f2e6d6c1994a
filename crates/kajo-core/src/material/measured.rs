//! A material whose BRDF was measured, and is looked up in tables.
//!
//! The same everywhere; of an anisotropic one the x axis lies along `u`, turned by `rotation`. The classic integrator sees a diffuse
//! surface of the albedo straight on.
//!
//! Scene: `Measured { file chrome.bsdf }`

use std::sync::Arc;

use super::{Appearance, Material, Orientation, ShadingPoint};
use crate::bsdf::{Bsdf, MeasuredLobe, Phong};
use crate::measured::MeasuredBrdf;
use crate::texture::{AnyTexture, FloatTexture, TextureContext};

/// A measured material.
#[derive(Clone, Debug)]
pub struct MeasuredMaterial {
    brdf: Arc<MeasuredBrdf>,
    scale: FloatTexture,
    rotation: FloatTexture,
    /// Where it is the same everywhere.
    constant: Option<Phong>,
}

impl MeasuredMaterial {
    /// * `scale`: a factor of all values, at least 0
    /// * `rotation`: by how many full turns the x axis is turned from `u` towards `v`
    pub fn new(
        brdf: Arc<MeasuredBrdf>,
        scale: impl Into<FloatTexture>,
        rotation: impl Into<FloatTexture>,
    ) -> MeasuredMaterial {
        let (scale, rotation) = (scale.into(), rotation.into());
        let constant = match scale {
            FloatTexture::Constant(scale) => Some(Phong::matte(brdf.albedo(1.0), scale)),
            FloatTexture::Node(_) => None,
        };
        MeasuredMaterial { brdf, scale, rotation, constant }
    }
}

impl Material for MeasuredMaterial {
    fn is_finite(&self) -> bool {
        true
    }

    fn textures(&self) -> Vec<AnyTexture<'_>> {
        vec![self.scale.into(), self.rotation.into()]
    }

    fn phong(&self, appearance: &Appearance, at: &TextureContext) -> Phong {
        let here = || Phong::matte(self.brdf.albedo(1.0), self.scale.at(appearance.textures.evaluator(at)));
        self.constant.unwrap_or_else(here)
    }

    fn constant(&self) -> Option<&Phong> {
        self.constant.as_ref()
    }

    fn needs_uv(&self, _appearance: &Appearance) -> bool {
        self.brdf.is_anisotropic() || self.scale.varies()
    }

    fn orientation(&self, appearance: &Appearance, at: &ShadingPoint<'_>) -> Orientation {
        let evaluator = appearance.textures.evaluator(at.context);
        Orientation { turn: self.brdf.is_anisotropic().then(|| self.rotation.at(evaluator)), lean: None }
    }

    fn is_oriented(&self, _appearance: &Appearance) -> bool {
        self.brdf.is_anisotropic()
    }

    fn bsdf<'a>(&'a self, appearance: &'a Appearance, at: &ShadingPoint<'_>) -> Bsdf<'a> {
        let lanes = self.brdf.lanes(at.wavelengths);
        let scale = self.scale.at(appearance.textures.evaluator(at.context));
        Bsdf::Measured(MeasuredLobe { brdf: &self.brdf, scale, lanes })
    }
}
