//! Vertices that lie at the same place made one.

use crate::memory_budget::OverBudget;
use crate::read_memory::ReadMemory;
use kajo_math::rng::mix;
use std::collections::HashMap;
use std::hash::{BuildHasher, Hasher, RandomState};

/// Points by their position, in the order in which they were first seen.
pub(crate) struct Weld {
    pub positions: Vec<[f32; 3]>,
    numbers: HashMap<(u64, u32), u32, Keyed>,
}

impl Weld {
    pub fn new() -> Weld {
        // A secret key: nobody can write a file whose points all fall into the same place of the table.
        let key = RandomState::new().hash_one(0);
        Weld { positions: Vec::new(), numbers: HashMap::with_hasher(Keyed { key }) }
    }

    /// Makes room for `more` points.
    pub fn room(&mut self, more: usize, memory: &mut ReadMemory) -> Result<(), OverBudget> {
        /// A key with its number, in a table that is between seven eighths and seven sixteenths full.
        const BYTES_PER_POINT: usize = 2 * (size_of::<((u64, u32), u32)>() + 1);
        memory.room(&mut self.positions, more)?;
        let (len, capacity) = (self.numbers.len(), self.numbers.capacity());
        if capacity - len < more {
            // The old table stays while the new one is filled.
            let wanted = more.max(len).max(16);
            memory.take(wanted.saturating_mul(BYTES_PER_POINT))?;
            self.numbers.reserve(wanted);
        }
        Ok(())
    }

    /// The number of the point at this position, a new one if there was none. The two zeros are one.
    pub fn number(&mut self, position: [f32; 3]) -> u32 {
        let [x, y, z] = position.map(|x| (x + 0.0).to_bits());
        let next = self.positions.len() as u32;
        let number = *self.numbers.entry((u64::from(x) | u64::from(y) << 32, z)).or_insert(next);
        if number == next {
            self.positions.push(position);
        }
        number
    }
}

struct Keyed {
    key: u64,
}

impl BuildHasher for Keyed {
    type Hasher = Mixer;

    fn build_hasher(&self) -> Mixer {
        Mixer(self.key)
    }
}

/// Mixes the words of a key one after the other.
struct Mixer(u64);

impl Hasher for Mixer {
    fn finish(&self) -> u64 {
        self.0
    }

    fn write(&mut self, bytes: &[u8]) {
        bytes.iter().for_each(|&byte| self.write_u64(byte.into()));
    }

    #[inline]
    fn write_u64(&mut self, word: u64) {
        self.0 = mix(self.0 ^ word);
    }

    #[inline]
    fn write_u32(&mut self, word: u32) {
        self.write_u64(word.into());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_points_are_one_and_others_are_not() {
        let mut weld = Weld::new();
        let points = [
            [0.0, 1.0, 2.0],
            [1.0, 0.0, 2.0],
            [0.0, 1.0, 2.0],
            [-0.0, 1.0, 2.0],
            [f32::NAN; 3],
            [f32::NAN; 3],
        ];
        let numbers: Vec<u32> = points.into_iter().map(|p| weld.number(p)).collect();
        assert_eq!(numbers, [0, 1, 0, 0, 2, 2]);
        assert_eq!(weld.positions.len(), 3);
    }
}
