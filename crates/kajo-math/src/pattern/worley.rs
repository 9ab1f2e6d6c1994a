//! Cellular texture: distances to the nearest of points strewn over space [Worley 1996].
//!
//! The points are a Poisson process of one point per unit of volume, so that the distances `F1`, `F2` to the nearest and the second
//! nearest have `P(F1 > r) = exp(-v)`, `P(F2 > r) = (1 + v) exp(-v)`, where `v` is the volume of the ball of radius `r`, and
//!
//! ```text
//! E F1 = Gamma(4/3) (3 / 4 pi)^(1/3) = 0.553960        E F2 = 4/3 E F1 = 0.738614
//! ```
//!
//! in every metric, since distances are measured in units in which the unit balls of all have the same volume. A lattice whose cells hold
//! four points each on average is searched in rings around the point, until no cell that is left can hold a nearer one: unlike the 3³
//! cells that are often looked at this misses none.

use super::{Pattern, hash};
use crate::Vec3;

/// How distances are measured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Metric {
    /// Root of the sum of squares: cells with straight walls.
    #[default]
    Euclidean,
    /// Sum of the absolute differences: cells like facets of crystals.
    Manhattan,
    /// The largest difference: cells like blocks.
    Chebyshev,
}

impl Metric {
    /// The distance of a difference, in units in which the unit ball has the volume of Euclid's.
    #[inline]
    fn distance(self, d: Vec3) -> f32 {
        match self {
            Metric::Euclidean => d.length(),
            // The third root of the octahedron's 4/3 by 4 pi / 3.
            Metric::Manhattan => 0.682_784_1 * d.abs().element_sum(),
            // That of the cube's 8 by 4 pi / 3.
            Metric::Chebyshev => 1.240_700_9 * d.abs().max_element(),
        }
    }
}

/// What the distances make.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum WorleyValue {
    /// `F1`: 0 at the points.
    #[default]
    Nearest,
    /// `F2`.
    Second,
    /// `F2 - F1`: 0 on the walls between cells, as cracks are.
    Crackle,
    /// A number drawn for each point, the same in all of its cell.
    Cell,
}

/// Cellular texture.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Worley {
    /// How distances are measured.
    pub metric: Metric,
    /// What they make.
    pub value: WorleyValue,
    /// Chooses one of many sets of points.
    pub seed: u32,
}

/// Edge of a cell of the lattice, which holds four points on average.
const EDGE: f32 = 1.587_401;

/// Rings of cells that are looked at: the chance of a point that has not two others within them is less than 1e-50.
const RINGS: i32 = 3;

/// `F1`, `F2`, and the hash of the nearest point.
///
/// * `q`: finite
pub fn nearest_two(q: Vec3, metric: Metric, seed: u32) -> ([f32; 2], u32) {
    let q = q / EDGE;
    let home = q.floor();
    let f = q - home;
    let home = home.to_array().map(|v| v as i32);
    let mut found = Found { distances: [f32::MAX; 2], point: 0 };
    // The distance to the nearest wall of the home cell, in the least of the metrics along an axis.
    let to_wall = f.min(1.0 - f).min_element();
    for ring in 0..=RINGS {
        let clear = metric.distance(Vec3::X) * (to_wall + (ring - 1) as f32);
        if ring > 0 && clear > found.distances[1] {
            break;
        }
        for x in -ring..=ring {
            for y in -ring..=ring {
                // Of inner columns the two ends alone are in the ring.
                let is_side = x.abs() == ring || y.abs() == ring;
                let step = if is_side { 1 } else { (2 * ring).max(1) };
                for z in (-ring..=ring).step_by(step as usize) {
                    found.look_into([x, y, z], home, f, metric, seed);
                }
            }
        }
    }
    (found.distances.map(|d| d * EDGE), found.point)
}

/// The nearest points so far.
struct Found {
    distances: [f32; 2],
    point: u32,
}

impl Found {
    /// Looks at the points of a cell, unless all of it is farther away than what was found.
    fn look_into(&mut self, [x, y, z]: [i32; 3], home: [i32; 3], f: Vec3, metric: Metric, seed: u32) {
        let corner = Vec3::new(x as f32, y as f32, z as f32);
        let outside = (corner - f).max(f - corner - 1.0).max(Vec3::ZERO);
        if metric.distance(outside) >= self.distances[1] {
            return;
        }
        let cell =
            hash::cell([home[0].wrapping_add(x), home[1].wrapping_add(y), home[2].wrapping_add(z)], seed);
        for i in 0..count(cell) {
            let u = |k: u32| hash::uniform(cell, 3 * i + k);
            let d = metric.distance(corner + Vec3::new(u(1), u(2), u(3)) - f);
            let [first, second] = self.distances;
            if d < first {
                (self.distances, self.point) = ([d, first], hash::with(cell, i as i32));
            } else if d < second {
                self.distances[1] = d;
            }
        }
    }
}

/// How many points a cell has: Poisson with mean 4.
pub(super) fn count(cell: u32) -> u32 {
    /// 2^32 times the chance of at most so many.
    const UP_TO: [u32; 18] = [
        78_665_070,
        393_325_350,
        1_022_645_910,
        1_861_739_991,
        2_700_834_071,
        3_372_109_335,
        3_819_626_178,
        4_075_350_088,
        4_203_212_044,
        4_260_039_579,
        4_282_770_593,
        4_291_036_417,
        4_293_791_691,
        4_294_639_468,
        4_294_881_690,
        4_294_946_282,
        4_294_962_431,
        4_294_966_230,
    ];
    let u = hash::spread_bits(cell ^ 0x5851_F42D);
    UP_TO.iter().map(|&up_to| u32::from(u >= up_to)).sum()
}

impl Pattern for Worley {
    fn is_finite(&self) -> bool {
        true
    }

    fn at(&self, q: Vec3, _width: f32) -> f32 {
        let ([first, second], point) = nearest_two(q, self.metric, self.seed);
        // What is cut off beyond these happens in fewer than one place in a thousand.
        match self.value {
            WorleyValue::Nearest => first / 1.2,
            WorleyValue::Second => second / 1.4,
            WorleyValue::Crackle => (second - first) / 0.9,
            WorleyValue::Cell => hash::uniform(point, 0),
        }
    }

    fn frequency(&self, _q: Vec3) -> f32 {
        1.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pattern::spread;

    const METRICS: [Metric; 3] = [Metric::Euclidean, Metric::Manhattan, Metric::Chebyshev];

    /// The two nearest points by looking at all cells around.
    fn by_force(q: Vec3, metric: Metric, seed: u32) -> [f32; 2] {
        let q = q / EDGE;
        let home = q.floor();
        let (f, mut distances) = (q - home, [f32::MAX; 2]);
        for x in -4..=4 {
            for y in -4..=4 {
                for z in -4..=4 {
                    let offset = Vec3::new(x as f32, y as f32, z as f32);
                    let cell = hash::cell([home.x as i32 + x, home.y as i32 + y, home.z as i32 + z], seed);
                    for i in 0..count(cell) {
                        let u = |k: u32| hash::uniform(cell, 3 * i + k);
                        let d = metric.distance(offset + Vec3::new(u(1), u(2), u(3)) - f);
                        distances = match distances {
                            [first, _] if d < first => [d, first],
                            [first, second] => [first, second.min(d)],
                        };
                    }
                }
            }
        }
        distances.map(|d| d * EDGE)
    }

    #[test]
    fn no_point_is_missed() {
        for metric in METRICS {
            for i in 0..3000 {
                let q = 200.0 * spread(i);
                assert_eq!(nearest_two(q, metric, 4).0, by_force(q, metric, 4), "{metric:?} {q}");
            }
        }
    }

    #[test]
    fn distances_have_their_expectations() {
        // 10^6 points in all; standard errors of the means are below 0.0004.
        for metric in METRICS {
            let n = 333_334u32;
            let (mut first, mut second, mut beyond) = (0.0f64, 0.0f64, 0u32);
            for i in 0..n {
                let ([f1, f2], _) = nearest_two(5000.0 * spread(i), metric, 11);
                first += f64::from(f1);
                second += f64::from(f2);
                beyond += u32::from(f2 > 1.0);
            }
            let n = f64::from(n);
            assert!((first / n - 0.553_960).abs() < 0.0015, "{metric:?}: {}", first / n);
            assert!((second / n - 0.738_614).abs() < 0.0015, "{metric:?}: {}", second / n);
            // (1 + v) exp(-v) of the unit ball.
            let v = 4.188_790_2f64;
            let share = (1.0 + v) * crate::fmath::exp64(-v);
            assert!((f64::from(beyond) / n - share).abs() < 0.002, "{metric:?}: {}", f64::from(beyond) / n);
        }
    }

    #[test]
    fn cells_hold_four_points_on_average() {
        let n = 100_000;
        let counts = (0..n).map(|i| f64::from(count(hash::cell([i, 2, -i], 0))));
        let (sum, squares) = counts.fold((0.0, 0.0), |(s, q), c| (s + c, q + c * c));
        let mean = sum / f64::from(n);
        let variance = squares / f64::from(n) - mean * mean;
        assert!((mean - 4.0).abs() < 0.03 && (variance - 4.0).abs() < 0.09, "{mean} {variance}");
    }
}
