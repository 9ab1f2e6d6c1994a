//! The blocks of the language, a file for each: what its fields are, and what is made of them.
//!
//! A new block is its own file and one line in the list of its family, here; the parser, the editor, `kajo help` and the
//! manual follow.

mod accretion_disk;
mod air_layers;
pub(super) mod algebraic;
pub(super) mod animation;
pub(super) mod bicubic_patch;
pub(super) mod bilinear_patch;
mod black_hole;
pub(super) mod blob;
pub(super) mod btf;
pub(super) mod checkerboard;
pub(super) mod cone;
pub(super) mod cuboid;
pub(super) mod curves;
pub(super) mod cylinder;
pub(super) mod directional_light;
pub(super) mod disk;
pub(super) mod distance_grid;
pub(super) mod fisheye_camera;
pub(super) mod function_medium;
pub(super) mod glass;
mod gradient_index;
mod gravitational_lens;
pub(super) mod grid_medium;
pub(super) mod group;
pub(super) mod height_field;
mod index_grid;
pub(super) mod interface;
pub(super) mod isosurface;
pub(super) mod lathe;
mod linear_index;
pub(super) mod lorentz;
mod luneburg_lens;
pub(super) mod marble;
pub(super) mod matte;
mod maxwell_fish_eye;
pub(super) mod measured;
pub(super) mod medium;
pub(super) mod metal;
pub(super) mod mix;
pub(super) mod model;
pub(super) mod noise;
pub(super) mod orthographic_camera;
pub(super) mod panorama_camera;
pub(super) mod patterns;
pub(super) mod perspective_camera;
pub(super) mod phase;
pub(super) mod phong_material;
pub(super) mod plane;
pub(super) mod point_light;
pub(super) mod polynomial;
pub(super) mod principled;
pub(super) mod prism;
pub(super) mod quad;
mod rod_lens;
pub(super) mod set_operations;
pub(super) mod sphere;
pub(super) mod sphere_sweep;
pub(super) mod spot_light;
pub(super) mod stereo_cubemap_camera;
pub(super) mod superellipsoid;
pub(super) mod text;
pub(super) mod texture_medium;
pub(super) mod texture_operations;
pub(super) mod torus;
pub(super) mod triangle;
pub(super) mod triangle_mesh;
pub(super) mod wood;
mod wormhole;

use self::patterns::PATTERNS;
use super::fields::PICTURE;
use super::member::{CameraMember, LightMember, MaterialMember, MediumMember, ObjectMember, TextureMember};
use crate::schema::{Absent, Block, FieldKind, FieldSpec, Kind};

/// All kinds of objects, in the order in which they are offered.
pub(super) const OBJECTS: [&ObjectMember; 35] = [
    &sphere::MEMBER,
    &cuboid::MEMBER,
    &plane::MEMBER,
    &cylinder::MEMBER,
    &cone::MEMBER,
    &torus::MEMBER,
    &superellipsoid::MEMBER,
    &blob::MEMBER,
    &isosurface::MEMBER,
    &algebraic::QUADRIC,
    &algebraic::CUBIC,
    &algebraic::QUARTIC,
    &polynomial::MEMBER,
    &distance_grid::MEMBER,
    &height_field::MEMBER,
    &prism::MEMBER,
    &text::MEMBER,
    &lathe::MEMBER,
    &sphere_sweep::MEMBER,
    &curves::MEMBER,
    &disk::MEMBER,
    &quad::MEMBER,
    &triangle::MEMBER,
    &bilinear_patch::MEMBER,
    &bicubic_patch::MEMBER,
    &triangle_mesh::MEMBER,
    &model::MEMBER,
    &set_operations::UNION,
    &set_operations::INTERSECTION,
    &set_operations::DIFFERENCE,
    &set_operations::MERGE,
    &group::GROUP,
    &group::TRANSFORM,
    &group::INSTANCE,
    &lorentz::MEMBER,
];

/// All kinds of cameras, in the order in which they are offered.
pub(super) const CAMERAS: [&CameraMember; 5] = [
    &perspective_camera::MEMBER,
    &orthographic_camera::MEMBER,
    &fisheye_camera::MEMBER,
    &panorama_camera::MEMBER,
    &stereo_cubemap_camera::MEMBER,
];

/// All kinds of lights.
pub(super) const LIGHTS: [&LightMember; 3] =
    [&directional_light::MEMBER, &point_light::MEMBER, &spot_light::MEMBER];

/// All kinds of materials, in the order in which they are offered.
pub(super) const MATERIALS: [&MaterialMember; 16] = [
    &phong_material::MEMBER,
    &phong_material::SHORT,
    &matte::MEMBER,
    &metal::MEMBER,
    &glass::MEMBER,
    &principled::MEMBER,
    &btf::MEMBER,
    &measured::MEMBER,
    &interface::MEMBER,
    &accretion_disk::MEMBER,
    &gravitational_lens::MEMBER,
    &checkerboard::MEMBER,
    &mix::MEMBER,
    &noise::MEMBER,
    &marble::MEMBER,
    &wood::MEMBER,
];

/// How many members a list or a group says it has.
const fn member_count(key: &'static str) -> FieldSpec {
    FieldSpec {
        absent: Absent::Nothing { means: "as many as there are", start: "1" },
        about: "how many there are, which is checked",
        ..FieldSpec::new(key, FieldKind::Count)
    }
}

pub(super) const LIGHT_COUNT: FieldSpec = member_count("numLights");

pub(super) const LIGHT_LIST: Block = Block {
    keyword: "Lights",
    kind: Kind::Lights,
    about: "the lights of the scene",
    groups: &[&[LIGHT_COUNT]],
    parts: &[],
};

pub(super) const MATERIAL_COUNT: FieldSpec = member_count("numMaterials");

pub(super) const MATERIAL_LIST: Block = Block {
    keyword: "Materials",
    kind: Kind::Materials,
    about: "the materials of the scene",
    groups: &[&[MATERIAL_COUNT]],
    parts: &[],
};

/// Textures that are made of others.
const TEXTURE_OPERATIONS: [&TextureMember; 8] = [
    &texture_operations::PLACED,
    &texture_operations::RAMP,
    &texture_operations::CURVE,
    &texture_operations::THRESHOLD,
    &texture_operations::BLEND,
    &texture_operations::MULTIPLY,
    &texture_operations::ADD,
    &texture_operations::FORMULA,
];

/// All kinds of textures that have names, in the order in which they are offered: patterns, and what is made of others.
pub(super) const TEXTURES: [&TextureMember; PATTERNS.len() + TEXTURE_OPERATIONS.len()] = {
    let mut all = [PATTERNS[0]; PATTERNS.len() + TEXTURE_OPERATIONS.len()];
    let mut i = 0;
    while i < all.len() {
        all[i] = if i < PATTERNS.len() { PATTERNS[i] } else { TEXTURE_OPERATIONS[i - PATTERNS.len()] };
        i += 1;
    }
    all
};

pub(super) const TEXTURE_LIST: Block = Block {
    keyword: "Textures",
    kind: Kind::Textures,
    about: "textures that have names",
    groups: &[],
    parts: &[],
};

/// All kinds of media, in the order in which they are offered.
pub(super) const MEDIA: [&MediumMember; 13] = [
    &medium::MEMBER,
    &grid_medium::MEMBER,
    &function_medium::MEMBER,
    &texture_medium::MEMBER,
    &gradient_index::MEMBER,
    &index_grid::MEMBER,
    &luneburg_lens::MEMBER,
    &maxwell_fish_eye::MEMBER,
    &rod_lens::MEMBER,
    &linear_index::MEMBER,
    &air_layers::MEMBER,
    &black_hole::MEMBER,
    &wormhole::MEMBER,
];

/// What names the medium of the air.
pub(super) const EXTERIOR: FieldSpec = FieldSpec {
    absent: Absent::Nothing { means: "empty space", start: "" },
    about: "name of the medium around everything",
    ..FieldSpec::new("exterior", FieldKind::Text)
};

pub(super) const MEDIUM_LIST: Block = Block {
    keyword: "Media",
    kind: Kind::Media,
    about: "what bodies and the air are filled with",
    groups: &[&[EXTERIOR]],
    parts: &[],
};

/// The word that chooses the material of what follows.
pub(super) const MATERIAL_INDEX: &str = "MaterialIndex";

/// Blocks that belong to no family.
const OTHERS: [&Block; 23] = [
    &blob::SPHERE,
    &blob::CYLINDER,
    &blob::PLANE,
    &prism::OUTLINE,
    &lathe::PROFILE,
    &sphere_sweep::PATH,
    &curves::STRAND,
    &super::settings::BLOCK,
    &animation::BLOCK,
    &super::background::BLOCK,
    &super::background::SKY,
    &super::background::STARS,
    &super::background::FOG,
    &LIGHT_LIST,
    &MATERIAL_LIST,
    &TEXTURE_LIST,
    &MEDIUM_LIST,
    &group::DEFINE,
    &super::motion::BLOCK,
    &super::motion::KEY,
    &super::follow_path::BLOCK,
    &super::world_line::BLOCK,
    &PICTURE,
];

/// All kinds of blocks.
pub fn blocks() -> impl Iterator<Item = &'static Block> {
    let objects = OBJECTS.iter().map(|member| &member.block);
    let lights = LIGHTS.iter().map(|member| &member.block);
    let cameras = CAMERAS.iter().map(|member| &member.block);
    let materials = MATERIALS.iter().map(|member| &member.block);
    let media = MEDIA.iter().map(|member| &member.block);
    let textures = TEXTURES.iter().map(|member| &member.block);
    objects.chain(cameras).chain(materials).chain(textures).chain(media).chain(OTHERS).chain(lights)
}

/// The block that begins with this word.
pub fn block_of(keyword: &str) -> Option<&'static Block> {
    blocks().find(|block| block.keyword == keyword)
}

/// The block that an item with this keyword begins within another one; `None` for `parent` outside of all that are known.
pub fn block_in(parent: Option<&Block>, keyword: &str) -> Option<&'static Block> {
    let Some(parent) = parent else { return block_of(keyword) };
    let of_family = || blocks().find(|block| block.keyword == keyword && parent.lists(block));
    parent.part(keyword).or_else(of_family)
}

/// The words of all blocks of a kind, in the order in which they are offered.
pub fn keywords_of(kind: Kind) -> impl Iterator<Item = &'static str> {
    blocks().filter(move |block| block.kind == kind).map(|block| block.keyword)
}

/// What a block with this keyword is, within a block of kind `parent`; in the list of a family it is taken for a member
/// whatever its word, so that numbers of materials stay while one is being typed.
pub fn kind_of(keyword: &str, parent: Option<Kind>) -> Kind {
    match parent {
        Some(Kind::Lights) => Kind::Light,
        Some(Kind::Materials) => Kind::Material,
        Some(Kind::Textures) => Kind::Texture,
        Some(Kind::Media) => Kind::Medium,
        Some(parent) if !parent.holds_objects() => Kind::Part,
        Some(_) | None => block_of(keyword).map_or(Kind::Part, |block| block.kind),
    }
}
