//! Light along a ray, and what becomes of it in a picture.
//!
//! [`Spectrum`] carries four lanes: linear RGB with the primaries of sRGB, or radiance at the four
//! wavelengths of a [`Wavelengths`], which travels with the path and decides which of the two it is. Code
//! that moves light treats lanes alike. Three places look at the mode: colour data as it is read by
//! [`Reflectance::at`], [`Unbounded::at`], [`Emission::at`] and, for textures, [`RgbBasis`]; dispersion, which calls
//! [`Wavelengths::terminate_secondary`]; and the [`sensor`].
//!
//! Radiance and colours are linear everywhere. What is not says so in its name.

mod aces;
pub mod basis;
mod black_bodies;
mod data;
pub mod dispersion;
pub mod emission;
pub mod gamut;
pub mod illuminant;
pub mod matrix;
pub mod metal;
pub mod named;
pub mod observer;
pub mod oklab;
mod planck;
pub mod reflectance;
pub mod sensor;
pub mod spectrum;
pub mod srgb;
pub mod tabulated;
pub mod tone;
mod uplift;
mod wavelength_choice;
pub mod wavelengths;
pub mod white;

pub use basis::RgbBasis;
pub use black_bodies::BlackBodies;
pub use dispersion::Dispersion;
pub use emission::Emission;
pub use metal::MeasuredMetal;
pub use reflectance::{Reflectance, Unbounded};
pub use spectrum::Spectrum;
pub use tabulated::{Outside, Tabulated};
pub use tone::Tone;
pub use wavelength_choice::WavelengthChoice;
pub use wavelengths::Wavelengths;
