//! Files of the collection UBO2014 of the University of Bonn [Weinmann, Gall and Klein 2014]: factorised matrices.
//!
//! A value for a pair of directions and a texel is three numbers `a`, each a product of a row of a matrix `U` of pairs and a row of a
//! matrix `W` of texels, of which a [colour model](colors) makes red, green and blue:
//!
//! ```text
//! a_c(pair, texel) = Σ_k U_c(pair, k) W_c(texel, k)                 pair = view · lights + light
//! ```
//!
//! In the form DFMF each number has matrices of its own, in FMF all three share `W`. Since logarithms may have been taken before, means over
//! texels are those of the colours, not of the matrices. What is before the matrices, little end first:
//!
//! ```text
//! bytes                       what
//! 8 or 9                      "!DFMF08FC", "!FMF12FCE" or "!FMF06FC"
//! 1                           "R" where rotations follow, else nothing
//! u32                         bytes of the header, from here to the views
//! u32                         its version, 1 to 4
//! 3 x 80, 4 x f32             texts about setup, sensor and light; pixels for a millimetre, a factor for each of three colours
//! u32                         from version 2: 1 if values have the cosine of the light in them
//! u32, text                   from version 3: a description
//! u32, (u32, text) each       from version 4: colour channels and their names
//! u32                         views; for each
//!   f32 f32                     angle to the normal, angle around it; radians
//!   u32, f32 f32 each           lights and their angles, the same ones for all views
//! u32 u32                     width and height in texels
//! u32, 9 x f32 each           with "R": rotations of the frame of texels
//! ```
//!
//! Then DFMF has the most components (u32), the number of the colour model (u32), a mean colour and three axes (12 f32), and for each number of a
//! colour bytes of a number (u8, 2, 4 or 8), components, rows of `U` and of `W` (u32 each), singular values, `U` and `W`, row by row. FMF has,
//! with the letter E, a version (u8), whether logarithms were taken (u32), and a map of heights (u32 u32 and halves); then components
//! (u32) and the same as DFMF once, with a row of `U` for each number of each pair. Either matrix may be that of the texels.

mod colors;
mod factors;
mod header;
#[cfg(test)]
mod tests;

use std::io::BufReader;

use kajo_scene::{AssetFile, Limits};

use super::compress::BtfSamples;
use super::error::BtfError;
use super::reader::Reader;
use factors::{Factors, Rows};
use header::{Header, content};

/// Pairs of directions whose values are worked out at once.
const PAIRS: usize = 256;

/// Reads a file of UBO2014 in the form DFMF or FMF.
///
/// Values become shares of what a white matt surface would send, over π, as those of UBO2003 are: `f` or, with the cosine, `f cos θi`; per steradian.
///
/// * `most`: texels along a side at most; of larger textures blocks are averaged
///
/// Beside the samples it takes as much memory as the matrices have as numbers of 32 bits.
///
/// # Errors
/// [`BtfError`], at the first thing that is malformed, cut off, in a form that is not read, or exceeds a limit.
pub fn read_ubo2014(file: AssetFile, limits: &Limits, most: u32) -> Result<BtfSamples, BtfError> {
    let mut reader = Reader::new(BufReader::new(file.reader), file.len, limits)?;
    let header = Header::read(&mut reader)?;
    let [width, height] = header.size;
    let block = width.max(height).div_ceil(most.max(1));
    let size = [(width / block).max(1), (height / block).max(1)];
    let n_pairs = header.views.len() * header.lights.len();
    let count = 3 * u128::from(size[0]) * u128::from(size[1]) * n_pairs as u128;
    let bytes = u64::try_from(4 * count).unwrap_or(u64::MAX);
    let _samples = limits.memory.share(bytes)?;
    let factors = Factors::read(&mut reader, &header)?;
    reader.end()?;
    let mut values = Vec::new();
    values.try_reserve_exact(count as usize).map_err(|_| limits.memory.exceeded(bytes))?;
    values.resize(count as usize, 0.0);
    for first in (0..n_pairs).step_by(PAIRS) {
        let part = Part::new(&factors, first, PAIRS.min(n_pairs - first));
        for (texel, values) in values.chunks_exact_mut(3 * n_pairs).enumerate() {
            let (column, row) = (texel as u32 % size[0], texel as u32 / size[0]);
            part.mean(&header, [column, row].map(|i| i * block), block, &mut values[3 * first..])?;
        }
    }
    let Header { views, lights, has_cosine, .. } = header;
    Ok(BtfSamples { size, views, lights, has_cosine, values })
}

/// Some pairs of directions in a row.
struct Part<'a> {
    first: usize,
    count: usize,
    /// For each number of a colour its components, each of all pairs.
    columns: [Vec<f32>; 3],
    texels: [Rows<'a>; 3],
}

impl<'a> Part<'a> {
    fn new(factors: &'a Factors, first: usize, count: usize) -> Part<'a> {
        let columns = [0, 1, 2].map(|channel| {
            let [pairs, _] = factors.channel(channel);
            let column = |k: usize| (first..first + count).map(move |pair| pairs.row(pair)[k]);
            (0..pairs.components).flat_map(column).collect()
        });
        Part { first, count, columns, texels: [0, 1, 2].map(|channel| factors.channel(channel)[1]) }
    }

    /// The means of colours over a block of texels, for each pair.
    ///
    /// * `corner`: column and row of its first texel
    /// * `means`: receives red, green and blue of each pair, per steradian
    fn mean(&self, header: &Header, corner: [u32; 2], block: u32, means: &mut [f32]) -> Result<(), BtfError> {
        let [x1, y1] = [0, 1].map(|i| (corner[i] + block).min(header.size[i]));
        let mut sums = [[0.0f64; 3]; PAIRS];
        let mut numbers = [[0.0f32; PAIRS]; 3];
        for (x, y) in (corner[1]..y1).flat_map(|y| (corner[0]..x1).map(move |x| (x, y))) {
            let texel = y as usize * header.size[0] as usize + x as usize;
            for (channel, numbers) in numbers.iter_mut().enumerate() {
                self.multiply(channel, texel, &mut numbers[..self.count]);
            }
            for (i, sum) in sums[..self.count].iter_mut().enumerate() {
                let rgb = header.color_model.rgb([numbers[0][i], numbers[1][i], numbers[2][i]]);
                if !rgb.iter().all(|v| v.is_finite()) {
                    let (pair, lights) = (self.first + i, header.lights.len());
                    let (view, light) = (pair / lights, pair % lights);
                    return Err(content(format!(
                        "its value at texel {x} {y} for view {view} and light {light} is not finite"
                    )));
                }
                *sum = [0, 1, 2].map(|c| sum[c] + f64::from(rgb[c]));
            }
        }
        let count = f64::from(x1 - corner[0]) * f64::from(y1 - corner[1]);
        for (to, sum) in means.chunks_exact_mut(3).zip(&sums[..self.count]) {
            to.copy_from_slice(&sum.map(|v| (v / count * std::f64::consts::FRAC_1_PI) as f32));
        }
        Ok(())
    }

    /// One of three numbers at a texel, for each pair.
    fn multiply(&self, channel: usize, texel: usize, products: &mut [f32]) {
        products.fill(0.0);
        let columns = self.columns[channel].chunks_exact(self.count);
        for (column, &weight) in columns.zip(self.texels[channel].row(texel)) {
            products.iter_mut().zip(column).for_each(|(sum, &v)| *sum += weight * v);
        }
    }
}
