//! Light that leaves a light: as much as its power says, drawn with the density it names.

use std::sync::Arc;

use super::densities::{KnownSurface, Simple};
use super::*;
use crate::background::Background;
use crate::family::Pooled;
use crate::ids::{LightGroup, LightIndex};
use kajo_math::{Aabb, Frame};
use kajo_scene::IesFile;

pub(crate) const WORLD: BoundingSphere = BoundingSphere { center: Vec3::new(1.0, -0.5, 0.3), radius: 2.5 };

fn point(attenuation: [f32; 3]) -> PointLight {
    PointLight {
        position: Vec3::new(0.3, 0.2, -0.4),
        intensity: Spectrum::WHITE,
        emission: Emission::from_rgb([2.0; 3]),
        attenuation,
    }
}

pub(super) fn area(patch: Patch, sides: Sides) -> AreaLight {
    AreaLight {
        patch,
        drift: None,
        varied: None,
        density: None,
        emission: Emission::from_rgb([2.0; 3]),
        sides,
        extent: PatchExtent::Whole,
        object: ObjectId::default(),
        part: 0,
    }
}

/// A light whose power is known.
pub(crate) struct KnownLight {
    pub id: LightId,
    pub power: f64,
    /// Where its surface is, and a receiver that light comes to.
    pub surface: Option<KnownSurface>,
}

/// Lights of each kind with the power they have.
pub(crate) fn every_light() -> (Lights, Vec<KnownLight>) {
    let mut lights = Lights::default();
    let mut list = Vec::new();
    let in_plane = |corner: DVec3, x: DVec3| DAffine3::from_cols(x, DVec3::Z, DVec3::NEG_Y, corner);
    let square = in_plane(DVec3::new(-0.5, 1.0, -0.5), DVec3::X);
    let ring = in_plane(DVec3::Y, 2.0 * DVec3::X);
    let ball =
        DAffine3::from_translation(DVec3::new(0.5, 0.0, 0.0)) * DAffine3::from_scale(DVec3::splat(0.7));
    let cone = DAffine3::from_scale(DVec3::new(1.0, 2.0, 1.5));
    let (below, above) = (Vec3::new(0.3, 0.2, -0.7), Vec3::new(-0.4, 1.9, 0.3));
    for (shape, map, sides, receiver) in [
        (Simple::Square, square, Sides::Front, below),
        (Simple::Square, square, Sides::Both, above),
        (Simple::Sphere, ball, Sides::Front, above),
        (Simple::Ring(0.5), ring, Sides::Back, above),
        (Simple::Frustum([1.0, 0.2]), cone, Sides::Both, Vec3::new(0.1, 0.2, 0.6)),
    ] {
        let patch = shape.patch(&map);
        let power = if sides == Sides::Both { 2.0 } else { 1.0 } * 2.0 * PI * patch.area();
        let surface = Some(KnownSurface::new(shape, map, receiver));
        list.extend(area(patch, sides).store(&mut lights).map(|id| KnownLight { id, power, surface }));
    }
    let mut known = |id: Option<LightId>, power| {
        list.push(KnownLight { id: id.expect("room"), power, surface: None });
    };
    known(point([0.0, 0.0, 1.0]).store(&mut lights), 8.0 * PI);
    let axis = Vec3::new(0.6, -0.8, 0.0);
    let spot = SpotLight { point: point([0.0, 0.0, 1.0]), axis, cone: SpotCone { inner: 0.1, outer: 0.5 } };
    // 2 pi I (1 - (cos inner + cos outer) / 2), of an intensity of 2.
    known(spot.store(&mut lights), 4.0 * PI * (1.0 - 0.7));
    let shadow = PI * 6.25;
    for height in [0.0, 0.1] {
        let emission = Emission::from_rgb([2.0; 3]);
        let to_light = Vec3::new(0.0, 0.6, 0.8);
        let light = DirectionalLight { to_light, height, intensity: Spectrum::WHITE, emission };
        // Of a wide disc it is the irradiance across the middle that is given.
        let widened = 2.0 / (2.0 - f64::from(height));
        known(light.store(&mut lights), 2.0 * shadow * widened);
    }
    let sky = SkyLight::new(Arc::new(Background::constant([2.0; 3])));
    known(sky.store(&mut lights), 8.0 * PI * shadow);
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
    known(luminaire.store(&mut lights), 2.0 * 2.0 * PI * (80.0 - 60.0 * 2.0 / PI));
    let (torus, receiver) = (Simple::Torus(0.5), Vec3::new(0.0, 0.2, 0.1));
    let patch = torus.patch(&cone);
    let power = 2.0 * PI * patch.area();
    let surface = Some(KnownSurface::new(torus, cone, receiver));
    let id = area(patch, Sides::Front).store(&mut lights);
    list.extend(id.map(|id| KnownLight { id, power, surface }));
    // Whose points are drawn by another density.
    let triangle = DAffine3::from_cols(DVec3::X, DVec3::Z, DVec3::NEG_Y, DVec3::new(-0.5, 1.0, -0.5));
    for (shape, map, sides, receiver) in [
        (Simple::Square, square, Sides::Front, below),
        (Simple::Triangle, triangle, Sides::Both, above),
        (Simple::Sphere, ball, Sides::Front, above),
        (Simple::Ring(0.5), ring, Sides::Back, above),
        (Simple::Frustum([1.0, 0.2]), cone, Sides::Both, Vec3::new(0.1, 0.2, 0.6)),
        (torus, cone, Sides::Both, receiver),
    ] {
        let patch = shape.patch(&map);
        let power = if sides == Sides::Both { 2.0 } else { 1.0 } * 2.0 * PI * patch.area();
        let luminance = |i: usize| 1.0 + (i * 29 % 13) as f32 / 4.0 + if i % 24 == 10 { 40.0 } else { 0.0 };
        let luminances: Vec<f32> = (0..48).map(luminance).collect();
        let density = EmissionDensity::new(&patch, [7, 5], &luminances, TableDetail::Sampled).map(Box::new);
        let surface = Some(KnownSurface::new(shape, map, receiver));
        assert!(density.is_some(), "{shape:?}");
        let light = AreaLight { density, ..area(patch, sides) };
        list.extend(light.store(&mut lights).map(|id| KnownLight { id, power, surface }));
    }
    (lights, list)
}

/// A box in the sphere.
fn world_box() -> Aabb {
    let half = Vec3::splat(2.5 / 3f32.sqrt());
    Aabb { min: WORLD.center - half, max: WORLD.center + half }
}

fn numbers(i: u32) -> LeNumbers {
    let s = Stream::new(23, [i, 0], 0);
    LeNumbers {
        position: Vec2::new(s.uniform(0), s.uniform(1)),
        direction: Vec2::new(s.uniform(2), s.uniform(3)),
    }
}

/// The light of these numbers that leaves.
fn leaving(lights: &Lights, id: LightId, k: u32) -> Option<LightLeSample> {
    lights.sample_le(id, 0.0, numbers(k), &Wavelengths::RGB, &WORLD, &MeanEmission)
}

#[test]
fn a_light_sends_out_its_power() {
    let (lights, list) = every_light();
    for (i, KnownLight { id, power, .. }) in list.into_iter().enumerate() {
        let n = 40_000;
        let (mut sum, mut squares) = (0.0, 0.0);
        for k in 0..n {
            let carried = leaving(&lights, id, k).map_or(0.0, |leaving| f64::from(leaving.power()[0]));
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
    let (lights, list) = every_light();
    for (i, KnownLight { id, .. }) in list.into_iter().enumerate() {
        for k in 0..500 {
            let Some(LightLeSample { at, d, pdf, .. }) = leaving(&lights, id, k) else { continue };
            assert!((d.length() - 1.0).abs() < 1e-5);
            // Of light from far away any point that it passes tells.
            let passed = match at {
                LightPoint::Infinite { through } => LightPoint::Infinite { through: through + 1.7 * d },
                near => near,
            };
            let again = lights.pdf_le(id, 0.0, &passed, d, &WORLD);
            let near = |a: f32, b: f32| (a / b - 1.0).abs() < 1e-3;
            let same = near(again.position, pdf.position) && near(again.direction, pdf.direction);
            // On the very rim of the disk rounding decides.
            let rim =
                at.is_infinite() && (passed.p() - WORLD.center).cross(d).length() > 0.999 * WORLD.radius;
            assert!(same || rim, "light {i}: {again:?} {pdf:?}");
        }
    }
}

#[test]
fn light_leaves_only_where_there_is_some() {
    let (lights, list) = every_light();
    let pdf = |i: usize, n: Vec3, d: Vec3| {
        let at = LightPoint::Surface { p: Vec3::Y, p_error: Vec3::ZERO, n };
        lights.pdf_le(list[i].id, 0.0, &at, d, &WORLD)
    };
    // The square's front looks down, as its edges say.
    let n = square(1.0).normal().unwrap().as_vec3();
    assert!(pdf(0, n, n).direction > 0.0 && pdf(0, n, -n).direction == 0.0);
    assert!(pdf(1, n, n).direction == pdf(1, n, -n).direction);
    let axis = Vec3::new(0.6, -0.8, 0.0);
    let spot = LightPoint::Position(lights.bounds(list[6].id).expect("a position").bounds.min);
    let from_spot = |d: Vec3| lights.pdf_le(list[6].id, 0.0, &spot, d, &WORLD).direction;
    assert!(from_spot(axis) > 0.0 && from_spot(-axis) == 0.0);
    assert_eq!(pdf(6, n, axis), EmissionPdf::default(), "no light leaves from elsewhere");
    let d = Vec3::new(0.0, -0.6, -0.8);
    let from_far =
        |through: Vec3| lights.pdf_le(list[7].id, 0.0, &LightPoint::Infinite { through }, d, &WORLD).position;
    assert!(from_far(WORLD.center) > 0.0);
    assert_eq!(from_far(WORLD.center + 2.6 * Vec3::X), 0.0, "beside the disk");
    assert_eq!(from_far(WORLD.center - 2.6 * d), 0.0, "before the disk");
    assert!(from_far(WORLD.center + 90.0 * d) > 0.0, "far behind");
}

#[test]
fn a_falloff_of_its_own_is_made_up_for() {
    let emitted = |attenuation| {
        point(attenuation)
            .sample_le(0.0, numbers(1), &Wavelengths::RGB, &WORLD, &MeanEmission)
            .expect("light into all directions")
    };
    assert_eq!(emitted([0.0, 0.0, 1.0]).share_at(3.0), 1.0);
    assert!((emitted([0.5, 0.25, 2.0]).share_at(3.0) - 9.0 / 19.25).abs() < 1e-6);
}

#[test]
fn lights_are_chosen_by_their_power() {
    let (lights, list) = every_light();
    let ids: Vec<(LightId, LightGroup)> =
        list.iter().map(|light| (light.id, LightGroup::default())).collect();
    let sampler = LightSampler::new(ids, list.len(), None, &lights);
    let by_power = PowerLightSampler::new(&sampler, &lights, &world_box());
    let all: f64 = list.iter().map(|light| light.power).sum();
    for (light, KnownLight { power, .. }) in LightIndex::all(list.len()).zip(&list) {
        let pmf = f64::from(by_power.pmf(light));
        assert!((pmf / (power / all) - 1.0).abs() < 0.08, "{light:?}: {pmf} for {}", power / all);
    }
    let n = 100_000;
    let mut counts = vec![0u32; list.len()];
    for k in 0..n {
        let chosen = by_power.sample((k as f32 + 0.5) / n as f32).expect("a light");
        assert_eq!(chosen.probability, by_power.pmf(chosen.light));
        counts[chosen.light.index()] += 1;
    }
    for (light, count) in LightIndex::all(list.len()).zip(counts) {
        let expected = by_power.pmf(light) * n as f32;
        assert!((count as f32 - expected).abs() < 2.0 + 1e-3 * expected, "{light:?}: {count} for {expected}");
    }
    let none = PowerLightSampler::new(&LightSampler::default(), &lights, &world_box());
    assert_eq!(none.sample(0.3), None);
}
