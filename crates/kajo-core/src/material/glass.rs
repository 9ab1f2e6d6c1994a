//! Glass, water and other clear matter: a body with a polished or rough surface, or a thin pane.
//!
//! A body bends light at its surface and absorbs inside. Where bodies overlap, the one of the higher priority is
//! there. A pane has no inside: light goes straight through, or is scattered by a rough one, weakened by
//! `exp(-absorption thickness)` and by reflection to and fro. The classic integrator sees a clear transparent colour and
//! the index of yellow light.
//!
//! Scene: `Glass { glass N-SF10  absorption 0.1 0.02 0.05 }`

use kajo_color::{Spectrum, Unbounded, Wavelengths, dispersion::Dispersion};
use kajo_math::Vec3;

use super::{Appearance, Grain, Interior, Material, Orientation, ShadingPoint, may_be_polished};
use crate::bsdf::{Bsdf, Dielectric, Microfacets, Phong, ThinDielectric, microfacet::NormalDistribution};
use crate::medium::MediumId;
use crate::texture::{AnyTexture, FloatTexture, TextureContext, TextureEvaluator, Textures};

/// What glass is like.
#[derive(Clone, Debug)]
pub struct GlassSettings {
    /// Index of refraction.
    pub index: Dispersion,
    /// Distribution of facets.
    pub shape: NormalDistribution,
    /// In [0, 1]; facets have its square.
    pub roughness: FloatTexture,
    /// Which way the facets run.
    pub grain: Grain,
    /// Absorption per unit length in linear RGB.
    pub absorption: [f32; 3],
    /// Thickness of a pane; `None` for a body.
    pub pane: Option<FloatTexture>,
    /// The body of the higher priority is there where several overlap.
    pub priority: i32,
    /// What scatters light inside of a body.
    pub medium: Option<MediumId>,
}

impl Default for GlassSettings {
    /// A clear body of the index 1.5.
    fn default() -> GlassSettings {
        GlassSettings {
            index: Dispersion::Constant(1.5),
            shape: NormalDistribution::Ggx,
            roughness: 0.0.into(),
            grain: Grain::default(),
            absorption: [0.0; 3],
            pane: None,
            priority: 0,
            medium: None,
        }
    }
}

/// A clear material.
#[derive(Clone, Debug)]
pub struct Glass {
    settings: GlassSettings,
    absorption: Unbounded,
    /// Where it is the same everywhere.
    constant: Option<Phong>,
}

impl From<GlassSettings> for Glass {
    fn from(settings: GlassSettings) -> Glass {
        let absorption = Unbounded::from_rgb(settings.absorption);
        let mut glass = Glass { settings, absorption, constant: None };
        glass.constant = (!glass.varies())
            .then(|| glass.classic(Textures::default().evaluator(&TextureContext::default())));
        glass
    }
}

impl Glass {
    fn varies(&self) -> bool {
        let GlassSettings { roughness, grain, pane, .. } = &self.settings;
        roughness.varies() || grain.varies() || pane.is_some_and(FloatTexture::varies)
    }

    /// The index at the first wavelength.
    fn eta(&self, wavelengths: &Wavelengths) -> f32 {
        self.settings.index.at(wavelengths)[0]
    }

    fn pane(&self, appearance: &Appearance, at: &ShadingPoint<'_>) -> Option<ThinDielectric> {
        let evaluator = appearance.textures.evaluator(at.context);
        let optical_depth = self.absorption.at(at.wavelengths) * self.settings.pane?.at(evaluator);
        let eta = self.eta(at.wavelengths) / at.eta_outside;
        let microfacets = self.facets(evaluator);
        Some(ThinDielectric { eta, optical_depth, microfacets })
    }

    fn facets(&self, evaluator: TextureEvaluator<'_>) -> Microfacets {
        let roughness = self.settings.roughness.at(evaluator);
        self.settings.grain.facets(self.settings.shape, roughness * roughness, evaluator)
    }

    fn classic(&self, evaluator: TextureEvaluator<'_>) -> Phong {
        Phong {
            transparent: Spectrum::rgb(1.0, 1.0, 1.0),
            specular: Spectrum::rgb(0.04, 0.04, 0.04),
            exponent: self.facets(evaluator).exponent(),
            absorption: Vec3::from(self.settings.absorption).into(),
            eta: if self.settings.pane.is_some() { 1.0 } else { self.settings.index.index_d() as f32 },
            ..Phong::BLACK
        }
    }
}

impl Material for Glass {
    fn is_finite(&self) -> bool {
        let GlassSettings { index, absorption, .. } = &self.settings;
        index.at(&Wavelengths::RGB).is_finite() && absorption.iter().all(|v| v.is_finite())
    }

    fn textures(&self) -> Vec<AnyTexture<'_>> {
        let GlassSettings { roughness, grain, pane, .. } = &self.settings;
        grain.textures().into_iter().chain([*roughness]).chain(*pane).map(AnyTexture::from).collect()
    }

    fn phong(&self, appearance: &Appearance, at: &TextureContext) -> Phong {
        self.constant.unwrap_or_else(|| self.classic(appearance.textures.evaluator(at)))
    }

    fn constant(&self) -> Option<&Phong> {
        self.constant.as_ref()
    }

    fn needs_uv(&self, _appearance: &Appearance) -> bool {
        self.constant.is_none()
    }

    fn orientation(&self, appearance: &Appearance, at: &ShadingPoint<'_>) -> Orientation {
        self.settings.grain.orientation(appearance.textures.evaluator(at.context))
    }

    fn is_oriented(&self, _appearance: &Appearance) -> bool {
        self.settings.grain.exists()
    }

    fn may_transmit(&self, _appearance: &Appearance) -> bool {
        true
    }

    fn bsdf<'a>(&'a self, appearance: &'a Appearance, at: &ShadingPoint<'_>) -> Bsdf<'a> {
        if let Some(pane) = self.pane(appearance, at) {
            return Bsdf::ThinDielectric(pane);
        }
        let eta = self.eta(at.wavelengths) / at.eta_outside;
        let facets = self.facets(appearance.textures.evaluator(at.context));
        Bsdf::Dielectric(Dielectric::new(eta, facets))
    }

    fn passage(&self, appearance: &Appearance, at: &ShadingPoint<'_>, cos: f32) -> Spectrum {
        self.pane(appearance, at).map_or(Spectrum::BLACK, |pane| pane.passage(cos))
    }

    fn has_passages(&self, _appearance: &Appearance) -> bool {
        self.settings.pane.is_some() && may_be_polished(self.settings.roughness)
    }

    fn interior(&self, _: &Appearance, at: &ShadingPoint<'_>) -> Option<Interior> {
        let wavelengths = at.wavelengths;
        self.settings.pane.is_none().then(|| Interior {
            eta: Some(self.eta(wavelengths)),
            is_dispersive: self.settings.index.is_dispersive(),
            absorption: self.absorption.at(wavelengths),
            priority: self.settings.priority,
            medium: self.settings.medium,
            adds: false,
        })
    }

    fn medium(&self) -> Option<MediumId> {
        self.settings.medium.filter(|_| self.settings.pane.is_none())
    }
}
