//! A surface without gloss: plaster, clay, cloth.
//!
//! Light is scattered by [`OrenNayar`], which for a roughness of 0 is Lambert's law. The classic integrator sees its
//! colour as a diffuse one.
//!
//! Scene: `Matte { color 0.7 0.4 0.3  roughness 0.6 }`, `Matte { color planks.png { repeat 4 } }`

use kajo_color::Wavelengths;

use super::{Appearance, Material, ShadingPoint};
use crate::bsdf::{Bsdf, Lambert, OrenNayar, Phong};
use crate::texture::{AnyTexture, ColorTexture, FloatTexture, TextureContext, TextureEvaluator, Textures};

/// A matt material.
#[derive(Clone, Debug)]
pub struct Matte {
    color: ColorTexture,
    roughness: FloatTexture,
    /// Where it is the same everywhere.
    constant: Option<Phong>,
}

impl Matte {
    /// * `color`: albedo; `roughness`: in [0, 1]
    pub fn new(color: impl Into<ColorTexture>, roughness: impl Into<FloatTexture>) -> Matte {
        let (color, roughness) = (color.into(), roughness.into());
        let constant = (!color.varies())
            .then(|| classic(&color, Textures::default().evaluator(&TextureContext::default())));
        Matte { color, roughness, constant }
    }
}

/// The classic model: roughness is nothing to it.
fn classic(color: &ColorTexture, evaluator: TextureEvaluator<'_>) -> Phong {
    let diffuse = evaluator.at.tinted(color.rgb(evaluator), &Wavelengths::RGB);
    Phong { ambient: diffuse, diffuse, ..Phong::BLACK }
}

impl Material for Matte {
    fn is_finite(&self) -> bool {
        true
    }

    fn textures(&self) -> Vec<AnyTexture<'_>> {
        vec![(&self.color).into(), self.roughness.into()]
    }

    fn phong(&self, appearance: &Appearance, at: &TextureContext) -> Phong {
        let here = || classic(&self.color, appearance.textures.evaluator(at));
        self.constant.filter(|_| at.tint.is_none()).unwrap_or_else(here)
    }

    fn constant(&self) -> Option<&Phong> {
        self.constant.as_ref()
    }

    fn needs_uv(&self, _appearance: &Appearance) -> bool {
        self.color.varies() || self.roughness.varies()
    }

    fn bsdf<'a>(&'a self, appearance: &'a Appearance, at: &ShadingPoint<'_>) -> Bsdf<'a> {
        let evaluator = appearance.textures.evaluator(at.context);
        let reflectance = at.context.tinted(self.color.at(evaluator, at.wavelengths), at.wavelengths);
        let roughness = self.roughness.at(evaluator);
        if roughness == 0.0 {
            return Bsdf::Lambert(Lambert::new(reflectance));
        }
        Bsdf::OrenNayar(OrenNayar { reflectance, roughness })
    }
}
