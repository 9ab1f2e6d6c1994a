//! Splatting: samples go to every pixel their filter reaches.
//!
//! A sample at offset `(x, y)` from the corner of its pixel counts for the pixel `(i, j)` further on
//! when `(x - ½ - i, y - ½ - j)` lies in the filter's support, with the filter's weight there. A part
//! therefore covers the pixels samples are taken for and a border as wide as the filter reaches.

use kajo_core::sampler::Sampler;
use kajo_math::Vec2;

use super::{
    fixed::{Term, Weight},
    layer::{self, MAX_CHANNELS},
    spec::FilmSpec,
    sums::Sums,
};
use crate::{PixelSample, rect::Rect};

/// What some samples bring to a rectangle of a film. Parts add up exactly, in any order.
#[derive(Clone, Debug)]
pub struct FilmPart {
    spec: FilmSpec,
    reach: Option<Reach>,
    pub(crate) sums: Sums,
    /// Samples with values that were not finite numbers.
    pub(crate) non_finite: u64,
    /// The splat at hand: values, and weights of its columns and rows.
    terms: Vec<Term>,
    columns: Vec<f32>,
    rows: Vec<f32>,
}

/// How far samples reach beyond their own pixel, in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Reach {
    /// To the left, to the right and upwards.
    side: i32,
    /// Downwards, where samples may overhang.
    below: i32,
}

impl Reach {
    fn new(radius: f32, sampler: &Sampler) -> Reach {
        // Offsets lie in [0, 1), or [0, height) downwards, and the support is half-open.
        let beyond = |extent: f32| (extent - 0.5 + radius).ceil() as i32 - 1;
        Reach { side: beyond(1.0), below: beyond(sampler.height()) }
    }
}

impl FilmPart {
    /// A part for no pixels yet; see [`FilmPart::reset`].
    pub fn new(spec: &FilmSpec, sampler: &Sampler) -> FilmPart {
        FilmPart {
            spec: *spec,
            reach: spec.filter.radius().map(|radius| Reach::new(radius, sampler)),
            sums: Sums::empty(spec),
            non_finite: 0,
            terms: Vec::with_capacity(MAX_CHANNELS),
            columns: Vec::new(),
            rows: Vec::new(),
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
        self.sums.reset(bordered.intersection(&self.spec.rect()));
        self.non_finite = 0;
    }

    /// The pixels that have sums: those of the tile and the border that its samples reach.
    pub fn rect(&self) -> Rect {
        self.sums.rect
    }

    /// What film the part is for.
    pub fn spec(&self) -> &FilmSpec {
        &self.spec
    }

    /// Adds sample `k` of pixel `(x, y)`, which lies in the tile.
    ///
    /// * `offset`: place of the sample relative to the pixel's top left corner, as its sampler gave it
    ///
    /// A value that is no finite number counts as zero, and the sample is counted as such.
    #[inline]
    pub fn add(&mut self, x: u32, y: u32, k: u32, offset: Vec2, sample: &PixelSample) {
        let own = self.sums.rect.index(x, y);
        let mut values = [0.0; MAX_CHANNELS];
        let values = layer::filtered_values(&self.spec, sample, &mut values);
        let finite = match self.reach {
            None => self.sums.add_plain(own, values),
            Some(reach) => self.splat(x, y, offset, reach, values),
        };
        let own_finite = self.sums.add_own(own, k, sample.first.as_ref());
        self.non_finite += u64::from(!finite | !own_finite);
    }

    /// Adds values to every pixel in the support of their sample's filter.
    ///
    /// Returns whether all of them were finite.
    fn splat(&mut self, x: u32, y: u32, offset: Vec2, reach: Reach, values: &[f32]) -> bool {
        self.terms.clear();
        self.terms.extend(values.iter().map(|&v| Term::new(v).unwrap_or(Term::ZERO)));
        let cell = self.spec.cell_around(x, y);
        let filter = &self.spec.filter;
        let x0 = taps(filter, offset.x, x, (cell.x0, cell.x1), (reach.side, reach.side), &mut self.columns);
        let y0 = taps(filter, offset.y, y, (cell.y0, cell.y1), (reach.side, reach.below), &mut self.rows);
        // Without columns, `x0` need not even be in the rectangle.
        let rows = if self.columns.is_empty() { &[] } else { &*self.rows };
        for (y, &wy) in (y0..).zip(rows) {
            let row = self.sums.rect.index(x0, y);
            for (pixel, &wx) in (row..).zip(&self.columns) {
                self.sums.add_filtered(pixel, Weight::new(wx * wy), &self.terms);
            }
        }
        values.iter().all(|v| v.is_finite())
    }
}

/// Weights of the pixels along one axis that a sample reaches, and the first of these pixels.
///
/// * `offset`: place of the sample relative to the start of pixel `own`
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
