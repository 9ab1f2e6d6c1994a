//! `Measured`: a BRDF by tables, of the data bases of MERL and RGL.

use crate::compile::extras::ExtraKeys;
use crate::compile::fields::{At, FileName, Keys, file, float_texture, keys};
use crate::compile::member::{MaterialMember, Member};
use crate::material::MeasuredMaterial;
use crate::schema::{Block, Kind};
use crate::texture::FloatTexture;

use super::metal::ROTATION;

keys! {
    MeasuredKeys<'t> {
        file: At<'t, FileName> = file("file").placed().required("a table of MERL (.binary) or of RGL (.bsdf)"),
        scale: FloatTexture = float_texture("scale", 0.0, f64::MAX).or(1.0, "a factor of all that it reflects"),
        rotation: FloatTexture = ROTATION,
    }
}

pub const MEMBER: MaterialMember = Member {
    block: Block {
        keyword: "Measured",
        kind: Kind::Material,
        about: "a material whose reflection was measured in a laboratory",
        groups: &[MeasuredKeys::FIELDS, ExtraKeys::FIELDS],
        parts: &[],
    },
    read: |compiler, item| {
        compiler.pooled_from(item, MeasuredKeys::read, |compiler, keys| {
            let MeasuredKeys { file, scale, rotation } = keys;
            Some(MeasuredMaterial::new(compiler.measured_brdf(&file)?, scale, rotation))
        })
    },
};
