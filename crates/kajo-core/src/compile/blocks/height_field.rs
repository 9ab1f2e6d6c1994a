//! `HeightField`: terrain from a picture or a function.

use std::sync::Arc;

use kajo_math::tape::Tape;
use kajo_math::{Vec2, Vec3};
use kajo_scene::{Item, Params};

use crate::compile::Compiler;
use crate::compile::fields::{
    At, FileName, Keys, Sources, count, file, flag, function, keys, number, pair, point, report_beside,
    report_without,
};
use crate::compile::graphics_state::{CurrentTransform, GraphicsState};
use crate::compile::height_field::{HeightFieldRequest, HeightSource};
use crate::compile::member::{Member, ObjectMember};
use crate::schema::{Block, Kind};

keys! {
    HeightFieldKeys<'t> {
        file: Option<At<'t, FileName>> =
            file("file").not_beside(&["function", "resolution"]).placed().option("picture of heights"),
        function: Option<Arc<Tape>> = function("function")
            .not_beside(&["file"])
            .option("height by x and z, counted from `center`, in place of a picture"),
        resolution: u32 = count("resolution", 2, 32_768)
            .only_beside("function")
            .or(512, "points along the longer side at which `function` is asked for"),
        center: Vec3 = point("center").or([0.0; 3], "middle of the rectangle, at the height 0"),
        size: Vec2 = pair("size").unit("length").or([1.0, 1.0], "of the rectangle along x and z"),
        heights: Vec2 = pair("heights").unit("length").or([0.0, 1.0], "what 0 and 1 of the picture or function stand for"),
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
        about: "terrain from a picture of heights, or a function",
        groups: &[HeightFieldKeys::FIELDS],
        parts: &[],
    },
    read: place_height_field,
};

fn place_height_field(
    compiler: &mut Compiler<'_>,
    item: Item<'_>,
    ctm: &mut CurrentTransform,
    state: &mut GraphicsState,
) {
    let shape = compiler.read_keys(item, read).and_then(|request| compiler.height_field(item, request));
    compiler.put_shape(shape, item, ctm, state);
}

fn read(params: &mut Params<'_, '_>, sources: &mut Sources<'_>) -> Option<HeightFieldRequest> {
    params.name();
    if params.contains("file") {
        report_beside(params, HeightFieldKeys::FIELDS, "file");
    }
    if !params.contains("function") {
        report_without(params, HeightFieldKeys::FIELDS, "function");
    }
    let HeightFieldKeys { file, function, resolution, center, size, heights, base, smooth } =
        HeightFieldKeys::read(params, sources)?;
    let source = match (file, function) {
        (Some(file), _) => HeightSource::Picture { span: file.item.head_span(), name: file.value.0 },
        (None, Some(function)) => HeightSource::Function { function, resolution },
        (None, None) => {
            params.report_missing("file");
            return None;
        }
    };
    Some(HeightFieldRequest { source, center, size, heights, base, smooth })
}
