mod convergence;
mod given;
mod spectra;
mod strata;

use super::*;
use SamplerKind::*;

const KINDS: [SamplerKind; 8] = [Uniform, Regular, Jittered, Sobol, ZSobol, Pmj, Poisson, Cmj];

fn draws(sampler: &Sampler, k: u32) -> SampleStream<'_> {
    SampleStream::new(sampler, 11, [3, 5], k)
}

fn positions(kind: SamplerKind, n: u32) -> Vec<Vec2> {
    let sampler = Sampler::new(kind, n);
    (0..n).map(|k| draws(&sampler, k).film_position()).collect()
}

#[test]
fn regular_positions_are_those_of_the_handout() {
    assert_eq!(positions(Regular, 1), [Vec2::new(0.5, 0.5)]);
    let four = [(0.25, 0.25), (0.75, 0.25), (0.25, 0.75), (0.75, 0.75)].map(|(x, y)| Vec2::new(x, y));
    assert_eq!(positions(Regular, 4), four);
}

#[test]
fn a_number_that_is_no_square_overhangs_as_in_the_reference() {
    assert_eq!(positions(Regular, 2), [Vec2::new(0.5, 0.5), Vec2::new(0.5, 1.5)]);
    for (n, overhangs, height) in [
        (0, false, 1.0),
        (1, false, 1.0),
        (2, true, 2.0),
        (3, true, 3.0),
        (9, false, 1.0),
        (15, true, 5.0 / 3.0),
    ] {
        for kind in [Regular, Jittered] {
            let sampler = Sampler::new(kind, n);
            assert_eq!((sampler.overhangs(), sampler.height()), (overhangs, height), "{kind:?} {n}");
            for p in positions(kind, n) {
                assert!(p.x >= 0.0 && p.x < 1.0 && p.y >= 0.0 && p.y < height, "{kind:?} {n}: {p}");
            }
        }
        assert!(!Sampler::new(Uniform, n).overhangs());
    }
}

#[test]
fn jittered_samples_keep_to_their_sub_pixel() {
    for side in [1, 2, 3, 7, 100, 1000] {
        let sampler = Sampler::new(Jittered, side * side);
        for k in (0..side * side).step_by(side as usize / 3 + 1) {
            let p = draws(&sampler, k).film_position() * side as f32;
            let cell = Vec2::new((k % side) as f32, (k / side) as f32);
            let inside = (p - cell).clamp(Vec2::splat(-1e-4), Vec2::splat(1.0001));
            assert_eq!(inside, p - cell, "sample {k} of {}", side * side);
        }
    }
}

#[test]
fn the_largest_random_number_does_not_round_out_of_the_pixel() {
    for side in [1, 3, 4096, 65_535] {
        let sampler = Sampler::new(Jittered, side * side);
        let p = sampler.in_sub_pixel(side * side - 1, Vec2::splat(1f32.next_down()));
        assert!(p.x < 1.0 && p.y < 1.0, "{side}: {p}");
    }
}

/// Mean, variance and correlation of the two coordinates over many pixels.
fn moments(kind: SamplerKind) -> [f64; 5] {
    let sampler = Sampler::new(kind, 1);
    let n = 100_000u32;
    let mut sums = [0.0; 5];
    for i in 0..n {
        let p = SampleStream::new(&sampler, 2, [i % 331, i / 331], 0).film_position().as_dvec2() - 0.5;
        for (sum, v) in sums.iter_mut().zip([p.x, p.y, p.x * p.x, p.y * p.y, p.x * p.y]) {
            *sum += v / f64::from(n);
        }
    }
    sums
}

#[test]
fn random_positions_are_uniform_over_the_pixel() {
    for kind in [Uniform, Jittered] {
        // Five standard errors of each moment of the uniform distribution on (-½, ½)².
        let found = moments(kind);
        let expected = [0.0, 0.0, 1.0 / 12.0, 1.0 / 12.0, 0.0];
        let sigma = [0.2887, 0.2887, 0.0745, 0.0745, 0.0833];
        for i in 0..5 {
            let error = (found[i] - expected[i]).abs();
            assert!(error < 5.0 * sigma[i] / 100_000f64.sqrt(), "{kind:?}, moment {i}: off by {error}");
        }
    }
}

#[test]
fn samples_of_open_ended_kinds_do_not_depend_on_their_number() {
    let numbers = |kind, n| {
        let sampler = Sampler::new(kind, n);
        let of_sample = |k| {
            let mut draws = SampleStream::new(&sampler, 3, [5, 9], k);
            let mut split = draws.split(1, 2, 3);
            let pairs = [draws.film_position(), draws.next_2d(), split.next_2d()];
            (pairs, [draws.next_1d(), split.next_1d()])
        };
        (0..16).map(of_sample).collect::<Vec<_>>()
    };
    for (name, kind) in SamplerKind::NAMES {
        assert_eq!(kind.is_open_ended(), numbers(kind, 16) == numbers(kind, 61), "{name}");
    }
}

#[test]
fn positions_depend_on_the_seed_only_where_they_are_random() {
    for kind in KINDS {
        let sampler = Sampler::new(kind, 4);
        let at = |seed| SampleStream::new(&sampler, seed, [3, 5], 1).film_position();
        assert_eq!(at(0) == at(1), kind == Regular, "{kind:?}");
    }
}
