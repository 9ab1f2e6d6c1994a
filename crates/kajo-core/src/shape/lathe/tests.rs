//! Lathes against closed forms, against other shapes, and against fine grids of rays.

use std::f64::consts::PI;

use kajo_math::{rng::Stream, warp};

use super::*;
use crate::shape::{Cone, Torus};

fn p(x: f64, y: f64) -> DVec2 {
    DVec2::new(x, y)
}

fn polyline(points: &[[f64; 2]]) -> Path<DVec2> {
    let mut path = Path::new(DVec2::from_array(points[0]));
    points[1..].iter().for_each(|&point| path.line_to(DVec2::from_array(point)));
    path
}

/// An arc of a circle in cubics of an eighth of a right angle, off by some billionths.
fn arc(middle: DVec2, radius: f64, [from, to]: [f64; 2]) -> Path<DVec2> {
    let n = ((to - from).abs() / (PI / 16.0)).ceil() as u32;
    let step = (to - from) / f64::from(n);
    let k = 4.0 / 3.0 * (step / 4.0).tan();
    let at = |a: f64| {
        let (sin, cos) = a.sin_cos();
        // Exactly on the axis where it is all but there.
        let x = middle.x + radius * cos;
        (p(if x.abs() < 1e-12 { 0.0 } else { x }, middle.y + radius * sin), radius * k * p(-sin, cos))
    };
    let mut path = Path::new(at(from).0);
    for i in 0..n {
        let [(a, da), (mut b, db)] = [i, i + 1].map(|i| at(from + step * f64::from(i)));
        if i + 1 == n && (to - from - 2.0 * PI).abs() < 1e-12 {
            b = path.curves()[0].start();
        }
        path.cubic_to([a + da, b - db], b);
    }
    path
}

fn upright(rule: FillRule) -> Turning {
    Turning { origin: DVec3::ZERO, axis: DVec3::Z, rule }
}

fn lathe(profiles: &[Path<DVec2>]) -> Lathe {
    Lathe::new(upright(FillRule::NonZero), profiles).unwrap()
}

/// Lines, a quadratic, cubics and a spline from the axis to the axis, and a hollow ring in it.
fn mixed() -> Vec<Path<DVec2>> {
    let mut body = Path::new(p(0.0, -0.9));
    body.line_to(p(0.6, -0.9));
    body.quadratic_to(p(0.5, -0.5), p(0.8, -0.3));
    body.cubic_to([p(1.3, 0.1), p(0.1, 0.1)], p(0.5, 0.5));
    body.spline_through(&[p(0.7, 0.7), p(0.3, 0.9), p(0.0, 0.8)]);
    let hole = Path::closed_spline(&[p(0.3, -0.6), p(0.15, -0.4), p(0.35, -0.2), p(0.45, -0.4)]).unwrap();
    vec![body, hole]
}

/// The parameters of all crossings of a ray's line, sorted.
fn crossings(lathe: &Lathe, ray: &Ray) -> Vec<f64> {
    let mut found = Vec::new();
    lathe.0.each(ray, |t, _| found.push(t));
    found.sort_unstable_by(f64::total_cmp);
    found
}

fn bits(s: Stream, k: u32) -> Vec2 {
    Vec2::new(s.uniform(k), s.uniform(k + 1))
}

fn random_ray(i: u32, seed: u64) -> Ray {
    let s = Stream::new(seed, [i, 0], 0);
    let d = warp::uniform_sphere(bits(s, 0));
    let through = Vec3::new(s.uniform(2), s.uniform(3), s.uniform(4)) * 2.0 - 1.0;
    Ray::new(through - 4.0 * d, d)
}

/// The same crossings as another shape has.
fn agree(name: &str, lathe: &Lathe, other: &impl Surface, tolerance: f32) {
    let mut hits = 0;
    for i in 0..20_000 {
        let ray = random_ray(i, 11);
        let all = |shape: &dyn Fn(&mut Vec<f32>)| {
            let mut found = Vec::new();
            shape(&mut found);
            found.sort_unstable_by(f32::total_cmp);
            found
        };
        let a = all(&|found| lathe.crossings(&ray, |hit| found.push(hit.t)));
        let b = all(&|found| other.crossings(&ray, |hit| found.push(hit.t)));
        hits += a.len();
        // Where a ray grazes, a profile that is off by a billionth decides otherwise.
        let grazes = b.windows(2).any(|pair| pair[1] - pair[0] < 1e-3)
            || a.windows(2).any(|pair| pair[1] - pair[0] < 1e-3);
        assert!(grazes || a.len() == b.len(), "{name} {i}: {a:?} {b:?}");
        let near = a.iter().zip(&b).all(|(a, b)| (a - b).abs() < tolerance);
        assert!(grazes || near, "{name} {i}: {a:?} {b:?}");
    }
    assert!(hits > 4000, "{name}: {hits}");
}

#[test]
fn profiles_of_other_shapes_are_those_shapes() {
    let cone = |base: f32, top: f32| {
        Cone::new(Vec3::new(0.0, 0.0, -0.5), Vec3::new(0.0, 0.0, 0.75), base, top, true).unwrap()
    };
    let cylinder = polyline(&[[0.0, -0.5], [0.75, -0.5], [0.75, 0.75], [0.0, 0.75]]);
    agree("cylinder", &lathe(&[cylinder]), &cone(0.75, 0.75), 2e-6);
    agree("cone", &lathe(&[polyline(&[[0.0, -0.5], [0.875, -0.5], [0.0, 0.75]])]), &cone(0.875, 0.0), 2e-6);
    let frustum = polyline(&[[0.0, -0.5], [0.875, -0.5], [0.25, 0.75], [0.0, 0.75]]);
    agree("frustum", &lathe(&[frustum]), &cone(0.875, 0.25), 2e-6);
    let ball = lathe(&[arc(p(0.0, 0.125), 0.75, [-PI / 2.0, PI / 2.0])]);
    agree("sphere", &ball, &crate::shape::Sphere::new(Vec3::new(0.0, 0.0, 0.125), 0.75), 2e-5);
    let ring = lathe(&[arc(p(0.75, 0.0), 0.25, [0.0, 2.0 * PI])]);
    agree("torus", &ring, &Torus::new(Vec3::ZERO, Vec3::Z, 0.75, 0.25).unwrap(), 2e-5);
}

/// Volume by chords along x, exact in their direction.
fn volume(lathe: &Lathe) -> f64 {
    const N: u32 = 1000;
    let bounds = lathe.bounds();
    let (low, extent) = (bounds.min.as_dvec3(), bounds.extent().as_dvec3());
    let middle = |i: u32| (f64::from(i) + 0.5) / f64::from(N);
    let mut sum = 0.0;
    for j in 0..N / 2 {
        for k in 0..N / 2 {
            let at = low + extent * DVec3::new(0.0, 0.5 + middle(j), middle(2 * k) + 0.5 / f64::from(N));
            let ray = Ray::new((at - DVec3::X).as_vec3(), Vec3::X);
            sum += crossings(lathe, &ray).chunks(2).map(|pair| pair[1] - pair[0]).sum::<f64>();
        }
    }
    2.0 * sum * extent.y * 0.5 * extent.z / f64::from((N / 2) * (N / 2))
}

/// The integral of `pi r^2 dz` along a path, by Gauss's rule of five points, exact to degree 9.
fn turned(path: &Path<DVec2>) -> f64 {
    const NODES: [[f64; 2]; 5] = [
        [0.0, 0.568_888_888_888_888_9],
        [0.538_469_310_105_683, 0.478_628_670_499_366_5],
        [-0.538_469_310_105_683, 0.478_628_670_499_366_5],
        [0.906_179_845_938_664, 0.236_926_885_056_189_1],
        [-0.906_179_845_938_664, 0.236_926_885_056_189_1],
    ];
    let of_curve = |curve: &Bezier<DVec2>| -> f64 {
        let at = |[x, weight]: [f64; 2]| {
            let s = 0.5 + 0.5 * x;
            0.5 * weight * PI * curve.at(s).x.powi(2) * curve.derivative(s).y
        };
        NODES.map(at).iter().sum()
    };
    path.curves().iter().map(of_curve).sum()
}

#[test]
fn volumes_follow_their_formulas() {
    let near = |name: &str, found: f64, expected: f64| {
        assert!((found / expected - 1.0).abs() < 5e-4, "{name}: {found} instead of {expected}");
    };
    let frustum = polyline(&[[0.0, -0.5], [0.875, -0.5], [0.25, 0.75], [0.0, 0.75]]);
    near("frustum", volume(&lathe(&[frustum])), PI * 1.25 / 3.0 * (0.765625 + 0.21875 + 0.0625));
    let ball = arc(p(0.0, 0.125), 0.75, [-PI / 2.0, PI / 2.0]);
    near("ball", volume(&lathe(&[ball])), 4.0 / 3.0 * PI * 0.421875);
    // Pappus: area of the section times the way of its middle.
    let triangle = polyline(&[[0.5, 0.0], [0.875, 0.125], [0.625, 0.5], [0.5, 0.0]]);
    let area = 0.5 * (0.375 * 0.5 - 0.125 * 0.125);
    near("ring", volume(&lathe(&[triangle])), 2.0 * PI * (2.0 / 3.0) * area);
    let [body, hole] = <[Path<DVec2>; 2]>::try_from(mixed()).unwrap();
    let (whole, hollow) = (turned(&body), turned(&hole));
    assert!(hollow < 0.0, "the hole is gone around the other way");
    near("body", volume(&lathe(std::slice::from_ref(&body))), whole);
    near("hollow body", volume(&lathe(&[body, hole])), whole + hollow);
}

/// Crossings against what is inside by winding numbers of fine polygons, near and from eight thousand units away.
#[test]
fn no_crossing_is_missed_and_none_is_made_up() {
    let profiles = mixed();
    let shape = lathe(&profiles);
    let polygon = |path: &Path<DVec2>| -> Vec<DVec2> {
        let mut points: Vec<DVec2> =
            path.curves().iter().flat_map(|c| (0..1000).map(|i| c.at(f64::from(i) / 1000.0))).collect();
        points.push(path.end());
        points
    };
    let polygons: Vec<Vec<DVec2>> = profiles.iter().map(polygon).collect();
    // Even numbers of crossings of a line outward are outside.
    let inside = |q: DVec2| {
        let mut count = 0;
        for points in &polygons {
            for pair in points.windows(2) {
                let [a, b] = [pair[0], pair[1]];
                if (a.y < q.y) != (b.y < q.y) {
                    let x = a.x + (q.y - a.y) / (b.y - a.y) * (b.x - a.x);
                    count += u32::from(x > q.x);
                }
            }
        }
        count % 2 == 1
    };
    let mut inner = 0;
    for i in 0..800 {
        let ray = random_ray(i, 17);
        // A tenth are level, or nearly so, or go through the axis, or along it.
        let ray = match i % 40 {
            0 => Ray::new(ray.o, Vec3::new(ray.d.x, ray.d.y, 0.0)),
            1 => Ray::new(
                Vec3::new(ray.o.x, ray.o.y, 0.3 * ray.o.z.fract()),
                Vec3::new(ray.d.x, ray.d.y, 1e-9),
            ),
            2 => Ray::new(Vec3::new(-4.0 * ray.d.x, -4.0 * ray.d.y, 0.4), Vec3::new(ray.d.x, ray.d.y, -0.02)),
            3 => Ray::new(Vec3::new(0.2 * ray.d.x, 0.2 * ray.d.y, -3.0), Vec3::Z),
            _ => ray,
        };
        let found = crossings(&shape, &ray);
        assert!(found.len().is_multiple_of(2));
        for k in 0..200 {
            let t = 8.0 * (f64::from(k) + 0.5) / 200.0;
            let at = Ray64::new(&ray).at(t);
            let q = p(at.truncate().length(), at.z);
            let expected = inside(q);
            let count = found.iter().filter(|c| **c < t).count();
            // Polygons are not the curves.
            let near = || polygons.iter().flatten().any(|p| p.distance(q) < 2e-3);
            assert!((count % 2 == 1) == expected || near(), "ray {i} {ray:?} at {at}: {found:?}");
            inner += u32::from(expected);
        }
    }
    assert!(inner > 3_000, "{inner}");
}

#[test]
fn far_origins_cost_no_digits() {
    let shape = lathe(&mixed());
    let mut hits = 0;
    for i in 0..3000u32 {
        let s = Stream::new(83, [i, 0], 0);
        let round = |v: Vec3| (v * 256.0).round() / 256.0;
        let d = round(warp::uniform_sphere(bits(s, 0)));
        let o = round(Vec3::new(s.uniform(2), s.uniform(3), s.uniform(4)) - 0.5) - 2.0 * d;
        let (a, b) = (crossings(&shape, &Ray::new(o, d)), crossings(&shape, &Ray::new(o - 8192.0 * d, d)));
        assert_eq!(a.len(), b.len(), "{i}");
        let agree = a.iter().zip(&b).all(|(a, b)| (a + 8192.0 - b).abs() < 1e-9);
        assert!(agree, "{i}: {a:?} {b:?}");
        hits += a.len();
    }
    assert!(hits > 3000);
}

/// Rays that graze the widest circle from inside and outside, by less and less.
#[test]
fn tangent_rays_cross_twice_or_not_at_all() {
    let ball = lathe(&[arc(p(0.0, 0.0), 0.75, [-PI / 2.0, PI / 2.0])]);
    let (mut both, mut none) = (0, 0);
    for i in 0..100_000u32 {
        let s = Stream::new(29, [i, 0], 0);
        let n = warp::uniform_sphere(bits(s, 0)).as_dvec3();
        let d = n.any_orthonormal_vector();
        let off = 1e-7 * f64::from(s.uniform(2) - 0.5);
        let at = (0.75 + off) * n - 2.0 * d;
        let found = crossings(&ball, &Ray::new(at.as_vec3(), d.as_vec3())).len();
        assert!(found == 0 || found == 2, "{found} at {off:e} along {d}");
        (both, none) = (both + found / 2, none + usize::from(found == 0));
    }
    assert!(both > 20_000 && none > 20_000, "{both} {none}");
}

/// Rays at joints, at the poles, along flat ends and upright walls, all but level.
#[test]
fn crossings_come_in_pairs() {
    let shapes = [
        lathe(&mixed()),
        lathe(&[arc(p(0.0, 0.0), 0.8, [-PI / 2.0, PI / 2.0])]),
        lathe(&[polyline(&[[0.0, -0.5], [0.75, -0.5], [0.75, 0.5], [0.25, 0.5], [0.25, 0.0], [0.0, 0.0]])]),
        Lathe::new(upright(FillRule::EvenOdd), &mixed()).unwrap(),
    ];
    for (n, shape) in shapes.iter().enumerate() {
        let joints: Vec<DVec2> = shape.0.curves.iter().map(Bezier::start).collect();
        for i in 0..40_000u32 {
            let s = Stream::new(73, [i, n as u32], 0);
            let joint = |k: u32| {
                let at = joints[(s.uniform(k) * joints.len() as f32) as usize];
                let (sin, cos) = [(0.0, 1.0), (1.0, 0.0), (0.6, 0.8)][(s.uniform(k + 1) * 3.0) as usize];
                DVec3::new(at.x * cos, at.x * sin, at.y)
            };
            let o = match i % 3 {
                0 => (warp::uniform_sphere(bits(s, 4)) * 3.0).as_dvec3(),
                _ => joint(8),
            };
            let mut d = joint(12) - o;
            if i % 5 == 0 {
                d.z = 1e-9 * f64::from(s.uniform(14) - 0.5);
            }
            let ray = Ray::new((o - 3.0 * d).as_vec3(), d.as_vec3());
            if ray.d.length() > 0.0 {
                let found = crossings(shape, &ray);
                assert!(found.len().is_multiple_of(2), "{n} {i}: {found:?} of {ray:?}");
            }
        }
    }
}

#[test]
fn rays_along_the_axis_meet_both_poles() {
    let ball = lathe(&[arc(p(0.0, 0.0), 0.75, [-PI / 2.0, PI / 2.0])]);
    let along = Ray::new(Vec3::new(0.0, 0.0, -2.0), Vec3::Z);
    let found = crossings(&ball, &along);
    assert!(
        found.len() == 2 && (found[0] - 1.25).abs() < 1e-9 && (found[1] - 2.75).abs() < 1e-9,
        "{found:?}"
    );
    let hit = ball.hit(&along).unwrap();
    assert!(ball.surface_at(&along, &hit).n.distance(Vec3::NEG_Z) < 1e-3);
    // Down a hole through the middle, and beside it.
    let ring = lathe(&[polyline(&[[0.25, 0.0], [0.75, 0.0], [0.75, 0.5], [0.25, 0.5], [0.25, 0.0]])]);
    assert!(crossings(&ring, &along).is_empty());
    let beside = Ray::new(Vec3::new(0.5, 0.0, -2.0), Vec3::Z);
    assert_eq!(crossings(&ring, &beside), [2.0, 2.5]);
    let level = Ray::new(Vec3::new(-2.0, 0.0, 0.25), Vec3::X);
    assert_eq!(crossings(&ring, &level), [1.25, 1.75, 2.25, 2.75]);
}

/// A sheet is met wherever the profile is, and has no inside.
#[test]
fn open_profiles_are_sheets() {
    let sheet = lathe(&[polyline(&[[0.25, 0.0], [0.75, 1.0]])]);
    assert!(!sheet.is_closed() && !sheet.is_solid() && lathe(&mixed()).is_closed());
    let ray = Ray::new(Vec3::new(-2.0, 0.0, 0.5), Vec3::X);
    assert_eq!(crossings(&sheet, &ray), [1.5, 2.5]);
    let hit = sheet.hit(&ray).unwrap();
    let n = sheet.surface_at(&ray, &hit).n;
    assert!(n.x < -0.8 && n.z < 0.0, "the outside is on the right of the profile: {n}");
}

#[test]
fn profiles_that_make_nothing_are_told() {
    let make = |profiles: &[Path<DVec2>]| Lathe::new(upright(FillRule::NonZero), profiles).err();
    assert_eq!(make(&[]), Some(LatheError::Nothing));
    assert_eq!(make(&[polyline(&[[0.0, 0.0], [0.0, 1.0]])]), Some(LatheError::Nothing));
    assert_eq!(make(&[polyline(&[[1.0, 1.0], [1.0, 1.0]])]), Some(LatheError::Nothing));
    assert_eq!(make(&[polyline(&[[1.0, 1.0], [2.0, 2.0], [1.0, 1.0]])]), Some(LatheError::Nothing));
    assert_eq!(make(&[polyline(&[[0.0, 0.0], [1.0, 0.0], [-0.1, 1.0]])]), Some(LatheError::CrossesAxis(0)));
    let mut bulge = Path::new(p(0.1, 0.0));
    bulge.cubic_to([p(-1.0, 0.3), p(-1.0, 0.6)], p(0.1, 1.0));
    assert_eq!(make(&[bulge]), Some(LatheError::CrossesAxis(0)));
    // Controls may be beyond the axis where the curve is not.
    let mut touching = Path::new(p(0.5, 0.0));
    touching.quadratic_to(p(-0.4, 0.5), p(0.5, 1.0));
    assert_eq!(make(&[touching]), None);
}
