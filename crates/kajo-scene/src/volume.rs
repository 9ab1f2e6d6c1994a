//! Files of density grids.
//!
//! ```text
//! Mitsuba .vol          POV-Ray .df3             raw
//! "VOL", u8 3           u16 nx ny nz, big end     nothing but values: the scene says the rest
//! i32 encoding (1)      values of 8, 16 or 32
//! i32 nx ny nz          bits, big end first, by
//! i32 channels          the length of the file;
//! f32 min xyz, max xyz  the largest stands for 1
//! f32 values
//! ```
//!
//! x runs first, then y. All of it is little end first but `df3`. Values are taken from the stream piece by piece, so a header cannot
//! ask for more memory than the file has bytes for.

use std::io::Read;

use crate::assets::{AssetError, AssetFile};
use crate::limits::Limits;
use crate::memory_budget::{MemoryShare, OverBudget};

/// A grid of numbers as a file stores it.
#[derive(Debug)]
pub struct VolumeFile {
    /// Voxels along x, y and z.
    pub size: [u32; 3],
    /// x first, then y.
    pub values: Vec<f32>,
    /// The box that it fills, where the file says one.
    pub bounds: Option<[[f32; 3]; 2]>,
    /// Memory of the values, which the holder of this keeps.
    pub memory: MemoryShare,
}

/// How numbers are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VolumeEncoding {
    /// Bytes; 255 stands for 1.
    U8,
    /// Two bytes; 65535 stands for 1.
    U16,
    /// Floats of four bytes.
    F32,
}

/// The values of a raw file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RawVolume {
    /// Voxels along x, y and z.
    pub size: [u32; 3],
    /// How each is stored.
    pub encoding: VolumeEncoding,
}

/// Why a grid cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum VolumeError {
    /// The file could not be read.
    #[error(transparent)]
    Asset(#[from] AssetError),
    /// Values need more memory than is left.
    #[error(transparent)]
    Memory(#[from] OverBudget),
    /// The file is something else.
    #[error("{0}")]
    Content(String),
    /// It ends before its last value.
    #[error("the file ends after {found} of its {expected} values")]
    Short {
        /// Values that it has.
        found: u64,
        /// Values that it should have.
        expected: u64,
    },
}

/// How values stand in the stream.
#[derive(Clone, Copy)]
struct Layout {
    bytes: usize,
    decode: fn(&[u8]) -> f32,
    /// Values of a voxel, of which the first is taken.
    channels: usize,
}

/// Reads a grid: `.vol` by its first letters, what `raw` says if the scene says it, else `.df3`.
///
/// # Errors
/// [`VolumeError`], at the first thing that is malformed, cut off, or exceeds a limit.
pub fn read_volume(
    file: AssetFile,
    raw: Option<RawVolume>,
    limits: &Limits,
) -> Result<VolumeFile, VolumeError> {
    let limit = limits.mesh_bytes;
    if file.len.is_some_and(|len| len > limit) {
        return Err(AssetError::TooLarge { limit }.into());
    }
    let len = file.len;
    let mut reader = file.reader.take(limit);
    if let Some(RawVolume { size, encoding }) = raw {
        let layout = match encoding {
            VolumeEncoding::U8 => Layout { bytes: 1, decode: |b| f32::from(b[0]) / 255.0, channels: 1 },
            VolumeEncoding::U16 => Layout {
                bytes: 2,
                decode: |b| f32::from(u16::from_le_bytes([b[0], b[1]])) / 65535.0,
                channels: 1,
            },
            VolumeEncoding::F32 => Layout { bytes: 4, decode: float, channels: 1 },
        };
        return values(&mut reader, size, layout, None, limits);
    }
    let head: [u8; 6] = head(&mut reader)?;
    if head.starts_with(b"VOL") {
        vol(&mut reader, head, limits)
    } else {
        df3(&mut reader, head, len, limits)
    }
}

fn float(b: &[u8]) -> f32 {
    f32::from_le_bytes([b[0], b[1], b[2], b[3]])
}

/// The first bytes of what is left.
fn head<const N: usize>(reader: &mut impl Read) -> Result<[u8; N], VolumeError> {
    let mut head = [0; N];
    match reader.read_exact(&mut head) {
        Ok(()) => Ok(head),
        Err(error) if error.kind() == std::io::ErrorKind::UnexpectedEof => {
            Err(VolumeError::Content("the file ends within its header".to_owned()))
        }
        Err(error) => Err(AssetError::from(error).into()),
    }
}

/// * `first`: the bytes read so far
fn vol(reader: &mut impl Read, first: [u8; 6], limits: &Limits) -> Result<VolumeFile, VolumeError> {
    if first[3] != 3 {
        return Err(VolumeError::Content(format!("this is version {} of the format, not 3", first[3])));
    }
    let rest: [u8; 42] = head(reader)?;
    let mut all = [0; 44];
    all[..2].copy_from_slice(&first[4..]);
    all[2..].copy_from_slice(&rest);
    let whole = |i: usize| i32::from_le_bytes([all[4 * i], all[4 * i + 1], all[4 * i + 2], all[4 * i + 3]]);
    let [encoding, channels] = [whole(0), whole(4)];
    if encoding != 1 {
        return Err(VolumeError::Content(format!(
            "its values have encoding {encoding}, and only floats (1) are read"
        )));
    }
    let [Ok(nx), Ok(ny), Ok(nz)] = [1, 2, 3].map(|i| u32::try_from(whole(i))) else {
        return Err(VolumeError::Content("a number of voxels is negative".to_owned()));
    };
    if !(1..=16).contains(&channels) {
        return Err(VolumeError::Content(format!("it has {channels} channels")));
    }
    let corner = |i: usize| [0, 1, 2].map(|axis| float(&all[4 * (5 + 3 * i + axis)..]));
    let layout = Layout { bytes: 4, decode: float, channels: channels as usize };
    values(reader, [nx, ny, nz], layout, Some([corner(0), corner(1)]), limits)
}

fn df3(
    reader: &mut impl Read,
    first: [u8; 6],
    len: Option<u64>,
    limits: &Limits,
) -> Result<VolumeFile, VolumeError> {
    let size = [0, 1, 2].map(|i| u32::from(u16::from_be_bytes([first[2 * i], first[2 * i + 1]])));
    let voxels: u64 = size.into_iter().map(u64::from).product();
    let Some(len) = len else {
        return Err(VolumeError::Content(
            "the length of a df3 file says how its values are stored, and it is not known".to_owned(),
        ));
    };
    let left = len.saturating_sub(6);
    let layout = match left.checked_div(voxels) {
        Some(1) => Layout { bytes: 1, decode: |b| f32::from(b[0]) / 255.0, channels: 1 },
        Some(2 | 3) => Layout {
            bytes: 2,
            decode: |b| f32::from(u16::from_be_bytes([b[0], b[1]])) / 65535.0,
            channels: 1,
        },
        Some(4) => Layout {
            bytes: 4,
            decode: |b| (f64::from(u32::from_be_bytes([b[0], b[1], b[2], b[3]])) / 4_294_967_295.0) as f32,
            channels: 1,
        },
        Some(0) => return Err(VolumeError::Short { found: left, expected: voxels }),
        None => return Err(VolumeError::Content("the grid has no voxels".to_owned())),
        Some(_) => {
            let message = format!(
                "this is no .vol and no .df3: {len} bytes for {} x {} x {} voxels",
                size[0], size[1], size[2]
            );
            return Err(VolumeError::Content(message));
        }
    };
    values(reader, size, layout, None, limits)
}

/// Values until there is one for each voxel.
fn values(
    reader: &mut impl Read,
    size: [u32; 3],
    layout: Layout,
    bounds: Option<[[f32; 3]; 2]>,
    limits: &Limits,
) -> Result<VolumeFile, VolumeError> {
    /// Voxels that are read at once.
    const PIECE: usize = 1 << 14;
    let expected = size.into_iter().map(u64::from).try_fold(1, u64::checked_mul).unwrap_or(u64::MAX);
    if expected == 0 {
        return Err(VolumeError::Content("the grid has no voxels".to_owned()));
    }
    let mut memory = limits.memory.share(0)?;
    let mut values: Vec<f32> = Vec::new();
    let voxel = layout.bytes * layout.channels;
    let mut piece = vec![0; PIECE * voxel];
    while (values.len() as u64) < expected {
        let wanted = (expected - values.len() as u64).min(PIECE as u64) as usize;
        let bytes = fill(reader, &mut piece[..wanted * voxel])?;
        let found = bytes / voxel;
        if values.capacity() - values.len() < found {
            // By a quarter, so that little more is held than is needed; what is moved is not counted twice.
            let more = (values.len() / 4).max(found).min((expected - values.len() as u64) as usize);
            memory.grow((more * size_of::<f32>()) as u64)?;
            let over = || limits.memory.exceeded((more * size_of::<f32>()) as u64);
            values.try_reserve_exact(more).map_err(|_| over())?;
        }
        values.extend(piece[..found * voxel].chunks_exact(voxel).map(|voxel| (layout.decode)(voxel)));
        if found < wanted {
            return Err(VolumeError::Short { found: values.len() as u64, expected });
        }
    }
    Ok(VolumeFile { size, values, bounds, memory })
}

/// Fills a piece as far as there are bytes.
fn fill(reader: &mut impl Read, piece: &mut [u8]) -> Result<usize, VolumeError> {
    let mut filled = 0;
    while filled < piece.len() {
        match reader.read(&mut piece[filled..]) {
            Ok(0) => break,
            Ok(n) => filled += n,
            Err(error) if error.kind() == std::io::ErrorKind::Interrupted => {}
            Err(error) => return Err(AssetError::from(error).into()),
        }
    }
    Ok(filled)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::assets::{Assets, MemoryAssets};
    use crate::memory_budget::MemoryBudget;

    fn read(bytes: Vec<u8>, raw: Option<RawVolume>) -> Result<VolumeFile, String> {
        let assets = MemoryAssets::new().with("v", bytes);
        let limits = Limits { memory: MemoryBudget::new(1 << 20), ..Limits::default() };
        read_volume(assets.open("v", "").unwrap(), raw, &limits).map_err(|error| error.to_string())
    }

    fn vol_file([nx, ny, nz]: [i32; 3], channels: i32, values: &[f32]) -> Vec<u8> {
        let mut bytes = b"VOL\x03".to_vec();
        [1, nx, ny, nz, channels].iter().for_each(|n| bytes.extend(n.to_le_bytes()));
        [-1.0f32, -2.0, -3.0, 1.0, 2.0, 3.0].iter().chain(values).for_each(|v| bytes.extend(v.to_le_bytes()));
        bytes
    }

    #[test]
    fn the_formats_are_read() {
        let vol = read(vol_file([3, 1, 2], 1, &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0]), None).unwrap();
        assert_eq!((vol.size, &*vol.values), ([3, 1, 2], &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0][..]));
        assert_eq!(vol.bounds, Some([[-1.0, -2.0, -3.0], [1.0, 2.0, 3.0]]));
        let first = read(vol_file([2, 1, 1], 2, &[0.5, 9.0, 0.25, 9.0]), None).unwrap();
        assert_eq!(*first.values, [0.5, 0.25]);
        let df3 = |values: &[u8]| [&[0, 2, 0, 1, 0, 1], values].concat();
        assert_eq!(*read(df3(&[0, 255]), None).unwrap().values, [0.0, 1.0]);
        assert_eq!(*read(df3(&[255, 255, 0, 0]), None).unwrap().values, [1.0, 0.0]);
        assert_eq!(*read(df3(&[128, 0, 0, 0, 0, 0, 0, 0]), None).unwrap().values, [0.5, 0.0]);
        let raw = |encoding| Some(RawVolume { size: [1, 2, 1], encoding });
        assert_eq!(*read(vec![51, 255], raw(VolumeEncoding::U8)).unwrap().values, [0.2, 1.0]);
        assert_eq!(*read(vec![255, 255, 0, 0], raw(VolumeEncoding::U16)).unwrap().values, [1.0, 0.0]);
        let floats = [1.5f32, 2.5].iter().flat_map(|v| v.to_le_bytes()).collect();
        assert_eq!(*read(floats, raw(VolumeEncoding::F32)).unwrap().values, [1.5, 2.5]);
    }

    #[test]
    fn what_is_no_grid_is_said() {
        let error = |bytes| read(bytes, None).err().unwrap();
        assert_eq!(error(b"VO".to_vec()), "the file ends within its header");
        assert_eq!(error(b"VOL\x02\0\0".to_vec()), "this is version 2 of the format, not 3");
        assert_eq!(error(vol_file([2, 2, 2], 1, &[1.0; 7])), "the file ends after 7 of its 8 values");
        // Numbers that a header may say.
        let huge = vol_file([i32::MAX; 3], 1, &[1.0; 70]);
        assert!(error(huge).starts_with("the file ends after 70 of its "), "nothing is made of the number");
        assert_eq!(
            error(vol_file([10_000, 10_000, 10_000], 1, &[])),
            "the file ends after 0 of its 1000000000000 values"
        );
        assert_eq!(error(vol_file([0, 9, 9], 1, &[])), "the grid has no voxels");
        assert_eq!(error(vol_file([-1, 9, 9], 1, &[])), "a number of voxels is negative");
        assert_eq!(error(vol_file([1, 1, 1], 0, &[1.0])), "it has 0 channels");
        assert_eq!(error(vec![0, 0, 0, 1, 0, 1, 7]), "the grid has no voxels");
        assert_eq!(error(vec![0, 9, 0, 9, 0, 9, 7]), "the file ends after 1 of its 729 values");
        assert!(error(vec![0, 1, 0, 1, 0, 1, 7, 7, 7, 7, 7]).contains("no .vol and no .df3"));
        let over = error(vol_file([1 << 10, 1 << 9, 1], 1, &vec![0.0; 1 << 19]));
        assert!(over.contains("memory") || over.contains("MiB"), "{over}");
    }
}
