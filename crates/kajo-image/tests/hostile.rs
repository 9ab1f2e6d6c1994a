//! Damaged and hostile files of every format: an error or a picture within the limits,
//! never a panic and never more memory than allowed.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use kajo_image::exr::{ChannelData, ExrLayer, ExrPicture};
use kajo_image::{BitDepth, DecodeLimits, EncodeOptions, Format, Image, ImageError, decode, encode, exr};
use png::text_metadata::ITXtChunk;

const LIMITS: DecodeLimits = DecodeLimits { max_side: 4096, max_bytes: 1 << 20 };
/// What decoders may use beside pixels: tables of the decompressors, headers, messages.
const WORKING_MEMORY: usize = 4 << 20;
const MUTANTS_PER_FILE: u32 = 3000;

/// Counts this thread's live and largest memory.
struct Counting;

thread_local! {
    static LIVE: Cell<isize> = const { Cell::new(0) };
    static PEAK: Cell<isize> = const { Cell::new(0) };
}

fn count(change: isize) {
    // The cells are gone while a thread ends; nothing is measured then.
    let _ = LIVE.try_with(|live| {
        live.set(live.get() + change);
        let _ = PEAK.try_with(|peak| peak.set(peak.get().max(live.get())));
    });
}

#[expect(unsafe_code, reason = "the allocator's interface; both methods pass on to the system's")]
// SAFETY: every call is passed on unchanged, so the system allocator's guarantees hold.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count(layout.size() as isize);
        // SAFETY: the caller's promises are those `System` asks for.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, ptr: *mut u8, layout: Layout) {
        count(-(layout.size() as isize));
        // SAFETY: `ptr` came from `System` above.
        unsafe { System.dealloc(ptr, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// SplitMix64 [Steele et al. 2014].
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, n: usize) -> usize {
        (self.next() % n as u64) as usize
    }
}

/// One to eight changes: bytes, runs and numbers overwritten, pieces cut or repeated.
fn mutate(file: &[u8], random: &mut Random) -> Vec<u8> {
    const NUMBERS: [u32; 8] = [0, 1, 0xff, 0xffff, 0x7fff_ffff, 0x8000_0000, 0xffff_fffe, u32::MAX];
    let mut bytes = file.to_vec();
    for _ in 0..=random.below(8) {
        if bytes.len() < 8 {
            break;
        }
        // Headers decide most, so half of the changes go there.
        let range = if random.below(2) == 0 { bytes.len() } else { bytes.len().min(400) };
        let at = random.below(range - 4);
        match random.below(6) {
            0 => bytes[at] = random.next() as u8,
            1 => bytes[at] ^= 1 << random.below(8),
            2 => bytes[at..at + 4].copy_from_slice(&NUMBERS[random.below(8)].to_le_bytes()),
            3 => bytes[at..at + 4].copy_from_slice(&NUMBERS[random.below(8)].to_be_bytes()),
            4 => bytes.truncate(at),
            _ => {
                let piece = bytes[at..(at + random.below(40)).min(bytes.len())].to_vec();
                bytes.splice(at..at, piece);
            }
        }
    }
    bytes
}

fn layered_exr() -> Vec<u8> {
    let plane = |k: usize| ChannelData::F32((0..600).map(|i| (i * k % 97) as f32).collect());
    let layer = |name: Option<&str>, names: &[&str]| ExrLayer {
        name: name.map(str::to_owned),
        channels: names.iter().enumerate().map(|(k, &n)| (n.to_owned(), plane(k + 1))).collect(),
    };
    let ids = ChannelData::U32((0..600).collect());
    let mut layers = vec![layer(None, &["R", "G", "B", "A"]), layer(Some("N"), &["X", "Y", "Z"])];
    layers.push(ExrLayer { name: Some("id".into()), channels: vec![("id".into(), ids)] });
    exr::encode(ExrPicture {
        width: 30,
        height: 20,
        layers,
        chromaticities: None,
        attributes: vec![("software".into(), "kajo".into())],
    })
    .unwrap()
}

fn corpus() -> Vec<(Format, Vec<u8>)> {
    let image = Image::from_fn(23, 17, |x, y| [x as f32 / 23.0, y as f32 / 17.0, 0.5, 1.0]).unwrap();
    let mut files = vec![(Format::Exr, layered_exr())];
    for format in Format::ALL {
        for channels in [1, 3, 4] {
            let image = image.with_channels(channels).unwrap();
            files.push((format, encode(&image, format, &EncodeOptions::default()).unwrap()));
        }
    }
    let deep = EncodeOptions { depth: BitDepth::Sixteen, ..Default::default() };
    files.push((Format::Png, encode(&image, Format::Png, &deep).unwrap()));
    files.push((Format::Ppm, b"P3\n2 2\n255\n1 2 3 4 5 6 7 8 9 10 11 12\n".to_vec()));
    files.push((Format::Ppm, b"P1\n4 2\n1 0 1 0 0 1 0 1\n".to_vec()));
    files.push((
        Format::Ppm,
        b"P7\nWIDTH 1\nHEIGHT 1\nDEPTH 3\nMAXVAL 255\nTUPLTYPE RGB\nENDHDR\nabc".to_vec(),
    ));
    files
}

fn check(format: Format, bytes: &[u8]) {
    let before = LIVE.get();
    PEAK.set(before);
    let result = decode(bytes, Some(format), &LIMITS);
    let used = (PEAK.get() - before) as usize;
    assert!(
        used <= LIMITS.max_bytes as usize + WORKING_MEMORY + 8 * bytes.len(),
        "{format}: {used} bytes for a file of {}: {result:?}",
        bytes.len()
    );
    match result {
        Ok(decoded) => assert!(decoded.image.data().len() as u64 * 4 <= LIMITS.max_bytes),
        Err(error) => {
            assert!(!matches!(error, ImageError::Parameter(_)), "{format}: blames the caller: {error}")
        }
    }
}

#[test]
fn mutated_files_end_in_an_error_or_a_small_picture() {
    for (seed, (format, file)) in corpus().into_iter().enumerate() {
        decode(&file, Some(format), &LIMITS).unwrap();
        let mut random = Random(seed as u64);
        for _ in 0..MUTANTS_PER_FILE {
            check(format, &mutate(&file, &mut random));
        }
    }
}

/// Sixteen megabytes of text that take some kilobytes in the file are left out.
#[test]
fn texts_that_are_packed_too_well_are_left_out() {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 1, 1);
    encoder.set_color(png::ColorType::Grayscale);
    let mut writer = encoder.write_header().unwrap();
    for (keyword, length) in [("long", 16 << 20), ("short", 1000)] {
        let mut chunk = ITXtChunk::new(keyword, " ".repeat(length));
        chunk.compressed = true;
        chunk.compress_text().unwrap();
        writer.write_text_chunk(&chunk).unwrap();
    }
    writer.write_image_data(&[7]).unwrap();
    writer.finish().unwrap();
    assert!(bytes.len() < 1 << 18, "{} bytes", bytes.len());
    check(Format::Png, &bytes);
    let decoded = decode(&bytes, Some(Format::Png), &LIMITS).unwrap();
    assert_eq!(decoded.text, [("short".to_owned(), " ".repeat(1000))]);
}

/// Makes the checksums of PNG chunks right again, so that the damage is believed.
fn repair_checksums(file: &mut [u8]) {
    let mut start = 8;
    while let Some(len) = file.get(start..start + 4) {
        let end = start + 8 + u32::from_be_bytes([len[0], len[1], len[2], len[3]]) as usize;
        if end + 4 > file.len() {
            return;
        }
        let mut crc = u32::MAX;
        for &byte in &file[start + 4..end] {
            crc ^= u32::from(byte);
            for _ in 0..8 {
                crc = (crc >> 1) ^ (0xedb8_8320 & (crc & 1).wrapping_neg());
            }
        }
        file[end..end + 4].copy_from_slice(&(!crc).to_be_bytes());
        start = end + 4;
    }
}

#[test]
fn damage_with_right_checksums_ends_in_an_error_or_a_small_picture() {
    let files = corpus().into_iter().filter(|(format, _)| *format == Format::Png);
    for (seed, (format, file)) in files.enumerate() {
        let mut untouched = file.clone();
        repair_checksums(&mut untouched);
        assert_eq!(untouched, file);
        let mut random = Random(1000 + seed as u64);
        for _ in 0..MUTANTS_PER_FILE {
            let mut mutant = mutate(&file, &mut random);
            repair_checksums(&mut mutant);
            check(format, &mutant);
        }
    }
}

#[test]
fn truncated_files_end_in_an_error_or_a_small_picture() {
    for (format, file) in corpus() {
        for len in 0..file.len() {
            check(format, &file[..len]);
        }
    }
}

#[test]
fn noise_is_no_picture() {
    let mut random = Random(99);
    for len in 0..2000 {
        let bytes: Vec<u8> = (0..len).map(|_| random.next() as u8).collect();
        for format in Format::ALL {
            check(format, &bytes);
        }
    }
}

#[test]
fn huge_sizes_are_refused_by_the_header_alone() {
    let huge: [(Format, &[u8]); 4] = [
        (Format::Ppm, b"P6\n1000000 1000000\n255\n"),
        (Format::Pfm, b"PF\n4000000000 4000000000\n-1\n"),
        (Format::Hdr, b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1000000 +X 1000000\n"),
        (Format::Tga, &[0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xff, 0xff, 0xff, 0xff, 24, 0]),
    ];
    for (format, bytes) in huge {
        check(format, bytes);
        let result = decode(bytes, Some(format), &LIMITS);
        assert!(matches!(result, Err(ImageError::Limit { .. })), "{format}: {result:?}");
    }
    // Beyond 2⁶⁴ bytes the decoders themselves give up.
    let absurd: [(Format, &[u8]); 2] = [
        (Format::Ppm, b"P6\n4000000000 4000000000\n255\n"),
        (Format::Hdr, b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4000000000 +X 4000000000\n"),
    ];
    for (format, bytes) in absurd {
        check(format, bytes);
        assert!(decode(bytes, None, &LIMITS).is_err(), "{format}");
    }
}
