//! Surfaces as triangles, for pictures made by rasterising.
//!
//! Vertices lie on the surface and have its normals, so that a mesh of few triangles is off by the sagitta of its
//! arcs alone: `r (1 - cos(pi / n))` with `n` segments around.

use std::f64::consts::{PI, TAU};

use std::collections::HashMap;

use kajo_math::{Aabb, DVec3, Transform, Vec3, fmath};

use super::patch::on_torus;
use super::{Canonical, CurvedPatch, DiskPatch, Patch, QuadPatch};

/// Triangles that stand for a surface, in its own space. They wind counter-clockwise seen from outside.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tessellation {
    /// Vertices.
    pub positions: Vec<Vec3>,
    /// Unit outward normals of the vertices; zero where each triangle is to have its own.
    pub normals: Vec<Vec3>,
    /// Indices of vertices.
    pub faces: Vec<[u32; 3]>,
    /// The part of the shape that each triangle belongs to, as in [`crate::interaction::Hit::part`].
    pub parts: Vec<u32>,
}

impl Tessellation {
    /// Adds a vertex and returns its index.
    pub fn vertex(&mut self, p: Vec3, n: Vec3) -> u32 {
        self.positions.push(p);
        self.normals.push(n);
        self.positions.len() as u32 - 1
    }

    /// Adds a triangle.
    pub fn face(&mut self, part: u32, corners: [u32; 3]) {
        self.faces.push(corners);
        self.parts.push(part);
    }

    /// Adds a piece of surface.
    ///
    /// * `around`: segments of a full circle
    pub fn patch(&mut self, part: u32, patch: &Patch, around: u32) {
        let around = around.max(3);
        match patch {
            Patch::Triangle([a, b, c]) => {
                let n = (b - a).cross(c - a).normalize_or_zero().as_vec3();
                let corners = [a, b, c].map(|p| self.vertex(p.as_vec3(), n));
                self.face(part, corners);
            }
            Patch::Rectangle(rectangle) => {
                let ([a, b], corner) = (rectangle.edges(), rectangle.corner());
                self.grid(part, [1, 1], |x, y| (corner + x * a + y * b, rectangle.normal()));
            }
            Patch::Quad(QuadPatch { corner, edges: [a, b] }) => {
                let n = a.cross(*b).normalize_or_zero();
                self.grid(part, [1, 1], |x, y| (corner + x * a + y * b, n));
            }
            Patch::Disk(DiskPatch { center, axes: [a, b], inner }) => {
                let n = a.cross(*b).normalize_or_zero();
                self.grid(part, [around, 1], |x, y| {
                    let r = inner + y * (1.0 - inner);
                    (center + r * (fmath::cos64(TAU * x) * a + fmath::sin64(TAU * x) * b), n)
                });
            }
            Patch::Sphere { center, radius } => self.grid(part, [around, around.div_ceil(2)], |x, y| {
                let n = unit(x, y);
                (center + *radius * n, n)
            }),
            Patch::Curved(curved) => self.curved(part, curved, around),
            // Its shape knows better.
            Patch::Traced(_) => {}
        }
    }

    fn curved(&mut self, part: u32, curved: &CurvedPatch, around: u32) {
        match curved.surface {
            Canonical::Sphere => {
                self.grid(part, [around, around.div_ceil(2)], |x, y| curved.placed(unit(x, y), unit(x, y)));
            }
            Canonical::Frustum([r0, r1]) => self.grid(part, [around, 1], |x, y| {
                let (sin, cos) = (fmath::sin64(TAU * x), fmath::cos64(TAU * x));
                let r = r0 + y * (r1 - r0);
                curved.placed(DVec3::new(r * cos, r * sin, y), DVec3::new(cos, sin, r0 - r1))
            }),
            Canonical::Torus { minor, widest } => {
                self.grid(part, [around, around.div_ceil(2)], |x, y| {
                    let middle = on_torus(0.0, 0.0, TAU * x);
                    let q = on_torus(minor, (2.0 * y - 1.0) * widest, TAU * x);
                    curved.placed(q, (q - middle) / minor)
                });
            }
        }
    }

    /// Adds the image of the unit square under a map to points and normals.
    pub fn grid(&mut self, part: u32, [columns, rows]: [u32; 2], map: impl Fn(f64, f64) -> (DVec3, DVec3)) {
        let first = self.positions.len() as u32;
        for row in 0..=rows {
            for column in 0..=columns {
                let (p, n) = map(f64::from(column) / f64::from(columns), f64::from(row) / f64::from(rows));
                self.vertex(p.as_vec3(), n.as_vec3());
            }
        }
        let index = |column: u32, row: u32| first + row * (columns + 1) + column;
        for row in 0..rows {
            for column in 0..columns {
                let [a, b] = [index(column, row), index(column + 1, row)];
                let [c, d] = [index(column + 1, row + 1), index(column, row + 1)];
                self.turned(part, [a, b, c]);
                self.turned(part, [a, c, d]);
            }
        }
    }

    /// Takes the triangles to another space.
    pub fn place(&mut self, to: &Transform) {
        self.positions.iter_mut().for_each(|p| *p = to.point(*p));
        self.normals.iter_mut().filter(|n| **n != Vec3::ZERO).for_each(|n| *n = to.normal(*n));
        if to.mirrors() {
            self.faces.iter_mut().for_each(|face| face.swap(1, 2));
        }
    }

    /// Makes the outside of the inside.
    pub fn turn_inside_out(&mut self) {
        self.normals.iter_mut().for_each(|n| *n = -*n);
        self.faces.iter_mut().for_each(|face| face.swap(1, 2));
    }

    /// Adds to `out` what of the triangles is at points that are kept: large ones, and those at the border, in pieces.
    ///
    /// * `first_part`: what to add to the numbers of parts
    pub fn cut(&self, first_part: u32, keeps: impl Fn(Vec3) -> bool, out: &mut Tessellation) {
        /// Pieces are looked at that are this much smaller than the whole, and pieces of those at the border.
        const PIECES: f32 = 12.0;
        const AT_BORDER: u32 = 2;
        let coarse = Aabb::around(self.positions.iter().copied()).extent().length() / PIECES;
        for (face, part) in self.faces.iter().zip(&self.parts) {
            let corners = face.map(|i| (self.positions[i as usize], self.normals[i as usize]));
            let extent = Aabb::around(corners.map(|corner| corner.0)).extent().length();
            let least = (extent / coarse).max(1.0).log2().ceil() as u32;
            let mut kept = Vec::new();
            Cut { keeps: &keeps, least, most: least + AT_BORDER }.cut(corners, 0, &mut kept);
            for corners in kept {
                let face = corners.map(|(p, n)| out.vertex(p, n));
                out.face(first_part + part, face);
            }
        }
    }

    /// Adds the surface in a box where a function is zero, by tetrahedra: six in each cube of a grid [Doi and Koide 1991].
    ///
    /// * `cells`: cubes along the longest side
    /// * `f`: value, positive inside, and outward normal of any length
    pub fn level_set(&mut self, bounds: Aabb, cells: u32, f: impl Fn(DVec3) -> (f64, DVec3)) {
        if bounds.is_empty() || !bounds.is_finite() {
            return;
        }
        let (low, extent) = (bounds.min.as_dvec3(), bounds.extent().as_dvec3());
        let size = extent.max_element() / f64::from(cells.clamp(2, 256));
        let n = (extent / size).ceil().as_uvec3() + 1;
        let point = |[x, y, z]: [u32; 3]| low + size * DVec3::new(x.into(), y.into(), z.into());
        let index = |[x, y, z]: [u32; 3]| ((z * n.y + y) * n.x + x) as usize;
        let mut values = Vec::with_capacity((n.x * n.y * n.z) as usize);
        for z in 0..n.z {
            for y in 0..n.y {
                values.extend((0..n.x).map(|x| f(point([x, y, z])).0));
            }
        }
        // The tetrahedra around the diagonal of a cube, by the order in which its axes are gone along.
        const ORDERS: [[usize; 3]; 6] = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];
        let mut edges: HashMap<[usize; 2], u32> = HashMap::new();
        for z in 0..n.z - 1 {
            for y in 0..n.y - 1 {
                for x in 0..n.x - 1 {
                    for order in ORDERS {
                        let mut corner = [x, y, z];
                        let corners = [None, Some(order[0]), Some(order[1]), Some(order[2])].map(|axis| {
                            axis.into_iter().for_each(|axis: usize| corner[axis] += 1);
                            (index(corner), point(corner))
                        });
                        self.tetrahedron(corners, &values, &f, &mut edges);
                    }
                }
            }
        }
    }

    /// Adds what of a surface is in a tetrahedron: a triangle, two or none.
    fn tetrahedron(
        &mut self,
        corners: [(usize, DVec3); 4],
        values: &[f64],
        f: &impl Fn(DVec3) -> (f64, DVec3),
        edges: &mut HashMap<[usize; 2], u32>,
    ) {
        let (mut inside, mut outside) = (Vec::with_capacity(4), Vec::with_capacity(4));
        for corner in corners {
            if values[corner.0] > 0.0 { inside.push(corner) } else { outside.push(corner) }
        }
        let mut vertex = |(i, p): (usize, DVec3), (j, q): (usize, DVec3)| {
            *edges.entry([i.min(j), i.max(j)]).or_insert_with(|| {
                let at = p + values[i] / (values[i] - values[j]) * (q - p);
                let (value, n) = f(at);
                // One step of Newton's method, not farther than the edge is long.
                let step = value / n.length_squared() * n;
                let at = if step.length_squared() < (q - p).length_squared() { at + step } else { at };
                self.vertex(at.as_vec3(), f(at).1.normalize_or_zero().as_vec3())
            })
        };
        let faces = match (&*inside, &*outside) {
            ([a], [b, c, d]) | ([b, c, d], [a]) => vec![[vertex(*a, *b), vertex(*a, *c), vertex(*a, *d)]],
            ([a, b], [c, d]) => {
                let [ac, ad, bc, bd] = [vertex(*a, *c), vertex(*a, *d), vertex(*b, *c), vertex(*b, *d)];
                vec![[ac, ad, bd], [ac, bd, bc]]
            }
            _ => Vec::new(),
        };
        faces.into_iter().for_each(|face| self.turned(0, face));
    }

    /// Adds a triangle, wound as its normals say, unless it has shrunk to a line.
    pub fn turned(&mut self, part: u32, [a, b, c]: [u32; 3]) {
        let [p, q, r] = [a, b, c].map(|i| self.positions[i as usize]);
        if p == q || q == r || r == p {
            return;
        }
        let n: Vec3 = [a, b, c].map(|i| self.normals[i as usize]).iter().sum();
        let outward = (q - p).cross(r - p).dot(n) >= 0.0;
        self.face(part, if outward { [a, b, c] } else { [a, c, b] });
    }
}

/// Which pieces of a triangle are kept.
struct Cut<'a, F> {
    keeps: &'a F,
    /// How often it is divided in any case, and at most.
    least: u32,
    most: u32,
}

impl<F: Fn(Vec3) -> bool> Cut<'_, F> {
    /// Adds what is kept of a piece, position and normal of each corner; whether that is all of it.
    fn cut(&self, corners: [(Vec3, Vec3); 3], depth: u32, kept: &mut Vec<[(Vec3, Vec3); 3]>) -> bool {
        let [a, b, c] = corners;
        let middle = (a.0 + b.0 + c.0) / 3.0;
        if depth >= self.least {
            let keeps = (self.keeps)(middle);
            // At corners themselves other surfaces may begin.
            let uniform = || corners.iter().all(|(p, _)| (self.keeps)(p.lerp(middle, 0.02)) == keeps);
            if depth == self.most || uniform() {
                kept.extend(keeps.then_some(corners));
                return keeps;
            }
        }
        let half = |a: (Vec3, Vec3), b: (Vec3, Vec3)| (0.5 * (a.0 + b.0), (a.1 + b.1).normalize_or_zero());
        let (ab, bc, ca) = (half(a, b), half(b, c), half(c, a));
        let before = kept.len();
        let parts = [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]];
        let whole = parts.map(|part| self.cut(part, depth + 1, kept)).iter().all(|&whole| whole);
        if whole {
            kept.truncate(before);
            kept.push(corners);
        }
        whole
    }
}

/// The point of the unit sphere at longitude `x` and latitude `y`, both in [0, 1], `y` from the north pole.
fn unit(x: f64, y: f64) -> DVec3 {
    let z = fmath::cos64(PI * y);
    let r = (1.0 - z * z).max(0.0).sqrt();
    DVec3::new(r * fmath::cos64(TAU * x), r * fmath::sin64(TAU * x), z)
}

impl CurvedPatch {
    /// A point of the canonical surface with its normal, in world space.
    fn placed(&self, q: DVec3, n: DVec3) -> (DVec3, DVec3) {
        let n = (self.inverse.matrix3.transpose() * n).normalize_or_zero();
        (self.map.transform_point3(q), n)
    }
}
