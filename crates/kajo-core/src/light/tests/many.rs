//! Ten thousand lights: the tree finds the same light as a uniform choice, with far less noise.

use super::*;
use kajo_math::rng::{mix, unit};

use crate::family::Pooled;
use crate::ids::{LightGroup, LightIndex};

/// A grid of 100 by 100 lights at height 1, one apart; every third is a small square, the others are points.
fn grid() -> (Lights, LightSampler) {
    let mut lights = Lights::default();
    let (mut points, mut areas) = (Vec::new(), Vec::new());
    for i in 0..10_000u32 {
        let at = DVec3::new(f64::from(i % 100) - 49.5, 1.0, f64::from(i / 100) - 49.5);
        // Of its own, so that what the tree gains does not change with the hash of samples.
        let strength = 0.2 + unit((mix(mix(mix(mix(31) ^ u64::from(i)))) >> 32) as u32);
        if i.is_multiple_of(3) {
            let patch = Patch::parallelogram(at, [0.1 * DVec3::X, 0.1 * DVec3::Z]);
            let emission = Emission::from_rgb([100.0 * strength; 3]);
            let area = AreaLight {
                patch,
                emission,
                drift: None,
                varied: None,
                density: None,
                sides: Sides::Both,
                extent: PatchExtent::Whole,
                object: ObjectId::from_index(i),
                part: 0,
            };
            areas.extend(area.store(&mut lights));
        } else {
            let point = PointLight {
                position: at.as_vec3(),
                intensity: Spectrum::WHITE,
                emission: Emission::from_rgb([strength; 3]),
                attenuation: [0.0, 0.0, 1.0],
            };
            points.extend(point.store(&mut lights));
        }
    }
    let first_area = points.len();
    points.extend(areas);
    let list = points.into_iter().map(|id| (id, LightGroup::default())).collect();
    let sampler = LightSampler::new(list, first_area, None, &lights);
    (lights, sampler)
}

/// Samples of [`estimate`].
const COUNT: u32 = 300_000;

/// The mean of samples of the irradiance at a receiver.
fn estimate(lights: &Lights, sampler: &LightSampler, to: &Receiver, choice: LightChoice) -> f64 {
    let mut sum = 0.0;
    for i in 0..COUNT {
        let s = Stream::new(32, [i, 0], 0);
        let (u, place) = (s.uniform(0), Vec2::new(s.uniform(1), s.uniform(2)));
        let drawn = sampler.sample(to, u, choice).and_then(|chosen| {
            let id = sampler.id(chosen.light);
            let sample = lights.sample_li(id, to, place, &Wavelengths::RGB, &MeanEmission)?;
            let pdf = sample.pdf * chosen.probability;
            Some(f64::from(sample.radiance[0] * sample.wi.dot(to.n).max(0.0) / pdf))
        });
        sum += drawn.unwrap_or(0.0);
    }
    sum / f64::from(COUNT)
}

/// Mean and variance of one sample: a sum over all lights and 4 x 4 positions on each. Estimated from samples the variance would
/// hang on the few brightest.
fn moments(lights: &Lights, sampler: &LightSampler, to: &Receiver, choice: LightChoice) -> [f64; 2] {
    let (mut mean, mut squares) = (0.0, 0.0);
    for light in (0..sampler.len()).filter_map(LightIndex::new) {
        let probability = f64::from(sampler.pmf(light, to, choice));
        for place in 0..16 {
            let u = (Vec2::new((place % 4) as f32, (place / 4) as f32) + 0.5) / 4.0;
            let sample = lights.sample_li(sampler.id(light), to, u, &Wavelengths::RGB, &MeanEmission);
            let Some(sample) = sample else { continue };
            let value = f64::from(sample.radiance[0] * sample.wi.dot(to.n).max(0.0) / sample.pdf);
            if value > 0.0 {
                mean += value / 16.0;
                squares += value * value / probability / 16.0;
            }
        }
    }
    [mean, squares - mean * mean]
}

#[test]
fn the_tree_gives_the_mean_of_a_uniform_choice_with_a_twentieth_of_the_variance() {
    let (lights, sampler) = grid();
    assert_eq!(sampler.len(), 10_000);
    let tilted = Vec3::new(0.6, 0.8, 0.0);
    for (p, n) in [(Vec3::ZERO, Vec3::Y), (Vec3::new(20.3, 0.2, -31.0), tilted)] {
        let to = Receiver { p, n, time: 0.0 };
        let [tree, uniform] = [LightChoice::Tree, LightChoice::Uniform].map(|choice| {
            let [mean, variance] = moments(&lights, &sampler, &to, choice);
            let (found, sigma) =
                (estimate(&lights, &sampler, &to, choice), (variance / f64::from(COUNT)).sqrt());
            assert!((found - mean).abs() < 4.5 * sigma, "{choice:?}, {p}: {found}, not {mean} ± {sigma}");
            variance
        });
        assert!(20.0 * tree < uniform, "{p}: {tree} {uniform}");
    }
}

/// Of an object of many patches a few stand for all, with the same power, and none of those that have none.
#[test]
fn a_few_pieces_stand_for_those_of_a_large_object() {
    let mut lights = Lights::default();
    let mut list = Vec::new();
    let mut powers = [0.0; 2];
    for (primitive, pieces) in [(0, 16), (1, 5000u32)] {
        for part in 0..pieces {
            let u = |k| Stream::new(51, [part, primitive], 0).uniform(k);
            let corner = 9.0 * DVec3::new(u(0).into(), u(1).into(), u(2).into());
            let patch = Patch::parallelogram(corner, [f64::from(u(3)) * DVec3::X, DVec3::Z]);
            let emission = Emission::from_rgb([if part % 4 == 3 { 0.0 } else { 1.0 }; 3]);
            let (sides, extent, object) = (Sides::Both, PatchExtent::Whole, ObjectId::from_index(primitive));
            let (drift, varied, density) = (None, None, None);
            let area = AreaLight { patch, emission, drift, varied, density, sides, extent, object, part };
            powers[primitive as usize] += area.bounds().unwrap().power;
            list.extend(area.store(&mut lights).map(|id| (id, LightGroup::default())));
        }
    }
    let sampler = LightSampler::new(list, 0, None, &lights);
    let taken = sampler.representatives(&lights, 16);
    let (few, many) = taken.split_at(16);
    assert!(few.iter().all(|&(_, factor)| factor == 1.0) && many.len() == 16);
    let power = |&(id, factor): &(LightId, f32)| lights.bounds(id).unwrap().power * factor;
    let sum: f32 = many.iter().map(power).sum();
    assert!((sum / powers[1] - 1.0).abs() < 1e-3, "{sum} {}", powers[1]);
    assert!(many.iter().all(|piece| (power(piece) / (powers[1] / 16.0) - 1.0).abs() < 1e-3));
    // From far away they are as bright as all of them.
    let far = Vec3::new(300.0, 500.0, -400.0);
    let light = |pieces: &[(LightId, f32)]| -> f32 {
        pieces.iter().map(|&(id, factor)| factor * lights.illuminate(id, far, 0.0).intensity[0]).sum()
    };
    let all: Vec<_> = sampler.list()[16..].iter().map(|&id| (id, 1.0)).collect();
    assert!((light(many) / light(&all) - 1.0).abs() < 0.05, "{} {}", light(many), light(&all));
    // Without light none is chosen.
    for area in &mut lights.areas {
        area.emission = Emission::BLACK;
    }
    assert_eq!(sampler.representatives(&lights, 16).len(), 16);
}

/// Discs in the sky are in one more list than directions without an extent.
#[test]
fn all_lists_count_as_memory() {
    let bytes = |height: f32| {
        let mut lights = Lights::default();
        let emission = Emission::from_rgb([1.0; 3]);
        let light = DirectionalLight { to_light: Vec3::Y, height, intensity: Spectrum::WHITE, emission };
        let ids = (0..1000).flat_map(|_| light.clone().store(&mut lights)).collect::<Vec<_>>();
        let list: Vec<_> = ids.into_iter().map(|id| (id, LightGroup::default())).collect();
        LightSampler::new(list, 1000, None, &lights).bytes()
    };
    assert_eq!(bytes(1e-3) - bytes(0.0), 1000 * size_of::<LightIndex>());
}
