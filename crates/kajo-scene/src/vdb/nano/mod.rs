//! NanoVDB files: trees of OpenVDB as they lie in memory, without pointers.
//!
//! ```text
//! segment: u64 magic, u32 version, u16 grids, u16 codec        0 none, 1 zip, 2 blosc
//!   of each grid 176 bytes: u64 bytes, u64 bytes in the file, ..., u32 type at 32, u32 length of the name at 136, codec at 168; then the name
//!   each grid: as it is; or u64 length and a stream of zlib; or such pieces of Blosc
//! grid: 672 bytes               the map, in doubles, at 384: a matrix by rows; at 528: what the origin becomes
//! tree: 64 bytes                at 24: where the root is from here
//! root                          24 bytes box, u32 tiles, background, statistics; then tiles: u64 key, i64 child, u32 is active, value
//! nodes of 32^3 and 16^3        32 bytes, mask of active, mask of children, statistics; then entries: value, or i64 child
//! leaves of 8^3                 12 bytes, 3, u8 flags, mask of active, statistics; then voxels
//!   of codes                    f32 least, f32 step, and 8 bytes in place of the statistics; of any width: 2^k bits, k in the upper three of the flags
//! ```
//!
//! Children are told by how many bytes they are behind what has them. Numbers are little end first, and parts begin at multiples of 32 bytes.
//! Grids of the versions 32.x are read that have floats, doubles, three of these, or codes for floats [Museth 2021; OpenVDB 10,
//! `nanovdb/NanoVDB.h`, `nanovdb/util/IO.h`].

mod layout;

use self::layout::{Layout, Voxels};
use super::blosc;
use super::input::Input;
use super::map::GridMap;
use super::topology::{LOWER, Mask, ROOT, Tile, Topology, UPPER, entry_origin};
use super::zip::damaged;
use super::{GridEntry, VoxelGrid};
use crate::limits::Limits;
use crate::memory_budget::MemoryShare;
use crate::volume::VolumeError;
use crate::voxels::{LEAF_VOXELS, VoxelValue};

/// What files begin with.
pub const FILE_MAGICS: [[u8; 8]; 2] = [*b"NanoVDB0", *b"NanoVDB2"];

/// What grids begin with.
const GRID_MAGICS: [[u8; 8]; 2] = [*b"NanoVDB0", *b"NanoVDB1"];

/// Bytes in front of the tree, and where in them the map is.
const GRID: usize = 672;
const MATRIX: usize = 384;
const ORIGIN: usize = 528;

/// Bytes of a leaf in front of its mask, and behind it.
const LEAF_MASK: usize = 16;
const LEAF_STATISTICS: usize = 80;

/// What a file says of a grid.
struct Entry {
    name: String,
    kind: u32,
    bytes: u64,
    bytes_in_file: u64,
    codec: u16,
}

impl Entry {
    fn layout(&self) -> Result<Layout, String> {
        Layout::of(self.kind).map_err(|values| {
            format!(
                "the grid `{}` has voxels of {values}, and what is read has one number or three",
                self.name
            )
        })
    }
}

/// The grids of the next segment; `None` behind the last one.
fn segment(input: &mut Input) -> Result<Option<Vec<Entry>>, VolumeError> {
    if input.is_at_end()? {
        return Ok(None);
    }
    if !FILE_MAGICS.contains(&input.array()?) {
        return Err(VolumeError::Content("a part of it is no NanoVDB".to_owned()));
    }
    let version = input.u32()?;
    if version >> 21 != 32 {
        let message = format!("it has version {} of NanoVDB, and only 32 is read", version >> 21);
        return Err(VolumeError::Content(message));
    }
    let [count, _codec] = [input.u16()?, input.u16()?];
    let entry = |_| -> Result<Entry, VolumeError> {
        let head: [u8; 176] = input.array()?;
        let whole = |at: usize| u64_at(&head, at);
        let (Some(bytes), Some(bytes_in_file)) = (whole(0), whole(8)) else { return Err(damaged()) };
        let (Some(kind), Some(length)) = (u32_at(&head, 32), u32_at(&head, 136)) else {
            return Err(damaged());
        };
        let name = input.text_of(length)?;
        let name = name.split('\0').next().unwrap_or_default().to_owned();
        Ok(Entry { name, kind, bytes, bytes_in_file, codec: u16::from_le_bytes([head[168], head[169]]) })
    };
    (0..count).map(entry).collect::<Result<_, _>>().map(Some)
}

/// The grids of a file.
pub fn list(input: &mut Input) -> Result<Vec<GridEntry>, VolumeError> {
    let mut entries = Vec::new();
    while let Some(segment) = segment(input)? {
        for entry in &segment {
            let channels = entry.layout().map(|layout| layout.channels);
            entries.push(GridEntry { channels, name: entry.name.clone() });
        }
        for entry in segment {
            input.skip(entry.bytes_in_file)?;
        }
    }
    Ok(entries)
}

/// Reads a grid.
///
/// * `wanted`: its place in the file
pub fn read<T: VoxelValue>(
    input: &mut Input,
    mut wanted: usize,
    limits: &Limits,
) -> Result<VoxelGrid<T>, VolumeError> {
    while let Some(segment) = segment(input)? {
        for entry in segment {
            if wanted > 0 {
                wanted -= 1;
                input.skip(entry.bytes_in_file)?;
                continue;
            }
            let layout = entry.layout().map_err(VolumeError::Content)?;
            if layout.channels != T::CHANNELS {
                let message = format!(
                    "the grid `{}` has {} numbers in a voxel, not {}",
                    entry.name,
                    layout.channels,
                    T::CHANNELS
                );
                return Err(VolumeError::Content(message));
            }
            let (bytes, held) = unpacked(input, &entry, limits)?;
            let (voxels, map, memory) = grid(&Data { bytes: &bytes, layout }, limits)?;
            drop(held);
            return Ok(VoxelGrid { name: entry.name, voxels, map, memory });
        }
    }
    Err(VolumeError::Content("there is no such grid".to_owned()))
}

/// The bytes of a grid, and their memory.
fn unpacked(
    input: &mut Input,
    entry: &Entry,
    limits: &Limits,
) -> Result<(Vec<u8>, MemoryShare), VolumeError> {
    /// How many times as long a stream may become.
    const MOST: u64 = 1100;
    let mut held = limits.memory.share(0)?;
    let Entry { bytes, codec, .. } = *entry;
    match codec {
        0 => return Ok((input.bytes(bytes, &mut held)?, held)),
        1 => {
            let packed = input.u64()?;
            let packed = input.bytes(packed, &mut held)?;
            if bytes > MOST * packed.len() as u64 + 1024 {
                return Err(damaged());
            }
            held.grow(bytes)?;
            let out = miniz_oxide::inflate::decompress_to_vec_zlib_with_limit(&packed, bytes as usize);
            let out = out.ok().filter(|out| out.len() as u64 == bytes).ok_or_else(damaged)?;
            return Ok((out, held));
        }
        2 => {}
        _ => return Err(VolumeError::Content(format!("its codec {codec} is not known"))),
    }
    let mut out = Vec::new();
    while (out.len() as u64) < bytes {
        let packed = input.u64()?;
        let packed = input.bytes(packed, &mut held)?;
        let length = u64::from(u32_at(&packed, 4).ok_or_else(damaged)?);
        if length == 0 || length > MOST * packed.len() as u64 + 1024 || length > bytes - out.len() as u64 {
            return Err(damaged());
        }
        held.grow(length)?;
        let start = out.len();
        out.resize(start + length as usize, 0);
        blosc::unpack(&packed, &mut out[start..])?;
    }
    Ok((out, held))
}

/// The bytes of a grid.
struct Data<'a> {
    bytes: &'a [u8],
    layout: Layout,
}

fn u32_at(bytes: &[u8], at: usize) -> Option<u32> {
    bytes.get(at..at.checked_add(4)?)?.try_into().ok().map(u32::from_le_bytes)
}

fn u64_at(bytes: &[u8], at: usize) -> Option<u64> {
    bytes.get(at..at.checked_add(8)?)?.try_into().ok().map(u64::from_le_bytes)
}

fn outside() -> VolumeError {
    VolumeError::Content("a part of the grid is outside of it".to_owned())
}

impl Data<'_> {
    fn slice(&self, at: usize, len: usize) -> Result<&[u8], VolumeError> {
        at.checked_add(len).and_then(|end| self.bytes.get(at..end)).ok_or_else(outside)
    }

    fn u32(&self, at: usize) -> Result<u32, VolumeError> {
        u32_at(self.bytes, at).ok_or_else(outside)
    }

    fn u64(&self, at: usize) -> Result<u64, VolumeError> {
        u64_at(self.bytes, at).ok_or_else(outside)
    }

    fn f64(&self, at: usize) -> Result<f64, VolumeError> {
        self.u64(at).map(f64::from_bits)
    }

    /// The place that a number at `at` says how far it is from `from`.
    fn child(&self, from: usize, at: usize) -> Result<usize, VolumeError> {
        let distance = self.u64(at)?.cast_signed();
        usize::try_from(distance).ok().and_then(|distance| from.checked_add(distance)).ok_or_else(outside)
    }

    /// The value at a place.
    fn value<T: VoxelValue>(&self, at: usize) -> Result<T, VolumeError> {
        self.slice(at, self.layout.value()).map(|bytes| self.layout.decode(bytes))
    }

    /// The masks of a node, of what is active and of children; and where its entries are.
    fn node(&self, at: usize, shape: [u32; 2]) -> Result<([Mask; 2], usize), VolumeError> {
        let mask = (1usize << (3 * shape[0])) / 8;
        let first = at.checked_add(32).ok_or_else(outside)?;
        let masks =
            [Mask::of_bytes(self.slice(first, mask)?), Mask::of_bytes(self.slice(first + mask, mask)?)];
        Ok((masks, at + self.layout.node_head(mask)))
    }

    /// Where the voxels of a leaf are, and how many bytes they take.
    fn leaf_voxels(&self, leaf: usize) -> Result<(usize, usize), VolumeError> {
        let start = leaf.checked_add(self.layout.leaf_head()).ok_or_else(outside)?;
        let bytes = match self.layout.voxels {
            Voxels::Plain => self.layout.value() * LEAF_VOXELS,
            codes => (LEAF_VOXELS << self.log2_bits(leaf, codes)?) / 8,
        };
        Ok((start, bytes))
    }

    /// The logarithm of the bits of each code of a leaf.
    fn log2_bits(&self, leaf: usize, codes: Voxels) -> Result<u32, VolumeError> {
        match codes {
            Voxels::Codes(bits) => Ok(bits),
            _ => match self.u32(leaf + 12)? >> 29 {
                bits @ 0..=4 => Ok(bits),
                bits => Err(VolumeError::Content(format!("a leaf of it has codes of {} bits", 1u32 << bits))),
            },
        }
    }

    /// Reads the voxels of a leaf.
    fn leaf<T: VoxelValue>(&self, leaf: usize, voxels: &mut [T]) -> Result<(), VolumeError> {
        let (start, len) = self.leaf_voxels(leaf)?;
        let bytes = self.slice(start, len)?;
        if self.layout.voxels == Voxels::Plain {
            for (voxel, bytes) in voxels.iter_mut().zip(bytes.chunks_exact(self.layout.value())) {
                *voxel = self.layout.decode(bytes);
            }
            return Ok(());
        }
        let log2_bits = self.log2_bits(leaf, self.layout.voxels)?;
        let [least, step] =
            [self.u32(leaf + LEAF_STATISTICS)?, self.u32(leaf + LEAF_STATISTICS + 4)?].map(f32::from_bits);
        for (index, voxel) in voxels.iter_mut().enumerate() {
            *voxel = T::from_numbers(&[code(bytes, log2_bits, index) as f32 * step + least]);
        }
        Ok(())
    }
}

/// One of many codes of `2^log2_bits` bits, 16 at most; the first ones are the lowest of each byte.
fn code(bytes: &[u8], log2_bits: u32, index: usize) -> u16 {
    let bit = index << log2_bits;
    match log2_bits {
        4 => u16::from_le_bytes([bytes[bit / 8], bytes[bit / 8 + 1]]),
        3 => u16::from(bytes[bit / 8]),
        _ => u16::from(bytes[bit / 8]) >> (bit % 8) & ((1 << (1 << log2_bits)) - 1),
    }
}

/// Nodes that may still be met: more than fit into a grid are met only where some are met twice.
struct Left(usize);

impl Left {
    fn take(&mut self, bytes: usize) -> Result<(), VolumeError> {
        self.0 = self
            .0
            .checked_sub(bytes)
            .ok_or_else(|| VolumeError::Content("parts of the grid overlap".to_owned()))?;
        Ok(())
    }
}

fn grid<T: VoxelValue>(
    data: &Data<'_>,
    limits: &Limits,
) -> Result<(crate::voxels::SparseVoxels<T>, GridMap, MemoryShare), VolumeError> {
    if !GRID_MAGICS.iter().any(|magic| data.bytes.starts_with(magic)) {
        return Err(VolumeError::Content("a part of it is no grid of NanoVDB".to_owned()));
    }
    let mut map = GridMap { axes: [[0.0; 3]; 3], origin: [0.0; 3] };
    for row in 0..3 {
        for axis in 0..3 {
            map.axes[axis][row] = data.f64(MATRIX + 8 * (3 * row + axis))?;
        }
        map.origin[row] = data.f64(ORIGIN + 8 * row)?;
    }
    map.check()?;
    let root = data.child(GRID, GRID + 24)?;
    let tiles = data.u32(root.checked_add(24).ok_or_else(outside)?)? as usize;
    let layout = data.layout;
    let background = data.value::<T>(root + layout.background())?;
    let mut made = Topology::new(background, limits)?;
    let mut left = Left(data.bytes.len());
    let mut known = std::collections::BTreeSet::new();
    for tile in 0..tiles {
        left.take(layout.root_tile())?;
        let at = root + layout.root_head() + layout.root_tile() * tile;
        let key = data.u64(at)?;
        // 21 bits for each axis, x first.
        let origin = [42, 21, 0].map(|shift| ((key >> shift & 0x1f_ffff) << ROOT) as u32 as i32);
        if !known.insert(origin) {
            return Err(VolumeError::Content("two parts of it are at the same place".to_owned()));
        }
        if data.u64(at + 8)? == 0 {
            let tile = Tile { origin, log2_width: ROOT, value: data.value(at + layout.tile_value())? };
            made.tile(tile, data.u32(at + 16)? != 0)?;
            continue;
        }
        upper(data, data.child(root, at + 8)?, origin, &mut made, &mut left)?;
    }
    let (builder, low) = made.build(limits, |leaf: usize, voxels| data.leaf(leaf, voxels))?;
    let (voxels, memory) = builder.finish();
    Ok((voxels, map.counted_from(low), memory))
}

/// A node of 32^3 entries.
fn upper<T: VoxelValue>(
    data: &Data<'_>,
    at: usize,
    origin: [i32; 3],
    made: &mut Topology<T, usize>,
    left: &mut Left,
) -> Result<(), VolumeError> {
    let mut nodes = Vec::new();
    entries(data, at, origin, UPPER, made, left, &mut nodes)?;
    let mut leaves = Vec::new();
    for (origin, at) in nodes {
        leaves.clear();
        entries(data, at, origin, LOWER, made, left, &mut leaves)?;
        for &(origin, at) in &leaves {
            let (start, len) = data.leaf_voxels(at)?;
            left.take(start - at + len)?;
            let mask = Mask::of_bytes(data.slice(at + LEAF_MASK, LEAF_VOXELS / 8)?);
            made.leaf(origin, &mask, at)?;
        }
    }
    Ok(())
}

/// The tiles of a node; its children are added to a list.
fn entries<T: VoxelValue>(
    data: &Data<'_>,
    at: usize,
    origin: [i32; 3],
    shape: [u32; 2],
    made: &mut Topology<T, usize>,
    left: &mut Left,
    children: &mut Vec<([i32; 3], usize)>,
) -> Result<(), VolumeError> {
    let ([active, has_child], table) = data.node(at, shape)?;
    let count = 1usize << (3 * shape[0]);
    let width = data.layout.entry();
    left.take(width * count)?;
    data.slice(table, width * count)?;
    for index in 0..count {
        let place = entry_origin(origin, shape, index);
        let entry = table + width * index;
        if has_child.is_on(index) {
            children.push((place, data.child(at, entry)?));
        } else {
            made.tile(
                Tile { origin: place, log2_width: shape[1], value: data.value(entry)? },
                active.is_on(index),
            )?;
        }
    }
    Ok(())
}
