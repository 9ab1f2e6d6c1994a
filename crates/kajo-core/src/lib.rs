//! The compiled scene and everything evaluated along a ray.
//!
//! [`compile::compile`] turns the tree of a scene text into a [`Scene`]: typed pools, 32-bit handles and
//! a tree of bounds. Nothing here opens a file, starts a thread or prints.

pub mod animation;
pub mod background;
pub mod bsdf;
pub mod builder;
pub mod camera;
pub mod compile;
pub mod curved_light;
pub mod daylight;
pub mod differential;
pub mod emission;
mod emissive_media;
pub mod environment;
mod family;
pub mod ids;
pub mod interaction;
mod item_buffer;
#[cfg(test)]
mod laws;
pub mod light;
pub mod lighting;
pub mod material;
pub mod measured;
pub mod medium;
mod motion;
mod moving_tree;
mod nested;
mod objects;
pub mod sampler;
pub mod scene;
pub mod schema;
pub mod settings;
pub mod shading;
pub mod shape;
mod sky_disc;
pub mod space;
pub mod star_field;
pub mod texture;

pub use family::Pooled;
pub use ids::{LightGroup, LightIndex, ObjectId};
pub use interaction::RayOffset;
pub use item_buffer::ItemBuffer;
pub use motion::{MovingTransform, Shutter};
pub use nested::{ElementContent, NestedElement};
pub use objects::{Object, Objects};
pub use scene::{Interaction, RayEvent, Scene};
