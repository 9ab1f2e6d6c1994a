use kajo_core::camera::{FisheyeCamera, FisheyeProjection, PanoramaCamera};
use kajo_math::Vec3;
use kajo_math::rng::Stream;

use super::*;

const SIZE: [u32; 2] = [960, 540];

fn random(i: u32) -> impl FnMut() -> f64 {
    let s = Stream::new(11, [i, 0], 0);
    let mut k = 0;
    move || {
        k += 1;
        f64::from(s.uniform(k - 1))
    }
}

fn random_vector(next: &mut impl FnMut() -> f64) -> DVec3 {
    2.0 * DVec3::new(next(), next(), next()) - 1.0
}

/// A random camera of every kind that has a projection.
fn poses(i: u32) -> Vec<CameraPose> {
    let mut next = random(i);
    let (eye, target, up) =
        (5.0 * random_vector(&mut next), random_vector(&mut next), random_vector(&mut next));
    let perspective = CameraPose::perspective(eye, target, up, 0.2 + 1.5 * next());
    let frame = *perspective.camera.frame();
    let with = |camera| CameraPose::new(camera, up);
    let fisheye = FisheyeCamera {
        frame,
        angle: 3.0,
        projection: FisheyeProjection::Equisolid,
        to_corners: next() < 0.5,
    };
    vec![
        CameraPose { corner_samples: true, ..perspective.clone() },
        CameraPose::orthographic(eye, target, up, 1.0 + 5.0 * next()),
        with(Camera::Panorama(PanoramaCamera { frame, eyes: None })),
        with(Camera::Fisheye(fisheye)),
        perspective,
    ]
}

#[test]
fn rays_go_through_the_pixels_that_points_appear_in() {
    let mut checked = 0;
    for i in 0..200 {
        let mut next = random(1000 + i);
        for pose in poses(i) {
            let place = DVec2::new(960.0 * next(), 540.0 * next());
            let Some(ray) = pose.ray(place, SIZE) else { continue };
            let p = ray.o.as_dvec3() + (0.5 + 20.0 * next()) * ray.d.as_dvec3();
            let found = pose.project(p, SIZE).expect("what a ray meets is seen");
            assert!(found.distance(place) < 0.01, "{pose:?}: {found} for {place}");
            checked += 1;
        }
    }
    assert!(checked > 900, "{checked}");
}

#[test]
fn the_matrix_agrees_with_the_rays() {
    for i in 0..200 {
        let mut next = random(2000 + i);
        for pose in poses(i) {
            let Some(matrix) = pose.projection(SIZE, 0.1, 1000.0) else { continue };
            let place = DVec2::new(960.0 * next(), 540.0 * next());
            let ray = pose.ray(place, SIZE).expect("flat pictures see everywhere");
            let p = ray.o.as_dvec3() + (0.5 + 20.0 * next()) * ray.d.as_dvec3();
            let clip = matrix * p.extend(1.0);
            let ndc = clip.truncate() / clip.w;
            let found = DVec2::new(480.0 * (1.0 + ndc.x), 270.0 * (1.0 - ndc.y));
            assert!(found.distance(place) < 0.01, "{pose:?}: {found} for {place}");
            assert!((0.0..1.0).contains(&ndc.z), "{ndc}");
        }
    }
}

/// A camera that moves is where it is when the shutter opens, and stands there once it is changed.
#[test]
fn a_moving_camera_starts_where_the_shutter_opens() {
    let text = "PerspectiveCamera { center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30
                  Motion { key 0 { Translate 1 2 3 YRotate 30 } key 1 { Translate 2 0 0 } } }";
    let assets = crate::MemoryAssets::new().with("a.txt", text);
    let loaded = crate::load_from("a.txt", &assets, &crate::LoadOptions::default());
    let scene = loaded.scene.as_ref().unwrap_or_else(|| panic!("{}", loaded.report(false)));
    let mut pose = CameraPose::of(scene);
    assert!(pose.camera().moves());
    let place = DVec2::new(100.0, 200.0);
    let ray = pose.ray(place, SIZE).unwrap();
    let p = ray.o.as_dvec3() + 3.0 * ray.d.as_dvec3();
    assert!(ray.o.as_dvec3().distance(pose.eye()) < 1e-5);
    assert!(pose.project(p, SIZE).unwrap().distance(place) < 0.01);
    let original = scene.output.camera.ray(Vec2::new(0.3, 0.1), 1.0, Vec2::ZERO, 0.0).unwrap();
    assert!(original.o.as_dvec3().distance(pose.eye()) < 1e-5, "{original:?}");
    pose.fly(DVec3::ZERO);
    assert!(!pose.camera().moves());
    let now = pose.camera().ray(Vec2::new(0.3, 0.1), 1.0, Vec2::ZERO, 0.0).unwrap();
    assert!(now.d.distance(original.d) < 1e-6 && now.o.distance(original.o) < 1e-5);
}

#[test]
fn near_and_far_are_the_ends_of_depth() {
    for pose in poses(3) {
        let Some(matrix) = pose.projection(SIZE, 0.5, 30.0) else { continue };
        for (distance, depth) in [(0.5, 0.0), (30.0, 1.0)] {
            let clip = matrix * (pose.eye() + distance * pose.forward()).extend(1.0);
            assert!((clip.z / clip.w - depth).abs() < 1e-9, "{pose:?}");
        }
    }
}

#[test]
fn turning_keeps_the_horizon_level_and_never_topples() {
    let mut pose = CameraPose::perspective(DVec3::ZERO, DVec3::NEG_Z, DVec3::Y, 1.0);
    pose.turn(0.5 * std::f64::consts::PI, 0.0);
    assert!(pose.forward().distance(DVec3::X) < 1e-12, "a turn to the right goes from -z to x");
    for i in 0..500 {
        let mut next = random(i);
        pose.turn(next() - 0.5, 2.0 * next() - 1.0);
        assert!(pose.right().y.abs() < 1e-12 && pose.up().y > 0.0, "{pose:?}");
        assert!((pose.forward().length() - 1.0).abs() < 1e-12);
    }
}

#[test]
fn an_orbit_keeps_distance_and_place_in_the_picture() {
    let center = DVec3::new(1.0, 0.5, -2.0);
    let mut pose = CameraPose::perspective(DVec3::new(4.0, 3.0, 5.0), DVec3::ZERO, DVec3::Y, 0.8);
    let (distance, seen) = (pose.eye().distance(center), pose.project(center, SIZE).unwrap());
    let eye = pose.eye();
    pose.orbit(center, 0.3, 0.1);
    assert!(pose.eye().distance(eye) > 0.5);
    for i in 0..100 {
        let mut next = random(i);
        pose.orbit(center, next() - 0.5, next() - 0.5);
        assert!((pose.eye().distance(center) - distance).abs() < 1e-9);
        assert!(pose.project(center, SIZE).unwrap().distance(seen) < 1e-6);
    }
}

#[test]
fn a_framed_box_is_in_the_picture_and_fills_much_of_it() {
    let bounds = Aabb::around([Vec3::new(-3.0, 1.0, 2.0), Vec3::new(1.0, 2.0, 9.0)]);
    for (i, aspect) in [(1, 16.0 / 9.0), (2, 1.0), (3, 0.5)] {
        let size = [(540.0 * aspect) as u32, 540];
        for mut pose in poses(i).into_iter().filter(|pose| pose.projection(SIZE, 1.0, 2.0).is_some()) {
            pose.frame(&bounds, aspect);
            let mut reach = 0.0f64;
            for corner in 0..8 {
                let pick = |k: usize| if corner >> k & 1 == 0 { bounds.min[k] } else { bounds.max[k] };
                let p = pose.project(Vec3::new(pick(0), pick(1), pick(2)).as_dvec3(), size).unwrap();
                let middle = 0.5 * DVec2::new(size[0].into(), size[1].into());
                reach = reach.max(((p - middle) / middle).abs().max_element());
            }
            assert!(reach < 1.0 && reach > 0.4, "{pose:?}: {reach}");
        }
    }
}

#[test]
fn a_steep_field_of_view_and_size_can_be_set() {
    let mut pose = CameraPose::perspective(DVec3::Z, DVec3::ZERO, DVec3::Y, 1.0);
    pose.set_angle(0.5);
    assert!((pose.angle().unwrap() - 0.5).abs() < 1e-12 && pose.size().is_none());
    let mut pose = CameraPose::orthographic(DVec3::Z, DVec3::ZERO, DVec3::Y, 1.0);
    pose.set_size(3.0);
    assert_eq!(pose.size(), Some(3.0));
    assert!(pose.angle().is_none());
}
