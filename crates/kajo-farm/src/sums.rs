//! What the units of one tile brought so far, as one file.
//!
//! | bytes | what |
//! |---|---|
//! | 8, 4 | `kajosums` and the version of the format |
//! | 32 | BLAKE3 of the plan |
//! | 8 | the tile |
//! | 8, then 44 each | units in it: stage, unit, digest of the part |
//! | 8, n | length of the film's sums, and these, see [`Film::save`] |
//! | 32 | BLAKE3 of everything before |
//!
//! Numbers are little-endian. Digests stay, so that a late second copy of a unit's result can still be compared.

use std::collections::BTreeMap;

use kajo::{Film, SplitRender};

use crate::FarmError;
use crate::part::{PartError, Reader};

const MAGIC: &[u8; 8] = b"kajosums";
const VERSION: u32 = 1;
const HASH: usize = 32;

/// The sum of some units' results.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct TileSums {
    /// The digests of the parts that are in it, by stage and unit.
    pub units: BTreeMap<(u32, u64), [u8; HASH]>,
    /// The film's bytes.
    film: Vec<u8>,
}

impl TileSums {
    /// * `units`: in the film, with the digests of their parts
    pub fn new(units: BTreeMap<(u32, u64), [u8; HASH]>, film: &Film) -> Result<TileSums, FarmError> {
        let mut bytes = Vec::new();
        film.save(1, &mut bytes).map_err(|error| FarmError::Input(error.to_string()))?;
        Ok(TileSums { units, film: bytes })
    }

    pub fn bytes(&self, plan: &[u8; HASH], tile: u64) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(self.film.len() + 44 * self.units.len() + 128);
        bytes.extend(MAGIC);
        bytes.extend(VERSION.to_le_bytes());
        bytes.extend(plan);
        bytes.extend(tile.to_le_bytes());
        bytes.extend((self.units.len() as u64).to_le_bytes());
        for ((stage, unit), digest) in &self.units {
            bytes.extend(stage.to_le_bytes());
            bytes.extend(unit.to_le_bytes());
            bytes.extend(digest);
        }
        bytes.extend((self.film.len() as u64).to_le_bytes());
        bytes.extend(&self.film);
        bytes.extend(*blake3::hash(&bytes).as_bytes());
        bytes
    }

    pub fn read(bytes: &[u8], plan: &[u8; HASH], tile: u64) -> Result<TileSums, PartError> {
        let (body, hash) = bytes.split_last_chunk::<HASH>().ok_or(PartError::Damaged)?;
        if blake3::hash(body) != *hash {
            return Err(PartError::Damaged);
        }
        let mut rest = Reader(body);
        if rest.take()? != *MAGIC || u32::from_le_bytes(rest.take()?) != VERSION {
            return Err(PartError::Damaged);
        }
        if rest.take()? != *plan {
            return Err(PartError::OtherPlan);
        }
        if u64::from_le_bytes(rest.take()?) != tile {
            return Err(PartError::Damaged);
        }
        let count = u64::from_le_bytes(rest.take()?);
        let mut units = BTreeMap::new();
        for _ in 0..count {
            let key = (u32::from_le_bytes(rest.take()?), u64::from_le_bytes(rest.take()?));
            units.insert(key, rest.take()?);
        }
        let length = usize::try_from(u64::from_le_bytes(rest.take()?)).map_err(|_| PartError::Damaged)?;
        let film = rest.skip(length)?.to_vec();
        if rest.0.is_empty() { Ok(TileSums { units, film }) } else { Err(PartError::Damaged) }
    }

    pub fn film(&self, split: &SplitRender<'_>) -> Result<Film, PartError> {
        let mut rest = &self.film[..];
        let film = split.restore_film(&mut rest).map_err(|_| PartError::Damaged)?;
        if rest.is_empty() { Ok(film) } else { Err(PartError::Damaged) }
    }
}
