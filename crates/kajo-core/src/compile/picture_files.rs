//! Pictures of files: each is read once, and is kept as a whole or by tiles.

use std::collections::HashMap;
use std::fmt;
use std::sync::Arc;

use kajo_image::{DecodeLimits, Decoded, Format, ImageError};
use kajo_scene::{AssetFile, Assets, MemoryBudget, OverBudget, Reopen, read_limited};

use super::CompileOptions;
use crate::texture::{Encoding, Picture, PictureMap, TexelFilter, TiledCopies, TilingRule, content_stamp};

/// Pictures read so far, by their paths and what their colours are said to mean; `None` where one cannot be read.
#[derive(Default)]
pub(super) struct PictureCache {
    pictures: HashMap<(String, Option<Encoding>), Option<Arc<Picture>>>,
    /// How those are filtered that do not say it themselves.
    pub filter: TexelFilter,
    /// Bytes of those in memory.
    resident: u64,
    /// Whether the memory of the cache of tiles has been taken.
    has_tiles: bool,
}

/// Reads pictures, each once.
pub(super) struct PictureReader<'a> {
    assets: &'a dyn Assets,
    /// Bytes of the largest file.
    limit: u64,
    pub memory: &'a MemoryBudget,
    tiled: Option<&'a TiledCopies>,
    cache: &'a mut PictureCache,
}

impl<'a> PictureReader<'a> {
    pub fn new(
        assets: &'a dyn Assets,
        options: &'a CompileOptions,
        cache: &'a mut PictureCache,
    ) -> PictureReader<'a> {
        let (limit, memory) = (options.limits.picture_bytes, &options.limits.memory);
        PictureReader { assets, limit, memory, tiled: options.tiled.as_ref(), cache }
    }
}

impl PictureReader<'_> {
    /// The picture of a file, and what is wrong with it when it is read for the first time.
    ///
    /// * `from`: the path of the file that names it
    pub fn picture(&mut self, name: &str, from: &str, encoding: Option<Encoding>) -> ReadPicture {
        let file = self.assets.open(name, from).map_err(|error| Problem::Unreadable(error.to_string()))?;
        let (key, limit, memory) = ((file.path.clone(), encoding), self.limit, self.memory);
        let copies = self.tiled.zip(file.reopen.clone()).zip(file.stamp);
        let copies = copies.map(|((copies, source), stamp)| Copies { copies, source, encoding, stamp });
        self.cached(key, copies, || read_picture(file, format_of(name), limit, memory))
    }

    /// The picture of bytes that another file holds, under a name of its own.
    ///
    /// * `source`: how its bytes are had again, with a stamp of the content, where that can be
    pub fn held(
        &mut self,
        bytes: &[u8],
        name: &str,
        encoding: Option<Encoding>,
        source: Option<Reopen>,
    ) -> ReadPicture {
        let memory = self.memory;
        let copies = self.tiled.zip(source);
        let copies = copies.map(|(copies, source)| {
            let stamp = content_stamp(bytes);
            Copies { copies, source, encoding, stamp }
        });
        self.cached((name.to_owned(), encoding), copies, || decode(bytes, None, memory))
    }

    /// How pictures are filtered that do not say it themselves.
    pub fn filter(&self) -> TexelFilter {
        self.cache.filter
    }

    /// The picture as it lies where nothing is said.
    ///
    /// # Errors
    /// Where there is no memory for its filter.
    pub fn laid(&self, picture: Arc<Picture>) -> Result<PictureMap, Problem> {
        let filter = self.cache.filter;
        self.prepare(&picture, filter).map_err(|over| Problem::Unreadable(over.to_string()))?;
        Ok(PictureMap { filter, ..PictureMap::new(picture) })
    }

    /// Makes what a filter needs besides the texels, once for all that ask for it.
    ///
    /// # Errors
    /// Where there is no memory for it.
    pub fn prepare(&self, picture: &Picture, filter: TexelFilter) -> Result<(), OverBudget> {
        self.memory.take(picture.preparation(filter))?;
        picture.prepare(filter);
        Ok(())
    }

    /// * `copies`: where its tiled copy is, if it may have one
    fn cached(
        &mut self,
        key: (String, Option<Encoding>),
        copies: Option<Copies<'_>>,
        read: impl FnOnce() -> Result<Decoded, String>,
    ) -> ReadPicture {
        match self.cache.pictures.get(&key) {
            Some(Some(known)) => return Ok((Arc::clone(known), None)),
            Some(None) => return Err(Problem::Unreadable("it could not be read before".to_owned())),
            None => {}
        }
        let tiled = copies.as_ref().and_then(|copies| self.in_tiles(copies));
        let read = match tiled {
            Some(tiled) => tiled,
            None => read().and_then(|decoded| self.made(&decoded, key.1, copies)),
        };
        let read = read.map_err(Problem::Unreadable).map(|(picture, outside)| {
            (Arc::new(picture), (outside > 0).then_some(Problem::Outside(outside)))
        });
        self.cache.pictures.insert(key, read.as_ref().ok().map(|(picture, _)| Arc::clone(picture)));
        read
    }

    /// The picture of a tiled copy, where there is one and it is wanted.
    fn in_tiles(&mut self, copies: &Copies<'_>) -> Option<Result<(Picture, usize), String>> {
        let Copies { copies, source, encoding, stamp } = copies;
        let (picture, outside) = copies.open(source, *encoding, *stamp).ok()?;
        let [width, height] = picture.size();
        let is_wanted = copies.rule.wants(self.cache.resident, Picture::bytes(width, height));
        let tiled = is_wanted.then(|| self.take_tiles(copies).map(|()| (picture, outside)))?;
        (tiled.is_ok() || copies.rule == TilingRule::All).then_some(tiled)
    }

    /// The picture of a file, in memory or in tiles.
    fn made(
        &mut self,
        decoded: &Decoded,
        encoding: Option<Encoding>,
        copies: Option<Copies<'_>>,
    ) -> Result<(Picture, usize), String> {
        // Until the texels are made there are the floats of the file, too.
        let floats = size_of_val(decoded.image.data()) as u64;
        let _floats = self.memory.share(floats).map_err(|over| over.to_string())?;
        let bytes = Picture::bytes(decoded.image.width(), decoded.image.height());
        let mut texels = self.memory.share(bytes).map_err(|over| over.to_string())?;
        let whole = if decoded.depth.is_some() { Encoding::Srgb } else { Encoding::Linear };
        let used = encoding.unwrap_or(whole);
        let (picture, outside) = Picture::new(&decoded.image, used);
        let copies = copies.filter(|copies| copies.copies.rule.wants(self.cache.resident, bytes));
        if let Some(Copies { copies, source, stamp, .. }) = copies {
            let written = copies.make(&picture, &source, (encoding, used), (stamp, outside));
            drop(texels);
            let opened = written
                .map_err(|error| format!("its tiled copy cannot be written: {error}"))
                .and_then(|()| self.take_tiles(copies))
                .and_then(|()| {
                    copies
                        .open(&source, encoding, stamp)
                        .map_err(|error| format!("its tiled copy cannot be read: {error}"))
                });
            // Unless tiles are required it stays in memory for as long as there is room.
            if opened.is_ok() || copies.rule == TilingRule::All {
                return opened;
            }
            self.memory.take(bytes).map_err(|over| over.to_string())?;
        } else {
            texels.keep(bytes).map_err(|over| over.to_string())?;
        }
        self.cache.resident += bytes;
        Ok((picture, outside))
    }

    /// Takes the memory of the tiles that are kept, once.
    fn take_tiles(&mut self, copies: &TiledCopies) -> Result<(), String> {
        if !self.cache.has_tiles {
            self.memory.take(copies.cache.limit()).map_err(|over| format!("the cache of tiles: {over}"))?;
            self.cache.has_tiles = true;
        }
        Ok(())
    }
}

/// Where the tiled copy of a file is.
struct Copies<'a> {
    copies: &'a TiledCopies,
    source: Reopen,
    /// What its colours are said to mean.
    encoding: Option<Encoding>,
    stamp: u64,
}

/// Makes the tiled copy of a picture unless there is one; answers its size in texels.
///
/// * `options`: with [`CompileOptions::tiled`]
/// * `encoding`: what its colours are said to mean
///
/// # Errors
/// Why it cannot be made, in words that complete "cannot make a copy of `x`: ...".
pub fn tile_picture(
    name: &str,
    assets: &dyn Assets,
    options: &CompileOptions,
    encoding: Option<Encoding>,
) -> Result<[u32; 2], String> {
    let mut cache = PictureCache::default();
    let read = PictureReader::new(assets, options, &mut cache).picture(name, "", encoding);
    let (picture, _) = read.map_err(|problem| problem.to_string())?;
    if cache.resident > 0 {
        return Err("it is small, and always in memory as a whole".to_owned());
    }
    Ok(picture.size())
}

/// A picture, and what is wrong with it when it is read for the first time.
pub(super) type ReadPicture = Result<(Arc<Picture>, Option<Problem>), Problem>;

/// What is wrong with a picture.
pub(super) enum Problem {
    /// It cannot be read, and why.
    Unreadable(String),
    /// So many of its values are no shares.
    Outside(usize),
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Problem::Unreadable(reason) => f.write_str(reason),
            Problem::Outside(n) => write!(f, "{n} of its values are not between 0 and 1"),
        }
    }
}

/// The format that the ending of a name suggests.
pub(super) fn format_of(name: &str) -> Option<Format> {
    name.rsplit_once('.').and_then(|(_, ending)| Format::from_extension(ending))
}

/// The picture in a file of at most `limit` bytes.
pub(super) fn read_picture(
    file: AssetFile,
    hint: Option<Format>,
    limit: u64,
    memory: &MemoryBudget,
) -> Result<Decoded, String> {
    let _file = memory.share(file.len.unwrap_or(0)).map_err(|over| over.to_string())?;
    let bytes = read_limited(file, limit).map_err(|error| error.to_string())?;
    decode(&bytes, hint, memory)
}

/// The picture in the bytes of a file; `hint` is its format where they do not say.
pub(super) fn decode(bytes: &[u8], hint: Option<Format>, memory: &MemoryBudget) -> Result<Decoded, String> {
    let usual = DecodeLimits::default();
    let limits = DecodeLimits { max_bytes: usual.max_bytes.min(memory.left()), ..usual };
    kajo_image::decode(bytes, hint, &limits).map_err(|error| match error {
        ImageError::Limit { needed, limit, .. } if limit == limits.max_bytes && limit < usual.max_bytes => {
            memory.exceeded(needed).to_string()
        }
        ImageError::Memory { needed } => memory.exceeded(needed).to_string(),
        error => error.to_string(),
    })
}
