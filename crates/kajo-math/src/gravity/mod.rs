//! Light in the curved spacetimes of general relativity: black holes and wormholes.
//!
//! Units are geometric: the gravitational constant and the speed of light are 1, so mass is a length (that of the sun is
//! 1.477 km). Metrics have the signature `- + + +`. Everything is in double precision.
//!
//! * [`Kerr`]: the metric of a rotating black hole in Kerr-Schild coordinates and the rays of light in it; without spin it is
//!   that of Schwarzschild
//! * [`Observer`]: the frame of a camera, of a surface or of an emitter at any velocity
//! * [`ThinDisk`]: gas that orbits in the equatorial plane, after Novikov, Page and Thorne
//! * [`ThinLens`]: a weak lens, far from everything
//! * [`Wormhole`]: a throat between two places
//! * [`schwarzschild`]: what is known of a hole without spin in closed form

mod kerr;
mod observer;
pub mod schwarzschild;
pub mod thin_disk;
mod thin_lens;
mod wormhole;

pub use kerr::{Conserved, Kerr, KerrMetric};
pub use observer::{Observer, seen_from_rest};
pub use thin_disk::ThinDisk;
pub use thin_lens::ThinLens;
pub use wormhole::{Profile, ThroatPassage, Wormhole};
