//! Trees of boxes that move: the right boxes at the right time.

use kajo_math::{Aabb, Ray, Vec3};

use super::meshes::{Mesh, Random};
use crate::{BuildSettings, Bvh, MovingBvh};

fn boxes(n: usize, speed: f32, seed: u64) -> Vec<[Aabb; 2]> {
    let mut random = Random::new(seed);
    let mut one = || {
        let (p, extent) = (random.cube(), random.cube().abs() * 0.2);
        let (q, other) = (p + random.cube() * speed, random.cube().abs() * 0.2);
        [Aabb::around([p, p + extent]), Aabb::around([q, q + other])]
    };
    (0..n).map(|_| one()).collect()
}

fn build(boxes: &[[Aabb; 2]]) -> MovingBvh {
    MovingBvh::build(boxes, &BuildSettings::default())
}

/// A box at a moment, grown by `margin`.
fn at([open, close]: &[Aabb; 2], time: f32, margin: f32) -> Aabb {
    let mix = |a: Vec3, b: Vec3| {
        let s = f64::from(time);
        ((1.0 - s) * a.as_dvec3() + s * b.as_dvec3()).as_vec3()
    };
    Aabb { min: mix(open.min, close.min) - margin, max: mix(open.max, close.max) + margin }
}

fn rays(n: usize) -> Vec<Ray> {
    let mut random = Random::new(3);
    let mut rays = Mesh::soup(300, 0.2, 9).rays(n, 10);
    for (i, ray) in rays.iter_mut().enumerate() {
        ray.time = [0.0, 1.0, random.unit(), random.unit()][i % 4];
    }
    rays
}

#[test]
fn each_visits_all_that_are_met_once_and_little_else() {
    for (n, speed) in [(0, 1.0), (1, 1.0), (9, 1.0), (2000, 0.1), (2000, 3.0)] {
        let boxes = boxes(n, speed, n as u64);
        let tree = build(&boxes);
        for ray in rays(500) {
            let mut seen = vec![0; n];
            tree.each(&ray, |i| seen[i as usize] += 1);
            for (b, seen) in boxes.iter().zip(seen) {
                let met = |margin| at(b, ray.time, margin).clip(&ray).is_some();
                assert!(seen <= 1 && (seen == 1 || !met(-1e-6)), "{ray:?} misses {b:?}");
                // A tree of one box has no node that could test it.
                assert!(seen == 0 || n == 1 || met(1e-4), "{ray:?} does not meet {b:?}");
            }
        }
    }
}

#[test]
fn far_from_the_origin_nothing_is_missed() {
    let moved = |b: Aabb, by: Vec3| Aabb { min: b.min * 50.0 + by, max: b.max * 50.0 + by };
    let far = Vec3::new(1e6, -3e6, 2e5);
    let boxes: Vec<_> =
        boxes(500, 2.0, 8).into_iter().map(|[a, b]| [moved(a, far), moved(b, far * 1.5)]).collect();
    let (tree, mut random) = (build(&boxes), Random::new(4));
    for (i, b) in (0u32..).zip(&boxes) {
        for _ in 0..20 {
            let time = random.unit();
            let place = at(b, time, 0.0);
            let inside = place.min + (place.max - place.min) * (0.5 + 0.4 * random.cube());
            let o = random.cube() * 1e6;
            let ray = Ray { time, ..Ray::new(o, inside - o) };
            let mut seen = false;
            tree.each(&ray, |j| seen |= i == j);
            assert!(seen || at(b, time, -2.0).clip(&ray).is_none(), "{i} at {time}");
        }
    }
}

#[test]
fn closest_and_any_agree_with_a_loop() {
    let (boxes, mut hits, mut visits) = (boxes(3000, 0.5, 3), 0, 0);
    let tree = build(&boxes);
    let entry = |ray: &Ray, i: u32| {
        let (t, _) = at(&boxes[i as usize], ray.time, 0.0).clip(ray)?;
        (t > ray.t_min && t < ray.t_max).then_some((t, i))
    };
    for ray in rays(2000) {
        let mut best: Option<(f32, u32)> = None;
        tree.closest(&ray, |i, t_max| {
            visits += 1;
            let Some(hit) = entry(&ray, i) else { return t_max };
            best = Some(best.map_or(hit, |b| if hit < b { hit } else { b }));
            best.map_or(t_max, |b| b.0)
        });
        let least = |a: (f32, u32), b: (f32, u32)| if b < a { b } else { a };
        let expected = (0..boxes.len() as u32).filter_map(|i| entry(&ray, i)).reduce(least);
        assert_eq!(best, expected, "{ray:?}");
        assert_eq!(tree.any(&ray, |i| entry(&ray, i).is_some()), best.is_some());
        hits += usize::from(best.is_some());
    }
    assert!(hits > 500 && visits < 2000 * 60, "{hits} hits in {visits} visits");
}

#[test]
fn boxes_that_rest_are_met_as_in_a_tree_without_time() {
    let boxes: Vec<Aabb> = boxes(700, 0.0, 5).into_iter().map(|[a, _]| a).collect();
    let moving = build(&boxes.iter().map(|b| [*b, *b]).collect::<Vec<_>>());
    let still = Bvh::build(&boxes, &BuildSettings::default());
    assert_eq!(moving.bounds(), still.bounds());
    for ray in rays(500) {
        let (mut a, mut b) = (Vec::new(), Vec::new());
        moving.each(&ray, |i| a.push(i));
        still.each(&ray, |i| b.push(i));
        // Boxes are widened a little more where they may move.
        assert!(b.iter().all(|i| a.contains(i)) && a.len() <= b.len() + 1, "{ray:?}");
    }
}

#[test]
fn times_outside_the_shutter_count_as_its_ends() {
    let place = |x: f32| Aabb::around([Vec3::new(x, -1.0, -1.0), Vec3::new(x + 1.0, 1.0, 1.0)]);
    let tree = build(&[[place(0.0), place(10.0)], [place(10.0), place(0.0)]]);
    let met = |x: f32, time: f32| {
        let mut met = Vec::new();
        let ray = Ray { time, ..Ray::new(Vec3::new(x, 0.0, -5.0), Vec3::Z) };
        tree.each(&ray, |i| met.push(i));
        met.sort_unstable();
        met
    };
    for (time, near, far) in [(0.0, vec![0], vec![1]), (1.0, vec![1], vec![0]), (0.5, vec![], vec![])] {
        assert_eq!((met(0.5, time), met(10.5, time)), (near, far));
    }
    assert_eq!((met(5.5, 0.5), met(0.5, -3.0), met(0.5, 7.0)), (vec![0, 1], vec![0], vec![1]));
    assert_eq!((met(0.5, f32::NAN), met(10.5, f32::NAN)), (vec![0], vec![1]));
}

#[test]
fn what_cannot_move_is_left_out() {
    let unit = Aabb::around([Vec3::ZERO, Vec3::ONE]);
    let nan = Aabb { min: Vec3::splat(f32::NAN), max: Vec3::ONE };
    let end = |x: f32| Aabb::around([Vec3::splat(x)]);
    let boxes = [
        [unit, unit],
        [unit, Aabb::EMPTY],
        [Aabb::EVERYWHERE, unit],
        [nan, unit],
        [end(f32::MAX), end(-f32::MAX)],
    ];
    let tree = build(&boxes);
    assert_eq!((tree.stats().dropped, tree.stats().leaves, tree.bounds()), (4, 1, unit));
    let mut seen = Vec::new();
    tree.each(&Ray::new(Vec3::splat(-1.0), Vec3::ONE), |i| seen.push(i));
    assert_eq!(seen, [0]);
}
