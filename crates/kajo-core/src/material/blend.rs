//! Two materials mixed by a pattern: the classic `Checkerboard`, `Noise`, `Marble` and `Wood`, or evenly: `Mix`.
//!
//! The pattern is evaluated at `Transform * p`, `p` the world-space point, and every property
//! of the two materials is mixed, the index of refraction too.
//!
//! Scene: `Checkerboard { Transform { UniformScale 2 }  materialIndex 0  materialIndex 1 }`
//! Scene: `Mix { amount 0.3  materialIndex 0  materialIndex 1 }`

use kajo_color::Spectrum;
use kajo_math::Affine3A;

use super::{
    Appearance, Appearances, Interior, MaterialId, MaterialPoint, Materials, Orientation, ShadingPoint,
};
use crate::bsdf::{Bsdf, Phong};
use crate::texture::{TextureId, Textures};

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
    /// The material that is there by the number `at.u`, and what to ask it.
    fn part<'a>(&self, textures: &Textures, at: &ShadingPoint<'a>) -> (MaterialId, ShadingPoint<'a>) {
        let t = textures
            .value(self.pattern, self.pattern_from_world.transform_point3(at.place.p))
            .clamp(0.0, 1.0);
        let [first, second] = self.materials;
        // What is left of the number after the choice is uniform again.
        let (part, u) = if at.u < t { (second, at.u / t) } else { (first, (at.u - t) / (1.0 - t)) };
        (part, ShadingPoint { u: u.min(1.0f32.next_down()), ..*at })
    }
}

impl Appearance for Blend {
    fn phong(&self, appearances: Appearances<'_>, at: &MaterialPoint) -> Phong {
        let t = appearances.textures.value(self.pattern, self.pattern_from_world.transform_point3(at.p));
        let [first, second] = self.materials;
        if t == 0.0 {
            return appearances.phong(first, at);
        }
        if t == 1.0 {
            return appearances.phong(second, at);
        }
        let first = appearances.phong(first, at);
        first.lerp(&appearances.phong(second, at), t)
    }

    fn bsdf(&self, appearances: Appearances<'_>, at: &ShadingPoint<'_>) -> Bsdf {
        let (part, at) = self.part(appearances.textures, at);
        appearances.bsdf(part, &at)
    }

    fn passage(&self, appearances: Appearances<'_>, at: &ShadingPoint<'_>, cos: f32) -> Spectrum {
        let t = appearances
            .textures
            .value(self.pattern, self.pattern_from_world.transform_point3(at.place.p))
            .clamp(0.0, 1.0);
        let [first, second] = self.materials.map(|m| appearances.passage(m, at, cos));
        first.lerp(second, t)
    }

    fn has_passages(&self, materials: &Materials) -> bool {
        self.materials.iter().any(|&m| materials.has_passages(m, materials))
    }

    fn interior(&self, appearances: Appearances<'_>, at: &ShadingPoint<'_>) -> Option<Interior> {
        let (part, at) = self.part(appearances.textures, at);
        appearances.interior(part, &at)
    }

    fn orientation(&self, appearances: Appearances<'_>, at: &ShadingPoint<'_>) -> Orientation {
        let (part, at) = self.part(appearances.textures, at);
        appearances.orientation(part, &at)
    }

    fn is_oriented(&self, materials: &Materials) -> bool {
        self.materials.iter().any(|&m| materials.is_oriented(m, materials))
    }

    fn is_mixture(&self) -> bool {
        true
    }

    fn needs_uv(&self, materials: &Materials) -> bool {
        self.materials.iter().any(|&m| materials.needs_uv(m, materials))
    }

    fn may_transmit(&self, materials: &Materials) -> bool {
        self.materials.iter().any(|&m| materials.may_transmit(m, materials))
    }
}
