//! `HeightField`: terrain from a picture.

use kajo_math::{Vec2, Vec3};
use kajo_scene::{Item, Params};

use crate::compile::Compiler;
use crate::compile::fields::{At, FileName, Keys, Sources, file, flag, keys, number, pair, point};
use crate::compile::height_field::HeightFieldRequest;
use crate::compile::member::{Member, ObjectMember};
use crate::compile::place::{Place, Walk};
use crate::schema::{Block, Kind};

keys! {
    HeightFieldKeys<'t> {
        file: At<'t, FileName> = file("file").placed().required("picture of heights"),
        center: Vec3 = point("center").or([0.0; 3], "middle of the rectangle, at the height 0"),
        size: Vec2 = pair("size").unit("length").or([1.0, 1.0], "of the rectangle along x and z"),
        heights: Vec2 = pair("heights").unit("length").or([0.0, 1.0], "what 0 and 1 of the picture stand for"),
        base: Option<f32> = number("base").unit("length").unlike(
            "a sheet",
            "-0.1",
            "height of the floor of a solid; what is lower is cut off",
        ),
        smooth: bool = flag("smooth").or(false, "shaded by interpolated normals"),
    }
}

pub const MEMBER: ObjectMember = Member {
    block: Block {
        keyword: "HeightField",
        kind: Kind::Shape,
        about: "terrain from a picture of heights",
        groups: &[HeightFieldKeys::FIELDS],
    },
    read: place_height_field,
};

fn place_height_field(compiler: &mut Compiler<'_>, item: Item<'_>, place: &mut Place, walk: &mut Walk) {
    let shape = compiler.read_keys(item, read).and_then(|request| compiler.height_field(item, request));
    compiler.put_shape(shape, item, place, walk);
}

fn read(params: &mut Params<'_, '_>, sources: &mut Sources<'_>) -> Option<HeightFieldRequest> {
    params.name();
    let HeightFieldKeys { file, center, size, heights, base, smooth } =
        HeightFieldKeys::read(params, sources)?;
    let place = file.item.head_span();
    Some(HeightFieldRequest { name: file.value.0, place, center, size, heights, base, smooth })
}
