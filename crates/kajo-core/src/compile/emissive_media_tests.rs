//! Which bodies of media that emit are drawn, and where directions to them lead.

use kajo_math::rng::Stream;
use kajo_math::{Vec2, Vec3};
use kajo_scene::{MemoryAssets, SceneDesc};

use super::{CompileOptions, compile};
use crate::scene::Scene;

fn scene(media: &str, materials: &str, things: &str) -> Scene {
    let text = format!(
        "PerspectiveCamera {{ center 0 0 9  direction 0 0 -1  up 0 1 0  angle 30  shutter 0 1 }}
         Media {{ {media} }} Materials {{ Interface hot {{ medium gas }} {materials} }} {things}"
    );
    let mut parsed = SceneDesc::parse_str(&text);
    let options = CompileOptions::default();
    let made = compile(&mut parsed.desc, &MemoryAssets::new(), &options, &mut parsed.diagnostics);
    made.unwrap_or_else(|| panic!("{text}\n{:?}", parsed.diagnostics))
}

/// The share of directions drawn from a point whose line comes nearer to another one than a distance.
fn share_near(scene: &Scene, from: Vec3, p: Vec3, distance: f32) -> f32 {
    let near = (0..1000).filter(|&i| {
        let number = Stream::new(4, [i, 0], 0);
        let [u, v] = [0, 2].map(|k| Vec2::new(number.uniform(k), number.uniform(k + 1)));
        let (w, _) = scene.emissive_volumes().sample(from, u, v).expect("there is a body");
        (p - from).reject_from(w).length() < distance
    });
    near.count() as f32 / 1000.0
}

const GAS: &str = "Medium gas { emission 1 }";
const FROM: Vec3 = Vec3::new(3.0, 8.0, 5.0);

/// The box around a ball is nearly twice as large; directions are drawn to the ball.
#[test]
fn directions_lead_into_bodies() {
    let ball = scene(GAS, "", "Group { MaterialIndex hot Sphere { center 1 2 0  radius 0.7 } }");
    let share = share_near(&ball, FROM, Vec3::new(1.0, 2.0, 0.0), 0.7);
    assert!(share > 0.95, "{share}");
    // What a function leaves of a body, seen from within.
    let medium = "FunctionMedium gas { function = 1 - 20 * ((x - 3)^2 + y^2 + z^2)  min -4 -4 -4  max 4 4 4  emission 1 }";
    let core = scene(medium, "", "Group { MaterialIndex hot Box { min -4 -4 -4  max 4 4 4 } }");
    let share = share_near(&core, Vec3::new(-2.0, 1.0, 3.0), Vec3::new(3.0, 0.0, 0.0), 0.23);
    assert!(share > 0.9, "{share}");
    // A shell of a solid by set operations, seen from its hollow.
    let shell = "Difference { Sphere { center 0 0 0  radius 2 }  Sphere { center 0 0 0  radius 1.9 } }";
    let shell = scene(GAS, "", &format!("Group {{ MaterialIndex hot {shell} }}"));
    let pdf = |w: Vec3| shell.emissive_volumes().pdf(Vec3::ZERO, w);
    let even = 0.25 / std::f32::consts::PI;
    assert!((pdf(Vec3::X) / even - 1.0).abs() < 0.3 && pdf(Vec3::new(0.6, 0.0, 0.8)) > 0.5 * even);
}

/// While the shutter is open a body is in all places that it comes to.
#[test]
fn bodies_that_move_are_found() {
    let ball =
        "Transform { Motion { key 0 { }  key 1 { Translate 4 0 0 } } Sphere { center -2 0 0  radius 0.5 } }";
    let scene = scene(GAS, "", &format!("Group {{ MaterialIndex hot {ball} }}"));
    for x in [-2.0, 0.0, 2.0] {
        let share = share_near(&scene, FROM, Vec3::new(x, 0.0, 0.0), 0.5);
        assert!(share > 0.08, "{x}: {share}");
    }
}

/// The air, gas within glass, what gives nothing: none of them; of many bodies the brightest.
#[test]
fn what_is_not_drawn() {
    let ball = "Sphere { center 0 0 0  radius 1 }";
    let none = [
        scene("Medium gas { emission 1  sigma_a 1 } exterior gas", "", ""),
        scene(GAS, "Glass bulb { medium gas }", &format!("Group {{ MaterialIndex bulb {ball} }}")),
        scene("Medium gas { sigma_a 1 }", "", &format!("Group {{ MaterialIndex hot {ball} }}")),
        scene("Medium gas { emission 0 }", "", &format!("Group {{ MaterialIndex hot {ball} }}")),
    ];
    for (i, scene) in none.iter().enumerate() {
        assert!(scene.emissive_volumes().is_empty(), "{i}");
    }
    let balls: String = (0..100)
        .map(|i| {
            format!("Sphere {{ center {} 0 0  radius {} }} ", 3 * i, 0.1 + 0.01 * f64::from(i * 37 % 100))
        })
        .collect();
    let many = scene(GAS, "", &format!("Group {{ MaterialIndex hot {balls} }}"));
    let above = |i: i32| many.emissive_volumes().pdf(Vec3::new(3.0 * i as f32, 5.0, 0.0), Vec3::NEG_Y);
    let found = (0..100).filter(|&i| above(i) > 0.0);
    assert!(found.clone().all(|i| i * 37 % 100 >= 36) && found.count() == 64);
}
