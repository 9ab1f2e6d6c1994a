//! One material for most things: fuzz over coat over a mixture of diffuse base, metal and glass.
//!
//! The parameters are the core of OpenPBR 1.1; [`Principled`](crate::bsdf::Principled) has the equations. At each
//! hit the base is a metal with probability `metalness`, else glass with probability `transmission`, else diffuse base.
//! Roughnesses are as they look: facets have their squares. Where the surface is thin, its glass is a pane that
//! light crosses without being bent, or a frosted one, and of which `color` is what one crossing lets through. A share of the
//! diffuse base may be a body instead, [`SubsurfaceBody`], which light enters and is scattered in.
//!
//! Scene: `Principled { color 0.8 0.1 0.05  roughness 0.3  coat 1 }`

use kajo_color::{Dispersion, Reflectance, Spectrum, Unbounded, Wavelengths};
use kajo_math::{Vec2, Vec3, fmath};

use super::{
    Appearance, Grain, Interior, Material, Orientation, PhongMaterial, ShadingPoint, may_be_polished,
};
use crate::bsdf::{
    self, Base, Bsdf, DiffuseNormal, Microfacets, Phong, Principled, Subsurface, ThinDielectric,
    microfacet::NormalDistribution,
};
use crate::medium::MediumId;
use crate::texture::{AnyTexture, ColorTexture, FloatTexture, TextureContext, TextureEvaluator, Textures};

/// The least light that a pane lets through, black ones too.
const LEAST_PASSED: f32 = 1e-30;

/// How the gloss of a diffuse base differs from that of its index of refraction; see [`bsdf::Specular`].
#[derive(Clone, Debug)]
pub enum SpecularLayer {
    /// A factor at every angle.
    Factor(ColorTexture),
    /// A factor at normal incidence.
    F0 {
        /// The factor, over the scale.
        factor: ColorTexture,
        /// What that is multiplied by, at least 1.
        scale: f32,
        /// Another factor at every angle.
        weight: FloatTexture,
    },
}

impl Default for SpecularLayer {
    /// No difference.
    fn default() -> SpecularLayer {
        SpecularLayer::Factor(Reflectance::constant(1.0).into())
    }
}

impl SpecularLayer {
    fn varies(&self) -> bool {
        match self {
            SpecularLayer::Factor(color) => color.varies(),
            SpecularLayer::F0 { factor, weight, .. } => factor.varies() || weight.varies(),
        }
    }

    /// Its textures; whether what else it has is finite.
    fn textures(&self) -> (Vec<AnyTexture<'_>>, bool) {
        match self {
            SpecularLayer::Factor(color) => (vec![color.into()], true),
            SpecularLayer::F0 { factor, scale, weight } => {
                (vec![factor.into(), (*weight).into()], scale.is_finite())
            }
        }
    }

    fn at(&self, evaluator: TextureEvaluator<'_>, wavelengths: &Wavelengths) -> bsdf::Specular {
        match self {
            SpecularLayer::Factor(color) => bsdf::Specular::Factor(color.at(evaluator, wavelengths)),
            &SpecularLayer::F0 { ref factor, scale, ref weight } => bsdf::Specular::F0 {
                factor: factor.at(evaluator, wavelengths) * scale,
                // Of the colour, so that it does not depend on the wavelengths of a path.
                largest: factor.rgb(evaluator).max_lane() * scale,
                weight: weight.at(evaluator),
            },
        }
    }
}

/// What is below a surface that light enters in the place of its diffuse base.
///
/// Its medium decides the colour of the body; [`crate::medium::Coefficients::subsurface`] has the one of a given colour. Where the colour
/// differs from place to place the medium is white, and light takes the square root of the colour on its way in and out.
#[derive(Clone, Copy, Debug)]
pub struct SubsurfaceBody {
    /// Share of the body in the diffuse base.
    pub share: FloatTexture,
    /// What the body is filled with.
    pub medium: MediumId,
    /// Whether the surface has the colour in the place of the medium.
    pub is_tinted: bool,
}

/// What a layered surface is like; shares and roughnesses are in [0, 1], colours in linear RGB.
#[derive(Clone, Debug)]
pub struct Layers {
    /// Albedo of the diffuse base, of the metal straight on, and factor of light that enters or leaves the glass.
    pub color: ColorTexture,
    /// What differs in glossy reflection.
    pub specular: SpecularLayer,
    /// Share of metal.
    pub metalness: FloatTexture,
    /// Share of glass in what is not metal.
    pub transmission: FloatTexture,
    /// Absorption of the glass per unit length in linear RGB.
    pub absorption: [f32; 3],
    /// Whether the glass is a pane with nothing inside.
    pub thin: bool,
    /// Of the glossy surface.
    pub roughness: FloatTexture,
    /// Which way the facets of the glossy surface run.
    pub grain: Grain,
    /// Of the diffuse base.
    pub diffuse_roughness: FloatTexture,
    /// Index of refraction of diffuse base and glass; that of a body is the same everywhere.
    pub eta: FloatTexture,
    /// That of the glass where it differs between wavelengths.
    pub dispersion: Option<Dispersion>,
    /// Amount of coat, in [0, 1].
    pub coat: FloatTexture,
    /// Light that the coat lets through in and out again.
    pub coat_color: ColorTexture,
    /// Of the coat.
    pub coat_roughness: FloatTexture,
    /// Index of refraction of the coat.
    pub coat_eta: FloatTexture,
    /// Amount of fuzz, in [0, 1].
    pub fuzz: FloatTexture,
    /// Of the fuzz.
    pub fuzz_color: ColorTexture,
    /// How far its fibers stand up.
    pub fuzz_roughness: FloatTexture,
    /// The body of the higher priority is there where several overlap.
    pub priority: i32,
    /// What scatters light inside of the glass.
    pub medium: Option<MediumId>,
    /// What light enters in the place of the diffuse base. There is no other inside then: neither `transmission` nor `medium` count.
    pub subsurface: Option<SubsurfaceBody>,
}

impl Default for Layers {
    /// A grey diffuse base under a gloss.
    fn default() -> Layers {
        let grey = |value: f32| ColorTexture::from(Reflectance::constant(value));
        Layers {
            color: grey(0.8),
            specular: SpecularLayer::default(),
            metalness: 0.0.into(),
            transmission: 0.0.into(),
            absorption: [0.0; 3],
            thin: false,
            roughness: 0.3.into(),
            grain: Grain::default(),
            diffuse_roughness: 0.0.into(),
            eta: 1.5.into(),
            dispersion: None,
            coat: 0.0.into(),
            coat_color: grey(1.0),
            coat_roughness: 0.0.into(),
            coat_eta: 1.6.into(),
            fuzz: 0.0.into(),
            fuzz_color: grey(1.0),
            fuzz_roughness: 0.5.into(),
            priority: 0,
            medium: None,
            subsurface: None,
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
        let constant = (!layers.vary())
            .then(|| layers.classic(Textures::default().evaluator(&TextureContext::default())));
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
    fn colors(&self) -> [&ColorTexture; 3] {
        [&self.color, &self.coat_color, &self.fuzz_color]
    }

    /// All numbers but those of gloss and grain.
    fn numbers(&self) -> [FloatTexture; 10] {
        [
            self.metalness,
            self.transmission,
            self.coat,
            self.fuzz,
            self.roughness,
            self.diffuse_roughness,
            self.coat_roughness,
            self.fuzz_roughness,
            self.eta,
            self.coat_eta,
        ]
    }

    fn vary(&self) -> bool {
        self.colors().into_iter().any(ColorTexture::varies)
            || self.numbers().into_iter().any(FloatTexture::varies)
            || self.specular.varies()
            || self.grain.varies()
            || self.subsurface.is_some_and(|body| body.share.varies())
    }

    fn classic(&self, evaluator: TextureEvaluator<'_>) -> Phong {
        let color = evaluator.at.tinted(self.color.rgb(evaluator), &Wavelengths::RGB);
        let metal = self.metalness.at(evaluator);
        let glass = (1.0 - metal) * self.transmission.at(evaluator);
        let gloss = Spectrum::rgb(0.04, 0.04, 0.04) * (1.0 - metal);
        Phong {
            ambient: color * (1.0 - metal - glass),
            diffuse: color * (1.0 - metal - glass),
            specular: color * metal + gloss,
            reflective: color * metal,
            transparent: color * glass,
            exponent: self.facets(evaluator).exponent(),
            absorption: Vec3::from(self.absorption).into(),
            eta: if self.thin { 1.0 } else { self.eta.at(evaluator) },
        }
    }

    /// The facets of the glossy surface.
    fn facets(&self, evaluator: TextureEvaluator<'_>) -> Microfacets {
        self.grain.facets(NormalDistribution::Ggx, squared(self.roughness, evaluator), evaluator)
    }

    /// The layers over a base.
    ///
    /// * `eta`: index of refraction of the base over that of the medium above
    fn above(
        &self,
        base: Base,
        eta: f32,
        evaluator: TextureEvaluator<'_>,
        at: &ShadingPoint<'_>,
    ) -> Principled {
        let facets = self.facets(evaluator);
        Principled {
            base,
            color: self.color_at(evaluator, at.wavelengths),
            specular: self.specular.at(evaluator, at.wavelengths),
            diffuse_roughness: self.diffuse_roughness.at(evaluator),
            alpha: Vec2::new(facets.alpha_x, facets.alpha_y),
            eta: if base == Base::Glass { eta } else { eta.max(1.0) },
            coat: self.coat.at(evaluator),
            coat_color: self.coat_color.at(evaluator, at.wavelengths),
            coat_alpha: squared(self.coat_roughness, evaluator),
            coat_eta: (self.coat_eta.at(evaluator) / at.eta_outside).max(1.0),
            fuzz: self.fuzz.at(evaluator),
            fuzz_color: self.fuzz_color.at(evaluator, at.wavelengths),
            fuzz_roughness: self.fuzz_roughness.at(evaluator),
            diffuse_normal: DiffuseNormal::SAME,
        }
    }

    fn color_at(&self, evaluator: TextureEvaluator<'_>, wavelengths: &Wavelengths) -> Spectrum {
        evaluator.at.tinted(self.color.at(evaluator, wavelengths), wavelengths)
    }

    /// The index of refraction of the glass at the first wavelength.
    fn glass_eta(&self, evaluator: TextureEvaluator<'_>, wavelengths: &Wavelengths) -> f32 {
        match &self.dispersion {
            None => self.eta.at(evaluator),
            Some(dispersion) => dispersion.at(wavelengths)[0],
        }
    }

    /// The glass of a thin surface.
    fn pane(&self, evaluator: TextureEvaluator<'_>, at: &ShadingPoint<'_>) -> ThinDielectric {
        let depth = |passed: f32| -fmath::ln(passed.max(LEAST_PASSED));
        let optical_depth = self.color_at(evaluator, at.wavelengths).map(depth);
        let microfacets = self.facets(evaluator);
        ThinDielectric { eta: self.eta.at(evaluator) / at.eta_outside, optical_depth, microfacets }
    }

    /// Whether light enters its glass anywhere.
    fn transmit(&self) -> bool {
        self.subsurface.is_none()
            && self.metalness.share_range()[0] < 1.0
            && self.transmission.share_range()[1] > 0.0
    }
}

/// The facets' `α` of a roughness.
#[inline]
fn squared(roughness: FloatTexture, evaluator: TextureEvaluator<'_>) -> f32 {
    let roughness = roughness.at(evaluator);
    roughness * roughness
}

impl Material for LayeredMaterial {
    fn is_finite(&self) -> bool {
        let layers = &self.layers;
        let look = self.look.as_ref().is_none_or(|look| look.is_finite());
        look && layers.absorption.iter().all(|v| v.is_finite()) && layers.specular.textures().1
    }

    fn textures(&self) -> Vec<AnyTexture<'_>> {
        let layers = &self.layers;
        let numbers = layers.numbers().into_iter().chain(layers.grain.textures());
        let mut textures: Vec<AnyTexture<'_>> = numbers.map(AnyTexture::from).collect();
        textures.extend(layers.colors().map(AnyTexture::from));
        textures.extend(layers.specular.textures().0);
        textures.extend(layers.subsurface.map(|body| AnyTexture::from(body.share)));
        textures.extend(self.look.iter().flat_map(|look| look.textures()));
        textures
    }

    fn phong(&self, appearance: &Appearance, at: &TextureContext) -> Phong {
        if let Some(look) = &self.look {
            return look.phong(appearance, at);
        }
        let here = || self.layers.classic(appearance.textures.evaluator(at));
        self.constant.filter(|_| at.tint.is_none()).unwrap_or_else(here)
    }

    fn constant(&self) -> Option<&Phong> {
        self.look.as_ref().map_or(self.constant.as_ref(), |look| look.constant())
    }

    fn needs_uv(&self, _appearance: &Appearance) -> bool {
        self.constant.is_none()
    }

    fn orientation(&self, appearance: &Appearance, at: &ShadingPoint<'_>) -> Orientation {
        self.layers.grain.orientation(appearance.textures.evaluator(at.context))
    }

    fn is_oriented(&self, _appearance: &Appearance) -> bool {
        self.layers.grain.exists()
    }

    fn is_mixture(&self) -> bool {
        true
    }

    fn may_transmit(&self, _appearance: &Appearance) -> bool {
        self.layers.transmit() || self.layers.subsurface.is_some()
    }

    fn bsdf<'a>(&'a self, appearance: &'a Appearance, at: &ShadingPoint<'_>) -> Bsdf<'a> {
        let layers = &self.layers;
        let (evaluator, wavelengths) = (appearance.textures.evaluator(at.context), at.wavelengths);
        let metal = layers.metalness.at(evaluator);
        if let Some(body) = layers.subsurface.filter(|_| at.u >= metal) {
            let above = layers.above(Base::Diffuse, layers.eta.at(evaluator) / at.eta_outside, evaluator, at);
            return Bsdf::Subsurface(Subsurface::below(&above, body.share.at(evaluator), body.is_tinted));
        }
        let glass = metal + (1.0 - metal) * layers.transmission.at(evaluator);
        let base = match at.u {
            u if u < metal => Base::Metal,
            u if u < glass => Base::Glass,
            _ => Base::Diffuse,
        };
        if layers.thin && base == Base::Glass {
            return Bsdf::ThinDielectric(layers.pane(evaluator, at));
        }
        let eta = match base {
            Base::Glass => layers.glass_eta(evaluator, wavelengths),
            Base::Diffuse | Base::Metal => layers.eta.at(evaluator),
        };
        Bsdf::Principled(layers.above(base, eta / at.eta_outside, evaluator, at))
    }

    fn passage(&self, appearance: &Appearance, at: &ShadingPoint<'_>, cos: f32) -> Spectrum {
        let (layers, evaluator) = (&self.layers, appearance.textures.evaluator(at.context));
        let glass = (1.0 - layers.metalness.at(evaluator)) * layers.transmission.at(evaluator);
        if !layers.thin || glass == 0.0 {
            return Spectrum::BLACK;
        }
        layers.pane(evaluator, at).passage(cos) * glass
    }

    fn has_passages(&self, _appearance: &Appearance) -> bool {
        self.layers.thin && self.layers.transmit() && may_be_polished(self.layers.roughness)
    }

    fn interior(&self, appearance: &Appearance, at: &ShadingPoint<'_>) -> Option<Interior> {
        let Layers { priority, thin, medium, ref dispersion, subsurface, .. } = self.layers;
        if let Some(body) = subsurface {
            let (absorption, medium) = (Spectrum::BLACK, Some(body.medium));
            return Some(Interior {
                eta: None,
                is_dispersive: false,
                absorption,
                priority,
                medium,
                adds: false,
            });
        }
        (self.layers.transmit() && !thin).then(|| Interior {
            eta: Some(self.layers.glass_eta(appearance.textures.evaluator(at.context), at.wavelengths)),
            is_dispersive: dispersion.as_ref().is_some_and(Dispersion::is_dispersive),
            absorption: self.absorption.at(at.wavelengths),
            priority,
            medium,
            adds: false,
        })
    }

    fn medium(&self) -> Option<MediumId> {
        let of_glass = self.layers.medium.filter(|_| self.layers.transmit() && !self.layers.thin);
        self.layers.subsurface.map(|body| body.medium).or(of_glass)
    }
}
