//! A writer of OpenVDB files, for tests and the grids of examples.
//!
//! The layout is told by the reader, `kajo_scene::read_vdb`. Values are chosen and left out as the library does, so that every way of storing the
//! inactive ones is met; files of it are read by `vdb_print`.

use std::collections::{BTreeMap, BTreeSet};

use kajo_math::half;

/// How arrays of values are compressed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VdbCompression {
    /// Not at all.
    None,
    /// By zlib.
    Zip,
    /// By LZ4 in a container of Blosc, with shuffled bytes.
    Blosc,
}

/// What a voxel holds, and how.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VdbKind {
    /// Four bytes.
    Float,
    /// A float that is saved as a half.
    Half,
    /// Eight bytes.
    Double,
    /// Three floats.
    Vec3,
    /// Three floats that are saved as halves.
    HalfVec3,
    /// Three numbers of eight bytes.
    DoubleVec3,
    /// A half, as trees of version 225 have it.
    OwnHalf,
}

/// From indices to the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum VdbMap {
    /// The size of a voxel.
    Uniform(f64),
    /// Sizes along the axes, and what the origin becomes.
    ScaleTranslate([f64; 3], [f64; 3]),
    /// What the axes become, and what the origin becomes.
    Affine([[f64; 3]; 3], [f64; 3]),
}

/// Masks of active voxels and values of a leaf; z runs first.
#[derive(Clone, Debug)]
pub(crate) struct Leaf {
    pub active: [bool; 512],
    pub values: [[f32; 3]; 512],
}

/// A grid to write.
#[derive(Clone, Debug)]
pub struct VdbGrid {
    /// Its name.
    pub name: String,
    /// What its voxels hold.
    pub kind: VdbKind,
    /// From indices to the world.
    pub map: VdbMap,
    /// What voxels are that nothing is said of.
    pub background: [f32; 3],
    pub(crate) leaves: BTreeMap<[i32; 3], Leaf>,
    pub(crate) tiles: BTreeMap<(u32, [i32; 3]), ([f32; 3], bool)>,
}

impl VdbMap {
    /// What the axes become, and what the origin becomes.
    pub fn affine(&self) -> ([[f64; 3]; 3], [f64; 3]) {
        let scaled = |[x, y, z]: [f64; 3]| [[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]];
        match *self {
            VdbMap::Uniform(size) => (scaled([size; 3]), [0.0; 3]),
            VdbMap::ScaleTranslate(scale, origin) => (scaled(scale), origin),
            VdbMap::Affine(axes, origin) => (axes, origin),
        }
    }
}

/// A file to write.
#[derive(Clone, Debug)]
pub struct VdbFile {
    /// The version of the format.
    pub version: u32,
    /// How values are compressed.
    pub compression: VdbCompression,
    /// Whether values of inactive voxels are left out.
    pub masks: bool,
    /// Its grids.
    pub grids: Vec<VdbGrid>,
}

impl VdbGrid {
    /// A grid without voxels, on a background of zero.
    pub fn new(name: &str, kind: VdbKind, map: VdbMap) -> VdbGrid {
        let (leaves, tiles) = (BTreeMap::new(), BTreeMap::new());
        VdbGrid { name: name.to_owned(), kind, map, background: [0.0; 3], leaves, tiles }
    }

    fn voxel(&mut self, index: [i32; 3]) -> (&mut Leaf, usize) {
        let background = self.background;
        let leaf = self
            .leaves
            .entry(index.map(|x| x & !7))
            .or_insert(Leaf { active: [false; 512], values: [background; 512] });
        let [x, y, z] = index.map(|x| (x & 7) as usize);
        (leaf, x << 6 | y << 3 | z)
    }

    /// Gives a voxel an active value; of scalar grids the first number counts.
    pub fn set(&mut self, index: [i32; 3], value: [f32; 3]) {
        let (leaf, k) = self.voxel(index);
        (leaf.active[k], leaf.values[k]) = (true, value);
    }

    /// Gives a voxel a value that is not active.
    pub fn set_inactive(&mut self, index: [i32; 3], value: [f32; 3]) {
        let (leaf, k) = self.voxel(index);
        (leaf.active[k], leaf.values[k]) = (false, value);
    }

    /// Gives a cube one value.
    ///
    /// * `log2_width`: 3, 7 or 12
    /// * `origin`: a multiple of the width
    pub fn tile(&mut self, log2_width: u32, origin: [i32; 3], value: [f32; 3], is_active: bool) {
        self.tiles.insert((log2_width, origin), (value, is_active));
    }

    fn channels(&self) -> usize {
        if matches!(self.kind, VdbKind::Vec3 | VdbKind::HalfVec3 | VdbKind::DoubleVec3) { 3 } else { 1 }
    }
}

impl VdbFile {
    /// The bytes of the file.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut out = Vec::new();
        out.extend(*b" BDV\0\0\0\0");
        [self.version, 10, 0].iter().for_each(|n| out.extend(n.to_le_bytes()));
        out.push(1);
        out.extend(*b"00000000-0000-0000-0000-000000000000");
        metadata(&mut out, &[("creator", "string", b"kajo")]);
        out.extend((self.grids.len() as u32).to_le_bytes());
        for grid in &self.grids {
            text(&mut out, &grid.name);
            text(
                &mut out,
                match grid.kind {
                    VdbKind::Float => "Tree_float_5_4_3",
                    VdbKind::Half => "Tree_float_5_4_3_HalfFloat",
                    VdbKind::Double => "Tree_double_5_4_3",
                    VdbKind::Vec3 => "Tree_vec3s_5_4_3",
                    VdbKind::HalfVec3 => "Tree_vec3s_5_4_3_HalfFloat",
                    VdbKind::DoubleVec3 => "Tree_vec3d_5_4_3",
                    VdbKind::OwnHalf => "Tree_half_5_4_3",
                },
            );
            text(&mut out, "");
            let places = out.len();
            out.extend([0; 24]);
            let start = out.len() as u64;
            let buffers = Writer { file: self, grid, out: &mut out }.grid();
            let ends = [start, buffers, out.len() as u64];
            for (k, place) in ends.into_iter().enumerate() {
                out[places + 8 * k..places + 8 * k + 8].copy_from_slice(&place.to_le_bytes());
            }
        }
        out
    }
}

fn text(out: &mut Vec<u8>, text: &str) {
    out.extend((text.len() as u32).to_le_bytes());
    out.extend(text.as_bytes());
}

fn metadata(out: &mut Vec<u8>, entries: &[(&str, &str, &[u8])]) {
    out.extend((entries.len() as u32).to_le_bytes());
    for (name, kind, data) in entries {
        text(out, name);
        text(out, kind);
        out.extend((data.len() as u32).to_le_bytes());
        out.extend(*data);
    }
}

struct Writer<'a> {
    file: &'a VdbFile,
    grid: &'a VdbGrid,
    out: &'a mut Vec<u8>,
}

impl Writer<'_> {
    /// Writes a grid; where its leaves begin.
    fn grid(&mut self) -> u64 {
        let compression = match self.file.compression {
            VdbCompression::None => 0,
            VdbCompression::Zip => 1,
            VdbCompression::Blosc => 4,
        };
        self.out.extend((compression | u32::from(self.file.masks) << 1).to_le_bytes());
        let is_half = matches!(self.grid.kind, VdbKind::Half | VdbKind::HalfVec3);
        metadata(
            self.out,
            &[
                ("class", "string", b"fog volume"),
                ("is_saved_as_half_float", "bool", &[u8::from(is_half)]),
                ("name", "string", self.grid.name.as_bytes()),
            ],
        );
        self.map();
        self.out.extend(1u32.to_le_bytes());
        let background = self.grid.background;
        self.value(background);
        let of_root: Vec<_> = self.grid.tiles.iter().filter(|((width, _), _)| *width == 12).collect();
        let inner = self.grid.tiles.keys().filter(|(width, _)| *width < 12).map(|(_, origin)| origin);
        let children: BTreeSet<[i32; 3]> =
            self.grid.leaves.keys().chain(inner).map(|origin| origin.map(|x| x & !4095)).collect();
        self.out.extend((of_root.len() as u32).to_le_bytes());
        self.out.extend((children.len() as u32).to_le_bytes());
        for ((_, origin), (value, is_active)) in of_root {
            origin.iter().for_each(|x| self.out.extend(x.to_le_bytes()));
            self.value(*value);
            self.out.push(u8::from(*is_active));
        }
        let mut leaves = Vec::new();
        for origin in children {
            origin.iter().for_each(|x| self.out.extend(x.to_le_bytes()));
            self.node(origin, 12, &mut leaves);
        }
        let start = self.out.len() as u64;
        for origin in leaves {
            let leaf = &self.grid.leaves[&origin];
            self.mask(&leaf.active);
            self.values(&leaf.active, &leaf.values);
        }
        start
    }

    fn map(&mut self) {
        let mut numbers = Vec::new();
        let derived = |scale: [f64; 3]| {
            let of = |f: &dyn Fn(f64) -> f64| scale.map(f);
            [scale, of(&f64::abs), of(&|s| 1.0 / s), of(&|s| 1.0 / (s * s)), of(&|s| 0.5 / s)].concat()
        };
        match self.grid.map {
            VdbMap::Uniform(size) => {
                text(self.out, "UniformScaleMap");
                numbers.extend(derived([size; 3]));
            }
            VdbMap::ScaleTranslate(scale, origin) => {
                text(self.out, "ScaleTranslateMap");
                numbers.extend(origin);
                numbers.extend(derived(scale));
            }
            VdbMap::Affine(axes, origin) => {
                text(self.out, "AffineMap");
                axes.iter().for_each(|axis| numbers.extend([axis[0], axis[1], axis[2], 0.0]));
                numbers.extend([origin[0], origin[1], origin[2], 1.0]);
            }
        }
        numbers.iter().for_each(|x| self.out.extend(x.to_le_bytes()));
    }

    fn value(&mut self, value: [f32; 3]) {
        for &number in &value[..self.grid.channels()] {
            match self.grid.kind {
                VdbKind::Double | VdbKind::DoubleVec3 => self.out.extend(f64::from(number).to_le_bytes()),
                VdbKind::OwnHalf => self.out.extend(half::from_f32(number).to_le_bytes()),
                _ => self.out.extend(number.to_le_bytes()),
            }
        }
    }

    fn mask(&mut self, bits: &[bool]) {
        self.out.extend(
            bits.chunks(8).map(|bits| bits.iter().rev().fold(0, |byte, &bit| byte << 1 | u8::from(bit))),
        );
    }

    /// * `log2_width`: of the node, 12 or 7
    fn node(&mut self, origin: [i32; 3], log2_width: u32, leaves: &mut Vec<[i32; 3]>) {
        let width = if log2_width == 12 { 7 } else { 3 };
        let entries = 1usize << (3 * (log2_width - width));
        let is_within = |p: &[i32; 3]| p.map(|x| x >> log2_width) == origin.map(|x| x >> log2_width);
        let index = |p: [i32; 3]| {
            let [x, y, z] = [0, 1, 2].map(|axis| ((p[axis] - origin[axis]) >> width) as usize);
            let shift = log2_width - width;
            x << (2 * shift) | y << shift | z
        };
        let (mut child, mut active) = (vec![false; entries], vec![false; entries]);
        let mut values = vec![self.grid.background; entries];
        let mut children = BTreeMap::new();
        for &leaf in self.grid.leaves.keys().filter(|leaf| is_within(leaf)) {
            child[index(leaf)] = true;
            children.insert(index(leaf), leaf.map(|x| x >> width << width));
        }
        for (&(tile_width, tile), &(value, is_active)) in &self.grid.tiles {
            if !is_within(&tile) || tile_width > width {
                continue;
            }
            if tile_width == width {
                (active[index(tile)], values[index(tile)]) = (is_active, value);
            } else {
                child[index(tile)] = true;
                children.insert(index(tile), tile.map(|x| x >> width << width));
            }
        }
        self.mask(&child);
        self.mask(&active);
        self.values(&active, &values);
        for child in children.into_values() {
            if width == 7 {
                self.node(child, 7, leaves);
            } else {
                let mask = self.grid.leaves[&child].active;
                self.mask(&mask);
                leaves.push(child);
            }
        }
    }

    /// The values of a node, of which those are left out that are known otherwise.
    fn values(&mut self, active: &[bool], values: &[[f32; 3]]) {
        let background = self.grid.background;
        let minus = background.map(|x| -x);
        let mut off: Vec<[f32; 3]> = Vec::new();
        for (value, _) in values.iter().zip(active).filter(|(_, active)| !**active) {
            if !off.contains(value) {
                off.push(*value);
            }
        }
        // Which value the bits of a mask stand for: 0, and 1.
        let (flag, written, one) = match *off {
            _ if !self.file.masks => (6, vec![], None),
            [] => (0, vec![], None),
            [a] if a == background => (0, vec![], None),
            [a] if a == minus => (1, vec![], None),
            [a] => (2, vec![a], None),
            [a, b] if [a, b] == [background, minus] || [b, a] == [background, minus] => {
                (3, vec![], Some(background))
            }
            [a, b] if a == background => (4, vec![b], Some(a)),
            [a, b] if b == background => (4, vec![a], Some(b)),
            [a, b] => (5, vec![a, b], Some(b)),
            _ => (6, vec![], None),
        };
        self.out.push(flag);
        written.into_iter().for_each(|value| self.value(value));
        if let Some(one) = one {
            let bits: Vec<bool> =
                values.iter().zip(active).map(|(value, active)| !active && *value == one).collect();
            self.mask(&bits);
        }
        let kept: Vec<[f32; 3]> = values
            .iter()
            .zip(active)
            .filter(|(_, active)| flag == 6 || **active)
            .map(|(value, _)| *value)
            .collect();
        self.array(&kept);
    }

    fn array(&mut self, values: &[[f32; 3]]) {
        let mut bytes = Vec::new();
        let channels = self.grid.channels();
        for number in values.iter().flat_map(|value| &value[..channels]) {
            match self.grid.kind {
                VdbKind::Half | VdbKind::HalfVec3 | VdbKind::OwnHalf => {
                    bytes.extend(half::from_f32(*number).to_le_bytes());
                }
                VdbKind::Double | VdbKind::DoubleVec3 => bytes.extend(f64::from(*number).to_le_bytes()),
                _ => bytes.extend(number.to_le_bytes()),
            }
        }
        let is_half = matches!(self.grid.kind, VdbKind::Half | VdbKind::HalfVec3);
        if is_half && values.is_empty() {
            return;
        }
        let width = if is_half || self.grid.kind == VdbKind::OwnHalf { 2 } else { 4 };
        let packed = match self.file.compression {
            VdbCompression::None => return self.out.extend(bytes),
            VdbCompression::Zip => miniz_oxide::deflate::compress_to_vec_zlib(&bytes, 9),
            VdbCompression::Blosc => blosc(&bytes, width, bytes.len().max(1)),
        };
        if packed.len() < bytes.len() {
            self.out.extend((packed.len() as i64).to_le_bytes());
            self.out.extend(packed);
        } else {
            self.out.extend((-(bytes.len() as i64)).to_le_bytes());
            self.out.extend(bytes);
        }
    }
}

/// A container of Blosc, its bytes shuffled.
///
/// * `width`: bytes of a number
/// * `block`: bytes of a block, a multiple of `width`
pub fn blosc(bytes: &[u8], width: usize, block: usize) -> Vec<u8> {
    let blocks: Vec<&[u8]> = bytes.chunks(block).collect();
    let first = 16 + 4 * blocks.len();
    let (mut starts, mut streams) = (Vec::new(), Vec::new());
    for part in blocks {
        starts.extend(((first + streams.len()) as u32).to_le_bytes());
        let count = part.len() / width;
        let shuffled: Vec<u8> =
            (0..width).flat_map(|byte| (0..count).map(move |k| part[k * width + byte])).collect();
        // A last block that is shorter is one stream.
        let split = if block / width >= 128 && part.len() == block { width } else { 1 };
        for stream in shuffled.chunks(shuffled.len().div_ceil(split).max(1)) {
            let packed = lz4(stream);
            let chosen = if packed.len() < stream.len() { &packed[..] } else { stream };
            streams.extend((chosen.len() as u32).to_le_bytes());
            streams.extend(chosen);
        }
    }
    // LZ4, and shuffled.
    let mut out = vec![2, 1, 1 << 5 | 1, width as u8];
    for n in [bytes.len(), block.min(bytes.len()), first + streams.len()] {
        out.extend((n as u32).to_le_bytes());
    }
    [out, starts, streams].concat()
}

/// A block of LZ4: each copy is of the last place with the same four bytes.
pub fn lz4(bytes: &[u8]) -> Vec<u8> {
    // The last five bytes are literals, and no copy begins in the last twelve.
    let (last_copy, last_end) = (bytes.len().saturating_sub(12), bytes.len().saturating_sub(5));
    let mut seen: BTreeMap<&[u8], usize> = BTreeMap::new();
    let (mut out, mut start, mut at) = (Vec::new(), 0, 0);
    while at < last_copy {
        let from = seen.insert(&bytes[at..at + 4], at).filter(|from| at - from <= 0xffff);
        let Some(from) = from else {
            at += 1;
            continue;
        };
        let length = (0..last_end - at).take_while(|k| bytes[from + k] == bytes[at + k]).count();
        if length < 4 {
            at += 1;
            continue;
        }
        sequence(&mut out, &bytes[start..at], Some((at - from, length)));
        at += length;
        start = at;
    }
    sequence(&mut out, &bytes[start..], None);
    out
}

fn sequence(out: &mut Vec<u8>, literals: &[u8], copy: Option<(usize, usize)>) {
    let of_copy = copy.map_or(0, |(_, length)| length - 4);
    out.push((literals.len().min(15) as u8) << 4 | of_copy.min(15) as u8);
    let rest = |out: &mut Vec<u8>, n: usize| {
        if n >= 15 {
            out.extend(std::iter::repeat_n(255, (n - 15) / 255));
            out.push(((n - 15) % 255) as u8);
        }
    };
    rest(out, literals.len());
    out.extend(literals);
    if let Some((distance, _)) = copy {
        out.extend((distance as u16).to_le_bytes());
        rest(out, of_copy);
    }
}
