//! The files of a model, read again for a picture within them.
//!
//! A tiled copy of such a picture is made of bytes that are let go when the model has been read. Where the copy is damaged later, the
//! picture is taken out of the model once more.

use std::io::{self, Cursor};
use std::sync::{Arc, Mutex, PoisonError};

use kajo_scene::{AssetError, AssetFile, Assets, Limits, LoadStep, MemoryBudget, Reopen, read_gltf_picture};

use crate::texture::content_stamp;

/// Files, and how each that was opened is opened again.
pub(super) struct RecordedAssets<'a> {
    assets: &'a dyn Assets,
    opened: Mutex<Vec<(String, Option<Reopen>)>>,
}

/// The files that a model was read from.
#[derive(Clone, Debug)]
pub(super) struct ModelFiles {
    model: Reopen,
    /// Its buffers.
    others: ReopenedAssets,
    limits: Limits,
}

/// Files that are opened again, by the names that they were opened by.
#[derive(Clone, Debug)]
struct ReopenedAssets(Arc<[(String, Reopen)]>);

impl<'a> RecordedAssets<'a> {
    pub fn new(assets: &'a dyn Assets) -> RecordedAssets<'a> {
        RecordedAssets { assets, opened: Mutex::default() }
    }

    /// The files of a model whose buffers were opened here; `None` where one of them cannot be opened again.
    ///
    /// * `model`: the file that names them
    pub fn files_of(self, model: Reopen, limits: &Limits) -> Option<ModelFiles> {
        let opened = self.opened.into_inner().unwrap_or_else(PoisonError::into_inner);
        let again = opened.into_iter().map(|(name, reopen)| Some((name, reopen?)));
        let others = ReopenedAssets(again.collect::<Option<_>>()?);
        // It is read when the scene is in memory already.
        Some(ModelFiles {
            model,
            others,
            limits: Limits { memory: MemoryBudget::default(), ..limits.clone() },
        })
    }
}

impl Assets for RecordedAssets<'_> {
    fn open(&self, name: &str, from: &str) -> Result<AssetFile, AssetError> {
        let file = self.assets.open(name, from)?;
        let mut opened = self.opened.lock().unwrap_or_else(PoisonError::into_inner);
        opened.push((name.to_owned(), file.reopen.clone()));
        Ok(file)
    }

    fn progress(&self, step: LoadStep<'_>) {
        self.assets.progress(step);
    }
}

impl Assets for ReopenedAssets {
    fn open(&self, name: &str, _from: &str) -> Result<AssetFile, AssetError> {
        let known = self.0.iter().find(|(known, _)| known == name);
        known.map_or(Err(AssetError::NotFound), |(_, reopen)| reopen.open())
    }
}

impl ModelFiles {
    /// How a picture within the model is had again.
    ///
    /// * `number`: among the pictures of the model
    pub fn picture(&self, number: usize) -> Reopen {
        let identity = format!("{}#images[{number}]", self.model.identity());
        let (files, path) = (self.clone(), identity.clone());
        Reopen::new(&identity, move || {
            let ModelFiles { model, others, limits } = &files;
            let bytes = read_gltf_picture(model.open()?, others, limits, number)
                .map_err(|error| io::Error::other(error.to_string()))?;
            Ok(AssetFile {
                path: path.clone(),
                len: Some(bytes.len() as u64),
                stamp: Some(content_stamp(&bytes)),
                reopen: None,
                reader: Box::new(Cursor::new(bytes)),
            })
        })
    }
}
