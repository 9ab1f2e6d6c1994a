//! Light of a surface that differs from place to place: a slide before an emitter, holes, a mixture of which a part glows.
//!
//! The radiance is a sum over the materials that the surface is made of, each times the factors of its place:
//!
//! ```text
//! L(p) = Σ_i  L_i Π_k f_ik(p)
//! ```
//!
//! Places are still drawn as if the whole surface gave the same light; which piece of it is asked goes by what is on it.

use kajo_color::{Emission, Spectrum, Wavelengths};
use kajo_math::Affine3A;

use crate::material::MaterialPoint;
use crate::texture::{PictureMap, Share, TextureId, Textures, picture_reflectance};

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

impl VariedEmission {
    /// The sum of these.
    pub fn new(terms: Vec<EmissionTerm>) -> VariedEmission {
        let needs_uv = terms.iter().flat_map(|term| &term.factors).any(|factor| match factor {
            EmissionFactor::Share(share) => share.varies(),
            EmissionFactor::Slide(_) => true,
            EmissionFactor::Tint | EmissionFactor::Pattern { .. } => false,
        });
        VariedEmission { terms, needs_uv }
    }

    /// The radiance at a place.
    ///
    /// * `at`: surface coordinates are of effect where [`VariedEmission::needs_uv`]
    pub fn at(&self, textures: &Textures, at: &MaterialPoint, wavelengths: &Wavelengths) -> Spectrum {
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
    fn at(&self, textures: &Textures, at: &MaterialPoint, wavelengths: &Wavelengths) -> Spectrum {
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
