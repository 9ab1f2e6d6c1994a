//! Integrators: from a camera ray to the light that arrives along it.

pub mod ambient_occlusion;
pub mod bidir;
mod camera_view;
pub mod classic;
pub mod path;
mod shadow;
mod transport;

pub use ambient_occlusion::AmbientOcclusion;
pub use bidir::{Bidirectional, BidirectionalSettings};
pub use classic::{Classic, ClassicSettings};
pub use path::{Path, PathSettings};

#[cfg(test)]
mod flat_tests;
#[cfg(test)]
mod immersion_tests;
#[cfg(test)]
mod limit_tests;
#[cfg(test)]
mod motion_tests;
#[cfg(test)]
mod tests;
