//! What is in front of a file and of each of its grids.

use super::input::Input;
use crate::volume::VolumeError;

/// The front of a file.
pub struct Header {
    pub grids: u32,
}

/// The numbers that a tree has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Number {
    /// Two bytes.
    Half,
    /// Four bytes.
    Float,
    /// Eight bytes.
    Double,
}

/// How the numbers of voxels are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stored {
    /// Numbers of a voxel.
    pub channels: usize,
    pub number: Number,
    /// Whether arrays of them are of halves, whatever the tree has.
    pub is_half: bool,
}

/// What a grid holds.
pub enum GridKind {
    Values {
        channels: usize,
        number: Number,
    },
    /// Something that is not read, and why.
    Other(String),
}

/// The front of a grid.
pub struct GridHeader {
    pub name: String,
    pub kind: GridKind,
    /// Where the grid, its leaves, and what comes behind it begin.
    pub start: u64,
    pub buffers: u64,
    pub end: u64,
}

impl Header {
    pub fn read(input: &mut Input) -> Result<Header, VolumeError> {
        if input.array()? != super::MAGIC {
            return Err(VolumeError::Content("this is no file of OpenVDB".to_owned()));
        }
        let version = input.u32()?;
        if !(222..=225).contains(&version) {
            let message = format!("it has version {version} of the format, and only 222 to 225 are read");
            return Err(VolumeError::Content(message));
        }
        let _library: [u8; 8] = input.array()?;
        if input.u8()? == 0 {
            let message = "it was written as a stream, without the places of its grids";
            return Err(VolumeError::Content(message.to_owned()));
        }
        let _uuid: [u8; 36] = input.array()?;
        metadata(input)?;
        Ok(Header { grids: input.u32()? })
    }

    /// What is in front of the next grid.
    pub fn grid(&self, input: &mut Input) -> Result<GridHeader, VolumeError> {
        // Grids of the same name are told apart by a number behind a separator.
        let named = input.text()?;
        let name = named.split('\x1e').next().unwrap_or_default().to_owned();
        let [kind, parent] = [input.text()?, input.text()?];
        let kind = match &*parent {
            "" => kind_of(&name, &kind),
            _ => {
                let parent = parent.split('\x1e').next().unwrap_or_default();
                GridKind::Other(format!("the grid `{name}` is an instance of `{parent}`: name that one"))
            }
        };
        let mut places = [0; 3];
        for place in &mut places {
            *place = u64::try_from(input.i64()?)
                .map_err(|_| VolumeError::Content(format!("the grid `{name}` begins before the file")))?;
        }
        let [start, buffers, end] = places;
        Ok(GridHeader { name, kind, start, buffers, end })
    }
}

fn kind_of(name: &str, kind: &str) -> GridKind {
    let (channels, number) = match kind.strip_suffix("_HalfFloat").unwrap_or(kind) {
        "Tree_half_5_4_3" => (1, Number::Half),
        "Tree_float_5_4_3" => (1, Number::Float),
        "Tree_double_5_4_3" => (1, Number::Double),
        "Tree_vec3s_5_4_3" => (3, Number::Float),
        "Tree_vec3d_5_4_3" => (3, Number::Double),
        _ => return GridKind::Other(format!("the grid `{name}` is a {kind}, which is not read")),
    };
    GridKind::Values { channels, number }
}

/// Steps over what a file or a grid says of itself; whether arrays of its numbers are of halves.
///
/// The library believes this entry, not the name of the tree.
pub fn metadata(input: &mut Input) -> Result<bool, VolumeError> {
    let mut is_half = false;
    for _ in 0..input.u32()? {
        let [name, _kind] = [input.text()?, input.text()?];
        let bytes = input.u32()?;
        if name == "is_saved_as_half_float" && bytes == 1 {
            is_half = input.u8()? != 0;
        } else {
            input.skip(bytes.into())?;
        }
    }
    Ok(is_half)
}
