//! How the numbers of a pixel's samples lie to each other.

use kajo_testkit::ChiSquare;

use super::*;

/// The number at a dimension, and the pair there.
fn numbers(sampler: &Sampler, seed: u64, k: u32, dimension: u32) -> (f32, Vec2) {
    let mut draws = SampleStream::new(sampler, seed, [3, 5], k);
    (0..dimension).for_each(|_| _ = draws.next_1d());
    (draws.clone().next_1d(), draws.next_2d())
}

/// Whether `n` numbers lie one in each of `n` equal parts.
fn is_stratified(numbers: impl Iterator<Item = f32>, n: u32) -> bool {
    let mut hit = vec![false; n as usize];
    numbers.for_each(|u| hit[(f64::from(u) * f64::from(n)) as usize] = true);
    hit.iter().all(|&h| h)
}

fn is_net(points: &[Vec2]) -> bool {
    let m = points.len().ilog2();
    (0..=m).all(|p| {
        let [columns, rows] = [1u32 << p, 1 << (m - p)];
        let cell = |u: Vec2| (u.x * columns as f32) as u32 + columns * (u.y * rows as f32) as u32;
        let mut hit = vec![false; points.len()];
        points.iter().for_each(|&u| hit[cell(u) as usize] = true);
        hit.iter().all(|&h| h)
    })
}

#[test]
fn numbers_are_one_to_a_stratum_for_any_number_of_samples() {
    for kind in [Regular, Jittered, Pmj, Poisson, Cmj] {
        for n in [1, 2, 3, 5, 16, 37, 100] {
            let sampler = Sampler::new(kind, n);
            for (dimension, seed) in [(2, 0), (5, 1), (40, 2)] {
                let first = (0..n).map(|k| numbers(&sampler, seed, k, dimension).0);
                assert!(is_stratified(first, n), "{kind:?}, {n} samples");
                let beyond = (n..2 * n).map(|k| numbers(&sampler, seed, k, dimension).0);
                assert!(is_stratified(beyond, n), "{kind:?}, samples beyond {n}");
            }
        }
    }
}

#[test]
fn jittered_pairs_are_multi_jittered() {
    for (kind, side) in [Jittered, Cmj].into_iter().flat_map(|kind| [1, 2, 3, 8].map(|side| (kind, side))) {
        let n = side * side;
        let sampler = Sampler::new(kind, n);
        for seed in 0..20 {
            let points: Vec<Vec2> = (0..n).map(|k| numbers(&sampler, seed, k, 2).1).collect();
            assert!(is_stratified(points.iter().map(|p| p.x), n), "columns");
            assert!(is_stratified(points.iter().map(|p| p.y), n), "rows");
            let cell = |p: &Vec2| (p.x * side as f32).floor() + side as f32 * (p.y * side as f32).floor();
            assert!(is_stratified(points.iter().map(|p| (cell(p) + 0.5) / n as f32), n), "cells");
        }
    }
}

/// In each row of the grid the points stand in the same order of finer columns, and in each column in that of finer rows.
#[test]
fn correlated_pairs_have_one_order_for_all_rows_and_one_for_all_columns() {
    let side = 6u32;
    let orders = |kind, flip: bool| -> std::collections::HashSet<Vec<u32>> {
        let sampler = Sampler::new(kind, side * side);
        let points = (0..side * side).map(|k| numbers(&sampler, 4, k, 2).1 * side as f32);
        let mut cells = vec![vec![0; side as usize]; side as usize];
        for p in points.map(|p| if flip { Vec2::new(p.y, p.x) } else { p }) {
            cells[p.y as usize][p.x as usize] = (p.y.fract() * side as f32) as u32;
        }
        cells.into_iter().collect()
    };
    for flip in [false, true] {
        assert_eq!(orders(Cmj, flip).len(), 1);
        assert!(orders(Jittered, flip).len() > 1);
    }
}

#[test]
fn sobol_pairs_are_nets_at_every_dimension_for_every_power_of_two() {
    for kind in [Sobol, ZSobol] {
        let sampler = Sampler::new(kind, 256);
        for (dimension, seed) in [(0, 0), (2, 1), (7, 2), (31, 3)] {
            let points: Vec<Vec2> = (0..256).map(|k| numbers(&sampler, seed, k, dimension).1).collect();
            // On the Z-curve, digits to base 4 are shuffled: prefixes of powers of four are whole blocks.
            let powers = (0..=8).filter(|m| kind == Sobol || m % 2 == 0);
            powers.for_each(|m| assert!(is_net(&points[..1 << m]), "{kind:?} {dimension}: 2^{m}"));
            assert!(is_stratified(points.iter().map(|p| p.x), 256));
        }
    }
}

#[test]
fn progressive_points_are_nets_in_the_pixel_as_they_come_and_elsewhere_as_a_whole() {
    for m in [0, 1, 4, 7, 8] {
        let sampler = Sampler::new(Pmj, 1 << m);
        let points =
            |dimension| -> Vec<Vec2> { (0..1 << m).map(|k| numbers(&sampler, 9, k, dimension).1).collect() };
        (0..=m).for_each(|l| assert!(is_net(&points(0)[..1 << l]), "2^{l} of 2^{m} points"));
        assert!(is_net(&points(6)), "2^{m}");
    }
}

#[test]
fn poisson_points_keep_their_distance() {
    let torus = |a: Vec2, b: Vec2| {
        let d = (a - b).abs();
        d.min(1.0 - d).length()
    };
    for n in [2u32, 9, 64, 300] {
        let sampler = Sampler::new(Poisson, n);
        let r = (0.6965 / n as f32).sqrt();
        for dimension in [0, 4] {
            let points: Vec<Vec2> = (0..n).map(|k| numbers(&sampler, 1, k, dimension).1).collect();
            for (i, &a) in points.iter().enumerate() {
                assert!(points[..i].iter().all(|&b| torus(a, b) > 0.999 * r), "{n} points");
            }
        }
    }
}

/// Every sample of every kind alone is uniform in the square, which is why estimates have no bias.
#[test]
fn each_sample_is_uniform() {
    let pixels = 6400u32;
    for kind in KINDS {
        let sampler = Sampler::new(kind, 6);
        for (k, dimension) in [(0, 2), (5, 2), (3, 9)] {
            let mut counts = [0.0; 64];
            for i in 0..pixels {
                let mut draws = SampleStream::new(&sampler, 3, [17 * (i % 80), 17 * (i / 80)], k);
                (0..dimension).for_each(|_| _ = draws.next_1d());
                let u = draws.next_2d();
                assert!(u.x >= 0.0 && u.x < 1.0 && u.y >= 0.0 && u.y < 1.0);
                counts[(u.x * 8.0) as usize + 8 * (u.y * 8.0) as usize] += 1.0;
            }
            let test = ChiSquare::test(&counts, &[f64::from(pixels) / 64.0; 64]);
            assert!(test.p > 1e-5, "{kind:?}, sample {k}, dimension {dimension}: {test:?}");
        }
    }
}

#[test]
fn numbers_do_not_depend_on_the_order_they_are_asked_for() {
    for kind in KINDS {
        let sampler = Sampler::new(kind, 16);
        let forward: Vec<_> = (0..16).map(|k| numbers(&sampler, 1, k, 6)).collect();
        let same = Sampler::new(kind, 16);
        for k in (0..16).rev() {
            assert_eq!(numbers(&same, 1, k, 6), forward[k as usize], "{kind:?}");
        }
        assert_ne!(numbers(&sampler, 2, 0, 6), forward[0]);
    }
}

#[test]
fn rays_of_a_split_are_spread_together() {
    for kind in [Jittered, Sobol] {
        let sampler = Sampler::new(kind, 4);
        let rays: Vec<f32> = (0..4)
            .flat_map(|k| (0..8).map(move |i| (k, i)))
            .map(|(k, i)| draws(&sampler, k).split(1, i, 8).next_1d())
            .collect();
        assert!(is_stratified(rays.iter().copied(), 32), "{kind:?}");
        let other = draws(&sampler, 0).split(2, 0, 8).next_1d();
        assert_ne!(other, rays[0], "{kind:?}: branches have numbers of their own");
    }
}

#[test]
fn no_number_of_samples_and_no_place_is_too_much() {
    for kind in KINDS {
        for n in [0, 1, 1025, 1 << 20] {
            let sampler = Sampler::new(kind, n);
            for k in [0, n, u32::MAX] {
                let mut draws =
                    SampleStream::new(&sampler, u64::MAX, [u32::MAX; 2], k).split(u32::MAX, 7, u32::MAX);
                let u = draws.next_2d();
                assert!(u.x < 1.0 && u.y < 1.0 && draws.next_1d() < 1.0, "{kind:?} {n} {k}");
            }
        }
    }
}

/// What comes after an unknown count of numbers has the same dimensions in all samples, and is spread evenly over them.
#[test]
fn substreams_shift_none_of_those_that_follow() {
    let n = 16;
    for kind in KINDS {
        let sampler = Sampler::new(kind, n);
        let after = |k: u32, count: u32| {
            let mut draws = draws(&sampler, k);
            let first = draws.next_1d();
            let mut own = draws.substream().expect("no numbers are given");
            let apart: Vec<f32> = (0..count).map(|_| own.next_1d()).collect();
            let next = draws.next_1d();
            assert!(apart.iter().all(|&u| u != first && u != next), "{kind:?}");
            draws.skip(count);
            draws.begin_part(1);
            [next, draws.next_1d()]
        };
        for i in [0, 1] {
            let values: Vec<f32> = (0..n).map(|k| after(k, 3 * k)[i]).collect();
            assert_eq!(values, (0..n).map(|k| after(k, 0)[i]).collect::<Vec<_>>(), "{kind:?}");
            assert!(kind == Uniform || is_stratified(values.iter().copied(), n), "{kind:?}: {values:?}");
        }
        let mut late = draws(&sampler, 3);
        late.skip(3000);
        let mut same = late;
        same.begin_part(2);
        assert_eq!(same.next_1d(), { late }.next_1d(), "no dimension is taken twice");
        same.begin_part(4);
        assert_ne!(same.next_1d(), late.next_1d());
    }
}
