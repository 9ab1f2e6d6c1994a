//! Things and cameras on paths.

use std::f64::consts::{FRAC_1_SQRT_2, TAU};

use kajo_math::{DAffine3, DVec3, Vec2, fmath};
use kajo_scene::{MemoryAssets, SceneDesc};

use super::{CompileOptions, clock_of, compile, operations_matrix};
use crate::scene::Scene;

/// The map of an operation.
fn map(keys: &str) -> DAffine3 {
    let parsed = SceneDesc::parse_str(&format!("Transform {{ FollowPath {{ {keys} }} }}"));
    let item = parsed.desc.roots().next().unwrap();
    operations_matrix(item.children(), false)
}

fn is_near(a: DVec3, b: DVec3) -> bool {
    a.distance(b) < 1e-6
}

/// A scene of a ball, and what was said about it.
fn scene(camera: &str, operation: &str, frame: i64) -> (Option<Scene>, String) {
    let text = format!(
        "PerspectiveCamera {{ angle 30  up 0 1 0  {camera} }} Animation {{ fps 10  frames 0 20 }} Materials {{ Matte {{ }} }}
         Group {{ MaterialIndex 0 Transform {{ {operation} Sphere {{ center 0 0 0  radius 1 }} }} }}"
    );
    let options = CompileOptions { frame: Some(frame), ..CompileOptions::default() };
    let clock = clock_of(&SceneDesc::parse_str(&text).desc, &options).unwrap_or_default();
    let assets = MemoryAssets::new();
    let mut parsed = SceneDesc::parse_at("scene", &text, &assets, &kajo_scene::Limits::default(), &clock);
    let scene = compile(&mut parsed.desc, &assets, &options, &mut parsed.diagnostics);
    (scene, parsed.diagnostics.iter().map(|said| format!("{said:?}\n")).collect())
}

const STRAIGHT: &str = "line 1 0 0  3 0 0  3 0 2";

#[test]
fn progress_is_a_share_of_the_length() {
    for (progress, point) in [
        (0.0, [1.0, 0.0, 0.0]),
        (0.25, [2.0, 0.0, 0.0]),
        (0.75, [3.0, 0.0, 1.0]),
        (1.0, [3.0, 0.0, 2.0]),
        // A path with ends has nothing beyond them.
        (1.5, [3.0, 0.0, 2.0]),
        (-0.5, [1.0, 0.0, 0.0]),
    ] {
        let found = map(&format!("{STRAIGHT}  progress {progress}")).translation;
        assert!(is_near(found, point.into()), "{progress}: {found}");
    }
    // A parabola from (-1, 1) to (1, 1) with its vertex at zero: y = x^2. Its length from the vertex to x has a closed form.
    let length = |x: f64| {
        let root = (1.0 + 4.0 * x * x).sqrt();
        0.5 * x * root + 0.25 * fmath::ln64(2.0 * x + root)
    };
    for x in [0.1, 0.4, 0.9] {
        let progress = 0.5 + 0.5 * length(x) / length(1.0);
        let found = map(&format!("quadratic -1 1 0  0 -1 0  1 1 0  progress {progress}"));
        assert!(is_near(found.translation, DVec3::new(x, x * x, 0.0)), "{x}: {found:?}");
    }
}

#[test]
fn things_point_along_the_path() {
    let found = map(&format!("{STRAIGHT}  progress 0.25"));
    let turned = |map: &DAffine3, v: [f64; 3]| map.matrix3 * DVec3::from_array(v);
    // What points forwards, up and to the right.
    assert!(
        is_near(turned(&found, [0.0, 0.0, -1.0]), DVec3::X)
            && is_near(turned(&found, [0.0, 1.0, 0.0]), DVec3::Y)
    );
    assert!(is_near(turned(&found, [1.0, 0.0, 0.0]), DVec3::Z));
    let nose = map(&format!("{STRAIGHT}  progress 0.75  forward 1 0 0  up 0 0 1"));
    assert!(is_near(turned(&nose, [1.0, 0.0, 0.0]), DVec3::Z), "{nose:?}");
    // Leaning by 45 degrees: what was up is half way to the right.
    let banked = map(&format!("{STRAIGHT}  progress 0.25  bank 45"));
    assert!(is_near(turned(&banked, [0.0, 0.0, -1.0]), DVec3::X));
    assert!(is_near(turned(&banked, [0.0, 1.0, 0.0]), DVec3::new(0.0, FRAC_1_SQRT_2, FRAC_1_SQRT_2)));
    let unturned = map(&format!("{STRAIGHT}  progress 0.25  turn off"));
    assert!(is_near(turned(&unturned, [0.3, 0.4, 0.5]), DVec3::new(0.3, 0.4, 0.5)));
    for progress in [0.0, 0.2, 0.5, 0.51, 0.9, 1.0] {
        let m = map(&format!("spline 0 0 0  1 2 0  3 1 4  3 0 0  progress {progress}  bank 30")).matrix3;
        assert!(
            (m * m.transpose()).abs_diff_eq(kajo_math::DMat3::IDENTITY, 1e-12) && m.determinant() > 0.0,
            "{m}"
        );
    }
}

#[test]
fn closed_paths_go_on_and_points_said_twice_change_nothing() {
    let ring = "spline 1 0 0  0 0 1  -1 0 0  0 0 -1  1 0 0";
    let at = |progress: f64| map(&format!("{ring}  progress {progress}"));
    for progress in [0.1, 0.3, 0.77] {
        for rounds in [-3.0, 1.0, 5.0] {
            assert!(is_near(at(progress).translation, at(progress + rounds).translation));
        }
    }
    // By symmetry a quarter of the length is a quarter of a turn, and speed is constant.
    assert!(is_near(at(0.25).translation, DVec3::Z) && is_near(at(0.5).translation, DVec3::NEG_X));
    let steps: Vec<f64> = (0..400u32)
        .map(|i| at(f64::from(i) / 400.0).translation.distance(at(f64::from(i + 1) / 400.0).translation))
        .collect();
    let whole: f64 = steps.iter().sum();
    assert!(steps.iter().all(|step| (step * 400.0 / whole - 1.0).abs() < 1e-3) && whole < TAU, "{whole}");
    let twice = "line 1 0 0  1 0 0  3 0 0  3 0 0  3 0 2  3 0 2";
    for progress in [0.0, 0.25, 0.5, 0.75, 1.0] {
        let found = map(&format!("{twice}  progress {progress}"));
        let expected = map(&format!("{STRAIGHT}  progress {progress}"));
        assert!(found.abs_diff_eq(expected, 1e-9), "{progress}: {found:?} {expected:?}");
    }
}

#[test]
fn cameras_and_things_go_along_with_the_time() {
    let path = "FollowPath { line 0 0 0  40 0 0  progress (time / 2) }";
    let still = "center 0 0 9  direction 0 0 -1";
    let (film, said) = scene(still, path, 10);
    let film = film.unwrap_or_else(|| panic!("{said}"));
    assert!(film.moves(), "a shutter of half a frame");
    // In its own space the camera looks along -z, which is the path's direction.
    let (film, said) = scene(&format!("center 0 1 0  direction 0 0 -1  shutter 0 0  {path}"), "", 5);
    let film = film.unwrap_or_else(|| panic!("{said}"));
    let ray = film.output.camera.ray(Vec2::ZERO, 1.0, Vec2::ZERO, 0.0).unwrap();
    assert!(
        is_near(ray.o.as_dvec3(), DVec3::new(10.0, 1.0, 0.0)) && is_near(ray.d.as_dvec3(), DVec3::X),
        "{ray:?}"
    );
}

#[test]
fn mistakes_are_told() {
    let still = "center 0 0 9  direction 0 0 -1";
    for (keys, words) in [
        ("progress 0.5", "goes nowhere"),
        ("line 1 1 1  1 1 1", "has no length"),
        ("line 0 0 0  1 0", "groups of 3"),
        ("line 0 0 0  1 0 0  progress 1e7", "at most 1000000"),
        ("line 0 0 0  1 0 0  forward 0 0 0", "length above zero"),
        ("line 0 0 0  1 0 0  up 0 0 -1", "the same direction"),
        ("line 0 0 0  1 0 0  turn off  bank 20", "`bank` has no effect"),
        ("line 0 0 0  1 0 0  speed 3", "unknown word `speed`"),
    ] {
        let (_, said) = scene(still, &format!("FollowPath {{ {keys} }}"), 1);
        assert!(said.contains(words), "{keys}: {said}");
    }
    // What is known of the world only.
    for camera in [
        "fit scene",
        "center 0 0 0  target scene",
        "center 0 0 0  direction 0 0 -1  aperture 0.1  focus 0 0 -5",
    ] {
        let (scene, said) = scene(&format!("{camera}  FollowPath {{ {STRAIGHT} }}"), "", 1);
        assert!(scene.is_none() && said.contains("says by numbers where it looks"), "{camera}: {said}");
    }
}
