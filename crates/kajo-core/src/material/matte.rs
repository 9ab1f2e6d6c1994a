//! A surface without gloss: plaster, clay, cloth.
//!
//! Light is scattered by [`OrenNayar`], which for a roughness of 0 is Lambert's law. The classic integrator sees its
//! colour as a diffuse one.
//!
//! Scene: `Matte { color 0.7 0.4 0.3  roughness 0.6 }`

use kajo_color::Reflectance;
use kajo_math::Vec3;

use super::{Appearance, Materials, ShadingPoint};
use crate::bsdf::{Bsdf, Lambert, OrenNayar, Phong};
use crate::texture::Textures;

/// A matt material.
#[derive(Clone, Debug)]
pub struct Matte {
    color: Reflectance,
    roughness: f32,
    classic: Phong,
}

impl Matte {
    /// * `color`: albedo; `roughness`: in [0, 1]
    pub fn new(color: Reflectance, roughness: f32) -> Matte {
        let diffuse = Vec3::from(color.rgb()).into();
        let classic = Phong { ambient: diffuse, diffuse, ..Phong::BLACK };
        Matte { color, roughness, classic }
    }
}

impl Appearance for Matte {
    fn phong(&self, _materials: &Materials, _textures: &Textures, _p: Vec3) -> Phong {
        self.classic
    }

    fn constant(&self) -> Option<&Phong> {
        Some(&self.classic)
    }

    fn may_transmit(&self, _materials: &Materials) -> bool {
        false
    }

    fn bsdf(&self, _materials: &Materials, _textures: &Textures, at: &ShadingPoint<'_>) -> Bsdf {
        let reflectance = self.color.at(at.wavelengths);
        if self.roughness == 0.0 {
            return Bsdf::Lambert(Lambert::new(reflectance));
        }
        Bsdf::OrenNayar(OrenNayar { reflectance, roughness: self.roughness })
    }
}
