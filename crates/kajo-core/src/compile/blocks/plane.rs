//! `Plane`: a plane without bounds.

use kajo_math::Vec3;
use kajo_scene::Params;

use crate::compile::fields::{Keys, Sources, keys, number, vector};
use crate::compile::member::{Member, ObjectMember};
use crate::schema::{Block, Kind};
use crate::shape::Plane;

keys! {
    PlaneKeys {
        normal: Vec3 = vector("normal").required("at right angles to it"),
        offset: f32 = number("offset")
            .unit("length")
            .required("distance from the origin along the normal"),
    }
}

pub const MEMBER: ObjectMember = Member {
    block: Block {
        keyword: "Plane",
        kind: Kind::Shape,
        about: "a plane without bounds",
        groups: &[PlaneKeys::FIELDS],
        parts: &[],
    },
    read: |compiler, item, ctm, state| compiler.solid(item, ctm, state, read),
};

fn read(params: &mut Params<'_, '_>, sources: &mut Sources<'_>) -> Option<Plane> {
    let PlaneKeys { normal, offset } = PlaneKeys::read(params, sources)?;
    Some(Plane::new(normal.as_dvec3(), offset.into()))
}
