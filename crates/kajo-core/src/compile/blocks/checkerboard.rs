//! `Checkerboard`: two materials in cubes.

use crate::compile::material_draft::PARTS;
use crate::compile::member::{MaterialMember, Member};
use crate::compile::transform;
use crate::schema::{Block, Kind};
use crate::texture::Checker;

pub const MEMBER: MaterialMember = Member {
    block: Block {
        keyword: "Checkerboard",
        kind: Kind::Material,
        about: "two materials in cubes of length one",
        groups: &[PARTS],
        parts: &[&transform::PLACEMENT],
    },
    read: |compiler, item| compiler.blend(item, |_, sources| sources.textures.nodes.float(Checker)),
};
