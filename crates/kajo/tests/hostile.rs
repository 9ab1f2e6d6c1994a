//! The seeds of `fuzz/corpus` and what a fixed seed makes of them, compiled and rendered.

#[path = "hostile/renders.rs"]
mod renders;

use kajo_math::rng::Stream;
use kajo_testkit::corpus;

/// Changed bytes, pieces that are gone or double, and numbers in place of others.
fn mutate(seed: &[u8], stream: &Stream) -> Vec<u8> {
    const NUMBERS: [&[u8]; 10] =
        [b"0", b"-1", b"nan", b"inf", b"1e-30", b"1e30", b"-0.0", b"65536", b"1e-7", b"0.999999"];
    let mut data = seed.to_vec();
    let below = |i: u32, n: usize| (stream.uniform(i) * n as f32) as usize;
    for round in 0..1 + below(0, 3) as u32 {
        let i = 1 + 4 * round;
        let at = below(i, data.len().max(1));
        let end = (at + below(i + 1, 12)).min(data.len());
        match below(i + 2, 5) {
            0 if at < data.len() => data[at] ^= 1 << below(i + 3, 8),
            1 => drop(data.drain(at.min(end)..end)),
            2 => {
                let piece = data[at.min(end)..end].to_vec();
                data.splice(at.min(end)..at.min(end), piece);
            }
            _ => {
                // The number that begins there, or after.
                let is_digit = |b: &u8| b.is_ascii_digit() || b"+-.e".contains(b);
                let Some(from) = data[at.min(end)..].iter().position(is_digit).map(|i| at + i) else {
                    continue;
                };
                let to = data[from..].iter().position(|b| !is_digit(b)).map_or(data.len(), |i| from + i);
                data.splice(from..to, NUMBERS[below(i + 3, NUMBERS.len())].iter().copied());
            }
        }
    }
    data
}

/// Mutants of each seed.
const MUTANTS: u32 = 300;

fn replay(name: &str, run: impl Fn(&[u8], u32)) {
    for (number, (_, seed)) in corpus(name).iter().enumerate() {
        for i in 0..MUTANTS {
            let stream = Stream::new(22, [number as u32, i], 0);
            let data = if i < 8 { seed.clone() } else { mutate(seed, &stream) };
            run(&data, i + number as u32);
        }
    }
}

#[test]
fn scenes_are_refused_or_rendered() {
    let square: &[u8] = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
    let files: [(&str, &[u8]); 3] = [
        ("m.obj", square),
        ("a.pgm", b"P2 2 2 255 0 255 128 7\n"),
        ("a.ppm", b"P3 2 1 255 0 255 128 7 9 1\n"),
    ];
    for name in ["scene", "render"] {
        replay(name, |data, i| renders::picture(data, &files, renders::integrator(i as u8)));
    }
}

#[test]
fn meshes_are_refused_or_rendered_in_every_part() {
    for name in ["obj", "ply", "stl"] {
        replay(name, |data, i| renders::mesh(data, name, i as usize, renders::integrator((i / 8) as u8)));
    }
}

#[test]
fn models_are_refused_or_rendered() {
    replay("gltf", |data, i| {
        let extension = if data.starts_with(b"glTF") { "glb" } else { "gltf" };
        renders::mesh(data, extension, i as usize, renders::integrator(i as u8));
    });
}
