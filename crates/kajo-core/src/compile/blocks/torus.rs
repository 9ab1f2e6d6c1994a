//! `Torus`: a ring with a round tube.

use kajo_math::Vec3;
use kajo_scene::Params;

use crate::compile::fields::{Direction, Keys, Sources, direction, keys, point, positive};
use crate::compile::member::{Member, ObjectMember};
use crate::schema::{Block, Kind};
use crate::shape::Torus;

keys! {
    TorusKeys {
        center: Vec3 = point("center").or([0.0; 3], "its middle"),
        axis: Direction = direction("axis").or([0.0, 1.0, 0.0], "through its hole"),
        major_radius: f32 =
            positive("majorRadius").unit("length").required("from its middle to that of the tube"),
        minor_radius: f32 = positive("minorRadius").unit("length").required("radius of the tube"),
    }
}

pub const MEMBER: ObjectMember = Member {
    block: Block {
        keyword: "Torus",
        kind: Kind::Shape,
        about: "a ring with a round tube",
        groups: &[TorusKeys::FIELDS],
        parts: &[],
    },
    read: |compiler, item, ctm, state| compiler.solid(item, ctm, state, read),
};

fn read(params: &mut Params<'_, '_>, sources: &mut Sources<'_>) -> Option<Torus> {
    let TorusKeys { center, axis: Direction(axis), major_radius, minor_radius } =
        TorusKeys::read(params, sources)?;
    Torus::new(center, axis, major_radius, minor_radius)
}
