//! Rays through indices whose curves are known.

use std::f64::consts::{FRAC_PI_2, PI};

use kajo_math::fmath::{acos64, atan2_64, cos64, ln64, sin64, tan64};
use kajo_math::ode::rk4_step;
use kajo_math::rng::Stream;
use kajo_math::{DVec3, Ray, Vec3};

use super::*;
use crate::curved_light::ball::Ball;
use crate::curved_light::{Followed, Outcome, follow, position};

fn through(medium: &GradientIndex, ball: &mut Ball, o: DVec3, d: DVec3) -> Followed {
    let ray = Ray::new(o.as_vec3(), d.normalize().as_vec3());
    follow(&medium.at(&Wavelengths::RGB), &ray, None, &ball.region(), ball)
}

/// Where a way has ended.
fn end(followed: &Followed) -> DVec3 {
    followed.chord.at(followed.chord.t_max).as_dvec3()
}

fn uniform(i: u32, dimension: u32, [lo, hi]: [f64; 2]) -> f64 {
    lo + (hi - lo) * f64::from(Stream::new(2031, [i, 0], 0).uniform(dimension))
}

/// Parallel rays at any height leave a Luneburg ball at its far pole, with the slope that the closed form has.
#[test]
fn parallel_rays_meet_at_the_far_side_of_a_luneburg_ball() {
    let center = DVec3::new(3.0, -2.0, 0.5);
    let medium = GradientIndex::new(Profile::Luneburg { center, radius: 2.0 });
    for i in 0..40 {
        let h = uniform(i, 0, [-0.95, 0.95]);
        let start = center + 2.0 * DVec3::new(-(1.0 - h * h).sqrt(), h, 0.0);
        let mut ball = Ball::new(center, 2.0);
        let followed = through(&medium, &mut ball, start + 1e-6 * DVec3::X, DVec3::X);
        assert_eq!(followed.outcome, Outcome::Meets);
        let off = end(&followed).distance(center + 2.0 * DVec3::X);
        assert!(off < 3e-6, "height {h}: {off} from the pole");
        let d = DVec3::new((1.0 - h * h).sqrt(), -h, 0.0);
        assert!(followed.d.distance(d) < 3e-6, "height {h}: {} for {d}", followed.d);
        assert!((followed.index - 1.0).abs() < 1e-6 && (followed.eta_scale - 1.0).abs() < 1e-5);
        // Chords join, and none of them is far from the ball's inside.
        for pair in ball.passed.windows(2) {
            assert_eq!(pair[0].o + pair[0].d, pair[1].o);
        }
    }
}

/// The error of the fixed method falls with the fourth power of the step.
#[test]
fn classic_steps_through_a_luneburg_ball_are_of_fourth_order() {
    let medium = GradientIndex::new(Profile::Luneburg { center: DVec3::ZERO, radius: 1.0 });
    let field = medium.at(&Wavelengths::RGB);
    let h: f64 = 0.1;
    let error = |n: u32| {
        let mut y = [-(1.0 - h * h).sqrt(), h, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0];
        for _ in 0..n {
            y = rk4_step(&mut |_, y: &RayState| field.slope(y), 0.0, &y, FRAC_PI_2 / f64::from(n));
        }
        position(&y).distance(DVec3::X)
    };
    let errors: Vec<f64> = (0..5).map(|k| error(10 << k)).collect();
    assert!((errors[0] / 8.9e-6 - 1.0).abs() < 0.02, "{}", errors[0]);
    for pair in errors.windows(2) {
        let slope = ln64(pair[0] / pair[1]) / ln64(2.0);
        assert!((slope - 4.0).abs() < 0.1, "slope {slope}: {errors:?}");
    }
}

#[test]
fn rays_of_a_fish_eye_are_circles_that_meet_at_the_image() {
    let medium = GradientIndex::new(Profile::FishEye { center: DVec3::ZERO, radius: 1.0, index: 2.0 });
    let field = medium.at(&Wavelengths::RGB);
    let p = DVec3::new(0.6, 0.0, 0.0);
    let image = -p / p.length_squared();
    for i in 0..30 {
        let angle = uniform(i, 0, [0.6, 2.5]);
        let d = DVec3::new(cos64(angle), sin64(angle), 0.0);
        let mut y = field.start(p, d).expect("light is everywhere");
        // A circle through both: its centre lies on the bisector of the two and on the normal of the ray.
        let n = DVec3::new(-d.y, d.x, 0.0);
        let r = 0.5 * (image - p).length_squared() / n.dot(image - p);
        let (center, mut nearest) = (p + r * n, f64::INFINITY);
        let mut solver = kajo_math::ode::Solver::new(
            &mut |_, y: &RayState| field.slope(y),
            0.0,
            y,
            kajo_math::ode::Tolerance { absolute: 1e-12, relative: 1e-12 },
        );
        while y[7] < 1.5 * PI {
            let step = solver.step(&mut |_, y: &RayState| field.slope(y), 1e4).expect("smooth");
            for k in 1..=16 {
                let at = step.at(f64::from(k) / 16.0);
                let residual = position(&at).distance(center) / r.abs() - 1.0;
                assert!(residual.abs() < 1e-8, "angle {angle}: {residual} off the circle");
            }
            // The optical length to the image is that of half a great circle.
            if let Some(theta) = step.event([0.0, 1.0], |y| y[7] - PI) {
                nearest = nearest.min(position(&step.at(theta)).distance(image));
            }
            y = *step.end();
        }
        assert!(nearest < 1e-8, "angle {angle}: {nearest} from the image");
    }
}

/// Period and amplitude of rays that wind about the axis of a rod.
#[test]
fn rays_in_a_rod_are_waves_of_the_known_period() {
    let medium =
        GradientIndex::new(Profile::Rod { origin: DVec3::ZERO, axis: DVec3::X, index: 1.5, gradient: 0.5 });
    let field = medium.at(&Wavelengths::RGB);
    for (degrees, period, amplitude) in
        [(5.0f64, 12.518552, 0.174311), (20.0, 11.808526, 0.684040), (40.0, 9.626398, 1.285575)]
    {
        let a = degrees.to_radians();
        let y = field.start(DVec3::ZERO, DVec3::new(cos64(a), sin64(a), 0.0)).expect("inside");
        let tolerance = kajo_math::ode::Tolerance { absolute: 1e-11, relative: 1e-11 };
        let mut f = |_: f64, y: &RayState| field.slope(y);
        let mut solver = kajo_math::ode::Solver::new(&mut f, 0.0, y, tolerance);
        let (mut found, mut highest) = (None, 0.0f64);
        while found.is_none() {
            let step = solver.step(&mut f, 100.0).expect("smooth");
            if let Some(theta) = step.event([0.0, 1.0], |y| y[4]) {
                highest = highest.max(step.at(theta)[1]);
            }
            let rises = step.end()[1] >= 0.0 && step.start()[1] < 0.0;
            found = rises.then(|| step.event([0.0, 1.0], |y| y[1])).flatten().map(|theta| step.at(theta)[0]);
        }
        let found = found.expect("it comes back");
        assert!((found - period).abs() < 1e-6, "{degrees} degrees: period {found}");
        assert!((highest - amplitude).abs() < 1e-6, "{degrees} degrees: amplitude {highest}");
    }
}

#[test]
fn rays_in_a_linear_square_are_parabolas() {
    for i in 0..20 {
        let (n0, g, angle) =
            (uniform(i, 0, [1.2, 1.6]), uniform(i, 1, [-0.3, 0.3]), uniform(i, 2, [-0.7, 0.7]));
        let (origin, gradient) = (DVec3::new(0.0, 0.0, 0.0), DVec3::new(0.0, 0.0, g));
        let medium = GradientIndex::new(Profile::Linear { origin, index: n0, gradient });
        let mut ball = Ball::new(DVec3::ZERO, 1.0);
        let followed = through(&medium, &mut ball, DVec3::ZERO, DVec3::new(cos64(angle), 0.0, sin64(angle)));
        assert_eq!(followed.outcome, Outcome::Meets);
        let p = end(&followed);
        let z = p.x * tan64(angle) + g * p.x * p.x / (2.0 * n0 * n0 * cos64(angle) * cos64(angle));
        assert!((p.z - z).abs() < 1e-6, "{p}: {z}");
        let n = (n0 * n0 + 2.0 * g * p.z).sqrt();
        assert!((followed.index - n).abs() < 1e-6 && (followed.eta_scale - n0 * n0 / (n * n)).abs() < 1e-6);
        assert!((p.length() - 1.0).abs() < 1e-6);
    }
}

fn function(
    text: impl Fn(&mut kajo_math::tape::TapeBuilder, [kajo_math::tape::Node; 3]) -> kajo_math::tape::Node,
) -> Profile {
    let mut builder = kajo_math::tape::TapeBuilder::new();
    let variables = [0, 1, 2].map(|i| builder.variable(i));
    let result = text(&mut builder, variables);
    Profile::Function(std::sync::Arc::new(builder.finish(result)))
}

/// `n cos(angle to the layers)` stays what it is through any layers.
#[test]
fn layers_keep_the_momentum_along_them() {
    let layers = AirLayers {
        up: DVec3::Y,
        ground: 0.0,
        temperature: 293.0,
        rise: 40.0,
        depth: 0.05,
        inversion: 8.0,
        height: 2.0,
        width: 0.3,
        strength: 1.0,
    };
    let medium = GradientIndex::new(Profile::Layers(layers));
    let field = medium.at(&Wavelengths::RGB);
    for i in 0..20 {
        let angle = uniform(i, 0, [-0.004, 0.004]);
        let start = field.start(DVec3::new(0.0, 1.0, 0.0), DVec3::new(cos64(angle), sin64(angle), 0.0));
        let start = start.expect("air");
        let mut f = |_: f64, y: &RayState| field.slope(y);
        let tolerance = kajo_math::ode::Tolerance { absolute: 1e-11, relative: 1e-11 };
        let mut solver = kajo_math::ode::Solver::new(&mut f, 0.0, start, tolerance);
        while solver.t() < 2000.0 && solver.y()[1] > 0.0 {
            solver.limit_step(10.0);
            let step = solver.step(&mut f, 2000.0).expect("smooth");
            let kept = field.corrected(step.end());
            assert!((kept[3] - start[3]).abs() < 1e-10, "{}", kept[3] - start[3]);
            assert!((momentum(&kept).length() - field.index(&kept)).abs() < 1e-12);
            solver.correct(&mut f, kept);
        }
    }
}

/// Curves through an index that has no closed form, beside an independent solver: SciPy's `DOP853` at its least tolerance, which its
/// `Radau` agrees with.
#[test]
fn an_index_without_closed_form_bends_as_another_solver_says() {
    // 1.5 + 0.2 sin(2 x + y) cos(z) - 0.1 z^2
    let medium = GradientIndex::new(function(|tape, [x, y, z]| {
        use kajo_math::tape::{Node, Unary};
        let phase = tape.mul(x, Node::Constant(2.0));
        let phase = tape.add(phase, y);
        let (wave, slow) = (tape.unary(Unary::Sin, phase), tape.unary(Unary::Cos, z));
        let ripple = tape.mul(wave, slow);
        let (ripple, sag) = (tape.mul(ripple, Node::Constant(0.2)), tape.mul(z, z));
        let sag = tape.mul(sag, Node::Constant(-0.1));
        let sum = tape.add(ripple, sag);
        tape.add(sum, Node::Constant(1.5))
    }));
    let field = medium.at(&Wavelengths::RGB);
    let mut f = |_: f64, y: &RayState| field.slope(y);
    // Place, direction, and what there is after 1.25 of the parameter: place, momentum, optical length.
    let known = [
        (
            [0.0, 0.0, -1.0],
            [0.2, 0.1, 1.0],
            [
                0.67689971034,
                0.33844985517,
                0.80442054057,
                0.72258149235,
                0.36129074617,
                1.34966462508,
                3.1009892577,
            ],
        ),
        (
            [0.3, -0.4, -0.8],
            [-0.5, 0.6, 0.7],
            [
                -0.16036959378,
                0.85260497176,
                0.51484928953,
                -0.01826584278,
                1.17709889353,
                1.02627454453,
                2.87382122915,
            ],
        ),
        (
            [-0.6, 0.2, 0.1],
            [1.0, -0.3, 0.2],
            [
                1.29140264227,
                -0.10691232734,
                0.35549351969,
                1.58606158507,
                -0.20906012624,
                0.10405816435,
                3.02173812339,
            ],
        ),
    ];
    for (p, d, known) in known {
        let start = field.start(p.into(), DVec3::from(d).normalize()).expect("light");
        let mut solver = kajo_math::ode::Solver::new(&mut f, 0.0, start, crate::curved_light::TOLERANCE);
        while solver.t() < 1.25 {
            solver.step(&mut f, 1.25).expect("smooth");
        }
        let y = solver.y();
        let found = [y[0], y[1], y[2], y[3], y[4], y[5], y[7]];
        for (found, known) in found.into_iter().zip(known) {
            assert!((found - known).abs() < 1e-8, "{found} for {known}");
        }
    }
}

/// Light that grazes hot ground comes back up with all the bending that the indices allow, below 0.5124 degrees in all.
#[test]
fn a_hot_road_mirrors_up_to_the_known_angle() {
    use kajo_math::tape::{Binary, Node, Unary};
    // From 1.00027 down to 1.00023 at the ground.
    let medium = GradientIndex::new(function(|tape, [_, y, _]| {
        let scaled = tape.mul(y, Node::Constant(-1.0 / 0.1));
        let fall = tape.unary(Unary::Exp, scaled);
        let fall = tape.mul(fall, Node::Constant(4e-5));
        tape.binary(Binary::Sub, Node::Constant(1.00027), fall)
    }));
    let critical = (2.0f64 * 4e-5 / 1.00027).sqrt();
    assert!(
        (2.0 * critical.to_degrees() - 1.0247).abs() < 1e-3 && (critical.to_degrees() - 0.5124).abs() < 1e-3
    );
    let lowest = |angle: f64| {
        let field = medium.at(&Wavelengths::RGB);
        let start = field.start(DVec3::new(0.0, 2.0, 0.0), DVec3::new(cos64(angle), -sin64(angle), 0.0));
        let mut f = |_: f64, y: &RayState| field.slope(y);
        let tolerance = kajo_math::ode::Tolerance { absolute: 1e-11, relative: 1e-11 };
        let mut solver = kajo_math::ode::Solver::new(&mut f, 0.0, start.expect("air"), tolerance);
        loop {
            solver.limit_step(1.0);
            let step = solver.step(&mut f, 1e5).expect("smooth");
            if let Some(theta) = step.event([0.0, 1.0], |y| y[4]) {
                break step.at(theta)[1];
            }
            if step.end()[1] < 0.0 {
                break step.end()[1];
            }
        }
    };
    let exact = acos64((1.00027 - 4e-5) / 1.00027);
    assert!(lowest(exact * (1.0 - 1e-6)) > 0.0, "a ray below the angle comes back");
    assert!(lowest(exact * (1.0 + 1e-6)) < 0.0, "a ray above it meets the ground");
    assert!((exact.to_degrees() - 0.5124).abs() < 5e-5, "{}", exact.to_degrees());
}

/// Light from the horizon to an observer at the sea, through air that thins by a factor of e every 8 km.
#[test]
fn the_horizon_is_lifted_by_the_known_angle() {
    use kajo_math::tape::{Binary, Node, Unary};
    let medium = GradientIndex::new(function(|tape, [x, y, z]| {
        let square = |tape: &mut kajo_math::tape::TapeBuilder, v| tape.mul(v, v);
        let (x, y, z) = (square(tape, x), square(tape, y), square(tape, z));
        let sum = tape.add(x, y);
        let sum = tape.add(sum, z);
        let r = tape.unary(Unary::Sqrt, sum);
        let h = tape.binary(Binary::Sub, Node::Constant(6371.0), r);
        let h = tape.mul(h, Node::Constant(1.0 / 8.0));
        let air = tape.unary(Unary::Exp, h);
        let air = tape.mul(air, Node::Constant(2.77e-4));
        tape.add(air, Node::Constant(1.0))
    }));
    let mut atmosphere = Ball::new(DVec3::ZERO, 6371.0 + 200.0);
    let followed = through(&medium, &mut atmosphere, DVec3::new(0.0, 6371.0, 0.0), DVec3::X);
    assert_eq!(followed.outcome, Outcome::Meets);
    let bending = atan2_64(-followed.d.y, followed.d.x).to_degrees() * 60.0;
    assert!((bending - 37.28).abs() < 0.05, "{bending} minutes of arc");
}

#[test]
fn the_way_back_is_the_way_there() {
    let turbulence =
        IndexTurbulence { amplitude: 0.05, frequency: Vec3::splat(1.5), origin: Vec3::X, octaves: 3 };
    let mut medium = GradientIndex::new(Profile::Linear {
        origin: DVec3::ZERO,
        index: 1.4,
        gradient: DVec3::new(0.1, 0.2, -0.1),
    });
    medium.turbulence = Some(turbulence);
    let field = medium.at(&Wavelengths::RGB);
    let mut f = |_: f64, y: &RayState| field.slope(y);
    let tolerance = kajo_math::ode::Tolerance { absolute: 1e-12, relative: 1e-12 };
    for i in 0..20 {
        let d = DVec3::new(uniform(i, 0, [-1.0, 1.0]), uniform(i, 1, [-1.0, 1.0]), uniform(i, 2, [0.2, 1.0]));
        let start = field.start(DVec3::new(0.2, 0.1, -0.9), d.normalize()).expect("light");
        let go = |f: &mut dyn FnMut(f64, &RayState) -> RayState, y: RayState| {
            let mut f = |t: f64, y: &RayState| f(t, y);
            let mut solver = kajo_math::ode::Solver::new(&mut f, 0.0, y, tolerance);
            while solver.t() < 1.2 {
                solver.step(&mut f, 1.2).expect("smooth");
            }
            *solver.y()
        };
        let there = go(&mut f, start);
        let back = go(&mut f, [there[0], there[1], there[2], -there[3], -there[4], -there[5], 0.0, 0.0]);
        assert!(position(&back).distance(position(&start)) < 1e-9);
        assert!((momentum(&back) + momentum(&start)).length() < 1e-9);
        assert!((back[7] - there[7]).abs() < 1e-9, "optical lengths");
    }
}

/// What turns light back before it leaves, and light for which there is no index: both end.
#[test]
fn light_that_gets_nowhere_is_lost_and_no_endless_loop() {
    // A ring of light around the middle of a ball of the index 1/r.
    let medium = GradientIndex::new(function(|tape, [x, y, z]| {
        use kajo_math::tape::{Binary, Node, Unary};
        let (x, y, z) = (tape.mul(x, x), tape.mul(y, y), tape.mul(z, z));
        let sum = tape.add(x, y);
        let sum = tape.add(sum, z);
        let r = tape.unary(Unary::Sqrt, sum);
        tape.binary(Binary::Div, Node::Constant(1.0), r)
    }));
    let mut ball = Ball::new(DVec3::ZERO, 1.0);
    let around = through(&medium, &mut ball, DVec3::new(0.5, 0.0, 0.0), DVec3::Y);
    assert!(matches!(around.outcome, Outcome::Lost | Outcome::Meets), "{around:?}");
    let inwards = through(&medium, &mut ball, DVec3::new(0.5, 0.0, 0.0), DVec3::new(-1.0, 0.2, 0.0));
    assert_eq!(inwards.outcome, Outcome::Lost);
    // An index that vanishes at x = 0.
    let medium = GradientIndex::new(Profile::Linear { origin: DVec3::ZERO, index: 0.0, gradient: DVec3::X });
    assert_eq!(through(&medium, &mut ball, DVec3::new(-0.5, 0.0, 0.0), DVec3::Y).outcome, Outcome::Lost);
}

/// First-order steps do what they are known to do: their error falls with the first power of their length.
#[test]
fn plain_steps_are_of_first_order() {
    let mut medium = GradientIndex::new(Profile::Luneburg { center: DVec3::ZERO, radius: 1.0 });
    let error = |medium: &GradientIndex| {
        let start = DVec3::new(-0.75f64.sqrt(), 0.5, 0.0) + 1e-6 * DVec3::X;
        let followed = through(medium, &mut Ball::new(DVec3::ZERO, 1.0), start, DVec3::X);
        assert_eq!(followed.outcome, Outcome::Meets);
        end(&followed).distance(DVec3::X)
    };
    medium.stepping = Stepping::Euler(500);
    let coarse = error(&medium);
    medium.stepping = Stepping::Euler(1000);
    let fine = error(&medium);
    assert!((coarse / fine - 2.0).abs() < 0.2, "{coarse} {fine}");
    medium.stepping = Stepping::RungeKutta(100);
    assert!(error(&medium) < 5e-4);
}

/// A constant index leaves rays straight.
#[test]
fn a_constant_index_bends_nothing() {
    let medium = GradientIndex::new(function(|_, _| kajo_math::tape::Node::Constant(1.3)));
    let mut ball = Ball::new(DVec3::ZERO, 1.0);
    let (o, d) = (DVec3::new(-0.3, 0.1, 0.2), DVec3::new(0.6, -0.48, 0.64));
    let followed = through(&medium, &mut ball, o, d);
    let expected = o + d * (-o.dot(d) + (o.dot(d) * o.dot(d) - o.length_squared() + 1.0).sqrt());
    assert!(end(&followed).distance(expected) < 2e-6 && followed.d.distance(d) < 1e-6);
    assert!((followed.time - 1.3 * followed.length).abs() < 1e-6);
}

/// A Luneburg ball of numbers on a grid: the error at its pole falls with at least the third power of the distances of these.
#[test]
fn grids_bend_light_as_the_function_that_was_sampled() {
    const HALF: f64 = 1.2;
    let error = |n: u32| {
        let mut values = Vec::new();
        let at = |i: u32| HALF * (2.0 * f64::from(i) / f64::from(n - 1) - 1.0);
        for z in 0..n {
            for y in 0..n {
                // In the corners of the box, outside of the ball, 2 - r^2 is no square.
                let index =
                    |x: u32| (2.0 - DVec3::new(at(x), at(y), at(z)).length_squared()).max(0.05).sqrt();
                values.extend((0..n).map(|x| index(x) as f32));
            }
        }
        let bounds = [Vec3::splat(-HALF as f32), Vec3::splat(HALF as f32)];
        let grid = IndexGrid::new([n; 3], &values, bounds).expect("an index");
        let medium = GradientIndex::new(Profile::Grid(std::sync::Arc::new(grid)));
        let off = |h: f64| {
            let start = DVec3::new(-(1.0 - h * h).sqrt(), h, 0.0) + 1e-6 * DVec3::X;
            let followed = through(&medium, &mut Ball::new(DVec3::ZERO, 1.0), start, DVec3::X);
            assert_eq!(followed.outcome, Outcome::Meets);
            end(&followed).distance(DVec3::X)
        };
        [0.1, 0.3, 0.5].map(off).into_iter().fold(0.0, f64::max)
    };
    let [coarse, middle, fine] = [13, 25, 49].map(error);
    assert!(coarse < 0.02 && coarse / middle > 8.0 && middle / fine > 6.0, "{coarse} {middle} {fine}");
    assert!(fine < 5e-5, "{fine}");
}

#[test]
fn numbers_that_are_no_index_are_refused() {
    let bounds = [Vec3::NEG_ONE, Vec3::ONE];
    let refused = |size, values: &[f32], bounds| IndexGrid::new(size, values, bounds).err();
    let values = [1.0, 1.5, 1.2, 0.0, 1.0, 1.0, 1.0, 1.0];
    assert_eq!(
        refused([2, 2, 2], &values, bounds),
        Some(IndexGridError::Index { point: [1, 1, 0], index: 0.0 })
    );
    assert!(matches!(refused([1, 1, 1], &[f32::NAN], bounds), Some(IndexGridError::Index { .. })));
    assert_eq!(
        refused([2, 2, 1], &values, bounds),
        Some(IndexGridError::Count { size: [2, 2, 1], values: 8 })
    );
    assert!(matches!(refused([u32::MAX; 3], &[], bounds), Some(IndexGridError::Count { .. })));
    assert_eq!(refused([1, 1, 1], &[1.0], [Vec3::ONE, Vec3::ONE]), Some(IndexGridError::EmptyBox));
}
