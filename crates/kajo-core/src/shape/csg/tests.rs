//! Set operations by their algebra, and by volumes.

use std::f64::consts::PI;

use kajo_math::{DQuat, DVec3, Keyframes, rng::Stream, warp};

use super::*;
use crate::shape::{Cone, Cuboid, Plane, Sphere, Torus};

fn part(shape: impl Into<AnyShape>) -> Vec<SolidPart> {
    placed(shape, DAffine3::IDENTITY)
}

fn placed(shape: impl Into<AnyShape>, map: DAffine3) -> Vec<SolidPart> {
    vec![SolidPart { shape: shape.into(), map: Motion::still(map), material: None, source: 0 }]
}

fn solid(operation: SetOperation, operands: &[Vec<SolidPart>]) -> Csg {
    Csg::new(operation, operands).unwrap()
}

use SetOperation::{Difference, Intersection, Union};

fn ball(x: f32, radius: f32) -> Vec<SolidPart> {
    part(Sphere::new(x * Vec3::X, radius))
}

fn cylinder(axis: Vec3, radius: f32) -> Vec<SolidPart> {
    part(Cone::new(-3.0 * axis, 3.0 * axis, radius, radius, true).unwrap())
}

/// A line through a random point of the ball of radius 2.
fn line(i: u32) -> Ray {
    let s = Stream::new(41, [i, 0], 0);
    let u = |k| Vec2::new(s.uniform(k), s.uniform(k + 1));
    let (through, d) = (2.0 * warp::uniform_sphere(u(0)) * s.uniform(2), warp::uniform_sphere(u(3)));
    Ray::new(through - 6.0 * d, d)
}

fn crossings(solid: &Csg, ray: &Ray) -> Vec<f32> {
    let mut found = Vec::new();
    solid.crossings(ray, |hit| found.push(hit.t));
    found
}

/// Volume by the chords of parallel lines, one in each cell of a grid.
fn volume(solid: &Csg) -> f64 {
    const SIDE: u16 = 1500;
    let bounds = solid.bounds().padded(0.01);
    let extent = bounds.extent();
    let mut sum = 0.0;
    for i in 0..u32::from(SIDE) * u32::from(SIDE) {
        let s = Stream::new(61, [i, 0], 0);
        let cell = Vec2::new((i % u32::from(SIDE)) as f32, (i / u32::from(SIDE)) as f32);
        let at = (cell + Vec2::new(s.uniform(0), s.uniform(1))) / f32::from(SIDE);
        let o = bounds.min + Vec3::new(at.x * extent.x, at.y * extent.y, -1.0);
        for pair in crossings(solid, &Ray::new(o, Vec3::Z)).chunks(2) {
            sum += f64::from(pair[1] - pair[0]);
        }
    }
    sum * f64::from(extent.x) * f64::from(extent.y) / (f64::from(SIDE) * f64::from(SIDE))
}

#[test]
fn volumes_follow_their_formulas() {
    let near = |name: &str, solid: &Csg, expected: f64| {
        let got = volume(solid);
        assert!((got / expected - 1.0).abs() < 5e-4, "{name}: {got} instead of {expected}");
    };
    let balls = [ball(0.0, 1.0), ball(1.0, 1.0)];
    near("lens", &solid(Intersection, &balls), 5.0 * PI / 12.0);
    near("two balls", &solid(Union, &balls), 7.068_583);
    let [x, y, z] = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| cylinder(axis, 1.0));
    near("two cylinders", &solid(Intersection, &[x.clone(), y.clone()]), 16.0 / 3.0);
    near("three cylinders", &solid(Intersection, &[x, y, z]), 8.0 * (2.0 - 2f64.sqrt()));
    // A ball with a hole of height 1 through it, of whatever size, has what a ball of diameter 1 has.
    let bead = |radius: f32| {
        solid(Difference, &[ball(0.0, radius), cylinder(Vec3::Y, (radius * radius - 0.25).sqrt())])
    };
    near("small bead", &bead(0.7), PI / 6.0);
    near("large bead", &bead(1.9), PI / 6.0);
    let cube = part(Cuboid::new(Vec3::NEG_ONE, Vec3::ONE));
    near("frame", &solid(Difference, &[cube.clone(), ball(0.0, 1.2)]), 1.616_284);
    // Half spaces: an eighth of a ball.
    let below = |axis: DVec3| part(Plane::new(axis, 0.0));
    let eighth = [ball(0.0, 1.0), below(DVec3::X), below(DVec3::Y), below(-DVec3::Z)];
    near("an eighth", &solid(Intersection, &eighth), PI / 6.0);
    near(
        "seven eighths",
        &solid(Difference, &[ball(0.0, 1.0), part(solid(Intersection, &eighth))]),
        7.0 * PI / 6.0,
    );
}

/// A random solid of operations within operations.
fn random(s: &Stream, k: &mut u32, depth: u32) -> Vec<SolidPart> {
    let mut u = || {
        *k += 1;
        s.uniform(*k)
    };
    if depth == 0 || u() < 0.1 {
        let mut v = || Vec3::new(u(), u(), u());
        let turn =
            DQuat::from_rotation_y(f64::from(v().x) * 6.0) * DQuat::from_rotation_x(f64::from(v().y) * 6.0);
        let map = DAffine3::from_rotation_translation(turn, (v() - 0.5).as_dvec3() * 1.6);
        let size = 0.4 + v().x;
        return match (v().x * 4.0) as u32 {
            0 => placed(Sphere::new(Vec3::ZERO, size), map),
            1 => placed(Cuboid::new(Vec3::splat(-0.8 * size), Vec3::splat(0.7 * size)), map),
            2 => placed(Cone::new(Vec3::ZERO, size * Vec3::Y, size, 0.3 * size, true).unwrap(), map),
            _ => placed(Torus::new(Vec3::ZERO, Vec3::Y, size, 0.4 * size).unwrap(), map),
        };
    }
    let operation = [Union, Intersection, Difference][((u() * 3.0) as usize).min(2)];
    let operands = [random(s, k, depth - 1), random(s, k, depth - 1)];
    part(solid(operation, &operands))
}

/// Laws of sets, as the same crossings to the bit.
#[test]
fn the_algebra_of_sets_holds() {
    let all = || part(Cuboid::new(Vec3::splat(-9.0), Vec3::splat(9.0)));
    let mut different = 0;
    for tree in 0..12 {
        let s = Stream::new(43, [tree, 0], 0);
        let mut k = 0;
        let [a, b, c] = [6, 5, 4].map(|depth| random(&s, &mut k, depth));
        let of =
            |operation, operands: [&Vec<SolidPart>; 2]| part(solid(operation, &operands.map(Clone::clone)));
        let (or, and, minus) = (
            |x: &_, y: &_| of(Union, [x, y]),
            |x: &_, y: &_| of(Intersection, [x, y]),
            |x: &_, y: &_| of(Difference, [x, y]),
        );
        let (once, twice) = (false, true);
        let laws = [
            (
                "De Morgan, union",
                once,
                minus(&all(), &or(&a, &b)),
                and(&minus(&all(), &a), &minus(&all(), &b)),
            ),
            (
                "De Morgan, intersection",
                once,
                minus(&all(), &and(&a, &b)),
                or(&minus(&all(), &a), &minus(&all(), &b)),
            ),
            ("associativity", once, or(&a, &or(&b, &c)), or(&or(&a, &b), &c)),
            ("distributivity", twice, and(&a, &or(&b, &c)), or(&and(&a, &b), &and(&a, &c))),
            (
                "distributivity of differences",
                twice,
                minus(&or(&a, &b), &c),
                or(&minus(&a, &c), &minus(&b, &c)),
            ),
            ("idempotence", twice, or(&a, &a), solid_of(&a)),
            ("absorption", twice, or(&a, &and(&a, &b)), solid_of(&a)),
        ];
        for (name, twice, left, right) in &laws {
            let [left, right] = [left, right].map(|parts| solid(Union, std::slice::from_ref(parts)));
            for i in 0..10_000 {
                let ray = line(i);
                let (left, right) = (crossings(&left, &ray), crossings(&right, &ray));
                // Of a face that is there twice and another one that cannot be told from it, either may be named.
                let agree = if *twice { left.len() == right.len() } else { left == right };
                assert!(agree, "{name}, tree {tree}, ray {i}: {left:?} {right:?}");
                different += u32::from(left != right);
            }
        }
        let nothing = solid(Difference, &[a.clone(), a.clone()]);
        assert!((0..10_000).all(|i| nothing.hit(&line(i)).is_none()), "tree {tree} less itself");
    }
    assert!(different < 20, "{different} of 840,000 rays name another of two faces");
}

/// Operands that move are at each moment where they would be at rest, to the bit.
#[test]
fn operands_move_as_if_they_stood_still_at_each_moment() {
    let shutter = Shutter::new(0.25, 1.5);
    let mut met = 0;
    for tree in 0..12 {
        let s = Stream::new(101, [tree, 0], 0);
        let mut k = 0;
        let parts = [random(&s, &mut k, 3), random(&s, &mut k, 2), part(Plane::new(DVec3::Y, 0.3))];
        let key = |axis: DVec3, angle: f64, to: DVec3| {
            DAffine3::from_rotation_translation(DQuat::from_axis_angle(axis.normalize(), angle), to)
        };
        let motions = [
            Motion::still(key(DVec3::ONE, 0.4, DVec3::X * 0.1)),
            Motion::keyed(
                Keyframes::new(&[
                    (0.0, key(DVec3::Z, 0.0, DVec3::ZERO)),
                    (0.8, key(DVec3::Z, 1.2, DVec3::new(0.5, 0.1, -0.2))),
                    (2.0, key(DVec3::X, 2.0, DVec3::new(-0.4, 0.3, 0.1))),
                ])
                .unwrap(),
            ),
            Motion::keyed(
                Keyframes::new(&[(0.0, DAffine3::IDENTITY), (1.0, key(DVec3::X, 0.7, DVec3::Y))]).unwrap(),
            ),
        ];
        for operation in [Union, Intersection, Difference] {
            let of = |map: &dyn Fn(&Motion) -> Motion| {
                // Under one motion more, as a solid within a solid is.
                let outer = map(&motions[1]);
                let inner = parts.iter().zip(&motions).map(|(parts, motion)| {
                    let moved =
                        |part: &SolidPart| SolidPart { map: map(motion).then(&part.map), ..part.clone() };
                    parts.iter().map(moved).collect()
                });
                let inner = Csg::new(operation, &inner.collect::<Vec<_>>()).unwrap();
                let nested = vec![SolidPart { shape: inner.into(), map: outer, material: None, source: 0 }];
                let mut solid = Csg::new(Difference, &[nested, ball(0.2, 0.4)]).unwrap();
                solid.expose(shutter);
                solid
            };
            let moving = of(&Motion::clone);
            assert!(moving.moves() && moving.has_moving_parts());
            for step in 0..=4u8 {
                let time = f32::from(step) / 4.0;
                let moment = shutter.open + f64::from(time) * (shutter.close - shutter.open);
                let still = of(&|motion| Motion::still(motion.at(moment)));
                assert!(!still.moves() && !still.has_moving_parts());
                let part = [0.25 * f64::from(step.saturating_sub(1)), 0.25 * f64::from(step)];
                let bounds = moving.bounds_during(part).padded(1e-5);
                for i in 0..400 {
                    let ray = Ray { time, ..line(i) };
                    let [found, expected] = [&moving, &still].map(|solid| {
                        let mut found = Vec::new();
                        solid.crossings(&ray, |hit| found.push((hit, solid.surface_at(&ray, &hit))));
                        found
                    });
                    assert_eq!(found.len(), expected.len(), "tree {tree}, {operation:?} at {time}, ray {i}");
                    for ((a, at_a), (b, at_b)) in found.iter().zip(&expected) {
                        assert_eq!((a.t, a.part), (b.t, b.part));
                        assert_eq!((at_a.p, at_a.n), (at_b.p, at_b.n));
                        assert!(bounds.contains(at_a.p), "{} at {time}", at_a.p);
                        met += 1;
                    }
                }
            }
        }
    }
    assert!(met > 40_000, "{met}");
}

/// What of a leaf shows changes with the time of a ray, wherever the leaf's patches are then.
#[test]
fn the_surface_shows_where_the_leaves_have_moved() {
    let there = DAffine3::from_translation(DVec3::X);
    let slides = Motion::keyed(Keyframes::new(&[(0.0, DAffine3::IDENTITY), (1.0, there)]).unwrap());
    let hole = SolidPart { map: slides, ..ball(0.0, 0.5)[0].clone() };
    let plane = part(Plane::new(DVec3::Y, 0.0));
    let solid = solid(Difference, &[ball(0.0, 2.0), vec![hole], plane]);
    for (time, x, shows) in [(0.0, 0.0, false), (0.0, 0.6, true), (1.0, 0.6, false), (1.0, 0.0, true)] {
        assert_eq!(solid.shows(2, Vec3::new(x, 0.0, 0.0), time), shows, "{x} at {time}");
    }
    // The wall of the hole, and where it was when the shutter opened.
    let p = Vec3::new(1.0, 0.5, 0.0);
    assert!(solid.shows(1, p, 1.0));
    let motion = solid.part_motion(1).unwrap();
    assert_eq!(motion.carried(p, [1.0, 0.0]), Vec3::new(0.0, 0.5, 0.0));
    assert!(solid.part_motion(0).is_none() && solid.part_motion(2).is_none());
}

/// What is taken away is told whole and with whose it is, however deep, and where it is when the shutter opens.
#[test]
fn what_is_taken_away_is_told_whole() {
    let of = |source: u32, x: f64| {
        let map = Motion::still(DAffine3::from_translation(x * DVec3::X));
        vec![SolidPart { source, map, ..ball(0.0, 0.5)[0].clone() }]
    };
    let inner = part(solid(Difference, &[of(1, 0.0), of(2, 0.4)]));
    let there = DAffine3::from_translation(DVec3::Y);
    let slides = Motion::keyed(Keyframes::new(&[(0.0, there), (1.0, DAffine3::IDENTITY)]).unwrap());
    let moving = vec![SolidPart { source: 3, map: slides, ..ball(0.0, 0.5)[0].clone() }];
    // What is taken from what is taken away is not.
    let solid = solid(Difference, &[of(4, 0.0), inner, moving]);
    let told: Vec<_> = solid.subtracted(32).collect();
    assert_eq!(told.iter().map(|(source, _)| *source).collect::<Vec<_>>(), [1, 3]);
    for ((_, triangles), center) in told.iter().zip([Vec3::ZERO, Vec3::Y]) {
        assert!(triangles.faces.len() > 500);
        assert!(triangles.positions.iter().all(|p| (p.distance(center) - 0.5).abs() < 1e-5));
    }
}

fn solid_of(parts: &[SolidPart]) -> Vec<SolidPart> {
    part(solid(Union, &[parts.to_vec()]))
}

/// Ways in and out take turns, normals point out, and no two crossings are nearer than they are known.
#[test]
fn what_is_entered_is_left() {
    for tree in 0..20 {
        let random = random(&Stream::new(47, [tree, 0], 0), &mut 0, 6);
        let solid = solid(Union, &[random]);
        for i in 0..5000 {
            let ray = line(i);
            let mut inside = false;
            let mut last = f32::NEG_INFINITY;
            solid.crossings(&ray, |hit| {
                let n = solid.surface_at(&ray, &hit).ng;
                assert!(n.dot(ray.d) < 2e-3 || inside, "{n} where ray {i} enters tree {tree}");
                assert!(n.dot(ray.d) > -2e-3 || !inside, "{n} where ray {i} leaves tree {tree}");
                assert!(hit.t > last);
                (inside, last) = (!inside, hit.t);
            });
            assert!(!inside, "ray {i} stays in tree {tree}");
        }
    }
}

/// A solid less itself moved by next to nothing leaves slivers that are thicker than their error, or none.
#[test]
fn almost_the_same_leaves_no_speckles() {
    let shapes: [AnyShape; 3] = [
        Sphere::new(Vec3::ZERO, 1.0).into(),
        Cuboid::new(Vec3::NEG_ONE, Vec3::ONE).into(),
        Torus::new(Vec3::ZERO, Vec3::Y, 1.0, 0.4).unwrap().into(),
    ];
    for shape in shapes {
        for moved in [0.0, 1e-12, 1e-9, 1e-7, 1e-6, 1e-5] {
            let other =
                placed(shape.clone(), DAffine3::from_translation(DVec3::new(0.6, 0.64, 0.48) * moved));
            let sliver = solid(Difference, &[part(shape.clone()), other]);
            for i in 0..50_000 {
                let ray = line(i);
                let found = crossings(&sliver, &ray);
                assert!(found.len().is_multiple_of(2));
                assert!(moved >= 1e-7 || found.is_empty(), "{} {moved}: {found:?}", shape.name());
                assert!(found.iter().all(|t| t.is_finite()));
                assert!(
                    found.windows(2).all(|pair| pair[1] - pair[0] > 1e-6),
                    "{} {moved}: {found:?}",
                    shape.name()
                );
            }
        }
    }
}

#[test]
fn only_solids_can_be_operands() {
    let open = Cone::new(Vec3::ZERO, Vec3::Y, 1.0, 1.0, false).unwrap();
    let error = Csg::new(Union, &[ball(0.0, 1.0), part(open)]).unwrap_err();
    assert_eq!(error, CsgError::NotClosed { operand: 1, part: 0 });
    assert_eq!(Csg::new(Union, &[]).unwrap_err(), CsgError::Empty);
    assert_eq!(Csg::new(Difference, &[vec![], ball(0.0, 1.0)]).unwrap().bounds(), Aabb::EMPTY);
    let flat = DAffine3::from_scale(DVec3::new(1.0, 0.0, 1.0));
    assert_eq!(
        Csg::new(Union, &[placed(Sphere::new(Vec3::ZERO, 1.0), flat)]).unwrap_err(),
        CsgError::NoInverse
    );
}

/// Points of the leaves show where they are on the surface, which is where a ray along the normal meets it.
#[test]
fn the_surface_is_what_shows_of_the_leaves() {
    let cube = part(Cuboid::new(Vec3::NEG_ONE, Vec3::ONE));
    let rings = [Vec3::X, Vec3::Y].map(|axis| part(Torus::new(Vec3::ZERO, axis, 1.0, 0.3).unwrap()));
    let operands = [part(solid(Union, &[cube, rings[0].clone()])), ball(0.3, 1.2), rings[1].clone()];
    let solid = solid(Difference, &operands);
    let (mut shown, mut hidden, mut different) = (0, 0, 0);
    solid.patches(|part, patch| {
        for i in 0..400 {
            let s = Stream::new(59, [i, part], 0);
            let Some(drawn) = patch.sample_area(Vec2::new(s.uniform(0), s.uniform(1))) else { continue };
            let drawn = drawn.at;
            let shows = solid.shows(part, drawn.p, 0.0);
            let n = if solid.is_inverted(part) { -drawn.n } else { drawn.n };
            let ray = Ray::new(drawn.p + 0.01 * n, -n).over(-1.0, 1.0);
            let mut met = false;
            solid.crossings(&ray, |hit| met |= (hit.t - 0.01).abs() < 1e-4 && hit.part == part);
            different += u32::from(shows != met);
            *(if shows { &mut shown } else { &mut hidden }) += 1;
        }
    });
    assert!(shown > 500 && hidden > 500, "{shown} {hidden}");
    // Where two surfaces meet another one is nearer than its points are known.
    assert!(different < 5, "{different}");
}

/// Of many leaves, those that hold a point decide whether it is for another one to say if the result does.
#[test]
fn many_leaves_say_which_of_them_shows() {
    const LEAVES: u32 = 60;
    let center = |i: u32| {
        let s = Stream::new(83, [i, 0], 0);
        Vec3::new(s.uniform(0), s.uniform(1), s.uniform(2))
    };
    let ball = |i: u32| part(Sphere::new(center(i), 0.25));
    let halves = [0, LEAVES / 2].map(|first| (first..first + LEAVES / 2).flat_map(ball).collect());
    let solid = solid(Difference, &halves);
    let (mut shown, mut unclear) = (0, 0);
    for k in 0..5000 {
        let s = Stream::new(89, [k, 0], 0);
        let (leaf, p) = (k % LEAVES, Vec3::new(s.uniform(0), s.uniform(1), s.uniform(2)));
        let near = |i: u32| (center(i).distance(p) - 0.25).abs() < 1e-5;
        if (0..LEAVES).any(near) {
            unclear += 1;
            continue;
        }
        let any = |mut of: std::ops::Range<u32>| of.any(|i| i != leaf && center(i).distance(p) < 0.25);
        let expected = if leaf < LEAVES / 2 {
            !any(0..LEAVES / 2) && !any(LEAVES / 2..LEAVES)
        } else {
            any(0..LEAVES / 2) && !any(LEAVES / 2..LEAVES)
        };
        assert_eq!(solid.shows(leaf, p, 0.0), expected, "leaf {leaf} at {p}");
        shown += u32::from(expected);
    }
    assert!(shown > 500 && unclear < 50, "{shown} {unclear}");
}
