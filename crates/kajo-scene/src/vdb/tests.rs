//! Files of the writer of `kajo_testkit`, read again and damaged.

use kajo_testkit::nano_vdb::{self, NanoKind};
use kajo_testkit::vdb::{VdbCompression, VdbFile, VdbGrid, VdbKind, VdbMap};

use super::*;
use crate::assets::{Assets, MemoryAssets};
use crate::memory_budget::MemoryBudget;

fn limits() -> Limits {
    Limits { memory: MemoryBudget::new(64 << 20), ..Limits::default() }
}

fn open(bytes: &[u8]) -> AssetFile {
    MemoryAssets::new().with("v", bytes).open("v", "").unwrap()
}

fn read<T: VoxelValue>(bytes: &[u8], wanted: usize) -> Result<VoxelGrid<T>, String> {
    read_vdb(open(bytes), wanted, &limits()).map_err(|error| error.to_string())
}

/// A number for each voxel, of which halves know all.
fn value([x, y, z]: [i32; 3]) -> f32 {
    ((x * 7 + y * 13 + z * 29).rem_euclid(64)) as f32 / 16.0
}

/// A ball of voxels on both sides of the origin, with what is off in and around it, and tiles of all levels.
fn ball(name: &str, kind: VdbKind, map: VdbMap) -> VdbGrid {
    let mut grid = VdbGrid::new(name, kind, map);
    for x in -6..15 {
        for y in -9..9 {
            for z in 3..30 {
                let index = [x, y, z];
                let r2 = (x - 4) * (x - 4) + y * y + (z - 16) * (z - 16);
                let v = value(index);
                match r2 {
                    0..9 => grid.set_inactive(index, [2.0; 3]),
                    9..16 => grid.set_inactive(index, [-1.0; 3]),
                    16..80 => grid.set(index, [v, v + 1.0, -v]),
                    _ => {}
                }
            }
        }
    }
    grid.tile(3, [8, 0, 40], [0.5, 1.5, 2.5], true);
    grid.tile(3, [16, 0, 40], [0.25, 0.25, 0.25], false);
    grid.tile(7, [0, 128, 0], [0.75; 3], true);
    grid
}

fn file(compression: VdbCompression, masks: bool, grids: Vec<VdbGrid>) -> VdbFile {
    VdbFile { version: 224, compression, masks, grids }
}

/// The value of a voxel of [`ball`] by its index.
fn expected(index @ [x, y, z]: [i32; 3]) -> f32 {
    let r2 = (x - 4) * (x - 4) + y * y + (z - 16) * (z - 16);
    match r2 {
        0..9 => return 2.0,
        9..16 => return -1.0,
        16..80 => return value(index),
        _ => {}
    }
    match index.map(|x| x >> 3) {
        [1, 0, 5] => 0.5,
        [2, 0, 5] => 0.25,
        _ if index.map(|x| x >> 7) == [0, 1, 0] => 0.75,
        _ => 0.0,
    }
}

#[test]
fn every_way_of_storing_is_read() {
    use VdbCompression::{Blosc, None, Zip};
    for compression in [None, Zip, Blosc] {
        for masks in [false, true] {
            for kind in [VdbKind::Float, VdbKind::Half, VdbKind::Double, VdbKind::OwnHalf] {
                for version in [222, 223, 224, 225] {
                    let grid = ball("density", kind, VdbMap::Uniform(0.5));
                    let bytes = VdbFile { version, ..file(compression, masks, vec![grid]) }.to_bytes();
                    let grid = read::<f32>(&bytes, 0).unwrap();
                    // From the ball at -4 and -8 to the ends of the largest tile.
                    assert_eq!(grid.voxels.size(), [132, 264, 128], "{kind:?}");
                    assert_eq!(grid.map.point([0.5; 3]), [-2.0, -4.0, 0.0]);
                    for x in -4..128 {
                        for y in (-8..15).chain(120..256) {
                            for z in (0..60).chain([127]) {
                                let at = [(x + 4) as u32, (y + 8) as u32, z as u32];
                                let found = grid.voxels.at(at);
                                assert_eq!(
                                    found,
                                    expected([x, y, z]),
                                    "{compression:?} {masks} {kind:?} {x} {y} {z}"
                                );
                            }
                        }
                    }
                }
            }
            for kind in [VdbKind::Vec3, VdbKind::HalfVec3, VdbKind::DoubleVec3] {
                let bytes = file(compression, masks, vec![ball("Cd", kind, VdbMap::Uniform(1.0))]).to_bytes();
                let grid = read::<[f32; 3]>(&bytes, 0).unwrap();
                let v = value([0, 5, 12]);
                assert_eq!(grid.voxels.at([4, 13, 12]), [v, v + 1.0, -v]);
                assert_eq!(grid.voxels.at([12, 8, 40]), [0.5, 1.5, 2.5]);
            }
        }
    }
}

#[test]
fn inactive_values_may_be_left_out_in_every_way() {
    // Of what is off there is: the background, its negative, one value, and pairs of these.
    for (background, off) in [
        (3.0, vec![3.0]),
        (3.0, vec![-3.0]),
        (3.0, vec![5.0]),
        (3.0, vec![3.0, -3.0]),
        (3.0, vec![3.0, 5.0]),
        (3.0, vec![5.0, 6.0]),
        (3.0, vec![5.0, 6.0, 7.0]),
        (0.0, vec![0.0]),
    ] {
        let mut grid = VdbGrid::new("d", VdbKind::Float, VdbMap::Uniform(1.0));
        grid.background = [background; 3];
        for k in 0..512 {
            let index = [k >> 6, k >> 3 & 7, k & 7];
            let is_on = k % 3 == 0 || [0, 7].contains(&index[0]);
            match is_on {
                true => grid.set(index, [k as f32; 3]),
                false => grid.set_inactive(index, [off[k as usize % off.len()]; 3]),
            }
        }
        let read = read::<f32>(&file(VdbCompression::Zip, true, vec![grid]).to_bytes(), 0).unwrap();
        for k in 0..512u32 {
            let index = [k >> 6, k >> 3 & 7, k & 7];
            let is_on = k % 3 == 0 || [0, 7].contains(&index[0]);
            let expected = if is_on { k as f32 } else { off[k as usize % off.len()] };
            assert_eq!(read.voxels.at(index), expected, "{off:?} {index:?}");
        }
    }
}

#[test]
fn grids_are_found_by_name_and_placed() {
    let axes = [[0.0, 2.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 0.5]];
    let grids = vec![
        ball("Cd", VdbKind::Vec3, VdbMap::Uniform(1.0)),
        ball("density", VdbKind::Float, VdbMap::ScaleTranslate([1.0, 2.0, 4.0], [10.0, 20.0, 30.0])),
        ball("flame", VdbKind::Half, VdbMap::Affine(axes, [1.0, 2.0, 3.0])),
    ];
    let bytes = file(VdbCompression::Zip, true, grids).to_bytes();
    let entries = list_vdb(open(&bytes), &limits()).unwrap();
    let found: Vec<_> = entries.iter().map(|entry| (&*entry.name, entry.channels.clone())).collect();
    assert_eq!(found, [("Cd", Ok(3)), ("density", Ok(1)), ("flame", Ok(1))]);
    // The middle of voxel (-4, -8, 0).
    let density = read::<f32>(&bytes, 1).unwrap();
    assert_eq!((&*density.name, density.map.point([0.5; 3])), ("density", [6.0, 4.0, 30.0]));
    let flame = read::<f32>(&bytes, 2).unwrap();
    assert_eq!(flame.map.point([0.5; 3]), [9.0, -6.0, 3.0]);
    assert_eq!(read::<f32>(&bytes, 0).unwrap_err(), "the grid `Cd` has 3 numbers in a voxel, not 1");
    assert_eq!(read::<f32>(&bytes, 3).unwrap_err(), "there is no such grid");
}

#[test]
fn memory_is_for_what_is_there() {
    // Two voxels 10,000 voxels apart.
    let mut grid = VdbGrid::new("d", VdbKind::Float, VdbMap::Uniform(1.0));
    [0, 10_000].iter().for_each(|x| grid.set([*x, x / 2, x / 3], [1.0; 3]));
    let bytes = file(VdbCompression::None, true, vec![grid]).to_bytes();
    let grid = read::<f32>(&bytes, 0).unwrap();
    assert_eq!(grid.voxels.size(), [10_001, 5001, 3334]);
    assert!(grid.voxels.bytes() < 1 << 20, "{}", grid.voxels.bytes());
    let none = Limits { memory: MemoryBudget::new(1000), ..Limits::default() };
    let over = read_vdb::<f32>(open(&bytes), 0, &none).err().unwrap().to_string();
    assert!(over.contains("memory"), "{over}");
}

#[test]
fn what_is_no_grid_is_said() {
    let error = |file: VdbFile| read::<f32>(&file.to_bytes(), 0).err().unwrap();
    let empty = VdbGrid::new("d", VdbKind::Float, VdbMap::Uniform(1.0));
    let of = |grid: VdbGrid| file(VdbCompression::Zip, true, vec![grid]);
    assert_eq!(error(of(empty.clone())), "the grid has no active voxels");
    let mut far = empty.clone();
    far.set([i32::MIN; 3], [1.0; 3]);
    far.set([i32::MAX; 3], [1.0; 3]);
    assert!(error(of(far)).contains("4294967296 x 4294967296 x 4294967296, which is too large"));
    let mut flat = empty.clone();
    flat.map = VdbMap::Uniform(f64::NAN);
    flat.set([0; 3], [1.0; 3]);
    assert_eq!(error(of(flat)), "the places of its voxels are no numbers");
    assert!(error(VdbFile { version: 221, ..of(empty.clone()) }).contains("version 221"));
    assert_eq!(error(VdbFile { grids: vec![], ..of(empty) }), "there is no such grid");
    assert_eq!(read::<f32>(b" BDV\0\0\0\0abc", 0).unwrap_err(), "the file ends within a grid");
    assert_eq!(read::<f32>(b"OBJ", 0).unwrap_err(), "this is no file of OpenVDB, nor of NanoVDB");
    assert_eq!(read::<f32>(&[0; 99], 0).unwrap_err(), "this is no file of OpenVDB, nor of NanoVDB");
    // Numbers that a file may say.
    let mut hostile = of(ball("density", VdbKind::Float, VdbMap::Uniform(1.0))).to_bytes();
    let at = hostile.windows(7).position(|word| word == b"density").unwrap() + 7 + 4 + 16 + 4;
    for (place, said) in [
        (-1i64, "the grid `density` begins before the file"),
        (i64::MAX, "the file ends within a grid"),
        (3, "it says that a part begins at byte 3, which is in another one"),
    ] {
        hostile[at..at + 8].copy_from_slice(&place.to_le_bytes());
        assert_eq!(read::<f32>(&hostile, 0).unwrap_err(), said);
    }
}

/// Cut off anywhere, or with any byte changed, a file is read or refused.
#[test]
fn damaged_files_are_refused() {
    for compression in [VdbCompression::None, VdbCompression::Zip, VdbCompression::Blosc] {
        let mut grid = VdbGrid::new("d", VdbKind::Float, VdbMap::Uniform(1.0));
        (0..200).for_each(|k| grid.set([k % 9, k / 9, k % 4], [k as f32; 3]));
        let bytes = file(compression, true, vec![grid]).to_bytes();
        read::<f32>(&bytes, 0).unwrap();
        for len in (8..bytes.len()).step_by(23) {
            let error = read::<f32>(&bytes[..len], 0).err().unwrap();
            assert!(error.contains("ends within a grid"), "{len}: {error}");
        }
        for at in (0..bytes.len()).step_by(7) {
            let mut damaged = bytes.clone();
            damaged[at] ^= 0xff;
            let _ = read::<f32>(&damaged, 0);
        }
    }
}

#[test]
fn nano_grids_are_those_of_open_ones() {
    let axes = [[0.0, 2.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 0.5]];
    let mut other = ball("flame", VdbKind::Float, VdbMap::Affine(axes, [1.0, 2.0, 3.0]));
    other.tile(12, [-8192, 0, 0], [0.5; 3], true);
    let grids = [ball("density", VdbKind::Float, VdbMap::Uniform(0.5)), other];
    let open_file = file(VdbCompression::Zip, true, grids.to_vec()).to_bytes();
    for compression in [VdbCompression::None, VdbCompression::Zip, VdbCompression::Blosc] {
        let bytes = nano_vdb::to_bytes(&grids, compression);
        let names = list_vdb(open(&bytes), &limits()).unwrap();
        assert_eq!(names.iter().map(|entry| &*entry.name).collect::<Vec<_>>(), ["density", "flame"]);
        for index in [0, 1] {
            let [nano, open] = [&bytes, &open_file].map(|bytes| read::<f32>(bytes, index).unwrap());
            assert_eq!((nano.voxels.size(), nano.map), (open.voxels.size(), open.map));
            let [nx, ny, nz] = open.voxels.size();
            for k in 0..200_000u64 {
                let along = |step: u64, n: u32| (k * step % u64::from(n)) as u32;
                let voxel = [along(7919, nx), along(104_729, ny), along(1, nz)];
                assert_eq!(nano.voxels.at(voxel), open.voxels.at(voxel), "{voxel:?}");
            }
        }
    }
    assert_eq!(
        read::<f32>(&nano_vdb::to_bytes(&[], VdbCompression::None), 0).err().unwrap(),
        "there is no such grid"
    );
}

#[test]
fn nano_grids_have_numbers_of_every_kind() {
    use VdbCompression::{None, Zip};
    let grid = ball("v", VdbKind::Float, VdbMap::Uniform(1.0));
    let bytes = |kind| nano_vdb::to_bytes_as(std::slice::from_ref(&grid), &[kind], Zip);
    let voxels = |z| (-4..15).flat_map(move |x| (-8..15).map(move |y| [x, y, z]));
    let at = |[x, y, z]: [i32; 3]| [(x + 4) as u32, (y + 8) as u32, z as u32];
    for kind in [NanoKind::Vec3, NanoKind::DoubleVec3] {
        let nano = read::<[f32; 3]>(&bytes(kind), 0).unwrap();
        let open = ball("v", VdbKind::Vec3, VdbMap::Uniform(1.0));
        let open = read::<[f32; 3]>(&file(None, true, vec![open]).to_bytes(), 0).unwrap();
        for index in (3..45).flat_map(voxels) {
            assert_eq!(nano.voxels.at(at(index)), open.voxels.at(at(index)), "{kind:?} {index:?}");
        }
    }
    for (kind, off) in [
        (NanoKind::Double, 0.0),
        // Leaves have numbers from -1 to 4.
        (NanoKind::Codes(4), 5.0 / 65_535.0),
        (NanoKind::Codes(3), 5.0 / 255.0),
        (NanoKind::Codes(2), 5.0 / 15.0),
        (NanoKind::CodesByLeaf, 5.0),
    ] {
        let read = read::<f32>(&bytes(kind), 0).unwrap();
        let (mut largest, mut exact) = (0.0f32, 0);
        for index in (3..45).flat_map(voxels) {
            let difference = (read.voxels.at(at(index)) - expected(index)).abs();
            largest = largest.max(difference);
            exact += usize::from(difference < 1e-4);
        }
        assert!(largest <= 0.51 * off, "{kind:?} {largest}");
        // By turns: a fifth of the leaves is known to sixteen bits.
        assert!(kind != NanoKind::CodesByLeaf || exact > 3000, "{exact}");
    }
    let other = nano_vdb::to_bytes(&[grid], None);
    let mut whole = other.clone();
    whole[16 + 32] = 4;
    assert_eq!(
        read::<f32>(&whole, 0).err().unwrap(),
        "the grid `v` has voxels of whole numbers, and what is read has one number or three"
    );
    assert_eq!(read::<[f32; 3]>(&other, 0).err().unwrap(), "the grid `v` has 1 numbers in a voxel, not 3");
}

/// A file that is cut off is refused, and one with other bits somewhere is either refused or read.
fn refuse_damaged<T: VoxelValue>(bytes: &[u8]) {
    let step = bytes.len() / 100 + 1;
    for len in (8..bytes.len()).step_by(step) {
        assert!(read::<T>(&bytes[..len], 0).is_err(), "{len}");
    }
    for at in (0..bytes.len()).step_by(step).chain(0..300.min(bytes.len())) {
        let mut damaged = bytes.to_vec();
        damaged[at] ^= 0xff;
        let _ = read::<T>(&damaged, 0);
    }
}

#[test]
fn damaged_nano_files_are_refused() {
    let mut grid = VdbGrid::new("d", VdbKind::Float, VdbMap::Uniform(1.0));
    (0..200).for_each(|k| grid.set([k % 9, k / 9, k % 4], [k as f32; 3]));
    let as_kind =
        |kind, compression| nano_vdb::to_bytes_as(std::slice::from_ref(&grid), &[kind], compression);
    let numbers = [NanoKind::Float, NanoKind::Double, NanoKind::CodesByLeaf]
        .into_iter()
        .chain((2..5).map(NanoKind::Codes))
        .map(|kind| as_kind(kind, VdbCompression::None));
    let packed =
        [VdbCompression::Zip, VdbCompression::Blosc].map(|packing| as_kind(NanoKind::Float, packing));
    numbers.chain(packed).for_each(|bytes| refuse_damaged::<f32>(&bytes));
    let vectors = [NanoKind::Vec3, NanoKind::DoubleVec3].map(|kind| as_kind(kind, VdbCompression::None));
    vectors.iter().for_each(|bytes| refuse_damaged::<[f32; 3]>(bytes));
    let upper = 16 + 176 + 2 + 672 + 64 + 96;
    let leaf = upper + 8256 + 8 * 32_768 + 1088 + 8 * 4096;
    let mut bytes = as_kind(NanoKind::CodesByLeaf, VdbCompression::None);
    bytes[leaf + 15] |= 0xe0;
    assert_eq!(read::<f32>(&bytes, 0).err().unwrap(), "a leaf of it has codes of 128 bits");
    // All entries of a node are one child, which costs no more than the bytes of the file.
    let mut bytes = as_kind(NanoKind::Float, VdbCompression::None);
    let (masks, table) = (upper + 32 + 4096, upper + 8256);
    let child: [u8; 8] = bytes[table..table + 8].try_into().unwrap();
    bytes[masks..masks + 4096].fill(0xff);
    bytes[table..table + 8 * 32_768].as_chunks_mut().0.fill(child);
    assert_eq!(read::<f32>(&bytes, 0).err().unwrap(), "parts of the grid overlap");
}
