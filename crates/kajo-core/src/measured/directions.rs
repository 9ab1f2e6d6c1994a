//! Directions of the upper hemisphere at which something is known, and interpolation between them.
//!
//! Directions are projected to the plane, where all of the hemisphere is the unit disk and circles stay circles:
//!
//! ```text
//! p = (x, y) / (1 + z)
//! ```
//!
//! Between the points of their Delaunay triangulation the value is the barycentric mean of three. Beyond their hull, which ends some
//! degrees above the horizon, it stays what it is at the edge: copies of the corners of the hull stand so far out that
//! the whole disk is covered. Functions that are affine in the plane are interpolated exactly within the hull.

use kajo_math::delaunay::Delaunay;
use kajo_math::{DVec2, Vec2, Vec3, fmath};

/// Cells of the grid that finds triangles, along each side.
const CELLS: usize = 32;

/// Barycentric coordinates below this are rounding: a direction of the set has the weight 1.
const LEAST_WEIGHT: f32 = 2e-6;

/// Most directions of a set.
pub const MAX_DIRECTIONS: usize = 8192;

/// Directions with a triangulation.
#[derive(Clone, Debug, PartialEq)]
pub struct DirectionSet {
    directions: Vec<Vec3>,
    triangles: Vec<Triangle>,
    /// Numbers of triangles that reach into each cell, cell by cell.
    found: Vec<u32>,
    /// Where those of each cell begin in `found`, and the end.
    begins: Vec<u32>,
}

/// A triangle of the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Triangle {
    /// Numbers of directions.
    corners: [u32; 3],
    /// The last two barycentric coordinates of `p` are `row · (p, 1)`.
    rows: [Vec3; 2],
}

/// Why directions cannot be interpolated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DirectionError {
    /// There are none, or too many.
    #[error("{0} directions, of which there have to be between 1 and {MAX_DIRECTIONS}")]
    Count(usize),
    /// One is not above the surface.
    #[error(
        "direction {0} has an angle to the normal of {1} degrees, which has to be at least 0 and at most 90"
    )]
    Below(usize, f32),
    /// Two are the same.
    #[error("directions {0} and {1} are the same")]
    Same(usize, usize),
    /// There is no area between them.
    #[error("the directions lie on a line, and nothing can be said beside it")]
    Line,
}

/// The unit vector with the angle `theta` to the normal, and `phi` from x towards y; radians.
pub fn direction([theta, phi]: [f32; 2]) -> Vec3 {
    let ((sin, cos), (y, x)) = (fmath::sin_cos(theta), fmath::sin_cos(phi));
    Vec3::new(sin * x, sin * y, cos.max(0.0))
}

fn projected(w: Vec3) -> Vec2 {
    w.truncate() / (1.0 + w.z.max(0.0))
}

impl DirectionSet {
    /// The set of directions with these angles: to the normal, and from x towards y; radians. One alone stands for all.
    ///
    /// # Errors
    /// [`DirectionError`].
    pub fn new(angles: &[[f32; 2]]) -> Result<DirectionSet, DirectionError> {
        if angles.is_empty() || angles.len() > MAX_DIRECTIONS {
            return Err(DirectionError::Count(angles.len()));
        }
        for (i, &[theta, phi]) in angles.iter().enumerate() {
            if !((0.0..=1.570_797).contains(&theta) && phi.is_finite()) {
                return Err(DirectionError::Below(i, theta.to_degrees()));
            }
        }
        let directions: Vec<Vec3> = angles.iter().map(|&angles| direction(angles)).collect();
        let points: Vec<DVec2> = directions.iter().map(|&w| projected(w).as_dvec2()).collect();
        if points.len() == 1 {
            return Ok(DirectionSet {
                directions,
                triangles: Vec::new(),
                found: Vec::new(),
                begins: Vec::new(),
            });
        }
        check_distinct(&points)?;
        let delaunay = Delaunay::new(&points).ok_or(DirectionError::Line)?;
        let triangles = covering(&points, &delaunay);
        let (found, begins) = grid(&triangles);
        let triangles = triangles.iter().map(|(corners, points)| Triangle::new(*corners, *points)).collect();
        Ok(DirectionSet { directions, triangles, found, begins })
    }

    /// The directions, unit vectors.
    pub fn directions(&self) -> &[Vec3] {
        &self.directions
    }

    /// The three directions around a unit vector above the surface with their weights, which are at least 0 and add up to 1.
    #[inline]
    pub fn weights(&self, w: Vec3) -> [(u32, f32); 3] {
        if self.triangles.is_empty() {
            return [(0, 1.0), (0, 0.0), (0, 0.0)];
        }
        let p = projected(w);
        let cell = cell_of(p.x) + CELLS * cell_of(p.y);
        let here = &self.found[self.begins[cell] as usize..self.begins[cell + 1] as usize];
        // Rounding may leave a point outside of all: then the nearest one is taken.
        let (mut best, mut least) = ([(0, 1.0), (0, 0.0), (0, 0.0)], f32::NEG_INFINITY);
        for &t in here {
            let Triangle { corners, rows } = &self.triangles[t as usize];
            let [b, c] = rows.map(|row| row.dot(p.extend(1.0)));
            let a = 1.0 - b - c;
            let inside = a.min(b).min(c);
            if inside > least {
                least = inside;
                best = [(corners[0], a), (corners[1], b), (corners[2], c)];
            }
            if inside >= 0.0 {
                break;
            }
        }
        let held = best.map(|(i, weight)| (i, if weight < LEAST_WEIGHT { 0.0 } else { weight }));
        let scale = 1.0 / (held[0].1 + held[1].1 + held[2].1);
        held.map(|(i, weight)| (i, weight * scale))
    }
}

impl Triangle {
    fn new(corners: [u32; 3], [a, b, c]: [DVec2; 3]) -> Triangle {
        let (ab, ac) = (b - a, c - a);
        let area = ab.perp_dot(ac);
        // Coordinates of b and c by Cramer's rule.
        let row = |x: f64, y: f64| {
            Vec3::new((x / area) as f32, (y / area) as f32, (-(x * a.x + y * a.y) / area) as f32)
        };
        Triangle { corners, rows: [row(ac.y, -ac.x), row(-ab.y, ab.x)] }
    }
}

fn check_distinct(points: &[DVec2]) -> Result<(), DirectionError> {
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|&i, &j| points[i].x.total_cmp(&points[j].x).then(points[i].y.total_cmp(&points[j].y)));
    for (n, &i) in order.iter().enumerate() {
        let near = order[n + 1..].iter().take_while(|&&j| points[j].x - points[i].x < 1e-5);
        if let Some(&j) = near.clone().find(|&&j| points[j].distance(points[i]) < 1e-5) {
            return Err(DirectionError::Same(i.min(j), i.max(j)));
        }
    }
    Ok(())
}

/// Triangles that cover the unit disk, with their corners.
fn covering(points: &[DVec2], delaunay: &Delaunay) -> Vec<([u32; 3], [DVec2; 3])> {
    let at = |i: u32| points[i as usize];
    let mut all: Vec<_> = delaunay.triangles.iter().map(|&corners| (corners, corners.map(at))).collect();
    let hull = &delaunay.hull;
    let middle = hull.iter().map(|&i| at(i)).sum::<DVec2>() / hull.len() as f64;
    let edges = || (0..hull.len()).map(|i| (hull[i], hull[(i + 1) % hull.len()]));
    // How far out each edge has to go to pass beside the disk.
    let needed = edges().map(|(a, b)| {
        let out = -(at(b) - at(a)).perp().normalize();
        (1.01 - middle.dot(out)) / (at(a) - middle).dot(out).max(1e-6)
    });
    let scale = needed.fold(1.01, f64::max);
    for (a, b) in edges() {
        let [out_a, out_b] = [a, b].map(|i| middle + scale * (at(i) - middle));
        all.push(([a, b, b], [at(a), out_b, at(b)]));
        all.push(([a, a, b], [at(a), out_a, out_b]));
    }
    all
}

/// Column or row of the grid over `[-1, 1]²`.
fn cell_of(x: f32) -> usize {
    ((0.5 * x + 0.5) * CELLS as f32).clamp(0.0, CELLS as f32 - 1.0) as usize
}

/// For each cell those triangles whose boxes reach into it.
fn grid(triangles: &[([u32; 3], [DVec2; 3])]) -> (Vec<u32>, Vec<u32>) {
    let mut cells = vec![Vec::new(); CELLS * CELLS];
    for (t, (_, [a, b, c])) in triangles.iter().enumerate() {
        let (low, high) = (a.min(*b).min(*c) - 1e-5, a.max(*b).max(*c) + 1e-5);
        if high.x < -1.01 || high.y < -1.01 || low.x > 1.01 || low.y > 1.01 {
            continue;
        }
        for y in cell_of(low.y as f32)..=cell_of(high.y as f32) {
            for x in cell_of(low.x as f32)..=cell_of(high.x as f32) {
                cells[x + CELLS * y].push(t as u32);
            }
        }
    }
    let mut begins = vec![0];
    let mut found = Vec::new();
    for cell in cells {
        found.extend(cell);
        begins.push(found.len() as u32);
    }
    (found, begins)
}

#[cfg(test)]
mod tests {
    use kajo_math::{rng::Stream, warp};

    use super::*;

    /// Rings of directions, as measurements have them.
    pub fn rings() -> Vec<[f32; 2]> {
        let ring = |k: u32| {
            (0..6 * k).map(move |i| {
                [15f32.to_radians() * k as f32, std::f32::consts::TAU * i as f32 / (6 * k) as f32]
            })
        };
        [[0.0; 2]].into_iter().chain((1..=5).flat_map(ring)).collect()
    }

    #[test]
    fn a_direction_of_the_set_stands_for_itself() {
        let set = DirectionSet::new(&rings()).unwrap();
        for (i, &w) in set.directions().iter().enumerate() {
            let weights = set.weights(w);
            assert!(weights.iter().any(|&(j, weight)| j as usize == i && weight == 1.0), "{i}: {weights:?}");
        }
    }

    #[test]
    fn affine_functions_of_the_plane_are_exact_within_the_hull_and_held_beyond() {
        let set = DirectionSet::new(&rings()).unwrap();
        let f = |p: Vec2| 0.3 + 0.5 * p.x - 0.2 * p.y;
        for i in 0..5000 {
            let s = Stream::new(2, [i, 0], 0);
            let w = warp::uniform_hemisphere(Vec2::new(s.uniform(0), s.uniform(1)));
            let weights = set.weights(w);
            let sum: f32 = weights.iter().map(|w| w.1).sum();
            assert!((sum - 1.0).abs() < 1e-6 && weights.iter().all(|w| w.1 >= 0.0), "{w}: {weights:?}");
            let mean: f32 =
                weights.iter().map(|&(i, weight)| weight * f(projected(set.directions()[i as usize]))).sum();
            let p = projected(w);
            if w.z > 72f32.to_radians().cos() {
                assert!((mean - f(p)).abs() < 3e-6, "{w}: {mean} {}", f(p));
            } else if w.z < 75f32.to_radians().cos() {
                let edge = p * ((37.5f32).to_radians().tan() / p.length());
                assert!((mean - f(edge)).abs() < 0.01, "{w}: {mean} {}", f(edge));
            }
        }
    }

    #[test]
    fn directions_on_one_side_cover_the_hemisphere_too() {
        let set = DirectionSet::new(&[[0.9, 0.0], [1.2, 0.3], [1.0, 0.8], [0.7, 0.4]]).unwrap();
        for i in 0..1000 {
            let s = Stream::new(4, [i, 0], 0);
            let w = warp::uniform_hemisphere(Vec2::new(s.uniform(0), s.uniform(1)));
            let sum: f32 = set.weights(w).iter().map(|w| w.1).sum();
            assert!((sum - 1.0).abs() < 1e-5, "{w}");
        }
        let alone = DirectionSet::new(&[[0.4, 1.0]]).unwrap();
        assert_eq!(alone.weights(Vec3::X)[0], (0, 1.0));
    }

    #[test]
    fn what_cannot_be_interpolated_is_said() {
        let error = |angles: &[[f32; 2]]| DirectionSet::new(angles).unwrap_err();
        assert_eq!(error(&[]), DirectionError::Count(0));
        assert_eq!(error(&[[0.0; 2], [2.0, 0.0]]), DirectionError::Below(1, 2f32.to_degrees()));
        assert!(matches!(error(&[[f32::NAN, 0.0]]), DirectionError::Below(0, _)));
        assert_eq!(error(&[[0.0; 2], [0.5, 0.0], [0.0, 1.0]]), DirectionError::Same(0, 2));
        assert_eq!(error(&[[0.0; 2], [0.5, 0.0], [0.7, 0.0]]), DirectionError::Line);
    }
}
