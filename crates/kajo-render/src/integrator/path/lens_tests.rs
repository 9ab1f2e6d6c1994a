//! Weak gravitational lenses: where images are, and how bright.

use super::tests::{camera, check, mean, mean_of, scene};
use super::*;
use crate::integrator::{Bidirectional, BidirectionalSettings};

/// A lens in the plane z = 0, seen from the distance 10.
fn seen(view: &str, lens: &str, objects: &str) -> Scene {
    scene(&format!(
        "{view} Materials {{ GravitationalLens m {{ {lens} }}
             Matte white {{ color 0.8 0.8 0.8 }} Matte bright {{ color 0 0 0  emission 1 }} }}
         Group {{ MaterialIndex m Disk {{ center 0 0 0  normal 0 0 1  radius 8 }} {objects} }}"
    ))
}

fn settings(bounces: u32) -> PathSettings {
    PathSettings { bounces, ..PathSettings::default() }
}

/// What is seen in a direction of the sine `p` from the middle, at the angle `turn` about the axis.
fn radiance(lens: &str, source: &str, p: f64, turn: f64) -> f64 {
    let r = 10.0 * p / (1.0 - p * p).sqrt();
    let view = camera([0.0, 0.0, 10.0], [(r * turn.cos()) as f32, (r * turn.sin()) as f32, 0.0]);
    let scene = seen(&view, lens, &format!("MaterialIndex bright Sphere {{ {source} }}"));
    mean(&scene, settings(1), 4, 0).mean
}

/// Behind a point mass half way to it a star is a ring: `sin θ tan θ = 2 M / D`; behind an isothermal sphere
/// one of `sin θ = 2π σ²`.
#[test]
fn stars_behind_lenses_are_rings() {
    let star = "center 0 0 -10  radius 0.05";
    let sin2 = {
        // s² / sqrt(1 - s²) = 2 M / D.
        let k: f64 = 2.0 * 0.1 / 10.0;
        0.5 * k * ((k * k + 4.0).sqrt() - k)
    };
    let isothermal = 2.0 * std::f64::consts::PI * 0.15 * 0.15;
    for (lens, ring) in [("mass 0.1", sin2.sqrt()), ("dispersion 0.15", isothermal)] {
        for turn in [0.0, 1.0, 2.5, 4.0] {
            assert_eq!(radiance(lens, star, ring, turn), 1.0, "{lens} {turn}");
            for factor in [0.0, 0.5, 0.9, 1.1, 2.0] {
                assert_eq!(radiance(lens, star, factor * ring, turn), 0.0, "{lens} {turn} {factor}");
            }
        }
    }
}

/// A star behind a flat galaxy is four stars in a cross, and none in between.
#[test]
fn a_star_behind_an_ellipse_is_a_cross() {
    let lens = "dispersion 0.12  axisRatio 0.5  axis 1 0 0";
    let (star, b, f) = ("center 0 0 -10  radius 0.08", 4.0 * std::f64::consts::PI * 0.0144, 0.75f64.sqrt());
    // Along the axes ψ is q x and y, so that the angles do not depend on the distance.
    let across = 0.5 * b * 0.5 / 0.5f64.sqrt() / f;
    let [along, across] = [across * (f / 0.5).atan(), across * f.atanh()];
    for k in 0..4 {
        let turn = std::f64::consts::FRAC_PI_2 * f64::from(k);
        let ring = if k % 2 == 0 { along } else { across };
        assert_eq!(radiance(lens, star, ring, turn), 1.0, "{k}");
        let between = turn + std::f64::consts::FRAC_PI_4;
        assert!((1..40).all(|i| radiance(lens, star, 0.005 * f64::from(i), between) == 0.0), "{k}");
    }
}

/// All light passes, and none is added.
#[test]
fn a_uniform_sky_is_as_bright_as_it_is() {
    for to in [[0.5, 0.2, 0.0], [3.0, -2.0, 0.0]] {
        let view = camera([0.0, 0.0, 10.0], to).replace("color 0 0 0", "color 1 1 1");
        for lens in ["mass 0.05", "dispersion 0.2 axisRatio 0.4 core 0.3 axis 1 2 0"] {
            check(&seen(&view, lens, ""), settings(4), 40, 1.0);
        }
    }
}

/// A lens lights a wall by paths that find the emitter as by light from the emitter.
#[test]
fn light_behind_a_lens_is_the_same_from_both_ends() {
    let view = camera([0.0, 0.0, -6.0], [0.3, 0.2, -9.0]);
    let objects = "MaterialIndex white Quad { corner -4 -4 -9 edge1 8 0 0 edge2 0 8 0 }
        MaterialIndex bright Sphere { center 0.4 0 6  radius 1.5 }";
    let scene = seen(&view, "dispersion 0.18  axisRatio 0.7", objects);
    let path = mean(&scene, settings(2), 2000, 0);
    let both = BidirectionalSettings { bounces: 2, ..BidirectionalSettings::default() };
    let found = mean_of(&Bidirectional::new(&scene, both, [1, 1], LayerSet::of(&[])), 2000, 0);
    let sigma = found.standard_error.hypot(path.standard_error);
    assert!((found.mean - path.mean).abs() < 4.0 * sigma, "{found:?} {path:?}");
    assert!(path.mean > 0.0 && sigma < 0.05 * path.mean, "{found:?} {path:?}");
}
