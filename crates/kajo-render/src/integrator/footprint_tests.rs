//! Footprints along paths against differences of traced rays: on a floor seen in a mirror ball, through a glass ball, and in a
//! waving mesh of triangles.

use kajo_color::{Spectrum, Wavelengths};
use kajo_core::bsdf::{BsdfSample, ScatterKind, Transport};
use kajo_core::sampler::{SampleStream, Sampler, SamplerKind};
use kajo_core::scene::Scene;
use kajo_math::{Ray, Vec2, Vec3};
use kajo_scene::MemoryAssets;

use super::camera_view::CameraView;
use super::tests::scene_with;
use super::transport::{Event, MediumStack, PathState, SurfaceInteraction, advance, follow, leave};
use super::{Path, PathSettings};
use crate::{LayerSet, PixelIntegrator, SampleContext, Trail};

const SIZE: [u32; 2] = [200, 200];

/// What happens at a surface on the way.
#[derive(Clone, Copy, Debug)]
enum SurfaceKind {
    Mirror,
    /// Into glass, or out of it.
    Glass,
}

/// A scene of things before a floor and a wall whose picture is filtered.
fn scene(camera: &str, things: &str) -> Scene {
    let mut file = b"PF\n1 1\n-1.0\n".to_vec();
    file.extend([0.5f32; 3].into_iter().flat_map(f32::to_le_bytes));
    let assets = MemoryAssets::new().with("grey.pfm", file);
    let text = format!(
        "{camera} Background {{ color 0 0 0 }}
         Materials {{ Matte floor {{ color grey.pfm {{ filter ewa }} }} Glass glass {{ indexOfRefraction 1.5 }} Metal mirror {{ roughness 0 }} }}
         Group {{ MaterialIndex floor Plane {{ normal 0 1 0  offset -2 }} Plane {{ normal 0 0 1  offset -6 }} {things} }}"
    );
    scene_with(&text, &assets)
}

/// Follows a ray by a way to the last surface: its point, and what the path says that a sample covers.
fn reach(scene: &Scene, start: PathState<'_>, way: &[SurfaceKind]) -> Option<(Vec3, [Vec3; 2], u32)> {
    let (mut path, mut surface) = (start, SurfaceInteraction::default());
    let mut observer = Trail::default();
    for &step in way {
        let Event::Surface = advance(scene, &mut path, &mut surface, &mut None, &mut observer) else {
            return None;
        };
        let (d, n) = (-surface.wo, surface.at.point.n);
        let enters = d.dot(n) < 0.0;
        let n = if enters { n } else { -n };
        let cos = d.dot(n);
        let (wi, eta) = match step {
            SurfaceKind::Mirror => (d - 2.0 * cos * n, 1.0),
            SurfaceKind::Glass => {
                let eta = if enters { 1.5 } else { 1.0 / 1.5 };
                let cos_t = 1.0 - (1.0 - cos * cos) / (eta * eta);
                if cos_t < 0.1 {
                    return None;
                }
                (d / eta - (cos / eta + cos_t.sqrt()) * n, eta)
            }
        };
        let wi = wi.normalize();
        let kind =
            ScatterKind { transmission: matches!(step, SurfaceKind::Glass), delta: true, straight: false };
        let sample = BsdfSample { wi: Vec3::Z, weight: Spectrum::WHITE, pdf: 1.0, kind, eta };
        if path.differential.is_some() {
            leave(scene, &mut path, &surface, wi, &sample);
        }
        follow(&mut path, &surface, wi, &sample, &mut observer);
    }
    let Event::Surface = advance(scene, &mut path, &mut surface, &mut None, &mut observer) else {
        return None;
    };
    Some((surface.at.point.p, surface.at.footprint.dp, surface.at.object.number()))
}

/// Compares the two for pixels all over the picture; returns how many could be compared.
fn check(scene: &Scene, way: &[SurfaceKind], tolerance: f32) -> usize {
    let view = CameraView::new(scene, &scene.output.camera, SIZE, LayerSet::of(&[]));
    let sampler = Sampler::new(SamplerKind::Uniform, 1);
    let draws = SampleStream::new(&sampler, 0, [0, 0], 0);
    let start = |ray: Ray| {
        PathState::new(
            ray,
            Wavelengths::RGB,
            Spectrum::WHITE,
            Transport::Radiance,
            MediumStack::default(),
            draws,
        )
    };
    let mut compared = 0;
    for (x, y) in (3..SIZE[0]).step_by(7).flat_map(|x| (3..SIZE[1]).step_by(7).map(move |y| (x, y))) {
        let raster = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
        let at = |raster: Vec2| view.ray(raster, &mut { draws });
        let differential = view.differential(raster, draws, 1);
        assert!(differential.is_some());
        let Some(ray) = at(raster) else { continue };
        let Some((_, found, object)) = reach(scene, PathState { differential, ..start(ray) }, way) else {
            continue;
        };
        for (found, axis) in found.into_iter().zip([Vec2::X, Vec2::NEG_Y]) {
            // A part of a pixel, so that what is not linear stays small.
            const PART: f32 = 0.25;
            let ends = [0.5, -0.5]
                .map(|side| at(raster + PART * side * axis).and_then(|ray| reach(scene, start(ray), way)));
            let [Some((there, _, first)), Some((back, _, last))] = ends else { continue };
            if first != object || last != object {
                continue;
            }
            let expected = (there - back) / PART;
            // Near the rim, and where rays come together, a pixel is large against what bends them.
            if expected.length() > 0.5 || expected.length() < 5e-3 {
                continue;
            }
            compared += 1;
            let error = (found - expected).length() / expected.length();
            assert!(error < tolerance, "{raster} {axis}: {found} {expected} {error}");
        }
    }
    compared
}

const CAMERA: &str = "PerspectiveCamera { center 0 1 8  direction 0 -0.1 -1  up 0 1 0  angle 40 }";

#[test]
fn footprints_are_those_of_traced_rays() {
    let empty = scene(CAMERA, "");
    assert!(check(&empty, &[], 0.002) > 1000);
    let parallel = scene("OrthographicCamera { center 0 1 8  direction 0 -0.3 -1  up 0 1 0  size 8 }", "");
    assert!(check(&parallel, &[], 0.002) > 1000);
    let fisheye = scene("FisheyeCamera { center 0 1 8  direction 0 -0.3 -1  up 0 1 0  angle 180 }", "");
    assert!(check(&fisheye, &[], 0.005) > 500);
}

#[test]
fn footprints_in_a_mirror_ball_are_those_of_traced_rays() {
    let ball = "MaterialIndex mirror Sphere { center 0 0.5 0  radius 1.5 }";
    assert!(check(&scene(CAMERA, ball), &[SurfaceKind::Mirror], 0.01) > 100);
    let squeezed = "MaterialIndex mirror Transform { Translate 0 0.5 0  Scale 1.6 1.2 0.8  Sphere { center 0 0 0  radius 1.2 } }";
    assert!(check(&scene(CAMERA, squeezed), &[SurfaceKind::Mirror], 0.01) > 50);
}

#[test]
fn footprints_through_a_glass_ball_are_those_of_traced_rays() {
    let ball = "MaterialIndex glass Sphere { center 0 0.5 0  radius 1.5 }";
    assert!(check(&scene(CAMERA, ball), &[SurfaceKind::Glass, SurfaceKind::Glass], 0.01) > 100);
}

/// A chequered plane to the horizon under light of irradiance pi, whose picture is filtered.
fn horizon(filter: &str) -> Scene {
    let mut file = b"PF\n64 64\n-1.0\n".to_vec();
    let texel = |x: u32, y: u32| [(((x / 16) ^ (y / 16)) & 1) as f32; 3];
    let texels = (0..64).flat_map(|y| (0..64).flat_map(move |x| texel(x, y)));
    file.extend(texels.flat_map(f32::to_le_bytes));
    let assets = MemoryAssets::new().with("checks.pfm", file);
    const E: f64 = std::f64::consts::PI;
    let text = format!(
        "PerspectiveCamera {{ center 0.13 1 0.4  direction 0.17 -0.25 -1  up 0 1 0  angle 40 }} Background {{ color 0 0 0 }}
         Lights {{ DirectionalLight {{ direction 0 -1 0 irradiance {E} {E} {E} }} }}
         Materials {{ Matte m {{ color checks.pfm {{ filter {filter}  repeat 0.5 }} }} }}
         Group {{ MaterialIndex m Plane {{ normal 0 1 0  offset 0 }} }}"
    );
    scene_with(&text, &assets)
}

/// The picture of [`horizon`] by samples of a pixel on a grid of `n x n`.
fn picture(filter: &str, n: u32) -> Vec<f32> {
    picture_of(&horizon(filter), n)
}

fn picture_of(scene: &Scene, n: u32) -> Vec<f32> {
    const SIZE: [u32; 2] = [36, 24];
    let settings = PathSettings { bounces: 0, ..PathSettings::default() };
    let path = Path::new(scene, settings, SIZE, LayerSet::of(&[]));
    let sampler = Sampler::new(SamplerKind::Uniform, 1);
    let mut ctx = SampleContext::new(&sampler, 3);
    let mut pixel = |x: u32, y: u32| {
        let mut sum = 0.0;
        for k in 0..n * n {
            ctx.begin([x, y], k);
            let within = (Vec2::new((k % n) as f32, (k / n) as f32) + 0.5) / n as f32;
            sum += path.sample(&mut ctx, [x, y], Vec2::new(x as f32, y as f32) + within).radiance[0];
        }
        sum / (n * n) as f32
    };
    (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| (x, y))).map(|(x, y)| pixel(x, y)).collect()
}

/// Against 4,096 samples of the texels themselves: ellipses have at most a quarter of the error of squares, and are grey
/// where the horizon is near.
#[test]
fn ellipses_show_a_plane_to_the_horizon() {
    let reference = picture("nearest", 64);
    // Rows below the one that the horizon is in, and those of them that are next to it.
    let first = 1 + (0..24).find(|&y| (0..36).all(|x| reference[y * 36 + x] > 0.0)).unwrap();
    let errors = ["ewa", "trilinear", "feline", "sat", "bilinear"].map(|filter| {
        let found = picture(filter, 1);
        let below = first * 36..;
        let relative = |(a, b): (&f32, &f32)| (a - b) * (a - b) / (b * b + 0.01);
        let sum: f32 = found[below.clone()].iter().zip(&reference[below]).map(relative).sum();
        if filter == "ewa" {
            let near = &found[first * 36..(first + 2) * 36];
            let mean = near.iter().sum::<f32>() / near.len() as f32;
            assert!((mean - 0.5).abs() < 0.005, "{mean}");
        }
        sum / (found.len() - first * 36) as f32
    });
    let [ewa, trilinear, feline, sat, bilinear] = errors;
    assert!(ewa <= 0.25 * trilinear, "{errors:?}");
    assert!(feline < trilinear && sat < bilinear && trilinear < bilinear, "{errors:?}");
}

/// The plane of [`horizon`] in the colours that a texture `t` gives to a pattern `p`.
fn patterned(texture: &str, pattern: &str, filter: &str) -> Scene {
    const E: f64 = std::f64::consts::PI;
    let text = format!(
        "PerspectiveCamera {{ center 0.13 1 0.4  direction 0.17 -0.25 -1  up 0 1 0  angle 40 }} Background {{ color 0 0 0 }}
         Lights {{ DirectionalLight {{ direction 0 -1 0 irradiance {E} {E} {E} }} }}
         Textures {{ {texture} {pattern} filter {filter} }} }} Materials {{ Matte m {{ color t }} }}
         Group {{ MaterialIndex m Plane {{ normal 0 1 0  offset 0 }} }}"
    );
    scene_with(&text, &MemoryAssets::new())
}

/// Against 1,024 samples a pixel of one: ramps and thresholds average over what their pattern is within a footprint.
#[test]
fn sharp_stops_are_filtered() {
    let sharp = "Ramp t { texture p  interpolation step  stop 0 0.1 0.1 0.1  stop 0.6 0.9 0.9 0.9 }";
    let narrow = "Ramp t { texture p  stop 0.5 0 0 0  stop 0.52 1 1 1 }";
    let often = "Ramp t { texture p  frequency 3  interpolation oklab  stop 0 0 0 0  stop 1 1 1 1 }";
    let threshold = "Threshold t { texture p  edge 0.45 }";
    let gradient = "Gradient p { size 0.7  wave sine  Transform { YRotate 80 }";
    let clouds = "Clouds p { size 0.5";
    let mut errors = Vec::new();
    // What a pattern fades by the longer side of a footprint is lost along the shorter side as well: there less is gained.
    for (texture, pattern, gain) in [
        (sharp, gradient, 4.0),
        (narrow, gradient, 4.0),
        (often, gradient, 2.0),
        (threshold, gradient, 4.0),
        (sharp, clouds, 1.6),
        (often, clouds, 4.0),
        (threshold, clouds, 1.6),
        (threshold, "Checks p { size 0.3", 1.6),
    ] {
        let reference = picture_of(&patterned(texture, pattern, "off"), 32);
        let [filtered, point] = ["on", "off"].map(|filter| {
            let found = picture_of(&patterned(texture, pattern, filter), 1);
            reference.iter().zip(found).map(|(a, b)| (a - b) * (a - b)).sum::<f32>()
        });
        errors.push((texture, pattern, point / filtered, gain));
    }
    assert!(errors.iter().all(|(_, _, found, gain)| found >= gain), "{errors:?}");
}
