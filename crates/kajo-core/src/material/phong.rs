//! The material of the classic format.
//!
//! The classic integrator takes its numbers as they stand; integrators that estimate integrals see
//! [`PhongLobes`], the same model with its lobes normalised. Its colour `transparentColor` then tints each
//! passage through the surface, and the inside absorbs nothing. A picture is a factor of the diffuse and the ambient
//! colour.
//!
//! Scene: `Material { diffuseColor 0.8 0.3 0.2  specularColor 1 1 1  exponent 32 }`

use kajo_color::{Reflectance, Spectrum, Wavelengths};

use super::{Appearance, Interior, Material, ShadingPoint};
use crate::bsdf::{Bsdf, Lambert, Phong, PhongLobes};
use crate::texture::{AnyTexture, ColorTexture, TextureContext, TextureEvaluator};

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
    /// A factor of the diffuse and the ambient colour.
    picture: Option<ColorTexture>,
}

impl PhongMaterial {
    /// A material whose diffuse, specular, reflective and transparent colours are these reflectances.
    pub fn new(phong: Phong, colors: [Reflectance; 4]) -> PhongMaterial {
        let is_matt =
            [phong.specular, phong.reflective, phong.transparent].iter().all(|color| color.is_black());
        PhongMaterial { phong, colors, lobes: PhongLobes::from(&phong), is_matt, picture: None }
    }

    /// The same material with a picture as a factor of its diffuse and ambient colour.
    pub fn with_picture(self, picture: Option<ColorTexture>) -> PhongMaterial {
        PhongMaterial { picture, ..self }
    }

    /// The same material with another diffuse colour, under ambient light as well.
    pub fn with_diffuse(&self, diffuse: Spectrum) -> PhongMaterial {
        let phong = Phong { diffuse, ambient: diffuse, ..self.phong };
        let [_, specular, reflective, transparent] = self.colors.clone();
        let colors = [Reflectance::from_rgb(diffuse.to_rgb()), specular, reflective, transparent];
        PhongMaterial::new(phong, colors).with_picture(self.picture.clone())
    }

    /// What light is scattered by where there is a picture or the mesh has colours.
    #[inline(never)]
    fn painted(&self, appearance: &Appearance, at: &ShadingPoint<'_>) -> Bsdf {
        let [diffuse, specular, reflective, transparent] =
            self.colors.each_ref().map(|color| color.at(at.wavelengths));
        let diffuse = self.as_painted(diffuse, appearance.textures.evaluator(&at.context), at.wavelengths);
        if self.is_matt {
            return Bsdf::Lambert(Lambert::new(diffuse));
        }
        let phong = Phong { diffuse, specular, reflective, transparent, ..self.phong };
        Bsdf::Phong(PhongLobes::from(&phong).within(at.eta_outside))
    }

    /// A diffuse or ambient colour where it differs from place to place.
    fn as_painted(
        &self,
        color: Spectrum,
        place: TextureEvaluator<'_>,
        wavelengths: &Wavelengths,
    ) -> Spectrum {
        let picture = self.picture.as_ref();
        let color = picture.map_or(color, |picture| color * picture.at(place, wavelengths));
        place.at.tinted(color, wavelengths)
    }

    #[inline]
    fn varies_at(&self, at: &TextureContext) -> bool {
        self.picture.is_some() || at.tint.is_some()
    }
}

impl From<Phong> for PhongMaterial {
    fn from(phong: Phong) -> PhongMaterial {
        let colors = [phong.diffuse, phong.specular, phong.reflective, phong.transparent];
        PhongMaterial::new(phong, colors.map(|color| Reflectance::from_rgb(color.to_rgb())))
    }
}

impl Material for PhongMaterial {
    fn is_finite(&self) -> bool {
        let Phong { ambient, diffuse, specular, reflective, transparent, absorption, exponent, eta } =
            self.phong;
        let colors = [ambient, diffuse, specular, reflective, transparent, absorption];
        colors.iter().all(|color| color.is_finite()) && exponent.is_finite() && eta.is_finite()
    }

    fn textures(&self) -> Vec<AnyTexture<'_>> {
        self.picture.iter().map(AnyTexture::from).collect()
    }

    #[inline]
    fn phong(&self, appearance: &Appearance, at: &TextureContext) -> Phong {
        if !self.varies_at(at) {
            return self.phong;
        }
        let [ambient, diffuse] = [self.phong.ambient, self.phong.diffuse]
            .map(|color| self.as_painted(color, appearance.textures.evaluator(at), &Wavelengths::RGB));
        Phong { ambient, diffuse, ..self.phong }
    }

    #[inline]
    fn constant(&self) -> Option<&Phong> {
        if self.picture.is_none() { Some(&self.phong) } else { None }
    }

    fn needs_uv(&self, _appearance: &Appearance) -> bool {
        self.picture.is_some()
    }

    fn may_transmit(&self, _appearance: &Appearance) -> bool {
        !self.phong.transparent.is_black()
    }

    #[inline]
    fn bsdf(&self, appearance: &Appearance, at: &ShadingPoint<'_>) -> Bsdf {
        if self.varies_at(&at.context) {
            return self.painted(appearance, at);
        }
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

    fn interior(&self, _: &Appearance, _: &ShadingPoint<'_>) -> Option<Interior> {
        let absorption = Spectrum::BLACK;
        let interior = Interior { eta: self.phong.eta, is_dispersive: false, absorption, priority: 0 };
        (!self.phong.transparent.is_black()).then_some(interior)
    }
}
