//! Pictures in tiles: files of which a render reads what it sees, and the cache that holds it.
//!
//! A [tiled copy](format) of a picture has its texels and those of all smaller copies in tiles of 64 x 64. [`TileCache`] keeps the
//! tiles that were asked for last, within a number of bytes, however large the pictures are together [Pharr and Hanrahan 1996]. Texels are the same
//! bits as those of the whole picture in memory, so what is cached, and when, changes no picture.

mod cache;
mod format;
mod picture;
#[cfg(test)]
mod tests;

pub use cache::{TileCache, TileFiles};
pub use format::{ReadAt, TILED_EXTENSION, TiledError};
pub use picture::{TiledCopies, TilingRule};
pub(super) use picture::{TiledLevel, TiledPicture};

use crate::texture::picture::StoredBytes;

/// Side of a tile, in texels.
const SIDE: u32 = 64;

/// A number that differs when bytes do [Fowler, Noll and Vo, FNV-1a].
pub(crate) fn content_stamp(bytes: &[u8]) -> u64 {
    bytes
        .iter()
        .fold(0xcbf2_9ce4_8422_2325, |hash, &byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

/// A tile of a level. Those at the right and the lower edge of a level may be smaller than others.
#[derive(Debug)]
struct Tile {
    width: u32,
    texels: TileTexels,
}

/// The texels of a tile, row by row.
#[derive(Debug)]
enum TileTexels {
    /// As pictures in memory have them.
    Stored(Vec<[u16; 4]>),
    /// Numbers of 8 bits of a file, which take half the memory, and what texels have for them.
    Bytes(Vec<[u8; 4]>, &'static StoredBytes),
}

impl Tile {
    /// * `x`, `y`: within the tile
    #[inline]
    fn texel(&self, x: usize, y: usize) -> [u16; 4] {
        let i = y * self.width as usize + x;
        match &self.texels {
            TileTexels::Stored(texels) => texels[i],
            TileTexels::Bytes(bytes, [colors, alphas]) => {
                let [r, g, b, alpha] = bytes[i].map(usize::from);
                [colors[r], colors[g], colors[b], alphas[alpha]]
            }
        }
    }

    /// Bytes that it takes in memory.
    fn bytes(&self) -> u64 {
        let texels = match &self.texels {
            TileTexels::Stored(texels) => size_of_val(&texels[..]),
            TileTexels::Bytes(bytes, _) => size_of_val(&bytes[..]),
        };
        (size_of::<Tile>() + texels) as u64
    }
}

/// A level of the pyramid in tiles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct LevelShape {
    width: u32,
    height: u32,
    /// The number of its first tile among those of all levels.
    first: u32,
}

impl LevelShape {
    /// Tiles across and down.
    fn tiles(&self) -> [u32; 2] {
        [self.width.div_ceil(SIDE), self.height.div_ceil(SIDE)]
    }

    /// The levels of a picture, the largest first.
    fn all(width: u32, height: u32) -> Vec<LevelShape> {
        let mut levels = vec![LevelShape { width, height, first: 0 }];
        loop {
            let last = levels[levels.len() - 1];
            if last.width == 1 && last.height == 1 {
                return levels;
            }
            let [across, down] = last.tiles();
            let (width, height) = ((last.width / 2).max(1), (last.height / 2).max(1));
            levels.push(LevelShape { width, height, first: last.first + across * down });
        }
    }

    /// Columns and rows of the tiles, row by row.
    fn tile_positions(self) -> impl Iterator<Item = (u32, u32)> {
        let [across, down] = self.tiles();
        (0..down).flat_map(move |row| (0..across).map(move |column| (column, row)))
    }

    /// Width and height of the tile in this column and row of tiles.
    fn tile_size(&self, column: u32, row: u32) -> [u32; 2] {
        [(self.width - column * SIDE).min(SIDE), (self.height - row * SIDE).min(SIDE)]
    }
}
