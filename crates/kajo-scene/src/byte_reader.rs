//! Bytes of mesh files, read in pieces.
//!
//! The buffer holds what is unread. It grows to the longest run of bytes that
//! a reader must see at once; the file itself is never held.

use crate::assets::AssetError;
use crate::limits::Limits;
use crate::mesh_file_error::MeshFileError;
use std::io::{ErrorKind, Read};

/// A stream of bytes with a buffer in front.
pub(crate) struct ByteReader<'l, R> {
    reader: R,
    pub path: &'l str,
    pub limits: &'l Limits,
    buffer: Vec<u8>,
    /// The unread part of the buffer.
    start: usize,
    end: usize,
    at_end: bool,
    bytes_read: u64,
}

impl<'l, R: Read> ByteReader<'l, R> {
    const CHUNK: usize = 256 << 10;

    pub fn new(reader: R, path: &'l str, limits: &'l Limits) -> Self {
        Self { reader, path, limits, buffer: Vec::new(), start: 0, end: 0, at_end: false, bytes_read: 0 }
    }

    /// Bytes that are at hand.
    #[inline]
    pub fn unread(&self) -> &[u8] {
        &self.buffer[self.start..self.end]
    }

    #[inline]
    pub fn unread_mut(&mut self) -> &mut [u8] {
        &mut self.buffer[self.start..self.end]
    }

    /// Whether nothing more will come than is at hand.
    pub fn at_end(&self) -> bool {
        self.at_end
    }

    /// Steps over `n` of the bytes at hand.
    #[inline]
    pub fn consume(&mut self, n: usize) {
        self.start = (self.start + n).min(self.end);
    }

    /// The first `len` bytes at hand, after stepping over `consumed` of them.
    #[inline]
    pub fn take(&mut self, len: usize, consumed: usize) -> &[u8] {
        let start = self.start;
        self.consume(consumed);
        &self.buffer[start..start + len]
    }

    /// The last `n` bytes that were stepped over; they are kept until more is read.
    pub fn before(&self, n: usize) -> &[u8] {
        &self.buffer[self.start - n..self.start]
    }

    /// The bytes at hand after it was tried to have `n` of them: fewer only at the end of the file.
    #[inline]
    pub fn at_least(&mut self, n: usize) -> Result<&[u8], MeshFileError> {
        while self.end - self.start < n && !self.at_end {
            self.fill()?;
        }
        Ok(self.unread())
    }

    /// Steps over `n` bytes, at hand or not; `false` when the file ends before.
    pub fn skip(&mut self, mut n: u64) -> Result<bool, MeshFileError> {
        loop {
            let step = n.min((self.end - self.start) as u64);
            self.consume(step as usize);
            n -= step;
            if n == 0 || self.at_end {
                return Ok(n == 0);
            }
            self.fill()?;
        }
    }

    /// Reads more bytes behind the unread ones.
    pub fn fill(&mut self) -> Result<(), MeshFileError> {
        self.buffer.copy_within(self.start..self.end, 0);
        self.end -= self.start;
        self.start = 0;
        if self.buffer.len() < self.end + Self::CHUNK {
            self.buffer.resize(self.end + Self::CHUNK, 0);
        }
        let read = loop {
            match self.reader.read(&mut self.buffer[self.end..]) {
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                result => break result.map_err(|error| self.unreadable(error.into()))?,
            }
        };
        self.at_end = read == 0;
        self.end += read;
        self.bytes_read += read as u64;
        if self.bytes_read > self.limits.mesh_bytes {
            return Err(self.unreadable(AssetError::TooLarge { limit: self.limits.mesh_bytes }));
        }
        Ok(())
    }

    /// A mistake at the first unread byte.
    pub fn mistake(&self, message: impl Into<String>) -> MeshFileError {
        let byte = self.bytes_read - (self.end - self.start) as u64;
        MeshFileError::Bytes { path: self.path.to_owned(), byte, message: message.into() }
    }

    fn unreadable(&self, source: AssetError) -> MeshFileError {
        MeshFileError::Read { path: self.path.to_owned(), source }
    }
}
