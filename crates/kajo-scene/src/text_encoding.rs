//! Text that is not UTF-8: what is known of it, so that a message can name it.

/// What is said of a file in UTF-16.
pub(crate) const UTF_16: &str = "this file is UTF-16 text, which is not read; save it as UTF-8";

/// Whether a text that begins so is UTF-16: after a byte order mark, or since every other byte is zero.
pub(crate) fn is_utf16(head: &[u8]) -> bool {
    if head.starts_with(&[0xff, 0xfe]) || head.starts_with(&[0xfe, 0xff]) {
        return true;
    }
    let (pairs, _) = head[..head.len().min(8)].as_chunks::<2>();
    let is_text = |byte: u8| (b' '..0x7f).contains(&byte) || byte.is_ascii_whitespace();
    let little = pairs.iter().all(|&[low, high]| high == 0 && is_text(low));
    let big = pairs.iter().all(|&[high, low]| high == 0 && is_text(low));
    pairs.len() >= 2 && (little || big)
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// A text in UTF-16, in all the ways in which it is written: of either byte order, with and without a mark.
    pub(crate) fn in_utf16(text: &str) -> [Vec<u8>; 4] {
        let little: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
        let big: Vec<u8> = text.encode_utf16().flat_map(u16::to_be_bytes).collect();
        [[&[0xff, 0xfe], &*little].concat(), [&[0xfe, 0xff], &*big].concat(), little, big]
    }

    #[test]
    fn every_other_byte_is_zero_or_a_mark_comes_first() {
        for text in ["v 1 2 3\n", "\n\nsolid", "ply"] {
            assert!(in_utf16(text).iter().all(|bytes| is_utf16(bytes)), "{text:?}");
            assert!(!is_utf16(text.as_bytes()) && !is_utf16(format!("\u{feff}{text}").as_bytes()));
        }
        for bytes in [&b""[..], b"v", b"v\0", b"\0\0\0\0\0\0", b"a\0b\x01c\0d\0"] {
            assert!(!is_utf16(bytes), "{bytes:?}");
        }
    }
}
