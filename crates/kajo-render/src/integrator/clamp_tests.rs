//! A limit on samples takes away light that was scattered, and says how much.

use kajo_core::sampler::{Sampler, SamplerKind};
use kajo_core::scene::Scene;
use kajo_core::settings::{Settings, SettingsKey, Technique};
use kajo_math::Vec2;
use kajo_scene::MemoryAssets;

use super::tests::scene_with;
use super::{
    Bidirectional, BidirectionalSettings, Defaults, INTEGRATORS, Path, PathSettings, Prepare, SettingsContext,
};
use crate::{
    ClampedLight, Film, FilmSpec, Layer, LayerSet, PixelIntegrator, RenderSettings, SampleContext, Setup,
    Silent, render,
};

const CAMERA: &str = "PerspectiveCamera { center 0 0 8 direction 0 0 -1 up 0 1 0 angle 20 }";

fn scene(text: &str) -> Scene {
    scene_with(&format!("{CAMERA} {text}"), &MemoryAssets::new())
}

/// The mean radiance of a few samples in the middle of the picture, and of what is seen of emitters in them.
fn radiance_and_seen(integrator: &dyn PixelIntegrator) -> [f32; 2] {
    let sampler = Sampler::new(SamplerKind::Sobol, 16);
    let mut ctx = SampleContext::new(&sampler, 0);
    let mut sums = [0.0; 2];
    for k in 0..16 {
        ctx.begin([0, 0], k);
        let sample = integrator.sample(&mut ctx, [0, 0], Vec2::splat(0.5));
        for (sum, light) in sums.iter_mut().zip([sample.radiance, ctx.aux.seen]) {
            *sum += light[0] / 16.0;
        }
    }
    sums
}

/// Runs over every integrator that knows the limit, with its state if it has one.
fn for_each_integrator(scene: &Scene, mut visit: impl FnMut(&str, &dyn PixelIntegrator)) {
    let said = Settings { photons: Some(1000), ..Settings::default() };
    for spec in INTEGRATORS.into_iter().filter(|spec| spec.keys.contains(&SettingsKey::Clamp)) {
        let context =
            SettingsContext { said: &said, scene, size: [1, 1], defaults: Defaults::Modern, uv: false };
        let settings = (spec.settings)(&context);
        let integrator = settings.prepare(scene, &scene.output.camera, [1, 1], LayerSet::of(&[Layer::Color]));
        if integrator.samples_per_state().is_none() {
            visit(spec.name.0, &*integrator);
            continue;
        }
        let setup = Setup { seed: 0, threads: 1, memory: u64::MAX, progress: &Silent };
        let with_state = integrator.with_state(0, &setup).expect("a state");
        visit(spec.name.0, &*with_state.integrator);
    }
}

#[test]
fn emitters_are_seen_straight_and_by_way_of_mirrors_and_glass() {
    let quad = "Quad { corner -9 -9 0  edge1 18 0 0  edge2 0 18 0 }";
    let sky = "Background { color 3 3 3 }";
    let seen = [
        format!("{sky} Group {{ }}"),
        format!(
            "Materials {{ Matte emitter {{ color 0 0 0  emission 3 3 3 }} }} Group {{ MaterialIndex emitter {quad} }}"
        ),
        format!("{sky} Materials {{ Metal mirror {{ }} }} Group {{ MaterialIndex mirror {quad} }}"),
        format!(
            "{sky} Materials {{ Glass clear {{ indexOfRefraction 1.5 }} }}
             Group {{ MaterialIndex clear Sphere {{ center 0 0 0  radius 2 }} }}"
        ),
    ];
    for text in &seen {
        let scene = scene(text);
        for_each_integrator(&scene, |name, integrator| {
            let [radiance, seen] = radiance_and_seen(integrator);
            // By `light` what is seen in mirrors is no part of the picture.
            assert!(radiance > 0.5 || name == "light", "{name}: {radiance} of {text}");
            assert!((radiance - seen).abs() <= 1e-5 * radiance, "{name}: {seen} of {radiance} of {text}");
        });
    }
}

#[test]
fn what_is_scattered_is_not_seen_of_emitters() {
    let matte = "Background { color 3 3 3 } Materials { Matte white { color 0.8 0.8 0.8 } }
        Group { MaterialIndex white Quad { corner -9 -9 0  edge1 18 0 0  edge2 0 18 0 } }";
    let rough = "Background { color 3 3 3 } Materials { Metal rough { roughness 0.3 } }
        Group { MaterialIndex rough Quad { corner -9 -9 0  edge1 18 0 0  edge2 0 18 0 } }";
    let fog =
        "Background { color 3 3 3 } Media { Medium fog { density 3 } } Materials { Interface air { medium fog } }
        Group { MaterialIndex air Box { min -3 -3 -3  max 3 3 3 } }";
    for text in [matte, rough, fog] {
        let scene = scene(text);
        for_each_integrator(&scene, |name, integrator| {
            let [radiance, seen] = radiance_and_seen(integrator);
            let share = if text == fog { 0.01 } else { 0.0 };
            assert!(seen <= share * radiance, "{name}: {seen} of {radiance} of {text}");
        });
    }
}

/// A floor under a small bright ball, whose light comes rarely and much at once where nothing but scattering finds it.
fn with_fireflies() -> Scene {
    scene(
        "Materials { Matte floor { color 0.5 0.6 0.7 }  Matte emitter { color 0 0 0  emission 100 75 25 } }
         Group {
             MaterialIndex floor Quad { corner -4 -1 4  edge1 8 0 0  edge2 0 0 -8 }
             MaterialIndex emitter  Sphere { center 0 0.4 0  radius 0.2 }
         }",
    )
}

fn film_of(integrator: &dyn PixelIntegrator, spec: FilmSpec, threads: usize) -> Film {
    let film = Film::new(spec, u64::MAX).expect("a film");
    let sampler = Sampler::new(SamplerKind::Sobol, 16);
    let settings = RenderSettings { threads, tile: 5, ..RenderSettings::new(sampler) };
    render(integrator, &film, &settings, &Silent).expect("a render");
    film
}

/// The mean of a picture, red, green and blue.
fn mean(film: &Film) -> [f64; 3] {
    let picture = film.develop(Layer::Color).expect("colour");
    let sum = |c: usize| picture.pixels().map(|pixel| f64::from(pixel[c])).sum::<f64>();
    [0, 1, 2].map(|c| sum(c) / picture.pixels().count() as f64)
}

#[test]
fn what_is_taken_is_what_the_picture_lacks() {
    let scene = with_fireflies();
    let (size, layers) = ([24, 18], LayerSet::of(&[Layer::Color]));
    let by_chance = PathSettings { technique: Technique::Scattering, ..PathSettings::default() };
    let from_lights = BidirectionalSettings::default();
    let path = Path::new(&scene, by_chance, size, layers);
    let bidirectional = Bidirectional::new(&scene, from_lights, size, layers);
    let integrators: [&dyn PixelIntegrator; 2] = [&path, &bidirectional];
    for (integrator, limit) in integrators.into_iter().zip([3.0, 0.02]) {
        let plain = FilmSpec { layers, ..FilmSpec::new(size[0], size[1]) };
        let spec = FilmSpec { clamp: Some(limit), ..plain };
        let (whole, limited) = (film_of(integrator, plain, 1), film_of(integrator, spec, 1));
        assert_eq!(whole.clamped(), None);
        let ClampedLight { count, taken, .. } = limited.clamped().expect("a limit");
        assert!(count > 5 && taken.iter().all(|&share| share > 0.02 && share < 0.98), "{count} {taken:?}");
        let (before, after) = (mean(&whole), mean(&limited));
        for c in 0..3 {
            let lacks = 1.0 - after[c] / before[c];
            assert!((lacks - taken[c]).abs() < 1e-5, "{lacks} is lacking, {} was taken", taken[c]);
        }
        let again = film_of(integrator, spec, 3);
        assert_eq!(again.clamped(), limited.clamped());
        assert_eq!(mean(&again), after);
        let loose = FilmSpec { clamp: Some(1e9), ..plain };
        let loose = film_of(integrator, loose, 1);
        assert_eq!(loose.clamped().map(|light| light.count), Some(0));
        assert_eq!(mean(&loose), before);
    }
}

/// The emitter itself stays as bright as it is.
#[test]
fn no_pixel_but_those_of_emitters_is_above_the_limit() {
    let scene = with_fireflies();
    let (size, layers) = ([24, 18], LayerSet::of(&[Layer::Color]));
    let by_chance = PathSettings { technique: Technique::Scattering, ..PathSettings::default() };
    let path = Path::new(&scene, by_chance, size, layers);
    let spec = FilmSpec { layers, clamp: Some(0.5), ..FilmSpec::new(size[0], size[1]) };
    let film = film_of(&path, spec, 1);
    let picture = film.develop(Layer::Color).expect("colour");
    let mut reds: Vec<f32> = picture.pixels().map(|pixel| pixel[0]).collect();
    reds.sort_by(f32::total_cmp);
    let bright = reds.iter().filter(|&&red| red > 0.501).count();
    assert!((1..16).contains(&bright) && reds[reds.len() - 1] > 90.0, "{bright} pixels: {reds:?}");
}
