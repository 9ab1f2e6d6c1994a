//! `Model`: a whole glTF model with its materials and lights.

use kajo_scene::{Args, Diagnostic, Item, Params};

use crate::compile::Compiler;
use crate::compile::fields;
use crate::compile::fields::{At, FileName, Keys, Plain, Sources, Typed, at_least, file, flag, keys, number};
use crate::compile::graphics_state::{CurrentTransform, GraphicsState};
use crate::compile::member::{Member, ObjectMember};
use crate::compile::model::ModelRequest;
use crate::compile::model_beads::BeadRadii;
use crate::compile::subdivision::{Subdivision, SubdivisionKeys};
use crate::ids::LightGroup;
use crate::schema::{Block, FieldKind, FieldSpec, Kind};

keys! {
    ModelKeys<'t> {
        file: At<'t, FileName> = file("file").placed().required("glTF"),
        smooth: bool = flag("smooth").or(true, "shaded by interpolated normals"),
        materials: bool = flag("materials").or(true, "in the materials of its own file"),
        lights: bool = flag("lights").or(true, "with the lights of its file"),
        light_scale: f32 = at_least("lightScale", 0.0).or(1.0, "factor of these lights"),
        group: Option<LightGroup> = fields::GROUP,
        points: Option<f32> =
            at_least("points", 0.0).unit("length").option("radius of spheres in place of points"),
        animation: Option<AnimationName> =
            Typed::<AnimationName>::new("animation", FieldKind::Text).unlike("the first", "", "name of its animation, or its number from 0"),
        animation_time: Option<f32> = number("animationTime").unit("s").unlike("that of the frame", "0", "moment of the animation"),
        animation_repeat: bool = flag("animationRepeat").or(true, "it begins again when it is over"),
        lines: Option<f32> = at_least("lines", 0.0).unit("length").option("radius of tubes in place of lines"),
    }
}

/// The name of an animation, or its number.
struct AnimationName(String);

impl Plain<'_> for AnimationName {
    fn parse(_: &FieldSpec, args: &mut Args<'_>, _: &mut Sources<'_>) -> Result<AnimationName, Diagnostic> {
        if args.is_word() {
            return args.text().map(|name| AnimationName(name.into_owned()));
        }
        args.int_in(0..=i64::from(u32::MAX)).map(|number| AnimationName(number.to_string()))
    }
}

pub const MEMBER: ObjectMember = Member {
    block: Block {
        keyword: "Model",
        kind: Kind::Shape,
        about: "a whole glTF model with its materials and lights",
        groups: &[ModelKeys::FIELDS, SubdivisionKeys::FIELDS],
        parts: &[],
    },
    read: place_model,
};

fn place_model(
    compiler: &mut Compiler<'_>,
    item: Item<'_>,
    ctm: &mut CurrentTransform,
    state: &mut GraphicsState,
) {
    if let Some(request) = compiler.read_keys(item, read) {
        compiler.model(item, request, ctm, state);
    }
}

fn read(params: &mut Params<'_, '_>, sources: &mut Sources<'_>) -> Option<ModelRequest> {
    params.name();
    let subdivision = Subdivision::read(params, sources, &[]);
    let keys = ModelKeys::read(params, sources)?;
    Some(ModelRequest {
        name: keys.file.value.0,
        at: keys.file.item.head_span(),
        smooth: keys.smooth,
        own_materials: keys.materials,
        radii: BeadRadii { points: keys.points, lines: keys.lines },
        lights: keys.lights,
        light_scale: keys.light_scale,
        group: keys.group.unwrap_or_default(),
        subdivision: subdivision?,
        animation: keys.animation.map(|name| name.0),
        animation_time: keys.animation_time,
        animation_repeat: keys.animation_repeat,
    })
}
