//! The file of a tiled copy.
//!
//! ```text
//! "KAJOTILE"                        8 bytes
//! tiles                             each a stream of zlib [RFC 1950], level by level, row by row
//! index                             for each tile: offset u64, length u32
//! description                       a stream of zlib, see below
//! offset of the description         u64
//! its length                        u32
//! "KAJOTILE"                        8 bytes
//!
//! description:  version u32 · width u32 · height u32 · encoding u32 (0 sRGB, 1 linear) · stamp of the source u64
//!               · values outside of [0, 1] u64 · means f32 x 4 · tiles u32
//! ```
//!
//! All numbers are little-endian. A tile begins with one byte. After 0 follow red, green, blue and alpha in planes: for each the upper bytes of
//! all texels and then the lower ones. After 1 a texel has one byte for each channel, the number of the file that it comes from, where 8 bits were
//! all that it had. Each number is less its left neighbour's, so that smooth pictures have small ones. Checksums are those of zlib.

use std::cell::RefCell;
use std::io::{self, Write};

use miniz_oxide::deflate::compress_to_vec_zlib;
use miniz_oxide::inflate::{decompress_slice_iter_to_slice, decompress_to_vec_zlib_with_limit};

use super::{LevelShape, SIDE, Tile, TileTexels};
use crate::texture::picture::Encoding;

/// The ending of the names of tiled copies.
pub const TILED_EXTENSION: &str = "ktile";

const MAGIC: &[u8; 8] = b"KAJOTILE";
const VERSION: u32 = 1;
/// Bytes after the description.
const FOOTER: u64 = 8 + 4 + 8;
/// Bytes of a tile in the index.
const ENTRY: u64 = 8 + 4;
const DESCRIPTION: usize = 4 + 4 + 4 + 4 + 8 + 8 + 16 + 4;
/// How hard is tried to make it small: fast.
const EFFORT: u8 = 2;

/// Why a tiled copy cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum TiledError {
    /// It is no tiled copy, or a part of it is damaged.
    #[error("it is damaged")]
    Damaged,
    /// It is that of another state of the file, or of another version of this program.
    #[error("it is out of date")]
    Outdated,
    /// The operating system refused.
    #[error("{0}")]
    Io(#[from] io::Error),
}

/// What a tiled copy says about itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Description {
    pub size: [u32; 2],
    pub encoding: Encoding,
    /// [`kajo_scene::AssetFile::stamp`] of the file that it is a copy of.
    pub stamp: u64,
    /// How many values of the file are not between 0 and 1.
    pub outside: u64,
    pub mean: [f32; 4],
}

/// A tiled copy's description, and where its index is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Header {
    pub description: Description,
    index: u64,
}

/// Reads parts of a file.
pub trait ReadAt {
    /// Bytes in the file.
    ///
    /// # Errors
    /// Those of the system.
    fn bytes(&self) -> io::Result<u64>;

    /// Fills the buffer from `offset` on.
    ///
    /// # Errors
    /// Those of the system, and where the file ends before.
    fn read_at(&self, offset: u64, buffer: &mut [u8]) -> io::Result<()>;
}

/// Takes numbers from the front of bytes.
struct Fields<'a>(&'a [u8]);

impl Fields<'_> {
    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (first, rest) = self.0.split_first_chunk::<N>()?;
        self.0 = rest;
        Some(*first)
    }

    fn u32(&mut self) -> Option<u32> {
        self.take().map(u32::from_le_bytes)
    }

    fn u64(&mut self) -> Option<u64> {
        self.take().map(u64::from_le_bytes)
    }
}

impl Description {
    fn bytes(&self, tiles: u32) -> Vec<u8> {
        let encoding = match self.encoding {
            Encoding::Srgb => 0,
            Encoding::Linear => 1,
        };
        let mut bytes = Vec::with_capacity(DESCRIPTION);
        for number in [VERSION, self.size[0], self.size[1], encoding] {
            bytes.extend(number.to_le_bytes());
        }
        bytes.extend(self.stamp.to_le_bytes());
        bytes.extend(self.outside.to_le_bytes());
        self.mean.iter().for_each(|mean| bytes.extend(mean.to_le_bytes()));
        bytes.extend(tiles.to_le_bytes());
        bytes
    }

    /// The description and the number of tiles.
    fn read(bytes: &[u8]) -> Option<(u32, Description, u32)> {
        let mut fields = Fields(bytes);
        let version = fields.u32()?;
        let size = [fields.u32()?, fields.u32()?];
        let encoding = match fields.u32()? {
            0 => Encoding::Srgb,
            1 => Encoding::Linear,
            _ => return None,
        };
        let (stamp, outside) = (fields.u64()?, fields.u64()?);
        let mut mean = [0.0; 4];
        for mean in &mut mean {
            *mean = f32::from_le_bytes(fields.take()?);
        }
        let description = Description { size, encoding, stamp, outside, mean };
        Some((version, description, fields.u32()?))
    }
}

/// Makes bytes of tiles.
#[derive(Debug)]
struct TilePacker {
    /// For each number of a texel the number of 8 bits that becomes it, [of colours, of alpha]; 256 where there is none.
    bytes: [Vec<u16>; 2],
}

impl TilePacker {
    fn new(encoding: Encoding) -> TilePacker {
        let bytes = encoding.stored_bytes().map(|numbers| {
            let mut bytes = vec![256; 1 << 16];
            (0u16..).zip(numbers).for_each(|(byte, number)| bytes[usize::from(number)] = byte);
            bytes
        });
        TilePacker { bytes }
    }

    /// The bytes of a channel, where each number is one that 8 bits become.
    fn bytes_of(&self, texels: &[[u16; 4]], channel: usize) -> Option<Vec<u8>> {
        let bytes = &self.bytes[usize::from(channel == 3)];
        texels.iter().map(|texel| u8::try_from(bytes[usize::from(texel[channel])]).ok()).collect()
    }

    /// * `texels`: of a tile, in rows of `width`
    fn pack(&self, texels: &[[u16; 4]], width: usize) -> Vec<u8> {
        let mut planes = Vec::with_capacity(1 + 8 * texels.len());
        let narrow: Option<Vec<_>> = (0..4).map(|channel| self.bytes_of(texels, channel)).collect();
        planes.push(u8::from(narrow.is_some()));
        if let Some(channels) = narrow {
            for row in channels.iter().flat_map(|channel| channel.chunks(width)) {
                planes.extend(
                    row.iter().scan(0u8, |left, &v| Some(v.wrapping_sub(std::mem::replace(left, v)))),
                );
            }
        } else {
            for channel in 0..4 {
                let difference = |row: &[[u16; 4]]| {
                    let mut left = 0u16;
                    row.iter()
                        .map(|texel| {
                            texel[channel].wrapping_sub(std::mem::replace(&mut left, texel[channel]))
                        })
                        .collect::<Vec<_>>()
                };
                let differences: Vec<u16> = texels.chunks(width).flat_map(difference).collect();
                planes.extend(differences.iter().map(|v| (v >> 8) as u8));
                planes.extend(differences.iter().map(|&v| v as u8));
            }
        }
        compress_to_vec_zlib(&planes, EFFORT)
    }
}

/// The tile of its bytes.
fn unpack(bytes: &[u8], [width, height]: [u32; 2], encoding: Encoding) -> Option<Tile> {
    thread_local! {
        static PLANES: RefCell<Vec<u8>> = const { RefCell::new(Vec::new()) };
    }
    let (n, row) = ((width * height) as usize, width as usize);
    PLANES.with_borrow_mut(|planes| {
        planes.resize(1 + 8 * n, 0);
        let filled = decompress_slice_iter_to_slice(planes, std::iter::once(bytes), true, false).ok()?;
        let (&kind, planes) = planes[..filled].split_first()?;
        let texels = match kind {
            0 if planes.len() == 8 * n => TileTexels::Stored(stored_of(planes, row)),
            1 if planes.len() == 4 * n => TileTexels::Bytes(bytes_of(planes, row), encoding.stored_bytes()),
            _ => return None,
        };
        Some(Tile { width, texels })
    })
}

/// Numbers of 8 bits from the planes of their differences.
fn bytes_of(planes: &[u8], row: usize) -> Vec<[u8; 4]> {
    let n = planes.len() / 4;
    let [r, g, b, alpha] = std::array::from_fn(|channel| planes[channel * n..][..n].iter());
    let mut texels: Vec<_> = r.zip(g).zip(b).zip(alpha).map(|(((&r, &g), &b), &a)| [r, g, b, a]).collect();
    for row in texels.chunks_mut(row) {
        let mut left = [0u8; 4];
        for texel in row {
            left = std::array::from_fn(|c| left[c].wrapping_add(texel[c]));
            *texel = left;
        }
    }
    texels
}

/// Texels from the planes of the upper and the lower bytes of their differences.
fn stored_of(planes: &[u8], row: usize) -> Vec<[u16; 4]> {
    let n = planes.len() / 8;
    let plane = |number: usize| &planes[number * n..][..n];
    let channels: [_; 4] = std::array::from_fn(|channel| [plane(2 * channel), plane(2 * channel + 1)]);
    let difference = |i: usize| channels.map(|[upper, lower]| u16::from_be_bytes([upper[i], lower[i]]));
    let mut texels: Vec<_> = (0..n).map(difference).collect();
    for row in texels.chunks_mut(row) {
        let mut left = [0u16; 4];
        for texel in row {
            left = std::array::from_fn(|c| left[c].wrapping_add(texel[c]));
            *texel = left;
        }
    }
    texels
}

/// Writes the tiled copy of a picture.
///
/// * `levels`: all of them, the largest first, each with its texels row by row
pub(super) fn write(
    description: &Description,
    levels: &[(LevelShape, &[[u16; 4]])],
    to: &mut dyn Write,
) -> io::Result<()> {
    let packer = TilePacker::new(description.encoding);
    to.write_all(MAGIC)?;
    let mut offset = MAGIC.len() as u64;
    let mut index = Vec::new();
    for (shape, texels) in levels {
        for (column, row) in shape.tile_positions() {
            let [width, _] = shape.tile_size(column, row);
            let bytes = packer.pack(&cut(*shape, texels, column, row), width as usize);
            to.write_all(&bytes)?;
            index.extend(offset.to_le_bytes());
            index.extend((bytes.len() as u32).to_le_bytes());
            offset += bytes.len() as u64;
        }
    }
    to.write_all(&index)?;
    offset += index.len() as u64;
    let tiles = (index.len() as u64 / ENTRY) as u32;
    let description = compress_to_vec_zlib(&description.bytes(tiles), EFFORT);
    to.write_all(&description)?;
    to.write_all(&offset.to_le_bytes())?;
    to.write_all(&(description.len() as u32).to_le_bytes())?;
    to.write_all(MAGIC)
}

/// The texels of one tile of a level.
pub(super) fn cut(shape: LevelShape, texels: &[[u16; 4]], column: u32, row: u32) -> Vec<[u16; 4]> {
    let [width, height] = shape.tile_size(column, row);
    let stride = shape.width as usize;
    let first = (row * SIDE) as usize * stride + (column * SIDE) as usize;
    let rows = (0..height as usize).map(|y| &texels[first + y * stride..][..width as usize]);
    rows.flatten().copied().collect()
}

impl Header {
    /// What a tiled copy says about itself; whether its tiles are whole is seen when they are read.
    ///
    /// # Errors
    /// [`TiledError::Damaged`], [`TiledError::Outdated`] where it is of another version, or those of the system.
    pub fn read(file: &dyn ReadAt) -> Result<Header, TiledError> {
        let len = file.bytes()?;
        let start = len.checked_sub(FOOTER).ok_or(TiledError::Damaged)?;
        let mut footer = [0; FOOTER as usize];
        file.read_at(start, &mut footer)?;
        let mut fields = Fields(&footer);
        let (offset, length) = fields.u64().zip(fields.u32()).ok_or(TiledError::Damaged)?;
        // Compressed, so little is hardly more than it was.
        let is_whole = fields.0 == MAGIC
            && length as usize <= 2 * DESCRIPTION
            && offset.checked_add(length.into()) == Some(start);
        if !is_whole {
            return Err(TiledError::Damaged);
        }
        let mut packed = vec![0; length as usize];
        file.read_at(offset, &mut packed)?;
        let bytes =
            decompress_to_vec_zlib_with_limit(&packed, DESCRIPTION).map_err(|_| TiledError::Damaged)?;
        let (version, description, tiles) = Description::read(&bytes).ok_or(TiledError::Damaged)?;
        if version != VERSION {
            return Err(TiledError::Outdated);
        }
        let [width, height] = description.size;
        let is_sized = width > 0 && height > 0 && u64::from(width) * u64::from(height) <= 1 << 31;
        let index = offset.checked_sub(ENTRY * u64::from(tiles)).filter(|_| is_sized);
        let index = index.ok_or(TiledError::Damaged)?;
        if count(&LevelShape::all(width, height)) != tiles {
            return Err(TiledError::Damaged);
        }
        Ok(Header { description, index })
    }

    /// Reads one tile of a level.
    ///
    /// # Errors
    /// [`TiledError::Damaged`] or those of the system.
    pub fn tile(&self, file: &dyn ReadAt, shape: LevelShape, number: u32) -> Result<Tile, TiledError> {
        let mut entry = [0; ENTRY as usize];
        file.read_at(self.index + ENTRY * u64::from(shape.first + number), &mut entry)?;
        let mut fields = Fields(&entry);
        let (offset, length) = fields.u64().zip(fields.u32()).ok_or(TiledError::Damaged)?;
        let [column, row] = [number % shape.tiles()[0], number / shape.tiles()[0]];
        let size = shape.tile_size(column, row);
        // What cannot be made smaller is kept as it is, with a few bytes more.
        let most = 2 * (1 + 8 * u64::from(size[0] * size[1])) + 64;
        let ends = offset.checked_add(length.into()).filter(|&end| end <= self.index);
        if ends.is_none() || u64::from(length) > most {
            return Err(TiledError::Damaged);
        }
        let mut packed = vec![0; length as usize];
        file.read_at(offset, &mut packed)?;
        unpack(&packed, size, self.description.encoding).ok_or(TiledError::Damaged)
    }
}

/// Tiles of all levels.
fn count(levels: &[LevelShape]) -> u32 {
    levels.last().map_or(0, |last| last.first + 1)
}
