//! One material for most things: fuzz over coat over a mixture of diffuse base, metal and glass.
//!
//! The parameters are the core of OpenPBR 1.1; [`Principled`](crate::bsdf::Principled) has the equations. At each
//! hit the base is a metal with probability `metalness`, else glass with probability `transmission`, else diffuse base.
//! Roughnesses are as they look: facets have their squares. Where the surface is thin, its glass is a pane that
//! light crosses without being bent, or a frosted one, and of which `color` is what one crossing lets through.
//!
//! Scene: `Principled { color 0.8 0.1 0.05  roughness 0.3  coat 1 }`

use kajo_color::{Dispersion, Reflectance, Spectrum, Unbounded, Wavelengths};
use kajo_math::{Vec2, Vec3, fmath};

use super::{
    Appearance, Grain, Interior, Material, Orientation, PhongMaterial, ShadingPoint, may_be_polished,
};
use crate::bsdf::{
    self, Base, Bsdf, DiffuseNormal, Microfacets, Phong, Principled, ThinDielectric, microfacet::Shape,
};
use crate::texture::{Paint, Share, SurfaceUv, TextureContext};

/// The least light that a pane lets through, black ones too.
const LEAST_PASSED: f32 = 1e-30;

/// How the gloss of a diffuse base differs from that of its index of refraction; see [`bsdf::Specular`].
#[derive(Clone, Debug)]
pub enum Specular {
    /// A factor at every angle.
    Factor(Paint),
    /// A factor at normal incidence.
    F0 {
        /// The factor, over the scale.
        factor: Paint,
        /// What that is multiplied by, at least 1.
        scale: f32,
        /// Another factor at every angle.
        weight: Share,
    },
}

impl Default for Specular {
    /// No difference.
    fn default() -> Specular {
        Specular::Factor(Reflectance::constant(1.0).into())
    }
}

impl Specular {
    fn varies(&self) -> bool {
        match self {
            Specular::Factor(color) => color.varies(),
            Specular::F0 { factor, weight, .. } => factor.varies() || weight.varies(),
        }
    }

    fn is_finite(&self) -> bool {
        match self {
            Specular::Factor(color) => color.is_finite(),
            Specular::F0 { factor, scale, weight } => {
                factor.is_finite() && scale.is_finite() && weight.is_finite()
            }
        }
    }

    fn at(&self, uv: SurfaceUv, wavelengths: &Wavelengths) -> bsdf::Specular {
        match self {
            Specular::Factor(color) => bsdf::Specular::Factor(color.at(uv, wavelengths)),
            &Specular::F0 { ref factor, scale, ref weight } => bsdf::Specular::F0 {
                factor: factor.at(uv, wavelengths) * scale,
                // Of the colour, so that it does not depend on the wavelengths of a path.
                largest: factor.rgb(uv).max_lane() * scale,
                weight: weight.at(uv),
            },
        }
    }
}

/// What a layered surface is like; shares and roughnesses are in [0, 1], colours in linear RGB.
#[derive(Clone, Debug)]
pub struct Layers {
    /// Albedo of the diffuse base, of the metal straight on, and factor of light that enters or leaves the glass.
    pub color: Paint,
    /// What differs in glossy reflection.
    pub specular: Specular,
    /// Share of metal.
    pub metalness: Share,
    /// Share of glass in what is not metal.
    pub transmission: Share,
    /// Absorption of the glass per unit length in linear RGB.
    pub absorption: [f32; 3],
    /// Whether the glass is a pane with nothing inside.
    pub thin: bool,
    /// Of the glossy surface.
    pub roughness: Share,
    /// Which way the facets of the glossy surface run.
    pub grain: Grain,
    /// Of the diffuse base.
    pub diffuse_roughness: Share,
    /// Index of refraction of diffuse base and glass.
    pub eta: f32,
    /// That of the glass where it differs between wavelengths.
    pub dispersion: Option<Dispersion>,
    /// Amount of coat, in [0, 1].
    pub coat: Share,
    /// Light that the coat lets through in and out again.
    pub coat_color: Paint,
    /// Of the coat.
    pub coat_roughness: Share,
    /// Index of refraction of the coat.
    pub coat_eta: f32,
    /// Amount of fuzz, in [0, 1].
    pub fuzz: Share,
    /// Of the fuzz.
    pub fuzz_color: Paint,
    /// How far its fibers stand up.
    pub fuzz_roughness: Share,
    /// The body of the higher priority is there where several overlap.
    pub priority: i32,
}

impl Default for Layers {
    /// A grey diffuse base under a gloss.
    fn default() -> Layers {
        let grey = |value: f32| Paint::from(Reflectance::constant(value));
        Layers {
            color: grey(0.8),
            specular: Specular::default(),
            metalness: 0.0.into(),
            transmission: 0.0.into(),
            absorption: [0.0; 3],
            thin: false,
            roughness: 0.3.into(),
            grain: Grain::default(),
            diffuse_roughness: 0.0.into(),
            eta: 1.5,
            dispersion: None,
            coat: 0.0.into(),
            coat_color: grey(1.0),
            coat_roughness: 0.0.into(),
            coat_eta: 1.6,
            fuzz: 0.0.into(),
            fuzz_color: grey(1.0),
            fuzz_roughness: 0.5.into(),
            priority: 0,
        }
    }
}

/// A layered material.
#[derive(Clone, Debug)]
pub struct LayeredMaterial {
    layers: Layers,
    absorption: Unbounded,
    /// What the classic integrator sees in place of these.
    look: Option<Box<PhongMaterial>>,
    /// Where it is the same everywhere.
    constant: Option<Phong>,
}

impl From<Layers> for LayeredMaterial {
    fn from(layers: Layers) -> LayeredMaterial {
        let constant = (!layers.vary()).then(|| layers.classic(&TextureContext::default()));
        let absorption = Unbounded::from_rgb(layers.absorption);
        LayeredMaterial { layers, absorption, look: None, constant }
    }
}

impl LayeredMaterial {
    /// The same material, which looks like another one to the classic integrator.
    pub fn with_look(self, look: PhongMaterial) -> LayeredMaterial {
        LayeredMaterial { look: Some(Box::new(look)), ..self }
    }
}

impl Layers {
    /// All colours but that of the gloss.
    fn colors(&self) -> [&Paint; 3] {
        [&self.color, &self.coat_color, &self.fuzz_color]
    }

    /// All numbers that may be pictures, but for those of gloss and grain.
    fn shares(&self) -> [&Share; 8] {
        [
            &self.metalness,
            &self.transmission,
            &self.coat,
            &self.fuzz,
            &self.roughness,
            &self.diffuse_roughness,
            &self.coat_roughness,
            &self.fuzz_roughness,
        ]
    }

    fn vary(&self) -> bool {
        self.colors().into_iter().any(Paint::varies)
            || self.shares().into_iter().any(Share::varies)
            || self.specular.varies()
            || self.grain.varies()
    }

    fn classic(&self, at: &TextureContext) -> Phong {
        let uv = at.uv;
        let color = at.tinted(self.color.rgb(uv), &Wavelengths::RGB);
        let metal = self.metalness.at(uv);
        let glass = (1.0 - metal) * self.transmission.at(uv);
        let gloss = Spectrum::rgb(0.04, 0.04, 0.04) * (1.0 - metal);
        Phong {
            ambient: color * (1.0 - metal - glass),
            diffuse: color * (1.0 - metal - glass),
            specular: color * metal + gloss,
            reflective: color * metal,
            transparent: color * glass,
            exponent: self.facets(uv).exponent(),
            absorption: Vec3::from(self.absorption).into(),
            eta: if self.thin { 1.0 } else { self.eta },
        }
    }

    /// The facets of the glossy surface.
    fn facets(&self, uv: SurfaceUv) -> Microfacets {
        self.grain.facets(Shape::Ggx, squared(&self.roughness, uv), uv)
    }

    fn color_at(&self, at: &ShadingPoint<'_>) -> Spectrum {
        at.context.tinted(self.color.at(at.context.uv, at.wavelengths), at.wavelengths)
    }

    /// The index of refraction of the glass at the first wavelength.
    fn glass_eta(&self, wavelengths: &Wavelengths) -> f32 {
        self.dispersion.as_ref().map_or(self.eta, |dispersion| dispersion.at(wavelengths)[0])
    }

    /// The glass of a thin surface.
    fn pane(&self, at: &ShadingPoint<'_>) -> ThinDielectric {
        let depth = |passed: f32| -fmath::ln(passed.max(LEAST_PASSED));
        let optical_depth = self.color_at(at).map(depth);
        let microfacets = self.facets(at.context.uv);
        ThinDielectric { eta: self.eta / at.eta_outside, optical_depth, microfacets }
    }

    /// Whether light enters the material anywhere.
    fn transmit(&self) -> bool {
        self.metalness.range()[0] < 1.0 && self.transmission.range()[1] > 0.0
    }
}

/// The facets' `α` of a roughness.
#[inline]
fn squared(roughness: &Share, uv: SurfaceUv) -> f32 {
    let roughness = roughness.at(uv);
    roughness * roughness
}

impl Material for LayeredMaterial {
    fn is_finite(&self) -> bool {
        let layers = &self.layers;
        let numbers = [layers.eta, layers.coat_eta].into_iter().chain(layers.absorption);
        let look = self.look.as_ref().is_none_or(|look| look.is_finite());
        look && numbers.into_iter().all(f32::is_finite)
            && layers.colors().into_iter().all(Paint::is_finite)
            && layers.shares().into_iter().all(Share::is_finite)
            && layers.specular.is_finite()
            && layers.grain.is_finite()
    }

    fn phong(&self, appearance: &Appearance, at: &TextureContext) -> Phong {
        if let Some(look) = &self.look {
            return look.phong(appearance, at);
        }
        self.constant.filter(|_| at.tint.is_none()).unwrap_or_else(|| self.layers.classic(at))
    }

    fn constant(&self) -> Option<&Phong> {
        self.look.as_ref().map_or(self.constant.as_ref(), |look| look.constant())
    }

    fn needs_uv(&self, _appearance: &Appearance) -> bool {
        self.constant.is_none()
    }

    fn orientation(&self, _: &Appearance, at: &ShadingPoint<'_>) -> Orientation {
        self.layers.grain.orientation(at.context.uv)
    }

    fn is_oriented(&self, _appearance: &Appearance) -> bool {
        self.layers.grain.exists()
    }

    fn is_mixture(&self) -> bool {
        true
    }

    fn may_transmit(&self, _appearance: &Appearance) -> bool {
        self.layers.transmit()
    }

    fn bsdf(&self, _appearance: &Appearance, at: &ShadingPoint<'_>) -> Bsdf {
        let layers = &self.layers;
        let (uv, wavelengths) = (at.context.uv, at.wavelengths);
        let metal = layers.metalness.at(uv);
        let glass = metal + (1.0 - metal) * layers.transmission.at(uv);
        let base = match at.u {
            u if u < metal => Base::Metal,
            u if u < glass => Base::Glass,
            _ => Base::Diffuse,
        };
        let eta = match base {
            Base::Glass => layers.glass_eta(wavelengths),
            Base::Diffuse | Base::Metal => layers.eta,
        };
        let eta = eta / at.eta_outside;
        if layers.thin && base == Base::Glass {
            return Bsdf::ThinDielectric(layers.pane(at));
        }
        let facets = layers.facets(uv);
        Bsdf::Principled(Principled {
            base,
            color: layers.color_at(at),
            specular: layers.specular.at(uv, wavelengths),
            diffuse_roughness: layers.diffuse_roughness.at(uv),
            alpha: Vec2::new(facets.alpha_x, facets.alpha_y),
            eta: if base == Base::Glass { eta } else { eta.max(1.0) },
            coat: layers.coat.at(uv),
            coat_color: layers.coat_color.at(uv, wavelengths),
            coat_alpha: squared(&layers.coat_roughness, uv),
            coat_eta: (layers.coat_eta / at.eta_outside).max(1.0),
            fuzz: layers.fuzz.at(uv),
            fuzz_color: layers.fuzz_color.at(uv, wavelengths),
            fuzz_roughness: layers.fuzz_roughness.at(uv),
            diffuse_normal: DiffuseNormal::SAME,
        })
    }

    fn passage(&self, _: &Appearance, at: &ShadingPoint<'_>, cos: f32) -> Spectrum {
        let (layers, uv) = (&self.layers, at.context.uv);
        let glass = (1.0 - layers.metalness.at(uv)) * layers.transmission.at(uv);
        if !layers.thin || glass == 0.0 {
            return Spectrum::BLACK;
        }
        layers.pane(at).passage(cos) * glass
    }

    fn has_passages(&self, _appearance: &Appearance) -> bool {
        self.layers.thin && self.layers.transmit() && may_be_polished(&self.layers.roughness)
    }

    fn interior(&self, _: &Appearance, at: &ShadingPoint<'_>) -> Option<Interior> {
        let Layers { priority, thin, ref dispersion, .. } = self.layers;
        (self.layers.transmit() && !thin).then(|| Interior {
            eta: self.layers.glass_eta(at.wavelengths),
            is_dispersive: dispersion.as_ref().is_some_and(Dispersion::is_dispersive),
            absorption: self.absorption.at(at.wavelengths),
            priority,
        })
    }
}
