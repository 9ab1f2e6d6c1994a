use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};

use kajo_core::sampler::SamplerKind;
use kajo_math::Vec3;

use super::*;
use crate::Silent;
use crate::{FilmSpec, Filter, FirstHit, Layer, LayerSet, PixelSample};

/// Radiance as a function of the position on the film and of a random number.
struct Field<F>(F);

impl<F: Fn(Vec2, f32) -> f32 + Sync> PixelIntegrator for Field<F> {
    fn sample(&self, ctx: &mut SampleContext<'_>, _pixel: [u32; 2], raster: Vec2) -> PixelSample {
        ctx.rays.camera += 1;
        ctx.rays.shadow += 2;
        let value = (self.0)(raster, ctx.draws.next_1d());
        ctx.aux.albedo = [value; 3];
        ctx.aux.lights[3] = [0.0, value, 0.0];
        let hit =
            FirstHit { t: raster.x, n: Vec3::Y, uv: raster.fract(), object: raster.y as u32, material: 7 };
        PixelSample { radiance: [value; 3], first: Some(hit) }
    }
}

fn settings(kind: SamplerKind, n: u32) -> RenderSettings {
    RenderSettings { threads: 2, ..RenderSettings::new(Sampler::new(kind, n)) }
}

fn film(spec: FilmSpec) -> Film {
    Film::new(spec, u64::MAX).expect("a sensible film")
}

fn colours(film: &Film) -> Vec<f32> {
    let image = film.develop(Layer::Color).expect("colour");
    image.data().chunks(3).map(|rgb| rgb[0]).collect()
}

/// A row of a picture of `f`, sampled by a fine regular grid.
fn row_of(filter: Filter, width: u32, f: impl Fn(f32) -> f32 + Sync) -> Vec<f32> {
    let film = film(FilmSpec { filter, ..FilmSpec::new(width, 1) });
    let settings = settings(SamplerKind::Regular, 64 * 64);
    render(&Field(|p: Vec2, _| f(p.x)), &film, &settings, &Silent).expect("rendered");
    colours(&film)
}

#[test]
fn the_picture_does_not_depend_on_threads_tiles_or_storage() {
    let noisy = Field(|p: Vec2, u: f32| u * (p.x * 0.37).sin().abs() + 1e-3 * p.y);
    for filter in [Filter::None, Filter::gaussian(0.7), Filter::MITCHELL] {
        let layers = LayerSet::of(&Layer::ALL);
        let spec = FilmSpec { filter, layers, ..FilmSpec::new(67, 41) };
        let mut first: Option<Vec<Vec<u32>>> = None;
        for (threads, tile, one_pass) in
            [(1, 0, false), (2, 1, false), (7, 8, true), (2, 64, false), (1, 67, true), (64, 1000, false)]
        {
            let film = film(FilmSpec { one_pass, ..spec });
            let settings = RenderSettings { threads, tile, ..settings(SamplerKind::Jittered, 5) };
            let stats = render(&noisy, &film, &settings, &Silent).expect("rendered");
            assert_eq!((stats.samples, stats.rays.camera, stats.rays.total()), (13_735, 13_735, 41_205));
            let bits = |layer| {
                film.develop(layer).expect("the film has it").data().iter().map(|v| v.to_bits()).collect()
            };
            let bits: Vec<Vec<u32>> = Layer::ALL.into_iter().map(bits).collect();
            assert_eq!(
                first.get_or_insert(bits.clone()),
                &bits,
                "{filter:?}, {threads} threads, tile {tile}"
            );
        }
    }
}

#[test]
fn large_pictures_in_one_pass_are_the_same_too() {
    let noisy = Field(|p: Vec2, u: f32| u + p.x);
    let spec = FilmSpec::new(300, 257);
    let (open, one_pass) = (film(spec), film(FilmSpec { one_pass: true, ..spec }));
    let settings = settings(SamplerKind::Uniform, 2);
    for film in [&open, &one_pass] {
        render(&noisy, film, &RenderSettings { tile: 24, ..settings.clone() }, &Silent).expect("rendered");
    }
    assert_eq!(colours(&open), colours(&one_pass));
    assert!(colours(&open).iter().all(|&v| v > 0.0));
}

#[test]
fn the_seed_decides_the_noise() {
    let render_with = |seed| {
        let film = film(FilmSpec::new(8, 8));
        let settings = RenderSettings { seed, ..settings(SamplerKind::Uniform, 1) };
        render(&Field(|_, u| u), &film, &settings, &Silent).expect("rendered");
        colours(&film)
    };
    assert_eq!(render_with(1), render_with(1));
    assert_ne!(render_with(1), render_with(2));
}

#[test]
fn every_size_and_number_of_samples_works() {
    for (width, height) in [(1, 1), (1, 50), (50, 1), (33, 2)] {
        for n in [0, 1, 2, 3, 16] {
            let film = film(FilmSpec::new(width, height));
            let stats = render(&Field(|_, _| 0.25), &film, &settings(SamplerKind::Regular, n), &Silent)
                .expect("rendered");
            assert_eq!(stats.samples, u64::from(width * height * n));
            let expected = if n == 0 { 0.0 } else { 0.25 };
            assert!(colours(&film).iter().all(|&v| v == expected), "{width} x {height}, {n} samples");
        }
    }
}

#[test]
fn an_edge_through_a_pixel_centre_is_a_half() {
    for filter in [
        Filter::None,
        Filter::BOX,
        Filter::Box { radius: 1.5 },
        Filter::Tent { radius: 1.0 },
        Filter::gaussian(0.5),
        Filter::MITCHELL,
        Filter::LANCZOS,
    ] {
        let row = row_of(filter, 11, |x| if x < 5.5 { 1.0 } else { 0.0 });
        assert!((row[5] - 0.5).abs() < 1e-5, "{filter:?}: {}", row[5]);
        assert!((row[4] + row[6] - 1.0).abs() < 1e-5, "{filter:?}: {row:?}");
    }
}

#[test]
fn a_tent_spreads_an_edge_over_two_pixels() {
    let row = row_of(Filter::Tent { radius: 1.0 }, 8, |x| if x < 4.0 { 1.0 } else { 0.0 });
    for (found, expected) in row.iter().zip([1.0, 1.0, 1.0, 0.875, 0.125, 0.0, 0.0, 0.0]) {
        assert!((found - expected).abs() < 1e-6, "{row:?}");
    }
}

/// By how much the Gaussian of standard deviation ½, cut off at ±1, attenuates cos 2πfx: the ratio of its
/// integrals with and without the cosine, by Simpson's rule.
fn truncated_attenuation(f: f64) -> f64 {
    let n = 20_000;
    let (mut with, mut without) = (0.0, 0.0);
    for i in 0..=n {
        let x = -1.0 + 2.0 * f64::from(i) / f64::from(n);
        let simpson = if i == 0 || i == n { 1.0 } else { f64::from(2 + 2 * (i % 2)) };
        let g = simpson * (-2.0 * x * x).exp();
        with += g * (2.0 * std::f64::consts::PI * f * x).cos();
        without += g;
    }
    with / without
}

#[test]
fn a_gaussian_attenuates_waves_by_its_transform() {
    // The whole bell gives exp(-2π²σ²f²) = 0.734603, 0.291213 and 0.007192; cut off at 2σ it gives these.
    for (f, expected) in [(0.25, 0.782_718), (0.5, 0.340_725), (1.0, -0.010_923)] {
        assert!((truncated_attenuation(f) - expected).abs() < 1e-5, "{f}: {}", truncated_attenuation(f));
        let wave = |x: f32| (2.0 * std::f64::consts::PI * f * (f64::from(x) - 8.5)).cos() as f32;
        let row = row_of(Filter::gaussian(0.5), 17, wave);
        assert!((f64::from(row[8]) - expected).abs() < 3e-4, "{f}: {} is not {expected}", row[8]);
    }
}

/// Stops after a number of questions.
struct StopAfter {
    left: AtomicUsize,
}

impl Progress for StopAfter {
    fn done(&self, done: u64, total: u64, rays: u64) {
        assert!(done <= total && rays > 0);
    }

    fn cancelled(&self) -> bool {
        self.left.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |n| n.checked_sub(1)).is_err()
    }
}

#[test]
fn a_cancelled_render_keeps_what_it_has() {
    let film = film(FilmSpec::new(96, 96));
    let settings = RenderSettings { threads: 1, ..settings(SamplerKind::Regular, 4) };
    let stop = StopAfter { left: AtomicUsize::new(10) };
    let Err(RenderError::Cancelled(stats)) = render(&Field(|_, _| 0.5), &film, &settings, &stop) else {
        panic!("the render was not cancelled");
    };
    let done = colours(&film).iter().filter(|&&v| v == 0.5).count() as u64;
    assert!(done > 0 && done < 96 * 96, "{done} pixels");
    assert_eq!(stats.samples, 4 * done);

    let at_once = StopAfter { left: AtomicUsize::new(0) };
    let film = self::film(FilmSpec::new(64, 64));
    let stopped = render(&Field(|_, _| 0.5), &film, &settings, &at_once);
    assert_eq!(colours(&film), vec![0.0; 4096]);
    assert!(matches!(stopped, Err(RenderError::Cancelled(RenderStats { samples: 0, .. }))));
}

/// Adds up what is reported.
#[derive(Default)]
struct Count {
    largest: AtomicU64,
    rays: AtomicU64,
}

impl Progress for Count {
    fn done(&self, done: u64, total: u64, rays: u64) {
        assert_eq!(total, 100 * 50);
        self.largest.fetch_max(done, Ordering::Relaxed);
        self.rays.fetch_max(rays, Ordering::Relaxed);
    }

    fn cancelled(&self) -> bool {
        false
    }
}

#[test]
fn progress_ends_with_everything_done() {
    let film = film(FilmSpec::new(100, 50));
    let count = Count::default();
    render(&Field(|_, _| 0.5), &film, &settings(SamplerKind::Jittered, 3), &count).expect("rendered");
    assert_eq!((count.largest.into_inner(), count.rays.into_inner()), (5000, 45_000));
}

#[test]
fn a_panic_costs_one_unit() {
    let film = film(FilmSpec::new(64, 64));
    let bug =
        Field(|p: Vec2, _| if p.x as u32 == 40 && p.y as u32 == 10 { panic!("boo at {p}") } else { 0.5 });
    let Err(RenderError::Panicked { failed, stats }) =
        render(&bug, &film, &settings(SamplerKind::Regular, 1), &Silent)
    else {
        panic!("nothing failed");
    };
    assert_eq!(failed.len(), 1);
    assert_eq!(
        failed[0].unit,
        Unit { tile: Rect { x0: 32, y0: 0, x1: 64, y1: 32 }, samples: 0..1, limits: Unit::UNLIMITED }
    );
    assert!(failed[0].message.starts_with("boo at"));
    assert_eq!(stats.threads, 2);
    let colours = colours(&film);
    assert_eq!(colours.iter().filter(|&&v| v == 0.5).count(), 3 * 1024);
    let error = RenderError::Panicked { failed, stats }.to_string();
    assert!(error.contains("(32, 0)") && error.contains("boo at"), "{error}");
}

#[test]
fn few_tiles_share_their_samples_among_threads() {
    let plan = |width, height, samples, threads| {
        let settings = RenderSettings { threads, ..settings(SamplerKind::Uniform, samples) };
        Plan::new(&film(FilmSpec::new(width, height)), &settings, 0..samples, &[])
    };
    // One tile, eight threads: 64 units, whose sample ranges follow each other.
    let one = plan(1, 1, 1000, 8);
    assert_eq!(one.len(), 64);
    let mut next = 0;
    for i in 0..64 {
        let unit = one.unit(i).expect("a unit");
        assert_eq!(unit.samples.start, next);
        next = unit.samples.end;
    }
    assert_eq!((next, one.unit(64)), (1000, None));
    assert_eq!(plan(1, 1, 3, 8).len(), 3);
    assert_eq!(plan(320, 320, 1000, 8).len(), 100);
    assert_eq!(plan(320, 320, 0, 8).len(), 0);
    // Absurd wishes are cut down.
    let absurd =
        RenderSettings { threads: usize::MAX, tile: u32::MAX, ..settings(SamplerKind::Uniform, u32::MAX) };
    let plan = Plan::new(&film(FilmSpec::new(1000, 1000)), &absurd, 0..u32::MAX, &[]);
    assert_eq!((plan.grid.len(), plan.len()), (4, 8 * 1024));
}

/// A part of a picture has the same bits as in the whole, with every filter and every way to split the work.
#[test]
fn a_part_is_the_same_as_in_the_whole() {
    let noisy = Field(|p: Vec2, u: f32| u * (p.x * 0.37).sin().abs() + 1e-3 * p.y);
    let shown = Rect { x0: 13, y0: 9, x1: 50, y1: 37 };
    for (filter, kind) in [
        (Filter::None, SamplerKind::Jittered),
        (Filter::MITCHELL, SamplerKind::Sobol),
        (Filter::gaussian(1.3), SamplerKind::Poisson),
    ] {
        let spec = FilmSpec {
            filter,
            layers: LayerSet::of(&[Layer::Color, Layer::ObjectId]),
            ..FilmSpec::new(67, 41)
        };
        let rendered = |spec: FilmSpec, tile| {
            let film = film(spec);
            let settings = RenderSettings { tile, ..settings(kind, 5) };
            let stats = render(&noisy, &film, &settings, &Silent).expect("rendered");
            (film, stats.samples)
        };
        let (whole, all) = rendered(spec, 0);
        for (tile, one_pass) in [(0, false), (8, true), (64, true)] {
            let (part, some) = rendered(FilmSpec { shown: Some(shown), one_pass, ..spec }, tile);
            assert!(some < all && some >= 5 * shown.area(), "{some} of {all}");
            let (part_image, image) =
                (part.develop(Layer::Color).expect("colour"), whole.develop(Layer::Color).expect("colour"));
            assert_eq!([part_image.width(), part_image.height()], [37, 28]);
            let (part_ids, ids) =
                (part.ids(Layer::ObjectId).expect("ids"), whole.ids(Layer::ObjectId).expect("ids"));
            for y in 0..28 {
                for x in 0..37 {
                    let (of_part, of_whole) = (part_image.pixel(x, y), image.pixel(x + 13, y + 9));
                    assert_eq!(of_part, of_whole, "{filter:?} at {x}, {y}");
                    assert_eq!(part_ids[(y * 37 + x) as usize], ids[((y + 9) * 67 + x + 13) as usize]);
                }
            }
        }
        let outside = FilmSpec { shown: Some(Rect { x0: 70, y0: 0, x1: 80, y1: 9 }), ..spec };
        assert!(outside.check(u64::MAX).is_err());
    }
}
