//! The material of the classic format.
//!
//! The classic integrator takes its numbers as they stand; integrators that estimate integrals see
//! [`PhongLobes`], the same model with its lobes normalised. Its colour `transparentColor` then tints each
//! passage through the surface, and the inside absorbs nothing. Textures are factors of its colours.
//!
//! Scene: `Material { diffuseColor 0.8 0.3 0.2  specularColor 1 1 1  exponent 32 }`

use kajo_color::{Reflectance, Spectrum, Wavelengths};

use super::{Appearance, Interior, Material, ShadingPoint};
use crate::bsdf::{Bsdf, Lambert, Phong, PhongLobes};
use crate::texture::{AnyTexture, ColorTexture, FloatTexture, TextureContext, TextureEvaluator};

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
    /// What differs from place to place, if anything does.
    textures: Option<Box<PhongTextures>>,
}

/// What of a Phong material differs from place to place.
#[derive(Clone, Debug, Default)]
pub struct PhongTextures {
    /// A factor of the ambient colour.
    pub ambient: Option<ColorTexture>,
    /// A factor of the diffuse colour.
    pub diffuse: Option<ColorTexture>,
    /// A factor of the colour of the highlight.
    pub specular: Option<ColorTexture>,
    /// A factor of the colour of the mirror.
    pub reflective: Option<ColorTexture>,
    /// A factor of the colour of what shines through.
    pub transparent: Option<ColorTexture>,
    /// In place of the exponent.
    pub exponent: Option<FloatTexture>,
}

impl PhongMaterial {
    /// A material whose diffuse, specular, reflective and transparent colours are these reflectances.
    pub fn new(phong: Phong, colors: [Reflectance; 4]) -> PhongMaterial {
        let is_matt =
            [phong.specular, phong.reflective, phong.transparent].iter().all(|color| color.is_black());
        PhongMaterial { phong, colors, lobes: PhongLobes::from(&phong), is_matt, textures: None }
    }

    /// The same material with a texture as a factor of its diffuse and ambient colour.
    pub fn with_picture(self, picture: Option<ColorTexture>) -> PhongMaterial {
        self.with_textures(PhongTextures {
            ambient: picture.clone(),
            diffuse: picture,
            ..PhongTextures::default()
        })
    }

    /// The same material where this differs from place to place.
    pub fn with_textures(self, textures: PhongTextures) -> PhongMaterial {
        let varies =
            textures.colors().into_iter().any(|color| color.is_some()) || textures.exponent.is_some();
        PhongMaterial { textures: varies.then(|| Box::new(textures)), ..self }
    }

    /// The same material with another diffuse colour, under ambient light as well.
    pub fn with_diffuse(&self, diffuse: Spectrum) -> PhongMaterial {
        let phong = Phong { diffuse, ambient: diffuse, ..self.phong };
        let [_, specular, reflective, transparent] = self.colors.clone();
        let colors = [Reflectance::from_rgb(diffuse.to_rgb()), specular, reflective, transparent];
        PhongMaterial { textures: self.textures.clone(), ..PhongMaterial::new(phong, colors) }
    }

    /// What light is scattered by where anything differs from place to place.
    #[inline(never)]
    fn varied(&self, appearance: &Appearance, at: &ShadingPoint<'_>) -> Bsdf<'static> {
        let wavelengths = at.wavelengths;
        let [diffuse, specular, reflective, transparent] =
            self.colors.each_ref().map(|color| color.at(wavelengths));
        let plain = Phong { diffuse, specular, reflective, transparent, ..self.phong };
        let phong = self.textured(plain, appearance.textures.evaluator(at.context), wavelengths);
        if self.is_matt {
            return Bsdf::Lambert(Lambert::new(phong.diffuse));
        }
        Bsdf::Phong(PhongLobes::from(&phong).within(at.eta_outside))
    }

    /// The model at a place.
    ///
    /// * `phong`: what it is without textures and colours of a mesh
    fn textured(&self, phong: Phong, evaluator: TextureEvaluator<'_>, wavelengths: &Wavelengths) -> Phong {
        let mut phong = phong;
        if let Some(textures) = &self.textures {
            let colors = [
                &mut phong.ambient,
                &mut phong.diffuse,
                &mut phong.specular,
                &mut phong.reflective,
                &mut phong.transparent,
            ];
            for (color, texture) in std::iter::zip(colors, textures.colors()) {
                if let Some(texture) = texture {
                    *color *= texture.at(evaluator, wavelengths);
                }
            }
            phong.exponent = textures.exponent.map_or(phong.exponent, |exponent| exponent.at(evaluator));
        }
        let [ambient, diffuse] =
            [phong.ambient, phong.diffuse].map(|color| evaluator.at.tinted(color, wavelengths));
        Phong { ambient, diffuse, ..phong }
    }

    #[inline]
    fn varies_at(&self, at: &TextureContext) -> bool {
        self.textures.is_some() || at.tint.is_some()
    }
}

impl PhongTextures {
    fn colors(&self) -> [Option<&ColorTexture>; 5] {
        [&self.ambient, &self.diffuse, &self.specular, &self.reflective, &self.transparent]
            .map(Option::as_ref)
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
        let Some(textures) = &self.textures else { return Vec::new() };
        let colors = textures.colors().into_iter().flatten().map(AnyTexture::from);
        colors.chain(textures.exponent.map(AnyTexture::from)).collect()
    }

    #[inline]
    fn phong(&self, appearance: &Appearance, at: &TextureContext) -> Phong {
        if !self.varies_at(at) {
            return self.phong;
        }
        self.textured(self.phong, appearance.textures.evaluator(at), &Wavelengths::RGB)
    }

    #[inline]
    fn constant(&self) -> Option<&Phong> {
        if self.textures.is_none() { Some(&self.phong) } else { None }
    }

    fn needs_uv(&self, _appearance: &Appearance) -> bool {
        self.textures.is_some()
    }

    fn may_transmit(&self, _appearance: &Appearance) -> bool {
        !self.phong.transparent.is_black()
    }

    #[inline]
    fn bsdf<'a>(&'a self, appearance: &'a Appearance, at: &ShadingPoint<'_>) -> Bsdf<'a> {
        if self.varies_at(at.context) {
            return self.varied(appearance, at);
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
        let interior = Interior {
            eta: Some(self.phong.eta),
            is_dispersive: false,
            absorption,
            priority: 0,
            medium: None,
            adds: false,
        };
        (!self.phong.transparent.is_black()).then_some(interior)
    }
}
