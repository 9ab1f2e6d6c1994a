//! Tells the program what its pictures are decided by: a digest of the sources of all crates up to this one.

use std::fs;
use std::path::{Path, PathBuf};

/// The crates that decide bits of pictures.
const CRATES: [&str; 8] =
    ["kajo-math", "kajo-color", "kajo-bvh", "kajo-scene", "kajo-image", "kajo-core", "kajo-render", "kajo"];

fn main() {
    let here = PathBuf::from(std::env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default());
    let crates = here.parent().unwrap_or(&here);
    let mut hash = Fnv::new();
    for name in CRATES {
        let sources = crates.join(name).join("src");
        println!("cargo::rerun-if-changed={}", sources.display());
        add(&sources, name, &mut hash);
    }
    println!("cargo::rustc-env=KAJO_SOURCES={:016x}", hash.0);
}

/// Adds the files of a folder and those below it, in the order of their names.
fn add(folder: &Path, name: &str, hash: &mut Fnv) {
    let Ok(entries) = fs::read_dir(folder) else { return };
    let mut entries: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    entries.sort();
    for path in entries {
        let file = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let name = format!("{name}/{file}");
        if path.is_dir() {
            add(&path, &name, hash);
        } else if let Ok(bytes) = fs::read(&path) {
            hash.add(name.as_bytes());
            // A checkout may have put a carriage return before each end of line.
            let is_text = file.ends_with(".rs");
            bytes.iter().filter(|&&byte| !(is_text && byte == b'\r')).for_each(|&byte| hash.add(&[byte]));
            hash.add(&[0]);
        }
    }
}

/// FNV-1a in 64 bits: tells versions apart, and is no defence against anybody.
struct Fnv(u64);

impl Fnv {
    fn new() -> Fnv {
        Fnv(0xcbf2_9ce4_8422_2325)
    }

    fn add(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }
}
