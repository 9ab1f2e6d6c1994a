//! Pictures to the bytes of files and back, whatever the format.

use std::borrow::Cow;
use std::io::Cursor;

use ::image::codecs::{bmp::BmpEncoder, hdr::HdrEncoder, pnm, tga::TgaEncoder};
use ::image::error::UnsupportedErrorKind;
use ::image::{DynamicImage, ExtendedColorType, ImageDecoder, ImageEncoder, ImageReader, Rgb};

use crate::contained::contained;
use crate::exr::{ExrLayer, ExrPicture};
use crate::quantise::clamp_or_zero;
use crate::{BitDepth, DecodeLimits, Decoded, EncodeOptions, Format, Image, ImageError, exr, pfm, png};

/// The bytes of a picture file.
///
/// # Errors
/// [`ImageError::Parameter`] when the format cannot hold the picture or the text.
pub fn encode(image: &Image, format: Format, options: &EncodeOptions) -> Result<Vec<u8>, ImageError> {
    match format {
        Format::Png => png::encode(&*opaque(image, options)?, options),
        Format::Exr => exr::encode(ExrPicture {
            width: image.width(),
            height: image.height(),
            layers: vec![ExrLayer::from_image(None, image)],
            chromaticities: None,
            attributes: options.text.clone(),
        }),
        Format::Tga => encode_tga(&*opaque(image, options)?, options),
        Format::Bmp => encode_bmp(image, options),
        Format::Ppm => encode_ppm(image, options),
        Format::Pfm => pfm::encode(image),
        Format::Hdr => encode_hdr(image),
        Format::Jpeg | Format::WebP => Err(ImageError::parameter(format!("{format} is read, not written"))),
    }
}

/// Reads a picture of any format this crate knows, by its first bytes.
///
/// `hint` is the format its name suggests; it decides only where the bytes do not, which
/// is for TGA.
///
/// # Errors
/// [`ImageError::UnknownFormat`], [`ImageError::Malformed`], [`ImageError::Unsupported`]
/// and [`ImageError::Limit`].
pub fn decode(bytes: &[u8], hint: Option<Format>, limits: &DecodeLimits) -> Result<Decoded, ImageError> {
    let format = Format::from_magic(bytes).or(hint).ok_or(ImageError::UnknownFormat)?;
    match format {
        Format::Png => png::decode(bytes, limits),
        Format::Pfm => pfm::decode(bytes, limits),
        Format::Exr => {
            let picture = exr::decode(bytes, limits)?;
            Ok(Decoded { format, image: picture.main_image()?, depth: None, text: picture.attributes })
        }
        Format::Tga => decode_with(bytes, format, ::image::ImageFormat::Tga, limits),
        Format::Bmp => decode_with(bytes, format, ::image::ImageFormat::Bmp, limits),
        Format::WebP => decode_with(bytes, format, ::image::ImageFormat::WebP, limits),
        Format::Ppm => decode_with(bytes, format, ::image::ImageFormat::Pnm, limits),
        Format::Hdr => decode_with(bytes, format, ::image::ImageFormat::Hdr, limits),
        Format::Jpeg => decode_with(bytes, format, ::image::ImageFormat::Jpeg, limits),
    }
}

fn opaque<'a>(image: &'a Image, options: &EncodeOptions) -> Result<Cow<'a, Image>, ImageError> {
    if !options.opaque_alpha {
        return Ok(Cow::Borrowed(image));
    }
    // Through three channels, so that an alpha the picture has is replaced.
    Ok(Cow::Owned(image.with_channels(3)?.with_channels(4)?))
}

fn encode_tga(image: &Image, options: &EncodeOptions) -> Result<Vec<u8>, ImageError> {
    let colour = match image.channels() {
        1 => ExtendedColorType::L8,
        2 => ExtendedColorType::La8,
        3 => ExtendedColorType::Rgb8,
        _ => ExtendedColorType::Rgba8,
    };
    let mut bytes = Vec::new();
    TgaEncoder::new(&mut bytes)
        .write_image(&options.bytes(image), image.width(), image.height(), colour)
        .map_err(ImageError::parameter)?;
    Ok(bytes)
}

fn encode_bmp(image: &Image, options: &EncodeOptions) -> Result<Vec<u8>, ImageError> {
    // Few programs understand an alpha channel in these files.
    let (channels, colour) =
        if image.channels() < 3 { (1, ExtendedColorType::L8) } else { (3, ExtendedColorType::Rgb8) };
    let samples = options.bytes(&image.with_channels(channels)?);
    let mut bytes = Vec::new();
    BmpEncoder::new(&mut bytes)
        .encode(&samples, image.width(), image.height(), colour)
        .map_err(ImageError::parameter)?;
    Ok(bytes)
}

fn encode_ppm(image: &Image, options: &EncodeOptions) -> Result<Vec<u8>, ImageError> {
    let binary = pnm::SampleEncoding::Binary;
    let (channels, subtype, colour) = if image.channels() < 3 {
        (1, pnm::PnmSubtype::Graymap(binary), ExtendedColorType::L8)
    } else {
        (3, pnm::PnmSubtype::Pixmap(binary), ExtendedColorType::Rgb8)
    };
    let samples = options.bytes(&image.with_channels(channels)?);
    let mut bytes = Vec::new();
    pnm::PnmEncoder::new(&mut bytes)
        .with_subtype(subtype)
        .write_image(&samples, image.width(), image.height(), colour)
        .map_err(ImageError::parameter)?;
    Ok(bytes)
}

fn encode_hdr(image: &Image) -> Result<Vec<u8>, ImageError> {
    // The format has no sign, no infinity and no NaN.
    let pixels: Vec<_> = image.rgb_pixels().map(|p| Rgb(p.map(|v| clamp_or_zero(v, HDR_MAX)))).collect();
    let mut bytes = Vec::new();
    HdrEncoder::new(&mut bytes)
        .encode(&pixels, image.width() as usize, image.height() as usize)
        .map_err(ImageError::parameter)?;
    Ok(bytes)
}

/// A little below 2¹²⁷, the largest power of two the shared exponent can hold.
const HDR_MAX: f32 = 1e38;

/// Reads with a decoder of the `image` crate.
fn decode_with(
    bytes: &[u8],
    format: Format,
    decoder: ::image::ImageFormat,
    limits: &DecodeLimits,
) -> Result<Decoded, ImageError> {
    let error = |error| by_fault(format, limits, error);
    let (size, channels, pixels) = contained(format, || {
        let mut reader = ImageReader::with_format(Cursor::new(bytes), decoder);
        let mut bounds = ::image::Limits::no_limits();
        bounds.max_alloc = Some(limits.max_bytes);
        reader.limits(bounds);
        let decoder = reader.into_decoder().map_err(error)?;
        let (width, height) = decoder.dimensions();
        if width == 0 || height == 0 {
            return Err(ImageError::malformed(format, "a picture without pixels"));
        }
        let colour = decoder.color_type();
        let channels = colour.channel_count();
        // The decoder's own copy, be it the runs of TGA or the coefficients of a progressive JPEG, its result, and ours
        // where that is another.
        let decoding = 2 * u64::from(colour.bytes_per_pixel());
        let converting = if format.is_float() { 0 } else { 4 * u64::from(channels) };
        limits.check(width.into(), height.into(), decoding + converting)?;
        Ok(([width, height], channels, DynamicImage::from_decoder(decoder).map_err(error)?))
    })?;
    let (data, depth) =
        floats(pixels).ok_or_else(|| ImageError::unsupported(format, "an unknown kind of pixel"))?;
    let image = Image::from_data(size[0], size[1], channels.into(), data)?;
    Ok(Decoded { format, image, depth, text: Vec::new() })
}

/// The samples in the decoder's order; `None` for kinds of pixel the crate may add one day.
fn floats(pixels: DynamicImage) -> Option<(Vec<f32>, Option<BitDepth>)> {
    use DynamicImage as D;
    let eight = |v: Vec<u8>| (v.into_iter().map(|v| f32::from(v) / 255.0).collect(), Some(BitDepth::Eight));
    let sixteen =
        |v: Vec<u16>| (v.into_iter().map(|v| f32::from(v) / 65535.0).collect(), Some(BitDepth::Sixteen));
    Some(match pixels {
        D::ImageLuma8(p) => eight(p.into_raw()),
        D::ImageLumaA8(p) => eight(p.into_raw()),
        D::ImageRgb8(p) => eight(p.into_raw()),
        D::ImageRgba8(p) => eight(p.into_raw()),
        D::ImageLuma16(p) => sixteen(p.into_raw()),
        D::ImageLumaA16(p) => sixteen(p.into_raw()),
        D::ImageRgb16(p) => sixteen(p.into_raw()),
        D::ImageRgba16(p) => sixteen(p.into_raw()),
        D::ImageRgb32F(p) => (p.into_raw(), None),
        D::ImageRgba32F(p) => (p.into_raw(), None),
        _ => return None,
    })
}

fn by_fault(format: Format, limits: &DecodeLimits, error: ::image::ImageError) -> ImageError {
    use ::image::ImageError as E;
    match error {
        E::Unsupported(e) => match e.kind() {
            UnsupportedErrorKind::GenericFeature(what) => ImageError::unsupported(format, what),
            _ => ImageError::unsupported(format, e),
        },
        // The crate does not say by how much.
        E::Limits(_) => {
            let limit = limits.max_bytes;
            ImageError::Limit { what: "memory in bytes", needed: limit.saturating_add(1), limit }
        }
        other => ImageError::malformed(format, other),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Quantiser, Transfer};

    fn picture<const N: usize>() -> Image {
        Image::from_fn::<N>(7, 5, |x, y| {
            std::array::from_fn(|c| (x * 30 + y * 11 + c as u32 * 7) as f32 / 255.0)
        })
        .unwrap()
    }

    fn round_trip(image: &Image, format: Format, options: &EncodeOptions) -> Decoded {
        let bytes = encode(image, format, options).unwrap();
        let decoded = decode(&bytes, Some(format), &DecodeLimits::default()).unwrap();
        assert_eq!(decoded.format, format);
        decoded
    }

    #[test]
    fn extensions_and_names_go_both_ways() {
        for format in Format::ALL {
            assert_eq!(Format::from_extension(format.extension()), Some(format));
            assert_eq!(Format::from_extension(&format.extension().to_uppercase()), Some(format));
        }
        assert_eq!(Format::from_extension("jpeg"), None);
        assert_eq!(Format::from_extension(""), None);
    }

    /// A smooth picture as JPEG.
    fn jpeg() -> Vec<u8> {
        let mut bytes = Vec::new();
        let samples: Vec<u8> =
            (0..16 * 8u32).flat_map(|i| [16 * (i % 16) as u8, 200, 24 * (i / 16) as u8]).collect();
        ::image::codecs::jpeg::JpegEncoder::new_with_quality(&mut bytes, 100)
            .write_image(&samples, 16, 8, ExtendedColorType::Rgb8)
            .unwrap();
        bytes
    }

    #[test]
    fn jpeg_is_read_and_not_written() {
        let decoded = decode(&jpeg(), None, &DecodeLimits::default()).unwrap();
        assert_eq!((decoded.format, decoded.depth), (Format::Jpeg, Some(BitDepth::Eight)));
        assert_eq!((decoded.image.width(), decoded.image.height()), (16, 8));
        let [r, g, b] = decoded.image.rgb(9, 5);
        let expected = [144.0, 200.0, 120.0].map(|v: f32| v / 255.0);
        assert!([r, g, b].iter().zip(expected).all(|(a, b)| (a - b).abs() < 0.03), "{r} {g} {b}");
        let refused = encode(&picture::<3>(), Format::Jpeg, &EncodeOptions::default());
        assert!(matches!(refused, Err(ImageError::Parameter(_))));
        let small = DecodeLimits { max_side: 15, ..DecodeLimits::default() };
        assert!(matches!(decode(&jpeg(), None, &small), Err(ImageError::Limit { .. })));
    }

    /// Three by two colours, some of which are seen through, as WebP without loss.
    fn webp() -> Vec<u8> {
        let samples: Vec<u8> = (0..6u8).flat_map(|i| [40 * i, 255 - i, 7, 255 - 50 * i]).collect();
        let mut bytes = Vec::new();
        ::image::codecs::webp::WebPEncoder::new_lossless(&mut bytes)
            .encode(&samples, 3, 2, ExtendedColorType::Rgba8)
            .unwrap();
        bytes
    }

    #[test]
    fn webp_is_read_and_not_written() {
        let decoded = decode(&webp(), None, &DecodeLimits::default()).unwrap();
        assert_eq!((decoded.format, decoded.depth), (Format::WebP, Some(BitDepth::Eight)));
        let image = decoded.image;
        assert_eq!((image.width(), image.height(), image.channels()), (3, 2, 4));
        let expected = [160.0, 251.0, 7.0, 55.0].map(|v: f32| v / 255.0);
        assert_eq!(image.data()[4 * 4..5 * 4], expected);
        let refused = encode(&picture::<3>(), Format::WebP, &EncodeOptions::default());
        assert!(matches!(refused, Err(ImageError::Parameter(_))));
    }

    #[test]
    fn damaged_files_end_in_an_error_or_a_picture() {
        let bmp = encode(&picture::<3>(), Format::Bmp, &EncodeOptions::default()).unwrap();
        let limits = DecodeLimits { max_side: 4096, max_bytes: 1 << 26 };
        for (format, whole) in [(Format::Jpeg, jpeg()), (Format::WebP, webp()), (Format::Bmp, bmp)] {
            for i in 0..whole.len() {
                let _ = decode(&whole[..i], Some(format), &limits);
                for value in [0x00, 0x7f, 0xff, whole[i] ^ 0x10] {
                    let mut damaged = whole.clone();
                    damaged[i] = value;
                    if let Ok(read) = decode(&damaged, Some(format), &limits) {
                        assert!(read.image.data().iter().all(|v| (0.0..=1.0).contains(v)));
                    }
                }
            }
        }
    }

    #[test]
    fn every_format_but_tga_is_known_by_its_bytes() {
        for format in Format::ALL {
            let bytes = encode(&picture::<3>(), format, &EncodeOptions::default()).unwrap();
            assert_eq!(Format::from_magic(&bytes), (format != Format::Tga).then_some(format));
            let misleading = if format == Format::Tga { None } else { Some(Format::Tga) };
            let found = decode(&bytes, misleading, &DecodeLimits::default()).map(|d| d.format);
            assert_eq!(
                found,
                if format == Format::Tga { Err(ImageError::UnknownFormat) } else { Ok(format) }
            );
        }
    }

    #[test]
    fn whole_numbers_round_trip() {
        let options = EncodeOptions::default();
        for format in [Format::Png, Format::Tga, Format::Bmp, Format::Ppm] {
            let grey = round_trip(&picture::<1>(), format, &options).image;
            // A bitmap's greys are a palette.
            let channels = if format == Format::Bmp { 3 } else { 1 };
            assert_eq!(grey, picture::<1>().with_channels(channels).unwrap(), "{format}");
            assert_eq!(round_trip(&picture::<3>(), format, &options).image, picture::<3>(), "{format}");
        }
        for format in [Format::Png, Format::Tga] {
            assert_eq!(round_trip(&picture::<4>(), format, &options).image, picture::<4>(), "{format}");
        }
        for format in [Format::Bmp, Format::Ppm] {
            let opaque = picture::<4>().with_channels(3).unwrap();
            assert_eq!(round_trip(&picture::<4>(), format, &options).image, opaque, "{format}");
        }
    }

    #[test]
    fn floats_round_trip() {
        let options = EncodeOptions::default();
        for format in [Format::Exr, Format::Pfm] {
            let mut image = picture::<3>();
            image.data_mut()[..3].copy_from_slice(&[-1.5, 1e30, f32::NEG_INFINITY]);
            assert_eq!(round_trip(&image, format, &options).image, image, "{format}");
            assert_eq!(round_trip(&picture::<1>(), format, &options).image, picture::<1>(), "{format}");
        }
    }

    #[test]
    fn radiance_keeps_eight_bits_of_the_brightest_channel() {
        let image = Image::from_data(
            4,
            1,
            3,
            vec![0.5, 0.25, 0.0, 1000.0, 3.0, 1.0, -1.0, f32::NAN, 0.0, f32::INFINITY, 0.0, 0.0],
        )
        .unwrap();
        let decoded = round_trip(&image, Format::Hdr, &EncodeOptions::default());
        assert_eq!(decoded.depth, None);
        for (from, to) in image.pixels().zip(decoded.image.pixels()) {
            let sane: Vec<f32> = from.iter().map(|v| clamp_or_zero(*v, HDR_MAX)).collect();
            let brightest = sane.iter().copied().fold(0.0, f32::max);
            for (a, b) in sane.iter().zip(to) {
                assert!((a - b).abs() <= brightest / 128.0, "{a} {b}");
            }
        }
    }

    #[test]
    fn the_classic_program_writes_opaque_colour() {
        let options = EncodeOptions { opaque_alpha: true, ..Default::default() };
        for format in [Format::Png, Format::Tga] {
            let image = Image::filled(1, 1, &[0.1, 0.3, 0.7, 0.2]).unwrap();
            let stored: Vec<_> = round_trip(&image, format, &options)
                .image
                .data()
                .iter()
                .map(|v| (v * 255.0).round())
                .collect();
            assert_eq!(stored, [26.0, 77.0, 179.0, 255.0], "{format}");
            assert_eq!(round_trip(&picture::<1>(), format, &options).image.channels(), 4);
        }
    }

    #[test]
    fn the_curve_leaves_alpha_alone() {
        let quantiser = Quantiser { transfer: Transfer::Srgb, ..Default::default() };
        let options = EncodeOptions { quantiser, ..Default::default() };
        let image = Image::filled(1, 1, &[0.214_041_14, 0.5]).unwrap();
        assert_eq!(options.quantise(&image), [128, 128]);
    }
}
