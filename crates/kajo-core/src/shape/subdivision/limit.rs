//! Places and normals on the limit surface.
//!
//! Tangents at a vertex of `n` edges, `e_i` their far ends and `f_i` the far corner of the face between `e_i` and `e_(i+1)`, are for
//! polygons [Halstead, Kass and DeRose 1993]
//!
//! ```text
//! t = Σ A cos(i a) e_i + (cos(i a) + cos((i+1) a)) f_i         a = 2 pi/n,  A = 1 + cos a + cos(a/2) sqrt(2 (9 + cos a))
//! ```
//!
//! and the same with sines, for triangles `Σ cos(i a) e_i` and `Σ sin(i a) e_i`.
//!
//! Where `k` faces lie between two sharp edges, one tangent is `e_0 - e_k`. The other one is what a step multiplies by the factor `l` of
//! `sin(i a)`, `a = pi/k`, that is, the left eigenvector of the step's matrix:
//!
//! ```text
//! polygons:   t = b (e_0 + e_k) + Σ sin(i a) e_i + Σ d_i f_i + (..) v      d_i = (sin(i a) + sin((i+1) a)) / A
//!             A = 1 + cos a + sqrt((1 + cos a)(9 + cos a)),  l = (A + 4)/16
//!             b = (8 (3/4 - l)(sin(a)/16 + d_0/4) - 3/8 Σ sin(i a) - 1/4 Σ d_i) / (1 + 8 (3/4 - l)(l - 1/2))
//! triangles:  t = b (e_0 + e_k) + Σ sin(i a) e_i + (..) v                  l = 3/8 + cos(a)/4
//!             b = (8 (3/4 - l) sin(a)/8 - 3/8 Σ sin(i a)) / (1 + 8 (3/4 - l)(l - 1/2))
//! ```
//!
//! with the factor of `v` that makes all of them add up to zero; of one face it is `e_0 + e_1 - 2 v`.

use std::f64::consts::{PI, TAU};

use kajo_math::{DVec3, fmath};

use super::Scheme;
use super::cage::{Cage, NONE};
use super::refine::{Around, loop_share};

/// Normals at corners: one for each run of faces around a vertex without a sharp edge between them.
#[derive(Debug, Default)]
pub(super) struct Normals {
    pub values: Vec<DVec3>,
    /// Index of each corner's normal.
    pub corners: Vec<u32>,
}

impl Normals {
    pub fn of(&self, corner: usize) -> DVec3 {
        self.values[self.corners[corner] as usize]
    }
}

/// The places of all vertices of a cage.
pub(super) fn positions(cage: &Cage, scheme: Scheme) -> Vec<DVec3> {
    let around = Around::new(cage, &cage.positions);
    let mut far = Vec::new();
    if scheme == Scheme::CatmullClark {
        far = vec![DVec3::ZERO; cage.positions.len()];
        for (c, &vertex) in cage.corners.iter().enumerate() {
            far[vertex as usize] += cage.positions[cage.corners[cage.next(cage.next(c))] as usize];
        }
    }
    let place = |(i, &v): (usize, &DVec3)| {
        let n = f64::from(around.edges[i]);
        match around.sharp[i] {
            _ if n == 0.0 => v,
            0 | 1 => match scheme {
                Scheme::CatmullClark => (n * n * v + 4.0 * around.ends[i] + far[i]) / (n * (n + 5.0)),
                Scheme::Loop => {
                    let c = 1.0 / (0.375 / loop_share(n) + n);
                    (1.0 - n * c) * v + c * around.ends[i]
                }
            },
            2 => (4.0 * v + around.sharp_ends[i]) / 6.0,
            _ => v,
        }
    };
    cage.positions.iter().enumerate().map(place).collect()
}

/// The normals of all corners.
///
/// * `positions`: of the vertices as control points
pub(super) fn normals(cage: &Cage, positions: &[DVec3], scheme: Scheme) -> Normals {
    let around = Around::new(cage, positions);
    let mut normals = Normals { values: Vec::new(), corners: vec![NONE; cage.corners.len()] };
    let mut ring = Ring::default();
    for c in 0..cage.corners.len() {
        if normals.corners[c] != NONE {
            continue;
        }
        ring.gather(cage, positions, c);
        for &corner in &ring.corners {
            normals.corners[corner] = normals.values.len() as u32;
        }
        normals.values.push(ring.normal(around.sharp[cage.corners[c] as usize], scheme));
    }
    normals
}

/// A run of faces around a vertex, anticlockwise.
#[derive(Default)]
struct Ring {
    center: DVec3,
    corners: Vec<usize>,
    /// Whether it goes all around.
    is_closed: bool,
    /// Far ends of edges, of an open run one more than faces.
    ends: Vec<DVec3>,
    /// The far corner of each face.
    far: Vec<DVec3>,
}

impl Ring {
    /// The run that a corner is in.
    fn gather(&mut self, cage: &Cage, positions: &[DVec3], corner: usize) {
        let place = |c: usize| positions[cage.corners[c] as usize];
        let mut first = corner;
        while !cage.sharp[first] {
            first = cage.next(cage.twins[first] as usize);
            if first == corner {
                break;
            }
        }
        self.center = place(corner);
        self.is_closed = !cage.sharp[first];
        self.corners.clear();
        self.ends.clear();
        self.far.clear();
        let mut c = first;
        loop {
            self.corners.push(c);
            self.ends.push(place(cage.next(c)));
            self.far.push(place(cage.next(cage.next(c))));
            let before = cage.before(c);
            if cage.sharp[before] {
                self.ends.push(place(before));
                return;
            }
            c = cage.twins[before] as usize;
            if c == first {
                return;
            }
        }
    }

    /// * `sharp`: how many sharp edges the vertex has
    fn normal(&mut self, sharp: u32, scheme: Scheme) -> DVec3 {
        // One sharp edge ends here: it is met at both ends of the run.
        if sharp == 1 && !self.is_closed {
            self.is_closed = true;
            self.ends.pop();
        }
        let edge = |i: usize| self.ends[i % self.ends.len()] - self.center;
        let mean: DVec3 = (0..self.corners.len()).map(|i| edge(i).cross(edge(i + 1))).sum();
        let tangents = match (self.is_closed, sharp) {
            (true, _) => Some(self.tangents_around(scheme)),
            (false, 2) => Some(self.tangents_of_border(scheme)),
            _ => None,
        };
        let normal = tangents.map_or(mean, |[s, t]| s.cross(t));
        let side = if normal.dot(mean) < 0.0 { -1.0 } else { 1.0 };
        // Of folded faces tangents may vanish.
        (side * normal).try_normalize().unwrap_or_else(|| mean.normalize_or_zero())
    }

    fn tangents_around(&self, scheme: Scheme) -> [DVec3; 2] {
        let n = self.corners.len();
        let a = TAU / n as f64;
        let cos = fmath::cos64(a);
        let of_edge = match scheme {
            Scheme::CatmullClark => 1.0 + cos + fmath::cos64(0.5 * a) * (2.0 * (9.0 + cos)).sqrt(),
            Scheme::Loop => 1.0,
        };
        let mut tangents = [DVec3::ZERO; 2];
        for i in 0..n {
            let (sin, cos) = fmath::sincos64(i as f64 * a);
            let (sin_next, cos_next) = fmath::sincos64((i + 1) as f64 * a);
            let end = of_edge * (self.ends[i] - self.center);
            tangents[0] += cos * end;
            tangents[1] += sin * end;
            if scheme == Scheme::CatmullClark {
                let far = self.far[i] - self.center;
                tangents[0] += (cos + cos_next) * far;
                tangents[1] += (sin + sin_next) * far;
            }
        }
        tangents
    }

    fn tangents_of_border(&self, scheme: Scheme) -> [DVec3; 2] {
        let k = self.corners.len();
        let edge = |i: usize| self.ends[i] - self.center;
        let along = edge(0) - edge(k);
        if k == 1 {
            return [along, edge(0) + edge(1)];
        }
        let (sin, cos) = fmath::sincos64(PI / k as f64);
        let inner = |i: usize| fmath::sin64(i as f64 * PI / k as f64);
        let (of_edges, edges) =
            (1..k).fold((0.0, DVec3::ZERO), |(sum, edges), i| (sum + inner(i), edges + inner(i) * edge(i)));
        // The factor of a step, the weights of the ends' neighbours in a step, and the sum of all but the ends'.
        let (lambda, beside, sum, inside) = match scheme {
            Scheme::CatmullClark => {
                let a = 1.0 + cos + ((1.0 + cos) * (9.0 + cos)).sqrt();
                let weight = |i: usize| (inner(i) + inner(i + 1)) / a;
                let (of_faces, faces) = (0..k).fold((0.0, DVec3::ZERO), |(sum, faces), i| {
                    (sum + weight(i), faces + weight(i) * (self.far[i] - self.center))
                });
                let beside = sin / 16.0 + weight(0) / 4.0;
                ((a + 4.0) / 16.0, beside, 0.375 * of_edges + 0.25 * of_faces, edges + faces)
            }
            Scheme::Loop => (0.375 + 0.25 * cos, sin / 8.0, 0.375 * of_edges, edges),
        };
        let rest = 8.0 * (0.75 - lambda);
        let ends = (rest * beside - sum) / (rest * (lambda - 0.5) + 1.0);
        [along, ends * (edge(0) + edge(k)) + inside]
    }
}
