//! Participating media against closed forms and published tables.

use std::f64::consts::PI;

use kajo_core::settings::Technique;
use kajo_testkit::every;
use kajo_testkit::vdb::{VdbGrid, VdbKind, VdbMap};

use super::tests::{TECHNIQUES, camera, check, mean, scene};
use super::*;
use crate::integrator::tests::{cube_of_voxels, scene_with, vdb_of};

fn settings(bounces: u32) -> PathSettings {
    PathSettings { bounces, ..PathSettings::default() }
}

/// A medium named `m`, a boundary of it, and what else there is.
fn filled(view: &str, medium: &str, rest: &str) -> Scene {
    scene(&format!(
        "{view} Media {{ Medium m {{ {medium} }} }} Materials {{ Interface i {{ medium m }} }} {rest}"
    ))
}

/// A camera that sees along a line, and a sky of the radiance 1.
pub(super) fn under_a_white_sky(from: [f32; 3], to: [f32; 3]) -> String {
    camera(from, to).replace("color 0 0 0", "color 1 1 1")
}

/// What absorbs only has no noise.
#[test]
fn an_absorber_follows_beer_and_lambert() {
    let ball = "Group { MaterialIndex i Sphere { center 0 0 0 radius 1 } }";
    let medium = "sigma_a 0.5 1 3";
    for (from, length) in [([0.0, 0.0, 5.0], 2.0), ([0.0, 0.0, 0.5], 1.5)] {
        let scene = filled(&under_a_white_sky(from, [0.0, 0.0, -9.0]), medium, ball);
        for (lane, sigma) in [0.5, 1.0, 3.0].into_iter().enumerate() {
            let found = mean(&scene, settings(16), 16, lane);
            let expected = f64::exp(-sigma * length);
            assert!((found.mean / expected - 1.0).abs() < 3e-6, "{length} {sigma}: {}", found.mean);
        }
    }
    // A light seen through air that absorbs, by both ways of finding it.
    let text = format!(
        "{} Media {{ Medium air {{ sigma_a 0.25 }} exterior air }}
         Materials {{ Matte light {{ color 0 0 0  emission 1 }} Matte white {{ color 1 1 1 }} }}
         Group {{ MaterialIndex light Sphere {{ center 0 4 0 radius 0.001 }}
                  MaterialIndex white Disk {{ center 0 0 0 normal 0 1 0 radius 0.1 }} }}",
        camera([0.0, 2.0, 0.1], [0.0, 0.0, 0.0])
    );
    let scene = scene(&text);
    let way = (4.0 + 0.01f64).sqrt() + 4.0 - 0.001;
    let expected = (0.001f64 / 4.0).powi(2) * (-0.25 * way).exp();
    let found = mean(&scene, settings(1), 64, 0).mean;
    assert!((found / expected - 1.0).abs() < 2e-3, "{found} {expected}");
}

/// A beam from above into a cube, seen from the side: light that is scattered once.
#[test]
fn single_scattering_in_a_cube() {
    let cube = "Lights { DirectionalLight { direction 0 -1 0  irradiance 1 } }
        Group { MaterialIndex i Box { min -1 -1 -1 max 1 1 1 } }";
    let expected = |s: f64, y: f64| (-s * (1.0 - y)).exp() * (1.0 - (-2.0 * s).exp()) / (4.0 * PI);
    for (s, y) in [(1.0, 0.9), (1.0, 0.0), (2.0, 0.0), (0.5, -0.5)] {
        let view = camera([0.0, y, 5.0], [0.0, y, 0.0]);
        let scene = filled(&view, &format!("sigma_s {s}"), cube);
        check(&scene, settings(0), 4000, expected(s, f64::from(y)));
    }
    // Each colour, whichever draws the distances.
    let scene = filled(&camera([0.0, 0.2, 5.0], [0.0, 0.2, 0.0]), "sigma_s 0.2 1 4", cube);
    for (lane, s) in [0.2, 1.0, 4.0].into_iter().enumerate() {
        mean(&scene, settings(0), 8000, lane).check(expected(s, 0.2f32.into()), 0.01).unwrap();
    }
}

/// A point light in endless fog beside the camera's ray.
#[test]
fn single_scattering_of_a_point_light_in_endless_fog() {
    for (sigma, expected) in [(0.05, 0.00805391), (0.1, 0.01151431), (0.2, 0.01216811)] {
        let text = format!(
            "{} Media {{ Medium fog {{ sigma_s {sigma} }} exterior fog }}
             Lights {{ PointLight {{ position 1 0 0  intensity 1 }} }}",
            camera([0.0, 0.0, 5.0], [0.0, 0.0, 0.0])
        );
        mean(&scene(&text), settings(0), 40_000, 0).check(expected, 0.05).unwrap();
    }
}

/// The beam of a spot light with a hard edge, seen from the side: the integral of `sigma I exp(-sigma (t + r)) / (4 pi
/// r^2)` over what of the ray is in the cone, which is so little that free paths, and points drawn all along the ray,
/// end elsewhere. The spot lights beside it shine elsewhere too.
#[test]
fn single_scattering_in_the_beam_of_a_spot_light() {
    let sigma = 0.1f64;
    let half_angle = 3.0f64.to_radians();
    let even = format!("Medium fog {{ sigma_s {sigma} }}");
    let varying = format!(
        "FunctionMedium fog {{ function = 1 + 0 * x  min -30 -30 -30 max 30 30 30  sigma_s {sigma} }}"
    );
    let spot = |at: [f64; 3], d: [f64; 3]| {
        let [[x, y, z], [u, v, w]] = [at, d];
        format!(
            "SpotLight {{ position {x} {y} {z}  direction {u} {v} {w}  angle 6 innerAngle 6  intensity 1 }}"
        )
    };
    let others: String =
        (0..6u8).map(|i| spot([4.0, f64::from(i), -3.0], [1.0, 0.1 * f64::from(i), -0.2])).collect();
    let (from, height) = (8.0, 3.0);
    let reach = height * half_angle.tan();
    let n = 20_000;
    let h = 2.0 * reach / f64::from(n);
    let expected: f64 = (0..n)
        .map(|k| {
            let off = -reach + h * (f64::from(k) + 0.5);
            let r2 = off * off + height * height;
            h * sigma * (-sigma * (from + off + r2.sqrt())).exp() / (4.0 * PI * r2)
        })
        .sum();
    for (fog, rest, samples) in [(&even, "", 400), (&even, &*others, 400), (&varying, &*others, 2000)] {
        let view = camera([0.0, 0.0, 8.0], [0.0, 0.0, 0.0]);
        let lights = format!("Lights {{ {} {rest} }}", spot([0.0, height, 0.0], [0.0, -1.0, 0.0]));
        let text = format!("{view} Media {{ {fog} exterior fog }} {lights}");
        let found = mean(&scene(&text), settings(0), samples, 0);
        found.check(expected, 0.01).unwrap();
    }
}

/// The half space of [Chandrasekhar 1950], lit and seen straight on.
#[test]
fn a_half_space_reflects_as_its_h_function_says() {
    let half = "Lights { DirectionalLight { direction 0 -1 0  irradiance 1 } }
        Group { MaterialIndex i Box { min -1000 -1000 -1000 max 1000 0 1000 } }";
    for (albedo, pi_f) in [(0.5, 0.097853), (0.8, 0.255431), (0.9, 0.385072)] {
        let view = camera([0.0, 5.0, 0.0], [0.0, 0.0, 0.0]);
        let scene = filled(&view, &format!("albedo {albedo} density 1"), half);
        mean(&scene, settings(4000), 4000, 0).check(pi_f / PI, 0.02).unwrap();
    }
}

/// A slab of optical depth 2, albedo 0.9, g = 0.75 under light straight on: its reflectance and transmittance by
/// [van de Hulst 1980]. By reciprocity they are what is seen of a sky on one side only.
#[test]
fn a_slab_reflects_and_transmits_as_the_tables_say() {
    let slab = |black: &str| {
        format!(
            "{} Media {{ Medium m {{ albedo 0.9 density 2 g 0.75 }} }}
             Materials {{ Interface i {{ medium m }} Matte black {{ color 0 0 0 }} }}
             Group {{ MaterialIndex i Box {{ min -500 -1 -500 max 500 0 500 }}
                      MaterialIndex black {black} }}",
            under_a_white_sky([0.0, 5.0, 0.0], [0.0, 0.0, 0.0])
        )
    };
    let reflects = scene(&slab("Plane { normal 0 1 0 offset -2 }"));
    let transmits = scene(&slab("Plane { normal 0 1 0 offset 9 }"));
    mean(&reflects, settings(4000), 6000, 0).check(0.09739, 0.02).unwrap();
    mean(&transmits, settings(4000), 6000, 0).check(0.66096, 0.02).unwrap();
}

/// A half space with a surface of index 1.5, isotropic, albedo 0.9: the reflectance of [Giovanelli 1955].
#[test]
fn a_half_space_behind_a_surface() {
    let text = format!(
        "{} Media {{ Medium m {{ albedo 0.9 density 1 }} }}
         Materials {{ Glass g {{ indexOfRefraction 1.5  medium m }} }}
         Group {{ MaterialIndex g Box {{ min -1000 -1000 -1000 max 1000 0 1000 }} }}",
        under_a_white_sky([0.0, 5.0, 0.0], [0.0, 0.0, 0.0])
    );
    let found = mean(&scene(&text), settings(4000), 4000, 0);
    assert!((found.mean - 0.2602).abs() < 0.001 + 4.0 * found.standard_error, "{found:?}");
}

/// Nothing is lost and nothing is made where all light is scattered under a sky that is the same everywhere.
#[test]
fn media_of_albedo_1_are_not_seen_under_a_uniform_sky() {
    let shapes = [
        "MaterialIndex i Sphere { center 0 0 0 radius 1 }",
        "MaterialIndex i Box { min -1 -1 -1 max 1 1 1 }",
        "MaterialIndex i Difference { Sphere { center 0 0 0 radius 1 } Box { min 0 0 0 max 2 2 2 } }",
    ];
    for (shape, medium) in shapes.iter().flat_map(|shape| {
        ["sigma_s 3", "sigma_s 0.5 2 6 g 0.7", "sigma_s 1 0 4 phase rayleigh"].map(|medium| (shape, medium))
    }) {
        for from in [[0.3, 0.2, 4.0], [0.1, -0.3, 0.1]] {
            let scene =
                filled(&under_a_white_sky(from, [0.0, -0.2, -0.1]), medium, &format!("Group {{ {shape} }}"));
            for (lane, technique) in TECHNIQUES.into_iter().enumerate() {
                let settings = PathSettings { technique, ..settings(4000) };
                mean(&scene, settings, 200, lane).check(1.0, 0.05).unwrap();
            }
            // Without roulette no path has another weight.
            let plain = PathSettings { technique: Technique::Scattering, roulette: false, ..settings(4000) };
            if medium == "sigma_s 3" {
                let found = mean(&scene, plain, 64, 0);
                assert!((found.mean - 1.0).abs() < 1e-5, "{shape}: {}", found.mean);
            }
        }
    }
}

/// Clear glass around what scatters all light, and a cavity in that.
#[test]
fn filled_glass_is_not_seen_under_a_uniform_sky() {
    for spectral in [false, true] {
        let text = format!(
            "{} Media {{ Medium m {{ sigma_s 1 2 3 g 0.5 }} Medium n {{ sigma_s 4 }} }}
             Materials {{ Glass g {{ indexOfRefraction 1.5 medium m priority 1 }} Interface i {{ medium n priority 2 }} }}
             Group {{ MaterialIndex g Sphere {{ center 0 0 0 radius 1 }}
                      MaterialIndex i Box {{ min -0.4 -0.4 -0.7 max 0.4 0.4 0.2 }} }}",
            under_a_white_sky([0.0, 0.5, 4.0], [0.0, 0.0, 0.0])
        );
        let settings = PathSettings { spectral, ..settings(4000) };
        mean(&scene(&text), settings, 3000, 1).check(1.0, 0.05).unwrap();
    }
}

/// Wavelengths by wavelength is the same as by red, green and blue where all are alike.
#[test]
fn spectral_media_are_as_bright() {
    let text = |spectrum: &str| {
        format!(
            "{} Media {{ Medium m {{ {spectrum} }} }} Materials {{ Interface i {{ medium m }} }}
             Lights {{ PointLight {{ position 0 2 0  intensity 1 }} }}
             Group {{ MaterialIndex i Sphere {{ center 0 0 0 radius 1 }} }}",
            camera([0.0, 0.0, 5.0], [0.0, 0.0, 0.0])
        )
    };
    let scene = scene(&text("albedo 0.8 density 1.5 g 0.3"));
    let by_rgb = mean(&scene, settings(8), 20_000, 1);
    let by_wavelength = mean(&scene, PathSettings { spectral: true, ..settings(8) }, 20_000, 1);
    let spread = (by_rgb.standard_error.powi(2) + by_wavelength.standard_error.powi(2)).sqrt();
    assert!((by_rgb.mean - by_wavelength.mean).abs() < 4.0 * spread, "{by_rgb:?} {by_wavelength:?}");
}

/// The three ways of finding light agree where all of them can.
#[test]
fn techniques_agree() {
    let text = format!(
        "{} Media {{ Medium m {{ albedo 0.9 0.7 0.5 density 1 2 3 g 0.6 }} Medium haze {{ sigma_s 0.05 }} exterior haze }}
         Materials {{ Interface i {{ medium m }} Matte light {{ color 0 0 0 emission 4 }} Matte grey {{ color 0.5 0.5 0.5 }} }}
         Group {{ MaterialIndex i Sphere {{ center 0 0 0 radius 1 }}
                  MaterialIndex light Quad {{ corner -1 3 -1 edge1 2 0 0 edge2 0 0 2 }}
                  MaterialIndex grey Disk {{ center 0 -1.5 0 normal 0 1 0 radius 3 }} }}",
        camera([0.0, 0.3, 5.0], [0.0, 0.0, 0.0])
    );
    let scene = scene(&text);
    for lane in [0, 2] {
        let of = |technique| mean(&scene, PathSettings { technique, ..settings(6) }, 8000, lane);
        let [combined, lights, scattering] = TECHNIQUES.map(of);
        for other in [lights, scattering] {
            let spread = (combined.standard_error.powi(2) + other.standard_error.powi(2)).sqrt();
            assert!((combined.mean - other.mean).abs() < 4.0 * spread, "{lane}: {combined:?} {other:?}");
        }
    }
}

/// A grid of 4 x 3 x 5 densities from 0 to 1 in the box from -1 to 1, and a function that knows what is between them.
fn random_grid() -> (String, impl Fn(f64, f64, f64) -> f64) {
    const SIZE: [usize; 3] = [4, 3, 5];
    let numbers = kajo_math::rng::Stream::new(77, [1, 2], 3);
    let values: Vec<f32> = (0..60).map(|k| numbers.uniform(k)).collect();
    let text: Vec<String> = values.iter().map(f32::to_string).collect();
    let text = format!("size 4 3 5  values {}", text.join(" "));
    let at = move |x: f64, y: f64, z: f64| {
        let mut sum = 0.0;
        let mut corner = |i: usize, j: usize, k: usize, weight: f64| {
            sum += weight * f64::from(values[(k * SIZE[1] + j) * SIZE[0] + i]);
        };
        let split = |v: f64, n: usize| {
            let place = ((v + 1.0) / 2.0 * n as f64 - 0.5).clamp(0.0, n as f64 - 1.0);
            let low = (place as usize).min(n - 2);
            [(low, 1.0 - (place - low as f64)), (low + 1, place - low as f64)]
        };
        for (i, u) in split(x, SIZE[0]) {
            for (j, v) in split(y, SIZE[1]) {
                for (k, w) in split(z, SIZE[2]) {
                    corner(i, j, k, u * v * w);
                }
            }
        }
        sum
    };
    (text, at)
}

fn grid_scene(view: &str, medium: &str, rest: &str) -> Scene {
    scene(&format!(
        "{view} Media {{ {medium} }} Materials {{ Interface i {{ medium m }} }}
         Group {{ MaterialIndex i Box {{ min -1 -1 -1 max 1 1 1 }} }} {rest}"
    ))
}

/// What a grid lets through against the integral of its density, which is a cubic in each cell, so that two points of Gauss's rule
/// for each piece of the ray between planes of voxels are exact.
#[test]
fn grids_let_through_what_their_integral_says() {
    let (grid, density) = random_grid();
    let (from, to) = ([3.0f64, 1.0, 4.0], [-0.1, 0.2, 0.1]);
    let d = [0, 1, 2].map(|i| to[i] - from[i]);
    let length = d.iter().map(|v| v * v).sum::<f64>().sqrt();
    let mut planes: Vec<f64> = Vec::new();
    for (axis, n) in [4, 3, 5].into_iter().enumerate() {
        let edges = (0..n).map(|k| -1.0 + 2.0 * (f64::from(k) + 0.5) / f64::from(n)).chain([-1.0, 1.0]);
        planes.extend(edges.map(|plane| (plane - from[axis]) / d[axis]));
    }
    planes.sort_by(f64::total_cmp);
    let mut depth = 0.0;
    for pair in planes.windows(2) {
        let at = |t: f64| [0, 1, 2].map(|i| from[i] + t * d[i]);
        let middle = at(0.5 * (pair[0] + pair[1]));
        if middle.iter().all(|v| v.abs() < 1.0) {
            for side in [-1.0, 1.0] {
                let t = 0.5 * (pair[0] + pair[1]) + side / 12f64.sqrt() * (pair[1] - pair[0]);
                let [x, y, z] = at(t);
                depth += 0.5 * (pair[1] - pair[0]) * length * density(x, y, z);
            }
        }
    }
    let view = under_a_white_sky(from.map(|v| v as f32), to.map(|v| v as f32));
    let scene = grid_scene(&view, &format!("GridMedium m {{ {grid} sigma_a 0.5 1 3 }}"), "");
    for (lane, sigma) in [0.5, 1.0, 3.0].into_iter().enumerate() {
        let expected = (-sigma * depth).exp();
        mean(&scene, settings(16), 4000, lane).check(expected, 0.06).unwrap();
    }
}

/// The strongest test: nothing of a medium is seen that only scatters, under a sky that is the same everywhere.
#[test]
fn any_grid_of_albedo_1_is_not_seen_under_a_uniform_sky() {
    let (grid, _) = random_grid();
    for medium in [
        format!("GridMedium m {{ {grid} density 8 }}"),
        format!("GridMedium m {{ {grid} sigma_s 1 4 16 g 0.6 }}"),
        "FunctionMedium m { function = 3 * exp(-4 * (x^2 + y^2 + z^2)) + sin(5 * x) sigma_s 1 3 2 }"
            .to_owned(),
    ] {
        for from in [[3.0, 1.0, 4.0], [0.2, -0.1, 0.3]] {
            let scene = grid_scene(&under_a_white_sky(from, [-0.1, 0.2, 0.1]), &medium, "");
            for (lane, technique) in TECHNIQUES.into_iter().enumerate() {
                let settings = PathSettings { technique, ..settings(4000) };
                mean(&scene, settings, 300, lane).check(1.0, 0.05).unwrap();
            }
            let spectral = PathSettings { spectral: true, ..settings(4000) };
            mean(&scene, spectral, 300, 1).check(1.0, 0.05).unwrap();
        }
    }
}

/// A grid that is the same everywhere, and a function that is, scatter as a homogeneous medium.
#[test]
fn constant_grids_are_homogeneous() {
    let beam = "Lights { DirectionalLight { direction 0 -1 0  irradiance 1 } }";
    for medium in [
        "GridMedium m { size 3 1 2 values 0.5 0.5 0.5 0.5 0.5 0.5 sigma_s 2 }",
        "FunctionMedium m { function = 0.25 + 0 * x sigma_s 4 }",
    ] {
        let scene = grid_scene(&camera([0.0, 0.2, 5.0], [0.0, 0.2, 0.0]), medium, beam);
        let expected = (-0.8f64).exp() * (1.0 - (-2f64).exp()) / (4.0 * PI);
        mean(&scene, settings(0), 8000, 0).check(expected, 0.02).unwrap();
    }
}

/// A small emitter in fog, a point light that a ray passes closely, and one on the ray itself: points drawn along the ray change no light
/// and take the fireflies away.
#[test]
fn points_along_a_ray_find_what_collisions_find() {
    const COEFFICIENTS: &str = "sigma_s 0.1 0.3 0.2  sigma_a 0.05 0 0.1  g 0.4";
    const BOX: &str = "min -5 -3 -5 max 5 4 5";
    let text = |fog: &str, rest: &str| {
        format!("{} Media {{ {fog} exterior fog }} {rest}", camera([0.0, 0.0, 4.0], [0.0, 0.0, 0.0]))
    };
    let emitter = |radius: f32| {
        format!(
            "Materials {{ Matte m {{ color 0 0 0  emission {} }} Matte white {{ color 0.7 0.7 0.7 }} }}
             Group {{ MaterialIndex m Sphere {{ center 0 0.3 0  radius {radius} }}
                      MaterialIndex white Plane {{ normal 0 1 0  offset -1 }} }}",
            1.0 / (radius * radius)
        )
    };
    let colors = vdb_of(vec![row_of_colors("Cd", &COLORS)]);
    let cases = [
        (format!("Medium fog {{ {COEFFICIENTS} }}"), emitter(0.05)),
        (format!("Medium fog {{ {COEFFICIENTS} }}"), emitter(0.25)),
        (
            format!("FunctionMedium fog {{ function = 1 + sin(2 * z) * cos(x)  {BOX}  {COEFFICIENTS} }}"),
            emitter(0.05),
        ),
        (format!("GridMedium fog {{ file smoke.vdb  grid Cd  {BOX}  {COEFFICIENTS} }}"), emitter(0.05)),
    ];
    for (fog, rest) in every(2, cases) {
        let scene = scene_with(&text(&fog, &rest), &colors);
        for lane in 0..3 {
            // Met by chance alone, no points are drawn.
            let met = PathSettings { technique: Technique::Scattering, ..settings(1) };
            let [met, both] = [(met, 60_000), (settings(1), 4000)].map(|(s, n)| mean(&scene, s, n, lane));
            let spread = both.standard_error.hypot(met.standard_error);
            assert!((both.mean - met.mean).abs() < 4.5 * spread, "{lane} {fog} {rest}: {both:?} {met:?}");
            assert!(spread < 0.05 * met.mean, "{lane} {fog} {rest}: {both:?} {met:?}");
        }
    }
    // Passing at the distance 0.01: by quadrature. Collisions alone hardly ever come so near.
    let (sigma, b) = (0.3f64, 0.01);
    let light = format!("Lights {{ PointLight {{ position {b} 0 0  intensity 1 }} }}");
    let fog = "Media { Medium fog { sigma_s 0.3 } exterior fog }";
    let close = scene(&format!("{} {fog} {light}", camera([0.0, 0.0, 5.0], [0.0, 0.0, 0.0])));
    let n = 400_000;
    // t = 5 + b tan(angle), so that the integrand is smooth.
    let (low, high) = ((-5.0f64 / b).atan(), PI / 2.0);
    let h = (high - low) / f64::from(n);
    let expected: f64 = (0..n)
        .map(|k| {
            let angle = low + h * (f64::from(k) + 0.5);
            let (t, r) = (5.0 + b * angle.tan(), b / angle.cos());
            h * sigma / (4.0 * PI * b) * (-sigma * (t + r)).exp()
        })
        .sum();
    mean(&close, settings(0), 2000, 0).check(expected, 0.02).unwrap();
}

/// The same where the density is `a + c z`, so that free paths have null collisions.
#[test]
fn points_along_a_ray_through_a_varying_medium_find_what_they_should() {
    let (a, c, b, back) = (0.3f64, 0.05, 0.01, 4.0);
    let text = format!(
        "{} Media {{ FunctionMedium fog {{ function = {a} + {c} * z  min -9 -9 -{back} max 9 9 9  sigma_s 1 }} exterior fog }}
         Lights {{ PointLight {{ position {b} 0 0  intensity 1 }} }}",
        camera([0.0, 0.0, 5.0], [0.0, 0.0, 0.0])
    );
    let n = 400_000;
    let (low, high) = ((-5.0f64 / b).atan(), (back / b).atan());
    let h = (high - low) / f64::from(n);
    let expected: f64 = (0..n)
        .map(|k| {
            let angle = low + h * (f64::from(k) + 0.5);
            let (z, r) = (-b * angle.tan(), b / angle.cos());
            let mean_density = |z: [f64; 2]| a + c * 0.5 * (z[0] + z[1]);
            let depth = mean_density([5.0, z]) * (5.0 - z) + mean_density([z, 0.0]) * r;
            h * (a + c * z) / (4.0 * PI * b) * (-depth).exp()
        })
        .sum();
    mean(&scene(&text), settings(0), 8000, 0).check(expected, 0.02).unwrap();
}

/// Media `a`, `b` and `air`, boundaries of the first two, and the objects that these fill.
fn overlapping(view: &str, media: &str, group: &str) -> Scene {
    scene(&format!(
        "{view} Media {{ {media} }}
         Materials {{ Interface a {{ medium a }} Interface b {{ medium b }} Interface hole {{ priority 1 }} Glass pane {{ indexOfRefraction 1 }} }}
         Group {{ {group} }}"
    ))
}

const LEFT: &str = "MaterialIndex a Box { min -2 -1 -1 max 0.5 1 1 }";
const RIGHT: &str = "MaterialIndex b Box { min -0.5 -0.9 -0.8 max 1 0.8 0.9 }";

const NEARLY_CUBE: &str =
    "MaterialIndex b Box { min -1.00002 -1.00002 -1.00002 max 1.00002 1.00002 1.00002 }";

/// Absorbers let through the product of what each of them does, without noise: two slabs of the lengths 2.5 and 1.5, in air that has an end.
#[test]
fn the_transmittances_of_media_that_overlap_multiply() {
    let media = "Medium a { sigma_a 0.2 0.5 1 }  Medium b { sigma_a 0.3 0.1 0.4 }  GridMedium air { size 1 1 1 values 1  min -4 -4 -4 max 4 4 4 sigma_a 0 }";
    let a = [0.2, 0.5, 1.0].map(|sigma| sigma * 2.5);
    let b = [0.3, 0.1, 0.4].map(|sigma| sigma * 1.5);
    let both = [0, 1, 2].map(|i| a[i] + b[i]);
    // From outside, through a hole of the length 0.8 in both, and from within both.
    let hole = "MaterialIndex hole Box { min -0.4 -2 -2 max 0.4 2 2 }";
    let without = [0, 1, 2].map(|i| both[i] - 0.8 * (a[i] / 2.5 + b[i] / 1.5));
    let half = [0, 1, 2].map(|i| a[i] * 0.2 + b[i] / 1.5);
    for (from, more, expected) in
        [(-5.0, "", both), (5.0, "", both), (-5.0, hole, without), (5.0, hole, without), (0.0, "", half)]
    {
        for objects in [format!("{LEFT} {RIGHT} {more}"), format!("{more} {RIGHT} {LEFT}")] {
            let view = under_a_white_sky([from, 0.1, 0.2], [if from > 0.0 { -9.0 } else { 9.0 }, 0.1, 0.2]);
            let scene = overlapping(&view, media, &objects);
            for (lane, depth) in expected.into_iter().enumerate() {
                let found = mean(&scene, settings(16), 16, lane).mean;
                assert!(
                    (found / f64::exp(-depth) - 1.0).abs() < 5e-6,
                    "{from} {objects} {lane}: {found} {depth}"
                );
            }
        }
    }
    // Glass that is entered after both takes their place.
    let view = under_a_white_sky([-5.0, 0.1, 0.2], [9.0, 0.1, 0.2]);
    let pane = "MaterialIndex pane Box { min -0.4 -2 -2 max 0.4 2 2 }";
    let scene = overlapping(&view, media, &format!("{LEFT} {RIGHT} {pane}"));
    let found = mean(&scene, settings(16), 16, 0).mean;
    assert!((found / f64::exp(-without[0]) - 1.0).abs() < 5e-6, "{found}");
}

/// As for one medium: whatever overlaps whatever.
#[test]
fn media_of_albedo_1_that_overlap_are_not_seen_under_a_uniform_sky() {
    let (grid, _) = random_grid();
    let function = "function = 2 + sin(4 * x) * cos(3 * y)  min -2 -2 -2  max 2 2 2";
    for media in [
        "Medium a { sigma_s 1 2 0.5 g 0.6 }  Medium b { sigma_s 3 0.2 2 phase rayleigh }".to_owned(),
        format!("Medium a {{ sigma_s 0.5 2 1 g 0.6 }}  GridMedium b {{ {grid} sigma_s 8 1 4 droplets 20 }}"),
        format!(
            "FunctionMedium a {{ {function} sigma_s 1 0 0.5 }}  GridMedium b {{ {grid} sigma_s 8 1 4 g -0.5 }}
             FunctionMedium air {{ {function} sigma_s 0 0.4 0.2  phaseTable 0 1 90 0 180 3 }} exterior air"
        ),
    ] {
        for from in [[0.3, 0.2, 4.0], [0.1, -0.3, 0.1]] {
            let view = under_a_white_sky(from, [0.0, -0.2, -0.1]);
            let scene = overlapping(&view, &media, &format!("{LEFT} {RIGHT}"));
            for (lane, technique) in TECHNIQUES.into_iter().enumerate() {
                let settings = PathSettings { technique, ..settings(4000) };
                mean(&scene, settings, 300, lane).check(1.0, 0.05).unwrap();
            }
            let spectral = PathSettings { spectral: true, ..settings(4000) };
            mean(&scene, spectral, 300, 1).check(1.0, 0.05).unwrap();
        }
    }
}

/// A medium that is split into two of the same body is one.
#[test]
fn media_that_overlap_are_their_sum() {
    let beam = "Lights { DirectionalLight { direction 0 -1 0  irradiance 1 } }";
    let view = format!("{} {beam}", camera([0.0, 0.2, 5.0], [0.0, 0.2, 0.0]));
    let cube = "MaterialIndex a Box { min -1 -1 -1 max 1 1 1 }";
    // Surfaces in the same place are met as one.
    let twice = format!("{cube} {NEARLY_CUBE}");
    let voxels = "size 2 1 1 values 1 1";
    for media in [
        "Medium a { sigma_s 0.4 0.1 3 }  Medium b { sigma_s 0.6 0.4 1 }".to_owned(),
        format!("Medium a {{ sigma_s 0.4 0.1 3 }}  GridMedium b {{ {voxels} sigma_s 0.6 0.4 1 }}"),
        format!(
            "GridMedium a {{ {voxels} sigma_s 0.4 0.1 3 }}  GridMedium b {{ {voxels} sigma_s 0.6 0.4 1 }}"
        ),
    ] {
        let scene = overlapping(&view, &media, &twice);
        for (lane, s) in every(2, [1.0f64, 0.5, 4.0].into_iter().enumerate()) {
            let expected = (-0.8 * s).exp() * (1.0 - (-2.0 * s).exp()) / (4.0 * PI);
            mean(&scene, settings(0), 12_000, lane).check(expected, 0.02).unwrap();
        }
    }
    // Where one absorbs what the other scatters, with light that is scattered many times.
    let lit = under_a_white_sky([0.0, 0.2, 5.0], [0.0, 0.2, 0.0]);
    let one = overlapping(
        &lit,
        "Medium a { sigma_s 2 1 0.5  sigma_a 0.1 0.6 0.3  g 0.3 }  Medium b { density 1 }",
        cube,
    );
    for parts in [
        "Medium a { sigma_s 2 1 0.5 g 0.3 }  Medium b { sigma_a 0.1 0.6 0.3 }".to_owned(),
        format!("Medium a {{ sigma_s 2 1 0.5 g 0.3 }}  GridMedium b {{ {voxels} sigma_a 0.1 0.6 0.3 }}"),
        format!(
            "GridMedium a {{ {voxels} sigma_s 1.5 0.5 0 sigma_a 0 0.6 0 g 0.3 }}  Medium b {{ sigma_s 0.5 0.5 0.5  sigma_a 0.1 0 0.3  g 0.3 }}"
        ),
    ] {
        let split = overlapping(&lit, &parts, &twice);
        for lane in every(2, 0..3) {
            let [one, split] = [&one, &split].map(|scene| mean(scene, settings(200), 6000, lane));
            let spread = one.standard_error.hypot(split.standard_error);
            assert!((one.mean - split.mean).abs() < 4.5 * spread, "{parts} {lane}: {split:?} {one:?}");
            assert!(spread < 0.02 * one.mean, "{parts} {lane}: {split:?} {one:?}");
        }
    }
}

/// Media that emit add their light: `e/sigma (1 - exp(-sigma d))` with the sums of both, where one is as hot as the other it has to itself.
#[test]
fn media_that_emit_add_their_light() {
    let cube = format!("MaterialIndex a Box {{ min -1 -1 -1 max 1 1 1 }} {NEARLY_CUBE}");
    let view = camera([0.0, 0.2, 5.0], [0.0, 0.2, 0.0]);
    let voxels = "size 2 1 1 values 1 1";
    for (media, samples) in [
        ("Medium a { sigma_a 0.5 emission 1 2 3 }  Medium b { sigma_a 0.3 emission 0.5 }".to_owned(), 16),
        (
            format!(
                "Medium a {{ sigma_a 0.5 emission 1 2 3 }}  GridMedium b {{ {voxels} sigma_a 0.3 emission 0.5 }}"
            ),
            20_000,
        ),
    ] {
        let scene = overlapping(&view, &media, &cube);
        for (lane, e) in [1.5, 2.5, 3.5].into_iter().enumerate() {
            let expected = e / 0.8 * (1.0 - (-1.6f64).exp());
            let found = mean(&scene, settings(16), samples, lane);
            match samples {
                16 => assert!((found.mean / expected - 1.0).abs() < 1e-4, "{found:?} {expected}"),
                _ => found.check(expected, 0.02).unwrap(),
            }
        }
    }
}

/// A row of voxels along x.
fn row_of_colors(name: &str, colors: &[[f32; 3]]) -> VdbGrid {
    let mut grid = VdbGrid::new(name, VdbKind::Vec3, VdbMap::Uniform(1.0));
    for (i, &color) in colors.iter().enumerate() {
        grid.set([i as i32, 0, 0], color);
    }
    grid
}

const COLORS: [[f32; 3]; 4] = [[0.9, 0.1, 0.4], [0.0, 0.8, 0.2], [0.3, 0.0, 2.0], [0.5, 0.5, 0.0]];

/// Along a row of voxels the optical depth of each colour is the sum of theirs, with that of the air, if there is one: what is seen through
/// it, and light that comes through it to a wall.
#[test]
fn absorption_by_voxels_has_the_colour_of_each() {
    let assets = vdb_of(vec![row_of_colors("Cd", &COLORS)]);
    let sigma = [0.6, 1.0, 0.5];
    let depth = [0, 1, 2].map(|i| sigma[i] * COLORS.iter().map(|c| f64::from(c[i])).sum::<f64>());
    let slab = "GridMedium m { file smoke.vdb  grid Cd  sigma_a 0.6 1 0.5  min -2 -1 -1  max 2 1 1 }";
    for (air, more) in [("", 0.0), ("Medium n { sigma_a 0.1 } exterior n", 0.1)] {
        let seen = format!(
            "{} Background {{ color 0 0 0 }} Media {{ {slab} {air} }}
             Materials {{ Interface i {{ medium m }} Matte light {{ color 0 0 0  emission 1 }} }}
             Group {{ MaterialIndex i Box {{ min -2 -1 -1 max 2 1 1 }} MaterialIndex light Box {{ min 3 -9 -9 max 4 9 9 }} }}",
            camera([-3.0, 0.1, 0.2], [9.0, 0.1, 0.2])
        );
        let lit = format!(
            "{} Background {{ color 0 0 0 }} Media {{ {slab} {air} }}
             Materials {{ Interface i {{ medium m }} Matte wall {{ color 1 1 1 }} }}
             Lights {{ PointLight {{ position -3 0 0  intensity 36 }} }}
             Group {{ MaterialIndex i Box {{ min -2 -1 -1 max 2 1 1 }} MaterialIndex wall Box {{ min 3 -9 -9 max 4 9 9 }} }}",
            camera([2.5, 0.1, 0.0], [3.0, 0.0, 0.0])
        );
        let back = 0.5f64.hypot(0.1);
        for (text, scale, way) in [(seen, 1.0, 6.0), (lit, 1.0 / PI, 6.0 + back)] {
            let scene = scene_with(&text, &assets);
            for (lane, depth) in every(2, depth.into_iter().enumerate()) {
                let expected = scale * (-depth - more * way).exp();
                mean(&scene, settings(4), 20_000, lane).check(expected, 0.02).unwrap();
            }
        }
    }
}

/// Voxels of one colour are as the medium that has it everywhere, alone and with another one in the same place, and what is white and
/// scatters is not seen under a white sky, whatever the colours of its densities.
#[test]
fn voxels_of_one_colour_are_a_medium_of_that_colour() {
    let scene_of = |medium: &str, other: &str, color: [[f32; 3]; 4]| {
        let text = format!(
            "{} Media {{ {medium}  Medium n {{ {other} }} }}
             Materials {{ Interface i {{ medium m }} Interface j {{ medium n }} }}
             Group {{ MaterialIndex i Box {{ min -1 -1 -1 max 1 1 1 }} MaterialIndex j Box {{ min -3 -0.5 -0.5 max 0 0.5 0.5 }} }}",
            under_a_white_sky([0.3, 0.2, 5.0], [-0.2, 0.2, 0.0])
        );
        scene_with(&text, &vdb_of(vec![row_of_colors("Cd", &color)]))
    };
    let grid = |more: &str| {
        format!("GridMedium m {{ file smoke.vdb  grid Cd  min -1 -1 -1  max 1 1 1  density 3  {more} }}")
    };
    let other = "sigma_s 0.4  sigma_a 0.2 0.1 0.3";
    let voxels = scene_of(&grid("albedo 0.7"), other, [[0.25, 0.5, 1.0]; 4]);
    let everywhere = scene_of("Medium m { density 0.75 1.5 3  albedo 0.7 }", other, COLORS);
    let white = scene_of(&grid("g 0.4"), "sigma_s 0.4 1 2", COLORS);
    for lane in 0..3 {
        let [found, expected] = [&voxels, &everywhere].map(|scene| mean(scene, settings(100), 3000, lane));
        let spread = found.standard_error.hypot(expected.standard_error);
        assert!((found.mean - expected.mean).abs() < 4.5 * spread, "{lane}: {found:?} {expected:?}");
        assert!(spread < 0.03 * expected.mean, "{lane}: {found:?} {expected:?}");
        mean(&white, PathSettings { roulette: false, ..settings(4000) }, 1000, lane)
            .check(1.0, 0.02)
            .unwrap();
    }
}

/// A grid of colours is an albedo: as the medium that has it everywhere, alone and with another one in the same place.
#[test]
fn colours_of_voxels_are_albedos() {
    let grids = vec![
        cube_of_voxels("density", VdbKind::Float, [0.5; 3]),
        cube_of_voxels("Cd", VdbKind::Vec3, [0.25, 0.5, 1.0]),
    ];
    let assets = vdb_of(grids);
    let scene_of = |medium: &str| {
        let text = format!(
            "{} Media {{ {medium}  Medium n {{ sigma_s 0.4  sigma_a 0.2 0.1 0.3 }} }}
             Materials {{ Interface i {{ medium m }} Interface j {{ medium n }} }}
             Group {{ MaterialIndex i Box {{ min -1 -1 -1 max 1 1 1 }} MaterialIndex j Box {{ min -3 -0.5 -0.5 max 0 0.5 0.5 }} }}",
            under_a_white_sky([0.3, 0.2, 5.0], [-0.2, 0.2, 0.0])
        );
        scene_with(&text, &assets)
    };
    let place = "min -1 -1 -1 max 1 1 1";
    let by_place =
        scene_of(&format!("GridMedium m {{ file smoke.vdb {place} density 3 albedo 0.9 albedoGrid Cd }}"));
    let everywhere =
        scene_of(&format!("GridMedium m {{ file smoke.vdb {place} density 3 albedo 0.225 0.45 0.9 }}"));
    for lane in 0..3 {
        let [found, expected] = [&by_place, &everywhere].map(|scene| mean(scene, settings(100), 3000, lane));
        let spread = found.standard_error.hypot(expected.standard_error);
        assert!((found.mean - expected.mean).abs() < 4.5 * spread, "{lane}: {found:?} {expected:?}");
        assert!(spread < 0.03 * expected.mean, "{lane}: {found:?} {expected:?}");
    }
}

/// A cube of voxels of the density 1, that goes its own width along x while the shutter is open: a ray beside where it was meets matter for
/// three quarters of the time, whose absorption and emission it sees for so long; where light is only scattered nothing is seen.
#[test]
fn matter_that_moves_is_where_its_velocity_has_brought_it() {
    let grids = vec![
        cube_of_voxels("density", VdbKind::Float, [1.0; 3]),
        cube_of_voxels("Cd", VdbKind::Vec3, [1.0, 0.5, 0.25]),
        cube_of_voxels("flame", VdbKind::Float, [1.0; 3]),
        cube_of_voxels("vel", VdbKind::Vec3, [8.0, 0.0, 0.0]),
        cube_of_voxels("v.x", VdbKind::Float, [8.0; 3]),
        cube_of_voxels("v.y", VdbKind::Float, [0.0; 3]),
        cube_of_voxels("v.z", VdbKind::Half, [0.0; 3]),
    ];
    let assets = vdb_of(grids);
    // The box of the file is 4 wide, and here 2, so that a velocity of 8 is one of 4, half of which is 2.
    let scene_of = |shutter: &str, medium: &str, other: &str| {
        let view = under_a_white_sky([1.5, 0.2, 5.0], [1.5, 0.2, 0.0]);
        let view = view.replacen("Camera {", &format!("Camera {{ shutter {shutter} "), 1);
        let (materials, body) = match other {
            "" => ("", ""),
            _ => ("Interface j { medium n }", "MaterialIndex j Box { min -2 -1 -1.9 max 3 1 2.1 }"),
        };
        let text = format!(
            "{view} Media {{ GridMedium m {{ file smoke.vdb min -1 -1 -1 max 1 1 1 velocityScale 0.5 {medium} }} {other} }}
             Materials {{ Interface i {{ medium m }} {materials} }}
             Group {{ MaterialIndex i Box {{ min -3 -2 -2 max 4 2 2 }} {body} }}"
        );
        scene_with(&text, &assets)
    };
    let colored = [0.7, 0.35, 0.175];
    let haze = "Medium n { sigma_a 0.1 }";
    for (shutter, share) in [("0 1", 0.75), ("0 0", 0.0), ("0.9 0.9", 1.0), ("-1 1", 0.375), ("0 0.5", 0.5)] {
        for velocity in every(2, ["velocity vel", "velocity v"]) {
            for (medium, sigma) in [("density 0.7", [0.7; 3]), ("grid Cd density 0.7", colored)] {
                for (other, more) in [("", 0.0), (haze, 0.4)] {
                    let scene = scene_of(shutter, &format!("{medium} albedo 0 {velocity}"), other);
                    for (lane, sigma) in every(2, sigma.into_iter().enumerate()) {
                        let expected = (share * f64::exp(-2.0 * sigma) + 1.0 - share) * f64::exp(-more);
                        let found = mean(&scene, settings(4), 2000, lane);
                        // Where no matter is ever met there is no noise.
                        let is_exact = (found.mean / expected - 1.0).abs() < 1e-6;
                        assert!(
                            is_exact || found.check(expected, 0.02).is_ok(),
                            "{shutter}: {found:?} {expected}"
                        );
                    }
                }
            }
        }
        let fire = "sigma_a 0 temperature flame temperatureScale 1800 velocity vel";
        let [found, resting] = [shutter, "0.9 0.9"].map(|shutter| {
            let scene = scene_of(shutter, fire, "");
            mean(&scene, settings(4), 2000, 0)
        });
        let spread = found.standard_error.hypot(resting.standard_error) + 1e-6;
        assert!(resting.mean > 1.2, "{resting:?}");
        let expected = 1.0 + share * (resting.mean - 1.0);
        assert!((found.mean - expected).abs() < 4.5 * spread, "{shutter}: {found:?} {expected}");
        let white = scene_of(shutter, "density 3 g 0.4 velocity vel", "");
        mean(&white, PathSettings { roulette: false, ..settings(4000) }, 1000, 0).check(1.0, 0.02).unwrap();
    }
}
