//! A rectangle of floats.

use crate::ImageError;

/// A picture of `height × width × channels` floats, row 0 on top, channels interleaved.
///
/// Channels are grey (1), grey and alpha (2), red-green-blue (3) or red-green-blue-alpha
/// (4). The numbers have no unit of their own: a render holds linear radiance, a decoded
/// PNG the stored values divided by their maximum. A side is never zero.
#[derive(Debug, Clone, PartialEq)]
pub struct Image {
    width: u32,
    height: u32,
    channels: usize,
    data: Vec<f32>,
}

/// Pixels `x .. x + width`, `y .. y + height`; `y` counts from the top.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Crop {
    /// Left column.
    pub x: u32,
    /// Top row.
    pub y: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

impl Image {
    /// A picture of zeros.
    ///
    /// # Errors
    /// [`ImageError::Parameter`] when a side is zero or `channels` is not 1 to 4, and
    /// [`ImageError::Memory`] when there is no memory for the pixels.
    pub fn new(width: u32, height: u32, channels: usize) -> Result<Self, ImageError> {
        let len = Self::checked_len(width, height, channels)?;
        let mut data = Vec::new();
        data.try_reserve_exact(len).map_err(|_| ImageError::memory((len * size_of::<f32>()) as u64))?;
        data.resize(len, 0.0);
        Ok(Self { width, height, channels, data })
    }

    /// A picture with every pixel equal to `pixel`, whose length is the number of channels.
    ///
    /// # Errors
    /// As [`Image::new`].
    pub fn filled(width: u32, height: u32, pixel: &[f32]) -> Result<Self, ImageError> {
        let mut image = Self::new(width, height, pixel.len())?;
        image.data.chunks_exact_mut(pixel.len()).for_each(|p| p.copy_from_slice(pixel));
        Ok(image)
    }

    /// Takes over `data`, laid out `height × width × channels` with row 0 on top.
    ///
    /// # Errors
    /// [`ImageError::Parameter`] as [`Image::new`], or when `data` has another length.
    pub fn from_data(width: u32, height: u32, channels: usize, data: Vec<f32>) -> Result<Self, ImageError> {
        let len = Self::checked_len(width, height, channels)?;
        if data.len() != len {
            let found = data.len();
            return Err(ImageError::parameter(format!(
                "{width} x {height} x {channels} floats are {len}, not {found}"
            )));
        }
        Ok(Self { width, height, channels, data })
    }

    /// A picture whose pixel (x, y) is `pixel(x, y)`.
    ///
    /// # Errors
    /// As [`Image::new`].
    pub fn from_fn<const N: usize>(
        width: u32,
        height: u32,
        mut pixel: impl FnMut(u32, u32) -> [f32; N],
    ) -> Result<Self, ImageError> {
        let mut image = Self::new(width, height, N)?;
        for y in 0..height {
            for (x, out) in (0..width).zip(image.row_mut(y).chunks_exact_mut(N)) {
                out.copy_from_slice(&pixel(x, y));
            }
        }
        Ok(image)
    }

    fn checked_len(width: u32, height: u32, channels: usize) -> Result<usize, ImageError> {
        if width == 0 || height == 0 {
            return Err(ImageError::parameter(format!("a picture of {width} x {height} has no pixels")));
        }
        if !(1..=4).contains(&channels) {
            return Err(ImageError::parameter(format!("a picture has 1 to 4 channels, not {channels}")));
        }
        (width as usize)
            .checked_mul(height as usize)
            .and_then(|n| n.checked_mul(channels))
            .filter(|n| n.checked_mul(size_of::<f32>()).is_some())
            .ok_or_else(|| ImageError::parameter(format!("{width} x {height} pixels overflow memory")))
    }

    /// Columns.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Floats per pixel, 1 to 4.
    pub fn channels(&self) -> usize {
        self.channels
    }

    /// All floats, `height × width × channels`.
    pub fn data(&self) -> &[f32] {
        &self.data
    }

    /// All floats, `height × width × channels`.
    pub fn data_mut(&mut self) -> &mut [f32] {
        &mut self.data
    }

    /// Gives the floats away.
    pub fn into_data(self) -> Vec<f32> {
        self.data
    }

    /// The channels of one pixel.
    ///
    /// # Panics
    /// When (x, y) lies outside the picture, as slice indexing does.
    pub fn pixel(&self, x: u32, y: u32) -> &[f32] {
        let start = self.offset(x, y);
        &self.data[start..start + self.channels]
    }

    /// The channels of one pixel, to be changed.
    ///
    /// # Panics
    /// When (x, y) lies outside the picture, as slice indexing does.
    pub fn pixel_mut(&mut self, x: u32, y: u32) -> &mut [f32] {
        let start = self.offset(x, y);
        &mut self.data[start..start + self.channels]
    }

    /// Red, green and blue of one pixel; grey is spread and alpha left out.
    ///
    /// # Panics
    /// When (x, y) lies outside the picture, as slice indexing does.
    pub fn rgb(&self, x: u32, y: u32) -> [f32; 3] {
        to_rgb(self.pixel(x, y))
    }

    /// Pixels from left to right, rows from top to bottom.
    pub fn pixels(&self) -> impl ExactSizeIterator<Item = &[f32]> {
        self.data.chunks_exact(self.channels)
    }

    /// As [`Image::pixels`], each spread to red, green and blue as [`Image::rgb`] does.
    pub fn rgb_pixels(&self) -> impl ExactSizeIterator<Item = [f32; 3]> {
        self.pixels().map(to_rgb)
    }

    /// The floats of row `y`, counted from the top.
    ///
    /// # Panics
    /// When `y` lies outside the picture, as slice indexing does.
    pub fn row(&self, y: u32) -> &[f32] {
        let (start, len) = (self.offset(0, y), self.row_len());
        &self.data[start..start + len]
    }

    /// The floats of row `y`, to be changed.
    ///
    /// # Panics
    /// When `y` lies outside the picture, as slice indexing does.
    pub fn row_mut(&mut self, y: u32) -> &mut [f32] {
        let (start, len) = (self.offset(0, y), self.row_len());
        &mut self.data[start..start + len]
    }

    /// A copy of the part inside `rect`.
    ///
    /// # Errors
    /// [`ImageError::Parameter`] when `rect` is empty or leaves the picture.
    pub fn crop(&self, rect: Crop) -> Result<Self, ImageError> {
        self.check_inside(rect)?;
        let mut part = Self::new(rect.width, rect.height, self.channels)?;
        let from = rect.x as usize * self.channels;
        for y in 0..rect.height {
            let len = part.row_len();
            part.row_mut(y).copy_from_slice(&self.row(rect.y + y)[from..from + len]);
        }
        Ok(part)
    }

    /// Overwrites the part whose top left pixel is (x, y) with `tile`.
    ///
    /// # Errors
    /// [`ImageError::Parameter`] when the tile leaves the picture or has other channels.
    pub fn blit(&mut self, tile: &Self, x: u32, y: u32) -> Result<(), ImageError> {
        self.check_inside(Crop { x, y, width: tile.width, height: tile.height })?;
        if tile.channels != self.channels {
            let (a, b) = (tile.channels, self.channels);
            return Err(ImageError::parameter(format!("a tile of {a} channels in a picture of {b}")));
        }
        let to = x as usize * self.channels;
        for row in 0..tile.height {
            self.row_mut(y + row)[to..to + tile.row_len()].copy_from_slice(tile.row(row));
        }
        Ok(())
    }

    /// Pictures of one height and channel count side by side, the first on the left.
    ///
    /// # Errors
    /// [`ImageError::Parameter`] when there is no picture, they differ, or the strip is too wide.
    pub fn strip(images: &[Self]) -> Result<Self, ImageError> {
        let first = images.first().ok_or_else(|| ImageError::parameter("a strip of no pictures"))?;
        if images.iter().any(|image| image.height != first.height) {
            return Err(ImageError::parameter("pictures of a strip must have the same height"));
        }
        let width = images
            .iter()
            .try_fold(0u32, |sum, image| sum.checked_add(image.width))
            .ok_or_else(|| ImageError::parameter("the strip is too wide"))?;
        let mut strip = Self::new(width, first.height, first.channels)?;
        let mut x = 0;
        for image in images {
            strip.blit(image, x, 0)?;
            x += image.width;
        }
        Ok(strip)
    }

    /// The same colours with exactly `channels` floats per pixel.
    ///
    /// Grey is spread over colour, colour becomes grey by its mean, a missing alpha is 1.
    ///
    /// # Errors
    /// [`ImageError::Parameter`] when `channels` is not 1 to 4.
    pub fn with_channels(&self, channels: usize) -> Result<Self, ImageError> {
        let mut image = Self::new(self.width, self.height, channels)?;
        for (from, to) in self.pixels().zip(image.data.chunks_exact_mut(channels)) {
            let [r, g, b] = to_rgb(from);
            let alpha = if from.len().is_multiple_of(2) { from[from.len() - 1] } else { 1.0 };
            let grey = if from.len() < 3 { r } else { (r + g + b) / 3.0 };
            match to {
                [v] => *v = grey,
                [v, a] => (*v, *a) = (grey, alpha),
                [x, y, z] => (*x, *y, *z) = (r, g, b),
                _ => to.copy_from_slice(&[r, g, b, alpha]),
            }
        }
        Ok(image)
    }

    fn row_len(&self) -> usize {
        self.width as usize * self.channels
    }

    fn offset(&self, x: u32, y: u32) -> usize {
        // Without this check a large x would quietly name a pixel of a later row.
        assert!(x < self.width && y < self.height, "pixel ({x}, {y}) of {} x {}", self.width, self.height);
        (y as usize * self.width as usize + x as usize) * self.channels
    }

    fn check_inside(&self, rect: Crop) -> Result<(), ImageError> {
        let fits = |start: u32, len: u32, side: u32| u64::from(start) + u64::from(len) <= u64::from(side);
        if fits(rect.x, rect.width, self.width) && fits(rect.y, rect.height, self.height) {
            return Ok(());
        }
        let (w, h) = (self.width, self.height);
        Err(ImageError::parameter(format!("{rect:?} leaves a picture of {w} x {h}")))
    }
}

fn to_rgb(pixel: &[f32]) -> [f32; 3] {
    match *pixel {
        [r, g, b] | [r, g, b, _] => [r, g, b],
        [v, ..] => [v; 3],
        [] => unreachable!("a picture has at least one channel"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn coordinates(width: u32, height: u32) -> Image {
        Image::from_fn(width, height, |x, y| [x as f32, y as f32]).unwrap()
    }

    #[test]
    fn impossible_shapes_are_refused() {
        for (w, h, c) in [(0, 1, 1), (1, 0, 1), (1, 1, 0), (1, 1, 5), (u32::MAX, u32::MAX, 4)] {
            assert!(matches!(Image::new(w, h, c), Err(ImageError::Parameter(_))), "{w} {h} {c}");
        }
        assert!(Image::from_data(2, 2, 1, vec![0.0; 5]).is_err());
        assert!(Image::filled(2, 2, &[]).is_err());
    }

    #[test]
    fn rows_run_from_the_top_and_pixels_from_the_left() {
        let image = coordinates(3, 2);
        assert_eq!(image.data(), [0., 0., 1., 0., 2., 0., 0., 1., 1., 1., 2., 1.]);
        assert_eq!(image.pixel(2, 1), [2.0, 1.0]);
        assert_eq!(image.row(1), [0., 1., 1., 1., 2., 1.]);
        assert_eq!(image.pixels().len(), 6);
    }

    #[test]
    #[should_panic(expected = "pixel (3, 0) of 3 x 2")]
    fn a_column_too_far_is_not_the_next_row() {
        coordinates(3, 2).pixel(3, 0);
    }

    #[test]
    fn crop_and_blit_are_inverse() {
        let image = coordinates(5, 4);
        let rect = Crop { x: 1, y: 2, width: 3, height: 2 };
        let part = image.crop(rect).unwrap();
        assert_eq!(part.pixel(0, 0), [1.0, 2.0]);
        assert_eq!(part.pixel(2, 1), [3.0, 3.0]);

        let mut canvas = Image::new(5, 4, 2).unwrap();
        canvas.blit(&part, rect.x, rect.y).unwrap();
        assert_eq!(canvas.crop(rect).unwrap(), part);
        let painted = canvas.pixels().filter(|p| **p != [0.0, 0.0]).count();
        assert_eq!(painted, 6);
    }

    #[test]
    fn parts_outside_are_refused() {
        let image = coordinates(5, 4);
        for rect in [(3, 0, 3, 1), (0, 3, 1, 2), (u32::MAX, 0, 2, 1), (0, 0, 0, 1)] {
            let (x, y, width, height) = rect;
            assert!(image.crop(Crop { x, y, width, height }).is_err(), "{rect:?}");
        }
        let mut canvas = Image::new(5, 4, 3).unwrap();
        assert!(canvas.blit(&image, 0, 0).is_err(), "channels differ");
        assert!(canvas.blit(&Image::new(2, 2, 3).unwrap(), 4, 0).is_err(), "too wide");
    }

    #[test]
    fn a_strip_keeps_order() {
        let tiles: Vec<_> = (0..12).map(|i| Image::filled(2, 3, &[i as f32]).unwrap()).collect();
        let strip = Image::strip(&tiles).unwrap();
        assert_eq!((strip.width(), strip.height()), (24, 3));
        for x in 0..24 {
            assert_eq!(strip.pixel(x, 2), [(x / 2) as f32]);
        }
        assert!(Image::strip(&[]).is_err());
        assert!(Image::strip(&[Image::new(1, 1, 1).unwrap(), Image::new(1, 2, 1).unwrap()]).is_err());
    }

    #[test]
    fn channels_are_added_and_dropped() {
        let convert =
            |from: &[f32], n| Image::filled(1, 1, from).unwrap().with_channels(n).unwrap().into_data();
        assert_eq!(convert(&[0.5], 4), [0.5, 0.5, 0.5, 1.0]);
        assert_eq!(convert(&[0.5, 0.25], 4), [0.5, 0.5, 0.5, 0.25]);
        assert_eq!(convert(&[0.0, 0.25, 0.5], 1), [0.25]);
        assert_eq!(convert(&[0.1, 0.2, 0.3, 0.4], 3), [0.1, 0.2, 0.3]);
        assert_eq!(convert(&[0.0, 0.25, 0.5, 0.75], 2), [0.25, 0.75]);
    }
}
