//! BRDFs of the data base of MERL: isotropic, by the half vector and the direction that light has seen from it
//! [Matusik et al. 2003; Rusinkiewicz 1998].
//!
//! ```text
//! i32 i32 i32     90 angles of the half vector, 90 of the difference, 180 azimuths of the difference
//! f64 for each    red, then green, then blue; the azimuth runs fastest
//!
//! θh = (i/90)² 90°        θd = j 1°        φd = k 1°        f = value · (1, 1.15, 1.66) / 1500
//! ```
//!
//! All is little end first. Between nodes the value is linear in `(θh)^½`, `θd` and `φd`; `φd` repeats after 180 degrees, as the
//! two directions may be exchanged. Negative values, which mark what could not be measured, are 0.
//!
//! Directions are drawn by the half vector, uniform within each of the 90 rings, and for a part by the cosine.

use std::f32::consts::{FRAC_1_PI, FRAC_2_PI, FRAC_PI_2, PI, TAU};

use kajo_math::piecewise::Piecewise1D;
use kajo_math::{Vec2, Vec3, fmath, warp};

/// Angles of the half vector, of the difference, and azimuths of the difference.
pub const SIZE: [usize; 3] = [90, 90, 180];

const SCALE: [f64; 3] = [1.0 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0];

/// The share of directions that are drawn by the cosine.
const COSINE_SHARE: f32 = 0.3;

/// Rings of differences that say how often a half vector is drawn: those up to 60 degrees.
const DRAWN_BY: usize = 60;

/// A BRDF of that data base.
#[derive(Clone)]
pub struct MerlBrdf {
    /// `[θh][θd][φd]`, linear RGB per steradian.
    values: Vec<[f32; 3]>,
    rings: Piecewise1D,
}

/// `1 - cos θh` at the begin of a ring of half vectors, precise near 0.
fn rise(ring: usize) -> f32 {
    let s = ring as f32 / SIZE[0] as f32;
    fmath::one_minus_cos(s * s * FRAC_PI_2)
}

impl MerlBrdf {
    /// The BRDF of a file.
    ///
    /// # Errors
    /// What is malformed, in words.
    pub fn read(file: &[u8]) -> Result<MerlBrdf, String> {
        let (head, rest) = file.split_at_checked(12).ok_or("the file ends within its header")?;
        let side =
            |i: usize| i32::from_le_bytes([head[4 * i], head[4 * i + 1], head[4 * i + 2], head[4 * i + 3]]);
        let found = [side(0), side(1), side(2)];
        if found != SIZE.map(|n| n as i32) {
            return Err(format!(
                "its header says {} x {} x {} values, and files of MERL have 90 x 90 x 180",
                found[0], found[1], found[2]
            ));
        }
        let n: usize = SIZE.iter().product();
        if rest.len() != 24 * n {
            return Err(format!("it has {} bytes of values, and should have {}", rest.len(), 24 * n));
        }
        let value = |i: usize, channel: usize| {
            let at = 8 * (channel * n + i);
            let bytes: [u8; 8] = std::array::from_fn(|k| rest[at + k]);
            let value = (f64::from_le_bytes(bytes) * SCALE[channel]) as f32;
            // Not a number becomes 0 too.
            if value > 0.0 { value } else { 0.0 }
        };
        let values: Vec<[f32; 3]> = (0..n).map(|i| [value(i, 0), value(i, 1), value(i, 2)]).collect();
        if !values.iter().flatten().all(|v| v.is_finite()) {
            return Err("one of its values is infinite".to_owned());
        }
        Ok(MerlBrdf { rings: rings(&values), values })
    }

    /// The value at a node; the azimuth repeats.
    fn node(&self, h: usize, d: usize, azimuth: usize) -> Vec3 {
        let [n, m, k] = SIZE;
        Vec3::from(self.values[(h.min(n - 1) * m + d.min(m - 1)) * k + azimuth % k])
    }

    /// The BRDF in linear RGB, for unit vectors above the surface.
    pub fn value(&self, wo: Vec3, wi: Vec3) -> [f32; 3] {
        let Some(h) = (wo + wi).try_normalize() else { return [0.0; 3] };
        let theta_h = 2.0 * fmath::asin((0.5 * (h - Vec3::Z).length()).min(1.0));
        // The light seen from a frame whose z axis is the half vector, and whose x axis lies below it.
        let y = Vec3::Z.cross(h).normalize_or(Vec3::Y);
        let x = y.cross(h);
        let d = Vec3::new(wi.dot(x), wi.dot(y), wi.dot(h));
        let theta_d = 2.0 * fmath::asin((0.5 * (d - Vec3::Z).length()).min(1.0));
        let phi_d = fmath::atan2(d.y, d.x);
        let phi_d = if phi_d < 0.0 { phi_d + PI } else { phi_d };
        let place = [
            (theta_h * FRAC_2_PI).max(0.0).sqrt() * SIZE[0] as f32,
            theta_d * FRAC_2_PI * SIZE[1] as f32,
            phi_d * FRAC_1_PI * SIZE[2] as f32,
        ];
        let cell = place.map(|v| v.floor());
        let [i, j, k] = cell.map(|v| v as usize);
        let [a, b, c] = [0, 1, 2].map(|axis| place[axis] - cell[axis]);
        let along = |i, j| self.node(i, j, k).lerp(self.node(i, j, k + 1), c);
        let across = |i| along(i, j).lerp(along(i, j + 1), b);
        across(i).lerp(across(i + 1), a).to_array()
    }

    /// Density per solid angle of [`MerlBrdf::sample`].
    pub fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        let cosine = COSINE_SHARE * wi.z * FRAC_1_PI;
        let Some(h) = (wo + wi).try_normalize() else { return cosine };
        let across = h.truncate().length_squared();
        let rise_h = across / (1.0 + h.z);
        let ring = ring_of(rise_h);
        let density = self.rings.probability(ring) / (TAU * (rise(ring + 1) - rise(ring)));
        cosine + (1.0 - COSINE_SHARE) * density / (4.0 * wo.dot(h)).max(1e-9)
    }

    /// A direction of light for a viewer, which may be below the surface: then nothing is scattered.
    pub fn sample(&self, wo: Vec3, u: Vec2, uc: f32) -> Vec3 {
        if uc < COSINE_SHARE {
            return warp::cosine_hemisphere(u);
        }
        let (ring, rest) = self.rings.cell_of(u.x);
        let rise_h = rise(ring) + rest * (rise(ring + 1) - rise(ring));
        let sin = (rise_h * (2.0 - rise_h)).max(0.0).sqrt();
        let (y, x) = fmath::sin_cos(TAU * u.y);
        let h = Vec3::new(sin * x, sin * y, 1.0 - rise_h);
        (2.0 * wo.dot(h) * h - wo).normalize_or(Vec3::Z)
    }

    /// Bytes of memory.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.values)
    }
}

/// The ring of half vectors that rise by so much.
fn ring_of(rise_h: f32) -> usize {
    let (mut low, mut high) = (0, SIZE[0]);
    while high - low > 1 {
        let middle = low.midpoint(high);
        if rise(middle) <= rise_h { low = middle } else { high = middle }
    }
    low
}

/// How often half vectors of each ring are drawn: by the mean of what is scattered about them.
fn rings(values: &[[f32; 3]]) -> Piecewise1D {
    let [n, m, k] = SIZE;
    let weight = |ring: usize| {
        let mean = |i: usize| {
            let row = &values[i * m * k..][..DRAWN_BY * k];
            row.iter().flatten().map(|&v| f64::from(v)).sum::<f64>() / row.len() as f64
        };
        let (near, far) = (mean(ring), mean((ring + 1).min(n - 1)));
        let cos = 1.0 - 0.5 * (rise(ring) + rise(ring + 1));
        let share = f64::from(rise(ring + 1) - rise(ring)) * f64::from(cos);
        (0.5 * (near + far) * share) as f32
    };
    let weights: Vec<f32> = (0..n).map(weight).collect();
    let least = 1e-4 * weights.iter().sum::<f32>() / n as f32;
    let held: Vec<f32> = weights.iter().map(|&w| w.max(least)).collect();
    Piecewise1D::new(&held).or_else(|| Piecewise1D::new(&vec![1.0; n])).expect("numbers above zero")
}

#[cfg(test)]
pub(crate) mod tests {
    use kajo_math::rng::Stream;

    use super::*;

    /// The file of a function of the angles of half vector and difference.
    pub fn file(f: impl Fn(f32, f32, f32) -> [f32; 3]) -> Vec<u8> {
        let mut bytes: Vec<u8> = SIZE.iter().flat_map(|&n| (n as i32).to_le_bytes()).collect();
        let n: usize = SIZE.iter().product();
        for (channel, scale) in SCALE.into_iter().enumerate() {
            for i in 0..n {
                let (h, d, phi) = (i / (90 * 180), i / 180 % 90, i % 180);
                let s = h as f32 / 90.0;
                let value = f(s * s * FRAC_PI_2, d as f32 * PI / 180.0, phi as f32 * PI / 180.0)[channel];
                bytes.extend((f64::from(value) / scale).to_le_bytes());
            }
        }
        bytes
    }

    /// A gloss on a matt ground.
    pub fn gloss() -> Vec<u8> {
        file(|h, d, _| {
            let value = 0.05 + 0.25 * fmath::pow(fmath::cos(h).max(0.0), 60.0) * (0.5 + 0.5 * fmath::cos(d));
            [value, 0.8 * value, 0.5 * value]
        })
    }

    fn upper(i: u32) -> Vec3 {
        let s = Stream::new(23, [i, 0], 0);
        warp::uniform_hemisphere(Vec2::new(s.uniform(0), s.uniform(1)))
    }

    #[test]
    fn a_constant_is_one_and_smooth_functions_are_near() {
        let flat = MerlBrdf::read(&file(|_, _, _| [0.1, 0.2, 0.3])).unwrap();
        let glossy = MerlBrdf::read(&gloss()).unwrap();
        for (wo, wi) in (0..2000).map(|i| (upper(2 * i), upper(2 * i + 1))) {
            let found = flat.value(wo, wi);
            assert!((0..3).all(|c| (found[c] - 0.1 * (c + 1) as f32).abs() < 1e-6), "{found:?}");
            let h = (wo + wi).normalize();
            let expected = 0.05 + 0.25 * fmath::pow(h.z, 60.0) * (0.5 + 0.5 * wi.dot(h));
            let found = glossy.value(wo, wi)[0];
            // The last degree of the difference is held.
            assert!((found - expected).abs() < 0.005 * expected + 1e-3, "{wo} {wi}: {found} {expected}");
            let back = glossy.value(wi, wo)[0];
            assert!((found - back).abs() < 1e-4, "{found} {back}");
        }
    }

    #[test]
    fn azimuths_are_those_of_the_light_seen_from_the_half_vector() {
        let turned = MerlBrdf::read(&file(|_, _, phi| [0.2 + 0.1 * fmath::cos(2.0 * phi); 3])).unwrap();
        // In the plane of the normal the azimuth is 0 or 180 degrees, across it 90.
        let (wo, wi) = (Vec3::new(-0.6, 0.0, 0.8), Vec3::new(0.28, 0.0, 0.96));
        assert!((turned.value(wo, wi)[0] - 0.3).abs() < 1e-4);
        let [wo, wi] = [-0.5, 0.5].map(|y| Vec3::new(0.5, y, 0.5f32.sqrt()));
        assert!((turned.value(wo, wi)[0] - 0.1).abs() < 1e-4);
    }

    #[test]
    fn what_is_no_file_of_merl_is_said() {
        let error = |bytes: &[u8]| MerlBrdf::read(bytes).err().unwrap();
        let good = gloss();
        assert_eq!(error(&good[..7]), "the file ends within its header");
        assert!(error(&good[..good.len() - 1]).contains("should have 34992000"));
        let mut other = good.clone();
        other[0] = 91;
        assert!(error(&other).contains("91 x 90 x 180"));
    }
}
