//! Path tracing against closed forms.

use kajo_core::compile::{CompileOptions, compile};
use kajo_core::sampler::{Sampler, SamplerKind};
use kajo_core::settings::{Directions, Technique};
use kajo_math::DVec3;
use kajo_math::solid_angle::polygon_irradiance;
use kajo_scene::{MemoryAssets, SceneDesc};
use kajo_testkit::Estimate;

use super::*;
use crate::PixelIntegrator;
use crate::integrator::{AmbientOcclusion, AmbientOcclusionSettings};

/// Black on the left, white on the right.
const HALF: &[u8] = b"Pf\n2 1\n-1\n\0\0\0\0\0\0\x80\x3f";

pub(super) fn scene(text: &str) -> Scene {
    let mut parsed = SceneDesc::parse_str(text);
    let assets = MemoryAssets::new().with("half.pfm", HALF);
    let scene = compile(&mut parsed.desc, &assets, &CompileOptions::default(), &mut parsed.diagnostics);
    scene.unwrap_or_else(|| panic!("{text}\n{:?}", parsed.diagnostics))
}

/// A camera that looks through a pixel at about a point, in a black world.
pub(super) fn camera(from: [f32; 3], to: [f32; 3]) -> String {
    let [a, b, c] = from;
    let [x, y, z] = [to[0] - a, to[1] - b, to[2] - c];
    format!(
        "PerspectiveCamera {{ center {a} {b} {c}  direction {x} {y} {z}  up 0.1 0.9 0.2  angle 0.01 }}
         Background {{ color 0 0 0 }}"
    )
}

/// The mean of a lane of the picture's single pixel over batches of paths.
pub(super) fn mean(scene: &Scene, settings: PathSettings, paths: u32, lane: usize) -> Estimate {
    mean_of(&Path::new(scene, settings, [1, 1], LayerSet::of(&[])), paths, lane)
}

pub(super) fn mean_of(integrator: &dyn PixelIntegrator, paths: u32, lane: usize) -> Estimate {
    let sampler = Sampler::new(SamplerKind::Uniform, paths);
    Estimate::of_batches(|batch| {
        let mut ctx = SampleContext::new(&sampler, 0);
        let sum: f64 = (0..paths)
            .map(|k| {
                let place = ctx.begin([0, batch], k);
                f64::from(integrator.sample(&mut ctx, [0, 0], place).radiance[lane])
            })
            .sum();
        sum / f64::from(paths)
    })
}

#[track_caller]
pub(super) fn check(scene: &Scene, settings: PathSettings, paths: u32, expected: f64) {
    let found = mean(scene, settings, paths, 0);
    // Estimates without variance differ by rounding in single precision.
    if (found.mean / expected - 1.0).abs() < 1e-5 {
        return;
    }
    if let Err(complaint) = found.check(expected, 0.01) {
        panic!("{settings:?}: {complaint}");
    }
}

pub(super) const TECHNIQUES: [Technique; 3] = [Technique::Combined, Technique::Lights, Technique::Scattering];

#[test]
fn an_emissive_room_is_as_bright_as_its_series() {
    let shells = [
        "Sphere { center 0 0 0 radius 1 }",
        "Box { min -1 -1.2 -1 max 1.1 1 1 }",
        "Cylinder { base 0 -1 0 top 0 1 0 radius 1 }",
        "Transform { Scale 1 2 1.5 YRotate 30 Sphere { center 0 0 0 radius 0.7 } }",
    ];
    for shell in shells {
        let view = camera([0.2, 0.1, -0.1], [0.7, -0.3, 0.5]);
        let material = "Materials { Material m { diffuseColor 0.5 0.5 0.5  emission 1 1 1 } }";
        let scene = scene(&format!("{view} {material} Group {{ MaterialIndex m {shell} }}"));
        for technique in TECHNIQUES {
            let settings = PathSettings { bounces: 100, technique, ..PathSettings::default() };
            check(&scene, settings, 1600, 2.0);
            // Direct light and one bounce more: 1 + 1/2 + 1/4.
            check(&scene, PathSettings { bounces: 1, ..settings }, 1600, 1.75);
        }
        let settings = PathSettings { bounces: 1, ..PathSettings::default() };
        for directions in [Directions::Cosine, Directions::Uniform] {
            check(&scene, PathSettings { directions, ..settings }, 1600, 1.75);
            check(&scene, PathSettings { directions, branches: 4, ..settings }, 800, 1.75);
        }
    }
}

#[test]
fn a_square_light_lights_a_floor_as_lambert_says() {
    let view = camera([0.0, 0.5, 2.0], [0.0, 0.0, 0.0]);
    let text = format!(
        "{view} Materials {{ Material floor {{ diffuseColor 0.7 0.7 0.7 }}
                             Material emitter {{ diffuseColor 0 0 0  emission 3 3 3 emits front }} }}
         Group {{ MaterialIndex floor Quad {{ corner -9 0 -9 edge1 0 0 18 edge2 18 0 0 }}
                  MaterialIndex emitter Quad {{ corner -0.5 1 -0.5 edge1 1 0 0 edge2 0 0 1 }} }}"
    );
    let expected = 0.7 / std::f64::consts::PI * 3.0 * 0.752_275;
    for technique in TECHNIQUES {
        let settings = PathSettings { bounces: 1, technique, ..PathSettings::default() };
        check(&scene(&text), settings, 2000, expected);
    }
    // The half of it that a picture, holes or a mixture leave, by every way of saying so.
    let half = [
        DVec3::new(0.0, 1.0, -0.5),
        DVec3::new(0.5, 1.0, -0.5),
        DVec3::new(0.5, 1.0, 0.5),
        DVec3::new(0.0, 1.0, 0.5),
    ];
    let expected_of_half =
        0.7 / std::f64::consts::PI * 3.0 * polygon_irradiance(DVec3::ZERO, DVec3::Y, &half).abs();
    let even = "Material emitter { diffuseColor 0 0 0  emission 3 3 3 emits front }";
    let half_of = |emitter: &str| text.replace(even, emitter);
    for emitter in [
        "Matte emitter { color 0 0 0  emission half.pfm { filter nearest  light 3 } emits front }",
        "Matte emitter { color 0 0 0  emission 3  emits front  opacity half.pfm { filter nearest } }",
        "Matte off { color 0 0 0 } Matte on { color 0 0 0  emission 3  emits front }
         Checkerboard emitter { Transform { Translate 0 0.5 0.5 Scale 1 0.1 0.1 } materialIndex on materialIndex off }",
    ] {
        for technique in TECHNIQUES {
            let settings = PathSettings { bounces: 1, technique, ..PathSettings::default() };
            check(&scene(&half_of(emitter)), settings, 8000, expected_of_half);
        }
    }
    // Its back gives no light.
    let dark = text.replace("emits front", "emits back");
    assert_eq!(mean(&scene(&dark), PathSettings::default(), 50, 0).mean, 0.0);
    // With direct light alone the emitter and the light it casts are there.
    let settings = PathSettings { only_mirrors: true, ..PathSettings::default() };
    check(&scene(&text), settings, 2000, expected);
}

#[test]
fn mirrors_before_the_first_surface_may_be_free() {
    let text = format!(
        "{} Materials {{ Matte floor {{ color 0.7 0.7 0.7 }}  Glass pane {{ indexOfRefraction 1 }}
                         Matte emitter {{ color 0 0 0  emission 3  emits front }} }}
         Group {{ MaterialIndex floor Quad {{ corner -9 0 -9 edge1 0 0 18 edge2 18 0 0 }}
                  MaterialIndex emitter Quad {{ corner -0.5 1 -0.5 edge1 1 0 0 edge2 0 0 1 }}
                  MaterialIndex pane Quad {{ corner -1 0.01 1 edge1 2 0 0 edge2 0 0.8 0 }}
                  Quad {{ corner -1 0.01 1.2 edge1 2 0 0 edge2 0 0.8 0 }} }}",
        camera([0.0, 0.5, 2.0], [0.0, 0.0, 0.0])
    );
    let expected = 0.7 / std::f64::consts::PI * 3.0 * 0.752_275;
    for branches in [1, 4] {
        let settings = PathSettings { bounces: 0, free_mirrors: 2, branches, ..PathSettings::default() };
        check(&scene(&text), settings, 2000, expected);
        let too_few = PathSettings { free_mirrors: 1, ..settings };
        assert_eq!(mean(&scene(&text), too_few, 50, 0).mean, 0.0);
    }
}

#[test]
fn holes_do_not_emit() {
    let text = |opacity: f32| {
        format!(
            "{} Materials {{ Matte floor {{ color 0.7 0.7 0.7 }}
                 Matte emitter {{ color 0 0 0  emission 3  emits front  opacity {opacity} }} }}
             Group {{ MaterialIndex floor Quad {{ corner -9 0 -9 edge1 0 0 18 edge2 18 0 0 }}
                      MaterialIndex emitter Quad {{ corner -0.5 1 -0.5 edge1 1 0 0 edge2 0 0 1 }} }}",
            camera([0.0, 0.5, 2.0], [0.0, 0.0, 0.0])
        )
    };
    for technique in TECHNIQUES {
        let settings = PathSettings { bounces: 1, technique, ..PathSettings::default() };
        let expected = 0.4 * 0.7 / std::f64::consts::PI * 3.0 * 0.752_275;
        check(&scene(&text(0.4)), settings, 2000, expected);
        assert_eq!(mean(&scene(&text(0.0)), settings, 50, 0).mean, 0.0);
    }
    // A black body as warm as the world around it is not to be seen, with holes or without.
    let warm = format!(
        "{} Materials {{ Matte warm {{ color 0 0 0  emission 1  opacity 0.3 }} }}
         Group {{ MaterialIndex warm Sphere {{ center 0 0 0 radius 1 }} }}",
        camera([0.0, 0.0, 4.0], [0.3, 0.5, 0.0]).replace("color 0 0 0", "color 1 1 1")
    );
    check(&scene(&warm), PathSettings::default(), 4000, 1.0);
}

#[test]
fn a_point_light_in_a_white_ball_lights_it_evenly() {
    // Direct light and what all bounces add: I (cos/d^2 + rho/(1-rho)/R^2) rho/pi.
    let view = camera([0.0, 0.6, 0.0], [-1.0, 0.0, 0.0]);
    let text = format!(
        "{view} Lights {{ PointLight {{ position 0.5 0 0  intensity 1 1 1 }} }}
         Materials {{ Material m {{ diffuseColor 0.8 0.8 0.8 }} }}
         Group {{ MaterialIndex m Sphere {{ center 0 0 0 radius 1 }} }}"
    );
    let settings = PathSettings { bounces: 200, ..PathSettings::default() };
    check(&scene(&text), settings, 1000, 1.131_768);
}

#[test]
fn glass_in_an_even_world_is_not_to_be_seen() {
    let text = format!(
        "{} Materials {{ Material glass {{ diffuseColor 0 0 0 transparentColor 1 1 1 indexOfRefraction 1.5 }} }}
         Group {{ MaterialIndex glass Sphere {{ center 0 0 0 radius 1 }} }}",
        camera([0.0, 0.0, 4.0], [0.3, 0.5, 0.0]).replace("color 0 0 0", "color 1 1 1")
    );
    let settings = PathSettings { bounces: 100, ..PathSettings::default() };
    let found = mean(&scene(&text), settings, 200, 0);
    assert!((found.mean - 1.0).abs() < 1e-3, "{found:?}");
}

#[test]
fn colour_and_wavelengths_agree() {
    let view = camera([0.2, 0.1, -0.1], [0.7, -0.3, 0.5]);
    let text = format!(
        "{view} Materials {{ Material m {{ diffuseColor 0.6 0.4 0.2  emission 1 1 1 }} }}
         Group {{ MaterialIndex m Sphere {{ center 0 0 0 radius 1 }} }}"
    );
    let scene = scene(&text);
    let settings = PathSettings { bounces: 1, spectral: true, ..PathSettings::default() };
    // Products of spectra are not those of colours: compare the one bounce that has none, and roughly the rest.
    let direct = PathSettings { bounces: 0, ..settings };
    for (lane, albedo) in [(0, 0.6), (1, 0.4), (2, 0.2)] {
        if let Err(complaint) = mean(&scene, direct, 6000, lane).check(1.0 + albedo, 0.01) {
            panic!("lane {lane}: {complaint}");
        }
        let found = mean(&scene, settings, 4000, lane).mean;
        let expected = 1.0 + albedo + albedo * albedo;
        assert!((found / expected - 1.0).abs() < 0.1, "lane {lane}: {found} for {expected}");
    }
}

#[test]
fn nested_bodies_of_one_index_are_one_body() {
    // Water inside glass that overlaps it: with equal indices nothing is bent or mirrored where they meet, and
    // the world behind is seen as through one ball.
    let ball = |inner: &str| {
        format!(
            "{} Materials {{ Material glass {{ diffuseColor 0 0 0 transparentColor 1 1 1 indexOfRefraction 1.3 }} }}
             Group {{ MaterialIndex glass Sphere {{ center 0 0 0 radius 1 }} {inner} }}",
            camera([0.0, 0.0, 4.0], [0.3, 0.5, 0.0]).replace("color 0 0 0", "color 0.5 0.5 0.5")
        )
    };
    let settings = PathSettings { bounces: 100, ..PathSettings::default() };
    let inner = "Sphere { center 0.1 0 0 radius 0.6 }";
    let found = mean(&scene(&ball(inner)), settings, 200, 0).mean;
    assert!((found - 0.5).abs() < 1e-3, "{found}");
}

/// A floor of albedo 0.6 lit from above through a black screen, seen from the side below the screen.
fn below_a_screen(emitter: &str, screen: &str) -> Scene {
    scene(&format!(
        "{} {} Materials {{
           Matte floor {{ color 0.6 0.6 0.6 }}  Material emitter {{ diffuseColor 0 0 0  emission 3 3 3 }}
           Matte solid {{ color 0 0 0 }}  Matte none {{ color 0 0 0  opacity 0 }}  Glass glass {{ }}
           {screen}
         }}
         Group {{
           MaterialIndex floor  Quad {{ corner -1 0 -1  edge1 2 0 0  edge2 0 0 2 }}
           MaterialIndex screen Quad {{ corner -9 1 -9  edge1 18 0 0  edge2 0 0 18 }}
           {} }}",
        camera([3.0, 0.5, 0.0], [0.0, 0.0, 0.0]),
        if emitter.starts_with("Point") { format!("Lights {{ {emitter} }}") } else { String::new() },
        if emitter.starts_with("Point") { String::new() } else { format!("MaterialIndex emitter {emitter}") },
    ))
}

const SCREENS: [(&str, f64); 3] = [
    ("Matte screen { color 0 0 0  opacity 0.4 }", 0.6),
    ("Mix screen { amount 0.25  materialIndex none  materialIndex solid }", 0.75),
    ("Checkerboard screen { materialIndex none  materialIndex none }", 1.0),
];

#[test]
fn light_comes_through_holes_in_proportion() {
    for (screen, passes) in SCREENS {
        let text = below_a_screen("PointLight { position 0 2 0  intensity 5 5 5 }", screen);
        let expected = passes * 0.6 / std::f64::consts::PI * 5.0 / 4.0;
        check(&text, PathSettings::default(), 400, expected);
        // A square of unit area one above: Lambert's formula.
        let emitter = "Quad { corner -0.5 2 -0.5  edge1 1 0 0  edge2 0 0 1 }";
        let text = below_a_screen(emitter, screen);
        let expected = passes * 0.6 / std::f64::consts::PI * 3.0 * 0.230_837;
        for technique in TECHNIQUES {
            let settings = PathSettings { technique, bounces: 1, ..PathSettings::default() };
            let paths = if technique == Technique::Scattering { 10_000 } else { 2000 };
            check(&text, settings, paths, expected);
        }
    }
}

#[test]
fn what_is_behind_holes_is_seen_in_proportion() {
    for (screen, passes) in SCREENS {
        let text = format!(
            "{} Materials {{
               Matte solid {{ color 0 0 0 }}  Matte none {{ color 0 0 0  opacity 0 }}  {screen}
             }} Group {{ MaterialIndex screen  Quad {{ corner -9 -9 0  edge1 18 0 0  edge2 0 18 0 }} }}",
            camera([0.1, 0.2, 4.0], [0.3, 0.5, 0.0]).replace("color 0 0 0", "color 1 1 1")
        );
        let settings = PathSettings { bounces: 0, ..PathSettings::default() };
        check(&scene(&text), settings, 4000, passes);
    }
}

/// The share of light that a pane of index 1.5 and the optical depth `depth` lets pass at the cosine `cos`.
fn pane_share(cos: f64, depth: f64) -> f64 {
    let cos_t = (1.0 - (1.0 - cos * cos) / 2.25).sqrt();
    let rs = (cos - 1.5 * cos_t) / (cos + 1.5 * cos_t);
    let rp = (1.5 * cos - cos_t) / (1.5 * cos + cos_t);
    let (r, a) = (0.5 * (rs * rs + rp * rp), (-depth / cos_t).exp());
    (1.0 - r) * (1.0 - r) * a / (1.0 - r * r * a * a)
}

#[test]
fn lights_shine_through_panes() {
    // What stands above the floor and is between it and the lights, and what it lets pass at a cosine.
    type Passes = fn(f64) -> f64;
    let panes: [(&str, Passes); 5] = [
        ("Glass pane { thin on }", |cos| pane_share(cos, 0.0)),
        ("Glass pane { thickness 0.2  absorption 3 1 1 }", |cos| pane_share(cos, 0.6)),
        ("Principled pane { transmission 1  thin on  roughness 0.1  color 0.5 0.7 0.9 }", |cos| {
            pane_share(cos, 2f64.ln())
        }),
        ("Principled pane { transmission 0.5  thin on  roughness 0  color 1 1 1  metalness 0.2 }", |cos| {
            0.4 * pane_share(cos, 0.0)
        }),
        (
            "Glass clear { thin on }  Matte none { opacity 0 }  Mix pane { amount 0.25  materialIndex clear  materialIndex none }",
            |cos| 0.25 + 0.75 * pane_share(cos, 0.0),
        ),
    ];
    for (pane, passes) in panes {
        let text = |emitter: &str| {
            format!(
                "{} Materials {{ Matte floor {{ color 0.7 0.7 0.7 }} {pane} Matte bright {{ color 0 0 0  emission 3  emits front }} }}
                 Group {{ MaterialIndex floor Quad {{ corner -9 0 -9 edge1 0 0 18 edge2 18 0 0 }}
                          MaterialIndex pane Quad {{ corner -9 0.6 -9 edge1 0 0 18 edge2 18 0 0 }} {emitter} }}",
                camera([0.0, 0.5, 2.0], [0.0, 0.0, 0.0])
            )
        };
        // A point light at (0.6, 1, 0): I/d^2 cos rho/pi of the share.
        let point = text("")
            .replace("Materials", "Lights { PointLight { position 0.6 1 0  intensity 3 3 3 } } Materials");
        let cos = 1.0 / 1.36f64.sqrt();
        let expected = 0.7 / std::f64::consts::PI * 3.0 * cos.powi(3) * passes(cos);
        check(&scene(&point), PathSettings { bounces: 1, ..PathSettings::default() }, 200, expected);
        // A square light, piece by piece.
        let square = text("MaterialIndex bright Quad { corner -0.5 1 -0.5 edge1 1 0 0 edge2 0 0 1 }");
        let n = 200;
        let middle = |i: i32| (f64::from(i) + 0.5) / f64::from(n) - 0.5;
        let pieces = (0..n * n).map(|i| {
            let cos = 1.0 / (1.0 + middle(i / n).powi(2) + middle(i % n).powi(2)).sqrt();
            cos.powi(4) * passes(cos) / f64::from(n * n)
        });
        let expected = 0.7 / std::f64::consts::PI * 3.0 * pieces.sum::<f64>();
        for technique in TECHNIQUES {
            let settings = PathSettings { bounces: 1, technique, ..PathSettings::default() };
            check(&scene(&square), settings, 8000, expected);
        }
        // The share of the sky that a floor sees through the pane.
        let wide = "corner -900 0.6 -900 edge1 0 0 1800 edge2 1800 0 0";
        let below = scene(&text("").replace("corner -9 0.6 -9 edge1 0 0 18 edge2 18 0 0", wide));
        let occlusion =
            AmbientOcclusion::new(&below, AmbientOcclusionSettings { reach: 1e5 }, [1, 1], LayerSet::of(&[]));
        let seen = (0..1000).map(|i| (f64::from(i) + 0.5) / 1000.0).map(|cos| 2e-3 * cos * passes(cos));
        let found = mean_of(&occlusion, 4000, 0);
        // Of a coloured pane the luminance counts.
        if !pane.contains("color 0.5") && !pane.contains("absorption 3") {
            found.check(seen.sum(), 0.02).unwrap_or_else(|complaint| panic!("{pane}: {complaint}"));
        }
        // Where only direct light is asked for, panes are no hindrance either.
        let settings = PathSettings { only_mirrors: true, bounces: 1, ..PathSettings::default() };
        check(&scene(&square), settings, 8000, expected);
    }
}

#[test]
fn a_mixture_is_as_bright_as_its_parts_in_their_shares() {
    let text = format!(
        "{} Materials {{
           Matte dark {{ color 0.1 0.1 0.1 }}  Matte light {{ color 0.9 0.9 0.9 }}
           Mix mixed {{ amount 0.3  materialIndex dark  materialIndex light }}
         }} Group {{ MaterialIndex mixed  Sphere {{ center 0 0 0  radius 1 }} }}",
        camera([0.1, 0.2, 4.0], [0.3, 0.5, 0.0]).replace("color 0 0 0", "color 1 1 1")
    );
    check(&scene(&text), PathSettings::default(), 4000, 0.7 * 0.1 + 0.3 * 0.9);
}

#[test]
fn light_is_absorbed_on_its_way_from_a_light_and_to_the_camera() {
    // Everything is inside of a body that bends nothing: rho/pi I/h^2 exp(-a (h + d)).
    let view = camera([0.0, 0.5, 0.5], [0.0, 0.0, 0.0]);
    let text = format!(
        "{view} Lights {{ PointLight {{ position 0 1 0  intensity 3 3 3 }} }}
         Materials {{ Glass murk {{ indexOfRefraction 1  absorption 0.8 0.8 0.8 }}
                      Matte floor {{ color 0.7 0.7 0.7  roughness 0 }} }}
         Group {{ MaterialIndex murk Box {{ min -5 -5 -5 max 5 5 5 }}
                  MaterialIndex floor Quad {{ corner -2 0 -2 edge1 0 0 4 edge2 4 0 0 }} }}"
    );
    let expected = 0.7 / std::f64::consts::PI * 3.0 * (-0.8 * (1.0 + 0.5f64.sqrt())).exp();
    let settings = PathSettings { bounces: 1, ..PathSettings::default() };
    check(&scene(&text), settings, 10, expected);
    // A light with a surface is found in two ways, which must agree about the murk.
    let lit = text.replace("PointLight { position 0 1 0  intensity 3 3 3 }", "").replace(
        "MaterialIndex floor",
        "MaterialIndex emitter Quad { corner -1 1 -1 edge1 2 0 0 edge2 0 0 2 } MaterialIndex floor",
    );
    let lit = lit.replace("Matte floor", "Material emitter { emission 3 3 3 } Matte floor");
    let drawn = PathSettings { technique: Technique::Lights, ..settings };
    let drawn = mean(&scene(&lit), drawn, 4000, 0);
    for technique in [Technique::Combined, Technique::Scattering] {
        check(&scene(&lit), PathSettings { technique, ..settings }, 8000, drawn.mean);
    }
}

#[test]
fn a_hidden_boundary_before_a_light_takes_nothing_away() {
    // The ball of lower priority is not there; shadow rays do not know that, so chance must count in full.
    let view = camera([0.0, 0.5, 0.5], [0.0, 0.0, 0.0]);
    let text = |ball: &str| {
        format!(
            "{view} Materials {{ Glass air {{ indexOfRefraction 1  priority 1 }}  Glass ball {{ }}
                          Matte floor {{ color 0.7 0.7 0.7  roughness 0 }}  Material emitter {{ emission 3 3 3 }} }}
             Group {{ MaterialIndex air Box {{ min -5 -5 -5 max 5 5 5 }}
                      MaterialIndex emitter Quad {{ corner -1 1 -1 edge1 2 0 0 edge2 0 0 2 }} {ball}
                      MaterialIndex floor Quad {{ corner -2 0 -2 edge1 0 0 4 edge2 4 0 0 }} }}"
        )
    };
    let settings = PathSettings { bounces: 1, ..PathSettings::default() };
    let clear = mean(&scene(&text("")), settings, 4000, 0);
    let hidden = text("MaterialIndex ball Box { min -1.5 0.6 -1.5 max 1.5 0.8 1.5 }");
    check(&scene(&hidden), settings, 8000, clear.mean);
}

/// What is before the camera and hidden neither stops its ray nor moves the surface behind, and layers say what others do of it.
#[test]
fn occlusion_goes_on_behind_a_hidden_boundary() {
    let view = camera([0.0, 0.5, 0.5], [0.0, 0.0, 0.0]);
    let text = |ball: &str| {
        format!(
            "{view} Materials {{ Glass air {{ indexOfRefraction 1  priority 1 }}  Glass ball {{ }}  Matte floor {{ }} }}
             Group {{ MaterialIndex air Box {{ min -5 -5 -5 max 5 5 5 }} {ball}
                      MaterialIndex floor Quad {{ corner -2 0 -2 edge1 0 0 4 edge2 4 0 0 }} }}"
        )
    };
    let [clear, hidden] =
        ["", "MaterialIndex ball Sphere { center 0 0.25 0.25 radius 0.1 }"].map(|ball| scene(&text(ball)));
    let sampler = Sampler::new(SamplerKind::Uniform, 1);
    let sample = |integrator: &dyn PixelIntegrator| {
        let mut ctx = SampleContext::new(&sampler, 0);
        let position = ctx.begin([0, 0], 0);
        integrator.sample(&mut ctx, [0, 0], position)
    };
    let occlusion = |scene: &Scene| {
        let settings = AmbientOcclusionSettings { reach: 0.1 };
        sample(&AmbientOcclusion::new(scene, settings, [1, 1], LayerSet::of(&[])))
    };
    assert_eq!((occlusion(&clear).radiance, occlusion(&hidden).radiance), ([1.0; 3], [1.0; 3]));
    let path = sample(&Path::new(&hidden, PathSettings::default(), [1, 1], LayerSet::of(&[])));
    assert_eq!(occlusion(&hidden).first, path.first);
    assert!(path.first.is_some_and(|first| first.t < 0.4), "the ball: {:?}", path.first);
}

#[test]
fn a_glossy_surface_in_a_body_of_its_own_index_is_not_glossy() {
    // Seen against the normal, where the share that is mirrored is ((n - m) / (n + m))^2.
    let look = |outside: f64| {
        let text = format!(
            "{} Materials {{ Glass body {{ indexOfRefraction {outside} }}
                  Principled paint {{ color 0 0 0  roughness 0  indexOfRefraction 1.5 }} }}
             Group {{ MaterialIndex body Box {{ min -9 -1 -9 max 9 1 9 }}
                      MaterialIndex paint Quad {{ corner -8 0 -8 edge1 0 0 16 edge2 16 0 0 }} }}",
            camera([0.0, 4.0, 0.0], [0.0, 0.0, 0.0]).replace("color 0 0 0", "color 1 1 1")
        );
        mean(&scene(&text), PathSettings { bounces: 3, ..PathSettings::default() }, 4000, 0).mean
    };
    let mirrored = |n: f64, m: f64| ((n - m) / (n + m)).powi(2);
    for outside in [1.0, 1.33, 1.5] {
        let (face, paint) = (mirrored(1.0, outside), mirrored(outside, 1.5));
        // Mirrored by the face, and by the paint behind it once.
        let expected = face + (1.0 - face).powi(2) * paint;
        assert!((look(outside) - expected).abs() < 0.004, "{outside}: {} {expected}", look(outside));
    }
}
