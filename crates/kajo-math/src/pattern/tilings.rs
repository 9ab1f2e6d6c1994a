//! Tilings: bricks, hexagons, cells, checks, and the spots of a leopard.
//!
//! Bricks and hexagons are 1 within a tile and 0 in the joint around it, less by a share that is drawn for each tile; they lie in x and y
//! and are the same along z. What samples average over is an edge as wide as they are apart, so that joints thinner than that
//! grow pale and do not break up.

use super::hash;
use super::{Pattern, fract};
use crate::{Vec3, fmath};

/// What is left of a tile `inside` away from its joint, when samples are `width` apart.
fn covered(inside: f32, width: f32) -> f32 {
    if width > 0.0 {
        (inside / width + 0.5).clamp(0.0, 1.0)
    } else if inside >= 0.0 {
        1.0
    } else {
        0.0
    }
}

/// The variance of what is `tone` within a tile and 0 in its joint, over samples of which so many see the tile.
fn edge_variance(covered: f32, tone: f32) -> f32 {
    covered * (1.0 - covered) * tone * tone
}

/// Bricks of length 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Brick {
    /// Height of a course, with its joint.
    pub height: f32,
    /// Width of the joints.
    pub mortar: f32,
    /// By which part of its length each course is shifted against the one below.
    pub shift: f32,
    /// How much darker a brick may be than another.
    pub variation: f32,
    /// Chooses how dark each brick is.
    pub seed: u32,
}

impl Default for Brick {
    fn default() -> Brick {
        Brick { height: 0.375, mortar: 0.0625, shift: 0.5, variation: 0.0, seed: 0 }
    }
}

impl Pattern for Brick {
    fn is_finite(&self) -> bool {
        [self.height, self.mortar, self.shift, self.variation].iter().all(|v| v.is_finite())
    }

    fn at(&self, q: Vec3, width: f32) -> f32 {
        let (covered, tone) = self.covered(q, width);
        covered * tone
    }

    fn lost(&self, q: Vec3, width: f32, _variance: f32) -> f32 {
        let (covered, tone) = self.covered(q, width);
        edge_variance(covered, tone)
    }

    fn frequency(&self, _q: Vec3) -> f32 {
        1.0 / self.height.clamp(1e-6, 1.0)
    }
}

impl Brick {
    /// What is left of the brick around a point beside its joint, and how light it is.
    fn covered(&self, q: Vec3, width: f32) -> (f32, f32) {
        let course = (q.y / self.height).floor();
        let x = q.x + self.shift * course;
        let column = x.floor();
        let across = (x - column).min(column + 1.0 - x);
        let y = q.y - course * self.height;
        let up = y.min(self.height - y);
        let own = hash::uniform(hash::cell([column as i32, course as i32, 0], self.seed), 0);
        (covered(across.min(up) - 0.5 * self.mortar, width), 1.0 - self.variation * own)
    }
}

/// Regular hexagons, their centres one unit apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hexagons {
    /// Width of the joints.
    pub mortar: f32,
    /// How much darker a tile may be than another.
    pub variation: f32,
    /// Chooses how dark each tile is.
    pub seed: u32,
}

impl Default for Hexagons {
    fn default() -> Hexagons {
        Hexagons { mortar: 0.0625, variation: 0.0, seed: 0 }
    }
}

/// Distance between rows of hexagons.
const ROW: f32 = 0.866_025_4;

impl Hexagons {
    /// The tile around a point, and the distance to its edge.
    fn tile(x: f32, y: f32) -> ([i32; 2], f32) {
        // Centres are those of two lattices of rectangles of 1 by 2 ROW; the nearer one is the tile's.
        let [even, odd] = [0.0, 0.5].map(|half: f32| {
            let column = (x - half + 0.5).floor();
            let row = (y / (2.0 * ROW) - half + 0.5).floor();
            let d = [x - half - column, y - (row + half) * 2.0 * ROW];
            ([2 * column as i32 + i32::from(half > 0.0), 2 * row as i32 + i32::from(half > 0.0)], d)
        });
        let square = |[dx, dy]: [f32; 2]| dx * dx + dy * dy;
        let (cell, [dx, dy]) = if square(odd.1) < square(even.1) { odd } else { even };
        let (dx, dy) = (dx.abs(), dy.abs());
        (cell, 0.5 - dx.max(0.5 * dx + ROW * dy))
    }
}

impl Pattern for Hexagons {
    fn is_finite(&self) -> bool {
        self.mortar.is_finite() && self.variation.is_finite()
    }

    fn at(&self, q: Vec3, width: f32) -> f32 {
        let (covered, tone) = self.covered(q, width);
        covered * tone
    }

    fn lost(&self, q: Vec3, width: f32, _variance: f32) -> f32 {
        let (covered, tone) = self.covered(q, width);
        edge_variance(covered, tone)
    }

    fn frequency(&self, _q: Vec3) -> f32 {
        1.0
    }
}

impl Hexagons {
    /// What is left of the tile around a point beside its joint, and how light it is.
    fn covered(&self, q: Vec3, width: f32) -> (f32, f32) {
        let ([column, row], inside) = Hexagons::tile(q.x, q.y);
        let own = hash::uniform(hash::cell([column, row, 0], self.seed), 0);
        (covered(inside - 0.5 * self.mortar, width), 1.0 - self.variation * own)
    }
}

/// Cubes of edge 1, each with a number that is drawn for it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cells {
    /// Chooses the numbers.
    pub seed: u32,
}

impl Pattern for Cells {
    fn is_finite(&self) -> bool {
        true
    }

    fn at(&self, q: Vec3, _width: f32) -> f32 {
        hash::uniform(hash::cell(q.floor().to_array().map(|v| v as i32), self.seed), 0)
    }

    fn frequency(&self, _q: Vec3) -> f32 {
        1.0
    }
}

/// Cubes of edge 1 that are 0 and 1 by turns.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Checks;

impl Pattern for Checks {
    fn is_finite(&self) -> bool {
        true
    }

    /// The exclusive or of the shares that samples average over along each axis.
    fn at(&self, q: Vec3, width: f32) -> f32 {
        let signed = |v: f32| {
            let t = 0.5 * v;
            let t = fract(t);
            // Positive in the first half of the period, negative in the second: distance to the nearer edge.
            let d = 2.0 * (0.25 - (t - 0.25).abs());
            let d = if t >= 0.75 { 2.0 * (t - 1.0) } else { d };
            2.0 * covered(d, width) - 1.0
        };
        0.5 - 0.5 * signed(q.x) * signed(q.y) * signed(q.z)
    }

    fn lost(&self, q: Vec3, width: f32, _variance: f32) -> f32 {
        edge_variance(self.at(q, width), 1.0)
    }

    fn frequency(&self, _q: Vec3) -> f32 {
        0.5
    }
}

/// Spots: `((sin 2 pi x + sin 2 pi y + sin 2 pi z) / 3)^2`, after POV-Ray's pattern of that name.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Leopard;

impl Pattern for Leopard {
    fn is_finite(&self) -> bool {
        true
    }

    fn at(&self, q: Vec3, _width: f32) -> f32 {
        let wave = |v: f32| fmath::sin(std::f32::consts::TAU * fract(v));
        let mean = (wave(q.x) + wave(q.y) + wave(q.z)) / 3.0;
        mean * mean
    }

    fn frequency(&self, _q: Vec3) -> f32 {
        1.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pattern::{SolidPattern, spread};

    #[test]
    fn joints_take_the_share_that_they_have() {
        // (1 - m) (h - m) / h of bricks; of hexagons the square of what is left of the inradius.
        let brick = SolidPattern::new(Brick::default()).mean();
        assert!((brick - (1.0 - 0.0625) * (0.375 - 0.0625) / 0.375).abs() < 0.01, "{brick}");
        let hexagons = SolidPattern::new(Hexagons::default()).mean();
        assert!((hexagons - (1.0 - 0.0625f32).powi(2)).abs() < 0.01, "{hexagons}");
        let leopard = SolidPattern::new(Leopard).mean();
        assert!((leopard - 1.0 / 6.0).abs() < 0.006, "{leopard}");
    }

    #[test]
    fn hexagons_are_the_nearest_centres() {
        for i in 0..2000 {
            let q = 9.0 * spread(i);
            let (_, inside) = Hexagons::tile(q.x, q.y);
            // The edge is half way between the two nearest centres.
            let mut distances = Vec::new();
            for row in -14..=14i32 {
                for column in -12..=12 {
                    let centre = (column as f32 + 0.5 * (row & 1) as f32, row as f32 * ROW);
                    distances.push(((q.x - centre.0).powi(2) + (q.y - centre.1).powi(2)).sqrt());
                }
            }
            distances.sort_by(f32::total_cmp);
            let [a, b] = [distances[0], distances[1]];
            // Centres are one apart: the bisector of two is (b^2 - a^2) / 2 away.
            assert!((inside - 0.5 * (b * b - a * a)).abs() < 1e-4, "{q}: {inside}");
        }
    }

    #[test]
    fn checks_alternate_and_average_to_grey() {
        for i in 0..500 {
            let q = 12.0 * spread(i);
            let odd = q.floor().element_sum().rem_euclid(2.0);
            assert_eq!(Checks.at(q, 0.0), odd, "{q}");
        }
        // On an edge between two cells samples see half of each.
        assert_eq!(Checks.at(Vec3::new(1.0, 0.5, 0.5), 0.25), 0.5);
        assert_eq!(Checks.at(Vec3::new(0.9375, 0.5, 0.5), 0.25), 0.25);
    }
}
