//! Daylight and other lights that standards define by a formula.
//!
//! Daylight of correlated temperature `T` is a mean and two variations of it,
//!
//! ```text
//! S(λ) = S₀(λ) + M₁ S₁(λ) + M₂ S₂(λ)
//! x_D = 0.244063 + 0.09911e3/T + 2.9678e6/T² − 4.6070e9/T³      4000 K ≤ T ≤ 7000 K
//! x_D = 0.237040 + 0.24748e3/T + 1.9018e6/T² − 2.0064e9/T³      7000 K < T ≤ 25000 K
//! y_D = −3 x_D² + 2.870 x_D − 0.275
//! M₁ = (−1.3515 − 1.7703 x_D + 5.9114 y_D) / M,   M = 0.0241 + 0.2562 x_D − 0.7341 y_D
//! M₂ = (0.0300 − 31.4424 x_D + 30.0717 y_D) / M
//! ```
//!
//! with `M₁` and `M₂` rounded to three decimals. D65, the white of the sensor, is a standard of its own,
//! defined by its table. [CIE 015:2018, 4.1], [ISO/CIE 11664-2:2022]

pub(crate) use crate::data::daylight::D65;
use crate::data::daylight::{S0, S1, S2};
use crate::data::observer::{X, Y, Z};
use crate::observer::{FIRST_NM, GAUSS, LAST_NM, LUMINANCE_NM, NODES, STEP_NM, line, locate};
use crate::planck::black_body_shape;
use crate::tabulated::{Outside, Tabulated};

/// Distance of the nodes of daylight in nm.
pub(crate) const DAY_STEP_NM: f64 = 10.0;
/// How many there are.
const DAY_NODES: usize = S0.len();

/// `∫ D65 x̄ dλ / ∫ ȳ dλ` and so on, before scaling.
const D65_XYZ_RAW: [f64; 3] = [seen_by(&X), seen_by(&Y), seen_by(&Z)];

/// CIE XYZ of D65 of luminance 1.
pub(crate) const D65_XYZ: [f64; 3] = [D65_XYZ_RAW[0] / D65_XYZ_RAW[1], 1.0, D65_XYZ_RAW[2] / D65_XYZ_RAW[1]];

/// What scales [`D65`] to luminance 1.
pub(crate) const D65_SCALE: f64 = 1.0 / D65_XYZ_RAW[1];

/// D65 of luminance 1, as the inner loop reads it.
static D65_UNIT: [f32; DAY_NODES] = {
    let (mut table, mut i) = ([0.0; DAY_NODES], 0);
    while i < DAY_NODES {
        table[i] = (D65[i] * D65_SCALE) as f32;
        i += 1;
    }
    table
};

/// D65 of luminance 1 at a wavelength in nm: the spectrum of a light of colour 1 1 1.
#[inline]
pub fn d65(nm: f32) -> f32 {
    match locate(nm, DAY_STEP_NM, DAY_NODES) {
        Some((node, t)) => D65_UNIT[node] + t * (D65_UNIT[node + 1] - D65_UNIT[node]),
        None => 0.0,
    }
}

/// D65 as [`d65`] within its table, and outside of it a black body of its temperature that is as bright as the table at its end.
pub(crate) fn d65_continued(nm: f32) -> f32 {
    /// Correlated colour temperature of D65 in kelvin.
    const KELVIN: f32 = 6504.0;
    let (first, last) = (FIRST_NM as f32, LAST_NM as f32);
    let end = nm.clamp(first, last);
    if nm == end {
        return d65(nm);
    }
    d65(end) * (black_body_shape(nm, KELVIN) / black_body_shape(end, KELVIN))
}

/// `∫ D65 m dλ / ∫ ȳ dλ` of one colour matching function.
const fn seen_by(m: &[f64; NODES]) -> f64 {
    let (mut sum, mut i) = (0.0, 0);
    while i < NODES - 1 {
        let middle = FIRST_NM + STEP_NM * (i as f64 + 0.5);
        let (a, b) = (middle - 0.5 * GAUSS * STEP_NM, middle + 0.5 * GAUSS * STEP_NM);
        sum += line(&D65, DAY_STEP_NM, a) * line(m, STEP_NM, a);
        sum += line(&D65, DAY_STEP_NM, b) * line(m, STEP_NM, b);
        i += 1;
    }
    0.5 * sum * STEP_NM / LUMINANCE_NM
}

/// Daylight of a correlated colour temperature in [4000, 25000] K, which is held to that range; 100 at 560 nm.
pub fn daylight(kelvin: f64) -> Tabulated {
    let [x, y] = daylight_xy(kelvin);
    let m = 0.0241 + 0.2562 * x - 0.7341 * y;
    let thousandth = |v: f64| (v * 1000.0).round() / 1000.0;
    let m1 = thousandth((-1.3515 - 1.7703 * x + 5.9114 * y) / m);
    let m2 = thousandth((0.0300 - 31.4424 * x + 30.0717 * y) / m);
    let values: Vec<f64> = (0..DAY_NODES).map(|i| S0[i] + m1 * S1[i] + m2 * S2[i]).collect();
    Tabulated::regular(FIRST_NM, DAY_STEP_NM, &values, Outside::Zero)
}

/// Chromaticity of daylight of a temperature in [4000, 25000] K, which is held to that range.
pub fn daylight_xy(kelvin: f64) -> [f64; 2] {
    let t = 1e3 / kelvin.clamp(4000.0, 25000.0);
    let x = if t >= 1.0 / 7.0 {
        0.244063 + t * (0.09911 + t * (2.9678 - t * 4.6070))
    } else {
        0.237040 + t * (0.24748 + t * (1.9018 - t * 2.0064))
    };
    [x, -3.0 * x * x + 2.870 * x - 0.275]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gamut::xy_of;
    use crate::observer::{xyz, xyz_of};

    #[track_caller]
    fn check([x, y]: [f64; 2], expected: [f64; 2], tolerance: f64) {
        let off = (x - expected[0]).abs().max((y - expected[1]).abs());
        assert!(off < tolerance, "{x} {y} for {expected:?}");
    }

    #[test]
    fn d65_is_the_published_table() {
        // The standard prints a value every 5 nm; those between the nodes are their means.
        let published = [
            (360.0, 46.6383),
            (405.0, 87.1204),
            (495.0, 109.082),
            (560.0, 100.0),
            (645.0, 81.863),
            (815.0, 54.6998),
        ];
        for (nm, value) in published {
            let found = f64::from(d65(nm)) / D65_SCALE;
            assert!((found - value).abs() < 1e-3, "{nm}: {found}");
        }
        assert_eq!([d65(359.0), d65(831.0)], [0.0; 2]);
    }

    #[test]
    fn the_white_of_the_sensor_is_d65() {
        check(xy_of(D65_XYZ), [0.3127, 0.3290], 5e-5);
        let by_integral = xyz(&[], |nm| f64::from(d65(nm)));
        for (found, expected) in by_integral.into_iter().zip(D65_XYZ) {
            assert!((found - expected).abs() < 1e-6, "{by_integral:?}");
        }
    }

    #[test]
    fn daylights_have_their_published_colours() {
        // [CIE 015:2018, table 3]. Nominal temperatures are multiplied by 1.4388 / 1.4380.
        let published = [
            (5000.0, [0.34567, 0.35851]),
            (5500.0, [0.33243, 0.34744]),
            (6500.0, [0.31272, 0.32903]),
            (7500.0, [0.29903, 0.31488]),
        ];
        for (nominal, expected) in published {
            let kelvin = nominal * 1.4388 / 1.4380;
            check(xy_of(xyz_of(&daylight(kelvin))), expected, 1e-4);
            check(daylight_xy(kelvin), expected, 5e-4);
        }
        assert_eq!(daylight_xy(1.0), daylight_xy(4000.0));
        assert_eq!(daylight_xy(f64::INFINITY), daylight_xy(25000.0));
    }
}
