//! Equal cells of the box of a file's voxels, to bound what interpolation makes of the voxels in each.

use std::ops::RangeInclusive;

use kajo_math::Aabb;
use kajo_scene::{Block, SparseVoxels, VoxelValue};

/// Voxels that share a cell, along an axis, at least.
const LEAST_BLOCK: u32 = 4;

/// Cells along an axis, at most.
const MOST_CELLS: u32 = 64;

/// Cells along each axis of a box of voxels.
#[derive(Clone, Copy, Debug)]
pub(super) struct VoxelCells {
    voxels: [u32; 3],
    count: [u32; 3],
}

impl VoxelCells {
    /// * `voxels`: along x, y and z, at least one
    pub fn new(voxels: [u32; 3]) -> VoxelCells {
        VoxelCells { voxels, count: voxels.map(|n| n.div_ceil(LEAST_BLOCK).min(MOST_CELLS)) }
    }

    /// Cells along x, y and z.
    pub fn count(&self) -> [u32; 3] {
        self.count
    }

    /// All cells together.
    pub fn len(&self) -> usize {
        self.count.into_iter().product::<u32>() as usize
    }

    /// The place of a cell among all, x first.
    pub fn index(&self, [x, y, z]: [u32; 3]) -> usize {
        ((z * self.count[1] + y) * self.count[0] + x) as usize
    }

    /// The cells in which voxels count, from `low` to before `high` along each axis: a voxel does from the middle of the one before to that of
    /// the one behind.
    fn reached(&self, low: [u32; 3], high: [u32; 3]) -> [RangeInclusive<u32>; 3] {
        [0, 1, 2].map(|axis| {
            let (cells, voxels) = (u64::from(self.count[axis]), u64::from(self.voxels[axis]));
            let cell = |twice: u64| (twice * cells / (2 * voxels)) as u32;
            let first = cell((2 * u64::from(low[axis])).saturating_sub(1));
            first..=cell(2 * u64::from(high[axis]) + 1).min(self.count[axis] - 1)
        })
    }

    /// The cells that a box in the space of the voxels touches; where it is outside of theirs, those nearest to it.
    pub fn touched(&self, region: &Aabb) -> [RangeInclusive<u32>; 3] {
        let (low, high) = (region.min.to_array(), region.max.to_array());
        [0, 1, 2].map(|axis| {
            let last = self.count[axis] - 1;
            let cells_per_voxel = self.count[axis] as f32 / self.voxels[axis] as f32;
            // A number that is none becomes 0, and one that is too large the largest.
            let cell = |x: f32| ((x * cells_per_voxel).floor() as i64).clamp(0, i64::from(last)) as u32;
            // Where rounding might say the one beside, that one counts too.
            let (first, end) = (cell(low[axis] - 1e-3), cell(high[axis] + 1e-3));
            first..=end.max(first)
        })
    }

    /// Folds the numbers of all voxels into the cells in which they count, block by block.
    ///
    /// * `of_value`: what a voxel says; its first argument is its place
    /// * `add`: joins two of these
    pub fn fold<T: VoxelValue, A: Copy>(
        &self,
        voxels: &SparseVoxels<T>,
        start: A,
        mut of_value: impl FnMut([u32; 3], T) -> A,
        add: impl Fn(A, A) -> A,
    ) -> Vec<A> {
        let mut cells = vec![start; self.len()];
        let offset = voxels.offset();
        voxels.for_each_block(|low, high, block| {
            let found = match block {
                Block::Constant(value) => of_value(low, value),
                Block::Leaf(_) => {
                    let mut found = start;
                    for voxel in cells_of([0, 1, 2].map(|axis| low[axis]..=high[axis] - 1)) {
                        let shifted = [0, 1, 2].map(|axis| voxel[axis] + offset[axis]);
                        found = add(found, of_value(voxel, block.at(shifted)));
                    }
                    found
                }
            };
            for cell in cells_of(self.reached(low, high)) {
                let cell = &mut cells[self.index(cell)];
                *cell = add(*cell, found);
            }
        });
        cells
    }
}

/// All places of three ranges, x first.
pub(super) fn cells_of([xs, ys, zs]: [RangeInclusive<u32>; 3]) -> impl Iterator<Item = [u32; 3]> {
    zs.flat_map(move |z| {
        let xs = xs.clone();
        ys.clone().flat_map(move |y| xs.clone().map(move |x| [x, y, z]))
    })
}
