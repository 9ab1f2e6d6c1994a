//! `Superellipsoid`: between a box, a ball and an octahedron.

use kajo_math::Vec3;
use kajo_scene::Params;

use crate::compile::fields::{Keys, Sources, between, keys, point, positive};
use crate::compile::member::{Member, ObjectMember};
use crate::schema::{Block, Kind};
use crate::shape::Superellipsoid;

keys! {
    SuperellipsoidKeys {
        center: Vec3 = point("center").or([0.0; 3], "its middle"),
        radius: f32 = positive("radius").unit("length").required("from the middle to each face of the box around it"),
        east: f32 = between("east", Superellipsoid::LEAST_EXPONENT, Superellipsoid::LARGEST_EXPONENT)
            .or(1.0, "exponent around the y axis: square near 0, round at 1, a diamond at 2"),
        north: f32 = between("north", Superellipsoid::LEAST_EXPONENT, Superellipsoid::LARGEST_EXPONENT)
            .or(1.0, "exponent from pole to pole, likewise"),
    }
}

pub const MEMBER: ObjectMember = Member {
    block: Block {
        keyword: "Superellipsoid",
        kind: Kind::Shape,
        about: "between a box, a ball and an octahedron",
        groups: &[SuperellipsoidKeys::FIELDS],
        parts: &[],
    },
    read: |compiler, item, ctm, state| compiler.solid(item, ctm, state, read),
};

fn read(params: &mut Params<'_, '_>, sources: &mut Sources<'_>) -> Option<Superellipsoid> {
    let SuperellipsoidKeys { center, radius, east, north } = SuperellipsoidKeys::read(params, sources)?;
    Superellipsoid::new(center, radius, east, north)
}
