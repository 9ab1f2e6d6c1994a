//! `Cylinder`: a cone that does not taper.

use kajo_math::Vec3;
use kajo_scene::Params;

use super::cone::{CAPPED, along_axis, base, top};
use crate::compile::fields::{At, Keys, Sources, keys, number};
use crate::compile::member::{Member, ObjectMember};
use crate::schema::{Block, Kind};
use crate::shape::Cone;

keys! {
    CylinderKeys<'t> {
        base: Vec3 = base("middle of one end"),
        top: At<'t, Vec3> = top("middle of the other end"),
        radius: f32 = number("radius").unit("length").required("its radius"),
        capped: bool = CAPPED,
    }
}

pub const MEMBER: ObjectMember = Member {
    block: Block {
        keyword: "Cylinder",
        kind: Kind::Shape,
        about: "a cylinder, with or without caps",
        groups: &[CylinderKeys::FIELDS],
        parts: &[],
    },
    read: |compiler, item, ctm, state| compiler.solid(item, ctm, state, read),
};

fn read(params: &mut Params<'_, '_>, sources: &mut Sources<'_>) -> Option<Cone> {
    let CylinderKeys { base, top, radius, capped } = CylinderKeys::read(params, sources)?;
    along_axis(params, base, top, [radius; 2], capped)
}
