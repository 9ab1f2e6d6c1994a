//! The light that surfaces give: the same everywhere, or different from place to place behind a slide, between holes, in a mixture of
//! which a part gives light.
//!
//! The radiance is a sum over the materials that the surface is made of, each times the factors of its place:
//!
//! ```text
//! L(p) = Σ_i  L_i Π_k f_ik(p)
//! ```
//!
//! Which patch of a surface is asked for light, and which of its points, goes by what is on it: see `light/emission_density.rs`.

use std::sync::Arc;

use kajo_color::{Emission, Spectrum, Wavelengths};
use kajo_math::Vec3;

mod orbiting_gas;

pub use orbiting_gas::OrbitingGas;

use crate::ids::LightGroup;
use crate::light::Sides;
use crate::texture::{
    AnyTexture, ColorTexture, FloatTexture, TextureContext, TextureDetail, TextureEvaluator, Textures,
    VertexOpacity,
};

/// The light that the surfaces of a material give; none by default.
#[derive(Clone, Debug, Default)]
pub struct SurfaceEmission {
    /// That of several materials where it mixes them; none is black.
    terms: Vec<EmissionTerm>,
    /// The sides that it leaves the surface on.
    pub sides: Sides,
    /// The group of lights that it is seen in.
    pub group: LightGroup,
}

impl From<Emission> for SurfaceEmission {
    /// The same radiance everywhere, on both sides.
    fn from(emission: Emission) -> SurfaceEmission {
        SurfaceEmission::of_term(EmissionTerm {
            emission,
            gas: None,
            colors: Vec::new(),
            amounts: Vec::new(),
        })
    }
}

impl From<OrbitingGas> for SurfaceEmission {
    /// The light of gas that goes around a black hole, on both sides.
    fn from(gas: OrbitingGas) -> SurfaceEmission {
        let (emission, gas) = (gas.mean(), Some(Arc::new(gas)));
        SurfaceEmission::of_term(EmissionTerm { emission, gas, colors: Vec::new(), amounts: Vec::new() })
    }
}

impl SurfaceEmission {
    fn of_term(term: EmissionTerm) -> SurfaceEmission {
        SurfaceEmission { terms: vec![term], ..SurfaceEmission::default() }.without_black()
    }

    /// The light where it leaves the surface on these sides only.
    pub fn on(self, sides: Sides) -> SurfaceEmission {
        SurfaceEmission { sides, ..self }
    }

    /// The light among that of a group.
    pub fn in_group(self, group: LightGroup) -> SurfaceEmission {
        SurfaceEmission { group, ..self }
    }

    /// The light as it shines through a texture, as through a slide.
    pub fn through(mut self, slide: &ColorTexture) -> SurfaceEmission {
        self.terms.iter_mut().for_each(|term| term.colors.push(slide.clone()));
        self
    }

    /// The light of which a share is left at each position; `None` where there are too many textures.
    ///
    /// * `opacity`: that share, which the opacity at the corners of a mesh is another factor of
    pub fn weakened(self, opacity: FloatTexture, textures: &mut Textures) -> Option<SurfaceEmission> {
        match opacity {
            FloatTexture::Node(_) if !self.is_black() => {
                Some(self.times(textures.float(VertexOpacity(opacity))?))
            }
            _ => Some(self.times(opacity)),
        }
    }

    /// The light times a number in [0, 1].
    pub fn times(mut self, amount: FloatTexture) -> SurfaceEmission {
        match amount {
            FloatTexture::Constant(value) => self.scaled(value),
            FloatTexture::Node(_) => {
                self.terms.iter_mut().for_each(|term| term.amounts.push(amount));
                self
            }
        }
    }

    fn scaled(mut self, factor: f32) -> SurfaceEmission {
        for term in &mut self.terms {
            term.emission = term.emission.clone().scaled(factor);
            term.gas = term.gas.take().map(|gas| Arc::new(gas.scaled(factor)));
        }
        self.without_black()
    }

    /// The light of both, on the sides and in the group of this one unless it is black.
    pub fn with(mut self, other: SurfaceEmission) -> SurfaceEmission {
        if self.is_black() {
            return other;
        }
        self.terms.extend(other.terms);
        self
    }

    /// Whether both shine from the same sides and belong to the same group.
    pub fn agrees_with(&self, other: &SurfaceEmission) -> bool {
        self.sides == other.sides && self.group == other.group
    }

    /// Whether there is none.
    pub fn is_black(&self) -> bool {
        self.terms.is_empty()
    }

    /// The textures that it is made of.
    pub fn textures(&self) -> impl Iterator<Item = AnyTexture<'_>> {
        self.terms.iter().flat_map(EmissionTerm::textures)
    }

    /// Whether all its own numbers are finite.
    pub fn is_finite(&self) -> bool {
        let is_finite = |term: &EmissionTerm| {
            term.emission.is_finite() && term.gas.as_ref().is_none_or(|gas| gas.is_finite())
        };
        self.terms.iter().all(is_finite)
    }

    /// The light, where it is the same everywhere.
    pub fn constant(&self) -> Option<&Emission> {
        match &*self.terms {
            [term] if term.gas.is_none() => term.textures().next().is_none().then_some(&term.emission),
            _ => None,
        }
    }

    fn without_black(mut self) -> SurfaceEmission {
        self.terms.retain(|term| !term.emission.is_black());
        self
    }
}

/// Light that leaves a surface.
#[derive(Clone, Copy, Debug, Default)]
pub struct Leaving {
    /// From where, in world space.
    pub p: Vec3,
    /// The unit direction, where it is known; else the light is that of no particular one.
    pub d: Option<Vec3>,
}

/// The radiance of a surface, position by position.
#[derive(Clone, Debug)]
pub struct VariedEmission {
    terms: Vec<EmissionTerm>,
    needs_uv: bool,
    detail: TextureDetail,
}

/// What one material adds to the light of a surface.
#[derive(Clone, Debug)]
struct EmissionTerm {
    /// Its radiance where all factors are 1, or about the mean of it.
    emission: Emission,
    /// What gives that light, where it is no surface at rest.
    gas: Option<Arc<OrbitingGas>>,
    /// Factors that are colours.
    colors: Vec<ColorTexture>,
    /// Factors that are numbers, held to [0, 1].
    amounts: Vec<FloatTexture>,
}

impl EmissionTerm {
    fn textures(&self) -> impl Iterator<Item = AnyTexture<'_>> {
        let amounts = self.amounts.iter().copied().map(AnyTexture::from);
        self.colors.iter().map(AnyTexture::from).chain(amounts)
    }

    fn at(&self, evaluator: TextureEvaluator<'_>, leaving: Leaving, wavelengths: &Wavelengths) -> Spectrum {
        let light = match &self.gas {
            None => self.emission.at(wavelengths),
            Some(gas) => gas.radiance(leaving.p, leaving.d, wavelengths),
        };
        let light = self.colors.iter().fold(light, |light, color| light * color.at(evaluator, wavelengths));
        self.amounts.iter().fold(light, |light, amount| light * amount.at(evaluator).clamp(0.0, 1.0))
    }

    fn mean(&self, textures: &Textures) -> [f32; 3] {
        let colors = self.colors.iter().map(|color| color.mean(textures));
        let amounts = self.amounts.iter().map(|amount| [amount.mean(textures); 3]);
        colors
            .chain(amounts)
            .fold(self.emission.rgb(), |light, factor| [0, 1, 2].map(|i| light[i] * factor[i]))
    }
}

impl VariedEmission {
    /// The light of a surface that differs from place to place.
    pub fn new(emission: SurfaceEmission, textures: &Textures) -> VariedEmission {
        let terms = emission.terms;
        let mut detail = TextureDetail::default();
        let mut needs_uv = false;
        for texture in terms.iter().flat_map(EmissionTerm::textures) {
            texture.detail(textures, &mut detail);
            needs_uv |= texture.needs_uv(textures);
        }
        detail.has_pattern |= terms.iter().any(|term| term.gas.is_some());
        VariedEmission { terms, needs_uv, detail }
    }

    /// The radiance at a position.
    ///
    /// * `at`: surface coordinates are of effect where [`VariedEmission::needs_uv`]
    pub fn at(
        &self,
        textures: &Textures,
        at: &TextureContext,
        leaving: Leaving,
        wavelengths: &Wavelengths,
    ) -> Spectrum {
        let evaluator = textures.evaluator(at);
        let radiance = |term: &EmissionTerm| term.at(evaluator, leaving, wavelengths);
        self.terms.iter().map(radiance).fold(Spectrum::BLACK, |sum, light| sum + light)
    }

    /// The light of each material.
    pub fn emissions(&self) -> impl Iterator<Item = &Emission> {
        self.terms.iter().map(|term| &term.emission)
    }

    /// How finely it differs from place to place.
    pub fn detail(&self) -> &TextureDetail {
        &self.detail
    }

    /// Whether it depends on surface coordinates.
    #[inline]
    pub fn needs_uv(&self) -> bool {
        self.needs_uv
    }

    /// The light of a surface whose positions are all alike and each the mean of these, of pictures the mean of all their
    /// texels.
    pub fn mean(&self, textures: &Textures) -> Emission {
        let sum = self.terms.iter().map(|term| term.mean(textures));
        Emission::from_rgb(sum.fold([0.0; 3], |sum, light| [0, 1, 2].map(|i| sum[i] + light[i])))
    }
}
