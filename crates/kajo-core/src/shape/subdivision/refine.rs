//! One step of subdivision.
//!
//! Of each corner `c` of a face comes a new face: for polygons the quadrilateral of its vertex, its edge, the face, and the edge
//! before; for triangles that of its vertex and its two edges, beside one of all three edges. So new corners are numbered by
//! old ones, and twins of twins are known without a search.

use std::ops::{Add, Mul};

use kajo_math::DVec3;

use super::cage::{Cage, NONE, Starts};
use super::{PrimvarChannel, Scheme};
use crate::ids::MaterialSlot;
use crate::shape::mesh::ABSENT;

/// Sums over what is around each vertex.
pub(super) struct Around {
    /// How many edges there are.
    pub edges: Vec<u32>,
    /// Sum of their far ends.
    pub ends: Vec<DVec3>,
    /// How many of them are sharp.
    pub sharp: Vec<u32>,
    /// Sum of the far ends of those.
    pub sharp_ends: Vec<DVec3>,
}

impl Around {
    /// * `positions`: of the vertices of `cage`
    pub fn new(cage: &Cage, positions: &[DVec3]) -> Around {
        let n = positions.len();
        let (ends, sharp_ends) = (vec![DVec3::ZERO; n], vec![DVec3::ZERO; n]);
        let mut around = Around { edges: vec![0; n], ends, sharp: vec![0; n], sharp_ends };
        for c in 0..cage.corners.len() {
            if cage.twins[c] != NONE && !cage.is_first(c) {
                continue;
            }
            let [a, b] = [c, cage.next(c)].map(|c| cage.corners[c] as usize);
            for (at, end) in [(a, b), (b, a)] {
                around.edges[at] += 1;
                around.ends[at] += positions[end];
                if cage.sharp[c] {
                    around.sharp[at] += 1;
                    around.sharp_ends[at] += positions[end];
                }
            }
        }
        around
    }
}

/// How much of each neighbour a vertex takes by Loop's rule.
pub(super) fn loop_share(n: f64) -> f64 {
    let c = 0.375 + 0.25 * kajo_math::fmath::cos64(std::f64::consts::TAU / n);
    (0.625 - c * c) / n
}

impl Cage {
    /// The cage after one step.
    pub(super) fn refined(&self, scheme: Scheme) -> Cage {
        let (edge_of, n_edges) = self.edge_numbers();
        let first_edge = self.positions.len();
        let faces = match scheme {
            Scheme::CatmullClark => self.face_points(),
            Scheme::Loop => Vec::new(),
        };
        let mut positions = self.vertex_points(scheme, &faces);
        positions.resize(first_edge + n_edges, DVec3::ZERO);
        for c in 0..self.corners.len() {
            if self.twins[c] == NONE || self.is_first(c) {
                positions[first_edge + edge_of[c] as usize] = self.edge_point(scheme, c, &faces);
            }
        }
        let first_face = positions.len() as u32;
        positions.extend(faces);
        let edge = |c: usize| first_edge as u32 + edge_of[c];
        let steps = Steps { cage: self, scheme };
        Cage {
            positions,
            starts: Starts::Every(if scheme == Scheme::Loop { 3 } else { 4 }),
            corners: steps.corners(|c| self.corners[c], edge, |face| first_face + face as u32),
            twins: steps.twins(),
            sharp: steps.sharp(),
            uvs: self.uvs.as_ref().map(|uvs| steps.channel(uvs)),
            colors: self.colors.as_ref().map(|colors| steps.channel(colors)),
            materials: self.materials.as_ref().map(|materials| steps.materials(materials)),
        }
    }

    /// A number for the edge of each corner, and how many there are.
    fn edge_numbers(&self) -> (Vec<u32>, usize) {
        let (mut numbers, mut n) = (vec![0; self.corners.len()], 0);
        for c in 0..self.corners.len() {
            numbers[c] = match self.twins[c] {
                twin if (twin as usize) < c => numbers[twin as usize],
                _ => {
                    n += 1;
                    n - 1
                }
            };
        }
        (numbers, n as usize)
    }

    fn face_points(&self) -> Vec<DVec3> {
        let mean = |face: usize| {
            let corners = self.of_face(face);
            let n = corners.len() as f64;
            corners.map(|c| self.positions[self.corners[c] as usize]).sum::<DVec3>() / n
        };
        (0..self.face_count()).map(mean).collect()
    }

    fn edge_point(&self, scheme: Scheme, c: usize, faces: &[DVec3]) -> DVec3 {
        let place = |c: usize| self.positions[self.corners[c] as usize];
        let ends = place(c) + place(self.next(c));
        if self.sharp[c] {
            return 0.5 * ends;
        }
        let twin = self.twins[c] as usize;
        match scheme {
            Scheme::CatmullClark => 0.25 * (ends + faces[self.face_of(c)] + faces[self.face_of(twin)]),
            Scheme::Loop => 0.375 * ends + 0.125 * (place(self.before(c)) + place(self.before(twin))),
        }
    }

    fn vertex_points(&self, scheme: Scheme, faces: &[DVec3]) -> Vec<DVec3> {
        let around = Around::new(self, &self.positions);
        let mut of_faces = vec![DVec3::ZERO; if faces.is_empty() { 0 } else { self.positions.len() }];
        if !faces.is_empty() {
            for (c, &vertex) in self.corners.iter().enumerate() {
                of_faces[vertex as usize] += faces[self.face_of(c)];
            }
        }
        let point = |(i, &v): (usize, &DVec3)| {
            let n = f64::from(around.edges[i]);
            match around.sharp[i] {
                _ if n == 0.0 => v,
                0 | 1 => match scheme {
                    Scheme::CatmullClark => (of_faces[i] / n + (around.ends[i] / n + v) + (n - 3.0) * v) / n,
                    Scheme::Loop => {
                        let b = loop_share(n);
                        (1.0 - n * b) * v + b * around.ends[i]
                    }
                },
                2 => 0.125 * (6.0 * v + around.sharp_ends[i]),
                _ => v,
            }
        };
        self.positions.iter().enumerate().map(point).collect()
    }
}

/// How a step numbers the corners of the new faces.
struct Steps<'a> {
    cage: &'a Cage,
    scheme: Scheme,
}

impl Steps<'_> {
    /// What all new corners have, of what old corners, edges and faces have.
    fn corners<T>(
        &self,
        vertex: impl Fn(usize) -> T,
        edge: impl Fn(usize) -> T,
        face: impl Fn(usize) -> T,
    ) -> Vec<T> {
        let cage = self.cage;
        let mut new = Vec::with_capacity(4 * cage.corners.len());
        match self.scheme {
            Scheme::CatmullClark => {
                for c in 0..cage.corners.len() {
                    new.extend([vertex(c), edge(c), face(cage.face_of(c)), edge(cage.before(c))]);
                }
            }
            Scheme::Loop => {
                for f in 0..cage.corners.len() / 3 {
                    let corners = [3 * f, 3 * f + 1, 3 * f + 2];
                    for c in corners {
                        new.extend([vertex(c), edge(c), edge(cage.before(c))]);
                    }
                    new.extend(corners.map(&edge));
                }
            }
        }
        new
    }

    /// The first new corner of the face that comes of an old corner.
    fn first(&self, corner: usize) -> usize {
        match self.scheme {
            Scheme::CatmullClark => 4 * corner,
            Scheme::Loop => 12 * (corner / 3) + 3 * (corner % 3),
        }
    }

    /// The new corner that stands for the first half of an old corner's edge, and that for the second half.
    fn halves(&self, corner: usize) -> [usize; 2] {
        let last = if self.scheme == Scheme::Loop { 2 } else { 3 };
        [self.first(corner), self.first(self.cage.next(corner)) + last]
    }

    fn twins(&self) -> Vec<u32> {
        let cage = self.cage;
        let mut twins = vec![NONE; 4 * cage.corners.len()];
        for c in 0..cage.corners.len() {
            if cage.twins[c] != NONE {
                let ([a, b], [p, q]) = (self.halves(c), self.halves(cage.twins[c] as usize));
                (twins[a], twins[b]) = (q as u32, p as u32);
            }
            match self.scheme {
                Scheme::CatmullClark => {
                    let (in_, out) = (4 * c + 1, 4 * cage.next(c) + 2);
                    (twins[in_], twins[out]) = (out as u32, in_ as u32);
                }
                Scheme::Loop => {
                    let (across, middle) = (self.first(c) + 1, 12 * (c / 3) + 9 + (c + 2) % 3);
                    (twins[across], twins[middle]) = (middle as u32, across as u32);
                }
            }
        }
        twins
    }

    fn sharp(&self) -> Vec<bool> {
        let mut sharp = vec![false; 4 * self.cage.corners.len()];
        for c in 0..self.cage.corners.len() {
            for half in self.halves(c) {
                sharp[half] = self.cage.sharp[c];
            }
        }
        sharp
    }

    /// Values blended linearly: those of edges and faces come after the old ones.
    fn channel<T: Copy + Default + Add<Output = T> + Mul<f32, Output = T>>(
        &self,
        old: &PrimvarChannel<T>,
    ) -> PrimvarChannel<T> {
        let cage = self.cage;
        let (n_values, n_corners) = (old.values.len() as u32, cage.corners.len() as u32);
        let value = |c: usize| old.values.get(old.corners[c] as usize).copied();
        let mut values = old.values.clone();
        let edge = |c: usize| Some((value(c)? + value(cage.next(c))?) * 0.5);
        values.extend((0..cage.corners.len()).map(|c| edge(c).unwrap_or_default()));
        let face = |f: usize| {
            let corners = cage.of_face(f);
            let share = 1.0 / corners.len() as f32;
            corners.map(value).try_fold(T::default(), |sum, value| Some(sum + value? * share))
        };
        if self.scheme == Scheme::CatmullClark {
            values.extend((0..cage.face_count()).map(|f| face(f).unwrap_or_default()));
        }
        let known = |index: u32, is_known: bool| if is_known { index } else { ABSENT };
        let corners = self.corners(
            |c| old.corners[c],
            |c| known(n_values + c as u32, edge(c).is_some()),
            |f| known(n_values + n_corners + f as u32, face(f).is_some()),
        );
        PrimvarChannel { values, corners }
    }

    fn materials(&self, old: &[MaterialSlot]) -> Vec<MaterialSlot> {
        let cage = self.cage;
        match self.scheme {
            Scheme::CatmullClark => (0..cage.corners.len()).map(|c| old[cage.face_of(c)]).collect(),
            Scheme::Loop => old.iter().flat_map(|&material| [material; 4]).collect(),
        }
    }
}
