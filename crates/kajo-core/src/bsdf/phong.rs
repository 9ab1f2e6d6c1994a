//! The Phong model as the classic programs have it, not normalised.
//!
//! ```text
//! L = ka La + sum over lights of I [ kd max(n.l, 0) + ks max(r.v, 0)^q ]
//! ```
//!
//! with `r = 2 (n.l) n - l` the mirror image of the direction to the light and `v` the direction
//! to the viewer. The highlight vanishes where `n.l <= 0`. `0^0` is 1. The older programs
//! use the half vector `h`, the unit vector along `l + v`, and `max(n.h, 0)^q`
//! [Phong 1975], [Blinn 1977].

use kajo_color::Spectrum;
use kajo_math::{Vec3, fmath};

/// Which vector makes the highlight.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Highlight {
    /// The mirror image of the direction to the light [Phong 1975].
    Mirror,
    /// The vector halfway between light and viewer [Blinn 1977].
    Half,
    /// The half vector, times `n.l`: the older programs' `-specular_fix`.
    HalfTimesCosine,
}

/// Reflection and transmission at one point of a Phong material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Phong {
    /// `ka`: colour under ambient light.
    pub ambient: Spectrum,
    /// `kd`: diffuse colour.
    pub diffuse: Spectrum,
    /// `ks`: colour of the highlight.
    pub specular: Spectrum,
    /// `q`: sharpness of the highlight.
    pub exponent: f32,
    /// Factor of what the mirror direction shows.
    pub reflective: Spectrum,
    /// Factor of what is seen through the surface.
    pub transparent: Spectrum,
    /// Absorption inside, per unit length: light is attenuated by `exp(-absorption d)`.
    pub absorption: Spectrum,
    /// Index of refraction inside.
    pub eta: f32,
}

impl Phong {
    /// A surface that reflects nothing.
    pub const BLACK: Phong = Phong {
        ambient: Spectrum::BLACK,
        diffuse: Spectrum::BLACK,
        specular: Spectrum::BLACK,
        exponent: 1.0,
        reflective: Spectrum::BLACK,
        transparent: Spectrum::BLACK,
        absorption: Spectrum::BLACK,
        eta: 1.0,
    };

    /// A surface that is not seen: all light goes straight on.
    pub const CLEAR: Phong = Phong { transparent: Spectrum::WHITE, ..Phong::BLACK };

    /// A diffuse surface of an albedo times a factor, as far as that is one.
    pub fn matte(albedo: [f32; 3], scale: f32) -> Phong {
        let [r, g, b] = albedo.map(|v| (v * scale).clamp(0.0, 1.0));
        let diffuse = Spectrum::rgb(r, g, b);
        Phong { ambient: diffuse, diffuse, ..Phong::BLACK }
    }

    /// Light reflected towards the viewer from one light.
    ///
    /// * `n`: unit normal on the side where the light is to count
    /// * `wo`, `wi`: unit directions to the viewer and to the light
    /// * `intensity`: light that arrives from `wi`
    #[inline(always)]
    pub fn shade(&self, n: Vec3, wo: Vec3, wi: Vec3, intensity: Spectrum, highlight: Highlight) -> Spectrum {
        let cos_i = n.dot(wi);
        if cos_i.is_nan() || cos_i <= 0.0 {
            // Nothing, but of an infinite light, as a falloff of zero makes, that is no number: such
            // points are black in the reference's pictures too.
            return intensity * 0.0;
        }
        let mut reflected = self.diffuse * cos_i;
        if !self.specular.is_black() {
            let alignment = match highlight {
                Highlight::Mirror => (2.0 * cos_i * n - wi).dot(wo),
                Highlight::Half | Highlight::HalfTimesCosine => n.dot((wi + wo).normalize_or_zero()),
            };
            let lobe = fmath::pow(alignment.max(0.0), self.exponent);
            let lobe = if highlight == Highlight::HalfTimesCosine { lobe * cos_i } else { lobe };
            reflected += self.specular * lobe;
        }
        intensity * reflected
    }

    /// The same where a relief tilts the diffuse part further than the highlight.
    ///
    /// * `n`: of the highlight
    /// * `diffuse_n`: of the diffuse part
    #[inline(never)]
    pub fn shade_with_two_normals(
        &self,
        n: Vec3,
        diffuse_n: Vec3,
        wo: Vec3,
        wi: Vec3,
        intensity: Spectrum,
        highlight: Highlight,
    ) -> Spectrum {
        let matt = Phong { specular: Spectrum::BLACK, ..*self };
        let glossy = Phong { diffuse: Spectrum::BLACK, ..*self };
        matt.shade(diffuse_n, wo, wi, intensity, highlight) + glossy.shade(n, wo, wi, intensity, highlight)
    }

    /// Every factor mixed with that of `other`: `(1 - t) self + t other`.
    pub fn lerp(&self, other: &Phong, t: f32) -> Phong {
        let mix = |a: f32, b: f32| a * (1.0 - t) + b * t;
        Phong {
            ambient: self.ambient.lerp(other.ambient, t),
            diffuse: self.diffuse.lerp(other.diffuse, t),
            specular: self.specular.lerp(other.specular, t),
            exponent: mix(self.exponent, other.exponent),
            reflective: self.reflective.lerp(other.reflective, t),
            transparent: self.transparent.lerp(other.transparent, t),
            absorption: self.absorption.lerp(other.absorption, t),
            eta: mix(self.eta, other.eta),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo_math::{Vec2, rng::Stream, warp};

    fn plain() -> Phong {
        Phong {
            ambient: Spectrum::WHITE,
            diffuse: Spectrum::rgb(0.2, 0.5, 0.7),
            specular: Spectrum::grey(0.4),
            exponent: 7.5,
            reflective: Spectrum::BLACK,
            transparent: Spectrum::BLACK,
            absorption: Spectrum::BLACK,
            eta: 1.0,
        }
    }

    /// The formula of the module head, in double precision and with its own algebra.
    #[test]
    fn a_thousand_random_directions_follow_the_formula() {
        let phong = plain();
        for i in 0..1000 {
            let s = Stream::new(11, [i, 0], 0);
            let direction = |k| warp::uniform_sphere(Vec2::new(s.uniform(k), s.uniform(k + 1)));
            let (n, wo, wi) = (direction(0), direction(2), direction(4));
            let got = phong.shade(n, wo, wi, Spectrum::WHITE, Highlight::Mirror);
            let (n, wo, wi) = (n.as_dvec3(), wo.as_dvec3(), wi.as_dvec3());
            let cos = n.dot(wi);
            // The mirror image by projection: what is along n stays, what is across turns round.
            let along = n * cos;
            let mirrored = along - (wi - along);
            for lane in 0..3 {
                let lobe = if cos > 0.0 { mirrored.dot(wo).max(0.0).powf(7.5) } else { 0.0 };
                let expected = f64::from(phong.diffuse[lane]) * cos.max(0.0) + 0.4 * lobe;
                assert!((f64::from(got[lane]) - expected).abs() < 1e-5, "{i}: {got:?} {expected}");
            }
        }
    }

    #[test]
    fn highlights_differ_by_their_vector_and_stop_at_the_horizon() {
        let phong = Phong { exponent: 0.0, ..plain() };
        let wo = Vec3::new(1.0, 0.0, 1.0).normalize();
        for highlight in [Highlight::Mirror, Highlight::Half, Highlight::HalfTimesCosine] {
            let below = phong.shade(Vec3::Z, wo, Vec3::new(0.0, 0.6, -0.8), Spectrum::WHITE, highlight);
            assert!(below.is_black());
            let endless = Spectrum::grey(f32::INFINITY);
            assert!(!phong.shade(Vec3::Z, wo, Vec3::NEG_Z, endless, highlight).is_finite());
        }
        let wi = Vec3::new(0.0, 0.6, 0.8);
        let full = phong.shade(Vec3::Z, wo, wi, Spectrum::WHITE, Highlight::Mirror);
        assert!((full[0] - (0.2 * 0.8 + 0.4)).abs() < 1e-6, "0^0 is 1: {full:?}");
        let fixed = phong.shade(Vec3::Z, wo, wi, Spectrum::WHITE, Highlight::HalfTimesCosine);
        assert!((fixed[0] - (0.2 * 0.8 + 0.4 * 0.8)).abs() < 1e-6);
    }
}
