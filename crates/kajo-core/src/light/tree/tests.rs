use super::super::Receiver;
use super::*;
use kajo_math::{Vec2, Vec3, rng::Stream, warp};

/// Lights of different strength and direction in a box.
fn lights(n: u32) -> Vec<Option<LightBounds>> {
    let light = |i: u32| {
        let s = Stream::new(3, [i, 0], 0);
        let at = 10.0 * Vec3::new(s.uniform(0), s.uniform(1), s.uniform(2));
        let size = Vec3::splat(0.1 * s.uniform(3));
        LightBounds {
            bounds: Aabb { min: at - size, max: at + size },
            axis: warp::uniform_sphere(Vec2::new(s.uniform(4), s.uniform(5))),
            cos_spread: if i.is_multiple_of(3) { -1.0 } else { 1.0 },
            cos_reach: 0.0,
            two_sided: i.is_multiple_of(5),
            power: 0.1 + s.uniform(6),
            is_inverse_square: true,
        }
    };
    (0..n).map(|i| (i % 97 != 96).then(|| light(i))).collect()
}

/// A point of light on the x axis.
fn point(x: f32, power: f32) -> Option<LightBounds> {
    let at = Vec3::new(x, 0.0, 0.0);
    Some(LightBounds {
        bounds: Aabb { min: at, max: at },
        axis: Vec3::Z,
        cos_spread: -1.0,
        cos_reach: 0.0,
        two_sided: false,
        power,
        is_inverse_square: true,
    })
}

#[test]
fn probabilities_agree_with_the_walk_and_sum_to_one() {
    let lights = lights(200);
    let tree = LightTree::build(&lights);
    assert_eq!(LightIndex::all(200).filter(|&light| tree.has(light)).count(), 198);
    for k in 0..30 {
        let s = Stream::new(5, [k, 0], 0);
        let p = 12.0 * Vec3::new(s.uniform(0), s.uniform(1), s.uniform(2));
        let n =
            if k % 4 == 0 { Vec3::ZERO } else { warp::uniform_sphere(Vec2::new(s.uniform(3), s.uniform(4))) };
        let to = Receiver { p, n, time: 0.0 };
        let sum: f32 = LightIndex::all(200).map(|light| tree.pmf(light, &to, &tree.first_step(&to))).sum();
        // A walk may end among lights that turn out not to reach the receiver.
        assert!(sum > 0.8 && sum < 1.0 + 1e-4, "{sum}");
        for j in 0..50 {
            let Some(SampledLight { light, probability, .. }) =
                tree.sample(&to, &tree.first_step(&to), s.uniform(10 + j))
            else {
                continue;
            };
            let again = tree.pmf(light, &to, &tree.first_step(&to));
            assert!((again / probability - 1.0).abs() < 1e-4, "{light:?}: {again} {probability}");
        }
    }
}

#[test]
fn what_can_send_light_is_never_ruled_out() {
    let lights = lights(150);
    let tree = LightTree::build(&lights);
    for k in 0..40 {
        let s = Stream::new(6, [k, 0], 0);
        let p = 12.0 * Vec3::new(s.uniform(0), s.uniform(1), s.uniform(2));
        for (i, light) in LightIndex::all(150).zip(&lights) {
            let Some(light) = light else { continue };
            // From the middle of the light, straight along its axis or sideways within its reach.
            let w = (p - light.bounds.center()).normalize();
            let sends = light.cos_spread < 0.0 || light.axis.dot(w) > 0.0 || light.two_sided;
            let to = Receiver { p, ..Receiver::default() };
            let found = tree.pmf(i, &to, &tree.first_step(&to)) > 0.0;
            assert!(found || !sends, "receiver {k}, light {i:?}");
        }
    }
}

#[test]
fn near_and_strong_lights_are_chosen_more_often() {
    let tree = LightTree::build(&[point(0.0, 1.0), point(10.0, 1.0), point(20.0, 4.0), point(30.0, 0.0)]);
    let to = Receiver { p: Vec3::X, ..Receiver::default() };
    let chances: Vec<f32> =
        LightIndex::all(4).map(|light| tree.pmf(light, &to, &tree.first_step(&to))).collect();
    assert!(chances[0] > 10.0 * chances[1] && chances[2] > 0.5 * chances[1]);
    assert_eq!(chances[3], 0.0);
    assert!(!tree.has(LightIndex::new(3).unwrap()));
}

/// What two points of light send to the place of both of them is as much as there is.
#[test]
fn lights_at_the_receiver_are_chosen_alike() {
    for n in [3, 20] {
        let lights: Vec<_> = (0..n).map(|i| point(if i < 2 { 0.0 } else { i as f32 }, 1e10)).collect();
        let tree = LightTree::build(&lights);
        let to = Receiver::default();
        let step = tree.first_step(&to);
        let chances: Vec<f32> = LightIndex::all(n).map(|light| tree.pmf(light, &to, &step)).collect();
        assert!((chances[0] - 0.5).abs() < 1e-3 && (chances[1] - 0.5).abs() < 1e-3, "{chances:?}");
        assert!((0..9).all(|i| tree.sample(&to, &step, i as f32 / 9.0).is_some()));
    }
}

/// Spot lights at one place, which are split in the order of the list: one alone shines on the receiver, and two that shine away from each
/// other are a group that knows no direction.
#[test]
fn a_light_that_shines_past_the_receiver_is_not_chosen() {
    let spot = |axis: Vec3| {
        let at = 2.0 * Vec3::Y;
        let bounds = Aabb { min: at, max: at };
        Some(LightBounds { bounds, axis, cos_spread: 1.0, cos_reach: 0.98, ..point(0.0, 1.0)? })
    };
    let tree = LightTree::build(&[Vec3::NEG_Y, Vec3::Z, Vec3::X, Vec3::NEG_X].map(spot));
    let to = Receiver::default();
    let first = LightIndex::new(0).expect("an index");
    assert_eq!(tree.pmf(first, &to, &tree.first_step(&to)), 1.0);
    assert!((0..9).all(|i| tree.sample(&to, &tree.first_step(&to), i as f32 / 9.0).unwrap().light == first));
}

#[test]
fn no_light_is_no_choice() {
    let tree = LightTree::build(&[]);
    assert!(tree.is_empty());
    let to = Receiver::default();
    assert!(tree.sample(&to, &tree.first_step(&to), 0.5).is_none());
}

#[test]
fn probabilities_along_rays_agree_with_the_walk() {
    let mut drawn = 0;
    for (k, lights) in (0..30u32).zip([200, 1, 2, 8, 9, 60].map(lights).iter().cycle()) {
        let tree = LightTree::build(lights);
        let all = || LightIndex::all(lights.len());
        let s = Stream::new(7, [k, 0], 0);
        let o = 12.0 * Vec3::new(s.uniform(0), s.uniform(1), s.uniform(2));
        let d = warp::uniform_sphere(Vec2::new(s.uniform(3), s.uniform(4)));
        let along = RaySegment {
            o,
            d,
            length: 20.0 * s.uniform(5),
            time: 0.0,
            extinction: 0.2,
            is_homogeneous: true,
        };
        let sum: f32 = all().map(|light| tree.pmf(light, &along, &tree.first_step(&along))).sum();
        assert!(sum < 1.0 + 1e-4, "{sum}");
        for j in 0..50 {
            let Some(SampledLight { light, probability, .. }) =
                tree.sample(&along, &tree.first_step(&along), s.uniform(10 + j))
            else {
                continue;
            };
            let again = tree.pmf(light, &along, &tree.first_step(&along));
            assert!((again / probability - 1.0).abs() < 1e-4, "{light:?}: {again} {probability}");
            drawn += u32::from(tree.seen_from(light, &along).is_some());
        }
    }
    assert!(drawn > 600, "{drawn}");
}

/// Of two lights alike, which a tree over many has in one group, the one that a ray passes closely is chosen.
#[test]
fn a_light_that_a_ray_passes_closely_is_chosen() {
    let tree = LightTree::build(&[0.0, 1.0, -1.0, 2.0].map(|x| point(x, 1.0)));
    let along = RaySegment {
        o: Vec3::new(1e-3, 0.0, -3.0),
        d: Vec3::Z,
        length: 6.0,
        time: 0.0,
        extinction: 0.1,
        is_homogeneous: true,
    };
    let first = LightIndex::new(0).expect("an index");
    assert!(tree.pmf(first, &along, &tree.first_step(&along)) > 0.99);
}
