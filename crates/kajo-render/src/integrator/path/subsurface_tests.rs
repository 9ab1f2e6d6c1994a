//! Bodies that light is scattered in below their surface.

use kajo_core::settings::Technique;
use kajo_testkit::every;

use super::tests::{TECHNIQUES, camera, mean, scene};
use super::*;

fn settings() -> PathSettings {
    PathSettings { bounces: 15_000, ..PathSettings::default() }
}

const HALF_SPACE: &str = "Box { min -1000 -1000 -1000 max 1000 0 1000 }";

/// A body of the material `b` under a sky of the radiance 1.
fn under_a_white_sky(from: [f32; 3], material: &str, body: &str) -> Scene {
    scene(&format!(
        "{} {} Group {{ MaterialIndex b {body} }}",
        camera(from, [0.0, 0.0, 0.0]).replace("color 0 0 0", "color 1 1 1"),
        if material.contains("Materials") {
            material.to_owned()
        } else {
            format!("Materials {{ {material} }}")
        }
    ))
}

/// A half space gives back the colour that was asked for, to one part in a hundred, at each of three mean free paths.
#[test]
fn a_half_space_has_the_colour_of_its_surface() {
    let radius = "subsurfaceScale 1  subsurfaceRadius 1 0.5 2  indexOfRefraction 1";
    let cases = [
        (format!("Principled b {{ color 0.2 0.5 0.8  subsurface 1  {radius} }}"), [0.2, 0.5, 0.8]),
        (format!("Principled b {{ color 0.05 0.95 0.6  subsurface 1  {radius} }}"), [0.05, 0.95, 0.6]),
        (format!("Principled b {{ color 0.2 0.5 0.8  subsurface 0.4  {radius} }}"), [0.2, 0.5, 0.8]),
        (
            format!(
                "Textures {{ Clouds any {{ }} Ramp paint {{ texture any  stop 0 0.5 0.5 0.5  stop 1 0.5 0.5 0.5 }} }}
                 Materials {{ Principled b {{ color paint  subsurface 1  {radius} }} }}"
            ),
            [0.5; 3],
        ),
    ];
    for (material, color) in every(2, cases) {
        let scene = under_a_white_sky([1.0, 5.0, 0.0], &material, HALF_SPACE);
        for (lane, expected) in color.into_iter().enumerate() {
            let found = mean(&scene, settings(), 2000, lane);
            let off = (found.mean - expected).abs();
            assert!(off < 0.01 * expected + 3.0 * found.standard_error, "{material} {lane}: {found:?}");
            assert!(found.standard_error < 0.01, "{found:?}");
        }
    }
}

/// By wavelengths too, whose albedos are inverted one by one: a grey stays grey.
#[test]
fn a_half_space_has_its_colour_by_wavelengths() {
    let material =
        "Principled b { color 0.7 0.7 0.7  subsurface 1  subsurfaceRadius 1 0.2 0.1  indexOfRefraction 1 }";
    let scene = under_a_white_sky([1.0, 5.0, 0.0], material, HALF_SPACE);
    for lane in 0..3 {
        let found = mean(&scene, PathSettings { spectral: true, ..settings() }, 8000, lane);
        assert!((found.mean - 0.7).abs() < 0.007 + 3.0 * found.standard_error, "{lane}: {found:?}");
    }
}

/// Below gloss, coat and fuzz it is as bright as a diffuse base below the same.
#[test]
fn layers_lie_on_a_body_as_on_a_diffuse_base() {
    let layers = "color 0.6 0.6 0.6  roughness 0.4  coat 0.6  coatColor 0.9 0.6 0.8  fuzz 0.4";
    for from in [[1.0, 5.0, 0.0], [9.0, 1.5, 0.0]] {
        let of = |more: &str| {
            let scene = under_a_white_sky(from, &format!("Principled b {{ {layers} {more} }}"), HALF_SPACE);
            mean(&scene, settings(), 8000, 0)
        };
        let (body, base) = (of("subsurface 1"), of(""));
        let noise = body.standard_error.hypot(base.standard_error);
        assert!((body.mean - base.mean).abs() < 0.015 * base.mean + 3.0 * noise, "{body:?} {base:?}");
    }
}

/// With scattering that goes on forward it is about the same colour.
#[test]
fn anisotropy_changes_the_colour_little() {
    for g in [-0.5, 0.8] {
        let material = format!(
            "Principled b {{ color 0.3 0.6 0.9  subsurface 1  subsurfaceAnisotropy {g}  indexOfRefraction 1  subsurfaceScale 1 }}"
        );
        let scene = under_a_white_sky([1.0, 5.0, 0.0], &material, HALF_SPACE);
        for (lane, color) in [0.3, 0.6, 0.9].into_iter().enumerate() {
            let found = mean(&scene, settings(), 1500, lane);
            assert!(
                (found.mean - color).abs() < 0.05 * color + 3.0 * found.standard_error,
                "{g} {lane}: {found:?}"
            );
        }
    }
}

/// Nothing is lost and nothing is made in a body of albedo 1.
#[test]
fn a_white_body_is_not_seen_under_a_uniform_sky() {
    let body = "Sphere { center 0 0 0 radius 1 }";
    for share in [1.0, 0.5] {
        let material = format!(
            "Principled b {{ color 1 1 1  subsurface {share}  indexOfRefraction 1  subsurfaceScale 1  subsurfaceRadius 0.5 }}"
        );
        let scene = under_a_white_sky([0.4, 3.0, 2.0], &material, body);
        for (lane, technique) in TECHNIQUES.into_iter().enumerate() {
            let settings = PathSettings { technique, ..settings() };
            mean(&scene, settings, 200, lane).check(1.0, 0.06).unwrap();
        }
        if share == 1.0 {
            // Every path comes out, and none has another weight.
            let plain = PathSettings { technique: Technique::Scattering, roulette: false, ..settings() };
            let found = mean(&scene, plain, 200, 0);
            assert!((found.mean - 1.0).abs() < 1e-3, "{found:?}");
        }
    }
}

/// Light that comes out at twice the distance of a body of twice the radius is a quarter as bright.
#[test]
fn light_spreads_by_the_radius() {
    let at = |scale: f32| {
        let text = format!(
            "{} Lights {{ PointLight {{ position {scale} {} 0  intensity 1 }} }}
             Materials {{ Principled b {{ color 0.8 0.8 0.8  subsurface 1  subsurfaceScale {scale}  indexOfRefraction 1 }} }}
             Group {{ MaterialIndex b {HALF_SPACE} }}",
            camera([0.0, 5.0, 0.0], [0.0, 0.0, 0.0]),
            0.1 * scale
        );
        mean(&scene(&text), settings(), 8_000, 0)
    };
    let (near, far) = (at(1.0), at(2.0));
    let noise = near.standard_error.hypot(4.0 * far.standard_error);
    assert!((near.mean - 4.0 * far.mean).abs() < 4.0 * noise, "{near:?} {far:?}");
    assert!(noise < 0.2 * near.mean, "{near:?} {far:?}");
    // A diffuse surface has 0.8/π cos θ / r² from a light so low; light that has entered below it comes from there.
    let diffuse = 0.8 / std::f64::consts::PI * 0.1 / 1.01f64.powf(1.5);
    assert!(near.mean - 4.0 * near.standard_error > 1.5 * diffuse, "{near:?} {diffuse}");
}

/// Colours that walk apart bring as much light as paths that have all of them: of a sky, of an emitter beside the body, and of one within it, whether lights are drawn or met.
#[test]
fn split_colours_bring_the_light_of_whole_paths() {
    let text = format!(
        "{} Materials {{
            Principled b {{ color 0.8 0.5 0.4  roughness 0.4  subsurface 1  subsurfaceRadius 1 0.35 0.2  subsurfaceScale 0.6 }}
            Matte emitter {{ color 0.5 0.5 0.5  emission 9 8 12 }}
         }}
         Group {{
            MaterialIndex b Sphere {{ center 0 0 0 radius 1 }}
            MaterialIndex emitter Sphere {{ center 0.2 0.55 0 radius 0.2 }} Quad {{ corner -2 -1 2  edge1 0 2 0  edge2 1 0 1 }}
         }}",
        camera([0.4, 3.0, 2.0], [0.0, 0.3, 0.0]).replace("color 0 0 0", "color 0.3 0.2 0.4")
    );
    let scene = scene(&text);
    // A path with branches is not split.
    let whole = [0, 1, 2].map(|lane| mean(&scene, PathSettings { branches: 2, ..settings() }, 3000, lane));
    for technique in TECHNIQUES {
        for (lane, whole) in whole.iter().enumerate() {
            let split = mean(&scene, PathSettings { technique, ..settings() }, 2000, lane);
            let noise = split.standard_error.hypot(whole.standard_error);
            assert!(
                (split.mean - whole.mean).abs() < 4.0 * noise,
                "{technique:?} {lane}: {split:?} {whole:?}"
            );
            assert!(noise < 0.05 * whole.mean, "{technique:?} {lane}: {split:?} {whole:?}");
        }
    }
}

/// What is lost of each colour depends on its own walk alone, so that little of the noise of whole paths is left.
#[test]
fn split_colours_have_little_noise() {
    let material =
        "Principled b { color 0.8 0.5 0.4  subsurface 1  subsurfaceRadius 1 0.35 0.2  indexOfRefraction 1 }";
    let scene = under_a_white_sky([1.0, 5.0, 0.0], material, HALF_SPACE);
    let [split, whole] =
        [1, 2].map(|branches| mean(&scene, PathSettings { branches, ..settings() }, 1000, 0));
    assert!(split.standard_error < 0.5 * whole.standard_error, "{split:?} {whole:?}");
}
