//! Arrays of numbers, as they are or compressed.

use kajo_math::half;

use super::blosc;
use super::header::{Number, Stored};
use super::input::Input;
use super::zip::{damaged, unzip};
use crate::volume::VolumeError;

const ZIP: u32 = 1;
const ACTIVE_MASK: u32 = 2;
const BLOSC: u32 = 4;

/// How a grid stores its numbers.
#[derive(Clone, Copy, Debug)]
pub struct Codec {
    compression: u32,
    stored: Stored,
}

/// Room for the bytes of an array, which is used again.
#[derive(Default)]
pub struct Room {
    packed: Vec<u8>,
    bytes: Vec<u8>,
    /// The numbers of the last array.
    pub numbers: Vec<f32>,
}

impl Codec {
    pub fn new(compression: u32, stored: Stored) -> Result<Codec, VolumeError> {
        if compression & !(ZIP | ACTIVE_MASK | BLOSC) != 0 {
            return Err(VolumeError::Content(format!("its compression {compression} is not known")));
        }
        Ok(Codec { compression, stored })
    }

    /// Whether nodes leave out values of voxels that are not active.
    pub fn masks(&self) -> bool {
        self.compression & ACTIVE_MASK != 0
    }

    /// The numbers of one value, uncompressed and as the tree has them.
    pub fn value(&self, input: &mut Input) -> Result<[f32; 3], VolumeError> {
        let mut value = [0.0; 3];
        for number in &mut value[..self.stored.channels] {
            *number = match self.stored.number {
                Number::Half => half::to_f32(input.u16()?),
                Number::Float => input.array().map(f32::from_le_bytes)?,
                Number::Double => input.f64()? as f32,
            };
        }
        Ok(value)
    }

    /// The numbers of an array of values, as many as a node has at most.
    pub fn values(&self, input: &mut Input, count: usize, room: &mut Room) -> Result<(), VolumeError> {
        let Stored { channels, number, is_half } = self.stored;
        room.numbers.clear();
        if is_half && count == 0 {
            return Ok(());
        }
        let width = match number {
            _ if is_half => 2,
            Number::Half => 2,
            Number::Float => 4,
            Number::Double => 8,
        };
        let bytes = count * channels * width;
        room.bytes.clear();
        room.bytes.resize(bytes, 0);
        if self.compression & (ZIP | BLOSC) == 0 {
            input.fill(&mut room.bytes)?;
        } else {
            let packed = input.i64()?;
            // What would not become shorter is stored as it is, with a negative length.
            if packed <= 0 {
                if packed.unsigned_abs() != bytes as u64 {
                    return Err(damaged());
                }
                input.fill(&mut room.bytes)?;
            } else {
                let most = bytes + blosc::OVERHEAD;
                let packed = usize::try_from(packed).ok().filter(|&n| n <= most).ok_or_else(damaged)?;
                room.packed.resize(packed, 0);
                input.fill(&mut room.packed)?;
                // Both flags at once are not written; the library looks for Blosc first.
                if self.compression & BLOSC != 0 {
                    blosc::unpack(&room.packed, &mut room.bytes)?;
                } else {
                    unzip(&room.packed, &mut room.bytes)?;
                }
            }
        }
        let numbers = room.bytes.chunks_exact(width);
        match width {
            2 => room.numbers.extend(numbers.map(|b| half::to_f32(u16::from_le_bytes([b[0], b[1]])))),
            4 => room.numbers.extend(numbers.map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]]))),
            _ => room.numbers.extend(
                numbers.map(|b| f64::from_le_bytes([b[0], b[1], b[2], b[3], b[4], b[5], b[6], b[7]]) as f32),
            ),
        }
        Ok(())
    }
}
