use std::sync::atomic::{AtomicUsize, Ordering};

use kajo_core::sampler::{SampleStream, Sampler, SamplerKind};
use kajo_math::Vec2;

use super::*;
use crate::{
    FilmSpec, Filter, Layer, LayerSet, PixelSample, SampleContext, Silent, position_of, render,
    schedule::Sequence,
};

/// Light that depends on everything, and splats everywhere.
struct Noisy;

impl PixelIntegrator for Noisy {
    fn sample(&self, ctx: &mut SampleContext<'_>, pixel: [u32; 2], raster: Vec2) -> PixelSample {
        let stream = *ctx.draws.stream();
        let u = |d| stream.uniform(d);
        let value = u(5) * (raster.x * 0.3).sin().abs() + 0.01 * pixel[1] as f32;
        if u(6) < 0.5 {
            ctx.splats.add(Vec2::new(u(7) * 80.0, u(8) * 60.0), [u(9), 0.1, value]);
        }
        ctx.rays.camera += 1;
        PixelSample { radiance: [value, u(10), 0.5], first: None }
    }
}

fn settings(kind: SamplerKind, n: u32) -> RenderSettings {
    RenderSettings { threads: 2, ..RenderSettings::new(Sampler::new(kind, n)) }
}

fn film(spec: FilmSpec) -> Film {
    Film::new(spec, u64::MAX).expect("a sensible film")
}

fn spec(filter: Filter, halves: bool) -> FilmSpec {
    let layers = LayerSet::of(&[Layer::Color, Layer::Variance, Layer::SampleCount]);
    FilmSpec { filter, layers, halves, ..FilmSpec::new(70, 41) }
}

/// The bits of the picture and of its layers.
fn bits(film: &Film) -> Vec<Vec<u32>> {
    let of =
        |layer| film.develop(layer).expect("the film has it").data().iter().map(|v| v.to_bits()).collect();
    film.spec().layers.iter().map(of).collect()
}

/// Renders in passes to the end, without looking.
fn in_passes(film: &Film, settings: &RenderSettings, goal: &Goal) -> Position {
    let mut position = Position::default();
    let look = &mut |_: &Film, _: &Position, _: &RenderStats| ControlFlow::Continue(());
    render_passes(&Noisy, film, settings, goal, &mut position, &Silent, look).expect("rendered");
    position
}

#[test]
fn passes_make_the_same_picture_as_one_pass() {
    for filter in [Filter::None, Filter::MITCHELL] {
        for (kind, n) in [
            (SamplerKind::Jittered, 9),
            (SamplerKind::Uniform, 70),
            (SamplerKind::Regular, 7),
            (SamplerKind::ZSobol, 8),
            (SamplerKind::Poisson, 5),
        ] {
            let settings = settings(kind, n);
            let (whole, passes) = (film(spec(filter, false)), film(spec(filter, false)));
            render(&Noisy, &whole, &settings, &Silent).expect("rendered");
            let position = in_passes(&passes, &settings, &Goal::default());
            assert_eq!((position.samples(), passes.samples()), (n, u64::from(70 * 41 * n)));
            assert_eq!(bits(&whole), bits(&passes), "{filter:?}, {kind:?} {n}");
        }
    }
}

#[test]
fn passes_end_where_they_should() {
    let film = film(FilmSpec::new(3, 3));
    let mut ends = Vec::new();
    let look = &mut |film: &Film, position: &Position, stats: &RenderStats| {
        assert_eq!((film.samples(), stats.samples), (9 * u64::from(position.done), film.samples()));
        ends.push(position.samples());
        if position.done == 192 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let settings = settings(SamplerKind::Uniform, 1000);
    let mut position = Position::default();
    let ended = render_passes(&Noisy, &film, &settings, &Goal::default(), &mut position, &Silent, look);
    assert!(matches!(ended, Err(RenderError::Cancelled(stats)) if stats.samples == 9 * 192));
    assert_eq!(ends, [1, 2, 4, 8, 16, 32, 64, 128, 192]);
    // A quota cuts passes short, but never the ends that are always there.
    let goal = Goal::default();
    for (done, quota, end) in [(0, 0, 1), (40, 10, 50), (50, 100, 64), (64, 1000, 128), (960, 1000, 1000)] {
        let position = Position { done, ..Position::default() };
        assert_eq!(position.next_samples(&settings, &goal, quota, &|_| u32::MAX), Some(done..end));
    }
    let end = Position { done: 1000, ..Position::default() };
    assert_eq!(end.next_samples(&settings, &goal, 1, &|_| u32::MAX), None);
}

#[test]
fn a_sequence_visits_all_and_begins_everywhere() {
    for n in [1, 2, 3, 4, 7, 9, 16, 25, 64, 100, 1024] {
        let sampler = Sampler::new(SamplerKind::Regular, n);
        let sequence = Sequence::new(&sampler);
        let mut indices: Vec<u32> = sequence.indices(0..n).collect();
        let split: Vec<u32> = sequence.indices(0..n / 3).chain(sequence.indices(n / 3..n)).collect();
        assert_eq!(indices, split);
        if n >= 9 {
            let first = &indices[..n as usize / 2];
            let mean: Vec2 =
                first.iter().map(|&k| SampleStream::new(&sampler, 0, [0, 0], k).film_position()).sum();
            let mean = mean / first.len() as f32;
            assert!((mean - 0.5).abs().max_element() < 0.15, "{n}: the first half lies around {mean}");
        }
        indices.sort();
        assert!(indices.into_iter().eq(0..n), "{n}");
    }
    let uniform = Sequence::new(&Sampler::new(SamplerKind::Uniform, 4));
    assert!(uniform.indices(2..9).eq(2..9), "there is no end to it");
}

#[test]
fn positions_are_where_a_sequence_has_its_indices() {
    let kinds = [SamplerKind::Regular, SamplerKind::Jittered, SamplerKind::Uniform, SamplerKind::Sobol];
    for (kind, n) in kinds.into_iter().flat_map(|kind| [1, 2, 3, 8, 9, 100, 1009].map(|n| (kind, n))) {
        let sampler = Sampler::new(kind, n);
        let positions = Sequence::new(&sampler).indices(0..n).map(|index| position_of(&sampler, index));
        assert!(positions.eq(0..n), "{kind:?} {n}");
        assert_eq!(position_of(&sampler, n), n, "{kind:?}: beyond all samples");
    }
    // Of so many that none could be looked for one by one.
    let sampler = Sampler::new(SamplerKind::Jittered, 4_000_000_000);
    let sequence = Sequence::new(&sampler);
    for position in [0, 1, 2, 12_345, 3_123_456_789, 3_999_999_999] {
        let index = sequence.indices(position..position + 1).next().expect("one of the samples");
        assert_eq!(position_of(&sampler, index), position);
    }
}

/// Cancels after a number of questions.
struct StopAfter(AtomicUsize);

impl Progress for StopAfter {
    fn done(&self, done: u64, total: u64, _: u64) {
        assert!(done <= total);
    }

    fn cancelled(&self) -> bool {
        self.0.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |n| n.checked_sub(1)).is_err()
    }
}

#[test]
fn a_render_that_is_interrupted_and_saved_often_ends_with_the_same_bits() {
    for (halves, filter) in [(false, Filter::None), (true, Filter::gaussian(0.6))] {
        let spec = spec(filter, halves);
        let settings = settings(SamplerKind::Uniform, 40);
        let goal = Goal { adaptive: halves, ..Goal::default() };
        let expected = film(spec);
        in_passes(&expected, &settings, &goal);

        let (mut film, mut position) = (film(spec), Position::default());
        let mut interruptions = 0;
        loop {
            // Other threads and tiles each time.
            let (threads, tile) = (1 + interruptions % 3, 16 + interruptions as u32 % 40);
            let settings = RenderSettings { threads, tile, ..settings.clone() };
            let stop = StopAfter(AtomicUsize::new(11 + interruptions * 7 % 90));
            let look = &mut |_: &Film, _: &Position, _: &RenderStats| ControlFlow::Continue(());
            let ended = render_passes(&Noisy, &film, &settings, &goal, &mut position, &stop, look);
            if ended.is_ok() {
                break;
            }
            interruptions += 1;
            let mut saved = Vec::new();
            film.save(0, &mut saved).expect("memory does not fail");
            position.save(&mut saved).expect("memory does not fail");
            let mut input = &saved[..];
            film = Film::restore(spec, u64::MAX, &mut input).expect("as it was saved");
            let restored = Position::restore(&film, &settings, &mut input).expect("as it was saved");
            assert!(input.is_empty() && restored == position);
            position = restored;
        }
        assert!(interruptions > 5, "{interruptions} interruptions");
        assert_eq!(bits(&film), bits(&expected));
        assert_eq!(film.samples(), expected.samples());
    }
}

#[test]
fn states_that_make_no_sense_are_refused() {
    let settings = settings(SamplerKind::Uniform, 4);
    let spec = spec(Filter::None, false);
    let film = film(spec);
    let mut position = in_passes(&film, &settings, &Goal::default());
    position.unfinished = Some(Unfinished { samples: 4..9, tile: 32, ranges: 2, finished: vec![5] });
    let (mut sums, mut place) = (Vec::new(), Vec::new());
    film.save(0, &mut sums).expect("memory does not fail");
    position.save(&mut place).expect("memory does not fail");
    for len in 0..sums.len().min(2000) {
        assert!(Film::restore(spec, u64::MAX, &mut &sums[..len]).is_err());
    }
    for len in 0..place.len() {
        assert!(Position::restore(&film, &settings, &mut &place[..len]).is_err(), "{len} bytes");
    }
    // Any byte may be wrong; whatever comes of it is no panic.
    for i in 0..place.len() {
        for wrong in [0, 1, 16, 17, 0x7F, 0xFF] {
            let mut bytes = place.clone();
            bytes[i] = wrong;
            let _ = Position::restore(&film, &settings, &mut &bytes[..]);
        }
    }
    let one_pass = self::film(FilmSpec { one_pass: true, ..FilmSpec::new(300, 300) });
    assert!(one_pass.save(0, &mut Vec::new()).is_err());
}

#[test]
fn time_ends_a_render_after_the_first_sample() {
    let film = film(FilmSpec::new(50, 40));
    let goal = Goal { time: Some(Duration::ZERO), ..Goal::default() };
    let position = in_passes(&film, &settings(SamplerKind::Uniform, 1 << 20), &goal);
    assert_eq!((position.samples(), film.samples()), (1, 50 * 40));
}

#[test]
fn noise_is_estimated_and_ends_a_render() {
    /// Uniform in [0, 1): a mean of ½ and a variance of 1/12.
    struct White;
    impl PixelIntegrator for White {
        fn sample(&self, ctx: &mut SampleContext<'_>, _: [u32; 2], _: Vec2) -> PixelSample {
            PixelSample { radiance: [2, 3, 4].map(|d| ctx.draws.stream().uniform(d)), first: None }
        }
    }
    // e = sqrt(1/12n / (¼ + 0.05²)), 0.102 for 32 samples and 0.144 for 16.
    let goal = Goal { noise: Some(0.12), ..Goal::default() };
    for halves in [false, true] {
        for threads in [1, 3] {
            let film = film(spec(Filter::None, halves));
            assert_eq!(film.noise(), None);
            let settings = RenderSettings { threads, ..settings(SamplerKind::Uniform, 1 << 20) };
            let mut position = Position::default();
            let look = &mut |_: &Film, _: &Position, _: &RenderStats| ControlFlow::Continue(());
            render_passes(&White, &film, &settings, &goal, &mut position, &Silent, look).expect("rendered");
            assert_eq!(position.samples(), 32);
            let noise = film.noise().expect("known");
            assert!((noise / 0.1015 - 1.0).abs() < 0.02, "{noise}");
        }
    }
}

/// Dark on the left; on the right one sample in 10,000 brings 1000.
struct Rare;

impl PixelIntegrator for Rare {
    fn sample(&self, ctx: &mut SampleContext<'_>, pixel: [u32; 2], _: Vec2) -> PixelSample {
        let hit = pixel[0] >= 32 && ctx.draws.stream().uniform(3) < 1e-4;
        PixelSample { radiance: [if hit { 1000.0 } else { 0.0 }; 3], first: None }
    }
}

#[test]
fn adaptive_sampling_is_unbiased_and_starves_nobody() {
    let spec = FilmSpec { width: 64, height: 32, ..spec(Filter::None, true) };
    let goal = Goal { adaptive: true, ..Goal::default() };
    let render_with = |seed, threads| {
        let film = film(spec);
        let settings = RenderSettings { seed, threads, ..settings(SamplerKind::Uniform, 32) };
        let mut position = Position::default();
        let look = &mut |_: &Film, _: &Position, _: &RenderStats| ControlFlow::Continue(());
        render_passes(&Rare, &film, &settings, &goal, &mut position, &Silent, look).expect("rendered");
        film
    };
    assert_eq!(bits(&render_with(1, 1)), bits(&render_with(1, 4)));
    let n = 400;
    let (mut sum, mut squares, mut samples) = (0.0, 0.0, 0);
    for seed in 0..n {
        let film = render_with(seed, 2);
        let counts = film.develop(Layer::SampleCount).expect("counts").into_data();
        assert!(counts.iter().all(|&count| count >= 8.0));
        samples += film.samples();
        let image = film.develop(Layer::Color).expect("colour");
        let right: f64 = (0..32 * 32).map(|i| f64::from(image.pixel(32 + i % 32, i / 32)[0])).sum();
        let mean = right / 1024.0;
        sum += mean;
        squares += mean * mean;
    }
    let n = n as f64;
    let (mean, spent) = (sum / n, samples as f64 / (n * 64.0 * 32.0));
    let sigma = ((squares / n - mean * mean) / (n - 1.0)).sqrt();
    assert!((mean - 0.1).abs() < 4.0 * sigma && sigma < 0.006, "{mean} ± {sigma}");
    assert!((31.0..34.0).contains(&spent), "{spent} samples a pixel");
}

#[test]
fn adaptive_sampling_spends_where_noise_is() {
    /// Noise on the right, light everywhere.
    struct HalfNoisy;
    impl PixelIntegrator for HalfNoisy {
        fn sample(&self, ctx: &mut SampleContext<'_>, pixel: [u32; 2], _: Vec2) -> PixelSample {
            let value = if pixel[0] < 32 { 0.5 } else { ctx.draws.stream().uniform(3) };
            PixelSample { radiance: [value; 3], first: None }
        }
    }
    let spec = FilmSpec { width: 64, height: 32, ..spec(Filter::None, true) };
    let render_to = |goal: Goal| {
        let film = film(spec);
        let mut position = Position::default();
        let look = &mut |_: &Film, _: &Position, _: &RenderStats| ControlFlow::Continue(());
        let settings = settings(SamplerKind::Uniform, 256);
        render_passes(&HalfNoisy, &film, &settings, &goal, &mut position, &Silent, look).expect("rendered");
        film
    };
    let film = render_to(Goal { adaptive: true, ..Goal::default() });
    let counts = film.develop(Layer::SampleCount).expect("counts");
    let (calm, noisy) = (counts.pixel(0, 0)[0], counts.pixel(40, 0)[0]);
    assert!(noisy > 6.0 * calm && calm >= 64.0, "{calm} and {noisy}");
    // Half of the picture has e² = 1/12n / (¼ + 0.05²): 0.02² for 413 samples.
    let film = render_to(Goal { adaptive: true, noise: Some(0.02), ..Goal::default() });
    let noise = film.noise().expect("known");
    assert!((0.018..0.021).contains(&noise), "{noise}");
}
