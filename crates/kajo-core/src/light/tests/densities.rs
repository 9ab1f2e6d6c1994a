//! Every patch of surface draws directions by the density it names, from outside, from inside and from its surface.

use kajo_testkit::sphere;

use super::*;

const TESTS: u32 = 31;

/// A surface before its map: unit triangle, unit square, ring, unit sphere, side of a cone, torus around the unit circle.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Simple {
    Triangle,
    Square,
    Ring(f64),
    Sphere,
    Frustum([f64; 2]),
    Torus(f64),
}

impl Simple {
    pub fn patch(self, map: &DAffine3) -> Patch {
        let (x, y, o) = (DVec3::X, DVec3::Y, DVec3::ZERO);
        let simple = match self {
            Simple::Triangle => Patch::Triangle([o, x, y]),
            Simple::Square => Patch::parallelogram(o, [x, y]),
            Simple::Ring(inner) => Patch::Disk(DiskPatch { center: o, axes: [x, y], inner }),
            Simple::Sphere => Patch::Sphere { center: o, radius: 1.0 },
            Simple::Frustum(radii) => return Patch::curved(Canonical::Frustum(radii), *map).unwrap(),
            Simple::Torus(minor) => {
                let widest = if minor > 1.0 { (-1.0 / minor).acos() } else { PI };
                return Patch::curved(Canonical::Torus { minor, widest }, *map).unwrap();
            }
        };
        simple.transformed(map).unwrap()
    }

    /// Parameters and normals where the ray `o + t d` crosses the surface.
    fn crossings(self, o: DVec3, d: DVec3) -> Vec<(f64, DVec3)> {
        let roots = |a: f64, b: f64, c: f64| {
            let root = (b * b - a * c).sqrt();
            [(-b - root) / a, (-b + root) / a].into_iter().filter(|t| t.is_finite())
        };
        let at = |t: f64| o + t * d;
        match self {
            Simple::Sphere => roots(d.dot(d), o.dot(d), o.dot(o) - 1.0).map(|t| (t, at(t))).collect(),
            Simple::Frustum([r0, r1]) => {
                let k = r1 - r0;
                let (r, dr) = (r0 + k * o.z, k * d.z);
                let a = d.x * d.x + d.y * d.y - dr * dr;
                let b = o.x * d.x + o.y * d.y - r * dr;
                let c = o.x * o.x + o.y * o.y - r * r;
                let on = |t: &f64| (0.0..=1.0).contains(&at(*t).z);
                let normal = |p: DVec3| DVec3::new(p.x, p.y, 0.0).normalize() - k * DVec3::Z;
                roots(a, b, c).filter(on).map(|t| (t, normal(at(t)))).collect()
            }
            Simple::Torus(minor) => {
                let torus = Torus::new(Vec3::ZERO, Vec3::Z, 1.0, minor as f32).unwrap();
                let mut found = Vec::new();
                torus.crossings(&Ray::new(o.as_vec3(), d.as_vec3()), |hit| found.push(f64::from(hit.t)));
                let normal = |p: DVec3| p - DVec3::new(p.x, p.y, 0.0).normalize();
                found.into_iter().map(|t| (t, normal(at(t)))).collect()
            }
            flat => {
                let t = -o.z / d.z;
                let (p, r) = (at(t), at(t).truncate().length());
                let inside = match flat {
                    Simple::Triangle => p.x >= 0.0 && p.y >= 0.0 && p.x + p.y <= 1.0,
                    Simple::Square => p.x.min(p.y) >= 0.0 && p.x.max(p.y) <= 1.0,
                    Simple::Ring(inner) => (inner..=1.0).contains(&r),
                    Simple::Sphere | Simple::Frustum(_) | Simple::Torus(_) => false,
                };
                if inside { vec![(t, DVec3::Z)] } else { Vec::new() }
            }
        }
    }
}

/// A simple surface under a map, and a receiver: one that no other part of the surface hides what is drawn from.
#[derive(Clone, Copy, Debug)]
pub(crate) struct KnownSurface {
    shape: Simple,
    map: DAffine3,
    inverse: DAffine3,
    pub receiver: Vec3,
}

impl KnownSurface {
    pub fn new(shape: Simple, map: DAffine3, receiver: Vec3) -> KnownSurface {
        KnownSurface { shape, map, inverse: map.inverse(), receiver }
    }

    /// The points of the surface that can be drawn for the receiver in the unit direction `wi`.
    ///
    /// Of a sphere only the nearest one can.
    pub fn points(&self, wi: Vec3) -> Vec<LightPoint> {
        let o = self.inverse.transform_point3(self.receiver.as_dvec3());
        let d = self.inverse.transform_vector3(wi.as_dvec3());
        let mut crossings = self.shape.crossings(o, d);
        crossings.retain(|crossing| crossing.0 > 1e-6);
        crossings.sort_by(|a, b| a.0.total_cmp(&b.0));
        crossings.truncate(if matches!(self.shape, Simple::Sphere) { 1 } else { 4 });
        let point = |(t, n): (f64, DVec3)| LightPoint::Surface {
            p: self.map.transform_point3(o + t * d).as_vec3(),
            p_error: Vec3::ZERO,
            n: (self.inverse.matrix3.transpose() * n).normalize().as_vec3(),
        };
        crossings.into_iter().map(point).collect()
    }
}

/// Compares directions drawn from `from` with their density, which counts all positions in a direction unless only
/// the nearest can be drawn.
#[track_caller]
fn check(simple: Simple, map: DAffine3, from: Vec3, nearest_only: bool) {
    let patch = simple.patch(&map);
    let (inverse, normals) = (map.inverse(), map.inverse().matrix3.transpose());
    let o = inverse.transform_point3(from.as_dvec3());
    let pdf = |w: Vec3| {
        let d = inverse.transform_vector3(w.as_dvec3());
        let mut crossings = simple.crossings(o, d);
        crossings.retain(|crossing| crossing.0 > 1e-6);
        crossings.sort_by(|a, b| a.0.total_cmp(&b.0));
        crossings.truncate(if nearest_only { 1 } else { 4 });
        let density = |(t, n): &(f64, DVec3)| {
            let p = map.transform_point3(o + *t * d).as_vec3();
            patch.pdf(from, p, (normals * *n).normalize().as_vec3())
        };
        crossings.iter().map(density).sum()
    };
    let draw = |u: Vec2, _| patch.sample(from, u).map(|drawn| drawn.wi);
    let result = sphere::test(60_000, 77, draw, pdf);
    assert!(result.passes(0.01, TESTS), "{simple:?} from {from}: {result:?}");
}

/// A map that turns, stretches unevenly and moves.
fn skewed() -> DAffine3 {
    let turn = DQuat::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), 0.9);
    DAffine3::from_scale_rotation_translation(DVec3::new(0.7, 1.3, 0.9), turn, DVec3::new(0.3, 0.2, -0.1))
        * DAffine3::from_cols(DVec3::X, DVec3::new(0.4, 1.0, 0.0), DVec3::Z, DVec3::ZERO)
}

const ABOVE: Vec3 = Vec3::new(0.4, 0.1, 0.8);
const FAR: Vec3 = Vec3::new(-2.0, 3.0, 5.0);

#[test]
fn flat_pieces() {
    for from in [ABOVE, FAR] {
        check(Simple::Triangle, DAffine3::IDENTITY, from, true);
        check(Simple::Square, DAffine3::IDENTITY, from, true);
        check(Simple::Ring(0.0), DAffine3::IDENTITY, from, true);
    }
    check(Simple::Ring(0.6), DAffine3::IDENTITY, ABOVE, true);
}

#[test]
fn flat_pieces_under_a_map() {
    check(Simple::Triangle, skewed(), FAR, true);
    // A parallelogram, which is drawn by halves, and an elliptic ring.
    check(Simple::Square, skewed(), FAR, true);
    check(Simple::Ring(0.3), skewed(), FAR, true);
}

#[test]
fn spheres() {
    check(Simple::Sphere, DAffine3::IDENTITY, Vec3::new(0.0, 3.0, 1.0), true);
    check(Simple::Sphere, DAffine3::IDENTITY, Vec3::new(0.0, 0.6, 0.8) * 1.01, true);
    check(Simple::Sphere, DAffine3::IDENTITY, Vec3::new(0.5, 0.2, -0.3), true);
    check(Simple::Sphere, DAffine3::IDENTITY, Vec3::NEG_Z, true);
}

#[test]
fn ellipsoids_and_cones() {
    // From inside: towards an outline the density grows without bound, which no quadrature follows.
    check(Simple::Sphere, skewed(), Vec3::new(0.4, 0.1, 0.0), false);
    check(
        Simple::Frustum([1.0, 0.4]),
        skewed(),
        skewed().transform_point3(DVec3::new(0.1, 0.1, 0.4)).as_vec3(),
        false,
    );
    check(Simple::Frustum([0.5, 0.5]), DAffine3::IDENTITY, Vec3::new(0.0, 0.2, 0.7), false);
}

/// From outside they are drawn through their silhouettes: beside them, beyond both ends, near and far, cut off at an apex.
#[test]
fn silhouettes() {
    let out = |x: f64, y: f64, z: f64| skewed().transform_point3(DVec3::new(x, y, z)).as_vec3();
    check(Simple::Sphere, skewed(), FAR, false);
    check(Simple::Sphere, skewed(), out(0.9, 0.6, 0.1), false);
    let cylinder = Simple::Frustum([0.5, 0.5]);
    check(cylinder, DAffine3::IDENTITY, Vec3::new(0.8, 0.1, 0.4), false);
    check(cylinder, DAffine3::IDENTITY, Vec3::new(-0.5, 0.7, 1.6), false);
    check(cylinder, DAffine3::IDENTITY, 3.0 * FAR, false);
    check(cylinder, skewed(), out(0.3, -0.9, -0.5), false);
    for radii in [[1.0, 0.4], [0.3, 1.2], [1.0, 0.0]] {
        check(Simple::Frustum(radii), skewed(), out(2.0, 0.5, 0.4), false);
        check(Simple::Frustum(radii), DAffine3::IDENTITY, Vec3::new(-1.5, 1.0, 1.5), false);
    }
    check(Simple::Frustum([0.8, 0.0]), DAffine3::IDENTITY, Vec3::new(0.9, 0.1, -1.0), false);
    check(Simple::Frustum([0.8, 0.0]), skewed(), out(0.1, 0.1, 2.5), false);
}

/// All that can be seen is drawn: estimates of what the outer side sends have the mean that drawing by area has, and less variance.
#[test]
fn silhouettes_cover_what_is_seen() {
    for (simple, from) in [
        (Simple::Sphere, Vec3::new(1.5, 0.3, 1.0)),
        (Simple::Frustum([0.5, 0.5]), Vec3::new(1.0, 0.3, 1.8)),
        (Simple::Frustum([0.5, 0.5]), Vec3::new(0.2, 0.9, 0.5)),
        (Simple::Frustum([0.9, 0.2]), Vec3::new(1.6, 1.2, -0.3)),
    ] {
        let patch = match simple {
            Simple::Sphere => Patch::curved(Canonical::Sphere, DAffine3::IDENTITY).unwrap(),
            other => other.patch(&DAffine3::IDENTITY),
        };
        let moments = |patch: &Patch| {
            const N: u32 = 100_000;
            let (mut sum, mut squares) = (0.0, 0.0);
            for i in 0..N {
                let Some(PatchDirection { at, wi, pdf }) = patch.sample(from, draw(i)) else { continue };
                let again = patch.pdf(from, at.p, at.n);
                assert!((again / pdf - 1.0).abs() < 2e-3, "{simple:?}: {} {again}", pdf);
                if at.n.dot(wi) > 0.0 {
                    continue;
                }
                // Something that differs over the surface.
                let e = f64::from((1.5 + at.p.z + 0.5 * wi.x) / pdf);
                (sum, squares) = (sum + e, squares + e * e);
            }
            let n = f64::from(N);
            (sum / n, (squares / n - (sum / n).powi(2)) / n)
        };
        let (through, by_area) = (moments(&patch), moments(&patch.clone().by_area().unwrap()));
        let sigma = (through.1 + by_area.1).sqrt();
        assert!((through.0 - by_area.0).abs() < 4.5 * sigma, "{simple:?}: {through:?} {by_area:?}");
        assert!(through.1 < by_area.1, "{simple:?}: {through:?} {by_area:?}");
    }
}

/// Every position of a patch has coordinates, also where the patch has moved to.
#[test]
fn coordinates_name_places() {
    let moved = DAffine3::from_scale_rotation_translation(
        DVec3::splat(1.5),
        DQuat::from_rotation_x(0.8),
        DVec3::new(0.1, -0.4, 0.7),
    );
    let flat = [Simple::Triangle, Simple::Square, Simple::Ring(0.3)];
    let curved = [Simple::Sphere, Simple::Frustum([1.0, 0.4]), Simple::Torus(0.4), Simple::Torus(1.5)];
    let shapes = [&flat[..], &curved].concat();
    for (simple, map) in shapes.iter().flat_map(|s| [DAffine3::IDENTITY, skewed()].map(|map| (s, map))) {
        let patch = simple.patch(&map);
        let [here, there] = [None, Some(moved)].map(|moved| PlacedPatch { patch: &patch, moved });
        for k in 0..200 {
            let coordinates = 0.01 + 0.98 * draw(k);
            let drawn = [here, there].map(|patch| patch.point_at(coordinates).unwrap());
            let [at, image] = drawn.map(|drawn| drawn.at);
            let [density, of_image] = drawn.map(|drawn| drawn.pdf_area);
            let mapped = moved.transform_point3(at.p.as_dvec3()).as_vec3();
            assert!(image.p.distance(mapped) < 1e-5, "{simple:?}: {} for {mapped}", image.p);
            let again = [here.coordinates(at.p), there.coordinates(image.p)];
            assert!(
                again.iter().all(|c| c.distance(coordinates) < 1e-4),
                "{simple:?}: {again:?} {coordinates}"
            );
            assert!((of_image * 2.25 / density - 1.0).abs() < 1e-3, "{simple:?}: {of_image} {density}");
        }
    }
}

#[test]
fn tori() {
    // From the middle of tubes that leave no hole all of the surface is in view, and none of it edge on.
    check(Simple::Torus(2.0), DAffine3::IDENTITY, Vec3::new(0.1, 0.05, 0.0), false);
    check(
        Simple::Torus(1.5),
        skewed(),
        skewed().transform_point3(DVec3::new(0.0, 0.1, 0.1)).as_vec3(),
        false,
    );
}

#[test]
fn skies_with_their_sun() {
    use crate::background::Background;
    use crate::daylight::{Sky, SkySettings, Sun};

    let with = Sky::new(&AFTERNOON);
    let without = Sky::new(&SkySettings { sun: false, ..AFTERNOON });
    let (to_sun, sun_share) = (with.sun.as_ref().unwrap().direction, with.sun_share());
    let from_sun = with.sun.as_ref().unwrap().radiance.luminance() * Sun::SOLID_ANGLE * to_sun.y;
    let sky = SkyLight::new(std::sync::Arc::new(Background::Sky(Box::new(with))));
    // Irradiance of a level surface: the dome's by a fine sum, and the sun's by its solid angle.
    let (mut sun_hits, mut sum, mut squares, n) = (0, 0.0, 0.0, 200_000);
    for i in 0..n {
        let s = sample_li(&sky, Vec3::ZERO, draw(i)).unwrap();
        let again = sky.pdf_li(&Receiver::default(), &s.at, s.wi);
        assert!((again / s.pdf - 1.0).abs() < 1e-2, "{}", s.wi);
        sun_hits += u32::from(s.pdf > 1000.0);
        let e = f64::from(s.radiance.luminance() * s.wi.y.max(0.0) / s.pdf);
        sum += e;
        squares += e * e;
    }
    let mean = sum / f64::from(n);
    let sigma = ((squares / f64::from(n) - mean * mean) / f64::from(n)).sqrt();
    let (rows, columns) = (300, 600);
    let mut dome = 0.0;
    for i in 0..rows * columns {
        let y = (f64::from(i / columns) + 0.5) / f64::from(rows);
        let (r, phi) =
            ((1.0 - y * y).sqrt(), std::f64::consts::TAU * f64::from(i % columns) / f64::from(columns));
        let d = DVec3::new(r * phi.cos(), y, r * phi.sin()).as_vec3();
        dome +=
            f64::from(without.color(d).luminance()) * y * std::f64::consts::TAU / f64::from(rows * columns);
    }
    let expected = dome + f64::from(from_sun);
    // The dome's sum has an error of its own near the horizon and the sun.
    assert!((mean - expected).abs() < 4.5 * sigma + 2e-3 * expected, "{mean} ± {sigma} for {expected}");
    let share = f64::from(sun_hits) / f64::from(n);
    assert!((share - f64::from(sun_share)).abs() < 5e-3, "{share}");
}
