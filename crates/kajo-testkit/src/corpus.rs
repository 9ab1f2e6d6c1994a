//! The seeds of the fuzz targets, for tests that replay them.

use std::fs;
use std::path::Path;

/// The files of a folder of `fuzz/corpus` with their paths, in the order of these.
///
/// # Panics
/// When they cannot be read, or are so few that something is missing.
pub fn corpus(name: &str) -> Vec<(String, Vec<u8>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus").join(name);
    let mut seeds: Vec<(String, Vec<u8>)> = fs::read_dir(folder)
        .expect("the corpus is part of the repository")
        .map(|entry| entry.expect("a readable folder").path())
        .map(|path| (path.display().to_string(), fs::read(&path).expect("a readable seed")))
        .collect();
    seeds.sort();
    assert!(seeds.len() >= 8, "the corpus is missing");
    seeds
}
