//! Irradiance caches against closed forms and against paths.

use std::f64::consts::PI;

use kajo_core::light::LightChoice;
use kajo_core::sampler::{Sampler, SamplerKind};
use kajo_core::settings::Gradients;
use kajo_image::Image;
use kajo_scene::MemoryAssets;

use super::*;
use crate::integrator::PathSettings;
use crate::integrator::same_picture::assert_same_picture;
use crate::integrator::tests::scene_with;
use crate::{Film, FilmSpec, Layer, PixelIntegrator, RenderSettings, Silent, render};

fn scene(text: &str) -> Scene {
    scene_with(text, &MemoryAssets::new())
}

fn camera(from: [f32; 3], to: [f32; 3], angle: f32) -> String {
    let [a, b, c] = from;
    let [x, y, z] = [to[0] - a, to[1] - b, to[2] - c];
    format!(
        "PerspectiveCamera {{ center {a} {b} {c}  direction {x} {y} {z}  up 0.1 0.9 0.2  angle {angle} }}
         Background {{ color 0 0 0 }}"
    )
}

const ALL: [Gradients; 3] = [Gradients::Occlusion, Gradients::Strata, Gradients::Off];

fn with(gradients: Gradients) -> IrradianceSettings {
    IrradianceSettings { gradients, bounces: 100, rays: 512, ..IrradianceSettings::default() }
}

fn setup(seed: u64) -> Setup<'static> {
    Setup { seed, threads: 1, memory: u64::MAX, progress: &Silent }
}

fn film(size: [u32; 2]) -> Film {
    let layers = LayerSet::of(&[Layer::Color]);
    Film::new(FilmSpec { layers, ..FilmSpec::new(size[0], size[1]) }, u64::MAX).unwrap()
}

fn schedule(samples: u32) -> RenderSettings {
    RenderSettings { threads: 2, ..RenderSettings::new(Sampler::new(SamplerKind::Sobol, samples)) }
}

fn picture(integrator: &dyn PixelIntegrator, size: [u32; 2], samples: u32) -> Image {
    let film = film(size);
    render(integrator, &film, &schedule(samples), &Silent).unwrap();
    film.develop(Layer::Color).unwrap()
}

fn mean(picture: &Image) -> f64 {
    let data = picture.data();
    data.iter().map(|&v| f64::from(v)).sum::<f64>() / data.len() as f64
}

fn cached(scene: &Scene, settings: IrradianceSettings, size: [u32; 2], samples: u32) -> Image {
    let integrator = IrradianceCaching::new(scene, settings, size, LayerSet::of(&[Layer::Color]));
    picture(&integrator, size, samples)
}

/// The records for a picture.
fn records(scene: &Scene, settings: IrradianceSettings, size: [u32; 2], seed: u64) -> Cache {
    let caching = IrradianceCaching::new(scene, settings, size, LayerSet::of(&[]));
    let setup = setup(seed);
    caching.builder(&setup).build(None).unwrap().0
}

/// All light is the same everywhere, so no record is wrong but by noise.
#[test]
fn an_emissive_room_is_as_bright_as_its_series() {
    let text = format!(
        "{} Materials {{ Material m {{ diffuseColor 0.5 0.5 0.5  emission 1 1 1 }} }}
         Group {{ MaterialIndex m Sphere {{ center 0 0 0 radius 1 }} }}",
        camera([0.2, 0.1, -0.1], [0.7, -0.3, 0.5], 70.0)
    );
    let scene = scene(&text);
    for gradients in ALL {
        for (bounces, expected) in [(100, 2.0), (1, 1.75), (0, 1.5)] {
            let found =
                mean(&cached(&scene, IrradianceSettings { bounces, ..with(gradients) }, [24, 24], 64));
            assert!(
                (found / expected - 1.0).abs() < 3e-3,
                "{gradients:?}, {bounces}: {found} for {expected}"
            );
        }
    }
}

fn lit_ball(angle: f32) -> Scene {
    scene(&format!(
        "{} Lights {{ PointLight {{ position 0.5 0 0  intensity 1 1 1 }} }}
         Materials {{ Material m {{ diffuseColor 0.5 0.5 0.5 }} }}
         Group {{ MaterialIndex m Sphere {{ center 0 0 0 radius 1 }} }}",
        camera([0.0, 0.6, 0.0], [-1.0, 0.0, 0.0], angle)
    ))
}

/// S2: the indirect irradiance `rho/(1 - rho) I/R^2` is the same everywhere, to 0.5 % with fewer than 200 records.
#[test]
fn the_indirect_light_in_a_ball_is_even() {
    let scene = lit_ball(40.0);
    let size = [48, 48];
    let settings =
        IrradianceSettings { rays: 8192, accuracy: 0.02, bounces: 40, ..with(Gradients::Occlusion) };
    let caching = IrradianceCaching::new(&scene, settings, size, LayerSet::of(&[]));
    let setup = Setup { threads: 2, ..setup(1) };
    let (cache, rays) = caching.builder(&setup).build(None).unwrap();
    let n = cache.records.records().len();
    assert!((8..200).contains(&n), "{n} records");
    assert!(rays.reflected > 8000 * n as u64);
    let expected = 0.5 / (1.0 - 0.5);
    let sampler = Sampler::new(SamplerKind::Sobol, 1);
    let mut ctx = SampleContext::new(&sampler, 7);
    let (mut sums, mut worst, mut count) = ([0.0; 2], 0.0_f64, 0);
    for i in 0..48 * 48 {
        let pixel = [i % 48, i / 48];
        let raster = Vec2::new(pixel[0] as f32, pixel[1] as f32) + ctx.begin(pixel, 0);
        let mut counting = crate::trail::Counting::new(&ctx);
        let (_, look) = caching.plain.observe_with(
            &mut ctx,
            raster,
            &mut counting,
            FirstDiffuseVisitor::from_camera(None),
        );
        let at = look.query().unwrap();
        if let Some(e) = cache.records.irradiance(&at, cache.turn) {
            count += 1;
            let error = f64::from(e[1]) / expected - 1.0;
            sums = [sums[0] + error, sums[1] + error * error];
            worst = worst.max(error.abs());
        }
    }
    assert!(count > 2250, "records hold at {count} of 2304 places");
    let [mean, square] = sums.map(|sum| sum / f64::from(count));
    assert!(mean.abs() < 1e-3 && square.sqrt() < 5e-3 && worst < 0.02, "{mean} {} {worst}", square.sqrt());
}

/// Matt walls of a colour, a mirror, glass, gloss and clay: what paths find.
#[test]
fn caches_and_paths_agree() {
    let text = format!(
        "{} Lights {{ PointLight {{ position 0.5 1.2 0.5  intensity 2 2 2 }} }}
         Materials {{ Matte wall {{ color 0.6 0.5 0.4 }}  Matte red {{ color 0.7 0.1 0.1 }}
                      Metal mirror {{ metal silver }}  Glass glass {{ }}
                      Material shiny {{ diffuseColor 0.3 0.4 0.3  specularColor 0.4 0.4 0.4  exponent 30 }}
                      Matte clay {{ color 0.4 0.4 0.4  roughness 0.6 }} }}
         Group {{ MaterialIndex wall Box {{ min -2 -2 -2 max 2 2 2 }}
                  MaterialIndex red Quad {{ corner -1.99 -2 -2 edge1 0 4 0 edge2 0 0 4 }}
                  MaterialIndex mirror Sphere {{ center -1 -1 -1 radius 0.8 }}
                  MaterialIndex glass Sphere {{ center 1.2 -1 -0.5 radius 0.5 }}
                  MaterialIndex shiny Sphere {{ center 0 -1.5 0.6 radius 0.4 }}
                  MaterialIndex clay Quad {{ corner 0.4 -1.9 0.4 edge1 1.2 0 0.3 edge2 0 1.2 0 }} }}",
        camera([0.0, 0.0, 1.9], [0.0, -1.0, 0.0], 70.0)
    );
    let scene = scene(&text);
    let size = [24, 24];
    let path = PathSettings { bounces: 30, ..PathSettings::default() };
    let expected = picture(&Path::new(&scene, path, size, LayerSet::of(&[Layer::Color])), size, 512);
    for gradients in ALL {
        let settings = IrradianceSettings { bounces: 30, rays: 1024, ..with(gradients) };
        let found = cached(&scene, settings, size, 128);
        let error = (mean(&found) / mean(&expected) - 1.0).abs();
        assert!(error < 0.01, "{gradients:?}: {} instead of {}", mean(&found), mean(&expected));
        let difference: f64 =
            std::iter::zip(found.data(), expected.data()).map(|(a, b)| f64::from((a - b).abs())).sum();
        let difference = difference / expected.data().len() as f64 / mean(&expected);
        assert!(difference < 0.05, "{gradients:?}: {difference}");
    }
}

/// Light of a sky of one colour is kept too, whatever else a surface does than reflect evenly, and whether light is scattered before or not.
/// So a single sample shows little noise.
#[test]
fn an_even_sky_is_kept() {
    let size = [48, 48];
    let pictures = |bounces: u32, materials: &str, light_choice: LightChoice| {
        let text = format!(
            "PerspectiveCamera {{ center 0 1.5 5  direction 0 -0.3 -1  up 0 1 0  angle 40 }}
             Background {{ color 0.9 1 1.2 }} Lights {{ DirectionalLight {{ direction 1 -2 -1  irradiance 0.2 }} }}
             Materials {{ Matte ground {{ color 0.6 0.5 0.4 }}  {materials} }}
             Group {{ MaterialIndex ground Plane {{ normal 0 1 0  offset 0 }}
                      MaterialIndex a Sphere {{ center -1.2 0.6 0 radius 0.6 }}
                      MaterialIndex b Box {{ min 0 0.4 -1 max 1.5 0.6 1 }}
                      MaterialIndex c Sphere {{ center 0.2 0.2 1.4 radius 0.2 }} }}"
        );
        let scene = scene(&text);
        let path = PathSettings { bounces, free_mirrors: bounces, ..PathSettings::default() };
        let path = Path::new(&scene, path, size, LayerSet::of(&[Layer::Color]));
        let of = |gradients| {
            let settings =
                IrradianceSettings { bounces, light_choice, rays: 1024, accuracy: 0.03, ..with(gradients) };
            [1, 128].map(|samples| cached(&scene, settings, size, samples))
        };
        (
            [1, 512].map(|samples| picture(&path, size, samples)),
            ALL.map(|gradients| (gradients, of(gradients))),
        )
    };
    fn squares(a: &Image, b: &Image) -> impl Iterator<Item = f64> {
        std::iter::zip(a.data(), b.data()).map(|(a, b)| f64::from((a - b) * (a - b)))
    }
    // Without edges.
    let noise = |a: &Image, b: &Image| {
        let mut sorted: Vec<f64> = squares(a, b).collect();
        sorted.sort_unstable_by(f64::total_cmp);
        sorted[..sorted.len() * 3 / 4].iter().sum::<f64>()
    };
    let matt = "Matte a { color 0.7 0.2 0.2 }  Matte b { color 0.5 0.5 0.5 }  Matte c { color 0.5 0.5 0.5 }";
    let many = "Metal a { metal silver }  Glass c { }
                Material b { diffuseColor 0.3 0.4 0.3  specularColor 0.4 0.4 0.4  exponent 30 }";
    let lacquer = "Material a { diffuseColor 0.4 0.3 0.3  reflectiveColor 0.3 0.3 0.3 }  Matte b { color 0.5 0.5 0.5 }
                   Material c { diffuseColor 0.3 0.4 0.3  transparentColor 0.4 0.4 0.4  indexOfRefraction 1.3 }";
    // Rays of scattering meet the emitter, and have to be followed for it.
    let emitter = "Material a { diffuseColor 0.5 0.5 0.5  emission 1 0.8 0.6 }  Matte b { color 0.5 0.5 0.5 }
                   Metal c { metal silver }";
    for (bounces, materials) in
        [(0, matt), (0, many), (20, matt), (20, many), (4, lacquer), (0, emitter), (20, emitter)]
    {
        let ([noisy, expected], by_gradients) = pictures(bounces, materials, LightChoice::Tree);
        for (gradients, [single, found]) in by_gradients {
            let case = format!("{bounces} bounces, {gradients:?}");
            let error = (mean(&found) / mean(&expected) - 1.0).abs();
            assert!(error < 0.005, "{case}: {} instead of {}", mean(&found), mean(&expected));
            let rms = (squares(&found, &expected).sum::<f64>() / expected.data().len() as f64).sqrt()
                / mean(&expected);
            assert!(rms < 0.025, "{case}: {rms}");
            let ratio = noise(&single, &found) / noise(&noisy, &expected);
            assert!([emitter, lacquer].contains(&materials) || ratio < 0.03, "{case}: {ratio}");
        }
    }
    // Skies that are drawn are no part of it.
    let (_, [(_, [_, drawn]), ..]) = pictures(20, many, LightChoice::Uniform);
    let ([_, expected], _) = pictures(20, many, LightChoice::Tree);
    assert!((mean(&drawn) / mean(&expected) - 1.0).abs() < 0.005);
}

/// Light of media is direct light, which is drawn and not part of what is kept: with a ball of gas in its middle the wall of a hollow
/// ball has the irradiance `e V / R^2` of the gas, and that over `1 - albedo` in all.
#[test]
fn light_of_media_counts_once() {
    let text = format!(
        "{} Media {{ Medium gas {{ emission 5 }} }} Materials {{ Interface hot {{ medium gas }}  Matte wall {{ color 0.6 0.6 0.6 }} }}
         Group {{ MaterialIndex wall Sphere {{ center 0 0 0  radius 1 }}  MaterialIndex hot Sphere {{ center 0 0 0  radius 0.3 }} }}",
        camera([0.5, 0.0, 0.0], [1.0, 0.2, 0.1], 60.0)
    );
    let scene = scene(&text);
    let found = mean(&cached(&scene, with(Gradients::Occlusion), [16, 16], 16));
    let expected = 0.6 / PI * 5.0 * (4.0 / 3.0 * PI * 0.3f64.powi(3)) / (1.0 - 0.6);
    assert!((found / expected - 1.0).abs() < 0.01, "{found} {expected}");
}

/// A floor beside a bright wall whose light it gets, with much fewer records the less accurate they are.
#[test]
fn the_error_falls_with_the_accuracy() {
    let text = format!(
        "{} Lights {{ PointLight {{ position 0 1 1  intensity 4 4 4 }} }}
         Materials {{ Matte wall {{ color 0.7 0.7 0.7 }} }}
         Group {{ MaterialIndex wall Box {{ min -2 -2 -2 max 2 2 2 }}
                  MaterialIndex wall Box {{ min -0.8 -2 -0.8 max 0.2 -0.5 0.2 }} }}",
        camera([1.0, 0.5, 1.9], [-0.2, -1.4, -0.2], 60.0)
    );
    let scene = scene(&text);
    let size = [40, 30];
    let fine = IrradianceSettings { accuracy: 1e-4, bounces: 4, rays: 4096, ..with(Gradients::Occlusion) };
    let exact = cached(&scene, fine, size, 16);
    let mut last = (0.0, usize::MAX);
    for accuracy in [0.002, 0.03, 1.0] {
        let settings = IrradianceSettings { accuracy, ..fine };
        let found = cached(&scene, settings, size, 16);
        let squares = std::iter::zip(found.data(), exact.data()).map(|(a, b)| f64::from((a - b) * (a - b)));
        let error = (squares.sum::<f64>() / exact.data().len() as f64).sqrt() / mean(&exact);
        let n = records(&scene, settings, size, 0).records.records().len();
        assert!(error > last.0 && n < last.1, "{accuracy}: {error} by {n} records after {last:?}");
        last = (error, n);
    }
    assert!(last.0 < 0.05, "{last:?}");
}

#[test]
fn threads_tiles_and_stops_make_the_same_picture() {
    let text = format!(
        "{} Lights {{ PointLight {{ position 0 1.5 0  intensity 4 4 4 }} }}
         Materials {{ Matte wall {{ color 0.6 0.5 0.4 }}  Glass glass {{ }} }}
         Group {{ MaterialIndex wall Box {{ min -2 -2 -2 max 2 2 2 }}
                  MaterialIndex glass Sphere {{ center 0.5 -0.5 0 radius 0.8 }} }}",
        camera([0.0, 0.0, 1.9], [0.0, -1.0, 0.0], 70.0)
    );
    let scene = scene(&text);
    let size = [20, 16];
    let settings = IrradianceSettings { rays: 64, ..with(Gradients::Occlusion) };
    let integrator = IrradianceCaching::new(&scene, settings, size, LayerSet::of(&[Layer::Color]));
    assert_same_picture(&integrator, size, &schedule(4), [40, 60]);
}

/// Points are drawn where records are, and what is between them is the irradiance.
#[test]
fn records_can_be_seen() {
    let scene = lit_ball(60.0);
    let settings = IrradianceSettings { shows_records: true, ..with(Gradients::Occlusion) };
    let shown = cached(&scene, settings, [48, 48], 4);
    let (mut points, mut light) = (0, 0);
    for pixel in shown.data().chunks(3) {
        points += usize::from(pixel[0] > 1.1 * pixel[1]);
        light += usize::from((f64::from(pixel[1]) * PI - 1.0).abs() < 0.1);
    }
    assert!(points > 10 && light > 1500, "{points} points, {light} pixels of even light");
}

/// In white light, dots alone have a colour in the picture of the records: the layer says how much of a pixel they take, seen in a mirror
/// too.
#[test]
fn the_layer_of_records_shows_their_dots() {
    let size = [32, 32];
    let scene = scene(&format!(
        "{} Lights {{ PointLight {{ position 0.5 0.5 0  intensity 1 1 1 }} }}
         Materials {{ Matte wall {{ color 0.5 0.5 0.5 }}  Metal mirror {{ color 1 1 1 }} }}
         Group {{ MaterialIndex wall Box {{ min -2 -2 -2 max 2 2 2 }}
                  MaterialIndex mirror Quad {{ corner -1.9 -1.5 -1.9  edge1 1.5 0 0  edge2 0 3 0 }} }}",
        camera([0.0, 0.0, 1.9], [0.0, -0.3, 0.0], 70.0)
    ));
    let layers = LayerSet::of(&[Layer::Color, Layer::CacheRecords]);
    let of = |shows_records: bool| {
        let settings = IrradianceSettings { shows_records, rays: 64, ..with(Gradients::Occlusion) };
        let integrator = IrradianceCaching::new(&scene, settings, size, layers);
        let film = Film::new(FilmSpec { layers, ..FilmSpec::new(size[0], size[1]) }, u64::MAX).unwrap();
        render(&integrator, &film, &schedule(16), &Silent).unwrap();
        [Layer::Color, Layer::CacheRecords].map(|layer| film.develop(layer).unwrap())
    };
    let ([_, shares], [shown, _]) = (of(false), of(true));
    let mut dotted = [0, 0];
    for (y, x) in (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (y, x))) {
        let (share, [r, g, _]) = (shares.pixel(x, y)[0], [0, 1, 2].map(|i| shown.pixel(x, y)[i]));
        assert!((r - g - share).abs() < 1e-3, "{x} {y}: {share} of {r} {g}");
        dotted[usize::from(share > 0.1)] += 1;
    }
    assert!(dotted[0] > 400 && dotted[1] > 20, "{dotted:?}");
}

#[test]
fn what_cannot_be_is_said() {
    let view = camera([0.0, 0.0, 3.0], [0.0, 0.0, 0.0], 30.0);
    let scene = |material: &str| {
        scene(&format!(
            "{view} Lights {{ PointLight {{ position 0 3 3  intensity 1 1 1 }} }}
             Materials {{ {material} }} Group {{ MaterialIndex m Sphere {{ center 0 0 0 radius 1 }} }}"
        ))
    };
    let made = |scene: &Scene, memory| {
        let settings = IrradianceSettings { rays: 16, ..with(Gradients::Occlusion) };
        let integrator = IrradianceCaching::new(scene, settings, [8, 8], LayerSet::of(&[]));
        let made = PixelIntegrator::with_state(&integrator, 0, &Setup { memory, ..setup(0) });
        made.map(|made| made.notes.join(" "))
    };
    let mirror = made(&scene("Metal m { metal silver }"), u64::MAX).unwrap();
    assert!(mirror.contains("no surface that is seen") && mirror.contains("`integrator path`"), "{mirror}");
    let matt = made(&scene("Matte m { color 0.5 0.5 0.5 }"), u64::MAX).unwrap();
    assert_eq!(matt, "");
    let refused = made(&scene("Matte m { color 0.5 0.5 0.5 }"), 100).unwrap_err().to_string();
    assert!(refused.contains("0 MB") && refused.contains("larger `accuracy`"), "{refused}");
}

/// A picture through another camera that starts from the records of one before takes few rays more, whatever the threads, and is as right;
/// one of other settings starts afresh.
#[test]
fn a_moved_camera_starts_from_the_records_before() {
    let view = |from: [f32; 3]| {
        let text = format!(
            "{} Lights {{ PointLight {{ position 0 1.5 0  intensity 4 4 4 }} }}
             Materials {{ Matte wall {{ color 0.6 0.5 0.4 }} }}
             Group {{ MaterialIndex wall Box {{ min -2 -2 -2 max 2 2 2 }}
                      MaterialIndex wall Sphere {{ center 0.5 -0.5 0 radius 0.8 }} }}",
            camera(from, [0.0, -0.5, 0.0], 60.0)
        );
        scene(&text)
    };
    let count = |kept: &KeptState| {
        let records: KeptRecords = kept.take().expect("there are records");
        let count = records.records.len();
        kept.put(records);
        count
    };
    let (first, second) = (view([0.0, 0.0, 1.9]), view([0.4, 0.3, 1.6]));
    let size = [32, 32];
    for gradients in ALL {
        let settings = IrradianceSettings { rays: 256, bounces: 4, ..with(gradients) };
        let made = |scene: &Scene, settings, threads, kept: Option<&KeptState>| {
            let layers = LayerSet::of(&[Layer::Color]);
            let mut integrator = IrradianceCaching::new(scene, settings, size, layers);
            if let Some(kept) = kept {
                PixelIntegrator::keep_state(&mut integrator, kept);
            }
            let setup = Setup { threads, ..setup(5) };
            let rays = PixelIntegrator::with_state(&integrator, 0, &setup).unwrap().rays.total();
            (rays, picture(&integrator, size, 16))
        };
        let (fresh, alone) = made(&second, settings, 1, None);
        let from_the_first = |threads: usize| {
            let kept = KeptState::default();
            let (rays, _) = made(&first, settings, threads, Some(&kept));
            let before = count(&kept);
            assert!(before > 10 && rays > 256 * before as u64, "{before} records, {rays} rays");
            let (rays, picture) = made(&second, settings, threads, Some(&kept));
            assert!(count(&kept) >= before);
            (rays, picture, kept)
        };
        let (rays, with_kept, kept) = from_the_first(1);
        assert!(2 * rays < fresh, "{gradients:?}: {rays} of {fresh} rays");
        assert_eq!(with_kept.data(), from_the_first(3).1.data());
        let [a, b] = [mean(&with_kept), mean(&alone)];
        assert!((a / b - 1.0).abs() < 0.01, "{gradients:?}: {a} and {b}");
        // Without gradients a picture differs as much from one of other records.
        let allowed = if gradients == Gradients::Off { 0.08 } else { 0.03 };
        let differences = with_kept.data().iter().zip(alone.data()).map(|(a, b)| f64::from((a - b).abs()));
        let off = differences.sum::<f64>() / alone.data().len() as f64 / b;
        assert!(off < allowed, "{gradients:?}: {off}");
        // Other records are wanted now.
        let finer = IrradianceSettings { accuracy: 0.05, ..settings };
        let (rays, _) = made(&second, finer, 1, Some(&kept));
        assert_eq!(rays, made(&second, finer, 1, None).0);
    }
}
