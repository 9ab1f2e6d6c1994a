//! A polygon in space cut into triangles.
//!
//! The polygon is projected along its Newell normal, the sum of the cross
//! products of successive corners, onto the coordinate plane that shows it
//! largest. Convex polygons become a fan; others are cut ear by ear: an ear is
//! a convex corner whose triangle holds no other corner [Meisters 1975].
//! Only the neighbours of a removed ear change, so the work is O(n²).

/// Concave polygons with more corners become a fan, which bounds the work on hostile files.
const MOST_CLIPPED: usize = 1024;

/// The triangles of a polygon, as indices of its corners: always `n - 2` of them.
///
/// Corners that are not finite, or a polygon without area, yield a fan.
pub(crate) fn triangulate(corners: &[[f32; 3]], triangles: &mut Vec<[usize; 3]>) {
    triangles.clear();
    let n = corners.len();
    if n < 3 {
        return;
    }
    let fan = (1..n - 1).map(|i| [0, i, i + 1]);
    let Some(flat) = (n > 3).then(|| project(corners)).flatten() else {
        triangles.extend(fan);
        return;
    };
    let convex = (0..n).all(|i| turn(flat[i], flat[(i + 1) % n], flat[(i + 2) % n]) >= 0.0);
    if convex || n > MOST_CLIPPED {
        triangles.extend(fan);
    } else {
        clip_ears(&flat, triangles);
    }
}

/// The corners in the plane, counter-clockwise; `None` when there is no area to speak of.
fn project(corners: &[[f32; 3]]) -> Option<Vec<[f64; 2]>> {
    let points: Vec<[f64; 3]> = corners.iter().map(|p| p.map(f64::from)).collect();
    let mut normal = [0.0; 3];
    for (i, a) in points.iter().enumerate() {
        let b = points[(i + 1) % points.len()];
        for (axis, sum) in normal.iter_mut().enumerate() {
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            // Relative to the first corner, so that distance from the origin costs no digits.
            let relative = |p: [f64; 3], k: usize| p[k] - points[0][k];
            *sum += relative(*a, u) * relative(b, v) - relative(*a, v) * relative(b, u);
        }
    }
    let largest =
        (0..3).fold(0, |best, axis| if normal[axis].abs() > normal[best].abs() { axis } else { best });
    if !(normal[largest].abs() > 0.0 && normal[largest].is_finite()) {
        return None;
    }
    let (mut u, mut v) = ((largest + 1) % 3, (largest + 2) % 3);
    if normal[largest] < 0.0 {
        std::mem::swap(&mut u, &mut v);
    }
    Some(points.iter().map(|p| [p[u], p[v]]).collect())
}

/// Twice the area of the triangle, positive when it turns left.
fn turn(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// What is left of a polygon whose ears are being cut, as a ring.
struct Ring<'p> {
    points: &'p [[f64; 2]],
    previous: Vec<usize>,
    next: Vec<usize>,
    /// Corners that turn right and are still there; only these can lie in an ear.
    reflex: Vec<usize>,
}

fn clip_ears(points: &[[f64; 2]], triangles: &mut Vec<[usize; 3]>) {
    let n = points.len();
    let mut ring = Ring {
        points,
        previous: (0..n).map(|i| (i + n - 1) % n).collect(),
        next: (0..n).map(|i| (i + 1) % n).collect(),
        reflex: Vec::new(),
    };
    ring.reflex = (0..n).filter(|&i| ring.corner_turn(i) < 0.0).collect();
    let mut is_ear: Vec<bool> = (0..n).map(|i| ring.is_ear(i)).collect();
    let mut at = 0;
    for left in (3..=n).rev() {
        // A polygon that crosses itself may have no ear; then any corner is cut.
        let ear = ring.walk(at, left).find(|&i| is_ear[i]).unwrap_or(at);
        let (before, after) = (ring.previous[ear], ring.next[ear]);
        triangles.push([before, ear, after]);
        ring.remove(ear);
        for i in [before, after] {
            is_ear[i] = ring.is_ear(i);
        }
        // From the far side of the ear: neighbouring ears in a row would make slivers.
        at = after;
    }
}

impl Ring<'_> {
    fn corner_turn(&self, i: usize) -> f64 {
        turn(self.points[self.previous[i]], self.points[i], self.points[self.next[i]])
    }

    fn is_ear(&self, i: usize) -> bool {
        let (a, b, c) = (self.points[self.previous[i]], self.points[i], self.points[self.next[i]]);
        let holds = |p: [f64; 2]| {
            // A corner at the same place, as where a slit closes, does not stand in the way.
            p != a && p != b && p != c && turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0
        };
        turn(a, b, c) > 0.0 && !self.reflex.iter().any(|&j| holds(self.points[j]))
    }

    fn walk(&self, from: usize, count: usize) -> impl Iterator<Item = usize> {
        std::iter::successors(Some(from), |&i| Some(self.next[i])).take(count)
    }

    fn remove(&mut self, i: usize) {
        let (before, after) = (self.previous[i], self.next[i]);
        self.next[before] = after;
        self.previous[after] = before;
        let gone =
            |ring: &Self, j: usize| j == i || ((j == before || j == after) && ring.corner_turn(j) >= 0.0);
        let mut reflex = std::mem::take(&mut self.reflex);
        reflex.retain(|&j| !gone(self, j));
        self.reflex = reflex;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn area(corners: &[[f32; 3]], [a, b, c]: [usize; 3]) -> f64 {
        let flat = |i: usize| [f64::from(corners[i][0]), f64::from(corners[i][1])];
        turn(flat(a), flat(b), flat(c)) / 2.0
    }

    fn check_tiles(corners: &[[f32; 3]], expected_area: f64) {
        let mut triangles = Vec::new();
        triangulate(corners, &mut triangles);
        assert_eq!(triangles.len(), corners.len() - 2);
        let areas: Vec<f64> = triangles.iter().map(|&t| area(corners, t)).collect();
        assert!(areas.iter().all(|&a| a >= 0.0), "{areas:?}: one is turned over");
        let sum: f64 = areas.iter().sum();
        assert!((sum - expected_area).abs() < 1e-5 * expected_area, "{sum} is not {expected_area}");
    }

    fn flat(points: &[[f32; 2]]) -> Vec<[f32; 3]> {
        points.iter().map(|&[x, y]| [x, y, 5.0]).collect()
    }

    #[test]
    fn a_dart_is_cut_along_its_inner_diagonal() {
        for shift in 0..4 {
            let mut dart = flat(&[[0., 0.], [4., 2.], [0., 4.], [1., 2.]]);
            dart.rotate_left(shift);
            check_tiles(&dart, 6.0);
        }
    }

    #[test]
    fn letters_and_slits_are_tiled() {
        let l = flat(&[[0., 0.], [3., 0.], [3., 1.], [1., 1.], [1., 3.], [0., 3.]]);
        check_tiles(&l, 5.0);
        let u = flat(&[[0., 0.], [3., 0.], [3., 3.], [2., 3.], [2., 1.], [1., 1.], [1., 3.], [0., 3.]]);
        check_tiles(&u, 7.0);
        // A square with a square hole, joined to the outside by a slit.
        let holed = flat(&[
            [0., 0.],
            [4., 0.],
            [4., 4.],
            [0., 4.],
            [0., 0.],
            [1., 1.],
            [1., 3.],
            [3., 3.],
            [3., 1.],
            [1., 1.],
        ]);
        check_tiles(&holed, 12.0);
    }

    #[test]
    fn a_comb_of_many_teeth_is_tiled() {
        let teeth = 200;
        let mut comb: Vec<[f32; 2]> = vec![[0., -1.], [2.0 * teeth as f32, -1.]];
        comb.extend((0..=2 * teeth).rev().map(|i| [i as f32, if i % 2 == 0 { 0.0 } else { 3.0 }]));
        check_tiles(&flat(&comb), 2.0 * f64::from(teeth) + 3.0 * f64::from(teeth));
    }

    #[test]
    fn polygons_without_sense_still_give_their_count() {
        let mut triangles = Vec::new();
        for corners in [
            vec![[0.0; 3]; 7],
            vec![[f32::NAN; 3]; 6],
            vec![[f32::MAX; 3], [f32::MIN; 3], [0.; 3], [f32::MAX, 0., 0.], [f32::INFINITY; 3]],
            flat(&[[0., 0.], [1., 1.], [2., 2.], [3., 3.], [4., 4.]]),
            flat(&[[0., 0.], [2., 2.], [2., 0.], [0., 2.]]),
        ] {
            triangulate(&corners, &mut triangles);
            assert_eq!(triangles.len(), corners.len() - 2, "{corners:?}");
        }
        triangulate(&[[0.; 3]; 2], &mut triangles);
        assert!(triangles.is_empty());
    }

    proptest! {
        /// A star around the origin is simple, whatever its radii.
        #[test]
        fn stars_are_tiled(radii in prop::collection::vec(0.2f32..2.0, 5..40), flip in any::<bool>()) {
            let n = radii.len();
            let mut star: Vec<[f32; 3]> = radii.iter().enumerate().map(|(i, r)| {
                let angle = std::f32::consts::TAU * i as f32 / n as f32;
                [r * angle.cos(), r * angle.sin(), 0.0]
            }).collect();
            let whole: f64 = (0..n).map(|i| {
                let [x, y, _] = star[i].map(f64::from);
                let [u, v, _] = star[(i + 1) % n].map(f64::from);
                (x * v - y * u) / 2.0
            }).sum();
            if flip {
                // Seen from behind, in another plane.
                star.iter_mut().for_each(|p| *p = [p[0], 0.0, p[1]]);
                let mut triangles = Vec::new();
                triangulate(&star, &mut triangles);
                let sum: f64 = triangles.iter().map(|&t| {
                    let turned: Vec<_> = star.iter().map(|p| [p[0], p[2], 0.0]).collect();
                    area(&turned, t)
                }).sum();
                prop_assert!((sum - whole).abs() < 1e-4 * whole);
            } else {
                check_tiles(&star, whole);
            }
        }
    }
}
