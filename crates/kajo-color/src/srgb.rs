//! The transfer curve of sRGB [IEC 61966-2-1].

use kajo_math::fmath;

/// Display value in [0, 1] of a linear value; below 0 and above 1 it is continued by its own formula.
pub fn encode(linear: f32) -> f32 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * fmath::pow(linear, 1.0 / 2.4) - 0.055 }
}

/// Linear value of a display value; the inverse of [`encode`].
pub fn decode(display: f32) -> f32 {
    if display <= 0.040_45 { display / 12.92 } else { fmath::pow((display + 0.055) / 1.055, 2.4) }
}

/// `v` held to [0, 1]; what is not a number is 0.
pub(crate) fn unit(v: f32) -> f32 {
    if v > 0.0 { v.min(1.0) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curve_is_inverted_and_meets_known_points() {
        for i in 0..=1000 {
            let x = i as f32 / 1000.0;
            assert!((decode(encode(x)) - x).abs() < 1e-6, "{x}");
        }
        assert!((encode(0.214_041_14) - 0.5).abs() < 1e-6);
        assert!(encode(0.0) == 0.0 && (encode(1.0) - 1.0).abs() < 1e-6);
    }
}
