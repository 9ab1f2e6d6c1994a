//! A picture file to be written.

use std::path::PathBuf;

use kajo::{Format, View};

use crate::failure::Failure;

/// A file to be written and what it shows.
#[derive(Debug)]
pub struct Output {
    pub destination: Destination,
    pub format: Format,
    pub views: Vec<View>,
}

/// Where the bytes of a picture go.
#[derive(Debug)]
pub enum Destination {
    File(PathBuf),
    StandardOutput,
}

impl Destination {
    /// The format that the name's ending says; PNG for standard output and devices.
    ///
    /// # Errors
    /// When the ending says nothing.
    pub fn format(&self) -> Result<Format, Failure> {
        let Destination::File(path) = self else { return Ok(Format::Png) };
        let extension = path.extension().map(|extension| extension.to_string_lossy());
        let is_device = extension.is_none() && path.starts_with("/dev");
        let format = extension.and_then(|extension| Format::from_extension(&extension));
        format.or(is_device.then_some(Format::Png)).ok_or_else(|| {
            let message = "its ending says no format; known are .png, .exr, .tga, .bmp, .ppm, .pfm and .hdr";
            Failure::Input(format!("cannot write `{}`: {message}", path.display()))
        })
    }
}
