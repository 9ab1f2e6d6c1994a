//! A layered surface in the terms of OpenPBR: fuzz over a coat over a metal, a diffuse base or a glass.
//!
//! Each layer reflects its own light and lets the rest through to the one below. Seen from `v`:
//!
//! ```text
//! f  =  wf cf ffuzz  +  (1 - wf Rfuzz(v)) [ wc fcoat  +  T(v) fbase ]
//!
//! T  =  1 - wc  +  wc (1 - Ecoat(v)) t            t = tint ^ ((1/cos θo' + 1/cos θi') / 2),  θ' inside the coat
//!
//! fbase  =  metal,   or clear glass,   or   fgloss + (1 - Egloss(v)) fdiffuse
//! ```
//!
//! `R` and `E` are the shares that fuzz and coat reflect [OpenPBR 1.1, sec. 3 and 4]. What passes a layer depends
//! on the direction to the viewer only: so no light is lost, and white layers on a white base reflect all of it.
//! The price is that the formula is not symmetric. Paths from the lights use it with both directions
//! exchanged, so that they find the same picture.
//!
//! Left out: the darkening of a base by light that the coat throws back to it, and thin films. A body that light enters in the place
//! of the diffuse base is a [`Subsurface`](super::Subsurface).
//! From inside a glass base there is neither fuzz nor coat.

use kajo_color::Spectrum;
use kajo_math::{Vec2, Vec3, fmath};

use super::broad::LEAST_BROAD_ALPHA;
use super::diffuse_normal::DiffuseNormal;
use super::fuzz::Fuzz;
use super::gloss::Gloss;
use super::microfacet::NormalDistribution;
use super::{
    BsdfSample, Conductor, Dielectric, MetalFresnel, Microfacets, OrenNayar, ScatterKind, Transport,
    same_side, upright,
};

/// What lies below coat and fuzz.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Base {
    /// A diffuse base under a glossy surface.
    Diffuse,
    /// A metal.
    Metal,
    /// Clear glass.
    Glass,
}

/// How the gloss of a diffuse base differs from that of its index of refraction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Specular {
    /// A factor at every angle, which metals have at 82 degrees and glass for what it reflects [OpenPBR 1.1, sec. 3.6].
    Factor(Spectrum),
    /// A factor at normal incidence, which fades to 1 at grazing angles; metals are left alone
    /// [Khronos glTF, KHR_materials_specular].
    F0 {
        /// The factor, at least 0. The reflectance at normal incidence is held to 1.
        factor: Spectrum,
        /// The largest one at any wavelength: it decides how much light reaches the diffuse base.
        largest: f32,
        /// Another factor at every angle, in [0, 1].
        weight: f32,
    },
}

/// A layered surface at one point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Principled {
    /// What lies below.
    pub base: Base,
    /// Albedo of the diffuse base, reflectance of the metal straight on, or factor of light through the glass.
    pub color: Spectrum,
    /// What differs in glossy reflection.
    pub specular: Specular,
    /// Roughness of the diffuse base, in [0, 1].
    pub diffuse_roughness: f32,
    /// Roughness `α` along x and y.
    pub alpha: Vec2,
    /// Index of refraction of diffuse base or glass over that of the medium above, at least 1.
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
    /// Normal of a diffuse base.
    pub diffuse_normal: DiffuseNormal,
}

impl Default for Principled {
    fn default() -> Principled {
        let white = Spectrum::WHITE;
        Principled {
            base: Base::Diffuse,
            color: Spectrum::grey(0.8),
            specular: Specular::Factor(white),
            diffuse_roughness: 0.0,
            alpha: Vec2::splat(0.09),
            eta: 1.5,
            coat: 0.0,
            coat_color: white,
            coat_alpha: 0.0,
            coat_eta: 1.6,
            fuzz: 0.0,
            fuzz_color: white,
            fuzz_roughness: 0.5,
            diffuse_normal: DiffuseNormal::SAME,
        }
    }
}

/// Probabilities of choosing each part of the layers, for one `wo`.
struct Shares {
    fuzz: f32,
    coat: f32,
    gloss: f32,
    /// The diffuse base, the metal or the glass.
    base: f32,
}

/// What passes through the layers above the base, and how much each layer reflects.
struct LayerTransmission {
    fuzz: f32,
    coat: f32,
    /// Share of light that passes fuzz and coat, their tint left out.
    through: f32,
}

impl Principled {
    pub(super) fn has_diffuse(&self) -> bool {
        self.base == Base::Diffuse
    }

    /// The same with a diffuse base about another normal.
    pub(super) fn bumped(self, diffuse_normal: DiffuseNormal) -> Principled {
        Principled { diffuse_normal, ..self }
    }

    fn facets(&self) -> Microfacets {
        Microfacets { shape: NormalDistribution::Ggx, alpha_x: self.alpha.x, alpha_y: self.alpha.y }.held()
    }

    fn gloss(&self) -> Gloss {
        Gloss::new(self.eta, self.facets())
    }

    fn coat_lobe(&self) -> Gloss {
        Gloss::new(self.coat_eta, Microfacets::new(NormalDistribution::Ggx, self.coat_alpha))
    }

    fn diffuse_base(&self) -> OrenNayar {
        OrenNayar { reflectance: self.color, roughness: self.diffuse_roughness }
    }

    fn metal(&self) -> Conductor {
        let f82 = match self.specular {
            Specular::Factor(color) => color,
            Specular::F0 { .. } => Spectrum::WHITE,
        };
        let fresnel = MetalFresnel::Tinted { f0: self.color, f82 };
        Conductor { fresnel, microfacets: self.facets() }
    }

    fn glass(&self) -> Dielectric {
        let microfacets = self.facets();
        let reflection_tint = match self.specular {
            Specular::Factor(color) => color,
            Specular::F0 { factor, weight, .. } => (factor * weight).clamp(0.0, 1.0),
        };
        Dielectric { eta: self.eta, microfacets, reflection_tint, transmission_tint: self.color }
    }

    /// What the gloss of a diffuse base reflects, with the cosine of `wi`; both directions above.
    fn gloss_value(&self, gloss: &Gloss, wo: Vec3, wi: Vec3) -> Spectrum {
        let by_index = gloss.eval(wo, wi).0;
        match self.specular {
            Specular::Factor(color) => color * by_index,
            Specular::F0 { factor, weight, .. } => {
                let mirrors = gloss.mirror_values(wo, wi);
                factor.map(|factor| weight * gloss.with_f0(factor, by_index, mirrors))
            }
        }
    }

    /// Share of light that the gloss of a diffuse base reflects to `wo`.
    fn gloss_albedo(&self, gloss: &Gloss, wo: Vec3) -> Spectrum {
        let by_index = gloss.albedo(wo);
        match self.specular {
            Specular::Factor(color) => color * by_index,
            Specular::F0 { factor, weight, .. } => {
                let mirrors = gloss.mirror_albedos(wo);
                factor.map(|factor| weight * gloss.with_f0(factor, by_index, mirrors))
            }
        }
    }

    /// Share of light from or to `v` that does not pass the gloss to the diffuse base, the same at all wavelengths.
    fn gloss_kept(&self, gloss: &Gloss, v: Vec3) -> f32 {
        let by_index = gloss.albedo(v);
        match self.specular {
            Specular::Factor(_) => by_index,
            Specular::F0 { largest, weight, .. } => {
                (weight * gloss.with_f0(largest, by_index, gloss.mirror_albedos(v))).min(1.0)
            }
        }
    }

    /// Both directions with `wo` above, where it does not matter on which side it is.
    fn turned(&self, wo: Vec3, wi: Vec3) -> (Vec3, Vec3) {
        if self.base == Base::Glass { (wo, wi) } else { upright(wo, wi) }
    }

    /// What the layers above the base do to light that is seen from `v`.
    fn seen(&self, v: Vec3) -> LayerTransmission {
        if v.z <= 0.0 {
            return LayerTransmission { fuzz: 0.0, coat: 0.0, through: 1.0 };
        }
        let fuzz = if self.fuzz > 0.0 { self.fuzz * Fuzz::new(v, self.fuzz_roughness).albedo } else { 0.0 };
        let coat = if self.coat > 0.0 { self.coat * self.coat_lobe().albedo(v) } else { 0.0 };
        LayerTransmission { fuzz, coat: (1.0 - fuzz) * coat, through: (1.0 - fuzz) * (1.0 - coat) }
    }

    /// Factor of light that passes the tinted coat from `wi` and back to `wo`, relative to clear coat
    /// that lets the share `1 - coat E` through.
    fn coat_tint(&self, wo: Vec3, wi: Vec3, v: Vec3) -> Spectrum {
        if self.coat <= 0.0 || v.z <= 0.0 || self.coat_color == Spectrum::WHITE {
            return Spectrum::WHITE;
        }
        self.tinted_by_coat(0.5 * (self.inverse_cos_in_coat(wo) + self.inverse_cos_in_coat(wi)), v)
    }

    /// Share of light that gets through the layers to a diffuse base, seen from `v` above, the tint of the coat left out.
    pub(super) fn passed_to_base(&self, v: Vec3) -> f32 {
        self.seen(v).through * (1.0 - self.gloss_kept(&self.gloss(), v))
    }

    /// Factor of light that passes the tinted coat once, from or to `v` above; see [`Principled::coat_tint`].
    pub(super) fn one_way_tint(&self, v: Vec3) -> Spectrum {
        if self.coat <= 0.0 || self.coat_color == Spectrum::WHITE {
            return Spectrum::WHITE;
        }
        self.tinted_by_coat(0.5 * self.inverse_cos_in_coat(v), v)
    }

    /// One over the cosine of a direction where it goes through the coat.
    fn inverse_cos_in_coat(&self, w: Vec3) -> f32 {
        let sin2 = (1.0 - w.z * w.z).max(0.0) / (self.coat_eta * self.coat_eta);
        1.0 / (1.0 - sin2).max(1e-4).sqrt()
    }

    /// The tint of the coat over a length, relative to clear coat, of light that is seen from `v`.
    fn tinted_by_coat(&self, length: f32, v: Vec3) -> Spectrum {
        let passed = self.coat * (1.0 - self.coat_lobe().albedo(v));
        let bare = 1.0 - self.coat;
        if passed + bare <= 0.0 {
            return Spectrum::WHITE;
        }
        self.coat_color.map(|c| (passed * fmath::pow(c.max(0.0), length) + bare) / (passed + bare))
    }

    fn shares(&self, wo: Vec3) -> Shares {
        let seen = self.seen(wo);
        let fuzz = seen.fuzz * self.fuzz_color.max_lane();
        let (gloss, base) = match self.base {
            Base::Metal | Base::Glass => (0.0, 1.0),
            Base::Diffuse => {
                let gloss = self.gloss();
                let below = 1.0 - self.gloss_kept(&gloss, wo);
                (self.gloss_albedo(&gloss, wo).max_lane(), below * self.color.max_lane())
            }
        };
        let (gloss, base) = (seen.through * gloss, seen.through * base);
        let sum = fuzz + seen.coat + gloss + base;
        if sum <= 0.0 || !sum.is_finite() {
            return Shares { fuzz: 0.0, coat: 0.0, gloss: 0.0, base: 1.0 };
        }
        Shares { fuzz: fuzz / sum, coat: seen.coat / sum, gloss: gloss / sum, base: base / sum }
    }

    /// Whether gloss or coat of a diffuse base are narrow lobes.
    pub(super) fn has_narrow_lobes(&self) -> bool {
        let [gloss, coat] = self.broad_lobes();
        !gloss || (self.coat > 0.0 && !coat)
    }

    /// Whether gloss and coat are broad lobes.
    fn broad_lobes(&self) -> [bool; 2] {
        [self.alpha.min_element(), self.coat_alpha].map(|alpha| alpha >= LEAST_BROAD_ALPHA)
    }

    /// The part of [`Principled::eval`] that is no narrow lobe.
    pub(super) fn broad_value(&self, wo: Vec3, wi: Vec3, mode: Transport) -> Spectrum {
        self.value(wo, wi, mode, self.broad_lobes())
    }

    pub(super) fn eval(&self, wo: Vec3, wi: Vec3, mode: Transport) -> Spectrum {
        self.value(wo, wi, mode, [true; 2])
    }

    /// * `with_gloss`, `with_coat`: whether what the gloss of a diffuse base and what the coat reflect is part of it
    #[inline(always)]
    fn value(&self, wo: Vec3, wi: Vec3, mode: Transport, [with_gloss, with_coat]: [bool; 2]) -> Spectrum {
        let (wo, wi) = self.turned(wo, wi);
        let v = if mode == Transport::Radiance { wo } else { wi };
        let reflected_above = wo.z > 0.0 && wi.z > 0.0;
        let seen = self.seen(v);
        let mut value =
            self.base_value(wo, wi, v, mode, with_gloss) * self.coat_tint(wo, wi, v) * seen.through;
        if with_coat && reflected_above && self.coat > 0.0 {
            value += Spectrum::grey(self.coat_lobe().eval(wo, wi).0 * self.coat * (1.0 - seen.fuzz));
        }
        if reflected_above && self.fuzz > 0.0 {
            let fuzz = Fuzz::new(v, self.fuzz_roughness);
            // The fit's lobe belongs to the viewer's direction; the other one is the light's.
            let light = if mode == Transport::Radiance { wi } else { wo };
            value += self.fuzz_color * (self.fuzz * fuzz.albedo * fuzz.shape(light) * wi.z);
        }
        value
    }

    #[inline(always)]
    fn base_value(&self, wo: Vec3, wi: Vec3, v: Vec3, mode: Transport, with_gloss: bool) -> Spectrum {
        match self.base {
            Base::Metal => self.metal().eval(wo, wi),
            Base::Glass => self.glass().eval(wo, wi, mode),
            Base::Diffuse if !same_side(wo, wi) => Spectrum::BLACK,
            Base::Diffuse => {
                let gloss = self.gloss();
                let diffuse =
                    self.diffuse_normal.eval(wo, wi, mode, |wo, wi| self.diffuse_base().eval(wo, wi));
                let below = diffuse * (1.0 - self.gloss_kept(&gloss, v));
                if with_gloss { self.gloss_value(&gloss, wo, wi) + below } else { below }
            }
        }
    }

    pub(super) fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        let (wo, wi) = self.turned(wo, wi);
        let shares = self.shares(wo);
        let mut pdf = shares.base
            * match self.base {
                Base::Metal => self.metal().pdf(wo, wi),
                Base::Glass => self.glass().pdf(wo, wi),
                Base::Diffuse => {
                    let directions = self.diffuse_normal.directions(wo, wi);
                    directions.map_or(0.0, |(wo, wi)| self.diffuse_base().pdf(wo, wi))
                }
            };
        if wo.z > 0.0 && wi.z > 0.0 {
            if shares.gloss > 0.0 {
                pdf += shares.gloss * self.gloss().eval(wo, wi).1;
            }
            if shares.coat > 0.0 {
                pdf += shares.coat * self.coat_lobe().eval(wo, wi).1;
            }
            if shares.fuzz > 0.0 {
                pdf += shares.fuzz * Fuzz::new(wo, self.fuzz_roughness).shape(wi) * wi.z;
            }
        }
        pdf
    }

    pub(super) fn sample(&self, wo: Vec3, u: Vec2, uc: f32, mode: Transport) -> Option<BsdfSample> {
        let side = if self.base == Base::Glass { 1.0 } else { wo.z.signum() };
        let wo = Vec3::new(wo.x, wo.y, side * wo.z);
        let Shares { fuzz, coat, gloss, base } = self.shares(wo);
        let (glossy, matte) = (fuzz + coat, fuzz + coat + gloss);
        let (mut kind, mut eta) = (ScatterKind::REFLECTION, 1.0);
        let wi = if uc < fuzz {
            Fuzz::new(wo, self.fuzz_roughness).sample(u)
        } else if uc < glossy {
            self.coat_lobe().sample(wo, u, (uc - fuzz) / coat)?
        } else if uc < matte {
            self.gloss().sample(wo, u, (uc - glossy) / gloss)?
        } else {
            let uc = ((uc - matte) / base).min(1.0 - f32::EPSILON);
            let sample = match self.base {
                Base::Diffuse => self.diffuse_normal.sample(wo, |wo| self.diffuse_base().sample(wo, u, uc)),
                Base::Metal => self.metal().sample(wo, u),
                Base::Glass => self.glass().sample(wo, u, uc, mode),
            }?;
            if sample.kind.delta {
                // Glass of the index around it: straight on, and nothing but sampling finds it.
                let v = if mode == Transport::Radiance { wo } else { sample.wi };
                let factor = self.coat_tint(wo, sample.wi, v) * (self.seen(v).through / base);
                return Some(BsdfSample { weight: sample.weight * factor, pdf: sample.pdf * base, ..sample });
            }
            (kind, eta) = (sample.kind, sample.eta);
            sample.wi
        };
        let pdf = self.pdf(wo, wi);
        let weight = self.eval(wo, wi, mode) * (1.0 / pdf);
        let sample = BsdfSample::new(Vec3::new(wi.x, wi.y, side * wi.z), weight, pdf, kind)?;
        Some(BsdfSample { eta, ..sample })
    }

    pub(super) fn albedo(&self, wo: Vec3) -> Spectrum {
        let (wo, _) = self.turned(wo, wo);
        let seen = self.seen(wo);
        let base = match self.base {
            Base::Metal => self.metal().albedo(wo),
            Base::Glass => self.glass().albedo(wo),
            Base::Diffuse => {
                let gloss = self.gloss();
                let below = self.diffuse_base().albedo(wo) * (1.0 - self.gloss_kept(&gloss, wo));
                self.gloss_albedo(&gloss, wo) + below
            }
        };
        let passed = base * self.coat_tint(wo, wo, wo) * seen.through;
        self.fuzz_color * seen.fuzz + Spectrum::grey(seen.coat) + passed
    }
}
