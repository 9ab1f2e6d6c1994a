//! A boundary that light does not notice: nothing but the end of what is inside, such as smoke in air.
//!
//! Light goes straight on, `f = delta(wi + wo)`, and is in another medium from there on. The inside
//! has the index of what is around.
//!
//! Scene: `Interface { medium smoke }`

use kajo_color::Spectrum;

use super::{Appearance, Interior, Material, ShadingPoint};
use crate::bsdf::{Bsdf, Phong};
use crate::medium::MediumId;
use crate::texture::{AnyTexture, TextureContext};

/// The boundary of a medium and nothing else.
#[derive(Clone, Debug)]
pub struct NullBoundary {
    /// What is inside; `None` for a cavity.
    pub medium: Option<MediumId>,
    /// The body of the higher priority is there where several overlap.
    pub priority: i32,
}

/// What the classic integrator sees: nothing.
const CLEAR: Phong = Phong { transparent: Spectrum::WHITE, eta: 1.0, ..Phong::BLACK };

impl Material for NullBoundary {
    fn is_finite(&self) -> bool {
        true
    }

    fn textures(&self) -> Vec<AnyTexture<'_>> {
        Vec::new()
    }

    fn phong(&self, _appearance: &Appearance, _at: &TextureContext) -> Phong {
        CLEAR
    }

    fn constant(&self) -> Option<&Phong> {
        Some(&CLEAR)
    }

    fn may_transmit(&self, _appearance: &Appearance) -> bool {
        true
    }

    fn bsdf(&self, _appearance: &Appearance, _at: &ShadingPoint<'_>) -> Bsdf {
        Bsdf::Null
    }

    fn passage(&self, _appearance: &Appearance, _at: &ShadingPoint<'_>, _cos: f32) -> Spectrum {
        Spectrum::WHITE
    }

    fn has_passages(&self, _appearance: &Appearance) -> bool {
        true
    }

    fn interior(&self, _appearance: &Appearance, _at: &ShadingPoint<'_>) -> Option<Interior> {
        let &NullBoundary { medium, priority } = self;
        Some(Interior { eta: None, is_dispersive: false, absorption: Spectrum::BLACK, priority, medium })
    }

    fn medium(&self) -> Option<MediumId> {
        self.medium
    }
}
