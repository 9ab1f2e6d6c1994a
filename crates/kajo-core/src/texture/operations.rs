//! Numbers that are worked out from others.

use super::{FilteredNumber, FloatNode, FloatTexture, TextureContext, TextureSlope, Textures};

/// What is left of 1: `1 - t`.
#[derive(Clone, Copy, Debug)]
pub struct Complement(pub FloatTexture);

/// A number in [0, 1] as a place between two others: `lo + (hi - lo) t`.
#[derive(Clone, Copy, Debug)]
pub struct Remapped {
    /// The number.
    pub texture: FloatTexture,
    /// What 0 and 1 stand for.
    pub range: [f32; 2],
}

impl FloatNode for Complement {
    fn is_finite(&self) -> bool {
        true
    }

    fn part(&self) -> Option<FloatTexture> {
        Some(self.0)
    }

    fn value(&self, textures: &Textures, at: &TextureContext) -> f32 {
        1.0 - self.0.at(textures.evaluator(at))
    }

    fn filtered(&self, textures: &Textures, at: &TextureContext) -> FilteredNumber {
        let number = self.0.filtered(textures.evaluator(at));
        number.mapped(1.0 - number.mean, -1.0)
    }

    fn slope(&self, textures: &Textures, at: &TextureContext, factor: f32) -> TextureSlope {
        self.0.slope(textures.evaluator(at), -factor)
    }

    fn mean(&self, textures: &Textures) -> f32 {
        1.0 - self.0.mean(textures)
    }
}

impl Remapped {
    fn map(&self, t: f32) -> f32 {
        let [lo, hi] = self.range;
        lo + (hi - lo) * t
    }
}

impl FloatNode for Remapped {
    fn is_finite(&self) -> bool {
        self.range.iter().all(|v| v.is_finite())
    }

    fn part(&self) -> Option<FloatTexture> {
        Some(self.texture)
    }

    fn value(&self, textures: &Textures, at: &TextureContext) -> f32 {
        self.map(self.texture.at(textures.evaluator(at)))
    }

    fn filtered(&self, textures: &Textures, at: &TextureContext) -> FilteredNumber {
        let number = self.texture.filtered(textures.evaluator(at));
        number.mapped(self.map(number.mean), self.range[1] - self.range[0])
    }

    fn slope(&self, textures: &Textures, at: &TextureContext, factor: f32) -> TextureSlope {
        let [lo, hi] = self.range;
        self.texture.slope(textures.evaluator(at), (hi - lo) * factor)
    }

    fn mean(&self, textures: &Textures) -> f32 {
        self.map(self.texture.mean(textures))
    }
}
