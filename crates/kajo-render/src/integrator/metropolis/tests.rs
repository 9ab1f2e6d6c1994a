//! Markov chains against closed forms and against paths.

use std::f64::consts::PI;
use std::ops::Range;

use kajo_core::sampler::{Sampler, SamplerKind};
use kajo_core::settings::Caustics;
use kajo_math::rng::Stream;
use kajo_scene::MemoryAssets;
use kajo_testkit::{Estimate, every, is_deep, p_of_equal_means};

use super::MutatedSamples::{ByTechnique, OfBothEnds, OfPaths};
use super::allotment::Moments;
use super::chain::{acceptance, moved};
use super::*;
use crate::integrator::bidir::integrator_of;
use crate::integrator::same_picture::assert_same_picture;
use crate::integrator::tests::scene_with;
use crate::integrator::{PathSettings, Prepare};
use crate::{
    Film, FilmSpec, LARGEST_R_HAT, Position, RenderSettings, Silent, Unit, render, render_work_unit,
};

/// Chains that begin at fewer samples.
struct Small<'a>(Metropolis<'a>);

const FEW: u32 = 4096;

/// So many samples of each class, fewer where there are many classes.
fn few(of: &Metropolis<'_>) -> Vec<u32> {
    let classes = of.mutated().classes().len();
    vec![FEW.min(6 * FEW / classes as u32); classes]
}

impl PixelIntegrator for Small<'_> {
    fn sample(&self, _: &mut SampleContext<'_>, _: [u32; 2], _: Vec2) -> PixelSample {
        panic!("samples are taken with a state")
    }

    fn samples_per_state(&self) -> Option<SamplesPerState> {
        Some(SamplesPerState::All)
    }

    fn with_state<'a>(&'a self, _: u32, setup: &Setup<'_>) -> Result<WithState<'a>, SetupError> {
        let (starts, rays) = Starts::of_samples(&few(&self.0), self.0.mutated(), self.0.size, setup)?;
        Ok(WithState { integrator: Box::new(Chains { of: &self.0, starts }), rays, notes: Vec::new() })
    }
}

const SIZE: [u32; 2] = [24, 20];

fn scene(text: &str) -> Scene {
    scene_with(text, &MemoryAssets::new())
}

fn setup(seed: u64) -> Setup<'static> {
    Setup { seed, threads: 1, memory: u64::MAX, progress: &Silent }
}

fn film() -> Film {
    let layers = LayerSet::of(&[Layer::Color]);
    Film::new(FilmSpec { layers, ..FilmSpec::new(SIZE[0], SIZE[1]) }, u64::MAX).unwrap()
}

fn schedule(samples: u32, seed: u64, threads: usize, tile: u32) -> RenderSettings {
    RenderSettings { seed, threads, tile, ..RenderSettings::new(Sampler::new(SamplerKind::Uniform, samples)) }
}

/// Means of the first channel over the quarters of a picture, and over all of it.
fn means(integrator: &dyn PixelIntegrator, samples: u32, seed: u64) -> [f64; 5] {
    let film = film();
    render(integrator, &film, &schedule(samples, seed, 1, 0), &Silent).unwrap();
    let image = film.develop(Layer::Color).unwrap();
    let mut sums = [0.0; 5];
    for (i, pixel) in image.data().chunks_exact(3).enumerate() {
        let (x, y) = (i as u32 % SIZE[0], i as u32 / SIZE[0]);
        let quarter = u32::from(x >= SIZE[0] / 2) + 2 * u32::from(y >= SIZE[1] / 2);
        sums[quarter as usize] += 4.0 * f64::from(pixel[0]);
        sums[4] += f64::from(pixel[0]);
    }
    sums.map(|sum| sum / f64::from(SIZE[0] * SIZE[1]))
}

/// [`means`] of batches of samples, chains with beginnings of their own.
fn estimates(integrator: &dyn PixelIntegrator, samples: u32) -> [Estimate; 5] {
    let batches: Vec<[f64; 5]> = (0..32).map(|batch| means(integrator, samples, batch)).collect();
    [0, 1, 2, 3, 4].map(|region| Estimate::of_batches(|batch| batches[batch as usize][region]))
}

fn chains(scene: &Scene, bounces: u32, samples: MutatedSamples) -> Small<'_> {
    let settings = MetropolisSettings { bounces, samples, ..MetropolisSettings::default() };
    Small(Metropolis::new(scene, settings, SIZE, LayerSet::of(&[Layer::Color])))
}

fn camera(from: [f32; 3], to: [f32; 3], angle: f32) -> String {
    let [a, b, c] = from;
    let [x, y, z] = [to[0] - a, to[1] - b, to[2] - c];
    format!(
        "PerspectiveCamera {{ center {a} {b} {c}  direction {x} {y} {z}  up 0.1 0.9 0.2  angle {angle} }}
         Background {{ color 0 0 0 }}"
    )
}

/// Independent proposals with the target `2u` are accepted with probability 2/3 in the mean, with `3u^2` with 1/2.
#[test]
fn acceptance_is_that_of_known_targets() {
    for (power, expected) in [(1, 2.0 / 3.0), (2, 0.5)] {
        let estimate = Estimate::of_batches(|batch| {
            let stream = Stream::new(4, [batch, power as u32], 0);
            let target = |u: f32| u.powi(power);
            let (mut u, mut sum) = (0.7, 0.0);
            let n = 20_000;
            for m in 0..n {
                let v = stream.uniform(2 * m);
                let a = acceptance(target(u), target(v));
                sum += f64::from(a);
                if stream.uniform(2 * m + 1) < a {
                    u = v;
                }
            }
            sum / f64::from(n)
        });
        estimate.check(expected, 2e-3).unwrap();
    }
}

#[test]
fn small_steps_are_small_symmetric_and_stay_in_the_cube() {
    let stream = Stream::new(9, [0, 0], 0);
    let mut logarithms = [0u32; 8];
    for i in 0..40_000 {
        let (u, x) = (stream.uniform(2 * i), stream.uniform(2 * i + 1));
        for is_up in [false, true] {
            let v = moved(u, x, is_up);
            assert!((0.0..1.0).contains(&v));
            let step = (v - u).abs().min(1.0 - (v - u).abs());
            assert!((0.99 / 1024.0..1.01 / 64.0).contains(&step), "from {u} by {step}");
            // The way back is the same step the other way.
            assert!((moved(v, x, !is_up) - u).abs() < 1e-6 || u < 1e-6);
            logarithms[((step * 1024.0).log2() * 2.0).clamp(0.0, 7.0) as usize] += 1;
        }
    }
    assert!(logarithms.iter().all(|&n| n.abs_diff(10_000) < 600), "{logarithms:?}");
    assert!(moved(1.0 - f32::EPSILON / 2.0, 0.0, true) < 1.0 && moved(0.0, 0.5, false) < 1.0);
}

/// Brightness that grows across the picture, and a strip beside it that is dark.
struct Ramp;

impl PixelIntegrator for Ramp {
    fn sample(&self, ctx: &mut SampleContext<'_>, _: [u32; 2], raster: Vec2) -> PixelSample {
        let x = raster.x / SIZE[0] as f32;
        // A number behind the film decides, too.
        let value = if x < 0.25 { 0.0 } else { x * 2.0 * ctx.draws.next_1d() };
        PixelSample { radiance: [value, 0.5 * value, 0.0], first: None }
    }
}

#[test]
fn a_chain_finds_a_ramp_of_known_brightness() {
    let pass = |seed: u64| {
        let (starts, _) = Starts::of_samples(&[FEW], Mutated::Whole(&Ramp), SIZE, &setup(seed)).unwrap();
        let mut columns = [0.0; 24];
        let mutations = 40_000;
        let sampler = Sampler::new(SamplerKind::Uniform, 1);
        let mut ctx = SampleContext::new(&sampler, seed);
        ctx.begin([0, 0], 0);
        let start = starts.draw(seed, [0, 0], 0, 0).unwrap();
        let mut evaluation = Evaluation::of(Mutated::Whole(&Ramp), SIZE, &mut ctx);
        let mut chain = Chain::new(start, &mut evaluation);
        for m in 0..mutations {
            chain.mutate(m, starts.brightness_of(&start), &mut evaluation, &mut |raster, value| {
                columns[raster.x as usize] += 24.0 * f64::from(value[0]) / f64::from(mutations);
            });
        }
        columns
    };
    let passes: Vec<[f64; 24]> = (0..32).map(pass).collect();
    (0..24).for_each(|column: usize| {
        let expected = if column < 6 { 0.0 } else { (column as f64 + 0.5) / 24.0 };
        let found = Estimate::of_batches(|batch| passes[batch as usize][column]);
        assert!(found.check(expected, 0.05).is_ok(), "column {column}: {found:?} for {expected}");
    });
}

fn emissive_sphere() -> String {
    format!(
        "{} Materials {{ Material m {{ diffuseColor 0.5 0.5 0.5  emission 1 1 1 }} }}
         Group {{ MaterialIndex m Sphere {{ center 0 0 0 radius 1 }} }}",
        camera([0.2, 0.1, -0.1], [0.7, -0.3, 0.5], 70.0)
    )
}

#[test]
fn an_emissive_room_and_a_white_ball_are_as_bright_as_their_series() {
    let emissive = emissive_sphere();
    let white = format!(
        "{} Lights {{ PointLight {{ position 0.5 0 0  intensity 1 1 1 }} }}
         Materials {{ Material m {{ diffuseColor 0.8 0.8 0.8 }} }}
         Group {{ MaterialIndex m Sphere {{ center 0 0 0 radius 1 }} }}",
        camera([0.0, 0.6, 0.0], [-1.0, 0.0, 0.0], 0.01)
    );
    let forms = [(&emissive, 30, 2.0), (&emissive, 1, 1.75), (&white, 60, 0.8 / PI * (1.0 / 2.25 + 4.0))];
    for (text, bounces, expected) in every(2, forms) {
        let scene = scene(text);
        for samples in [OfPaths, OfBothEnds, ByTechnique] {
            let [.., found] =
                estimates(&chains(&scene, bounces, samples), if samples == ByTechnique { 8 } else { 2 });
            assert!(
                found.check(expected, 0.01).is_ok(),
                "{bounces} bounces, {samples:?}: {found:?} instead of {expected}"
            );
        }
    }
}

const BOX: &str = "Materials { Matte wall { color 0.6 0.6 0.6 }  Matte red { color 0.7 0.2 0.2 }
        Matte emitter { color 0 0 0 emission 5 5 5 emits front } }
    Group { MaterialIndex wall Box { min -2 -2 -2 max 2 2 2 }
            MaterialIndex emitter Quad { corner -1.5 1.9 -1 edge1 1 0 0 edge2 0 0 1 }
            MaterialIndex red Box { min 0.4 -2 -1 max 1.4 0 0 } }";

/// The parts of a matt room are as bright as paths find them, and the whole has the brightness of the independent samples.
#[test]
fn chains_and_paths_agree_in_every_part_of_a_room() {
    let scene = scene(&format!("{} {BOX}", camera([0.0, 0.0, 1.9], [0.0, -1.0, 0.0], 70.0)));
    let path = PathSettings { bounces: 3, ..PathSettings::default() };
    let expected = estimates(&Path::new(&scene, path, SIZE, LayerSet::of(&[Layer::Color])), 4);
    for samples in [OfPaths, OfBothEnds, ByTechnique] {
        let found = estimates(&chains(&scene, 3, samples), if samples == ByTechnique { 24 } else { 4 });
        for (region, (found, expected)) in found.iter().zip(&expected).enumerate() {
            let sigma = found.standard_error.hypot(expected.standard_error);
            assert!(
                (found.mean - expected.mean).abs() < 4.5 * sigma && sigma < 0.03 * expected.mean,
                "region {region}, {samples:?}: {found:?} and {expected:?}"
            );
        }
    }
}

/// A cloud and haze under a spot light, with the light from both ends that is held to paths elsewhere: paths alone are noisy near the light.
#[test]
fn chains_and_light_from_both_ends_agree_in_fog() {
    let scene = scene(&format!(
        "{} Lights {{ SpotLight {{ position 0 1.8 0  direction 0 -1 -0.3  angle 70  innerAngle 30  intensity 3 3 3 }} }}
         Media {{ FunctionMedium m {{ function = 2 - x  sigma_s 0.6 1 0.8 }} Medium air {{ sigma_s 0.2  sigma_a 0.1 }} exterior air }}
         Materials {{ Matte wall {{ color 0.6 0.6 0.6 }}  Interface i {{ medium m }} }}
         Group {{ MaterialIndex wall Box {{ min -2 -2 -2 max 2 2 2 }}  MaterialIndex i Box {{ min -0.8 -1 -1 max 0.8 1 0.4 }} }}",
        camera([0.0, 0.0, 1.9], [0.0, -0.3, 0.0], 70.0)
    ));
    let settings = BidirectionalSettings { bounces: 2, ..BidirectionalSettings::default() };
    let layers = LayerSet::of(&[Layer::Color]);
    let both = integrator_of(&scene.output.camera, &scene, settings, SIZE, layers);
    let expected = estimates(&*both, 4);
    for samples in [OfBothEnds, ByTechnique] {
        let found = estimates(&chains(&scene, 2, samples), if samples == ByTechnique { 40 } else { 4 });
        for (region, (found, expected)) in found.iter().zip(&expected).enumerate() {
            let sigma = found.standard_error.hypot(expected.standard_error);
            assert!(
                (found.mean - expected.mean).abs() < 4.5 * sigma && sigma < 0.08 * expected.mean,
                "region {region}, {samples:?}: {found:?} and {expected:?}"
            );
        }
    }
}

/// The caustic of a point below a ball of glass and beside a mirror, which is on no path of scattering alone: each part of the floor is as bright
/// as independent samples of the same paths find it.
#[test]
fn chains_walk_on_manifolds() {
    let scene = scene(&format!(
        "{} Lights {{ PointLight {{ position 0.2 2.3 0  intensity 3 }} }}
         Materials {{ Matte floor {{ color 0.5 0.5 0.5 }}  Glass glass {{ indexOfRefraction 1.5 }}  Metal mirror {{ metal silver }} }}
         Group {{ MaterialIndex floor Quad {{ corner -3 0 -3 edge1 0 0 6 edge2 6 0 0 }}
                  MaterialIndex glass Sphere {{ center 0 1.2 0 radius 0.5 }}
                  MaterialIndex mirror Quad {{ corner 2 0 2 edge1 0 2 0 edge2 0 0 -4 }} }}",
        camera([0.3, 2.5, 3.5], [0.5, 0.0, 0.0], 50.0)
    ));
    let settings = MetropolisSettings {
        bounces: 3,
        samples: OfPaths,
        caustics: Caustics::Manifold,
        ..MetropolisSettings::default()
    };
    let paths = ManifoldPath::through(
        &scene.output.camera,
        &scene,
        settings.of_paths(),
        SIZE,
        LayerSet::of(&[Layer::Color]),
    );
    let expected = estimates(&paths, 8);
    let walking = Small(Metropolis::new(&scene, settings, SIZE, LayerSet::of(&[Layer::Color])));
    let found = estimates(&walking, 8);
    let plain = MetropolisSettings { caustics: Caustics::Scattering, ..settings };
    let without = Small(Metropolis::new(&scene, plain, SIZE, LayerSet::of(&[Layer::Color])));
    let without = estimates(&without, 2);
    for (region, (found, expected)) in found.iter().zip(&expected).enumerate() {
        let sigma = found.standard_error.hypot(expected.standard_error);
        assert!(
            (found.mean - expected.mean).abs() < 4.5 * sigma && sigma < 0.08 * expected.mean,
            "region {region}: {found:?} and {expected:?}"
        );
    }
    assert!(without[4].mean < 0.9 * found[4].mean, "{without:?}");
    assert_eq!(settings.left_out(&scene, SIZE), Vec::<&str>::new());
    let fog = scene_with("Media { Medium air { sigma_s 0.1 } exterior air }", &MemoryAssets::new());
    assert!(settings.left_out(&fog, SIZE).iter().any(|note| note.contains("caustics manifold")));
    assert_same_picture(&walking, SIZE, &schedule(6, 1, 1, 0), [20, 11]);
}

#[test]
fn threads_tiles_and_stops_make_the_same_picture() {
    let media = "Media { FunctionMedium m { function = 2 - x  sigma_s 0.6 1 0.8 }
            Medium air { sigma_s 0.2  sigma_a 0.1 }  exterior air }
        Materials { Interface cloud { medium m }";
    let cloud = "Group { MaterialIndex cloud Sphere { center -1 -1 0 radius 0.7 }";
    let foggy = BOX.replacen("Materials {", media, 1).replacen("Group {", cloud, 1);
    for text in [BOX, &foggy] {
        let scene = scene(&format!("{} {text}", camera([0.0, 0.0, 1.9], [0.0, -1.0, 0.0], 70.0)));
        for samples in [OfPaths, OfBothEnds, ByTechnique] {
            assert_same_picture(&chains(&scene, 3, samples), SIZE, &schedule(6, 1, 1, 0), [20, 11]);
        }
    }
}

/// In an emissive sphere of albedo 1/2 paths of `k` vertices bring `2^(2-k)`, and so do the chains that follow them:
/// all the way from the choice of the length.
#[test]
fn the_light_of_each_length_has_its_mean() {
    let scene = scene(&emissive_sphere());
    let it = chains(&scene, 2, ByTechnique).0;
    let pass = |seed: u64| {
        let (starts, _) = Starts::of_samples(&few(&it), it.mutated(), SIZE, &setup(seed)).unwrap();
        let (draws, mutations) = (32, 250);
        let sampler = Sampler::new(SamplerKind::Uniform, draws);
        let mut ctx = SampleContext::new(&sampler, seed);
        let mut means = [0.0; 7];
        for index in 0..draws {
            ctx.begin([0, 0], index);
            let start = starts.draw(seed, [0, 0], index, index.into()).unwrap();
            let mut evaluation = Evaluation::of(it.mutated(), SIZE, &mut ctx);
            let mut chain = Chain::new(start, &mut evaluation);
            for m in 0..mutations {
                chain.mutate(m, starts.brightness_of(&start), &mut evaluation, &mut |_, value| {
                    means[start.class as usize] += f64::from(value[0]) / f64::from(draws * mutations);
                });
            }
            evaluation.give_back(&mut ctx);
        }
        means
    };
    let passes: Vec<[f64; 7]> = (0..32).map(pass).collect();
    for (k, expected) in [0.0, 0.0, 1.0, 0.5, 0.25, 0.125, 0.0].into_iter().enumerate() {
        let found = Estimate::of_batches(|batch| passes[batch as usize][k]);
        assert!(found.check(expected, 0.08).is_ok(), "{k} vertices: {found:?} for {expected}");
    }
}

/// Importances of classes whose means and spreads are known: 1 or 1 + 2 spread, each as often; nothing where the spread is negative.
struct Spreads(Vec<f64>);

impl Spreads {
    fn numbers(&self, limits: [u32; 2]) -> (Vec<u32>, u32) {
        let mut pilot = 0;
        let more = |numbers: &[u32], classes: &mut [Moments]| {
            pilot += numbers.iter().sum::<u32>();
            for ((class, &n), spread) in classes.iter_mut().zip(numbers).zip(&self.0) {
                (0..n).for_each(|i| {
                    class.add((1.0 + 2.0 * spread * f64::from(i % 2)) * f64::from(u8::from(*spread >= 0.0)))
                });
            }
            Ok::<(), ()>(())
        };
        let numbers = allotment::numbers(self.0.len(), limits, more).unwrap();
        (numbers, pilot)
    }
}

/// Of four classes with the spreads 0, 1, 2 and 5 and the means 1, 2, 3 and 6, in units of their sum 12 the sum of spreads is 2/3.
#[test]
fn samples_are_allotted_by_the_spread_of_each_class() {
    let classes = Spreads(vec![0.0, 1.0, 2.0, 5.0]);
    let share = [0.0, 0.125, 0.25, 0.625].map(|share| 0.125 / 4.0 + 0.875 * share);
    let all = (2.0 / 3.0 / (UNSURE / 8.0)).powi(2);
    for (limits, expected) in [([100, u32::MAX], all), ([100, 3000], 3000.0), ([200_000, 300_000], 200_000.0)]
    {
        let (numbers, pilot) = classes.numbers(limits);
        for (&n, share) in numbers.iter().zip(share) {
            let wanted = share * expected;
            assert!((f64::from(n) - wanted).abs() < 0.02 * wanted + 2.0, "{numbers:?} for {wanted}");
        }
        assert!(f64::from(pilot) < 0.26 * expected + 300.0, "{pilot} samples tell of {expected}");
    }
    // Where nothing is found, all are looked at alike, as often as they may be.
    assert_eq!(Spreads(vec![-1.0; 3]).numbers([9, 300]).0, [100; 3]);
}

/// An easy room begins with few samples, whose numbers no thread changes: over paths a thirtieth of what there may be,
/// by lengths a sixth. Each part of the picture's samples has start samples of its own.
#[test]
fn easy_rooms_begin_with_few_samples() {
    let easy = scene(&emissive_sphere());
    for (samples, most, factor) in [(OfBothEnds, 1 << 17, 25), (ByTechnique, 1 << 20, 5)] {
        let settings = MetropolisSettings { bounces: 16, samples, ..MetropolisSettings::default() };
        let it = Metropolis::new(&easy, settings, [640, 480], LayerSet::of(&[Layer::Color]));
        let find = |threads, k| it.starts(k, &Setup { threads, ..setup(3) }).unwrap();
        let [one, two, seven] = [1, 2, 7].map(|threads| find(threads, 0));
        assert!(one == two && one == seven, "{samples:?}");
        let (starts, rays) = one;
        assert!(rays.camera.max(starts.number() as u64) < most / factor, "{rays:?}");
        assert!(starts.standard_error() < 0.2 * UNSURE * starts.brightness() && starts.notes().is_empty());
        assert_ne!(starts.brightness(), find(1, 1).0.brightness());
        assert_eq!(PixelIntegrator::samples_per_state(&it), NonZeroU32::new(54).map(SamplesPerState::Count));
    }
}

/// The number of samples is told by others, so that their mean is that of the light, however few they are.
#[test]
fn the_pilot_makes_no_bias() {
    let scene = scene(&emissive_sphere());
    let it = chains(&scene, 2, ByTechnique).0;
    let brightness = |batch: u32| {
        let mean = |i: u32| {
            let (starts, _) =
                Starts::within([16, 400], it.mutated(), SIZE, &setup((batch * 100 + i).into())).unwrap();
            starts.brightness() / 20.0
        };
        (0..20).map(mean).sum::<f64>()
    };
    Estimate::of_batches(brightness).check(1.875, 0.01).unwrap();
}

/// A room that is lit through a slit in the wall behind which the emitter is.
const SLIT: &str = "Materials { Matte wall { color 0.6 0.6 0.6 }
        Matte emitter { color 0 0 0 emission 50 50 50 } }
    Group { MaterialIndex wall Box { min -2 -2 -4 max 2 2 2 }
            Box { min -2 -2 -2.1 max 1.85 2 -2 }
            Box { min 1.9 -2 -2.1 max 2 2 -2 }
            MaterialIndex emitter Sphere { center -1.4 1.2 -3.4 radius 0.2 } }";

/// R-hat of a render.
fn r_hat(integrator: &dyn PixelIntegrator, samples: u32, seed: u64) -> f64 {
    let film = film();
    render(integrator, &film, &schedule(samples, seed, 2, 0), &Silent).unwrap();
    film.r_hat().unwrap()
}

/// Chains that have found no other light than that they began with do not agree; many of an easy room do, and of the same room the more the better.
#[test]
fn few_chains_of_a_slit_do_not_agree_and_many_of_a_room_do() {
    let slit = scene(&format!("{} {SLIT}", camera([-1.0, 0.0, 1.9], [0.6, -0.3, 0.0], 70.0)));
    let room = scene(&format!("{} {BOX}", camera([0.0, 0.0, 1.9], [0.0, -1.0, 0.0], 70.0)));
    let (slit, room) = (chains(&slit, 4, OfBothEnds), chains(&room, 3, OfBothEnds));
    for seed in 0..3 {
        let found = [r_hat(&slit, 32, seed), r_hat(&slit, 256, seed), r_hat(&room, 256, seed)];
        let [few, many, easy] = found;
        assert!(
            few > LARGEST_R_HAT && many < few && easy < LARGEST_R_HAT && easy < many,
            "seed {seed}: {found:?}"
        );
    }
    assert_eq!(r_hat(&room, 1, 0), f64::INFINITY, "a single chain");
}

/// Films of parts add up to the counts of the whole, by way of files too; other integrators count nothing.
#[test]
fn parts_of_a_render_count_what_the_whole_does() {
    let room = scene(&format!("{} {BOX}", camera([0.0, 0.0, 1.9], [0.0, -1.0, 0.0], 70.0)));
    let integrator = chains(&room, 3, OfBothEnds);
    let settings = schedule(12, 5, 2, 0);
    let whole = film();
    render(&integrator, &whole, &settings, &Silent).unwrap();
    let sum = film();
    for samples in [7..12, 0..4, 4..7] {
        let part = film();
        let unit = Unit { tile: whole.spec().rect(), samples, limits: Unit::UNLIMITED };
        render_work_unit(&integrator, &part, &settings, &Position::default(), &unit, &Silent).unwrap();
        sum.absorb(restored(&part)).unwrap();
    }
    let found = sum.r_hat().unwrap();
    assert!(found > 1.0 && found.is_finite() && Some(found) == whole.r_hat(), "{found}");
    let path = Path::new(&room, PathSettings::default(), SIZE, LayerSet::of(&[Layer::Color]));
    let other = film();
    render(&path, &other, &settings, &Silent).unwrap();
    assert_eq!(restored(&other).r_hat(), None);
}

/// Means of the first channel over tiles of 8 x 10 pixels, of so many samples of a render.
fn tile_means(integrator: &Metropolis<'_>, samples: Range<u32>, seed: u64) -> Vec<f64> {
    let film = film();
    let unit = Unit { tile: film.spec().rect(), samples, limits: Unit::UNLIMITED };
    let settings = schedule(unit.samples.end, seed, 1, 0);
    render_work_unit(integrator, &film, &settings, &Position::default(), &unit, &Silent).unwrap();
    let image = film.develop(Layer::Color).unwrap();
    let mut sums = vec![0.0; 6];
    for (i, pixel) in image.data().chunks_exact(3).enumerate() {
        let (x, y) = (i % SIZE[0] as usize, i / SIZE[0] as usize);
        sums[x / 8 + 3 * (y / 10)] += f64::from(pixel[0]) / 80.0;
    }
    sums
}

/// Means of tiles do not depend on the seed by more than their noise: start samples, which all chains of a render share, the choice
/// of their beginnings and of their lengths, all of it.
#[test]
fn seeds_agree_in_every_tile() {
    const SEEDS: u64 = 16;
    let parts = if is_deep() { 6 } else { 3 };
    let scene = scene(&format!("{} {BOX}", camera([0.0, 0.0, 1.9], [0.0, -1.0, 0.0], 70.0)));
    for (samples, per_part) in every(2, [(OfBothEnds, 2), (ByTechnique, 8)]) {
        let settings = MetropolisSettings { bounces: 2, samples, ..MetropolisSettings::default() };
        let integrator = Metropolis::new(&scene, settings, SIZE, LayerSet::of(&[Layer::Color]));
        let of_seed = |seed: u64| -> Vec<Vec<f64>> {
            (0..parts)
                .map(|part| tile_means(&integrator, part * per_part..(part + 1) * per_part, seed))
                .collect()
        };
        let seeds: Vec<Vec<Vec<f64>>> = (0..SEEDS).map(of_seed).collect();
        for tile in 0..6 {
            let groups: Vec<Vec<f64>> =
                seeds.iter().map(|parts| parts.iter().map(|means| means[tile]).collect()).collect();
            let p = p_of_equal_means(&groups);
            assert!(p > 1e-3, "{samples:?}, tile {tile}: p = {p}");
        }
    }
}

/// A film that was saved and read again.
fn restored(film: &Film) -> Film {
    let mut saved = Vec::new();
    film.save(1, &mut saved).unwrap();
    let mut rest = &saved[..];
    let restored = Film::restore(*film.spec(), u64::MAX, &mut rest).unwrap();
    assert!(rest.is_empty() && restored.r_hat() == film.r_hat());
    restored
}

#[test]
fn what_cannot_be_is_said() {
    let dark = scene(&format!(
        "{} Materials {{ Matte m {{ }} }} Group {{ MaterialIndex m Sphere {{ center 0 0 0 radius 1 }} }}",
        camera([0.0, 0.0, 3.0], [0.0, 0.0, 0.0], 30.0)
    ));
    let integrator = chains(&dark, 3, OfBothEnds);
    let (starts, rays) = Starts::of_samples(&[500], integrator.0.mutated(), SIZE, &setup(0)).unwrap();
    assert!(starts.notes()[0].contains("none of 500 samples") && rays.camera == 500);
    assert_eq!(starts.draw(0, [0, 0], 0, 0), None);
    assert_eq!(means(&integrator, 1, 0), [0.0; 5]);
    let poor = Setup { memory: 10, ..setup(0) };
    let refused = Starts::of_samples(&[500], integrator.0.mutated(), SIZE, &poor).err().unwrap();
    assert!(refused.to_string().contains("8000 bytes"), "{refused}");
}
