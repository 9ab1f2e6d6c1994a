//! Cameras: points of the picture become directions, and light that arrives finds the picture again.
//!
//! Those that light can be connected with name the density themselves ([`Camera::importance`]). The others are held
//! against the closed form of their projection, for a picture whose points are uniform:
//!
//! ```text
//! panorama    1 / (2 pi^2 cos(latitude))
//! fisheye     r r'(theta) / (4 sin theta)           the disk r <= 1 in a square of area 4
//! cube        1 / (24 cos^3)                        cos with the axis of the face
//! ```

use std::f32::consts::PI;

use kajo_math::rng::Stream;
use kajo_math::{DAffine3, DVec2, DVec3, Motion, Vec2, Vec3};

use super::{Census, Draw, Furnace, Who, kinds};
use crate::camera::tests::every_camera;
use crate::camera::{Camera, CameraFrame, FisheyeCamera, FisheyeProjection, MovingCamera};
use crate::motion::{MovingTransform, Shutter};

kinds!(Camera: Orthographic, Perspective, Panorama, Fisheye, StereoCubemap, Moving);

const ASPECT: f32 = 1.5;

pub(super) fn census() -> Census {
    let unpowered = &["Panorama", "Fisheye", "StereoCubemap"];
    Census { family: "camera", kinds: KINDS.to_vec(), pointlike: &[], unpowered }
}

/// The list of the cameras' own tests, and one that moves.
fn cameras() -> Vec<Camera> {
    let mut cameras = every_camera();
    let lens = cameras.iter().find(|camera| camera.has_lens()).cloned().expect("one has a lens");
    let map = MovingTransform::new(Motion::still(DAffine3::IDENTITY), Shutter::default());
    cameras.push(Camera::Moving(Box::new(MovingCamera { camera: lens, map })));
    cameras
}

fn who(camera: &Camera, number: usize) -> Who {
    Who { family: "camera", kind: kind(camera), name: format!("number {number}") }
}

#[test]
fn rays_have_unit_directions() {
    let turn = Motion::still(DAffine3::from_axis_angle(DVec3::ONE.normalize(), 0.7));
    let map = MovingTransform::new(turn, Shutter::default());
    let turned = cameras()
        .into_iter()
        .map(|camera| Camera::Moving(Box::new(MovingCamera { camera, map: map.clone() })));
    for (i, camera) in cameras().into_iter().chain(turned).enumerate() {
        for k in 0..500 {
            let s = Stream::new(5, [i as u32, k], 0);
            let [at, lens] = [0, 2].map(|n| Vec2::new(s.uniform(n), s.uniform(n + 1)));
            // The closest representable vectors have squared lengths within three roundings of 1.
            let Some(ray) = camera.ray(2.2 * at - 1.1, ASPECT, lens, s.uniform(4)) else { continue };
            let off = (ray.d.as_dvec3().length_squared() - 1.0).abs();
            assert!(off < 4.0 * f64::from(f32::EPSILON), "{camera:?}: {off} off at {at}");
        }
    }
}

pub(super) fn draws() -> Vec<Draw> {
    cameras().into_iter().enumerate().filter_map(|(i, camera)| draw(who(&camera, i), camera)).collect()
}

/// `None` for parallel rays, which have one direction, and for axes that make no picture light could find.
fn draw(who: Who, camera: Camera) -> Option<Draw> {
    let frame = *camera.frame();
    let local = move |w: Vec3| {
        Vec3::new(w.dot(frame.right.as_vec3()), w.dot(frame.up.as_vec3()), w.dot(frame.forward.as_vec3()))
    };
    match camera.at_rest().clone() {
        Camera::Orthographic(still) => {
            let focus = still.lens.as_ref()?.focus;
            // One point of the film: its rays meet in focus, and each has its own point of the lens.
            let film = Vec2::new(0.3, -0.4);
            let drawn = camera.clone();
            let middle =
                frame.center + 0.5 * still.size * (0.3 * f64::from(ASPECT) * frame.right - 0.4 * frame.up);
            Some(Draw {
                who,
                draw: Box::new(move |u, _| Some(drawn.ray(film, ASPECT, u, 0.0)?.d)),
                pdf: Box::new(move |d| {
                    let slope = local(d).truncate().as_dvec2() / f64::from(local(d).z);
                    let DVec2 { x, y } = -focus * slope;
                    let o = middle + x * frame.right + y * frame.up;
                    camera.importance(o.as_vec3(), d, ASPECT, 0.0).map_or(0.0, |seen| seen.pdf_direction)
                }),
            })
        }
        Camera::Perspective(_) => {
            frame.is_orthonormal().then_some(())?;
            let lens = Vec2::new(0.1, 0.8);
            let drawn = camera.clone();
            let ray = move |film: Vec2| drawn.ray(2.0 * film - 1.0, ASPECT, lens, 0.0);
            let o = ray(Vec2::splat(0.5))?.o;
            Some(Draw {
                who,
                draw: Box::new(move |film, _| Some(ray(film)?.d)),
                pdf: Box::new(move |d| {
                    camera.importance(o, d, ASPECT, 0.0).map_or(0.0, |seen| seen.pdf_direction)
                }),
            })
        }
        still => {
            let projected = move |w: Vec3| match &still {
                Camera::Fisheye(fisheye) => fisheye_pdf(fisheye, w),
                Camera::StereoCubemap(_) => 1.0 / (24.0 * w.abs().max_element().powi(3)),
                _ => 1.0 / (2.0 * PI * PI * w.x.hypot(w.z).max(1e-6)),
            };
            Some(Draw {
                who,
                draw: Box::new(move |film, _| Some(camera.ray(2.0 * film - 1.0, 1.0, film, 0.0)?.d)),
                pdf: Box::new(move |d| projected(local(d))),
            })
        }
    }
}

/// Density of a direction in the camera's axes for a square picture; the growth of its radius is a difference.
fn fisheye_pdf(camera: &FisheyeCamera, w: Vec3) -> f32 {
    let half = 0.5 * camera.angle;
    let radius = |theta: f64| match camera.projection {
        FisheyeProjection::Equidistant => theta / half,
        FisheyeProjection::Equisolid => (0.5 * theta).sin() / (0.5 * half).sin(),
        FisheyeProjection::Stereographic => (0.5 * theta).tan() / (0.5 * half).tan(),
        FisheyeProjection::Orthographic => theta.sin() / half.sin(),
    };
    let theta = f64::from(w.z).clamp(-1.0, 1.0).acos().clamp(1e-4, std::f64::consts::PI - 1e-4);
    // Where the disk reaches the corners the picture shows a part of it.
    let reach = if camera.to_corners { 2f64.sqrt() } else { 1.0 };
    let at = reach * radius(theta) * w.truncate().as_dvec2().normalize_or_zero();
    if theta > half || at.abs().max_element() > 1.0 {
        return 0.0;
    }
    let step = 1e-5;
    let growth = (radius(theta + step) - radius(theta - step)) / (2.0 * step);
    (reach * reach * radius(theta) * growth / (4.0 * theta.sin())) as f32
}

/// Width and height of a plane across the view at a distance, somewhat more than the camera sees of it.
fn seen_across(camera: &Camera, frame: &CameraFrame, distance: f64) -> [f64; 2] {
    let corners = [-1.0, 1.0].into_iter().flat_map(|x| [-1.0, 1.0].map(|y| Vec2::new(x, y)));
    let lens = |i: u32| Vec2::new((i % 8) as f32, (i / 8) as f32) / 8.0;
    let rays = corners.flat_map(|at| (0..64).filter_map(move |i| camera.ray(at, ASPECT, lens(i), 0.0)));
    let reach = rays.map(|ray| {
        let (o, d) = (ray.o.as_dvec3() - frame.center, ray.d.as_dvec3());
        let p = o + (distance - o.dot(frame.forward)) / d.dot(frame.forward) * d;
        DVec2::new(p.dot(frame.right), p.dot(frame.up)).abs()
    });
    (2.2 * reach.fold(DVec2::ZERO, DVec2::max)).to_array()
}

/// Light of unit radiance from a plane: the mean of the picture is 1.
pub(super) fn furnaces() -> Vec<Furnace> {
    let connected = |camera: &Camera| camera.is_connectable() && camera.frame().is_orthonormal();
    let all = cameras().into_iter().enumerate().filter(|(_, camera)| connected(camera));
    all.map(|(i, camera)| {
        let frame = *camera.frame();
        let middle = frame.center + 3.0 * frame.forward;
        let [width, height] = seen_across(&camera, &frame, 3.0);
        Furnace {
            who: who(&camera, i),
            energy: Box::new(move |u, uc| {
                let (x, y) = (width * (f64::from(u.x) - 0.5), height * (f64::from(u.y) - 0.5));
                let p = (middle + x * frame.right + y * frame.up).as_vec3();
                let lens = Vec2::new(uc, (uc * 977.0).fract());
                let Some(way) = camera.connect(p, lens, ASPECT, 0.0) else { return 0.0 };
                let cosine = -way.wi.as_dvec3().dot(frame.forward);
                width * height * cosine * f64::from(way.we / way.pdf)
            }),
            // The edge of the picture cuts through cells of the sample grid.
            expected: [0.985, 1.015],
        }
    })
    .collect()
}
