//! `Mix`: two materials in the same proportion everywhere.

use crate::compile::fields::{Keys, between, keys};
use crate::compile::material_draft::PARTS;
use crate::compile::member::{MaterialMember, Member};
use crate::schema::{Block, Kind};

keys! {
    MixKeys {
        amount: f32 = between("amount", 0.0, 1.0).or(0.5, "share of the second"),
    }
}

pub const MEMBER: MaterialMember = Member {
    block: Block {
        keyword: "Mix",
        kind: Kind::Material,
        about: "two materials in the same proportion everywhere",
        groups: &[PARTS, MixKeys::FIELDS],
    },
    read: |compiler, item| {
        compiler.blend(item, |params, sources| {
            MixKeys::read(params, sources).map(|MixKeys { amount }| amount.into())
        })
    },
};
