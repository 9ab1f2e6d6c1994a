//! Models that move, frame by frame.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use kajo_math::{Ray, Vec3};
use kajo_scene::{AssetError, AssetFile, Assets, Limits, LoadStep, MemoryAssets, SceneDesc};

use super::{CompileOptions, MeshStore, clock_of, compile};
use crate::scene::{RayEvent, Scene};

/// A triangle (0, 0), (1, 0), (0, 1) at z = 0 with two animations of a second: `slide` takes it 4 along x, `lift` 2 along z by
/// the weight of a target.
const MODEL: &str = r#"{"asset":{"version":"2.0"},"buffers":[{"byteLength":112,"uri":
"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAIBAAAAAAAAAAAAAAAAAAAAAAAAAAEAAAAAAAAAAAAAAAEAAAAAAAAAAAAAAAEAAAAAAAACAPw=="}],
"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":8},
{"buffer":0,"byteOffset":44,"byteLength":24},{"buffer":0,"byteOffset":68,"byteLength":36},{"buffer":0,"byteOffset":104,"byteLength":8}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},{"bufferView":1,"componentType":5126,"count":2,"type":"SCALAR"},
{"bufferView":2,"componentType":5126,"count":2,"type":"VEC3"},{"bufferView":3,"componentType":5126,"count":3,"type":"VEC3"},
{"bufferView":4,"componentType":5126,"count":2,"type":"SCALAR"}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0},"targets":[{"POSITION":3}]}]}],"nodes":[{"mesh":0}],
"animations":[{"name":"slide","channels":[{"sampler":0,"target":{"node":0,"path":"translation"}}],"samplers":[{"input":1,"output":2}]},
{"name":"lift","channels":[{"sampler":0,"target":{"node":0,"path":"weights"}}],"samplers":[{"input":1,"output":4}]}]}"#;

/// Files that count the trees which are built of them.
struct Counting {
    files: MemoryAssets,
    built: AtomicUsize,
}

impl Assets for Counting {
    fn open(&self, name: &str, from: &str) -> Result<AssetFile, AssetError> {
        self.files.open(name, from)
    }

    fn progress(&self, step: LoadStep<'_>) {
        if matches!(step, LoadStep::Building { .. }) {
            self.built.fetch_add(1, Ordering::Relaxed);
        }
    }
}

fn assets() -> Counting {
    Counting { files: MemoryAssets::new().with("a.gltf", MODEL), built: AtomicUsize::new(0) }
}

fn compiled(keys: &str, assets: &Counting, options: &CompileOptions) -> Result<Scene, Vec<String>> {
    let text = format!(
        "PerspectiveCamera {{ center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30 }}
        Materials {{ Matte {{ }} }} Group {{ MaterialIndex 0 Model {{ file a.gltf {keys} }} }}"
    );
    let clock = clock_of(&SceneDesc::parse_str(&text).desc, options).unwrap_or_default();
    let mut parsed = SceneDesc::parse_at("scene", text, &assets.files, &Limits::default(), &clock);
    let mut diagnostics = parsed.diagnostics;
    let scene = compile(&mut parsed.desc, assets, options, &mut diagnostics);
    scene.ok_or_else(|| diagnostics.errors().map(|error| error.message.clone()).collect())
}

/// How high the triangle is, found by a ray a little beside the image of its first corner.
fn height(scene: &Scene, x: f32) -> Option<f32> {
    match scene.trace(&Ray::new(Vec3::new(x + 0.1, 0.1, 50.0), Vec3::NEG_Z)) {
        RayEvent::Surface(at) => Some(at.point.p.z),
        RayEvent::Escaped => None,
    }
}

fn at_frame(frame: i64) -> CompileOptions {
    CompileOptions { frame: Some(frame), ..CompileOptions::default() }
}

#[test]
fn models_move_with_the_frames() {
    let assets = assets();
    let scene = |keys: &str, frame| compiled(keys, &assets, &at_frame(frame)).unwrap();
    assert_eq!(height(&scene("", 13), 2.0), Some(0.0));
    assert_eq!(height(&scene("animation lift", 7), 0.0), Some(0.5));
    assert_eq!(height(&scene("animation 1", 19), 0.0), Some(1.5));
    // It begins again after 24 frames, or stays.
    assert_eq!(height(&scene("", 13 + 48), 2.0), Some(0.0));
    assert_eq!(height(&scene("animationRepeat off", 99), 4.0), Some(0.0));
    // Another moment, by a number or by an expression.
    assert_eq!(height(&scene("animationTime 0.75", 1), 3.0), Some(0.0));
    assert_eq!(height(&scene("animationTime (0.5 * time)", 25), 2.0), Some(0.0));
    assert!(!scene("", 13).moves());
    // Its keys are known, where it follows the frames.
    let known = scene("animation lift", 5).output.animated_models;
    assert_eq!(
        (known.len(), known[0].name.as_deref(), &*known[0].key_times),
        (1, Some("lift"), &[0.0, 1.0][..])
    );
    assert!(scene("animationTime 0.5", 5).output.animated_models.is_empty());
}

#[test]
fn a_model_in_no_film_rests_unless_a_moment_is_written() {
    let assets = assets();
    let scene = |keys: &str| compiled(keys, &assets, &CompileOptions::default()).unwrap();
    assert_eq!(height(&scene(""), 0.0), Some(0.0));
    assert_eq!(height(&scene("animationTime 0.5"), 2.0), Some(0.0));
    assert_eq!(height(&scene("animation lift animationTime 0.5"), 0.0), Some(1.0));
    let said = compiled("animation jump", &assets, &CompileOptions::default()).unwrap_err();
    assert!(said[0].contains("it has no animation `jump`; there are `slide`, `lift`"), "{said:?}");
}

#[test]
fn meshes_that_stay_what_they_were_are_built_once() {
    let assets = assets();
    let store = Arc::new(MeshStore::default());
    let built = |keys: &str, frame| {
        let before = assets.built.load(Ordering::Relaxed);
        let options = CompileOptions { meshes: Some(Arc::clone(&store)), ..at_frame(frame) };
        compiled(keys, &assets, &options).unwrap();
        assets.built.load(Ordering::Relaxed) - before
    };
    assert_eq!([1, 2, 3].map(|frame| built("", frame)), [1, 0, 0]);
    assert_eq!(store.len(), 1);
    // One that changes its shape is another mesh, and those that are not used any more are forgotten.
    assert_eq!([2, 3, 3].map(|frame| built("animation lift", frame)), [1, 1, 0]);
    assert_eq!(store.len(), 1);
}
