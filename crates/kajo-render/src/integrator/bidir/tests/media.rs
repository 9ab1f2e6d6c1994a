//! Participating media: all ways are one, closed forms, and the same light as by path tracing.

use kajo_testkit::every;

use super::ways::{check_merged_light, check_ways_within};
use super::*;
use crate::integrator::same_picture::assert_same_picture;

/// A room with a light on its ceiling, filled with `air` and with other things in it.
fn room(media: &str, materials: &str, emitter: &str, things: &str) -> String {
    format!(
        "PerspectiveCamera {{ center 0 0 0.95  direction 0 -0.2 -1  up 0 1 0  angle 70 }} Background {{ color 0 0 0 }}
         Media {{ {media} }}
         Materials {{ Matte white {{ color 0.7 0.7 0.7 }}  Material emitter {{ diffuseColor 0.2 0.2 0.2  emission 2 2 2 }} {materials} }}
         Group {{ MaterialIndex white  Box {{ min -1 -1 -1  max 1 1 1 }}  {emitter}  {things} }}"
    )
}

const CEILING: &str = "MaterialIndex emitter Quad { corner -0.6 0.95 -0.6  edge1 1.2 0 0  edge2 0 0 1.2 }";
const GRID: &str =
    "GridMedium m { size 2 2 2 values 1 0.2 0 0.7 0.4 1 0.6 0.1 min -0.7 -0.7 -0.7 max 0.6 0.6 0.6";
const COLORED_GRID: &str = "GridMedium m { file colors.vdb  grid Cd  min -0.7 -0.7 -0.7  max 0.6 0.6 0.6  sigma_s 1.5 1 1.2  sigma_a 0.4 0.2 0.6  g 0.3";
const BODY: &str = "MaterialIndex body Box { min -0.7 -0.7 -0.7  max 0.6 0.6 0.6 }";

const LOW: &str = "MaterialIndex body Box { min -0.6 -0.9 -0.6  max 0.6 -0.3 0.3 }";

/// Each way of drawing a path of some length finds all of its light alone, with collisions anywhere on it. Alone some are noisy, where
/// collisions near the camera or near each other are joined.
#[test]
fn all_ways_through_media_are_one() {
    let body = "Interface body { medium m }";
    let air = room("Medium air { sigma_s 0.4  sigma_a 0.2  g 0.3 }  exterior air", "", CEILING, "");
    let in_body = |media: &str| room(media, body, CEILING, BODY);
    let coloured = format!(
        "{GRID} sigma_s 0.3 1 2.5  sigma_a 0.8 0.2 0.1  g -0.4 }}  Medium air {{ sigma_s 0.3 0.1 0.2 }} exterior air"
    );
    // Three in one place, each with its own phase function.
    let three = format!(
        "{GRID} sigma_s 0.5 1 2  sigma_a 0.4 0.2 0.1  phaseTable 0 0  90 2  180 1 }}
         FunctionMedium n {{ function = 1 + x * y  sigma_s 1.2 0.6 0.3  g 0.5 }}
         Medium air {{ sigma_s 0.2 0.1 0.3 }} exterior air"
    );
    let bodies = format!("{BODY} MaterialIndex other Box {{ min -0.3 -0.9 -0.9  max 0.9 0.3 0.5 }}");
    let materials = "Interface body { medium m } Interface other { medium n }";
    // A column for each colour, one of which sends nothing straight on.
    let columns = "phaseColors on  phaseTable 0 5 3 0  40 2 2 1  90 0.3 0.5 1  180 0.5 0.9 2";
    let cases = [
        (air, 4000),
        (in_body(&format!("{GRID} sigma_s 1.5 sigma_a 0.3 }}")), 6000),
        (in_body(&coloured), 6000),
        (in_body(&format!("{GRID} sigma_s 1 1.5 2 sigma_a 0.3 {columns} }}")), 6000),
        (room(&three, materials, CEILING, &bodies), 6000),
        // A density for each colour, alone and in air.
        (in_body(&format!("{COLORED_GRID} }}")), 6000),
        (in_body(&format!("{COLORED_GRID} }} Medium air {{ sigma_s 0.3 0.1 0.2 }} exterior air")), 6000),
    ];
    for (text, samples) in every(2, cases) {
        check_ways_within(&text, 1, samples, 0.2);
    }
}

/// Vertices on surfaces are merged, those in media connected, since nothing is behind glass.
#[test]
fn merging_in_media_takes_nothing_and_adds_nothing() {
    let air = room("Medium air { sigma_s 0.4 0.2 0.1  sigma_a 0.2  g 0.3 }  exterior air", "", CEILING, "");
    let body =
        room(&format!("{GRID} sigma_s 1.5 sigma_a 0.3 }}"), "Interface body { medium m }", CEILING, BODY);
    for text in [air, body] {
        check_merged_light(&text, 1, (1500, 20_000, 0.03));
    }
}

/// Light comes to a floor through a slab of glass with smoke in it: what is merged there, hit by chance or connected
/// behind it counts once, also where the surface of a body of lower priority lies in the slab and ends connections.
#[test]
fn merging_in_glass_takes_nothing_and_adds_nothing() {
    let even = "Medium m { sigma_s 2.5 1.5 1  sigma_a 0.2  g 0.3 }";
    let grid = "GridMedium m { size 2 2 2 values 1 0.2 0 0.7 0.4 1 0.6 0.1 min -1 0.3 -1 max 1 0.7 1  sigma_s 4 1 2  sigma_a 0.3 }";
    let colors =
        "GridMedium m { file colors.vdb  grid Cd  min -1 0.3 -1 max 1 0.7 1  sigma_s 4 2 3  sigma_a 0.3 }";
    let hidden = "MaterialIndex hidden Box { min -3 0.4 -3  max 3 0.6 3 }";
    let cases = [(even, "", 8000), (grid, "", 14_000), (colors, "", 24_000), (even, hidden, 24_000)];
    for (medium, more, samples) in every(2, cases) {
        let text = format!(
            "PerspectiveCamera {{ center 0 0 0.95  direction 0 -0.6 -1  up 0 1 0  angle 70 }} Background {{ color 0 0 0 }} Media {{ {medium} }}
             Materials {{ Matte white {{ color 0.7 0.7 0.7 }} Matte emitter {{ color 0 0 0  emission 2 2 2 }} Glass body {{ indexOfRefraction 1.3  medium m }}
                          Glass hidden {{ indexOfRefraction 1.3  priority -1 }} }}
             Group {{ MaterialIndex white Quad {{ corner -1 -0.6 -1  edge1 0 0 2  edge2 2 0 0 }}
                      MaterialIndex emitter Quad {{ corner -0.3 0.9 -0.3  edge1 0.6 0 0  edge2 0 0 0.6 }}
                      MaterialIndex body Box {{ min -3 0.3 -3  max 3 0.7 3 }} {more} }}"
        );
        check_merged_light(&text, 3, (samples, 20_000, 0.05));
    }
}

/// The same with a body below layers in the place of a diffuse base, all of it or a part: its formula is not symmetric.
#[test]
fn all_ways_through_bodies_are_one() {
    let layers =
        "roughness 0.5  coat 0.5  coatColor 0.9 0.6 0.8  coatRoughness 0.5  fuzz 0.3  subsurfaceScale 0.6";
    for share in every(2, [0.6, 1.0]) {
        let body = format!("Principled body {{ color 0.9 0.7 0.6  subsurface {share}  {layers} }}");
        check_ways_within(&room("", &body, CEILING, LOW), 2, 6000, 0.4);
    }
    let painted = format!("Principled body {{ color 0.9 0.7 0.6  subsurface 0.8  {layers} }}");
    let text = room("", &painted, CEILING, LOW).replace("color 0.9 0.7 0.6", "color paint");
    let paint =
        "Clouds any { size 0.5 } Ramp paint { texture any  stop 0.3 0.2 0.3 0.3  stop 0.7 0.9 0.5 0.5 }";
    check_ways_within(&format!("Textures {{ {paint} }} {text}"), 2, 6000, 0.4);
}

#[test]
fn lights_seen_through_media_are_found_both_ways() {
    let ball = "MaterialIndex emitter Sphere { center 0.1 0.2 -0.3  radius 0.15 }";
    let text = room(&format!("{GRID} sigma_s 1.5 }}"), "Interface body { medium m }", ball, BODY)
        .replace("angle 70", "angle 60  aperture 0.2  focus 0.7");
    check_ways_within(&text, 0, 8000, 0.2);
}

/// A beam from above into a cube, seen from the side: light that is scattered once.
#[test]
fn single_scattering_in_a_cube() {
    let expected = |s: f64, y: f64| (-s * (1.0 - y)).exp() * (1.0 - (-2.0 * s).exp()) / (4.0 * PI);
    for (s, y) in [(1.0, 0.4), (0.5, -0.5f32)] {
        let text = |medium: &str| {
            format!(
                "{} Media {{ {medium} }} Materials {{ Interface i {{ medium m }} }}
                 Lights {{ DirectionalLight {{ direction 0 -1 0  irradiance 1 }} }}
                 Group {{ MaterialIndex i Box {{ min -1 -1 -1 max 1 1 1 }} }}",
                camera([0.0, y, 5.0], [0.0, y, 0.0], 0.01)
            )
        };
        for medium in [
            format!("Medium m {{ sigma_s {s} }}"),
            format!("FunctionMedium m {{ function = {s} + 0 * x  sigma_s 1 }}"),
        ] {
            let settings = BidirectionalSettings { bounces: 0, ..both() };
            let found = mean(&scene(&text(&medium)), settings, 8000);
            found.check(expected(s, f64::from(y)), 0.02).unwrap();
        }
    }
}

/// The half space of [Chandrasekhar 1950] and the slab of [van de Hulst 1980], see `path/media_tests.rs`.
#[test]
fn half_spaces_and_slabs_are_as_the_tables_say() {
    let view = |sky: &str| camera([0.0, 5.0, 0.0], [0.0, 0.0, 0.0], 0.01).replace("color 0 0 0", sky);
    let half = format!(
        "{} Media {{ Medium m {{ albedo 0.8 density 1 }} }} Materials {{ Interface i {{ medium m }} }}
         Lights {{ DirectionalLight {{ direction 0 -1 0  irradiance 1 }} }}
         Group {{ MaterialIndex i Box {{ min -1000 -1000 -1000 max 1000 0 1000 }} }}",
        view("color 0 0 0")
    );
    let many = BidirectionalSettings { bounces: 200, ..both() };
    mean(&scene(&half), many, 2000).check(0.255_431 / PI, 0.02).unwrap();
    let slab = |black: &str| {
        format!(
            "{} Media {{ Medium m {{ albedo 0.9 density 2 g 0.75 }} }}
             Materials {{ Interface i {{ medium m }} Matte black {{ color 0 0 0 }} }}
             Group {{ MaterialIndex i Box {{ min -500 -1 -500 max 500 0 500 }} MaterialIndex black {black} }}",
            view("color 1 1 1")
        )
    };
    mean(&scene(&slab("Plane { normal 0 1 0 offset -2 }")), many, 2000).check(0.09739, 0.04).unwrap();
    mean(&scene(&slab("Plane { normal 0 1 0 offset 9 }")), many, 2000).check(0.66096, 0.02).unwrap();
}

/// Nothing is lost and nothing is made where all light is scattered under a sky that is the same everywhere.
#[test]
fn media_of_albedo_1_are_not_seen_under_a_uniform_sky() {
    for (medium, material) in [
        ("Medium m { sigma_s 0.5 2 6 g 0.7 }", "Interface i { medium m }"),
        (
            "GridMedium m { size 2 2 2 values 1 0.2 0 0.7 0.4 1 0.6 0.1 min -1 -1 -1 max 1 1 1  sigma_s 1 4 8 }",
            "Interface i { medium m }",
        ),
        ("Medium m { sigma_s 1 2 3 }", "Glass i { indexOfRefraction 1.4  medium m }"),
    ] {
        // In glass radiance is larger by the squared index.
        let views = [[0.3, 0.2, 4.0], [0.1, -0.3, 0.1]];
        for from in views.into_iter().filter(|from| !material.starts_with("Glass") || from[2] > 1.0) {
            let text = format!(
                "{} Media {{ {medium} }} Materials {{ {material} }} Group {{ MaterialIndex i Box {{ min -1 -1 -1 max 1 1 1 }} }}",
                camera(from, [0.0, -0.2, -0.1], 20.0).replace("color 0 0 0", "color 1 1 1")
            );
            for spectral in [false, true] {
                let settings = BidirectionalSettings { bounces: 1000, spectral, ..both() };
                mean(&scene(&text), settings, 400).check(1.0, 0.05).unwrap();
            }
        }
    }
}

/// Fog around a spot light over a floor, balls of smoke and a bottle of it, all kinds of lights.
#[test]
fn media_look_as_by_path_tracing() {
    let lights = [
        "SpotLight { position 0.5 1.2 0.5  direction -0.3 -1 -0.4  angle 60  innerAngle 30  intensity 9 6 4 }",
        "PointLight { position -0.6 0.8 0.3  intensity 2 2 2 }",
        "DirectionalLight { direction 0.3 -1 -0.4  irradiance 2 3 2  angle 20 }",
        "DirectionalLight { direction 0.3 -1 -0.4  irradiance 2 2 2 }",
    ];
    let media = [
        "Medium m { sigma_s 0.5 1 2  sigma_a 0.2 0.1 0  g 0.5 }  Medium air { sigma_s 0.15 0.2 0.3 }",
        "GridMedium m { size 2 1 2 values 3 0.5 0 2 min -0.8 -1 -0.8 max 0.8 0.8 0.8  sigma_s 0.9 0.7 0.8  sigma_a 0.1 0.3 0.2 }  Medium air { sigma_a 0.3 }",
        "FunctionMedium m { function = 2 * exp(-3 * (x^2 + y^2 + z^2))  sigma_s 1 2 3 }
         FunctionMedium air { function = 1 - y  min -2 -1 -2  max 2 1 2  sigma_s 0.2 }",
    ];
    for (i, light) in lights.into_iter().enumerate() {
        for (j, media) in media.into_iter().enumerate() {
            let exterior = if i < 2 || j == 2 { "exterior air" } else { "" };
            let text = format!(
                "PerspectiveCamera {{ center 0 0.3 3  direction 0 -0.1 -1  up 0 1 0  angle 40 }} Background {{ color 0 0 0 }}
                 Lights {{ {light} }} Media {{ {media} {exterior} }}
                 Materials {{ Matte white {{ color 0.7 0.6 0.5 }}  Interface cloud {{ medium m }}  Glass bottle {{ medium m  roughness 0.6 }}
                    Matte emitter {{ color 0.2 0.2 0.2  emission 3 2 1 }} }}
                 Group {{ MaterialIndex white Plane {{ normal 0 1 0  offset -1 }}
                    MaterialIndex {} Sphere {{ center 0 0 0  radius 0.7 }}
                    MaterialIndex emitter Sphere {{ center 0.9 -0.5 0.1  radius 0.3 }} }}",
                if j == 1 && i == 1 { "bottle" } else { "cloud" }
            );
            let scene = scene(&text);
            // Each colour, and by wavelength, somewhere.
            let (lane, spectral) = ((i + j) % 3, (i + 2 * j) % 4 == 1);
            let (bounces, samples) = (3, 2500 * effort());
            let path = PathSettings { bounces, spectral, ..PathSettings::default() };
            let path = mean_of(&Path::new(&scene, path, [1, 1], LayerSet::of(&[])), samples, lane);
            let settings = BidirectionalSettings { bounces, spectral, ..both() };
            let both_ends = integrator_of(&scene.output.camera, &scene, settings, [1, 1], LayerSet::of(&[]));
            let found = mean_of(&*both_ends, samples, lane);
            let sigma = found.standard_error.hypot(path.standard_error);
            let off = (found.mean - path.mean).abs();
            assert!(off < 4.5 * sigma, "{spectral} {lane} {text}: {found:?} {path:?}");
            assert!(sigma < 0.04 * path.mean, "{spectral} {lane} {text} is too noisy: {found:?} {path:?}");
        }
    }
}

/// Light tracing finds all that the camera sees of media and matt surfaces.
#[test]
fn light_tracing_finds_media() {
    let text = "PerspectiveCamera { center 0 0.3 3  direction 0 -0.1 -1  up 0 1 0  angle 40 } Background { color 0 0 0 }
         Lights { PointLight { position -0.6 0.8 0.3  intensity 2 2 2 } }
         Media { FunctionMedium m { function = 2 * exp(-3 * (x^2 + y^2 + z^2))  sigma_s 1 2 3 }  Medium air { sigma_s 0.1  sigma_a 0.05 }  exterior air }
         Materials { Matte white { color 0.7 0.6 0.5 }  Interface cloud { medium m }  Matte emitter { color 0.2 0.2 0.2  emission 3 2 1 } }
         Group { MaterialIndex white Plane { normal 0 1 0  offset -1 }  MaterialIndex cloud Sphere { center 0 0 0  radius 0.7 }
            MaterialIndex emitter Sphere { center 0.9 -0.5 0.1  radius 0.3 } }";
    let scene = scene(text);
    let path = PathSettings { bounces: 3, ..PathSettings::default() };
    let path = mean_of(&Path::new(&scene, path, [1, 1], LayerSet::of(&[])), 4000, 1);
    let settings = BidirectionalSettings { bounces: 3, ..from_lights() };
    let integrator = integrator_of(&scene.output.camera, &scene, settings, [1, 1], LayerSet::of(&[]));
    let found = mean_of(&*integrator, 16_000, 1);
    let sigma = found.standard_error.hypot(path.standard_error);
    assert!((found.mean - path.mean).abs() < 4.5 * sigma, "{found:?} {path:?}");
    assert!(sigma < 0.03 * path.mean, "too noisy: {found:?} {path:?}");
}

#[test]
fn threads_tiles_and_stops_make_the_same_picture() {
    let text = room(
        &format!("{GRID} sigma_s 1 2 3 }} Medium air {{ sigma_s 0.2 }} exterior air"),
        "Interface body { medium m }",
        CEILING,
        BODY,
    );
    let scene = scene(&text);
    let layers = LayerSet::of(&[crate::Layer::Color]);
    let integrator = integrator_of(&scene.output.camera, &scene, both(), [24, 20], layers);
    let settings = crate::RenderSettings::new(Sampler::new(SamplerKind::Sobol, 4));
    assert_same_picture(&*integrator, [24, 20], &settings, [20, 11]);
}
