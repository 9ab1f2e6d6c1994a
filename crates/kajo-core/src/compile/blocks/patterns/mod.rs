//! Patterns that have names: what all of them have in common.

pub mod bands;
pub mod cellular;
pub mod noises;
pub mod tilings;

use std::sync::Arc;

use kajo_math::Affine3A;
use kajo_math::pattern::{AnyPattern, Octaves, SolidPattern, TurbulentWarp, Wave};
use kajo_scene::{Diagnostic, Params};

use crate::compile::fields::{
    Defaulted, Keys, Sources, at_least, between, choice, choices, count, degrees, flag, keys, number,
    positive,
};
use crate::compile::member::TextureMember;
use crate::compile::named_texture::NamedTexture;
use crate::compile::transform;
use crate::texture::{
    FloatTexture, MappedColor, MappedFloat, Mapping, PatternNode, Projection, TextureSpace, UvSet,
};

/// All patterns, in the order in which they are offered.
pub const PATTERNS: [&TextureMember; 23] = [
    &tilings::BRICK,
    &tilings::HEXAGONS,
    &tilings::CHECKS,
    &tilings::CELLS,
    &bands::GRADIENT,
    &bands::RADIAL,
    &bands::SPIRAL,
    &bands::ONION,
    &noises::CLOUDS,
    &noises::TURBULENCE,
    &noises::RIDGED,
    &noises::WRINKLES,
    &noises::GRANITE,
    &noises::GABOR,
    &bands::VEINS,
    &bands::AGATE,
    &bands::RINGS,
    &bands::TIMBER,
    &cellular::WORLEY,
    &cellular::CRACKLE,
    &bands::LEOPARD,
    &bands::RIPPLES,
    &bands::WAVES,
];

/// The words for projections.
#[derive(Clone, Copy, PartialEq)]
pub enum ProjectionName {
    Solid,
    Uv,
    Planar,
    Spherical,
    Cylindrical,
    Cubic,
    Triplanar,
    Camera,
}

choices! {
    ProjectionName {
        "camera" => ProjectionName::Camera,
        "cubic" => ProjectionName::Cubic,
        "cylindrical" => ProjectionName::Cylindrical,
        "planar" => ProjectionName::Planar,
        "solid" => ProjectionName::Solid,
        "spherical" => ProjectionName::Spherical,
        "triplanar" => ProjectionName::Triplanar,
        "uv" => ProjectionName::Uv,
    }
}

choices! {
    TextureSpace {
        "object" => TextureSpace::Object,
        "world" => TextureSpace::World,
    }
}

choices! {
    Wave {
        "once" => Wave::Once,
        "saw" => Wave::Saw,
        "sine" => Wave::Sine,
        "triangle" => Wave::Triangle,
    }
}

keys! {
    /// Where a texture is.
    pub(super) PlacementKeys {
        space: TextureSpace = choice::<TextureSpace>("space")
            .or_word("world", "what it is placed in: the world, or the space in which the fields of the shape are written"),
        size: f32 = positive("size").unit("length").or(1.0, "length of the unit that it is described in"),
        projection: ProjectionName = choice::<ProjectionName>("projection")
            .or_word("solid", "how it is laid on surfaces"),
        uv_set: u32 = count("uvSet", 1, 2).or(1, "which surface coordinates `projection uv` takes"),
        angle: f32 = degrees("angle", 0.01, 179.0).or(90.0, "opening of `projection camera`"),
        warp: f32 = number("warp").or(0.0, "by how many units turbulence moves it"),
        warp_octaves: u32 = count("warpOctaves", 1, 16).or(6, "levels of detail of the turbulence"),
        lambda: f32 = between("lambda", 1.0, 16.0).or(2.0, "frequency of a level by that of the one before"),
        omega: f32 = between("omega", 0.0, 1.0).or(0.5, "size of a level by that of the one before"),
        filter: bool = flag("filter").or(false, "faded where it is finer than samples are apart"),
    }
}

/// How many octaves there are.
const OCTAVES: Defaulted<u32> = count("octaves", 1, 16).or(6, "levels of detail");

/// Which of many patterns of a kind.
const SEED: Defaulted<u32> = count("seed", 0, 999_999_999).or(0, "chooses one of many");

keys! {
    /// Sums of noise.
    pub(super) OctaveKeys {
        octaves: u32 = OCTAVES,
        gain: f32 = between("gain", 0.01, 1.0).or(0.5, "size of a level by that of the one before"),
        lacunarity: f32 = between("lacunarity", 1.0, 16.0).or(2.0, "frequency of a level by that of the one before"),
        seed: u32 = SEED,
    }
}

impl OctaveKeys {
    fn octaves(self) -> Octaves {
        let OctaveKeys { octaves, gain, lacunarity, seed } = self;
        Octaves { count: octaves, gain, lacunarity, seed }
    }
}

keys! {
    /// What has a seed and nothing else.
    pub(super) SeedKeys {
        seed: u32 = SEED,
    }
}

impl PlacementKeys {
    fn warp(&self) -> Option<TurbulentWarp> {
        (self.warp != 0.0).then_some(TurbulentWarp {
            amount: kajo_math::Vec3::splat(self.warp),
            octaves: self.warp_octaves,
            lambda: self.lambda,
            omega: self.omega,
            seed: 0,
        })
    }

    fn projection(&self) -> Projection {
        match self.projection {
            ProjectionName::Solid => Projection::Solid,
            ProjectionName::Uv if self.uv_set == 2 => Projection::Uv(UvSet::Second),
            ProjectionName::Uv => Projection::Uv(UvSet::First),
            ProjectionName::Planar => Projection::Planar,
            ProjectionName::Spherical => Projection::Spherical,
            ProjectionName::Cylindrical => Projection::Cylindrical,
            ProjectionName::Cubic => Projection::Cubic,
            ProjectionName::Triplanar => Projection::Triplanar,
            ProjectionName::Camera => {
                Projection::Camera { tan_half: kajo_math::fmath::tan(0.5 * self.angle.to_radians()) }
            }
        }
    }
}

/// Where a texture is, by the keys and the `Transform` of its block; `None` inside where that is where it was.
pub(super) fn placement(
    params: &mut Params<'_, '_>,
    sources: &mut Sources<'_>,
) -> Option<(Option<Mapping>, bool)> {
    let transform = params.block(transform::PLACEMENT.keyword);
    let keys = PlacementKeys::read(params, sources)?;
    if keys.warp == 0.0 {
        params.idle(&["warpOctaves", "lambda", "omega"], "without a `warp`");
    }
    if keys.projection != ProjectionName::Camera {
        params.idle(&["angle"], "without `projection camera`");
    }
    if keys.projection != ProjectionName::Uv {
        params.idle(&["uvSet"], "without `projection uv`");
    }
    let by_rows = sources.rules.matrix_by_rows;
    let space_from_texture = match transform {
        Some(item) => transform::read_alone(item, by_rows, params.diagnostics())?,
        None => Affine3A::IDENTITY,
    };
    let texture_from_space = space_from_texture.inverse();
    if !texture_from_space.is_finite() {
        let error = Diagnostic::error("this `Transform` leaves a texture no space");
        params.report(error.help("no axis may be scaled by 0"), "has no place in the world");
        return None;
    }
    let warp = keys.warp();
    let projection = keys.projection();
    let is_plain = keys.space == TextureSpace::World
        && transform.is_none()
        && projection == Projection::Solid
        && keys.size == 1.0
        && warp.is_none();
    let mapping = Mapping {
        space: keys.space,
        texture_from_space,
        projection,
        size: keys.size,
        warp,
        is_filtered: keys.filter,
    };
    Some(((!is_plain).then_some(mapping), keys.filter))
}

/// A pattern at the place that its block says.
fn pattern(
    params: &mut Params<'_, '_>,
    sources: &mut Sources<'_>,
    read: impl FnOnce(&mut Params<'_, '_>, &mut Sources<'_>) -> Option<AnyPattern>,
) -> Option<NamedTexture> {
    let pattern = read(params, sources);
    let placed = placement(params, sources);
    let (pattern, (mapping, is_filtered)) = (pattern?, placed?);
    let node = PatternNode { solid: SolidPattern::new(pattern), is_filtered };
    let texture = sources.textures.nodes.float(node)?;
    mapped(NamedTexture::Float(texture), mapping, sources)
}

/// A texture at another place.
pub(super) fn mapped(
    texture: NamedTexture,
    mapping: Option<Mapping>,
    sources: &mut Sources<'_>,
) -> Option<NamedTexture> {
    let Some(mapping) = mapping.map(Arc::new) else { return Some(texture) };
    let nodes = &mut sources.textures.nodes;
    match texture {
        NamedTexture::Float(texture @ FloatTexture::Node(_)) => {
            nodes.float(MappedFloat { texture, mapping }).map(NamedTexture::Float)
        }
        NamedTexture::Float(constant) => Some(NamedTexture::Float(constant)),
        NamedTexture::Color(texture) => {
            nodes.color(MappedColor { texture, mapping }).map(NamedTexture::Color)
        }
    }
}

/// A pattern of a file of this folder: its block, and what its keys make.
macro_rules! pattern_member {
    ($name:ident, $keyword:literal, $about:literal, [$($Keys:ident),*], |$params:ident, $sources:ident| $read:expr) => {
        pub const $name: crate::compile::member::TextureMember = crate::compile::member::Member {
            block: crate::schema::Block {
                keyword: $keyword,
                kind: crate::schema::Kind::Texture,
                about: $about,
                groups: &[$($Keys::FIELDS,)* super::PlacementKeys::FIELDS],
                parts: &[&crate::compile::transform::PLACEMENT],
            },
            read: |params, sources| super::pattern(params, sources, |$params, $sources| Some($read.into())),
        };
    };
}

use pattern_member;

/// A number that is not negative, by the name that patterns have for it.
const fn amount(key: &'static str, default: f32, about: &'static str) -> Defaulted<f32> {
    at_least(key, 0.0).or(default, about)
}
