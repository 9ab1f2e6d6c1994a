//! Solids made of solids, as they are written.

use kajo_math::{Ray, Vec3};
use kajo_scene::{MemoryAssets, SceneDesc};

use super::tests::scene;
use super::*;
use crate::scene::RayEvent;

const HEAD: &str = "PerspectiveCamera { center 0 0 10 direction 0 0 -1 up 0 1 0 angle 30 }
Materials { Material red { diffuseColor 1 0 0 } Material green { diffuseColor 0 1 0 } }\n";

fn of(group: &str) -> Scene {
    scene(&format!("{HEAD}Group {{ MaterialIndex red {group} }}"))
}

/// What a ray down the z axis from (x, y) meets first: how high, and of which colour.
fn look(scene: &Scene, x: f32, y: f32) -> Option<(f32, [f32; 3])> {
    match scene.trace(&Ray::new(Vec3::new(x, y, 10.0), Vec3::NEG_Z)) {
        RayEvent::Surface(at) => {
            let phong = scene.appearance.phong(at.material, &scene.texture_context(&at));
            Some(((at.point.p.z * 1e4).round() / 1e4, phong.diffuse.to_rgb()))
        }
        RayEvent::Escaped => None,
    }
}

/// Everything that is said about a group with a mistake.
fn report(group: &str) -> String {
    let open = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\n";
    let assets = MemoryAssets::new().with("open.obj", open);
    let mut parsed = SceneDesc::parse_str(&format!("{HEAD}Group {{ MaterialIndex red {group} }}"));
    let mut diagnostics = parsed.diagnostics;
    let scene = compile(&mut parsed.desc, &assets, &CompileOptions::default(), &mut diagnostics);
    assert!(scene.is_none(), "accepted: {group}");
    diagnostics.iter().map(|diagnostic| format!("{diagnostic:?}\n")).collect()
}

const RED: [f32; 3] = [1.0, 0.0, 0.0];
const GREEN: [f32; 3] = [0.0, 1.0, 0.0];
const BLUE: [f32; 3] = [0.0, 0.0, 1.0];

/// With a corner towards the viewer, of a material of its own.
const TETRAHEDRON: &str = "mtllib cube.mtl\nusemtl own\nv -1 -1 0\nv 1 -1 0\nv -1 1 0\nv -1 -1 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";

#[test]
fn faces_keep_the_materials_of_their_operands() {
    let cube = "Box { min -1 -1 -1 max 1 1 1 }";
    let scene =
        of(&format!("Difference {{ {cube} MaterialIndex green Sphere {{ center 0 0 1 radius 0.5 }} }}"));
    assert_eq!(look(&scene, 0.8, 0.8), Some((1.0, RED)));
    assert_eq!(look(&scene, 0.0, 0.0), Some((0.5, GREEN)));
    assert_eq!(scene.geometry.primitives.len(), 1);
    // Without a material of its own a block has the one before it, wherever what it is made of was described.
    let scene = of(&format!(
        "Define cube {{ {cube} }} MaterialIndex green
         Difference {{ Instance cube Group {{ Sphere {{ center 0 0 1 radius 0.5 }} Sphere {{ center 0.8 0.8 1 radius 0.1 }} }} }}"
    ));
    assert_eq!(look(&scene, 0.0, 0.0), Some((0.5, GREEN)));
    assert_eq!(look(&scene, 0.8, 0.8), Some((0.9, GREEN)));
    assert_eq!(look(&scene, -0.8, 0.8), Some((1.0, GREEN)));
}

/// What a block says of its material holds for all of its faces, whatever brings another one.
#[test]
fn a_material_of_the_block_holds_for_all_its_faces() {
    let cube = "Box { min -1 -1 -1 max 1 1 1 }";
    let hole = "MaterialIndex blue Sphere { center 0 0 1 radius 0.5 }";
    let blue = HEAD.replace("Materials {", "Materials { Material blue { diffuseColor 0 0 1 }");
    let of = |group: &str| scene(&format!("{blue}Group {{ {group} }}"));
    let both =
        |scene: &Scene| [look(scene, 0.8, 0.8), look(scene, 0.0, 0.0)].map(|seen| seen.map(|(_, c)| c));
    let without = of(&format!("MaterialIndex red Difference {{ {cube} {hole} }}"));
    assert_eq!(both(&without), [Some(RED), Some(BLUE)]);
    // No other material is needed then, and what comes after the block has none of it.
    let held = format!("Group {{ {cube} }} Group {{ {hole} }}");
    let beside = "Sphere { center 5 0 0 radius 0.1 }";
    let own = of(&format!("Difference {{ material green {held} }} {beside}"));
    assert_eq!(both(&own), [Some(GREEN), Some(GREEN)]);
    assert_eq!(own.geometry.primitives.len(), 2);
    // The material that is in force behind it is that of the last `MaterialIndex`, as always.
    let last = own.geometry.primitives[1].material;
    assert_eq!(last, own.appearance.list[0].0);
    // An operand's is one of several, and gives way to that of a block around it.
    let inner = format!("Merge {{ material green {held} }}");
    let ball = "Sphere { center 0 0 1.2 radius 0.5 }";
    let around = of(&format!("Difference {{ {inner} MaterialIndex red {ball} }}"));
    assert_eq!(both(&around), [Some(GREEN), Some(RED)]);
    let outer = of(&format!("MaterialIndex red Difference {{ material 0 {inner} {ball} }}"));
    assert_eq!(both(&outer), [Some(BLUE), Some(BLUE)]);
    // Meshes that bring materials of their own are no exception.
    let assets = MemoryAssets::new().with("cube.obj", TETRAHEDRON).with("cube.mtl", "newmtl own\nKd 1 1 0\n");
    let with_mesh = |material: &str| {
        let mesh = "TriangleMesh { file cube.obj  materials on }";
        let text = format!("{blue}Group {{ MaterialIndex red Merge {{ {material} {mesh} {ball} }} }}");
        let mut parsed = SceneDesc::parse_str(&text);
        let mut said = parsed.diagnostics;
        let scene = compile(&mut parsed.desc, &assets, &CompileOptions::default(), &mut said);
        look(&scene.unwrap_or_else(|| panic!("{said:?}")), -0.5, -0.5).map(|(_, color)| color)
    };
    assert_eq!(with_mesh(""), Some([1.0, 1.0, 0.0]));
    assert_eq!(with_mesh("material green"), Some(GREEN));
}

/// A `Union` is a group, and its material that of all objects in it, whatever they bring.
#[test]
fn a_material_of_a_union_holds_for_all_its_objects() {
    let head = HEAD.replace("Materials {", "Materials { Material blue { diffuseColor 0 0 1 }");
    let assets = MemoryAssets::new().with("cube.obj", TETRAHEDRON).with("cube.mtl", "newmtl own\nKd 1 1 0\n");
    let of = |group: &str| {
        let mut parsed = SceneDesc::parse_str(&format!("{head}Group {{ {group} }}"));
        let mut said = parsed.diagnostics;
        let scene = compile(&mut parsed.desc, &assets, &CompileOptions::default(), &mut said);
        scene.unwrap_or_else(|| panic!("{said:?}"))
    };
    let carved =
        "Difference { Box { min -1 -1 -1 max 1 1 1 } MaterialIndex red Sphere { center 0 0 1 radius 0.5 } }";
    let mesh = "TriangleMesh { file cube.obj  materials on }";
    let objects = format!(
        "Group {{ MaterialIndex blue {carved} }} Instance cut {{ Translate 3 0 0 }}
         Transform {{ Translate -3 0 0 Blob {{ sphere {{ center 0 0 0 radius 1 material red }} sphere {{ center 0 0 0.1 radius 1 }} }} }}
         Transform {{ Translate 0 3 0 {mesh} }} Union {{ material red Sphere {{ center 0 -3 0 radius 1 }} }}"
    );
    let places = [(0.0, 0.0), (0.8, 0.8), (3.0, 0.0), (3.8, 0.8), (-3.0, 0.0), (-0.5, 2.5), (0.0, -3.0)];
    let colors = |scene: &Scene| places.map(|(x, y)| look(scene, x, y).map(|(_, color)| color).unwrap());
    let define = format!("Define cut {{ MaterialIndex blue {carved} }}");
    let without = of(&format!("{define} MaterialIndex blue Union {{ {objects} }}"));
    let mixed = colors(&without)[4];
    let yellow = [1.0, 1.0, 0.0];
    assert_eq!(colors(&without), [RED, BLUE, RED, BLUE, mixed, yellow, RED]);
    assert!([RED, BLUE].contains(&mixed), "one of the two, drawn: {mixed:?}");
    // No other material is needed, what comes after the block has none of it, and it remains a group.
    let beside = "Sphere { center 9 0 0 radius 0.1 }";
    let with = of(&format!("{define} Union {{ material green {objects} }} MaterialIndex red {beside}"));
    assert_eq!(colors(&with), [GREEN; 7]);
    assert_eq!(with.geometry.primitives.len(), 6);
    assert_eq!(look(&with, 9.0, 0.0), Some((0.1, RED)));
    // In another operation it is an operand of this material, and gives way to that of what is around it.
    let pair = "Union { material green Sphere { center 0 0 1 radius 0.5 } MESH }".replace("MESH", mesh);
    let carves = |own: &str| {
        of(&format!("MaterialIndex blue Difference {{ {own} Box {{ min -1 -1 -1 max 1 1 1 }} {pair} }}"))
    };
    let both =
        |scene: &Scene| [(0.8, 0.8), (-0.1, -0.1)].map(|(x, y)| look(scene, x, y).map(|(_, color)| color));
    assert_eq!(both(&carves("")), [Some(BLUE), Some(GREEN)]);
    assert_eq!(both(&carves("material red")), [Some(RED), Some(RED)]);
}

#[test]
fn materials_that_contradict_each_other_are_refused() {
    let ball = "Sphere { center 0 0 0 radius 1 }";
    let said = report(&format!("Difference {{ material green MaterialIndex red {ball} }}"));
    assert!(said.contains("has a `material` for all its faces") && said.contains("leave out"), "{said}");
    let said = report(&format!("Merge {{ material grene {ball} }}"));
    assert!(said.contains("grene") && said.contains("did you mean `green`"), "{said}");
    let said = report(&format!("Union {{ material green MaterialIndex red {ball} }}"));
    assert!(said.contains("this `Union` has a `material` for all its faces"), "{said}");
    let said = report(&format!("Union {{ material grene {ball} }}"));
    assert!(said.contains("did you mean `green`") && !said.contains("has no material"), "{said}");
}

#[test]
fn operations_stand_in_operations_and_under_transforms() {
    let scene = of("Define pill { Merge { Sphere { center -1 0 0 radius 0.5 } Sphere { center 1 0 0 radius 0.5 }
                    Cylinder { base -1 0 0 top 1 0 0 radius 0.5 } } }
                    Difference {
                      Union { Instance pill Instance pill { ZRotate 90 } }
                      Transform { Translate 0 0 0.5 Intersection { Box { min -9 -9 0 max 9 9 9 } Plane { normal 0 1 0 offset 0.2 } } }
                      Instance pill { UniformScale 0.5 }
                    }");
    assert_eq!(look(&scene, 0.0, 1.0), Some((0.5, RED)), "above the cut");
    assert_eq!(look(&scene, 0.0, -1.4), Some((0.3, RED)), "the rounded end");
    assert_eq!(look(&scene, 0.0, 0.0), Some((0.5, RED)), "the cut touches the top");
    let hollow = Ray::new(Vec3::new(0.0, 0.0, 0.0), Vec3::NEG_Z);
    let RayEvent::Surface(at) = scene.trace(&hollow) else { panic!("the cavity has a wall") };
    assert!((at.point.p.z + 0.25).abs() < 1e-5 && at.point.n.z > 0.99, "{} {}", at.point.p, at.point.n);
}

#[test]
fn a_union_by_itself_is_a_group() {
    let scene = of("Union { Sphere { center 0 0 0 radius 1 } Disk { center 3 0 0 normal 0 0 1 radius 1 } }");
    assert_eq!(scene.geometry.primitives.len(), 2);
    let scene = of("Merge pair { Sphere { center 0 0 0 radius 1 } Sphere { center 1 0 0 radius 1 } }");
    assert_eq!(scene.geometry.primitives.len(), 1);
}

#[test]
fn a_solid_moves_as_a_whole() {
    let moving = "Motion { key 0 { } key 1 { Translate 4 0 0 } }";
    let ball = "Sphere { center 0 0 0 radius 1 }";
    let hole = "Sphere { center 0 0 1 radius 0.5 }";
    let text = format!("Transform {{ {moving} Difference {{ {ball} {hole} }} }}");
    let scene = of(&text);
    assert!(scene.moves());
}

#[test]
fn what_cannot_hold_moving_operands_says_so() {
    let moving = "Motion { key 0 { } key 1 { Translate 4 0 0 } }";
    let ball = "Sphere { center 0 0 0 radius 1 }";
    let carved = format!("Difference {{ {ball} Transform {{ {moving} {ball} }} }}");
    let said = report(&format!("Lorentz {{ velocity 0.5 0 0 {carved} }}"));
    assert!(said.contains("cannot be moved by a `Motion` as well"), "{said}");
    let scene = of(&format!("Merge {{ {carved} {ball} }} {ball}"));
    assert!(scene.moves() && scene.geometry.motions.len() == 1);
    // A motion that is over before the shutter opens is none.
    let later = carved.replace("key 0 { } key 1", "key -3 { } key -2");
    assert!(!of(&later).moves());
}

#[test]
fn what_encloses_nothing_is_refused_with_its_place() {
    let ball = "Sphere { center 0 0 0 radius 1 }";
    let said = report(&format!("Difference {{ {ball} Disk {{ center 0 0 0 normal 0 1 0 radius 1 }} }}"));
    assert!(said.contains("must have an inside") && said.contains("encloses nothing"), "{said}");
    let said =
        report(&format!("Intersection {{ {ball} Cylinder {{ base 0 0 0 top 0 1 0 radius 1 capped off }} }}"));
    assert!(said.contains("encloses nothing"), "{said}");
    let said = report(&format!("Intersection {{ {ball} TriangleMesh {{ file open.obj }} }}"));
    assert!(said.contains("the edge from 0 0 0 to 0 1 0 has a triangle on one side only"), "{said}");
    assert!(report("Merge { }").contains("`Merge` has no operands"));
    assert!(report("Difference { Box { min 0 0 0 max 1 1 1 } radius 3 }").contains("unknown word `radius`"));
}

/// The first operand is the first one, whether there is anything of it or not.
#[test]
fn nothing_less_something_is_nothing() {
    let scene = of("Difference { Group { } Sphere { center 0 0 0 radius 1 } }");
    assert_eq!(look(&scene, 0.0, 0.0), None);
    let scene = of("Difference { Sphere { center 0 0 0 radius 1 } Sphere { center 0 0 0 radius 1 } }");
    assert_eq!(look(&scene, 0.3, 0.2), None);
}
