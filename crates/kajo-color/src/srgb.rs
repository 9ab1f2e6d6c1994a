//! The transfer curve of sRGB [IEC 61966-2-1].

use kajo_math::fmath;

/// Display value in [0, 1] of a linear value; below 0 and above 1 it is continued by its own formula. Off by at most 4e-7 in [0, 1].
pub fn encode(linear: f32) -> f32 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * fmath::pow(linear, 1.0 / 2.4) - 0.055 }
}

/// Linear value of a display value; the inverse of [`encode`]. Off by at most 8e-7 of itself in [0, 1].
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
    fn both_directions_are_as_exact_as_they_say() {
        for i in 1..=200_000u32 {
            // Closer to each other where it is dark.
            let v = (f64::from(i) / 200_000.0).powi(2) as f32;
            let x = f64::from(v);
            let exact = if v <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 };
            assert!((f64::from(encode(v)) - exact).abs() < 4e-7, "{v}");
            let exact = if v <= 0.040_45 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) };
            assert!((f64::from(decode(v)) / exact - 1.0).abs() < 8e-7, "{v}");
        }
    }

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
