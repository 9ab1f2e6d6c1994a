//! Light that differs from place to place is the same whichever way a place is found.

use std::collections::BTreeSet;

use kajo_color::{Spectrum, Wavelengths};
use kajo_image::{EncodeOptions, Format, Image, encode};
use kajo_math::{Ray, Vec2, Vec3, rng::Stream};
use kajo_scene::{MemoryAssets, SceneDesc};

use super::{CompileOptions, compile};
use crate::bsdf::tests::without_tables;
use crate::bsdf::{Base, Bsdf, Specular, ThinDielectric};
use crate::ids::LightIndex;
use crate::light::{LeNumbers, LightChoice, LightLeSample, LightPoint, PowerLightSampler, Receiver};
use crate::scene::{RayEvent, Scene};

/// A picture of 2 x 2 colours.
const SLIDE: &[u8] = b"P6\n2 2\n255\n\xff\x40\x20\x30\xe0\x90\x10\x50\xff\xc0\xc0\x60";

const TILE: &str = "mtllib a.mtl\nusemtl neon\nv -1 0 0\nv 1 0 0\nv 1 1 0.3\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n\
    f 1/1 2/2 3/3\nf 1/1 3/3 4/4\n";

fn read(text: &str) -> (Option<Scene>, Vec<String>) {
    let assets = MemoryAssets::new().with("slide.ppm", SLIDE).with("tile.obj", TILE);
    let assets = assets.with("a.mtl", "newmtl neon\nKe 4 2 1\nmap_Ke slide.ppm\n");
    let texel = |i: u32| 10 + 240 * u32::from(i == 19) + i * 7 % 5;
    let texels: Vec<String> = (0..64).map(|i| texel(i).to_string()).collect();
    let assets = assets.with("texel.pgm", format!("P2 8 8 255 {}\n", texels.join(" ")));
    let mut parsed = SceneDesc::parse_str(text);
    let mut diagnostics = parsed.diagnostics;
    let scene = compile(&mut parsed.desc, &assets, &CompileOptions::default(), &mut diagnostics);
    (scene, diagnostics.iter().map(|d| d.message.clone()).collect())
}

/// These things of these materials, whose last is their own.
fn lit(materials: &str, things: &str) -> Scene {
    let text = format!(
        "PerspectiveCamera {{ center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30  shutter 0 1 }} Background {{ color 0 0 0 }}
         Materials {{ {materials} }} Group {{ MaterialIndex emitter {things} }}"
    );
    let (scene, said) = read(&text);
    scene.unwrap_or_else(|| panic!("{text}\n{said:?}"))
}

const MATERIALS: [&str; 5] = [
    "Matte emitter { emission slide.ppm { filter nearest  light blackbody 3000 4 } }",
    "Matte emitter { emission 3 2 1  opacity slide.ppm { channel green } }",
    "Matte emitter { emission slide.ppm { repeat 3  wrap mirror }  opacity slide.ppm  emits front }",
    "Matte a { emission 5 1 1 } Matte b { emission slide.ppm 7 }
     Marble emitter { materialIndex a  materialIndex b  Transform { UniformScale 2 } frequency 3 }",
    "Matte a { color 0 0 0 } Matte b { emission 1 4 2  opacity 0.5 } Mix m { materialIndex a  materialIndex b  amount 0.25 }
     Checkerboard emitter { materialIndex m  materialIndex b  Transform { Translate 0.1 0.2 0.3 UniformScale 3 } }",
];

/// One bright texel of 64.
const TEXEL: &str = "Matte emitter { emission texel.pgm 20 }";

const THINGS: [&str; 10] = [
    "Quad { corner -1 -1 0  edge1 2 0 0  edge2 0.3 2 0 }",
    "Triangle { vertex0 -1 0 0  vertex1 1 0 0  vertex2 0 1 0  textCoord0 0 0  textCoord1 2 0  textCoord2 0 1 }",
    "TriangleMesh { file tile.obj }",
    "TriangleMesh { file tile.obj  materials on }",
    "Sphere { center 0.2 0 0  radius 0.8 }",
    "Disk { center 0 0 0  normal 0 1 1  radius 1 }",
    "Cylinder { base 0 -1 0  top 0 1 0  radius 0.5 }",
    "Cone { base 0 -1 0  top 0 1 0  radius 1 }",
    "Transform { Translate 1 0 0 YRotate 40 Scale 1 2 0.5 Box { min -1 -1 -1  max 1 1 1 } }",
    "Transform { Motion { key 0 { } key 1 { Translate 1 0 0 ZRotate 60 } } TriangleMesh { file tile.obj } }",
];

/// What a ray from `from` to `p` sees give light there, if nothing is in front of it.
fn seen(scene: &Scene, from: Vec3, p: Vec3, time: f32) -> Option<Spectrum> {
    let d = (p - from).normalize();
    let event = scene.trace(&Ray { time, ..Ray::new(from, d) });
    let at = event.surface().filter(|at| at.point.p.distance(p) < 1e-4)?;
    Some(scene.surface_light(at, d, &Wavelengths::RGB)?.radiance)
}

/// Light that leaves a light chosen by its power.
fn leaving(
    scene: &Scene,
    sampler: &PowerLightSampler,
    time: f32,
    u: f32,
    numbers: LeNumbers,
) -> Option<LightLeSample> {
    scene.sample_le(sampler.sample(u)?.light, time, numbers, &Wavelengths::RGB, sampler.world())
}

/// The mean of a function is that of a cube around the origin; light that it gives elsewhere alone is drawn all the same.
#[test]
fn a_function_that_shines_far_from_the_origin_is_a_light() {
    let material = "Matte emitter { emission = 50 * exp(-(x - 30)^2) }";
    for thing in [
        "Quad { corner 29.5 0 0 edge1 1 0 0 edge2 0 1 0 }",
        "Sphere { center 30 0 0 radius 0.5 }",
        "Torus { center 30 0 0 axis 0 1 0 majorRadius 0.5 minorRadius 0.2 }",
        "Blob { threshold 0.5 sphere { center 30 0 0 radius 1 strength 1 } }",
    ] {
        let scene = lit(material, thing);
        let drawn = scene.power_light_sampler().sample(0.5).unwrap_or_else(|| panic!("{thing}"));
        let to = Receiver { p: Vec3::new(30.0, 3.0, 3.0), ..Receiver::default() };
        let pmf = scene.lighting.sampler.pmf(drawn.light, &to, crate::light::LightSelection::Tree);
        assert!(drawn.probability > 0.0 && pmf > 0.0, "{thing}: {} {pmf}", drawn.probability);
    }
}

/// Whether two values are the same, and not on both sides of the edge of a texel or of a pattern.
fn agree(a: Spectrum, b: Spectrum) -> bool {
    (a - b).to_rgb().iter().all(|d| d.abs() < 2e-3 * (1.0 + a.luminance()))
}

#[test]
fn places_give_the_light_that_is_seen_of_them() {
    for materials in MATERIALS {
        for things in THINGS {
            let scene = lit(materials, things);
            let sampler = scene.power_light_sampler();
            let (mut same, mut other, mut values) = (0, 0, BTreeSet::new());
            let mut count = |drawn: Spectrum, seen: Option<Spectrum>| {
                let Some(seen) = seen else { return };
                values.insert((1000.0 * drawn.luminance()) as u32);
                if agree(drawn, seen) { same += 1 } else { other += 1 }
            };
            for k in 0..400 {
                let s = Stream::new(31, [k, 0], 0);
                let u = |d: u32| s.uniform(d);
                let time = u(0);
                let to = Receiver { p: 8.0 * Vec3::new(u(1), u(2), u(3)) - 4.0, n: Vec3::ZERO, time };
                let place = Vec2::new(u(4), u(5));
                let chosen = scene.lighting.sampler.sample(&to, u(6), LightChoice::Tree);
                let drawn = chosen.and_then(|it| {
                    scene.sample_li(it.light, &to, place, &Wavelengths::RGB, LightChoice::Tree)
                });
                if let Some(sample) = drawn
                    && let LightPoint::Surface { p, .. } = sample.at
                {
                    count(sample.radiance, seen(&scene, to.p, p, time));
                }
                let numbers =
                    LeNumbers { position: Vec2::new(u(7), u(8)), direction: Vec2::new(u(9), u(10)) };
                if let Some(leaving) = leaving(&scene, &sampler, time, u(11), numbers) {
                    let p = leaving.at.p();
                    count(leaving.radiance, seen(&scene, p + 0.1 * leaving.d, p, time));
                }
            }
            assert!(same > 200 && other * 200 < same, "{materials} {things}: {same} {other}");
            assert!(values.len() > 1, "{materials} {things} is the same everywhere");
        }
    }
}

/// Mean and variance of the irradiance that a receiver is found to have from the only light, without its own cosine.
fn irradiance(scene: &Scene, p: Vec3) -> [f64; 2] {
    let (mut sum, mut squares, n) = (0.0, 0.0, 20_000);
    for k in 0..n {
        let s = Stream::new(33, [k, 0], 0);
        let to = Receiver { p, n: Vec3::ZERO, time: s.uniform(0) };
        let chosen = scene.lighting.sampler.sample(&to, s.uniform(1), LightChoice::Tree);
        let drawn = chosen.and_then(|chosen| {
            let place = Vec2::new(s.uniform(2), s.uniform(3));
            let li = scene.sample_li(chosen.light, &to, place, &Wavelengths::RGB, LightChoice::Tree)?;
            // What is on the far side of a body does not arrive.
            let LightPoint::Surface { p: point, .. } = li.at else { return None };
            seen(scene, p, point, to.time)?;
            Some(f64::from(li.radiance.luminance() / (li.pdf * chosen.probability)))
        });
        let value = drawn.unwrap_or(0.0);
        sum += value;
        squares += value * value;
    }
    let mean = sum / f64::from(n);
    [mean, squares / f64::from(n) - mean * mean]
}

/// Drawn by what they emit places give the same light as drawn evenly, and on the whole with less noise.
#[test]
fn drawing_places_by_their_emission_changes_no_light() {
    let (mut tables, mut quieter) = (0, 0);
    for materials in MATERIALS.into_iter().chain([TEXEL]) {
        for things in THINGS {
            let scene = lit(materials, things);
            let mut evenly = lit(materials, things);
            evenly.lighting.lights.areas.iter_mut().for_each(|light| light.density = None);
            tables += usize::from(scene.lighting.lights.areas.iter().any(|light| light.density.is_some()));
            for p in [Vec3::new(0.5, 1.5, 2.5), Vec3::new(-4.0, 1.0, 20.0), Vec3::new(1.0, -1.5, -0.7)] {
                let [[mean, variance], [even_mean, even_variance]] =
                    [&scene, &evenly].map(|scene| irradiance(scene, p));
                let sigma = ((variance + even_variance) / 20_000.0).sqrt();
                let place = format!("{materials} {things} from {p}");
                assert!(
                    (mean - even_mean).abs() < 5.0 * sigma + 1e-6,
                    "{place}: {mean} {even_mean} ± {sigma}"
                );
                // A bright texel that faces away is drawn in vain.
                let is_quiet = materials == TEXEL || variance < 1.5 * even_variance + 1e-9;
                assert!(is_quiet, "{place}: {variance} {even_variance}");
                quieter += usize::from(variance < 0.8 * even_variance);
            }
        }
    }
    assert!(tables > 20 && quieter > 38, "{tables} of 60, {quieter} of 180");
}

/// The relative variance of emission over density, of points drawn for nobody.
fn unevenness(scene: &Scene, light: LightIndex) -> f64 {
    let world = *scene.power_light_sampler().world();
    let (mut sum, mut squares, n) = (0.0, 0.0, 4000);
    for k in 0..n {
        let s = Stream::new(34, [k, 0], 0);
        let position = Vec2::new(s.uniform(0), s.uniform(1));
        let numbers = LeNumbers { position, direction: Vec2::new(s.uniform(2), s.uniform(3)) };
        let leaving = scene.sample_le(light, 0.0, numbers, &Wavelengths::RGB, &world).unwrap();
        let weight = f64::from(leaving.radiance.luminance() / leaving.pdf.position);
        sum += weight;
        squares += weight * weight;
    }
    squares * f64::from(n) / (sum * sum) - 1.0
}

/// What a drawn point stands for is everywhere the same on flat patches along whose edges the picture lies, and nearly so elsewhere.
#[test]
fn the_emission_over_its_density_is_even() {
    let floor = "Quad { corner -1 -1 0  edge1 2 0 0  edge2 0 2 0 }";
    for (things, allowed) in
        [(floor, 1e-5), (THINGS[0], 1e-5), (THINGS[1], 0.1), (THINGS[2], 0.1), (THINGS[6], 0.1)]
    {
        let scene = lit(TEXEL, things);
        let mut evenly = lit(TEXEL, things);
        evenly.lighting.lights.areas.iter_mut().for_each(|light| light.density = None);
        for light in LightIndex::all(scene.lighting.lights.areas.len()) {
            let [found, even] = [&scene, &evenly].map(|scene| unevenness(scene, light));
            assert!(found < allowed * even + 0.1 * allowed, "{things} {light:?}: {found} of {even}");
        }
    }
}

/// What lights are chosen by is the mean of their places.
#[test]
fn lights_are_as_strong_as_the_mean_of_their_places() {
    for materials in
        ["Matte emitter { emission slide.ppm 2 { light 1.5 1 0.5 } }", MATERIALS[1], MATERIALS[4]]
    {
        let scene = lit(materials, THINGS[0]);
        let sampler = scene.power_light_sampler();
        let n = 4000;
        let sum = (0..n).fold(Spectrum::BLACK, |sum, k| {
            let s = Stream::new(32, [k, 0], 0);
            let position = Vec2::new(s.uniform(0), s.uniform(1));
            let numbers = LeNumbers { position, direction: Vec2::new(s.uniform(2), s.uniform(3)) };
            let leaving = leaving(&scene, &sampler, 0.0, 0.5, numbers);
            let area = scene.lighting.lights.areas[0].patch.area() as f32;
            sum + leaving.map_or(Spectrum::BLACK, |it| it.radiance * (1.0 / (it.pdf.position * area)))
        });
        let mean = sum * (1.0 / n as f32);
        let known = Spectrum::from(Vec3::from(scene.lighting.lights.areas[0].emission.rgb()));
        let off = (mean - known).to_rgb().map(f32::abs);
        // The pattern is not even over the piece.
        assert!(off.iter().all(|&d| d < 0.1 * known.luminance()), "{materials}: {mean:?} {known:?}");
    }
}

/// A triangle whose material has these words more, as a light without any other.
fn model(words: &str) -> Scene {
    let floats = [-1.0f32, -1.0, 0.0, 3.0, -1.0, 0.0, -1.0, 3.0, 0.0, 0.0, 1.0, 2.0, 1.0, 0.0, -1.0];
    let bytes: Vec<u8> = floats.iter().flat_map(|x| x.to_le_bytes()).collect();
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},"buffers":[{{"uri":"a.bin","byteLength":60}}],
        "bufferViews":[{{"buffer":0,"byteLength":36}},{{"buffer":0,"byteOffset":36,"byteLength":24}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}},
            {{"bufferView":1,"componentType":5126,"count":3,"type":"VEC2"}}],
        "textures":[{{"source":0}},{{"source":1}}],"images":[{{"uri":"slide.ppm"}},{{"uri":"veil.pam"}}],
        "materials":[{{"pbrMetallicRoughness":{{"metallicFactor":0,{words}}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"TEXCOORD_0":1}},"material":0}}]}}],
        "nodes":[{{"mesh":0}}]}}"#
    );
    let image = Image::from_fn(2, 1, |x, _| [1.0, 0.0, 0.5, if x == 0 { 0.25 } else { 0.75 }]).unwrap();
    let veil = encode(&image, Format::Png, &EncodeOptions::default()).unwrap();
    let assets = MemoryAssets::new().with("a.gltf", json).with("a.bin", bytes);
    let assets = assets.with("slide.ppm", SLIDE).with("veil.pam", veil);
    let text =
        "PerspectiveCamera { center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30 } Background { color 0 0 0 }
        Group { Model { file a.gltf } }";
    let mut parsed = SceneDesc::parse_str(text);
    let mut diagnostics = parsed.diagnostics;
    let scene = compile(&mut parsed.desc, &assets, &CompileOptions::default(), &mut diagnostics);
    scene.unwrap_or_else(|| panic!("{words}\n{diagnostics:?}"))
}

#[test]
fn models_emit_and_have_holes() {
    let ray =
        |x: f32, y: f32, from: f32| Ray::new(Vec3::new(x, y, from), Vec3::new(0.0, 0.0, -from.signum()));
    let seen = |scene: &Scene, ray: Ray| {
        let event = scene.trace(&ray);
        let emitted = event.surface().and_then(|at| scene.surface_light(at, ray.d, &Wavelengths::RGB));
        emitted.map(|emitted| emitted.radiance.to_rgb())
    };
    let dark = model("\"roughnessFactor\":1}");
    assert_eq!(seen(&dark, ray(0.0, 0.0, 5.0)), None);
    let even = model("\"roughnessFactor\":1},\"emissiveFactor\":[3,2,1]");
    assert_eq!(seen(&even, ray(0.0, 0.0, 5.0)), Some([3.0, 2.0, 1.0]));
    assert_eq!(seen(&even, ray(0.0, 0.0, -5.0)), None);
    let slide = "\"roughnessFactor\":1},\"emissiveFactor\":[3,2,1],\"emissiveTexture\":{\"index\":0},\"doubleSided\":true";
    let slide = model(slide);
    // At a quarter of the way to the right and three up, the middle of the first texel.
    let texel = [0xffu8, 0x40, 0x20].map(|v| kajo_color::srgb::decode(f32::from(v) / 255.0));
    for from in [5.0, -5.0] {
        let found = seen(&slide, ray(-0.5, 0.5, from)).unwrap();
        let expected = [3.0 * texel[0], 2.0 * texel[1], texel[2]];
        assert!(std::iter::zip(found, expected).all(|(a, b)| (a - b).abs() < 1e-3), "{found:?} {expected:?}");
    }
    // Alpha of 1/4 on the left and 3/4 on the right.
    let veil = "\"baseColorTexture\":{\"index\":1},\"baseColorFactor\":[1,1,1,0.8]}";
    for (cover, expected) in [
        ("", [0.0, 0.0]),
        (",\"alphaMode\":\"BLEND\"", [0.8, 0.4]),
        (",\"alphaMode\":\"MASK\"", [1.0, 0.0]),
        (",\"alphaMode\":\"MASK\",\"alphaCutoff\":0.1", [0.0, 0.0]),
    ] {
        let scene = model(&format!("{veil}{cover}"));
        let found = [-0.5, 0.5].map(|x| scene.transmittance_in_air(&ray(x, 0.0, 5.0))[0]);
        assert!(std::iter::zip(found, expected).all(|(a, b)| (a - b).abs() < 1e-3), "{cover}: {found:?}");
    }
}

/// The share that many gauzes leave is their product, exactly.
#[test]
fn transmittance_is_the_product_of_all_opacities() {
    let passes = |gauzes: u32| {
        let gauze = |i: u32| format!("Quad {{ corner -1 -1 -{i}  edge1 2 0 0  edge2 0 2 0 }} ");
        lit("Matte emitter { opacity 0.5 }", &(0..gauzes).map(gauze).collect::<String>())
    };
    let down = Ray::new(Vec3::new(0.1, 0.2, 5.0), Vec3::NEG_Z);
    for gauzes in [1, 20, 40] {
        let left = passes(gauzes).transmittance_in_air(&down)[0];
        assert_eq!(left, 0.5f32.powi(gauzes as i32));
    }
}

/// The layers of models in the words of their extensions.
#[test]
fn models_are_of_glass_and_coat() {
    let down = Ray::new(Vec3::new(0.0, 0.0, 5.0), Vec3::NEG_Z);
    let look = |words: &str, u: f32| {
        let scene = model(&format!("\"roughnessFactor\":0.5}},\"extensions\":{{{words}}}"));
        let RayEvent::Surface(at) = scene.trace(&down) else { panic!("the triangle is met: {words}") };
        let interior = scene.interior(&at, &Wavelengths::RGB, u);
        (
            without_tables(scene.bsdf(&at, &Wavelengths::RGB, 1.0, u)),
            interior,
            scene.transmittance_in_air(&down)[0],
        )
    };
    let layers = |words: &str| match look(words, 0.5) {
        (Bsdf::Principled(layers), None, 0.0) => layers,
        other => panic!("{words}: {other:?}"),
    };
    let plain = layers("");
    assert_eq!((plain.base, plain.coat, plain.fuzz, plain.eta), (Base::Diffuse, 0.0, 0.0, 1.5));
    let coat = layers(r#""KHR_materials_clearcoat":{"clearcoatFactor":0.5,"clearcoatRoughnessFactor":0.2}"#);
    assert!(coat.coat == 0.5 && coat.coat_eta == 1.5 && (coat.coat_alpha - 0.04).abs() < 1e-6, "{coat:?}");
    let velvet =
        layers(r#""KHR_materials_sheen":{"sheenColorFactor":[0.5,0.25,0],"sheenRoughnessFactor":0.4}"#);
    assert_eq!(
        (velvet.fuzz, velvet.fuzz_color, velvet.fuzz_roughness),
        (0.5, Spectrum::rgb(1.0, 0.5, 0.0), 0.4)
    );
    let dull = layers(r#""KHR_materials_specular":{"specularFactor":0.25},"KHR_materials_ior":{"ior":1.3}"#);
    let white = Spectrum::rgb(1.0, 1.0, 1.0);
    assert_eq!(plain.specular, Specular::Factor(white));
    assert_eq!((dull.specular, dull.eta), (Specular::F0 { factor: white, largest: 1.0, weight: 0.25 }, 1.3));
    let bright = layers(r#""KHR_materials_specular":{"specularColorFactor":[4,1,0]}"#);
    let factor = Spectrum::rgb(4.0, 1.0, 0.0);
    assert_eq!(bright.specular, Specular::F0 { factor, largest: 4.0, weight: 1.0 });
    let brushed = layers(r#""KHR_materials_anisotropy":{"anisotropyStrength":0.5}"#);
    // Across 1/4, along 1/4 + 3/4 1/4.
    assert!((brushed.alpha - Vec2::new(0.4375, 0.25)).abs().max_element() < 1e-5, "{:?}", brushed.alpha);

    // Without a volume glass is a pane: light goes straight on, and nothing is inside.
    let clear = "\"KHR_materials_transmission\":{\"transmissionFactor\":0.75}";
    let (pane, interior, _) = look(clear, 0.5);
    let is_frosted = |pane: &ThinDielectric| pane.eta == 1.5 && pane.microfacets.alpha_x == 0.25;
    assert!(matches!(pane, Bsdf::ThinDielectric(pane) if is_frosted(&pane)), "{pane:?}");
    assert!(interior.is_none());
    assert!(matches!(look(clear, 0.9).0, Bsdf::Principled(layers) if layers.base == Base::Diffuse));
    let volume = r#""KHR_materials_volume":{"thicknessFactor":1,"attenuationDistance":1,"attenuationColor":[1,0.5,1]}"#;
    let (body, interior, _) = look(&format!("{clear},{volume}"), 0.5);
    assert!(matches!(body, Bsdf::Principled(layers) if layers.base == Base::Glass), "{body:?}");
    let [r, g, b] = interior.unwrap().absorption.to_rgb();
    assert!(r == 0.0 && (g - 2f32.ln()).abs() < 1e-4 && b == 0.0, "{r} {g} {b}");
}

/// Wavelengths are drawn where lights have lines, wherever their spectra are written.
#[test]
fn lines_of_lights_are_found() {
    let near_sodium = |materials: &str, rest: &str| {
        let text = format!(
            "PerspectiveCamera {{ center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30 }} {rest}
             Materials {{ {materials} Matte plain {{}} }}
             Group {{ MaterialIndex 0 Sphere {{ center 0 0 0 radius 1 }} }}"
        );
        let (scene, said) = read(&text);
        let choice = scene.unwrap_or_else(|| panic!("{said:?}")).wavelength_choice();
        let drawn = |i: u32| choice.sample((i as f32 + 0.5) / 1000.0).nm().unwrap();
        let near = |nm: &f32| (584.0..595.0).contains(nm);
        (0..1000).flat_map(drawn).filter(near).count() as f64 / 4000.0
    };
    let dark = "Background { color 0 0 0 }";
    let without = near_sodium("Matte emitter { emission 5 }", dark);
    assert!((0.02..0.06).contains(&without), "{without}");
    for (materials, rest) in [
        ("Matte emitter { emission sodium 5 }", dark),
        ("Matte emitter { emission slide.ppm { light sodium 5 } }", dark),
        ("Noise n { materialIndex a materialIndex plain } Matte a { emission sodium 5 }", dark),
        ("Matte dark {}", "Background { color sodium 0.5 }"),
        (
            "Matte dark {}",
            "Background { color 0 0 0 } Lights { PointLight { position 0 5 0 intensity sodium 5 } }",
        ),
        (
            "Matte dark {}",
            "Background { color 0 0 0 } Lights { SpotLight { position 0 5 0 direction 0 -1 0 angle 30 intensity sodium 5 } }",
        ),
        (
            "Matte dark {}",
            "Background { color 0 0 0 } Lights { DirectionalLight { direction 0 -1 0 irradiance sodium 5 } }",
        ),
    ] {
        let found = near_sodium(materials, rest);
        assert!(found > 0.85, "{materials} {rest}: {found}");
    }
    // Of two lights each has its part: here the other one is as strong.
    let other = "Background { color 5 5 5 }";
    let half = near_sodium("Matte emitter { emission sodium 5 }", other);
    assert!((0.2..0.8).contains(&half), "{half}");
}

/// Of a mesh on which a picture is black here and there the bright triangles are the strong lights.
#[test]
fn pieces_are_as_strong_as_what_is_on_them() {
    // A strip of twelve squares; the picture is white from 1/4 to 1/2.
    let mut obj = String::new();
    for i in 0..=12 {
        let x = f64::from(i);
        obj += &format!("v {x} 0 0\nv {x} 1 0\nvt {} 0\nvt {} 1\n", x / 12.0, x / 12.0);
    }
    for i in 0..12 {
        let a = 2 * i + 1;
        obj += &format!("f {a}/{a} {0}/{0} {1}/{1}\nf {a}/{a} {1}/{1} {2}/{2}\n", a + 2, a + 3, a + 1);
    }
    let assets = MemoryAssets::new().with("strip.obj", obj).with("bar.pgm", "P2 4 1 255 0 255 0 0\n");
    let text = "PerspectiveCamera { center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30 }
        Materials { Matte m { emission bar.pgm 8 { filter nearest } } }
        Group { MaterialIndex m TriangleMesh { file strip.obj } }";
    let mut parsed = SceneDesc::parse_str(text);
    let mut diagnostics = parsed.diagnostics;
    let scene = compile(&mut parsed.desc, &assets, &CompileOptions::default(), &mut diagnostics);
    let scene = scene.unwrap_or_else(|| panic!("{diagnostics:?}"));
    let light = |part: u32| scene.lighting.lights.areas[part as usize].emission.luminance();
    assert_eq!(scene.lighting.lights.areas.len(), 24);
    // The mean is 2: a tenth of it is left to the dark ones.
    for part in 0..24 {
        let expected = if (6..12).contains(&part) { 0.9 * 8.0 + 0.2 } else { 0.2 };
        assert!((light(part) - expected).abs() < 1e-3, "{part}: {} {expected}", light(part));
    }
}

#[test]
fn parts_of_a_mixture_shine_alike() {
    let scene = |second: &str| {
        read(&format!(
            "PerspectiveCamera {{ center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30 }}
             Materials {{ Matte a {{ emission 1 }} Matte b {{ emission 2 {second} }} Mix m {{ materialIndex a materialIndex b }} }}
             Group {{ MaterialIndex m Sphere {{ center 0 0 0 radius 1 }} }}"
        ))
    };
    let (even, said) = scene("");
    assert!(said.is_empty(), "{said:?}");
    assert_eq!(even.unwrap().lighting.lights.areas[0].emission.rgb(), [1.5; 3]);
    assert_eq!(
        scene("emits front").1,
        ["the parts of a mixture shine from the same sides and in the same group"]
    );
}
