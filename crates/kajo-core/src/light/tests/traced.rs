//! Surfaces whose points are found by rays, against spheres, which they may be.

use kajo_testkit::sphere;

use super::*;
use crate::light::{BoundingSphere, LeNumbers};
use crate::shape::{Blob, BlobComponent, BlobCore, BlobKernel};

/// Radius of the sphere that a ball of POV-Ray's kernel makes for the threshold 1/4.
fn radius() -> f64 {
    0.5f64.sqrt()
}

fn balls(centers: &[DVec3]) -> Blob {
    let ball = |&center: &DVec3| BlobComponent {
        core: BlobCore::Ball(center),
        radius: 1.0,
        strength: 1.0,
        material: 0,
    };
    let components: Vec<BlobComponent> = centers.iter().map(ball).collect();
    Blob::new(BlobKernel::Povray, 0.25, &components).unwrap()
}

/// The light of a blob under a map.
fn light_of(blob: &Blob, map: &DAffine3, sides: Sides) -> AreaLight {
    let mut patches = Vec::new();
    blob.patches(|_, patch| patches.push(patch.transformed(map).unwrap()));
    assert_eq!(patches.len(), 1);
    emission::area(patches.remove(0), sides)
}

/// Two balls of which neither has support where the other one is.
const PAIR: [DVec3; 2] = [DVec3::new(-1.0, 0.0, 0.0), DVec3::new(1.0, 0.0, 0.0)];

fn skewed() -> DAffine3 {
    let turn = DQuat::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), 0.9);
    DAffine3::from_scale_rotation_translation(DVec3::new(0.7, 1.3, 0.9), turn, DVec3::new(0.3, 0.2, -0.1))
}

/// Parameters and normals, not of unit length, where a ray crosses spheres of that radius under a map.
fn crossings(centers: &[DVec3], map: &DAffine3, from: Vec3, w: Vec3) -> Vec<(f64, DVec3)> {
    let inverse = map.inverse();
    let (o, d) = (inverse.transform_point3(from.as_dvec3()), inverse.transform_vector3(w.as_dvec3()));
    let mut found = Vec::new();
    for center in centers {
        let to = o - center;
        let (a, b, c) = (d.dot(d), to.dot(d), to.dot(to) - radius() * radius());
        let root = (b * b - a * c).sqrt();
        found.extend([(-b - root) / a, (-b + root) / a].map(|t| (t, to + t * d)));
    }
    found.retain(|(t, _)| *t > 1e-3);
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    let normals = inverse.matrix3.transpose();
    found.into_iter().map(|(t, n)| (t, (normals * n).normalize())).collect()
}

/// Directions follow the density summed over all points that lie there.
fn directions(centers: &[DVec3], map: &DAffine3, from: Vec3, patch: &Patch) {
    let pdf = |w: Vec3| {
        let at = crossings(centers, map, from, w);
        at.iter().map(|(t, n)| patch.pdf(from, from + *t as f32 * w, n.as_vec3())).sum()
    };
    let draw = |u: Vec2, _| patch.sample(from, u).map(|drawn| drawn.wi);
    let result = sphere::test(40_000, 77, draw, pdf);
    assert!(result.passes(0.01, 8), "{} balls from {from}: {result:?}", centers.len());
}

#[test]
fn directions_follow_their_density() {
    let still = DAffine3::IDENTITY;
    for (centers, map, from) in [
        (&[DVec3::ZERO][..], still, Vec3::new(0.0, 3.0, 1.0)),
        (&[DVec3::ZERO], still, Vec3::new(0.3, 0.2, -0.1)),
        (&[DVec3::ZERO], skewed(), Vec3::new(1.5, 1.0, 0.0)),
        (&PAIR, still, Vec3::new(7.0, 0.3, 0.4)),
        (&PAIR, still, Vec3::new(0.2, 0.3, 0.1)),
        (&PAIR, still, Vec3::new(1.1, 0.3, 0.1)),
    ] {
        let light = light_of(&balls(centers), &map, Sides::Both);
        directions(centers, &map, from, &light.patch);
        if centers.len() == 2 && from.x > 3.0 {
            directions(centers, &map, from, &light.patch.by_area().unwrap());
        }
    }
}

/// Each point that lies in a direction is drawn as often as its own density says.
#[test]
fn every_point_has_its_own_density() {
    let from = Vec3::new(7.0, 0.3, 0.4);
    let light = light_of(&balls(&PAIR), &DAffine3::IDENTITY, Sides::Both);
    for patch in [light.patch.clone(), light.patch.by_area().unwrap()] {
        const N: u32 = 60_000;
        let (mut sums, mut squares) = ([0.0; 4], [0.0; 4]);
        for i in 0..N {
            let Some(PatchDirection { at, wi, pdf }) = patch.sample(from, draw(i)) else { continue };
            let ball = usize::from(at.p.x < 0.0);
            let k = 2 * ball + usize::from(at.n.dot(wi) > 0.0);
            let e = f64::from(1.0 / pdf);
            sums[k] += e;
            squares[k] += e * e;
        }
        for k in 0..4 {
            // The solid angle of the ball, once for its near side and once for its far side.
            let distance2 = from.as_dvec3().distance_squared(PAIR[1 - k / 2]);
            let expected = 2.0 * PI * (1.0 - (1.0 - radius() * radius() / distance2).sqrt());
            let n = f64::from(N);
            let mean = sums[k] / n;
            let sigma = ((squares[k] / n - mean * mean) / n).sqrt();
            assert!((mean - expected).abs() < 4.5 * sigma, "{k}: {mean} ± {sigma} for {expected}");
        }
    }
}

/// Irradiance from all points in view if nothing hid anything: that of both sides of a sphere, and from inside of one.
#[test]
fn irradiance_is_that_of_spheres() {
    let single = light_of(&balls(&[DVec3::ZERO]), &DAffine3::IDENTITY, Sides::Both).patch;
    let (found, sigma) = irradiance(&single, 3.0 * Vec3::Y, Vec3::NEG_Y, 20_000);
    let expected = 2.0 * PI * (radius() / 3.0).powi(2);
    assert!((found - expected).abs() < 4.5 * sigma, "{found} ± {sigma} for {expected}");
    let (found, sigma) = irradiance(&single, Vec3::new(0.1, 0.2, 0.3), Vec3::NEG_Y, 20_000);
    assert!((found - PI).abs() < 4.5 * sigma, "{found} ± {sigma} for pi");
}

#[test]
fn areas_are_measured() {
    let ball = balls(&[DVec3::ZERO]);
    let sphere = 4.0 * PI * radius() * radius();
    let area = |map: &DAffine3| light_of(&ball, map, Sides::Both).patch.area();
    assert!((area(&DAffine3::IDENTITY) / sphere - 1.0).abs() < 5e-3);
    assert!((area(&DAffine3::from_scale(DVec3::splat(3.0))) / (9.0 * sphere) - 1.0).abs() < 5e-3);
    let pair = light_of(&balls(&PAIR), &DAffine3::IDENTITY, Sides::Both).patch;
    assert!((pair.area() / (2.0 * sphere) - 1.0).abs() < 3e-2, "{} for {}", pair.area(), 2.0 * sphere);
    let stretched = DAffine3::from_scale(DVec3::new(0.7, 1.3, 2.0) * radius());
    let ellipsoid = Patch::curved(Canonical::Sphere, stretched).unwrap().area();
    let found = area(&DAffine3::from_scale(DVec3::new(0.7, 1.3, 2.0)));
    assert!((found / ellipsoid - 1.0).abs() < 2e-2, "{found} for {ellipsoid}");
}

const WORLD: BoundingSphere = BoundingSphere { center: Vec3::ZERO, radius: 9.0 };

/// Light that leaves: its density is that of the light, and light through patches of the surface into some directions is what
/// the cosine makes of them.
#[test]
fn light_leaves_as_its_density_says() {
    for (sides, factor) in [(Sides::Both, 1.0), (Sides::Front, 0.5), (Sides::Back, 0.5)] {
        let light = light_of(&balls(&PAIR), &DAffine3::IDENTITY, sides);
        const N: u32 = 60_000;
        let (mut sums, mut squares) = ([0.0; 4], [0.0; 4]);
        for i in 0..N {
            let s = Stream::new(29, [i, 0], 0);
            let pair = |k| Vec2::new(s.uniform(k), s.uniform(k + 1));
            let u = LeNumbers { position: pair(0), direction: pair(2) };
            let Some(sample) = light.sample_le(0.0, u, &Wavelengths::RGB, &WORLD, &MeanEmission) else {
                continue;
            };
            let LightPoint::Surface { p, n, .. } = sample.at else { panic!("a surface") };
            assert!(sides.emit(sample.d.dot(n)));
            let again = light.pdf_le(0.0, &sample.at, sample.d, &WORLD);
            assert!((again.position / sample.pdf.position - 1.0).abs() < 1e-3, "{again:?} {:?}", sample.pdf);
            assert_eq!(again.direction, sample.pdf.direction);
            assert_eq!(
                light.pdf_le(0.0, &sample.at, -sample.d, &WORLD).direction > 0.0,
                sides == Sides::Both
            );
            let e = f64::from(sample.cosine() / (sample.pdf.position * sample.pdf.direction));
            // Along the line from ball to ball, where lines have four points, and across it.
            let k = 2 * usize::from(p.x < 0.0) + usize::from(sample.d.x.abs() > 0.9);
            sums[k] += e;
            squares[k] += e * e;
        }
        for k in 0..4 {
            let share = if k % 2 == 1 { 0.1 } else { 0.9 };
            // The integral of the cosine's amount over a sphere, for each direction, is twice its cross-section.
            let expected = factor * 4.0 * PI * share * 2.0 * PI * radius() * radius();
            let n = f64::from(N);
            let mean = sums[k] / n;
            let sigma = ((squares[k] / n - mean * mean) / n).sqrt();
            assert!((mean - expected).abs() < 4.5 * sigma, "{sides:?} {k}: {mean} ± {sigma} for {expected}");
        }
    }
}

/// A light that has moved is the light at the other position.
#[test]
fn what_moves_is_drawn_where_it_is() {
    let moved = DAffine3::from_translation(DVec3::new(0.5, -1.0, 2.0)) * DAffine3::from_rotation_y(0.7);
    let patch = light_of(&balls(&PAIR), &skewed(), Sides::Both).patch;
    let there = light_of(&balls(&PAIR), &(moved * skewed()), Sides::Both).patch;
    let placed = PlacedPatch { patch: &patch, moved: Some(moved) };
    let from = Vec3::new(4.0, 3.0, 1.0);
    let mut drawn = 0;
    for i in 0..4000 {
        let [a, b] = [placed.sample(from, draw(i)), there.sample(from, draw(i))];
        let (Some(a), Some(b)) = (a, b) else { continue };
        drawn += 1;
        assert!(a.at.p.distance(b.at.p) < 1e-4 && (a.pdf / b.pdf - 1.0).abs() < 1e-3);
        assert!((placed.pdf(from, a.at.p, a.at.n) / a.pdf - 1.0).abs() < 1e-3);
    }
    assert!(drawn > 60, "{drawn}");
}
