//! Writes the cloud of `scenes/gallery/cloud.txt`: `cargo run -p kajo-testkit --example cloud_vdb -- scenes/gallery/grids/cloud.vdb`.
//!
//! A cumulus, 10 long, which floats 2.5 above (0, 0, 0): balls of several sizes over a flat base, eaten away by fractal noise of cells [Worley 1996].
//! `density` is from 0 to 1.

use kajo_math::Vec3;
use kajo_math::pattern::{Metric, nearest_two};
use kajo_testkit::vdb::{VdbCompression, VdbFile, VdbGrid, VdbKind, VdbMap};

/// The length of a voxel.
const VOXEL: f64 = 0.1;
/// Voxels along the axes.
const SIZE: [i32; 3] = [100, 56, 68];
/// What the cloud is raised by, in voxels.
const HEIGHT: i32 = 18;

/// The middle and the radius of each ball.
const BALLS: [(Vec3, f32); 10] = [
    (Vec3::new(-2.0, 1.7, 0.0), 2.0),
    (Vec3::new(-0.2, 2.4, -0.3), 2.6),
    (Vec3::new(1.6, 1.9, 0.4), 2.0),
    (Vec3::new(3.0, 1.4, -0.1), 1.3),
    (Vec3::new(-3.1, 1.3, -0.5), 1.2),
    (Vec3::new(-0.8, 3.5, 0.0), 1.7),
    (Vec3::new(0.6, 3.4, -0.7), 1.5),
    (Vec3::new(-1.0, 1.6, 1.3), 1.5),
    (Vec3::new(3.9, 1.2, 0.4), 0.8),
    (Vec3::new(0.5, 1.5, 1.6), 1.2),
];

/// How dense the cloud is at a point, from 0 to 1.
fn density(p: Vec3) -> f32 {
    let inside =
        BALLS.iter().map(|&(middle, radius)| 1.0 - (p - middle).length() / radius).fold(0.0, f32::max);
    let above = ((p.y - 0.7) / 0.45).clamp(0.0, 1.0);
    if inside <= 0.0 || above <= 0.0 {
        return 0.0;
    }
    let cells = |k: u16| nearest_two(p * 0.55 * f32::from(1_u16 << k), Metric::Euclidean, k.into()).0[0];
    let worn: f32 = (0..4).map(|k| 0.5_f32.powi(i32::from(k) + 1) * cells(k)).sum();
    above * (3.0 * (inside - 0.75 * worn + 0.2)).clamp(0.0, 1.0)
}

fn main() -> std::io::Result<()> {
    let path = std::env::args().nth(1).expect("the file to write");
    let mut grid = VdbGrid::new("density", VdbKind::Half, VdbMap::Uniform(VOXEL));
    let [nx, ny, nz] = SIZE;
    for index in (0..nx * ny * nz).map(|k| [k % nx - nx / 2, k / nx % ny, k / (nx * ny) - nz / 2]) {
        let p = Vec3::from(index.map(|i| i as f32 + 0.5)) * VOXEL as f32;
        // Numbers of few digits are stored in few bytes.
        let stored = (32.0 * density(p)).round() / 32.0;
        if stored > 0.0 {
            grid.set([index[0], index[1] + HEIGHT, index[2]], [stored; 3]);
        }
    }
    let file = VdbFile { version: 224, compression: VdbCompression::Zip, masks: true, grids: vec![grid] };
    std::fs::write(path, file.to_bytes())
}
