//! No ray slips through a closed mesh, and every ray that enters leaves.

use kajo_math::{Ray, Vec3};

use super::meshes::{Mesh, Random};
use crate::{BuildSettings, Quality, TriangleBvh};

/// A million rays over all cases; with `KAJO_DEEP` set, ten million.
fn rays_each() -> usize {
    if std::env::var_os("KAJO_DEEP").is_some() { 2_500_000 } else { 250_000 }
}

/// Spheres of radius 1 made larger, smaller or moved away: name, scale, offset.
const PLACES: [(&str, f32, f32); 4] =
    [("unit", 1.0, 0.0), ("tiny", 1e-4, 0.0), ("large", 1e6, 0.0), ("far", 1e3, 1e6)];

/// Calls `check` with rays aimed at vertices and edges from points at about `from` radii
/// from the centre.
fn aim(mesh: &Mesh, scale: f32, offset: f32, from: f32, mut check: impl FnMut(&Ray)) {
    let (mut random, center) = (Random::new(3), Vec3::splat(offset));
    for i in 0..rays_each() {
        let [a, b, _] = mesh.corners(random.below(mesh.triangles.len()));
        let target = match i % 4 {
            0 => a,
            1 => (a + b) / 2.0,
            _ => a + (b - a) * random.unit(),
        };
        let o = center + random.cube().normalize_or(Vec3::X) * scale * from;
        check(&Ray::new(o, target - o));
    }
}

fn each_place(from: f32, check: impl Fn(&TriangleBvh, &Ray) -> Result<(), String>) {
    for (name, scale, offset) in PLACES {
        // The same stretched along no axis: its triangles are long, and many are cut.
        let stretched = |p: Vec3| p + Vec3::ONE * (10.0 * p.element_sum());
        for (quality, stretch) in [(Quality::Fast, false), (Quality::High, false), (Quality::High, true)] {
            let shape = |p: Vec3| if stretch { stretched(p) } else { p };
            let mesh = Mesh::sphere(4).moved(|p| shape(p) * scale + offset);
            let tree =
                TriangleBvh::build(&mesh.positions, &mesh.triangles, &BuildSettings { quality }).unwrap();
            assert!(tree.cut || !stretch, "{name}: nothing is cut");
            let mut failures = Vec::new();
            // From outside, from where that still is outside.
            let from = if stretch && from > 1.0 { 31.0 * from } else { from };
            aim(&mesh, scale, offset, from, |ray| {
                if let Err(message) = check(&tree, ray) {
                    failures.push(format!("{message}: {ray:?}"));
                }
            });
            assert!(failures.is_empty(), "{name}: {} failures, first {}", failures.len(), failures[0]);
        }
    }
}

#[test]
fn nothing_escapes_from_inside() {
    each_place(0.7, |tree, ray| match (tree.closest(ray), tree.any(ray)) {
        (Some(_), true) => Ok(()),
        answers => Err(format!("{answers:?}")),
    });
}

#[test]
fn rays_from_outside_cross_an_even_number_of_times() {
    each_place(3.0, |tree, ray| {
        let mut crossings = 0;
        tree.all(ray, |_| crossings += 1);
        if crossings % 2 == 0 { Ok(()) } else { Err(format!("{crossings} crossings")) }
    });
}

#[test]
fn rays_from_inside_cross_an_odd_number_of_times() {
    each_place(0.7, |tree, ray| {
        let mut crossings = 0;
        tree.all(ray, |_| crossings += 1);
        if crossings % 2 == 1 { Ok(()) } else { Err(format!("{crossings} crossings")) }
    });
}
