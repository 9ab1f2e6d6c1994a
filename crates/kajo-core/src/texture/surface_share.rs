//! The shares of materials that a surface says by its coordinates.

use kajo_math::Vec2;

use super::{FloatNode, TextureContext, TextureDetail, TextureSlope, Textures, UvSet};

/// One of the four surface coordinates as a number: of a [`Blob`](crate::shape::Blob) the share of one of its materials.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceShare {
    /// The set that it is of.
    pub set: UvSet,
    /// The number of the coordinate there, 0 or 1.
    pub axis: usize,
    /// Its mean over all places, about.
    pub mean: f32,
}

impl FloatNode for SurfaceShare {
    fn is_finite(&self) -> bool {
        self.mean.is_finite()
    }

    fn value(&self, _textures: &Textures, at: &TextureContext) -> f32 {
        let uv: Vec2 = match self.set {
            UvSet::First => at.uv.first,
            UvSet::Second => at.uv.second,
        };
        let [u, v] = uv.to_array();
        if self.axis == 0 { u } else { v }
    }

    fn needs_uv(&self, _textures: &Textures) -> bool {
        true
    }

    /// Not known: a relief follows what is mixed, not how it is.
    fn slope(&self, _textures: &Textures, _at: &TextureContext, _factor: f32) -> TextureSlope {
        TextureSlope::default()
    }

    fn detail(&self, _textures: &Textures, found: &mut TextureDetail) {
        found.has_pattern = true;
    }

    fn mean(&self, _textures: &Textures) -> f32 {
        self.mean
    }
}
