//! What every reader of mesh files makes: triangles with optional attributes.

use crate::skipped::Skipped;

/// Stands for "none" among the indices of a [`TriMesh`].
pub const NO_INDEX: u32 = u32::MAX;

/// Which values of a list the corners of each triangle have.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Corners {
    /// None: the file has no such values.
    #[default]
    Absent,
    /// Those with the numbers of the corner's vertices.
    Vertices,
    /// Three indices for each triangle, or [`NO_INDEX`].
    Own(Vec<[u32; 3]>),
}

/// A triangle mesh. Every index is in range or, where said so, [`NO_INDEX`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TriMesh {
    /// Vertices. Those that no face uses may be not finite.
    pub positions: Vec<[f32; 3]>,
    /// Normals as written, not normalised; zero where the file's is not finite.
    pub normals: Vec<[f32; 3]>,
    /// Texture coordinates; zero where the file's are not finite.
    pub uvs: Vec<[f32; 2]>,
    /// Red, green, blue and opacity, each in [0, 1].
    pub colors: Vec<[f32; 4]>,
    /// Whether red, green and blue are values for a screen, after the curve of sRGB, and not amounts.
    pub colors_are_srgb: bool,
    /// The vertices of each triangle.
    pub faces: Vec<[u32; 3]>,
    /// Faces of more than three corners, in their order: the first of their triangles, and how many these are.
    pub polygons: Vec<[u32; 2]>,
    /// The normals of each triangle's corners.
    pub face_normals: Corners,
    /// The texture coordinates of each triangle's corners.
    pub face_uvs: Corners,
    /// The colours of each triangle's corners.
    pub face_colors: Corners,
    /// The material of each triangle, an index into `material_names`, or
    /// [`NO_INDEX`] where the file names none; absent when it names none at all.
    pub face_materials: Option<Vec<u32>>,
    /// Names in the order of their first use.
    pub material_names: Vec<String>,
    /// Files of materials, as written, without repeats.
    pub libraries: Vec<String>,
}

/// What a reader left out or changed.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct MeshReport {
    /// Faces of more than three corners.
    pub polygons: usize,
    /// Faces of fewer than three corners, which are left out.
    pub degenerate: usize,
    /// Triangles left out for a vertex that is not finite.
    pub dropped: usize,
    /// Normals and texture coordinates replaced by zero, and colours by white, because they are not finite.
    pub zeroed: usize,
    /// Statements that are not read: those of lines, points and curves, and unknown ones.
    pub skipped: Skipped,
    /// What else the file has that is not supported, one sentence each.
    pub left_out: Vec<String>,
}

impl TriMesh {
    /// Leaves out triangles with a vertex that is not finite; answers how many there were.
    pub(crate) fn drop_not_finite(&mut self) -> usize {
        let finite = |v: u32| self.positions[v as usize].iter().all(|x| x.is_finite());
        let keep: Vec<bool> = self.faces.iter().map(|face| face.iter().all(|&v| finite(v))).collect();
        retain(&mut self.faces, &keep);
        for corners in [&mut self.face_uvs, &mut self.face_normals, &mut self.face_colors] {
            if let Corners::Own(list) = corners {
                retain(list, &keep);
            }
        }
        if let Some(materials) = &mut self.face_materials {
            retain(materials, &keep);
        }
        let mut kept_before = Vec::with_capacity(keep.len() + 1);
        kept_before.push(0);
        kept_before.extend(keep.iter().scan(0, |kept, &keep| {
            *kept += u32::from(keep);
            Some(*kept)
        }));
        for [first, count] in &mut self.polygons {
            let [from, to] = [*first, *first + *count].map(|i| kept_before[i as usize]);
            (*first, *count) = (from, to - from);
        }
        keep.iter().filter(|&&keep| !keep).count()
    }
}

fn retain<T>(list: &mut Vec<T>, keep: &[bool]) {
    let mut keep = keep.iter();
    list.retain(|_| keep.next().is_none_or(|&keep| keep));
}

impl MeshReport {
    /// The numbers, or zeros, counted, when one is not finite.
    #[inline]
    pub(crate) fn finite_or_zero<const N: usize>(&mut self, numbers: [f32; N]) -> [f32; N] {
        self.finite_or(numbers, 0.0)
    }

    /// The numbers, or others, counted, when one is not finite.
    #[inline]
    pub(crate) fn finite_or<const N: usize>(&mut self, numbers: [f32; N], other: f32) -> [f32; N] {
        if numbers.iter().all(|x| x.is_finite()) {
            return numbers;
        }
        self.zeroed += 1;
        [other; N]
    }

    /// What the user should hear about, one sentence each.
    pub fn warnings(&self) -> Vec<String> {
        let mut list = Vec::new();
        if self.degenerate > 0 {
            let count = self.degenerate;
            list.push(format!("{count} faces have fewer than three corners; they were left out"));
        }
        if self.dropped > 0 {
            list.push(format!(
                "{} triangles have a vertex that is not finite; they were left out",
                self.dropped
            ));
        }
        if self.zeroed > 0 {
            list.push(format!(
                "{} normals, texture coordinates or colours are not finite; they were ignored",
                self.zeroed
            ));
        }
        list.extend(self.skipped.sentences());
        list.extend(self.left_out.iter().cloned());
        list
    }
}
