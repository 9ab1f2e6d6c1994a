//! Subdivision surfaces: a coarse mesh as the control cage of a smooth surface.
//!
//! Each step makes smaller faces of every face and moves the vertices to means of those around; without end that is a surface of
//! continuous normals. Polygons are subdivided by the rules of [Catmull and Clark 1978], triangles by those of [Loop 1987], borders
//! and sharp edges by those of cubic splines [Hoppe et al. 1994]. After the last step vertices go to their places on the limit
//! surface, where normals are those of its tangents [Halstead, Kass and DeRose 1993].
//!
//! *Catmull-Clark.* A face gets the mean `F` of its corners, an edge the mean of its ends and of the two faces' `F`, and a vertex `v`
//! of `n` edges, with the means `Q` of the `F` around and `R` of the edges' middles, goes to
//!
//! ```text
//! v' = (Q + 2 R + (n - 3) v) / n              limit: (n² v + 4 Σ e + Σ f) / (n (n + 5))
//! ```
//!
//! with the far ends `e` of its edges and the far corners `f` of its faces.
//!
//! *Loop.* An edge gets 3/8 of both ends and 1/8 of the two corners across, and a vertex goes to
//!
//! ```text
//! v' = (1 - n b) v + b Σ e                    limit: (1 - n c) v + c Σ e
//! b = (5/8 - (3/8 + cos(2 pi/n)/4)²) / n      c = 1 / (3/(8 b) + n)
//! ```
//!
//! *Borders and sharp edges.* An edge gets its middle; a vertex of two goes to `(6 v + a + b) / 8`, limit `(4 v + a + b) / 6`; one of
//! more stays. One at which a single sharp edge ends is taken as if it were smooth.
//!
//! Texture coordinates and colours belong to corners of faces, and are blended linearly within each face, so that seams stay.
//!
//! Displacement moves the vertices of the limit surface along their normals, by one amount for each vertex however many faces and
//! seams meet there, so that nothing cracks; the normals after that are those of the same tangents at the new places.

mod cage;
mod limit;
mod polygons;
mod refine;

use std::sync::Arc;

use kajo_math::{DVec3, Vec2};

pub use self::cage::Cage;
pub use self::polygons::Polygons;
use super::mesh::{CornerValues, MeshData};
use super::vertex_attributes::VertexAttributes;
use crate::ids::MaterialSlot;

/// By which rules a cage is subdivided.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Scheme {
    /// Any polygons, which become quadrilaterals.
    CatmullClark,
    /// Triangles.
    Loop,
}

/// Values at corners of faces.
#[derive(Clone, Debug, Default)]
pub struct PrimvarChannel<T> {
    /// The values.
    pub values: Vec<T>,
    /// Index of each corner's value, or [`super::ABSENT`].
    pub corners: Vec<u32>,
}

/// A surface after its last step, all vertices on the limit surface.
#[derive(Debug)]
pub struct Subdivided {
    cage: Arc<Cage>,
    scheme: Scheme,
    positions: Vec<DVec3>,
    normals: limit::Normals,
}

impl Subdivided {
    /// Subdivides a cage.
    ///
    /// * `levels`: steps, at least one
    pub fn new(mut cage: Cage, scheme: Scheme, levels: u32) -> Subdivided {
        for _ in 0..levels.max(1) {
            cage = cage.refined(scheme);
        }
        let positions = limit::positions(&cage, scheme);
        let normals = limit::normals(&cage, &cage.positions, scheme);
        Subdivided { cage: Arc::new(cage), scheme, positions, normals }
    }

    /// Vertices, in the order in which faces name them.
    pub fn positions(&self) -> &[DVec3] {
        &self.positions
    }

    /// Moves each vertex along its normal.
    ///
    /// * `height`: how far at a point with texture coordinates; where several of these meet, their mean
    pub fn displace(&mut self, mut height: impl FnMut(DVec3, Vec2) -> f64) {
        let cage = &*self.cage;
        let mut sums = vec![(0.0, 0u32, DVec3::ZERO); self.positions.len()];
        for (corner, &vertex) in cage.corners.iter().enumerate() {
            let uv = cage.uvs.as_ref().and_then(|uvs| uvs.values.get(uvs.corners[corner] as usize));
            let (sum, count, normal) = &mut sums[vertex as usize];
            *sum += height(self.positions[vertex as usize], uv.copied().unwrap_or_default());
            *count += 1;
            *normal += self.normals.of(corner);
        }
        for (p, (sum, count, normal)) in self.positions.iter_mut().zip(sums) {
            *p += sum / f64::from(count.max(1)) * normal.normalize_or_zero();
        }
        self.normals = limit::normals(cage, &self.positions, self.scheme);
    }

    /// The triangles.
    ///
    /// * `smooth`: with normals
    pub fn into_mesh(self, smooth: bool) -> MeshData {
        let Subdivided { cage, positions, normals, .. } = self;
        let triangles = triangles(&cage, &positions);
        let faces = triangles.iter().map(|corners| corners.map(|c| cage.corners[c as usize])).collect();
        let of =
            |indices: &[u32]| triangles.iter().map(|corners| corners.map(|c| indices[c as usize])).collect();
        let per_face = cage.face_size();
        let slots = |materials: &Vec<MaterialSlot>| {
            triangles.iter().map(|[corner, ..]| materials[(corner / per_face) as usize]).collect()
        };
        MeshData {
            positions: positions.iter().map(|p| p.as_vec3()).collect(),
            faces,
            normals: smooth.then(|| CornerValues {
                values: normals.values.iter().map(|n| n.as_vec3()).collect(),
                faces: Some(of(&normals.corners)),
            }),
            uvs: cage
                .uvs
                .as_ref()
                .map(|uvs| CornerValues { values: uvs.values.clone(), faces: Some(of(&uvs.corners)) }),
            colors: cage.colors.as_ref().map(|colors| CornerValues {
                values: colors.values.clone(),
                faces: Some(of(&colors.corners)),
            }),
            attributes: VertexAttributes::default(),
            material_slots: cage.materials.as_ref().map(slots),
        }
    }
}

/// Triangles of all faces, by corners; quadrilaterals are cut along the shorter diagonal.
fn triangles(cage: &Cage, positions: &[DVec3]) -> Vec<[u32; 3]> {
    let n = cage.corners.len() as u32;
    if cage.face_size() == 3 {
        return (0..n / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    }
    let place = |c: u32| positions[cage.corners[c as usize] as usize];
    (0..n / 4)
        .flat_map(|i| {
            let [a, b, c, d] = [4 * i, 4 * i + 1, 4 * i + 2, 4 * i + 3];
            let across = |x, y| place(x).distance_squared(place(y));
            if across(a, c) <= across(b, d) { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] }
        })
        .collect()
}

/// How many triangles a cage becomes.
///
/// * `faces`, `corners`: of the cage
pub fn triangle_count(scheme: Scheme, [faces, corners]: [usize; 2], levels: u32) -> u64 {
    let times = |n: usize, by: u32| (n as u64).saturating_mul(4u64.saturating_pow(by));
    match scheme {
        Scheme::CatmullClark => times(corners, levels.max(1) - 1).saturating_mul(2),
        Scheme::Loop => times(faces, levels.max(1)),
    }
}

/// Memory that the making of a triangle takes at most.
pub const BYTES_PER_TRIANGLE: u64 = 300;

#[cfg(test)]
mod tests;
