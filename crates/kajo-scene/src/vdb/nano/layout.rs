//! Where the values of a grid of NanoVDB lie, by their kind.

use crate::voxels::VoxelValue;

/// How the voxels of leaves are saved; tiles are always numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Voxels {
    /// As numbers.
    Plain,
    /// One number each as the step of a scale that each leaf has, in `2^k` bits.
    Codes(u32),
    /// The same, where each leaf says its `k`.
    CodesByLeaf,
}

/// The values of a grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layout {
    /// Numbers of a value.
    pub channels: usize,
    /// Bytes of a number, of floats or doubles.
    pub scalar: usize,
    pub voxels: Voxels,
}

impl Layout {
    /// The layout of a kind of grid [`nanovdb::GridType`]; for those that are not read, what they hold.
    pub fn of(kind: u32) -> Result<Layout, &'static str> {
        let plain = |channels, scalar| Layout { channels, scalar, voxels: Voxels::Plain };
        let codes = |voxels| Layout { voxels, ..plain(1, 4) };
        Ok(match kind {
            1 => plain(1, 4),
            2 => plain(1, 8),
            6 => plain(3, 4),
            7 => plain(3, 8),
            13 => codes(Voxels::Codes(2)),
            14 => codes(Voxels::Codes(3)),
            15 => codes(Voxels::Codes(4)),
            16 => codes(Voxels::CodesByLeaf),
            3..=5 | 10 => return Err("whole numbers"),
            8 => return Err("no values"),
            17 | 18 => return Err("four numbers"),
            _ => return Err("another kind"),
        })
    }

    /// Bytes of a value.
    pub fn value(self) -> usize {
        self.channels * self.scalar
    }

    /// A value of its bytes.
    pub fn decode<T: VoxelValue>(self, bytes: &[u8]) -> T {
        let mut numbers = [0.0; 3];
        if self.scalar == 4 {
            let floats = bytes.as_chunks().0.iter().map(|bytes| f32::from_le_bytes(*bytes));
            numbers.iter_mut().zip(floats).for_each(|(number, value)| *number = value);
        } else {
            let doubles = bytes.as_chunks().0.iter().map(|bytes| f64::from_le_bytes(*bytes));
            numbers.iter_mut().zip(doubles).for_each(|(number, value)| *number = value as f32);
        }
        T::from_numbers(&numbers[..T::CHANNELS])
    }

    /// Where a root has its background, behind a box and the number of tiles.
    pub fn background(self) -> usize {
        28_usize.next_multiple_of(self.scalar)
    }

    /// Bytes of a root in front of its tiles: the background, the least and the largest value, the mean and the deviation.
    pub fn root_head(self) -> usize {
        (self.background() + 3 * self.value() + 2 * self.scalar).next_multiple_of(32)
    }

    /// Where a tile of a root has its value, behind the key, the child and whether it is active.
    pub fn tile_value(self) -> usize {
        20_usize.next_multiple_of(self.scalar)
    }

    /// Bytes of a tile of a root.
    pub fn root_tile(self) -> usize {
        (self.tile_value() + self.value()).next_multiple_of(32)
    }

    /// Bytes of what a node says of its values.
    fn statistics(self) -> usize {
        2 * self.value() + 2 * self.scalar
    }

    /// Bytes of a node in front of its entries.
    ///
    /// * `mask`: bytes of each of its two masks
    pub fn node_head(self, mask: usize) -> usize {
        (32 + 2 * mask + self.statistics()).next_multiple_of(32)
    }

    /// Bytes of an entry of a node, a value or a child.
    pub fn entry(self) -> usize {
        self.value().next_multiple_of(8)
    }

    /// Bytes of a leaf in front of its voxels.
    pub fn leaf_head(self) -> usize {
        // With codes there are the least value and the step, and statistics of two bytes each.
        (80 + self.statistics()).next_multiple_of(32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sizes of the library's structures, printed by a program with its headers (OpenVDB 10).
    #[test]
    fn sizes_are_those_of_the_library() {
        let of = |kind: u32| {
            let layout = Layout::of(kind).unwrap();
            let nodes = [4096, 512].map(|mask| layout.node_head(mask));
            (layout.root_head(), layout.root_tile(), nodes, layout.entry(), layout.leaf_head())
        };
        assert_eq!(of(1), (64, 32, [8256, 1088], 8, 96));
        assert_eq!(of(2), (96, 32, [8256, 1088], 8, 128));
        assert_eq!(of(6), (96, 32, [8256, 1088], 16, 128));
        assert_eq!(of(7), (128, 64, [8288, 1120], 24, 160));
        for kind in 13..=16 {
            assert_eq!(of(kind), of(1));
        }
        assert_eq!(Layout::of(8), Err("no values"));
    }
}
