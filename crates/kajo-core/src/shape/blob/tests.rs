//! Blobs against closed forms, and against their field.

use kajo_math::{fmath, rng::Stream, warp};

use super::*;

fn ball(x: f64, strength: f64) -> BlobComponent {
    BlobComponent { core: BlobCore::Ball(x * DVec3::X), radius: 1.0, strength, material: 0 }
}

fn gaussian(components: &[BlobComponent]) -> Blob {
    Blob::new(BlobKernel::Gaussian, 1.0, components).unwrap()
}

/// Where the line along x at a height y crosses.
fn along_x(blob: &Blob, y: f32) -> Vec<f64> {
    let mut found = Vec::new();
    let ray = Ray::new(Vec3::new(-10.0, y, 0.0), Vec3::X);
    blob.0.crossings(&ray, |t| {
        found.push(t - 10.0);
        false
    });
    found
}

fn agree(found: &[f64], expected: &[f64]) -> bool {
    found.len() == expected.len() && found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-8)
}

#[test]
fn crossings_are_where_formulas_have_them() {
    // One ball of strength 2: a sphere of radius sqrt(ln 2).
    let r = fmath::ln64(2.0).sqrt();
    let found = along_x(&gaussian(&[ball(0.0, 2.0)]), 0.0);
    assert!(agree(&found, &[-r, r]), "{found:?}");
    // Two balls apart, found by bisection in 30 digits.
    let pair = gaussian(&[ball(-1.5, 2.0), ball(1.5, 2.0)]);
    let found = along_x(&pair, 0.0);
    assert!(agree(&found, &[-2.332_555_113, -0.655_905_188, 0.655_905_188, 2.332_555_113]), "{found:?}");
    let found = along_x(&pair, 0.2);
    let expected = [-2.308_175_815, -0.681_615_680, 0.681_615_680, 2.308_175_815];
    assert!(found.len() == 4 && found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 2e-8), "{found:?}");
    // POV-Ray's kernel: (1 - r^2)^2 = 1/4.
    let pov = Blob::new(BlobKernel::Povray, 0.25, &[ball(0.0, 1.0)]).unwrap();
    assert!(agree(&along_x(&pov, 0.0), &[-0.5f64.sqrt(), 0.5f64.sqrt()]));
    // Wyvill's kernel is one half at half of the radius.
    let wyvill = Blob::new(BlobKernel::Wyvill, 0.5, &[ball(0.0, 1.0)]).unwrap();
    assert!(agree(&along_x(&wyvill, 0.0), &[-0.5, 0.5]));
}

/// Two equal balls join at the distance `2 sqrt(ln(2 b / T) / a)`.
#[test]
fn balls_join_at_their_distance() {
    let joins = 2.0 * fmath::ln64(4.0).sqrt();
    assert!((joins - 2.354_820).abs() < 1e-6);
    for (off, crossings) in [(-1e-6, 2), (1e-6, 4)] {
        let half = 0.5 * (joins + off);
        assert_eq!(along_x(&gaussian(&[ball(-half, 2.0), ball(half, 2.0)]), 0.0).len(), crossings, "{off}");
    }
}

fn random(n: u32, kernel: BlobKernel) -> Blob {
    let component = |i: u32| {
        let s = Stream::new(67, [i, n], 0);
        let point = |k: u32| {
            DVec3::new(s.uniform(k).into(), s.uniform(k + 1).into(), s.uniform(k + 2).into()) * 2.0 - 1.0
        };
        // Without cylinders a blob of POV-Ray's kernel is a quartic along a ray.
        let core = if i.is_multiple_of(3) && (n.is_multiple_of(2) || kernel != BlobKernel::Povray) {
            BlobCore::Cylinder([point(0), point(3)])
        } else {
            BlobCore::Ball(point(0))
        };
        let strength = if i % 4 == 3 { -0.8 } else { 1.0 };
        BlobComponent { core, radius: 0.2 + 0.3 * f64::from(s.uniform(7)), strength, material: 0 }
    };
    Blob::new(kernel, 0.4, &(0..n).map(component).collect::<Vec<_>>()).unwrap()
}

/// The sign of the field on a fine grid of many lines changes where there are crossings, and nowhere else.
#[test]
fn no_crossing_is_missed_and_none_is_made_up() {
    for kernel in [BlobKernel::Gaussian, BlobKernel::Wyvill, BlobKernel::Povray] {
        for n in [1, 2, 5, 40, 41] {
            let blob = random(n, kernel);
            for i in 0..150 {
                let s = Stream::new(71, [i, n], 0);
                let u = |k| Vec2::new(s.uniform(k), s.uniform(k + 1));
                let d = warp::uniform_sphere(u(0));
                let ray = Ray::new(warp::uniform_sphere(u(2)) * s.uniform(4) - 4.0 * d, d);
                let mut found = Vec::new();
                blob.0.crossings(&ray, |t| {
                    found.push(t);
                    false
                });
                assert!(found.is_sorted() && found.len().is_multiple_of(2), "{found:?}");
                const STEPS: u32 = 800;
                let line = Ray64::new(&ray);
                let inside = |k: u32| blob.field(line.at(8.0 * f64::from(k) / f64::from(STEPS))).0 >= 0.0;
                for k in 0..STEPS {
                    let step = |k: u32| 8.0 * f64::from(k) / f64::from(STEPS);
                    let between = found.iter().filter(|&&t| step(k) <= t && t < step(k + 1)).count();
                    let changes = inside(k) != inside(k + 1);
                    assert_eq!(between % 2 == 1, changes, "{kernel:?} {n}, ray {i}, {} {found:?}", step(k));
                }
            }
        }
    }
}

/// Normals are the gradient's direction, and points lie on the surface.
#[test]
fn points_are_on_the_surface() {
    let blob = random(40, BlobKernel::Gaussian);
    let mut hits = 0;
    for i in 0..2000 {
        let s = Stream::new(73, [i, 0], 0);
        let d = warp::uniform_sphere(Vec2::new(s.uniform(0), s.uniform(1)));
        let ray = Ray::new(Vec3::new(s.uniform(2), s.uniform(3), s.uniform(4)) - 0.5 - 4.0 * d, d);
        let Some(hit) = blob.hit(&ray) else { continue };
        hits += 1;
        let at = blob.surface_at(&ray, &hit);
        let (value, gradient) = blob.field(at.p.as_dvec3());
        assert!(value.abs() < 1e-6 * gradient.length().max(1.0), "{value} at {}", at.p);
        assert!(at.n.dot(ray.d) < 1e-3, "the first crossing enters");
        let h = 1e-5;
        let difference = |axis: DVec3| {
            let at = |by: f64| blob.field(at.p.as_dvec3() + by * axis).0;
            (at(h) - at(-h)) / (2.0 * h)
        };
        let expected = -DVec3::new(difference(DVec3::X), difference(DVec3::Y), difference(DVec3::Z));
        assert!(expected.normalize().distance(at.n.as_dvec3()) < 1e-4, "{expected} {}", at.n);
    }
    assert!(hits > 1000);
}

/// A hole by a negative ball within a positive one, seen from outside and from within the hole.
#[test]
fn negative_balls_make_holes() {
    let small = BlobComponent { core: BlobCore::Ball(DVec3::ZERO), radius: 0.4, strength: -3.0, material: 0 };
    let blob = gaussian(&[ball(0.0, 3.0), small]);
    assert_eq!(along_x(&blob, 0.0).len(), 4);
    assert!(blob.field(DVec3::ZERO).0 < 0.0);
    let from_within = Ray::new(Vec3::ZERO, Vec3::new(0.3, 0.5, -0.4));
    let hit = blob.hit(&from_within).unwrap();
    assert!(blob.surface_at(&from_within, &hit).n.dot(from_within.d) < 0.0);
}

#[test]
fn what_is_no_blob() {
    assert!(Blob::new(BlobKernel::Gaussian, 0.0, &[ball(0.0, 1.0)]).is_none());
    let flat = BlobComponent { radius: 0.0, ..ball(0.0, 1.0) };
    assert!(Blob::new(BlobKernel::Gaussian, 1.0, &[flat]).is_none());
    let nothing = Blob::new(BlobKernel::Wyvill, 1.0, &[]).unwrap();
    assert!(nothing.hit(&Ray::new(Vec3::ZERO, Vec3::X)).is_none() && nothing.bounds().is_empty());
    let weak = gaussian(&[ball(0.0, 0.5)]);
    assert!(weak.hit(&Ray::new(-3.0 * Vec3::X, Vec3::X)).is_none());
}

/// Boxes and balls around blobs hold them and are hardly larger.
#[test]
fn extents_are_tight() {
    let blob = gaussian(&[ball(0.0, 2.0)]);
    let r = fmath::ln64(2.0).sqrt();
    let Aabb { min, max } = blob.bounds();
    for x in [max, -min].into_iter().flat_map(|corner| corner.to_array()) {
        assert!((r..1.15 * r).contains(&f64::from(x)), "{x} for {r}");
    }
    let parts = &*blob.0;
    let extent = Extent { kernel: parts.kernel, threshold: parts.threshold, terms: &parts.terms };
    let around = extent.radius(blob.bounds(), DVec3::ZERO);
    assert!((r..1.1 * r).contains(&around), "{around} for {r}");
    let negative = gaussian(&[ball(0.0, 2.0), ball(0.9, -1.5)]);
    assert!(negative.bounds().max.x < blob.bounds().max.x, "what is taken away");
    // Every point of the field above the threshold lies within.
    for kernel in [BlobKernel::Gaussian, BlobKernel::Wyvill, BlobKernel::Povray] {
        let blob = random(40, kernel);
        let parts = &*blob.0;
        let center = blob.bounds().center().as_dvec3();
        let extent = Extent { kernel, threshold: parts.threshold, terms: &parts.terms };
        let around = extent.radius(blob.bounds(), center);
        for i in 0..20_000 {
            let s = Stream::new(97, [i, 0], 0);
            let p = (Vec3::new(s.uniform(0), s.uniform(1), s.uniform(2)) * 4.0 - 2.0).as_dvec3();
            if blob.field(p).0 >= 0.0 {
                assert!(blob.bounds().contains(p.as_vec3()) && p.distance(center) <= around, "{p}");
            }
        }
    }
}

fn plane(normal: DVec3, offset: f64, radius: f64, strength: f64) -> BlobComponent {
    BlobComponent { core: BlobCore::HalfSpace { normal, offset }, radius, strength, material: 0 }
}

/// A half space reaches the threshold where its kernel does, and a ball on it makes a hill of known height.
#[test]
fn half_spaces_are_where_formulas_have_them() {
    let lift = fmath::ln64(2.0).sqrt();
    for (kernel, threshold, height) in [
        (BlobKernel::Gaussian, 0.5, 0.5 * lift),
        (BlobKernel::Wyvill, 0.5, 0.25),
        (BlobKernel::Povray, 0.25, 0.5 * 0.5f64.sqrt()),
    ] {
        let ground = Blob::new(kernel, threshold, &[plane(DVec3::Y, 0.3, 0.5, 1.0)]).unwrap();
        assert!(!ground.is_closed() && ground.is_solid() && !ground.bounds().is_finite());
        for (o, d) in [(Vec3::new(3.0, 5.0, 1.0), Vec3::new(0.4, -2.0, 0.3)), (Vec3::Y * 1e3, -Vec3::Y)] {
            let ray = Ray::new(o, d).over(f32::NEG_INFINITY, f32::INFINITY);
            let mut found = Vec::new();
            ground.0.crossings(&ray, |t| {
                found.push(t);
                false
            });
            assert_eq!(found.len(), 1, "{found:?}");
            let y = f64::from(o.y) + found[0] * f64::from(d.y);
            assert!((y - 0.3 - height).abs() < 1e-9, "{kernel:?}: {y}");
            assert!(!ground.starts_inside(&ray) && ground.starts_inside(&Ray { d: -d, ..ray }));
            let at = ground.surface_at(&ray, &ground.hit(&ray).unwrap());
            assert!(at.n.distance(Vec3::Y) < 1e-6 && (f64::from(at.p.y) - y).abs() < 1e-5, "{at:?}");
        }
        let beside = Ray::new(Vec3::ZERO, Vec3::X).over(f32::NEG_INFINITY, f32::INFINITY);
        assert!(ground.hit(&beside).is_none() && ground.starts_inside(&beside));
    }
    // exp(-y^2) + exp(-(y - 1)^2) = 3/2 at the top of a ball that sits on the ground.
    let hill = Blob::new(
        BlobKernel::Gaussian,
        0.5,
        &[plane(DVec3::Y, 0.0, 1.0, 1.0), BlobComponent { core: BlobCore::Ball(DVec3::Y), ..ball(0.0, 1.0) }],
    )
    .unwrap();
    let hit = hill.hit(&Ray::new(9.0 * Vec3::Y, -Vec3::Y)).unwrap();
    let y = 9.0 - f64::from(hit.t);
    let field = fmath::exp64(-y * y) + fmath::exp64(-(y - 1.0) * (y - 1.0));
    assert!((field - 0.5).abs() < 1e-5 && y > 1.0, "{y} {field}");
    // What takes away beyond a plane leaves a part with an end.
    let cut = gaussian(&[ball(0.0, 3.0), plane(DVec3::X, 0.0, 0.2, -4.0)]);
    assert!(cut.is_closed() && cut.bounds().min.x > -0.5 && cut.bounds().max.x > 0.9, "{:?}", cut.bounds());
    assert_eq!(along_x(&cut, 0.0).len(), 2);
}

/// Blobs with half spaces begin inside or outside as they say, and change where there are crossings, and nowhere else.
#[test]
fn blobs_without_an_end_are_followed_along_whole_lines() {
    let (mut crossed, mut from_within) = (0, 0);
    for kernel in [BlobKernel::Gaussian, BlobKernel::Wyvill, BlobKernel::Povray] {
        for n in 1..24 {
            let s = Stream::new(103, [n, 0], 0);
            let parts = random(n, kernel);
            let of = |term: &Term, i: u32| {
                let u = Vec2::new(s.uniform(4 * i), s.uniform(4 * i + 1));
                let normal = warp::uniform_sphere(u).as_dvec3().normalize();
                let strength = if i.is_multiple_of(3) { -0.5 } else { 0.6 };
                let side = plane(normal, f64::from(s.uniform(4 * i + 2)) - 0.5, 0.4, strength);
                let own = BlobComponent {
                    core: term.core(),
                    radius: 1.0 / term.inverse2().sqrt(),
                    strength: term.strength(),
                    material: 0,
                };
                if i.is_multiple_of(4) { vec![own, side] } else { vec![own] }
            };
            let components: Vec<_> =
                parts.0.terms.iter().zip(0..).flat_map(|(term, i)| of(term, i)).collect();
            let blob = Blob::new(kernel, 0.4, &components).unwrap();
            for i in 0..60 {
                let s = Stream::new(107, [i, n], 0);
                let u = |k| Vec2::new(s.uniform(k), s.uniform(k + 1));
                let d = warp::uniform_sphere(u(0));
                let ray = Ray::new(warp::uniform_sphere(u(2)) * s.uniform(4), d);
                let ray = ray.over(f32::NEG_INFINITY, f32::INFINITY);
                let mut found = Vec::new();
                blob.0.crossings(&ray, |t| {
                    found.push(t);
                    false
                });
                assert!(found.is_sorted(), "{found:?}");
                let starts = blob.starts_inside(&ray);
                from_within += u32::from(starts);
                crossed += found.len();
                let line = Ray64::new(&ray);
                for k in -200..=200 {
                    let t = 0.05 * f64::from(k);
                    let field = blob.field(line.at(t)).0;
                    let inside = starts != (found.partition_point(|&at| at < t) % 2 == 1);
                    let is_clear = field.abs() > 1e-6;
                    assert!(!is_clear || inside == (field >= 0.0), "{kernel:?} {n}, ray {i}, {t}: {found:?}");
                }
            }
        }
    }
    assert!(crossed > 2000 && from_within > 300, "{crossed} {from_within}");
}

#[test]
fn materials_have_shares_by_their_fields() {
    let of = |x: f64, strength: f64, material: usize| BlobComponent { material, ..ball(x, strength) };
    let two = gaussian(&[of(-0.5, 2.0, 0), of(0.5, 2.0, 1)]);
    assert_eq!(two.shares(DVec3::Y)[1], 0.5);
    let p = DVec3::new(0.3, 0.2, -0.4);
    let ratio = fmath::exp64(-(0.8 * 0.8 - 0.2 * 0.2));
    assert!((f64::from(two.shares(p)[1]) - 1.0 / (1.0 + ratio)).abs() < 1e-6);
    // What takes away has none, and five materials are mixed one after the other.
    let five: Vec<_> = (0..5).map(|i| of(0.3 * f64::from(i) - 0.6, 1.0, i as usize)).collect();
    let all = gaussian(&[&five[..], &[of(0.1, -0.5, 4)]].concat());
    let shares = all.shares(p);
    let mut mixed = [0.0; 5];
    for (i, &share) in shares.iter().enumerate() {
        mixed[..i].iter_mut().for_each(|part| *part *= 1.0 - f64::from(share));
        mixed[i] = f64::from(share);
    }
    let field = |i: u8| {
        let x = 0.3 * f64::from(i) - 0.6;
        fmath::exp64(-(p - x * DVec3::X).length_squared())
    };
    let fields = [0, 1, 2, 3, 4].map(field);
    let sum: f64 = fields.iter().sum();
    for (mixed, field) in mixed.iter().zip(&fields) {
        assert!((mixed - field / sum).abs() < 1e-6, "{mixed} {field}");
    }
    let hit = Hit::default();
    assert_eq!(all.uv_at(&hit, p.as_vec3()).to_array(), all.shares(p.as_vec3().as_dvec3())[1..3]);
    let second = all.second_uv_at(&hit, p.as_vec3()).unwrap().to_array();
    assert_eq!(second, all.shares(p.as_vec3().as_dvec3())[3..]);
    assert_eq!(
        (two.second_uv_at(&hit, Vec3::Y), gaussian(&[ball(0.0, 2.0)]).uv_at(&hit, Vec3::Y)),
        (None, NO_UV)
    );
    assert!(Blob::new(BlobKernel::Gaussian, 1.0, &[of(0.0, 2.0, MOST_MATERIALS)]).is_none());
}

/// What is in the way of a ray is what it hits, and the first of all crossings; from within the cell of a hit the field has the bits of
/// the sum over all components.
#[test]
fn cells_agree_with_one_another() {
    let mut hits = 0;
    let kernels = [BlobKernel::Gaussian, BlobKernel::Wyvill, BlobKernel::Povray];
    for (kernel, n) in kernels.into_iter().flat_map(|kernel| [1, 7, 41, 301].map(|n| (kernel, n))) {
        let blob = random(n, kernel);
        let cells = blob.0.cells.as_ref().unwrap();
        let Parts { kernel, threshold, terms, .. } = &*blob.0;
        for i in 0..2000 {
            let s = Stream::new(107, [i, n], 0);
            let u = |k| Vec2::new(s.uniform(k), s.uniform(k + 1));
            let d = warp::uniform_sphere(u(0));
            let from = 4.0 * s.uniform(5);
            let ray = Ray::new(warp::uniform_sphere(u(2)) * s.uniform(4) - from * d, d)
                .over(0.0, 6.0 * s.uniform(6));
            let hit = blob.hit(&ray);
            assert_eq!(blob.blocks(&ray), hit.is_some(), "{n}: ray {i}");
            let mut first = None;
            blob.crossings(&ray, |hit| first = first.or(Some(hit.t)));
            assert_eq!(hit.map(|hit| hit.t), first, "{n}: ray {i}");
            let Some(hit) = hit else { continue };
            hits += 1;
            let p = Ray64::new(&ray).at(hit.t.into());
            let (value, gradient) = blob.0.sum_of(cells.members_near(hit.u as u32, p).unwrap(), p);
            let whole = terms
                .iter()
                .map(|term| term.at(*kernel, p))
                .fold((-threshold, DVec3::ZERO), |sum, at| (sum.0 + at.0, sum.1 + at.1));
            assert_eq!((value, gradient), whole, "{n}: ray {i}");
            assert!(value.abs() < 1e-4, "{value}");
        }
    }
    assert!(hits > 3000, "{hits}");
}

/// A surface that is one point, or none but for rounding, ends the search for cells.
#[test]
fn surfaces_that_are_hardly_there_have_few_cells() {
    for strength in [0.5, 0.5 + 1e-15, 0.5 - 1e-15] {
        let blob = Blob::new(BlobKernel::Povray, 0.5, &[ball(0.3, strength)]).unwrap();
        assert!(blob.heap_bytes() < 1 << 16);
        let found = along_x(&blob, 0.0);
        assert!(found.is_empty() || found.len() == 2, "{found:?}");
    }
}

/// Where every ball reaches everywhere all cells have all of them, and there are few cells.
#[test]
fn balls_in_one_heap_take_little_memory() {
    let s = Stream::new(91, [0, 0], 0);
    let at = |i: u32| 0.01 * DVec3::new(s.uniform(3 * i).into(), s.uniform(3 * i + 1).into(), 0.5);
    let ball = |i| BlobComponent { core: BlobCore::Ball(at(i)), radius: 1.0, strength: 1.0, material: 0 };
    let balls: Vec<_> = (0..600).map(ball).collect();
    let blob = Blob::new(BlobKernel::Povray, 150.0, &balls).unwrap();
    let bytes = blob.0.cells.as_ref().unwrap().heap_bytes();
    assert!(bytes < 600 * 4 * 1024, "{bytes}");
    // Nearly one ball of strength 600: (1 - r^2)^2 = 1/4.
    let found = along_x(&blob, 0.005);
    assert!(found.len() == 2 && (found[1] - 0.5f64.sqrt()).abs() < 0.01, "{found:?}");
}
