//! `TriangleMesh`: triangles of an OBJ, PLY or STL file.

use std::sync::Arc;

use kajo_math::tape::Tape;
use kajo_scene::{Item, Params};

use crate::compile::Compiler;
use crate::compile::fields::{
    At, FileName, Keys, Sources, file, flag, float_texture, function, keys, report_beside,
};
use crate::compile::graphics_state::{CurrentTransform, GraphicsState};
use crate::compile::member::{Member, ObjectMember};
use crate::compile::mesh::MeshRequest;
use crate::compile::mesh_store::Shading;
use crate::compile::subdivision::{Displacement, Subdivision, SubdivisionKeys};
use crate::schema::{Around, Block, FieldValue, Kind};
use crate::texture::FloatTexture;

keys! {
    MeshKeys<'t> {
        file: Option<At<'t, FileName>> = file("file").placed().option("OBJ, PLY or STL"),
        obj_file: Option<At<'t, FileName>> =
            file("obj_file").spelling_of("file").placed().option("OBJ, PLY or STL"),
        smooth: Option<bool> =
            flag("smooth").ruled(smooth, "by neighbouring faces", "shaded by interpolated normals"),
        materials: bool = flag("materials").or(false, "in the materials of its own file"),
        colors: bool = flag("colors").or(false, "tinted by the colours of its vertices"),
        displacement: Option<FloatTexture> = float_texture("displacement", f64::MIN, f64::MAX)
            .unit("length")
            .only_beside("subdivide")
            .option("how far the subdivided surface is moved outwards"),
        displacement_function: Option<Arc<Tape>> = function("displacementFunction")
            .only_beside("subdivide")
            .not_beside(&["displacement"])
            .option("the same as a function of the place"),
    }
}

pub const MEMBER: ObjectMember = Member {
    block: Block {
        keyword: "TriangleMesh",
        kind: Kind::Shape,
        about: "the triangles of an OBJ, PLY or STL file",
        groups: &[MeshKeys::FIELDS, SubdivisionKeys::FIELDS],
        parts: &[],
    },
    read: place_mesh,
};

fn smooth(around: &Around<'_>) -> Option<FieldValue> {
    (!around.rules().smooth_meshes).then(|| FieldValue::flag(false))
}

fn place_mesh(
    compiler: &mut Compiler<'_>,
    item: Item<'_>,
    ctm: &mut CurrentTransform,
    state: &mut GraphicsState,
) {
    let shape = compiler.read_keys(item, read).and_then(|request| compiler.mesh(item, request));
    compiler.put_shape(shape, item, ctm, state);
}

fn read(params: &mut Params<'_, '_>, sources: &mut Sources<'_>) -> Option<MeshRequest> {
    params.name();
    let unasked = if sources.rules.smooth_meshes { Shading::Averaged } else { Shading::Flat };
    params.either(&["file", "obj_file"], "a mesh");
    let subdivision = Subdivision::read(params, sources, MeshKeys::FIELDS);
    let MeshKeys { file, obj_file, smooth, materials, colors, displacement, displacement_function } =
        MeshKeys::read(params, sources)?;
    let Some(file) = file.or(obj_file) else {
        if !params.contains("obj_file") {
            params.report_missing("file");
        }
        return None;
    };
    let subdivision = subdivision?;
    let unasked = if subdivision.is_some() { Shading::Smooth } else { unasked };
    let shading = smooth.map_or(unasked, |on| if on { Shading::Smooth } else { Shading::Flat });
    let (name, span) = (file.value.0, file.item.head_span());
    if params.contains("displacement") {
        report_beside(params, MeshKeys::FIELDS, "displacement");
    }
    let function = displacement_function.map(Displacement::Function);
    let displacement = displacement.map(Displacement::Texture).or(function);
    let displacement = displacement.filter(|_| subdivision.is_some());
    Some(MeshRequest { name, span, shading, own_materials: materials, colors, subdivision, displacement })
}
