//! ꟻLIP: the difference a person sees when two pictures alternate [Andersson et al. 2020].
//!
//! Per pixel, from 0 (none) to 1 (largest), with E_c the colour and E_f the feature error:
//!
//! ```text
//! E   = E_c ^ (1 - E_f)
//! E_c = g(HyAB(blurred reference, blurred test) ^ 0.7)
//! E_f = (max(|Δ edges|, |Δ points|) / √2) ^ ½
//! ```
//!
//! The blur stands for the eye's contrast sensitivity at a distance given in pixels per
//! degree; it acts in the opponent space Y C_x C_z. HyAB is the distance in L*a*b* that
//! suits large colour differences, here after the Hunt effect; g spreads it over [0, 1].
//! Edges and points are first and second derivatives of a Gaussian on Y. All kernels are
//! sums of products of one-dimensional ones and are applied so; borders repeat.
//!
//! Constants are those of the paper; the test values come from the authors' evaluator 1.7.

use std::f32::consts::{FRAC_1_SQRT_2, PI};

use kajo_color::srgb;
use kajo_math::fmath;

use super::check_same_size;
use crate::quantise::clamp_or_zero;
use crate::{Image, ImageError};

/// The authors' viewing conditions: a screen of 3840 pixels and 0.7 m seen from 0.7 m.
pub const DEFAULT_PIXELS_PER_DEGREE: f32 = 3840.0 * PI / 180.0;

/// Below, the feature detector is too narrow for single precision; above, wider than screens.
const PIXELS_PER_DEGREE: std::ops::RangeInclusive<f32> = 5.0..=1000.0;

/// Exponents of the colour and of the feature error.
const QC: f32 = 0.7;
const QF: f32 = 0.5;
/// Colour errors up to the share PC of the largest fill the range up to PT.
const PC: f32 = 0.4;
const PT: f32 = 0.95;
/// Width of the eye's feature detector in degrees.
const FEATURE_WIDTH: f32 = 0.082;
/// Contrast sensitivities of Y, C_x and C_z: weights a and widths b of up to two Gaussians.
const SENSITIVITY: [&[(f32, f32)]; 3] = [&[(1.0, 0.0047)], &[(1.0, 0.0053)], &[(34.1, 0.04), (13.5, 0.025)]];
/// The widest b above decides the radius of all blurs.
const WIDEST: f32 = 0.04;

/// The error map: `height × width × 1`, values in [0, 1].
///
/// * `reference`, `test`: sRGB-encoded values, clamped to [0, 1]; NaN is black, alpha ignored
/// * `pixels_per_degree`: of the viewer's field of view, 5 to 1000
///
/// # Errors
/// [`ImageError::Parameter`] when sizes differ or `pixels_per_degree` is out of range.
pub fn flip(reference: &Image, test: &Image, pixels_per_degree: f32) -> Result<Image, ImageError> {
    check_same_size(reference, test)?;
    if !PIXELS_PER_DEGREE.contains(&pixels_per_degree) {
        return Err(ImageError::parameter(format!(
            "{pixels_per_degree} pixels per degree are not 5 to 1000"
        )));
    }
    let seen = [reference, test].map(|image| PerceivedImage::new(image, pixels_per_degree));
    let max_distance = max_distance();
    let data = seen[0].pixels.iter().zip(&seen[1].pixels).map(|(r, x)| error(r, x, max_distance)).collect();
    Image::from_data(reference.width(), reference.height(), 1, data)
}

/// What the eye makes of one pixel.
struct Percept {
    /// Blurred colour in L*a*b* after the Hunt effect.
    lab: [f32; 3],
    /// Strength of an edge here.
    edge: f32,
    /// Strength of a point or line here.
    point: f32,
}

/// A picture as the eye sees it.
struct PerceivedImage {
    pixels: Vec<Percept>,
}

impl PerceivedImage {
    fn new(image: &Image, pixels_per_degree: f32) -> Self {
        let [y, cx, cz] = opponent_planes(image);
        let grey = Plane { values: y.values.iter().map(|y| (y + 16.0) / 116.0).collect(), ..y };
        let (edges, points) = features(&grey, pixels_per_degree);
        let mut planes =
            [y, cx, cz].into_iter().zip(SENSITIVITY).map(|(p, s)| blur(&p, s, pixels_per_degree));
        let [y, cx, cz] = std::array::from_fn(|_| planes.next().map_or(Vec::new(), |p| p.values));
        let pixels = (0..y.len())
            .map(|i| Percept { lab: hunt_lab([y[i], cx[i], cz[i]]), edge: edges[i], point: points[i] })
            .collect();
        Self { pixels }
    }
}

fn error(r: &Percept, x: &Percept, max_distance: f32) -> f32 {
    let colour = spread(fmath::pow(hyab(r.lab, x.lab), QC), max_distance);
    let feature = (r.edge - x.edge).abs().max((r.point - x.point).abs());
    let feature = fmath::pow((FRAC_1_SQRT_2 * feature).min(1.0), QF);
    fmath::pow(colour, 1.0 - feature).clamp(0.0, 1.0)
}

/// Maps [0, PC · max] to [0, PT] and the rest to [PT, 1] [Andersson et al. 2020, sec. 4.1.3].
fn spread(distance: f32, max: f32) -> f32 {
    let knee = PC * max;
    if distance < knee { PT / knee * distance } else { PT + (distance - knee) / (max - knee) * (1.0 - PT) }
}

/// The largest HyAB distance in sRGB, between green and blue, to the power QC.
fn max_distance() -> f32 {
    let lab = |rgb| hunt(lab(xyz(rgb)));
    fmath::pow(hyab(lab([0.0, 1.0, 0.0]), lab([0.0, 0.0, 1.0])), QC)
}

// Colour spaces. White is that of the matrix: the image of (1, 1, 1).

const XYZ_FROM_RGB: [[f32; 3]; 3] = [
    [0.412_386_56, 0.357_591_49, 0.180_450_49],
    [0.212_636_82, 0.715_182_98, 0.072_180_2],
    [0.019_330_62, 0.119_197_16, 0.950_372_6],
];
const RGB_FROM_XYZ: [[f32; 3]; 3] = [
    [3.241_003_3, -1.537_398_9, -0.498_615_86],
    [-0.969_224_33, 1.875_930_1, 0.041_554_224],
    [0.055_639_423, -0.204_011_2, 1.057_148_9],
];
const WHITE: [f32; 3] = [0.950_428_55, 1.0, 1.088_900_4];

fn transform(m: &[[f32; 3]; 3], v: [f32; 3]) -> [f32; 3] {
    m.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

fn xyz(rgb: [f32; 3]) -> [f32; 3] {
    transform(&XYZ_FROM_RGB, rgb)
}

/// Y C_x C_z: L*a*b* without its cube root.
fn opponent(xyz: [f32; 3]) -> [f32; 3] {
    let [x, y, z] = std::array::from_fn(|i| xyz[i] / WHITE[i]);
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

fn xyz_from_opponent([y, cx, cz]: [f32; 3]) -> [f32; 3] {
    let y = (y + 16.0) / 116.0;
    [(y + cx / 500.0) * WHITE[0], y * WHITE[1], (y - cz / 200.0) * WHITE[2]]
}

fn lab(xyz: [f32; 3]) -> [f32; 3] {
    const DELTA: f32 = 6.0 / 29.0;
    let f = |t: f32| {
        if t > DELTA * DELTA * DELTA {
            fmath::pow(t, 1.0 / 3.0)
        } else {
            t / (3.0 * DELTA * DELTA) + 4.0 / 29.0
        }
    };
    let [x, y, z] = std::array::from_fn(|i| f(xyz[i] / WHITE[i]));
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// The Hunt effect: colours of dark areas look less colourful.
fn hunt([l, a, b]: [f32; 3]) -> [f32; 3] {
    [l, 0.01 * l * a, 0.01 * l * b]
}

fn hunt_lab(opponent: [f32; 3]) -> [f32; 3] {
    let rgb = transform(&RGB_FROM_XYZ, xyz_from_opponent(opponent));
    hunt(lab(xyz(rgb.map(|v| v.clamp(0.0, 1.0)))))
}

/// City-block in lightness, Euclidean in colour.
fn hyab(p: [f32; 3], q: [f32; 3]) -> f32 {
    let [l, a, b] = std::array::from_fn(|i| p[i] - q[i]);
    l.abs() + (a * a + b * b).sqrt()
}

fn opponent_planes(image: &Image) -> [Plane; 3] {
    let width = image.width() as usize;
    let mut planes =
        std::array::from_fn(|_| Plane { width, values: Vec::with_capacity(image.pixels().len()) });
    for rgb in image.rgb_pixels() {
        let linear = rgb.map(|v| srgb::decode(clamp_or_zero(v, 1.0)));
        for (plane, value) in planes.iter_mut().zip(opponent(xyz(linear))) {
            plane.values.push(value);
        }
    }
    planes
}

// Filters.

/// One value per pixel.
struct Plane {
    width: usize,
    values: Vec<f32>,
}

impl Plane {
    /// Filters along rows; the first and last pixel of a row repeat beyond it.
    fn filter_rows(&self, kernel: &[f32]) -> Self {
        let radius = kernel.len() / 2;
        let mut padded = vec![0.0; self.width + 2 * radius];
        let mut values = vec![0.0; self.values.len()];
        for (row, out) in self.values.chunks_exact(self.width).zip(values.chunks_exact_mut(self.width)) {
            padded[..radius].fill(row[0]);
            padded[radius..radius + self.width].copy_from_slice(row);
            padded[radius + self.width..].fill(row[self.width - 1]);
            for (i, k) in kernel.iter().enumerate() {
                out.iter_mut().zip(&padded[i..]).for_each(|(o, v)| *o += k * v);
            }
        }
        Self { width: self.width, values }
    }

    /// Filters along columns; the first and last row repeat.
    fn filter_columns(&self, kernel: &[f32]) -> Self {
        let height = self.values.len() / self.width;
        let radius = kernel.len() / 2;
        let mut values = vec![0.0; self.values.len()];
        for (y, out) in values.chunks_exact_mut(self.width).enumerate() {
            for (i, k) in kernel.iter().enumerate() {
                let row = (y + i).saturating_sub(radius).min(height - 1) * self.width;
                out.iter_mut().zip(&self.values[row..row + self.width]).for_each(|(o, v)| *o += k * v);
            }
        }
        Self { width: self.width, values }
    }
}

/// Blurs with the sum of the given Gaussians, scaled so that all weights together are one.
fn blur(plane: &Plane, gaussians: &[(f32, f32)], pixels_per_degree: f32) -> Plane {
    let radius = (3.0 * (WIDEST / (2.0 * PI * PI)).sqrt() * pixels_per_degree).ceil();
    // Each Gaussian a √(π/b) exp(-π² d² / b), d in degrees, splits into one in x and one
    // in y; its share of the whole is the square of the sum of either.
    let kernels = gaussians.iter().map(|&(a, b)| {
        let kernel = kernel(radius, |x| {
            let d = x / pixels_per_degree;
            fmath::exp(-PI * PI * d * d / b)
        });
        let sum: f32 = kernel.iter().sum();
        (kernel, a * (PI / b).sqrt() * sum * sum, sum)
    });
    let kernels: Vec<_> = kernels.collect();
    let total: f32 = kernels.iter().map(|(_, share, _)| share).sum();
    let mut blurred = Plane { width: plane.width, values: vec![0.0; plane.values.len()] };
    for (kernel, share, sum) in kernels {
        let unit: Vec<f32> = kernel.iter().map(|k| k / sum).collect();
        let part = plane.filter_rows(&unit).filter_columns(&unit);
        let weight = share / total;
        blurred.values.iter_mut().zip(part.values).for_each(|(b, p)| *b += weight * p);
    }
    blurred
}

/// Strengths of edges and of points per pixel: lengths of the filtered gradient.
fn features(grey: &Plane, pixels_per_degree: f32) -> (Vec<f32>, Vec<f32>) {
    let sd = 0.5 * FEATURE_WIDTH * pixels_per_degree;
    let radius = (3.0 * sd).ceil();
    let gaussian = |x: f32| fmath::exp(-x * x / (2.0 * sd * sd));
    let smooth = balanced(kernel(radius, gaussian));
    let strength = |derivative: Vec<f32>| {
        let dx = grey.filter_rows(&derivative).filter_columns(&smooth);
        let dy = grey.filter_columns(&derivative).filter_rows(&smooth);
        dx.values.iter().zip(&dy.values).map(|(x, y)| (x * x + y * y).sqrt()).collect()
    };
    let edges = strength(balanced(kernel(radius, |x| -x * gaussian(x))));
    let points = strength(balanced(kernel(radius, |x| (x * x / (sd * sd) - 1.0) * gaussian(x))));
    (edges, points)
}

/// `f` at whole numbers from `-radius` to `radius`.
fn kernel(radius: f32, f: impl Fn(f32) -> f32) -> Vec<f32> {
    let radius = radius as i32;
    (-radius..=radius).map(|x| f(x as f32)).collect()
}

/// Scales so that the positive weights sum to 1 and the negative ones, if any, to -1.
fn balanced(mut kernel: Vec<f32>) -> Vec<f32> {
    let positive: f32 = kernel.iter().map(|k| k.max(0.0)).sum();
    let negative: f32 = kernel.iter().map(|k| (-k).max(0.0)).sum();
    for k in &mut kernel {
        *k /= if *k < 0.0 { negative } else { positive };
    }
    kernel
}

#[cfg(test)]
mod tests {
    use super::super::mean;
    use super::super::test_pairs::{PAIRS, Pair};
    use super::*;

    #[test]
    fn agrees_with_the_authors_evaluator() {
        for Pair { name, flip: expected, flip_at_30_ppd, largest, inner, .. } in PAIRS {
            let (reference, test) = Pair::images(name);
            let map = flip(&reference, &test, DEFAULT_PIXELS_PER_DEGREE).unwrap();
            let close = |what, a: f64, b: f64| assert!((a - b).abs() < 1e-4, "{name} {what}: {a} {b}");
            close("mean", mean(&map), expected);
            close("largest", map.data().iter().copied().fold(0.0, f32::max).into(), largest);
            close("inner", map.pixel(map.width() / 3, map.height() / 4)[0].into(), inner);
            close("30 ppd", mean(&flip(&reference, &test, 30.0).unwrap()), flip_at_30_ppd);
        }
    }

    #[test]
    fn equal_pictures_have_no_error_and_order_does_not_matter() {
        for pair in PAIRS {
            let (a, b) = Pair::images(pair.name);
            assert!(flip(&a, &a, 67.0).unwrap().data().iter().all(|&e| e == 0.0));
            assert_eq!(flip(&a, &b, 67.0).unwrap(), flip(&b, &a, 67.0).unwrap());
        }
    }

    #[test]
    fn any_floats_give_errors_between_zero_and_one() {
        let wild = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -3.0, 7.0, 0.0, 1.0];
        let image = |k| Image::from_fn(9, 8, |x, y| [wild[((x * 3 + y * 5 + k) % 7) as usize]; 3]).unwrap();
        for ppd in [5.0, 67.0, 1000.0] {
            let map = flip(&image(0), &image(1), ppd).unwrap();
            assert!(map.data().iter().all(|e| (0.0..=1.0).contains(e)), "{ppd}");
        }
    }

    #[test]
    fn absurd_distances_are_refused() {
        let image = Image::new(1, 1, 1).unwrap();
        for ppd in [0.0, -1.0, f32::NAN, f32::INFINITY, 4.9, 1001.0] {
            assert!(flip(&image, &image, ppd).is_err(), "{ppd}");
        }
    }
}
