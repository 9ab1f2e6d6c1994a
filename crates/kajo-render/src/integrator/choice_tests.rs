//! What `integrator auto` takes of scenes that are made for one integrator each.

use kajo_core::scene::Scene;
use kajo_scene::MemoryAssets;

use super::tests::scene_with;
use super::{CHOICES, IntegratorSpec, choose};

const MATERIALS: &str = "Materials {
    Matte white { color 0.7 0.7 0.7 }
    Glass glass { indexOfRefraction 1.5 }
    Metal mirror { metal silver }
    Matte bright { color 0 0 0  emission 20 20 20 }
    Matte dim { color 0 0 0  emission 2 2 2 }
}";
const FLOOR: &str = "MaterialIndex white  Quad { corner -4 -1 4  edge1 8 0 0  edge2 0 0 -8 }";
const BALL: &str = "MaterialIndex glass  Sphere { center 0 0 0  radius 0.8 }";

fn scene(around: &str, things: &str) -> Scene {
    let background = if around.contains("Background") { "" } else { "Background { color 0 0 0 }" };
    let text = format!(
        "PerspectiveCamera {{ center 0 2 9  direction 0 -0.25 -1  up 0 1 0  angle 40 }}
         {background} {around} {MATERIALS} Group {{ {FLOOR} {things} }}"
    );
    scene_with(&text, &MemoryAssets::new())
}

#[track_caller]
fn check(around: &str, things: &str, expected: &str, why: &str) {
    let scene = scene(around, things);
    let choice = choose(&scene);
    assert_eq!(choice.integrator.name.0, expected, "{}", choice.why);
    assert!(choice.why.contains(why), "{}", choice.why);
    // The scene keeps the answer.
    assert_eq!(choose(&scene).why, choice.why);
}

#[test]
fn what_lights_shine_on_is_for_paths() {
    let quad = "MaterialIndex bright  Quad { corner -1 4 1  edge1 0 0 -2  edge2 2 0 0 }";
    check("", quad, "path", "lit by lights themselves");
    check(
        "Lights { PointLight { position 0 4 0  intensity 9 9 9 } }",
        "",
        "path",
        "lit by lights themselves",
    );
}

#[test]
fn light_of_points_through_glass_is_for_both_ends() {
    let point = "Lights { PointLight { position 0 4 0  intensity 9 9 9 } }";
    check(point, BALL, "bidirectional", "from points");
}

/// The caustic of a ball on the floor, seen from above and, but for a rim, in a mirror; and the same floor in the mirror without the ball.
#[test]
fn caustics_in_a_mirror_are_for_merging() {
    let point = "Lights { PointLight { position 0 4 0  intensity 9 9 9 } }";
    let mirror = "MaterialIndex mirror  Quad { corner -4 -1 -2  edge1 8 0 0  edge2 0 6 0 }
        MaterialIndex white  Quad { corner -4 -1 2.5  edge1 8 0 0  edge2 0 1.2 0 }";
    check(point, &format!("{BALL} {mirror}"), "vcm", "merged paths alone");
    check(point, BALL, "bidirectional", "from points");
    check("Background { color 1 1 1 }", &format!("{BALL} {mirror}"), "path", "all around");
}

#[test]
fn a_light_before_a_mirror_is_for_both_ends_and_one_in_glass_for_merging() {
    let emitter = "MaterialIndex bright  Quad { corner -0.5 4 -0.5  edge1 1 0 0  edge2 0 0 1 }
        MaterialIndex mirror  Quad { corner -2 5 -2  edge1 4 0 0  edge2 0 0 4 }";
    check("", emitter, "bidirectional", "much of its light");
    // What the ball shows of the floor is lit through it.
    let bulb = format!("{BALL}  MaterialIndex bright  Sphere {{ center 0 0 0  radius 0.2 }}");
    check("", &bulb, "vcm", "merged paths alone");
    check(
        "",
        "MaterialIndex bright  Sphere { center 0 0 0  radius 0.2 }",
        "path",
        "lit by lights themselves",
    );
}

#[test]
fn a_room_lit_by_its_ceiling_is_for_both_ends() {
    // A light over a shade, below a ceiling.
    let room = "MaterialIndex white  Quad { corner -9 6 -9  edge1 18 0 0  edge2 0 0 18 }
        Quad { corner -9 2.5 -9  edge1 18 0 0  edge2 0 0 18 }
        MaterialIndex bright  Quad { corner -0.5 3 -0.5  edge1 0 0 1  edge2 1 0 0 }";
    let up = room.replace("edge1 0 0 1  edge2 1 0 0", "edge1 1 0 0  edge2 0 0 1");
    let ajar = up.replace("corner -9 2.5 -9  edge1 18 0 0", "corner -9 2.5 -9  edge1 15 0 0");
    check("", &ajar, "bidirectional", "little of what is seen");
}

#[test]
fn a_sky_is_for_paths() {
    check("Background { color 1 1 1 }", BALL, "path", "all around");
}

#[test]
fn what_one_integrator_alone_knows_is_for_that_one() {
    let quad = "MaterialIndex dim  Quad { corner -1 4 1  edge1 0 0 -2  edge2 2 0 0 }";
    let moving = format!(
        "{quad} Lorentz {{ velocity 0.5 0 0  MaterialIndex white  Sphere {{ center 0 0 0  radius 0.5 }} }}"
    );
    check("", &moving, "path", "speeds");
    let point = "PointLight { position 0 4 0  color 1 1 1 }";
    check(&format!("Lights {{ {point} }}"), BALL, "classic", "classic formula");
    check(&format!("Fog {{ color 0.5 0.5 0.5  density 0.1 }} Lights {{ {point} }}"), "", "classic", "fog");
    let fading = "Lights { PointLight { position 0 4 0  intensity 1 1 1 } }";
    check(
        &format!("Background {{ color 0 0 0  ambientLight 1 1 1 }} {fading}"),
        BALL,
        "classic",
        "ambient light",
    );
    check("", "", "path", "nothing in it gives light");
    check("Media { Medium gas { emission 1  sigma_a 1 } exterior gas }", "", "path", "media that emit");
}

#[test]
fn all_that_may_be_said_is_an_integrator_but_for_the_first() {
    assert_eq!(CHOICES[0], "auto");
    assert!(CHOICES.is_sorted_by(|a, b| a < b), "{CHOICES:?}");
    for name in &CHOICES[1..] {
        assert!(IntegratorSpec::named(kajo_core::settings::IntegratorName(name)).is_some());
    }
}
