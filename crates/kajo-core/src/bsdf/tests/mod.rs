//! What every lobe must hold, from one list.

mod laws;
mod list;
mod microfacets;
mod random;
mod tables;
