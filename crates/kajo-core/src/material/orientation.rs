//! How a material turns the frame in which it scatters.
//!
//! The z axis of the frame is the normal of the surface, which a relief makes lean. The x axis is nothing to most materials;
//! where it is something, it starts along the first surface coordinate and is turned from there.

use kajo_math::{Vec2, Vec3};

use crate::bsdf::{Microfacets, microfacet::NormalDistribution};
use crate::texture::{FloatTexture, TextureEvaluator};

/// What a material asks of its frame at a point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Orientation {
    /// By how much the x axis is turned from the direction of `u` towards that of `v`, in full turns; `None` where it
    /// may point anywhere.
    pub turn: Option<f32>,
    /// How the normal leans.
    pub lean: Option<Lean>,
}

/// How a relief makes the normal of a surface lean.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lean {
    /// To the vector with these components along the two tangents, made perpendicular unit vectors, and the normal.
    Tangent(Vec3),
    /// As the surface leans that rises by the sum of both from place to place.
    Slope {
        /// For each unit of its coordinates.
        by_uv: Vec2,
        /// For each unit of the world.
        by_p: Vec3,
    },
}

/// Which way the facets of a surface run.
#[derive(Clone, Copy, Debug)]
pub struct Grain {
    /// In [0, 1]: 0 for facets that are alike all around, 1 for grooves.
    pub anisotropy: FloatTexture,
    /// By how much the direction of the greater roughness is turned from `u`, in full turns.
    pub rotation: FloatTexture,
}

impl Default for Grain {
    fn default() -> Grain {
        Grain { anisotropy: 0.0.into(), rotation: 0.0.into() }
    }
}

impl Grain {
    /// The facets of a surface with the roughness `alpha` on the whole.
    #[inline]
    pub fn facets(
        &self,
        shape: NormalDistribution,
        alpha: f32,
        evaluator: TextureEvaluator<'_>,
    ) -> Microfacets {
        match self.anisotropy {
            FloatTexture::Constant(0.0) => Microfacets::new(shape, alpha),
            _ => Microfacets::brushed(shape, alpha, self.anisotropy.at(evaluator)),
        }
    }

    /// The frame that the facets need.
    pub fn orientation(&self, evaluator: TextureEvaluator<'_>) -> Orientation {
        Orientation { turn: self.exists().then(|| self.rotation.at(evaluator)), lean: None }
    }

    /// Whether the facets are not alike all around.
    pub fn exists(&self) -> bool {
        self.anisotropy.share_range()[1] > 0.0
    }

    /// Its textures.
    pub(super) fn textures(&self) -> [FloatTexture; 2] {
        [self.anisotropy, self.rotation]
    }

    /// Whether it differs between places.
    pub fn varies(&self) -> bool {
        self.anisotropy.varies() || (self.exists() && self.rotation.varies())
    }
}
