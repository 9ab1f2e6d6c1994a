use super::*;
use FisheyeProjection::{Equidistant, Equisolid, Orthographic, Stereographic};

const PROJECTIONS: [FisheyeProjection; 4] = [Equidistant, Equisolid, Orthographic, Stereographic];

fn fisheye(projection: FisheyeProjection, degrees: f64) -> FisheyeCamera {
    let frame = CameraFrame::new(DVec3::ZERO, DVec3::NEG_Z, DVec3::Y);
    FisheyeCamera { frame, angle: degrees.to_radians(), projection, to_corners: false }
}

fn direction(camera: &FisheyeCamera, x: f64, y: f64) -> DVec3 {
    camera.ray(Vec2::new(x as f32, y as f32), 1.0, Vec2::ZERO).expect("inside the disk").d.as_dvec3()
}

#[test]
fn the_middle_looks_forward_and_the_edge_to_the_side() {
    for projection in PROJECTIONS {
        let camera = fisheye(projection, 180.0);
        assert!(direction(&camera, 0.0, 0.0).distance(DVec3::NEG_Z) < 1e-6);
        assert!(direction(&camera, 1.0, 0.0).distance(DVec3::X) < 1e-4);
        assert!(direction(&camera, 0.0, -1.0).distance(DVec3::NEG_Y) < 1e-4);
        assert!(camera.ray(Vec2::new(0.8, 0.8), 1.0, Vec2::ZERO).is_none(), "outside of the disk");
        assert!(camera.ray(Vec2::new(0.6, 0.0), 2.0, Vec2::ZERO).is_none(), "the disk is as wide as high");
        let filling = FisheyeCamera { to_corners: true, ..camera };
        let corner = filling.ray(Vec2::ONE, 1.0, Vec2::ZERO).expect("the corner").d.as_dvec3();
        assert!(corner.distance(DVec3::new(1.0, 1.0, 0.0).normalize()) < 1e-3, "{projection:?} {corner}");
    }
}

/// Angles at half the radius, from the tables of the projections.
#[test]
fn angles_follow_the_projection() {
    for (projection, degrees, theta) in [
        (Equidistant, 180.0, 45.0),
        (Equidistant, 360.0, 90.0),
        (Equisolid, 180.0, 41.409_622),
        (Stereographic, 180.0, 53.130_102),
        (Orthographic, 180.0, 30.0),
        (Orthographic, 60.0, 14.477_512),
    ] {
        let w = direction(&fisheye(projection, degrees), 0.3, -0.4);
        let found = (-w.z).acos().to_degrees();
        assert!((found - theta).abs() < 1e-3, "{projection:?} {degrees}: {found}");
    }
}

/// How a small square of the picture is stretched: outwards, and around the middle.
fn stretch(camera: &FisheyeCamera, r: f64) -> (f64, f64) {
    let h = 1e-3;
    let outwards = direction(camera, r + h, 0.0).distance(direction(camera, r - h, 0.0));
    let around = direction(camera, r, h).distance(direction(camera, r, -h));
    (outwards / (2.0 * h), around / (2.0 * h))
}

#[test]
fn projections_keep_what_they_promise() {
    for degrees in [100.0, 180.0] {
        let [a, b] = [0.2, 0.9].map(|r| stretch(&fisheye(Equisolid, degrees), r));
        assert!((a.0 * a.1 / (b.0 * b.1) - 1.0).abs() < 1e-3, "solid angles: {a:?} {b:?}");
        let [a, b] = [0.2, 0.9].map(|r| stretch(&fisheye(Stereographic, degrees), r));
        assert!((a.0 / a.1 - 1.0).abs() < 1e-3 && (b.0 / b.1 - 1.0).abs() < 1e-3, "shapes: {a:?} {b:?}");
        let [a, b] = [0.2, 0.9].map(|r| stretch(&fisheye(Equidistant, degrees), r));
        assert!((a.0 / b.0 - 1.0).abs() < 1e-3, "lengths: {a:?} {b:?}");
        // Seen from far away: solid angle times cosine.
        let camera = fisheye(Orthographic, degrees);
        let [a, b] = [0.2, 0.9].map(|r| {
            let (outwards, around) = stretch(&camera, r);
            outwards * around * -direction(&camera, r, 0.0).z
        });
        assert!((a / b - 1.0).abs() < 2e-3, "irradiances: {a} {b}");
    }
}
