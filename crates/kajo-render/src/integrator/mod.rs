//! Integrators: from a camera ray to the light that arrives along it.

pub mod classic;
mod shadow;

pub use classic::{Classic, ClassicSettings};

#[cfg(test)]
mod tests;
