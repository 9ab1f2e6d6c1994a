//! Work for counting instructions: `instructions KERNEL ROUNDS`.
//!
//! Makes a tree and rays, then runs one kernel on all of them so many times. A program that
//! counts instructions, run with 0 and with 1 rounds, tells by the difference what a ray costs;
//! `cargo xtask instructions` does that.

use std::process::ExitCode;

use kajo_bvh::bench::{Mesh, Rays, primary, secondary};
use kajo_bvh::{BuildSettings, Quality, TriangleBvh, TriangleHit};
use kajo_math::rng::mix;
use kajo_math::{Ray, Vec3};

/// Squares on a side of the ground.
const GROUND: u32 = 96;
/// Thin triangles that stand on it.
const BLADES: u32 = 3000;
/// Of the camera's tiles of 1024 rays, one in so many is used.
const TILES: usize = 32;

/// Uniform in [0, 1): number `k` of thing `i`.
fn uniform(i: u32, k: u32) -> f32 {
    (mix(u64::from(i) << 8 | u64::from(k)) >> 40) as f32 / (1 << 24) as f32
}

/// Rough ground with thin triangles on it, in a large room: parts of very different size.
fn scene() -> Mesh {
    let mut mesh = Mesh {
        name: "instructions".into(),
        positions: Vec::new(),
        triangles: Vec::new(),
        eye: Vec3::new(0.5, 0.45, 1.6),
        target: Vec3::new(0.5, 0.0, 0.5),
        up: Vec3::Y,
        fov_degrees: 50.0,
        light: Vec3::new(0.2, 1.5, 0.8),
        eps: 1e-4,
    };
    let at = |i: u32| (i % (GROUND + 1), i / (GROUND + 1));
    let height = |i: u32| Vec3::new(at(i).0 as f32, 3.0 * uniform(i, 0), at(i).1 as f32) / GROUND as f32;
    mesh.positions.extend((0..(GROUND + 1) * (GROUND + 1)).map(height));
    for i in (0..(GROUND + 1) * GROUND).filter(|&i| at(i).0 < GROUND) {
        let below = i + GROUND + 1;
        mesh.triangles.extend([[i, i + 1, below], [i + 1, below + 1, below]]);
    }
    for i in 0..BLADES {
        let foot = Vec3::new(uniform(i, 1), 0.0, uniform(i, 2));
        let tip = foot + Vec3::new(0.1 * uniform(i, 3) - 0.05, 0.05 + 0.2 * uniform(i, 4), 0.0);
        add(&mut mesh, [foot, foot + Vec3::new(0.002, 0.0, 0.002), tip]);
    }
    let corner =
        |i: u32| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) * 40.0 - Vec3::splat(20.0);
    for [a, b, c, d] in [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]] {
        add(&mut mesh, [a, b, c].map(corner));
        add(&mut mesh, [a, c, d].map(corner));
    }
    mesh
}

fn add(mesh: &mut Mesh, corners: [Vec3; 3]) {
    let first = mesh.positions.len() as u32;
    mesh.positions.extend(corners);
    mesh.triangles.push([first, first + 1, first + 2]);
}

fn build(mesh: &Mesh) -> TriangleBvh {
    let settings = BuildSettings { quality: Quality::Fast };
    TriangleBvh::build(&mesh.positions, &mesh.triangles, &settings).unwrap_or_default()
}

/// How many hits one round finds, and over how many things its cost is spread.
fn round(
    kernel: &str,
    tree: &TriangleBvh,
    mesh: &Mesh,
    camera: &[Ray],
    others: &Rays,
) -> Option<(usize, usize)> {
    let closest = |rays: &[Ray]| (rays.iter().filter(|ray| tree.closest(ray).is_some()).count(), rays.len());
    Some(match kernel {
        "primary" => closest(camera),
        "bounce" => closest(&others.bounce),
        "shadow" => (others.shadow.iter().filter(|ray| tree.any(ray)).count(), others.shadow.len()),
        "packet" => {
            let (packets, _) = camera.as_chunks::<8>();
            (packets.iter().map(|rays| tree.closest8(rays).iter().flatten().count()).sum(), camera.len())
        }
        "build" => (build(mesh).stats().leaves, mesh.triangles.len()),
        _ => return None,
    })
}

fn main() -> ExitCode {
    let mut args = std::env::args().skip(1);
    let kernel = args.next().unwrap_or_default();
    let rounds: usize = args.next().and_then(|rounds| rounds.parse().ok()).unwrap_or(1);
    // One thread, so that none waits in a loop.
    let Ok(pool) = rayon::ThreadPoolBuilder::new().num_threads(1).build() else { return ExitCode::FAILURE };
    pool.install(|| {
        let mesh = scene();
        let tree = build(&mesh);
        let camera: Vec<Ray> = primary(&mesh).chunks(1024).step_by(TILES).flatten().copied().collect();
        let hits: Vec<Option<TriangleHit>> = camera.iter().map(|ray| tree.closest(ray)).collect();
        let others = secondary(&mesh, &camera, &hits);
        let size = |kernel| round(kernel, &tree, &mesh, &camera, &others);
        let Some((found, things)) = size(&kernel) else {
            eprintln!("instructions primary|bounce|shadow|packet|build ROUNDS");
            return ExitCode::FAILURE;
        };
        // Without the round that told the size.
        for _ in 0..rounds {
            std::hint::black_box(size(&kernel));
        }
        println!("{found} found of {things}");
        ExitCode::SUCCESS
    })
}
