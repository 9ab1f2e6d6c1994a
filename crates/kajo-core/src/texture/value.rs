//! Numbers and colours that are the same everywhere or named by a node.

use kajo_color::{Reflectance, Spectrum, Wavelengths};
use kajo_math::{Vec2, Vec3};

use super::{
    ColorNodeId, FilteredNormals, FilteredNumber, FloatNodeId, TextureContext, TextureDetail, TextureSlope,
    Textures,
};

/// What textures are evaluated by: their nodes, at a point.
#[derive(Clone, Copy, Debug)]
pub struct TextureEvaluator<'a> {
    /// The nodes.
    pub textures: &'a Textures,
    /// The point.
    pub at: &'a TextureContext,
}

/// A number: a share in [0, 1] where the parameter is one, or an exponent, a length or an index.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FloatTexture {
    /// The same everywhere.
    Constant(f32),
    /// What a node says.
    Node(FloatNodeId),
}

impl From<f32> for FloatTexture {
    fn from(value: f32) -> FloatTexture {
        FloatTexture::Constant(value)
    }
}

impl From<FloatNodeId> for FloatTexture {
    fn from(node: FloatNodeId) -> FloatTexture {
        FloatTexture::Node(node)
    }
}

impl FloatTexture {
    /// The number at a point.
    #[inline]
    pub fn at(self, evaluator: TextureEvaluator<'_>) -> f32 {
        match self {
            FloatTexture::Constant(value) => value,
            FloatTexture::Node(node) => evaluator.textures.value(node, evaluator.at),
        }
    }

    /// The number at a point, with what is known of how it varies within the footprint.
    pub fn filtered(self, evaluator: TextureEvaluator<'_>) -> FilteredNumber {
        match self {
            FloatTexture::Constant(value) => FilteredNumber::point(value),
            FloatTexture::Node(node) if evaluator.at.footprint.is_point() => {
                FilteredNumber::point(evaluator.textures.value(node, evaluator.at))
            }
            FloatTexture::Node(node) => evaluator.textures.filtered(node, evaluator.at),
        }
    }

    /// Whether it is, or is made of, something that is filtered by the footprint.
    pub fn is_filtered(self, textures: &Textures) -> bool {
        match self {
            FloatTexture::Constant(_) => false,
            FloatTexture::Node(node) => textures.is_filtered(node),
        }
    }

    /// The number where it is an opacity, which the opacity at the corners of a mesh is another factor of.
    #[inline]
    pub fn covered_at(self, evaluator: TextureEvaluator<'_>) -> f32 {
        match self {
            FloatTexture::Constant(value) => value * evaluator.at.cover(),
            FloatTexture::Node(node) => evaluator.textures.covered(node, evaluator.at),
        }
    }

    /// The derivatives of `factor` times it at a point; nothing is evaluated for a factor of 0.
    pub fn slope(self, evaluator: TextureEvaluator<'_>, factor: f32) -> TextureSlope {
        match self {
            FloatTexture::Node(node) if factor != 0.0 => evaluator.textures.slope(node, evaluator.at, factor),
            FloatTexture::Node(_) | FloatTexture::Constant(_) => TextureSlope::default(),
        }
    }

    /// Whether it is not constant.
    pub fn varies(self) -> bool {
        matches!(self, FloatTexture::Node(_))
    }

    /// Whether it depends on surface coordinates.
    pub fn needs_uv(self, textures: &Textures) -> bool {
        match self {
            FloatTexture::Constant(_) => false,
            FloatTexture::Node(node) => textures.needs_uv(node),
        }
    }

    /// Adds to what is `found` of other textures.
    pub fn detail(self, textures: &Textures, found: &mut TextureDetail) {
        if let FloatTexture::Node(node) = self {
            textures.detail(node, found);
        }
    }

    /// Its mean over all places, about.
    pub fn mean(self, textures: &Textures) -> f32 {
        match self {
            FloatTexture::Constant(value) => value,
            FloatTexture::Node(node) => textures.mean(node),
        }
    }

    /// The least and the largest number that it may be anywhere where it is a share: a node may be anything from 0 to 1.
    pub fn share_range(self) -> [f32; 2] {
        match self {
            FloatTexture::Constant(value) => [value; 2],
            FloatTexture::Node(_) => [0.0, 1.0],
        }
    }
}

/// A colour of a surface.
#[derive(Clone, Debug)]
pub enum ColorTexture {
    /// The same everywhere.
    Constant(Reflectance),
    /// What a node says.
    Node(ColorNodeId),
}

impl From<Reflectance> for ColorTexture {
    fn from(color: Reflectance) -> ColorTexture {
        ColorTexture::Constant(color)
    }
}

impl From<ColorNodeId> for ColorTexture {
    fn from(node: ColorNodeId) -> ColorTexture {
        ColorTexture::Node(node)
    }
}

impl ColorTexture {
    /// The reflectance at a point.
    #[inline]
    pub fn at(&self, evaluator: TextureEvaluator<'_>, wavelengths: &Wavelengths) -> Spectrum {
        match self {
            ColorTexture::Constant(color) => color.at(wavelengths),
            ColorTexture::Node(node) => evaluator.textures.reflectance(*node, evaluator.at, wavelengths),
        }
    }

    /// Linear RGB at a point.
    pub fn rgb(&self, evaluator: TextureEvaluator<'_>) -> Spectrum {
        match self {
            ColorTexture::Constant(color) => Spectrum::from(Vec3::from(color.rgb())),
            ColorTexture::Node(node) => {
                evaluator.textures.reflectance(*node, evaluator.at, &Wavelengths::RGB)
            }
        }
    }

    /// As normals, where a filter takes the mean of some that differ: along surface coordinates.
    pub fn filtered_normals(&self, evaluator: TextureEvaluator<'_>) -> Option<FilteredNormals> {
        let ColorTexture::Node(node) = self else { return None };
        let FilteredNormals { mean, spread } = evaluator.textures.filtered_normals(*node, evaluator.at)?;
        let [x, y] = [Vec2::X, Vec2::Y].map(|axis| self.along(evaluator.textures, axis));
        let across = self.along(evaluator.textures, mean.truncate());
        Some(FilteredNormals { mean: across.extend(mean.z), spread: spread.mapped(x, y) })
    }

    /// A direction of the texture's own coordinates as one of the surface coordinates that place it.
    pub fn along(&self, textures: &Textures, m: Vec2) -> Vec2 {
        match self {
            ColorTexture::Constant(_) => m,
            ColorTexture::Node(node) => textures.colors.along(*node, m),
        }
    }

    /// Whether it is not constant.
    pub fn varies(&self) -> bool {
        matches!(self, ColorTexture::Node(_))
    }

    /// Whether it is, or is made of, something that is filtered by the footprint.
    pub fn is_filtered(&self, textures: &Textures) -> bool {
        match self {
            ColorTexture::Constant(_) => false,
            ColorTexture::Node(node) => textures.color_is_filtered(*node),
        }
    }

    /// Whether it depends on surface coordinates.
    pub fn needs_uv(&self, textures: &Textures) -> bool {
        match self {
            ColorTexture::Constant(_) => false,
            ColorTexture::Node(node) => textures.color_needs_uv(*node),
        }
    }

    /// Adds to what is `found` of other textures.
    pub fn detail(&self, textures: &Textures, found: &mut TextureDetail) {
        if let ColorTexture::Node(node) = self {
            textures.color_detail(*node, found);
        }
    }

    /// Its mean over all places in linear RGB, about.
    pub fn mean(&self, textures: &Textures) -> [f32; 3] {
        match self {
            ColorTexture::Constant(color) => color.rgb(),
            ColorTexture::Node(node) => textures.color_mean(*node),
        }
    }
}

/// Any texture that something is made of.
#[derive(Clone, Copy, Debug)]
pub enum AnyTexture<'a> {
    /// A number.
    Float(FloatTexture),
    /// A colour.
    Color(&'a ColorTexture),
}

impl From<FloatTexture> for AnyTexture<'_> {
    fn from(texture: FloatTexture) -> Self {
        AnyTexture::Float(texture)
    }
}

impl<'a> From<&'a ColorTexture> for AnyTexture<'a> {
    fn from(texture: &'a ColorTexture) -> AnyTexture<'a> {
        AnyTexture::Color(texture)
    }
}

impl AnyTexture<'_> {
    /// Whether it is finite where it is the same everywhere; nodes have been asked, and reflectances are.
    pub fn is_finite(self) -> bool {
        !matches!(self, AnyTexture::Float(FloatTexture::Constant(value)) if !value.is_finite())
    }

    /// Whether it depends on surface coordinates.
    pub fn needs_uv(self, textures: &Textures) -> bool {
        match self {
            AnyTexture::Float(texture) => texture.needs_uv(textures),
            AnyTexture::Color(texture) => texture.needs_uv(textures),
        }
    }

    /// Adds to what is `found` of other textures.
    pub fn detail(self, textures: &Textures, found: &mut TextureDetail) {
        match self {
            AnyTexture::Float(texture) => texture.detail(textures, found),
            AnyTexture::Color(texture) => texture.detail(textures, found),
        }
    }

    /// Whether its node, if it names one, is among these.
    pub fn is_known(self, textures: &Textures) -> bool {
        match self {
            AnyTexture::Float(FloatTexture::Node(node)) => textures.floats.contains(node),
            AnyTexture::Color(ColorTexture::Node(node)) => textures.colors.contains(*node),
            AnyTexture::Float(_) | AnyTexture::Color(_) => true,
        }
    }
}
