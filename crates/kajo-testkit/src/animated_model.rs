//! A glTF model that moves.

use std::path::Path;
use std::{fs, io};

/// A triangle that goes 4 units to the right and back, by the animation `walk` with keys at three times.
const WALKER: &str = r#"{"asset":{"version":"2.0"},"buffers":[{"byteLength":84,"uri":"walker.bin"}],
"bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":12},{"buffer":0,"byteOffset":48,"byteLength":36}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},{"bufferView":1,"componentType":5126,"count":3,"type":"SCALAR"},
{"bufferView":2,"componentType":5126,"count":3,"type":"VEC3"}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"nodes":[{"mesh":0}],
"animations":[{"name":"walk","channels":[{"sampler":0,"target":{"node":0,"path":"translation"}}],"samplers":[{"input":1,"output":2}]}]}"#;

/// Writes it as `walker.gltf` into a folder.
///
/// * `times`: those of its keys, in seconds, each later than the one before
///
/// # Errors
/// When it cannot be written.
pub fn write_walker(folder: &Path, times: [f32; 3]) -> io::Result<()> {
    let corners = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let positions = [0.0, 0.0, 0.0, 4.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    let numbers = corners.into_iter().chain(times).chain(positions);
    let bytes: Vec<u8> = numbers.flat_map(f32::to_le_bytes).collect();
    fs::write(folder.join("walker.bin"), bytes)?;
    fs::write(folder.join("walker.gltf"), WALKER)
}
