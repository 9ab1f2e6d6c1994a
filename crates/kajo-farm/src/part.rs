//! The result of a unit as bytes.
//!
//! | bytes | what |
//! |---|---|
//! | 8, 4 | `kajopart` and the version of the format |
//! | 32 | BLAKE3 of the plan |
//! | 4, 8 | stage and unit |
//! | 8, n | length of the film's sums, and these, see [`Film::save`] |
//! | 32 | BLAKE3 of everything before: equal for equal results |
//! | 2, n | length of the name of who made it, and the name |
//! | 32 | BLAKE3 of everything before |
//!
//! Numbers are little-endian.

use kajo::{Film, SplitRender};

use crate::FarmError;

const MAGIC: &[u8; 8] = b"kajopart";
const VERSION: u32 = 1;
const HASH: usize = 32;

/// The result of a unit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Part {
    /// The stage.
    pub stage: u32,
    /// The unit.
    pub unit: u64,
    /// Equal for equal results.
    pub digest: [u8; HASH],
    /// Who made it.
    pub host: String,
    bytes: Vec<u8>,
    /// Where the film's bytes are.
    film: std::ops::Range<usize>,
}

/// Why bytes are no part.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PartError {
    /// Something is missing or wrong.
    #[error("it is damaged")]
    Damaged,
    /// It belongs elsewhere.
    #[error("it belongs to another plan")]
    OtherPlan,
}

impl Part {
    /// The result of a unit.
    ///
    /// * `plan`: the plan's hash
    ///
    /// # Errors
    /// When there is no memory for it.
    pub fn new(
        plan: &[u8; HASH],
        (stage, unit): (u32, u64),
        film: &Film,
        host: &str,
    ) -> Result<Part, FarmError> {
        let mut sums = Vec::new();
        film.save(1, &mut sums).map_err(|error| FarmError::Input(error.to_string()))?;
        let mut bytes = Vec::with_capacity(sums.len() + 512);
        bytes.extend(MAGIC);
        bytes.extend(VERSION.to_le_bytes());
        bytes.extend(plan);
        bytes.extend(stage.to_le_bytes());
        bytes.extend(unit.to_le_bytes());
        bytes.extend((sums.len() as u64).to_le_bytes());
        let film = bytes.len()..bytes.len() + sums.len();
        bytes.extend(sums);
        let digest = *blake3::hash(&bytes).as_bytes();
        bytes.extend(digest);
        let host: String = host.chars().take(256).collect();
        bytes.extend((host.len() as u16).to_le_bytes());
        bytes.extend(host.as_bytes());
        bytes.extend(*blake3::hash(&bytes).as_bytes());
        Ok(Part { stage, unit, digest, host, bytes, film })
    }

    /// Reads a part of this plan.
    ///
    /// # Errors
    /// [`PartError`]; every changed bit is found.
    pub fn read(bytes: Vec<u8>, plan: &[u8; HASH]) -> Result<Part, PartError> {
        let damaged = PartError::Damaged;
        let body = bytes.len().checked_sub(HASH).ok_or(damaged)?;
        let (body, hash) = bytes.split_at(body);
        if blake3::hash(body) != *hash.first_chunk::<HASH>().ok_or(damaged)? {
            return Err(damaged);
        }
        let mut rest = Reader(body);
        if rest.take()? != *MAGIC || u32::from_le_bytes(rest.take()?) != VERSION {
            return Err(damaged);
        }
        if rest.take()? != *plan {
            return Err(PartError::OtherPlan);
        }
        let (stage, unit) = (u32::from_le_bytes(rest.take()?), u64::from_le_bytes(rest.take()?));
        let length = usize::try_from(u64::from_le_bytes(rest.take()?)).map_err(|_| damaged)?;
        let start = body.len() - rest.0.len();
        rest.skip(length)?;
        let film = start..start + length;
        let digest = rest.take()?;
        if blake3::hash(&body[..film.end]) != digest {
            return Err(damaged);
        }
        let length = usize::from(u16::from_le_bytes(rest.take()?));
        let host = String::from_utf8(rest.0.get(..length).ok_or(damaged)?.to_vec()).map_err(|_| damaged)?;
        Ok(Part { stage, unit, digest, host, film, bytes })
    }

    /// All of it, for a file.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// The sums.
    ///
    /// # Errors
    /// [`PartError::Damaged`] when they are no film of this split.
    pub fn film(&self, split: &SplitRender<'_>) -> Result<Film, PartError> {
        let mut rest = &self.bytes[self.film.clone()];
        let film = split.restore_film(&mut rest).map_err(|_| PartError::Damaged)?;
        if rest.is_empty() { Ok(film) } else { Err(PartError::Damaged) }
    }
}

/// Takes bytes from the front.
pub(crate) struct Reader<'a>(pub &'a [u8]);

impl<'a> Reader<'a> {
    pub fn take<const N: usize>(&mut self) -> Result<[u8; N], PartError> {
        let (first, rest) = self.0.split_first_chunk().ok_or(PartError::Damaged)?;
        self.0 = rest;
        Ok(*first)
    }

    pub fn skip(&mut self, n: usize) -> Result<&'a [u8], PartError> {
        let (first, rest) = self.0.split_at_checked(n).ok_or(PartError::Damaged)?;
        self.0 = rest;
        Ok(first)
    }
}
