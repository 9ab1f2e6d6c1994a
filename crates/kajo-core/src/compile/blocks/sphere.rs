//! `Sphere`: a ball.

use kajo_math::Vec3;
use kajo_scene::Params;

use crate::compile::fields::{Keys, Sources, keys, number, point};
use crate::compile::member::{Member, ObjectMember};
use crate::schema::{Block, Kind};
use crate::shape::Sphere;

keys! {
    SphereKeys {
        center: Vec3 = point("center").required("its middle"),
        radius: f32 = number("radius").unit("length").required("its radius"),
    }
}

pub const MEMBER: ObjectMember = Member {
    block: Block {
        keyword: "Sphere",
        kind: Kind::Shape,
        about: "a ball",
        groups: &[SphereKeys::FIELDS],
        parts: &[],
    },
    read: |compiler, item, ctm, state| compiler.solid(item, ctm, state, read),
};

fn read(params: &mut Params<'_, '_>, sources: &mut Sources<'_>) -> Option<Sphere> {
    let SphereKeys { center, radius } = SphereKeys::read(params, sources)?;
    Some(Sphere::new(center, radius))
}
