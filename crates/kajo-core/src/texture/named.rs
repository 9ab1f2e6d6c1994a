//! A texture that has a name, which may stand for a number or for a colour.

use kajo_color::{Reflectance, Spectrum};
use kajo_math::Vec3;

use super::{ColorTexture, FloatTexture, Grey, Lightness, TextureEvaluator, Textures};

/// A texture that is a number or a colour.
#[derive(Clone, Debug)]
pub enum NamedTexture {
    /// A number.
    Float(FloatTexture),
    /// A colour.
    Color(ColorTexture),
}

impl NamedTexture {
    /// The number; of a colour how light it is. `None` where there are too many nodes.
    pub fn number(&self, nodes: &mut Textures) -> Option<FloatTexture> {
        match self {
            NamedTexture::Float(texture) => Some(*texture),
            NamedTexture::Color(color) => nodes.float(Lightness(color.clone())),
        }
    }

    /// The colour; of a number the grey. `None` where there are too many nodes.
    pub fn color(&self, nodes: &mut Textures) -> Option<ColorTexture> {
        match self {
            NamedTexture::Float(FloatTexture::Constant(value)) => {
                Some(Reflectance::from_rgb([*value; 3]).into())
            }
            NamedTexture::Float(texture) => nodes.color(Grey::reflectance(*texture)),
            NamedTexture::Color(color) => Some(color.clone()),
        }
    }

    /// The colour at a point in linear RGB; of a number the grey of that share of light.
    pub fn rgb(&self, evaluator: TextureEvaluator<'_>) -> Spectrum {
        match self {
            NamedTexture::Float(texture) => Vec3::splat(texture.at(evaluator)).into(),
            NamedTexture::Color(color) => color.rgb(evaluator),
        }
    }
}
