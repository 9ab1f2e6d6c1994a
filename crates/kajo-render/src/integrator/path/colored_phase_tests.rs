//! Phase functions that differ between colours or wavelengths.

use std::f64::consts::PI;

use kajo_core::medium::Phase;
use kajo_core::settings::Technique;
use kajo_testkit::every;

use super::media_tests::under_a_white_sky;
use super::tests::{TECHNIQUES, camera, mean, mean_of, scene};
use super::*;
use crate::integrator::{BidirectionalSettings, bidir};

/// Forwards in red, backwards in blue, and of blue nothing at all straight on.
const COLORS: &str =
    "phaseColors on phaseTable 0 9 3 0  30 2 2 1  90 0.2 0.5 1  140 0.3 0.9 2  180 0.3 0.2 0.1";
const SPECTRAL: &str =
    "phaseWavelengths 440 520 640 phaseTable 0 1 4 9  40 1 2 2  90 1 0.6 0.2  180 4 0.8 0.1";

fn settings(bounces: u32) -> PathSettings {
    PathSettings { bounces, ..PathSettings::default() }
}

fn phase_in(scene: &Scene) -> &Phase {
    scene.appearance.media.coefficients(scene.lighting.air.expect("the air")).phase()
}

/// A ball of two media, or of one.
fn ball(view: &str, medium: &str) -> Scene {
    scene(&format!(
        "{view} Media {{ {medium} }} Materials {{ Interface i {{ medium m }} }}
         Group {{ MaterialIndex i Sphere {{ center 0 0 0 radius 1 }} }}"
    ))
}

/// Nothing is lost and nothing is made, of no colour.
#[test]
fn media_of_albedo_1_are_not_seen_under_a_uniform_sky() {
    let grid = "GridMedium m { size 2 2 2 values 1 0.2 0 0.7 0.4 1 0.6 0.1 min -1 -1 -1 max 1 1 1";
    for (medium, phase) in every(2, [("Medium m {", COLORS), ("Medium m {", SPECTRAL), (grid, COLORS)]) {
        for from in [[0.3, 0.2, 4.0], [0.1, -0.3, 0.1]] {
            let view = under_a_white_sky(from, [0.0, -0.2, -0.1]);
            let scene = ball(&view, &format!("{medium} sigma_s 2 3 4 {phase} }}"));
            for (lane, technique) in TECHNIQUES.into_iter().enumerate() {
                for spectral in [false, true] {
                    // With roulette weights have a long tail.
                    let settings = PathSettings { technique, spectral, roulette: false, ..settings(4000) };
                    let found = mean(&scene, settings, 4000, lane).check(1.0, 0.05);
                    assert_eq!(found.err(), None, "{medium} {phase} {from:?} {technique:?} {spectral}");
                }
            }
            for spectral in [false, true] {
                let both = BidirectionalSettings {
                    bounces: 1000,
                    spectral,
                    roulette: false,
                    ..BidirectionalSettings::default()
                };
                let both =
                    bidir::integrator_of(&scene.output.camera, &scene, both, [1, 1], LayerSet::of(&[]));
                let found = mean_of(&*both, 500, 2).check(1.0, 0.1);
                assert_eq!(found.err(), None, "{medium} {phase} {from:?} from both ends {spectral}");
            }
        }
    }
}

/// A beam from above into a cube, seen from the side: light that is scattered once by a right angle, of each colour by its own column.
#[test]
fn light_of_each_colour_is_scattered_by_its_own_column() {
    let cube = "Lights { DirectionalLight { direction 0 -1 0  irradiance 1 } }
        Materials { Interface i { medium m } } Group { MaterialIndex i Box { min -1 -1 -1 max 1 1 1 } }";
    let sideways = scene(&format!(
        "{} Media {{ Medium m {{ sigma_s 0.5 1 2 {COLORS} }} exterior m }} {cube}",
        camera([0.0, 0.2, 0.5], [0.0, 0.2, 0.0])
    ));
    let right_angle = phase_in(&sideways).at(&kajo_color::Wavelengths::RGB).at(0.0).value();
    let values = right_angle.to_rgb();
    assert!(values[0] < 0.5 * values[1] && values[1] < values[2], "{values:?}");
    let text = format!(
        "{} Media {{ Medium m {{ sigma_s 0.5 1 2 {COLORS} }} }} {cube}",
        camera([0.0, 0.2, 5.0], [0.0, 0.2, 0.0])
    );
    let scene = scene(&text);
    for (lane, s) in [0.5f64, 1.0, 2.0].into_iter().enumerate() {
        let expected = (-0.8 * s).exp() * (1.0 - (-2.0 * s).exp()) * f64::from(values[lane]);
        mean(&scene, settings(0), 8000, lane).check(expected, 0.02).unwrap();
    }
}

/// One medium with a column for each colour is three in one place, of one colour each.
#[test]
fn columns_of_colours_are_media_of_one_colour() {
    let view = format!(
        "{} Lights {{ DirectionalLight {{ direction 0.3 -1 -0.4  irradiance 3 3 3 angle 30 }} }}",
        camera([0.0, 0.2, 5.0], [0.0, 0.2, 0.0])
    );
    let one = ball(&view, &format!("Medium m {{ sigma_s 2 3 1.5  sigma_a 0.1 0.2 0 {COLORS} }}"));
    let column = |values: &str| format!("phaseTable {values}");
    let three = scene(&format!(
        "{view} Media {{ Medium r {{ sigma_s 2 0 0 sigma_a 0.1 0.2 0 {} }} Medium g {{ sigma_s 0 3 0 {} }}
                         Medium b {{ sigma_s 0 0 1.5 {} }} }}
         Materials {{ Interface r {{ medium r }} Interface g {{ medium g }} Interface b {{ medium b }} }}
         Group {{ MaterialIndex r Sphere {{ center 0 0 0 radius 1 }} MaterialIndex g Sphere {{ center 0 0 0 radius 1.00002 }}
                  MaterialIndex b Sphere {{ center 0 0 0 radius 1.00004 }} }}",
        column("0 9  30 2  90 0.2  140 0.3  180 0.3"),
        column("0 3  30 2  90 0.5  140 0.9  180 0.2"),
        column("0 0  30 1  90 1  140 2  180 0.1"),
    ));
    for lane in every(2, 0..3) {
        let [one, three] = [&one, &three].map(|scene| mean(scene, settings(50), 20_000, lane));
        let sigma = one.standard_error.hypot(three.standard_error);
        assert!((one.mean - three.mean).abs() < 4.0 * sigma, "{lane}: {one:?} {three:?}");
        assert!(sigma < 0.03 * one.mean, "{lane} is too noisy: {one:?} {three:?}");
    }
}

/// Light met by chance, drawn, and both weighed; from the camera and from both ends; by colour and by wavelength.
#[test]
fn all_ways_find_the_same_light() {
    let text = |phase: &str| {
        format!(
            "PerspectiveCamera {{ center 0 0 3  direction 0 0 -1  up 0 1 0  angle 30 }} Background {{ color 0 0 0 }}
             Media {{ Medium m {{ sigma_s 2 3 1.5  sigma_a 0.1 0.2 0 {phase} }} }}
             Materials {{ Interface i {{ medium m }} Matte light {{ color 0 0 0 emission 4 }} Matte grey {{ color 0.5 0.5 0.5 }} }}
             Group {{ MaterialIndex i Sphere {{ center 0 0 0 radius 0.9 }} MaterialIndex grey Plane {{ normal 0 1 0  offset -1 }}
                      MaterialIndex light Quad {{ corner -1 2 -1 edge1 2 0 0 edge2 0 0 2 }} }}"
        )
    };
    let cases = [(COLORS, false, 0), (COLORS, false, 2), (COLORS, true, 1), (SPECTRAL, true, 2)];
    for (phase, spectral, lane) in every(2, cases) {
        let scene = scene(&text(phase));
        let of = |technique| PathSettings { technique, spectral, ..settings(4) };
        let combined = mean(&scene, of(Technique::Combined), 12_000, lane);
        let both = BidirectionalSettings { bounces: 4, spectral, ..BidirectionalSettings::default() };
        let both = bidir::integrator_of(&scene.output.camera, &scene, both, [1, 1], LayerSet::of(&[]));
        let others = [
            mean(&scene, of(Technique::Lights), 12_000, lane),
            mean(&scene, of(Technique::Scattering), 24_000, lane),
            mean_of(&*both, 12_000, lane),
        ];
        for other in others {
            let sigma = combined.standard_error.hypot(other.standard_error);
            assert!(
                (combined.mean - other.mean).abs() < 4.5 * sigma,
                "{phase} {spectral} {lane}: {combined:?} {others:?}"
            );
            assert!(sigma < 0.04 * combined.mean, "{phase} {lane} is too noisy: {combined:?} {others:?}");
        }
    }
}

/// The mean over the lanes of a path's weight is 1 whatever the lanes are, so that white light stays white but for the noise of its colour.
#[test]
fn the_mean_of_the_lanes_has_no_noise() {
    let view = under_a_white_sky([0.3, 0.2, 4.0], [0.0, -0.2, -0.1]);
    let scene = ball(&view, &format!("Medium m {{ sigma_s 3 {} }}", COLORS.replace("3 0  30", "3 2  30")));
    let plain = PathSettings { technique: Technique::Scattering, roulette: false, ..settings(4000) };
    let lanes = [0, 1, 2].map(|lane| mean(&scene, plain, 64, lane).mean);
    let found = lanes.iter().sum::<f64>() / 3.0;
    assert!((found - 1.0).abs() < 1e-4, "{lanes:?}");
    assert!(lanes.iter().all(|lane| (lane - 1.0).abs() < 0.2 * PI), "{lanes:?}");
}
