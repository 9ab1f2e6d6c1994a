//! Splatting: samples go to every pixel their filter reaches.
//!
//! A sample at offset `(x, y)` from the corner of its pixel counts for the pixel `(i, j)` further on
//! when `(x - ½ - i, y - ½ - j)` lies in the filter's support, with the filter's weight there. A part
//! therefore covers the pixels samples are taken for and a border as wide as the filter reaches.

use kajo_core::sampler::Sampler;
use kajo_math::Vec2;

use super::{
    clamp::ClampSums,
    fixed::{Term, Weight},
    pixels::Pixels,
    reach::Reach,
    spec::FilmSpec,
    sums::Sums,
    values::{MAX_CHANNELS, filtered_values},
};
use crate::{Auxiliary, ChainCounts, PixelSample, context::Splats, rect::Rect};

/// What some samples bring to a rectangle of a film, and their splats to all of it. Parts add up exactly, in any
/// order.
#[derive(Clone, Debug)]
pub struct FilmPart {
    spec: FilmSpec,
    reach: Option<Reach>,
    pub(crate) store: Store,
    /// Light for other positions.
    pub(crate) splats: Splats,
    /// Where Markov chains were.
    pub(crate) chains: ChainCounts,
    /// Light above the limit on samples.
    pub(crate) clamped: ClampSums,
    /// Samples taken.
    pub(crate) samples: u64,
    /// Samples with values that were not finite numbers.
    pub(crate) non_finite: u64,
    /// The sample at hand: its values for filtered layers, and the weights of the pixels it reaches.
    values: [f32; MAX_CHANNELS],
    terms: Vec<Term>,
    taps: Taps,
}

/// What a part consists of.
#[derive(Clone, Debug)]
pub(crate) enum Store {
    /// Sums, since more is to come.
    Sums(Sums),
    /// Finished pixels: their only sample is all that they ever get.
    Pixels(Pixels),
}

impl FilmPart {
    /// A part for no pixels yet; see [`FilmPart::reset`].
    pub fn new(spec: &FilmSpec, sampler: &Sampler) -> FilmPart {
        let single = !spec.keeps_sums() && sampler.samples() == 1;
        FilmPart {
            spec: *spec,
            reach: spec.filter.radius().map(|radius| Reach::new(radius, sampler)),
            store: if single { Store::Pixels(Pixels::empty()) } else { Store::Sums(Sums::empty(spec)) },
            splats: Splats::default(),
            chains: ChainCounts::default(),
            clamped: ClampSums::default(),
            samples: 0,
            non_finite: 0,
            values: [0.0; MAX_CHANNELS],
            terms: Vec::with_capacity(MAX_CHANNELS),
            taps: Taps::default(),
        }
    }

    /// Empties the part and makes it ready for samples of the pixels of `tile`; keeps its memory.
    pub fn reset(&mut self, tile: &Rect) {
        let reach = self.reach.unwrap_or(Reach { side: 0, below: 0 });
        let (side, below) = (reach.side as u32, reach.below as u32);
        let bordered = Rect {
            x0: tile.x0.saturating_sub(side),
            y0: tile.y0.saturating_sub(side),
            x1: tile.x1.saturating_add(side),
            y1: tile.y1.saturating_add(below),
        };
        let rect = bordered.intersection(&self.spec.rect());
        match &mut self.store {
            Store::Sums(sums) => sums.reset(rect),
            Store::Pixels(pixels) => pixels.reset(&self.spec, rect),
        }
        self.splats.clear();
        self.chains.clear();
        self.clamped = ClampSums::default();
        self.samples = 0;
        self.non_finite = 0;
    }

    /// The pixels that the part holds: those of the tile and the border that its samples reach.
    pub fn rect(&self) -> Rect {
        match &self.store {
            Store::Sums(sums) => sums.rect,
            Store::Pixels(pixels) => pixels.rect,
        }
    }

    /// What film the part is for.
    pub fn spec(&self) -> &FilmSpec {
        &self.spec
    }

    /// Adds sample `k` of pixel `(x, y)`, which lies in the tile.
    ///
    /// * `offset`: position of the sample relative to the pixel's top left corner, as its sampler gave it
    ///
    /// * `aux`: values for layers that have them from there
    ///
    /// A value that is no finite number counts as zero, and the sample is counted as such.
    #[inline]
    pub fn add(&mut self, x: u32, y: u32, k: u32, offset: Vec2, sample: &PixelSample, aux: &Auxiliary) {
        match self.spec.clamp {
            None => self.add_whole([x, y], k, offset, sample, aux),
            Some(limit) => {
                let (sample, aux) = self.clamped.limit_sample(limit, sample, aux);
                self.add_whole([x, y], k, offset, &sample, &aux);
            }
        }
    }

    /// Adds a sample with all of its light.
    #[inline]
    fn add_whole(&mut self, [x, y]: [u32; 2], k: u32, offset: Vec2, sample: &PixelSample, aux: &Auxiliary) {
        let n = filtered_values(&self.spec, sample, aux, &mut self.values);
        let values = &self.values[..n];
        let finite = match (&mut self.store, self.reach) {
            (Store::Pixels(pixels), _) => pixels.put(&self.spec, pixels.rect.index(x, y), values, sample),
            (Store::Sums(sums), None) => {
                let own = sums.slot(x, y, k);
                sums.add_plain(own, values) & sums.add_own(own, k, sample)
            }
            (Store::Sums(sums), Some(reach)) => {
                let own = sums.slot(x, y, k);
                let finite = sums.add_own(own, k, sample);
                self.terms.clear();
                self.terms.extend(values.iter().map(|&v| Term::new(v).unwrap_or(Term::ZERO)));
                self.taps.surround(&self.spec, [x, y], offset, reach);
                for (j, y) in self.taps.rows() {
                    let row = sums.slot(self.taps.first[0], y, k);
                    for (weight, slot) in
                        self.taps.weights(&self.spec.filter, j).zip((row..).step_by(sums.stride()))
                    {
                        sums.add_filtered(slot, weight, &self.terms);
                    }
                }
                finite & values.iter().all(|v| v.is_finite())
            }
        };
        self.samples += 1;
        self.non_finite += u64::from(!finite);
    }

    /// Takes over the splats of the part's samples, and leaves none behind.
    pub fn take_splats(&mut self, splats: &mut Splats) {
        std::mem::swap(&mut self.splats, splats);
        splats.clear();
    }

    /// Takes over what the chains of the part's samples have counted, and leaves nothing behind.
    pub fn take_chains(&mut self, chains: &mut ChainCounts) {
        std::mem::swap(&mut self.chains, chains);
        chains.clear();
    }
}

/// The pixels in the support of a filter around a position, and their weights.
#[derive(Clone, Debug, Default)]
pub(crate) struct Taps {
    /// Column and row of the first pixel.
    first: [u32; 2],
    columns: Vec<f32>,
    /// None when there are no columns: then the first pixel need not even be in the film.
    rows: Vec<f32>,
    /// From the middle of the first pixel to the position.
    from_first: Vec2,
}

impl Taps {
    /// Rows in the support, counted there and in the film.
    #[inline]
    fn rows(&self) -> impl Iterator<Item = (usize, u32)> {
        (self.first[1]..).take(self.rows.len()).enumerate()
    }

    /// Weights of the pixels of one row, from the first column in the support on.
    #[inline]
    fn weights(&self, filter: &super::Filter, row: usize) -> impl Iterator<Item = Weight> {
        let is_separable = filter.is_separable();
        let (own, y) = (self.rows[row], self.from_first.y - row as f32);
        self.columns.iter().enumerate().map(move |(i, &column)| {
            let weight =
                if is_separable { column * own } else { filter.weight(self.from_first.x - i as f32, y) };
            Weight::new(weight)
        })
    }

    /// Finds the pixels around a position.
    ///
    /// * `own`: the pixel whose cell they are confined to
    /// * `offset`: the position relative to the top left corner of that pixel
    fn surround(&mut self, spec: &FilmSpec, own: [u32; 2], offset: Vec2, reach: Reach) {
        let cell = spec.cell_around(own[0], own[1]);
        let filter = &spec.filter;
        let (across, down) = ((reach.side, reach.side), (reach.side, reach.below));
        let x0 = taps(filter, offset.x, own[0], (cell.x0, cell.x1), across, &mut self.columns);
        let y0 = taps(filter, offset.y, own[1], (cell.y0, cell.y1), down, &mut self.rows);
        self.first = [x0, y0];
        let steps = Vec2::new(x0.wrapping_sub(own[0]) as i32 as f32, y0.wrapping_sub(own[1]) as i32 as f32);
        self.from_first = offset - 0.5 - steps;
        if self.columns.is_empty() {
            self.rows.clear();
        }
    }
}

/// The pixel that a position of the film lies in; `None` beside the picture.
///
/// * `raster`: in pixels from the top left corner
pub(crate) fn pixel_at(spec: &FilmSpec, raster: Vec2) -> Option<[u32; 2]> {
    let inside = |at: f32, n: u32| at >= 0.0 && at < n as f32;
    // Where the picture's width is no `f32`, the comparison lets one position too many through.
    (inside(raster.x, spec.width) && inside(raster.y, spec.height))
        .then(|| [(raster.x as u32).min(spec.width - 1), (raster.y as u32).min(spec.height - 1)])
}

/// Calls `add` with every pixel that light at a position of the film reaches, and its weight there; not at all
/// beside the picture.
///
/// * `raster`: in pixels from the top left corner
/// * `taps`: memory to work with
pub(crate) fn splat(spec: &FilmSpec, raster: Vec2, taps: &mut Taps, mut add: impl FnMut(u32, u32, Weight)) {
    let Some(own) = pixel_at(spec, raster) else { return };
    let Some(radius) = spec.filter.radius() else {
        add(own[0], own[1], Weight::ONE);
        return;
    };
    let offset = raster - Vec2::new(own[0] as f32, own[1] as f32);
    taps.surround(spec, own, offset, Reach::within_pixel(radius));
    for (j, y) in taps.rows() {
        for (weight, x) in taps.weights(&spec.filter, j).zip(taps.first[0]..) {
            add(x, y, weight);
        }
    }
}

/// Weights of the pixels along one axis that a sample reaches, and the first of these pixels.
///
/// * `offset`: position of the sample relative to the start of pixel `own`
/// * `cell`: the pixels it may reach
/// * `reach`: how far before and after `own` these can lie at most
fn taps(
    filter: &super::Filter,
    offset: f32,
    own: u32,
    cell: (u32, u32),
    reach: (i32, i32),
    weights: &mut Vec<f32>,
) -> u32 {
    weights.clear();
    // Counted from `own`, so that the weights do not depend on where in the picture it lies.
    let before = reach.0.min(i32::try_from(own - cell.0).unwrap_or(i32::MAX));
    let after = reach.1.min(i32::try_from(cell.1 - 1 - own).unwrap_or(i32::MAX));
    let weight = |i: i32| filter.profile(offset - 0.5 - i as f32);
    let Some(first) = (-before..=after).find(|&i| weight(i) != 0.0) else { return own };
    weights.extend((first..=after).map(weight));
    while weights.last() == Some(&0.0) {
        weights.pop();
    }
    own.wrapping_add_signed(first)
}
