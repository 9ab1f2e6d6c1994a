//! Maps of uniform numbers to other distributions.
//!
//! They are as exact as single precision can be: of spheres, hemispheres and cones the coordinate along the axis is off by at most 1e-7,
//! the squared distance from it by 3e-7 and the angle around it by 1e-6; of a cone that distance by 1e-6 of itself.
//! Points of a disk are off by 5e-7, and the squared heights of a hemisphere over it by 5e-7.

use crate::{Vec2, Vec3, fmath};

/// Whether an event of the probability `p` happens, and what is left of the number after that, uniform in [0, 1) again.
///
/// * `u`: uniform in [0, 1); the event happens below `p`
#[inline]
pub fn choose(u: f32, p: f32) -> (bool, f32) {
    let happens = u < p;
    let rest = if happens { u / p } else { (u - p) / (1.0 - p) };
    (happens, rest.min(1.0f32.next_down()))
}

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

/// A direction uniform over the hemisphere around z, from `u` in [0, 1)^2; its pdf is `1 / (2 pi)`.
#[inline]
pub fn uniform_hemisphere(u: Vec2) -> Vec3 {
    let z = u.x;
    let r = (1.0 - z * z).max(0.0).sqrt();
    let (s, c) = fmath::sin_cos(std::f32::consts::TAU * u.y);
    Vec3::new(r * c, r * s, z)
}

/// A direction uniform over the cone of half angle `r` around z, from `u` in [0, 1)^2; its pdf is
/// `1 / (2 pi (1 - cos r))`.
///
/// * `one_minus_cos`: `1 - cos r`, which keeps its digits where `cos r` has lost them
#[inline]
pub fn uniform_cone(u: Vec2, one_minus_cos: f32) -> Vec3 {
    let x = u.x * one_minus_cos;
    let r = (x * (2.0 - x)).max(0.0).sqrt();
    let (s, c) = fmath::sin_cos(std::f32::consts::TAU * u.y);
    Vec3::new(r * c, r * s, 1.0 - x)
}

/// A point uniform over the unit disk, from `u` in [0, 1)^2: squares around the middle become circles, so that
/// neighbours stay neighbours [Shirley and Chiu 1997].
#[inline]
pub fn concentric_disk(u: Vec2) -> Vec2 {
    let v = 2.0 * u - Vec2::ONE;
    if v == Vec2::ZERO {
        return v;
    }
    let quarter = std::f32::consts::FRAC_PI_4;
    let (r, angle) = if v.x.abs() > v.y.abs() {
        (v.x, quarter * (v.y / v.x))
    } else {
        (v.y, 2.0 * quarter - quarter * (v.x / v.y))
    };
    let (s, c) = fmath::sin_cos(angle);
    Vec2::new(r * c, r * s)
}

/// A direction of the hemisphere around z with density proportional to the cosine, from `u` in [0, 1)^2: a
/// uniform point of the disk, lifted [Malley 1988]. Its pdf is `z / pi`.
#[inline]
pub fn cosine_hemisphere(u: Vec2) -> Vec3 {
    let d = concentric_disk(u);
    d.extend((1.0 - d.length_squared()).max(0.0).sqrt())
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, TAU};

    use super::*;
    use crate::rng::Stream;

    #[test]
    fn warps_are_as_exact_as_they_say() {
        for i in 0..200_000 {
            let s = Stream::new(17, [i, 0], 0);
            // Also next to the poles.
            let near = if i % 4 == 0 { 1e-5 * s.uniform(0) } else { s.uniform(0) };
            let x = if i % 8 == 0 { (1.0 - near).min(1.0f32.next_down()) } else { near };
            let u = Vec2::new(x, s.uniform(1));
            let (x, phi) = (f64::from(x), TAU * f64::from(u.y));
            let around = [phi.cos(), phi.sin()];
            let across = |w: Vec3| [w.x, w.y].map(f64::from);
            for (w, z) in [(uniform_sphere(u), 1.0 - 2.0 * x), (uniform_hemisphere(u), x)] {
                assert!((f64::from(w.z) - z).abs() < 1e-7, "{u}: {w}");
                let [a, b] = across(w);
                let squared = a * a + b * b;
                assert!((squared - (1.0 - z * z)).abs() < 3e-7, "{u}: {w}");
                let angle = a * around[1] - b * around[0];
                assert!(angle.abs() <= 1e-6 * squared.sqrt(), "{u}: {w}");
            }
            let height = if i % 2 == 0 { 1e-4 * s.uniform(2) } else { s.uniform(2) };
            let w = uniform_cone(u, height);
            let below = x * f64::from(height);
            assert!((f64::from(w.z) - (1.0 - below)).abs() < 1e-7);
            let r = (below * (2.0 - below)).sqrt();
            let off = [0, 1].map(|k| (across(w)[k] - r * around[k]).abs());
            assert!(off.iter().all(|&off| off <= 1e-6 * r), "{u} {height}: {w}");
            let (p, lifted) = (concentric_disk(u), cosine_hemisphere(u));
            let [a, b] = [2.0 * x - 1.0, 2.0 * f64::from(u.y) - 1.0];
            let (r, angle) =
                if a.abs() > b.abs() { (a, FRAC_PI_4 * b / a) } else { (b, FRAC_PI_2 - FRAC_PI_4 * a / b) };
            if r == 0.0 {
                continue;
            }
            let exact = [r * angle.cos(), r * angle.sin()];
            let off = [f64::from(p.x) - exact[0], f64::from(p.y) - exact[1]];
            assert!(off.iter().all(|off| off.abs() < 5e-7), "{u}: {p}");
            let z = f64::from(lifted.z);
            assert!((z * z - (1.0 - r * r)).abs() < 5e-7, "{u}: {lifted}");
        }
    }

    /// What is left of the number is uniform in [0, 1) in both cases, also next to `p`, and for 0 and 1.
    #[test]
    fn a_choice_leaves_a_uniform_number() {
        for p in [0.0, 1e-6, 0.25, 0.5, 0.9, 1.0f32] {
            let mut rests = [Vec::new(), Vec::new()];
            for i in 0..4000 {
                let (happens, rest) = choose((i as f32 + 0.5) / 4000.0, p);
                assert!((0.0..1.0).contains(&rest), "{p}: {rest}");
                rests[usize::from(happens)].push(rest);
            }
            assert!((rests[1].len() as f32 - 4000.0 * p).abs() <= 1.0, "{p}");
            for rests in rests.iter().filter(|rests| rests.len() > 500) {
                let mean = rests.iter().sum::<f32>() / rests.len() as f32;
                assert!((mean - 0.5).abs() < 1e-3 && rests.is_sorted(), "{p}: {mean}");
            }
        }
        for p in (1..1000).map(|i| i as f32 / 1000.0) {
            let ends = [p.next_down(), p, 1.0f32.next_down()].map(|u| choose(u, p));
            assert_eq!(ends.map(|end| end.0), [true, false, false]);
            assert!(ends.iter().all(|(_, rest)| (0.0..1.0).contains(rest)), "{p}: {ends:?}");
        }
    }

    /// Moments of the points of a fine grid, against the integrals over disk and hemisphere.
    #[test]
    fn disk_and_hemispheres_have_the_moments_of_their_densities() {
        let n = 256;
        let mut square = 0.0;
        let (mut uniform, mut cosine) = ([0.0f64; 3], [0.0f64; 3]);
        for i in 0..n * n {
            let u = Vec2::new((i % n) as f32 + 0.5, (i / n) as f32 + 0.5) / n as f32;
            square += f64::from(concentric_disk(u).length_squared());
            for (sums, w) in [(&mut uniform, uniform_hemisphere(u)), (&mut cosine, cosine_hemisphere(u))] {
                assert!((w.length() - 1.0).abs() < 1e-5 && w.z >= 0.0);
                for (sum, value) in sums.iter_mut().zip([w.z, w.z * w.z, w.x * w.x]) {
                    *sum += f64::from(value);
                }
            }
        }
        let mean = |sum: f64| sum / f64::from(n * n);
        assert!((mean(square) - 0.5).abs() < 1e-4);
        for (sums, expected) in [(uniform, [0.5, 1.0 / 3.0, 1.0 / 3.0]), (cosine, [2.0 / 3.0, 0.5, 0.25])] {
            for (sum, expected) in sums.into_iter().zip(expected) {
                // The cosine ends in a square root at the rim, where a grid is less exact.
                assert!((mean(sum) - expected).abs() < 3e-4, "{} {expected}", mean(sum));
            }
        }
    }

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
