//! What a film is asked to hold, and what that costs.

use kajo_core::sampler::Sampler;
use thiserror::Error;

use super::{
    filter::Filter,
    layer::{DepthMap, Layer, LayerSet, NormalMap},
    reach::Reach,
};
use crate::rect::Rect;

/// Most pixels a picture may have.
pub const LARGEST_PICTURE: u64 = 1 << 31;

/// Pictures up to this size always keep their sums, so that their samples can be split among threads.
const SMALL_PICTURE: u64 = 1 << 16;

/// Size, filter and layers of a film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilmSpec {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Width and height of the cells that samples are confined to, in pixels, counted from the top left
    /// corner: no sample reaches a pixel of another cell. `None` for one cell. The tiles of a cube map
    /// are such cells.
    pub cell: Option<[u32; 2]>,
    /// How samples are spread over pixels.
    pub filter: Filter,
    /// The most that a sample brings of light that was scattered, the largest of red, green and blue, above zero; `None` for any
    /// amount. See [`clamp`](super::clamp).
    pub clamp: Option<f32>,
    /// What to record.
    pub layers: LayerSet,
    /// Scale of [`Layer::DepthMap`].
    pub depth_map: DepthMap,
    /// Rule of [`Layer::NormalMap`].
    pub normal_map: NormalMap,
    /// The film is for one call of [`render`](crate::render) and nothing is merged into it afterwards.
    /// Where samples count for their own pixel only, the finished tiles of all but small pictures are then
    /// kept as floats, in about a quarter of the memory; the pictures are the same.
    pub one_pass: bool,
    /// Samples of even and of odd index are summed apart, and a pixel is the mean of the two means. This keeps
    /// pictures unbiased whose samples are spread by what earlier ones showed; see
    /// [`adaptive`](crate::schedule::adaptive).
    pub halves: bool,
    /// The pixels that are shown; all of them for `None`. Samples are taken only where they reach these, and what is
    /// shown has the same bits as in the whole picture.
    pub shown: Option<Rect>,
    /// Samples are taken everywhere all the same: light splats from anywhere to anywhere, or the noise of the whole
    /// picture decides.
    pub samples_everywhere: bool,
}

impl FilmSpec {
    /// A film of colours with the plain average and room for merging.
    pub fn new(width: u32, height: u32) -> FilmSpec {
        FilmSpec {
            width,
            height,
            cell: None,
            filter: Filter::None,
            clamp: None,
            layers: LayerSet::of(&[Layer::Color]),
            depth_map: DepthMap::default(),
            normal_map: NormalMap::default(),
            one_pass: false,
            halves: false,
            shown: None,
            samples_everywhere: false,
        }
    }

    /// The pixels that are shown.
    pub fn shown(&self) -> Rect {
        self.shown.map_or(self.rect(), |shown| shown.intersection(&self.rect()))
    }

    /// The pixels that samples are taken of: those shown, and those whose samples reach them.
    pub fn sampled(&self, sampler: &Sampler) -> Rect {
        if self.shown.is_none() || self.samples_everywhere || self.halves {
            return self.rect();
        }
        let reach = Reach::of(&self.filter, sampler).widest();
        let Rect { x0, y0, x1, y1 } = self.shown();
        let around = Rect {
            x0: x0.saturating_sub(reach),
            y0: y0.saturating_sub(reach),
            x1: x1.saturating_add(reach),
            y1: y1.saturating_add(reach),
        };
        around.intersection(&self.rect())
    }

    /// The whole picture.
    pub fn rect(&self) -> Rect {
        Rect::of_size(self.width, self.height)
    }

    /// Bytes that a full film of this kind takes.
    pub fn bytes(&self) -> u128 {
        let channels: usize = self.layers.iter().map(Layer::channels).sum();
        let per_pixel = if self.keeps_sums() { self.parts().bytes_per_pixel() } else { 4 * channels };
        let area = if self.samples_everywhere || self.halves { self.rect() } else { self.shown() }.area();
        u128::from(area) * per_pixel as u128
    }

    /// Whether the sums stay until the picture is developed.
    pub(crate) fn keeps_sums(&self) -> bool {
        let small = self.rect().area() <= SMALL_PICTURE;
        !self.one_pass || self.halves || small || self.filter.radius().is_some()
    }

    /// The arrays that sums consist of.
    pub(crate) fn parts(&self) -> Parts {
        let weights = self.filter.radius().is_some();
        Parts {
            halves: if self.halves { 2 } else { 1 },
            channels: self.layers.filtered().map(Layer::channels).sum(),
            weights,
            counts: !weights || self.layers.has(Layer::SampleCount) || self.layers.has(Layer::Variance),
            distances: self.layers.has(Layer::Depth),
            firsts: self.layers.has(Layer::ObjectId) || self.layers.has(Layer::MaterialId),
            moments: self.layers.has(Layer::Variance),
        }
    }

    /// The pixels that a sample of pixel `(x, y)` may reach.
    #[inline]
    pub(crate) fn cell_around(&self, x: u32, y: u32) -> Rect {
        let Some([width, height]) = self.cell else { return self.rect() };
        let (x0, y0) = (x - x % width, y - y % height);
        Rect {
            x0,
            y0,
            x1: x0.saturating_add(width).min(self.width),
            y1: y0.saturating_add(height).min(self.height),
        }
    }

    /// Whether a film of this kind can be made within `budget` bytes.
    ///
    /// # Errors
    /// [`FilmError`] names the number that is out of range.
    pub fn check(&self, budget: u64) -> Result<(), FilmError> {
        let (width, height) = (self.width, self.height);
        if self.shown.is_some() && self.shown().area() == 0 {
            return Err(FilmError::NothingShown { width, height });
        }
        if width == 0 || height == 0 || self.cell.is_some_and(|cell| cell.contains(&0)) {
            return Err(FilmError::Empty { width, height });
        }
        let pixels = u64::from(width) * u64::from(height);
        if pixels > LARGEST_PICTURE {
            return Err(FilmError::TooManyPixels { width, height, pixels });
        }
        if !self.filter.is_valid() {
            return Err(FilmError::Filter { radius: self.filter.radius().unwrap_or(0.0) });
        }
        let needed = self.bytes();
        if needed > u128::from(budget) {
            return Err(FilmError::Memory {
                width,
                height,
                needed: needed as f64 / 1e6,
                budget: budget as f64 / 1e6,
            });
        }
        Ok(())
    }
}

/// Which arrays the sums of a film consist of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Parts {
    /// Sets of sums that samples are dealt to by their index: 1 or 2.
    pub halves: usize,
    /// Filtered channels per pixel.
    pub channels: usize,
    /// Weights differ from sample to sample, so they are summed; otherwise the count is their sum.
    pub weights: bool,
    /// Samples are counted.
    pub counts: bool,
    /// Distances of hits are summed.
    pub distances: bool,
    /// The first sample's object and material are kept.
    pub firsts: bool,
    /// Colours of the pixel's own samples and their squares are summed.
    pub moments: bool,
}

impl Parts {
    fn bytes_per_pixel(self) -> usize {
        let half = 16 * self.channels
            + if self.weights { 8 } else { 0 }
            + if self.counts { 4 } else { 0 }
            + if self.distances { 20 } else { 0 }
            + if self.firsts { 12 } else { 0 }
            + if self.moments { 96 } else { 0 };
        half * self.halves
    }
}

/// Why a film cannot be made or added to.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum FilmError {
    /// The picture, or a cell of it, has no pixels.
    #[error(
        "a picture of {width} x {height} pixels has nothing to show; width, height and cells must be at least 1"
    )]
    Empty {
        /// Columns asked for.
        width: u32,
        /// Rows asked for.
        height: u32,
    },
    /// Of the picture nothing is to be shown.
    #[error("this part lies outside of the picture of {width} x {height} pixels")]
    NothingShown {
        /// Columns of the picture.
        width: u32,
        /// Rows of the picture.
        height: u32,
    },
    /// More pixels than any picture may have.
    #[error(
        "a picture of {width} x {height} has {pixels} pixels; at most {LARGEST_PICTURE} are possible, ask for a smaller one"
    )]
    TooManyPixels {
        /// Columns asked for.
        width: u32,
        /// Rows asked for.
        height: u32,
        /// Their product.
        pixels: u64,
    },
    /// More memory than the caller allows.
    #[error(
        "a picture of {width} x {height} with these outputs needs {needed:.0} MB and {budget:.0} MB are allowed; \
         ask for a smaller one or for fewer outputs"
    )]
    Memory {
        /// Columns asked for.
        width: u32,
        /// Rows asked for.
        height: u32,
        /// Megabytes needed.
        needed: f64,
        /// Megabytes allowed.
        budget: f64,
    },
    /// The system has no more memory.
    #[error("no memory is left for a film of {needed:.0} MB")]
    OutOfMemory {
        /// Megabytes needed.
        needed: f64,
    },
    /// The filter's radius makes no sense.
    #[error(
        "a filter radius of {radius} pixels was found; more than 0 and at most {} is possible",
        Filter::LARGEST_RADIUS
    )]
    Filter {
        /// Radius asked for.
        radius: f32,
    },
    /// A part was made for a film of another size, filter or set of layers.
    #[error("this part belongs to another film")]
    OtherFilm,
    /// The film was made for one pass and can take nothing more.
    #[error("this film was made for one pass; parts can only be merged into a film that keeps its sums")]
    OnePass,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn absurd_pictures_are_refused_with_what_they_need() {
        let check = |width, height, budget| FilmSpec::new(width, height).check(budget);
        assert!(matches!(check(0, 5, u64::MAX), Err(FilmError::Empty { .. })));
        let huge = check(1_000_000_000, 1_000_000_000, u64::MAX).expect_err("refused");
        assert!(huge.to_string().contains("1000000000000000000 pixels"), "{huge}");
        assert!(matches!(check(u32::MAX, u32::MAX, u64::MAX), Err(FilmError::TooManyPixels { .. })));
        assert_eq!(check(1 << 16, 1 << 15, u64::MAX), Ok(()));
        assert!(matches!(check(1 << 16, (1 << 15) + 1, u64::MAX), Err(FilmError::TooManyPixels { .. })));
        let tight = check(1000, 1000, 51_999_999).expect_err("refused");
        assert!(tight.to_string().contains("needs 52 MB"), "{tight}");
        assert_eq!(check(1000, 1000, 52_000_000), Ok(()));
        let cell = FilmSpec { cell: Some([4, 0]), ..FilmSpec::new(8, 8) };
        assert!(matches!(cell.check(u64::MAX), Err(FilmError::Empty { .. })));
        for radius in [0.0, f32::NAN, 1e9] {
            let spec = FilmSpec { filter: Filter::Tent { radius }, ..FilmSpec::new(8, 8) };
            assert!(matches!(spec.check(u64::MAX), Err(FilmError::Filter { .. })), "{radius}");
        }
    }

    #[test]
    fn colour_at_4k_stays_well_under_a_gigabyte() {
        let spec = FilmSpec::new(3840, 2160);
        let filtered = FilmSpec { filter: Filter::MITCHELL, ..spec };
        assert_eq!(spec.bytes(), 3840 * 2160 * 52);
        assert_eq!(filtered.bytes(), 3840 * 2160 * 56);
        assert_eq!(FilmSpec { one_pass: true, ..spec }.bytes(), 3840 * 2160 * 12);
        assert_eq!(FilmSpec { one_pass: true, ..filtered }.bytes(), filtered.bytes());
        assert_eq!(FilmSpec { one_pass: true, halves: true, ..spec }.bytes(), 2 * spec.bytes());
    }

    #[test]
    fn cells_are_counted_from_the_top_left_corner() {
        let spec = FilmSpec { cell: Some([4, 3]), ..FilmSpec::new(10, 4) };
        assert_eq!(spec.cell_around(5, 2), Rect { x0: 4, y0: 0, x1: 8, y1: 3 });
        assert_eq!(spec.cell_around(9, 3), Rect { x0: 8, y0: 3, x1: 10, y1: 4 });
        assert_eq!(FilmSpec::new(10, 4).cell_around(9, 3), Rect::of_size(10, 4));
    }
}
