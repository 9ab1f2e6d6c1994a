//! Boxes of solids that are told by a function: the way of a line through them, and the faces that close what they cut.
//!
//! Faces have numbers from 1: the lower and the upper one across x, then y, then z. A hit of a face has its number as `u`.

use kajo_math::{Aabb, DVec3, Ray, Vec3};

use super::{Ray64, Tessellation, in_range};
use crate::interaction::Hit;

/// The corners of a box.
pub(super) type Corners = [DVec3; 2];

/// A box of single precision around one of double precision.
pub(super) fn around([low, high]: Corners) -> Aabb {
    Aabb { min: low.to_array().map(down).into(), max: high.to_array().map(|x| -down(-x)).into() }
}

/// A number of single precision that is not more.
pub(super) fn down(x: f64) -> f32 {
    let single = x as f32;
    if f64::from(single) > x { single.next_down() } else { single }
}

/// The piece of a line in a box and in a range of parameters; none where it has no length. Boxes that share a face give both the
/// same parameter there.
///
/// * `ends`: of the box along an axis
#[inline]
pub(super) fn clip(
    ends: impl Fn(usize) -> [f64; 2],
    line: &Ray64,
    [mut from, mut to]: [f64; 2],
) -> Option<[f64; 2]> {
    for axis in 0..3 {
        let [low, high] = ends(axis);
        let (o, d) = (line.o[axis], line.d[axis]);
        if d == 0.0 {
            if !(low <= o && o < high) {
                return None;
            }
            continue;
        }
        let [a, b] = [(low - o) / d, (high - o) / d];
        from = from.max(a.min(b));
        to = to.min(a.max(b));
    }
    (from < to).then_some([from, to])
}

/// Where a line is in a box, and through which faces it comes and goes.
pub(super) fn faces([low, high]: Corners, line: &Ray64) -> Option<[(f64, u32); 2]> {
    let (mut enters, mut leaves) = ((f64::NEG_INFINITY, 0), (f64::INFINITY, 0));
    for axis in 0..3 {
        let (o, d) = (line.o[axis], line.d[axis]);
        let from_below = d > 0.0;
        if d == 0.0 {
            if !(low[axis] <= o && o < high[axis]) {
                return None;
            }
            continue;
        }
        let [a, b] = [(low[axis] - o) / d, (high[axis] - o) / d];
        let face = |is_high: bool| 1 + 2 * axis as u32 + u32::from(is_high);
        if a.min(b) > enters.0 {
            enters = (a.min(b), face(!from_below));
        }
        if a.max(b) < leaves.0 {
            leaves = (a.max(b), face(from_below));
        }
    }
    (enters.0 < leaves.0).then_some([enters, leaves])
}

/// The hit of a face, if it is in the ray's range and cuts through the inside.
pub(super) fn cap(
    ray: &Ray,
    line: &Ray64,
    (t, face): (f64, u32),
    is_inside: impl FnOnce(DVec3) -> bool,
) -> Option<Hit> {
    let single = in_range(ray, t)?;
    is_inside(line.at(t)).then(|| on_face(single, face))
}

/// A hit of a face.
pub(super) fn on_face(t: f32, face: u32) -> Hit {
    Hit { t, u: face as f32, ..Hit::default() }
}

/// For a hit of a face, the point brought onto it and its outward normal.
pub(super) fn face_point(corners: Corners, hit: &Hit, mut p: DVec3) -> Option<(DVec3, DVec3)> {
    let face = (hit.u as usize).checked_sub(1)?;
    let (axis, is_high) = (face / 2, face % 2 == 1);
    p[axis] = corners[usize::from(is_high)][axis];
    let mut n = DVec3::ZERO;
    n[axis] = if is_high { 1.0 } else { -1.0 };
    Some((p, n))
}

/// The face that a point of single precision is on, if any.
pub(super) fn face_at(corners: Corners, p: Vec3) -> Option<u32> {
    let corners = corners.map(DVec3::as_vec3);
    (0..3).find_map(|axis| {
        let at = corners.iter().position(|corner| p[axis] == corner[axis])?;
        Some(1 + 2 * axis as u32 + at as u32)
    })
}

/// Triangles of the surface of a function in a box, and of the faces that close it.
///
/// * `bounds`: of the surface, within the box
/// * `f`: how far a point is inside, negative outside, and the slopes of that
pub(super) fn tessellate(
    [low, high]: Corners,
    bounds: Aabb,
    closed: bool,
    around: u32,
    out: &mut Tessellation,
    f: impl Fn(DVec3) -> (f64, DVec3),
) {
    // A little more than the box, so that its faces are in between.
    let margin = if closed { 0.01 * (high - low) } else { DVec3::ZERO };
    let bounds = Aabb { min: bounds.min - margin.as_vec3(), max: bounds.max + margin.as_vec3() };
    out.level_set(bounds, around, |p| {
        let (inside, gradient) = f(p);
        // The nearest face of the box, by as much as the surface is near in this unit.
        let (below, above) = (p - low, high - p);
        let depth = below.min(above).min_element();
        let scaled = depth * gradient.length().max(f64::MIN_POSITIVE);
        if !closed || inside < scaled {
            return (inside, gradient);
        }
        let face = |axis: usize| DVec3::AXES[axis] * if below[axis] < above[axis] { -1.0 } else { 1.0 };
        let axis = (0..3).find(|&axis| below[axis].min(above[axis]) <= depth).unwrap_or(0);
        (scaled, face(axis) * gradient.length())
    });
}
