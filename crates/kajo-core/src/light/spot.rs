//! A point light that shines into a cone.
//!
//! ```text
//! I(theta) = I s((cos theta - cos outer) / (cos inner - cos outer)),   s(x) = x^2 (3 - 2 x)
//! ```
//!
//! with `x` cut off to [0, 1]: full within the inner angle, nothing beyond the outer one. The power
//! is `2 pi I (1 - (cos inner + cos outer) / 2)`.
//!
//! Scene: `SpotLight { position 0 5 0  direction 0 -1 0  color 1 1 1  angle 40  innerAngle 30 }`

use std::f32::consts::TAU;

use kajo_color::{Emission, Wavelengths};
use kajo_math::{Frame, Vec2, Vec3, warp};

use super::{Ball, EmissionPdf, Emitted, Emitter, Illumination, LightBounds, LightSample, PointLight};

/// A spot light.
#[derive(Clone, Debug)]
pub struct SpotLight {
    /// Position, intensity on the axis, falloff with distance.
    pub point: PointLight,
    /// Unit direction of the axis, away from the light.
    pub axis: Vec3,
    /// Cosine of the half angle within which the light is full.
    pub cos_inner: f32,
    /// Cosine of the half angle beyond which there is none; not above `cos_inner`.
    pub cos_outer: f32,
}

impl SpotLight {
    /// Share of the axis' intensity in a direction whose cosine with the axis is `cos`.
    #[inline]
    pub fn profile(&self, cos: f32) -> f32 {
        if cos >= self.cos_inner {
            return 1.0;
        }
        let x = ((cos - self.cos_outer) / (self.cos_inner - self.cos_outer)).clamp(0.0, 1.0);
        x * x * (3.0 - 2.0 * x)
    }

    /// Density per solid angle of the directions into which light leaves.
    fn pdf(&self) -> f32 {
        1.0 / (TAU * (1.0 - self.cos_outer))
    }
}

impl Emitter for SpotLight {
    #[inline]
    fn illuminate(&self, p: Vec3, time: f32) -> Illumination {
        let arriving = self.point.illuminate(p, time);
        Illumination { intensity: arriving.intensity * self.profile(-arriving.wi.dot(self.axis)), ..arriving }
    }

    #[inline]
    fn sample(&self, p: Vec3, time: f32, u: Vec2, wavelengths: &Wavelengths) -> Option<LightSample> {
        let sample = self.point.sample(p, time, u, wavelengths)?;
        let share = self.profile(-sample.wi.dot(self.axis));
        (share > 0.0).then(|| LightSample { radiance: sample.radiance * share, ..sample })
    }

    fn bounds(&self) -> Option<LightBounds> {
        // Within its cone it is as bright as the point light; that it is dark elsewhere is in the reach.
        let point = self.point.point_bounds();
        Some(LightBounds { axis: self.axis, cos_spread: 1.0, cos_reach: self.cos_outer, ..point })
    }

    fn emit(&self, _time: f32, u: [Vec2; 2], wavelengths: &Wavelengths, _world: &Ball) -> Option<Emitted> {
        let local = warp::uniform_cone(u[1], 1.0 - self.cos_outer);
        let emitted =
            self.point.emitted(Frame::from_normal(self.axis).to_world(local), self.pdf(), wavelengths);
        let radiance = emitted.radiance * self.profile(local.z);
        Some(Emitted { radiance, ..emitted })
    }

    fn emission_pdf(&self, _time: f32, _at: [Vec3; 2], d: Vec3, _world: &Ball) -> EmissionPdf {
        let direction = if self.profile(d.dot(self.axis)) > 0.0 { self.pdf() } else { 0.0 };
        EmissionPdf { place: 1.0, direction }
    }

    fn power(&self, _world: &Ball) -> f32 {
        let cone = 0.5 * (1.0 - 0.5 * (self.cos_inner + self.cos_outer));
        self.point.point_bounds().power * cone
    }

    fn emission(&self) -> Option<&Emission> {
        self.point.emission()
    }
}

#[cfg(test)]
mod tests {
    use super::super::{LightChoice, LightTree};
    use super::*;
    use kajo_color::{Emission, Spectrum};

    fn spot(inner: f32, outer: f32) -> SpotLight {
        let point = PointLight {
            position: Vec3::ZERO,
            intensity: Spectrum::WHITE,
            emission: Emission::from_rgb([1.0; 3]),
            attenuation: [0.0, 0.0, 1.0],
        };
        let cos = |degrees: f32| kajo_math::fmath::cos(degrees.to_radians());
        SpotLight { point, axis: Vec3::NEG_Y, cos_inner: cos(inner), cos_outer: cos(outer) }
    }

    #[test]
    fn the_profile_is_full_then_smooth_then_nothing() {
        let light = spot(20.0, 40.0);
        let middle = 0.5 * (light.cos_inner + light.cos_outer);
        assert_eq!((light.profile(1.0), light.profile(light.cos_inner)), (1.0, 1.0));
        assert!((light.profile(middle) - 0.5).abs() < 1e-5);
        assert_eq!((light.profile(light.cos_outer), light.profile(-1.0)), (0.0, 0.0));
        // A hard edge is allowed.
        let hard = spot(30.0, 30.0);
        assert_eq!((hard.profile(hard.cos_inner), hard.profile(hard.cos_inner - 1e-3)), (1.0, 0.0));
    }

    #[test]
    fn power_is_the_integral_of_the_profile() {
        for (inner, outer) in [(0.0, 60.0), (25.0, 30.0), (10.0, 90.0)] {
            let light = spot(inner, outer);
            let n = 20_000;
            let step = 2.0 / n as f32;
            let sum: f32 = (0..n).map(|i| light.profile(-1.0 + (i as f32 + 0.5) * step) * step).sum();
            let power = TAU * sum;
            let world = Ball { center: Vec3::ZERO, radius: 1.0 };
            assert!((light.power(&world) / power - 1.0).abs() < 1e-3, "{inner} {outer}");
        }
    }

    /// Of two lamps that a place gets the same light from, each is chosen as often as the other.
    #[test]
    fn a_narrow_cone_is_chosen_for_what_arrives_from_it() {
        let narrow = spot(4.0, 5.0);
        let point = PointLight { position: Vec3::X, ..narrow.point.clone() };
        let tree = LightTree::build(&[narrow.bounds(), point.bounds()]);
        let chance = |p: Vec3| tree.probability(0, p, Vec3::Y, LightChoice::Tree);
        let between = chance(Vec3::new(0.0, -30.0, 0.0));
        assert!((between - 0.5).abs() < 0.01, "{between}");
        assert_eq!(chance(Vec3::new(9.0, -30.0, 0.0)), 0.0, "outside its cone");
    }
}
