use kajo_math::rng::Stream;
use kajo_testkit::Estimate;

use super::*;

fn random(i: u32) -> impl Fn(u32) -> f32 {
    let stream = Stream::new(11, [i, 0], 0);
    move |d| stream.uniform(d)
}

fn direction(u: &impl Fn(u32) -> f32, d: u32) -> Vec3 {
    let z = 2.0 * u(d) - 1.0;
    let (r, phi) = ((1.0 - z * z).max(0.0).sqrt(), std::f32::consts::TAU * u(d + 1));
    Vec3::new(r * phi.cos(), r * phi.sin(), z)
}

/// Photons on the floor, spread evenly over a square of two units.
fn on_a_floor(n: u32, seed: u32) -> Vec<Photon> {
    let photon = |i: u32| {
        let u = random(i.wrapping_add(seed.wrapping_mul(0x0100_0193)));
        Photon::new(&arrival(Vec3::new(2.0 * u(0) - 1.0, 2.0 * u(1) - 1.0, 0.0), Spectrum::grey(1.0)), 0.5)
    };
    (0..n).map(photon).collect()
}

fn arrival(p: Vec3, power: Spectrum) -> Arrival {
    Arrival { p, n: Vec3::Z, wi: Vec3::Z, power, scatterings: 0, secondary_terminated: false }
}

#[test]
fn a_photon_takes_24_bytes_and_keeps_what_it_is_told() {
    assert_eq!(size_of::<Photon>(), 24);
    for i in 0..20_000 {
        let u = random(i);
        let power = Spectrum::from([u(4), u(5), u(6), u(7)]) * 2f32.powi((60.0 * u(8)) as i32 - 40);
        let told = Arrival {
            p: Vec3::new(u(0), -u(1), 100.0 * u(2)),
            n: direction(&u, 10),
            wi: direction(&u, 12),
            power,
            scatterings: i % 20,
            secondary_terminated: i % 3 == 0,
        };
        let mut photon = Photon::new(&told, u(9));
        photon.set_axis(i as usize % 3);
        assert_eq!(photon.p, told.p.to_array());
        assert!(photon.wi().dot(told.wi) > 1.0 - 1e-6 && photon.n().dot(told.n) > 0.999, "{told:?}");
        for lane in 0..4 {
            let error = (photon.power()[lane] - power[lane]).abs();
            assert!(error <= 2.0 / 1023.0 * power.max_lane(), "{power:?} is kept as {:?}", photon.power());
        }
        assert_eq!(
            (photon.secondary_terminated(), photon.axis()),
            (told.secondary_terminated, i as usize % 3)
        );
        assert!(photon.is_within(i % 20) && photon.is_within(30));
        assert_eq!(photon.is_within(3), i % 20 <= 3);
    }
    let dark = [Spectrum::BLACK, Spectrum::grey(-1.0), Spectrum::grey(f32::NAN), Spectrum::grey(1e-35)];
    for power in dark {
        assert!(Photon::new(&arrival(Vec3::ZERO, power), 0.9).power().is_black(), "{power:?}");
    }
}

/// Rounding is even in the mean, for powers that are all alike.
#[test]
fn the_power_of_many_photons_is_kept() {
    for power in [1.0, 0.998, 0.50049, 3e-5] {
        let n = 4096u32;
        let dithers = (0..n).map(|i| dither(i, 0));
        let photons = dithers.map(|u| Photon::new(&arrival(Vec3::ZERO, Spectrum::grey(power)), u));
        let sum: f64 = photons.map(|photon| f64::from(photon.power()[1])).sum();
        assert!((sum / f64::from(n) / f64::from(power) - 1.0).abs() < 1e-4, "{power}: {sum}");
    }
}

#[test]
fn searches_find_what_a_look_at_all_finds() {
    let photons: Vec<Photon> = (0..3000)
        .map(|i| {
            let u = random(i);
            // Some lie at the same position.
            let p = Vec3::new(u(0), u(1), 0.05 * u(2)) * if i % 7 == 0 { 0.0 } else { 1.0 };
            Photon::new(&Arrival { n: direction(&u, 3), ..arrival(p, Spectrum::grey(u(5))) }, 0.5)
        })
        .collect();
    let map = PhotonMap::new(photons.clone(), 2).for_nearest(20);
    assert!(!map.is_empty());
    let mut scratch = NearestScratch::new();
    for i in 0..200 {
        let u = random(90_000 + i);
        let point = GatherPoint { p: Vec3::new(u(0), u(1), 0.05 * u(2)), n: direction(&u, 3) };
        let r = 0.3 * u(6);
        let distance = |photon: &Photon| point.p.distance_squared(photon.p.into());
        let mut expected: Vec<f32> =
            photons.iter().filter(|photon| point.takes(photon, r)).map(distance).collect();
        expected.retain(|&d2| d2 <= r * r);
        let mut found = Vec::new();
        map.within(&point, r, |photon| found.push(distance(photon)));
        expected.sort_by(f32::total_cmp);
        found.sort_by(f32::total_cmp);
        assert_eq!(found, expected);

        let r = map.largest_radius();
        let mut expected: Vec<f32> =
            photons.iter().filter(|photon| point.takes(photon, r)).map(distance).collect();
        expected.retain(|&d2| d2 <= map.most_r2);
        expected.sort_by(f32::total_cmp);
        expected.truncate(20);
        let mut found = Vec::new();
        map.nearest(&point, 20, &mut scratch, |photon| found.push(distance(photon)));
        assert_eq!(found, expected);

        // In a ball all of them count.
        let mut all: Vec<f32> = photons.iter().map(distance).collect();
        all.sort_by(f32::total_cmp);
        let mut found = Vec::new();
        map.within_ball(point.p, r, |photon| found.push(distance(photon)));
        found.sort_by(f32::total_cmp);
        assert_eq!(found, all[..all.partition_point(|&d2| d2 <= r * r)]);
        let mut found = Vec::new();
        map.nearest_in_ball(point.p, 20, &mut scratch, |photon| found.push(distance(photon)));
        all.retain(|&d2| d2 <= map.most_r2);
        all.truncate(20);
        assert_eq!(found, all);
    }
}

/// Through a cloud of photons, from within it and from outside, along axes too, near and without end.
#[test]
fn photons_along_a_ray_are_those_a_look_at_all_finds() {
    let photon = |i: u32| {
        let u = random(i);
        let p = 2.0 * Vec3::new(u(0), u(1), u(2)) - Vec3::ONE;
        Photon::new(&arrival(p, Spectrum::WHITE), 0.5)
    };
    let photons: Vec<Photon> = (0..3000).map(photon).collect();
    let map = PhotonMap::new(photons.clone(), 1);
    let mut all = 0;
    for i in 0..200 {
        let u = random(10_000 + i);
        let o = 3.0 * (2.0 * Vec3::new(u(0), u(1), u(2)) - Vec3::ONE);
        let d = match i % 4 {
            0 => Vec3::AXES[(i / 4 % 3) as usize] * if i % 8 == 0 { 1.0 } else { -1.0 },
            _ => direction(&u, 3),
        };
        let (t_max, r) = (if i % 3 == 0 { f32::INFINITY } else { 4.0 * u(6) }, 0.02 + 0.2 * u(7));
        let o = if i % 4 == 0 { o * 0.3 } else { o };
        let ray = Ray { t_min: 0.0, t_max, ..Ray::new(o, d) };
        let key = |photon: &Photon, t: f32, d2: f32| {
            (photon.p().to_array().map(f32::to_bits), t.to_bits(), d2.to_bits())
        };
        let mut found = Vec::new();
        map.along(&ray, r, |photon, t, d2| found.push(key(photon, t, d2)));
        let mut expected = Vec::new();
        for photon in &photons {
            let to = photon.p() - o;
            let t = to.dot(d);
            let d2 = (to - t * d).length_squared();
            if t >= 0.0 && t <= t_max && d2 <= r * r {
                expected.push(key(photon, t, d2));
            }
        }
        found.sort_unstable();
        expected.sort_unstable();
        assert_eq!(found, expected, "{ray:?} {r}");
        all += found.len();
    }
    assert!(all > 1000, "{all}");
}

#[test]
fn any_number_of_threads_builds_the_same_tree_of_any_order() {
    let photons = on_a_floor(200_000, 1);
    let tree = PhotonMap::new(photons.clone(), 1).photons;
    let mut turned = photons;
    turned.rotate_left(77_777);
    for threads in [2, 7] {
        assert!(PhotonMap::new(turned.clone(), threads).photons == tree, "{threads} threads");
    }
    assert!(PhotonMap::new(Vec::new(), 3).for_nearest(5).is_empty());
    let alike = vec![Photon::new(&arrival(Vec3::ONE, Spectrum::WHITE), 0.0); 1000];
    assert_eq!(PhotonMap::new(alike, 2).for_nearest(5).photons.len(), 1000);
}

/// The same in a volume.
#[test]
fn the_nearest_photons_of_a_ball_tell_their_density() {
    let n = 20_000u32;
    let photon = |i: u32| {
        let u = random(i);
        let p = 2.0 * Vec3::new(u(0), u(1), u(2)) - Vec3::ONE;
        Photon::new(&arrival(p, Spectrum::grey(1.0)), 0.5)
    };
    let density = f64::from(n) / 8.0;
    for k in [3, 10, 50] {
        let estimate = Estimate::of_batches(|batch| {
            let photons = (0..n).map(|i| photon(i + n * (100 + batch))).collect();
            let map = PhotonMap::new(photons, 1).for_nearest(k);
            let mut scratch = NearestScratch::new();
            let mean_of = 200;
            let found = (0..mean_of).map(|i| {
                let u = random(7_000_000 + 1000 * batch + i);
                let p = Vec3::new(u(0), u(1), u(2)) - Vec3::splat(0.5);
                let mut sum = 0.0;
                let factor = map.nearest_in_ball(p, k, &mut scratch, |photon| sum += photon.power()[0]);
                f64::from(factor * sum)
            });
            found.sum::<f64>() / f64::from(mean_of)
        });
        let error = (estimate.mean / density - 1.0).abs();
        let (sigma, wrong) = (estimate.standard_error / density, 1.0 / (k as f64 - 1.0));
        assert!(error < 4.0 * sigma && sigma < 0.25 * wrong, "{k}: off by {error} +- {sigma}");
    }
}

/// Photons of known density: `k / (pi r_k^2)` is too large by `k / (k - 1)`, exactly.
#[test]
fn the_nearest_photons_tell_their_density() {
    let n = 20_000u32;
    let density = f64::from(n) / 4.0;
    for k in [3, 10, 50] {
        let estimate = Estimate::of_batches(|batch| {
            let map = PhotonMap::new(on_a_floor(n, 100 + batch), 1).for_nearest(k);
            let mut scratch = NearestScratch::new();
            let mean_of = 200;
            (0..mean_of)
                .map(|i| {
                    let u = random(7_000_000 + 1000 * batch + i);
                    let point = GatherPoint { p: Vec3::new(u(0) - 0.5, u(1) - 0.5, 0.0), n: Vec3::Z };
                    let mut sum = 0.0;
                    let factor = map.nearest(&point, k, &mut scratch, |photon| sum += photon.power()[0]);
                    f64::from(factor * sum)
                })
                .sum::<f64>()
                / f64::from(mean_of)
        });
        // Where fewer are found within the largest radius, those in it are counted, which is as right.
        let error = (estimate.mean / density - 1.0).abs();
        let (sigma, wrong) = (estimate.standard_error / density, 1.0 / (k as f64 - 1.0));
        assert!(error < 4.0 * sigma && sigma < 0.2 * wrong, "{k}: off by {error} +- {sigma}");
    }
}
