use kajo_color::Wavelengths;
use kajo_math::Aabb;

use super::*;
use crate::curved_light::{Chords, Followed, Outcome, RayEquation, Region, position};

/// Nothing in the way.
struct Empty;

impl Chords for Empty {
    fn hit(&mut self, _chord: &Ray) -> Option<f32> {
        None
    }
}

fn hole(spin: f32) -> BlackHole {
    BlackHole::new(Vec3::ZERO, 1.0, spin, Vec3::Y).expect("a hole")
}

fn region(radius: f32) -> Region {
    Region { bounds: Aabb { min: Vec3::splat(-radius), max: Vec3::splat(radius) } }
}

fn check(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() < tolerance, "{found} instead of {expected}");
}

fn followed(hole: &BlackHole, o: Vec3, d: Vec3, radius: f32) -> Followed {
    let ray = Ray::new(o, d.normalize());
    hole.follow(&ray, None, &region(radius), &Wavelengths::RGB, &mut Empty).expect("light is bent")
}

/// The angle about an axis within which light looked along ends in the hole, in degrees.
fn edge(hole: &BlackHole, o: Vec3, towards: Vec3, side: Vec3) -> f64 {
    let (mut lo, mut hi) = (0.0f64, 3.1);
    for _ in 0..24 {
        let angle = 0.5 * (lo + hi);
        let d = angle.cos() as f32 * towards + angle.sin() as f32 * side;
        let ends = followed(hole, o, d, 60.0).outcome == Outcome::Absorbed;
        if ends { lo = angle } else { hi = angle }
    }
    lo.to_degrees()
}

#[test]
fn the_shadow_has_the_size_that_is_seen() {
    let hole = hole(0.0);
    for (r, degrees) in [(4.0, 66.71627), (6.0, 45.0), (10.0, 27.69456), (20.0, 14.26903)] {
        check(edge(&hole, Vec3::new(0.0, 0.0, r), Vec3::NEG_Z, Vec3::X), degrees, 1e-3);
        // Light that is followed into the past ends at the same edge.
        let past = hole.clone().observed_by(BlackHoleObserver::Falls);
        check(edge(&past, Vec3::new(0.0, 0.0, r), Vec3::NEG_Z, Vec3::X), degrees, 1e-3);
    }
}

#[test]
fn the_side_that_comes_nearer_is_seen_through_farther() {
    // From +z, with the spin about +y, the near side moves to +x. Light that goes with the spin passes nearer to the hole: from the side of
    // -x, where what is dragged along comes towards the eye, so the shadow reaches less far there.
    let hole = hole(0.9);
    let from = Vec3::new(0.0, 0.0, 50.0);
    let [left, right] = [Vec3::NEG_X, Vec3::X].map(|side| edge(&hole, from, Vec3::NEG_Z, side));
    let [near, far] = [2.844_421f64, 6.832_319];
    let seen = |b: f64| (b / 50.0).asin().to_degrees();
    assert!(left < right, "{left} {right}");
    check(left, seen(near), 0.1 * seen(near));
    check(right, seen(far), 0.1 * seen(far));
    // Light followed into the past has the same sides, in coordinates whose axes are turned by a little, about M a/r².
    let past = hole.observed_by(BlackHoleObserver::Falls);
    check(edge(&past, from, Vec3::NEG_Z, Vec3::NEG_X), left, 0.06);
}

#[test]
fn frequencies_of_the_sky() {
    for (r, expected) in [(10.0, 1.5625), (4.0, 4.0)] {
        let way = followed(&hole(0.0), Vec3::new(0.0, r, 0.0), Vec3::new(0.3, 1.0, -0.2), 400.0);
        assert_eq!(way.outcome, Outcome::Leaves);
        check(way.g.powi(4), expected, 1e-8 * expected);
    }
}

#[test]
fn discs_that_come_towards_the_eye_are_shifted_to_blue() {
    // Edge-on, tangential: 1.414214 and 0.471405 at 6 M.
    for (r, approaching, receding) in
        [(6.0f32, 2f64.sqrt(), 0.471_405), (10.0, 1.294_245, 0.618_121), (20.0, 1.206_277, 0.746_098)]
    {
        let p = Vec3::new(r, 0.0, 0.0);
        // Right-handed about y: at +x it moves to -z.
        for (d, expected) in [(Vec3::NEG_Z, approaching), (Vec3::Z, receding)] {
            let (doppler, far) = hole(0.0).shift_of_orbit(p, d, true).expect("an orbit");
            check(doppler * far, expected, 1e-6);
        }
        // Light without angular momentum about the axis.
        let (doppler, far) = hole(0.0).shift_of_orbit(p, Vec3::Y, true).expect("an orbit");
        check(doppler * far, f64::from(1.0 - 3.0 / r).sqrt(), 1e-6);
    }
    assert!(hole(0.0).shift_of_orbit(Vec3::new(2.9, 0.0, 0.0), Vec3::Y, true).is_none());
}

#[test]
fn cameras_that_move() {
    let hole = hole(0.0);
    let p = Vec3::new(0.0, 0.0, 8.0);
    // sqrt(M/(r - 2M)) on orbits, sqrt(2M/r) in free fall.
    let orbit = hole.orbital_velocity(p, true).expect("an orbit");
    assert!(orbit.distance(Vec3::X / 6f32.sqrt()) < 1e-6, "{orbit}");
    let fall = hole.falling_velocity(p).expect("a fall");
    assert!(fall.distance(Vec3::NEG_Z * 0.5) < 1e-6, "{fall}");
    let past = hole.clone().observed_by(BlackHoleObserver::Falls);
    assert!(past.falling_velocity(p).expect("a fall").distance(Vec3::NEG_Z * 0.5) < 1e-6);
    assert!(!hole.may_see_from(Vec3::X) && past.may_see_from(Vec3::X));
    assert!(
        !hole.clone().observed_by(BlackHoleObserver::Orbits { with_axis: true }).may_see_from(2.5 * Vec3::X)
    );
    // Inside of the horizon the sky is still seen, on the outer side.
    let way = followed(&past, Vec3::new(0.0, 0.0, 1.5), Vec3::Z, 100.0);
    assert_eq!(way.outcome, Outcome::Leaves);
    // Radially from behind: 1/(1 + sqrt(2/r)).
    check(way.g, 1.0 / (1.0 + (2.0f64 / 1.5).sqrt()), 1e-6);
    let way = followed(&past, Vec3::new(0.0, 0.0, 1.5), Vec3::NEG_Z, 100.0);
    assert_eq!(way.outcome, Outcome::Absorbed);
}

#[test]
fn what_cannot_be_a_hole() {
    let new = |mass: f32, spin: f32, axis: Vec3| BlackHole::new(Vec3::ZERO, mass, spin, axis).err();
    for mass in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        assert_eq!(new(mass, 0.0, Vec3::Y), Some(BlackHoleError::Mass));
    }
    for spin in [1.01, -2.0, f32::NAN] {
        assert_eq!(new(1.0, spin, Vec3::Y), Some(BlackHoleError::Spin));
    }
    assert_eq!(new(1.0, 0.0, Vec3::ZERO), Some(BlackHoleError::Axis));
    assert!(new(1.0, 1.0, Vec3::Y).is_none());
}

#[test]
fn nothing_is_infinite_at_the_axis_and_the_horizon() {
    for spin in [0.0, 0.9, 1.0] {
        let hole = hole(spin);
        for o in [Vec3::new(0.0, 9.0, 0.0), Vec3::new(0.0, -9.0, 1e-20), Vec3::new(9.0, 0.0, 0.0)] {
            let way = followed(&hole, o, -o, 40.0);
            assert_eq!(way.outcome, Outcome::Absorbed);
            assert!(way.d.is_finite() && way.length.is_finite() && way.g.is_finite());
        }
    }
    let (hole, region) = (hole(0.9), region(40.0));
    let geodesics = Geodesics::new(&hole, &region);
    assert!(geodesics.start(DVec3::ZERO, DVec3::X).is_none());
    let start = geodesics.start(DVec3::Y * 5.0, DVec3::X).expect("outside");
    assert_eq!(position(&start), DVec3::Y * 5.0);
}
