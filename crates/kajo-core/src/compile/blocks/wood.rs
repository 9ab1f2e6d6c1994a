//! `Wood`: rings of two materials.

use super::marble::VeinKeys;
use crate::compile::fields::Keys;
use crate::compile::material_draft::PARTS;
use crate::compile::member::{MaterialMember, Member};
use crate::compile::transform;
use crate::schema::{Block, Kind};
use crate::texture::Wood;

pub const MEMBER: MaterialMember = Member {
    block: Block {
        keyword: "Wood",
        kind: Kind::Material,
        about: "two materials in rings around an axis",
        groups: &[PARTS, VeinKeys::FIELDS],
        parts: &[&transform::PLACEMENT],
    },
    read: |compiler, item| {
        compiler.blend(item, |params, sources| {
            let VeinKeys { octaves, frequency, amplitude } = VeinKeys::read(params, sources)?;
            sources.textures.nodes.float(Wood { octaves, frequency, amplitude })
        })
    },
};
