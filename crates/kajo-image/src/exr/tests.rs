use super::*;
use crate::{DecodeLimits, EncodeOptions, Format};

fn ramp(n: usize) -> Vec<f32> {
    (0..n).map(|i| i as f32 * 0.25 - 1.0).collect()
}

/// Every kind of channel, a name for every habit, and values no other format keeps.
fn render() -> ExrPicture {
    let (width, height) = (9, 37);
    let n = (width * height) as usize;
    let f32s = |name: &str, scale: f32| {
        (name.to_owned(), ChannelData::F32(ramp(n).into_iter().map(|v| v * scale).collect()))
    };
    let mut depth = ramp(n);
    depth[0] = f32::INFINITY;
    depth[1] = f32::MIN_POSITIVE / 2.0;
    ExrPicture {
        width,
        height,
        chromaticities: Some([[0.7, 0.29], [0.165, 0.83], [0.128, 0.044], [0.32, 0.34]]),
        layers: vec![
            ExrLayer {
                name: None,
                channels: vec![
                    f32s("A", 1.0),
                    f32s("B", 2.0),
                    f32s("G", 3.0),
                    f32s("R", 4.0),
                    ("Z".into(), ChannelData::F32(depth)),
                ],
            },
            ExrLayer {
                name: Some("N".into()),
                channels: vec![f32s("X", 1.0), f32s("Y", 2.0), f32s("Z", 3.0)],
            },
            ExrLayer {
                name: Some("light.key".into()),
                channels: vec![("B".into(), ChannelData::F16(ramp(n)))],
            },
            ExrLayer {
                name: Some("objectId".into()),
                channels: vec![(
                    "id".into(),
                    ChannelData::U32((0..n as u32).map(|i| u32::MAX - i).collect()),
                )],
            },
        ],
        attributes: [("comments", "Kúla"), ("kajo/scene", "a.txt"), ("kajo/spp", "64"), ("software", "kajo")]
            .map(|(k, v)| (k.to_owned(), v.to_owned()))
            .to_vec(),
    }
}

#[test]
fn every_layer_channel_and_remark_round_trips() {
    for encode in [encode, encode_quickly] {
        let bytes = encode(render()).unwrap();
        assert_eq!(decode(&bytes, &DecodeLimits::default()).unwrap(), render());
    }
}

#[test]
fn the_same_picture_gives_the_same_bytes() {
    let first = encode(render()).unwrap();
    // Every map of the underlying crate has its own seed, so eight runs would differ.
    for _ in 0..8 {
        assert!(encode(render()).unwrap() == first);
    }
}

#[test]
fn long_names_are_kept() {
    let mut picture = render();
    picture.layers[1].name = Some("n".repeat(200));
    let bytes = encode(picture).unwrap();
    assert!(decode(&bytes, &DecodeLimits::default()).unwrap().layer(Some(&"n".repeat(200))).is_some());
}

#[test]
fn contradictions_are_refused() {
    let refused = |change: fn(&mut ExrPicture)| {
        let mut picture = render();
        change(&mut picture);
        matches!(encode(picture), Err(ImageError::Parameter(_)))
    };
    assert!(refused(|p| p.width = 0));
    assert!(refused(|p| p.height += 1));
    assert!(refused(|p| p.layers.clear()));
    assert!(refused(|p| p.layers[1].name = Some(String::new())));
    assert!(refused(|p| p.layers[1].name = Some("n".repeat(300))));
    assert!(refused(|p| p.layers[1].name = Some("a\0b".into())));
    assert!(refused(|p| p.layers[0].channels[0].0 = String::new()));
    assert!(refused(|p| p.layers[0].channels[0].0 = "R".into()));
    assert!(refused(|p| p.attributes[0].0 = String::new()));
    assert!(!refused(|_| ()));
}

#[test]
fn the_main_picture_is_colour_with_alpha() {
    let image = render().main_image().unwrap();
    assert_eq!(image.channels(), 4);
    assert_eq!(image.pixel(1, 0), [-3.0, -2.25, -1.5, -0.75]);
}

#[test]
fn layers_of_every_shape_become_pictures() {
    let channels = |names: &[&str]| {
        let layer = ExrLayer {
            name: None,
            channels: names.iter().map(|&n| (n.to_owned(), ChannelData::U32(vec![7]))).collect(),
        };
        layer.to_image(1, 1).map(|image| image.channels())
    };
    assert_eq!(channels(&["Y"]), Ok(1));
    assert_eq!(channels(&["A", "Y"]), Ok(2));
    assert_eq!(channels(&["B", "G", "R", "Z"]), Ok(3));
    assert_eq!(channels(&["X", "Y", "Z"]), Ok(3), "not luminance");
    assert_eq!(channels(&["U", "V"]), Ok(1));
    assert_eq!(channels(&["a", "b", "c", "d"]), Ok(3));
    assert!(channels(&[]).is_err());
    assert!(render().layers[0].to_image(9, 36).is_err());
}

#[test]
fn images_round_trip_through_the_common_entry() {
    let image = Image::from_fn(5, 3, |x, y| [x as f32, y as f32, -0.5]).unwrap();
    let options = EncodeOptions { text: vec![("software".into(), "kajo".into())], ..Default::default() };
    let bytes = crate::encode(&image, Format::Exr, &options).unwrap();
    let decoded = crate::decode(&bytes, None, &DecodeLimits::default()).unwrap();
    assert_eq!(decoded.image, image);
    assert_eq!(decoded.text, options.text);
}

#[test]
fn limits_count_every_channel() {
    let bytes = encode(render()).unwrap();
    // The picture, and the unpacking of a chunk of 16 lines.
    let needed = 9 * 37 * 10 * 4 + 9 * 16 * (10 * 4 * 8 + 16);
    assert!(decode(&bytes, &DecodeLimits { max_bytes: needed, ..Default::default() }).is_ok());
    let short = decode(&bytes, &DecodeLimits { max_bytes: needed - 1, ..Default::default() });
    assert!(matches!(short, Err(ImageError::Limit { what: "memory in bytes", .. })), "{short:?}");
}

/// A file of several parts, as other programs write it; `names` are parts and their channel.
fn parts(sizes: [usize; 3], names: [(&str, &str); 3]) -> Vec<u8> {
    use ::exr::prelude::*;
    let layers: Vec<Layer<AnyChannels<FlatSamples>>> = names
        .iter()
        .zip(sizes)
        .map(|(&(part, channel), size)| {
            let channel = AnyChannel::new(channel, FlatSamples::F32(vec![size as f32; size * 2]));
            let channels = AnyChannels::sort(SmallVec::from_vec(vec![channel]));
            Layer::new((size, 2), LayerAttributes::named(part), Encoding::FAST_LOSSLESS, channels)
        })
        .collect();
    let attributes = ImageAttributes::with_size((sizes[0], 2));
    let mut bytes = std::io::Cursor::new(Vec::new());
    ::exr::image::Image::from_layers(attributes, layers).write().to_buffered(&mut bytes).unwrap();
    bytes.into_inner()
}

#[test]
fn parts_become_layers() {
    let file = parts([3; 3], [("rgba", "Y"), ("depth", "Z"), ("whatever", "diffuse.R")]);
    let picture = decode(&file, &DecodeLimits::default()).unwrap();
    let names: Vec<_> =
        picture.layers.iter().map(|l| (l.name.as_deref(), l.channels[0].0.as_str())).collect();
    assert_eq!(names, [(None, "Y"), (Some("depth"), "Z"), (Some("diffuse"), "R")]);
}

#[test]
fn parts_of_different_sizes_are_not_supported() {
    let file = parts([3, 3, 4], [("a", "Y"), ("b", "Z"), ("c", "R")]);
    let result = decode(&file, &DecodeLimits::default());
    assert!(matches!(result, Err(ImageError::Unsupported { .. })), "{result:?}");
}

/// A file of one chunk of DWA compression, with the channels of a picture as 16-bit floats and a whole number `id`: samples
/// of all three kinds of packing.
fn dwa(size: usize) -> Vec<u8> {
    use ::exr::prelude::*;
    let plane = || FlatSamples::F16((0..size * size).map(|i| f16::from_f32(i as f32 * 0.01)).collect());
    let mut channels: SmallVec<[_; 4]> =
        ["A", "B", "G", "R"].into_iter().map(|name| AnyChannel::new(name, plane())).collect();
    channels.push(AnyChannel::new("id", FlatSamples::U32((0..(size * size) as u32).collect())));
    let encoding = Encoding {
        compression: Compression::DWAA(None),
        blocks: Blocks::ScanLines,
        line_order: LineOrder::Increasing,
    };
    let layer = Layer::new((size, size), LayerAttributes::default(), encoding, AnyChannels::sort(channels));
    let mut bytes = std::io::Cursor::new(Vec::new());
    ::exr::image::Image::from_layer(layer).write().non_parallel().to_buffered(&mut bytes).unwrap();
    bytes.into_inner()
}

/// Where the eleven numbers of the first chunk stand: behind the header and the table, `y`, and the length.
fn numbers_of_dwa(file: &[u8]) -> usize {
    let version = 2_u64.to_le_bytes();
    let place = file.windows(8).rposition(|bytes| bytes == version).expect("one chunk of version 2");
    assert!(place > 100);
    place
}

#[test]
fn sizes_in_a_dwa_chunk_are_compared_with_its_pixels() {
    let good = dwa(32);
    let picture = decode(&good, &DecodeLimits::default()).unwrap();
    let ids = picture.layer(None).and_then(|layer| layer.channel("id"));
    assert_eq!(ids, Some(&ChannelData::U32((0..1024).collect())));
    let numbers = numbers_of_dwa(&good);
    for index in 1..10 {
        for claimed in [1 << 18, 1 << 32, 1 << 40, i64::MAX as u64, u64::MAX] {
            let mut bad = good.clone();
            bad[numbers + 8 * index..][..8].copy_from_slice(&u64::to_le_bytes(claimed));
            match decode(&bad, &DecodeLimits::default()) {
                Err(ImageError::Malformed { reason, .. }) => {
                    assert!(reason.contains("DWA chunk"), "{index}: {reason}");
                }
                other => panic!("{index} of {claimed}: {other:?}"),
            }
        }
    }
}

#[test]
fn damaged_files_of_every_compression_end_in_an_error_or_a_picture() {
    let zip = encode(render()).unwrap();
    let limits = DecodeLimits { max_side: 4096, max_bytes: 1 << 26 };
    for whole in [zip, dwa(16)] {
        for i in 0..whole.len() {
            let _ = decode(&whole[..i], &limits);
            for value in [0x00, 0x7f, 0xff] {
                let mut damaged = whole.clone();
                damaged[i] = value;
                let _ = decode(&damaged, &limits);
            }
        }
    }
}

#[test]
fn a_chunk_that_comes_twice_is_refused() {
    let mut file = encode(render()).unwrap();
    // 37 lines are three chunks; the table of their places ends where the first one begins.
    let first = (0..file.len())
        .find(|&i| file[i..].starts_with(&(i as u64 + 24).to_le_bytes()))
        .expect("a table of three");
    let (table, place) = (first + 8, file[first..first + 8].to_vec());
    file[table..table + 8].copy_from_slice(&place);
    let result = decode(&file, &DecodeLimits::default());
    assert!(
        matches!(&result, Err(ImageError::Malformed { reason, .. }) if reason.contains("twice")),
        "{result:?}"
    );
}
