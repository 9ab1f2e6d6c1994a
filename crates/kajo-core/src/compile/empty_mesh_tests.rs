//! Meshes of which nothing can be hit stand anywhere in a scene and change nothing of it.

use kajo_math::{Ray, Vec3};
use kajo_scene::{Limits, MemoryAssets, SceneDesc};

use super::{CompileOptions, compile};
use crate::scene::{RayEvent, Scene};

const SCENE: &str = "PerspectiveCamera { center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30  shutter 0 1 }
    Materials { Matte grey { } Matte emitter { emission 5 5 5 } Glass glass { } Mix both { materialIndex grey  materialIndex emitter } }\n";

/// Files without a triangle that could be hit.
const FILES: [(&str, &[u8]); 9] = [
    ("lines.obj", b"mtllib m.mtl\nv 0 0 0\nv 1 0 0\nusemtl a\nl 1 2\n"),
    ("none.obj", b""),
    ("materials.obj", b"mtllib m.mtl\nusemtl a\nusemtl b\nusemtl c\n"),
    ("flat.obj", b"mtllib m.mtl\nv 0 0 0\nv 1 1 1\nv 2 2 2\nusemtl a\nf 1 2 3\nusemtl b\nf 1 1 1\nf 1 3 2\n"),
    ("nan.obj", b"mtllib m.mtl\nv nan nan nan\nv inf 0 0\nusemtl a\nf 1 2 1\nusemtl b\nf 1 1 1\n"),
    ("unlit.obj", b"mtllib none.mtl\nusemtl a\nv 1e38 0 0\nv 1e38 0 0\nf 1 2 1\n"),
    (
        "none.ply",
        b"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n\
        element face 0\nproperty list uchar int vertex_indices\nend_header\nnan nan nan\n",
    ),
    (
        "points.ply",
        b"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n\
        end_header\n0 0 0\n",
    ),
    ("none.stl", b"solid\nendsolid\n"),
];

/// The ways to read one.
const KEYS: [&str; 4] = ["", "smooth on", "materials on", "smooth on  materials on"];

/// The ways to place one, `MESH` standing for it.
const PLACES: [&str; 5] = [
    "MESH",
    "Transform { Translate 1 2 3 XRotate 40 Scale 1 -2 3 MESH }",
    "Transform { Motion { key 0 { } key 1 { Translate 1 0 0 YRotate 90 } } MESH }",
    "Define thing { MESH } Instance thing { Translate 1 0 0 } Instance thing { Motion { key 0 { } key 1 { ZRotate 9 } } }",
    // Nested: enough objects that a tree of its own is made for the definition.
    "Define thing { MANY } Instance thing { Translate 1 0 0 } Instance thing { Scale 2 2 2 }",
];

fn compiled(group: &str) -> (Option<Scene>, Vec<String>) {
    let mut assets =
        MemoryAssets::new().with("m.mtl", "newmtl a\nKe 3 2 1\nnewmtl b\nKd 1 1 1\n").with("none.mtl", "");
    for (name, bytes) in FILES {
        assets = assets.with(name, bytes);
    }
    let mut parsed = SceneDesc::parse_str(&format!("{SCENE}Group {{ {group} }}"));
    let mut diagnostics = parsed.diagnostics;
    let limits = Limits { objects: 1000, ..Limits::default() };
    let options = CompileOptions { limits, ..CompileOptions::default() };
    let scene = compile(&mut parsed.desc, &assets, &options, &mut diagnostics);
    (scene, diagnostics.iter().map(|d| d.message.clone()).collect())
}

#[test]
fn nothing_is_hit_and_nothing_shines() {
    let emitter = "MaterialIndex emitter  Quad { corner -1 3 -1  edge1 2 0 0  edge2 0 0 2 }";
    let floor = "MaterialIndex grey  Plane { normal 0 1 0  offset -1 }";
    let (plain, _) = compiled(&format!("{emitter} {floor}"));
    let plain = plain.unwrap();
    let ray = Ray::new(Vec3::new(0.0, 5.0, 0.0), Vec3::new(0.02, -1.0, 0.01));
    let look = |scene: &Scene| match scene.trace(&ray) {
        RayEvent::Surface(at) => (at.point.p, at.hit.part),
        RayEvent::Escaped => panic!("there is a light below"),
    };
    for (file, _) in FILES {
        for (keys, place) in KEYS.iter().flat_map(|keys| PLACES.map(|place| (keys, place))) {
            for material in ["grey", "emitter", "glass", "both"] {
                let mesh = format!("TriangleMesh {{ file {file}  {keys} }}");
                let things = place.replace("MESH", &mesh).replace("MANY", &mesh.repeat(70));
                let text = format!("{emitter} {floor} MaterialIndex {material} {things}");
                let (scene, said) = compiled(&text);
                let scene = scene.unwrap_or_else(|| panic!("{text}\n{said:?}"));
                assert_eq!(look(&scene), look(&plain), "{text}");
                assert_eq!(
                    scene.lighting.sampler.list().len(),
                    plain.lighting.sampler.list().len(),
                    "{text}"
                );
                assert_eq!(scene.geometry.bounds(), plain.geometry.bounds(), "{text}");
                assert!(!said.iter().any(|m| m.contains("plane without bounds")), "{text}\n{said:?}");
                assert!(!said.is_empty(), "{text}");
                assert!(!scene.occluded(&ray.over(0.0, 1.0)), "{text}");
                scene.geometry.item_buffer(Vec3::ZERO, 64);
                assert!(scene.geometry.nested_elements(|_| 1, 1000).len() <= 140);
            }
        }
    }
}

/// Lights of a mesh whose first triangle has none of its own materials.
#[test]
fn any_triangle_of_a_mesh_may_shine() {
    let text = "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nusemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\n";
    let assets = MemoryAssets::new().with("m.mtl", "newmtl a\nKe 3 2 1\nnewmtl b\n").with("x.obj", text);
    let group = "Group { MaterialIndex grey  TriangleMesh { file x.obj  materials on } }";
    let mut parsed = SceneDesc::parse_str(&format!("{SCENE}{group}"));
    let mut diagnostics = parsed.diagnostics;
    let scene = compile(&mut parsed.desc, &assets, &CompileOptions::default(), &mut diagnostics).unwrap();
    assert_eq!(scene.lighting.lights.areas.iter().map(|light| light.part).collect::<Vec<_>>(), [1]);
}
