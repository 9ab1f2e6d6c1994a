//! `Disk`: a flat disk or ring.

use kajo_math::Vec3;
use kajo_scene::Params;

use crate::compile::fields::{At, Keys, Sources, keys, number, point, vector};
use crate::compile::member::{Member, ObjectMember, reported};
use crate::schema::{Block, Kind};
use crate::shape::Disk;

keys! {
    DiskKeys<'t> {
        center: Vec3 = point("center").required("its middle"),
        normal: At<'t, Vec3> = vector("normal").placed().required("at right angles to it"),
        radius: f32 = number("radius").unit("length").required("its radius"),
        inner_radius: f32 = number("innerRadius").unit("length").or(0.0, "radius of the hole"),
    }
}

pub const MEMBER: ObjectMember = Member {
    block: Block {
        keyword: "Disk",
        kind: Kind::Shape,
        about: "a flat disk or ring",
        groups: &[DiskKeys::FIELDS],
        parts: &[],
    },
    read: |compiler, item, ctm, state| compiler.solid(item, ctm, state, read),
};

fn read(params: &mut Params<'_, '_>, sources: &mut Sources<'_>) -> Option<Disk> {
    let DiskKeys { center, normal, radius, inner_radius } = DiskKeys::read(params, sources)?;
    let disk = Disk::new(center, normal.value, radius, inner_radius);
    reported(params, disk, normal.item, "`normal` must not be zero")
}
