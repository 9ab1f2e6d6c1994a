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

use kajo_color::{Emission, Spectrum, Wavelengths};
use kajo_math::Affine3A;

use crate::family::Pooled;
use crate::ids::LightGroup;
use crate::light::Sides;
use crate::texture::{
    Constant, PictureMap, Share, TexelFilter, TextureContext, TextureId, Textures, picture_reflectance,
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
        let terms = vec![EmissionTerm { emission, factors: Vec::new() }];
        SurfaceEmission { terms, ..SurfaceEmission::default() }.without_black()
    }
}

impl SurfaceEmission {
    /// The light where it leaves the surface on these sides only.
    pub fn on(self, sides: Sides) -> SurfaceEmission {
        SurfaceEmission { sides, ..self }
    }

    /// The light among that of a group.
    pub fn in_group(self, group: LightGroup) -> SurfaceEmission {
        SurfaceEmission { group, ..self }
    }

    /// The light as it shines through a picture.
    pub fn through(self, slide: PictureMap) -> SurfaceEmission {
        self.times(&EmissionFactor::Slide(slide))
    }

    /// The light of a surface that the colours at its vertices tint too.
    pub fn tinted(self) -> SurfaceEmission {
        self.times(&EmissionFactor::Tint)
    }

    /// The light of which a share is left at each place.
    pub fn weakened(mut self, share: &Share) -> SurfaceEmission {
        match share {
            Share::Plain(value) => {
                for term in &mut self.terms {
                    term.emission = term.emission.clone().scaled(*value);
                }
                self.without_black()
            }
            Share::Picture(..) | Share::Cut(..) => self.times(&EmissionFactor::Share(share.clone())),
        }
    }

    /// The light of one of two materials that a pattern mixes.
    ///
    /// * `is_second`: whether it is the one that the pattern shows where it is 1
    pub fn mixed(
        self,
        pattern: TextureId,
        pattern_from_world: Affine3A,
        is_second: bool,
        textures: &Textures,
    ) -> SurfaceEmission {
        if let Some(&Constant { value: t }) = Constant::find(textures, pattern) {
            return self.weakened(&Share::Plain(if is_second { t } else { 1.0 - t }));
        }
        self.times(&EmissionFactor::Pattern { pattern, pattern_from_world, is_second })
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

    /// Whether all numbers are finite.
    pub fn is_finite(&self) -> bool {
        self.terms
            .iter()
            .all(|term| term.emission.is_finite() && term.factors.iter().all(EmissionFactor::is_finite))
    }

    /// The light, where it is the same everywhere.
    pub fn constant(&self) -> Option<&Emission> {
        match &*self.terms {
            [EmissionTerm { emission, factors }] if factors.is_empty() => Some(emission),
            _ => None,
        }
    }

    fn times(mut self, factor: &EmissionFactor) -> SurfaceEmission {
        self.terms.iter_mut().for_each(|term| term.factors.push(factor.clone()));
        self
    }

    fn without_black(mut self) -> SurfaceEmission {
        self.terms.retain(|term| !term.emission.is_black());
        self
    }
}

/// The radiance of a surface, place by place.
#[derive(Clone, Debug)]
pub struct VariedEmission {
    terms: Vec<EmissionTerm>,
    needs_uv: bool,
}

/// What one material adds to the light of a surface.
#[derive(Clone, Debug)]
pub struct EmissionTerm {
    /// Its radiance where all factors are 1.
    pub emission: Emission,
    /// What it is multiplied by.
    pub factors: Vec<EmissionFactor>,
}

/// What the light of a surface is multiplied by from place to place.
#[derive(Clone, Debug)]
pub enum EmissionFactor {
    /// The share of the surface between its holes.
    Share(Share),
    /// The colours at the vertices.
    Tint,
    /// The colours of a picture, through which light shines as through a slide.
    Slide(PictureMap),
    /// The share of a mixture that one of its two materials has.
    Pattern {
        /// 0 shows the first material, 1 the second.
        pattern: TextureId,
        /// World space to the pattern's space.
        pattern_from_world: Affine3A,
        /// Whether it is the share of the second material.
        is_second: bool,
    },
}

impl From<SurfaceEmission> for VariedEmission {
    fn from(emission: SurfaceEmission) -> VariedEmission {
        let terms = emission.terms;
        let needs_uv = terms.iter().flat_map(|term| &term.factors).any(|factor| match factor {
            EmissionFactor::Share(share) => share.varies(),
            EmissionFactor::Slide(_) => true,
            EmissionFactor::Tint | EmissionFactor::Pattern { .. } => false,
        });
        VariedEmission { terms, needs_uv }
    }
}

impl VariedEmission {
    /// The radiance at a place.
    ///
    /// * `at`: surface coordinates are of effect where [`VariedEmission::needs_uv`]
    pub fn at(&self, textures: &Textures, at: &TextureContext, wavelengths: &Wavelengths) -> Spectrum {
        let radiance = |term: &EmissionTerm| {
            let light = term.emission.at(wavelengths);
            term.factors.iter().fold(light, |light, factor| light * factor.at(textures, at, wavelengths))
        };
        self.terms.iter().map(radiance).fold(Spectrum::BLACK, |sum, light| sum + light)
    }

    /// The light of each material.
    pub fn emissions(&self) -> impl Iterator<Item = &Emission> {
        self.terms.iter().map(|term| &term.emission)
    }

    /// The pictures that it depends on.
    pub fn pictures(&self) -> impl Iterator<Item = &PictureMap> {
        self.factors().filter_map(|factor| match factor {
            EmissionFactor::Slide(map)
            | EmissionFactor::Share(Share::Picture(map, _) | Share::Cut(map, ..)) => Some(map),
            EmissionFactor::Share(Share::Plain(_))
            | EmissionFactor::Tint
            | EmissionFactor::Pattern { .. } => None,
        })
    }

    /// Whether it may change at once and not linearly between the middles of texels.
    pub fn jumps(&self) -> bool {
        let nearest = |map: &PictureMap| map.filter == TexelFilter::Nearest;
        let cut = |factor: &EmissionFactor| matches!(factor, EmissionFactor::Share(Share::Cut(..)));
        self.has_pattern() || self.pictures().any(nearest) || self.factors().any(cut)
    }

    /// Whether it depends on a pattern in space.
    pub fn has_pattern(&self) -> bool {
        self.factors().any(|factor| matches!(factor, EmissionFactor::Pattern { .. }))
    }

    fn factors(&self) -> impl Iterator<Item = &EmissionFactor> {
        self.terms.iter().flat_map(|term| &term.factors)
    }

    /// Whether it depends on surface coordinates.
    #[inline]
    pub fn needs_uv(&self) -> bool {
        self.needs_uv
    }

    /// The light of a surface whose places are all alike and each the mean of these, of pictures the mean of all their
    /// texels.
    pub fn mean(&self) -> Emission {
        let mean = |term: &EmissionTerm| {
            let means = term.factors.iter().map(EmissionFactor::mean);
            means.fold(term.emission.rgb(), |light, factor| [0, 1, 2].map(|i| light[i] * factor[i]))
        };
        let sum = self.terms.iter().map(mean);
        Emission::from_rgb(sum.fold([0.0; 3], |sum, light| [0, 1, 2].map(|i| sum[i] + light[i])))
    }
}

impl EmissionFactor {
    fn at(&self, textures: &Textures, at: &TextureContext, wavelengths: &Wavelengths) -> Spectrum {
        match self {
            EmissionFactor::Share(share) => Spectrum::WHITE * share.covered_at(at.uv, at.cover()),
            EmissionFactor::Tint => at.tinted(Spectrum::WHITE, wavelengths),
            EmissionFactor::Slide(map) => picture_reflectance(map, at.uv, wavelengths),
            EmissionFactor::Pattern { pattern, pattern_from_world, is_second } => {
                let t = textures.value(*pattern, pattern_from_world.transform_point3(at.p)).clamp(0.0, 1.0);
                Spectrum::WHITE * if *is_second { t } else { 1.0 - t }
            }
        }
    }

    fn is_finite(&self) -> bool {
        match self {
            EmissionFactor::Share(share) => share.is_finite(),
            EmissionFactor::Tint => true,
            EmissionFactor::Slide(map) => map.is_finite(),
            EmissionFactor::Pattern { pattern_from_world, .. } => pattern_from_world.is_finite(),
        }
    }

    fn mean(&self) -> [f32; 3] {
        match self {
            EmissionFactor::Share(share) => [share.mean(); 3],
            EmissionFactor::Tint => [1.0; 3],
            EmissionFactor::Slide(map) => {
                let [r, g, b, _] = map.mean();
                [r, g, b]
            }
            EmissionFactor::Pattern { .. } => [0.5; 3],
        }
    }
}
