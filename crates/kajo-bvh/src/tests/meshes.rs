//! Meshes and rays to test on, a function of their seeds.

use kajo_math::rng::{mix, unit};
use kajo_math::{Ray, Vec3};

/// Positions and triangles.
#[derive(Clone, Default)]
pub(crate) struct Mesh {
    pub(crate) positions: Vec<Vec3>,
    pub(crate) triangles: Vec<[u32; 3]>,
}

/// Uniform numbers, one after the other; of their own, so that counted work stays what it was when the hash of samples changes.
pub(crate) struct Random {
    key: u64,
    next: u64,
}

impl Random {
    pub(crate) fn new(seed: u64) -> Random {
        Random { key: mix(mix(mix(seed))), next: 0 }
    }

    pub(crate) fn unit(&mut self) -> f32 {
        self.next += 1;
        unit((mix(self.key ^ self.next) >> 32) as u32)
    }

    pub(crate) fn below(&mut self, n: usize) -> usize {
        ((self.unit() * n as f32) as usize).min(n - 1)
    }

    /// Uniform in the cube from -1 to 1.
    pub(crate) fn cube(&mut self) -> Vec3 {
        Vec3::new(self.unit(), self.unit(), self.unit()) * 2.0 - 1.0
    }
}

impl Mesh {
    pub(crate) fn push(&mut self, corners: [Vec3; 3]) {
        let first = self.positions.len() as u32;
        self.positions.extend(corners);
        self.triangles.push([first, first + 1, first + 2]);
    }

    pub(crate) fn corners(&self, triangle: usize) -> [Vec3; 3] {
        self.triangles[triangle].map(|i| self.positions[i as usize])
    }

    /// Every position `p` moved to `f(p)`.
    pub(crate) fn moved(mut self, f: impl Fn(Vec3) -> Vec3) -> Mesh {
        self.positions.iter_mut().for_each(|p| *p = f(*p));
        self
    }

    /// Scattered triangles; `size` is relative to the cube they fill.
    pub(crate) fn soup(n: usize, size: f32, seed: u64) -> Mesh {
        let (mut random, mut mesh) = (Random::new(seed), Mesh::default());
        for _ in 0..n {
            let p = random.cube();
            mesh.push([p, p + random.cube() * size, p + random.cube() * size]);
        }
        mesh
    }

    /// Long and thin triangles in all directions.
    pub(crate) fn slivers(n: usize, seed: u64) -> Mesh {
        let (mut random, mut mesh) = (Random::new(seed), Mesh::default());
        for _ in 0..n {
            let p = random.cube();
            let q = p + random.cube();
            mesh.push([p, q, p + (q - p) * random.unit() + random.cube() * 1e-4]);
        }
        mesh
    }

    /// A sheet over the unit square with `n` by `n` cells and heights up to `height`.
    pub(crate) fn grid(n: usize, height: f32, seed: u64) -> Mesh {
        let (mut random, mut mesh) = (Random::new(seed), Mesh::default());
        for y in 0..=n {
            for x in 0..=n {
                let h = random.unit() * height;
                mesh.positions.push(Vec3::new(x as f32 / n as f32, y as f32 / n as f32, h));
            }
        }
        let at = |x: usize, y: usize| (y * (n + 1) + x) as u32;
        for y in 0..n {
            for x in 0..n {
                mesh.triangles.push([at(x, y), at(x + 1, y), at(x + 1, y + 1)]);
                mesh.triangles.push([at(x, y), at(x + 1, y + 1), at(x, y + 1)]);
            }
        }
        mesh
    }

    /// A closed sphere of radius 1 with `20 * 4^level` triangles.
    pub(crate) fn sphere(level: usize) -> Mesh {
        let g = 0.5 * (1.0 + 5.0f32.sqrt());
        let mut positions: Vec<Vec3> = Vec::new();
        for (a, b) in [(1.0, g), (-1.0, g), (1.0, -g), (-1.0, -g)] {
            positions.extend([Vec3::new(a, b, 0.0), Vec3::new(0.0, a, b), Vec3::new(b, 0.0, a)]);
        }
        // The faces of the icosahedron are the triples of vertices at the least distance, 2.
        let near = |i: usize, j: usize| (positions[i].distance(positions[j]) - 2.0).abs() < 1e-3;
        let mut triangles = Vec::new();
        for i in 0..12 {
            for j in i + 1..12 {
                for k in j + 1..12 {
                    if near(i, j) && near(j, k) && near(k, i) {
                        triangles.push([i as u32, j as u32, k as u32]);
                    }
                }
            }
        }
        let mut mesh = Mesh { positions, triangles };
        for _ in 0..level {
            mesh = mesh.subdivided();
        }
        mesh.moved(Vec3::normalize)
    }

    fn subdivided(self) -> Mesh {
        let mut middles = std::collections::HashMap::new();
        let mut out = Mesh { positions: self.positions, triangles: Vec::new() };
        for [a, b, c] in self.triangles {
            let mut middle = |i: u32, j: u32| {
                *middles.entry((i.min(j), i.max(j))).or_insert_with(|| {
                    let p = (out.positions[i as usize] + out.positions[j as usize]).normalize();
                    out.positions.push(p);
                    out.positions.len() as u32 - 1
                })
            };
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            out.triangles.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        out
    }

    /// Every triangle `n` times.
    pub(crate) fn repeated(mut self, n: usize) -> Mesh {
        self.triangles = self.triangles.repeat(n);
        self
    }

    /// Rays of every kind at this mesh: scattered, along the axes through its vertices,
    /// aimed at vertices and edges, with all sorts of ranges.
    pub(crate) fn rays(&self, n: usize, seed: u64) -> Vec<Ray> {
        let mut random = Random::new(seed);
        let (lo, hi) = self
            .positions
            .iter()
            .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(lo, hi), p| (lo.min(*p), hi.max(*p)));
        let (middle, half) = if self.positions.is_empty() {
            (Vec3::ZERO, Vec3::ONE)
        } else {
            ((lo + hi) / 2.0, (hi - lo) / 2.0)
        };
        let half = half.max(Vec3::splat(half.max_element() * 0.1));
        (0..n)
            .map(|i| {
                let o = middle + random.cube() * half * 1.5;
                let target = self.target(i, &mut random).unwrap_or(middle + random.cube() * half);
                let (o, d) = match i % 8 {
                    0..=3 => (o, target - o),
                    4 | 5 => {
                        let axis = random.below(3);
                        let mut d = if i % 16 < 8 { Vec3::ZERO } else { Vec3::splat(-0.0) };
                        d[axis] = if random.unit() < 0.5 { 1.0 } else { -3.0 };
                        let mut from = target;
                        from[axis] = o[axis];
                        (from, d)
                    }
                    _ => (o, random.cube() * half),
                };
                let ray = Ray::new(o, d);
                match random.below(6) {
                    0 => ray.over(f32::NEG_INFINITY, f32::INFINITY),
                    1 => ray.over(random.unit() * 2.0 - 1.0, random.unit() * 3.0),
                    2 => ray.over(0.0, 1.0),
                    _ => ray,
                }
            })
            .collect()
    }

    /// A vertex, a point of an edge or a point inside of some triangle.
    fn target(&self, kind: usize, random: &mut Random) -> Option<Vec3> {
        if self.triangles.is_empty() {
            return None;
        }
        let [a, b, c] = self.corners(random.below(self.triangles.len()));
        let (s, t) = (random.unit(), random.unit());
        Some(match kind % 4 {
            0 => a,
            1 => a + (b - a) * s,
            2 => a + (b - a) * 0.5,
            _ => a + (b - a) * s + (c - a) * (t * (1.0 - s)),
        })
    }
}
