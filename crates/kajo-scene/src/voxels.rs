//! Grids of voxels of which most are empty.
//!
//! ```text
//! nodes      128^3 voxels each, an array over the box      entry: children, or one value for all
//! children    16^3 blocks each                             entry: a leaf, or one value for all
//! leaves       8^3 voxels each                             values
//! ```
//!
//! These are the two lower levels of a tree of OpenVDB [Museth 2013], below an array in place of its upper levels: a look-up is three steps for any
//! voxel, and a box that is nearly empty takes 4 bytes for 128^3 voxels.

use std::collections::BTreeMap;

use crate::limits::Limits;
use crate::memory_budget::{MemoryShare, OverBudget};

/// Numbers of a leaf.
pub(crate) const LEAF_VOXELS: usize = 512;

/// Blocks of a node.
const NODE_BLOCKS: usize = 4096;

/// Nodes along all axes together, at most: a box of 20,000^3 voxels.
const MOST_NODES: u64 = 1 << 22;

/// Marks an entry that is the index of a value.
const CONSTANT: u32 = 1 << 31;

/// What a voxel may hold.
pub trait VoxelValue: Copy + Default + PartialEq + Send + Sync + 'static {
    /// Numbers of a value.
    const CHANNELS: usize;

    /// A value of its numbers; as many as [`VoxelValue::CHANNELS`].
    fn from_numbers(numbers: &[f32]) -> Self;

    /// Its numbers.
    fn numbers(&self) -> &[f32];

    /// What tells values apart.
    fn bits(self) -> [u32; 3];
}

impl VoxelValue for f32 {
    const CHANNELS: usize = 1;

    fn from_numbers(numbers: &[f32]) -> f32 {
        numbers[0]
    }

    fn numbers(&self) -> &[f32] {
        std::slice::from_ref(self)
    }

    fn bits(self) -> [u32; 3] {
        [self.to_bits(), 0, 0]
    }
}

impl VoxelValue for [f32; 3] {
    const CHANNELS: usize = 3;

    fn from_numbers(numbers: &[f32]) -> [f32; 3] {
        [numbers[0], numbers[1], numbers[2]]
    }

    fn numbers(&self) -> &[f32] {
        self
    }

    fn bits(self) -> [u32; 3] {
        self.map(f32::to_bits)
    }
}

/// Voxels of a box, in blocks of 8 x 8 x 8 of which many may be missing.
#[derive(Debug)]
pub struct SparseVoxels<T> {
    size: [u32; 3],
    /// The first voxel of the box, in the voxels of the first node.
    offset: [u32; 3],
    /// Nodes along each axis.
    node_count: [u32; 3],
    /// Of each node the index of its children, or that of a value with [`CONSTANT`]; x first.
    nodes: Vec<u32>,
    /// Of each block the index of its leaf, or that of a value with [`CONSTANT`]; z first.
    children: Vec<[u32; NODE_BLOCKS]>,
    /// z first.
    leaves: Vec<[T; LEAF_VOXELS]>,
    constants: Vec<T>,
}

/// A block of voxels.
#[derive(Clone, Copy, Debug)]
pub enum Block<'a, T> {
    /// The values, the one of (x, y, z) within the block at `64 x + 8 y + z`.
    Leaf(&'a [T; LEAF_VOXELS]),
    /// All the same.
    Constant(T),
}

impl<T: VoxelValue> Block<'_, T> {
    /// The value of a voxel, whose coordinates within the block are the lowest three bits.
    #[inline]
    pub fn at(&self, [x, y, z]: [u32; 3]) -> T {
        match self {
            Block::Leaf(values) => values[((x & 7) << 6 | (y & 7) << 3 | z & 7) as usize],
            Block::Constant(value) => *value,
        }
    }
}

impl<T: VoxelValue> SparseVoxels<T> {
    /// Voxels along x, y and z.
    pub fn size(&self) -> [u32; 3] {
        self.size
    }

    /// The first voxel of the box, counted from the corner of its block.
    #[inline]
    pub fn offset(&self) -> [u32; 3] {
        self.offset
    }

    /// The block of a voxel.
    ///
    /// * `shifted`: coordinates of the voxel within the box, plus [`SparseVoxels::offset`]
    #[inline]
    pub fn block(&self, shifted: [u32; 3]) -> Block<'_, T> {
        let [x, y, z] = shifted;
        let [nx, ny, _] = self.node_count;
        let node = self.nodes[(((z >> 7) * ny + (y >> 7)) * nx + (x >> 7)) as usize];
        if node & CONSTANT != 0 {
            return Block::Constant(self.constants[(node & !CONSTANT) as usize]);
        }
        let entry = self.children[node as usize][child_index(shifted)];
        match entry & CONSTANT {
            0 => Block::Leaf(&self.leaves[entry as usize]),
            _ => Block::Constant(self.constants[(entry & !CONSTANT) as usize]),
        }
    }

    /// The value of a voxel of the box.
    #[inline]
    pub fn at(&self, voxel: [u32; 3]) -> T {
        let shifted = [0, 1, 2].map(|axis| voxel[axis] + self.offset[axis]);
        self.block(shifted).at(shifted)
    }

    /// Shows all parts of the box that are one block, or one value: the first voxel, the one behind the last, and the values.
    pub fn for_each_block(&self, mut show: impl FnMut([u32; 3], [u32; 3], Block<'_, T>)) {
        let mut shown = |corner: [u32; 3], width: u32, block: Block<'_, T>| {
            let end = [0, 1, 2]
                .map(|axis| (corner[axis] + width).saturating_sub(self.offset[axis]).min(self.size[axis]));
            let start = [0, 1, 2].map(|axis| corner[axis].saturating_sub(self.offset[axis]));
            if (0..3).all(|axis| start[axis] < end[axis]) {
                show(start, end, block);
            }
        };
        let [nx, ny, nz] = self.node_count;
        for (index, &node) in self.nodes.iter().enumerate() {
            let index = index as u32;
            debug_assert!(index < nx * ny * nz);
            let corner = [index % nx, index / nx % ny, index / nx / ny].map(|n| n << 7);
            if node & CONSTANT != 0 {
                shown(corner, 128, Block::Constant(self.constants[(node & !CONSTANT) as usize]));
                continue;
            }
            for (child, &entry) in self.children[node as usize].iter().enumerate() {
                let child = child as u32;
                let within = [child >> 8, child >> 4 & 15, child & 15];
                let corner = [0, 1, 2].map(|axis| corner[axis] + (within[axis] << 3));
                let block = match entry & CONSTANT {
                    0 => Block::Leaf(&self.leaves[entry as usize]),
                    _ => Block::Constant(self.constants[(entry & !CONSTANT) as usize]),
                };
                shown(corner, 8, block);
            }
        }
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> u64 {
        (size_of_val(&*self.nodes)
            + size_of_val(&*self.children)
            + size_of_val(&*self.leaves)
            + size_of_val(&*self.constants)) as u64
    }
}

fn child_index([x, y, z]: [u32; 3]) -> usize {
    ((x >> 3 & 15) << 8 | (y >> 3 & 15) << 4 | z >> 3 & 15) as usize
}

/// Why there are no such voxels.
pub(crate) enum BuildError {
    Memory(OverBudget),
    /// What is wrong with the box.
    Box(String),
}

impl From<OverBudget> for BuildError {
    fn from(over: OverBudget) -> BuildError {
        BuildError::Memory(over)
    }
}

/// Makes [`SparseVoxels`] of what a file has, piece by piece.
pub(crate) struct VoxelBuilder<'l, T> {
    made: SparseVoxels<T>,
    /// Indices of the first node, as in the file.
    base: [i64; 3],
    /// Which constant has these bits.
    known: BTreeMap<[u32; 3], u32>,
    memory: MemoryShare,
    limits: &'l Limits,
}

impl<'l, T: VoxelValue> VoxelBuilder<'l, T> {
    /// * `low`, `high`: indices of the first and of the last voxel of the box
    /// * `background`: what voxels are that nothing is said of
    pub fn new(
        low: [i32; 3],
        high: [i32; 3],
        background: T,
        limits: &'l Limits,
    ) -> Result<VoxelBuilder<'l, T>, BuildError> {
        let [low, high] = [low, high].map(|corner| corner.map(i64::from));
        let base = low.map(|x| x & !127);
        let counts = [0, 1, 2].map(|axis| ((high[axis] - base[axis]) >> 7) as u64 + 1);
        let size = [0, 1, 2].map(|axis| (high[axis] - low[axis]) as u64 + 1);
        let total = counts.into_iter().try_fold(1, u64::checked_mul).filter(|&n| n <= MOST_NODES);
        let Some(total) = total else {
            let [x, y, z] = size;
            return Err(BuildError::Box(format!(
                "its active voxels span a box of {x} x {y} x {z}, which is too large"
            )));
        };
        let memory = limits.memory.share(total * size_of::<u32>() as u64)?;
        let made = SparseVoxels {
            size: size.map(|n| n as u32),
            offset: [0, 1, 2].map(|axis| (low[axis] - base[axis]) as u32),
            node_count: counts.map(|n| n as u32),
            nodes: vec![CONSTANT; total as usize],
            children: Vec::new(),
            leaves: Vec::new(),
            constants: vec![background],
        };
        Ok(VoxelBuilder { made, base, known: BTreeMap::from([(background.bits(), 0)]), memory, limits })
    }

    /// The entry of a value.
    fn constant(&mut self, value: T) -> Result<u32, OverBudget> {
        if let Some(&index) = self.known.get(&value.bits()) {
            return Ok(index | CONSTANT);
        }
        let index = self.made.constants.len() as u32;
        room(&mut self.made.constants, &mut self.memory, self.limits)?;
        self.made.constants.push(value);
        self.known.insert(value.bits(), index);
        Ok(index | CONSTANT)
    }

    /// Nodes of the file's indices, as far as they are in the box.
    fn nodes(&self, origin: [i32; 3], log2_width: u32) -> [std::ops::Range<i64>; 3] {
        [0, 1, 2].map(|axis| {
            let first = (i64::from(origin[axis]) - self.base[axis]) >> 7;
            let count = 1i64 << log2_width.saturating_sub(7);
            first.max(0)..(first + count).min(i64::from(self.made.node_count[axis]))
        })
    }

    /// Gives one value to a cube of 128 voxels or more along an axis; those of a file do not overlap.
    pub fn fill(&mut self, origin: [i32; 3], log2_width: u32, value: T) -> Result<(), OverBudget> {
        let entry = self.constant(value)?;
        let [nx, ny, _] = self.made.node_count.map(|n| n as usize);
        let [xs, ys, zs] = self.nodes(origin, log2_width);
        for z in zs {
            for y in ys.clone() {
                for x in xs.clone() {
                    self.made.nodes[(z as usize * ny + y as usize) * nx + x as usize] = entry;
                }
            }
        }
        Ok(())
    }

    /// The entry of a block, if it is in the box.
    fn entry(&mut self, origin: [i32; 3]) -> Result<Option<&mut u32>, OverBudget> {
        let [nx, ny, _] = self.made.node_count.map(|n| n as usize);
        let [Some(x), Some(y), Some(z)] = self.nodes(origin, 3).map(|mut nodes| nodes.next()) else {
            return Ok(None);
        };
        let at = (z as usize * ny + y as usize) * nx + x as usize;
        let mut node = self.made.nodes[at];
        if node & CONSTANT != 0 {
            room(&mut self.made.children, &mut self.memory, self.limits)?;
            self.made.children.push([node; NODE_BLOCKS]);
            node = (self.made.children.len() - 1) as u32;
            self.made.nodes[at] = node;
        }
        let shifted = [0, 1, 2].map(|axis| (i64::from(origin[axis]) - self.base[axis]) as u32);
        Ok(Some(&mut self.made.children[node as usize][child_index(shifted)]))
    }

    /// Gives one value to a block.
    pub fn fill_block(&mut self, origin: [i32; 3], value: T) -> Result<(), OverBudget> {
        let constant = self.constant(value)?;
        if let Some(entry) = self.entry(origin)? {
            *entry = constant;
        }
        Ok(())
    }

    /// Gives a block its values, z first.
    pub fn leaf(&mut self, origin: [i32; 3], values: &[T; LEAF_VOXELS]) -> Result<(), OverBudget> {
        if values.iter().all(|value| value.bits() == values[0].bits()) {
            return self.fill_block(origin, values[0]);
        }
        let index = self.made.leaves.len() as u32;
        let Some(entry) = self.entry(origin)? else { return Ok(()) };
        *entry = index;
        room(&mut self.made.leaves, &mut self.memory, self.limits)?;
        self.made.leaves.push(*values);
        Ok(())
    }

    /// The voxels, and the memory that they take.
    pub fn finish(self) -> (SparseVoxels<T>, MemoryShare) {
        (self.made, self.memory)
    }
}

/// Room for one more, by a quarter, so that little more is held than is needed; what is moved is not counted twice.
fn room<V>(list: &mut Vec<V>, memory: &mut MemoryShare, limits: &Limits) -> Result<(), OverBudget> {
    if list.len() == list.capacity() {
        let more = (list.len() / 4).max(4);
        memory.grow((more * size_of::<V>()) as u64)?;
        let over = |_| limits.memory.exceeded((more * size_of::<V>()) as u64);
        list.try_reserve_exact(more).map_err(over)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn built(low: [i32; 3], high: [i32; 3]) -> VoxelBuilder<'static, f32> {
        static LIMITS: std::sync::LazyLock<Limits> = std::sync::LazyLock::new(Limits::default);
        VoxelBuilder::new(low, high, 0.0, &LIMITS).unwrap_or_else(|_| panic!("a box"))
    }

    #[test]
    fn voxels_are_where_they_were_put() {
        let mut builder = built([-3, 5, 120], [140, 300, 260]);
        builder.fill([0, 128, 128], 7, 2.0).unwrap();
        builder.fill_block([8, 16, 120], 3.0).unwrap();
        let ramp: [f32; LEAF_VOXELS] = std::array::from_fn(|i| i as f32);
        builder.leaf([-8, 0, 120], &ramp).unwrap();
        // Within what has one value, and outside of the box.
        builder.leaf([16, 136, 136], &ramp).unwrap();
        builder.leaf([400, 0, 0], &ramp).unwrap();
        builder.leaf([0, 0, 128], &[7.0; LEAF_VOXELS]).unwrap();
        let (voxels, _) = builder.finish();
        assert_eq!((voxels.size(), voxels.leaves.len()), ([144, 296, 141], 2));
        let at = |x: i32, y: i32, z: i32| voxels.at([(x + 3) as u32, (y - 5) as u32, (z - 120) as u32]);
        assert_eq!(
            [at(0, 128, 128), at(127, 255, 255), at(128, 128, 128), at(8, 16, 127)],
            [2.0, 2.0, 0.0, 3.0]
        );
        assert_eq!([at(-3, 5, 120), at(-1, 7, 127), at(16, 137, 138)], [360.0, 511.0, 10.0]);
        assert_eq!([at(0, 5, 128), at(140, 300, 260), at(24, 136, 136)], [7.0, 0.0, 2.0]);
        let (mut count, mut sum) = (0u64, 0.0);
        voxels.for_each_block(|low, high, block| {
            for x in low[0]..high[0] {
                for y in low[1]..high[1] {
                    for z in low[2]..high[2] {
                        let shifted = [x + voxels.offset[0], y + voxels.offset[1], z + voxels.offset[2]];
                        assert_eq!(block.at(shifted), voxels.at([x, y, z]));
                        count += 1;
                        sum += f64::from(block.at(shifted));
                    }
                }
            }
        });
        assert_eq!(count, 144 * 296 * 141);
        assert!(sum > 2.0 * 128.0 * 128.0 * 128.0);
    }

    #[test]
    fn boxes_without_end_are_refused() {
        let limits = Limits::default();
        let of = |low, high| match VoxelBuilder::<f32>::new(low, high, 0.0, &limits).err() {
            Some(BuildError::Box(message)) => message,
            _ => String::new(),
        };
        assert!(of([i32::MIN; 3], [i32::MAX; 3]).contains("4294967296 x 4294967296"));
        assert!(of([0; 3], [0; 3]).is_empty());
        let flat = built([i32::MIN, 0, 0], [i32::MIN + 1000, 0, 0]).finish().0;
        assert_eq!(flat.at([1000, 0, 0]), 0.0);
    }
}
