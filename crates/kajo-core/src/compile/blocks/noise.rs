//! `Noise`: clouds of two materials.

use super::marble::OCTAVES;
use crate::compile::fields::{Keys, keys};
use crate::compile::material_draft::PARTS;
use crate::compile::member::{MaterialMember, Member};
use crate::compile::transform;
use crate::schema::{Block, Kind};
use crate::texture::Noise;

keys! {
    NoiseKeys {
        octaves: u32 = OCTAVES,
    }
}

pub const MEMBER: MaterialMember = Member {
    block: Block {
        keyword: "Noise",
        kind: Kind::Material,
        about: "two materials in clouds",
        groups: &[PARTS, NoiseKeys::FIELDS],
        parts: &[&transform::PLACEMENT],
    },
    read: |compiler, item| {
        compiler.blend(item, |params, sources| {
            let NoiseKeys { octaves } = NoiseKeys::read(params, sources)?;
            sources.textures.nodes.float(Noise { octaves })
        })
    },
};
