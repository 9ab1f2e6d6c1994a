//! Integrators: from a camera ray to the light that arrives along it.

pub mod ambient_occlusion;
mod bodies;
pub mod classic;
pub mod path;
mod shadow;
mod view;
mod walk;

pub use ambient_occlusion::AmbientOcclusion;
pub use classic::{Classic, ClassicSettings};
pub use path::{Path, PathSettings};

#[cfg(test)]
mod tests;
