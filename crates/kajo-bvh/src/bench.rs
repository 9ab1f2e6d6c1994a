//! Rays a second: a protocol that gives every ray caster the same work.
//!
//! A mesh file holds triangles and a camera. From them follow three sets of rays, for a
//! picture of 1024 x 1024 pixels: **primary** rays through the pixels' centres, tile by
//! tile; from each of their hits a **bounce** ray in a cosine-distributed direction and a
//! **shadow** ray to a point light. Figures are medians over passes, each by wall clock and
//! by processor time, which other work on the machine disturbs less.
//!
//! File (`KMSH`, little-endian): magic, version 1, vertex and triangle counts; eye, target,
//! up; vertical field of view in degrees; light; offset of secondary rays; then positions
//! as three `f32` each and triangles as three `u32` each.

mod clock;
mod gate;
mod mesh;
mod rays;
mod report;

pub use mesh::Mesh;
pub use rays::{Rays, primary, secondary};
pub use report::{Figures, Rates, Report, Settings, run};
