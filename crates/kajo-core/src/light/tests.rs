use std::f64::consts::PI;

use kajo_color::{Emission, Wavelengths};
use kajo_math::solid_angle::polygon_irradiance;
use kajo_math::{DAffine3, DQuat, DVec3, Ray, Vec2, Vec3, rng::Stream};

use super::*;
use crate::daylight::SkySettings;
use crate::ids::ObjectId;
use crate::shape::{Canonical, DiskPatch, Patch, PatchDirection, PlacedPatch, Surface, Torus};

mod choice;
pub(crate) mod densities;
pub(crate) mod emission;
mod many;
mod traced;

/// A clear sky with its sun, dim enough to be told from other lights.
pub(crate) const AFTERNOON: SkySettings = SkySettings {
    turbidity: 3.0,
    elevation_deg: 35.0,
    azimuth_deg: 200.0,
    ground: 0.2,
    scale: 0.1,
    sun: true,
};

/// Surfaces whose radiance is everywhere the mean.
pub(crate) struct MeanEmission;

impl EmissiveSurfaces for MeanEmission {
    fn radiance(
        &self,
        light: &AreaLight,
        _emission: VariedEmissionId,
        _leaving: LeavingLight,
        _time: f32,
        wavelengths: &Wavelengths,
    ) -> Spectrum {
        light.emission.at(wavelengths)
    }

    fn shows(&self, _light: &AreaLight, _p: Vec3, _time: f32) -> bool {
        true
    }
}

/// What a light sends to a point.
pub(crate) fn sample_li(light: &impl Emitter, p: Vec3, u: Vec2) -> Option<LightLiSample> {
    light.sample_li(&Receiver { p, ..Receiver::default() }, u, &Wavelengths::RGB, &MeanEmission)
}

fn draw(i: u32) -> Vec2 {
    let stream = Stream::new(21, [i, 0], 0);
    Vec2::new(stream.uniform(0), stream.uniform(1))
}

/// Irradiance of unit radiance from both sides of a patch, and the standard error of its estimate.
fn irradiance(patch: &Patch, from: Vec3, n: Vec3, samples: u32) -> (f64, f64) {
    let (mut sum, mut squares) = (0.0, 0.0);
    for i in 0..samples {
        let Some(PatchDirection { at, wi, pdf }) = patch.sample(from, draw(i)) else { continue };
        assert!(wi.distance((at.p - from).normalize()) < 1e-6, "{patch:?}: {wi} to {}", at.p);
        let again = patch.pdf(from, at.p, at.n);
        assert!((again / pdf - 1.0).abs() < 1e-3, "{patch:?}: {again} for {}", pdf);
        let e = f64::from(wi.dot(n).max(0.0) / pdf);
        sum += e;
        squares += e * e;
    }
    let n = f64::from(samples);
    let mean = sum / n;
    (mean, ((squares / n - mean * mean).max(0.0) / n).sqrt())
}

fn square(height: f64) -> Patch {
    Patch::parallelogram(DVec3::new(-0.5, height, -0.5), [DVec3::X, DVec3::Z])
}

#[track_caller]
fn assert_near((found, sigma): (f64, f64), expected: f64) {
    let allowed = 4.5 * sigma + 2e-6 * expected;
    assert!((found - expected).abs() < allowed, "{found} ± {sigma} for {expected}");
}

#[test]
fn squares_give_what_lambert_says() {
    let up = Vec3::Y;
    for (height, expected) in [(0.5, 1.740_840), (1.0, 0.752_275), (2.0, 0.230_837)] {
        assert_near(irradiance(&square(height), Vec3::ZERO, up, 20_000), expected);
    }
    let aside = square(1.0);
    assert_near(irradiance(&aside, Vec3::new(1.0, 0.0, 0.0), up, 20_000), 0.265_005);
    assert_near(irradiance(&aside, Vec3::new(0.5, 0.0, 0.5), up, 20_000), 0.435_210);
}

#[test]
fn triangles_and_parallelograms_give_what_lambert_says() {
    let corners = [DVec3::new(0.0, 1.0, 0.0), DVec3::new(1.0, 1.0, 0.0), DVec3::new(0.0, 1.0, 1.0)];
    assert_near(irradiance(&Patch::Triangle(corners), Vec3::ZERO, Vec3::Y, 20_000), 0.302_300);
    let (corner, a, b) = (DVec3::new(-0.3, 0.8, 0.1), DVec3::new(1.0, 0.2, 0.0), DVec3::new(0.4, 0.1, 0.7));
    let skewed = Patch::parallelogram(corner, [a, b]);
    let outline = [corner, corner + a, corner + a + b, corner + b];
    let expected = polygon_irradiance(DVec3::ZERO, DVec3::Y, &outline).abs();
    assert_near(irradiance(&skewed, Vec3::ZERO, Vec3::Y, 40_000), expected);
    // Far away it is drawn by area.
    let far = Vec3::new(0.0, -400.0, 3.0);
    let expected = polygon_irradiance(far.as_dvec3(), DVec3::Y, &outline).abs();
    assert_near(irradiance(&skewed, far, Vec3::Y, 1000), expected);
}

#[test]
fn disks_and_spheres_have_closed_forms() {
    let disk = |inner: f64| Patch::Disk(DiskPatch { center: DVec3::Y, axes: [DVec3::X, DVec3::Z], inner });
    assert_near(irradiance(&disk(0.0), Vec3::ZERO, Vec3::Y, 40_000), PI / 2.0);
    // A ring is the difference of two disks.
    assert_near(irradiance(&disk(0.5), Vec3::ZERO, Vec3::Y, 40_000), PI / 2.0 - PI * 0.25 / 1.25);
    let sphere = Patch::Sphere { center: DVec3::new(0.0, 3.0, 0.0), radius: 1.0 };
    assert_near(irradiance(&sphere, Vec3::ZERO, Vec3::Y, 20_000), PI / 9.0);
}

#[test]
fn a_sphere_around_the_receiver_fills_half_the_sky() {
    for center in [Vec3::ZERO, Vec3::new(0.5, 0.0, 0.1), Vec3::new(0.0, 0.999, 0.0)] {
        let sphere = Patch::Sphere { center: DVec3::ZERO, radius: 1.0 };
        let (found, sigma) = irradiance(&sphere, center, Vec3::Y, 200_000);
        assert!((found - PI).abs() < 5.0 * sigma + 1e-3, "{center}: {found} ± {sigma}");
    }
}

#[test]
fn maps_keep_shapes_what_they_are() {
    let map = DAffine3::from_scale_rotation_translation(
        DVec3::splat(2.0),
        DQuat::from_rotation_x(0.7),
        DVec3::new(0.2, 4.0, -0.3),
    );
    let ball = Patch::Sphere { center: DVec3::ZERO, radius: 0.5 }.transformed(&map).unwrap();
    assert!(matches!(ball, Patch::Sphere { radius, .. } if (radius - 1.0).abs() < 1e-12));
    // An ellipsoid, and the same as a ball where nothing is stretched.
    let curved =
        Patch::curved(Canonical::Sphere, DAffine3::from_translation(DVec3::new(0.0, 3.0, 0.0))).unwrap();
    assert_near(irradiance(&curved, Vec3::ZERO, Vec3::Y, 400_000), 2.0 * PI / 9.0);
    let flat = map * DAffine3::from_scale(DVec3::new(1.0, 0.25, 1.0));
    let Some(Patch::Curved(ellipsoid)) =
        Patch::Sphere { center: DVec3::ZERO, radius: 1.0 }.transformed(&flat)
    else {
        panic!("an ellipsoid is expected");
    };
    // Half axes 2, 2 and 0.5: 2 pi a^2 (1 + (1 - e^2)/e atanh e).
    let e = (1.0f64 - 0.0625).sqrt();
    let expected = 2.0 * PI * 4.0 * (1.0 + (1.0 - e * e) / e * e.atanh());
    let area = Patch::Curved(ellipsoid).area();
    assert!((area / expected - 1.0).abs() < 1e-3, "{area} for {expected}");
}

#[test]
fn the_side_of_a_cone_has_its_area_and_its_normals() {
    let map = DAffine3::from_scale(DVec3::new(1.0, 1.0, 2.0));
    let cone = Patch::curved(Canonical::Frustum([1.0, 0.5]), map).unwrap();
    let expected = PI * 1.5 * (4.0f64 + 0.25).sqrt();
    assert!((cone.area() / expected - 1.0).abs() < 1e-6);
    for i in 0..100 {
        let s = cone.sample_area(draw(i)).unwrap().at;
        assert!(s.n.dot(Vec3::new(s.p.x, s.p.y, 0.0)) > 0.0 && s.n.z > 0.0);
        assert!((s.p.truncate().length() - (1.0 - 0.25 * s.p.z)).abs() < 1e-5);
    }
}

#[test]
fn mirrored_pieces_keep_their_outer_side() {
    let mirror = DAffine3::from_scale(DVec3::new(-1.0, 1.0, 1.0));
    let pieces = [
        square(1.0),
        Patch::Triangle([DVec3::ZERO, DVec3::Z, DVec3::X]),
        Patch::Disk(DiskPatch { center: DVec3::ZERO, axes: [DVec3::Z, DVec3::X], inner: 0.0 }),
    ];
    for piece in pieces {
        let (before, after) =
            (piece.normal().unwrap(), piece.transformed(&mirror).unwrap().normal().unwrap());
        assert!((before - after).length() < 1e-12, "{before} became {after}");
    }
}

#[test]
fn delta_lights_follow_their_laws() {
    let one = Emission::from_rgb([1.0; 3]);
    let light = |attenuation| PointLight {
        position: Vec3::new(0.0, 2.0, 0.0),
        intensity: Spectrum::WHITE,
        emission: one.clone(),
        attenuation,
    };
    let at = |light: &PointLight| sample_li(light, Vec3::ZERO, Vec2::ZERO).unwrap();
    let sample = at(&light([0.0, 0.0, 1.0]));
    assert!(sample.is_delta && sample.wi == Vec3::Y && sample.pdf == 1.0);
    assert!((sample.radiance[0] - 0.25).abs() < 1e-6);
    assert!((at(&light([1.0, 0.0, 0.0])).radiance[0] - 1.0).abs() < 1e-6);
}

#[test]
fn an_area_light_emits_from_its_sides_only() {
    let light = |sides| AreaLight {
        drift: None,
        varied: None,
        density: None,
        patch: square(1.0),
        emission: Emission::from_rgb([1.0; 3]),
        sides,
        extent: PatchExtent::Whole,
        object: ObjectId::default(),
        part: 0,
    };
    // The normal of the square is X x Z = -Y: its front looks down.
    let lit = |sides, from| sample_li(&light(sides), from, Vec2::splat(0.5)).is_some();
    let (below, above) = (Vec3::ZERO, Vec3::new(0.0, 2.0, 0.0));
    assert!(lit(Sides::Front, below) && !lit(Sides::Front, above));
    assert!(!lit(Sides::Back, below) && lit(Sides::Back, above));
    assert!(lit(Sides::Both, below) && lit(Sides::Both, above));
    assert!(light(Sides::Front).illuminate(above, 0.0).intensity.is_black());
    let classic = light(Sides::Front).illuminate(Vec3::new(0.0, -9.0, 0.0), 0.0);
    // Far away a light is a point: L A / d^2 / pi.
    assert!((classic.intensity[0] * 100.0 * std::f32::consts::PI - 1.0).abs() < 1e-3);
}

#[test]
fn a_tilted_receiver_and_any_polygon_get_what_lambert_says() {
    let tilted = Vec3::new(0.5, 0.75f32.sqrt(), 0.0);
    assert_near(irradiance(&square(1.0), Vec3::ZERO, tilted, 40_000), 0.651_489);
    // Regular and irregular polygons as fans of triangles, partly below the horizon of some receivers.
    for k in 0..8 {
        let s = Stream::new(41, [k, 0], 0);
        let corners = 3 + k as usize % 5;
        let ring: Vec<DVec3> = (0..corners)
            .map(|i| {
                let angle = std::f64::consts::TAU * (i as f64 + 0.7 * f64::from(s.uniform(i as u32)))
                    / corners as f64;
                DVec3::new(angle.cos(), 0.9, angle.sin())
            })
            .collect();
        let n = Vec3::new(s.uniform(20) - 0.5, 0.6, s.uniform(21) - 0.5).normalize();
        let (mut sum, mut variance) = (0.0, 0.0);
        for i in 1..corners - 1 {
            let fan = Patch::Triangle([ring[0], ring[i], ring[i + 1]]);
            let (mean, sigma) = irradiance(&fan, Vec3::ZERO, n, 20_000);
            sum += mean;
            variance += sigma * sigma;
        }
        let expected = polygon_irradiance(DVec3::ZERO, n.as_dvec3(), &ring).abs();
        assert_near((sum, variance.sqrt()), expected);
    }
}

#[test]
fn disks_at_two_heights() {
    for (height, expected) in [(1.0, PI / 2.0), (2.0, PI / 5.0)] {
        let axes = [DVec3::X, DVec3::Z];
        let disk = Patch::Disk(DiskPatch { center: DVec3::new(0.0, height, 0.0), axes, inner: 0.0 });
        assert_near(irradiance(&disk, Vec3::ZERO, Vec3::Y, 40_000), expected);
    }
}

#[test]
fn spots_send_their_profile_at_every_angle() {
    let cos = |degrees: f64| degrees.to_radians().cos();
    let point = PointLight {
        position: Vec3::ZERO,
        intensity: Spectrum::WHITE,
        emission: Emission::from_rgb([3.0; 3]),
        attenuation: [0.0, 0.0, 1.0],
    };
    let cone = SpotCone::new(15f32.to_radians(), 35f32.to_radians());
    let spot = SpotLight { point, axis: Vec3::NEG_Y, cone };
    for i in 0..20 {
        let angle = 2.0 * f64::from(i) + 0.5;
        let (sin, c) = angle.to_radians().sin_cos();
        let p = 2.0 * Vec3::new(sin as f32, -c as f32, 0.0);
        let x = ((c - cos(35.0)) / (cos(15.0) - cos(35.0))).clamp(0.0, 1.0);
        let expected = 3.0 * x * x * (3.0 - 2.0 * x) / 4.0;
        let found = sample_li(&spot, p, Vec2::ZERO).map_or(0.0, |s| f64::from(s.radiance[0]));
        assert!((found - expected).abs() < 1e-4, "{angle}: {found} {expected}");
    }
}

#[test]
fn a_wide_directional_light_keeps_its_irradiance_and_stays_on_its_disc() {
    for degrees in [0.0f32, 0.53, 20.0, 120.0] {
        let sin = (0.25 * degrees).to_radians().sin();
        let to_light = Vec3::new(0.48, 0.6, 0.64);
        let emission = Emission::from_rgb([5.0; 3]);
        let light =
            DirectionalLight { to_light, height: 2.0 * sin * sin, intensity: Spectrum::WHITE, emission };
        let (mut sum, n) = (0.0, 40_000);
        for i in 0..n {
            let sample = sample_li(&light, Vec3::ZERO, draw(i)).unwrap();
            let cos = f64::from(sample.wi.dot(to_light));
            let limit = f64::from(0.5 * degrees).to_radians().cos();
            assert!(cos > limit - 1e-6 && sample.is_delta == (degrees == 0.0));
            sum += f64::from(sample.radiance[0] / sample.pdf) * cos / f64::from(n);
            let again = light.pdf_li(&Receiver::default(), &sample.at, sample.wi);
            assert!(again == sample.pdf || cos < limit + 1e-6, "{degrees}: {again} for {}", sample.pdf);
        }
        assert!((sum / 5.0 - 1.0).abs() < 3e-3, "{degrees}: {sum}");
    }
}
