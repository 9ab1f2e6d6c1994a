use kajo_color::Spectrum;
use kajo_math::{Ray, Vec2, Vec3};
use kajo_scene::{MemoryAssets, Severity};

use super::*;
use crate::bsdf::tests::without_tables;
use crate::bsdf::{Base, Bsdf, Dielectric, ThinDielectric};
use crate::camera::Camera;
use crate::ids::ObjectId;
use crate::scene::RayEvent;
use crate::settings::Technique;

pub(super) const CAMERA: &str = "PerspectiveCamera { center 0 0 10 direction 0 0 -1 up 0 1 0 angle 30 }\n";
pub(super) const RED: &str =
    "Materials { Material red { diffuseColor 1 0 0 } Material { diffuseColor 0 1 0 } }\n";

/// The scene of a text, and everything said about it.
pub(super) fn compiled(text: &str) -> (Option<Scene>, Vec<(Severity, String)>) {
    compiled_as(text, None)
}

fn compiled_as(text: &str, dialect: Option<Dialect>) -> (Option<Scene>, Vec<(Severity, String)>) {
    let mut parsed = SceneDesc::parse_str(text);
    let mut diagnostics = parsed.diagnostics;
    let options = CompileOptions { dialect, ..CompileOptions::default() };
    let scene = compile(&mut parsed.desc, &MemoryAssets::new(), &options, &mut diagnostics);
    let said = diagnostics.iter().map(|d| (d.severity, d.message.clone())).collect();
    (scene, said)
}

pub(super) fn scene(text: &str) -> Scene {
    let (scene, said) = compiled(text);
    scene.unwrap_or_else(|| panic!("{text}\n{said:?}"))
}

/// The first error about a group in front of a usual camera.
pub(super) fn error_in_group(group: &str) -> String {
    let (scene, said) = compiled(&format!("{CAMERA}{RED}Group {{ {group} }}"));
    assert!(scene.is_none(), "accepted: {group}");
    said.into_iter().find(|(severity, _)| *severity == Severity::Error).expect("an error").1
}

/// What a ray down the z axis from (x, y) meets first.
pub(super) fn look(scene: &Scene, x: f32, y: f32) -> Option<(Vec3, Vec3, [f32; 3])> {
    let ray = Ray::new(Vec3::new(x, y, 10.0), Vec3::NEG_Z);
    match scene.trace(&ray) {
        RayEvent::Escaped => None,
        RayEvent::Surface(at) => {
            let phong = scene.appearance.phong(at.material, &scene.texture_context(&at));
            Some((at.point.p, at.point.n, phong.diffuse.to_rgb()))
        }
    }
}

#[test]
fn material_index_runs_through_the_whole_file() {
    let s = scene(&format!(
        "{CAMERA}{RED}Group {{ MaterialIndex 1 Sphere {{ center 0 0 0 radius 1 }}
         Group {{ MaterialIndex red Sphere {{ center 3 0 0 radius 1 }} }} Sphere {{ center 6 0 0 radius 1 }} }}"
    ));
    assert_eq!(look(&s, 0.0, 0.0).unwrap().2, [0.0, 1.0, 0.0]);
    assert_eq!(look(&s, 3.0, 0.0).unwrap().2, [1.0, 0.0, 0.0]);
    assert_eq!(look(&s, 6.0, 0.0).unwrap().2, [1.0, 0.0, 0.0], "set in a nested group, in force after it");
    let numbers: Vec<u32> = s.geometry.primitives.iter().map(|p| s.appearance.number(p.material)).collect();
    assert_eq!(numbers, [2, 1, 1]);
}

#[test]
fn the_first_of_two_equal_objects_wins() {
    for n in [2, 9] {
        let others = "MaterialIndex 1 Sphere { center 0 0 0 radius 1 } ".repeat(n);
        let planes = "Plane { normal 0 0 1 offset 1 } ".repeat(n);
        let s = scene(&format!(
            "{CAMERA}{RED}Group {{ MaterialIndex 0 Sphere {{ center 0 0 0 radius 1 }} {others} {planes} }}"
        ));
        assert_eq!(look(&s, 0.0, 0.0).unwrap().2, [1.0, 0.0, 0.0]);
    }
}

#[test]
fn later_operations_act_first_and_matrices_from_the_left() {
    let at = |ops: &str| {
        let s = scene(&format!(
            "{CAMERA}{RED}Group {{ MaterialIndex 0 Transform {{ {ops} Sphere {{ center 1 0 0 radius 0.1 }} }} }}"
        ));
        s.geometry.bounds().center()
    };
    let near = |a: Vec3, b: Vec3| assert!(a.distance(b) < 1e-4, "{a} {b}");
    near(at("Translate 5 0 0 Scale 2 2 2"), Vec3::new(7.0, 0.0, 0.0));
    near(at("Scale 2 2 2 Translate 5 0 0"), Vec3::new(12.0, 0.0, 0.0));
    near(at("ZRotate 90 Translate 1 0 0"), Vec3::new(0.0, 2.0, 0.0));
    near(at("YRotate 90"), Vec3::new(0.0, 0.0, -1.0));
    near(at("XRotate 90 Translate 0 1 0"), Vec3::new(1.0, 0.0, 1.0));
    near(at("Rotate { 0 0 1 90 }"), Vec3::Y);
    // Column by column: the last quadruple is the translation.
    let moves = "Matrix { 1 0 0 0  0 1 0 0  0 0 1 0  3 0 0 1 }";
    near(at(&format!("UniformScale 2 {moves}")), Vec3::new(5.0, 0.0, 0.0));
    near(at(&format!("{moves} UniformScale 2")), Vec3::new(5.0, 0.0, 0.0));
    // An axis of length 2: cos I + sin [a]x + (1 - cos) a a^T maps x to x + 3 x for 180 degrees... by the formula.
    let c = 60f32.to_radians().cos();
    near(at("Rotate { 2 0 0 60 }"), Vec3::new(c + (1.0 - c) * 4.0, 0.0, 0.0));
}

#[test]
fn mirrored_things_keep_their_normals_outward() {
    let triangle = "Triangle { vertex0 0 0 0 vertex1 1 0 0 vertex2 0 1 0 }";
    let s =
        scene(&format!("{CAMERA}{RED}Group {{ MaterialIndex 0 Transform {{ Scale -1 1 1 {triangle} }} }}"));
    let (_, n, _) = look(&s, -0.2, 0.2).unwrap();
    assert!(n.distance(Vec3::Z) < 1e-6, "{n}");
    let s = scene(&format!(
        "{CAMERA}{RED}Group {{ MaterialIndex 0 Transform {{ Scale 1 1 -3 Sphere {{ center 0 0 0 radius 1 }} }} }}"
    ));
    let (p, n, _) = look(&s, 0.0, 0.0).unwrap();
    assert!(n.distance(Vec3::Z) < 1e-6 && (p.z - 3.0).abs() < 1e-5, "{p} {n}");
}

#[test]
fn a_flattened_object_is_invisible_and_said_to_be() {
    let text = format!(
        "{CAMERA}{RED}Group {{ MaterialIndex 0 Transform {{ Scale 1 0 1 Sphere {{ center 0 0 0 radius 1 }} }} }}"
    );
    let (scene, said) = compiled(&text);
    assert!(look(&scene.unwrap(), 0.0, 0.0).is_none());
    assert!(said[0].0 == Severity::Warning && said[0].1.contains("no inverse"), "{said:?}");
}

#[test]
fn a_plane_is_no_light_and_a_spot_without_its_angle_is_one_mistake() {
    let emitter = "Materials { Material m { emission 1 1 1 } } Group { MaterialIndex m";
    let (scene, said) = compiled(&format!(
        "{CAMERA} {emitter} Plane {{ normal 0 1 0 offset 0 }} Sphere {{ center 0 0 0 radius 1 }} }}"
    ));
    assert_eq!(scene.unwrap().lighting.sampler.len(), 2, "the ball and the background");
    assert!(said.len() == 1 && said[0].1.contains("without bounds"), "{said:?}");
    let spot = "SpotLight { position 0 1 0 direction 0 -1 0 color 1 1 1 angle 400 }";
    let (_, said) = compiled(&format!("{CAMERA}{RED}Lights {{ {spot} }}"));
    assert_eq!(said.iter().filter(|s| s.0 == Severity::Error).count(), 1, "{said:?}");
}

#[test]
fn a_background_keeps_the_numbers_of_the_text() {
    // The classic format knows negative colours; as light they are none.
    let s = scene(&format!("{CAMERA} Background {{ color 0.7 -0.3 1.5 }} Group {{}}"));
    assert_eq!(s.lighting.background.color(Vec3::Y), Spectrum::rgb(0.7, -0.3, 1.5));
    let light = s.lighting.background.radiance(Vec3::Y, &kajo_color::Wavelengths::RGB);
    assert_eq!(light, Spectrum::rgb(0.7, 0.0, 1.5));
}

#[test]
fn without_lights_the_ambient_light_is_white() {
    let dark = scene(&format!("{CAMERA} Background {{ ambientLight 0.1 0.2 0.3 }} Lights {{ numLights 0 }}"));
    assert_eq!(dark.lighting.ambient, Spectrum::WHITE);
    let lit = scene(&format!(
        "{CAMERA} Background {{ ambientLight 0.1 0.2 0.3 }} Lights {{ DirectionalLight {{ direction 0 -1 0 color 0 0 0 }} }}"
    ));
    assert_eq!(lit.lighting.ambient, Spectrum::rgb(0.1, 0.2, 0.3));
}

#[test]
fn mistakes_are_told_with_what_was_expected() {
    assert!(error_in_group("Sphere { center 0 0 0 radius 1 }").contains("no material"));
    assert!(error_in_group("MaterialIndex 7").contains("no material number 7"));
    assert!(error_in_group("MaterialIndex rde").contains("no material named `rde`"));
    assert!(
        error_in_group("numObjects 3 MaterialIndex 0 Sphere { center 0 0 0 radius 1 }")
            .contains("there is 1 object")
    );
    assert!(
        error_in_group("MaterialIndex 0 Spehre { center 0 0 0 radius 1 }").contains("unknown word `Spehre`")
    );
    assert!(
        error_in_group("MaterialIndex 0 Sphere { center 0 0 radius 1 }")
            .contains("expected 3 numbers after `center`")
    );
    assert!(error_in_group("MaterialIndex 0 Sphere { center 0 0 0 }").contains("`Sphere` needs `radius`"));
    assert!(error_in_group("MaterialIndex 0 RevSurface { radius 1 }").contains("not supported yet"));
    assert!(
        error_in_group("MaterialIndex 0 Quad { corner 0 0 0 edge1 1 0 0 edge2 2 0 0 }").contains("parallel")
    );
    let on_line = "vertex0 0 0 0 vertex1 1 2 3 vertex2 2 4 6 vertex3 -1 -2 -3";
    assert!(
        error_in_group(&format!("MaterialIndex 0 BilinearPatch {{ {on_line} }}"))
            .contains("all be on one line")
    );
    let row = "1 2 3 1 2 3 1 2 3 1 2 3";
    let equal = format!("row0 {row} row1 {row} row2 {row} row3 {row}");
    assert!(
        error_in_group(&format!("MaterialIndex 0 BicubicPatch {{ {equal} }}")).contains("all be on one line")
    );
    assert!(
        error_in_group("MaterialIndex 0 BicubicPatch { row0 1 2 3 }")
            .contains("expected 12 numbers after `row0`")
    );
    let sharp = error_in_group("MaterialIndex 0 Superellipsoid { radius 1 east 2.5 }");
    assert!(sharp.contains("at least 0.01 and at most 2"), "{sharp}");
    let late = "MaterialIndex 0 Transform { Sphere { center 0 0 0 radius 1 } Translate 1 0 0 }";
    assert!(error_in_group(late).contains("after the object"));
    let (none, said) = compiled("Group { }");
    assert!(none.is_none() && said[0].1.contains("no camera"));
    let (none, said) = compiled("Group { Model { file nowhere.glb } }");
    assert!(none.is_none() && said.len() == 1, "what is not read may have a camera: {said:?}");
}

#[test]
fn all_mistakes_are_told_at_once() {
    let (_, said) = compiled(
        "Camrea { } Lights { numLights 2 PointLight { position 0 0 0 } }
         Group { Sphere { center 0 0 0 radius x } Plane { normal 0 1 0 } }",
    );
    let errors = said.iter().filter(|s| s.0 == Severity::Error).count();
    assert!(errors >= 6, "{said:#?}");
}

#[test]
fn circles_and_towers_of_blends_are_refused() {
    let blend = |body: &str| compiled(&format!("{CAMERA} Materials {{ {body} }} Group {{ }}"));
    let (none, said) = blend(
        "Checkerboard { materialIndex 1 materialIndex 0 } Checkerboard { materialIndex 0 materialIndex 0 }",
    );
    assert!(none.is_none() && said.iter().any(|s| s.1.contains("made of itself")), "{said:?}");
    // Each level mixes the previous one with itself: 2^40 evaluations a hit.
    let mut tower = "Material { }".to_owned();
    for i in 0..40 {
        tower += &format!("Noise {{ materialIndex {i} materialIndex {i} }}");
    }
    let (none, said) = blend(&tower);
    assert!(none.is_none() && said.iter().any(|s| s.1.contains("more than 1024")), "{said:?}");
    let mut chain = String::new();
    for i in 0..5000 {
        chain += &format!("Noise {{ materialIndex {} materialIndex {} }}", i + 1, i + 1);
    }
    let (none, said) = blend(&(chain + "Material { }"));
    assert!(none.is_none() && !said.is_empty(), "a long chain of forward references");
    // As deep as is allowed: 511 levels, each of the one below and a plain one. Threads' stacks may be small.
    let mut allowed = String::new();
    for i in 0..511 {
        allowed += &format!("Mix {{ materialIndex {} materialIndex plain }}", i + 1);
    }
    allowed += "Material plain { diffuseColor 1 0.5 0 }";
    let deep = std::thread::Builder::new().stack_size(256 << 10);
    let some = deep.spawn(move || blend(&allowed).0.is_some()).unwrap().join();
    assert!(some.unwrap(), "a chain within the limits");
    let (some, _) = blend("Checkerboard { materialIndex late materialIndex 1 } Material late { }");
    assert!(some.is_some(), "forward references by name and number");
}

#[test]
fn dialects_change_what_they_should() {
    let mesh = "Group { MaterialIndex 0 Transform { Matrix { 1 0 0 3  0 1 0 0  0 0 1 0  0 0 0 1 } Sphere { center 0 0 0 radius 1 } } }";
    let text = format!("{CAMERA}{RED}{mesh}");
    let center = |dialect| compiled_as(&text, Some(dialect)).0.unwrap().geometry.bounds().center();
    assert!(center(Dialect::Handout).distance(Vec3::ZERO) < 1e-5, "the fourth row is ignored");
    assert!(center(Dialect::Mit2004).distance(Vec3::new(3.0, 0.0, 0.0)) < 1e-5, "row by row");
    let a2 = "PerspectiveCamera { center 0 0 0 direction 0 0 -1 up 0 2 1 angle 30 }
              Materials { Material { specularColor 0.5 0.5 0.5 } } Lights { PointLight { position 0 0 0 color 1 1 1 falloff 2 } }";
    let s = compiled_as(a2, Some(Dialect::MitA2)).0.unwrap();
    let Camera::Perspective(camera) = s.output.camera else { panic!("a perspective camera") };
    assert_eq!(camera.frame().up.as_vec3(), Vec3::new(0.0, 2.0, 1.0));
    assert_eq!(s.appearance.materials.phongs[0].phong.reflective, Spectrum::rgb(0.5, 0.5, 0.5));
    assert_eq!(s.appearance.materials.phongs[0].phong.exponent, 0.0);
    assert_eq!(s.lighting.lights.point[0].attenuation, [0.0, 0.0, 2.0]);
    // The scene's own choice gives way to the command line's.
    let chosen = format!("Settings {{ dialect mit-2004 }} {CAMERA}");
    assert_eq!(compiled(&chosen).0.unwrap().output.rules.dialect, Dialect::Mit2004);
    assert_eq!(compiled_as(&chosen, Some(Dialect::MitA2)).0.unwrap().output.rules.dialect, Dialect::MitA2);
}

#[test]
fn synonyms_of_choices_are_read_and_never_listed() {
    let read = |word: &str| compiled(&format!("{CAMERA} Settings {{ technique {word} }}"));
    for (word, technique) in Technique::SYNONYMS {
        let (scene, said) = read(word);
        assert_eq!((scene.unwrap().output.settings.technique, said), (Some(technique), vec![]));
    }
    let (_, said) = read("x");
    assert_eq!(said[0].1, "expected `combined`, `lights` or `scattering` after `technique`, found `x`");
    let kind = settings::BLOCK.field("technique").unwrap().kind;
    assert_eq!(kind.to_string(), "combined, lights or scattering");
}

/// A plane, and two hundred shapes of four kinds.
fn jumble() -> Scene {
    let mut text = format!("{CAMERA}{RED}Group {{ MaterialIndex 0 Plane {{ normal 0.2 1 0.1 offset -3 }}");
    for i in 0..200u32 {
        let s = kajo_math::rng::Stream::new(41, [i, 0], 0);
        let v = |k| 8.0 * s.uniform(k) - 4.0;
        text += &match i % 4 {
            0 => format!("Sphere {{ center {} {} {} radius {} }}", v(0), v(1), v(2), s.uniform(3)),
            1 => format!(
                "Transform {{ Translate {} {} {} XRotate {} Scale 1 0.4 -2 Sphere {{ center 0 0 0 radius 0.5 }} }}",
                v(0),
                v(1),
                v(2),
                v(3) * 50.0
            ),
            2 => format!("Box {{ min {0} {1} {2} max {0} {1} {3} }}", v(0), v(1), v(2), v(3)),
            _ => format!(
                "Cylinder {{ base {} {} {} top {} {} {} radius 0.2 }}",
                v(0),
                v(1),
                v(2),
                v(3),
                v(4),
                v(5)
            ),
        };
    }
    scene(&(text + "}"))
}

#[test]
fn the_tree_and_the_planes_agree_with_brute_force() {
    let s = jumble();
    let mut hits = 0;
    for i in 0..20_000u32 {
        let r = kajo_math::rng::Stream::new(43, [i, 0], 0);
        let v = |k| Vec3::new(r.uniform(k), r.uniform(k + 1), r.uniform(k + 2)) * 12.0 - 6.0;
        let ray = Ray::new(v(0), v(3) - v(0));
        let each = s.geometry.primitives.iter().enumerate().filter_map(|(j, p)| {
            let local = p.pose.still_in(&s.geometry.transforms).unwrap().ray_in_object(&ray);
            let local = if p.pose.is_identity() { ray } else { local };
            Some((s.geometry.shapes.hit(p.shape, &local)?.t, ObjectId::from_index(j as u32)))
        });
        let brute = each.min_by(|a, b| a.partial_cmp(b).unwrap());
        let found = match s.trace(&ray) {
            RayEvent::Surface(at) => Some((at.hit.t, at.object)),
            RayEvent::Escaped => None,
        };
        assert_eq!(found, brute, "ray {i}");
        assert_eq!(s.occluded(&ray), brute.is_some());
        let mut nearest = None;
        s.crossings(&ray, |j, hit| {
            if nearest.is_none_or(|n: (f32, ObjectId)| (hit.t, j) < n) {
                nearest = Some((hit.t, j));
            }
        });
        assert_eq!(nearest, brute);
        hits += u32::from(brute.is_some());
    }
    assert!(hits > 5000);
}

#[test]
fn rays_from_and_to_a_point_need_no_tree() {
    let s = jumble();
    let (mut hits, mut hidden) = (0, 0);
    let apexes = [Vec3::new(0.0, 0.0, 20.0), Vec3::new(7.0, 5.0, -3.0), Vec3::new(0.5, 1.0, -0.7)];
    for (apex, cells) in apexes.into_iter().zip([0, 10_000, 100_000]) {
        let buffer = s.geometry.item_buffer(apex, cells).unwrap();
        for i in 0..5000u32 {
            let r = kajo_math::rng::Stream::new(45, [i, 0], 0);
            let p = Vec3::new(r.uniform(0), r.uniform(1), r.uniform(2)) * 12.0 - 6.0;
            let from = Ray::new(apex, (p - apex).normalize());
            let [with, without] = [Some(&buffer), None].map(|buffer| match s.trace_from(buffer, &from) {
                RayEvent::Surface(at) => Some((at.hit, at.object)),
                RayEvent::Escaped => None,
            });
            assert_eq!(with, without, "{apex} {p}");
            let to = Ray::new(p, -from.d).over(1e-3, p.distance(apex));
            assert_eq!(s.occluded_towards(Some(&buffer), &to), s.occluded(&to), "{apex} {p}");
            hits += u32::from(with.is_some());
            hidden += u32::from(s.occluded(&to));
        }
    }
    assert!(hits > 5000 && (5000..14_000).contains(&hidden), "{hits} {hidden}");
}

#[test]
fn looking_for_the_far_side_first_changes_nothing() {
    let s = jumble();
    let mut crossed = 0;
    for i in 0..5000u32 {
        let r = kajo_math::rng::Stream::new(46, [i, 0], 0);
        let signed = |k: u32| 2.0 * Vec3::new(r.uniform(k), r.uniform(k + 1), r.uniform(k + 2)) - 1.0;
        let RayEvent::Surface(at) = s.trace(&Ray::new(6.0 * signed(0), signed(3).normalize())) else {
            continue;
        };
        let onward = at.point.ray_towards(signed(6).normalize(), f32::INFINITY, 0.0, crate::RayOffset::Auto);
        let (mut first, mut plain) = (at, at);
        let met = s.trace_inwards(&onward, &mut first);
        assert_eq!(met, s.trace_into(None, &onward, &mut plain), "{i}");
        if met {
            assert_eq!((first.object, first.hit), (plain.object, plain.hit), "{i}");
            assert_eq!(first.point.p, plain.point.p, "{i}");
            crossed += u32::from(first.object == at.object);
        }
    }
    assert!(crossed > 300, "{crossed}");
}

#[test]
fn what_a_flattened_transform_holds_is_read_but_never_seen() {
    // Only the product of all three matrices would hide the missing inverse behind rounding.
    let ops = "YRotate 31 Scale 0 1 1 Group { Transform { XRotate 17 ZRotate 23";
    let text =
        |inner: &str| format!("{CAMERA}{RED}Group {{ MaterialIndex 0 Transform {{ {ops} {inner} }} }} }} }}");
    let (scene, said) = compiled(&text("Sphere { center 0 0 0 radius 1 }"));
    assert!(scene.unwrap().geometry.primitives.is_empty());
    assert_eq!(said.len(), 1, "one warning, for the outer block: {said:?}");
    assert!(said[0].1.contains("no inverse"));

    let (scene, said) = compiled(&text("Sphere { center 0 0 0 radios 1 }"));
    assert!(scene.is_none(), "mistakes in it are still mistakes: {said:?}");

    let s = self::scene(&format!(
        "{CAMERA}{RED}Group {{ MaterialIndex 0 Transform {{ Scale 0 1 1 Group {{ MaterialIndex 1 }} }}
         Sphere {{ center 0 0 0 radius 1 }} }}"
    ));
    assert_eq!(look(&s, 0.0, 0.0).unwrap().2, [0.0, 1.0, 0.0], "a material set in it stays in force");
}

#[test]
fn what_has_no_effect_is_said() {
    let said = |text: &str| -> Vec<String> {
        let (scene, said) = compiled(text);
        assert!(scene.is_some(), "{said:?}");
        said.into_iter().map(|(_, message)| message).collect()
    };
    let materials = |text: &str| said(&format!("{CAMERA}Materials {{ {text} }}"));
    for (text, key) in [
        ("Metal { metal gold  color 1 0 0 }", "color"),
        ("Glass { glass water  indexOfRefraction 1.4 }", "indexOfRefraction"),
        ("Glass { abbeNumber 30  glass water }", "abbeNumber"),
        ("Glass { thin off  thickness 0.3 }", "thickness"),
    ] {
        let messages = materials(text);
        assert!(
            messages.len() == 1 && messages[0].starts_with(&format!("`{key}` has no effect")),
            "{messages:?}"
        );
    }
    for text in ["Glass { thickness 0.1 }", "Glass { glass water  roughness 0.2 }", "Metal { color 1 0 0 }"] {
        assert_eq!(materials(text), [""; 0]);
    }
    let camera = |keys: &str| said(&format!("PerspectiveCamera {{ center 0 0 5  angle 30  {keys} }}"));
    let (ahead, up) = ("direction 0 0 -1", "up 0 1 0");
    assert_eq!(camera(&format!("{ahead} {up}")), [""; 0]);
    for keys in ["direction 0 0 0 up 0 1 0", "direction 0 2 0 up 0 -1 0", "direction 0 0 -1 up 0 0 0"] {
        assert_eq!(camera(keys).len(), 1, "{keys}");
    }
    for keys in ["focus 5", "blades 5"] {
        assert!(camera(&format!("{ahead} {up} {keys}"))[0].contains("without an `aperture`"));
    }
    assert_eq!(
        camera(&format!("{ahead} {up} aperture 0  focus 5  blades 6")),
        [""; 0],
        "a lens that is shut for now"
    );
    let angle = |angle: f32| {
        let view = format!("center 0 0 5  {ahead} {up}  angle {angle}");
        said(&format!("PerspectiveCamera {{ {view} }}"))
    };
    let as_wide =
        |size: f32| said(&format!("OrthographicCamera {{ center 0 0 5  {ahead} {up}  size {size} }}"));
    for wide in [1e-3, 30.0, 179.0] {
        assert_eq!((angle(wide), as_wide(wide)), (vec![], vec![]));
    }
    for (degrees, told) in [
        (0.0, "sees nothing"),
        (180.0, "FisheyeCamera"),
        (-30.0, "on its head"),
        (200.0, "on its head"),
        (360.0, "sees nothing"),
        (400.0, "whole turns"),
    ] {
        assert!(
            angle(degrees).len() == 1 && angle(degrees)[0].contains(told),
            "{degrees}: {:?}",
            angle(degrees)
        );
    }
    assert!(as_wide(0.0)[0].contains("sees nothing") && as_wide(-1.0)[0].contains("on its head"));
    let lights = |text: &str| said(&format!("{CAMERA}Lights {{ {text} }}"));
    let spot = "SpotLight { position 0 1 0  direction 0 -1 0  intensity 1  angle 30";
    assert_eq!(lights(&format!("{spot}  innerAngle 30 }}")), [""; 0]);
    assert!(lights(&format!("{spot}  innerAngle 31 }}"))[0].contains("`innerAngle` has no effect"));
    for (degrees, told) in [(0, "holds no light"), (181, "shines backwards"), (360, "`PointLight`")] {
        let light = format!("SpotLight {{ position 0 1 0  direction 0 -1 0  intensity 1  angle {degrees} }}");
        assert!(lights(&light).len() == 1 && lights(&light)[0].contains(told), "{:?}", lights(&light));
    }
    assert!(
        said(&format!("{CAMERA}Background {{ sky {{ }}  color 1 }}"))[0].contains("`color` has no effect")
    );
}

#[test]
fn light_is_not_divided_by_zero() {
    for zero in ["falloff 0", "falloff -0", "attenuation 0 0 0"] {
        let light = format!("PointLight {{ position 0 1 0  color 1 1 1  {zero} }}");
        let (scene, said) = compiled(&format!("{CAMERA}Lights {{ {light} }}"));
        assert!(scene.is_none() && said.len() == 1, "{zero}: {said:?}");
        assert!(said[0].1.contains("would divide the light by zero"), "{zero}: {said:?}");
    }
}

#[test]
fn one_mistake_is_reported_once() {
    let errors = |text: &str| -> Vec<String> {
        let (_, said) = compiled(&format!("{CAMERA}{text}"));
        said.into_iter().filter(|(severity, _)| *severity == Severity::Error).map(|(_, m)| m).collect()
    };
    let misspelt = errors(&format!("{RED}Group {{ numObjects 1 MaterialIndex 0 Spere {{ radius 1 }} }}"));
    assert_eq!(misspelt, ["unknown word `Spere` in `Group`"]);
    let later = errors(&format!("{RED}Lights {{ numLights 1 SunSky {{ }} }}"));
    assert_eq!(later, ["`SunSky` is no word of this language"]);
    let clear = errors("Materials { Principled { transmission 1  opacity 0.5 } }");
    assert_eq!(clear, ["light passes this material anyway, so that it can have no holes"]);
    let misspelt = errors("Materials { numMaterials 1 Matarial { } }");
    assert_eq!(misspelt, ["unknown word `Matarial` in `Materials`"]);
    for two in ["color 1 1 1  intensity 1", "power 3  intensity 1", "power 3  color 1 1 1"] {
        let twice = errors(&format!("Lights {{ PointLight {{ position 0 0 0  {two} }} }}"));
        assert_eq!(twice, ["a light has `color`, `intensity` or `power`, not both"]);
    }
    let ball = |index: &str| format!("Group {{ MaterialIndex {index} Sphere {{ center 0 0 0 radius 1 }} }}");
    for (materials, index) in [
        ("Matte { roughness 2  color 1.5 0 0 }", "0"),
        ("Matte one { color 1.5 0 0 } Matte two { }", "1"),
        ("Matte one { } Matte two { color 1.5 0 0 }", "two"),
        ("Matt two { }", "two"),
        ("Mix two { materialIndex one } Matte one { }", "two"),
    ] {
        let wrong = errors(&format!("Materials {{ {materials} }} {}", ball(index)));
        assert!(!wrong.iter().any(|message| message.contains("no material")), "{wrong:?}");
    }
    let other = errors(&format!("Materials {{ Matte one {{ color 1.5 0 0 }} }} {}", ball("nobody")));
    assert!(other.len() == 2 && other[1] == "there is no material named `nobody`", "{other:?}");
    for index in ["7", "nobody", "-1"] {
        let wrong =
            errors(&format!("{RED}Group {{ MaterialIndex {index} Sphere {{ center 0 0 0 radius 1 }} }}"));
        assert_eq!(wrong.len(), 1, "{wrong:?}");
    }
}

/// Normals at the middle of two triangles that share an edge by index but not all their corners.
#[test]
fn smooth_meshes_take_normals_as_the_dialect_says() {
    // A roof: the ridge is shared, each side also has normals of its own in the file.
    let roof =
        "v 0 1 0\nv 0 -1 0\nv 1 0 -1\nv -1 0 -1\nvn 1 0 0\nvn 0 1 0\nf 1//1 2//1 3//1\nf 2//2 1//2 4//2\n";
    let split = "v 0 1 0\nv 0 -1 0\nv 1 0 -1\nv -1 0 -1\nv 0 1 0\nv 0 -1 0\nf 1 2 3\nf 6 5 4\n";
    let normal = |keys: &str, obj: &str, dialect: Dialect| {
        let text =
            format!("{CAMERA}{RED}Group {{ MaterialIndex 0 TriangleMesh {{ obj_file a.obj {keys} }} }}");
        let mut parsed = SceneDesc::parse_str(&text);
        let assets = MemoryAssets::new().with("a.obj", obj);
        let options = CompileOptions { dialect: Some(dialect), ..CompileOptions::default() };
        let s = compile(&mut parsed.desc, &assets, &options, &mut parsed.diagnostics).expect("a scene");
        look(&s, 1e-4, 0.0).expect("the roof").1
    };
    let near = |a: Vec3, b: Vec3| assert!(a.distance(b) < 1e-3, "{a} {b}");
    let slope = Vec3::new(1.0, 0.0, 1.0).normalize();
    near(normal("", roof, Dialect::Handout), slope);
    near(normal("smooth on", roof, Dialect::Handout), Vec3::X);
    near(normal("smooth on", split, Dialect::Handout), Vec3::Z);
    near(normal("", roof, Dialect::MitA2), Vec3::Z);
    near(normal("", split, Dialect::MitA2), slope);
    near(normal("smooth off", roof, Dialect::MitA2), slope);
}

pub(super) fn with_files(text: &str, assets: &MemoryAssets) -> (Option<Scene>, Vec<String>) {
    let mut parsed = SceneDesc::parse_str(&format!("{CAMERA}{RED}{text}"));
    let mut diagnostics = parsed.diagnostics;
    let scene = compile(&mut parsed.desc, assets, &CompileOptions::default(), &mut diagnostics);
    (scene, diagnostics.iter().map(|d| d.message.clone()).collect())
}

/// A roof of two triangles over the z axis, in three formats; PLY with wrong normals, so that they show.
pub(super) fn roof() -> MemoryAssets {
    let obj = "v -1 0 0\nv 1 0 0\nv 0 1 1\nv 0 -1 1\nf 1 2 3\nf 1 4 2\n";
    let ply = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
        property float nx\nproperty float ny\nproperty float nz\nproperty float s\nproperty float t\n\
        element face 2\nproperty list uchar int vertex_indices\nend_header\n\
        -1 0 0 2 0 0 0 0\n1 0 0 2 0 0 1 0\n0 1 1 2 0 0 0 1\n0 -1 1 2 0 0 0 1\n3 0 1 2\n3 0 3 1\n";
    let facet = |a: &str, b: &str, c: &str| {
        format!("facet normal 0 0 0\nouter loop\nvertex {a}\nvertex {b}\nvertex {c}\nendloop\nendfacet\n")
    };
    let (left, right) = ("-1 0 0", "1 0 0");
    let stl = format!("solid\n{}{}endsolid\n", facet(left, right, "0 1 1"), facet(left, "0 -1 1", right));
    MemoryAssets::new().with("roof.obj", obj).with("roof.ply", ply).with("roof.stl", stl)
}

#[test]
fn meshes_of_all_formats_are_the_same_mesh() {
    for file in ["obj_file roof.obj", "file roof.obj", "file roof.ply", "file roof.stl"] {
        let (flat, said) =
            with_files(&format!("Group {{ MaterialIndex 0 TriangleMesh {{ {file} }} }}"), &roof());
        let flat = flat.unwrap_or_else(|| panic!("{said:?}"));
        let (p, n, _) = look(&flat, 0.0, 0.25).unwrap();
        assert!(
            (p.z - 0.25).abs() < 1e-5 && n.distance(Vec3::new(0.0, -1.0, 1.0).normalize()) < 1e-5,
            "{file}: {p} {n}"
        );
        let (smooth, _) =
            with_files(&format!("Group {{ MaterialIndex 0 TriangleMesh {{ {file} smooth on }} }}"), &roof());
        let (_, n, _) = look(&smooth.unwrap(), 0.0, 1e-4).unwrap();
        let expected = if file.ends_with("ply") { Vec3::X } else { Vec3::Z };
        assert!(n.distance(expected) < 1e-3, "{file}: {n}");
    }
}

#[test]
fn texture_coordinates_of_vertices_reach_the_hit() {
    let (scene, _) = with_files("Group { MaterialIndex 0 TriangleMesh { file roof.ply } }", &roof());
    let scene = scene.unwrap();
    let ray = Ray::new(Vec3::new(0.0, 0.25, 10.0), Vec3::NEG_Z);
    let RayEvent::Surface(at) = scene.trace(&ray) else { panic!("missed") };
    assert!(scene.geometry.uv(&at).distance(Vec2::new(0.375, 0.25)) < 1e-5, "{}", scene.geometry.uv(&at));
}

#[test]
fn triangles_without_area_are_counted_in_one_warning() {
    let flat = "Triangle { vertex0 0 0 0 vertex1 1 0 0 vertex2 2 0 0 } ";
    for (n, expected) in
        [(1, "this triangle has no area and is left out"), (7, "7 triangles have no area and are left out")]
    {
        let (scene, said) = compiled(&format!("{CAMERA}{RED}Group {{ MaterialIndex 0 {} }}", flat.repeat(n)));
        assert!(scene.unwrap().geometry.primitives.is_empty());
        assert_eq!(said, [(Severity::Warning, expected.to_owned())]);
    }
}

/// A model of one triangle that two nodes show, the second behind the first and to the right.
fn flag() -> MemoryAssets {
    let floats = [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let bytes: Vec<u8> = floats.iter().flat_map(|x| x.to_le_bytes()).collect();
    let json = r#"{"asset":{"version":"2.0"},"buffers":[{"uri":"flag.bin","byteLength":36}],
        "bufferViews":[{"buffer":0,"byteLength":36}],
        "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],
        "materials":[{"pbrMetallicRoughness":{"baseColorFactor":[0.25,0.5,1,1]}}],"animations":[{}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0},"material":0}]}],
        "nodes":[{"mesh":0,"name":"near"},{"mesh":0,"translation":[2,0,-1]}]}"#;
    MemoryAssets::new().with("models/flag.gltf", json).with("models/flag.bin", bytes)
}

#[test]
fn models_are_placed_with_their_materials_or_without() {
    let (scene, said) = with_files(
        "Group { Model { file models/flag.gltf } MaterialIndex red
         Transform { Translate 0 3 0 Model { file models/flag.gltf materials off } }
         Define flags { Model { file models/flag.gltf } } Instance flags { Translate 0 -3 0 } }",
        &flag(),
    );
    let scene = scene.unwrap_or_else(|| panic!("{said:?}"));
    assert_eq!(
        (scene.geometry.shapes.meshes.len(), scene.geometry.primitives.len()),
        (2, 6),
        "with and without materials"
    );
    let (own, red) = ([0.25, 0.5, 1.0], [1.0, 0.0, 0.0]);
    for (x, y, z, color) in [
        (0.2, 0.2, 0.0, own),
        (2.2, 0.2, -1.0, own),
        (0.2, 3.2, 0.0, red),
        (2.2, 3.2, -1.0, red),
        (2.2, -2.8, -1.0, own),
    ] {
        let (p, n, found) = look(&scene, x, y).unwrap_or_else(|| panic!("nothing at {x} {y}"));
        assert!((p.z - z).abs() < 1e-5 && found == color && n == Vec3::Z, "{x} {y}: {p} {found:?}");
    }
    let names: Vec<_> = scene.geometry.objects.iter().map(|o| (o.keyword, o.name)).collect();
    assert_eq!(names[..2], [("Model", Some("near")), ("Model", None)]);
    assert_eq!(said, ["`models/flag.gltf`: left out: 1 animations"; 2]);
}

#[test]
fn wrong_models_are_told() {
    let broken =
        MemoryAssets::new().with("a.gltf", "{\"asset\":{\"version\":\"2.0\"},\"nodes\":[{\"mesh\":0}]}");
    let (scene, said) = with_files("Group { MaterialIndex 0 Model { file a.gltf } }", &broken);
    assert!(scene.is_none());
    assert_eq!(said, ["a.gltf: nodes[0]: there is no meshes[0]"]);
    let (scene, said) = with_files("Group { MaterialIndex 0 TriangleMesh { file a.gltf } }", &broken);
    assert!(scene.is_none() && said[0].contains("show it with `Model { file ... }`"), "{said:?}");
}

/// How the first object's material scatters at a point above it.
fn scatters(materials: &str) -> Bsdf<'static> {
    let sphere = "Group { MaterialIndex 0  Sphere { center 0 0 0  radius 1 } }";
    let text = format!("{CAMERA}Materials {{ {materials} }}{sphere}");
    let scene = scene(&text);
    let RayEvent::Surface(at) = scene.trace(&Ray::new(Vec3::new(0.0, 0.0, 5.0), Vec3::NEG_Z)) else {
        panic!("the sphere is met");
    };
    without_tables(scene.bsdf(&at, &kajo_color::Wavelengths::RGB, 1.0, 0.5))
}

#[test]
fn physical_materials_scatter_as_they_are_written() {
    let matte = scatters("Matte { color 0.2 0.3 0.4 }");
    assert!(matches!(matte, Bsdf::Lambert(l) if l.reflectance == Spectrum::rgb(0.2, 0.3, 0.4)), "{matte:?}");
    let clay = scatters("Matte { roughness 0.7 }");
    assert!(matches!(clay, Bsdf::OrenNayar(l) if l.roughness == 0.7), "{clay:?}");

    let gold = scatters("Metal { metal gold }");
    let [r, g, b] = gold.albedo(Vec3::Z).to_rgb();
    assert!(gold.is_delta() && r > 0.9 && r > g && g > b, "gold is yellow: {r} {g} {b}");
    let paint = scatters("Metal { color 0.1 0.2 0.9  roughness 0.5 }");
    let [r, _, b] = paint.albedo(Vec3::Z).to_rgb();
    assert!(!paint.is_delta() && (r - 0.1).abs() < 1e-5 && (b - 0.9).abs() < 1e-5);

    let frost = scatters("Glass { indexOfRefraction 1.4  roughness 0.5 }");
    let alpha = |l: &Dielectric| l.microfacets.alpha_x;
    assert!(matches!(frost, Bsdf::Dielectric(l) if l.eta == 1.4 && alpha(&l) == 0.25), "{frost:?}");
    let prism = scatters("Glass { glass N-BK7 }");
    assert!(matches!(prism, Bsdf::Dielectric(l) if (l.eta - 1.5168).abs() < 1e-4), "{prism:?}");
    let pane = scatters("Glass { thickness 0.5  absorption 2 0 0 }");
    let depth = Spectrum::rgb(1.0, 0.0, 0.0);
    assert!(
        matches!(pane, Bsdf::ThinDielectric(l) if l.optical_depth == depth && l.is_polished()),
        "{pane:?}"
    );
    let frosted = scatters("Glass { thin on  roughness 0.5 }");
    assert!(matches!(frosted, Bsdf::ThinDielectric(l) if l.microfacets.alpha_y == 0.25), "{frosted:?}");

    let base = |text| match scatters(text) {
        Bsdf::Principled(layers) => layers.base,
        other => panic!("{other:?}"),
    };
    // The number that chooses is a half.
    assert_eq!(base("Principled { metalness 0.4 }"), Base::Diffuse);
    assert_eq!(base("Principled { metalness 0.6 }"), Base::Metal);
    assert_eq!(base("Principled { metalness 0.4  transmission 0.5 }"), Base::Glass);
    let pane = scatters("Principled { transmission 1  thin on  color 0.5 1 0  indexOfRefraction 1.4 }");
    let Bsdf::ThinDielectric(pane) = pane else { panic!("{pane:?}") };
    let ThinDielectric { eta, optical_depth, microfacets } = pane;
    assert!((microfacets.alpha_x - 0.09).abs() < 1e-6 && !pane.is_polished(), "{microfacets:?}");
    let [r, g, b] = optical_depth.to_rgb();
    assert!(eta == 1.4 && (r - 2f32.ln()).abs() < 1e-6 && g == 0.0 && b > 50.0, "{optical_depth:?}");
}

#[test]
fn mistakes_in_physical_materials_are_told() {
    let told = |material: &str| {
        let (_, messages) = compiled(&format!("Materials {{ {material} }}"));
        messages.into_iter().map(|(_, message)| message).collect::<Vec<_>>().join("; ")
    };
    assert!(told("Metal { metal godl }").contains("gold"));
    assert!(told("Glass { glass mud }").contains("N-BK7"));
    assert!(told("Matte { color 2 0 0 }").contains("between 0 and 1"));
    assert!(told("Glass { absorption -1 0 0 }").contains("not negative"));
    assert!(told("Principled { absorption -1 0 0 }").contains("not negative"));
    assert!(
        told("Principled { transmission 1  thin on  absorption 1 0 0 }").contains("a pane has no inside")
    );
    assert_eq!(told("Principled { thin on }"), "`thin` has no effect without `transmission`");
}
