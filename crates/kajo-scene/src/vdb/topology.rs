//! What a tree says before the values of its leaves: tiles, the places of leaves, and the box of active voxels.

use crate::limits::Limits;
use crate::memory_budget::{MemoryShare, OverBudget};
use crate::volume::VolumeError;
use crate::voxels::{BuildError, LEAF_VOXELS, VoxelBuilder, VoxelValue};

/// Logarithms of entries along an axis of a node, and of voxels along that of an entry.
pub const UPPER: [u32; 2] = [5, 7];
pub const LOWER: [u32; 2] = [4, 3];

/// Logarithm of the voxels along an axis of an entry of the root.
pub const ROOT: u32 = 12;

/// A cube of voxels that all have one value.
pub struct Tile<T> {
    pub origin: [i32; 3],
    pub log2_width: u32,
    pub value: T,
}

/// Bits of the entries of a node.
pub struct Mask(pub Vec<u64>);

impl Mask {
    /// Of words of eight bytes, the least first.
    pub fn of_bytes(bytes: &[u8]) -> Mask {
        let word = |b: &[u8]| b.iter().rev().fold(0, |word, &byte| word << 8 | u64::from(byte));
        Mask(bytes.chunks_exact(8).map(word).collect())
    }

    pub fn is_on(&self, index: usize) -> bool {
        self.0[index / 64] >> (index % 64) & 1 != 0
    }

    pub fn count(&self) -> usize {
        self.0.iter().map(|word| word.count_ones() as usize).sum()
    }
}

/// What a tree says before the values of its leaves.
///
/// * `L`: what finds the values of a leaf
pub struct Topology<T, L> {
    pub background: T,
    tiles: Vec<Tile<T>>,
    /// Origins of the leaves, in their order.
    leaves: Vec<([i32; 3], L)>,
    /// The box of active voxels so far.
    low: [i32; 3],
    high: [i32; 3],
    memory: MemoryShare,
}

impl From<BuildError> for VolumeError {
    fn from(error: BuildError) -> VolumeError {
        match error {
            BuildError::Memory(over) => over.into(),
            BuildError::Box(message) => VolumeError::Content(message),
        }
    }
}

/// The first voxel of an entry of a node.
pub fn entry_origin(origin: [i32; 3], [log2_entries, log2_width]: [u32; 2], index: usize) -> [i32; 3] {
    let along = |shift: u32| ((index >> shift & ((1 << log2_entries) - 1)) << log2_width) as i32;
    [origin[0] + along(2 * log2_entries), origin[1] + along(log2_entries), origin[2] + along(0)]
}

impl<T: VoxelValue, L> Topology<T, L> {
    pub fn new(background: T, limits: &Limits) -> Result<Topology<T, L>, OverBudget> {
        Ok(Topology {
            background,
            tiles: Vec::new(),
            leaves: Vec::new(),
            low: [i32::MAX; 3],
            high: [i32::MIN; 3],
            memory: limits.memory.share(0)?,
        })
    }

    /// The voxels, and the indices of the first one of their box.
    ///
    /// * `values`: gives the values of a leaf, one leaf after the other
    pub fn build<'l>(
        self,
        limits: &'l Limits,
        mut values: impl FnMut(L, &mut [T; LEAF_VOXELS]) -> Result<(), VolumeError>,
    ) -> Result<(VoxelBuilder<'l, T>, [i32; 3]), VolumeError> {
        let Topology { background, tiles, leaves, low, high, memory } = self;
        if low[0] > high[0] {
            return Err(VolumeError::Content("the grid has no active voxels".to_owned()));
        }
        let mut builder = VoxelBuilder::new(low, high, background, limits)?;
        for Tile { origin, log2_width, value } in tiles {
            if log2_width > 3 {
                builder.fill(origin, log2_width, value)?;
            } else {
                builder.fill_block(origin, value)?;
            }
        }
        let mut voxels = [T::default(); LEAF_VOXELS];
        for (origin, leaf) in leaves {
            values(leaf, &mut voxels)?;
            builder.leaf(origin, &voxels)?;
        }
        drop(memory);
        Ok((builder, low))
    }

    fn grow(&mut self, low: [i32; 3], high: [i32; 3]) {
        for axis in 0..3 {
            self.low[axis] = self.low[axis].min(low[axis]);
            self.high[axis] = self.high[axis].max(high[axis]);
        }
    }

    pub fn tile(&mut self, tile: Tile<T>, is_active: bool) -> Result<(), OverBudget> {
        if is_active {
            self.grow(tile.origin, tile.origin.map(|x| x + ((1 << tile.log2_width) - 1)));
        } else if tile.value.bits() == self.background.bits() {
            return Ok(());
        }
        push(&mut self.tiles, tile, &mut self.memory)
    }

    pub fn leaf(&mut self, origin: [i32; 3], mask: &Mask, leaf: L) -> Result<(), OverBudget> {
        // A word has the bits of the voxels of one x, eight for each y.
        let (xs, all) = mask
            .0
            .iter()
            .enumerate()
            .filter(|(_, word)| **word != 0)
            .fold((None, 0u64), |(xs, all), (x, word)| {
                (Some((xs.map_or(x, |(first, _)| first), x)), all | word)
            });
        if let Some((first, last)) = xs {
            let rows = (0..8).fold(0u8, |rows, y| rows | u8::from(all >> (8 * y) & 255 != 0) << y);
            let columns = (0..8).fold(0u8, |columns, y| columns | (all >> (8 * y)) as u8);
            let [lowest, highest] = [
                [first as u32, rows.trailing_zeros(), columns.trailing_zeros()],
                [last as u32, 7 - rows.leading_zeros(), 7 - columns.leading_zeros()],
            ];
            let at = |voxel: [u32; 3]| [0, 1, 2].map(|axis| origin[axis] + voxel[axis] as i32);
            self.grow(at(lowest), at(highest));
        }
        push(&mut self.leaves, (origin, leaf), &mut self.memory)
    }
}

fn push<V>(list: &mut Vec<V>, value: V, memory: &mut MemoryShare) -> Result<(), OverBudget> {
    if list.len() == list.capacity() {
        let more = list.len().max(16);
        memory.grow((more * size_of::<V>()) as u64)?;
        list.reserve_exact(more);
    }
    list.push(value);
    Ok(())
}
