//! Any bytes as the saved state of a render that is to go on.

#![no_main]

#[path = "../../crates/kajo-render/tests/hostile/state.rs"]
mod state;

use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    state::go_on(data);
});
