//! Solids made of others, through integrators: what moves within them, and liquids in their vessels.

use kajo_core::sampler::{Sampler, SamplerKind};
use kajo_core::scene::Scene;
use kajo_math::Vec2;
use kajo_math::rng::Stream;
use kajo_scene::MemoryAssets;

use super::tests::scene_with;
use super::{Path, PathSettings};
use crate::{LayerSet, PixelIntegrator, SampleContext};

const SIZE: [u32; 2] = [24, 16];

/// The mean of many samples of a pixel's middle.
fn mean(scene: &Scene, [x, y]: [u32; 2], samples: u32, seed: u32) -> f64 {
    let path = Path::new(scene, PathSettings::default(), SIZE, LayerSet::of(&[]));
    let sampler = Sampler::new(SamplerKind::Uniform, samples);
    let mut ctx = SampleContext::new(&sampler, seed.into());
    let radiance = |k: u32| {
        let within = ctx.begin([x, y], k);
        let place = Vec2::new(x as f32, y as f32) + within;
        path.sample(&mut ctx, [x, y], place).radiance.iter().map(|&v| f64::from(v)).sum::<f64>() / 3.0
    };
    (0..samples).map(radiance).sum::<f64>() / f64::from(samples)
}

/// The mean of values, and the square of its error.
fn estimate(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let spread = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>();
    (mean, spread / (n * (n - 1.0)))
}

/// A bowl that is hollowed out while the shutter is open, on a floor, in the light of a panel and of its own.
fn bowl(there: [&str; 2]) -> Scene {
    let [hole, cut] = there;
    scene_with(
        &format!(
            "PerspectiveCamera {{ center 0 2.5 5  direction 0 -0.45 -1  up 0 1 0  angle 30 }}
             Background {{ color 0.1 0.1 0.1 }}
             Materials {{ Matte grey {{ color 0.6 0.6 0.6 }}  Matte panel {{ color 0 0 0  emission 9 9 9 }}
               Matte bright {{ color 0.2 0.2 0.2  emission 1.5 1.5 1.5 }} }}
             Group {{ MaterialIndex grey  Plane {{ normal 0 1 0  offset -0.6 }}
               Difference {{ Sphere {{ center 0 0 0  radius 0.8 }}
                 MaterialIndex bright  Transform {{ {hole}  Sphere {{ center 0 0.6 0.1  radius 0.6 }} }}
                 MaterialIndex grey  Transform {{ {cut}  Plane {{ normal 1 0 0  offset -0.75 }} }} }}
               MaterialIndex panel  Quad {{ corner -1 3 -1  edge1 2 0 0  edge2 0 0 2 }} }}"
        ),
        &MemoryAssets::new(),
    )
}

/// A moving picture is the mean of what stands still: shape, shadows, and light of what moves.
#[test]
fn the_blur_of_operands_is_the_mean_of_their_stills() {
    let motion = |by: &str| format!("Motion {{ key 0 {{ }} key 1 {{ Translate {by} }} }}");
    let moving = bowl([&motion("0.8 0.2 0.4"), &motion("0.5 0 0")]);
    const STILLS: u32 = 240;
    let stills: Vec<Scene> = (0..STILLS)
        .map(|k| {
            // One moment in each of so many parts of the time.
            let t = (k as f32 + Stream::new(3, [k, 0], 0).uniform(0)) / STILLS as f32;
            let hole = format!("Translate {} {} {}", 0.8 * t, 0.2 * t, 0.4 * t);
            bowl([&hole, &format!("Translate {} 0 0", 0.5 * t)])
        })
        .collect();
    let mut blurred = 0;
    for pixel in [[12, 6], [10, 7], [14, 7], [15, 9], [8, 8], [7, 10], [12, 11], [17, 11]] {
        let runs: Vec<f64> = (0..STILLS).map(|k| mean(&moving, pixel, 40, 100 + k)).collect();
        let each: Vec<f64> = (0..).zip(&stills).map(|(k, still)| mean(still, pixel, 40, 900 + k)).collect();
        let ((a, error_a), (b, error_b)) = (estimate(&runs), estimate(&each));
        let sigma = (error_a + error_b).sqrt();
        assert!((a - b).abs() < 4.5 * sigma, "{pixel:?}: {a} for {b}, off by {}", (a - b) / sigma);
        // The stills differ from each other by more than their noise.
        let half = each.len() / 2;
        let (first, last) = (estimate(&each[..half]), estimate(&each[half..]));
        blurred += u32::from((first.0 - last.0).abs() > 8.0 * (first.1 + last.1).sqrt());
    }
    assert!(blurred >= 4, "{blurred}");
}

/// A ring before a wall of two colours: of glass, or a shell with something in it.
fn ring(content: &str) -> Scene {
    scene_with(
        &format!(
            "PerspectiveCamera {{ center 0 0 7  direction 0 0 -1  up 0 1 0  angle 26 }}
             Background {{ color 0.05 0.05 0.05 }}
             Materials {{ Matte left {{ color 0 0 0  emission 2 2 2 }}  Matte right {{ color 0 0 0  emission 0.4 0.4 0.4 }}
               Glass shell {{ indexOfRefraction 1.5  priority 2 }}  Glass same {{ indexOfRefraction 1.5  priority 1 }}
               Glass water {{ indexOfRefraction 1.33  priority 1 }} }}
             Group {{ MaterialIndex left  Quad {{ corner -9 0.2 -3  edge1 18 0 0  edge2 0 9 0 }}
               MaterialIndex right  Quad {{ corner -9 -9 -3  edge1 18 0 0  edge2 0 9.2 0 }} {content} }}"
        ),
        &MemoryAssets::new(),
    )
}

/// A liquid that overlaps with its vessel has one surface in common with it: filled with what it is made of, a hollow ring is a
/// solid one.
#[test]
fn a_ring_filled_with_its_own_glass_is_a_solid_one() {
    let tube = |radius: f64| format!("Torus {{ axis 0 0 1  majorRadius 1  minorRadius {radius} }}");
    let shell = format!("MaterialIndex shell  Difference {{ {} {} }}", tube(0.5), tube(0.4));
    let solid = ring(&format!("MaterialIndex shell  {}", tube(0.5)));
    let filled = ring(&format!("{shell}  MaterialIndex same  {}", tube(0.45)));
    let half = ring(&format!(
        "{shell}  MaterialIndex same  Intersection {{ {} Plane {{ normal 0 1 0  offset 0.2 }} }}
         Difference {{ {} Plane {{ normal 0 1 0  offset 0.1 }} }}",
        tube(0.45),
        tube(0.45)
    ));
    let gap = ring(&format!("{shell}  MaterialIndex same  {}", tube(0.39)));
    let water = ring(&format!("{shell}  MaterialIndex water  {}", tube(0.45)));
    let mut differ = [0; 2];
    for pixel in [[12, 2], [12, 3], [6, 8], [5, 5], [18, 8], [8, 12], [12, 13], [16, 4]] {
        let of = |scene: &Scene, seed: u32| {
            estimate(&(0..40).map(|k| mean(scene, pixel, 60, seed + k)).collect::<Vec<_>>())
        };
        let (expected, error) = of(&solid, 1);
        let off = |scene: &Scene, seed: u32| {
            let (found, error_found) = of(scene, seed);
            (found - expected).abs() / (error + error_found).sqrt().max(1e-5)
        };
        let (by_filled, by_half) = (off(&filled, 200), off(&half, 400));
        assert!(by_filled < 4.5 && by_half < 4.5, "{pixel:?}: {by_filled} {by_half} standard errors off");
        differ[0] += u32::from(off(&gap, 600) > 10.0);
        differ[1] += u32::from(off(&water, 800) > 10.0);
    }
    assert!(differ[0] >= 2 && differ[1] >= 1, "{differ:?}");
}
