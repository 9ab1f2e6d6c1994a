//! A writer of NanoVDB files, for tests: the first number of each voxel of a [`VdbGrid`].
//!
//! The layout is told by the reader, in `kajo_scene`. Statistics and checksums are left out.

use std::collections::BTreeMap;

use crate::vdb::{VdbCompression, VdbGrid, blosc};

/// Bytes of a grid in front of its tree, of this in front of the root, and of the nodes of each level.
const GRID: usize = 672;
const TREE: usize = 64;
const NODES: [usize; 3] = [270_400, 33_856, 2144];

const VERSION: u32 = 32 << 21 | 4 << 10;

/// The bytes of a file of grids.
pub fn to_bytes(grids: &[VdbGrid], compression: VdbCompression) -> Vec<u8> {
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
    for grid in grids {
        let bytes = grid_bytes(grid);
        let packed = match compression {
            VdbCompression::None => bytes.clone(),
            VdbCompression::Zip => with_length(miniz_oxide::deflate::compress_to_vec_zlib(&bytes, 9)),
            VdbCompression::Blosc => with_length(blosc(&bytes, 4, 1 << 18)),
        };
        let mut head = [0; 176];
        put(&mut head, 0, &(bytes.len() as u64).to_le_bytes());
        put(&mut head, 8, &(packed.len() as u64).to_le_bytes());
        put(&mut head, 32, &1u32.to_le_bytes());
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

fn grid_bytes(grid: &VdbGrid) -> Vec<u8> {
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
    let mut end = root + 64 + 32 * (of_root.len() + nodes[0].len());
    for nodes in &mut nodes {
        for node in nodes.values_mut() {
            node.at = end;
            end += NODES[node.level];
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
    put(&mut out, 636, &1u32.to_le_bytes());
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
    put(&mut out, root + 28, &grid.background[0].to_le_bytes());
    let key = |origin: [i32; 3]| {
        let [x, y, z] = origin.map(|x| u64::from(x.cast_unsigned() >> 12));
        (x << 42 | y << 21 | z).to_le_bytes()
    };
    let mut tile = root + 64;
    for (origin, node) in &nodes[0] {
        put(&mut out, tile, &key(*origin));
        put(&mut out, tile + 8, &((node.at - root) as u64).to_le_bytes());
        tile += 32;
    }
    for ((_, origin), (value, is_active)) in of_root {
        put(&mut out, tile, &key(*origin));
        put(&mut out, tile + 16, &u32::from(*is_active).to_le_bytes());
        put(&mut out, tile + 20, &value[0].to_le_bytes());
        tile += 32;
    }
    for level in 0..2 {
        let (width, log2) = (widths[level + 1], widths[level] - widths[level + 1]);
        let mask = (1usize << (3 * log2)) / 8;
        let table = (32 + 2 * mask + 16).next_multiple_of(32);
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
            for entry in out[node.at + table..node.at + NODES[level]].chunks_exact_mut(8) {
                entry[..4].copy_from_slice(&grid.background[0].to_le_bytes());
            }
            for (&(_, tile), &(value, is_active)) in
                grid.tiles.iter().filter(|((of, tile), _)| *of == width && is_within(tile))
            {
                put(&mut out, node.at + table + 8 * index(&tile), &value[0].to_le_bytes());
                out[node.at + 32 + index(&tile) / 8] |= u8::from(is_active) << (index(&tile) % 8);
            }
            for (place, child) in nodes[level + 1].iter().filter(|(place, _)| is_within(place)) {
                put(
                    &mut out,
                    node.at + table + 8 * index(place),
                    &((child.at - node.at) as u64).to_le_bytes(),
                );
                out[node.at + 32 + mask + index(place) / 8] |= 1 << (index(place) % 8);
            }
        }
    }
    for (origin, node) in &nodes[2] {
        let leaf = &grid.leaves[origin];
        origin.iter().enumerate().for_each(|(k, x)| put(&mut out, node.at + 4 * k, &x.to_le_bytes()));
        for (k, (value, active)) in leaf.values.iter().zip(leaf.active).enumerate() {
            put(&mut out, node.at + 96 + 4 * k, &value[0].to_le_bytes());
            out[node.at + 16 + k / 8] |= u8::from(active) << (k % 8);
        }
    }
    out
}
