//! Meshes by formula.
//!
//! * sphere: an icosahedron whose triangles are quartered eight times, displaced by products of sines
//! * grass: 400,000 blades of five triangles on a lawn of two, placed by a hash
//! * terrain: 2048 × 2048 heights, nine octaves of value noise

use std::collections::HashMap;
use std::f64::consts::TAU;

use kajo_bvh::bench::Mesh;
use kajo_math::fmath::{cos64, sin64};
use kajo_math::{DVec3, Vec3};

use crate::bench::pcg::{hash, uniform, unit};

/// Names of the meshes there are formulas for.
pub const NAMES: [&str; 3] = ["sphere", "grass", "terrain"];

/// How far secondary rays start from a surface, as a share of the mesh's diagonal.
const OFFSET: f64 = 1e-5;

/// The mesh of that name, if there is one.
pub fn generate(name: &str) -> Option<Mesh> {
    let triangles = match name {
        "sphere" => sphere(8),
        "grass" => grass(400_000),
        "terrain" => terrain(2048),
        _ => return None,
    };
    let [eye, target, light, [fov, ..]] = match name {
        "sphere" => [[0.6, 0.9, 2.6], [0.0, 0.0, 0.0], [3.0, 4.0, 3.0], [45.0; 3]],
        "grass" => [[0.0, 1.3, 11.0], [0.0, 0.1, 2.0], [6.0, 8.0, 4.0], [45.0; 3]],
        _ => [[-1.05, 0.60, -1.05], [0.1, -0.05, 0.1], [1.0, 1.6, -0.8], [48.0; 3]],
    };
    let positions: Vec<Vec3> = triangles.positions.iter().map(|p| p.as_vec3()).collect();
    let low = positions.iter().fold(Vec3::INFINITY, |low, &p| low.min(p)).as_dvec3();
    let high = positions.iter().fold(Vec3::NEG_INFINITY, |high, &p| high.max(p)).as_dvec3();
    Some(Mesh {
        name: name.to_owned(),
        positions,
        triangles: triangles.corners,
        eye: eye.into(),
        target: target.into(),
        up: Vec3::Y,
        fov_degrees: fov,
        light: light.into(),
        eps: (OFFSET * (high - low).length()) as f32,
    })
}

#[derive(Default)]
struct Triangles {
    positions: Vec<DVec3>,
    corners: Vec<[u32; 3]>,
}

fn sphere(level: u32) -> Triangles {
    let mut mesh = icosahedron();
    for _ in 0..level {
        mesh = quartered(&mesh);
    }
    for p in &mut mesh.positions {
        let sines = |a: [f64; 3], b: [f64; 3]| -> f64 { (0..3).map(|i| sin64(a[i] * p[i] + b[i])).product() };
        let r = 1.0
            + 0.05 * sines([11.0, 13.0, 17.0], [0.0; 3])
            + 0.01 * sines([61.0, 67.0, 71.0], [1.0, 2.0, 3.0]);
        *p *= r;
    }
    mesh
}

/// On the unit sphere.
fn icosahedron() -> Triangles {
    let t = (1.0 + 5f64.sqrt()) / 2.0;
    let mut positions = Vec::with_capacity(12);
    for turn in 0..3 {
        for sign in [t, -t] {
            for one in [-1.0, 1.0] {
                let p = [one, sign, 0.0];
                positions.push(DVec3::from_array([0, 1, 2].map(|i| p[(i + 3 - turn) % 3])).normalize());
            }
        }
    }
    let corners = vec![
        [0, 11, 5],
        [0, 5, 1],
        [0, 1, 7],
        [0, 7, 10],
        [0, 10, 11],
        [1, 5, 9],
        [5, 11, 4],
        [11, 10, 2],
        [10, 7, 6],
        [7, 1, 8],
        [3, 9, 4],
        [3, 4, 2],
        [3, 2, 6],
        [3, 6, 8],
        [3, 8, 9],
        [4, 9, 5],
        [2, 4, 11],
        [6, 2, 10],
        [8, 6, 7],
        [9, 8, 1],
    ];
    Triangles { positions, corners }
}

/// Every triangle cut in four at the middles of its edges, which move out to the unit sphere.
fn quartered(mesh: &Triangles) -> Triangles {
    let mut positions = mesh.positions.clone();
    let mut middles = HashMap::new();
    let mut middle = |a: u32, b: u32| {
        *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
            positions.push((mesh.positions[a as usize] + mesh.positions[b as usize]).normalize());
            positions.len() as u32 - 1
        })
    };
    let mut corners = Vec::with_capacity(4 * mesh.corners.len());
    for &[a, b, c] in &mesh.corners {
        let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
        corners.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
    }
    Triangles { positions, corners }
}

fn grass(blades: u32) -> Triangles {
    const BLADE: [[u32; 3]; 5] = [[0, 1, 2], [1, 3, 2], [2, 3, 4], [3, 5, 4], [4, 5, 6]];
    let mut mesh = Triangles::default();
    for i in 0..blades {
        let first = mesh.positions.len() as u32;
        add_blade(i, &mut mesh.positions);
        mesh.corners.extend(BLADE.map(|corners| corners.map(|c| first + c)));
    }
    let first = mesh.positions.len() as u32;
    for [x, z] in [[-10.0, -10.0], [10.0, -10.0], [-10.0, 10.0], [10.0, 10.0]] {
        mesh.positions.push(DVec3::new(x, 0.0, z));
    }
    mesh.corners.extend([[first, first + 2, first + 1], [first + 1, first + 2, first + 3]]);
    mesh
}

/// Three rows of two points and a tip, bent like a parabola.
fn add_blade(i: u32, positions: &mut Vec<DVec3>) {
    let u = |k| uniform(i, k);
    let foot = DVec3::new(20.0 * u(0) - 10.0, 0.0, 20.0 * u(1) - 10.0);
    let facing = TAU * u(2);
    let height = 0.25 + 0.35 * u(3);
    let half_width = 0.006 + 0.008 * u(4);
    let lean = 0.35 * height * (2.0 * u(5) - 1.0);
    let (sin, cos) = (sin64(facing), cos64(facing));
    for k in 0..4 {
        let s = f64::from(k) / 3.0;
        let middle = foot + DVec3::new(-sin * lean * s * s, height * s, cos * lean * s * s);
        let across = DVec3::new(cos, 0.0, sin) * half_width * (1.0 - s);
        match k {
            3 => positions.push(middle),
            _ => positions.extend([middle - across, middle + across]),
        }
    }
}

fn terrain(side: u32) -> Triangles {
    let mut mesh = Triangles::default();
    let place = |i: u32| -1.0 + 2.0 * f64::from(i) / f64::from(side - 1);
    for row in 0..side {
        for column in 0..side {
            let (x, z) = (place(column), place(row));
            mesh.positions.push(DVec3::new(x, height(x, z) - 0.25, z));
        }
    }
    for row in 0..side - 1 {
        for column in 0..side - 1 {
            let i = row * side + column;
            mesh.corners.extend([[i, i + side, i + 1], [i + 1, i + side, i + side + 1]]);
        }
    }
    mesh
}

fn height(x: f64, z: f64) -> f64 {
    let (mut height, mut amplitude, mut frequency) = (0.0, 0.25, 4.0);
    for octave in 0..9 {
        height += amplitude * value_noise((x + 1.0) * frequency, (z + 1.0) * frequency, octave);
        amplitude *= 0.5;
        frequency *= 2.0;
    }
    height
}

/// Hashed values at whole coordinates, which are not negative, blended smoothly between them.
fn value_noise(x: f64, y: f64, seed: u32) -> f64 {
    let (cell_x, cell_y) = (x.floor() as u32, y.floor() as u32);
    let (fx, fy) = (x - x.floor(), y - y.floor());
    let smooth = |f: f64| f * f * (3.0 - 2.0 * f);
    let value = |x: u32, y: u32| unit(hash(hash((x & 0xffff) * 65536 + (y & 0xffff)).wrapping_add(seed)));
    let row = |y| value(cell_x, y) * (1.0 - smooth(fx)) + value(cell_x + 1, y) * smooth(fx);
    row(cell_y) * (1.0 - smooth(fy)) + row(cell_y + 1) * smooth(fy)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Area of a closed or flat mesh, and that it names no vertex it does not have.
    fn area(mesh: &Triangles) -> f64 {
        let corner = |i: u32| mesh.positions[i as usize];
        mesh.corners
            .iter()
            .map(|&[a, b, c]| (corner(b) - corner(a)).cross(corner(c) - corner(a)).length() / 2.0)
            .sum()
    }

    #[test]
    fn the_sphere_is_round_and_closed() {
        let mut mesh = icosahedron();
        for _ in 0..4 {
            mesh = quartered(&mesh);
        }
        assert_eq!((mesh.corners.len(), mesh.positions.len()), (20 * 256, 10 * 256 + 2));
        // Inscribed, so a little less than the sphere.
        let share = area(&mesh) / (2.0 * TAU);
        assert!((0.99..1.0).contains(&share), "{share}");
        let outward = |&[a, b, c]: &[u32; 3]| {
            let [a, b, c] = [a, b, c].map(|i| mesh.positions[i as usize]);
            (b - a).cross(c - a).dot(a) > 0.0
        };
        assert!(mesh.corners.iter().all(outward), "all wind the same way");
    }

    #[test]
    fn grass_stands_on_its_lawn() {
        let mesh = grass(1000);
        assert_eq!(mesh.corners.len(), 5 * 1000 + 2);
        assert!(
            mesh.positions.iter().all(|p| (0.0..0.6).contains(&p.y) && p.x.abs() < 10.3 && p.z.abs() < 10.3)
        );
        assert!(area(&mesh) > 400.0);
    }

    #[test]
    fn terrain_has_bounded_heights_and_its_whole_area() {
        let mesh = terrain(33);
        assert_eq!(mesh.corners.len(), 2 * 32 * 32);
        assert!(mesh.positions.iter().all(|p| (-0.25..0.25).contains(&p.y)));
        assert!(area(&mesh) > 4.0);
    }

    #[test]
    fn other_names_have_no_formula() {
        assert!(generate("bunny").is_none());
    }
}
