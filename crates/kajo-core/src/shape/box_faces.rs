//! The faces of a box, where they close a solid that the box cuts through.
//!
//! Faces have numbers from 1: the lower and the upper one across x, then y, then z. A hit of a face has its number as `u`.

use kajo_math::{DVec3, Ray, Vec3};

use super::{Ray64, in_range};
use crate::interaction::Hit;

/// The corners of a box.
pub(super) type Corners = [DVec3; 2];

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
