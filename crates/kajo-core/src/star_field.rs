//! Stars: points of light before any other surroundings.
//!
//! A star of the illuminance `E` is a small disc of the angular radius `r`, soft at its rim,
//!
//! ```text
//! L(h) = 3 E / (2 pi H) (1 - h/H)^2,     h = 1 - cos θ < H = 1 - cos r
//! ```
//!
//! whose light over all directions is `E` exactly, and what bends light between them and the camera makes them larger, and thereby
//! brighter, as it does. Stars are black bodies, of 64 temperatures.
//!
//! A pixel that is larger than a star would see it now and then. So a path that knows what its pixel covers of the sky, the vectors `a` and `b`
//! between directions of neighbouring pixels, sees the same star as an ellipse that is at least some `k` pixels large,
//!
//! ```text
//! L(x) = 3 E / (pi sqrt(det M)) (1 - x' M^-1 x)^2,     M = 2 H I + k^2 (a a' + b b')
//! ```
//!
//! with the same light in all. Where gravity magnifies the sky `det M` is small and the star is bright, as large in the picture as
//! any other; pictures hold still where stars drift over pixels [James et al. 2015, A.2.2].
//!
//! Each star is listed in the squares of six faces of a cube that its disc may touch; a direction asks those of one square, and a pixel
//! those of its reach.
//!
//! Scene: `Background { stars { count 9000  galaxy 0.5 } }`

use std::f32::consts::{PI, TAU};
use std::fmt;

use kajo_color::{Emission, Spectrum, Wavelengths};
use kajo_math::rng::Stream;
use kajo_math::{Frame, Vec2, Vec3, fmath};

use crate::differential::SkyFootprint;

/// A point of light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Star {
    /// Unit direction to it.
    pub direction: Vec3,
    /// How bright it is: 0 for Vega, and a factor of 10^-0.4 for each further one.
    pub magnitude: f32,
    /// Of its light, in K.
    pub temperature: f32,
}

/// How stars are strewn that no catalogue lists.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StarDraw {
    /// How many there are.
    pub count: u32,
    /// Other numbers make other skies.
    pub seed: u32,
    /// Magnitude of the faintest ones.
    pub faintest: f32,
    /// The share that is in a band around the sky.
    pub galaxy: f32,
    /// Unit direction to the pole of that band.
    pub pole: Vec3,
}

/// Illuminance of a star of magnitude 0 in lux.
pub const VEGA: f32 = 2.54e-6;

/// The largest angular radius of a star, in radians.
pub const LARGEST_RADIUS: f32 = 0.1;

/// How much a magnitude counts: illuminance falls to 1/100 in five of them.
const MAGNITUDE: f32 = 0.4 * std::f32::consts::LN_10;

/// Temperatures of stars, each by the same factor from the one before it.
const COLORS: usize = 64;
const COOLEST: f32 = 2000.0;
const HOTTEST: f32 = 40_000.0;

/// The stars around a scene.
#[derive(Debug)]
pub struct StarField {
    stars: Vec<PlacedStar>,
    /// Sums of the illuminances up to each star.
    sums: Vec<f64>,
    /// `H = 1 - cos r` of the angular radius.
    height: f32,
    /// Luminance in the middle of a disc over its illuminance, `3 / (2 pi H)`.
    peak: f32,
    /// Radius in pixels that none is smaller than, where it is known what a pixel covers.
    pixels: f32,
    /// Squares along the edge of a face.
    side: usize,
    /// Where the stars of each square begin in `listed`, and where the last ones end.
    starts: Vec<u32>,
    /// Indices of stars, square by square.
    listed: Vec<u32>,
    /// Of luminance 1.
    colors: Vec<Emission>,
}

#[derive(Clone, Copy, Debug)]
struct PlacedStar {
    direction: Vec3,
    illuminance: f32,
    color: u8,
    /// The square that it is in.
    square: u32,
}

/// Why a catalogue lists no stars.
#[derive(Clone, Debug, PartialEq)]
pub struct StarCatalogError {
    /// Which line, from 1 on.
    line: usize,
    reason: &'static str,
}

impl fmt::Display for StarCatalogError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}: {}", self.line, self.reason)
    }
}

/// The stars of a text, one a line: right ascension and declination in degrees, magnitude, and, if it is known, temperature in K, with blanks or
/// commas between them. `#` begins a comment.
///
/// Declination 90 is up, +y, and right ascension 0 is -z; it grows to the left, as seen from within.
///
/// # Errors
///
/// The first line that is no star.
pub fn parse_stars(text: &str) -> Result<Vec<Star>, StarCatalogError> {
    let mut stars = Vec::new();
    for (i, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or("");
        let words = line.split(|c: char| c.is_whitespace() || c == ',').filter(|word| !word.is_empty());
        let numbers: Vec<Option<f64>> = words.map(|word| word.parse().ok()).collect();
        let error = |reason| StarCatalogError { line: i + 1, reason };
        let (ascension, declination, magnitude, temperature) = match numbers[..] {
            [] => continue,
            [Some(a), Some(d), Some(m)] => (a, d, m, 6500.0),
            [Some(a), Some(d), Some(m), Some(t)] => (a, d, m, t),
            _ => {
                return Err(error(
                    "a star has right ascension, declination, magnitude and perhaps a temperature",
                ));
            }
        };
        if !(ascension.is_finite() && (-90.0..=90.0).contains(&declination)) {
            return Err(error("angles are in degrees, and declinations lie between -90 and 90"));
        }
        if !((-30.0..=30.0).contains(&magnitude) && temperature > 0.0 && temperature.is_finite()) {
            return Err(error("magnitudes lie between -30 and 30, and temperatures are more than 0"));
        }
        let (sin_a, cos_a) = fmath::sin_cos(ascension.rem_euclid(360.0).to_radians() as f32);
        let (sin_d, cos_d) = fmath::sin_cos(declination.to_radians() as f32);
        let direction = Vec3::new(-cos_d * sin_a, sin_d, -cos_d * cos_a).normalize();
        stars.push(Star { direction, magnitude: magnitude as f32, temperature: temperature as f32 });
    }
    Ok(stars)
}

impl StarDraw {
    /// Stars as they are strewn over the sky: those brighter than a magnitude are 3.2 times as many with each further one, and a
    /// share of them lies in a band.
    pub fn stars(&self) -> Vec<Star> {
        /// How wide the band is: the mean sine of latitudes in it.
        const WIDTH: f32 = 0.09;
        let band = Frame::from_normal(self.pole);
        let star = |i: u32| {
            let s = Stream::new(u64::from(self.seed), [i, 0], 0);
            let mut z = 1.0 - 2.0 * s.uniform(0);
            if s.uniform(1) < self.galaxy {
                let away = -WIDTH * fmath::ln(1.0 - s.uniform(2));
                z = z.signum() * away.min(1.0);
            }
            let (sin, cos) = fmath::sin_cos(TAU * s.uniform(3));
            let across = (1.0 - z * z).max(0.0).sqrt();
            let direction = band.to_world(Vec3::new(across * cos, across * sin, z)).normalize();
            // The brightest of n is so by 2 log10 n, as counts of stars grow by 10^(m/2).
            let magnitude = self.faintest + 2.0 * fmath::ln(1.0 - s.uniform(4)) * std::f32::consts::LOG10_E;
            let warmth = s.uniform(5);
            let temperature = 3200.0 * fmath::pow(6.5, warmth * warmth.sqrt());
            Star { direction, magnitude, temperature }
        };
        (0..self.count).map(star).collect()
    }
}

impl StarField {
    /// Stars, each a disc.
    ///
    /// * `radius`: of each star, in radians; at most [`LARGEST_RADIUS`]
    /// * `scale`: factor of their light; 1 for lux
    ///
    /// What pixels cover does not count until [`StarField::at_least`] says how much.
    pub fn new(stars: &[Star], radius: f32, scale: f32) -> StarField {
        let half = fmath::sin(0.5 * radius.min(LARGEST_RADIUS));
        let placed = |star: &Star| {
            let at = fmath::ln(star.temperature / COOLEST) / fmath::ln(HOTTEST / COOLEST);
            PlacedStar {
                direction: star.direction,
                illuminance: scale * VEGA * fmath::exp(-MAGNITUDE * star.magnitude),
                color: (at * (COLORS - 1) as f32).round().clamp(0.0, (COLORS - 1) as f32) as u8,
                square: 0,
            }
        };
        let step = fmath::ln(HOTTEST / COOLEST) / (COLORS - 1) as f32;
        let color = |i: usize| Emission::blackbody(COOLEST * fmath::exp(step * i as f32));
        let stars: Vec<PlacedStar> = stars.iter().map(placed).collect();
        let mut sum = 0.0;
        let sums = stars.iter().map(|star| {
            sum += f64::from(star.illuminance);
            sum
        });
        let sums = sums.collect();
        // About a star in a square, and no square much smaller than a star.
        let side = ((stars.len() as f32 / 6.0).sqrt().min(0.5 / radius.max(1e-4)) as usize).clamp(1, 1024);
        let mut field = StarField {
            stars,
            sums,
            height: 2.0 * half * half,
            peak: 3.0 / (TAU * 2.0 * half * half),
            pixels: 0.0,
            side,
            starts: Vec::new(),
            listed: Vec::new(),
            colors: (0..COLORS).map(color).collect(),
        };
        for i in 0..field.stars.len() {
            field.stars[i].square = field.square(field.stars[i].direction) as u32;
        }
        (field.starts, field.listed) = field.lists(radius);
        field
    }

    /// The same where none is seen smaller than some pixels.
    ///
    /// * `pixels`: the radius, 0 for stars of their own size
    pub fn at_least(self, pixels: f32) -> StarField {
        StarField { pixels, ..self }
    }

    /// Whether it counts what a pixel covers.
    pub fn wants_footprint(&self) -> bool {
        self.pixels > 0.0
    }

    /// Which stars may touch each square.
    fn lists(&self, radius: f32) -> (Vec<u32>, Vec<u32>) {
        let squares = 6 * self.side * self.side;
        let mut starts = vec![0_u32; squares + 1];
        let each = |mut with: Box<dyn FnMut(usize, u32) + '_>| {
            for (i, star) in self.stars.iter().enumerate() {
                for face in 0..6 {
                    for square in self.touched(star.direction, radius, face) {
                        with(square, i as u32);
                    }
                }
            }
        };
        each(Box::new(|square, _| starts[square + 1] += 1));
        for i in 0..squares {
            starts[i + 1] += starts[i];
        }
        let mut next = starts.clone();
        let mut listed = vec![0; starts[squares] as usize];
        each(Box::new(|square, star| {
            listed[next[square] as usize] = star;
            next[square] += 1;
        }));
        (starts, listed)
    }

    /// The squares of a face that a disc around a direction may touch.
    fn touched(&self, d: Vec3, radius: f32, face: usize) -> impl Iterator<Item = usize> + use<> {
        let [ahead, x, y] = on_face(d, face);
        let side = self.side;
        let (u, v) = (x / ahead, y / ahead);
        // How far the rim is from the middle on the face, with room for its curve.
        let reach = 1.5 * radius * (1.0 + u * u + v * v);
        let range = |at: f32| {
            let cell = |at: f32| (0.5 * (at + 1.0) * side as f32).floor().clamp(0.0, side as f32) as usize;
            let touches = ahead > 0.3 && at - reach <= 1.0 && at + reach >= -1.0;
            if touches { cell(at - reach)..(cell(at + reach) + 1).min(side) } else { 0..0 }
        };
        let (columns, rows) = (range(u), range(v));
        rows.flat_map(move |row| columns.clone().map(move |column| (face * side + row) * side + column))
    }

    /// The square that a direction is in.
    fn square(&self, d: Vec3) -> usize {
        let face = face_of(d);
        let [ahead, x, y] = on_face(d, face);
        let cell = |at: f32| ((0.5 * (at / ahead + 1.0) * self.side as f32) as usize).min(self.side - 1);
        (face * self.side + cell(y)) * self.side + cell(x)
    }

    /// The stars that may touch a square.
    fn listed(&self, square: usize) -> &[u32] {
        match self.starts.get(square..square + 2) {
            Some(&[from, to]) => &self.listed[from as usize..to as usize],
            _ => &[],
        }
    }

    /// The stars that may be seen in a unit direction, each with its luminance there.
    fn seen(&self, d: Vec3) -> impl Iterator<Item = (&PlacedStar, f32)> {
        self.listed(self.square(d)).iter().filter_map(move |&i| {
            let star = &self.stars[i as usize];
            let rest = 1.0 - 0.5 * d.distance_squared(star.direction) / self.height;
            (rest > 0.0).then_some((star, star.illuminance * self.peak * rest * rest))
        })
    }

    /// The stars that a pixel around a unit direction may see, each with its luminance there.
    fn seen_within(&self, d: Vec3, footprint: &SkyFootprint) -> impl Iterator<Item = (&PlacedStar, f32)> {
        let ellipse = StarEllipse::new(d, 2.0 * self.height, footprint.dd.map(|dd| self.pixels * dd));
        let squares = (0..6).flat_map(move |face| self.touched(d, ellipse.reach, face));
        let listed = squares.flat_map(move |square| self.listed(square).iter().map(move |&i| (square, i)));
        listed.filter_map(move |(square, i)| {
            let star = &self.stars[i as usize];
            let is_own = star.square as usize == square;
            let rest = if is_own { 1.0 - ellipse.distance2(star.direction - d) } else { 0.0 };
            (rest > 0.0).then_some((star, star.illuminance * ellipse.peak * rest * rest))
        })
    }

    /// Their linear RGB from the direction `d`, not necessarily of unit length.
    pub fn color(&self, d: Vec3) -> Spectrum {
        let stars = self.seen(d.normalize_or_zero());
        stars.fold(Spectrum::BLACK, |sum, (star, luminance)| {
            sum + Spectrum::from(Vec3::from(self.colors[usize::from(star.color)].rgb())) * luminance
        })
    }

    /// Their radiance from the direction `d`, not necessarily of unit length.
    pub fn radiance(&self, d: Vec3, wavelengths: &Wavelengths) -> Spectrum {
        self.sum(self.seen(d.normalize_or_zero()), wavelengths)
    }

    /// The same as a pixel sees it, where stars are at least as large as [`StarField::at_least`] says.
    ///
    /// * `d`: unit vector
    #[inline(never)]
    pub fn radiance_within(&self, d: Vec3, footprint: &SkyFootprint, wavelengths: &Wavelengths) -> Spectrum {
        self.sum(self.seen_within(d, footprint), wavelengths)
    }

    /// Radiance of stars of which the luminance is known.
    fn sum<'a>(
        &self,
        stars: impl Iterator<Item = (&'a PlacedStar, f32)>,
        wavelengths: &Wavelengths,
    ) -> Spectrum {
        stars.fold(Spectrum::BLACK, |sum, (star, luminance)| {
            sum + self.colors[usize::from(star.color)].at(wavelengths) * luminance
        })
    }

    /// Density per solid angle of the unit direction `d` among those that are drawn: luminance over the illuminance of all stars together.
    pub fn pdf(&self, d: Vec3) -> f32 {
        let luminance: f32 = self.seen(d).map(|(_, luminance)| luminance).sum();
        let pdf = luminance / self.illuminance() as f32;
        if pdf.is_finite() { pdf } else { 0.0 }
    }

    /// A unit direction, drawn in proportion to luminance: a star by its illuminance, and a point of its disc by `1 - (1 - h/H)^3`, which
    /// is the light within `h`. `None` where no star gives light.
    ///
    /// * `u`: uniform in [0, 1)²
    pub fn sample(&self, u: Vec2) -> Option<Vec3> {
        let of_all = f64::from(u.x) * self.illuminance();
        let i = self.sums.partition_point(|&sum| sum <= of_all);
        let star = self.stars.get(i)?;
        let before = if i == 0 { 0.0 } else { self.sums[i - 1] };
        let rest = (1.0 - (of_all - before) / (self.sums[i] - before)).clamp(0.0, 1.0) as f32;
        let h = self.height * (1.0 - fmath::pow(rest, 1.0 / 3.0));
        let (sin, cos) = fmath::sin_cos(TAU * u.y);
        let across = (h * (2.0 - h)).sqrt();
        let local = Vec3::new(across * cos, across * sin, 1.0 - h);
        Some(Frame::from_normal(star.direction).to_world(local).normalize())
    }

    /// That of all stars together.
    fn illuminance(&self) -> f64 {
        self.sums.last().copied().unwrap_or(0.0)
    }

    /// The mean luminance of all directions.
    pub fn mean_luminance(&self) -> f32 {
        (self.illuminance() / (4.0 * std::f64::consts::PI)) as f32
    }

    /// Whether none of them gives light.
    pub fn is_black(&self) -> bool {
        self.illuminance() == 0.0
    }

    /// Whether all its numbers are finite.
    pub fn is_finite(&self) -> bool {
        let finite =
            |star: &PlacedStar| star.direction.is_finite() && (self.peak * star.illuminance).is_finite();
        self.stars.iter().all(finite)
    }
}

/// A star as a pixel sees it around one direction.
#[derive(Clone, Copy, Debug)]
struct StarEllipse {
    /// Unit vectors at right angles to the direction, along the axes.
    axes: [Vec3; 2],
    /// Squares of the half axes.
    lengths2: [f32; 2],
    /// The longer half axis.
    reach: f32,
    /// Luminance in the middle over the illuminance of the star.
    peak: f32,
}

impl StarEllipse {
    /// * `d`: unit direction
    /// * `r2`: square of the radius of a star
    /// * `sides`: of what else it covers. No half axis is longer than [`LARGEST_RADIUS`] but for that of the star.
    fn new(d: Vec3, r2: f32, sides: [Vec3; 2]) -> StarEllipse {
        let frame = Frame::from_normal(d);
        let [a, b] = sides.map(|side| Vec2::new(side.dot(frame.s), side.dot(frame.t)));
        let (xx, xy, yy) = (a.x * a.x + b.x * b.x, a.x * a.y + b.x * b.y, a.y * a.y + b.y * b.y);
        // Eigenvalues of the symmetric matrix, and the angle of the first eigenvector, of which twice is known.
        let (mean, half, skew) = (0.5 * (xx + yy), 0.5 * (xx - yy), xy);
        let apart = (half * half + skew * skew).sqrt();
        let double = if apart > 0.0 { Vec2::new(half, skew) / apart } else { Vec2::X };
        let cos = (0.5 * (1.0 + double.x)).max(0.0).sqrt();
        let sin = (0.5 * (1.0 - double.x)).max(0.0).sqrt().copysign(double.y);
        let largest = LARGEST_RADIUS * LARGEST_RADIUS;
        let lengths2 = [mean + apart, mean - apart].map(|length2| r2 + length2.clamp(0.0, largest));
        StarEllipse {
            axes: [cos * frame.s + sin * frame.t, cos * frame.t - sin * frame.s],
            lengths2,
            reach: lengths2[0].max(lengths2[1]).sqrt(),
            peak: 3.0 / (PI * (lengths2[0] * lengths2[1]).sqrt()),
        }
    }

    /// The square of a difference from the direction, 1 at the rim; more behind the viewer.
    fn distance2(&self, x: Vec3) -> f32 {
        let [u, v] = self.axes.map(|axis| axis.dot(x));
        // What is not across counts too, by which the other side of the sky is out of reach.
        let along2 = (x.length_squared() - u * u - v * v).max(0.0);
        (u * u + along2) / self.lengths2[0] + v * v / self.lengths2[1]
    }
}

/// Which face of a cube a direction meets.
fn face_of(d: Vec3) -> usize {
    let a = d.abs();
    let axis = if a.x >= a.y && a.x >= a.z { 0 } else { 1 + usize::from(a.z > a.y) };
    2 * axis + usize::from(d[axis] < 0.0)
}

/// A direction as a face sees it: how far it goes ahead, and along both edges.
fn on_face(d: Vec3, face: usize) -> [f32; 3] {
    let axis = face / 2;
    let ahead = if face.is_multiple_of(2) { d[axis] } else { -d[axis] };
    [ahead, d[(axis + 1) % 3], d[(axis + 2) % 3]]
}

#[cfg(test)]
mod tests {
    use kajo_math::warp;

    use super::*;

    fn field(stars: &[Star], radius: f32) -> StarField {
        StarField::new(stars, radius, 1.0)
    }

    fn drawn(count: u32) -> Vec<Star> {
        StarDraw { count, seed: 3, faintest: 6.5, galaxy: 0.5, pole: Vec3::new(0.6, 0.8, 0.0) }.stars()
    }

    /// Directions of a spiral, evenly over the sphere.
    fn directions(n: u32) -> impl Iterator<Item = Vec3> {
        (0..n).map(move |i| {
            let i = i as f32 + 0.5;
            warp::uniform_sphere(Vec2::new(i / n as f32, (0.618_034 * f64::from(i)).fract() as f32))
        })
    }

    /// What is listed is what all stars together are.
    #[test]
    fn no_star_is_overlooked() {
        for (count, radius) in [(5000, 0.02), (300, LARGEST_RADIUS), (20_000, 1e-3)] {
            let stars = drawn(count);
            let field = field(&stars, radius);
            let half = (0.5 * radius).sin();
            let beside = |star: &Star| {
                let frame = Frame::from_normal(star.direction);
                let rim = |angle: f32| {
                    let (s, c) = angle.sin_cos();
                    frame.to_world(Vec3::new(0.97 * radius * c, 0.97 * radius * s, 1.0)).normalize()
                };
                [star.direction, rim(0.3), rim(2.0), rim(4.1)]
            };
            let asked = stars.iter().step_by(7).flat_map(beside).chain(directions(500));
            for d in asked {
                let covers = |star: &&Star| d.distance_squared(star.direction) < 4.0 * half * half;
                let expected = stars.iter().filter(covers).count();
                assert_eq!(field.seen(d).count(), expected, "{count} {radius}: {d}");
            }
        }
    }

    /// The light of a star, over all directions, is its illuminance.
    #[test]
    fn light_of_stars_is_their_illuminance() {
        let star = Star { direction: Vec3::new(0.48, 0.6, -0.64), magnitude: -1.46, temperature: 9940.0 };
        let field = field(&[star], 0.1);
        let n = 400_000;
        let sum: f64 = directions(n).map(|d| f64::from(field.color(d).luminance())).sum();
        let found = 4.0 * std::f64::consts::PI * sum / f64::from(n);
        let expected = 2.54e-6 * 10f64.powf(0.4 * 1.46);
        assert!((found / expected - 1.0).abs() < 2e-3, "{found} for {expected}");
        let mean = f64::from(field.mean_luminance()) * 4.0 * std::f64::consts::PI;
        assert!((mean / expected - 1.0).abs() < 1e-4, "{mean}");
    }

    /// Footprints of all sizes, and of all shapes.
    fn footprint(d: Vec3, long: f32, short: f32, turn: f32) -> SkyFootprint {
        let Frame { s, t, .. } = Frame::from_normal(d);
        let (sin, cos) = turn.sin_cos();
        SkyFootprint { dd: [long * (cos * s + sin * t), short * (cos * t - sin * s)] }
    }

    /// A star is as bright to pixels of any shape, those included that cover more than a star may be.
    #[test]
    fn pixels_see_all_the_light_of_a_star() {
        let star = Star { direction: Vec3::new(0.48, 0.6, -0.64), magnitude: 0.0, temperature: 6500.0 };
        for (radius, long, short) in
            [(1e-3, 0.04, 0.03), (0.02, 0.05, 0.0), (1e-3, 1.0, 0.05), (0.05, 0.0, 0.0)]
        {
            let field = field(&[star], radius).at_least(1.5);
            let n = 1_000_000;
            let light = |d: Vec3| {
                let footprint = footprint(d, long, short, 0.7);
                f64::from(field.radiance_within(d, &footprint, &Wavelengths::RGB).luminance())
            };
            let found = 4.0 * std::f64::consts::PI * directions(n).map(light).sum::<f64>() / f64::from(n);
            assert!((found / 2.54e-6 - 1.0).abs() < 1e-2, "{radius} {long} {short}: {found}");
        }
    }

    /// What is listed is what all stars together are, each once, and those that no pixel is as large as are what they were.
    #[test]
    fn pixels_overlook_no_star() {
        for (count, radius) in [(5000, 0.002), (300, 0.05), (20_000, 1e-4)] {
            let stars = drawn(count);
            let field = field(&stars, radius).at_least(2.0);
            for (i, d) in directions(400).enumerate() {
                let (long, short) = (0.001 * (i % 29) as f32, 0.0005 * (i % 31) as f32);
                let footprint = footprint(d, long, short, i as f32);
                let ellipse = StarEllipse::new(d, 2.0 * field.height, footprint.dd.map(|dd| 2.0 * dd));
                let covers = |star: &&Star| ellipse.distance2(star.direction - d) < 1.0;
                let expected = stars.iter().filter(covers).count();
                assert_eq!(field.seen_within(d, &footprint).count(), expected, "{count} {radius}: {d}");
                let [point, plain] = [
                    field.radiance_within(d, &SkyFootprint::POINT, &Wavelengths::RGB).luminance(),
                    field.radiance(d, &Wavelengths::RGB).luminance(),
                ];
                assert!((point - plain).abs() <= 1e-3 * plain, "{d}: {point} {plain}");
            }
        }
    }

    /// Half axes are what two sides span, whatever their order.
    #[test]
    fn ellipses_are_those_of_their_sides() {
        for (i, d) in directions(50).enumerate() {
            let footprint = footprint(d, 0.04, 0.01, i as f32);
            for sides in [footprint.dd, [footprint.dd[1], -footprint.dd[0]]] {
                let ellipse = StarEllipse::new(d, 1e-6, sides);
                for (side, length) in footprint.dd.into_iter().zip([0.04f32, 0.01]) {
                    let rim = side * ((length * length + 1e-6).sqrt() / length);
                    assert!((ellipse.distance2(rim) - 1.0).abs() < 1e-3, "{d}: {}", ellipse.distance2(rim));
                }
                assert!((ellipse.reach - 0.04).abs() < 1e-4 && ellipse.distance2(-2.0 * d) > 1.0);
            }
        }
    }

    /// Luminance over density is the same in all directions that are drawn, at the poles and where discs overlap as well.
    #[test]
    fn drawn_directions_are_as_dense_as_they_are_bright() {
        let star = |direction: Vec3, magnitude| Star { direction, magnitude, temperature: 6500.0 };
        let near = Vec3::new(0.03, 1.0, 0.0).normalize();
        let field =
            field(&[star(Vec3::Y, 1.0), star(near, 0.0), star(Vec3::NEG_Y, 2.0), star(Vec3::X, 40.0)], 0.05);
        let all = field.mean_luminance() * 4.0 * PI;
        let mut south = 0.0;
        for (i, j) in (0..64).flat_map(|i| (0..64).map(move |j| (i, j))) {
            let u = Vec2::new(i as f32 + 0.5, j as f32 + 0.5) / 64.0;
            let d = field.sample(u).expect("a direction");
            let pdf = field.pdf(d);
            assert!((field.color(d).luminance() - pdf * all).abs() < 1e-3 * pdf * all, "{d}: {pdf}");
            south += f32::from(u8::from(d.y < 0.0)) / 4096.0;
        }
        let expected = 10f32.powf(-0.8) / (1.0 + 10f32.powf(-0.4) + 10f32.powf(-0.8));
        assert!((south - expected).abs() < 0.02, "{south} {expected}");
        assert_eq!(StarField::new(&[], 0.05, 1.0).sample(Vec2::ZERO), None);
    }

    #[test]
    fn counts_grow_with_magnitudes() {
        let stars = drawn(20_000);
        let up_to = |m: f32| stars.iter().filter(|star| star.magnitude < m).count() as f32;
        for m in [4.5, 5.5] {
            let ratio = up_to(m + 1.0) / up_to(m);
            assert!((ratio / 10f32.sqrt() - 1.0).abs() < 0.1, "{m}: {ratio}");
        }
        let pole = Vec3::new(0.6, 0.8, 0.0);
        let near = stars.iter().filter(|star| star.direction.dot(pole).abs() < 0.1).count() as f32;
        // A tenth of those that are everywhere, and 1 - exp(-0.1/0.09) of the others.
        let expected = 20_000.0 * (0.05 + 0.5 * (1.0 - (-0.1f32 / 0.09).exp()));
        assert!((near / expected - 1.0).abs() < 0.05, "{near} {expected}");
    }

    #[test]
    fn catalogues_are_read() {
        let text = "# Vega and Polaris\n279.2347, 38.7837, 0.03, 9602\n37.95 89.26 1.98\n\n";
        let stars = parse_stars(text).expect("stars");
        assert_eq!(stars.len(), 2);
        assert!(stars[1].direction.y > 0.999 && stars[1].temperature == 6500.0, "{stars:?}");
        let east = parse_stars("90 0 1").expect("a star")[0].direction;
        assert!(east.distance(Vec3::NEG_X) < 1e-6, "{east}");
        for (text, line) in
            [("1 2", 1), ("1 2 3\n1 x 3", 2), ("0 91 3", 1), ("0 0 99", 1), ("0 0 1 -5", 1), ("nan 0 1", 1)]
        {
            assert_eq!(parse_stars(text).map_err(|error| error.line), Err(line), "{text}");
        }
    }
}
