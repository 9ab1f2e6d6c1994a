//! Any bytes as a mesh that is rendered: the first one chooses the format, the second its part in the scene and the
//! third the integrator.

#![no_main]

#[path = "../../crates/kajo/tests/hostile/renders.rs"]
mod renders;

use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    let &[format, part, choice, ref file @ ..] = data else { return };
    let extension = ["obj", "ply", "stl", "glb"][usize::from(format % 4)];
    renders::mesh(file, extension, usize::from(part), renders::integrator(choice));
});
