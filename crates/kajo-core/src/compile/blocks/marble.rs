//! `Marble`: veins of two materials.

use crate::compile::fields::{Defaulted, Keys, count, keys, number};
use crate::compile::material_draft::PARTS;
use crate::compile::member::{MaterialMember, Member};
use crate::compile::transform;
use crate::schema::{Block, Kind};
use crate::texture::Marble;

/// How many octaves of noise are added up.
pub const OCTAVES: Defaulted<u32> = count("octaves", 0, 32).or(1, "levels of detail");

keys! {
    /// The keys of patterns that noise bends.
    pub(super) VeinKeys {
        octaves: u32 = OCTAVES,
        frequency: f32 = number("frequency").unit("1/length").or(1.0, "rings or veins per length"),
        amplitude: f32 = number("amplitude").or(1.0, "how strongly the noise bends them"),
    }
}

pub const MEMBER: MaterialMember = Member {
    block: Block {
        keyword: "Marble",
        kind: Kind::Material,
        about: "two materials in veins",
        groups: &[PARTS, VeinKeys::FIELDS],
        parts: &[&transform::PLACEMENT],
    },
    read: |compiler, item| {
        compiler.blend(item, |params, sources| {
            let VeinKeys { octaves, frequency, amplitude } = VeinKeys::read(params, sources)?;
            sources.textures.nodes.float(Marble { octaves, frequency, amplitude })
        })
    },
};
