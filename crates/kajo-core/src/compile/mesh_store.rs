//! Meshes kept from one compilation to the next, for a scene that is compiled again and again while it is edited.
//!
//! A mesh is known by its file, by what tells the states of that file apart, and by what of it is shown; one of a model, which
//! may move, by a digest of what it is made of. What a compilation that succeeded did not use is dropped.

use std::collections::HashMap;
use std::sync::{Mutex, MutexGuard, PoisonError};

use super::subdivision::Subdivision;
use crate::shape::Mesh;

/// Where the normals of a mesh come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Shading {
    /// The winding of each face.
    Flat,
    /// The file, or the faces around a point where the file has none: `smooth on`.
    Smooth,
    /// The faces around a vertex, whatever the file says: the rule of mit-a2.
    Averaged,
}

/// What makes two meshes the same.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct StoreKey {
    /// Name of the file.
    pub path: String,
    /// State of the file.
    pub stamp: u64,
    pub shading: Shading,
    /// Whether the file's colours are kept.
    pub colors: bool,
    /// Whether and how it is subdivided.
    pub subdivision: Option<Subdivision>,
}

/// A mesh, and what was said when its file was read.
#[derive(Clone, Debug)]
pub(super) struct Kept {
    pub mesh: Mesh,
    pub warnings: Vec<String>,
}

/// Meshes that were read before.
#[derive(Debug, Default)]
pub struct MeshStore {
    /// With each mesh, whether the compilation under way has used it.
    kept: Mutex<HashMap<StoreKey, (Kept, bool)>>,
    /// By the digest of its data, with the same.
    built: Mutex<HashMap<[u64; 2], (Mesh, bool)>>,
}

impl MeshStore {
    /// How many meshes are kept.
    pub fn len(&self) -> usize {
        self.lock().len() + self.lock_built().len()
    }

    /// Whether none is kept.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    pub(super) fn get(&self, key: &StoreKey) -> Option<Kept> {
        let mut kept = self.lock();
        let (found, is_used) = kept.get_mut(key)?;
        *is_used = true;
        Some(found.clone())
    }

    pub(super) fn put(&self, key: StoreKey, kept: Kept) {
        self.lock().insert(key, (kept, true));
    }

    /// A compilation begins: nothing is used yet.
    pub(super) fn begin(&self) {
        self.lock().values_mut().for_each(|(_, is_used)| *is_used = false);
        self.lock_built().values_mut().for_each(|(_, is_used)| *is_used = false);
    }

    /// A compilation has succeeded: what it did not use is dropped.
    pub(super) fn keep_used(&self) {
        self.lock().retain(|_, (_, is_used)| *is_used);
        self.lock_built().retain(|_, (_, is_used)| *is_used);
    }

    /// A mesh that was built of data with this digest.
    pub(super) fn built(&self, digest: [u64; 2]) -> Option<Mesh> {
        let mut built = self.lock_built();
        let (found, is_used) = built.get_mut(&digest)?;
        *is_used = true;
        Some(found.clone())
    }

    pub(super) fn put_built(&self, digest: [u64; 2], mesh: Mesh) {
        self.lock_built().insert(digest, (mesh, true));
    }

    fn lock_built(&self) -> MutexGuard<'_, HashMap<[u64; 2], (Mesh, bool)>> {
        self.built.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn lock(&self) -> MutexGuard<'_, HashMap<StoreKey, (Kept, bool)>> {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
