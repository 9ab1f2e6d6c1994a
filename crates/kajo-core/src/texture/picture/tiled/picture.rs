//! A picture whose texels are in a tiled copy.

use std::io;
use std::sync::{Arc, Mutex, PoisonError};

use kajo_image::{DecodeLimits, Format};
use kajo_scene::{Reopen, read_limited};

use super::cache::{TileCache, TileKey};
use super::format::{self, Description, Header, TILED_EXTENSION, TiledError};
use super::{LevelShape, SIDE, Tile, TileTexels, content_stamp};
use crate::texture::picture::pyramid::{Level, Pyramid};
use crate::texture::picture::{Encoding, Picture, stored};

/// Bytes of pictures that are never tiled.
const SMALL: u64 = 1 << 19;

/// Where tiled copies are, and for which pictures they are wanted.
#[derive(Clone, Debug)]
pub struct TiledCopies {
    /// Holds the tiles.
    pub cache: Arc<TileCache>,
    /// For which pictures.
    pub rule: TilingRule,
}

/// For which pictures tiled copies are wanted; never for those of less than 512 KiB.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TilingRule {
    /// For all.
    All,
    /// For those that do not fit into so many bytes beside the ones before them.
    Beyond(u64),
}

impl TilingRule {
    /// Whether a picture is to be tiled.
    ///
    /// * `resident`: bytes of the pictures in memory
    /// * `bytes`: of this one
    pub(crate) fn wants(self, resident: u64, bytes: u64) -> bool {
        bytes > SMALL
            && match self {
                TilingRule::All => true,
                TilingRule::Beyond(most) => resident.saturating_add(bytes) > most,
            }
    }
}

/// The texels of a picture in a tiled copy.
#[derive(Debug)]
pub(in crate::texture::picture) struct TiledPicture {
    cache: Arc<TileCache>,
    /// Its number in the cache.
    number: u32,
    name: String,
    header: Header,
    levels: Vec<LevelShape>,
    source: Reopen,
    /// One thread at a time makes a damaged copy anew.
    repair: Mutex<()>,
}

/// One of its levels.
#[derive(Clone, Copy, Debug)]
pub(in crate::texture::picture) struct TiledLevel<'a> {
    picture: &'a TiledPicture,
    shape: LevelShape,
}

/// The name of the copy of a file, read in this way.
fn name_of(source: &Reopen, encoding: Option<Encoding>) -> String {
    let kind = match encoding {
        None => "file",
        Some(Encoding::Srgb) => "srgb",
        Some(Encoding::Linear) => "linear",
    };
    let name = source.identity();
    let hash = content_stamp(format!("{name}\n{kind}").as_bytes());
    let last = name.rsplit(['/', '\\']).next().unwrap_or_default();
    let stem: String = last
        .chars()
        .map(|c| if c.is_alphanumeric() || ".-_".contains(c) { c } else { '_' })
        .take(60)
        .collect();
    format!("{stem}-{hash:016x}.{TILED_EXTENSION}")
}

impl TiledCopies {
    /// The picture of a tiled copy that there is.
    ///
    /// * `encoding`: what the colours were said to mean, as the copy was made
    /// * `stamp`: of the file that it is a copy of
    ///
    /// # Errors
    /// Where there is none, or none that is good for anything.
    pub(crate) fn open(
        &self,
        source: &Reopen,
        encoding: Option<Encoding>,
        stamp: u64,
    ) -> Result<(Picture, usize), TiledError> {
        let name = name_of(source, encoding);
        let file = self.cache.files().open(&name)?;
        let header = Header::read(&*file)?;
        let Description { size, stamp: of_copy, encoding: used, outside, mean } = header.description;
        if of_copy != stamp || encoding.is_some_and(|encoding| encoding != used) {
            return Err(TiledError::Outdated);
        }
        let tiled = TiledPicture {
            cache: Arc::clone(&self.cache),
            number: self.cache.picture(&name, stamp),
            name,
            levels: LevelShape::all(size[0], size[1]),
            header,
            source: source.clone(),
            repair: Mutex::new(()),
        };
        Ok((Picture::in_tiles(tiled, mean), usize::try_from(outside).unwrap_or(usize::MAX)))
    }

    /// Makes the tiled copy of a picture.
    ///
    /// * `asked`: what the colours are said to mean; `encoding`: what they do
    /// * `outside`: how many of its values were not between 0 and 1
    ///
    /// # Errors
    /// Those of the system.
    pub(crate) fn make(
        &self,
        picture: &Picture,
        source: &Reopen,
        (asked, encoding): (Option<Encoding>, Encoding),
        (stamp, outside): (u64, usize),
    ) -> io::Result<()> {
        let (size, outside, mean) = (picture.size(), outside as u64, picture.mean);
        let description = Description { size, encoding, stamp, outside, mean };
        let name = name_of(source, asked);
        self.cache.files().write(&name, &mut |to| write(picture, &description, to))
    }
}

/// Writes all levels of a picture in memory.
fn write(picture: &Picture, description: &Description, to: &mut dyn io::Write) -> io::Result<()> {
    let Some(texels) = picture.resident() else {
        return Err(io::Error::other("a tiled copy is made of a picture in memory"));
    };
    let pyramid = Pyramid::of(picture);
    let shapes = LevelShape::all(picture.width, picture.height);
    let above = pyramid.levels.iter().map(|level| &level.texels[..]);
    let levels: Vec<_> = shapes.into_iter().zip(std::iter::once(texels).chain(above)).collect();
    format::write(description, &levels, to)
}

impl TiledPicture {
    pub fn size(&self) -> [u32; 2] {
        self.header.description.size
    }

    /// The number of the smallest level.
    pub fn top(&self) -> usize {
        self.levels.len() - 1
    }

    /// A level of the pyramid; the smallest one for those that there are not.
    #[inline]
    pub fn level(&self, number: usize) -> TiledLevel<'_> {
        TiledLevel { picture: self, shape: self.levels[number.min(self.top())] }
    }

    /// Reads a tile of a level.
    fn load(&self, shape: LevelShape, number: u32) -> Tile {
        let read = || -> Result<Tile, TiledError> {
            let file = self.cache.files().open(&self.name)?;
            self.header.tile(&*file, shape, number)
        };
        read().unwrap_or_else(|_| {
            let _one = self.repair.lock().unwrap_or_else(PoisonError::into_inner);
            // Perhaps another thread has made it anew meanwhile.
            read().unwrap_or_else(|_| self.repaired(shape, number))
        })
    }

    /// The tile from the file that the copy is of, which is made anew.
    fn repaired(&self, shape: LevelShape, number: u32) -> Tile {
        match self.decoded() {
            Ok(picture) => {
                let description = self.header.description;
                // Where it cannot be written it is decoded again for every tile that is missing.
                let _ = self.cache.files().write(&self.name, &mut |to| write(&picture, &description, to));
                let [across, _] = shape.tiles();
                picture.tile(shape, number % across, number / across)
            }
            Err(reason) => {
                let source = self.source.identity();
                self.cache
                    .report(format!("cannot read `{source}` again, whose tiled copy is damaged: {reason}"));
                self.plain(shape, number)
            }
        }
    }

    fn decoded(&self) -> Result<Picture, String> {
        let Description { size, encoding, stamp, .. } = self.header.description;
        let file = self.source.open().map_err(|error| error.to_string())?;
        if file.stamp != Some(stamp) {
            return Err("it has changed".to_owned());
        }
        let bytes = read_limited(file, u64::MAX - 1).map_err(|error| error.to_string())?;
        let ending = self.source.identity().rsplit_once('.').map_or("", |(_, ending)| ending);
        let decoded = kajo_image::decode(&bytes, Format::from_extension(ending), &DecodeLimits::default());
        let decoded = decoded.map_err(|error| error.to_string())?;
        let (picture, _) = Picture::new(&decoded.image, encoding);
        if picture.size() == size { Ok(picture) } else { Err("it has another size".to_owned()) }
    }

    /// A tile of the mean colour.
    fn plain(&self, shape: LevelShape, number: u32) -> Tile {
        let [across, _] = shape.tiles();
        let [width, height] = shape.tile_size(number % across, number / across);
        let mean = self.header.description.mean.map(stored);
        Tile { width, texels: TileTexels::Stored(vec![mean; (width * height) as usize]) }
    }
}

impl Picture {
    /// A tile of a level of a picture in memory.
    fn tile(&self, shape: LevelShape, column: u32, row: u32) -> Tile {
        let [width, _] = shape.tile_size(column, row);
        let tile =
            |texels| Tile { width, texels: TileTexels::Stored(format::cut(shape, texels, column, row)) };
        if [shape.width, shape.height] == self.size() {
            return tile(self.resident().unwrap_or_default());
        }
        let pyramid = Pyramid::of(self);
        let is_same = |level: &&Level| [level.width, level.height] == [shape.width, shape.height];
        let level = pyramid.levels.iter().find(is_same).expect("a level of this picture");
        tile(&level.texels)
    }
}

impl TiledLevel<'_> {
    pub fn size(&self) -> [u32; 2] {
        [self.shape.width, self.shape.height]
    }

    /// The texel in this column and row, which are those of the level.
    #[inline]
    pub fn texel(&self, x: usize, y: usize) -> [u16; 4] {
        const SHIFT: u32 = SIDE.trailing_zeros();
        let mask = SIDE as usize - 1;
        let number = (y >> SHIFT) as u32 * self.shape.width.div_ceil(SIDE) + (x >> SHIFT) as u32;
        let key = TileKey { picture: self.picture.number, tile: self.shape.first + number };
        let load = || self.picture.load(self.shape, number);
        self.picture.cache.texel(key, x & mask, y & mask, load)
    }
}
