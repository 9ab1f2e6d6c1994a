//! Rounding bounds and ray origins that are safe by construction.
//!
//! No renderer-wide epsilon exists. A hit carries a bound on the rounding error of its
//! point, and [`offset_origin`] moves a new ray's origin just past that bound along the
//! surface's normal, after [Pharr, Jakob and Humphreys 2023, ch. 6.8].

use crate::Vec3;

/// Bound on the relative error of `n` roundings in a row: `n e / (1 - n e)` with `e = 2^-24`.
#[inline]
pub const fn gamma(n: u32) -> f32 {
    let ne = n as f32 * (0.5 * f32::EPSILON);
    ne / (1.0 - ne)
}

/// An origin for a ray that leaves the surface point `p` in direction `d`.
///
/// * `p_error`: bound on the absolute error of each coordinate of `p`
/// * `n`: unit geometric normal, either side
///
/// The result lies on the side of the surface that `d` points to, outside the error box
/// of `p`, so a ray that starts there cannot meet the surface it leaves.
#[inline]
pub fn offset_origin(p: Vec3, p_error: Vec3, n: Vec3, d: Vec3) -> Vec3 {
    // The rounding of the sum itself is at most half a unit in the last place of each coordinate;
    // a whole one, taken along with the error, keeps the result outside.
    let distance = n.abs().dot(p_error + f32::EPSILON * p.abs());
    p + n * distance.copysign(d.dot(n))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn origins_leave_the_error_box_on_the_right_side() {
        for scale in [1e-4f32, 1.0, 1e6] {
            let p = Vec3::new(0.3, -0.7, 0.2) * scale;
            let err = p.abs() * gamma(5);
            let n = Vec3::new(1.0, 2.0, -2.0) / 3.0;
            for d in [n, -n] {
                let o = offset_origin(p, err, n, d);
                assert!((o - p).dot(d) > 0.0, "scale {scale}");
            }
        }
    }
}
