//! How fast merging converges, on light that it finds alone: the caustic of a ball of glass, seen through a pane.
//!
//! Parallel light of the irradiance 1 along z meets a ball of index 1.5 and radius 1 about the origin at the height `h` over its axis, with
//! `sin i = h = 1.5 sin r`, and a screen at z = 2 at the distance `x(h)` from the axis, which has the irradiance
//!
//! ```text
//! E(x) = (1 - F)^2 h dh / (x dx)
//! ```
//!
//! With disks whose area goes as `i^(alpha - 1)` the squared error of the mean of `n` passes has the parts
//!
//! ```text
//! noise  n^-alpha,     blur  n^(2 alpha - 2)
//! ```
//!
//! which both go as `n^(-2/3)` where `alpha` is 2/3 [Knaus and Zwicker 2011].

use std::f64::consts::PI;

use kajo_core::sampler::{Sampler, SamplerKind};
use kajo_scene::MemoryAssets;

use super::*;
use crate::Silent;
use crate::integrator::tests::scene_with;

/// Side of the picture in pixels.
const SIDE: u32 = 24;

/// Half the width of what is seen of the screen; the camera looks at it at 60 degrees, so half its height is twice as much.
const HALF: f64 = 0.4;

const SCREEN: f64 = 2.0;
const INDEX: f64 = 1.5;
const ALBEDO: f64 = 0.8;

/// Distance from the axis at which a ray meets the screen, and the share of it that arrives.
fn landing(h: f64) -> (f64, f64) {
    let (i, r) = (h.asin(), (h / INDEX).asin());
    let (ci, cr) = (i.cos(), r.cos());
    let (s, p) = ((ci - INDEX * cr) / (ci + INDEX * cr), (INDEX * ci - cr) / (INDEX * ci + cr));
    let (leaves, bent) = (2.0 * r - i, 2.0 * (i - r));
    let x = leaves.sin() - bent.tan() * (SCREEN - leaves.cos());
    (x.abs(), (1.0 - 0.5 * (s * s + p * p)).powi(2))
}

/// Irradiance in rings of the width 0.002 around the axis.
fn irradiances() -> Vec<f64> {
    const WIDTH: f64 = 2e-3;
    const STEPS: u32 = 1 << 20;
    let mut rings = vec![0.0; 500];
    for k in 0..STEPS {
        let h = (f64::from(k) + 0.5) / f64::from(STEPS);
        let (x, share) = landing(h);
        if let Some(ring) = rings.get_mut((x / WIDTH) as usize) {
            *ring += share * 2.0 * PI * h / f64::from(STEPS);
        }
    }
    let area = |i: usize| PI * WIDTH * WIDTH * (2 * i + 1) as f64;
    rings.iter().enumerate().map(|(i, flux)| flux / area(i)).collect()
}

/// Radiance of each pixel, as the mean of 8 x 8 places.
fn expected() -> Vec<f64> {
    let rings = irradiances();
    for (x, expected) in [(0.1, 5.679), (0.2, 3.014), (0.3, 1.697), (0.5, 0.666), (0.7, 0.3129)] {
        let found: f64 = rings[(x / 2e-3) as usize];
        assert!((found / expected - 1.0).abs() < 0.02, "{x}: {found} for {expected}");
    }
    let place = |i: u32, half: f64| half * (2.0 * (f64::from(i) + 0.5) / f64::from(8 * SIDE) - 1.0);
    let mut pixels = vec![0.0; (SIDE * SIDE) as usize];
    for (i, j) in (0..8 * SIDE).flat_map(|j| (0..8 * SIDE).map(move |i| (i, j))) {
        let x = place(i, HALF).hypot(place(j, 2.0 * HALF));
        pixels[(i / 8 + SIDE * (j / 8)) as usize] += ALBEDO / PI * rings[(x / 2e-3) as usize] / 64.0;
    }
    pixels
}

fn caustic() -> Scene {
    let (sin, cos) = (0.75f64.sqrt(), 0.5);
    let text = format!(
        "OrthographicCamera {{ center 0 {} {}  direction 0 {sin} {cos}  up 0 {cos} {}  size {} }}
         Background {{ color 0 0 0 }}
         Lights {{ DirectionalLight {{ direction 0 0 1  irradiance 1 }} }}
         Materials {{ Glass glass {{ indexOfRefraction {INDEX} }}  Glass pane {{ indexOfRefraction 1.0001 }}
                      Matte screen {{ color {ALBEDO} {ALBEDO} {ALBEDO} }} }}
         Group {{ MaterialIndex glass Sphere {{ center 0 0 0  radius 1 }}
                  MaterialIndex pane Box {{ min -1 -2.2 0  max 1 -2.1 2 }}
                  MaterialIndex screen Disk {{ center 0 0 {SCREEN}  normal 0 0 -1  radius 0.95 }} }}",
        -3.0 * sin,
        SCREEN - 3.0 * cos,
        -sin,
        2.0 * HALF
    );
    scene_with(&text, &MemoryAssets::new())
}

/// Squared errors over the squared light of the picture after 8, 16, ... passes.
fn errors(integrator: &dyn PixelIntegrator, expected: &[f64], passes: u32, seed: u64) -> Vec<f64> {
    let sampler = Sampler::new(SamplerKind::Uniform, passes);
    let setup = Setup { seed, threads: 1, memory: u64::MAX, progress: &Silent };
    let mut sums = vec![0.0; expected.len()];
    let mut errors = Vec::new();
    let mut ctx = SampleContext::new(&sampler, seed);
    for i in 0..passes {
        let pass = integrator.with_state(i, &setup).unwrap_or_else(|error| panic!("{error}")).integrator;
        for (pixel, sum) in sums.iter_mut().enumerate() {
            let [x, y] = [pixel as u32 % SIDE, pixel as u32 / SIDE];
            let place = ctx.begin([x, y], i) + Vec2::new(x as f32, y as f32);
            *sum += f64::from(pass.sample(&mut ctx, [x, y], place).radiance[0]);
        }
        let n = i + 1;
        if n >= 8 && n.is_power_of_two() {
            let error = |(sum, expected): (&f64, &f64)| (sum / f64::from(n) - expected).powi(2);
            let light: f64 = expected.iter().map(|x| x * x).sum();
            errors.push(sums.iter().zip(expected).map(error).sum::<f64>() / light);
        }
    }
    errors
}

/// The slope of the line of least squares through the logarithms of errors after twice as many passes each.
fn slope(errors: &[f64]) -> f64 {
    let middle = 0.5 * (errors.len() - 1) as f64;
    let from_middle = |k: usize| k as f64 - middle;
    let along: f64 = (0..errors.len()).map(|k| from_middle(k).powi(2)).sum();
    errors.iter().enumerate().map(|(k, error)| from_middle(k) * error.log2()).sum::<f64>() / along
}

#[test]
fn the_error_falls_as_the_power_two_thirds_of_the_passes() {
    let scene = caustic();
    let settings = VertexMergingSettings {
        photons: 10_000,
        bounces: 4,
        radius: 0.08,
        alpha: 2.0 / 3.0,
        ..Default::default()
    };
    let layers = LayerSet::of(&[]);
    let made = |settings| integrator_of(&scene.output.camera, &scene, settings, [SIDE, SIDE], layers);
    let expected = expected();
    let [seeds, passes]: [u32; 2] = if kajo_testkit::is_deep() { [16, 1024] } else { [4, 256] };
    let merged = made(settings);
    let mut sums = vec![0.0; passes.ilog2() as usize - 2];
    for seed in 0..seeds {
        let found = errors(&*merged, &expected, passes, seed.into());
        sums.iter_mut().zip(found).for_each(|(sum, error)| *sum += error / f64::from(seeds));
    }
    let slope = slope(&sums);
    assert!((slope + 2.0 / 3.0).abs() < 0.1, "slope {slope} of {sums:?}");
    // Without merging there is nothing.
    let joined = made(VertexMergingSettings { merging: false, ..settings });
    let sampler = Sampler::new(SamplerKind::Uniform, 1);
    let mut ctx = SampleContext::new(&sampler, 0);
    let place = ctx.begin([9, 9], 0) + Vec2::new(9.0, 9.0);
    assert_eq!(joined.sample(&mut ctx, [9, 9], place).radiance, [0.0; 3]);
}
