//! Textures in the space of the object go where the object goes.

use kajo_math::rng::Stream;
use kajo_math::{Affine3A, Ray, Vec2, Vec3, warp};
use kajo_scene::{Diagnostics, Limits, MemoryAssets, SceneDesc};

use super::{CompileOptions, compile};
use crate::scene::{RayEvent, Scene};

/// A group whose material 0 shows a texture `t` of clouds `c`.
fn scene(texture: &str, group: &str, objects: usize) -> Scene {
    let text = format!(
        "PerspectiveCamera {{ center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30 }}
         Textures {{ Clouds c {{ octaves 3  size 0.4 }} Placed t {{ texture c {texture} }} }}
         Materials {{ Material {{ diffuseColor t }} }} Group {{ MaterialIndex 0 {group} }}"
    );
    let mut parsed = SceneDesc::parse_str(&text);
    let limits = Limits { objects, ..Limits::default() };
    let options = CompileOptions { limits, ..CompileOptions::default() };
    let mut said = Diagnostics::default();
    let scene = compile(&mut parsed.desc, &MemoryAssets::new(), &options, &mut said);
    scene.unwrap_or_else(|| panic!("{texture}: {:?}", said.iter().map(|d| &d.message).collect::<Vec<_>>()))
}

const USUAL: usize = 10_000_000;

/// What is seen along a ray from outside to the unit ball at the origin, which `world_from_ball` puts into the world.
fn seen(scene: &Scene, world_from_ball: &Affine3A, towards: Vec3, time: f32) -> f32 {
    let from = world_from_ball.transform_point3(1.001 * towards);
    let to = world_from_ball.transform_point3(Vec3::ZERO);
    let ray = Ray { time, ..Ray::new(from, (to - from).normalize()) };
    let RayEvent::Surface(at) = scene.trace(&ray) else { panic!("the ray begins before the ball") };
    scene.appearance.phong(at.material, &scene.texture_context(&at)).diffuse.to_rgb()[0]
}

fn directions() -> impl Iterator<Item = Vec3> {
    (0..100u32).map(|i| {
        let s = Stream::new(5, [i, 0], 0);
        warp::uniform_sphere(Vec2::new(s.uniform(0), s.uniform(1)))
    })
}

const BALL: &str = "Sphere { center 0 0 0  radius 1 }";

/// The words of operations, and what they do.
fn operations() -> (&'static str, Affine3A) {
    let map = Affine3A::from_translation(Vec3::new(5.0, -2.0, 1.0))
        * Affine3A::from_rotation_z(40f32.to_radians())
        * Affine3A::from_rotation_x(70f32.to_radians())
        * Affine3A::from_scale(Vec3::new(1.5, 0.7, 1.1));
    ("Translate 5 -2 1  ZRotate 40  XRotate 70  Scale 1.5 0.7 1.1", map)
}

/// By how much two functions of directions differ at most.
fn difference(a: impl Fn(Vec3) -> f32, b: impl Fn(Vec3) -> f32) -> f32 {
    directions().map(|d| (a(d) - b(d)).abs()).fold(0.0, f32::max)
}

#[test]
fn what_is_transformed_takes_its_texture_along() {
    let (words, map) = operations();
    let group = format!("{BALL} Transform {{ {words} {BALL} }}");
    for projection in
        ["solid", "planar", "spherical", "cylindrical", "cubic", "triplanar", "camera angle 150"]
    {
        for (space, follows) in [("object", true), ("world", false)] {
            let scene = scene(&format!("space {space}  projection {projection}"), &group, USUAL);
            let there = |d| seen(&scene, &map, d, 0.0);
            let off = difference(|d| seen(&scene, &Affine3A::IDENTITY, d, 0.0), there);
            assert!(if follows { off < 2e-3 } else { off > 0.1 }, "{space} {projection}: {off}");
        }
    }
}

#[test]
fn instances_have_it_flat_and_nested() {
    let (words, map) = operations();
    let second = Affine3A::from_translation(Vec3::new(-6.0, 3.0, 0.0)) * Affine3A::from_rotation_y(1.0);
    let degrees = 1f32.to_degrees();
    let others: String = (0..70).map(|i| format!("Sphere {{ center {i} 20 0  radius 0.1 }} ")).collect();
    let group = format!(
        "Define ball {{ MaterialIndex 0 {BALL} {others} }} {BALL} Transform {{ {words} Instance ball }}
         Transform {{ Translate -6 3 0  YRotate {degrees} Instance ball }}"
    );
    for objects in [USUAL, 400] {
        let scene = scene("space object", &group, objects);
        let is_nested = scene.geometry.aggregate.nested().is_some();
        assert_eq!(is_nested, objects == 400);
        let first = |d| seen(&scene, &Affine3A::IDENTITY, d, 0.0);
        for map in [map, second] {
            let off = difference(first, |d| seen(&scene, &map, d, 0.0));
            assert!(off < 2e-3, "{objects}: {off}");
        }
    }
}

#[test]
fn what_moves_has_the_same_texture_at_all_times() {
    let group = format!(
        "Transform {{ Motion {{ key 0 {{ Translate 0 0 0  ZRotate 0 }} key 1 {{ Translate 3 1 0  ZRotate 80 }} }} {BALL} }}"
    );
    let at = |t: f32| {
        Affine3A::from_translation(t * Vec3::new(3.0, 1.0, 0.0))
            * Affine3A::from_rotation_z((80.0 * t).to_radians())
    };
    for projection in ["solid", "cubic", "triplanar"] {
        for space in ["object", "world"] {
            let scene = scene(&format!("space {space}  projection {projection}"), &group, USUAL);
            for t in [0.25, 0.5, 1.0] {
                let off = difference(|d| seen(&scene, &at(0.0), d, 0.0), |d| seen(&scene, &at(t), d, t));
                assert!(off < 2e-3, "{space} {projection} {t}: {off}");
            }
        }
    }
}
