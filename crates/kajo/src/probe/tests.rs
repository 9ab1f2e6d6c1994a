use std::path::{Path, PathBuf};

use kajo_core::light::LightChoice;
use kajo_core::sampler::SamplerKind;
use kajo_core::settings::{IntegratorName, PhotonMapUse, Settings, Shadows, Technique};
use kajo_math::DVec3;
use kajo_math::rng::Stream;

use super::*;
use crate::{
    Defaults, Format, LoadOptions, MemoryAssets, RenderRequest, Silent, View, load, load_from, render,
};

fn scene(text: &str) -> Scene {
    let loaded = load_from("a.txt", &MemoryAssets::new().with("a.txt", text), &LoadOptions::default());
    assert!(loaded.scene.is_some(), "{}", loaded.report(false));
    loaded.scene.unwrap()
}

/// Everything that rays do: mirrors, glass in glass, fog, lights of all kinds, transparent shadows, textures.
fn rich() -> Scene {
    scene(
        "PerspectiveCamera { center 0 1.5 9 direction 0 -0.1 -1 up 0 1 0 angle 35 }
         Lights { PointLight { position 2 5 3 color 0.8 0.8 0.7 }
                  SpotLight { position -3 5 2 direction 0.5 -1 -0.5 color 1 0.5 0.5 angle 60 }
                  DirectionalLight { direction -1 -1 -1 color 0.4 0.4 0.5 } }
         Background { color 0.2 0.3 0.5 ambientLight 0.1 0.1 0.1 }
         Fog { color 0.5 0.5 0.6 density 0.02 }
         Materials {
           Material floor { diffuseColor 0.7 0.7 0.6 reflectiveColor 0.2 0.2 0.2 }
           Material mirror { reflectiveColor 0.9 0.9 0.8 diffuseColor 0.1 0.1 0.1 }
           Material glass { transparentColor 0.9 0.95 0.9 reflectiveColor 0.1 0.1 0.1 indexOfRefraction 1.5 }
           Glass crystal { indexOfRefraction 1.5 }
           Matte emitter { color 0 0 0 emission 4 4 3 }
         }
         Group {
           MaterialIndex floor Plane { normal 0 1 0 offset -1 }
           MaterialIndex mirror Sphere { center -1.5 0 0 radius 1 }
           MaterialIndex glass Sphere { center 1.2 0 1 radius 0.9 }
           MaterialIndex crystal Sphere { center 0 -0.4 3 radius 0.5 }
           MaterialIndex emitter Quad { corner -1 3 -1 edge1 2 0 0 edge2 0 0 2 }
         }",
    )
}

fn settings(scene: &Scene, asked: Settings) -> RenderSettings {
    let asked = Settings { size: Some([120, 80]), samples: Some((SamplerKind::Sobol, 4)), ..asked };
    RenderSettings::resolve(scene, &asked, Defaults::Modern, false).unwrap()
}

/// Each integrator and each of its ways to follow light.
fn ways() -> Vec<Settings> {
    let of = |name| Settings { integrator: Some(IntegratorName(name)), ..Settings::default() };
    vec![
        Settings { bounces: Some(4), ..of("classic") },
        Settings {
            bounces: Some(6),
            shadows: Some(Shadows::Transparent),
            fresnel: Some(true),
            ..of("classic")
        },
        Settings { shadows: Some(Shadows::Off), shade_back: Some(true), ..of("classic") },
        of("path"),
        Settings { technique: Some(Technique::Lights), ..of("path") },
        Settings { technique: Some(Technique::Scattering), ..of("path") },
        Settings { spectral: Some(true), ..of("path") },
        of("direct"),
        Settings { branches: Some(5), bounces: Some(2), ..of("distribution") },
        Settings { reach: Some(2.0), ..of("occlusion") },
        of("bidirectional"),
        Settings { spectral: Some(true), ..of("bidirectional") },
        of("light"),
        of("mlt"),
        of("mmlt"),
        Settings { merging: Some(false), ..of("vcm") },
    ]
    .into_iter()
    .chain(prepared())
    .collect()
}

/// The ways that prepare what samples share.
fn prepared() -> Vec<Settings> {
    let of = |name| {
        let (integrator, photons) = (Some(IntegratorName(name)), Some(3000));
        Settings { integrator, photons, ..Settings::default() }
    };
    vec![
        Settings { light_choice: Some(LightChoice::Learned), photons: None, ..of("path") },
        Settings { rays: Some(64), accuracy: Some(0.5), photons: None, ..of("irradiance") },
        of("photon"),
        Settings { photon_map: Some(PhotonMapUse::Caustics), ..of("photon") },
        of("sppm"),
        of("vcm"),
    ]
}

#[test]
fn contributions_add_up_to_the_sample() {
    let scene = rich();
    let camera = CameraPose::of(&scene);
    for asked in ways() {
        let settings = settings(&scene, asked);
        let integrator =
            render::integrator(&scene, &scene.output.camera, &settings, LayerSet::of(&[Layer::Color]));
        let mut states = States::new(&*integrator);
        let rays = DebugRays::new(&scene, &settings, &camera);
        let mut shooter = rays.shooter();
        let sampler = settings.sampler();
        let (mut lit, mut kinds) = (0, Vec::new());
        for i in 0..400 {
            let s = Stream::new(5, [i, 0], 0);
            let place = DVec2::new(120.0 * f64::from(s.uniform(0)), 80.0 * f64::from(s.uniform(1)));
            let index = i / 100;
            let debug = shooter.shoot(place, index, &Resources::default(), &Silent).unwrap();
            let setup = render::schedule(&settings, &Resources::default());
            let with_state = states.at(index, &setup.setup(&Silent), &mut RayCounters::default()).unwrap();
            let integrator =
                with_state.filter(|_| !settings.integrator.name.0.ends_with("mlt")).unwrap_or(&*integrator);
            let mut ctx = SampleContext::new(&sampler, settings.seed);
            let pixel = [place.x as u32, place.y as u32];
            ctx.begin(pixel, index);
            let sample = integrator.sample(&mut ctx, pixel, place.as_vec2());
            assert_eq!(
                (debug.radiance, debug.rays),
                (sample.radiance, ctx.rays),
                "{:?}",
                settings.integrator
            );
            let sum = debug.segments.iter().fold([0.0f64; 3], |sum, segment| {
                [0, 1, 2].map(|c| sum[c] + f64::from(segment.contribution[c]))
            });
            for (sum, radiance) in sum.iter().zip(debug.radiance) {
                let scale = 1.0 + radiance.abs();
                assert!((*sum as f32 - radiance).abs() < 2e-6 * scale, "{settings:?}: {sum} for {radiance}");
            }
            lit += usize::from(debug.radiance != [0.0; 3]);
            kinds.extend(debug.segments.iter().map(|segment| segment.kind));
        }
        assert!(lit > 100, "{settings:?}: {lit}");
        let expected = match settings.integrator.name.0 {
            "occlusion" => vec![RayKind::Camera, RayKind::Shadow],
            "classic" => {
                vec![RayKind::Camera, RayKind::Shadow, RayKind::Reflected, RayKind::Transmitted]
            }
            // Matt surfaces take from maps and caches.
            "photon" | "sppm" | "irradiance" => {
                vec![RayKind::Camera, RayKind::Reflected, RayKind::Transmitted]
            }
            _ => vec![RayKind::Camera, RayKind::Reflected, RayKind::Transmitted, RayKind::Scattered],
        };
        let from_lights = match settings.integrator.name.0 {
            "bidirectional" => vec![RayKind::Light, RayKind::Connection, RayKind::Splat],
            "light" => vec![RayKind::Light, RayKind::Splat],
            _ => vec![],
        };
        assert!(expected.iter().chain(&from_lights).all(|kind| kinds.contains(kind)), "{settings:?}");
    }
}

/// Every segment starts where the one before it ends, and ends on the surface that it says it met.
#[test]
fn segments_hang_together() {
    let scene = rich();
    let camera = CameraPose::of(&scene);
    for asked in ways() {
        let settings = settings(&scene, asked);
        let rays = DebugRays::new(&scene, &settings, &camera);
        let mut shooter = rays.shooter();
        for i in 0..60 {
            let place = DVec2::new(2.0 * f64::from(i) + 0.5, 20.0 + f64::from(i % 50));
            let debug = shooter.shoot(place, 0, &Resources::default(), &Silent).unwrap();
            let cast = debug.segments.iter().filter(|segment| segment.kind == RayKind::Camera).count();
            assert!(debug.rays.camera == 1 && debug.left_out == 0 && cast == 1);
            for (index, segment) in debug.segments.iter().enumerate() {
                let end = segment.from + segment.distance * segment.d;
                if let Some(hit) = segment.hit {
                    assert!(end.distance(hit.p) < 1e-4 * (1.0 + segment.distance), "{segment:?}");
                    assert!((1..=5).contains(&hit.object) && (1..=5).contains(&hit.material));
                }
                let way = debug.way_to(index);
                assert_eq!((way.len() as u32, way.last()), (segment.depth + 1, Some(&index)));
                let Some(parent) = segment.parent else {
                    assert!(
                        segment.kind == RayKind::Camera || (segment.kind == RayKind::Light && index == 0)
                    );
                    assert_eq!(way[0], index);
                    let is_camera = segment.kind == RayKind::Camera;
                    assert!(
                        !is_camera || settings.values().spectral == Some(true) || segment.weight == [1.0; 3]
                    );
                    continue;
                };
                let before = &debug.segments[parent as usize];
                let start = before.hit.expect("rays go on from surfaces").p;
                assert!(segment.from.distance(start) < 1e-4, "{segment:?} after {before:?}");
                let ends = [RayKind::Shadow, RayKind::Connection, RayKind::Splat];
                assert!(!ends.contains(&before.kind) && (parent as usize) < index);
            }
        }
    }
}

#[test]
fn a_debug_ray_says_what_is_in_the_way_of_light() {
    let scene = scene(
        "PerspectiveCamera { center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30 }
         Lights { PointLight { position 0 8 8 color 1 1 1 } }
         Background { color 0.1 0.2 0.3 ambientLight 0 0 0 }
         Materials { Material { diffuseColor 1 1 1 } }
         Group { MaterialIndex 0  Sphere { center 0 0 0 radius 1 }  Sphere { center 0 4 4 radius 1 } }",
    );
    let settings = settings(&scene, Settings::default());
    let camera = CameraPose::of(&scene);
    let debug = debug_ray(&scene, &settings, &camera, DVec2::new(60.0, 38.0), 0).unwrap();
    let [first, shadow] = debug.segments[..] else { panic!("{debug:#?}") };
    assert_eq!((first.hit.map(|hit| hit.object), first.contribution), (Some(1), [0.0; 3]));
    assert_eq!((shadow.kind, shadow.parent, shadow.depth), (RayKind::Shadow, Some(0), 1));
    assert_eq!(shadow.hit.map(|hit| hit.object), Some(2));
    let sky = debug_ray(&scene, &settings, &camera, DVec2::new(1.0, 1.0), 0).unwrap();
    assert_eq!((sky.segments.len(), sky.segments[0].hit), (1, None));
    assert!(sky.segments[0].distance.is_infinite());
    assert_eq!(sky.segments[0].contribution, [0.1, 0.2, 0.3]);
}

fn gallery() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/gallery");
    let entries = std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path());
    let mut paths: Vec<_> = entries.filter(|path| path.extension().is_some_and(|e| e == "txt")).collect();
    paths.retain(|path| path.file_name().is_some_and(|name| name != "manifest.txt"));
    paths.sort();
    paths
}

/// What is picked at the middle of random pixels is what the id layers have there.
#[test]
fn picks_are_the_numbers_of_the_id_layers() {
    let mut checked = 0;
    for path in gallery() {
        let loaded = load(&path, &LoadOptions::default());
        let Some(scene) = &loaded.scene else { panic!("{}", loaded.report(false)) };
        // One sample in the middle; lenses and shutters would see something else beside it. Things that move nearly as fast as light are
        // picked where they are, which is not where they are seen.
        if scene.relativity.is_some()
            || scene.output.camera.has_lens()
            || scene.moves()
            || scene.output.camera.cells() != [1, 1]
        {
            continue;
        }
        let asked = Settings {
            size: Some([160, 120]),
            samples: Some((SamplerKind::Regular, 1)),
            bounces: Some(0),
            integrator: Some(IntegratorName("classic")),
            shadows: Some(Shadows::Off),
            ..Settings::default()
        };
        let settings = RenderSettings::resolve(scene, &asked, Defaults::Modern, false).unwrap();
        let outputs = [View::Object, View::Material, View::Depth].map(|view| (view, Format::Exr));
        let picture = render(&RenderRequest::new(scene, &settings, &outputs), &Silent).unwrap();
        let [objects, materials, depths] = [View::Object, View::Material, View::Depth]
            .map(|view| decoded(&picture.encode(&[view], Format::Exr, crate::BitDepth::Eight).unwrap()));
        let camera = CameraPose::of(scene);
        for i in 0..400 {
            let s = Stream::new(9, [i, checked], 0);
            let [x, y] = [(160.0 * s.uniform(0)) as u32, (120.0 * s.uniform(1)) as u32];
            let place = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
            let found = pick(scene, &camera, place, settings.size);
            let at = (y * 160 + x) as usize;
            let expected = (objects[at], materials[at], depths[at]);
            let found =
                found.map_or((0.0, 0.0, f32::INFINITY), |p| (p.object as f32, p.material as f32, p.t));
            assert_eq!(found, expected, "{} at {x}, {y}", path.display());
            checked += 1;
        }
    }
    assert!(checked >= 10_000, "{checked}");
}

/// The numbers of a file of one channel.
fn decoded(bytes: &[u8]) -> Vec<f32> {
    let image =
        kajo_image::decode(bytes, Some(Format::Exr), &kajo_image::DecodeLimits::default()).unwrap().image;
    image.pixels().map(|pixel| pixel[0]).collect()
}

#[test]
fn a_pick_knows_the_words_of_the_text() {
    let text = "PerspectiveCamera { center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30 }
        Materials { Material { diffuseColor 1 1 1 } }
        Group { Define twin { MaterialIndex 0  Sphere ball { center 0 0 0 radius 1 } }
                Instance twin { Translate 1 0 0 }  Instance twin { Translate -1 0 0 } }";
    let assets = MemoryAssets::new().with("a.txt", text);
    let loaded = load_from("a.txt", &assets, &LoadOptions::default());
    let scene = loaded.scene.as_ref().unwrap_or_else(|| panic!("{}", loaded.report(false)));
    let camera = CameraPose::of(scene);
    let size = [200, 200];
    let at =
        |x: f64| pick(scene, &camera, camera.project(DVec3::new(x, 0.0, 0.0), size).unwrap(), size).unwrap();
    let (right, left) = (at(1.0), at(-1.0));
    assert_eq!((right.object, left.object), (1, 2));
    assert_eq!(
        (right.keyword, right.name.as_deref(), right.described_by),
        ("Sphere", Some("ball"), left.described_by)
    );
    assert_ne!(right.placed_by, left.placed_by);
    let word = |item: u32| loaded.desc.item(item).unwrap().keyword();
    assert_eq!((word(right.described_by), word(right.placed_by)), ("Sphere", "Instance"));
    assert!(right.normal.distance(Vec3::Z) < 0.2 && (right.t - 8.0).abs() < 0.2);
    assert!(pick(scene, &camera, DVec2::new(1.0, 1.0), size).is_none());
}

/// Shadow rays know the light they are cast to: that of the file, the emissive object, the background.
#[test]
fn shadow_rays_know_their_light() {
    let text = |lights: &str, group: &str| {
        scene(&format!(
            "PerspectiveCamera {{ center 0 4 9 direction 0 -0.4 -1 up 0 1 0 angle 30 }}
             Lights {{ {lights} }}
             Background {{ color 0.4 0.4 0.4 }}
             Materials {{ Matte floor {{ color 0.7 0.7 0.7 }} Matte emitter {{ color 0 0 0 emission 9 9 9 }} }}
             Group {{ MaterialIndex floor Plane {{ normal 0 1 0 offset 0 }} {group} }}"
        ))
    };
    let lights =
        "DirectionalLight { direction 0 -1 0.1 color 1 1 1 } PointLight { position 0 3 0 color 1 1 1 }";
    let block = "Box { min -9 2 -9 max 9 2.2 9 }";
    let emissive = "MaterialIndex emitter Quad { corner -1 3 -1 edge1 2 0 0 edge2 0 0 2 }";
    let scene = text(lights, &format!("{block} {emissive}"));
    let camera = CameraPose::perspective(DVec3::new(0.0, 1.0, 6.0), DVec3::ZERO, DVec3::Y, 0.5);
    for asked in ways() {
        let settings = settings(&scene, asked);
        let rays = DebugRays::new(&scene, &settings, &camera);
        let mut shooter = rays.shooter();
        let mut found = Vec::new();
        for i in 0..64 {
            let s = Stream::new(6, [i, 0], 0);
            let place = DVec2::new(120.0 * f64::from(s.uniform(0)), 80.0 * f64::from(s.uniform(1)));
            let ray = shooter.shoot(place, i / 16, &Resources::default(), &Silent).unwrap();
            for segment in ray.segments {
                let is_to_light =
                    segment.kind == RayKind::Shadow && settings.integrator.name.0 != "occlusion";
                assert_eq!(segment.light.is_some(), is_to_light, "{segment:?}");
                if segment.contribution == [0.0; 3] && segment.from.y.abs() < 1e-3 && is_to_light {
                    let hit = segment.hit.map(|hit| hit.object);
                    assert!(hit == Some(2) || hit.is_none(), "the slab is in the way: {segment:?}");
                }
                found.extend(segment.light);
            }
        }
        if settings.values().shadows.is_some_and(|shadows| shadows != Shadows::Off) {
            for light in [LightSource::Listed(0), LightSource::Listed(1), LightSource::Object(3)] {
                assert!(found.contains(&light), "{light:?} of {found:?}");
            }
        }
        if settings.values().technique == Some(Technique::Lights) {
            for light in [LightSource::Listed(0), LightSource::Listed(1), LightSource::Background] {
                assert!(found.contains(&light), "{light:?} of {found:?}");
            }
        }
    }
}

/// The debug rays through the middles of all pixels are the picture, of integrators that prepare something too.
#[test]
fn debug_rays_are_the_samples_of_the_picture() {
    let scene = rich();
    let camera = CameraPose::of(&scene);
    // What lights send to other pixels is in no debug ray.
    for asked in prepared().into_iter().filter(|asked| asked.integrator != Some(IntegratorName("vcm"))) {
        let asked = Settings { size: Some([16, 12]), samples: Some((SamplerKind::Regular, 1)), ..asked };
        let settings = RenderSettings::resolve(&scene, &asked, Defaults::Modern, false).unwrap();
        let outputs = [(View::Color, Format::Exr)];
        let picture = render(&RenderRequest::new(&scene, &settings, &outputs), &Silent).unwrap();
        let bytes = picture.encode(&[View::Color], Format::Exr, crate::BitDepth::Eight).unwrap();
        let image = kajo_image::decode(&bytes, Some(Format::Exr), &kajo_image::DecodeLimits::default())
            .unwrap()
            .image;
        let rays = DebugRays::new(&scene, &settings, &camera);
        let mut shooter = rays.shooter();
        assert!(rays.need_state(), "{settings:?}");
        for (i, pixel) in image.pixels().enumerate() {
            let place = DVec2::new((i % 16) as f64 + 0.5, (i / 16) as f64 + 0.5);
            let ray = shooter.shoot(place, 0, &Resources::default(), &Silent).unwrap();
            for (shown, found) in pixel.iter().zip(ray.radiance) {
                assert!(
                    (shown - found).abs() <= 1e-5 + 1e-3 * found.abs(),
                    "{place} {pixel:?} {ray:?} {settings:?}"
                );
            }
        }
    }
}

/// Samples of a regular pattern are taken in another order than they are counted in; each is shown with the state that it is taken with.
#[test]
fn a_debug_ray_has_the_state_of_its_sample() {
    let scene = rich();
    let camera = CameraPose::of(&scene);
    let asked = Settings { samples: Some((SamplerKind::Regular, 9)), ..prepared()[4].clone() };
    let asked = Settings { size: Some([8, 6]), ..asked };
    let settings = RenderSettings::resolve(&scene, &asked, Defaults::Modern, false).unwrap();
    let picture =
        render(&RenderRequest::new(&scene, &settings, &[(View::Color, Format::Exr)]), &Silent).unwrap();
    let bytes = picture.encode(&[View::Color], Format::Exr, crate::BitDepth::Eight).unwrap();
    let image =
        kajo_image::decode(&bytes, Some(Format::Exr), &kajo_image::DecodeLimits::default()).unwrap().image;
    let rays = DebugRays::new(&scene, &settings, &camera);
    let mut shooter = rays.shooter();
    let mut sums = vec![[0.0f32; 3]; 48];
    for index in 0..9 {
        let offset = DVec2::new(f64::from(index % 3) + 0.5, f64::from(index / 3) + 0.5) / 3.0;
        for (i, sum) in sums.iter_mut().enumerate() {
            let place = DVec2::new((i % 8) as f64, (i / 8) as f64) + offset;
            let ray = shooter.shoot(place, index, &Resources::default(), &Silent).unwrap();
            *sum = [0, 1, 2].map(|c| sum[c] + ray.radiance[c] / 9.0);
        }
    }
    for (pixel, sum) in image.pixels().zip(sums) {
        assert!(
            pixel.iter().zip(sum).all(|(a, b)| (a - b).abs() <= 1e-5 + 2e-3 * b.abs()),
            "{pixel:?} {sum:?}"
        );
    }
}

/// A prober, and what it says when it wakes.
fn prober() -> (Prober, std::sync::mpsc::Receiver<()>) {
    let (woken, wakes) = std::sync::mpsc::channel();
    let woken = std::sync::Mutex::new(woken);
    let wake = move || {
        let _ = woken.lock().unwrap().send(());
    };
    (Prober::new(2, wake, || ()), wakes)
}

fn subject(scene: &std::sync::Arc<Scene>, asked: Settings) -> std::sync::Arc<ProbeSubject> {
    let settings = settings(scene, asked);
    let (scene, camera) = (std::sync::Arc::clone(scene), CameraPose::of(scene));
    std::sync::Arc::new(ProbeSubject { scene, settings, camera })
}

/// Waits for a ray; returns it and how often the prober woke.
fn wait(prober: &Prober, wakes: &std::sync::mpsc::Receiver<()>) -> (Result<DebugRay, SetupError>, u32) {
    for n in 1.. {
        wakes.recv().unwrap();
        if let Some(result) = prober.take() {
            return (result, n);
        }
    }
    unreachable!()
}

#[test]
fn a_prober_prepares_once_for_all_rays_of_a_subject() {
    let scene = std::sync::Arc::new(rich());
    let (prober, wakes) = prober();
    assert!(prober.progress().is_none() && prober.take().is_none());
    let of = subject(&scene, prepared()[2].clone());
    let mut heard = 0;
    let heard: Vec<u32> = (0..12)
        .map(|i| {
            let place = DVec2::new(60.0 - 4.0 * f64::from(i), 50.0 + f64::from(i));
            prober.shoot(&of, place, 0);
            let (ray, n) = wait(&prober, &wakes);
            assert!(prober.progress().is_none());
            heard += n + wakes.try_iter().count() as u32;
            let alone = (i < 2).then(|| debug_ray(&scene, &of.settings, &of.camera, place, 0).unwrap());
            assert!(alone.is_none_or(|alone| ray.unwrap() == alone));
            heard
        })
        .collect();
    // Once for each of ten results, which may be taken before that is heard; what prepares again says so as well.
    let later = heard[11] - heard[1];
    assert!((9..=11).contains(&later), "later rays have something to wait for: {heard:?}");
}

#[test]
fn a_prober_drops_what_nobody_wants_any_more() {
    let scene = std::sync::Arc::new(rich());
    let (prober, wakes) = prober();
    let slow = subject(&scene, Settings { photons: Some(1 << 24), ..prepared()[2].clone() });
    let quick = subject(&scene, prepared()[2].clone());
    let place = DVec2::new(60.0, 50.0);
    for _ in 0..2 {
        prober.shoot(&slow, place, 0);
        assert!(prober.progress().is_some());
        wakes.recv().unwrap();
        assert!(prober.progress().is_some());
        prober.shoot(&quick, place, 0);
        assert!(wait(&prober, &wakes).0.is_ok());
    }
    prober.shoot(&slow, place, 0);
    prober.forget();
    assert!(prober.progress().is_none() && prober.take().is_none());
    prober.shoot(&quick, place, 0);
    assert!(wait(&prober, &wakes).0.is_ok());
    // A subject that is wanted again before its preparation has ended for another one.
    let again = subject(&scene, Settings { photons: Some(1 << 18), ..prepared()[2].clone() });
    prober.shoot(&again, place, 0);
    wakes.recv().unwrap();
    prober.shoot(&quick, place, 0);
    prober.shoot(&again, place, 0);
    assert!(wait(&prober, &wakes).0.is_ok());
    // Nor does anybody wait for it at the end.
    prober.shoot(&slow, place, 0);
    drop(prober);
}
