//! Bundles against differences of rays that are followed one by one.

use kajo_color::Wavelengths;
use kajo_math::rng::Stream;
use kajo_math::{Aabb, DVec3, Ray, Vec3};

use super::gradient_index::Profile;
use super::{BlackHole, BlackHoleObserver, GradientIndex, Medium, WormholeMedium, WormholeShape};
use crate::curved_light::ball::SphereChords;
use crate::curved_light::{Followed, Outcome, Region};
use crate::differential::RayDifferential;

/// Where rays end, the inside of a ball, and what bends them.
struct Trial<'a, M> {
    medium: &'a M,
    center: DVec3,
    radius: f64,
    region: Region,
}

impl<'a, M: Medium> Trial<'a, M> {
    fn within(medium: &'a M, center: DVec3, radius: f64) -> Trial<'a, M> {
        Trial { medium, center, radius, region: SphereChords::new(center, radius).region() }
    }

    fn follow(&self, ray: &Ray, around: Option<&RayDifferential>) -> Followed {
        let mut ball = SphereChords::new(self.center, self.radius);
        self.medium.follow(ray, around, &self.region, &Wavelengths::RGB, &mut ball).expect("light is bent")
    }
}

/// Follows rays to the surface of a ball; the largest errors of differences of points and of directions, in parts of the
/// differences.
fn errors(trial: &Trial<'_, impl Medium>, starts: &[(Vec3, Vec3)]) -> [f64; 2] {
    let mut worst = [0.0f64; 2];
    let mut compared = 0;
    for (i, &(o, d)) in starts.iter().enumerate() {
        let d = d.normalize();
        let s = Stream::new(44, [i as u32, 0], 0);
        let side = |k| (Vec3::new(s.uniform(k), s.uniform(k + 1), s.uniform(k + 2)) - 0.5) * 2.0;
        let across = |v: Vec3| v - v.dot(d) * d;
        let around = RayDifferential {
            dp: [0.1 * across(side(0)), Vec3::ZERO],
            dd: [0.02 * across(side(3)), 0.1 * across(side(6))],
        };
        let whole = trial.follow(&Ray::new(o, d), Some(&around));
        if whole.outcome != Outcome::Meets {
            continue;
        }
        let end = |way: &Followed| way.chord.at(way.chord.t_max).as_dvec3();
        let bundle = whole.bundle.expect("a bundle").on_plane((end(&whole) - trial.center).normalize());
        for i in 0..2 {
            const STEP: f32 = 4e-3;
            let beside = [STEP, -STEP].map(|e| {
                let ray = Ray::new(o + e * around.dp[i], (d + e * around.dd[i]).normalize());
                trial.follow(&ray, None)
            });
            if beside.iter().any(|way| way.outcome != Outcome::Meets) {
                continue;
            }
            let step = 2.0 * f64::from(STEP);
            let by_point = (end(&beside[0]) - end(&beside[1])) / step;
            let by_direction = (beside[0].d - beside[1].d) / step;
            worst[0] = worst[0].max(
                (bundle.dp[i].as_dvec3() - by_point).length() / (trial.radius * 0.01 + by_point.length()),
            );
            worst[1] = worst[1]
                .max((bundle.dd[i].as_dvec3() - by_direction).length() / (0.01 + by_direction.length()));
            compared += 1;
        }
    }
    assert!(compared > starts.len(), "{compared} of {}", starts.len());
    worst
}

/// Points and directions inside a ball around the origin.
fn starts(n: u32, reach: f32) -> Vec<(Vec3, Vec3)> {
    let draw = |i: u32| {
        let s = Stream::new(45, [i, 0], 0);
        let v = |k| Vec3::new(s.uniform(k), s.uniform(k + 1), s.uniform(k + 2)) - 0.5;
        (reach * v(0), v(3))
    };
    (0..n).map(draw).collect()
}

#[test]
fn bundles_are_derivatives_in_glass_of_a_varying_index() {
    let center = DVec3::new(3.0, -2.0, 0.5);
    let ball = GradientIndex::new(Profile::Luneburg { center, radius: 2.0 });
    let eye = GradientIndex::new(Profile::FishEye { center, radius: 2.0, index: 1.6 });
    let starts: Vec<_> = starts(40, 2.0).into_iter().map(|(o, d)| (o + center.as_vec3(), d)).collect();
    for (name, medium) in [("Luneburg", ball), ("fish-eye", eye)] {
        let found = errors(&Trial::within(&medium, center, 2.0), &starts);
        assert!(found.iter().all(|error| *error < 5e-3), "{name}: {found:?}");
    }
}

#[test]
fn bundles_are_derivatives_around_a_spinning_hole() {
    let hole = BlackHole::new(Vec3::ZERO, 1.0, 0.9, Vec3::Y).expect("a hole");
    // From ten masses away, past the hole by more than what is caught.
    let aim = |i: u32| {
        let s = Stream::new(46, [i, 0], 0);
        let (sin, cos) = (std::f32::consts::TAU * s.uniform(0)).sin_cos();
        let b = 7.0 + 8.0 * s.uniform(1);
        (Vec3::new(b * cos, b * sin, 20.0), Vec3::new(0.0, 0.0, -1.0))
    };
    let starts: Vec<_> = (0..40).map(aim).collect();
    for (name, hole) in [("rest", hole.clone()), ("falls", hole.observed_by(BlackHoleObserver::Falls))] {
        let found = errors(&Trial::within(&hole, DVec3::ZERO, 40.0), &starts);
        assert!(found.iter().all(|error| *error < 5e-3), "{name}: {found:?}");
    }
}

#[test]
fn bundles_go_through_wormholes() {
    let shape = WormholeShape {
        centers: [Vec3::ZERO, Vec3::new(20.0, 0.0, 0.0)],
        throat: 1.0,
        length: 0.5,
        radius: 3.0,
        width: 0.0,
        directions: [Vec3::NEG_Z, Vec3::new(1.0, 0.0, -1.0)],
        up: Vec3::Y,
    };
    let wormhole = WormholeMedium::new(&shape).expect("a wormhole");
    let into = |i: u32| {
        let s = Stream::new(47, [i, 0], 0);
        (Vec3::new(s.uniform(0) - 0.5, s.uniform(1) - 0.5, 2.5), Vec3::new(0.2 * s.uniform(2), 0.1, -1.0))
    };
    let starts: Vec<_> = (0..40).map(into).collect();
    let far = DVec3::new(20.0, 0.0, 0.0);
    let region = Region { bounds: Aabb { min: Vec3::splat(-3.0), max: Vec3::new(23.0, 3.0, 3.0) } };
    let found = errors(&Trial { region, ..Trial::within(&wormhole, far, 3.0) }, &starts);
    assert!(found.iter().all(|error| *error < 5e-3), "{found:?}");
}
