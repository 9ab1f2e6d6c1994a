//! Maps of uniform numbers to other distributions.

use crate::{Vec2, Vec3, fmath};

/// A right-handed orthonormal basis whose third vector is the unit vector `n`
/// [Duff et al. 2017].
#[inline]
pub fn basis(n: Vec3) -> (Vec3, Vec3) {
    let sign = 1.0f32.copysign(n.z);
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    (Vec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x), Vec3::new(b, sign + n.y * n.y * a, -n.y))
}

/// A direction uniform over the sphere, from `u` in [0, 1)^2; its pdf is `1 / (4 pi)`.
#[inline]
pub fn uniform_sphere(u: Vec2) -> Vec3 {
    let z = 1.0 - 2.0 * u.x;
    let r = (1.0 - z * z).max(0.0).sqrt();
    let (s, c) = fmath::sin_cos(std::f32::consts::TAU * u.y);
    Vec3::new(r * c, r * s, z)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bases_are_orthonormal_and_right_handed() {
        for n in [Vec3::Z, Vec3::NEG_Z, Vec3::X, Vec3::new(0.6, -0.64, -0.48)] {
            let (s, t) = basis(n);
            assert!((s.cross(t) - n).length() < 1e-6, "{n}");
        }
    }

    #[test]
    fn sphere_directions_average_to_nothing() {
        let n = 64;
        let mut sum = Vec3::ZERO;
        for i in 0..n * n {
            let u = Vec2::new((i % n) as f32 + 0.5, (i / n) as f32 + 0.5) / n as f32;
            let w = uniform_sphere(u);
            assert!((w.length() - 1.0).abs() < 1e-5);
            sum += w;
        }
        assert!((sum / (n * n) as f32).length() < 1e-4);
    }
}
