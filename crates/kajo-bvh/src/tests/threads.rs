//! The tree does not depend on the number of threads.

use kajo_math::Aabb;

use super::meshes::Mesh;
use crate::{BuildSettings, Bvh, Quality, TriangleBvh};

#[test]
fn any_number_of_threads_builds_the_same_tree() {
    // Large enough for sets that all threads share.
    same_for_all(&Mesh::grid(220, 0.3, 1));
    same_for_all(&Mesh::soup(40_000, 0.05, 2));
}

fn same_for_all(mesh: &Mesh) {
    let boxes: Vec<Aabb> = (0..mesh.triangles.len()).map(|t| Aabb::around(mesh.corners(t))).collect();
    for quality in [Quality::Linear, Quality::Fast, Quality::High] {
        let settings = BuildSettings { quality };
        let on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let triangles = TriangleBvh::build(&mesh.positions, &mesh.triangles, &settings).unwrap();
                (triangles, Bvh::build(&boxes, &settings))
            })
        };
        let (triangles, top) = on(1);
        assert!(triangles.stats().nodes > 1000);
        for threads in [2, 7] {
            let (other, other_top) = on(threads);
            assert!(other.tree.nodes == triangles.tree.nodes && other.groups == triangles.groups);
            assert!(other_top.tree.nodes == top.tree.nodes);
        }
    }
}
