//! A scene and all it names in one file, so that it can be rendered where none of these files are.
//!
//! | bytes | what |
//! |---|---|
//! | 8, 4 | `kajobndl` and the version of the format |
//! | 8, n | length of a JSON object, the manifest, and the object |
//! | | the contents of all files, one after the other |
//! | 32 | BLAKE3 of everything before |
//!
//! A bundle knows for each name that a scene uses, in each of its files, which content is meant. So names lead to these
//! contents and nowhere else, whatever they look like.

use std::collections::BTreeMap;
use std::io::{Cursor, Read};
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

use kajo::{AssetError, AssetFile, Assets, SceneDigest};
use serde::{Deserialize, Serialize};

use crate::FarmError;
use crate::part::Reader;

const MAGIC: &[u8; 8] = b"kajobndl";
const VERSION: u32 = 1;

/// A scene with all its files.
#[derive(Clone, Debug, Default)]
pub struct Bundle {
    /// The scene's name.
    scene: String,
    /// By what a file is called, and in which file: its resolved name.
    names: BTreeMap<(String, String), String>,
    /// By resolved names.
    contents: BTreeMap<String, Arc<[u8]>>,
}

#[derive(Serialize, Deserialize)]
struct Manifest {
    scene: String,
    /// Name, file that says it, and place of the content in `files`.
    names: Vec<(String, String, usize)>,
    files: Vec<BundledFile>,
}

#[derive(Serialize, Deserialize)]
struct BundledFile {
    path: String,
    bytes: u64,
    blake3: String,
}

impl Bundle {
    /// Whether a file begins like a bundle.
    pub fn is_one(path: &Path) -> bool {
        let mut head = [0; 8];
        std::fs::File::open(path).and_then(|mut file| file.read_exact(&mut head)).is_ok() && head == *MAGIC
    }

    /// The scene's name.
    pub fn scene(&self) -> &str {
        &self.scene
    }

    /// What the scene was read from, as [`SceneDigest::of_files`] says it of the files themselves.
    pub fn digest(&self) -> SceneDigest {
        SceneDigest::of_contents(self.contents.values().map(|content| &**content))
    }

    /// How many files it has, and bytes of these.
    pub fn size(&self) -> (usize, u64) {
        (self.contents.len(), self.contents.values().map(|content| content.len() as u64).sum())
    }

    /// The bytes of its file.
    ///
    /// # Errors
    /// When there is no manifest of it.
    pub fn bytes(&self) -> Result<Vec<u8>, FarmError> {
        let place = |path: &String| self.contents.keys().position(|key| key == path).unwrap_or(usize::MAX);
        let manifest = Manifest {
            scene: self.scene.clone(),
            names: self
                .names
                .iter()
                .map(|((name, from), path)| (name.clone(), from.clone(), place(path)))
                .collect(),
            files: self
                .contents
                .iter()
                .map(|(path, content)| BundledFile {
                    path: path.clone(),
                    bytes: content.len() as u64,
                    blake3: blake3::hash(content).to_hex().to_string(),
                })
                .collect(),
        };
        let manifest = serde_json::to_vec(&manifest).map_err(|error| FarmError::Input(error.to_string()))?;
        let mut bytes = MAGIC.to_vec();
        bytes.extend(VERSION.to_le_bytes());
        bytes.extend((manifest.len() as u64).to_le_bytes());
        bytes.extend(manifest);
        self.contents.values().for_each(|content| bytes.extend(&**content));
        bytes.extend(*blake3::hash(&bytes).as_bytes());
        Ok(bytes)
    }

    /// Reads a bundle.
    ///
    /// # Errors
    /// [`FarmError::Input`] when anything of it is wrong.
    pub fn read(bytes: &[u8]) -> Result<Bundle, FarmError> {
        Bundle::parse(bytes).ok_or_else(|| FarmError::Input("the bundle is damaged, or none".to_owned()))
    }

    fn parse(bytes: &[u8]) -> Option<Bundle> {
        let (body, hash) = bytes.split_last_chunk::<32>()?;
        let mut rest = Reader(body);
        if blake3::hash(body) != *hash || rest.take().ok()? != *MAGIC {
            return None;
        }
        if u32::from_le_bytes(rest.take().ok()?) != VERSION {
            return None;
        }
        let length = usize::try_from(u64::from_le_bytes(rest.take().ok()?)).ok()?;
        let manifest: Manifest = serde_json::from_slice(rest.skip(length).ok()?).ok()?;
        let mut contents = BTreeMap::new();
        for file in &manifest.files {
            let content = rest.skip(usize::try_from(file.bytes).ok()?).ok()?;
            if blake3::hash(content).to_hex().as_str() != file.blake3 {
                return None;
            }
            contents.insert(file.path.clone(), Arc::from(content));
        }
        let mut names = BTreeMap::new();
        for (name, from, place) in manifest.names {
            names.insert((name, from), manifest.files.get(place)?.path.clone());
        }
        rest.0.is_empty().then_some(Bundle { scene: manifest.scene, names, contents })
    }
}

impl Assets for Bundle {
    fn open(&self, name: &str, from: &str) -> Result<AssetFile, AssetError> {
        let path = self.names.get(&(name.to_owned(), from.to_owned())).ok_or(AssetError::NotFound)?;
        let content = Arc::clone(self.contents.get(path).ok_or(AssetError::NotFound)?);
        let len = Some(content.len() as u64);
        Ok(AssetFile {
            path: path.clone(),
            len,
            stamp: None,
            reopen: None,
            reader: Box::new(Cursor::new(content)),
        })
    }
}

/// Files that are put into a bundle as they are opened.
pub struct Recording<'a> {
    inner: &'a dyn Assets,
    bundle: Mutex<Bundle>,
}

impl<'a> Recording<'a> {
    /// * `scene`: the name by which the scene will be opened
    pub fn new(inner: &'a dyn Assets, scene: &str) -> Recording<'a> {
        let bundle = Bundle { scene: scene.to_owned(), ..Bundle::default() };
        Recording { inner, bundle: Mutex::new(bundle) }
    }

    /// All that was opened.
    pub fn bundle(self) -> Bundle {
        self.bundle.into_inner().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Assets for Recording<'_> {
    fn open(&self, name: &str, from: &str) -> Result<AssetFile, AssetError> {
        let mut file = self.inner.open(name, from)?;
        let mut content = Vec::new();
        file.reader.read_to_end(&mut content)?;
        let content: Arc<[u8]> = content.into();
        let mut bundle = self.bundle.lock().unwrap_or_else(PoisonError::into_inner);
        bundle.names.insert((name.to_owned(), from.to_owned()), file.path.clone());
        bundle.contents.insert(file.path.clone(), Arc::clone(&content));
        Ok(AssetFile { len: Some(content.len() as u64), reader: Box::new(Cursor::new(content)), ..file })
    }

    fn progress(&self, step: kajo::LoadStep<'_>) {
        self.inner.progress(step);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo::{LoadOptions, MemoryAssets};

    const SCENE: &str = "include \"camera.txt\"  Materials { Material {} }
        Group { MaterialIndex 0  Sphere { center 0 0 0  radius 1 } }";
    const CAMERA: &str = "PerspectiveCamera { center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30 }";

    #[test]
    fn a_bundle_holds_all_that_a_scene_opens() {
        let files =
            MemoryAssets::new().with("a/scene.txt", SCENE).with("a/camera.txt", CAMERA).with("b", "no");
        let recording = Recording::new(&files, "a/scene.txt");
        let loaded = kajo::load_from("a/scene.txt", &recording, &LoadOptions::default());
        assert!(loaded.scene.is_some(), "{}", loaded.report(false));
        let bytes = recording.bundle().bytes().unwrap();
        let bundle = Bundle::read(&bytes).unwrap();
        assert_eq!(bundle.size(), (2, (SCENE.len() + CAMERA.len()) as u64));
        let again = kajo::load_from(bundle.scene(), &bundle, &LoadOptions::default());
        assert!(again.scene.is_some(), "{}", again.report(false));
        assert!(bundle.open("/etc/passwd", "").is_err() && bundle.open("../b", "a/scene.txt").is_err());
        for at in (0..bytes.len()).step_by(7) {
            let mut changed = bytes.clone();
            changed[at] ^= 4;
            assert!(Bundle::read(&changed).is_err(), "byte {at}");
        }
        assert!(Bundle::read(&bytes[..bytes.len() - 1]).is_err() && Bundle::read(b"").is_err());
    }
}
