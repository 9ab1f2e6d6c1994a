//! A point light that shines into a cone.
//!
//! ```text
//! I(theta) = I s((cos theta - cos outer) / (cos inner - cos outer)),   s(x) = x^2 (3 - 2 x)
//! ```
//!
//! with `x` cut off to [0, 1]: full within the inner angle, nothing beyond the outer one. The power
//! is `2 pi I (1 - (cos inner + cos outer) / 2)`.
//!
//! Cosines of small angles are near 1, and their differences have lost their digits. So a cone keeps `1 - cos`, which of
//! unit vectors `d` and `a` is `|d - a|^2 / 2`.
//!
//! Scene: `SpotLight { position 0 5 0  direction 0 -1 0  color 1 1 1  angle 40  innerAngle 30 }`

use std::f32::consts::TAU;

use kajo_color::{Emission, Wavelengths};
use kajo_math::{Frame, Vec2, Vec3, fmath, warp};

use super::{
    BoundingSphere, EmissionPdf, EmissiveSurfaces, Emitter, Illumination, LeNumbers, LightBounds,
    LightLeSample, LightLiSample, LightOutline, LightPoint, PointLight, Receiver,
};

/// A spot light.
#[derive(Clone, Debug)]
pub struct SpotLight {
    /// Position, intensity on the axis, falloff with distance.
    pub point: PointLight,
    /// Unit direction of the axis, away from the light.
    pub axis: Vec3,
    /// Where it shines.
    pub cone: SpotCone,
}

/// A cone with a soft edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpotCone {
    /// `1 - cos` of the half angle within which light is full.
    pub inner: f32,
    /// `1 - cos` of the half angle beyond which there is none; at least `inner`.
    pub outer: f32,
}

impl SpotCone {
    /// The cone of these half angles in radians, of which the first is not the larger one.
    pub fn new(inner: f32, outer: f32) -> SpotCone {
        SpotCone { inner: fmath::one_minus_cos(inner), outer: fmath::one_minus_cos(outer) }
    }

    /// The power of a light in the cone over that of one as bright in all directions.
    pub fn share_of_sphere(self) -> f32 {
        0.25 * (self.inner + self.outer)
    }

    /// Share of the intensity on the axis that there is in another direction.
    ///
    /// * `one_minus_cos`: `1 - cos` of the angle with the axis
    #[inline]
    pub fn profile(self, one_minus_cos: f32) -> f32 {
        if one_minus_cos <= self.inner {
            return 1.0;
        }
        let x = ((self.outer - one_minus_cos) / (self.outer - self.inner)).clamp(0.0, 1.0);
        x * x * (3.0 - 2.0 * x)
    }
}

impl SpotLight {
    /// Share of the axis' intensity in the unit direction `d`, away from the light.
    #[inline]
    pub fn profile(&self, d: Vec3) -> f32 {
        self.cone.profile(0.5 * d.distance_squared(self.axis))
    }

    /// Density per solid angle of the directions into which light leaves.
    fn pdf_leaving(&self) -> f32 {
        1.0 / (TAU * self.cone.outer)
    }
}

impl Emitter for SpotLight {
    #[inline]
    fn illuminate(&self, p: Vec3, time: f32) -> Illumination {
        let arriving = self.point.illuminate(p, time);
        Illumination { intensity: arriving.intensity * self.profile(-arriving.wi), ..arriving }
    }

    fn is_finite(&self) -> bool {
        let cone = [self.cone.inner, self.cone.outer];
        self.point.is_finite() && self.axis.is_finite() && cone.iter().all(|v| v.is_finite())
    }

    #[inline]
    fn sample_li<S: EmissiveSurfaces>(
        &self,
        to: &Receiver,
        u: Vec2,
        wavelengths: &Wavelengths,
        surfaces: &S,
    ) -> Option<LightLiSample> {
        let sample = self.point.sample_li(to, u, wavelengths, surfaces)?;
        let share = self.profile(-sample.wi);
        (share > 0.0).then(|| LightLiSample { radiance: sample.radiance * share, ..sample })
    }

    fn pdf_li(&self, to: &Receiver, at: &LightPoint, wi: Vec3) -> f32 {
        if self.profile(-wi) > 0.0 { self.point.pdf_li(to, at, wi) } else { 0.0 }
    }

    fn is_pointlike(&self) -> bool {
        true
    }

    fn is_unfading(&self) -> bool {
        self.point.is_unfading()
    }

    fn apex(&self) -> Option<Vec3> {
        self.point.apex()
    }

    fn outline(&self) -> LightOutline {
        let cosines = [self.cone.inner, self.cone.outer].map(|one_minus_cos| 1.0 - one_minus_cos);
        LightOutline::Cone { apex: self.point.position, axis: self.axis, cosines }
    }

    fn bounds(&self) -> Option<LightBounds> {
        // Within its cone it is as bright as the point light; that it is dark elsewhere is in the reach.
        let point = self.point.point_bounds();
        Some(LightBounds { axis: self.axis, cos_spread: 1.0, cos_reach: 1.0 - self.cone.outer, ..point })
    }

    fn sample_le<S: EmissiveSurfaces>(
        &self,
        _time: f32,
        u: LeNumbers,
        wavelengths: &Wavelengths,
        _world: &BoundingSphere,
        _surfaces: &S,
    ) -> Option<LightLeSample> {
        let d = Frame::from_normal(self.axis).to_world(warp::uniform_cone(u.direction, self.cone.outer));
        let leaving = self.point.leaving(d, self.pdf_leaving(), wavelengths);
        Some(LightLeSample { radiance: leaving.radiance * self.profile(d), ..leaving })
    }

    fn pdf_le(&self, _time: f32, at: &LightPoint, d: Vec3, _world: &BoundingSphere) -> EmissionPdf {
        let direction = if self.profile(d) > 0.0 { self.pdf_leaving() } else { 0.0 };
        EmissionPdf::at_point(self.point.is_at(at), direction)
    }

    fn power(&self, _world: &BoundingSphere) -> f32 {
        self.point.point_bounds().power * self.cone.share_of_sphere()
    }

    fn emission(&self) -> Option<&Emission> {
        self.point.emission()
    }
}

#[cfg(test)]
mod tests {
    use super::super::LightTree;
    use super::*;
    use crate::ids::LightIndex;
    use kajo_color::{Emission, Spectrum};

    fn spot(inner: f32, outer: f32) -> SpotLight {
        let point = PointLight {
            position: Vec3::ZERO,
            intensity: Spectrum::WHITE,
            emission: Emission::from_rgb([1.0; 3]),
            attenuation: [0.0, 0.0, 1.0],
        };
        SpotLight { point, axis: Vec3::NEG_Y, cone: SpotCone::new(inner.to_radians(), outer.to_radians()) }
    }

    /// A direction by the cosine of its angle with the axis.
    fn at(cos: f64) -> Vec3 {
        Vec3::new((1.0 - cos * cos).max(0.0).sqrt() as f32, -cos as f32, 0.0)
    }

    #[test]
    fn the_profile_is_full_then_smooth_then_nothing() {
        let light = spot(20.0, 40.0);
        let [inner, outer] = [20.0f64, 40.0].map(|degrees| degrees.to_radians().cos());
        assert_eq!((light.profile(at(1.0)), light.profile(at(inner + 1e-4))), (1.0, 1.0));
        assert!((light.profile(at(0.5 * (inner + outer))) - 0.5).abs() < 1e-6);
        assert_eq!((light.profile(at(outer - 1e-4)), light.profile(at(-1.0))), (0.0, 0.0));
        // A hard edge is allowed.
        let (hard, edge) = (spot(30.0, 30.0), 30f64.to_radians().cos());
        assert_eq!((hard.profile(at(edge + 1e-6)), hard.profile(at(edge - 1e-6))), (1.0, 0.0));
    }

    /// A cone of a degree keeps the digits that differences of its cosines, which are near 1, have not.
    #[test]
    fn the_edge_of_a_narrow_cone_has_all_its_digits() {
        let (light, cos) = (spot(0.4, 0.5), |degrees: f64| degrees.to_radians().cos());
        for i in 1..10 {
            let c = cos(0.4 + 0.01 * f64::from(i));
            let x = (c - cos(0.5)) / (cos(0.4) - cos(0.5));
            let expected = x * x * (3.0 - 2.0 * x);
            let found = f64::from(light.profile(at(c)));
            assert!((found - expected).abs() < 2e-6, "{found} for {expected}");
        }
    }

    #[test]
    fn power_is_the_integral_of_the_profile() {
        for (inner, outer) in [(0.0, 60.0), (25.0, 30.0), (10.0, 90.0)] {
            let light = spot(inner, outer);
            let n = 20_000;
            let step = 2.0 / n as f32;
            let sum: f32 =
                (0..n).map(|i| light.profile(at(f64::from(-1.0 + (i as f32 + 0.5) * step))) * step).sum();
            let power = TAU * sum;
            let world = BoundingSphere { center: Vec3::ZERO, radius: 1.0 };
            assert!((light.power(&world) / power - 1.0).abs() < 1e-3, "{inner} {outer}");
        }
    }

    /// Of two lights that a receiver gets the same light from, each is chosen as often as the other.
    #[test]
    fn a_narrow_cone_is_chosen_for_what_arrives_from_it() {
        let narrow = spot(4.0, 5.0);
        let point = PointLight { position: Vec3::X, ..narrow.point.clone() };
        let tree = LightTree::build(&[narrow.bounds(), point.bounds()]);
        let first = LightIndex::new(0).expect("an index");
        let chance = |p: Vec3| {
            let to = Receiver { p, n: Vec3::Y, time: 0.0 };
            tree.pmf(first, &to, &tree.first_step(&to))
        };
        let between = chance(Vec3::new(0.0, -30.0, 0.0));
        assert!((between - 0.5).abs() < 0.01, "{between}");
        assert_eq!(chance(Vec3::new(9.0, -30.0, 0.0)), 0.0, "outside its cone");
    }
}
