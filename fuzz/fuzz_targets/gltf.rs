//! Any bytes as a glTF model, in JSON or binary, that may name itself as a buffer.

#![no_main]

use kajo_scene::{Assets, Limits, MemoryAssets, read_gltf};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    let assets = MemoryAssets::new().with("m.gltf", data);
    let Ok(file) = assets.open("m.gltf", "") else { return };
    if let Ok(model) = read_gltf(file, &assets, &Limits::default()) {
        for part in model.instances.iter().flat_map(|instance| &model.meshes[instance.mesh]) {
            for &v in part.mesh.faces.iter().flatten() {
                assert!(part.mesh.positions[v as usize].iter().all(|x| x.is_finite()));
            }
            assert!(part.material.is_none_or(|material| material < model.materials.len()));
        }
    }
});
