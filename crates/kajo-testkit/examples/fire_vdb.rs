//! Writes the fire of `scenes/gallery/fire.txt`: `cargo run -p kajo-testkit --example fire_vdb -- scenes/gallery/grids/fire.vdb`.
//!
//! Tongues of a flame above the point (0, 0, 0), 2.4 high: `density` is that of soot, and `flame` how hot it is, from 0 to 1.

use kajo_math::Vec3;
use kajo_math::noise::perlin;
use kajo_testkit::vdb::{VdbCompression, VdbFile, VdbGrid, VdbKind, VdbMap};

/// The length of a voxel.
const VOXEL: f64 = 0.05;

/// Octaves of noise, each half as large and half as strong as the one before.
fn octaves(p: Vec3) -> f32 {
    (0..3).map(|k| perlin(p * (1 << k) as f32 + 7.3 * k as f32) / (1 << k) as f32).sum()
}

/// How far inside of the flame a point is: 0 at its edge, below that outside.
fn inside(p: Vec3) -> f32 {
    let h = (p.y / 2.4).clamp(0.0, 1.0);
    // What has risen further has been carried further, and is torn into tongues that are longer than wide.
    let q = Vec3::new(2.1 * p.x, 0.9 * p.y, 2.1 * p.z);
    let carried = Vec3::new(octaves(q + 3.0), 0.0, octaves(q - 11.0)) * (0.45 * h.powf(0.8));
    let r = (p + carried).with_y(0.0).length();
    let width = 0.75 * (h + 0.02).powf(0.25) * (1.0 - h).powf(0.85);
    1.0 - r / width.max(1e-3) + 0.9 * octaves(1.3 * q + 5.0) * h
}

fn main() -> std::io::Result<()> {
    let path = std::env::args().nth(1).expect("the file to write");
    let of = |name: &str| VdbGrid::new(name, VdbKind::Half, VdbMap::Uniform(VOXEL));
    let (mut density, mut flame) = (of("density"), of("flame"));
    for index in (0..36 * 50 * 36).map(|k| [k % 36 - 18, k / 36 % 50, k / 1800 - 18]) {
        let p = Vec3::from(index.map(|x| (f64::from(x) * VOXEL) as f32));
        let d = inside(p);
        if d <= 0.0 {
            continue;
        }
        // Numbers of few digits are stored in few bytes.
        let stored = |v: f32| (v.clamp(0.0, 1.0) * 64.0).round() / 64.0;
        let soot = stored(1.6 * d);
        if soot > 0.0 {
            density.set(index, [soot; 3]);
            flame.set(index, [stored(0.3 + 0.9 * d.min(0.8) - 0.18 * p.y); 3]);
        }
    }
    let grids = vec![density, flame];
    let file = VdbFile { version: 224, compression: VdbCompression::Zip, masks: true, grids };
    std::fs::write(path, file.to_bytes())
}
