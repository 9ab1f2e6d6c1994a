//! Pictures rendered at three times their size, three by three pixels of which become one.
//!
//! The programs of one course take nine rays for a pixel so. Their filter is binomial, `(1 2 1)/4` across and down:
//!
//! ```text
//!   1 2 1
//!   2 4 2  / 16
//!   1 2 1
//! ```

use kajo_image::{Image, ImageError};

/// Columns and rows that become one.
pub(crate) const SIDE: u32 = 3;

/// How three by three pixels become one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reduction {
    /// By their mean.
    Mean,
    /// Weighed by 1 2 1 on each axis.
    Binomial,
}

impl Reduction {
    /// The picture whose pixels are made of those of `image`, whose sides are multiples of three.
    pub(crate) fn reduce(self, image: &Image) -> Result<Image, ImageError> {
        let weights = match self {
            Reduction::Mean => [1.0, 1.0, 1.0],
            Reduction::Binomial => [1.0, 2.0, 1.0],
        };
        let whole: f32 = weights.iter().sum::<f32>() * weights.iter().sum::<f32>();
        let mut result = Image::new(image.width() / SIDE, image.height() / SIDE, image.channels())?;
        for y in 0..result.height() {
            for x in 0..result.width() {
                for (dy, wy) in (0..).zip(weights) {
                    for (dx, wx) in (0..).zip(weights) {
                        let from = image.pixel(SIDE * x + dx, SIDE * y + dy);
                        let to = result.pixel_mut(x, y);
                        to.iter_mut().zip(from).for_each(|(to, v)| *to += wx * wy * v);
                    }
                }
                result.pixel_mut(x, y).iter_mut().for_each(|v| *v /= whole);
            }
        }
        Ok(result)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_by_hand() {
        let image = Image::from_fn(6, 3, |x, y| [f32::from(u8::from((x, y) == (4, 0))), 2.0]).unwrap();
        let binomial = Reduction::Binomial.reduce(&image).unwrap();
        assert_eq!((binomial.width(), binomial.height()), (2, 1));
        assert_eq!(binomial.data(), [0.0, 2.0, 0.125, 2.0]);
        let mean = Reduction::Mean.reduce(&image).unwrap();
        assert_eq!(mean.data(), [0.0, 2.0, 1.0 / 9.0, 2.0]);
    }
}
