//! The faces of a subdivision surface and which of them share edges.
//!
//! A corner also stands for the edge from it to the next corner of its face. Its twin is the same edge seen from the other
//! face. Edges with one face, with more than two, and with two that wind against each other are sharp and have no twins.

use kajo_math::{DVec3, Vec2, Vec4};

use super::{Polygons, PrimvarChannel};
use crate::ids::MaterialSlot;

/// The index of no corner.
pub(super) const NONE: u32 = u32::MAX;

/// A mesh of polygons; after one step all faces have the same number of corners.
#[derive(Clone, Debug, Default)]
pub struct Cage {
    pub(super) positions: Vec<DVec3>,
    /// The first corner of each face and one past the last, unless all faces have as many corners.
    pub(super) starts: Starts,
    /// The vertex of each corner.
    pub(super) corners: Vec<u32>,
    pub(super) twins: Vec<u32>,
    pub(super) sharp: Vec<bool>,
    pub(super) uvs: Option<PrimvarChannel<Vec2>>,
    pub(super) colors: Option<PrimvarChannel<Vec4>>,
    pub(super) materials: Option<Vec<MaterialSlot>>,
}

/// Where faces begin in the list of corners.
#[derive(Clone, Debug)]
pub(super) enum Starts {
    /// Each after so many corners.
    Every(u32),
    /// As this list says, which ends with the number of all corners; and the face of each corner.
    List(Vec<u32>, Vec<u32>),
}

impl Default for Starts {
    fn default() -> Starts {
        Starts::Every(4)
    }
}

impl Cage {
    /// A cage of polygons.
    ///
    /// Corners that repeat the one before are left out, and faces with fewer than three corners then.
    ///
    /// * `crease_cos`: edges whose faces' normals have a smaller cosine are sharp
    pub fn new(polygons: Polygons, crease_cos: f64) -> Cage {
        let Polygons { positions, sizes, corners, uvs, colors, materials } = polygons;
        let positions: Vec<DVec3> = positions.iter().map(|p| p.as_dvec3()).collect();
        let (mut starts, mut kept, mut kept_faces) = (vec![0], Vec::with_capacity(corners.len()), Vec::new());
        let mut first = 0;
        for (face, &size) in sizes.iter().enumerate() {
            let of_face = first..first + size as usize;
            let begin = kept.len();
            for c in of_face.clone() {
                let before = if c == of_face.start { of_face.end - 1 } else { c - 1 };
                if corners[c] != corners[before] {
                    kept.push(c);
                }
            }
            if kept.len() - begin < 3 {
                kept.truncate(begin);
            } else {
                starts.push(kept.len() as u32);
                kept_faces.push(face);
            }
            first = of_face.end;
        }
        let face_of =
            (0u32..).zip(starts.windows(2)).flat_map(|(face, ends)| (ends[0]..ends[1]).map(move |_| face));
        let face_of = face_of.collect();
        let mut cage = Cage {
            positions,
            starts: Starts::List(starts, face_of),
            corners: kept.iter().map(|&c| corners[c]).collect(),
            twins: vec![NONE; kept.len()],
            sharp: vec![true; kept.len()],
            uvs: uvs.map(|uvs| uvs.of_corners(&kept)),
            colors: colors.map(|colors| colors.of_corners(&kept)),
            materials: materials.map(|materials| kept_faces.iter().map(|&face| materials[face]).collect()),
        };
        cage.find_twins(crease_cos);
        cage
    }

    /// Number of faces and of corners.
    pub fn counts(&self) -> [usize; 2] {
        [self.face_count(), self.corners.len()]
    }

    pub(super) fn face_count(&self) -> usize {
        match &self.starts {
            Starts::Every(n) => self.corners.len() / *n as usize,
            Starts::List(starts, _) => starts.len() - 1,
        }
    }

    /// How many corners faces have where they all have as many; 0 elsewhere.
    pub(super) fn face_size(&self) -> u32 {
        if let Starts::Every(n) = self.starts { n } else { 0 }
    }

    /// The corners of a face.
    #[inline]
    pub(super) fn of_face(&self, face: usize) -> std::ops::Range<usize> {
        match &self.starts {
            Starts::Every(n) => face * *n as usize..(face + 1) * *n as usize,
            Starts::List(starts, _) => starts[face] as usize..starts[face + 1] as usize,
        }
    }

    /// The face of a corner.
    #[inline]
    pub(super) fn face_of(&self, corner: usize) -> usize {
        match &self.starts {
            Starts::Every(n) => corner / *n as usize,
            Starts::List(_, faces) => faces[corner] as usize,
        }
    }

    /// The next corner of its face.
    #[inline]
    pub(super) fn next(&self, corner: usize) -> usize {
        let face = self.of_face(self.face_of(corner));
        if corner + 1 == face.end { face.start } else { corner + 1 }
    }

    /// The corner before it.
    #[inline]
    pub(super) fn before(&self, corner: usize) -> usize {
        let face = self.of_face(self.face_of(corner));
        if corner == face.start { face.end - 1 } else { corner - 1 }
    }

    /// Whether a corner is the one of the two at its edge that stands for it.
    #[inline]
    pub(super) fn is_first(&self, corner: usize) -> bool {
        self.twins[corner] as usize > corner
    }

    /// The sum of the triangles that a face is cut into, as a normal twice as long as its area.
    fn face_normal(&self, face: usize) -> DVec3 {
        let corners = self.of_face(face);
        let place = |c: usize| self.positions[self.corners[c] as usize];
        let first = place(corners.start);
        let pairs = corners.clone().skip(1).zip(corners.skip(2));
        pairs.map(|(b, c)| (place(b) - first).cross(place(c) - first)).sum()
    }

    fn find_twins(&mut self, crease_cos: f64) {
        let ends = |c: usize| [self.corners[c], self.corners[self.next(c)]];
        let mut edges: Vec<([u32; 2], u32)> = (0..self.corners.len())
            .map(|c| {
                let [a, b] = ends(c);
                ([a.min(b), a.max(b)], c as u32)
            })
            .collect();
        edges.sort_unstable();
        let mut pairs = Vec::with_capacity(edges.len() / 2);
        for group in edges.chunk_by(|a, b| a.0 == b.0) {
            if let [(_, a), (_, b)] = *group
                && ends(a as usize)[0] != ends(b as usize)[0]
            {
                pairs.push([a, b]);
            }
        }
        for [a, b] in pairs {
            (self.twins[a as usize], self.twins[b as usize]) = (b, a);
            let [m, n] = [a, b].map(|c| self.face_normal(self.face_of(c as usize)).normalize_or_zero());
            let is_sharp = m.dot(n) < crease_cos;
            (self.sharp[a as usize], self.sharp[b as usize]) = (is_sharp, is_sharp);
        }
    }
}

impl<T: Copy> PrimvarChannel<T> {
    fn of_corners(self, kept: &[usize]) -> PrimvarChannel<T> {
        let corners = kept.iter().map(|&c| self.corners[c]).collect();
        PrimvarChannel { values: self.values, corners }
    }
}
