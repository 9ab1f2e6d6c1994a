//! Writing one part with dotted channel names.

use std::collections::BTreeSet;
use std::io::Cursor;

use ::exr::image::{AnyChannel, AnyChannels, Blocks, Encoding, FlatSamples, Layer};
use ::exr::meta::attribute::{AttributeValue, Chromaticities, LineOrder, Text};
use ::exr::meta::header::LayerAttributes;
use ::exr::prelude::{Compression, SmallVec, Vec2, WritableImage, f16};

use super::{ChannelData, ExrLayer, ExrPicture};
use crate::ImageError;

/// Longest name of a channel or attribute, in bytes.
const MAX_NAME: usize = 255;

/// The bytes of an OpenEXR file; the same picture always gives the same bytes.
///
/// # Errors
/// [`ImageError::Parameter`] when there is no channel, a channel does not have
/// `width · height` samples, two have the same full name, or a name is empty, longer than
/// 255 bytes or contains a zero.
pub fn encode(picture: ExrPicture) -> Result<Vec<u8>, ImageError> {
    compressed(picture, Compression::ZIP16)
}

/// As [`encode`] in a fraction of the time: equal bytes in a row are all that is compressed, so the file is larger.
///
/// # Errors
/// As there.
pub fn encode_quickly(picture: ExrPicture) -> Result<Vec<u8>, ImageError> {
    compressed(picture, Compression::RLE)
}

fn compressed(picture: ExrPicture, compression: Compression) -> Result<Vec<u8>, ImageError> {
    check(&picture)?;
    let size = Vec2(picture.width as usize, picture.height as usize);
    let channels: SmallVec<[_; 4]> = picture.layers.into_iter().flat_map(channels_of).collect();
    let encoding = Encoding { compression, blocks: Blocks::ScanLines, line_order: LineOrder::Increasing };
    let layer = Layer::new(size, attributes(&picture.attributes), encoding, AnyChannels::sort(channels));
    let mut bytes = Cursor::new(Vec::new());
    let mut image = ::exr::image::Image::from_layer(layer);
    image.attributes.chromaticities = picture.chromaticities.map(|[red, green, blue, white]| {
        let place = |[x, y]: [f32; 2]| Vec2(x, y);
        Chromaticities { red: place(red), green: place(green), blue: place(blue), white: place(white) }
    });
    image.write().non_parallel().to_buffered(&mut bytes).map_err(ImageError::parameter)?;
    let mut bytes = bytes.into_inner();
    sort_attributes(&mut bytes);
    Ok(bytes)
}

fn check(picture: &ExrPicture) -> Result<(), ImageError> {
    let (width, height) = (picture.width, picture.height);
    let sides = 1..=i32::MAX as u32;
    if !sides.contains(&width) || !sides.contains(&height) {
        return Err(ImageError::parameter(format!("OpenEXR holds no picture of {width} x {height}")));
    }
    let mut names = BTreeSet::new();
    for layer in &picture.layers {
        for (channel, data) in &layer.channels {
            let name = full_name(layer.name.as_deref(), channel);
            if layer.name.as_deref() == Some("") || channel.is_empty() {
                return Err(ImageError::parameter(format!("an empty name in channel `{name}`")));
            }
            check_name(&name)?;
            if data.len() as u64 != u64::from(width) * u64::from(height) {
                return Err(ImageError::parameter(format!("channel `{name}` is not {width} x {height}")));
            }
            if !names.insert(name.clone()) {
                return Err(ImageError::parameter(format!("two channels are called `{name}`")));
            }
        }
    }
    if names.is_empty() {
        return Err(ImageError::parameter("an OpenEXR picture without channels"));
    }
    picture.attributes.iter().try_for_each(|(name, _)| check_name(name))
}

fn check_name(name: &str) -> Result<(), ImageError> {
    if name.is_empty() || name.len() > MAX_NAME || name.contains('\0') {
        return Err(ImageError::parameter(format!("`{name}` is not a name OpenEXR can hold")));
    }
    Ok(())
}

fn full_name(layer: Option<&str>, channel: &str) -> String {
    layer.map_or_else(|| channel.to_owned(), |layer| format!("{layer}.{channel}"))
}

fn channels_of(layer: ExrLayer) -> impl Iterator<Item = AnyChannel<FlatSamples>> {
    let name = layer.name;
    layer.channels.into_iter().map(move |(channel, data)| {
        let samples = match data {
            ChannelData::F32(v) => FlatSamples::F32(v),
            ChannelData::F16(v) => FlatSamples::F16(v.into_iter().map(f16::from_f32).collect()),
            ChannelData::U32(v) => FlatSamples::U32(v),
        };
        AnyChannel::new(text(&full_name(name.as_deref(), &channel)), samples)
    })
}

fn attributes(remarks: &[(String, String)]) -> LayerAttributes {
    let mut attributes = LayerAttributes::default();
    for (name, value) in remarks {
        let value = text(value);
        match name.as_str() {
            "software" => attributes.software_name = Some(value),
            "comments" => attributes.comments = Some(value),
            "owner" => attributes.owner = Some(value),
            "capDate" => attributes.capture_date = Some(value),
            _ => {
                attributes.other.insert(text(name), AttributeValue::Text(value));
            }
        }
    }
    attributes
}

/// OpenEXR's strings are UTF-8 today; the crate's own conversion would allow Latin-1 only.
fn text(string: &str) -> Text {
    Text::from_slice_unchecked(string.as_bytes())
}

/// Puts the attributes of the one header into alphabetical order.
///
/// The `exr` crate keeps them in a hash map whose order differs from run to run. The
/// header's length, and with it every offset, stays as it is.
fn sort_attributes(file: &mut [u8]) {
    const START: usize = 8; // magic number and version
    let mut attributes = Vec::new();
    let mut end = START;
    while let Some(len) = attribute_len(&file[end..]) {
        attributes.push(file[end..end + len].to_vec());
        end += len;
    }
    attributes.sort();
    file[START..end].copy_from_slice(&attributes.concat());
}

/// Bytes of the attribute at the start: name, zero, type, zero, 4-byte size, value.
/// `None` at the zero that ends the header.
fn attribute_len(bytes: &[u8]) -> Option<usize> {
    let zero = |from: usize| Some(from + bytes.get(from..)?.iter().position(|&b| b == 0)?);
    let name_end = zero(0).filter(|&end| end > 0)?;
    let type_end = zero(name_end + 1)?;
    let size = bytes.get(type_end + 1..type_end + 5)?.try_into().ok()?;
    Some(type_end + 5 + u32::from_le_bytes(size) as usize)
}
