//! Portable float map: grey or colour, 32-bit floats, no compression [Debevec 1998].
//!
//! A text header of three words, then rows from **bottom** to top:
//!
//! ```text
//! Pf | PF            grey or red-green-blue
//! width height
//! scale              negative: little-endian; the magnitude is a unit nobody uses
//! ```

use crate::{DecodeLimits, Decoded, Format, Image, ImageError};

/// The bytes of a PFM file; alpha is left out.
///
/// # Errors
/// [`ImageError::Parameter`] when there is no memory for the copy.
pub fn encode(image: &Image) -> Result<Vec<u8>, ImageError> {
    let channels = if image.channels() < 3 { 1 } else { 3 };
    let kind = if channels == 1 { "Pf" } else { "PF" };
    let mut bytes = format!("{kind}\n{} {}\n-1.0\n", image.width(), image.height()).into_bytes();
    for y in (0..image.height()).rev() {
        for pixel in image.row(y).chunks_exact(image.channels()) {
            bytes.extend(pixel[..channels].iter().flat_map(|v| v.to_le_bytes()));
        }
    }
    Ok(bytes)
}

/// Reads a PFM file of either byte order.
///
/// # Errors
/// [`ImageError::Malformed`] and [`ImageError::Limit`].
pub fn decode(bytes: &[u8], limits: &DecodeLimits) -> Result<Decoded, ImageError> {
    let (kind, rest) = word(bytes)?;
    let channels = match kind {
        "Pf" => 1,
        "PF" => 3,
        _ => return Err(malformed("neither `Pf` nor `PF`")),
    };
    let (width, rest) = number::<u32>(rest, "width")?;
    let (height, rest) = number::<u32>(rest, "height")?;
    let (scale, rest) = number::<f32>(rest, "scale")?;
    if width == 0 || height == 0 {
        return Err(malformed("a picture without pixels"));
    }
    if !scale.is_finite() || scale == 0.0 {
        return Err(malformed("the scale is zero or not finite"));
    }
    limits.check(width.into(), height.into(), 4 * channels as u64)?;

    let mut image = Image::new(width, height, channels)?;
    let mut samples = rest.chunks_exact(4);
    if samples.len() < image.data().len() {
        return Err(malformed("the file ends before the picture does"));
    }
    let from_bytes = if scale < 0.0 { f32::from_le_bytes } else { f32::from_be_bytes };
    for y in (0..height).rev() {
        for (value, sample) in image.row_mut(y).iter_mut().zip(samples.by_ref()) {
            *value = from_bytes([sample[0], sample[1], sample[2], sample[3]]);
        }
    }
    Ok(Decoded { format: Format::Pfm, depth: None, text: Vec::new(), image })
}

/// The next word and what follows the single blank behind it.
fn word(bytes: &[u8]) -> Result<(&str, &[u8]), ImageError> {
    // The longest sensible word is a float; a hostile file may hold gigabytes without a blank.
    let end =
        bytes.iter().take(40).position(u8::is_ascii_whitespace).ok_or_else(|| malformed("no header"))?;
    let word = std::str::from_utf8(&bytes[..end]).map_err(malformed)?;
    Ok((word, &bytes[end + 1..]))
}

fn number<'a, T: std::str::FromStr>(bytes: &'a [u8], what: &str) -> Result<(T, &'a [u8]), ImageError> {
    let (word, rest) = word(bytes)?;
    let value = word.parse().map_err(|_| malformed(format!("`{word}` is not a {what}")))?;
    Ok((value, rest))
}

fn malformed(reason: impl ToString) -> ImageError {
    ImageError::malformed(Format::Pfm, reason)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_row_of_the_file_is_the_bottom_one() {
        let image = Image::from_data(1, 2, 1, vec![1.0, 2.0]).unwrap();
        let bytes = encode(&image).unwrap();
        assert_eq!(bytes, [b"Pf\n1 2\n-1.0\n".as_slice(), &2f32.to_le_bytes(), &1f32.to_le_bytes()].concat());
    }

    #[test]
    fn both_byte_orders_are_read() {
        let big = [b"PF\n1 1\n1.0\n".as_slice(), &[1f32, -2.5, f32::INFINITY].map(f32::to_be_bytes).concat()]
            .concat();
        let decoded = decode(&big, &DecodeLimits::default()).unwrap();
        assert_eq!(decoded.image.data(), [1.0, -2.5, f32::INFINITY]);
    }

    #[test]
    fn bad_headers_are_refused_before_memory_is_reserved() {
        let result = |text: &str| decode(text.as_bytes(), &DecodeLimits::default());
        for text in
            ["", "PF", "P6\n1 1\n1\n", "PF\n-1 1\n1\n", "PF\n1 1\n0\n", "PF\n1 1\nnan\n", "PF\n0 1\n1\n"]
        {
            assert!(matches!(result(text), Err(ImageError::Malformed { .. })), "{text:?}");
        }
        assert!(matches!(result("PF\n4000000000 4000000000\n-1\n"), Err(ImageError::Limit { .. })));
        assert!(matches!(result("PF\n60000 1\n-1\n1234"), Err(ImageError::Malformed { .. })));
    }
}
