//! Numbers of sums in as few bytes as they need.

use std::io::{self, ErrorKind, Read};

/// Writes numbers in as few bytes each as the largest needs.
pub(crate) fn save_numbers(numbers: impl Iterator<Item = i128> + Clone, out: &mut Vec<u8>) {
    const WHOLE: usize = size_of::<i128>();
    let (count, set) = numbers.clone().fold((0, 0), |(count, set), n| (count + 1, set | n ^ (n >> 127)));
    // The sign needs a bit too.
    let bits = if count == 0 { 0 } else { 129 - set.leading_zeros() };
    let width = bits.div_ceil(8) as usize;
    out.push(width as u8);
    // Each number is written whole, and the next one over what it has too much.
    let mut at = out.len();
    out.resize(at + count * width + WHOLE, 0);
    for number in numbers {
        out[at..at + WHOLE].copy_from_slice(&number.to_le_bytes());
        at += width;
    }
    out.truncate(at);
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

pub(crate) fn bytes<const N: usize>(input: &mut dyn Read) -> io::Result<[u8; N]> {
    let mut bytes = [0; N];
    input.read_exact(&mut bytes)?;
    Ok(bytes)
}

pub(crate) fn flag(input: &mut dyn Read) -> io::Result<bool> {
    match bytes(input)? {
        [0] => Ok(false),
        [1] => Ok(true),
        _ => Err(invalid()),
    }
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
            let mut saved = vec![7];
            save_numbers(numbers.iter().copied(), &mut saved);
            assert_eq!(saved.remove(0), 7, "what was there stays");
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
