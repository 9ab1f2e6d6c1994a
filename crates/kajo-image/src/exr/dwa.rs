//! Sizes in chunks of DWA compression, compared with what the chunk may hold.
//!
//! Such a chunk begins with eleven numbers of 64 bits that say how large its sections are, packed and unpacked; the
//! decoder reserves what they ask for. Each channel's samples go, by the rules of the chunk, to one of three: the
//! samples as they are, runs of equal bytes, or the coefficients of blocks of 8 x 8 samples. So none of them can be
//! larger than all channels would make it. [OpenEXR, `internal_dwa_compressor.h`]

use ::exr::block::chunk::{Chunk, CompressedBlock};
use ::exr::math::Vec2;
use ::exr::meta::header::Header;
use ::exr::prelude::Compression;

use crate::{Format, ImageError};

/// The numbers at the beginning, in the order of the file.
const NAMES: [&str; 11] = [
    "version",
    "unpacked other samples",
    "packed other samples",
    "packed coefficients",
    "packed means of blocks",
    "packed runs",
    "runs",
    "samples of runs",
    "coefficients",
    "means of blocks",
    "kind of coefficients",
];

/// Checks the sizes in a chunk of DWA compression; other chunks pass.
///
/// # Errors
/// [`ImageError::Malformed`] for a chunk that is cut off or asks for more than its pixels are.
pub(super) fn check(chunk: &Chunk, header: &Header) -> Result<(), ImageError> {
    let packed = match (&chunk.compressed_block, header.compression) {
        (CompressedBlock::ScanLine(block), Compression::DWAA(_) | Compression::DWAB(_)) => {
            &block.compressed_pixels_le
        }
        (CompressedBlock::Tile(block), Compression::DWAA(_) | Compression::DWAB(_)) => {
            &block.compressed_pixels_le
        }
        _ => return Ok(()),
    };
    let place = header.get_block_data_indices(&chunk.compressed_block).map_err(malformed)?;
    let Vec2(width, height) = header.get_absolute_block_pixel_coordinates(place).map_err(malformed)?.size;
    let unpacked = width as u64 * height as u64 * header.channels.bytes_per_pixel as u64;
    // A chunk without content stands for zeros; one that would grow is stored as it is.
    if packed.is_empty() || packed.len() as u64 == unpacked {
        return Ok(());
    }
    let blocks = (width.div_ceil(8) * height.div_ceil(8)) as u64 * header.channels.list.len() as u64;
    let most = |index: usize| match index {
        1 | 7 => unpacked,
        2..=5 => packed.len() as u64,
        // The longest way to write a byte is a run of one.
        6 => 2 * unpacked,
        8 => 64 * blocks,
        9 => blocks,
        _ => u64::MAX,
    };
    let (numbers, _) = packed.as_chunks::<8>();
    if numbers.len() < NAMES.len() {
        return Err(malformed("it is cut off"));
    }
    for (index, (bytes, name)) in numbers.iter().zip(NAMES).enumerate() {
        let (found, most) = (u64::from_le_bytes(*bytes), most(index));
        if found > most {
            return Err(malformed(format_args!(
                "it claims {found} bytes or numbers of {name}, and has at most {most}"
            )));
        }
    }
    Ok(())
}

fn malformed(reason: impl std::fmt::Display) -> ImageError {
    ImageError::malformed(Format::Exr, format_args!("a DWA chunk contradicts itself: {reason}"))
}
