//! Numbers that are given, and those behind their end.

use super::*;

/// All numbers of a sample in turn: its place in the pixel, a pair, and single ones.
fn numbers(mut draws: SampleStream<'_>, n: usize) -> Vec<f32> {
    let first = [draws.film_position(), draws.next_2d()].map(|u| u.to_array()).concat();
    let single = std::iter::repeat_with(|| draws.next_1d());
    first.into_iter().chain(single).take(n).collect()
}

/// As many different numbers, none of them likely to be drawn.
fn slice(n: usize) -> Vec<f32> {
    (0..n).map(|i| (i as f32 + 0.5) / n as f32).collect()
}

#[test]
fn a_slice_replays_whoever_asks() {
    let given = slice(20);
    let sampler = Sampler::given(given.clone(), Vec::new());
    for (seed, pixel, sample) in [(0, [0, 0], 0), (7, [3, 5], 11)] {
        assert_eq!(numbers(SampleStream::new(&sampler, seed, pixel, sample), 20), given);
    }
    // Dimensions that are left out are left out of the slice.
    let mut draws = draws(&sampler, 0);
    draws.skip(17);
    assert_eq!((draws.pair_if(true), draws.number_if(true)), (Vec2::new(given[17], given[18]), given[19]));
}

#[test]
fn behind_the_slice_numbers_are_those_of_uniform_samples() {
    let uniform = Sampler::new(Uniform, 1);
    for n in [0, 1, 3, 7] {
        let sampler = Sampler::given(slice(n), slice(n));
        for k in 0..50 {
            let expected = [slice(n), numbers(draws(&uniform, k), 40).split_off(n)].concat();
            assert_eq!(numbers(draws(&sampler, k), 40), expected, "{n} given");
        }
    }
    // Over many samples they fill 64 cells evenly; chi-square of 63 degrees of freedom is below 134 but for 4e-7.
    let sampler = Sampler::given(slice(5), Vec::new());
    let mut cells = [0f64; 64];
    for k in 0..6400 {
        let mut draws = draws(&sampler, k);
        draws.skip(5);
        let u = draws.next_2d();
        cells[(u.x * 8.0) as usize * 8 + (u.y * 8.0) as usize] += 1.0;
    }
    let chi2: f64 = cells.iter().map(|n| (n - 100.0).powi(2) / 100.0).sum();
    assert!(chi2 < 134.0, "{chi2}");
}

#[test]
fn a_path_beside_has_numbers_of_its_own_and_forks_have_none() {
    let (path, beside) = (slice(8), slice(13));
    let sampler = Sampler::given(path.clone(), beside.clone());
    let uniform = Sampler::new(Uniform, 1);
    let (given, free) = (draws(&sampler, 4), draws(&uniform, 4));
    assert_eq!(numbers(given.split(0, 0, 1), 13), beside);
    let deeper = |draws: SampleStream<'_>| numbers(draws.split(0, 0, 1).split(1, 0, 1), 13);
    assert_eq!(deeper(given), deeper(free));
    for i in 0..3 {
        assert_eq!(numbers(given.split(2, i, 3), 13), numbers(free.split(2, i, 3), 13));
    }
    assert_eq!(numbers(given, 8), path, "splitting takes nothing");
    let mut in_order = given;
    in_order.begin_part(1);
    assert_eq!(numbers(in_order, 8), path, "given numbers stay in their order");
    assert!(
        given.substream().is_none()
            && given.split(0, 0, 1).substream().is_none()
            && free.substream().is_some()
    );
    assert_ne!(sampler, Sampler::given(path, Vec::new()));
}
