//! Depth of field against the formulas of the thin lens.

use std::f64::consts::PI;

use kajo_math::rng::unit;
use kajo_math::sobol;

use super::*;

fn frame() -> CameraFrame {
    CameraFrame::new(DVec3::ZERO, DVec3::NEG_Z, DVec3::Y)
}

fn round(diameter: f64, focus: f64) -> ThinLens {
    ThinLens { aperture: Aperture::Round, radius: 0.5 * diameter, focus }
}

fn perspective(lens: ThinLens) -> Camera {
    Camera::Perspective(PerspectiveCamera::new(frame(), 0.6).with_lens(Some(lens)))
}

/// A grid of numbers over [0, 1)².
fn grid(n: u32) -> impl Iterator<Item = Vec2> {
    (0..n * n).map(move |i| Vec2::new((i % n) as f32 + 0.5, (i / n) as f32 + 0.5) / n as f32)
}

/// Where the ray of a position of the picture meets the plane at depth `z`.
fn crossing(camera: &Camera, at: Vec2, lens: Vec2, z: f64) -> DVec3 {
    let ray = camera.ray(at, 1.5, lens, 0.0).expect("a ray");
    let (o, d) = (ray.o.as_dvec3(), ray.d.as_dvec3());
    o - d * (z + o.z) / d.z
}

#[test]
fn the_circle_of_confusion_has_its_diameter() {
    // Aperture 0.2, focus 5.
    for (z, diameter) in [(2.5, 0.1), (4.0, 0.04), (5.0, 0.0), (7.5, 0.1), (10.0, 0.2)] {
        for lens in [Camera::with_lens, |camera: Camera, lens| {
            let Camera::Perspective(p) = camera else { return camera };
            Camera::Orthographic(OrthographicCamera { frame: *p.frame(), size: 2.0, lens })
        }] {
            let camera = lens(perspective(round(0.2, 5.0)), Some(round(0.2, 5.0)));
            let at = Vec2::new(0.3, -0.7);
            let middle = crossing(&camera, at, Vec2::splat(0.5), z);
            let radii = grid(100).map(|u| crossing(&camera, at, u, z).distance(middle));
            let widest = radii.fold(0.0, f64::max);
            // The outermost points of the grid lie half a cell inside.
            assert!((widest - 0.5 * diameter).abs() < 0.006 * diameter + 1e-6, "{z}: {widest}");
        }
    }
}

/// f = 50 mm, f/1.4, focused at 2 m: circles on the film in millimetres.
#[test]
fn circles_on_the_film_are_those_of_the_thin_lens() {
    let (f, n, s) = (50.0, 1.4, 2000.0);
    let camera = perspective(round(f / n, s));
    for (z, circle) in [(1000.0, 0.91575), (1500.0, 0.30525), (3000.0, 0.30525), (1e9, 0.91575)] {
        // The ray from a point of the axis through the upper end of the lens, and its place in the picture.
        let o = DVec3::new(0.0, 0.5 * f / n * (1.0 - 1e-6), 0.0);
        let d = (DVec3::new(0.0, 0.0, -z) - o).normalize();
        let seen = camera.importance(o.as_vec3(), d.as_vec3(), 1.5, 0.0).expect("in the picture");
        // At unit distance the picture is tan(0.3) high; the film is s f / (s - f) away.
        let on_film = f64::from(seen.at.y).abs() * 0.3f64.tan() * s * f / (s - f);
        assert!((2.0 * on_film / circle - 1.0).abs() < 1e-3, "{z}: {}", 2.0 * on_film);
    }
}

/// Share of a disk that lies within `t` of its radius to one side of its middle.
fn side_of_disk(t: f64) -> f64 {
    let t = t.clamp(-1.0, 1.0);
    0.5 + (t.asin() + t * (1.0 - t * t).sqrt()) / PI
}

#[test]
fn an_edge_out_of_focus_fades_as_the_disk_does() {
    let camera = perspective(round(0.2, 5.0));
    let (z, radius) = (2.5, 0.05);
    for k in -12..=12 {
        let t = f64::from(k) / 10.0;
        // The ray through the middle of the lens passes the edge at x = 0 by t radii.
        let at = Vec2::new((t * radius / z / 0.3f64.tan() / 1.5) as f32, 0.0);
        let n = 300;
        let right = grid(n).filter(|&u| crossing(&camera, at, u, z).x > 0.0).count();
        let share = right as f64 / f64::from(n * n);
        assert!((share - side_of_disk(t)).abs() < 2e-3, "{t}: {share}");
    }
}

#[test]
fn the_blurred_disk_is_uniform() {
    let camera = perspective(round(0.2, 5.0));
    let (n, rings, sectors) = (1 << 20, 5, 8);
    let mut counts = vec![0u32; rings * sectors];
    for i in 0..n {
        let u = Vec2::from_array(sobol::point(i).map(unit));
        let p = crossing(&camera, Vec2::ZERO, u, 10.0) / 0.1;
        let ring = ((p.x * p.x + p.y * p.y) * rings as f64) as usize;
        let sector = ((p.y.atan2(p.x) / PI + 1.0) * 0.5 * sectors as f64) as usize;
        counts[ring.min(rings - 1) * sectors + sector.min(sectors - 1)] += 1;
    }
    let expected = f64::from(n) / (rings * sectors) as f64;
    for count in counts {
        assert!((f64::from(count) / expected - 1.0).abs() < 0.005, "{count} of {expected}");
    }
}

#[test]
fn highlights_behind_the_focus_are_upright() {
    let lens = ThinLens { aperture: Aperture::Polygon { blades: 3, rotation: 0.0 }, ..round(0.2, 5.0) };
    let camera = perspective(lens);
    let light = DVec3::new(0.0, 0.0, -20.0);
    // Of all rays to the light, the one through the corner on top of the lens appears highest.
    let place = |u| {
        let o = camera.ray(Vec2::ZERO, 1.5, u, 0.0).expect("a ray").o;
        let d = (light - o.as_dvec3()).normalize();
        (camera.importance(o, d.as_vec3(), 1.5, 0.0).expect("in the picture").at.y, o.y)
    };
    let all: Vec<_> = grid(40).map(place).collect();
    let highest = all.iter().max_by(|a, b| a.0.total_cmp(&b.0)).expect("some");
    assert!(highest.1 > 0.09, "{highest:?}");
}

#[test]
fn a_pinhole_does_not_look_at_the_lens() {
    for camera in [
        Camera::Perspective(PerspectiveCamera::new(frame(), 0.6)),
        Camera::Orthographic(OrthographicCamera { frame: frame(), size: 2.0, lens: None }),
    ] {
        assert!(!camera.has_lens());
        let ray = |u| camera.ray(Vec2::new(0.1, 0.2), 1.5, u, 0.0).map(|ray| (ray.o, ray.d));
        assert_eq!(ray(Vec2::ZERO), ray(Vec2::splat(0.9)));
    }
}
