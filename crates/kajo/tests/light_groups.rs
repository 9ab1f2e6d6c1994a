//! The light of groups of emitters, seen apart.

use kajo::{
    BitDepth, Defaults, Format, IntegratorName, LightChoice, LoadOptions, MemoryAssets, RenderRequest,
    RenderSettings, SamplerKind, Scene, Settings, Silent, View, load_from, render,
};
use kajo_image::exr::{self, ChannelData, ExrPicture};

const OUTPUTS: [(View, Format); 2] = [(View::Color, Format::Exr), (View::Lights, Format::Exr)];

fn scene(text: &str) -> Scene {
    let loaded = load_from("s.txt", &MemoryAssets::new().with("s.txt", text), &LoadOptions::default());
    assert!(loaded.diagnostics.is_empty(), "{}", loaded.report(false));
    loaded.scene.unwrap()
}

/// The file with the light and its groups.
fn rendered(scene: &Scene, asked: &Settings) -> ExrPicture {
    let settings = RenderSettings::resolve(scene, asked, Defaults::Modern, false).unwrap();
    let picture = render(&RenderRequest::new(scene, &settings, &OUTPUTS), &Silent).unwrap();
    let bytes = picture.encode(&[View::Color, View::Lights], Format::Exr, BitDepth::Eight).unwrap();
    exr::decode(&bytes, &kajo_image::DecodeLimits::default()).unwrap()
}

fn values<'a>(file: &'a ExrPicture, layer: Option<&str>, channel: &str) -> &'a [f32] {
    let layer = file.layer(layer).unwrap_or_else(|| panic!("no layer {layer:?}"));
    match layer.channel(channel) {
        Some(ChannelData::F32(values)) => values,
        other => panic!("{channel} is {other:?}"),
    }
}

#[test]
fn each_group_has_the_light_of_its_lights() {
    let scene = scene(
        "OrthographicCamera { center 0 3 0  direction 0 -1 0  up 0 0 1  size 0.001 }
         Background { color 0 0 0 }
         Lights {
           PointLight { position 0 2 0  intensity 4 2 1  group key }
           PointLight { position 2 2 0  intensity 9 9 9  group fill }
           PointLight { position -2 2 0  intensity 0 0 5  group key }
           PointLight { position 0 1 0  intensity 3 0 0 }
         }
         Materials { Matte { color 0.5 0.5 0.5 } }
         Group { MaterialIndex 0  Plane { normal 0 1 0  offset 0 } }",
    );
    let asked = Settings {
        integrator: Some(IntegratorName("direct")),
        size: Some([1, 1]),
        samples: Some((SamplerKind::Sobol, 4096)),
        exposure: Some(1.0),
        light_choice: Some(LightChoice::Uniform),
        ..Settings::default()
    };
    let file = rendered(&scene, &asked);
    // Twice the albedo over pi, for the exposure, times I cos/d^2; those aside are at 45 degrees.
    let slanted = 2.0 / 8f32.powf(1.5);
    for (group, irradiance) in [
        ("lights.key", [1.0, 0.5, 0.25 + 5.0 * slanted]),
        ("lights.fill", [9.0 * slanted; 3]),
        ("lights.other", [3.0, 0.0, 0.0]),
    ] {
        for (channel, irradiance) in ["R", "G", "B"].into_iter().zip(irradiance) {
            let found = values(&file, Some(group), channel)[0] * std::f32::consts::PI;
            assert!((found - irradiance).abs() <= 0.05 * irradiance, "{group}: {found} for {irradiance}");
        }
    }
}

#[test]
fn the_groups_add_up_to_the_light() {
    let scene = scene(
        "PerspectiveCamera { center 0 1 6  direction 0 -0.1 -1  up 0 1 0  angle 40 }
         Background { color 0.2 0.3 0.5  group sky }
         Lights { PointLight { position 2 4 2  color 3 2 1  group key } }
         Materials {
           Matte floor { color 0.6 0.5 0.4 }  Glass glass { glass N-SF10 }
           Material emitter { diffuseColor 0 0 0  emission 4 3 2  group emitter }
         }
         Group {
           MaterialIndex floor  Plane { normal 0 1 0  offset -1 }
           MaterialIndex glass  Sphere { center 0.5 0 0  radius 1 }
           MaterialIndex emitter   Sphere { center -1.5 0.5 0  radius 0.5 }
         }",
    );
    for (integrator, spectral) in [
        ("path", false),
        ("path", true),
        ("distribution", true),
        ("direct", false),
        ("classic", false),
        ("occlusion", false),
    ] {
        let asked = Settings {
            integrator: Some(IntegratorName(integrator)),
            spectral: Some(spectral),
            size: Some([12, 8]),
            samples: Some((SamplerKind::Sobol, 8)),
            ..Settings::default()
        };
        let file = rendered(&scene, &asked);
        for channel in ["R", "G", "B"] {
            let light = values(&file, None, channel);
            let parts = scene.lighting.groups.iter().map(|name| format!("lights.{name}"));
            let parts: Vec<&[f32]> = parts.map(|name| values(&file, Some(&name), channel)).collect();
            assert_eq!(parts.len(), 4);
            for (i, light) in light.iter().enumerate() {
                let sum: f32 = parts.iter().map(|part| part[i]).sum();
                let size: f32 = parts.iter().map(|part| part[i].abs()).sum();
                assert!((sum - light).abs() <= 1e-5 * size, "{integrator:?}: {sum} for {light}");
            }
            let lit = |part: &[f32]| part.iter().any(|&v| v > 0.05);
            let is_grouped = !matches!(integrator, "classic" | "occlusion");
            assert_eq!(parts[1..].iter().all(|part| lit(part)), is_grouped, "{integrator:?}");
            assert_eq!(lit(parts[0]), !is_grouped, "{integrator:?}");
        }
    }
}

#[test]
fn asking_for_groups_changes_no_light() {
    let scene = scene(
        "PerspectiveCamera { center 0 1 6  direction 0 -0.1 -1  up 0 1 0  angle 40 }
         Materials { Matte floor { color 0.6 0.5 0.4 } }
         Lights { PointLight { position 2 4 2  color 3 2 1  group key } }
         Group { MaterialIndex floor  Plane { normal 0 1 0  offset -1 } }",
    );
    let asked =
        Settings { integrator: Some(IntegratorName("path")), size: Some([16, 9]), ..Settings::default() };
    let settings = RenderSettings::resolve(&scene, &asked, Defaults::Modern, false).unwrap();
    let light = |outputs: &[(View, Format)]| {
        render(&RenderRequest::new(&scene, &settings, outputs), &Silent).unwrap().light().unwrap()
    };
    assert_eq!(light(&OUTPUTS).data(), light(&OUTPUTS[..1]).data());
}
