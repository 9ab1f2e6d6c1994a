//! A material with holes too small to be seen: leaves, gauze, a thing that fades away.
//!
//! At each hit the surface is there with the probability `opacity`, else light goes straight on:
//!
//! ```text
//! f = opacity f_inner + (1 - opacity) delta(wi + wo)
//! ```
//!
//! Shadow rays are weakened by `1 - opacity` at every crossing, which is the mean of that. The classic integrator mixes
//! the material with a clear one. What the surface emits is weakened by `opacity` place by place. Colours at the corners
//! of a mesh may have an opacity too, which is another factor.
//!
//! Scene: `Matte { color 0.2 0.5 0.1  opacity 0.6 }`

use kajo_color::Spectrum;
use kajo_math::{fmath, warp};

use super::parts::answers_of_part;
use super::{Appearance, Interior, Material, MaterialId, ShadingPoint};
use crate::bsdf::Phong;
use crate::emission::SurfaceEmission;
use crate::texture::{AnyTexture, FloatTexture, TextureContext, Textures};

/// An opaque material that is not everywhere.
#[derive(Clone, Debug)]
pub struct Perforated {
    /// The material between the holes; light enters no body there.
    pub material: MaterialId,
    /// The share of the surface that is there; less than 1 somewhere.
    pub opacity: FloatTexture,
}

impl Perforated {
    /// The share of the surface that is there at a place.
    fn opacity(&self, appearance: &Appearance, at: &TextureContext) -> f32 {
        self.opacity.covered_at(appearance.textures.evaluator(at))
    }

    /// What to ask the material there; `None` in a hole, by the number `at.u`.
    fn chosen<'a>(
        &self,
        appearance: &Appearance,
        at: &ShadingPoint<'a>,
    ) -> Option<(MaterialId, ShadingPoint<'a>)> {
        let opacity = self.opacity(appearance, at.context);
        let (is_there, u) = warp::choose(at.u, opacity);
        is_there.then_some((self.material, ShadingPoint { u, ..*at }))
    }
}

impl Material for Perforated {
    fn is_finite(&self) -> bool {
        true
    }

    fn textures(&self) -> Vec<AnyTexture<'_>> {
        vec![self.opacity.into()]
    }

    fn parts(&self) -> &[MaterialId] {
        std::slice::from_ref(&self.material)
    }

    fn emission(
        &self,
        of_part: &dyn Fn(MaterialId) -> SurfaceEmission,
        textures: &mut Textures,
    ) -> Option<SurfaceEmission> {
        of_part(self.material).weakened(self.opacity, textures)
    }

    fn phong(&self, appearance: &Appearance, at: &TextureContext) -> Phong {
        let inner = appearance.phong(self.material, at);
        let opacity = self.opacity(appearance, at);
        if opacity >= 1.0 {
            return inner;
        }
        let clear =
            Phong { transparent: Spectrum::WHITE, exponent: inner.exponent, eta: inner.eta, ..Phong::BLACK };
        let absorption = Spectrum::WHITE * -fmath::ln(1.0 - opacity);
        Phong { absorption, eta: 1.0, ..inner.lerp(&clear, 1.0 - opacity) }
    }

    fn may_transmit(&self, _appearance: &Appearance) -> bool {
        true
    }

    answers_of_part!(bsdf, orientation);

    /// None, whatever fills bodies of the material between the holes: light comes in through these without passing a boundary.
    fn interior(&self, _appearance: &Appearance, _at: &ShadingPoint<'_>) -> Option<Interior> {
        None
    }

    fn needs_uv(&self, appearance: &Appearance) -> bool {
        self.opacity.needs_uv(&appearance.textures) || appearance.needs_uv(self.material)
    }

    fn passage(&self, appearance: &Appearance, at: &ShadingPoint<'_>, cos: f32) -> Spectrum {
        let opacity = self.opacity(appearance, at.context);
        let between = appearance.passage(self.material, at, cos);
        Spectrum::WHITE * (1.0 - opacity) + between * opacity
    }

    fn has_passages(&self, _appearance: &Appearance) -> bool {
        true
    }
}
