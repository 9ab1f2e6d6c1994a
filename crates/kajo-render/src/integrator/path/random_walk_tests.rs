//! How far light strays in media without end, where every ray of a path is known.
//!
//! Flights have the mean length 1 and the mean square 2, and neighbouring directions the mean cosine `g`, those that are
//! `k` flights apart `g^k`. So `n` flights lead from their start to a place at the mean square distance
//!
//! ```text
//! 2n + 2 sum over i < j of g^(j-i)  =  2/(1-g) (n - g (1 - g^n)/(1 - g))
//! ```

use kajo_core::sampler::{Sampler, SamplerKind};
use kajo_testkit::{Estimate, every, is_deep};

use super::tests::{camera, scene};
use super::*;
use crate::PixelIntegrator;
use crate::trail::RayKind;

/// Flights of the longest walk.
const FLIGHTS: usize = 10;

fn mean_square(n: usize, g: f64) -> f64 {
    2.0 / (1.0 - g) * (n as f64 - g * (1.0 - g.powi(n as i32)) / (1.0 - g))
}

/// The squared distances to which the first flights of a path lead.
fn squared_distances(path: &Path<'_>, ctx: &mut SampleContext<'_>, place: Vec2) -> [f64; FLIGHTS] {
    let (_, trail) = path.trail(ctx, [0, 0], place);
    let is_flight = |kind| matches!(kind, RayKind::Camera | RayKind::Scattered);
    let mut flights = trail.segments().iter().filter(|segment| is_flight(segment.kind));
    let from = trail.segments()[0].from;
    std::array::from_fn(|n| {
        let flight = flights.next().expect("paths in endless fog go on");
        assert_eq!(flight.depth as usize, n, "each flight begins where the last one ended");
        (flight.from + flight.distance * flight.d - from).as_dvec3().length_squared()
    })
}

#[test]
fn walks_stray_as_far_as_their_mean_cosine_says() {
    assert!((mean_square(10, 0.5) - 36.0039).abs() < 1e-4 && (mean_square(10, -0.5) - 13.7773).abs() < 1e-4);
    let bounds = "min -99 -99 -99 max 99 99 99";
    let cases = [
        ("Medium fog { sigma_s 1  g 0.5 }".to_owned(), 0.5),
        ("Medium fog { sigma_s 1 }".to_owned(), 0.0),
        ("Medium fog { sigma_s 1  g -0.5 }".to_owned(), -0.5),
        ("Medium fog { sigma_s 1  phase rayleigh }".to_owned(), 0.0),
        // Bounds of the function lie above its values, so that some collisions are null.
        (format!("FunctionMedium fog {{ function = sin(x)^2 + cos(x)^2  {bounds}  sigma_s 1  g 0.5 }}"), 0.5),
    ];
    for (medium, g) in every(4, cases) {
        let scene = scene(&format!(
            "{} Media {{ {medium}  exterior fog }} Lights {{ PointLight {{ position 0 50 0  intensity 1 }} }}",
            camera([0.3, -0.2, 0.1], [0.0, 0.0, -5.0])
        ));
        let settings = PathSettings { bounces: 99, roulette: false, ..PathSettings::default() };
        let path = Path::new(&scene, settings, [1, 1], LayerSet::of(&[]));
        let (walks, noise) = if is_deep() { (2000, 0.012) } else { (1000, 0.018) };
        let sampler = Sampler::new(SamplerKind::Uniform, walks);
        let batches: Vec<[f64; FLIGHTS]> = (0..32)
            .map(|batch| {
                let mut ctx = SampleContext::new(&sampler, 0);
                let mut sums = [0.0; FLIGHTS];
                for k in 0..walks {
                    let place = ctx.begin([0, batch], k);
                    let found = squared_distances(&path, &mut ctx, place);
                    sums.iter_mut().zip(found).for_each(|(sum, d)| *sum += d / f64::from(walks));
                }
                sums
            })
            .collect();
        for flights in 1..=FLIGHTS {
            let found = Estimate::of_batches(|batch| batches[batch as usize][flights - 1]);
            let checked = found.check(mean_square(flights, g), noise);
            assert!(checked.is_ok(), "{medium}, {flights} flights: {checked:?}");
        }
    }
}
