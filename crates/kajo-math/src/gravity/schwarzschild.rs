//! What is known of light around a black hole without spin in closed form.
//!
//! In the plane of its orbit light of impact parameter `b` around mass 1 follows, with `u = 1/r`,
//!
//! ```text
//! (du/dφ)² = 1/b² - u² + 2 u³ = 2 (u - u₁)(u - u₂)(u - u₃),    u₁ < 0 < u₂ < u₃
//! ```
//!
//! so that angles are elliptic integrals of the first kind [Darwin 1959]. Here they are made of Carlson's symmetric form.

use std::f64::consts::PI;

use crate::fmath::{acos64, cos64};

/// The impact parameter of light that is just captured, over the mass: `sqrt(27)`.
pub const CRITICAL_IMPACT: f64 = 5.196_152_422_706_632;

/// Carlson's elliptic integral `R_F(x, y, z) = ∫₀^∞ dt / (2 sqrt((t+x)(t+y)(t+z)))` [Carlson 1995, algorithm 1].
///
/// * `x`, `y`, `z`: not negative, and at most one of them zero
pub fn elliptic_rf(mut x: f64, mut y: f64, mut z: f64) -> f64 {
    for _ in 0..60 {
        let mean = (x + y + z) / 3.0;
        let off = [x, y, z].map(|v| (v - mean).abs()).into_iter().fold(0.0, f64::max);
        if off < 2e-3 * mean {
            break;
        }
        let [a, b, c] = [x, y, z].map(f64::sqrt);
        let lambda = a * b + b * c + c * a;
        [x, y, z] = [x, y, z].map(|v| 0.25 * (v + lambda));
    }
    let mean = (x + y + z) / 3.0;
    let [dx, dy] = [(mean - x) / mean, (mean - y) / mean];
    let dz = -(dx + dy);
    let (e2, e3) = (dx * dy - dz * dz, dx * dy * dz);
    (1.0 - e2 / 10.0 + e3 / 14.0 + e2 * e2 / 24.0 - 3.0 * e2 * e3 / 44.0) / mean.sqrt()
}

/// The incomplete elliptic integral `F(φ | m) = ∫ dθ / sqrt(1 - m sin² θ)` for `sin φ = s`, in [0, 1].
pub fn elliptic_f(s: f64, m: f64) -> f64 {
    let s2 = s * s;
    s * elliptic_rf(1.0 - s2, 1.0 - m * s2, 1.0)
}

/// The roots `u₁ < u₂ < u₃` of `1/b² - u² + 2 u³` for light that is not captured.
fn turning_points(b: f64) -> [f64; 3] {
    // u = 1/6 + cos(θ)/3 solves it where cos 3θ = 1 - 54/b².
    let third = acos64((1.0 - 54.0 / (b * b)).clamp(-1.0, 1.0)) / 3.0;
    let root = |turn: f64| 1.0 / 6.0 + cos64(third + turn) / 3.0;
    [root(2.0 * PI / 3.0), root(-2.0 * PI / 3.0), root(0.0)]
}

/// The angle that light is deflected by on its way from infinity to infinity, in radians.
///
/// * `b`: impact parameter over the mass
///
/// `None` where the light is captured.
pub fn deflection(b: f64) -> Option<f64> {
    if b.is_nan() || b <= CRITICAL_IMPACT {
        return None;
    }
    let [u1, u2, u3] = turning_points(b);
    let m = (u2 - u1) / (u3 - u1);
    let start = (-u1 / (u2 - u1)).max(0.0).sqrt();
    let angle = 2.0 * (2.0 / (u3 - u1)).sqrt() * (elliptic_f(1.0, m) - elliptic_f(start, m));
    Some(angle - PI)
}

/// The angle about the hole that light goes through between two places, by way of its closest approach.
///
/// * `b`: impact parameter over the mass
/// * `r`: radial coordinates of the places over the mass
///
/// `None` where the light is captured, or does not come to one of the places.
pub fn swept_angle(b: f64, r: [f64; 2]) -> Option<f64> {
    let nearest = closest_approach(b)?;
    let [u1, u2, u3] = turning_points(b);
    let m = (u2 - u1) / (u3 - u1);
    let to_nearest = |r: f64| {
        let start = ((1.0 / r - u1) / (u2 - u1)).clamp(0.0, 1.0).sqrt();
        (2.0 / (u3 - u1)).sqrt() * (elliptic_f(1.0, m) - elliptic_f(start, m))
    };
    r.iter().all(|r| *r >= nearest).then(|| r.into_iter().map(to_nearest).sum())
}

/// How near such light comes, as a radial coordinate over the mass.
pub fn closest_approach(b: f64) -> Option<f64> {
    (b > CRITICAL_IMPACT).then(|| 1.0 / turning_points(b)[1])
}

/// The sine of the angle that the shadow subtends about the direction to the hole, for an observer at rest
/// [Synge 1966]: `sin² = 27 (1 - 2/r) / r²`. Inside of the orbit of light, r < 3, the shadow covers more than half the sky.
///
/// * `r`: the observer's radial coordinate over the mass, more than 2
pub fn shadow_sine(r: f64) -> f64 {
    (27.0 * (1.0 - 2.0 / r)).sqrt() / r
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(found: f64, expected: f64, relative: f64) {
        assert!((found / expected - 1.0).abs() < relative, "{found} instead of {expected}");
    }

    #[test]
    fn elliptic_integrals() {
        check(elliptic_rf(1.0, 2.0, 0.0), 1.311_028_777_146_06, 1e-13);
        check(elliptic_rf(2.0, 3.0, 4.0), 0.584_082_841_677_11, 1e-12);
        check(elliptic_f(1.0, 0.0), PI / 2.0, 1e-14);
    }

    #[test]
    fn light_is_deflected() {
        for (b, expected) in [
            (5.25f64, 4.194_799_71f64),
            (5.5, 2.553_020_18),
            (6.0, 1.719_388_31),
            (7.0, 1.127_639_10),
            (8.0, 0.858_730_02),
            (10.0, 0.590_395_79),
            (15.0, 0.336_365_73),
            (20.0, 0.236_136_00),
            (50.0, 0.085_083_45),
            (100.0, 0.041_222_54),
            (1000.0, 0.004_011_82),
            (6.167_567, PI / 2.0),
            (5.356_959, PI),
            (5.202_680, 2.0 * PI),
        ] {
            // The numbers have nine decimals; near the critical ray the last one of `b` counts much.
            let tolerance = if b < 5.21 { 1e-4 } else { 1e-6 + 1e-8 / expected };
            check(deflection(b).unwrap(), expected, tolerance);
        }
        check(closest_approach(10.0).unwrap(), 8.788_851, 1e-6);
        // Straight lines far away; the whole way is half a turn more than the deflection.
        let straight = PI - 2.0 * (1e4f64 / 1e6).asin();
        check(swept_angle(1e4, [1e6, 1e6]).unwrap(), straight + 4e-4, 1e-6);
        check(swept_angle(10.0, [1e12, 1e12]).unwrap(), PI + deflection(10.0).unwrap(), 1e-9);
        assert!(swept_angle(10.0, [8.0, 100.0]).is_none());
        assert!(deflection(5.19).is_none() && deflection(f64::NAN).is_none());
        // The strong field: a logarithm of the distance to the critical ray.
        let b = 5.2;
        let logarithm = -(b / CRITICAL_IMPACT - 1.0).ln() + (216.0 * (7.0 - 4.0 * 3f64.sqrt())).ln() - PI;
        check(logarithm, 6.8080, 1e-4);
        check(deflection(b).unwrap(), 6.8104, 1e-4);
        // The limb of the sun: 4 M/b, in seconds of arc.
        let (mass, radius) = (1.476_625, 695_700.0);
        check(deflection(radius / mass).unwrap() * 3600.0 * 180.0 / PI, 1.751_19, 1e-4);
    }

    #[test]
    fn shadows() {
        for (r, degrees) in [
            (4.0, 66.716_27),
            (6.0, 45.0),
            (10.0, 27.694_56),
            (20.0, 14.269_03),
            (100.0, 2.948_56),
            (1000.0, 0.297_42),
        ] {
            check(shadow_sine(r).asin().to_degrees(), degrees, 2e-5);
        }
    }
}
