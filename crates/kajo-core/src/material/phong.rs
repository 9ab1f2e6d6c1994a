//! The material of the classic format.
//!
//! The classic integrator takes its numbers as they stand; integrators that estimate integrals see
//! [`PhongLobes`], the same model with its lobes normalised. Its colour `transparentColor` then tints each
//! passage through the surface, and the inside absorbs nothing.
//!
//! Scene: `Material { diffuseColor 0.8 0.3 0.2  specularColor 1 1 1  exponent 32 }`

use kajo_color::Reflectance;
use kajo_math::Vec3;

use super::{Appearance, Interior, Materials, ShadingPoint};
use crate::bsdf::{Bsdf, Lambert, Phong, PhongLobes};
use crate::texture::Textures;

/// A Phong material.
#[derive(Clone, Debug)]
pub struct PhongMaterial {
    /// Its numbers in linear RGB.
    pub phong: Phong,
    /// The diffuse, specular, reflective and transparent colours as reflectances.
    colors: [Reflectance; 4],
    /// The lobes of the linear RGB colours, in a vacuum.
    lobes: PhongLobes,
    /// Whether there is nothing but matt reflection.
    is_matt: bool,
}

impl PhongMaterial {
    /// A material whose diffuse, specular, reflective and transparent colours are these reflectances.
    pub fn new(phong: Phong, colors: [Reflectance; 4]) -> PhongMaterial {
        let is_matt =
            [phong.specular, phong.reflective, phong.transparent].iter().all(|color| color.is_black());
        PhongMaterial { phong, colors, lobes: PhongLobes::from(&phong), is_matt }
    }
}

impl From<Phong> for PhongMaterial {
    fn from(phong: Phong) -> PhongMaterial {
        let colors = [phong.diffuse, phong.specular, phong.reflective, phong.transparent];
        PhongMaterial::new(phong, colors.map(|color| Reflectance::from_rgb(color.to_rgb())))
    }
}

impl Appearance for PhongMaterial {
    #[inline]
    fn phong(&self, _materials: &Materials, _textures: &Textures, _p: Vec3) -> Phong {
        self.phong
    }

    #[inline]
    fn constant(&self) -> Option<&Phong> {
        Some(&self.phong)
    }

    fn may_transmit(&self, _materials: &Materials) -> bool {
        !self.phong.transparent.is_black()
    }

    #[inline]
    fn bsdf(&self, _materials: &Materials, _textures: &Textures, at: &ShadingPoint<'_>) -> Bsdf {
        if self.is_matt {
            return Bsdf::Lambert(Lambert::new(self.colors[0].at(at.wavelengths)));
        }
        let mut lobes = self.lobes;
        if at.wavelengths.is_spectral() {
            let [diffuse, specular, reflective, transparent] =
                self.colors.each_ref().map(|color| color.at(at.wavelengths));
            lobes = PhongLobes::from(&Phong { diffuse, specular, reflective, transparent, ..self.phong });
        }
        Bsdf::Phong(lobes.within(at.eta_outside))
    }

    fn interior(&self, _: &Materials, _: &Textures, _: &ShadingPoint<'_>) -> Option<Interior> {
        let absorption = kajo_color::Spectrum::BLACK;
        let interior = Interior { eta: self.phong.eta, is_dispersive: false, absorption, priority: 0 };
        (!self.phong.transparent.is_black()).then_some(interior)
    }
}
