//! The textures of the preview are those that rays meet.

use super::tests::scene_of;
use super::*;
use kajo_math::{Ray, Vec2};

/// A texel of an atlas, between texels as a card reads it.
fn read(atlas: &Atlas, [x, y]: [f32; 2]) -> Vec3 {
    let [columns, rows] = atlas.size();
    let texel = |x: f32, y: f32| {
        let [x, y] = [(x as u32).min(columns - 1), (y as u32).min(rows - 1)];
        let begin = 4 * (y * columns + x) as usize;
        Vec3::from([0, 1, 2].map(|i| f32::from(atlas.rgba()[begin + i])))
    };
    let [x, y] = [x - 0.5, y - 0.5];
    let [s, t] = [x - x.floor(), y - y.floor()];
    let row = |y: f32| texel(x, y).lerp(texel(x + 1.0, y), s);
    row(y).lerp(row(y + 1.0), t)
}

/// A point, the unit normal and the texel there of each textured triangle, in its middle, with the number of its object.
fn middles(preview: &Preview) -> Vec<(Vec3, Vec3, [f32; 2], u32)> {
    let mut all = Vec::new();
    for mesh in preview.meshes.iter().filter(|mesh| !mesh.texels.is_empty()) {
        assert_eq!(mesh.texels.len(), mesh.vertices.len());
        for face in mesh.indices.chunks_exact(3) {
            let corners = [0, 1, 2].map(|k| face[k] as usize);
            let mean = |of: &dyn Fn(usize) -> Vec3| corners.iter().map(|&i| of(i)).sum::<Vec3>() / 3.0;
            let p = mean(&|i| mesh.vertices[i].position.into());
            let [a, b, c] = corners.map(|i| Vec3::from(mesh.vertices[i].position));
            let n = (b - a).cross(c - a);
            let texel = mean(&|i| Vec2::from(mesh.texels[i]).extend(0.0));
            all.push((p, n.normalize(), [texel.x, texel.y], mesh.vertices[corners[0]].object));
        }
    }
    all
}

/// Fine textures, and the share of the middles of triangles at which they are what a ray finds there.
fn agreement(scene: &Scene, preview: &Preview) -> f64 {
    let atlas = preview.atlas.as_ref().expect("textures").refined(scene, || true).unwrap();
    let (mut same, mut all) = (0.0, 0.0);
    for (p, n, texel, object) in middles(preview) {
        let ray = Ray::new(p + 0.02 * n, -n);
        let Some((at, _)) = scene.trace_snapshot(&ray).filter(|(at, _)| at.object.number() == object) else {
            continue;
        };
        let met = color::encoded(color::at(scene, &at));
        let expected = Vec3::from([met[0], met[1], met[2]].map(f32::from));
        same += f64::from(u8::from((read(&atlas, texel) - expected).abs().max_element() < 24.0));
        all += 1.0;
    }
    let triangles = middles(preview).len();
    assert!(all > 0.7 * triangles as f64, "{all} rays meet something of {triangles}");
    same / all
}

const MATERIALS: &str = "
    Textures {
        Checks checks { }
        Gradient across { frequency 0.3 }
        Gradient laid { frequency 0.5  projection uv }
        Gradient own { frequency 0.3  space object }
    }
    Materials {
        PhongMaterial uniform { diffuseColor 0 0 1  bump checks { height 0.1 } }
        Matte checks { color checks }
        Matte across { color across }
        Matte laid { color laid }
        Matte own { color own }
    }";

fn scene(group: &str) -> Scene {
    scene_of(MATERIALS, group, 1_000_000)
}

#[test]
fn textures_of_the_preview_are_what_rays_find() {
    for (shape, least) in [
        ("Sphere { center 0 0 0 radius 1 }", 0.97),
        ("Transform { XRotate 20 Scale -1 1 2 Box { min -1 -1 -1 max 2 1 1 } }", 0.99),
        ("Transform { Translate 1 2 3 Cylinder { base 0 0 0 top 0 2 0 radius 0.7 } }", 0.97),
        ("Torus { center 0 0 0 axis 0 1 0 majorRadius 2 minorRadius 0.5 }", 0.97),
        ("Triangle { vertex0 0 0 0 vertex1 3 0 0 vertex2 0 2 1 }", 0.99),
        ("Difference { Box { min -1 -1 -1 max 1 1 1 } Sphere { center 1 1 1 radius 1 } }", 0.9),
        ("TriangleMesh { file one.obj }", 0.99),
    ] {
        for material in ["across", "laid", "own"] {
            let scene = scene(&format!("MaterialIndex {material} {shape}"));
            let preview = Preview::of(&scene);
            let found = agreement(&scene, &preview);
            assert!(found >= least, "{material} on {shape}: {found}");
        }
    }
}

#[test]
fn surfaces_without_textures_have_one_colour() {
    let scene = scene("MaterialIndex uniform Sphere { center 0 0 0 radius 1 }");
    let preview = Preview::of(&scene);
    assert!(preview.atlas.is_none() && preview.meshes.iter().all(|mesh| mesh.texels.is_empty()));
}

#[test]
fn the_many_share_what_one_has() {
    let balls =
        |n: u32| -> String { (0..n).map(|i| format!("Sphere {{ center {i} 0 0  radius 0.4 }}\n")).collect() };
    for n in [1, 20, 2000] {
        let scene = scene(&format!("MaterialIndex checks {}", balls(n)));
        let preview = Preview::of(&scene);
        let [columns, rows] = preview.atlas.as_ref().unwrap().size();
        let texels = columns * rows;
        assert!((TEXELS_OF_AN_OBJECT / 2..TEXELS + TEXELS / 4).contains(&texels), "{n}: {texels}");
    }
}

/// What is too much for textures is still there, in one colour.
#[test]
fn no_more_triangles_show_textures_than_can_be_had() {
    let balls: String =
        (0..60_000).map(|i| format!("Sphere {{ center {} {} 0  radius 0.4 }}\n", i % 300, i / 300)).collect();
    let scene = scene(&format!("MaterialIndex checks {balls}"));
    let preview = Preview::of(&scene);
    let textured: usize =
        preview.meshes.iter().filter(|m| !m.texels.is_empty()).map(|m| m.indices.len() / 3).sum();
    assert!(textured > TEXTURED_TRIANGLES / 2 && textured <= TEXTURED_TRIANGLES, "{textured}");
    assert!(preview.triangle_count() > textured as u64);
    let mut seen = vec![false; 60_000];
    for instance in &preview.instances {
        let vertices = &preview.meshes[instance.mesh as usize].vertices;
        vertices.iter().for_each(|vertex| seen[(instance.object + vertex.object) as usize - 1] = true);
    }
    assert!(seen.into_iter().all(|seen| seen));
}

/// Texels are the smallest where the scene is, and there are some as far as one can see.
#[test]
fn textures_of_planes_are_fine_where_the_scene_is() {
    let scene =
        scene("MaterialIndex checks Sphere { center 0 0 0 radius 1 } Plane { normal 0 1 0  offset -1 }");
    let preview = Preview::of(&scene);
    let mesh = preview.meshes.iter().find(|mesh| !mesh.texels.is_empty()).unwrap();
    let corner =
        |i: u32| (Vec3::from(mesh.vertices[i as usize].position), Vec2::from(mesh.texels[i as usize]));
    let (mut near, mut far) = (0.0f32, 0.0f32);
    for face in mesh.indices.chunks_exact(3).filter(|face| mesh.vertices[face[0] as usize].object == 2) {
        let [(p, a), (q, b), _] = [0, 1, 2].map(|k| corner(face[k]));
        let distance = p.length().max(q.length());
        let texel = p.distance(q) / a.distance(b).max(1.0);
        if distance < 8.0 {
            near = near.max(texel);
        }
        far = far.max(distance);
    }
    assert!(near > 0.0 && near < 0.1 && far > 1e4, "{near} {far}");
}

#[test]
fn textures_are_refined_until_told_to_stop() {
    let scene = scene("MaterialIndex checks Sphere { center 0 0 0 radius 1 }");
    let preview = Preview::of(&scene);
    let coarse = preview.atlas.as_ref().unwrap();
    assert!(coarse.refined(&scene, || false).is_none());
    let fine = coarse.refined(&scene, || true).unwrap();
    assert_eq!(fine.size(), coarse.size());
    assert_ne!(fine.rgba(), coarse.rgba());
}
