//! Colour models in which values are factorised.

use kajo_math::fmath;

use super::super::error::BtfError;

/// What is added before a logarithm is taken.
const EPSILON: f32 = 1e-5;

/// What the three numbers of a value mean.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum ColorModel {
    /// 0: red, green and blue.
    Rgb,
    /// 1: luminance and two colour differences.
    Yuv,
    /// 3: coordinates along the principal axes of all colours.
    Principal {
        /// The mean of all colours.
        mean: [f32; 3],
        /// The axes, one after the other.
        axes: [[f32; 3]; 3],
    },
    /// 4: luminance, and differences of orange and green.
    YCoCg,
    /// 9: the logarithm of the luminance `Y + ε`, and U and V.
    LogYuv,
    /// 10: the same, with `u` and `v` for which `U = sign(u) ε exp |u|`.
    LogYLogUv,
    /// 11: the logarithm of the luminance `Y + ε`, and U and V over the same.
    LogYRatio,
    /// 12: logarithms of red, green and blue plus ε.
    LogRgb,
}

impl ColorModel {
    /// The model of a file.
    ///
    /// * `mean`, `axes`: as the file has them, whatever the model
    ///
    /// # Errors
    /// [`BtfError::Content`], for numbers of no model that is known, or axes that are not finite.
    pub fn new(number: u32, mean: [f32; 3], axes: [[f32; 3]; 3]) -> Result<ColorModel, BtfError> {
        let is_finite = mean.iter().chain(axes.as_flattened()).all(|v| v.is_finite());
        Ok(match number {
            0 => ColorModel::Rgb,
            1 => ColorModel::Yuv,
            3 if is_finite => ColorModel::Principal { mean, axes },
            3 => return Err(BtfError::Content("its axes of colours are not finite".to_owned())),
            4 => ColorModel::YCoCg,
            9 => ColorModel::LogYuv,
            10 => ColorModel::LogYLogUv,
            11 => ColorModel::LogYRatio,
            12 => ColorModel::LogRgb,
            _ => {
                let read = "0, 1, 3, 4 and 9 to 12 are read";
                return Err(BtfError::Content(format!("its colour model has the number {number}; {read}")));
            }
        })
    }

    /// Red, green and blue, linear.
    #[inline]
    pub fn rgb(&self, value: [f32; 3]) -> [f32; 3] {
        let [a, b, c] = value;
        match self {
            ColorModel::Rgb => value,
            ColorModel::Yuv => of_yuv(value),
            ColorModel::Principal { mean, axes } => {
                [0, 1, 2].map(|i| a * axes[0][i] + b * axes[1][i] + c * axes[2][i] + mean[i])
            }
            ColorModel::YCoCg => [a + b - c, a + c, a - b - c],
            ColorModel::LogYuv => of_yuv([fmath::exp(a) - EPSILON, b, c]),
            ColorModel::LogYLogUv => {
                let grown = |v: f32| if v == 0.0 { 0.0 } else { v.signum() * EPSILON * fmath::exp(v.abs()) };
                of_yuv([fmath::exp(a) - EPSILON, grown(b), grown(c)])
            }
            ColorModel::LogYRatio => {
                let y = fmath::exp(a);
                of_yuv([y - EPSILON, b * y, c * y])
            }
            ColorModel::LogRgb => value.map(|v| fmath::exp(v) - EPSILON),
        }
    }
}

/// The colour of a luminance and two differences, with the factors of analogue television that the files are made with.
fn of_yuv([y, u, v]: [f32; 3]) -> [f32; 3] {
    [y + 1.139_83 * v, y - 0.394_65 * u - 0.580_6 * v, y + 2.032_11 * u]
}
