//! Textures: numbers and colours that vary over surfaces and in space.
//!
//! A parameter of a material is a [`FloatTexture`] or a [`ColorTexture`]: the same everywhere, or the name of a node in [`Textures`], which
//! is evaluated at a [`TextureContext`]. Nodes are pictures laid on surfaces, and patterns, which fill space; a node may be
//! made of others.

mod channel;
mod checker;
mod combination;
mod context;
mod coordinates;
mod curve;
mod expression;
mod filtered;
mod footprint;
mod integral;
mod knots;
mod mapping;
mod marble;
mod named;
mod noise;
mod normal_spread;
mod operations;
mod pattern;
mod picture;
mod placed;
mod ramp;
mod rgb;
mod slope;
mod surface_share;
mod value;
mod vertex_color;
mod wood;

pub use channel::{Channel, PictureChannel, PictureCut};
pub use checker::Checker;
pub use combination::{ColorCombination, ColorOperation, FloatCombination, FloatOperation};
pub use context::TextureContext;
pub use coordinates::UvSet;
pub use curve::{Curve, CurveNumbers};
pub use expression::Expression;
pub use filtered::FilteredNumber;
pub use footprint::TextureFootprint;
pub use knots::{Interpolation, Knots};
pub use mapping::{MappedColor, MappedFloat, Mapping, Projection, TextureSpace};
pub use marble::Marble;
pub use named::NamedTexture;
pub use noise::Noise;
pub use normal_spread::{FilteredNormals, NormalSpread};
pub use operations::{Complement, Remapped};
pub use pattern::PatternNode;
pub(crate) use picture::content_stamp;
pub use picture::{
    Encoding, Picture, PictureMap, ReadAt, TILED_EXTENSION, TexelFilter, TextureDetail, TileCache, TileFiles,
    TiledCopies, TiledError, Tiling, TilingRule, Wrap,
};
pub use placed::Placed;
pub use ramp::{Colors, Cycle, Grey, Lightness, Ramp};
pub(crate) use rgb::rgb_reflectance;
pub use slope::TextureSlope;
pub use surface_share::SurfaceShare;
pub use value::{AnyTexture, ColorTexture, FloatTexture, TextureEvaluator};
pub use vertex_color::{VertexColor, VertexOpacity};
pub use wood::Wood;

use kajo_color::{Spectrum, Wavelengths};
use kajo_math::Vec2;

use crate::family::family;
pub use crate::interaction::SurfaceUv;

/// What every node can do that is a number, in [0, 1].
pub trait FloatNode {
    /// Whether all its own numbers are finite.
    fn is_finite(&self) -> bool;

    /// The texture that it is made of, if it is one number.
    fn part(&self) -> Option<FloatTexture> {
        None
    }

    /// All textures that it is made of.
    fn parts(&self) -> Vec<AnyTexture<'_>> {
        self.part().into_iter().map(AnyTexture::from).collect()
    }

    /// Whether what it answers depends on [`TextureContext::footprint`], parts left out.
    fn wants_footprint(&self) -> bool {
        false
    }

    /// Whether what it answers depends on [`TextureContext::object_from_world`], parts left out.
    fn wants_object_space(&self) -> bool {
        false
    }

    /// Whether it lies on the second set of surface coordinates, parts left out.
    fn is_on_second_set(&self) -> bool {
        false
    }

    /// Makes what it shares with others that show the same picture.
    fn prepare(&self) {}

    /// The number at a point.
    fn value(&self, textures: &Textures, at: &TextureContext) -> f32;

    /// Whether it is, or is made of, something that is filtered by [`TextureContext::footprint`].
    fn is_filtered(&self, textures: &Textures) -> bool {
        self.part().is_some_and(|part| part.is_filtered(textures))
    }

    /// The number at a point, with what is known of how it varies within the footprint; nothing unless it says otherwise.
    fn filtered(&self, textures: &Textures, at: &TextureContext) -> FilteredNumber {
        FilteredNumber::point(self.value(textures, at))
    }

    /// The number where it is an opacity, which the opacity at the corners of a mesh is another factor of.
    fn covered(&self, textures: &Textures, at: &TextureContext) -> f32 {
        self.value(textures, at) * at.cover()
    }

    /// Whether the number depends on surface coordinates.
    fn needs_uv(&self, textures: &Textures) -> bool {
        self.part().is_some_and(|part| part.needs_uv(textures))
    }

    /// The derivatives of `factor` times it; those of a pattern unless it says otherwise.
    fn slope(&self, textures: &Textures, at: &TextureContext, factor: f32) -> TextureSlope {
        TextureSlope::in_space(at, factor, |at| self.value(textures, at))
    }

    /// Adds to what is `found` of other textures; a pattern unless it has a part or says otherwise.
    fn detail(&self, textures: &Textures, found: &mut TextureDetail) {
        match self.part() {
            Some(part) => part.detail(textures, found),
            None => (found.has_pattern, found.jumps) = (true, true),
        }
    }

    /// Its mean over all places, about.
    fn mean(&self, _textures: &Textures) -> f32 {
        0.5
    }
}

family! {
    /// Names a node in [`FloatNodes`].
    handle FloatNodeId;
    /// All nodes of a scene that are numbers.
    pools FloatNodes;
    /// Any node that is a number.
    any AnyFloatNode;
    contract FloatNode;
    members {
        channels: PictureChannel,
        checkers: Checker,
        combinations: FloatCombination,
        complements: Complement,
        curves: Curve,
        cuts: PictureCut,
        expressions: Expression,
        lightnesses: Lightness,
        mapped: MappedFloat,
        marbles: Marble,
        noises: Noise,
        patterns: PatternNode,
        placed: Placed,
        remapped: Remapped,
        surface_shares: SurfaceShare,
        vertex_opacities: VertexOpacity,
        woods: Wood,
    }
    any methods {
        /// See [`FloatNode::is_finite`].
        fn is_finite() -> bool;
        /// See [`FloatNode::parts`].
        fn parts() -> Vec<AnyTexture<'_>>;
        /// See [`FloatNode::wants_footprint`].
        fn wants_footprint() -> bool;
        /// See [`FloatNode::wants_object_space`].
        fn wants_object_space() -> bool;
        /// See [`FloatNode::is_on_second_set`].
        fn is_on_second_set() -> bool;
        /// See [`FloatNode::prepare`].
        fn prepare() -> ();
    }
    methods {}
    methods of Textures.floats {
        /// See [`FloatNode::mean`].
        fn mean() -> f32;
        /// See [`FloatNode::needs_uv`].
        fn needs_uv() -> bool;
        /// See [`FloatNode::detail`].
        fn detail(found: &mut TextureDetail);
        /// See [`FloatNode::value`].
        fn value(at: &TextureContext) -> f32;
        /// See [`FloatNode::is_filtered`].
        fn is_filtered() -> bool;
        /// See [`FloatNode::filtered`].
        fn filtered(at: &TextureContext) -> FilteredNumber;
        /// See [`FloatNode::covered`].
        fn covered(at: &TextureContext) -> f32;
        /// See [`FloatNode::slope`].
        fn slope(at: &TextureContext, factor: f32) -> TextureSlope;
    }
}

/// What every node can do that is a colour.
pub trait ColorNode {
    /// Whether all its own numbers are finite.
    fn is_finite(&self) -> bool;

    /// All textures that it is made of.
    fn parts(&self) -> Vec<AnyTexture<'_>> {
        Vec::new()
    }

    /// Whether what it answers depends on [`TextureContext::footprint`], parts left out.
    fn wants_footprint(&self) -> bool {
        false
    }

    /// Whether what it answers depends on [`TextureContext::object_from_world`], parts left out.
    fn wants_object_space(&self) -> bool {
        false
    }

    /// Whether it lies on the second set of surface coordinates, parts left out.
    fn is_on_second_set(&self) -> bool {
        false
    }

    /// Makes what it shares with others that show the same picture.
    fn prepare(&self) {}

    /// The reflectance at a point.
    fn reflectance(&self, textures: &Textures, at: &TextureContext, wavelengths: &Wavelengths) -> Spectrum;

    /// Whether it is, or is made of, something that is filtered by [`TextureContext::footprint`].
    fn color_is_filtered(&self, _textures: &Textures) -> bool {
        false
    }

    /// Whether the colour depends on surface coordinates.
    fn color_needs_uv(&self, textures: &Textures) -> bool;

    /// Adds to what is `found` of other textures.
    fn color_detail(&self, textures: &Textures, found: &mut TextureDetail);

    /// A direction of the texture's own coordinates as one of the surface coordinates that place it.
    fn along(&self, m: Vec2) -> Vec2 {
        m
    }

    /// As normals `m = 2 rgb - 1`, where [`ColorNode::reflectance`] is the mean of those within the footprint and they differ.
    fn filtered_normals(&self, _textures: &Textures, _at: &TextureContext) -> Option<FilteredNormals> {
        None
    }

    /// Its mean over all places in linear RGB, about.
    fn color_mean(&self, textures: &Textures) -> [f32; 3];
}

family! {
    /// Names a node in [`ColorNodes`].
    handle ColorNodeId;
    /// All nodes of a scene that are colours.
    pools ColorNodes;
    /// Any node that is a colour.
    any AnyColorNode;
    contract ColorNode;
    members {
        combinations: ColorCombination,
        greys: Grey,
        mapped: MappedColor,
        pictures: PictureMap,
        ramps: Ramp,
        vertex_colors: VertexColor,
    }
    any methods {
        /// See [`ColorNode::parts`].
        fn parts() -> Vec<AnyTexture<'_>>;
        /// See [`ColorNode::is_finite`].
        fn is_finite() -> bool;
        /// See [`ColorNode::wants_footprint`].
        fn wants_footprint() -> bool;
        /// See [`ColorNode::wants_object_space`].
        fn wants_object_space() -> bool;
        /// See [`ColorNode::is_on_second_set`].
        fn is_on_second_set() -> bool;
        /// See [`ColorNode::prepare`].
        fn prepare() -> ();
    }
    methods {
        /// See [`ColorNode::along`].
        fn along(m: Vec2) -> Vec2;
    }
    methods of Textures.colors {
        /// See [`ColorNode::color_mean`].
        fn color_mean() -> [f32; 3];
        /// See [`ColorNode::color_is_filtered`].
        fn color_is_filtered() -> bool;
        /// See [`ColorNode::color_needs_uv`].
        fn color_needs_uv() -> bool;
        /// See [`ColorNode::color_detail`].
        fn color_detail(found: &mut TextureDetail);
        /// See [`ColorNode::reflectance`].
        fn reflectance(at: &TextureContext, wavelengths: &Wavelengths) -> Spectrum;
        /// See [`ColorNode::filtered_normals`].
        fn filtered_normals(at: &TextureContext) -> Option<FilteredNormals>;
    }
}

/// All textures of a scene: what nodes are evaluated in.
#[derive(Debug, Default)]
pub struct Textures {
    /// Numbers.
    pub floats: FloatNodes,
    /// Colours.
    pub colors: ColorNodes,
    wants_footprint: bool,
    wants_object_space: bool,
    has_second_set: bool,
}

impl Textures {
    /// The texture of a node that is a number; `None` where there are too many.
    pub fn float(&mut self, node: impl Into<AnyFloatNode>) -> Option<FloatTexture> {
        let node = node.into();
        self.wants_footprint |= node.wants_footprint();
        self.wants_object_space |= node.wants_object_space();
        self.has_second_set |= node.is_on_second_set();
        node.prepare();
        node.store(&mut self.floats).map(FloatTexture::Node)
    }

    /// The texture of a node that is a colour; `None` where there are too many.
    pub fn color(&mut self, node: impl Into<AnyColorNode>) -> Option<ColorTexture> {
        let node = node.into();
        self.wants_footprint |= node.wants_footprint();
        self.wants_object_space |= node.wants_object_space();
        self.has_second_set |= node.is_on_second_set();
        node.prepare();
        node.store(&mut self.colors).map(ColorTexture::Node)
    }

    /// Whether what any node answers depends on [`TextureContext::footprint`].
    pub fn wants_footprint(&self) -> bool {
        self.wants_footprint
    }

    /// Whether what any node answers depends on [`TextureFootprint::second_uv`].
    pub fn wants_second_footprint(&self) -> bool {
        self.wants_footprint && self.has_second_set
    }

    /// Whether what any node answers depends on [`TextureContext::object_from_world`].
    pub fn wants_object_space(&self) -> bool {
        self.wants_object_space
    }

    /// What textures are evaluated by at a point.
    #[inline]
    pub fn evaluator<'a>(&'a self, at: &'a TextureContext) -> TextureEvaluator<'a> {
        TextureEvaluator { textures: self, at }
    }

    /// Bytes of memory of all nodes, without what they point to.
    pub fn bytes(&self) -> usize {
        self.floats.bytes() + self.colors.bytes()
    }
}

/// A number in about [-1, 1] brought to [0, 1].
pub(crate) fn unit_from_signed(v: f32) -> f32 {
    (0.5 + 0.5 * v).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo_math::{Affine3A, Vec3, noise::perlin};

    #[test]
    fn checker_follows_the_classic_parity() {
        // The rule for positive and negative cells, and the reference's own result on whole negative numbers.
        for (q, first) in [
            (Vec3::new(0.5, 0.5, 0.5), true),
            (Vec3::new(1.5, 0.5, 0.5), false),
            (Vec3::new(-0.5, 0.5, 0.5), false),
            (Vec3::new(-1.5, 0.5, 0.5), true),
            (Vec3::new(-0.5, -0.5, 0.5), true),
            (Vec3::new(7.2, -3.1, 2.9), false),
            (Vec3::new(-1.0, 0.5, 0.5), true),
        ] {
            assert_eq!(Checker.at(q) == 0.0, first, "{q}");
        }
        for i in 0..1000 {
            let s = kajo_math::rng::Stream::new(5, [i, 0], 0);
            let q = 20.0 * Vec3::new(s.uniform(0), s.uniform(1), s.uniform(2)) - 10.0;
            let even = q.floor().element_sum().rem_euclid(2.0) == 0.0;
            assert_eq!(Checker.at(q) == 0.0, even, "{q}");
        }
    }

    #[test]
    fn patterns_follow_their_formulas() {
        let q = Vec3::new(0.3, 1.7, -2.2);
        let turbulence = perlin(q) + 0.5 * perlin(2.0 * q);
        let noise = Noise { octaves: 2 }.at(q);
        assert!((noise - (0.5 + 0.5 * turbulence)).abs() < 1e-6);
        let marble = Marble { octaves: 2, frequency: 3.0, amplitude: 4.0 }.at(q);
        assert!((marble - (0.5 + 0.5 * (3.0 * 0.3 + 4.0 * turbulence).sin())).abs() < 1e-5);
        let wood = Wood { octaves: 2, frequency: 3.0, amplitude: 4.0 }.at(q);
        let rings = 3.0 * (0.3f32 * 0.3 + 2.2 * 2.2).sqrt();
        assert!((wood - (0.5 + 0.5 * (rings + 4.0 * turbulence).sin())).abs() < 1e-5);
    }

    #[test]
    fn a_placed_texture_is_evaluated_in_its_own_space() {
        let mut textures = Textures::default();
        let noise = Noise { octaves: 2 };
        let texture = textures.float(noise).unwrap();
        let texture_from_world = Affine3A::from_scale(Vec3::new(2.0, 3.0, -1.0));
        let twice = textures.float(Placed { texture, texture_from_world }).unwrap();
        let thrice = textures.float(Placed { texture: twice, texture_from_world }).unwrap();
        let p = Vec3::new(0.4, -0.3, 0.9);
        let at = TextureContext { p, ..TextureContext::default() };
        let own = Vec3::new(2.0, 3.0, -1.0) * p;
        assert_eq!(twice.at(textures.evaluator(&at)), noise.at(own));
        assert_eq!(thrice.at(textures.evaluator(&at)), noise.at(Vec3::new(2.0, 3.0, -1.0) * own));
    }

    #[test]
    fn slopes_are_derivatives() {
        let mut textures = Textures::default();
        let bands = textures.float(Marble { octaves: 1, frequency: 3.0, amplitude: 0.0 }).unwrap();
        let texture_from_world = Affine3A::from_scale(Vec3::new(2.0, 1.0, 1.0));
        let narrow = textures.float(Placed { texture: bands, texture_from_world }).unwrap();
        let rest = textures.float(Complement(narrow)).unwrap();
        let wide = textures.float(Remapped { texture: rest, range: [1.0, 5.0] }).unwrap();
        for p in [Vec3::new(0.3, 0.1, -0.2), Vec3::new(-4.0, 0.0, 9.0)] {
            let at = TextureContext { p, ..TextureContext::default() };
            let evaluator = textures.evaluator(&at);
            let slope = |texture: FloatTexture| {
                let TextureSlope { uv, p } = texture.slope(evaluator, 0.5);
                assert!(uv == Vec2::ZERO && p.y.abs() < 1e-4 && p.z.abs() < 1e-4, "{p}");
                p.x
            };
            // Of (1 + sin 3x) / 2, half of it.
            let expected = |x: f32| 0.75 * (3.0 * x).cos();
            for (texture, expected) in [
                (0.7.into(), 0.0),
                (bands, expected(p.x)),
                (narrow, 2.0 * expected(2.0 * p.x)),
                (rest, -2.0 * expected(2.0 * p.x)),
                (wide, -8.0 * expected(2.0 * p.x)),
            ] {
                assert!((slope(texture) - expected).abs() < 5e-3, "{texture:?} at {p}: {expected}");
            }
            let nowhere = TextureContext { p: Vec3::NAN, ..at };
            assert_eq!(bands.slope(textures.evaluator(&nowhere), 0.0), TextureSlope::default(), "not asked");
            let [number, left] = [narrow, rest].map(|texture| texture.at(evaluator));
            assert_eq!((left, wide.at(evaluator)), (1.0 - number, 1.0 + 4.0 * left));
        }
    }
}
