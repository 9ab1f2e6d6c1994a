//! Blobs as they are written.

use kajo_math::{Ray, Vec2, Vec3};

use super::tests::{compiled, scene};
use crate::Scene;
use crate::light::{LightChoice, Receiver};
use crate::scene::RayEvent;
use kajo_color::Wavelengths;

const HEAD: &str = "PerspectiveCamera { center 0 0 10 direction 0 0 -1 up 0 1 0 angle 30 }
Materials { Material red { diffuseColor 1 0 0 } Material green { diffuseColor 0 1 0 } Material blue { diffuseColor 0 0 1 }
  Material bright { diffuseColor 0 0 0  emission 2 2 2 } Material black { diffuseColor 0 0 0 }
  Material white { diffuseColor 1 1 1 } }\n";

fn of(group: &str) -> Scene {
    scene(&format!("{HEAD}Group {{ {group} }}"))
}

/// The colour that a ray down the z axis from (x, y) meets first.
fn color(scene: &Scene, x: f32, y: f32) -> Option<[f32; 3]> {
    match scene.trace(&Ray::new(Vec3::new(x, y, 10.0), Vec3::NEG_Z)) {
        RayEvent::Surface(at) => {
            Some(scene.appearance.phong(at.material, &scene.texture_context(&at)).diffuse.to_rgb())
        }
        RayEvent::Escaped => None,
    }
}

fn error(group: &str) -> String {
    let (scene, said) = compiled(&format!("{HEAD}Group {{ {group} }}"));
    assert!(scene.is_none(), "accepted: {group}");
    format!("{said:?}")
}

const PAIR: &str = "sphere { center -0.5 0 0  radius 1  strength 2  material red }
    sphere { center 0.5 0 0  radius 1  strength 2  material green }";

#[test]
fn materials_blend_by_the_strength_of_their_components() {
    let near = |a: Option<[f32; 3]>, b: [f32; 3]| {
        let close = |a: [f32; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-4);
        assert!(a.is_some_and(close), "{a:?} for {b:?}");
    };
    let pair = of(&format!("Blob {{ {PAIR} }}"));
    near(color(&pair, 0.0, 0.0), [0.5, 0.5, 0.0]);
    // exp(-0.2^2) to exp(-0.8^2).
    let share = 1.0 / (1.0 + (0.04f32 - 0.64).exp());
    near(color(&pair, -0.3, 0.0), [share, 1.0 - share, 0.0]);
    near(color(&pair, 0.3, 0.0), [1.0 - share, share, 0.0]);
    // Moved, turned, and as an operand it is the same.
    let moved =
        of(&format!("Transform {{ Translate 1 0.5 -2 ZRotate 90 UniformScale 2 Blob {{ {PAIR} }} }}"));
    near(color(&moved, 1.0, 0.5 - 0.6), [share, 1.0 - share, 0.0]);
    let carved = of(&format!(
        "MaterialIndex blue Difference {{ Transform {{ Translate 0 0 1 Blob {{ {PAIR} }} }} Box {{ min -9 0.2 -9 max 9 9 9 }} }}"
    ));
    near(color(&carved, -0.3, 0.0), [share, 1.0 - share, 0.0]);
    let own = of(&format!("Difference {{ material blue Blob {{ {PAIR} }} Box {{ min 1 1 1 max 2 2 2 }} }}"));
    near(color(&own, -0.3, 0.0), [0.0, 0.0, 1.0]);
    // Whoever says nothing has the material in force, and what takes away has no share.
    let third =
        "sphere { center 0 -1 0 radius 1 strength 2 } sphere { center -0.3 0 0 radius 1 strength -0.1 }";
    let three = of(&format!("MaterialIndex blue Blob {{ {PAIR} {third} }}"));
    let Some([r, g, b]) = color(&three, 0.0, -0.5) else { panic!("no blob") };
    assert!((r - g).abs() < 1e-5 && (r + g + b - 1.0).abs() < 1e-5 && b > r, "{r} {g} {b}");
    // All of one material is none of a mixture.
    let same = of(
        "Blob { sphere { center 0 0 0 radius 1 material red } sphere { center 1 0 0 radius 1 material red } }",
    );
    assert_eq!(color(&same, 0.0, 0.0), Some([1.0, 0.0, 0.0]));
    assert!(!same.appearance.has_pictures);
}

#[test]
fn five_materials_are_mixed_and_six_are_refused() {
    let part = |i: usize, material: &str| {
        format!("sphere {{ center {} 0 0 radius 1 strength 2 material {material} }} ", 0.2 * i as f32)
    };
    let names = ["red", "green", "blue", "bright", "black"];
    let five: String = names.iter().enumerate().map(|(i, name)| part(i, name)).collect();
    let Some([r, g, b]) = color(&of(&format!("Blob {{ {five} }}")), 0.4, 0.0) else { panic!("no blob") };
    let weight = |i: f32| (-(0.2 * i - 0.4) * (0.2 * i - 0.4)).exp();
    let sum: f32 = [0.0, 1.0, 2.0, 3.0, 4.0].map(weight).iter().sum();
    for (found, i) in [(r, 0.0), (g, 1.0), (b, 2.0)] {
        assert!((found - weight(i) / sum).abs() < 1e-4, "{r} {g} {b}");
    }
    let said = error(&format!("Blob {{ {five} {} }}", part(6, "white")));
    assert!(said.contains("5 materials at most"), "{said}");
}

#[test]
fn mistakes_in_components_are_told() {
    let said = error(&format!("Blob {{ {PAIR} sphere {{ center 0 1 0 radius 1 }} }}"));
    assert!(said.contains("this component has no material, and others have one"), "{said}");
    let said =
        error(&format!("Blob {{ {PAIR} sphere {{ center 0 1 0 radius 1 strength -1 material red }} }}"));
    assert!(said.contains("what takes away from a blob has no material"), "{said}");
    let said = error("Blob { sphere { center 0 1 0 radius 1 material rde } }");
    assert!(said.contains("rde"), "{said}");
    let said = error("MaterialIndex 0 Blob { plane { point 0 0 0 normal 0 0 0 radius 1 } }");
    assert!(said.contains("must not be zero"), "{said}");
    let said = error("MaterialIndex 0 Blob { plane { point 0 0 0 normal 0 1 0 radius 0 } }");
    assert!(said.contains("radius"), "{said}");
}

#[test]
fn half_spaces_are_operands_and_stand_alone() {
    let ground = "Blob { threshold 0.5  plane { point 0 -1 0  normal 0 1 0  radius 0.5  material red }
        sphere { center 0 -0.8 0  radius 0.6  material green } }";
    let scene = of(ground);
    assert!(scene.geometry.has_unbounded());
    let down = |x: f32| match scene.trace(&Ray::new(Vec3::new(x, 9.0, 0.0), Vec3::NEG_Y)) {
        RayEvent::Surface(at) => at.point.p.y,
        RayEvent::Escaped => f32::NEG_INFINITY,
    };
    let flat = -1.0 + 0.5 * 2f32.ln().sqrt();
    assert!((down(7.0) - flat).abs() < 1e-5 && down(0.0) > flat + 0.2, "{} {}", down(7.0), down(0.0));
    // What a box keeps of it.
    let kept =
        of(&format!("MaterialIndex blue Intersection {{ {ground} Box {{ min -1 -3 -1 max 1 3 1 }} }}"));
    let bounds = kept.geometry.bounds();
    assert!(bounds.is_finite() && (bounds.min.y + 3.0).abs() < 1e-5, "{bounds:?}");
    let mut inside = false;
    kept.crossings(&Ray::new(Vec3::new(0.5, -2.0, 0.1), Vec3::X), |_, _| inside = !inside);
    assert!(inside);
    assert_eq!(color(&kept, 0.0, -2.0), Some([0.0, 0.0, 1.0]), "the cut has the box's");
}

/// The light of a component of a mixture is its share of it everywhere.
#[test]
fn light_blends_as_materials_do() {
    let scene = of("Blob { sphere { center -0.5 0 0 radius 1 strength 2 material bright }
        sphere { center 0.5 0 0 radius 1 strength 2 material black } }");
    let to = Receiver { p: Vec3::new(0.0, 0.0, 8.0), n: Vec3::NEG_Z, time: 0.0 };
    let mut drawn = 0;
    for i in 0..400u16 {
        let u = Vec2::new(f32::from(i % 20) + 0.5, f32::from(i / 20) + 0.5) / 20.0;
        let Some(chosen) = scene.lighting.sampler.sample(&to, 0.5, LightChoice::Uniform) else {
            panic!("no light")
        };
        let Some(light) = scene.sample_li(chosen.light, &to, u, &Wavelengths::RGB, LightChoice::Uniform)
        else {
            continue;
        };
        let RayEvent::Surface(at) = scene.trace(&Ray::new(to.p, light.wi)) else { continue };
        if at.point.p.distance(light.at.p()) > 1e-4 {
            continue;
        }
        drawn += 1;
        let square = |x: f32| (at.point.p - x * Vec3::X).length_squared();
        let expected = 2.0 / (1.0 + (square(-0.5) - square(0.5)).exp());
        let seen = scene.surface_light(&at, light.wi, &Wavelengths::RGB).unwrap().radiance.to_rgb()[0];
        let sampled = light.radiance.to_rgb()[0];
        assert!(
            (seen - expected).abs() < 1e-3 && (sampled - expected).abs() < 1e-3,
            "{seen} {sampled} {expected}"
        );
    }
    assert!(drawn > 50, "{drawn}");
}
