//! Writes the dye of `scenes/gallery/dye.txt`: `cargo run -p kajo-testkit --example dye_vdb -- scenes/gallery/grids/dye.vdb`.
//!
//! Two drops of dye that run into each other in the unit ball around (0, 0, 0): `density` from 0 to 1, and `Cd` its colours.

use kajo_math::Vec3;
use kajo_math::noise::perlin;
use kajo_testkit::vdb::{VdbCompression, VdbFile, VdbGrid, VdbKind, VdbMap};

/// Voxels along an axis.
const SIDE: i32 = 40;

const YELLOW: Vec3 = Vec3::new(0.98, 0.75, 0.12);
const BLUE: Vec3 = Vec3::new(0.15, 0.35, 0.95);

/// Noise of octaves of which each is half as large and half as strong as the one before.
fn octaves(p: Vec3) -> f32 {
    (0..3).map(|k| perlin(p * (1 << k) as f32 + 5.1 * k as f32) / (1 << k) as f32).sum()
}

fn main() -> std::io::Result<()> {
    let path = std::env::args().nth(1).expect("the file to write");
    let map = || VdbMap::Uniform(2.0 / f64::from(SIDE));
    let mut density = VdbGrid::new("density", VdbKind::Half, map());
    let mut colors = VdbGrid::new("Cd", VdbKind::HalfVec3, map());
    // Numbers of few digits are stored in few bytes.
    let stored = |v: f32| (v.clamp(0.0, 1.0) * 32.0).round() / 32.0;
    for index in (0..SIDE.pow(3)).map(|k| [k % SIDE, k / SIDE % SIDE, k / (SIDE * SIDE)]) {
        let index = index.map(|i| i - SIDE / 2);
        let p = Vec3::from(index.map(|i| (i as f32 + 0.5) * 2.0 / SIDE as f32));
        let carried = Vec3::new(octaves(1.7 * p + 3.0), octaves(1.7 * p - 4.0), octaves(1.7 * p + 9.0));
        let q = p + 0.45 * carried;
        let inside = stored(1.6 * (0.85 - q.length()) + 0.3 * octaves(4.0 * p));
        if inside > 0.0 && p.length() < 0.95 {
            density.set(index, [inside; 3]);
            let share = (0.5 + 2.2 * q.x).clamp(0.0, 1.0);
            colors.set(index, BLUE.lerp(YELLOW, share).to_array().map(stored));
        }
    }
    let grids = vec![density, colors];
    let file = VdbFile { version: 224, compression: VdbCompression::Zip, masks: true, grids };
    std::fs::write(path, file.to_bytes())
}
