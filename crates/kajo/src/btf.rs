//! Bidirectional texture functions from scenes and from measurements, and their files.
//!
//! [`make`] renders one, [`read_folder`] reads pictures of one, [`compress`] makes of either what a file holds, and [`write_btf`] its
//! bytes. The material `BTF` shows it.

mod folder;
mod make;

pub use folder::{FolderError, read_folder};
pub use kajo_core::measured::btf::{
    BtfEncoding, BtfError, BtfFile, BtfSamples, Compression, compress, read_btf, write_btf,
};
pub use make::{MakeError, Making, make};

use std::path::Path;

use kajo_scene::{Assets, Limits};

use crate::FsAssets;

/// Reads the file at `path`, and how its values are stored.
///
/// # Errors
/// [`BtfError`], what is wrong with it in words.
pub fn read_file(path: &Path) -> Result<(BtfFile, BtfEncoding), BtfError> {
    let assets = FsAssets::new(path).map_err(kajo_scene::AssetError::from)?.allow_outside(true);
    let (file, encoding, _) = read_btf(assets.open(assets.scene_name(), "")?, &Limits::default())?;
    Ok((file, encoding))
}

/// Directions in rings around the normal, the outermost 75 degrees from it: the normal itself, and `6 k` in ring `k`. As pairs of angles:
/// to the normal, and from u towards v; radians.
pub fn rings(n: u32) -> Vec<[f32; 2]> {
    use std::f32::consts::TAU;
    let outermost = 75.0 / 360.0 * TAU;
    let ring =
        |k: u32| (0..6 * k).map(move |i| [outermost * k as f32 / n as f32, TAU * i as f32 / (6 * k) as f32]);
    [[0.0; 2]].into_iter().chain((1..=n).flat_map(ring)).collect()
}
