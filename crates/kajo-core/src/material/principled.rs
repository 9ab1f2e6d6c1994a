//! One material for most things: fibres over varnish over a mixture of pigment, metal and glass.
//!
//! The parameters are the core of OpenPBR 1.1; [`Principled`](crate::bsdf::Principled) has the equations. At each
//! hit the base is a metal with probability `metalness`, else glass with probability `transmission`, else pigment.
//! Roughnesses are as they look: facets have their squares.
//!
//! Scene: `Principled { color 0.8 0.1 0.05  roughness 0.3  coat 1 }`

use kajo_color::{Reflectance, Spectrum};
use kajo_math::{Vec2, Vec3};

use super::{Appearance, Interior, Materials, ShadingPoint};
use crate::bsdf::{Base, Bsdf, Microfacets, Phong, Principled, microfacet::Shape};
use crate::texture::Textures;

/// What a layered surface is like; shares and roughnesses are in [0, 1], colours in linear RGB.
#[derive(Clone, Debug)]
pub struct Layers {
    /// Albedo of the pigment, of the metal straight on, and factor of light that enters or leaves the glass.
    pub color: Reflectance,
    /// Factor of glossy reflection.
    pub specular_color: Reflectance,
    /// Share of metal.
    pub metalness: f32,
    /// Share of glass in what is not metal.
    pub transmission: f32,
    /// Of the glossy surface.
    pub roughness: f32,
    /// Of the pigment.
    pub diffuse_roughness: f32,
    /// Index of refraction of pigment and glass.
    pub eta: f32,
    /// Share of varnish.
    pub coat: f32,
    /// Light that varnish lets through in and out again.
    pub coat_color: Reflectance,
    /// Of the varnish.
    pub coat_roughness: f32,
    /// Index of refraction of the varnish.
    pub coat_eta: f32,
    /// Share of fibres.
    pub fuzz: f32,
    /// Of the fibres.
    pub fuzz_color: Reflectance,
    /// How far fibres stand up.
    pub fuzz_roughness: f32,
    /// The body of the higher priority is there where several overlap.
    pub priority: i32,
}

/// A layered material.
#[derive(Clone, Debug)]
pub struct LayeredMaterial {
    layers: Layers,
    classic: Phong,
}

impl From<Layers> for LayeredMaterial {
    fn from(layers: Layers) -> LayeredMaterial {
        let color = Spectrum::from(Vec3::from(layers.color.rgb()));
        let (metal, glass) = (layers.metalness, (1.0 - layers.metalness) * layers.transmission);
        let alpha = layers.roughness * layers.roughness;
        let gloss = Spectrum::rgb(0.04, 0.04, 0.04) * (1.0 - metal);
        let classic = Phong {
            ambient: color * (1.0 - metal - glass),
            diffuse: color * (1.0 - metal - glass),
            specular: color * metal + gloss,
            reflective: color * metal,
            transparent: color * glass,
            exponent: Microfacets::new(Shape::Ggx, alpha).exponent(),
            eta: layers.eta,
            ..Phong::BLACK
        };
        LayeredMaterial { layers, classic }
    }
}

impl Appearance for LayeredMaterial {
    fn phong(&self, _materials: &Materials, _textures: &Textures, _p: Vec3) -> Phong {
        self.classic
    }

    fn constant(&self) -> Option<&Phong> {
        Some(&self.classic)
    }

    fn is_mixture(&self) -> bool {
        true
    }

    fn may_transmit(&self, _materials: &Materials) -> bool {
        self.layers.metalness < 1.0 && self.layers.transmission > 0.0
    }

    fn bsdf(&self, _materials: &Materials, _textures: &Textures, at: &ShadingPoint<'_>) -> Bsdf {
        let layers = &self.layers;
        let glass = layers.metalness + (1.0 - layers.metalness) * layers.transmission;
        let base = match at.u {
            u if u < layers.metalness => Base::Metal,
            u if u < glass => Base::Glass,
            _ => Base::Diffuse,
        };
        let eta = layers.eta / at.eta_outside;
        Bsdf::Principled(Principled {
            base,
            color: layers.color.at(at.wavelengths),
            specular_color: layers.specular_color.at(at.wavelengths),
            diffuse_roughness: layers.diffuse_roughness,
            alpha: Vec2::splat(layers.roughness * layers.roughness),
            eta: if base == Base::Glass { eta } else { eta.max(1.0) },
            coat: layers.coat,
            coat_color: layers.coat_color.at(at.wavelengths),
            coat_alpha: layers.coat_roughness * layers.coat_roughness,
            coat_eta: (layers.coat_eta / at.eta_outside).max(1.0),
            fuzz: layers.fuzz,
            fuzz_color: layers.fuzz_color.at(at.wavelengths),
            fuzz_roughness: layers.fuzz_roughness,
        })
    }

    fn interior(&self, _: &Materials, _: &Textures, _: &ShadingPoint<'_>) -> Option<Interior> {
        let Layers { eta, priority, .. } = self.layers;
        let transmits = self.layers.metalness < 1.0 && self.layers.transmission > 0.0;
        transmits.then_some(Interior { eta, is_dispersive: false, absorption: Spectrum::BLACK, priority })
    }
}
