//! Guided paths against paths by scattering.

use kajo_core::sampler::{Sampler, SamplerKind};
use kajo_image::Image;
use kajo_scene::MemoryAssets;
use kajo_testkit::every;

use super::field::Known;
use super::*;
use crate::integrator::same_picture::assert_same_picture;
use crate::integrator::tests::scene_with;
use crate::{Film, FilmSpec, Layer, PixelIntegrator, RenderSettings, Silent, render};

const SIZE: [u32; 2] = [24, 16];

/// A room that is lit through a gap in a wall, with a mirror, something glossy and a pane.
const ROOM: &str = "PerspectiveCamera { center 0 0 0.9 direction 0.3 -0.2 -1 up 0 1 0 angle 70 }
    Background { color 0 0 0 }
    Materials {
        Matte white { color 0.7 0.7 0.6 }
        Matte emitter { color 0 0 0 emission 20 16 10 }
        Metal steel { metal iron roughness 0.2 }
        Metal mirror { metal silver roughness 0 }
        Principled coated { color 0.6 0.2 0.1 coat 1 roughness 0.4 }
    }
    Group {
        MaterialIndex white
        Box { min -1 -1 -1 max 2.5 1 1 }
        Box { min 0.98 -1 -0.4 max 1.02 1 1 }
        MaterialIndex emitter
        Sphere { center 1.7 0.4 0.5 radius 0.3 }
        MaterialIndex steel
        Sphere { center -0.3 -0.7 -0.4 radius 0.3 }
        MaterialIndex coated
        Sphere { center 0.5 -0.8 -0.2 radius 0.2 }
        MaterialIndex mirror
        Sphere { center -0.6 -0.8 0.2 radius 0.2 }
    }";

/// A closed sphere whose surface emits and reflects half of what comes: the radiance is 1 everywhere.
const FURNACE: &str = "PerspectiveCamera { center 0.2 0.1 -0.1 direction 0.7 -0.3 0.5 up 0 1 0 angle 70 }
    Background { color 0 0 0 }
    Materials { Matte m { color 0.5 0.5 0.5 emission 0.5 0.5 0.5 } }
    Group { MaterialIndex m Sphere { center 0 0 0 radius 1 } }";

/// Haze and a ball of glass below an emitter and a sky.
const HAZE: &str = "PerspectiveCamera { center 0 0.5 3 direction 0 -0.1 -1 up 0 1 0 angle 50 }
    Background { color 0.1 0.15 0.2 }
    Media { Medium fog { sigma_s 0.1 } exterior fog }
    Materials {
        Matte floor { color 0.6 0.6 0.6 }
        Matte emitter { color 0 0 0 emission 8 8 8 }
        Glass glass { indexOfRefraction 1.5 }
        Principled leaf { color 0.3 0.6 0.1 transmission 0.5 roughness 0.4 thin on }
    }
    Group {
        MaterialIndex floor Quad { corner -3 -0.5 -3 edge1 0 0 6 edge2 6 0 0 }
        MaterialIndex emitter Sphere { center 0.8 1.5 0 radius 0.3 }
        MaterialIndex glass Sphere { center -0.5 0 0 radius 0.5 }
        MaterialIndex leaf Quad { corner 0 -0.5 0.5 edge1 0.5 0.5 0 edge2 0 0.5 0.2 }
    }";

fn scene(text: &str) -> Scene {
    scene_with(text, &MemoryAssets::new())
}

fn settings(training: u32) -> PathSettings {
    PathSettings { guiding: true, training, bounces: 12, ..PathSettings::default() }
}

fn setup(seed: u64) -> Setup<'static> {
    Setup { seed, threads: 2, memory: 1 << 28, progress: &Silent }
}

fn guided(scene: &Scene, settings: PathSettings) -> GuidedPath<'_> {
    GuidedPath::through(&scene.output.camera, scene, settings, SIZE, LayerSet::of(&[Layer::Color]))
}

/// The same, guided whether that is of use or not.
fn always_guided(scene: &Scene, settings: PathSettings) -> GuidedPath<'_> {
    GuidedPath { least_gain: f64::NEG_INFINITY, ..guided(scene, settings) }
}

/// * `seed`: of the training, and of the picture
fn guided_picture(path: &GuidedPath<'_>, samples: u32, seed: u64) -> Image {
    let trained = learned(path, &setup(seed));
    assert!(trained.notes.is_empty() && trained.rays.total() > 0, "{:?}", trained.notes);
    picture(&*trained.integrator, &schedule(samples, seed))
}

fn learned<'a>(path: &'a GuidedPath<'_>, setup: &Setup<'_>) -> WithState<'a> {
    Integrator::with_state(path, 0, setup).unwrap()
}

fn notes(path: &GuidedPath<'_>) -> Vec<String> {
    learned(path, &setup(0)).notes
}

fn schedule(samples: u32, seed: u64) -> RenderSettings {
    RenderSettings { threads: 2, seed, ..RenderSettings::new(Sampler::new(SamplerKind::Sobol, samples)) }
}

fn picture(integrator: &dyn PixelIntegrator, schedule: &RenderSettings) -> Image {
    let layers = LayerSet::of(&[Layer::Color]);
    let film = Film::new(FilmSpec { layers, ..FilmSpec::new(SIZE[0], SIZE[1]) }, u64::MAX).unwrap();
    render(integrator, &film, schedule, &Silent).unwrap();
    film.develop(Layer::Color).unwrap()
}

fn mean(picture: &Image) -> f64 {
    let data = picture.data();
    data.iter().map(|&v| f64::from(v)).sum::<f64>() / data.len() as f64
}

/// The mean of pictures of several seeds, with its standard error.
fn estimate(mut of: impl FnMut(u64) -> Image) -> (f64, f64) {
    let means: Vec<f64> = (0..16).map(|seed| mean(&of(seed))).collect();
    let n = means.len() as f64;
    let all = means.iter().sum::<f64>() / n;
    let variance = means.iter().map(|m| (m - all) * (m - all)).sum::<f64>() / (n - 1.0);
    (all, (variance / n).sqrt())
}

#[test]
fn guided_paths_have_the_mean_of_others() {
    for (text, spectral) in every(2, [(ROOM, true), (FURNACE, false), (HAZE, false), (ROOM, false)]) {
        let scene = scene(text);
        let settings = PathSettings { spectral, ..settings(100) };
        let path = always_guided(&scene, settings);
        let plain = estimate(|seed| picture(&path.path, &schedule(32, seed)));
        let with = estimate(|seed| guided_picture(&path, 32, seed + 100));
        let sigma = plain.1.hypot(with.1);
        assert!(plain.0 > 0.0 && (plain.0 - with.0).abs() < 4.0 * sigma, "{plain:?} {with:?}\n{text}");
    }
}

/// `1 - 2^-13` with so many bounces.
#[test]
fn a_furnace_is_white_by_guided_paths() {
    let scene = scene(FURNACE);
    let path = always_guided(&scene, settings(200));
    let (found, error) = estimate(|seed| guided_picture(&path, 16, seed));
    assert!((found - 1.0).abs() < 4.0 * error + 2e-4 && error < 5e-3, "{found} +- {error}");
}

#[test]
fn a_room_behind_a_gap_is_less_noisy_with_a_guide() {
    let scene = scene(ROOM);
    let path = always_guided(&scene, settings(600));
    let noise = |of: &dyn Fn(u64) -> Image| {
        let [a, b] = [1, 2].map(of);
        let scale = mean(&a) + mean(&b);
        let pairs = a.data().iter().zip(b.data()).map(|(a, b)| f64::from(a - b).powi(2));
        pairs.sum::<f64>() / (scale * scale)
    };
    let with = noise(&|seed| guided_picture(&path, 64, seed));
    let without = noise(&|seed| picture(&path.path, &schedule(64, seed)));
    assert!(with < 0.75 * without, "{with} {without}");
}

#[test]
fn a_guide_of_no_use_is_left_and_changes_nothing() {
    let scene = scene(FURNACE);
    let path = guided(&scene, settings(100));
    let with_state = learned(&path, &setup(0));
    assert!(with_state.notes[0].contains("less noisy"), "{:?}", with_state.notes);
    let bits = |integrator: &dyn PixelIntegrator| -> Vec<u32> {
        picture(integrator, &schedule(4, 0)).data().iter().map(|v| v.to_bits()).collect()
    };
    assert_eq!(bits(&*with_state.integrator), bits(&path.path));
    // Of one sample for each of these few pixels nothing can be learned, and nothing without any light.
    let few = notes(&guided(&scene, settings(1)));
    assert!(few[0].contains("too few samples"), "{few:?}");
    let dark = scene_with(&ROOM.replace("20 16 10", "0 0 0"), &MemoryAssets::new());
    let dark = notes(&guided(&dark, settings(100)));
    assert!(dark[0].contains("no path has found any light"), "{dark:?}");
}

/// A path that is expected to add as much as its whole sample goes on, one that adds less ends now and then, one that adds more splits.
#[test]
fn paths_are_followed_by_what_they_are_worth() {
    let known = Known { records: 100.0, x: 100.0, squares: 100.0, energy: 100.0, ..Known::default() };
    let cell = |light: f32| Cell { guide: Some(0), share: 0.5, light, direct: 1.0, known };
    let field = Field::new(kajo_math::Aabb { min: Vec3::ZERO, max: Vec3::ONE });
    let mut guide = Guide::new(&field);
    // The first one sends 4 (1 + 1) to the camera, half of which is light that was scattered before.
    assert_eq!(guide.worth_of(4.0, &cell(1.0)), Worth::Splits(1));
    assert_eq!(guide.worth_of(1.0, &cell(8.0)), Worth::Splits(1));
    let Worth::Survives(q) = guide.worth_of(1.0, &cell(0.8)) else { panic!() };
    assert!((q - 0.3).abs() < 1e-6, "{q}");
    assert_eq!(guide.worth_of(0.0, &cell(1.0)), Worth::Survives(LEAST_SURVIVAL));
    assert_eq!(guide.worth_of(4.0, &cell(8.5)), Worth::Splits(4));
    assert_eq!(guide.worth_of(f32::NAN, &cell(1.0)), Worth::Unknown);
    // Little is known of a cell with few records.
    let known = Known { x: 2.0, squares: 2.0, ..known };
    assert_eq!(guide.worth_of(1.0, &Cell { known, ..cell(1.0) }), Worth::Unknown);
    // Branches are counted.
    let branches: u32 = (0..100)
        .map(|_| guide.worth_of(1.0, &cell(1e6)))
        .map(|worth| if let Worth::Splits(n) = worth { n - 1 } else { 0 })
        .sum();
    assert_eq!(branches, MOST_BRANCHES - 3);
}

#[test]
fn a_guided_picture_is_the_same_for_any_threads_and_splits() {
    let scene = scene(ROOM);
    let path = always_guided(&scene, settings(100));
    let schedule = schedule(8, 3);
    let [plain, with] = [picture(&path.path, &schedule), guided_picture(&path, 8, 3)];
    assert_ne!(plain.data(), with.data(), "it is guided");
    assert_same_picture(&path, SIZE, &schedule, [40, 25]);
}

/// With no memory at all what is learned is little, and nothing breaks.
#[test]
fn a_guide_keeps_to_its_memory() {
    let scene = scene(ROOM);
    let path = guided(&scene, settings(100));
    for memory in [0, 1 << 16, 1 << 20] {
        let setup = Setup { memory, ..setup(0) };
        let outcome = Training::new(&path.plain, None, 100, &setup).learn(f64::NEG_INFINITY).unwrap();
        let field = outcome.field.unwrap();
        let bytes = field.nodes.len() * size_of::<quadtree::Node>();
        assert!(bytes as u64 <= memory.max(1 << 16), "{memory}: {bytes}");
    }
}

/// A branch is not judged by what the one before it came to.
#[test]
fn branches_are_worth_what_their_path_was() {
    let field = Field::new(kajo_math::Aabb { min: Vec3::ZERO, max: Vec3::ONE });
    let mut guide = Guide::new(&field);
    guide.comes_to(Vec3::splat(0.5), Vec3::Z, Spectrum::WHITE);
    guide.forks();
    guide.comes_to_unguided();
    assert_eq!((guide.worth(), guide.share_of_scattering()), (Worth::Unknown, None));
    guide.takes_branch(true);
    assert_eq!(guide.worth(), Worth::Splits(1));
    assert!(guide.share_of_scattering().is_some());
}
