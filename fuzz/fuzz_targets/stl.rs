//! Any bytes as an STL mesh.

#![no_main]

use kajo_scene::{Limits, read_stl};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    if let Ok((mesh, _)) = read_stl(data, "m.stl", &Limits::default()) {
        for &v in mesh.faces.iter().flatten() {
            assert!(mesh.positions[v as usize].iter().all(|x| x.is_finite()));
        }
    }
});
