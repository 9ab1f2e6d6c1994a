//! A writer of NanoVDB files, for tests.
//!
//! The layout is told by the reader, in `kajo_scene`. Statistics and checksums are left out.

use std::collections::BTreeMap;

use crate::vdb::{Leaf, VdbCompression, VdbGrid, VdbKind, blosc};

/// Bytes of a grid in front of its tree, and of this in front of the root.
const GRID: usize = 672;
const TREE: usize = 64;

const VERSION: u32 = 32 << 21 | 4 << 10;

/// What voxels hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NanoKind {
    /// One number, a float.
    Float,
    /// One number, a double.
    Double,
    /// Three floats.
    Vec3,
    /// Three doubles.
    DoubleVec3,
    /// One number, as a step between the least and the largest one of its leaf, in `2^k` bits: 4, 8 or 16.
    Codes(u32),
    /// The same, in 1, 2, 4, 8 and 16 bits by turns.
    CodesByLeaf,
}

impl NanoKind {
    fn of(kind: VdbKind) -> NanoKind {
        match kind {
            VdbKind::Float | VdbKind::Half | VdbKind::OwnHalf => NanoKind::Float,
            VdbKind::Double => NanoKind::Double,
            VdbKind::Vec3 | VdbKind::HalfVec3 => NanoKind::Vec3,
            VdbKind::DoubleVec3 => NanoKind::DoubleVec3,
        }
    }

    /// The library's number for it.
    fn number(self) -> u32 {
        match self {
            NanoKind::Float => 1,
            NanoKind::Double => 2,
            NanoKind::Vec3 => 6,
            NanoKind::DoubleVec3 => 7,
            NanoKind::Codes(log2) => 11 + log2,
            NanoKind::CodesByLeaf => 16,
        }
    }

    /// Bytes of a root in front of its background, and its tiles; in front of the value of a tile, and of a tile; of an entry of a node.
    fn sizes(self) -> [usize; 5] {
        match self {
            NanoKind::Double => [32, 96, 24, 32, 8],
            NanoKind::Vec3 => [28, 96, 20, 32, 16],
            NanoKind::DoubleVec3 => [32, 128, 24, 64, 24],
            _ => [28, 64, 20, 32, 8],
        }
    }

    /// Bytes of a node in front of its entries.
    fn node_head(self, level: usize) -> usize {
        [8256, 1088][level] + if self == NanoKind::DoubleVec3 { 32 } else { 0 }
    }

    /// Bytes of a node or a leaf.
    fn bytes(self, level: usize) -> usize {
        match (level, self) {
            (2, NanoKind::Float) => 2144,
            (2, NanoKind::Double) => 4224,
            (2, NanoKind::Vec3) => 6272,
            (2, NanoKind::DoubleVec3) => 12_448,
            (2, NanoKind::Codes(log2)) => 96 + (64 << log2),
            // As much room as the widest ones need.
            (2, NanoKind::CodesByLeaf) => 96 + (64 << 4),
            _ => self.node_head(level) + self.sizes()[4] * [32_768, 4096][level],
        }
    }

    fn value(self, numbers: [f32; 3]) -> Vec<u8> {
        match self {
            NanoKind::Double => f64::from(numbers[0]).to_le_bytes().to_vec(),
            NanoKind::Vec3 => numbers.iter().flat_map(|x| x.to_le_bytes()).collect(),
            NanoKind::DoubleVec3 => numbers.iter().flat_map(|x| f64::from(*x).to_le_bytes()).collect(),
            _ => numbers[0].to_le_bytes().to_vec(),
        }
    }

    /// What is behind the mask of a leaf, and the logarithm of the bits of its codes.
    ///
    /// * `turn`: its place among the leaves
    fn leaf(self, leaf: &Leaf, turn: usize) -> (Vec<u8>, u8) {
        let log2 = match self {
            NanoKind::Codes(log2) => log2,
            NanoKind::CodesByLeaf => (turn % 5) as u32,
            _ => {
                let mut out = vec![0; self.bytes(2) - 80 - 512 * self.value([0.0; 3]).len()];
                leaf.values.iter().for_each(|value| out.extend(self.value(*value)));
                return (out, 0);
            }
        };
        let numbers = || leaf.values.iter().map(|value| value[0]);
        let least = numbers().fold(f32::INFINITY, f32::min);
        let bits = 1 << log2;
        let step = (numbers().fold(f32::NEG_INFINITY, f32::max) - least) / ((1u32 << bits) - 1) as f32;
        let mut codes = vec![0u8; 64 << log2];
        for (index, number) in numbers().enumerate() {
            let code = if step > 0.0 { ((number - least) / step).round() as u16 } else { 0 };
            let bit = index << log2;
            code.to_le_bytes()
                .iter()
                .zip(&mut codes[bit / 8..])
                .for_each(|(from, to)| *to |= from << (bit % 8));
        }
        let head = [least, step, 0.0, 0.0].map(f32::to_le_bytes);
        ([head.as_flattened(), &codes].concat(), (log2 << 5) as u8)
    }
}

/// The bytes of a file of grids, whose values are those of OpenVDB's.
pub fn to_bytes(grids: &[VdbGrid], compression: VdbCompression) -> Vec<u8> {
    let kinds: Vec<_> = grids.iter().map(|grid| NanoKind::of(grid.kind)).collect();
    to_bytes_as(grids, &kinds, compression)
}

/// The bytes of a file of grids.
///
/// * `kinds`: what their voxels hold
pub fn to_bytes_as(grids: &[VdbGrid], kinds: &[NanoKind], compression: VdbCompression) -> Vec<u8> {
    let mut out = b"NanoVDB0".to_vec();
    let codec: u16 = match compression {
        VdbCompression::None => 0,
        VdbCompression::Zip => 1,
        VdbCompression::Blosc => 2,
    };
    out.extend(VERSION.to_le_bytes());
    out.extend((grids.len() as u16).to_le_bytes());
    out.extend(codec.to_le_bytes());
    let mut all = Vec::new();
    for (grid, kind) in grids.iter().zip(kinds) {
        let bytes = grid_bytes(grid, *kind);
        let packed = match compression {
            VdbCompression::None => bytes.clone(),
            VdbCompression::Zip => with_length(miniz_oxide::deflate::compress_to_vec_zlib(&bytes, 9)),
            VdbCompression::Blosc => with_length(blosc(&bytes, 4, 1 << 18)),
        };
        let mut head = [0; 176];
        put(&mut head, 0, &(bytes.len() as u64).to_le_bytes());
        put(&mut head, 8, &(packed.len() as u64).to_le_bytes());
        put(&mut head, 32, &kind.number().to_le_bytes());
        put(&mut head, 136, &(grid.name.len() as u32 + 1).to_le_bytes());
        put(&mut head, 168, &codec.to_le_bytes());
        put(&mut head, 172, &VERSION.to_le_bytes());
        out.extend(head);
        out.extend(grid.name.bytes());
        out.push(0);
        all.push(packed);
    }
    out.extend(all.concat());
    out
}

fn with_length(bytes: Vec<u8>) -> Vec<u8> {
    [&(bytes.len() as u64).to_le_bytes(), &bytes[..]].concat()
}

fn put(out: &mut [u8], at: usize, bytes: &[u8]) {
    out[at..at + bytes.len()].copy_from_slice(bytes);
}

/// A node: where it lies, and what it is the parent of.
struct Node {
    at: usize,
    level: usize,
}

fn grid_bytes(grid: &VdbGrid, kind: NanoKind) -> Vec<u8> {
    let [background, root_head, tile_value, root_tile, entry] = kind.sizes();
    // Nodes by their level, the largest first, and their origin.
    let mut nodes: [BTreeMap<[i32; 3], Node>; 3] = Default::default();
    let widths = [12, 7, 3];
    let inner = grid.tiles.keys().map(|&(width, origin)| (width, origin));
    for (width, origin) in grid.leaves.keys().map(|&origin| (0, origin)).chain(inner) {
        for (level, nodes) in nodes.iter_mut().enumerate().filter(|(level, _)| widths[*level] > width) {
            let origin = origin.map(|x| x >> widths[level] << widths[level]);
            nodes.insert(origin, Node { at: 0, level });
        }
    }
    let of_root: Vec<_> = grid.tiles.iter().filter(|((width, _), _)| *width == 12).collect();
    let root = GRID + TREE;
    let mut end = root + root_head + root_tile * (of_root.len() + nodes[0].len());
    for nodes in &mut nodes {
        for node in nodes.values_mut() {
            node.at = end;
            end += kind.bytes(node.level);
        }
    }
    let mut out = vec![0; end];
    put(&mut out, 0, b"NanoVDB0");
    put(&mut out, 8, &u64::MAX.to_le_bytes());
    put(&mut out, 16, &VERSION.to_le_bytes());
    put(&mut out, 28, &1u32.to_le_bytes());
    put(&mut out, 32, &(end as u64).to_le_bytes());
    put(&mut out, 40, grid.name.as_bytes());
    let (axes, origin) = grid.map.affine();
    for row in 0..3 {
        for (axis, column) in axes.iter().enumerate() {
            let number = column[row];
            put(&mut out, 384 + 8 * (3 * row + axis), &number.to_le_bytes());
            put(&mut out, 296 + 4 * (3 * row + axis), &(number as f32).to_le_bytes());
        }
        put(&mut out, 528 + 8 * row, &origin[row].to_le_bytes());
        put(&mut out, 368 + 4 * row, &(origin[row] as f32).to_le_bytes());
    }
    put(&mut out, 632, &0u32.to_le_bytes());
    put(&mut out, 636, &kind.number().to_le_bytes());
    let firsts = [2, 1, 0].map(|level| nodes[level].values().map(|node| node.at).min().unwrap_or(end));
    for (k, first) in firsts.into_iter().chain([root]).enumerate() {
        put(&mut out, GRID + 8 * k, &((first - GRID) as u64).to_le_bytes());
    }
    for (k, level) in [2, 1, 0].into_iter().enumerate() {
        put(&mut out, GRID + 32 + 4 * k, &(nodes[level].len() as u32).to_le_bytes());
    }
    let active = grid.leaves.iter().flat_map(|(origin, leaf)| {
        let on = (0..512).filter(|&k| leaf.active[k as usize]);
        on.map(|k: i32| [origin[0] + (k >> 6), origin[1] + (k >> 3 & 7), origin[2] + (k & 7)])
    });
    let of_tiles = grid
        .tiles
        .iter()
        .filter(|(_, (_, is_active))| *is_active)
        .flat_map(|(&(width, origin), _)| [origin, origin.map(|x| x + ((1 << width) - 1))]);
    let mut corners = [[i32::MAX; 3], [i32::MIN; 3]];
    for p in active.chain(of_tiles) {
        for axis in 0..3 {
            corners[0][axis] = corners[0][axis].min(p[axis]);
            corners[1][axis] = corners[1][axis].max(p[axis]);
        }
    }
    for (k, x) in corners.as_flattened().iter().enumerate() {
        put(&mut out, root + 4 * k, &x.to_le_bytes());
    }
    put(&mut out, root + 24, &((of_root.len() + nodes[0].len()) as u32).to_le_bytes());
    put(&mut out, root + background, &kind.value(grid.background));
    let key = |origin: [i32; 3]| {
        let [x, y, z] = origin.map(|x| u64::from(x.cast_unsigned() >> 12));
        (x << 42 | y << 21 | z).to_le_bytes()
    };
    let mut tile = root + root_head;
    for (origin, node) in &nodes[0] {
        put(&mut out, tile, &key(*origin));
        put(&mut out, tile + 8, &((node.at - root) as u64).to_le_bytes());
        tile += root_tile;
    }
    for ((_, origin), (value, is_active)) in of_root {
        put(&mut out, tile, &key(*origin));
        put(&mut out, tile + 16, &u32::from(*is_active).to_le_bytes());
        put(&mut out, tile + tile_value, &kind.value(*value));
        tile += root_tile;
    }
    for level in 0..2 {
        let (width, log2) = (widths[level + 1], widths[level] - widths[level + 1]);
        let mask = (1usize << (3 * log2)) / 8;
        let table = kind.node_head(level);
        for (origin, node) in &nodes[level] {
            let index = |p: &[i32; 3]| {
                let [x, y, z] = [0, 1, 2].map(|axis| ((p[axis] - origin[axis]) >> width) as usize);
                x << (2 * log2) | y << log2 | z
            };
            let is_within =
                |p: &[i32; 3]| p.map(|x| x >> widths[level]) == origin.map(|x| x >> widths[level]);
            for (k, x) in origin.iter().enumerate() {
                put(&mut out, node.at + 4 * k, &x.to_le_bytes());
                put(&mut out, node.at + 12 + 4 * k, &(x + ((1 << widths[level]) - 1)).to_le_bytes());
            }
            let of_background = kind.value(grid.background);
            for entry in out[node.at + table..node.at + kind.bytes(level)].chunks_exact_mut(entry) {
                entry[..of_background.len()].copy_from_slice(&of_background);
            }
            for (&(_, tile), &(value, is_active)) in
                grid.tiles.iter().filter(|((of, tile), _)| *of == width && is_within(tile))
            {
                put(&mut out, node.at + table + entry * index(&tile), &kind.value(value));
                out[node.at + 32 + index(&tile) / 8] |= u8::from(is_active) << (index(&tile) % 8);
            }
            for (place, child) in nodes[level + 1].iter().filter(|(place, _)| is_within(place)) {
                put(
                    &mut out,
                    node.at + table + entry * index(place),
                    &((child.at - node.at) as u64).to_le_bytes(),
                );
                out[node.at + 32 + mask + index(place) / 8] |= 1 << (index(place) % 8);
            }
        }
    }
    for (turn, (origin, node)) in nodes[2].iter().enumerate() {
        let leaf = &grid.leaves[origin];
        origin.iter().enumerate().for_each(|(k, x)| put(&mut out, node.at + 4 * k, &x.to_le_bytes()));
        for (k, active) in leaf.active.into_iter().enumerate() {
            out[node.at + 16 + k / 8] |= u8::from(active) << (k % 8);
        }
        let (voxels, flags) = kind.leaf(leaf, turn);
        put(&mut out, node.at + 80, &voxels);
        out[node.at + 15] = flags;
    }
    out
}
