//! A matt floor whose normals lean has the radiance of its irradiance from wherever it is seen.
//!
//! Normals lean by an angle `t` to +x. Parallel light of the irradiance `E` across it, at the angle `s` from a normal, gives the
//! radiance
//!
//! ```text
//! L = R/π E cos s
//! ```
//!
//! and a sky of radiance 1, of which the true surface hides what is below it, `L = R (1 + cos t)/2`, also beyond a right angle.

use kajo_core::sampler::{Sampler, SamplerKind};
use kajo_core::scene::Scene;
use kajo_math::Vec3;
use kajo_math::rng::Stream;
use kajo_scene::MemoryAssets;

use super::classic::Classic;
use super::tests::{plain, scene_with};
use super::{Bidirectional, BidirectionalSettings, Path, PathSettings};
use crate::{LayerSet, PixelIntegrator, SampleContext};

const REFLECTANCE: f64 = 0.5;
const DARK: &str = "Background { color 0 0 0 }";
const SIZE: [u32; 2] = [1, 1];

/// A normal map that leans everywhere to +u.
fn leaning(degrees: f32) -> MemoryAssets {
    let mut file = b"PF\n1 1\n-1.0\n".to_vec();
    let (s, c) = degrees.to_radians().sin_cos();
    file.extend([s, 0.0, c].map(|v| 0.5 + 0.5 * v).into_iter().flat_map(f32::to_le_bytes));
    MemoryAssets::new().with("leaning.pfm", file)
}

/// Parallel light that comes from `degrees` from the vertical, on the side of +x, with the irradiance π across it.
fn sun(degrees: f64) -> String {
    let (x, y) = degrees.to_radians().sin_cos();
    const E: f64 = std::f64::consts::PI;
    format!("{DARK} Lights {{ DirectionalLight {{ direction {} {} 0 irradiance {E} {E} {E} }} }}", -x, -y)
}

/// A floor of a leaning material, seen from so many degrees above -x.
fn floor(material: &str, light: &str, degrees: f64, assets: &MemoryAssets) -> Scene {
    floor_with(material, "leaning.pfm", light, degrees, assets)
}

/// * `relief`: the picture of normals, and what is said of it
fn floor_with(material: &str, relief: &str, light: &str, degrees: f64, assets: &MemoryAssets) -> Scene {
    let (y, x) = degrees.to_radians().sin_cos();
    let text = format!(
        "OrthographicCamera {{ center {} {} 0  direction {x} -{y} 0  up 0 1 0  size 0.05 }}
         {light} Materials {{ {material}  normalMap {relief} }} }}
         Group {{ MaterialIndex m Quad {{ corner -5 0 5  edge1 10 0 0  edge2 0 0 -10 }} }}",
        -3.0 * x,
        3.0 * y
    );
    scene_with(&text, assets)
}

/// The mean radiance of the middle of the picture by an integrator.
fn mean(integrator: &dyn PixelIntegrator) -> f64 {
    mean_of(integrator, 1 << 15)
}

fn mean_of(integrator: &dyn PixelIntegrator, samples: u32) -> f64 {
    let sampler = Sampler::new(SamplerKind::Sobol, samples);
    let mut ctx = SampleContext::new(&sampler, 3);
    let radiance = |k: u32| {
        let raster = ctx.begin([0, 0], k);
        f64::from(integrator.sample(&mut ctx, [0, 0], raster).radiance[0])
    };
    (0..samples).map(radiance).sum::<f64>() / f64::from(samples)
}

/// The radiance of a floor that leans by `lean` degrees, from many directions, under the light of `light`, in which it
/// reflects `cos` of a full irradiance.
fn check(lean: f32, light: &str, cos: f64) {
    let assets = leaning(lean);
    let is_classic = !light.contains("color 1 1 1");
    for material in ["Matte m { color 0.5 0.5 0.5", "PhongMaterial m { diffuseColor 0.5 0.5 0.5"] {
        for degrees in [60.0f64, 45.0, 20.0, 5.0, 120.0, 160.0, 175.0] {
            let scene = floor(material, light, degrees, &assets);
            let layers = || LayerSet::of(&[]);
            let path = Path::new(&scene, PathSettings::default(), SIZE, layers());
            let both_ends = Bidirectional::new(&scene, BidirectionalSettings::default(), SIZE, layers());
            let classic = Classic::new(&scene, plain(&scene), SIZE, layers());
            let mut integrators: Vec<&dyn PixelIntegrator> = vec![&path, &both_ends];
            // Skies are no light to it.
            integrators.extend(is_classic.then_some(&classic as &dyn PixelIntegrator));
            for (i, integrator) in integrators.into_iter().enumerate() {
                let (found, expected) = (mean(integrator), REFLECTANCE * cos);
                let off = (found / expected - 1.0).abs();
                let place = format!("{i}, {material} by {lean} degrees from {degrees}");
                assert!(off < 2e-3, "{place}: {found} for {expected} by {light}");
            }
        }
    }
}

#[test]
fn matt_reliefs_are_as_bright_from_everywhere() {
    let cos = 30f64.to_radians().cos();
    check(30.0, &sun(0.0), cos);
    check(30.0, "Background { color 1 1 1 }", 0.5 * (1.0 + cos));
}

#[test]
fn reliefs_that_lean_beyond_a_right_angle_keep_their_normal() {
    check(110.0, &sun(60.0), 50f64.to_radians().cos());
    check(110.0, "Background { color 1 1 1 }", 0.5 * (1.0 + 110f64.to_radians().cos()));
}

/// Light from behind the normal of a relief makes a highlight about the one that is held up, and nothing else.
#[test]
fn classic_highlights_go_by_the_normal_that_is_held_up() {
    let material = "PhongMaterial m { diffuseColor 0.5 0.5 0.5  specularColor 0.25 0.25 0.25  exponent 0";
    let scene = floor(material, &sun(0.0), 20.0, &leaning(110.0));
    let found = mean(&Classic::new(&scene, plain(&scene), SIZE, LayerSet::of(&[])));
    assert!((found - 0.25).abs() < 1e-6, "{found}");
}

/// Normals whose slopes are Gaussian, with the deviations 0.2 and 0.06 along axes that are turned by 30 degrees.
fn facets() -> MemoryAssets {
    const N: u32 = 64;
    let mut file = format!("PF\n{N} {N}\n-1.0\n").into_bytes();
    let (sin, cos) = 30f32.to_radians().sin_cos();
    for (row, column) in (0..N).flat_map(|row| (0..N).map(move |column| (row, column))) {
        let s = Stream::new(12, [column, row], 0);
        let (angle, length) =
            (std::f32::consts::TAU * s.uniform(0), (-2.0 * (1.0 - s.uniform(1)).ln()).sqrt());
        let (a, b) = (0.2 * length * angle.cos(), 0.06 * length * angle.sin());
        let m = Vec3::new(cos * a - sin * b, sin * a + cos * b, 1.0).normalize();
        file.extend([m.x, m.y, m.z].map(|v| 0.5 + 0.5 * v).into_iter().flat_map(f32::to_le_bytes));
    }
    MemoryAssets::new().with("leaning.pfm", file)
}

/// Facets that are too small to be seen make a surface as rough as it is with each of them on its own: what many samples find without a
/// filter, a few find with one. That leaning facets hide each other, and are seen more or less, is not in it.
#[test]
fn filtered_reliefs_are_as_rough_as_their_facets() {
    let (facets, even) = (facets(), leaning(0.0));
    let [mut farthest, mut without]: [f64; 2] = [0.0; 2];
    for light in [-30.0, -15.0, 0.0, 20.0, 40.0] {
        let radiance = |assets: &MemoryAssets, filter: &str, samples: u32| {
            let material = "Metal m { color 0.9 0.9 0.9  roughness 0.4  distribution beckmann";
            let relief = format!("leaning.pfm {{ filter {filter}  repeat 700 700 }}");
            let scene = floor_with(material, &relief, &sun(light), 60.0, assets);
            mean_of(&Path::new(&scene, PathSettings::default(), SIZE, LayerSet::of(&[])), samples)
        };
        let expected = radiance(&facets, "nearest", 1 << 16);
        let off = |found: f64| (found - expected).abs() / (0.05 + expected);
        for filter in ["ewa", "trilinear", "sat", "feline"] {
            farthest = farthest.max(off(radiance(&facets, filter, 16)));
        }
        without = without.max(off(radiance(&even, "nearest", 16)));
    }
    assert!(farthest < 0.15, "{farthest}");
    assert!(without > 0.5, "as if there were no facets: {without}");
}
