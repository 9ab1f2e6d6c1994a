//! Floats to whole numbers: the last step before an 8- or 16-bit file.
//!
//! With M = 255 or 65,535 a value v becomes
//!
//! ```text
//! nearest:   floor(clamp(v, 0, 1) · M + ½)
//! truncate:  floor(clamp(v, 0, 1) · M)
//! ```
//!
//! and a NaN becomes 0. Nearest is what the classic ray tracer writes, truncate what its
//! older relatives wrote (`mit-a2`). Both write linear values as they are; a picture meant
//! for a screen goes through the sRGB curve first.

use kajo_color::srgb;

/// How a value between two whole numbers is settled.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Rounding {
    /// To the nearest, halves up.
    #[default]
    Nearest,
    /// Down.
    Truncate,
}

/// The curve between the numbers of an [`Image`](crate::Image) and those in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Transfer {
    /// None: the file holds the image's own numbers.
    #[default]
    AsIs,
    /// The image is linear and the file holds its sRGB encoding; alpha stays as it is.
    Srgb,
}

/// Bits per stored sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum BitDepth {
    /// 0 to 255.
    #[default]
    Eight,
    /// 0 to 65,535.
    Sixteen,
}

impl BitDepth {
    /// The largest stored number, which stands for 1.
    pub fn max(self) -> u16 {
        match self {
            Self::Eight => 255,
            Self::Sixteen => u16::MAX,
        }
    }
}

/// A choice of curve and rounding; the default is the classic ray tracer's.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Quantiser {
    /// Curve applied to colour before rounding.
    pub transfer: Transfer,
    /// Rounding.
    pub rounding: Rounding,
}

impl Quantiser {
    /// The stored number of a colour value.
    pub fn colour(self, value: f32, depth: BitDepth) -> u16 {
        match self.transfer {
            Transfer::AsIs => self.linear(value, depth),
            Transfer::Srgb => self.linear(srgb::encode(value), depth),
        }
    }

    /// The stored number of an alpha or other value that no curve applies to.
    pub fn linear(self, value: f32, depth: BitDepth) -> u16 {
        let half = match self.rounding {
            Rounding::Nearest => 0.5,
            Rounding::Truncate => 0.0,
        };
        // The conversion floors, as its argument is not negative, and turns NaN into 0.
        // Single precision is part of the rule: 0.7 · 255 rounds up to 178.5 in it.
        (value.clamp(0.0, 1.0) * f32::from(depth.max()) + half) as u16
    }

    /// The value in [0, 1] that the colour `stored` stands for, in the image's numbers.
    pub fn value(self, stored: u16, depth: BitDepth) -> f32 {
        let value = f32::from(stored) / f32::from(depth.max());
        match self.transfer {
            Transfer::AsIs => value,
            Transfer::Srgb => srgb::decode(value),
        }
    }
}

/// `value` in [0, `max`]; NaN is 0, where `f32::clamp` would keep it.
pub(crate) fn clamp_or_zero(value: f32, max: f32) -> f32 {
    if value.is_nan() { 0.0 } else { value.clamp(0.0, max) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CLASSIC: Quantiser = Quantiser { transfer: Transfer::AsIs, rounding: Rounding::Nearest };
    const MIT_A2: Quantiser = Quantiser { transfer: Transfer::AsIs, rounding: Rounding::Truncate };
    const SCREEN: Quantiser = Quantiser { transfer: Transfer::Srgb, rounding: Rounding::Nearest };

    #[test]
    fn classic_values() {
        let stored = [0.1, 0.3, 0.7, 0.5, 1.5, -0.3, f32::NAN, f32::INFINITY, f32::NEG_INFINITY]
            .map(|v| CLASSIC.colour(v, BitDepth::Eight));
        assert_eq!(stored, [26, 77, 179, 128, 255, 0, 0, 255, 0]);
    }

    #[test]
    fn the_older_rule_rounds_down() {
        let stored = [0.5, 0.999, 1.0, -1.0, f32::NAN].map(|v| MIT_A2.colour(v, BitDepth::Eight));
        assert_eq!(stored, [127, 254, 255, 0, 0]);
    }

    #[test]
    fn sixteen_bits_keep_every_number() {
        for stored in 0..=u16::MAX {
            for q in [CLASSIC, SCREEN] {
                assert_eq!(q.colour(q.value(stored, BitDepth::Sixteen), BitDepth::Sixteen), stored, "{q:?}");
            }
        }
    }

    #[test]
    fn eight_bits_keep_every_number() {
        for stored in 0..=255 {
            for q in [CLASSIC, SCREEN] {
                assert_eq!(q.colour(q.value(stored, BitDepth::Eight), BitDepth::Eight), stored, "{q:?}");
            }
        }
    }

    #[test]
    fn the_srgb_curve_applies_to_colour_only() {
        assert_eq!(SCREEN.colour(0.214_041_14, BitDepth::Eight), 128);
        assert_eq!(SCREEN.linear(0.214_041_14, BitDepth::Eight), 55);
        assert_eq!(SCREEN.colour(f32::NAN, BitDepth::Eight), 0);
    }
}
