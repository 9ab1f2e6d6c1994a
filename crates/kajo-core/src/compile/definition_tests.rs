//! Definitions and their instances.

use kajo_math::Vec3;
use kajo_scene::{MemoryAssets, Severity};

use super::tests::{CAMERA, RED, error_in_group, look, roof, scene, with_files};
use super::*;

const BALL: &str = "Sphere { center 0 0 0 radius 1 }";

#[test]
fn instances_stand_where_their_operations_say() {
    let s = scene(&format!(
        "{CAMERA}{RED}Group {{ Define pair {{ {BALL} Transform {{ Translate 0 3 0 Group {{ MaterialIndex 1 {BALL} }} }} }}
         MaterialIndex red Instance pair
         Instance pair {{ Translate 5 0 0 UniformScale 0.5 }}
         Transform {{ Translate -5 0 0 Instance pair {{ ZRotate 180 }} }} }}"
    ));
    let (red, green) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
    for (x, y, z, color) in [
        (0.0, 0.0, 1.0, red),
        (0.0, 3.0, 1.0, green),
        (5.0, 0.0, 0.5, red),
        (5.0, 1.5, 0.5, green),
        (-5.0, 0.0, 1.0, red),
        (-5.0, -3.0, 1.0, green),
    ] {
        let (p, _, found) = look(&s, x, y).unwrap_or_else(|| panic!("nothing at {x} {y}"));
        assert!((p.z - z).abs() < 1e-4 && found == color, "{x} {y}: {p} {found:?}");
    }
    assert_eq!(s.geometry.shapes.spheres.len(), 2, "stored once");
    assert_eq!(s.geometry.primitives.len(), 6);
}

#[test]
fn definitions_nest_and_take_the_material_in_force() {
    let s = scene(&format!(
        "{CAMERA}{RED}Group {{ Define ball {{ Sphere pearl {{ center 0 0 0 radius 0.1 }} }}
         Define row {{ MaterialIndex 1 Instance ball MaterialIndex red Instance ball {{ Translate 1 0 0 }} }}
         Define block {{ Instance row  Instance row {{ Translate 0 1 0 }} Instance ball {{ Translate 0 2 0 }} }}
         MaterialIndex 1 Instance block  MaterialIndex red  Instance block {{ Translate 0 0 -3 }} }}"
    ));
    assert_eq!((s.geometry.primitives.len(), s.geometry.shapes.spheres.len()), (10, 1));
    let numbers: Vec<u32> = s.geometry.primitives.iter().map(|p| s.appearance.number(p.material)).collect();
    assert_eq!(numbers, [2, 1, 2, 1, 2, 2, 1, 2, 1, 1], "a definition's own first, then the instance's");
    assert!(s.geometry.objects.iter().all(|o| o.name == Some("pearl") && o.keyword == "Sphere"));
    let all: Vec<_> = s.geometry.objects.iter().collect();
    assert!(all.iter().all(|o| o.described_by == all[0].described_by), "one text for all of them");
    let first = all[0].placed_by;
    assert!(all[..5].iter().all(|o| o.placed_by == first), "the outermost instance");
    assert!(all[5..].iter().all(|o| o.placed_by == first + 2), "the other, past `MaterialIndex red`");
    assert_eq!(look(&s, 1.0, 1.0).unwrap().2, [1.0, 0.0, 0.0]);
}

#[test]
fn triangles_of_a_definition_keep_their_side_when_mirrored() {
    let s = scene(&format!(
        "{CAMERA}{RED}Group {{ Define t {{ Transform {{ Translate 1 0 0
         Triangle {{ vertex0 0 0 0 vertex1 1 0 0 vertex2 0 1 0 }} }} }}
         MaterialIndex 0 Instance t {{ Scale -1 1 1 }} }}"
    ));
    let (_, n, _) = look(&s, -1.2, 0.2).unwrap();
    assert!(n.distance(Vec3::Z) < 1e-6, "{n}");
}

#[test]
fn wrong_definitions_are_told() {
    for (group, said) in [
        ("Define { }", "`Define` needs a name"),
        ("Instance { }", "`Instance` needs the name of a definition"),
        ("Instance tree", "there is no definition named `tree` before this"),
        ("Define a { Instance a }", "there is no definition named `a` before this"),
        ("Define a { } Define a { }", "there are two definitions named `a`"),
        ("Define a { Sphere { center 0 0 0 radius 1 } } Instance a", "`Instance` has no material"),
        ("Define a { } Instance a { Sphere { center 0 0 0 radius 1 } }", "unknown"),
    ] {
        let found = error_in_group(group);
        assert!(found.contains(said), "{group}: {found}");
    }
}

#[test]
fn exponential_nesting_is_refused_before_it_costs() {
    let mut text = format!("Define d0 {{ {BALL} }} ");
    for i in 1..64 {
        let ten = format!("Instance d{} ", i - 1).repeat(10);
        text += &format!("Define d{i} {{ {ten} }} ");
    }
    let mut parsed =
        SceneDesc::parse_str(&format!("{CAMERA}{RED}Group {{ {text} MaterialIndex 0 Instance d63 }}"));
    let limits = Limits { objects: 100_000, ..Limits::default() };
    let options = CompileOptions { limits, ..CompileOptions::default() };
    let mut diagnostics = parsed.diagnostics;
    assert!(compile(&mut parsed.desc, &MemoryAssets::new(), &options, &mut diagnostics).is_none());
    let said: Vec<_> = diagnostics.iter().map(|d| &d.message).collect();
    assert_eq!(said, ["with this there would be more objects than can be numbered, about 4 * 10^9"]);
}

/// A look at all names for each of them would take minutes.
#[test]
fn many_names_are_looked_up_one_by_one() {
    let count = 20_000;
    let named = |i: usize| format!("material_with_a_long_name_{i}");
    let materials: String = (0..count).map(|i| format!("Material {} {{ }}\n", named(i))).collect();
    let objects: String = (0..count).map(|i| format!("MaterialIndex {} {BALL}\n", named(i))).collect();
    let mixtures: String = (1..count)
        .step_by(2)
        .map(|i| format!("Checkerboard {{ materialIndex {} materialIndex {} }}\n", named(i), named(i - 1)))
        .collect();
    let s = scene(&format!("{CAMERA}Materials {{ {materials}{mixtures} }} Group {{ {objects} }}"));
    assert_eq!(s.geometry.object_count() as usize, count);
    // As many wrong ones; suggestions are made for the first twenty.
    let wrong = objects.replace("MaterialIndex material", "MaterialIndex Material");
    let text = format!("{CAMERA}Materials {{ {materials} }} Group {{ {wrong} }}");
    let mut parsed = SceneDesc::parse_str(&text);
    let mut diagnostics = parsed.diagnostics;
    let options = CompileOptions::default();
    assert!(compile(&mut parsed.desc, &MemoryAssets::new(), &options, &mut diagnostics).is_none());
    let helped =
        diagnostics.iter().filter(|d| d.help.iter().any(|help| help.contains("did you mean"))).count();
    assert_eq!((diagnostics.count(Severity::Error), helped), (count, 20));
}

/// Ten thousand objects; with `KAJO_DEEP` set, a million.
#[test]
fn many_instances_take_little_memory_and_are_all_hit() {
    let side = if kajo_testkit::is_deep() { 1000 } else { 100 };
    let row: String = (0..side).map(|i| format!("Instance ball {{ Translate {i} 0 0 }} ")).collect();
    let block: String = (0..side).map(|i| format!("Instance row {{ Translate 0 {i} 0 }} ")).collect();
    let s = scene(&format!(
        "{CAMERA}{RED}Group {{ Define ball {{ Sphere {{ center 0 0 0 radius 0.25 }} }} Define row {{ {row} }}
         MaterialIndex 0 {block} }}"
    ));
    let objects = s.geometry.object_count() as usize;
    assert_eq!((objects, s.geometry.shapes.spheres.len()), (side * side, 1));
    let each = s.geometry.bytes() / objects;
    assert!(each < 250, "{each} bytes an object");
    for i in 0..side {
        let (x, y) = (i as f32, (i * 7 % side) as f32);
        let (p, _, _) = look(&s, x, y).unwrap_or_else(|| panic!("nothing at {x} {y}"));
        assert!((p.z - 0.25).abs() < 1e-4 && look(&s, x + 0.5, y).is_none(), "{p}");
    }
}

#[test]
fn a_mesh_is_stored_once_however_often_it_is_placed() {
    let place = |n: usize| {
        let instances: String = (0..n).map(|i| format!("Instance roof {{ Translate {i} 0 0 }} ")).collect();
        let roof_block =
            "Define roof { TriangleMesh { file roof.ply } } Define row { Instance roof Instance roof }";
        let (scene, said) = with_files(
            &format!("Group {{ MaterialIndex 0 {roof_block} {instances} Instance row }}"),
            &roof(),
        );
        scene.unwrap_or_else(|| panic!("{said:?}"))
    };
    let (few, many) = (place(1), place(50));
    assert_eq!((few.geometry.shapes.meshes.len(), many.geometry.shapes.meshes.len()), (1, 1));
    assert_eq!((few.geometry.object_count(), many.geometry.object_count()), (3, 52));
}

#[test]
fn a_definition_in_a_transform_is_not_moved_and_not_counted() {
    let s = scene(&format!(
        "{CAMERA}{RED}Group {{ numObjects 2 MaterialIndex 0
         Define other {{ {BALL} }}
         Transform {{ Translate 9 0 0 Define ball {{ numObjects 1 {BALL} }} Instance ball }} Instance ball }}"
    ));
    assert!(look(&s, 0.0, 0.0).is_some() && look(&s, 9.0, 0.0).is_some());
    assert_eq!(s.geometry.primitives.len(), 2);
}
