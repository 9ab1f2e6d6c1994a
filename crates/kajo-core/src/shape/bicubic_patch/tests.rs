//! Bicubic patches against known points, fine tessellations and closed forms.

use kajo_math::{rng::Stream, warp};

use super::*;

fn point(seed: u32, i: u32) -> Vec3 {
    let s = Stream::new(127, [seed, i], 0);
    Vec3::new(s.uniform(0), s.uniform(1), s.uniform(2)) * 2.0 - 1.0
}

/// A sheet with bends, or with folds where `bent` is large.
fn sheet(seed: u32, bent: f32) -> BicubicPatch {
    let at = |i: u32, j: u32| {
        Vec3::new(i as f32 / 1.5 - 1.0, j as f32 / 1.5 - 1.0, 0.0) + bent * point(seed, 4 * j + i)
    };
    BicubicPatch::new([0, 1, 2, 3].map(|j| [0, 1, 2, 3].map(|i| at(i, j)))).unwrap()
}

/// A line through a point of the patch.
fn line_through(patch: &BicubicPatch, uv: DVec2, seed: u32, far: f32) -> Ray {
    let s = Stream::new(131, [seed, 0], 0);
    let d = warp::uniform_sphere(Vec2::new(s.uniform(0), s.uniform(1)));
    Ray::new(patch.derivatives(uv).p.as_vec3() - far * d, d)
}

/// Where a ray's line crosses a patch.
fn crossing_uvs(patch: &BicubicPatch, ray: &Ray) -> Vec<DVec2> {
    let mut scratch = Scratch::default();
    patch.find_crossings(ray, &mut scratch);
    scratch.crossings
}

/// Lines through known points find them, also from far away, and all that is found is on the line.
#[test]
fn points_of_the_patch_are_met() {
    let mut several = 0;
    for seed in 0..3000 {
        let patch = sheet(seed, [0.1, 0.6, 1.5][seed as usize % 3]);
        let s = Stream::new(137, [seed, 0], 0);
        let uv = DVec2::new(s.uniform(0).into(), s.uniform(1).into()) * 0.96 + 0.02;
        for (far, grazing) in [(3.0, 0.02), (1000.0, 0.2)] {
            let ray = line_through(&patch, uv, seed, far);
            // What rounding makes of the origin may pass beside a fold.
            if patch.normal(uv).dot(ray.d.as_dvec3()).abs() < grazing {
                continue;
            }
            let found = crossing_uvs(&patch, &ray);
            several += u32::from(found.len() > 1);
            let near = 1e-5 * f64::from(far);
            assert!(found.iter().any(|place| place.distance(uv) < near), "{seed}: {found:?} without {uv}");
            let line = Ray64::new(&ray);
            for place in found {
                let off = (patch.derivatives(place).p - line.o).cross(line.d).length();
                assert!(off < 1e-11 * f64::from(far), "{seed}: {off}");
            }
        }
    }
    assert!(several > 500, "{several}");
}

/// The number of crossings is that of a fine tessellation, but for lines within its sagitta of a fold or a border.
#[test]
fn no_crossing_is_missed_and_none_is_made_up() {
    const N: u32 = 160;
    let (mut agreed, mut hits) = (0, 0);
    for seed in 0..6 {
        let patch = sheet(seed, 1.0);
        let grid: Vec<DVec3> = (0..=N)
            .flat_map(|j| (0..=N).map(move |i| DVec2::new(i.into(), j.into()) / f64::from(N)))
            .map(|uv| patch.derivatives(uv).p)
            .collect();
        for i in 0..400 {
            let s = Stream::new(139, [i, seed], 0);
            let uv = DVec2::new(s.uniform(0).into(), s.uniform(1).into()) * 1.4 - 0.2;
            let ray = line_through(&patch, uv, i, 4.0);
            let line = Ray64::new(&ray);
            let (x, y) = basis64(line.d);
            let seen: Vec<DVec2> =
                grid.iter().map(|&p| DVec2::new((p - line.o).dot(x), (p - line.o).dot(y))).collect();
            let crosses = |a: DVec2, b: DVec2, c: DVec2| {
                let turns = [a.perp_dot(b), b.perp_dot(c), c.perp_dot(a)];
                u32::from(turns.iter().all(|&t| t > 0.0) || turns.iter().all(|&t| t < 0.0))
            };
            let cell = |i: u32, j: u32| {
                let at = |i: u32, j: u32| seen[(j * (N + 1) + i) as usize];
                crosses(at(i, j), at(i + 1, j), at(i + 1, j + 1))
                    + crosses(at(i, j), at(i + 1, j + 1), at(i, j + 1))
            };
            let expected: u32 =
                (0..N).flat_map(|j| (0..N).map(move |i| (i, j))).map(|(i, j)| cell(i, j)).sum();
            let found = crossing_uvs(&patch, &ray);
            hits += u32::from(!found.is_empty());
            // Near folds and borders both may be right.
            let is_clear = found.iter().all(|&place| {
                let inner = (place - 0.5).abs().max_element() < 0.49;
                inner && patch.normal(place).dot(line.d).abs() > 0.05
            });
            if found.len() == expected as usize {
                agreed += 1;
            } else {
                let differ = found.len().abs_diff(expected as usize);
                assert!(!is_clear || differ.is_multiple_of(2), "{seed}: ray {i}: {found:?} and {expected}");
            }
        }
    }
    assert!(agreed > 2370 && hits > 1200, "{agreed} of 2400, {hits} hit");
}

/// Patches that share an edge let no ray through it.
#[test]
fn patches_that_share_an_edge_leave_no_gap() {
    for seed in 0..40 {
        let point = |i: u32, j: u32| {
            Vec3::new(i as f32 / 1.5 - 2.0, j as f32 / 1.5 - 1.0, 0.0) + 0.2 * point(seed, 8 * j + i)
        };
        let patch = |first: u32| {
            BicubicPatch::new([0, 1, 2, 3].map(|j| [0, 1, 2, 3].map(|i| point(first + i, j)))).unwrap()
        };
        let (left, right) = (patch(0), patch(3));
        for i in 0..300 {
            let s = Stream::new(149, [i, seed], 0);
            let target = left.derivatives(DVec2::new(1.0, s.uniform(0).into())).p.as_vec3();
            let from = Vec3::new(s.uniform(1) - 0.5, s.uniform(2) - 0.5, 5.0);
            let ray = Ray::new(from, target - from);
            assert!(left.hit(&ray).is_some() || right.hit(&ray).is_some(), "{seed}: ray {i} slips through");
        }
    }
}

/// An edge that is one point: normals go to that of the tip, and rays at it meet it.
#[test]
fn edges_may_be_points() {
    // A dome whose last row is its top: at all longitudes the tangents along v end in the plane there.
    let row = |r: f32, y: f32| {
        let k = 0.552;
        [Vec3::new(r, y, 0.0), Vec3::new(r, y, k * r), Vec3::new(k * r, y, r), Vec3::new(0.0, y, r)]
    };
    let dome = BicubicPatch::new([row(1.0, 0.0), row(1.0, 0.552), row(0.552, 1.0), row(0.0, 1.0)]).unwrap();
    for u in [0.0, 0.3, 0.5, 1.0] {
        let n = dome.normal(DVec2::new(u, 1.0));
        assert!(n.y.abs() > 1.0 - 1e-9, "{n} at {u}");
    }
    let down = |x: f32, z: f32| Ray::new(Vec3::new(x, 3.0, z), Vec3::NEG_Y);
    for (x, z) in [(1e-7, 1e-7), (1e-4, 2e-4), (0.1, 0.2), (0.5, 0.5)] {
        let hit = dome.hit(&down(x, z)).unwrap_or_else(|| panic!("nothing at {x} {z}"));
        let y = dome.surface_at(&down(x, z), &hit).p;
        assert!((y.length() - 1.0).abs() < 2e-3, "{y}");
        assert_eq!(crossing_uvs(&dome, &down(x, z)).len(), 1, "{x} {z}");
    }
    // The point itself belongs to all longitudes, and is found.
    assert!(dome.hit(&down(0.0, 0.0)).is_some());
}

/// Points of the patch have the coordinates they were made of, and the area is counted.
#[test]
fn points_know_their_coordinates() {
    for seed in 0..300 {
        let (patch, s) = (sheet(seed, 0.15), Stream::new(163, [seed, 0], 0));
        let uv = DVec2::new(s.uniform(0).into(), s.uniform(1).into());
        let hit = patch.hit_at(0, patch.derivatives(uv).p.as_vec3());
        assert!(DVec2::new(hit.u.into(), hit.v.into()).distance(uv) < 1e-4, "{seed}: {hit:?} for {uv}");
    }
    sheet(0, 0.0).patches(|_, patch| assert!((patch.area() / 4.0 - 1.0).abs() < 0.02, "{}", patch.area()));
}

#[test]
fn control_points_on_a_line_make_no_patch() {
    assert!(BicubicPatch::new([[Vec3::ONE; 4]; 4]).is_none());
    let on_line =
        [0.0, 1.0, 5.0, 2.0].map(|x| [0.0, 0.5, 1.0, 7.0].map(|y| Vec3::new(x + y, 2.0 * (x + y), 1.0)));
    assert!(BicubicPatch::new(on_line).is_none());
}

/// A flat patch seen on its edge is met everywhere or nowhere; that is decided in bounded time.
#[test]
fn rays_in_the_plane_of_a_flat_patch_end() {
    let flat = sheet(0, 0.0);
    for i in 0..50 {
        let ray = Ray::new(Vec3::new(-3.0, 0.02 * i as f32, 0.0), Vec3::new(1.0, 0.01 * i as f32, 0.0));
        flat.crossings(&ray, |hit| assert!(hit.t.is_finite()));
    }
}
