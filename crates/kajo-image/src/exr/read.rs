//! Reading every layer and channel, within limits.
//!
//! Pixels come in chunks, each compressed by itself. What a chunk may take is known from the header, so the sizes that
//! are written in it are compared with that first, and only then does the `exr` crate unpack it.

use std::collections::{BTreeMap, BTreeSet};
use std::io::Cursor;

use ::exr::block::{self, UncompressedBlock};
use ::exr::error::Error;
use ::exr::math::Vec2;
use ::exr::meta::attribute::{AttributeValue, SampleType, Text};
use ::exr::meta::header::{Header, LayerAttributes};
use ::exr::meta::{BlockDescription, MetaData};
use ::exr::prelude::f16;

use super::{ChannelData, ExrLayer, ExrPicture, dwa};
use crate::contained::contained;
use crate::{DecodeLimits, Format, ImageError};

/// Bytes of a sample in the picture; 16-bit floats become 32-bit ones.
const BYTES_PER_SAMPLE: u64 = 4;

/// Memory for unpacking a chunk, in units of its unpacked bytes, and in bytes for each of its pixels. The compression
/// that takes most is DWA: its sections, the transformed blocks of three channels as floats, and the result.
const UNPACKING: [u64; 2] = [8, 16];

/// Reads all layers and channels of an OpenEXR file at full resolution.
///
/// A channel `a.b.R` belongs to layer `a.b`. In a file of several parts a bare channel
/// belongs to the layer named like its part, except in the first part, the main picture.
/// The position of the data window is ignored.
///
/// # Errors
/// [`ImageError::Malformed`], [`ImageError::Limit`], and [`ImageError::Unsupported`] for
/// deep data, subsampled channels and parts of different sizes.
pub fn decode(bytes: &[u8], limits: &DecodeLimits) -> Result<ExrPicture, ImageError> {
    // The arithmetic of the crate on sizes and offsets can trip over hostile headers.
    let (meta, parts) = contained(Format::Exr, || {
        let file = block::read(Cursor::new(bytes), false).map_err(by_fault)?;
        check(file.headers(), bytes.len(), limits)?;
        let chunks = file.filter_chunks(false, |_, _, block| block.level == Vec2(0, 0)).map_err(by_fault)?;
        let meta = block::reader::ChunksReader::meta_data(&chunks).clone();
        let mut parts = meta.headers.iter().map(Planes::new).collect::<Result<Vec<Planes>, ImageError>>()?;
        let mut seen = BTreeSet::new();
        for chunk in chunks {
            let chunk = chunk.map_err(by_fault)?;
            let header =
                meta.headers.get(chunk.layer_index).ok_or_else(|| malformed("a chunk of no part"))?;
            dwa::check(&chunk, header)?;
            let block = UncompressedBlock::decompress_chunk(chunk, &meta, false).map_err(by_fault)?;
            // Many entries of the table of chunks may name the same one.
            let Vec2(x, y) = block.index.pixel_position;
            if !seen.insert((block.index.layer, y, x)) {
                return Err(malformed("a chunk comes twice"));
            }
            parts[block.index.layer].put(&block, header)?;
        }
        Ok((meta, parts))
    })?;
    into_picture(&meta, parts)
}

/// The file's own channels of one part, row 0 on top.
struct Planes {
    width: usize,
    channels: Vec<ChannelData>,
}

impl Planes {
    fn new(header: &Header) -> Result<Planes, ImageError> {
        let Vec2(width, height) = header.layer_size;
        let plane = |kind: SampleType| {
            Ok(match kind {
                SampleType::F16 => ChannelData::F16(zeros(width * height)?),
                SampleType::F32 => ChannelData::F32(zeros(width * height)?),
                SampleType::U32 => ChannelData::U32(zeros(width * height)?),
            })
        };
        let channels = header.channels.list.iter().map(|channel| plane(channel.sample_type));
        Ok(Planes { width, channels: channels.collect::<Result<_, ImageError>>()? })
    }

    /// Puts an unpacked chunk where it belongs.
    fn put(&mut self, block: &UncompressedBlock, header: &Header) -> Result<(), ImageError> {
        for line in block.lines(&header.channels) {
            let Vec2(x, y) = line.location.position;
            let start = y * self.width + x;
            let place = start..start + line.location.sample_count;
            let outside = || malformed("a chunk lies outside the picture");
            let plane = self.channels.get_mut(line.location.channel).ok_or_else(outside)?;
            match plane {
                ChannelData::F16(plane) => {
                    let samples = line.read_samples::<f16>();
                    for (value, sample) in plane.get_mut(place).ok_or_else(outside)?.iter_mut().zip(samples) {
                        *value = sample.map_err(by_fault)?.to_f32();
                    }
                }
                ChannelData::F32(plane) => {
                    let place = plane.get_mut(place).ok_or_else(outside)?;
                    line.read_samples_into_slice(place).map_err(by_fault)?;
                }
                ChannelData::U32(plane) => {
                    let place = plane.get_mut(place).ok_or_else(outside)?;
                    line.read_samples_into_slice(place).map_err(by_fault)?;
                }
            }
        }
        Ok(())
    }
}

/// `n` zeros, if there is memory for them.
fn zeros<T: Clone + Default>(n: usize) -> Result<Vec<T>, ImageError> {
    let mut plane = Vec::new();
    plane.try_reserve_exact(n).map_err(|_| ImageError::memory(n as u64 * BYTES_PER_SAMPLE))?;
    plane.resize(n, T::default());
    Ok(plane)
}

/// Checks everything that decides how much memory is reserved, but for what stands in the chunks.
fn check(headers: &[Header], file_len: usize, limits: &DecodeLimits) -> Result<(), ImageError> {
    let first = headers.first().ok_or_else(|| malformed("no header"))?;
    let Vec2(width, height) = first.layer_size;
    if width == 0 || height == 0 {
        return Err(malformed("a picture without pixels"));
    }
    limits.check(width as u64, height as u64, 0)?;
    let (mut planes, mut unpacking, mut n_chunks) = (0_u64, 0, 0_u64);
    for header in headers {
        if header.deep {
            return Err(ImageError::unsupported(Format::Exr, "deep data"));
        }
        if header.channels.list.iter().any(|channel| channel.sampling != Vec2(1, 1)) {
            return Err(ImageError::unsupported(Format::Exr, "subsampled channels"));
        }
        if header.layer_size != first.layer_size {
            return Err(ImageError::unsupported(Format::Exr, "parts of different sizes"));
        }
        let samples = header.channels.list.len() as u64;
        if samples == 0 {
            return Err(malformed("a part without channels"));
        }
        if let BlockDescription::Tiles(tiles) = header.blocks {
            let Vec2(width, height) = tiles.tile_size;
            limits.check(width as u64, height as u64, 0)?;
        }
        let Vec2(width, height) = header.max_block_pixel_size();
        let pixels = width as u64 * height as u64;
        let [times, per_pixel] = UNPACKING;
        let block = pixels.saturating_mul(times.saturating_mul(samples * BYTES_PER_SAMPLE) + per_pixel);
        unpacking = block.max(unpacking);
        planes = planes.saturating_add(samples * BYTES_PER_SAMPLE);
        n_chunks = n_chunks.saturating_add(header.chunk_count as u64);
    }
    // Each chunk has a place in a table.
    if n_chunks.saturating_mul(8) > file_len as u64 {
        return Err(malformed("the file ends before the picture does"));
    }
    let pixels = width as u64 * height as u64;
    limits.check_bytes(pixels.saturating_mul(planes).saturating_add(unpacking))
}

fn into_picture(meta: &MetaData, parts: Vec<Planes>) -> Result<ExrPicture, ImageError> {
    let first = meta.headers.first().ok_or_else(|| malformed("no layer"))?;
    let Vec2(width, height) = first.layer_size;
    let pair = |Vec2(x, y): Vec2<f32>| [x, y];
    let chromaticities = first.shared_attributes.chromaticities;
    let chromaticities = chromaticities.map(|c| [pair(c.red), pair(c.green), pair(c.blue), pair(c.white)]);
    let mut attributes = Vec::new();
    let mut layers: Vec<ExrLayer> = Vec::new();
    let mut places: BTreeMap<Option<String>, usize> = BTreeMap::new();
    for (part_index, (header, part)) in meta.headers.iter().zip(parts).enumerate() {
        attributes.extend(text_attributes(&header.own_attributes));
        let part_name = header.own_attributes.layer_name.as_ref().filter(|_| part_index > 0).map(string);
        for (channel, data) in header.channels.list.iter().zip(part.channels) {
            let full_name = string(&channel.name);
            let (layer, name) = match full_name.rsplit_once('.') {
                Some((layer, name)) => (Some(layer.to_owned()), name.to_owned()),
                None => (part_name.clone(), full_name),
            };
            let place = *places.entry(layer).or_insert_with_key(|layer| {
                layers.push(ExrLayer { name: layer.clone(), channels: Vec::new() });
                layers.len() - 1
            });
            layers[place].channels.push((name, data));
        }
    }
    layers.sort_by_key(|layer| layer.name.is_some());
    attributes.sort();
    attributes.dedup();
    Ok(ExrPicture { width: width as u32, height: height as u32, layers, chromaticities, attributes })
}

fn text_attributes(attributes: &LayerAttributes) -> impl Iterator<Item = (String, String)> {
    let standard = [
        ("software", &attributes.software_name),
        ("comments", &attributes.comments),
        ("owner", &attributes.owner),
        ("capDate", &attributes.capture_date),
    ];
    let standard =
        standard.into_iter().filter_map(|(name, value)| Some((name.to_owned(), string(value.as_ref()?))));
    let custom = attributes.other.iter().filter_map(|(name, value)| match value {
        AttributeValue::Text(value) => Some((string(name), string(value))),
        _ => None,
    });
    standard.chain(custom)
}

fn string(text: &Text) -> String {
    String::from_utf8_lossy(text.as_slice()).into_owned()
}

fn by_fault(error: Error) -> ImageError {
    match error {
        Error::NotSupported(what) => ImageError::unsupported(Format::Exr, what),
        error => malformed(error),
    }
}

fn malformed(reason: impl ToString) -> ImageError {
    ImageError::malformed(Format::Exr, reason)
}
