//! `Mix`: two materials in the same proportion everywhere, or in that of a texture.

use crate::compile::fields::{Keys, keys, share};
use crate::compile::material_draft::PARTS;
use crate::compile::member::{MaterialMember, Member};
use crate::compile::transform;
use crate::schema::{Block, Kind};
use crate::texture::FloatTexture;

keys! {
    MixKeys {
        amount: FloatTexture = share("amount").or(0.5, "share of the second"),
    }
}

pub const MEMBER: MaterialMember = Member {
    block: Block {
        keyword: "Mix",
        kind: Kind::Material,
        about: "two materials in the same proportion everywhere",
        groups: &[PARTS, MixKeys::FIELDS],
        parts: &[&transform::PLACEMENT],
    },
    read: |compiler, item| {
        compiler
            .blend(item, |params, sources| MixKeys::read(params, sources).map(|MixKeys { amount }| amount))
    },
};
