//! `Triangle`: one triangle.

use kajo_math::{Vec2, Vec3};
use kajo_scene::{Item, Params};

use crate::compile::Compiler;
use crate::compile::fields::{Keys, Sources, keys, pair, point};
use crate::compile::graphics_state::{CurrentTransform, GraphicsState};
use crate::compile::member::{Member, ObjectMember};
use crate::schema::{Block, Kind};
use crate::shape::{ShapeId, Triangle};

keys! {
    TriangleKeys {
        vertex0: Vec3 = point("vertex0").required("first corner"),
        vertex1: Vec3 = point("vertex1").required("second corner"),
        vertex2: Vec3 = point("vertex2").required("third corner"),
        uv0: Vec2 = pair("textCoord0").or([0.0, 0.0], "texture coordinates of the first corner"),
        uv1: Vec2 = pair("textCoord1").or([1.0, 0.0], "texture coordinates of the second corner"),
        uv2: Vec2 = pair("textCoord2").or([0.0, 1.0], "texture coordinates of the third corner"),
    }
}

pub const MEMBER: ObjectMember = Member {
    block: Block {
        keyword: "Triangle",
        kind: Kind::Shape,
        about: "one triangle",
        groups: &[TriangleKeys::FIELDS],
        parts: &[],
    },
    read: place_triangle,
};

fn place_triangle(
    compiler: &mut Compiler<'_>,
    item: Item<'_>,
    ctm: &mut CurrentTransform,
    state: &mut GraphicsState,
) {
    let shape = compiler.triangle(item, ctm);
    match ctm.world.constant() {
        Some(_) => compiler.put_shape(shape, item, &mut ctm.baked(), state),
        None => compiler.put_shape(shape, item, ctm, state),
    }
}

impl Compiler<'_> {
    /// A single triangle, taken to its place at once unless it moves: no ray is ever transformed for it.
    fn triangle(&mut self, item: Item<'_>, ctm: &CurrentTransform) -> Option<ShapeId> {
        let mut triangle = self.read_keys(item, read)?;
        if triangle.is_degenerate() {
            let (count, _) = self.flat_triangles.get_or_insert((0, item.keyword_span()));
            *count += 1;
            return None;
        }
        if let Some(transform) = ctm.fixed().filter(|transform| !transform.is_identity()) {
            triangle.vertices = triangle.vertices.map(|v| transform.point(v));
            if transform.mirrors() {
                // The normal keeps its side of the surface: the order of the corners turns round.
                triangle.vertices.swap(1, 2);
                triangle.uvs.swap(1, 2);
            }
        }
        self.shape(item, triangle)
    }
}

fn read(params: &mut Params<'_, '_>, sources: &mut Sources<'_>) -> Option<Triangle> {
    params.name();
    let keys = TriangleKeys::read(params, sources)?;
    let vertices = [keys.vertex0, keys.vertex1, keys.vertex2];
    Some(Triangle { vertices, uvs: [keys.uv0, keys.uv1, keys.uv2] })
}
