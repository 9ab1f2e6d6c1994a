//! Blocks of LZ4: sequences of literals and of copies of what came before.
//!
//! ```text
//! u8 token          count of literals (high 4 bits), length of the copy - 4 (low 4 bits)
//! u8 ...            where a count is 15: bytes that are added to it, up to the first that is not 255
//! literals
//! u16 distance      of the copy; the last sequence has none
//! u8 ...            as above, for the length of the copy
//! ```
//!
//! [Collet, LZ4].

/// Unpacks a block; `None` for one that is damaged or does not fill `out` exactly.
pub fn unpack(mut packed: &[u8], out: &mut [u8]) -> Option<()> {
    let mut at = 0;
    loop {
        let token = *packed.split_off_first()?;
        let count = length(usize::from(token >> 4), &mut packed)?;
        let literals = packed.split_off(..count)?;
        let end = at + count;
        out.get_mut(at..end)?.copy_from_slice(literals);
        at = end;
        if packed.is_empty() {
            return (at == out.len()).then_some(());
        }
        let distance =
            usize::from(u16::from_le_bytes([*packed.split_off_first()?, *packed.split_off_first()?]));
        let count = length(usize::from(token & 15), &mut packed)?.checked_add(4)?;
        let from = at.checked_sub(distance).filter(|_| distance > 0)?;
        if count > out.len() - at {
            return None;
        }
        if distance >= count {
            out.copy_within(from..from + count, at);
        } else {
            // A copy may begin before the end of what it copies, and repeat it.
            for k in 0..count {
                out[at + k] = out[from + k];
            }
        }
        at += count;
    }
}

/// A count whose first part is in a token.
fn length(first: usize, packed: &mut &[u8]) -> Option<usize> {
    let mut sum = first;
    if first == 15 {
        loop {
            let more = *packed.split_off_first()?;
            sum = sum.checked_add(more.into())?;
            if more != 255 {
                break;
            }
        }
    }
    Some(sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unpacked(packed: &[u8], len: usize) -> Option<Vec<u8>> {
        let mut out = vec![0; len];
        unpack(packed, &mut out).map(|()| out)
    }

    #[test]
    fn literals_and_copies() {
        assert_eq!(unpacked(b"\x30abc", 3).unwrap(), b"abc");
        // "ab" repeated, then a literal.
        assert_eq!(unpacked(b"\x22ab\x02\x00\x10c", 9).unwrap(), b"ababababc");
        let long = [&b"\xf0\x05"[..], &[7; 20]].concat();
        assert_eq!(unpacked(&long, 20).unwrap(), [7; 20]);
        let copied = b"\x1fa\x01\x00\xff\x01\x00";
        assert_eq!(unpacked(copied, 1 + 4 + 15 + 256).unwrap(), [b'a'; 276]);
    }

    #[test]
    fn what_is_damaged_is_refused() {
        for (packed, len) in [
            (&b""[..], 0),
            (b"\x30ab", 3),
            (b"\x30abc", 2),
            (b"\x30abc", 4),
            (b"\x10a\x02\x00\x00", 5),
            (b"\x10a\x00\x00\x00", 5),
            (b"\x10a\x01\x00", 4),
            (b"\xf0\xff\xff", 9),
            (b"\x1fa\x01\x00\xff\xff\xff\x00\x00", 9),
        ] {
            assert_eq!(unpacked(packed, len), None, "{packed:?}");
        }
    }
}
