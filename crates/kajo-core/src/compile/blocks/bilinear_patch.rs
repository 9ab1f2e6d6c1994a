//! `BilinearPatch`: the straight lines between four corners.

use kajo_math::Vec3;
use kajo_scene::Params;

use crate::compile::fields::{At, Keys, Sources, keys, point};
use crate::compile::member::{Member, ObjectMember, reported};
use crate::schema::{Block, Kind};
use crate::shape::BilinearPatch;

keys! {
    BilinearPatchKeys<'t> {
        vertex0: Vec3 = point("vertex0").required("first corner, (u, v) = (0, 0)"),
        vertex1: Vec3 = point("vertex1").required("next corner around it, (1, 0)"),
        vertex2: Vec3 = point("vertex2").required("the one opposite the first, (1, 1)"),
        vertex3: At<'t, Vec3> = point("vertex3").placed().required("last corner, (0, 1)"),
    }
}

pub const MEMBER: ObjectMember = Member {
    block: Block {
        keyword: "BilinearPatch",
        kind: Kind::Shape,
        about: "the surface of straight lines between four corners",
        groups: &[BilinearPatchKeys::FIELDS],
        parts: &[],
    },
    read: |compiler, item, ctm, state| compiler.solid(item, ctm, state, read),
};

fn read(params: &mut Params<'_, '_>, sources: &mut Sources<'_>) -> Option<BilinearPatch> {
    let BilinearPatchKeys { vertex0, vertex1, vertex2, vertex3 } = BilinearPatchKeys::read(params, sources)?;
    let patch = BilinearPatch::new([vertex0, vertex1, vertex2, vertex3.value]);
    reported(params, patch, vertex3.item, "the corners of a patch must not all be on one line")
}
