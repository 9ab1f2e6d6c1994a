//! The folder with tiled copies of pictures.

use std::env;
use std::fs::{self, File};
use std::io::{self, BufWriter, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use kajo_core::compile::{CompileOptions, tile_picture};
use kajo_core::texture::{Encoding, ReadAt, TILED_EXTENSION, TileCache, TileFiles, TiledCopies, TilingRule};

use crate::FsAssets;
use crate::output::replace;

/// Where tiled copies of pictures are kept, and how much of them is in memory.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TextureFolder {
    /// The folder; it is made where it is missing.
    pub folder: PathBuf,
    /// Bytes of tiles in memory: then all pictures but small ones are read by tiles. Without it they are in memory as a whole for as long as they
    /// take at most half of the scene's memory; those that do not fit are read by tiles, of which a quarter of that is kept.
    pub memory: Option<u64>,
}

/// What is said of the folder to programs that make backups [Cache Directory Tagging Specification, 2004].
const TAG: &str = "Signature: 8a477f597d28d172789f06886806bc55\n# Tiled copies of pictures, made by kajo. They may be removed.\n";

impl TextureFolder {
    /// The folder of this user: that of the variable `KAJO_TEXTURES`, or one where the system keeps what can be made
    /// again; `None` where there is no such place.
    pub fn of_user() -> Option<PathBuf> {
        let variable = |name: &str| env::var_os(name).filter(|value| !value.is_empty()).map(PathBuf::from);
        let absolute = |path: PathBuf| Some(path).filter(|path| path.is_absolute());
        let cache = || {
            if cfg!(windows) {
                return variable("LOCALAPPDATA").and_then(absolute);
            }
            let home = || variable("HOME").and_then(absolute);
            if cfg!(target_os = "macos") {
                return home().map(|home| home.join("Library/Caches"));
            }
            // [XDG Base Directory Specification]
            variable("XDG_CACHE_HOME").and_then(absolute).or_else(|| home().map(|home| home.join(".cache")))
        };
        variable("KAJO_TEXTURES").or_else(|| cache().map(|cache| cache.join("kajo").join("textures")))
    }

    /// The folder of this user, for pictures that do not fit into memory.
    pub fn usual() -> Option<TextureFolder> {
        TextureFolder::of_user().map(|folder| TextureFolder { folder, memory: None })
    }

    /// The copies, for the compiler.
    ///
    /// * `scene`: bytes of memory for all of the scene
    pub(crate) fn copies(&self, scene: u64) -> TiledCopies {
        let (limit, rule) = match self.memory {
            Some(bytes) => (bytes, TilingRule::All),
            None => (scene / 4, TilingRule::Beyond(scene / 2)),
        };
        let files = FolderFiles { folder: self.folder.clone() };
        TiledCopies { cache: Arc::new(TileCache::new(Box::new(files), limit)), rule }
    }

    /// Makes the tiled copy of a picture unless there is one; answers its size in texels.
    ///
    /// * `encoding`: what its colours are said to mean, as the block of a picture says it; without it the file decides
    ///
    /// # Errors
    /// Why it cannot be made, in words.
    pub fn make(&self, picture: &Path, encoding: Option<Encoding>) -> Result<[u32; 2], String> {
        let assets = FsAssets::new(picture).map_err(|error| error.to_string())?;
        let tiled = TextureFolder { memory: Some(1 << 20), ..self.clone() };
        let options = CompileOptions { tiled: Some(tiled.copies(0)), ..CompileOptions::default() };
        tile_picture(assets.scene_name(), &assets, &options, encoding)
    }

    /// The files of the tiled copies, each with its bytes, by their names. None where there is no folder.
    ///
    /// # Errors
    /// When the folder cannot be read.
    pub fn files(&self) -> io::Result<Vec<(PathBuf, u64)>> {
        let entries = match fs::read_dir(&self.folder) {
            Ok(entries) => entries,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
            Err(error) => return Err(error),
        };
        let mut files = Vec::new();
        for entry in entries {
            let entry = entry?;
            let path = entry.path();
            if path.extension().is_some_and(|ending| ending == TILED_EXTENSION)
                && entry.file_type()?.is_file()
            {
                files.push((path, entry.metadata()?.len()));
            }
        }
        files.sort();
        Ok(files)
    }

    /// Removes all tiled copies; answers how many there were, and their bytes.
    ///
    /// # Errors
    /// When one cannot be removed.
    pub fn clear(&self) -> io::Result<(usize, u64)> {
        let files = self.files()?;
        files.iter().try_for_each(|(path, _)| fs::remove_file(path))?;
        Ok((files.len(), files.iter().map(|(_, bytes)| bytes).sum()))
    }
}

/// The files of a folder.
#[derive(Debug)]
struct FolderFiles {
    folder: PathBuf,
}

/// A file of which parts are read; one thread at a time.
struct OpenFile(Mutex<File>);

impl ReadAt for OpenFile {
    fn bytes(&self) -> io::Result<u64> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).metadata().map(|metadata| metadata.len())
    }

    fn read_at(&self, offset: u64, buffer: &mut [u8]) -> io::Result<()> {
        let mut file = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        file.seek(SeekFrom::Start(offset))?;
        file.read_exact(buffer)
    }
}

impl TileFiles for FolderFiles {
    // Opened for every tile: a scene may have more pictures than a process may have open files.
    fn open(&self, name: &str) -> io::Result<Box<dyn ReadAt>> {
        Ok(Box::new(OpenFile(Mutex::new(File::open(self.folder.join(name))?))))
    }

    fn write(&self, name: &str, content: &mut dyn FnMut(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
        fs::create_dir_all(&self.folder)?;
        let tag = self.folder.join("CACHEDIR.TAG");
        if !tag.exists() {
            fs::write(tag, TAG)?;
        }
        replace(&self.folder.join(name), &mut |file| {
            let mut buffered = BufWriter::with_capacity(1 << 20, file);
            content(&mut buffered)?;
            buffered.flush()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{LoadOptions, load};
    use kajo_image::{EncodeOptions, Format, Image, encode};

    /// A folder with a scene that shows a picture of 512 x 300 texels.
    fn scene() -> (tempfile::TempDir, PathBuf) {
        let folder = tempfile::tempdir().unwrap();
        let image =
            Image::from_fn(512, 300, |x, y| [(x % 7) as f32 / 6.0, (y % 5) as f32 / 4.0, 0.5]).unwrap();
        let bytes = encode(&image, Format::Png, &EncodeOptions::default()).unwrap();
        fs::write(folder.path().join("a.png"), bytes).unwrap();
        let text = "PerspectiveCamera { center 0 0 4 direction 0 0 -1 up 0 1 0 angle 40 }
            Lights { PointLight { position 0 2 4 color 1 1 1 } }
            Materials { Matte { color a.png { filter ewa } } }
            Group { MaterialIndex 0 Quad { corner -1 -1 0 edge1 2 0 0 edge2 0 2 0 } }";
        fs::write(folder.path().join("scene.txt"), text).unwrap();
        let path = folder.path().join("scene.txt");
        (folder, path)
    }

    fn options(folder: &Path, memory: Option<u64>) -> LoadOptions {
        let textures = Some(TextureFolder { folder: folder.join("tiles"), memory });
        LoadOptions { textures, ..LoadOptions::default() }
    }

    #[test]
    fn copies_are_made_once_and_used_again() {
        let (folder, path) = scene();
        let options = options(folder.path(), Some(1 << 20));
        let loaded = load(&path, &options);
        assert!(loaded.scene.is_some(), "{}", loaded.report(false));
        let textures = options.textures.clone().unwrap();
        let files = textures.files().unwrap();
        assert!(files.len() == 1 && files[0].1 > 1000, "{files:?}");
        let changed = || fs::metadata(&files[0].0).unwrap().modified().unwrap();
        let before = changed();
        assert!(load(&path, &options).scene.is_some());
        assert_eq!(changed(), before, "it is not written again");
        assert!(folder.path().join("tiles/CACHEDIR.TAG").exists());
        assert_eq!(
            fs::read_dir(folder.path().join("tiles")).unwrap().count(),
            2,
            "no file is left in the making"
        );
        // A copy that is cut off is made again.
        fs::write(&files[0].0, b"KAJOTILE").unwrap();
        assert!(load(&path, &options).scene.is_some());
        assert_eq!(textures.files().unwrap(), files);
        assert_eq!(textures.clear().unwrap().0, 1);
        assert!(textures.files().unwrap().is_empty());
    }

    #[test]
    fn pictures_that_fit_are_not_copied() {
        let (folder, path) = scene();
        let options = options(folder.path(), None);
        assert!(load(&path, &options).scene.is_some());
        assert!(options.textures.unwrap().files().unwrap().is_empty());
    }

    /// What can be rendered without copies can be where they have no folder.
    #[test]
    fn pictures_stay_in_memory_where_copies_cannot_be_kept() {
        let (folder, path) = scene();
        for name in ["a.png", "b.png"] {
            let image = Image::from_fn(1024, 700, |x, y| [((x + y) % 7) as f32 / 6.0]).unwrap();
            let bytes = encode(&image, Format::Png, &EncodeOptions::default()).unwrap();
            fs::write(folder.path().join(name), bytes).unwrap();
        }
        let text = "PerspectiveCamera { center 0 0 4 direction 0 0 -1 up 0 1 0 angle 40 }
            Materials { Matte { color a.png } Matte { color b.png } }
            Group { MaterialIndex 0 Sphere { center 0 0 0 radius 1 } MaterialIndex 1 Sphere { center 2 0 0 radius 1 } }";
        fs::write(&path, text).unwrap();
        // Each picture takes 5.7 MB, so that the second one is beyond half of this.
        let tight = LoadOptions { memory: Some(18_000_000), ..options(folder.path(), None) };
        let with_folder = load(&path, &tight);
        assert!(with_folder.scene.is_some(), "{}", with_folder.report(false));
        let textures = tight.textures.clone().unwrap();
        assert_eq!(textures.files().unwrap().len(), 1);
        fs::remove_dir_all(folder.path().join("tiles")).unwrap();
        fs::write(folder.path().join("tiles"), "a file").unwrap();
        let without = load(&path, &tight);
        assert!(without.scene.is_some(), "{}", without.report(false));
    }

    #[test]
    fn the_same_name_is_found_beforehand() {
        let (folder, path) = scene();
        let options = options(folder.path(), Some(1 << 20));
        let textures = options.textures.clone().unwrap();
        let picture = folder.path().join("a.png");
        assert_eq!(textures.make(&picture, None), Ok([512, 300]));
        let files = textures.files().unwrap();
        assert!(load(&path, &options).scene.is_some());
        assert_eq!(textures.files().unwrap(), files);
        assert!(textures.make(&folder.path().join("b.png"), None).is_err());
        assert!(textures.make(&path, None).is_err(), "no picture");
    }

    #[test]
    fn a_folder_that_cannot_be_made_is_said() {
        let (folder, path) = scene();
        fs::write(folder.path().join("tiles"), "a file").unwrap();
        let loaded = load(&path, &options(folder.path(), Some(1 << 20)));
        assert!(loaded.scene.is_none());
        assert!(loaded.report(false).contains("tiled copy cannot be written"), "{}", loaded.report(false));
    }
}
