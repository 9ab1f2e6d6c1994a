//! Gradient noise: improved Perlin noise with hashed gradients.
//!
//! At each lattice point stands one of the twelve directions to the edges of a cube, four of them drawn twice as often; its dot products
//! with the offset are blended by `6t^5 - 15t^4 + 10t^3` [Perlin 2002]. The choice is a [hash](super::hash), so that
//! nothing is repeated after 256 cells. Over all places its mean is 0, its standard deviation [`SIGMA`], and the mean of its absolute
//! value [`MEAN_ABS`].

use super::{cell_and_offset, hash, lerp};
use crate::Vec3;

/// Standard deviation of the noise.
pub(super) const SIGMA: f32 = 0.27;

/// Mean of the absolute value.
pub(super) const MEAN_ABS: f32 = 0.220_2;

/// Noise in about [-1, 1], zero at lattice points.
///
/// * `q`: finite
pub fn noise(q: Vec3, seed: u32) -> f32 {
    let [(x, fx), (y, fy), (z, fz)] = q.to_array().map(cell_and_offset);
    let [u, v, w] = [fx, fy, fz].map(fade);
    let plane = |i: i32, fx: f32| {
        let h = hash::with(seed, x.wrapping_add(i));
        let edge = |j: i32, fy: f32| {
            let h = hash::with(h, y.wrapping_add(j));
            let corner = |k: i32, fz: f32| gradient(hash::with(h, z.wrapping_add(k)), fx, fy, fz);
            lerp(w, corner(0, fz), corner(1, fz - 1.0))
        };
        lerp(v, edge(0, fy), edge(1, fy - 1.0))
    };
    lerp(u, plane(0, fx), plane(1, fx - 1.0))
}

/// Three independent noises.
pub fn noise_vector(q: Vec3, seed: u32) -> Vec3 {
    // Moved, since each is zero at its lattice points.
    let shifted = |k: u32| noise(q + SHIFT * k as f32, seed.wrapping_add(k));
    Vec3::new(shifted(0), shifted(1), shifted(2))
}

/// Irrational parts of a cell by which octaves are moved, so that their zeros do not meet: powers of `1 / g`, `g^4 = g + 1`.
pub(super) const SHIFT: Vec3 = Vec3::new(0.819_172_5, 0.671_043_6, 0.549_700_5);

fn fade(t: f32) -> f32 {
    t * t * t * (t * (t * 6.0 - 15.0) + 10.0)
}

/// Dot product of the offset with one of the directions to the edges of a cube.
#[inline]
fn gradient(hash: u32, x: f32, y: f32, z: f32) -> f32 {
    let h = hash >> 28;
    let u = if h < 8 { x } else { y };
    let v = if h < 4 { y } else { z };
    let v = if h == 12 || h == 14 { x } else { v };
    (if h & 1 == 0 { u } else { -u }) + (if h & 2 == 0 { v } else { -v })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pattern::spread;

    #[test]
    fn moments_are_those_of_improved_noise() {
        let n = 400_000u32;
        let (mut sum, mut squares, mut absolute) = (0.0f64, 0.0f64, 0.0f64);
        for i in 0..n {
            let v = f64::from(noise(1000.0 * spread(i), 3));
            assert!(v.abs() < 1.04);
            sum += v;
            squares += v * v;
            absolute += v.abs();
        }
        let n = f64::from(n);
        let sigma = (squares / n).sqrt();
        assert!((sum / n).abs() < 0.002, "{}", sum / n);
        assert!((sigma - f64::from(SIGMA)).abs() < 0.001, "{sigma}");
        assert!((absolute / n - f64::from(MEAN_ABS)).abs() < 0.001, "{}", absolute / n);
    }

    #[test]
    fn it_vanishes_on_the_lattice_and_is_smooth_across_its_planes() {
        for i in -4..4 {
            assert_eq!(noise(Vec3::new(i as f32, 7.0, -2.0), 1), 0.0);
        }
        for i in 0..500 {
            let q = (8.0 * spread(i)).round() + 0.37 * spread(i + 1000);
            for axis in 0..3 {
                let mut at = q;
                at[axis] = q[axis].round();
                let value = |step: f32| {
                    let mut q = at;
                    q[axis] += step;
                    noise(q, 5)
                };
                // Value, slope and curvature agree from both sides.
                let h = 0.02;
                let [below, there, above] = [value(-h), value(0.0), value(h)];
                assert!(((above - there) - (there - below)).abs() < 6e-3, "{q} {axis}");
                assert!((above - there).abs() < 2.5 * h);
            }
        }
    }

    #[test]
    fn the_parts_of_a_vector_are_independent() {
        let n = 50_000u32;
        let products = (0..n).fold(Vec3::ZERO, |sum, i| {
            let v = noise_vector(100.0 * spread(i), 9);
            sum + v * Vec3::new(v.y, v.z, v.x)
        });
        assert!((products / n as f32).abs().max_element() < 0.002, "{products}");
    }
}
