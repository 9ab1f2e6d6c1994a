//! Triangle meshes.
//!
//! A mesh has a tree of its own whose leaves test triangles and nothing else, watertight
//! (see `kajo-bvh`). Flat shading takes the normal of the winding, `(b-a) x (c-a)`; smooth
//! shading interpolates normals at the vertices.
//!
//! Scene: `TriangleMesh { file bunny.ply  smooth on }`

use std::cmp::Ordering;
use std::collections::HashMap;
use std::sync::Arc;

use kajo_bvh::{BuildError, BuildSettings, TriangleBvh};
use kajo_math::{Aabb, DVec3, Ray, Vec2, Vec3, Vec4, rng::mix, robust::gamma};

use super::{Patch, Surface, Tessellation, VertexAttributes, hit_of_triangle, triangle_error};
use crate::ids::MaterialSlot;
use crate::interaction::{Hit, NO_UV, SurfacePoint, Tangents};

/// A corner of a face that has no normal or no texture coordinates of its own.
pub const ABSENT: u32 = u32::MAX;

/// Values at corners of faces: a list of values and three indices into it for each face.
#[derive(Debug, Default)]
pub struct CornerValues<T> {
    /// The values.
    pub values: Vec<T>,
    /// Indices of the corners' values, or [`ABSENT`]; `None` when they are those of the vertices.
    pub faces: Option<Vec<[u32; 3]>>,
}

impl<T: Copy> CornerValues<T> {
    /// The values at the corners of a face with these vertices.
    fn of(&self, face: u32, vertices: [u32; 3]) -> Option<[T; 3]> {
        let [a, b, c] = match &self.faces {
            Some(faces) => *faces.get(face as usize)?,
            None => vertices,
        };
        let value = |i: u32| self.values.get(i as usize).copied();
        Some([value(a)?, value(b)?, value(c)?])
    }

    fn bytes(&self) -> usize {
        size_of_val(&*self.values) + self.faces.as_ref().map_or(0, |faces| size_of_val(&**faces))
    }
}

/// An indexed triangle mesh with its tree. A clone is the same mesh.
#[derive(Clone, Debug)]
pub struct Mesh {
    parts: Arc<Parts>,
    /// The material of each triangle, where the mesh brings any.
    material_slots: Option<Arc<[MaterialSlot]>>,
}

#[derive(Debug)]
struct Parts {
    positions: Vec<Vec3>,
    faces: Vec<[u32; 3]>,
    normals: Option<CornerValues<Vec3>>,
    uvs: Option<CornerValues<Vec2>>,
    colors: Option<CornerValues<Vec4>>,
    attributes: Option<Box<VertexAttributes>>,
    bvh: TriangleBvh,
    closed: bool,
}

/// What a mesh is made of; every index lies within the list it points to.
#[derive(Debug, Default)]
pub struct MeshData {
    /// Vertices.
    pub positions: Vec<Vec3>,
    /// Vertex indices of each triangle.
    pub faces: Vec<[u32; 3]>,
    /// Unit normals at the corners, for smooth shading.
    pub normals: Option<CornerValues<Vec3>>,
    /// Texture coordinates at the corners.
    pub uvs: Option<CornerValues<Vec2>>,
    /// Linear RGB and opacity in [0, 1] at the corners, factors of those of the material; see
    /// [`crate::texture::TextureContext::tint`].
    pub colors: Option<CornerValues<Vec4>>,
    /// What else vertices have.
    pub attributes: VertexAttributes,
    /// The mesh's own material number of each triangle.
    pub material_slots: Option<Vec<MaterialSlot>>,
}

impl MeshData {
    /// Bytes of the mesh with its tree, and more bytes while that is built.
    pub(crate) fn memory(&self) -> (usize, usize) {
        const TREE: usize = 64;
        const BUILDING: usize = 128;
        let corners = |bytes: Option<usize>| bytes.unwrap_or(0);
        let lists = size_of_val(&*self.positions)
            + size_of_val(&*self.faces)
            + corners(self.normals.as_ref().map(CornerValues::bytes))
            + corners(self.uvs.as_ref().map(CornerValues::bytes))
            + corners(self.colors.as_ref().map(CornerValues::bytes))
            + self.attributes.bytes()
            + self.material_slots.as_ref().map_or(0, |slots| size_of_val(&**slots));
        (lists + TREE * self.faces.len(), BUILDING * self.faces.len())
    }
}

impl Mesh {
    /// Builds the tree of a mesh.
    ///
    /// Triangles without area or with coordinates that are not finite are never hit; how many
    /// there are is [`Mesh::dropped`].
    ///
    /// # Errors
    ///
    /// When a face names a vertex that does not exist, or there are too many faces.
    pub fn new(data: MeshData, settings: &BuildSettings) -> Result<Mesh, BuildError> {
        let MeshData { positions, faces, normals, uvs, colors, attributes, material_slots } = data;
        let attributes = (!attributes.is_empty()).then(|| Box::new(attributes));
        let bvh = TriangleBvh::build(&positions, &faces, settings)?;
        let closed = is_closed(&positions, &faces);
        let parts = Parts { positions, faces, normals, uvs, colors, attributes, bvh, closed };
        Ok(Mesh { parts: Arc::new(parts), material_slots: material_slots.map(Arc::from) })
    }

    /// Number of triangles given.
    pub fn triangle_count(&self) -> usize {
        self.parts.faces.len()
    }

    /// Number of triangles that no ray can hit, for want of area or of finite corners.
    pub fn dropped(&self) -> usize {
        self.parts.bvh.stats().dropped
    }

    /// The ends of an edge that has a triangle on one side only, or two that wind against each other, if there is one.
    pub fn open_edge(&self) -> Option<[Vec3; 2]> {
        // Adding zero makes one of the two zeros.
        let bits = |p: Vec3| (p + Vec3::ZERO).to_array().map(f32::to_bits);
        let mut balance: HashMap<[[u32; 3]; 2], i32> = HashMap::new();
        let edges = || {
            self.parts.faces.iter().flat_map(|&[a, b, c]| {
                [(a, b), (b, c), (c, a)].map(|(from, to)| {
                    [self.parts.positions[from as usize], self.parts.positions[to as usize]]
                })
            })
        };
        for [from, to] in edges() {
            let (from, to) = (bits(from), bits(to));
            *balance.entry([from.min(to), from.max(to)]).or_default() += if from < to { 1 } else { -1 };
        }
        edges().find(|&[from, to]| {
            let (from, to) = (bits(from), bits(to));
            from != to && balance[&[from.min(to), from.max(to)]] != 0
        })
    }

    /// The vertices.
    pub fn positions(&self) -> &[Vec3] {
        &self.parts.positions
    }

    /// The mesh's own material of each triangle, or [`MaterialSlot::NONE`]; none at all where it brings no materials.
    pub fn material_slots(&self) -> &[MaterialSlot] {
        self.material_slots.as_deref().unwrap_or_default()
    }

    /// The same mesh without the materials that it brings.
    #[must_use]
    pub fn of_one_material(&self) -> Mesh {
        Mesh { parts: self.parts.clone(), material_slots: None }
    }

    /// The corners of a triangle.
    pub fn triangle(&self, face: u32) -> [Vec3; 3] {
        self.parts.faces[face as usize].map(|i| self.parts.positions[i as usize])
    }

    /// Whether the colours of the corners let anything show through.
    pub fn has_opacities(&self) -> bool {
        self.parts.colors.as_ref().is_some_and(|colors| colors.values.iter().any(|color| color.w < 1.0))
    }

    /// Texture coordinates at the corners of the triangle, if the mesh has them there.
    fn corner_uvs(&self, hit: &Hit) -> Option<[Vec2; 3]> {
        self.parts.uvs.as_ref()?.of(hit.part, self.parts.faces[hit.part as usize])
    }

    /// Interpolated unit normal, if the mesh has normals there.
    fn smooth_normal(&self, hit: &Hit) -> Option<Vec3> {
        let [a, b, c] = self.parts.normals.as_ref()?.of(hit.part, self.parts.faces[hit.part as usize])?;
        ((1.0 - hit.u - hit.v) * a + hit.u * b + hit.v * c).try_normalize()
    }
}

impl Surface for Mesh {
    fn bounds(&self) -> Aabb {
        self.parts.bvh.bounds()
    }

    fn is_finite(&self) -> bool {
        // Triangles with corners that are not finite are left out.
        true
    }

    #[inline]
    fn hit(&self, ray: &Ray) -> Option<Hit> {
        let hit = self.parts.bvh.closest(ray)?;
        Some(Hit { t: hit.t, u: hit.u, v: hit.v, part: hit.triangle })
    }

    #[inline]
    fn blocks(&self, ray: &Ray) -> bool {
        self.parts.bvh.any(ray)
    }

    fn crossings<F: FnMut(Hit)>(&self, ray: &Ray, mut visit: F) {
        self.parts.bvh.all(ray, |hit| visit(Hit { t: hit.t, u: hit.u, v: hit.v, part: hit.triangle }));
    }

    fn surface_at(&self, _ray: &Ray, hit: &Hit) -> SurfacePoint {
        let corners = self.triangle(hit.part);
        let [a, b, c] = corners.map(|p| p.as_dvec3());
        let (u, v) = (f64::from(hit.u), f64::from(hit.v));
        let ng = (b - a).cross(c - a).normalize_or(DVec3::Z).as_vec3();
        let p = (a + u * (b - a) + v * (c - a)).as_vec3();
        let p_error = gamma(2) * p.abs() + Vec3::splat(triangle_error([a, b, c]));
        SurfacePoint { p, p_error, n: self.smooth_normal(hit).unwrap_or(ng), ng }
    }

    fn hit_at(&self, part: u32, p: Vec3) -> Hit {
        hit_of_triangle(self.triangle(part).map(|v| v.as_dvec3()), part, p)
    }

    fn uv_at(&self, hit: &Hit, _p: Vec3) -> Vec2 {
        self.corner_uvs(hit).map_or(NO_UV, |[a, b, c]| (1.0 - hit.u - hit.v) * a + hit.u * b + hit.v * c)
    }

    fn second_uv_at(&self, hit: &Hit, _p: Vec3) -> Option<Vec2> {
        self.parts.attributes.as_ref()?.second_uv(self.parts.faces[hit.part as usize], hit)
    }

    fn color_at(&self, hit: &Hit) -> Option<Vec4> {
        let [a, b, c] = self.parts.colors.as_ref()?.of(hit.part, self.parts.faces[hit.part as usize])?;
        // Coordinates that are rounded may lie a little outside.
        Some(((1.0 - hit.u - hit.v) * a + hit.u * b + hit.v * c).clamp(Vec4::ZERO, Vec4::ONE))
    }

    fn has_colors(&self) -> bool {
        self.parts.colors.is_some()
    }

    fn tangents_at(&self, hit: &Hit, _p: Vec3) -> Tangents {
        let corners = self.triangle(hit.part).map(|p| p.as_dvec3());
        let own =
            self.corner_uvs(hit).map_or_else(Tangents::default, |uvs| Tangents::of_triangle(corners, uvs));
        let Some(attributes) = &self.parts.attributes else { return own };
        let [a, b, c] = corners;
        let flat = || (b - a).cross(c - a).normalize_or(DVec3::Z).as_vec3();
        let n = self.smooth_normal(hit).unwrap_or_else(flat);
        attributes.tangents(self.parts.faces[hit.part as usize], hit, n, own)
    }

    fn second_tangents_at(&self, hit: &Hit, _p: Vec3) -> Option<Tangents> {
        let uvs = self.parts.attributes.as_ref()?.second_uvs(self.parts.faces[hit.part as usize])?;
        Some(Tangents::of_triangle(self.triangle(hit.part).map(|p| p.as_dvec3()), uvs))
    }

    fn patches<F: FnMut(u32, Patch)>(&self, mut visit: F) {
        for face in 0..self.parts.faces.len() as u32 {
            visit(face, Patch::Triangle(self.triangle(face).map(|v| v.as_dvec3())));
        }
    }

    /// Vertices are shared as in the mesh; one with several normals is there more than once.
    fn tessellate(&self, _around: u32, out: &mut Tessellation) {
        let base = out.positions.len() as u32;
        out.positions.extend(&self.parts.positions);
        out.normals.resize(out.positions.len(), Vec3::ZERO);
        let mut given = vec![self.parts.normals.is_none(); self.parts.positions.len()];
        for (part, &face) in (0..).zip(&self.parts.faces) {
            let normals = self.parts.normals.as_ref().and_then(|normals| normals.of(part, face));
            let corner = |k: usize| {
                let (i, n) = (face[k], normals.map_or(Vec3::ZERO, |normals| normals[k]));
                let place = (base + i) as usize;
                if !given[i as usize] {
                    given[i as usize] = true;
                    out.normals[place] = n;
                }
                if out.normals[place] == n {
                    base + i
                } else {
                    out.vertex(self.parts.positions[i as usize], n)
                }
            };
            let corners = [0, 1, 2].map(corner);
            out.face(part, corners);
        }
    }

    fn is_closed(&self) -> bool {
        self.parts.closed
    }

    fn is_curved(&self) -> bool {
        false
    }

    fn part_count(&self) -> u32 {
        self.parts.faces.len() as u32
    }

    fn material_slot(&self, part: u32) -> Option<MaterialSlot> {
        self.material_slots().get(part as usize).and_then(|slot| slot.given())
    }

    fn heap_bytes(&self) -> usize {
        size_of_val(&*self.parts.positions)
            + size_of_val(&*self.parts.faces)
            + self.parts.normals.as_ref().map_or(0, CornerValues::bytes)
            + self.parts.uvs.as_ref().map_or(0, CornerValues::bytes)
            + self.parts.colors.as_ref().map_or(0, CornerValues::bytes)
            + self.parts.attributes.as_ref().map_or(0, |attributes| attributes.bytes())
            + size_of_val(self.material_slots())
            + self.parts.bvh.stats().bytes
    }
}

/// Which faces meet at a vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Neighbours {
    /// Those that name the same vertex: seams where a file repeats a point stay sharp.
    ByIndex,
    /// Those with a corner at the same position.
    ByPosition,
}

/// Normals at the vertices: the plain sum of the unit normals of the faces around, as the
/// `mit-a2` programs have it.
pub fn vertex_normals(positions: &[Vec3], faces: &[[u32; 3]], neighbours: Neighbours) -> CornerValues<Vec3> {
    let first = (neighbours == Neighbours::ByPosition).then(|| welded(positions));
    let place = |corner: u32| first.as_ref().map_or(corner, |first| first[corner as usize]);
    let mut sums = vec![Vec3::ZERO; positions.len()];
    for face in faces {
        let [a, b, c] = face.map(|i| positions[i as usize].as_dvec3());
        let n = (b - a).cross(c - a).normalize_or_zero().as_vec3();
        for &corner in face {
            sums[place(corner) as usize] += n;
        }
    }
    for corner in 0..sums.len() {
        // The first of several comes before the others, so that it is of unit length already.
        sums[corner] = match place(corner as u32) as usize {
            first if first == corner => sums[corner].normalize_or_zero(),
            first => sums[first],
        };
    }
    CornerValues { values: sums, faces: None }
}

/// For each vertex the first one at the same position.
pub(super) fn welded(positions: &[Vec3]) -> Vec<u32> {
    let key = |i: u32| (positions[i as usize] + Vec3::ZERO).to_array().map(f32::to_bits);
    let mut order: Vec<u32> = (0..positions.len() as u32).collect();
    order.sort_unstable_by_key(|&i| (key(i), i));
    let mut first = vec![0; positions.len()];
    for group in order.chunk_by(|&i, &j| key(i) == key(j)) {
        for &i in group {
            first[i as usize] = group[0];
        }
    }
    first
}

/// Whether every edge is used equally often in both directions, so that the surface has no border.
///
/// Points count as one where their positions are equal. Instead of a table of edges, which would take more
/// memory than the mesh, a hash of each edge is added for one direction and subtracted for the other; the sum
/// of a surface with a border is zero with a probability of 2^-128.
fn is_closed(positions: &[Vec3], faces: &[[u32; 3]]) -> bool {
    let point = |i: u32| {
        // Adding zero makes one of the two zeros.
        let bits = (positions[i as usize] + Vec3::ZERO).to_array().map(|x| u64::from(x.to_bits()));
        mix(mix(bits[0] | bits[1] << 32) ^ bits[2])
    };
    let mut sum = 0u128;
    for face in faces {
        let [a, b, c] = face.map(point);
        for (from, to) in [(a, b), (b, c), (c, a)] {
            let (low, high) = (from.min(to), from.max(to));
            let edge = u128::from(mix(low ^ mix(high))) << 64 | u128::from(mix(high ^ mix(!low)));
            sum = match from.cmp(&to) {
                Ordering::Less => sum.wrapping_add(edge),
                Ordering::Equal => sum,
                Ordering::Greater => sum.wrapping_sub(edge),
            };
        }
    }
    sum == 0
}
