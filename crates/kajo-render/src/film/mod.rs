//! The film: for each pixel the weighted sum of what samples bring, and the sum of their weights.
//!
//! ```text
//! pixel = Σ w(sample - pixel centre) value / Σ w(sample - pixel centre)
//! ```
//!
//! Samples splat: each goes to all pixels that the filter centred on it reaches. The sums are exact
//! integers (see [`fixed`]), so a picture has the same bits for any number of threads, any tiles and
//! any split of its samples into parts.
//!
//! A film is a grid of blocks, each behind a lock of its own and made when the first part reaches it.
//! Threads work far apart, so they hardly ever meet at one.

pub mod filter;
pub mod fixed;
pub mod layer;
mod part;
mod pixels;
pub mod spec;
mod sums;

use std::sync::{
    Mutex, MutexGuard, PoisonError,
    atomic::{AtomicU64, Ordering},
};

pub use filter::Filter;
use kajo_image::Image;
pub use layer::{DepthMap, Layer, LayerSet, NormalMap};
pub use part::FilmPart;
use pixels::Pixels;
pub use spec::{FilmError, FilmSpec, LARGEST_PICTURE};
use sums::Sums;

use crate::rect::{Grid, Rect};

/// Side of a block in pixels.
const BLOCK: u32 = 32;

/// A picture in the making.
#[derive(Debug)]
pub struct Film {
    spec: FilmSpec,
    grid: Grid,
    blocks: Vec<Mutex<Block>>,
    non_finite: AtomicU64,
}

/// What a film knows about one cell of its grid.
#[derive(Debug)]
enum Block {
    /// No sample reached it yet.
    Empty,
    /// More may come.
    Open(Box<Sums>),
    /// Finished; only in films made for one pass.
    Finished(Box<Pixels>),
}

impl Film {
    /// A film without samples.
    ///
    /// * `budget`: bytes it may take when it is full
    ///
    /// # Errors
    /// [`FilmError`] when the picture is empty, too large for the budget or for any film, or when its
    /// filter makes no sense. Nothing is allocated before that is known.
    pub fn new(spec: FilmSpec, budget: u64) -> Result<Film, FilmError> {
        spec.check(budget)?;
        let grid = Grid::new(spec.width, spec.height, BLOCK);
        let mut blocks = Vec::new();
        let count = grid.len() as usize;
        blocks
            .try_reserve_exact(count)
            .map_err(|_| FilmError::OutOfMemory { needed: spec.bytes() as f64 / 1e6 })?;
        blocks.resize_with(count, || Mutex::new(Block::Empty));
        Ok(Film { spec, grid, blocks, non_finite: AtomicU64::new(0) })
    }

    /// What the film holds.
    pub fn spec(&self) -> &FilmSpec {
        &self.spec
    }

    /// Samples so far that had a value that was no finite number; it counted as zero.
    pub fn non_finite(&self) -> u64 {
        self.non_finite.load(Ordering::Relaxed)
    }

    /// Adds a part. The film does not depend on the order in which parts come.
    ///
    /// # Errors
    /// [`FilmError::OtherFilm`] when the part was made for another film, [`FilmError::OnePass`] when this one
    /// was made for one pass.
    pub fn merge(&self, part: &FilmPart) -> Result<(), FilmError> {
        if *part.spec() != self.spec {
            return Err(FilmError::OtherFilm);
        }
        if !self.spec.keeps_sums() {
            return Err(FilmError::OnePass);
        }
        self.add(part);
        Ok(())
    }

    /// Adds a part of this film. In a film made for one pass it must be all that its pixels ever get.
    pub(crate) fn add(&self, part: &FilmPart) {
        self.non_finite.fetch_add(part.non_finite, Ordering::Relaxed);
        let cells = self.grid.cells_over(&part.rect());
        for row in cells.y0..cells.y1 {
            for column in cells.x0..cells.x1 {
                let mut block = self.block(column, row);
                if let Block::Empty = *block {
                    *block = self.new_block(self.grid.cell(column, row));
                }
                match &mut *block {
                    Block::Empty => {}
                    Block::Open(sums) => sums.absorb(&part.sums),
                    Block::Finished(pixels) => pixels.take(&self.spec, &part.sums),
                }
            }
        }
    }

    fn new_block(&self, rect: Rect) -> Block {
        if self.spec.keeps_sums() {
            let mut sums = Sums::empty(&self.spec);
            sums.reset(rect);
            Block::Open(Box::new(sums))
        } else {
            Block::Finished(Box::new(Pixels::new(&self.spec, rect)))
        }
    }

    fn block(&self, column: u32, row: u32) -> MutexGuard<'_, Block> {
        let index = row as usize * self.grid.columns() as usize + column as usize;
        // A block is left whole by whoever panicked with its lock held: the worst is a part half added,
        // and that part is reported as failed.
        self.blocks[index].lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The picture of a layer: `height × width ×` [`Layer::channels`], row 0 on top.
    ///
    /// Pixels that no sample reached are zero, and infinite in [`Layer::Depth`]. Filters with negative
    /// lobes can give negative values. Numbers of objects and materials are exact up to 2^24; see
    /// [`Film::ids`]. `None` when the film does not have the layer or there is no memory for the picture.
    pub fn develop(&self, layer: Layer) -> Option<Image> {
        let n = layer.channels();
        let background = if layer == Layer::Depth { f32::INFINITY } else { 0.0 };
        let mut data = self.plane(layer, n, background)?;
        let width = self.spec.width as usize;
        self.for_each_block(|rect, block| {
            for y in rect.y0..rect.y1 {
                let start = (y as usize * width + rect.x0 as usize) * n;
                let row = &mut data[start..start + rect.width() as usize * n];
                match block {
                    Block::Empty => {}
                    Block::Open(sums) => sums.row(&self.spec, layer, rect.index(rect.x0, y), row),
                    Block::Finished(pixels) => pixels.row(&self.spec, layer, rect.index(rect.x0, y), row),
                }
            }
        });
        Image::from_data(self.spec.width, self.spec.height, n, data).ok()
    }

    /// The numbers of [`Layer::ObjectId`] or [`Layer::MaterialId`], row by row from the top; 0 where there is
    /// nothing. `None` when the film does not have the layer or it is another one, or there is no memory.
    pub fn ids(&self, layer: Layer) -> Option<Vec<u32>> {
        if !matches!(layer, Layer::ObjectId | Layer::MaterialId) {
            return None;
        }
        let mut ids = self.plane(layer, 1, 0)?;
        let width = self.spec.width as usize;
        self.for_each_block(|rect, block| {
            for y in rect.y0..rect.y1 {
                for x in rect.x0..rect.x1 {
                    let pixel = rect.index(x, y);
                    ids[y as usize * width + x as usize] = match block {
                        Block::Empty => 0,
                        Block::Open(sums) => sums.id(layer, pixel),
                        Block::Finished(pixels) => pixels.id(&self.spec, layer, pixel),
                    };
                }
            }
        });
        Some(ids)
    }

    /// A plane of `n` numbers per pixel, if the film has the layer and the system the memory.
    fn plane<T: Clone>(&self, layer: Layer, n: usize, value: T) -> Option<Vec<T>> {
        let len = usize::try_from(self.spec.rect().area()).ok()?.checked_mul(n)?;
        let mut plane = Vec::new();
        plane.try_reserve_exact(if self.spec.layers.has(layer) { len } else { return None }).ok()?;
        plane.resize(len, value);
        Some(plane)
    }

    fn for_each_block(&self, mut visit: impl FnMut(Rect, &Block)) {
        for row in 0..self.grid.rows() {
            for column in 0..self.grid.columns() {
                visit(self.grid.cell(column, row), &self.block(column, row));
            }
        }
    }
}

#[cfg(test)]
mod tests;
