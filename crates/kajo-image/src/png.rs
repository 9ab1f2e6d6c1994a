//! PNG, 8 and 16 bits [ISO/IEC 15948, 3rd edition].
//!
//! Numbers are written by the rules of [`Quantiser`](crate::Quantiser). A file says how
//! its colours are encoded only when that is known: with [`Transfer::Srgb`] it carries
//! the `sRGB` and `gAMA` chunks, with [`Transfer::AsIs`] neither, so that programs show
//! the numbers as they are.

use std::io::Cursor;

use ::png::DeflateCompression;
use ::png::text_metadata::ITXtChunk;

use crate::contained::contained;
use crate::{BitDepth, DecodeLimits, Decoded, EncodeOptions, Format, Image, ImageError, Transfer};

/// Longest text that is unpacked, in bytes: a text may be packed a thousandfold.
const LONGEST_TEXT: usize = 1 << 16;

/// Of zlib. What comes after takes two to four times as long for 3 to 7 % of the bytes of a rendered picture.
const LEVEL: u8 = 3;

/// The bytes of a PNG file with the channels of `image`.
///
/// # Errors
/// [`ImageError::Parameter`] when a text keyword is not 1 to 79 Latin-1 characters, or the
/// picture is larger than PNG allows (2³¹ - 1 pixels a side).
pub fn encode(image: &Image, options: &EncodeOptions) -> Result<Vec<u8>, ImageError> {
    let samples = options.quantise(image);
    let mut bytes = Vec::new();
    let mut encoder = ::png::Encoder::new(&mut bytes, image.width(), image.height());
    encoder.set_color(match image.channels() {
        1 => ::png::ColorType::Grayscale,
        2 => ::png::ColorType::GrayscaleAlpha,
        3 => ::png::ColorType::Rgb,
        _ => ::png::ColorType::Rgba,
    });
    let samples = match options.depth {
        BitDepth::Eight => {
            encoder.set_depth(::png::BitDepth::Eight);
            samples.iter().map(|&v| v as u8).collect()
        }
        BitDepth::Sixteen => {
            encoder.set_depth(::png::BitDepth::Sixteen);
            samples.iter().flat_map(|v| v.to_be_bytes()).collect::<Vec<u8>>()
        }
    };
    encoder.set_deflate_compression(DeflateCompression::Level(LEVEL));
    if options.quantiser.transfer == Transfer::Srgb {
        encoder.set_source_srgb(::png::SrgbRenderingIntent::Perceptual);
        // The value the standard asks for beside sRGB, for programs that know gAMA only.
        encoder.set_source_gamma(::png::ScaledFloat::from_scaled(45_455));
    }
    for (keyword, text) in &options.text {
        // `tEXt` is Latin-1; anything else goes into the international chunk.
        let added = if text.chars().all(|c| u32::from(c) < 256) {
            encoder.add_text_chunk(keyword.clone(), text.clone())
        } else {
            encoder.add_itxt_chunk(keyword.clone(), text.clone())
        };
        added.map_err(ImageError::parameter)?;
    }
    let mut writer = encoder.write_header().map_err(ImageError::parameter)?;
    writer.write_image_data(&samples).map_err(ImageError::parameter)?;
    writer.finish().map_err(ImageError::parameter)?;
    Ok(bytes)
}

/// Reads any PNG: palettes become colours, transparency an alpha channel, 1 to 4 bits 8.
///
/// Values are the stored ones divided by their maximum, whatever curve they follow. Of an
/// animation the first picture is returned. Compressed texts of more than 64 KiB are left out.
///
/// # Errors
/// [`ImageError::Malformed`] for damaged or truncated files and [`ImageError::Limit`].
pub fn decode(bytes: &[u8], limits: &DecodeLimits) -> Result<Decoded, ImageError> {
    contained(Format::Png, || unpack(bytes, limits))
}

fn unpack(bytes: &[u8], limits: &DecodeLimits) -> Result<Decoded, ImageError> {
    let memory = ::png::Limits { bytes: usize::try_from(limits.max_bytes).unwrap_or(usize::MAX) };
    let mut decoder = ::png::Decoder::new_with_limits(Cursor::new(bytes), memory);
    decoder.set_transformations(::png::Transformations::EXPAND);
    decoder.set_ignore_iccp_chunk(true);
    let info = decoder.read_header_info().map_err(malformed)?;
    limits.check(info.width.into(), info.height.into(), 0)?;

    let mut reader = decoder.read_info().map_err(malformed)?;
    let size = reader.output_buffer_size().ok_or_else(|| malformed("the picture overflows memory"))?;
    // The samples as bytes, and as floats.
    let bytes_per_sample = if reader.output_color_type().1 == ::png::BitDepth::Sixteen { 2 } else { 1 };
    limits.check_bytes(size as u64 + (size / bytes_per_sample) as u64 * 4)?;
    let mut samples = Vec::new();
    samples.try_reserve_exact(size).map_err(|_| ImageError::memory(size as u64))?;
    samples.resize(size, 0);
    let frame = reader.next_frame(&mut samples).map_err(malformed)?;
    reader.finish().map_err(malformed)?;
    samples.truncate(frame.buffer_size());

    let depth = if frame.bit_depth == ::png::BitDepth::Sixteen { BitDepth::Sixteen } else { BitDepth::Eight };
    let data = match depth {
        BitDepth::Eight => samples.iter().map(|&v| f32::from(v) / 255.0).collect(),
        BitDepth::Sixteen => {
            samples.chunks_exact(2).map(|v| f32::from(u16::from_be_bytes([v[0], v[1]])) / 65535.0).collect()
        }
    };
    let image = Image::from_data(frame.width, frame.height, frame.color_type.samples(), data)?;
    let info = reader.info();
    let latin1 = info.uncompressed_latin1_text.iter().map(|t| (t.keyword.clone(), t.text.clone()));
    let international = info.utf8_text.iter().filter_map(|t| Some((t.keyword.clone(), unpacked(t)?)));
    Ok(Decoded {
        format: Format::Png,
        depth: Some(depth),
        text: latin1.chain(international).collect(),
        image,
    })
}

/// The text of a chunk; `None` when it is damaged or too long.
fn unpacked(chunk: &ITXtChunk) -> Option<String> {
    let mut chunk = chunk.clone();
    chunk.decompress_text_with_limit(LONGEST_TEXT).ok()?;
    chunk.get_text().ok()
}

fn malformed(error: impl ToString) -> ImageError {
    ImageError::malformed(Format::Png, error)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Quantiser;

    fn picture<const N: usize>(depth: BitDepth) -> Image {
        let q = Quantiser::default();
        Image::from_fn::<N>(7, 5, |x, y| {
            std::array::from_fn(|c| q.value((x * 31 + y * 101 + c as u32 * 7) as u16 % 256, depth))
        })
        .unwrap()
    }

    fn check_round_trip<const N: usize>(depth: BitDepth) {
        let image = picture::<N>(depth);
        let options = EncodeOptions { depth, ..Default::default() };
        let decoded = decode(&encode(&image, &options).unwrap(), &DecodeLimits::default()).unwrap();
        assert_eq!(decoded.image, image);
        assert_eq!(decoded.depth, Some(depth));
    }

    #[test]
    fn every_depth_and_channel_count_round_trips() {
        for depth in [BitDepth::Eight, BitDepth::Sixteen] {
            check_round_trip::<1>(depth);
            check_round_trip::<2>(depth);
            check_round_trip::<3>(depth);
            check_round_trip::<4>(depth);
        }
    }

    #[test]
    fn text_round_trips_and_bad_keywords_are_refused() {
        let text = vec![("Software".into(), "kajo".into()), ("Title".into(), "Kúla – sphere ☀".into())];
        let options = EncodeOptions { text: text.clone(), ..Default::default() };
        let bytes = encode(&picture::<3>(BitDepth::Eight), &options).unwrap();
        assert_eq!(decode(&bytes, &DecodeLimits::default()).unwrap().text, text);

        for keyword in ["", "☀", &"k".repeat(80)] {
            let options = EncodeOptions { text: vec![(keyword.into(), "x".into())], ..Default::default() };
            let result = encode(&picture::<3>(BitDepth::Eight), &options);
            assert!(matches!(result, Err(ImageError::Parameter(_))), "{keyword:?}");
        }
    }

    #[test]
    fn the_colour_chunks_follow_the_transfer() {
        let has = |bytes: &[u8], chunk: &[u8]| bytes.windows(4).any(|w| w == chunk);
        let image = picture::<3>(BitDepth::Eight);
        let as_is = encode(&image, &EncodeOptions::default()).unwrap();
        assert!(!has(&as_is, b"sRGB") && !has(&as_is, b"gAMA"));

        let quantiser = Quantiser { transfer: Transfer::Srgb, ..Default::default() };
        let srgb = encode(&image, &EncodeOptions { quantiser, ..Default::default() }).unwrap();
        assert!(has(&srgb, b"sRGB") && has(&srgb, b"gAMA"));
    }

    #[test]
    fn a_bomb_is_refused_by_its_header() {
        let mut bytes = encode(&Image::new(1, 1, 3).unwrap(), &EncodeOptions::default()).unwrap();
        bytes[16..24].copy_from_slice(&[0x7f, 0xff, 0xff, 0xff, 0x7f, 0xff, 0xff, 0xff]);
        // The header's checksum has to be right for the size to be believed.
        let mut crc = u32::MAX;
        for &byte in &bytes[12..29] {
            crc ^= u32::from(byte);
            for _ in 0..8 {
                crc = (crc >> 1) ^ (0xedb8_8320 & (crc & 1).wrapping_neg());
            }
        }
        bytes[29..33].copy_from_slice(&(!crc).to_be_bytes());
        let result = decode(&bytes, &DecodeLimits::default());
        assert!(matches!(result, Err(ImageError::Limit { what: "width in pixels", .. })), "{result:?}");
    }

    #[test]
    fn every_truncation_is_an_error() {
        let bytes = encode(&picture::<3>(BitDepth::Eight), &EncodeOptions::default()).unwrap();
        for len in 0..bytes.len() {
            let result = decode(&bytes[..len], &DecodeLimits::default());
            assert!(matches!(result, Err(ImageError::Malformed { .. })), "{len}: {result:?}");
        }
    }
}
