//! The boundary of what fills a body, such as smoke in air, and nothing else.
//!
//! Light goes straight on, `f = delta(wi + wo)`, and is in another medium from there on. The inside
//! has the index of what is around, unless the medium has an index of its own: where that differs from the one around the
//! boundary reflects and refracts as polished glass does.
//!
//! Scene: `Interface { medium smoke }`

use kajo_color::{Spectrum, Wavelengths};
use kajo_math::Vec3;

use super::{Appearance, Interior, Material, ShadingPoint};
use crate::bsdf::{Bsdf, Dielectric, Microfacets, Phong, microfacet::NormalDistribution};
use crate::medium::MediumId;
use crate::texture::{AnyTexture, TextureContext};

/// The boundary of a medium and nothing else.
#[derive(Clone, Debug)]
pub struct NullInterface {
    /// What is inside, which adds to what is there; `None` for nothing, which in a body of a lower priority is a cavity.
    pub medium: Option<MediumId>,
    /// The body of the higher priority is there where several overlap.
    pub priority: i32,
}

/// Indices nearer to each other than this part are the same: what the steps along a curve may have left.
const SAME_INDEX: f32 = 1e-6;

impl NullInterface {
    /// Index of refraction inside, where the medium has one.
    fn index(&self, appearance: &Appearance, p: Vec3, wavelengths: &Wavelengths) -> Option<f32> {
        appearance.media.index(self.medium?, p, wavelengths)
    }
}

impl Material for NullInterface {
    fn is_finite(&self) -> bool {
        true
    }

    fn textures(&self) -> Vec<AnyTexture<'_>> {
        Vec::new()
    }

    fn phong(&self, _appearance: &Appearance, _at: &TextureContext) -> Phong {
        Phong::CLEAR
    }

    fn constant(&self) -> Option<&Phong> {
        Some(&Phong::CLEAR)
    }

    fn may_transmit(&self, _appearance: &Appearance) -> bool {
        true
    }

    fn bsdf<'a>(&'a self, appearance: &'a Appearance, at: &ShadingPoint<'_>) -> Bsdf<'a> {
        let eta = self.index(appearance, at.context.p, at.wavelengths).map(|index| index / at.eta_outside);
        match eta.filter(|eta| (eta - 1.0).abs() > SAME_INDEX) {
            None => Bsdf::Null,
            Some(eta) => {
                Bsdf::Dielectric(Dielectric::new(eta, Microfacets::new(NormalDistribution::Ggx, 0.0)))
            }
        }
    }

    fn passage(&self, appearance: &Appearance, _at: &ShadingPoint<'_>, _cos: f32) -> Spectrum {
        // What comes through a body that bends light does not come along a segment.
        if self.bends_light(appearance) { Spectrum::BLACK } else { Spectrum::WHITE }
    }

    fn has_passages(&self, _appearance: &Appearance) -> bool {
        true
    }

    fn interior(&self, appearance: &Appearance, at: &ShadingPoint<'_>) -> Option<Interior> {
        let &NullInterface { medium, priority } = self;
        let eta = self.index(appearance, at.context.p, at.wavelengths);
        let is_dispersive = medium.is_some_and(|medium| appearance.media.is_dispersive(medium));
        // What bends light is alone.
        let adds = !self.bends_light(appearance);
        Some(Interior { eta, is_dispersive, absorption: Spectrum::BLACK, priority, medium, adds })
    }

    fn medium(&self) -> Option<MediumId> {
        self.medium
    }

    fn may_bend_light(&self) -> bool {
        true
    }
}
