//! A film as bytes, for checkpoints.
//!
//! For each block, row by row: what camera rays brought, after a byte that is 1 when there is something, and the
//! splats likewise. Sums are written in the least number of bytes that holds all numbers of an array, little-endian,
//! after a byte with that number. How long an array is follows from the [`FilmSpec`], so that nothing is allocated by
//! what a file says.

use std::io::{self, ErrorKind, Read, Write};
use std::sync::atomic::Ordering;

use super::{Block, Camera, Film, FilmError, FilmSpec, Layer, splats::SplatSums, sums::Sums};

impl Film {
    /// Writes all sums.
    ///
    /// # Errors
    /// Those of `out`; and `InvalidInput` for a film made for one pass, which has no sums.
    pub fn save(&self, out: &mut dyn Write) -> io::Result<()> {
        if !self.spec.keeps_sums() {
            return Err(io::Error::new(ErrorKind::InvalidInput, "the film keeps no sums"));
        }
        out.write_all(&self.samples().to_le_bytes())?;
        out.write_all(&self.non_finite().to_le_bytes())?;
        let mut result = Ok(());
        self.for_each_block(|_, block| {
            if result.is_ok() {
                result = save_block(block, out);
            }
        });
        result
    }

    /// Reads what [`Film::save`] wrote of a film of this kind.
    ///
    /// # Errors
    /// Those of `input`; `InvalidData` when it holds something else; and as [`Film::new`].
    pub fn restore(spec: FilmSpec, budget: u64, input: &mut dyn Read) -> io::Result<Film> {
        let film = Film::new(spec, budget).map_err(|error: FilmError| io::Error::other(error.to_string()))?;
        film.samples.store(u64::from_le_bytes(bytes(input)?), Ordering::Relaxed);
        film.non_finite.store(u64::from_le_bytes(bytes(input)?), Ordering::Relaxed);
        for row in 0..film.grid.rows() {
            for column in 0..film.grid.columns() {
                let rect = film.grid.cell(column, row);
                let mut block = film.block(column, row);
                if flag(input)? {
                    let mut sums = Sums::empty(&spec);
                    sums.reset(rect);
                    sums.restore(input)?;
                    block.camera = Camera::Open(Box::new(sums));
                }
                if flag(input)? {
                    let mut splats = SplatSums::new(rect, spec.layers.has(Layer::Variance));
                    splats.restore(input)?;
                    block.splats = Some(Box::new(splats));
                }
            }
        }
        Ok(film)
    }
}

fn save_block(block: &Block, out: &mut dyn Write) -> io::Result<()> {
    match &block.camera {
        Camera::Open(sums) => {
            out.write_all(&[1])?;
            sums.save(out)?;
        }
        Camera::Empty | Camera::Finished(_) => out.write_all(&[0])?,
    }
    match &block.splats {
        Some(splats) => {
            out.write_all(&[1])?;
            splats.save(out)
        }
        None => out.write_all(&[0]),
    }
}

/// Writes numbers in as few bytes each as the largest needs.
pub(crate) fn save_numbers(
    numbers: impl Iterator<Item = i128> + Clone,
    out: &mut dyn Write,
) -> io::Result<()> {
    // The sign needs a bit too.
    let bits = |n: i128| 129 - (n ^ (n >> 127)).leading_zeros();
    let width = numbers.clone().map(bits).max().unwrap_or(0).div_ceil(8) as usize;
    let mut buffer = vec![width as u8];
    for number in numbers {
        buffer.extend_from_slice(&number.to_le_bytes()[..width]);
    }
    out.write_all(&buffer)
}

/// Reads `count` numbers that [`save_numbers`] wrote, and hands each with its index to `put`.
pub(crate) fn restore_numbers(
    count: usize,
    input: &mut dyn Read,
    mut put: impl FnMut(usize, i128) -> io::Result<()>,
) -> io::Result<()> {
    /// Numbers that are read at once, so that a false count takes no memory.
    const CHUNK: usize = 1 << 12;
    let [width] = bytes(input)?;
    let width = usize::from(width);
    if width > 16 || (width == 0 && count > 0) {
        return Err(invalid());
    }
    let mut buffer = vec![0; width * CHUNK];
    for start in (0..count).step_by(CHUNK) {
        let chunk = &mut buffer[..width * CHUNK.min(count - start)];
        input.read_exact(chunk)?;
        for (i, low) in (start..).zip(chunk.chunks_exact(width)) {
            let negative = low.last().is_some_and(|&high| high >= 0x80);
            let mut bytes = [if negative { 0xFF } else { 0 }; 16];
            bytes[..width].copy_from_slice(low);
            put(i, i128::from_le_bytes(bytes))?;
        }
    }
    Ok(())
}

/// As [`restore_numbers`] into an array of integers, which must hold them.
pub(crate) fn restore_array<T: TryFrom<i128>>(array: &mut [T], input: &mut dyn Read) -> io::Result<()> {
    restore_numbers(array.len(), input, |i, number| {
        array[i] = number.try_into().map_err(|_| invalid())?;
        Ok(())
    })
}

pub(crate) fn flag(input: &mut dyn Read) -> io::Result<bool> {
    match bytes(input)? {
        [0] => Ok(false),
        [1] => Ok(true),
        _ => Err(invalid()),
    }
}

fn bytes<const N: usize>(input: &mut dyn Read) -> io::Result<[u8; N]> {
    let mut bytes = [0; N];
    input.read_exact(&mut bytes)?;
    Ok(bytes)
}

pub(crate) fn invalid() -> io::Error {
    io::Error::new(ErrorKind::InvalidData, "these are not the sums of such a film")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_come_back_in_as_few_bytes_as_they_need() {
        for (numbers, width) in [
            (vec![0, 0, 0], 1),
            (vec![127, -128], 1),
            (vec![128], 2),
            (vec![-129, 5], 2),
            (vec![i128::MAX, i128::MIN, -1], 16),
            (vec![], 0),
        ] {
            let mut saved = Vec::new();
            save_numbers(numbers.iter().copied(), &mut saved).expect("memory does not fail");
            assert_eq!(saved.len(), 1 + width * numbers.len(), "{numbers:?}");
            let mut restored = vec![7i128; numbers.len()];
            restore_array(&mut restored, &mut &saved[..]).expect("as it was written");
            assert_eq!(restored, numbers);
        }
        let mut small = [0u8; 1];
        assert!(restore_array(&mut small, &mut &[2, 0, 1][..]).is_err(), "256 is no byte");
        assert!(restore_array(&mut small, &mut &[17, 0][..]).is_err());
        assert!(restore_array(&mut small, &mut &[0][..]).is_err());
        assert!(restore_array(&mut small, &mut &[1][..]).is_err(), "the end is missing");
    }
}
