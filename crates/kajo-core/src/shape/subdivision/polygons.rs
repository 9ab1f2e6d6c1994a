//! Polygons put together again from the triangles that a reader has cut them into.

use kajo_math::{Vec2, Vec3, Vec4};

use super::{PrimvarChannel, Scheme};
use crate::ids::MaterialSlot;
use crate::shape::mesh::{ABSENT, CornerValues, MeshData, welded};

/// A polygon mesh to be subdivided.
#[derive(Clone, Debug, Default)]
pub struct Polygons {
    /// Vertices.
    pub positions: Vec<Vec3>,
    /// How many corners each face has, at least three.
    pub sizes: Vec<u32>,
    /// The vertices of all corners, face by face, anticlockwise seen from outside.
    pub corners: Vec<u32>,
    /// Texture coordinates.
    pub uvs: Option<PrimvarChannel<Vec2>>,
    /// Linear RGB and opacity.
    pub colors: Option<PrimvarChannel<Vec4>>,
    /// The mesh's own material number of each face.
    pub materials: Option<Vec<MaterialSlot>>,
}

impl Polygons {
    /// The faces of a mesh; vertices at the same place become one.
    ///
    /// * `polygons`: the first triangle and the number of triangles of each face that has more than one
    pub fn of_mesh(data: MeshData, polygons: &[[u32; 2]], scheme: Scheme) -> Polygons {
        let vertices = welded(&data.positions);
        let mut sizes = Vec::with_capacity(data.faces.len());
        let mut corners = Vec::with_capacity(3 * data.faces.len());
        let mut first_of_face = Vec::with_capacity(data.faces.len());
        let mut outline = Outline::default();
        let mut polygons = polygons.iter().peekable();
        let mut triangle = 0;
        while triangle < data.faces.len() {
            while polygons.next_if(|[first, n]| *n == 0 || (*first as usize) < triangle).is_some() {}
            let together = match polygons.peek() {
                Some([first, n]) if *first as usize == triangle && scheme == Scheme::CatmullClark => {
                    *n as usize
                }
                _ => 1,
            };
            let end = (triangle + together).min(data.faces.len());
            let found = together > 1 && outline.find(&data.faces, triangle..end);
            if found {
                sizes.push(outline.corners.len() as u32);
                corners.extend_from_slice(&outline.corners);
                first_of_face.push(triangle);
            } else {
                for i in triangle..end {
                    sizes.push(3);
                    corners.extend([0, 1, 2].map(|k| [i as u32, k]));
                    first_of_face.push(i);
                }
            }
            triangle = end;
        }
        let vertex = |&[i, k]: &[u32; 2]| data.faces[i as usize][k as usize];
        let named = |list: &Option<Vec<[u32; 3]>>| -> Vec<u32> {
            let own = |corner: &[u32; 2]| match list {
                Some(list) => list.get(corner[0] as usize).map_or(ABSENT, |of| of[corner[1] as usize]),
                None => vertex(corner),
            };
            corners.iter().map(own).collect()
        };
        let uvs = data.uvs.as_ref().map(|uvs| named(&uvs.faces));
        let colors = data.colors.as_ref().map(|colors| named(&colors.faces));
        let channel = |values: Option<CornerValues<Vec2>>, corners: Option<Vec<u32>>| {
            Some(PrimvarChannel { values: values?.values, corners: corners? })
        };
        let materials = data.material_slots.as_ref();
        Polygons {
            corners: corners.iter().map(|corner| vertices[vertex(corner) as usize]).collect(),
            sizes,
            uvs: channel(data.uvs, uvs),
            colors: data
                .colors
                .zip(colors)
                .map(|(of, corners)| PrimvarChannel { values: of.values, corners }),
            materials: materials.map(|slots| first_of_face.iter().map(|&i| slots[i]).collect()),
            positions: data.positions,
        }
    }
}

/// Finds the border of a few triangles.
#[derive(Default)]
struct Outline {
    /// Triangle and number of each corner.
    corners: Vec<[u32; 2]>,
    /// Ends of edges and the corner where each begins, in the order of the ends.
    edges: Vec<([u32; 2], [u32; 2])>,
}

impl Outline {
    /// Whether the border of the triangles is a single ring without a vertex twice, which `corners` is then.
    fn find(&mut self, faces: &[[u32; 3]], triangles: std::ops::Range<usize>) -> bool {
        let Outline { corners, edges } = self;
        let n = triangles.len() + 2;
        edges.clear();
        for i in triangles {
            for k in 0..3 {
                edges.push(([faces[i][k], faces[i][(k + 1) % 3]], [i as u32, k as u32]));
            }
        }
        edges.sort_unstable();
        let has = |ends: [u32; 2]| edges.binary_search_by_key(&ends, |edge| edge.0).is_ok();
        let from = |vertex: u32| {
            let start = edges.partition_point(|edge| edge.0[0] < vertex);
            let leaving = edges[start..].iter().take_while(move |edge| edge.0[0] == vertex);
            leaving.filter(|edge| !has([edge.0[1], edge.0[0]]))
        };
        let borders = edges.iter().filter(|edge| !has([edge.0[1], edge.0[0]]));
        if borders.clone().count() != n {
            return false;
        }
        corners.clear();
        let mut edge = borders.clone().min_by_key(|edge| edge.1);
        while let Some(&(ends, corner)) = edge {
            corners.push(corner);
            let mut next = from(ends[1]);
            edge = next.next();
            if next.next().is_some() || corners.len() > n {
                return false;
            }
            if edge.is_some_and(|edge| edge.1 == corners[0]) {
                return corners.len() == n;
            }
        }
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(faces: &[[u32; 3]]) -> Option<Vec<u32>> {
        let mut outline = Outline::default();
        let found = outline.find(faces, 0..faces.len());
        let vertices = outline.corners.iter().map(|[i, k]| faces[*i as usize][*k as usize]).collect();
        found.then_some(vertices)
    }

    #[test]
    fn borders_of_triangles_are_polygons() {
        assert_eq!(found(&[[0, 1, 2], [0, 2, 3]]), Some(vec![0, 1, 2, 3]));
        assert_eq!(found(&[[5, 1, 2], [2, 4, 5], [2, 3, 4]]), Some(vec![5, 1, 2, 3, 4]));
        // Two triangles apart, and a polygon that has a vertex twice.
        assert_eq!(found(&[[0, 1, 2], [3, 4, 5]]), None);
        assert_eq!(found(&[[0, 1, 2], [0, 2, 0]]), None);
        assert_eq!(found(&[[0, 1, 2], [0, 2, 3], [0, 3, 1]]), None);
    }

    #[test]
    fn meshes_have_their_faces_again() {
        let positions = (0..6).map(|i| Vec3::new(i as f32, (i * i) as f32, 0.0)).collect();
        let faces = vec![[0, 1, 2], [0, 2, 3], [3, 4, 5]];
        let uvs = CornerValues {
            values: vec![Vec2::ZERO; 9],
            faces: Some(vec![[0, 1, 2], [0, 2, 3], [6, 7, ABSENT]]),
        };
        let slot = |i| MaterialSlot::new(i).unwrap();
        let material_slots = Some(vec![slot(7), slot(7), slot(8)]);
        let data = || MeshData { material_slots: material_slots.clone(), ..MeshData::default() };
        let with = |positions: &Vec<Vec3>, uvs| MeshData {
            positions: positions.clone(),
            faces: faces.clone(),
            uvs: Some(uvs),
            ..data()
        };
        let positions: Vec<Vec3> = positions;
        let uvs_again = CornerValues { values: uvs.values.clone(), faces: uvs.faces.clone() };
        let polygons = Polygons::of_mesh(with(&positions, uvs), &[[0, 2]], Scheme::CatmullClark);
        assert_eq!((&polygons.sizes[..], &polygons.corners[..]), (&[4, 3][..], &[0, 1, 2, 3, 3, 4, 5][..]));
        assert_eq!(polygons.uvs.unwrap().corners, [0, 1, 2, 3, 6, 7, ABSENT]);
        assert_eq!(polygons.materials.unwrap(), [slot(7), slot(8)]);
        let triangles = Polygons::of_mesh(with(&positions, uvs_again), &[[0, 2]], Scheme::Loop);
        assert_eq!(triangles.sizes, [3, 3, 3]);
    }
}
