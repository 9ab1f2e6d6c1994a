//! Writes the seeds of the fuzz target `vdb`: `cargo run -p kajo-testkit --example vdb_seeds -- fuzz/corpus/vdb`.

use std::path::PathBuf;

use kajo_testkit::nano_vdb::{self, NanoKind};
use kajo_testkit::vdb::{VdbCompression, VdbFile, VdbGrid, VdbKind, VdbMap};

fn main() -> std::io::Result<()> {
    let folder = PathBuf::from(std::env::args().nth(1).expect("the folder to write into"));
    std::fs::create_dir_all(&folder)?;
    let mut few = VdbGrid::new("density", VdbKind::Float, VdbMap::Uniform(0.5));
    (0..40).for_each(|k| few.set([k % 9 - 3, k / 9, k % 4], [k as f32 / 8.0; 3]));
    few.set_inactive([1, 1, 1], [3.0; 3]);
    few.tile(3, [8, 8, 8], [0.5; 3], true);
    let mut many = few.clone();
    many.tile(7, [128, 0, 0], [0.25; 3], true);
    many.tile(12, [-8192, 0, 0], [0.125; 3], true);
    let of = |kind: VdbKind, name: &str| {
        let mut grid = few.clone();
        (grid.kind, grid.name) = (kind, name.to_owned());
        grid
    };
    let axes = [[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 2.0]];
    let mut turned = few.clone();
    turned.map = VdbMap::Affine(axes, [1.0, 2.0, 3.0]);
    let nano = |kind| nano_vdb::to_bytes_as(std::slice::from_ref(&few), &[kind], VdbCompression::Zip);
    let file = |compression, masks, grids| VdbFile { version: 224, compression, masks, grids }.to_bytes();
    let plain = file(VdbCompression::None, true, vec![few.clone()]);
    let seeds = [
        ("plain.vdb", plain.clone()),
        ("zip.vdb", file(VdbCompression::Zip, false, vec![many.clone()])),
        ("blosc.vdb", file(VdbCompression::Blosc, true, vec![many])),
        ("half.vdb", file(VdbCompression::Zip, true, vec![of(VdbKind::Half, "flame")])),
        ("double.vdb", file(VdbCompression::Blosc, true, vec![of(VdbKind::Double, "density")])),
        ("vectors.vdb", file(VdbCompression::Zip, true, vec![of(VdbKind::Vec3, "Cd")])),
        ("vectors_of_doubles.vdb", file(VdbCompression::Zip, true, vec![of(VdbKind::DoubleVec3, "vel")])),
        ("own_half.vdb", file(VdbCompression::Zip, true, vec![of(VdbKind::OwnHalf, "density")])),
        ("turned.vdb", file(VdbCompression::Zip, true, vec![turned])),
        ("cut.vdb", plain[..plain.len() / 2].to_vec()),
        ("head.vdb", plain[..60].to_vec()),
        ("zip.nvdb", nano_vdb::to_bytes(&[few.clone()], VdbCompression::Zip)),
        ("blosc.nvdb", nano_vdb::to_bytes(std::slice::from_ref(&few), VdbCompression::Blosc)),
        ("vectors.nvdb", nano(NanoKind::DoubleVec3)),
        ("codes.nvdb", nano(NanoKind::CodesByLeaf)),
    ];
    for (name, bytes) in seeds {
        std::fs::write(folder.join(name), bytes)?;
    }
    Ok(())
}
