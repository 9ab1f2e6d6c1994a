//! Two materials mixed by a pattern: the classic `Checkerboard`, `Noise`, `Marble` and `Wood`, or evenly: `Mix`.
//!
//! The pattern is evaluated at `Transform * p`, `p` the world-space point, and every property
//! of the two materials is mixed, the index of refraction too.
//!
//! Scene: `Checkerboard { Transform { UniformScale 2 }  materialIndex 0  materialIndex 1 }`
//! Scene: `Mix { amount 0.3  materialIndex 0  materialIndex 1 }`

use kajo_color::Spectrum;
use kajo_math::warp;

use super::parts::answers_of_part;
use super::{Appearance, Material, MaterialId, ShadingPoint};
use crate::bsdf::Phong;
use crate::emission::SurfaceEmission;
use crate::texture::{AnyTexture, Complement, FloatTexture, TextureContext, Textures};

/// A mixture of two materials.
#[derive(Clone, Copy, Debug)]
pub struct Blend {
    /// The share of the second material.
    pub amount: FloatTexture,
    /// The two materials. The compiler sees to it that they lead to no circle.
    pub materials: [MaterialId; 2],
}

impl Blend {
    /// The material that is there by the number `at.u`, and what to ask it.
    fn chosen<'a>(
        &self,
        appearance: &Appearance,
        at: &ShadingPoint<'a>,
    ) -> Option<(MaterialId, ShadingPoint<'a>)> {
        let t = self.amount.at(appearance.textures.evaluator(at.context)).clamp(0.0, 1.0);
        let [first, second] = self.materials;
        let (is_second, u) = warp::choose(at.u, t);
        Some((if is_second { second } else { first }, ShadingPoint { u, ..*at }))
    }
}

impl Material for Blend {
    fn is_finite(&self) -> bool {
        true
    }

    fn parts(&self) -> &[MaterialId] {
        &self.materials
    }

    fn textures(&self) -> Vec<AnyTexture<'_>> {
        vec![self.amount.into()]
    }

    fn emission(
        &self,
        of_part: &dyn Fn(MaterialId) -> SurfaceEmission,
        textures: &mut Textures,
    ) -> Option<SurfaceEmission> {
        let [first, second] = self.materials.map(of_part);
        let rest = match self.amount {
            FloatTexture::Constant(t) => (1.0 - t).into(),
            FloatTexture::Node(_) if first.is_black() => self.amount,
            FloatTexture::Node(_) => textures.float(Complement(self.amount))?,
        };
        Some(first.times(rest).with(second.times(self.amount)))
    }

    fn needs_uv(&self, appearance: &Appearance) -> bool {
        let parts = || self.materials.into_iter().any(|part| appearance.needs_uv(part));
        self.amount.needs_uv(&appearance.textures) || parts()
    }

    fn phong(&self, appearance: &Appearance, at: &TextureContext) -> Phong {
        let t = self.amount.at(appearance.textures.evaluator(at));
        let [first, second] = self.materials;
        if t == 0.0 {
            return appearance.phong(first, at);
        }
        if t == 1.0 {
            return appearance.phong(second, at);
        }
        let first = appearance.phong(first, at);
        first.lerp(&appearance.phong(second, at), t)
    }

    answers_of_part!(bsdf, interior, orientation);

    fn passage(&self, appearance: &Appearance, at: &ShadingPoint<'_>, cos: f32) -> Spectrum {
        let t = self.amount.at(appearance.textures.evaluator(at.context)).clamp(0.0, 1.0);
        let [first, second] = self.materials.map(|m| appearance.passage(m, at, cos));
        first.lerp(second, t)
    }
}
