//! A material whose BRDF was measured, and is looked up in tables.
//!
//! The same everywhere; of an anisotropic one the x axis lies along `u`, turned by `rotation`. The classic integrator sees a diffuse
//! surface of the albedo straight on.
//!
//! Scene: `Measured { file chrome.bsdf }`

use std::sync::Arc;

use kajo_color::Spectrum;

use super::{Appearance, Material, Orientation, ShadingPoint};
use crate::bsdf::{Bsdf, MeasuredLobe, Phong};
use crate::measured::MeasuredBrdf;
use crate::texture::{AnyTexture, FloatTexture, TextureContext};

/// A measured material.
#[derive(Clone, Debug)]
pub struct MeasuredMaterial {
    brdf: Arc<MeasuredBrdf>,
    scale: f32,
    rotation: FloatTexture,
    constant: Phong,
}

impl MeasuredMaterial {
    /// * `scale`: a factor of all values, at least 0
    /// * `rotation`: by how many full turns the x axis is turned from `u` towards `v`
    pub fn new(brdf: Arc<MeasuredBrdf>, scale: f32, rotation: impl Into<FloatTexture>) -> MeasuredMaterial {
        let [r, g, b] = brdf.albedo(1.0).map(|v| (v * scale).clamp(0.0, 1.0));
        let diffuse = Spectrum::rgb(r, g, b);
        let constant = Phong { ambient: diffuse, diffuse, ..Phong::BLACK };
        MeasuredMaterial { brdf, scale, rotation: rotation.into(), constant }
    }
}

impl Material for MeasuredMaterial {
    fn is_finite(&self) -> bool {
        self.scale.is_finite()
    }

    fn textures(&self) -> Vec<AnyTexture<'_>> {
        vec![self.rotation.into()]
    }

    fn phong(&self, _appearance: &Appearance, _at: &TextureContext) -> Phong {
        self.constant
    }

    fn constant(&self) -> Option<&Phong> {
        Some(&self.constant)
    }

    fn needs_uv(&self, _appearance: &Appearance) -> bool {
        self.brdf.is_anisotropic()
    }

    fn orientation(&self, appearance: &Appearance, at: &ShadingPoint<'_>) -> Orientation {
        let evaluator = appearance.textures.evaluator(at.context);
        Orientation { turn: self.brdf.is_anisotropic().then(|| self.rotation.at(evaluator)), lean: None }
    }

    fn is_oriented(&self, _appearance: &Appearance) -> bool {
        self.brdf.is_anisotropic()
    }

    fn bsdf<'a>(&'a self, _appearance: &'a Appearance, at: &ShadingPoint<'_>) -> Bsdf<'a> {
        let lanes = self.brdf.lanes(at.wavelengths);
        Bsdf::Measured(MeasuredLobe { brdf: &self.brdf, scale: self.scale, lanes })
    }
}
