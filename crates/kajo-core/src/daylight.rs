//! A clear sky with the sun in it.
//!
//! The sky's luminance and chromaticity in a direction at the angle `theta` from straight up and `gamma` from the
//! sun, for the sun at `theta_s`, are
//!
//! ```text
//! Y = Yz F(theta, gamma) / F(0, theta_s),   F = (1 + A e^(B / cos theta)) (1 + C e^(D gamma) + E cos^2 gamma)
//! ```
//!
//! and so for x and y; `A` to `E` and the values straight up depend on the turbidity and the sun's height
//! [Preetham et al. 1999]. The model was fitted to simulations for turbidities from 2 to 6. It is too bright near the
//! sun at low heights, and as a whole half as bright again as clear skies are measured; it knows neither dusk nor clouds.
//!
//! The sun is an even disc of a black body of 5778 K, dimmed on its way through `m` air masses by air and haze,
//!
//! ```text
//! T = exp(-0.008735 l^-4.08 m) exp(-beta l^-1.3 m),      beta = 0.04608 turbidity - 0.04586
//! ```
//!
//! for wavelengths `l` in micrometres [Preetham et al. 1999, appendix]; ozone and water are left out.
//! Luminances are in thousands of cd/m². Below the horizon lies even ground that sun and sky light.
//!
//! Scene: `Background { sky { turbidity 3  elevation 40  azimuth 120  scale 0.05 } }`

use std::f32::consts::{FRAC_1_PI, PI};

use kajo_color::emission::planck;
use kajo_color::matrix::apply;
use kajo_color::{Emission, Outside, RgbBasis, Spectrum, Tabulated, Wavelengths, sensor};
use kajo_math::{Vec2, Vec3, fmath};

use crate::environment::{DensityWeight, Environment, SphereDensity, direction_of};
use crate::sky_disc::SkyDisc;

/// `1 - cos r` for the sun's angular radius of 0.2666 degrees.
const SUN_DISC: f32 = 1.0826e-5;

/// Luminance of the sun's disc above the air, in thousands of cd/m²: 128 klx over its solid angle.
const SUN_LUMINANCE: f32 = 128.0 / (2.0 * PI * SUN_DISC);

/// Size of the picture of the sky.
const WIDTH: u32 = 512;
const HEIGHT: u32 = 256;

/// What a clear sky is like.
#[derive(Clone, Copy, Debug)]
pub struct SkySettings {
    /// Haze: 2 is very clear, 3 clear, 6 hazy; in [2, 10].
    pub turbidity: f32,
    /// Height of the sun in degrees, in [0, 90].
    pub elevation_deg: f32,
    /// Where the sun stands in degrees: 0 is -z, 90 is +x.
    pub azimuth_deg: f32,
    /// Reflectance of the ground.
    pub ground: f32,
    /// Factor of all light.
    pub scale: f32,
    /// Whether the sun itself is there.
    pub sun: bool,
}

/// A clear sky.
#[derive(Debug)]
pub struct Sky {
    picture: Environment,
    /// The sun, unless it is left out.
    pub sun: Option<Sun>,
    sky_irradiance: f32,
}

/// The sun's disc.
#[derive(Clone, Debug)]
pub struct Sun {
    /// Unit direction to its middle.
    pub direction: Vec3,
    /// Radiance.
    pub radiance: Emission,
}

impl Sun {
    /// Solid angle of the disc.
    pub const SOLID_ANGLE: f32 = 2.0 * PI * SUN_DISC;

    /// Its place in the sky.
    #[inline]
    pub fn disc(&self) -> SkyDisc {
        SkyDisc { middle: self.direction, height: SUN_DISC }
    }
}

impl Sky {
    /// The sky of these settings.
    pub fn new(settings: &SkySettings) -> Sky {
        let turbidity = settings.turbidity.clamp(2.0, 10.0);
        let theta_s = (90.0 - settings.elevation_deg.clamp(0.0, 90.0)).to_radians();
        let (sin, cos) = fmath::sin_cos(settings.azimuth_deg.to_radians());
        let (sin_s, cos_s) = fmath::sin_cos(theta_s);
        let to_sun = Vec3::new(sin_s * sin, cos_s, -sin_s * cos);
        let radiance = sun_radiance(turbidity, theta_s).scaled(settings.scale);
        let sun = settings.sun.then_some(Sun { direction: to_sun, radiance });

        let dome = Dome::new(turbidity, theta_s);
        let place =
            |x: u32, y: u32| Vec2::new((x as f32 + 0.5) / WIDTH as f32, (y as f32 + 0.5) / HEIGHT as f32);
        // Half the rows show the sky; the others are filled once its light is known.
        let (mut pixels, mut irradiance) = (Vec::new(), Vec3::ZERO);
        for y in 0..HEIGHT / 2 {
            for x in 0..WIDTH {
                let d = direction_of(place(x, y));
                let rgb = settings.scale * dome.rgb(d, to_sun);
                let solid_angle = 2.0 * PI * PI / (WIDTH * HEIGHT) as f32
                    * fmath::sin(PI * (y as f32 + 0.5) / HEIGHT as f32);
                irradiance += rgb * (d.y * solid_angle);
                pixels.push(rgb);
            }
        }
        let from_sun =
            sun.as_ref().map_or(Vec3::ZERO, |sun| Vec3::from(sun.radiance.rgb()) * Sun::SOLID_ANGLE * cos_s);
        let ground = (irradiance + from_sun) * (settings.ground / PI);
        let rgb = |x, y: u32| if y < HEIGHT / 2 { pixels[(y * WIDTH + x) as usize] } else { ground };
        let picture = Environment::from_fn(WIDTH as usize, HEIGHT as usize, |x, y| rgb(x as u32, y as u32));
        Sky { picture, sun, sky_irradiance: Spectrum::from(irradiance).luminance() }
    }

    /// Linear RGB from the direction `d`, not necessarily of unit length.
    #[inline]
    pub fn color(&self, d: Vec3) -> Spectrum {
        let sky = self.picture.color(d);
        match self.sun_in(d) {
            Some(sun) => sky + Spectrum::from(Vec3::from(sun.radiance.rgb())),
            None => sky,
        }
    }

    /// Radiance from the direction `d`, not necessarily of unit length.
    #[inline]
    pub fn radiance(&self, d: Vec3, wavelengths: &Wavelengths) -> Spectrum {
        let sky = RgbBasis::new(wavelengths).emission(self.picture.color(d).to_rgb());
        match self.sun_in(d) {
            Some(sun) => sky + sun.radiance.at(wavelengths),
            None => sky,
        }
    }

    fn sun_in(&self, d: Vec3) -> Option<&Sun> {
        self.sun.as_ref().filter(|sun| sun.disc().covers(d))
    }

    /// The density in proportion to the brightness of sky and ground, without the sun.
    pub fn density(&self, weight: DensityWeight) -> Option<SphereDensity> {
        self.picture.density(weight)
    }

    /// The mean luminance over all directions of the sky, the ground and the sun.
    pub fn mean_luminance(&self) -> f32 {
        self.picture.mean_luminance() + self.mean_luminance_of_sun()
    }

    /// The mean over all directions of what the luminance of sky and ground is above its mean, with all light of the sun.
    pub fn luminance_above_mean(&self) -> f32 {
        self.picture.luminance_above_mean() + self.mean_luminance_of_sun()
    }

    fn mean_luminance_of_sun(&self) -> f32 {
        let sun = self.sun.as_ref().map_or(0.0, |sun| sun.radiance.luminance() * Sun::SOLID_ANGLE);
        0.25 * FRAC_1_PI * sun
    }

    /// Whether there is no light.
    pub fn is_black(&self) -> bool {
        self.picture.is_black()
    }

    /// The share of drawn directions that are to go to the sun.
    pub fn sun_share(&self) -> f32 {
        let sun = self.sun.as_ref().map_or(0.0, |sun| sun.radiance.luminance() * Sun::SOLID_ANGLE);
        let share = sun / (sun + self.sky_irradiance).max(f32::MIN_POSITIVE);
        // Neither may be forgotten: either may be hidden.
        if self.sun.is_some() { share.clamp(0.2, 0.7) } else { 0.0 }
    }
}

/// Radiance of the sun's disc through the air, for the sun at `theta_s` from straight up.
fn sun_radiance(turbidity: f32, theta_s: f32) -> Emission {
    const KELVIN: f64 = 5778.0;
    let degrees = theta_s.to_degrees();
    let air_mass = 1.0 / (fmath::cos(theta_s) + 0.15 * fmath::pow(93.885 - degrees, -1.253));
    let beta = 0.04608 * turbidity - 0.04586;
    let at = |nm: u32, air_mass: f32| {
        let l = 1e-3 * nm as f32;
        let thickness = 0.008735 * fmath::pow(l, -4.08) + beta * fmath::pow(l, -1.3);
        let shape = planck(f64::from(nm), KELVIN) / planck(560.0, KELVIN);
        (nm as f32, shape as f32 * fmath::exp(-thickness * air_mass))
    };
    let table =
        |air_mass: f32| Tabulated::new((360..=830).step_by(10).map(|nm| at(nm, air_mass)), Outside::Zero);
    match (table(0.0), table(air_mass)) {
        (Ok(above), Ok(below)) => {
            let unit = Emission::from_spectrum(above, 1.0).luminance();
            Emission::from_spectrum(below, SUN_LUMINANCE / unit)
        }
        _ => Emission::BLACK,
    }
}

/// The sky's light by direction.
struct Dome {
    /// For Y, x and y: the value straight up over `F(0, theta_s)`, and A to E.
    parts: [(f32, [f32; 5]); 3],
}

impl Dome {
    fn new(t: f32, theta_s: f32) -> Dome {
        let coefficients = [
            [[0.1787, -1.4630], [-0.3554, 0.4275], [-0.0227, 5.3251], [0.1206, -2.5771], [-0.0670, 0.3703]],
            [[-0.0193, -0.2592], [-0.0665, 0.0008], [-0.0004, 0.2125], [-0.0641, -0.8989], [-0.0033, 0.0452]],
            [[-0.0167, -0.2608], [-0.0950, 0.0092], [-0.0079, 0.2102], [-0.0441, -1.6537], [-0.0109, 0.0529]],
        ]
        .map(|rows| rows.map(|[slope, start]| slope * t + start));
        let chi = (4.0 / 9.0 - t / 120.0) * (PI - 2.0 * theta_s);
        let luminance = (4.0453 * t - 4.9710) * fmath::tan(chi) - 0.2155 * t + 2.4192;
        let x = zenith(
            t,
            theta_s,
            [
                [0.00166, -0.00375, 0.00209, 0.0],
                [-0.02903, 0.06377, -0.03202, 0.00394],
                [0.11693, -0.21196, 0.06052, 0.25886],
            ],
        );
        let y = zenith(
            t,
            theta_s,
            [
                [0.00275, -0.00610, 0.00317, 0.0],
                [-0.04214, 0.08970, -0.04153, 0.00516],
                [0.15346, -0.26756, 0.06670, 0.26688],
            ],
        );
        let up = [luminance.max(0.0), x, y];
        let part = |i: usize| (up[i] / perez(&coefficients[i], 1.0, theta_s), coefficients[i]);
        Dome { parts: [part(0), part(1), part(2)] }
    }

    /// Linear sRGB from a direction above the horizon, none of it negative.
    fn rgb(&self, d: Vec3, to_sun: Vec3) -> Vec3 {
        let gamma = fmath::acos(d.dot(to_sun).clamp(-1.0, 1.0));
        let [luminance, x, y] =
            self.parts.map(|(factor, coefficients)| factor * perez(&coefficients, d.y.max(1e-3), gamma));
        let by_y = f64::from(luminance) / f64::from(y);
        let xyz = [f64::from(x) * by_y, f64::from(luminance), f64::from(1.0 - x - y) * by_y];
        let rgb = apply(&sensor::RGB_FROM_XYZ, xyz).map(|v| v as f32);
        let rgb = Vec3::from(rgb).max(Vec3::ZERO);
        if rgb.is_finite() { rgb } else { Vec3::ZERO }
    }
}

/// `F` of the module.
fn perez([a, b, c, d, e]: &[f32; 5], cos_theta: f32, gamma: f32) -> f32 {
    let cos = fmath::cos(gamma);
    (1.0 + a * fmath::exp(b / cos_theta)) * (1.0 + c * fmath::exp(d * gamma) + e * cos * cos)
}

/// A chromaticity straight up: a polynomial in the turbidity and the sun's angle.
fn zenith(t: f32, theta_s: f32, rows: [[f32; 4]; 3]) -> f32 {
    let [a, b, c] = rows.map(|[p, q, r, s]| ((p * theta_s + q) * theta_s + r) * theta_s + s);
    (a * t + b) * t + c
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sky(turbidity: f32, elevation_deg: f32) -> Sky {
        let settings =
            SkySettings { turbidity, elevation_deg, azimuth_deg: 90.0, ground: 0.2, scale: 1.0, sun: true };
        Sky::new(&settings)
    }

    /// Illuminance of a level place by the sky alone, in klx.
    fn from_sky(sky: &Sky) -> f32 {
        sky.sky_irradiance
    }

    /// Illuminance of a level place by the sun alone, in klx.
    fn from_sun(sky: &Sky) -> f32 {
        let sun = sky.sun.as_ref().unwrap();
        sun.radiance.luminance() * Sun::SOLID_ANGLE * sun.direction.y
    }

    #[test]
    fn straight_up_is_what_the_tables_say() {
        // Turbidity 3, sun at 45 degrees, by the formulas in double precision.
        let dome = Dome::new(3.0, PI / 4.0);
        let to_sun = Vec3::new(0.5f32.sqrt(), 0.5f32.sqrt(), 0.0);
        let rgb = dome.rgb(Vec3::Y, to_sun);
        let luminance = Spectrum::from(rgb).luminance();
        let chi = (4.0f64 / 9.0 - 3.0 / 120.0) * std::f64::consts::FRAC_PI_2;
        let expected = (4.0453 * 3.0 - 4.9710) * chi.tan() - 0.2155 * 3.0 + 2.4192;
        assert!((f64::from(luminance) / expected - 1.0).abs() < 1e-3, "{luminance} for {expected}");
        assert!(rgb.z > rgb.y && rgb.y > rgb.x, "blue: {rgb}");
    }

    #[test]
    fn illuminances_are_those_of_clear_days() {
        // The sky's by a fine sum of the formulas in double precision; a clear day has some 70 to 110 klx of sun
        // across its rays.
        for (elevation, dome, sun) in [(60.0, 31.5305, 60.0..100.0), (30.0, 24.0049, 25.0..50.0)] {
            let sky = sky(3.0, elevation);
            assert!((from_sky(&sky) / dome - 1.0).abs() < 2e-3, "{elevation}: sky {}", from_sky(&sky));
            assert!(sun.contains(&from_sun(&sky)), "{elevation}: sun {}", from_sun(&sky));
        }
    }

    #[test]
    fn the_sun_reddens_as_it_sinks_and_dims_with_haze() {
        let red = |elevation: f32| {
            let [r, _, b] = sky(3.0, elevation).sun.unwrap().radiance.rgb();
            r / b.max(1e-9)
        };
        assert!(red(60.0) < red(20.0) && red(20.0) < red(5.0), "{} {} {}", red(60.0), red(20.0), red(5.0));
        assert!(from_sun(&sky(2.0, 40.0)) > 1.2 * from_sun(&sky(6.0, 40.0)));
    }

    #[test]
    fn haze_makes_the_sky_paler() {
        let away = |turbidity: f32| {
            let rgb = sky(turbidity, 40.0).color(Vec3::new(-1.0, 0.7, 0.2)).to_rgb();
            rgb[2] / rgb[0]
        };
        assert!(away(2.0) > 1.2 * away(6.0), "{} {}", away(2.0), away(6.0));
    }

    #[test]
    fn the_sun_is_a_disc_where_it_should_be() {
        let sky = sky(3.0, 30.0);
        let sun = sky.sun.as_ref().unwrap();
        let aside = |degrees: f32| {
            let (sin, cos) = fmath::sin_cos(degrees.to_radians());
            7.0 * (cos * sun.direction + sin * Vec3::Z)
        };
        assert!(sun.direction.distance(Vec3::new(0.75f32.sqrt(), 0.5, 0.0)) < 1e-5);
        let covers = |d| sun.disc().covers(d);
        assert!(covers(aside(0.26)) && !covers(aside(0.275)) && !covers(-aside(0.0)));
        assert!(sky.color(aside(0.2)).luminance() > 1e5 && sky.color(aside(0.4)).luminance() < 100.0);
        assert!((SUN_DISC / (1.0 - 0.2666f64.to_radians().cos()) as f32 - 1.0).abs() < 1e-3);
    }

    #[test]
    fn every_sky_is_finite_and_none_is_negative() {
        for turbidity in [f32::MIN, 2.0, 5.0, 10.0, 99.0] {
            for elevation in [-5.0, 0.0, 1.0, 45.0, 90.0, 180.0] {
                let sky = sky(turbidity, elevation);
                assert!(
                    sky.sky_irradiance.is_finite() && sky.density(DensityWeight::All).is_some(),
                    "{turbidity} {elevation}"
                );
                let share = sky.sun_share();
                assert!((0.2..=0.7).contains(&share));
            }
        }
    }
}
