//! Meshes of files as subdivision surfaces.

use kajo_image::{EncodeOptions, Format, Image, encode};
use kajo_math::{Ray, Vec3};
use kajo_scene::{Limits, MemoryAssets, SceneDesc};

use super::{CompileOptions, compile};
use crate::scene::{Interaction, RayEvent, Scene};

/// A cube from -1 to 1, of quadrilaterals with the whole picture on each.
const CUBE: &str = "v -1 -1 -1\nv 1 -1 -1\nv -1 1 -1\nv 1 1 -1\nv -1 -1 1\nv 1 -1 1\nv -1 1 1\nv 1 1 1\n\
    vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n\
    f 1/1 3/2 4/3 2/4\nf 5/1 6/2 8/3 7/4\nf 1/1 2/2 6/3 5/4\nf 3/1 7/2 8/3 4/4\nf 1/1 5/2 7/3 3/4\nf 2/1 4/2 8/3 6/4\n";

const OCTAHEDRON: &str = "v 1 0 0\nv -1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\nv 0 0 -1\n\
    f 1 3 5\nf 3 2 5\nf 2 4 5\nf 4 1 5\nf 3 1 6\nf 2 3 6\nf 4 2 6\nf 1 4 6\n";

fn compiled_within(limits: Limits, keys: &str) -> (Option<Scene>, Vec<String>) {
    compiled_with(limits, keys, "")
}

fn compiled_with(limits: Limits, keys: &str, sheet: &str) -> (Option<Scene>, Vec<String>) {
    let split = |x: u32, _| if x < 4 { [0.0; 3] } else { [1.0; 3] };
    let picture = encode(&Image::from_fn(8, 8, split).unwrap(), Format::Png, &EncodeOptions::default());
    let assets = MemoryAssets::new()
        .with("cube.obj", CUBE)
        .with("bare.obj", CUBE.replace("/1", "").replace("/2", "").replace("/3", "").replace("/4", ""))
        .with("octahedron.obj", OCTAHEDRON)
        .with("sheet.obj", sheet)
        .with("split.png", picture.unwrap());
    let text = format!(
        "PerspectiveCamera {{ center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30 }}
         Materials {{ Matte {{ color 0.8 0.4 0.2 }} }}
         Group {{ MaterialIndex 0 {keys} }}"
    );
    let mut parsed = SceneDesc::parse_str(&text);
    let mut diagnostics = parsed.diagnostics;
    let options = CompileOptions { limits, ..CompileOptions::default() };
    let scene = compile(&mut parsed.desc, &assets, &options, &mut diagnostics);
    (scene, diagnostics.iter().map(|d| d.message.clone()).collect())
}

fn mesh(file: &str, keys: &str) -> Scene {
    let (scene, said) = compiled_within(Limits::default(), &format!("TriangleMesh {{ file {file} {keys} }}"));
    assert_eq!(said, [] as [&str; 0], "{keys}");
    scene.unwrap()
}

fn said(file: &str, keys: &str) -> Vec<String> {
    compiled_within(Limits::default(), &format!("TriangleMesh {{ file {file} {keys} }}")).1
}

fn at(scene: &Scene, x: f32, y: f32) -> Interaction {
    match scene.trace(&Ray::new(Vec3::new(x, y, 5.0), Vec3::NEG_Z)) {
        RayEvent::Surface(at) => at,
        RayEvent::Escaped => panic!("nothing at {x} {y}"),
    }
}

fn height(scene: &Scene) -> f32 {
    at(scene, 0.0, 0.0).point.p.z
}

/// The limit of the middle of a face: after one step its neighbours are at 3/4 and 5/9 of the cube's height.
const MIDDLE: f32 = (16.0 + 12.0 + 20.0 / 9.0) / 36.0;

#[test]
fn cubes_of_quadrilaterals_become_round() {
    for levels in [1, 2, 5] {
        let cube = mesh("cube.obj", &format!("subdivide {levels}"));
        assert!((height(&cube) - MIDDLE).abs() < 1e-6, "{levels}: {}", height(&cube));
        assert!(at(&cube, 0.001, 0.0).point.n.distance(Vec3::Z) < 0.01);
    }
    assert_eq!(height(&mesh("cube.obj", "subdivide 0")), 1.0);
    assert_eq!(height(&mesh("cube.obj", "subdivide 3  creaseAngle 60")), 1.0);
    assert!((height(&mesh("cube.obj", "subdivide 3  creaseAngle 91")) - MIDDLE).abs() < 1e-6);
}

#[test]
fn schemes_are_chosen_by_the_faces() {
    // The tip of an octahedron has four neighbours, whose mean is the middle: 1 - n c of it is left.
    let share = (5.0f64 / 8.0 - (3.0f64 / 8.0).powi(2)) / 4.0;
    let tip = 1.0 - 4.0 / (3.0 / (8.0 * share) + 4.0);
    for keys in ["subdivide 4", "subdivide 4  scheme loop"] {
        let found = f64::from(height(&mesh("octahedron.obj", keys)));
        assert!((found - tip).abs() < 1e-6, "{found} for {tip}");
    }
    let other = height(&mesh("octahedron.obj", "subdivide 4  scheme catmullClark"));
    assert!((f64::from(other) - tip).abs() > 0.01, "{other}");
    let triangles = height(&mesh("cube.obj", "subdivide 4  scheme loop"));
    assert!((triangles - MIDDLE).abs() > 0.01, "{triangles}");
}

#[test]
fn displacement_moves_outwards() {
    let raised = mesh("cube.obj", "subdivide 3  displacement 0.25");
    assert!((height(&raised) - MIDDLE - 0.25).abs() < 1e-6);
    // The left half of each face is black, the right one white.
    let pictured = mesh("cube.obj", "subdivide 6  displacement split.png { range -0.1 0.2 }");
    let plain = mesh("cube.obj", "subdivide 6");
    for (x, expected) in [(-0.3, -0.1), (0.3, 0.2)] {
        let [moved, still] = [&pictured, &plain].map(|scene| at(scene, x, 0.0).point);
        let along = (moved.p - still.p).dot(still.n);
        assert!((along - expected).abs() < 0.02, "{x}: {along}");
    }
}

/// A level square that a function raises: its height is that of the function, and its normal that of the gradient.
#[test]
fn functions_displace() {
    let sheet = "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n";
    let with = |function: &str| {
        let mesh =
            format!("TriangleMesh {{ file sheet.obj  subdivide 7  displacementFunction = {function} }}");
        compiled_with(Limits::default(), &mesh, sheet)
    };
    let (scene, said) = with("0.2 * x + 0.1 * x * y");
    assert_eq!(said, [] as [&str; 0]);
    let scene = scene.unwrap();
    for (x, y) in [(0.0, 0.0), (0.3, -0.2), (-0.25, 0.31)] {
        let point = at(&scene, x, y).point;
        assert!((point.p.z - 0.2 * x - 0.1 * x * y).abs() < 1e-4, "{}", point.p);
        let n = Vec3::new(-0.2 - 0.1 * y, -0.1 * x, 1.0).normalize();
        assert!(point.n.distance(n) < 1e-3, "{} {n}", point.n);
    }
    // Where there is no value there is no surface.
    let scene = with("sqrt(x)").0.unwrap();
    let hits = |x: f32| scene.trace(&Ray::new(Vec3::new(x, 0.1, 5.0), Vec3::NEG_Z)).surface().is_some();
    assert!(hits(0.2) && !hits(-0.2));
}

#[test]
fn subdivided_meshes_are_solids() {
    let solid =
        "Difference { TriangleMesh { file cube.obj  subdivide 3 }  Sphere { center 0 0 1  radius 0.5 } }";
    let (scene, said) = compiled_within(Limits::default(), solid);
    assert_eq!(said, [] as [&str; 0]);
    assert!((height(&scene.unwrap()) - 0.5).abs() < 1e-5);
}

#[test]
fn flat_faces_on_request() {
    let [smooth, flat] = ["", "smooth off"].map(|keys| mesh("cube.obj", &format!("subdivide 2 {keys}")));
    let off = |scene: &Scene| {
        let point = at(scene, 0.2, 0.31).point;
        point.n.distance(point.ng)
    };
    assert!(off(&smooth) > 1e-3 && off(&flat) == 0.0);
}

#[test]
fn what_cannot_be_is_said() {
    let has =
        |said: Vec<String>, part: &str| assert!(said.iter().any(|s| s.contains(part)), "{part}: {said:?}");
    has(said("cube.obj", "subdivide 13"), "subdivide");
    has(said("cube.obj", "subdivide -1"), "subdivide");
    has(said("cube.obj", "scheme loop"), "scheme");
    has(said("cube.obj", "subdivide 2  scheme quad"), "quad");
    has(said("cube.obj", "displacement 0.5"), "displacement");
    has(said("cube.obj", "displacementFunction = x"), "displacementFunction");
    has(said("cube.obj", "subdivide 2  displacement 0.5  displacementFunction = x"), "beside `displacement`");
    has(said("cube.obj", "subdivide 2  displacementFunction = w"), "w");
    has(said("cube.obj", "subdivide 2  displacement no.png"), "no.png");
    has(said("bare.obj", "subdivide 2  displacement split.png"), "no texture coordinates");
    let few = Limits { faces: 1000, ..Limits::default() };
    let (scene, said) = compiled_within(few, "TriangleMesh { file cube.obj  subdivide 6 }");
    assert!(scene.is_none());
    has(said, "subdivided 6 times it has more than 1000 triangles");
    let (_, said) = compiled_within(
        Limits { memory: kajo_scene::MemoryBudget::new(1 << 20), ..Limits::default() },
        "TriangleMesh { file cube.obj  subdivide 10 }",
    );
    has(said, "memory");
}
