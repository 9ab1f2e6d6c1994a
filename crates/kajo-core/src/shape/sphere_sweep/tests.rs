//! Sphere sweeps against closed forms, against a torus, and against very many balls.

use std::f64::consts::PI;

use kajo_math::{DAffine3, rng::Stream, warp};

use super::*;
use crate::shape::{Sphere, Torus};

fn path(points: &[[f64; 4]]) -> Path<DVec4> {
    let mut path = Path::new(DVec4::from_array(points[0]));
    points[1..].iter().for_each(|&p| path.line_to(DVec4::from_array(p)));
    path
}

fn sweep(paths: &[Path<DVec4>]) -> SphereSweep {
    SphereSweep::new(paths).unwrap()
}

/// A line, a quadratic, a cubic and a spline whose balls swell, shrink and cross themselves.
fn mixed() -> Path<DVec4> {
    let p = |x: f64, y: f64, z: f64, r: f64| DVec4::new(x, y, z, r);
    let mut path = path(&[[-0.8, -0.6, 0.1, 0.1], [-0.2, -0.5, 0.0, 0.2]]);
    path.quadratic_to(p(0.9, -0.4, 0.3, 0.05), p(0.6, 0.3, 0.1, 0.15));
    path.cubic_to([p(0.3, 0.9, -0.3, 0.5), p(-0.8, 0.8, 0.3, -0.1)], p(-0.6, 0.2, 0.4, 0.12));
    path.spline_through(&[p(-0.3, -0.4, 0.2, 0.2), p(0.2, -0.3, -0.4, 0.08), p(0.7, 0.1, 0.1, 0.1)]);
    path
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

/// The parameters of all crossings of a ray's line, in pairs.
fn crossings(sweep: &SphereSweep, ray: &Ray) -> Vec<f64> {
    let mut found = Vec::new();
    sweep.0.intervals(ray, |ends| found.extend(ends.map(|end| end.t)));
    found
}

fn agree(name: &str, sweep: &SphereSweep, other: &impl Surface, tolerance: f32) {
    let mut hits = 0;
    for i in 0..20_000 {
        let ray = random_ray(i, 11);
        let (mut a, mut b) = (Vec::new(), Vec::new());
        sweep.crossings(&ray, |hit| a.push(hit.t));
        other.crossings(&ray, |hit| b.push(hit.t));
        b.sort_unstable_by(f32::total_cmp);
        hits += a.len();
        // Where a ray grazes, a path that is off by a billionth decides otherwise.
        let grazes = [&a, &b].iter().any(|t| t.windows(2).any(|pair| pair[1] - pair[0] < 1e-3));
        let near = a.len() == b.len() && a.iter().zip(&b).all(|(a, b)| (a - b).abs() < tolerance);
        assert!(grazes || near, "{name} {i}: {a:?} {b:?}");
    }
    assert!(hits > 3000, "{name}: {hits}");
}

#[test]
fn paths_of_other_shapes_are_those_shapes() {
    let still = sweep(&[path(&[[0.25, -0.125, 0.5, 0.75], [0.25, -0.125, 0.5, 0.75]])]);
    agree("ball", &still, &Sphere::new(Vec3::new(0.25, -0.125, 0.5), 0.75), 2e-6);
    // A ball that grows around itself is its largest.
    let growing = sweep(&[path(&[[0.0, 0.0, 0.0, 0.25], [0.125, 0.0, 0.0, 0.75]])]);
    agree("largest ball", &growing, &Sphere::new(Vec3::new(0.125, 0.0, 0.0), 0.75), 2e-6);
    // A circle in cubics of an eighth of a right angle, off by some billionths.
    let at = |i: u32| {
        let (sin, cos) = (f64::from(i % 32) * PI / 16.0).sin_cos();
        let k = 0.75 * 4.0 / 3.0 * (PI / 64.0).tan();
        (DVec4::new(0.75 * cos, 0.75 * sin, 0.0, 0.25), DVec4::new(-k * sin, k * cos, 0.0, 0.0))
    };
    let mut circle = Path::new(at(0).0);
    (0..32).for_each(|i| circle.cubic_to([at(i).0 + at(i).1, at(i + 1).0 - at(i + 1).1], at(i + 1).0));
    agree("torus", &sweep(&[circle]), &Torus::new(Vec3::ZERO, Vec3::Z, 0.75, 0.25).unwrap(), 2e-5);
}

/// Volume by chords along z, exact in their direction.
fn volume(sweep: &SphereSweep) -> f64 {
    const N: u32 = 700;
    let bounds = sweep.bounds();
    let (low, extent) = (bounds.min.as_dvec3(), bounds.extent().as_dvec3());
    let middle = |i: u32| (f64::from(i) + 0.5) / f64::from(N);
    let mut sum = 0.0;
    for j in 0..N {
        for i in 0..N {
            let at = low + extent * DVec3::new(middle(i), middle(j), 0.0);
            let ray = Ray::new((at - DVec3::Z).as_vec3(), Vec3::Z);
            sum += crossings(sweep, &ray).chunks(2).map(|pair| pair[1] - pair[0]).sum::<f64>();
        }
    }
    sum * extent.x * extent.y / f64::from(N * N)
}

#[test]
fn volumes_follow_their_formulas() {
    let near = |name: &str, found: f64, expected: f64| {
        assert!((found / expected - 1.0).abs() < 5e-4, "{name}: {found} instead of {expected}");
    };
    // Two balls and the cone that touches both: what of each is beyond its circle, and the frustum between them.
    let (a, b) = (DVec3::new(-0.5, 0.1, -0.3), DVec3::new(0.6, -0.2, 0.4));
    let (r0, r1, length) = (0.5f64, 0.2f64, a.distance(b));
    let sin = (r0 - r1) / length;
    let cap = |r: f64, sin: f64| PI / 3.0 * r.powi(3) * (2.0 + 3.0 * sin - sin.powi(3));
    let cos2 = 1.0 - sin * sin;
    let between = PI / 3.0 * length * cos2 * cos2 * (r0 * r0 + r0 * r1 + r1 * r1);
    let cone = path(&[a.extend(r0).to_array(), b.extend(r1).to_array()]);
    near("cone", volume(&sweep(&[cone])), cap(r0, sin) + cap(r1, -sin) + between);
    // A tube that never bends more than its radius: its length times its section, and one ball.
    let p = |x: f64, y: f64, z: f64| DVec4::new(x, y, z, 0.15);
    let mut tube = Path::new(p(-0.9, -0.4, 0.0));
    tube.cubic_to([p(-0.2, 0.9, 0.3), p(0.3, -1.2, -0.2)], p(0.9, 0.5, 0.2));
    const STEPS: u32 = 10_000;
    let curve = tube.curves()[0];
    let speed = |i: u32| curve.derivative((f64::from(i) + 0.5) / f64::from(STEPS)).truncate().length();
    let length = (0..STEPS).map(speed).sum::<f64>() / f64::from(STEPS);
    near("tube", volume(&sweep(&[tube])), PI * 0.0225 * length + 4.0 / 3.0 * PI * 0.003375);
}

/// Crossings against whether points are in any of very many balls.
#[test]
fn no_crossing_is_missed_and_none_is_made_up() {
    let path = mixed();
    let shape = sweep(std::slice::from_ref(&path));
    let balls: Vec<DVec4> =
        path.curves().iter().flat_map(|c| (0..=1500).map(|i| c.at(f64::from(i) / 1500.0))).collect();
    // How deep a point is in a ball at most.
    let depth = |p: DVec3| {
        balls.iter().map(|b| b.w.abs() - b.truncate().distance(p)).fold(f64::NEG_INFINITY, f64::max)
    };
    let mut inner = 0;
    for i in 0..400 {
        let ray = random_ray(i, 17);
        let found = crossings(&shape, &ray);
        assert!(found.len().is_multiple_of(2) && found.is_sorted());
        for t in &found {
            assert!(depth(Ray64::new(&ray).at(*t)).abs() < 1e-5, "{i}: {t} of {found:?}");
        }
        for k in 0..60 {
            let t = 2.5 + 3.0 * (f64::from(k) + 0.5) / 60.0;
            let depth = depth(Ray64::new(&ray).at(t));
            let count = found.iter().filter(|c| **c < t).count();
            assert!(
                (count % 2 == 1) == (depth > 0.0) || depth.abs() < 1e-5,
                "{i} at {t}: {depth}, {found:?}"
            );
            inner += u32::from(depth > 0.0);
        }
    }
    assert!(inner > 600, "{inner}");
}

/// Normals are those of the distance to the nearest ball, and far-away origins cost no digits.
#[test]
fn crossings_are_the_same_from_far_away() {
    let shape = sweep(&[mixed()]);
    let mut hits = 0;
    for i in 0..3000u32 {
        let s = Stream::new(83, [i, 0], 0);
        let round = |v: Vec3| (v * 256.0).round() / 256.0;
        let d = round(warp::uniform_sphere(bits(s, 0)));
        let o = round(Vec3::new(s.uniform(2), s.uniform(3), s.uniform(4)) - 0.5) - 2.0 * d;
        let (a, b) = (crossings(&shape, &Ray::new(o, d)), crossings(&shape, &Ray::new(o - 8192.0 * d, d)));
        assert_eq!(a.len(), b.len(), "{i}");
        let agree = a.iter().zip(&b).all(|(a, b)| (a + 8192.0 - b).abs() < 1e-8);
        assert!(agree, "{i}: {a:?} {b:?}");
        hits += a.len();
    }
    assert!(hits > 2000, "{hits}");
}

/// Rays that graze a tube by less and less cross twice or not at all, and the crossings are near each other.
#[test]
fn tangent_rays_cross_twice_or_not_at_all() {
    let rod = sweep(&[path(&[[-0.5, 0.0, 0.0, 0.25], [0.5, 0.0, 0.0, 0.25]])]);
    let (mut both, mut none) = (0, 0);
    for i in 0..50_000u32 {
        let s = Stream::new(29, [i, 0], 0);
        let angle = TAU * f64::from(s.uniform(0));
        let n = DVec3::new(0.0, angle.cos(), angle.sin());
        let d = DVec3::new(f64::from(s.uniform(1) - 0.5), -angle.sin(), angle.cos()).normalize();
        let off = 1e-7 * f64::from(s.uniform(2) - 0.5);
        let at = (0.25 + off) * n - 2.0 * d;
        let found = crossings(&rod, &Ray::new(at.as_vec3(), d.as_vec3()));
        assert!(found.is_empty() || (found.len() == 2 && found[1] - found[0] < 2e-3), "{found:?} at {off:e}");
        (both, none) = (both + found.len() / 2, none + usize::from(found.is_empty()));
    }
    assert!(both > 10_000 && none > 10_000, "{both} {none}");
}

#[test]
fn paths_without_balls_make_nothing() {
    assert!(SphereSweep::new(&[]).is_none());
    assert!(SphereSweep::new(&[path(&[[0.0; 4], [1.0, 0.0, 0.0, 0.0]])]).is_none());
    // A point is a ball, and a tip is one of none.
    assert!(SphereSweep::new(&[path(&[[0.0, 0.0, 0.0, 0.5], [1.0, 0.0, 0.0, 0.0]])]).is_some());
}

/// A sweep that gives light is drawn by spheres along it, moved and stretched ones too: the mean of an estimate is the one of a single
/// sphere around all of it, each point has the density that it was drawn with, and what is long and thin has far less variance.
#[test]
fn light_is_drawn_along_the_sweep() {
    const N: u32 = 40_000;
    let wire =
        path(&[[-2.0, 0.0, 0.0, 0.03], [0.0, 0.3, 1.0, 0.03], [0.3, 0.0, -1.0, 0.05], [2.0, 0.0, 0.0, 0.03]]);
    let many: Vec<_> =
        (0..90).map(|i| f64::from(i) / 20.0).map(|x| [x - 2.0, (3.0 * x).sin(), 0.2, 0.02]).collect();
    let stretched = DAffine3::from_scale(DVec3::new(0.5, 1.5, 1.0));
    for (sweep, map, gain) in [
        (sweep(std::slice::from_ref(&wire)), DAffine3::IDENTITY, 20.0),
        (sweep(&[wire]), stretched, 8.0),
        (sweep(&[mixed()]), DAffine3::IDENTITY, 1.0),
        (sweep(&[path(&many)]), DAffine3::IDENTITY, 5.0),
    ] {
        let mut covered = None;
        sweep.patches(|_, patch| covered = patch.transformed(&map));
        let single = Patch::Traced(Box::new(TracedPatch::new(sweep.clone(), 0).unwrap()));
        let from = Vec3::new(0.4, 1.1, 2.0);
        let moments = |patch: &Patch| {
            let (mut sum, mut squares, mut off) = (0.0, 0.0, 0);
            for i in 0..N {
                let s = Stream::new(7, [i, 0], 0);
                let Some(way) = patch.sample(from, bits(s, 0)) else { continue };
                let again = patch.pdf(from, way.at.p, way.at.n);
                off += u32::from((again / way.pdf - 1.0).abs() > 0.01);
                let e = f64::from((2.5 + way.at.p.x + way.wi.z) / way.pdf);
                (sum, squares) = (sum + e, squares + e * e);
            }
            // On the very edge of a view rounding decides whether a point is in it.
            assert!(off < N / 2000, "{off} of {N}");
            let (mean, mean2) = (sum / f64::from(N), squares / f64::from(N));
            (mean, (mean2 - mean * mean) / f64::from(N))
        };
        let (covered, single) = (moments(&covered.unwrap()), moments(&single.transformed(&map).unwrap()));
        let sigma = (covered.1 + single.1).sqrt();
        assert!((covered.0 - single.0).abs() < 4.5 * sigma, "{covered:?} {single:?}");
        assert!(covered.1 * gain < single.1, "{covered:?} {single:?}");
    }
}
