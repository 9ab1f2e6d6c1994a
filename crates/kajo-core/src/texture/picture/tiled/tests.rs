//! Tiled copies have the texels of the pictures that they are made of, whatever becomes of them.

use std::collections::BTreeMap;
use std::io::{self, Cursor, Write};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};

use kajo_image::{EncodeOptions, Format, Image, encode};
use kajo_math::rng::Stream;
use kajo_math::{Vec2, Vec3};
use kajo_scene::{AssetError, AssetFile, Reopen};

use super::format::ReadAt;
use super::*;
use crate::texture::{
    Encoding, Picture, PictureMap, SurfaceUv, TexelFilter, TextureContext, TextureFootprint, Wrap,
};

/// Files in memory.
#[derive(Clone, Debug, Default)]
struct MemoryFiles {
    files: Arc<Mutex<BTreeMap<String, Vec<u8>>>>,
    reads: Arc<AtomicUsize>,
}

struct MemoryFile {
    bytes: Vec<u8>,
    reads: Arc<AtomicUsize>,
}

impl ReadAt for MemoryFile {
    fn bytes(&self) -> io::Result<u64> {
        Ok(self.bytes.len() as u64)
    }

    fn read_at(&self, offset: u64, buffer: &mut [u8]) -> io::Result<()> {
        self.reads.fetch_add(buffer.len(), Ordering::Relaxed);
        let rest = usize::try_from(offset).ok().and_then(|offset| self.bytes.get(offset..));
        let found = rest.and_then(|rest| rest.get(..buffer.len())).ok_or(io::ErrorKind::UnexpectedEof)?;
        buffer.copy_from_slice(found);
        Ok(())
    }
}

impl TileFiles for MemoryFiles {
    fn open(&self, name: &str) -> io::Result<Box<dyn ReadAt>> {
        let files = self.files.lock().unwrap();
        let bytes = files.get(name).ok_or(io::ErrorKind::NotFound)?.clone();
        Ok(Box::new(MemoryFile { bytes, reads: Arc::clone(&self.reads) }))
    }

    fn write(&self, name: &str, content: &mut dyn FnMut(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
        let mut bytes = Vec::new();
        content(&mut bytes)?;
        self.files.lock().unwrap().insert(name.to_owned(), bytes);
        Ok(())
    }
}

/// A picture that is neither smooth nor of few colours, with alpha.
fn noisy(width: u32, height: u32) -> Image {
    Image::from_fn(width, height, |x, y| {
        let s = Stream::new(8, [x / 3, y], 0);
        [s.uniform(0), x as f32 / width as f32, y as f32 / height as f32, s.uniform(1)]
    })
    .unwrap()
}

/// The file of a picture, which says the stamp 7 until it is taken away.
fn source(bytes: Option<Vec<u8>>) -> Reopen {
    Reopen::new("/folder/a.png", move || {
        let bytes = bytes.clone().ok_or(AssetError::NotFound)?;
        let (path, len) = ("a.png".to_owned(), Some(bytes.len() as u64));
        Ok(AssetFile { path, len, stamp: Some(7), reopen: None, reader: Box::new(Cursor::new(bytes)) })
    })
}

struct Made {
    files: MemoryFiles,
    copies: TiledCopies,
    source: Reopen,
    whole: Arc<Picture>,
}

impl Made {
    /// The tiled copy of a picture as its file has it.
    fn new(image: &Image, format: Format, encoding: Encoding, limit: u64) -> Made {
        let bytes = encode(image, format, &EncodeOptions::default()).unwrap();
        let image =
            kajo_image::decode(&bytes, Some(format), &kajo_image::DecodeLimits::default()).unwrap().image;
        let files = MemoryFiles::default();
        let cache = Arc::new(TileCache::new(Box::new(files.clone()), limit));
        let copies = TiledCopies { cache, rule: TilingRule::All };
        let (whole, outside) = Picture::new(&image, encoding);
        let source = source(Some(bytes));
        copies.make(&whole, &source, (None, encoding), (7, outside)).unwrap();
        Made { files, copies, source, whole: Arc::new(whole) }
    }

    fn open(&self) -> Arc<Picture> {
        Arc::new(self.copies.open(&self.source, None, 7).unwrap().0)
    }

    fn damage(&self, damage: impl FnMut(&mut Vec<u8>)) {
        self.files.files.lock().unwrap().values_mut().for_each(damage);
    }
}

fn contexts() -> impl Iterator<Item = TextureContext> {
    (0..300u32).map(|i| {
        let s = Stream::new(9, [i, 0], 0);
        let uv = 3.0 * Vec2::new(s.uniform(0), s.uniform(1)) - 1.0;
        let width = 0.6 * s.uniform(2).powi(4);
        let duv = [Vec2::new(width, 0.2 * width), Vec2::new(-0.1 * width, width * s.uniform(3))];
        TextureContext {
            p: Vec3::new(uv.x, uv.y, 0.0),
            uv: SurfaceUv::from(uv),
            footprint: TextureFootprint { uv: duv, ..TextureFootprint::default() },
            ..TextureContext::default()
        }
    })
}

const FILTERS: [TexelFilter; 8] = [
    TexelFilter::Nearest,
    TexelFilter::Bilinear,
    TexelFilter::Bicubic,
    TexelFilter::Trilinear,
    TexelFilter::Sat,
    TexelFilter::Ewa,
    TexelFilter::Feline,
    TexelFilter::Stochastic,
];

#[test]
fn every_filter_finds_the_bits_of_the_whole_picture() {
    for (width, height) in [(200, 130), (64, 64), (65, 1), (1, 300), (3, 2)] {
        for (format, encoding) in [(Format::Png, Encoding::Srgb), (Format::Exr, Encoding::Linear)] {
            let made = Made::new(&noisy(width, height), format, encoding, 100_000);
            let tiled = made.open();
            assert_eq!(tiled.size(), made.whole.size());
            assert_eq!(tiled.mean, made.whole.mean);
            for (i, filter) in FILTERS.into_iter().enumerate() {
                let wrap = [[Wrap::Repeat, Wrap::Mirror, Wrap::Clamp, Wrap::Once][i % 4]; 2];
                let [a, b] = [&made.whole, &tiled].map(|picture| {
                    picture.prepare(filter);
                    PictureMap { filter, wrap, ..PictureMap::new(Arc::clone(picture)) }
                });
                for at in contexts() {
                    let [a, b] = [&a, &b].map(|map| map.filtered(&at).map(f32::to_bits));
                    assert_eq!(a, b, "{width} x {height} {filter:?} {:?}", at.uv.first);
                }
            }
        }
    }
}

#[test]
fn eight_bits_of_a_file_are_eight_bits_of_the_copy() {
    let size = |format, encoding| {
        let made = Made::new(&noisy(256, 256), format, encoding, 1);
        let files = made.files.files.lock().unwrap();
        files.values().map(Vec::len).sum::<usize>()
    };
    let (narrow, wide) = (size(Format::Png, Encoding::Srgb), size(Format::Exr, Encoding::Linear));
    assert!(narrow < 256 * 256 * 5 && narrow < wide, "{narrow} {wide}");
}

#[test]
fn only_what_is_seen_is_read() {
    let made = Made::new(&noisy(1024, 1024), Format::Png, Encoding::Srgb, 1 << 20);
    let all: usize = made.files.files.lock().unwrap().values().map(Vec::len).sum();
    let map = PictureMap::new(made.open());
    for _ in 0..100 {
        map.at(Vec2::new(0.3, 0.4));
    }
    let read = made.files.reads.load(Ordering::Relaxed);
    assert!(read > 1000 && read < all / 50, "{read} of {all}");
    assert!(made.copies.cache.bytes() > 0);
}

#[test]
fn threads_share_a_cache_that_is_too_small() {
    let made = Made::new(&noisy(640, 640), Format::Png, Encoding::Srgb, 1);
    let [whole, tiled] = [Arc::clone(&made.whole), made.open()].map(|picture| {
        picture.prepare(TexelFilter::Ewa);
        PictureMap { filter: TexelFilter::Ewa, ..PictureMap::new(picture) }
    });
    std::thread::scope(|scope| {
        for _ in 0..3 {
            scope.spawn(|| {
                for at in contexts() {
                    assert_eq!(whole.filtered(&at), tiled.filtered(&at));
                }
            });
        }
    });
}

#[test]
fn a_damaged_tile_is_made_anew_from_the_file() {
    let made = Made::new(&noisy(300, 200), Format::Png, Encoding::Srgb, 1 << 20);
    // In the middle of the first tile.
    made.damage(|bytes| bytes[200..260].fill(0xa5));
    let (whole, tiled) = (PictureMap::new(Arc::clone(&made.whole)), PictureMap::new(made.open()));
    let uv = Vec2::new(0.05, 0.95);
    assert_eq!(tiled.at(uv), whole.at(uv));
    assert!(made.copies.cache.take_problems().is_empty());
    // The copy is whole again.
    let other = TiledCopies {
        cache: Arc::new(TileCache::new(Box::new(made.files.clone()), 1 << 20)),
        rule: TilingRule::All,
    };
    let again = PictureMap::new(Arc::new(other.open(&source(None), None, 7).unwrap().0));
    assert_eq!(again.at(uv), whole.at(uv));
    assert!(other.cache.take_problems().is_empty());
}

#[test]
fn without_its_file_a_damaged_tile_is_the_mean_and_that_is_said() {
    let made = Made::new(&noisy(300, 200), Format::Png, Encoding::Srgb, 1 << 20);
    made.damage(|bytes| bytes[200..260].fill(0xa5));
    let lost = Made { source: source(None), ..made };
    let map = PictureMap::new(lost.open());
    let found = map.at(Vec2::new(0.05, 0.95));
    for (found, mean) in found.into_iter().zip(lost.whole.mean) {
        assert!((found - mean).abs() < 1e-4);
    }
    let problems = lost.copies.cache.take_problems();
    assert!(problems.len() == 1 && problems[0].contains("/folder/a.png"), "{problems:?}");
}

#[test]
fn copies_that_are_cut_old_or_no_copies_are_refused() {
    let refused = |damage: &mut dyn FnMut(&mut Vec<u8>)| {
        let made = Made::new(&noisy(100, 90), Format::Png, Encoding::Srgb, 1 << 20);
        made.damage(damage);
        made.copies.open(&made.source, None, 7).err()
    };
    assert!(refused(&mut |_| {}).is_none());
    for n in [0, 1, 19, 20, 60, 5000] {
        assert!(matches!(refused(&mut |bytes| bytes.truncate(n)), Some(TiledError::Damaged)), "{n} bytes");
    }
    assert!(matches!(refused(&mut |bytes| bytes.fill(0)), Some(TiledError::Damaged)));
    assert!(matches!(refused(&mut |bytes| bytes.fill(0xff)), Some(TiledError::Damaged)));
    // Every byte of the description and of what follows it.
    let made = Made::new(&noisy(100, 90), Format::Png, Encoding::Srgb, 1 << 20);
    let len = made.files.files.lock().unwrap().values().next().unwrap().len();
    let mut refusals = 0;
    for at in len - 80..len {
        made.damage(|bytes| bytes[at] ^= 0x40);
        // The last bits of a stream mean nothing.
        if let Ok((picture, outside)) = made.copies.open(&made.source, None, 7) {
            assert_eq!(
                (picture.size(), picture.mean, outside),
                ([100, 90], made.whole.mean, 0),
                "byte {at} of {len}"
            );
        } else {
            refusals += 1;
        }
        made.damage(|bytes| bytes[at] ^= 0x40);
    }
    assert!(refusals > 60, "{refusals} of 80");
    assert!(matches!(made.copies.open(&made.source, None, 8), Err(TiledError::Outdated)));
    assert!(matches!(
        made.copies.open(&made.source, Some(Encoding::Linear), 7),
        Err(TiledError::Io(error)) if error.kind() == io::ErrorKind::NotFound
    ));
}

#[test]
fn small_pictures_stay_in_memory() {
    assert!(!TilingRule::All.wants(0, 1000) && TilingRule::All.wants(0, 1 << 20));
    let beyond = TilingRule::Beyond(10 << 20);
    assert!(!beyond.wants(0, 10 << 20) && beyond.wants(1, 10 << 20) && !beyond.wants(u64::MAX, 1000));
}
