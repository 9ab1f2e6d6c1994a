//! How a picture is written.

use crate::{BitDepth, Image, Quantiser};

/// How a picture is written. Formats take from it what they can hold: float formats ignore
/// the quantiser, only PNG has 16 bits, only PNG and OpenEXR have text.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct EncodeOptions {
    /// Bits per sample in PNG.
    pub depth: BitDepth,
    /// From floats to whole numbers.
    pub quantiser: Quantiser,
    /// Write red, green, blue and an alpha of 1, whatever channels the picture has; this
    /// is what the classic ray tracer writes. For PNG and TGA.
    pub opaque_alpha: bool,
    /// Remarks: keyword and text.
    pub text: Vec<(String, String)>,
}

impl EncodeOptions {
    /// The stored numbers of `image`, in its own order; alpha takes no curve.
    pub(crate) fn quantise(&self, image: &Image) -> Vec<u16> {
        let channels = image.channels();
        let colours = if channels.is_multiple_of(2) { channels - 1 } else { channels };
        let mut samples = Vec::with_capacity(image.data().len());
        for pixel in image.pixels() {
            let (colour, alpha) = pixel.split_at(colours);
            samples.extend(colour.iter().map(|&v| self.quantiser.colour(v, self.depth)));
            samples.extend(alpha.iter().map(|&v| self.quantiser.linear(v, self.depth)));
        }
        samples
    }

    pub(crate) fn bytes(&self, image: &Image) -> Vec<u8> {
        let eight = Self { depth: BitDepth::Eight, ..self.clone() };
        eight.quantise(image).iter().map(|&v| v as u8).collect()
    }
}
