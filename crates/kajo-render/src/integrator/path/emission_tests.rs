//! Media that give light, against closed forms, by paths from the camera and from both ends.

use kajo_color::{BlackBodies, Wavelengths};
use kajo_core::camera::Camera;
use kajo_core::compile::{CompileOptions, compile};
use kajo_core::medium::REFERENCE_KELVIN;
use kajo_core::sampler::{Sampler, SamplerKind};
use kajo_core::settings::Technique;
use kajo_scene::{MemoryAssets, SceneDesc};
use kajo_testkit::Estimate;
use kajo_testkit::vdb::{VdbCompression, VdbFile, VdbGrid, VdbKind, VdbMap};

use super::tests::{camera, scene};
use super::*;
use crate::PixelIntegrator;
use crate::integrator::bidir::{BidirectionalSettings, integrator_of};

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

/// Paths, and both ends; by red, green and blue or by wavelength.
fn integrators(scene: &Scene, spectral: bool) -> Vec<Box<dyn PixelIntegrator + '_>> {
    let path = PathSettings { bounces: 2000, spectral, ..PathSettings::default() };
    let both = BidirectionalSettings { bounces: 200, spectral, ..BidirectionalSettings::default() };
    let camera: &Camera = &scene.output.camera;
    let none = || LayerSet::of(&[]);
    vec![Box::new(Path::new(scene, path, [1, 1], none())), integrator_of(camera, scene, both, [1, 1], none())]
}

fn filled(view: &str, medium: &str, body: &str) -> Scene {
    scene(&format!(
        "{view} Media {{ {medium} }} Materials {{ Interface i {{ medium m }} }} Group {{ MaterialIndex i {body} }}"
    ))
}

const BOX: &str = "Box { min -1 -1 -1 max 1 1 1 }";

/// `e/s (1 - exp(-s L))`, and `e L` where nothing is absorbed: without noise.
#[test]
fn a_slab_that_emits_has_its_closed_form() {
    for (from, length) in [([0.0, 0.0, 5.0], 2.0), ([0.0, 0.0, 0.5], 1.5)] {
        let medium = "Medium m { emission 3 2 1  sigma_a 0.5 0 2 }";
        let scene = filled(&camera(from, [0.0, 0.0, -9.0]), medium, BOX);
        let expected = [
            3.0 / 0.5 * (1.0 - f64::exp(-0.5 * length)),
            2.0 * length,
            0.5 * (1.0 - f64::exp(-2.0 * length)),
        ];
        for integrator in integrators(&scene, false) {
            for (lane, expected) in expected.into_iter().enumerate() {
                let found = mean_of(&*integrator, 16, lane).mean;
                assert!((found / expected - 1.0).abs() < 1e-5, "{length} {lane}: {found} {expected}");
            }
        }
    }
    // All of the air.
    let endless =
        filled(&camera([0.0; 3], [0.0, 0.0, -1.0]), "Medium m { emission 3 sigma_a 2 } exterior m", "");
    let found = mean_of(&*integrators(&endless, false)[0], 16, 0).mean;
    assert!((found - 1.5).abs() < 1e-5, "{found}");
}

/// What only emits by a function of the position, and what absorbs in other positions as well, by quadrature.
#[test]
fn emission_that_varies_is_its_integral() {
    let density = |z: f64| (1.0 + z).max(0.0);
    for sigma in [0.0, 1.2] {
        let n = 20_000;
        let h = 2.0 / f64::from(n);
        let (mut depth, mut expected) = (0.0, 0.0);
        for k in 0..n {
            let d = density(1.0 - h * (f64::from(k) + 0.5));
            expected += 2.0 * d * (-sigma * (depth + 0.5 * h * d)).exp() * h;
            depth += d * h;
        }
        let medium = format!("FunctionMedium m {{ function = 1 + z  emission 2  sigma_a {sigma} }}");
        let scene = filled(&camera([0.1, 0.2, 5.0], [0.1, 0.2, 0.0]), &medium, BOX);
        for integrator in integrators(&scene, false) {
            let found = mean_of(&*integrator, 4000, 0);
            // Stratified samples of a line are nearly without noise.
            if (found.mean / expected - 1.0).abs() > 1e-5 {
                found.check(expected, 0.02).unwrap();
            }
        }
    }
}

/// In an even sky of the radiance `B` a medium that absorbs `a` and gives `a B` is not to be seen, whatever it scatters.
#[test]
fn a_medium_as_hot_as_its_surroundings_is_not_seen() {
    for medium in [
        "Medium m { sigma_a 0.5 1 2  sigma_s 1 3 0.5  g 0.4  emission 0.5 1 2 }",
        "Medium m { sigma_a 0.3  sigma_s 2  emission 0.3 }",
        "GridMedium m { size 2 2 2 values 1 0.2 0 0.7 0.4 1 0.6 0.1  sigma_a 1 0.5 2  sigma_s 1 4 2  emission 1 0.5 2 }",
        "FunctionMedium m { function = 2 - x  sigma_a 0.5 0.2 1  emission 0.5 0.2 1 }",
    ] {
        for from in [[0.3, 0.2, 4.0], [0.1, -0.3, 0.1]] {
            let view = camera(from, [0.0, -0.2, -0.1]).replace("color 0 0 0", "color 1 1 1");
            let scene = filled(&view, medium, BOX);
            for integrator in integrators(&scene, false) {
                for lane in 0..3 {
                    mean_of(&*integrator, 800, lane).check(1.0, 0.05).unwrap();
                }
            }
        }
    }
    // By wavelength, grey, so that the emission is that of the sky at each of them.
    let view = camera([0.3, 0.2, 4.0], [0.0, -0.2, -0.1]).replace("color 0 0 0", "color 1 1 1");
    let scene =
        filled(&view, "FunctionMedium m { function = 2 - x  sigma_a 0.4  sigma_s 1  emission 0.4 }", BOX);
    for integrator in integrators(&scene, true) {
        mean_of(&*integrator, 1000, 1).check(1.0, 0.05).unwrap();
    }
}

/// A flame lights a floor: an even ball that only emits has the intensity `e V` to all sides, far away.
#[test]
fn a_flame_lights_what_is_around_it() {
    let text = format!(
        "{} Media {{ Medium m {{ emission 50 }} }}
         Materials {{ Interface i {{ medium m }}  Matte white {{ color 1 1 1  roughness 0 }} }}
         Group {{ MaterialIndex i Sphere {{ center 0 1 0  radius 0.2 }}  MaterialIndex white Disk {{ center 0 0 0  normal 0 1 0  radius 0.02 }} }}",
        camera([0.3, 0.4, 0.1], [0.0, 0.0, 0.0])
    );
    let scene = scene(&text);
    // Over the ball, of the power to the receiver per area: e dV / d^2, whose mean over a ball is not that of its middle.
    let n = 60;
    let (mut sum, h) = (0.0, 0.4 / f64::from(n));
    for i in 0..n * n * n {
        let at = |k: i32| -0.2 + h * (f64::from(k) + 0.5);
        let (x, y, z) = (at(i % n), at(i / n % n), at(i / n / n));
        if x * x + y * y + z * z < 0.04 {
            let r2 = x * x + (1.0 + y) * (1.0 + y) + z * z;
            sum += 50.0 * h * h * h * (1.0 + y) / (r2 * r2.sqrt());
        }
    }
    let expected = sum / std::f64::consts::PI;
    for integrator in integrators(&scene, false) {
        mean_of(&*integrator, 20_000, 0).check(expected, 0.02).unwrap();
    }
}

/// Two blocks of voxels, one behind the other along z from 0 to 2, with a density and a heat each.
fn fire(view: &str, medium: &str) -> Scene {
    let grid = |name: &str, values: [f32; 2]| {
        let mut grid = VdbGrid::new(name, VdbKind::Float, VdbMap::ScaleTranslate([0.125; 3], [0.0625; 3]));
        grid.tile(3, [0, 0, 0], [values[0]; 3], true);
        grid.tile(3, [0, 0, 8], [values[1]; 3], true);
        grid
    };
    let grids = vec![grid("density", [1.0, 0.5]), grid("flame", [1.0, 0.25])];
    let file = VdbFile { version: 224, compression: VdbCompression::Zip, masks: true, grids }.to_bytes();
    let text = format!(
        "{view} Media {{ GridMedium m {{ file fire.vdb  temperature flame  {medium} }} }}
         Materials {{ Interface i {{ medium m }} }} Group {{ MaterialIndex i Box {{ min -1 -1 -1  max 2 2 3 }} }}"
    );
    let mut parsed = SceneDesc::parse_str(&text);
    let assets = MemoryAssets::new().with("fire.vdb", file);
    let made = compile(&mut parsed.desc, &assets, &CompileOptions::default(), &mut parsed.diagnostics);
    made.unwrap_or_else(|| panic!("{text}\n{:?}", parsed.diagnostics))
}

/// `e d B(T)/Y`, weakened by what is before it, by quadrature.
#[test]
fn a_fire_emits_by_its_temperature() {
    let bodies = BlackBodies::new(REFERENCE_KELVIN);
    let scene = fire(
        &camera([0.5, 0.5, 5.0], [0.5, 0.5, 0.0]),
        "sigma_a 0.7  temperatureScale 2000  temperatureOffset 600  brightness 3",
    );
    let value = |z: f64, values: [f64; 2]| {
        let t = (8.0 * z - 7.5).clamp(0.0, 1.0);
        values[0] + t * (values[1] - values[0])
    };
    let n = 4000;
    let h = 2.0 / f64::from(n);
    let (mut depth, mut expected) = (0.0, [0.0; 3]);
    for k in 0..n {
        let z = 2.0 - h * (f64::from(k) + 0.5);
        let d = value(z, [1.0, 0.5]);
        let kelvin = 600.0 + 2000.0 * value(z, [1.0, 0.25]);
        let light = bodies.at(kelvin, &Wavelengths::RGB).to_rgb();
        let weight = 3.0 * d * f64::exp(-0.7 * (depth + 0.5 * h * d)) * h;
        (0..3).for_each(|lane| expected[lane] += weight * f64::from(light[lane]));
        depth += d * h;
    }
    assert!(expected[0] > 3.0 * expected[2], "{expected:?}");
    for integrator in integrators(&scene, false) {
        for (lane, expected) in expected.into_iter().enumerate() {
            mean_of(&*integrator, 4000, lane).check(expected, 0.02).unwrap();
        }
    }
}

/// In an even sky of the radiance of black bodies of its temperature a medium that absorbs 1 and emits 1 is not to be seen.
#[test]
fn a_fire_as_hot_as_its_surroundings_is_not_seen() {
    let [r, g, b] = BlackBodies::new(REFERENCE_KELVIN).at(1700.0, &Wavelengths::RGB).to_rgb();
    let view = camera([0.6, 0.4, 4.0], [0.4, 0.5, 0.1]).replace("color 0 0 0", &format!("color {r} {g} {b}"));
    let medium = "sigma_a 1  sigma_s 3 1 2  g 0.4  temperatureScale 0  temperatureOffset 1700";
    let scene = fire(&view, medium);
    for integrator in integrators(&scene, false) {
        for (lane, expected) in [r, g, b].into_iter().enumerate() {
            mean_of(&*integrator, 500, lane).check(expected.into(), 0.05).unwrap();
        }
    }
}

/// Light of media is drawn and met: behind panes and sheets with holes, in smoke whose colours are scattered differently, where bodies of
/// glass hide a part, beside other gas, in motion, from within.
#[test]
fn light_of_media_that_is_drawn_and_met_is_one() {
    let smoke = "Medium air { sigma_s 0.1 0.2 0.3  sigma_a 0.05  phaseColors on  phaseTable 0 5 3 0  90 0.5 1 2  180 1 1 1 } exterior air";
    let gas = "FunctionMedium gas { function = 2 + 3 * x  emission 9 6 4  sigma_a 0.3 0.5 1 }";
    let grid = "GridMedium gas { size 2 1 2  values 1 0.2 0 0.7  min -0.4 0 -0.4  max 0.4 0.8 0.4  emission 20 10 5  sigma_s 1 2 3 }";
    let ball = "MaterialIndex hot Sphere { center 0.1 0.4 0  radius 0.3 }";
    let pane = "MaterialIndex pane Quad { corner -1 -0.3 -1  edge1 2 0 0  edge2 0 0 2 }";
    let sheet = "MaterialIndex sheet Quad { corner -1 -0.2 -1  edge1 2 0 0  edge2 0 0 2 }";
    let glass = "MaterialIndex glass Sphere { center 0.2 0.25 0.1  radius 0.3 }";
    let other = "MaterialIndex dim Box { min -0.9 -0.6 -0.5  max -0.5 0.2 0 }";
    let moving = "MaterialIndex hot Transform { Motion { key 0 { }  key 1 { Translate 0.6 0 0 } } Sphere { center -0.2 0.4 0  radius 0.3 } }";
    let around = "MaterialIndex hot Sphere { center 0 -0.7 0  radius 0.9 }";
    let cases = [
        (gas, format!("{ball} {pane} {sheet}"), false),
        (&format!("{smoke} {gas}"), ball.to_owned(), false),
        (&format!("{smoke} {grid}"), format!("{ball} {sheet}"), true),
        (gas, format!("{ball} {glass}"), false),
        (grid, format!("{ball} {glass} {other}"), false),
        (gas, format!("{moving} {other}"), true),
        (&format!("{smoke} {gas}"), around.to_owned(), false),
    ];
    for (media, things, spectral) in cases {
        let text = format!(
            "PerspectiveCamera {{ center 0.5 0.2 3  direction -0.15 -0.25 -1  up 0 1 0  angle 30  shutter 0 1 }} Background {{ color 0 0 0 }}
             Media {{ Medium dim {{ emission 1 2 4 }} {media} }}
             Materials {{ Matte white {{ color 0.8 0.7 0.6 }}  Interface hot {{ medium gas }}  Interface dim {{ medium dim }}
                Glass pane {{ thin on }}  Matte sheet {{ color 0.5 0.5 0.5  opacity 0.4 }}  Glass glass {{ priority 1 }} }}
             Group {{ MaterialIndex white Plane {{ normal 0 1 0  offset -0.8 }} {things} }}"
        );
        let scene = scene(&text);
        let path = |technique| PathSettings { bounces: 3, technique, spectral, ..PathSettings::default() };
        let of = |technique| Path::new(&scene, path(technique), [1, 1], LayerSet::of(&[]));
        let lane = usize::from(spectral);
        let met = mean_of(&of(Technique::Scattering), 12_000, lane);
        let both_ends = BidirectionalSettings { bounces: 3, spectral, ..BidirectionalSettings::default() };
        let both_ends = integrator_of(&scene.output.camera, &scene, both_ends, [1, 1], LayerSet::of(&[]));
        let [drawn, both] = [Technique::Lights, Technique::Combined].map(|by| mean_of(&of(by), 3000, lane));
        for (name, found) in
            [("drawn", drawn), ("both", both), ("both ends", mean_of(&*both_ends, 3000, lane))]
        {
            let sigma = found.standard_error.hypot(met.standard_error);
            assert!((found.mean - met.mean).abs() < 4.0 * sigma, "{name} {text}: {found:?} {met:?}");
            assert!(sigma < 0.03 * met.mean, "{name} {text} is too noisy: {found:?} {met:?}");
        }
    }
}

/// The light of a small flame has next to no noise on a floor where it is drawn.
#[test]
fn drawn_light_of_media_has_little_noise() {
    let scene = scene(&format!(
        "{} Media {{ FunctionMedium m {{ function = exp(-40 * (x^2 + (y - 2)^2 + z^2))  min -1 1 -1  max 1 3 1  emission 5 }} }}
         Materials {{ Interface i {{ medium m }}  Matte white {{ }} }}
         Group {{ MaterialIndex i Box {{ min -1 1 -1  max 1 3 1 }}  MaterialIndex white Plane {{ normal 0 1 0  offset 0 }} }}",
        camera([2.0, 0.8, 0.5], [0.0, 0.0, 0.0])
    ));
    let of = |technique| {
        let settings = PathSettings { bounces: 0, technique, ..PathSettings::default() };
        mean_of(&Path::new(&scene, settings, [1, 1], LayerSet::of(&[])), 500, 0)
    };
    let [met, drawn, both] = [Technique::Scattering, Technique::Lights, Technique::Combined].map(of);
    let settings = BidirectionalSettings { bounces: 0, ..BidirectionalSettings::default() };
    let both_ends = integrator_of(&scene.output.camera, &scene, settings, [1, 1], LayerSet::of(&[]));
    for found in [drawn, both, mean_of(&*both_ends, 500, 0)] {
        assert!((found.mean - both.mean).abs() < 4.5 * found.standard_error.hypot(both.standard_error));
        assert!(found.standard_error < 0.2 * met.standard_error, "{found:?} {met:?}");
    }
}
