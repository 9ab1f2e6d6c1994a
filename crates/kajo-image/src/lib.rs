//! Pixel buffers, picture files and picture comparison for kajo.
//!
//! An [`Image`] is `height × width × channels` floats, row 0 on top. [`encode`] turns it
//! into the bytes of a picture file and [`decode`] turns such bytes back, whoever wrote
//! them; [`exr`] handles files with many layers. [`metrics`] says how far two pictures
//! are apart and [`difference`] shows where.
//!
//! The crate takes bytes and returns bytes: it never opens a file. Decoding checks a
//! picture's size against [`DecodeLimits`] before it reserves memory, and bytes from
//! anywhere end in a typed [`ImageError`], never in a panic.

mod codec;
mod contained;
mod decoded;
mod encode_options;
mod error;
mod format;
mod image;
mod limits;
mod quantise;

pub mod colormap;
pub mod denoise;
pub mod difference;
pub mod exr;
pub mod metrics;
pub mod pfm;
pub mod png;

pub use codec::{decode, encode};
pub use contained::is_contained;
pub use decoded::Decoded;
pub use encode_options::EncodeOptions;
pub use error::ImageError;
pub use format::Format;
pub use image::{Crop, Image};
pub use limits::DecodeLimits;
pub use quantise::{BitDepth, Quantiser, Rounding, Transfer};
