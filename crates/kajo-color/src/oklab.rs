//! Oklab: a space in which equal steps look about equally large [Ottosson 2020].
//!
//! Linear sRGB goes to the responses of three cones, of these to the third roots, and of those to lightness and two opponent colours.
//! Halfway between blue and yellow lies a grey that is as light as it looks, and between two hues no grey that neither has.

use kajo_math::fmath;

/// Lightness, green to red, and blue to yellow of a linear sRGB colour.
pub fn from_rgb(rgb: [f32; 3]) -> [f32; 3] {
    let roots = times(&CONES, rgb.map(f64::from)).map(|v| fmath::pow64(v.abs(), 1.0 / 3.0).copysign(v));
    times(&OPPONENTS, roots).map(|v| v as f32)
}

/// The linear sRGB colour of lightness, green to red, and blue to yellow.
pub fn to_rgb([l, a, b]: [f32; 3]) -> [f32; 3] {
    let roots = [
        l + 0.396_337_78 * a + 0.215_803_76 * b,
        l - 0.105_561_346 * a - 0.063_854_17 * b,
        l - 0.089_484_18 * a - 1.291_485_5 * b,
    ];
    let [l, m, s] = roots.map(|root| root * root * root);
    [
        4.076_741_7 * l - 3.307_711_6 * m + 0.230_969_94 * s,
        -1.268_438 * l + 2.609_757_4 * m - 0.341_319_4 * s,
        -0.004_196_086_3 * l - 0.703_418_6 * m + 1.707_614_7 * s,
    ]
}

/// From linear sRGB to cones.
const CONES: [[f64; 3]; 3] = [
    [0.412_221_470_8, 0.536_332_536_3, 0.051_445_992_9],
    [0.211_903_498_2, 0.680_699_545_1, 0.107_396_956_6],
    [0.088_302_461_9, 0.281_718_837_6, 0.629_978_700_5],
];

/// From the roots of these to lightness and opponents.
const OPPONENTS: [[f64; 3]; 3] = [
    [0.210_454_255_3, 0.793_617_785_0, -0.004_072_046_8],
    [1.977_998_495_1, -2.428_592_205_0, 0.450_593_709_9],
    [0.025_904_037_1, 0.782_771_766_2, -0.808_675_766_0],
];

fn times(matrix: &[[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
    matrix.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_have_the_published_values() {
        for (rgb, expected) in [
            ([1.0, 1.0, 1.0], [1.0, 0.0, 0.0]),
            ([1.0, 0.0, 0.0], [0.627_955, 0.224_863, 0.125_846]),
            ([0.0, 1.0, 0.0], [0.866_440, -0.233_888, 0.179_498]),
            ([0.0, 0.0, 1.0], [0.452_014, -0.032_457, -0.311_528]),
        ] {
            let found = from_rgb(rgb);
            assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 2e-5), "{rgb:?}: {found:?}");
        }
    }

    #[test]
    fn it_is_inverted() {
        for i in 0..1000 {
            let rgb = [i % 10, i / 10 % 10, i / 100].map(|v| v as f32 / 9.0);
            let back = to_rgb(from_rgb(rgb));
            assert!(back.iter().zip(rgb).all(|(a, b)| (a - b).abs() < 2e-5), "{rgb:?}: {back:?}");
        }
    }
}
