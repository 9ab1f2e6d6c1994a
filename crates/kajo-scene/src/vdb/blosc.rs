//! Containers of Blosc, version 1.
//!
//! ```text
//! u8 version, u8 version of the codec, u8 flags, u8 width of a number
//! u32 bytes, u32 bytes of a block, u32 bytes of the container
//! u32 start of each block          unless the content is stored as it is (flag 2)
//! block: one stream, or as many as a number has bytes; each a u32 length and the data
//! ```
//!
//! Flags: 1 bytes are shuffled, so that first those of all numbers come, then all second ones; 2 stored as it is; 4 bits are shuffled; 16 blocks
//! are one stream; the upper three are the codec: 0 BloscLZ, 1 LZ4, 2 Snappy, 3 zlib, 4 Zstandard.
//! [Alted, c-blosc 1.21, `README_CHUNK_FORMAT.rst`, `blosc.c`].

use super::lz4;
use super::zip::{damaged, unzip};
use crate::volume::VolumeError;

/// Bytes by which a container is longer than its content, at most.
pub const OVERHEAD: usize = 16;

/// Fills an array from a container.
pub fn unpack(packed: &[u8], out: &mut [u8]) -> Result<(), VolumeError> {
    let (head, _) = packed.split_first_chunk::<OVERHEAD>().ok_or_else(damaged)?;
    let word = |at: usize| read_u32(packed, at).ok_or_else(damaged);
    let (flags, width) = (head[2], usize::from(head[3]).max(1));
    let [bytes, block] = [word(4)?, word(8)?];
    if bytes != out.len() {
        return Err(damaged());
    }
    if bytes == 0 {
        return Ok(());
    }
    if flags & 2 != 0 {
        out.copy_from_slice(packed.get(OVERHEAD..OVERHEAD + bytes).ok_or_else(damaged)?);
        return Ok(());
    }
    if flags & 4 != 0 {
        return Err(VolumeError::Content(
            "its values are compressed by Blosc with shuffled bits, which is not read".to_owned(),
        ));
    }
    let codec = flags >> 5;
    if block == 0 || block > bytes {
        return Err(damaged());
    }
    let mut shuffled = vec![0; if flags & 1 != 0 && width > 1 { block } else { 0 }];
    for (index, part) in out.chunks_mut(block).enumerate() {
        let start = word(OVERHEAD + 4 * index)?;
        // The last block, if it is shorter, is never split.
        let is_split = flags & 16 == 0 && width <= 16 && block / width >= 128 && part.len() == block;
        let streams = if is_split { width } else { 1 };
        let len = part.len();
        let target = if shuffled.is_empty() { &mut *part } else { &mut shuffled[..len] };
        let mut at = start;
        for stream in target.chunks_mut(len / streams) {
            let length = word(at)?;
            let data = at.checked_add(4).and_then(|at| packed.get(at..at.checked_add(length)?));
            let data = data.ok_or_else(damaged)?;
            at += 4 + length;
            if length == stream.len() {
                stream.copy_from_slice(data);
                continue;
            }
            decode(codec, data, stream)?;
        }
        if !shuffled.is_empty() {
            unshuffle(&shuffled[..len], part, width);
        }
    }
    Ok(())
}

/// Fills a stream by the codec of this number.
fn decode(codec: u8, data: &[u8], stream: &mut [u8]) -> Result<(), VolumeError> {
    match codec {
        1 => lz4::unpack(data, stream).ok_or_else(damaged),
        3 => unzip(data, stream),
        _ => {
            let name = ["BloscLZ", "LZ4", "Snappy", "zlib", "Zstandard"]
                .get(usize::from(codec))
                .unwrap_or(&"an unknown codec");
            let message =
                format!("its values are compressed by Blosc with {name}, and only LZ4 and zlib are read");
            Err(VolumeError::Content(message))
        }
    }
}

fn read_u32(bytes: &[u8], at: usize) -> Option<usize> {
    let word = bytes.get(at..at.checked_add(4)?)?;
    Some(u32::from_le_bytes([word[0], word[1], word[2], word[3]]) as usize)
}

/// First bytes first, then second ones, to numbers; what is behind the last whole number stays.
fn unshuffle(shuffled: &[u8], out: &mut [u8], width: usize) {
    let count = shuffled.len() / width;
    for byte in 0..width {
        for (k, &value) in shuffled[byte * count..(byte + 1) * count].iter().enumerate() {
            out[k * width + byte] = value;
        }
    }
    out[count * width..].copy_from_slice(&shuffled[count * width..]);
}
