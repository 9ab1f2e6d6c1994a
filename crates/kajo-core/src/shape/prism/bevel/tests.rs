//! Bevelled prisms against closed forms, and against distances by brute force.

use kajo_math::{Ray, Vec3, rng::Stream, warp};

use super::super::tests::{crossings, mixed, polygon, upright, volume};
use super::*;
use crate::shape::{FillRule, Path, Prism, Surface, Sweep};

fn bevelled(contours: &[Path<DVec2>], depth: f64, width: f64, profile: BevelProfile) -> Prism {
    ruled(contours, FillRule::NonZero, depth, Bevel { width, profile })
}

fn ruled(contours: &[Path<DVec2>], rule: FillRule, depth: f64, bevel: Bevel) -> Prism {
    Prism::new(Sweep { bevel: Some(bevel), ..upright(depth, 1.0, rule) }, contours).unwrap()
}

fn square() -> [Path<DVec2>; 1] {
    [polygon(&[[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]])]
}

/// What is left of a square at each height is a square.
#[test]
fn volumes_are_those_of_eroded_squares() {
    const STEPS: u32 = 20_000;
    let volume_of = |depth: f64, width: f64, inset: &dyn Fn(f64) -> f64| {
        let step = depth / f64::from(STEPS);
        let area = |i: u32| {
            let z = (f64::from(i) + 0.5) * step;
            let h = z.min(depth - z);
            (1.0 - 2.0 * if h < width { inset(h) } else { 0.0 }).max(0.0).powi(2)
        };
        (0..STEPS).map(area).sum::<f64>() * step
    };
    let closed_form = 0.3 + (1.0 - 0.8_f64.powi(3)) / 3.0;
    let chamfer = volume(&bevelled(&square(), 0.5, 0.1, BevelProfile::Chamfer));
    assert!((chamfer / closed_form - 1.0).abs() < 5e-4, "{chamfer} for {closed_form}");
    // Two pyramids: bevels meet in ridges.
    let roof = volume(&bevelled(&square(), 2.0, 0.6, BevelProfile::Chamfer));
    let expected = 0.8 + 1.0 / 3.0;
    assert!((roof / expected - 1.0).abs() < 5e-4, "{roof} for {expected}");
    for (depth, width) in [(0.5, 0.1), (0.5, 0.25), (1.4, 0.7)] {
        let round = volume(&bevelled(&square(), depth, width, BevelProfile::Round));
        let expected =
            volume_of(depth, width, &|h| width - (width * width - (width - h) * (width - h)).max(0.0).sqrt());
        assert!((round / expected - 1.0).abs() < 5e-4, "{round} for {expected} of {width}");
    }
}

/// Bars laid over each other are bevelled as the cross that they are.
#[test]
fn what_others_fill_is_no_border() {
    let bars = [
        polygon(&[[-0.9, -0.2], [0.9, -0.2], [0.9, 0.2], [-0.9, 0.2]]),
        polygon(&[[-0.2, -0.7], [0.2, -0.7], [0.2, 0.7], [-0.2, 0.7]]),
    ];
    let outline: Vec<[f64; 2]> = vec![
        [0.9, -0.2],
        [0.9, 0.2],
        [0.2, 0.2],
        [0.2, 0.7],
        [-0.2, 0.7],
        [-0.2, 0.2],
        [-0.9, 0.2],
        [-0.9, -0.2],
        [-0.2, -0.2],
        [-0.2, -0.7],
        [0.2, -0.7],
        [0.2, -0.2],
    ];
    for profile in [BevelProfile::Chamfer, BevelProfile::Round] {
        let [laid, cut] = [&bars[..], &[polygon(&outline)]].map(|all| bevelled(all, 0.5, 0.12, profile));
        let mut met = 0;
        for i in 0..4000 {
            let ray = line(i);
            let [a, b] = [&laid, &cut].map(|prism| crossings(prism, &ray));
            assert_eq!(a.len(), b.len(), "{profile:?} ray {i}: {a:?} {b:?}");
            met += a.len();
            for (a, b) in a.iter().zip(&b) {
                assert!((a.0 - b.0).abs() < 1e-4, "{profile:?} ray {i}: {a:?} {b:?}");
            }
        }
        assert!(met > 2000, "{met}");
    }
}

/// A line through a random point near the prism.
fn line(i: u32) -> Ray {
    let s = Stream::new(5, [i, 0], 0);
    let u = |k| kajo_math::Vec2::new(s.uniform(k), s.uniform(k + 1));
    let through = Vec3::new(2.0 * s.uniform(0) - 1.0, 2.0 * s.uniform(1) - 1.0, 0.6 * s.uniform(2) - 0.05);
    let d = warp::uniform_sphere(u(3));
    Ray::new(through - 4.0 * d, d)
}

/// The distance to an outline by many points of it.
fn distance(contours: &[Path<DVec2>], q: DVec2) -> f64 {
    const STEPS: u32 = 400;
    let curves = contours.iter().flat_map(Path::curves);
    let points = curves.flat_map(|curve| (0..=STEPS).map(|i| curve.at(f64::from(i) / f64::from(STEPS))));
    points.fold(f64::INFINITY, |least, at| least.min(at.distance(q)))
}

/// Along random lines, what is inside by crossings against what is inside by distances.
#[test]
fn crossings_are_where_distances_say() {
    const WIDTH: f64 = 0.13;
    let contours = mixed();
    for profile in [BevelProfile::Chamfer, BevelProfile::Round] {
        let bevel = Bevel { width: WIDTH, profile };
        let prism = ruled(&contours, FillRule::EvenOdd, 0.5, bevel);
        let mut on_bevel = 0;
        for i in 0..150 {
            let ray = line(i);
            let found = crossings(&prism, &ray);
            assert!(found.len().is_multiple_of(2), "{found:?}");
            on_bevel += found.iter().filter(|(_, part)| *part >= prism.part_count() - 2).count();
            for k in 0..200 {
                let t = 3.0 + 0.01 * f64::from(k);
                let at = ray.o.as_dvec3() + t * ray.d.as_dvec3();
                let end = at.z.min(0.5 - at.z);
                let is_filled = end > 0.0 && prism.0.winding(at.truncate()) % 2 != 0;
                let depth =
                    if is_filled { bevel.depth(distance(&contours, at.truncate()), end) } else { -1.0 };
                // Points of the outline are up to 0.003 apart.
                if depth.abs() < 5e-3 || end.abs() < 1e-6 {
                    continue;
                }
                let inside = found.iter().filter(|(crossing, _)| *crossing < t).count() % 2 == 1;
                assert_eq!(inside, depth > 0.0, "{profile:?} ray {i} at {t}: {depth}, {found:?}");
            }
        }
        assert!(on_bevel > 50, "{on_bevel}");
    }
}

/// Points are on the surface, normals are its gradient, and tangents are across them.
#[test]
fn normals_and_tangents_belong_to_the_surface() {
    let prism = bevelled(&mixed(), 0.5, 0.1, BevelProfile::Round);
    let edge = prism.0.edge.as_ref().unwrap();
    let depth = |at: DVec3| prism.0.bevel_depth(edge, at);
    let mut checked = 0;
    for i in 0..3000 {
        let ray = line(i);
        prism.crossings(&ray, |hit| {
            if hit.part < prism.part_count() - 2 {
                return;
            }
            let at = prism.surface_at(&ray, &hit);
            let at64 = at.p.as_dvec3();
            assert!(depth(at64).abs() < 1e-6, "{i}: {}", depth(at64));
            const STEP: f64 = 1e-5;
            let slope = |axis: DVec3| (depth(at64 - STEP * axis) - depth(at64 + STEP * axis)) / (2.0 * STEP);
            let gradient = DVec3::new(slope(DVec3::X), slope(DVec3::Y), slope(DVec3::Z));
            let end = at64.z.min(0.5 - at64.z);
            // Where two parts of the outline are equally near, or the bevel begins, it has no one gradient.
            if (gradient.length() - 1.0).abs() < 1e-4 && end < 0.099 {
                assert!(at.n.as_dvec3().distance(gradient) < 1e-3, "{i}: {} for {gradient}", at.n);
                let tangents = prism.tangents_at(&hit, at.p);
                for tangent in [tangents.dpdu, tangents.dpdv] {
                    let across = tangent.normalize().dot(at.n).abs();
                    assert!(across < 1e-3 || end > 0.0999, "{i}: {across}");
                }
                checked += 1;
            }
        });
    }
    assert!(checked > 200, "{checked}");
}

#[test]
fn bevels_without_room_are_none() {
    let of = |depth: f64, taper: f64, width: f64| {
        let bevel = Some(Bevel { width, profile: BevelProfile::Chamfer });
        Prism::new(Sweep { bevel, ..upright(depth, taper, FillRule::NonZero) }, &square())
    };
    assert!(of(0.5, 1.0, 0.25).is_some());
    for (depth, taper, width) in [(0.5, 1.0, 0.26), (0.5, 0.5, 0.1), (0.5, 1.0, 0.0), (0.5, 1.0, f64::NAN)] {
        assert!(of(depth, taper, width).is_none(), "{depth} {taper} {width}");
    }
}
