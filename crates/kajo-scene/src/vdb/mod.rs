//! Files of OpenVDB, and of NanoVDB: several grids by name, each a tree of voxels [Museth 2013].
//!
//! ```text
//! " BDV" and 4 zeros, u32 version, u32 library major and minor, u8 has offsets, 36 letters uuid
//! metadata                       u32 count, then each: name, type, u32 bytes, data
//! u32 grids, each:
//!   name, type, parent's name    "Tree_float_5_4_3", "Tree_vec3s_5_4_3_HalfFloat", ...
//!   i64 grid, buffers, end       where they are in the file
//!   u32 compression              1 zip, 2 active mask, 4 blosc
//!   metadata, transform          indices to world
//!   topology                     root, nodes of 32^3 and of 16^3: masks, values of tiles
//!   buffers                      leaves of 8^3, in the order of the topology: mask, values
//! ```
//!
//! Numbers are little end first; names have their length in four bytes. Voxel (i, j, k) has its middle at the point (i,
//! j, k) of index space. There is no specification but the library itself [OpenVDB 10, `openvdb/io`, `openvdb/tree`].
//! Versions 222 (OpenVDB 3.0, 2012) to 225 (OpenVDB 13, 2025, with trees of halves) are read.
//!
//! A file is read from front to back, and nothing is made of a number in it but of the bytes that follow it.

mod blosc;
mod codec;
mod header;
mod input;
mod lz4;
mod map;
mod nano;
#[cfg(test)]
mod tests;
mod topology;
mod tree;
mod zip;

use crate::assets::AssetFile;
use crate::limits::Limits;
use crate::memory_budget::MemoryShare;
use crate::volume::VolumeError;
use crate::voxels::{SparseVoxels, VoxelValue};

pub use map::GridMap;

use codec::Codec;
use header::{GridKind, Header, Stored};
use input::Input;

/// What files of OpenVDB begin with.
const MAGIC: [u8; 8] = *b" BDV\0\0\0\0";

/// A grid of a file, in its box of active voxels.
#[derive(Debug)]
pub struct VoxelGrid<T> {
    /// Its name in the file.
    pub name: String,
    /// Its voxels; what is outside of the box of the active ones is left out.
    pub voxels: SparseVoxels<T>,
    /// From the voxels, of which the first fills the unit cube, to the world.
    pub map: GridMap,
    /// Memory of the voxels, which the holder of this keeps.
    pub memory: MemoryShare,
}

/// A grid of a file by its name and what it holds.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GridEntry {
    /// Its name; empty for one without.
    pub name: String,
    /// Numbers of a voxel; for grids that are not read, why.
    pub channels: Result<usize, String>,
}

/// A kind of file with grids that have names and places.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    OpenVdb,
    NanoVdb,
}

impl Format {
    /// * `head`: the first eight bytes of a file, or more
    fn of(head: &[u8]) -> Option<Format> {
        match head {
            head if head.starts_with(&MAGIC) => Some(Format::OpenVdb),
            head if nano::FILE_MAGICS.iter().any(|magic| head.starts_with(magic)) => Some(Format::NanoVdb),
            _ => None,
        }
    }
}

/// Whether a file begins as those of OpenVDB or NanoVDB do.
///
/// * `head`: its first eight bytes, or more
pub fn is_vdb(head: &[u8]) -> bool {
    Format::of(head).is_some()
}

/// The kind of a file, which is then read from its front.
fn format_of(file: &mut AssetFile) -> Result<Format, VolumeError> {
    let head = file.head(MAGIC.len())?;
    Format::of(&head)
        .ok_or_else(|| VolumeError::Content("this is no file of OpenVDB, nor of NanoVDB".to_owned()))
}

/// The grids of a file, in its order.
///
/// # Errors
/// [`VolumeError`] of the first thing that is malformed or cut off.
pub fn list_vdb(mut file: AssetFile, limits: &Limits) -> Result<Vec<GridEntry>, VolumeError> {
    if format_of(&mut file)? == Format::NanoVdb {
        return nano::list(&mut Input::new(file, limits)?);
    }
    let mut input = Input::new(file, limits)?;
    let header = Header::read(&mut input)?;
    let mut entries = Vec::new();
    for _ in 0..header.grids {
        let grid = header.grid(&mut input)?;
        let channels = match &grid.kind {
            GridKind::Values { channels, .. } => Ok(*channels),
            GridKind::Other(why) => Err(why.clone()),
        };
        entries.push(GridEntry { name: grid.name, channels });
        input.skip_to(grid.end)?;
    }
    Ok(entries)
}

/// Reads the first grid that is wanted.
///
/// * `wanted`: its place in what [`list_vdb`] answers
///
/// # Errors
/// [`VolumeError`] of the first thing that is malformed, cut off, or exceeds a limit.
pub fn read_vdb<T: VoxelValue>(
    mut file: AssetFile,
    wanted: usize,
    limits: &Limits,
) -> Result<VoxelGrid<T>, VolumeError> {
    if format_of(&mut file)? == Format::NanoVdb {
        return nano::read(&mut Input::new(file, limits)?, wanted, limits);
    }
    let mut input = Input::new(file, limits)?;
    let header = Header::read(&mut input)?;
    for index in 0..header.grids as usize {
        let grid = header.grid(&mut input)?;
        if index < wanted {
            input.skip_to(grid.end)?;
            continue;
        }
        let (channels, number) = match grid.kind {
            GridKind::Values { channels, number } => (channels, number),
            GridKind::Other(why) => return Err(VolumeError::Content(why)),
        };
        if channels != T::CHANNELS {
            let message =
                format!("the grid `{}` has {channels} numbers in a voxel, not {}", grid.name, T::CHANNELS);
            return Err(VolumeError::Content(message));
        }
        input.skip_to(grid.start)?;
        let compression = input.u32()?;
        let is_half = header::metadata(&mut input)?;
        let map = map::read(&mut input)?;
        let codec = Codec::new(compression, Stored { channels, number, is_half })?;
        let (voxels, low, memory) = tree::read::<T>(&mut input, codec, grid.buffers, limits)?;
        return Ok(VoxelGrid { name: grid.name, voxels, map: map.counted_from(low), memory });
    }
    Err(VolumeError::Content("there is no such grid".to_owned()))
}
