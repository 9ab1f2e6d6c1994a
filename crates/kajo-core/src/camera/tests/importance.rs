//! Importance: it integrates to one, and belongs to the rays that the camera casts.

use kajo_testkit::{Estimate, sphere};

use super::*;

const ASPECT: f32 = 1.5;

fn cameras() -> Vec<Camera> {
    let frame = CameraFrame::new(DVec3::new(0.3, -0.2, 1.0), DVec3::new(1.0, 2.0, -1.5), DVec3::Y);
    let lens = |aperture| Some(ThinLens { aperture, radius: 0.3, focus: 4.0 });
    let perspective = PerspectiveCamera::new(frame, 0.9);
    vec![
        Camera::Perspective(perspective.clone()),
        Camera::Perspective(perspective.clone().with_lens(lens(Aperture::Round))),
        Camera::Perspective(perspective.with_lens(lens(Aperture::Polygon { blades: 5, rotation: 1.0 }))),
        Camera::Orthographic(OrthographicCamera { frame, size: 3.0, lens: lens(Aperture::Round) }),
        Camera::Orthographic(OrthographicCamera {
            frame,
            size: 3.0,
            lens: lens(Aperture::Polygon { blades: 3, rotation: 0.0 }),
        }),
    ]
}

fn axes(camera: &Camera) -> CameraFrame {
    match camera {
        Camera::Perspective(camera) => *camera.frame(),
        Camera::Orthographic(camera) => camera.frame,
        _ => unreachable!("no other cameras here"),
    }
}

#[test]
fn a_ray_of_the_camera_is_found_where_it_was_cast() {
    for camera in cameras() {
        for i in 0..500 {
            let s = Stream::new(6, [i, 0], 0);
            let at = 1.98 * Vec2::new(s.uniform(0), s.uniform(1)) - 0.99;
            // The hull of the lens itself is left out, where rounding decides.
            let u = 0.02 + 0.96 * Vec2::new(s.uniform(2), s.uniform(3));
            let ray = camera.ray(at, ASPECT, u, 0.0).expect("a ray");
            let seen = camera.importance(ray.o, ray.d, ASPECT, 0.0).expect("the camera cast it");
            assert!(seen.at.distance(at) < 1e-5, "{at} {seen:?}");
            // The rays are drawn in proportion to importance times cosine.
            let cosine = ray.d.dot(axes(&camera).forward.as_vec3());
            assert!((seen.we * cosine / (seen.pdf_area * seen.pdf_direction) - 1.0).abs() < 1e-5);
            assert_eq!(camera.importance(ray.o, -ray.d, ASPECT, 0.0), None, "behind the camera");
        }
    }
}

/// The integral of the importance over rays from points that are drawn, which is one.
#[test]
fn origins_cover_all_rays_of_a_lens() {
    for camera in cameras().into_iter().filter(Camera::has_lens) {
        let frame = axes(&camera);
        // The tangent of the largest angle to the camera's direction; a telecentric lens is 0.3 wide, 4 before its focus.
        let reach = if matches!(camera, Camera::Orthographic(_)) { 0.08 } else { 1.0 };
        let estimate = Estimate::of_batches(|batch| {
            let n = 100;
            let mut sum = 0.0;
            for i in 0..n * n {
                let s = Stream::new(16, [i, batch], 0);
                let u = Vec2::new((i % n) as f32 + s.uniform(0), (i / n) as f32 + s.uniform(1)) / n as f32;
                let o = camera.sample_origin(u, ASPECT, 0.0).expect("it has a lens");
                assert!((o.as_dvec3() - frame.center).dot(frame.forward).abs() < 1e-5);
                // Directions uniform in the tangent plane: dw = cos^3 dA.
                let across = reach * (2.0 * Vec2::new(s.uniform(2), s.uniform(3)).as_dvec2() - 1.0);
                let d = (frame.forward + across.x * frame.right + across.y * frame.up).normalize();
                let cosine = d.dot(frame.forward);
                if let Some(seen) = camera.importance(o, d.as_vec3(), ASPECT, 0.0) {
                    sum += 4.0 * reach * reach * f64::from(seen.we / seen.pdf_origin) * cosine.powi(4);
                }
            }
            sum / f64::from(n * n)
        });
        estimate.check(1.0, 0.02).unwrap_or_else(|problem| panic!("{camera:?}: {problem}"));
    }
    for camera in cameras().into_iter().filter(|camera| !camera.has_lens()) {
        assert_eq!(camera.sample_origin(Vec2::splat(0.5), ASPECT, 0.0), None);
    }
}

/// Light from a plane of uniform radiance: each camera's picture is uniform, and all of it has the mean 1.
#[test]
fn importance_integrates_to_one() {
    for camera in cameras() {
        let frame = axes(&camera);
        let depth = 3.0;
        // The part of the plane that the camera sees, and more.
        let (width, height) = (8.0, 6.0);
        let middle = frame.center + depth * frame.forward;
        let mut quarters = [0.0; 4];
        let estimate = Estimate::of_batches(|batch| {
            let n = 60;
            let mut sum = 0.0;
            for i in 0..n * n {
                let s = Stream::new(9, [i, batch], 0);
                let u = |k: u32| f64::from(s.uniform(k));
                let (x, y) =
                    ((f64::from(i % n) + u(0)) / f64::from(n), (f64::from(i / n) + u(1)) / f64::from(n));
                let p = middle + width * (x - 0.5) * frame.right + height * (y - 0.5) * frame.up;
                let lens = Vec2::new(s.uniform(2), s.uniform(3));
                let Some(way) = camera.connect(p.as_vec3(), lens, ASPECT, 0.0) else { continue };
                let cosine = -way.wi.as_dvec3().dot(frame.forward);
                let value = width * height * cosine * f64::from(way.we / way.pdf) / f64::from(n * n);
                quarters[usize::from(way.at.x > 0.0) + 2 * usize::from(way.at.y > 0.0)] += value / 32.0;
                sum += value;
            }
            sum
        });
        estimate.check(1.0, 0.002).unwrap_or_else(|problem| panic!("{camera:?}: {problem}"));
        for quarter in quarters {
            assert!((quarter - 0.25).abs() < 0.005, "{camera:?}: {quarters:?}");
        }
    }
}

#[test]
fn a_connection_ends_on_the_lens_and_shows_where_the_camera_looks() {
    for camera in cameras() {
        let frame = axes(&camera);
        for i in 0..200 {
            let s = Stream::new(8, [i, 0], 0);
            let at = 1.8 * Vec2::new(s.uniform(0), s.uniform(1)) - 0.9;
            let u = Vec2::new(s.uniform(2), s.uniform(3));
            // A point in focus is seen at the same position through any point of the lens.
            let ray = camera.ray(at, ASPECT, u, 0.0).expect("a ray");
            let t = 4.0 / f64::from(ray.d.dot(frame.forward.as_vec3()));
            let p = ray.o.as_dvec3() + t * ray.d.as_dvec3();
            let way = camera.connect(p.as_vec3(), Vec2::new(u.y, u.x), ASPECT, 0.0).expect("it is seen");
            assert!(way.at.distance(at) < 1e-4, "{at} {way:?}");
            let o = p + f64::from(way.distance) * way.wi.as_dvec3();
            assert!((o - frame.center).dot(frame.forward).abs() < 1e-5);
        }
    }
}

#[test]
fn what_is_not_in_the_picture_has_no_importance() {
    for camera in cameras() {
        let frame = axes(&camera);
        let at = |right: f64, forward: f64| {
            let p = frame.center + right * frame.right + forward * frame.forward;
            camera.connect(p.as_vec3(), Vec2::splat(0.4), ASPECT, 0.0)
        };
        assert!(at(0.0, 3.0).is_some());
        assert_eq!(at(30.0, 3.0), None, "beside the picture");
        assert_eq!(at(0.0, -3.0), None, "behind the camera");
    }
    let frame = axes(&cameras()[0]);
    for camera in [
        Camera::Orthographic(OrthographicCamera {
            frame: frame.with_raw_up(DVec3::Z),
            size: 3.0,
            lens: None,
        }),
        Camera::Perspective(PerspectiveCamera::new(frame.with_raw_up(DVec3::Z), 0.9)),
        Camera::Panorama(PanoramaCamera { frame, eyes: None }),
    ] {
        let p = (frame.center + frame.forward).as_vec3();
        assert_eq!(camera.connect(p, Vec2::splat(0.5), ASPECT, 0.0), None, "{camera:?}");
    }
}

#[test]
fn parallel_rays_are_connected_with_where_they_are() {
    let frame = axes(&cameras()[0]);
    let camera = Camera::Orthographic(OrthographicCamera { frame, size: 3.0, lens: None });
    let p =
        |right: f64| (frame.center + right * frame.right - 0.75 * frame.up - 7.0 * frame.forward).as_vec3();
    let way = camera.connect(p(0.9), Vec2::ZERO, ASPECT, 0.0).expect("rays start infinitely far back");
    assert!(way.at.distance(Vec2::new(0.4, -0.5)) < 1e-5 && way.distance == f32::INFINITY);
    assert!((way.we / way.pdf - 1.0 / 13.5).abs() < 1e-6, "one over the area of the film");
    assert!((way.wi.as_dvec3() + frame.forward).length() < 1e-6);
    assert_eq!(camera.connect(p(2.3), Vec2::ZERO, ASPECT, 0.0), None, "beside the picture");
}

/// The density of camera rays around a point is the same for the ray and for the connection.
#[test]
fn rays_cross_an_area_as_often_as_connections_say() {
    let frame = axes(&cameras()[0]);
    let parallel = Camera::Orthographic(OrthographicCamera { frame, size: 3.0, lens: None });
    for camera in cameras().into_iter().chain([parallel]) {
        for i in 0..200 {
            let s = Stream::new(10, [i, 0], 0);
            let at = 1.8 * Vec2::new(s.uniform(0), s.uniform(1)) - 0.9;
            let u = 0.02 + 0.96 * Vec2::new(s.uniform(2), s.uniform(3));
            let ray = camera.ray(at, ASPECT, u, 0.0).expect("a ray");
            // Where all points of the lens see it at the same position.
            let t = 4.0 / ray.d.dot(frame.forward.as_vec3());
            let across = camera.pdf_across(&ray, t, ASPECT).expect("the camera cast it");
            let way = camera.connect(ray.at(t), u, ASPECT, 0.0).expect("it is seen");
            assert!((across / way.pdf_across - 1.0).abs() < 1e-3, "{camera:?}: {across} {way:?}");
            assert!(way.pdf_across > 0.0);
        }
    }
    // Twice as far away rays of one origin are a quarter as dense.
    let ray = cameras()[0].ray(Vec2::ZERO, ASPECT, Vec2::ZERO, 0.0).expect("a ray");
    let across = |t| cameras()[0].pdf_across(&ray, t, ASPECT).expect("it is seen");
    assert!((across(2.0) / across(4.0) - 4.0).abs() < 1e-5);
}

#[test]
fn directions_from_a_point_of_the_lens_follow_their_density() {
    const TESTS: u32 = 6;
    let perspective = |camera: &Camera| matches!(camera, Camera::Perspective(_));
    for camera in cameras().into_iter().filter(perspective) {
        for lens in [Vec2::new(0.5, 0.5), Vec2::new(0.1, 0.8)] {
            let ray = |film: Vec2| camera.ray(2.0 * film - 1.0, ASPECT, lens, 0.0);
            let o = ray(Vec2::splat(0.5)).expect("a ray").o;
            let pdf = |d: Vec3| camera.importance(o, d, ASPECT, 0.0).map_or(0.0, |seen| seen.pdf_direction);
            let result = sphere::test(60_000, 31, |film, _| ray(film).map(|ray| ray.d), pdf);
            assert!(result.passes(0.01, TESTS), "{camera:?} at {lens}: {result:?}");
        }
    }
}
