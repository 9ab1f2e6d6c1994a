//! Densities of directions as trees of squares [Müller, Gross and Novák 2017, 3.1].
//!
//! The sphere is a square, by a map that keeps areas and neighbours [Clarberg 2008]. A node divides its square into quarters and says
//! which share of what the square holds is in each, so that with the shares `s` on the way to a leaf the density per solid angle is
//!
//! ```text
//! p = 1/(4 pi) product of 4 s
//! ```
//!
//! A direction is drawn by descending: the two numbers that choose a quarter are stretched over it and go on. Equal numbers in, equal order
//! out, so that well-spread samples stay well-spread.

use std::f32::consts::{FRAC_2_PI, FRAC_PI_4, PI};

use kajo_math::{Vec2, Vec3, fmath};

/// Density of directions that are uniform over the sphere.
pub const UNIFORM: f32 = 0.25 / PI;

/// The largest number below 1.
const BELOW_ONE: f32 = 1.0 - f32::EPSILON / 2.0;

/// A quarter that is divided no further.
pub const LEAF: u32 = u32::MAX;

/// A square in four quarters: that at the origin, the next in x, the next in y, and the one across.
#[derive(Clone, Copy, Debug)]
pub struct Node {
    /// What is in each, as a share of the node; they sum to 1.
    pub shares: [f32; 4],
    /// The node of each quarter, or [`LEAF`].
    pub children: [u32; 4],
}

/// Which quarter a place of the unit square is in, and the place within it.
#[inline]
pub fn quarter(p: Vec2) -> (usize, Vec2) {
    let (x, y) = (usize::from(p.x >= 0.5), usize::from(p.y >= 0.5));
    (x + 2 * y, Vec2::new(2.0 * p.x - x as f32, 2.0 * p.y - y as f32))
}

/// Density per solid angle of a direction, by the tree below a node.
///
/// * `p`: the direction in the square, [`to_square`]
#[inline]
pub fn density(nodes: &[Node], root: u32, mut p: Vec2) -> f32 {
    let (mut density, mut at) = (UNIFORM, root);
    while at != LEAF {
        let node = &nodes[at as usize];
        let (i, within) = quarter(p);
        density *= 4.0 * node.shares[i];
        (at, p) = (node.children[i], within);
    }
    density
}

/// Draws a direction with [`density`], which is returned with its place in the square.
///
/// * `u`: uniform in [0, 1)²
#[inline]
pub fn sample(nodes: &[Node], root: u32, mut u: Vec2) -> (Vec2, f32) {
    let (mut density, mut at) = (UNIFORM, root);
    let (mut corner, mut side) = (Vec2::ZERO, 1.0);
    while at != LEAF {
        let node = &nodes[at as usize];
        let [a, b, c, d] = node.shares;
        let left = (a + c) / (a + b + c + d);
        let x = usize::from(u.x >= left);
        let (low, high) = if x == 0 { (a, c) } else { (b, d) };
        let below = low / (low + high);
        let y = usize::from(u.y >= below);
        let within = |u: f32, part: f32, i: usize| match i {
            0 => u / part,
            _ => (u - part) / (1.0 - part),
        };
        u = Vec2::new(within(u.x, left, x), within(u.y, below, y)).clamp(Vec2::ZERO, Vec2::splat(BELOW_ONE));
        side *= 0.5;
        corner += side * Vec2::new(x as f32, y as f32);
        let i = x + 2 * y;
        density *= 4.0 * node.shares[i];
        at = node.children[i];
    }
    ((corner + side * u).min(Vec2::splat(BELOW_ONE)), density)
}

/// A unit vector as a place in the unit square: equal areas of the sphere are equal areas there [Clarberg 2008].
#[inline]
pub fn to_square(w: Vec3) -> Vec2 {
    let (x, y) = (w.x.abs(), w.y.abs());
    let r = (1.0 - w.z.abs()).max(0.0).sqrt();
    // The angle in the quarter, from 0 to 1.
    let turn = if x == 0.0 && y == 0.0 { 0.0 } else { FRAC_2_PI * fmath::atan2(y, x) };
    let (mut u, mut v) = (r - turn * r, turn * r);
    if w.z < 0.0 {
        (u, v) = (1.0 - v, 1.0 - u);
    }
    let place = 0.5 * Vec2::new(u.copysign(w.x) + 1.0, v.copysign(w.y) + 1.0);
    place.clamp(Vec2::ZERO, Vec2::splat(BELOW_ONE))
}

/// The unit vector of a place in the unit square.
#[inline]
pub fn from_square(p: Vec2) -> Vec3 {
    let (u, v) = (2.0 * p.x - 1.0, 2.0 * p.y - 1.0);
    let (x, y) = (u.abs(), v.abs());
    let above = 1.0 - (x + y);
    let r = 1.0 - above.abs();
    let turn = if r == 0.0 { 1.0 } else { (y - x) / r + 1.0 };
    let (sin, cos) = fmath::sin_cos(FRAC_PI_4 * turn);
    let z = (1.0 - r * r).copysign(above);
    let across = r * (2.0 - r * r).max(0.0).sqrt();
    Vec3::new((across * cos).copysign(u), (across * sin).copysign(v), z)
}

#[cfg(test)]
mod tests {
    use kajo_math::rng::mix;
    use kajo_testkit::ChiSquare;

    use super::*;

    fn numbers(i: u64) -> Vec2 {
        let h = mix(i);
        Vec2::new((h >> 40) as f32, (h >> 16 & 0xFF_FFFF) as f32) / 16_777_216.0
    }

    #[test]
    fn the_square_and_the_sphere_are_one_and_the_same() {
        for i in 0..20_000 {
            let p = numbers(i);
            let w = from_square(p);
            assert!((w.length() - 1.0).abs() < 1e-5, "{p} {w}");
            assert!(to_square(w).distance(p) < 3e-4, "{p} {w} {}", to_square(w));
        }
        for w in [Vec3::X, Vec3::Y, Vec3::Z, -Vec3::X, -Vec3::Y, -Vec3::Z] {
            let p = to_square(w);
            assert!(p.cmpge(Vec2::ZERO).all() && p.cmplt(Vec2::ONE).all());
            assert!(from_square(p).distance(w) < 1e-3, "{w} {p}");
        }
    }

    /// The mean of z^2 is 1/3 and that of a cap its share, which a map that keeps areas has and no other.
    #[test]
    fn the_map_keeps_areas() {
        let n = 512;
        let (mut squares, mut cap, mut slice) = ([0.0f64; 3], 0, 0);
        for i in 0..n * n {
            let w = from_square((Vec2::new((i % n) as f32, (i / n) as f32) + 0.5) / n as f32);
            let xyz = [w.x, w.y, w.z].map(f64::from);
            squares = [0, 1, 2].map(|k| squares[k] + xyz[k] * xyz[k]);
            cap += usize::from(w.dot(Vec3::new(0.6, 0.48, 0.64)) > 0.9);
            slice += usize::from(fmath::atan2(w.y, w.x).abs() < 0.3);
        }
        let all = (n * n) as f64;
        for square in squares {
            assert!((square / all - 1.0 / 3.0).abs() < 1e-4);
        }
        assert!((cap as f64 / all - 0.05).abs() < 2e-4, "{}", cap as f64 / all);
        assert!((slice as f64 / all - 0.3 / std::f64::consts::PI).abs() < 5e-4);
    }

    /// A tree with a narrow peak, an empty quarter, and one that is even.
    fn forest() -> Vec<Node> {
        vec![
            Node { shares: [0.5, 0.2, 0.0, 0.3], children: [1, LEAF, LEAF, 3] },
            Node { shares: [0.01, 0.97, 0.01, 0.01], children: [LEAF, 2, LEAF, LEAF] },
            Node { shares: [0.1, 0.2, 0.3, 0.4], children: [LEAF; 4] },
            Node { shares: [0.25; 4], children: [LEAF; 4] },
        ]
    }

    #[test]
    fn densities_integrate_to_one() {
        let nodes = forest();
        let n = 512;
        let place = |i: usize| (Vec2::new((i % n) as f32, (i / n) as f32) + 0.5) / n as f32;
        let sum: f64 = (0..n * n).map(|i| f64::from(density(&nodes, 0, place(i)) / UNIFORM)).sum();
        assert!((sum / (n * n) as f64 - 1.0).abs() < 1e-6);
    }

    #[test]
    fn directions_are_drawn_with_their_density() {
        let nodes = forest();
        let (side, n) = (16, 400_000);
        let mut counts = vec![0.0; side * side];
        for i in 0..n {
            let (p, pdf) = sample(&nodes, 0, numbers(i));
            let expected = density(&nodes, 0, p);
            assert!((pdf / expected - 1.0).abs() < 1e-5, "{p}: {pdf} {expected}");
            let cell = (p * side as f32).as_uvec2();
            counts[cell.x as usize + side * cell.y as usize] += 1.0;
        }
        let expected: Vec<f64> = (0..side * side)
            .map(|i| {
                let p = (Vec2::new((i % side) as f32, (i / side) as f32) + 0.5) / side as f32;
                f64::from(density(&nodes, 0, p) / UNIFORM) * n as f64 / (side * side) as f64
            })
            .collect();
        let p = ChiSquare::test(&counts, &expected).p;
        assert!(p > 1e-3, "{p}");
    }
}
