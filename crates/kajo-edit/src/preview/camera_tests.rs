//! Every camera: what the preview draws at a pixel is what is picked there, what a debug ray meets and where handles are.

use kajo_core::sampler::SamplerKind;
use kajo_core::settings::Settings;
use kajo_math::rng::Stream;
use kajo_math::{DVec2, DVec3, DVec4};

use super::tests::triangles;
use super::*;
use kajo::probe::{debug_ray, pick};
use kajo::{CameraPose, Defaults, LoadOptions, MemoryAssets, RenderSettings, load_from, suitable_size};

/// Things on all sides of the origin, on a plane.
const WORLD: &str = "
Materials { Material { diffuseColor 0.8 0.2 0.2 } }
Group {
  MaterialIndex 0
  Plane { normal 0.1 1 0  offset -2 }
  Sphere { center 0 0.5 -4  radius 1.5 }
  Box { min 2 -1 -6  max 3 4 -2 }
  Box { min -5 -1 -5  max -3 0.5 -3 }
  Box { min -1.5 -1 3  max 1 2 4 }
  Transform { YRotate 30  Box { min 4 -1 1  max 5 1 2 } }
  Triangle { vertex0 -4 3 2  vertex1 -4 -1 3  vertex2 -3 3 -1 }
  Quad { corner -2 5 -2  edge1 4 0 0  edge2 0 0 4 }
}
";

const BASIS: &str = "center 0.2 0.4 0.1  direction 0.2 -0.15 -1  up 0.1 1 0";

fn cameras() -> Vec<String> {
    let of = |keyword: &str, keys: &str| format!("{keyword} {{ {BASIS}  {keys} }}");
    let mut cameras = vec![
        of("PerspectiveCamera", "angle 60"),
        of("PerspectiveCamera", "angle 130"),
        of("PerspectiveCamera", "angle 250"),
        of("PerspectiveCamera", "angle 70  aperture 0.3  focus 4"),
        of("PerspectiveCamera", "angle 70  Motion { key 0 { Translate 0 1 2 } key 1 { YRotate 50 } }"),
        of("PerspectiveCamera", "angle 70") + " Settings { dialect mit-a2 }",
        of("OrthographicCamera", "size 9"),
        of("OrthographicCamera", "size -9"),
        of("OrthographicCamera", "size 9  aperture 0.3  focus 4"),
        of("OrthographicCamera", "size 9") + " Settings { dialect mit-a2 }",
        of("PanoramaCamera", ""),
        of("PanoramaCamera", "stereo omnidirectional  eyeSeparation 0.3"),
        of("StereoCubemapCamera", "stereo twin  eyeSeparation 0.3"),
        of("StereoCubemapCamera", "stereo omnidirectional  eyeSeparation 0.3"),
    ];
    for projection in ["equidistant", "equisolid", "orthographic", "stereographic"] {
        for fit in ["height", "corners"] {
            let angle = if projection == "orthographic" { 170 } else { 260 };
            cameras.push(of("FisheyeCamera", &format!("projection {projection}  fit {fit}  angle {angle}")));
        }
    }
    cameras
}

/// The object that a graphics card draws at a place of the picture.
///
/// * `triangles`: in clip space
fn rasterised(triangles: &[([DVec4; 3], u32)], place: DVec2, size: [u32; 2]) -> u32 {
    let ndc = DVec2::new(2.0 * place.x / f64::from(size[0]) - 1.0, 1.0 - 2.0 * place.y / f64::from(size[1]));
    let (mut nearest, mut object) = (1.0, 0);
    for (clip, number) in triangles {
        // The corners' shares of the point of the triangle that appears there.
        let x = DVec3::from_array(clip.map(|p| p.x - ndc.x * p.w));
        let y = DVec3::from_array(clip.map(|p| p.y - ndc.y * p.w));
        let shares = x.cross(y);
        let shares = shares / shares.element_sum();
        if !shares.is_finite() || shares.min_element() < 0.0 {
            continue;
        }
        let p: DVec4 = clip.iter().zip(shares.to_array()).map(|(p, share)| *p * share).sum();
        let depth = p.z / p.w;
        if p.w > 0.0 && (0.0..nearest).contains(&depth) {
            (nearest, object) = (depth, *number);
        }
    }
    object
}

/// Whether a pixel lies at the edge of an object, whose triangles are not quite as round as it is.
fn is_edge(scene: &Scene, pose: &CameraPose, place: DVec2, size: [u32; 2]) -> bool {
    let at = |x: f64, y: f64| pick(scene, pose, place + DVec2::new(x, y), size).map(|seen| seen.object);
    let here = at(0.0, 0.0);
    [(-1.0, 0.0), (1.0, 0.0), (0.0, -1.0), (0.0, 1.0)].into_iter().any(|(x, y)| at(x, y) != here)
}

#[test]
fn the_object_under_a_thousand_pixels_is_the_one_drawn_there() {
    for camera in cameras() {
        let assets = MemoryAssets::new().with("a.txt", format!("{camera} {WORLD}"));
        let loaded = load_from("a.txt", &assets, &LoadOptions::default());
        let scene = loaded.scene.unwrap_or_else(|| panic!("{camera}: no scene"));
        let pose = CameraPose::of(&scene);
        let size = suitable_size(&scene.output.camera, [480, 320]);
        let asked =
            Settings { size: Some(size), samples: Some((SamplerKind::Regular, 1)), ..Settings::default() };
        let settings = RenderSettings::resolve(&scene, &asked, Defaults::Modern, false).unwrap();
        let preview = Preview::of(&scene);
        let [near, far] = pose.depths(&preview.bounds);
        let drawn = pose.projection(size, near, far).map(|matrix| {
            let matrix = matrix.as_mat4().as_dmat4();
            let in_clip_space = |corners: [Vec3; 3]| corners.map(|p| matrix * p.as_dvec3().extend(1.0));
            let all = triangles(&preview).into_iter();
            all.map(|(corners, object)| (in_clip_space(corners), object)).collect::<Vec<_>>()
        });
        let traced = TracedPreview::of(&scene, &pose, size, size, [0; 3], || true).unwrap();
        let is_pinhole = !scene.output.camera.has_lens() && !scene.output.camera.moves();
        let (mut edges, mut things) = (0, std::collections::BTreeSet::new());
        for i in 0..1000 {
            let s = Stream::new(21, [i, 0], 0);
            let pixel = [0, 1].map(|k| (f64::from(s.uniform(k)) * f64::from(size[k as usize])).floor());
            let place = DVec2::from_array(pixel) + 0.5;
            let seen = pick(&scene, &pose, place, size);
            let object = seen.as_ref().map_or(0, |seen| seen.object);
            assert_eq!(traced.object(place), object, "{camera}: traced at {place}");
            if let Some(triangles) = &drawn {
                if is_edge(&scene, &pose, place, size) {
                    edges += 1;
                    continue;
                }
                assert_eq!(rasterised(triangles, place, size), object, "{camera}: at {place}");
            }
            things.insert(object);
            let Some(seen) = seen else { continue };
            // A handle there would be here.
            let places = pose.projections(seen.point.as_dvec3(), size).into_iter().flatten();
            let nearest = places.map(|found| found.distance(place)).fold(f64::INFINITY, f64::min);
            assert!(nearest < 0.05, "{camera}: {} is {nearest} from {place}", seen.point);
            if is_pinhole {
                let ray = debug_ray(&scene, &settings, &pose, place, 0).unwrap();
                assert_eq!(
                    ray.segments[0].hit.map(|hit| hit.object),
                    Some(object),
                    "{camera}: ray at {place}"
                );
            }
        }
        assert!(edges < 250, "{camera}: {edges} edges");
        assert!(things.len() >= 4, "{camera}: {things:?}");
    }
}

/// Squares of a hundred balls each, on three sides of the origin: more than the preview draws one by one.
fn nested_world() -> String {
    let balls = |i: u32| format!("Sphere {{ center {} {} 0 radius 0.3 }}\n", i % 10, i / 10);
    let square: String = (0..100).map(balls).collect();
    let place = |i: u32| {
        let turn = [0, 90, 200][(i % 3) as usize];
        format!("Instance square {{ YRotate {turn} Translate -5 -5 {} }}\n", -6.0 - 0.3 * f64::from(i / 3))
    };
    let places: String = (0..400).map(place).collect();
    format!(
        "Materials {{ Matte {{ }} }} Group {{ MaterialIndex 0 Box {{ min 2 -1 -5 max 3 1 -4 }}
         Define square {{ {square} }} {places} }}"
    )
}

#[test]
fn what_rays_show_of_nested_instances_is_picked_there_through_every_camera() {
    let world = nested_world();
    for camera in cameras() {
        let assets = MemoryAssets::new().with("a.txt", format!("{camera} {world}"));
        let mut options = LoadOptions::default();
        options.limits.objects = 4_000;
        let loaded = load_from("a.txt", &assets, &options);
        let scene = loaded.scene.unwrap_or_else(|| panic!("{camera}: no scene"));
        assert!(Preview::of(&scene).has_boxes && scene.geometry.primitives.len() == 1);
        let pose = CameraPose::of(&scene);
        let size = suitable_size(&scene.output.camera, [240, 160]);
        let asked =
            Settings { size: Some(size), samples: Some((SamplerKind::Regular, 1)), ..Settings::default() };
        let settings = RenderSettings::resolve(&scene, &asked, Defaults::Modern, false).unwrap();
        let traced = TracedPreview::of(&scene, &pose, size, size, [0; 3], || true).unwrap();
        let is_pinhole = !scene.output.camera.has_lens() && !scene.output.camera.moves();
        let mut things = std::collections::BTreeSet::new();
        for i in 0..1000 {
            let s = Stream::new(22, [i, 0], 0);
            let pixel = [0, 1].map(|k| (f64::from(s.uniform(k)) * f64::from(size[k as usize])).floor());
            let place = DVec2::from_array(pixel) + 0.5;
            let seen = pick(&scene, &pose, place, size);
            assert_eq!(
                traced.object(place),
                seen.as_ref().map_or(0, |seen| seen.object),
                "{camera}: at {place}"
            );
            let Some(seen) = seen else { continue };
            things.insert(seen.object);
            let ray = pose.ray(place, size).unwrap();
            let distance = (seen.point - ray.o).dot(ray.d);
            assert!(
                (traced.distance(place) - distance).abs() < 1e-3 * distance.abs() + 1e-4,
                "{camera}: at {place}"
            );
            let places = pose.projections(seen.point.as_dvec3(), size).into_iter().flatten();
            let nearest = places.map(|found| found.distance(place)).fold(f64::INFINITY, f64::min);
            assert!(nearest < 0.05, "{camera}: {} is {nearest} from {place}", seen.point);
            if is_pinhole {
                let ray = debug_ray(&scene, &settings, &pose, place, 0).unwrap();
                let hit = ray.segments[0].hit.map(|hit| hit.object);
                assert_eq!(hit, Some(seen.object), "{camera}: ray at {place}");
            }
        }
        assert!(things.len() >= 20, "{camera}: {things:?}");
    }
}

#[test]
fn a_place_is_the_same_in_a_picture_of_another_shape() {
    for camera in cameras() {
        let assets = MemoryAssets::new().with("a.txt", format!("{camera} {WORLD}"));
        let scene = load_from("a.txt", &assets, &LoadOptions::default()).scene.unwrap();
        let pose = CameraPose::of(&scene);
        let [of, to] = [[480, 320], [480, 250]].map(|size| suitable_size(&scene.output.camera, size));
        let place = 0.4 * DVec2::new(of[0].into(), of[1].into());
        let there = pose.position_in(place, of, to);
        let [a, b] = [pose.ray(place, of).unwrap(), pose.ray(there, to).unwrap()];
        assert!(a.d.distance(b.d) < 1e-3, "{camera}: {there}: {} {}", a.d, b.d);
        let share = there / DVec2::new(to[0].into(), to[1].into());
        assert!((share.y - 0.4).abs() < 1e-3 || camera.contains("corners"), "{camera}: {share}");
        assert!(pose.position_in(there, to, of).distance(place) < 0.05, "{camera}");
    }
}
