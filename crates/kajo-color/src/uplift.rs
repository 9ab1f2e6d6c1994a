//! A smooth reflectance spectrum for three numbers.
//!
//! A parabola bent into [0, 1] by a sigmoid,
//!
//! ```text
//! f(λ) = S(c₀ x² + c₁ x + c₂),   S(p) = 1/2 + p / (2 √(1 + p²)),   x = (λ − 595 nm) / 235 nm
//! ```
//!
//! Its coefficients make the sensor see the wanted colour under D65. They are found by Newton's
//! method with Levenberg's damping from the grey in the middle; `S'(p) = (1 + p²)^(-3/2) / 2`.
//! Colours with a component of exactly 0 or 1 are limits that no finite coefficients reach; the search
//! stops when nothing improves, far below what the eye can tell.
//! [Jakob and Hanika 2019, eq. 4 to 8]

use kajo_math::Vec4;

use crate::Spectrum;
use crate::data::observer::{X, Y, Z};
use crate::illuminant::{D65, D65_SCALE, DAY_STEP_NM};
use crate::matrix::apply;
use crate::observer::{FIRST_NM, GAUSS, LAST_NM, LUMINANCE_NM, STEP_NM, line};
use crate::sensor::RGB_FROM_XYZ;

/// The middle and half the width of the visible range in nm.
const MIDDLE_NM: f64 = 0.5 * (FIRST_NM + LAST_NM);
const HALF_NM: f64 = 0.5 * (LAST_NM - FIRST_NM);

/// `|x|` up to which the formula holds, with room for rounding. Beyond the visible range, where lanes get by the Doppler effect alone, a
/// spectrum stays what it is at the end.
const VISIBLE: f32 = 1.000_01;

/// A spectrum with values in [0, 1] that has a given colour under D65.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Uplift {
    /// The same at every wavelength.
    Constant(f32),
    /// `c₀, c₁, c₂` of the module's formula.
    Sigmoid([f32; 3]),
}

impl Uplift {
    /// The spectrum of linear sRGB in [0, 1].
    pub(crate) fn of(rgb: [f32; 3]) -> Uplift {
        if rgb[0] == rgb[1] && rgb[1] == rgb[2] {
            return Uplift::Constant(rgb[0]);
        }
        Uplift::Sigmoid(fit(rgb.map(f64::from)).map(|c| c as f32))
    }

    /// The values at four wavelengths in nm.
    #[inline]
    pub(crate) fn at(&self, nm: [f32; 4]) -> Spectrum {
        match *self {
            Uplift::Constant(v) => Spectrum::grey(v),
            Uplift::Sigmoid([c0, c1, c2]) => {
                // All lanes in one step: numbers written one by one are slow to be read as four.
                let x = (Vec4::from_array(nm) - MIDDLE_NM as f32) * (1.0 / HALF_NM) as f32;
                let x = x.clamp(Vec4::splat(-VISIBLE), Vec4::splat(VISIBLE));
                let p = (c0 * x + c1) * x + c2;
                Spectrum::from(0.5 + 0.5 * p / (1.0 + p * p).sqrt())
            }
        }
    }
}

/// Stretches of an integral over the visible range in nm, with two Gauss points on each. Daylight is
/// straight and the observer smooth on a stretch.
const STRETCH_NM: f64 = 5.0;
const POINTS: usize = 2 * ((LAST_NM - FIRST_NM) / STRETCH_NM) as usize;

/// `x` of each point, and its share of linear RGB of white light on a white surface.
static RESPONSE: [(f64, [f64; 3]); POINTS] = {
    let (mut table, mut i) = ([(0.0, [0.0; 3]); POINTS], 0);
    while i < POINTS {
        let side = if i.is_multiple_of(2) { -GAUSS } else { GAUSS };
        let nm = FIRST_NM + STRETCH_NM * ((i / 2) as f64 + 0.5 + 0.5 * side);
        let light = 0.5 * STRETCH_NM * D65_SCALE / LUMINANCE_NM * line(&D65, DAY_STEP_NM, nm);
        let response = [line(&X, STEP_NM, nm), line(&Y, STEP_NM, nm), line(&Z, STEP_NM, nm)];
        let xyz = [light * response[0], light * response[1], light * response[2]];
        table[i] = ((nm - MIDDLE_NM) / HALF_NM, apply(&RGB_FROM_XYZ, xyz));
        i += 1;
    }
    table
};

/// What the sensor sees of a spectrum, and how that changes with its coefficients.
struct SensorResponse {
    rgb: [f64; 3],
    /// `slope[i][k]` = d rgb[i] / d c[k].
    slope: [[f64; 3]; 3],
}

fn sensor_response(c: [f64; 3]) -> SensorResponse {
    let mut response = SensorResponse { rgb: [0.0; 3], slope: [[0.0; 3]; 3] };
    for (x, weight) in &RESPONSE {
        let p = (c[0] * x + c[1]) * x + c[2];
        let r = 1.0 / (1.0 + p * p).sqrt();
        let (value, slope) = (0.5 + 0.5 * p * r, 0.5 * r * r * r);
        for (i, weight) in weight.iter().enumerate() {
            response.rgb[i] += weight * value;
            let by_c2 = weight * slope;
            response.slope[i][0] += by_c2 * x * x;
            response.slope[i][1] += by_c2 * x;
            response.slope[i][2] += by_c2;
        }
    }
    response
}

/// Coefficients for linear sRGB in [0, 1].
fn fit(rgb: [f64; 3]) -> [f64; 3] {
    const ENOUGH: f64 = 1e-14;
    let residual = |response: &SensorResponse| [0, 1, 2].map(|i| response.rgb[i] - rgb[i]);
    let square = |v: [f64; 3]| v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    let (mut c, mut damping) = ([0.0; 3], 1e-3);
    let mut response = sensor_response(c);
    for _ in 0..200 {
        let error = square(residual(&response));
        if error < ENOUGH || damping > 1e12 {
            break;
        }
        let next = step(c, &response.slope, residual(&response), damping);
        let there = sensor_response(next);
        if square(residual(&there)) < error {
            (c, response, damping) = (next, there, damping * 0.2);
        } else {
            damping *= 6.0;
        }
    }
    c
}

/// `c − (JᵀJ + damping diag JᵀJ)⁻¹ Jᵀ r`.
fn step(c: [f64; 3], j: &[[f64; 3]; 3], r: [f64; 3], damping: f64) -> [f64; 3] {
    let (mut normal, mut gradient) = ([[0.0; 3]; 3], [0.0; 3]);
    for k in 0..3 {
        for l in 0..3 {
            normal[k][l] = (0..3).map(|i| j[i][k] * j[i][l]).sum();
        }
        normal[k][k] *= 1.0 + damping;
        gradient[k] = (0..3).map(|i| j[i][k] * r[i]).sum();
    }
    let by = apply(&crate::matrix::inverse(&normal), gradient);
    [0, 1, 2].map(|k| c[k] - by[k])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_met_up_to_the_corners_of_the_cube() {
        let levels = [0.0, 0.003, 0.04, 0.2, 0.5, 0.8, 0.96, 1.0];
        let colours = levels.map(|r| levels.map(|g| levels.map(|b| [r, g, b])));
        for rgb in colours.as_flattened().as_flattened() {
            let found = sensor_response(fit(*rgb)).rgb;
            assert!((0..3).all(|i| (found[i] - rgb[i]).abs() < 1e-4), "{rgb:?}: {found:?}");
        }
    }

    #[test]
    fn slopes_are_the_changes_of_what_is_seen() {
        let c = [0.7, -1.3, 0.4];
        let slope = sensor_response(c).slope;
        for k in 0..3 {
            let moved = |by: f64| {
                let mut c = c;
                c[k] += by;
                sensor_response(c).rgb
            };
            let (up, down) = (moved(1e-5), moved(-1e-5));
            for i in 0..3 {
                let difference = (up[i] - down[i]) / 2e-5;
                assert!((slope[i][k] - difference).abs() < 1e-8, "{i} {k}: {} {difference}", slope[i][k]);
            }
        }
    }

    #[test]
    fn greys_are_flat() {
        assert_eq!(Uplift::of([0.3; 3]), Uplift::Constant(0.3));
        assert_eq!(Uplift::of([1.0; 3]).at([700.0; 4]), Spectrum::WHITE);
        let white = RESPONSE.iter().fold([0.0; 3], |sum, (_, w)| [0, 1, 2].map(|i| sum[i] + w[i]));
        for x in white {
            assert!((x - 1.0).abs() < 1e-5, "{white:?}");
        }
    }
}
