//! Least and greatest height of blocks of cells.

use super::HeightGrid;

/// Bounds of square blocks of cells, in levels: those of the first have two cells a side, those of each next one twice as many,
/// up to a single block.
#[derive(Debug)]
pub(super) struct HeightBounds {
    levels: Vec<Level>,
}

#[derive(Debug)]
struct Level {
    columns: u32,
    /// Least and greatest, row by row.
    bounds: Vec<[f32; 2]>,
}

impl HeightBounds {
    /// Those of a grid of two points or more a side.
    pub fn new(grid: &HeightGrid) -> HeightBounds {
        let mut levels: Vec<Level> = Vec::new();
        for [columns, rows] in sizes(grid.cells()) {
            let below = levels.last();
            let mut bounds = Vec::with_capacity(columns as usize * rows as usize);
            for row in 0..rows {
                bounds.extend((0..columns).map(|column| match below {
                    Some(below) => below.block(2 * column, 2 * row),
                    None => points(grid, 2 * column, 2 * row),
                }));
            }
            levels.push(Level { columns, bounds });
        }
        HeightBounds { levels }
    }

    /// Bytes that they take for so many points.
    pub fn bytes(columns: u32, rows: u32) -> u64 {
        let blocks = |[columns, rows]: [u32; 2]| u64::from(columns) * u64::from(rows);
        sizes([columns - 1, rows - 1]).map(blocks).sum::<u64>() * size_of::<[f32; 2]>() as u64
    }

    /// Of the whole grid.
    pub fn all(&self) -> [f32; 2] {
        self.levels[self.levels.len() - 1].bounds[0]
    }

    /// The level of the block that holds all; single cells have level 0.
    pub fn top(&self) -> u32 {
        self.levels.len() as u32
    }

    /// Of a block of `2^level` cells a side, `level` above 0.
    #[inline]
    pub fn block(&self, level: u32, [column, row]: [u32; 2]) -> [f32; 2] {
        let level = &self.levels[level as usize - 1];
        level.bounds[row as usize * level.columns as usize + column as usize]
    }
}

impl Level {
    /// Of four neighbouring blocks, or of fewer at the border.
    fn block(&self, column: u32, row: u32) -> [f32; 2] {
        let rows = self.bounds.chunks_exact(self.columns as usize).skip(row as usize).take(2);
        rows.flat_map(|blocks| blocks.iter().skip(column as usize).take(2)).copied().fold(NONE, union)
    }
}

/// Blocks along x and z of all levels.
fn sizes([columns, rows]: [u32; 2]) -> impl Iterator<Item = [u32; 2]> {
    let half = |size: &[u32; 2]| (size.iter().any(|&n| n > 1)).then(|| size.map(|n| n.div_ceil(2)));
    std::iter::successors(Some([columns.div_ceil(2), rows.div_ceil(2)]), half)
}

/// The bounds of nothing.
const NONE: [f32; 2] = [f32::INFINITY, f32::NEG_INFINITY];

fn union(a: [f32; 2], b: [f32; 2]) -> [f32; 2] {
    [a[0].min(b[0]), a[1].max(b[1])]
}

/// Of the corners of four cells, or of fewer at the border.
fn points(grid: &HeightGrid, column: u32, row: u32) -> [f32; 2] {
    let columns = column..=(column + 2).min(grid.columns - 1);
    let rows = row..=(row + 2).min(grid.rows - 1);
    let heights = rows.flat_map(|row| columns.clone().map(move |column| grid.at(column, row)));
    heights.fold(NONE, |bounds, h| union(bounds, [h, h]))
}
