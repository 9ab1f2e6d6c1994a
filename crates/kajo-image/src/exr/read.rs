//! Reading every layer and channel, within limits.

use std::io::Cursor;
use std::panic::{AssertUnwindSafe, catch_unwind};

use ::exr::error::Error;
use ::exr::image::{FlatImage, FlatSamples, read::read};
use ::exr::math::Vec2;
use ::exr::meta::attribute::{AttributeValue, Text};
use ::exr::meta::header::{Header, LayerAttributes};
use ::exr::meta::{BlockDescription, MetaData};
use ::exr::prelude::{ReadChannels, ReadLayers};

use super::{ChannelData, ExrLayer, ExrPicture};
use crate::{DecodeLimits, Format, ImageError};

/// Memory per sample while decoding: the crate's copy and ours, 4 bytes each at most.
const BYTES_PER_SAMPLE: u64 = 8;

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
    let meta = contained(|| MetaData::read_from_buffered(Cursor::new(bytes), false))?;
    check(&meta.headers, limits)?;
    let file: FlatImage = contained(|| {
        read()
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .all_layers()
            .all_attributes()
            .non_parallel()
            .from_buffered(Cursor::new(bytes))
    })?;
    into_picture(file)
}

/// Runs the `exr` crate on bytes of unknown origin.
///
/// The crate is written in safe Rust and means to return errors, but its arithmetic on
/// sizes and offsets can still trip over hostile headers; such a panic ends here, as an
/// error of the file. Nothing it touched is used afterwards.
fn contained<T>(decoder: impl FnOnce() -> Result<T, Error>) -> Result<T, ImageError> {
    match catch_unwind(AssertUnwindSafe(decoder)) {
        Ok(Ok(value)) => Ok(value),
        Ok(Err(Error::NotSupported(what))) => Err(ImageError::unsupported(Format::Exr, what)),
        Ok(Err(error)) => Err(malformed(error)),
        Err(_) => Err(malformed("sizes or offsets in the file contradict each other")),
    }
}

/// Checks everything that decides how much memory the crate will reserve.
fn check(headers: &[Header], limits: &DecodeLimits) -> Result<(), ImageError> {
    let first = headers.first().ok_or_else(|| malformed("no header"))?;
    let mut bytes_per_pixel = 0;
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
            limits.check(width as u64, height as u64, samples.saturating_mul(BYTES_PER_SAMPLE))?;
        }
        bytes_per_pixel += samples.saturating_mul(BYTES_PER_SAMPLE);
    }
    let Vec2(width, height) = first.layer_size;
    if width == 0 || height == 0 {
        return Err(malformed("a picture without pixels"));
    }
    limits.check(width as u64, height as u64, bytes_per_pixel)
}

fn into_picture(file: FlatImage) -> Result<ExrPicture, ImageError> {
    let Vec2(width, height) = file.layer_data.first().ok_or_else(|| malformed("no layer"))?.size;
    let pair = |Vec2(x, y): Vec2<f32>| [x, y];
    let chromaticities = file.attributes.chromaticities;
    let chromaticities = chromaticities.map(|c| [pair(c.red), pair(c.green), pair(c.blue), pair(c.white)]);
    let mut attributes = Vec::new();
    let mut layers: Vec<ExrLayer> = Vec::new();
    for (part_index, part) in file.layer_data.into_iter().enumerate() {
        attributes.extend(text_attributes(&part.attributes));
        let part_name = part.attributes.layer_name.filter(|_| part_index > 0).map(|name| string(&name));
        for channel in part.channel_data.list {
            let full_name = string(&channel.name);
            let (layer, name) = match full_name.rsplit_once('.') {
                Some((layer, name)) => (Some(layer.to_owned()), name.to_owned()),
                None => (part_name.clone(), full_name),
            };
            let data = channel_data(channel.sample_data);
            match layers.iter_mut().find(|l| l.name == layer) {
                Some(found) => found.channels.push((name, data)),
                None => layers.push(ExrLayer { name: layer, channels: vec![(name, data)] }),
            }
        }
    }
    layers.sort_by_key(|layer| layer.name.is_some());
    attributes.sort();
    attributes.dedup();
    Ok(ExrPicture { width: width as u32, height: height as u32, layers, chromaticities, attributes })
}

fn channel_data(samples: FlatSamples) -> ChannelData {
    match samples {
        FlatSamples::F32(v) => ChannelData::F32(v),
        FlatSamples::F16(v) => ChannelData::F16(v.into_iter().map(|x| x.to_f32()).collect()),
        FlatSamples::U32(v) => ChannelData::U32(v),
    }
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

fn malformed(reason: impl ToString) -> ImageError {
    ImageError::malformed(Format::Exr, reason)
}
