//! No sample lasts for ever: paths meet a bounded number of surfaces, fork into a bounded number of others, and are
//! given up when the render is to stop.

use std::sync::atomic::{AtomicUsize, Ordering};

use kajo_color::Reflectance;
use kajo_core::RayOffset;
use kajo_core::background::Background;
use kajo_core::builder::{SceneBuilder, SceneError};
use kajo_core::camera::{CameraFrame, PerspectiveCamera};
use kajo_core::ids::PoseId;
use kajo_core::material::{Matte, Perforated};
use kajo_core::sampler::{Sampler, SamplerKind};
use kajo_core::scene::Scene;
use kajo_core::settings::Settings;
use kajo_core::shape::Triangle;
use kajo_math::{DVec3, Vec2, Vec3};
use kajo_scene::MemoryAssets;

use super::tests::{plain, scene_with};
use super::transport::steps::MOST_SURFACES;
use super::{Bidirectional, BidirectionalSettings, Classic, ClassicSettings, Path, PathSettings};
use crate::{
    Film, FilmSpec, LayerSet, PixelIntegrator, Progress, RayCounters, RenderError, RenderSettings,
    SampleContext, render,
};

const CAMERA: &str = "PerspectiveCamera { center 0 0 8 direction 0 0 -1 up 0 1 0 angle 20 }";

/// The sample in the middle of the picture's only pixel.
fn sample(integrator: &dyn PixelIntegrator) -> ([f32; 3], RayCounters) {
    let sampler = Sampler::new(SamplerKind::Regular, 1);
    let mut ctx = SampleContext::new(&sampler, 0);
    ctx.begin([0, 0], 0);
    let sample = integrator.sample(&mut ctx, [0, 0], Vec2::splat(0.5));
    (sample.radiance, ctx.rays)
}

/// A white sky behind a stack of sheets that are cut out altogether.
fn behind_holes(sheets: u32) -> Result<Scene, SceneError> {
    let mut scene = SceneBuilder::default();
    scene.background(Background::constant([1.0; 3]))?;
    let red = scene.material(Matte::new(Reflectance::from_rgb([1.0, 0.0, 0.0]), 0.0))?;
    let hole = scene.material(Perforated { material: red, opacity: 0.0.into() })?;
    let [low, right, high] = [(-900.0, -900.0), (900.0, -900.0), (0.0, 900.0)];
    for i in 0..sheets {
        let z = -1e-2 * i as f32;
        let vertices = [low, right, high].map(|(x, y)| Vec3::new(x, y, z));
        let sheet = scene.shape(Triangle { vertices, uvs: [Vec2::ZERO; 3] })?;
        scene.object(sheet, hole, PoseId::IDENTITY)?;
    }
    let frame = CameraFrame::new(8.0 * DVec3::Z, DVec3::NEG_Z, DVec3::Y);
    scene.camera(PerspectiveCamera::new(frame, 0.3))?;
    scene.finish(Settings::default())
}

#[test]
fn a_path_passes_many_holes_but_not_more_than_there_may_be() {
    for (sheets, expected) in [(MOST_SURFACES - 1, [1.0; 3]), (MOST_SURFACES, [0.0; 3])] {
        let scene = behind_holes(sheets).expect("a scene");
        let path = Path::new(&scene, PathSettings::default(), [1, 1], LayerSet::of(&[]));
        assert_eq!(sample(&path).0, expected, "path through {sheets}");
        let settings = BidirectionalSettings::default();
        let both = Bidirectional::new(&scene, settings, [1, 1], LayerSet::of(&[]));
        assert_eq!(sample(&both).0, expected, "bidirectional through {sheets}");
    }
}

/// Balls in balls, each of which mirrors and lets through.
fn onion() -> Scene {
    let text = format!(
        "{CAMERA} Background {{ color 1 1 1 }} Lights {{ }}
         Materials {{ PhongMaterial m {{ diffuseColor 0 0 0 reflectiveColor 0.5 0.5 0.5
                                         transparentColor 0.5 0.5 0.5 indexOfRefraction 1.1 }} }}
         Group {{ MaterialIndex m Sphere {{ center 0 0 0 radius 1 }} Sphere {{ center 0 0 0 radius 0.9 }}
                  Sphere {{ center 0 0 0 radius 0.8 }} }}"
    );
    scene_with(&text, &MemoryAssets::new())
}

fn branching(scene: &Scene, bounces: u32) -> Classic<'_> {
    let settings = ClassicSettings { bounces, ray_offset: RayOffset::Auto, ..plain(scene) };
    Classic::new(scene, settings, [1, 1], LayerSet::of(&[]))
}

#[test]
fn a_sample_forks_into_no_more_paths_than_there_may_be() {
    let onion = onion();
    let (few, many) = (sample(&branching(&onion, 17)), sample(&branching(&onion, 60)));
    assert_eq!(few.1.left_out, 0, "all of 17 forks in a row are followed");
    assert!(many.1.left_out > 1000, "{:?}", many.1);
    assert!(many.1.total() < 60 << 18, "{:?}", many.1);
    // No light is lost at a surface, and the sky is 1: what there is of it comes nearer to that.
    assert!(few.0[0] < many.0[0] && many.0[0] < 1.0, "{few:?} {many:?}");
}

/// Stops when it has been asked some times.
struct StopAfter(AtomicUsize);

impl Progress for StopAfter {
    fn done(&self, _: u64, _: u64, _: u64) {}

    fn cancelled(&self) -> bool {
        self.0.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |left| left.checked_sub(1)).is_err()
    }
}

/// Renders a picture of one pixel until a render that was asked three times stops.
fn stopped(integrator: &dyn PixelIntegrator) -> (Film, RayCounters) {
    let film = Film::new(FilmSpec::new(1, 1), u64::MAX).expect("a film of one pixel");
    let sampler = Sampler::new(SamplerKind::Regular, 1);
    let settings = RenderSettings { threads: 1, ..RenderSettings::new(sampler) };
    match render(integrator, &film, &settings, &StopAfter(AtomicUsize::new(3))) {
        Err(RenderError::Cancelled(stats)) => (film, stats.rays),
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_sample_of_many_rays_is_given_up_when_the_render_stops() {
    let onion = onion();
    let text = format!(
        "{CAMERA} Background {{ color 1 1 1 }} Lights {{ }} Materials {{ Matte m {{ color 0.5 0.5 0.5 }} }}
         Group {{ MaterialIndex m Plane {{ normal 0 0 1 offset 0 }} }}"
    );
    let floor = scene_with(&text, &MemoryAssets::new());
    let settings = PathSettings { branches: 1 << 16, ..PathSettings::default() };
    let distribution = Path::new(&floor, settings, [1, 1], LayerSet::of(&[]));
    for integrator in [&branching(&onion, 60) as &dyn PixelIntegrator, &distribution] {
        let (film, rays) = stopped(integrator);
        assert!(rays.total() < 40_000, "{rays:?}");
        let picture = film.develop(crate::Layer::Color).expect("colour");
        assert_eq!(picture.data(), [0.0; 3], "part of a sample is in the film");
    }
}
