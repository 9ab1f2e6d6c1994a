//! `Matte`: paper, plaster, chalk.

use crate::compile::extras::ExtraKeys;
use crate::compile::fields::{Keys, color_texture, keys, share};
use crate::compile::member::{MaterialMember, Member};
use crate::material::Matte;
use crate::schema::{Block, Kind};
use crate::texture::{ColorTexture, FloatTexture};

keys! {
    MatteKeys {
        color: ColorTexture = color_texture("color").or([0.8; 3], "its colour"),
        roughness: FloatTexture = share("roughness").or(0.0, "0 is as paper, 1 as plaster"),
    }
}

pub const MEMBER: MaterialMember = Member {
    block: Block {
        keyword: "Matte",
        kind: Kind::Material,
        about: "paper, plaster, chalk: light is scattered to all sides",
        groups: &[MatteKeys::FIELDS, ExtraKeys::FIELDS],
        parts: &[],
    },
    read: |compiler, item| {
        compiler.pooled(item, |params, sources| {
            let MatteKeys { color, roughness } = MatteKeys::read(params, sources)?;
            Some(Matte::new(color, roughness))
        })
    },
};
