//! Three by three matrices in double precision that the compiler can evaluate.

/// Rows of a three by three matrix.
pub type Matrix3 = [[f64; 3]; 3];

/// `m v`.
pub const fn apply(m: &Matrix3, v: [f64; 3]) -> [f64; 3] {
    let mut out = [0.0; 3];
    let mut i = 0;
    while i < 3 {
        out[i] = m[i][0] * v[0] + m[i][1] * v[1] + m[i][2] * v[2];
        i += 1;
    }
    out
}

/// `m v` in single precision, as pictures are.
#[inline]
pub fn apply_f32(m: &Matrix3, v: [f32; 3]) -> [f32; 3] {
    apply(m, v.map(f64::from)).map(|x| x as f32)
}

/// `a b`.
pub const fn product(a: &Matrix3, b: &Matrix3) -> Matrix3 {
    let mut out = [[0.0; 3]; 3];
    let (mut i, mut j) = (0, 0);
    while i < 3 {
        out[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j];
        (i, j) = if j < 2 { (i, j + 1) } else { (i + 1, 0) };
    }
    out
}

/// The matrix with `d` on its diagonal and zero elsewhere.
pub const fn diagonal(d: [f64; 3]) -> Matrix3 {
    [[d[0], 0.0, 0.0], [0.0, d[1], 0.0], [0.0, 0.0, d[2]]]
}

/// Determinant.
pub const fn determinant(m: &Matrix3) -> f64 {
    let [a, b, c] = *m;
    a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0])
        + a[2] * (b[0] * c[1] - b[1] * c[0])
}

/// Inverse, by the adjugate; not finite for a singular matrix.
pub const fn inverse(m: &Matrix3) -> Matrix3 {
    let [a, b, c] = *m;
    let s = 1.0 / determinant(m);
    [
        [s * (b[1] * c[2] - b[2] * c[1]), s * (a[2] * c[1] - a[1] * c[2]), s * (a[1] * b[2] - a[2] * b[1])],
        [s * (b[2] * c[0] - b[0] * c[2]), s * (a[0] * c[2] - a[2] * c[0]), s * (a[2] * b[0] - a[0] * b[2])],
        [s * (b[0] * c[1] - b[1] * c[0]), s * (a[1] * c[0] - a[0] * c[1]), s * (a[0] * b[1] - a[1] * b[0])],
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_matrix_times_its_inverse_is_one() {
        let m = [[0.5, 0.3, -0.1], [0.2, 0.9, 0.4], [-0.6, 0.1, 1.2]];
        let one = product(&m, &inverse(&m));
        for (i, row) in one.iter().enumerate() {
            for (j, x) in row.iter().enumerate() {
                assert!((x - f64::from(i == j)).abs() < 1e-15, "{one:?}");
            }
        }
        assert_eq!(apply(&diagonal([1.0, 2.0, 3.0]), [4.0, 5.0, 6.0]), [4.0, 10.0, 18.0]);
        assert!(
            (determinant(&m) - 0.5 * (0.9 * 1.2 - 0.4 * 0.1)
                + 0.3 * (0.2 * 1.2 + 0.4 * 0.6)
                + 0.1 * (0.2 * 0.1 + 0.9 * 0.6))
                .abs()
                < 1e-15
        );
    }
}
