//! Files that are read piece by piece, so that no number in one can ask for more memory than the file has bytes.

use std::io::{ErrorKind, Read};

use kajo_math::half;
use kajo_scene::{AssetError, Limits, MemoryShare};

use super::error::BtfError;

/// How a number is stored, little end first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scalar {
    /// 16 bits.
    Half,
    /// 32 bits.
    Float,
    /// 64 bits.
    Double,
}

impl Scalar {
    pub fn bytes(self) -> usize {
        match self {
            Scalar::Half => 2,
            Scalar::Float => 4,
            Scalar::Double => 8,
        }
    }

    /// The number in as many bytes.
    fn value(self, bytes: &[u8]) -> f32 {
        match (self, bytes) {
            (Scalar::Half, &[a, b]) => half::to_f32(u16::from_le_bytes([a, b])),
            (Scalar::Float, &[a, b, c, d]) => f32::from_le_bytes([a, b, c, d]),
            (Scalar::Double, &[a, b, c, d, e, f, g, h]) => {
                f64::from_le_bytes([a, b, c, d, e, f, g, h]) as f32
            }
            _ => f32::NAN,
        }
    }
}

/// A file that is read piece by piece, and the memory of what was read.
pub(super) struct Reader<'l, R> {
    pub file: R,
    limits: &'l Limits,
    pub memory: MemoryShare,
    /// Bytes read.
    position: u64,
}

impl<'l, R: Read> Reader<'l, R> {
    /// * `len`: bytes of the file, where that is known
    ///
    /// # Errors
    /// [`BtfError::Asset`], for one that is too large.
    pub fn new(file: R, len: Option<u64>, limits: &'l Limits) -> Result<Reader<'l, R>, BtfError> {
        let limit = limits.mesh_bytes;
        if len.is_some_and(|len| len > limit) {
            return Err(AssetError::TooLarge { limit }.into());
        }
        Ok(Reader { file, limits, memory: limits.memory.share(0)?, position: 0 })
    }

    /// Bytes read so far.
    pub fn position(&self) -> u64 {
        self.position
    }

    /// Fills `bytes`, which are of the `part` of a file.
    pub fn bytes(&mut self, bytes: &mut [u8], part: &'static str) -> Result<(), BtfError> {
        let limit = self.limits.mesh_bytes;
        self.position = self.position.saturating_add(bytes.len() as u64);
        if self.position > limit {
            return Err(AssetError::TooLarge { limit }.into());
        }
        match self.file.read_exact(bytes) {
            Ok(()) => Ok(()),
            Err(error) if error.kind() == ErrorKind::UnexpectedEof => Err(BtfError::Short(part)),
            Err(error) => Err(AssetError::from(error).into()),
        }
    }

    pub fn byte(&mut self, part: &'static str) -> Result<u8, BtfError> {
        let mut byte = [0];
        self.bytes(&mut byte, part)?;
        Ok(byte[0])
    }

    pub fn whole(&mut self, part: &'static str) -> Result<u32, BtfError> {
        let mut bytes = [0; 4];
        self.bytes(&mut bytes, part)?;
        Ok(u32::from_le_bytes(bytes))
    }

    /// Passes over bytes.
    pub fn skip(&mut self, count: u64, part: &'static str) -> Result<(), BtfError> {
        let mut buffer = [0; 1 << 12];
        let mut left = count;
        while left > 0 {
            let piece = left.min(buffer.len() as u64);
            self.bytes(&mut buffer[..piece as usize], part)?;
            left -= piece;
        }
        Ok(())
    }

    /// Refuses a file that goes on.
    pub fn end(&mut self) -> Result<(), BtfError> {
        match self.bytes(&mut [0], "end") {
            Err(BtfError::Short(_)) => Ok(()),
            Err(error) => Err(error),
            Ok(()) => Err(BtfError::Long),
        }
    }

    /// Room for `piece` more of a list that still lacks `left`, which includes these.
    pub fn room<T>(&mut self, list: &mut Vec<T>, piece: usize, left: u64) -> Result<(), BtfError> {
        if list.capacity() - list.len() < piece {
            let more = (list.len() / 4).max(piece).min(usize::try_from(left).unwrap_or(usize::MAX));
            let bytes = (more * size_of::<T>()) as u64;
            self.memory.grow(bytes)?;
            list.try_reserve_exact(more).map_err(|_| self.limits.memory.exceeded(bytes))?;
        }
        Ok(())
    }

    /// `count` values appended to a list that lacks `left`, which includes these.
    pub fn values(
        &mut self,
        list: &mut Vec<f32>,
        [count, left]: [u64; 2],
        scalar: Scalar,
        part: &'static str,
    ) -> Result<(), BtfError> {
        /// Numbers that are read at once.
        const PIECE: usize = 1 << 10;
        let size = scalar.bytes();
        let mut buffer = [0; 8 * PIECE];
        let mut read = 0;
        while read < count {
            let piece = (count - read).min(PIECE as u64) as usize;
            self.room(list, piece, left - read)?;
            let bytes = &mut buffer[..piece * size];
            self.bytes(bytes, part)?;
            list.extend(bytes.chunks_exact(size).map(|bytes| scalar.value(bytes)));
            read += piece as u64;
        }
        Ok(())
    }

    /// Pairs of angles.
    pub fn angles(&mut self, count: u32) -> Result<Vec<[f32; 2]>, BtfError> {
        let mut numbers = Vec::new();
        self.values(&mut numbers, [2 * u64::from(count); 2], Scalar::Float, "directions")?;
        Ok(numbers.chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect())
    }
}
