//! Meshes of triangles from the accessors of a glTF primitive.

use super::accessor::View;
use super::container::Buffers;
use super::json::{Document, Primitive};
use super::{Budget, ModelPart};
use crate::tri_mesh::{Corners, MeshReport, NO_INDEX, TriMesh};

/// What was found on the way and is not used.
#[derive(Default)]
pub(super) struct Skipped {
    lines_and_points: usize,
    morphs: usize,
    colored: usize,
    report: MeshReport,
}

impl Skipped {
    /// What the user should hear about.
    pub fn sentences(self) -> Vec<String> {
        let list = [
            (self.lines_and_points, "parts made of lines or points"),
            (self.morphs, "parts that change their shape, which keep the first"),
            (self.colored, "parts with colours at their vertices, which are not used"),
        ];
        let counted = list.into_iter().filter(|&(count, _)| count > 0);
        let left_out = counted.map(|(count, what)| format!("left out: {count} {what}")).collect();
        MeshReport { left_out, ..self.report }.warnings()
    }
}

/// All parts of a mesh that are made of triangles.
pub(super) fn read_mesh(
    document: &Document,
    buffers: &Buffers<'_>,
    mesh: usize,
    budget: &mut Budget,
    skipped: &mut Skipped,
) -> Result<Vec<ModelPart>, String> {
    let mut parts = Vec::new();
    for (i, primitive) in document.meshes[mesh].primitives.iter().enumerate() {
        let named = |said: String| format!("primitives[{i}]: {said}");
        let Some(shape) = Shape::of(primitive.mode) else {
            skipped.lines_and_points += 1;
            continue;
        };
        let Some(&position) = primitive.attributes.get("POSITION") else { continue };
        let reader = Reader { document, buffers, primitive };
        let mesh = reader.read(shape, position, budget, skipped).map_err(named)?;
        if let Some(material) = primitive.material.filter(|&m| m >= document.materials.len()) {
            return Err(named(format!("there is no materials[{material}]")));
        }
        skipped.morphs += usize::from(!primitive.targets.is_empty());
        skipped.colored += usize::from(primitive.attributes.contains_key("COLOR_0"));
        parts.push(ModelPart { mesh, material: primitive.material });
    }
    Ok(parts)
}

/// How indices make triangles.
#[derive(Clone, Copy)]
enum Shape {
    Triangles,
    Strip,
    Fan,
}

impl Shape {
    fn of(mode: u32) -> Option<Shape> {
        Some(match mode {
            4 => Shape::Triangles,
            5 => Shape::Strip,
            6 => Shape::Fan,
            _ => return None,
        })
    }

    fn triangles(self, indices: &[u32]) -> Vec<[u32; 3]> {
        match self {
            Shape::Triangles => indices.as_chunks().0.to_vec(),
            Shape::Strip => {
                let turned = |(i, w): (usize, &[u32])| {
                    if i % 2 == 0 { [w[0], w[1], w[2]] } else { [w[1], w[0], w[2]] }
                };
                indices.windows(3).enumerate().map(turned).collect()
            }
            Shape::Fan => {
                let Some((&center, rim)) = indices.split_first() else { return Vec::new() };
                rim.windows(2).map(|w| [center, w[0], w[1]]).collect()
            }
        }
    }
}

struct Reader<'d, 'b> {
    document: &'d Document,
    buffers: &'d Buffers<'b>,
    primitive: &'d Primitive,
}

impl Reader<'_, '_> {
    fn read(
        &self,
        shape: Shape,
        position: usize,
        budget: &mut Budget,
        skipped: &mut Skipped,
    ) -> Result<TriMesh, String> {
        let positions = View::<3>::new(self.document, self.buffers, position)?;
        let normals = self.attribute::<3>("NORMAL", positions.count)?;
        let uvs = self.attribute::<2>("TEXCOORD_0", positions.count)?;
        let mut indices = self.indices(&positions, budget)?;
        let used = used_vertices(&mut indices, positions.count);
        let n = used.len();
        budget.take::<[f32; 8]>(n)?;
        budget.take::<[u32; 3]>(indices.len())?;
        let mut mesh = TriMesh {
            positions: used.iter().map(|v| positions.floats(v)).collect(),
            faces: shape.triangles(&indices),
            ..TriMesh::default()
        };
        if let Some(normals) = normals {
            mesh.normals = used.iter().map(|v| skipped.report.finite_or_zero(normals.floats(v))).collect();
            mesh.face_normals = Corners::Vertices;
        }
        if let Some(uvs) = uvs {
            let upright = |[u, v]: [f32; 2]| [u, 1.0 - v];
            mesh.uvs = used.iter().map(|v| skipped.report.finite_or_zero(upright(uvs.floats(v)))).collect();
            mesh.face_uvs = Corners::Vertices;
        }
        skipped.report.dropped += mesh.drop_not_finite();
        Ok(mesh)
    }

    fn attribute<const N: usize>(&self, name: &str, count: usize) -> Result<Option<View<'_, N>>, String> {
        let Some(&number) = self.primitive.attributes.get(name) else { return Ok(None) };
        let view = View::new(self.document, self.buffers, number)?;
        if view.count != count {
            return Err(format!("there are {count} vertices, but {} of `{name}`", view.count));
        }
        Ok(Some(view))
    }

    /// The vertices of the corners, all of which exist.
    fn indices(&self, positions: &View<'_, 3>, budget: &mut Budget) -> Result<Vec<u32>, String> {
        let count = positions.count;
        let Some(number) = self.primitive.indices else {
            if !positions.is_backed() {
                return Err("its vertices have no data".to_owned());
            }
            budget.take::<u32>(count)?;
            return match u32::try_from(count) {
                Ok(count) if count < NO_INDEX => Ok((0..count).collect()),
                _ => Err(format!("{count} vertices are too many")),
            };
        };
        let view = View::<1>::new(self.document, self.buffers, number)?;
        if !view.is_backed() {
            return Err("its indices have no data".to_owned());
        }
        budget.take::<u32>(view.count)?;
        let mut indices = Vec::with_capacity(view.count);
        for i in 0..view.count {
            let [index] = view.get(i);
            if index >= count as f64 || index >= f64::from(NO_INDEX) || index < 0.0 || index.fract() != 0.0 {
                return Err(format!("corner {i} names vertex {index}, but there are {count}"));
            }
            indices.push(index as u32);
        }
        Ok(indices)
    }
}

/// The vertices to be kept, as numbers of the file.
enum Used {
    All(usize),
    Some(Vec<u32>),
}

impl Used {
    fn len(&self) -> usize {
        match self {
            Used::All(n) => *n,
            Used::Some(list) => list.len(),
        }
    }

    fn iter(&self) -> impl Iterator<Item = usize> {
        let at = |i: usize| match self {
            Used::All(_) => i,
            Used::Some(list) => list[i] as usize,
        };
        (0..self.len()).map(at)
    }
}

/// Keeps all vertices where most are used; else those only, which `indices` then count. Parts of a model
/// often share one long list of vertices.
fn used_vertices(indices: &mut [u32], count: usize) -> Used {
    if count <= indices.len() {
        return Used::All(count);
    }
    let mut list = indices.to_vec();
    list.sort_unstable();
    list.dedup();
    for index in indices {
        *index = list.partition_point(|v| v < index) as u32;
    }
    Used::Some(list)
}
