//! A point light with the measured intensities of a luminaire.
//!
//! Intensities are given for vertical angles `γ` from the axis and horizontal angles `C` around it, and are
//! interpolated bilinearly between these; what lies beyond the vertical angles of the table is dark. Of a table
//! that stops at 90 or 180 degrees the rest is its mirror image. Over a cell of the grid the interpolation is linear in
//! `γ` with the means `a` and `b` of its two ends, so that the flux has a closed form:
//!
//! ```text
//! flux = Σ ΔC ( a cos γ0 - b cos γ1 + (b - a) (sin γ1 - sin γ0) / (γ1 - γ0) )
//! ```
//!
//! A candela counts as one unit of `intensity`. The file's axis, straight down, lies along `direction`.
//!
//! Scene: `PointLight { position 0 3 0  ies "luminaires/street.ies"  direction 0 -1 0  rotate 90 }`

use std::f64::consts::PI;
use std::sync::Arc;

use kajo_color::{Emission, Spectrum, Wavelengths};
use kajo_math::{Aabb, Frame, Vec2, Vec3, fmath, warp};
use kajo_scene::IesFile;

use super::sample::INVERSE_SQUARE;
use super::{
    BoundingSphere, EmissionPdf, EmissiveSurfaces, Emitter, Illumination, LeNumbers, LightBounds,
    LightLeSample, LightLiSample, LightPoint, Receiver,
};

/// Which horizontal angles are measured; the others are like these.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Symmetry {
    /// One for all.
    Around,
    /// From 0 to 90 degrees, mirrored at both planes.
    Quarters,
    /// From 0 to 180 degrees.
    Halves,
    /// From 90 to 270 degrees.
    Sides,
    /// From 0 to 360 degrees.
    None,
}

impl Symmetry {
    /// How often the measured part fills the circle.
    fn parts(self) -> f64 {
        match self {
            Symmetry::Quarters => 4.0,
            Symmetry::Halves | Symmetry::Sides => 2.0,
            Symmetry::Around | Symmetry::None => 1.0,
        }
    }

    /// The measured angle that is like `c` in [0, 360].
    fn fold(self, c: f32) -> f32 {
        match self {
            Symmetry::Around => 0.0,
            Symmetry::Quarters => 90.0 - ((c % 180.0) - 90.0).abs(),
            Symmetry::Halves => 180.0 - (c - 180.0).abs(),
            Symmetry::Sides => 90.0 + ((c + 90.0) % 360.0 - 180.0).abs(),
            Symmetry::None => c,
        }
    }
}

/// Intensities over all directions.
#[derive(Clone, Debug, PartialEq)]
pub struct Photometry {
    /// Angles from the axis in degrees, increasing.
    vertical: Vec<f32>,
    /// Angles around it in degrees, increasing.
    horizontal: Vec<f32>,
    symmetry: Symmetry,
    /// A row of vertical angles for each horizontal one.
    candela: Vec<f32>,
}

impl From<IesFile> for Photometry {
    fn from(file: IesFile) -> Photometry {
        let IesFile { vertical_deg: vertical, horizontal_deg: mut horizontal, mut candela, .. } = file;
        let symmetry = match *horizontal {
            [_] => Symmetry::Around,
            [0.0, .., 90.0] => Symmetry::Quarters,
            [0.0, .., 180.0] => Symmetry::Halves,
            [90.0, .., 270.0] => Symmetry::Sides,
            _ => Symmetry::None,
        };
        if symmetry == Symmetry::None && horizontal.last() != Some(&360.0) {
            horizontal.push(360.0);
            candela.extend_from_within(..vertical.len());
        }
        Photometry { vertical, horizontal, symmetry, candela }
    }
}

impl Photometry {
    /// The intensity in candela.
    ///
    /// * `vertical_deg`: angle from the axis, in [0, 180]; `horizontal_deg`: angle around it, in [0, 360]
    pub fn intensity(&self, vertical_deg: f32, horizontal_deg: f32) -> f32 {
        let ends = (self.vertical[0], self.vertical[self.vertical.len() - 1]);
        if !(vertical_deg >= ends.0 && vertical_deg <= ends.1) {
            return 0.0;
        }
        let (v, s) = interval_of(&self.vertical, vertical_deg);
        let (h, t) = interval_of(&self.horizontal, self.symmetry.fold(horizontal_deg));
        let n = self.vertical.len();
        let at = |h: usize| {
            let row = &self.candela[h * n..(h + 1) * n];
            row[v] + s * (row[(v + 1).min(n - 1)] - row[v])
        };
        let (a, b) = (at(h), at((h + 1).min(self.horizontal.len() - 1)));
        a + t * (b - a)
    }

    /// The intensity in a direction: the axis is along z, the horizontal angle 0 along x, and 90 along -y.
    #[inline]
    pub fn towards(&self, d: Vec3) -> f32 {
        let around = fmath::atan2(-d.y, d.x).to_degrees();
        let off_axis = fmath::atan2(d.truncate().length(), d.z).to_degrees();
        self.intensity(off_axis.clamp(0.0, 180.0), if around < 0.0 { around + 360.0 } else { around })
    }

    /// All light, in lumen.
    pub fn flux(&self) -> f64 {
        if self.symmetry == Symmetry::Around {
            return 2.0 * PI * self.row_flux(|v| f64::from(self.candela[v]));
        }
        let n = self.vertical.len();
        let wedge = |h: usize| {
            let width = f64::from(self.horizontal[h + 1] - self.horizontal[h]).to_radians();
            let mean = |v: usize| {
                0.5 * (f64::from(self.candela[h * n + v]) + f64::from(self.candela[(h + 1) * n + v]))
            };
            width * self.row_flux(mean)
        };
        self.symmetry.parts() * (0..self.horizontal.len() - 1).map(wedge).sum::<f64>()
    }

    /// Integral over the vertical angles of an intensity that is given at each of them.
    fn row_flux(&self, intensity: impl Fn(usize) -> f64) -> f64 {
        let cell = |v: usize| {
            let [g0, g1] = [v, v + 1].map(|v| f64::from(self.vertical[v]).to_radians());
            let (a, b) = (intensity(v), intensity(v + 1));
            let slope = (b - a) / (g1 - g0);
            a * fmath::cos64(g0) - b * fmath::cos64(g1) + slope * (fmath::sin64(g1) - fmath::sin64(g0))
        };
        (0..self.vertical.len() - 1).map(cell).sum()
    }

    /// The first and last vertical angle, in degrees, between which there is light.
    fn reach(&self) -> (f32, f32) {
        let n = self.vertical.len();
        let is_lit = |v: &usize| (0..self.horizontal.len()).any(|h| self.candela[h * n + v] > 0.0);
        let first = (0..n).find(is_lit).unwrap_or(0);
        let last = (0..n).rev().find(is_lit).unwrap_or(0);
        (self.vertical[first.saturating_sub(1)], self.vertical[(last + 1).min(n - 1)])
    }
}

/// Which two of the increasing `nodes` `x` lies between, and how far from the first to the second. A single node has
/// itself for a neighbour.
fn interval_of(nodes: &[f32], x: f32) -> (usize, f32) {
    if nodes.len() < 2 {
        return (0, 0.0);
    }
    let i = nodes.partition_point(|&node| node <= x).clamp(1, nodes.len() - 1) - 1;
    (i, ((x - nodes[i]) / (nodes[i + 1] - nodes[i])).clamp(0.0, 1.0))
}

/// A point light with measured intensities.
#[derive(Clone, Debug)]
pub struct PhotometricLight {
    /// World-space position.
    pub position: Vec3,
    /// The luminaire's own axes: z is where the vertical angle is 0, x where the horizontal one is.
    pub frame: Frame,
    /// How strongly it shines where.
    pub photometry: Arc<Photometry>,
    /// Intensity for each candela of the file.
    pub emission: Emission,
    /// The same for the classic formula.
    pub intensity: Spectrum,
}

impl PhotometricLight {
    /// Direction to the light, distance, and candela over the square of the distance.
    #[inline]
    fn seen_from(&self, p: Vec3) -> (Vec3, f32, f32) {
        let to_light = self.position - p;
        let d = to_light.length();
        let wi = to_light / d;
        (wi, d, self.photometry.towards(self.frame.to_local(-wi)) / (d * d))
    }

    /// Whether a point that light comes from is the light's.
    fn is_at(&self, at: &LightPoint) -> bool {
        matches!(at, LightPoint::Position(p) if *p == self.position)
    }

    /// Whether any light leaves into the unit direction `d`.
    fn shines_into(&self, d: Vec3) -> bool {
        self.photometry.towards(self.frame.to_local(d)) > 0.0
    }
}

impl Emitter for PhotometricLight {
    #[inline]
    fn illuminate(&self, p: Vec3, _time: f32) -> Illumination {
        let (wi, distance, share) = self.seen_from(p);
        Illumination { wi, distance, intensity: self.intensity * share }
    }

    fn is_finite(&self) -> bool {
        let Frame { s, t, n } = self.frame;
        let vectors = [self.position, s, t, n];
        vectors.iter().all(|v| v.is_finite()) && self.intensity.is_finite() && self.emission.is_finite()
    }

    #[inline]
    fn sample_li<S: EmissiveSurfaces>(
        &self,
        to: &Receiver,
        _u: Vec2,
        wavelengths: &Wavelengths,
        _surfaces: &S,
    ) -> Option<LightLiSample> {
        let (wi, _, share) = self.seen_from(to.p);
        let radiance = self.emission.at(wavelengths) * share;
        let at = LightPoint::Position(self.position);
        (share > 0.0).then_some(LightLiSample { wi, radiance, pdf: 1.0, is_delta: true, at })
    }

    fn pdf_li(&self, _to: &Receiver, at: &LightPoint, wi: Vec3) -> f32 {
        f32::from(u8::from(self.is_at(at) && self.shines_into(-wi)))
    }

    fn is_pointlike(&self) -> bool {
        true
    }

    fn bounds(&self) -> Option<LightBounds> {
        let (first, last) = self.photometry.reach();
        // A luminaire that shines up only is narrower around the other axis.
        let (axis, widest) =
            if 180.0 - first < last { (-self.frame.n, 180.0 - first) } else { (self.frame.n, last) };
        Some(LightBounds {
            bounds: Aabb { min: self.position, max: self.position },
            axis,
            cos_spread: fmath::cos(widest.to_radians()),
            cos_reach: 0.0,
            two_sided: false,
            power: self.photometry.flux() as f32 * self.emission.luminance(),
            is_inverse_square: true,
        })
    }

    fn apex(&self) -> Option<Vec3> {
        Some(self.position)
    }

    /// Into all directions alike.
    fn sample_le<S: EmissiveSurfaces>(
        &self,
        _time: f32,
        u: LeNumbers,
        wavelengths: &Wavelengths,
        _world: &BoundingSphere,
        _surfaces: &S,
    ) -> Option<LightLeSample> {
        let d = warp::uniform_sphere(u.direction);
        let candela = self.photometry.towards(self.frame.to_local(d));
        (candela > 0.0).then(|| LightLeSample {
            at: LightPoint::Position(self.position),
            d,
            radiance: self.emission.at(wavelengths) * candela,
            attenuation: INVERSE_SQUARE,
            pdf: EmissionPdf { position: 1.0, direction: (0.25 / PI) as f32 },
            is_delta: true,
        })
    }

    fn pdf_le(&self, _time: f32, at: &LightPoint, d: Vec3, _world: &BoundingSphere) -> EmissionPdf {
        let direction = if self.shines_into(d) { (0.25 / PI) as f32 } else { 0.0 };
        EmissionPdf::at_point(self.is_at(at), direction)
    }

    fn power(&self, _world: &BoundingSphere) -> f32 {
        self.bounds().map_or(0.0, |bounds| bounds.power)
    }

    fn emission(&self) -> Option<&Emission> {
        Some(&self.emission)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::tests::sample_li;
    use kajo_math::rng::Stream;

    fn photometry(vertical: &[f32], horizontal: &[f32], candela: impl Fn(f32, f32) -> f32) -> Photometry {
        let all = horizontal.iter().flat_map(|&h| vertical.iter().map(move |&v| (v, h)));
        let candela = all.map(|(v, h)| candela(v, h)).collect();
        let (vertical_deg, horizontal_deg) = (vertical.to_vec(), horizontal.to_vec());
        IesFile { vertical_deg, horizontal_deg, candela, lamp_lumens: None, watts: 1.0 }.into()
    }

    fn every(step: f32, first: f32, last: f32) -> Vec<f32> {
        (0..=((last - first) / step) as u32).map(|i| first + step * i as f32).collect()
    }

    /// A lopsided light over the angles of a plane; linear within each cell of a grid of 10 by 30 degrees.
    fn lopsided(v: f32, h: f32) -> f32 {
        (180.0 - v) * (1.0 + (h - 180.0).abs() / 90.0)
    }

    #[test]
    fn tables_are_interpolated_in_both_angles() {
        let emitter = photometry(&[0.0, 45.0, 90.0], &[0.0, 90.0], |v, h| 100.0 - v + 0.5 * h);
        for (v, h) in [(0.0, 0.0), (45.0, 90.0), (90.0, 30.0), (22.5, 45.0), (77.7, 11.1)] {
            assert!((emitter.intensity(v, h) - (100.0 - v + 0.5 * h)).abs() < 1e-4, "{v} {h}");
        }
        assert_eq!((emitter.intensity(90.1, 0.0), emitter.intensity(180.0, 45.0)), (0.0, 0.0));
        // Up only: what is below the first angle is dark.
        let up = photometry(&[90.0, 180.0], &[0.0], |v, _| v);
        assert_eq!((up.intensity(89.9, 7.0), up.intensity(135.0, 200.0)), (0.0, 135.0));
    }

    #[test]
    fn what_is_not_measured_is_mirrored() {
        let vertical = every(10.0, 0.0, 180.0);
        let whole = photometry(&vertical, &every(30.0, 0.0, 360.0), lopsided);
        let open = photometry(&vertical, &every(30.0, 0.0, 330.0), lopsided);
        let half = photometry(&vertical, &every(30.0, 0.0, 180.0), lopsided);
        let quarters = photometry(&vertical, &[0.0, 90.0], |v, h| v * h);
        let sides = photometry(&vertical, &[90.0, 150.0, 210.0, 270.0], |v, h| v * h);
        for i in 0..200 {
            let s = Stream::new(3, [i, 0], 0);
            let (v, h) = (180.0 * s.uniform(0), 360.0 * s.uniform(1));
            let expected = lopsided(v, h);
            for emitter in [&whole, &open, &half] {
                assert!((emitter.intensity(v, h) - expected).abs() < 2e-3 * expected + 1e-3, "{v} {h}");
            }
            let near = |emitter: &Photometry, to: f32| {
                assert!((emitter.intensity(v, h) - v * to).abs() < 2e-3 * v * to + 1e-2, "{v} {h} for {to}");
            };
            near(&quarters, [h, 180.0 - h, h - 180.0, 360.0 - h][(h / 90.0) as usize % 4]);
            near(&sides, [180.0 - h, h, 540.0 - h][usize::from(h >= 90.0) + usize::from(h > 270.0)]);
        }
    }

    #[test]
    fn the_flux_is_the_integral_over_all_directions() {
        let vertical = every(10.0, 0.0, 180.0);
        let lights = [
            photometry(&[0.0, 180.0], &[0.0], |_, _| 3.0),
            photometry(&vertical, &every(30.0, 0.0, 180.0), lopsided),
            photometry(&[20.0, 50.0, 75.0], &[0.0, 20.0, 90.0], |v, h| 5.0 + v * h),
            photometry(&[90.0, 110.0], &[90.0, 110.0, 200.0, 270.0], |v, h| v + h),
            photometry(&[0.0, 30.0], &[0.0, 10.0, 200.0], |v, h| 40.0 - v + h),
        ];
        for emitter in &lights {
            // A grid in the two angles, by the midpoint rule.
            let (rows, columns) = (1800, 720);
            let mut sum = 0.0;
            for i in 0..rows {
                let v = (f64::from(i) + 0.5) * 180.0 / f64::from(rows);
                let ring: f64 = (0..columns)
                    .map(|j| {
                        f64::from(emitter.intensity(v as f32, (j as f32 + 0.5) * 360.0 / columns as f32))
                    })
                    .sum();
                sum += ring * v.to_radians().sin();
            }
            let expected = sum * (PI / f64::from(rows)) * (2.0 * PI / f64::from(columns));
            assert!((emitter.flux() / expected - 1.0).abs() < 1e-3, "{} for {expected}", emitter.flux());
        }
        assert!((lights[0].flux() / (12.0 * PI) - 1.0).abs() < 1e-6, "the same to all sides");
    }

    #[test]
    fn the_intensity_of_a_cosine_gives_the_flux_of_a_matt_surface() {
        let cosine = |v: f32, _| 1000.0 * v.to_radians().cos().max(0.0);
        let emitter = photometry(&every(1.0, 0.0, 90.0), &[0.0], cosine);
        assert!((emitter.flux() / (1000.0 * PI) - 1.0).abs() < 1e-4);
    }

    #[test]
    fn angles_count_around_the_axis_seen_from_above() {
        let emitter = photometry(&[0.0, 180.0], &[0.0, 90.0, 180.0, 270.0, 360.0], |_, h| 1.0 + h % 360.0);
        // Straight down in a room with y up: x is 0 degrees, and -z, to the left of x from above, is 90.
        let frame = Frame::from_tangent(Vec3::NEG_Y, Vec3::X);
        for (d, expected) in [(Vec3::X, 1.0), (Vec3::NEG_Z, 91.0), (Vec3::NEG_X, 181.0), (Vec3::Z, 271.0)] {
            let found = emitter.towards(frame.to_local(d));
            assert!((found - expected).abs() < 1e-3, "{d}: {found}");
        }
    }

    #[test]
    fn light_leaves_within_the_bounds_and_falls_off_with_the_square() {
        for (first, last) in [(0.0, 40.0), (110.0, 170.0), (0.0, 180.0), (30.0, 140.0)] {
            let photometry = photometry(&[first, last], &[0.0], |_, _| 80.0);
            let light = PhotometricLight {
                position: Vec3::new(0.0, 2.0, 0.0),
                frame: Frame::from_tangent(Vec3::new(0.6, -0.8, 0.0), Vec3::X),
                photometry: Arc::new(photometry),
                emission: Emission::from_rgb([0.5; 3]),
                intensity: Spectrum::WHITE,
            };
            let bounds = light.bounds().unwrap();
            let mut lit = 0;
            for i in 0..2000 {
                let s = Stream::new(9, [i, 0], 0);
                let d = warp::uniform_sphere(Vec2::new(s.uniform(0), s.uniform(1)));
                let angle = light.frame.n.dot(d).clamp(-1.0, 1.0).acos().to_degrees();
                let sample = sample_li(&light, light.position + 4.0 * d, Vec2::ZERO);
                assert_eq!(sample.is_some(), (first..=last).contains(&angle), "{angle}");
                if let Some(sample) = sample {
                    lit += 1;
                    assert!((sample.radiance[0] - 2.5).abs() < 1e-4 && sample.is_delta);
                    assert!(d.dot(bounds.axis) >= bounds.cos_spread - 1e-4, "{first} {last}: {angle}");
                }
            }
            assert!(lit > 100);
        }
    }
}
