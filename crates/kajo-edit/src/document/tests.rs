//! Whole documents: edits, steps back and forth, files.

mod blocks;

use std::fs;
use std::path::{Path, PathBuf};

use proptest::prelude::*;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};

use super::*;
use crate::{FieldKind, FieldValue, template};
use kajo_core::scene::Scene;

const SCENE: &str = "# A small scene.
PerspectiveCamera { center 0 0 9  direction 0 0 -1  up 0 1 0  angle 30 }
Lights {
  numLights 1
  PointLight { position 1 2 3  color 1 1 1 } # the only one
}
Materials {
  Matte red { color 0.8 0.1 0.1 }
  Matte { color 0.1 0.8 0.1 }
  Checkerboard { materialIndex red  materialIndex 1 }
}
Group {
  numObjects 3
  MaterialIndex red
  Sphere ball { center 0 0 0  radius 1 }
  MaterialIndex 1
  Box { min 1 0 0  max 2 1 1 }
  Transform { Translate 0 1 0  Disk { center 0 0 0  normal 0 1 0  radius 1 } }
}
";

fn document(text: &str) -> Document {
    let mut document = Document::untitled(Path::new("."), text, LoadOptions::default()).unwrap();
    document.compile();
    document
}

/// A document whose text makes a scene.
fn good(text: &str) -> Document {
    let document = document(text);
    assert!(document.is_current(), "{}", document.report(false));
    document
}

fn find(document: &Document, keyword: &str) -> NodeId {
    let node = document.outline().nodes().iter().find(|node| &*node.keyword == keyword);
    node.unwrap_or_else(|| panic!("no {keyword}")).id
}

/// Applies an edit and returns the lines that differ, each with `-` or `+` before it.
fn diff(document: &mut Document, edit: &Edit) -> Vec<String> {
    let before = document.text().to_owned();
    document.apply(edit).unwrap();
    document.compile();
    assert!(document.is_current(), "{}\n{}", document.text(), document.report(false));
    let (old, new): (Vec<_>, Vec<_>) = (before.lines().collect(), document.text().lines().collect());
    let gone = old.iter().filter(|line| !new.contains(line)).map(|line| format!("-{line}"));
    gone.chain(new.iter().filter(|line| !old.contains(line)).map(|line| format!("+{line}"))).collect()
}

fn refusal(document: &mut Document, edit: &Edit) -> String {
    let before = document.text().to_owned();
    let refused = document.apply(edit).unwrap_err().to_string();
    assert_eq!(document.text(), before);
    refused
}

#[test]
fn values_are_set_and_nothing_else() {
    let mut d = good(SCENE);
    let ball = find(&d, "Sphere");
    assert_eq!(
        diff(&mut d, &Edit::set(ball, "center", FieldValue::numbers([0.0, 0.25, 0.0]))),
        ["-  Sphere ball { center 0 0 0  radius 1 }", "+  Sphere ball { center 0 0.25 0  radius 1 }"]
    );
    let light = find(&d, "PointLight");
    assert_eq!(
        diff(&mut d, &Edit::set(light, "attenuation", FieldValue::numbers([1.0, 0.0, 0.5])))[1],
        "+  PointLight { position 1 2 3  color 1 1 1  attenuation 1 0 0.5 } # the only one"
    );
    let remove = Edit::Unset { node: light, key: "attenuation".to_owned(), nth: None };
    d.apply(&remove).unwrap();
    let disk = find(&d, "Transform");
    assert_eq!(
        diff(&mut d, &Edit::set(disk, "UniformScale", FieldValue::numbers([2.0])))[1],
        "+  Transform { Translate 0 1 0  UniformScale 2  Disk { center 0 0 0  normal 0 1 0  radius 1 } }"
    );
    let checker = find(&d, "Checkerboard");
    let second = Edit::Set {
        node: checker,
        key: "materialIndex".into(),
        nth: Some(1),
        value: FieldValue::word("red"),
    };
    assert_eq!(diff(&mut d, &second)[1], "+  Checkerboard { materialIndex red  materialIndex red }");
    while d.undo() {}
    assert_eq!(d.text(), SCENE);
    assert!(!d.outline().nodes().is_empty() && d.redo_label() == Some("set center"));
}

#[test]
fn fields_say_what_holds() {
    let d = good(SCENE);
    let fields = d.fields(find(&d, "Sphere"));
    assert_eq!(fields.len(), 2);
    assert_eq!(
        (fields[1].key.as_str(), fields[1].value.clone()),
        ("radius", Some(FieldValue::numbers([1.0])))
    );
    let (file, span) = fields[1].span.clone().unwrap();
    assert_eq!((file, &d.text()[span]), (FileId(0), "radius 1"));
    let matte = d.fields(find(&d, "Matte"));
    let roughness = matte.iter().find(|field| field.key == "roughness").unwrap();
    assert_eq!((roughness.value.clone(), roughness.span.clone()), (Some(FieldValue::numbers([0.0])), None));
    assert_eq!(roughness.kind, FieldKind::Number { min: 0.0, max: 1.0 });
    let references: Vec<_> =
        d.fields(find(&d, "Checkerboard")).into_iter().map(|f| (f.nth, f.value.unwrap())).collect();
    assert_eq!(references, [(0, FieldValue::word("red")), (1, FieldValue::numbers([1.0]))]);
    let moved: Vec<_> = d.fields(find(&d, "Transform")).into_iter().map(|f| f.key).collect();
    assert_eq!(moved, ["Translate"]);
}

#[test]
fn values_that_share_a_word_are_edited_one_by_one() {
    let prism = "Prism {\n  depth 1\n  outline {\n    line 0 0  1 0\n    line 1 1  0 1\n  }\n}";
    let mut d = good(&SCENE.replace("  Box { min 1 0 0  max 2 1 1 }", prism));
    let outline = find(&d, "outline");
    let lines: Vec<_> = d.fields(outline).into_iter().map(|f| (f.key, f.nth)).collect();
    assert_eq!(lines, [("line".to_owned(), 0), ("line".to_owned(), 1)]);
    let value = FieldValue::numbers([1.0, 1.0, 0.0, 2.0]);
    let second = Edit::Set { node: outline, key: "line".to_owned(), nth: Some(1), value };
    assert_eq!(diff(&mut d, &second), ["-    line 1 1  0 1", "+    line 1 1  0 2"]);
}

/// All stops of a ramp are fields, and one more; they are set as a list, in place, longer and shorter.
#[test]
fn lists_of_stops_are_edited_as_one() {
    let ramp = "Textures {\n  Cells m { }\n  Ramp r {\n    texture m\n    stop 0 1 0 0  # red\n    stop 1 0 0 1\n    frequency 2\n  }\n}";
    let mut d = good(&format!("{ramp}\n{SCENE}"));
    let node = find(&d, "Ramp");
    let fields = d.fields(node);
    let stops: Vec<_> =
        fields.iter().filter(|f| f.key == "stop").map(|f| (f.nth, f.span.is_some())).collect();
    assert_eq!(stops, [(0, true), (1, true), (2, false)]);
    let ramp = crate::Ramp::of(&fields).unwrap();
    assert_eq!(ramp.at(0.5), [0.5, 0.0, 0.5]);

    let set = |stops: &[crate::RampStop]| Edit::SetList {
        node,
        key: "stop".to_owned(),
        values: stops.iter().map(crate::RampStop::value).collect(),
    };
    let middle = ramp.with_stop(0.25);
    let longer = diff(&mut d, &set(&middle));
    assert_eq!(longer, ["+    stop 0.25 0.75 0 0.25"]);
    assert_eq!(crate::Ramp::of(&d.fields(node)).unwrap().stops, middle);
    let shorter = diff(&mut d, &set(&middle[1..]));
    let expected =
        ["-    stop 0 1 0 0  # red", "-    stop 0.25 0.75 0 0.25", "+    stop 0.25 0.75 0 0.25  # red"];
    assert_eq!(shorter, expected);
    // All of them may go, which is no ramp, and come again.
    d.apply(&set(&[])).unwrap();
    d.compile();
    assert!(crate::Ramp::of(&d.fields(node)).is_none() && !d.is_current());
    assert_eq!(diff(&mut d, &set(&middle[1..])), ["+    stop 0.25 0.75 0 0.25  stop 1 0 0 1"]);
    assert_eq!(crate::Ramp::of(&d.fields(node)).unwrap().stops, middle[1..]);
}

#[test]
fn blocks_are_added_where_they_belong() {
    let mut d = good(SCENE);
    let sphere = template("Sphere", [0.0, 1.0, 2.0], 0.5).unwrap();
    let added = diff(&mut d, &Edit::Add { into: None, block: sphere.clone() });
    assert_eq!(added, ["-  numObjects 3", "+  numObjects 4", "+  Sphere { center 0 1 2  radius 0.5 }"]);
    let spot = template("SpotLight", [0.0; 3], 1.0).unwrap();
    assert_eq!(diff(&mut d, &Edit::Add { into: None, block: spot })[0], "-  numLights 1");
    let glass = template("Glass", [0.0; 3], 1.0).unwrap();
    assert_eq!(diff(&mut d, &Edit::Add { into: None, block: glass }), ["+  Glass { }"]);
    let fog = "Fog { color 1 1 1  density 0.1 }".to_owned();
    assert_eq!(diff(&mut d, &Edit::Add { into: None, block: fog.clone() }), [format!("+{fog}")]);
    assert!(refusal(&mut d, &Edit::Add { into: None, block: fog }).contains("already"));
    assert!(refusal(&mut d, &Edit::Add { into: None, block: "Nonsense 1".into() }).contains("not one block"));
    assert!(
        refusal(&mut d, &Edit::Add { into: None, block: format!("{sphere} {sphere}") }).contains("not one")
    );

    let mut empty = document("");
    let added = empty.apply(&Edit::Add { into: None, block: sphere }).unwrap();
    assert_eq!(&*empty.node(added.created.unwrap()).unwrap().keyword, "Materials");
    empty
        .apply(&Edit::Add { into: None, block: template("PerspectiveCamera", [0.0; 3], 1.0).unwrap() })
        .unwrap();
    empty.compile();
    assert!(empty.is_current(), "{}", empty.report(false));
}

#[test]
fn every_template_compiles() {
    use crate::keywords_of;
    for keyword in [Kind::Shape, Kind::Light, Kind::Material, Kind::Group, Kind::Transform]
        .into_iter()
        .flat_map(keywords_of)
    {
        let Some(block) = template(keyword, [0.1, 0.2, 0.3], 0.7) else {
            assert!(
                ["AccretionDisk", "BTF", "Measured", "Model", "Text", "TriangleMesh"].contains(&keyword),
                "{keyword}"
            );
            continue;
        };
        let mut d = good(SCENE);
        let created = d.apply(&Edit::Add { into: None, block: block.clone() }).unwrap().created.unwrap();
        assert_eq!(&*d.node(created).unwrap().keyword, keyword);
        d.compile();
        assert!(d.is_current(), "{block}: {}", d.report(false));
    }
}

#[test]
fn what_is_deleted_leaves_no_trace() {
    let mut d = good(SCENE);
    let light = find(&d, "PointLight");
    assert_eq!(
        diff(&mut d, &Edit::Delete(light)),
        [
            "-  numLights 1",
            "-  PointLight { position 1 2 3  color 1 1 1 } # the only one",
            "+  numLights 0",
            "+   # the only one"
        ]
    );
    let ball = find(&d, "Box");
    assert_eq!(
        diff(&mut d, &Edit::Delete(ball)),
        ["-  numObjects 3", "-  Box { min 1 0 0  max 2 1 1 }", "+  numObjects 2"]
    );
    let disk = find(&d, "Disk");
    let gone = diff(&mut d, &Edit::Delete(disk));
    assert!(gone[1].contains("Transform"), "an empty transform goes with its object: {gone:?}");
    d.undo();
    assert_eq!(find(&d, "Disk"), disk, "what comes back is known again");
    d.redo();
    assert!(d.node(disk).is_none());
    while d.undo() {}
    assert_eq!(d.text(), SCENE);
}

#[test]
fn materials_in_use_stay() {
    let mut d = good(SCENE);
    let red = find(&d, "Matte");
    assert!(refusal(&mut d, &Edit::Delete(red)).contains("in use: line 10"), "the first that names it");
    let list = find(&d, "Materials");
    assert!(refusal(&mut d, &Edit::Delete(list)).contains("in use"));
    let text = SCENE.replace("Matte red", "Metal unused { }\n  Matte red");
    let mut d = good(
        &text.replace("materialIndex 1", "materialIndex 2").replace("MaterialIndex 1", "MaterialIndex 2"),
    );
    let metal = find(&d, "Metal");
    d.apply(&Edit::Delete(metal)).unwrap();
    assert_eq!(d.text(), SCENE, "references by number follow");
}

#[test]
fn the_material_of_others_stays_what_it_is() {
    let text = SCENE
        .replace(
            "Sphere ball",
            "Group { MaterialIndex 2  Cone { base 5 0 0  top 5 1 0  radius 1 } }\n  Sphere ball",
        )
        .replace("numObjects 3", "numObjects 4");
    let mut d = good(&text);
    let materials = |d: &Document| -> Vec<(String, u32)> {
        let scene = d.scene().unwrap();
        let objects = scene.geometry.objects.iter().zip(&scene.geometry.primitives);
        objects.map(|(o, p)| (o.keyword.to_owned(), scene.appearance.number(p.material))).collect()
    };
    let before = materials(&d);
    let group = d.node(find(&d, "Cone")).unwrap().parent.unwrap();
    diff(&mut d, &Edit::Delete(group));
    assert_eq!(materials(&d), before[1..], "{}", d.text());
    d.undo();

    let [sphere, disk] = ["Sphere", "Disk"].map(|keyword| find(&d, keyword));
    diff(&mut d, &Edit::MoveInto { node: disk, into: group });
    let mut moved = materials(&d);
    moved.sort();
    let mut expected = before.clone();
    expected.sort();
    assert_eq!(moved, expected, "{}", d.text());
    assert!(d.node(disk).is_some_and(|node| node.parent == Some(group)), "it is still the same node");
    d.undo();

    diff(&mut d, &Edit::Duplicate(group));
    let mut twice = before.clone();
    twice.insert(0, before[0].clone());
    assert_eq!(materials(&d), twice, "{}", d.text());
    d.undo();

    let green = d.outline().nodes().iter().filter(|n| n.kind == Kind::Material).nth(1).unwrap().id;
    for (node, at) in [(group, 0), (sphere, 1), (disk, 3)] {
        let mut painted = before.clone();
        painted[at].1 = 2;
        diff(&mut d, &Edit::Paint { node, material: green });
        assert_eq!((materials(&d), d.material_of(node)), (painted, Some(green)), "{}", d.text());
        d.undo();
    }
    d.compile();
    assert_eq!(materials(&d), before);
}

#[test]
fn names_are_followed_by_references() {
    let mut d = good(SCENE);
    let red = find(&d, "Matte");
    let renamed = diff(&mut d, &Edit::Rename { node: red, name: Some("deep red".into()) });
    assert_eq!(renamed.len(), 6, "{renamed:?}");
    assert!(renamed.contains(&"+  MaterialIndex \"deep red\"".to_owned()));
    diff(&mut d, &Edit::Rename { node: red, name: None });
    assert!(d.text().contains("MaterialIndex 0") && d.text().contains("  Matte { color 0.8"));
    let ball = find(&d, "Sphere");
    diff(&mut d, &Edit::Rename { node: ball, name: Some("2nd {#}".into()) });
    assert_eq!(d.node(ball).unwrap().name.as_deref(), Some("2nd {#}"));
    let camera = find(&d, "PerspectiveCamera");
    assert!(refusal(&mut d, &Edit::Rename { node: camera, name: Some("x".into()) }).contains("no name"));
    assert!(refusal(&mut d, &Edit::Rename { node: ball, name: Some("a\nb".into()) }).contains("one line"));
}

/// The `material` of a set operation is that of everything in it: references follow, and nothing is put there that it refuses.
#[test]
fn the_material_of_an_operation_is_that_of_all_in_it() {
    let pair = "Union pair { material red  Cone { base 3 0 0  top 3 1 0  radius 1 }  Cylinder { base 5 0 0  top 5 1 0  radius 1 } }
  Group { Merge { material 1  Torus { majorRadius 1  minorRadius 0.4 } } }
  Blob { sphere { center 0 0 0  radius 1  material red } sphere { center 1 0 0  radius 1 } }
  Sphere ball";
    let text = SCENE.replace("Sphere ball", pair).replace("numObjects 3", "numObjects 6");
    let text = text
        .replace("Materials {", "Materials { Metal unused { }")
        .replace("numMaterials 3", "numMaterials 4");
    let text =
        text.replace("materialIndex 1", "materialIndex 2").replace("MaterialIndex 1", "MaterialIndex 2");
    let mut d = good(&text.replace("material 1", "material 2"));
    let materials = |d: &Document| -> Vec<(String, u32)> {
        let scene = d.scene().unwrap();
        let objects = scene.geometry.objects.iter().zip(&scene.geometry.primitives);
        objects.map(|(o, p)| (o.keyword.to_owned(), scene.appearance.number(p.material))).collect()
    };
    let before = materials(&d);
    assert_eq!(before[..3], [("Cone".into(), 2), ("Cylinder".into(), 2), ("Merge".into(), 3)]);
    // Every reference by number or name follows.
    let metal = find(&d, "Metal");
    d.apply(&Edit::Delete(metal)).unwrap();
    d.compile();
    assert!(d.text().contains("Merge { material 1 "), "{}", d.text());
    let red = find(&d, "Matte");
    assert!(refusal(&mut d, &Edit::Delete(red)).contains("in use"));
    let renamed = diff(&mut d, &Edit::Rename { node: red, name: Some("rust".into()) });
    assert!(renamed.iter().any(|line| line.starts_with("+") && line.contains("Union pair { material rust ")));
    assert!(renamed.iter().any(|line| line.starts_with("+") && line.contains("radius 1  material rust }")));
    // Whatever stands in it shows its material, and is painted with it.
    let [union, cone, merge, torus] = ["Union", "Cone", "Merge", "Torus"].map(|keyword| find(&d, keyword));
    let green = d.outline().nodes().iter().filter(|n| n.kind == Kind::Material).nth(1).unwrap().id;
    let of = |d: &Document| [union, cone, merge, torus].map(|node| d.material_of(node));
    assert_eq!(of(&d), [Some(red), Some(red), Some(green), Some(green)]);
    assert!(refusal(&mut d, &Edit::Paint { node: cone, material: green }).contains("`Union`"));
    diff(&mut d, &Edit::Paint { node: union, material: green });
    assert_eq!(of(&d), [Some(green); 4]);
    diff(&mut d, &Edit::Paint { node: merge, material: red });
    assert_eq!(of(&d), [Some(green), Some(green), Some(red), Some(red)]);
    // A group that holds one is painted with it.
    let holder = d.node(merge).unwrap().parent.unwrap();
    for material in [green, red] {
        diff(&mut d, &Edit::Paint { node: holder, material });
        assert_eq!(
            (d.material_of(holder), d.material_of(torus)),
            (Some(material), Some(material)),
            "{}",
            d.text()
        );
    }
    // What is put into it needs no `MaterialIndex`, and what is taken out keeps the material.
    let ball = find(&d, "Sphere");
    let [was, lost] = [materials(&d).len(), 1];
    diff(&mut d, &Edit::MoveInto { node: ball, into: merge });
    assert_eq!((materials(&d).len(), d.material_of(ball)), (was - lost, Some(red)), "{}", d.text());
    let disk = find(&d, "Disk");
    let transform = d.node(disk).unwrap().parent.unwrap();
    let group = d.node(transform).unwrap().parent.unwrap();
    diff(&mut d, &Edit::MoveInto { node: cone, into: group });
    assert_eq!(d.material_of(cone), Some(green), "{}", d.text());
    diff(&mut d, &Edit::MoveInto { node: torus, into: group });
    assert_eq!(d.material_of(torus), Some(red), "{}", d.text());
    diff(&mut d, &Edit::Duplicate(ball));
    assert_eq!(d.text().matches("MaterialIndex rust  Torus").count(), 1, "{}", d.text());
}

#[test]
fn what_goes_by_a_name_stays_where_that_is_known() {
    let text = SCENE.replace(
        "numObjects 3",
        "MaterialIndex red  repeat k 2 { let x = 2 * k  Cone { base 0 0 0  top (x + 0) 1 0  radius 1 }  Quad { corner x 0 0  edge1 1 0 0  edge2 0 1 0 }  Cylinder { base 0 0 0  top 0 1 0  radius 1 } }\n  Group { }",
    );
    let mut d = good(&text);
    let mut inner =
        d.tree().outline.nodes().iter().filter(|node| node.kind == Kind::Group).map(|node| node.id);
    let group = inner.next_back().unwrap();
    for keyword in ["Cone", "Quad"] {
        let node = find(&d, keyword);
        let refused = refusal(&mut d, &Edit::MoveInto { node, into: group });
        assert!(refused.contains("names"), "{keyword}: {refused}");
    }
    let lid = find(&d, "Cylinder");
    d.apply(&Edit::MoveInto { node: lid, into: group }).unwrap();
    assert!(d.tree().whole);
}

#[test]
fn definitions_are_kept_while_they_are_used() {
    let text = SCENE.replace("numObjects 3", "numObjects 4\n  Define pin { Cone { base 0 0 0  top 0 1 0  radius 1 } }\n  MaterialIndex 1  Instance pin");
    let mut d = good(&text);
    let pin = find(&d, "Define");
    assert!(refusal(&mut d, &Edit::Delete(pin)).contains("in use: line 15"));
    let renamed = diff(&mut d, &Edit::Rename { node: pin, name: Some("cone".into()) });
    assert!(renamed[3].contains("Instance cone"), "{renamed:?}");
    let instance = find(&d, "Instance");
    let moved = diff(&mut d, &Edit::set(instance, "Translate", FieldValue::numbers([1.0, 0.0, 0.0])));
    assert!(moved[1].ends_with("Instance cone { Translate 1 0 0 }"), "{moved:?}");
    let sphere = find(&d, "Sphere");
    assert!(refusal(&mut d, &Edit::MoveInto { node: instance, into: pin }).contains("before"));
    diff(&mut d, &Edit::MoveInto { node: sphere, into: pin });
    let objects = d.scene().unwrap().geometry.objects.len();
    assert_eq!(objects, 4);
    // Both objects of the instance lead to it, and to what describes them.
    let [ball, cone] = [2, 1].map(|number| (d.node_of_object(number), d.part_of_object(number)));
    assert_eq!(ball, (Some(instance), Some(sphere)));
    assert_eq!(cone, (Some(instance), Some(find(&d, "Cone"))));
    assert_eq!((d.objects_of(pin), d.objects_of(sphere)), (vec![1, 2], vec![2]));
}

/// Each turn of a `repeat` has nodes of its own, and all of them have one text: moved to where that is last it stays.
#[test]
fn what_stands_last_by_its_text_stays_there() {
    let last = "  Transform { Translate 0 1 0  Disk { center 0 0 0  normal 0 1 0  radius 1 } }\n";
    assert!(SCENE.contains(last));
    let text = SCENE.replace(last, "  repeat i 3 {\n    Torus { center i 0 0  axis 0 1 0 }\n  }\n");
    let mut d = document(&text);
    let nodes = d.outline().nodes();
    let tori: Vec<_> = nodes.iter().filter(|node| &*node.keyword == "Torus").collect();
    assert_eq!(tori.len(), 3, "{}", d.text());
    let (first, group) = (tori[0].id, find(&d, "Group"));
    let applied = d.apply(&Edit::MoveInto { node: first, into: group }).unwrap();
    assert!(!applied.changed && d.text() == text);
}

#[test]
fn a_gesture_is_one_step() {
    let mut d = good(SCENE);
    let ball = find(&d, "Sphere");
    d.begin_gesture("drag");
    for x in [0.5, 1.0, 1.5] {
        d.apply(&Edit::set(ball, "center", FieldValue::numbers([x, 0.0, 0.0]))).unwrap();
    }
    d.end_gesture();
    assert!(d.text().contains("center 1.5 0 0"));
    assert_eq!(d.undo_label(), Some("drag"));
    assert!(d.undo() && !d.undo());
    assert_eq!(d.text(), SCENE);
    d.begin_gesture("drag");
    d.apply(&Edit::set(ball, "radius", FieldValue::numbers([3.0]))).unwrap();
    d.cancel_gesture();
    assert_eq!((d.text(), d.redo_label()), (SCENE, Some("drag")), "what never happened hides nothing");
    assert!(d.redo() && d.text().contains("center 1.5 0 0"));
}

#[test]
fn a_broken_scene_keeps_the_last_good_one() {
    let mut d = good(SCENE);
    let ball = find(&d, "Sphere");
    let scene = Arc::clone(d.scene().unwrap());
    d.apply(&Edit::Unset { node: ball, key: "radius".into(), nth: None }).unwrap();
    d.compile();
    assert!(!d.is_current() && Arc::ptr_eq(d.scene().unwrap(), &scene));
    assert_eq!(d.lines().collect::<Vec<_>>().len(), 1);
    let (file, range) = d.range_of(d.diagnostics().errors().next().unwrap()).unwrap();
    assert_eq!((file, &d.text()[range]), (FileId(0), "Sphere"));
    assert_eq!(d.node_of_object(1), Some(ball), "of the scene that is shown");
    d.apply(&Edit::Rewrite { file: FileId(0), text: SCENE.replace("Group {", "Group { {") }).unwrap();
    assert!(refusal(&mut d, &Edit::Delete(ball)).contains("not closed"));
    d.undo();
    d.undo();
    d.compile();
    assert!(d.is_current());
}

#[test]
fn files_are_saved_reloaded_and_watched() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.txt");
    let part = folder.path().join("part.txt");
    let main = SCENE.replace("numObjects 3", "include part.txt\n  numObjects 4");
    fs::write(&path, &main).unwrap();
    fs::write(&part, "Cone { base 0 0 0  top 0 1 0  radius 1 } # mine\r\n").unwrap();
    let main = main.replace(
        "include part.txt\n  numObjects 4\n  MaterialIndex red",
        "numObjects 4\n  MaterialIndex red\n  include part.txt",
    );
    fs::write(&path, &main).unwrap();
    let mut d = Document::open(&path, LoadOptions::default()).unwrap();
    d.compile();
    assert!(d.is_current() && !d.is_dirty() && !d.changed_on_disk(), "{}", d.report(false));
    let cone = find(&d, "Cone");
    d.apply(&Edit::set(cone, "radius", FieldValue::numbers([2.0]))).unwrap();
    assert!(d.is_dirty() && d.text() == main);
    d.compile();
    assert!(d.is_current());
    d.save().unwrap();
    assert!(!d.is_dirty() && !d.changed_on_disk());
    assert_eq!(fs::read_to_string(&part).unwrap(), "Cone { base 0 0 0  top 0 1 0  radius 2 } # mine\r\n");
    assert_eq!(fs::read_to_string(&path).unwrap(), main);

    // Another program edits both; the node is known again, and the step can be taken back.
    let ball = find(&d, "Sphere");
    fs::write(&path, main.replace("# A small scene.", "# Somebody was here.\n")).unwrap();
    fs::write(&part, "# New.\nCone { base 0 0 0  top 0 1 0  radius 2 } # mine\r\n").unwrap();
    assert!(d.changed_on_disk());
    assert!(d.reload().unwrap().changed);
    assert!(!d.is_dirty() && !d.changed_on_disk());
    assert_eq!((find(&d, "Sphere"), find(&d, "Cone")), (ball, cone));
    d.undo();
    assert!(d.is_dirty() && d.text() == main);

    let copy = folder.path().join("copy.txt");
    d.save_as(&copy).unwrap();
    assert!(d.path() == Some(&copy) && !d.is_dirty());
    assert_eq!(fs::read_to_string(&copy).unwrap(), main);
    fs::remove_file(&copy).unwrap();
    assert!(matches!(d.reload(), Err(DocumentError::Read { .. })));
    fs::write(&copy, [0xff, 0xfe]).unwrap();
    assert!(d.reload().unwrap_err().to_string().contains("not text"));
    assert!(matches!(document(SCENE).save(), Err(DocumentError::Untitled)));
}

#[test]
fn a_mesh_is_read_once_until_its_file_changes() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = folder.path().join("tent.obj");
    fs::write(&mesh, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    let text = SCENE.replace("Sphere ball { center 0 0 0  radius 1 }", "TriangleMesh { obj_file tent.obj }");
    let mut d = Document::untitled(folder.path(), &text, LoadOptions::default()).unwrap();
    let triangles = |d: &mut Document| {
        d.compile();
        assert!(d.is_current(), "{}", d.report(false));
        d.scene().unwrap().geometry.shapes.meshes[0].triangle_count()
    };
    assert_eq!((triangles(&mut d), d.meshes.len()), (1, 1));
    let first = d.scene().unwrap().clone();
    let light = find(&d, "PointLight");
    d.apply(&Edit::set(light, "position", FieldValue::numbers([4.0, 4.0, 4.0]))).unwrap();
    triangles(&mut d);
    let shared = |a: &Scene, b: &Scene| {
        std::ptr::eq(a.geometry.shapes.meshes[0].positions(), b.geometry.shapes.meshes[0].positions())
    };
    assert!(shared(&first, d.scene().unwrap()), "an edit elsewhere reads nothing again");

    fs::write(&mesh, "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\n").unwrap();
    d.undo();
    assert_eq!((triangles(&mut d), d.meshes.len()), (2, 1), "the old one is forgotten");
}

#[test]
fn a_document_can_be_made_by_another_thread() {
    fn is_send<T: Send>() {}
    is_send::<Document>();
}

fn gallery() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/gallery");
    let files = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut scenes: Vec<_> =
        files.filter(|p| p.extension().is_some_and(|e| e == "txt") && !p.ends_with("manifest.txt")).collect();
    scenes.sort();
    assert!(scenes.len() > 20);
    scenes
}

/// Some edit that depends on `dice`: of any node, sensible or not.
fn some_edit(d: &Document, dice: &mut impl FnMut(usize) -> usize) -> Option<Edit> {
    let nodes = d.outline().nodes();
    // Where nothing is left, only something new can come.
    let Some(node) = nodes.get(dice(nodes.len().max(1))) else { return some_addition(None, dice) };
    let other = nodes[dice(nodes.len())].id;
    let number = dice(2001) as f64 / 100.0 - 10.0;
    Some(match dice(12) {
        0..=4 => {
            let fields = d.fields(node.id);
            let field = fields.get(dice(fields.len().max(1)))?;
            let mut value = field.value.clone().unwrap_or_else(|| FieldValue::numbers([1.0, 2.0, 3.0]));
            value.numbers.iter_mut().for_each(|n| *n = (*n * 0.5 + number) as f32 as f64);
            Edit::Set { node: node.id, key: field.key.clone(), nth: Some(field.nth), value }
        }
        5 => {
            let fields = d.fields(node.id);
            Edit::Unset { node: node.id, key: fields.get(dice(fields.len().max(1)))?.key.clone(), nth: None }
        }
        6 => Edit::Delete(node.id),
        7 => Edit::Duplicate(node.id),
        8 => Edit::MoveInto { node: node.id, into: other },
        9 => Edit::Rename { node: node.id, name: (dice(3) > 0).then(|| format!("name {number}")) },
        10 => Edit::Paint { node: node.id, material: other },
        _ => return some_addition(Some(other), dice),
    })
}

/// A new block, at the end of the text or in a node.
fn some_addition(node: Option<NodeId>, dice: &mut impl FnMut(usize) -> usize) -> Option<Edit> {
    let keywords = ["Sphere", "Box", "Quad", "PointLight", "Glass", "Marble", "Cone", "Group"];
    let x = dice(2001) as f64 / 100.0 - 10.0;
    let block = template(keywords[dice(keywords.len())], [x, 1.0, 0.0], 0.5)?;
    Some(Edit::Add { into: node.filter(|_| dice(2) > 0), block })
}

/// Applies `n` edits drawn by `dice` and takes all of them back; returns how many were possible.
fn edit_and_undo(d: &mut Document, n: usize, dice: &mut impl FnMut(usize) -> usize) -> usize {
    let before: Vec<_> = d.files().map(|(_, file)| file.text.clone()).collect();
    let mut done = 0;
    for _ in 0..n {
        let Some(edit) = some_edit(d, dice) else { continue };
        let was_whole = d.tree().whole;
        match d.apply(&edit) {
            Ok(_) => done += 1,
            Err(refused) => assert!(!refused.to_string().contains("overlap"), "{edit:?}: {refused}"),
        }
        assert!(d.tree().whole || !was_whole, "{edit:?} broke the text:\n{}", d.text());
    }
    while d.undo() {}
    let after: Vec<_> = d.files().map(|(_, file)| file.text.clone()).collect();
    assert!(before.iter().zip(&after).all(|(a, b)| a == b), "{}", d.text());
    done
}

/// Numbers below a bound that depend on nothing but `seed`.
fn dice(seed: u64) -> impl FnMut(usize) -> usize {
    let mut drawn = 0;
    move |sides| {
        drawn += 1;
        kajo_math::rng::mix(seed ^ (drawn << 20)) as usize % sides
    }
}

#[test]
fn a_thousand_edits_are_undone_byte_for_byte() {
    for (seed, path) in (0..).zip(gallery()) {
        let mut d = Document::open(&path, LoadOptions::default()).unwrap();
        let n = if seed == 0 || kajo_testkit::is_deep() { 1000 } else { 60 };
        let done = edit_and_undo(&mut d, n, &mut dice(seed));
        assert!(done > n / 5, "{}: only {done} of {n} edits were possible", path.display());
        assert!(!d.is_dirty());
    }
}

#[test]
fn any_way_of_writing_is_kept() {
    let config = Config { cases: 24, failure_persistence: None, ..Config::default() };
    let mut runner = TestRunner::new_with_rng(config, TestRng::deterministic_rng(RngAlgorithm::ChaCha));
    let styles =
        (any::<u64>(), any::<bool>(), prop::sample::select(vec!["\n", "\r\n", "\r"]), any::<[bool; 3]>());
    runner
        .run(&styles, |(seed, bom, newline, [tabs, glued, comments])| {
            let mut text = SCENE.replace('\n', newline);
            if tabs {
                text = text.replace("  ", "\t");
            }
            if glued {
                text = text.replace(" {", "{").replace("{ ", "{").replace(" }", "}");
            }
            if comments {
                text = text.replace(" center ", " /* c } */ center ").replace("}\n", "} // end {\n");
            }
            if bom {
                text.insert(0, '\u{feff}');
            }
            edit_and_undo(&mut document(&text), 150, &mut dice(seed));
            Ok(())
        })
        .unwrap();
}

#[test]
fn saved_and_edited_scenes_make_the_same_picture() {
    use kajo::{Defaults, Format, RenderSettings, Settings, Silent, View};
    let picture = |scene: &Scene| {
        let asked = Settings { size: Some([24, 18]), ..Settings::default() };
        let settings = RenderSettings::resolve(scene, &asked, Defaults::Modern, false).unwrap();
        let outputs = [(View::Color, Format::Pfm)];
        let picture = kajo::render(&kajo::RenderRequest::new(scene, &settings, &outputs), &Silent).unwrap();
        picture.encode(&[View::Color], Format::Pfm, kajo::BitDepth::Eight).unwrap()
    };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.txt");
    fs::write(&path, SCENE).unwrap();
    let mut d = Document::open(&path, LoadOptions::default()).unwrap();
    let ball = find(&d, "Sphere");
    d.compile();
    let before = picture(d.scene().unwrap());
    d.apply(&Edit::set(ball, "center", FieldValue::numbers([-f64::from(0.123_456_79_f32), 0.5, 1e-7])))
        .unwrap();
    d.apply(&Edit::Add { into: None, block: template("Quad", [0.0, -1.0, 0.0], 3.0).unwrap() }).unwrap();
    d.compile();
    let edited = picture(d.scene().unwrap());
    d.save().unwrap();
    let saved = kajo::load(&path, &LoadOptions::default());
    assert!(edited == picture(saved.scene.as_ref().unwrap()) && edited != before);
}
