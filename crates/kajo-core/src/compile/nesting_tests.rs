//! Nested instances beside the flat list of the same objects.

use kajo_math::rng::Stream;
use kajo_math::{Ray, Vec3};
use kajo_scene::{MemoryAssets, MemoryBudget};

use super::*;
use crate::ids::ObjectId;
use crate::scene::{Interaction, RayEvent};
use crate::{ElementContent, NestedElement};

const CAMERA: &str = "PerspectiveCamera { center 0 0 10 direction 0 0 -1 up 0 1 0 angle 30 }\n";
const MATERIALS: &str = "Materials { Material grey { diffuseColor 0.5 0.5 0.5 }
    Material { diffuseColor 0 1 0  transparentColor 0.5 0.6 0.7 }  Material emitter { diffuseColor 0 0 0  emission 1 1 1 } }\n";

/// A scene of a group, or what is wrong with it, where instances are nested that make more than a sixteenth of `objects`.
fn compiled(group: &str, objects: usize) -> (Option<Scene>, Vec<String>) {
    let mut parsed = SceneDesc::parse_str(&format!("{CAMERA}{MATERIALS}Group {{ {group} }}"));
    let limits = Limits { objects, ..Limits::default() };
    let options = CompileOptions { limits, ..CompileOptions::default() };
    let mut diagnostics = parsed.diagnostics;
    let scene = compile(&mut parsed.desc, &MemoryAssets::new(), &options, &mut diagnostics);
    (scene, diagnostics.iter().map(|d| d.message.clone()).collect())
}

fn scene(group: &str, objects: usize) -> Scene {
    let (scene, said) = compiled(group, objects);
    scene.unwrap_or_else(|| panic!("{said:?}"))
}

/// Numbers in [-1, 1). Of the forests of seeds 23 to 39 half are hit by a twentieth of the rays; this one is.
fn signed(k: u32) -> impl Fn(u32) -> f32 {
    let stream = Stream::new(28, [k, 0], 0);
    move |d| 2.0 * stream.uniform(d) - 1.0
}

/// `n` lines, each with a random place, turn and stretch for what `line` makes of it.
fn scattered(n: u32, seed: u32, spread: f32, line: impl Fn(u32, &str) -> String) -> String {
    let each = |i: u32| {
        let x = signed(seed * 1000 + i);
        let [a, b, c] = [0, 1, 2].map(|k| spread * x(k));
        let mirror = if i.is_multiple_of(3) { -1.0 } else { 1.0 };
        let stretch = 0.8 + 0.3 * x(5);
        let operations = format!(
            "Translate {a} {b} {c}  YRotate {}  ZRotate {}  Scale {mirror} {stretch} 0.9",
            180.0 * x(3),
            40.0 * x(4)
        );
        line(i, &operations)
    };
    (0..n).map(each).collect()
}

/// Three levels of definitions under a few objects of the scene's own, 8,431 in all.
fn forest() -> String {
    let twig = scattered(70, 1, 1.0, |i, operations| {
        let x = signed(i);
        let shape = match i % 5 {
            0 => "Sphere { center 0 0 0 radius 0.12 }".to_owned(),
            1 => "Box { min -0.1 -0.05 -0.1 max 0.1 0.15 0.1 }".to_owned(),
            2 => "Cone { base 0 0 0 top 0 0.3 0.1 radius 0.1 topRadius 0.02 }".to_owned(),
            3 => "Disk { center 0 0 0 normal 0 1 0.3 radius 0.15 }".to_owned(),
            _ => format!("Triangle {{ vertex0 0 0 0 vertex1 0.3 0 {} vertex2 0 0.3 0.1 }}", x(9)),
        };
        let material = ["", "MaterialIndex 1", "MaterialIndex grey"][i as usize / 20 % 3];
        format!("{material} Transform {{ {operations} {shape} }}\n")
    });
    let tree = scattered(5, 2, 2.0, |_, operations| format!("Instance twig {{ {operations} }}\n"));
    let grove = scattered(6, 3, 8.0, |_, operations| format!("Instance tree {{ {operations} }}\n"));
    let forest = scattered(4, 4, 20.0, |i, operations| {
        format!("MaterialIndex {} Instance grove {{ {operations} }}\n", i % 2)
    });
    format!(
        "Define twig {{ {twig} }} Define tree {{ {tree} Sphere {{ center 0 0 0 radius 0.3 }} }} Define grove {{ {grove} }}
         MaterialIndex 0 Sphere {{ center 0 0 0 radius 1 }} {forest}
         Plane {{ normal 0 1 0 offset -30 }} Box {{ min 3 3 3 max 4 5 6 }}"
    )
}

fn rays(n: u32) -> impl Iterator<Item = Ray> {
    (0..n).map(|k| {
        let x = signed(50_000 + k);
        let far = if k % 4 == 0 { 4.0 } else { 1.0 };
        let o = far * 25.0 * Vec3::new(x(0), x(1), x(2));
        let to = 18.0 * Vec3::new(x(3), x(4), x(5));
        Ray::new(o, to - o).over(0.0, if k % 5 == 0 { 0.8 } else { f32::INFINITY })
    })
}

/// All that is known of a hit but the number of the object.
fn facts(scene: &Scene, at: &Interaction) -> String {
    let object = scene.geometry.object(at.object);
    format!("{:?} {:?} {:?} {:?} {object:?}", at.point, at.hit, at.material, scene.geometry.uv(at))
}

#[test]
fn nested_instances_are_the_flat_list_bit_for_bit() {
    for (far, n) in [(0.0, 10_000), (3000.7, 5_000)] {
        let there = format!("Transform {{ Translate {far} -{far} 0  Group {{ {} }} }}", forest());
        compare(&there, Vec3::new(far, -far, 0.0), n);
    }
}

/// Compares what rays find in both scenes of a forest.
fn compare(text: &str, there: Vec3, n: u32) {
    let (flat, nested) = (scene(text, 10_000_000), scene(text, 4_000));
    assert!(
        flat.geometry.aggregate.nested().is_none()
            && flat.geometry.primitives.len() == 4 * 6 * (5 * 70 + 1) + 3
    );
    assert_eq!(
        (nested.geometry.primitives.len(), nested.geometry.object_count()),
        (3, flat.geometry.object_count())
    );
    assert!(nested.geometry.transmits && flat.geometry.transmits);
    let (mut hits, mut within, mut passed) = (0, 0, 0);
    for ray in rays(n) {
        let ray = Ray { o: ray.o + there, ..ray };
        let event = |scene: &Scene| match scene.trace(&ray) {
            RayEvent::Surface(at) => Some(facts(scene, &at)),
            RayEvent::Escaped => None,
        };
        let found = event(&nested);
        assert_eq!(found, event(&flat), "{ray:?}");
        assert_eq!(nested.occluded(&ray), flat.occluded(&ray), "{ray:?}");
        let crossings = |scene: &Scene| {
            let mut all = Vec::new();
            scene.crossings(&ray, |i, hit| all.push(facts(scene, &scene.interaction(&ray, i, hit))));
            all.sort_unstable();
            all
        };
        assert_eq!(crossings(&nested), crossings(&flat), "{ray:?}");
        let through = |scene: &Scene| {
            let mut all = Vec::new();
            let blocked = scene.occluded_or(None, &ray, |i, hit| {
                all.push(format!(
                    "{hit:?} {:?} {:?}",
                    scene.transparency(&ray, i, hit),
                    scene.geometry.object(i)
                ));
                false
            });
            all.sort_unstable();
            (!blocked).then_some(all)
        };
        let all = through(&nested);
        assert_eq!(all, through(&flat), "{ray:?}");
        hits += u32::from(found.is_some());
        passed += all.map_or(0, |all| all.len());
        within += u32::from(nested.trace(&ray).surface().is_some_and(|at| at.object.index() >= 3));
    }
    assert!(hits > n / 3 && within > n / 20 && passed > 100, "{hits} {within} {passed}");
    let (a, b) = (nested.geometry.bounds(), flat.geometry.bounds());
    assert!((a.min - b.min).max_element() <= 1e-2 && (b.max - a.max).max_element() <= 1e-2, "{a:?} {b:?}");
}

/// Numbers of objects run through the placements in their order.
#[test]
fn every_nested_object_is_found_by_its_number() {
    let nested = scene(&forest(), 4_000);
    let mut last = None;
    for number in 3..nested.geometry.object_count() as u32 {
        let place = nested.geometry.object(ObjectId::from_index(number)).map(|object| object.placed_by);
        assert!(place.is_some() && place >= last, "{number}");
        last = place;
    }
    let beyond = ObjectId::from_index(nested.geometry.object_count() as u32);
    assert!(nested.geometry.object(beyond).is_none() && nested.geometry.shape(ObjectId::NONE).is_none());
}

/// A thousand groves of a thousand trees of a thousand leaves, all in one plane.
#[test]
fn a_thousand_million_objects_take_little_memory() {
    let row = |word: &str, step: usize, rows: bool| {
        let place = |i: usize| if rows { [0, i * step] } else { [i * step, 0] };
        let line = |i: usize| format!("Instance {word} {{ Translate {} {} 0 }}\n", place(i)[0], place(i)[1]);
        (0..1000).map(line).collect::<String>()
    };
    let leaves: String = (0..1000).map(|i| format!("Sphere {{ center {i} 0 0 radius 0.4 }}\n")).collect();
    let text = format!(
        "Define tree {{ {leaves} }} Define grove {{ {} }} MaterialIndex 0 {}",
        row("tree", 1, true),
        row("grove", 1000, false)
    );
    let s = scene(&text, 10_000_000);
    assert_eq!((s.geometry.object_count(), s.geometry.primitives.len()), (1_000_000_000, 0));
    assert!(s.geometry.bytes() < 2_000_000, "{}", s.geometry.bytes());
    for k in 0..1000 {
        let x = signed(k);
        let [column, row] = [x(0), x(1)].map(|x| ((0.5 * x + 0.5) * 1000.0) as u32);
        let grove = k;
        let leaf = Vec3::new((1000 * grove + column) as f32, row as f32, 0.0);
        let at = s.trace(&Ray::new(leaf + 5.0 * Vec3::Z, Vec3::NEG_Z));
        let at = at.surface().unwrap();
        assert!((at.hit.t - 4.6).abs() < 1e-4);
        assert_eq!(at.object.index() as u32, (grove * 1000 + row) * 1000 + column);
    }
    assert!(!s.occluded(&Ray::new(Vec3::new(500_000.5, 500.5, 5.0), Vec3::NEG_Z)));
}

#[test]
fn nesting_without_end_is_refused_and_deep_nesting_is_not() {
    let ball = "Sphere { center 0 0 0 radius 1 } ".repeat(64);
    let tower = |count: u32, each: &str| {
        let level = |i: u32| format!("Define d{i} {{ {} }} ", each.replace('#', &(i - 1).to_string()));
        let levels: String = (1..=count).map(level).collect();
        format!("Define d0 {{ {ball} }} {levels} MaterialIndex 0 Instance d{count}")
    };
    let (none, said) = compiled(&tower(64, &"Instance d# ".repeat(10)), 10_000);
    assert!(none.is_none() && said.len() == 1 && said[0].contains("be numbered"), "{said:?}");
    for levels in [5, 31, 200] {
        let text = tower(levels, "Instance d# { Translate 0 0.5 0 }") + " Instance d0 Instance d0";
        let s = scene(&text, 1_500);
        assert_eq!(s.geometry.object_count(), 3 * 64);
        let top = s.trace(&Ray::new(Vec3::new(0.0, 1000.0, 0.0), Vec3::NEG_Y));
        assert_eq!(top.surface().map(|at| at.hit.t), Some(1000.0 - 0.5 * levels as f32 - 1.0));
    }
}

#[test]
fn lights_and_motion_stay_flat_or_are_refused() {
    let twig: String = (0..70).map(|i| format!("Sphere {{ center {i} 0 0 radius 0.4 }} ")).collect();
    let lit = format!("Define twig {{ {twig} MaterialIndex emitter Sphere {{ center 0 1 0 radius 0.1 }} }}");
    let s = scene(&format!("{lit} MaterialIndex 0 {}", "Instance twig ".repeat(4)), 1_000);
    assert_eq!((s.geometry.aggregate.nested().is_none(), s.lighting.list.len()), (true, 4));
    let defined = format!("Define twig {{ {twig} }} Define tree {{ {} }}", "Instance twig ".repeat(4));
    let s =
        scene(&format!("{defined} MaterialIndex 0 Instance tree MaterialIndex emitter Instance twig"), 1_000);
    assert_eq!(
        (s.geometry.primitives.len(), s.geometry.object_count(), s.lighting.list.len()),
        (70, 350, 70)
    );
    let motion = "Motion { key 0 { Translate 0 0 0 } key 1 { Translate 1 0 0 } }";
    for (placed, words) in [
        ("MaterialIndex emitter Instance tree", "make lights of 280 objects"),
        (&*format!("MaterialIndex 0 Instance tree {{ {motion} }}"), "move 280 objects"),
        (
            &*format!("Define wood {{ Instance tree {{ {motion} }} }} MaterialIndex 0 Instance wood"),
            "move 280",
        ),
        ("Instance tree", "no material"),
    ] {
        let (none, said) = compiled(&format!("{defined} {placed}"), 1_000);
        assert!(none.is_none() && said.iter().any(|s| s.contains(words)), "{placed}: {said:?}");
    }
}

#[test]
fn all_pieces_of_nested_instances_are_the_flat_list() {
    let text = forest();
    let (flat, nested) = (scene(&text, 10_000_000), scene(&text, 4_000));
    let mut elements = nested.geometry.nested_elements(|_| 1, usize::MAX);
    elements.sort_by_key(|element| element.object);
    // The sphere before them, the plane and the box after them are in the list of both scenes.
    let listed = &flat.geometry.primitives[1..flat.geometry.primitives.len() - 2];
    assert_eq!(elements.len(), listed.len());
    for (i, (element, primitive)) in (0..).zip(elements.iter().zip(listed)) {
        assert_eq!(element.object.index(), nested.geometry.primitives.len() + i);
        let ElementContent::Shape(shape) = element.content else { panic!("{element:?}") };
        let found = element.world_from_object.bounds(&nested.geometry.shapes.bounds(shape));
        let expected =
            flat.geometry.transform_of(primitive, 0.0).bounds(&flat.geometry.shapes.bounds(primitive.shape));
        assert!(found.min.distance(expected.min) + found.max.distance(expected.max) < 1e-4, "{element:?}");
        let number = |scene: &Scene, material| scene.appearance.number(material);
        assert_eq!(number(&nested, element.material), number(&flat, primitive.material));
    }
}

#[test]
fn few_pieces_of_nested_instances_leave_nothing_out() {
    let nested = scene(&forest(), 4_000);
    let all = nested.geometry.nested_elements(|_| 1, usize::MAX);
    let bounds = |element: &NestedElement| {
        element.world_from_object.bounds(&match element.content {
            ElementContent::Shape(shape) => nested.geometry.shapes.bounds(shape),
            ElementContent::Whole(bounds) => bounds,
        })
    };
    for budget in [48, 400, 3000] {
        let mut few = nested.geometry.nested_elements(|_| 1, budget);
        let cost = |element: &NestedElement| {
            if matches!(element.content, ElementContent::Shape(_)) { 1 } else { 12 }
        };
        assert!(few.iter().map(cost).sum::<usize>() <= budget && few.len() >= 4, "{budget} {}", few.len());
        few.sort_by_key(|element| element.object);
        assert_eq!(few[0].object.index(), 3);
        for element in &all {
            let place = few.partition_point(|whole| whole.object <= element.object) - 1;
            let (inner, outer) = (bounds(element), bounds(&few[place]));
            let grown = outer.extent().length() * 1e-4;
            assert!((inner.min + grown).cmpge(outer.min).all() && (inner.max - grown).cmple(outer.max).all());
        }
    }
    assert!(scene("", 4_000).geometry.nested_elements(|_| 1, 100).is_empty());
}

#[test]
fn numbers_of_nested_objects_are_known_by_what_places_them() {
    let nested = scene(&forest(), 4_000);
    let placed_by = |number| nested.geometry.object(ObjectId::from_index(number)).unwrap().placed_by;
    let placed: Vec<u32> = (3..nested.geometry.object_count() as u32).map(placed_by).collect();
    let wanted = placed[placed.len() / 2];
    let found = nested.geometry.nested_objects(|item| item == wanted).into_iter();
    let found = found.flat_map(|range| range.start.index() as u32..range.end.index() as u32);
    let expected: Vec<u32> = (3..).zip(&placed).filter(|(_, by)| **by == wanted).map(|(i, _)| i).collect();
    assert_eq!(found.collect::<Vec<_>>(), expected);
    assert!(expected.len() > 1000);
}

/// Twenty-two definitions, each of two instances of the one before it; the innermost has something that moves.
fn moving_levels() -> String {
    let motion = "Motion { key 0 { } key 1 { Translate 1 0 0 } }";
    let ball = "Sphere { center 0 0 0 radius 1 }";
    let mut text = format!("MaterialIndex 0 Define d0 {{ Transform {{ {motion} {ball} }} }}\n");
    for i in 1..=22 {
        let (before, there) = (i - 1, format!("Translate {i} 0 0"));
        text += &format!("Define d{i} {{ Instance d{before} Instance d{before} {{ {there} }} }}\n");
    }
    text + "Instance d22"
}

#[test]
fn what_moves_is_counted_before_it_is_made() {
    let compiled = |memory: MemoryBudget| {
        let mut parsed = SceneDesc::parse_str(&format!("{CAMERA}{MATERIALS}Group {{ {} }}", moving_levels()));
        let options = CompileOptions {
            limits: Limits { memory: memory.clone(), ..Limits::default() },
            ..CompileOptions::default()
        };
        let mut diagnostics = parsed.diagnostics;
        assert!(compile(&mut parsed.desc, &MemoryAssets::new(), &options, &mut diagnostics).is_none());
        let said: Vec<_> = diagnostics.iter().map(|d| d.message.clone()).collect();
        assert_eq!(said.len(), 1, "{said:?}");
        assert!(memory.used() < 1_000_000, "{} bytes were taken", memory.used());
        said[0].clone()
    };
    assert!(compiled(MemoryBudget::default()).contains("more than 10000000 objects"));
    let little = MemoryBudget::new(100_000_000);
    assert!(compiled(little.clone()).contains("there is no memory for the objects of the scene"));
    assert!(little.was_exceeded());
}

#[test]
fn what_moves_little_is_not_refused() {
    let motion = "Motion { key 0 { } key 1 { Translate 1 0 0 } }";
    let still = "Instance still ".repeat(100);
    let group = format!(
        "MaterialIndex 0 Define still {{ {} }} Define wood {{ {still} }}
         Define one {{ Transform {{ {motion} Sphere {{ center 0 0 0 radius 1 }} }} }}
         Define two {{ Instance one Instance one }} Instance two Instance two Instance wood",
        "Sphere { center 0 0 0 radius 1 }".repeat(100)
    );
    let scene = scene(&group, 1000);
    assert_eq!(scene.geometry.object_count(), 10_004);
}
