//! What three numbers cannot know: paints under sodium light, and filters one behind the other.
//!
//! `cargo run -p kajo-color --example rgb_or_spectral`

use kajo_color::{Emission, Reflectance, Spectrum, Wavelengths, named, sensor};

const PAINTS: [(&str, [f32; 3]); 4] = [
    ("red", [0.6, 0.05, 0.05]),
    ("yellow", [0.7, 0.55, 0.05]),
    ("green", [0.1, 0.4, 0.1]),
    ("blue", [0.05, 0.1, 0.6]),
];

fn main() {
    let sodium = named::illuminant("sodium").expect("it is in the list");
    println!("paint under sodium light        as RGB                 as a spectrum");
    for (name, rgb) in PAINTS {
        let paint = Reflectance::from_rgb(rgb);
        print(name, |lambda| sodium.at(lambda) * paint.at(lambda));
    }

    let white = Emission::from_rgb([1.0; 3]);
    let filter = Reflectance::from_rgb([0.45, 0.75, 0.5]);
    println!("\ndaylight through filters       as RGB                 as a spectrum");
    for n in [1, 2, 4, 8, 16] {
        let through =
            |lambda: &Wavelengths| (0..n).fold(white.at(lambda), |light, _| light * filter.at(lambda));
        print(&n.to_string(), through);
    }
}

/// Linear sRGB of the same light in both modes.
fn print(name: &str, light: impl Fn(&Wavelengths) -> Spectrum) {
    const N: u32 = 100_000;
    let mut sum = [0.0; 3];
    for i in 0..N {
        let lambda = Wavelengths::sample((i as f32 + 0.5) / N as f32);
        for (sum, x) in sum.iter_mut().zip(sensor::to_rgb(light(&lambda), &lambda)) {
            *sum += f64::from(x) / f64::from(N);
        }
    }
    let [r, g, b] = light(&Wavelengths::RGB).to_rgb();
    println!("{name:<28}{r:7.4} {g:7.4} {b:7.4}  {:7.4} {:7.4} {:7.4}", sum[0], sum[1], sum[2]);
}
