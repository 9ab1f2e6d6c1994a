//! Set operations whose operands move, as they are written.

use kajo_color::Wavelengths;
use kajo_math::rng::Stream;
use kajo_math::{Aabb, Ray, Vec2, Vec3, warp};

use super::tests::scene;
use crate::Scene;
use crate::interaction::SurfacePoint;
use crate::light::{LightChoice, LightPoint, Receiver};
use crate::scene::{Immersion, Interaction, RayEvent};

const HEAD: &str = "PerspectiveCamera { center 0 0 10 direction 0 0 -1 up 0 1 0 angle 30 }
Background { color 0 0 0 }
Textures { Brick wall { size 0.4  mortar 0  variation 1 }
  Ramp stone { texture wall  stop 0 1 0 0  stop 0.5 0 1 0  stop 1 0 0 1 } }
Materials { Matte grey { color stone } Material emitter { diffuseColor 0 0 0  emission 1 1 1 }
  Glass glass { indexOfRefraction 1.5 } }\n";

/// A solid whose operands are placed by two transforms, within a third.
fn carved([outer, a, b]: [&str; 3], material: &str) -> Scene {
    scene(&format!(
        "{HEAD}Group {{ MaterialIndex {material}
         Transform {{ {outer} Difference {{
           Merge {{ Box {{ min -0.8 -0.8 -0.8  max 0.8 0.8 0.8 }}
             Transform {{ {a} Torus {{ center 0 0 0.8  axis 0 0 1  majorRadius 0.6  minorRadius 0.2 }} }} }}
           Transform {{ {b} Sphere {{ center 0.4 0.4 0.8  radius 0.5 }}
             Plane {{ normal 0 1 0  offset -0.6 }} }}
           Cylinder {{ base 0 0 -2  top 0 0 2  radius 0.2 }} }} }} }}"
    ))
}

fn moving(material: &str) -> Scene {
    carved(
        [
            "Motion { key 0 { } key 1 { Translate 0.4 0.2 -1  YRotate 40 } }",
            "Motion { key 0 { Scale 1 1 1 } key 1 { Translate 0 0 0.6  Scale 1.2 0.9 1.4 } }",
            "Motion { key 0 { Translate -0.3 0 0 } key 1 { Translate 0.3 0.2 0.1 ZRotate 50 } }",
        ],
        material,
    )
}

fn resting(t: f32, material: &str) -> Scene {
    let mix = |a: f32, b: f32| a + t * (b - a);
    let outer = format!("Translate {} {} {}  YRotate {}", 0.4 * t, 0.2 * t, -t, 40.0 * t);
    let a = format!("Translate 0 0 {}  Scale {} {} {}", 0.6 * t, mix(1.0, 1.2), mix(1.0, 0.9), mix(1.0, 1.4));
    let b = format!("Translate {} {} {} ZRotate {}", mix(-0.3, 0.3), 0.2 * t, 0.1 * t, 50.0 * t);
    carved([&outer, &a, &b], material)
}

fn ray(k: u32, time: f32) -> Ray {
    let s = Stream::new(23, [k, 0], 0);
    let to = 2.4 * Vec3::new(s.uniform(0), s.uniform(1), s.uniform(2)) - 1.2;
    let from = 6.0 * warp::uniform_sphere(Vec2::new(s.uniform(3), s.uniform(4)));
    Ray { time, ..Ray::new(from, (to - from).normalize()) }
}

fn met(scene: &Scene, ray: &Ray) -> Option<Interaction> {
    match scene.trace(ray) {
        RayEvent::Surface(at) => Some(at),
        RayEvent::Escaped => None,
    }
}

#[test]
fn at_each_moment_the_solid_is_what_it_would_be_at_rest() {
    let moving = moving("grey");
    assert!(moving.moves() && moving.geometry.aggregate.has_moving());
    let (mut hits, mut different) = (0, 0);
    for step in 0..=8u8 {
        let t = f32::from(step) / 8.0;
        let resting = resting(t, "grey");
        assert!(!resting.moves());
        for k in 0..500 {
            let ray = ray(k, t);
            let [a, b] = [&moving, &resting].map(|scene| met(scene, &ray));
            let (Some(a), Some(b)) = (a, b) else {
                different += u32::from(a.is_some() != b.is_some());
                continue;
            };
            // Rays that graze an edge are decided by rounding.
            if a.hit.part != b.hit.part || (a.hit.t - b.hit.t).abs() > 1e-3 {
                different += 1;
                continue;
            }
            hits += 1;
            let [near, off] = [a.point.p.distance(b.point.p), a.point.n.distance(b.point.n)];
            assert!(near < 1e-4 && off < 1e-3, "{k} at {t}: {near} {off}");
            let uv = [moving.geometry.uv(&a), resting.geometry.uv(&b)];
            assert!((uv[0] - uv[1]).abs().min_element() < 1e-3, "{k} at {t}: {uv:?}");
            let [da, db] = [moving.geometry.tangents(&a), resting.geometry.tangents(&b)];
            let apart = (da.dpdu - db.dpdu).length() + (da.dpdv - db.dpdv).length();
            let size = 1.0 + db.dpdu.length() + db.dpdv.length();
            assert!(apart < 4e-3 * size, "{k} at {t}: {da:?} {db:?}");
            let beyond = ray.over(0.0, a.hit.t * 1.001 + 1e-3);
            assert!(moving.occluded(&beyond) && !moving.occluded(&ray.over(0.0, a.hit.t * 0.999)));
        }
    }
    assert!(hits > 1500 && different < 12, "{hits} {different}");
}

/// Patterns go along with the operand that they are on.
#[test]
fn patterns_are_painted_on_the_operands() {
    let moving = moving("grey");
    let (mut same, mut different, mut moved) = (0, 0, 0);
    for k in 0..3000 {
        let ray = ray(k, 0.7);
        let Some(at) = met(&moving, &ray) else { continue };
        let color = |at: &Interaction| {
            moving.appearance.phong(at.material, &moving.texture_context(at)).diffuse.to_rgb()
        };
        // Where this point of the operand is when the shutter opens.
        let then = SurfacePoint { p: moving.geometry.point_at(&at, 0.0), ..at.point };
        let unmoved = Interaction { time: 0.0, ..at };
        let near = |a: [f32; 3], b: [f32; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-4);
        match near(color(&at), color(&Interaction { point: then, ..unmoved })) {
            true => same += 1,
            false => different += 1,
        }
        moved += u32::from(!near(color(&at), color(&unmoved)));
    }
    // A point next to a joint may be on its other side.
    assert!(same > 800 && different < 5 && moved > 400, "{same} {different} {moved}");
}

#[test]
fn lights_of_moving_operands_are_where_they_are_seen() {
    let wavelengths = Wavelengths::RGB;
    let moving = moving("emitter");
    let (mut drawn, mut visible, mut missed) = (0, 0, 0);
    for step in 0..=4u8 {
        let time = f32::from(step) / 4.0;
        for k in 0..2000 {
            let s = Stream::new(29, [k, u32::from(step)], 0);
            let p = 5.0 * warp::uniform_sphere(Vec2::new(s.uniform(0), s.uniform(1)));
            let to = Receiver { p, n: Vec3::ZERO, time };
            let choice = LightChoice::Uniform;
            let Some(chosen) = moving.lighting.sampler.sample(&to, s.uniform(2), choice) else { continue };
            let place = Vec2::new(s.uniform(3), s.uniform(4));
            let Some(light) = moving.sample_li(chosen.light, &to, place, &wavelengths, choice) else {
                continue;
            };
            drawn += 1;
            // What was drawn is on the surface at that moment, or behind another piece of it.
            let Some(at) = met(&moving, &Ray { time, ..Ray::new(p, light.wi) }) else {
                missed += 1;
                continue;
            };
            let Some(seen) = moving.surface_light(&at, light.wi, &wavelengths) else { continue };
            if light.at.p().distance(at.point.p) < 1e-4 {
                let density = moving.pdf_li(seen.light, &to, &LightPoint::on(&at.point), light.wi, choice);
                let expected = light.pdf * chosen.probability;
                assert!((density / expected - 1.0).abs() < 2e-2, "{k} at {time}: {density} {expected}");
                visible += 1;
            }
        }
    }
    assert!(visible > 1000 && missed < 5, "{drawn} {visible} {missed}");
}

#[test]
fn cameras_within_moving_glass_know_where_they_start() {
    let moving = moving("glass");
    let around = |p: Vec3| Aabb { min: p - 0.01, max: p + 0.01 };
    assert_eq!(moving.geometry.immersion(&around(Vec3::ZERO)), Immersion::Moving);
    assert_eq!(moving.geometry.immersion(&around(Vec3::splat(9.0))), Immersion::Outside);
    // The torus comes to z = 1.7 before it is turned and moved away.
    let bounds = moving.geometry.bounds();
    assert!(bounds.max.z > 1.0 && bounds.is_finite(), "{bounds:?}");
    for step in 0..=4u8 {
        let time = f32::from(step) / 4.0;
        let resting = resting(time, "glass");
        let inside = |scene: &Scene, p: Vec3| {
            let mut inside = false;
            scene.crossings(&Ray { time, ..Ray::new(p, Vec3::new(0.3, 0.9, 0.31)) }, |_, _| inside = !inside);
            inside
        };
        let mut within = 0;
        for k in 0..600 {
            let s = Stream::new(31, [k, 0], 0);
            let p = 2.4 * Vec3::new(s.uniform(0), s.uniform(1), s.uniform(2)) - 1.2;
            assert_eq!(inside(&moving, p), inside(&resting, p), "{p} at {time}");
            within += u32::from(inside(&moving, p));
        }
        assert!(within > 60, "{within}");
    }
}
