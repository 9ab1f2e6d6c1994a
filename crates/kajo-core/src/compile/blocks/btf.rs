//! `BTF`: a surface whose texels were measured, or rendered, for many directions of view and light.

use kajo_math::Vec2;

use crate::compile::extras::ExtraKeys;
use crate::compile::fields::{At, FileName, Keys, choice, choices, file, float_texture, keys, pair};
use crate::compile::member::{MaterialMember, Member};
use crate::material::{BtfMaterial, BtfSettings};
use crate::schema::{Block, Kind};
use crate::texture::FloatTexture;

/// What is shown where a sample covers more than a texel.
#[derive(Clone, Copy)]
struct Filtered(bool);

choices! {
    Filtered {
        "linear" => Filtered(false),
        "trilinear" => Filtered(true),
    }
}

keys! {
    BtfKeys<'t> {
        file: At<'t, FileName> = file("file").placed().required("a BTF, as `kajo btf` makes them"),
        scale: FloatTexture = float_texture("scale", 0.0, f64::MAX).or(1.0, "a factor of all that it reflects"),
        repeat: Vec2 = pair("repeat").or([1.0, 1.0], "how often it fits into the unit square"),
        offset: Vec2 = pair("offset").or([0.0, 0.0], "by how much of itself it is moved, to the left and down"),
        filter: Filtered = choice::<Filtered>("filter")
            .or_word("linear", "what is between its texels, and whether smaller copies are shown"),
    }
}

pub const MEMBER: MaterialMember = Member {
    block: Block {
        keyword: "BTF",
        kind: Kind::Material,
        about: "cloth, leather: a texture that depends on view and light",
        groups: &[BtfKeys::FIELDS, ExtraKeys::FIELDS],
        parts: &[],
    },
    read: |compiler, item| {
        compiler.pooled_from(item, BtfKeys::read, |compiler, keys| {
            let BtfKeys { file, scale, repeat, offset, filter: Filtered(is_filtered) } = keys;
            let settings = BtfSettings { scale, repeat, offset, is_filtered };
            Some(BtfMaterial::new(compiler.btf(&file)?, settings))
        })
    },
};
