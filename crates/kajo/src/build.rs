#![doc = include_str!("../../../docs/src/program/library.md")]

pub use kajo_color::{Dispersion, Emission, Reflectance, Spectrum};
pub use kajo_core::background::Background;
pub use kajo_core::builder::{AssemblyPart, BuildSettings, PartContent, SceneBuilder, SceneError};
pub use kajo_core::emission::SurfaceEmission;
pub use kajo_core::ids::{AssemblyId, LightGroup, LightIndex, ObjectId, PoseId};
pub use kajo_core::medium::Fog;
pub use kajo_core::{Shutter, bsdf, camera, daylight, environment, light, material, shape, texture};
