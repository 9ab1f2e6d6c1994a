//! What every lobe must hold, from one list.

mod accuracy;
mod brushed_clear;
mod brushed_metal;
mod laws;
pub(crate) mod list;
mod microfacets;
mod random;
mod tables;

use super::Bsdf;

/// The same scattering for whoever keeps no scene; of a material that is looked up in tables there is none.
pub fn without_tables(bsdf: Bsdf<'_>) -> Bsdf<'static> {
    match bsdf {
        Bsdf::Lambert(lobe) => Bsdf::Lambert(lobe),
        Bsdf::OrenNayar(lobe) => Bsdf::OrenNayar(lobe),
        Bsdf::BumpedDiffuse(lobe) => Bsdf::BumpedDiffuse(lobe),
        Bsdf::Conductor(lobe) => Bsdf::Conductor(lobe),
        Bsdf::Dielectric(lobe) => Bsdf::Dielectric(lobe),
        Bsdf::ThinDielectric(lobe) => Bsdf::ThinDielectric(lobe),
        Bsdf::Phong(lobe) => Bsdf::Phong(lobe),
        Bsdf::Principled(lobe) => Bsdf::Principled(lobe),
        Bsdf::Subsurface(lobe) => Bsdf::Subsurface(lobe),
        Bsdf::Deflector(lobe) => Bsdf::Deflector(lobe),
        Bsdf::Null => Bsdf::Null,
        Bsdf::Btf(_) | Bsdf::Measured(_) => panic!("its tables belong to the scene"),
    }
}
