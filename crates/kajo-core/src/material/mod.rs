//! Materials: which reflection model a surface has at each of its points.

mod accretion_disk;
mod appearance;
mod blend;
mod btf;
mod embossed;
mod glass;
mod gravitational_lens;
mod matte;
mod measured;
mod metal;
mod null_interface;
mod orientation;
mod parts;
mod perforated;
mod phong;
mod principled;

pub use accretion_disk::AccretionDisk;
pub use appearance::Appearance;
pub use blend::Blend;
pub use btf::{BtfMaterial, BtfSettings};
pub use embossed::{Embossed, Relief};
pub use glass::{Glass, GlassSettings};
pub use gravitational_lens::GravitationalLens;
pub use matte::Matte;
pub use measured::MeasuredMaterial;
pub use metal::{Metal, Substance};
pub use null_interface::NullInterface;
pub use orientation::{Grain, Lean, Orientation};
pub use perforated::Perforated;
pub use phong::{PhongMaterial, PhongTextures};
pub use principled::{LayeredMaterial, Layers, SpecularLayer, SubsurfaceBody};

use kajo_color::{Spectrum, Wavelengths};

use crate::bsdf::{Bsdf, POLISHED, Phong};
use crate::emission::SurfaceEmission;
use crate::family::family;
use crate::medium::MediumId;
use crate::texture::{AnyTexture, FloatTexture, TextureContext, Textures};

/// Inputs of the evaluation of a material.
#[derive(Clone, Copy, Debug)]
pub struct ShadingPoint<'a> {
    /// Where textures are looked up.
    pub context: &'a TextureContext,
    /// Wavelengths of the lanes of spectra.
    pub wavelengths: &'a Wavelengths,
    /// Index of refraction outside, on the side of the normal, at the first wavelength.
    pub eta_outside: f32,
    /// Uniform in [0, 1): chooses among the parts of a mixture.
    pub u: f32,
}

/// Whether a pane of a roughness lets light go straight on anywhere.
fn may_be_polished(roughness: FloatTexture) -> bool {
    let least = roughness.share_range()[0];
    least * least <= POLISHED
}

/// What fills a body whose surface lets light through.
#[derive(Clone, Copy, Debug)]
pub struct Interior {
    /// Index of refraction at the first wavelength; `None` for that of what is around.
    pub eta: Option<f32>,
    /// Whether the index depends on the wavelength.
    pub is_dispersive: bool,
    /// Absorption per unit length: light is weakened by `exp(-absorption d)`.
    pub absorption: Spectrum,
    /// Where bodies overlap the one of the highest priority is there [Schmidt and Budge 2002].
    pub priority: i32,
    /// Participating medium inside of the body.
    pub medium: Option<MediumId>,
    /// Whether all this adds to what else of the same priority is there, and does not take its place.
    pub adds: bool,
}

/// What every material can do.
pub trait Material {
    /// Whether all its own numbers are finite.
    fn is_finite(&self) -> bool;

    /// The textures that it is made of.
    fn textures(&self) -> Vec<AnyTexture<'_>>;

    /// Whether it asks for [`TextureContext::footprint`] itself, textures left out.
    fn wants_footprint(&self) -> bool {
        false
    }

    /// The materials that it is made of.
    fn parts(&self) -> &[MaterialId] {
        &[]
    }

    /// The light that its surfaces give because those of its parts do; `None` where there are too many textures.
    ///
    /// * `of_part`: the light of each of these
    /// * `textures`: has room for those that are factors of that light
    fn emission(
        &self,
        _of_part: &dyn Fn(MaterialId) -> SurfaceEmission,
        _textures: &mut Textures,
    ) -> Option<SurfaceEmission> {
        Some(SurfaceEmission::default())
    }

    /// The classic reflection model at a point.
    fn phong(&self, appearance: &Appearance, at: &TextureContext) -> Phong;

    /// The classic reflection model, where it is the same at every point.
    fn constant(&self) -> Option<&Phong> {
        None
    }

    /// Whether any answer depends on surface coordinates.
    fn needs_uv(&self, appearance: &Appearance) -> bool {
        self.parts().iter().any(|&part| appearance.needs_uv(part))
    }

    /// Whether light can pass through anywhere.
    fn may_transmit(&self, appearance: &Appearance) -> bool {
        self.parts().iter().any(|&part| appearance.may_transmit(part))
    }

    /// How light is scattered at a point, for integrators that estimate integrals.
    ///
    /// A mixture answers with one of its parts, drawn with its share; the mean of the answers is the mixture.
    fn bsdf<'a>(&'a self, appearance: &'a Appearance, at: &ShadingPoint<'_>) -> Bsdf<'a>;

    /// Whether [`Material::bsdf`] chooses among parts.
    fn is_mixture(&self) -> bool {
        false
    }

    /// The share of light that goes straight on at a point: through holes, where [`Material::bsdf`] answers with
    /// [`Bsdf::Null`], and through panes, where it answers with [`Bsdf::ThinDielectric`]. Of a mixture it is the mean,
    /// whatever `at.u` is.
    ///
    /// * `cos`: of the angle between light and normal
    fn passage(&self, _appearance: &Appearance, _at: &ShadingPoint<'_>, _cos: f32) -> Spectrum {
        Spectrum::BLACK
    }

    /// Whether [`Material::passage`] is more than nothing anywhere.
    fn has_passages(&self, appearance: &Appearance) -> bool {
        self.parts().iter().any(|&part| appearance.has_passages(part))
    }

    /// How the frame of [`Material::bsdf`] is to be turned.
    fn orientation(&self, _appearance: &Appearance, _at: &ShadingPoint<'_>) -> Orientation {
        Orientation::default()
    }

    /// Whether [`Material::orientation`] asks for anything anywhere.
    fn is_oriented(&self, appearance: &Appearance) -> bool {
        self.parts().iter().any(|&part| appearance.is_oriented(part))
    }

    /// What is behind the surface, for materials that refract.
    fn interior(&self, _appearance: &Appearance, _at: &ShadingPoint<'_>) -> Option<Interior> {
        None
    }

    /// The medium that it names as its own inside; see [`Interior::medium`].
    fn medium(&self) -> Option<MediumId> {
        None
    }

    /// Whether its [`Material::medium`] may be one in which light bends: only where there is nothing but the medium.
    fn may_bend_light(&self) -> bool {
        false
    }

    /// Whether its surface itself turns light that goes through it, as a lens of no thickness does.
    fn is_thin_lens(&self) -> bool {
        false
    }

    /// Whether a body of it is filled anywhere with a medium that absorbs or scatters light.
    fn has_medium(&self, appearance: &Appearance) -> bool {
        let own = self.medium().is_some_and(|medium| !appearance.media.bends_light(medium));
        own || self.parts().iter().any(|&part| appearance.has_medium(part))
    }

    /// Whether a body of it is filled anywhere with a medium in which light bends.
    fn bends_light(&self, appearance: &Appearance) -> bool {
        let own = self.medium().is_some_and(|medium| appearance.media.bends_light(medium));
        own || self.parts().iter().any(|&part| appearance.bends_light(part))
    }
}

family! {
    /// Names a material in [`Materials`].
    handle MaterialId;
    /// All materials of a scene.
    pools Materials;
    /// Any material.
    any AnyMaterial;
    contract Material;
    members {
        accretion_disks: AccretionDisk,
        blends: Blend,
        btfs: BtfMaterial,
        embossed: Embossed,
        glasses: Glass,
        gravitational_lenses: GravitationalLens,
        layered: LayeredMaterial,
        mattes: Matte,
        measured: MeasuredMaterial,
        metals: Metal,
        null_interfaces: NullInterface,
        perforated: Perforated,
        phongs: PhongMaterial,
    }
    any methods {
        /// See [`Material::is_finite`].
        fn is_finite() -> bool;
        /// See [`Material::parts`].
        fn parts() -> &[MaterialId];
        /// See [`Material::textures`].
        fn textures() -> Vec<AnyTexture<'_>>;
        /// See [`Material::medium`].
        fn medium() -> Option<MediumId>;
        /// See [`Material::may_bend_light`].
        fn may_bend_light() -> bool;
    }
    methods {
        /// See [`Material::emission`].
        fn emission(
            of_part: &dyn Fn(MaterialId) -> SurfaceEmission,
            textures: &mut Textures,
        ) -> Option<SurfaceEmission>;
        /// See [`Material::parts`].
        fn parts() -> &[MaterialId];
        /// See [`Material::medium`].
        fn medium() -> Option<MediumId>;
        /// See [`Material::constant`].
        fn constant() -> Option<&Phong>;
        /// See [`Material::is_mixture`].
        fn is_mixture() -> bool;
        /// See [`Material::wants_footprint`].
        fn wants_footprint() -> bool;
        /// See [`Material::is_thin_lens`].
        fn is_thin_lens() -> bool;
    }
    methods of Appearance.materials {
        /// See [`Material::phong`].
        fn phong(at: &TextureContext) -> Phong;
        /// See [`Material::may_transmit`].
        fn may_transmit() -> bool;
        /// See [`Material::needs_uv`].
        fn needs_uv() -> bool;
        /// See [`Material::bsdf`].
        fn bsdf(at: &ShadingPoint<'_>) -> Bsdf<'_>;
        /// See [`Material::passage`].
        fn passage(at: &ShadingPoint<'_>, cos: f32) -> Spectrum;
        /// See [`Material::has_passages`].
        fn has_passages() -> bool;
        /// See [`Material::orientation`].
        fn orientation(at: &ShadingPoint<'_>) -> Orientation;
        /// See [`Material::is_oriented`].
        fn is_oriented() -> bool;
        /// See [`Material::interior`].
        fn interior(at: &ShadingPoint<'_>) -> Option<Interior>;
        /// See [`Material::has_medium`].
        fn has_medium() -> bool;
        /// See [`Material::bends_light`].
        fn bends_light() -> bool;
    }
}

#[cfg(test)]
mod tint_tests;
