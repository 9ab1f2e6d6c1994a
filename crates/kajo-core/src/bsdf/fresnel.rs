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
/// Snell's law in vector form, `t = (d - (eta cos_t - cos_i) n) / eta`, where the difference is `(eta² - 1) / (eta cos_t + cos_i)`.
/// `t` is off by at most `1e-6 / (eta cos_t)`.
#[inline]
pub fn refract(d: Vec3, n: Vec3, eta: f32) -> Option<Vec3> {
    let cos_i = -d.dot(n);
    let bend = (eta - 1.0) * (eta + 1.0) / (cos_i + eta_cos_t(cos_i, eta)?);
    Some((d - bend * n) / eta)
}

/// `eta cos_t = √(eta² - sin_i²)`, or `None` under total internal reflection.
#[inline]
fn eta_cos_t(cos_i: f32, eta: f32) -> Option<f32> {
    // The second form loses no digits of a small cosine beside an index next to 1, the first none of a small index.
    let square = if cos_i > 0.7 {
        eta * eta - (1.0 - cos_i) * (1.0 + cos_i)
    } else {
        (eta - 1.0) * (eta + 1.0) + cos_i * cos_i
    };
    (square > 0.0).then(|| square.sqrt())
}

/// Reflectance of a smooth dielectric for unpolarised light: the mean of the squared
/// amplitudes `(eta ci - ct)/(eta ci + ct)` and `(ci - eta ct)/(ci + eta ct)` [Fresnel 1823].
///
/// * `cos_i`: cosine between the ray and the normal, in [0, 1]
/// * `eta`: index on the far side over index on the near side
///
/// One under total internal reflection. Off by at most 1e-6 of itself where `eta >= 1`; below, by 2e-6 of itself and as much as
/// it changes with the last bit of `cos_i`.
#[inline]
pub fn dielectric(cos_i: f32, eta: f32) -> f32 {
    let ci = cos_i.clamp(0.0, 1.0);
    let Some(eta_ct) = eta_cos_t(ci, eta) else { return 1.0 };
    // Both differences in factors, of which those that are small are exact.
    let beyond = (eta - 1.0) * (eta + 1.0);
    let (eta2, ci2, sin2_i) = (eta * eta, ci * ci, (1.0 - ci) * (1.0 + ci));
    let (sum, eta_sum) = (ci + eta_ct, eta2 * ci + eta_ct);
    let perpendicular = beyond / (sum * sum);
    let parallel = beyond * (eta2 * ci2 - sin2_i) / (eta_sum * eta_sum);
    0.5 * (parallel * parallel + perpendicular * perpendicular)
}

#[cfg(test)]
mod tests {
    use kajo_math::{Vec2, rng::Stream, warp};

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

    /// The same in double precision, in a form that does not cancel either.
    fn reflectance(ci: f64, eta: f64) -> f64 {
        let square = (eta - 1.0) * (eta + 1.0) + ci * ci;
        if square <= 0.0 {
            return 1.0;
        }
        let (eta_ct, beyond) = (square.sqrt(), (eta - 1.0) * (eta + 1.0));
        let perpendicular = beyond / (ci + eta_ct).powi(2);
        let brewster = (eta * ci).powi(2) - (1.0 - ci) * (1.0 + ci);
        let parallel = beyond * brewster / (eta * eta * ci + eta_ct).powi(2);
        0.5 * (parallel * parallel + perpendicular * perpendicular)
    }

    /// An index in (1/4, 1) or (1, 4), often next to 1, and one of the cosines in (0, 1), often next to an end.
    fn index_and_cosine(i: u32) -> (f32, f32) {
        let number = Stream::new(13, [i, 0], 0);
        let excess = 1.0 + 3.0 * number.uniform(0).powi(if i & 1 == 0 { 1 } else { 6 }).max(1e-6);
        let cos = match i / 4 % 3 {
            0 => number.uniform(1),
            1 => number.uniform(1).powi(4),
            _ => 1.0 - number.uniform(1).powi(4),
        };
        (if i & 2 == 0 { excess } else { 1.0 / excess }, cos.max(1e-12))
    }

    #[test]
    fn reflectance_is_as_exact_as_it_says() {
        for i in 0..1 << 20 {
            let (eta, cos) = index_and_cosine(i);
            let at = |cos: f32| reflectance(cos.into(), eta.into());
            let (found, exact) = (f64::from(dielectric(cos, eta)), at(cos));
            let change = [cos.next_up(), cos.next_down()].map(|cos| (at(cos) - exact).abs());
            let bound = if eta > 1.0 { 1e-6 * exact } else { 2e-6 * exact + change[0].max(change[1]) };
            assert!((found - exact).abs() <= bound, "cosine {cos}, index {eta}: {found} {exact}");
        }
        // What is no boundary lets everything pass.
        assert_eq!([1.0, 0.3, 1e-20].map(|cos| dielectric(cos, 1.0)), [0.0; 3]);
    }

    #[test]
    fn refraction_is_as_exact_as_it_says() {
        for i in 0..1 << 20 {
            let (eta, _) = index_and_cosine(i);
            let u = |k| Stream::new(14, [i, 0], 0).uniform(k);
            let [d, n] = [0, 2].map(|k| warp::uniform_sphere(Vec2::new(u(k), u(k + 1))));
            let n = if d.dot(n) > 0.0 { -n } else { n };
            let (d64, n64, eta64) = (d.as_dvec3(), n.as_dvec3(), f64::from(eta));
            let cos_i = -d64.dot(n64);
            let sin2_t = (1.0 - cos_i * cos_i) / (eta64 * eta64);
            let cos_t = (1.0 - sin2_t).max(0.0).sqrt();
            // Where light goes along the surface, whether it passes is a matter of the last bit.
            let Some(t) = refract(d, n, eta) else {
                assert!(cos_t * eta64 < 1e-3, "{d} {n} {eta}");
                continue;
            };
            let exact = d64 / eta64 + (cos_i / eta64 - cos_t) * n64;
            let off = t.as_dvec3().distance(exact);
            assert!(off * eta64 * cos_t < 1e-6, "{d} {n} {eta}: {off}");
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
