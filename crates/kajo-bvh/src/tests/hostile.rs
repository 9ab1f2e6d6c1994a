//! Input that no one should send: never a panic, and the good part still works.

use kajo_math::{Aabb, Ray, Vec3};

use super::meshes::Mesh;
use crate::build::MAX_LEVELS;
use crate::{BuildError, BuildSettings, Bvh, Quality, TriangleBvh};

fn build(mesh: &Mesh) -> TriangleBvh {
    TriangleBvh::build(&mesh.positions, &mesh.triangles, &BuildSettings::default()).unwrap()
}

fn build_high(mesh: &Mesh) -> TriangleBvh {
    let settings = BuildSettings { quality: Quality::High };
    TriangleBvh::build(&mesh.positions, &mesh.triangles, &settings).unwrap()
}

#[test]
fn triangles_without_area_or_number_are_dropped_and_counted() {
    let mut mesh = Mesh::soup(100, 0.3, 1);
    let (nan, inf) = (Vec3::new(0.0, f32::NAN, 0.0), Vec3::new(f32::INFINITY, 0.0, 0.0));
    mesh.push([nan, Vec3::X, Vec3::Y]);
    mesh.push([Vec3::X, inf, Vec3::Y]);
    mesh.push([Vec3::X, Vec3::Y, -inf]);
    mesh.push([Vec3::X, Vec3::X, Vec3::Y]);
    mesh.push([Vec3::ZERO, Vec3::ONE, Vec3::splat(0.5)]);
    mesh.push([nan, nan, nan]);
    let tree = build(&mesh);
    assert_eq!(tree.stats().dropped, 6);
    assert!(tree.bounds().is_finite());
    let mut tiny = Mesh::default();
    tiny.push([Vec3::ZERO, Vec3::X * 1e-30, Vec3::Y * 1e-30]);
    assert_eq!(build(&tiny).stats().dropped, 0, "small is not degenerate");
}

#[test]
fn cutting_is_bounded_whatever_the_triangles() {
    // Long triangles through one point, all boxes alike, at all sizes; the same ones over and over;
    // one that is longer than all others by far.
    let star = Mesh::slivers(400, 6).moved(|p| p * p.length_squared().powi(9));
    let mut spear = Mesh::soup(3000, 0.01, 7);
    spear.push([Vec3::splat(-1e30), Vec3::splat(1e30), Vec3::new(1e30, 1e30, -1e30)]);
    let stack = Mesh::soup(100, 0.3, 8).repeated(60);
    for mut mesh in [star, spear, stack, Mesh::soup(200, 2.0, 9).repeated(40)] {
        mesh.push([Vec3::X, Vec3::X, Vec3::Y]);
        mesh.push([Vec3::X, Vec3::splat(f32::NAN), Vec3::Y]);
        let (tree, n) = (build_high(&mesh), mesh.triangles.len());
        let references = tree.groups.iter().map(|g| {
            let mut ids = g.triangles.to_vec();
            ids.dedup();
            ids.len()
        });
        let references: usize = references.sum();
        assert!(tree.stats().dropped == 2 && references <= n + n * 3 / 10, "{references} of {n}");
        assert!(tree.stats().depth <= MAX_LEVELS);
        // What one triangle takes in a group of its own, with a node for every two leaves, is the most.
        assert!(tree.stats().bytes <= references * (160 + 256), "{:?}", tree.stats());
        assert_eq!(tree.bounds(), build(&mesh).bounds());
    }
}

#[test]
fn nothing_is_built_from_nothing() {
    let tree = build(&Mesh::default());
    let ray = Ray::new(Vec3::ZERO, Vec3::X);
    assert!(tree.closest(&ray).is_none() && !tree.any(&ray) && tree.bounds().is_empty());
    let boxes = Bvh::build(&[Aabb::EMPTY, Aabb::EVERYWHERE], &BuildSettings::default());
    assert!(boxes.stats().dropped == 2 && !boxes.any(&ray, |_| true) && boxes.bounds().is_empty());
}

#[test]
fn an_index_out_of_range_is_an_error() {
    let mut mesh = Mesh::soup(10, 0.3, 1);
    mesh.triangles[7][1] = 30;
    let error = TriangleBvh::build(&mesh.positions, &mesh.triangles, &BuildSettings::default()).unwrap_err();
    assert_eq!(error, BuildError::IndexOutOfRange { triangle: 7, index: 30, vertices: 30 });
    assert!(error.to_string().contains("triangle 7"));
}

#[test]
fn sizes_at_the_end_of_the_number_range() {
    for scale in [1e-38, 1e-30, 1e18, 1e30, f32::MAX] {
        let mesh = Mesh::soup(500, 0.3, 2).moved(|p| p * scale);
        let trees = [build(&mesh), build_high(&mesh)];
        for (ray, tree) in mesh.rays(200, 4).iter().flat_map(|ray| trees.each_ref().map(|tree| (*ray, tree)))
        {
            let (hit, any) = (tree.closest(&ray), tree.any(&ray));
            assert!(hit.is_none_or(|h| !h.t.is_nan()));
            assert_eq!(hit.is_some(), any);
            tree.all(&ray, |_| {});
            assert!(
                tree.closest8(&[ray; 8]).iter().all(|h| h.map(|h| h.triangle) == hit.map(|h| h.triangle))
            );
        }
    }
}

#[test]
fn rays_that_are_no_rays_hit_nothing() {
    let tree = build(&Mesh::sphere(2));
    let (nan, inf) = (f32::NAN, f32::INFINITY);
    let bad = [
        Ray::new(Vec3::splat(nan), Vec3::X),
        Ray::new(Vec3::ZERO, Vec3::splat(nan)),
        Ray::new(Vec3::ZERO, Vec3::new(1.0, nan, 0.0)),
        Ray::new(Vec3::ZERO, Vec3::ZERO),
        Ray::new(Vec3::ZERO, Vec3::splat(-0.0)),
        Ray::new(Vec3::splat(inf), Vec3::X),
        Ray::new(Vec3::ZERO, Vec3::splat(inf)),
        Ray::new(Vec3::ZERO, Vec3::X).over(nan, inf),
        Ray::new(Vec3::ZERO, Vec3::X).over(0.0, nan),
        Ray::new(Vec3::ZERO, Vec3::X).over(2.0, 1.0),
        Ray::new(Vec3::ZERO, Vec3::X).over(inf, inf),
    ];
    for ray in bad {
        let mut all = 0;
        tree.all(&ray, |_| all += 1);
        assert!(tree.closest(&ray).is_none() && !tree.any(&ray) && all == 0, "{ray:?}");
        let mut packet = [Ray::new(Vec3::ZERO, Vec3::X); 8];
        packet[3] = ray;
        let hits = tree.closest8(&packet);
        assert!((0..8).all(|i| hits[i].is_some() == (i != 3)), "{ray:?}");
    }
    assert!(tree.any(&Ray::new(Vec3::ZERO, Vec3::X)));
}

#[test]
fn depth_is_bounded_where_every_split_takes_one_primitive() {
    // Each box is half as far from the origin as the one before: the heuristic peels them off.
    let boxes: Vec<Aabb> = (0..250i32)
        .flat_map(|i| {
            let p = Vec3::splat(2f32.powi(i / 2 - 100));
            [Aabb::around([p, p * 1.1]), Aabb::around([-p, -p * 1.1])]
        })
        .collect();
    let tree = Bvh::build(&boxes, &BuildSettings::default());
    assert!(tree.stats().depth <= MAX_LEVELS);
    let mut seen = vec![0; boxes.len()];
    tree.each(&Ray::new(Vec3::splat(-1e-35), Vec3::ONE).over(f32::NEG_INFINITY, f32::INFINITY), |i| {
        seen[i as usize] += 1
    });
    assert_eq!(seen, vec![1; boxes.len()]);
}

#[test]
fn many_boxes_in_one_place() {
    let boxes = vec![Aabb::around([Vec3::ZERO, Vec3::ONE]); 100_000];
    let tree = Bvh::build(&boxes, &BuildSettings::default());
    assert!(tree.stats().depth <= 17, "{}", tree.stats().depth);
    let mut count = 0;
    tree.each(&Ray::new(Vec3::splat(-1.0), Vec3::ONE), |_| count += 1);
    assert_eq!(count, boxes.len());
}
