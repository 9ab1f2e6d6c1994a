//! The magma colour map [Smith and van der Walt 2015, matplotlib, CC0].
//!
//! Brightness rises evenly from black over purple and orange to pale yellow, so that an
//! error map also reads in grey. Every eighth entry of the original 256 is kept (at equal
//! distances); between them the map is linear, within 1.3/255 of the original.

use crate::quantise::clamp_or_zero;

/// sRGB-encoded colours at 0, 1/32 .. 1.
const MAGMA: [[u8; 3]; 33] = [
    [0, 0, 4],
    [3, 3, 17],
    [10, 8, 34],
    [19, 13, 51],
    [29, 17, 70],
    [40, 17, 90],
    [54, 16, 106],
    [67, 15, 118],
    [80, 18, 124],
    [93, 23, 127],
    [105, 28, 129],
    [118, 33, 129],
    [130, 38, 129],
    [143, 42, 129],
    [156, 46, 127],
    [169, 50, 125],
    [182, 55, 121],
    [195, 59, 117],
    [207, 65, 112],
    [219, 72, 106],
    [230, 81, 99],
    [238, 92, 94],
    [245, 105, 92],
    [249, 120, 93],
    [251, 135, 97],
    [253, 150, 104],
    [254, 165, 113],
    [254, 180, 123],
    [254, 195, 135],
    [254, 209, 148],
    [253, 224, 162],
    [252, 238, 176],
    [252, 253, 191],
];

/// The sRGB-encoded colour of `t`, clamped to [0, 1]; NaN is 0.
pub fn magma(t: f32) -> [f32; 3] {
    let last = MAGMA.len() - 1;
    let position = clamp_or_zero(t, 1.0) * last as f32;
    let i = (position as usize).min(last - 1);
    let fraction = position - i as f32;
    std::array::from_fn(|c| {
        let [a, b] = [i, i + 1].map(|i| f32::from(MAGMA[i][c]));
        (a + (b - a) * fraction) / 255.0
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn matches_entries_of_the_original() {
        let original = [
            (0, [0, 0, 4]),
            (64, [81, 18, 124]),
            (100, [137, 40, 129]),
            (128, [183, 55, 121]),
            (200, [253, 152, 105]),
            (255, [252, 253, 191]),
        ];
        for (i, expected) in original {
            let colour = magma(i as f32 / 255.0);
            for c in 0..3 {
                assert!((colour[c] * 255.0 - expected[c] as f32).abs() < 1.8, "{i}: {colour:?}");
            }
        }
    }

    #[test]
    fn brightness_never_falls() {
        let luminance = |t: f32| {
            let [r, g, b] = magma(t).map(kajo_color::srgb::decode);
            0.2126 * r + 0.7152 * g + 0.0722 * b
        };
        for i in 0..1000 {
            assert!(luminance((i + 1) as f32 / 1000.0) > luminance(i as f32 / 1000.0), "{i}");
        }
    }

    #[test]
    fn values_outside_are_clamped() {
        assert_eq!(magma(-1.0), magma(0.0));
        assert_eq!(magma(f32::NAN), magma(0.0));
        assert_eq!(magma(f32::INFINITY), magma(1.0));
    }
}
