//! Light that leaves an emitter: as much as its power says, drawn with the density it names.

use std::sync::Arc;

use super::*;
use crate::background::Background;
use crate::family::Pooled;
use kajo_math::{Aabb, Frame};
use kajo_scene::IesFile;

pub(crate) const WORLD: Ball = Ball { center: Vec3::new(1.0, -0.5, 0.3), radius: 2.5 };

fn point(attenuation: [f32; 3]) -> PointLight {
    PointLight {
        position: Vec3::new(0.3, 0.2, -0.4),
        intensity: Spectrum::WHITE,
        emission: Emission::from_rgb([2.0; 3]),
        attenuation,
    }
}

fn area(patch: Patch, sides: Sides) -> AreaLight {
    AreaLight {
        patch,
        drift: None,
        varied: None,
        emission: Emission::from_rgb([2.0; 3]),
        sides,
        primitive: 0,
        part: 0,
    }
}

/// One light of each kind with the power it has.
pub(crate) fn emitters() -> (Lights, Vec<(LightId, f64)>) {
    let mut lights = Lights::default();
    let mut list = Vec::new();
    let ball = Patch::Sphere { center: DVec3::new(0.5, 0.0, 0.0), radius: 0.7 };
    let ring = Patch::Disk(DiskPatch { center: DVec3::Y, axes: [2.0 * DVec3::X, DVec3::Z], inner: 0.5 });
    let cone = Patch::curved(Canonical::Frustum([1.0, 0.2]), DAffine3::from_scale(DVec3::new(1.0, 2.0, 1.5)));
    let cone = cone.expect("a cone");
    for (patch, sides) in [
        (square(1.0), Sides::Front),
        (square(1.0), Sides::Both),
        (ball, Sides::Front),
        (ring, Sides::Back),
        (cone, Sides::Both),
    ] {
        let power = if sides == Sides::Both { 2.0 } else { 1.0 } * 2.0 * PI * patch.area();
        list.extend(area(patch, sides).store(&mut lights).map(|id| (id, power)));
    }
    list.extend(point([0.0, 0.0, 1.0]).store(&mut lights).map(|id| (id, 8.0 * PI)));
    let axis = Vec3::new(0.6, -0.8, 0.0);
    let spot = SpotLight { point: point([0.0, 0.0, 1.0]), axis, cone: Cone { inner: 0.1, outer: 0.5 } };
    // 2 pi I (1 - (cos inner + cos outer) / 2), of an intensity of 2.
    list.extend(spot.store(&mut lights).map(|id| (id, 4.0 * PI * (1.0 - 0.7))));
    let shadow = PI * 6.25;
    for height in [0.0, 0.1] {
        let emission = Emission::from_rgb([2.0; 3]);
        let to_light = Vec3::new(0.0, 0.6, 0.8);
        let light = DirectionalLight { to_light, height, intensity: Spectrum::WHITE, emission };
        // Of a wide disc it is the irradiance across the middle that is given.
        let widened = 2.0 / (2.0 - f64::from(height));
        list.extend(light.store(&mut lights).map(|id| (id, 2.0 * shadow * widened)));
    }
    let sky = SkyLight::new(Arc::new(Background::constant([2.0; 3])));
    list.extend(sky.store(&mut lights).map(|id| (id, 8.0 * PI * shadow)));
    // Its intensity is linear in the angle from its axis: 2 pi times the integral of (80 - 60 v 2/pi) sin v.
    let file = IesFile {
        vertical_deg: vec![0.0, 90.0],
        horizontal_deg: vec![0.0],
        candela: vec![80.0, 20.0],
        lamp_lumens: None,
        watts: 1.0,
    };
    let luminaire = PhotometricLight {
        position: Vec3::new(0.3, 0.2, -0.4),
        frame: Frame::from_normal(axis),
        photometry: Arc::new(file.into()),
        emission: Emission::from_rgb([2.0; 3]),
        intensity: Spectrum::WHITE,
    };
    let power = 2.0 * 2.0 * PI * (80.0 - 60.0 * 2.0 / PI);
    list.extend(luminaire.store(&mut lights).map(|id| (id, power)));
    (lights, list)
}

/// A box in the ball.
fn world_box() -> Aabb {
    let half = Vec3::splat(2.5 / 3f32.sqrt());
    Aabb { min: WORLD.center - half, max: WORLD.center + half }
}

fn numbers(i: u32) -> [Vec2; 2] {
    let s = Stream::new(23, [i, 0], 0);
    [Vec2::new(s.uniform(0), s.uniform(1)), Vec2::new(s.uniform(2), s.uniform(3))]
}

#[test]
fn a_light_sends_out_its_power() {
    let (lights, list) = emitters();
    for (i, (id, power)) in list.into_iter().enumerate() {
        let n = 40_000;
        let (mut sum, mut squares) = (0.0, 0.0);
        for k in 0..n {
            let emitted = lights.emit(id, 0.0, numbers(k), &Wavelengths::RGB, &WORLD);
            let carried = emitted.map_or(0.0, |emitted| f64::from(emitted.power()[0]));
            sum += carried;
            squares += carried * carried;
        }
        let mean = sum / f64::from(n);
        let sigma = ((squares / f64::from(n) - mean * mean).max(0.0) / f64::from(n)).sqrt();
        assert!((mean - power).abs() < 4.5 * sigma + 1e-5 * power, "light {i}: {mean} ± {sigma} for {power}");
        // Power as lights are chosen by.
        let told = f64::from(lights.power(id, &WORLD));
        assert!((told / power - 1.0).abs() < 0.06, "light {i}: {told} for {power}");
    }
}

#[test]
fn densities_of_drawn_light_are_those_of_the_light() {
    let (lights, list) = emitters();
    for (i, (id, _)) in list.into_iter().enumerate() {
        for k in 0..500 {
            let Some(emitted) = lights.emit(id, 0.0, numbers(k), &Wavelengths::RGB, &WORLD) else { continue };
            assert!((emitted.d.length() - 1.0).abs() < 1e-5);
            let n = match emitted.origin {
                Target::Surface { n, .. } => n,
                Target::Point(_) | Target::Infinity => Vec3::ZERO,
            };
            // Of light from far away any point on the way tells.
            let p = if emitted.is_infinite() { emitted.p + 1.7 * emitted.d } else { emitted.p };
            let again = lights.emission_pdf(id, 0.0, [p, n], emitted.d, &WORLD);
            let near = |a: f32, b: f32| (a / b - 1.0).abs() < 1e-3;
            let same = near(again.place, emitted.pdf.place) && near(again.direction, emitted.pdf.direction);
            // On the very rim of the disk rounding decides.
            let rim =
                emitted.is_infinite() && (p - WORLD.center).cross(emitted.d).length() > 0.999 * WORLD.radius;
            assert!(same || rim, "light {i}: {again:?} {:?}", emitted.pdf);
        }
    }
}

#[test]
fn light_leaves_no_light_where_it_has_none() {
    let (lights, list) = emitters();
    let pdf = |i: usize, n: Vec3, d: Vec3| lights.emission_pdf(list[i].0, 0.0, [Vec3::Y, n], d, &WORLD);
    // The square's front looks down, as its edges say.
    let n = square(1.0).normal().unwrap().as_vec3();
    assert!(pdf(0, n, n).direction > 0.0 && pdf(0, n, -n).direction == 0.0);
    assert!(pdf(1, n, n).direction == pdf(1, n, -n).direction);
    let axis = Vec3::new(0.6, -0.8, 0.0);
    assert!(pdf(6, n, axis).direction > 0.0 && pdf(6, n, -axis).direction == 0.0);
    let d = Vec3::new(0.0, -0.6, -0.8);
    let from_far = |p: Vec3| lights.emission_pdf(list[7].0, 0.0, [p, Vec3::ZERO], d, &WORLD).place;
    assert!(from_far(WORLD.center) > 0.0);
    assert_eq!(from_far(WORLD.center + 2.6 * Vec3::X), 0.0, "beside the disk");
    assert_eq!(from_far(WORLD.center - 2.6 * d), 0.0, "before the disk");
    assert!(from_far(WORLD.center + 90.0 * d) > 0.0, "far behind");
}

#[test]
fn a_falloff_of_its_own_is_made_up_for() {
    let emitted = |attenuation| {
        point(attenuation)
            .emit(0.0, numbers(1), &Wavelengths::RGB, &WORLD)
            .expect("light into all directions")
    };
    assert_eq!(emitted([0.0, 0.0, 1.0]).share_at(3.0), 1.0);
    assert!((emitted([0.5, 0.25, 2.0]).share_at(3.0) - 9.0 / 19.25).abs() < 1e-6);
}

#[test]
fn lights_are_drawn_by_their_power() {
    let (lights, list) = emitters();
    let ids: Vec<(LightId, u8)> = list.iter().map(|light| (light.0, 0)).collect();
    let emitters = Emitters::new(ids, list.len() as u32, None, &lights);
    let departures = Departures::new(&emitters, &lights, &world_box());
    let all: f64 = list.iter().map(|light| light.1).sum();
    for (i, (_, power)) in (0..).zip(&list) {
        let probability = f64::from(departures.probability(i));
        assert!((probability / (power / all) - 1.0).abs() < 0.08, "{i}: {probability} for {}", power / all);
    }
    let n = 100_000;
    let mut counts = vec![0u32; list.len()];
    for k in 0..n {
        let light = departures.choose((k as f32 + 0.5) / n as f32).expect("a light");
        counts[light as usize] += 1;
    }
    for (i, count) in (0..).zip(counts) {
        let expected = departures.probability(i) * n as f32;
        assert!((count as f32 - expected).abs() < 2.0 + 1e-3 * expected, "{i}: {count} for {expected}");
    }
    let none = Departures::new(&Emitters::default(), &lights, &world_box());
    assert_eq!(none.choose(0.3), None);
}
