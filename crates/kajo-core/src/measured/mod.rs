//! Reflection that was measured, or rendered, and is looked up in tables.

mod brdf;
pub mod btf;
mod directions;
pub(crate) mod merl;
pub(crate) mod rgl;
mod tensor_file;
mod warp;

pub use brdf::{MeasuredBrdf, MeasuredError, MeasuredLanes};
pub use directions::{DirectionError, DirectionSet, MAX_DIRECTIONS, direction};
