//! Light from both ends against closed forms, and its parts against each other.

use std::f64::consts::PI;

use kajo_core::compile::{CompileOptions, compile};
use kajo_core::sampler::{Sampler, SamplerKind};
use kajo_math::rng::Stream;
use kajo_scene::{MemoryAssets, SceneDesc};
use kajo_testkit::Estimate;
use kajo_testkit::vdb::{VdbCompression, VdbFile, VdbGrid, VdbKind, VdbMap};

use super::*;
use crate::integrator::{Path, PathSettings};
use crate::{PixelIntegrator, Setup, Silent};

mod media;
mod scenes;
mod ways;
mod weights;

fn scene(text: &str) -> Scene {
    let mut parsed = SceneDesc::parse_str(text);
    let scene = compile(
        &mut parsed.desc,
        &MemoryAssets::new()
            .with("gem.obj", GEM)
            .with("dents.pfm", dents())
            .with("colors.vdb", colored_voxels()),
        &CompileOptions::default(),
        &mut parsed.diagnostics,
    );
    scene.unwrap_or_else(|| panic!("{text}\n{:?}", parsed.diagnostics))
}

/// A mesh so coarse that its shading normals are far from the true ones.
const GEM: &str = "v 1 0 0\nv -1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\nv 0 0 -1\n\
    f 1 3 5\nf 3 2 5\nf 2 4 5\nf 4 1 5\nf 3 1 6\nf 2 3 6\nf 4 2 6\nf 1 4 6\n";

/// A picture of normals that lean up to 50 degrees.
fn dents() -> Vec<u8> {
    let mut file = b"PF\n4 4\n-1\n".to_vec();
    for i in 0..16u32 {
        let s = Stream::new(8, [i, 0], 0);
        let texel = [0.1 + 0.8 * s.uniform(0), 0.1 + 0.8 * s.uniform(1), 0.85];
        file.extend(texel.into_iter().flat_map(f32::to_le_bytes));
    }
    file
}

/// Eight voxels, each of a colour of its own.
fn colored_voxels() -> Vec<u8> {
    let mut grid = VdbGrid::new("Cd", VdbKind::Vec3, VdbMap::Uniform(1.0));
    for (k, color) in [
        [1.0, 0.3, 0.1],
        [0.1, 0.2, 0.0],
        [0.0, 0.6, 1.0],
        [0.7, 0.7, 0.7],
        [0.4, 0.0, 0.1],
        [0.2, 1.0, 0.3],
        [0.6, 0.1, 0.9],
        [0.1, 0.1, 0.4],
    ]
    .into_iter()
    .enumerate()
    {
        grid.set([0, 1, 2].map(|axis| (k >> axis & 1) as i32), color);
    }
    VdbFile { version: 224, compression: VdbCompression::None, masks: true, grids: vec![grid] }.to_bytes()
}

/// A camera in a black world.
fn camera(from: [f32; 3], to: [f32; 3], angle: f32) -> String {
    let [a, b, c] = from;
    let [x, y, z] = [to[0] - a, to[1] - b, to[2] - c];
    format!(
        "PerspectiveCamera {{ center {a} {b} {c}  direction {x} {y} {z}  up 0.1 0.9 0.2  angle {angle} }}
         Background {{ color 0 0 0 }}"
    )
}

/// The mean of a lane of a picture of one pixel, splats included.
fn mean_of(integrator: &dyn PixelIntegrator, samples: u32, lane: usize) -> Estimate {
    let sampler = Sampler::new(SamplerKind::Sobol, samples);
    Estimate::of_batches(|batch| {
        let mut ctx = SampleContext::new(&sampler, 0);
        let mut sum = 0.0;
        for k in 0..samples {
            let place = ctx.begin([0, batch], k);
            sum += f64::from(integrator.sample(&mut ctx, [0, 0], place).radiance[lane]);
        }
        let inside = |raster: Vec2| raster.min_element() >= 0.0 && raster.max_element() < 1.0;
        let splats = ctx.splats.as_slice().iter().filter(|splat| inside(splat.raster));
        sum += splats.map(|splat| f64::from(splat.value[lane])).sum::<f64>();
        sum / f64::from(samples)
    })
}

fn mean(scene: &Scene, settings: BidirectionalSettings, samples: u32) -> Estimate {
    let camera = &scene.output.camera;
    mean_of(&*integrator_of(camera, scene, settings, [1, 1], LayerSet::of(&[])), samples, 0)
}

#[track_caller]
fn check(scene: &Scene, settings: BidirectionalSettings, samples: u32, expected: f64) {
    let found = mean(scene, settings, samples);
    if (found.mean / expected - 1.0).abs() < 1e-5 {
        return;
    }
    if let Err(complaint) = found.check(expected, 0.01) {
        panic!("{settings:?}: {complaint}");
    }
}

/// How many times as many samples are taken.
fn effort() -> u32 {
    if kajo_testkit::is_deep() { 5 } else { 1 }
}

fn setup(seed: u64) -> Setup<'static> {
    Setup { seed, threads: 1, memory: u64::MAX, progress: &Silent }
}

fn both() -> BidirectionalSettings {
    BidirectionalSettings::default()
}

fn from_lights() -> BidirectionalSettings {
    BidirectionalSettings { only_from_lights: true, ..both() }
}

#[test]
fn an_emissive_room_is_as_bright_as_its_series() {
    let shells = [
        "Sphere { center 0 0 0 radius 1 }",
        "Box { min -1 -1 -1 max 1 1 1 }",
        "Transform { Scale 1 2 1.5 YRotate 30 Sphere { center 0 0 0 radius 0.7 } }",
    ];
    for shell in shells {
        for angle in [0.01, 70.0] {
            let view = camera([0.2, 0.1, -0.1], [0.7, -0.3, 0.5], angle);
            let material = "Materials { Material m { diffuseColor 0.5 0.5 0.5  emission 1 1 1 } }";
            let scene = scene(&format!("{view} {material} Group {{ MaterialIndex m {shell} }}"));
            check(&scene, BidirectionalSettings { bounces: 100, ..both() }, 256, 2.0);
            // Direct light and one bounce more: 1 + 1/2 + 1/4.
            check(&scene, BidirectionalSettings { bounces: 1, ..both() }, 256, 1.75);
            check(&scene, BidirectionalSettings { bounces: 1, spectral: true, ..both() }, 512, 1.75);
        }
        let view = camera([0.2, 0.1, -0.1], [0.7, -0.3, 0.5], 70.0);
        let material = "Materials { Material m { diffuseColor 0.5 0.5 0.5  emission 1 1 1 } }";
        let scene = scene(&format!("{view} {material} Group {{ MaterialIndex m {shell} }}"));
        check(&scene, BidirectionalSettings { bounces: 1, ..from_lights() }, 2000, 1.75);
    }
}

#[test]
fn a_point_light_in_a_white_ball_lights_it_evenly() {
    let text = |angle: f32| {
        format!(
            "{} Lights {{ PointLight {{ position 0.5 0 0  intensity 1 1 1 }} }}
             Materials {{ Material m {{ diffuseColor 0.8 0.8 0.8 }} }}
             Group {{ MaterialIndex m Sphere {{ center 0 0 0 radius 1 }} }}",
            camera([0.0, 0.6, 0.0], [-1.0, 0.0, 0.0], angle)
        )
    };
    let expected = 0.8 / PI * (1.0 / 2.25 + 4.0);
    check(&scene(&text(0.01)), BidirectionalSettings { bounces: 200, ..both() }, 250, expected);
}

#[test]
fn a_square_light_lights_a_floor_as_lambert_says() {
    let text = |from: [f32; 3], angle: f32| {
        format!(
            "{} Materials {{ Material floor {{ diffuseColor 0.7 0.7 0.7 }}
                             Material emitter {{ diffuseColor 0 0 0  emission 3 3 3 emits front }} }}
             Group {{ MaterialIndex floor Quad {{ corner -9 0 -9 edge1 0 0 18 edge2 18 0 0 }}
                      MaterialIndex emitter Quad {{ corner -0.5 1 -0.5 edge1 1 0 0 edge2 0 0 1 }} }}",
            camera(from, [0.0, 0.0, 0.0], angle)
        )
    };
    let expected = 0.7 / PI * 3.0 * 0.752_275;
    let aside = text([0.0, 0.5, 2.0], 0.01);
    check(&scene(&aside), BidirectionalSettings { bounces: 1, ..both() }, 500, expected);
    // Over more of the floor light tracing finds what path tracing does.
    let down = scene(&text([0.0, 0.5, 0.0], 60.0));
    let path = PathSettings { bounces: 0, ..PathSettings::default() };
    let path = mean_of(&Path::new(&down, path, [1, 1], LayerSet::of(&[])), 500, 0);
    check(&down, BidirectionalSettings { bounces: 0, ..from_lights() }, 8000, path.mean);
    let dark = aside.replace("emits front", "emits back");
    assert_eq!(mean(&scene(&dark), both(), 50).mean, 0.0);
}

#[test]
fn glass_in_an_even_world_is_not_to_be_seen() {
    for material in ["Glass g { indexOfRefraction 1.5 }", "Glass g { roughness 0.6 }"] {
        let text = format!(
            "{} Materials {{ {material} }} Group {{ MaterialIndex g Sphere {{ center 0 0 0 radius 1 }} }}",
            camera([0.0, 0.0, 4.0], [0.3, 0.5, 0.0], 1.0).replace("color 0 0 0", "color 1 1 1")
        );
        let found = mean(&scene(&text), BidirectionalSettings { bounces: 100, ..both() }, 200);
        assert!((found.mean - 1.0).abs() < 2e-3 + 4.0 * found.standard_error, "{material}: {found:?}");
    }
}

#[test]
fn light_is_absorbed_from_the_light_on() {
    // Light, floor and camera are inside of a body that bends nothing. The path tracer is held to a closed form.
    let view = camera([0.0, 0.5, 0.5], [0.0, 0.0, 0.0], 40.0);
    let text = format!(
        "{view} Lights {{ PointLight {{ position 0 1 0  intensity 3 3 3 }} }}
         Materials {{ Glass murk {{ indexOfRefraction 1  absorption 0.8 0.8 0.8 }}
                      Matte floor {{ color 0.7 0.7 0.7  roughness 0 }} }}
         Group {{ MaterialIndex murk Box {{ min -5 -5 -5 max 5 5 5 }}
                  MaterialIndex floor Quad {{ corner -0.5 0 -0.5 edge1 0 0 1 edge2 1 0 0 }} }}"
    );
    let scene = scene(&text);
    let path = PathSettings { bounces: 1, ..PathSettings::default() };
    let path = mean_of(&Path::new(&scene, path, [1, 1], LayerSet::of(&[])), 2000, 0);
    for settings in [both(), from_lights()] {
        let found = mean(&scene, BidirectionalSettings { bounces: 1, ..settings }, 40_000);
        let sigma = found.standard_error.hypot(path.standard_error);
        assert!((found.mean - path.mean).abs() < 4.5 * sigma, "{settings:?}: {found:?} {path:?}");
        assert!(sigma < 0.01 * path.mean, "{settings:?} is too noisy: {found:?}");
    }
}
