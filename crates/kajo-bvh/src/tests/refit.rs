//! Trees with new boxes answer as new trees do.

use kajo_math::{Aabb, Ray, Vec3};

use super::brute::{Loop, check_on};
use super::meshes::Mesh;
use crate::simd::Portable;
use crate::{BuildError, BuildSettings, Bvh, Quality, TriangleBvh};

fn bent(mesh: &Mesh) -> Mesh {
    mesh.clone().moved(|p| Vec3::new(p.x + 0.3 * p.y * p.y, 1.5 * p.y, p.z - 0.4 * p.x + 7.0))
}

#[test]
fn triangles_with_new_corners_are_hit_where_they_are() {
    for mesh in [
        Mesh::soup(1, 1.0, 4),
        Mesh::soup(2000, 0.2, 5),
        Mesh::slivers(900, 5),
        Mesh::sphere(4),
        Mesh::default(),
    ] {
        let (mut tree, bent) = (build(&mesh), bent(&mesh));
        tree.refit(&bent.positions, &bent.triangles).unwrap();
        check_on(Portable, &tree, &Loop::over(&bent), &bent.rays(1000, 6), "bent");
        let bounds = Aabb::around(bent.triangles.iter().flatten().map(|&i| bent.positions[i as usize]));
        assert_eq!(tree.bounds(), bounds);
        let settings = BuildSettings { quality: Quality::High };
        let mut cut = TriangleBvh::build(&mesh.positions, &mesh.triangles, &settings).unwrap();
        cut.refit(&bent.positions, &bent.triangles).unwrap();
        check_on(Portable, &cut, &Loop::over(&bent), &bent.rays(1000, 6), "bent and cut");
        // Back again, and everything is as it was.
        tree.refit(&mesh.positions, &mesh.triangles).unwrap();
        let new = build(&mesh);
        assert!(tree.tree.nodes == new.tree.nodes && tree.groups == new.groups);
    }
}

#[test]
fn triangles_that_vanish_come_back() {
    let mesh = Mesh::soup(600, 0.3, 5);
    let mut tree = build(&mesh);
    let mut broken = mesh.clone();
    for (i, [a, b, _]) in mesh.triangles.iter().enumerate() {
        match i % 6 {
            0 => broken.positions[*a as usize].y = f32::NAN,
            1 => broken.positions[*a as usize].x = f32::INFINITY,
            2 => broken.positions[*a as usize] = mesh.positions[*b as usize],
            _ => {}
        }
    }
    tree.refit(&broken.positions, &broken.triangles).unwrap();
    assert!(tree.bounds().is_finite());
    check_on(Portable, &tree, &Loop::over(&broken), &mesh.rays(1000, 6), "broken");
    let mut fewer = mesh.clone();
    fewer.triangles.truncate(100);
    tree.refit(&fewer.positions, &fewer.triangles).unwrap();
    check_on(Portable, &tree, &Loop::over(&fewer), &mesh.rays(1000, 6), "fewer");
    tree.refit(&mesh.positions, &mesh.triangles).unwrap();
    check_on(Portable, &tree, &Loop::over(&mesh), &mesh.rays(1000, 6), "whole");
}

#[test]
fn a_wrong_index_changes_nothing() {
    let mut mesh = Mesh::soup(50, 0.3, 5);
    let mut tree = build(&mesh);
    let before = tree.clone();
    mesh.triangles[9][2] = 150;
    let error = tree.refit(&mesh.positions, &mesh.triangles).unwrap_err();
    assert_eq!(error, BuildError::IndexOutOfRange { triangle: 9, index: 150, vertices: 150 });
    assert!(tree.tree.nodes == before.tree.nodes && tree.groups == before.groups);
}

#[test]
fn boxes_move_vanish_and_come_back() {
    let at = |x: f32| Aabb::around([Vec3::new(x, -1.0, -1.0), Vec3::new(x + 0.5, 1.0, 1.0)]);
    let boxes: Vec<Aabb> = (0..100).map(|i| at(i as f32)).collect();
    let mut tree = Bvh::build(&boxes, &BuildSettings::default());
    let met = |tree: &Bvh, x: f32| {
        let mut met = Vec::new();
        tree.each(&Ray::new(Vec3::new(x + 0.25, 0.0, -5.0), Vec3::Z), |i| met.push(i));
        met
    };
    let turned: Vec<Aabb> = (0..100).map(|i| at(-3.0 * i as f32)).collect();
    tree.refit(&turned);
    for i in 0..100 {
        assert_eq!(met(&tree, -3.0 * i as f32), [i]);
    }
    assert_eq!(tree.bounds(), turned[0].union(turned[99]));
    let mut holes = boxes[..70].to_vec();
    holes[7] = Aabb::EMPTY;
    holes[8] = Aabb::EVERYWHERE;
    tree.refit(&holes);
    for i in 0..100 {
        let there = i < 70 && i != 7 && i != 8;
        assert_eq!(met(&tree, i as f32), if there { vec![i] } else { vec![] });
    }
    tree.refit(&boxes);
    assert!((0..100).all(|i| met(&tree, i as f32) == [i]));
}

fn build(mesh: &Mesh) -> TriangleBvh {
    TriangleBvh::build(&mesh.positions, &mesh.triangles, &BuildSettings::default()).unwrap()
}
