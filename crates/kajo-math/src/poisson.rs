//! Maximal Poisson-disk point sets on the unit torus.
//!
//! No two points are nearer than `r`, and there is no room for another: the outcome of throwing darts at random for
//! ever and keeping those that hit no disk. Such sets cover `N pi r^2 / 4 = 0.5470` of the square with disks of radius
//! `r/2` [Torquato, Uche and Stillinger 2006], so that
//!
//! ```text
//! N = 0.6965 / r^2
//! ```
//!
//! Darts are thrown at a list of square cells that may still have room. After each round the cells are cut in
//! four and the quarters inside a single disk are dropped, until none is left [Ebeida et al. 2012]. All cells of a round
//! are equally large, so a dart that is kept is uniform over the room there is.

use crate::{DVec2, rng::Stream};

/// Points times squared distance of a large maximal set.
const SATURATION: f64 = 4.0 / std::f64::consts::PI * 0.5470;

/// Darts of a round for each cell of the list [Ebeida et al. 2012, section 3.3].
const DARTS_PER_CELL: f64 = 0.3;

/// Rounds after which cells are smaller than the spacing of numbers near 1, and what is left is nothing.
const ROUNDS: u32 = 40;

/// The least distance that is served; the work grows like its inverse square.
const LEAST_DISTANCE: f64 = 1e-3;

/// Sets tried for one with the number of points asked for.
const ATTEMPTS: u64 = 256;

/// A maximal set of points of [0, 1)² that are at least `r` apart, where the square's opposite edges are one.
///
/// * `r`: from 0.001 to 1; what is outside counts as the nearer end
pub fn maximal(r: f64, seed: u64) -> Vec<DVec2> {
    Darts::new(r.clamp(LEAST_DISTANCE, 1.0), seed).throw()
}

/// A maximal set of `n` points, or one of slightly more points cut to `n` where luck fails.
pub fn exactly(n: usize, seed: u64) -> Vec<DVec2> {
    let r = (SATURATION / n.max(1) as f64).sqrt();
    let mut larger: Option<Vec<DVec2>> = None;
    for attempt in 0..ATTEMPTS {
        let set = maximal(r, seed.wrapping_add(attempt));
        if set.len() == n {
            return set;
        }
        let best = larger.as_ref().map_or(usize::MAX, Vec::len);
        if (n..best).contains(&set.len()) {
            larger = Some(set);
        }
    }
    let mut set = larger.unwrap_or_else(|| maximal(0.9 * r, seed));
    set.truncate(n);
    set
}

/// From `b` to `a` by the shortest way around the torus.
#[inline]
pub fn torus_difference(a: DVec2, b: DVec2) -> DVec2 {
    let d = a - b;
    d - d.round()
}

/// The points so far, in a grid whose cells have room for one each.
struct Darts {
    r: f64,
    /// Cells of the grid on a side; their diagonal is at most `r`.
    side: u32,
    /// Cells around one that a disk around a point of it may reach.
    reach: i32,
    grid: Vec<Option<DVec2>>,
    stream: Stream,
    drawn: u32,
}

impl Darts {
    fn new(r: f64, seed: u64) -> Darts {
        let side = (std::f64::consts::SQRT_2 / r).ceil() as u32;
        let reach = (r * f64::from(side)).ceil() as i32;
        let grid = vec![None; (side * side) as usize];
        Darts { r, side, reach, grid, stream: Stream::new(seed, [0, 0], 0), drawn: 0 }
    }

    fn throw(mut self) -> Vec<DVec2> {
        let mut points = Vec::new();
        let mut cells: Vec<[u64; 2]> =
            (0..self.side).flat_map(|y| (0..self.side).map(move |x| [x.into(), y.into()])).collect();
        for round in 0..ROUNDS {
            if cells.is_empty() {
                break;
            }
            let size = 1.0 / (f64::from(self.side) * (1u64 << round) as f64);
            for _ in 0..(DARTS_PER_CELL * cells.len() as f64).ceil() as usize {
                if cells.is_empty() {
                    break;
                }
                let chosen = (self.uniform() * cells.len() as f64) as usize;
                let [x, y] = cells[chosen].map(|c| c as f64);
                let dart = DVec2::new(x + self.uniform(), y + self.uniform()) * size;
                if self.is_free(dart) {
                    let cell = self.cell(dart);
                    self.grid[cell] = Some(dart);
                    points.push(dart);
                    cells.swap_remove(chosen);
                }
            }
            let quarters = cells
                .iter()
                .flat_map(|&[x, y]| [[0, 0], [1, 0], [0, 1], [1, 1]].map(|[i, j]| [2 * x + i, 2 * y + j]));
            cells = quarters.filter(|&cell| !self.is_covered(cell, 0.5 * size)).collect();
        }
        points
    }

    /// Uniform in [0, 1).
    fn uniform(&mut self) -> f64 {
        self.drawn += 1;
        f64::from(self.stream.uniform(self.drawn))
    }

    /// The place in the grid of a point of [0, 1)².
    fn cell(&self, p: DVec2) -> usize {
        let [x, y] = (p * f64::from(self.side)).to_array().map(|c| (c as u32).min(self.side - 1));
        (y * self.side + x) as usize
    }

    /// The points whose disks may reach `p`.
    fn near(&self, p: DVec2) -> impl Iterator<Item = DVec2> + '_ {
        let cell = self.cell(p) as i64;
        let side = i64::from(self.side);
        let around = -i64::from(self.reach)..=i64::from(self.reach);
        around.clone().flat_map(move |dy| {
            let row = (cell / side + dy).rem_euclid(side) * side;
            around
                .clone()
                .filter_map(move |dx| self.grid[(row + (cell % side + dx).rem_euclid(side)) as usize])
        })
    }

    fn is_free(&self, p: DVec2) -> bool {
        self.near(p).all(|q| torus_difference(p, q).length_squared() >= self.r * self.r)
    }

    /// Whether one disk covers the whole of a cell of this size.
    fn is_covered(&self, [x, y]: [u64; 2], size: f64) -> bool {
        let middle = (DVec2::new(x as f64, y as f64) + 0.5) * size;
        self.near(middle).any(|q| {
            let farthest = torus_difference(middle, q).abs() + 0.5 * size;
            farthest.length_squared() <= self.r * self.r
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The least distance of two points, by looking at all pairs.
    fn least_distance(points: &[DVec2]) -> f64 {
        let pairs = points.iter().enumerate().flat_map(|(i, &a)| points[..i].iter().map(move |&b| (a, b)));
        pairs.map(|(a, b)| torus_difference(a, b).length()).fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn points_keep_their_distance_and_leave_no_room() {
        for (r, seed) in [(0.4, 1), (0.2, 2), (0.07, 3), (0.031, 4)] {
            let points = maximal(r, seed);
            assert!(points.iter().all(|p| p.cmpge(DVec2::ZERO).all() && p.cmplt(DVec2::ONE).all()));
            assert!(least_distance(&points) >= r, "r = {r}");
            // Witnesses on a grid, and points around each disk where gaps would open.
            let n = 300;
            let mut witnesses: Vec<DVec2> = (0..n * n)
                .map(|i| DVec2::new((i % n) as f64 + 0.5, (i / n) as f64 + 0.5) / n as f64)
                .collect();
            for &p in &points {
                let angles = (0..64).map(|i| f64::from(i) * std::f64::consts::TAU / 64.0);
                witnesses.extend(angles.map(|a| p + 1.000_01 * r * DVec2::new(a.cos(), a.sin())));
            }
            for w in witnesses {
                let nearest = points.iter().map(|&p| torus_difference(w, p).length());
                assert!(nearest.fold(f64::INFINITY, f64::min) < r * (1.0 + 1e-9), "r = {r}: room at {w}");
            }
        }
    }

    /// The density at saturation [Torquato, Uche and Stillinger 2006]: a process that is not random sequential
    /// addition would miss it.
    #[test]
    fn sets_are_as_dense_as_random_sequential_addition() {
        let r = 0.008;
        let sets = 4;
        let points: usize = (0..sets).map(|seed| maximal(r, seed).len()).sum();
        let density = points as f64 / sets as f64 * r * r;
        assert!((density / 0.6965 - 1.0).abs() < 0.01, "{density}");
    }

    #[test]
    fn sets_of_a_given_size_are_maximal() {
        for n in (1..=40).chain([64, 100, 255, 1024]) {
            let set = exactly(n, 7);
            assert_eq!(set.len(), n);
            let r = (SATURATION / n as f64).sqrt();
            let whole = (0..ATTEMPTS).any(|attempt| maximal(r, 7 + attempt) == set);
            assert!(whole, "{n} points were not met by luck");
        }
        assert!(exactly(0, 7).is_empty());
    }

    #[test]
    fn absurd_distances_end() {
        assert_eq!(maximal(5.0, 0).len(), 1);
        assert_eq!(maximal(f64::INFINITY, 0).len(), 1);
        assert_eq!(maximal(0.75, 3).len(), 1, "larger than half the diagonal of the square");
    }
}
