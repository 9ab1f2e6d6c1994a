//! Perlin's improved noise and its turbulence.
//!
//! Gradients at the points of the integer lattice, blended by `6t^5 - 15t^4 + 10t^3`
//! [Perlin 2002]. In double precision, as his program and that of the classic scenes have it: next to 1 the polynomial cancels, and
//! stripes of marble and wood are functions of the noise times large numbers.

use crate::{DVec3, Vec3};

/// Noise in about [-1, 1], zero at every lattice point, with period 256 on each axis.
pub fn perlin(p: Vec3) -> f32 {
    perlin64(p.x.into(), p.y.into(), p.z.into()) as f32
}

/// [`perlin`] in double precision.
pub fn perlin64(x: f64, y: f64, z: f64) -> f64 {
    if !(x.is_finite() && y.is_finite() && z.is_finite()) {
        return 0.0;
    }
    let cell = |v: f64| v.floor().rem_euclid(256.0) as usize;
    let (xi, yi, zi) = (cell(x), cell(y), cell(z));
    let (xf, yf, zf) = (x - x.floor(), y - y.floor(), z - z.floor());
    let (u, v, w) = (fade(xf), fade(yf), fade(zf));
    let hash = |i: usize, j: usize, k: usize| {
        let a = usize::from(PERMUTATION[(xi + i) & 255]) + yi + j;
        let b = usize::from(PERMUTATION[a & 255]) + zi + k;
        PERMUTATION[b & 255]
    };
    let corner =
        |i: usize, j: usize, k: usize| gradient(hash(i, j, k), xf - i as f64, yf - j as f64, zf - k as f64);
    let edge = |j, k| lerp(u, corner(0, j, k), corner(1, j, k));
    let face = |k| lerp(v, edge(0, k), edge(1, k));
    lerp(w, face(0), face(1))
}

/// [`perlin64`] and its gradient, which is continuous, and so is that one's.
pub fn perlin_slope64(p: DVec3) -> (f64, DVec3) {
    if !p.is_finite() {
        return (0.0, DVec3::ZERO);
    }
    let floor = p.floor();
    let (f, cell) = (p - floor, floor.to_array().map(|v| v.rem_euclid(256.0) as usize));
    let weights = f.to_array().map(fade);
    let slopes = f.to_array().map(|t| 30.0 * t * t * (t * (t - 2.0) + 1.0));
    let (mut value, mut slope) = (0.0, DVec3::ZERO);
    for corner in 0..8 {
        let bit = |axis: usize| (corner >> axis) & 1;
        let a = usize::from(PERMUTATION[(cell[0] + bit(0)) & 255]) + cell[1] + bit(1);
        let b = usize::from(PERMUTATION[a & 255]) + cell[2] + bit(2);
        let hash = PERMUTATION[b & 255];
        let g = DVec3::new(
            gradient(hash, 1.0, 0.0, 0.0),
            gradient(hash, 0.0, 1.0, 0.0),
            gradient(hash, 0.0, 0.0, 1.0),
        );
        let product = g.dot(f - DVec3::new(bit(0) as f64, bit(1) as f64, bit(2) as f64));
        // The share of the corner is a product of one factor for each axis.
        let w = |axis: usize| if bit(axis) == 1 { weights[axis] } else { 1.0 - weights[axis] };
        let dw = |axis: usize| if bit(axis) == 1 { slopes[axis] } else { -slopes[axis] };
        let share = w(0) * w(1) * w(2);
        value += share * product;
        slope +=
            share * g + product * DVec3::new(dw(0) * w(1) * w(2), w(0) * dw(1) * w(2), w(0) * w(1) * dw(2));
    }
    (value, slope)
}

/// The sum of `octaves` noises of doubling frequency and halving size:
/// `N(p) + N(2p)/2 + N(4p)/4 + ...`.
pub fn turbulence(p: Vec3, octaves: u32) -> f32 {
    let (mut q, mut size, mut sum) = (p, 1.0, 0.0);
    for _ in 0..octaves {
        sum += size * perlin(q);
        q *= 2.0;
        size *= 0.5;
    }
    sum
}

fn fade(t: f64) -> f64 {
    t * t * t * (t * (t * 6.0 - 15.0) + 10.0)
}

fn lerp(t: f64, a: f64, b: f64) -> f64 {
    a + t * (b - a)
}

/// Dot product of the offset with one of the twelve edge directions of a cube.
fn gradient(hash: u8, x: f64, y: f64, z: f64) -> f64 {
    let h = hash & 15;
    let u = if h < 8 { x } else { y };
    let v = match h {
        0..4 => y,
        12 | 14 => x,
        _ => z,
    };
    (if h & 1 == 0 { u } else { -u }) + (if h & 2 == 0 { v } else { -v })
}

/// The permutation of Perlin's reference program.
#[rustfmt::skip]
const PERMUTATION: [u8; 256] = [
    151, 160, 137, 91, 90, 15, 131, 13, 201, 95, 96, 53, 194, 233, 7, 225, 140, 36, 103, 30, 69, 142, 8, 99, 37, 240, 21, 10, 23, 190, 6, 148,
    247, 120, 234, 75, 0, 26, 197, 62, 94, 252, 219, 203, 117, 35, 11, 32, 57, 177, 33, 88, 237, 149, 56, 87, 174, 20, 125, 136, 171, 168, 68, 175,
    74, 165, 71, 134, 139, 48, 27, 166, 77, 146, 158, 231, 83, 111, 229, 122, 60, 211, 133, 230, 220, 105, 92, 41, 55, 46, 245, 40, 244, 102, 143, 54,
    65, 25, 63, 161, 1, 216, 80, 73, 209, 76, 132, 187, 208, 89, 18, 169, 200, 196, 135, 130, 116, 188, 159, 86, 164, 100, 109, 198, 173, 186, 3, 64,
    52, 217, 226, 250, 124, 123, 5, 202, 38, 147, 118, 126, 255, 82, 85, 212, 207, 206, 59, 227, 47, 16, 58, 17, 182, 189, 28, 42, 223, 183, 170, 213,
    119, 248, 152, 2, 44, 154, 163, 70, 221, 153, 101, 155, 167, 43, 172, 9, 129, 22, 39, 253, 19, 98, 108, 110, 79, 113, 224, 232, 178, 185, 112, 104,
    218, 246, 97, 228, 251, 34, 242, 193, 238, 210, 144, 12, 191, 179, 162, 241, 81, 51, 145, 235, 249, 14, 239, 107, 49, 192, 214, 31, 181, 199, 106, 157,
    184, 84, 204, 176, 115, 121, 50, 45, 127, 4, 150, 254, 138, 236, 205, 93, 222, 114, 67, 29, 24, 72, 243, 141, 128, 195, 78, 66, 215, 61, 156, 180,
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[expect(clippy::approx_constant, reason = "the point at which the value is published")]
    fn agrees_with_the_published_values() {
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-14, "{a} {b}");
        near(perlin64(3.14, 42.0, 7.0), 0.136_919_958_784_000_12);
        near(perlin64(0.5, 0.5, 0.5), -0.25);
        near(perlin64(1.1, 2.2, 3.3), 0.028_381_052_562_432_216);
    }

    #[test]
    fn the_gradient_is_that_of_the_value() {
        for i in 0..200 {
            let p = DVec3::new(0.37, -0.81, 0.53) * f64::from(i) - 20.0;
            let (value, slope) = perlin_slope64(p);
            assert!((value - perlin64(p.x, p.y, p.z)).abs() < 1e-14);
            let h = 1e-5;
            for axis in 0..3 {
                let at = |s: f64| {
                    let mut q = p;
                    q[axis] += s;
                    perlin64(q.x, q.y, q.z)
                };
                let difference = (at(h) - at(-h)) / (2.0 * h);
                assert!((difference - slope[axis]).abs() < 1e-8, "{p} {axis}: {difference} {}", slope[axis]);
            }
        }
    }

    #[test]
    fn vanishes_on_the_lattice_and_survives_bad_numbers() {
        for i in -3..3 {
            assert_eq!(perlin(Vec3::new(i as f32, 2.0, -5.0)), 0.0);
        }
        assert_eq!(perlin(Vec3::splat(f32::NAN)), 0.0);
        assert_eq!(perlin(Vec3::splat(f32::INFINITY)), 0.0);
    }

    #[test]
    fn permutation_is_one() {
        let mut seen = [false; 256];
        PERMUTATION.iter().for_each(|&i| seen[usize::from(i)] = true);
        assert!(seen.iter().all(|&s| s));
    }
}
