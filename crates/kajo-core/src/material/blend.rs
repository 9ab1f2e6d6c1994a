//! Two materials mixed by a pattern: the classic `Checkerboard`, `Noise`, `Marble` and `Wood`, or evenly: `Mix`.
//!
//! The pattern is evaluated at `Transform * p`, `p` the world-space point, and every property
//! of the two materials is mixed, the index of refraction too.
//!
//! Scene: `Checkerboard { Transform { UniformScale 2 }  materialIndex 0  materialIndex 1 }`
//! Scene: `Mix { amount 0.3  materialIndex 0  materialIndex 1 }`

use kajo_color::Spectrum;
use kajo_math::{Affine3A, Vec3};

use super::parts::answers_of_part;
use super::{Appearance, Material, MaterialId, ShadingPoint};
use crate::bsdf::Phong;
use crate::emission::SurfaceEmission;
use crate::texture::{TextureContext, TextureId};

/// A mixture of two materials.
#[derive(Clone, Copy, Debug)]
pub struct Blend {
    /// 0 shows the first material, 1 the second.
    pub pattern: TextureId,
    /// World space to the pattern's space.
    pub pattern_from_world: Affine3A,
    /// The two materials. The compiler sees to it that they lead to no circle.
    pub materials: [MaterialId; 2],
}

impl Blend {
    /// The share of the second material at a world-space point; a number of the pattern, in [0, 1] but for rounding.
    fn share_of_second(&self, appearance: &Appearance, p: Vec3) -> f32 {
        appearance.textures.value(self.pattern, self.pattern_from_world.transform_point3(p))
    }

    /// The material that is there by the number `at.u`, and what to ask it.
    fn chosen<'a>(
        &self,
        appearance: &Appearance,
        at: &ShadingPoint<'a>,
    ) -> Option<(MaterialId, ShadingPoint<'a>)> {
        let t = self.share_of_second(appearance, at.context.p).clamp(0.0, 1.0);
        let [first, second] = self.materials;
        // What is left of the number after the choice is uniform again.
        let (part, u) = if at.u < t { (second, at.u / t) } else { (first, (at.u - t) / (1.0 - t)) };
        Some((part, ShadingPoint { u: u.min(1.0f32.next_down()), ..*at }))
    }
}

impl Material for Blend {
    fn is_finite(&self) -> bool {
        self.pattern_from_world.is_finite()
    }

    fn parts(&self) -> &[MaterialId] {
        &self.materials
    }

    fn pattern(&self) -> Option<TextureId> {
        Some(self.pattern)
    }

    fn emission(
        &self,
        appearance: &Appearance,
        of_part: &dyn Fn(MaterialId) -> SurfaceEmission,
    ) -> SurfaceEmission {
        let [first, second] = self.materials.map(of_part);
        let mixed = |part: SurfaceEmission, is_second| {
            part.mixed(self.pattern, self.pattern_from_world, is_second, &appearance.textures)
        };
        mixed(first, false).with(mixed(second, true))
    }

    fn phong(&self, appearance: &Appearance, at: &TextureContext) -> Phong {
        let t = self.share_of_second(appearance, at.p);
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
        let t = self.share_of_second(appearance, at.context.p).clamp(0.0, 1.0);
        let [first, second] = self.materials.map(|m| appearance.passage(m, at, cos));
        first.lerp(second, t)
    }
}
