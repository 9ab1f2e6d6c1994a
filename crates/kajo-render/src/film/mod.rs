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
//! Light may also come as splats, for any pixel from anywhere; see [`context`](crate::context).
//!
//! A film is a grid of blocks, each behind a lock of its own and made when the first part reaches it.
//! Threads work far apart, so they hardly ever meet at one.

pub mod clamp;
pub mod filter;
pub mod fixed;
pub mod layer;
pub mod noise;
pub(crate) mod numbers;
mod part;
mod pixels;
mod reach;
pub mod spec;
mod splats;
pub mod state;
mod sums;
mod values;

use std::sync::{
    Mutex, MutexGuard, PoisonError,
    atomic::{AtomicU64, Ordering},
};

use clamp::ClampSums;
pub use clamp::ClampedLight;
pub use filter::Filter;
use kajo_image::Image;
pub use layer::{DepthMap, Layer, LayerSet, NormalMap};
pub use part::FilmPart;
use part::{Store, Taps};
use pixels::Pixels;
pub use spec::{FilmError, FilmSpec, LARGEST_PICTURE};
use splats::{Areas, SplatSums};
pub(crate) use sums::Spread;
use sums::Sums;

use fixed::Term;

use crate::{
    ChainCounts,
    context::Splat,
    rect::{Grid, Rect},
};

/// Side of a block in pixels.
const BLOCK: u32 = 32;

/// A picture in the making.
#[derive(Debug)]
pub struct Film {
    spec: FilmSpec,
    grid: Grid,
    blocks: Vec<Mutex<Block>>,
    samples: AtomicU64,
    non_finite: AtomicU64,
    /// Where Markov chains were.
    chains: Mutex<ChainCounts>,
    /// Light above the limit on samples.
    clamped: Mutex<ClampSums>,
}

/// What a film holds of one cell of its grid.
#[derive(Debug, Default)]
struct Block {
    camera: Camera,
    /// Splats, if there were any.
    splats: Option<Box<SplatSums>>,
}

/// What camera rays brought to a block.
#[derive(Debug, Default)]
enum Camera {
    /// No sample reached it yet.
    #[default]
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
        blocks.resize_with(count, Mutex::default);
        let (samples, non_finite) = (AtomicU64::new(0), AtomicU64::new(0));
        let (chains, clamped) = (Mutex::default(), Mutex::default());
        Ok(Film { spec, grid, blocks, samples, non_finite, chains, clamped })
    }

    /// What the film holds.
    pub fn spec(&self) -> &FilmSpec {
        &self.spec
    }

    /// The blocks.
    pub(crate) fn grid(&self) -> Grid {
        self.grid
    }

    /// Samples so far, over all pixels.
    pub fn samples(&self) -> u64 {
        self.samples.load(Ordering::Relaxed)
    }

    /// Samples and splats so far that had a value that was no finite number; it counts as zero.
    pub fn non_finite(&self) -> u64 {
        self.non_finite.load(Ordering::Relaxed)
    }

    /// How far groups of Markov chains are from agreeing; see [`ChainCounts::r_hat`].
    pub fn r_hat(&self) -> Option<f64> {
        self.chains().r_hat()
    }

    /// What the limit on samples has taken away; `None` without one.
    pub fn clamped(&self) -> Option<ClampedLight> {
        self.spec.clamp.map(|limit| self.clamp_sums().light(limit))
    }

    fn clamp_sums(&self) -> MutexGuard<'_, ClampSums> {
        self.clamped.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn chains(&self) -> MutexGuard<'_, ChainCounts> {
        self.chains.lock().unwrap_or_else(PoisonError::into_inner)
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
        self.samples.fetch_add(part.samples, Ordering::Relaxed);
        self.non_finite.fetch_add(part.non_finite, Ordering::Relaxed);
        self.chains().absorb(&part.chains);
        let cells = self.grid.cells_over(&part.rect());
        for row in cells.y0..cells.y1 {
            for column in cells.x0..cells.x1 {
                let mut block = self.block(column, row);
                if let Camera::Empty = block.camera {
                    block.camera = self.new_camera(self.grid.cell(column, row));
                }
                match (&mut block.camera, &part.store) {
                    (Camera::Open(sums), Store::Sums(part)) => sums.absorb(part),
                    (Camera::Finished(pixels), Store::Sums(part)) => pixels.take(&self.spec, part),
                    (Camera::Finished(pixels), Store::Pixels(part)) => pixels.copy(&self.spec, part),
                    // Pixels come only from films that keep no sums.
                    (Camera::Empty, _) | (Camera::Open(_), Store::Pixels(_)) => {}
                }
            }
        }
        let (mut taps, mut clamped) = (Taps::default(), part.clamped);
        part.splats.as_slice().iter().for_each(|splat| self.add_splat(splat, &mut taps, &mut clamped));
        if self.spec.clamp.is_some() {
            self.clamp_sums().absorb(&clamped);
        }
    }

    /// Adds all that another film of the same kind holds, splats too. The sum does not depend on the order in which
    /// films come, nor on how samples were shared out among them.
    ///
    /// # Errors
    /// [`FilmError::OtherFilm`] when the other one differs in kind, [`FilmError::OnePass`] when they keep no sums.
    pub fn absorb(&self, other: Film) -> Result<(), FilmError> {
        if other.spec != self.spec {
            return Err(FilmError::OtherFilm);
        }
        if !self.spec.keeps_sums() {
            return Err(FilmError::OnePass);
        }
        self.samples.fetch_add(other.samples(), Ordering::Relaxed);
        self.non_finite.fetch_add(other.non_finite(), Ordering::Relaxed);
        self.chains().absorb(&other.chains());
        self.clamp_sums().absorb(&other.clamp_sums());
        for (mine, other) in self.blocks.iter().zip(other.blocks) {
            let mut mine = mine.lock().unwrap_or_else(PoisonError::into_inner);
            let other = other.into_inner().unwrap_or_else(PoisonError::into_inner);
            match (&mut mine.camera, other.camera) {
                (Camera::Open(sums), Camera::Open(more)) => sums.absorb(&more),
                (Camera::Empty, camera) => mine.camera = camera,
                // A film that keeps sums has no finished pixels.
                (Camera::Open(_) | Camera::Finished(_), _) => {}
            }
            match (&mut mine.splats, other.splats) {
                (Some(sums), Some(more)) => sums.absorb(&more),
                (None, more) => mine.splats = more,
                (Some(_), None) => {}
            }
        }
        Ok(())
    }

    fn add_splat(&self, splat: &Splat, taps: &mut Taps, clamped: &mut ClampSums) {
        let pixel = part::pixel_at(&self.spec, splat.raster);
        let value = match (self.spec.clamp, pixel) {
            (Some(limit), Some(_)) => clamped.limited(limit, splat.value, [0.0; 3]),
            _ => splat.value,
        };
        let terms = value.map(Term::new);
        if terms.contains(&None) || !splat.raster.is_finite() {
            self.non_finite.fetch_add(1, Ordering::Relaxed);
        }
        let terms = terms.map(|term| term.unwrap_or(Term::ZERO));
        let spreads = self.spec.layers.has(Layer::Variance);
        let to_pixel = |x: u32, y: u32, add: &mut dyn FnMut(&mut SplatSums)| {
            let mut block = self.block(x / BLOCK, y / BLOCK);
            let new = || Box::new(SplatSums::new(self.grid.cell(x / BLOCK, y / BLOCK), spreads));
            add(block.splats.get_or_insert_with(new));
        };
        part::splat(&self.spec, splat.raster, taps, |x, y, weight| {
            to_pixel(x, y, &mut |sums| sums.add(x, y, weight, &terms));
        });
        if let Some([x, y]) = pixel.filter(|_| spreads) {
            to_pixel(x, y, &mut |sums| sums.add_square(x, y, &terms));
        }
    }

    fn samples_per_pixel(&self) -> f64 {
        self.samples() as f64 / self.spec.rect().area() as f64
    }

    fn new_camera(&self, rect: Rect) -> Camera {
        if self.spec.keeps_sums() {
            let mut sums = Sums::empty(&self.spec);
            sums.reset(rect);
            Camera::Open(Box::new(sums))
        } else {
            Camera::Finished(Box::new(Pixels::new(&self.spec, rect)))
        }
    }

    fn block(&self, column: u32, row: u32) -> MutexGuard<'_, Block> {
        let index = row as usize * self.grid.columns() as usize + column as usize;
        // A block is left whole by whoever panicked with its lock held: the worst is a part half added,
        // and that part is reported as failed.
        self.blocks[index].lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The picture of a layer: `height × width ×` [`Layer::channels`] of what is shown, row 0 on top.
    ///
    /// Pixels that no sample reached are zero, and infinite in [`Layer::Depth`]. Filters with negative
    /// lobes can give negative values. Numbers of objects and materials are exact up to 2^24; see
    /// [`Film::ids`]. `None` when the film does not have the layer or there is no memory for the picture.
    pub fn develop(&self, layer: Layer) -> Option<Image> {
        let n = layer.channels();
        let background = if layer == Layer::Depth { f32::INFINITY } else { 0.0 };
        let shown = self.spec.shown();
        let mut data = self.plane(layer, n, background)?;
        let mut areas = None;
        let mut whole_row = vec![background; BLOCK as usize * n];
        self.for_each_block(|rect, block| {
            let common = rect.intersection(&shown);
            if common.width() == 0 {
                return;
            }
            let row = &mut whole_row[..rect.width() as usize * n];
            for y in common.y0..common.y1 {
                row.fill(background);
                self.block_row(block, rect, layer, y, &mut areas, row);
                let from = (common.x0 - rect.x0) as usize * n;
                let to = shown.index(common.x0, y) * n;
                let len = common.width() as usize * n;
                data[to..to + len].copy_from_slice(&row[from..from + len]);
            }
        });
        Image::from_data(shown.width(), shown.height(), n, data).ok()
    }

    /// The value of a layer at one pixel, with zeros for channels that it does not have; `None` outside of the
    /// picture or when the film does not have the layer.
    pub fn value(&self, layer: Layer, x: u32, y: u32) -> Option<[f32; 3]> {
        if !self.spec.layers.has(layer) || x >= self.spec.width || y >= self.spec.height {
            return None;
        }
        let n = layer.channels();
        let (column, row) = (x / BLOCK, y / BLOCK);
        let rect = self.grid.cell(column, row);
        let mut values = [if layer == Layer::Depth { f32::INFINITY } else { 0.0 }; BLOCK as usize * 3];
        let values = &mut values[..rect.width() as usize * n];
        self.block_row(&self.block(column, row), rect, layer, y, &mut None, values);
        let first = (x - rect.x0) as usize * n;
        Some([0, 1, 2].map(|c| if c < n { values[first + c] } else { 0.0 }))
    }

    /// The numbers of [`Layer::ObjectId`] or [`Layer::MaterialId`], row by row from the top; 0 where there is
    /// nothing. `None` when the film does not have the layer or it is another one, or there is no memory.
    pub fn ids(&self, layer: Layer) -> Option<Vec<u32>> {
        if !matches!(layer, Layer::ObjectId | Layer::MaterialId) {
            return None;
        }
        let mut ids = self.plane(layer, 1, 0)?;
        let shown = self.spec.shown();
        self.for_each_block(|rect, block| {
            let common = rect.intersection(&shown);
            for y in common.y0..common.y1 {
                for x in common.x0..common.x1 {
                    let pixel = rect.index(x, y);
                    ids[shown.index(x, y)] = match &block.camera {
                        Camera::Empty => 0,
                        Camera::Open(sums) => sums.id(layer, pixel),
                        Camera::Finished(pixels) => pixels.id(&self.spec, layer, pixel),
                    };
                }
            }
        });
        Some(ids)
    }

    /// Develops the row `y` of a block that covers `rect`. What no sample reached stays as it is.
    fn block_row(
        &self,
        block: &Block,
        rect: Rect,
        layer: Layer,
        y: u32,
        areas: &mut Option<Areas>,
        row: &mut [f32],
    ) {
        match &block.camera {
            Camera::Empty => {}
            Camera::Open(sums) => sums.row(&self.spec, layer, rect.index(rect.x0, y), row),
            Camera::Finished(pixels) => pixels.row(&self.spec, layer, rect.index(rect.x0, y), row),
        }
        match (&block.splats, layer) {
            (Some(splats), Layer::Color) => {
                let areas = areas.get_or_insert_with(|| Areas::new(&self.spec));
                splats.add_to_row(areas, self.samples_per_pixel(), y, row);
            }
            (Some(splats), Layer::Variance) => splats.add_variance_to_row(self.samples_per_pixel(), y, row),
            _ => {}
        }
    }

    /// A plane of `n` numbers per pixel, if the film has the layer and the system the memory.
    fn plane<T: Clone>(&self, layer: Layer, n: usize, value: T) -> Option<Vec<T>> {
        let len = usize::try_from(self.spec.shown().area()).ok()?.checked_mul(n)?;
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
