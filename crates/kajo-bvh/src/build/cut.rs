//! Triangles cut at planes across the axes: boxes around the parts, never too small.
//!
//! The part of a triangle on one side of a plane is the polygon of its corners there and of the
//! points where its edges cross the plane. Crossings are worked out in f64 and their
//! coordinates rounded away from the polygon, by more than the error of the arithmetic.

use kajo_math::Vec3;

use super::prim::Box4;

/// Relative error of a crossing; the arithmetic's own is less than a quarter of it.
const ERROR: f64 = 8.0 * f64::EPSILON;

/// The boxes around what lies before and behind `plane`, across `axis`, of the part of a
/// triangle that is in `bounds`; `None` for a side that has nothing.
///
/// Every point of the triangle in `bounds` is in one of the boxes, and both are within `bounds`.
pub(super) fn cut(corners: [Vec3; 3], bounds: Box4, axis: usize, plane: f32) -> [Option<Box4>; 2] {
    let mut sides = [Box4::EMPTY; 2];
    for (i, p) in corners.into_iter().enumerate() {
        let q = corners[(i + 1) % 3];
        if p[axis] <= plane {
            sides[0] = sides[0].grown(p.extend(0.0));
        }
        if p[axis] >= plane {
            sides[1] = sides[1].grown(p.extend(0.0));
        }
        if (p[axis] < plane && plane < q[axis]) || (q[axis] < plane && plane < p[axis]) {
            let (lo, hi) = crossing(p, q, axis, plane);
            sides = sides.map(|side| side.grown(lo.extend(0.0)).grown(hi.extend(0.0)));
        }
    }
    let (mut before, mut behind) = (bounds, bounds);
    before.hi[axis] = before.hi[axis].min(plane);
    behind.lo[axis] = behind.lo[axis].max(plane);
    let intersection = |side: Box4, half: Box4| {
        let part = Box4 { lo: side.lo.max(half.lo), hi: side.hi.min(half.hi) };
        part.lo.truncate().cmple(part.hi.truncate()).all().then_some(part)
    };
    [intersection(sides[0], before), intersection(sides[1], behind)]
}

/// The corners of a box around the point where the edge from `p` to `q` crosses the plane.
fn crossing(p: Vec3, q: Vec3, axis: usize, plane: f32) -> (Vec3, Vec3) {
    let (a, b) = (p.as_dvec3(), q.as_dvec3());
    let share = (f64::from(plane) - a[axis]) / (b[axis] - a[axis]);
    let point = a + share * (b - a);
    let error = ERROR * (a.abs() + b.abs());
    let (mut lo, mut hi) = (p.min(q), p.max(q));
    for k in 0..3 {
        if k == axis {
            (lo[k], hi[k]) = (plane, plane);
        } else {
            lo[k] = lo[k].max(down(point[k] - error[k]));
            hi[k] = hi[k].min(-down(-(point[k] + error[k])));
        }
    }
    (lo, hi)
}

/// The largest f32 that is not above `x`.
fn down(x: f64) -> f32 {
    let near = x as f32;
    if f64::from(near) > x { near.next_down() } else { near }
}

#[cfg(test)]
mod tests {
    use kajo_math::Vec4;
    use kajo_math::rng::mix;

    use super::*;

    /// Number `k` of thing `i`, within -1 and 1.
    fn at(i: u32, k: u32) -> f32 {
        (mix(u64::from(i) << 8 | u64::from(k)) >> 40) as f32 / (1 << 23) as f32 - 1.0
    }

    fn point(i: u32, k: u32) -> Vec3 {
        Vec3::new(at(i, k), at(i, k + 1), at(i, k + 2))
    }

    fn holds(bounds: Option<Box4>, p: [f64; 3]) -> bool {
        bounds.is_some_and(|b| (0..3).all(|k| f64::from(b.lo[k]) <= p[k] && p[k] <= f64::from(b.hi[k])))
    }

    /// A point of the triangle whose coordinates are exact in f64: weights are small integers.
    fn inside(corners: [Vec3; 3], i: u32) -> [f64; 3] {
        let (u, v) = (mix(u64::from(i)) % 65, mix(u64::from(i) + 77) % 65);
        let (u, v) = if u + v > 64 { (64 - u, 64 - v) } else { (u, v) };
        let weights = [64 - u - v, u, v].map(|weight| weight as f64 / 64.0);
        [0, 1, 2].map(|k| (0..3).map(|c| weights[c] * f64::from(corners[c][k])).sum())
    }

    #[test]
    fn every_point_is_on_one_side() {
        for i in 0..3000 {
            let scale = 10f32.powi(i as i32 % 60 - 30);
            let thin = if i % 3 == 0 { Vec3::splat(1e-5) } else { Vec3::ONE };
            let far = if i % 7 == 0 { Vec3::splat(1000.0) } else { Vec3::ZERO };
            let a = (point(i, 0) + far) * scale;
            let corners = [a, a + point(i, 3) * scale, a + point(i, 6) * thin * scale];
            let all = Box4::around(corners.map(Into::into));
            // Cut in two, and one of the parts again.
            let mut parts = vec![all];
            for (axis, share) in [(i as usize % 3, 0.3), (i as usize / 3 % 3, 0.6)] {
                let Some(bounds) = parts.pop() else { break };
                let plane = bounds.lo[axis] + (bounds.hi[axis] - bounds.lo[axis]) * share;
                let sides = cut(corners, bounds, axis, plane);
                for (side, part) in sides.iter().enumerate() {
                    let Some(part) = part else { continue };
                    let (lo, hi) = (part.lo.truncate(), part.hi.truncate());
                    assert!(lo.cmpge(bounds.lo.truncate()).all() && hi.cmple(bounds.hi.truncate()).all());
                    assert!(if side == 0 { hi[axis] <= plane } else { lo[axis] >= plane }, "{i}");
                }
                for j in 0..60 {
                    let p = inside(corners, i * 100 + j);
                    if holds(Some(bounds), p) {
                        assert!(holds(sides[0], p) || holds(sides[1], p), "{i} {j}: {p:?} of {corners:?}");
                    }
                }
                parts.extend(sides.into_iter().flatten());
            }
        }
    }

    #[test]
    fn parts_are_as_small_as_they_can_be() {
        let corners = [Vec3::ZERO, Vec3::new(4.0, 4.0, 0.0), Vec3::new(4.0, 0.0, 8.0)];
        let all = Box4::around(corners.map(Into::into));
        let near = |b: Option<Box4>, lo: [f32; 3], hi: [f32; 3]| {
            let b = b.unwrap();
            (b.lo.truncate() - Vec3::from(lo)).abs().max_element() < 1e-5
                && (b.hi.truncate() - Vec3::from(hi)).abs().max_element() < 1e-5
        };
        let [before, behind] = cut(corners, all, 0, 1.0);
        assert!(near(before, [0.0, 0.0, 0.0], [1.0, 1.0, 2.0]), "{before:?}");
        assert!(near(behind, [1.0, 0.0, 0.0], [4.0, 4.0, 8.0]), "{behind:?}");
    }

    #[test]
    fn planes_beside_and_at_the_border() {
        let corners = [Vec3::ZERO, Vec3::X, Vec3::Y];
        let all = Box4::around(corners.map(Into::into));
        assert!(matches!(cut(corners, all, 0, 2.0), [Some(_), None]));
        assert!(matches!(cut(corners, all, 0, -1.0), [None, Some(_)]));
        let [before, behind] = cut(corners, all, 0, 1.0);
        assert!(before.unwrap().hi == all.hi && behind.unwrap().lo.truncate() == Vec3::X);
        // A triangle across the plane's axis lies on both sides of it.
        let [before, behind] = cut(corners, all, 2, 0.0);
        assert!(before.is_some() && behind.is_some());
        let elsewhere = Box4 { lo: Vec4::splat(5.0), hi: Vec4::splat(6.0) };
        assert!(cut(corners, elsewhere, 0, 5.5).iter().all(Option::is_none));
    }
}
