//! From linear light of any strength to the values of a display.
//!
//! Scene light is linear and has no upper end; a display has. Every curve here takes linear sRGB, after
//! exposure and white balance, and gives values in [0, 1] *encoded for an sRGB display*; they are no longer
//! linear. [`Tone::Linear`] alone changes nothing.
//!
//! `Srgb` clips each component and encodes it. `Aces` is the reference rendering of the Academy
//! for screens of 100 nits, version 1, step by step as in the module `aces`. `Agx` is Troy Sobotka's: colours
//! are drawn towards grey by a matrix `A`, logarithms of base 2 from 10 stops below middle grey to 6.5 above
//! it go through a curve, and `A⁻¹` draws them apart again:
//!
//! ```text
//! t = (log₂(A rgb / 0.18) + 10) / 16.5
//! display = A⁻¹ (h s(t) + 1/2),   s(t) = x / (1 + xᵖ)^(1/p),   x = 2 (t − t₀) / h,   t₀ = 10 / 16.5
//! ```
//!
//! with `p` = 3 below `t₀` and 3.25 above it, and `h` such that the curve meets 0 and 1 at the ends.
//! [Sobotka 2022], [Wrensch 2023], who approximates the curve by a polynomial.

use kajo_math::fmath;

use crate::matrix::{Matrix3, apply_f32, inverse};
use crate::srgb::unit;
use crate::{aces, srgb};

/// How linear light is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tone {
    /// Not at all: linear values stay as they are.
    Linear,
    /// The curve of sRGB; what is brighter than white is clipped.
    #[default]
    Srgb,
    /// Film-like, with soft ends: ACES 1, the screen of 100 nits in a dim room.
    Aces,
    /// Film-like, and bright colours go to white: AgX.
    Agx,
}

impl Tone {
    /// All of them.
    pub const ALL: [Tone; 4] = [Tone::Linear, Tone::Srgb, Tone::Aces, Tone::Agx];

    /// The name as it is written in a scene or on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Tone::Linear => "linear",
            Tone::Srgb => "srgb",
            Tone::Aces => "aces",
            Tone::Agx => "agx",
        }
    }

    /// The curve called `name`.
    pub fn named(name: &str) -> Option<Tone> {
        Tone::ALL.into_iter().find(|tone| tone.name() == name)
    }

    /// Values for an sRGB display of linear sRGB. What is not a number counts as black, except in `Linear`.
    pub fn display(self, rgb: [f32; 3]) -> [f32; 3] {
        match self {
            Tone::Linear => rgb,
            Tone::Srgb => rgb.map(|v| srgb::encode(unit(v))),
            Tone::Aces => aces::display(rgb.map(finite)),
            Tone::Agx => agx(rgb.map(finite)),
        }
    }
}

/// The factor of an exposure in stops: `2^stops`.
pub fn exposure(stops: f32) -> f32 {
    fmath::exp(stops * std::f32::consts::LN_2)
}

/// `v` held to what half floats can hold; what is not a number is 0.
fn finite(v: f32) -> f32 {
    if v.is_nan() { 0.0 } else { v.clamp(-65504.0, 65504.0) }
}

/// What draws colours together.
const AGX_INSET: Matrix3 = [
    [0.842479062253094, 0.0784335999999992, 0.0792237451477643],
    [0.0423282422610123, 0.878468636469772, 0.0791661274605434],
    [0.0423756549057051, 0.0784336, 0.879142973793104],
];
const AGX_OUTSET: Matrix3 = inverse(&AGX_INSET);

fn agx(rgb: [f32; 3]) -> [f32; 3] {
    const LOWEST_STOP: f32 = -10.0;
    const STOPS: f32 = 16.5;
    const MIDDLE_GREY: f32 = 0.18;
    let stops = |v: f32| fmath::ln((v / MIDDLE_GREY).max(1e-10)) / std::f32::consts::LN_2;
    let drawn = apply_f32(&AGX_INSET, rgb.map(|v| v.max(0.0)));
    let curved = drawn.map(|v| agx_curve(unit((stops(v) - LOWEST_STOP) / STOPS)));
    apply_f32(&AGX_OUTSET, curved).map(unit)
}

/// The curve of the module's head for `t` in [0, 1].
fn agx_curve(t: f32) -> f32 {
    const PIVOT: f32 = 10.0 / 16.5;
    const SLOPE: f32 = 2.0;
    // What makes the curve meet 0 and 1: ((2 a)^-p ((4 a)^p - 1))^(-1/p), `a` the distance of the end.
    const TOE: f32 = 0.512_277_4;
    const SHOULDER: f32 = 0.541_464_15;
    let (power, scale) = if t < PIVOT { (3.0, -TOE) } else { (3.25, SHOULDER) };
    let x = SLOPE * (t - PIVOT) / scale;
    0.5 + scale * x / fmath::pow(1.0 + fmath::pow(x, power), 1.0 / power)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Linear sRGB and what OpenColorIO 2.6 makes of it: its built-in output transform of ACES 1.0 for
    /// video, and AgX from its own matrix, allocation and table operators.
    #[rustfmt::skip]
    const SHOWN: [([f32; 3], [f32; 3], [f32; 3]); 21] = [
        ([0.0, 0.0, 0.0], [0.0000, 0.0000, 0.0000], [0.0000, 0.0000, 0.0000]),
        ([0.0001, 0.0001, 0.0001], [0.0000, 0.0000, 0.0000], [0.0000, 0.0000, 0.0000]),
        ([0.01, 0.01, 0.01], [0.0128, 0.0128, 0.0128], [0.0961, 0.0962, 0.0962]),
        ([0.18, 0.18, 0.18], [0.3560, 0.3559, 0.3559], [0.4999, 0.5000, 0.5000]),
        ([0.5, 0.5, 0.5], [0.6472, 0.6472, 0.6472], [0.6771, 0.6772, 0.6772]),
        ([1.0, 1.0, 1.0], [0.8120, 0.8120, 0.8120], [0.7874, 0.7875, 0.7876]),
        ([4.0, 4.0, 4.0], [0.9553, 0.9553, 0.9553], [0.9377, 0.9378, 0.9379]),
        ([16.0, 16.0, 16.0], [0.9997, 0.9997, 0.9997], [0.9994, 0.9996, 0.9996]),
        ([100.0, 100.0, 100.0], [1.0000, 1.0000, 1.0000], [0.9998, 1.0000, 1.0000]),
        ([0.18, 0.02, 0.02], [0.2996, 0.0396, 0.0519], [0.5289, 0.1779, 0.1779]),
        ([0.02, 0.18, 0.02], [0.0000, 0.3479, 0.0520], [0.1928, 0.5197, 0.1929]),
        ([0.02, 0.02, 0.18], [0.0044, 0.0409, 0.3356], [0.1931, 0.1931, 0.5196]),
        ([1.0, 0.1, 0.05], [0.8143, 0.2756, 0.1698], [0.8320, 0.4380, 0.3612]),
        ([0.05, 1.0, 0.1], [0.3958, 0.8173, 0.3516], [0.4041, 0.8152, 0.4634]),
        ([0.1, 0.05, 1.0], [0.2212, 0.1333, 0.8211], [0.4639, 0.4043, 0.8171]),
        ([8.0, 0.5, 0.1], [1.0000, 0.8125, 0.5214], [1.0000, 0.7480, 0.6409]),
        ([0.2, 6.0, 0.3], [0.8892, 0.9775, 0.8069], [0.6992, 0.9893, 0.7222]),
        ([0.3, 0.4, 12.0], [0.8278, 0.6712, 1.0000], [0.7995, 0.8101, 1.0000]),
        ([0.05, 0.03, 0.02], [0.1212, 0.0749, 0.0468], [0.2850, 0.2083, 0.1602]),
        ([2.0, 1.5, 0.3], [0.9124, 0.8739, 0.6270], [0.8888, 0.8516, 0.6379]),
        ([0.8, 0.1, 0.9], [0.7921, 0.2563, 0.7937], [0.7654, 0.4754, 0.7852]),
    ];

    #[test]
    fn curves_are_those_of_opencolorio() {
        for (rgb, aces, agx) in SHOWN {
            for (tone, expected) in [(Tone::Aces, aces), (Tone::Agx, agx)] {
                let found = tone.display(rgb);
                assert!(
                    (0..3).all(|i| (found[i] - expected[i]).abs() < 3e-4),
                    "{tone:?} {rgb:?}: {found:?} {expected:?}"
                );
            }
        }
    }

    #[test]
    fn linear_is_linear_and_srgb_clips() {
        assert_eq!(Tone::Linear.display([-1.0, 0.5, 9.0]), [-1.0, 0.5, 9.0]);
        assert_eq!(Tone::Srgb.display([-1.0, 0.5, 9.0]), [0.0, srgb::encode(0.5), srgb::encode(1.0)]);
        assert!((exposure(3.0) - 8.0).abs() < 1e-5 && (exposure(-1.0) - 0.5).abs() < 1e-7);
    }

    #[test]
    fn greys_keep_their_order_and_odd_numbers_stay_in_range() {
        for tone in [Tone::Srgb, Tone::Aces, Tone::Agx] {
            let mut last = -1.0;
            for i in 0..400 {
                let shown = tone.display([exposure(-14.0 + 0.06 * i as f32); 3])[1];
                assert!(shown >= last, "{tone:?} {i}: {shown} {last}");
                last = shown;
            }
            for odd in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, -1.0, 1e-40] {
                for rgb in [[odd; 3], [odd, 0.5, 0.0], [0.0, odd, odd]] {
                    let shown = tone.display(rgb);
                    assert!(shown.iter().all(|v| (0.0..=1.0).contains(v)), "{tone:?} {rgb:?}: {shown:?}");
                }
            }
            assert_eq!(Tone::named(tone.name()), Some(tone));
        }
        assert_eq!(Tone::named("filmic"), None);
    }
}
