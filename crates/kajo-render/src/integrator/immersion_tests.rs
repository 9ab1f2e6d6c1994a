//! Cameras of which some rays start inside an absorbing body that bends nothing, and others do not: the light of each
//! is weakened by the part of the ray that is inside.

use std::f64::consts::PI;

use kajo_core::sampler::{Sampler, SamplerKind};
use kajo_core::scene::Scene;
use kajo_math::Vec2;
use kajo_scene::MemoryAssets;

use super::tests::scene_with;
use super::{Bidirectional, BidirectionalSettings, Path, PathSettings};
use crate::{LayerSet, PixelIntegrator, SampleContext};

/// Absorption of the slab per unit length.
const SIGMA: f64 = 0.4;

/// A slab in a white world.
fn scene(camera: &str, slab: &str) -> Scene {
    let text = format!(
        "{camera} Background {{ color 1 1 1 }}
         Materials {{ Glass murk {{ indexOfRefraction 1  absorption {SIGMA} {SIGMA} {SIGMA} }} }}
         Group {{ MaterialIndex murk {slab} }}"
    );
    scene_with(&text, &MemoryAssets::new())
}

/// Compares the mean of many samples of a position of the picture with what is expected, for paths from the camera alone and
/// from both ends.
#[track_caller]
fn check(scene: &Scene, size: [u32; 2], place: Vec2, expected: f64) {
    let layers = LayerSet::of(&[]);
    let integrators: [Box<dyn PixelIntegrator + '_>; 2] = [
        Box::new(Path::new(scene, PathSettings::default(), size, layers)),
        Box::new(Bidirectional::new(scene, BidirectionalSettings::default(), size, layers)),
    ];
    let samples = 1 << 12;
    let sampler = Sampler::new(SamplerKind::Sobol, samples);
    for integrator in integrators {
        let mut ctx = SampleContext::new(&sampler, 5);
        let radiance = |k: u32| {
            ctx.begin([0, 0], k);
            f64::from(integrator.sample(&mut ctx, [0, 0], place).radiance[0])
        };
        let found = (0..samples).map(radiance).sum::<f64>() / f64::from(samples);
        assert!((found - expected).abs() < 1e-3, "{place}: {found} for {expected}");
    }
}

fn transmittance(length: f64) -> f64 {
    (-SIGMA * length).exp()
}

#[test]
fn a_slab_that_cuts_the_film_plane_weakens_the_rays_that_start_in_it() {
    let camera =
        "OrthographicCamera { center 0 0 0 direction 0 0 -1 up 0 1 0 size 2  aperture 0.001  focus 9 }";
    // Parallel rays without a lens come from infinitely far behind the slab.
    let parallel = camera.replace("aperture 0.001  focus 9", "");
    for (camera, inside) in [(camera, 3.0), (&*parallel, 4.0)] {
        let scene = scene(camera, "Box { min -3 -2 -3  max -0.5 2 1 }");
        check(&scene, [2, 1], Vec2::new(0.5, 0.5), transmittance(inside));
        check(&scene, [2, 1], Vec2::new(1.5, 0.5), 1.0);
    }
}

#[test]
fn a_slab_that_cuts_the_lens_weakens_a_part_of_it() {
    // The lens is seen from so far that all rays are as good as parallel.
    let camera =
        "PerspectiveCamera { center 0 0 0 direction 0 0 -1 up 0 1 0 angle 0.01  aperture 1  focus 100000 }";
    for k in [-0.4f64, 0.3] {
        let scene = scene(camera, &format!("Box {{ min -3 -2 -3  max {} 2 1 }}", 0.5 * k));
        let covered = 1.0 - (k.acos() - k * (1.0 - k * k).sqrt()) / PI;
        check(&scene, [1, 1], Vec2::splat(0.5), covered * transmittance(3.0) + 1.0 - covered);
    }
}

#[test]
fn each_eye_knows_where_it_is() {
    let camera =
        "PanoramaCamera { center 0 0 0 direction 0 0 -1 up 0 1 0  stereo omnidirectional  eyeSeparation 1 }";
    let scene = scene(camera, "Box { min -3 -2 -3  max -0.2 2 1 }");
    check(&scene, [4, 4], Vec2::new(2.0, 1.0), transmittance(3.0));
    check(&scene, [4, 4], Vec2::new(2.0, 3.0), 1.0);
}

#[test]
fn the_moment_decides_where_the_camera_is() {
    // It is in the slab in the second half of the time, and ever less of the slab is before it.
    let later = (transmittance(2.0) - transmittance(3.0)) / (2.0 * SIGMA);
    let expected = 0.5 * transmittance(3.0) + later;
    let pinhole = |place: &str, motion: &str| {
        format!("PerspectiveCamera {{ center {place} direction 0 0 -1 up 0 1 0 angle 0.01 {motion} }}")
    };
    let motion = |z: f32| format!("Motion {{ key 0 {{ }} key 1 {{ Translate 0 0 {z} }} }}");
    let slab = "Box { min -2 -2 -4  max 2 2 -1 }";
    let moving_slab = scene(&pinhole("0 0 0", ""), &format!("Transform {{ {} {slab} }}", motion(2.0)));
    let moving_camera = scene(&pinhole("0 0 0", &motion(-2.0)), slab);
    // The same slab by operands that move: a box in a larger one, and half spaces within a body that rests.
    let operand = format!(
        "Intersection {{ Box {{ min -2 -2 -9  max 2 2 9 }} Transform {{ {} Box {{ min -3 -3 -4  max 3 3 -1 }} }} }}",
        motion(2.0)
    );
    let cut = format!(
        "Difference {{ Box {{ min -2 -2 -9  max 2 2 9 }} Transform {{ {} Plane {{ normal 0 0 1  offset -4 }} \
         Plane {{ normal 0 0 -1  offset 1 }} }} }}",
        motion(2.0)
    );
    let operands = [operand, cut].map(|solid| scene(&pinhole("0 0 0", ""), &solid));
    for scene in [moving_slab, moving_camera].into_iter().chain(operands) {
        check(&scene, [1, 1], Vec2::splat(0.5), expected);
    }
}
