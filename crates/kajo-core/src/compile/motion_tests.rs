//! Scenes in which things move.

use kajo_color::Wavelengths;
use kajo_math::rng::Stream;
use kajo_math::{Ray, Vec2, Vec3, warp};

use super::tests::{compiled, scene};
use crate::Scene;
use crate::ids::ObjectId;
use crate::light::{LightChoice, LightLiSample, LightPoint, Receiver};
use crate::scene::{Interaction, RayEvent};

const CAMERA: &str = "PerspectiveCamera { center 0 0 10 direction 0 0 -1 up 0 1 0 angle 30 }\n";
const MATERIALS: &str = "Materials { Material grey { diffuseColor 0.5 0.5 0.5 }
    Material emitter { diffuseColor 0 0 0  emission 1 1 1 } }\n";

/// One of each shape, lights and not.
const SHAPES: &str = "MaterialIndex emitter
    Sphere { center 0.4 0 0  radius 0.5 }
    Cone { base -1 0 0  top -1 0.8 0.1  radius 0.4  topRadius 0.1 }
    Disk { center 0 1 0  normal 0.2 1 0  radius 0.4  innerRadius 0.1 }
    Quad { corner 1 1 0  edge1 0.6 0 0.2  edge2 0.1 0.5 0 }
    Triangle { vertex0 -1 -1 0  vertex1 -0.3 -1 0.3  vertex2 -0.6 -0.4 0 }
    MaterialIndex grey
    Box { min 0.4 -1 -0.3  max 0.9 -0.6 0.2 }";

fn group(content: &str) -> Scene {
    scene(&format!("{CAMERA}{MATERIALS}Group {{ MaterialIndex grey {content} }}"))
}

/// Everything moved, turned and stretched from one pose to another.
fn moving() -> Scene {
    group(&format!(
        "Transform {{ Motion {{ key 0 {{ Translate -1 0 0  Scale 1 1 1 }}
            key 1 {{ Translate 1 0.5 -1  ZRotate 80  Scale 1.5 0.8 1.2 }} }} Group {{ {SHAPES} }} }}"
    ))
}

/// The same at rest at a moment.
fn resting(t: f32) -> Scene {
    let mix = |a: f32, b: f32| a + t * (b - a);
    group(&format!(
        "Transform {{ Translate {} {} {}  ZRotate {}  Scale {} {} {} Group {{ {SHAPES} }} }}",
        mix(-1.0, 1.0),
        0.5 * t,
        -t,
        80.0 * t,
        mix(1.0, 1.5),
        mix(1.0, 0.8),
        mix(1.0, 1.2)
    ))
}

fn random(k: u32) -> impl Fn(u32) -> f32 {
    let stream = Stream::new(17, [k, 0], 0);
    move |d| stream.uniform(d)
}

/// A ray through the neighbourhood of the origin at some time.
fn ray(k: u32, time: f32) -> Ray {
    let u = random(k);
    let to = 3.0 * Vec3::new(u(0), u(1), u(2)) - 1.5;
    let from = 6.0 * warp::uniform_sphere(Vec2::new(u(3), u(4)));
    Ray { time, ..Ray::new(from, (to - from).normalize()) }
}

fn met(scene: &Scene, ray: &Ray) -> Option<Interaction> {
    match scene.trace(ray) {
        RayEvent::Surface(at) => Some(at),
        RayEvent::Escaped => None,
    }
}

#[test]
fn at_each_moment_things_are_where_they_would_be_at_rest() {
    let moving = moving();
    assert!(moving.moves() && moving.geometry.aggregate.has_moving());
    let mut hits = 0;
    for step in 0..=8u8 {
        let t = f32::from(step) / 8.0;
        let resting = resting(t);
        assert!(!resting.moves());
        for k in 0..400 {
            let ray = ray(k, t);
            let found = [&moving, &resting].map(|scene| met(scene, &ray));
            // Rays that graze an edge are decided by rounding.
            let ([Some(a), Some(b)], true) = (found, found[0].is_some() == found[1].is_some()) else {
                continue;
            };
            if a.object != b.object {
                continue;
            }
            hits += 1;
            assert!(
                a.point.p.distance(b.point.p) < 1e-4 && a.point.n.distance(b.point.n) < 1e-3,
                "{k} at {t}"
            );
            let uv = [moving.geometry.uv(&a), resting.geometry.uv(&b)];
            assert!((uv[0] - uv[1]).abs().min_element() < 1e-3, "{k} at {t}: {uv:?}");
            assert_eq!(
                moving.occluded(&ray.over(0.0, a.hit.t * 0.9)),
                resting.occluded(&ray.over(0.0, a.hit.t * 0.9))
            );
        }
    }
    assert!(hits > 600, "{hits}");
}

/// Light of a light chosen for a receiver; the density includes the choice.
fn sample_light(
    scene: &Scene,
    to: &Receiver,
    u: f32,
    place: Vec2,
    choice: LightChoice,
) -> Option<LightLiSample> {
    let chosen = scene.lighting.sampler.sample(to, u, choice)?;
    let sample = scene.sample_li(chosen.light, to, place, &Wavelengths::RGB, choice)?;
    Some(LightLiSample { pdf: sample.pdf * chosen.probability, ..sample })
}

#[test]
fn lights_are_sampled_where_they_are() {
    let moving = moving();
    let mut drawn = 0;
    // Not at the very start, where a ball at rest is a sphere and is drawn as one.
    for step in 1..=4u8 {
        let t = f32::from(step) / 4.0;
        let resting = resting(t);
        for k in 0..300 {
            let u = random(1000 + k);
            let p = 5.0 * Vec3::new(u(0), u(1), u(2)) - 2.5;
            let to = Receiver { p, n: Vec3::ZERO, time: t };
            let choice = LightChoice::Uniform;
            let draw = |scene: &Scene| sample_light(scene, &to, u(3), Vec2::new(u(4), u(5)), choice);
            let (Some(a), Some(b)) = (draw(&moving), draw(&resting)) else { continue };
            assert!(a.wi.distance(b.wi) < 2e-3, "{k} at {t}: {} {}", a.wi, b.wi);
            assert!((a.pdf / b.pdf - 1.0).abs() < 0.02, "{k} at {t}: {} {}", a.pdf, b.pdf);
            drawn += 1;
            // What is met in that direction has the density with which it was drawn.
            let Some(at) = met(&moving, &Ray { time: t, ..Ray::new(p, a.wi) }) else { continue };
            let Some(hit) = moving.surface_light(&at, a.wi, &Wavelengths::RGB) else { continue };
            if a.at.p().distance(at.point.p) < 1e-4 {
                let met = moving.pdf_li(hit.light, &to, &LightPoint::on(&at.point), a.wi, choice);
                assert!((met / a.pdf - 1.0).abs() < 0.02, "{k} at {t}: {met} {}", a.pdf);
            }
        }
    }
    assert!(drawn > 1000, "{drawn}");
}

#[test]
fn the_choice_of_lights_rules_none_out_at_any_time() {
    let spinning = group(
        "Transform { Motion { key 0 { } key 0.5 { YRotate 90 } key 1 { YRotate 180 } }
         MaterialIndex emitter Quad { corner -1 -1 1  edge1 2 0 0  edge2 0 2 0 } }
         Transform { Translate 9 0 0  Sphere { center 0 0 0  radius 1 } }",
    );
    for k in 0..500 {
        let u = random(k);
        let p = 8.0 * Vec3::new(u(0), u(1), u(2)) - 4.0;
        let to = Receiver { p, n: Vec3::ZERO, time: u(3) };
        let sample = sample_light(&spinning, &to, u(4), Vec2::new(u(5), u(6)), LightChoice::Tree);
        assert!(sample.is_some(), "from {p} at {}", to.time);
    }
}

/// Twenty things that move in their own way among as many that rest.
fn crowd() -> Scene {
    let mut text = "Plane { normal 0 1 0  offset -2 }".to_owned();
    for i in 0..20 {
        let u = random(500 + i);
        let v = |d: u32| format!("{} {} {}", 4.0 * u(d) - 2.0, 4.0 * u(d + 1) - 2.0, 4.0 * u(d + 2) - 2.0);
        text += &format!(
            "Sphere {{ center {}  radius 0.2 }}
             Transform {{ Translate {} Motion {{ key -0.2 {{ YRotate {} }} key 0.4 {{ Translate {} }} key 1.1 {{ XRotate {} }} }}
             Box {{ min -0.2 -0.1 -0.3  max 0.3 0.2 0.1 }} }}",
            v(0),
            v(3),
            170.0 * u(6),
            v(7),
            -170.0 * u(10)
        );
    }
    group(&text)
}

#[test]
fn trees_find_what_a_search_of_everything_finds() {
    let scene = crowd();
    let (mut hits, mut moved) = (0, 0);
    for k in 0..4000 {
        let ray = ray(k, random(k)(9));
        let brute = (0..scene.geometry.primitives.len() as u32).filter_map(|i| {
            let primitive = &scene.geometry.primitives[i as usize];
            let map = match primitive.pose.still_in(&scene.geometry.transforms) {
                Some(map) => *map,
                None => primitive.pose.moving_in(&scene.geometry.motions).unwrap().at(ray.time),
            };
            let own = if primitive.pose.is_identity() { ray } else { map.ray_in_object(&ray) };
            scene.geometry.shapes.hit(primitive.shape, &own).map(|hit| (hit.t, ObjectId::from_index(i)))
        });
        let nearest = brute.min_by(|a, b| a.0.total_cmp(&b.0));
        let found = met(&scene, &ray);
        assert_eq!(found.map(|at| (at.hit.t, at.object)), nearest, "ray {k}");
        assert_eq!(scene.occluded(&ray), nearest.is_some());
        let mut crossings = Vec::new();
        scene.crossings(&ray, |i, hit| crossings.push((hit.t, i)));
        assert_eq!(crossings.into_iter().min_by(|a, b| a.0.total_cmp(&b.0)), nearest);
        hits += u32::from(found.is_some());
        moved += u32::from(
            found.is_some_and(|at| scene.geometry.is_moving(&scene.geometry.primitives[at.object.index()])),
        );
    }
    assert!(hits > 2000 && moved > 300, "{hits} {moved}");
}

#[test]
fn the_shutter_says_which_part_of_a_motion_is_seen() {
    let through = |shutter: &str| {
        scene(&format!(
            "PerspectiveCamera {{ {shutter} center 0 0 10 direction 0 0 -1 up 0 1 0 angle 30 }} {MATERIALS}
             Group {{ MaterialIndex grey Transform {{ Motion {{ key 0 {{ }} key 2 {{ Translate 4 0 0 }} }}
             Sphere {{ center 0 0 0  radius 0.1 }} }} }}"
        ))
    };
    let sees = |scene: &Scene, x: f32, time: f32| {
        met(scene, &Ray { time, ..Ray::new(Vec3::new(x, 0.0, 5.0), Vec3::NEG_Z) }).is_some()
    };
    let usual = through("");
    assert!(sees(&usual, 0.0, 0.0) && sees(&usual, 2.0, 1.0) && !sees(&usual, 2.0, 0.5));
    let late = through("shutter 1 1.5");
    assert!(sees(&late, 2.0, 0.0) && sees(&late, 2.5, 0.5) && sees(&late, 3.0, 1.0));
    for (shutter, x) in [("shutter 0.5 0.5", 1.0), ("shutter 5 9", 4.0), ("shutter -3 -2", 0.0)] {
        let still = through(shutter);
        assert!(!still.moves() && !still.geometry.aggregate.has_moving(), "{shutter}");
        assert!([0.0, 0.4, 1.0].iter().all(|&time| sees(&still, x, time)), "{shutter}");
        assert!((still.geometry.bounds().center().x - x).abs() < 1e-5);
    }
}

#[test]
fn motions_nest_and_instances_share_their_shapes() {
    let nested = group(
        "Define pair { Sphere { center 1 0 0  radius 0.1 }
           Transform { Motion { key 0 { } key 1 { Translate 0 0 1 } } Sphere { center 2 0 0  radius 0.1 } } }
         Transform { Translate 0 1 0  Motion { key 0 { } key 1 { ZRotate 90 } }
           Instance pair { Motion { key 0 { } key 1 { Translate 1 0 0 } }  UniformScale 2 } }
         Instance pair",
    );
    assert_eq!(nested.geometry.shapes.spheres.len(), 2, "definitions are not copied");
    assert_eq!((nested.geometry.primitives.len(), nested.geometry.motions.len()), (4, 3));
    // At the end: (1, 0, 0) scaled, moved along x, turned to y, lifted.
    for (k, center) in [(0, Vec3::new(0.0, 4.0, 0.0)), (1, Vec3::new(0.0, 6.0, 2.0)), (2, Vec3::X)] {
        let ray = Ray { time: 1.0, ..Ray::new(center + 5.0 * Vec3::Y, Vec3::NEG_Y) };
        let at = met(&nested, &ray).unwrap_or_else(|| panic!("part {k}"));
        assert_eq!((at.object.index(), (at.point.p - center).x.abs() < 1e-5), (k, true));
    }
}

#[test]
fn cameras_move_and_are_found_where_they_are() {
    let camera = |motion: &str| {
        scene(&format!(
            "PerspectiveCamera {{ center 0 1 10 direction 0 0 -1 up 0 1 0 angle 30 aperture 0.1 focus 4 {motion} }}"
        ))
        .output.camera
    };
    let (moving, still) = (camera("Motion { key 0 { } key 1 { Translate 2 0 0 YRotate 60 } }"), camera(""));
    assert!(moving.moves() && !still.moves() && moving.has_lens());
    assert!(!camera("shutter 1 1 Motion { key 0 { } key 1 { Translate 2 0 0 YRotate 60 } }").moves());
    let m = kajo_math::Affine3A::from_translation(Vec3::X)
        * kajo_math::Affine3A::from_rotation_y(30f32.to_radians());
    for k in 0..50 {
        let u = random(k);
        let (at, lens) = (2.0 * Vec2::new(u(0), u(1)) - 1.0, Vec2::new(u(2), u(3)));
        let [a, b] = [&moving, &still].map(|camera| camera.ray(at, 1.5, lens, 0.5).expect("a ray"));
        assert!(
            a.o.distance(m.transform_point3(b.o)) < 1e-5 && a.d.distance(m.transform_vector3(b.d)) < 1e-5
        );
        assert_eq!((a.time, b.time), (0.5, 0.5));
        let p = a.at(4.0);
        let seen = moving.importance(a.o, a.d, 1.5, 0.5).expect("in the picture");
        assert!(seen.at.distance(at) < 1e-3, "{k}: {} {at}", seen.at);
        let way = moving.connect(p, lens, 1.5, 0.5).expect("in the picture");
        assert!(way.at.distance(at) < 0.05 && way.wi.distance(-a.d) < 1e-2, "{k}");
        let projected = moving.project(a.at(4.0 / seen_cosine(&a, &m)).as_dvec3(), 1.5, 0.5).expect("seen");
        assert!(projected.as_vec2().distance(at) < 1e-3, "{k}: {projected} {at}");
    }
}

/// The cosine of a ray with the direction of the moved camera.
fn seen_cosine(ray: &Ray, m: &kajo_math::Affine3A) -> f32 {
    ray.d.dot(m.transform_vector3(Vec3::NEG_Z))
}

#[test]
fn mistakes_in_motions_are_told() {
    let said = |content: &str| {
        let text = format!(
            "{CAMERA}{MATERIALS}Group {{ MaterialIndex grey Transform {{ {content}
            Sphere {{ center 0 0 0  radius 1 }} }} }}"
        );
        compiled(&text).1.into_iter().map(|(_, message)| message).collect::<Vec<_>>().join("; ")
    };
    for (content, expected) in [
        ("Motion { key 0 { } }", "two keys or more"),
        ("Motion { key 1 { } key 0 { Translate 1 0 0 } }", "order of time"),
        ("Motion { key 0 { } key 1 { Scale 1 0 1 } }", "flat"),
        ("Motion { key 0 { } key 1 { Scale 1 -1 1 } }", "mirror image"),
        ("Motion { key 0 { } key { Translate 1 0 0 } }", "key"),
        ("Motion { key 0 { } kay 1 { } }", "kay"),
        ("Motion { key 0 { } key 1 { ZRotate 360 } }", "moves nothing"),
        ("Motion { key 0 { } key 1 { ZRotate 180 } }", "either way"),
    ] {
        assert!(said(content).contains(expected), "{content}: {}", said(content));
    }
    assert_eq!(said("Motion { key 0 { } key 1 { ZRotate 170  Translate 1 0 0 } }"), "");
    let camera = |keys: &str| {
        let text = format!("PerspectiveCamera {{ center 0 0 10 direction 0 0 -1 up 0 1 0 angle 30 {keys} }}");
        compiled(&text).1.into_iter().map(|(_, message)| message).collect::<Vec<_>>().join("; ")
    };
    assert!(camera("Motion { key 0 { } key 1 { UniformScale 2 } }").contains("not stretched"));
    assert!(camera("shutter 2 1").contains("closes after it opens"));
    assert_eq!(camera("shutter 1 2  Motion { key 0 { } key 1 { YRotate 20 } }"), "");
}
