//! Prisms against closed forms, and against their outlines.

use kajo_math::{rng::Stream, warp};

use super::*;

pub(super) fn p(x: f64, y: f64) -> DVec2 {
    DVec2::new(x, y)
}

pub(super) fn polygon(corners: &[[f64; 2]]) -> Path<DVec2> {
    let mut path = Path::new(DVec2::from_array(corners[0]));
    corners[1..].iter().for_each(|&corner| path.line_to(DVec2::from_array(corner)));
    path.close();
    path
}

/// Upright, from z = 0.
pub(super) fn upright(depth: f64, taper: f64, rule: FillRule) -> Sweep {
    Sweep { origin: DVec3::ZERO, axes: [DVec3::X, DVec3::Y, DVec3::Z], depth, taper, rule, bevel: None }
}

fn prism(contours: &[Path<DVec2>], taper: f64, rule: FillRule) -> Prism {
    Prism::new(upright(0.5, taper, rule), contours).unwrap()
}

fn star(radius: f64) -> Path<DVec2> {
    let corners: Vec<[f64; 2]> = (0..5)
        .map(|i| 0.8 * std::f64::consts::PI * f64::from(i))
        .map(|a| [radius * a.cos(), radius * a.sin()])
        .collect();
    polygon(&corners)
}

/// Lines, a quadratic, cubics and a hole that is a spline.
pub(super) fn mixed() -> [Path<DVec2>; 2] {
    let mut outside = Path::new(p(-1.0, -0.7));
    outside.line_to(p(0.3, -0.9));
    outside.quadratic_to(p(0.2, -0.2), p(1.0, -0.3));
    outside.cubic_to([p(1.6, 0.4), p(0.1, 0.2)], p(0.6, 0.9));
    outside.spline_through(&[p(0.0, 0.5), p(-0.4, 0.9), p(-0.9, 0.3)]);
    outside.close();
    let hole = Path::closed_spline(&[p(-0.3, -0.4), p(0.1, -0.1), p(-0.2, 0.2), p(-0.6, 0.0)]).unwrap();
    [outside, hole]
}

/// The parameters of all crossings of a ray's line.
pub(super) fn crossings(prism: &Prism, ray: &Ray) -> Vec<(f64, u32)> {
    let mut found = Vec::new();
    prism.0.intervals(ray, |ends| found.extend(ends.map(|(t, hit)| (t, hit.part))));
    found
}

/// Volume by chords along x, exact in their direction.
pub(super) fn volume(prism: &Prism) -> f64 {
    const N: u32 = 800;
    let bounds = prism.bounds();
    let (low, extent) = (bounds.min.as_dvec3(), bounds.extent().as_dvec3());
    let middle = |i: u32| (f64::from(i) + 0.5) / f64::from(N);
    let mut sum = 0.0;
    for j in 0..N {
        for k in 0..N / 8 {
            let at = low + extent * DVec3::new(0.0, middle(j), middle(8 * k + 3) + 0.5 / f64::from(N));
            let ray = Ray::new((at - DVec3::X).as_vec3(), Vec3::X);
            let found = crossings(prism, &ray);
            sum += found.chunks(2).map(|pair| pair[1].0 - pair[0].0).sum::<f64>();
        }
    }
    sum * extent.y * extent.z / f64::from(N * (N / 8))
}

fn is_near(found: f64, expected: f64) -> bool {
    (found / expected - 1.0).abs() < 5e-4
}

#[test]
fn volumes_are_area_times_height() {
    let whole = |path: Path<DVec2>| volume(&prism(&[path], 1.0, FillRule::NonZero));
    assert!(is_near(whole(polygon(&[[0., 0.], [2., 0.], [2.5, 1.], [0.5, 1.5]])), 0.5 * 2.625));
    // A parabola has two thirds of the triangle around it [Archimedes].
    let mut parabola = Path::new(p(0.0, 0.0));
    parabola.quadratic_to(p(1.0, 2.0), p(2.0, 0.0));
    parabola.close();
    assert!(is_near(whole(parabola), 0.5 * 4.0 / 3.0));
    // The integral of y dx of this cubic is 18 B(3, 3) = 3/5.
    let mut cubic = Path::new(p(0.0, 0.0));
    cubic.cubic_to([p(0.0, 1.0), p(1.0, 1.0)], p(1.0, 0.0));
    cubic.close();
    assert!(is_near(whole(cubic), 0.5 * 0.6));
}

#[test]
fn what_tapers_has_the_volume_of_a_frustum() {
    let square = || polygon(&[[-1., -1.], [1., -1.], [1., 1.], [-1., 1.]]);
    for taper in [0.0, 0.4, 1.0, 1.7] {
        let found = volume(&prism(&[square()], taper, FillRule::NonZero));
        assert!(is_near(found, 4.0 * 0.5 * (1.0 + taper + taper * taper) / 3.0), "{taper}: {found}");
    }
}

/// Of a star the middle, which is gone around twice, is inside by one rule and outside by the other.
#[test]
fn outlines_that_cross_themselves_are_filled_by_the_rule() {
    let golden = 0.5 * (1.0 + 5f64.sqrt());
    let (inner, tenth) = (golden.powi(-2), std::f64::consts::PI / 5.0);
    let (whole, middle) = (5.0 * inner * tenth.sin(), 2.5 * inner * inner * (2.0 * tenth).sin());
    let of = |rule: FillRule| volume(&prism(&[star(1.0)], 1.0, rule));
    assert!(is_near(of(FillRule::NonZero), 0.5 * whole));
    assert!(is_near(of(FillRule::EvenOdd), 0.5 * (whole - middle)));
    // No wall shows within what is filled.
    let across = Ray::new(Vec3::new(-3.0, 0.05, 0.2), Vec3::X);
    assert_eq!(crossings(&prism(&[star(1.0)], 1.0, FillRule::NonZero), &across).len(), 2);
    assert_eq!(crossings(&prism(&[star(1.0)], 1.0, FillRule::EvenOdd), &across).len(), 4);
}

/// Rays to the very points where walls meet, from everywhere: from outside into the inside they cross twice, never once, never not.
#[test]
fn no_ray_slips_between_walls() {
    let corners = [[1., 0.], [0.5, 0.875], [-0.5, 0.75], [-1., 0.125], [-0.625, -0.75], [0.375, -1.]];
    let convex = prism(&[polygon(&corners)], 1.0, FillRule::NonZero);
    for i in 0..60_000u32 {
        let s = Stream::new(71, [i, 0], 0);
        let [x, y] = corners[(i % 6) as usize];
        let corner = Vec3::new(x as f32, y as f32, [0.25, 0.4 * s.uniform(0) + 0.05][(i / 6 % 2) as usize]);
        // Towards a place inside, through the corner; directions are short in bits, so that rays meet the corner exactly.
        let inward = Vec3::new(-corner.x, -corner.y, 0.0)
            + 0.25 * (warp::uniform_sphere(bits(s, 1)) * 64.0).round() / 64.0;
        let inward = Vec3::new(inward.x, inward.y, 0.125 * (inward.z * 64.0).round() / 64.0);
        let ray = Ray::new(corner - 4.0 * inward, inward);
        let found = crossings(&convex, &ray);
        assert!(found.len() == 2 && found[1].0 - found[0].0 > 0.1, "{i}: {found:?} of {ray:?}");
        assert!((found[0].0 - 4.0).abs() < 1e-6, "{i}: {found:?}");
    }
}

fn bits(s: Stream, k: u32) -> Vec2 {
    Vec2::new(s.uniform(k), s.uniform(k + 1))
}

/// Also of outlines with tangents that turn back, of rays to joints, along walls, and to the tip, there are even numbers.
#[test]
fn crossings_come_in_pairs() {
    let shapes = [
        prism(&mixed(), 1.0, FillRule::NonZero),
        prism(&mixed(), 0.0, FillRule::EvenOdd),
        prism(&mixed(), 2.0, FillRule::EvenOdd),
        prism(&[star(0.9)], 0.3, FillRule::EvenOdd),
    ];
    for (n, shape) in shapes.iter().enumerate() {
        let joints: Vec<DVec2> = shape.0.curves.iter().map(Bezier::start).collect();
        for i in 0..40_000u32 {
            let s = Stream::new(73, [i, n as u32], 0);
            let joint = |k: u32| {
                let (at, z) = (
                    joints[(s.uniform(k) * joints.len() as f32) as usize],
                    0.5 * f64::from(s.uniform(k + 1)),
                );
                (shape.0.size_at(z) * at).extend(z)
            };
            let o = match i % 3 {
                0 => (warp::uniform_sphere(bits(s, 4)) * 3.0).as_dvec3(),
                1 => joint(8),
                _ => (joint(8).truncate() * 1.5).extend(joint(8).z),
            };
            let to = if i % 5 == 0 { DVec3::new(0.0, 0.0, 0.5) } else { joint(12) };
            let d = to - o;
            let ray = Ray::new((o - 3.0 * d).as_vec3(), d.as_vec3());
            let found = crossings(shape, &ray);
            assert!(found.len().is_multiple_of(2), "{n} {i}");
            assert!(found.windows(2).all(|pair| pair[0].0 <= pair[1].0), "{n} {i}: {found:?}");
        }
    }
}

/// Crossings against whether points are inside of fine polygons, found by going around them.
#[test]
fn no_crossing_is_missed_and_none_is_made_up() {
    for (rule, taper) in [(FillRule::NonZero, 1.0), (FillRule::EvenOdd, 0.3), (FillRule::EvenOdd, 0.0)] {
        let contours = mixed();
        let shape = prism(&contours, taper, rule);
        let polygons: Vec<Vec<DVec2>> = contours
            .iter()
            .map(|path| {
                path.curves().iter().flat_map(|c| (0..400).map(|i| c.at(f64::from(i) / 400.0))).collect()
            })
            .collect();
        let winding = |q: DVec2| -> f64 {
            let turn =
                |a: DVec2, b: DVec2| kajo_math::fmath::atan2_64((a - q).perp_dot(b - q), (a - q).dot(b - q));
            let around = |polygon: &Vec<DVec2>| {
                (0..polygon.len()).map(|i| turn(polygon[i], polygon[(i + 1) % polygon.len()])).sum::<f64>()
            };
            polygons.iter().map(around).sum::<f64>() / std::f64::consts::TAU
        };
        let mut inside = 0;
        for i in 0..600u32 {
            let s = Stream::new(79, [i, 0], 0);
            let d = warp::uniform_sphere(bits(s, 0));
            let through = Vec3::new(2.0 * s.uniform(2) - 1.0, 2.0 * s.uniform(3) - 1.0, 0.5 * s.uniform(4));
            let ray = Ray::new(through - 4.0 * d, d);
            let found = crossings(&shape, &ray);
            for k in 0..40 {
                let t = 3.0 + 2.0 * (f64::from(k) + 0.5) / 40.0;
                let at = Ray64::new(&ray).at(t);
                let near = (at.z.abs() < 2e-3 || (at.z - 0.5).abs() < 2e-3)
                    || found.iter().any(|(c, _)| (c - t).abs() < 2e-3);
                let q = at.truncate() / shape.0.size_at(at.z);
                // Polygons are not the curves, and the tip has no place in the outline.
                if near || shape.0.size_at(at.z) < 1e-2 || is_close_to(&polygons, q) {
                    continue;
                }
                let expected = at.z > 0.0 && at.z < 0.5 && rule.fills(winding(q).round() as i32);
                let count = found.iter().filter(|(c, _)| *c < t).count();
                assert_eq!(count % 2 == 1, expected, "ray {i} at {at}: {found:?}");
                inside += u32::from(expected);
            }
        }
        assert!(inside > 1000, "{inside}");
    }
}

fn is_close_to(polygons: &[Vec<DVec2>], q: DVec2) -> bool {
    polygons.iter().flatten().any(|p| p.distance(q) < 1e-2)
}

/// The same crossings from near and from ten thousand units away.
#[test]
fn far_origins_cost_no_digits() {
    let shape = prism(&mixed(), 0.6, FillRule::NonZero);
    let mut hits = 0;
    for i in 0..3000u32 {
        let s = Stream::new(83, [i, 0], 0);
        let round = |v: Vec3| (v * 256.0).round() / 256.0;
        let d = round(warp::uniform_sphere(bits(s, 0)));
        let o = round(Vec3::new(s.uniform(2) - 0.5, s.uniform(3) - 0.5, 0.5 * s.uniform(4))) - 2.0 * d;
        let (near, far) = (Ray::new(o, d), Ray::new(o - 8192.0 * d, d));
        let (a, b) = (crossings(&shape, &near), crossings(&shape, &far));
        assert_eq!(a.len(), b.len(), "{i}");
        let agree = a.iter().zip(&b).all(|(a, b)| (a.0 + 8192.0 - b.0).abs() < 1e-9);
        assert!(agree, "{i}: {a:?} {b:?}");
        hits += a.len();
    }
    assert!(hits > 3000);
}

/// Two outlines that share a side are one solid: nothing shows where they meet.
#[test]
fn contours_that_touch_are_one() {
    let halves = [
        polygon(&[[0., 0.], [0.3, 0.1], [0.2, 1.1], [0., 1.]]),
        polygon(&[[0.3, 0.1], [0.7, 0.], [0.9, 1.], [0.2, 1.1]]),
    ];
    let shape = prism(&halves, 1.0, FillRule::NonZero);
    for i in 0..5000u32 {
        let s = Stream::new(89, [i, 0], 0);
        let o = Vec3::new(-1.0, 0.15 + 0.7 * s.uniform(0), 0.05 + 0.4 * s.uniform(1));
        let to = Vec3::new(0.8, 0.15 + 0.7 * s.uniform(2), 0.05 + 0.4 * s.uniform(3));
        assert_eq!(crossings(&shape, &Ray::new(o, to - o)).len(), 2, "{i}");
    }
}

#[test]
fn rays_along_the_axis_and_along_walls() {
    let shape = prism(&[polygon(&[[-1., -1.], [1., -1.], [1., 1.], [-1., 1.]])], 1.0, FillRule::NonZero);
    let along = |x: f32, y: f32| crossings(&shape, &Ray::new(Vec3::new(x, y, -2.0), Vec3::Z));
    assert_eq!(along(0.5, 0.25), [(2.0, NEAR_END), (2.5, FAR_END)]);
    assert!(along(1.5, 0.25).is_empty());
    for (x, y) in [(1.0, 0.3), (-1.0, 0.3), (0.3, 1.0), (0.3, -1.0), (1.0, 1.0)] {
        assert!(along(x, y).len().is_multiple_of(2));
    }
    // To the tip of a pyramid from below, off its axis and on it.
    let pyramid = prism(&[polygon(&[[-1., -1.], [1., -1.], [1., 1.], [-1., 1.]])], 0.0, FillRule::NonZero);
    for x in [0.0, 0.25, 0.5] {
        let o = Vec3::new(4.0 * x, 0.0, -1.5);
        let found = crossings(&pyramid, &Ray::new(o, Vec3::new(0.0, 0.0, 0.5) - o));
        assert!(
            found.len() == 2 && (found[0].0 - 0.75).abs() < 1e-12 && (found[1].0 - 1.0).abs() < 1e-12,
            "{found:?}"
        );
    }
}

#[test]
fn outlines_without_area_make_nothing() {
    let make =
        |contours: &[Path<DVec2>]| Prism::new(upright(1.0, 1.0, FillRule::NonZero), contours).is_some();
    assert!(!make(&[]) && !make(&[polygon(&[[0., 0.], [1., 1.], [2., 2.]])]));
    assert!(!make(&[polygon(&[[1., 1.], [1., 1.], [1., 1.]])]));
    assert!(make(&[polygon(&[[0., 0.], [1., 1.], [2., 2.], [0., 1.]])]));
    let mut open = Path::new(p(0.0, 0.0));
    open.quadratic_to(p(1.0, 0.0), p(1.0, 1.0));
    assert!(!make(&[open]));
    assert!(Prism::new(upright(0.0, 1.0, FillRule::NonZero), &[star(1.0)]).is_none());
}

/// A gear of thousands of teeth: rays find what a brute search over its curves finds.
#[test]
fn many_curves_are_found_by_a_tree() {
    let corner = |i: u32| {
        let (a, r) = (std::f64::consts::TAU * f64::from(i) / 4000.0, if i % 4 < 2 { 1.0 } else { 0.9 });
        [r * a.cos(), r * a.sin()]
    };
    let shape = prism(&[polygon(&(0..4000).map(corner).collect::<Vec<_>>())], 1.0, FillRule::NonZero);
    for i in 0..400u32 {
        let s = Stream::new(97, [i, 0], 0);
        let (o, to) = (warp::uniform_sphere(bits(s, 0)) * 2.0, warp::uniform_sphere(bits(s, 2)) * 0.9);
        let line = Ray64::new(&Ray::new(o, to - o));
        let side =
            PlaneLine::new(line.d.truncate().perp(), line.o.truncate().perp_dot(line.d.truncate()), 1.0);
        let (mut found, mut expected) = (Vec::new(), Vec::new());
        shape.0.tree.each(
            |bounds| side.overlaps(bounds),
            |i| side.crossings(&shape.0.curves[i as usize], |s, _| found.push((i, s))),
        );
        for (i, curve) in shape.0.curves.iter().enumerate() {
            side.crossings(curve, |s, _| expected.push((i as u32, s)));
        }
        assert_eq!(found, expected);
        assert!(found.len().is_multiple_of(2));
    }
}
