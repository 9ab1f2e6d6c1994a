//! Every kind of handle, seen by random cameras, follows the cursor.

use std::path::Path;

use kajo_math::{DMat3, DVec2, DVec3};

use super::*;
use crate::{Document, Kind};
use kajo::CameraPose;
use kajo::LoadOptions;

const SCENE: &str = "
PerspectiveCamera { center 0 1 8  direction 0 -0.1 -2  up 0 1 0  angle 30  aperture 0.1  focus 7 }
Lights {
  PointLight { position 1 2 3  color 1 1 1 }
  SpotLight { position -1 2 1  direction 0.5 -2 0  angle 40  innerAngle 20  color 1 1 1 }
  DirectionalLight { direction -1 -2 -1  color 1 1 1 }
}
Materials { Matte { } }
Group {
  MaterialIndex 0
  Plane { normal 0.2 2 0.1  offset -1 }
  Transform {
    Translate 0.3 0.1 -0.2  Rotate 0.48 0.6 0.64 35  UniformScale 0.8
    Sphere { center 0 0.5 0  radius 0.7 }
  }
  Transform { YRotate 20  Scale 1 1.5 0.8  Box { min -1 -0.5 0  max 0 0.5 1 } }
  Cylinder { base 1 0 0  top 1 1 0.3  radius 0.3 }
  Transform { ZRotate 50  Cone { base -1 0 0.4  top -1 1 0  radius 0.5  topRadius 0.2 } }
  Disk { center 0 1 0.5  normal 0.4 0.5 1  radius 0.8  innerRadius 0.3 }
  Transform { XRotate 20  Torus { center 0 1 -0.5  axis 0.4 2 0.5  majorRadius 0.8  minorRadius 0.3 } }
  Quad { corner -1 0 1  edge1 1.5 0.1 0  edge2 0 0.2 -1 }
  BilinearPatch { vertex0 0 0 1  vertex1 1 0.2 1  vertex2 0.8 1 0.4  vertex3 -0.2 0.9 0.8 }
  Transform {
    YRotate 30
    BicubicPatch {
      row0 0 0 0  1 0 0.4  2 0 0.4  3 0 0      row1 0 1 0.2  1 1 0.9  2 1 0.9  3 1 0.2
      row2 0 2 0.2  1 2 0.9  2 2 0.9  3 2 0.2  row3 0 3 0  1 3 0.4  2 3 0.4  3 3 0
    }
  }
  Triangle { vertex0 0 0 1  vertex1 1 0.2 1  vertex2 0.3 1 0.8 }
  Transform { XRotate 40  Curves { radius 0.1  strand { points -1 0 0  0 1 0.4  0.5 0 1  1 1 0 } } }
  Define pair { Sphere { center 0 0 0  radius 0.2 } }
  Instance pair { Translate 0.5 0.5 0.5 }
  Difference { Box { min -1 -1 -1  max 0 0 0 }  Transform { YRotate 30  Sphere { center -0.2 0 0  radius 0.6 } } }
  Group both { Sphere { center 1 1 1  radius 0.1 }  Sphere { center 1 1 0  radius 0.1 } }
}
";

fn document() -> Document {
    let mut document = Document::untitled(Path::new("."), SCENE, LoadOptions::default()).unwrap();
    document.compile();
    assert!(document.is_current(), "{}", document.report(false));
    document
}

/// Numbers in [-1, 1] that depend on nothing but `seed`.
fn random(seed: u64) -> impl FnMut() -> f64 {
    let mut drawn = 0;
    move || {
        drawn += 1;
        f64::from(kajo_math::rng::mix(seed << 32 | drawn) as u32) / f64::from(u32::MAX) * 2.0 - 1.0
    }
}

fn poses() -> Vec<CameraPose> {
    let mut random = random(7);
    let mut pose = |i: i32| {
        let mut v = |scale: f64| DVec3::new(random(), random(), random()) * scale;
        let (eye, target, up) = (v(1.0).normalize() * 7.0, v(0.5), v(1.0) + DVec3::Y);
        let of = |keyword: &str, keys: &str| {
            let [eye, ahead, up] = [eye, target - eye, up].map(|v| format!("{} {} {}", v.x, v.y, v.z));
            pose_of(&format!("{keyword} {{ center {eye} direction {ahead} up {up} {keys} }}"))
        };
        match i % 6 {
            0 => CameraPose::perspective(eye, target, up, 0.4 + 0.1 * f64::from(i)),
            1 => CameraPose::orthographic(eye, target, up, 5.0),
            2 => of("PanoramaCamera", ""),
            3 => of("FisheyeCamera", "angle 120  projection equisolid"),
            4 => of("PanoramaCamera", "stereo omnidirectional"),
            _ => of("StereoCubemapCamera", ""),
        }
    };
    (0..12).map(&mut pose).collect()
}

/// The camera of a text.
fn pose_of(camera: &str) -> CameraPose {
    let mut document = Document::untitled(Path::new("."), camera, LoadOptions::default()).unwrap();
    document.compile();
    CameraPose::of(document.scene().unwrap())
}

/// A place for the cursor that the handle can follow to.
fn goal(handle: &Handle, eye: &Eye<'_>, from: DVec2, random: &mut impl FnMut() -> f64) -> Option<DVec2> {
    match handle.track {
        Track::Screen | Track::Plane(_) => Some(from + DVec2::new(random(), random()) * 30.0),
        Track::Line(direction) => {
            let by = 25.0 * eye.pixel_at(handle.at) * random();
            eye.project(handle.at + by * direction)
        }
        Track::Circle { center, axis } => {
            let turn = kajo_math::DQuat::from_axis_angle(axis, random());
            eye.project(center + turn * (handle.at - center))
        }
    }
}

/// Whether the picture shows one thing after the other on the way between two places, as it does not at the edges of
/// panoramas and of the faces of cubes.
fn is_continuous(eye: &Eye<'_>, from: DVec2, to: DVec2) -> bool {
    let inside = |place: DVec2| {
        let [width, height] = eye.size.map(f64::from);
        (0.0..width).contains(&place.x) && (0.0..height).contains(&place.y)
    };
    let ways: Option<Vec<DVec3>> =
        (0..=16).map(|i| Some(eye.sight(from.lerp(to, f64::from(i) / 16.0))?.direction)).collect();
    let is_smooth = |ways: Vec<DVec3>| ways.windows(2).all(|pair| pair[0].dot(pair[1]) > 0.99);
    eye.pose.is_flat() || inside(from) && inside(to) && ways.is_some_and(is_smooth)
}

/// Drags every handle of every node by every camera; `check` sees each with what became of it.
fn drag_all(
    handles_of: impl Fn(&Document, NodeId, &Eye<'_>) -> Vec<Handle>,
    check: impl Fn(&Document, usize, &Handle, &Dragged, &Eye<'_>),
) -> Vec<HandleKind> {
    let mut document = document();
    let (mut random, mut seen) = (random(3), Vec::new());
    let nodes: Vec<NodeId> = document.outline().nodes().iter().map(|node| node.id).collect();
    for pose in poses() {
        let eye = Eye { pose: &pose, size: [960, 540] };
        for &node in &nodes {
            for (i, handle) in handles_of(&document, node, &eye).into_iter().enumerate() {
                let Some(from) = eye.project(handle.at) else { continue };
                let to = goal(&handle, &eye, from, &mut random).filter(|to| is_continuous(&eye, from, *to));
                let Some(to) = to else { continue };
                let Some(dragged) = handle.drag(&eye, from, to, &Snap::default()) else {
                    assert!(!matches!(handle.track, Track::Screen), "{handle:?}");
                    continue;
                };
                let there = eye.project(dragged.at).unwrap();
                let place = || format!("{handle:?}\nfrom {from} to {to}: at {there}");
                assert!(there.distance(to) < 0.5, "{}", place());
                document.begin_gesture("drag");
                document.apply(&dragged.edit).unwrap_or_else(|e| panic!("{e}: {}", place()));
                document.end_gesture();
                check(&document, i, &handle, &dragged, &eye);
                document.undo();
                assert_eq!(document.text(), SCENE);
                seen.push(handle.kind);
            }
        }
    }
    seen
}

#[test]
fn handles_of_shapes_follow_the_cursor_and_the_text_follows_them() {
    let seen = drag_all(handles_of, |document, i, handle, dragged, eye| {
        let handles = handles_of(document, handle.node, eye);
        let again = &handles[i];
        let origin = |from: DVec3| handle.world_from_local.transform_point3(from);
        let pixels = |a: DVec3, b: DVec3| eye.project(a).unwrap().distance(eye.project(b).unwrap());
        match &handle.meaning {
            // Directions are shown as long as the picture has room: they agree as directions.
            Meaning::Direction { from, .. } | Meaning::Cone { from, .. } => {
                let [a, b] = [again.at, dragged.at].map(|at| (at - origin(*from)).normalize());
                if !matches!(handle.meaning, Meaning::Cone { .. }) {
                    assert!(a.distance(b) < 1e-3, "{handle:?}: {a} {b}");
                }
            }
            // A plane turns about the foot of its normal, which keeps to the plane.
            Meaning::Facing { from, .. } => {
                let value = |key: &str| document.value(handle.node, key).unwrap();
                let normal = DVec3::from_array(value("normal").vec3().unwrap()).normalize();
                assert!(normal.distance((dragged.at - *from).normalize()) < 1e-4, "{handle:?}");
                assert!((normal.dot(*from) - value("offset").numbers[0]).abs() < 5e-3, "{handle:?}");
            }
            // A radius is shown at another side than where it was dragged to.
            Meaning::Distance { from, line, .. } => {
                let local = handle.world_from_local.inverse();
                let off = |at: DVec3| {
                    let off = local.transform_point3(at) - *from;
                    line.map_or(off, |line| off.cross(line)).length()
                };
                let (a, b) = (off(again.at), off(dragged.at));
                assert!((a - b).abs() < 1e-4 * b, "{handle:?}: {a} {b}");
            }
            _ => assert!(pixels(again.at, dragged.at) < 0.5, "{handle:?}: {} {}", again.at, dragged.at),
        }
    });
    for kind in [HandleKind::Point, HandleKind::Size, HandleKind::Direction] {
        assert!(seen.iter().filter(|&&s| s == kind).count() >= 30, "{kind:?}");
    }
}

#[test]
fn cones_of_lights_open_as_they_are_dragged() {
    let document = document();
    let spot = document.outline().nodes().iter().find(|n| &*n.keyword == "SpotLight").unwrap().id;
    let pose = CameraPose::perspective(DVec3::new(0.0, 1.0, 9.0), DVec3::Y, DVec3::Y, 0.6);
    let eye = Eye { pose: &pose, size: [640, 480] };
    let handles = handles_of(&document, spot, &eye);
    let cone =
        handles.iter().find(|handle| matches!(handle.meaning, Meaning::Cone { key: "angle", .. })).unwrap();
    let Meaning::Cone { from, axis, .. } = cone.meaning else { panic!() };
    assert!((2.0 * (cone.at - from).angle_between(axis).to_degrees() - 40.0).abs() < 1e-6);
    let grabbed = eye.project(cone.at).unwrap();
    let dragged = cone.drag(&eye, grabbed, grabbed + DVec2::new(20.0, -10.0), &Snap::default()).unwrap();
    let expected = 2.0 * (dragged.at - from).angle_between(axis).to_degrees();
    let crate::Edit::Set { value, .. } = dragged.edit else { panic!() };
    assert!(
        (value.numbers[0] - expected).abs() < 0.01 && (expected - 40.0).abs() > 3.0,
        "{value:?} {expected}"
    );
}

#[test]
fn gizmos_follow_the_cursor_and_take_their_nodes_with_them() {
    let gizmo = |mode: Mode, axes: Axes| {
        move |document: &Document, node: NodeId, eye: &Eye<'_>| gizmo_of(document, node, eye, mode, axes)
    };
    let original = document();
    for axes in [Axes::World, Axes::Own] {
        let seen = drag_all(gizmo(Mode::Move, axes), |document, i, handle, dragged, eye| {
            let again = &gizmo_of(document, handle.node, eye, Mode::Move, axes)[i];
            // The arm is of constant size in the picture, so the pivot is what tells.
            let pivot = pivot_of(document, handle.node).unwrap();
            let arm = handle.at - pivot_of(&original, handle.node).unwrap_or(handle.at);
            // A plane that slides along itself is the same plane.
            if &*document.node(handle.node).unwrap().keyword == "Plane" {
                return;
            }
            if matches!(handle.kind, HandleKind::Middle) {
                assert!(eye.project(again.at).unwrap().distance(eye.project(dragged.at).unwrap()) < 0.5);
            } else {
                assert!(pivot.distance(dragged.at - arm) < 1e-2, "{handle:?} {pivot} {}", dragged.at);
            }
        });
        assert!(seen.contains(&HandleKind::Arrow(2)) && seen.contains(&HandleKind::Square(0)));
        let seen = drag_all(gizmo(Mode::Turn, axes), |document, _, handle, _, _| {
            let node = document.node(handle.node).unwrap();
            let pivots = [document, &original].map(|d| pivot_of(d, handle.node).unwrap());
            // That of a plane is the foot of its normal, and that of a group lies among those of what is in it.
            let stays = node.kind != Kind::Group && &*node.keyword != "Plane";
            assert!(!stays || pivots[0].distance(pivots[1]) < 1e-5, "{handle:?}: the pivot stays");
        });
        assert!(seen.contains(&HandleKind::Ring(1)));
        let seen = drag_all(gizmo(Mode::Scale, axes), |_, _, _, _, _| {});
        assert!(seen.contains(&HandleKind::Scale(1)) && seen.contains(&HandleKind::Middle));
    }
}

#[test]
fn values_snap_while_a_key_is_held() {
    let document = document();
    let find = |keyword: &str| document.outline().nodes().iter().find(|n| &*n.keyword == keyword).unwrap().id;
    let pose = CameraPose::perspective(DVec3::new(0.0, 0.5, 9.0), DVec3::Y, DVec3::Y, 0.6);
    let eye = Eye { pose: &pose, size: [640, 480] };
    let snap = Snap { length: 0.25, degrees: 15.0, factor: 0.5 };
    let drag = |handle: &Handle, by: DVec2| {
        let from = eye.project(handle.at).unwrap();
        handle.drag(&eye, from, from + by, &snap).unwrap().edit
    };
    let point = &handles_of(&document, find("PointLight"), &eye)[0];
    let crate::Edit::Set { value, .. } = drag(point, DVec2::new(31.0, -17.0)) else { panic!() };
    assert!(value.numbers.iter().all(|x| (x * 4.0).fract() == 0.0), "{value:?}");
    let ring = &gizmo_of(&document, find("Quad"), &eye, Mode::Turn, Axes::World)[2];
    let crate::Edit::Move { movement: crate::Movement::Rotate { degrees, .. }, .. } =
        drag(ring, DVec2::new(10.0, 33.0))
    else {
        panic!()
    };
    assert!(degrees != 0.0 && degrees % 15.0 == 0.0, "{degrees}");
}

/// Components of a blob have the handles of their fields.
#[test]
fn components_of_blobs_have_handles() {
    let text = "PerspectiveCamera { center 0 0 9  direction 0 0 -1  up 0 1 0  angle 30 } Materials { Matte { } }
        Group { MaterialIndex 0  Transform { Translate 1 0 0  Blob { sphere { center 0 0.5 0  radius 0.5 }
        cylinder { base 0 0 0  top 1 0.5 0  radius 0.3 }  plane { point 0 -1 0  normal 0 1 0  radius 0.2 } } } }";
    let mut document = Document::untitled(Path::new("."), text, LoadOptions::default()).unwrap();
    document.compile();
    let pose = CameraPose::of(document.scene().unwrap());
    let eye = Eye { pose: &pose, size: [640, 480] };
    let find = |document: &Document, keyword: &str| {
        document.outline().nodes().iter().find(|node| &*node.keyword == keyword).unwrap().id
    };
    for (keyword, count) in [("sphere", 2), ("cylinder", 3), ("plane", 3)] {
        assert_eq!(handles_of(&document, find(&document, keyword), &eye).len(), count, "{keyword}");
    }
    let center = &handles_of(&document, find(&document, "sphere"), &eye)[0];
    let from = eye.project(center.at).unwrap();
    let by = DVec2::new(20.0, -10.0);
    let dragged = center.drag(&eye, from, from + by, &Snap::default()).unwrap();
    document.begin_gesture("drag");
    document.apply(&dragged.edit).unwrap();
    document.end_gesture();
    let moved = &handles_of(&document, find(&document, "sphere"), &eye)[0];
    assert!((eye.project(moved.at).unwrap() - from - by).length() < 0.5, "{}", document.text());
}

#[test]
fn handles_are_picked_where_they_are_seen() {
    let document = document();
    let pose = CameraPose::perspective(DVec3::new(1.0, 2.0, 9.0), DVec3::Y, DVec3::Y, 0.6);
    let eye = Eye { pose: &pose, size: [640, 480] };
    let triangle = document.outline().nodes().iter().find(|n| &*n.keyword == "Triangle").unwrap().id;
    let handles = handles_of(&document, triangle, &eye);
    for handle in &handles {
        let place = eye.project(handle.at).unwrap();
        assert_eq!(pick(&handles, &eye, place + DVec2::new(3.0, 4.0), 6.0).unwrap().at, handle.at);
        assert!(pick(&handles, &eye, place + DVec2::new(300.0, 4.0), 6.0).is_none());
    }
    let rings = gizmo_of(&document, triangle, &eye, Mode::Turn, Axes::World);
    let pivot = pivot_of(&document, triangle).unwrap();
    for line in lines_of(&rings, pivot) {
        let place = eye.project(0.5 * (line.from + line.to)).unwrap();
        let picked = pick(&rings, &eye, place, 2.0).unwrap();
        let is_crossing =
            rings.iter().filter(|ring| pick(std::slice::from_ref(ring), &eye, place, 2.0).is_some()).count()
                > 1;
        assert!(is_crossing || picked.kind == rings[line.handle].kind);
    }
    let arrows = gizmo_of(&document, triangle, &eye, Mode::Move, Axes::World);
    assert_eq!(lines_of(&arrows, pivot).len(), 3);
    for arrow in &arrows[..3] {
        let pixels = eye.project(arrow.at).unwrap().distance(eye.project(pivot).unwrap());
        assert!(pixels < 90.0, "of constant size: {pixels}");
    }
    let own = gizmo_of(&document, triangle, &eye, Mode::Scale, Axes::Own);
    let Meaning::Scale { axes, .. } = own[0].meaning else { panic!() };
    assert!((axes.transpose() * axes).abs_diff_eq(DMat3::IDENTITY, 1e-12));
}
