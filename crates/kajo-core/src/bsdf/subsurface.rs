//! Layers over a body that light enters, is scattered in, and leaves elsewhere.
//!
//! In the place of a share `w` of the diffuse base of [`Principled`] light passes the surface, on its way in and out again to all sides
//! alike, whatever direction it came from. Seen from `v` outside, or from inside:
//!
//! ```text
//! outside    f  =  fuzz + coat + gloss + P(v) (1 - w) color/π   on the side of v,    P(v) w s t/π   on the other
//! inside     f  =  s t/π   on the other side, and nothing on this one
//! ```
//!
//! `P` is the share of light that passes the layers, which depends on the direction to the viewer only; `s` is the colour of the coat on
//! one way through it, and `t` is 1, or for a white body with a colour at its surface the square root of that. So a body of albedo 1
//! below white layers gives back all light, and one whose half space has the reflectance `A` as much as a diffuse base of the colour
//! `A`; the interior is described by its medium. The formula is not symmetric, as that of the layers is not. The surface
//! reflects nothing of what comes from inside, as where the indices of both sides are the same.

use kajo_color::Spectrum;
use kajo_math::{Vec2, Vec3};

use super::diffuse_normal::DiffuseNormal;
use super::{Base, BsdfSample, Lambert, Principled, Specular, Transport, same_side};

/// A layered surface over a body, at one point.
///
/// It has the fields of [`Principled`] that count here, and not one of these: with the share beside it, lobes would be larger.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Subsurface {
    /// Albedo of what is below the layers, be it diffuse or the body.
    pub color: Spectrum,
    /// Share of the body in it, in [0, 1].
    pub share: f32,
    /// Whether light takes the square root of `color` as it enters and as it leaves the body, which has the colour itself else.
    pub is_tinted: bool,
    /// Factor of glossy reflection.
    pub specular: Spectrum,
    /// Roughness `α` along x and y.
    pub alpha: Vec2,
    /// Index of refraction of the gloss over that of the medium above, at least 1.
    pub eta: f32,
    /// Share of the surface that is coated.
    pub coat: f32,
    /// Light that the coat lets through, in and out again, straight on.
    pub coat_color: Spectrum,
    /// Roughness `α` of the coat.
    pub coat_alpha: f32,
    /// Index of refraction of the coat over that of the medium above, at least 1.
    pub coat_eta: f32,
    /// Share of the surface that is covered by fuzz.
    pub fuzz: f32,
    /// Colour of the fuzz.
    pub fuzz_color: Spectrum,
    /// Roughness of the fuzz, in [0, 1].
    pub fuzz_roughness: f32,
    /// Normal of what is diffuse, and of the body.
    pub diffuse_normal: DiffuseNormal,
}

impl Default for Subsurface {
    /// A grey body under a gloss.
    fn default() -> Subsurface {
        Subsurface::below(&Principled::default(), 1.0, false)
    }
}

impl Subsurface {
    /// A body in the place of a share of a diffuse base.
    ///
    /// * `layers`: what is above, with the colour of base and body
    /// * `share`, `is_tinted`: see the fields
    pub fn below(layers: &Principled, share: f32, is_tinted: bool) -> Subsurface {
        let Principled { color, alpha, eta, coat, coat_color, coat_alpha, coat_eta, .. } = *layers;
        let Principled { fuzz, fuzz_color, fuzz_roughness, diffuse_normal, .. } = *layers;
        let specular = match layers.specular {
            Specular::Factor(color) => color,
            Specular::F0 { factor, weight, .. } => (factor * weight).clamp(0.0, 1.0),
        };
        Subsurface {
            color,
            share,
            is_tinted,
            specular,
            alpha,
            eta,
            coat,
            coat_color,
            coat_alpha,
            coat_eta,
            fuzz,
            fuzz_color,
            fuzz_roughness,
            diffuse_normal,
        }
    }

    /// The same about another normal.
    pub(super) fn bumped(self, diffuse_normal: DiffuseNormal) -> Subsurface {
        Subsurface { diffuse_normal, ..self }
    }

    /// The layers over a diffuse base.
    fn over(&self, color: Spectrum) -> Principled {
        Principled {
            base: Base::Diffuse,
            color,
            specular: Specular::Factor(self.specular),
            diffuse_roughness: 0.0,
            alpha: self.alpha,
            eta: self.eta,
            coat: self.coat,
            coat_color: self.coat_color,
            coat_alpha: self.coat_alpha,
            coat_eta: self.coat_eta,
            fuzz: self.fuzz,
            fuzz_color: self.fuzz_color,
            fuzz_roughness: self.fuzz_roughness,
            diffuse_normal: self.diffuse_normal,
        }
    }

    /// All that reflects light outside.
    pub(super) fn reflecting(&self) -> Principled {
        self.over(self.color * (1.0 - self.share))
    }

    /// Factor of light that enters or leaves the body.
    fn tint(&self) -> Spectrum {
        if self.is_tinted { self.color.map(|color| color.max(0.0).sqrt()) } else { Spectrum::WHITE }
    }

    /// What passes the surface.
    fn passing(&self) -> Lambert {
        Lambert { reflectance: Spectrum::BLACK, transmittance: self.tint() }
    }

    /// Share of light that goes into the body from `v` outside.
    fn entering(&self, v: Vec3) -> Spectrum {
        let layers = self.over(self.color);
        self.tint() * layers.one_way_tint(v) * (self.share * layers.passed_to_base(v))
    }

    /// Probability of going into the body from outside.
    fn enters(&self, wo: Vec3) -> f32 {
        let [inside, outside] = [self.entering(wo), self.reflecting().albedo(wo)].map(|s| s.max_lane());
        if outside > 0.0 { inside / (inside + outside) } else { 1.0 }
    }

    pub(super) fn eval(&self, wo: Vec3, wi: Vec3, mode: Transport) -> Spectrum {
        if same_side(wo, wi) {
            return if wo.z > 0.0 { self.reflecting().eval(wo, wi, mode) } else { Spectrum::BLACK };
        }
        let passing = self.passing();
        let value = self.diffuse_normal.eval(wo, wi, mode, |wo, wi| passing.eval(wo, wi));
        // The direction outside, and whether the viewer is there.
        let (outside, is_viewer) = match wo.z > 0.0 {
            true => (wo, mode == Transport::Radiance),
            false => (wi, mode == Transport::Importance),
        };
        let layers = self.over(self.color);
        let passed = if is_viewer { self.share * layers.passed_to_base(outside) } else { 1.0 };
        value * layers.one_way_tint(outside) * passed
    }

    pub(super) fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        let p = if wo.z > 0.0 { self.enters(wo) } else { 1.0 };
        if same_side(wo, wi) {
            return if p < 1.0 { (1.0 - p) * self.reflecting().pdf(wo, wi) } else { 0.0 };
        }
        let passing = self.passing();
        let directions = self.diffuse_normal.directions(wo, wi);
        directions.map_or(0.0, |(wo, wi)| p * passing.pdf(wo, wi))
    }

    pub(super) fn sample(&self, wo: Vec3, u: Vec2, uc: f32, mode: Transport) -> Option<BsdfSample> {
        let p = if wo.z > 0.0 { self.enters(wo) } else { 1.0 };
        if uc >= p {
            let uc = ((uc - p) / (1.0 - p)).min(1.0 - f32::EPSILON);
            let sample = self.reflecting().sample(wo, u, uc, mode)?;
            return BsdfSample::new(
                sample.wi,
                sample.weight * (1.0 / (1.0 - p)),
                sample.pdf * (1.0 - p),
                sample.kind,
            );
        }
        let passing = self.passing();
        let sample = self.diffuse_normal.sample(wo, |wo| passing.sample(wo, u, 1.0))?;
        let pdf = self.pdf(wo, sample.wi);
        BsdfSample::new(sample.wi, self.eval(wo, sample.wi, mode) * (1.0 / pdf), pdf, sample.kind)
    }

    pub(super) fn albedo(&self, wo: Vec3) -> Spectrum {
        if wo.z > 0.0 { self.over(self.color).albedo(wo) } else { self.tint() }
    }
}

#[cfg(test)]
mod tests {
    use kajo_math::warp;

    use super::*;

    fn towards(cos: f32) -> Vec3 {
        Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos)
    }

    /// Light from all around that passes the surface and is given back whole, by a body that nothing is lost in.
    #[test]
    fn what_enters_and_what_is_reflected_is_what_a_diffuse_base_reflects() {
        let color = Spectrum::rgb(0.9, 0.5, 0.2);
        for share in [0.0, 0.4, 1.0] {
            let body = Subsurface { color, share, coat: 0.5, fuzz: 0.3, ..Subsurface::default() };
            for cos in [0.05, 0.3, 1.0] {
                let wo = towards(cos);
                let all = body.reflecting().albedo(wo) + body.entering(wo) * color;
                let off = (all - body.albedo(wo)).map(f32::abs).max_lane();
                assert!(off < 1e-5, "{share} {cos}: {off}");
            }
        }
    }

    #[test]
    fn nothing_is_reflected_inside_and_all_goes_out() {
        let body = Subsurface { share: 0.5, coat: 0.7, fuzz: 0.2, ..Subsurface::default() };
        let wo = -towards(0.6);
        for i in 0..50 {
            let u = Vec2::new((i as f32 + 0.5) / 50.0, ((i as f32 + 0.5) * 0.618).fract());
            let sample = body.sample(wo, u, 0.5, Transport::Radiance).unwrap();
            assert!(sample.wi.z > 0.0 && sample.kind.transmission);
            assert!((sample.weight - Spectrum::WHITE).map(f32::abs).max_lane() < 1e-5, "{:?}", sample.weight);
            let below = -warp::cosine_hemisphere(u);
            assert_eq!(body.eval(wo, below, Transport::Radiance), Spectrum::BLACK);
            assert_eq!(body.pdf(wo, below), 0.0);
        }
    }

    /// A coat of a colour is passed once on the way in and once on the way out.
    #[test]
    fn the_tint_of_the_coat_counts_once_each_way() {
        let coat_color = Spectrum::rgb(0.25, 0.5, 1.0);
        let body = Subsurface { coat: 1.0, coat_color, coat_alpha: 0.2, ..Subsurface::default() };
        let clear = Subsurface { coat_color: Spectrum::WHITE, ..body };
        let (up, down) = (Vec3::Z, towards(0.4) * Vec3::new(1.0, 1.0, -1.0));
        for mode in [Transport::Radiance, Transport::Importance] {
            for (wo, wi) in [(up, down), (down, up)] {
                let ratio = body.eval(wo, wi, mode).safe_div(clear.eval(wo, wi, mode)).to_rgb();
                let exact = [0.5, 0.5f32.sqrt(), 1.0];
                assert!((0..3).all(|i| (ratio[i] - exact[i]).abs() < 1e-5), "{ratio:?}");
            }
        }
    }
}
