//! Light along a ray, and what becomes of it in a picture.
//!
//! [`Spectrum`] carries four lanes. Today the first three are linear RGB with the primaries
//! of sRGB and the fourth is zero; a spectral mode will put four wavelengths there. Code
//! that integrates light treats lanes alike and never asks which mode it is in.

pub mod spectrum;
pub mod srgb;

pub use spectrum::Spectrum;
