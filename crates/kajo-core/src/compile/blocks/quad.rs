//! `Quad`: a parallelogram.

use kajo_math::Vec3;
use kajo_scene::Params;

use crate::compile::fields::{At, Keys, Sources, keys, point, vector};
use crate::compile::member::{Member, ObjectMember, reported};
use crate::schema::{Block, Kind};
use crate::shape::Quad;

keys! {
    QuadKeys<'t> {
        corner: Vec3 = point("corner").required("one corner"),
        edge1: Vec3 = vector("edge1").required("from there to the next corner"),
        edge2: At<'t, Vec3> = vector("edge2").placed().required("from there to the last corner"),
    }
}

pub const MEMBER: ObjectMember = Member {
    block: Block {
        keyword: "Quad",
        kind: Kind::Shape,
        about: "a parallelogram",
        groups: &[QuadKeys::FIELDS],
        parts: &[],
    },
    read: |compiler, item, ctm, state| compiler.solid(item, ctm, state, read),
};

fn read(params: &mut Params<'_, '_>, sources: &mut Sources<'_>) -> Option<Quad> {
    let QuadKeys { corner, edge1, edge2 } = QuadKeys::read(params, sources)?;
    let quad = Quad::new(corner, edge1, edge2.value);
    reported(params, quad, edge2.item, "`edge1` and `edge2` must not be parallel or zero")
}
