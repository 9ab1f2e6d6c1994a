//! Delaunay triangulation of points of the plane: no point lies inside the circle around any triangle.
//!
//! Points are added from left to right, each joined with the edges of the hull that it sees, so that none ever falls into a
//! triangle; then edges are flipped until all circles are empty [Lawson 1977]. Of points on one circle, such as those of a
//! regular grid, any triangulation will do: an edge is flipped only where a point is inside by more than rounding.

use std::collections::HashMap;

use crate::DVec2;

/// Less than this is rounding, for points of magnitude about 1.
const EPSILON: f64 = 1e-12;

/// A triangulation, whose corners are numbers of points.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Delaunay {
    /// Corners, counterclockwise.
    pub triangles: Vec<[u32; 3]>,
    /// The convex hull, counterclockwise.
    pub hull: Vec<u32>,
}

/// Twice the signed area of a triangle, positive when it is counterclockwise.
fn orient(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    (b - a).perp_dot(c - a)
}

/// Positive when `d` is inside the circle around the counterclockwise triangle `a b c`.
fn in_circle(a: DVec2, b: DVec2, c: DVec2, d: DVec2) -> f64 {
    let [a, b, c] = [a - d, b - d, c - d];
    let lifted = |p: DVec2, q: DVec2, r: DVec2| p.length_squared() * q.perp_dot(r);
    lifted(a, b, c) + lifted(b, c, a) + lifted(c, a, b)
}

impl Delaunay {
    /// The triangulation of points of magnitude about 1; `None` where there is none, as all are on a line or two are in one
    /// place.
    pub fn new(points: &[DVec2]) -> Option<Delaunay> {
        if points.len() < 3 || !points.iter().all(|p| p.is_finite()) {
            return None;
        }
        let mut order: Vec<u32> = (0..u32::try_from(points.len()).ok()?).collect();
        let at = |i: u32| points[i as usize];
        order.sort_by(|&i, &j| at(i).x.total_cmp(&at(j).x).then(at(i).y.total_cmp(&at(j).y)));
        if order.windows(2).any(|pair| at(pair[0]).distance_squared(at(pair[1])) < EPSILON) {
            return None;
        }
        let mut swept = Delaunay::started(points, &order)?;
        let begun = swept.hull.len();
        for &p in &order[begun..] {
            swept.join(points, p)?;
        }
        swept.flip(points);
        Some(swept)
    }

    /// The first points on a line, and the first one beside it.
    fn started(points: &[DVec2], order: &[u32]) -> Option<Delaunay> {
        let at = |i: u32| points[i as usize];
        let (first, second) = (at(order[0]), at(order[1]));
        let beside = order[2..].iter().position(|&p| orient(first, second, at(p)).abs() > EPSILON)? + 2;
        let (mut line, apex) = (order[..beside].to_vec(), order[beside]);
        if orient(first, second, at(apex)) < 0.0 {
            line.reverse();
        }
        let triangles = line.windows(2).map(|pair| [pair[0], pair[1], apex]).collect();
        line.push(apex);
        Some(Delaunay { triangles, hull: line })
    }

    /// Joins a point to the right of all others with what it sees of the hull.
    fn join(&mut self, points: &[DVec2], p: u32) -> Option<()> {
        let at = |i: u32| points[i as usize];
        let n = self.hull.len();
        let sees = |i: usize| orient(at(self.hull[i % n]), at(self.hull[(i + 1) % n]), at(p)) < -EPSILON;
        // The first edge that it sees after one that it does not.
        let first = (0..n).find(|&i| sees(i) && !sees(i + n - 1))?;
        let seen = (first..first + n).take_while(|&i| sees(i)).count();
        for i in first..first + seen {
            self.triangles.push([self.hull[(i + 1) % n], self.hull[i % n], p]);
        }
        // From where it stops seeing around to where it starts.
        let kept = (first + seen..=first + n).map(|i| self.hull[i % n]);
        self.hull = kept.chain([p]).collect();
        Some(())
    }

    fn flip(&mut self, points: &[DVec2]) {
        let at = |i: u32| points[i as usize];
        let mut owner = HashMap::new();
        let mut stack = Vec::new();
        for (t, &[a, b, c]) in self.triangles.iter().enumerate() {
            for edge in [(a, b), (b, c), (c, a)] {
                owner.insert(edge, t);
                stack.push(edge);
            }
        }
        while let Some((a, b)) = stack.pop() {
            let (Some(&t), Some(&s)) = (owner.get(&(a, b)), owner.get(&(b, a))) else { continue };
            let beyond = |t: usize| self.triangles[t].into_iter().find(|&v| v != a && v != b);
            let (Some(c), Some(d)) = (beyond(t), beyond(s)) else { continue };
            if in_circle(at(a), at(b), at(c), at(d)) <= EPSILON {
                continue;
            }
            owner.remove(&(a, b));
            owner.remove(&(b, a));
            self.triangles[t] = [a, d, c];
            self.triangles[s] = [d, b, c];
            for (edge, t) in [((a, d), t), ((d, c), t), ((c, a), t), ((d, b), s), ((b, c), s), ((c, d), s)] {
                owner.insert(edge, t);
            }
            stack.extend([(a, d), (d, b), (b, c), (c, a)]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Stream;

    fn check(points: &[DVec2]) -> Delaunay {
        let found = Delaunay::new(points).unwrap();
        let at = |i: u32| points[i as usize];
        let area = |v: &[u32; 3]| orient(at(v[0]), at(v[1]), at(v[2]));
        let hull: f64 =
            (1..found.hull.len() - 1).map(|i| area(&[found.hull[0], found.hull[i], found.hull[i + 1]])).sum();
        let sum: f64 = found.triangles.iter().map(area).sum();
        assert!((sum - hull).abs() < 1e-9, "{sum} of {hull}");
        // Euler's formula.
        assert_eq!(found.triangles.len(), 2 * points.len() - 2 - found.hull.len());
        for t in &found.triangles {
            assert!(area(t) > 0.0, "{t:?}");
            let inside = |&&p: &&DVec2| in_circle(at(t[0]), at(t[1]), at(t[2]), p) > 1e-9;
            assert_eq!(points.iter().find(inside), None);
        }
        found
    }

    #[test]
    fn circles_are_empty_and_the_hull_is_filled() {
        for n in [3, 4, 5, 10, 100, 400] {
            let random = |i: u32| {
                let s = Stream::new(3, [i, n], 0);
                DVec2::new(f64::from(s.uniform(0)), f64::from(s.uniform(1)))
            };
            check(&(0..n).map(random).collect::<Vec<_>>());
        }
    }

    #[test]
    fn points_on_circles_and_lines_are_joined_too() {
        let rings = |n: u32, k: u32| {
            let ring = move |r: u32| {
                (0..n).map(move |i| {
                    let angle = f64::from(i) / f64::from(n) * std::f64::consts::TAU;
                    0.15 * f64::from(r) * DVec2::new(libm::cos(angle), libm::sin(angle))
                })
            };
            [DVec2::ZERO].into_iter().chain((1..=k).flat_map(ring)).collect::<Vec<_>>()
        };
        let found = check(&rings(6, 1));
        assert_eq!((found.triangles.len(), found.hull.len()), (6, 6));
        check(&rings(12, 5));
        check(&rings(24, 3));
        let grid: Vec<_> = (0..64).map(|i| DVec2::new(f64::from(i % 8), f64::from(i / 8)) / 8.0).collect();
        assert_eq!(Delaunay::new(&grid).unwrap().triangles.len(), 98);
    }

    #[test]
    fn what_has_no_area_has_no_triangles() {
        let line: Vec<_> = (0..5).map(|i| DVec2::new(0.1, 0.3) * f64::from(i)).collect();
        assert_eq!(Delaunay::new(&line), None);
        assert_eq!(Delaunay::new(&line[..2]), None);
        assert_eq!(Delaunay::new(&[DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::X]), None);
    }
}
