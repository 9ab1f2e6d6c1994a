//! Scenes that change with time, frame by frame.

use kajo_math::{DVec3, Ray, Vec2, Vec3, fmath};
use kajo_scene::{Limits, MemoryAssets, SceneDesc};

use super::{CompileOptions, clock_of, compile};
use crate::scene::{RayEvent, Scene};

const CAMERA: &str = "PerspectiveCamera { center 0 0 9  direction 0 0 -1  up 0 1 0  angle 30 }";

fn options(frame: Option<i64>) -> CompileOptions {
    CompileOptions { frame, ..CompileOptions::default() }
}

fn compiled(text: &str, options: &CompileOptions) -> Result<Scene, Vec<String>> {
    let (assets, limits) = (MemoryAssets::new(), Limits::default());
    let probe = SceneDesc::parse_str(text);
    let clock = clock_of(&probe.desc, options).unwrap_or_default();
    let mut parsed = SceneDesc::parse_at("scene", text, &assets, &limits, &clock);
    let mut diagnostics = parsed.diagnostics;
    let scene = compile(&mut parsed.desc, &assets, options, &mut diagnostics);
    scene.ok_or_else(|| diagnostics.errors().map(|error| error.message.clone()).collect())
}

fn scene(objects: &str, frame: i64) -> Scene {
    let text = format!(
        "{CAMERA} Animation {{ fps 24  frames 1 48 }} Materials {{ Matte {{ }} }} Group {{ MaterialIndex 0 {objects} }}"
    );
    compiled(&text, &options(Some(frame))).unwrap_or_else(|said| panic!("{said:?}"))
}

/// Where the nearest thing along -z is above a point of the plane at a ray's time.
fn height(scene: &Scene, x: f32, y: f32, time: f32) -> Option<f32> {
    let ray = Ray { time, ..Ray::new(Vec3::new(x, y, 50.0), Vec3::NEG_Z) };
    match scene.trace(&ray) {
        RayEvent::Surface(at) => Some(at.point.p.z),
        RayEvent::Escaped => None,
    }
}

#[test]
fn numbers_are_those_of_the_frame() {
    let ball = "Sphere { center 0 0 0  radius keys { 0: 1  1: 3 } }";
    for (frame, radius) in [(1, 1.0), (13, 2.0), (25, 3.0), (40, 3.0)] {
        let scene = scene(ball, frame);
        assert!(!scene.moves());
        assert_eq!(height(&scene, 0.0, 0.0, 0.7), Some(radius));
        assert_eq!(scene.output.animation.unwrap().frame, frame);
    }
}

#[test]
fn operations_move_while_the_shutter_is_open() {
    // A unit a frame.
    let scene = scene("Transform { Translate (24 * time) 0 0 Sphere { center 0 0 0  radius 0.1 } }", 13);
    assert!(scene.moves());
    for time in [0.0, 0.25, 0.8, 0.99] {
        // The shutter is open for half a frame.
        let x = 12.0 + 0.5 * time;
        assert!(height(&scene, x, 0.0, time).is_some(), "{time}");
        assert!(
            height(&scene, x + 0.11, 0.0, time).is_none() && height(&scene, x - 0.11, 0.0, time).is_none()
        );
    }
    let text = |shutter: &str| {
        format!(
            "PerspectiveCamera {{ center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30 {shutter} }} Materials {{ Matte {{ }} }}
             Group {{ MaterialIndex 0 Transform {{ Translate frame 0 0 Sphere {{ center 0 0 0  radius 0.1 }} }} }}"
        )
    };
    let still = compiled(&text("shutter 0.5 0.5"), &options(Some(7))).unwrap();
    assert!(!still.moves());
    assert!(height(&still, 7.5, 0.0, 0.9).is_some());
    // Without any frames the time is 0, that of frame 1, and nothing moves.
    let no_film = compiled(&text(""), &options(None)).unwrap();
    assert!(!no_film.moves() && no_film.output.animation.is_none());
    assert!(height(&no_film, 1.0, 0.0, 0.9).is_some());
}

#[test]
fn turns_are_exact_between_moments() {
    // A quarter of a turn while the shutter is open.
    let scene = scene("Transform { ZRotate (12 * 360 * time) Sphere { center 10 0 0  radius 0.01 } }", 5);
    for i in 0..20u8 {
        let time = f32::from(i) / 20.0;
        let angle = (90.0 * time).to_radians();
        let (sin, cos) = (fmath::sin(angle), fmath::cos(angle));
        assert!(height(&scene, 10.0 * cos, 10.0 * sin, time).is_some(), "{time}");
    }
}

#[test]
fn what_becomes_flat_stands_still_in_that_frame() {
    let shrinking = "Transform { UniformScale keys { 0: 1  1: 0 } Sphere { center 0 0 0  radius 1 } }";
    assert_eq!(height(&scene(shrinking, 13), 0.0, 0.0, 0.0), Some(0.5));
    let text = format!(
        "{CAMERA} Animation {{ }} Materials {{ Matte {{ }} }} Group {{ MaterialIndex 0 {shrinking} }}"
    );
    // The frame at which it is gone holds nothing, and says so.
    let gone = compiled(&text, &options(Some(25))).unwrap();
    assert!(height(&gone, 0.0, 0.0, 0.0).is_none());
}

#[test]
fn cameras_move_along_their_keys() {
    let text = "PerspectiveCamera { center keys { 0: 0 0 9  1: 24 0 9 }  target 0 0 0  up 0 1 0  angle 30 }
        Animation { } Materials { Matte { } } Group { MaterialIndex 0 Sphere { center 0 0 0  radius 1 } }";
    let scene = compiled(text, &options(Some(3))).unwrap();
    assert!(scene.output.camera.moves());
    for time in [0.0, 0.5, 1.0] {
        let ray = scene.output.camera.ray(Vec2::ZERO, 1.0, Vec2::ZERO, time).unwrap();
        let eye = DVec3::new(2.0 + 0.5 * f64::from(time), 0.0, 9.0);
        assert!(ray.o.as_dvec3().distance(eye) < 1e-5, "{} {eye}", ray.o);
        let towards = -eye.normalize();
        assert!(ray.d.as_dvec3().normalize().distance(towards) < 1e-4, "{time}");
    }
    // Keys of other numbers do not move it.
    let zoom = text
        .replace("center keys { 0: 0 0 9  1: 24 0 9 }", "center 0 0 9")
        .replace("angle 30", "angle keys { 0: 30  1: 60 }");
    assert!(!compiled(&zoom, &options(Some(3))).unwrap().output.camera.moves());
}

#[test]
fn the_frames_of_motion_blocks_follow_each_other() {
    let moving =
        "Transform { Motion { key 0 { } key 2 { Translate 48 0 0 } } Sphere { center 0 0 0  radius 0.1 } }";
    let scene = scene(moving, 25);
    for time in [0.0, 0.5, 0.99] {
        assert!(height(&scene, 24.0 + 0.5 * time, 0.0, time).is_some(), "{time}");
    }
}

#[test]
fn an_orbit_closes_to_the_bit() {
    let orbit = "let a = keys loop { 0: 0  2: 360 }
        Transform { YRotate a  Translate keys cubic loop { 0: 3 0 0  1: 3.5 0.1 0  2: 3 0 0 }  ZRotate a Box { min -1 -1 -1 max 1 1 1 } }";
    let (first, after_last) = (scene(orbit, 2), scene(orbit, 50));
    let other = scene(orbit, 26);
    let mut differ = 0;
    for i in 0..400_u16 {
        let (x, y) = (f32::from(i % 20) * 0.5 - 5.0, f32::from(i / 20) * 0.3 - 3.0);
        let time = f32::from(i) / 400.0;
        let bits = |scene: &Scene| height(scene, x, y, time).map(f32::to_bits);
        assert_eq!(bits(&first), bits(&after_last));
        differ += usize::from(bits(&first) != bits(&other));
    }
    assert!(differ > 20, "the test sees the object");
}

#[test]
fn patterns_go_along_from_frame_to_frame() {
    let board = "Animation { } Materials { Matte { color 1 0 0 } Matte { color 0 1 0 } Checkerboard { materialIndex 0 materialIndex 1 } }";
    let text = format!(
        "{CAMERA} {board} Group {{ MaterialIndex 2 Transform {{ Translate (24 * time) 0 0 Box {{ min -9 -9 -1 max 9 9 0 }} }} }}"
    );
    // A square to the right in each frame.
    for frame in [1, 2, 3] {
        let scene = compiled(&text, &options(Some(frame))).unwrap();
        let motion = &scene.geometry.motions[0];
        let p = Vec3::new(0.5, 0.5, 0.0);
        let now = motion.at(0.0).point(p);
        assert_eq!(now.x, 0.5 + (frame - 1) as f32);
        assert!(motion.painted(now, 0.0).distance(p) < 1e-5);
    }
}

#[test]
fn mistakes_are_said() {
    let said = |text: &str, frame| compiled(&format!("{CAMERA} {text}"), &options(frame)).unwrap_err();
    assert_eq!(said("Animation { fps 0 }", None).len(), 1);
    assert_eq!(said("Animation { fps -24 }", Some(3)).len(), 1);
    assert_eq!(said("Animation { frames 9 3 }", None), ["the last frame does not come before the first one"]);
    assert_eq!(
        said("Animation { fps (time) }", Some(2)).pop().unwrap(),
        "the frames of a scene are the same at all times"
    );
    assert_eq!(said("Animation { rate 3 }", None).len(), 1);
    // A number that is right at the frame and wrong while the shutter is open.
    let wrong = "Materials { Matte { } } Group { MaterialIndex 0 Transform { XRotate 1e38 * (1 + 1e5 * time) Sphere { center 0 0 0 radius 1 } } }";
    assert_eq!(said(wrong, Some(1)).len(), 1);
}
