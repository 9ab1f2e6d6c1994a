use std::f64::consts::PI;

use super::*;
use crate::gravity::{Observer, schwarzschild, thin_disk};
use crate::ode::{Solver, Tolerance};
use crate::rng::Stream;

const FINE: Tolerance = Tolerance { absolute: 1e-12, relative: 1e-12 };

fn check(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() < tolerance, "{found} instead of {expected}");
}

fn joined(x: DVec3, p: DVec3) -> [f64; 6] {
    [x.x, x.y, x.z, p.x, p.y, p.z]
}

fn parted(y: &[f64; 6]) -> (DVec3, DVec3) {
    (DVec3::new(y[0], y[1], y[2]), DVec3::new(y[3], y[4], y[5]))
}

/// Follows light until it is farther away than `far`; `None` where it crosses the horizon.
fn followed(kerr: &Kerr, x: DVec3, p: DVec3, energy: f64, far: f64) -> Option<(DVec3, DVec3)> {
    stepped(kerr, x, p, energy, far, FINE).0
}

/// The same with another tolerance, and how many steps it took.
fn stepped(
    kerr: &Kerr,
    x: DVec3,
    p: DVec3,
    energy: f64,
    far: f64,
    tolerance: Tolerance,
) -> (Option<(DVec3, DVec3)>, u32) {
    let mut flow = |_: f64, y: &[f64; 6]| {
        let (x, p) = parted(y);
        let (dx, dp) = kerr.flow(x, p, energy);
        joined(dx, dp)
    };
    let mut solver = Solver::new(&mut flow, 0.0, joined(x, p), tolerance);
    for taken in 1..=100_000 {
        let step = solver.step(&mut flow, f64::INFINITY).expect("steps");
        let (x, p) = parted(step.end());
        if kerr.radius(x) < kerr.horizon() {
            return (None, taken);
        }
        if x.length() > far && x.dot(p) > 0.0 {
            let there = step.event([0.0, 1.0], |y| parted(y).0.length() - far).unwrap_or(1.0);
            return (Some(parted(&step.at(there))), taken);
        }
    }
    panic!("too many steps");
}

/// Numbers in [-1, 1].
fn number(i: u32, k: u32) -> f64 {
    2.0 * f64::from(Stream::new(11, [i, 0], 0).uniform(k)) - 1.0
}

#[test]
fn the_metric_is_that_of_kerr() {
    for i in 0..50 {
        let kerr = Kerr::new(1.0, number(i, 0));
        let x = 4.0 * DVec3::new(number(i, 1), number(i, 2), number(i, 3));
        let KerrMetric { r, f, k } = kerr.metric(x);
        let a2 = kerr.spin() * kerr.spin();
        check(r.powi(4) - (x.length_squared() - a2) * r * r, a2 * x.z * x.z, 1e-10);
        check(k.length(), 1.0, 1e-12);
        // In the coordinates of Boyer and Lindquist f is 2 M r/(r² + a² cos² θ).
        let cos = x.z / r;
        check(f, 2.0 * r / (r * r + a2 * cos * cos), 1e-10);
        // Lowering undoes raising.
        let metric = kerr.metric(x);
        let p = (number(i, 4), DVec3::new(number(i, 5), number(i, 6), number(i, 7)));
        let (t, back) = metric.lowered(metric.raised(p));
        check(t, p.0, 1e-9);
        check(back.distance(p.1), 0.0, 1e-9);
    }
}

#[test]
fn the_flow_is_the_derivative_of_the_hamiltonian() {
    for i in 0..50 {
        let kerr = Kerr::new(1.0, number(i, 0));
        let x = 2.0 * DVec3::new(number(i, 1), number(i, 2), number(i, 3)) + DVec3::new(0.0, 0.0, 2.5);
        let p = DVec3::new(number(i, 4), number(i, 5), number(i, 6));
        let energy = 0.8;
        let (dx, dp) = kerr.flow(x, p, energy);
        let h = 1e-5;
        for axis in 0..3 {
            let step = h * DVec3::AXES[axis];
            let by_p = (kerr.norm(x, p + step, energy) - kerr.norm(x, p - step, energy)) / (4.0 * h);
            let by_x = (kerr.norm(x + step, p, energy) - kerr.norm(x - step, p, energy)) / (4.0 * h);
            check(dx[axis], by_p, 1e-8);
            check(dp[axis], -by_x, 1e-8);
        }
        let by_energy = (kerr.norm(x, p, energy + h) - kerr.norm(x, p, energy - h)) / (4.0 * h);
        check(kerr.time_rate(x, p, energy), -by_energy, 1e-8);
    }
}

#[test]
fn without_mass_light_goes_straight() {
    let kerr = Kerr::new(0.0, 0.5);
    let p = DVec3::new(0.6, 0.0, 0.8);
    for x in [DVec3::new(1.0, 2.0, 3.0), DVec3::ZERO, DVec3::Z] {
        let (dx, dp) = kerr.flow(x, p, 1.0);
        assert_eq!((dx, dp), (p, DVec3::ZERO));
    }
}

#[test]
fn what_is_conserved_stays() {
    for i in 0..12 {
        let kerr = Kerr::new(1.0, [0.0, 0.5, 0.9, -0.998, 1.0][i as usize % 5]);
        let x = DVec3::new(12.0, number(i, 0), number(i, 1));
        let seen = DVec3::new(-1.0, 0.6 * number(i, 2) + 0.3, 0.5 * number(i, 3) + 0.3).normalize();
        let (energy, p) = Observer::at_rest(&kerr, x).unwrap().emitted(seen);
        let before = kerr.conserved(x, p, energy);
        let Some((x, p)) = followed(&kerr, x, p, energy, 50.0) else { continue };
        let after = kerr.conserved(x, p, energy);
        check(after.momentum, before.momentum, 1e-9);
        check(after.carter, before.carter, 1e-9 * (1.0 + before.carter));
        check(kerr.norm(x, p, energy), 0.0, 1e-9);
        check(kerr.metric(x).energy(p, true), energy, 1e-9);
        check(kerr.metric(x).energy(-p, false), -energy, 1e-9);
        let projected = kerr.null_projected(x, p * (1.0 + 1e-6), energy);
        check(projected.distance(p), 0.0, 1e-9);
    }
}

#[test]
fn deflection_without_spin() {
    let kerr = Kerr::new(1.0, 0.0);
    for b in [5.25, 5.5, 6.0, 7.0, 10.0, 20.0, 50.0] {
        let far = 1e5;
        let x = DVec3::new(far, 0.0, 0.0);
        let (x, p) = followed(&kerr, x, arriving(&kerr, far, b), 1.0, far).unwrap();
        // Light came in the direction whose sine is b/far; what it turns beyond is of the order of b/far².
        let velocity = kerr.flow(x, p, 1.0).0;
        let deflection = (velocity.y.atan2(velocity.x) - PI + (b / far).asin()).rem_euclid(2.0 * PI);
        let exact = schwarzschild::deflection(b).unwrap().rem_euclid(2.0 * PI);
        check(deflection / exact, 1.0, 1e-6);
    }
}

/// The momentum of light of energy 1 that comes from the side of +x in the equatorial plane with the angular momentum `b`.
fn arriving(kerr: &Kerr, far: f64, b: f64) -> DVec3 {
    let x = DVec3::new(far, 0.0, 0.0);
    let mut p = DVec3::new(-1.0, b / far, 0.0);
    for _ in 0..20 {
        p.x -= kerr.norm(x, p, 1.0) / (2.0 * kerr.flow(x, p, 1.0).0.x);
    }
    p
}

/// The largest |b| of an equatorial ray that is captured, on the side of one sign.
fn edge(kerr: &Kerr, sign: f64) -> f64 {
    let far = 1000.0;
    let (mut lo, mut hi) = (1.0, 9.0);
    for _ in 0..40 {
        let b = 0.5 * (lo + hi);
        let x = DVec3::new(far, 0.0, 0.0);
        let p = arriving(kerr, far, sign * b);
        if followed(kerr, x, p, 1.0, far + 1.0).is_none() { lo = b } else { hi = b }
    }
    0.5 * (lo + hi)
}

#[test]
fn the_shadow_leans_to_one_side() {
    for (spin, prograde, retrograde) in
        [(0.0, 5.196_152, 5.196_152), (0.5, 4.096_267, 6.138_156), (0.9, 2.844_421, 6.832_319)]
    {
        let kerr = Kerr::new(1.0, spin);
        check(edge(&kerr, 1.0), prograde, 2e-6);
        check(edge(&kerr, -1.0), retrograde, 2e-6);
    }
    let kerr = Kerr::new(1.0, 0.998);
    check(edge(&kerr, 1.0), 2.110_888, 2e-6);
    check(edge(&kerr, -1.0), 6.996_666, 2e-6);
}

#[test]
fn shadows_of_observers_at_rest() {
    let kerr = Kerr::new(1.0, 0.0);
    for r in [4.0, 6.0, 10.0, 20.0] {
        let x = DVec3::new(0.0, 0.0, r);
        let observer = Observer::at_rest(&kerr, x).unwrap();
        let (mut lo, mut hi) = (0.0, PI);
        for _ in 0..40 {
            let angle: f64 = 0.5 * (lo + hi);
            let (energy, p) = observer.emitted(DVec3::new(angle.sin(), 0.0, -angle.cos()));
            if followed(&kerr, x, p, energy, 1.1 * r).is_none() { lo = angle } else { hi = angle }
        }
        check(lo.to_degrees(), schwarzschild::shadow_sine(r).asin().to_degrees(), 1e-6);
    }
}

#[test]
fn frequencies_from_orbits() {
    // Edge-on, the tangential ray of a circular orbit, and seen from the axis.
    for (spin, r, approaching, receding) in [
        (0.0, 6.0, 2f64.sqrt(), 0.471_405),
        (0.0, 10.0, 1.294_245, 0.618_121),
        (0.0, 20.0, 1.206_277, 0.746_098),
    ] {
        let kerr = Kerr::new(1.0, spin);
        let x = DVec3::new(r, 0.0, 0.0);
        let omega = kerr.angular_velocity(r, true);
        let gas = Observer::rotating(&kerr, x, omega).unwrap();
        // Tangential in the frame at rest, so p_r = 0.
        for (sign, expected) in [(1.0, approaching), (-1.0, receding)] {
            let (energy, p) = Observer::at_rest(&kerr, x).unwrap().emitted(DVec3::new(0.0, sign, 0.0));
            check(energy / gas.received(energy, p).0, expected, 1e-6);
        }
        // A ray without angular momentum has the frequency of one that leaves along the axis.
        check(1.0 / gas.received(1.0, kerr.null_projected(x, DVec3::X, 1.0)).0, (1.0 - 3.0 / r).sqrt(), 1e-9);
    }
    // With spin: u^t = (1 + a r^-1.5)/sqrt(1 - 3/r + 2 a r^-1.5).
    let kerr = Kerr::new(1.0, 0.9);
    let r: f64 = thin_disk::innermost_orbit(0.9) + 1.0;
    let x = DVec3::new(0.0, (r * r + 0.81).sqrt(), 0.0);
    let gas = Observer::rotating(&kerr, x, kerr.angular_velocity(r, true)).unwrap();
    let a = 0.9 / (r * r.sqrt());
    check(gas.velocity().0, (1.0 + a) / (1.0 - 3.0 / r + 2.0 * a).sqrt(), 1e-9);
}

#[test]
fn nothing_is_infinite_at_the_pole_the_horizon_and_the_ring() {
    let kerr = Kerr::new(1.0, 0.9);
    let places = [
        DVec3::ZERO,
        DVec3::new(0.9, 0.0, 0.0),
        DVec3::new(0.0, 0.9, 1e-300),
        DVec3::new(0.0, 0.0, kerr.horizon()),
        DVec3::new(0.0, 0.0, 5.0),
        DVec3::new(1e-200, 0.0, -5.0),
    ];
    for x in places {
        let (dx, dp) = kerr.flow(x, DVec3::new(0.3, -0.4, 0.5), 1.0);
        assert!(dx.is_finite() && dp.is_finite(), "{x}: {dx} {dp}");
    }
}

/// What a picture takes: with each digit of accuracy 1.6 times as many steps, as with any method of fifth order.
#[test]
fn steps_grow_with_the_fifth_root_of_accuracy() {
    let kerr = Kerr::new(1.0, 0.9);
    let eye = DVec3::new(31.84, 0.0, 3.2);
    let rows = [1e-4, 1e-6, 1e-8, 1e-10, 1e-12].map(|tolerance| {
        let tolerance = Tolerance { absolute: tolerance, relative: tolerance };
        let (mut steps, mut worst, mut count) = (0, 0.0f64, 0);
        for i in 0..200 {
            let seen = DVec3::new(-1.0, 0.5 * number(i, 0), 0.3 * number(i, 1)).normalize();
            let (energy, p) = Observer::at_rest(&kerr, eye).unwrap().emitted(seen);
            let (end, taken) = stepped(&kerr, eye, p, energy, 300.0, tolerance);
            steps += taken;
            let exact = followed(&kerr, eye, p, energy, 300.0);
            if let (Some((_, p)), Some((_, exact))) = (end, exact) {
                worst = worst.max(p.normalize().angle_between(exact.normalize()));
                count += 1;
            }
        }
        assert!(count > 150, "{count}");
        (f64::from(steps) / 200.0, worst)
    });
    for ((steps, worst), exponent) in rows.iter().zip([4, 6, 8, 10, 12]) {
        println!("1e-{exponent}: {steps:.1} steps, {worst:.1e} radians at most");
    }
    for pair in rows[1..].windows(2) {
        let more = pair[1].0 / pair[0].0;
        assert!((2.0..2.8).contains(&more), "{more}");
    }
    assert!(rows[3].1 < 1e-7, "{:e}", rows[3].1);
}
