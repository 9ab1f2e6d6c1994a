//! Work for a ray: it grows with the logarithm of the number of triangles, and no change of the
//! code makes it larger unseen.

use kajo_math::Ray;

use super::meshes::{Mesh, Random};
use crate::{BuildSettings, Quality, TriangleBvh};

fn build(mesh: &Mesh, quality: Quality) -> TriangleBvh {
    TriangleBvh::build(&mesh.positions, &mesh.triangles, &BuildSettings { quality }).unwrap()
}

/// Nodes that a ray at a sphere of `20 * 4^level` triangles visits on average.
fn visits(level: usize) -> f64 {
    let mesh = Mesh::sphere(level);
    let (tree, mut random) = (build(&mesh, Quality::Fast), Random::new(5));
    let mut inward = || {
        let o = random.cube().normalize() * 3.0;
        Ray::new(o, random.cube() * 0.5 - o)
    };
    let rays: Vec<Ray> = (0..2000).map(|_| inward()).collect();
    assert!(rays.iter().all(|ray| tree.closest(ray).is_some()));
    tree.closest_visits(&rays).nodes as f64 / rays.len() as f64
}

#[test]
fn twice_the_triangles_take_a_quarter_more_nodes_at_most() {
    // From 1280 triangles on; each level has four times as many.
    let deepest = if std::env::var_os("KAJO_DEEP").is_some() { 9 } else { 6 };
    let counts: Vec<f64> = (3..=deepest).map(visits).collect();
    for pair in counts.windows(2) {
        assert!(pair[1] <= pair[0] * 1.25 * 1.25, "{counts:?}");
    }
    assert!(counts[0] < 10.0, "{counts:?}");
}

/// Nodes and groups that closest-hit and any-hit rays at a mesh visit.
fn work(mesh: &Mesh, quality: Quality) -> [usize; 4] {
    let (tree, rays) = (build(mesh, quality), mesh.rays(2000, 7));
    let (closest, any) = (tree.closest_visits(&rays), tree.any_visits(&rays));
    [closest.nodes, closest.groups, any.nodes, any.groups]
}

/// Work that was counted when these lines were written. Who changes the builder or the walk sees
/// here, without noise, what it does: smaller numbers are to be written down, larger ones to be
/// weighed.
#[test]
fn the_work_is_what_it_was() {
    let [sphere, soup, slivers] = [Mesh::sphere(5), Mesh::soup(20_000, 0.05, 1), Mesh::slivers(5000, 2)];
    let figures = [Quality::Linear, Quality::Fast, Quality::High]
        .map(|quality| [work(&sphere, quality), work(&soup, quality), work(&slivers, quality)]);
    let known = [
        [[11531, 4899, 10327, 3520], [24857, 13424, 20594, 10661], [88073, 256056, 71526, 208641]],
        [[10967, 4393, 9868, 3312], [22367, 13606, 18870, 10878], [78488, 222709, 63853, 180898]],
        [[10964, 4382, 9860, 3268], [21969, 13477, 18453, 10794], [80030, 219543, 65017, 178543]],
    ];
    assert_eq!(figures, known);
}
