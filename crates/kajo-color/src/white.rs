//! White balance: which light the picture calls white.
//!
//! A light of chromaticity `(x, y)` becomes the white of sRGB by Bradford's adaptation of
//! [`gamut::adaptation`]. A temperature stands for daylight from 4000 K on and for a black body
//! below. A tint moves off that line at a right angle in the diagram of 1960,
//!
//! ```text
//! u = 4x / (12y − 2x + 3),   v = 6y / (12y − 2x + 3)
//! ```
//!
//! by `Duv` = tint / 3000: green above the line, magenta below it.
//! [CIE 015:2018, 9.4], [Ohno 2014]

use crate::emission::planck;
use crate::gamut::{self, SRGB, WHITE_D65, xy_of, xyz_of};
use crate::matrix::{Matrix3, product};
use crate::{illuminant, observer};

/// The linear sRGB of a picture in which light of chromaticity `xy` is white, from linear sRGB in which D65
/// is. A chromaticity that no light has, with `y` not positive, changes nothing.
pub fn balance_xy(xy: [f64; 2]) -> Matrix3 {
    let from = if xy[1] > 0.0 && xy[0].is_finite() && xy[1].is_finite() { xy } else { WHITE_D65 };
    let adapted = gamut::adaptation(xyz_of(from), xyz_of(WHITE_D65));
    product(&SRGB.rgb_from_xyz(), &product(&adapted, &SRGB.xyz_from_rgb()))
}

/// The same for a temperature in [1000, 25000] K, which is held to that range, and a tint in [-150, 150], also
/// held: positive where the light is green and the picture shall not be.
pub fn balance(kelvin: f64, tint: f64) -> Matrix3 {
    balance_xy(chromaticity(kelvin, tint))
}

/// Chromaticity of the light of a temperature and a tint, as in [`balance`].
pub fn chromaticity(kelvin: f64, tint: f64) -> [f64; 2] {
    let kelvin = if kelvin > 1000.0 { kelvin.min(25000.0) } else { 1000.0 };
    let line = if kelvin >= 4000.0 { illuminant::daylight_xy } else { black_body_xy };
    // A step along the line that does not leave its end.
    let (cool, warm) = if kelvin > 10000.0 { (kelvin, kelvin - 10.0) } else { (kelvin + 1.0, kelvin) };
    let (cool, warm, here) = (uv_of(line(cool)), uv_of(line(warm)), uv_of(line(kelvin)));
    let (du, dv) = (cool[0] - warm[0], cool[1] - warm[1]);
    let length = (du * du + dv * dv).sqrt();
    // From warm on the right to cool on the left, green lies to the right of the way.
    let beside = |duv: f64| xy_of_uv([here[0] + dv / length * duv, here[1] - du / length * duv]);
    let blue = |[x, y]: [f64; 2]| 1.0 - x - y;
    let mut duv = if tint.is_nan() { 0.0 } else { tint.clamp(-150.0, 150.0) / 3000.0 };
    // Warm light has little blue, and a tint that took most of it would not be a light.
    while blue(beside(duv)) < 0.5 * blue(beside(0.0)) {
        duv *= 0.5;
    }
    beside(duv)
}

/// Chromaticity of a black body.
fn black_body_xy(kelvin: f64) -> [f64; 2] {
    xy_of(observer::xyz(&[], |nm| planck(f64::from(nm), kelvin)))
}

/// Chromaticity from the coordinates of 1960.
fn xy_of_uv([u, v]: [f64; 2]) -> [f64; 2] {
    let sum = 2.0 * u - 8.0 * v + 4.0;
    [3.0 * u / sum, 2.0 * v / sum]
}

/// The coordinates of 1960.
fn uv_of([x, y]: [f64; 2]) -> [f64; 2] {
    let sum = 12.0 * y - 2.0 * x + 3.0;
    [4.0 * x / sum, 6.0 * y / sum]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::matrix::apply;

    #[test]
    fn the_light_becomes_white() {
        for xy in [[0.4476, 0.4074], [0.28, 0.29], [0.37, 0.45]] {
            let rgb = apply(&SRGB.rgb_from_xyz(), xyz_of(xy));
            for x in apply(&balance_xy(xy), rgb) {
                assert!((x - 1.0).abs() < 1e-9, "{xy:?}");
            }
        }
        for xy in [WHITE_D65, [0.3, 0.0], [f64::NAN, 0.3]] {
            let same = balance_xy(xy);
            assert!((0..3).all(|i| (0..3).all(|j| (same[i][j] - f64::from(i == j)).abs() < 1e-12)), "{xy:?}");
        }
    }

    #[test]
    fn temperatures_have_their_chromaticity() {
        // Black bodies by today's constants, daylight by its formula.
        for (kelvin, expected) in
            [(2855.5, [0.4476, 0.4074]), (6504.0, [0.3127, 0.3291]), (1000.0, [0.6528, 0.3445])]
        {
            let found = chromaticity(kelvin, 0.0);
            assert!((0..2).all(|i| (found[i] - expected[i]).abs() < 2e-4), "{kelvin}: {found:?}");
        }
        assert_eq!(chromaticity(f64::NAN, f64::NAN), chromaticity(1000.0, 0.0));
        assert_eq!(chromaticity(1e9, 1e9), chromaticity(25000.0, 150.0));
    }

    #[test]
    fn warm_light_is_cooled_and_green_light_reddened() {
        let grey = |m: Matrix3| apply(&m, [0.5; 3]);
        let [r, _, b] = grey(balance(3000.0, 0.0));
        assert!(r < 0.4 && b > 0.8, "{r} {b}");
        for kelvin in [1500.0, 2500.0, 3999.0, 4001.0, 6500.0, 12000.0] {
            let ([_, plain, _], [_, tinted, _]) = (grey(balance(kelvin, 0.0)), grey(balance(kelvin, 60.0)));
            assert!(tinted < 0.97 * plain && tinted > 0.5 * plain, "{kelvin}: {plain} {tinted}");
        }
    }
}
