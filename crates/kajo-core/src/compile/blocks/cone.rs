//! `Cone`: pointed or cut off, with or without caps.

use kajo_math::Vec3;
use kajo_scene::Params;

use crate::compile::fields::{At, Defaulted, Keys, Required, Sources, flag, keys, number, point};
use crate::compile::member::{Member, ObjectMember, reported};
use crate::schema::{Block, Kind};
use crate::shape::Cone;

/// Whether a shape that is drawn out along an axis has ends.
pub const CAPPED: Defaulted<bool> = flag("capped").or(true, "closed by disks at its ends");

/// The start of an axis.
pub const fn base(about: &'static str) -> Required<Vec3> {
    point("base").required(about)
}

/// The end of an axis.
pub const fn top<'t>(about: &'static str) -> Required<At<'t, Vec3>> {
    point("top").placed().required(about)
}

keys! {
    ConeKeys<'t> {
        base: Vec3 = base("middle of the base"),
        top: At<'t, Vec3> = top("the tip, or the middle of the other end"),
        radius: f32 = number("radius").unit("length").required("radius of the base"),
        top_radius: f32 = number("topRadius").unit("length").or(0.0, "radius at the top"),
        capped: bool = CAPPED,
    }
}

pub const MEMBER: ObjectMember = Member {
    block: Block {
        keyword: "Cone",
        kind: Kind::Shape,
        about: "a cone, pointed or cut off, with or without caps",
        groups: &[ConeKeys::FIELDS],
        parts: &[],
    },
    read: |compiler, item, ctm, state| compiler.solid(item, ctm, state, read),
};

fn read(params: &mut Params<'_, '_>, sources: &mut Sources<'_>) -> Option<Cone> {
    let ConeKeys { base, top, radius, top_radius, capped } = ConeKeys::read(params, sources)?;
    along_axis(params, base, top, [radius, top_radius], capped)
}

/// A cone, or a cylinder where the radii are the same.
pub fn along_axis(
    params: &mut Params<'_, '_>,
    base: Vec3,
    top: At<'_, Vec3>,
    [radius, top_radius]: [f32; 2],
    capped: bool,
) -> Option<Cone> {
    let cone = Cone::new(base, top.value, radius, top_radius, capped);
    reported(params, cone, top.item, "`base` and `top` are the same point")
}
