//! How fast errors fall with the number of samples.
//!
//! Bands and integrands after [Christensen, Kensler and Kilpatrick 2018].

use kajo_testkit::Estimate;

use super::*;

/// A function on the unit square and its integral.
struct Integrand {
    name: &'static str,
    f: fn(Vec2) -> f64,
    integral: f64,
}

const SMOOTH: [Integrand; 2] = [
    Integrand {
        name: "gaussian",
        f: |u| (-u.as_dvec2().length_squared()).exp(),
        integral: 0.557_746_285_351_034,
    },
    Integrand { name: "xy", f: |u| f64::from(u.x) * f64::from(u.y), integral: 0.25 },
];

const EDGES: [Integrand; 2] = [
    Integrand {
        name: "disk",
        f: |u| f64::from(u8::from(u.as_dvec2().length_squared() < std::f64::consts::FRAC_2_PI)),
        integral: 0.5,
    },
    Integrand { name: "triangle", f: |u| f64::from(u8::from(u.x < u.y)), integral: 0.5 },
];

const STEP: Integrand = Integrand {
    name: "step",
    f: |u| f64::from(u8::from(f64::from(u.x) < std::f64::consts::FRAC_1_PI)),
    integral: std::f64::consts::FRAC_1_PI,
};

/// Root of the mean squared error of `n` samples at a dimension, over many pixels. No two of them share a sequence of `zsobol`,
/// whose neighbourhoods are 256 wide.
fn error(kind: SamplerKind, n: u32, dimension: u32, pixels: u32, integrand: &Integrand) -> f64 {
    let sampler = Sampler::new(kind, n);
    let squares = (0..pixels).map(|i| {
        let sum: f64 = (0..n)
            .map(|k| {
                let mut draws = SampleStream::new(&sampler, 77, [i << 8, 5 * i], k);
                (0..dimension).for_each(|_| _ = draws.next_1d());
                (integrand.f)(draws.next_2d())
            })
            .sum();
        (sum / f64::from(n) - integrand.integral).powi(2)
    });
    (squares.sum::<f64>() / f64::from(pixels)).sqrt()
}

/// The exponent of the number of samples in the error, fitted to even powers of two.
fn slope(kind: SamplerKind, powers: std::ops::RangeInclusive<u32>, integrand: &Integrand) -> f64 {
    // The standard deviation of the slope is 0.015.
    let pixels = if kind == Uniform { 250 } else { 160 };
    let points: Vec<(f64, f64)> =
        powers.step_by(2).map(|m| (f64::from(m), error(kind, 1 << m, 2, pixels, integrand).log2())).collect();
    let n = points.len() as f64;
    let (x, y) = points.iter().fold((0.0, 0.0), |(x, y), p| (x + p.0 / n, y + p.1 / n));
    let covariance: f64 = points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
    covariance / points.iter().map(|p| (p.0 - x).powi(2)).sum::<f64>()
}

#[track_caller]
fn check(kind: SamplerKind, integrand: &Integrand, band: std::ops::RangeInclusive<f64>) {
    // Eight octaves; with KAJO_DEEP set, ten for the kinds that have as many points.
    let deep = kajo_testkit::is_deep() && kind != Pmj;
    let top = if deep { 14 } else { 12 };
    let slope = slope(kind, 4..=top, integrand);
    assert!(band.contains(&slope), "{kind:?}, {}: slope {slope:.3}", integrand.name);
}

#[test]
fn independent_samples_converge_like_the_root() {
    for integrand in [&SMOOTH[0], &EDGES[0], &STEP] {
        check(Uniform, integrand, -0.52..=-0.48);
    }
}

#[test]
fn jittered_samples_converge_linearly_where_it_is_smooth() {
    for integrand in &SMOOTH {
        check(Jittered, integrand, -1.1..=-0.9);
        check(Cmj, integrand, -0.82..=-0.68);
    }
    for integrand in &EDGES {
        check(Jittered, integrand, -0.8..=-0.7);
        check(Cmj, integrand, -0.82..=-0.7);
    }
}

#[test]
fn nets_converge_faster_than_linearly_where_it_is_smooth() {
    for kind in [Sobol, ZSobol, Pmj] {
        for integrand in &SMOOTH {
            check(kind, integrand, -1.6..=-1.35);
        }
        for integrand in &EDGES {
            check(kind, integrand, -0.82..=-0.7);
        }
        check(kind, &STEP, -1.1..=-0.9);
    }
}

/// Smooth functions of directions that are uniform over the hemisphere or the sphere: azimuths by turns, and cosines.
const SPHERES: [Integrand; 2] = [
    Integrand {
        name: "irradiance of a smooth sky",
        f: |u| {
            let (cos, phi) = (f64::from(u.y), std::f64::consts::TAU * f64::from(u.x));
            cos * (1.0 + 0.3 * cos + 0.5 * (1.0 - cos * cos).sqrt() * phi.cos())
        },
        integral: 0.6,
    },
    Integrand {
        name: "clamped cosine",
        f: |u| {
            let (cos, phi) = (1.0 - 2.0 * f64::from(u.y), std::f64::consts::TAU * f64::from(u.x));
            let sin = (1.0 - cos * cos).max(0.0).sqrt();
            (0.3 * sin * phi.cos() + 0.4 * sin * phi.sin() + 0.75f64.sqrt() * cos).max(0.0)
        },
        integral: 0.25,
    },
];

/// Only there: where the sums over rows or columns of the grid differ, the one order for all of them costs more than it gains.
#[test]
fn correlated_jitter_is_better_than_nets_for_smooth_functions_of_directions() {
    for integrand in &SPHERES {
        let [cmj, sobol] = [Cmj, Sobol].map(|kind| error(kind, 64, 2, 2000, integrand).powi(2));
        assert!(sobol / cmj > 2.0, "{}: variance {cmj:e} beside {sobol:e}", integrand.name);
    }
}

/// Disks leave gaps at random, but fewer than chance does.
#[test]
fn poisson_disks_are_better_than_chance() {
    for integrand in SMOOTH.iter().chain(&EDGES) {
        for n in [16, 256, 1024] {
            let ratio = error(Poisson, n, 2, 200, integrand) / error(Uniform, n, 2, 200, integrand);
            assert!(ratio < 0.7, "{}, {n} samples: {ratio}", integrand.name);
        }
    }
}

/// Pairs of dimensions must not know of each other: a function of four of them keeps its mean.
#[test]
fn pairs_are_independent() {
    for kind in KINDS {
        let sampler = Sampler::new(kind, 64);
        let estimate = Estimate::of_batches(|batch| {
            let product = |i: u32| {
                let mut draws = SampleStream::new(&sampler, 5, [i / 64, batch], i % 64);
                let [a, b] = [draws.next_2d(), draws.next_2d()];
                let c = draws.next_1d();
                // Means 1 of four factors, whose products feel any correlation.
                f64::from(16.0 * a.x * b.x * c * if (a.y < 0.5) == (b.y < 0.5) { 1.0 } else { 0.0 })
            };
            (0..64 * 1000).map(product).sum::<f64>() / f64::from(64 * 1000)
        });
        estimate.check(1.0, 0.002).unwrap_or_else(|problem| panic!("{kind:?}: {problem}"));
    }
}
