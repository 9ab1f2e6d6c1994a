//! Height fields against closed forms and against the function that they are the graph of.

use kajo_math::rng::Stream;
use kajo_math::{fmath, warp};

use super::*;

/// Random heights in [0, `most`].
fn rough(columns: u32, rows: u32, most: f32) -> HeightGrid {
    let heights = (0..columns * rows).map(|i| most * Stream::new(83, [i, columns], 0).uniform(0)).collect();
    HeightGrid { columns, rows, heights }
}

fn field(grid: HeightGrid, base: Option<f64>) -> HeightField {
    HeightField::new(grid, DVec2::new(-1.0, -0.5), DVec2::new(2.0, 1.5), base, false).unwrap()
}

fn crossings(field: &HeightField, ray: &Ray) -> Vec<(f64, u32)> {
    let mut found = Vec::new();
    field.0.walk(ray, |t, part| {
        found.push((t, part));
        false
    });
    found
}

/// A ray through a point of the box from outside of it.
fn random_ray(i: u32) -> Ray {
    let s = Stream::new(89, [i, 0], 0);
    let u = |k| Vec2::new(s.uniform(k), s.uniform(k + 1));
    let through = Vec3::new(2.0 * s.uniform(0) - 1.0, 0.8 * s.uniform(1) - 0.1, 1.5 * s.uniform(2) - 0.5);
    let d = warp::uniform_sphere(u(3));
    // Terrain is mostly looked at from low above.
    let d = Vec3::new(d.x, d.y * s.uniform(5), d.z).normalize();
    Ray::new(through - 4.0 * d, d)
}

/// Each piece of a fine grid of many lines holds an odd number of crossings where the sign of the function changes.
#[test]
fn no_crossing_is_missed_and_none_is_made_up() {
    const STEPS: u32 = 4000;
    for (columns, rows) in [(2, 2), (3, 2), (2, 9), (8, 8), (13, 6)] {
        for base in [None, Some(-0.2), Some(0.2)] {
            let field = field(rough(columns, rows, 0.6), base);
            for i in 0..200 {
                let ray = random_ray(i);
                let found = crossings(&field, &ray);
                assert!(found.windows(2).all(|pair| pair[0].0 <= pair[1].0), "{found:?}");
                let line = Ray64::new(&ray);
                let step = |k: u32| 8.0 * f64::from(k) / f64::from(STEPS);
                let side = |t: f64| {
                    let p = line.at(t);
                    let over = (DVec2::new(p.x, p.z) - field.0.corner) / field.0.size;
                    let is_over = over.cmpge(DVec2::ZERO).all() && over.cmple(DVec2::ONE).all();
                    let is_below = p.y < field.0.height_and_slopes(p.x, p.z).0;
                    (is_over, is_below && base.is_none_or(|base| p.y > base))
                };
                for k in 0..STEPS {
                    let (a, b) = (side(step(k)), side(step(k + 1)));
                    // The surface alone ends where the rectangle does.
                    if base.is_none() && !(a.0 && b.0) {
                        continue;
                    }
                    let changes = (a.0 && a.1) != (b.0 && b.1);
                    let between = found.iter().filter(|(t, _)| step(k) <= *t && *t < step(k + 1)).count();
                    assert_eq!(
                        between % 2 == 1,
                        changes,
                        "{columns} {base:?}: ray {i} at {} {found:?}",
                        step(k)
                    );
                }
            }
        }
    }
}

/// Rays through borders and corners of cells, along them, and from ten thousand units away: of a solid one leaves as often as
/// one enters, inside and outside by turns, and crossings are on the surface.
#[test]
fn rays_along_the_grid_leave_as_often_as_they_enter() {
    let (columns, rows) = (9, 7);
    let field = field(rough(columns, rows, 0.6), Some(-0.1));
    let mut hits = 0;
    for i in 0..60_000 {
        let s = Stream::new(97, [i, 0], 0);
        let corner = |k: u32| {
            let pick = |k: u32, n: u32| ((s.uniform(k) * n as f32) as u32).min(n - 1);
            let (x, z) = (pick(k, columns), pick(k + 1, rows));
            let cell = field.0.cell_size;
            let at = field.0.corner + DVec2::new(x.into(), z.into()) * cell;
            (Vec3::new(at.x as f32, field.0.grid.at(x, z), at.y as f32), [x, z])
        };
        let ((p, [_, z]), (q, [_, other])) = (corner(0), corner(2));
        let d = match i % 4 {
            // Through two corners, from near and far.
            0 | 1 => q - p,
            // Within a plane between cells.
            2 => Vec3::new(s.uniform(4) - 0.5, 0.3 * (s.uniform(5) - 0.5), 0.0),
            // Straight down at a corner, or on a border.
            _ if z == other => Vec3::NEG_Y,
            _ => warp::uniform_sphere(Vec2::new(s.uniform(4), s.uniform(5))),
        };
        let Some(d) = d.try_normalize() else { continue };
        let ray = Ray::new(p - if i % 4 == 1 { 1e4 } else { 3.0 } * d, d);
        let found = crossings(&field, &ray);
        assert!(found.len().is_multiple_of(2), "ray {i}: {found:?}");
        hits += usize::from(!found.is_empty());
        let line = Ray64::new(&ray);
        for &(t, part) in &found {
            let p = line.at(t);
            let off = p.y - field.0.height_and_slopes(p.x, p.z).0;
            assert!(part != SURFACE || off.abs() < 1e-11, "ray {i} is {off} off");
        }
    }
    assert!(hits > 20_000, "{hits}");
}

/// The volume of a bilinear patch is its area times the mean of its corners.
#[test]
fn volumes_are_those_of_the_cells() {
    let grid = rough(7, 5, 0.6);
    let [columns, rows] = grid.cells();
    let cells = (0..rows).flat_map(|j| (0..columns).map(move |i| [i, j]));
    let mean = |cell| grid.corners(cell).map(f64::from).iter().sum::<f64>() / 4.0;
    let expected = cells.map(mean).sum::<f64>() / f64::from(columns * rows) * 3.0 + 0.2 * 3.0;
    let field = field(grid.clone(), Some(-0.2));
    // Lines in three directions, as many as give five digits of a function with edges.
    for axis in 0..3 {
        let bounds = field.bounds();
        let (n, extent) = (600, bounds.extent());
        let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
        let mut sum = 0.0;
        for k in 0..n * n {
            let mut o = bounds.min;
            o[axis] -= 1.0;
            o[a] += extent[a] * ((k % n) as f32 + 0.5) / n as f32;
            o[b] += extent[b] * ((k / n) as f32 + 0.5) / n as f32;
            let ray = Ray::new(o, Vec3::AXES[axis]);
            sum += crossings(&field, &ray).chunks(2).map(|pair| pair[1].0 - pair[0].0).sum::<f64>();
        }
        let volume = sum * f64::from(extent[a]) * f64::from(extent[b]) / f64::from(n * n);
        assert!((volume / expected - 1.0).abs() < 5e-4, "{volume} for {expected} along {axis}");
    }
}

/// A ray meets a paraboloid `y = x z`, which is one bilinear patch, where its quadratic says.
#[test]
fn crossings_are_where_the_quadratic_has_them() {
    let grid = HeightGrid { columns: 2, rows: 2, heights: vec![1.0, -1.0, -1.0, 1.0] };
    let field = HeightField::new(grid, DVec2::splat(-1.0), DVec2::splat(2.0), None, false).unwrap();
    for far in [0.0, 1e4] {
        // y = 0.1 against x z = (0.5 t)(0.7 - 0.25 t): 0.125 t^2 - 0.35 t + 0.1 = 0.
        let d = Vec3::new(0.5, 0.0, -0.25);
        let (o, t0) = (Vec3::new(0.0, 0.1, 0.7) - far * d, f64::from(far));
        let found = crossings(&field, &Ray::new(o, d));
        let y = f64::from(0.1f32);
        let z = f64::from(o.z) - 0.25 * t0;
        let x = f64::from(o.x) + 0.5 * t0;
        // (x + 0.5 s)(z - 0.25 s) = y with s = t - t0.
        let (a, h, c) = (0.125, 0.5 * (0.25 * x - 0.5 * z), y - x * z);
        let (first, last) = kajo_math::roots::quadratic(a, h, c).unwrap();
        let expected: Vec<f64> = [first, last].into_iter().filter(|s| (x + 0.5 * s).abs() <= 1.0).collect();
        assert_eq!(found.len(), expected.len(), "{found:?} {expected:?}");
        for ((t, _), s) in found.iter().zip(&expected) {
            assert!((t - t0 - s).abs() < 1e-9, "{t} for {s}");
        }
    }
}

/// Normals for shading are continuous, and those of a plane are its own, also at the border.
#[test]
fn smooth_normals_are_continuous() {
    let build =
        |grid: HeightGrid| HeightField::new(grid, DVec2::ZERO, DVec2::splat(4.0), None, true).unwrap();
    let down = |x: f32, z: f32| Ray::new(Vec3::new(x, 9.0, z), Vec3::NEG_Y);
    let normal = |field: &HeightField, x: f32, z: f32| {
        let ray = down(x, z);
        field.surface_at(&ray, &field.hit(&ray).unwrap())
    };
    let heights = (0..25).map(|i| 0.5 * (i % 5) as f32 - 0.25 * (i / 5) as f32).collect();
    let plane = build(HeightGrid { columns: 5, rows: 5, heights });
    let expected = Vec3::new(-0.5, 1.0, 0.25).normalize();
    for (x, z) in [(0.0, 0.0), (1.3, 2.7), (4.0, 3.99)] {
        let at = normal(&plane, x, z);
        assert!(at.n.distance(expected) < 1e-6 && at.ng.distance(expected) < 1e-6, "{} {}", at.n, at.ng);
    }
    let rough = build(rough(5, 5, 1.0));
    for k in 0..200 {
        let z = 0.02 * k as f32;
        let [before, after] = [1.9999, 2.0001].map(|x| normal(&rough, x, z));
        assert!(before.n.distance(after.n) < 2e-3, "{} and {} at {z}", before.n, after.n);
    }
}

/// A cone of terrain that a long slope of cells makes is met where it is, and only few of its blocks are looked into.
#[test]
fn large_grids_are_exact() {
    let n = 1025u32;
    let half = f64::from(n / 2);
    let height = |i: u32, j: u32| {
        let (x, z) = (f64::from(i) / half - 1.0, f64::from(j) / half - 1.0);
        (fmath::cos64(3.0 * x) * fmath::cos64(2.0 * z)) as f32
    };
    let heights = (0..n).flat_map(|j| (0..n).map(move |i| height(i, j))).collect();
    let grid = HeightGrid { columns: n, rows: n, heights };
    let field = HeightField::new(grid, DVec2::splat(-1.0), DVec2::splat(2.0), Some(-2.0), false).unwrap();
    assert!(field.heap_bytes() < 7 * (n * n) as usize);
    for i in 0..2000 {
        let ray = random_ray(i);
        let found = crossings(&field, &ray);
        assert!(found.len().is_multiple_of(2));
        for (t, part) in found {
            let p = Ray64::new(&ray).at(t);
            let off = p.y - fmath::cos64(3.0 * p.x) * fmath::cos64(2.0 * p.z);
            assert!(part != SURFACE || off.abs() < 1e-5, "{off}");
        }
    }
}

/// Areas of the patches that light is drawn from, counted by lines: those of a box, and of a plane that leans.
#[test]
fn areas_are_those_of_the_faces() {
    let areas = |field: &HeightField| {
        let mut areas = Vec::new();
        field.patches(|_, patch| areas.push(patch.area()));
        areas
    };
    let heights = vec![0.5; 12];
    let flat = field(HeightGrid { columns: 4, rows: 3, heights }, Some(-0.5));
    let found = areas(&flat);
    assert_eq!(found.len(), 6);
    for (found, expected) in found.iter().zip([3.0, 1.5, 1.5, 2.0, 2.0, 3.0]) {
        // Of 4096 lines through the sphere so many meet the face, give or take three times the root of their number.
        let radius2 = 0.25 * (2.0f64 * 2.0 + 1.5 * 1.5 + 1.0);
        let lines = 4096.0 * expected / (std::f64::consts::TAU * radius2);
        assert!((found / expected - 1.0).abs() < 3.0 / lines.sqrt(), "{found} for {expected}");
    }
    let leaning = field(HeightGrid { columns: 2, rows: 2, heights: vec![0.0, 2.0, 0.0, 2.0] }, None);
    let found = areas(&leaning);
    assert!(found.len() == 1 && (found[0] / (3.0 * 2f64.sqrt()) - 1.0).abs() < 0.02, "{found:?}");
}

#[test]
fn numbers_that_make_no_terrain_are_refused() {
    let build = |columns: u32, rows: u32, heights: Vec<f32>, size: f64, base: Option<f64>| {
        let grid = HeightGrid { columns, rows, heights };
        HeightField::new(grid, DVec2::ZERO, DVec2::splat(size), base, false).err()
    };
    let small = |columns, rows| Some(HeightFieldError::TooSmall { columns, rows });
    assert_eq!(build(1, 1, vec![0.0], 1.0, None), small(1, 1));
    assert_eq!(build(0, 0, vec![], 1.0, None), small(0, 0));
    assert_eq!(build(2, 3, vec![0.0; 5], 1.0, None), small(2, 3));
    let not_finite = Some(HeightFieldError::NotFinite { column: 1, row: 1 });
    assert_eq!(build(2, 2, vec![0.0, 0.0, 0.0, f32::NAN], 1.0, None), not_finite);
    assert_eq!(build(2, 2, vec![0.0; 4], 0.0, None), Some(HeightFieldError::NoArea));
    assert_eq!(build(2, 2, vec![0.0; 4], f64::NAN, None), Some(HeightFieldError::NoArea));
    assert_eq!(build(2, 2, vec![0.0; 4], 1.0, Some(0.0)), Some(HeightFieldError::BelowBase));
    assert_eq!(build(2, 2, vec![0.0; 4], 1.0, Some(-1.0)), None);
}

/// A flat field is met once from either side, a solid one twice.
#[test]
fn flat_terrain_is_a_plane_or_a_box() {
    for (base, count) in [(None, 1), (Some(-1.0), 2)] {
        for height in [0.0, 0.1, 1e6] {
            let heights = vec![height; 12];
            let field = field(
                HeightGrid { columns: 4, rows: 3, heights },
                base.map(|base: f64| base + f64::from(height)),
            );
            for d in [Vec3::Y, Vec3::NEG_Y, Vec3::new(0.2, -1.0, 0.1)] {
                let through = Vec3::new(0.25, height, 0.1);
                let far = 3.0 + 4.0 * height;
                let found = crossings(&field, &Ray::new(through - far * d, d));
                assert_eq!(found.len(), count, "{height} {base:?} {d}: {found:?}");
            }
        }
    }
}
