//! The colours at the corners of a mesh as textures.

use kajo_color::{Spectrum, Wavelengths};

use super::{
    ColorNode, FilteredNumber, FloatNode, FloatTexture, TextureContext, TextureDetail, TextureSlope, Textures,
};

/// The colours, white where there are none.
#[derive(Clone, Copy, Debug)]
pub struct VertexColor;

/// An opacity that the opacity at the corners of a mesh is another factor of; see [`FloatTexture::covered_at`].
#[derive(Clone, Copy, Debug)]
pub struct VertexOpacity(pub FloatTexture);

impl ColorNode for VertexColor {
    fn is_finite(&self) -> bool {
        true
    }

    fn color_needs_uv(&self, _textures: &Textures) -> bool {
        false
    }

    fn color_detail(&self, _textures: &Textures, _found: &mut TextureDetail) {}

    fn reflectance(&self, _textures: &Textures, at: &TextureContext, wavelengths: &Wavelengths) -> Spectrum {
        at.tinted(Spectrum::WHITE, wavelengths)
    }

    fn color_mean(&self, _textures: &Textures) -> [f32; 3] {
        [1.0; 3]
    }
}

impl FloatNode for VertexOpacity {
    fn is_finite(&self) -> bool {
        true
    }

    fn part(&self) -> Option<FloatTexture> {
        Some(self.0)
    }

    fn value(&self, textures: &Textures, at: &TextureContext) -> f32 {
        self.0.covered_at(textures.evaluator(at))
    }

    fn filtered(&self, textures: &Textures, at: &TextureContext) -> FilteredNumber {
        self.0.filtered(textures.evaluator(at)).mapped(self.value(textures, at), at.cover())
    }

    /// Of the opacity alone: the colours of a mesh have no derivatives here.
    fn slope(&self, textures: &Textures, at: &TextureContext, factor: f32) -> TextureSlope {
        self.0.slope(textures.evaluator(at), at.cover() * factor)
    }

    fn mean(&self, textures: &Textures) -> f32 {
        self.0.mean(textures)
    }
}
