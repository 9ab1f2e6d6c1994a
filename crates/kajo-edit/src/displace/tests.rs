//! Movements against rays: what a ray met before, the moved ray meets afterwards.

use std::path::{Path, PathBuf};

use kajo_core::scene::{RayEvent, Scene};
use kajo_math::Ray;

use super::*;
use crate::keywords_of;
use crate::{Document, Edit, template};
use kajo::LoadOptions;

fn gallery() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/gallery")
}

/// Blocks of every shape, none of them symmetric where it can be helped.
fn shapes() -> Vec<String> {
    let shape = |keyword: &str| match keyword {
        "TriangleMesh" => "TriangleMesh { obj_file meshes/knot.obj }".to_owned(),
        "HeightField" => {
            let heights = "size 1.4 1.2  heights -0.3 0.6  base -0.6";
            format!("HeightField {{ file pictures/ball.png  center 0.1 0.2 0  {heights} }}")
        }
        "Model" => "Model { file meshes/lantern.glb }".to_owned(),
        "Text" => "Text { text ga  font fonts/kajo.ttf  origin 0.1 0.2 0  size 0.8  depth 0.3  bevel 0.05 }"
            .to_owned(),
        "Cone" => "Cone { base 0.1 -0.4 0  top 0.5 0.8 0.2  radius 0.7  topRadius 0.3 }".to_owned(),
        "Superellipsoid" => {
            "Superellipsoid { center 0.1 0.2 -0.1  radius 0.7  east 0.3  north 1.6 }".to_owned()
        }
        "Disk" => "Disk { center 0.1 0.2 0  normal 1 2 0.5  radius 0.9  innerRadius 0.2 }".to_owned(),
        "Plane" => "Plane { normal 0.5 2 1  offset 0.3 }".to_owned(),
        other => template(other, [0.1, 0.2, -0.1], 0.7).unwrap(),
    };
    let waves = template("HeightField", [0.1, 0.2, -0.1], 0.7);
    keywords_of(Kind::Shape).map(shape).chain(waves).collect()
}

fn scene(objects: &str) -> String {
    format!(
        "PerspectiveCamera {{ center 0 0 9  direction 0 0 -1  up 0 1 0  angle 30 }}\n\
         Materials {{ Matte {{ }} }}\nGroup {{\n  MaterialIndex 0\n  {objects}\n}}\n"
    )
}

fn document(text: &str) -> Document {
    let mut document = Document::untitled(&gallery(), text, LoadOptions::default()).unwrap();
    document.compile();
    assert!(document.is_current(), "{text}\n{}", document.report(false));
    document
}

/// Distances along rays, each of which is mapped first; negative for a miss.
fn distances(scene: &Scene, map: &DAffine3) -> Vec<f32> {
    let mut drawn = 0;
    let mut random = move || {
        drawn += 1;
        kajo_math::rng::mix(drawn) as u32 as f64 / f64::from(u32::MAX) - 0.5
    };
    let mut ray = move || {
        let mut v = || DVec3::new(random(), random(), random());
        let origin = v().normalize() * 6.0;
        let direction = v() * 3.0 - origin;
        let (o, d) = (map.transform_point3(origin), map.transform_vector3(direction));
        Ray { t_max: f32::INFINITY, ..Ray::new(o.as_vec3(), d.as_vec3()) }
    };
    let mut distance = move || match scene.trace(&ray()) {
        RayEvent::Surface(at) => at.hit.t,
        RayEvent::Escaped => -1.0,
    };
    (0..600).map(|_| distance()).collect()
}

/// Places to move from: the text around a shape, and whether that makes a node of its own that is moved instead.
const AROUND: [(&str, Option<&str>); 11] = [
    ("@", None),
    ("Group { @ }", None),
    ("Group g { @ }", Some("g")),
    ("Transform { Translate 0.3 -0.2 0.1  @ }", None),
    ("Transform { YRotate 30  Scale 1 1.5 0.7  Group { @ } }", None),
    ("Transform {\n    Translate 0.5 0 0\n    YRotate 30\n    Scale 1 2 0.5\n    @\n  }", None),
    ("Transform { Matrix { 1 0 0 0  0 0 1 0  0 -1 0 0  0.5 0.2 0 1 }  @ }", None),
    ("Transform { Rotate 0 0 0.9 30  Translate 0.1 0 0  @ }", None),
    ("Transform { Scale -1 1 1  Transform { Rotate 0.6 0 0.8 40  @ } }", None),
    ("Define d { @ }  Instance d", Some("d")),
    ("Define d { @ }  Instance d { Translate 0.2 0.1 0  Rotate 0 0.6 0.8 20  UniformScale 0.8 }", Some("d")),
];

fn movements() -> Vec<Movement> {
    let center = DVec3::new(0.3, -0.4, 0.2);
    let axes = DMat3::from_quat(turn(DVec3::new(0.48, 0.6, 0.64), 35.0));
    let scale = |axes, factors| Movement::Scale { center, axes, factors };
    vec![
        Movement::Translate(DVec3::new(0.25, -0.5, 0.125)),
        Movement::Rotate { center, axis: DVec3::Y, degrees: 25.0 },
        Movement::Rotate { center, axis: DVec3::new(0.48, 0.6, 0.64), degrees: -70.0 },
        scale(DMat3::IDENTITY, DVec3::splat(1.25)),
        scale(DMat3::IDENTITY, DVec3::new(1.0, 1.5, 0.8)),
        scale(axes, DVec3::new(1.25, 1.0, 0.5)),
        scale(DMat3::IDENTITY, DVec3::new(-1.0, 1.0, 1.0)),
        Movement::Map(DAffine3::from_cols_array(&[
            1.0, 0.2, 0.0, 0.0, 1.1, 0.3, -0.2, 0.0, 0.9, 0.1, 0.2, 0.3,
        ])),
    ]
}

#[test]
fn everything_moves_as_it_is_told() {
    for shape in shapes() {
        let keyword = shape.split(' ').next().unwrap_or_default();
        // A mesh takes its time, and is as good in one place as in another.
        let around = if ["Model", "TriangleMesh"].contains(&keyword) { &AROUND[3..4] } else { &AROUND[..] };
        for (around, name) in around {
            let text = scene(&around.replace('@', &shape));
            let mut document = document(&text);
            let is_it = |n: &Node| match name {
                Some(name) => n.name.as_deref() == Some(name) && n.kind != Kind::Define,
                None => &*n.keyword == keyword,
            };
            let node = document.outline().nodes().iter().find(|n| is_it(n)).unwrap().id;
            let before = distances(document.scene().unwrap(), &DAffine3::IDENTITY);
            for movement in movements() {
                let place = || format!("{movement:?}\nof {text}");
                document.apply(&Edit::Move { node, movement }).unwrap_or_else(|e| panic!("{e}: {}", place()));
                document.compile();
                assert!(
                    document.is_current(),
                    "{}\n{}\n{}",
                    place(),
                    document.text(),
                    document.report(false)
                );
                let after = distances(document.scene().unwrap(), &movement.map());
                let agree = |(a, b): (&f32, &f32)| (a - b).abs() < 2e-3 || (*a < 0.0 && *b < 0.0);
                let n = before.iter().zip(&after).filter(|&pair| agree(pair)).count();
                // Rays that graze an edge may go either way.
                assert!(n >= 594, "{n} of 600 rays agree: {}\n{}", place(), document.text());
                document.undo();
                assert_eq!(document.text(), text);
            }
        }
    }
}

#[test]
fn movements_add_up_in_the_numbers_that_are_there() {
    for shape in shapes() {
        for (around, name) in AROUND {
            let mut document = document(&scene(&around.replace('@', &shape)));
            let keyword = shape.split(' ').next().unwrap_or_default();
            let is_it = |n: &Node| match name {
                Some(name) => n.name.as_deref() == Some(name) && n.kind != Kind::Define,
                None => &*n.keyword == keyword,
            };
            let node = document.outline().nodes().iter().find(|n| is_it(n)).unwrap().id;
            for movement in &movements()[..4] {
                let count = |d: &Document| d.text().split_ascii_whitespace().count();
                document.apply(&Edit::Move { node, movement: *movement }).unwrap();
                let once = count(&document);
                document.apply(&Edit::Move { node, movement: *movement }).unwrap();
                document.apply(&Edit::Move { node, movement: *movement }).unwrap();
                assert_eq!(count(&document), once, "{movement:?}\n{}", document.text());
                while document.undo() {}
            }
        }
    }
}

/// The line that differs after a movement of the first node with this keyword.
fn moved(objects: &str, keyword: &str, movement: Movement) -> String {
    let mut document = document(&scene(objects));
    let node = document.outline().nodes().iter().find(|n| &*n.keyword == keyword).unwrap().id;
    document.apply(&Edit::Move { node, movement }).unwrap();
    document.text().lines().nth(4).unwrap().trim().to_owned()
}

#[test]
fn the_text_is_what_one_would_write() {
    let up = Movement::Translate(DVec3::new(0.0, 0.5, 0.0));
    let turn = Movement::Rotate { center: DVec3::ZERO, axis: DVec3::NEG_Y, degrees: -30.0 };
    let half = Movement::Scale { center: DVec3::ZERO, axes: DMat3::IDENTITY, factors: DVec3::splat(0.5) };
    let flat =
        Movement::Scale { center: DVec3::ZERO, axes: DMat3::IDENTITY, factors: DVec3::new(1.0, 0.5, 1.0) };
    for (before, keyword, movement, after) in [
        ("Sphere { center 1 0 0  radius 2 }", "Sphere", up, "Sphere { center 1 0.5 0  radius 2 }"),
        ("Sphere { center 1 0 0  radius 2 }", "Sphere", half, "Sphere { center 0.5 0 0  radius 1 }"),
        (
            "Sphere { center 1 0 0  radius 2 }",
            "Sphere",
            flat,
            "Transform { Scale 1 0.5 1  Sphere { center 1 0 0  radius 2 } }",
        ),
        ("Plane { normal 0 3 0  offset 1 }", "Plane", up, "Plane { normal 0 3 0  offset 1.5 }"),
        (
            "Box { min 0 0 0  max 1 1 1 }",
            "Box",
            turn,
            "Transform { YRotate 30  Box { min 0 0 0  max 1 1 1 } }",
        ),
        (
            "Transform { Translate 0 1 0 /* up */ Scale 1 2 1 Group { } }",
            "Transform",
            turn,
            "Transform { Translate 0 1 0  YRotate 30 /* up */ Scale 1 2 1 Group { } }",
        ),
        (
            "Transform { YRotate 15  UniformScale 2  Group { } }",
            "Transform",
            turn,
            "Transform { YRotate 45  UniformScale 2  Group { } }",
        ),
        (
            "Transform { YRotate 15  UniformScale 2  Group { } }",
            "Transform",
            flat,
            "Transform { YRotate 15  Scale 2 1 2  Group { } }",
        ),
        ("Define d { } Instance d", "Instance", up, "Define d { } Instance d { Translate 0 0.5 0 }"),
    ] {
        assert_eq!(moved(before, keyword, movement), after);
    }
}

#[test]
fn what_cannot_be_moved_says_so() {
    let mut document =
        document(&scene("Transform { Scale 1 0 1  Sphere { center 0 0 0  radius 1 } }  Define d { }"));
    let nodes: Vec<_> = document.outline().nodes().iter().map(|n| (n.keyword.to_string(), n.id)).collect();
    let up = Movement::Translate(DVec3::Y);
    for (keyword, node) in nodes {
        let moved = document.apply(&Edit::Move { node, movement: up }).map_err(|e| e.to_string());
        match &*keyword {
            "Materials" | "Matte" | "Group" | "Define" => {
                assert!(moved.unwrap_err().contains("cannot be moved"))
            }
            _ => assert!(moved.is_ok(), "{keyword}: {moved:?}"),
        }
    }
    let flat =
        Movement::Scale { center: DVec3::ZERO, axes: DMat3::IDENTITY, factors: DVec3::new(1.0, 0.0, 1.0) };
    let sphere = document.outline().nodes().iter().find(|n| &*n.keyword == "Sphere").unwrap().id;
    assert!(document.apply(&Edit::Move { node: sphere, movement: flat }).is_err());
}

#[test]
fn the_camera_follows_a_pose() {
    use kajo::CameraPose;
    let mut document = document(&scene(""));
    let text = document.text().to_owned();
    let mut pose = CameraPose::of(document.scene().unwrap());
    document.apply(&Edit::Look(Box::new(pose.clone()))).unwrap();
    assert_eq!(document.text(), text, "a pose that was not changed changes nothing");
    pose.fly(DVec3::new(0.5, 0.0, 2.0));
    document.apply(&Edit::Look(Box::new(pose.clone()))).unwrap();
    assert!(document.text().contains("direction 0 0 -1  up 0 1 0  angle 30"), "{}", document.text());
    pose.turn(0.3, 0.2);
    pose.set_angle(0.7);
    document.apply(&Edit::Look(Box::new(pose.clone()))).unwrap();
    document.compile();
    let written = CameraPose::of(document.scene().unwrap());
    for (a, b) in
        [(written.eye(), pose.eye()), (written.forward(), pose.forward()), (written.up(), pose.up())]
    {
        assert!(a.distance(b) < 1e-5, "{a} {b}");
    }
    assert!((written.angle().unwrap() - 0.7).abs() < 1e-6);
    let mut empty = Document::untitled(&gallery(), "", LoadOptions::default()).unwrap();
    empty.apply(&Edit::Look(Box::new(pose))).unwrap();
    empty.compile();
    assert!(empty.is_current() && empty.text().starts_with("PerspectiveCamera {"), "{}", empty.report(false));
}

/// What goes along a path is moved in the world, and a camera on one is left to its path.
#[test]
fn what_follows_a_path_is_moved_with_it() {
    let path = "FollowPath { line 1 0 0  3 0 2  progress 0.25  bank 20 }";
    let movement = Movement::Rotate { center: DVec3::new(0.5, 0.0, 1.0), axis: DVec3::Y, degrees: 30.0 };
    for operations in [path.to_owned(), format!("Translate 1 2 3 {path}"), format!("{path} YRotate 40")] {
        let mut document = document(&scene(&format!(
            "Transform {{ {operations} Group {{ Box {{ min 0 0 0  max 1 2 3 }} }} }}"
        )));
        let moved = |document: &Document| {
            let node = document.outline().nodes().iter().find(|node| node.kind == Kind::Transform).unwrap();
            (node.id, document.tree.own_map(node))
        };
        let (id, before) = moved(&document);
        document.apply(&Edit::Move { node: id, movement }).unwrap();
        let (_, after) = moved(&document);
        assert!(after.abs_diff_eq(movement.map() * before, 1e-5), "{}", document.text());
    }
    for (path, name) in [(path, "FollowPath"), ("WorldLine { acceleration 0 0 -0.1 }", "WorldLine")] {
        let text = scene("Sphere { center 0 0 0  radius 1 }")
            .replace("center 0 0 9", &format!("center 0 0 9  {path}"));
        let mut document = document(&text);
        let mut pose = kajo::CameraPose::of(document.scene().unwrap());
        pose.fly(DVec3::new(0.5, 0.0, 2.0));
        let refused = document.apply(&Edit::Look(Box::new(pose))).unwrap_err().to_string();
        assert!(refused.contains(name), "{refused}");
    }
}

/// However a camera says where it looks, moving it by hand edits what is written, and the scene has the camera shown.
#[test]
fn cameras_that_look_at_things_are_moved_by_hand() {
    use kajo::CameraPose;
    for (keys, kept, gone) in [
        ("center 0 1 9  target 1 1 0  angle 30", "target", "direction"),
        ("lookAt 0 1 9  1 1 0  angle 30", "lookAt", "center"),
        ("lookAt 0 1 9  1 1 0  0 1 0  angle 30", "lookAt", "center"),
        ("center 0 1 9  target ball  angle 30", "direction", "target"),
        ("fit scene", "center", "fit"),
        ("fit ball 0.1  direction 1 -1 -3", "direction", "fit"),
        ("fit ball  center 0 2 9", "angle", "fit"),
    ] {
        let text = format!(
            "PerspectiveCamera {{ {keys} }} Materials {{ Matte {{ }} }}
             Group {{ MaterialIndex 0  Sphere ball {{ center 1 1 0  radius 1 }} }}"
        );
        let mut document = Document::untitled(Path::new("."), &text, LoadOptions::default()).unwrap();
        document.compile();
        assert!(document.is_current(), "{}", document.report(false));
        let mut pose = CameraPose::of(document.scene().unwrap());
        pose.turn(0.3, -0.2);
        pose.fly(DVec3::new(0.5, 0.25, -2.0));
        document.apply(&Edit::Look(Box::new(pose.clone()))).unwrap();
        document.compile();
        assert!(document.is_current(), "{}\n{}", document.text(), document.report(false));
        let found = CameraPose::of(document.scene().unwrap());
        assert!(found.eye().distance(pose.eye()) < 1e-4, "{}", document.text());
        assert!(found.forward().distance(pose.forward()) < 1e-5, "{}", document.text());
        assert!(found.up().distance(pose.up()) < 1e-5, "{}", document.text());
        assert!((found.angle().unwrap() - pose.angle().unwrap()).abs() < 1e-6, "{}", document.text());
        let camera = document.text().split("Materials").next().unwrap().to_owned();
        assert!(camera.contains(kept) && !camera.contains(&format!("{gone} ")), "{camera}");
    }
}
