//! A texture in a space of its own.

use kajo_math::{Affine3A, Vec3, Vec3A};

use super::{
    FilteredNumber, FloatNode, FloatTexture, TextureContext, TextureFootprint, TextureSlope, Textures,
};

/// Another texture, evaluated at `texture_from_world * p`.
#[derive(Clone, Copy, Debug)]
pub struct Placed {
    /// The texture.
    pub texture: FloatTexture,
    /// From the world to its space.
    pub texture_from_world: Affine3A,
}

impl Placed {
    /// The point and its footprint in the texture's own space.
    fn own(&self, at: &TextureContext) -> TextureContext {
        let map = &self.texture_from_world;
        let p = at.footprint.p.map(|dp| map.transform_vector3(dp));
        let footprint = TextureFootprint { p, ..at.footprint };
        TextureContext { p: map.transform_point3(at.p), footprint, ..*at }
    }
}

impl FloatNode for Placed {
    fn is_finite(&self) -> bool {
        self.texture_from_world.is_finite()
    }

    fn part(&self) -> Option<FloatTexture> {
        Some(self.texture)
    }

    fn value(&self, textures: &Textures, at: &TextureContext) -> f32 {
        self.texture.at(textures.evaluator(&self.own(at)))
    }

    fn filtered(&self, textures: &Textures, at: &TextureContext) -> FilteredNumber {
        self.texture.filtered(textures.evaluator(&self.own(at)))
    }

    fn slope(&self, textures: &Textures, at: &TextureContext, factor: f32) -> TextureSlope {
        let own = self.own(at);
        let TextureSlope { uv, p } = self.texture.slope(textures.evaluator(&own), factor);
        // By the chain rule: the transpose of the map takes gradients back.
        TextureSlope { uv, p: Vec3::from(self.texture_from_world.matrix3.transpose() * Vec3A::from(p)) }
    }

    fn mean(&self, textures: &Textures) -> f32 {
        self.texture.mean(textures)
    }
}
