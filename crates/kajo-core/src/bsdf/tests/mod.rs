//! What every lobe must hold, from one list.

mod brushed_clear;
mod brushed_metal;
mod laws;
pub(crate) mod list;
mod microfacets;
mod random;
mod tables;
