use super::*;
use kajo::{LoadOptions, MemoryAssets, load_from};
use kajo_core::ObjectId;

fn scene(group: &str) -> Scene {
    limited_scene(group, 10_000_000)
}

/// A scene whose instances are nested where they make more than a sixteenth of `objects`.
fn limited_scene(group: &str, objects: usize) -> Scene {
    let materials = "Materials { Material { diffuseColor 1 0 0 } Material { diffuseColor 0 0 1 } }";
    scene_of(materials, group, objects)
}

/// A scene of a block of materials, and blocks in its group; see [`limited_scene`].
pub(super) fn scene_of(materials: &str, group: &str, objects: usize) -> Scene {
    let text = format!(
        "PerspectiveCamera {{ center 0 1 9 direction 0 0 -1 up 0 1 0 angle 40 }}
         Lights {{ PointLight {{ position 0 5 0 color 1 0 0 }}
                   SpotLight {{ position 1 5 0 direction 0 -1 0 color 1 1 1 angle 60 }}
                   DirectionalLight {{ direction -1 -1 -1 color 1 1 1 }}
                   PointLight {{ position 2 5 0 ies luminaire.ies color 0 0 1 }} }}
         {materials}
         Group {{ {group} }}"
    );
    let two = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nusemtl a\nf 1 2 3\nusemtl b\nf 1 3 4\n";
    let mtl = "newmtl a\nKd 0 1 0\nnewmtl b\nKd 1 1 0\n";
    let assets = MemoryAssets::new()
        .with("a.txt", text)
        .with("two.obj", format!("mtllib two.mtl\n{two}"))
        .with("two.mtl", mtl)
        .with("luminaire.ies", "TILT=NONE\n1 -1 1  3 1 1 2  0 0 0\n1 1 60\n0 90 180\n0\n1 1 1\n")
        .with("one.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    let mut options = LoadOptions::default();
    options.limits.objects = objects;
    let loaded = load_from("a.txt", &assets, &options);
    assert!(loaded.scene.is_some(), "{}", loaded.report(false));
    loaded.scene.unwrap()
}

/// All triangles in world space, with their object number.
pub(super) fn triangles(preview: &Preview) -> Vec<([Vec3; 3], u32)> {
    let mut all = Vec::new();
    for instance in &preview.instances {
        let mesh = &preview.meshes[instance.mesh as usize];
        for face in mesh.indices.chunks_exact(3) {
            let corner = |k: usize| &mesh.vertices[face[k] as usize];
            let place = |k: usize| instance.world_from_mesh.transform_point3(corner(k).position.into());
            all.push(([place(0), place(1), place(2)], instance.object + corner(0).object));
        }
    }
    all
}

#[test]
fn every_object_has_triangles_where_it_is() {
    let scene = scene(
        "MaterialIndex 0
         Sphere { center 0 0 0 radius 1 }
         Transform { Translate 2 0 0 Scale 1 2 1 Sphere { center 0 0 0 radius 0.5 } }
         Box { min -3 -1 -1 max -2 1 1 }
         MaterialIndex 1
         Transform { XRotate 30 Scale -1 1 1 Cylinder { base 0 3 0 top 0 4 0 radius 0.5 } }
         Cone { base 4 0 0 top 4 1 0 radius 0.5 topRadius 0 }
         Disk { center 0 -2 0 normal 0 1 0 radius 2 innerRadius 1 }
         Quad { corner 5 0 0 edge1 1 0 0 edge2 0 1 0 }
         Triangle { vertex0 0 5 0 vertex1 1 5 0 vertex2 0 6 0 }
         TriangleMesh { file two.obj materials on }
         Transform { Translate 0 0 2 TriangleMesh { file one.obj } }",
    );
    let preview = Preview::of(&scene);
    let mut boxes = vec![Aabb::EMPTY; scene.geometry.primitives.len()];
    for (corners, object) in triangles(&preview) {
        boxes[object as usize - 1] = boxes[object as usize - 1].union(Aabb::around(corners));
    }
    for (i, found) in boxes.iter().enumerate() {
        let primitive = &scene.geometry.primitives[i];
        let bounds = scene.geometry.shapes.bounds(primitive.shape);
        let bounds = primitive.pose.still_in(&scene.geometry.transforms).unwrap().bounds(&bounds);
        let missing = (bounds.extent() - found.extent()).max_element();
        assert!(bounds.padded(1e-4).contains(found.min) && bounds.padded(1e-4).contains(found.max), "{i}");
        // Boxes around turned boxes are somewhat larger than need be.
        assert!(missing < 0.35 * bounds.extent().max_element() + 1e-4, "{i}: {found:?} in {bounds:?}");
    }
    assert_eq!(preview.triangle_count(), triangles(&preview).len() as u64);
}

#[test]
fn triangles_face_outward_also_under_mirrors() {
    let scene = scene(
        "MaterialIndex 0
         Transform { Scale -1 1 1 Box { min 1 1 1 max 2 3 4 } }
         Transform { Scale 1 1 -2 Cone { base 5 0 0 top 5 1 0 radius 0.5 topRadius 0.2 } }",
    );
    let preview = Preview::of(&scene);
    let mesh = &preview.meshes[preview.instances[0].mesh as usize];
    for face in mesh.indices.chunks_exact(3) {
        let [a, b, c] = [0, 1, 2].map(|k| mesh.vertices[face[k] as usize]);
        let [p, q, r] = [a, b, c].map(|v| Vec3::from(v.position));
        assert!((q - p).cross(r - p).dot(Vec3::from(b.normal)) > 0.0);
    }
}

#[test]
fn a_plane_lies_below_everything_as_far_as_one_can_see() {
    let scene = scene(
        "MaterialIndex 0 Sphere { center 3 0 0 radius 1 }
         Transform { YRotate 20 Plane { normal 0 1 0 offset -1 } }",
    );
    let square: Vec<_> = triangles(&Preview::of(&scene)).into_iter().filter(|t| t.1 == 2).collect();
    assert_eq!(square.len(), 162);
    assert!(square.iter().flat_map(|(corners, _)| corners).all(|p| (p.y + 1.0).abs() < 1e-4));
    let around = Aabb::around(square.iter().flat_map(|(corners, _)| *corners)).padded(1e-3);
    for p in [Vec3::new(4.0, -1.0, 1.0), Vec3::new(0.0, -1.0, 9.0), Vec3::new(1e4, -1.0, -1e4)] {
        assert!(around.contains(p), "{p}");
    }
}

#[test]
fn instances_share_their_triangles() {
    let scene = scene(
        "MaterialIndex 0
         Sphere { center 0 0 0 radius 1 } Sphere { center 3 0 0 radius 2 }
         Define pair { TriangleMesh { file two.obj materials on } }
         Instance pair { Translate 0 1 0 } Instance pair { Translate 0 2 0 }",
    );
    let preview = Preview::of(&scene);
    let of = |object: u32| preview.instances.iter().filter(move |instance| instance.object == object);
    let meshes = |object: u32| of(object).map(|instance| instance.mesh).collect::<Vec<_>>();
    assert_eq!((meshes(1).len(), meshes(1)), (1, meshes(2)), "one sphere for all");
    assert_eq!((meshes(3).len(), meshes(3)), (2, meshes(4)), "a piece for each material of the mesh");
    let colors: Vec<_> = of(3).map(|instance| instance.color).collect();
    assert!(colors.iter().all(|c| c[1] > 200) && colors[0][0] < 60 && colors[1][0] > 200, "{colors:?}");
    assert!(meshes(3).iter().all(|&mesh| preview.meshes[mesh as usize].vertices.len() == 3));
}

#[test]
fn the_more_spheres_there_are_the_fewer_triangles_each_has() {
    for (n, range) in [(1, 3000..4097), (500, 300..500), (10_000, 40..65), (60_000, 4..17)] {
        let balls: String = (0..n).map(|i| format!("Sphere {{ center {i} 0 0 radius 0.4 }}\n")).collect();
        let preview = Preview::of(&scene(&format!("MaterialIndex 1 {balls}")));
        let each = preview.triangle_count() / n;
        assert!(range.contains(&each), "{n} spheres of {each} triangles");
    }
}

#[test]
fn nested_instances_are_shown_as_far_as_that_is_not_too_much() {
    let balls = |n: u32| -> String {
        (0..n).map(|i| format!("Sphere {{ center {} 0 {} radius 0.4 }}\n", i % 10, i / 10)).collect()
    };
    let rows =
        |n: u32| -> String { (0..n).map(|i| format!("Instance square {{ Translate 0 {i} 0 }}\n")).collect() };
    for squares in [3, 400] {
        let text = format!("MaterialIndex 1 Define square {{ {} }} {}", balls(100), rows(squares));
        let scene = limited_scene(&text, 4_000);
        assert_eq!(
            (scene.geometry.primitives.len(), scene.geometry.object_count()),
            (0, 100 * u64::from(squares))
        );
        let preview = Preview::of(&scene);
        let is_box = |i: &PreviewInstance| preview.meshes[i.mesh as usize].vertices.len() == 8;
        let n_boxes = preview.instances.iter().filter(|i| is_box(i)).count();
        let n_spheres = preview.instances.len() - n_boxes;
        assert_eq!(100 * n_boxes + n_spheres, 100 * squares as usize);
        assert_eq!(n_boxes == 0, squares == 3, "{n_boxes}");
        assert_eq!(preview.has_boxes, squares == 400);
        assert!(n_spheres > 200 && preview.triangle_count() < 1_000_000, "{}", preview.triangle_count());
        let mut all = Aabb::EMPTY;
        for (corners, object) in triangles(&preview) {
            let word = ObjectId::from_number(object)
                .and_then(|id| scene.geometry.object(id))
                .map(|object| object.keyword);
            assert_eq!(word, Some("Sphere"));
            all = all.union(Aabb::around(corners));
        }
        let expected = scene.geometry.bounds();
        assert!((all.min - expected.min).abs().max_element() < 0.1, "{all:?}");
        assert!((all.max - expected.max).abs().max_element() < 0.1, "{all:?}");
        assert!(preview.instances.iter().all(|instance| instance.color[2] > 200 && instance.color[0] < 60));
    }
}

#[test]
fn lights_and_the_camera_have_wires() {
    let scene = scene("MaterialIndex 0 Sphere { center 0 0 0 radius 1 }");
    let lines = Preview::of(&scene).lines;
    for kind in [LineKind::Light(1), LineKind::Light(2), LineKind::Camera] {
        assert!(lines.iter().any(|line| line.kind == kind), "{kind:?}");
    }
    // A point, and one with measured intensities.
    for (number, x, color) in [(0, 0.0, [255, 80, 80, 255]), (3, 2.0, [80, 80, 255, 255])] {
        let star: Vec<_> = lines.iter().filter(|line| line.kind == LineKind::Light(number)).collect();
        assert!(!star.is_empty(), "light {number}");
        for line in star {
            let middle = 0.5 * (Vec3::from(line.ends[0]) + Vec3::from(line.ends[1]));
            assert!(middle.distance(Vec3::new(x, 5.0, 0.0)) < 1e-5);
            assert_eq!(line.color, color);
        }
    }
}

#[test]
fn nothing_is_shown_of_nothing() {
    let empty = scene("");
    let preview = Preview::of(&empty);
    assert_eq!(preview.triangle_count(), 0);
    assert!(preview.bounds.extent().min_element() > 0.0);
}
