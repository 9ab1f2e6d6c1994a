//! Derivatives of irradiance against closed forms and differences.

use std::f64::consts::PI;

use kajo_math::rng::Stream;

use super::*;
use crate::integrator::irradiance::hemisphere::RayResult;

/// A hemisphere of `rays` rays over the origin, into a scene that answers a direction with a radiance and one over a distance.
fn hemisphere(rays: u32, seed: u64, scene: impl Fn(DVec3) -> ([f64; 3], f64)) -> Hemisphere {
    let strata = Strata::of(rays);
    let ray = |i: usize| {
        let stream = Stream::new(seed, [0, 0], i as u32);
        let d = strata.direction(i, [0, 1].map(|n| stream.uniform(n).into()));
        let (radiance, inverse_distance) = scene(d);
        RayResult { d, radiance, inverse_distance }
    };
    Hemisphere { strata, rays: (0..strata.len()).map(ray).collect() }
}

/// A black wall of height `h` at the distance `d`, endless, under a sky of radiance 1. It stands in the direction `angle` of the
/// tangent plane.
fn wall(h: f64, d: f64, angle: f64) -> impl Fn(DVec3) -> ([f64; 3], f64) {
    let towards = DVec2::from_angle(angle);
    move |w| {
        let t = d / w.truncate().dot(towards);
        if t > 0.0 && t * w.z < h { ([0.0; 3], 1.0 / t) } else { ([1.0; 3], 0.0) }
    }
}

/// With `q^2 = d^2 + h^2`: `E = pi/2 (1 + d/q)`, `E' = pi/2 h^2/q^3` and `E'' = -3pi/2 h^2 d/q^5`, away from the wall.
#[test]
fn a_floor_beside_a_wall_is_known() {
    for (case, (h, d, angle)) in [(1.0, 1.0, 0.0), (1.0, 2.0, 0.7), (2.0, 1.5, 4.0)].into_iter().enumerate() {
        let q = f64::hypot(d, h);
        let e = 0.5 * PI * (1.0 + d / q);
        let (e1, e2) = (0.5 * PI * h * h / q.powi(3), -1.5 * PI * h * h * d / q.powi(5));
        let away = -DVec2::from_angle(angle);
        let mut by_strata = DVec2::ZERO;
        for seed in 0..4 {
            let found = hemisphere(4096, 10 * case as u64 + seed, wall(h, d, angle));
            let Derivatives { gradient, hessian: [xx, xy, yy] } = found.derivatives();
            assert!((found.irradiance()[1] / e - 1.0).abs() < 3e-3, "{:?} for {e}", found.irradiance());
            let error = (gradient[1] - away * e1).length() / e1;
            assert!(error < 0.03, "{gradient:?} for {e1}: {error}");
            let along = |v: DVec2| DVec2::new(xx * v.x + xy * v.y, xy * v.x + yy * v.y);
            let error = (along(away) - away * e2).length().max(along(away.perp()).length()) / e2.abs();
            assert!(error < 0.1, "{xx} {xy} {yy} for {e2}: {error}");
            let strata = found.gradient_of_strata()[2];
            by_strata += 0.25 * strata;
            let error = (strata - away * e1).length() / e1;
            assert!(error < 0.05, "by strata: {error}");
        }
        let error = (by_strata - away * e1).length() / e1;
        assert!(error < 0.03, "by strata, the mean: {error}");
    }
}

/// A floor under a sky that grows brighter in one direction has the rotational gradient of its integral: with `L = 1 + w·a`,
/// `E(n) = pi + 2pi/3 a·n`.
#[test]
fn turning_towards_the_light_is_known() {
    let a = DVec3::new(0.3, -0.2, 0.4);
    let found = hemisphere(4096, 1, |w| ([1.0 + w.dot(a); 3], 0.0));
    assert!((found.irradiance()[0] - PI - 2.0 * PI / 3.0 * a.z).abs() < 1e-3);
    let expected = 2.0 * PI / 3.0 * a.truncate();
    let error = (found.rotational_gradient()[0] - expected).length();
    assert!(error < 0.02, "{error} of {expected}");
}

/// Nothing changes under an even sky, nor in a scene of one radiance, however near its walls are.
#[test]
fn even_light_has_no_derivatives() {
    for inverse_distance in [0.0, 3.0] {
        let found = hemisphere(500, 2, |_| ([0.5, 1.0, 2.0], inverse_distance));
        let Derivatives { gradient, hessian } = found.derivatives();
        let largest = gradient.iter().map(|g| g.length()).chain(hessian.map(f64::abs)).fold(0.0, f64::max);
        assert!(largest < 1e-9, "{gradient:?} {hessian:?}");
        assert!(found.gradient_of_strata().iter().all(|g| g.length() < 1e-9));
    }
}

/// Edges against differences of `g` itself.
#[test]
fn edges_have_their_derivatives() {
    let ends = [DVec3::new(1.0, 0.5, 2.0), DVec3::new(0.8, 0.9, 1.7)];
    let near = [DVec3::new(1.0, 0.5, 0.4), DVec3::new(1.02, 0.51, 0.41)];
    let wide = [DVec3::new(1.0, 0.1, 0.2), DVec3::new(-0.7, 0.9, 0.3)];
    let g = |[p, q]: [DVec3; 2], x: DVec2| {
        let [a, b] = [p, q].map(|v| (v - x.extend(0.0)).normalize());
        (a.x * b.y - a.y * b.x) * arc_over_sine(a.dot(b))[0]
    };
    for ends in [ends, near, wide] {
        let corner = |v: DVec3| Corner::new(v.normalize(), v.length().recip());
        let edge = Edge::new(&corner(ends[0]), &corner(ends[1]));
        let (h, at) = (1e-3, |x: f64, y: f64| g(ends, DVec2::new(x, y)));
        let first = DVec2::new(at(h, 0.0) - at(-h, 0.0), at(0.0, h) - at(0.0, -h)) / (2.0 * h);
        assert!((edge.first - first).length() < 1e-5, "{} for {first}", edge.first);
        let second = [
            (at(h, 0.0) + at(-h, 0.0) - 2.0 * at(0.0, 0.0)) / (h * h),
            (at(h, h) + at(-h, -h) - at(h, -h) - at(-h, h)) / (4.0 * h * h),
            (at(0.0, h) + at(0.0, -h) - 2.0 * at(0.0, 0.0)) / (h * h),
        ];
        for (found, expected) in edge.second.into_iter().zip(second) {
            assert!((found - expected).abs() < 1e-4, "{:?} for {second:?}", edge.second);
        }
    }
}

#[test]
fn eigenvalues_have_their_axes() {
    let [(sin, cos), (a, b)] = [(0.6, 0.8), (-3.0, 0.5)];
    // b along (cos, sin), a across.
    let matrix = [b * cos * cos + a * sin * sin, (b - a) * sin * cos, b * sin * sin + a * cos * cos];
    let (values, axis) = eigenvalues(matrix);
    assert!((values[0] - a).abs() < 1e-12 && (values[1] - b).abs() < 1e-12 && (axis - cos).abs() < 1e-12);
    let (values, axis) = eigenvalues([2.0, 0.0, 2.0]);
    assert!(values == [2.0, 2.0] && axis.abs() <= 1.0);
    assert_eq!(eigenvalues([0.0; 3]), ([0.0; 2], 1.0));
    let (_, axis) = eigenvalues([5.0, 0.0, 1.0]);
    assert_eq!(axis, 0.0);
}
