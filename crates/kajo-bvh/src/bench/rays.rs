//! The rays of the protocol, a function of the mesh alone.

use kajo_math::{Ray, Vec3, fmath};

use super::Mesh;
use crate::TriangleHit;

/// Pixels on a side.
const SIZE: u32 = 1024;
/// Pixels on a side of a tile.
const TILE: u32 = 32;

/// Rays that start from hits of primary rays.
#[derive(Clone, Debug, Default)]
pub struct Rays {
    /// Into a cosine-distributed direction.
    pub bounce: Vec<Ray>,
    /// To the light.
    pub shadow: Vec<Ray>,
}

/// The PCG hash, 32 bits to 32 bits.
fn pcg(x: u32) -> u32 {
    let s = x.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let w = ((s >> ((s >> 28) + 4)) ^ s).wrapping_mul(277_803_737);
    (w >> 22) ^ w
}

/// Uniform in [0, 1): number `k` of ray `i`.
fn uniform(i: u32, k: u32) -> f32 {
    (pcg(pcg(i).wrapping_add(k)) >> 8) as f32 * (1.0 / 16_777_216.0)
}

fn unit(v: Vec3) -> Vec3 {
    v * (1.0 / v.dot(v).sqrt())
}

/// One ray a pixel, tiles row by row and rows within a tile.
pub fn primary(mesh: &Mesh) -> Vec<Ray> {
    let forward = unit(mesh.target - mesh.eye);
    let right = unit(forward.cross(mesh.up));
    let up = right.cross(forward);
    let half = fmath::tan(mesh.fov_degrees * 0.5 * std::f32::consts::PI / 180.0);
    let inv = 2.0 / SIZE as f32;
    let tiles = SIZE / TILE;
    let pixel = |i: u32| {
        let (tile, within) = (i / (TILE * TILE), i % (TILE * TILE));
        (tile % tiles * TILE + within % TILE, tile / tiles * TILE + within / TILE)
    };
    let ray = |(x, y): (u32, u32)| {
        let px = ((x as f32 + 0.5) * inv - 1.0) * half;
        let py = (1.0 - (y as f32 + 0.5) * inv) * half;
        Ray::new(mesh.eye, unit(forward + right * px + up * py))
    };
    (0..SIZE * SIZE).map(|i| ray(pixel(i))).collect()
}

/// Bounce and shadow rays of the primary rays that hit something.
pub fn secondary(mesh: &Mesh, rays: &[Ray], hits: &[Option<TriangleHit>]) -> Rays {
    let mut out = Rays::default();
    for (i, (ray, hit)) in (0..).zip(rays.iter().zip(hits)) {
        let Some(hit) = hit else { continue };
        let [a, b, c] = mesh.triangles[hit.triangle as usize].map(|v| mesh.positions[v as usize]);
        let across = (b - a).cross(c - a);
        if across.dot(across) <= 0.0 {
            continue;
        }
        let mut n = unit(across);
        if n.dot(ray.d) > 0.0 {
            n = -n;
        }
        let q = ray.o + ray.d * hit.t + n * mesh.eps;
        let z = 1.0 - 2.0 * uniform(i, 0);
        let r = (1.0 - z * z).max(0.0).sqrt();
        let phi = std::f32::consts::TAU * uniform(i, 1);
        let d = n + Vec3::new(r * fmath::cos(phi), r * fmath::sin(phi), z);
        let d = if d.dot(d) > 1e-12 { d } else { n };
        out.bounce.push(Ray::new(q, unit(d)));
        let to_light = mesh.light - q;
        let distance = to_light.dot(to_light).sqrt();
        out.shadow.push(Ray::new(q, to_light * (1.0 / distance)).over(0.0, distance * 0.999));
    }
    out
}
