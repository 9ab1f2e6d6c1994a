//! Patterns that fill space, in a space in which their features are about one unit wide.

use kajo_math::Vec3;
use kajo_math::pattern::{Pattern, SolidPattern};

use super::{FilteredNumber, FloatNode, TextureContext, TextureSlope, Textures};

/// A pattern.
#[derive(Clone, Copy, Debug)]
pub struct PatternNode {
    /// The pattern.
    pub solid: SolidPattern,
    /// Whether features too narrow for the distance between samples are faded to their means.
    pub is_filtered: bool,
}

impl PatternNode {
    fn at(&self, q: Vec3, at: &TextureContext) -> f32 {
        self.solid.at(q, if self.is_filtered { at.footprint.width() } else { 0.0 })
    }
}

impl FloatNode for PatternNode {
    fn is_finite(&self) -> bool {
        self.solid.pattern().is_finite()
    }

    fn wants_footprint(&self) -> bool {
        self.is_filtered
    }

    fn value(&self, _textures: &Textures, at: &TextureContext) -> f32 {
        self.at(at.p, at)
    }

    fn is_filtered(&self, _textures: &Textures) -> bool {
        self.is_filtered
    }

    fn filtered(&self, _textures: &Textures, at: &TextureContext) -> FilteredNumber {
        let value = |at: &TextureContext| self.at(at.p, at);
        if !self.is_filtered {
            return FilteredNumber::point(value(at));
        }
        FilteredNumber::by_differences(at, self.solid.lost(at.p, at.footprint.width()), value)
    }

    /// By differences over a small part of its unit.
    fn slope(&self, _textures: &Textures, at: &TextureContext, factor: f32) -> TextureSlope {
        TextureSlope::over(at, 1.0 / 256.0, factor, |at| self.at(at.p, at))
    }

    fn mean(&self, _textures: &Textures) -> f32 {
        self.solid.mean()
    }
}
