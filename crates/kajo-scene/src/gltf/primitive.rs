//! Meshes of triangles, lines and points from the accessors of a glTF primitive.

use super::accessor::AccessorView;
use super::container::Buffers;
use super::json::{Document, Primitive};
use super::material::Sets;
use super::skin::{Pose, blended, turned};
use super::{Budget, ModelPart};
use crate::tri_mesh::{Corners, MeshReport, NO_INDEX, TriMesh};
use kajo_math::{DAffine3, DVec3};

/// What was found on the way and is not used.
#[derive(Default)]
pub(super) struct Skipped {
    /// Primitives of a kind that there is not.
    unknown: usize,
    report: MeshReport,
}

impl Skipped {
    /// What the user should hear about.
    pub fn sentences(self) -> Vec<String> {
        let unknown =
            (self.unknown > 0).then(|| format!("left out: {} parts of an unknown kind", self.unknown));
        MeshReport { left_out: unknown.into_iter().collect(), ..self.report }.warnings()
    }
}

/// All parts of a mesh.
pub(super) fn read_mesh(
    document: &Document,
    buffers: &Buffers<'_>,
    mesh: usize,
    pose: &Pose<'_>,
    budget: &mut Budget,
    skipped: &mut Skipped,
) -> Result<Vec<ModelPart>, String> {
    let mut parts = Vec::new();
    for (i, primitive) in document.meshes[mesh].primitives.iter().enumerate() {
        let named = |said: String| format!("primitives[{i}]: {said}");
        let Some(kind) = Kind::of(primitive.mode) else {
            skipped.unknown += 1;
            continue;
        };
        let Some(&position) = primitive.attributes.get("POSITION") else { continue };
        if let Some(material) = primitive.material.filter(|&m| m >= document.materials.len()) {
            return Err(named(format!("there is no materials[{material}]")));
        }
        let material = primitive.material.map(|number| &document.materials[number]);
        let reader = Reader {
            document,
            buffers,
            primitive,
            sets: material.map_or(Sets { first: 0, second: None }, |material| material.sets()),
            needs_tangents: material.is_some_and(|material| material.needs_tangents()),
        };
        let part = reader.read(kind, position, pose, budget, skipped).map_err(named)?;
        parts.push(part);
    }
    Ok(parts)
}

/// What indices are made into.
#[derive(Clone, Copy)]
enum Kind {
    Points,
    Lines,
    LineLoop,
    LineStrip,
    Triangles,
    Strip,
    Fan,
}

impl Kind {
    fn of(mode: u32) -> Option<Kind> {
        Some(match mode {
            0 => Kind::Points,
            1 => Kind::Lines,
            2 => Kind::LineLoop,
            3 => Kind::LineStrip,
            4 => Kind::Triangles,
            5 => Kind::Strip,
            6 => Kind::Fan,
            _ => return None,
        })
    }

    fn triangles(self, indices: &[u32]) -> Vec<[u32; 3]> {
        match self {
            Kind::Triangles => indices.as_chunks().0.to_vec(),
            Kind::Strip => {
                let turned = |(i, w): (usize, &[u32])| {
                    if i % 2 == 0 { [w[0], w[1], w[2]] } else { [w[1], w[0], w[2]] }
                };
                indices.windows(3).enumerate().map(turned).collect()
            }
            Kind::Fan => {
                let Some((&center, rim)) = indices.split_first() else { return Vec::new() };
                rim.windows(2).map(|w| [center, w[0], w[1]]).collect()
            }
            Kind::Points | Kind::Lines | Kind::LineLoop | Kind::LineStrip => Vec::new(),
        }
    }

    fn lines(self, indices: &[u32]) -> Vec<[u32; 2]> {
        let strip = || indices.windows(2).map(|w| [w[0], w[1]]);
        match (self, indices) {
            (Kind::Lines, _) => indices.as_chunks().0.to_vec(),
            (Kind::LineStrip, _) => strip().collect(),
            (Kind::LineLoop, [first, _, .., last]) => strip().chain([[*last, *first]]).collect(),
            _ => Vec::new(),
        }
    }
}

/// Texture coordinates that count upwards.
fn upright([u, v]: [f32; 2]) -> [f32; 2] {
    [u, 1.0 - v]
}

struct Reader<'d, 'b> {
    document: &'d Document,
    buffers: &'d Buffers<'b>,
    primitive: &'d Primitive,
    sets: Sets,
    needs_tangents: bool,
}

impl Reader<'_, '_> {
    fn read(
        &self,
        kind: Kind,
        position: usize,
        pose: &Pose<'_>,
        budget: &mut Budget,
        skipped: &mut Skipped,
    ) -> Result<ModelPart, String> {
        let positions = AccessorView::<3>::new(self.document, self.buffers, position)?;
        let count = positions.count;
        let mut indices = self.indices(&positions, budget)?;
        let used = used_vertices(&mut indices, count);
        budget.take::<[f32; 8]>(used.len())?;
        budget.take::<[u32; 3]>(indices.len())?;
        let normals = self.attribute::<3>("NORMAL", count)?;
        let uvs = self.attribute::<2>(&format!("TEXCOORD_{}", self.sets.first), count)?;
        let mut part = ModelPart {
            mesh: TriMesh { faces: kind.triangles(&indices), ..TriMesh::default() },
            material: self.primitive.material,
            segments: kind.lines(&indices),
            points: if matches!(kind, Kind::Points) { indices } else { Vec::new() },
            ..ModelPart::default()
        };
        let mesh = &mut part.mesh;
        mesh.positions = used.iter().map(|v| positions.floats(v)).collect();
        self.morph("POSITION", &mut mesh.positions, &used, pose, budget)?;
        if let Some(normals) = normals {
            mesh.normals = used.iter().map(|v| skipped.report.finite_or_zero(normals.floats(v))).collect();
            mesh.face_normals = Corners::Vertices;
            self.morph("NORMAL", &mut mesh.normals, &used, pose, budget)?;
        }
        if let Some(uvs) = uvs {
            mesh.uvs = used.iter().map(|v| skipped.report.finite_or_zero(upright(uvs.floats(v)))).collect();
            mesh.face_uvs = Corners::Vertices;
        }
        self.second_uvs(&mut part, &used, count, budget, skipped)?;
        part.mesh.colors = self.colors(&used, count, budget)?;
        if !part.mesh.colors.is_empty() {
            part.mesh.face_colors = Corners::Vertices;
        }
        if self.needs_tangents
            && let Some(tangents) = self.attribute::<4>("TANGENT", count)?
        {
            budget.take::<[f32; 4]>(used.len())?;
            let tangents = used.iter().map(|v| skipped.report.finite_or_zero(tangents.floats(v)));
            part.tangents = tangents.collect();
            self.morph("TANGENT", &mut part.tangents, &used, pose, budget)?;
        }
        if let Some(joints) = &pose.joints {
            self.bend(joints, &mut part, &used, count, budget)?;
        }
        skipped.report.dropped += part.mesh.drop_not_finite();
        let finite = |&v: &u32| part.mesh.positions[v as usize].iter().all(|x| x.is_finite());
        part.points.retain(finite);
        part.segments.retain(|ends| ends.iter().all(finite));
        Ok(part)
    }

    /// The second texture coordinates, where they are asked for and there are some.
    fn second_uvs(
        &self,
        part: &mut ModelPart,
        used: &Used,
        count: usize,
        budget: &mut Budget,
        skipped: &mut Skipped,
    ) -> Result<(), String> {
        let Some(set) = self.sets.second else { return Ok(()) };
        let Some(uvs) = self.attribute::<2>(&format!("TEXCOORD_{set}"), count)? else { return Ok(()) };
        budget.take::<[f32; 2]>(used.len())?;
        let uvs = used.iter().map(|v| skipped.report.finite_or_zero(upright(uvs.floats(v))));
        part.second_uvs = uvs.collect();
        Ok(())
    }

    /// Colours at the vertices; none where all are white.
    fn colors(&self, used: &Used, count: usize, budget: &mut Budget) -> Result<Vec<[f32; 4]>, String> {
        let Some(&number) = self.primitive.attributes.get("COLOR_0") else { return Ok(Vec::new()) };
        let has_alpha = self.document.accessors.get(number).is_some_and(|accessor| accessor.r#type == "VEC4");
        budget.take::<[f32; 4]>(used.len())?;
        // What is no number is no light.
        let held = |x: f32| if x > 0.0 { x.min(1.0) } else { 0.0 };
        let colors: Vec<[f32; 4]> = if has_alpha {
            let view = self.attribute::<4>("COLOR_0", count)?;
            view.iter().flat_map(|view| used.iter().map(|v| view.floats(v).map(held))).collect()
        } else {
            let view = self.attribute::<3>("COLOR_0", count)?;
            let opaque = |[r, g, b]: [f32; 3]| [held(r), held(g), held(b), 1.0];
            view.iter().flat_map(|view| used.iter().map(|v| opaque(view.floats(v)))).collect()
        };
        let is_white = colors.iter().all(|color| *color == [1.0; 4]);
        Ok(if is_white { Vec::new() } else { colors })
    }

    /// Adds what targets of morphs say to the first three numbers of each vertex.
    fn morph<const N: usize>(
        &self,
        name: &str,
        values: &mut [[f32; N]],
        used: &Used,
        pose: &Pose<'_>,
        budget: &mut Budget,
    ) -> Result<(), String> {
        for (target, &weight) in self.primitive.targets.iter().zip(pose.weights) {
            let Some(&number) = target.get(name).filter(|_| weight != 0.0) else { continue };
            let view = AccessorView::<3>::new(self.document, self.buffers, number)?;
            // This takes time in place of memory.
            budget.take::<[f32; 3]>(values.len())?;
            if used.iter().any(|v| v >= view.count) {
                return Err(format!(
                    "a target has {} of `{name}`, fewer than there are vertices",
                    view.count
                ));
            }
            for (value, v) in values.iter_mut().zip(used.iter()) {
                for (x, d) in value.iter_mut().zip(view.get(v)) {
                    *x = (f64::from(*x) + weight * d) as f32;
                }
            }
        }
        Ok(())
    }

    /// Moves every vertex with its joints.
    fn bend(
        &self,
        joints: &[DAffine3],
        part: &mut ModelPart,
        used: &Used,
        count: usize,
        budget: &mut Budget,
    ) -> Result<(), String> {
        let mut sets = Vec::new();
        while let Some(numbers) = self.attribute::<4>(&format!("JOINTS_{}", sets.len()), count)? {
            let weights = self.attribute::<4>(&format!("WEIGHTS_{}", sets.len()), count)?;
            budget.take::<[f32; 8]>(used.len())?;
            sets.push((numbers, weights.ok_or("its joints have no weights")?));
        }
        let fallback = joints.first().copied().unwrap_or(DAffine3::IDENTITY);
        for (i, v) in used.iter().enumerate() {
            let pairs = sets.iter().flat_map(|(numbers, weights)| {
                std::iter::zip(numbers.get(v).map(|joint| joint as usize), weights.get(v))
            });
            let map = blended(joints, pairs).unwrap_or(fallback);
            let p = &mut part.mesh.positions[i];
            *p = map.transform_point3(DVec3::from(p.map(f64::from))).as_vec3().to_array();
            if let Some(n) = part.mesh.normals.get_mut(i) {
                *n = turned(&map, *n);
            }
            if let Some([x, y, z, _]) = part.tangents.get_mut(i) {
                let along = map.transform_vector3(DVec3::from([*x, *y, *z].map(f64::from)));
                [*x, *y, *z] = along.normalize_or_zero().as_vec3().to_array();
            }
        }
        Ok(())
    }

    fn attribute<const N: usize>(
        &self,
        name: &str,
        count: usize,
    ) -> Result<Option<AccessorView<'_, N>>, String> {
        let Some(&number) = self.primitive.attributes.get(name) else { return Ok(None) };
        let view = AccessorView::new(self.document, self.buffers, number)?;
        if view.count != count {
            return Err(format!("there are {count} vertices, but {} of `{name}`", view.count));
        }
        Ok(Some(view))
    }

    /// The vertices of the corners, all of which exist.
    fn indices(&self, positions: &AccessorView<'_, 3>, budget: &mut Budget) -> Result<Vec<u32>, String> {
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
        let view = AccessorView::<1>::new(self.document, self.buffers, number)?;
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
