//! Subdivision surfaces against splines, spheres and their own limits.

use std::f64::consts::PI;

use kajo_bvh::BuildSettings;
use kajo_math::{Vec3, fmath};

use super::*;
use crate::shape::Mesh;

/// No edges are sharp but borders.
const SMOOTH: f64 = -2.0;

fn polygons(positions: Vec<Vec3>, faces: &[&[u32]]) -> Polygons {
    Polygons {
        positions,
        sizes: faces.iter().map(|face| face.len() as u32).collect(),
        corners: faces.concat(),
        ..Polygons::default()
    }
}

fn cube() -> Polygons {
    let corner = |i: u8| Vec3::new((i & 1).into(), (i >> 1 & 1).into(), (i >> 2).into()) * 2.0 - 1.0;
    let faces: [&[u32]; 6] =
        [&[0, 2, 3, 1], &[4, 5, 7, 6], &[0, 1, 5, 4], &[2, 6, 7, 3], &[0, 4, 6, 2], &[1, 3, 7, 5]];
    polygons((0..8).map(corner).collect(), &faces)
}

fn octahedron() -> Polygons {
    let positions = vec![Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z];
    let faces: [&[u32]; 8] =
        [&[0, 2, 4], &[2, 1, 4], &[1, 3, 4], &[3, 0, 4], &[2, 0, 5], &[1, 2, 5], &[3, 1, 5], &[0, 3, 5]];
    polygons(positions, &faces)
}

/// A square of `n` by `n` faces over [0, 1]², moved by `map`.
fn grid(n: u32, map: impl Fn(Vec2) -> Vec3, triangles: bool) -> Polygons {
    let at = |i: u32| Vec2::new((i % (n + 1)) as f32, (i / (n + 1)) as f32) / n as f32;
    let positions = (0..(n + 1) * (n + 1)).map(|i| map(at(i))).collect();
    let mut faces: Vec<Vec<u32>> = Vec::new();
    for j in 0..n {
        for i in 0..n {
            let a = j * (n + 1) + i;
            let [b, c, d] = [a + 1, a + n + 2, a + n + 1];
            if triangles {
                faces.extend([vec![a, b, c], vec![a, c, d]])
            } else {
                faces.push(vec![a, b, c, d])
            }
        }
    }
    polygons(positions, &faces.iter().map(Vec::as_slice).collect::<Vec<_>>())
}

/// Without some faces, so that the border turns inwards.
fn notched(mut grid: Polygons) -> Polygons {
    let left_out = if grid.sizes[0] == 4 { 1 } else { 3 };
    for _ in 0..left_out {
        let size = grid.sizes.pop().unwrap() as usize;
        grid.corners.truncate(grid.corners.len() - size);
    }
    grid
}

fn scheme_of(polygons: &Polygons) -> Scheme {
    if polygons.sizes.iter().all(|&n| n == 3) { Scheme::Loop } else { Scheme::CatmullClark }
}

fn surface(polygons: Polygons, crease_cos: f64, levels: u32) -> Subdivided {
    let scheme = scheme_of(&polygons);
    Subdivided::new(Cage::new(polygons, crease_cos), scheme, levels)
}

fn mesh(surface: Subdivided) -> Mesh {
    Mesh::new(surface.into_mesh(true), &BuildSettings::default()).unwrap()
}

fn volume(surface: &Subdivided) -> f64 {
    let cage = &*surface.cage;
    let place = |c: u32| surface.positions[cage.corners[c as usize] as usize];
    let triangles = triangles(cage, &surface.positions);
    triangles.iter().map(|t| place(t[0]).dot(place(t[1]).cross(place(t[2]))) / 6.0).sum()
}

/// Every twin of every level shares its edge the other way round, and no border comes up.
#[test]
fn steps_keep_surfaces_closed() {
    for start in [cube(), octahedron()] {
        let scheme = scheme_of(&start);
        let mut cage = Cage::new(start, SMOOTH);
        for level in 0..4 {
            for c in 0..cage.corners.len() {
                let twin = cage.twins[c] as usize;
                let ends = |c: usize| [cage.corners[c], cage.corners[cage.next(c)]];
                let [a, b] = ends(c);
                assert_eq!((cage.twins[twin] as usize, ends(twin)), (c, [b, a]), "{scheme:?} {level}");
                assert!(!cage.sharp[c]);
            }
            // Euler's formula for a ball.
            let edges = cage.corners.len() / 2;
            assert_eq!(cage.positions.len() + cage.face_count(), edges + 2, "{scheme:?} {level}");
            cage = cage.refined(scheme);
        }
    }
    for start in [cube(), octahedron()] {
        assert!(mesh(surface(start, SMOOTH, 3)).open_edge().is_none());
    }
}

/// Where a vertex is on the limit surface does not depend on how often the cage is subdivided before.
#[test]
fn the_limit_is_the_same_from_every_level() {
    let bumps = |p: Vec2| Vec3::new(p.x, p.y, 0.3 * (7.0 * p.x).sin() * (5.0 * p.y).cos());
    let starts = [cube(), octahedron(), grid(3, bumps, false), grid(3, bumps, true)];
    let bent = [notched(grid(3, bumps, false)), notched(grid(3, bumps, true))];
    for (i, start) in starts.into_iter().chain(bent).enumerate() {
        for crease_cos in [SMOOTH, 0.5] {
            let [few, many] = [1, 4].map(|levels| surface(start.clone(), crease_cos, levels));
            let sharp = refine::Around::new(&few.cage, &few.cage.positions).sharp;
            for (v, p) in few.positions.iter().enumerate() {
                let q = many.positions[v];
                // Where a sharp edge ends there is no such formula.
                if sharp[v] == 1 {
                    continue;
                }
                assert!(p.distance(q) < 1e-12, "mesh {i}, vertex {v}: {p} {q}");
            }
            // Normals of the coarser one are those of the finer one, by corner.
            for (c, &vertex) in few.cage.corners.iter().enumerate() {
                if few.cage.sharp[c] || few.cage.sharp[few.cage.before(c)] {
                    continue;
                }
                let same = many.cage.corners.iter().position(|&v| v == vertex).unwrap();
                let (a, b) = (few.normals.of(c), many.normals.of(same));
                assert!(a.distance(b) < 1e-9 || crease_cos == 0.5, "mesh {i}, vertex {vertex}: {a} {b}");
            }
        }
    }
}

/// Inside of a regular grid the surface of Catmull and Clark is the bicubic B-spline, and with a border the spline of
/// the border; Loop's is a box spline that reproduces quadratics but for a constant.
#[test]
fn regular_grids_are_splines() {
    // A cubic B-spline over control points i² has at the knot i the value i² + 1/3.
    let n = 8;
    let bowl = |p: Vec2| Vec3::new(p.x, p.y, p.x * p.x);
    let flat = surface(grid(n, bowl, false), SMOOTH, 1);
    let h = 1.0 / f64::from(n);
    for j in 0..=n {
        for i in 1..n {
            let p = flat.positions[(j * (n + 1) + i) as usize];
            let x = f64::from(i) * h;
            assert!((p.z - x * x - h * h / 3.0).abs() < 1e-7 && (p.x - x).abs() < 1e-7, "{i} {j}: {p}");
        }
    }
    for triangles in [false, true] {
        let tilted = |p: Vec2| Vec3::new(p.x, p.y, 0.25 * p.x - 0.5 * p.y);
        let plane = surface(grid(4, tilted, triangles), SMOOTH, 2);
        let n = DVec3::new(-0.25, 0.5, 1.0).normalize();
        assert!(plane.normals.values.iter().all(|m| m.distance(n) < 1e-6), "planes stay planes");
        assert!(plane.positions.iter().all(|p| (p.z - 0.25 * p.x + 0.5 * p.y).abs() < 1e-7));
    }
}

/// The normals are those of ever smaller faces around.
#[test]
fn normals_are_those_of_the_surface() {
    let bumps = |p: Vec2| Vec3::new(p.x, p.y, 0.3 * (7.0 * p.x).sin() * (5.0 * p.y).cos());
    for (i, start) in
        [cube(), octahedron(), grid(3, bumps, false), grid(3, bumps, true)].into_iter().enumerate()
    {
        let fine = surface(start, SMOOTH, 6);
        let mut worst: f64 = 0.0;
        for c in 0..fine.cage.corners.len() {
            let place = |c: usize| fine.positions[fine.cage.corners[c] as usize];
            let [p, a, b] = [c, fine.cage.next(c), fine.cage.before(c)].map(place);
            let facet = (a - p).cross(b - p).normalize_or_zero();
            worst = worst.max(facet.distance(fine.normals.of(c)));
        }
        assert!(worst < 0.12, "mesh {i}: {worst}");
    }
}

#[test]
fn sharp_edges_stay_sharp() {
    let all_sharp = surface(cube(), 0.5, 3);
    assert!((volume(&all_sharp) - 8.0).abs() < 1e-12);
    let normals = &all_sharp.normals;
    let is_axis = |n: &DVec3| (n.abs().max_element() - 1.0).abs() < 1e-12;
    assert!(normals.values.iter().all(is_axis), "flat faces");
    // A roof: its ridge is a straight line that only the fold of it keeps.
    let roof = |p: Vec2| Vec3::new(p.x, p.y, 0.5 - (p.x - 0.5).abs());
    let [smooth, sharp] = [SMOOTH, 0.5].map(|cos| surface(grid(4, roof, false), cos, 3));
    let ridge = |s: &Subdivided| s.positions[2 * 5 + 2].z;
    assert!(
        (ridge(&sharp) - 0.5).abs() < 1e-7 && ridge(&smooth) < 0.45,
        "{} {}",
        ridge(&sharp),
        ridge(&smooth)
    );
}

#[test]
fn texture_coordinates_keep_their_seams() {
    let mut start = cube();
    // Every face has the whole picture.
    let uvs = (0..24).map(|c| [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y][c % 4]).collect();
    start.uvs = Some(PrimvarChannel { values: uvs, corners: (0..24).collect() });
    start.materials = Some((0..6).filter_map(MaterialSlot::new).collect());
    let data = surface(start, SMOOTH, 2).into_mesh(true);
    let (uvs, slots) = (data.uvs.unwrap(), data.material_slots.unwrap());
    let mut areas = [0.0; 6];
    for (face, &slot) in uvs.faces.unwrap().iter().zip(&slots) {
        let [a, b, c] = face.map(|i| uvs.values[i as usize]);
        areas[slot.index()] += 0.5 * (b - a).perp_dot(c - a);
    }
    assert!(areas.iter().all(|area| (area - 1.0).abs() < 1e-6), "{areas:?}");
    assert_eq!(data.faces.len() as u64, triangle_count(Scheme::CatmullClark, [6, 24], 2));
}

/// A sphere by moving all vertices of a subdivided cube onto it.
fn sphere(levels: u32) -> Subdivided {
    let mut ball = surface(cube(), SMOOTH, levels);
    ball.positions.iter_mut().for_each(|p| *p = p.normalize());
    let cage = &*ball.cage;
    ball.normals = limit::Normals { values: ball.positions.clone(), corners: cage.corners.clone() };
    ball
}

/// `r = 1 + e P2(cos)`: its volume is `4 pi/3 (1 + 3 e²/5 + 2 e³/35)`.
#[test]
fn displaced_spheres_have_their_volume() {
    for (e, expected) in [(0.1, 4.214_162), (0.3, 4.421_448)] {
        let exact = 4.0 * PI / 3.0 * (1.0 + 0.6 * e * e + 2.0 / 35.0 * e * e * e);
        assert!((exact - expected).abs() < 1e-6);
        let volumes = [5, 6].map(|levels| {
            let mut ball = sphere(levels);
            ball.displace(|p, _| e * (1.5 * p.z * p.z - 0.5));
            volume(&ball)
        });
        // What planes cut off goes with the square of their size.
        let limit = (4.0 * volumes[1] - volumes[0]) / 3.0;
        assert!((limit / exact - 1.0).abs() < 1e-5, "{e}: {volumes:?} {limit} for {exact}");
        assert!((volumes[1] / exact - 1.0).abs() < 2e-3);
    }
    let mut ball = sphere(3);
    ball.displace(|p, _| 0.3 * (1.5 * p.z * p.z - 0.5));
    assert!(mesh(ball).open_edge().is_none());
}

/// Normals of the displaced sphere are off by the square of the size of faces.
#[test]
fn normals_of_displaced_surfaces_converge() {
    let e = 0.3;
    let worst = |levels: u32| {
        let mut ball = sphere(levels);
        ball.displace(|p, _| e * (1.5 * p.z * p.z - 0.5));
        let mut sum = 0.0;
        for (c, &v) in ball.cage.corners.iter().enumerate() {
            let p = ball.positions[v as usize];
            // The gradient of |p| - 1 - e P2(z/|p|).
            let (r, cos) = (p.length(), p.z / p.length());
            let slope = 3.0 * e * cos / r;
            let n = (p / r - slope * (DVec3::Z - cos * p / r)).normalize();
            sum += n.distance_squared(ball.normals.of(c));
        }
        (sum / ball.cage.corners.len() as f64).sqrt()
    };
    let errors = [3, 4, 5].map(worst);
    let rates = [errors[0] / errors[1], errors[1] / errors[2]];
    assert!(rates.iter().all(|rate| *rate > 3.3), "{errors:?} {rates:?}");
}

/// Where texture coordinates of a vertex differ, it moves by their mean, and nothing cracks.
#[test]
fn seams_do_not_crack() {
    let mut start = cube();
    let uvs = (0..24).map(|c| Vec2::new(c as f32, 0.0)).collect();
    start.uvs = Some(PrimvarChannel { values: uvs, corners: (0..24).collect() });
    let mut ball = surface(start, SMOOTH, 3);
    ball.displace(|_, uv| 0.01 * f64::from(uv.x));
    assert!(mesh(ball).open_edge().is_none());
}

#[test]
fn odd_meshes_are_no_trouble() {
    let none = surface(polygons(Vec::new(), &[]), SMOOTH, 3);
    assert!(none.positions().is_empty());
    // Three faces at an edge, a face the wrong way round, a bow tie, a repeated corner, and a vertex of no face.
    let p = |i: u32| Vec3::new((i % 3) as f32, (i / 3) as f32, (i * i % 5) as f32);
    let positions: Vec<Vec3> = (0..12).map(p).collect();
    for faces in [
        &[&[0, 1, 2][..], &[1, 0, 3], &[0, 1, 4]][..],
        &[&[0, 1, 2], &[0, 1, 3]],
        &[&[0, 1, 2], &[0, 3, 4]],
        &[&[0, 1, 1, 2, 3], &[5, 5, 5]],
        &[&[0, 1, 2, 3, 4, 5], &[0, 5, 6]],
        &[&[0, 1, 0, 2]],
    ] {
        for scheme in [Scheme::CatmullClark, Scheme::Loop] {
            if scheme == Scheme::Loop && faces.iter().any(|face| face.len() > 3) {
                continue;
            }
            let cage = Cage::new(polygons(positions.clone(), faces), SMOOTH);
            let mut odd = Subdivided::new(cage, scheme, 3);
            odd.displace(|_, _| 0.1);
            assert!(odd.positions.iter().all(|p| p.is_finite()));
            assert!(odd.normals.values.iter().all(|n| n.is_finite()));
            assert!(mesh(odd).triangle_count() > 0);
        }
    }
}

/// A cap of triangles around a vertex of any valence: its limit normal is the axis.
#[test]
fn any_valence_has_its_normal() {
    for n in 3..9u32 {
        let rim = |i: u32| {
            let (sin, cos) = fmath::sincos64(2.0 * PI * f64::from(i) / f64::from(n));
            Vec3::new(cos as f32, sin as f32, 0.0)
        };
        let positions: Vec<Vec3> = std::iter::once(0.4 * Vec3::Z).chain((0..n).map(rim)).collect();
        let faces: Vec<[u32; 3]> = (0..n).map(|i| [0, 1 + i, 1 + (i + 1) % n]).collect();
        let faces: Vec<&[u32]> = faces.iter().map(<[u32; 3]>::as_slice).collect();
        for scheme in [Scheme::CatmullClark, Scheme::Loop] {
            let cage = Cage::new(polygons(positions.clone(), &faces), SMOOTH);
            let cap = Subdivided::new(cage, scheme, 2);
            let corner = cap.cage.corners.iter().position(|&v| v == 0).unwrap();
            assert!(cap.normals.of(corner).distance(DVec3::Z) < 1e-6, "{scheme:?} {n}");
        }
    }
}
