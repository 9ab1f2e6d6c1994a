//! Comparing two picture files.

use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use kajo_image::colormap::magma;
use kajo_image::metrics::{self, Comparison, DEFAULT_PIXELS_PER_DEGREE, Exposures};
use kajo_image::{DecodeLimits, Decoded, Format, Image, ImageError, decode, difference};

use crate::memory;

/// Bytes a pixel while two pictures are compared, beside the pictures: what an eye makes of one of them, and the planes
/// that the other is blurred in.
const BYTES_TO_COMPARE: u64 = 130;

/// Two pictures and how far they are apart.
#[derive(Debug)]
pub struct Difference {
    reference: Decoded,
    test: Decoded,
    /// Where, and how much, an eye would notice: `height × width × 1` in [0, 1].
    pub flip: Image,
    /// Figures that compare number with number.
    pub figures: Comparison,
}

/// Why two pictures cannot be compared.
#[derive(Debug, thiserror::Error)]
pub enum CompareError {
    /// A file cannot be read.
    #[error("cannot read `{}`: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// A file is no picture.
    #[error("cannot read `{}`: {source}", path.display())]
    Decode {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        source: ImageError,
    },
    /// The pictures do not go together.
    #[error(transparent)]
    Image(#[from] ImageError),
}

impl Difference {
    /// Compares the picture in `test` with that in `reference`.
    ///
    /// Values are compared as they are stored, so that a picture of 8 bits and one of 16 differ by rounding only.
    ///
    /// # Errors
    /// When one of them cannot be read, or they have different sizes.
    pub fn between(reference: &Path, test: &Path) -> Result<Difference, CompareError> {
        let (reference, test) = (read_picture(reference)?, read_picture(test)?);
        let is_light = reference.format.is_float() || test.format.is_float();
        let (figures, flip) = compare_pictures(&reference.image, &test.image, is_light)?;
        Ok(Difference { reference, test, flip, figures })
    }

    /// Mean of the FLIP error over all pixels, 0 to 1.
    pub fn mean_flip(&self) -> f64 {
        metrics::mean(&self.flip)
    }

    /// Share of pixels, 0 to 1, with a channel off by more than `steps`/255.
    ///
    /// # Errors
    /// None that [`Difference::between`] would not have found.
    pub fn share_above(&self, steps: f64) -> Result<f64, CompareError> {
        Ok(metrics::share_above(&self.reference.image, &self.test.image, steps)?)
    }

    /// The FLIP error as a picture: black where the pictures agree, through violet and orange to pale yellow.
    ///
    /// # Errors
    /// When there is no memory for it.
    pub fn picture(&self) -> Result<Image, CompareError> {
        Ok(difference::error_map(&self.flip)?)
    }
}

/// Compares two pictures in memory: figures number by number, and the FLIP error, `height × width × 1` in [0, 1].
///
/// * `is_light`: whether the numbers are light, to be looked at with several exposures, and not values of a screen
///
/// # Errors
/// When they have different sizes, or there is no memory for the comparison.
pub fn compare_pictures(
    reference: &Image,
    test: &Image,
    is_light: bool,
) -> Result<(Comparison, Image), CompareError> {
    let pixels = u64::from(reference.width()) * u64::from(reference.height());
    let needed = pixels.saturating_mul(BYTES_TO_COMPARE);
    if needed > memory::available() {
        return Err(ImageError::Memory { needed }.into());
    }
    let figures = metrics::compare(reference, test)?;
    let flip = match is_light {
        false => metrics::flip(reference, test, DEFAULT_PIXELS_PER_DEGREE)?,
        true => metrics::hdr_flip(reference, test, Exposures::of(reference), DEFAULT_PIXELS_PER_DEGREE)?,
    };
    Ok((figures, flip))
}

/// Two renders and how far the light of one is from the other's.
#[derive(Debug)]
pub struct LightDifference {
    /// Figures that compare number with number.
    pub figures: Comparison,
    /// `|a - b| / (|a| + |b|)` of each pixel, summed over its channels, in the colours of magma: black where the
    /// pictures agree, pale yellow where one of them is black and the other is not.
    pub map: Image,
}

impl LightDifference {
    /// Compares the light of two pictures, linear RGB.
    ///
    /// # Errors
    /// When they have different sizes, or there is no memory for the map.
    pub fn between(reference: &Image, test: &Image) -> Result<LightDifference, CompareError> {
        let figures = metrics::compare(reference, test)?;
        let map = Image::from_fn(reference.width(), reference.height(), |x, y| {
            let (a, b) = (reference.rgb(x, y), test.rgb(x, y));
            let (apart, sum) = a
                .iter()
                .zip(b)
                .fold((0.0, 0.0), |(apart, sum), (a, b)| (apart + (a - b).abs(), sum + a.abs() + b.abs()));
            magma(if apart == 0.0 { 0.0 } else { apart / sum })
        })?;
        Ok(LightDifference { figures, map })
    }
}

/// Reads a picture of any format kajo knows.
///
/// # Errors
/// [`CompareError::Read`] and [`CompareError::Decode`].
pub fn read_picture(path: &Path) -> Result<Decoded, CompareError> {
    let usual = DecodeLimits::default();
    let limits = DecodeLimits { max_bytes: usual.max_bytes.min(memory::available()), ..usual };
    let bytes = read_regular(path, usual.max_bytes)
        .map_err(|source| CompareError::Read { path: path.to_path_buf(), source })?;
    let hint = path.extension().and_then(|extension| Format::from_extension(&extension.to_string_lossy()));
    decode(&bytes, hint, &limits).map_err(|source| {
        let source = match source {
            ImageError::Limit { needed, limit, .. }
                if limit == limits.max_bytes && limit < usual.max_bytes =>
            {
                ImageError::Memory { needed }
            }
            source => source,
        };
        CompareError::Decode { path: path.to_path_buf(), source }
    })
}

/// Reads a regular file of at most `limit` bytes.
pub(crate) fn read_regular(path: &Path, limit: u64) -> io::Result<Vec<u8>> {
    if !std::fs::metadata(path)?.is_file() {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "it is not a regular file"));
    }
    let mut bytes = Vec::new();
    File::open(path)?.take(limit.saturating_add(1)).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > limit {
        let message = format!("it has more than {limit} bytes, the most that is read");
        return Err(io::Error::new(io::ErrorKind::FileTooLarge, message));
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo_image::{EncodeOptions, encode};

    fn picture(folder: &Path, name: &str, pixel: [f32; 3]) -> PathBuf {
        let image = Image::filled(8, 4, &pixel).unwrap();
        let path = folder.join(name);
        let format = Format::from_extension(name.rsplit('.').next().unwrap()).unwrap();
        std::fs::write(&path, encode(&image, format, &EncodeOptions::default()).unwrap()).unwrap();
        path
    }

    #[test]
    fn equal_pictures_do_not_differ_and_others_do() {
        let folder = tempfile::tempdir().unwrap();
        let a = picture(folder.path(), "a.png", [0.2, 0.4, 0.6]);
        let b = picture(folder.path(), "b.png", [0.2, 0.4, 0.8]);
        let same = Difference::between(&a, &a).unwrap();
        assert_eq!((same.figures.mse, same.mean_flip(), same.share_above(0.0).unwrap()), (0.0, 0.0, 0.0));
        let other = Difference::between(&a, &b).unwrap();
        assert!((other.figures.mse - 0.04 / 3.0).abs() < 1e-7 && other.mean_flip() > 0.0);
        assert_eq!((other.share_above(50.0).unwrap(), other.share_above(51.0).unwrap()), (1.0, 0.0));
        assert_eq!(other.picture().unwrap().channels(), 3);
    }

    #[test]
    fn light_is_compared_by_shares() {
        let of = |rgb: [f32; 3]| Image::filled(2, 2, &rgb).unwrap();
        let (a, b) = (of([0.2, 0.4, 6.0]), of([0.2, 0.4, 2.0]));
        let same = LightDifference::between(&a, &a).unwrap();
        assert_eq!((same.figures.max_abs, same.map.rgb(1, 1)), (0.0, magma(0.0)));
        let other = LightDifference::between(&a, &b).unwrap();
        assert_eq!((other.figures.max_abs, other.map.rgb(0, 1)), (4.0, magma(4.0 / 9.2)));
        let black = LightDifference::between(&a, &of([0.0; 3])).unwrap();
        assert_eq!(black.map.rgb(0, 0), magma(1.0));
        assert!(LightDifference::between(&a, &Image::filled(1, 1, &[0.0; 3]).unwrap()).is_err());
    }

    #[test]
    fn float_pictures_are_compared_too() {
        let folder = tempfile::tempdir().unwrap();
        let a = picture(folder.path(), "a.exr", [0.2, 0.4, 6.0]);
        let b = picture(folder.path(), "b.pfm", [0.2, 0.4, 6.0]);
        assert_eq!(Difference::between(&a, &b).unwrap().figures.max_abs, 0.0);
    }

    #[test]
    fn what_is_no_picture_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let text = folder.path().join("scene.txt");
        std::fs::write(&text, "Group {}").unwrap();
        assert!(matches!(read_picture(&text), Err(CompareError::Decode { .. })));
        assert!(matches!(read_picture(folder.path()), Err(CompareError::Read { .. })));
        assert!(matches!(read_picture(&folder.path().join("x.png")), Err(CompareError::Read { .. })));
        assert_eq!(read_regular(&text, 7).unwrap_err().kind(), io::ErrorKind::FileTooLarge);
    }
}
