//! What is read from a picture file.

use crate::{BitDepth, Format, Image};

/// A picture read from a file.
#[derive(Debug, Clone, PartialEq)]
pub struct Decoded {
    /// What the file was.
    pub format: Format,
    /// The numbers as stored: whole numbers divided by their maximum, floats as they are.
    /// Of an OpenEXR file, the picture a viewer would show.
    pub image: Image,
    /// Bits per sample in the file; `None` for floats.
    pub depth: Option<BitDepth>,
    /// Remarks: keyword and text.
    pub text: Vec<(String, String)>,
}
