//! No integrator can tell given numbers from drawn ones, so that any can be driven from outside.

use kajo_core::sampler::{SampleStream, Sampler, SamplerKind};
use kajo_core::scene::Scene;
use kajo_core::settings::Settings;
use kajo_math::Vec2;
use kajo_scene::MemoryAssets;

use super::tests::scene_with;
use super::{Defaults, INTEGRATORS, IntegratorSpec, Prepare, SettingsContext};
use crate::context::Splat;
use crate::{Layer, LayerSet, PixelIntegrator, RayCounters, SampleContext};

const SIZE: [u32; 2] = [24, 16];

/// More than any of these samples takes.
const ENOUGH: u32 = 2048;

/// A lens, a moving ball, glass, a mirror, emitters of several kinds and a hole.
fn scene() -> Scene {
    let text =
        "PerspectiveCamera { center 0 1 7 direction 0 -0.1 -1 up 0 1 0 angle 40  aperture 0.2 focus 7 }
         Lights { PointLight { position 2 5 3 color 0.8 0.8 0.7 }
                  DirectionalLight { direction -1 -1 -1 color 0.4 0.4 0.5 angle 5 } }
         Background { color 0.2 0.3 0.5 }
         Materials {
           Matte floor { color 0.7 0.7 0.6 }
           Metal mirror { metal gold roughness 0.2 }
           Glass crystal { indexOfRefraction 1.5 }
           Matte screen { color 0.5 0.5 0.5 opacity 0.4 }
           Matte emitter { color 0 0 0 emission 4 4 3 }
         }
         Group {
           MaterialIndex floor Plane { normal 0 1 0 offset -1 }
           MaterialIndex mirror
           Transform { Motion { key 0 { } key 1 { Translate 0.5 0 0 } } Sphere { center -1.5 0 0 radius 1 } }
           MaterialIndex crystal Sphere { center 1.2 0 1 radius 0.9 }
           MaterialIndex screen Quad { corner -3 -1 2 edge1 1.5 0 0 edge2 0 2 0 }
           MaterialIndex emitter Quad { corner -1 3 -1 edge1 2 0 0 edge2 0 0 2 }
         }";
    scene_with(text, &MemoryAssets::new())
}

fn prepared<'a>(spec: &IntegratorSpec, scene: &'a Scene, said: &Settings) -> Box<dyn PixelIntegrator + 'a> {
    let context = SettingsContext { said, scene, size: [40, 30], defaults: Defaults::Modern, uv: false };
    (spec.settings)(&context).prepare(scene, &scene.output.camera, SIZE, LayerSet::of(&[Layer::Color]))
}

/// All that the sample of number `k` brings, each of another pixel.
fn sample(
    integrator: &dyn PixelIntegrator,
    sampler: &Sampler,
    seed: u64,
    k: u32,
) -> ([f32; 3], Vec<Splat>, RayCounters) {
    let pixel = pixel(k);
    let mut ctx = SampleContext::new(sampler, seed);
    let place = ctx.begin(pixel, k);
    let corner = Vec2::new(pixel[0] as f32, pixel[1] as f32);
    let radiance = integrator.sample(&mut ctx, pixel, corner + place).radiance;
    (radiance, ctx.splats.as_slice().to_vec(), ctx.rays)
}

fn pixel(k: u32) -> [u32; 2] {
    [5 * k % SIZE[0], 7 * k % SIZE[1]]
}

/// The first `n` numbers of a uniform sample, and of the path that is followed beside its own.
fn recorded(seed: u64, k: u32, n: u32) -> Sampler {
    let uniform = Sampler::new(SamplerKind::Uniform, 1);
    let mut draws = SampleStream::new(&uniform, seed, pixel(k), k);
    let numbers = |draws: &SampleStream<'_>| (0..n).map(|d| draws.stream().uniform(d)).collect();
    let path = numbers(&draws);
    draws.film_position();
    Sampler::given(path, numbers(&draws.split(0, 0, 1)))
}

#[test]
fn an_integrator_driven_by_recorded_numbers_gives_the_same_bits() {
    let scene = scene();
    let uniform = Sampler::new(SamplerKind::Uniform, 1);
    let (seed, other) = (5, 99);
    for spec in INTEGRATORS {
        let forks = spec.name.0 == "distribution";
        for is_spectral in [false, true] {
            let said = Settings { spectral: Some(is_spectral), ..Settings::default() };
            let integrator = prepared(spec, &scene, &said);
            let (mut lit, mut by_continuation) = (0, 0);
            for k in 0..150 {
                let expected = sample(&*integrator, &uniform, seed, k);
                let found = |n, seed| sample(&*integrator, &recorded(5, k, n), seed, k);
                // Forks take no numbers that are given, so these hold with the same seed.
                let seed_behind = if forks { seed } else { other };
                assert_eq!(found(ENOUGH, seed_behind), expected, "{} {is_spectral}: {k}", spec.name);
                for n in [0, 1, 6, 23] {
                    assert_eq!(found(n, seed), expected, "{} {is_spectral}: {k}, {n} given", spec.name);
                }
                lit += usize::from(expected.0 != [0.0; 3] || !expected.1.is_empty());
                by_continuation += usize::from(found(2, other) != expected);
            }
            assert!(lit > 60 && by_continuation > 25, "{}: {lit} {by_continuation}", spec.name);
        }
    }
}
