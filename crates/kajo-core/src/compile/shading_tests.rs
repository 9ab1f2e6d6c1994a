//! Frames of compiled scenes: grain and relief along the coordinates of surfaces.

use kajo_image::{EncodeOptions, Format, Image, encode};
use kajo_math::{Frame, Ray, Vec3};
use kajo_scene::{Diagnostics, MemoryAssets, SceneDesc};

use super::{CompileOptions, compile};
use crate::scene::Scene;
use crate::shading::Shading;

/// A scene of one object, seen from above.
fn scene(materials: &str, object: &str) -> Scene {
    scene_with(&MemoryAssets::new(), materials, object)
}

fn scene_with(assets: &MemoryAssets, materials: &str, object: &str) -> Scene {
    let text = format!(
        "PerspectiveCamera {{ center 0 9 0 direction 0 -1 0 up 0 0 -1 angle 30 }}
         Materials {{ {materials} }} Group {{ MaterialIndex 0 {object} }}"
    );
    let mut parsed = SceneDesc::parse_str(&text);
    let mut said = Diagnostics::default();
    let scene = compile(&mut parsed.desc, assets, &CompileOptions::default(), &mut said);
    scene.unwrap_or_else(|| panic!("{text}: {:?}", said.iter().map(|d| &d.message).collect::<Vec<_>>()))
}

fn seen(scene: &Scene, x: f32, z: f32) -> Shading {
    let at = scene.trace(&Ray::new(Vec3::new(x, 9.0, z), Vec3::NEG_Y));
    scene.shading(at.surface().expect("it is met"), 0.5)
}

const BRUSHED: &str = "Metal { metal gold  roughness 0.5  anisotropy 0.8 }";
const TURNED: &str = "Metal { metal gold  roughness 0.5  anisotropy 0.8  rotation 0.25 }";
const FLOOR: &str = "Quad { corner -1 0 1  edge1 2 0 0  edge2 0 0 -2 }";

fn assert_along(found: Vec3, expected: Vec3) {
    assert!(found.distance(expected) < 1e-5, "{found} for {expected}");
}

#[test]
fn grain_runs_along_the_first_coordinate_and_turns_to_the_second() {
    assert_along(seen(&scene(BRUSHED, FLOOR), 0.3, 0.2).tangent, Vec3::X);
    assert_along(seen(&scene(TURNED, FLOOR), 0.3, 0.2).tangent, Vec3::NEG_Z);
    let eighth = "Metal { roughness 0.5  anisotropy 0.8  rotation 0.125 }";
    assert_along(
        seen(&scene(eighth, FLOOR), 0.3, 0.2).tangent,
        Vec3::new(0.5f32.sqrt(), 0.0, -0.5f32.sqrt()),
    );
    // Mirrored, v turns round and u does not.
    let mirrored = format!("Transform {{ Scale 1 1 -1  {FLOOR} }}");
    assert_along(seen(&scene(BRUSHED, &mirrored), 0.3, 0.2).tangent, Vec3::X);
    assert_along(seen(&scene(TURNED, &mirrored), 0.3, 0.2).tangent, Vec3::Z);
}

/// A function of the place dents as much as it rises along the surface, whether that has coordinates or not.
#[test]
fn functions_dent_by_their_slope_along_the_surface() {
    let dented = "Matte { color 0.5 0.5 0.5  bump = 0.2 * sin(3 * x) + 0.1 * y * z }";
    let slope = |p: Vec3| Vec3::new(0.6 * (3.0 * p.x).cos(), 0.1 * p.z, 0.1 * p.y);
    for object in [FLOOR, "Sphere { center 0 0 0  radius 1 }", "Box { min -1 -1 -1  max 1 1 1 }"] {
        let scene = scene(dented, object);
        for (x, z) in [(0.3, 0.2), (-0.4, 0.1), (0.0, -0.5)] {
            let event = scene.trace(&Ray::new(Vec3::new(x, 9.0, z), Vec3::NEG_Y));
            let at = event.surface().unwrap();
            let slope = slope(at.point.p);
            let expected = (at.point.n - (slope - slope.dot(at.point.n) * at.point.n)).normalize();
            assert_along(scene.shading(at, 0.5).n, expected);
        }
    }
}

#[test]
fn grain_goes_along_with_objects() {
    let disk = "Disk { center 0 0 0  normal 0 1 0  radius 1 }";
    for map in ["", "Scale 3 1 3", "YRotate 70", "Translate 0 1 0  XRotate 20"] {
        let text = format!("Transform {{ {map} {disk} }}");
        for (x, z) in [(0.5, 0.1), (-0.2, 0.4), (0.1, -0.7)] {
            let shading = seen(&scene(BRUSHED, &text), x, z);
            // Around the centre, across the radius.
            let radial = Vec3::new(x, 0.0, z);
            let tilt = if map.contains("XRotate") { 0.1 } else { 1e-5 };
            assert!(shading.tangent.dot(radial).abs() < tilt, "{map}: {}", shading.tangent);
            assert!(shading.tangent.dot(shading.n).abs() < 1e-5 && shading.tangent.length() > 0.999);
        }
    }
    let nested = format!("Define knob {{ {disk} }} Instance knob {{ Translate 0.1 0 0  YRotate 10 }}");
    let tangent = seen(&scene(BRUSHED, &nested), 0.6, 0.0).tangent;
    assert!(tangent.x.abs() < 1e-5 && tangent.z.abs() > 0.999, "{tangent}");
}

#[test]
fn materials_that_ask_for_nothing_get_the_plain_frame() {
    let objects = [FLOOR, "Sphere { center 0 0 0  radius 1 }"];
    for object in objects {
        let plain = scene("Metal { metal gold  roughness 0.5 }", object);
        assert!(!plain.appearance.has_orientations);
        let shading = seen(&plain, 0.3, 0.2);
        let wo = Vec3::new(0.0, 0.8, 0.6);
        assert_eq!(shading.frame(wo), Frame::from_normal(shading.n));
    }
    // At the pole of a sphere there is no direction to go by.
    let pole = seen(&scene(BRUSHED, objects[1]), 0.0, 0.0);
    let frame = pole.frame(Vec3::Y);
    assert!((frame.n - Vec3::Y).length() < 1e-5 && frame.s.is_finite());
}

#[test]
fn a_mixture_has_the_grain_of_the_part_that_is_there() {
    let parts = format!("Checkerboard {{ materialIndex 1  materialIndex 2 }} Matte {{}} {BRUSHED}");
    let scene = scene(&parts, FLOOR);
    assert!(scene.appearance.has_orientations);
    let found = [0.4, -0.4].map(|x| seen(&scene, x, 0.2).tangent);
    assert!(found.contains(&Vec3::ZERO) && found.contains(&Vec3::X), "{found:?}");
}

/// The normal of `height sin(k u)` to the first order, with a quarter of the error for half the texels.
#[test]
fn heights_lean_as_the_surface_that_they_raise() {
    let (k, height) = (2.0 * std::f32::consts::TAU, 0.05f32);
    let error = |texels: u32| {
        let image = Image::from_fn(texels, 1, |x, _| {
            [0.5 + 0.5 * (k * (x as f32 + 0.5) / texels as f32).sin(), 0.0, 0.0]
        });
        let file = encode(&image.unwrap(), Format::Exr, &EncodeOptions::default()).unwrap();
        let material = format!("Matte {{ bump waves.exr {{ height {height} }} }}");
        let scene = scene_with(&MemoryAssets::new().with("waves.exr", file), &material, FLOOR);
        (0..64).map(|i| (i as f32 + 0.5) / 64.0).fold(0.0f32, |worst, u| {
            // The floor is two units wide.
            let n = seen(&scene, 2.0 * u - 1.0, 0.1).n;
            let slope = 0.25 * height * k * (k * u).cos();
            worst.max((n.x / n.y + slope).abs()).max(n.z.abs())
        })
    };
    let (coarse, fine) = (error(32), error(64));
    assert!(fine < 0.002 && (3.0..5.0).contains(&(coarse / fine)), "{coarse} {fine}");
}

#[test]
fn a_picture_of_normals_turns_with_the_surface() {
    let texel = Image::filled(1, 1, &[0.8, 0.5, 0.9]).unwrap();
    let file = encode(&texel, Format::Exr, &EncodeOptions::default()).unwrap();
    let assets = MemoryAssets::new().with("lean.exr", file);
    let lean = "Matte { normalMap lean.exr }";
    let assert_near = |found: Vec3, expected: Vec3| {
        assert!(found.distance(expected.normalize()) < 2e-4, "{found} for {expected}");
    };
    let floor = scene_with(&assets, lean, FLOOR);
    assert_near(seen(&floor, 0.2, 0.3).n, Vec3::new(0.6, 0.8, 0.0));
    assert!(seen(&floor, 0.2, 0.3).leans);
    let turned = scene_with(&assets, lean, &format!("Transform {{ YRotate 90  {FLOOR} }}"));
    assert_near(seen(&turned, 0.2, 0.3).n, Vec3::new(0.0, 0.8, -0.6));
    let mirrored = scene_with(&assets, lean, &format!("Transform {{ Scale -1 1 1  {FLOOR} }}"));
    assert_near(seen(&mirrored, 0.2, 0.3).n, Vec3::new(-0.6, 0.8, 0.0));
    let flat = scene_with(&assets, "Matte { normalMap lean.exr { scale 0.5 } }", FLOOR);
    assert_near(seen(&flat, 0.2, 0.3).n, Vec3::new(0.3, 0.8, 0.0));
    // A ball leans along its circles of latitude.
    let ball = scene_with(&assets, lean, "Sphere { center 0 0 0  radius 1 }");
    let east = seen(&ball, 0.0, 0.6);
    assert_near(east.n, 0.8 * east.ng + 0.6 * Vec3::X);
    // Grain follows the normal that leans.
    let brushed = "Metal { roughness 0.5  anisotropy 0.5  normalMap lean.exr }";
    let frame = seen(&scene_with(&assets, brushed, FLOOR), 0.2, 0.3).frame(Vec3::Y);
    assert_near(frame.s, Vec3::new(0.8, -0.6, 0.0));
}
