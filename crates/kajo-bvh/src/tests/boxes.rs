//! Trees of boxes: every box that is met is visited, once, and in a good order.

use kajo_math::{Aabb, Ray, Vec3};

use super::meshes::{Mesh, Random};
use crate::{BuildSettings, Bvh};

fn boxes(n: usize, size: f32, seed: u64) -> Vec<Aabb> {
    let mut random = Random::new(seed);
    (0..n)
        .map(|i| {
            let p = random.cube();
            let extent = if i % 5 == 0 { Vec3::ZERO } else { random.cube().abs() * size };
            Aabb::around([p, p + extent])
        })
        .collect()
}

fn rays(n: usize) -> Vec<Ray> {
    Mesh::soup(300, 0.2, 9).rays(n, 10)
}

#[test]
fn each_visits_all_that_are_met_once() {
    for (n, size) in [(0, 1.0), (1, 1.0), (2, 1.0), (7, 1.0), (8, 1.0), (9, 1.0), (2000, 0.1), (2000, 1.0)] {
        let boxes = boxes(n, size, n as u64);
        let tree = Bvh::build(&boxes, &BuildSettings::default());
        for ray in rays(500) {
            let mut seen = vec![0; n];
            tree.each(&ray, |i| seen[i as usize] += 1);
            for (i, b) in boxes.iter().enumerate() {
                assert!(seen[i] <= 1, "{ray:?} {i}");
                // `clip` reports boxes within rounding; just inside, it must be right.
                let inner = Aabb { min: b.min - 1e-7, max: b.max + 1e-7 };
                assert!(
                    seen[i] == 1 || b.clip(&ray).is_none() || inner.clip(&ray).is_none(),
                    "{ray:?} misses {b:?}"
                );
            }
        }
    }
}

/// The nearest box by where the ray enters it, ties to the lowest number.
fn nearest(boxes: &[Aabb], ray: &Ray) -> Option<(f32, u32)> {
    let entries = (0u32..).zip(boxes).filter_map(|(i, b)| Some((b.clip(ray)?.0, i)));
    entries
        .filter(|(t, _)| *t > ray.t_min && *t < ray.t_max)
        .min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)))
}

#[test]
fn closest_finds_the_nearest_and_skips_most() {
    let (boxes, mut hits, mut visits) = (boxes(5000, 0.05, 3), 0, 0);
    let tree = Bvh::build(&boxes, &BuildSettings::default());
    for ray in rays(2000) {
        let mut best: Option<(f32, u32)> = None;
        tree.closest(&ray, |i, t_max| {
            visits += 1;
            let Some((t, _)) = boxes[i as usize].clip(&ray) else { return t_max };
            let better = best.map_or(t < ray.t_max, |b| (t, i) < b);
            if t > ray.t_min && better {
                best = Some((t, i));
            }
            best.map_or(t_max, |b| b.0)
        });
        assert_eq!(best, nearest(&boxes, &ray), "{ray:?}");
        hits += usize::from(best.is_some());
        assert_eq!(
            tree.any(&ray, |i| nearest(&boxes[i as usize..=i as usize], &ray).is_some()),
            best.is_some()
        );
    }
    assert!(hits > 500 && visits < 2000 * 60, "{hits} hits in {visits} visits");
}

#[test]
fn a_box_entered_exactly_at_the_best_hit_is_visited() {
    let boxes = vec![Aabb::around([Vec3::new(2.0, -1.0, -1.0), Vec3::new(3.0, 1.0, 1.0)]); 20];
    let tree = Bvh::build(&boxes, &BuildSettings::default());
    let mut visited = 0;
    tree.closest(&Ray::new(Vec3::ZERO, Vec3::X), |_, t_max| {
        visited += 1;
        t_max.min(2.0)
    });
    assert_eq!(visited, 20);
}

#[test]
fn empty_boxes_are_left_out_but_keep_their_numbers() {
    let mut boxes = boxes(50, 0.3, 4);
    boxes.insert(10, Aabb::EMPTY);
    boxes.insert(20, Aabb { min: Vec3::splat(f32::NAN), max: Vec3::ONE });
    boxes.insert(30, Aabb::EVERYWHERE);
    let tree = Bvh::build(&boxes, &BuildSettings::default());
    assert_eq!((tree.stats().dropped, tree.stats().leaves), (3, 50));
    let mut seen = [false; 53];
    for b in &boxes {
        let ray = Ray::new(Vec3::splat(-9.0), b.center() + Vec3::splat(9.0));
        tree.each(&ray, |i| seen[i as usize] = true);
    }
    assert!((0..53).all(|i| seen[i] != [10, 20, 30].contains(&i)), "{seen:?}");
}
