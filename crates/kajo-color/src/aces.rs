//! The reference rendering of the Academy for a screen of 100 nits in a dim room.
//!
//! In the primaries AP0: a glow around saturated dark colours, and reds turned a little towards grey. In
//! AP1: 4 % of the saturation is given up, a spline of logarithms makes luminances of 10000 nits, another
//! brings them to 48 nits, and what the dim room asks for is corrected by `Y^0.9811` and 7 % of saturation.
//! Then Bradford's adaptation to D65, the primaries of sRGB, and its curve. This is
//! `RRT.ctl` followed by `ODT.Academy.RGBmonitor_100nits_dim.ctl` of ACES 1.0.3, not one of their fits.
//! [Academy 2017, ACES 1.0.3], [Academy TB-2014-004]

use kajo_math::fmath;

use crate::gamut::{ACES2065, ACESCG, SRGB};
use crate::matrix::{Matrix3, apply_f32};
use crate::srgb;

const AP0_FROM_SRGB: Matrix3 = ACES2065.from(&SRGB);
const AP1_FROM_AP0: Matrix3 = ACESCG.from(&ACES2065);
const SRGB_FROM_AP1: Matrix3 = SRGB.from(&ACESCG);
/// Luminance of AP1.
const LUMINANCE: [f64; 3] = ACESCG.xyz_from_rgb()[1];

/// Display values in [0, 1] of finite linear sRGB.
pub(crate) fn display(rgb: [f32; 3]) -> [f32; 3] {
    let aces = redden_less(glow(apply_f32(&AP0_FROM_SRGB, rgb)));
    let rendered = saturate(apply_f32(&AP1_FROM_AP0, aces.map(|v| v.max(0.0))).map(|v| v.max(0.0)), 0.96);
    let nits = rendered.map(|v| SCREEN.at(REFERENCE.at(v)));
    let shown = dim_room(nits.map(|v| (v - BLACK_NITS) / (WHITE_NITS - BLACK_NITS)));
    apply_f32(&SRGB_FROM_AP1, saturate(shown, 0.93)).map(|v| srgb::encode(srgb::unit(v)))
}

/// Mixes `rgb` of AP1 with its luminance.
fn saturate(rgb: [f32; 3], saturation: f32) -> [f32; 3] {
    let y = luminance(rgb);
    rgb.map(|v| saturation * v + (1.0 - saturation) * y)
}

fn luminance([r, g, b]: [f32; 3]) -> f32 {
    LUMINANCE[0] as f32 * r + LUMINANCE[1] as f32 * g + LUMINANCE[2] as f32 * b
}

/// The correction of contrast for a dim room, which leaves chromaticities alone.
fn dim_room(rgb: [f32; 3]) -> [f32; 3] {
    let y = luminance(rgb);
    let factor = if y > 0.0 { fmath::pow(y, 0.9811 - 1.0) } else { 0.0 };
    rgb.map(|v| v * factor)
}

/// How colourful a colour is, from 0 to about 1.
fn saturation([r, g, b]: [f32; 3]) -> f32 {
    let (most, least) = (r.max(g).max(b), r.min(g).min(b));
    (most.max(1e-10) - least.max(1e-10)) / most.max(1e-2)
}

/// Brightens saturated colours around black.
fn glow([r, g, b]: [f32; 3]) -> [f32; 3] {
    const MIDDLE: f32 = 0.08;
    let chroma = (b * (b - g) + g * (g - r) + r * (r - b)).max(0.0).sqrt();
    let yc = (b + g + r + 1.75 * chroma) / 3.0;
    let x = (saturation([r, g, b]) - 0.4) / 0.2;
    let t = (1.0 - (0.5 * x).abs()).max(0.0);
    let gain = 0.05 * 0.5 * (1.0 + x.signum() * (1.0 - t * t));
    let added = if yc <= 2.0 / 3.0 * MIDDLE {
        gain
    } else if yc >= 2.0 * MIDDLE {
        0.0
    } else {
        gain * (MIDDLE / yc - 0.5)
    };
    [r, g, b].map(|v| v * (1.0 + added))
}

/// Turns reds a little towards grey, most at hue 0 and not at all 67.5° from it.
fn redden_less([r, g, b]: [f32; 3]) -> [f32; 3] {
    const WIDTH: f32 = 135.0;
    let hue = fmath::atan2(3.0f32.sqrt() * (g - b), 2.0 * r - g - b).to_degrees();
    let at = (hue + 0.5 * WIDTH) * (4.0 / WIDTH);
    let weight = if r == g && g == b { 0.0 } else { 1.5 * cubic_spline(at) };
    [r + weight * saturation([r, g, b]) * (0.03 - r) * (1.0 - 0.82), g, b]
}

/// The uniform cubic B-spline over [0, 4].
fn cubic_spline(x: f32) -> f32 {
    let x = (x - 2.0).abs();
    if x < 1.0 {
        2.0 / 3.0 - x * x * (1.0 - 0.5 * x)
    } else {
        let rest = (2.0 - x).max(0.0);
        rest * rest * rest / 6.0
    }
}

const BLACK_NITS: f32 = 0.02;
const WHITE_NITS: f32 = 48.0;

/// A quadratic B-spline from logarithm to logarithm, of base 10, in two halves that meet at middle grey. A
/// straight line of slope `high_slope` follows; below there is nothing but the lowest value.
struct Spline<const N: usize> {
    /// Logarithms of the arguments at the low end, in the middle, at the high end.
    x: [f32; 3],
    low: [f32; N],
    high: [f32; N],
    /// Logarithms of the values at the ends.
    ends: [f32; 2],
    high_slope: f32,
}

/// From the light of the scene to 10000 nits: from 15 stops below middle grey to 18 above it.
const REFERENCE: Spline<5> = Spline {
    x: [-5.260_177_4, -0.744_727_5, 4.673_812_4],
    low: [-4.0, -4.0, -3.157_376_6, -0.485_25, 1.847_732_5],
    high: [-0.718_548_24, 2.081_030_7, 3.668_124, 4.0, 4.0],
    ends: [-4.0, 4.0],
    high_slope: 0.0,
};

/// From 10000 nits to 48, for what the other makes of 6.5 stops below and above middle grey.
const SCREEN: Spline<9> = Spline {
    x: [-2.540_624, 0.681_241_2, 3.002_476_8],
    low: [-1.698_97, -1.698_97, -1.4779, -1.2291, -0.8648, -0.448, 0.005_18, 0.451_108_03, 0.911_374_45],
    high: [0.515_438_7, 0.847_043_8, 1.1358, 1.3802, 1.5197, 1.5985, 1.6467, 1.674_609_1, 1.687_873_3],
    ends: [-1.698_97, 1.681_241_2],
    high_slope: 0.04,
};

impl<const N: usize> Spline<N> {
    fn at(&self, v: f32) -> f32 {
        use std::f32::consts::LN_10;
        let x = fmath::ln(v.max(1e-10)) / LN_10;
        let y = if x <= self.x[0] {
            self.ends[0]
        } else if x < self.x[1] {
            segment(&self.low, (x - self.x[0]) / (self.x[1] - self.x[0]))
        } else if x < self.x[2] {
            segment(&self.high, (x - self.x[1]) / (self.x[2] - self.x[1]))
        } else {
            self.ends[1] + (x - self.x[2]) * self.high_slope
        };
        fmath::exp(y * LN_10)
    }
}

/// One half of a spline at `t` in [0, 1).
fn segment<const N: usize>(coefficients: &[f32; N], t: f32) -> f32 {
    let at = t * (N - 2) as f32;
    let i = (at as usize).min(N - 3);
    let (a, b, c) = (coefficients[i], coefficients[i + 1], coefficients[i + 2]);
    let s = at - i as f32;
    ((0.5 * a - b + 0.5 * c) * s + (b - a)) * s + 0.5 * (a + b)
}
