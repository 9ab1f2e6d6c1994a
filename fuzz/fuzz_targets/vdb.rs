//! Any bytes as a file of OpenVDB or NanoVDB.

#![no_main]

use kajo_scene::{Assets, Limits, MemoryAssets, MemoryBudget, list_vdb, read_vdb};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    let assets = MemoryAssets::new().with("v", data);
    let open = || assets.open("v", "").expect("the file is there");
    let limits = Limits { memory: MemoryBudget::new(256 << 20), ..Limits::default() };
    let entries = list_vdb(open(), &limits).unwrap_or_default();
    for wanted in 0..entries.len().clamp(1, 4) {
        if let Ok(grid) = read_vdb::<f32>(open(), wanted, &limits) {
            grid.voxels.at(grid.voxels.size().map(|n| n - 1));
        }
        let _ = read_vdb::<[f32; 3]>(open(), wanted, &limits);
    }
});
