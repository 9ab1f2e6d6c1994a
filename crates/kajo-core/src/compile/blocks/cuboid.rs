//! `Box`: a box along the axes.

use kajo_math::Vec3;
use kajo_scene::Params;

use crate::compile::fields::{Keys, Sources, keys, point};
use crate::compile::member::{Member, ObjectMember};
use crate::schema::{Block, Kind};
use crate::shape::Cuboid;

keys! {
    BoxKeys {
        min: Vec3 = point("min").required("the corner with the smallest coordinates"),
        max: Vec3 = point("max").required("the corner with the largest coordinates"),
    }
}

pub const MEMBER: ObjectMember = Member {
    block: Block {
        keyword: "Box",
        kind: Kind::Shape,
        about: "a box with faces parallel to the axes",
        groups: &[BoxKeys::FIELDS],
        parts: &[],
    },
    read: |compiler, item, ctm, state| compiler.solid(item, ctm, state, read),
};

fn read(params: &mut Params<'_, '_>, sources: &mut Sources<'_>) -> Option<Cuboid> {
    let BoxKeys { min, max } = BoxKeys::read(params, sources)?;
    Some(Cuboid::new(min, max))
}
