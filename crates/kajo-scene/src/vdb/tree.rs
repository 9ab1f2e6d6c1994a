//! The tree of a grid: a root, nodes of 32^3 and of 16^3 entries, leaves of 8^3 voxels.

use std::collections::BTreeSet;

use super::codec::{Codec, Room};
use super::input::Input;
use super::topology::{LOWER, Mask, ROOT, Tile, Topology, UPPER, entry_origin};
use crate::limits::Limits;
use crate::memory_budget::MemoryShare;
use crate::volume::VolumeError;
use crate::voxels::{LEAF_VOXELS, SparseVoxels, VoxelValue};

/// How inactive values of a node are known [`openvdb/io/Compression.h`].
mod inactive {
    pub const BACKGROUND: u8 = 0;
    // 1 is the negative of the background.
    pub const ONE: u8 = 2;
    pub const MASK_OF_BACKGROUND: u8 = 3;
    pub const MASK_AND_ONE: u8 = 4;
    pub const MASK_AND_TWO: u8 = 5;
    pub const ALL: u8 = 6;
}

/// Reads a tree; its active voxels, the indices of the first of their box, and the memory.
///
/// * `buffers`: where the leaves are in the file
pub fn read<T: VoxelValue>(
    input: &mut Input,
    codec: Codec,
    buffers: u64,
    limits: &Limits,
) -> Result<(SparseVoxels<T>, [i32; 3], MemoryShare), VolumeError> {
    let mut reader = Reader { input, codec, room: Room::default(), values: Vec::new() };
    let topology = reader.topology(limits)?;
    reader.input.skip_to(buffers)?;
    let background = topology.background;
    let (builder, low) = topology.build(limits, |(), voxels| {
        let mask = reader.mask(LEAF_VOXELS)?;
        reader.node_values(&mask, background)?;
        voxels.copy_from_slice(&reader.values);
        Ok(())
    })?;
    let (voxels, memory) = builder.finish();
    Ok((voxels, low, memory))
}

struct Reader<'i, T> {
    input: &'i mut Input,
    codec: Codec,
    room: Room,
    /// The values of the last node.
    values: Vec<T>,
}

impl<T: VoxelValue> Reader<'_, T> {
    fn mask(&mut self, bits: usize) -> Result<Mask, VolumeError> {
        let mut bytes = [0; 4096];
        let bytes = &mut bytes[..bits / 8];
        self.input.fill(bytes)?;
        Ok(Mask::of_bytes(bytes))
    }

    fn value(&mut self) -> Result<T, VolumeError> {
        self.codec.value(self.input).map(|numbers| T::from_numbers(&numbers))
    }

    fn origin(&mut self) -> Result<[i32; 3], VolumeError> {
        Ok([self.input.i32()?, self.input.i32()?, self.input.i32()?])
    }

    /// The values of a node, as many as its mask has bits.
    fn node_values(&mut self, active: &Mask, background: T) -> Result<(), VolumeError> {
        let len = active.0.len() * 64;
        let flag = self.input.u8()?;
        if flag > inactive::ALL {
            return Err(VolumeError::Content(format!("a node of it has the unknown flag {flag}")));
        }
        let negative = || {
            let mut numbers = [0.0; 3];
            for (number, bits) in numbers.iter_mut().zip(background.bits()) {
                *number = -f32::from_bits(bits);
            }
            T::from_numbers(&numbers)
        };
        let mut of_off = if flag == inactive::BACKGROUND { background } else { negative() };
        let mut of_on = background;
        if [inactive::ONE, inactive::MASK_AND_ONE, inactive::MASK_AND_TWO].contains(&flag) {
            of_off = self.value()?;
            if flag == inactive::MASK_AND_TWO {
                of_on = self.value()?;
            }
        }
        let has_mask =
            [inactive::MASK_OF_BACKGROUND, inactive::MASK_AND_ONE, inactive::MASK_AND_TWO].contains(&flag);
        let chosen = if has_mask { Some(self.mask(len)?) } else { None };
        let leaves_out = self.codec.masks() && flag != inactive::ALL;
        let count = if leaves_out { active.count() } else { len };
        self.codec.values(self.input, count, &mut self.room)?;
        let mut read = self.room.numbers.chunks_exact(T::CHANNELS).map(T::from_numbers);
        self.values.clear();
        if count == len {
            self.values.extend(read);
        } else {
            self.values.extend((0..len).map(|index| match active.is_on(index) {
                true => read.next().unwrap_or_default(),
                false if chosen.as_ref().is_some_and(|chosen| chosen.is_on(index)) => of_on,
                false => of_off,
            }));
        }
        Ok(())
    }

    fn topology(&mut self, limits: &Limits) -> Result<Topology<T, ()>, VolumeError> {
        let buffers = self.input.u32()?;
        if buffers != 1 {
            return Err(VolumeError::Content(format!("its leaves have {buffers} buffers, not one")));
        }
        let background = self.value()?;
        let mut made = Topology::new(background, limits)?;
        let [tiles, children] = [self.input.u32()?, self.input.u32()?];
        let mut known = BTreeSet::new();
        let mut place = |origin: [i32; 3]| match origin.iter().all(|x| x & ((1 << ROOT) - 1) == 0) {
            true if known.insert(origin) => Ok(origin),
            true => Err(VolumeError::Content("two parts of it are at the same place".to_owned())),
            false => Err(VolumeError::Content("a part of it is between the places of nodes".to_owned())),
        };
        for _ in 0..tiles {
            let origin = place(self.origin()?)?;
            let value = self.value()?;
            let is_active = self.input.u8()? != 0;
            made.tile(Tile { origin, log2_width: ROOT, value }, is_active)?;
        }
        for _ in 0..children {
            let origin = place(self.origin()?)?;
            self.upper(origin, &mut made)?;
        }
        Ok(made)
    }

    /// A node of 32^3 entries.
    fn upper(&mut self, origin: [i32; 3], made: &mut Topology<T, ()>) -> Result<(), VolumeError> {
        let children = self.node(origin, UPPER, made)?;
        for index in (0..1 << (3 * UPPER[0])).filter(|&index| children.is_on(index)) {
            let origin = entry_origin(origin, UPPER, index);
            let leaves = self.node(origin, LOWER, made)?;
            for index in (0..1 << (3 * LOWER[0])).filter(|&index| leaves.is_on(index)) {
                let origin = entry_origin(origin, LOWER, index);
                let mask = self.mask(LEAF_VOXELS)?;
                made.leaf(origin, &mask, ())?;
            }
        }
        Ok(())
    }

    /// Masks and tiles of a node; which of its entries are nodes or leaves.
    fn node(
        &mut self,
        origin: [i32; 3],
        shape: [u32; 2],
        made: &mut Topology<T, ()>,
    ) -> Result<Mask, VolumeError> {
        let entries = 1usize << (3 * shape[0]);
        let [children, active] = [self.mask(entries)?, self.mask(entries)?];
        self.node_values(&active, made.background)?;
        for index in (0..entries).filter(|&index| !children.is_on(index)) {
            let origin = entry_origin(origin, shape, index);
            made.tile(Tile { origin, log2_width: shape[1], value: self.values[index] }, active.is_on(index))?;
        }
        Ok(children)
    }
}
