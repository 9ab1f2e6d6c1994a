//! Pictures of all directions, and drawing directions by their brightness.
//!
//! A picture's x runs over the longitude, its y over the angle from straight up:
//!
//! ```text
//! u = 1/2 + atan2(dx, -dz) / 2 pi,      v = acos(dy) / pi
//! ```
//!
//! so that its middle looks along -z, as the pictures of a `PanoramaCamera` do. Between the middles of pixels colours are
//! blended linearly. A direction is drawn by drawing a position of the picture, with a density in proportion to luminance times
//! `sin theta`, where `theta = pi v`; per solid angle that density is
//!
//! ```text
//! p(w) = p(u, v) / (2 pi^2 sin theta)
//! ```
//!
//! [Pharr et al. 2023, 12.5.2], with `p(u, v)` bilinear between the middles of pixels as the light is, and zero at the poles.
//!
//! Scene: `Background { environment sky.exr  rotate 30  scale 2 }`

use std::f32::consts::{FRAC_1_PI, PI, TAU};

use kajo_color::Spectrum;
use kajo_image::Image;
use kajo_math::bilinear::Bilinear2D;
use kajo_math::{Vec2, Vec3, fmath};

/// Part of the mean brightness of the picture and of its row that every position counts with at least, so that no light is left
/// undrawn, not even beside a sun that is brighter than single precision can tell from the sky.
const LEAST_SHARE: f32 = 1e-3;

/// The direction that a position of a picture shows, of unit length.
///
/// * `uv`: in [0, 1]², with (0, 0) at the top left
#[inline]
pub fn direction_of(uv: Vec2) -> Vec3 {
    let (sin_theta, cos_theta) = fmath::sin_cos(PI * uv.y);
    let (sin_phi, cos_phi) = fmath::sin_cos(TAU * (uv.x - 0.5));
    Vec3::new(sin_theta * sin_phi, cos_theta, -sin_theta * cos_phi)
}

/// The position of a picture that shows the direction `d`, not necessarily of unit length; in [0, 1]².
#[inline]
pub fn uv_of(d: Vec3) -> Vec2 {
    let horizontal = (d.x * d.x + d.z * d.z).sqrt();
    let u = 0.5 + fmath::atan2(d.x, -d.z) / TAU;
    Vec2::new(u, FRAC_1_PI * fmath::atan2(horizontal, d.y))
}

/// A position turned around by a share of the full circle; its x stays in [0, 1).
#[inline]
fn turned(uv: Vec2, by: f32) -> Vec2 {
    let x = uv.x + by;
    Vec2::new((x - x.floor()).min(1.0f32.next_down()), uv.y)
}

/// A picture of all directions.
#[derive(Debug)]
pub struct Environment {
    /// Linear sRGB without negative parts, row by row.
    pixels: Vec<Vec3>,
    width: usize,
    height: usize,
    /// By what share of the circle the picture is turned.
    turn: f32,
    is_black: bool,
    /// Over all directions.
    mean_luminance: f32,
    /// The mean of what is above that.
    above_mean: f32,
}

impl Environment {
    /// An environment of `scale` times the picture's linear sRGB, turned around the y axis.
    ///
    /// * `rotate_deg`: counterclockwise as seen from above
    ///
    /// Also returns how many pixels were negative or not finite; they are black.
    pub fn new(picture: &Image, scale: f32, rotate_deg: f32) -> (Environment, usize) {
        let mut unusable = 0;
        let mut is_black = true;
        let usable = |rgb: [f32; 3]| {
            let rgb = scale * Vec3::from(rgb);
            if rgb.is_finite() && rgb.min_element() >= 0.0 {
                is_black &= rgb == Vec3::ZERO;
                return rgb;
            }
            unusable += 1;
            Vec3::ZERO
        };
        let pixels: Vec<Vec3> = picture.rgb_pixels().map(usable).collect();
        let (width, height) = (picture.width() as usize, picture.height() as usize);
        // From above, with x to the right and -z upward, longitudes run clockwise.
        let turn = -rotate_deg.rem_euclid(360.0) / 360.0;
        let mean_luminance = luminance_above(&pixels, width, 0.0);
        let above_mean = luminance_above(&pixels, width, mean_luminance);
        (Environment { pixels, width, height, turn, is_black, mean_luminance, above_mean }, unusable)
    }

    /// An environment of these colours, linear sRGB without negative parts, by column and row.
    pub(crate) fn from_fn(width: usize, height: usize, color: impl Fn(usize, usize) -> Vec3) -> Environment {
        let pixels: Vec<Vec3> = (0..width * height).map(|i| color(i % width, i / width)).collect();
        let is_black = pixels.iter().all(|&rgb| rgb == Vec3::ZERO);
        let mean_luminance = luminance_above(&pixels, width, 0.0);
        let above_mean = luminance_above(&pixels, width, mean_luminance);
        Environment { pixels, width, height, turn: 0.0, is_black, mean_luminance, above_mean }
    }

    /// Linear RGB from the direction `d`, not necessarily of unit length.
    #[inline]
    pub fn color(&self, d: Vec3) -> Spectrum {
        let uv = turned(uv_of(d), -self.turn);
        let (x, y) = (uv.x * self.width as f32 - 0.5, uv.y * self.height as f32 - 0.5);
        let (left, top) = (x.floor(), y.floor());
        // Around the circle the picture goes on, at the poles it ends.
        let column = |i: isize| i.rem_euclid(self.width as isize) as usize;
        let row = |j: isize| j.clamp(0, self.height as isize - 1) as usize;
        let pixel = |i, j| Spectrum::from(self.pixels[row(j) * self.width + column(i)]);
        let (i, j, s, t) = (left as isize, top as isize, x - left, y - top);
        let upper = pixel(i, j).lerp(pixel(i + 1, j), s);
        upper.lerp(pixel(i, j + 1).lerp(pixel(i + 1, j + 1), s), t)
    }

    /// Whether the picture is black.
    pub fn is_black(&self) -> bool {
        self.is_black
    }

    /// The mean luminance of all directions.
    pub fn mean_luminance(&self) -> f32 {
        self.mean_luminance
    }

    /// The mean over all directions of what the luminance is above that mean.
    pub fn luminance_above_mean(&self) -> f32 {
        self.above_mean
    }

    /// The density in proportion to brightness; `None` for a black picture.
    ///
    /// * `weight`: which of the light counts
    pub fn density(&self, weight: DensityWeight) -> Option<SphereDensity> {
        let luminance = |x: usize, y: usize| Spectrum::from(self.pixels[y * self.width + x]).luminance();
        SphereDensity::new(self.width, self.height, self.turn, luminance, weight)
    }
}

/// The mean over all directions of what a picture's luminance is above a level.
fn luminance_above(pixels: &[Vec3], width: usize, level: f32) -> f32 {
    let (mut sum, mut weights) = (0.0, 0.0);
    let height = (pixels.len() / width.max(1)) as f32;
    for (y, row) in pixels.chunks(width.max(1)).enumerate() {
        let weight = f64::from(fmath::sin(PI * (y as f32 + 0.5) / height));
        let above = |&rgb: &Vec3| f64::from((Spectrum::from(rgb).luminance() - level).max(0.0));
        sum += weight * row.iter().map(above).sum::<f64>();
        weights += weight * row.len() as f64;
    }
    (sum / weights) as f32
}

/// Which light of a background directions are drawn by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DensityWeight {
    /// All of it.
    All,
    /// What is above the mean over all directions [Karlík et al. 2019, eq. 14].
    AboveMean,
}

/// A density over directions that is bilinear between the positions of a grid of longitudes and latitudes.
#[derive(Clone, Debug)]
pub struct SphereDensity {
    /// Its columns and rows of nodes are the middles of pixels. The first column is there again at the end, and before and
    /// after the rows, at half the distance, are the poles.
    positions: Bilinear2D,
    /// By what share of the circle the first column is turned.
    turn: f32,
}

impl SphereDensity {
    /// The density in proportion to the brightness in the middles of `width` times `height` pixels, blended between
    /// them; `None` where there is none.
    pub fn new(
        width: usize,
        height: usize,
        turn: f32,
        brightness: impl Fn(usize, usize) -> f32,
        weight: DensityWeight,
    ) -> Option<SphereDensity> {
        let mut values: Vec<f32> = (0..width * height).map(|i| brightness(i % width, i / width)).collect();
        let sum: f64 = values.iter().map(|&v| f64::from(v)).sum();
        if sum <= 0.0 {
            return None;
        }
        let least = LEAST_SHARE * (sum / values.len() as f64) as f32;
        let least: Vec<f32> = values
            .chunks(width)
            .map(|row| least.max(LEAST_SHARE * row.iter().sum::<f32>() / width as f32))
            .collect();
        let sines: Vec<f32> =
            (0..height).map(|y| fmath::sin(PI * (y as f32 + 0.5) / height as f32)).collect();
        if weight == DensityWeight::AboveMean {
            let all: f64 = sines.iter().map(|&sine| f64::from(sine)).sum();
            let rows = values.chunks(width).zip(&sines);
            let sum: f64 = rows
                .map(|(row, &sine)| f64::from(sine) * row.iter().map(|&v| f64::from(v)).sum::<f64>())
                .sum();
            let mean = (sum / (all * width as f64)) as f32;
            values.iter_mut().for_each(|value| *value = (*value - mean).max(0.0));
        }
        let node = |x: usize, row: usize| match row {
            pole if pole == 0 || pole > height => 0.0,
            _ => values[(row - 1) * width + x % width].max(least[row - 1]) * sines[row - 1],
        };
        let positions = Bilinear2D::new([width, height + 1], 0.5, node)?;
        Some(SphereDensity { positions, turn: turn + 0.5 / width as f32 })
    }

    /// A unit direction drawn with this density, and its density per solid angle.
    ///
    /// * `u`: uniform in [0, 1)²
    #[inline]
    pub fn sample(&self, u: Vec2) -> Option<(Vec3, f32)> {
        let (uv, pdf) = self.positions.sample(u);
        let pdf = pdf / solid_angle_per_area(uv);
        (pdf > 0.0 && pdf.is_finite()).then(|| (direction_of(turned(uv, self.turn)), pdf))
    }

    /// Density per solid angle of the unit direction `wi`.
    #[inline]
    pub fn pdf(&self, wi: Vec3) -> f32 {
        let uv = turned(uv_of(wi), -self.turn);
        let pdf = self.positions.pdf(uv) / solid_angle_per_area(uv);
        if pdf.is_finite() { pdf } else { 0.0 }
    }
}

/// Solid angle per area of the unit square of uv.
#[inline]
fn solid_angle_per_area(uv: Vec2) -> f32 {
    2.0 * PI * PI * fmath::sin(PI * uv.y)
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo_math::{rng::Stream, warp};
    use kajo_testkit::sphere;

    /// A dim sky with a bright spot and a black part.
    fn sky(rotate: f32) -> Environment {
        let picture = Image::from_fn(32, 16, |x, y| match (x, y) {
            (20, 5) => [300.0, 200.0, 100.0],
            (_, 10..) => [0.0; 3],
            _ => [0.2, 0.3, 0.1 * (1.0 + y as f32)],
        })
        .unwrap();
        Environment::new(&picture, 0.5, rotate).0
    }

    fn uniform(i: u32) -> Vec3 {
        let s = Stream::new(8, [i, 0], 0);
        warp::uniform_sphere(Vec2::new(s.uniform(0), s.uniform(1)))
    }

    #[test]
    fn places_and_directions_agree() {
        for i in 0..1000 {
            let d = uniform(i);
            assert!((direction_of(uv_of(3.0 * d)) - d).length() < 1e-5, "{d}");
        }
        assert_eq!(uv_of(Vec3::NEG_Z), Vec2::splat(0.5));
        // From the middle the right is to the right, and the top is up.
        assert!(uv_of(Vec3::X).abs_diff_eq(Vec2::new(0.75, 0.5), 1e-6));
        assert!(uv_of(Vec3::Y).y == 0.0 && uv_of(Vec3::NEG_Y).y == 1.0);
    }

    #[test]
    fn rotation_is_that_of_things() {
        let map = kajo_math::Mat3::from_rotation_y(70f32.to_radians());
        let (straight, turned) = (sky(0.0), sky(70.0));
        for i in 0..500 {
            let d = uniform(i);
            let (a, b) = (straight.color(d), turned.color(map * d));
            assert!((a - b).magnitude() < 2e-2 * (1.0 + a.magnitude()), "{d}: {a:?} {b:?}");
        }
    }

    #[test]
    fn pixels_are_seen_in_their_middles_and_blended_between() {
        let picture = Image::from_fn(4, 2, |x, y| [(x + 4 * y) as f32, 0.0, 0.0]).unwrap();
        let (map, unusable) = Environment::new(&picture, 2.0, 0.0);
        let at = |u: f32, v: f32| map.color(direction_of(Vec2::new(u, v)))[0];
        assert_eq!(unusable, 0);
        assert!((at(0.125, 0.25) - 0.0).abs() < 1e-4 && (at(0.875, 0.75) - 14.0).abs() < 1e-4);
        assert!((at(0.25, 0.25) - 1.0).abs() < 1e-4 && (at(0.375, 0.5) - 6.0).abs() < 1e-4);
        // Across the seam, and beyond the last row.
        assert!((at(0.0, 0.25) - 3.0).abs() < 1e-3 && (at(0.375, 0.99) - 10.0).abs() < 1e-3);
    }

    #[test]
    fn what_is_no_light_is_black() {
        let pixel = |x, _| [[f32::NAN, 1.0, 0.0], [1.0, -1.0, 0.0]][x as usize];
        let picture = Image::from_fn(2, 1, pixel).unwrap();
        let (map, unusable) = Environment::new(&picture, 1.0, 0.0);
        assert!(unusable == 2 && map.is_black() && map.density(DensityWeight::All).is_none());
        assert!(map.color(Vec3::X).is_black());
    }

    #[test]
    fn directions_follow_their_density() {
        for (i, map) in [sky(0.0), sky(200.0)].iter().enumerate() {
            let density = map.density(DensityWeight::All).unwrap();
            let drawn = |u: Vec2, _| density.sample(u).map(|(wi, _)| wi);
            let result = sphere::test(100_000, 30 + i as u64, drawn, |wi| density.pdf(wi));
            assert!(result.passes(0.01, 2), "{result:?}");
            for k in 0..1000 {
                let s = Stream::new(9, [k, 0], 0);
                let (wi, pdf) = density.sample(Vec2::new(s.uniform(0), s.uniform(1))).unwrap();
                assert!((density.pdf(wi) / pdf - 1.0).abs() < 1e-2, "{wi}");
            }
        }
    }

    /// The light is bilinear and so is the density: what a direction stands for is the same everywhere, but for the change of
    /// `sin theta` from row to row.
    #[test]
    fn the_light_over_its_density_is_even() {
        let sun = |x: u32, y: u32| if y == 20 && (x == 40 || x == 41) { 300.0f32 } else { 0.2 };
        let rough = |x: u32, y: u32| Stream::new(7, [x, y], 0).uniform(0) + 0.05;
        for brightness in [&sun as &dyn Fn(u32, u32) -> f32, &rough] {
            let picture = Image::from_fn(128, 64, |x, y| [brightness(x, y); 3]).unwrap();
            let map = Environment::new(&picture, 1.0, 25.0).0;
            let density = map.density(DensityWeight::All).unwrap();
            let weights = (0..4000).map(|k| {
                let s = Stream::new(12, [k, 0], 0);
                let (wi, pdf) = density.sample(Vec2::new(s.uniform(0), s.uniform(1))).unwrap();
                // Next to the poles a row is as wide as its distance from them.
                (wi.y.abs() < 0.97).then(|| map.color(wi).luminance() / pdf)
            });
            let weights: Vec<f32> = weights.flatten().collect();
            let mean = weights.iter().sum::<f32>() / weights.len() as f32;
            let worst = weights.iter().map(|w| (w / mean - 1.0).abs()).fold(0.0, f32::max);
            assert!(worst < 0.08, "{mean}: {worst}");
        }
    }

    /// Three above and one below: the mean is two, and a quarter of the light is above that.
    #[test]
    fn what_is_above_the_mean_is_drawn_alone() {
        let picture = Image::from_fn(64, 32, |_, y| [if y < 16 { 3.0 } else { 1.0 }; 3]).unwrap();
        let map = Environment::new(&picture, 1.0, 40.0).0;
        assert!((map.mean_luminance() - 2.0).abs() < 1e-5 && (map.luminance_above_mean() - 0.5).abs() < 1e-5);
        let [all, above] = [DensityWeight::All, DensityWeight::AboveMean].map(|by| map.density(by).unwrap());
        let share_above = |density: &SphereDensity| {
            let draw = |i: u32| {
                let s = Stream::new(17, [i, 0], 0);
                density.sample(Vec2::new(s.uniform(0), s.uniform(1))).unwrap().0
            };
            (0..4000).filter(|&i| draw(i).y > 0.0).count() as f64 / 4000.0
        };
        assert!((share_above(&all) - 0.75).abs() < 0.02 && share_above(&above) > 0.97);
        // A picture that is the same everywhere is drawn from evenly.
        let even = Environment::new(&Image::filled(8, 4, &[0.7; 3]).unwrap(), 1.0, 0.0).0;
        let even = (even.luminance_above_mean(), even.density(DensityWeight::AboveMean).unwrap());
        assert!(even.0 < 1e-6 && (even.1.pdf(Vec3::X) * 4.0 * PI - 1.0).abs() < 0.1, "{}", even.0);
    }

    #[test]
    fn drawing_by_brightness_finds_the_same_light_with_less_noise() {
        let map = sky(40.0);
        let density = map.density(DensityWeight::All).unwrap();
        let n = 200_000;
        let value = |d: Vec3| f64::from(map.color(d).luminance());
        let spread = |f: &dyn Fn(u32) -> f64| {
            let (mut sum, mut squares) = (0.0, 0.0);
            for i in 0..n {
                let v = f(i);
                sum += v;
                squares += v * v;
            }
            let mean = sum / f64::from(n);
            (mean, (squares / f64::from(n) - mean * mean) / f64::from(n))
        };
        let by_brightness = spread(&|i| {
            let s = Stream::new(10, [i, 0], 0);
            let (wi, pdf) = density.sample(Vec2::new(s.uniform(0), s.uniform(1))).unwrap();
            value(wi) / f64::from(pdf)
        });
        let everywhere = spread(&|i| value(uniform(i)) * 4.0 * std::f64::consts::PI);
        let sigma = (by_brightness.1 + everywhere.1).sqrt();
        assert!((by_brightness.0 - everywhere.0).abs() < 4.0 * sigma, "{by_brightness:?} {everywhere:?}");
        assert!(by_brightness.1 < everywhere.1 / 50.0, "{by_brightness:?} {everywhere:?}");
    }

    /// One pixel is the same light from everywhere, and so is one row or one column of a colour.
    #[test]
    fn the_smallest_pictures_have_their_density() {
        for (i, size) in [[1, 1], [1, 5], [7, 1], [2, 2]].into_iter().enumerate() {
            let picture = Image::from_fn(size[0], size[1], |_, _| [0.5; 3]).unwrap();
            let density = Environment::new(&picture, 1.0, 77.0).0.density(DensityWeight::All).unwrap();
            let drawn = |u: Vec2, _| density.sample(u).map(|(wi, _)| wi);
            let result = sphere::test(50_000, 50 + i as u64, drawn, |wi| density.pdf(wi));
            assert!(result.passes(0.01, 4), "{size:?}: {result:?}");
        }
    }

    #[test]
    fn nothing_that_shines_is_left_out() {
        let sun = |x: u32, y: u32| [if (x, y) == (1000, 3) { 1e9 } else { 1.0 }; 3];
        for map in [sky(0.0), Environment::new(&Image::from_fn(4096, 8, sun).unwrap(), 1.0, 0.0).0] {
            let density = map.density(DensityWeight::All).unwrap();
            for i in 0..20_000 {
                let d = uniform(i);
                assert!(map.color(d).is_black() || density.pdf(d) > 0.0, "{d}");
            }
        }
    }

    /// At the poles, on the seam, and for numbers at the ends of their range.
    #[test]
    fn densities_are_numbers_everywhere() {
        let map = sky(0.0);
        let density = map.density(DensityWeight::All).unwrap();
        let seam = [-1e-7, 0.0, 1e-7].map(|x| Vec3::new(x, 0.3, 1.0).normalize());
        for d in [Vec3::Y, Vec3::NEG_Y, Vec3::new(1e-20, 1.0, 0.0), seam[0], seam[1], seam[2]] {
            assert!(density.pdf(d).is_finite() && density.pdf(d) >= 0.0, "{d}");
        }
        assert!((density.pdf(seam[0]) / density.pdf(seam[2]) - 1.0).abs() < 1e-3);
        let last = 1.0f32.next_down();
        for u in [Vec2::ZERO, Vec2::splat(last), Vec2::new(0.0, last), Vec2::new(last, 0.0)] {
            if let Some((wi, pdf)) = density.sample(u) {
                assert!(wi.is_normalized() && pdf > 0.0 && pdf.is_finite(), "{u}: {wi} {pdf}");
            }
        }
    }
}
