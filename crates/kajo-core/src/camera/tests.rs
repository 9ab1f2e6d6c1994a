mod fisheye;
mod importance;
mod lens;

use kajo_math::{Aabb, DVec3, Vec2, Vec3, rng::Stream};

use super::*;

fn random_frame(i: u32) -> CameraFrame {
    let s = Stream::new(3, [i, 0], 0);
    let v = |k: u32| {
        DVec3::new(s.uniform(k).into(), s.uniform(k + 1).into(), s.uniform(k + 2).into()) * 2.0 - 1.0
    };
    CameraFrame::new(5.0 * v(0), v(3), v(6))
}

/// A camera of each kind and of each projection, without lenses and with.
pub(crate) fn every_camera() -> Vec<Camera> {
    let frame = random_frame(7);
    let lens = ThinLens { aperture: Aperture::Round, radius: 0.2, focus: 4.0 };
    let mut cameras = vec![
        Camera::Perspective(PerspectiveCamera::new(frame, 0.9)),
        Camera::Orthographic(OrthographicCamera { frame, size: 3.0, lens: None }),
        Camera::Perspective(PerspectiveCamera::new(frame, 0.4)).with_lens(Some(lens.clone())),
        Camera::Orthographic(OrthographicCamera { frame, size: 7.0, lens: Some(lens) }),
        Camera::Perspective(PerspectiveCamera::new(frame.with_raw_up(frame.up + 0.3 * frame.right), 0.9)),
        Camera::Panorama(PanoramaCamera { frame, eyes: None }),
        Camera::Panorama(PanoramaCamera { frame, eyes: Some(EyePair { separation: 0.1 }) }),
        Camera::StereoCubemap(StereoCubemapCamera {
            frame,
            eyes: EyePair { separation: 0.1 },
            stereo: Stereo::Twin,
        }),
        Camera::StereoCubemap(StereoCubemapCamera {
            frame,
            eyes: EyePair { separation: 0.1 },
            stereo: Stereo::Omnidirectional,
        }),
    ];
    for (projection, angle) in [
        (FisheyeProjection::Equidistant, 5.0),
        (FisheyeProjection::Equisolid, 4.0),
        (FisheyeProjection::Stereographic, 3.5),
        (FisheyeProjection::Orthographic, 3.0),
    ] {
        for to_corners in [false, true] {
            cameras.push(Camera::Fisheye(FisheyeCamera { frame, angle, projection, to_corners }));
        }
    }
    cameras
}

#[test]
fn rays_start_in_the_box_around_their_origins() {
    let positions = [Vec2::new(-1.0, 1.0), Vec2::new(1.0, -1.0)];
    for camera in every_camera() {
        let Some(origins) = camera.origins(positions, 1.5) else {
            let ray = camera.ray(Vec2::ZERO, 1.5, Vec2::ZERO, 0.0).expect("seen by any camera");
            assert_eq!(ray.t_min, f32::NEG_INFINITY);
            continue;
        };
        let share_one = origins.min == origins.max;
        assert_eq!(
            share_one,
            camera.apex().is_some()
                || matches!(camera, Camera::Fisheye(_))
                || matches!(camera, Camera::Panorama(PanoramaCamera { eyes: None, .. })),
            "{camera:?}"
        );
        let nearly = Aabb { min: origins.min - 1e-5, max: origins.max + 1e-5 };
        for i in 0..500 {
            let s = Stream::new(9, [i, 0], 0);
            let at = Vec2::new(s.uniform(0), s.uniform(1)) * 2.0 - 1.0;
            let Some(ray) = camera.ray(at, 1.5, Vec2::new(s.uniform(2), s.uniform(3)), 0.0) else { continue };
            assert!(nearly.contains(ray.o), "{camera:?}: {} is not in {origins:?}", ray.o);
        }
    }
}

#[test]
fn orthographic_corners_are_where_the_handout_puts_them() {
    for i in 0..100 {
        let frame = random_frame(i);
        let camera = OrthographicCamera { frame, size: 3.0, lens: None };
        for (x, y) in [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)] {
            let ray = camera.ray(Vec2::new(x, y), 1.5, Vec2::ZERO).unwrap();
            let (x, y) = (f64::from(x), f64::from(y));
            let expected = frame.center + 3.0 / 2.0 * y * frame.up + 3.0 * 1.5 / 2.0 * x * frame.right;
            assert!(ray.o.as_dvec3().distance(expected) < 1e-5);
            assert_eq!(ray.t_min, f32::NEG_INFINITY);
        }
    }
}

#[test]
fn perspective_angle_is_vertical() {
    let frame = CameraFrame::new(DVec3::ZERO, DVec3::NEG_Z, DVec3::Y);
    let camera = PerspectiveCamera::new(frame, 90f64.to_radians());
    let top = camera.ray(Vec2::new(0.0, 1.0), 2.0, Vec2::ZERO).unwrap().d;
    assert!((top - Vec3::new(0.0, 1.0, -1.0).normalize()).length() < 1e-6);
    let right = camera.ray(Vec2::new(1.0, 0.0), 2.0, Vec2::ZERO).unwrap().d;
    assert!((right - Vec3::new(2.0, 0.0, -1.0).normalize()).length() < 1e-6);
}

#[test]
fn degenerate_up_sends_the_centre_ray_everywhere() {
    let frame = CameraFrame::new(DVec3::ZERO, DVec3::NEG_Z, DVec3::Z);
    let camera = PerspectiveCamera::new(frame, 1.0);
    assert_eq!(camera.ray(Vec2::new(0.7, -0.3), 1.0, Vec2::ZERO).unwrap().d, Vec3::NEG_Z);
}

/// The angle between the eyes' views of a point at distance d: asin(r/d) tangent, atan(r/d) twin.
#[test]
fn stereo_parallax_has_its_closed_form() {
    let frame = CameraFrame::new(DVec3::ZERO, DVec3::NEG_Z, DVec3::Y);
    let eyes = EyePair { separation: 0.065 };
    let panorama = PanoramaCamera { frame, eyes: Some(eyes) };
    for (d, degrees) in [(1.0, 1.862_441), (2.0, 0.931_097), (10.0, 0.186_212)] {
        // The ray through longitude a passes the eye circle on a tangent; it meets the circle of
        // radius d at angle a - asin(r/d) for the right eye. Solve for the point straight ahead.
        let a = f64::to_radians(degrees);
        let ray = panorama.ray(Vec2::new((-a / std::f64::consts::PI) as f32, -0.5), 1.0, Vec2::ZERO).unwrap();
        let target = Vec3::new(0.0, 0.0, -d as f32);
        let miss = (target - ray.o).cross(ray.d).length();
        assert!(miss < 1e-6 * d as f32 + 1e-7, "{d}: {miss}");
    }
    let twin = StereoCubemapCamera { frame, eyes, stereo: Stereo::Twin };
    for (d, degrees) in [(1.0f64, 1.861_458f64), (2.0, 0.930_974), (10.0, 0.186_213)] {
        let x = -degrees.to_radians().tan();
        // The middle of face 10, the right eye's front face.
        let ray = twin.ray(Vec2::new(((10.5 + 0.5 * x) / 6.0 - 1.0) as f32, 0.0), 12.0, Vec2::ZERO).unwrap();
        let miss = (Vec3::new(0.0, 0.0, -d as f32) - ray.o).cross(ray.d).length();
        assert!(miss < 3e-6 * d as f32, "{d}: {miss}");
    }
}

#[test]
fn cube_faces_meet_along_their_edges() {
    let frame = random_frame(4);
    let camera = StereoCubemapCamera { frame, eyes: EyePair { separation: 0.0 }, stereo: Stereo::Twin };
    // Edges as (face, point of its border, face, the same point on the other).
    for s in [-0.9, 0.0, 0.4] {
        for (f, a, g, b) in [
            (4, (1.0, s), 0, (-1.0, s)),
            (4, (-1.0, s), 1, (1.0, s)),
            (0, (1.0, s), 5, (-1.0, s)),
            (1, (-1.0, s), 5, (1.0, s)),
            (4, (s, 1.0), 2, (s, -1.0)),
            (4, (s, -1.0), 3, (s, 1.0)),
            (0, (s, 1.0), 2, (1.0, s)),
            (5, (s, 1.0), 2, (-s, 1.0)),
            (5, (s, -1.0), 3, (-s, -1.0)),
        ] {
            let (v, w) = (camera.direction(f, a.0, a.1), camera.direction(g, b.0, b.1));
            assert!(v.distance(w) < 1e-12, "faces {f} and {g} at {s}: {v} {w}");
        }
    }
}

#[test]
fn panorama_poles_and_middle() {
    let frame = CameraFrame::new(DVec3::ZERO, DVec3::NEG_Z, DVec3::Y);
    let plain = PanoramaCamera { frame, eyes: None };
    assert!(plain.ray(Vec2::ZERO, 1.0, Vec2::ZERO).unwrap().d.distance(Vec3::NEG_Z) < 1e-6);
    assert!(plain.ray(Vec2::new(0.5, 0.0), 1.0, Vec2::ZERO).unwrap().d.distance(Vec3::X) < 1e-6);
    assert!(plain.ray(Vec2::new(0.3, 1.0), 1.0, Vec2::ZERO).unwrap().d.distance(Vec3::Y) < 1e-6);
    let stereo = PanoramaCamera { frame, eyes: Some(EyePair { separation: 2.0 }) };
    // Left eye on top, looking forward: one unit to the left.
    assert!(stereo.ray(Vec2::new(0.0, 0.5), 1.0, Vec2::ZERO).unwrap().o.distance(Vec3::NEG_X) < 1e-6);
    assert!(stereo.ray(Vec2::new(0.0, -0.5), 1.0, Vec2::ZERO).unwrap().o.distance(Vec3::X) < 1e-6);
    assert!(
        stereo.ray(Vec2::new(0.0, 0.999), 1.0, Vec2::ZERO).unwrap().o.length() < 1e-6,
        "no parallax at the pole"
    );
}
