//! `TextureMedium`: smoke or a cloud whose density is a texture.

use kajo_math::{Aabb, Vec3};
use kajo_scene::{Diagnostic, Params};

use super::medium::{CoefficientKeys, coefficients};
use super::phase::PhaseKeys;
use crate::compile::fields::{Keys, Sources, keys, point};
use crate::compile::member::{MediumMember, Member};
use crate::compile::operands::OPERAND;
use crate::medium::TextureMedium;
use crate::schema::{Block, Kind};

keys! {
    BoxKeys {
        min: Vec3 = point("min").or([-1.0; 3], "the corner of its box with the smallest coordinates"),
        max: Vec3 = point("max").or([1.0; 3], "the corner of its box with the largest coordinates"),
    }
}

pub const MEMBER: MediumMember = Member {
    block: Block {
        keyword: "TextureMedium",
        kind: Kind::Medium,
        about: "smoke or a cloud by a texture",
        groups: &[&[OPERAND], BoxKeys::FIELDS, CoefficientKeys::FIELDS, PhaseKeys::FIELDS],
        parts: &[],
    },
    read: |compiler, item| compiler.medium(item, read),
};

fn read(params: &mut Params<'_, '_>, sources: &mut Sources<'_>) -> Option<TextureMedium> {
    let texture = sources.operands(params, [1, 1]);
    let keys = BoxKeys::read(params, sources);
    let coefficients = coefficients(params, sources);
    let (mut texture, BoxKeys { min, max }, coefficients) = (texture?, keys?, coefficients?);
    let texture = texture.pop()?.number(sources.textures.nodes)?;
    let made = TextureMedium::new(coefficients, texture, Aabb { min, max });
    if made.is_none() {
        let error = Diagnostic::error("every coordinate of `min` must be less than that of `max`");
        params.report(error, "no such medium");
    }
    made
}
