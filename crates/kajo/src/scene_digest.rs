//! What a scene was read from, as one number.

use std::fs::File;
use std::io;
use std::path::PathBuf;

/// What a scene was read from, as one number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SceneDigest(pub(crate) [u8; 32]);

impl SceneDigest {
    /// The digest of the contents of files, in this order.
    ///
    /// # Errors
    /// When one cannot be read.
    pub fn of_files(paths: &[PathBuf]) -> io::Result<SceneDigest> {
        let mut all = blake3::Hasher::new();
        for path in paths {
            let mut one = blake3::Hasher::new();
            one.update_reader(File::open(path)?)?;
            all.update(one.finalize().as_bytes());
        }
        Ok(SceneDigest(*all.finalize().as_bytes()))
    }

    /// The same of the contents themselves.
    pub fn of_contents<'a>(contents: impl IntoIterator<Item = &'a [u8]>) -> SceneDigest {
        let mut all = blake3::Hasher::new();
        for content in contents {
            all.update(blake3::hash(content).as_bytes());
        }
        SceneDigest(*all.finalize().as_bytes())
    }

    /// The digest of this and a text: the scene around a model is in no file.
    pub fn with_text(self, text: &str) -> SceneDigest {
        let mut both = blake3::Hasher::new();
        both.update(&self.0).update(text.as_bytes());
        SceneDigest(*both.finalize().as_bytes())
    }
}
