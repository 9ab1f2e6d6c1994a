//! Grids of functions with known surfaces, and of random numbers.

use kajo_math::rng::Stream;

use super::*;

/// Samples a function on `n` points a side of the box from -1 to 1.
fn grid(n: [u32; 3], closed: bool, f: impl Fn(DVec3) -> f64) -> DistanceGrid {
    let mut values = Vec::new();
    for z in 0..n[2] {
        for y in 0..n[1] {
            for x in 0..n[0] {
                let at = DVec3::new(x.into(), y.into(), z.into()) / (UVec3::from(n) - 1).as_dvec3();
                values.push(f(2.0 * at - 1.0) as f32);
            }
        }
    }
    DistanceGrid::new(n, values, [Vec3::NEG_ONE, Vec3::ONE], 0.0, [closed, true]).unwrap()
}

/// A ray from around the box through it.
fn ray(i: u32) -> Ray {
    let stream = Stream::new(11, [i, 0], 0);
    let point = |k: u32| Vec3::from_array([k, k + 1, k + 2].map(|k| 2.0 * stream.uniform(k) - 1.0));
    let o = 4.0 * point(0).normalize_or(Vec3::X);
    Ray::new(o, point(3) - o)
}

fn crossings(grid: &DistanceGrid, ray: &Ray) -> Vec<f32> {
    let mut found = Vec::new();
    grid.crossings(ray, |hit| found.push(hit.t));
    found.sort_by(f32::total_cmp);
    found
}

/// A function that is linear is met exactly, with its normal.
#[test]
fn planes_are_exact() {
    let n = DVec3::new(1.0, 2.0, -0.5);
    let plane = grid([5, 4, 7], false, |p| n.dot(p) - 0.25);
    let mut met = 0;
    for i in 0..500 {
        let ray = ray(i);
        let (o, d) = (ray.o.as_dvec3(), ray.d.as_dvec3());
        let t = (0.25 - n.dot(o)) / n.dot(d);
        let at = o + t * d;
        let found = plane.hit(&ray);
        if at.abs().max_element() < 0.999 {
            let hit = found.unwrap_or_else(|| panic!("{i}: nothing at {at}"));
            assert!((f64::from(hit.t) - t).abs() < 2e-6, "{} for {t}", hit.t);
            let point = plane.surface_at(&ray, &hit);
            assert!(point.p.as_dvec3().distance(at) < 3e-6);
            assert!(point.n.as_dvec3().distance(n.normalize()) < 1e-5, "{}", point.n);
            assert!(point.ng.as_dvec3().distance(n.normalize()) < 1e-5, "{}", point.ng);
            met += 1;
        } else if at.abs().max_element() > 1.001 {
            assert!(found.is_none(), "{i}: {found:?}");
        }
    }
    assert!(met > 150, "{met}");
}

/// Of a ball the error falls with the square of the spacing.
#[test]
fn a_ball_is_as_good_as_its_grid() {
    let error = |n: u32| {
        let ball = grid([n; 3], true, |p| p.length() - 0.7);
        let mut worst = 0.0_f64;
        for i in 0..2000 {
            let ray = ray(i);
            for t in crossings(&ball, &ray) {
                let at = ray.o.as_dvec3() + f64::from(t) * ray.d.as_dvec3();
                worst = worst.max((at.length() - 0.7).abs());
            }
        }
        worst
    };
    let (coarse, fine) = (error(17), error(33));
    let spacing = 2.0_f64 / 16.0;
    // The second derivatives of the distance are 1 / 0.7 in two directions: an eighth of the square of the spacing for each.
    assert!(coarse < 2.0 * 0.125 * spacing * spacing / 0.7 * 1.1, "{coarse}");
    let ratio = coarse / fine;
    assert!((3.2..4.8).contains(&ratio), "{ratio}");
}

/// Random numbers: on each line, what is inside by crossings against the sign of the function.
#[test]
fn no_crossing_is_missed() {
    for closed in [true, false] {
        let stream = Stream::new(2, [0, 0], 0);
        let values = (0..6 * 5 * 4).map(|k| stream.uniform(k) - 0.5).collect();
        let random =
            DistanceGrid::new([6, 5, 4], values, [Vec3::NEG_ONE, Vec3::ONE], 0.0, [closed, false]).unwrap();
        let mut count = 0;
        for i in 0..400 {
            let ray = ray(i);
            let found = crossings(&random, &ray);
            count += found.len();
            if closed {
                assert!(found.len().is_multiple_of(2), "{found:?}");
            }
            let line = Ray64::new(&ray);
            let Some([(enters, _), (leaves, _)]) = faces(random.0.corners(), &line) else {
                assert!(found.is_empty(), "{found:?}");
                continue;
            };
            let (margin, steps) = (1e-5 * (leaves - enters), 2000);
            let at =
                |k: u32| enters + margin + (leaves - enters - 2.0 * margin) * f64::from(k) / f64::from(steps);
            let starts = if closed { found.iter().filter(|&&t| f64::from(t) < at(0)).count() } else { 0 };
            let first_inside = random.0.is_inside(line.at(at(0)));
            assert!(!closed || (starts == 1) == first_inside, "{i}: {found:?}");
            for k in 1..=steps {
                let t = at(k);
                // Roots are rounded to single precision.
                if found.iter().any(|&root| (f64::from(root) - t).abs() < 1e-6) {
                    continue;
                }
                let passed =
                    found.iter().filter(|&&root| f64::from(root) < t && f64::from(root) > at(0)).count();
                assert_eq!(
                    first_inside == passed.is_multiple_of(2),
                    random.0.is_inside(line.at(t)),
                    "{i}: {found:?} at {t}"
                );
            }
            // The nearest is the first.
            assert_eq!(random.hit(&ray).map(|hit| hit.t), found.first().copied(), "{i}");
        }
        assert!(count > 500, "{count}");
    }
}

#[test]
fn numbers_that_are_no_grid_are_refused() {
    let of = |size: [u32; 3], values: Vec<f32>, max: f32| {
        DistanceGrid::new(size, values, [Vec3::ZERO, Vec3::splat(max)], 0.0, [true, true]).unwrap_err()
    };
    assert_eq!(of([1, 2, 2], vec![0.0; 4], 1.0), DistanceGridError::TooSmall { size: [1, 2, 2] });
    assert_eq!(of([2, 2, 2], vec![0.0; 7], 1.0), DistanceGridError::TooSmall { size: [2, 2, 2] });
    assert_eq!(of([u32::MAX; 3], vec![0.0; 7], 1.0), DistanceGridError::TooSmall { size: [u32::MAX; 3] });
    assert_eq!(of([2, 2, 2], vec![1.0; 8], 0.0), DistanceGridError::NoVolume);
    let mut values = vec![1.0; 2 * 3 * 4];
    values[2 + 2 * 3 * 2 + 1] = f32::NAN;
    assert_eq!(of([2, 3, 4], values, 1.0), DistanceGridError::NotFinite { at: [1, 1, 2] });
    assert!(grid([2, 2, 2], true, |_| 1.0).is_empty());
    // All of the box is inside: only its faces are seen.
    let full = grid([2, 2, 2], true, |_| -1.0);
    assert_eq!(full.bounds(), Aabb { min: Vec3::NEG_ONE, max: Vec3::ONE });
    assert_eq!(
        full.hit(&Ray::new(Vec3::new(0.1, 0.2, 4.0), Vec3::NEG_Z)).map(|hit| (hit.t, hit.u)),
        Some((3.0, 6.0))
    );
}
