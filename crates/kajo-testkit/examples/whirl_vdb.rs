//! Writes the whirlwind of `scenes/gallery/whirl.txt`: `cargo run -p kajo-testkit --example whirl_vdb -- scenes/gallery/grids/whirl.vdb`.
//!
//! A funnel of dust around the axis x = z = 0, 2.6 high: `density`, and `vel`, how fast it turns and rises.

use kajo_math::Vec3;
use kajo_math::noise::perlin;
use kajo_testkit::vdb::{VdbCompression, VdbFile, VdbGrid, VdbKind, VdbMap};

/// The length of a voxel, and of one of the velocities.
const VOXELS: [f64; 2] = [0.05, 0.2];

/// Voxels along x, y and z.
const SIZES: [[i32; 3]; 2] = [[48, 54, 48], [15, 16, 15]];

/// The radius of the funnel at a height.
fn radius(y: f32) -> f32 {
    0.1 + 0.13 * y * y
}

fn density(p: Vec3) -> f32 {
    let (r, angle) = (p.with_y(0.0).length(), p.z.atan2(p.x));
    let lumps: f32 = (0..3)
        .map(|k| {
            let scale = (1 << k) as f32;
            // Lumps stand in rising turns around the axis.
            let turned = angle + 2.2 * p.y;
            let place =
                Vec3::new(1.6 * turned.cos(), 1.4 * p.y, 1.6 * turned.sin()) + 2.0 * (r - radius(p.y));
            perlin(scale * 1.7 * place + 9.1 * scale) / scale
        })
        .sum();
    let wall = 1.0 - ((r - radius(p.y)) / (0.06 + 0.09 * p.y)).abs();
    let dust = 1.0 - (p - Vec3::Y * 0.05).length_squared() / 0.3;
    let fade = ((2.6 - p.y) / 0.7).clamp(0.0, 1.0);
    (wall + 1.5 * lumps).max(dust + 2.0 * lumps) * fade
}

fn velocity(p: Vec3) -> Vec3 {
    let r = p.with_y(0.0).length();
    let turn = 2.4 / (0.35 + r * r) * 0.5;
    Vec3::new(-p.z * turn, 0.35, p.x * turn)
}

fn main() -> std::io::Result<()> {
    let path = std::env::args().nth(1).expect("the file to write");
    let mut grids = [("density", VdbKind::Half), ("vel", VdbKind::Vec3)].map(|(name, kind)| {
        let voxel = if kind == VdbKind::Half { VOXELS[0] } else { VOXELS[1] };
        VdbGrid::new(name, kind, VdbMap::Uniform(voxel))
    });
    for (k, grid) in grids.iter_mut().enumerate() {
        let [nx, ny, nz] = SIZES[k];
        for i in 0..nx * ny * nz {
            let index = [i % nx - nx / 2, i / nx % ny - k as i32, i / (nx * ny) - nz / 2];
            let p = Vec3::from(index.map(|x| (f64::from(x) * VOXELS[k]) as f32));
            // Numbers of few digits are stored in few bytes.
            if k == 0 {
                let stored = (density(p).clamp(0.0, 1.0) * 32.0).round() / 32.0;
                if stored > 0.0 {
                    grid.set(index, [stored; 3]);
                }
            } else {
                grid.set(index, velocity(p).to_array().map(|v| (16.0 * v).round() / 16.0));
            }
        }
    }
    let file = VdbFile { version: 224, compression: VdbCompression::Zip, masks: true, grids: grids.to_vec() };
    std::fs::write(path, file.to_bytes())
}
