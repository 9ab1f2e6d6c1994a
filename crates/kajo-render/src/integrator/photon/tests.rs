//! Photon maps against closed forms and against paths.

use std::f64::consts::PI;

use kajo_core::sampler::{Sampler, SamplerKind};
use kajo_scene::MemoryAssets;
use kajo_testkit::{Estimate, every};

use super::*;
use crate::integrator::Prepare;
use crate::integrator::camera_view::GOLDEN;
use crate::integrator::same_picture::assert_same_picture;
use crate::integrator::tests::{passing_smoke, scene_with};
use crate::{Layer, PixelIntegrator, RenderSettings, Silent};

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

const USES: [Option<PhotonMapUse>; 4] =
    [Some(PhotonMapUse::Gather), Some(PhotonMapUse::Direct), Some(PhotonMapUse::Caustics), None];

/// * `photons`: of one map for all samples; one for each of them has a sixteenth
fn with(usage: Option<PhotonMapUse>, photons: u32) -> PhotonSettings {
    let photons = if usage.is_some() { photons } else { photons / 16 };
    PhotonSettings { usage, photons, bounces: 100, ..PhotonSettings::default() }
}

fn setup(seed: u64) -> Setup<'static> {
    Setup { seed, threads: 1, memory: u64::MAX, progress: &Silent }
}

/// The mean of a picture of one pixel, by maps of their own for each batch.
fn mean_of(integrator: &dyn PixelIntegrator, samples: u32) -> Estimate {
    let sampler = Sampler::new(SamplerKind::Sobol, samples);
    Estimate::of_batches(|batch| {
        let seed = u64::from(batch);
        let mut ctx = SampleContext::new(&sampler, seed);
        let mut sum = 0.0;
        let mut state: Option<(u32, WithState<'_>)> = None;
        for i in 0..samples {
            let part = integrator.samples_per_state().map(|samples| samples.part_of(i));
            if let Some(k) = part.filter(|&k| state.as_ref().is_none_or(|&(of, _)| of != k)) {
                let made = integrator.with_state(k, &setup(seed));
                state = Some((k, made.unwrap_or_else(|error| panic!("{error}"))));
            }
            let integrator = state.as_ref().map_or(integrator, |(_, made)| &*made.integrator);
            let place = ctx.begin([0, 0], i);
            sum += f64::from(integrator.sample(&mut ctx, [0, 0], place).radiance[0]);
        }
        sum / f64::from(samples)
    })
}

/// Each photon is a dot of two pixels across, in the colour of its light, seen in a mirror too and in a medium.
#[test]
fn photons_are_shown_as_dots() {
    const SIZE: [u32; 2] = [96, 96];
    let emitter =
        "Matte emitter { color 0 0 0  emission 4 1 1 } Matte floor { color 0.5 0.5 0.5 } Metal mirror { }
        Interface air { medium fog }";
    let room = "MaterialIndex emitter Quad { corner -1 3 9  edge1 2 0 0  edge2 0 0 2 }
        MaterialIndex floor Quad { corner -4 0 14  edge1 8 0 0  edge2 0 0 -8 }";
    let head = "Media { Medium fog { density 0.5 } }";
    let straight = camera([0.0, 2.8, 10.0], [0.0, 0.0, 10.0], 70.0);
    // The floor as a mirror above it shows it.
    let mirrored = camera([2.0, 2.0, 10.0], [0.0, 6.0, 10.0], 40.0);
    let mirror = "MaterialIndex mirror Quad { corner -4 6 6  edge1 8 0 0  edge2 0 0 8 }";
    let fog = "MaterialIndex air Box { min -3.9 0.1 6.1  max 3.9 2.9 13.9 }";
    for (camera, more) in [(&straight, ""), (&mirrored, mirror), (&straight, fog)] {
        let scene = scene(&format!("{head} {camera} Materials {{ {emitter} }} Group {{ {room} {more} }}"));
        let dots = |photons: u32| {
            let settings = PhotonSettings { photons, ..with(Some(PhotonMapUse::Dots), 0) };
            let integrator = PhotonMapping::new(&scene, settings, SIZE, LayerSet::of(&[]));
            let state = PixelIntegrator::with_state(&integrator, 0, &setup(3)).unwrap();
            let sampler = Sampler::new(SamplerKind::Regular, 1);
            let mut ctx = SampleContext::new(&sampler, 0);
            let mut pixels = 0;
            for (x, y) in (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| (x, y))) {
                let place = Vec2::new(x as f32, y as f32) + ctx.begin([x, y], 0);
                let [red, green, _] = state.integrator.sample(&mut ctx, [x, y], place).radiance;
                // The emitter itself is brighter.
                assert!(red < 0.11 || (green < 0.6 * red && red > 0.3), "{red} {green}");
                pixels += u32::from(red > 0.3 && red < 3.0);
            }
            f64::from(pixels)
        };
        let (few, many) = (dots(200), dots(800));
        assert!(few > 8.0 && many / few > 2.0 && many / few < 6.0, "{few} {many} of {more}");
    }
}

fn mean(scene: &Scene, settings: PhotonSettings, samples: u32) -> Estimate {
    mean_of(&PhotonMapping::new(scene, settings, [1, 1], LayerSet::of(&[])), samples)
}

#[track_caller]
fn check(scene: &Scene, settings: PhotonSettings, samples: u32, expected: f64, bias: f64) {
    let found = mean(scene, settings, samples);
    let error = (found.mean - expected).abs();
    // All samples of a narrow view look at the same few photons, where the map itself is shown.
    let noise = if settings.usage == Some(PhotonMapUse::Direct) { 0.08 } else { 0.03 };
    assert!(
        error <= 4.0 * found.standard_error + bias * expected && found.standard_error < noise * expected,
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
    for usage in USES {
        check(&scene(&text), with(usage, 8_000), 32, 2.0, 2e-3);
        // Direct light and one bounce more: 1 + 1/2 + 1/4.
        check(&scene(&text), PhotonSettings { bounces: 1, ..with(usage, 8_000) }, 32, 1.75, 2e-3);
    }
}

#[test]
fn a_point_light_in_a_white_ball_lights_it_evenly() {
    let text = format!(
        "{} Lights {{ PointLight {{ position 0.5 0 0  intensity 1 1 1 }} }}
         Materials {{ Material m {{ diffuseColor 0.8 0.8 0.8 }} }}
         Group {{ MaterialIndex m Sphere {{ center 0 0 0 radius 1 }} }}",
        camera([0.0, 0.6, 0.0], [-1.0, 0.0, 0.0], 0.01)
    );
    let expected = 0.8 / PI * (1.0 / 2.25 + 4.0);
    for usage in USES {
        check(&scene(&text), with(usage, 8_000), 32, expected, 4e-3);
    }
}

/// All power that lights send into a closed room of black walls is stored there.
#[test]
fn the_power_of_lights_is_kept() {
    let room =
        "Materials { Matte black { color 0 0 0 }  Matte emitter { color 0 0 0 emission 3 3 3 emits front } }
        Group { MaterialIndex black Box { min -2 -2 -2 max 2 2 2 }
                MaterialIndex emitter Quad { corner -0.5 1 -0.5 edge1 1 0 0 edge2 0 0 1 } }";
    let lights = "Lights { PointLight { position 0.3 0 0.2  intensity 1 1 1 } }";
    let expected = 4.0 * PI + 3.0 * PI;
    let scene = scene(&format!("{} {lights} {room}", camera([0.0, 0.0, 1.0], [0.0, 0.0, 0.0], 30.0)));
    let emission = PhotonEmission::new(&scene, 50_000, 3, true);
    let batch = emission
        .emit(
            0,
            &Wavelengths::RGB,
            PhotonRequest { map: Wanted::All, caustics: true, in_media: None, beams: None },
            &setup(3),
        )
        .unwrap();
    let power: f64 = batch.photons.iter().map(|photon| f64::from(photon.power()[0])).sum();
    assert!((power / expected - 1.0).abs() < 1e-3, "{power} instead of {expected}");
    assert!(batch.caustics.is_empty() && batch.rays.light == 50_000);
}

/// Matt walls, an emitter, a mirror and glass: what paths find that meet the emitter.
#[test]
fn maps_and_paths_agree_where_paths_find_all() {
    let text = format!(
        "{} Materials {{ Matte wall {{ color 0.6 0.5 0.4 }}  Matte emitter {{ color 0 0 0 emission 5 5 5 emits front }}
                         Metal mirror {{ metal silver }}  Glass glass {{ }}
                         Metal brushed {{ metal gold roughness 0.3 }} }}
         Group {{ MaterialIndex wall Box {{ min -2 -2 -2 max 2 2 2 }}
                  MaterialIndex emitter Quad {{ corner -1 1.9 -1 edge1 2 0 0 edge2 0 0 2 }}
                  MaterialIndex mirror Sphere {{ center -1 -1 -1 radius 0.8 }}
                  MaterialIndex glass Sphere {{ center 1 -1 -0.5 radius 0.8 }}
                  MaterialIndex brushed Sphere {{ center 0 -1.5 0.6 radius 0.4 }} }}",
        camera([0.0, 0.0, 1.9], [0.0, -1.0, 0.0], 70.0)
    );
    let scene = scene(&text);
    let path = PathSettings { bounces: 6, ..PathSettings::default() };
    let expected = mean_of(&Path::new(&scene, path, [1, 1], LayerSet::of(&[])), 8192);
    for usage in every(2, USES.into_iter().rev()) {
        let found = mean(&scene, PhotonSettings { bounces: 6, ..with(usage, 10_000) }, 384);
        let sigma = found.standard_error.hypot(expected.standard_error);
        // Disks reach beyond the edges of surfaces, most of all where the map itself is seen.
        let bias = if usage == Some(PhotonMapUse::Direct) { 0.04 } else { 0.012 };
        let error = (found.mean / expected.mean - 1.0).abs();
        assert!(error < 4.0 * sigma / expected.mean + bias, "{usage:?}: {found:?} instead of {expected:?}");
        assert!(sigma < 0.02 * expected.mean, "{usage:?} is too noisy: {found:?}");
    }
}

/// In light from the ceiling alone, highlights beside diffuse parts are left to paths, and what is a hole to a photon is seen by others: of coats a half was lost, of
/// surfaces that are holes in part as much of the indirect light.
#[test]
fn coats_and_holes_are_as_bright_as_by_paths() {
    let scene_of = |material: &str| {
        let text = format!(
            "{} Materials {{ Matte wall {{ color 0.7 0.6 0.5 }}  Matte emitter {{ color 0 0 0 emission 5 5 5 emits front }} {material} }}
             Group {{ MaterialIndex wall Box {{ min -2 -2 -2 max 2 2 2 }}
                      MaterialIndex emitter Quad {{ corner -0.9 1 -0.9 edge1 0 0 1.8 edge2 1.8 0 0 }}
                      MaterialIndex thing Sphere {{ center -0.6 -0.6 -0.2 radius 0.9 }}
                      MaterialIndex thing Box {{ min 0.5 -1.6 -0.9 max 1.7 0 0.3 }} }}",
            camera([0.0, -0.3, 1.9], [-0.5, -0.6, 0.0], 30.0)
        );
        scene(&text)
    };
    let materials = [
        "Principled thing { color 0.05 0.05 0.05  roughness 0.6  coat 1 }",
        "Matte thing { color 0.8 0.7 0.6  opacity 0.4 }",
        "PhongMaterial thing { diffuseColor 0.4 0.3 0.2  specularColor 0.4 0.4 0.4  exponent 60  reflectiveColor 0.1 0.1 0.1 }",
        "Principled thing { color 0.6 0.5 0.4  metalness 0.5  roughness 0.2 }",
    ];
    for material in materials {
        let scene = scene_of(material);
        let path = PathSettings { bounces: 6, ..PathSettings::default() };
        let expected = mean_of(&Path::new(&scene, path, [1, 1], LayerSet::of(&[])), 4096);
        for usage in every(2, [None, Some(PhotonMapUse::Caustics), Some(PhotonMapUse::Gather)]) {
            let found = mean(&scene, PhotonSettings { bounces: 6, ..with(usage, 10_000) }, 128);
            let sigma = found.standard_error.hypot(expected.standard_error) / expected.mean;
            let error = (found.mean / expected.mean - 1.0).abs();
            assert!(error < 4.0 * sigma + 0.012, "{material} {usage:?}: {found:?} instead of {expected:?}");
            assert!(sigma < 0.05, "{material} {usage:?} is too noisy: {found:?}");
        }
    }
}

#[test]
fn radii_shrink_as_they_should() {
    let world = BoundingSphere { center: Vec2::ZERO.extend(0.0), radius: 1.0 };
    let share = |n: u32| Radius::of_pass(n, 1000, &world).disk.share;
    // r_N / r_1 for the N-th pass, [Knaus and Zwicker 2011].
    for (n, expected) in [(99, 0.488_251), (999, 0.332_808), (9999, 0.226_751)] {
        assert!((share(n) - expected).abs() < 2e-3 * expected, "{n}: {}", share(n));
    }
    assert_eq!(share(0), 1.0);
    // As much is left of the volume of balls as of the area of disks.
    for n in [0, 9, 999] {
        let Radius { disk, ball } = Radius::of_pass(n, 1000, &world);
        assert!((ball.share.powi(3) - disk.share.powi(2)).abs() < 1e-6);
        assert!((ball.bounds[0] - 0.1).abs() < 1e-6);
    }
}

#[test]
fn threads_tiles_and_stops_make_the_same_picture() {
    let text = format!(
        "{} Lights {{ PointLight {{ position 0 1.5 0  intensity 4 4 4 }} }}
         Materials {{ Matte wall {{ color 0.6 0.5 0.4 }}  Glass glass {{ abbeNumber 30 }} }}
         Group {{ MaterialIndex wall Box {{ min -2 -2 -2 max 2 2 2 }}
                  MaterialIndex glass Sphere {{ center 0.5 -0.5 0 radius 0.8 }} }}",
        camera([0.0, 0.0, 1.9], [0.0, -1.0, 0.0], 70.0)
    );
    let fog = "Media { Medium air { sigma_s 0.3 0.2 0.1  sigma_a 0.05  g 0.3 }  exterior air } Materials";
    let motion = "Transform { Motion { key 0 { } key 1 { Translate -1 0 0 } } Sphere { center 0.5 -0.5 0 radius 0.8 } }";
    let moving = text.replacen("Sphere { center 0.5 -0.5 0 radius 0.8 }", motion, 1);
    let moving = moving.replacen("Camera {", "Camera { shutter 0 1", 1);
    let rolling = moving.replacen("shutter 0 1", "shutter 0 1 rollingShutter 0.5", 1);
    for text in every(2, [text.clone(), moving, text.replacen("Materials", fog, 1), rolling]) {
        let scene = scene(&text);
        for (usage, spectral) in [(None, true), (Some(PhotonMapUse::Gather), false)] {
            let settings =
                PhotonSettings { spectral, ..with(usage, 9000 * if usage.is_some() { 1 } else { 16 }) };
            let integrator = PhotonMapping::new(&scene, settings, [20, 16], LayerSet::of(&[Layer::Color]));
            let schedule = RenderSettings::new(Sampler::new(SamplerKind::Sobol, 4));
            assert_same_picture(&integrator, [20, 16], &schedule, [9, 5]);
        }
    }
}

#[test]
fn what_cannot_be_is_said() {
    let view = camera([0.0, 0.0, 3.0], [0.0, 0.0, 0.0], 30.0);
    let ball = "Materials { Matte m { } } Group { MaterialIndex m Sphere { center 0 0 0 radius 1 } }";
    let dark = scene(&format!("{view} {ball}"));
    let lit = scene(&format!("{view} Lights {{ PointLight {{ position 0 3 3  intensity 1 1 1 }} }} {ball}"));
    let sun = "Lights { DirectionalLight { direction 0 -1 0  color 1 1 1 } }";
    let plane = ball.replace("Sphere", "Plane { normal 0 1 0 offset -1 } Sphere");
    for (lights, things, is_left_out) in [(sun, &*plane, true), (sun, ball, false), ("", &*plane, false)] {
        let notes = with(None, 5000).left_out(&scene(&format!("{view} {lights} {things}")), [4, 4]).join(" ");
        assert_eq!(notes.contains("planes without end"), is_left_out, "{notes}");
    }
    let made = |scene: &Scene, usage, memory| {
        let integrator = PhotonMapping::new(scene, with(usage, 5000), [4, 4], LayerSet::of(&[]));
        let made = PixelIntegrator::with_state(&integrator, 0, &Setup { memory, ..setup(0) });
        made.map(|made| made.notes.join(" "))
    };
    assert!(made(&dark, None, u64::MAX).unwrap().contains("no light"));
    assert!(made(&lit, Some(PhotonMapUse::Caustics), u64::MAX).unwrap().contains("no caustics"));
    assert_eq!(made(&lit, Some(PhotonMapUse::Gather), u64::MAX), Ok(String::new()));
    let refused = made(&lit, Some(PhotonMapUse::Gather), 1000).unwrap_err().to_string();
    assert!(refused.contains("5000 paths") && refused.contains("`photons`"), "{refused}");
}

/// An emissive room in which the radiance is 2, filled with a medium `fog` that changes nothing of that.
///
/// * `number`: of the medium; each is looked at by other maps, where tests are not run in full
/// * `bias`: of photons in balls, as a share of the light
fn check_room_of((number, medium): (usize, &str), bias: f64) {
    let text = format!(
        "{} Media {{ {medium}  exterior fog }} Materials {{ Material m {{ diffuseColor 0.5 0.5 0.5  emission 1 1 1 }} }}
         Group {{ MaterialIndex m Sphere {{ center 0 0 0 radius 1 }} }}",
        camera([0.2, 0.1, -0.1], [0.7, -0.3, 0.5], 70.0)
    );
    for usage in every(3, USES.into_iter().cycle().skip(number).take(USES.len())) {
        check(&scene(&text), with(usage, 8_000), 64, 2.0, bias);
    }
}

/// Fog of albedo 1 changes no light that is the same everywhere, in one colour or all, even or in clouds.
#[test]
fn fog_without_absorption_leaves_an_emissive_room_as_bright_as_it_was() {
    let media = [
        "Medium fog { sigma_s 0.3 1 3  g 0.6 }",
        "Medium fog { sigma_s 0.3 1 3  phaseColors on phaseTable 0 5 3 0  90 0.3 0.5 1  180 0.5 0.9 2 }",
        "FunctionMedium fog { function = 1 + x * y  sigma_s 3 2 1 }",
    ];
    for medium in every(2, media.into_iter().enumerate()) {
        check_room_of(medium, 4e-3);
    }
}

/// Fog as hot as the walls of a room that all emit alike is not seen: what it absorbs it emits, and that is scattered
/// and comes back from the walls too.
#[test]
fn fog_as_hot_as_its_room_is_not_seen() {
    let media = [
        "Medium fog { sigma_s 1.5 0.5 1  sigma_a 0.7  emission 1.4 1.4 1.4  g 0.3 }",
        "FunctionMedium fog { function = 1 + x * y  sigma_s 1 1.5 0.5  sigma_a 0.7  emission 1.4 1.4 1.4 }",
    ];
    for medium in media.into_iter().enumerate() {
        check_room_of(medium, 6e-3);
    }
}

/// A small light in thin fog: points drawn along rays, collisions and photons together find what paths find, with little noise.
#[test]
fn a_small_light_in_fog_is_as_bright_as_paths_find_it() {
    let text = format!(
        "{} Media {{ Medium air {{ sigma_s 0.06 0.05 0.04  sigma_a 0.01  g 0.4 }}  exterior air }}
         Lights {{ PointLight {{ position 0.2 0.3 -0.5  intensity 4 4 4 }} }}
         Materials {{ Matte wall {{ color 0.3 0.3 0.3 }} }}
         Group {{ MaterialIndex wall Quad {{ corner -4 -2 4  edge1 8 0 0  edge2 0 0 -8 }} }}",
        camera([0.0, 0.0, 3.0], [0.0, 0.2, 0.0], 40.0)
    );
    let scene = scene(&text);
    let path = PathSettings { bounces: 20, ..PathSettings::default() };
    let expected = mean_of(&Path::new(&scene, path, [1, 1], LayerSet::of(&[])), 2048);
    let found = mean(&scene, PhotonSettings { bounces: 20, ..with(None, 8_000) }, 96);
    let sigma = found.standard_error.hypot(expected.standard_error) / expected.mean;
    let error = (found.mean / expected.mean - 1.0).abs();
    assert!(error < 4.0 * sigma + 3e-3 && sigma < 0.025, "{found:?} instead of {expected:?}");
}

/// Light from above in smoke in clear glass, seen from the side, by beams: what is scattered once is neither blurred nor noisy, in dense
/// smoke, in thin smoke, and in one that has another colour.
#[test]
fn beams_behind_glass_are_as_bright_as_single_scattering() {
    let media = [
        ("sigma_s 1", 1.0, 1.0),
        ("sigma_s 0.02 0.05 0", 0.02, 1.0),
        ("sigma_s 0.6 0 4  sigma_a 0.2", 0.8, 0.75),
    ];
    for (medium, sigma_t, albedo) in media {
        let y = 0.4;
        let text = format!(
            "{} Media {{ Medium m {{ {medium} }} }} Materials {{ Glass glass {{ indexOfRefraction 1.0001 medium m }} }}
             Lights {{ DirectionalLight {{ direction 0 -1 0  irradiance 1 }} }}
             Group {{ MaterialIndex glass Box {{ min -1 -1 -1 max 1 1 1 }} }}",
            camera([0.0, y, 5.0], [0.0, y, 0.0], 0.01),
        );
        let (deep, wide): (f64, f64) = (sigma_t * (1.0 - f64::from(y)), sigma_t * 2.0);
        let expected = albedo * (-deep).exp() * (1.0 - (-wide).exp()) / (4.0 * PI);
        let found = mean(&scene(&text), PhotonSettings { bounces: 2, ..with(None, 64_000) }, 8);
        let error = (found.mean / expected - 1.0).abs();
        assert!(
            error < 4.0 * found.standard_error / expected + 1e-3 && found.standard_error < 8e-3 * expected,
            "{medium}: {found:?} instead of {expected}"
        );
    }
}

/// By photons of another moment it would be lit three quarters of the time that it is there.
#[test]
fn smoke_is_lit_while_it_passes() {
    let (scenes, expected) = passing_smoke();
    for scene in every(2, &scenes) {
        // The balls of an eighth of the photons of a map are large.
        for (usage, photons, bias) in [(None, 32_000, 0.06), (Some(PhotonMapUse::Gather), 256_000, 0.14)] {
            let settings = PhotonSettings { bounces: 2, ..with(usage, photons) };
            check(scene, settings, 32, expected, bias);
        }
    }
}

/// Of 64 passes each cell of a grid of 4 by 4 has its share, within half of it: no wavelength is that of one moment.
#[test]
fn moments_and_wavelengths_of_passes_go_their_own_ways() {
    for seed in 0..50 {
        let mut cells = [0; 16];
        for k in 0..64 {
            let wavelength = number_of_pass(seed ^ WAVELENGTH_SALT, k, GOLDEN);
            let moment = number_of_pass(seed ^ MOMENT_SALT, k, MOMENT_STEP);
            cells[(4.0 * wavelength) as usize + 4 * (4.0 * moment) as usize] += 1;
        }
        assert!(cells.iter().all(|cell| (2..=6).contains(cell)), "{seed}: {cells:?}");
    }
}

/// A room in which a ball and a plate go farther than they are wide.
#[test]
fn what_moves_is_lit_by_photons_of_its_moment() {
    let room = |shutter: &str| {
        let things = "MaterialIndex wall Box { min -2 -2 -2 max 2 2 2 }
             MaterialIndex emitter Quad { corner -1 1.9 -1 edge1 2 0 0 edge2 0 0 2 }
             MaterialIndex wall Transform { Motion { key 0 { } key 1 { Translate 1.6 0 0 } } Sphere { center -0.8 -0.3 -0.2 radius 0.5 } }
             MaterialIndex wall Transform { Motion { key 0 { } key 1 { Translate 0 0.8 0 } } Quad { corner -1 -1.9 0.2 edge1 0 0 0.8 edge2 2 0 0 } }";
        let materials =
            "Matte wall { color 0.6 0.5 0.4 }  Matte emitter { color 0 0 0 emission 5 5 5 emits front }";
        let view = camera([0.0, 0.0, 1.9], [0.0, -0.6, 0.0], 40.0);
        let view = view.replacen("Camera {", &format!("Camera {{ {shutter}"), 1);
        scene(&format!("{view} Materials {{ {materials} }} Group {{ {things} }}"))
    };
    // Where rows are exposed one after the other photons of all parts of the time are needed at once.
    for (shutter, uses) in [("shutter 0 1", &USES[..]), ("shutter 0 1 rollingShutter 0.6", &[None])] {
        let scene = room(shutter);
        let path = PathSettings { bounces: 6, ..PathSettings::default() };
        let expected = mean_of(&Path::new(&scene, path, [1, 1], LayerSet::of(&[])), 2048);
        for &usage in every(2, uses.iter().rev()) {
            let photons = if usage.is_some() { 100_000 } else { 40_000 };
            let found = mean(&scene, PhotonSettings { bounces: 6, ..with(usage, photons) }, 128);
            let sigma = found.standard_error.hypot(expected.standard_error) / expected.mean;
            let bias = if usage == Some(PhotonMapUse::Direct) { 0.04 } else { 0.012 };
            let error = (found.mean / expected.mean - 1.0).abs();
            assert!(error < 4.0 * sigma + bias, "{usage:?}: {found:?} instead of {expected:?}");
            assert!(sigma < 0.02, "{usage:?} is too noisy: {found:?}");
        }
    }
}

/// Light that goes the way that all rays of an orthographic camera go: no beam passes a ray, and photons bring it.
#[test]
fn light_along_the_rays_of_the_camera_is_not_lost() {
    for camera in ["direction 0 -1 0", "direction 0.02 -1 0"] {
        let text = format!(
            "OrthographicCamera {{ center 0 3 0  {camera}  up 0 0 -1  size 1 }} Background {{ color 0 0 0 }}
             Media {{ Medium m {{ sigma_s 1 }} }} Materials {{ Glass glass {{ indexOfRefraction 1.0001 medium m }} }}
             Lights {{ DirectionalLight {{ direction 0 -1 0  irradiance 1 }} }}
             Group {{ MaterialIndex glass Box {{ min -1 -1 -1 max 1 1 1 }} }}"
        );
        // Down to a depth of 2 and back.
        let expected = (1.0 - (-4.0f64).exp()) / 2.0 / (4.0 * PI);
        let found = mean(&scene(&text), PhotonSettings { bounces: 2, ..with(None, 8_000) }, 64);
        let error = (found.mean / expected - 1.0).abs();
        assert!(
            error < 4.0 * found.standard_error / expected + 2e-3,
            "{camera}: {found:?} instead of {expected}"
        );
        assert!(found.standard_error < 0.02 * expected, "{camera}: {found:?}");
    }
}

/// Beams are kept in media that are thin enough, of the first paths alone, and no more than there is use for.
#[test]
fn beams_are_kept_of_the_first_paths() {
    let emitted = |medium: &str, paths: u32| {
        let scene = scene(&format!(
            "{} Media {{ Medium m {{ {medium} }} exterior m }} Materials {{ Matte wall {{ color 0.5 0.5 0.5 }} }}
             Lights {{ PointLight {{ position 0 0.5 0  intensity 1 }} }}
             Group {{ MaterialIndex wall Box {{ min -2 -2 -2 max 2 2 2 }} }}",
            camera([0.0, 0.0, 1.0], [0.0, 0.0, 0.0], 30.0)
        ));
        let wanted = PhotonRequest {
            map: Wanted::All,
            caustics: false,
            in_media: Some(Wanted::All),
            beams: Some(1.0),
        };
        PhotonEmission::new(&scene, paths, 8, false).emit(0, &Wavelengths::RGB, wanted, &setup(3)).unwrap()
    };
    let few = emitted("sigma_s 0.1", 200);
    assert_eq!(few.beam_paths, 200);
    // Each path ends after eight scatterings, with one ray before each and one behind the last, which leaves no photon.
    assert!(few.beams.len() >= 200 * 8 && few.in_media.len() < few.beams.len() / 2);
    let many = emitted("sigma_s 0.1", 20_000);
    assert!(many.beam_paths > 200 && many.beam_paths < 270, "{}", many.beam_paths);
    assert!(many.beams.len() >= emission::MOST_BEAMS && many.beams.len() < emission::MOST_BEAMS + 9);
    assert_eq!(many.photons_beside_beams, many.in_media.len() as u64);
    let dense = emitted("sigma_s 2", 500);
    assert!(dense.beams.is_empty() && dense.photons_beside_beams == 0 && !dense.in_media.is_empty());
    // The beams of the same paths are the same ones.
    assert_eq!(
        few.beams[..1500].iter().map(|beam| beam.o).collect::<Vec<_>>(),
        many.beams[..1500].iter().map(|beam| beam.o).collect::<Vec<_>>()
    );
}

/// A room of fog with a ball of glass and a denser cloud, in which an emitter is large enough for paths to meet it.
#[test]
fn photons_in_media_and_paths_agree() {
    let text = format!(
        "{} Media {{ Medium air {{ sigma_s 0.2 0.15 0.1  sigma_a 0.05  g 0.3 }}
                     FunctionMedium cloud {{ function = 1.5 + x  sigma_s 1 2 1.5  sigma_a 0.2 0.1 0.3
                        phaseColors on phaseTable 0 5 3 0  90 0.3 0.5 1  180 0.5 0.9 2 }}  exterior air }}
         Materials {{ Matte wall {{ color 0.6 0.5 0.4 }}  Matte emitter {{ color 0 0 0 emission 5 5 5 emits front }}
                      Glass glass {{ }}  Interface body {{ medium cloud }} }}
         Group {{ MaterialIndex wall Box {{ min -2 -2 -2 max 2 2 2 }}
                  MaterialIndex emitter Quad {{ corner -1 1.9 -1 edge1 2 0 0 edge2 0 0 2 }}
                  MaterialIndex glass Sphere {{ center 1 -1 -0.5 radius 0.8 }}
                  MaterialIndex body Sphere {{ center -0.8 -0.8 0 radius 0.8 }} }}",
        camera([0.0, 0.0, 1.9], [0.0, -1.0, 0.0], 70.0)
    );
    let scene = scene(&text);
    let path = PathSettings { bounces: 40, ..PathSettings::default() };
    let expected = mean_of(&Path::new(&scene, path, [1, 1], LayerSet::of(&[])), 8192);
    for usage in every(2, USES) {
        let found = mean(&scene, PhotonSettings { bounces: 40, ..with(usage, 20_000) }, 128);
        let sigma = found.standard_error.hypot(expected.standard_error) / expected.mean;
        // Disks and balls reach into walls, where there are no photons.
        let bias = if usage == Some(PhotonMapUse::Caustics) { 0.0 } else { 0.04 };
        let error = (found.mean / expected.mean - 1.0).abs();
        assert!(error < 4.0 * sigma + bias, "{usage:?}: {found:?} instead of {expected:?}");
        assert!(sigma < 0.025, "{usage:?} is too noisy: {found:?}");
    }
}

/// In balls that shrink the light that is missed beside walls comes back: with 64 times the photons a quarter of it is left.
#[test]
fn balls_of_many_photons_miss_little() {
    let text = format!(
        "{} Media {{ Medium air {{ sigma_s 0.5 0.4 0.3 }}  exterior air }}
         Materials {{ Matte wall {{ color 0.7 0.7 0.7 }}  Matte emitter {{ color 0 0 0 emission 5 5 5 emits front }} }}
         Group {{ MaterialIndex wall Box {{ min -1 -1 -1 max 1 1 1 }}
                  MaterialIndex emitter Quad {{ corner -0.5 0.95 -0.5 edge1 1 0 0 edge2 0 0 1 }} }}",
        camera([0.0, 0.0, 0.9], [0.0, -0.1, 0.0], 60.0)
    );
    let scene = scene(&text);
    let path = PathSettings { bounces: 64, ..PathSettings::default() };
    let expected = mean_of(&Path::new(&scene, path, [1, 1], LayerSet::of(&[])), 4096).mean;
    let missed = |photons: u32| {
        let settings = PhotonSettings { bounces: 64, ..with(Some(PhotonMapUse::Gather), photons) };
        1.0 - mean(&scene, settings, 128).mean / expected
    };
    let [few, many] = [1_000, 64_000].map(missed);
    assert!(few > 0.01 && many.abs() < 0.4 * few, "{few} {many}");
}
