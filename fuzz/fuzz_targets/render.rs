//! Any bytes as a scene that is compiled and rendered; the first one chooses the integrator.

#![no_main]

#[path = "../../crates/kajo/tests/hostile/renders.rs"]
mod renders;

use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    let Some((&choice, text)) = data.split_first() else { return };
    let square: &[u8] = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
    let grey: &[u8] = b"P2 2 2 255 0 255 128 7\n";
    let colours: &[u8] = b"P3 2 1 255 0 255 128 7 9 1\n";
    renders::picture(
        text,
        &[("m.obj", square), ("a.pgm", grey), ("a.ppm", colours)],
        renders::integrator(choice),
    );
});
