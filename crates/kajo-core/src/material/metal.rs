//! Metal by its name or by its colour, polished or rough.
//!
//! Roughness is as it looks: facets have `α = roughness²`. The classic integrator sees a mirror with the
//! reflectance straight on, and a highlight of the exponent `2/α² - 2`.
//!
//! Scene: `Metal { metal gold  roughness 0.3 }`

use kajo_color::{Reflectance, Spectrum, metal};
use kajo_math::Vec3;

use super::{Appearance, Materials, ShadingPoint};
use crate::bsdf::{Bsdf, Conductor, MetalFresnel, Microfacets, Phong, microfacet::Shape};
use crate::texture::Textures;

/// What a metal is made of.
#[derive(Clone, Debug)]
pub enum Substance {
    /// Measured index and extinction.
    Measured(metal::Metal),
    /// Reflectance straight on; towards the horizon it goes to white.
    Color(Reflectance),
}

/// A metal.
#[derive(Clone, Debug)]
pub struct Metal {
    substance: Substance,
    facets: Microfacets,
    classic: Phong,
}

impl Metal {
    /// * `roughness`: in [0, 1]
    pub fn new(substance: Substance, shape: Shape, roughness: f32) -> Metal {
        let rgb = match &substance {
            Substance::Measured(metal) => metal.rgb(),
            Substance::Color(color) => color.rgb(),
        };
        let f0 = Spectrum::from(Vec3::from(rgb));
        let facets = Microfacets::new(shape, roughness * roughness);
        let classic = Phong { specular: f0, reflective: f0, exponent: facets.exponent(), ..Phong::BLACK };
        Metal { substance, facets, classic }
    }
}

impl Appearance for Metal {
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
        let fresnel = match &self.substance {
            Substance::Measured(metal) => {
                let (eta, k) = metal.at(at.wavelengths);
                let outside = 1.0 / at.eta_outside;
                MetalFresnel::Complex { eta: eta * outside, k: k * outside }
            }
            Substance::Color(color) => {
                MetalFresnel::Tinted { f0: color.at(at.wavelengths), f82: Spectrum::WHITE }
            }
        };
        Bsdf::Conductor(Conductor { fresnel, microfacets: self.facets })
    }
}
