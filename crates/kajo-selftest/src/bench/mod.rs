//! What `kajo bench` measures: the renderer ([`whitted`]), ray casting alone ([`rays`]), reading scene
//! text ([`parse`]) and memory ([`memory`]).
//!
//! Everything measured is made here by formula, or is a mesh file given by the user, so that a figure can be
//! taken again anywhere. Every result is checked before its time is shown: a wrong picture is not a
//! fast one. Times are by wall clock and by processor time, the latter of all threads added up; on
//! a machine that does other work besides, compare by the latter.

mod machine;
pub mod memory;
pub mod parse;
mod pcg;
mod picture;
pub mod rays;
mod time;
pub mod whitted;

pub use machine::Machine;
pub use time::{Spread, Times};
