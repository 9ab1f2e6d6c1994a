//! A texture in a space of its own.

use kajo_math::{Affine3A, Vec3, Vec3A};

use super::{FloatNode, FloatTexture, TextureContext, TextureSlope, Textures};

/// Another texture, evaluated at `texture_from_world * p`.
#[derive(Clone, Copy, Debug)]
pub struct Placed {
    /// The texture.
    pub texture: FloatTexture,
    /// From the world to its space.
    pub texture_from_world: Affine3A,
}

impl FloatNode for Placed {
    fn is_finite(&self) -> bool {
        self.texture_from_world.is_finite()
    }

    fn part(&self) -> Option<FloatTexture> {
        Some(self.texture)
    }

    fn value(&self, textures: &Textures, at: &TextureContext) -> f32 {
        let at = TextureContext { p: self.texture_from_world.transform_point3(at.p), ..*at };
        self.texture.at(textures.evaluator(&at))
    }

    fn slope(&self, textures: &Textures, at: &TextureContext, factor: f32) -> TextureSlope {
        let own = TextureContext { p: self.texture_from_world.transform_point3(at.p), ..*at };
        let TextureSlope { uv, p } = self.texture.slope(textures.evaluator(&own), factor);
        // By the chain rule: the transpose of the map takes gradients back.
        TextureSlope { uv, p: Vec3::from(self.texture_from_world.matrix3.transpose() * Vec3A::from(p)) }
    }

    fn mean(&self, textures: &Textures) -> f32 {
        self.texture.mean(textures)
    }
}
