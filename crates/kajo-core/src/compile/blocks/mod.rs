//! The blocks of the language, a file for each: what its fields are, and what is made of them.
//!
//! A family of blocks has a list of its members beside the code that walks over them (`lights.rs` for lights). A new
//! block is its own file here and one line in that list; the editor, `kajo help` and the manual follow.

pub(super) mod checkerboard;
pub(super) mod cone;
pub(super) mod cuboid;
pub(super) mod cylinder;
pub(super) mod directional_light;
pub(super) mod disk;
pub(super) mod fisheye_camera;
pub(super) mod glass;
pub(super) mod group;
pub(super) mod marble;
pub(super) mod matte;
pub(super) mod metal;
pub(super) mod mix;
pub(super) mod model;
pub(super) mod noise;
pub(super) mod orthographic_camera;
pub(super) mod panorama_camera;
pub(super) mod perspective_camera;
pub(super) mod phong_material;
pub(super) mod plane;
pub(super) mod point_light;
pub(super) mod principled;
pub(super) mod quad;
pub(super) mod sphere;
pub(super) mod spot_light;
pub(super) mod stereo_cubemap_camera;
pub(super) mod triangle;
pub(super) mod triangle_mesh;
pub(super) mod wood;

use crate::schema::{Block, Kind};

/// A block of a family, and what reads it.
pub(super) struct Member<F> {
    pub block: Block,
    pub read: F,
}

/// The words of the members of a family.
pub(super) const fn keywords<F, const N: usize>(members: &[&Member<F>; N]) -> [&'static str; N] {
    let mut words = [""; N];
    let mut i = 0;
    while i < N {
        words[i] = members[i].block.keyword;
        i += 1;
    }
    words
}

/// Blocks that belong to no family.
const OTHERS: [&Block; 9] = [
    &super::settings::BLOCK,
    &super::background::BLOCK,
    &super::background::SKY,
    &super::background::FOG,
    &super::lights::LIST,
    &super::materials::LIST,
    &group::DEFINE,
    &super::motion::BLOCK,
    &super::motion::KEY,
];

/// All kinds of blocks.
pub fn blocks() -> impl Iterator<Item = &'static Block> {
    let objects = super::group::MEMBERS.iter().map(|member| &member.block);
    let lights = super::lights::MEMBERS.iter().map(|member| &member.block);
    let cameras = super::camera::MEMBERS.iter().map(|member| &member.block);
    let materials = super::materials::MEMBERS.iter().map(|member| &member.block);
    objects.chain(cameras).chain(materials).chain(OTHERS).chain(lights)
}

/// The block that begins with this word.
pub fn block_of(keyword: &str) -> Option<&'static Block> {
    blocks().find(|block| block.keyword == keyword)
}

/// The words of all blocks of a kind, in the order in which they are offered.
pub fn keywords_of(kind: Kind) -> impl Iterator<Item = &'static str> {
    blocks().filter(move |block| block.kind == kind).map(|block| block.keyword)
}

/// What a block with this keyword is, within a block of kind `parent`.
pub fn kind_of(keyword: &str, parent: Option<Kind>) -> Kind {
    match parent {
        Some(Kind::Lights) => Kind::Light,
        Some(Kind::Materials) => Kind::Material,
        Some(parent) if !parent.holds_objects() => Kind::Part,
        Some(_) | None => block_of(keyword).map_or(Kind::Part, |block| block.kind),
    }
}
