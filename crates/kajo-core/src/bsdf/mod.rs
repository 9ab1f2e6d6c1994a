//! What a surface does with light at one point, as a small value.

pub mod fresnel;
mod phong;

pub use phong::{Highlight, Phong};
