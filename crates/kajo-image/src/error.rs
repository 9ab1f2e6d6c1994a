//! What can go wrong with a picture, sorted by whose fault it is.

use crate::Format;

/// Why a picture could not be made, read or written.
///
/// There is no input/output variant: this crate works on bytes in memory.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ImageError {
    /// The file is at fault: its bytes are cut short, damaged or contradictory.
    #[error("not a valid {format} picture: {reason}")]
    Malformed {
        /// The format the bytes claim to be.
        format: Format,
        /// What is wrong, in the decoder's words.
        reason: String,
    },
    /// The bytes belong to no format this crate reads.
    #[error("not a picture of a known format (PNG, JPEG, OpenEXR, TGA, BMP, WebP, PPM, PFM or Radiance HDR)")]
    UnknownFormat,
    /// The file may be valid, but asks for something this crate lacks.
    #[error("this {format} picture is not supported: {feature}")]
    Unsupported {
        /// The format of the file.
        format: Format,
        /// What is missing.
        feature: String,
    },
    /// The picture is larger than the caller's [`DecodeLimits`](crate::DecodeLimits) allow.
    #[error("picture too large: {what} is {needed}, the limit is {limit}")]
    Limit {
        /// What is too large.
        what: &'static str,
        /// How much the picture asks for, at least.
        needed: u64,
        /// How much the caller allows.
        limit: u64,
    },
    /// The system has no memory left for the picture.
    #[error("no memory for {needed} bytes of a picture")]
    Memory {
        /// Bytes asked for.
        needed: u64,
    },
    /// The caller's arguments contradict each other.
    #[error("{0}")]
    Parameter(String),
}

impl ImageError {
    pub(crate) fn malformed(format: Format, reason: impl ToString) -> Self {
        Self::Malformed { format, reason: reason.to_string() }
    }

    pub(crate) fn unsupported(format: Format, feature: impl ToString) -> Self {
        Self::Unsupported { format, feature: feature.to_string() }
    }

    pub(crate) fn memory(needed: u64) -> Self {
        Self::Memory { needed }
    }

    pub(crate) fn parameter(reason: impl ToString) -> Self {
        Self::Parameter(reason.to_string())
    }
}
