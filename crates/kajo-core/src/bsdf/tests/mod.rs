//! What every lobe must hold, from one list.

mod brushed;
mod laws;
pub(crate) mod list;
mod microfacets;
mod random;
mod tables;
