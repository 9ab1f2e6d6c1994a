//! The bytes of a file, from front to back.

use std::io::{BufRead, BufReader, Read, Take};

use super::zip::damaged;
use crate::assets::{AssetError, AssetFile};
use crate::limits::Limits;
use crate::memory_budget::MemoryShare;
use crate::volume::VolumeError;

/// A stream of bytes that knows how many were read.
pub(crate) struct Input {
    reader: BufReader<Take<Box<dyn Read + Send>>>,
    at: u64,
}

impl Input {
    /// * `limits`: of the bytes of a file
    pub fn new(file: AssetFile, limits: &Limits) -> Result<Input, VolumeError> {
        let limit = limits.mesh_bytes;
        if file.len.is_some_and(|len| len > limit) {
            return Err(AssetError::TooLarge { limit }.into());
        }
        Ok(Input { reader: BufReader::with_capacity(1 << 16, file.reader.take(limit)), at: 0 })
    }

    /// Fills a piece.
    pub fn fill(&mut self, piece: &mut [u8]) -> Result<(), VolumeError> {
        self.at += piece.len() as u64;
        match self.reader.read_exact(piece) {
            Ok(()) => Ok(()),
            Err(error) if error.kind() == std::io::ErrorKind::UnexpectedEof => Err(short()),
            Err(error) => Err(AssetError::from(error).into()),
        }
    }

    /// The next bytes.
    pub fn array<const N: usize>(&mut self) -> Result<[u8; N], VolumeError> {
        let mut bytes = [0; N];
        self.fill(&mut bytes)?;
        Ok(bytes)
    }

    pub fn u8(&mut self) -> Result<u8, VolumeError> {
        self.array().map(|[byte]| byte)
    }

    pub fn u16(&mut self) -> Result<u16, VolumeError> {
        self.array().map(u16::from_le_bytes)
    }

    pub fn u64(&mut self) -> Result<u64, VolumeError> {
        self.array().map(u64::from_le_bytes)
    }

    pub fn u32(&mut self) -> Result<u32, VolumeError> {
        self.array().map(u32::from_le_bytes)
    }

    pub fn i32(&mut self) -> Result<i32, VolumeError> {
        self.array().map(i32::from_le_bytes)
    }

    pub fn i64(&mut self) -> Result<i64, VolumeError> {
        self.array().map(i64::from_le_bytes)
    }

    pub fn f64(&mut self) -> Result<f64, VolumeError> {
        self.array().map(f64::from_le_bytes)
    }

    /// A text with its length in front.
    pub fn text(&mut self) -> Result<String, VolumeError> {
        let len = self.u32()?;
        self.text_of(len)
    }

    /// A text of a number of bytes.
    pub fn text_of(&mut self, len: u32) -> Result<String, VolumeError> {
        const LONGEST: u32 = 1 << 16;
        if len > LONGEST {
            return Err(VolumeError::Content(format!("a name of {len} bytes is too long")));
        }
        let mut bytes = vec![0; len as usize];
        self.fill(&mut bytes)?;
        Ok(String::from_utf8_lossy(&bytes).into_owned())
    }

    /// Many bytes, whose memory is taken piece by piece as they come.
    pub fn bytes(&mut self, count: u64, memory: &mut MemoryShare) -> Result<Vec<u8>, VolumeError> {
        const PIECE: u64 = 1 << 20;
        let mut bytes = Vec::new();
        while (bytes.len() as u64) < count {
            let start = bytes.len();
            let more = (count - start as u64).min(PIECE.max(start as u64 / 4));
            memory.grow(more)?;
            bytes.try_reserve_exact(more as usize).map_err(|_| damaged())?;
            bytes.resize(start + more as usize, 0);
            self.fill(&mut bytes[start..])?;
        }
        Ok(bytes)
    }

    /// Whether there is nothing left.
    pub fn is_at_end(&mut self) -> Result<bool, VolumeError> {
        Ok(self.reader.fill_buf().map_err(AssetError::from)?.is_empty())
    }

    /// Steps over bytes.
    pub fn skip(&mut self, count: u64) -> Result<(), VolumeError> {
        let skipped = std::io::copy(&mut self.reader.by_ref().take(count), &mut std::io::sink());
        self.at = self.at.saturating_add(count);
        match skipped {
            Ok(skipped) if skipped == count => Ok(()),
            Ok(_) => Err(short()),
            Err(error) => Err(AssetError::from(error).into()),
        }
    }

    /// Steps over what is left before a place of the file.
    pub fn skip_to(&mut self, place: u64) -> Result<(), VolumeError> {
        match place.checked_sub(self.at) {
            Some(count) => self.skip(count),
            None => Err(VolumeError::Content(format!(
                "it says that a part begins at byte {place}, which is in another one"
            ))),
        }
    }
}

fn short() -> VolumeError {
    VolumeError::Content("the file ends within a grid".to_owned())
}
