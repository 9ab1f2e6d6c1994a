//! Mirror and refracted directions, and how light divides between them.

use kajo_math::Vec3;

/// The mirror image of the incoming direction `d` at a surface with unit normal `n`.
#[inline]
pub fn reflect(d: Vec3, n: Vec3) -> Vec3 {
    d - 2.0 * d.dot(n) * n
}

/// The refracted direction, or `None` under total internal reflection.
///
/// * `d`: unit direction of the ray
/// * `n`: unit normal against it, `d . n <= 0`
/// * `eta`: index on the far side over index on the near side
///
/// Snell's law in vector form: with `cos_t^2 = 1 - sin_i^2 / eta^2`,
/// `t = d/eta + (cos_i/eta - cos_t) n`.
#[inline]
pub fn refract(d: Vec3, n: Vec3, eta: f32) -> Option<Vec3> {
    let (d, n, eta) = (d.as_dvec3(), n.as_dvec3(), f64::from(eta));
    let cos_i = -d.dot(n);
    let sin2_t = (1.0 - cos_i * cos_i).max(0.0) / (eta * eta);
    if sin2_t.is_nan() || sin2_t >= 1.0 {
        return None;
    }
    let t = d / eta + (cos_i / eta - (1.0 - sin2_t).sqrt()) * n;
    Some(t.as_vec3())
}

/// Reflectance of a smooth dielectric for unpolarised light: the mean of the squared
/// amplitudes `(eta ci - ct)/(eta ci + ct)` and `(ci - eta ct)/(ci + eta ct)` [Fresnel 1823].
///
/// * `cos_i`: cosine between the ray and the normal, in [0, 1]
/// * `eta`: index on the far side over index on the near side
///
/// One under total internal reflection.
#[inline]
pub fn dielectric(cos_i: f32, eta: f32) -> f32 {
    let (cos_i, eta) = (f64::from(cos_i).clamp(0.0, 1.0), f64::from(eta));
    let sin2_t = (1.0 - cos_i * cos_i) / (eta * eta);
    if sin2_t.is_nan() || sin2_t >= 1.0 {
        return 1.0;
    }
    let cos_t = (1.0 - sin2_t).sqrt();
    let parallel = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    let perpendicular = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    (0.5 * (parallel * parallel + perpendicular * perpendicular)) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reflectance of glass, n = 1.5, as textbooks tabulate it.
    #[test]
    fn fresnel_table_of_glass() {
        let cos = |deg: f64| deg.to_radians().cos() as f32;
        let outside =
            [(0.0, 0.04), (30.0, 0.041_523), (45.0, 0.050_240), (60.0, 0.089_187), (75.0, 0.253_061)];
        let grazing = [(80.0, 0.387_704), (85.0, 0.612_800), (89.0, 0.904_185)];
        for (deg, expected) in outside.into_iter().chain(grazing) {
            assert!((f64::from(dielectric(cos(deg), 1.5)) - expected).abs() < 2e-6, "{deg}");
        }
        for (deg, expected) in [(30.0, 0.055_190), (40.0, 0.245_291), (41.0, 0.379_751), (41.9, 1.0)] {
            assert!((f64::from(dielectric(cos(deg), 1.0 / 1.5)) - expected).abs() < 5e-5, "inside {deg}");
        }
    }

    /// `1 - F_int = (1 - F_ext) / n^2` for hemispherical averages, and the averages themselves.
    #[test]
    fn hemispherical_averages() {
        for (n, external, internal) in [(1.33f32, 0.065_931, 0.471_949), (1.5, 0.091_778, 0.596_346)] {
            // Average over solid angle with cosine: substitute x = cos^2.
            let average = |eta: f32| {
                let steps = 200_000;
                let f = |i: u32| {
                    f64::from(dielectric(((f64::from(i) + 0.5) / f64::from(steps)).sqrt() as f32, eta))
                };
                (0..steps).map(f).sum::<f64>() / f64::from(steps)
            };
            let (ext, int) = (average(n), average(1.0 / n));
            assert!((ext - external).abs() < 1e-5 && (int - internal).abs() < 1e-4, "{ext} {int}");
            assert!((1.0 - int - (1.0 - ext) / f64::from(n * n)).abs() < 1e-4);
        }
    }

    #[test]
    fn refraction_obeys_snell_and_reverses() {
        for deg in [0.0f32, 10.0, 40.0, 80.0, 89.0] {
            let (s, c) = deg.to_radians().sin_cos();
            let d = Vec3::new(s, 0.0, -c);
            let t = refract(d, Vec3::Z, 1.5).unwrap();
            assert!((t.x - s / 1.5).abs() < 1e-6 && (t.length() - 1.0).abs() < 1e-6);
            let back = refract(-t, Vec3::NEG_Z, 1.0 / 1.5).unwrap();
            assert!((back + d).length() < 1e-5);
        }
        let critical = (1.0f32 / 1.5).asin();
        for (angle, passes) in [(critical - 1e-3, true), (critical + 1e-3, false)] {
            let d = Vec3::new(angle.sin(), 0.0, -angle.cos());
            assert_eq!(refract(d, Vec3::Z, 1.0 / 1.5).is_some(), passes);
        }
    }
}
