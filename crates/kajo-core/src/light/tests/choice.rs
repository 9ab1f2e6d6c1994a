//! The choice between lights that have a position and those infinitely far away.

use super::*;
use crate::background::Background;
use crate::family::Pooled;
use crate::ids::{LightGroup, LightIndex};
use std::sync::Arc;

/// Points at height 1, a sky and suns, in this order, of these strengths.
fn lit(points: &[f32], attenuation: [f32; 3], suns: &[f32], sky: Option<f32>) -> (Lights, LightSampler) {
    let mut lights = Lights::default();
    let mut list = Vec::new();
    for (i, &strength) in points.iter().enumerate() {
        let position = Vec3::new(i as f32, 1.0, 0.0);
        let emission = Emission::from_rgb([strength; 3]);
        let point = PointLight { position, intensity: Spectrum::WHITE, emission, attenuation };
        list.extend(point.store(&mut lights));
    }
    for &strength in suns {
        list.extend(DirectionalLight::new(Vec3::NEG_Y, Emission::from_rgb([strength; 3])).store(&mut lights));
    }
    let first_area = list.len();
    let background = sky.map(|strength| {
        let sky = SkyLight::new(Arc::new(Background::constant([strength; 3])));
        list.extend(sky.store(&mut lights));
        LightIndex::new(first_area).unwrap()
    });
    let list = list.into_iter().map(|id| (id, LightGroup::default())).collect();
    let sampler = LightSampler::new(list, first_area, background, &lights);
    (lights, sampler)
}

const SQUARE: [f32; 3] = [0.0, 0.0, 1.0];

fn scenes() -> Vec<(Lights, LightSampler)> {
    vec![
        lit(&[1.0], SQUARE, &[], None),
        lit(&[], SQUARE, &[], Some(0.3)),
        lit(&[], SQUARE, &[0.0, 2.0, 1e-3], None),
        lit(&[1.0], SQUARE, &[], Some(1e-3)),
        lit(&[3.0, 0.01, 2.0], SQUARE, &[1.0, 0.5], Some(0.2)),
        lit(&[3.0, 0.01, 2.0], [1.0, 0.0, 0.0], &[1.0, 0.5], Some(0.2)),
        lit(&[5.0; 200], SQUARE, &[1.0; 7], Some(0.2)),
    ]
}

/// Lights are chosen as often as is said, and what is left of the number is spread evenly over [0, 1).
#[test]
fn a_light_takes_its_share_of_the_numbers_and_gives_them_back() {
    let n = 1 << 16;
    for (k, (_, sampler)) in scenes().into_iter().enumerate() {
        let learned = every_third_arrives(&sampler);
        for choice in [LightSelection::Tree, LightSelection::Uniform, LightSelection::Learned(&learned)] {
            let to = Receiver { p: Vec3::new(0.3, 0.1, 0.2), n: Vec3::new(0.0, 0.6, 0.8), time: 0.0 };
            let mut rests = vec![Vec::new(); sampler.list().len()];
            for i in 0..n {
                let u = (i as f32 + 0.5) / n as f32;
                let chosen = sampler.sample(&to, u, choice).unwrap();
                let pmf = sampler.pmf(chosen.light, &to, choice);
                assert!((chosen.probability / pmf - 1.0).abs() < 1e-5, "{k} {u}: {chosen:?} {pmf}");
                rests[chosen.light.index()].push(chosen.rest);
            }
            let mut sum = 0.0;
            for (light, rests) in LightIndex::all(rests.len()).zip(&mut rests) {
                let pmf = sampler.pmf(light, &to, choice);
                sum += pmf;
                let count = rests.len() as f32;
                assert!((count - pmf * n as f32).abs() < 2.0, "{k} {light:?}: {count} {pmf}");
                rests.sort_by(f32::total_cmp);
                let even = rests.iter().enumerate().map(|(i, rest)| (rest - (i as f32 + 0.5) / count).abs());
                let worst = even.fold(0.0, f32::max);
                assert!(worst < 2.0 / count, "{k} {light:?}: {worst} of {count}");
            }
            assert!((sum - 1.0).abs() < 1e-4, "{k}: {sum}");
        }
    }
}

/// A table of draws of which those of every third light arrive.
fn every_third_arrives(sampler: &LightSampler) -> LightVisibility {
    let s = Stream::new(72, [0, 0], 0);
    let draw = |i: u32| {
        let p = 4.0 * Vec3::new(s.uniform(4 * i), s.uniform(4 * i + 1), s.uniform(4 * i + 2)) - 2.0;
        let light = LightIndex::new((s.uniform(4 * i + 3) * sampler.list().len() as f32) as usize).unwrap();
        let to = Receiver { p, n: Vec3::ZERO, time: 0.0 };
        // Each light is drawn as often as any other.
        let weight = sampler.pmf(light, &to, LightSelection::Tree) * sampler.list().len() as f32;
        LightDraw { p, light, weight, arrives: light.index().is_multiple_of(3) }
    };
    sampler.learn((0..5000).map(draw).collect())
}

/// No light is drawn less than a tenth as often as by the tree, whatever is learned.
#[test]
fn what_never_arrived_is_drawn_rarely_and_never_not_at_all() {
    for (k, (_, sampler)) in scenes().into_iter().enumerate() {
        let learned = every_third_arrives(&sampler);
        for i in 0..20 {
            let s = Stream::new(73, [i, 0], 0);
            let p = 3.0 * Vec3::new(s.uniform(0), s.uniform(1), s.uniform(2)) - 1.5;
            let to = Receiver { p, n: Vec3::ZERO, time: 0.0 };
            for light in LightIndex::all(sampler.list().len()) {
                let [tree, by_learned] = [LightSelection::Tree, LightSelection::Learned(&learned)]
                    .map(|by| sampler.pmf(light, &to, by));
                assert!(
                    by_learned >= 0.0999 * tree && by_learned <= 1.0001,
                    "{k} {light:?}: {tree} {by_learned}"
                );
            }
        }
    }
    // Of three points alike the first is all that arrives; the tree draws it once in three times.
    let (_, sampler) = lit(&[1.0; 3], SQUARE, &[], None);
    let learned = every_third_arrives(&sampler);
    let to = Receiver { p: Vec3::new(1.0, -1.0, 1.0), n: Vec3::ZERO, time: 0.0 };
    let first = sampler.pmf(LightIndex::new(0).unwrap(), &to, LightSelection::Learned(&learned));
    assert!(first > 0.9, "{first}");
    // And of a sky, a sun and a point: the sky is the light of number 2, the point that of 0.
    let (_, sampler) = lit(&[1e-2], SQUARE, &[30.0], Some(10.0));
    let learned = every_third_arrives(&sampler);
    let by = [LightSelection::Tree, LightSelection::Learned(&learned)];
    let [tree, first] = by.map(|by| sampler.pmf(LightIndex::new(0).unwrap(), &to, by));
    assert!(tree < 0.02 && first > 0.5, "{tree} {first}");
}

#[test]
fn what_was_never_drawn_is_taken_for_visible() {
    for (_, sampler) in scenes() {
        let nothing = sampler.learn(Vec::new());
        let to = Receiver { p: Vec3::new(0.3, 0.1, 0.2), n: Vec3::new(0.0, 0.6, 0.8), time: 0.0 };
        for light in LightIndex::all(sampler.list().len()) {
            let [tree, learned] = [LightSelection::Tree, LightSelection::Learned(&nothing)]
                .map(|by| sampler.pmf(light, &to, by));
            assert!((tree - learned).abs() < 1e-6, "{light:?}: {tree} {learned}");
        }
    }
}

/// A table is one of regions: what is hidden on one side of a wall may be seen on the other.
#[test]
fn regions_have_shares_of_their_own() {
    let (_, sampler) = lit(&[1.0; 2], SQUARE, &[], None);
    let s = Stream::new(74, [0, 0], 0);
    let draws = (0..20_000).map(|i| {
        let p = Vec3::new(8.0 * s.uniform(4 * i) - 4.0, s.uniform(4 * i + 1), s.uniform(4 * i + 2));
        let light = LightIndex::new(usize::from(s.uniform(4 * i + 3) < 0.5)).unwrap();
        LightDraw { p, light, weight: 1.0, arrives: (p.x < 0.0) == (light.index() == 0) }
    });
    let learned = sampler.learn(draws.collect());
    for (x, seen) in [(-3.0, 0), (3.0, 1)] {
        let to = Receiver { p: Vec3::new(x, 0.5, 0.5), n: Vec3::ZERO, time: 0.0 };
        let pmf = sampler.pmf(LightIndex::new(seen).unwrap(), &to, LightSelection::Learned(&learned));
        assert!(pmf > 0.85, "{x}: {pmf}");
    }
}

/// Beside lights of another kind each kind is chosen by the root of its irradiance, where that can be told.
#[test]
fn kinds_of_lights_are_chosen_by_the_roots_of_their_irradiances() {
    let to = Receiver { p: Vec3::ZERO, n: Vec3::Y, time: 0.0 };
    let pmf_by = |(_, sampler): (Lights, LightSampler), i: usize, by: LightSelection<'_>| {
        sampler.pmf(LightIndex::new(i).unwrap(), &to, by)
    };
    let pmf = |made, i| pmf_by(made, i, LightSelection::TreeAlone);
    let expected = |a: f32, b: f32| a.sqrt() / (a.sqrt() + b.sqrt());
    let sky = pmf(lit(&[4.0], SQUARE, &[], Some(0.01)), 1);
    assert!((sky - expected(0.01 * PI as f32, 4.0)).abs() < 1e-4, "{sky}");
    // An even sky is not drawn where scattering finds it too.
    for i in [0, 1] {
        let beside = pmf_by(lit(&[], SQUARE, &[2.0], Some(0.4)), i, LightSelection::Tree);
        assert_eq!(beside, [1.0, 0.0][i]);
    }
    let sun = pmf(lit(&[4.0], SQUARE, &[0.5], None), 1);
    assert!((sun - expected(0.125, 4.0)).abs() < 1e-4, "{sun}");
    let strong = pmf(lit(&[], SQUARE, &[9.0, 1.0], None), 0);
    assert!((strong - 0.75).abs() < 1e-5, "{strong}");
    // The classic format's points may be as bright from everywhere.
    let even = pmf(lit(&[4.0], [1.0, 0.0, 0.0], &[0.5], Some(0.01)), 2);
    assert!((even - 2.0 / 3.0 * expected(0.01 * PI as f32, 0.125)).abs() < 1e-4, "{even}");
}

/// Of few numbers that choose a light all that are drawn for it differ.
#[test]
fn a_choice_among_many_leaves_numbers_enough() {
    let (_, sampler) = lit(&vec![1.0; 30_000], SQUARE, &[], None);
    let to = Receiver { p: Vec3::new(15_000.2, -100.0, 0.3), n: Vec3::ZERO, time: 0.0 };
    let (mut sum, mut squares, mut coarse, n) = (0.0, 0.0, 0, 20_000);
    for i in 0..n {
        let s = Stream::new(71, [i, 0], 0);
        let chosen = sampler.sample(&to, s.uniform(0), LightChoice::Uniform).unwrap();
        let pair = chosen.pair(Vec2::new(s.uniform(0), s.uniform(1)));
        assert!(pair.cmpge(Vec2::ZERO).all() && pair.cmplt(Vec2::ONE).all());
        coarse += usize::from((pair.x * 4096.0).fract() == 0.0);
        sum += f64::from(pair.x);
        squares += f64::from(pair.x) * f64::from(pair.x);
    }
    let (mean, square) = (sum / f64::from(n), squares / f64::from(n));
    assert!((mean - 0.5).abs() < 0.01 && (square - 1.0 / 3.0).abs() < 0.01, "{mean} {square}");
    assert!(coarse < 40, "{coarse}");
}
