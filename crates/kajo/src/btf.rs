//! Bidirectional texture functions from scenes and from measurements, and their files.
//!
//! [`make`] renders one, [`read_folder`] reads pictures of one and [`read_ubo2014`] a factorised one, [`compress`] makes of any of them what
//! a file holds, and [`write_btf`] its bytes. The material `BTF` shows it.

mod folder;
mod make;

pub use folder::{FolderError, read_folder};
pub use kajo_core::measured::btf::{
    BtfEncoding, BtfError, BtfFile, BtfSamples, Compression, compress, read_btf, write_btf,
};
pub use make::{MakeError, Making, make};

use std::path::Path;

use kajo_core::measured::btf;
use kajo_scene::{AssetError, AssetFile, Assets, Limits, MemoryBudget};

use crate::FsAssets;

/// Reads the file at `path`, and how its values are stored.
///
/// # Errors
/// [`BtfError`], what is wrong with it in words.
pub fn read_file(path: &Path) -> Result<(BtfFile, BtfEncoding), BtfError> {
    let (file, encoding, _) = read_btf(opened(path)?, &Limits::default())?;
    Ok((file, encoding))
}

/// Samples of a file of the collection UBO2014, in the forms DFMF and FMF.
///
/// * `most`: texels along a side at most; of larger textures blocks are averaged
///
/// # Errors
/// [`BtfError`], what is wrong with it in words.
pub fn read_ubo2014(path: &Path, most: u32, memory: &MemoryBudget) -> Result<BtfSamples, BtfError> {
    let limits = Limits { memory: memory.clone(), ..Limits::default() };
    btf::read_ubo2014(opened(path)?, &limits, most)
}

fn opened(path: &Path) -> Result<AssetFile, AssetError> {
    let assets = FsAssets::new(path)?.allow_outside(true);
    assets.open(assets.scene_name(), "")
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
