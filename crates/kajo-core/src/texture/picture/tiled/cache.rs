//! The cache of tiles.

use std::cell::RefCell;
use std::collections::{HashMap, VecDeque};
use std::fmt;
use std::hash::{BuildHasherDefault, Hash, Hasher};
use std::io::{self, Write};
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::Tile;
use super::format::ReadAt;

/// Files with tiled copies, by their names; a folder, say.
pub trait TileFiles: fmt::Debug + Send + Sync {
    /// Opens a file.
    ///
    /// # Errors
    /// Those of the system.
    fn open(&self, name: &str) -> io::Result<Box<dyn ReadAt>>;

    /// Makes a file of what `content` writes. A reader that opens it meanwhile finds what there was before, or all of the new one.
    ///
    /// # Errors
    /// Those of the system and of `content`; then there is what there was before.
    fn write(&self, name: &str, content: &mut dyn FnMut(&mut dyn Write) -> io::Result<()>) -> io::Result<()>;
}

/// The tiles of pictures that were asked for last, shared by all threads and by all scenes that are given it.
///
/// It holds at most so many bytes, and a few tiles for each thread besides.
#[derive(Debug)]
pub struct TileCache {
    files: Box<dyn TileFiles>,
    limit: u64,
    shards: Vec<Mutex<Shard>>,
    /// Numbers of the pictures that were opened, by the names of their files and their stamps.
    pictures: Mutex<HashMap<(String, u64), u32>>,
    problems: Mutex<Vec<String>>,
}

/// Which tile of which picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct TileKey {
    pub picture: u32,
    /// Among those of all levels.
    pub tile: u32,
}

/// Scatters numbers in a row [Knuth, section 6.4].
const GOLDEN_RATIO: u64 = 0x9e37_79b9_7f4a_7c15;

impl TileKey {
    fn both(self) -> u64 {
        u64::from(self.picture) << 32 | u64::from(self.tile)
    }

    fn scattered(self) -> u64 {
        self.both().wrapping_mul(GOLDEN_RATIO)
    }
}

impl Hash for TileKey {
    fn hash<H: Hasher>(&self, state: &mut H) {
        state.write_u64(self.both());
    }
}

/// The hash of a [`TileKey`]; keys are not attacker-controlled.
#[derive(Clone, Copy, Debug, Default)]
struct Scattering(u64);

impl Hasher for Scattering {
    fn finish(&self) -> u64 {
        self.0
    }

    fn write(&mut self, bytes: &[u8]) {
        bytes.iter().for_each(|&byte| self.write_u64(byte.into()));
    }

    fn write_u64(&mut self, number: u64) {
        // Within a part of the cache other bits than those that choose it.
        self.0 = (self.0 ^ number).wrapping_mul(GOLDEN_RATIO).rotate_left(20);
    }
}

/// A part of the cache with a lock of its own.
#[derive(Debug, Default)]
struct Shard {
    tiles: HashMap<TileKey, Held, BuildHasherDefault<Scattering>>,
    /// In the order in which they came, or were spared.
    order: VecDeque<TileKey>,
    bytes: u64,
}

#[derive(Debug)]
struct Held {
    tile: Arc<Tile>,
    /// Whether it was asked for since it was looked at last.
    was_used: bool,
}

/// Tiles that a thread keeps at hand, without a lock.
const AT_HAND: usize = 256;

type RecentTile = Option<(TileKey, Arc<Tile>)>;

thread_local! {
    static RECENT: RefCell<[RecentTile; AT_HAND]> = const { RefCell::new([const { None }; AT_HAND]) };
}

/// Bytes of the cache for each of its locks, at least.
const LEAST_SHARD: u64 = 4 << 20;

/// Numbers of pictures are those of the process: threads keep tiles of several caches.
static NEXT_PICTURE: AtomicU32 = AtomicU32::new(0);

/// What a panic left behind is whole: every change is made by one call.
fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl TileCache {
    /// An empty one.
    ///
    /// * `limit`: bytes of tiles that it keeps; one tile is kept in any case
    pub fn new(files: Box<dyn TileFiles>, limit: u64) -> TileCache {
        let shards = (limit / LEAST_SHARD).clamp(1, 16);
        TileCache {
            files,
            limit,
            shards: (0..shards).map(|_| Mutex::default()).collect(),
            pictures: Mutex::default(),
            problems: Mutex::default(),
        }
    }

    /// Bytes of tiles that it keeps at most.
    pub fn limit(&self) -> u64 {
        self.limit
    }

    /// Bytes of the tiles that it holds.
    pub fn bytes(&self) -> u64 {
        self.shards.iter().map(|shard| locked(shard).bytes).sum()
    }

    /// Takes what went wrong while tiles were read. Where there is any of it, parts of pictures were shown in their mean colour.
    pub fn take_problems(&self) -> Vec<String> {
        std::mem::take(&mut locked(&self.problems))
    }

    pub(super) fn files(&self) -> &dyn TileFiles {
        &*self.files
    }

    pub(super) fn report(&self, problem: String) {
        let mut problems = locked(&self.problems);
        if !problems.contains(&problem) {
            problems.push(problem);
        }
    }

    /// The number of a picture.
    ///
    /// * `stamp`: of the state of the file that it is a copy of
    pub(super) fn picture(&self, name: &str, stamp: u64) -> u32 {
        let mut pictures = locked(&self.pictures);
        *pictures
            .entry((name.to_owned(), stamp))
            .or_insert_with(|| NEXT_PICTURE.fetch_add(1, Ordering::Relaxed))
    }

    /// A texel of a tile.
    ///
    /// * `x`, `y`: within the tile
    /// * `load`: reads the tile
    #[inline]
    pub(super) fn texel(&self, key: TileKey, x: usize, y: usize, load: impl FnOnce() -> Tile) -> [u16; 4] {
        RECENT.with_borrow_mut(|recent| {
            let slot = &mut recent[(key.scattered() >> 56) as usize % AT_HAND];
            match slot {
                Some((known, tile)) if *known == key => tile.texel(x, y),
                _ => {
                    let tile = self.tile(key, load);
                    let texel = tile.texel(x, y);
                    *slot = Some((key, tile));
                    texel
                }
            }
        })
    }

    #[inline(never)]
    fn tile(&self, key: TileKey, load: impl FnOnce() -> Tile) -> Arc<Tile> {
        let shard = &self.shards[((key.scattered() >> 32) % self.shards.len() as u64) as usize];
        if let Some(held) = locked(shard).tiles.get_mut(&key) {
            held.was_used = true;
            return Arc::clone(&held.tile);
        }
        // Two threads may read the same tile at a time; none waits for a read that another one has begun.
        let tile = Arc::new(load());
        locked(shard).keep(key, &tile, self.limit / self.shards.len() as u64);
        tile
    }
}

impl Shard {
    /// Keeps a tile, and lets others go that were not used since they were last in turn: "second chance"
    /// [Corbató 1968].
    fn keep(&mut self, key: TileKey, tile: &Arc<Tile>, limit: u64) {
        let held = Held { tile: Arc::clone(tile), was_used: false };
        match self.tiles.insert(key, held) {
            // Another thread was faster.
            Some(_) => return,
            None => self.order.push_back(key),
        }
        self.bytes += tile.bytes();
        while self.bytes > limit && self.order.len() > 1 {
            let Some(oldest) = self.order.pop_front() else { return };
            let is_spared = oldest == key
                || self.tiles.get_mut(&oldest).is_some_and(|held| std::mem::take(&mut held.was_used));
            if is_spared {
                self.order.push_back(oldest);
            } else if let Some(gone) = self.tiles.remove(&oldest) {
                self.bytes -= gone.tile.bytes();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::TileTexels;
    use super::*;

    #[derive(Debug)]
    struct NoFiles;

    impl TileFiles for NoFiles {
        fn open(&self, _name: &str) -> io::Result<Box<dyn ReadAt>> {
            Err(io::ErrorKind::NotFound.into())
        }

        fn write(
            &self,
            _name: &str,
            _content: &mut dyn FnMut(&mut dyn Write) -> io::Result<()>,
        ) -> io::Result<()> {
            Err(io::ErrorKind::Unsupported.into())
        }
    }

    fn tile(value: u16) -> Tile {
        Tile { width: 64, texels: TileTexels::Stored(vec![[value; 4]; 64 * 64]) }
    }

    #[test]
    fn it_holds_what_it_may_and_what_is_used_stays() {
        let cache = TileCache::new(Box::new(NoFiles), 10 * tile(0).bytes());
        let picture = cache.picture("a", 0);
        assert_eq!(picture, cache.picture("a", 0));
        assert_ne!(picture, cache.picture("a", 1), "another state of the file has other tiles");
        let mut loads = [0; 100];
        for i in 0..100u32 {
            for tile_number in [i, 0] {
                let key = TileKey { picture, tile: tile_number };
                let found = cache.tile(key, || {
                    loads[tile_number as usize] += 1;
                    tile(tile_number as u16)
                });
                assert_eq!(found.texel(63, 63), [tile_number as u16; 4]);
            }
            assert!(cache.bytes() <= cache.limit());
        }
        assert_eq!(loads, [1; 100], "the one in use is never read twice");
        assert_eq!(cache.bytes(), cache.limit());
        cache.tile(TileKey { picture, tile: 50 }, || {
            loads[50] += 1;
            tile(50)
        });
        assert_eq!(loads[50], 2, "what was let go is read again");
    }

    #[test]
    fn one_that_is_smaller_than_a_tile_keeps_one() {
        let cache = TileCache::new(Box::new(NoFiles), 1);
        for i in 0..10 {
            let key = TileKey { picture: cache.picture("b", 0), tile: i };
            assert_eq!(cache.texel(key, 5, 5, || tile(i as u16)), [i as u16; 4]);
            assert_eq!(cache.bytes(), tile(0).bytes());
        }
    }

    #[test]
    fn a_problem_is_told_once() {
        let cache = TileCache::new(Box::new(NoFiles), 1);
        for problem in ["a", "b", "a"] {
            cache.report(problem.to_owned());
        }
        assert_eq!(cache.take_problems(), ["a", "b"]);
        assert!(cache.take_problems().is_empty());
    }
}
