//! Stars that are smaller than a pixel: how much of their light pictures have, wherever in a pixel they are.

use std::ops::Range;

use kajo_core::sampler::{Sampler, SamplerKind};
use kajo_scene::MemoryAssets;

use super::*;
use crate::integrator::Prepare;
use crate::integrator::tests::scene_with;

/// One star of magnitude 0, towards -z, before a black sky.
fn scene(camera: &str, stars: &str, rest: &str) -> Scene {
    let assets = MemoryAssets::new().with("one.txt", b"0 0 0 6500\n");
    let text = format!(
        "PerspectiveCamera {{ up 0 1 0 {camera} }} Background {{ color 0 0 0  stars {{ catalog one.txt  scale 1e6  {stars} }} }} {rest}"
    );
    scene_with(&text, &assets)
}

/// Illuminance of the star, luminance over all directions.
const E: f64 = 2.54;

/// The light of a picture of so many degrees, whose pixels are alike on a plane before the camera.
///
/// * `size`: columns and rows
/// * `rows`: that are looked at; all others are black
/// * `n`: samples of a pixel
fn light(scene: &Scene, degrees: f64, size: u32, rows: Range<u32>, n: u32) -> f64 {
    let settings = PathSettings { bounces: 4, ..PathSettings::default() };
    let integrator = settings.prepare(scene, &scene.output.camera, [size, size], LayerSet::of(&[]));
    let sampler = Sampler::new(SamplerKind::Jittered, n);
    let mut ctx = SampleContext::new(&sampler, 7);
    let edge = 2.0 * (0.5 * degrees.to_radians()).tan() / f64::from(size);
    let mut sum = 0.0;
    for (x, y) in rows.flat_map(|y| (0..size).map(move |x| (x, y))) {
        let middle = [x, y].map(|v| (f64::from(v) + 0.5 - 0.5 * f64::from(size)) * edge);
        let cos = 1.0 / (1.0 + middle[0] * middle[0] + middle[1] * middle[1]).sqrt();
        for k in 0..n {
            let place = ctx.begin([x, y], k) + Vec2::new(x as f32, y as f32);
            let rgb = integrator.sample(&mut ctx, [x, y], place).radiance;
            let luminance = 0.212_64 * rgb[0] + 0.715_17 * rgb[1] + 0.072_19 * rgb[2];
            sum += f64::from(luminance) * edge * edge * cos * cos * cos / f64::from(n);
        }
    }
    sum
}

/// Sixteen samples see a star that moves over a pixel, each time as bright as it is; of one of its own size they see all or nothing.
#[test]
fn stars_do_not_flicker() {
    let all = |stars: &str| {
        let of = |i: u32| {
            let d = 0.001 * f64::from(i);
            let camera = format!("center 0 0 0  direction {d} {} -1  angle 6", 0.7 * d);
            light(&scene(&camera, stars, ""), 6.0, 12, 0..12, 16) / E
        };
        (0..9).map(of).collect::<Vec<_>>()
    };
    let steady = all("radius 0.001");
    assert!(steady.iter().all(|light| (light - 1.0).abs() < 0.04), "{steady:?}");
    let own = all("radius 0.001  pixelRadius 0");
    assert!(own.iter().all(|light| !(0.2..5.0).contains(light)), "{own:?}");
    // One that is large is what it was.
    let large = all("radius 1");
    assert!(large.iter().all(|light| (light - 1.0).abs() < 0.04), "{large:?}");
}

/// A camera that flies towards a star sees it in `D^2` times as much light, on `D^2` times less of the sky.
#[test]
fn stars_ahead_of_a_fast_camera_are_as_bright_as_they_are() {
    for velocity in [0.6f64, 0.8] {
        let camera = format!("center 0 0 0  direction 0.003 0.002 -1  angle 6  velocity 0 0 -{velocity}");
        let found = light(&scene(&camera, "radius 0.001", ""), 6.0, 12, 0..12, 16) / E;
        let expected = (1.0 + velocity) / (1.0 - velocity);
        assert!((found / expected - 1.0).abs() < 0.05, "{velocity}: {found} for {expected}");
    }
}

/// The mirror image of a star is no other.
#[test]
fn stars_in_a_mirror_are_as_bright_as_they_are() {
    let mirror = "Materials { Material m { diffuseColor 0 0 0  reflectiveColor 1 1 1 } }
        Group { MaterialIndex m Quad { corner -9 -9 3  edge1 18 0 0  edge2 0 18 0 } }";
    let camera = "center 0 0 0  direction 0.003 0.002 1  angle 6";
    let found = light(&scene(camera, "radius 0.001", mirror), 6.0, 12, 0..12, 16) / E;
    assert!((found - 1.0).abs() < 0.05, "{found}");
}

/// Behind a black hole both images of a star have the light that a disc has which is large enough for every pixel to see, for a camera at
/// rest and for one that falls.
#[test]
fn stars_behind_a_hole_are_magnified() {
    let camera = "center 6 0 60  direction 0 0 -1  angle 44";
    for observer in ["rests", "falls"] {
        let space = format!(
            "Media {{ BlackHole hole {{ mass 1  observer {observer} }} }} Materials {{ Interface space {{ medium hole }} }}
            Group {{ MaterialIndex space  Sphere {{ center 0 0 0  radius 300 }} }}"
        );
        let [small, large] = [("radius 0.001", 16), ("radius 0.8  pixelRadius 0", 36)]
            .map(|(stars, n)| light(&scene(camera, stars, &space), 44.0, 48, 18..30, n) / E);
        assert!(large > 1.2 && (small / large - 1.0).abs() < 0.04, "{observer}: {small} {large}");
    }
}
