//! What rays see that hit nothing.
//!
//! One colour, an [`Environment`], a clear [`Sky`], or a cube map: six square pictures around the scene, right and left
//! (+x, -x), up and down (+y, -y), front and back (+z, -z), looked up bilinearly. Any of them may have stars before it.
//!
//! Scene: `Background { color 0.2 0.3 0.5  ambientLight 0.1 0.1 0.1  cubeMap sky }`

use std::sync::Arc;

use kajo_color::{Emission, RgbBasis, Spectrum, Wavelengths};
use kajo_image::Image;
use kajo_math::{Vec2, Vec3};

use crate::daylight::{Sky, Sun};
use crate::differential::SkyFootprint;
use crate::environment::{DensityWeight, Environment, SphereDensity, direction_of};
use crate::star_field::StarField;

/// File names of the six pictures of a cube map, in the order of [`CubeMap::new`].
pub const FACE_NAMES: [&str; 6] = ["right", "left", "up", "down", "front", "back"];

/// The surroundings of a scene.
#[derive(Debug)]
pub enum Background {
    /// The same in all directions.
    Constant {
        /// Linear RGB as it was written: the classic format knows negative colours.
        color: Spectrum,
        /// The same as light.
        emission: Emission,
    },
    /// A picture in every direction.
    CubeMap(Box<CubeMap>),
    /// A picture of all directions.
    Environment(Box<Environment>),
    /// A clear sky.
    Sky(Box<Sky>),
    /// Stars before any of these.
    Starry {
        /// What is behind them.
        behind: Box<Background>,
        /// The stars.
        stars: Arc<StarField>,
    },
}

impl Default for Background {
    /// Black.
    fn default() -> Background {
        Background::constant([0.0; 3])
    }
}

impl Background {
    /// Whether all its numbers are finite; those of pictures are.
    pub fn is_finite(&self) -> bool {
        match self {
            Background::Constant { color, emission } => color.is_finite() && emission.is_finite(),
            Background::CubeMap(_) | Background::Environment(_) | Background::Sky(_) => true,
            Background::Starry { behind, stars } => behind.is_finite() && stars.is_finite(),
        }
    }

    /// The same linear RGB from everywhere.
    pub fn constant(rgb: [f32; 3]) -> Background {
        Background::Constant { color: Vec3::from(rgb).into(), emission: Emission::from_rgb(rgb) }
    }

    /// Linear RGB from the direction `d`, not necessarily of unit length.
    #[inline]
    pub fn color(&self, d: Vec3) -> Spectrum {
        match self {
            Background::Constant { color, .. } => *color,
            Background::CubeMap(map) => map.color(d),
            Background::Environment(environment) => environment.color(d),
            Background::Sky(sky) => sky.color(d),
            Background::Starry { behind, stars } => behind.color(d) + stars.color(d),
        }
    }

    /// Radiance from the direction `d`, not necessarily of unit length.
    #[inline]
    pub fn radiance(&self, d: Vec3, wavelengths: &Wavelengths) -> Spectrum {
        match self {
            Background::Constant { emission, .. } => emission.at(wavelengths),
            Background::Sky(sky) => sky.radiance(d, wavelengths),
            Background::Starry { behind, stars } => {
                behind.radiance(d, wavelengths) + stars.radiance(d, wavelengths)
            }
            _ if wavelengths.is_spectral() => RgbBasis::new(wavelengths).emission(self.color(d).to_rgb()),
            _ => self.color(d),
        }
    }

    /// The same as a pixel sees it: no star is smaller than that.
    #[inline]
    pub fn radiance_within(&self, d: Vec3, footprint: &SkyFootprint, wavelengths: &Wavelengths) -> Spectrum {
        match self {
            Background::Starry { behind, stars } if !footprint.is_point() => {
                behind.radiance(d, wavelengths) + stars.radiance_within(d, footprint, wavelengths)
            }
            _ => self.radiance(d, wavelengths),
        }
    }

    /// Whether it asks what a pixel covers.
    pub fn wants_footprint(&self) -> bool {
        matches!(self, Background::Starry { stars, .. } if stars.wants_footprint())
    }

    /// Where light comes from, stars left out, to draw directions by; `None` where it comes from everywhere alike, or from nowhere.
    ///
    /// * `weight`: which of the light counts
    pub fn density(&self, weight: DensityWeight) -> Option<SphereDensity> {
        match self {
            Background::Constant { .. } => None,
            Background::CubeMap(map) => map.density(weight),
            Background::Environment(environment) => environment.density(weight),
            Background::Sky(sky) => sky.density(weight),
            Background::Starry { behind, .. } => behind.density(weight),
        }
    }

    /// The sun, which directions are drawn to of their own, and the share of directions that go there.
    pub fn sun(&self) -> Option<(&Sun, f32)> {
        match self {
            Background::Sky(sky) => sky.sun.as_ref().map(|sun| (sun, sky.sun_share())),
            Background::Starry { behind, .. } => behind.sun(),
            _ => None,
        }
    }

    /// The mean luminance of all directions, that of the sun included.
    pub fn mean_luminance(&self) -> f32 {
        match self {
            Background::Constant { emission, .. } => emission.luminance(),
            Background::CubeMap(map) => map.mean_luminance(),
            Background::Environment(environment) => environment.mean_luminance(),
            Background::Sky(sky) => sky.mean_luminance(),
            Background::Starry { behind, stars } => behind.mean_luminance() + stars.mean_luminance(),
        }
    }

    /// The mean over all directions of what the luminance of its picture is above its mean, with all light of the sun and of stars.
    pub fn luminance_above_mean(&self) -> f32 {
        match self {
            Background::Constant { .. } => 0.0,
            Background::CubeMap(map) => map.luminance_above(map.mean_luminance()),
            Background::Environment(environment) => environment.luminance_above_mean(),
            Background::Sky(sky) => sky.luminance_above_mean(),
            Background::Starry { behind, stars } => behind.luminance_above_mean() + stars.mean_luminance(),
        }
    }

    /// Whether no light comes from anywhere.
    pub fn is_black(&self) -> bool {
        match self {
            Background::Constant { emission, .. } => emission.is_black(),
            Background::CubeMap(_) => false,
            Background::Environment(environment) => environment.is_black(),
            Background::Sky(sky) => sky.is_black(),
            Background::Starry { behind, stars } => behind.is_black() && stars.is_black(),
        }
    }
}

/// Six pictures around the scene.
#[derive(Debug)]
pub struct CubeMap {
    faces: [Image; 6],
}

impl CubeMap {
    /// A cube map of the faces right, left, up, down, front, back, each with at least one channel.
    pub fn new(faces: [Image; 6]) -> CubeMap {
        CubeMap { faces }
    }

    /// The brightness of the pictures over a grid as fine as they are.
    fn density(&self, weight: DensityWeight) -> Option<SphereDensity> {
        let pixels = |face: &Image| u64::from(face.width()) * u64::from(face.height());
        let side = self.faces.iter().map(pixels).max().unwrap_or(1).isqrt().clamp(1, 2048) as usize;
        let (width, height) = (4 * side, 2 * side);
        let luminance = |x: usize, y: usize| {
            let uv = Vec2::new((x as f32 + 0.5) / width as f32, (y as f32 + 0.5) / height as f32);
            self.color(direction_of(uv)).luminance()
        };
        SphereDensity::new(width, height, 0.0, luminance, weight)
    }

    /// The mean luminance of all directions.
    fn mean_luminance(&self) -> f32 {
        self.luminance_above(0.0)
    }

    /// The mean over all directions of what the luminance is above a level.
    fn luminance_above(&self, level: f32) -> f32 {
        let (mut sum, mut weights) = (0.0, 0.0);
        for face in &self.faces {
            let [w, h] = [face.width(), face.height()];
            for (x, y) in (0..h).flat_map(|y| (0..w).map(move |x| (x, y))) {
                // The solid angle of a pixel of a cube, up to a factor.
                let [a, b] = [(x, w), (y, h)].map(|(i, n)| 2.0 * (f64::from(i) + 0.5) / f64::from(n) - 1.0);
                let r2 = 1.0 + a * a + b * b;
                let weight = 1.0 / (r2 * r2.sqrt() * f64::from(w) * f64::from(h));
                let luminance = Spectrum::from(Vec3::from(face.rgb(x, y))).luminance();
                sum += weight * f64::from((luminance - level).max(0.0));
                weights += weight;
            }
        }
        (sum / weights) as f32
    }

    /// Which picture shows the direction, and where: `u` to the right and `v` upward, in [0, 1].
    fn face_coordinates(d: Vec3) -> (usize, f32, f32) {
        let a = d.abs();
        let unit = |v: f32| 0.5 * (v + 1.0);
        if a.x >= a.y && a.x >= a.z {
            let (u, v) = (unit(d.z / d.x), unit(d.y / d.x));
            if d.x > 0.0 { (0, u, v) } else { (1, u, 1.0 - v) }
        } else if a.y >= a.z {
            let (u, v) = (unit(d.x / d.y), unit(d.z / d.y));
            if d.y > 0.0 { (2, u, v) } else { (3, 1.0 - u, v) }
        } else {
            let (u, v) = (unit(d.x / d.z), unit(d.y / d.z));
            if d.z > 0.0 { (4, 1.0 - u, v) } else { (5, 1.0 - u, 1.0 - v) }
        }
    }

    fn color(&self, d: Vec3) -> Spectrum {
        let (face, u, v) = CubeMap::face_coordinates(d);
        bilinear(&self.faces[face], u, v)
    }
}

/// The picture's colour between its four nearest pixels; borders are continued.
fn bilinear(image: &Image, u: f32, v: f32) -> Spectrum {
    let split = |at: f32, n: u32| {
        let x = (at * n as f32 - 0.5).clamp(0.0, (n - 1) as f32);
        let low = x.floor();
        (low as u32, (low as u32 + 1).min(n - 1), x - low)
    };
    let (x0, x1, s) = split(u, image.width());
    let (y0, y1, t) = split(1.0 - v, image.height());
    let pixel = |x, y| Spectrum::from(Vec3::from(image.rgb(x, y)));
    pixel(x0, y0).lerp(pixel(x1, y0), s).lerp(pixel(x0, y1).lerp(pixel(x1, y1), s), t)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Faces that show their own number and agree along no edge.
    fn numbered() -> CubeMap {
        CubeMap::new(std::array::from_fn(|i| Image::filled(2, 2, &[i as f32, 0.0, 0.0]).unwrap()))
    }

    #[test]
    fn axes_look_at_their_faces() {
        let map = numbered();
        let axes = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z];
        for (i, d) in axes.into_iter().enumerate() {
            assert_eq!(map.color(3.0 * d)[0], i as f32);
        }
    }

    #[test]
    fn places_within_faces_follow_the_table() {
        let (eps, mid) = (1e-6, 0.75);
        for (d, face, u, v) in [
            (Vec3::new(1.0, 0.5, 0.5), 0, mid, mid),
            (Vec3::new(-1.0, 0.5, 0.5), 1, 1.0 - mid, mid),
            (Vec3::new(0.5, 1.0, 0.5), 2, mid, mid),
            (Vec3::new(0.5, -1.0, 0.5), 3, mid, 1.0 - mid),
            (Vec3::new(0.5, 0.5, 1.0), 4, 1.0 - mid, mid),
            (Vec3::new(0.5, 0.5, -1.0), 5, mid, mid),
        ] {
            let (f, a, b) = CubeMap::face_coordinates(d);
            assert!(f == face && (a - u).abs() < eps && (b - v).abs() < eps, "{d}: {f} {a} {b}");
        }
    }
}
