//! The files of a scene as they are on disk, but for those that have been edited.

use std::io::Cursor;

use kajo_scene::{AssetError, AssetFile, Assets, LoadStep};

use super::SceneFile;
use kajo::FsAssets;

/// Files found by `disk`; where one is in `files`, its text is taken from there.
pub(super) struct Overlay<'a> {
    pub disk: &'a FsAssets,
    pub files: &'a [SceneFile],
}

impl Assets for Overlay<'_> {
    fn open(&self, name: &str, from: &str) -> Result<AssetFile, AssetError> {
        let found = self.disk.open(name, from);
        let path = match &found {
            Ok(file) => &file.path,
            // The scene itself need not be on disk yet, or any more.
            Err(_) if from.is_empty() => name,
            Err(_) => return found,
        };
        let Some(file) = self.files.iter().find(|file| file.name == path) else { return found };
        let bytes = file.text.as_bytes().to_vec();
        let (path, len) = (file.name.clone(), Some(bytes.len() as u64));
        Ok(AssetFile { path, len, stamp: None, reopen: None, reader: Box::new(Cursor::new(bytes)) })
    }

    fn progress(&self, step: LoadStep<'_>) {
        self.disk.progress(step);
    }
}
