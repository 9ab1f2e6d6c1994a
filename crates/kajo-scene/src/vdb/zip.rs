//! Streams of zlib.

use crate::volume::VolumeError;

/// Fills an array from a stream of zlib.
pub fn unzip(packed: &[u8], bytes: &mut [u8]) -> Result<(), VolumeError> {
    let unpacked =
        miniz_oxide::inflate::decompress_slice_iter_to_slice(bytes, std::iter::once(packed), true, false);
    if unpacked.ok() == Some(bytes.len()) { Ok(()) } else { Err(damaged()) }
}

pub fn damaged() -> VolumeError {
    VolumeError::Content("compressed values of it are damaged".to_owned())
}
