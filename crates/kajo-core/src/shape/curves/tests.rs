use kajo_math::rng::Stream;
use kajo_math::warp;

use super::*;
use crate::shape::Cone;

const BASES: [CurveBasis; 4] =
    [CurveBasis::Linear, CurveBasis::Bezier, CurveBasis::BSpline, CurveBasis::CatmullRom];

fn strands(points: &[[f32; 3]], radii: &[f32]) -> Strands {
    let points: Vec<Vec3> = points.iter().copied().map(Vec3::from_array).collect();
    let ends = vec![points.len() as u32];
    Strands { points, radii: radii.to_vec(), ends }
}

/// Two bends in space, each wider than the tube.
fn bent() -> Strands {
    let points = [
        [-1.0, -0.6, 0.2],
        [-0.6, 0.5, -0.4],
        [0.1, 0.9, 0.3],
        [0.6, 0.1, 0.6],
        [0.4, -0.7, 0.1],
        [-0.2, -0.9, -0.6],
        [-0.9, -0.5, -0.9],
    ];
    strands(&points, &[0.16, 0.12, 0.1, 0.05, 0.12, 0.09, 0.02])
}

fn point(s: &Stream, k: u32) -> Vec3 {
    Vec3::from_array([k, k + 1, k + 2].map(|k| 2.0 * s.uniform(k) - 1.0))
}

fn random_ray(i: u32, reach: f32) -> Ray {
    let s = Stream::new(29, [i, 0], 0);
    let d = warp::uniform_sphere(Vec2::new(s.uniform(3), s.uniform(4)));
    Ray::new(reach * point(&s, 0) - 3.0 * d, d)
}

fn all_crossings(curves: &Curves, ray: &Ray) -> Vec<Hit> {
    let mut found = Vec::new();
    curves.crossings(ray, |hit| found.push(hit));
    found.sort_by(|a, b| a.t.total_cmp(&b.t));
    found
}

/// Places of a strand, `n` in each segment, and its end.
fn points(curves: &Curves, n: u32) -> Vec<CurvePoint> {
    let parts = &*curves.0;
    let leaves = parts.leaves.iter().filter(|leaf| leaf.kind != LeafKind::Corner && leaf.span == 0);
    let segments: Vec<CurveSpan> = leaves.map(|leaf| parts.segment(leaf.node)).collect();
    let inner = segments.iter().flat_map(|segment| (0..n).map(|i| segment.at(f64::from(i) / f64::from(n))));
    inner.chain(segments.last().map(|segment| segment.at(1.0))).collect()
}

/// Whether a point is nearer to a curve than its radius, beside the curve and not beyond its ends; `None` where that cannot be told
/// from points this far from each other.
fn is_inside(points: &[CurvePoint], q: DVec3) -> Option<bool> {
    let n = points.len();
    let (i, nearest) = points
        .iter()
        .enumerate()
        .min_by(|a, b| a.1.p.distance_squared(q).total_cmp(&b.1.p.distance_squared(q)))?;
    let off = nearest.p.distance(q) - nearest.r;
    let beyond = (q - nearest.p).dot(nearest.m.normalize());
    let at_end = (i == 0 && beyond < 0.0) || (i == n - 1 && beyond > 0.0);
    (off.abs() > 2e-3 && !(at_end && beyond.abs() < 2e-3)).then_some(off < 0.0 && !at_end)
}

/// Between two crossings a ray is inside if it has crossed an odd number of times before, against the distance from the curve.
#[test]
fn tubes_are_where_their_curves_are_near() {
    for basis in &BASES[1..] {
        let curves = Curves::new(&bent(), *basis, CurveForm::Tube).unwrap();
        let points = points(&curves, 200);
        let mut checked = 0;
        for i in 0..400 {
            let ray = random_ray(i, 0.8);
            let hits = all_crossings(&curves, &ray);
            assert!(hits.len().is_multiple_of(2), "{basis:?}, ray {i}: {hits:?}");
            for k in 0..120 {
                let t = 1.0 + 0.035 * k as f32;
                let expected = is_inside(&points, ray.at(t).as_dvec3());
                let before = hits.iter().filter(|hit| hit.t < t).count();
                if let Some(expected) = expected {
                    assert_eq!(before % 2 == 1, expected, "{basis:?}, ray {i} at {t}: {hits:?}");
                    checked += u32::from(expected);
                }
            }
            for hit in hits.iter().filter(|hit| !CAPS.contains(&hit.u)) {
                let p = curves.surface_at(&ray, hit).p.as_dvec3();
                let (point, ..) = curves.0.point_at(&curves.0.leaves[hit.part as usize], hit, p);
                let off = p.distance(point.p) - point.r;
                assert!(off.abs() < 2e-7 && (p - point.p).dot(point.m).abs() < 2e-6, "{off}");
            }
        }
        assert!(checked > 300, "{basis:?}: {checked}");
    }
}

/// All kinds of curves through points on a line are the same cone.
#[test]
fn straight_tubes_are_cones() {
    let (a, b) = (Vec3::new(0.1, -0.6, 0.2), Vec3::new(-0.3, 0.6, 0.5));
    let points: Vec<[f32; 3]> = (0..7).map(|i| a.lerp(b, i as f32 / 6.0).to_array()).collect();
    for (r0, r1) in [(0.25, 0.25), (0.3, 0.05), (0.2, 0.0)] {
        let radii: Vec<f32> = (0..7).map(|i| r0 + (r1 - r0) * i as f32 / 6.0).collect();
        let cone = Cone::new(a, b, r0, r1, true).unwrap();
        for basis in BASES {
            let curves = Curves::new(&strands(&points, &radii), basis, CurveForm::Tube).unwrap();
            let mut hits = 0;
            for i in 0..40_000 {
                let ray = random_ray(i, 0.7);
                match (curves.hit(&ray), cone.hit(&ray)) {
                    (Some(x), Some(y)) if (x.t - y.t).abs() < 4e-6 => {
                        hits += 1;
                        let (p, q) = (curves.surface_at(&ray, &x), cone.surface_at(&ray, &y));
                        // Not at the edge of a cap, where either is right.
                        let agree = p.n.distance(q.n) < 1e-4
                            || (q.p - b).length().min((q.p - a).length()) > 0.99 * r1;
                        assert!(agree, "{basis:?}, ray {i}: {} for {}", p.n, q.n);
                    }
                    (None, None) => {}
                    (x, y) => {
                        // They may differ by the rounding of the points.
                        let near = Ray { o: ray.o + 1e-5 * warp::basis(ray.d).0, ..ray };
                        let (x, y) = (x.or(curves.hit(&near)), y.or(cone.hit(&near)));
                        let off = x.zip(y).map(|(x, y)| (x.t - y.t).abs());
                        assert!(off.is_none_or(|off| off < 1e-2), "{basis:?}, ray {i}: {x:?} for {y:?}");
                    }
                }
            }
            assert!(hits > 5000, "{basis:?}: {hits}");
        }
    }
}

/// Rays that are exactly across a straight tube and exactly along it.
#[test]
fn rays_along_the_axes_are_no_exception() {
    let points = [[0.0, -1.0, 0.0], [0.0, -0.5, 0.0], [0.0, 0.5, 0.0], [0.0, 1.0, 0.0]];
    for basis in BASES {
        let curves = Curves::new(&strands(&points, &[0.25; 4]), basis, CurveForm::Tube).unwrap();
        let found = all_crossings(&curves, &Ray::new(Vec3::new(0.0, 0.25, -3.0), Vec3::Z));
        let ts: Vec<f32> = found.iter().map(|hit| hit.t).collect();
        assert_eq!(ts, [2.75, 3.25], "{basis:?}");
        // Exactly on the plane between two spans.
        let found = all_crossings(&curves, &Ray::new(Vec3::new(0.0, -0.5, -3.0), Vec3::Z));
        assert_eq!(found.len(), 2, "{basis:?}: {found:?}");
        let found = all_crossings(&curves, &Ray::new(Vec3::new(0.1, -3.0, 0.1), Vec3::Y));
        let ts: Vec<f32> = found.iter().map(|hit| hit.t).collect();
        assert_eq!(ts, [2.0, 4.0], "{basis:?}");
        assert_eq!(all_crossings(&curves, &Ray::new(Vec3::new(0.25, -3.0, 0.0), Vec3::Y)).len() % 2, 0);
        let ribbon = Curves::new(&strands(&points, &[0.25; 4]), basis, CurveForm::Ribbon).unwrap();
        for y in [-0.5, 0.25] {
            let found = all_crossings(&ribbon, &Ray::new(Vec3::new(0.1, y, -3.0), Vec3::Z));
            assert!(!found.is_empty() && found.iter().all(|hit| hit.t == 3.0), "{basis:?}: {found:?}");
        }
    }
}

/// A million rays at the planes between spans: none goes through, and each leaves as often as it enters.
#[test]
fn there_are_no_gaps_between_pieces() {
    for (form, basis) in [CurveForm::Tube, CurveForm::Ribbon]
        .into_iter()
        .flat_map(|form| BASES[1..].iter().map(move |b| (form, *b)))
    {
        let curves = Curves::new(&bent(), basis, form).unwrap();
        let parts = &*curves.0;
        let inner: Vec<CurveSpan> = parts
            .leaves
            .iter()
            .skip(1)
            .filter(|leaf| leaf.kind != LeafKind::Corner)
            .map(|leaf| parts.span(leaf))
            .collect();
        for i in 0..170_000_u32 {
            let s = Stream::new(31, [i, 0], 0);
            let end = &inner[i as usize % inner.len()].ends[0];
            let d = warp::uniform_sphere(Vec2::new(s.uniform(0), s.uniform(1)));
            let (x, y) = basis64(end.axis.normalize());
            let (sin, cos) = fmath::sincos64(TAU * f64::from(s.uniform(2)));
            let (target, rise) = match form {
                CurveForm::Tube => {
                    let r = 0.98 * end.r * f64::from(s.uniform(3)).sqrt();
                    (end.p + r * (cos * x + sin * y), 0.0)
                }
                CurveForm::Ribbon => {
                    let across = end.axis.cross(d.as_dvec3());
                    let seen = across.length() / end.axis.length();
                    let off = 0.98 * end.r * f64::from(2.0 * s.uniform(3) - 1.0);
                    (end.p + off * across.normalize(), 1.0 - seen)
                }
            };
            // Seen along itself a bend may be too tight for its width.
            if rise > 0.3 {
                continue;
            }
            let ray = Ray::new((target - 3.0 * d.as_dvec3()).as_vec3(), d);
            let found = all_crossings(&curves, &ray);
            // What is there begins before the place that is aimed at; a ribbon is a little before or behind.
            let slack = if form == CurveForm::Tube { 1e-3 } else { 0.1 };
            let stopped = found.iter().any(|hit| hit.t < 3.0 + slack);
            assert!(stopped, "{form:?} {basis:?}: ray {i} goes through: {found:?}");
            // At a corner of Béziers a ball is met as well.
            let even =
                form == CurveForm::Ribbon || basis == CurveBasis::Bezier || found.len().is_multiple_of(2);
            assert!(even, "{form:?} {basis:?}: ray {i}: {found:?}");
        }
    }
}

/// The nearest points of a curve seen along a ray, by a fine subdivision of it.
#[test]
fn ribbons_are_what_is_near_to_the_curve_as_it_is_seen() {
    for basis in &BASES[1..] {
        let curves = Curves::new(&bent(), *basis, CurveForm::Ribbon).unwrap();
        let points = points(&curves, 400);
        let (mut met, mut missed) = (0, 0);
        for i in 0..6000 {
            let ray = random_ray(i, 0.9);
            let (o, d) = (ray.o.as_dvec3(), ray.d.as_dvec3().normalize());
            let off = |p: DVec3| (p - o - (p - o).dot(d) * d).length();
            let inner = points.windows(3).filter(|w| off(w[1].p) <= off(w[0].p) && off(w[1].p) < off(w[2].p));
            let near: Vec<f64> = inner.map(|w| off(w[1].p) / w[1].r).collect();
            if near.iter().any(|ratio| (ratio - 1.0).abs() < 0.02) {
                continue;
            }
            let expected = near.iter().filter(|ratio| **ratio < 1.0).count();
            let found = all_crossings(&curves, &ray);
            // Where a curve is seen along itself, points beside each other count twice.
            assert_eq!(found.is_empty(), expected == 0, "{basis:?}, ray {i}: {found:?} for {near:?}");
            for hit in &found {
                let at = curves.surface_at(&ray, hit);
                assert!(at.p.distance(ray.at(hit.t)) < 1e-5 && at.n.dot(ray.d) < 0.0);
                let uv = curves.uv_at(hit, at.p);
                assert!((0.0..=1.0).contains(&uv.x) && (0.0..=1.0).contains(&uv.y), "{uv}");
            }
            if expected > 0 { met += 1 } else { missed += 1 }
        }
        assert!(met > 500 && missed > 500, "{met} {missed}");
    }
}

/// Light that leaves a ribbon is not met by the place that it leaves, on neither side.
#[test]
fn nothing_meets_the_ribbon_that_it_leaves() {
    use crate::interaction::RayOffset;
    let points = [[-1.0, 0.0, 0.0], [-0.3, 0.05, 0.0], [0.3, -0.05, 0.0], [1.0, 0.0, 0.0]];
    let ribbon = Curves::new(&strands(&points, &[0.1; 4]), CurveBasis::BSpline, CurveForm::Ribbon).unwrap();
    let mut left = 0;
    for i in 0..20_000 {
        let ray = random_ray(i, 0.6);
        let Some(hit) = ribbon.hit(&ray) else { continue };
        let at = ribbon.surface_at(&ray, &hit);
        let s = Stream::new(37, [i, 0], 0);
        let d = warp::uniform_sphere(Vec2::new(s.uniform(0), s.uniform(1)));
        let away = at.ray_towards(d, f32::INFINITY, 0.0, RayOffset::Auto);
        assert!(!ribbon.blocks(&away), "ray {i} towards {d}");
        left += 1;
    }
    assert!(left > 1000, "{left}");
}

#[test]
fn corners_of_lines_are_round() {
    let zigzag = strands(&[[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]], &[0.2; 3]);
    for form in [CurveForm::Tube, CurveForm::Ribbon] {
        let curves = Curves::new(&zigzag, CurveBasis::Linear, form).unwrap();
        assert_eq!(curves.span_count(), 3);
        let above = Ray::new(Vec3::new(0.0, 1.19, 3.0), Vec3::NEG_Z);
        assert!(curves.blocks(&above) && !curves.blocks(&Ray { o: Vec3::new(0.0, 1.21, 3.0), ..above }));
    }
}

#[test]
fn coordinates_run_along_the_strand() {
    let curves = Curves::new(&bent(), CurveBasis::CatmullRom, CurveForm::Tube).unwrap();
    // The fourth of seven points.
    let p = Vec3::new(0.6, 0.1, 0.6);
    let ray = Ray::new(p + Vec3::new(3.0, 0.0, 0.0), Vec3::NEG_X);
    let hit = curves.hit(&ray).unwrap();
    let u = curves.uv_at(&hit, curves.surface_at(&ray, &hit).p).x;
    assert!((u - 0.5).abs() < 0.03, "{u}");
}

#[test]
fn what_is_no_curve_is_told() {
    let new = |strands: &Strands, basis| {
        Curves::new(strands, basis, CurveForm::Tube).map(|curves| curves.span_count())
    };
    let one = strands(&[[0.0; 3]], &[0.1]);
    assert_eq!(new(&one, CurveBasis::BSpline), Err(CurvesError::PointCount { strand: 0, points: 1 }));
    let six = strands(&[[0.0; 3]; 6], &[0.1; 6]);
    assert_eq!(new(&six, CurveBasis::Bezier), Err(CurvesError::PointCount { strand: 0, points: 6 }));
    assert_eq!(new(&six, CurveBasis::BSpline), Err(CurvesError::Empty));
    assert_eq!(new(&Strands::default(), CurveBasis::Linear), Err(CurvesError::Empty));
    for (x, r) in [(f32::NAN, 0.1), (f32::INFINITY, 0.1), (0.5, -0.1), (0.5, f32::NAN)] {
        let bad = strands(&[[0.0; 3], [x, 1.0, 0.0]], &[0.1, r]);
        assert_eq!(new(&bad, CurveBasis::CatmullRom), Err(CurvesError::BadNumber { strand: 0 }));
    }
    // Of two strands one is there.
    let mut two = bent();
    two.points.extend([Vec3::ONE; 4]);
    two.radii.extend([0.1; 4]);
    two.finish_strand();
    let curves = Curves::new(&two, CurveBasis::BSpline, CurveForm::Tube).unwrap();
    assert_eq!(curves.dropped(), 1);
}

/// Control points that coincide at the ends leave a curve without a tangent there.
#[test]
fn equal_control_points_do_no_harm() {
    let points = [[0.0, -1.0, 0.0], [0.0, -1.0, 0.0], [0.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    for form in [CurveForm::Tube, CurveForm::Ribbon] {
        let curves = Curves::new(&strands(&points, &[0.2; 4]), CurveBasis::Bezier, form).unwrap();
        for k in 0..100 {
            let y = -0.99 + 0.0198 * k as f32;
            let ray = Ray::new(Vec3::new(0.05, y, 2.0), Vec3::NEG_Z);
            let hit = curves.hit(&ray).unwrap_or_else(|| panic!("{form:?} at {y}"));
            let at = curves.surface_at(&ray, &hit);
            assert!(at.p.is_finite() && (at.n.length() - 1.0).abs() < 1e-5);
        }
        assert!(!curves.blocks(&Ray::new(Vec3::new(0.0, 1.3, 2.0), Vec3::NEG_Z)));
    }
}

/// Hair: bytes of each segment, the boxes in the tree included.
#[test]
fn a_segment_takes_few_bytes() {
    let mut hair = Strands::default();
    for i in 0..20_000 {
        let s = Stream::new(41, [i, 0], 0);
        let root = point(&s, 0);
        for k in 0..6 {
            hair.points.push(root + 0.02 * k as f32 * Vec3::Y + 0.002 * point(&s, 3 + 3 * k));
            hair.radii.push(1e-4 * (6 - k) as f32);
        }
        hair.finish_strand();
    }
    let curves = Curves::new(&hair, CurveBasis::BSpline, CurveForm::Tube).unwrap();
    let segments = 5 * hair.len();
    assert!(curves.span_count() <= segments * 11 / 10, "{} spans", curves.span_count());
    let each = curves.heap_bytes() / segments;
    assert!(each < 90, "{each} bytes a segment");
}

/// A span of a tube that gives light is drawn along its chord: no point that is seen is left out, since the mean of an estimate is that of a
/// sphere around it, and fewer rays miss it.
#[test]
fn spans_give_light_along_their_chords() {
    const N: u32 = 20_000;
    let curves = Curves::new(&bent(), CurveBasis::CatmullRom, CurveForm::Tube).unwrap();
    let mut patches = Vec::new();
    curves.patches(|part, patch| patches.push((part, patch)));
    assert!(patches.len() > 4, "{}", patches.len());
    for (part, patch) in patches {
        let bounds = curves.0.leaf_bounds(&curves.0.leaves[part as usize]);
        let (center, radius) = (bounds.center().as_dvec3(), 0.5 * bounds.extent().as_dvec3().length());
        let single = TracedPatch::new(curves.clone(), part).unwrap().within(center, radius);
        let single = Patch::Traced(Box::new(single));
        let from = Vec3::new(0.3, 1.6, 1.5);
        let moments = |patch: &Patch| {
            let (mut sum, mut squares) = (0.0, 0.0);
            for i in 0..N {
                let s = Stream::new(41, [i, part], 0);
                let Some(way) = patch.sample(from, Vec2::new(s.uniform(0), s.uniform(1))) else { continue };
                let e = f64::from((2.5 + way.at.p.x) / way.pdf);
                (sum, squares) = (sum + e, squares + e * e);
            }
            let (mean, mean2) = (sum / f64::from(N), squares / f64::from(N));
            (mean, (mean2 - mean * mean) / f64::from(N))
        };
        let (along, around) = (moments(&patch), moments(&single));
        let sigma = (along.1 + around.1).sqrt();
        assert!((along.0 - around.0).abs() < 5.0 * sigma, "{part}: {along:?} {around:?}");
        assert!(along.1 < 0.8 * around.1, "{part}: {along:?} {around:?}");
    }
}
