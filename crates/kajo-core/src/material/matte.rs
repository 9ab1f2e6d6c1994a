//! A surface without gloss: plaster, clay, cloth.
//!
//! Light is scattered by [`OrenNayar`], which for a roughness of 0 is Lambert's law. The classic integrator sees its
//! colour as a diffuse one.
//!
//! Scene: `Matte { color 0.7 0.4 0.3  roughness 0.6 }`, `Matte { color planks.png { repeat 4 } }`

use kajo_color::Wavelengths;

use super::{Appearance, Material, ShadingPoint};
use crate::bsdf::{Bsdf, Lambert, OrenNayar, Phong};
use crate::texture::{Paint, Share, TextureContext};

/// A matt material.
#[derive(Clone, Debug)]
pub struct Matte {
    color: Paint,
    roughness: Share,
    /// Where it is the same everywhere.
    constant: Option<Phong>,
}

impl Matte {
    /// * `color`: albedo; `roughness`: in [0, 1]
    pub fn new(color: impl Into<Paint>, roughness: impl Into<Share>) -> Matte {
        let (color, roughness) = (color.into(), roughness.into());
        let constant = (!color.varies()).then(|| classic(&color, &TextureContext::default()));
        Matte { color, roughness, constant }
    }
}

/// The classic model: roughness is nothing to it.
fn classic(color: &Paint, at: &TextureContext) -> Phong {
    let diffuse = at.tinted(color.rgb(at.uv), &Wavelengths::RGB);
    Phong { ambient: diffuse, diffuse, ..Phong::BLACK }
}

impl Material for Matte {
    fn is_finite(&self) -> bool {
        self.color.is_finite() && self.roughness.is_finite()
    }

    fn phong(&self, _appearance: &Appearance, at: &TextureContext) -> Phong {
        self.constant.filter(|_| at.tint.is_none()).unwrap_or_else(|| classic(&self.color, at))
    }

    fn constant(&self) -> Option<&Phong> {
        self.constant.as_ref()
    }

    fn needs_uv(&self, _appearance: &Appearance) -> bool {
        self.color.varies() || self.roughness.varies()
    }

    fn bsdf(&self, _appearance: &Appearance, at: &ShadingPoint<'_>) -> Bsdf {
        let reflectance = at.context.tinted(self.color.at(at.context.uv, at.wavelengths), at.wavelengths);
        let roughness = self.roughness.at(at.context.uv);
        if roughness == 0.0 {
            return Bsdf::Lambert(Lambert::new(reflectance));
        }
        Bsdf::OrenNayar(OrenNayar { reflectance, roughness })
    }
}
