//! Metal by its name or by its colour, polished or rough.
//!
//! Roughness is as it looks: facets have `α = roughness²`. The classic integrator sees a mirror with the
//! reflectance straight on, and a highlight of the exponent `2/α² - 2`.
//!
//! Scene: `Metal { metal gold  roughness 0.3  anisotropy 0.8 }`

use kajo_color::{Spectrum, Wavelengths, metal};
use kajo_math::Vec3;

use super::{Appearance, Grain, Material, Orientation, ShadingPoint};
use crate::bsdf::{Bsdf, Conductor, MetalFresnel, Microfacets, Phong, microfacet::NormalDistribution};
use crate::texture::{AnyTexture, ColorTexture, FloatTexture, TextureContext, TextureEvaluator, Textures};

/// What a metal is made of.
#[derive(Clone, Debug)]
pub enum Substance {
    /// Measured index and extinction.
    Measured(metal::MeasuredMetal),
    /// Reflectance straight on; towards the horizon it goes to white.
    Color(ColorTexture),
}

/// A metal.
#[derive(Clone, Debug)]
pub struct Metal {
    substance: Substance,
    shape: NormalDistribution,
    roughness: FloatTexture,
    grain: Grain,
    /// Where it is the same everywhere.
    constant: Option<Phong>,
}

impl Metal {
    /// * `roughness`: in [0, 1]
    pub fn new(substance: Substance, shape: NormalDistribution, roughness: impl Into<FloatTexture>) -> Metal {
        let (roughness, grain) = (roughness.into(), Grain::default());
        Metal { substance, shape, roughness, grain, constant: None }.known()
    }

    /// The same metal, brushed.
    pub fn brushed(self, grain: Grain) -> Metal {
        Metal { grain, ..self }.known()
    }

    /// With what is the same everywhere worked out.
    fn known(self) -> Metal {
        let constant =
            (!self.varies()).then(|| self.classic(Textures::default().evaluator(&TextureContext::default())));
        Metal { constant, ..self }
    }

    fn varies(&self) -> bool {
        self.roughness.varies()
            || self.grain.varies()
            || matches!(&self.substance, Substance::Color(color) if color.varies())
    }

    fn facets(&self, evaluator: TextureEvaluator<'_>) -> Microfacets {
        let roughness = self.roughness.at(evaluator);
        self.grain.facets(self.shape, roughness * roughness, evaluator)
    }

    fn classic(&self, evaluator: TextureEvaluator<'_>) -> Phong {
        let f0 = match &self.substance {
            Substance::Measured(metal) => Spectrum::from(Vec3::from(metal.rgb())),
            Substance::Color(color) => evaluator.at.tinted(color.rgb(evaluator), &Wavelengths::RGB),
        };
        Phong { specular: f0, reflective: f0, exponent: self.facets(evaluator).exponent(), ..Phong::BLACK }
    }
}

impl Material for Metal {
    fn is_finite(&self) -> bool {
        true
    }

    fn textures(&self) -> Vec<AnyTexture<'_>> {
        let [anisotropy, rotation] = self.grain.textures();
        let mut textures = vec![self.roughness.into(), anisotropy.into(), rotation.into()];
        if let Substance::Color(color) = &self.substance {
            textures.push(color.into());
        }
        textures
    }

    fn phong(&self, appearance: &Appearance, at: &TextureContext) -> Phong {
        let here = || self.classic(appearance.textures.evaluator(at));
        self.constant.filter(|_| at.tint.is_none()).unwrap_or_else(here)
    }

    fn constant(&self) -> Option<&Phong> {
        self.constant.as_ref()
    }

    fn needs_uv(&self, _appearance: &Appearance) -> bool {
        self.constant.is_none()
    }

    fn orientation(&self, appearance: &Appearance, at: &ShadingPoint<'_>) -> Orientation {
        self.grain.orientation(appearance.textures.evaluator(at.context))
    }

    fn is_oriented(&self, _appearance: &Appearance) -> bool {
        self.grain.exists()
    }

    fn bsdf<'a>(&'a self, appearance: &'a Appearance, at: &ShadingPoint<'_>) -> Bsdf<'a> {
        let evaluator = appearance.textures.evaluator(at.context);
        let fresnel = match &self.substance {
            Substance::Measured(metal) => {
                let (eta, k) = metal.at(at.wavelengths);
                let outside = 1.0 / at.eta_outside;
                MetalFresnel::Complex { eta: eta * outside, k: k * outside }
            }
            Substance::Color(color) => {
                let f0 = at.context.tinted(color.at(evaluator, at.wavelengths), at.wavelengths);
                MetalFresnel::Tinted { f0, f82: Spectrum::WHITE }
            }
        };
        Bsdf::Conductor(Conductor { fresnel, microfacets: self.facets(evaluator) })
    }
}
