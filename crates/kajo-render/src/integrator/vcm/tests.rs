//! Connection and merging against the bidirectional integrator, closed forms and paths.

use std::f64::consts::PI;

use kajo_core::sampler::{Sampler, SamplerKind};
use kajo_scene::MemoryAssets;
use kajo_testkit::{Estimate, every};

use super::*;
use crate::integrator::same_picture::assert_same_picture;
use crate::integrator::tests::{passing_smoke, scene_with};
use crate::integrator::{Path, PathSettings, PhotonMapping, PhotonSettings};
use crate::{Film, FilmSpec, Layer, RenderSettings, Silent, render};

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

fn setup(seed: u64) -> Setup<'static> {
    Setup { seed, threads: 1, memory: u64::MAX, progress: &Silent }
}

fn prepared(scene: &Scene, settings: VertexMergingSettings) -> Box<dyn PixelIntegrator + '_> {
    integrator_of(&scene.output.camera, scene, settings, [1, 1], LayerSet::of(&[]))
}

/// The mean of a picture of one pixel, splats included, by passes of its own for each batch.
fn mean_of(integrator: &dyn PixelIntegrator, samples: u32) -> Estimate {
    let sampler = Sampler::new(SamplerKind::Sobol, samples);
    Estimate::of_batches(|batch| {
        let seed = u64::from(batch);
        let mut ctx = SampleContext::new(&sampler, seed);
        let mut sum = 0.0;
        for i in 0..samples {
            let state = integrator.samples_per_state().map(|_| {
                integrator.with_state(i, &setup(seed)).unwrap_or_else(|error| panic!("{error}")).integrator
            });
            let integrator = state.as_deref().unwrap_or(integrator);
            let place = ctx.begin([0, 0], i);
            sum += f64::from(integrator.sample(&mut ctx, [0, 0], place).radiance[0]);
        }
        let inside = |raster: Vec2| raster.min_element() >= 0.0 && raster.max_element() < 1.0;
        let splats = ctx.splats.as_slice().iter().filter(|splat| inside(splat.raster));
        (sum + splats.map(|splat| f64::from(splat.value[0])).sum::<f64>()) / f64::from(samples)
    })
}

fn with(photons: u32) -> VertexMergingSettings {
    VertexMergingSettings { photons, bounces: 100, ..VertexMergingSettings::default() }
}

#[track_caller]
fn check(scene: &Scene, settings: VertexMergingSettings, samples: u32, expected: f64, bias: f64) {
    let found = mean_of(&*prepared(scene, settings), samples);
    let error = (found.mean - expected).abs();
    assert!(
        error <= 4.0 * found.standard_error + bias * expected && found.standard_error < 0.03 * expected,
        "{settings:?}: {found:?} instead of {expected}"
    );
}

#[test]
fn an_emissive_room_is_as_bright_as_its_series() {
    let text = format!(
        "{} Materials {{ Material m {{ diffuseColor 0.5 0.5 0.5  emission 1 1 1 }} }}
         Group {{ MaterialIndex m Sphere {{ center 0 0 0 radius 1 }} }}",
        camera([0.2, 0.1, -0.1], [0.7, -0.3, 0.5], 70.0)
    );
    check(&scene(&text), with(1000), 64, 2.0, 2e-3);
    check(&scene(&text), VertexMergingSettings { bounces: 1, ..with(1000) }, 64, 1.75, 2e-3);
}

#[test]
fn a_point_light_in_a_white_ball_lights_it_evenly() {
    let text = format!(
        "{} Lights {{ PointLight {{ position 0.5 0 0  intensity 1 1 1 }} }}
         Materials {{ Material m {{ diffuseColor 0.8 0.8 0.8 }} }}
         Group {{ MaterialIndex m Sphere {{ center 0 0 0 radius 1 }} }}",
        camera([0.0, 0.6, 0.0], [-1.0, 0.0, 0.0], 0.01)
    );
    let settings = VertexMergingSettings { radius: 0.017, ..with(1000) };
    check(&scene(&text), settings, 64, 0.8 / PI * (1.0 / 2.25 + 4.0), 4e-3);
}

/// Matt walls, an emitter, a mirror and glass: what paths find that meet the emitter. With wavelengths, and where glass disperses them.
#[test]
fn merging_and_paths_agree_where_paths_find_all() {
    // Wavelengths are those of passes, which are few.
    for (glass, spectral, noise) in [("", false, 0.03), ("abbeNumber 20", true, 0.05)] {
        let text = format!(
            "{} Materials {{ Matte wall {{ color 0.6 0.5 0.4 }}  Matte emitter {{ color 0 0 0 emission 5 5 5 emits front }}
                             Metal mirror {{ metal silver }}  Glass glass {{ {glass} }}
                             Metal brushed {{ metal gold roughness 0.3 }} }}
             Group {{ MaterialIndex wall Box {{ min -2 -2 -2 max 2 2 2 }}
                      MaterialIndex emitter Quad {{ corner -1 1.9 -1 edge1 2 0 0 edge2 0 0 2 }}
                      MaterialIndex mirror Sphere {{ center -1 -1 -1 radius 0.8 }}
                      MaterialIndex glass Sphere {{ center 1 -1 -0.5 radius 0.8 }}
                      MaterialIndex brushed Sphere {{ center 0 -1.5 0.6 radius 0.4 }} }}",
            camera([0.0, 0.0, 1.9], [0.0, -1.0, 0.0], 70.0)
        );
        let scene = scene(&text);
        let path = PathSettings { bounces: 6, spectral, ..PathSettings::default() };
        let expected = mean_of(&Path::new(&scene, path, [1, 1], LayerSet::of(&[])), 4096);
        let settings = VertexMergingSettings { bounces: 6, spectral, ..with(500) };
        let found = mean_of(&*prepared(&scene, settings), 128);
        let sigma = found.standard_error.hypot(expected.standard_error) / expected.mean;
        let error = (found.mean / expected.mean - 1.0).abs();
        assert!(error < 4.0 * sigma + 0.01 && sigma < noise, "{found:?} instead of {expected:?}");
    }
}

/// A beam from above into smoke in clear glass, seen from the side: no connection finds it. Even, of all colours, of varying
/// density, and two media in one place.
#[test]
fn merging_alone_finds_a_beam_behind_glass() {
    let media = [
        "Medium m { sigma_s 1 }",
        "Medium m { sigma_s 0.8 0.1 3  sigma_a 0.2 0.1 0 }",
        "FunctionMedium m { function = 1 + 0 * x  sigma_s 0.8 2 0.3  sigma_a 0.2 }",
        "Medium m { sigma_s 0.5 1 0.2 }  Medium n { sigma_s 0.3 0.2 1  sigma_a 0.2 }",
    ];
    for media in every(2, media) {
        let (y, albedo) = (0.4, if media.contains("0.2") { 0.8 } else { 1.0 });
        let text = format!(
            "{} Media {{ {media} }} Materials {{ Glass glass {{ indexOfRefraction 1.0001 medium m }} Interface more {{ medium {} }} }}
             Lights {{ DirectionalLight {{ direction 0 -1 0  irradiance 1 }} }}
             Group {{ MaterialIndex glass Box {{ min -1 -1 -1 max 1 1 1 }} {} }}",
            camera([0.0, y, 5.0], [0.0, y, 0.0], 0.01),
            if media.contains(" n ") { "n" } else { "m" },
            if media.contains(" n ") { "MaterialIndex more Box { min -0.999 -0.999 -0.999 max 0.999 0.999 0.999 }" } else { "" },
        );
        let expected = albedo * (-(1.0 - f64::from(y))).exp() * (1.0 - (-2.0f64).exp()) / (4.0 * PI);
        // The even one is held more closely than the others.
        let photons = if media == "Medium m { sigma_s 1 }" { 8000 } else { 2000 };
        let settings = VertexMergingSettings { bounces: 2, radius: 0.075, alpha: 1.0, ..with(photons) };
        // A part of each ball at a boundary lies outside the smoke.
        check(&scene(&text), settings, 64, expected * 0.985, 0.015);
    }
}

/// Light of smoke that passes by is that of its moment.
#[test]
fn smoke_is_lit_while_it_passes() {
    let (scenes, expected) = passing_smoke();
    // The box of the second one is large beside its smoke.
    for (scene, photons) in every(2, scenes.iter().zip([4000, 16_000])) {
        let settings = VertexMergingSettings { bounces: 2, radius: 0.2, alpha: 1.0, ..with(photons) };
        check(scene, settings, 64, expected * 0.92, 0.06);
    }
}

/// Smoke without absorption, in glass and without, is not seen under a sky that is the same everywhere.
#[test]
fn smoke_of_albedo_1_is_not_seen_under_a_uniform_sky() {
    let cases = [
        ("Medium m { sigma_s 1 2 3 }", "Glass i { indexOfRefraction 1.4  medium m }"),
        (
            "GridMedium m { size 2 2 2 values 1 0.2 0 0.7 0.4 1 0.6 0.1 min -1 -1 -1 max 1 1 1  sigma_s 1 4 8 }",
            "Glass i { indexOfRefraction 1.2  medium m }",
        ),
        ("Medium m { sigma_s 0.5 2 6 g 0.7 }", "Interface i { medium m }"),
    ];
    for (medium, material) in every(2, cases) {
        let text = format!(
            "{} Media {{ {medium} }} Materials {{ {material} }} Group {{ MaterialIndex i Box {{ min -1 -1 -1 max 1 1 1 }} }}",
            camera([0.3, 0.2, 4.0], [0.0, -0.2, -0.1], 20.0).replace("color 0 0 0", "color 1 1 1")
        );
        let settings = VertexMergingSettings { bounces: 1000, radius: 0.05, ..with(1000) };
        check(&scene(&text), settings, 64, 1.0, 4e-3);
    }
}

/// Light of a point that a ball of glass bends in murky water behind glass: connections find a part of it, photons all.
#[test]
fn murky_water_behind_glass_is_as_bright_as_photons_find_it() {
    let text = format!(
        "{} Media {{ Medium murk {{ sigma_s 0.4 0.3 0.2  sigma_a 0.1 }} }} Lights {{ PointLight {{ position 0 0.9 0  intensity 1 2 3 }} }}
         Materials {{ Glass water {{ indexOfRefraction 1.3 medium murk }} Glass ball {{ indexOfRefraction 1.6 priority 2 }} }}
         Group {{ MaterialIndex water Box {{ min -0.5 -0.5 -0.5 max 0.5 0.5 0.5 }}
                  MaterialIndex ball Sphere {{ center 0 0.3 0 radius 0.2 }} }}",
        camera([0.0, 0.2, 2.8], [0.0, 0.0, 0.0], 10.0)
    );
    let scene = scene(&text);
    let sppm = PhotonSettings { bounces: 5, photons: 2000, usage: None, ..PhotonSettings::default() };
    let expected = mean_of(&PhotonMapping::new(&scene, sppm, [1, 1], LayerSet::of(&[])), 128);
    let settings = VertexMergingSettings { bounces: 5, radius: 0.07, ..with(3000) };
    let found = mean_of(&*prepared(&scene, settings), 128);
    let both = mean_of(&*prepared(&scene, VertexMergingSettings { merging: false, ..settings }), 64);
    let sigma = found.standard_error.hypot(expected.standard_error) / expected.mean;
    let error = (found.mean / expected.mean - 1.0).abs();
    assert!(error < 4.0 * sigma && sigma < 0.06, "{found:?} instead of {expected:?}");
    assert!(both.mean < 0.3 * expected.mean, "{both:?}");
}

/// Scenes in which every kind of end is met: a moving ball, a lens, a sky, glass that disperses, and media.
fn scenes() -> [(String, bool); 5] {
    let things = "MaterialIndex wall Quad { corner -2 -1 -2 edge1 0 0 4 edge2 4 0 0 }
        MaterialIndex glass Sphere { center 0.7 -0.4 0 radius 0.6 }
        MaterialIndex emitter Quad { corner -1 1.9 -1 edge1 1 0 0 edge2 0 0 1 }
        MaterialIndex mirror Quad { corner -2 -1 -1.5 edge1 4 0 0 edge2 0 2 -0.2 }";
    let materials = "Matte wall { color 0.6 0.5 0.4 }  Matte emitter { color 0 0 0 emission 5 5 5 }
        Metal mirror { metal silver }  Glass glass { abbeNumber 30 }";
    let text = |view: &str, more: &str, things: &str| {
        format!(
            "{} {more} Materials {{ {materials} Interface smoke {{ medium m }} }} Group {{ {things} }}",
            camera([0.0, 0.5, 2.9], [0.0, -0.7, 0.0], 50.0).replace("angle", &format!("{view} angle"))
        )
    };
    let media = "Media { Medium m { sigma_s 0.5  sigma_a 0.1 } }";
    let sky = format!(
        "{media} Lights {{ DirectionalLight {{ direction 0.3 -1 0.1  irradiance 1 1 1  angle 5 }} }}"
    );
    let moving = "MaterialIndex wall Transform { Motion { key 0 { } key 1 { Translate 0.4 0 0 } }
        Sphere { center -0.8 -0.5 0.3 radius 0.4 } }";
    let smoke = "MaterialIndex smoke Sphere { center -0.8 -0.3 0.3 radius 0.5 }";
    // Where nothing names a medium, there is none.
    let clear = |text: String| text.replace(media, "").replace("Interface smoke { medium m }", "");
    [
        (clear(text("", media, things)), true),
        (clear(text("aperture 0.1  focus 3", &sky, things)), false),
        (clear(text("shutter 0 1", media, &format!("{things} {moving}"))), false),
        (text("", media, &format!("{things} {smoke}")), true),
        (
            text("", media, &format!("{things} {smoke}")).replace("abbeNumber 30", "abbeNumber 30  medium m"),
            true,
        ),
    ]
}

#[test]
fn without_merging_it_is_the_bidirectional_integrator_to_the_bit() {
    for (text, spectral) in scenes() {
        let scene = scene(&text);
        let schedule = RenderSettings::new(Sampler::new(SamplerKind::Sobol, 8));
        let layers = LayerSet::of(&[Layer::Color, Layer::Albedo]);
        let bits = |integrator: &dyn PixelIntegrator| -> Vec<u32> {
            let film = Film::new(FilmSpec { layers, ..FilmSpec::new(24, 16) }, u64::MAX).expect("a film");
            render(integrator, &film, &schedule, &Silent).expect("a render");
            let picture = |layer| film.develop(layer).expect("a picture");
            [Layer::Color, Layer::Albedo]
                .into_iter()
                .flat_map(|layer| picture(layer).data().iter().map(|v| v.to_bits()).collect::<Vec<_>>())
                .collect()
        };
        let camera = &scene.output.camera;
        let both = BidirectionalSettings { spectral, bounces: 20, ..BidirectionalSettings::default() };
        let settings = VertexMergingSettings { merging: false, bounces: 20, spectral, ..with(1000) };
        let both = crate::integrator::Prepare::prepare(both, &scene, camera, [24, 16], layers);
        let found = bits(&*integrator_of(camera, &scene, settings, [24, 16], layers));
        assert!(found == bits(&*both) && found.iter().any(|&v| v != 0), "{text}");
        let merged = VertexMergingSettings { merging: true, ..settings };
        assert!(found != bits(&*integrator_of(camera, &scene, merged, [24, 16], layers)), "{text}");
    }
}

#[test]
fn threads_tiles_and_stops_make_the_same_picture() {
    for (text, spectral) in scenes() {
        let scene = scene(&text);
        let settings = VertexMergingSettings { spectral, ..with(9000) };
        let layers = LayerSet::of(&[Layer::Color]);
        let integrator = integrator_of(&scene.output.camera, &scene, settings, [20, 16], layers);
        let schedule = RenderSettings::new(Sampler::new(SamplerKind::Sobol, 4));
        assert_same_picture(&*integrator, [20, 16], &schedule, [9, 5]);
    }
}

#[test]
fn radii_shrink_as_they_should() {
    let scene = scene(&format!(
        "{} Materials {{ Matte m {{ }} }} Group {{ MaterialIndex m Sphere {{ center 0 0 0 radius 1 }} }}",
        camera([0.0, 0.0, 5.0], [0.0; 3], 30.0)
    ));
    let camera = &scene.output.camera;
    let radius = |alpha: f32, k: u32| {
        let settings = VertexMergingSettings { radius: 0.25, alpha, ..with(1000) };
        VertexMerging::<NoMedia>::made(camera, &scene, settings, [8, 8], LayerSet::of(&[])).pass(k, 0).radius
    };
    // i^(-1/8) and i^(-1/2).
    for (alpha, k, expected) in [(0.75, 0, 0.25), (0.75, 255, 0.125), (0.0, 99, 0.025), (1.0, 5000, 0.25)] {
        assert!((radius(alpha, k) - expected).abs() < 1e-5, "{alpha} {k}: {}", radius(alpha, k));
    }
}

/// Two pixels and a half at the ball, also as a mirror shows it.
#[test]
fn the_first_radius_follows_the_pixels() {
    let radius = |text: &str, side: u32| {
        let scene = scene(text);
        let settings = VertexMergingSettings { photons: 10_000_000, ..with(1) };
        let camera = &scene.output.camera;
        VertexMerging::<NoMedia>::made(camera, &scene, settings, [side; 2], LayerSet::of(&[])).first_radius
    };
    let wall = "Materials { Matte m { } Metal mirror { } } Group { MaterialIndex m Quad { corner -4 -4 -1 edge1 8 0 0 edge2 0 8 0 }";
    let ahead = format!("{} {wall} }}", camera([0.0, 0.0, 3.0], [0.0; 3], 20.0));
    let behind = format!(
        "{} {wall} MaterialIndex mirror Quad {{ corner -4 -4 5 edge1 8 0 0 edge2 0 8 0 }} }}",
        camera([0.0, 0.0, 3.0], [0.0, 0.0, 6.0], 20.0)
    );
    for (text, distance) in [(&ahead, 4.0), (&behind, 8.0)] {
        let expected = 2.5 * 2.0 * 10f32.to_radians().tan() * distance / 256.0;
        let found = radius(text, 256);
        assert!((found / expected - 1.0).abs() < 0.03, "{found} instead of {expected}");
        assert!((radius(text, 512) / found - 0.5).abs() < 0.02);
    }
}

/// Where the scene is large beside what is seen of it, disks that hold a vertex are wider than the picture.
#[test]
fn a_small_thing_in_a_large_scene_is_as_bright_as_it_is() {
    let text = format!(
        "{} Lights {{ PointLight {{ position 0 3 0  intensity 9 }} }} Materials {{ Matte m {{ color 0.5 0.5 0.5 }} }}
         Group {{ MaterialIndex m Disk {{ center 0 0 0 normal 0 1 0 radius 0.01 }}
                  Sphere {{ center 100 -100 100 radius 1 }}  Sphere {{ center -100 -100 -100 radius 1 }} }}",
        camera([0.0, 0.03, 0.02], [0.0; 3], 4.0)
    );
    check(&scene(&text), with(1000), 64, 0.5 / PI, 4e-3);
}

#[test]
fn what_cannot_be_is_said() {
    let view = camera([0.0, 0.0, 3.0], [0.0; 3], 30.0);
    let light = "Lights { PointLight { position 0 3 3  intensity 1 1 1 } }";
    let ball = |material: &str| {
        format!(
            "Materials {{ {material} m {{ }} }} Group {{ MaterialIndex m Sphere {{ center 0 0 0 radius 1 }} }}"
        )
    };
    let made = |text: String, memory| {
        let scene = scene(&text);
        let integrator = integrator_of(&scene.output.camera, &scene, with(5000), [4, 4], LayerSet::of(&[]));
        integrator.with_state(0, &Setup { memory, ..setup(0) }).map(|made| made.notes.join(" "))
    };
    assert!(made(format!("{view} {}", ball("Matte")), u64::MAX).unwrap().contains("no light"));
    assert!(
        made(format!("{view} {light} {}", ball("Glass")), u64::MAX).unwrap().contains("mirrors or clear")
    );
    assert_eq!(made(format!("{view} {light} {}", ball("Matte")), u64::MAX), Ok(String::new()));
    let refused = made(format!("{view} {light} {}", ball("Matte")), 1000).unwrap_err().to_string();
    assert!(refused.contains("5000 paths") && refused.contains("`photons`"), "{refused}");
}

#[test]
fn a_vertex_takes_little_memory() {
    assert_eq!(size_of::<crate::integrator::bidir::LightVertex>(), 36);
}
